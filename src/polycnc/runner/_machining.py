"""Cut a body by a run: the recorder's rows become the course of the tool, the course cuts the stock."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.errors import SourcePosition, UsageError
from polycnc.kernel import IS_RAPID, LEADING, TIME_S
from polycnc.machine import MachineConfig, ToolConfig
from polycnc.nc import CONTEXT_SHIFT, BlockRecords
from polycnc.runner._blocks import BlockTable, ExecutedBlock
from polycnc.runner._known_places import NOWHERE, without_doubtful, without_homing
from polycnc.runner._machined import Collision, IdleFeed, Machined
from polycnc.runner._rotation import tip_and_axis, turning_axes
from polycnc.runner._stock_tools import hand_tool, said_form, tools_of
from polycnc.runner._turning_tools import turning_tools_of
from polycnc.stock import (
    Course,
    Cutting,
    Form,
    Insert,
    Rows,
    Stock,
    Tally,
    Tool,
    Turned,
    TurnedCutting,
    TurnedTarget,
    TurningCutting,
    Voxels,
    fixtures_of,
    solid_fixtures_of,
    turned_fixtures_of,
)

Floats = npt.NDArray[np.float64]


_TURNS_STEP = 0.005
"""How much the spindle's speed changes before it counts as another one, as a part of it."""


class MachiningCollector:
    """Collect the course of the tool's tip over a run, in the coordinates of the work offset of the first cut.

    A tool hangs from the spindle, or from the turret, by its sizes in the machine file, whatever compensation does. A
    machine without Y is a lathe: its X is the distance from the axis, and Y of the course is 0.

    Raises:
        UsageError: a machine without X and Z.
    """

    def __init__(self, config: MachineConfig) -> None:
        self._lathe = "Y" not in config.axis_names
        self._names = ("X", "Z") if self._lathe else ("X", "Y", "Z")
        missing = [name for name in self._names if name not in config.axis_names]
        if missing:
            raise UsageError(
                f"machine '{config.name}' has no axis {missing[0]}: its stock cannot be cut",
                hint="Stock is cut on machines with X, Y and Z, and on lathes with X and Z.",
            )
        self._config = config
        self._turning = [LEADING + number for number, _ in turning_axes(config)]
        self._turned = False
        self._axes = [config.axis_names.index(name) for name in self._names]
        self._table = BlockTable()
        self._course = Course()
        self._zero: list[float] | None = None
        self.texts = self._table.texts
        self._said = ""  # about the form
        self._notes: list[str] = []
        self._came_down = False
        self._last_place: Floats | None = None

    def add(self, rows: Floats, tags: npt.NDArray[np.int64], records: BlockRecords) -> None:
        """Take a piece of the record."""
        if not len(rows):
            return
        self._turned = self._turned or bool(np.any(rows[:, self._turning] != 0.0))
        contexts = tags >> CONTEXT_SHIFT
        begins = np.flatnonzero(np.diff(contexts, prepend=~contexts[:1]))
        lengths = np.diff(begins, append=len(tags))
        found = [self._context(int(tag), records) for tag in tags[begins].tolist()]
        shift, tool = (np.repeat(np.array(column), lengths, axis=0) for column in zip(*found, strict=True))
        pieces = np.split(tags, begins[1:])
        starts = np.flatnonzero(np.diff(tags, prepend=~tags[:1]))
        block = np.repeat(self._table.numbers(tags[starts], records), np.diff(starts, append=len(tags)))
        position = rows[:, LEADING : LEADING + len(self._config.axes)]
        place = position[:, self._axes]
        parts = zip(pieces, np.split(place[:, 0], begins[1:]), strict=True)
        turns = np.concatenate([self._turns(piece, x_mm, records) for piece, x_mm in parts])
        rapid = rows[:, IS_RAPID] != 0.0
        if self._zero is None:
            cuts = np.flatnonzero(~rapid[1:] & np.any(place[1:] != place[:-1], axis=1))
            words = records.lasting_words(int(tags[cuts[0] + 1])) if len(cuts) else None
            if words is not None:
                offsets = [self._config.work_offset(name) for name in words.work]
                self._zero = [sum(offset[axis] for offset in offsets) for axis in self._axes]
        tool = self._without_start(place, rapid, tool)
        if self._lathe:
            place = np.insert(place, 1, 0.0, axis=1)
        tip, axis = place - shift, np.array([[0.0, 0.0, 1.0]])
        if self._turning:
            tip, axis = tip_and_axis(self._config, position, place, -shift)
        self._course.add(Rows(rows[:, TIME_S].copy(), tip, block, tool, rapid, turns, axis))

    def _turns(self, tags: npt.NDArray[np.int64], x_mm: Floats, records: BlockRecords) -> Floats:
        """Return how fast the spindle turns with rows of one context; in steps at constant surface speed."""
        turns, clamp = records.spindle_turns(tags), records.surface_clamp(int(tags[0]))
        zero = records.zero(int(tags[0]))
        if clamp is None or zero is None:
            return turns
        around_mm = 2.0 * np.pi * np.maximum(np.abs(x_mm - zero.offset[self._axes[0]]), 1e-6)
        rpm = np.minimum(np.abs(turns) * 1000.0 / around_mm, min(clamp, self._config.spindle.max_rpm))
        steps = np.rint(np.log(np.maximum(rpm, 1e-9)) / _TURNS_STEP)
        return np.where(np.abs(turns) > 1.0, np.sign(turns) * np.exp(_TURNS_STEP * steps), turns)

    def _without_start(
        self, place: Floats, rapid: npt.NDArray[np.bool_], tool: npt.NDArray[np.int64]
    ) -> npt.NDArray[np.int64]:
        """Return the tools with none where the machine has not come down yet: where it was before is not known."""
        if self._came_down:
            return tool
        height = place[:, 0 if self._lathe else -1]
        down = np.flatnonzero(height[1:] < height[:-1])
        self._came_down = len(down) > 0
        first = int(down[0]) + 1 if len(down) else len(tool)
        before = place[:1] if self._last_place is None else self._last_place
        self._last_place = place[-1:].copy()
        still = np.all(np.concatenate((before, place[:-1])) == place, axis=1)
        return np.where((rapid | still) & (np.arange(len(tool)) < first), NOWHERE, tool)

    def _with_hand_tool(
        self, course: Rows, tools: Mapping[int, Tool | Insert]
    ) -> Mapping[int, Tool | Insert]:
        """Return tools with the one that a program without a change of tools cuts with, if that can be read."""
        if 0 in tools or np.any(course.tool[~course.rapid] > 0):
            return tools
        rotating = {number: tool for number, tool in tools.items() if isinstance(tool, Tool)}
        tool = hand_tool(self.texts, rotating)
        if tool is None:
            return tools
        self._notes.append(f"no M6 brings a tool: the one that the program describes is taken, {tool}")
        return {**tools, 0: tool}

    def _context(self, tag: int, records: BlockRecords) -> tuple[list[float], int]:
        """Return how a block's tool hangs from the spindle, and its number."""
        words = records.lasting_words(tag)
        if words is None:
            return [0.0, 0.0, 0.0], 0
        tool = self._config.tools.get(words.tool, ToolConfig())
        length = tool.length_mm + tool.wear_length_mm
        if self._lathe:
            return [tool.x_mm + tool.wear_x_mm, tool.y_mm, length + tool.z_mm + tool.wear_z_mm], words.tool
        return [tool.x_mm, tool.y_mm, length], words.tool

    def _place(self, block: ExecutedBlock) -> SourcePosition | None:
        text = self.texts.get(block.program)
        return None if text is None or not block.line else text.line_position(block.line)

    def machined(self, form: Form, tools: Mapping[int, Tool | Insert] | None = None) -> Machined:
        """Cut the body that a form tells, with the tools that machine and programs describe if none are given.

        Raises:
            UsageError: a body that cannot be derived, or none that can be cut.
        """
        course, (x, y, z) = self._course.rows(), self._zero_mm()
        course = replace(course, tip=course.tip - (x, y, z))
        if z == 0.0 and not self._turned:
            course = without_homing(
                course, course.tip[:, 0 if self._lathe else 2], self._table.blocks(), self.texts
            )
        form, self._said = said_form(form, self.texts)
        if self._lathe:
            given = turning_tools_of(self._config, self.texts) if tools is None else tools
            bar = form.turned_body(course)
            wanted = None if form.target is None else TurnedTarget(Path(form.target), bar, form.tolerance_mm)
            turned = TurningCutting(bar, given, turned_fixtures_of(form.fixtures, bar.cell_mm), wanted)
            turned.add(course)
            found = self._what_was_cut(turned.stock, turned.tally, form, course, given)
            return found if wanted is None else replace(found, comparison=wanted.compare(bar))
        given = self._with_hand_tool(course, tools_of(self._config, self.texts)) if tools is None else tools
        mills = {number: tool for number, tool in given.items() if isinstance(tool, Tool)}
        undercuts = any(
            number in mills and mills[number].undercuts for number in np.unique(course.tool).tolist()
        )
        if self._turned or undercuts or isinstance(form.given, Voxels):
            if not self._turned:
                form = form.told(course, mills)
            if undercuts and form.target is not None:
                raise UsageError("a target with tools that undercut", hint="Leave it out.")
            body = form.voxels(course, mills)
            final = form.solid_target_of(body)
            solid = TurnedCutting(body, mills, solid_fixtures_of(form.fixtures, body.cell_mm), final)
            solid.add(course)
            found = self._what_was_cut(solid.stock, solid.tally, form, course, given)
            return found if final is None else replace(found, comparison=final.compare(body))
        stock = form.body(course, mills)
        target = form.target_of(stock)
        cutting = Cutting(stock, mills, fixtures_of(form.fixtures, stock.cell_mm), target)
        cutting.add(course)
        found = self._what_was_cut(stock, cutting.tally, form, course, given)
        return found if target is None else replace(found, comparison=target.compare(stock))

    def _zero_mm(self) -> tuple[float, float, float]:
        first, *others = self._zero or [0.0] * len(self._names)
        return (first, 0.0, others[0]) if self._lathe else (first, others[0], others[1])

    def _what_was_cut(
        self,
        stock: Stock | Turned | Voxels,
        tally: Tally,
        form: Form,
        course: Rows,
        tools: Mapping[int, Tool | Insert],
    ) -> Machined:
        blocks = self._table.blocks()
        removed = np.zeros(len(blocks))
        counted = tally.by_block_mm3[: len(blocks)]
        removed[: len(counted)] = counted
        missed = "" if removed.any() or tally.unknown_tools else self._missed(stock, course)
        contacts = tally.contacts.all()
        known = without_doubtful(contacts, course, tally.unknown_tools)
        doubt = (
            f"{len(contacts) - len(known)} collisions are not reported: tools of unknown shape have cut there"
        )
        return Machined(
            stock=stock,
            blocks=blocks,
            removed_mm3=removed,
            by_tool_mm3=dict(tally.by_tool_mm3),
            engagement=tally.engaged.all(),
            collisions=[
                Collision(
                    each.kind, at.program, at.line, self._place(at), each.t_s, each.place, each.depth_mm
                )
                for each in known
                for at in [blocks[each.block]]
            ],
            idle=[
                IdleFeed(at.program, at.line, self._place(at), each.t_s, each.duration_s, each.place)
                for each in tally.idle
                for at in [blocks[each.block]]
            ],
            idle_s=tally.idle_s,
            comparison=None,
            messages=[
                f"stock: {stock}, {stock.cell_mm:.4g} mm a cell{self._said}",
                *_too_wide(stock.cell_mm, tools, tally.by_tool_mm3),
                *self._notes,
                *map(self._cuts_nothing, sorted(tally.unknown_tools)),
                *([doubt] if len(known) < len(contacts) else []),
                *([missed] if missed else []),
            ],
            form=form,
            course=course,
            tools=tools,
            zero_mm=self._zero_mm(),
            missed=missed,
        )

    def _cuts_nothing(self, tool: int) -> str:
        if tool == 0:
            where, words = ("turret", "T0101, or T and M6,") if self._lathe else ("spindle", "T and M6")
            return (
                f"no tool is in the {where} in some cuts: nothing is removed there; program {words} before them,"
                f" or say the one that is there in a comment like {self._shape(1)}"
            )
        if not self._lathe and isinstance(turning_tools_of(self._config, self.texts).get(tool), Insert):
            return (
                f"tool {tool} turns, and '{self._config.name}' has a Y axis: it cuts nothing here; run the program"
                " on a lathe, like --machine lathe2"
            )
        return (
            f"the shape of tool {tool} is not known: it cuts nothing here; a comment like {self._shape(tool)}"
            " or [tools] of the machine file tells it"
        )

    def _shape(self, tool: int) -> str:
        return f"(T{tool} CNMG120408)" if self._lathe else f"(T{tool} D=10)"

    def _missed(self, stock: Stock | Turned | Voxels, course: Rows) -> str:
        """Say where a body lies that no tool has met, and where they have cut; nothing if they have not."""
        cuts = np.flatnonzero(~course.rapid[1:] & np.any(course.tip[1:] != course.tip[:-1], axis=1))
        if not len(cuts):
            return ""
        tips = np.concatenate((course.tip[cuts], course.tip[cuts + 1]))
        low, high = tips.min(axis=0).tolist(), tips.max(axis=0).tolist()
        lies, cut = (
            ", ".join(f"{name}{a:.5g} to {name}{b:.5g}" for name, a, b in zip("XYZ", *ends, strict=True))
            for ends in ((stock.box.low, stock.box.high), (low, high))
        )
        return f"no tool meets the stock: it lies at {lies}, and they cut at {cut} (mm from the work offset)"


def _too_wide(cell_mm: float, tools: Mapping[int, Tool | Insert], cut: Iterable[int]) -> list[str]:
    """Return what to say where a tool that has cut is less than two cells wide."""
    mills = ((number, tool.diameter_mm) for number in cut if isinstance(tool := tools.get(number), Tool))
    number, diameter_mm = min(mills, key=lambda each: each[1], default=(0, math.inf))
    if diameter_mm >= 2.0 * cell_mm:
        return []
    return [
        f"cells of {cell_mm:g} mm are wide for tool {number} of {diameter_mm:g} mm: volumes and depths are rough"
    ]
