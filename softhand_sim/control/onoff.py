"""The paper's ON-OFF pressure law, evaluated at the sensor's sampling rate."""

from collections.abc import Sequence
from dataclasses import dataclass

from softhand_sim.air import AMBIENT_PA_ABS
from softhand_sim.checks import require_finite
from softhand_sim.control.protocol import ControllerState, ValveCommand
from softhand_sim.elements import ELEMENTS

# inlet open, outlet open, last reading, rise over the last tick of inlet, fall over the last tick of outlet, ticks open
MEMORY_SIZE = 6


@dataclass(frozen=True, kw_only=True)
class OnOffController:
    """Inlet and outlet, each fully open or shut, never both open.

    A shut inlet opens when the reading is below the set value by more than the dead band, and shuts as
    soon as the sensor reads the set value; the outlet mirrors it.

    Sampling at 50 Hz adds a difficulty: the pressure moves by one *pulse* (up to 2 kPa) between two
    readings. A literal law shuts up to one pulse late, holds *above* the set value and then chatters,
    while the paper's hand holds "marginally below". So with ``lookahead`` (default) the controller
    remembers what its last pulse did to the reading, and doesn't fire, or stops, when one more such pulse
    would carry the reading past the set value. Held values then lie below the set value on the way up and
    above it on the way down, by less than the larger of a pulse and the dead band. That memory is our
    reading of the paper, not stated in it.

    A set pressure of zero is release: the outlet stays open until the element is at ambient.

    Attributes
    ----------
    dead_band_pa
        Half width of the band round the set value in which a shut valve stays shut [Pa]. Default: two
        counts of the sensor (0.49 kPa). Choice: below one count the converter's flicker alone would fire
        the valves.
    lookahead
        Whether the last pulse is remembered (see above).
    ambient_pa_abs
        Ambient that the gauge set pressures refer to [Pa abs].
    minimum_pulse_ticks
        Shortest opening of a valve, in control ticks. Choice: 1, which is 20 ms at the paper's 50 Hz; a valve with an
        opening delay of a tick or more needs more, or its pulses let nothing through.
    dead_time_ticks
        How long a valve goes on flowing after the command to shut, in control ticks; looked ahead too. Choice: 0.

    Raises
    ------
    ValueError
        If the dead band or dead time is negative, ambient is not positive, or the pulse is not a whole number from
        1 to 1000.
    """

    dead_band_pa: float = 2.0 * 244.140625
    lookahead: bool = True
    ambient_pa_abs: float = AMBIENT_PA_ABS
    minimum_pulse_ticks: int = 1
    dead_time_ticks: float = 0.0

    def __post_init__(self) -> None:
        require_finite("dead_band_pa", self.dead_band_pa, at_least=0.0)
        require_finite("ambient_pa_abs", self.ambient_pa_abs, above=0.0)
        require_finite("dead_time_ticks", self.dead_time_ticks, at_least=0.0)
        if self.minimum_pulse_ticks not in range(1, 1001):
            raise ValueError(f"minimum_pulse_ticks = {self.minimum_pulse_ticks!r}: must be an integer from 1 to 1000")

    def reset(self) -> ControllerState:
        """Return the memory before the first tick: valves shut, no pulse seen."""
        return (0.0,) * MEMORY_SIZE * len(ELEMENTS)

    def command(
        self, readings_pa_abs: Sequence[float], set_pa_gauge: Sequence[float], state: ControllerState
    ) -> tuple[tuple[ValveCommand, ...], ControllerState]:
        """Return the valve positions of every element, and the new memory (see ``Controller``)."""
        commands: list[ValveCommand] = []
        memory: list[float] = []
        for k, (reading, set_gauge) in enumerate(zip(readings_pa_abs, set_pa_gauge, strict=True)):
            inlet, outlet, last, rise, fall, ticks_open = state[k * MEMORY_SIZE : (k + 1) * MEMORY_SIZE]
            # with dead time the first reading of a pulse shows a part of it: keep what the one before did
            part = self.dead_time_ticks > 0.0 and ticks_open == 1.0
            if self.lookahead and inlet:
                rise = max(reading - last, rise if part else 0.0)
            if self.lookahead and outlet:
                fall = max(last - reading, fall if part else 0.0)
            now = ValveCommand(bool(inlet), bool(outlet))
            if 0.0 < ticks_open < self.minimum_pulse_ticks:
                command = now
            else:
                command = self._decide(reading - self.ambient_pa_abs, float(set_gauge), now, rise, fall)
            ticks_open = ticks_open + 1.0 if command == now else 1.0
            if not (command.inlet_open or command.outlet_open):
                ticks_open = 0.0
            commands.append(command)
            memory += (float(command.inlet_open), float(command.outlet_open), reading, rise, fall, ticks_open)
        return tuple(commands), tuple(memory)

    def _decide(
        self, reading_gauge: float, set_gauge: float, now: ValveCommand, rise: float, fall: float
    ) -> ValveCommand:
        """Return the valve positions of one element from gauge pressures [Pa]."""
        error = set_gauge - reading_gauge
        if set_gauge <= 0.0:
            return ValveCommand(False, -error > (0.0 if now.outlet_open else self.dead_band_pa))
        # a pulse that begins lasts its shortest time, one that goes on may end at the next tick
        going_on, beginning = 1.0 + self.dead_time_ticks, float(self.minimum_pulse_ticks)
        inlet_at = rise * going_on if now.inlet_open else max(self.dead_band_pa, rise * beginning)
        outlet_at = fall * going_on if now.outlet_open else max(self.dead_band_pa, fall * beginning)
        return ValveCommand(error > inlet_at, -error > outlet_at)
