"""The paper's facts of analyses (i) and (ii), and what the studies report beside them."""

from dataclasses import replace

import numpy as np
import pytest

from fea.actuator import SILICONE
from fea.density import DENSITIES
from fea.fields import node_strain
from fea.newton import Status
from fea.path import Sweep
from fea.study import Setup, actuator_study, exoskeleton_study


def setup(geometry, materials, **changes):
    given = {"geometry": geometry, "silicone": materials.silicone, "tpu": materials.tpu, "pet": materials.pet}
    return Setup(**({**given, "density": DENSITIES["coarse"]} | changes))


def short(geometry):
    length = 6 * geometry.ring_pitch_m + geometry.cap_thickness_m
    gaps = (2.1e-3, 4.3e-3, 6.5e-3)  # no part of the actuator
    return replace(geometry, ring_count=6, actuator_length_m=length, gap_start_m=gaps, gap_length_m=1e-4)


@pytest.fixture(scope="module")
def steps():
    return []


@pytest.fixture(scope="module")
def inflated(geometry, materials, steps):
    return actuator_study(setup(short(geometry), materials), [4e3, 8e3], Sweep(on_step=steps.append))


def test_actuator_s_highest_strain_is_at_the_inner_surface(inflated, geometry):
    """Alves et al., section 3.2."""
    radius = inflated.figures["max_von_mises_strain_radius_m"]
    assert radius[0] is None
    assert radius[1:] == pytest.approx([geometry.actuator_inner_radius_m] * 2)


def test_strain_falls_from_the_inner_surface_outwards_away_from_the_cap(inflated, geometry):
    cylindrical = inflated.model.mesh.cylindrical
    strain = node_strain(inflated.model, inflated.states[-1], SILICONE)
    middle = np.abs(cylindrical[:, 2] - 0.5 * short(geometry).chamber_length_m) <= 1.01 * geometry.ring_pitch_m
    radii = (geometry.actuator_inner_radius_m, geometry.ring_radius_m, geometry.actuator_outer_radius_m)
    inner, middle_wall, outer = (strain[middle & np.isclose(cylindrical[:, 0], r, atol=1e-6)].mean() for r in radii)
    assert inner > 1.2 * middle_wall
    assert middle_wall > outer


def test_wall_thins_as_the_actuator_lengthens(inflated, geometry, materials):
    """Incompressible: wall area times stretch is constant, which ties wall, radius and stretch together."""
    f, g = inflated.figures, short(geometry)
    outer = g.actuator_outer_radius_m * (1.0 + np.array(f["outer_radius_growth"]))
    inner = outer - np.array(f["wall_thickness_m"])
    area = (outer**2 - inner**2) / (g.actuator_outer_radius_m**2 - g.actuator_inner_radius_m**2)
    assert (np.diff(f["wall_thickness_m"]) < 0.0).all()
    assert (np.diff(f["axial_stretch"]) > 0.0).all()
    # mid-length, between rings, against the whole chamber with its stiff ends
    assert area * f["axial_stretch"] == pytest.approx(np.ones(3), abs=0.03)
    without = actuator_study(setup(g, materials, rings=False), [5e3], Sweep()).figures
    assert without["outer_radius_growth"][1] > 5.0 * abs(f["outer_radius_growth"][1])


def test_exoskeleton_s_stress_maximum_is_at_the_proximal_joint(geometry, materials):
    """Alves et al., section 3.2."""
    study = exoskeleton_study(setup(geometry, materials), (0.07, 0.16), Sweep())
    f = study.figures
    assert study.status is Status.CONVERGED
    assert f["load_n"] == pytest.approx([0.0, 0.07, 0.16])
    assert f["stress_maximum_at"] == ["proximal"] * 3
    assert (np.diff(f["max_von_mises_stress_pa"]) > 0.0).all()
    assert len(study.states) == len(f["joint_rotation_rad"]) == 3


def test_resumed_path_repeats_the_unbroken_one(inflated, steps, geometry, materials):
    """It goes on with the same step size, so even the iterations agree, but for one that rounding may decide."""
    again = []
    first = [step for step in steps if step.parameter <= 4e3]
    resume = Sweep(resume=first, on_step=again.append)
    study = actuator_study(setup(short(geometry), materials), [4e3, 8e3], resume)
    assert len(first) + len(again) == len(steps)
    assert abs(study.figures["newton_iterations"] - inflated.figures["newton_iterations"]) <= 1
    for key in ("pressure_pa_gauge", "axial_stretch", "volume_m3", "max_von_mises_strain"):
        np.testing.assert_allclose(study.figures[key], inflated.figures[key], rtol=1e-6)


def test_costs_are_parts_of_the_whole(inflated):
    f = inflated.figures
    assert f["assembly_s"] > 0.0
    assert f["solve_s"] > 0.0
    assert f["contact_s"] == 0.0
    assert f["assembly_s"] + f["solve_s"] <= f["wall_s"]
    assert f["newton_iterations"] >= 2
    assert f["dofs"] == len(inflated.model.free)


def test_iterations_reported_are_those_counted(geometry, materials):
    seen, steps = [], []
    sweep = Sweep(on_iteration=lambda *report: seen.append(report), on_step=steps.append)
    study = actuator_study(setup(short(geometry), materials), [2e3], sweep)
    # each solve ends with one residual more than it has iterations
    assert len(seen) == study.figures["newton_iterations"] + len(steps)
    assert {parameter for parameter, _, _ in seen} == {2e3}
    assert steps[-1].residual == seen[-1][2] <= 1e-6
