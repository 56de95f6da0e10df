"""Small scripts for the kernel alone, and what every cycle of them comes to, as a transcript that a person can read.

A script is the lines of a transcript that begin with `>`; `Player.play` gives what each says. Lengths in mm, speeds in
mm/s, accelerations in mm/s2, times in s, angles in degrees; axes are called X, Y and Z.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from polycnc.kernel import (
    ADDED,
    BLOCK,
    FEED_MM_S,
    FOLLOWING_ERROR,
    IS_RAPID,
    LEADING,
    LIMIT_HIGH,
    LIMIT_LOW,
    MAIN,
    MOST_SPANS,
    NOT_MERGED,
    PATH_EVENT,
    PATH_RESTED,
    PIDF,
    PROFILE_ENDED,
    QUEUE_LOW,
    RAPID,
    REFERENCE,
    SOFT_LIMIT,
    SPAN_CURVED,
    SPAN_END,
    SPAN_LENGTH,
    SPAN_SIZE,
    STOP,
    SWITCH_EDGE,
    TIME_S,
    TOP_SPEED,
    KernelState,
    advance,
    append_arc,
    append_circle3d,
    append_line,
    append_spline,
    append_wait,
    cut_bezier,
    drop_queue,
    earliest_limit,
    free_slots,
    give_to_path,
    give_to_point_to_point,
    make_state,
    measure_queue,
    merge_line,
    move_to,
    place_machine,
    prepare_path,
    replan_path,
    rest_position,
    skip,
    start_path,
    stop_axis,
)

AXES = "XYZ"
CYCLE_S = 0.01
PATH = 1  # of two: the other is idle, and its row is not asked
AXIS = (2, 0, 1)  # of the machine, for X, Y and Z
SLOTS = 23  # of the path, fewer than a script may need in all
LAYERS = {"main": MAIN, "added": ADDED}
SWITCHES = {"low": LIMIT_LOW, "high": LIMIT_HIGH, "reference": REFERENCE}
RAISED = {
    PATH_RESTED: "rested",
    PROFILE_ENDED: "profile ended",
    QUEUE_LOW: "queue low",
    SWITCH_EDGE: "edge",
    SOFT_LIMIT: "soft limit",
    FOLLOWING_ERROR: "following error",
    PATH_EVENT: "event",
}
OF_AN_AXIS = PROFILE_ENDED | SWITCH_EDGE | SOFT_LIMIT | FOLLOWING_ERROR
KINDS = ("line", "arc", "circle", "spline", "wait")


def machine_axis(name: str) -> int:
    """Return which axis of the machine goes by a name."""
    return AXIS[AXES.index(name)]


class Player:
    """A machine of three axes with a path, and the commands of a script."""

    def __init__(self) -> None:
        self.state: KernelState = make_state(
            3, cycle_s=CYCLE_S, paths=2, segments=2 * SLOTS, record_cycles=1, record_actual=True
        )
        self.tag = 0
        self.new = False
        self.closed = True
        self.shows_actual = False
        self.done = 0
        self.state.paths.axis[PATH] = AXIS
        self.state.paths.axis[0] = -1
        self.state.clock[0]["main_path"] = PATH
        self.state.paths.row[PATH]["low_water"] = -1
        assert self.state.clock[0]["axis"] == -1
        give_to_path(self.state, PATH)
        start_path(self.state.paths, PATH)

    def play(self, command: str) -> list[str]:
        """Carry out a command and return what it says."""
        word, *rest = command.split()
        act: Callable[..., list[str] | None] = getattr(self, f"do_{word}")
        return act(*rest) or []

    # The machine.

    def do_speed(self, *values: str) -> None:
        self.state.limits.speed[:] = [float(value) for value in values]

    def do_acceleration(self, *values: str) -> None:
        self.state.limits.acceleration[:] = [float(value) for value in values]

    def do_jump(self, *values: str) -> None:
        self.state.limits.jump[:] = [float(value) for value in values]

    def do_counts(self, axes: str) -> None:
        self.state.limits.feed_axis[:] = [axis in axes for axis in AXES]

    def do_place(self, *values: str) -> None:
        for axis, value in zip(AXIS, values, strict=True):
            place_machine(self.state, axis, float(value))
        give_to_path(self.state, PATH)

    def do_servo(self, axis: str, name: str, value: str) -> None:
        self.shows_actual = True
        i = machine_axis(axis)
        servo, drive = self.state.servo.row, self.state.plant.row
        if name in (servo.dtype.names or ()):
            servo[name][i] = float(value)
            servo["mode"][i] = PIDF
        else:
            drive[name][i] = float(value)

    def do_switch(self, axis: str, which: str, low: str, high: str) -> None:
        row = self.state.switches.switch[machine_axis(axis), SWITCHES[which]]
        row["on_from"], row["on_to"] = float(low), float(high)

    def do_marks(self, axis: str, name: str, value: str) -> None:
        self.state.switches.marks[name][machine_axis(axis)] = float(value)

    def do_show(self, axis: str, name: str) -> list[str]:
        i = machine_axis(axis)
        for row in (self.state.switches.marks, self.state.servo.row, self.state.plant.row):
            if name in (row.dtype.names or ()):
                return [f"{row[name][i]:.6f}"]
        if name.endswith("_position"):
            edges = self.state.switches.switch[name][i]
            return [" ".join(f"{edge:.6f}" for edge in edges)]
        raise KeyError(name)

    # The path.

    def do_path(self, name: str, value: str) -> None:
        self.state.paths.row[PATH][name] = float(value)

    def do_open(self) -> None:
        self.closed = False

    def do_close(self) -> None:
        self.closed = self.new = True

    def _target(self, words: tuple[str, ...]) -> tuple[np.ndarray, list[str]]:
        """Return the end that words such as `X7.3` name, the other axes staying, and the other words."""
        end, other = self.state.paths.queued[PATH].copy(), []
        for word in words:
            if word[0] in AXES:
                end[AXES.index(word[0])] = float(word[1:])
            else:
                other.append(word)
        self.tag += 1
        self.new = True
        return end, other

    def do_line(self, *words: str) -> list[str] | None:
        end, other = self._target(words)
        flags = (STOP if "stop" in other else 0) | (RAPID if "rapid" in other else 0)
        feed = math.inf if "rapid" in other else float(other[0])
        state = self.state
        if merge_line(state.seg, state.paths, PATH, state.limits, end, feed, flags, self.tag) != NOT_MERGED:
            return ["merged"]
        if append_line(state.seg, state.paths, PATH, state.limits, end, feed, flags, self.tag):
            return None
        return ["no length"]

    def do_arc(self, plane: str, p: str, q: str, sweep: str, *words: str) -> list[str] | None:
        end, other = self._target(words)
        state = self.state
        one, two = AXES.index(plane[0]), AXES.index(plane[1])
        start, turn = state.paths.queued[PATH], math.radians(float(sweep))
        center_p, center_q = float(p), float(q)
        if plane[0] not in "".join(words):  # on the circle
            at_p, at_q = start[one] - center_p, start[two] - center_q
            end[one] = center_p + math.cos(turn) * at_p - math.sin(turn) * at_q
            end[two] = center_q + math.cos(turn) * at_q + math.sin(turn) * at_p
        flags = RAPID if "rapid" in other else 0
        feed = math.inf if "rapid" in other else float(other[0])
        args = (end, one, two, center_p, center_q, turn, feed, flags, self.tag)
        return None if append_arc(state.seg, state.paths, PATH, state.limits, *args) else ["no length"]

    def do_circle(self, *words: str) -> list[str] | None:
        *numbers, feed = (float(word) for word in words)
        self.tag += 1
        self.new = True
        center, normal, sweep = np.array(numbers[:3]), np.array(numbers[3:6]), numbers[6]
        args = (0, 1, 2, center, normal, sweep, feed, 0, self.tag)
        return None if append_circle3d(self.state.seg, self.state.paths, PATH, *args) else ["no circle"]

    def do_bezier(self, plane: str, *words: str) -> list[str]:
        *numbers, feed = (float(word) for word in words)
        one, two = AXES.index(plane[0]), AXES.index(plane[1])
        self.tag += 1
        self.new = True
        state, spans = self.state, np.zeros((MOST_SPANS, SPAN_SIZE))
        control = np.vstack([np.zeros(2), np.array(numbers).reshape(3, 2)])
        start = state.paths.queued[PATH].copy()
        count = cut_bezier(control, spans)
        for span in spans[:count]:
            assert span[SPAN_CURVED]
            end = start.copy()
            end[[one, two]] += span[SPAN_END : SPAN_END + 2]
            append_spline(
                state.seg, state.paths, PATH, end, one, two, span, float(span[SPAN_LENGTH]), feed, 0, self.tag
            )
        return [f"{count} spans"]

    def do_wait(self, seconds: str, event: str = "-1") -> None:
        self.tag += 1
        self.new = True
        append_wait(self.state.seg, self.state.paths, PATH, float(seconds), int(event), self.tag, 0)

    def do_end(self, _: str, value: str) -> None:
        """Prescribe the speed at the end of the last segment: `end speed 12.5`."""
        self._row(int(self.state.paths.row[PATH]["tail"]) - 1)["end_speed"] = float(value)

    def _row(self, count: int) -> np.void:
        path = self.state.paths.row[PATH]
        row: np.void = self.state.seg.row[int(path["base"]) + count % int(path["capacity"])]
        return row

    def do_free(self) -> list[str]:
        return [f"{free_slots(self.state.paths, PATH)} slots"]

    def do_drop(self) -> None:
        drop_queue(self.state.seg, self.state.paths, PATH)

    def do_earliest(self) -> list[str]:
        """Say before which segment the path can still rest, and let it."""
        count = earliest_limit(self.state.seg, self.state.paths, PATH, CYCLE_S)
        self.state.paths.row[PATH]["limit"] = count
        return [f"rests before {count}"]

    def _prepare(self) -> None:
        state = self.state
        if self.new:
            state.paths.row[PATH]["closed"] = self.closed
            prepare_path(state.seg, state.paths, PATH, state.limits, CYCLE_S, state.work)
            self.new = False

    def do_change(self, *words: str) -> None:
        """Change something of the path that runs: `change override 0.37`."""
        for name, value in zip(words[::2], words[1::2], strict=True):
            self.do_path(name, value)
        self._prepare()
        state = self.state
        replan_path(state.seg, state.paths, PATH, state.limits, CYCLE_S, state.work)

    # Single axes.

    def do_move(self, axis: str, layer: str, *numbers: str) -> list[str] | None:
        """Take an axis to a target: target, velocity there, velocity, acceleration, deceleration, jerk, policy."""
        i = machine_axis(axis)
        if layer == "main":
            self._own(i)
        *values, policy = numbers
        args = [float(value) for value in values]
        target, end, velocity, acceleration, deceleration, jerk = args
        phases = move_to(
            self.state.ptp,
            LAYERS[layer],
            i,
            target,
            end,
            velocity,
            acceleration,
            deceleration,
            jerk,
            int(policy),
        )
        return None if phases >= 0 else ["refused"]

    def do_halt(self, axis: str, layer: str, deceleration: str, jerk: str) -> list[str]:
        i = machine_axis(axis)
        stop_axis(self.state.ptp, LAYERS[layer], i, float(deceleration), float(jerk))
        return [f"rests at {rest_position(self.state.ptp, LAYERS[layer], i):.6f}"]

    def do_rests(self, axis: str, layer: str) -> list[str]:
        """Say where the profile of an axis comes to rest, nan where none runs."""
        return [f"{rest_position(self.state.ptp, LAYERS[layer], machine_axis(axis)):.6f}"]

    def _own(self, i: int) -> None:
        if self.state.owner[i] >= 0:
            give_to_point_to_point(self.state, i)

    # What is shown.

    def do_run(self, cycles: str, every: str = "1") -> list[str]:
        """Run cycles and show each of them, or every so many."""
        self._prepare()
        return [row for n in range(int(cycles)) if (row := self._cycle((n + 1) % int(every) == 0))]

    def do_rest(self, every: str = "1") -> list[str]:
        """Run until the path comes to the end of its queue."""
        self._prepare()
        said: list[str] = []
        for n in range(900):
            if row := self._cycle((n + 1) % int(every) == 0):
                said.append(row)
            if self.state.clock[0]["raised"] & PATH_RESTED:
                return [*said, f"after {self.done} cycles"]
        raise AssertionError("the path does not come to rest")

    def do_until(self, *reasons: str) -> list[str]:
        """Run until one of the reasons is met, and show that cycle."""
        self._prepare()
        wanted = [bit for bit, name in RAISED.items() if name in " ".join(reasons)]
        row = self._cycle(True, most=500, mask=sum(wanted))
        return [row]

    def _cycle(self, shown: bool, most: int = 1, mask: int = PATH_EVENT) -> str:
        state = self.state
        state.clock[0]["mask"] = mask
        state.recorder.filled[0] = 0
        done = advance(state, most)
        self.done += done
        clock, path = state.clock[0], state.paths.row[PATH]
        raised = [name for bit, name in RAISED.items() if clock["raised"] & bit]
        if clock["raised"] & PATH_EVENT:
            raised.append(str(path["event"]))
        if clock["raised"] & OF_AN_AXIS:
            raised.append(AXES[AXIS.index(clock["axis"])])
        assert raised or clock["axis"] == -1
        if not shown and not raised:
            return ""
        setpoints, actual = state.setpoint[[*AXIS]], state.servo.actual[[*AXIS]]
        if done == 1:  # the record has it all
            row = state.recorder.rows[0]
            recorded = row[LEADING:][[*AXIS, *(3 + axis for axis in AXIS)]]
            assert list(recorded) == [*setpoints, *actual]
            assert (row[FEED_MM_S], row[BLOCK]) == (path["speed"], path["tag"])
            assert row[TIME_S] == self.done * CYCLE_S
            if row[IS_RAPID]:
                raised.insert(0, "rapid")
        numbers = [*setpoints, path["speed"], *(actual if self.shows_actual else ())]
        line = f"{self.done:4d} " + " ".join(f"{number:11.6f}" for number in numbers)
        return f"{line} {path['tag']:3d} {', '.join(raised)}".rstrip()

    def do_skip(self, until: str) -> list[str]:
        self._prepare()
        cycles = skip(self.state, PATH, int(until))
        self.done += cycles
        return [f"{cycles} cycles to " + " ".join(f"{place:.6f}" for place in self.state.setpoint[[*AXIS]])]

    def do_segments(self) -> list[str]:
        """Show what the segments ahead are planned with: length, cap, acceleration, junction, speed at the end."""
        self._prepare()
        path, said = self.state.paths.row[PATH], []
        for count in range(int(path["head"]), int(path["prepared"])):
            row = self._row(count)
            names = ("length", "cap", "accel", "junction", "out", "yield_before", "yield_after")
            numbers = " ".join(f"{row[name]:11.6f}" for name in names)
            said.append(f"{KINDS[row['kind']]:>6} {numbers} {row['tag']:3d}")
        return [*said, f"from {path['head']} on, final up to {path['planned']}"]

    def do_extents(self) -> list[str]:
        self._prepare()
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        measure_queue(
            self.state.seg, self.state.paths, PATH, int(self.state.paths.row[PATH]["head"]), low, high
        )
        return [" ".join(f"{number:.6f}" for number in box) for box in (low, high)]

    def do_totals(self) -> list[str]:
        totals = self.state.paths.totals[PATH]
        names = ("rapid s", "feed s", "wait s", "rapid length", "feed length", "segments", "top speed")
        assert len(names) == TOP_SPEED + 1
        return [", ".join(f"{name} {total:.6f}" for name, total in zip(names, totals, strict=True))]
