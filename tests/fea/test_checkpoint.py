import json
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fea
from fea.checkpoint import Checkpoints
from fea.cost import Cost
from fea.path import Step
from scripts.fea import main

ROOT = Path(fea.__file__).parents[1]
RUN = ["exoskeleton", "--mesh", "coarse", "--loads", "0.01,0.02,0.03,0.05", "--no-pictures"]
# four rings: a fifth of the cells, and the silicone bulges against the tube between them
FINGER = ["finger", "--mesh", "coarse", "--pressures", "3,6", "--dimension", "ring_count=4", "--no-pictures"]


def step(parameter):
    rng = np.random.default_rng(int(parameter))
    cost = Cost(newton_iterations=3, wall_s=parameter)
    return Step(parameter=parameter, u_m=rng.normal(size=(4, 3)), iterations=2, residual=1e-8, cost=cost)


def test_steps_come_back_as_they_were(tmp_path):
    identity = {"geometry": {"wall_m": 2e-3}, "code": "a"}
    store = Checkpoints(tmp_path, identity)
    assert store.load() == []
    saved = [step(1.0), step(2.5)]
    for s in saved:
        store.save(s)
    again = Checkpoints(tmp_path, dict(reversed(identity.items())))
    loaded = again.load()
    again.save(step(3.0))
    assert [p.name for p in sorted(tmp_path.iterdir())] == [f"step-000{k}.npz" for k in (1, 2, 3)]
    for a, b in zip(saved, loaded, strict=True):
        np.testing.assert_array_equal(a.u_m, b.u_m)
        assert replace(a, u_m=b.u_m).cost == b.cost
        assert (a.parameter, a.iterations, a.residual) == (b.parameter, b.iterations, b.residual)


def test_another_run_s_steps_are_refused_by_what_differs(tmp_path):
    Checkpoints(tmp_path, {"geometry": 1, "materials": "set1", "code": "a"}).save(step(1.0))
    with pytest.raises(ValueError, match=r"step-0001\.npz: checkpoint of another run \(code, materials differ\)"):
        Checkpoints(tmp_path, {"geometry": 1, "materials": "set3", "code": "b"}).load()


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 half a file", b"not an archive"])
def test_damaged_file_is_refused_by_name(tmp_path, content):
    (tmp_path / "step-0001.npz").write_bytes(content)
    with pytest.raises(ValueError, match=r"step-0001\.npz: not a checkpoint"):
        Checkpoints(tmp_path, {}).load()


def test_run_killed_in_mid_sweep_resumes_to_the_same_curve(tmp_path, capsys):
    whole = tmp_path / "whole.json"
    assert main([*RUN, "--json", str(whole)]) == 0
    out, broken = tmp_path / "out", tmp_path / "broken.json"
    again = [*RUN, "--json", str(broken), "--out", str(out)]
    done = kill_in_mid_sweep(again, out / "checkpoint", after=3)
    assert 3 <= done < 10  # two steps to each of five levels
    assert not broken.exists()

    capsys.readouterr()
    assert main(again) == 0
    assert f"resumed after {done} steps" in capsys.readouterr().err
    assert len(list((out / "checkpoint").glob("step-*.npz"))) == 10
    a, b = (json.loads(file.read_text()) for file in (whole, broken))
    assert a["load_n"] == b["load_n"]
    for key in ("tip_deflection_m", "joint_rotation_rad", "max_von_mises_stress_pa"):
        # a relative residual of 1e-6
        np.testing.assert_allclose(b[key], a[key], rtol=2e-5)
    assert a["newton_iterations"] == pytest.approx(b["newton_iterations"], abs=6)

    # the finished folder refuses another material and leaves its files alone
    assert main([*again, "--tpu", "ninjaflex/set1"]) == 2
    assert "materials differ" in capsys.readouterr().err
    assert len(list(out.glob("fields-*.vtu"))) == 5


def test_finger_in_contact_killed_in_mid_sweep_resumes_to_the_same_curve(tmp_path, capsys):
    whole, broken, out = tmp_path / "whole.json", tmp_path / "broken.json", tmp_path / "out"
    assert main([*FINGER, "--json", str(whole)]) == 0
    again = [*FINGER, "--json", str(broken), "--out", str(out)]
    done = kill_in_mid_sweep(again, out / "checkpoint", after=1)
    assert not broken.exists()

    capsys.readouterr()
    assert main(again) == 0
    assert f"resumed after {done} steps" in capsys.readouterr().err
    assert len(list((out / "checkpoint").glob("step-*.npz"))) > done
    a, b = (json.loads(file.read_text()) for file in (whole, broken))
    assert a["pressure_pa_gauge"] == b["pressure_pa_gauge"]
    assert max(a["contact_force_n"]) > 0.0
    assert len(a["tip_angle_deg"]) >= 5
    for key in ("tip_angle_deg", "joint_rotation_rad", "tip_displacement_m", "volume_m3"):
        np.testing.assert_allclose(b[key], a[key], rtol=1e-4, atol=1e-4 * np.abs(a[key]).max())


def kill_in_mid_sweep(argv, checkpoints: Path, after: int) -> int:
    """Start ``scripts/fea.py``, kill it once it has written some steps; return how many there are."""
    process = subprocess.Popen(
        [sys.executable, "scripts/fea.py", *argv], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    deadline = time.monotonic() + 60.0
    awaited = checkpoints / f"step-{after:04d}.npz"
    while not awaited.exists() and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.005)
    process.kill()
    assert process.wait() == -signal.SIGKILL
    return len(list(checkpoints.glob("step-*.npz")))
