"""One episode's draw: which object, where, how heavy and slippery, which finger, which valves and sensors."""

from dataclasses import dataclass, replace

import numpy as np

from envs.randomization import Randomization, Range
from softhand_sim.effects import Effects
from softhand_sim.elements import FINGERS
from softhand_sim.pneumatics.leak import Leak
from softhand_sim.pneumatics.orifice import Orifice


@dataclass(frozen=True, kw_only=True)
class Draw:
    """What holds in one episode.

    Attributes
    ----------
    object, calibration
        Indices into the environment's objects and finger calibrations (material pairs).
    object_offset_m, object_yaw_rad
        Displacement along x and y [m], (2,), and turn about the vertical [rad].
    mass_ratio, friction
        Mass over the object's own, and its coefficient (None: its own).
    mass_kg
        Mass [kg] instead of the ratio, if a caller fixed it.
    leak, valve_flow_ratio, sensor_offset_pa
        As in `Randomization`; None for no leak.
    """

    object: int = 0
    calibration: int = 0
    object_offset_m: tuple[float, float] = (0.0, 0.0)
    object_yaw_rad: float = 0.0
    mass_ratio: float = 1.0
    mass_kg: float | None = None
    friction: float | None = None
    leak: Leak | None = None
    valve_flow_ratio: float = 1.0
    sensor_offset_pa: float = 0.0

    def on(self, effects: Effects) -> Effects:
        """Return a scene's effects with this episode's leak, valves and sensors."""
        if self.leak is not None:
            effects = replace(effects, leaks=(self.leak,))
        if effects.gas is not None and self.valve_flow_ratio != 1.0:
            inlet, outlet = (_scaled(v, self.valve_flow_ratio) for v in (effects.gas.inlet, effects.gas.outlet))
            effects = replace(effects, gas=replace(effects.gas, inlet=inlet, outlet=outlet))
        if effects.sensor is not None and self.sensor_offset_pa != 0.0:
            offset = effects.sensor.offset_pa + self.sensor_offset_pa
            effects = replace(effects, sensor=replace(effects.sensor, offset_pa=offset))
        return effects


def _scaled(valve: Orifice, ratio: float) -> Orifice:
    return replace(valve, sonic_conductance_m3_per_s_pa=ratio * valve.sonic_conductance_m3_per_s_pa)


@dataclass(frozen=True, kw_only=True)
class Drawer:
    """Draws episodes for an environment of so many objects and calibrations."""

    ranges: Randomization
    objects: int
    calibrations: int

    def draw(self, rng: np.random.Generator) -> Draw:
        """Return what the next episode is like.

        As many numbers are drawn whatever the ranges, so that changing or fixing one leaves the others as they were.
        """
        r = self.ranges
        thing, pair, finger = (int(rng.integers(n)) for n in (self.objects, self.calibrations, len(FINGERS)))
        x, y, yaw, offset = rng.uniform(-1.0, 1.0, size=4).tolist()
        mass, friction, leaks, hole, flow = rng.uniform(size=5).tolist()
        leak = None
        if leaks < r.leak_probability:
            orifice = Orifice(sonic_conductance_m3_per_s_pa=_logarithmic(r.leak_m3_per_s_pa, hole))
            leak = Leak(finger=FINGERS[finger], orifice=orifice)
        return Draw(
            object=thing,
            calibration=pair,
            object_offset_m=(r.position_m * x, r.position_m * y),
            object_yaw_rad=r.yaw_rad * yaw,
            mass_ratio=_even(r.mass_ratio, mass),
            friction=None if r.friction is None else _even(r.friction, friction),
            leak=leak,
            valve_flow_ratio=_logarithmic(r.valve_flow_ratio, flow),
            sensor_offset_pa=r.sensor_offset_pa * offset,
        )


def _even(limits: Range, share: float) -> float:
    return limits[0] + share * (limits[1] - limits[0])


def _logarithmic(limits: Range, share: float) -> float:
    # equal limits give themselves exactly
    return float(limits[0] * (limits[1] / limits[0]) ** share)
