"""``scripts/finger_table.py``: the tables from made-up runs, one real run, and one line on bad input."""

import json
import math
from dataclasses import replace

import pytest

from fea.geometry import FingerGeometry
from scripts import _finger_markdown as markdown
from scripts import finger_table
from scripts._finger_runs import DIED, Case, execute

TINY = ["--dimension", "ring_count=2", "--to", "1"]


def made_up(angle_at_75, **more):
    """A run whose angle is proportional to the pressure."""
    case = {
        "mesh": "coarse",
        "formulation": "P2",
        "volumetric": "d1_literal",
        "silicone_set": "set1",
        "tpu_set": "set3",
    }
    run = {
        "case": case | {k: more.pop(k) for k in list(more) if k in case},
        "branch": ["loading"] * 3,
        "pressure_pa_gauge": [0.0, 15e3, 75e3],
        "tip_angle_deg": [0.0, 0.2 * angle_at_75, angle_at_75],
        "volume_m3": [2e-6, 2.1e-6, 3e-6],
        "status": "converged",
        "dofs": 1000,
        "newton_iterations": 70,
        "wall_s": 41.0,
        "peak_memory_bytes": 2_500_000_000,
    }
    return run | more


def cells(text):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]


def test_convergence_compares_with_the_finest_quadratic_run_of_the_same_reading():
    runs = [
        made_up(99.0, dofs=1000),
        made_up(100.0, dofs=9000, mesh="reference"),
        made_up(3.0, dofs=20000, formulation="P1"),
        made_up(50.0, dofs=9000, volumetric="near_incompressible"),
        made_up(0.0, status="stalled", pressure_pa_gauge=[0.0, 15e3, 30e3], dofs=99000),
        {"case": made_up(1.0)["case"], "status": DIED, "message": "killed"},
    ]
    table = cells(markdown.convergence(runs, [15e3, 75e3]))
    assert len({len(row) for row in table}) == 1
    head, body = table[0], table[2:]
    angle, change = head.index("75 kPa, degrees"), head.index("angle, change")
    assert [row[angle] for row in body] == ["99.00", "100.00", "3.00", "50.00", "-", "-"]
    assert [row[change] for row in body] == ["-1.00 %", "finest", "-97.00 %", "finest", "-", "-"]
    assert body[0][head.index("volume at 75 kPa, ml")] == "3.000"
    assert body[0][head.index("memory, GB")] == "2.50"
    assert [row[-1] for row in body[-2:]] == ["stalled, 30 kPa", "died: killed"]


def test_slope_is_that_of_the_outermost_points():
    assert markdown.slope_per_unit(10.0, [(-1.0, 8.0), (1.0, 14.0)]) == pytest.approx(3.0)
    assert markdown.slope_per_unit(10.0, [(-1.0, None), (1.0, 14.0)]) == pytest.approx(4.0)
    assert markdown.slope_per_unit(None, [(-1.0, 8.0), (1.0, 14.0)]) == pytest.approx(3.0)
    assert markdown.slope_per_unit(10.0, [(-1.0, None), (1.0, None)]) is None


def test_sensitivity_of_a_power_law_is_its_exponent():
    """Angle ~ gap^2 / sector: 2 % and -1 % per per cent, and the slopes in their units."""
    geometry, start = FingerGeometry(), 90.0
    runs = []
    for name, exponent in (("gap_length_m", 2.0), ("sector_half_angle_rad", -1.0), ("tube_wall_m", 1.0)):
        for sign in (-1.0, 1.0):
            about, changed = finger_table.varied(geometry, name, sign, percent=2.0, by_mm=None)
            angle = start * (1.0 + 0.02 * sign) ** exponent
            runs.append(about if changed is None else made_up(angle) | about)
    gap, sector, wall = cells(markdown.sensitivity(made_up(start), runs, 75e3))[2:]
    assert float(gap[4]) == pytest.approx(2.0, abs=0.01)
    assert float(gap[5]) == pytest.approx(2.0 * start / geometry.gap_length_m * 1e-4, rel=0.01)
    assert float(sector[4]) == pytest.approx(-1.0, abs=0.01)
    assert float(sector[5]) == pytest.approx(-start / math.degrees(geometry.sector_half_angle_rad), rel=0.01)
    # the default is the thinnest wall allowed: one side only, and the reason for it
    assert float(wall[4]) == pytest.approx(1.0, abs=0.01)
    assert "invalid: tube_wall_m = 0.00196 m must be at least 0.002" in wall[-1]
    assert gap[-1] == ""


def test_gap_starts_are_shifted_together_and_angles_by_an_arc():
    geometry = FingerGeometry()
    _, shifted = finger_table.varied(geometry, "gap_start_m", 1.0, percent=None, by_mm=0.1)
    moved = [b - a for a, b in zip(geometry.gap_start_m, shifted.gap_start_m, strict=True)]
    assert moved == pytest.approx([1e-4] * 3)
    about, _ = finger_table.varied(geometry, "sector_half_angle_rad", -1.0, percent=None, by_mm=0.1)
    assert about["change"] * geometry.tube_outer_radius_m == pytest.approx(-1e-4)


def test_every_length_and_angle_of_the_geometry_is_open_and_the_paper_s_ring_count_is_not():
    names = finger_table.open_dimensions(FingerGeometry())
    assert set(FingerGeometry().as_dict()) - set(names) == {"ring_count"}


def test_branches_are_compared_at_equal_pressures():
    run = made_up(90.0)
    assert markdown.hysteresis_deg(run) is None
    run["branch"] += ["unloading"] * 2
    run["pressure_pa_gauge"] += [15e3, 7e3]
    run["tip_angle_deg"] += [20.5, 11.0]
    assert markdown.hysteresis_deg(run) == pytest.approx(2.5)
    row = cells(markdown.materials([run], [15e3, 75e3, 80e3]))[2]
    assert row[:7] == ["set1", "set3", "coarse", "18.0", "90.0", "-", "2.50"]


def test_levels_end_at_the_highest_pressure():
    assert finger_table.levels([15e3, 30e3, 75e3], 30e3) == [15e3, 30e3]
    assert finger_table.levels([15e3, 30e3, 75e3], 40e3) == [15e3, 30e3, 40e3]
    assert finger_table.levels([15e3], 5e3) == [5e3]


def test_runs_are_kept_one_by_one_and_not_repeated(tmp_path, capsys, monkeypatch):
    file = tmp_path / "runs.json"
    argv = ["convergence", "--meshes", "coarse", "--volumetric", "d1_literal", *TINY, "--json", str(file)]
    assert finger_table.main([*argv, "--formulations", "P1"]) == 0
    first = json.loads(file.read_text())["runs"]
    assert len(first) == 1
    assert first[0]["pressure_pa_gauge"] == [0.0, 1000.0]
    assert first[0]["tip_angle_deg"][1] > 0.0
    assert first[0]["status"] == "converged"
    assert 5e7 < first[0]["peak_memory_bytes"] < 8e9

    seen = []

    def quickly(case, report):  # noqa: ARG001 - the signature of the real one
        seen.append(case.formulation)
        return made_up(75.0) | {"case": case.as_dict()}

    monkeypatch.setattr(finger_table, "execute", quickly)
    capsys.readouterr()
    assert finger_table.main([*argv, "--formulations", "P1", "P2"]) == 0
    assert seen == ["P2"]
    kept = json.loads(file.read_text())["runs"]
    assert kept[0] == first[0]
    assert len(kept) == 2
    assert len(cells(capsys.readouterr().out)) == 4
    # a table of another kind does not overwrite them
    assert finger_table.main(["materials", *TINY, "--json", str(file)]) == 2
    assert "another table" in capsys.readouterr().err
    assert json.loads(file.read_text())["runs"] == kept


def test_contact_refused_in_the_run_s_process_is_a_result():
    geometry = replace(FingerGeometry(), ring_count=2, clearance_m=0.08e-3)
    run = execute(Case(geometry=geometry, pressures_pa_gauge=(1e3,), formulation="P1"))
    assert run["status"] == "invalid"
    assert "must be below the smallest gap at rest" in run["message"]


@pytest.mark.parametrize(
    ("argv", "told"),
    [
        (["dance"], "dance"),
        (["convergence", "--meshes", "infinite"], "--meshes"),
        (["convergence", "--to", "-5"], "--to"),
        (["convergence", "--percent", "3"], "--percent: not an option of convergence"),
        (["materials", "--formulations", "P1"], "--formulations: not an option of materials"),
        (["materials", "--silicone-sets", "set9"], "--silicone-sets"),
        (["sensitivity", "--percent", "3", "--by-mm", "0.1"], "--percent, --by-mm"),
        (["sensitivity", "--only", "colour"], "--only colour: no such dimension; allowed: actuator_inner_radius_m"),
        (["sensitivity", "--meshes", "coarse", "calibration"], "sensitivity takes one"),
        (["surrogate", "--dimension", "tube_wall_m=0.001"], "tube_wall_m = 0.001 m"),
        (["surrogate", "--friction", "-1"], "--friction"),
        (["surrogate", "--friction", "3"], "friction = 3.0 must be from 0 to 2"),
        (["surrogate", "--json", "/proc/none/a.json"], "--json"),
    ],
)
def test_bad_input_is_one_line_before_any_run(argv, told, capsys, monkeypatch):
    monkeypatch.setattr(finger_table, "execute", lambda *_: pytest.fail("a run was started"))
    try:
        status = finger_table.main(argv)
    except SystemExit as stop:  # argparse
        status = stop.code
    lines = capsys.readouterr().err.strip().splitlines()
    assert status == 2
    assert len(lines) == 1, lines
    assert told in lines[0]


def test_a_file_of_something_else_is_not_overwritten(tmp_path, capsys):
    file = tmp_path / "notes.json"
    file.write_text('{"notes": []}')
    assert finger_table.main(["surrogate", "--json", str(file)]) == 2
    assert "not a file of this program" in capsys.readouterr().err
    assert file.read_text() == '{"notes": []}'


def test_a_killed_run_is_told_and_tried_again(tmp_path, capsys, monkeypatch):
    file = tmp_path / "runs.json"
    dead = {"status": DIED, "message": "the run's process ended with -9"}
    monkeypatch.setattr(finger_table, "execute", lambda case, _: dead | {"case": case.as_dict()})
    argv = ["surrogate", *TINY, "--json", str(file)]
    assert finger_table.main(argv) == 1
    assert "ended with -9" in capsys.readouterr().err
    assert json.loads(file.read_text())["runs"] == []
