"""Moves: from points and arcs of the tool path to the words of RAPID, LINEAR, ARC_CW and ARC_CCW."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from polycnc.errors import ProgramError
from polycnc.post.macros._compile import START_WORDS
from polycnc.post.output._arc_center import WrittenArc, may_be_written
from polycnc.post.output._kinematics import Angles, Kinematics
from polycnc.post.output._output import Output
from polycnc.post.output._rotary import table_angles, tilt_hint
from polycnc.post.tool_path._arcs import Arc, cuts
from polycnc.post.tool_path._course import Straight, Turn
from polycnc.post.tool_path._cycles import Step
from polycnc.post.tool_path._records import UPRIGHT, Feed, Thread, Vector
from polycnc.post.tool_path._tangency import Tangency

_TILTED = 1e-6
_FLAT_MM = 1e-7
_LARGE_TURN_DEG = 90.0
_OFF_PLANE_MM = 1e-3
_CHORD_UNITS = 0.4  # of the last decimal: lines that lie nearer to an arc are lost in rounding
_FEED_OF_AXES = (
    "the feed of moves that turn the tool axis is that of the machine's axes, not of the tip (inverse_time)"
)
_NO_FEED_MODE = (
    "a feed per revolution, and no macro of the control file says so to the control",
    "Let the CAM system write feeds per minute, or ask for FEEDMODE in its macros if the control has G95.",
)


class Motion:
    """The tool on its way: position and tool axis as the tool path has them, feed, and lengths so far."""

    def __init__(self, output: Output) -> None:
        self.position: Vector | None = None
        self.axis: Vector = UPRIGHT
        self.feed: float | None = None
        self.per_revolution = False
        self.feed_mm = self.rapid_mm = 0.0
        self.arcs = 0
        self.tangency = Tangency()
        self._output = output
        self._call = output.call
        self._parameters = output.parameters
        self._scale = output.scale
        self._must_write = True
        self._elsewhere = False  # a macro moved the machine: nobody knows where it stands
        self._first = 0.0
        self._tilt = self._turn = 0.0
        self._rotary: dict[str, float] = {}
        five_axis = output.parameters.five_axis
        self._kinematics = Kinematics(five_axis) if five_axis is not None else None
        self.angles: Angles = (0.0, 0.0)
        self.tool_length_mm: float | None = None
        self._has_start = any(output.control.names(word) for word in START_WORDS)
        self._has_feed_mode = output.control.names("FEEDMODE")
        self._needs = {macro: output.control.has(macro) for macro in ("RAPID", "LINEAR", "THREAD")}
        # A lathe's program has no Y: what the tool path says there would be lost.
        named = [word for word in "IJKR" if output.control.uses("ARC_CW", word)]
        self._by_radius = named == ["R"]
        self._flat = not any(output.control.uses(macro, "Y") for macro in ("RAPID", "LINEAR"))
        self.surface_speed = False
        self._thread: Thread | None = None

    def set_feed(self, record: Feed) -> None:
        """Take the feed of later moves."""
        self.feed, self.per_revolution = record.value, record.per_revolution

    def is_plain(self, start: Vector | None, axis: Vector) -> bool:
        """Tell whether a straight feed move from a point is no more than its end."""
        return not (
            self._must_write
            or self._first
            or (self.per_revolution and not self._has_feed_mode)
            or self._kinematics is not None
            or self._rotary
            or self._thread is not None
            or axis is not self.axis
            or self.position != start
            or self.feed is None
            or not self._needs["LINEAR"]
        )

    def thread(self, record: Thread | None) -> None:
        """Let feed moves be cuts of a thread, or not any more."""
        self._thread = record if record is not None and record.on else None

    def _lead(self, line: int, thread: Thread) -> float:
        """Return the lead of a cut.

        Raises:
            ProgramError: it is not known, or the spindle does not keep its speed.
        """
        if self.surface_speed:
            raise self._output.fail(
                line, "a thread with constant surface speed", "Write SPINDL/RPM before the thread."
            )
        if thread.lead is not None:
            return thread.lead
        if self.feed is None or not self.per_revolution:
            raise self._output.fail(
                line,
                "a thread whose lead is not known",
                "Write PITCH/LEAD,1.5 before it, or a feed per revolution like FEDRAT/1.5,MMPR.",
            )
        return self.feed

    def feed_along(
        self, line: int, start: Vector, ends: npt.NDArray[np.float64], blocks: array[int] | None
    ) -> None:
        """Move straight with the feed to one point after the other, [points, 3], where that is plain.

        `blocks` gets how many blocks there are after each of them.
        """
        if self._flat and len(off := np.flatnonzero(np.abs(ends[:, 1]) > _OFF_PLANE_MM)):
            raise self._off_plane(line + int(off[0]), float(ends[off[0], 1]))
        before = np.concatenate((np.array([start]), ends[:-1]))
        ways = ends - before
        lengths = np.sqrt((ways * ways).sum(axis=1))
        self.tangency.run(start, ends, lengths)
        self.feed_mm += float(lengths.sum())
        moves = (ways != 0.0).any(axis=1)
        rows = np.concatenate((ends, before), axis=1) if self._has_start else ends
        feed, mode = self.feed_words(0)
        first = self._output.blocks
        behind = self._output.call_along(rows[moves] * self._scale, feed, mode, blocks is not None)
        if blocks is not None:
            counts = np.concatenate((np.array([first], np.intc), behind))
            blocks.frombytes(counts[np.cumsum(moves)].tobytes())
        x, y, z = ends[-1].tolist()
        self.position = (x, y, z)

    def feed_to(self, line: int, start: Vector, end: Vector, axis: Vector) -> None:
        """Move straight to a point with the feed: most of a long tool path, so on a short way where it is plain."""
        if not self.is_plain(start, axis):
            self.move(Straight(line, start, end, axis, False))
            return
        assert self.feed is not None
        if self._flat and abs(end[1]) > _OFF_PLANE_MM:
            raise self._off_plane(line, end[1])
        length = math.dist(start, end)
        self.tangency.feed(start, end, length)
        if start == end:
            return
        scale = self._scale
        words: dict[str, float | str] = {
            "X": end[0] * scale,
            "Y": end[1] * scale,
            "Z": end[2] * scale,
            "F": self.feed * scale,
            "FEEDMODE": 95.0 if self.per_revolution else 94.0,
        }
        if self._has_start:
            words["STARTX"], words["STARTY"], words["STARTZ"] = (value * scale for value in start)
        self.position = end
        self.feed_mm += length
        self._call("LINEAR", words)

    def travelled(self, steps: Iterable[Step], end: Vector) -> None:
        """Take the position after a hole that a macro drilled, and the lengths of its steps."""
        here = self.position
        for step in steps:
            length = 0.0 if here is None else math.dist(here, step.point)
            if step.kind == "rapid":
                self.rapid_mm += length
            else:
                self.feed_mm += length
            here = step.point
        self.position = end
        self._must_write = self._elsewhere = False

    def set_position(self, position: Vector | None) -> None:
        """Take where the tool stands; its axis is written with the next move."""
        self.position = position

    def first(self, rank: float) -> None:
        """Say with FIRSTMOTION that the next move or hole is a first one; the higher rank counts."""
        self._first = max(self._first, rank)
        self._output.keep(FIRSTMOTION=self._first)

    def began(self) -> None:
        """Know that the first move or hole is written."""
        if self._first:
            self._first = 0.0
            self._output.keep(FIRSTMOTION=0.0)

    def moved_by_macro(self) -> None:
        """Know that the machine may stand elsewhere: the next move is written, wherever it goes."""
        self._must_write = True

    def tool_changed(self) -> None:
        """Know that the machine stands where tools are changed."""
        self._must_write = self._elsewhere = True

    def move(self, act: Straight) -> None:
        """Go straight to a point."""
        line, _, end, axis, rapid = act
        self.tangency.straight(act.start, end, not rapid)
        self.straight(line, end, axis, rapid)

    def straight(self, line: int, end: Vector, axis: Vector | None, rapid: bool) -> None:
        """Move straight to a point, by rapid or with the feed."""
        before = self.angles
        if axis is not None and axis != self.axis:
            self._lean(line, axis)
            self._must_write = True
        if self._kinematics is not None:
            self._turn_to(line, self._kinematics, before, end, rapid)
            return
        start = self.position
        if start == end and not self._must_write:
            return
        elsewhere, self._elsewhere, self._must_write = self._elsewhere, False, False
        x, y, z = end
        if self._flat and abs(y) > _OFF_PLANE_MM:
            raise self._off_plane(line, y)
        if start is None:
            start = end
        scale = self._scale
        words: dict[str, float | str] = {
            "X": x * scale,
            "Y": y * scale,
            "Z": z * scale,
            "STARTX": start[0] * scale,
            "STARTY": start[1] * scale,
            "STARTZ": start[2] * scale,
        }
        if self._rotary:
            words.update(self._rotary)
        self.position = end
        if rapid:
            self.rapid_mm += math.dist(start, end)
            self._check("RAPID", line)
            self._call("RAPID", words)
        elif self._thread is not None:
            if elsewhere:
                raise self._output.fail(
                    line,
                    "a thread that begins where the tool was changed",
                    "Write RAPID and a GOTO to its start before it.",
                )
            self.feed_mm += math.dist(start, end)
            self._check("THREAD", line)
            words["LEAD"] = self._lead(line, self._thread) * scale
            self._call("THREAD", words)
        else:
            self.feed_mm += math.dist(start, end)
            self._check("LINEAR", line)
            words["F"], words["FEEDMODE"] = self.feed_words(line)
            self._call("LINEAR", words)
        if self._first:
            self.began()

    def _off_plane(self, line: int, y: float) -> ProgramError:
        return self._output.fail(
            line,
            f"the point lies {y:g} mm off the plane: the control file writes no Y",
            'A lathe\'s path has X and Z; where it is in X and Y, write turning_plane = "xy" in the parameters.',
        )

    @property
    def has_head(self) -> bool:
        """Whether positions depend on the length of the tool."""
        return self._kinematics is not None and self._kinematics.on_machine and self._kinematics.has_head

    @property
    def turned_on_machine(self) -> bool:
        """Whether X, Y, Z are those of a machine whose rotary axes are not at 0, so that they are not the part's."""
        return self._kinematics is not None and self._kinematics.on_machine and self.angles != (0.0, 0.0)

    def _turn_to(self, line: int, kinematics: Kinematics, before: Angles, end: Vector, rapid: bool) -> None:
        """Move straight to a point with rotary axes, in pieces that keep the tip on its line."""
        if self._thread is not None and not rapid:
            raise self._output.fail(
                line, "a thread on a machine with five axes", "Post it for a lathe by itself."
            )
        start = self.position
        if start == end and not self._must_write:
            return
        after = self.angles
        if self._elsewhere:
            start, before = None, after
        self._elsewhere = self._must_write = False
        length = self._reach(line, kinematics, after)
        tolerance = self._parameters.tolerance_mm
        pieces: Iterable[tuple[Vector, Angles]] = ((end, after),)
        turn = max(abs(after[0] - before[0]), abs(after[1] - before[1]))
        if not rapid and start is not None and turn > 0.0:
            pieces = kinematics.pieces(start, before, end, after, length, tolerance)
            if turn > _LARGE_TURN_DEG:
                self._output.remark(
                    line, f"a feed move turns a rotary axis by more than {_LARGE_TURN_DEG:g} degree"
                )
        here, angles = (end if start is None else start), before
        for point, turned in pieces:
            self._piece(line, kinematics, (here, angles), (point, turned), length, rapid)
            here, angles = point, turned
        self.position = end

    def _piece(
        self,
        line: int,
        kinematics: Kinematics,
        start: tuple[Vector, Angles],
        end: tuple[Vector, Angles],
        length: float,
        rapid: bool,
    ) -> None:
        way = math.dist(start[0], end[0])
        scale = self._scale
        if kinematics.on_machine:
            begin, place = kinematics.position(*start, length), kinematics.position(*end, length)
        else:
            begin, place = start[0], end[0]
        words: dict[str, float | str] = {
            name: value * scale
            for name, value in zip(
                ("X", "Y", "Z", "STARTX", "STARTY", "STARTZ"), (*place, *begin), strict=True
            )
        }
        words |= zip(("TOOLI", "TOOLJ", "TOOLK"), kinematics.axis_of(end[1]), strict=True)
        words |= zip(kinematics.letters, end[1], strict=True)
        macro = "RAPID" if rapid else "LINEAR"
        self._check(macro, line)
        if rapid:
            self.rapid_mm += way
        else:
            self.feed_mm += way
            words["F"], words["FEEDMODE"] = self._turning_feed(line, way, start[1], end[1])
        self._call(macro, words)
        if self._first:
            self.began()

    def _turning_feed(self, line: int, way: float, before: Angles, after: Angles) -> tuple[float, float]:
        """Return F and FEEDMODE of a move with rotary axes: the inverse of its time if they turn."""
        plain = self.feed_words(line)
        five_axis = self._parameters.five_axis
        turn = max(abs(after[0] - before[0]), abs(after[1] - before[1]))
        if five_axis is None or turn == 0.0:
            return plain
        if not five_axis.inverse_time:
            if five_axis.output == "machine":
                self._output.remark(line, _FEED_OF_AXES)
            return plain
        assert self.feed is not None
        if self.per_revolution:
            hint = "Let the CAM system write feeds per minute where the tool axis turns."
            raise self._output.fail(line, "a feed per revolution with inverse time", hint)
        minutes = way / self.feed if way > _FLAT_MM else turn / five_axis.turning_deg_min
        return 1.0 / minutes, 93.0

    def _reach(self, line: int, kinematics: Kinematics, angles: Angles) -> float:
        """Return the length of the tool, which counts where a head turns it.

        Raises:
            ProgramError: it is not known.
        """
        if not self.has_head:
            return 0.0
        if not self.tool_length_mm and angles != (0.0, 0.0):
            raise self._output.fail(
                line,
                "the head turns a tool whose length is not known",
                "Let the CAM system write the length with the tool, like LOADTL/3,LENGTH,120.",
            )
        return self.tool_length_mm or 0.0

    def feed_words(self, line: int) -> tuple[float, float]:
        """Return F and FEEDMODE.

        Raises:
            ProgramError: there is no feed yet, or one per revolution that the control file does not know.
        """
        if self.feed is None:
            raise self._output.fail(line, "a feed move without a feed", "Write FEDRAT before it.")
        if self.per_revolution and not self._has_feed_mode:
            raise self._output.fail(line, *_NO_FEED_MODE)
        return self.feed * self._scale, 95.0 if self.per_revolution else 94.0

    def circle(self, act: Turn) -> None:
        """Move along an arc: in pieces as the parameters say, or in lines."""
        line = act.line
        if self._thread is not None:
            raise self._output.fail(line, "an arc within a thread", "Write THREAD/OFF before it.")
        if act.axis != self.axis:
            raise self._output.fail(
                line, "the tool axis changes with an arc", "Write a GOTO with the new axis before it."
            )
        if self._flat and abs(act.end[1]) > _OFF_PLANE_MM:
            raise self._off_plane(line, act.end[1])
        self.tangency.arc(line, act.start, act.end, act.center, act.normal)
        whole = Arc(act.start, act.end, act.center, act.normal, act.angle)
        self.feed_mm += whole.length
        self.arcs += 1
        before = self.feed_mm
        if self._stays_arc(whole):
            for piece in whole.pieces(cuts(whole, self._parameters.arc_split)):
                self._arc(line, piece)
        else:
            self._chords(line, whole)
        self.feed_mm = before

    def _stays_arc(self, arc: Arc) -> bool:
        has = self._output.control.has
        allowed = not self.turned_on_machine and may_be_written(arc, self._parameters)
        return allowed and has("ARC_CW") and has("ARC_CCW")

    def _chords(self, line: int, arc: Arc) -> None:
        finest = _CHORD_UNITS * 10.0**-self._parameters.decimals / self._scale
        for point in arc.chords(max(self._parameters.tolerance_mm, finest)):
            self.straight(line, point, None, False)

    def _arc(self, line: int, arc: Arc) -> None:
        """Write one arc of up to a whole turn; as lines if it is one within the tolerance, or if no centre fits."""
        found = arc.plane()
        assert found is not None
        plane, clockwise = found
        scale, decimals = self._scale, self._parameters.decimals
        center = None
        if arc.height > self._parameters.tolerance_mm:
            center = WrittenArc(arc, plane, clockwise, scale, decimals).center(self._by_radius)
        if center is None:
            self._chords(line, arc)
            return
        start = [round(value * scale, decimals) for value in arc.start]
        absolute = self._parameters.arc_center == "absolute"
        i, j, k = center if absolute else (c - s for c, s in zip(center, start, strict=True))
        normal_word = {17: "K", 18: "J", 19: "I"}[plane]
        radius = arc.radius * scale
        x, y, z = arc.end
        words: dict[str, float | str] = {
            "X": x * scale,
            "Y": y * scale,
            "Z": z * scale,
            "STARTX": arc.start[0] * scale,
            "STARTY": arc.start[1] * scale,
            "STARTZ": arc.start[2] * scale,
            "I": i,
            "J": j,
            "K": k,
            "R": radius if arc.sweep <= math.pi + 1e-9 else -radius,
            "PLANE": float(plane),
            "SWEEP": math.degrees(arc.sweep),
        }
        words[normal_word] = 0.0
        words["F"], words["FEEDMODE"] = self.feed_words(line)
        self.position = arc.end
        self._must_write = False
        self._call("ARC_CW" if clockwise else "ARC_CCW", words)
        if self._first:
            self.began()

    def _check(self, macro: str, line: int) -> None:
        if not self._needs[macro]:
            raise self._output.fail(
                line,
                f"the control file has no macro {macro}",
                f"Add {macro} to [nc_macros] of the control file.",
            )

    def _lean(self, line: int, axis: Vector) -> None:
        """Take a new tool axis, and the rotary positions or words for it."""
        kind = self._parameters.rotary
        self.axis = axis
        if self._kinematics is not None:
            angles = self._kinematics.nearest(axis, self.angles)
            if angles is None:
                raise self._output.fail(
                    line,
                    f"the rotary axes {' and '.join(self._kinematics.letters)} cannot reach the tool axis "
                    f"{axis[0]:.6g}, {axis[1]:.6g}, {axis[2]:.6g}",
                    "Look at limits_deg and direction of the axes in the control file, or tilt the part in the CAM "
                    "system.",
                )
            self.angles = angles
            return
        if kind == "none":
            if math.dist(axis, UPRIGHT) > _TILTED:
                raise self._output.fail(
                    line,
                    "the tool is tilted, and the control file has no rotary axes",
                    tilt_hint(axis),
                )
            return
        self._rotary = {"TOOLI": axis[0], "TOOLJ": axis[1], "TOOLK": axis[2]}
        if kind != "vector":
            self._tilt, self._turn = table_angles(axis, kind, self._tilt, self._turn)
            self._rotary["A" if kind == "ac_table" else "B"] = self._tilt
            self._rotary["C"] = self._turn
