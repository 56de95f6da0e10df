"""Spindle, tool, coolant and other auxiliary functions: what they change and the wait they put into the queue.

They take effect at rest, in the order: spindle speed, tool, tool change, spindle, coolant, others; then the
motion of the block; then program stops and the program end.
"""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.nc._actions import MAction
from polycnc.nc._channel_state import ChannelState
from polycnc.nc._messages import Messages
from polycnc.nc._moves import Wait
from polycnc.nc._words import BlockWords, Fail, MWord

_BEFORE_MOTION = (
    MAction.TOOL_CHANGE,
    MAction.SPINDLE_CW,
    MAction.SPINDLE_CCW,
    MAction.SPINDLE_STOP,
    MAction.COOLANT_MIST,
    MAction.COOLANT_FLOOD,
    MAction.COOLANT_OFF,
    MAction.AUXILIARY,
)
_AFTER_MOTION = (MAction.PROGRAM_STOP, MAction.OPTIONAL_STOP, MAction.PROGRAM_END)
_DIRECTION = {MAction.SPINDLE_CW: 1, MAction.SPINDLE_CCW: -1, MAction.SPINDLE_STOP: 0}


@dataclass
class Auxiliary:
    """Carry out S, T and M words of a block."""

    state: ChannelState
    messages: Messages
    fail: Fail

    def before_motion(self, words: BlockWords, line: int) -> list[Wait]:
        """Return the waits of all functions that come before the block's motion."""
        waits = []
        speed = words.take("S")
        if speed is not None:
            self._set_speed(speed.value)
            if not any(m.action in _DIRECTION for m in words.m):
                waits.append(Wait(0.0, line, (f"S{speed.value:g}",)))
        self._select_tool(words)
        for action in _BEFORE_MOTION:
            waits += [self._function(m, speed is not None, line) for m in words.m if m.action is action]
        return waits

    def after_motion(self, words: BlockWords, line: int) -> list[Wait]:
        """Return the waits of program stops and the program end."""
        return [Wait(0.0, line, (f"M{m.code}",)) for m in words.m if m.action in _AFTER_MOTION]

    def _set_speed(self, speed: float) -> None:
        if speed < 0.0:
            raise self.fail(f"the spindle speed {speed:g} is negative", "Turn the other way with M4.", None)
        top = self.state.machine.spindle.max_rpm
        if speed > top and not self.state.spindle.surface_speed:
            self.messages.add(f"S above the spindle's {top:g} rpm: the spindle turns at its highest speed")
            speed = top
        self.state.spindle.speed = speed

    def _select_tool(self, words: BlockWords) -> None:
        tool = words.take("T")
        if tool is None:
            return
        if tool.value < 0 or tool.value != int(tool.value):
            raise self.fail(f"T{tool.value:g} is not a tool number", "Write a whole number from 0 up.", tool)
        self.state.selected_tool = int(tool.value)

    def _function(self, m: MWord, has_speed: bool, line: int) -> Wait:
        times = self.state.machine.times
        name = f"M{m.code}"
        if m.action is MAction.TOOL_CHANGE:
            self.state.tool = self.state.selected_tool
            return Wait(times.tool_change_s, line, (f"{name} T{self.state.tool}",))
        if m.action in _DIRECTION:
            changed = self.state.spindle.direction != _DIRECTION[m.action]
            self.state.spindle.direction = _DIRECTION[m.action]
            word = f"{name} S{self.state.spindle.speed:g}" if has_speed else name
            return Wait(times.spindle_start_s if changed or has_speed else 0.0, line, (word,))
        return Wait(times.auxiliary_s, line, (name,))
