"""``--replay FILE``: runs a replay file again and says whether its alarm came back."""

from pathlib import Path

from scripts import _cli
from softhand_sim.guards.replay import repeat


def tell_repeat(file: Path, json: Path | None) -> int:
    """Repeat, print, write the JSON; return 0 if the alarm is the same to the bit, else the status of incomplete work.

    Raises
    ------
    FileNotFoundError, ValueError
        If there is no such file, or it is no replay file.
    """
    again = repeat(file)
    print(", ".join(f"{key} {value}" for key, value in again.about.items()))
    print(f"saved: {again.saved.text()}")
    print(f"again: {'no guard fired' if again.seen is None else again.seen.text()}")
    print("the same to the bit" if again.same else "NOT the same: another version of the engine, or of the code?")
    if json is not None:
        seen = None if again.seen is None else again.seen.data()
        _cli.write_json(
            json, {"about": dict(again.about), "saved": again.saved.data(), "seen": seen, "same": again.same}
        )
    return 0 if again.same else _cli.INCOMPLETE
