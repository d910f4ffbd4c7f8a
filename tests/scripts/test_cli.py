"""The command lines: bad input is one line on stderr and a non-zero status; results are whole files."""

import json

import numpy as np
import pytest
import trimesh
from PIL import Image

from scripts import calibrate, characterize, choose_grasps, grasp_benchmark, object_catalogue


def refused(capsys, main, argv):
    try:
        status = main(argv)
    except SystemExit as stop:  # argparse
        status = stop.code
    captured = capsys.readouterr()
    lines = captured.err.strip().splitlines()
    assert status not in (0, None)
    assert captured.out == ""
    assert len(lines) == 1, captured.err
    return lines[0]


@pytest.fixture
def meshes(tmp_path):
    sphere = trimesh.creation.icosphere(subdivisions=2, radius=0.0375)
    sphere.export(tmp_path / "metres.stl")
    sphere.copy().apply_scale(1000).export(tmp_path / "millimetres.stl")
    (tmp_path / "empty.obj").write_text("")
    (tmp_path / "nan.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 nan 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    return tmp_path


@pytest.mark.parametrize(
    ("file", "more", "told"),
    [
        ("missing.obj", ["--mass", "0.068"], "missing.obj"),
        ("empty.obj", ["--mass", "0.068"], "empty.obj"),
        ("nan.obj", ["--mass", "0.068"], "nan"),
        ("millimetres.stl", ["--mass", "0.068"], "0.001"),
        ("metres.stl", ["--mass", "-1"], "--mass"),
        ("metres.stl", [], "--mass"),
        ("metres.stl", ["--mass", "0.1", "--friction", "-0.1"], "--friction"),
    ],
)
def test_bad_meshes_and_masses(file, more, told, meshes, capsys):
    line = refused(capsys, grasp_benchmark.main, ["--mesh", str(meshes / file), "--trials", "1", *more])
    assert told.lower() in line.lower()


@pytest.mark.parametrize(
    ("main", "argv", "told"),
    [
        (grasp_benchmark.main, ["--objects", "apple,unicorn"], "unicorn"),
        (grasp_benchmark.main, ["--trials", "0"], "--trials"),
        (grasp_benchmark.main, ["--workers", "two"], "--workers"),
        (grasp_benchmark.main, ["--calibration", "/nowhere/finger.json"], "finger.json"),
        (grasp_benchmark.main, ["--protocol", "dance"], "dance"),
        (grasp_benchmark.main, ["--protocol", "/nowhere/mine.toml"], "mine.toml"),
        (grasp_benchmark.main, ["--protocol", "six_forces_weightless", "--mass", "0.2"], "--mass"),
        (grasp_benchmark.main, ["--ycb", "/nowhere/ycb"], "/nowhere/ycb"),
        (grasp_benchmark.main, ["--search", "10"], "--search: 10 must be 0, or 64 or above"),
        (grasp_benchmark.main, ["--objects", "apple", "--grasps", "/nowhere/g.toml"], "g.toml"),
        (choose_grasps.main, ["--objects", "unicorn"], "unicorn"),
        (choose_grasps.main, ["--search", "1"], "--search"),
        (choose_grasps.main, ["--calibration", "/nowhere/finger.json"], "finger.json"),
        (characterize.main, ["pressure-angle", "--pressures", "10,900"], "900000"),
        (characterize.main, ["pressure-angle", "--pressures", "ten"], "--pressures"),
        (characterize.main, ["dance"], "dance"),
        (characterize.main, ["tip-load", "--pressures", "10"], "--pressures"),
        (characterize.main, ["tip-force", "--evidence", "/nowhere/evidence.json"], "evidence.json"),
        (calibrate.main, ["--density", "infinite"], "--density"),
        (object_catalogue.main, ["--objects", "unicorn"], "unicorn"),
    ],
)
def test_bad_arguments(main, argv, told, capsys):
    assert told in refused(capsys, main, argv)


@pytest.mark.parametrize("main", [grasp_benchmark.main, characterize.main, calibrate.main, object_catalogue.main])
def test_help_shows_examples(main, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["--help"])
    assert stop.value.code == 0
    assert "examples:" in capsys.readouterr().out


def test_a_mesh_of_one_s_own_gets_a_verdict(meshes, tmp_path):
    out = tmp_path / "out.json"
    argv = [
        "--mesh",
        str(meshes / "metres.stl"),
        "--mass",
        "0.068",
        "--trials",
        "1",
        "--no-pictures",
        "--json",
        str(out),
    ]
    assert grasp_benchmark.main(argv) == 0
    data = json.loads(out.read_text())
    row = data["objects"]["metres"]
    assert row["trials"] == 1
    assert {"held", "success_rate", "wilson_low", "wilson_high"} <= set(row)
    wanted = {
        "object",
        "seed",
        "outcome",
        "lift_m",
        "slip_m",
        "creep_m_per_s",
        "penetration_m",
        "wall_s",
        "simulated_s",
    }
    assert wanted <= set(data["trials"][0])
    assert data["trials"][0]["outcome"] == "HELD"
    assert [p.name for p in tmp_path.iterdir() if "partial" in p.name] == []


def test_broken_objects_are_listed_and_the_others_run(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("SOFTHAND_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "ycb"
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.0375)
    texts = {
        "014_lemon": "Dear sir or madam",
        "015_peach": "v 0 0 0\nv 1 0 0\nv 0 nan 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n",
        "016_pear": "mtllib ../../../secret.mtl\nv 0 0 0\n",
    }
    for name in ("013_apple", *texts, "900_thing"):
        (folder / name / "google_16k").mkdir(parents=True)
        ball.export(folder / name / "google_16k/textured.obj")
    for name, text in texts.items():
        (folder / name / "google_16k/textured.obj").write_text(text)
    (folder / "objects.json").write_text(json.dumps({"objects": ["013_apple", *texts, "900_thing", "../secret"]}))
    out = tmp_path / "out.json"
    argv = ["--ycb", str(folder), "--trials", "1", "--no-pictures", "--json", str(out)]
    assert grasp_benchmark.main(argv) == 1
    data = json.loads(out.read_text())
    assert list(data["objects"]) == ["013_apple"]
    assert data["trials"][0]["mass_kg"] == 0.068
    assert data["settings"]["protocol"]["name"] == "paper"
    reasons = data["not_tried"]
    assert set(reasons) == {*texts, "900_thing", "../secret"}
    assert "NaN" in reasons["015_peach"]
    assert "outside the folder" in reasons["016_pear"]
    assert "outside the folder" in reasons["../secret"]
    assert "no mass" in reasons["900_thing"]
    told = capsys.readouterr()
    assert "013_apple" in told.out
    assert all(f"not tried: {name}: " in told.err for name in reasons)


def test_the_catalogue_s_page_shows_every_object(tmp_path, capsys):
    page, data, picture = tmp_path / "objects.md", tmp_path / "objects.json", tmp_path / "objects.png"
    argv = ["--objects", "apple,mug", "--markdown", str(page), "--json", str(data), "--picture", str(picture)]
    assert object_catalogue.main(argv) == 0
    rows = json.loads(data.read_text())["objects"]
    assert rows["mug"]["mass_kg"] == 0.118
    assert "| apple | 013_apple |" in page.read_text()
    assert "](objects.png)" in page.read_text()
    # two tiles of different things, the rest of the row white
    pixels = np.asarray(Image.open(picture)).astype(int)
    width = pixels.shape[1] // 8
    assert np.abs(pixels[:, :width] - pixels[:, width : 2 * width]).max() > 50
    assert pixels[:, 2 * width :].min() == 255
    assert "apple" in capsys.readouterr().out


def test_characterize_writes_the_agreed_keys(tmp_path):
    out = tmp_path / "angles.json"
    assert characterize.main(["pressure-angle", "--pressures", "10,37,75", "--json", str(out)]) == 0
    data = json.loads(out.read_text())
    assert data["pressure_pa_gauge"] == [10e3, 37e3, 75e3]
    assert data["tip_angle_deg"][2] == pytest.approx(95.0, abs=2.0)
    assert [sum(row) for row in data["joint_angle_deg"]] == pytest.approx(data["tip_angle_deg"])


def test_characterize_writes_what_it_checks(tmp_path, capsys):
    out = tmp_path / "tip_force.json"
    assert characterize.main(["tip-force", "--json", str(out), "--pictures", str(tmp_path)]) == 0
    data = json.loads(out.read_text())
    assert all(check["holds"] for check in data["checks"])
    assert len(data["tip_force_n"]) == len(data["fea_tip_force_n"]) == len(data["pressure_pa_gauge"])
    assert (tmp_path / "tip-force.png").is_file()
    assert "blocked tip force" in capsys.readouterr().out
