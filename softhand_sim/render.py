"""Pictures of a scene, drawn without a screen."""

import os
from pathlib import Path
from types import TracebackType
from typing import Self

import mujoco
import numpy as np
import numpy.typing as npt
from PIL import Image

from softhand_sim.gl import INSTALL_HINT

Picture = npt.NDArray[np.uint8]


class RenderUnavailableError(RuntimeError):
    """The machine has no OpenGL library that could draw; the message says what to install."""


class Camera:
    """Draws pictures of one model; a context manager that frees the GL context at its end."""

    def __init__(self, model: mujoco.MjModel, *, width: int = 640, height: int = 480) -> None:
        if os.environ.get("MUJOCO_GL") in ("disable", "off"):
            raise RenderUnavailableError(INSTALL_HINT)
        try:
            self._renderer = mujoco.Renderer(model, height, width)
        except (mujoco.FatalError, RuntimeError, AttributeError, ImportError, OSError) as error:
            raise RenderUnavailableError(f"{INSTALL_HINT} ({type(error).__name__}: {error})") from error

    def picture(self, data: mujoco.MjData, camera: str | mujoco.MjvCamera) -> Picture:
        """Return an RGB picture, shape (height, width, 3), uint8."""
        self._renderer.update_scene(data, camera)
        return np.asarray(self._renderer.render(), dtype=np.uint8)

    def depth_m(self, data: mujoco.MjData, camera: str | mujoco.MjvCamera) -> npt.NDArray[np.float32]:
        """Return the distance of every pixel from the camera's plane [m], shape (height, width)."""
        self._renderer.enable_depth_rendering()
        try:
            self._renderer.update_scene(data, camera)
            return np.asarray(self._renderer.render(), dtype=np.float32)
        finally:
            self._renderer.disable_depth_rendering()

    def close(self) -> None:
        """Free the GL context."""
        self._renderer.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def around(
    point_m: npt.NDArray[np.float64], *, distance_m: float = 0.42, azimuth_deg: float = 125.0
) -> mujoco.MjvCamera:
    """Return a free camera that looks at `point_m`, shape (3,), from slightly above."""
    camera = mujoco.MjvCamera()
    camera.lookat[:] = point_m
    camera.distance = distance_m
    camera.azimuth = azimuth_deg
    camera.elevation = -12.0
    return camera


def save_png(path: Path, picture: Picture) -> None:
    """Write a picture in one piece."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    Image.fromarray(picture).save(partial, format="PNG")
    partial.replace(path)
