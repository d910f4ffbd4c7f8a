"""Fields as VTU (VTK XML) files of curved quadratic tetrahedra, which ParaView opens; no library needed."""

import base64
import os
from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from fea.arrays import F64
from fea.lattice import SolidMesh

_QUADRATIC_TETRA = 24  # VTK file formats: vertices, then mid-edges 01 12 20 03 13 23
_MIRRORED = [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]
_TYPES = {np.dtype("<f8"): "Float64", np.dtype("<i8"): "Int64", np.dtype("u1"): "UInt8"}


def write_vtu(path: Path, mesh: SolidMesh, *, nodes: Mapping[str, F64], cells: Mapping[str, F64]) -> None:
    """Write a mesh with node fields ([n_nodes] or [n_nodes, 3]) and element fields ([n_elements]), in one piece.

    Raises
    ------
    ValueError
        If a field has the wrong length; the message names it.
    """
    for fields, length in ((nodes, len(mesh.points_m)), (cells, len(mesh.elements))):
        for name, values in fields.items():
            if len(values) != length:
                raise ValueError(f"{name}: {len(values)} values, must be {length}")
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    partial.write_text(_document(mesh, nodes, cells), encoding="ascii")
    partial.replace(path)


def positive_elements(mesh: SolidMesh) -> np.ndarray:
    """Return elements [n, 10] in VTK's order with positive volume."""
    corners = mesh.points_m[mesh.elements[:, :4]]
    negative = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0.0
    return np.where(negative[:, None], mesh.elements[:, _MIRRORED], mesh.elements)


def _document(mesh: SolidMesh, nodes: Mapping[str, F64], cells: Mapping[str, F64]) -> str:
    count = len(mesh.elements)
    topology = {
        "connectivity": positive_elements(mesh).ravel(),
        "offsets": 10 * np.arange(1, count + 1),
        "types": np.full(count, _QUADRATIC_TETRA, dtype="u1"),
    }
    return "\n".join(
        [
            '<?xml version="1.0"?>',
            '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
            f'<UnstructuredGrid><Piece NumberOfPoints="{len(mesh.points_m)}" NumberOfCells="{count}">',
            _section("Points", {"points": mesh.points_m}),
            _section("Cells", topology),
            _section("PointData", nodes),
            _section("CellData", cells),
            "</Piece></UnstructuredGrid></VTKFile>\n",
        ]
    )


def _section(name: str, arrays: Mapping[str, np.ndarray]) -> str:
    return f"<{name}>\n" + "".join(_data_array(key, values) for key, values in arrays.items()) + f"</{name}>"


def _data_array(name: str, values: np.ndarray) -> str:
    little = np.ascontiguousarray(values, dtype="u1" if values.dtype == np.uint8 else f"<{values.dtype.kind}8")
    components = 1 if little.ndim == 1 else little.shape[1]
    raw = little.tobytes()
    text = base64.b64encode(np.uint64(len(raw)).tobytes() + raw).decode("ascii")
    kind = _TYPES[little.dtype]
    return (
        f'<DataArray type="{kind}" Name={quoteattr(name)} NumberOfComponents="{components}" format="binary">\n'
        f"{text}\n</DataArray>\n"
    )
