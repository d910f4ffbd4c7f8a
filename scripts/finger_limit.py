"""Inflate the complete finger by volume, to tell a limit point, a maximum of its pressure, from a failed solve."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

import numpy as np
from tqdm import tqdm

from fea.calibration import load_materials
from fea.checkpoint import code_version
from fea.exoskeleton import section_motions
from fea.finger import CONTACT, FRICTION, MESHES, OPTIONS, FingerModel, finger_model
from fea.geometry import FingerGeometry
from fea.linear_solver import solver_name
from fea.newton import Status
from fea.volume_control import VolumePath, inflate_by_volume
from scripts import _cli
from scripts._finger_markdown import rows

EXAMPLES = """examples:
  python scripts/finger_limit.py --mesh coarse --json out/limit.json
  python scripts/finger_limit.py --mesh coarse --to 1.3 --steps 6 --friction 0
  python scripts/finger_limit.py --dimension gap_length_m=0.0061 --dimension sector_half_angle_rad=1.0472
Ends with status 1 where equilibrium is lost before the last volume, and with 0 at a limit point or without one.
"""


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--mesh", choices=list(MESHES), default="calibration", help="mesh density (%(default)s)")
    _cli.add_materials(p)
    _cli.add_friction(p, FRICTION)
    p.add_argument("--to", type=_cli.positive_float, default=1.7, help="last volume over that at rest (%(default)s)")
    p.add_argument("--steps", type=_cli.positive_int, default=24, help="volumes on the way (%(default)s)")
    _cli.add_dimension(p)
    p.add_common(seed="taken for uniformity; nothing is random", json="write the figures here")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Run; return the exit status."""
    args = parser().parse_args(argv)
    if args.to <= 1.0:
        raise ValueError(f"--to {args.to:g}: must be above 1, the volume at rest")
    geometry = _cli.with_dimensions(FingerGeometry(), args.dimension)
    m = load_materials(*args.materials)
    _cli.check_writable(args.json)
    contact = replace(CONTACT, friction=args.friction)
    model = finger_model(geometry, m.silicone, m.pet, m.tpu, MESHES[args.mesh], contact=contact)
    assert model.solid.cavity is not None
    rest = model.solid.cavity.volume_m3(model.solid.mesh.points_m)
    volumes = [rest * v for v in np.linspace(1.0, args.to, args.steps + 1)[1:]]
    with tqdm(total=len(volumes), desc="volumes", unit="state") as bar:
        path = inflate_by_volume(model.solid, volumes, OPTIONS, contact=model.contact, progress=bar.update)
    found = figures(path, model, geometry)
    if args.json is not None:
        more = {
            "mesh": args.mesh,
            "geometry": geometry.as_dict(),
            "materials": args.materials,
            "friction": args.friction,
        }
        _cli.write_json(args.json, found | more | {"linear_solver": solver_name(), "code_sha256": code_version()})
    print(markdown(found))
    return 0 if path.status is Status.CONVERGED or path.limit is not None else 1


def figures(path: VolumePath, model: FingerModel, geometry: FingerGeometry) -> dict[str, Any]:
    """Return the states of the whole finger, JSON ready."""
    tips = [section_motions(model.solid.mesh, geometry, u)[-1][0] for u in path.u_m]
    limit = path.limit
    return {
        "status": path.status.value,
        "volume_m3": (2.0 * path.volume_m3).tolist(),
        "pressure_pa_gauge": path.pressure_pa_gauge.tolist(),
        "slope_pa_per_m3": (0.5 * path.slope_pa_per_m3).tolist(),
        "tip_angle_deg": np.rad2deg(tips).tolist(),
        "limit_pressure_pa_gauge": None if limit is None else limit.pressure_pa_gauge,
        "limit_volume_m3": None if limit is None else 2.0 * limit.volume_m3,
        "newton_iterations": path.iterations,
        "dofs": len(model.solid.free),
    }


def markdown(found: dict[str, Any]) -> str:
    """Return the states as a table and what was found as a sentence."""
    header = ("chamber, mm3", "kPa", "slope, kPa/mm3", "tip, degrees")
    columns = (found[name] for name in ("volume_m3", "pressure_pa_gauge", "slope_pa_per_m3", "tip_angle_deg"))
    body = [
        (f"{1e9 * v:.0f}", f"{1e-3 * p:.2f}", f"{1e-12 * s:.4f}", f"{angle:.1f}")
        for v, p, s, angle in zip(*columns, strict=True)
    ]
    if found["limit_pressure_pa_gauge"] is not None:
        said = f"limit point at {1e-3 * found['limit_pressure_pa_gauge']:.2f} kPa"
    else:
        said = "no limit point" if body else "no state reached"
    return f"{rows(header, body)}\n\n{said}; {found['status']}, {found['newton_iterations']} iterations"


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
