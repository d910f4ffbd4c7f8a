"""Grasps of things that are hard to hold or to simulate; each verdict against that at a quarter of the step."""

from functools import cache, partial

from softhand_sim.objects.blocks import blocks
from softhand_sim.objects.catalogue import make_object
from softhand_sim.objects.model import ObjectModel, build_object
from softhand_sim.objects.shapes.rod import rod
from softhand_sim.stability.case import HardCase
from softhand_sim.stability.scene_runs import Grasped


@cache
def _thing(name: str, mass_kg: float | None = None, friction: float | None = None) -> ObjectModel:
    return make_object(name).with_overrides(mass_kg=mass_kg, friction=friction)


@cache
def thin_marker() -> ObjectModel:
    """Return a pen of 5 mm, thinner than a finger's pad is high."""
    shape = rod(thick_diameter_m=0.005, thick_length_m=0.1, thin_diameter_m=0.002, thin_length_m=0.02)
    return build_object(shape, name="marker_5_mm", kind="rod", mass_kg=0.005, friction=0.8)


@cache
def scissors() -> ObjectModel:
    """Return scissors of two blades of 1.5 mm that cross, with loops as plain bars (sides as YCB 037: 87 x 200 mm)."""
    t = 0.0015
    shape = blocks(
        [
            ((0.0, -0.006, 0.0), (0.1, 0.006, t)),
            ((0.1, -0.0435, 0.0), (0.12, 0.0435, 0.009)),
            ((0.12, -0.0435, 0.0), (0.2, -0.0335, 0.009)),
            ((0.12, 0.0335, 0.0), (0.2, 0.0435, 0.009)),
        ]
    )
    return build_object(shape, name="scissors", kind="blocks", mass_kg=0.082, friction=0.5)


def _case(name: str, hard: str, make: object, stiffness: float = 1.0) -> HardCase:
    return HardCase(
        name=name,
        hard=hard,
        stability="finite, no warning of the engine, nothing deeper than 5 mm, no energy from nowhere",
        correctness="same verdict as at 0.5 ms",
        run=Grasped(make=make, stiffness=stiffness),  # type: ignore[arg-type]
    )


KINDS = {
    case.name: case
    for case in (
        _case("strawberry of 2 g", "lighter than a phalanx by six", partial(_thing, "strawberry", 0.002)),
        _case("bottle of 1.1 kg", "eleven times the hand's mass", partial(_thing, "bleach_bottle")),
        _case("marker of 5 mm", "thinner than a pad is high", thin_marker),
        _case("scissors", "edges of 1.5 mm on the table", scissors),
        _case("oiled apple", "friction of 0.05", partial(_thing, "apple", None, 0.05)),
        _case("sticky apple", "friction of 2: nothing slides", partial(_thing, "apple", None, 2.0)),
        _case("mug", "24 convex parts, many contacts", partial(_thing, "mug")),
        _case("golf ball", "small, hard, squeezed out", partial(_thing, "golf_ball")),
        _case("can of 40 kg", "ten thousand times a distal phalanx", partial(_thing, "soup_can", 40.0)),
        _case(
            "joints ten times stiffer",
            "shorter natural periods against the same step",
            partial(_thing, "tennis_ball"),
            10.0,
        ),
        _case("joints ten times softer", "fingers wind up to their stops", partial(_thing, "tennis_ball"), 0.1),
    )
}
