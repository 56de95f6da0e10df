"""Which block every row of a record belongs to: read from the block records while they are known."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from polycnc.nc import LINE_MASK, Action, BlockRecords, ProgramText

_MOTIONS = {
    Action.RAPID: "rapid",
    Action.LINEAR: "line",
    Action.ARC_CW: "arc",
    Action.ARC_CCW: "arc",
    Action.CUBIC_SPLINE: "spline",
    Action.QUADRATIC_SPLINE: "spline",
}
KINDS = ("rapid", "line", "arc", "spline", "cycle", "other")


@dataclass(frozen=True, slots=True)
class ExecutedBlock:
    """A block that took time: its program, its line (from 1), the tool in the spindle, and how it moves.

    `kind` is one of `KINDS`; "cycle" is a drilling cycle.
    """

    program: str
    line: int
    tool: int
    kind: str


@dataclass(slots=True)
class BlockTable:
    """Number the blocks of a run as they are executed; keep the texts that they stand in, by name."""

    blocks: list[ExecutedBlock] = field(default_factory=list)
    texts: dict[str, ProgramText] = field(default_factory=dict)
    _numbers: dict[ExecutedBlock, int] = field(default_factory=dict)

    def number(self, tag: int, records: BlockRecords) -> int:
        """Return the number of the block that a tag refers to."""
        text = records.source(tag)
        name = "" if text is None else text.name
        motion = records.motion(tag)
        kind = "other" if motion is None else _MOTIONS.get(motion, "cycle")
        block = ExecutedBlock(name, tag & LINE_MASK, records.tool(tag), kind)
        number = self._numbers.get(block)
        if number is None:
            number = self._numbers[block] = len(self.blocks)
            self.blocks.append(block)
            if text is not None:
                self.texts.setdefault(name, text)
        return number


@dataclass(frozen=True)
class Execution:
    """Say which block was executed when.

    `start` [executions] is the first row of each execution, `number` [executions] the place of its block in `blocks`;
    `texts` are the programs by name.
    """

    start: npt.NDArray[np.int64]
    number: npt.NDArray[np.int64]
    blocks: tuple[ExecutedBlock, ...]
    texts: dict[str, ProgramText]


@dataclass(slots=True)
class ExecutionCollector:
    """Collect which block is executed from which row on."""

    table: BlockTable = field(default_factory=BlockTable)
    _starts: list[npt.NDArray[np.int64]] = field(default_factory=list)
    _numbers: list[int] = field(default_factory=list)
    _rows: int = 0
    _last: int | None = None

    def add(self, tags: npt.NDArray[np.int64], records: BlockRecords) -> npt.NDArray[np.int64]:
        """Take the tags of the next rows; return the number of each row's block."""
        if not len(tags):
            return np.zeros(0, np.int64)
        before = self._numbers[-1:]
        starts = np.flatnonzero(np.diff(tags, prepend=tags[:1] if self._last is None else self._last))
        if self._last is None:
            starts = np.concatenate((np.zeros(1, np.int64), starts))
        numbers = [self.table.number(tag, records) for tag in tags[starts].tolist()]
        self._numbers += numbers
        self._starts.append(starts + self._rows)
        self._rows += len(tags)
        self._last = int(tags[-1])
        if before and not (len(starts) and starts[0] == 0):
            starts, numbers = np.concatenate((np.zeros(1, np.int64), starts)), before + numbers
        return np.repeat(np.array(numbers, np.int64), np.diff(starts, append=len(tags)))

    def execution(self) -> Execution:
        """Return everything collected."""
        starts = np.concatenate(self._starts) if self._starts else np.zeros(0, np.int64)
        return Execution(
            starts, np.array(self._numbers, np.int64), tuple(self.table.blocks), dict(self.table.texts)
        )
