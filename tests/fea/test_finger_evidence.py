"""Evidence from made-up runs: what is taken, what is refused, and that the runtime reads what is written."""

import copy
import json
from dataclasses import replace

import numpy as np
import pytest

from fea.calibration import load_materials
from fea.density import DENSITIES
from fea.evidence import RUNS, TIP_LOADS, check_run, evidence
from fea.geometry import FingerGeometry
from fea.study import Setup
from fea.weight_evidence import WEIGHT_RUNS, weight_evidence
from scripts import finger_evidence
from softhand_sim.calibration import load_evidence, load_weight_evidence

ALL = RUNS | WEIGHT_RUNS


def setup_of(name: str) -> Setup:
    materials = load_materials()
    return Setup(
        geometry=FingerGeometry(),
        silicone=materials.silicone,
        tpu=materials.tpu,
        pet=materials.pet,
        density=DENSITIES["calibration"],
        finger=ALL[name].case,
    )


def figures(name: str) -> dict:
    """What a run would write of a finger that turns by a degree a kilopascal, and back by one a hundredth newton."""
    setup = setup_of(name)
    path = setup.finger.path(ALL[name].pressures_pa_gauge)
    targets = [0.0, *path.targets]
    pressure, load = np.array([(path.pressure(t), path.tip_load(t)) for t in targets]).T
    angle = np.radians(1e-3 * pressure - 100.0 * load)[:, None] / 3.0 * np.ones(3)
    return {
        "branch": [path.branch(t) for t in targets],
        "pressure_pa_gauge": pressure.tolist(),
        "tip_load_n": load.tolist(),
        "joint_rotation_rad": angle.tolist(),
        "tip_displacement_m": (0.05 * angle.sum(axis=1)).tolist(),
        "volume_m3": (2.5e-6 + 1e-11 * pressure).tolist(),
        "tip_force_n": np.maximum(0.0, 6e-6 * (pressure - 40e3)).tolist(),
        "status": "converged",
        **dict.fromkeys(("dofs", "elements", "newton_iterations", "wall_s"), 1),
        "provenance": json.loads(json.dumps(setup.provenance())),
    }


@pytest.fixture(scope="module")
def runs() -> dict[str, dict]:
    return {name: figures(name) for name in ALL}


@pytest.mark.parametrize("name", list(ALL))
def test_a_run_is_taken_for_what_it_is_only(runs, name):
    run = ALL[name]
    check_run(name, run, runs[name], setup_of(name), any_code=False)
    cut = copy.deepcopy(runs[name])
    cut["pressure_pa_gauge"] = cut["pressure_pa_gauge"][:-1]
    with pytest.raises(ValueError, match=f"{name}: pressure_pa_gauge is not that of this run"):
        check_run(name, run, cut, setup_of(name), any_code=True)
    thick = replace(setup_of(name), geometry=replace(FingerGeometry(), tube_wall_m=0.0021))
    with pytest.raises(ValueError, match=r"provenance\.geometry"):
        check_run(name, run, runs[name], thick, any_code=True)
    rough = replace(run, case=replace(run.case, friction=0.4))
    with pytest.raises(ValueError, match=r"provenance\.finger"):
        check_run(name, rough, runs[name], setup_of(name), any_code=True)
    old = copy.deepcopy(runs[name])
    old["provenance"]["code_sha256"] = "0"
    check_run(name, run, old, setup_of(name), any_code=True)
    with pytest.raises(ValueError, match=r"provenance\.code_sha256"):
        check_run(name, run, old, setup_of(name), any_code=False)


def test_runs_of_code_without_gravity_are_those_without_weight(runs):
    for name in ("cycle", "palm down"):
        old = copy.deepcopy(runs[name])
        old["provenance"]["code_sha256"] = "0"
        del old["provenance"]["finger"]["gravity_m_per_s2"]
        if name == "cycle":
            check_run(name, ALL[name], old, setup_of(name), any_code=True)
            continue
        with pytest.raises(ValueError, match=r"provenance\.finger"):
            check_run(name, ALL[name], old, setup_of(name), any_code=True)


def test_finished_runs_under_gravity_become_a_file_that_the_runtime_reads(runs, tmp_path):
    for name in WEIGHT_RUNS:
        (tmp_path / f"{name.replace(' ', '_')}.json").write_text(json.dumps(runs[name]))
    out = tmp_path / "weight_evidence.json"
    assert finger_evidence.main(["weight", "--runs", str(tmp_path), "--out", str(out)]) == 0
    assert json.loads(out.read_text()) == weight_evidence({name: runs[name] for name in WEIGHT_RUNS})
    read = load_weight_evidence(out)
    assert [attitude.name for attitude in read.attitudes] == list(WEIGHT_RUNS)
    for attitude in read.attitudes:
        assert attitude.gravity_m_per_s2 == pytest.approx(WEIGHT_RUNS[attitude.name].case.gravity_m_per_s2)
        assert attitude.tip_angle_deg == pytest.approx(1e-3 * attitude.pressure_pa_gauge)


def test_finished_runs_become_a_file_that_the_runtime_reads(runs, tmp_path):
    bench = {name: runs[name] for name in RUNS}
    for name, run in bench.items():
        (tmp_path / f"{name}.json").write_text(json.dumps(run))
    out = tmp_path / "evidence.json"
    assert finger_evidence.main(["--runs", str(tmp_path), "--out", str(out)]) == 0
    assert json.loads(out.read_text()) == evidence(bench)
    read = load_evidence(out)
    assert read.geometry == json.loads(json.dumps(FingerGeometry().as_dict()))
    assert read.cycle.tip_angle_deg == pytest.approx(1e-3 * read.cycle.pressure_pa_gauge)
    assert read.blocked.tip_force_n.max() == pytest.approx(0.24)
    assert len(read.tip_loads) == len(TIP_LOADS)
    for test in read.tip_loads:
        assert test.tip_load_n[0] == 0.0
        assert test.deflection_m == pytest.approx(0.05 * np.radians(100.0 * test.tip_load_n))
