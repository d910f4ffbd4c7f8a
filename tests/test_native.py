"""The engine's step as compiled loops take it."""

import mujoco
import numpy as np
import pytest

from softhand_sim.actuation.native import EngineGuard, guarded_step

PILE = "".join(
    f"<body pos='{0.05 * i} 0 0.05'><freejoint/><geom type='box' size='.1 .1 .1'/></body>" for i in range(12)
)


def world(memory):
    xml = f"<mujoco><size memory='{memory}'/><worldbody><geom type='plane' size='1 1 1'/>{PILE}</worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(xml)
    return model, mujoco.MjData(model)


def test_steps_are_the_engine_s_own_to_the_bit():
    model, data = world("20M")
    guard, other = EngineGuard(model, data), mujoco.MjData(model)
    for _ in range(20):
        assert guarded_step(guard.words)
    mujoco.mj_step(model, other, nstep=20)
    assert data.ncon > 0
    assert (data.time, data.qpos.tobytes(), data.qvel.tobytes()) == (
        other.time, other.qpos.tobytes(), other.qvel.tobytes(),
    )  # fmt: skip


def test_a_fatal_error_of_the_engine_is_raised_and_the_process_goes_on():
    model, data = world("8K")
    guard = EngineGuard(model, data)
    with pytest.raises(mujoco.FatalError, match="out of memory"):
        mujoco.mj_step(model, data)
    for _ in range(2):
        assert not guarded_step(guard.words)
        with pytest.raises(mujoco.FatalError, match="out of memory"):
            guard.raise_error()
    assert np.isfinite(data.qpos).all()
