from dataclasses import replace

import numpy as np
import pytest
import trimesh

from fea.surface import (
    MOULD_WALL_M,
    SECTORS,
    actuator_surface,
    exoskeleton_surface,
    first_layer_radius_m,
    mould_core,
    mould_shell,
    shell_outer_radius_m,
    thinnest_wall_m,
)
from scripts.export_stl import main

# area of a polygon of so many corners over that of its circle
POLYGON = np.sin(2.0 * np.pi / SECTORS) / (2.0 * np.pi / SECTORS)


def disc(radius):
    return np.pi * radius**2 * POLYGON


def exoskeleton_volume(g):
    """Corners lie on the sector's edges: equal cells inside it and equal, slightly different ones outside."""
    inner, outer, thick = g.tube_inner_radius_m, g.tube_outer_radius_m, g.tube_inner_radius_m + g.flexure_thickness_m
    cells = round(SECTORS * g.sector_half_angle_rad / (2.0 * np.pi))
    rest = SECTORS // 2 - cells
    sector = cells * np.sin(g.sector_half_angle_rad / cells)  # area of the full polygon sector over r^2
    whole = sector + rest * np.sin((np.pi - g.sector_half_angle_rad) / rest)
    tube = whole * (outer**2 - inner**2) * (g.actuator_length_m - 3 * g.gap_length_m)
    flexure = sector * (thick**2 - inner**2) * 3 * g.gap_length_m
    return tube + flexure + whole * outer**2 * g.end_plate_m


def actuator_volume(g):
    return disc(g.actuator_outer_radius_m) * g.actuator_length_m - disc(g.actuator_inner_radius_m) * g.chamber_length_m


@pytest.mark.parametrize("thickness", [2.0e-3, 3.6e-3])
def test_exoskeleton_is_watertight_and_has_its_volume(geometry, thickness):
    g = replace(geometry, flexure_thickness_m=thickness)
    surface = exoskeleton_surface(g)
    assert surface.is_watertight
    assert surface.body_count == 1
    assert surface.volume == pytest.approx(exoskeleton_volume(g), rel=1e-9)
    assert thinnest_wall_m(surface) == pytest.approx(2.0e-3, abs=1e-5)


def test_actuator_is_watertight_and_has_its_volume(geometry):
    surface = actuator_surface(geometry)
    assert surface.is_watertight
    assert surface.volume == pytest.approx(actuator_volume(geometry), rel=1e-9)
    assert thinnest_wall_m(surface) == pytest.approx(geometry.actuator_wall_m, abs=1e-5)


def test_mould_leaves_exactly_the_actuator_free(geometry):
    """Shell and core put together: what is open inside the shell is the silicone."""
    g = geometry
    shell, core = mould_shell(g), mould_core(g)
    for part in (shell, core):
        assert part.is_watertight
        assert part.body_count == 1
        assert thinnest_wall_m(part) >= 2.0e-3
    cup = disc(shell_outer_radius_m(g)) * (g.actuator_length_m + MOULD_WALL_M)
    rod = disc(g.actuator_inner_radius_m) * g.chamber_length_m
    assert cup - shell.volume - rod == pytest.approx(actuator_volume(g), rel=1e-9)
    # the rod reaches the inside of the cap
    assert np.ptp(core.vertices[:, 2]) == pytest.approx(MOULD_WALL_M + g.chamber_length_m)
    first = mould_shell(g, first_layer=True)
    assert first.is_watertight
    assert cup - first.volume == pytest.approx(disc(first_layer_radius_m(g)) * g.actuator_length_m, rel=1e-9)


def test_thin_wall_is_found():
    box = trimesh.creation.box(extents=(0.02, 0.0015, 0.02))
    assert thinnest_wall_m(box) == pytest.approx(0.0015)


def test_script_writes_millimetres_and_refuses_by_name(tmp_path, capsys):
    assert main(["--out", str(tmp_path / "stl")]) == 0
    files = sorted(p.name for p in (tmp_path / "stl").iterdir())
    assert files == sorted(
        f"{n}.stl" for n in ("actuator", "exoskeleton", "mould_core", "mould_shell", "mould_shell_first_layer")
    )
    part = trimesh.load_mesh(tmp_path / "stl" / "exoskeleton.stl")
    assert part.is_watertight
    assert part.extents[2] == pytest.approx(92.0)
    capsys.readouterr()
    assert main(["--out", str(tmp_path / "none"), "--dimension", "tube_wall_m=0.0015"]) == 2
    assert "tube_wall_m = 0.0015 m must be at least 0.002" in capsys.readouterr().err
    assert not (tmp_path / "none" / "exoskeleton.stl").exists()
