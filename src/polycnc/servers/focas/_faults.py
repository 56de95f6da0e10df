"""Faults on demand: a script says when what goes wrong, by the machine's time or by counts of requests.

Nothing here is random and nothing looks at a wall clock: the same script and the same requests give the same faults.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Self

from pydantic import Field, model_validator

from polycnc.machine import StrictModel, load_toml, validate

if TYPE_CHECKING:
    from polycnc.controllers.fanuc import PowerMate


class FaultKind(StrEnum):
    """What can go wrong."""

    LATENCY = "latency"
    """Replies come later by `delay_s`."""
    DROP = "drop"
    """The connection is reset instead of carrying a request out."""
    HALF = "half"
    """A request is carried out; half of the reply is sent, then the connection is reset."""
    MUTE = "mute"
    """A request is carried out and never answered."""
    REFUSE = "refuse"
    """A new session is refused as if all were used."""
    UNREACHABLE = "unreachable"
    """Nothing listens: new connections are refused; those that are open stay."""
    EMERGENCY_STOP = "emergency_stop"
    """The emergency stop is pressed, and released at the end."""
    ALARM = "alarm"
    """An alarm comes on; at the end RESET is pressed."""
    NO_OPTION = "no_option"
    """`commands` (all, if none are named) answer that their option is missing."""


_OF_MACHINE = (FaultKind.EMERGENCY_STOP, FaultKind.ALARM)


@cache
def _codes() -> Mapping[str, tuple[int, int]]:
    """Return the target and code of each command by its name."""
    from polycnc.controllers.fanuc.wire import LAYOUTS  # most scenarios name none

    return {
        name: target_code
        for target_code, layout in LAYOUTS.items()
        for name in layout.function.replace(" (old series)", "").split(", ")
    }


class Fault(StrictModel):
    """One fault: it begins at a machine time (s) or request, and ends after a time or number of them, or never.

    Requests are frames of commands, of all clients, counted from 1 since the machine is served.
    """

    kind: FaultKind = Field(strict=False)
    at_s: float | None = Field(default=None, ge=0.0, allow_inf_nan=False)
    at_request: int | None = Field(default=None, ge=1)
    for_s: float | None = Field(default=None, gt=0.0, allow_inf_nan=False)
    for_requests: int | None = Field(default=None, ge=1)
    delay_s: float = Field(default=0.0, ge=0.0, le=3600.0)
    alarm: int = Field(default=1000, ge=0, le=5999)
    text: str = Field(default="", max_length=64)
    axis: int | None = Field(default=None, ge=1)
    commands: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.at_s is None) == (self.at_request is None):
            raise ValueError("a fault begins at `at_s` or at `at_request`")
        if self.for_s is not None and self.for_requests is not None:
            raise ValueError("a fault ends after `for_s` or after `for_requests`")
        if (self.kind is FaultKind.LATENCY) != (self.delay_s > 0.0):
            raise ValueError("`delay_s` belongs to the kind latency")
        if self.commands and (unknown := [name for name in self.commands if name not in _codes()]):
            raise ValueError(f"no command is called {unknown[0]}")
        if self.commands and self.kind is not FaultKind.NO_OPTION:
            raise ValueError("`commands` belong to the kind no_option")
        return self

    @property
    def codes(self) -> frozenset[tuple[int, int]]:
        """The commands that it is about, by target and code; empty: all."""
        return frozenset(_codes()[name] for name in self.commands)


class _Script(StrictModel):
    fault: tuple[Fault, ...] = ()


def load_faults(path: Path) -> tuple[Fault, ...]:
    """Read a script: a TOML file of `[[fault]]` tables.

    Raises:
        UsageError: It cannot be read, or says what cannot be.
    """
    return validate(_Script, *load_toml(path)).fault


@dataclass(frozen=True, slots=True)
class Plan:
    """What happens to one frame of commands."""

    delay_s: float = 0.0
    kind: FaultKind | None = None
    """DROP, HALF or MUTE; None: it is answered."""
    missing: frozenset[tuple[int, int]] | None = None
    """Commands whose option is missing; empty: all of them, None: none."""


_NOTHING = Plan()


@dataclass(slots=True)
class _Course:
    fault: Fault
    since_s: float = math.inf
    since_request: int | None = None
    over: bool = False

    @property
    def waits(self) -> bool:
        return self.since_s == math.inf and not self.over

    @property
    def on(self) -> bool:
        return self.since_s < math.inf and not self.over


class Faults:
    """Follow a script: tell of every frame what happens to it, and do to the machine what the script says.

    `begin_s` is the machine's time from which the script counts.
    """

    def __init__(self, script: Iterable[Fault] = (), begin_s: float = 0.0) -> None:
        self._courses = [_Course(fault) for fault in script]
        self._begin_s = begin_s
        self.requests = 0
        """How many frames of commands have come."""

    @property
    def active(self) -> Sequence[Fault]:
        """The faults that hold now."""
        return [course.fault for course in self._courses if course.on] if self._courses else ()

    def has(self, kind: FaultKind) -> bool:
        """Whether a fault of a kind holds."""
        return any(course.on and course.fault.kind is kind for course in self._courses)

    def knows(self, kind: FaultKind) -> bool:
        """Whether the script has a fault of a kind at all."""
        return any(course.fault.kind is kind for course in self._courses)

    def next_s(self) -> float:
        """Return the machine's time at which something begins or ends; infinity if only requests can bring it."""
        times = [math.inf]
        for course in self._courses:
            fault = course.fault
            if course.over:
                continue
            if course.on and fault.for_s is not None:
                times.append(course.since_s + fault.for_s)
            elif not course.on and fault.at_s is not None:
                times.append(self._begin_s + fault.at_s)
        return min(times)

    def look(self, control: PowerMate) -> None:
        """Let begin and end what is due at the machine's time; `next_s` says when to look."""
        now_s = control.clock.now_s
        for course in self._courses:
            fault = course.fault
            if course.waits and fault.at_s is not None and _reached(now_s, self._begin_s + fault.at_s):
                self._begin(course, control)
            if course.on and fault.for_s is not None and _reached(now_s, course.since_s + fault.for_s):
                self._finish(course, control)

    def request(self, control: PowerMate) -> Plan:
        """Count a frame of commands and say what happens to it."""
        self.requests += 1
        if not self._courses:
            return _NOTHING
        self.look(control)
        for course in self._courses:
            fault = course.fault
            if course.waits and fault.at_request is not None and fault.at_request <= self.requests:
                self._begin(course, control)
            if course.on and fault.for_requests is not None:
                if course.since_request is None:
                    course.since_request = self.requests
                if self.requests >= course.since_request + fault.for_requests:
                    self._finish(course, control)
        return self.plan_of(self.active)

    @staticmethod
    def plan_of(on: Sequence[Fault]) -> Plan:
        """Return what faults that hold together do to a frame."""
        kinds = [fault.kind for fault in on if fault.kind in (FaultKind.DROP, FaultKind.HALF, FaultKind.MUTE)]
        missing = [fault.codes for fault in on if fault.kind is FaultKind.NO_OPTION]
        return Plan(
            sum(fault.delay_s for fault in on),
            kinds[0] if kinds else None,
            None
            if not missing
            else frozenset()
            if frozenset() in missing
            else frozenset[tuple[int, int]]().union(*missing),
        )

    def _begin(self, course: _Course, control: PowerMate) -> None:
        fault = course.fault
        course.since_s = control.clock.now_s
        if fault.kind is FaultKind.EMERGENCY_STOP:
            control.emergency_stop(True)
        elif fault.kind is FaultKind.ALARM:
            axis = None if fault.axis is None else min(fault.axis, control.axes)
            control.raise_alarm(fault.alarm, fault.text, axis=axis)

    def _finish(self, course: _Course, control: PowerMate) -> None:
        course.over = True
        if course.fault.kind is FaultKind.EMERGENCY_STOP and not self.has(FaultKind.EMERGENCY_STOP):
            control.emergency_stop(False)
        elif course.fault.kind is FaultKind.ALARM:
            control.reset()


class PresentFaults(Faults):
    """What the scenario that is followed now says, whichever that is: faults itself, or something that has `faults`."""

    def __init__(self, scenario: Callable[[], object]) -> None:
        super().__init__()
        self._scenario = scenario

    @property
    def _now(self) -> Faults | None:
        scenario = self._scenario()
        found = scenario if isinstance(scenario, Faults) else getattr(scenario, "faults", None)
        return found if isinstance(found, Faults) else None

    @property
    def active(self) -> Sequence[Fault]:
        """The faults that hold now."""
        return () if (now := self._now) is None else now.active

    def has(self, kind: FaultKind) -> bool:
        """Whether a fault of a kind holds."""
        return (now := self._now) is not None and now.has(kind)

    def knows(self, kind: FaultKind) -> bool:
        """Whether there is a fault of a kind at all."""
        return (now := self._now) is not None and now.knows(kind)

    def request(self, control: PowerMate) -> Plan:
        """Count a frame of commands and say what happens to it."""
        return _NOTHING if (now := self._now) is None else now.request(control)


def _reached(now_s: float, then_s: float) -> bool:
    return now_s >= then_s - 1e-9
