"""Objects beside a hand that moves at random: the engine never complains."""

import numpy as np
import pytest

from softhand_sim.grasp.place import place_object
from softhand_sim.grasp.scripted import plan_grasp
from softhand_sim.hand.scene import build_scene
from softhand_sim.objects.catalogue import load_catalogue, make_object
from softhand_sim.objects.mjcf import attach_object
from softhand_sim.simulation import HandSimulation, default_pneumatics


@pytest.mark.parametrize("name", load_catalogue())
def test_random_hand_motion_gives_no_engine_warning(name, calibration):
    model = make_object(name)
    scene = build_scene(calibration, add_object=lambda root: attach_object(root, model))
    simulation = HandSimulation(model=scene.model, calibration=calibration, pneumatics=default_pneumatics(calibration))
    rng = np.random.default_rng(6)
    grasp = plan_grasp(model).standoff(0.0)
    simulation.reset(rng, plan_grasp(model).standoff(0.05))
    place_object(simulation, model.rest_height_m, (0.0, 0.0, 0.0))
    touched, thing = False, int(simulation.model.body("object").id)
    for _ in range(12):
        # around the grasp, sometimes into the object and the table
        simulation.wrist_target = grasp + rng.uniform(-1.0, 1.0, 6) * np.array([0.03, 0.03, 0.03, 0.4, 0.3, 0.3])
        simulation.set_pressure_pa_gauge = rng.uniform(0.0, 80e3, 3)
        for _ in range(5):
            for _ in range(15):
                simulation.step()
            body = simulation.model.geom_bodyid[simulation.data.contact.geom]
            touched |= bool(((body == thing).any(axis=1) & (body != 0).all(axis=1)).any())
    assert touched
    assert np.isfinite(simulation.data.qpos).all()
    assert not any(warning.number for warning in simulation.data.warning)
