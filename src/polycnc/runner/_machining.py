"""Cut a body by a run: the recorder's rows become the course of the tool, the course cuts the stock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from polycnc.errors import SourcePosition, UsageError
from polycnc.kernel import IS_RAPID, LEADING, TIME_S
from polycnc.machine import MachineConfig, RotaryAxis, ToolConfig
from polycnc.nc import CONTEXT_SHIFT, BlockRecords
from polycnc.runner._blocks import BlockTable, ExecutedBlock
from polycnc.runner._machined import Collision, IdleFeed, Machined
from polycnc.runner._stock_tools import tools_of
from polycnc.stock import Course, Cutting, Form, NoStockError, Rows, Tool, fixtures_of

Floats = npt.NDArray[np.float64]
_PLACES = ("X", "Y", "Z")


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
        turns = np.concatenate([records.spindle_directions(piece) for piece in pieces])
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
        target = form.target_of(stock)
        cutting = Cutting(stock, tools, fixtures_of(form.fixtures, stock.cell_mm), target)
        cutting.add(course)
        blocks = self._table.blocks()
        removed = np.zeros(len(blocks))
        known = cutting.by_block_mm3[: len(blocks)]
        removed[: len(known)] = known
        return Machined(
            stock=stock,
            blocks=blocks,
            removed_mm3=removed,
            by_tool_mm3=cutting.by_tool_mm3,
            collisions=[
                Collision(
                    each.kind, at.program, at.line, self._place(at), each.t_s, each.place, each.depth_mm
                )
                for each in cutting.contacts
                for at in [blocks[each.block]]
            ],
            idle=[
                IdleFeed(at.program, at.line, self._place(at), each.t_s, each.duration_s, each.place)
                for each in cutting.idle
                for at in [blocks[each.block]]
            ],
            idle_s=cutting.idle_s,
            comparison=None if target is None else target.compare(stock),
            messages=[
                f"stock: {stock.box}, {stock.cell_mm:g} mm a cell",
                *(
                    f"the shape of tool {number} is not known: it cuts nothing here"
                    for number in sorted(cutting.unknown_tools)
                ),
            ],
            form=form,
            course=course,
            tools=tools,
            zero_mm=(x, y, z),
        )
