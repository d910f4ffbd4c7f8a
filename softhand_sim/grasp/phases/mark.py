"""Mark: slip and tilt count from here on."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from softhand_sim.grasp.stage import Stage


@dataclass(frozen=True, kw_only=True)
class Mark:
    """Take the object's present pose in the hand as what slip and tilt are measured from."""

    needs_object: bool = True

    def run(self, stage: Stage) -> Iterator[Callable[[], bool]]:
        """Mark, and go on at once."""
        stage.recorder.mark(stage.simulation)
        yield lambda: True


KINDS = {"mark": Mark}
