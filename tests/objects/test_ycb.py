"""A YCB folder as downloaded: which mesh, which mass, which errors."""

import json

import pytest
import trimesh

from softhand_sim.objects.catalogue import load_catalogue
from softhand_sim.objects.ycb import INDEX, load_ycb_object, ycb_mesh, ycb_names


@pytest.fixture(autouse=True)
def _own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("SOFTHAND_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def folder(tmp_path):
    """Two objects: one with all scans (of different sizes), one with the coarse scan only."""
    root = tmp_path / "ycb"
    for file, radius in (
        ("013_apple/google_16k/textured.obj", 0.0375),
        ("013_apple/google_16k/nontextured.stl", 0.036),
        ("013_apple/tsdf/nontextured.stl", 0.035),
        ("054_softball/tsdf/nontextured.ply", 0.048),
    ):
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        trimesh.creation.icosphere(subdivisions=3, radius=radius).export(root / file)
    return root


def test_names_come_from_folders_or_from_the_index(folder):
    assert ycb_names(folder) == ("013_apple", "054_softball")
    (folder / INDEX).write_text(json.dumps({"objects": ["054_softball", "054_softball", "001_chips_can"]}))
    assert ycb_names(folder) == ("054_softball", "001_chips_can")
    with pytest.raises(FileNotFoundError, match="001_chips_can"):
        load_ycb_object(folder, "001_chips_can")


@pytest.mark.parametrize("text", ["[1]", '{"objects": [1]}', "{", '{"objects": []}'])
def test_wrong_index_is_refused(folder, text):
    (folder / INDEX).write_text(text)
    with pytest.raises(ValueError, match=str(folder)):
        ycb_names(folder)


def test_best_scan_and_the_catalogue_s_mass_are_taken(folder):
    apple = load_ycb_object(folder, "013_apple")
    assert apple.name == "013_apple"
    assert apple.mass_kg == load_catalogue()["apple"].mass_kg
    assert apple.friction == load_catalogue()["apple"].friction
    assert apple.extents_m == pytest.approx([0.075] * 3, rel=0.01)
    assert ycb_mesh(folder, "054_softball").as_posix().endswith("tsdf/nontextured.ply")
    assert load_ycb_object(folder, "054_softball", mass_kg=0.5, friction=0.1).mass_kg == 0.5


def test_unknown_mass_missing_mesh_and_missing_folder_are_named(folder):
    (folder / "013_apple").rename(folder / "999_thing")
    with pytest.raises(ValueError, match="no mass of '999_thing'"):
        load_ycb_object(folder, "999_thing")
    assert load_ycb_object(folder, "999_thing", mass_kg=0.1).mass_kg == 0.1
    (folder / "014_lemon").mkdir()
    with pytest.raises(FileNotFoundError, match="014_lemon: no mesh"):
        load_ycb_object(folder, "014_lemon")
    with pytest.raises(FileNotFoundError, match="no YCB folder"):
        ycb_names(folder / "nowhere")


def test_paths_outside_the_folder_are_refused(folder, tmp_path):
    (tmp_path / "elsewhere" / "google_16k").mkdir(parents=True)
    trimesh.creation.icosphere(radius=0.03).export(tmp_path / "elsewhere/google_16k/textured.obj")
    for name in ("../elsewhere", str(tmp_path / "elsewhere")):
        with pytest.raises(ValueError, match="outside the folder"):
            load_ycb_object(folder, name, mass_kg=0.1)
    (folder / "015_peach").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(ValueError, match="outside the folder"):
        load_ycb_object(folder, "015_peach")


def test_a_texture_beside_the_scan_is_fine_and_one_outside_is_not(folder):
    scan = folder / "013_apple/google_16k/textured.obj"
    text = scan.read_text()
    for library, fine in (("textured.mtl", True), ("../../shared.mtl", True), ("../../../shared.mtl", False)):
        scan.write_text(f"mtllib {library}\n{text}")
        if fine:
            load_ycb_object(folder, "013_apple")
        else:
            with pytest.raises(ValueError, match="outside the folder"):
                load_ycb_object(folder, "013_apple")
