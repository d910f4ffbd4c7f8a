"""Scenes that settings are compared on, and what finer settings bring."""

import numpy as np
import pytest

from softhand_sim.effects.bare import BareHand
from softhand_sim.fidelity.fidelity import FINEST, HIGH_ACCURACY, Fidelity
from softhand_sim.fidelity.scenes import BareScene, GraspScene, draw_scenes, error
from softhand_sim.fidelity.shapes import Shapes, with_shapes
from softhand_sim.objects.catalogue import make_object

BARE = BareScene(hand=BareHand(set_angle_deg=(60.0, 40.0, 80.0), close_s=0.4, hold_s=0.2), seed=3)


def test_drawn_scenes_are_their_seed_s_alone():
    assert [s.name for s in draw_scenes(4, 5)] == [s.name for s in draw_scenes(4, 5)]
    assert [s.name for s in draw_scenes(2, 5)] == [s.name for s in draw_scenes(4, 5)][:2]
    assert not {s.name for s in draw_scenes(4, 5)} & {s.name for s in draw_scenes(4, 6)}


def test_a_scene_is_repeated_to_the_bit(calibration):
    one, other = (BARE.run(calibration, Fidelity()) for _ in range(2))
    assert error(one, other).angle_deg == 0.0


def test_a_finer_step_is_nearer_to_the_finest(calibration):
    """While fingers still move, first-order integration: an eighth of the step leaves under a quarter of the error."""
    finest, fine, coarse = (BARE.run(calibration, f) for f in (FINEST, HIGH_ACCURACY, Fidelity(timestep_s=4e-3)))
    assert error(fine, finest).angle_deg < 0.25 * error(coarse, finest).angle_deg
    assert error(coarse, finest).angle_deg < 2.0


def test_high_accuracy_slows_the_creep_of_a_held_ball(calibration):
    """Most of it: the rest of so short a hold is the valves' settling."""
    scene = GraspScene(model=make_object("tennis_ball"), seed=0)
    default, fine = (scene.run(calibration, f) for f in (Fidelity(), HIGH_ACCURACY))
    assert default.verdict == fine.verdict == "HELD"
    assert fine.creep_m_per_s < 0.75 * default.creep_m_per_s


@pytest.mark.parametrize("name", ["mug", "tennis_ball"])
def test_other_shapes_keep_the_object(name):
    model = make_object(name)
    corners = np.asarray(model.mesh.vertices)
    for shapes in Shapes:
        other = with_shapes(model, shapes)
        assert (other.mass_kg, other.friction) == (model.mass_kg, model.friction)
        if shapes is not Shapes.SHIPPED:
            reach = max(np.linalg.norm(p.vertices, axis=1).max() for p in other.convex_parts)
            assert reach == pytest.approx(np.linalg.norm(corners, axis=1).max(), rel=0.01)
    assert len(with_shapes(model, Shapes.HULL).convex_parts) == 1


def test_a_fidelity_is_its_record():
    fidelity = Fidelity(timestep_s=1e-3, links=6, shapes=Shapes.HULL, effects="full")
    data = fidelity.data()
    plain = {key: value for key, value in data.items() if key not in ("measured", "auto_effects")}
    assert Fidelity.from_data(plain) == fidelity
    with pytest.raises(ValueError, match="effects = 'none'"):
        Fidelity(effects="none")
