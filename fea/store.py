"""Solved fingers on disk, found by what they were solved from: an unchanged one is never solved again."""

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fea.checkpoint import content_hash

FORMAT, FORMAT_VERSION = "softhand-sim/solved-finger", 1


class DamagedEntryError(ValueError):
    """A store's file is not what was written there; the message names the file and what is wrong."""


@dataclass(frozen=True, kw_only=True)
class Solved:
    """A finger's calibration file and a report of its analyses, both JSON ready."""

    artifact: Mapping[str, Any]
    report: Mapping[str, Any]


class FingerStore:
    """A folder with one file for each identity, ``<SHA-256 of the identity>.json``.

    A file holds the identity, the result (or the reason why there is none) and the SHA-256 of both.

    Parameters
    ----------
    folder : Path
        Where the files are; made when the first one is written.
    warn : callable
        Gets one line for every damaged file, which is then solved again, and for a result that cannot be kept.
    """

    def __init__(self, folder: Path, warn: Callable[[str], None] = lambda _: None) -> None:
        self._folder, self._warn = folder, warn

    def file(self, identity: Mapping[str, Any]) -> Path:
        """Return the file of an identity, whether it exists or not."""
        return self._folder / f"{content_hash(identity)}.json"

    def solve(
        self, identity: Mapping[str, Any], work: Callable[[], Solved], *, force: bool = False
    ) -> tuple[Solved, bool]:
        """Return the result of an identity, and whether it came from the store; ``work`` is called if it is not there.

        A finger that the analyses refuse (a ``ValueError``) is kept as well, with the reason. With ``force`` the store
        is not asked, only written.

        Raises
        ------
        ValueError
            That of ``work``, now or when it was first called.
        """
        outcome = None if force else self._found(identity)
        stored = outcome is not None
        if outcome is None:
            try:
                solved = work()
                outcome = {"artifact": dict(solved.artifact), "report": dict(solved.report)}
            except ValueError as error:
                outcome = {"failure": str(error)}
            self._keep(identity, outcome)
        if "failure" in outcome:
            raise ValueError(outcome["failure"])
        return Solved(artifact=outcome["artifact"], report=outcome["report"]), stored

    def read(self, identity: Mapping[str, Any]) -> dict[str, Any] | None:
        """Return what is kept under an identity (``artifact`` and ``report``, or ``failure``); None if nothing is.

        Raises
        ------
        DamagedEntryError
            If the file is truncated, edited, or that of another identity.
        """
        file = self.file(identity)
        try:
            content = json.loads(file.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except (OSError, ValueError, RecursionError) as error:
            raise DamagedEntryError(f"{file}: not a whole JSON file ({error})") from None
        if not isinstance(content, dict) or content.get("format") != FORMAT:
            raise DamagedEntryError(f"{file}: format is not {FORMAT!r}")
        if content.get("format_version") != FORMAT_VERSION:
            found = content.get("format_version")
            raise DamagedEntryError(f"{file}: format_version = {found!r} must be {FORMAT_VERSION}")
        outcome = content.get("outcome")
        if content.get("sha256") != _checksum(content.get("identity"), outcome):
            raise DamagedEntryError(f"{file}: sha256 is not that of identity and outcome")
        if content_hash(content["identity"]) != content_hash(identity):
            raise DamagedEntryError(f"{file}: identity is another finger's")
        if not isinstance(outcome, dict) or not ("failure" in outcome or {"artifact", "report"} <= set(outcome)):
            raise DamagedEntryError(f"{file}: outcome has neither artifact and report nor failure")
        return outcome

    def _found(self, identity: Mapping[str, Any]) -> dict[str, Any] | None:
        try:
            return self.read(identity)
        except DamagedEntryError as error:
            self._warn(f"refused, solved again: {error}")
            return None

    def _keep(self, identity: Mapping[str, Any], outcome: dict[str, Any]) -> None:
        """Write in one piece; a folder that cannot be written to must not cost the result."""
        file = self.file(identity)
        content = {
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "sha256": _checksum(identity, outcome),
            "identity": identity,
            "outcome": outcome,
        }
        partial = file.with_name(f".{file.name}.{os.getpid()}.partial")
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            partial.write_text(json.dumps(content, allow_nan=False) + "\n", encoding="utf-8")
            partial.replace(file)
        except OSError as error:
            self._warn(f"not kept in the store: {file}: {error.strerror}")


def _checksum(identity: Any, outcome: Any) -> str:
    """Return the SHA-256 of identity and outcome, or an empty text where they cannot have been written by a store."""
    try:
        return content_hash([identity, outcome])
    except ValueError:  # NaN
        return ""
