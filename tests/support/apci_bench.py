"""A virtual board on a bench: every call of the library in short, and every register in every few scans, as text.

What a scene does is written down as one line of each register: its value at the end of each step, how often it
changed, and the sum over the samples, each value times the number of its sample.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from itertools import pairwise, zip_longest
from typing import Any

import numpy as np

from polycnc.controllers.apci import pcap, sap
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.controllers.apci.sap._board_host import BoardTasks
from polycnc.controllers.apci.sap._commands import AXIS_QUALIFIERS, SYSTEM_VARIABLES

_ELSEWHERE = {
    *("wrdigob", "wrcd", "wrci", "wrcbcnct", "wrSysVarInt", "wrSysVarDbl", "wrAxVarInt", "wrAxVarDbl"),
    *("wrtp", "wrlp", "wrlpndx"),
}  # fmt: skip
WRITES = sorted(
    name
    for name in pcap.FUNCTIONS
    if name.startswith("wr") and f"rd{name[2:]}" in pcap.FUNCTIONS and name not in _ELSEWHERE
)
"""What writes a register that is read back by a function of the same name."""
OF_AXES = {name for name in WRITES if re.search(r"tsrp| an,", str(pcap.FUNCTIONS[name].prototype))}
WHOLE = {
    *(
        "wrModeReg",
        "wrnfrax",
        "wrGCR",
        "wrControllerFlags",
        "wrmcp",
        "wrdigo",
        "wrledgn",
        "wrledyl",
        "wrledrd",
    )
}

_ELEMENTS = {"jtvl": "jtv", "rpd": "rp", "dpd": "dp", "tpd": "tp", "lpndx": "lp"}
_NOT_READ = {
    "rdigi",
    "rdlp",
    "rdap",
    "rdepc",
}  # they reset something, read all, or read nothing that a board does
_OF_RECORD = (
    *(
        "jac",
        "jvl",
        "hac",
        "hvl",
        "jovr",
        "rp",
        "dp",
        "tp",
        "sll",
        "slr",
        "ipw",
        "mpe",
        "gf",
        "mcp",
        "axst",
        "lsm",
    ),
    *("digi", "digo", "ifs", "kp", "ki", "kd", "kpl", "kfca", "kfcv"),
)
_IN_RECORD = {f"rd{name}": name for name in _OF_RECORD} | {"rdjtvl": "jtv"}
_IN_RECORD |= {f"rdf.{name}": name for name in ("kp", "ki", "kd", "kpl", "kfca", "kfcv")}
_FIRST = 300  # common double in which the program keeps what it reads
_QUALIFIERS = [each.name for each in AXIS_QUALIFIERS.values() if not each.indexed and each.name != "lp"]
_SYSTEM = [each.name for each in SYSTEM_VARIABLES.values() if not each.indexed]
_PATHS: dict[str, tuple[type, tuple[str, ...]]] = {
    "ml": (pcap.LMP, ()),
    "mc": (pcap.CMP, ("phi", "dtca1", "dtca2")),
    "mh": (pcap.HMP, ("phi", "dtca1", "dtca2")),
    "3d": (pcap.HMP3D, ("phi", "dtca1", "dtca2", "dtca3", "pn1", "pn2", "pn3")),
}


def _arguments(name: str) -> str:
    return re.sub(r".*\(|\)", "", str(pcap.FUNCTIONS[name].prototype))


def _readers() -> Iterator[tuple[str, str, Callable[[int], float]]]:
    """Yield the registers: where they belong, what they are called, and what reads them."""
    for name in pcap.FUNCTIONS:
        if not name.startswith("rd") or name in _NOT_READ:
            continue
        call, taken = getattr(pcap, name), _arguments(name)
        if taken == "TSRP *tsrp":
            elements = (
                ["kp", "ki", "kd", "kpl", "kfca", "kfcv"]
                if name == "rdf"
                else [_ELEMENTS.get(name[2:], name[2:])]
            )
            for element in elements:
                yield "axis", name if len(elements) == 1 else f"{name}.{element}", _through(call, element)
        elif re.fullmatch(r"(int|long)( \*)? ?an, .* \*\w+", taken):
            yield "axis", name, partial(_of_axis, call)
        elif re.fullmatch(r"void|(long|double) \*\w+", taken):
            yield "board", name, partial(_of_board, call)


def _through(call: Callable[[Any], Any], element: str) -> Callable[[int], float]:
    def read(an: int) -> float:
        record = pcap.TSRP(an=an)
        call(record)
        return float(getattr(record, element))

    return read


def _of_axis(call: Callable[[int], Any], an: int) -> float:
    return _last(call(an))


def _of_board(call: Callable[[], Any], _: int) -> float:
    return _last(call())


def _last(value: Any) -> float:
    return float(value[-1] if isinstance(value, tuple) else value)


_NUMBER = re.compile(r"-?\d+(\.\d+)?(e[-+]\d+)?")
_READERS = list(_readers())


class Bench:
    """A board of a system file; `step` lets time pass, everything else is a call of the library."""

    def __init__(self, system: str = "", *, program: bool = False) -> None:
        self.board = Board(parse_system_file(system))
        pcap.attach(self.board, clock=None)
        pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "")
        self.interrupts: list[int] = []
        pcap.MCUG3_SetBoardIntRoutine(self.interrupts.append)
        self.tracks: dict[str, list[float]] = {}
        self.ends: list[int] = []
        self.told: list[float] = []
        self.read_by_program: list[str] = []
        if program:
            self._run_reader()

    def __getattr__(self, name: str) -> Callable[..., Any]:
        call, taken = getattr(pcap, name), _arguments(name)
        stem = name.removeprefix("s") if name.startswith("sm") else name
        if stem[:2] in _PATHS and re.match(r"m[lch][ar]", stem):
            return lambda *given, **rest: self._move(call, stem, *given, **rest)
        if taken == "AS *as":
            return lambda *axes: call(pcap.AS.of(*axes))
        if taken == "AS *as, TSRP *tsrp":
            return lambda targets: self._jog(call, targets)
        if taken == "TSRP *tsrp" and name.startswith("wr"):
            element = _ELEMENTS.get(name[2:], name[2:])
            return lambda an, value: call(pcap.TSRP(an=an, **{element: value}))
        if taken == "TSRP *tsrp":
            return lambda an, **given: call(pcap.TSRP(an=an, **given))
        return lambda *given: call(*given)

    def _jog(self, call: Callable[..., None], targets: Mapping[int, float]) -> None:
        records = pcap.tsrp_array()
        for an, target in targets.items():
            records[an].tp = target
        call(pcap.AS.of(*targets), records)

    def _move(
        self,
        call: Callable[..., None],
        stem: str,
        targets: Mapping[int, float] | tuple[int, ...],
        speeds: tuple[float, ...],
        *shape: float,
        index: int | None = None,
    ) -> None:
        kind, names = _PATHS["3d" if stem.endswith("3d") else stem[:2]]
        record = kind(
            **dict(zip(("ac", "vl", "tvl"), speeds, strict=False)), **dict(zip(names, shape, strict=True))
        )
        if isinstance(targets, Mapping):
            for an, target in targets.items():
                record.dtm[an] = target
        call(pcap.AS.of(*targets), record, *([] if index is None else [index]))

    def points(self, *values: float) -> pcap.SPDBUF:
        """Return a table of setpoints."""
        return pcap.SPDBUF(position=[*values, *[0.0] * (1000 - len(values))])

    def program(self, text: str, task: int = 0) -> None:
        """Load a program into a task and start it."""
        assert isinstance(self.board.tasks, BoardTasks)
        self.board.tasks.load(sap.compile_program(text, task=task))
        pcap.startcnct(task)

    def _run_reader(self) -> None:
        """Let task 3 read what programs can read, again and again."""
        names = [f"A{n + 1}.{name}" for n in range(len(self.board.axes)) for name in _QUALIFIERS] + _SYSTEM
        lines = "; ".join(f"CD[{_FIRST + k}] := {name}" for k, name in enumerate(names))
        self.read_by_program = names
        self.program(f"BEGIN WHILE TRUE DO BEGIN {lines} END END.", 3)

    def step(self, scans: int, every: int = 5) -> None:
        """Let scans pass and note all registers in every few of them; between, those of rdap come from there."""
        for left in range(scans // every - 1, -1, -1):
            self.board.advance(every)
            self._note(one_by_one=left == 0)
        self.ends.append(len(self.tracks["rdErrorReg"]))
        for an in range(len(self.board.axes)):
            self._compare(an, len(self.ends) % 4)

    def tell(self, *values: float) -> None:
        """Note what functions have returned."""
        self.told += values

    def _compare(self, an: int, quarter: int) -> None:
        """Look whether rdap and the functions for a quarter of the bits tell the same as those for one register."""
        pcap.rdap(record := pcap.TSRP(an=an))
        last = {
            name.split()[0][2:]: values[-1] for name, values in self.tracks.items() if name.endswith(f" {an}")
        }
        last |= {name[2:]: last[name] for name in last if name.startswith("f.")}
        for name in _OF_RECORD:
            assert (name, getattr(record, name)) == (name, last[name])
        assert record.jtv == last["jtvl"]
        for name in ("axst", "digi", "digo", "ifs"):
            bit = getattr(pcap, f"rd{name}b")
            word = int(last[name])
            for number in range(8 * quarter + 1, 8 * quarter + 9):
                assert (name, number, bit(an, number)) == (name, number, word >> number - 1 & 1)

    def _note(self, *, one_by_one: bool) -> None:
        def note(name: str, value: float) -> None:
            self.tracks.setdefault(name, []).append(value)

        for an in range(len(self.board.axes)):
            record = pcap.TSRP(an=an)
            if not one_by_one:
                pcap.rdap(record)
            for owner, name, read in _READERS:
                if owner == "axis":
                    known = not one_by_one and name in _IN_RECORD
                    note(f"{name} {an}", float(getattr(record, _IN_RECORD[name])) if known else read(an))
        for owner, name, read in _READERS:
            if owner == "board":
                note(name, read(0))
        state, tasks = self.board.state, [pcap.CNCTS() for _ in range(4)]
        pcap.rdci(1000, whole := pcap.CIBUF())
        pcap.rdcd(1000, real := pcap.CDBUF())
        for letter, variables in (("I", np.array(whole.ci)), ("D", np.array(real.cd[:_FIRST]))):
            for index in variables.nonzero()[0]:
                self.tracks.setdefault(f"C{letter}{index}", [0.0] * (len(self.tracks["rdErrorReg"]) - 1))
            for name in [each for each in self.tracks if each.startswith(f"C{letter}")]:
                note(name, float(variables[int(name[2:])]))
        note("interrupts", float(sum(self.interrupts)))
        for task, status in enumerate(tasks):
            pcap.rdcncts(task, status)
            elements = ("errnum", "errline", "running", "csrcline", "stackfree")
            for element in elements if task < 3 else ("running",):
                note(f"task {task} {element}", float(getattr(status, element)))
        for k, name in enumerate(self.read_by_program):
            note(f"SAP {name}", float(state.cd[_FIRST + k]))

    def text(self) -> list[str]:
        """Return what the registers have done; what stayed 0 stands in one line."""
        lines, idle = [], []
        for name, values in self.tracks.items():
            changes = sum(a != b for a, b in pairwise(values))
            if not changes and values[0] == 0.0:
                idle.append(name)
                continue
            total = sum(k * each for k, each in enumerate(values, 1))
            marks = " ".join(f"{values[end - 1]:.12g}" for end in self.ends)
            lines.append(
                f"{name}: {marks} / {changes} / {total:.12g}" if changes else f"{name}: {values[0]:.12g}"
            )
        if self.told:
            lines.append(f"told: {' '.join(f'{each:.12g}' for each in self.told)}")
        return [*lines, f"0: {', '.join(idle)}"]


def difference(found: list[str], wanted: list[str], near: Callable[[float], Any]) -> str:
    """Return the first line that is not as it is written down, whole numbers exactly; nothing if all are."""

    def alike(a: str, b: str) -> bool:
        if a == b or not (_NUMBER.fullmatch(a) and _NUMBER.fullmatch(b)):
            return a == b
        return any(mark in a + b for mark in ".e") and bool(float(a) == near(float(b)))

    for line, other in zip_longest(found, wanted, fillvalue=""):
        if not all(alike(a, b) for a, b in zip_longest(line.split(), other.split(), fillvalue="")):
            return f"{line} instead of {other}"
    return ""
