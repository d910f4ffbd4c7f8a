"""A user's mesh file: what is refused, what is repaired, how it is split and cached."""

import logging

import mujoco
import numpy as np
import pytest
import trimesh
from dm_control import mjcf

from softhand_sim.objects.loader import load_mesh_object
from softhand_sim.objects.mass import is_closed, mass_properties
from softhand_sim.objects.mjcf import attach_object


@pytest.fixture(autouse=True)
def _own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("SOFTHAND_CACHE", str(tmp_path / "cache"))


def l_shape():
    """An L of 60 x 20 x 60 mm with legs 20 mm thick, as one closed surface; volume 40 mL of a hull of 56 mL."""
    outline = 0.02 * np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], dtype=float)
    n = len(outline)
    front = np.column_stack([outline[:, 0], np.zeros(n), outline[:, 1]])
    back = front + np.array([0, 0.02, 0])
    cap = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)])
    ring = np.arange(n)
    after = np.roll(ring, -1)
    sides = np.vstack([np.column_stack([ring, ring + n, after]), np.column_stack([after, ring + n, after + n])])
    faces = np.vstack([cap, cap[:, ::-1] + n, sides])
    return trimesh.Trimesh(np.vstack([front, back]), faces, process=False)


def saved(mesh, path):
    mesh.export(path)
    return path


@pytest.mark.parametrize("ending", ["obj", "stl", "ply", "glb"])
def test_every_format_gives_the_same_box(tmp_path, ending):
    box = trimesh.creation.box((0.06, 0.04, 0.02))
    box.apply_transform(trimesh.transformations.rotation_matrix(0.7, (1, 2, 3), (0.1, 0.2, 0.3)))
    model = load_mesh_object(saved(box, tmp_path / f"brick.{ending}"), mass_kg=0.12)
    assert model.name == "brick"
    assert len(model.convex_parts) == 1
    assert model.mesh.volume == pytest.approx(0.06 * 0.04 * 0.02, rel=1e-4)
    # most probable: on its largest face, whatever the frame of the file
    assert model.rest_height_m == pytest.approx(0.01, rel=1e-3)
    expected = 0.12 / 12 * np.array([0.04**2 + 0.02**2, 0.06**2 + 0.02**2, 0.06**2 + 0.04**2])
    assert np.allclose(np.linalg.eigvalsh(model.inertia_kg_m2), np.sort(expected), rtol=1e-3)
    props = mass_properties(model.mesh)
    assert np.abs(props.centre_m).max() < 1e-6
    # the inertia is along the axes of the turned mesh, not of the file
    expected = props.inertia_m5 * 0.12 / props.volume_m3
    assert np.allclose(model.inertia_kg_m2, expected, rtol=1e-4, atol=1e-4 * expected.max())


def test_scene_of_parts_that_touch_is_taken_as_one(tmp_path):
    scene = trimesh.Scene()
    for x in (0.0, 0.03):
        part = trimesh.creation.box((0.03, 0.03, 0.03))
        scene.add_geometry(part, transform=trimesh.transformations.translation_matrix((x, 0, 0)))
    path = tmp_path / "pair.glb"
    scene.export(path)
    model = load_mesh_object(path, mass_kg=0.1)
    assert model.mesh.volume == pytest.approx(2 * 0.03**3, rel=1e-4)
    assert sorted(model.extents_m) == pytest.approx([0.03, 0.03, 0.06], rel=1e-3)


def test_missing_file(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no mesh file at .*nowhere\.obj"):
        load_mesh_object(tmp_path / "nowhere.obj", mass_kg=0.1)


def refused(path, match, **changes):
    with pytest.raises(ValueError, match=match) as caught:
        load_mesh_object(path, **{"mass_kg": 0.1, **changes})
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("ending", ["obj", "stl", "ply", "glb"])
def test_text_instead_of_a_mesh(tmp_path, ending):
    path = tmp_path / f"letter.{ending}"
    path.write_text("Dear sir or madam,\nthis is not a mesh.\n", encoding="utf-8")
    refused(path, r"letter\.\w+: (not a readable mesh|the mesh is empty)")


@pytest.mark.parametrize("ending", ["obj", "stl", "ply", "glb"])
def test_empty_file(tmp_path, ending):
    path = tmp_path / f"nothing.{ending}"
    path.write_bytes(b"")
    refused(path, r"nothing\.\w+: (not a readable mesh|the mesh is empty)")


def test_unknown_format_and_folder(tmp_path):
    path = tmp_path / "thing.docx"
    path.write_text("x", encoding="utf-8")
    refused(path, r"'\.docx' is not one of")
    refused(tmp_path, "is a folder")


def test_points_without_triangles(tmp_path):
    path = tmp_path / "points.obj"
    path.write_text("v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\n", encoding="utf-8")
    refused(path, r"points\.obj: (the mesh is empty|not a readable mesh)")


@pytest.mark.parametrize("bad", ["nan", "inf"])
def test_vertex_that_is_not_finite(tmp_path, bad):
    path = saved(trimesh.creation.icosphere(subdivisions=1, radius=0.03), tmp_path / "ball.obj")
    lines = path.read_text(encoding="utf-8").splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("v "))
    lines[first] = f"v {bad} 0 0"
    path.write_text("\n".join(lines), encoding="utf-8")
    refused(path, r"ball\.obj: 1 of 42 vertices .* NaN or infinite")


def test_millimetres_are_refused_and_scale_mends_them(tmp_path):
    path = saved(trimesh.creation.icosphere(radius=37.5), tmp_path / "apple.stl")
    refused(path, r"largest side is 75 m, allowed 0\.005 m to 1\.0 m; probably millimetres; use --scale 0\.001")
    model = load_mesh_object(path, mass_kg=0.068, scale=0.001)
    assert model.extents_m == pytest.approx([0.075] * 3, rel=0.01)


def test_tiny_flat_and_bad_scale(tmp_path):
    path = saved(trimesh.creation.icosphere(radius=0.5e-3), tmp_path / "grain.stl")
    refused(path, r"largest side is 0\.001 m")
    refused(path, "scale is -1", scale=-1.0)
    refused(path, "scale is nan", scale=float("nan"))
    sheet = trimesh.Trimesh([(0, 0, 0), (0.1, 0, 0), (0.1, 0.1, 0), (0, 0.1, 0)], [(0, 1, 2), (0, 2, 3)])
    refused(saved(sheet, tmp_path / "sheet.ply"), "thinnest side is 0 m")


@pytest.mark.parametrize("mass", [-0.1, 0.0, float("nan")])
def test_impossible_mass_is_refused_before_the_file_is_read(tmp_path, mass):
    refused(tmp_path / "nowhere.obj", "mass_kg is", mass_kg=mass)
    refused(tmp_path / "nowhere.obj", "friction is", friction=-0.1)


def test_inverted_and_holed_surfaces_are_repaired(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.03)
    whole = ball.volume
    inside_out = trimesh.Trimesh(ball.vertices, ball.faces[:, ::-1], process=False)
    holed = trimesh.Trimesh(ball.vertices, ball.faces[1:], process=False)
    for mesh in (inside_out, holed):
        model = load_mesh_object(saved(mesh, tmp_path / "ball.ply"), mass_kg=0.05)
        assert is_closed(model.mesh)
        assert model.mesh.volume == pytest.approx(whole, rel=1e-3)
        assert any("repaired" in note for note in model.notes)


def test_open_surface_takes_the_mass_centre_of_its_parts(tmp_path):
    # five sides of a cube, a hole too large to fill: a thin open box, not a solid cube
    box = trimesh.creation.box((0.06, 0.06, 0.06)).subdivide()
    box.update_faces(box.triangles_center[:, 2] < 0.0299)
    model = load_mesh_object(saved(box, tmp_path / "open.ply"), mass_kg=0.05, keep_upright=True)
    assert any("stays open" in note for note in model.notes)
    assert model.extents_m == pytest.approx([0.06] * 3, rel=0.02)
    # four walls about the middle and a floor: 2/5 of the side above the floor
    assert model.rest_height_m == pytest.approx(0.024, rel=0.05)
    assert sum(part.volume for part in model.convex_parts) < 0.5 * 0.06**3


def test_concave_mesh_is_split_and_cached(tmp_path, monkeypatch):
    path = saved(l_shape(), tmp_path / "angle.obj")
    model = load_mesh_object(path, mass_kg=0.1)
    assert model.mesh.volume == pytest.approx(40e-6, rel=1e-3)
    assert len(model.convex_parts) >= 2
    assert sum(part.volume for part in model.convex_parts) == pytest.approx(40e-6, rel=0.1)
    hull_volume = model.mesh.convex_hull.volume
    assert sum(part.volume for part in model.convex_parts) < 0.85 * hull_volume
    # uniform density, whichever way the L lies: mass centre of the two bars
    bars = [((0.06, 0.02, 0.02), (0.03, 0.01, 0.01)), ((0.02, 0.02, 0.04), (0.01, 0.01, 0.04))]
    mean = sum(np.prod(s) * np.array(c) for s, c in bars) / 40e-6
    inertia = np.zeros((3, 3))
    for size, centre in bars:
        d, square = np.array(centre) - mean, np.square(size)
        inertia += np.prod(size) * (np.diag(square.sum() - square) / 12 + d @ d * np.eye(3) - np.outer(d, d))
    expected = np.linalg.eigvalsh(inertia * 0.1 / 40e-6)
    assert np.allclose(np.linalg.eigvalsh(model.inertia_kg_m2), expected, rtol=1e-3)

    files = list((tmp_path / "cache").rglob("*"))
    assert [f.suffix for f in files if f.is_file()] == [".npz"]  # and no temporary file left

    def unreachable(*_args, **_kwargs):
        raise AssertionError("decomposed again although cached")

    with monkeypatch.context() as patch:
        patch.setattr("softhand_sim.objects.decompose._run_coacd", unreachable)
        again = load_mesh_object(path, mass_kg=0.2)
        for a, b in zip(model.convex_parts, again.convex_parts, strict=True):
            assert a.vertices.tobytes() == b.vertices.tobytes()
        other = saved(l_shape().apply_scale(1.1), tmp_path / "other.obj")
        with pytest.raises(AssertionError, match="decomposed again"):
            load_mesh_object(other, mass_kg=0.1)


def test_decomposition_is_the_same_without_the_cache(tmp_path, monkeypatch):
    path = saved(l_shape(), tmp_path / "angle.obj")
    first = load_mesh_object(path, mass_kg=0.1)
    monkeypatch.setenv("SOFTHAND_CACHE", str(tmp_path / "another"))
    second = load_mesh_object(path, mass_kg=0.1)
    for a, b in zip(first.convex_parts, second.convex_parts, strict=True):
        assert a.vertices.tobytes() == b.vertices.tobytes()


def test_damaged_cache_file_is_made_again(tmp_path, caplog):
    path = saved(l_shape(), tmp_path / "angle.obj")
    first = load_mesh_object(path, mass_kg=0.1)
    (stored,) = (tmp_path / "cache").rglob("*.npz")
    stored.write_bytes(b"not a zip file")
    with caplog.at_level(logging.WARNING):
        second = load_mesh_object(path, mass_kg=0.1)
    assert "damaged" in caplog.text
    assert first.convex_parts[0].vertices.tobytes() == second.convex_parts[0].vertices.tobytes()
    assert np.load(stored, allow_pickle=False)["vertices"].shape[1] == 3


def test_unwritable_cache_is_no_error(tmp_path, monkeypatch, caplog):
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    monkeypatch.setenv("SOFTHAND_CACHE", str(tmp_path / "file"))
    with caplog.at_level(logging.WARNING):
        model = load_mesh_object(saved(l_shape(), tmp_path / "angle.obj"), mass_kg=0.1)
    assert len(model.convex_parts) >= 2
    assert "not cached" in caplog.text


def test_decomposition_prints_nothing(tmp_path, capfd):
    load_mesh_object(saved(l_shape(), tmp_path / "angle.obj"), mass_kg=0.1)
    assert capfd.readouterr() == ("", "")


def test_upright_pose_on_demand(tmp_path):
    slab = trimesh.creation.box((0.03, 0.06, 0.12))  # z up, standing on its smallest face
    path = saved(slab, tmp_path / "slab.stl")
    assert load_mesh_object(path, mass_kg=0.1).rest_height_m == pytest.approx(0.015, rel=1e-3)
    assert load_mesh_object(path, mass_kg=0.1, keep_upright=True).rest_height_m == pytest.approx(0.06, rel=1e-3)


def test_user_mesh_rests_in_the_engine(tmp_path):
    model = load_mesh_object(saved(l_shape(), tmp_path / "angle.obj"), mass_kg=0.1)
    root = mjcf.RootElement()
    root.worldbody.add("geom", type="plane", size=(1, 1, 0.1))
    attach_object(root, model).pos = (0, 0, model.rest_height_m)
    compiled = mujoco.MjModel.from_xml_string(root.to_xml_string())
    data = mujoco.MjData(compiled)
    for _ in range(1000):
        mujoco.mj_step(compiled, data)
    assert data.qpos[2] == pytest.approx(model.rest_height_m, abs=3e-4)
    assert np.linalg.norm(data.qpos[:2]) < 5e-4
    assert not any(warning.number for warning in data.warning)
