"""Spindle, tool, coolant and other auxiliary functions: what they change, and the waits they queue.

They take effect at rest, in the order: spindle speed, tool, tool change, spindle, coolant, others; then the
motion of the block; then program stops and the program end.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from polycnc.machine import ToolConfig
from polycnc.nc.blocks._channel_state import ChannelState, of_another_channel
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.blocks._motion import MotionBuilder
from polycnc.nc.blocks._moves import Stop, Wait
from polycnc.nc.blocks._words import BlockWords, Fail, GWord, MWord, code_text
from polycnc.nc.modal._actions import Action, Group, MAction
from polycnc.nc.modal._modal import INCH
from polycnc.nc.text._scan_plain import Word
from polycnc.units import MM_PER_INCH

_BEFORE_MOTION = (
    MAction.TOOL_CHANGE,
    MAction.SPINDLE_CW,
    MAction.SPINDLE_CCW,
    MAction.SPINDLE_STOP,
    MAction.SPINDLE_ORIENT,
    MAction.COOLANT_MIST,
    MAction.COOLANT_FLOOD,
    MAction.COOLANT_OFF,
    MAction.RIGID_TAP,
    MAction.AUXILIARY,
)
_AFTER_MOTION = (MAction.PROGRAM_STOP, MAction.OPTIONAL_STOP, MAction.PROGRAM_END)
_STOPS = {MAction.PROGRAM_STOP: Stop.PROGRAM, MAction.OPTIONAL_STOP: Stop.OPTIONAL}
_DIRECTION = {
    MAction.SPINDLE_CW: 1, MAction.SPINDLE_CCW: -1, MAction.SPINDLE_STOP: 0, MAction.SPINDLE_ORIENT: 0,
}  # fmt: skip
_WITH_SPEED = (*_DIRECTION, MAction.RIGID_TAP)
_M_PER_FOOT = 12.0 * MM_PER_INCH / 1000.0
LARGEST_NUMBER = 99_999_999


def whole_number(word: Word, what: str, fail: Fail, largest: int = LARGEST_NUMBER) -> int:
    """Return the number of a word that counts or names something.

    Raises:
        ProgramError: it is negative, too large or not whole.
    """
    if not word.value.is_integer() or not 0 <= word.value <= largest:
        text = f"{word.letter}{code_text(word.value)}"
        raise fail(f"{text} is not {what}", f"Write a whole number from 0 to {largest}.", word)
    return int(word.value)


@dataclass
class Auxiliary:
    """Carry out S, T and M words of a block."""

    state: ChannelState
    messages: Messages
    motion: MotionBuilder
    fail: Fail
    turret: bool = False

    def before_motion(self, words: BlockWords, line: int) -> list[Wait]:
        """Return the waits of all functions that come before the block's motion."""
        waits = []
        speed = words.take("S")
        if speed is not None and self._clamps(words, speed):
            speed = None
        if g := words.g.get(Group.SPINDLE_MODE):
            self._set_mode(g, speed)
        if speed is not None:
            self._set_speed(speed)
            if not any(m.action in _WITH_SPEED for m in words.m):
                waits.append(Wait(0.0, line, (f"S{code_text(speed.value)}",)))
        tool = words.take("T")
        if tool is not None:
            if self.turret:
                waits += self._turn_turret(tool, line)
            else:
                self.state.selected_tool = whole_number(tool, "a tool number", self.fail)
        if words.m:
            for action in _BEFORE_MOTION:
                waits += [self._function(m, speed, line) for m in words.m if m.action is action]
        return waits

    def after_motion(self, words: BlockWords, line: int, message: str = "") -> list[Wait]:
        """Return the waits of program stops, with a message to the operator, and of the program end."""
        return [
            Wait(0.0, line, (f"M{m.code}",), _STOPS.get(m.action), message=message)
            for m in words.m
            if m.action in _AFTER_MOTION
        ]

    def tool_data(self, tool: int) -> ToolConfig:
        """Return the data of a tool, zeros with a message if there are none; tool 0 is no tool."""
        tools = self.state.machine.tools
        if self.state.tables.has_tool(tool):
            return self.state.tables.tool(tool)
        if tool and not tools:
            self.messages.add("the machine has no tool table: lengths and radii of all tools are 0 mm")
        elif tool:
            self.messages.add(
                f"tool {tool} is not in the machine's tool table: its length and radius are 0 mm"
            )
        return ToolConfig()

    def _clamps(self, words: BlockWords, speed: Word) -> bool:
        """Take over the highest speed of constant surface speed, which S is beside the setting of a position."""
        g = words.g.get(Group.NON_MODAL)
        if g is None or g.action is not Action.SET_POSITION:
            return False
        if speed.value <= 0.0:
            raise self.fail("the spindle's clamp is not above zero", "Write S above 0.", speed)
        self.state.spindle = replace(self.state.spindle, clamp=speed.value)
        return True

    def _turn_turret(self, word: Word, line: int) -> list[Wait]:
        """Turn to the tool of the first digits and take the offset of the last two."""
        number = whole_number(word, "a tool and its offset", self.fail, 9999)
        tool, offset = divmod(number, 100)
        if tool == 0 and offset:
            raise self.fail(
                f"T{code_text(word.value)} names no tool", "Write tool and offset, like T0101.", word
            )
        state = self.state
        changes = tool not in (0, state.tool)
        if tool:
            state.tool = state.selected_tool = tool
        state.compensation_tool = offset
        state.length_tool = offset
        data = self.tool_data(offset)
        axes = {"X": data.x_mm + data.wear_x_mm, "Z": data.z_mm + data.wear_z_mm}
        for name, shift_mm in axes.items():
            if shift_mm != 0.0 and of_another_channel(name) in state.axis_names:
                raise self.fail(
                    f"offset {offset} moves axis {name}, which belongs to another channel",
                    "Take another offset, or execute the program in that channel.",
                    word,
                )
        letters = state.modal.letter_axis
        state.coordinates.set_tool(
            {int(letters[ord(name) - ord("A")]): value for name, value in axes.items()}, active=offset != 0
        )
        times = state.machine.times
        return [Wait(times.tool_change_s if changes else 0.0, line, (f"T{number:04d}",))]

    def _set_mode(self, g: GWord, speed: Word | None) -> None:
        spindle = self.state.spindle
        surface_speed = bool(g.value)
        if surface_speed == spindle.surface_speed:
            return
        if surface_speed and speed is None:
            raise self.fail(
                f"G{g.code} without a cutting speed", "Add S, in m/min (feet/min with inch words).", g.word
            )
        # Without S the spindle keeps the speed it has here.
        rpm = spindle.speed if surface_speed else self.motion.rpm(self.motion.start, self.motion.start)
        self.state.spindle = replace(spindle, speed=rpm, surface_speed=surface_speed)

    def _set_speed(self, word: Word) -> None:
        spindle = self.state.spindle
        speed = word.value
        if speed < 0.0:
            text = code_text(speed)
            raise self.fail(f"the spindle speed {text} is negative", "Turn the other way with M4.", word)
        top = self.state.machine.spindle.max_rpm
        if spindle.surface_speed:
            speed *= _M_PER_FOOT if self.state.modal.whole[INCH] else 1.0
        elif speed > top:
            self.messages.add(f"S is above the spindle's {code_text(top)} rpm: it turns at that speed")
            speed = top
        self.state.spindle = replace(spindle, speed=speed)

    def _function(self, m: MWord, speed: Word | None, line: int) -> Wait:
        times = self.state.machine.times
        name = f"M{m.code}"
        if m.action is MAction.TOOL_CHANGE:
            self.state.tool = self.state.selected_tool
            self.tool_data(self.state.tool)
            return Wait(times.tool_change_s, line, (f"{name} T{self.state.tool}",))
        if m.action is MAction.RIGID_TAP:
            turned = self.state.spindle.direction != 0
            self.state.rigid_tap = True
            self.state.spindle = replace(self.state.spindle, direction=0, oriented=False)
            word = name if speed is None else f"{name} S{code_text(speed.value)}"
            return Wait(times.spindle_start_s if turned else times.auxiliary_s, line, (word,))
        if m.action in _DIRECTION:
            spindle = self.state.spindle
            now = replace(
                spindle, direction=_DIRECTION[m.action], oriented=m.action is MAction.SPINDLE_ORIENT
            )
            changed = now != spindle or speed is not None
            self.state.spindle = now
            word = name if speed is None else f"{name} S{code_text(speed.value)}"
            return Wait(times.spindle_start_s if changed else 0.0, line, (word,))
        return Wait(times.auxiliary_s, line, (name,))
