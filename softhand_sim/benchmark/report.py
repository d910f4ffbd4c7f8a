"""Statistics and table of a benchmark."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from statistics import median
from typing import Any

from scipy.stats import binomtest

from softhand_sim.calibration import JOINT_RANGE_RAD
from softhand_sim.grasp.protocol import GraspProtocol
from softhand_sim.grasp.result import TrialResult
from softhand_sim.grasp.verdict import Outcome

HEADER = (
    f"{'object':<22}{'trials':>7}{'held':>6}{'rate':>7}  {'95 % Wilson':<14}"
    f"{'slip mm':>8}{'creep um/s':>12}{'depth mm':>10}{'force N':>9}{'fingers':>9}{'on stop':>9}  other outcomes"
)


def wilson_interval(held: int, trials: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a success rate (E. B. Wilson, J. Am. Stat. Assoc. 22, 1927)."""
    interval = binomtest(held, trials).proportion_ci(confidence_level=0.95, method="wilson")
    return float(interval.low), float(interval.high)


def summarise(results: Sequence[TrialResult]) -> dict[str, dict[str, Any]]:
    """Return per object: trials, held, success_rate, wilson_low, wilson_high, count of each outcome, flags.

    Medians of slip, creep, depth and force are over the trials that ended `HELD`, and None where none did.
    `held_on_stop` counts the holds in which a joint was bent back to its stop at some time: beyond what the finger is
    calibrated for, the stop carries. `finger_contact_share` is the share of trials in which a finger touched another,
    `engine_warnings` the number of the engine's warnings in all of them.
    """
    summary: dict[str, dict[str, Any]] = {}
    for name in dict.fromkeys(result.object for result in results):
        own = [result for result in results if result.object == name]
        held = [result for result in own if result.outcome is Outcome.HELD]
        low, high = wilson_interval(len(held), len(own))
        counts = Counter(result.outcome for result in own)
        summary[name] = {
            "trials": len(own),
            "held": len(held),
            "success_rate": len(held) / len(own),
            "wilson_low": low,
            "wilson_high": high,
            "outcomes": {outcome.value: counts[outcome] for outcome in Outcome},
            "held_median_slip_m": median(r.slip_m for r in held) if held else None,
            "held_median_creep_m_per_s": median(r.creep_m_per_s for r in held) if held else None,
            "trials_beyond_calibration": sum(bool(r.beyond_calibration) for r in own),
            "held_on_stop": sum(touched_stop(r) for r in held),
            "held_median_penetration_m": median(r.penetration_m for r in held) if held else None,
            "held_median_force_n": median(sum(r.force_n.values()) for r in held) if held else None,
            "finger_contact_share": sum(r.finger_contact_s > 0.0 for r in own) / len(own),
            "engine_warnings": sum(sum(r.engine_warnings.values()) for r in own),
        }
    return summary


def touched_stop(result: TrialResult) -> bool:
    """Whether a joint was bent back to its stop at some time of a trial."""
    lowest = (value for name, value in result.beyond_calibration.items() if name.endswith("_lowest_rad"))
    return min(lowest, default=0.0) <= JOINT_RANGE_RAD[0]


def table(summary: dict[str, dict[str, Any]]) -> str:
    """Return the summary as text, a row an object."""
    return "\n".join([HEADER, *(_row(name, row) for name, row in summary.items())])


def conditions(protocol: GraspProtocol) -> str:
    """Return what the outcomes of a table mean, in a line."""
    limits = protocol.thresholds
    when = "at any time" if limits.at_any_time else "at the end"
    return (
        f"protocol {protocol.name}: HELD is slip <= {1e3 * limits.slip_m:g} mm and tilt <= "
        f"{math.degrees(limits.tilt_rad):.3g} degrees {when}, creep <= {1e6 * limits.creep_m_per_s:g} um/s, depth "
        f"in the hold <= {1e3 * limits.penetration_m:g} mm, lifted by >= {limits.held_fraction:.0%} "
        f"of {protocol.lift_m:g} m; fingers: share of trials in which one finger touched another; "
        "on stop: holds in which a joint was bent back to its stop"
    )


def _row(name: str, row: dict[str, Any]) -> str:
    def scaled(key: str, factor: float, digits: int) -> str:
        return "-" if row[key] is None else f"{row[key] * factor:.{digits}f}"

    interval = f"{row['wilson_low']:.2f} - {row['wilson_high']:.2f}"
    others = ", ".join(f"{k} {n}" for k, n in row["outcomes"].items() if n and k != Outcome.HELD)
    return (
        f"{name:<22}{row['trials']:>7}{row['held']:>6}{row['success_rate']:>7.2f}  {interval:<14}"
        f"{scaled('held_median_slip_m', 1e3, 1):>8}{scaled('held_median_creep_m_per_s', 1e6, 0):>12}"
        f"{scaled('held_median_penetration_m', 1e3, 2):>10}{scaled('held_median_force_n', 1, 2):>9}"
        f"{row['finger_contact_share']:>9.2f}{row['held_on_stop']:>9}  {others}"
    )


def beyond_calibration(results: Sequence[TrialResult]) -> str:
    """Return one line an object on trials that left the range of the calibration, and how far; empty if none did."""
    lines = []
    for name in dict.fromkeys(result.object for result in results):
        own = [result for result in results if result.object == name]
        left = [result.beyond_calibration for result in own if result.beyond_calibration]
        if not left:
            continue
        keys = dict.fromkeys(key for row in left for key in row)
        extremes = {key: max((row[key] for row in left if key in row), key=abs) for key in keys}
        text = ", ".join(f"{key} {value:.3g}" for key, value in extremes.items())
        lines.append(f"beyond the calibrated range in {len(left)} of {len(own)} trials of {name}: {text}")
    return "\n".join(lines)


def told_by_guards(results: Sequence[TrialResult]) -> str:
    """Return a line for each caveat of the run, and one for each trial that a guard ended; empty if there is none."""
    lines = [f"not verified: {line}" for line in dict.fromkeys(line for r in results for line in r.caveats)]
    for result in results:
        if result.alarm:
            again = f" (repeat: --replay {result.replay})" if result.replay else ""
            lines.append(f"ended by a guard: {result.object}, seed {result.seed}: {result.alarm}{again}")
    return "\n".join(lines)


def trial_rows(results: Sequence[TrialResult]) -> list[dict[str, Any]]:
    """Return the trials as JSON-ready rows."""
    return [{**asdict(result), "outcome": result.outcome.value} for result in results]
