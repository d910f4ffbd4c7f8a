"""Pictures and windows of an environment's present world."""

import os
import sys
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from envs.world import World
from softhand_sim.render import Camera, RenderUnavailableError

RENDER_MODES = ("human", "rgb_array", "depth_array")

VIEW = "front"
"""The scene's camera."""


class Pictures:
    """Draws whatever world it is given; what belongs to another world's model is made anew."""

    def __init__(self) -> None:
        self._cameras: dict[tuple[int, int], tuple[mujoco.MjModel, Camera]] = {}
        self._window: tuple[World, Any] | None = None

    def render(self, world: World, mode: str) -> npt.NDArray[Any] | None:
        """Return the picture of a mode, None for ``human``."""
        if mode == "human":
            self._show(world)
            return None
        camera = self._camera(world, (480, 640))
        data = world.simulation.data
        return camera.depth_m(data, VIEW) if mode == "depth_array" else camera.picture(data, VIEW)

    def camera(self, world: World, size: tuple[int, int]) -> npt.NDArray[np.uint8]:
        """Return a picture of a height and width, (h, w, 3)."""
        return self._camera(world, size).picture(world.simulation.data, VIEW)

    def close(self) -> None:
        """Free all contexts and windows."""
        for _, camera in self._cameras.values():
            camera.close()
        self._cameras = {}
        if self._window is not None:
            self._window[1].close()
            self._window = None

    def _camera(self, world: World, size: tuple[int, int]) -> Camera:
        model, camera = self._cameras.get(size, (None, None))
        if camera is None or model is not world.model:
            if camera is not None:
                camera.close()
            camera = Camera(world.model, height=size[0], width=size[1])
            self._cameras[size] = (world.model, camera)
        return camera

    def _show(self, world: World) -> None:
        shown = None if self._window is None else self._window[0]
        if shown is not world or shown.simulation is not world.simulation:
            if self._window is not None:
                self._window[1].close()
            self._window = (world, _open_window(world))
        if self._window is not None:
            self._window[1].sync()


def _open_window(world: World) -> Any:
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise RenderUnavailableError(
            "no screen for render_mode='human': take 'rgb_array' (with RecordVideo, say), or set DISPLAY"
        )
    import mujoco.viewer  # noqa: PLC0415 - loads the window library, which needs a screen

    return mujoco.viewer.launch_passive(world.model, world.simulation.data, show_left_ui=False, show_right_ui=False)
