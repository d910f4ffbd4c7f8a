"""What must hold for any gas, any object, any trial: no crash, no silent NaN, only typed errors.

A property takes plain numbers and words, so that an example that fails is a JSON file. `ValueError` is the typed error
of bad input; anything else that is raised, a figure that is not finite, and a result that breaks a bound is a failure.
"""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from softhand_sim.elements import FINGERS, FINGERS_OF_ELEMENT
from softhand_sim.grasp.phases.hold import Hold
from softhand_sim.grasp.phases.lift import Lift
from softhand_sim.grasp.protocol_file import load_protocol
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.hand.scene import EngineSettings
from softhand_sim.objects.geometry import ShapeGeometry
from softhand_sim.objects.model import build_object
from softhand_sim.objects.shapes import GENERATORS
from softhand_sim.pneumatics.delay import ValveDelay
from softhand_sim.pneumatics.element import Element
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.orifice import Orifice
from softhand_sim.pneumatics.supply import Supply
from softhand_sim.pneumatics.system import PneumaticSystem
from softhand_sim.pneumatics.thermal import Polytropic
from softhand_sim.pneumatics.tube import Tubing
from softhand_sim.stability.gas_runs import Chatter
from softhand_sim.stability.scene_runs import shipped, stiffened

REFUSED = "refused"


@dataclass(frozen=True, kw_only=True)
class Property:
    """One property: its name, the span of each of its values, and what checks an example.

    Attributes
    ----------
    name: as on the command line.
    spans: per value ``(low, high)``, two floats or two integers, or a tuple of words. Examples also hold numbers
        outside a span of floats, NaN and infinity among them.
    check: gets the values by name; returns what came out (a word), raises `AssertionError` or whatever went wrong.
    weight: share of a run's examples that it gets, relative to the others.
    """

    name: str
    spans: Mapping[str, tuple[Any, ...]]
    check: Callable[..., str]
    weight: int = 1


def gas(  # noqa: PLR0913 - each is a value of the example
    *,
    conductance: float, ratio: float, volume_m3: float, dead_m3: float, compliance: float, supply_pa: float,
    ambient_pa: float, start_pa: float, leak: float, receiver_m3: float, wall_s: float, delay_s: float, dt: float,
    tubes: str, seed: int,
) -> str:  # fmt: skip
    """March any system through 0.4 s of chatter: pressures between what it began with and what it is connected to."""
    try:
        valve = Orifice(sonic_conductance_m3_per_s_pa=conductance, critical_pressure_ratio=ratio)
        tubing = Tubing() if tubes == "tubes" else None
        least = 0.0 if tubing is None else tubing.volume_m3(3)
        element = Element(
            inlet=valve, outlet=valve, dead_volume_m3=dead_m3 + least, compliance_m3_per_pa=compliance,
            supply_pa_abs=supply_pa, ambient_pa_abs=ambient_pa, tubing=tubing,
            thermal=Polytropic(wall_time_constant_s=wall_s) if tubes != "plain" else None,
        )  # fmt: skip
        system = PneumaticSystem(
            elements=(element,) * len(FINGERS_OF_ELEMENT), sensor=None, controller=Chatter(seed=seed),
            leaks=(Leak(finger=FINGERS[seed % 5], orifice=Orifice(sonic_conductance_m3_per_s_pa=leak)),),
            supply=Supply(volume_m3=receiver_m3) if tubes != "plain" else None,
            delay=ValveDelay(opening_s=delay_s) if seed % 2 else None,
        )  # fmt: skip
        state = system.reset([volume_m3] * 5, np.random.default_rng(seed), start_pa)
    except ValueError:
        return REFUSED
    low, high = min(ambient_pa, supply_pa), max(supply_pa, ambient_pa + start_pa)
    for _ in range(max(1, min(400, round(0.4 / dt))) if 1e-4 <= dt < 1.0 else 1):
        try:
            state = system.step(state, [volume_m3] * 5, [0.0] * 3, dt)
        except ValueError as error:
            if str(error).startswith("dt = "):
                return REFUSED
            # everything else was accepted
            raise AssertionError(f"an accepted system ended with {error}") from error
        values = (*state.pressure_pa_abs, *state.chamber_pa_abs)
        assert all(map(math.isfinite, values)), f"pressures {values}"
        assert all(math.isfinite(m) and m > 0.0 for m in (*state.mass_kg, *state.chamber_mass_kg)), state.mass_kg
        # heat of compression may overshoot the supply by the ratio of heat capacities, and cool by its inverse
        margin = 1.0 if tubes == "plain" else 1.45
        assert low / margin * (1.0 - 1e-6) <= min(values), f"{min(values)} below {low}"
        assert max(values) <= high * margin * (1.0 + 1e-6), f"{max(values)} above {high}"
    return "kept"


def shape(*, kind: str, a_m: float, b_m: float, c_m: float, mass_kg: float, friction: float) -> str:
    """Build any object: closed mesh, positive inertia that a solid can have, finite resting height."""
    try:
        model = build_object(_shape(kind, a_m, b_m, c_m), name="any", kind=kind, mass_kg=mass_kg, friction=friction)
    except ValueError:
        return REFUSED
    principal = np.linalg.eigvalsh(model.inertia_kg_m2)
    assert np.isfinite(principal).all(), f"inertia {principal}"
    assert principal[0] > 0.0, f"inertia {principal}"
    assert principal[2] <= (principal[0] + principal[1]) * (1.0 + 1e-6), f"inertia {principal}"
    assert math.isfinite(model.rest_height_m), f"rest height {model.rest_height_m}"
    assert model.rest_height_m > 0.0, f"rest height {model.rest_height_m}"
    return "kept"


def trial(  # noqa: PLR0913 - each is a value of the example
    *,
    kind: str, a_m: float, b_m: float, c_m: float, mass_kg: float, friction: float, pressure_pa: float, seed: int,
    timestep_s: float, impratio: float, noslip: int, gravity: float, stiffness: float,
) -> str:  # fmt: skip
    """Run any short trial: a verdict from the list, every figure finite, an alarm named where a guard ended it."""
    try:
        model = build_object(_shape(kind, a_m, b_m, c_m), name="any", kind=kind, mass_kg=mass_kg, friction=friction)
        engine = EngineSettings(
            timestep_s=timestep_s, impratio=impratio, noslip_iterations=noslip, gravity_m_per_s2=gravity
        )
        protocol = replace(
            load_protocol(), close_s=0.4, settle_s=0.1, closing_pressure_pa_gauge=pressure_pa, approach_m=0.02,
            phases=(Lift(height_m=0.02), Hold(duration_s=0.1)),
        )  # fmt: skip
        finger = stiffened(stiffness)
        setup = prepare(model, finger, protocol=protocol, engine=engine, plan=plan_grasp(model), control=shipped())
        result = run_trial(setup, seed)
    except ValueError:
        return REFUSED
    json.dumps(asdict(result), allow_nan=False)
    typed = result.outcome in (Outcome.DIVERGED, Outcome.UNBALANCED, Outcome.EXTRAPOLATED)
    assert typed <= bool(result.alarm), f"{result.outcome} without an alarm"
    assert result.simulated_s > 0.0, "nothing was simulated"
    if not result.alarm:
        assert result.penetration_m <= 5e-3, f"depth {result.penetration_m} and no alarm"
        assert not result.engine_warnings, f"{result.engine_warnings} and no alarm"
    return result.outcome.value


def _shape(kind: str, a_m: float, b_m: float, c_m: float) -> ShapeGeometry:
    sizes: dict[str, dict[str, float]] = {
        "sphere": {"diameter_m": a_m, "wall_thickness_m": 0.5 * a_m},
        "box": {"depth_m": a_m, "width_m": b_m, "height_m": c_m},
        "cylinder": {"diameter_m": a_m, "height_m": b_m},
        "rod": {"thick_diameter_m": a_m, "thick_length_m": b_m, "thin_diameter_m": 0.6 * a_m, "thin_length_m": b_m},
    }
    return GENERATORS[kind](**sizes[kind])


_SIZES = {"kind": ("sphere", "box", "cylinder", "rod"), "a_m": (2e-3, 0.2), "b_m": (2e-3, 0.2), "c_m": (2e-3, 0.2)}
_BODY = {"mass_kg": (1e-4, 5.0), "friction": (0.0, 3.0)}
PROPERTIES: Mapping[str, Property] = {
    one.name: one
    for one in (
        Property(
            name="gas",
            spans={
                "conductance": (1e-13, 1e-7), "ratio": (0.0, 0.8), "volume_m3": (1e-10, 1e-4), "dead_m3": (0.0, 1e-4),
                "compliance": (0.0, 1e-10), "supply_pa": (2e4, 1e6), "ambient_pa": (1e3, 1.1e5), "start_pa": (0.0, 1e5),
                "leak": (1e-13, 1e-7), "receiver_m3": (1e-7, 1e-2), "wall_s": (1e-3, 10.0), "delay_s": (0.0, 0.1),
                "dt": (1e-4, 2e-2), "tubes": ("plain", "heat", "tubes"), "seed": (0, 9999),
            },
            check=gas,
            weight=4,
        ),
        Property(name="shape", spans={**_SIZES, **_BODY}, check=shape, weight=2),
        Property(
            name="trial",
            spans={
                **_SIZES, **_BODY, "pressure_pa": (0.0, 1.2e5), "seed": (0, 9999), "timestep_s": (2.5e-4, 8e-3),
                "impratio": (1.0, 200.0), "noslip": (0, 30), "gravity": (0.0, 20.0), "stiffness": (0.1, 10.0),
            },
            check=trial,
            weight=4,
        ),
    )
}  # fmt: skip
"""Properties by name."""
