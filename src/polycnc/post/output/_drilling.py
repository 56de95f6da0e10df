"""Holes: each calls the cycle's macro, or becomes moves where the control file has none or does not want it."""

from __future__ import annotations

import math

from polycnc.post.output._motion import Motion
from polycnc.post.output._output import Output
from polycnc.post.tool_path._course import Hole
from polycnc.post.tool_path._cycles import MOST_PECKS, hole_steps, without_pecks
from polycnc.post.tool_path._records import UPRIGHT, Cycle

_SAME_LEVEL_MM = 1e-9


class Drilling:
    """What the control knows of the cycle in force."""

    def __init__(self, output: Output, motion: Motion) -> None:
        self.holes = 0
        self.rpm = 0.0
        self.spindle_sense = "cw"
        self._output = output
        self._motion = motion
        self._hole = 0
        self._returns_to: float | None = None

    def begin(self, record: Cycle) -> None:
        """Take a cycle for the points that follow."""
        self.close()
        if (
            record.kind in ("deep", "chip_break")
            and (record.depth + record.clearance) / record.peck > MOST_PECKS
        ):
            raise self._output.fail(record.line, "a hole with too many pecks", "Give a larger STEP.")

    def hole(self, act: Hole) -> None:
        """Drill at a point."""
        self.holes += 1
        by_macro = (
            self._output.parameters.cycles == "macros"
            and self._output.control.has(self._macro(act.cycle))
            and math.dist(act.axis, UPRIGHT) < 1e-6
            and not self._motion.turned_on_machine
        )
        if by_macro:
            self._by_macro(act)
        else:
            self._by_moves(act)

    def _macro(self, cycle: Cycle) -> str:
        return f"CYCLE_{cycle.kind.upper()}"

    def _by_macro(self, act: Hole) -> None:
        line, here, point, axis, cycle, levels = act
        x, y, surface = point
        motion = self._motion
        if axis != motion.axis:  # the tool turns above the hole, before the control's cycle
            self.close()
            motion.straight(line, (x, y, surface + levels.travel), axis, True)
            here = motion.position
        to_initial = levels.out > levels.start + _SAME_LEVEL_MM
        out = surface + levels.out
        other_way = self._hole > 0 and (self._returns_to is None) == to_initial
        if other_way or (to_initial and self._differs(out)):
            self.close()
        if to_initial and not self._hole:
            # The control leaves to the level before the cycle: go there first.
            if here is not None and here[2] < out:
                motion.straight(line, (here[0], here[1], out), axis, True)
            elif here is None or here[2] > out:
                motion.straight(line, (x, y, surface + levels.travel), axis, True)
                motion.straight(line, (x, y, out), axis, True)
        start = motion.position or (x, y, out)
        self._hole += 1
        self._returns_to = out if to_initial else None
        scale = self._output.scale
        words: dict[str, float | str] = {
            "X": x * scale,
            "Y": y * scale,
            "Z": (surface + levels.bottom) * scale,
            "STARTX": start[0] * scale,
            "STARTY": start[1] * scale,
            "STARTZ": start[2] * scale,
            "SURFACE": surface * scale,
            "R": (surface + levels.start) * scale,
            "OUT": out * scale,
            "RETRACT": 98.0 if to_initial else 99.0,
            "HOLE": float(self._hole),
            "P": cycle.dwell_s,
            "Q": cycle.peck * scale,
        }
        words.update(self._feed_words(line, cycle))
        self._output.call(self._macro(cycle), words)
        motion.began()
        steps = hole_steps(without_pecks(cycle), point, UPRIGHT, motion.position, levels, 0.0, 0.0)
        motion.travelled(steps, (x, y, out))

    def _differs(self, out: float) -> bool:
        return self._returns_to is not None and abs(self._returns_to - out) > _SAME_LEVEL_MM

    def _feed_words(self, line: int, cycle: Cycle) -> dict[str, float]:
        motion, scale = self._motion, self._output.scale
        feed, per_revolution = cycle.feed, cycle.per_revolution
        if feed is None:
            value, mode = motion.feed_words(line)
            feed, per_revolution = value / scale, mode == 95.0
        if cycle.kind != "tap":
            return {"F": feed * scale, "FEEDMODE": 95.0 if per_revolution else 94.0}
        if self.rpm <= 0.0:
            raise self._output.fail(
                line, "tapping before the spindle has a speed", "Write SPINDL before the cycle."
            )
        pitch = feed if per_revolution else feed / self.rpm
        return {"F": pitch * self.rpm * scale, "FEEDMODE": 94.0, "PITCH": pitch * scale, "S": self.rpm}

    def _by_moves(self, act: Hole) -> None:
        self.close()
        line, here, point, axis, cycle, levels = act
        motion, parameters = self._motion, self._output.parameters
        kept = motion.feed, motion.per_revolution
        words = self._feed_words(line, cycle)
        motion.feed = words["F"] / self._output.scale
        motion.per_revolution = words["FEEDMODE"] == 95.0
        turns = {"cw": "SPINDLE_CW", "ccw": "SPINDLE_CCW"}
        if self.spindle_sense == "ccw":
            turns = {"cw": "SPINDLE_CCW", "ccw": "SPINDLE_CW"}
        spindle: dict[str, float | str] = {"S": self.rpm, "SPINDLEMODE": 97.0}
        steps = hole_steps(cycle, point, axis, here, levels, parameters.chip_break_mm, parameters.reentry_mm)
        for step in steps:
            if step.kind in ("rapid", "feed"):
                motion.straight(line, step.point, axis, step.kind == "rapid")
            elif step.kind == "dwell":
                self._output.state("DWELL", line, {"DWELL": cycle.dwell_s, "DWELLREV": 0.0})
            else:
                macro = turns["ccw" if step.kind == "reverse" else "cw"]
                self._output.state("SPINDLE_OFF", line)
                self._output.state(macro, line, spindle)
        motion.feed, motion.per_revolution = kept

    def close(self) -> None:
        """Tell the control that its cycle is over, if it runs one; the next hole of a cycle calls it anew."""
        if self._hole:
            self._output.frame("CYCLE_OFF")
            self._motion.moved_by_macro()
        self._hole = 0
        self._returns_to = None
