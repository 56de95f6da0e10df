"""Turn a program into the numbers that the compiled scan runs (`core._turns`).

An instruction that acts on the board, or is none that the compiler writes, becomes one that is left to Python.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeAlias

import numpy as np

from polycnc.controllers.apci.core import _turn_state as ts
from polycnc.controllers.apci.core import _turn_values as tv
from polycnc.controllers.apci.core._turn_state import BOOLEAN, DOUBLE, INTEGER
from polycnc.controllers.apci.sap import _commands
from polycnc.controllers.apci.sap._arithmetic import wrap
from polycnc.controllers.apci.sap._host import Host
from polycnc.controllers.apci.sap._program import Cells, Program
from polycnc.errors import PolycncError

KIND_OF: dict[type, int] = {int: INTEGER, float: DOUBLE, bool: BOOLEAN}
_KIND_OF_LETTER = {"i": INTEGER, "d": DOUBLE, "b": BOOLEAN}

ILLEGAL = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError, struct.error)
"""What forged instructions raise: a program file may hold any."""

_OF_ONE = (
    *(
        "negi",
        "negd",
        "noti",
        "notb",
        "double",
        "absi",
        "absd",
        "sqri",
        "sqrd",
        "sqrt",
        "trunc",
        "round",
        "odd",
    ),
    *("sin", "cos", "tan", "arctan", "ln", "exp"),
)
_ONE = dict(zip(_OF_ONE, range(19), strict=True))
_WHOLE = ("addi", "subi", "muli", "divi", "modi", "andi", "ori", "xori", "shli", "shri")
_OTHERS = ("addd", "subd", "muld", "slashd", "lt", "le", "gt", "ge", "eq", "ne")
_TWO = dict(
    zip(_WHOLE + _OTHERS, range(20), strict=True)
)  # in the order of the numbers of `core._turn_state`
_LIVE = {
    "axst": tv.STATUS,
    "digi": tv.SIGNALS,
    "digo": tv.OUTPUTS,
    "rp": tv.ACTUAL,
    "dp": tv.SETPOINT,
    "rv": tv.ACTUAL_VELOCITY,
    "dv": tv.VELOCITY,
    "tp": tv.TARGET,
    "lpndx": tv.AT_INDEX,
    "jovr": tv.JOG_OVERRIDE,
    "lsm": tv.FREE,
    "MCiS": tv.MOVES,
    "PcapIndex": tv.POINT,
    "PosErr": tv.DIFFERENCE,
}
"""Qualifiers that a scan can change, other than those that are left to Python."""

_LEFT_TO_PYTHON = frozenset(
    {"lp", "mcp"}
)  # the one is taken by reading, the other computed from several values

Row: TypeAlias = tuple[int, int, int, int, int, int, float]
"""Operation, cells it takes, kind of its result, three arguments, a number."""


class BoardHost(Host, Protocol):
    """What a board gives beside what any host of tasks does."""

    def velocity_unit_s(self, axis: int) -> float:
        """Return by what velocities of an axis are multiplied for programs."""

    def alarms(self, axis: int) -> int:
        """Return the bits of digi that no scan changes."""

    def system_field(self, name: str) -> Sequence[float]:
        """Return a field of system variables."""

    def axis_field(self, axis: int, name: str) -> Sequence[float]:
        """Return a field of variables of an axis."""


@dataclass(frozen=True, slots=True)
class Slot:
    """Values that only Python changes: where they stand, how many they are, and what gives them."""

    first: int
    count: int
    read: Callable[[], float | Sequence[float]]


@dataclass
class Translation:
    """A program as numbers; places of routines and slots count from those of the program."""

    rows: list[Row] = field(default_factory=list)
    routines: list[tuple[int, int, int, int]] = field(default_factory=list)
    cells: list[int] = field(default_factory=list)
    conditions: list[int] = field(default_factory=list)
    slots: list[Slot] = field(default_factory=list)
    slot_count: int = 1  # slot 0 is 0
    waits: list[tuple[int, ...]] = field(default_factory=list)  # lists of axes, by number
    reads_buffer: bool = False


def translate(program: Program, host: BoardHost) -> Translation:
    """Return a program as numbers, for a board."""
    translator = _Translator(program, host)
    made = translator.made
    for entry in program.routines:
        kinds = _kinds(entry.cells)
        made.routines.append((entry.start, entry.parameters, len(made.cells), len(kinds)))
        made.cells.extend(kinds)
    for operation, argument, _ in program.code:
        try:
            row = translator.row(operation, argument)
            np.array(row[:-1], np.int64)
        except (*ILLEGAL, PolycncError):
            row = _REFUSED
        made.rows.append(row)
    made.conditions = [condition for condition, _ in program.events]
    return made


def _kinds(cells: Cells) -> list[int]:
    return [_KIND_OF_LETTER[letter] for letter, count in cells for _ in range(count)]


def _row(
    operation: int, takes: int = 0, kind: int = 0, x: int = 0, y: int = 0, z: int = 0, number: float = 0.0
) -> Row:
    return operation, takes, kind, x, y, z, number


_REFUSED = _row(ts.REFUSED)


class _Translator:
    def __init__(self, program: Program, host: BoardHost) -> None:
        self.made = Translation()
        self._program = program
        self._memory = sum(count for _, count in program.variables)
        self._host = host

    def row(self, operation: str, argument: Any) -> Row:
        """Return one instruction; raises one of `ILLEGAL` for a forged one."""
        if operation in _ONE:
            return _row(ts.OF_ONE, 1, x=_ONE[operation])
        if operation in _TWO:
            return _row(ts.OF_TWO, 2, x=_TWO[operation])
        one = _ROWS.get(operation)
        return _REFUSED if one is None else one(self, argument)

    def constant(self, value: Any) -> Row:
        kind = KIND_OF[type(value)]
        if kind == INTEGER and wrap(value) != value:
            return _REFUSED
        return _row(ts.CONSTANT, kind=kind, number=float(value))

    def cell(self, operation: int, local: int, cell: int, takes: int) -> Row:
        if cell < 0 or (not local and cell >= self._memory):
            return _REFUSED
        return _row(operation, takes, x=local, y=cell)

    def element(self, operation: int, local: int, argument: Any, takes: int) -> Row:
        cell, first, last = argument
        count = last - first + 1
        if cell < 0 or count < 1 or (not local and cell + count > self._memory):
            return _REFUSED
        return _row(operation, takes, x=local, y=cell, z=first, number=float(count))

    def within(self, argument: Any) -> Row:
        first, last, target = argument
        return _row(ts.WITHIN, 1, x=target, y=first, z=last)

    def axis(self, argument: Any) -> Row:
        letters, name, kind, indexed = argument
        i = self._host.axis_index(letters)
        if i is None or name in _LEFT_TO_PYTHON:
            return _REFUSED
        result = _KIND_OF_LETTER[kind]
        if indexed:
            return self._slots(
                len(self._host.axis_field(i, name)), lambda: self._host.axis_field(i, name), result
            )
        if name not in _LIVE:
            return self._slot(lambda: self._host.read_axis(i, name, None), result)
        alarms = 0
        if name == "digi":
            alarms = self._slot(lambda: float(self._host.alarms(i)), DOUBLE)[3]
        unit = self._host.velocity_unit_s(i)
        return _row(ts.AXIS, kind=result, x=_LIVE[name], y=i, z=alarms, number=unit)

    def system(self, argument: Any) -> Row:
        name, letter, index, indexed = argument
        kind = _KIND_OF_LETTER[letter]
        if name in ("ci", "cd"):
            return self._common(ts.COMMON, argument, 0)
        if name == "errorreg":
            return _row(ts.AXIS, kind=kind, x=tv.ERRORS)
        if indexed:
            return self._slots(
                len(self._host.system_field(name)), lambda: self._host.system_field(name), kind
            )
        return self._slot(lambda: self._host.read_system(name, index), kind)

    def set_system(self, argument: Any) -> Row:
        return self._common(ts.SET_COMMON, argument, 1) if argument[0] in ("ci", "cd") else _REFUSED

    def _common(self, operation: int, argument: Any, takes: int) -> Row:
        name, _, index, indexed = argument
        if not indexed and not 0 <= index < _commands.COMMON_COUNT:
            return _REFUSED
        which = int(name == "cd")
        return _row(operation, takes + bool(indexed), which, x=which, y=-1 if indexed else index)

    def _slot(self, read: Callable[[], float], kind: int) -> Row:
        def converted() -> float:
            return float(wrap(int(read()))) if kind == INTEGER else float(read())

        converted()
        return _row(ts.SLOT, kind=kind, x=self._place(1, converted))

    def _slots(self, count: int, read: Callable[[], Sequence[float]], kind: int) -> Row:
        return _row(ts.SLOT, 1, kind=kind, x=self._place(count, read), z=count)

    def _place(self, count: int, read: Callable[[], float | Sequence[float]]) -> int:
        first = self.made.slot_count
        self.made.slots.append(Slot(first, count, read))
        self.made.slot_count += count
        return first

    def buffer(self, letter: str) -> Row:
        form, kind = _commands.BUFFER_LETTERS[letter]
        self.made.reads_buffer = True
        return _row(ts.BUFFER, 1, _KIND_OF_LETTER[kind], x="bid".index(letter), y=struct.calcsize(form))

    def wait_axes(self, names: Sequence[str]) -> Row:
        found = [self._host.axis_index(name) for name in names]
        axes = tuple(i for i in found if i is not None)
        if not axes or len(axes) != len(names):
            return _REFUSED
        if axes not in self.made.waits:
            self.made.waits.append(axes)
        return _row(ts.WAIT_AXES, x=mask_of(axes), y=self.made.waits.index(axes))

    def call(self, routine: int) -> Row:
        return _row(ts.CALL, x=range(len(self._program.routines))[routine])


def mask_of(axes: Sequence[int]) -> int:
    """Return axes as bits by index."""
    return sum({1 << i for i in axes})


_ROWS: dict[str, Callable[[_Translator, Any], Row]] = {
    "const": _Translator.constant,
    "drop": lambda _, __: _row(ts.DROP, 1),
    "loadg": lambda one, cell: one.cell(ts.LOAD, 0, cell, 0),
    "storeg": lambda one, cell: one.cell(ts.STORE, 0, cell, 1),
    "loadl": lambda one, cell: one.cell(ts.LOAD, 1, cell, 0),
    "storel": lambda one, cell: one.cell(ts.STORE, 1, cell, 1),
    "loadxg": lambda one, argument: one.element(ts.LOAD_ELEMENT, 0, argument, 1),
    "storexg": lambda one, argument: one.element(ts.STORE_ELEMENT, 0, argument, 2),
    "loadxl": lambda one, argument: one.element(ts.LOAD_ELEMENT, 1, argument, 1),
    "storexl": lambda one, argument: one.element(ts.STORE_ELEMENT, 1, argument, 2),
    "jump": lambda _, target: _row(ts.JUMP, x=target),
    "jumpfalse": lambda _, target: _row(ts.JUMP_FALSE, 1, x=target),
    "unless": lambda _, target: _row(ts.DECIDE, 1, x=target, y=0),
    "when": lambda _, target: _row(ts.DECIDE, 1, x=target, y=1),
    "within": _Translator.within,
    "call": _Translator.call,
    "return": lambda _, result: _row(ts.RETURN, x=-1 if result is None else result),
    "endcondition": lambda _, __: _row(ts.END_CONDITION, 1),
    "axget": _Translator.axis,
    "sysget": _Translator.system,
    "sysput": _Translator.set_system,
    "rdcb": _Translator.buffer,
    "wait": lambda _, __: _row(ts.WAIT_TIME, 1, y=-1),
    "waitaxes": _Translator.wait_axes,
}
