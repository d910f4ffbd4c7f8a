"""The throughput benchmark: it counts what it says it counts, and the engine's part is a part."""

import json

from scripts import benchmark_throughput

QUICK = """
source = "test"
approach_m = 0.05
close_s = 0.2
settle_s = 0.05
[[phase]]
do = "lift"
height_m = 0.03
[[phase]]
do = "hold"
duration_s = 0.1
"""


def test_the_engine_s_share_is_that_of_the_same_steps(tmp_path):
    out, protocol = tmp_path / "out.json", tmp_path / "quick.toml"
    protocol.write_text(QUICK, encoding="utf-8")
    argv = ["--objects", "golf_ball,mug", "--trials", "2", "--repeats", "1", "--workers", "1"]
    assert benchmark_throughput.main([*argv, "--protocol", str(protocol), "--json", str(out)]) == 0
    data = json.loads(out.read_text())
    # 50 mm and 30 mm at 100 mm/s, two rests, closing, hold: 1.2 s in steps of 2 ms, asked every 20 ms
    for row in data["objects"]:
        assert abs(row["steps"] / row["trials"] - 600) <= 60
        assert 0.0 < row["engine_s"] < row["trial_s"]
        assert 0.0 < row["engine_share"] < 1.0
    assert data["engine_share"] < max(row["engine_share"] for row in data["objects"])
    assert [row["trials"] for row in data["runs"]] == [4]
    assert data["speedup"] == 1.0


def test_unknown_objects_are_refused(capsys):
    assert benchmark_throughput.main(["--objects", "unicorn"]) == 2
    assert "unicorn" in capsys.readouterr().err
