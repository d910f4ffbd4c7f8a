"""Tube resistance: the pressure in a chamber lags behind the one at the valves and the sensor."""

from dataclasses import dataclass

from softhand_sim.effects.kind import ActsOn

ACTS_ON = ActsOn.FLOW


@dataclass(frozen=True, kw_only=True)
class TubeResistance:
    """Friction in the tubes of `GasDynamics.tubing`, after `Tube`; it has no parameters of its own."""
