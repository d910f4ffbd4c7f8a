"""Sweeps: each condition changes what it says, and nothing else; table and pictures say what was found."""

import json
from xml.etree import ElementTree

import numpy as np
import pytest

from scripts import grasp_sweep
from softhand_sim.benchmark.plan import BenchmarkPlan, prepare_for
from softhand_sim.benchmark.report import wilson_interval
from softhand_sim.benchmark.store import conditions
from softhand_sim.benchmark.success_plots import success_plots
from softhand_sim.benchmark.sweep import Axis, sweep_points
from softhand_sim.benchmark.sweep_table import sweep_table, trend
from softhand_sim.grasp.protocol import Offsets
from softhand_sim.objects.catalogue import make_object
from softhand_sim.simulation import HandSimulation

BASE = BenchmarkPlan(objects=(make_object("apple"), make_object("tennis_ball")), trials=2)
SVG = "{http://www.w3.org/2000/svg}"


def one(name, value, base=BASE):
    (point,) = sweep_points(base, [Axis(name=name, values=(value,))])
    assert point.values == {name: value}
    return point.plan


def changed(plan):
    before, after = conditions(BASE), conditions(plan)
    return {key for key in after if before[key] != after[key]}


def test_objects_get_another_mass_or_friction():
    assert [model.mass_kg for model in one("mass_kg", 0.5).objects] == [0.5, 0.5]
    assert [model.mass_kg for model in one("mass_scale", 3.0).objects] == pytest.approx([3 * 0.068, 3 * 0.058])
    slippery = one("friction", 0.1)
    assert [model.friction for model in slippery.objects] == [0.1, 0.1]
    assert changed(slippery) == set()


def test_the_closing_pressure_is_what_the_fingers_are_asked_for():
    plan = one("pressure_pa_gauge", 40e3)
    assert changed(plan) == {"protocol"}
    setup = prepare_for(plan, BASE.objects[0])
    asked = setup.protocol.closing_pressures_pa_gauge(setup.calibration, setup.plan.set_angle_deg)
    assert asked == pytest.approx([40e3] * 3)
    own = BASE.protocol.closing_pressures_pa_gauge(setup.calibration, setup.plan.set_angle_deg)
    assert own == pytest.approx([setup.calibration.closing_pressure(a) for a in setup.plan.set_angle_deg])


def test_offsets_are_added_along_their_axis():
    plan = one("offset_y_m", 0.02)
    for seed in range(3):
        moved = plan.protocol.draw_offset(np.random.default_rng(seed), seed)
        stood = BASE.protocol.draw_offset(np.random.default_rng(seed), seed)
        assert np.subtract(moved, stood) == pytest.approx([0.0, 0.02, 0.0])
    assert one("offset_x_m", 0.01).protocol.offsets == Offsets(
        position_m=BASE.protocol.offsets.position_m, yaw_rad=BASE.protocol.offsets.yaw_rad, stated_m=((0.01, 0.0),)
    )


def test_a_leak_lets_the_finger_s_element_lose_gas():
    assert one("leak_thumb_m3_per_s_pa", 0.0).effects.leaks is None
    plan = one("leak_thumb_m3_per_s_pa", 2e-10)
    assert changed(plan) == {"effects"}
    setup = prepare_for(plan, BASE.objects[0])
    simulation = HandSimulation(model=setup.scene.model, calibration=setup.calibration, pneumatics=setup.pneumatics)
    simulation.reset(np.random.default_rng(0), setup.plan.standoff(0.1))
    simulation.set_pressure_pa_gauge = np.full(3, 50e3)
    for _ in range(1000):
        simulation.step()
    thumb, index, _ = simulation.pressure_pa_gauge()
    # a hole of twice the valve's size: the valve cannot keep up
    assert thumb < 0.9 * index
    assert index == pytest.approx(50e3, abs=6e3)


def test_a_calibration_of_another_finger_is_used(tmp_path):
    assert conditions(one("calibration", "shipped")) == conditions(BASE)
    with pytest.raises(FileNotFoundError, match=r"nowhere\.json"):
        one("calibration", str(tmp_path / "nowhere.json"))


@pytest.mark.parametrize(
    ("argv", "told"),
    [
        (["--vary", "colour=1,2"], "colour: no such condition"),
        (["--vary", "friction=0.1,0.1"], "different values"),
        (["--vary", "friction=-0.1"], "friction=-0.1"),
        (["--vary", "mass_kg=heavy"], "NAME=NUMBER"),
        (["--vary", "mass_kg=1", "--vary", "mass_kg=2"], "different conditions"),
        (["--vary", "offset_x_m=0.5"], "offset_x_m=0.5"),
        (["--vary", "pressure_pa_gauge=-1"], "closing_pressure_pa_gauge"),
        (["--vary", "leak_index_m3_per_s_pa=-1"], "leak"),
        (["--vary", "mass_kg=1", "--objects", "unicorn"], "unicorn"),
    ],
)
def test_bad_sweeps_are_refused_before_the_first_trial(argv, told, tmp_path, capsys):
    assert grasp_sweep.main([*argv, "--out", str(tmp_path)]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "sweep.json").exists()


def summary(held, trials=20):
    low, high = wilson_interval(held, trials)
    return {"trials": trials, "held": held, "success_rate": held / trials, "wilson_low": low, "wilson_high": high}


def sweep(counts, second=()):
    axes = [{"name": "mass_kg", "values": [0.1 * (k + 1) for k in range(len(counts))]}]
    if second:
        axes.append({"name": "friction", "values": list(second)})
    rows = []
    for k, line in enumerate(counts):
        for j, held in enumerate(line if second else [line]):
            values = {"mass_kg": axes[0]["values"][k]} | ({"friction": second[j]} if second else {})
            rows.append({"values": values, "objects": {"apple": summary(held)}})
    return {"settings": {"axes": axes, "objects": ["apple"]}, "rows": rows}


def test_the_trend_is_told_by_intervals_that_are_apart():
    assert trend(sweep([20, 19, 8, 0]), "mass_kg", "apple") == "falls"
    assert trend(sweep([0, 8, 20]), "mass_kg", "apple") == "rises"
    assert trend(sweep([18, 17, 19]), "mass_kg", "apple") == "level"
    assert trend(sweep([20, 0, 20]), "mass_kg", "apple") == "both"
    surface = sweep([[2, 20], [0, 10]], second=(0.2, 0.8))
    assert trend(surface, "mass_kg", "apple") == "falls"
    assert trend(surface, "friction", "apple") == "rises"
    assert "| 200 | 0.8 | 10/20 (0.30-0.70) |" in sweep_table(surface)


def test_pictures_show_every_point_where_it_belongs():
    (curve,) = success_plots(sweep([20, 10, 0])).values()
    dots = [dot for dot in ElementTree.fromstring(curve).iter(f"{SVG}circle")][:3]
    heights = [float(dot.get("cy")) for dot in dots]
    # the middle one halfway: 1, 0.5, 0
    assert heights[0] < heights[1] < heights[2]
    assert heights[1] == pytest.approx((heights[0] + heights[2]) / 2, abs=0.1)
    plots = success_plots(sweep([[2, 20], [0, 10]], second=(0.2, 0.8)))
    assert list(plots) == ["success_apple"]
    texts = [text.text for text in ElementTree.fromstring(plots["success_apple"]).iter(f"{SVG}text")]
    assert {"0.10", "1.00", "0.00", "0.50", "0.30 - 0.70", "mass (g)", "friction"} <= set(texts)


def test_a_sweep_goes_on_where_it_was_and_keeps_its_rows(tmp_path, monkeypatch):
    protocol = tmp_path / "quick.toml"
    protocol.write_text(
        'source = "test"\napproach_m = 0.05\nclose_s = 0.2\nsettle_s = 0.05\n'
        '[[phase]]\ndo = "lift"\nheight_m = 0.03\n[[phase]]\ndo = "hold"\nduration_s = 0.1\n',
        encoding="utf-8",
    )
    argv = ["--objects", "golf_ball", "--vary", "mass_scale=1,2", "--trials", "1", "--protocol", str(protocol)]
    argv += ["--out", str(tmp_path / "out")]
    assert grasp_sweep.main(argv) == 0
    first = json.loads((tmp_path / "out" / "sweep.json").read_text())
    monkeypatch.setattr("softhand_sim.benchmark.plan.run_trial", None)  # nothing is run again
    assert grasp_sweep.main(argv) == 0
    assert json.loads((tmp_path / "out" / "sweep.json").read_text()) == first
    assert [row["trials"][0]["mass_kg"] for row in first["rows"]] == pytest.approx([0.046, 0.092])
    assert (tmp_path / "out" / "success.svg").is_file()
    assert "| mass scale |" in (tmp_path / "out" / "table.md").read_text()
