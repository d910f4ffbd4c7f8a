"""Time the simulated finger against the finite elements over the same pressures, in one run on one thread.

Neither time has the building of its model in it.
"""

import os

# before numpy and the solvers are imported: one thread for both
os.environ.update({name: "1" for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")})

import sys
import time
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

import numpy as np
from tqdm import tqdm

from fea.calibration import FINGER_PRESSURES_PA_GAUGE, load_materials
from fea.density import DENSITIES
from fea.finger import MESHES, analyse_finger, finger_model
from fea.finger_path import FingerPath
from fea.geometry import FingerGeometry
from fea.newton import Status
from scripts import _cli
from softhand_sim.calibration import load_calibration
from softhand_sim.characterize import Bench

EXAMPLES = """examples:
  finger_speedup.py --json out/speedup.json            # calibration density, 5 to 10 minutes
  finger_speedup.py --density coarse --to 20           # a first look
"""
RAMP_BLOCKS, HOLD_BLOCKS, BLOCK_STEPS = 5, 5, 10
"""Choice: 0.1 s of rising pressure and 0.1 s of rest a row, friction brought up to date every 20 ms."""


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--density", choices=sorted(DENSITIES), default="calibration", help="mesh density (%(default)s)")
    p.add_argument("--to", type=_cli.positive_float, default=80.0, metavar="KPA", help="last pressure (%(default)s)")
    p.add_argument("--repeats", type=_cli.positive_int, default=20, help="sweeps of the simulated finger (%(default)s)")
    p.add_argument("--calibration", type=Path, help="finger calibration (default: the shipped one)")
    p.add_common(seed="taken for uniformity; nothing is random", json="write the figures to this file")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Time both; return the exit status."""
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    pressures = tuple(p for p in FINGER_PRESSURES_PA_GAUGE if p <= 1e3 * args.to)
    if not pressures:
        raise ValueError(f"--to {args.to:g}: must be at least {1e-3 * FINGER_PRESSURES_PA_GAUGE[0]:g} kPa")
    calibration = load_calibration(args.calibration)
    expected, fea_s = _finite_elements(args.density, pressures)
    times, found = [], np.empty(0)
    for _ in range(args.repeats):
        bench = Bench(calibration)
        start = time.perf_counter()
        found = sweep(bench, pressures)
        times.append(time.perf_counter() - start)
    error = found - expected
    data: dict[str, Any] = {
        "density": args.density,
        "pressure_pa_gauge": list(pressures),
        "fea_tip_angle_deg": expected.tolist(),
        "tip_angle_deg": found.tolist(),
        "fea_wall_s": fea_s,
        "surrogate_wall_s": median(times),
        "ratio": fea_s / median(times),
        "tip_angle_error_rms_deg": float(np.sqrt(np.mean(error**2))),
        "tip_angle_error_max_deg": float(np.abs(error).max()),
    }
    if args.json is not None:
        _cli.write_json(args.json, data)
    print(
        f"{len(pressures)} pressures up to {1e-3 * pressures[-1]:g} kPa: finite elements {fea_s:.1f} s, "
        f"simulated finger {1e3 * median(times):.1f} ms (median of {args.repeats}), ratio {data['ratio']:.0f}; "
        f"tip angle {data['tip_angle_error_rms_deg']:.2f} degrees RMS, {data['tip_angle_error_max_deg']:.2f} at most"
    )
    return 0


def sweep(bench: Bench, pressures_pa_gauge: Sequence[float]) -> np.ndarray:
    """Return the tip angle [deg] at each pressure, on a bench that starts without one."""
    before, angles = 0.0, []
    for pressure in pressures_pa_gauge:
        for k in range(1, RAMP_BLOCKS + HOLD_BLOCKS + 1):
            share = min(1.0, k / RAMP_BLOCKS)
            bench.step(before + share * (pressure - before), nstep=BLOCK_STEPS)
        angles.append(bench.read().tip_angle_deg)
        before = pressure
    return np.array(angles)


def _finite_elements(density: str, pressures: tuple[float, ...]) -> tuple[np.ndarray, float]:
    """Return the tip angles [deg] of the finite-element finger and the time of its solve [s]."""
    geometry, materials = FingerGeometry(), load_materials()
    with tqdm(total=len(pressures), desc="finite elements", unit="level") as bar:
        model = finger_model(geometry, materials.silicone, materials.pet, materials.tpu, MESHES[density])
        start = time.perf_counter()
        result = analyse_finger(model, geometry, FingerPath(pressures), progress=lambda: bar.update(1))
        wall = time.perf_counter() - start
    if result.status is not Status.CONVERGED:
        raise ValueError(f"finite elements: {result.status.value} above {result.pressure_pa_gauge[-1]:g} Pa")
    return np.rad2deg(result.tip_angle_rad[1:]), wall


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
