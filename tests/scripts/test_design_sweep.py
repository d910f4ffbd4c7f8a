"""``scripts/design_sweep.py`` with a stand-in for the analyses: rows, reasons, resumption, refusals."""

import json

import numpy as np
import pytest
from PIL import Image

from assets import asset_path
from fea.finger_design import load_design
from fea.geometry import FingerGeometry
from fea.store import Solved
from scripts import _sweep_report
from scripts._sweep_points import Variable, designs, variable
from scripts.design_sweep import main
from softhand_sim.benchmark.report import wilson_interval

SHIPPED = json.loads((asset_path("calibration") / "finger.json").read_text())
LIMIT_PA = 60e3


class StandIn:
    """The shipped calibration; a finger whose flexure is 20 % thicker ends early, one of set 1 is refused."""

    def __init__(self):
        self.runs = 0

    def __call__(self, design, density, *, choose=False, progress=lambda: None):  # noqa: ARG002 - the signature
        self.runs += 1
        if design.materials.silicone.parameter_set == "set1":
            raise ValueError("finger.pressure_pa_gauge: 4 usable converged states: a calibration needs at least 6")
        made = {k: v for k, v in SHIPPED.items() if k != "content_sha256"}
        made |= {"geometry": design.geometry.as_dict()}
        if design.geometry.flexure_thickness_m > 1.1 * FingerGeometry().flexure_thickness_m:
            kept = sum(p <= LIMIT_PA for p in made["curve"]["pressure_pa_gauge"])
            made["curve"] = {name: values[:kept] for name, values in made["curve"].items()}
            finger = made["fea"]["finger"]
            kept = next(k for k, p in enumerate(finger["pressure_pa_gauge"]) if p > LIMIT_PA)
            cut = {k: v[:kept] if isinstance(v, list) else v for k, v in finger.items()}
            made["fea"] = {**made["fea"], "finger": cut | {"status": "limit point"}}
        return Solved(artifact=made, report={})


@pytest.fixture
def stand_in():
    return StandIn()


@pytest.fixture
def sweep(tmp_path, stand_in):
    def run(*arguments):
        return main([*arguments, "--store", str(tmp_path / "store"), "--out", str(tmp_path / "out")], stand_in)

    return run


def test_one_finger_from_its_file_to_its_grasp_table(sweep, tmp_path, capsys):
    (tmp_path / "mine.toml").write_text("[geometry]\ntube_wall_m = 2.5e-3\n")
    figures = tmp_path / "rows.json"
    argv = ["--finger", str(tmp_path / "mine.toml"), "--objects", "apple", "--trials", "1", "--json", str(figures)]
    assert sweep(*argv, "--pressures", "60,75") == 0
    (row,) = json.loads(figures.read_text())["rows"]
    shipped = SHIPPED["curve"]
    assert row["tip_angle_deg"][1] == shipped["tip_angle_deg"][shipped["pressure_pa_gauge"].index(75e3)]
    finger = SHIPPED["fea"]["finger"]
    at_75 = finger["tip_angle_rad"][finger["pressure_pa_gauge"].index(75e3)]
    assert row["fea_tip_angle_deg"][1] == pytest.approx(np.rad2deg(at_75))
    assert row["tip_force_n"][1] > row["tip_force_n"][0] > 0.0
    assert row["objects"]["apple"]["held"] == 1
    assert row["process_s"] > 0.0
    assert json.loads((tmp_path / "out" / "finger-00.json").read_text())["geometry"]["tube_wall_m"] == 2.5e-3
    table = (tmp_path / "out" / "table.md").read_text()
    assert table == capsys.readouterr().out
    low, high = wilson_interval(1, 1)
    assert f"| 1/1 ({low:.2f}-{high:.2f}) |" in table
    assert not (tmp_path / "out" / "sweep.png").exists()


def test_a_finger_that_fails_is_a_row_with_its_reason(sweep, stand_in, tmp_path, capsys):
    argv = [
        *("--vary", "silicone=ecoflex-00-50/set1,ecoflex-00-50/set3"),
        *("--vary", "flexure_thickness_m=0.0033,0.004", "--objects", "none"),
    ]
    assert sweep(*argv) == 0
    rows = json.loads((tmp_path / "out" / "sweep.json").read_text())["rows"]
    assert [row["values"]["flexure_thickness_m"] for row in rows] == [0.0033, 0.004] * 2
    assert all(row["ended"].startswith("no result: finger.pressure_pa_gauge: 4 usable") for row in rows[:2])
    assert rows[2]["ended"] == "converged, 80 kPa"
    last = max(p for p in SHIPPED["fea"]["finger"]["pressure_pa_gauge"] if p <= LIMIT_PA)
    assert rows[3]["ended"] == f"limit point, {1e-3 * last:g} kPa"
    # 75 kPa lies beyond what the last finger reached: no number rather than an extrapolated one
    assert rows[3]["tip_angle_deg"] == rows[3]["tip_force_n"] == rows[3]["fea_tip_angle_deg"] == [None]
    assert rows[3]["closing_pressure_pa_gauge"] == LIMIT_PA
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("| silicone | flexure_thickness (mm) | 75 kPa, degrees |")
    assert lines[3].startswith("| ecoflex-00-50/set1 | 4 | - | - | - |")
    picture = np.asarray(Image.open(tmp_path / "out" / "sweep.png").convert("L"))
    assert picture.shape[0] > 500
    assert (picture < 128).mean() > 0.005
    # again: nothing is solved, neither those that worked nor those that failed
    assert stand_in.runs == 4
    assert sweep(*argv) == 0
    assert stand_in.runs == 4
    again = json.loads((tmp_path / "out" / "sweep.json").read_text())["rows"]
    assert [row.get("from_store") for row in again] == [None, None, True, True]


def test_no_result_at_all_is_a_status(sweep):
    assert sweep("--vary", "silicone=ecoflex-00-50/set1", "--objects", "none", "--no-plot") == 1


def test_a_combination_that_cannot_be_is_a_row_and_a_value_that_never_can_is_refused():
    base = load_design(asset_path("fingers", "default.toml"))
    walls, flexures = Variable(name="tube_wall_m", values=(2e-3, 3.5e-3)), (3.3e-3, 3.6e-3)
    made = designs(base, [walls, Variable(name="flexure_thickness_m", values=flexures)])
    assert [isinstance(design, ValueError) for _, design in made] == [False, False, True, False]
    assert made[1][1].geometry.flexure_thickness_m == 3.6e-3
    with pytest.raises(ValueError, match=r"--vary tube_wall_m=0\.0035: flexure_thickness_m = 0\.0033 must be at least"):
        designs(base, [walls])


def test_variables_have_their_kinds():
    assert variable("ring_count=30,44") == Variable(name="ring_count", values=(30, 44))
    assert variable("tpu = ninjaflex/set1".replace(" ", "")) == Variable(name="tpu", values=("ninjaflex/set1",))
    assert _sweep_report.label("sector_half_angle_rad") == "sector_half_angle (degrees)"
    assert _sweep_report.shown("gap_length_m", 5e-3) == "5"


@pytest.mark.parametrize(
    ("argv", "told"),
    [
        (["--vary", "colour=red"], "--vary colour: no such parameter; allowed: actuator_inner_radius_m"),
        (["--vary", "tube_wall_m=thick"], "--vary tube_wall_m=thick: must read NAME=VALUE,VALUE with float values"),
        (["--vary", "ring_count=30.5"], "--vary ring_count=30.5"),
        (["--vary", "tube_wall_m=2.5"], "--vary tube_wall_m=2.5: tube_wall_m = 2.5 m must lie in (0, 0.3) m"),
        (["--vary", "tube_wall_m=0.002,0.002"], "a value is there twice"),
        (["--vary", "ring_count=30", "--vary", "ring_count=40"], "given twice"),
        (["--vary", "ring_count=30", "--vary", "tpu=pet", "--vary", "gap_length_m=0.005"], "at most 2"),
        (["--vary", "tpu=ninjaflex/set9"], "sets has no 'set9'"),
        (["--pressures", "75,60"], "--pressures 75,60: must increase"),
        (["--pressures", "ten"], "--pressures ten: must be numbers"),
        (["--objects", "unicorn"], "--objects: 'unicorn' is not in the catalogue"),
        (["--finger", "absent.toml"], "no finger file absent.toml"),
    ],
)
def test_bad_input_is_one_line_before_any_analysis(sweep, stand_in, capsys, argv, told):
    assert sweep(*argv) == 2
    captured = capsys.readouterr()
    assert told in captured.err
    assert len(captured.err.strip().splitlines()) == 1
    assert captured.out == ""
    assert stand_in.runs == 0
