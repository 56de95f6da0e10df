"""Which block each row of a record belongs to: columns against what the records say of every tag by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import polycnc
from polycnc.nc import LINE_MASK, Action, BlockRecords
from polycnc.runner import run, view_program
from polycnc.runner._blocks import ExecutedBlock, ExecutionCollector, execution_by_lines
from polycnc.runner.view import _listing, _track

KINDS = {Action.RAPID: "rapid", Action.LINEAR: "line", Action.ARC_CW: "arc", Action.ARC_CCW: "arc"}


def _program(blocks: int) -> str:
    """Return a program of many plain blocks: motions that change now and then, tools, a sub-program, a cycle."""
    lines = ["T4 M6", "G0 X3 Y5 Z2"]
    for i in range(blocks):
        x = 3 + (i * 7) % 40
        motion = ("G1", "", "", "G0", "", "G2", "", "G1", "")[i % 9]
        arc = " R30" if i % 9 in (5, 6) else ""
        lines.append(f"{motion} X{x + 0.5 * (i % 3)} Y{5 + i % 11}{arc} F{7000 + i % 5}")
        if i % 1500 == 700:
            lines += [f"T{5 + i // 1500} M6", "M98 P77 L3"]
    lines += [
        "G81 X11 Y4 Z-2 R1 F900",
        "X15",
        "G80",
        "M30",
        "O77",
        *(f"G1 X{2 + n} Y{9 - n}" for n in range(9)),
    ]
    return "\n".join([*lines, "M99", ""])


class _Both:
    """Take what a run records by columns, and by asking for each tag."""

    def __init__(self) -> None:
        self.collector = ExecutionCollector()
        self.numbers: list[npt.NDArray[np.int64]] = []
        self.said: list[ExecutedBlock] = []

    def add(self, rows: Any, tags: npt.NDArray[np.int64], records: BlockRecords) -> None:
        for first in range(0, len(tags), 777):
            part = tags[first : first + 777]
            self.numbers.append(self.collector.add(part, records))
            known = {tag: self._asked(tag, records) for tag in set(part.tolist())}
            self.said += [known[tag] for tag in part.tolist()]

    @staticmethod
    def _asked(tag: int, records: BlockRecords) -> ExecutedBlock:
        text, motion = records.source(tag), records.motion(tag)
        kind = "other" if motion is None else KINDS.get(motion, "cycle")
        return ExecutedBlock(text.name if text else "", tag & LINE_MASK, records.tool(tag), kind)


def test_columns_say_of_every_row_what_its_tag_says() -> None:
    both = _Both()
    result = run(_program(6_000), "vmc3", "fanuc", tagged_rows=both.add)
    assert result.ok
    number = np.concatenate(both.numbers)
    blocks = both.collector.table.blocks()
    of_number = list(blocks)
    assert [of_number[each] for each in number.tolist()] == both.said
    assert len(set(of_number)) == len(of_number) > 6_000  # each block has one number
    assert {each.kind for each in of_number} >= {"rapid", "line", "arc", "cycle"}
    assert {each.tool for each in of_number} >= {4, 5, 6, 7, 8}
    execution = both.collector.execution()
    assert (
        np.repeat(execution.number, np.diff(execution.start, append=len(number))).tolist() == number.tolist()
    )


def test_a_view_makes_no_object_for_each_block(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a program as long as you like nothing but columns is held."""

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a block as an object")

    monkeypatch.setattr("polycnc.runner._blocks.ExecutedBlock", refuse)
    monkeypatch.setattr(_listing, "_MOST_LINES", 500)
    monkeypatch.setattr(_track.TrackCollector.__init__, "__kwdefaults__", {"most": 400})
    view = view_program(_program(3_000), "vmc3", "fanuc")
    assert view.result.ok


def test_of_a_record_without_blocks_its_lines_are_known() -> None:
    execution = execution_by_lines(np.array([7, 7, 3, 3, 3, 7]))
    assert execution.start.tolist() == [0, 2, 5]
    assert [execution.blocks[each].line for each in execution.number.tolist()] == [7, 3, 7]
    assert execution.blocks[0:2] == [ExecutedBlock("", 3, 0, "other"), ExecutedBlock("", 7, 0, "other")]


@pytest.mark.parametrize(
    ("lines", "remark"),
    [
        (["(rough)", "X5 (not alone)", "Y3"], "rough"),
        (["(rough)", "; fine", "X5 ; not alone", "X7 (nor this)"], "fine"),
        (["N10 (with number)", "()", "X2(2)"], "with number"),
        (["X5 (a)", "Y3 ; b"], ""),
        (["(slots)", "(T3 flat 6 mm)", "(T4 drill 5 mm)"], "T3 flat 6 mm"),
        ([*(f"X{n} (no)" for n in range(40)), "(late)", *(f"Y{n}" for n in range(40))], "late"),
    ],
)
def test_the_last_remark_that_stands_alone_names_an_operation(lines: list[str], remark: str) -> None:
    text = "G0 Z5\n" + "\n".join(lines) + "\nT3 M6\nG1 X9 F900\nM30\n"
    assert [each.name for each in polycnc.run(text).operations] == [remark]
