"""Auxiliary functions of programs: handed to spindle and PLC, and awaited by the channel that came to them."""

from __future__ import annotations

from collections.abc import Iterable

from polycnc.cnc._alarms import AlarmList
from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._plc import Function, PlcModel, functions_of
from polycnc.cnc._run_state import INTERRUPTED, RunState
from polycnc.cnc._spindle import Spindle
from polycnc.kernel import RAPID
from polycnc.machine import Clock, TimesConfig
from polycnc.nc import BlockRecord, Dialect, Event, Group, MAction
from polycnc.units import MM_PER_INCH

_ACTIONS = {action.title: action for action in MAction}
_SENSES: dict[MAction | None, int | None] = {
    MAction.SPINDLE_CW: 1, MAction.SPINDLE_CCW: -1, MAction.SPINDLE_STOP: 0, MAction.SPINDLE_ORIENT: None,
}  # fmt: skip
_ORIENTS = 19
"""The M code that cycles orient the spindle with."""
_STOPS = frozenset({MAction.PROGRAM_STOP, MAction.OPTIONAL_STOP, MAction.PROGRAM_END})
_SPINDLE = frozenset({MAction.SPINDLE_CW, MAction.SPINDLE_CCW, MAction.SPINDLE_STOP, MAction.SPINDLE_ORIENT})


class AuxiliaryFunctions:
    """Hand functions over, and know which channel waits for which; with `end_stops` M2 and M30 stop the spindle."""

    def __init__(
        self, clock: Clock, times: TimesConfig, spindle: Spindle, plc: PlcModel, *, end_stops: bool = True
    ) -> None:
        self._clock = clock
        self._times = times
        self._spindle = spindle
        self._plc = plc
        self._end_stops = end_stops
        self.requests: dict[int, list[int]] = {}
        """The serial numbers of what each channel waits for at the PLC."""

    def on_event(self, channel: ControlChannel, event: Event, dialect: Dialect) -> bool:
        """Hand the functions of a block over; return whether the path has to wait for their answers."""
        block = channel.executed
        if block is not None and channel.data.spindle:
            modal = block.modal
            # Constant surface speed has no speed of its own here: the spindle keeps the last one.
            rpm = None if modal.g.get(Group.SPINDLE_MODE) == _surface_speed(dialect) else modal.speed
            direction = _direction(event, block, dialect, end_stops=self._end_stops)
            self._spindle.turn(rpm=rpm, direction=direction)
            if direction is None and not self._spindle.is_orienting:
                self._spindle.orient()
        serials = [
            self._plc.strobe(
                Function(letter), number, default_s=self._default_s(channel, letter, number, dialect)
            )
            for letter, number in functions_of(event.word)
        ]
        waiting = [serial for serial in serials if not self._plc.finished(serial)]
        if waiting:
            self.requests.setdefault(channel.path, []).extend(waiting)
            self._clock.changes += 1
        return bool(waiting)

    def follow(self, channel: ControlChannel) -> None:
        """Let a laser have the power of the block that is executed, at the speed that there is now.

        It is off at rapid, and at rest where the program is held or stopped; with M4 its power is to S as the speed to
        the programmed feed. A program that is over leaves it off where it was switched off.
        """
        run, block = channel.run, channel.executed
        if run is None or block is None:
            return
        row, modal = run.feed.row, block.modal
        rests = run.state in INTERRUPTED and row["speed"] == 0.0
        power = 0.0 if rests or row["flags"] & RAPID else modal.speed
        if modal.spindle_direction < 0:
            feed_mm_s = modal.feed * (MM_PER_INCH if modal.inch else 1.0) / 60.0
            power *= float(row["speed"]) / feed_mm_s if feed_mm_s > 0.0 else 0.0
        going = run.state in (RunState.ACTIVE, RunState.HOLD)
        self._spindle.turn(rpm=power, direction=modal.spindle_direction if going else None)

    def _default_s(self, channel: ControlChannel, letter: str, number: int, dialect: Dialect) -> float:
        """Return how long a function takes that the PLC does not handle: a spindle its ramp, S alone nothing."""
        action = _ACTIONS.get(dialect.m.get(f"{number}", ""))
        if letter != "M" or action in _STOPS:
            return 0.0
        if action in _SPINDLE and channel.data.spindle:
            return max(0, self._spindle.reached_cycle() - self._clock.cycles) * self._clock.cycle_s
        return self._times.tool_change_s if action is MAction.TOOL_CHANGE else self._times.auxiliary_s

    def waiting(self, path: int) -> tuple[str, ...]:
        """Return the functions, like "M8", that a channel waits for."""
        serials = self.requests.get(path)
        if not serials:
            return ()
        return tuple(str(each) for each in self._plc.pending if each.serial in serials)

    def take_answers(self, channel: ControlChannel) -> bool:
        """Let a channel go on whose functions have all been answered; tell whether it does."""
        serials = self.requests.get(channel.path)
        if not serials or not all(self._plc.finished(serial) for serial in serials):
            return False
        del self.requests[channel.path]
        self._clock.changes += 1
        if channel.run is not None:
            channel.run.events.answered()
        return True

    def note_failures(self, alarms: AlarmList) -> None:
        """Put alarms on for the functions that were answered with one, or not in time."""
        for request in self._plc.take_failed():
            name = "function_not_answered" if request.timed_out else "function_failed"
            detail = str(request) if request.timed_out else f"{request}: {request.alarm}"
            paths = (path for path, serials in self.requests.items() if request.serial in serials)
            alarms.put(name, detail=detail, channel=next(paths, None))

    def withdraw(self, channels: Iterable[ControlChannel]) -> None:
        """Wait no longer for the functions of these channels."""
        for channel in channels:
            self._plc.cancel(self.requests.pop(channel.path, ()))

    def serials(self, path: int) -> tuple[int, ...]:
        """Return the requests that a channel waits for, to go back to."""
        return tuple(self.requests.get(path, ()))

    def restore(self, waiting: Iterable[tuple[int, tuple[int, ...]]]) -> None:
        """Go back to what each channel waited for."""
        self._clock.changes += 1
        self.requests = {path: list(serials) for path, serials in waiting if serials}


def _direction(event: Event, block: BlockRecord, dialect: Dialect, *, end_stops: bool) -> int | None:
    """Return how the spindle turns from an event on, None if it is oriented.

    Cycles stop it, turn it back and orient it on their way, by events of their own: what the program says stays. With
    `end_stops` the end of the program stops it (ISO 6983-1, M02 and M30), but not one that returns to a caller.
    """
    modal = block.modal
    returns = dialect.sub_program.end_returns and bool(block.stack)
    direction = None if modal.spindle_oriented else modal.spindle_direction
    for letter, number in functions_of(event.word):
        action = _ACTIONS.get(dialect.m.get(f"{number}", "")) if letter == "M" else None
        if action in _SENSES:
            direction = _SENSES[action]
        elif action is MAction.PROGRAM_END and end_stops and not returns:
            direction = 0
        elif letter == "M" and number == _ORIENTS and number not in modal.m:
            direction = None
    return direction


def _surface_speed(dialect: Dialect) -> str:
    codes = [code for code, name in dialect.g.items() if name == "constant_surface_speed"]
    return f"G{codes[0]}" if codes else ""
