"""Drive a control file's macros by the records of a tool path: each event calls its macro, once, in order.

The driver keeps what events need to know of one another: where the tool is, feed, tool, spindle, cycle. What it
gives to macros is documented in `_events`. Moves and holes have files of their own.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from polycnc.post.macros._control_file import ControlFile
from polycnc.post.macros._events import MOST_NUMBERS, word_macros
from polycnc.post.output._coming import SPINDLE_STATES, Coming, turned
from polycnc.post.output._drilling import Drilling
from polycnc.post.output._idle_macros import idle_macros
from polycnc.post.output._motion import Motion
from polycnc.post.output._output import Output
from polycnc.post.tool_path._course import Act, Course, CourseError, Hole, Straight, Turn
from polycnc.post.tool_path._needed import Needed
from polycnc.post.tool_path._records import (
    Axis,
    Circle,
    Compensation,
    Coolant,
    Cycle,
    CycleOff,
    Delta,
    Dwell,
    End,
    Feed,
    From,
    Goto,
    Home,
    Path,
    Points,
    Rapid,
    Retract,
    Spindle,
    Stop,
    Text,
    Thread,
    Tool,
    ToolShape,
    Word,
    WorkOffset,
)
from polycnc.post.tool_path._source import Remark
from polycnc.post.tool_path._tool_path import ToolPath

Progress = Callable[[float], None]

_CHUNK_RECORDS = 4096


@dataclass(frozen=True, slots=True)
class PostSummary:
    """What was written: blocks, records that were read, lengths of the moves, arcs, holes, and remarks."""

    blocks: int
    records: int
    feed_mm: float
    rapid_mm: float
    arcs: int
    holes: int
    tools: int
    remarks: tuple[Remark, ...]


@dataclass(slots=True)
class BlockMap:
    """Say for each line of the program which record of the tool path, and which line, it came from.

    Entry r is for record r, from 0: its last block, and its line. One more is for what ends the program, with line 0.
    `tool_mm` is the length of the tool at each record, if a head of the control file turns it; otherwise it is empty.
    """

    last_block: array[int] = field(default_factory=lambda: array("i"))
    line: array[int] = field(default_factory=lambda: array("i"))
    tool_mm: array[float] = field(default_factory=lambda: array("d"))

    def add(self, last_block: int, line: int) -> None:
        """Say that the blocks up to `last_block`, from where the last entry ended, came from `line`."""
        self.last_block.append(last_block)
        self.line.append(line)


def post_program(
    tool_path: ToolPath,
    control: ControlFile,
    out: Callable[[str], object],
    *,
    progress: Progress | None = None,
    block_map: BlockMap | None = None,
) -> PostSummary:
    """Write the program of a tool path: `out` gets its text in pieces of whole lines.

    `progress` is called now and then with the part that is done, 0 to 1. `block_map` is filled with the origin of
    each block that moves.

    Raises:
        ProgramError: the tool path or the control file asks for what cannot be posted.
    """
    output = Output(control, tool_path, out)
    driver = _Driver(output, Coming.of(tool_path, control))
    handlers = driver.handlers()
    records = 0
    has_head = driver.motion.has_head
    flushed = 0
    for record in tool_path.runs():
        if isinstance(record, Points):
            records += len(record.xyz)
            driver.points(record, block_map)
        else:
            records += 1
            handlers[record.__class__](record)
            if block_map is not None:
                block_map.add(output.blocks, record.line)
        if has_head and block_map is not None:
            block_map.tool_mm.extend(
                [driver.motion.tool_length_mm or 0.0] * (records - len(block_map.tool_mm))
            )
        if records - flushed >= _CHUNK_RECORDS:
            flushed = records
            output.flush()
            if progress is not None:
                progress(tool_path.part_read)
        if record.__class__ is End:
            break
    last_of_path = output.blocks
    driver.end()
    if block_map is not None and output.blocks > last_of_path:
        block_map.add(output.blocks, 0)
        if has_head:
            block_map.tool_mm.append(driver.motion.tool_length_mm or 0.0)
    output.flush()
    motion = driver.motion
    if motion.tangency.mostly_kinked:
        output.remark(motion.tangency.first_kink, motion.tangency.text())
    for text in idle_macros(control, motion.arcs):
        output.remark(0, text)
    return PostSummary(
        blocks=output.blocks,
        records=records,
        feed_mm=motion.feed_mm,
        rapid_mm=motion.rapid_mm,
        arcs=motion.arcs,
        holes=driver.drilling.holes,
        tools=driver.tools,
        remarks=tuple(tool_path.remarks.all()),
    )


_COOLANT_STATES = {"mist": 7.0, "flood": 8.0, "through": 88.0, "off": 9.0}


class _Driver:
    """One program: the frame of program, operations and tools around its moves."""

    def __init__(self, output: Output, coming: Coming) -> None:
        self.output = output
        self._coming = coming
        self._spindles = 0
        self.motion = Motion(output)
        self.drilling = Drilling(output, self.motion)
        self.course = Course()
        self.tools = 0
        self._part = self._machine = ""
        self._path = ""
        self._path_number = 0
        self._started = self._in_path = False
        self._shape = ToolShape(0, "", 0.0, 0.0)
        self._said = ToolShape(0)  # of the tool that comes next
        self._tool_number = 0
        self._turning: Spindle | None = None
        # With the number of tool changes before them: what came before the last one must be said again.
        self._spindle_words: tuple[str, dict[str, float | str], int] | None = None
        self._coolant_mode: tuple[str, int] = ("off", 0)
        self._resumes = False
        self._needed = Needed()

    def handlers(self) -> dict[type[Any], Callable[[Any], None]]:
        """Return the function for each kind of record."""
        return {
            Text: self._text,
            Path: self._path_record,
            WorkOffset: self._work_offset_record,
            ToolShape: self._tool_shape,
            Tool: self._working(self._tool),
            Spindle: self._working(self._spindle),
            Feed: self.motion.set_feed,
            Rapid: self._note,
            From: self._stands,
            Axis: self._note,
            Goto: self._goto,
            Delta: self._working(self._move),
            Home: self._working(self._move),
            Retract: self._working(self._move),
            Circle: self._working(self._move),
            Cycle: self._working(self._cycle),
            CycleOff: self._working(self._cycle_off),
            Thread: self._thread,
            Coolant: self._working(self._coolant),
            Compensation: self._working(self._compensation),
            Dwell: self._working(self._dwell),
            Stop: self._working(self._stop),
            Word: self._word,
            End: self._end_record,
        }

    def end(self) -> None:
        """End the program."""
        self._begin()
        self.drilling.close()
        self._end_path()
        self.output.frame("PROGRAM_END")

    def _working(self, handler: Callable[[Any], None]) -> Callable[[Any], None]:
        """Return `handler` for a record that belongs to an operation."""

        def work(record: Any) -> None:
            if not self._in_path:
                self._begin_path()
            handler(record)

        return work

    def _begin(self) -> None:
        if not self._started:
            self._started = True
            units = 20.0 if self.output.parameters.units == "inch" else 21.0
            words: dict[str, float | str] = {
                "PARTNAME": self._part,
                "MACHINENAME": self._machine,
                "UNITS": units,
            }
            self.output.keep(SPINDLESTATE=5.0, COOLANTSTATE=9.0, WORKOFFSET=float(self.course.work_offset))
            self._keep_coming()
            self.motion.first(2.0)
            self.output.frame("PROGRAM_START", words)

    def _keep_coming(self) -> None:
        self.output.keep(**self._coming.words(self.tools, self._spindles))

    def _begin_path(self) -> None:
        self._begin()
        self._in_path = True
        self._path_number += 1
        self.motion.first(1.0)
        self.output.frame("PATH_START", self._path_words())

    def _end_path(self) -> None:
        if self._in_path:
            self._in_path = False
            self.drilling.close()
            self.output.frame("PATH_END", self._path_words())

    def _path_words(self) -> dict[str, float | str]:
        return {"PATHNAME": self._path, "PATHNUMBER": float(self._path_number)}

    def _path_record(self, record: Path) -> None:
        self._end_path()
        self._path = _plain(record.name or "")
        before = self.course.work_offset
        self._take(record)
        if self.course.work_offset != before:
            self._work_offset(record.line)

    def _work_offset_record(self, record: WorkOffset) -> None:
        if record.frame and self.output.parameters.coordinate_systems != "work_offsets":
            raise self.output.fail(
                record.line,
                "the coordinate system changes within the tool path",
                "Let the CAM system write one tool path for each. If the points of each count from its own zero, "
                'coordinate_systems = "work_offsets" in the control file makes the first G54, the next G55.',
            )
        before = self.course.work_offset
        self._take(record)
        if self.course.work_offset != before:
            self.drilling.close()
            self._work_offset(record.line)

    def _work_offset(self, line: int) -> None:
        """Take another work offset: nothing that was written before says where the tool is in it."""
        control = self.output.control
        by_event = control.has("WORK_OFFSET")
        if not by_event and (self._in_path or not control.names("WORKOFFSET")):
            raise self.output.fail(
                line,
                f"work offset {self.course.work_offset}, and no macro of the control file writes WORKOFFSET",
                "Write it in the macro WORK_OFFSET, or leave work offsets out of the tool path.",
            )
        self.output.keep(WORKOFFSET=float(self.course.work_offset))
        if by_event:
            self._begin()
            blocks = self.output.blocks
            self.output.call("WORK_OFFSET", {})
            if self.output.blocks == blocks:
                raise self.output.fail(
                    line,
                    "the macro WORK_OFFSET of the control file writes nothing for work offset "
                    f"{self.course.work_offset}",
                    "Add it there, or leave it out of the tool path.",
                )
        self.motion.set_position(None)
        self.output.forget("X", "Y", "Z")
        self.motion.first(2.0)
        self.motion.moved_by_macro()

    def _end_record(self, record: End) -> None:
        """Nothing: the end of the tool path follows."""

    def _text(self, record: Text) -> None:
        text = _plain(record.text)
        if record.kind == "part":
            self._part = text
        elif record.kind == "machine":
            self._machine = text
        else:
            if not self._in_path:
                self._begin_path()
            if record.kind == "comment":
                self.output.frame("COMMENT", {"COMMENT": text})
            else:
                self.drilling.close()
                self.output.state("INSERT", record.line, {"COMMENT": record.text})

    def _tool_shape(self, record: ToolShape) -> None:
        name = None if record.name is None else _plain(record.name)
        new = ToolShape(record.line, name, record.diameter, record.length)
        self._shape, self._said = _over(self._shape, new), _over(self._said, new)

    def _tool(self, record: Tool) -> None:
        self._take(record)
        self.drilling.close()
        self._resumes = True
        self._needed.tool_changed()
        self.motion.thread(None)
        self._tool_shape(ToolShape(record.line, record.name, None, record.length))
        self.tools += 1
        before, self._tool_number = float(self._tool_number), record.number
        # What was said of an earlier tool does not hold for this one, nor the length of one that was changed since.
        if float(record.number) != before:
            self._shape = self._said
        self.motion.tool_length_mm = self._said.length
        self._said = ToolShape(record.line)
        self._keep_coming()
        self.motion.first(2.0)
        number = float(record.number)
        scale = self.output.scale
        words: dict[str, float | str] = {
            "T": number,
            "TOOLCHANGE": self.output.formatted("T", number),
            "TOOLNAME": self._shape.name or "",
            "TOOLDIAMETER": (self._shape.diameter or 0.0) * scale,
            "TOOLLENGTH": (self._shape.length or 0.0) * scale,
            "H": number if record.h is None else float(record.h),
            "D": number if record.d is None else float(record.d),
        }
        if self.tools > 1 and number != before and not self.output.control.has("TOOL_CHANGE"):
            raise self.output.fail(
                record.line,
                f"another tool, {record.number}, and the control file has no macro TOOL_CHANGE",
                "Add TOOL_CHANGE to its [nc_macros], or make a tool path of its own for each tool.",
            )
        self.output.state("TOOL_CHANGE", record.line, words)
        self.motion.tool_changed()

    def _spindle(self, record: Spindle) -> None:
        self.drilling.close()
        if record.sense == "off":
            self._spindle_words = None
            self.output.keep(SPINDLESTATE=SPINDLE_STATES["off"])
            self.output.state("SPINDLE_OFF", record.line)
            return
        self._spindles += 1
        self._keep_coming()
        self._turning = turned(self._turning, record)
        speed, surface = self._turning.speed, self._turning.surface
        if speed is None:
            raise self.output.fail(
                record.line, "the spindle turns before its speed is known", "Give a speed."
            )
        macro = "SPINDLE_CCW" if self._turning.sense == "ccw" else "SPINDLE_CW"
        control = self.output.control
        if surface and control.has(macro) and not control.uses(macro, "SPINDLEMODE"):
            raise self.output.fail(
                record.line,
                f"a surface speed, and {macro} of the control file does not tell it from revolutions",
                "Let the CAM system write RPM, or ask for SPINDLEMODE in the macro if the control has G96.",
            )
        if surface and record.max_rpm and control.has(macro) and not control.uses(macro, "MAXRPM"):
            raise self.output.fail(
                record.line,
                f"a highest speed of {record.max_rpm:g} rpm, and {macro} of the control file does not write it",
                "Ask for MAXRPM in the macro if the control has a clamp (G50 S, G92 S), or let the CAM system write "
                "RPM.",
            )
        self.drilling.rpm = 0.0 if surface else speed
        self.motion.surface_speed = surface
        self.drilling.spindle_sense = self._turning.sense
        words: dict[str, float | str] = {
            "S": self._spindle_number(speed, surface),
            "SPINDLEMODE": 96.0 if surface else 97.0,
        }
        if not self.output.parameters.strict:
            words["MAXRPM"] = record.max_rpm
        self.output.keep(SPINDLESTATE=SPINDLE_STATES[self._turning.sense])
        if surface and not record.max_rpm and self.output.control.uses(macro, "MAXRPM"):
            self.output.remark(
                record.line,
                "a surface speed without a highest speed (SPINDL/...,MAXRPM,n): nothing limits the spindle",
            )
        if record.max_rpm and not self.output.control.uses(macro, "MAXRPM"):
            self.output.remark(
                record.line,
                f"the highest speed is not written: {macro} of the control file does not use MAXRPM",
            )
        self._spindle_words = (macro, words, self.tools)
        self.output.state(macro, record.line, words)

    def _spindle_number(self, speed: float, surface: bool) -> float:
        """Return the number of S: revolutions per minute, or the surface speed in m or feet per minute."""
        in_feet = surface and self.output.parameters.units == "inch"
        return speed / 0.3048 if in_feet else speed

    def _take(self, record: Any) -> Act | None:
        """Return what a record makes the tool do."""
        try:
            return self.course.take(record)
        except CourseError as error:
            raise self.output.fail(error.line, error.what, error.hint) from None

    def _note(self, record: Rapid | Axis) -> None:
        self._take(record)

    def points(self, record: Points, block_map: BlockMap | None) -> None:
        """Take many points at once, as far as nothing but their moves comes of them."""
        line, xyz = record
        for place in range(len(xyz)):
            x, y, z = xyz[place].tolist()
            course, motion = self.course, self.motion
            if (
                self._in_path
                and not self._resumes
                and course.is_plain
                and course.here is not None
                and motion.is_plain(course.here, course.axis)
            ):
                self.drilling.close()
                if block_map is not None:
                    block_map.line.extend(range(line + place, line + len(xyz)))
                blocks = None if block_map is None else block_map.last_block
                motion.feed_along(line + place, course.here, xyz[place:], blocks)
                course.here = motion.position
                return
            self._goto(Goto(line + place, x, y, z))
            if block_map is not None:
                block_map.add(self.output.blocks, line + place)

    def _goto(self, record: Goto) -> None:
        if not self._in_path:
            self._begin_path()
        elif record.axis is None and not self._resumes:
            _, x, y, z, _ = record
            end = x, y, z
            start = self.course.plain(end)
            if start is not None:
                self.drilling.close()
                self.motion.feed_to(record.line, start, end, self.course.axis)
                return
        self._move(record)

    def _move(self, record: Any) -> None:
        act = self._take(record)
        if self._resumes:
            self._resume(record.line)
        if isinstance(act, Straight):
            self.drilling.close()
            self.motion.move(act)
        elif isinstance(act, Hole):
            self.drilling.hole(act)
            self.motion.tangency.straight(None, act.point, False)
        elif isinstance(act, Turn):
            self.motion.circle(act)

    def _stands(self, record: From) -> None:
        before = self.motion.position
        self._take(record)
        self.motion.set_position(self.course.here)
        if before is not None and before != self.course.here:
            self.motion.moved_by_macro()

    def _cycle(self, record: Cycle) -> None:
        self._take(record)
        self.drilling.begin(record)

    def _thread(self, record: Thread) -> None:
        self.drilling.close()
        self.motion.thread(record)

    def _cycle_off(self, record: CycleOff) -> None:
        self._take(record)
        self.drilling.close()

    def _resume(self, line: int) -> None:
        """Give back what a tool change took away: the spindle turns and the coolant flows as before."""
        self._resumes = False
        if self._spindle_words is not None and self._spindle_words[2] < self.tools:
            macro, words, _ = self._spindle_words
            self._spindle_words = (macro, words, self.tools)
            self.output.state(macro, line, words)
        if self._coolant_mode[0] != "off" and self._coolant_mode[1] < self.tools:
            self._coolant_mode = (self._coolant_mode[0], self.tools)
            self.output.state(f"COOLANT_{self._coolant_mode[0].upper()}", line)

    def _coolant(self, record: Coolant) -> None:
        self._coolant_mode = (record.mode, self.tools)
        self.output.keep(COOLANTSTATE=_COOLANT_STATES[record.mode])
        self.output.state(f"COOLANT_{record.mode.upper()}", record.line)

    def _compensation(self, record: Compensation) -> None:
        self.drilling.close()
        words: dict[str, float | str] = {}
        is_lathe = not self.output.control.uses("LINEAR", "Y")
        if record.side != "off" and record.plane is not None and not (is_lathe and record.plane == 18):
            raise self.output.fail(
                record.line,
                "radius compensation in another plane than XY",
                "Let the CAM system compensate the radius there (CUTCOM/OFF).",
            )
        if record.side != "off":
            words["D"] = float(self._tool_number if record.d is None else record.d)
        self.output.state(f"COMP_{record.side.upper()}", record.line, words)

    def _dwell(self, record: Dwell) -> None:
        self.drilling.close()
        words: dict[str, float | str] = {"DWELL": record.seconds, "DWELLREV": record.revolutions}
        self.output.state("DWELL", record.line, words)

    def _word(self, record: Word) -> None:
        """Hand a record that no other event takes to a macro of its own, if there is one."""
        control = self.output.control
        macro = next((each for each in word_macros(record.name, record.first) if control.has(each)), None)
        if macro is None or self.output.parameters.strict:
            if (why := self._needed.why(record)) is not None:
                raise self.output.fail(record.line, *why)
            self.output.remark(record.line, f"{record.name} is not known and was left out")
            return
        if not self._in_path:
            self._begin_path()
        self.drilling.close()
        numbers = (*record.numbers, *(0.0,) * MOST_NUMBERS)[:MOST_NUMBERS]
        words: dict[str, float | str] = {
            "WORD": _printable(record.name),
            "WORDTEXT": _printable(record.text),
            "NUMBERS": float(len(record.numbers)),
        }
        words |= {f"NUMBER{place}": number for place, number in enumerate(numbers, 1)}
        self.output.call(macro, words)

    def _stop(self, record: Stop) -> None:
        self.drilling.close()
        self.output.state("OPTIONAL_STOP" if record.optional else "STOP", record.line)


def _over(old: ToolShape, new: ToolShape) -> ToolShape:
    """Return the shape of a tool of which something more was said."""
    return ToolShape(
        new.line,
        old.name if new.name is None else new.name,
        old.diameter if new.diameter is None else new.diameter,
        old.length if new.length is None else new.length,
    )


def _printable(text: str) -> str:
    return "".join(char if char.isprintable() else " " for char in text)


def _plain(text: str) -> str:
    """Return a text that can stand in a comment of any control: one line, no parentheses."""
    return _printable(text).replace("(", "[").replace(")", "]").strip()
