"""One CNC task: a program, where it is, what it waits for, and the message string that it writes."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, NamedTuple, Protocol

from polycnc.controllers.apci.core._turn_steps import LATE, WAIT_UNIT_S
from polycnc.controllers.apci.sap._cnc_file import read_cnc, write_cnc
from polycnc.controllers.apci.sap._faults import FAULTS, ILLEGAL, REFUSED, STACK_OVERFLOW, VALUE_RANGE, Fault
from polycnc.controllers.apci.sap._host import Host
from polycnc.controllers.apci.sap._linker import link
from polycnc.controllers.apci.sap._machine import CELL_BYTES, FRAME_CELLS, STACK_CELLS, Pause, Step
from polycnc.controllers.apci.sap._program import Program, cell_values
from polycnc.errors import PolycncError

STRING_BYTES = 512
HALT_AT_WRITELN = 1 << 26  # in MODEREG

RUNNING, HALTED_BY_WRITELN, WAITING = 0x1, 0x4, 0x8  # 0x2, single step, is declared as not implemented
INCOMPLETE, COMPLETE = 0x1, 0x2

_ILLEGAL = (ArithmeticError, AssertionError, AttributeError, LookupError, TypeError, ValueError, struct.error)
"""What forged instructions raise: a program file may hold any (`CNCTS.errnum` tells)."""

_CONDITION_MOST = 1 << 16  # instructions of one look at the condition of an event
_STACK_MOST = STACK_CELLS * 2

# What makes up the state of a task beside its program and what it waits for.
_CELLS = ("stack", "memory", "frames", "_armed")
_NUMBERS = ("base", "next", "_errnum", "_errline", "_text_bits")
_FLAGS = ("_by_writeln", "_in_event")
_TEXTS = ("error", "_text")
_KINDS: tuple[tuple[tuple[str, ...], type], ...] = ((_NUMBERS, int), (_FLAGS, bool), (_TEXTS, str))


class State(Enum):
    """What a task does: nothing, its program, or nothing until it is continued."""

    IDLE = "idle"
    RUNNING = "running"
    STOPPED = "stopped"


@dataclass(frozen=True, slots=True)
class Wait:
    """What a task waits for: the scan number `until`, or, where that is None, the ends of profiles of `axes`."""

    until: int | None
    axes: tuple[int, ...]


class TaskStatus(NamedTuple):
    """The record CNCTS (Manual 002, table 11); `stackfree` is in bytes."""

    errnum: int
    errline: int
    stackfree: int
    running: int
    csrcline: int


class Offloaded(Protocol):
    """What has the state of a task while it is not in the task itself."""

    def reclaim(self) -> None:
        """Put the state back into the task."""

    def where(self) -> tuple[int, int, int, bool]:
        """Return the next instruction, cells on the stack, frames, and whether the task waits."""


class Task:
    """Run the program of one task a number of instructions at a time; see `Tasks` for the public calls."""

    def __init__(self, number: int, host: Host, control: Callable[[str, int], None]) -> None:
        self.number = number
        self.host = host
        self.control = control
        self.program: Program | None = None
        self.state = State.IDLE
        self.waiting: Wait | None = None
        self.error = ""  # of the last run-time error, for people
        self.stack: list[Any] = []
        self.memory: list[Any] = []
        self.frames: list[tuple[int, int]] = []
        self.base = 0
        self.next = 0
        self._errnum = self._errline = 0
        self._steps: list[Step] = []
        self.away: Offloaded | None = None  # has stack, memory, frames, wait and place of the program
        self._by_writeln = False
        self._in_event = False
        self._waiting_before: Wait | None = None  # of the program that an event handler interrupts
        self._armed: list[bool] = []
        self._text = ""
        self._text_bits = 0

    # Control

    def load(self, program: Program) -> None:
        """Halt the task and overwrite its program."""
        self._reset()
        self.program = program

    def start(self) -> None:
        """Run the program from its beginning, with all variables zero; a running one is stopped first."""
        self._reset()
        if self.program is not None:
            self.memory.extend(cell_values(self.program.variables))
            self._armed = [True] * len(self.program.events)
            try:
                self._steps = link(self, self.program)
            except _ILLEGAL as error:
                self._steps = []
                self._fail(0, ILLEGAL, f"{FAULTS[ILLEGAL]}: {error}")
                return
            self.state = State.RUNNING

    def end(self, stop: bool) -> None:
        """End the program: to be continued (`stop`), or for good."""
        self.reclaim_state()
        if self.state is State.RUNNING or not stop:
            self.state = State.STOPPED if stop else State.IDLE
            self._by_writeln = False

    def resume(self) -> None:
        """Go on after a stop; a program that has ended stays so."""
        if self.state is State.STOPPED:
            self.state = State.RUNNING
            self._by_writeln = False

    def is_halted(self) -> bool:
        """Return whether the task is not to run any further."""
        return self.state is not State.RUNNING

    def reclaim_state(self) -> None:
        """Have the state of the program in the task itself."""
        if self.away is not None:
            away, self.away = self.away, None
            away.reclaim()

    def _reset(self) -> None:
        self.reclaim_state()
        self.state = State.IDLE
        self.waiting = self._waiting_before = None
        self.error = ""
        self.stack.clear()
        self.memory.clear()
        self.frames.clear()
        self.base = self.next = self._errnum = self._errline = 0
        self._by_writeln = self._in_event = False

    # Running

    def run(self, budget: int, *, rest: bool = False) -> None:
        """Run at most `budget` instructions, as one scan does; return early when the program waits or ends.

        The `rest` of a turn begins in the middle of the program, without a look at events and waits.
        """
        self.reclaim_state()
        if self.state is not State.RUNNING:
            return
        at = self.next
        try:
            if self._armed and not self._in_event and not rest:
                self._raise_event()
            if self.waiting is not None:
                if not self._is_over(self.waiting):
                    return
                self.waiting = None
            steps = self._steps
            at = self.next
            for _ in range(budget):
                at = steps[at]()
            self.next = at
            if len(self.stack) > _STACK_MOST:  # only a forged program leaves values behind
                raise Fault(STACK_OVERFLOW)
        except Pause:
            pass
        except Fault as fault:
            self._fail(at, fault.number, str(fault))
        except PolycncError as error:
            self._fail(at, REFUSED, str(error))
        except _ILLEGAL as error:
            self._fail(at, ILLEGAL, f"{FAULTS[ILLEGAL]}: {error}")

    def _fail(self, at: int, number: int, text: str) -> None:
        self.state, self.waiting = State.IDLE, None
        self.next = at = at if 0 <= at < len(self._steps) else 0
        self._errnum, self._errline, self.error = number, self._line(at), text

    def _raise_event(self) -> None:
        """Begin the first handler whose condition has become true; it interrupts the program and its wait."""
        assert self.program is not None
        for index, (condition, handler) in enumerate(self.program.events):
            if not self._holds(condition):
                self._armed[index] = True
            elif self._armed[index]:
                self._armed[index] = False
                entry = self.program.routines[handler]
                self.frames.append((self.next, self.base))
                self.base = len(self.stack)
                self.stack.extend(cell_values(entry.cells))
                self.next = entry.start
                self._waiting_before, self.waiting = self.waiting, None
                self._in_event = True
                return

    def leave_event(self) -> None:
        """Return to what the event handler has interrupted."""
        self.waiting, self._waiting_before = self._waiting_before, None
        self._in_event = False

    def _holds(self, condition: int) -> bool:
        at = condition
        try:
            for _ in range(_CONDITION_MOST):
                at = self._steps[at]()
                if at < 0:
                    return bool(self.stack.pop())
            raise Fault(ILLEGAL, "a condition without end")
        except Fault as fault:
            self._fail(condition, fault.number, str(fault))
            raise Pause from None
        except PolycncError as error:
            self._fail(condition, REFUSED, str(error))
            raise Pause from None
        except _ILLEGAL as error:
            self._fail(condition, ILLEGAL, f"{FAULTS[ILLEGAL]}: {error}")
            raise Pause from None

    # Waiting

    def wait(self, time_ms: float, axes: tuple[int, ...]) -> bool:
        """Begin to wait, for the ends of profiles if there are axes; return False if there is nothing to wait for."""
        scans = time_ms * WAIT_UNIT_S / self.host.scan_s
        if not scans < 2.0**53:
            raise Fault(VALUE_RANGE)
        until = None if axes else self.host.scan + (math.ceil(scans - LATE) if scans > 0.0 else 0)
        wait = Wait(until, axes)
        self.waiting = None if self._is_over(wait) else wait
        return self.waiting is not None

    def _is_over(self, wait: Wait) -> bool:
        if wait.until is None:
            return self.host.profile_ended(wait.axes)
        return self.host.scan >= wait.until

    @property
    def in_event(self) -> bool:
        """Return whether the program is in the handler of an event."""
        return self._in_event

    @property
    def armed(self) -> list[bool]:
        """Return, event by event, whether its condition has not held since it was raised."""
        return self._armed

    # Messages

    def write(self, text: str) -> None:
        """Append to the message string, which begins anew after a complete one; it ends at 512 characters."""
        if self._text_bits & COMPLETE:
            self._text, self._text_bits = "", 0
        self._text = (self._text + text)[:STRING_BYTES]
        self._text_bits = INCOMPLETE

    def write_line(self) -> None:
        """Complete the message string; with MODEREG bit 26 the task stops here."""
        if self._text_bits & COMPLETE:
            self._text = ""
        self._text_bits = COMPLETE
        if int(self.host.read_system("modereg", None)) & HALT_AT_WRITELN:
            self.end(stop=True)
            self._by_writeln = True

    @property
    def text_bits(self) -> int:
        """Return bit 0 for an incomplete and bit 1 for a complete message that nobody has read."""
        return self._text_bits

    def take_text(self, size: int) -> str:
        """Return the message string, at most `size` characters of it, and forget it."""
        text, self._text, self._text_bits = self._text[: max(0, size)], "", 0
        return text

    # Status

    def status(self) -> TaskStatus:
        """Return the record that rdcncts reads."""
        at, waits = self.next, self.waiting is not None
        cells, frames = len(self.stack), len(self.frames)
        if self.away is not None:
            at, cells, frames, waits = self.away.where()
        running = RUNNING * (self.state is State.RUNNING) | HALTED_BY_WRITELN * self._by_writeln
        running |= WAITING * (self.state is State.RUNNING and waits)
        free = CELL_BYTES * max(0, STACK_CELLS - cells - FRAME_CELLS * frames)
        here = at - 1 if waits else at  # a wait is being executed until it ends
        return TaskStatus(self._errnum, self._errline, free, running, self._line(here))

    def _line(self, at: int) -> int:
        return self.program.code[at][2] if self.program is not None else 0

    # State

    def save(self) -> dict[str, Any]:
        """Return program and state as plain data."""
        self.reclaim_state()
        waits = (self.waiting, self._waiting_before)
        return {
            "program": None if self.program is None else write_cnc(self.program),
            "state": self.state.value,
            "waits": [None if wait is None else [wait.until, wait.axes] for wait in waits],
            **{name: getattr(self, name) for name in (*_CELLS, *_NUMBERS, *_FLAGS, *_TEXTS)},
            "linked": bool(self._steps),
        }

    def read_saved(self, data: Mapping[str, Any]) -> Callable[[], None]:
        """Read what `save` has returned; return what puts it back.

        Raises:
            KeyError, TypeError, ValueError: It is damaged.
        """
        program = None if data["program"] is None else read_cnc(data["program"])
        if program is None and data["linked"]:
            raise ValueError("a task runs no program")
        steps = link(self, program) if program is not None and data["linked"] else []
        state = State(data["state"])
        waits = [None if wait is None else Wait(wait[0], tuple(wait[1])) for wait in data["waits"]]
        cells = {name: list(data[name]) for name in _CELLS}
        cells["frames"] = [(int(back), int(base)) for back, base in cells["frames"]]
        rest = {name: kind(data[name]) for names, kind in _KINDS for name in names}

        def put() -> None:
            self.away = None
            self.program, self.state, self._steps = program, state, steps
            self.waiting, self._waiting_before = waits
            for name, values in cells.items():
                getattr(self, name)[:] = values  # the steps hold on to these lists
            for name, value in rest.items():
                setattr(self, name, value)

        return put
