"""Replay files: a trial that a guard ended, from its last checkpoint on. One NumPy archive, without pickle.

``about`` is JSON text: what was tried, the alarm, and the parameters in the form of `softhand_sim.guards.plain`;
``xml`` rebuilds the model, ``model_<field>`` are fields that were changed after it was compiled, ``state_<name>`` the
checkpoint, ``driven`` the wrist's references of each step where a phase drove it.
"""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import mujoco
import numpy as np
import numpy.typing as npt

from softhand_sim.grasp.record import Recorder
from softhand_sim.grasp.stage import SAMPLE_S
from softhand_sim.guards.limits import Alarm, AlarmKind
from softhand_sim.guards.plain import from_plain, to_plain
from softhand_sim.guards.watch import CHECKPOINT_TICKS, Watch
from softhand_sim.simulation import HandSimulation

FORMAT = "softhand-sim/replay"
FORMAT_VERSION = 1
_PARTS = ("calibration", "pneumatics", "losses", "anatomy", "guards")
Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Repeat:
    """What a repeat came to: the alarm in the file and that of the repeat, None if no guard fired."""

    about: Mapping[str, Any]
    saved: Alarm
    seen: Alarm | None

    @property
    def same(self) -> bool:
        """Whether it is the same alarm to the bit: kind, figure, time."""
        return self.saved == self.seen


def save_replay(path: Path, watch: Watch, xml: str, about: Mapping[str, Any]) -> None:
    """Write what repeats an alarm, in one piece.

    Parameters
    ----------
    path: of the file, ending ``.npz``.
    watch: of the trial that ended.
    xml: the scene's MJCF.
    about: what was tried: plain values for the reader.

    Raises
    ------
    ValueError
        If no guard fired, or a part (such as a controller of one's own) has no plain form.
    """
    if watch.alarm is None:
        raise ValueError("no guard fired: there is nothing to repeat")
    simulation = watch.simulation
    parts = {name: getattr(simulation, name) for name in _PARTS if name != "guards"} | {"guards": watch.limits}
    # what the runtime does not compute with
    parts["calibration"] = replace(simulation.calibration, notes={})
    text = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "mujoco_version": version("mujoco"),
        "numpy_version": version("numpy"),
        "alarm": watch.alarm.data(),
        "rest_height_m": watch.recorder.rest_height_m,
        "about": dict(about),
        "parts": {name: to_plain(part) for name, part in parts.items()},
    }
    arrays: dict[str, Any] = {
        "about": np.array(json.dumps(text, allow_nan=False)),
        "xml": np.array(xml),
        "driven": np.array(watch.driven).reshape(-1, 6),
        **{f"model_{name}": value for name, value in _changes(xml, simulation.model).items()},
        **{f"state_{name}": value for name, value in watch.state.items()},
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial.npz")
    np.savez_compressed(partial, **arrays)
    partial.replace(path)


def repeat(path: Path) -> Repeat:
    """Run a replay file again from its state, until a guard fires or the time of the saved alarm has passed.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no replay file.
    """
    if not path.is_file():
        raise FileNotFoundError(f"no replay file at {path}")
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        text = json.loads(str(arrays["about"]))
        if text["format"] != FORMAT or text["format_version"] != FORMAT_VERSION:
            raise ValueError(f"format {text['format']} {text['format_version']}, must be {FORMAT} {FORMAT_VERSION}")
        saved = Alarm(**{**text["alarm"], "kind": AlarmKind(text["alarm"]["kind"])})
        watch = _rebuilt(text, arrays)
    except (BadZipFile, KeyError, TypeError, EOFError, OSError, ValueError) as error:
        raise ValueError(f"{path}: not a replay file: {error}") from error
    driven = list(arrays["driven"])
    for _ in range(CHECKPOINT_TICKS + 1):
        if _tick(watch, driven) is not None or watch.simulation.data.time > saved.time_s:
            break
    return Repeat(about=text["about"], saved=saved, seen=watch.alarm)


def _rebuilt(text: Mapping[str, Any], arrays: Mapping[str, Any]) -> Watch:
    parts = {name: from_plain(text["parts"][name]) for name in _PARTS}
    model = mujoco.MjModel.from_xml_string(str(arrays["xml"]))
    for name, value in arrays.items():
        if name.startswith("model_"):
            getattr(model, name[6:])[...] = value
    guards = parts.pop("guards")
    simulation = HandSimulation(model=model, **parts)
    state = {name[6:]: value for name, value in arrays.items() if name.startswith("state_")}
    simulation.reset(np.random.default_rng(0), state["wrist_reference"])
    recorder = Recorder.of(simulation, float(text["rest_height_m"]))
    watch = Watch(simulation=simulation, recorder=recorder, limits=guards)
    watch.resume(state)
    return watch


def _tick(watch: Watch, driven: list[Vector]) -> Alarm | None:
    """Advance by one sample of the trial."""
    simulation = watch.simulation
    steps = max(1, round(SAMPLE_S / simulation.dt))
    if driven:
        for row in driven[:steps]:
            simulation.wrist_reference, simulation.wrist_target = row, row.copy()
            simulation.step()
        del driven[:steps]
    else:
        simulation.advance(steps)
    watch.recorder.sample(simulation)
    return watch.look()


def _changes(xml: str, model: mujoco.MjModel) -> dict[str, Any]:
    """Return the fields of a model that are not those of its XML."""
    fresh = mujoco.MjModel.from_xml_string(xml)
    found = {}
    for name in dir(model):
        mine = getattr(model, name, None)
        if isinstance(mine, np.ndarray) and not np.array_equal(
            mine, getattr(fresh, name), equal_nan=mine.dtype == "f8"
        ):
            found[name] = mine.copy()
    return found
