"""Meshes as they come: what is mended, and what is refused with a reason."""

import json

import numpy as np
import pytest
import trimesh

from softhand_sim.objects.loader import WORKING_FACES, load_mesh_object
from softhand_sim.objects.mass import is_closed, mass_properties

BALL_M3 = 4 / 3 * np.pi * 0.03**3


@pytest.fixture(autouse=True)
def _own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("SOFTHAND_CACHE", str(tmp_path / "cache"))


def ball(radius=0.03, at=(0.0, 0.0, 0.0), subdivisions=3):
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    mesh.apply_translation(at)
    return mesh


def inverted(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)


def together(*meshes):
    whole = trimesh.util.concatenate(meshes)
    return trimesh.Trimesh(whole.vertices, whole.faces, process=False)


def saved(mesh, path):
    mesh.export(path)
    return path


def refused(path, match, **options):
    with pytest.raises(ValueError, match=match) as caught:
        load_mesh_object(path, mass_kg=0.1, **options)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_two_bodies_apart_are_refused_and_touching_ones_are_not(tmp_path):
    apart = together(ball(), ball(at=(0.1, 0.0, 0.0)))
    refused(saved(apart, tmp_path / "apart.ply"), r"separate bodies, up to 40\.\d mm apart")
    box = trimesh.creation.box((0.06, 0.06, 0.02))
    lid = trimesh.creation.box((0.05, 0.05, 0.015))
    lid.apply_translation((0.0, 0.0, 0.0175))
    model = load_mesh_object(saved(together(box, lid), tmp_path / "one.ply"), mass_kg=0.1)
    assert model.mesh.volume == pytest.approx(0.06 * 0.06 * 0.02 + 0.05 * 0.05 * 0.015, rel=1e-3)


def test_a_piece_turned_inward_is_turned_outward_but_a_cavity_stays(tmp_path):
    box = trimesh.creation.box((0.06, 0.06, 0.02))
    lid = inverted(trimesh.creation.box((0.05, 0.05, 0.015)))
    lid.apply_translation((0.0, 0.0, 0.0175))
    model = load_mesh_object(saved(together(box, lid), tmp_path / "pair.ply"), mass_kg=0.1)
    assert model.mesh.volume == pytest.approx(0.06 * 0.06 * 0.02 + 0.05 * 0.05 * 0.015, rel=1e-3)
    assert any("1 pieces turned outward" in note for note in model.notes)
    hollow = together(ball(0.04), inverted(ball(0.03)))
    for name, mesh in (("hollow", hollow), ("inside_out", inverted(hollow))):
        model = load_mesh_object(saved(mesh, tmp_path / f"{name}.ply"), mass_kg=0.1)
        assert is_closed(model.mesh)
        assert model.mesh.volume == pytest.approx(4 / 3 * np.pi * (0.04**3 - 0.03**3), rel=0.02)
        r, s = 0.04, 0.03
        shell = 0.4 * 0.1 * (r**5 - s**5) / (r**3 - s**3)
        assert np.allclose(np.linalg.eigvalsh(model.inertia_kg_m2), shell, rtol=0.02)
        assert len(model.convex_parts) == 1  # nothing reaches the cavity


def test_crumbs_of_a_scan_are_dropped(tmp_path):
    model = load_mesh_object(saved(together(ball(), ball(0.0002, (0.05, 0, 0), 0)), tmp_path / "scan.ply"), mass_kg=0.1)
    assert any("1 loose bits dropped" in note for note in model.notes)
    assert model.extents_m == pytest.approx([0.06] * 3, rel=0.01)


def test_a_sheet_askew_a_line_and_a_closed_surface_without_volume(tmp_path):
    square = trimesh.Trimesh([(0, 0, 0), (0.1, 0, 0), (0.1, 0.1, 0), (0, 0.1, 0)], [(0, 1, 2), (0, 2, 3)])
    turn = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))
    askew = trimesh.Trimesh(square.vertices, np.vstack([square.faces, square.faces[:, ::-1]]), process=False)
    askew.apply_transform(turn)
    refused(saved(askew, tmp_path / "sheet.ply"), "flat")
    line = trimesh.Trimesh(
        [(0, 0, 0), (0.03, 0.03, 0.03), (0.06, 0.06, 0.06), (0.09, 0.09, 0.09)], [(0, 1, 2), (1, 2, 3)]
    )
    refused(saved(line, tmp_path / "line.ply"), "flat|proper triangles")
    # a bowl of no thickness: each triangle twice, once each way round
    cap = ball().copy()
    cap.update_faces(cap.triangles_center[:, 2] < 0.0)
    bowl = trimesh.Trimesh(cap.vertices, np.vstack([cap.faces, cap.faces[:, ::-1]]), process=False)
    refused(saved(bowl, tmp_path / "bowl.ply"), "encloses no volume")


def test_zero_area_triangles_do_no_harm(tmp_path):
    mesh = ball()
    a, b, _ = mesh.faces[0]
    dented = trimesh.Trimesh(mesh.vertices, np.vstack([mesh.faces, [(a, b, b), (a, a, a)]]), process=False)
    model = load_mesh_object(saved(dented, tmp_path / "ball.ply"), mass_kg=0.1)
    assert model.mesh.volume == pytest.approx(BALL_M3, rel=0.02)


def test_a_million_triangles_are_reduced(tmp_path):
    fine = ball(subdivisions=8)
    assert len(fine.faces) > 1_000_000
    model = load_mesh_object(saved(fine, tmp_path / "fine.stl"), mass_kg=0.1)
    assert f"reduced from {len(fine.faces)} to {WORKING_FACES} triangles" in model.notes
    assert mass_properties(model.mesh).volume_m3 == pytest.approx(BALL_M3, rel=0.01)
    assert np.allclose(np.linalg.eigvalsh(model.inertia_kg_m2), 0.4 * 0.1 * 0.03**2, rtol=0.01)


def test_a_file_that_is_too_large_is_refused_unread(tmp_path, monkeypatch):
    path = saved(ball(), tmp_path / "ball.stl")
    monkeypatch.setattr("softhand_sim.objects.reader.LARGEST_BYTES", 1000)
    refused(path, "bytes, allowed 1000")


@pytest.mark.parametrize("library", ["../secret.mtl", "/etc/hostname", "link.mtl"])
def test_material_file_outside_the_folder_is_refused(tmp_path, library):
    folder = tmp_path / "given"
    folder.mkdir()
    (tmp_path / "secret.mtl").write_text("newmtl a\n", encoding="utf-8")
    (folder / "link.mtl").symlink_to(tmp_path / "secret.mtl")
    path = saved(ball(), folder / "ball.obj")
    path.write_text(f"mtllib {library}\n" + path.read_text(encoding="utf-8"), encoding="utf-8")
    refused(path, f"names '{library}', which lies outside the folder")


@pytest.mark.parametrize("line", ["map_Kd ../../secret.png", "map_Bump -bm 0.5 ../../secret.png", "bump /etc/hostname"])
def test_texture_outside_the_folder_is_refused(tmp_path, line):
    folder = tmp_path / "given"
    folder.mkdir()
    (folder / "skin.mtl").write_text(f"newmtl a\n{line}\n", encoding="utf-8")
    path = saved(ball(), folder / "ball.obj")
    path.write_text("mtllib skin.mtl\n" + path.read_text(encoding="utf-8"), encoding="utf-8")
    with pytest.raises(ValueError, match=r"skin\.mtl: names '.*', which lies outside"):
        load_mesh_object(path, mass_kg=0.1)
    (folder / "skin.mtl").write_text("newmtl a\nmap_Kd my picture.png\n", encoding="utf-8")
    assert load_mesh_object(path, mass_kg=0.1).mesh.volume == pytest.approx(BALL_M3, rel=0.02)


def test_buffer_of_a_gltf_outside_the_folder_is_refused(tmp_path):
    folder = tmp_path / "given"
    folder.mkdir()
    for name, data in trimesh.exchange.gltf.export_gltf(trimesh.Scene(ball())).items():
        (folder / name).write_bytes(data)
    path = folder / "model.gltf"
    assert load_mesh_object(path, mass_kg=0.1).mesh.volume == pytest.approx(BALL_M3, rel=0.02)
    tree = json.loads(path.read_text(encoding="utf-8"))
    (tmp_path / "secret.bin").write_bytes((folder / tree["buffers"][0]["uri"]).read_bytes())
    tree["buffers"][0]["uri"] = "%2e%2e/secret.bin"
    path.write_text(json.dumps(tree), encoding="utf-8")
    refused(path, "outside the folder")


def test_a_heap_of_triangles_is_refused_at_once(tmp_path):
    corners = np.random.default_rng(0).uniform(-0.04, 0.04, (900, 3))
    heap = trimesh.Trimesh(corners, np.arange(900).reshape(-1, 3), process=False)
    refused(saved(heap, tmp_path / "heap.ply"), "falls into 300 pieces, allowed 50")


def test_a_decomposition_that_hangs_or_dies_costs_its_process_only(tmp_path, monkeypatch):
    bar = trimesh.creation.box((0.09, 0.01, 0.01))
    cross = together(bar, trimesh.creation.box((0.01, 0.09, 0.01)))
    path = saved(cross, tmp_path / "cross.ply")
    ring = saved(trimesh.creation.torus(0.04, 0.01), tmp_path / "ring.ply")
    with monkeypatch.context() as change:
        change.setattr("softhand_sim.objects.decompose.LONGEST_S", 1)
        refused(ring, r"took over 1 s of processor time")
    with monkeypatch.context() as change:
        change.setattr("softhand_sim.objects.decompose.LONGEST_WAIT_S", 0.01)
        refused(path, r"took longer than 0\.01 s")
    monkeypatch.setattr("softhand_sim.objects.decompose.sys.executable", "/bin/false")
    refused(path, "failed \\(status 1: no reason given\\)")


def test_random_bytes_are_refused_in_every_format(tmp_path):
    rng = np.random.default_rng(1)
    for ending in ("obj", "stl", "ply", "glb", "gltf", "off"):
        path = tmp_path / f"noise.{ending}"
        path.write_bytes(rng.bytes(3000))
        with pytest.raises(ValueError, match=f"noise.{ending}"):
            load_mesh_object(path, mass_kg=0.1)
