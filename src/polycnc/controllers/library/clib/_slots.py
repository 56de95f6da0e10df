"""Arguments as bytes: which way they go, how wide they are, how much lies behind a pointer."""

from __future__ import annotations

import ctypes
import hashlib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from typing import Any

from polycnc.controllers.library._c_types import Bytes, Opaque, Pointer, Text
from polycnc.controllers.library._functions import Argument, Direction, Function
from polycnc.controllers.library._header import Header
from polycnc.controllers.library._structures import Element, layouts, repacked
from polycnc.controllers.library.clib._packing import Selected


class Way(Enum):
    """How an argument travels."""

    VALUE = "value"  # a number, by value
    NUMBERS = "numbers"  # a pointer to one number or to several
    TEXT = "text"  # a pointer to characters that end in a zero
    MEMORY = "memory"  # a pointer to bytes
    RECORD = "record"  # a pointer to one structure
    RECORDS = "records"  # a pointer to several


@dataclass(frozen=True, slots=True)
class Slot:
    """An argument as bytes.

    `element` is the type of ctypes of a number or a structure; `size` and `room` say in C how many bytes are read and
    how many may be written. What a pointer in a structure leads to is a slot of its own: `holder` is the argument, and
    `member` the pointer.
    """

    argument: Argument
    way: Way
    element: Any
    size: str = ""
    room: str = ""
    holder: str = ""
    member: str = ""

    reads: bool = field(init=False)
    """Whether what lies there goes in."""
    writes: bool = field(init=False)
    """Whether something is written there."""
    width: int = field(init=False)
    """Bytes of an element."""

    def __post_init__(self) -> None:
        value, direction = self.way is Way.VALUE, self.argument.direction
        object.__setattr__(self, "reads", value or direction is not Direction.OUT)
        object.__setattr__(self, "writes", not value and direction is not Direction.IN)
        object.__setattr__(self, "width", ctypes.sizeof(self.element))

    @property
    def is_extended(self) -> bool:
        """Whether the structure is longer than that of the table, see `CLibrary.extensions`."""
        ctype = getattr(self.argument.type, "ctype", None)
        return self.way is Way.RECORD and ctype is not None and ctype.__name__ != self.element.__name__

    @property
    def row(self) -> str:
        """Everything that both sides have to agree on, as a line."""
        ways = f"{'r' if self.reads else ''}{'w' if self.writes else ''}"
        return f"{self.argument.name} {self.way.value} {ways} {self.width} {self.size} {self.room}"


@dataclass(frozen=True, slots=True)
class Call:
    """A function with its number on the wire."""

    number: int
    function: Function
    slots: tuple[Slot, ...]


@dataclass(frozen=True)
class CLibrary:
    """What C needs beyond the table of functions.

    Args:
        name: The library's name, without `lib` and ending.
        kind: The kind of controller that answers it.
        functions: The table of functions.
        header: The structures.
        constants: What programs call numbers.
        nobody: The code of a call when no machine is there.
        lost: The code when a connection is lost.
        null: The code for a null pointer, and for what is too large.
        handle: The code for a handle that is none.
        version: The code when the other side has another table.
        failed: The code of what should never happen.
        through: The argument that is a handle, "" if the library has none on the wire.
        opens: Functions that connect anew when the connection was lost.
        opens_at: The function that connects to an address, its first arguments.
        frees: The function that lets a handle go.
        stdcall: Whether 32-bit Windows programs clean no stack.
        basic: Whether its maker has a module for Visual Basic.
        declarations: C types that prototypes use, after the structures.
        helpers: C functions that extents use.
        in_bytes: Whether a length counts bytes; else elements.
        extents: By function and argument: how many bytes lie behind a pointer, in C.
        aliases: Other names of functions.
        left_out: By function, why it does nothing.
        interrupts: The functions that install the program's routine for interrupts, and remove it.
        extensions: By function, a structure that begins with the record of its argument and goes on with what that has
            no place for; it is passed in the record's place.
        is_extended: Whether it is, in C, of the argument; else the function does nothing.
        packing: To how many bytes the program packs structures, 0: each as the manual has it.
        packings: The packings that programs of this library have besides.
        selected: Which member of a union holds.
        failures: By function, what it answers where `null` or `lost` would mean success, or where it is left out.
    """

    name: str
    kind: str
    functions: Mapping[str, Function]
    header: Header
    constants: Mapping[str, int]
    nobody: int
    lost: int
    null: int
    handle: int
    version: int
    failed: int
    through: str = ""
    opens: frozenset[str] = frozenset()
    opens_at: str = ""
    frees: str = ""
    stdcall: bool = True
    basic: bool = False
    declarations: str = ""
    helpers: str = ""
    in_bytes: bool = True
    extents: Mapping[tuple[str, str], str] = field(default_factory=dict)
    aliases: Mapping[str, str] = field(default_factory=dict)
    left_out: Mapping[str, str] = field(default_factory=dict)
    interrupts: tuple[str, ...] = ()
    extensions: Mapping[str, Any] = field(default_factory=dict)
    is_extended: str = ""
    packing: int = 0
    packings: frozenset[int] = frozenset()
    selected: Selected = field(default_factory=dict)
    failures: Mapping[str, int] = field(default_factory=dict)

    @cached_property
    def calls(self) -> tuple[Call, ...]:
        """All functions, by name in the order of their numbers."""
        return tuple(
            Call(number, each, tuple(_slots(self, each)))
            for number, (_, each) in enumerate(sorted(self.functions.items()), 1)
            if each.name not in self.left_out
        )

    @cached_property
    def classes(self) -> Mapping[str, Any]:
        """The structures by name, as the program packs them."""
        classes = self.header.classes | {each.__name__: each for each in self.extensions.values()}
        return (
            {name: repacked(cls, self.packing) for name, cls in classes.items()} if self.packing else classes
        )

    @cached_property
    def _packed(self) -> dict[int, CLibrary]:
        return {0: self} | {each: replace(self, packing=each, packings=frozenset()) for each in self.packings}

    def packed(self, packing: int) -> CLibrary | None:
        """Return the library of programs that pack structures to so many bytes, None if there is none."""
        return self._packed.get(packing)

    def prepare(self) -> None:
        """Work out now what else the first client would wait for."""
        _ = self.by_number, self.table_hash

    @cached_property
    def by_number(self) -> Mapping[int, Call]:
        """All functions by their numbers."""
        return {each.number: each for each in self.calls}

    @cached_property
    def table_hash(self) -> bytes:
        """16 bytes that differ when anything does that both sides have to agree on."""
        rows = [
            f"{each.number} {each.function.prototype} " + ", ".join(slot.row for slot in each.slots)
            for each in self.calls
        ]
        rows += [f"{name} {each}" for name, each in layouts(*self.classes.values()).items()]
        return hashlib.sha256("\n".join(rows).encode()).digest()[:16]


def _slots(library: CLibrary, function: Function) -> Iterator[Slot]:
    for argument in function.arguments:
        slot = _slot(library, function, argument)
        held = {name: each for name, each in _elements(slot).items() if each.held}
        if not held:
            yield slot
            continue
        only_read = replace(argument, direction=Direction.IN)
        yield replace(slot, argument=only_read)
        way = Direction.IN if argument.direction is Direction.IN else Direction.OUT
        for name, each in held.items():
            behind = replace(argument, name=f"{argument.name}_{name}", direction=way, passed=False)
            said = library.extents.get((function.name, behind.name))
            size = f"pc_size({said or f'{argument.name} ? {argument.name}->{each.counted_by} : 0'})"
            yield Slot(behind, Way.MEMORY, ctypes.c_char, size, size, argument.name, name)


def _elements(slot: Slot) -> Mapping[str, Element]:
    return slot.element._table_.elements if slot.way is Way.RECORD else {}


def _slot(library: CLibrary, function: Function, argument: Argument) -> Slot:
    way, element = slot_of(library, argument)
    if way is Way.VALUE:
        return Slot(argument, way, element)
    if function.name in library.extensions and way is Way.RECORD:
        element = library.extensions[function.name]
    said = library.extents.get((function.name, argument.name))
    if said is None:
        said = _extent(library, function, argument, way, element)
    size = f"pc_size({said})"
    if way is Way.RECORD and _counter(function, argument) and argument.direction is Direction.IN:
        size = f"pc_least({said}, sizeof({element.__name__}))"
    if way is Way.TEXT and argument.direction is not Direction.OUT:
        size = f"pc_text({argument.name})"
    return Slot(argument, way, element, size, f"pc_size({said})")


def slot_of(library: CLibrary, argument: Argument) -> tuple[Way, Any]:
    """Return how an argument travels, and what its elements are; a number travels in a routine's place."""
    kind = argument.type
    star = argument.c.rstrip().endswith("*")
    match kind:
        case Text():
            return Way.TEXT, ctypes.c_char
        case Bytes():
            return Way.MEMORY, library.classes.get(argument.c.rstrip(" *"), ctypes.c_char)
        case Pointer(of=of) if of is callable:
            return Way.VALUE, ctypes.c_int32
        case Pointer(ctype=None, of=of):
            return (Way.NUMBERS, ctypes.c_int16) if of is int else (Way.RECORDS, _as_packed(library, of))
        case Pointer(ctype=ctype):
            return Way.RECORD, _as_packed(library, ctype)
    assert kind is not None
    by_value = argument.passed and argument.direction is Direction.IN and not star
    if isinstance(kind, Opaque):
        return (Way.VALUE if by_value else Way.NUMBERS), ctypes.c_uint32
    return (Way.VALUE if by_value else Way.NUMBERS), kind.ctype


def _as_packed(library: CLibrary, cls: Any) -> Any:
    return repacked(cls, library.packing) if library.packing else cls


def _counter(function: Function, argument: Argument) -> Argument | None:
    return next((each for each in function.arguments if each.length_of == argument.name), None)


def _extent(library: CLibrary, function: Function, argument: Argument, way: Way, element: Any) -> str:
    """Return in C how many bytes lie behind a pointer.

    Raises:
        TypeError: Nothing says it.
    """
    one = f"sizeof({element.__name__})" if hasattr(element, "_fields_") else str(ctypes.sizeof(element))
    counter = _counter(function, argument)
    if counter is not None:
        many = _number(counter)
        return many if library.in_bytes or one == "1" else f"(int64_t){many} * (int64_t){one}"
    if argument.many:
        return f"(int64_t)({_in_c(library, function, argument.many)}) * (int64_t){one}"
    if way in (Way.TEXT, Way.MEMORY) and argument.direction is Direction.IN and way is Way.TEXT:
        return "0"
    if way in (Way.TEXT, Way.MEMORY, Way.RECORDS):
        raise TypeError(f"{function.name}: how much lies behind {argument.name}?")
    return one


def _number(argument: Argument) -> str:
    """Return the value of a number in C, also behind a pointer, which may be null."""
    pointer = argument.c.rstrip().endswith("*")
    return f"({argument.name} ? *{argument.name} : 0)" if pointer else argument.name


def _in_c(library: CLibrary, function: Function, text: str) -> str:
    """Return an expression with the values of constants and arguments in place of their names."""
    values = {each.name: _number(each) for each in function.arguments}

    def value(found: re.Match[str]) -> str:
        name = found[0]
        if name in library.header.constants:
            return str(library.header.constants[name])
        return values[name]

    try:
        return re.sub(r"[A-Za-z_]\w*", value, text)
    except KeyError as error:
        raise TypeError(f"{function.name}: what is {error.args[0]} in {text}?") from None
