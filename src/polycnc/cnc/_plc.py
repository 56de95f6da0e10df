"""The PLC as a control sees it: auxiliary functions are handed over and answered, at once, later, or never.

Without a script every function is answered after the time that the machine file says. A script gives a function its
own time, an alarm instead of an answer, or no answer until somebody calls `answer`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TypeAlias

from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.errors import shown
from polycnc.machine import Clock, TimesConfig
from polycnc.units import is_finite

_FUNCTION = re.compile(r"([MSTB])(\d+(?:\.\d*)?)")


class Function(StrEnum):
    """The sorts of auxiliary functions."""

    M = "M"
    S = "S"
    T = "T"
    B = "B"


@dataclass(frozen=True, slots=True)
class Answer:
    """How a PLC answers a function: after a time (s; None: not before `answer` is called), well or with an alarm."""

    after_s: float | None = 0.0
    alarm: str = ""


Script: TypeAlias = Mapping[tuple[Function, int | None], Answer]
"""Answers by function and number; number None stands for all numbers that have no line of their own."""


@dataclass(frozen=True, slots=True)
class Request:
    """A function that waits for its answer, which comes in `due_cycle` (None: when `answer` is called).

    With `timed_out` no answer comes: `due_cycle` is when the control gives it up.
    """

    serial: int
    function: Function
    number: int
    cycle: int
    due_cycle: int | None
    alarm: str
    timed_out: bool = False

    def __str__(self) -> str:
        return f"{self.function}{self.number}"


@dataclass(frozen=True, slots=True)
class PlcState:
    """Everything a PLC model holds, to go back to."""

    pending: tuple[Request, ...]
    failed: tuple[Request, ...]
    serial: int


class PlcModel:
    """Answer auxiliary functions on a machine's clock.

    `limit_s` is how long an answer may take before it counts as failed; None: as long as it likes.
    """

    def __init__(
        self, clock: Clock, times: TimesConfig, script: Script | None = None, *, limit_s: float | None = None
    ) -> None:
        self._clock = clock
        self._times = times
        self._script = dict(script or {})
        self._limit_s = limit_s
        self._pending: dict[int, Request] = {}
        self._failed: list[Request] = []
        self._serial = 0
        for (function, number), answer in self._script.items():
            _check(Function(function), number, answer.after_s)

    @property
    def pending(self) -> tuple[Request, ...]:
        """The functions that wait for their answer, oldest first."""
        self._settle()
        return tuple(self._pending.values())

    def script(self, function: Function, number: int | None, answer: Answer) -> None:
        """Say how a function (number None: every number without a line of its own) is answered from now on.

        Raises:
            ControlError: A number below 0, or a time that is negative or not finite.
        """
        _check(function, number, answer.after_s)
        self._script[function, number] = answer

    def strobe(self, function: Function, number: int, *, default_s: float | None = None) -> int:
        """Hand a function over in this cycle; return the serial number to ask `finished` with.

        `default_s` is the time of the answer where the script says nothing; None: the machine file's time of a tool
        change for T, nothing for S, and its time of an auxiliary function for M and B.

        Raises:
            ControlError: A number below 0, or a time that is negative or not finite.
        """
        _check(function, number, default_s)
        answer = self._script.get((function, number)) or self._script.get((function, None))
        if answer is None:
            answer = Answer(self._default_s(function) if default_s is None else default_s)
        now = self._clock.cycles
        due = None if answer.after_s is None else now + self._clock.cycles_for(answer.after_s)
        latest = None if self._limit_s is None else now + self._clock.cycles_for(self._limit_s)
        late = latest is not None and (due is None or due > latest)
        self._clock.changes += 1
        self._serial += 1
        self._pending[self._serial] = Request(
            self._serial, function, number, now, latest if late else due, answer.alarm, late
        )
        return self._serial

    def finished(self, serial: int) -> bool:
        """Tell whether a function has had its answer by this cycle; a failed one never has."""
        self._settle()
        return serial not in self._pending and all(each.serial != serial for each in self._failed)

    def due_cycle(self) -> int | None:
        """Return the next cycle in which an answer comes by itself, None if there is none."""
        self._settle()
        return min(
            (each.due_cycle for each in self._pending.values() if each.due_cycle is not None), default=None
        )

    def answer(self, serial: int | None = None, *, alarm: str = "") -> None:
        """Answer a function that waits (None: the oldest) in this cycle, well or with the text of an alarm.

        Raises:
            ControlError: No such function waits.
        """
        self._settle()
        chosen = next(iter(self._pending), None) if serial is None else serial
        if chosen is None or chosen not in self._pending:
            raise ControlError(
                Refusal.IDLE,
                "no auxiliary function waits for an answer"
                if serial is None
                else f"request {serial} does not wait",
                hint="`pending` lists the functions that wait.",
            )
        self._clock.changes += 1
        self._pending[chosen] = replace(
            self._pending[chosen], due_cycle=self._clock.cycles, alarm=alarm, timed_out=False
        )
        self._settle()

    def take_failed(self) -> tuple[Request, ...]:
        """Return the functions that were answered with an alarm since the last call."""
        self._settle()
        failed = tuple(self._failed)
        self._failed.clear()
        return failed

    def cancel(self, serials: Iterable[int] | None = None) -> None:
        """Withdraw what waits, as a reset does: these requests, or all."""
        self._clock.changes += 1
        if serials is None:
            self._pending.clear()
            self._failed.clear()
            return
        withdrawn = set(serials)
        self._pending = {n: each for n, each in self._pending.items() if n not in withdrawn}
        self._failed = [each for each in self._failed if each.serial not in withdrawn]

    def snapshot(self) -> PlcState:
        """Return everything, to go back to."""
        return PlcState(tuple(self._pending.values()), tuple(self._failed), self._serial)

    def restore(self, state: PlcState) -> None:
        """Go back to a snapshot."""
        self._clock.changes += 1
        self._pending = {each.serial: each for each in state.pending}
        self._failed = list(state.failed)
        self._serial = state.serial

    def _default_s(self, function: Function) -> float:
        if function is Function.T:
            return self._times.tool_change_s
        return 0.0 if function is Function.S else self._times.auxiliary_s

    def _settle(self) -> None:
        """Move what is due by now out of the list of what waits."""
        now = self._clock.cycles
        for serial, each in list(self._pending.items()):
            if each.due_cycle is not None and each.due_cycle <= now:
                del self._pending[serial]
                if each.alarm or each.timed_out:
                    self._failed.append(each)


def functions_of(word: str) -> list[tuple[str, int]]:
    """Return letter and number of the auxiliary functions in the words of an event, "M6 T12" for example."""
    return [(letter, int(float(number))) for letter, number in _FUNCTION.findall(word)]


def _check(function: Function, number: int | None, after_s: float | None) -> None:
    if number is not None and number < 0:
        raise ControlError(
            Refusal.DATA, f"{function}{number} is not an auxiliary function", hint="Numbers start at 0."
        )
    if after_s is not None and not (is_finite(after_s) and after_s >= 0.0):
        raise ControlError(
            Refusal.DATA,
            f"{function}{'' if number is None else number} cannot be answered after {shown(after_s)} s",
            hint="Give a time from 0 s, or None for an answer by hand.",
        )
