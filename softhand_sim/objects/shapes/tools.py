"""Tools put together from blocks: hammer, power drill, open wrench."""

from softhand_sim.objects.blocks import blocks
from softhand_sim.objects.geometry import ShapeGeometry, require_positive


def hammer(
    *,
    length_m: float,
    handle_width_m: float,
    handle_thickness_m: float,
    head_length_m: float,
    head_width_m: float,
    head_thickness_m: float,
) -> ShapeGeometry:
    """Return a hammer lying on its side: handle along x, head along y at its +x end, both on the table.

    Raises
    ------
    ValueError
        If a length is not positive or the handle is wider than the head is long.
    """
    require_positive(**dict(locals()))
    if not (handle_width_m < head_length_m and head_width_m < length_m):
        raise ValueError(f"handle_width_m {handle_width_m} and head_width_m {head_width_m} do not fit the head")
    start = length_m - head_width_m
    return blocks(
        [
            ((0.0, -handle_width_m / 2.0, 0.0), (start, handle_width_m / 2.0, handle_thickness_m)),
            ((start, -head_length_m / 2.0, 0.0), (length_m, head_length_m / 2.0, head_thickness_m)),
        ]
    )


def drill(
    *,
    length_m: float,
    height_m: float,
    thickness_m: float,
    barrel_height_m: float,
    grip_width_m: float,
    grip_offset_m: float,
    base_length_m: float,
    base_height_m: float,
) -> ShapeGeometry:
    """Return a pistol-shaped power drill lying on its side: barrel along x, grip and battery base towards -y.

    `grip_offset_m` is the distance of grip and base from the barrel's rear end.

    Raises
    ------
    ValueError
        If a length is not positive or the parts do not fit together.
    """
    require_positive(**dict(locals()))
    if not (grip_offset_m + base_length_m <= length_m and grip_width_m <= base_length_m):
        raise ValueError(f"base_length_m {base_length_m} at grip_offset_m {grip_offset_m} does not fit {length_m}")
    if not barrel_height_m + base_height_m < height_m:
        raise ValueError(f"barrel_height_m {barrel_height_m} and base_height_m {base_height_m} leave no grip")
    x0, y1 = grip_offset_m, height_m - barrel_height_m
    return blocks(
        [
            ((0.0, y1, 0.0), (length_m, height_m, thickness_m)),
            ((x0, base_height_m, 0.0), (x0 + grip_width_m, y1, thickness_m)),
            ((x0, 0.0, 0.0), (x0 + base_length_m, base_height_m, thickness_m)),
        ]
    )


def wrench(
    *,
    length_m: float,
    thickness_m: float,
    handle_width_m: float,
    head_length_m: float,
    head_width_m: float,
    jaw_width_m: float,
    jaw_depth_m: float,
) -> ShapeGeometry:
    """Return an open wrench lying flat: handle along x, jaw open towards +x.

    Raises
    ------
    ValueError
        If a length is not positive or the parts do not fit together.
    """
    require_positive(**dict(locals()))
    if not (head_length_m < length_m and jaw_depth_m < head_length_m):
        raise ValueError(f"jaw_depth_m {jaw_depth_m} and head_length_m {head_length_m} do not fit {length_m}")
    if not (jaw_width_m < head_width_m and handle_width_m < head_width_m):
        raise ValueError(f"jaw_width_m {jaw_width_m} and handle_width_m {handle_width_m} need < {head_width_m}")
    start, jaw, half = length_m - head_length_m, length_m - jaw_depth_m, head_width_m / 2.0
    return blocks(
        [
            ((0.0, -handle_width_m / 2.0, 0.0), (start, handle_width_m / 2.0, thickness_m)),
            ((start, -half, 0.0), (jaw, half, thickness_m)),
            ((jaw, -half, 0.0), (length_m, -jaw_width_m / 2.0, thickness_m)),
            ((jaw, jaw_width_m / 2.0, 0.0), (length_m, half, thickness_m)),
        ]
    )


KINDS = {"drill": drill, "hammer": hammer, "wrench": wrench}
