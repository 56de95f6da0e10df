"""Follow a scenario: begin and end its steps at their cycles and requests, the same ones however time is cut."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from polycnc.errors import ConfigurationError, PolycncError, UsageError
from polycnc.machine import StrictModel
from polycnc.servers.commands import told
from polycnc.servers.focas import Fault, FaultKind, Faults, Plan
from polycnc.servers.machines import Log, ServedMachine, Treatment
from polycnc.servers.scenarios._actions import ACTIONS, DOORS, Action, Undo, fault_of
from polycnc.servers.scenarios._script import Script, Step, When

_LOOK_CYCLES = 20
_DOWN = 1e-9


@dataclass(slots=True)
class _Course:
    """How far a step is: `began_s` are the machine times of its first and its last begin."""

    step: Step
    action: Action
    values: Any
    done: int = 0
    began_s: float = math.inf
    last_s: float = math.inf
    since_request: int | None = None
    on: bool = False
    undo: Undo | None = None

    @property
    def waits(self) -> bool:
        """Whether it has not begun."""
        return self.done == 0

    @property
    def repeats(self) -> bool:
        """Whether it begins once more."""
        return 0 < self.done < self.step.times


@dataclass(frozen=True, slots=True)
class StepState:
    """How far a step is: `done` of its times have begun, and whether it is `on`."""

    step: Step
    done: int
    on: bool


@dataclass(frozen=True, slots=True)
class Happened:
    """What happened: the cycle, the step, and `began`, `ended` or why it was refused."""

    cycle: int
    step: str
    what: str


class Story:
    """A scenario on a machine, from now on; `happened` is what it has done.

    Raises:
        UsageError: A step is not for this machine.
    """

    def __init__(self, script: Script, machine: ServedMachine, log: Log | None = None) -> None:
        self.script = script
        self._machine = machine
        self._log = log or Log()
        self._courses = [_course(script, index, machine) for index in range(len(script.step))]
        self._by_name = {each.step.name: each for each in self._courses}
        self._requests: dict[str, int] = {}
        self.happened: list[Happened] = []
        self.faults = _ConnectionFaults(self)
        """What the door of FOCAS asks."""
        self.begin()

    def begin(self) -> None:
        """Count times from now on, and treat requests as the scenario says; the one before is closed by then."""
        self._begin_s = self._machine.served.clock.now_s
        self._machine.treat = self.request

    @property
    def steps(self) -> list[StepState]:
        """The steps, in the order of the file."""
        return [StepState(each.step, each.done, each.on) for each in self._courses]

    @property
    def passed_s(self) -> float:
        """The machine time since it began."""
        return self._machine.served.clock.now_s - self._begin_s

    def close(self) -> None:
        """End what is on, and let requests be treated as usual."""
        for course in self._courses:
            if course.on and course.action.ends:
                self._end(course)
        self._machine.treat_as_usual()

    # ------------------------------------------------------------------ time

    def next_s(self) -> float:
        """Return the machine's time at which something begins or ends, or is to be looked for."""
        times = [math.inf]
        clock = self._machine.served.clock
        for course in self._courses:
            step = course.step
            if course.on and step.for_s is not None:
                times.append(course.last_s + step.for_s)
            if course.waits:
                if step.at_s is not None:
                    times.append(self._at_s(course))
                elif step.at_request is None:
                    times.append((clock.cycles // _LOOK_CYCLES + 1) * _LOOK_CYCLES * clock.cycle_s)
            elif course.repeats and step.every_s is not None:
                times.append(course.last_s + step.every_s)
        return min(times)

    def look(self, device: object, /) -> None:
        """Do what is due at the machine's time."""
        clock = self._machine.served.clock
        now_s, is_look = clock.now_s + _DOWN, clock.cycles % _LOOK_CYCLES == 0
        for course in self._courses:
            step = course.step
            if course.on and step.for_s is not None and now_s >= course.last_s + step.for_s:
                self._end(course)
            if course.waits:
                if step.at_s is not None:
                    due = now_s >= self._at_s(course)
                else:
                    due = is_look and step.at_request is None and self._holds(step)
                if due:
                    self._begin(course)
            elif course.repeats and step.every_s is not None and now_s >= course.last_s + step.every_s:
                self._begin(course)

    def _at_s(self, course: _Course) -> float:
        step = course.step
        assert step.at_s is not None
        from_s = self._begin_s if step.after is None else self._by_name[step.after].began_s
        return from_s + step.at_s

    def _holds(self, step: Step) -> bool:
        control = self._machine.control
        assert control is not None
        status = control.status()
        if step.when is not None:
            return _compares(step.when, read_path(status, step.when.value))
        block = status.channel.block
        assert step.at_line is not None
        return (
            block is not None
            and status.channel.active
            and block.line >= step.at_line
            and step.program in (None, block.program)
        )

    # ------------------------------------------------------------------ requests

    def request(self, door: str) -> Treatment:
        """Count a request of a door, do what is due at it, and say how it is to be treated."""
        count = self._requests[door] = self._requests.get(door, 0) + 1
        for course in self._courses:
            step = course.step
            if step.door != door:
                continue
            if course.waits and step.at_request is not None and count >= step.at_request:
                self._begin(course)
            if course.on and step.for_requests is not None:
                if course.since_request is None:
                    course.since_request = count
                if count >= course.since_request + step.for_requests:
                    self._end(course)
        faults = self.connection_faults(door)
        return Treatment(
            any(each.kind is FaultKind.DROP for each in faults), sum(each.delay_s for each in faults)
        )

    def connection_faults(self, door: str) -> list[Fault]:
        """Return what happens to the connections of a door now."""
        return [
            fault_of(each.action.name, each.values) for each in self._courses
            if each.on and each.action.connection and each.step.door == door
        ]  # fmt: skip

    def knows(self, kind: FaultKind) -> bool:
        """Tell whether the scenario has a step of this kind at all."""
        return any(each.action.name == kind.value for each in self._courses)

    # ------------------------------------------------------------------ steps

    def _begin(self, course: _Course) -> None:
        now_s = self._machine.served.clock.now_s
        if course.done == 0:
            course.began_s = now_s
        course.done += 1
        course.last_s = now_s
        try:
            course.undo = course.action.begin(self._machine, course.values)
        except PolycncError as error:
            self._tell(course, f"refused: {error.what}")
            return
        course.on = True
        self._tell(course, "began")

    def _end(self, course: _Course) -> None:
        course.on = False
        course.since_request = None
        undo, course.undo = course.undo, None
        try:
            if undo is not None:
                undo()
        except PolycncError as error:
            self._tell(course, f"refused: {error.what}")
            return
        self._tell(course, "ended")

    def _tell(self, course: _Course, what: str) -> None:
        cycle = self._machine.served.clock.cycles
        self.happened.append(Happened(cycle, course.step.name, what))
        self._log.write("scenario", machine=self._machine.name, step=course.step.name, what=what, cycle=cycle)


class _ConnectionFaults(Faults):
    """The steps about the connections of FOCAS, as its door asks for them."""

    def __init__(self, story: Story) -> None:
        super().__init__()
        self._story = story

    @property
    def active(self) -> list[Fault]:
        """What holds now."""
        return self._story.connection_faults("focas")

    def has(self, kind: FaultKind) -> bool:
        """Whether something of a kind holds."""
        return any(each.kind is kind for each in self.active)

    def knows(self, kind: FaultKind) -> bool:
        """Whether the scenario has something of a kind at all."""
        return self._story.knows(kind)

    def request(self, control: object) -> Plan:
        """Count a frame of commands and say what happens to it."""
        self.requests += 1
        self._story.request("focas")
        return self.plan_of(self.active)


# ---------------------------------------------------------------------- checks


def _course(script: Script, index: int, machine: ServedMachine) -> _Course:
    """Return a step that has not begun, checked against the machine."""
    step, at = script.step[index], "do"
    try:
        action = ACTIONS.get(step.do)
        if action is None:
            raise UsageError(f"nothing is called '{step.do}'", hint=f"Actions are {', '.join(ACTIONS)}.")
        at = "door"
        _check_door(step, action)
        at = "for_s" if step.for_requests is None else "for_requests"
        if (step.for_s is not None or step.for_requests is not None) and not action.ends:
            raise UsageError(
                f"{step.do} has no end", hint="Leave the time away, and add a step that undoes it."
            )
        at = "with"
        values = _values(step, action)
        action.check(machine, values)
        at = "at_line" if step.when is None else "when"
        if step.when is not None or step.at_line is not None:
            if machine.control is None:
                raise UsageError("this machine has no status of a control", hint="Begin at a time.")
            if step.when is not None:
                read_path(machine.control.status(), step.when.value)
    except PolycncError as error:
        raise ConfigurationError(
            f"step '{step.name}': {error.what}",
            hint=error.hint,
            position=script.position(("step", index, at)),
        ) from None
    return _Course(step, action, values)


def _values(step: Step, action: Action) -> Any:
    if action.values is StrictModel:
        return step.values
    try:
        return action.values.model_validate(dict(step.values))
    except ValidationError as error:
        raise UsageError(told(error), hint="See its row in the reference.") from None


def _check_door(step: Step, action: Action) -> None:
    if step.door is None:
        if action.connection:
            raise UsageError(f"{step.do} happens to a door", hint=f"Name one: {', '.join(DOORS)}.")
        return
    if step.door not in DOORS:
        raise UsageError(
            f"requests of the door '{step.door}' are not counted", hint=f"Those of {', '.join(DOORS)} are."
        )
    if action.connection and action.name not in DOORS[step.door]:
        raise UsageError(
            f"{step.do} does not happen to {step.door}",
            hint=f"There is {', '.join(sorted(DOORS[step.door]))}.",
        )


def read_path(status: Any, path: str) -> Any:
    """Return a value of a status: names, keys and numbers with points between, like `channels.0.feed.actual`.

    Raises:
        UsageError: There is no such value.
    """
    found = status
    for name in path.split("."):
        names: Iterable[Any]
        if isinstance(found, Mapping):
            names = found
            inner = found.get(name)
        elif isinstance(found, tuple) and not hasattr(found, "_fields"):
            names = range(len(found))
            inner = found[int(name)] if name.isascii() and name.isdigit() and int(name) < len(found) else None
        else:
            names = getattr(found, "_fields", None) or getattr(found, "__dataclass_fields__", {})
            inner = getattr(found, name) if name in names else None
        if inner is None and name not in {str(each) for each in names}:
            raise UsageError(
                f"the status has no value '{path}'",
                hint=f"There is {', '.join(map(str, names))[:200] or 'nothing'}.",
            )
        found = inner
    return found


def _compares(when: When, value: Any) -> bool:
    if when.equals is not None:
        return bool(value == when.equals)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return value > when.above if when.above is not None else when.below is not None and value < when.below
