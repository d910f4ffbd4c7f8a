"""Hold: nothing moves, creep is measured."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from softhand_sim.checks import require_in
from softhand_sim.grasp.stage import Stage


@dataclass(frozen=True, kw_only=True)
class Hold:
    """Stand still for `duration_s`; creep is that of the last hold."""

    duration_s: float
    needs_object: bool = False

    def __post_init__(self) -> None:
        require_in("duration_s", self.duration_s, 0.05, 1000.0)

    def run(self, stage: Stage) -> Iterator[Callable[[], bool]]:
        """Sample the object's path in the hand until the time is over."""
        stage.recorder.start_hold()
        over = stage.after(self.duration_s)

        def held() -> bool:
            stage.recorder.sample_hold(stage.simulation)
            return over()

        yield held


KINDS = {"hold": Hold}
