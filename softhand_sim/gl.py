"""Which OpenGL library draws pictures: MuJoCo and dm_control read ``MUJOCO_GL`` once, when first imported."""

import ctypes
import os
import sys

INSTALL_HINT = (
    "no OpenGL library for pictures without a screen: install libegl1 and libgl1 (or libosmesa6), "
    "or set MUJOCO_GL to egl, osmesa or glfw"
)
# sonames of the headless libraries, best first
_HEADLESS = (("egl", ("libEGL.so.1",)), ("osmesa", ("libOSMesa.so.8", "libOSMesa.so.6")))


def choose_backend() -> None:
    """Set ``MUJOCO_GL`` on a Linux machine without a screen; a choice already made is left alone.

    With neither library present it is set to ``disable``: everything but pictures works.
    """
    if "MUJOCO_GL" in os.environ or sys.platform != "linux" or "DISPLAY" in os.environ:
        return
    for backend, names in _HEADLESS:
        if any(_loads(name) for name in names):
            os.environ["MUJOCO_GL"] = backend
            return
    os.environ["MUJOCO_GL"] = "disable"


def _loads(name: str) -> bool:
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True
