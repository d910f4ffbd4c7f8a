"""The catalogue's objects against closed forms, and their convex parts against their meshes."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import trimesh
from scipy.integrate import quad
from scipy.spatial import cKDTree

from softhand_sim.objects.blocks import blocks
from softhand_sim.objects.catalogue import load_catalogue, make_object
from softhand_sim.objects.mass import combined, is_closed, mass_properties
from softhand_sim.objects.shapes import GENERATORS
from softhand_sim.objects.shapes.apple import apple_profile

NAMES = tuple(load_catalogue())
# winding numbers are slow: one object of each kind, and those whose wall or handle is largest
SAMPLED = (*{entry.kind: name for name, entry in load_catalogue().items()}.values(), "mug", "bowl")
FACETING = 0.01  # inscribed polyhedra of 60 sides or more lose well under 1 %


def boxes(sizes_and_centres):
    """Volume, mass centre and inertia (density 1) of boxes, by the parallel-axis theorem."""
    volumes = np.array([np.prod(size) for size, _ in sizes_and_centres])
    centres = np.array([centre for _, centre in sizes_and_centres])
    mean = volumes @ centres / volumes.sum()
    inertia = np.zeros((3, 3))
    for volume, (size, centre) in zip(volumes, sizes_and_centres, strict=True):
        square = np.asarray(size) ** 2
        d = np.asarray(centre) - mean
        inertia += volume * (np.diag(square.sum() - square) / 12 + d @ d * np.eye(3) - np.outer(d, d))
    return volumes.sum(), mean, inertia


@cache
def made(name):
    return make_object(name)


def apple_volume(p):
    def disc(t, dt=1e-5):
        (r,), (low, high) = apple_profile(np.array([t]), **p)[0], apple_profile(np.array([t + dt, t - dt]), **p)[1]
        return np.pi * r * r * (high - low) / (2 * dt)

    # the dimple changes sign at the equator, where its height is e^(-1/s^2) of the depth: split there
    return quad(disc, 1e-4, np.pi / 2 - 1e-4)[0] + quad(disc, np.pi / 2 + 1e-4, np.pi - 1e-4)[0]


def banana_volume(p):
    arc = 2 * p["arc_radius_m"] * np.arcsin(p["length_m"] / 2 / p["arc_radius_m"])
    return np.pi / 4 * p["diameter_m"] ** 2 * arc * p["taper_exponent"] / (p["taper_exponent"] + 1)


def bottle_volume(p):
    a, b, c = p["depth_m"] / 2, p["width_m"] / 2, p["neck_diameter_m"] / 2
    shoulder = p["height_m"] - p["body_height_m"] - p["neck_height_m"]
    middle = shoulder * (2 * a * b + (a + b) * c + 2 * c * c) / 6
    return np.pi * (a * b * p["body_height_m"] + middle + c * c * p["neck_height_m"])


def egg_volume(p):
    k, m = p["taper_ratio"], p["neck_ratio"]
    t = np.linspace(0, np.pi, 100_001)
    a = p["diameter_m"] / 2 / (np.sin(t) * (1 + k * np.cos(t) + m * np.cos(t) ** 2)).max()
    return np.pi * a * a * p["length_m"] / 2 * (4 / 3 + 4 / 15 * (k * k + 2 * m) + 4 / 35 * m * m)


def vessel_volume(p):
    low, high, h, e = p["bottom_diameter_m"] / 2, p["top_diameter_m"] / 2, p["height_m"], p["bulge_exponent"]
    lip, lip_height = p["lip_width_m"], p["lip_height_m"]

    def outer(z):
        return low + (high - low) * (z / h) ** e

    def material(z):
        r = high + lip if z > h - lip_height else outer(z)
        hole = outer(z) - p["wall_thickness_m"] if z > p["bottom_thickness_m"] else 0.0
        return np.pi * (r * r - hole * hole)

    cuts = [0.0, p["bottom_thickness_m"], h - lip_height, h]
    return sum(quad(material, a, b)[0] for a, b in pairwise(cuts))


def drill_volume(p):
    grip = p["height_m"] - p["barrel_height_m"] - p["base_height_m"]
    barrel, base = p["length_m"] * p["barrel_height_m"], p["base_length_m"] * p["base_height_m"]
    return p["thickness_m"] * (barrel + base + p["grip_width_m"] * grip)


def hammer_volume(p):
    handle = (p["length_m"] - p["head_width_m"]) * p["handle_width_m"] * p["handle_thickness_m"]
    return handle + p["head_length_m"] * p["head_width_m"] * p["head_thickness_m"]


def wrench_volume(p):
    head = p["head_length_m"] * p["head_width_m"] - p["jaw_depth_m"] * p["jaw_width_m"]
    return p["thickness_m"] * ((p["length_m"] - p["head_length_m"]) * p["handle_width_m"] + head)


def tube_volume(diameter, length):
    return np.pi / 4 * diameter**2 * length


CLOSED_FORMS = {
    "apple": apple_volume,
    "banana": banana_volume,
    "bottle": bottle_volume,
    "box": lambda p: p["depth_m"] * p["width_m"] * p["height_m"],
    "cylinder": lambda p: tube_volume(p["diameter_m"], p["height_m"]),
    "drill": drill_volume,
    "egg": egg_volume,
    "hammer": hammer_volume,
    "mug": lambda p: mug_by_parts(p)[0],
    "rod": lambda p: (
        tube_volume(p["thick_diameter_m"], p["thick_length_m"]) + tube_volume(p["thin_diameter_m"], p["thin_length_m"])
    ),
    "rounded_box": lambda p: (p["depth_m"] * p["width_m"] - (4 - np.pi) * p["edge_radius_m"] ** 2) * p["height_m"],
    "sphere": lambda p: np.pi / 6 * (p["diameter_m"] ** 3 - (p["diameter_m"] - 2 * p["wall_thickness_m"]) ** 3),
    "vessel": vessel_volume,
    "wrench": wrench_volume,
}


def analytic_volume(name):
    entry = load_catalogue()[name]
    return CLOSED_FORMS[entry.kind](entry.parameters)


def mug_by_parts(p):
    """Volume, mass centre and inertia of wall, bottom and handle, the handle as a chain of small boxes."""
    outer, h, floor = p["diameter_m"] / 2, p["height_m"], p["bottom_thickness_m"]
    inner = outer - p["wall_thickness_m"]
    pieces = []
    for r, height, centre_z, sign in [(outer, h, h / 2, 1), (inner, h - floor, (h + floor) / 2, -1)]:
        v = sign * np.pi * r * r * height
        across = v * (3 * r * r + height**2) / 12
        pieces.append((v, np.array([0, 0, centre_z]), np.diag([across, across, v * r * r / 2])))
    strap, width = p["strap_thickness_m"], p["strap_width_m"]
    a, b = p["handle_reach_m"] - strap / 2, (p["handle_height_m"] - strap) / 2
    t = np.linspace(0, np.pi, 401)
    ends = np.column_stack([outer + a * np.sin(t), 0 * t, h / 2 - b * np.cos(t)])
    for start, end in pairwise(ends):
        v = np.linalg.norm(end - start) * strap * width
        along = (end - start) / np.linalg.norm(end - start)
        normal = np.array([along[2], 0, -along[0]])
        second = (strap**2 * np.outer(normal, normal) + width**2 * np.diag([0, 1, 0])) / 12
        pieces.append((v, (start + end) / 2, v * (np.trace(second) * np.eye(3) - second)))
    volume = sum(v for v, _, _ in pieces)
    mean = sum(v * c for v, c, _ in pieces) / volume
    inertia = sum(i + v * ((c - mean) @ (c - mean) * np.eye(3) - np.outer(c - mean, c - mean)) for v, c, i in pieces)
    return volume, mean, inertia


def depth_outside(points, part):
    """Signed distance of points to the farthest face plane of a convex part: <= 0 inside."""
    planes = np.einsum("ij,ij->i", part.face_normals, part.triangles_center)
    return (points @ part.face_normals.T - planes).max(axis=1)


def winding_number(points, mesh):
    """Times the surface goes around each point (solid angle of van Oosterom and Strackee)."""
    total = np.empty(len(points))
    for i, point in enumerate(points):
        a, b, c = np.moveaxis(mesh.triangles - point, 1, 0)
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        top = np.einsum("ij,ij->i", a, np.cross(b, c))
        dots = [np.einsum("ij,ij->i", x, y) for x, y in ((a, b), (b, c), (c, a))]
        total[i] = 2 * np.arctan2(top, la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb).sum()
    return total / (4 * np.pi)


def test_catalogue_has_thirty_objects_of_every_family():
    entries = load_catalogue()
    assert len(entries) >= 30
    assert {entry.kind for entry in entries.values()} == set(GENERATORS)
    assert len({entry.ycb for entry in entries.values()}) == len(entries)


@pytest.mark.parametrize(
    ("name", "mass_g"),
    [
        ("apple", 68),
        ("banana", 66),
        ("mug", 118),
        ("soup_can", 349),
        ("cracker_box", 411),
        ("tennis_ball", 58),
        ("strawberry", 18),
        ("bleach_bottle", 1131),
    ],
)
def test_mass_is_that_of_the_ycb_list(name, mass_g):
    assert made(name).mass_kg == pytest.approx(mass_g / 1000)


@pytest.mark.parametrize("name", NAMES)
def test_mesh_is_closed_outward_and_one_body(name):
    mesh = made(name).mesh
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert is_closed(mesh)
    assert mesh.volume > 0
    # a ball's cavity is a surface of its own; a handle makes a torus of a vessel
    entry = load_catalogue()[name]
    p = entry.parameters
    hollow = entry.kind == "sphere" and p["wall_thickness_m"] < p["diameter_m"] / 2
    assert mesh.body_count == (2 if hollow else 1)
    assert mesh.euler_number == {"mug": 0}.get(entry.kind, 4 if hollow else 2)


@pytest.mark.parametrize("name", NAMES)
def test_volume_is_that_of_the_closed_form(name):
    # inscribed facets: never more than the smooth solid, and at most 1 % less
    ratio = made(name).mesh.volume / analytic_volume(name)
    assert 1 - FACETING < ratio < 1 + 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_origin_is_the_mass_centre_and_inertia_is_possible(name):
    model = made(name)
    assert np.abs(mass_properties(model.mesh).centre_m).max() < 1e-9
    assert np.allclose(model.inertia_kg_m2, model.inertia_kg_m2.T)
    small, middle, large = np.linalg.eigvalsh(model.inertia_kg_m2)
    assert small > 0
    assert small + middle > large
    # independent of our own integrals
    expected = model.mesh.moment_inertia * model.mass_kg / model.mesh.volume
    assert np.allclose(model.inertia_kg_m2, expected, rtol=1e-6, atol=1e-6 * large)


def test_inertia_of_can_box_and_hollow_ball():
    entries = load_catalogue()
    p, model = entries["soup_can"].parameters, made("soup_can")
    r, h = p["diameter_m"] / 2, p["height_m"]
    across = model.mass_kg * (3 * r * r + h * h) / 12
    expected = np.diag([across, across, model.mass_kg * r * r / 2])
    assert np.allclose(model.inertia_kg_m2, expected, rtol=FACETING, atol=1e-12)

    p, model = entries["cracker_box"].parameters, made("cracker_box")
    sides = np.array([p["depth_m"], p["width_m"], p["height_m"]])
    expected = boxes([(sides, np.zeros(3))])[2] * model.mass_kg / np.prod(sides)
    assert np.allclose(model.inertia_kg_m2, expected, rtol=1e-9, atol=1e-12)

    p, model = entries["tennis_ball"].parameters, made("tennis_ball")
    outer = p["diameter_m"] / 2
    inner = outer - p["wall_thickness_m"]
    expected = 0.4 * model.mass_kg * (outer**5 - inner**5) / (outer**3 - inner**3) * np.eye(3)
    assert np.allclose(model.inertia_kg_m2, expected, rtol=FACETING, atol=1e-12)
    assert expected[0, 0] > 1.2 * 0.4 * model.mass_kg * outer**2  # a solid ball would be well below


def test_inertia_of_a_hollow_cup_and_of_a_solid_apple():
    """Discs in closed form against the mesh: a cup's is well above, an apple's near that of a solid of its size."""
    entries = load_catalogue()
    p, cup = entries["cup_medium"].parameters, made("cup_medium")
    low, high, h, floor = p["bottom_diameter_m"] / 2, p["top_diameter_m"] / 2, p["height_m"], p["bottom_thickness_m"]

    def radii(z):
        outer = low + (high - low) * z / h
        inner = outer - p["wall_thickness_m"] if z > floor else 0.0
        return (high + p["lip_width_m"] if z > h - p["lip_height_m"] else outer), inner

    expected = axial_and_across(radii, [0.0, floor, h - p["lip_height_m"], h]) * cup.mass_kg
    assert np.allclose(np.diag(cup.inertia_kg_m2), expected[[1, 1, 0]], rtol=FACETING)
    assert cup.inertia_kg_m2[2, 2] > 1.5 * 0.5 * cup.mass_kg * high**2  # a solid cylinder would be well below

    q, apple = entries["apple"].parameters, made("apple")
    radius, height = apple_profile(np.linspace(np.pi, 0.0, 20_001), **q)
    # Pappus' discs along the outline: right also where the dimples fold the height back
    dz = np.diff(height)
    r, z = (radius[1:] + radius[:-1]) / 2, (height[1:] + height[:-1]) / 2
    volume, centre = (np.pi * r**2 * dz).sum(), (np.pi * r**2 * dz * z).sum()
    axial = (np.pi * r**4 / 2 * dz).sum() / volume
    across = (np.pi * r**2 * (r**2 / 4 + z**2) * dz).sum() / volume - (centre / volume) ** 2
    assert np.allclose(np.diag(apple.inertia_kg_m2), apple.mass_kg * np.array([across, across, axial]), rtol=FACETING)


def axial_and_across(radii, cuts):
    """Inertia per mass about the axis and across it of a solid of rings (outer, inner radius at a height)."""

    def integral(f):
        return sum(quad(lambda z: f(*radii(z), z), a, b)[0] for a, b in pairwise(cuts))

    volume = integral(lambda r, s, _: r * r - s * s)
    centre = integral(lambda r, s, z: (r * r - s * s) * z) / volume
    axial = integral(lambda r, s, _: (r**4 - s**4) / 2) / volume
    across = integral(lambda r, s, z: (r**4 - s**4) / 4 + (r * r - s * s) * (z - centre) ** 2) / volume
    return np.array([axial, across])


def test_solid_sphere_when_the_wall_is_the_radius():
    mesh = GENERATORS["sphere"](diameter_m=0.08, wall_thickness_m=0.04).mesh
    assert mesh.volume == pytest.approx(np.pi / 6 * 0.08**3, rel=FACETING)
    props = mass_properties(mesh)
    assert np.allclose(props.inertia_m5 / props.volume_m3, 0.4 * 0.04**2 * np.eye(3), rtol=FACETING, atol=1e-9)


def test_mug_is_hollow_with_a_handle():
    model = made("mug")
    volume, centre, inertia = mug_by_parts(load_catalogue()["mug"].parameters)
    assert model.mesh.volume == pytest.approx(volume, rel=FACETING)
    assert model.rest_height_m == pytest.approx(centre[2], rel=FACETING)
    # the handle side is longer, and the mass centre has moved towards it
    low, high = model.mesh.bounds[:, 0]
    assert (low + high) / 2 > 0
    assert -low - load_catalogue()["mug"].parameters["diameter_m"] / 2 == pytest.approx(centre[0], rel=0.02)
    expected = inertia * model.mass_kg / volume
    assert np.allclose(model.inertia_kg_m2, expected, rtol=FACETING, atol=FACETING * expected.max())
    # along the axis above the bottom there is no material, in the wall there is
    p = load_catalogue()["mug"].parameters
    inside = np.array([[-centre[0], 0, 0], [-centre[0] - p["diameter_m"] / 2 + p["wall_thickness_m"] / 2, 0, 0]])
    assert winding_number(inside, model.mesh) == pytest.approx([0, 1], abs=1e-6)


def test_banana_mass_centre_is_off_its_box_centre():
    low, high = made("banana").mesh.bounds
    assert abs((low + high)[0] / 2) < 1e-5
    assert (low + high)[1] / 2 < -0.005  # arc: the tips hang back behind the mass centre


@pytest.mark.parametrize("name", NAMES)
def test_parts_are_convex_closed_and_few(name):
    parts = made(name).convex_parts
    most = {"mug": 20, "banana": 6, "vessel": 50, "bottle": 3, "wrench": 4, "drill": 3, "hammer": 2, "rod": 2}
    assert len(parts) <= most.get(load_catalogue()[name].kind, 1)
    for part in parts:
        assert part.is_watertight
        assert depth_outside(part.vertices, part).max() < 1e-9
        assert part.volume > 1e-9


@pytest.mark.parametrize("name", NAMES)
def test_parts_cover_the_mesh(name):
    model = made(name)
    points, _ = trimesh.sample.sample_surface(model.mesh, 4000, seed=1)
    outside = np.min([depth_outside(points, part) for part in model.convex_parts], axis=0)
    # coarser facets of collision hulls lie up to R (1 - cos(pi/32)) inside, blunt tips of the banana a little more
    assert outside.max() < 0.0005


@pytest.mark.parametrize("name", SAMPLED)
def test_parts_do_not_stick_out_of_the_mesh(name):
    model = made(name)
    points = np.vstack(
        [
            trimesh.sample.sample_surface(part, max(20, 600 // len(model.convex_parts)), seed=2)[0]
            for part in model.convex_parts
        ]
    )
    if load_catalogue()[name].kind == "apple":
        # its hull closes the dimples, as stated; everything outside their rims counts
        vertices = model.mesh.vertices
        rims = [np.hypot(*vertices[i, :2]) for i in (vertices[:, 2].argmax(), vertices[:, 2].argmin())]
        points = points[np.hypot(points[:, 0], points[:, 1]) > max(rims)]
    points = points[winding_number(points, model.mesh) < 0.5]
    dense, _ = trimesh.sample.sample_surface(model.mesh, 200_000, seed=3)
    if len(points):
        # pieces of arcs bulge over their hollow side in proportion to the arc
        assert cKDTree(dense).query(points)[0].max() < max(0.002, 0.015 * model.extents_m.max())


def test_parts_of_the_mug_leave_cup_and_handle_open():
    model = made("mug")
    p = load_catalogue()["mug"].parameters
    axis_x = model.mesh.bounds[0, 0] + p["diameter_m"] / 2
    openings = np.array(
        [
            [axis_x, 0, 0.02],  # inside the cup
            [axis_x + p["diameter_m"] / 2 + 0.4 * p["handle_reach_m"], 0, p["height_m"] / 2 - model.rest_height_m],
        ]
    )
    assert np.min([depth_outside(openings, part) for part in model.convex_parts], axis=0).min() > 0.005


@pytest.mark.parametrize("name", NAMES)
def test_generation_is_deterministic(name):
    first, second = made(name), made(name)
    assert first.mesh.vertices.tobytes() == second.mesh.vertices.tobytes()
    assert first.mesh.faces.tobytes() == second.mesh.faces.tobytes()
    for a, b in zip(first.convex_parts, second.convex_parts, strict=True):
        assert a.vertices.tobytes() == b.vertices.tobytes()
    assert first.inertia_kg_m2.tobytes() == second.inertia_kg_m2.tobytes()


def test_combined_solids_follow_the_parallel_axis_theorem():
    sizes = [((0.02, 0.03, 0.04), (0.0, 0.0, 0.0)), ((0.05, 0.01, 0.01), (0.1, -0.02, 0.03))]
    solids = []
    for size, centre in sizes:
        solid = trimesh.creation.box(size)
        solid.apply_translation(centre)
        solids.append(solid)
    volume, mean, inertia = boxes(sizes)
    props = combined(solids)
    assert props.volume_m3 == pytest.approx(volume)
    assert np.allclose(props.centre_m, mean)
    assert np.allclose(props.inertia_m5, inertia)


def test_blocks_make_one_closed_surface():
    bar, head = ((0.0, 0.0, 0.0), (0.3, 0.1, 0.1)), ((0.1, 0.1, 0.0), (0.2, 0.4, 0.2))
    shape = blocks([bar, head])
    assert shape.mesh.is_watertight
    assert shape.mesh.body_count == 1
    assert shape.mesh.volume == pytest.approx(0.3 * 0.1 * 0.1 + 0.1 * 0.3 * 0.2)
    with pytest.raises(ValueError, match="overlap"):
        blocks([bar, ((0.1, 0.05, 0.0), (0.2, 0.4, 0.2))])
    with pytest.raises(ValueError, match="edge"):
        blocks([bar, ((0.1, 0.1, 0.1), (0.2, 0.4, 0.2))])


@pytest.mark.parametrize("kind", GENERATORS)
def test_a_length_of_zero_is_refused_by_name(kind):
    entry = next(entry for entry in load_catalogue().values() if entry.kind == kind)
    key = next(
        key for key in entry.parameters if key.endswith("diameter_m") or key.endswith("length_m") or "depth" in key
    )
    with pytest.raises(ValueError, match=key):
        GENERATORS[kind](**{**entry.parameters, key: 0.0})
