"""LinuxCNC's stand-alone interpreter `rs274` as an oracle: run it on a program, read its canonical calls.

It prints four decimals. To compare more closely it is given a program that is `SCALE` times as large.
"""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from polycnc.units import MM_PER_INCH
from support.canonical import Dwell, Feed, Function, Point, Step, Traverse, Turn
from support.random_programs import tool_table

COMMAND = shutil.which("rs274")
SCALE = 10_000
RESOLUTION_MM = 0.5e-4 * MM_PER_INCH / SCALE
"""Half of the last printed digit, of a length in inch."""

_CALL = re.compile(r"^\s*\d+ N\S*\s+(\w+)\((.*)\)$", re.MULTILINE)
_TAG = re.compile(r"\((\d+)\.(\d+)\)")
_TAGGED = re.compile(r'"(\d+)\.(\d+)"')
_PLANES = {"CANON_PLANE_XY": (0, 1, 2), "CANON_PLANE_YZ": (1, 2, 0), "CANON_PLANE_XZ": (2, 0, 1)}
_FUNCTIONS = {
    "START_SPINDLE_CLOCKWISE": "M3",
    "START_SPINDLE_COUNTERCLOCKWISE": "M4",
    "STOP_SPINDLE_TURNING": "M5",
    "MIST_ON": "M7",
    "FLOOD_ON": "M8",
    "PROGRAM_STOP": "M0",
    "OPTIONAL_PROGRAM_STOP": "M1",
}
_OUTPUTS = {
    "SET_MOTION_OUTPUT_BIT": "M62 P{0}",
    "CLEAR_MOTION_OUTPUT_BIT": "M63 P{0}",
    "SET_AUX_OUTPUT_BIT": "M64 P{0}",
    "CLEAR_AUX_OUTPUT_BIT": "M65 P{0}",
    "SET_MOTION_OUTPUT_VALUE": "M67 E{0} Q{1}",
    "SET_AUX_OUTPUT_VALUE": "M68 E{0} Q{1}",
}
_DIRECTIONS = {"START_SPINDLE_CLOCKWISE": 1, "START_SPINDLE_COUNTERCLOCKWISE": -1, "STOP_SPINDLE_TURNING": 0}
_IGNORED = {
    "COMMENT",
    "MESSAGE",
    "MIST_OFF",  # M9 is both, in this order
    "ON_RESET",
    "SET_TOOL_TABLE_ENTRY",
    "CHANGE_TOOL_NUMBER",
    "SET_FEED_REFERENCE",
    "SET_MOTION_CONTROL_MODE",
    "SET_NAIVECAM_TOLERANCE",
    "PALLET_SHUTTLE",
    "ORIENT_SPINDLE",
    "WAIT_SPINDLE_ORIENT_COMPLETE",
    "SELECT_TOOL",
    "START_CHANGE",
    "ENABLE_FEED_OVERRIDE",
    "DISABLE_FEED_OVERRIDE",
    "ENABLE_SPEED_OVERRIDE",
    "DISABLE_SPEED_OVERRIDE",
    "FINISH",
    "ENABLE_FEED_HOLD",
    "DISABLE_FEED_HOLD",
    "ENABLE_ADAPTIVE_FEED",
    "DISABLE_ADAPTIVE_FEED",
}


@dataclass(frozen=True)
class Answer:
    """What rs274 made of a program: its calls as printed, or what it refused and the block it refused."""

    calls: list[tuple[str, list[str]]]
    error: str = ""
    block: str = ""


def call(file: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Run rs274 on a file, at home in its folder: it keeps its tools in a file there, and others may run too."""
    assert COMMAND is not None
    return subprocess.run(
        [COMMAND, "-g", *options, str(file)],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
        cwd=file.parent,
        env={**os.environ, "HOME": str(file.parent)},
    )


def interpret(program: str, folder: Path, *, block_delete: bool = False, tools: str = "") -> Answer:
    """Run rs274 on a program text in `folder`, with a tool table (default: a few, all zero) and no variables."""
    file, table = folder / "program.ngc", folder / "tools.tbl"
    file.write_text(program, encoding="ascii")
    table.write_text(tools or tool_table(), encoding="ascii")
    options = ["-b"] if block_delete else []
    done = call(file, *options, "-t", str(table))
    calls = [(name, [part.strip() for part in rest.split(",")]) for name, rest in _CALL.findall(done.stdout)]
    if done.returncode == 0:
        return Answer(calls)
    message = [line for line in done.stderr.splitlines() if line != "executing"]
    return Answer(calls, message[0] if message else "?", message[-1] if message else "?")


@dataclass(frozen=True)
class Sequences:
    """What rs274 made of sequences of tagged blocks: steps of each block, and what it refused first in a sequence."""

    steps: dict[tuple[int, int], list[Step]]
    refused: dict[int, tuple[int, str]]


def interpret_tagged(program: str, folder: Path, axes: int, tools: str, least_mm: float) -> Sequences:
    """Run rs274 once on blocks that end with a comment `(sequence.place)`; it goes on after those that it refuses."""
    file, table = folder / "program.ngc", folder / "tools.tbl"
    file.write_text(f"{program}\n(999999.0)\nM2\n", encoding="ascii")
    table.write_text(tools, encoding="ascii")
    done = call(file, "-n", "0", "-t", str(table))
    refused: dict[int, tuple[int, str]] = {}
    message = ""
    for line in done.stderr.splitlines():
        if (tag := _TAG.search(line)) is None:
            message = line
        elif int(tag[2]):  # the first block may refuse what the sequence before has left
            refused.setdefault(int(tag[1]), (int(tag[2]), message))
    canon = _Canon(axes, 1.0, least_mm, at=(0.0,) * axes)
    steps: dict[tuple[int, int], list[Step]] = {}
    for name, rest in _CALL.findall(done.stdout):
        if name == "COMMENT" and (found := _TAGGED.fullmatch(rest)) is not None:
            canon.steps = steps.setdefault((int(found[1]), int(found[2])), [])
        elif name == "PROGRAM_END":
            break
        elif name != "SET_SPINDLE_MODE":
            canon.call(name, [part.strip() for part in rest.split(",")])
    return Sequences(steps, refused)


@dataclass
class _Canon:
    """The state of the machine behind the canonical calls."""

    axes: int
    scale: float
    least_mm: float  # what printing may have made of no move
    inch: bool = False
    feed: float = 0.0  # mm/min, or mm
    number: float = 0.0  # the same as it was programmed: what counts when only rotary axes move
    per_revolution: bool = False
    rpm: float = 0.0
    plane: tuple[int, int, int] = (0, 1, 2)
    offsets: dict[str, list[float]] = field(default_factory=dict)
    lead: float = 0.0  # that the spindle turns
    direction: int = 0
    rotation: float = 0.0  # of a work offset, degrees
    at: Point = ()
    steps: list[Step] = field(default_factory=list)

    def length(self, text: str) -> float:
        return float(text) * (MM_PER_INCH if self.inch else 1.0) / self.scale

    def point(self, texts: list[str]) -> Point:
        values = [self.length(text) if axis < 3 else float(text) for axis, text in enumerate(texts)]
        for axis, value in enumerate(self.offsets.get("shift", [0.0] * 6)):
            values[axis] += value
        cosine, sine = math.cos(math.radians(self.rotation)), math.sin(math.radians(self.rotation))
        values[:2] = values[0] * cosine - values[1] * sine, values[0] * sine + values[1] * cosine
        others = [offset for name, offset in self.offsets.items() if name != "shift"]
        return tuple(
            value + sum(offset[axis] for offset in others) for axis, value in enumerate(values[: self.axes])
        )

    def speed(self, end: Point, arc: bool = False) -> float:
        """Return the speed of a feed move to `end`."""
        if self.lead:
            return self.lead * self.rpm
        straight = arc or math.dist(end[:3], self.at[:3]) > 2.0 * RESOLUTION_MM
        feed = self.feed if straight else self.number
        return feed * self.rpm if self.per_revolution else feed

    def offset(self, name: str, texts: list[str]) -> None:
        self.offsets[name] = [self.length(t) if axis < 3 else float(t) for axis, t in enumerate(texts)]

    def move(self, step: Traverse | Feed | Turn) -> None:
        # A move to where the machine stands is no move, unless it is a full circle.
        if isinstance(step, Turn) or math.dist(step.end, self.at) > self.least_mm:
            self.steps.append(step)
        self.at = step.end

    def arc(self, texts: list[str]) -> None:
        p, q, r = self.plane
        words, middle = ["0"] * 6, ["0"] * 6
        words[p], words[q], words[r] = texts[0], texts[1], texts[5]
        words[3:] = texts[6 : 6 + len(words[3:])]
        middle[p], middle[q] = texts[2], texts[3]
        end, axis = self.point(words), self.point(middle)
        center = (axis[p], axis[q])
        turns = int(texts[4])
        first = math.atan2(self.at[q] - center[1], self.at[p] - center[0])
        last = math.atan2(end[q] - center[1], end[p] - center[0])
        radius = math.dist((self.at[p], self.at[q]), center)
        hidden = 8.0 * RESOLUTION_MM * SCALE / self.scale
        nothing = hidden / radius  # an angle that printing may have made or hidden
        turn = (last - first) * math.copysign(1.0, turns) % (2.0 * math.pi)
        if turn < nothing or turn > 2.0 * math.pi - nothing:
            turn = 2.0 * math.pi
        sweep = math.copysign(turn + 2.0 * math.pi * (abs(turns) - 1), turns)
        self.move(Turn(end, center, (p, q), sweep, self.speed(end, arc=True)))

    def call(self, name: str, texts: list[str]) -> None:
        match name:
            case "USE_LENGTH_UNITS":
                self.inch = texts[0] == "CANON_UNITS_INCHES"
            case "SELECT_PLANE":
                self.plane = _PLANES[texts[0]]
            case "SET_G5X_OFFSET":
                self.offset("work", texts[1:])
            case "SET_G92_OFFSET":
                self.offset("shift", texts)
            case "USE_TOOL_LENGTH_OFFSET":
                self.offset("tool", [t for text in texts for t in text.split()])
            case "SET_XY_ROTATION":
                self.rotation = float(texts[0])
            case "SET_FEED_RATE":
                self.feed, self.number = self.length(texts[0]), float(texts[0]) / self.scale
            case "SET_SPINDLE_SPEED":
                self.rpm = float(texts[1])
                self.steps.append(Function(f"S{self.rpm:g}"))
            case "START_SPEED_FEED_SYNC":
                self.lead = self.length(texts[0])
            case "STOP_SPEED_FEED_SYNCH":
                self.lead = 0.0
            case "RIGID_TAP":
                start, end = self.at, self.point([*texts, "0", "0", "0"])
                end = (*end[:3], *start[3:])
                turn = {1: ("M4", "M3"), -1: ("M3", "M4")}[self.direction]
                self.steps += [Feed(end, self.speed(end)), Function(turn[0])]
                self.steps += [Feed(start, self.speed(start)), Function(turn[1])]
            case "SET_FEED_MODE":  # a feed of inverse time comes as a feed per minute
                self.per_revolution = texts[1] == "1"
            case "STRAIGHT_TRAVERSE":
                self.move(Traverse(self.point(texts)))
            case "STRAIGHT_FEED":
                end = self.point(texts)
                self.move(Feed(end, self.speed(end)))
            case "ARC_FEED":
                self.arc(texts)
            case "NURBS_FEED":  # its control points are not printed
                self.at = (math.inf,) * self.axes
            case "DWELL":
                self.steps.append(Dwell(float(texts[0])))
            case "CHANGE_TOOL":
                if self.steps and self.steps[-1] == Function("M5"):
                    self.steps.pop()  # changing a tool stops the spindle without an M5 in the program
                self.steps.append(Function(f"M6 T{texts[0]}"))
            case "FLOOD_OFF":
                self.steps.append(Function("M9"))
            case _ if name in _OUTPUTS:
                self.steps.append(Function(_OUTPUTS[name].format(*texts)))
            case _:
                self.direction = _DIRECTIONS.get(name, self.direction)
                if name in _FUNCTIONS:
                    self.steps.append(Function(_FUNCTIONS[name]))
                else:
                    assert name in _IGNORED, name


def canonical_steps(
    answer: Answer, axes: int, scale: float = SCALE, least_mm: float = 2.0 * RESOLUTION_MM
) -> list[Step]:
    """Turn the calls that rs274 printed for a program `scale` times as large into canonical steps.

    Moves of up to `least_mm` are none.
    """
    canon = _Canon(axes, scale, least_mm, at=(0.0,) * axes)
    for name, texts in answer.calls:
        if name == "SET_SPINDLE_MODE":  # the first call of the reset at program end that nothing else makes
            if canon.steps and canon.steps[-1] == Function("M5"):
                canon.steps.pop()
            break
        canon.call(name, texts)
    return canon.steps
