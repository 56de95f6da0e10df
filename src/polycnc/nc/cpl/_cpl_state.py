"""Where CPL programs stand, as values to go back to: their places, their variables, and what they wait for."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, MutableMapping, Sequence
from typing import Any, NamedTuple

from polycnc.language import Traced
from polycnc.machine import SnapshotError
from polycnc.nc.cpl._code_calls import CodeWord
from polycnc.nc.cpl._faults import Fault
from polycnc.nc.cpl._fields import Field, check_sizes
from polycnc.nc.cpl._host import Box, SubProgram
from polycnc.nc.cpl._program import Program
from polycnc.nc.cpl._strings import LONGEST, CharacterField, Part, Unlinked
from polycnc.nc.cpl._variables import Kind
from polycnc.nc.text._program import ProgramText

_PLAIN = (bool, int, float, str, type(None))


class SavedCharacters(NamedTuple):
    """A character field."""

    size: int
    text: str | None


class SavedField(NamedTuple):
    """A field: its type, its sizes, and its elements in the order of their indices."""

    kind: str
    sizes: tuple[int, ...]
    elements: tuple[object, ...]


class Object(NamedTuple):
    """The field or character field of this number among the objects of a state."""

    number: int


class SavedPart(NamedTuple):
    """A place in the character field of a number."""

    number: int
    begin: int
    length: int


class SavedText(NamedTuple):
    """A text of a program that was not linked."""

    text: str


class SavedCalled(NamedTuple):
    """What a call hands to a sub-program."""

    values: tuple[object, ...]
    linked: bool
    modal: bool


class SavedProgram(NamedTuple):
    """One program that runs: where it stands, and what of its present statement is left to emit.

    `place` is the line of its Python, 0 before the first and None after the last. `wait` says since when (ms) it waits
    at a WAIT: None before that has begun, an empty tuple where it waits for nothing. `after` are the words of a block
    after which a modal call may come, `left` the first and the last line of plain blocks that are given one by one.
    """

    text: ProgramText
    file: str
    called: SavedCalled
    line: int
    place: int | None
    names: dict[str, object]
    statements: int
    wait: tuple[int | None, ...]
    answer: int | None
    behind: tuple[CodeWord, ...] | None
    left: tuple[int, int] | None


class SavedCpl(NamedTuple):
    """The state of a run of CPL: variables, fields, the modal call, and each program under way, the main one first."""

    objects: tuple[SavedCharacters | SavedField, ...]
    globals: dict[str, object]
    permanent: dict[str, object]
    modal: SubProgram | None
    under_way: tuple[tuple[SavedCalled | None, SavedProgram | None], ...]


class Standing(NamedTuple):
    """A program that is to stand where another one stood."""

    saved: SavedProgram
    program: Program
    called: tuple[object, ...]
    names: dict[str, object]
    traced: Traced[int] | None


CPL_CLASSES: Sequence[type] = (
    CodeWord, Object, SavedCalled, SavedCharacters, SavedCpl, SavedField, SavedPart, SavedProgram, SavedText,
    SubProgram,
)  # fmt: skip
"""The classes of which the state of a run of CPL is made."""


class Objects:
    """The fields of a state: each once, and named by its number; `made` makes them anew."""

    def __init__(self) -> None:
        self.saved: list[SavedCharacters | SavedField | None] = []
        self._numbers: dict[int, int] = {}
        self._alive: list[object] = []

    def plain(self, value: object) -> object:
        """Return the value of a variable as a value to keep.

        Raises:
            SnapshotError: It is none that a variable has.
        """
        if type(value) in _PLAIN:
            return value
        if isinstance(value, CharacterField | Field):
            return Object(self._number(value))
        if isinstance(value, Part):
            return SavedPart(self._number(value.field), value.begin, value.length)
        if isinstance(value, Unlinked):
            return SavedText(value.text)
        raise SnapshotError(
            "the CPL program is in the middle of a command that cannot be kept",
            hint="take the snapshot at another moment",
        )

    def _number(self, value: CharacterField | Field) -> int:
        found = self._numbers.get(id(value))
        if found is None:
            found = self._numbers[id(value)] = len(self.saved)
            self._alive.append(value)
            self.saved.append(None)
            self.saved[found] = (
                SavedCharacters(value.size, value.text)
                if isinstance(value, CharacterField)
                else SavedField(value.kind, value.sizes, tuple(map(self.plain, value.values())))
            )
        return found

    def all(self) -> tuple[SavedCharacters | SavedField, ...]:
        """Return all fields that were named."""
        return tuple(each for each in self.saved if each is not None)


class MadeObjects:
    """The fields of a state made anew."""

    def __init__(self, saved: Sequence[SavedCharacters | SavedField]) -> None:
        try:
            self._made = [_made(each) for each in saved]
        except (Fault, ValueError, KeyError) as error:
            raise damaged("a field of no size") from error
        for field, each in zip(self._made, saved, strict=True):
            if isinstance(field, Field) and isinstance(each, SavedField):
                if len(field) != len(each.elements):
                    raise damaged("a field of another size")
                field.update(zip(list(field), map(self.value, each.elements), strict=True))

    def value(self, plain: object) -> object:
        """Return the value of a variable.

        Raises:
            SnapshotError: It is none.
        """
        match plain:
            case Object(number):
                return self._field(number)
            case SavedPart(number, begin, length):
                field = self._field(number)
                if not isinstance(field, CharacterField):
                    raise damaged("a part of no text")
                return Part(field, begin, length)
            case SavedText(text):
                return Unlinked(text)
        if type(plain) not in _PLAIN:
            raise damaged("a variable of no type")
        return plain

    def values(self, plain: Mapping[str, object]) -> dict[str, object]:
        """Return variables by their names."""
        return {name: self.value(each) for name, each in plain.items()}

    def _field(self, number: int) -> CharacterField | Field:
        if not 0 <= number < len(self._made):
            raise damaged("a field is missing")
        return self._made[number]


def _made(saved: SavedCharacters | SavedField) -> CharacterField | Field:
    if isinstance(saved, SavedField):
        kinds: dict[str, Kind] = {"I": "I", "R": "R", "D": "D", "B": "B", "S": "S"}
        check_sizes(kinds[saved.kind], saved.sizes)
        return Field(kinds[saved.kind], saved.sizes)
    if not 0 <= saved.size <= LONGEST:
        raise ValueError(saved.size)
    field = CharacterField(saved.size)
    field.assign(saved.text)
    return field


def kept_names(names: Mapping[str, Any], objects: Objects) -> dict[str, object]:
    """Return the names of a program's Python that it goes on with: not those that its head sets again."""
    return {
        name: objects.plain(value)
        for name, value in names.items()
        if name not in _HEAD and not callable(value) and not isinstance(value, array | Box)
    }


_HEAD = frozenset({"G", "M", "host", "arguments"})


def restore_state(variables: MutableMapping[str, Any], values: Mapping[str, object]) -> None:
    """Let variables have these values."""
    for name in [name for name in variables if name not in values]:
        del variables[name]
    for name, value in values.items():
        variables[name] = value


def damaged(why: str) -> SnapshotError:
    """Return the error of a snapshot that is none."""
    return SnapshotError(f"the snapshot is damaged: {why}", hint="use another one")
