"""Call the functions of a C library with any arguments, and the façade with the same: answers and bytes are equal."""

from __future__ import annotations

import ctypes
import random
import struct
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from polycnc.controllers.library import Opaque, Session
from polycnc.controllers.library.clib import Call, CLibrary, Slot, Way
from polycnc.errors import UsageError
from support.c_library import PATTERN, Guarded

_RESULTS = {"void": None, "double": ctypes.c_double, "short": ctypes.c_int16}
_EDGES = (0, 1, -1, 2, 3, 7, 32767, -32768, 255)
_NULL_SHARE = 0.03
_STATE_SHARE = 0.02
_LONGEST_TEXT = 4096  # without a zero
_MANY = 4096  # elements behind a pointer, where another argument says how many


@dataclass
class Passed:
    """An argument as C and as Python get it; `memory` is what C's pointer leads to, None for a number or null."""

    slot: Slot
    c: Any
    python: Any = None
    memory: Guarded | None = None
    content: bytes = b""

    @property
    def is_null(self) -> bool:
        return self.memory is None and self.slot.way is not Way.VALUE


@dataclass(frozen=True)
class Meant:
    """What callers mean: by function the values of arguments, numbers and contents, and by structure a record."""

    rows: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    records: Mapping[str, Callable[[random.Random], Any]] = field(default_factory=dict)

    def number(self, call: Call, slot: Slot) -> Any:
        """Return the value of an argument by value, or behind a pointer; None: any."""
        return self.rows.get(call.function.name, {}).get(slot.argument.name)

    def content(self, call: Call, slot: Slot, dice: random.Random) -> bytes | None:
        """Return what lies behind a pointer; None: anything."""
        found = self.number(call, slot)
        if found is not None:
            return bytes(found)
        made = self.records.get(slot.element.__name__)
        return None if made is None else bytes(made(dice))


@dataclass
class Hold:
    """Both libraries; `size` says how many bytes a program has behind a pointer, with these numbers for the others.

    `number` returns a value for an argument by value, or None: any. `state` returns the state of the machine, which no
    refused call may change.
    """

    library: CLibrary
    c: Any
    python: Session
    dice: random.Random
    number: Callable[[Call, Slot, random.Random], Any]
    size: Callable[[Call, Slot, dict[str, Any]], int]
    before: Callable[[Call, list[Passed]], Any] = lambda call, passed: None
    meant: Meant = field(default_factory=Meant)
    state: Callable[[], Any] = lambda: None
    texts: tuple[str, ...] = ("", "A", "abc", "x" * 80)
    objects: dict[int, Any] = field(default_factory=dict)
    told: list[str] = field(default_factory=list)
    codes: set[Any] = field(default_factory=set)
    done: Counter[str] = field(default_factory=Counter)
    """How often a function was carried out and not refused."""
    _is_meant: bool = False
    _null: Slot | None = None

    def call(self, call: Call) -> None:
        """Call a function in both, and compare answer, outputs and every other byte."""
        self._is_meant = self.dice.random() < 0.6
        self._compare(call, self._expected)

    def nulls(self, call: Call) -> None:
        """Call a function with each of its pointers null in turn, and all else as it is meant."""
        self._is_meant = True
        for slot in call.slots:
            if slot.way is not Way.VALUE:
                self._null = slot
                self._compare(call, self._expected)
        self._null = None

    def lost(self, call: Call) -> None:
        """Call a function of which nobody is there any more."""
        self._is_meant = True
        library, name = self.library, call.function.name
        coded = library.nobody if name in library.opens else library.lost
        failure = library.failures.get(name, coded if call.function.coded else 0)

        def expected(call: Call, passed: list[Passed]) -> tuple[Any, list[bytes]]:
            early = self.before(call, passed)
            return failure if early is None else early, [b""] * len(passed)

        self._compare(call, expected)

    def harmless(self, call: Call) -> int:
        """Call a function, and look only that nothing is written beside its arguments, or with a code at all."""
        self._is_meant = self.dice.random() < 0.6
        passed, answer, said = self._called(call)
        for each in passed:
            if each.memory is not None:
                assert each.memory.is_kept, f"{said}: beside {each.slot.argument.name}"
                untouched = each.memory.content == each.content.ljust(each.memory.size, PATTERN)
                assert untouched or not (call.function.coded and answer), f"{said}: {each.slot.argument.name}"
        return int(answer or 0)

    def _called(self, call: Call) -> tuple[list[Passed], Any, str]:
        passed = self._passed(call)
        function = getattr(self.c, self.dice.choice([call.function.name, *self._aliases(call)]))
        function.restype = _RESULTS.get(call.function.result, ctypes.c_int32)
        answer = function(*(each.c for each in passed))
        said = f"{call.function.name}({', '.join(str(each.python)[:50] for each in passed)}) = {answer}"
        self.told.append(said)
        self.codes.add(answer)
        return passed, answer, said

    def _compare(self, call: Call, expect: Callable[[Call, list[Passed]], tuple[Any, list[bytes]]]) -> None:
        passed, answer, said = self._called(call)
        expected, contents = expect(call, passed)
        if call.function.result != "void":
            assert answer == expected or (answer != answer and expected != expected), (
                f"{said}, not {expected}"
            )
        for each, content in zip(passed, contents, strict=True):
            if each.memory is not None:
                assert each.memory.is_kept, f"{said}: beside {each.slot.argument.name}"
                after = each.content.ljust(each.memory.size, PATTERN)
                after = (content + after[len(content) :])[: each.memory.size]
                assert each.memory.content == after, f"{said}: {each.slot.argument.name}"

    def _aliases(self, call: Call) -> list[str]:
        return [alias for alias, name in self.library.aliases.items() if name == call.function.name]

    def _passed(self, call: Call) -> list[Passed]:
        numbers: dict[str, Any] = {}
        passed: dict[str, Passed] = {}
        for slot in call.slots:  # first what says how much lies behind the others
            if slot.way is Way.VALUE:
                value = self._value(call, slot)
                numbers[slot.argument.name] = value
                opaque = isinstance(slot.argument.type, Opaque)
                python = self.objects.get(value, value or None) if opaque else value
                c = ctypes.c_void_p(value) if opaque else slot.element(value)
                passed[slot.argument.name] = Passed(slot, c, python)
        for slot in call.slots:
            if slot.way is Way.NUMBERS:
                made = self._numbers(call, slot, numbers)
                numbers[slot.argument.name] = made.python
                passed[slot.argument.name] = made
        for slot in call.slots:
            if slot.argument.name not in passed:
                passed[slot.argument.name] = made = self._memory(call, slot, numbers)
                numbers[slot.argument.name] = made.python
        return [passed[each.argument.name] for each in call.slots]

    def _value(self, call: Call, slot: Slot) -> Any:
        found = self.meant.number(call, slot) if self._is_meant else None
        if found is None:
            found = self.number(call, slot, self.dice)
        if found is None:
            found = self.dice.choice(_EDGES)
        return float(found) if slot.element is ctypes.c_double else slot.element(found).value

    def _is_null(self, slot: Slot) -> bool:
        return slot is self._null or (not self._is_meant and self.dice.random() < _NULL_SHARE)

    def _guarded(self, size: int, content: bytes) -> Guarded:
        return Guarded(size, content, low=self.dice.random() < 0.5)

    def _numbers(self, call: Call, slot: Slot, numbers: dict[str, Any]) -> Passed:
        if self._is_null(slot):
            return Passed(slot, None)
        count = max(1, min(_MANY, self.size(call, slot, numbers) // slot.width))
        values = [self._value(call, slot) for _ in range(count)]
        content = b"".join(bytes(slot.element(each)) for each in values) if slot.reads else b""
        memory = self._guarded(count * slot.width, content)
        python = values if getattr(slot.argument.type, "of", None) is int else values[0]
        return Passed(slot, ctypes.c_void_p(memory.address), python if slot.reads else None, memory, content)

    def _memory(self, call: Call, slot: Slot, numbers: dict[str, Any]) -> Passed:
        if self._is_null(slot):
            return Passed(slot, None)
        size = max(0, self.size(call, slot, numbers))
        if slot.way is Way.TEXT and slot.reads:
            text = self.dice.choice(self.texts)
            content = text.encode("latin-1") + (b"\0" if len(text) < _LONGEST_TEXT else b"")
            memory = self._guarded(max(size, len(content)), content)
            return Passed(slot, ctypes.c_void_p(memory.address), text, memory, content)
        content = b""
        if slot.reads:
            meant = self.meant.content(call, slot, self.dice) if self._is_meant else None
            content = self._bytes(size) if meant is None else (meant * (size // len(meant) + 1))[:size]
        memory = self._guarded(size, content)
        return Passed(
            slot, ctypes.c_void_p(memory.address), self._object(slot, size, content), memory, content
        )

    def _bytes(self, size: int) -> bytes:
        """Return content that means something as often as not: small numbers, characters, anything."""
        way = self.dice.random()
        if way < 0.5:
            return b"".join(struct.pack("<h", self.dice.randrange(-2, 9)) for _ in range(size // 2 + 1))[
                :size
            ]
        if way < 0.8:
            return bytes(size)
        return self.dice.randbytes(size)

    def _object(self, slot: Slot, size: int, content: bytes) -> Any:
        """Return what the façade is passed for memory."""
        if slot.way is Way.MEMORY:
            return content if slot.reads else None
        if slot.way is Way.RECORD:
            return slot.element.from_buffer_copy(content[: slot.width].ljust(slot.width, b"\0"))
        if slot.way is Way.RECORDS:
            whole = content.ljust(size, b"\0")
            return [
                slot.element.from_buffer_copy(whole[at : at + slot.width])
                for at in range(0, size - slot.width + 1, slot.width)
            ]
        return None

    def _expected(self, call: Call, passed: list[Passed]) -> tuple[Any, list[bytes]]:
        """Return what the façade answers, and what it leaves in each memory."""
        nothing = [b""] * len(passed)
        early = self.before(call, passed)
        if early is not None:
            return early, nothing
        function = call.function
        failure = self.library.failures.get(function.name, self.library.null)
        null = failure if function.coded else None if function.result == "void" else 0
        if any(each.is_null and each.slot.writes for each in passed):
            return null, nothing
        values = [each.python for each in passed if each.slot.argument.passed]
        before = self.state() if self.dice.random() < _STATE_SHARE else None
        self.python.refused = False
        try:
            answer = getattr(self.python, function.name)(*values)
        except UsageError:
            self.python.refused = True
            answer = null
        if before is not None and self.python.refused:
            assert self.state() == before, f"{function.name} was refused, and changed the machine"
        if answer is null and self.python.refused:
            return null, nothing
        results = list(answer) if isinstance(answer, tuple) else [answer]
        code = None if function.result == "void" else results.pop(0)
        if self.python.refused:
            return code, nothing
        self.done[function.name] += 1
        left = []
        for each in passed:
            if not each.slot.writes:
                left.append(b"")
                continue
            value = results.pop(0) if each.slot.argument.returned else each.python
            left.append(_memory_of(each.slot, value))
        return code, left


def _memory_of(slot: Slot, value: Any) -> bytes:
    if slot.way is Way.TEXT:
        return str(value).encode("latin-1") + b"\0"
    if isinstance(value, list):
        return b"".join(
            bytes(slot.element(each)) if slot.way is Way.NUMBERS else bytes(each) for each in value
        )
    return bytes(slot.element(value)) if slot.way is Way.NUMBERS else bytes(value)
