"""One call: bytes become arguments, the façade carries it out, its outputs become bytes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from itertools import count
from operator import attrgetter
from typing import Any, NamedTuple

from polycnc.controllers.library import Opaque, Session, repacked
from polycnc.controllers.library.clib import Call, CLibrary, Slot, Way, alike, copied, length_in
from polycnc.errors import UsageError
from polycnc.servers.calls._frames import CallError, Done, Given, Layout
from polycnc.servers.calls._quick import Quick, Take, quick_of

_MOST_HANDLES = 65536  # that a client has ever had
_CONTENT = attrgetter("content")


class _Taken(NamedTuple):
    """An argument that the façade is given: its place in the frame, its name, how its bytes become a value."""

    place: int
    name: str
    value: Callable[[Given], Any]


class _Put(NamedTuple):
    """An argument that is written: its place in the frame, how a value becomes its bytes."""

    place: int
    slot: Slot
    content: Callable[[Any], bytes]


@dataclass(slots=True)
class _Prepared:
    """A call as this client has it: what depends on the table alone is worked out once."""

    call: Call
    layout: Layout
    function: Callable[..., Any]
    null: int | float | None
    """The code of a null pointer."""
    taken: tuple[_Taken, ...]
    held: tuple[int, ...]
    """The places of what pointers in structures lead to."""
    put: tuple[_Put, ...]
    changed: bool
    """Whether records are written, of which some may be as before."""
    lengths: tuple[tuple[str, Any, Any], ...] = ()
    """Arguments that count the bytes of a structure that the program packs otherwise: name, its structure, ours."""


@dataclass(slots=True)
class Caller:
    """Carry out calls of one client, in its session of the façade.

    `ways` takes the place of functions that are different for a client elsewhere. From when it `listens` on, the client
    waits for the interrupts of a board: `push` sends it the bits of the lines.
    """

    library: CLibrary
    session: Session
    ways: dict[str, Callable[..., Any]] = field(default_factory=dict)
    listens: bool = False
    quick: dict[bytes, tuple[int, Quick]] = field(default_factory=dict)
    """Of calls that have been carried out and read through no pointer, by how their frames begin."""
    push: Callable[[int], None] = lambda _: None
    _handles: dict[int, Any] = field(default_factory=dict)
    _prepared: dict[int, _Prepared] = field(default_factory=dict)

    def carry_out(self, number: int, packed: bytes) -> tuple[Layout, Done]:
        """Carry out a call.

        Raises:
            CallError: There is no such call, or its arguments are not those of the table; nothing is carried out.
        """
        prepared = self._prepared.get(number) or self._prepare(number)
        return prepared.layout, self._done(prepared, prepared.layout.unpacked(packed))

    def carry_out_given(self, call: Call, given: list[Given]) -> Done:
        """Carry out a call whose arguments are there."""
        return self._done(self._prepared.get(call.number) or self._prepare(call.number), given)

    def _prepare(self, number: int) -> _Prepared:
        call = self.library.by_number.get(number)
        if call is None:
            raise CallError(f"there is no call {number}")
        name, slots = call.function.name, tuple(enumerate(call.slots))
        made = self._prepared[number] = _Prepared(
            call,
            Layout(call),
            self.ways.get(name) or getattr(self.session, name),
            self._null(call),
            tuple(
                _Taken(k, each.argument.name, self._taker(each)) for k, each in slots if each.argument.passed
            ),
            tuple(k for k, each in slots if each.holder),
            tuple(_Put(k, each, self._putter(each)) for k, each in slots if each.writes),
            any(each.way is Way.RECORDS for each in call.slots),
        )
        made.lengths = tuple(self._lengths(call))
        self._quicken(made)
        return made

    def _lengths(self, call: Call) -> Iterator[tuple[str, Any, Any]]:
        for slot in call.slots:
            if (cls := self._other(slot)) is not None and slot.way is Way.RECORD:
                for each in call.function.arguments:
                    if each.length_of == slot.argument.name:
                        yield each.name, slot.element, cls

    def _other(self, slot: Slot) -> Any:
        """Return the structure as the façade has it where the program packs it otherwise, None where both are alike."""
        if not self.library.packing or not hasattr(slot.element, "_table_"):
            return None
        cls = slot.element.variant_of
        return None if alike(slot.element, cls) else cls

    def _quicken(self, prepared: _Prepared) -> None:
        """Have the call answered without an object for each argument from now on, unless something is read."""
        slots = prepared.call.slots
        if any(each.way is not Way.VALUE and each.reads for each in slots):
            return
        if prepared.held or prepared.changed or prepared.lengths:
            return
        takes = [self._made(each, k) for k, each in enumerate(slots) if each.argument.passed]
        if any(not put.slot.argument.returned and put.slot.way is not Way.RECORD for put in prepared.put):
            return
        filled = {k: number for number, (k, _) in enumerate(takes)}
        results = count(0 if prepared.call.function.result == "void" else 1)
        puts = [
            (place, True, next(results), put)
            if slot.argument.returned
            else (place, False, filled[place], put)
            for place, slot, put in prepared.put
        ]
        name = prepared.call.function.name
        way = self.ways.get(name)
        carry_out = partial(self.session.packed_calls[name], self.session) if way is None else _of_list(way)
        begin, size, quick = quick_of(prepared.call, carry_out, self.session, prepared.null, takes, puts)
        self.quick[begin] = size, quick

    def _made(self, slot: Slot, place: int) -> Take:
        """Return where an argument is, and what makes of it what the façade is given; None of the number itself."""
        if not slot.reads:
            element = slot.element
            return place, (lambda _: element()) if slot.way is Way.RECORD else (lambda _: None)
        handles = self._handles
        return place, (lambda number: handles.get(number, number)) if isinstance(
            slot.argument.type, Opaque
        ) else None

    def _done(self, prepared: _Prepared, given: list[Given]) -> Done:
        name = prepared.call.function.name
        for put in prepared.put:
            if given[put.place].room is None and not put.slot.holder:
                return Done(name, prepared.null, [], True)
        values = {each.name: each.value(given[each.place]) for each in prepared.taken}
        for place in prepared.held:
            _hold(values, given[place])
        for counter, packed, cls in prepared.lengths:
            values[counter] = length_in(packed, cls, values[counter])
        self.session.refused = False
        try:
            answer = prepared.function(*values.values())
        except UsageError:
            return Done(name, prepared.null, [], True)
        results = list(answer) if isinstance(answer, tuple) else [answer]
        code = None if prepared.call.function.result == "void" else results.pop(0)
        if self.session.refused:
            return Done(name, code, [], True)
        return Done(name, code, list(_outputs(prepared, given, values, results)))

    def _null(self, call: Call) -> int | float | None:
        """Return the code of a call with a null pointer."""
        if call.function.result == "void":
            return None
        if call.function.coded:
            return self.library.failures.get(call.function.name, self.library.null)
        zero: int | float = call.function.zero()
        return zero

    def _taker(self, slot: Slot) -> Callable[[Given], Any]:
        """Return what makes of an argument's bytes what the façade is given; None of a null pointer."""
        if not slot.reads:
            if slot.way is Way.RECORD:
                return lambda given: slot.element()
            if slot.way is Way.RECORDS:
                return lambda given: _records(slot, bytes(given.room or 0))
            return lambda given: None
        if slot.way is Way.VALUE and not isinstance(slot.argument.type, Opaque):
            return _CONTENT
        read = self._reader(slot)
        return lambda given: None if given.content is None else read(given.content)

    def _reader(self, slot: Slot) -> Callable[[Any], Any]:
        match slot.way:
            case Way.VALUE:  # a handle
                return lambda content: self._handles.get(content, content)
            case Way.NUMBERS if isinstance(slot.argument.type, Opaque):
                return lambda content: self._handles.get(number := _first(slot, content), number)
            case Way.NUMBERS if getattr(slot.argument.type, "of", None) is int:
                return lambda content: _numbers(slot, content)
            case Way.NUMBERS:
                return lambda content: _first(slot, content)
            case Way.TEXT:
                return lambda content: content.split(b"\0", 1)[0].decode("latin-1")
            case Way.MEMORY:
                return self._from_packed(slot)
            case Way.RECORD if slot.is_extended:
                return lambda content: _inner(slot, content)
            case Way.RECORD if (cls := self._other(slot)) is not None:
                return lambda content: copied(
                    slot.element.from_buffer_copy(content[: slot.width].ljust(slot.width, b"\0")),
                    cls,
                    self.library.selected,
                )
            case Way.RECORD:
                width, made = slot.width, slot.element.from_buffer_copy
                return lambda content: made(content[:width].ljust(width, b"\0"))
        return lambda content: _records(slot, content)

    def _putter(self, slot: Slot) -> Callable[[Any], bytes]:
        """Return what makes of an output what lies in the program's memory."""
        match slot.way:
            case Way.NUMBERS if isinstance(slot.argument.type, Opaque):
                return lambda value: bytes(slot.element(self._number(value)))
            case Way.NUMBERS:
                return lambda value: b"".join(
                    bytes(slot.element(each))
                    for each in (value if isinstance(value, (list, tuple)) else (value,))
                )
            case Way.TEXT:
                return lambda value: str(value).encode("latin-1", "replace") + b"\0"
            case Way.RECORDS:
                return lambda value: b"".join(bytes(each) for each in value)
            case Way.RECORD if slot.is_extended:
                return lambda value: bytes(_outer(slot, value))
            case Way.RECORD if self._other(slot) is not None:
                return self._to_packed
        return bytes

    def _to_packed(self, value: Any) -> bytes:
        """Return a structure of the façade as the program packs it; it may be a variant of the table's."""
        kind: Any = type(value)
        cls = repacked(kind, self.library.packing)
        return bytes(copied(value, cls, self.library.selected))

    def _from_packed(self, slot: Slot) -> Callable[[Any], Any]:
        """Return what makes memory of the façade of memory of the program."""
        cls = self._other(slot)
        if cls is None:
            return lambda content: content
        selected = self.library.selected
        return lambda content: b"".join(
            bytes(copied(each, cls, selected)) for each in _records(slot, content)
        )

    def _number(self, handle: Any) -> int:
        """Return the number that stands for a handle; 0 for none."""
        if handle is None:
            return 0
        number = len(self._handles) + 1
        if number > _MOST_HANDLES:
            raise CallError(f"more than {_MOST_HANDLES} handles")
        self._handles[number] = handle
        return number


def _of_list(way: Callable[..., Any]) -> Callable[[list[Any]], Any]:
    return lambda given: way(*given)


def _inner(slot: Slot, content: bytes) -> Any:
    """Return the record in an extended one, what it has no place for beside it."""
    outer = slot.element.from_buffer_copy(content[: slot.width].ljust(slot.width, b"\0"))
    first, *others = slot.element._table_.elements
    made = type(getattr(outer, first)).from_buffer_copy(bytes(getattr(outer, first)))
    for name in others:
        setattr(made, name, getattr(outer, name))
    return made


def _outer(slot: Slot, value: Any) -> Any:
    """Return the extended record of a record and what is beside it."""
    made = slot.element()
    first, *others = slot.element._table_.elements
    setattr(made, first, value)
    for name in others:
        setattr(made, name, getattr(value, name))
    return made


def _hold(values: dict[str, Any], given: Given) -> None:
    """Put what a pointer in a structure leads to into the structure."""
    slot = given.slot
    holder = values.get(slot.holder)
    if holder is not None:
        held = bytearray(given.room or 0) if slot.writes else bytearray(given.content or b"")
        setattr(holder, slot.member, held)


def _outputs(
    prepared: _Prepared, given: list[Given], values: dict[str, Any], results: list[Any]
) -> Iterator[bytes]:
    """Go through what is written, each cut to its room."""
    returned = iter(results)
    for place, slot, content in prepared.put:
        if slot.holder:
            value = getattr(values[slot.holder], slot.member)
        else:
            argument = slot.argument
            value = next(returned) if argument.returned else values[argument.name]
        made = content(value)[: given[place].room or 0]
        yield _changed(given[place], made) if prepared.changed else made


def _changed(given: Given, content: bytes) -> bytes:
    """Return what has to be written of records: no record behind the last one that the call has changed."""
    before, width = given.content, given.slot.width
    if given.slot.way is not Way.RECORDS or not before:
        return content
    count = len(content) // width
    while (
        count and content[(count - 1) * width : count * width] == before[(count - 1) * width : count * width]
    ):
        count -= 1
    return content[: count * width]


def _numbers(slot: Slot, content: bytes) -> list[Any]:
    whole = range(0, len(content) - slot.width + 1, slot.width)
    return [slot.element.from_buffer_copy(content[at : at + slot.width]).value for at in whole]


def _first(slot: Slot, content: bytes) -> Any:
    numbers = _numbers(slot, content[: slot.width])
    return numbers[0] if numbers else 0


def _records(slot: Slot, content: bytes) -> list[Any]:
    whole = range(0, len(content) - slot.width + 1, slot.width)
    return [slot.element.from_buffer_copy(content[at : at + slot.width]) for at in whole]
