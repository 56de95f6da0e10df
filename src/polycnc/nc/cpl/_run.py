"""Run linked programs: the stack of running ones, their events, and run-time errors at their places."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Container
from dataclasses import dataclass
from typing import Any, NamedTuple, NoReturn

from polycnc.errors import PolycncError, ProgramError
from polycnc.language import Flaw, frame_of
from polycnc.nc.cpl import _numbers, _strings
from polycnc.nc.cpl._faults import CPL_IN_UNLINKED, INVALID_PARAMETER, INVALID_VARIABLE, Fault
from polycnc.nc.cpl._fields import dimension_field
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
    Step,
    SubProgram,
    Waiting,
    wait_for,
)
from polycnc.nc.cpl._program import NESTING, Linker, Program
from polycnc.nc.cpl._variables import SUFFIXES, Kind


class Arguments(NamedTuple):
    """What a program was called with, and whether its caller was linked."""

    values: tuple[object, ...] = ()
    linked: bool = True


@dataclass(slots=True)
class Level:
    """A running program: where it is, `line`, is known whenever it has yielded."""

    program: Program
    generator: Any
    linked: bool
    line: int = 0


class Run:
    """One run of a main program with its sub-programs; global variables live as long as it.

    Call `step` for the next thing that the control has to do; None is the end. A sub-program call is not handed out
    but entered (its program is on `stack` then), unless it is one that only the control knows.
    """

    def __init__(self, main: Program, linker: Linker, host: Host) -> None:
        self.globals: dict[str, Any] = {}
        self.stack: list[Level] = []
        self._host = host
        self._linker = linker
        self._answer: object = None
        self._enter(main, Arguments(linked=not main.marked_din))

    def step(self, answer: object = None) -> Event | None:
        """Return the next event; `answer` is that to the last one (WAIT: 0, 1 or 2).

        Raises:
            ProgramError: The program does what it must not; the run is over.
        """
        while self.stack:
            level = self.stack[-1]
            try:
                event: Event = level.generator.send(answer)
            except StopIteration:
                self.stack.pop()
                answer = None
                continue
            except PolycncError:
                self.stop()
                raise
            except (Fault, ArithmeticError, TypeError, ValueError) as error:
                self._explain(error)
            answer = None
            if isinstance(event, SubProgram):
                level.line = event.line
                self._call(event, level)
                continue
            if event is not PAUSE:
                level.line = event[0]  # type: ignore[index]
            return event
        return None

    def leave(self) -> bool:
        """End the program that runs now (M30, M17); tell whether another one goes on."""
        if self.stack:
            self.stack.pop().generator.close()
        return bool(self.stack)

    def stop(self) -> None:
        """End all programs."""
        while self.leave():
            pass

    def local_variables(self) -> dict[str, object]:
        """Return the local variables of the program that runs now, by name."""
        if not self.stack:
            return {}
        level = self.stack[-1]
        values = level.generator.gi_frame.f_locals
        local = (each for each in level.program.variables if each.scope in ("local", "parameter"))
        return {each.name: shown(values.get(each.python)) for each in local}

    def _enter(self, program: Program, arguments: Arguments) -> None:
        for error in undeclared(program, self._host.permanent):
            self.stop()
            raise error
        make = program.traced.load(_SCOPE)["program"]
        generator = make(self.globals, self._host.permanent, self._host, arguments)
        self.stack.append(Level(program, generator, arguments.linked))

    def _call(self, call: SubProgram, level: Level) -> None:
        source = level.program.source
        at = source.begin(call.line)
        at += len(source.line(call.line)) - len(source.line(call.line).lstrip())
        flaw: Flaw | None = None
        program = None
        try:
            program = self._linker.sub_program(call.address, call.name)
        except PolycncError:
            self.stop()
            raise
        if program is None:
            flaw = Flaw(at, f"there is no sub-program {call.name}", "write it into a file of this name")
        elif len(self.stack) > NESTING:
            flaw = Flaw(at, f"sub-programs are nested more than {NESTING} deep")
        elif any(running.program is program for running in self.stack):
            flaw = Flaw(at, f"{call.name} calls itself", "recursive calls are not possible")
        elif (call.unlinked or program.marked_din) and not program.is_plain:
            flaw = Flaw(
                at,
                CPL_IN_UNLINKED.what,
                f"take DIN from the call of {call.name} or from its first line",
            )
        if flaw is not None or program is None:
            self.stop()
            raise source.error(flaw or Flaw(at, "no program"))
        self._enter(program, Arguments(call.arguments, level.linked))

    def _explain(self, error: Exception) -> NoReturn:
        frame = frame_of(error, self._linker.traced)
        self.stop()
        if frame is None:
            raise error
        what, hint, code = _meaning(error)
        raise self._linker.source(frame.name).error(Flaw(frame.place, what, hint, code=code)) from error


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
        return value if arguments.linked else _Unlinked(value)
    if kind == "B":
        return _numbers.to_boolean(value)
    if kind == "I":
        whole = isinstance(value, float) and value.is_integer()
        return _numbers.to_integer(int(value) if whole and isinstance(value, float) else value)
    return (_numbers.to_real if kind == "R" else _numbers.to_double)(value)


class _Unlinked:
    """A text from a program that was not linked: only PDIM makes room for it."""

    def __init__(self, text: str) -> None:
        self.text = text


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


def _text_of(value: object) -> str | None:
    if isinstance(value, _Unlinked):
        raise Fault(
            INVALID_VARIABLE._replace(what="invalid variable"), "write PDIM before: the caller is not linked"
        )
    return _strings.text_of(value)


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


def _root(value: float) -> float:
    if value < 0:
        raise Fault(INVALID_PARAMETER, "SQRT takes no negative number")
    return float(value**0.5)


_SCOPE: dict[str, object] = {
    "OMITTED": OMITTED, "PAUSE": PAUSE, "Box": Box, "Item": Item, "BlockWord": BlockWord, "Lines": Lines,
    "NcValues": NcValues, "Step": Step, "SubProgram": SubProgram, "Waiting": Waiting, "wait_for": wait_for,
    "OverflowError": OverflowError, "abs": abs, "cell": _cell, "single": _numbers.single_rounder(),
    "to_integer": _numbers.to_integer, "to_real": _numbers.to_real, "to_double": _numbers.to_double,
    "to_boolean": _numbers.to_boolean, "sine": _numbers.sine, "cosine": _numbers.cosine,
    "tangent": _numbers.tangent, "arc_sine": _numbers.arc_sine, "arc_cosine": _numbers.arc_cosine,
    "arc_tangent": _numbers.arc_tangent, "root": _root, "whole": _numbers.whole, "nearest": _numbers.nearest,
    "to_bcd": _numbers.to_bcd, "from_bcd": _numbers.from_bcd, "text_of": _text_of, "put": _strings.put,
    "put_new": _strings.put_new, "put_part": _strings.put_part, "dimension": _strings.dimension,
    "dimension_field": dimension_field, "middle": _strings.middle, "trimmed": _strings.trimmed,
    "length": _strings.length, "position": _strings.position, "code": _strings.code,
    "character": _strings.character, "written": _strings.written, "number": _strings.number,
    "added": _strings.added, "parameter": _parameter, "parameter_field": _parameter_field, "kept": _kept,
    "as_word": _as_word, "inserted": _inserted, "ic_condition": _ic_condition,
}  # fmt: skip
"""What a running program knows of Python."""
