"""Analysis (iii) for several flexure thicknesses beside the shipped calibration's surrogate: a Markdown table."""

import json
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

import numpy as np
from tqdm import tqdm

from assets import asset_path
from fea.calibration import Materials, load_materials
from fea.finger import MESHES, PRESSURES_PA_GAUGE, FingerMesh, FingerResult, analyse_finger, finger_model
from fea.geometry import FingerGeometry
from scripts import _cli

EXAMPLES = """examples:
  python scripts/finger_table.py --flexure 3.3 --json out/finger.json   # a minute or two each on two free cores
  python scripts/finger_table.py --flexure 3.3 --to 10 --mesh coarse    # the first three pressures
"""


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--flexure", type=_cli.positive_float, nargs="+", default=[3.3], metavar="MM", help="thicknesses")
    p.add_argument("--mesh", choices=sorted(MESHES), default="coarse", help="mesh density (%(default)s)")
    p.add_argument("--to", type=_cli.positive_float, default=80.0, metavar="KPA", help="highest pressure (%(default)s)")
    p.add_common(seed="taken for uniformity; nothing is random", json="write the curves here")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Run the analyses; return the exit status."""
    args = parser().parse_args(argv)
    _cli.check_writable(args.json)
    pressures = [p for p in PRESSURES_PA_GAUGE if p <= 1e3 * args.to]
    if not pressures:
        raise ValueError(f"--to = {args.to} kPa must be at least {1e-3 * PRESSURES_PA_GAUGE[0]:g}")
    geometries = [replace(FingerGeometry(), flexure_thickness_m=round(1e-3 * t, 7)) for t in args.flexure]
    materials, runs = load_materials(), []
    for geometry in geometries:
        run = _run(geometry, materials, MESHES[args.mesh], pressures)
        print(table(run))
        runs.append(run)
    if args.json is not None:
        _cli.write_json(args.json, {"mesh": args.mesh, "runs": runs})
    return 0


def _run(geometry: FingerGeometry, materials: Materials, mesh: FingerMesh, pressures: list[float]) -> dict[str, Any]:
    start = time.perf_counter()
    model = finger_model(geometry, materials.silicone, materials.pet, materials.tpu, mesh)
    with tqdm(total=len(pressures), desc="pressures", unit="step") as bar:
        result = analyse_finger(model, geometry, pressures, progress=lambda: bar.update(1))
    return summary(geometry, result) | {"wall_s": time.perf_counter() - start}


def summary(geometry: FingerGeometry, r: FingerResult) -> dict[str, Any]:
    """Return one run, JSON ready; a gap beyond the clearance is null."""
    return {
        "flexure_thickness_m": geometry.flexure_thickness_m,
        "branch": ["loading"] * len(r.pressure_pa_gauge),
        "pressure_pa_gauge": r.pressure_pa_gauge.tolist(),
        "tip_angle_deg": np.rad2deg(r.tip_angle_rad).tolist(),
        "joint_rotation_rad": r.joint_angle_rad.tolist(),
        "tip_displacement_m": r.tip_displacement_m.tolist(),
        "volume_m3": r.volume_m3.tolist(),
        "minimum_gap_m": [float(gap) if np.isfinite(gap) else None for gap in r.minimum_gap_m],
        "contact_force_n": r.contact_force_n.tolist(),
        "status": r.status.value,
        "newton_iterations": r.iterations,
        "dofs": r.dofs,
    }


def table(run: dict[str, Any]) -> str:
    """Return the run as Markdown, with the surrogate of the shipped calibration in the last column."""
    calibration = json.loads((asset_path("calibration") / "finger.json").read_text(encoding="utf-8"))
    curve, shipped = calibration["curve"], calibration["geometry"]["flexure_thickness_m"]
    lines = [
        f"\nFlexure {1e3 * run['flexure_thickness_m']:.2f} mm, {run['dofs']} degrees of freedom, "
        f"{run['newton_iterations']} iterations, {run['status']}\n",
        f"| kPa | tip, degrees | joints 1 / 2 / 3 | tip moved, mm | chamber volume | least gap, mm | "
        f"contact, N | surrogate ({1e3 * shipped:.2f} mm), degrees |",
        "|---|---|---|---|---|---|---|---|",
    ]
    keys = [
        *("pressure_pa_gauge", "tip_angle_deg", "joint_rotation_rad", "tip_displacement_m", "volume_m3"),
        *("minimum_gap_m", "contact_force_n"),
    ]
    for p, tip, joints, moved, volume, gap, force in list(zip(*(run[k] for k in keys), strict=True))[1:]:
        model = float(np.interp(p, curve["pressure_pa_gauge"], curve["tip_angle_deg"]))
        lines.append(
            f"| {1e-3 * p:g} | {tip:.1f} | {' / '.join(f'{q:.1f}' for q in np.rad2deg(joints))} | {1e3 * moved:.1f} | "
            f"{100.0 * (volume / run['volume_m3'][0] - 1.0):+.1f} % | {'-' if gap is None else f'{1e3 * gap:.3f}'} | "
            f"{force:.2f} | {model:.1f} |"
        )
    return "\n".join(lines)


def main(argv: list[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
