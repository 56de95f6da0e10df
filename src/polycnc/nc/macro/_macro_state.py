"""Where a macro language and its programs stand, as values to go back to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from polycnc.nc.macro._calls import Arguments
from polycnc.nc.macro._variables import SavedVariables, Value
from polycnc.nc.records._block_records import Call
from polycnc.nc.text._program import ProgramText


@dataclass(frozen=True, slots=True)
class ModalCall:
    """A call after every move: program, repetitions and arguments; `each` in place of every block (G66.1)."""

    program: int
    repeats: int
    values: Mapping[int, Value]
    each: bool = False


class SavedItems(NamedTuple):
    """What a block or a span has still to give: see `LineItems`; `span` is its number, next offset and next line."""

    letters: tuple[tuple[str, float], ...]
    line: int
    offset: int
    stage: str
    span: tuple[int, int, int] | None


class SavedSource(NamedTuple):
    """One execution of one program, which begins at `offset` of `text`, or was begun at byte `start`.

    `errors` are still to be reported. `place` is the line of its Python at which it stands, 0 before the first and None
    after the last, with its `names`. `level` is that of its local variables.
    """

    text: ProgramText
    offset: int
    line: int
    plain: bool
    start: int | None
    errors: int
    pauses: int
    arguments: Arguments | None
    level: int
    outer_modals: tuple[ModalCall, ...]
    outer_interrupt: int | None
    outer_number: int
    closed: bool
    main: bool
    place: int | None
    names: dict[str, Value]
    items: SavedItems | None


class SavedSystem(NamedTuple):
    """What the control's own variables hold by themselves."""

    stored: dict[int, Value]
    timers: dict[int, tuple[float, float]]
    modal_call: bool
    program_number: int
    sequence_number: int


class SavedLanguage(NamedTuple):
    """What a macro language holds, and its programs under way, the main one first."""

    variables: SavedVariables
    system: SavedSystem
    modals: tuple[ModalCall, ...]
    interrupt_program: int | None
    interrupt: bool
    pending: int | None
    codes_off: int
    output: tuple[bool, int]
    levels: tuple[tuple[tuple[Call, ...], int, tuple[Value, ...]], ...]
    under_way: tuple[tuple[Arguments | None, SavedSource | None], ...]


MACRO_CLASSES: Sequence[type] = (
    Arguments, ModalCall, SavedItems, SavedLanguage, SavedSource, SavedSystem, SavedVariables,
)  # fmt: skip
"""The classes of which the state of a macro language is made."""
