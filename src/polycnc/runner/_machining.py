"""Cut a body by a run: the recorder's rows become the course of the tool, the course cuts the stock."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.errors import SourcePosition, UsageError
from polycnc.kernel import IS_RAPID, LEADING, TIME_S
from polycnc.machine import MachineConfig, RotaryAxis, ToolConfig
from polycnc.nc import CONTEXT_SHIFT, BlockRecords, ProgramText
from polycnc.runner._blocks import Blocks, BlockTable, ExecutedBlock
from polycnc.stock import (
    ContactKind,
    Course,
    Cutting,
    Form,
    NoStockError,
    Rows,
    Stock,
    Tool,
    ToolKind,
    tool_number,
    tool_of_remark,
)

Floats = npt.NDArray[np.float64]
_PLACES = ("X", "Y", "Z")
_REMARK_OR_TOOL = re.compile(rb"\(([^)\r\n]*)\)|;([^\r\n]*)|[Tt][ \t]*0*([0-9]+)")
_INCH = re.compile(rb"[Gg]0*20(?![0-9.])")


@dataclass(frozen=True, slots=True)
class Collision:
    """Say what went wrong in a block: kind, program and line (from 1), when first, and where it was how deep (mm).

    `position` is the block's place in its text, None where that is not known.
    """

    kind: ContactKind
    program: str
    line: int
    position: SourcePosition | None
    t_s: float
    place: tuple[float, float, float]
    depth_mm: float

    def __str__(self) -> str:
        place = " ".join(f"{name}{value:.3f}" for name, value in zip(_PLACES, self.place, strict=True))
        return f"{self.kind}, {self.depth_mm:.3f} mm deep at {place}"


@dataclass(frozen=True, eq=False)
class Machined:
    """Hold what a run left of a body: the stock, volumes (mm3) in all, by block and by tool, and what went wrong.

    `removed_mm3` [blocks] belongs to `blocks`. `messages` say what was assumed. The body of `form` was cut by `tools`
    on their `course`, from `zero_mm` in machine coordinates.
    """

    stock: Stock
    blocks: Blocks
    removed_mm3: Floats
    by_tool_mm3: Mapping[int, float]
    collisions: list[Collision]
    messages: list[str]
    form: Form
    course: Rows
    tools: Mapping[int, Tool]
    zero_mm: tuple[float, float, float]

    @property
    def volume_mm3(self) -> float:
        """What all blocks have removed."""
        return float(self.removed_mm3.sum())

    def as_dict(self) -> dict[str, Any]:
        """Return sizes, volumes and collisions as plain data for JSON; lines are those of the programs."""
        lines: dict[tuple[str, int], float] = {}
        for number in np.flatnonzero(self.removed_mm3).tolist():
            block = self.blocks[number]
            key = block.program, block.line
            lines[key] = lines.get(key, 0.0) + float(self.removed_mm3[number])
        return {
            "low_mm": list(self.stock.box.low),
            "high_mm": list(self.stock.box.high),
            "cell_mm": self.stock.cell_mm,
            "volume_mm3": self.stock.volume_mm3,
            "removed_mm3": self.volume_mm3,
            "removed_by_tool_mm3": {str(tool): volume for tool, volume in self.by_tool_mm3.items()},
            "removed_by_line_mm3": [
                {"program": program, "line": line, "volume_mm3": volume}
                for (program, line), volume in lines.items()
            ],
            "collisions": [
                {
                    "kind": each.kind.name.lower(),
                    "text": str(each),
                    "program": each.program,
                    "line": each.line,
                    "time_s": each.t_s,
                    "place_mm": list(each.place),
                    "depth_mm": each.depth_mm,
                }
                for each in self.collisions
            ],
        }


class MachiningCollector:
    """Collect the course of the tool's tip over a run, in the coordinates of the work offset of the first cut.

    A tool hangs from the spindle by its length in the machine file, whatever compensation does.

    Raises:
        UsageError: a machine without X, Y and Z.
    """

    def __init__(self, config: MachineConfig) -> None:
        missing = [name for name in _PLACES if name not in config.axis_names]
        if missing:
            raise UsageError(
                f"machine '{config.name}' has no axis {missing[0]}: its stock cannot be cut",
                hint="Stock is cut on machines with X, Y and Z.",
            )
        self._config = config
        self._turning = [
            (LEADING + index, axis.name)
            for index, axis in enumerate(config.axes)
            if isinstance(axis, RotaryAxis) and axis.carries != "nothing"
        ]
        self._turned = ""
        self._axes = [config.axis_names.index(name) for name in _PLACES]
        self._table = BlockTable()
        self._course = Course()
        self._zero: list[float] | None = None
        self.texts = self._table.texts

    def add(self, rows: Floats, tags: npt.NDArray[np.int64], records: BlockRecords) -> None:
        """Take a piece of the record."""
        if not len(rows):
            return
        for column, name in self._turning:
            if not self._turned and np.any(rows[:, column] != 0.0):
                self._turned = name
        contexts = tags >> CONTEXT_SHIFT
        begins = np.flatnonzero(np.diff(contexts, prepend=~contexts[:1]))
        lengths = np.diff(begins, append=len(tags))
        found = [self._context(int(tag), records) for tag in tags[begins].tolist()]
        shift, tool = (np.repeat(np.array(column), lengths, axis=0) for column in zip(*found, strict=True))
        pieces = np.split(tags, begins[1:])
        turns = np.concatenate([records.spindle_turns(piece) for piece in pieces])
        starts = np.flatnonzero(np.diff(tags, prepend=~tags[:1]))
        block = np.repeat(self._table.numbers(tags[starts], records), np.diff(starts, append=len(tags)))
        place = rows[:, LEADING : LEADING + len(self._config.axes)][:, self._axes]
        rapid = rows[:, IS_RAPID] != 0.0
        if self._zero is None:
            cuts = np.flatnonzero(~rapid[1:] & np.any(place[1:] != place[:-1], axis=1))
            words = records.lasting_words(int(tags[cuts[0] + 1])) if len(cuts) else None
            if words is not None:
                offsets = [self._config.work_offset(name) for name in words.work]
                self._zero = [sum(offset[axis] for offset in offsets) for axis in self._axes]
        tip = place - shift
        self._course.add(Rows(rows[:, TIME_S].copy(), tip, block, tool, rapid, turns))

    def _context(self, tag: int, records: BlockRecords) -> tuple[list[float], int]:
        """Return how a block's tool hangs from the spindle, and its number."""
        words = records.lasting_words(tag)
        if words is None:
            return [0.0, 0.0, 0.0], 0
        tool = self._config.tools.get(words.tool, ToolConfig())
        return [0.0, 0.0, tool.length_mm + tool.wear_length_mm], words.tool

    def _place(self, block: ExecutedBlock) -> SourcePosition | None:
        text = self.texts.get(block.program)
        return None if text is None or not block.line else text.line_position(block.line)

    def machined(self, form: Form, tools: Mapping[int, Tool] | None = None) -> Machined:
        """Cut the body that a form tells, with the tools that machine and programs describe if none are given.

        Raises:
            UsageError: a body that cannot be derived, or none that can be cut.
        """
        if self._turned:
            raise NoStockError(
                f"axis {self._turned} turns the part or the tool: stock is cut on three axes only",
                hint="Run the program without stock.",
            )
        if tools is None:
            tools = tools_of(self._config, self.texts)
        course = self._course.rows()
        x, y, z = self._zero or [0.0, 0.0, 0.0]
        course = replace(course, tip=course.tip - (x, y, z))
        stock = form.body(course, tools)
        cutting = Cutting(stock, tools)
        messages = [f"stock: {stock.box}, {stock.cell_mm:g} mm a cell"]
        cutting.add(course)
        messages += [
            f"the shape of tool {number} is not known: it cuts nothing here"
            for number in sorted(cutting.unknown_tools)
        ]
        blocks = self._table.blocks()
        collisions = [
            Collision(each.kind, at.program, at.line, self._place(at), each.t_s, each.place, each.depth_mm)
            for each in cutting.contacts
            for at in [blocks[each.block]]
        ]
        removed = np.zeros(len(blocks))
        known = cutting.by_block_mm3[: len(blocks)]
        removed[: len(known)] = known
        volumes = cutting.by_tool_mm3
        return Machined(stock, blocks, removed, volumes, collisions, messages, form, course, tools, (x, y, z))


def tools_of(config: MachineConfig, texts: Mapping[str, ProgramText]) -> dict[int, Tool]:
    """Return the tools that the machine file and the remarks of the programs describe; remarks come first."""
    tools = {}
    for number, each in config.tools.items():
        described = tool_of_remark(each.description)
        if described is not None:
            tools[number] = described
        elif each.radius_mm > 0.0:
            tools[number] = Tool(ToolKind.FLAT, 2.0 * each.radius_mm)
    for text in texts.values():
        inch = _INCH.search(text.content) is not None
        for number, remark in _remarks_of_tools(text):
            if (found := tool_of_remark(remark, inch=inch)) is not None:
                tools[number] = found
    return tools


def _remarks_of_tools(text: ProgramText) -> Iterator[tuple[int, str]]:
    """Yield numbers of tools with remarks: those that name them, and the last one before a T word."""
    last = ""
    for found in _REMARK_OR_TOOL.finditer(text.content):
        if found[3] is not None:
            if last:
                yield int(found[3][:9]), last
            continue
        remark = (found[1] or found[2] or b"").decode("utf-8", "replace")
        named = tool_number(remark)
        if named is not None:
            yield named, remark
        last = "" if named is not None else remark
