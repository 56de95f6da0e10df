"""Spindle, tool, coolant and other auxiliary functions: what they change, and the waits they queue.

They take effect at rest, in the order: spindle speed, tool, tool change, spindle, coolant, others; then the
motion of the block; then program stops and the program end. The power of a laser changes without a stop.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace

from polycnc.errors import ProgramError
from polycnc.nc.blocks import _feeds as feeds
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._channel_state import of_another_channel
from polycnc.nc.blocks._moves import Stop, Wait
from polycnc.nc.blocks._tool_offsets import tool_data
from polycnc.nc.blocks._words import NEXT_TOOL, GWord, MWord, code_text, whole_number
from polycnc.nc.modal._actions import M_SENSES, SPINDLE_SENSES, Action, Group, MAction, coolant_with
from polycnc.nc.modal._modal import FEED_MODE, FEED_PER_MINUTE, INCH
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
    MAction.SET_TOOL,
    MAction.AUXILIARY,
    MAction.AUXILIARY_WORDS,
    MAction.OUTPUT_IN_STEP,
    MAction.OUTPUT_AT_ONCE,
)
_OUTPUTS = (MAction.OUTPUT_IN_STEP, MAction.OUTPUT_AT_ONCE)
_AFTER_MOTION = (MAction.PROGRAM_STOP, MAction.OPTIONAL_STOP, MAction.PROGRAM_END)
_STOPS = {MAction.PROGRAM_STOP: Stop.PROGRAM, MAction.OPTIONAL_STOP: Stop.OPTIONAL}
_DIRECTION = {**SPINDLE_SENSES, MAction.SPINDLE_ORIENT: 0}
_PARAMETERS = "PQREL"
"""What a function with words takes where the dialect says nothing, in the order in which its event names them."""
_WITH_SPEED = (*_DIRECTION, MAction.RIGID_TAP)
_COOLANT = (MAction.COOLANT_MIST, MAction.COOLANT_FLOOD, MAction.COOLANT_OFF)
_M_PER_FOOT = 12.0 * MM_PER_INCH / 1000.0


def spindle_speed(block: BlockContext) -> None:
    """Carry out S and what it means; alone, S is a function of its own."""
    speed = block.words.take("S")
    if speed is not None and _clamps(block, speed):
        speed = None
    if g := block.words.g.get(Group.SPINDLE_MODE):
        _set_mode(block, g, speed)
    if speed is not None:
        _set_speed(block, speed)
        block.speed = speed
        if not _has_laser(block) and not any(m.action in _WITH_SPEED for m in block.words.m):
            block.items.append(Wait(0.0, block.line, (f"S{code_text(speed.value)}",)))


def select_tool(block: BlockContext) -> None:
    """Carry out T: the tool of the next change, or what the turret turns to."""
    word = block.words.take("T")
    if word is None:
        return
    if block.dialect.tool_word == "turret":
        block.items.append(_turn_turret(block, word))
        return
    block.after.selected_tool = whole_number(word, "a tool number", block.problem)
    following = block.words.take(NEXT_TOOL)
    if following is not None and not any(m.action is MAction.TOOL_CHANGE for m in block.words.m):
        raise block.problem("'T' is given twice without a tool change", "Write each address once.", following)


def functions(block: BlockContext) -> None:
    """Carry out the M codes that come before the block's motion, in their order."""
    for action in _BEFORE_MOTION:
        for m in block.words.m:
            if m.action is action:
                block.items += _function(block, m)


def laser_power(block: BlockContext) -> None:
    """Let the power of a laser change between two moves without a stop.

    Raises:
        ProgramError: the power follows the speed of moves that are given a time.
    """
    before, spindle = block.before.spindle, block.after.spindle
    follows = spindle.direction < 0 and spindle.speed > 0.0
    if follows and block.after.modal.whole[FEED_MODE] != FEED_PER_MINUTE and block.move_word is not None:
        raise block.problem(
            "the power of the laser follows the feed (M4), and this feed is no speed",
            "Take a feed per minute (G94), or M3 for a power that stays.",
            block.move_word,
        )
    if (before.speed, before.direction) != (spindle.speed, spindle.direction):
        block.items.append(Wait(0.0, block.line, passes=True))


def _has_laser(block: BlockContext) -> bool:
    return block.after.machine.spindle.laser


def stops(block: BlockContext) -> list[Wait]:
    """Return the waits of program stops, with a message to the operator, and of the program end."""
    return [
        Wait(0.0, block.line, (f"M{m.code}",), _STOPS.get(m.action), message=block.block.message)
        for m in block.words.m
        if m.action in _AFTER_MOTION
    ]


def _clamps(block: BlockContext, speed: Word) -> bool:
    """Take over the highest speed of constant surface speed, which S is beside the setting of a position."""
    g = block.words.g.get(Group.NON_MODAL)
    if g is None or g.action is not Action.SET_POSITION or block.dialect.d_limits_spindle:
        return False
    if speed.value <= 0.0:
        raise block.problem("the spindle's clamp is not above zero", "Write S above 0.", speed)
    block.after.spindle = replace(block.after.spindle, clamp=speed.value)
    return True


def _turn_turret(block: BlockContext, word: Word) -> Wait:
    """Turn to the tool of the first digits and take the offset of the last two."""
    number = whole_number(word, "a tool and its offset", block.problem, 9999)
    tool, offset = divmod(number, 100)
    if tool == 0 and offset:
        raise block.problem(
            f"T{code_text(word.value)} names no tool", "Write tool and offset, like T0101.", word
        )
    state = block.after
    changes = tool not in (0, state.tool)
    if tool:
        state.tool = state.selected_tool = tool
    state.compensation_tool = offset
    state.length_tool = offset
    data = tool_data(block, offset)
    axes = {"X": data.x_mm + data.wear_x_mm, "Z": data.z_mm + data.wear_z_mm}
    for name, shift_mm in axes.items():
        if shift_mm != 0.0 and of_another_channel(name) in state.axis_names:
            raise block.problem(
                f"offset {offset} moves axis {name}, which belongs to another channel",
                "Take another offset, or execute the program in that channel.",
                word,
            )
    shifts = {state.axis(name): value for name, value in axes.items()}
    state.place_zero(state.coordinates.with_length(shifts, int(offset != 0)))
    times = state.machine.times
    return Wait(times.tool_change_s if changes else 0.0, block.line, (f"T{number:04d}",))


def _set_mode(block: BlockContext, g: GWord, speed: Word | None) -> None:
    if block.dialect.d_limits_spindle and g.value:
        if speed is None:
            raise _no_cutting_speed(block, g)
        limit = block.words.take("D")
        clamp = math.inf if limit is None else abs(limit.value)
        block.after.spindle = replace(block.after.spindle, clamp=clamp)
    spindle = block.after.spindle
    surface_speed = bool(g.value)
    if surface_speed == spindle.surface_speed:
        return
    if surface_speed and _has_laser(block):
        raise block.problem(
            f"G{g.code} on a machine with a laser", "Write the power as S, without G96.", g.word
        )
    if surface_speed and speed is None:
        raise _no_cutting_speed(block, g)
    # Without S the spindle keeps the speed it has here.
    rpm = spindle.speed if surface_speed else feeds.rpm(block, block.start, block.start)
    block.after.spindle = replace(spindle, speed=rpm, surface_speed=surface_speed)


def _no_cutting_speed(block: BlockContext, g: GWord) -> ProgramError:
    hint = "Add S, in m/min (feet/min with inch words)."
    return block.problem(f"G{g.code} without a cutting speed", hint, g.word)


def _set_speed(block: BlockContext, word: Word) -> None:
    spindle = block.after.spindle
    speed = word.value
    if speed < 0.0:
        text = code_text(speed)
        raise block.problem(f"the spindle speed {text} is negative", "Turn the other way with M4.", word)
    top = block.after.machine.spindle.max_rpm
    if spindle.surface_speed:
        speed *= _M_PER_FOOT if block.after.modal.whole[INCH] else 1.0
    elif speed > top:
        block.note(f"S is above the spindle's {code_text(top)} rpm: it turns at that speed")
        speed = top
    block.after.spindle = replace(spindle, speed=speed, speed_said=True)


def _with_words(name: str, words: Sequence[Word]) -> str:
    return " ".join((name, *(f"{word.letter}{code_text(word.value)}" for word in words)))


def _function(block: BlockContext, m: MWord) -> tuple[Wait, ...]:
    """Carry out an M code; return the wait for it, none for what passes at speed."""
    if m.action in SPINDLE_SENSES and _has_laser(block):
        block.after.spindle = replace(block.after.spindle, direction=SPINDLE_SENSES[m.action], oriented=False)
        return ()
    output = block.words.by_letter.get("E")
    if m.action in _OUTPUTS and _has_laser(block) and output is not None and output.value == 0.0:
        power = block.words.by_letter.get("Q")
        if power is None:
            raise block.problem(f"M{m.code} without Q", "Add Q and the power of the laser.", m.word)
        _set_speed(block, power)
        if m.action is MAction.OUTPUT_IN_STEP:
            block.words.used |= {"E", "Q"}
            return ()
    return (_wait(block, m),)


def _parameters(block: BlockContext, m: MWord) -> list[Word]:
    """Take the words of a function.

    Raises:
        ProgramError: one that it needs is missing, or counts something and is not a whole number.
    """
    table = block.dialect.m_words
    takes = table.get(str(m.code), table.get("other", _PARAMETERS))
    words = []
    for letter, needed in re.findall(r"([A-Z])(!?)", takes):
        if (word := block.words.take(letter)) is not None:
            words.append(word)
            if needed and letter in "PE":
                whole_number(word, "a number of an output", block.problem)
        elif needed:
            raise block.problem(f"M{m.code} without {letter}", f"Add {letter} and its number.", m.word)
    return words


def _change_tool(block: BlockContext, name: str) -> Wait:
    """Take the selected tool; on some controls that stops the spindle."""
    block.after.tool = block.after.selected_tool
    tool_data(block, block.after.tool)
    if (following := block.words.by_letter.get(NEXT_TOOL)) is not None:
        block.after.selected_tool = whole_number(following, "a tool number", block.problem)
    events: tuple[str, ...] = (f"{name} T{block.after.tool}",)
    if block.dialect.tool_change_stops_spindle and block.after.spindle.direction:
        block.after.spindle = replace(block.after.spindle, direction=0)
        events = ("M5", *events)
    return Wait(block.after.machine.times.tool_change_s, block.line, events)


def _set_tool(block: BlockContext, m: MWord) -> Wait:
    """Say which tool is in the spindle."""
    number = block.words.take("Q")
    if number is None:
        raise block.problem(f"M{m.code} without Q", "Add Q and the number of the tool.", m.word)
    block.after.tool = block.after.selected_tool = whole_number(number, "a tool number", block.problem)
    tool_data(block, block.after.tool)
    return Wait(block.after.machine.times.auxiliary_s, block.line, (f"M{m.code} Q{block.after.tool}",))


def _wait(block: BlockContext, m: MWord) -> Wait:
    speed = block.speed
    times = block.after.machine.times
    name = f"M{m.code}"
    if m.action is MAction.TOOL_CHANGE:
        return _change_tool(block, name)
    if m.action is MAction.SET_TOOL:
        return _set_tool(block, m)
    if m.action is MAction.OUTPUT_IN_STEP:
        return Wait(0.0, block.line, (_with_words(name, _parameters(block, m)),), passes=True)
    if m.action is MAction.AUXILIARY_WORDS or m.action is MAction.OUTPUT_AT_ONCE:
        return Wait(times.auxiliary_s, block.line, (_with_words(name, _parameters(block, m)),))
    if m.action is MAction.RIGID_TAP:
        turned = block.after.spindle.direction != 0
        block.after.rigid_tap = True
        block.after.spindle = replace(block.after.spindle, direction=0, oriented=False)
        word = name if speed is None else f"{name} S{code_text(speed.value)}"
        return Wait(times.spindle_start_s if turned else times.auxiliary_s, block.line, (word,))
    if m.action in _DIRECTION:
        spindle = block.after.spindle
        now = replace(spindle, direction=_DIRECTION[m.action], oriented=m.action is MAction.SPINDLE_ORIENT)
        changed = now != spindle or speed is not None
        block.after.spindle = now
        word = name if speed is None else f"{name} S{code_text(speed.value)}"
        if str(m.code) in block.dialect.m_words:
            word = _with_words(word, _parameters(block, m))
        return Wait(times.spindle_start_s if changed else 0.0, block.line, (word,))
    if m.action in _COOLANT:
        _switch_coolant(block, m)
    return Wait(times.auxiliary_s, block.line, (name,))


def _switch_coolant(block: BlockContext, m: MWord) -> None:
    spindle = block.after.spindle
    coolant = coolant_with(spindle.coolant, m.code, M_SENSES[m.action])
    block.after.spindle = replace(spindle, coolant=coolant)
