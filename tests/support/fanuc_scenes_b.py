"""A Power Mate that a program of the manual works with, and everything that its library can read, as text.

Every call is a line with its code and what it returns; below it stands what has become different since the last look:
state, alarms, modal data, diagnosis data, positions, servo values, messages, panel, PMC memory, buffers, histories.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from datetime import datetime
from functools import partial
from itertools import groupby
from typing import Any

from polycnc.cnc import ControlError
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW

LETTERS = "GFYXARTKCD"
"""Address letters of the PMC by their numbers (Manual 000, pmc_rdpmcrng)."""
AREAS = {
    "G": ((0, 255), (1000, 1255)), "F": ((0, 127), (1000, 1000)), "Y": ((0, 127), (1000, 1063)),
    "X": ((0, 127), (1000, 1063)), "A": ((0, 24),), "R": ((0, 999), (9000, 9117)), "T": ((0, 79),),
    "K": ((0, 19),), "C": ((0, 79),), "D": ((0, 1859),),
}  # fmt: skip
USUAL = "GFYXA"
RECORD = ("key", "signal", "alarm", "date", "time")
AT = datetime(2031, 4, 17, 22, 53, 41)
ALARMS = 9
ALL_GROUPS = -1
SHOWN_ELSEWHERE = (30, 31, 301)
MODAL_KINDS = ((-1, 21), (-2, 27 * 6), (-3, 6 * 6))


def plain(value: Any) -> str:
    """Return a returned value as text: structures by their members that are not 0, bytes as hexadecimal numbers."""
    if isinstance(value, bytes):
        text = value.rstrip(b"\0")
        return repr(text)[1:] if text.isascii() and text.decode("ascii").isprintable() else value.hex(" ")
    if hasattr(value, "_fields_"):
        members = ((name, getattr(value, name)) for name, *_ in value._fields_)
        return " ".join(f"{name}={plain(member)}" for name, member in members if anything(member))
    if hasattr(value, "_length_") or isinstance(value, list):
        shown = [f"({plain(each)})" if hasattr(each, "_fields_") else plain(each) for each in value]
        while shown and shown[-1] in ("0", "()", "''"):
            shown.pop()
        return f"[{' '.join(shown)}]"
    return str(int(value)) if isinstance(value, int) else str(value)


def anything(member: Any) -> bool:
    """Whether a member is not all zeros."""
    return any(bytes(member)) if hasattr(member, "_length_") or hasattr(member, "_fields_") else bool(member)


def raw(value: Any) -> bytes:
    """Return a structure as it lies in memory, as the manual packs it."""
    return bytes(value.pack())


class Bench:
    """A control, a handle of it, and what was seen of both; `letters` are those of the PMC that a look reads; a
    `wide` one reads modal data, and diagnosis data that repeat others."""

    control: PowerMate

    def __init__(self, letters: str = USUAL, *, wide: bool = False, **machine: Any) -> None:
        self.letters, self.wide = letters, wide
        self.lines: list[str] = []
        self.library = fwlib.Session()
        self.fresh(**machine)

    def fresh(self, **machine: Any) -> None:
        """Begin with another control; what it is when the power comes on is not written down."""
        self.control = PowerMate(**machine)
        self.control.clock.set_now(AT)
        self.library.attach(0, self.control)
        _, self.handle = self.library.cnc_allclibhndl()
        self.kept: dict[str, tuple[bytes, dict[str, str]]] = {}
        self.memory: dict[tuple[str, int], bytes] = {}
        self.records = 0, 0
        self.noted: dict[str, str] = {}
        before = list(self.lines)
        self.look()
        self.lines = before
        self.lines.append(
            f"* power on: {', '.join(f'{name}={plain(value)}' for name, value in machine.items())}"
        )

    def again(self) -> None:
        """Go on with another control that has the same memory, as after the end of a process, and look."""
        now = self.control.clock.now
        self.control = PowerMate(self.control.axes, memory=self.control.store)
        self.control.clock.set_now(now)
        self.library.attach(0, self.control)
        _, self.handle = self.library.cnc_allclibhndl()
        self.lines.append("* another process, the same memory")
        self.look()

    # ------------------------------------------------------------------ what a scene does

    def title(self, text: str) -> None:
        """Begin a part."""
        self.lines += ["", f"## {text}"]

    def ask(self, name: str, *arguments: Any) -> Any:
        """Call a function and write down what it answers; return that."""
        found = getattr(self.library, name)(self.handle, *arguments)
        code, values = (found[0], found[1:]) if isinstance(found, tuple) else (found, ())
        given = ", ".join(map(plain, arguments))
        text = " | ".join(map(plain, values)) if code == EW.EW_OK else ""
        self.lines.append(f"{name}({given}) {EW(code).name} {text}".rstrip())
        return values[0] if values else code

    def do(self, name: str, *arguments: Any) -> None:
        """Call a function, and look what has become different."""
        self.ask(name, *arguments)
        self.look()

    def act(self, name: str, *arguments: Any, **named: Any) -> None:
        """Do something at the control itself, as its operator or its machine does, and look."""
        body: Callable[..., Any] = self.control  # type: ignore[assignment]
        for part in name.split("."):
            body = getattr(body, part)
        text = ", ".join([*(plain(each) for each in arguments), *(f"{k}={v}" for k, v in named.items())])
        try:
            body(*arguments, **named)
        except ControlError as error:
            self.lines.append(f"* {name}({text}) refused: {error.reason.name}")
        else:
            self.lines.append(f"* {name}({text})")
        self.look()

    def parameters(self, number: int, *values: int) -> None:
        """Write a parameter at the control: one value, or one for each axis."""
        if len(values) > 1:
            for axis, value in enumerate(values, 1):
                self.control.parameters.set(number, value, axis)
        else:
            self.control.parameters.set(number, values[0])
        self.lines.append(f"* parameter {number}: {' '.join(map(str, values))}")
        self.look()

    def put(self, letter: str, address: int, *data: int, cycles: int = 0) -> None:
        """Write bytes to the PMC by the library, let time pass, and look."""
        head = (LETTERS.index(letter), 0, address, address + len(data) - 1)
        block = b"".join(each.to_bytes(2, "little", signed=True) for each in head) + bytes(data)
        code = self.library.pmc_wrpmcrng(self.handle, len(block), block)
        self.control.advance(cycles)
        after = f", {cycles} cycles" if cycles else ""
        self.lines.append(f"{letter}{address} <- {bytes(data).hex(' ')} {EW(code).name}{after}")
        self.look()

    def run(self, cycles: int) -> None:
        """Let time pass, and look."""
        self.control.advance(cycles)
        self.lines.append(f"-- {cycles} cycles")
        self.look()

    def program(self, number: int, text: str, *, start: bool = True) -> None:
        """Register a program, select it in MEM, start it."""
        self.control.programs.register(number, f"O{number:04d}\n{text}\n")
        self.control.select_mode("MEM")
        self.control.select_program(number)
        if start:
            self.control.cycle_start()
        self.lines.append(f"* program O{number:04d}: {' / '.join(text.splitlines())}")
        self.look()

    # ------------------------------------------------------------------ what is seen

    def look(self) -> None:
        """Write down what has become different."""
        for name, data, decoded in self._readings():
            old, before = self.kept.get(name, (b"", {}))
            if old == data:
                continue
            now = decoded(data)
            self.kept[name] = data, now
            for key in sorted(before.keys() | now.keys()):
                was, is_now = before.get(key, ""), now.get(key, "")
                if key == "axes":
                    self.lines.append(f"    {parts_changed(was, is_now)}")
                elif was != is_now:
                    self.lines.append(f"    {key}: {was or '-'} > {is_now or '-'}")
        for letter in self.letters:
            self._look_at_pmc(letter)

    def _look_at_pmc(self, letter: str) -> None:
        for first, last in AREAS[letter]:
            data = self._pmc_bytes(LETTERS.index(letter), first, last)
            old = self.memory.get((letter, first), bytes(len(data)))
            self.memory[letter, first] = data
            if old != data:
                self.lines += [f"    {line}" for line in changed_bytes(letter, first, old, data)]

    def histories(self) -> None:
        """Write down what histories have got since the last time; sampling is stopped for it."""
        read = self._read
        read("cnc_stopophis")
        counts = read("cnc_rdophisno"), read("cnc_rdalmhisno")
        if any(new < old for old, new in zip(self.records, counts, strict=True)):
            self.lines.append(f"    {counts[0]} operations, {counts[1]} past alarms")
        before = tuple(min(old, new) for old, new in zip(self.records, counts, strict=True))
        if counts[0] > before[0]:
            his = read("cnc_rdophistry", before[0] + 1, counts[0], 6 + 8 * (counts[0] - before[0]))
            for k, each in enumerate(his.data, before[0] + 1):
                self.lines.append(f"    operation {k}: {record(each)}")
        if counts[1] > before[1]:
            his = read("cnc_rdalmhistry", before[1] + 1, counts[1], 6 + 48 * (counts[1] - before[1]))
            for k, each in enumerate(his.alm_his, before[1] + 1):
                self.lines.append(f"    past alarm {k}: {plain(each)}")
        self.records = counts
        read("cnc_startophis")

    def text(self) -> str:
        """Return all that was written down."""
        return "\n".join(line.rstrip() for line in self.lines).lstrip("\n") + "\n"

    def _read(self, name: str, *arguments: Any) -> Any:
        found = getattr(self.library, name)(self.handle, *arguments)
        if not isinstance(found, tuple):
            return found
        return found[1] if found[0] == EW.EW_OK else found[0].name

    def _structure(self, name: str, *arguments: Any) -> bytes:
        """Return what a function reads as it lies in memory, or the name of the code that refuses it."""
        found = self._read(name, *arguments)
        return found.encode() if isinstance(found, str) else raw(found)

    def _readings(self) -> Iterator[tuple[str, bytes, Callable[[bytes], dict[str, str]]]]:
        """Return all readings as bytes, each with what explains them."""
        yield "state", self._structure("cnc_statinfo"), _state
        yield "alarm groups", self._structure("cnc_alarm"), lambda data: {"alarm groups": data[:3:-1].hex()}
        yield "alarms", self._structure("cnc_rdalminfo", 1, ALL_GROUPS, 38 * ALARMS + 2), _alarms
        yield "message", self._structure("cnc_rdopmsg", 0, 262), _message
        yield "diagnosis", self.library.cnc_diagnosr(self.handle, 0, -1, 9999, 4096)[4], self._diagnosis
        if self.wide:
            for block in range(3):
                data = b"".join(
                    self._structure("cnc_modal", kind, block)[4 : 4 + size] for kind, size in MODAL_KINDS
                )
                yield f"block {block}", data, partial(_modal, block)
        yield from self._axes()
        yield "panel", self._structure("cnc_rdopnlsgnl", -1), _panel
        yield "general", self._structure("cnc_rdopnlgnrl", -1), lambda data: {"general": f"{data[4]:08b}"}
        yield "names", self._structure("cnc_rdopnlgsname", 0xFF), _names

    def _axes(self) -> Iterator[tuple[str, bytes, Callable[[bytes], dict[str, str]]]]:
        axes, most = self.control.axes, self.control.max_axis
        found = {
            name: self._read(f"cnc_{name}", -1, 4 + 4 * most).data[:axes]
            for name in ("absolute", "machine", "relative", "distance")
        } | {name[2:]: self._read(f"cnc_{name}") for name in ("rdcurrent", "rdsrvspeed", "rdloopgain")}
        text = " | ".join(f"{name} {' '.join(map(str, values))}" for name, values in found.items())
        yield "axes", text.encode(), partial(_same, "axes")
        yield "feed", str(self._read("cnc_actf").data).encode(), partial(_same, "feed")
        for name in ("exebufstat", "finstate"):
            yield name, self._structure(f"cnc_{name}"), partial(_bytes_of_paths, name)

    def _diagnosis(self, data: bytes) -> dict[str, str]:
        """Return the values of each number, by the sizes and types that the manual gives."""
        made, at = {}, 0
        while at < len(data):
            number, axis, kind = int.from_bytes(data[at : at + 2], "little"), data[at + 2], data[at + 3]
            size, count = (1, 1, 2, 4)[kind], self.control.max_axis if axis == 0xFF else 1
            ends = range(at + 4, at + 4 + size * count, size)
            values = [int.from_bytes(data[k : k + size], "little", signed=kind > 1) for k in ends]
            if self.wide or number not in SHOWN_ELSEWHERE:
                made[f"diagnosis {number}, axis {axis}, type {kind}"] = " ".join(map(str, values))
            at += 4 + size * count + size * count % 2
        return made

    def _pmc_bytes(self, kind: int, first: int, last: int) -> bytes:
        found = self._read("pmc_rdpmcrng", kind, 0, first, last, 9 + last - first)
        return b"" if isinstance(found, str) else bytes(found.u)[: last - first + 1]


def record(each: Any) -> str:
    """Return a record of the operation history."""
    kind = each.rec_alm.rec_type
    member = (each.rec_mdi, each.rec_sgn, each.rec_alm, each.rec_date, each.rec_time)[kind]
    return f"{RECORD[kind]} {plain(member)}"


def parts_changed(old: str, new: str) -> str:
    """Return the parts of a line that have changed."""
    before = old.split(" | ")
    return " | ".join(each for each in new.split(" | ") if each not in before)


def changed_bytes(letter: str, first: int, old: bytes, new: bytes) -> Iterator[str]:
    """Say which bytes have changed; many together by their ends and a sum, each times its place."""
    places = [k for k in range(len(new)) if k >= len(old) or old[k] != new[k]]
    for _, group in groupby(enumerate(places), lambda pair: pair[1] - pair[0]):
        run = [place for _, place in group]
        low, high = run[0], run[-1] + 1
        was, now = old[low:high], new[low:high]
        name = f"{letter}{first + low}" + (f"..{first + high - 1}" if high > low + 1 else "")
        if high - low > 8:
            total = sum(k * value for k, value in enumerate(now, 1))
            yield f"{name}: {now[:3].hex(' ')} ... {now[-3:].hex(' ')}, sum {total}"
        else:
            yield f"{name}: {was.hex(' ')} > {now.hex(' ')}"


def _same(name: str, data: bytes) -> dict[str, str]:
    return {name: data.decode()}


def _state(data: bytes) -> dict[str, str]:
    made = fwlib.ODBST.unpack(data)
    names = ("aut", "run", "motion", "mstb", "emergency", "alarm", "edit")
    return {f"state {name}": str(getattr(made, name)) for name in names}


def _alarms(data: bytes) -> dict[str, str]:
    made = {}
    for k in range(ALARMS):
        axis, number, length = (
            int.from_bytes(data[38 * k + m : 38 * k + m + 2], "little", signed=True) for m in (0, 2, 4)
        )
        if axis == -1:
            break
        made[f"alarm {k + 1}"] = f"{number} axis {axis} {plain(data[38 * k + 6 : 38 * k + 38])} ({length})"
    return made


def _message(data: bytes) -> dict[str, str]:
    if len(data) < 262:
        return {"message": data.decode()}
    return {"message": plain(fwlib.OPMSG.unpack(data))}


def _modal(block: int, data: bytes) -> dict[str, str]:
    made = {f"block {block} group {k}": f"{code:02x}" for k, code in enumerate(data[:21]) if code}
    for k in range(27 + 6):
        aux = data[21 + 6 * k :][:6]
        name = f"word {100 + k}" if k < 27 else f"word {173 + k}"
        if any(aux):
            value = int.from_bytes(aux[:4], "little", signed=True)
            made[f"block {block} {name}"] = f"{value} {aux[4]:02x} {aux[5]:02x}"
    return made


def _bytes_of_paths(name: str, data: bytes) -> dict[str, str]:
    return {name: data.decode() if data.startswith(b"EW") else data.hex(" ", 8)}


def _panel(data: bytes) -> dict[str, str]:
    made = fwlib.IODBSGNL.unpack(data)
    return {f"panel {name}": str(getattr(made, name)) for name, *_ in made._fields_}


def _names(data: bytes) -> dict[str, str]:
    return {f"name {k}": repr(data[4 + 9 * (k - 1) :][:9])[1:] for k in range(1, 9)}


def opdi(value: int, axis: int = 0) -> Any:
    """Return the value of an operation signal."""
    made = fwlib.ODBOPDI(axis=axis)
    made.u.cdata = value
    return made


def panel(bits: int, **members: int) -> Any:
    """Return signals of the panel, of which `bits` are selected."""
    return fwlib.IODBSGNL(type=short(bits), **members)


def short(bits: int) -> int:
    """Return 16 bits as a number with a sign."""
    return bits - 0x10000 if bits & 0x8000 else bits


def positions(*pairs: tuple[int, int]) -> bytes:
    """Return axes with values, as they are passed to a direct command."""
    return b"".join(raw(fwlib.ODBPOS(idata=axis, ldata=value)) for axis, value in pairs)
