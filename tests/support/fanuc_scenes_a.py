"""A living Power Mate on the bus of the library, and what programs on a PC read of it as a text (Manual 000).

`look` writes down what has changed since the last look; `call` writes down one call with its code and what it returned.
"""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.data._parameter_rows import Kind, parameter_rows
from polycnc.controllers.fanuc.fwlib import ALL_AXES, EW

POSITIONS = ("absolute", "machine", "relative", "distance", "skip", "srvdelay", "accdecdly")
LONGEST = 0x7FFF
SHORT = {
    EW.EW_LENGTH: "LEN", EW.EW_NUMBER: "NUM", EW.EW_ATTRIB: "ATTR", EW.EW_DATA: "DATA", EW.EW_BUSY: "BUSY",
    EW.EW_OVRFLOW: "OVRFL", EW.EW_REJECT: "REJ",
}  # fmt: skip


def short(code: int) -> str:
    """Return the name of a code as tables have it."""
    return SHORT.get(EW(code), EW(code).name.removeprefix("EW_"))


def runs(values: Iterable[tuple[int, str]]) -> str:
    """Return numbers and what belongs to each, equal neighbours as one: 0-3 A, 4 B."""
    made: list[tuple[int, int, str]] = []
    for number, text in values:
        if made and made[-1][2] == text and made[-1][1] == number - 1:
            made[-1] = made[-1][0], number, text
        else:
            made.append((number, number, text))
    return ", ".join(
        f"{first} {text}" if first == last else f"{first}-{last} {text}" for first, last, text in made
    )


def numbers(values: Iterable[int]) -> str:
    """Return numbers beside each other, without the zeros at the end."""
    kept = [*values]
    while kept and not kept[-1]:
        kept.pop()
    return " ".join(map(str, kept)) or "0"


def text(data: Any) -> str:
    """Return characters in quotes."""
    return ascii(data.decode("latin-1") if isinstance(data, bytes) else data)


def shown(value: Any) -> str:
    """Return what a function returned; of a structure all its elements, vacant ones left out, and its size."""
    if isinstance(value, (ctypes.Structure, ctypes.Union)):
        elements = ", ".join(f"{name} {each}" for name, each in _elements(value, ""))
        return f"{type(value).__name__} {elements or '0'} ({ctypes.sizeof(value)} bytes)"
    return text(value) if isinstance(value, bytes) else str(value)


def _elements(value: Any, place: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, (ctypes.Structure, ctypes.Union)):
        for name, *_ in type(value)._fields_:
            name = name.lstrip("_")
            yield from _elements(getattr(value, name), f"{place}.{name}" if place else name)
    elif isinstance(value, (bytes, str)):
        if value:
            yield place, text(value)
    elif isinstance(value, int):
        if value:
            yield place, str(value)
    elif len(value) and isinstance(value[0], int):
        if any(value):
            yield place, numbers(value)
    else:
        for k, each in enumerate(value):
            yield from _elements(each, f"{place}[{k}]")


def records(data: bytes, slots: int) -> dict[str, str]:
    """Return the parameters of a sequence of records, a line each."""
    made, at = {}, 0
    while at < len(data):
        number, kind = struct.unpack_from("<hH", data, at)
        size, many = (1, 1, 2, 4)[kind >> 8], slots if kind & 0xFF == 0xFF else 1
        values = struct.unpack_from(f"<{many}{'bbhi'[kind >> 8]}", data, at + 4)
        made[f"parameter {number}"] = f"type {kind:#06x}: {' '.join(map(str, values))}"
        at += 4 + size * many + size * many % 2
    return made


class Bench:
    """A control that is node 0, a handle of it, and the text."""

    device: PowerMate
    handle: int

    def __init__(self) -> None:
        self.lines: list[str] = []
        self._known: dict[str, str] = {}

    # ------------------------------------------------------------------ text

    def title(self, words: str) -> None:
        """Begin a section."""
        self.lines += ["", f"## {words}", ""] if self.lines else [f"## {words}", ""]

    def say(self, words: str) -> None:
        """Write a line."""
        self.lines.append(words)

    def table(self, head: str, columns: Iterable[Any], rows: Iterable[tuple[Any, Iterable[str]]]) -> None:
        """Write a table, in columns as wide as their longest cell."""
        cells = [[head, *map(str, columns)]] + [[str(name), *values] for name, values in rows]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        self.lines += [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in cells
        ]

    # ------------------------------------------------------------------ the control

    def control(self, **keys: Any) -> PowerMate:
        """Begin with a new control; a look tells what differs from the last look at the one before."""
        self.device = PowerMate(**keys)
        fwlib.detach()
        fwlib.attach(0, self.device)
        _, self.handle = fwlib.cnc_allclibhndl()
        return self.device

    def code(self, name: str, *given: Any) -> EW:
        """Call a function and return its code alone."""
        answer = getattr(fwlib, name)(self.handle, *given)
        return EW(answer[0] if isinstance(answer, tuple) else answer)

    def cell(self, name: str, *given: Any) -> str:
        """Call a function and return its code as tables have it."""
        return short(self.code(name, *given))

    def get(self, name: str, *given: Any) -> Any:
        """Return what a function returned after its code, which is that of success."""
        code, *rest = getattr(fwlib, name)(self.handle, *given)
        assert code == EW.EW_OK, (name, given, code)
        for record in rest:
            unused: Any = getattr(record, "dummy", 0)
            assert unused == 0 or not any(unused), (name, given, record)
        return rest[0] if len(rest) == 1 else rest

    def remove(self, *programs: int) -> None:
        """Delete programs if they are there, with none selected."""
        for number in programs:
            self.code("cnc_delete", number)

    def call(self, name: str, *given: Any) -> None:
        """Call a function and write down what it answers."""
        answer = getattr(fwlib, name)(self.handle, *given)
        code, *rest = answer if isinstance(answer, tuple) else (answer,)
        told = ", ".join(map(shown, rest)) if code == EW.EW_OK else ""
        arguments = ", ".join(map(shown, given))
        self.say(f"{name}({arguments}): {short(code)}{' ' if told else ''}{told}")

    def memory(self, words: str, record: Any) -> None:
        """Write down the bytes of a structure, without the zeros at its end."""
        data = bytes(record)
        self.say(f"{words}: {data.rstrip(bytes(1)).hex(' ', -2)} of {len(data)} bytes")

    def do(self, words: str, act: Callable[[], Any], *, data: bool = False) -> None:
        """Do something, and look what that has changed."""
        self.say(f"> {words}")
        act()
        self.look(data=data)

    def advance(self, cycles: int, words: str = "") -> None:
        """Let time pass, and look."""
        self.say(f"> {cycles} ms{' ' if words else ''}{words}")
        self.device.advance(cycles)
        self.look()

    # ------------------------------------------------------------------ looks

    def look(self, *, data: bool = False) -> None:
        """Write down what has changed of positions, execution and programs, with `data` of the data files too."""
        now = dict(self._axes())
        now |= self._execution()
        now |= self._memory()
        if data:
            now |= self._data()
        known = self._known
        kept = {name: each for name, each in known.items() if not data and name not in now}
        for name, each in now.items():
            if known.get(name) != each:
                self.say(f"  {name}: {each}")
        for name in known:
            if name not in now and name not in kept:
                self.say(f"  {name}: no more")
        self._known = kept | now

    def _axes(self) -> Iterator[tuple[str, str]]:
        handle, axes = self.handle, self.device.axes
        every = {name: self.get(f"cnc_{name}", ALL_AXES, LONGEST) for name in POSITIONS}
        for name, record in every.items():
            yield name, numbers(record.data)
        for axis in range(1, axes + 1):  # one axis has to say what all say
            for name, record in every.items():
                alone = self.get(f"cnc_{name}", axis, 8)
                wanted = [record.data[axis - 1]]
                if (alone.type, alone.dummy, [*alone.data][:1]) != (axis, 0, wanted) or any(
                    [*alone.data][1:]
                ):
                    yield f"{name} of axis {axis} alone", shown(alone)
            single = self.get("cnc_rddynamic", axis, 38)
            place = single.pos.oaxis
            found = tuple(getattr(place, name) for name in POSITIONS[:4])
            if found != tuple(every[name].data[axis - 1] for name in POSITIONS[:4]) or single.axis != axis:
                yield f"dynamic of axis {axis} alone", f"{single.axis}: {' '.join(map(str, found))}"
        whole = self.get("cnc_rddynamic", ALL_AXES, LONGEST)
        for name in POSITIONS[:4]:
            if [*getattr(whole.pos.faxis, name)] != [*every[name].data][
                : len(getattr(whole.pos.faxis, name))
            ]:
                yield f"dynamic {name}", numbers(getattr(whole.pos.faxis, name))
        yield (
            "dynamic",
            (
                f"alarm {whole.alarm & 0xFFFF:#x}, O{whole.prgnum} of O{whole.prgmnum}, N{whole.seqnum}, "
                f"F {whole.actf}, {whole.acts}, {whole.dummy}"
            ),
        )
        feed, program = self.get("cnc_actf"), self.get("cnc_rdprgnum")
        apart = (feed.data, program.data, program.mdata, self.get("cnc_rdseqnum").data)
        if apart != (whole.actf, whole.prgnum, whole.prgmnum, whole.seqnum):
            yield "feed, programs, sequence number by themselves", str(apart)
        state = fwlib.cnc_statinfo(handle)[1]
        yield (
            "state",
            (
                f"{self.device.mode.label}, run {state.run}, motion {state.motion}, mstb {state.mstb}, "
                f"emergency {state.emergency}, alarm {state.alarm}, edit {state.edit}"
            ),
        )

    def _execution(self) -> dict[str, str]:
        length, ahead, code = self.get("cnc_rdexecprog", 48)
        answer = fwlib.cnc_rdmdipntr(self.handle)
        mdi = answer[1]
        return {
            "program text": f"{text(code)} ({length}), {ahead} ahead",
            "mdi pointers": f"O{mdi.mdiprog} {mdi.mdipntr}, ahead O{mdi.crntprog} {mdi.crntpntr}"
            if answer[0] == EW.EW_OK
            else short(answer[0]),
        }

    def _memory(self) -> dict[str, str]:
        memory = self.get("cnc_rdproginfo", 0, 12).u.bin
        listed = [self.get("cnc_rdprogdir", kind, 1, 9999, 256).prg_data for kind in range(3)]
        return {
            "memory": f"{memory.reg_prg} programs, {memory.unreg_prg} more; "
            f"{memory.used_mem} used, {memory.unused_mem} free",
            "as text": text(self.get("cnc_rdproginfo", 1, 31).u.asc),
            "directory": f"{text(listed[2])}",
            "directory, without characters": f"{text(listed[1])}",
            "directory, numbers alone": f"{text(listed[0])}",
        }

    def _data(self) -> dict[str, str]:
        device = self.device
        offsets = self.get("cnc_rdtofsr", 1, 0, device.tool_offsets.count, LONGEST)
        made = {f"tool offset {number}": str(each) for number, each in enumerate(offsets.u.m_ofs, 1) if each}
        for first, last in ((1, 33), *device.macros.variables.ranges):
            for number, each in enumerate(self.get("cnc_rdmacror", first, last, LONGEST).data, first):
                if (each.mcr_val, each.dec_val) != (0, -1):
                    made[f"#{number}"] = f"{each.mcr_val} {each.dec_val}"
        _, last, length, data = self.get("cnc_rdparar", 0, ALL_AXES, 9999, LONGEST)
        assert (last, length) == (8022, len(data))
        return made | {
            name: each
            for name, each in records(data, device.max_axis).items()
            if each != _default(name, device)
        }


def _default(name: str, device: PowerMate) -> str:
    """Return the line of a parameter that has its default on every axis."""
    row = parameter_rows()[int(name.split()[1])]
    values = [row.default] * (device.axes if row.per_axis else 1)
    values += [0] * (device.max_axis - device.axes if row.per_axis else 0)
    signed = (value - 256 if row.kind is Kind.BIT and value > 127 else value for value in values)
    return f"type {int(row.kind) << 8 | (0xFF if row.per_axis else 0):#06x}: {' '.join(map(str, signed))}"


def stream(*blocks: str) -> bytes:
    """Return what a program sends: LF block LF ... LF %."""
    return "\n".join(("", *blocks, "%")).encode("latin-1")


def registered(device: PowerMate, **programs: str) -> None:
    """Put programs into the memory: O7=";N10 G1;M30" and so on; the O word comes by itself."""
    for name, blocks in programs.items():
        device.programs.register(int(name[1:]), "\n".join(f"O{int(name[1:]):04d}{blocks}".split(";")) + "\n")
