"""Run linked programs: the stack of running ones, their events, and run-time errors at their places."""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable, Container, Sequence
from typing import Any, NamedTuple

from polycnc.errors import PolycncError, ProgramError
from polycnc.language import Execution as Generated
from polycnc.language import Flaw, Traced
from polycnc.machine import SnapshotError
from polycnc.nc.cpl import _numbers, _strings
from polycnc.nc.cpl._faults import CPL_IN_UNLINKED, INVALID_PARAMETER, INVALID_VARIABLE, Fault
from polycnc.nc.cpl._fields import Field, dimension_field, index_needed
from polycnc.nc.cpl._functions import OWN
from polycnc.nc.cpl._host import (
    OMITTED,
    PAUSE,
    BlockWord,
    Box,
    Event,
    Host,
    Item,
    Lines,
    NcValues,
    Pause,
    Step,
    SubProgram,
    Waiting,
    wait_for,
)
from polycnc.nc.cpl._nul_names import nul_name
from polycnc.nc.cpl._program import NESTING, Linker, Program, shown_call
from polycnc.nc.cpl._variables import SUFFIXES, Kind

_STATE = re.compile(r"v_|at[0-9]|go\Z|t[0-9]|\Z")


class Arguments(NamedTuple):
    """What a program was called with, and whether its caller was linked."""

    values: tuple[object, ...] = ()
    linked: bool = True


class Called(NamedTuple):
    """What a call hands to the source of its sub-program; `modal`: its moves are followed by no call."""

    program: Program
    arguments: Arguments
    modal: bool = False


class Execution:
    """One program that runs: its next event, and its run-time errors at their places."""

    def __init__(
        self, program: Program, linker: Linker, host: Host, variables: dict[str, Any], arguments: Arguments
    ) -> None:
        for error in undeclared(program, host.permanent):
            raise error
        self.program = program
        self.linked = arguments.linked and not program.marked_din
        self.line = 0
        """The line of the last event."""
        self._linker = linker
        self.arguments = arguments
        given = variables, host.permanent, host, arguments
        self._run = Generated(program.traced, _SCOPE, given, self._explained)

    def step(self, answer: object = None) -> Event | None:
        """Return the next event, None at the end; `answer` is that to the last one (WAIT: 0, 1 or 2).

        Raises:
            ProgramError: The program does what it must not.
        """
        event: Event | None = self._run.next(answer)
        if event is not None and not isinstance(event, Pause):
            self.line = event[0]
        return event

    @property
    def place(self) -> int | None:
        """The line of its Python at which it stands: 0 before the first, None after the last.

        Raises:
            SnapshotError: It waits for the answer of a function, in the middle of a statement.
        """
        if self._run.inner is not None:
            raise SnapshotError(
                "the CPL program waits for the answer of a function",
                hint="take the snapshot when it has come",
            )
        return self._run.place

    def names(self) -> dict[str, Any]:
        """Return the names of its Python."""
        return self._run.names

    def go_to(self, traced: Traced[int] | None, names: dict[str, object]) -> object:
        """Stand where the code of `traced` stands (see `standing`), None at the end; return what it gives there."""
        return self._run.go_on(traced, names)

    @property
    def statement_line(self) -> int:
        """The line of the statement that is executed, or was last."""
        at = self._run.at
        return self.line if at is None else self.program.source.line_of(at)

    def error_here(self, what: str, hint: str = "") -> ProgramError:
        """Return an error at the statement that is executed, or was last."""
        line = max(self.statement_line, 1)
        source = self.program.source
        return source.error(Flaw(source.begin(line), what, hint))

    def close(self) -> None:
        """End the program."""
        self._run.close()

    def called(self, call: SubProgram, running: Sequence[Program]) -> Program:
        """Return the sub-program that is called, `running` being those under way.

        Raises:
            ProgramError: There is none, or it must not be called here.
        """
        program = self._linker.sub_program(call.address, call.name)
        if program is None:
            what = f"there is no sub-program {shown_call(call.address, call.name)}"
            raise self._error(call, what, "write it into a file of this name")
        if len(running) > NESTING:
            raise self._error(call, f"sub-programs are nested more than {NESTING} deep")
        if program in running:
            raise self._error(call, f"{call.name} calls itself", "recursive calls are not possible")
        if (call.unlinked or program.marked_din) and not program.is_plain:
            hint = f"take DIN from the call of {call.name} or from its first line"
            raise self._error(call, CPL_IN_UNLINKED.what, hint)
        return program

    def local_variables(self) -> dict[str, object]:
        """Return the local variables by name."""
        values = self._run.names
        local = (each for each in self.program.variables if each.scope in ("local", "parameter"))
        return {each.name: shown(values.get(each.python)) for each in local}

    def state(self) -> dict[str, object]:
        """Return what it goes on with: its place, variables, and what it is just computing; not what counts pauses."""
        return {name: value for name, value in self._run.state().items() if _STATE.match(name)}

    def _error(self, call: SubProgram, what: str, hint: str = "") -> ProgramError:
        source = self.program.source
        text = source.line(call.line)
        return source.error(Flaw(source.begin(call.line) + len(text) - len(text.lstrip()), what, hint))

    def _explained(self, error: Exception, at: int) -> ProgramError:
        what, hint, code = _meaning(error)
        if what == _numbers.not_assigned().what and (name := nul_name(error, self.program)):
            what = f"INVALID VARIABLE: {name} has no value (NUL)"
        return self.program.source.error(Flaw(at, what, hint, code=code))


class Run:
    """One run of a main program with its sub-programs; global variables live as long as it.

    Call `step` for the next thing that the control has to do; None is the end. A sub-program call is not handed out
    but entered: its program is on `stack` then.
    """

    def __init__(self, main: Program, linker: Linker, host: Host) -> None:
        self.globals: dict[str, Any] = {}
        self.stack: list[Execution] = []
        self._host = host
        self._linker = linker
        self._enter(main, Arguments())

    def step(self, answer: object = None) -> Event | None:
        """Return the next event; `answer` is that to the last one (WAIT: 0, 1 or 2).

        Raises:
            ProgramError: The program does what it must not; the run is over.
        """
        try:
            while self.stack:
                event = self.stack[-1].step(answer)
                answer = None
                if event is None:
                    self.stack.pop()
                elif isinstance(event, SubProgram):
                    caller = self.stack[-1]
                    program = caller.called(event, [each.program for each in self.stack])
                    self._enter(program, Arguments(event.arguments, caller.linked))
                else:
                    return event
        except PolycncError:
            self.stop()
            raise
        return None

    def leave(self) -> bool:
        """End the program that runs now (M30, M17); tell whether another one goes on."""
        if self.stack:
            self.stack.pop().close()
        return bool(self.stack)

    def stop(self) -> None:
        """End all programs."""
        while self.leave():
            pass

    def local_variables(self) -> dict[str, object]:
        """Return the local variables of the program that runs now, by name."""
        return self.stack[-1].local_variables() if self.stack else {}

    def _enter(self, program: Program, arguments: Arguments) -> None:
        self.stack.append(Execution(program, self._linker, self._host, self.globals, arguments))


def undeclared(program: Program, permanent: Container[str]) -> list[ProgramError]:
    """Return an error for each permanent variable of a program that the control does not have."""
    hint = "declare it in wmhperm.dat or anwperm.dat, and write the mark of its type: % ! ? $"
    return [
        program.source.error(Flaw(at, f"there is no permanent variable {each.name}", hint))
        for each, at in program.variables.items()
        if each.scope == "permanent" and each.name not in permanent
    ]


def shown(value: object) -> object:
    """Return the value of a variable as it is shown: texts as texts, fields as the field."""
    return _strings.text_of(value) if isinstance(value, _strings.CharacterField | _strings.Part) else value


def _meaning(error: Exception) -> tuple[str, str, str]:
    match error:
        case Fault():
            return error.what, error.hint, error.code
        case ZeroDivisionError():
            return "division by zero", "test the divisor with IF before", ""
        case OverflowError():
            return "the value is out of the range of its type", "INTEGER has 32 bits, REAL reaches 3.4E38", ""
        case TypeError() if "subscript" in str(error) or "item assignment" in str(error):
            return (
                "INVALID VARIABLE: the field is not dimensioned",
                "write DIM before the first use of the field",
                "",
            )
        case TypeError():
            fault = _numbers.not_assigned()
            return fault.what, fault.hint, fault.code
        case _:
            return (
                INVALID_PARAMETER.what,
                "the function has no value there; test its argument with IF before",
                "",
            )


def _cell() -> Any:
    return array("f", (0.0,))


def _parameter(arguments: Arguments, name: str, kind: Kind) -> object:
    place = int(name.rstrip("".join(SUFFIXES))[1:])
    value = arguments.values[place - 1] if 0 < place <= len(arguments.values) else None
    if value is None or isinstance(value, str) != (kind == "S"):
        return None
    if isinstance(value, str):
        return value if arguments.linked else _strings.Unlinked(value)
    if kind == "B":
        return _numbers.to_boolean(value)
    if kind == "I":
        whole = isinstance(value, float) and value.is_integer()
        return _numbers.to_integer(int(value) if whole and isinstance(value, float) else value)
    return (_numbers.to_real if kind == "R" else _numbers.to_double)(value)


def _parameter_field(arguments: Arguments, name: str, size: int) -> object:
    place = int(name.rstrip("$")[1:])
    field = _strings.CharacterField(size)
    value = arguments.values[place - 1] if 0 < place <= len(arguments.values) else None
    if isinstance(value, str):
        if len(value) > size:
            raise Fault(
                INVALID_VARIABLE._replace(what="invalid variable"), f"PDIM {name}({len(value)}) is needed"
            )
        field.assign(value)
    return field


def _handed(name: str, kind: Kind, value: object) -> object:
    """Return a variable as a function sets it: one with room of its own as it is, another one in a box."""
    return value if isinstance(value, _strings.CharacterField | Field) else Box(name, kind, value)


def _kept(value: object) -> object:
    if value is None:
        raise Fault("INVALID ASSIGNMENT", "a permanent variable cannot be deleted: the value is NUL")
    return value


def _as_word(value: object) -> float:
    if value is None:
        raise _numbers.not_assigned()
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise Fault("INVALID ASSIGNMENT", "an address takes a number")
    return float(value)


def _inserted(host: Host, value: object, column: int) -> tuple[BlockWord, ...]:
    if value is None:
        raise _numbers.not_assigned()
    return tuple(BlockWord(*word, column) for word in host.insert(value))


def _ic_condition(
    state: object, negated: bool, function: Callable[..., object], *arguments: object
) -> Callable[[], bool]:
    wanted = bool(state) != negated
    return lambda: function(*arguments) == wanted


def _assigned(value: object) -> object:
    if value is None:
        raise _numbers.not_assigned()
    return value


def _duration(value: object) -> int:
    milliseconds = _numbers.to_integer(_assigned(value))
    assert milliseconds is not None
    if milliseconds < 0:
        raise Fault(INVALID_PARAMETER, f"WAIT takes 0 ms or more, not {milliseconds}")
    return milliseconds


_SCOPE: dict[str, object] = {
    "OMITTED": OMITTED, "PAUSE": PAUSE, "Box": Box, "handed": _handed, "Item": Item, "BlockWord": BlockWord,
    "Lines": Lines, "NcValues": NcValues, "Step": Step, "SubProgram": SubProgram, "Waiting": Waiting,
    "wait_for": wait_for, **OWN, "OverflowError": OverflowError, "cell": _cell, "single": _numbers.single_rounder(),
    "to_integer": _numbers.to_integer, "to_real": _numbers.to_real, "to_double": _numbers.to_double,
    "to_boolean": _numbers.to_boolean, "text_of": _strings.text_of, "put": _strings.put,
    "put_new": _strings.put_new, "put_part": _strings.put_part, "dimension": _strings.dimension,
    "dimension_field": dimension_field, "Field": Field, "index_needed": index_needed,
    "section": _strings.section, "added": _strings.added,
    "parameter": _parameter, "parameter_field": _parameter_field, "kept": _kept, "assigned": _assigned,
    "duration": _duration, "as_word": _as_word, "inserted": _inserted, "ic_condition": _ic_condition,
}  # fmt: skip
"""What a running program knows of Python."""
