"""Blocks of a record that comes in pieces: each has one number, in whatever pieces its rows come."""

from __future__ import annotations

from typing import cast

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.nc import LINE_MASK, Action, BlockRecords, ProgramText, Zero
from polycnc.nc.records._block_records import CONTEXT_SHIFT
from polycnc.runner._blocks import ExecutionCollector

PROGRAMS = (ProgramText.from_text("main", "main.nc"), ProgramText.from_text("sub", "sub.nc"), None)
MOTIONS = (Action.RAPID, Action.LINEAR, Action.ARC_CW, None)


class Records:
    """Programs by the context of a tag, tools by the context, motions by the line."""

    def source(self, tag: int) -> ProgramText | None:
        return PROGRAMS[(tag >> CONTEXT_SHIFT) % 3]

    def tool(self, tag: int) -> int:
        return 3 + (tag >> CONTEXT_SHIFT) // 3

    def zero(self, tag: int) -> Zero | None:
        return Zero((float((tag >> CONTEXT_SHIFT) // 2),))

    def motion(self, tag: int) -> Action | None:
        return MOTIONS[((tag & LINE_MASK) * 7) % 4]

    def motions(self, tags: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        found = [self.motion(tag) for tag in tags.tolist()]
        return np.array([0 if each is None else int(each) for each in found])


def tags() -> npt.NDArray[np.int64]:
    """Return tags of rows: blocks of several rows, contexts that change, lines far apart and lines that come again."""
    rng = np.random.default_rng(23)
    lines = np.concatenate(
        [np.arange(5, 905), rng.integers(1, 70_000, 400), np.arange(300, 340), np.array([7, 9])]
    )
    contexts = np.sort(rng.integers(0, 7, len(lines)))
    rows: npt.NDArray[np.int64] = np.repeat(
        lines + (contexts << CONTEXT_SHIFT), rng.integers(1, 5, len(lines))
    )
    return np.concatenate((rows, rows[::-1]))  # and all of it again, the other way round


@pytest.mark.parametrize("piece", [1, 13, 400, 100_000])
def test_a_block_has_one_number_in_whatever_pieces_it_comes(piece: int) -> None:
    records = Records()
    rows = tags()
    collector = ExecutionCollector()
    given: list[npt.NDArray[np.int64]] = []
    first = 0
    while first < len(rows):
        size = piece if len(given) % 3 else 11  # some are done one by one, others at once
        given.append(collector.add(rows[first : first + size], cast(BlockRecords, records)))
        first += size
    assert len(collector.add(rows[:0], cast(BlockRecords, records))) == 0
    number = np.concatenate(given)
    blocks = list(collector.table.blocks())
    assert len(set(blocks)) == len(blocks)
    kinds = {Action.RAPID: "rapid", Action.LINEAR: "line", Action.ARC_CW: "arc", None: "other"}
    for tag, at in zip(rows.tolist(), number.tolist(), strict=True):
        text = records.source(tag)
        block = blocks[at]
        assert (block.program, block.line) == ("" if text is None else text.name, tag & LINE_MASK)
        assert (block.tool, block.kind) == (records.tool(tag), kinds[records.motion(tag)])
    execution = collector.execution()
    assert np.repeat(execution.number, np.diff(execution.start, append=len(rows))).tolist() == number.tolist()
    changes = np.flatnonzero(np.diff(rows)) + 1
    assert execution.start.tolist() == [0, *changes.tolist()]
    assert execution.texts.keys() <= {"main.nc", "sub.nc"}
