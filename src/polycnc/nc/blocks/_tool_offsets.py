"""Tools that shift several axes, and codes that name their data in the block (G43, G43.1, G43.2, G41.1, G10 L1)."""

from __future__ import annotations

from polycnc.errors import ProgramError
from polycnc.machine import ToolConfig
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._motion import axis_words, named_axes
from polycnc.nc.blocks._turned_offsets import other_frame, tool_that_reads
from polycnc.nc.blocks._word_checks import refuse_rest
from polycnc.nc.blocks._words import GWord, whole_number
from polycnc.nc.modal._actions import Action, Group
from polycnc.nc.modal._modal import NO_AXIS, PLANE, PLANE_ZX, length_scale

OFFSETS = (Action.TOOL_OFFSET, Action.TOOL_OFFSET_VALUES, Action.TOOL_OFFSET_ADD)
TURNED_TIPS = (0, 4, 3, 2, 1, 5, 8, 7, 6, 9)
"""The tip of a tool file by the orientation in LinuxCNC, and back: X points the other way.

Source: LinuxCNC user manual, "Lathe User Information", "Tool Orientation".
"""
_FIELDS = {"X": "x_mm", "Y": "y_mm", "Z": "length_mm"}
REFERENCE_SYSTEM = "G59.3"
"""The work offset whose zero is a known point of the fixture. Source: LinuxCNC G-code manual, "G10 L11"."""


def _no_tool(block: BlockContext, tool: int, letters: str) -> ProgramError:
    hint = f"Add it to the machine file, like {tool} = {{length_mm = 0, radius_mm = 3}} in [tools]."
    return block.problem(f"tool {tool} is not in the tool table", hint, block.words.first(*letters))


def tool_data(block: BlockContext, tool: int) -> ToolConfig:
    """Return the data of a tool, zeros with a message if there are none; tool 0 is no tool."""
    tools = block.after.machine.tools
    if block.after.tables.has_tool(tool):
        return block.after.tables.tool(tool)
    if tool and tools and "unknown tools" in block.dialect.refuses:
        raise _no_tool(block, tool, "HDQT")
    if tool and not tools:
        block.note("the machine has no tool table: lengths and radii of all tools are 0 mm")
    elif tool:
        block.note(f"tool {tool} is not in the machine's tool table: its length and radius are 0 mm")
    return ToolConfig()


def offsets_of(state: ChannelState, tool: ToolConfig) -> dict[int, float]:
    """Return what a tool shifts each axis by (mm)."""
    axes = {"X": tool.x_mm + tool.wear_x_mm, "Y": tool.y_mm, "Z": tool.length_mm + tool.wear_length_mm}
    return {axis: value for name, value in axes.items() if (axis := state.axis(name)) != NO_AXIS}


def shift_by_tool(block: BlockContext, g: GWord) -> None:
    """Shift axes by a tool, by values, or by one more tool.

    Raises:
        ProgramError: there is an axis word missing, or an H.
    """
    if (motion := block.words.g.get(Group.MOTION)) and g.action is Action.TOOL_OFFSET_VALUES:
        raise block.problem(
            f"G{g.code} and G{motion.code} exclude each other: both use the axis words",
            "Write them in two blocks.",
            motion.word,
        )
    state, coordinates = block.after, block.after.coordinates
    in_force: list[float] = coordinates.length.tolist()
    if g.action is Action.TOOL_OFFSET_VALUES:
        shifts = {**dict(enumerate(in_force)), **named_axes(block, g)}
    else:
        word = block.words.take("H")
        if g.action is Action.TOOL_OFFSET_ADD:
            if word is None:
                raise block.problem(f"G{g.code} without H", "Add H and the number of the tool.", g.word)
            if axis_words(block):
                raise block.problem(f"G{g.code} with axis words", "Move in a block of its own.", g.word)
        tool = state.tool if word is None else whole_number(word, "a tool offset number", block.problem)
        shifts = offsets_of(state, tool_data(block, tool))
        if g.action is Action.TOOL_OFFSET_ADD:
            shifts = {axis: value + shifts.get(axis, 0.0) for axis, value in enumerate(in_force)}
        state.length_tool = tool
    state.place_zero(coordinates.with_length(shifts, 1))


def diameter_of(block: BlockContext, g: GWord) -> ToolConfig:
    """Take D and L of a code that names the tool's diameter and where its tip lies.

    Raises:
        ProgramError: a word is missing, or has no meaning.
    """
    diameter = block.words.take("D")
    if diameter is None:
        raise block.problem(f"G{g.code} without D", "Add D and the tool's diameter.", g.word)
    tip = 0
    if word := block.words.take("L"):
        tip = whole_number(word, "where a tip lies", block.problem, len(TURNED_TIPS) - 1)
        if block.after.modal.whole[PLANE] != PLANE_ZX:
            raise block.problem(
                f"G{g.code} with L in another plane than G18", "Select G18, or take L out.", word
            )
    radius = abs(diameter.value) * length_scale(block.after.modal) / 2.0
    return ToolConfig.model_construct(**{**dict(ToolConfig()), "radius_mm": radius, "tip": TURNED_TIPS[tip]})


def _own_size(block: BlockContext) -> dict[str, float]:
    """Take R and Q of a tool: its radius, and where its tip lies."""
    changes: dict[str, float] = {}
    if (radius := block.words.length("R")) is not None:
        if radius < 0.0:
            raise block.problem("the radius is negative", "Write R from 0 up.", block.words.first("R"))
        changes["radius_mm"] = radius * length_scale(block.after.modal)
    if (tip := block.words.take("Q")) is not None:
        changes["tip"] = TURNED_TIPS[whole_number(tip, "where a tip lies", block.problem, 9)]
    return changes


def set_tool(block: BlockContext, g: GWord, table: int, number: int) -> None:
    """Set a tool of the table: L1 to values, L10 and L11 so that the present position reads them.

    Raises:
        ProgramError: there is no such tool, or a word has no meaning.
    """
    state, tables = block.after, block.after.tables
    if not tables.has_tool(number) and state.machine.tools:
        raise _no_tool(block, number, "P")
    for letter in "IJ":
        if word := block.words.take(letter):
            raise block.problem(
                f"{letter} is an angle of a tool, which tools do not have here", "Remove it.", word
            )
    values = axis_words(block)
    if table != 1:
        if other_frame(state):
            raise block.problem(
                f"G{g.code} L{table} while positions are turned or scaled", "Cancel that first.", g.word
            )
        name = state.coordinates.work[0] if table == 10 else REFERENCE_SYSTEM
        shifts = offsets_of(state, tables.tool(number))
        values = tool_that_reads(state, name, values, shifts, shifted=table == 10)
    changes: dict[str, float] = {}
    for axis, value in values.items():
        letter = state.axis_names[axis]
        if letter not in _FIELDS:
            raise block.problem(
                f"a tool has no offset along {letter}", "Tools shift X, Y and Z.", block.words.first(letter)
            )
        changes[_FIELDS[letter]] = value
    changes |= _own_size(block)
    if not changes:
        raise block.problem(f"G{g.code} L{table} without a value", "Add X, Y, Z, R or Q.", g.word)
    refuse_rest(block, g)
    tables.set_tool(number, **changes)
