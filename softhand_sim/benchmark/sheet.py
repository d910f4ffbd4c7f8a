"""Pictures of objects alone on the table, at one scale, on one sheet."""

from collections.abc import Sequence

import mujoco
import numpy as np
from dm_control import mjcf
from PIL import Image, ImageDraw, ImageFont

from softhand_sim.hand.scene import add_surroundings, compile_scene
from softhand_sim.objects.mjcf import attach_object
from softhand_sim.objects.model import ObjectModel
from softhand_sim.render import Camera, Picture

TILE = (240, 240)
"""Width and height of a tile in pixels."""
DISTANCE_M = 0.52
"""From the camera to the middle of each object; choice: the tallest, 250 mm, fills the tile."""
CAPTION_PIXELS = 22


def object_tile(model: ObjectModel) -> Picture:
    """Return a picture of one object, at the scale of all others, with its name below.

    Raises
    ------
    RenderUnavailableError
        If this machine cannot draw.
    """
    root = mjcf.RootElement(model="objects")
    add_surroundings(root)
    attach_object(root, model).pos = (0.0, 0.0, model.rest_height_m)
    scene = compile_scene(root)
    data = mujoco.MjData(scene.model)
    mujoco.mj_forward(scene.model, data)
    view = mujoco.MjvCamera()
    low, high = np.asarray(model.mesh.bounds)
    view.lookat[:] = (low + high) / 2.0 + np.array([0.0, 0.0, model.rest_height_m])
    view.distance, view.azimuth, view.elevation = DISTANCE_M, 120.0, -40.0
    with Camera(scene.model, width=TILE[0], height=TILE[1]) as camera:
        picture = camera.picture(data, view)
    return np.vstack([picture, _caption(f"{model.name}  {1e3 * model.mass_kg:.4g} g")])


def _caption(text: str) -> Picture:
    strip = Image.new("RGB", (TILE[0], CAPTION_PIXELS), "white")
    ImageDraw.Draw(strip).text((6, 3), text, fill="black", font=ImageFont.load_default(size=13))
    return np.asarray(strip, dtype=np.uint8)


def sheet(tiles: Sequence[Picture], columns: int) -> Picture:
    """Return pictures of one size in rows, the last row filled up in white."""
    blank = np.full_like(tiles[0], 255)
    filled = [*tiles, *[blank] * (-len(tiles) % columns)]
    return np.vstack([np.hstack(filled[i : i + columns]) for i in range(0, len(filled), columns)])
