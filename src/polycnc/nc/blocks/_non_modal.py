"""Functions that take the axis words of their block for themselves: G28, G30, G53 (one block), G92, G92.1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from polycnc.machine import first_contact
from polycnc.nc.blocks._auxiliary import whole_number
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.blocks._motion import MotionBuilder
from polycnc.nc.blocks._moves import Feed, Line, QueueItem, Stop, Wait
from polycnc.nc.blocks._probe import Probe
from polycnc.nc.blocks._words import Fail, GWord
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._modal import MOTION_LINEAR, MOTION_RAPID

REFERENCE_POSITIONS = 4
_CANCEL_FIRST = "Cancel it with G40 first."


@dataclass
class NonModal:
    """Carry out the non-modal functions."""

    state: ChannelState
    messages: Messages
    motion: MotionBuilder
    fail: Fail

    def carry_out(self, g: GWord, motion: int, line: int) -> Sequence[QueueItem]:
        """Return the moves of a block with such a function; `motion` is the motion in force.

        Raises:
            ProgramError: the block does not fit the function, or a limit would be passed.
        """
        match g.action:
            case Action.SET_POSITION:
                self._set_position(g)
            case Action.CLEAR_SET_POSITION:
                self._refuse_compensation(g, self.state.compensation.active)
                self.state.coordinates.clear_shift()
            case Action.REFERENCE_RETURN:
                return self._reference_return(g, 1, line)
            case Action.REFERENCE_POINT:
                return self._reference_return(g, self._reference_number(g), line)
            case Action.MACHINE_COORDINATES:
                return self._machine_move(g, motion, line)
            case Action.SKIP_MOVE:
                return self._skip_move(g, line)
            case Action.PROBE_MOVE | Action.PROBE_IN_PASSING:
                return self._probe_move(g, line, in_passing=g.action is Action.PROBE_IN_PASSING)
            case Action.PROBE_FIXED_STOP:
                return self._to_fixed_stop(g, line)
            case _:
                raise self.fail(f"G{g.code} cannot be carried out", "Take it out.", g.word)
        return []

    def _refuse_compensation(self, g: GWord, active: bool) -> None:
        if active:
            raise self.fail(f"G{g.code} while radius compensation is active", _CANCEL_FIRST, g.word)

    def _skip_move(self, g: GWord, line: int) -> list[QueueItem]:
        """Go straight at feed until the skip signal comes, at the latest to the end; what follows waits for it."""
        self._refuse_compensation(g, self.state.side != 0 or self.state.compensation.active)
        values = self.motion.axis_words()
        if not values:
            raise self.fail(f"G{g.code} without an axis", "Say how far to go at the most.", g.word)
        move = replace(self.motion.line(self.motion.target(values), False, line), exact_stop=True)
        self.state.skip_position = move.end
        wait = Wait(0.0, line, stop=Stop.DRAIN)
        self.state.probe = Probe(frozenset(values))
        return [Wait(0.0, line, stop=Stop.PROBE), move, wait]

    def _probe_move(self, g: GWord, line: int, *, in_passing: bool) -> list[QueueItem]:
        """Go straight at feed until the probe switches, or measure in passing; preparation waits for the end."""
        move = self._measuring_move(g, line, one_axis=in_passing)
        stop = Stop.PROBE_IN_PASSING if in_passing else Stop.PROBE
        return [Wait(0.0, line, stop=stop), move, Wait(0.0, line, stop=Stop.DRAIN)]

    def _to_fixed_stop(self, g: GWord, line: int) -> list[QueueItem]:
        """Go to a stop that the axes cannot pass, at the most to the end; it is met without going beyond."""
        move = self._measuring_move(g, line)
        probe = self.state.probe
        assert probe is not None
        machine = self.state.machine
        if (met := first_contact(machine.surfaces, machine.axis_names, move.start, move.end)) is not None:
            self.state.probe = replace(probe, position=met)
            move = replace(move, end=met)
        return [move, Wait(0.0, line, stop=Stop.DRAIN)]

    def _measuring_move(self, g: GWord, line: int, *, one_axis: bool = False) -> Line:
        self._refuse_compensation(g, self.state.side != 0 or self.state.compensation.active)
        values = self.motion.axis_words()
        if not values or (one_axis and len(values) > 1):
            count = "one axis" if one_axis else "an axis"
            raise self.fail(f"G{g.code} needs {count}", "Say how far to go at the most.", g.word)
        measured = frozenset(values) if one_axis else frozenset(range(len(self.state.axis_names)))
        self.state.probe = Probe(measured, one_axis)
        return replace(self.motion.line(self.motion.target(values), False, line), exact_stop=True)

    def _set_position(self, g: GWord) -> None:
        self._refuse_compensation(g, self.state.compensation.active)
        if self.state.frame.active:
            raise self.fail(
                f"G{g.code} while positions are turned, scaled or mirrored", "Cancel that first.", g.word
            )
        values = self.motion.axis_words()
        if not values and "S" not in self.motion.words.by_letter:  # S is the spindle's clamp
            raise self.fail(
                f"G{g.code} without an axis", "Name the axes and the positions they shall read.", g.word
            )
        for axis, value in values.items():
            self.state.coordinates.set_position(axis, value)

    def _reference_number(self, g: GWord) -> int:
        """Take P: which reference position, the second if there is none."""
        word = self.motion.words.take("P")
        number = 2 if word is None else whole_number(word, "a reference position", self.fail)
        if not 2 <= number <= REFERENCE_POSITIONS:
            raise self.fail(
                f"there is no reference position P{number}", f"Write P2 to P{REFERENCE_POSITIONS}.", word
            )
        if not any(len(axis.reference_positions) > number - 2 for axis in self.state.machine.axes):
            self.messages.add(
                f"G{g.code}: the machine file has no reference position {number}: the home position stands for it"
            )
        return number

    def _reference_return(self, g: GWord, number: int, line: int) -> list[Line]:
        """Go to the point that the axis words name, then with these axes (all, if none) to a reference position."""
        self._refuse_compensation(g, self.state.side != 0)
        values = self.motion.axis_words()
        start = self.motion.start
        middle = self.motion.target(values)
        self.motion.check_limits(middle, "would pass")
        home = tuple(
            self.motion.turned(index, axis.reference_position(number), middle[index])
            if index in values or not values
            else middle[index]
            for index, axis in enumerate(self.state.machine.axes)
        )
        self.motion.check_limits(home, "would go home to")
        self._remark_home(g, [index for index in range(len(home)) if index in values or not values])
        return [Line(start, middle, Feed(), True, True, line), Line(middle, home, Feed(), True, True, line)]

    def _remark_home(self, g: GWord, axes: list[int]) -> None:
        """Say that home is the part's zero, where it is: on hardly any machine it is."""
        machine, offset = self.state.machine, self.state.modal.offset
        linear = [index for index in axes if machine.axes[index].kind == "linear"]
        if linear and all(machine.axes[index].home == offset[index] for index in linear):
            self.messages.add(
                f"G{g.code}: home lies at the part's zero on machine '{machine.name}'; a machine file says where it is"
            )

    def _machine_move(self, g: GWord, motion: int, line: int) -> list[Line]:
        self._refuse_compensation(g, self.state.side != 0)
        if motion not in (MOTION_RAPID, MOTION_LINEAR) or self.state.cycle.action:
            raise self.fail(f"G{g.code} goes with G0 or G1 only", "Write G0 or G1 in this block.", g.word)
        end = self.motion.target(self.motion.axis_words(), machine_coordinates=True)
        return [self.motion.line(end, motion == MOTION_RAPID, line)]
