"""What a verdict rests on besides the object's path: contacts, links, forces, fingers in each other's way, warnings."""

import mujoco
import numpy as np
import pytest

from softhand_sim.elements import FINGERS
from softhand_sim.grasp.contacts import PALM, ContactMap
from softhand_sim.grasp.trial import prepare, run_trial
from softhand_sim.grasp.verdict import Outcome
from softhand_sim.objects.catalogue import make_object

# a bar of 0.3 kg on two supports: palm 50 mm from its middle, a finger 100 mm on the other side; two fingers that cross
BENCH = """
<mujoco>
  <option timestep="0.001" impratio="10" cone="elliptic"/>
  <worldbody>
    <body name="palm" pos="-0.05 0 0"><geom type="box" size="0.01 0.05 0.05"/></body>
    <body name="index_distal" pos="0.1 0 0"><geom type="box" size="0.01 0.05 0.05"/></body>
    <body name="ring_distal" pos="0 0.5 0"><joint/><geom type="sphere" size="0.05"/></body>
    <body name="little_base" pos="0 0.59 0"><joint/><geom type="sphere" size="0.05"/></body>
    <body name="object" pos="0 0 0.06"><freejoint/><geom type="box" size="0.12 0.02 0.01" mass="0.3"/></body>
  </worldbody>
</mujoco>
"""


def test_forces_are_those_of_the_lever():
    model = mujoco.MjModel.from_xml_string(BENCH)
    data = mujoco.MjData(model)
    for _ in range(1500):
        mujoco.mj_step(model, data)
    contacts = ContactMap.of(model)
    force = contacts.normal_forces_n(data)
    assert force.sum() == pytest.approx(0.3 * 9.81, rel=1e-3)
    assert force[PALM] + force[FINGERS.index("index")] == pytest.approx(force.sum())
    # moments about the object's middle, with the supports' inner and outer edges as bounds of the arms
    ratio = force[PALM] / force[FINGERS.index("index")]
    assert 0.09 / 0.06 < ratio < 0.11 / 0.04
    # the engine's own reading of the same forces
    own = np.zeros(6)
    for contact in contacts.of_object(data):
        mujoco.mj_contactForce(model, data, int(contact), decoded := np.zeros(6))
        own[contacts.member[contacts.hand_geom(data, int(contact))]] += decoded[0]
    assert np.array_equal(force, own)
    links = {contacts.link[contacts.hand_geom(data, int(i))] for i in contacts.of_object(data)}
    assert links == {"palm", "index_distal"}
    crossing = contacts.of_fingers(data)
    assert len(crossing) == 1
    assert data.contact.dist[crossing[0]] == pytest.approx(-0.01, abs=1e-6)


def test_a_held_mug_s_record_balances(calibration):
    result = run_trial(prepare(make_object("mug"), calibration), seed=0)
    assert result.outcome is Outcome.HELD
    assert result.contacts >= 3
    assert any(link.startswith("thumb_") for link in result.links)
    assert set(result.force_n) == {*FINGERS, "palm"}
    # friction bears the weight: at most mu times the normal forces, on sides that are nearly upright
    assert result.friction * sum(result.force_n.values()) > result.mass_kg * 9.81
    assert result.hold_penetration_m <= result.penetration_m < 0.002
    assert result.worst_slip_m >= result.slip_m
    assert result.engine_warnings == {}
    assert result.finger_contact_s == 0.0


def test_fingers_that_close_on_nothing_are_seen_to_touch(calibration):
    setup = prepare(make_object("soup_can"), calibration)
    result = run_trial(setup, seed=0)
    assert result.outcome is Outcome.MISSED
    assert result.finger_contact_s > 1.0
    assert result.finger_penetration_m > 0.0
    assert result.contacts == 0
    assert result.links == ()
    assert np.array(list(result.force_n.values())) == pytest.approx(0.0)
