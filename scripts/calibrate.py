"""Calibrate the finger: material sheets and geometry in, ``assets/calibration/finger.json`` out."""

import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

import numpy as np
from tqdm import tqdm

from assets import asset_path
from fea.artifact import write_artifact
from fea.calibration import (
    FINGER_PATH,
    TARGET_PRESSURE_PA_GAUGE,
    Calibration,
    Materials,
    calibrate,
    choose_sector,
    load_materials,
)
from fea.density import DENSITIES, Density
from fea.exoskeleton import LOADS_N
from fea.geometry import FingerGeometry
from scripts import _cli

EXAMPLES = """examples:
  python scripts/calibrate.py                                   # the shipped calibration, a few minutes
  python scripts/calibrate.py --density coarse --out out/f.json --json out/calibrate.json
  python scripts/calibrate.py --materials set2 set3 --out out/stiffer.json
  python scripts/calibrate.py --choose-sector --out out/f.json  # find the palm sector that gives 95 degrees at 75 kPa
"""


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--density", choices=sorted(DENSITIES), default="calibration", help="mesh density (%(default)s)")
    _cli.add_materials(p)
    _cli.add_dimension(p)
    p.add_argument("--choose-sector", action="store_true", help="find the palm sector that gives 95 degrees at 75 kPa")
    p.add_argument("--out", type=Path, help="calibration file (assets/calibration/finger.json)")
    p.add_common(
        seed="taken for uniformity; nothing is random", json="write the three analyses and the fit errors here"
    )
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Run the calibration; return the exit status."""
    args = parser().parse_args(argv)
    out = args.out if args.out is not None else asset_path("calibration") / "finger.json"
    _cli.check_writable(args.json)
    _cli.check_writable(out)
    density = DENSITIES[args.density]
    materials = load_materials(*args.materials)
    geometry = _cli.with_dimensions(FingerGeometry(), args.dimension)
    start = time.perf_counter()
    result = _run(geometry, materials, density, choose=args.choose_sector)
    write_artifact(result, out)
    if args.json is not None:
        _cli.write_json(args.json, summary(result, time.perf_counter() - start))
    angle = result.fit.surrogate.tip_angle_deg(TARGET_PRESSURE_PA_GAUGE)
    sector = np.rad2deg(result.geometry.sector_half_angle_rad)
    print(f"{out}: {angle:.1f} degrees at 75 kPa with a palm sector of +-{sector:.1f} degrees")
    return 0


def _run(geometry: FingerGeometry, materials: Materials, density: Density, *, choose: bool) -> Calibration:
    steps = len(density.pressures_pa_gauge) + len(LOADS_N) + 1 + len(FINGER_PATH.targets)
    work: Callable[..., Calibration] = choose_sector if choose else calibrate
    with tqdm(total=None if choose else steps, desc="load steps", unit="step") as bar:
        return work(geometry, materials, density, progress=lambda: bar.update(1))


def summary(c: Calibration, wall_s: float) -> dict[str, Any]:
    """Return what ``--json`` writes."""
    a, x, f = c.actuator, c.exoskeleton, c.finger
    return {
        "pressure_pa_gauge": a.pressure_pa_gauge.tolist(),
        "actuator_elongation": a.elongation.tolist(),
        "actuator_volume_m3": a.volume_m3.tolist(),
        "actuator_radial_growth_m": a.radial_growth_m.tolist(),
        "actuator_max_stretch": a.max_stretch.tolist(),
        "actuator_status": a.status.value,
        "load_n": x.load_n.tolist(),
        "exoskeleton_tip_deflection_m": x.tip_deflection_m.tolist(),
        "exoskeleton_joint_angle_rad": x.angle_rad.tolist(),
        "exoskeleton_status": x.status.value,
        "finger_branch": list(f.branch),
        "finger_pressure_pa_gauge": f.pressure_pa_gauge.tolist(),
        "finger_joint_angle_rad": f.joint_angle_rad.tolist(),
        "finger_volume_m3": f.volume_m3.tolist(),
        "finger_status": f.status.value,
        "tip_angle_deg_at_75_kpa": c.fit.surrogate.tip_angle_deg(TARGET_PRESSURE_PA_GAUGE),
        "sector_half_angle_rad": c.geometry.sector_half_angle_rad,
        "fit_rmse": dict(c.fit.rmse),
        "dofs": {"actuator": a.dofs, "exoskeleton": x.dofs, "finger": f.dofs},
        "newton_iterations": {"actuator": a.iterations, "exoskeleton": x.iterations, "finger": f.iterations},
        "density": c.density.name,
        "wall_s": wall_s,
    }


def main(argv: list[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
