"""STL files of the exoskeleton, the actuator and the actuator's mould, in millimetres, ready for a slicer."""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

if sys.path and Path(sys.path[0]).resolve() == Path(__file__).resolve().parent:
    # started by its path: the script ``fea.py`` beside this one would hide the package ``fea``
    sys.path[0] = str(Path(__file__).resolve().parents[1])

import trimesh

from fea.geometry import MINIMUM_WALL_M, FingerGeometry
from fea.surface import actuator_surface, exoskeleton_surface, mould_core, mould_shell, thinnest_wall_m
from scripts import _cli

EXAMPLES = """examples:
  export_stl.py --out out/stl
  export_stl.py --dimension flexure_thickness_m=0.0035 --out out/stl
Each layer of the actuator is cast in a two-part mould: its shell and the common core.
"""
PARTS: dict[str, Callable[[FingerGeometry], trimesh.Trimesh]] = {
    "exoskeleton": exoskeleton_surface,
    "actuator": actuator_surface,
    "mould_core": mould_core,
    "mould_shell_first_layer": lambda geometry: mould_shell(geometry, first_layer=True),
    "mould_shell": mould_shell,
}


def parser() -> _cli.Parser:
    """Return the command line."""
    p = _cli.Parser(description=__doc__, examples=EXAMPLES)
    p.add_argument("--out", type=Path, required=True, help="folder of the STL files")
    _cli.add_dimension(p)
    p.add_common(seed="taken for uniformity; nothing is random", json="write volumes and thinnest walls here")
    return p


def job(argv: Sequence[str] | None = None) -> int:
    """Write the files; return the exit status.

    Raises
    ------
    ValueError
        If a dimension is refused, or a part is not watertight or has a wall below 2 mm.
    """
    args = parser().parse_args(argv)
    geometry = _cli.with_dimensions(FingerGeometry(), args.dimension)
    _cli.check_writable(args.json)
    _cli.check_writable(args.out / "exoskeleton.stl", "--out")
    surfaces = {name: make(geometry) for name, make in PARTS.items()}
    facts = {}
    for name, surface in surfaces.items():
        wall = thinnest_wall_m(surface)
        if not surface.is_watertight:
            raise ValueError(f"{name}: surface is not watertight")
        # chords of the facets stand nearer than the circles
        if wall < MINIMUM_WALL_M - 1e-5:
            raise ValueError(f"{name}: wall of {wall:.6g} m must be at least {MINIMUM_WALL_M} m")
        facts[name] = {"volume_m3": float(surface.volume), "thinnest_wall_m": wall, "triangles": len(surface.faces)}
    for name, surface in surfaces.items():
        file = args.out / f"{name}.stl"
        data = surface.copy().apply_scale(1e3).export(file_type="stl")
        _cli.write_bytes(file, data)
        fact = facts[name]
        print(f"{file}: {1e6 * fact['volume_m3']:.2f} cm3, thinnest wall {1e3 * fact['thinnest_wall_m']:.2f} mm")
    if args.json is not None:
        _cli.write_json(args.json, {"parts": facts, "geometry": geometry.as_dict()})
    return 0


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point."""
    return _cli.run(job, argv)


if __name__ == "__main__":
    sys.exit(main())
