"""Bodies that are where they cannot be, or are pressed there."""

import math

import numpy as np

from softhand_sim.hand.finger import PAD_RADIUS_M
from softhand_sim.stability.case import Finding, scene_cases
from softhand_sim.stability.scene_runs import World, ball, box, stiffened

HIGH = (0.0, 0.0, 0.3, 0.0, 0.0, 0.0)
FAR = (0.4, 0.4, 0.02)


def spawned_inside(timestep_s: float) -> Finding:
    """Run: a ball of 50 g starts 5 mm inside a fingertip's pad: it may come out, but not be shot out."""
    radius = 0.02
    probe = World.of(timestep_s, ball(radius, 0.05, FAR), HIGH)
    data, model = probe.simulation.data, probe.simulation.model
    pad = model.geom("index_distal_pad").id
    out = data.geom_xmat[pad].reshape(3, 3)[:, 0]
    # away from the other fingers: along the pad's own side
    away = out if out[2] < 0.0 else -out
    place = data.geom_xpos[pad] + (radius + PAD_RADIUS_M - 4.9e-3) * away
    world = World.of(timestep_s, ball(radius, 0.05, tuple(place.tolist())), HIGH)
    joint = world.simulation.model.joint("object_joint").dofadr[0]
    fastest = 0.0

    def look() -> None:
        nonlocal fastest
        fastest = max(fastest, float(np.linalg.norm(world.simulation.data.qvel[joint : joint + 3])))

    # it falls for as long as it takes from there to the table, then rolls
    fall = math.sqrt(2.0 * 9.81 * float(place[2]))
    world.go(0.6, look)
    return world.finding("largest speed over that of the fall and 1 m/s, <= 1", fastest / (fall + 1.0), 1.0)


def jammed_fingers(timestep_s: float) -> Finding:
    """Fingers ten times too soft at 80 kPa: wound up to their stops, pressed against one another and the palm."""
    world = World.of(timestep_s, ball(0.02, 0.05, FAR), HIGH, calibration=stiffened(0.1))
    world.simulation.set_pressure_pa_gauge = np.full(3, 75e3)
    world.go(4.0)
    return world.finding("deepest contact anywhere [m], <= 0.005", world.deepest_m, 5e-3)


def crossed_fingers(timestep_s: float) -> Finding:
    """Run: a ball in the palm and every finger at 75 kPa: they close over it, onto one another and onto the palm."""
    world = World.of(timestep_s, ball(0.012, 0.02, (0.0, 0.0, 0.27)), (0.0, 0.0, 0.25, 0.0, 0.0, math.pi))
    world.simulation.set_pressure_pa_gauge = np.full(3, 75e3)
    world.go(4.0)
    return world.finding("deepest contact anywhere [m], <= 0.005", world.deepest_m, 5e-3)


def wedged(timestep_s: float) -> Finding:
    """Run: a block between palm and table while the wrist wants to be 30 mm lower: 50 N of servo on 40 g."""
    world = World.of(timestep_s, box((0.03, 0.03, 0.05), 0.04, (0.0, 0.0, 0.05)), (0.0, 0.0, 0.15, 0.0, 0.0, 0.0))
    world.simulation.wrist_target = np.array([0.0, 0.0, 0.07, 0.0, 0.0, 0.0])
    world.go(2.0)
    return world.finding("deepest contact anywhere [m], <= 0.005", world.deepest_m, 5e-3)


def bead(timestep_s: float) -> Finding:
    """Run: a bead of 1.3 mg under a closing hand of 100 g: ten thousand times lighter than a finger."""
    world = World.of(timestep_s, ball(0.004, 1.3e-6, (0.02, 0.0, 0.004)), (0.0, 0.0, 0.105, 0.0, 0.0, 0.0))
    world.simulation.set_pressure_pa_gauge = np.full(3, 75e3)
    world.go(3.0)
    return world.finding("deepest contact anywhere [m], <= 0.005", world.deepest_m, 5e-3)


KINDS = scene_cases(
    (
        "object spawned 5 mm inside a finger",
        "starts where it cannot be",
        "leaves no faster than it falls",
        spawned_inside,
    ),
    ("fingers jammed against each other", "ten times too soft, 75 kPa", "depth below 5 mm", jammed_fingers),
    (
        "fingers closed over a ball in the palm",
        "contacts of fingers, ball, palm",
        "depth below 5 mm",
        crossed_fingers,
    ),
    ("object wedged between palm and table", "50 N of servo on 40 g", "depth below 5 mm", wedged),
    ("mass ratio of 10,000", "bead of 1.3 mg under the fingers", "depth below 5 mm", bead),
)
