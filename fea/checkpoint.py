"""Converged load steps on disk: a killed run goes on where it stopped, a foreign one is refused by name."""

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from fea.cost import Cost
from fea.path import Step


class Checkpoints:
    """The converged steps of one run in a folder, one ``step-0001.npz`` each (no pickle).

    Parameters
    ----------
    folder : Path
        Where the steps are; made if missing.
    identity : mapping
        What makes the run this one (geometry, materials, mesh, loads, code ...): named parts, JSON ready. Each part's
        hash is kept with every step.
    """

    def __init__(self, folder: Path, identity: Mapping[str, Any]) -> None:
        self._folder = folder
        self._hashes = {name: content_hash(part) for name, part in identity.items()}
        self._count = 0

    def load(self) -> list[Step]:
        """Return the steps of an earlier run, in order.

        Raises
        ------
        ValueError
            If a file is damaged or belongs to another run; the message names the file and what differs.
        """
        files = sorted(self._folder.glob("step-*.npz"))
        steps = [self._read(file) for file in files]
        self._count = len(steps)
        return steps

    def save(self, step: Step) -> None:
        """Write a step in one piece: a reader, or a killed run, finds it whole or not at all."""
        self._folder.mkdir(parents=True, exist_ok=True)
        self._count += 1
        file = self._folder / f"step-{self._count:04d}.npz"
        partial = file.with_name(f".{file.name}.{os.getpid()}.partial")
        about = {"identity": self._hashes, "cost": asdict(step.cost), "iterations": step.iterations}
        with partial.open("wb") as stream:
            np.savez(
                stream,
                about=np.array(json.dumps(about)),
                parameter=np.float64(step.parameter),
                residual=np.float64(step.residual),
                u_m=step.u_m,
            )
            stream.flush()
            os.fsync(stream.fileno())
        partial.replace(file)

    def _read(self, file: Path) -> Step:
        try:
            with file.open("rb") as stream, np.load(stream, allow_pickle=False) as data:
                about = json.loads(str(data["about"]))
                parameter, residual, u_m = float(data["parameter"]), float(data["residual"]), data["u_m"]
        except (OSError, ValueError, KeyError, EOFError, BadZipFile) as error:
            raise ValueError(f"{file}: not a checkpoint of this program ({error}); remove it") from None
        kept = about["identity"]
        names = [name for name in sorted({*kept, *self._hashes}) if kept.get(name) != self._hashes.get(name)]
        if names:
            raise ValueError(f"{file}: checkpoint of another run ({', '.join(names)} differ); give another folder")
        return Step(
            parameter=parameter,
            u_m=u_m,
            iterations=int(about["iterations"]),
            residual=residual,
            cost=Cost(**about["cost"]),
        )


def content_hash(part: Any) -> str:
    """Return the SHA-256 of a JSON-ready value, independent of the order of keys."""
    return hashlib.sha256(json.dumps(part, sort_keys=True, allow_nan=False).encode()).hexdigest()


def code_version() -> str:
    """Return the SHA-256 of this package's source: a state of other code is not to be gone on from."""
    digest = hashlib.sha256()
    for file in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(file.name.encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()
