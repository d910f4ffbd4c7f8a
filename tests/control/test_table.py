"""Angle to pressure: the table, its C header, and what both refuse."""

import re

import numpy as np
import pytest

from scripts.export_controller import main
from softhand_sim.calibration import load_calibration
from softhand_sim.control.c_header import c_header
from softhand_sim.control.onoff import OnOffController
from softhand_sim.control.table import AngleTable
from softhand_sim.pneumatics.sensor import PressureSensor

TABLE = AngleTable(angle_deg=(0.0, 30.0, 95.0), pressure_pa_gauge=(0.0, 20e3, 75e3))


def header(table=TABLE, **controller):
    return c_header(table, OnOffController(**controller), PressureSensor(), 0.02)


def parsed(text):
    """Constants and arrays of a header, read as C would read them."""
    constants = {k: int(v) for k, v in re.findall(r"^#define (\w+) (\d+)$", text, re.M)}
    arrays = {}
    for kind, name, body in re.findall(r"static const (\w+) (\w+)\[SOFTHAND_TABLE_ROWS\] = \{(.*?)\};", text, re.S):
        values = [v.strip() for v in body.split(",") if v.strip()]
        if kind == "float":
            assert all(re.fullmatch(r"\d+(\.\d+)?(e[+-]?\d+)?f", v) and re.search(r"[.e]", v) for v in values)
        arrays[name] = [float(v.rstrip("f")) for v in values]
        assert len(values) == constants["SOFTHAND_TABLE_ROWS"]
    return constants, arrays


def test_each_element_has_its_own_angle():
    assert TABLE.pressures([0.0, 62.5, 95.0]) == pytest.approx((0.0, 47.5e3, 75e3), rel=1e-12)


def test_table_is_the_calibration_curve():
    calibration = load_calibration()
    table = AngleTable.of(calibration)
    for angle in np.linspace(*calibration.curve.tip_angle_deg[[0, -1]], 101).tolist():
        assert table.pressure(angle) == pytest.approx(calibration.pressure_for_angle(angle), rel=1e-9, abs=1e-6)
    assert AngleTable.of(calibration, 5).angle_deg == pytest.approx(
        np.linspace(calibration.curve.tip_angle_deg[0], calibration.curve.tip_angle_deg[-1], 5)
    )


def test_header_holds_the_table_and_the_counts_of_the_sensor():
    text = header(minimum_pulse_ticks=3)
    constants, arrays = parsed(text)
    assert constants == {
        "SOFTHAND_TABLE_ROWS": 3,
        "SOFTHAND_TICK_MS": 20,
        "SOFTHAND_MINIMUM_PULSE_TICKS": 3,
        # 0.004 x 101.325 - 0.04 of 1024
        "SOFTHAND_AMBIENT_COUNTS": 374,
        "SOFTHAND_DEAD_BAND_COUNTS": 2,
    }
    assert arrays["SOFTHAND_ANGLE_DEG"] == list(TABLE.angle_deg)
    assert arrays["SOFTHAND_PRESSURE_PA_GAUGE"] == list(TABLE.pressure_pa_gauge)
    assert arrays["SOFTHAND_SET_COUNTS"] == [374, 455, 681]
    assert text == header(minimum_pulse_ticks=3)
    assert text.count("{") == text.count("}")
    assert text.count("(") == text.count(")")
    guard = re.search(r"#ifndef (\w+)\n#define (\w+)\n", text)
    assert guard is not None
    assert guard[1] == guard[2]
    assert text.rstrip().endswith("#endif")


def test_floats_of_the_header_are_those_of_the_table():
    table = AngleTable.of(load_calibration())
    _, arrays = parsed(header(table))
    for name, values in (("ANGLE_DEG", table.angle_deg), ("PRESSURE_PA_GAUGE", table.pressure_pa_gauge)):
        np.testing.assert_array_equal(np.float32(arrays[f"SOFTHAND_{name}"]), np.float32(values))


def test_script_writes_header_and_json(tmp_path, capsys):
    out, json = tmp_path / "a" / "c.h", tmp_path / "c.json"
    assert main(["--out", str(out), "--rows", "4", "--angles", "10,20,30", "--json", str(json)]) == 0
    assert parsed(out.read_text())[0]["SOFTHAND_TABLE_ROWS"] == 4
    assert "set_pressure_pa_gauge" in json.read_text()
    assert "thumb" in capsys.readouterr().out
    for bad in (["--angles", "10,20,500"], ["--rows", "1"], ["--angles", "10,20"]):
        target = tmp_path / "none.h"
        assert main(["--out", str(target), *bad]) == 2
        assert not target.exists()
        assert "error" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("angles", "named"),
    [([0.0, 1.0], "set_angle_deg"), ([0.0, 96.0, 1.0], "index.*0 to 95"), ([0.0, 1.0, float("nan")], "middle_ring")],
)
def test_angles_outside_the_table_are_named(angles, named):
    with pytest.raises(ValueError, match=named):
        TABLE.pressures(angles)


def test_bad_tables_are_named():
    with pytest.raises(ValueError, match="2 or more"):
        AngleTable(angle_deg=(0.0,), pressure_pa_gauge=(0.0,))
    with pytest.raises(ValueError, match="angle_deg"):
        AngleTable(angle_deg=(0.0, 0.0), pressure_pa_gauge=(0.0, 1.0))
    with pytest.raises(ValueError, match="pressure_pa_gauge"):
        AngleTable(angle_deg=(0.0, 1.0), pressure_pa_gauge=(1.0, 1.0))
    with pytest.raises(ValueError, match="sensor"):
        header(AngleTable(angle_deg=(0.0, 1.0), pressure_pa_gauge=(0.0, 200e3)))
    with pytest.raises(ValueError, match="tick_s"):
        c_header(TABLE, OnOffController(), PressureSensor(), 0.0205)
