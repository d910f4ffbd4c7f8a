"""The scripts around the environments: they run, and what they say is whole."""

import json

import pytest

from scripts import benchmark_env, random_steps


def test_random_steps_count_and_watch_memory(tmp_path, monkeypatch, capsys):
    cases = list(random_steps._cases(("apple",)))
    assert len(cases) == 40
    assert len({json.dumps(case) for case in cases}) == 40
    monkeypatch.setattr(random_steps, "_cases", lambda _: [cases[0], cases[31], cases[37]])
    monkeypatch.setattr(random_steps, "EPISODE_STEPS", 20)
    out = tmp_path / "random.json"
    assert random_steps.main(["--steps", "300", "--objects", "apple", "--json", str(out)]) == 0
    data = json.loads(out.read_text())
    assert data["steps"] == 2 * (50 + 50 + 52)
    assert data["counts"]["episodes"] >= 8
    assert data["counts"]["NO ALARM"] == data["counts"]["episodes"]
    assert len(data["resident_bytes_after_each_case"]) == 6
    assert min(data["resident_bytes_after_each_case"]) > 50 << 20
    assert "304 steps in 3 cases" in capsys.readouterr().out


@pytest.mark.filterwarnings("ignore:.*observation space")
def test_an_observation_outside_its_space_fails_the_run(monkeypatch):
    cases = list(random_steps._cases(("apple",)))[1:2]
    monkeypatch.setattr(random_steps, "_cases", lambda _: cases)
    monkeypatch.setattr("envs.episode.Episode.observe", lambda episode: episode.spec.layout.high + 1.0)
    assert random_steps.main(["--steps", "4"]) == 1


def test_the_benchmark_compares_with_the_engine_and_a_batch(tmp_path):
    out = tmp_path / "env.json"
    arguments = ["--steps", "10", "--worlds", "2", "--turns", "1", "--seconds", "0.1", "--json", str(out)]
    assert benchmark_env.main(arguments) == 0
    data = json.loads(out.read_text())
    assert [row["scene"] for row in data["scenes"]] == list(benchmark_env.SCENES)
    for row in data["scenes"]:
        # 10 steps of 4 ms in 40 ms; an action does the engine's work and more
        assert row["engine_steps"] == 100
        assert row["ratio"] == pytest.approx(row["env_processor_s"] / row["engine_processor_s"])
    assert data["vector"]["worlds"] == 2
    free = data["free_running"]
    assert [row["time_step_s"] for row in free] == [0.004] * 6 + [0.002]
    assert [row["worlds"] for row in free] == [1, 2] * 3 + [1]
    for row in free:
        assert row["engine_steps"] * row["time_step_s"] == pytest.approx(0.04)
        # a process has at most its threads' time, of which there are two in a vector
        assert row["simulated_s_per_processor_s"] >= 0.9 / row["worlds"] * row["simulated_s_per_s"] > 0.0


def test_bad_input_is_one_line(capsys):
    assert random_steps.main(["--steps", "10", "--objects", "human_being"]) == 2
    assert "human_being" in capsys.readouterr().err
