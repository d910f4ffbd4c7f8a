"""The whole state of a running simulation as named arrays: it goes on from there bit for bit."""

from collections.abc import Mapping

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.losses import LossState
from softhand_sim.simulation import HandSimulation

Vector = npt.NDArray[np.float64]

_SPEC = int(mujoco.mjtState.mjSTATE_INTEGRATION)


def take(simulation: HandSimulation) -> dict[str, Vector]:
    """Return the state: engine, gas and control, losses, wrist, set pressures, extremes.

    Of what a step derives, the tendons' lengths are the only thing that the next one starts from.
    """
    model, data = simulation.model, simulation.data
    engine = np.zeros(mujoco.mj_stateSize(model, _SPEC))
    mujoco.mj_getState(model, data, engine, _SPEC)
    loss, gas = simulation.loss_state, simulation.gas
    return {
        "engine": engine,
        "ten_length": data.ten_length.copy(),
        "wrist_reference": np.array(simulation.wrist_reference),
        "wrist_target": np.array(simulation.wrist_target),
        "set_pressure_pa_gauge": np.array(simulation.set_pressure_pa_gauge),
        "gas": np.zeros(0) if gas is None else gas.to_array(),
        "slip_m": loss.slip_m.copy(),
        "flow_m": loss.flow_m.copy(),
        "bulge_m": loss.bulge_m.copy(),
        "next_look_s": np.array([simulation._next_look_s]),
        "extremes": simulation.range_watch.extremes.copy(),
    }


def restore(simulation: HandSimulation, state: Mapping[str, Vector]) -> None:
    """Put a simulation of the same model and parameters into a state.

    Raises
    ------
    ValueError
        If the state belongs to another model.
    """
    model, data = simulation.model, simulation.data
    size = mujoco.mj_stateSize(model, _SPEC)
    if state["engine"].shape != (size,) or state["ten_length"].shape != data.ten_length.shape:
        raise ValueError(f"engine: state of {state['engine'].shape} numbers, the model has ({size},)")
    simulation.reset(np.random.default_rng(0), state["wrist_reference"])
    mujoco.mj_setState(model, data, state["engine"], _SPEC)
    mujoco.mj_forward(model, data)
    # forward has touched what the next step starts its solver from, and brought the tendons up to date
    mujoco.mj_setState(model, data, state["engine"], _SPEC)
    data.ten_length[:] = state["ten_length"]
    simulation.wrist_target = state["wrist_target"].copy()
    simulation.set_pressure_pa_gauge = state["set_pressure_pa_gauge"]
    if simulation.pneumatics is not None:
        simulation.gas = simulation.pneumatics.restore(state["gas"])
    simulation.loss_state = LossState(slip_m=state["slip_m"], flow_m=state["flow_m"], bulge_m=state["bulge_m"])
    simulation._next_look_s = float(state["next_look_s"][0])
    simulation.range_watch.extremes[:] = state["extremes"]
