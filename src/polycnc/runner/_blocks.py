"""Which block every row of a record belongs to: read from the block records while they are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import overload

import numpy as np
import numpy.typing as npt

from polycnc.nc import CONTEXT_SHIFT, LINE_MASK, Action, BlockRecords, ProgramText
from polycnc.runner._zeros import NO_ZEROS, ZeroCollector, Zeros

_MOTIONS = {
    Action.RAPID: "rapid",
    Action.LINEAR: "line",
    Action.ARC_CW: "arc",
    Action.ARC_CCW: "arc",
    Action.CUBIC_SPLINE: "spline",
    Action.QUADRATIC_SPLINE: "spline",
    Action.NURBS: "spline",
}
KINDS = ("rapid", "line", "arc", "spline", "cycle", "other")
_FEW = 8  # blocks in a row with one context that are not worth arrays
_GROWTH = 64
_COLUMNS = np.dtype([("program", np.int32), ("line", np.int32), ("tool", np.int32), ("kind", np.uint8)])
_PAGE = 8  # bits of a line's number
_IN_PAGE = (1 << _PAGE) - 1


@dataclass(frozen=True, slots=True)
class ExecutedBlock:
    """A block that took time: its program, its line (from 1), the tool in the spindle, and how it moves.

    `kind` is one of `KINDS`; "cycle" is a drilling cycle.
    """

    program: str
    line: int
    tool: int
    kind: str


@dataclass(frozen=True, eq=False)
class Blocks(Sequence[ExecutedBlock]):
    """Hold executed blocks as columns: of a million of them nobody wants a million objects.

    `program` [blocks] are places in `names`, `kind` [blocks] places in `KINDS`.
    """

    names: tuple[str, ...]
    program: npt.NDArray[np.int32]
    line: npt.NDArray[np.int32]
    tool: npt.NDArray[np.int32]
    kind: npt.NDArray[np.uint8]

    def __len__(self) -> int:
        return len(self.line)

    def styles(self, number: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """Return for numbers of blocks an integer that changes with the tool and the kind of motion."""
        return self.kind[number] + len(KINDS) * self.tool[number].astype(np.int64)

    @overload
    def __getitem__(self, at: int) -> ExecutedBlock: ...
    @overload
    def __getitem__(self, at: slice) -> list[ExecutedBlock]: ...
    def __getitem__(self, at: int | slice) -> ExecutedBlock | list[ExecutedBlock]:
        if isinstance(at, slice):
            return [self[i] for i in range(*at.indices(len(self)))]
        name = self.names[self.program[at]]
        return ExecutedBlock(name, int(self.line[at]), int(self.tool[at]), KINDS[self.kind[at]])


class BlockTable:
    """Number the blocks of a run as they are executed; keep the texts that they stand in, by name."""

    def __init__(self) -> None:
        self.texts: dict[str, ProgramText] = {}
        self._names: dict[str, int] = {}
        self._rows = np.zeros(_GROWTH, _COLUMNS)
        self._count = 0
        # Numbers of blocks by program, tool, kind and line, many lines together; -1 for one that was not yet executed.
        self._numbers: dict[tuple[int, int, int, int], npt.NDArray[np.int32]] = {}

    def __len__(self) -> int:
        return self._count

    def blocks(self) -> Blocks:
        """Return the blocks so far."""
        rows = self._rows[: self._count]
        return Blocks(tuple(self._names), rows["program"], rows["line"], rows["tool"], rows["kind"])

    def styles(self, number: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """Return for numbers of blocks an integer that changes with the tool and the kind of motion."""
        return self.blocks().styles(number)

    def numbers(self, tags: npt.NDArray[np.int64], records: BlockRecords) -> npt.NDArray[np.int64]:
        """Return the numbers of the blocks that tags refer to."""
        found = np.empty(len(tags), np.int64)
        contexts = tags >> CONTEXT_SHIFT
        begins = np.flatnonzero(np.diff(contexts, prepend=~contexts[:1]))
        for begin, end in pairwise([*begins.tolist(), len(tags)]):
            text = records.source(int(tags[begin]))
            name = "" if text is None else text.name
            program = self._names.setdefault(name, len(self._names))
            if text is not None:
                self.texts.setdefault(name, text)
            tool = records.tool(int(tags[begin]))
            if end - begin < _FEW:
                for at, tag in enumerate(tags[begin:end].tolist(), start=begin):
                    kind = _kind(records.motion(tag))
                    found[at] = self._number(program, tag & LINE_MASK, tool, kind)
            else:
                lines = tags[begin:end] & LINE_MASK
                kinds = _KIND_OF_ACTION[records.motions(tags[begin:end])]
                found[begin:end] = self._many(program, lines, tool, kinds)
        return found

    def _number(self, program: int, line: int, tool: int, kind: int) -> int:
        numbers = self._page(program, tool, kind, line >> _PAGE)
        number = int(numbers[line & _IN_PAGE])
        if number < 0:
            number = self._count
            numbers[line & _IN_PAGE] = number
            self._add(np.array([(program, line, tool, kind)], _COLUMNS))
        return number

    def _many(
        self, program: int, lines: npt.NDArray[np.int64], tool: int, kinds: npt.NDArray[np.int64]
    ) -> npt.NDArray[np.int64]:
        found = np.empty(len(lines), np.int64)
        pages = (lines >> _PAGE) * len(KINDS) + kinds
        for page in np.unique(pages).tolist():
            numbers = self._page(program, tool, page % len(KINDS), page // len(KINDS))
            here = pages == page
            places = lines[here] & _IN_PAGE
            unknown = places[numbers[places] < 0]
            if len(unknown):
                new, first = np.unique(unknown, return_index=True)
                new = new[np.argsort(first)]
                numbers[new] = self._count + np.arange(len(new))
                rows = np.repeat(np.array([(program, 0, tool, page % len(KINDS))], _COLUMNS), len(new))
                rows["line"] = new + (page // len(KINDS) << _PAGE)
                self._add(rows)
            found[here] = numbers[places]
        return found

    def _page(self, program: int, tool: int, kind: int, page: int) -> npt.NDArray[np.int32]:
        key = program, tool, kind, page
        numbers = self._numbers.get(key)
        if numbers is None:
            numbers = self._numbers[key] = np.full(_IN_PAGE + 1, -1, np.int32)
        return numbers

    def _add(self, rows: npt.NDArray[np.void]) -> None:
        end = self._count + len(rows)
        if end > len(self._rows):
            grown = np.zeros(max(end, 2 * len(self._rows)), _COLUMNS)
            grown[: self._count] = self._rows[: self._count]
            self._rows = grown
        self._rows[self._count : end] = rows
        self._count = end


def _kind(motion: Action | None) -> int:
    return KINDS.index("other" if motion is None else _MOTIONS.get(motion, "cycle"))


_KIND_OF_ACTION = np.full(max(Action) + 1, _kind(None))
_KIND_OF_ACTION[list(Action)] = [_kind(action) for action in Action]


@dataclass(frozen=True)
class Execution:
    """Say which block was executed when.

    `start` [executions] is the first row of each execution, `number` [executions] the place of its block in `blocks`;
    `texts` are the programs by name, `zeros` where program zero lies.
    """

    start: npt.NDArray[np.int64]
    number: npt.NDArray[np.int64]
    blocks: Blocks
    texts: dict[str, ProgramText]
    zeros: Zeros = NO_ZEROS


def execution_by_lines(lines: npt.NDArray[np.int64]) -> Execution:
    """Return the execution of a record [rows] of which nothing but the line of each row is known."""
    begins = np.flatnonzero(np.diff(lines, prepend=~lines[:1]))
    line, number = np.unique(lines[begins], return_inverse=True)
    none = np.zeros(len(line), np.int32)
    blocks = Blocks(("",), none, line.astype(np.int32), none, np.full(len(line), _kind(None), np.uint8))
    return Execution(begins, number.astype(np.int64), blocks, {})


@dataclass(slots=True)
class ExecutionCollector:
    """Collect which block is executed from which row on."""

    table: BlockTable = field(default_factory=BlockTable)
    _zeros: ZeroCollector = field(default_factory=ZeroCollector)
    _starts: list[npt.NDArray[np.int64]] = field(default_factory=list)
    _numbers: list[npt.NDArray[np.int64]] = field(default_factory=list)
    _rows: int = 0
    _last: int | None = None
    _before: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))

    def add(self, tags: npt.NDArray[np.int64], records: BlockRecords) -> npt.NDArray[np.int64]:
        """Take the tags of the next rows; return the number of each row's block."""
        if not len(tags):
            return np.zeros(0, np.int64)
        starts = np.flatnonzero(np.diff(tags, prepend=~tags[:1] if self._last is None else self._last))
        numbers = self.table.numbers(tags[starts], records)
        self._zeros.add((starts + self._rows).tolist(), tags[starts], records)
        self._numbers.append(numbers)
        self._starts.append(starts + self._rows)
        self._rows += len(tags)
        self._last = int(tags[-1])
        before, self._before = self._before, numbers[-1:] if len(numbers) else self._before
        if not (len(starts) and starts[0] == 0):
            starts, numbers = np.append(np.zeros(1, np.int64), starts), np.append(before, numbers)
        return np.repeat(numbers, np.diff(starts, append=len(tags)))

    def execution(self) -> Execution:
        """Return everything collected."""
        none = np.zeros(0, np.int64)
        return Execution(
            np.concatenate([none, *self._starts]),
            np.concatenate([none, *self._numbers]),
            self.table.blocks(),
            dict(self.table.texts),
            self._zeros.zeros(),
        )
