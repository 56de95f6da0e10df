"""The tools of a run with their shapes: from the machine file, and from the remarks of programs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace

from polycnc.errors import UsageError
from polycnc.machine import MachineConfig, ToolConfig
from polycnc.nc import ProgramText
from polycnc.stock import Form, Tool, ToolKind, stock_of_remarks, tool_number, tool_of_remark

_REMARK_OR_TOOL = re.compile(  # an M6 counts for the T before it
    rb"\(([^)\r\n]*)\)|;([^\r\n]*)|[Tt][ \t]*0*([0-9]+)|[Mm]0*(6)(?![0-9.])(?![^\r\n(;]*[Tt][ \t]*[0-9])"
)
_REMARK = re.compile(rb"\(([^)\r\n]*)\)|;([^\r\n]*)")
_INCH = re.compile(rb"[Gg]0*20(?![0-9.])")


def tools_of(config: MachineConfig, texts: Mapping[str, ProgramText]) -> dict[int, Tool]:
    """Return the tools that the machine file and the remarks of the programs describe.

    A shape in the machine file comes first, then remarks, then its description and radius; how long it cuts, shank and
    holder are those of the machine file.

    Raises:
        UsageError: the machine file describes a tool that there cannot be.
    """
    tools = {}
    for number, each in config.tools.items():
        described = tool_of_remark(each.description)
        if described is not None:
            tools[number] = described
        elif each.radius_mm > 0.0:
            with named_tool(number, config):
                tools[number] = Tool(ToolKind.FLAT, 2.0 * each.radius_mm)
    for text in texts.values():
        inch = _is_inch(text)
        for number, remark in remarks_of_tools(text):
            if (found := tool_of_remark(remark, inch=inch)) is not None:
                tools[number] = found
    for number, each in config.tools.items():
        with named_tool(number, config):
            if (whole := _whole(tools.get(number), each)) is not None:
                tools[number] = whole
    return tools


@contextmanager
def named_tool(number: int, config: MachineConfig) -> Iterator[None]:
    """Name a tool of the machine file in what is wrong with it."""
    try:
        yield
    except UsageError as error:
        raise UsageError(f"tool {number} of '{config.name}': {error.what}", hint=error.hint) from None


def _is_inch(text: ProgramText) -> bool:
    return _INCH.search(text.content) is not None


def _whole(tool: Tool | None, config: ToolConfig) -> Tool | None:
    """Return a tool with what its table in the machine file says of it."""
    if config.shape is not None:
        radius_mm = max((radius for radius, _ in config.outline), default=config.radius_mm)
        if not radius_mm > 0.0:
            raise UsageError(f"a {config.shape} tool without a radius", hint="Give 'radius_mm'.")
        tool = Tool(
            ToolKind(config.shape),
            2.0 * radius_mm,
            corner_mm=config.corner_mm,
            angle_deg=config.angle_deg,
            tip_mm=config.tip_diameter_mm,
            outline=config.outline,
        )
    if tool is None:
        return None
    return replace(
        tool,
        flute_mm=config.flute_mm or tool.flute_mm,
        shank=tuple((height, 0.5 * diameter) for height, diameter in config.shank),
        holder=tuple((height, 0.5 * diameter) for height, diameter in config.holder),
        left_hand=config.left_hand or tool.left_hand,
        teeth=config.teeth or tool.teeth,
    )


def said_form(form: Form, texts: Mapping[str, ProgramText]) -> tuple[Form, str]:
    """Return the body that the remarks of programs say in place of `auto`, and a word about that for a message."""
    if form.text == "auto":
        for text in texts.values():
            remarks = (found[1] or found[2] for found in _REMARK.finditer(text.content))
            inch = _is_inch(text)
            said = stock_of_remarks((each.decode("utf-8", "replace") for each in remarks if each), inch=inch)
            if said is not None:
                return replace(form, text=said), f", as '{text.name}' says"
    return form, ""


def remarks_of_tools(text: ProgramText) -> Iterator[tuple[int, str]]:
    """Yield numbers of tools with remarks: those that name them, the last one before a T word, or before its M6."""
    last, number = "", None
    for found in _REMARK_OR_TOOL.finditer(text.content):
        if found[3] is not None or found[4] is not None:
            number = int(found[3][:9]) if found[3] is not None else number
            if last and number is not None:
                yield number, last
            last = ""
            continue
        remark = (found[1] or found[2] or b"").decode("utf-8", "replace")
        named = tool_number(remark)
        if named is not None:
            yield named, remark
        last = "" if named is not None else remark


def hand_tool(texts: Mapping[str, ProgramText], tools: Mapping[int, Tool]) -> Tool | None:
    """Return the tool of programs that never change it: by their one T word, else the only one that is described."""
    numbers, described = set[int](), list[Tool]()
    for text in texts.values():
        inch = _is_inch(text)
        for found in _REMARK_OR_TOOL.finditer(text.content):
            if found[3] is not None:
                numbers.add(int(found[3][:9]))
            remark = (found[1] or found[2] or b"").decode("utf-8", "replace")
            if (tool := tool_of_remark(remark, inch=inch)) is not None and tool not in described:
                described.append(tool)
    if numbers:
        return tools.get(numbers.pop()) if len(numbers) == 1 else None
    only = described or list(tools.values())
    return only[0] if len(only) == 1 else None
