"""A policy in a grasp trial: it reaches and closes in the place of the script, from what the hardware knows alone."""

from collections.abc import Callable, Iterator

import numpy as np
import numpy.typing as npt

from softhand_sim.grasp.plan import GraspPlan
from softhand_sim.policy.policy_file import Policy
from softhand_sim.policy.reach import SAMPLE_S, Reach
from softhand_sim.simulation import HandSimulation

Vector = npt.NDArray[np.float64]


def reach_and_close(
    policy: Policy,
    simulation: HandSimulation,
    plan: GraspPlan,
    closing_pa_gauge: Vector,
    highest_pa_gauge: float,
) -> Iterator[Callable[[], bool]]:
    """Give a policy's commands one after the other, and after each yield the question whether it is over.

    Parameters
    ----------
    policy, plan
        What decides, and the grasp that it corrects; the wrist stands at the plan's standoff.
    simulation
        Commanded; of it, the policy sees the sensors' readings, the valves and the wrist's pose.
    closing_pa_gauge
        Set pressures of the script when it closes [Pa gauge], (3,).
    highest_pa_gauge
        Highest set pressure [Pa gauge].
    """
    reach = Reach(
        spec=policy.spec, plan=plan, script_pa_gauge=closing_pa_gauge, highest_pa_gauge=highest_pa_gauge
    )  # fmt: skip
    began_s, samples = float(simulation.data.time), 0
    while not reach.over:
        action = policy.act(reach.features(simulation.data.qpos[simulation.index.wrist_qpos]))
        simulation.wrist_target, simulation.set_pressure_pa_gauge = reach.decide(action)
        first, samples = samples, samples + policy.spec.samples

        def over(first: int = first, last: int = samples) -> bool:
            # asked more often than the policy reads its sensors
            due = int((simulation.data.time - began_s) / SAMPLE_S + 1e-6)
            if due > first + reach.readings:
                reach.see(simulation.reading_pa_gauge(), simulation.valves_open())
            return due >= last

        yield over
