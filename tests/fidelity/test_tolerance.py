"""The shipped front, and what a tolerance picks in the benchmark and in the environments."""

import json
from dataclasses import asdict

import gymnasium
import numpy as np
import pytest

import envs  # noqa: F401 - registers the environments
from envs.config import EnvConfig
from scripts import grasp_benchmark
from softhand_sim.effects import FULL
from softhand_sim.effects.scene import Tolerance
from softhand_sim.fidelity.fidelity import Fidelity, shipped_front
from softhand_sim.fidelity.points import CANDIDATES, FINEST_NAME, NUMERICS
from softhand_sim.hand.scene import EngineSettings

WIDE = Tolerance(angle_deg=20.0, slip_m=0.02)


def test_the_shipped_points_are_the_settings_that_their_names_say():
    points = {point.measured.name: point for point in shipped_front().points}
    assert set(points) == set(CANDIDATES)
    for name, point in points.items():
        assert point.engine == NUMERICS[name].engine
        assert (point.links, point.shapes, point.effects) == (None, Fidelity().shapes, "bench")


def test_wider_tolerances_never_cost_more_and_are_kept():
    """From what the finest setting knows of itself on; each pick has few enough scenes beyond the tolerance."""
    front = shipped_front()
    finest = next(p.measured for p in front.points if p.measured.name == FINEST_NAME)
    least = np.array([finest.angle_error_deg, finest.slip_error_m])
    for share in np.linspace(0.0, 1.0, 5):
        costs = []
        for factor in (2.0, 4.0, 8.0, 16.0, 32.0):
            angle, slip = factor * least * (1.0, 1.0 + 4.0 * share)
            picked = Fidelity.for_tolerance(angle_deg=angle, slip_mm=1e3 * slip)
            errors = front.errors[front.points.index(picked)]
            assert ((errors.angle_deg > angle) | (errors.slip_m > slip)).mean() < 0.05
            costs.append(picked.measured.cost_ratio)
        assert costs == sorted(costs, reverse=True)
        assert costs[-1] < costs[0]


def test_what_the_finest_setting_does_not_know_of_itself_is_refused():
    finest = next(p.measured for p in shipped_front().points if p.measured.name == FINEST_NAME)
    with pytest.raises(ValueError, match="no measured setting"):
        Fidelity.for_tolerance(angle_deg=0.9 * finest.angle_error_deg, slip_mm=50.0)
    with pytest.raises(ValueError, match="no measured setting"):
        Fidelity.for_tolerance(angle_deg=50.0, slip_mm=0.9e3 * finest.slip_error_m)


def test_the_default_tolerance_of_two_degrees_and_a_millimetre_can_be_had():
    picked = Fidelity.for_tolerance()
    assert picked.measured is not None
    assert picked.measured.angle_error_deg <= 2.0


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--tolerance", "0,0"], "no measured setting"),
        (["--tolerance", "4,2", "--timestep", "1"], "--tolerance picks it"),
        (["--effects", "auto"], "--effects auto: needs --tolerance"),
    ],
)
def test_the_benchmark_refuses_what_it_cannot_promise(arguments, says, capsys):
    assert grasp_benchmark.main(["--objects", "strawberry", "--no-pictures", *arguments]) == 2
    assert says in capsys.readouterr().err


def test_what_a_tolerance_picks_stands_in_the_benchmark_s_result(tmp_path, capsys):
    file = tmp_path / "grasps.json"
    command = ["--objects", "strawberry", "--trials", "1", "--no-pictures", "--tolerance", "20,20", "--json", str(file)]
    assert grasp_benchmark.main(command) == 0
    told = json.loads(file.read_text())["settings"]["fidelity"]
    wanted = Fidelity.within(WIDE)
    assert told["timestep_s"] == wanted.timestep_s
    assert told["measured"]["cost_ratio"] == wanted.measured.cost_ratio
    assert f"picked: {wanted.measured.name}" in capsys.readouterr().out


def test_the_benchmark_shares_its_tolerance_as_environments_do(tmp_path, monkeypatch, capsys):
    """Half for the setting, half for the effects that each object's scene leaves out."""
    asked = []

    def choose(facts, tolerance):
        asked.append((facts.offered, tolerance))
        return facts.offered, ()

    monkeypatch.setattr("softhand_sim.grasp.trial.choose", choose)
    file = tmp_path / "grasps.json"
    command = ["--objects", "strawberry", "--trials", "1", "--no-pictures", "--effects", "auto", "--tolerance", "20,20"]
    assert grasp_benchmark.main([*command, "--json", str(file)]) == 0
    assert asked == [(FULL, Tolerance(angle_deg=10.0, slip_m=0.01))]
    told = json.loads(file.read_text())["settings"]["fidelity"]
    assert told["auto_effects"] == {"angle_deg": 10.0, "slip_m": 0.01}
    assert told["measured"] == asdict(Fidelity.for_tolerance(angle_deg=10.0, slip_mm=10.0).measured)
    assert "effects: those of full that a scene calls for within 10 degrees" in capsys.readouterr().out


def test_an_environment_shares_its_tolerance_between_setting_and_effects():
    config = EnvConfig(objects="strawberry", tolerance=WIDE, effects="auto")
    half = Tolerance(angle_deg=10.0, slip_m=0.01)
    settings = config.scenes().settings
    assert settings.engine == Fidelity.within(half).engine
    assert settings.tolerance == half
    own = EnvConfig(objects="strawberry", tolerance=WIDE, engine=EngineSettings())
    assert own.fidelity is None
    assert own.scenes().settings.tolerance == WIDE
    assert EnvConfig(objects="strawberry", effects="auto").fidelity is None


def test_an_environment_tells_what_was_picked(monkeypatch):
    # which effects the scene calls for is asked elsewhere
    monkeypatch.setattr("envs.world.choose", lambda facts, _tolerance: (facts.offered, ()))
    env = gymnasium.make("SoftHandGrasp-v0", objects=["strawberry"], tolerance=WIDE)
    _, info = env.reset(seed=0)
    picked = Fidelity.within(WIDE, effects_too=True)
    assert info["fidelity_name"] == picked.measured.name
    assert info["fidelity_cost_ratio"] == picked.measured.cost_ratio
    assert env.unwrapped.episode.here.simulation.dt == picked.timestep_s
    env.close()
