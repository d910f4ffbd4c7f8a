import base64
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from fea.exoskeleton import ExoskeletonMesh, exoskeleton_lattice
from fea.lattice import build_mesh
from fea.vtu import write_vtu

TYPES = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}


@pytest.fixture(scope="module")
def mesh(geometry):
    return build_mesh(exoskeleton_lattice(geometry, ExoskeletonMesh(gap_cells=1, segment_cells=1, wall_cells=1)))


def read(path):
    """Arrays of a VTU file after the VTK file format's own rules: a 64-bit length, then the data."""
    arrays = {}
    for array in ET.parse(path).getroot().iter("DataArray"):
        raw = base64.b64decode(array.text)
        assert int.from_bytes(raw[:8], "little") == len(raw) - 8
        values = np.frombuffer(raw[8:], dtype=TYPES[array.get("type")])
        width = int(array.get("NumberOfComponents"))
        arrays[array.get("Name")] = values.reshape(-1, width) if width > 1 else values
    return arrays


def test_file_holds_the_mesh_in_vtk_order(mesh, tmp_path):
    u = np.random.default_rng(0).normal(size=mesh.points_m.shape)
    cells = np.arange(len(mesh.elements), dtype=float)
    path = tmp_path / "fields.vtu"
    write_vtu(path, mesh, nodes={"displacement_m": u}, cells={"number": cells})
    data = read(path)
    assert [p.name for p in tmp_path.iterdir()] == ["fields.vtu"]
    np.testing.assert_array_equal(data["points"], mesh.points_m)
    np.testing.assert_array_equal(data["displacement_m"], u)
    np.testing.assert_array_equal(data["number"], cells)
    assert set(data["types"]) == {24}
    np.testing.assert_array_equal(data["offsets"], 10 * np.arange(1, len(cells) + 1))
    elements = data["connectivity"].reshape(-1, 10)
    np.testing.assert_array_equal(np.sort(elements), np.sort(mesh.elements))
    x = mesh.points_m[elements]
    assert (np.linalg.det(x[:, 1:4] - x[:, :1]) > 0.0).all()
    # VTK: nodes 4 to 9 lie on the edges 01 12 20 03 13 23; curved ones leave the chord by less than a third of it
    for node, (a, b) in enumerate([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)], start=4):
        away = np.linalg.norm(x[:, node] - 0.5 * (x[:, a] + x[:, b]), axis=1)
        assert (away < 0.34 * np.linalg.norm(x[:, a] - x[:, b], axis=1)).all()


def test_field_of_wrong_length_is_refused_by_name(mesh, tmp_path):
    with pytest.raises(ValueError, match="von_mises"):
        write_vtu(tmp_path / "f.vtu", mesh, nodes={"von_mises": np.zeros(3)}, cells={})
    assert list(tmp_path.iterdir()) == []
