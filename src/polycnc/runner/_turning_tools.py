"""The turning tools of a run: from the machine file, and from the remarks of programs."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from polycnc.errors import UsageError
from polycnc.machine import MachineConfig, ToolConfig
from polycnc.nc import TIPS, ProgramText
from polycnc.runner._stock_tools import named_tool, remarks_of_tools, tools_of
from polycnc.stock import Insert, Tool, ToolKind, grooving_tool, iso_insert, threading_tool

_INSIDE = re.compile(r"\bbor(?:e|ing)\b|\binside\b|\binternal\b", re.IGNORECASE)
_GROOVE = re.compile(r"\b(?:groov|part(?:ing)?[ -]?off|parting|cut[ -]?off)", re.IGNORECASE)
_THREAD = re.compile(r"^(?!.*\bmill).*\bthread", re.IGNORECASE)
_MM = re.compile(r"(\d+(?:\.\d*)?|\.\d+)\s*mm\b", re.IGNORECASE)
_DEG = re.compile(r"(\d+(?:\.\d*)?)\s*(?:deg|°)", re.IGNORECASE)
_THREAD_DEG = 60.0
_TO_THE_AXIS = -1.0


def turning_tools_of(config: MachineConfig, texts: Mapping[str, ProgramText]) -> dict[int, Tool | Insert]:
    """Return the tools of a lathe that the machine file and the remarks of programs describe; the file comes first.

    Raises:
        UsageError: the machine file describes a tool that there cannot be.
    """
    # What a mill calls a boring bar is here a bar whose insert is not known.
    on_axis = (each for each in tools_of(config, texts).items() if each[1].kind is not ToolKind.BORING)
    tools: dict[int, Tool | Insert] = dict(on_axis)
    for text in texts.values():
        for number, remark in remarks_of_tools(text):
            at = config.tools.get(number, ToolConfig())
            if (insert := _of_remark(remark, at)) is not None:
                tools[number] = insert
    for number, at in config.tools.items():
        with named_tool(number, config):
            insert = _of_table(at)
            known = tools.get(number) if insert is None else insert
            if isinstance(known, Insert):
                tools[number] = replace(known, left_hand=at.left_hand)
    return tools


def _of_table(at: ToolConfig) -> Insert | None:
    inside, tip = _placed(at)
    if at.insert:
        found = iso_insert(at.insert, at.approach_deg, inside=inside, tip=tip)
        if found is None:
            raise UsageError(f"an insert '{at.insert}'", hint="Write it like CNMG120408.")
        return found
    if at.width_mm > 0.0:
        return grooving_tool(at.width_mm, at.radius_mm, at.flute_mm or 1000.0, inside=inside, tip=tip)
    if at.thread_deg > 0.0:
        return threading_tool(at.thread_deg, at.radius_mm, inside=inside, tip=(tip[0], 0.0))
    return _of_remark(at.description, at) if at.description else None


def _of_remark(remark: str, at: ToolConfig) -> Insert | None:
    inside, tip = _placed(at, inside=_INSIDE.search(remark) is not None)
    try:
        if (found := iso_insert(remark, at.approach_deg, inside=inside, tip=tip)) is not None:
            return found
        if _GROOVE.search(remark) and (width := _MM.search(remark)):
            return grooving_tool(float(width[1]), at.radius_mm, inside=inside, tip=tip)
        if _THREAD.search(remark):
            angle = _DEG.search(remark)
            return threading_tool(float(angle[1]) if angle else _THREAD_DEG, inside=inside, tip=(tip[0], 0.0))
    except UsageError:
        return None
    return None


def _placed(at: ToolConfig, *, inside: bool = False) -> tuple[bool, tuple[float, float]]:
    """Return whether a tool cuts away from the axis, and the way from the middle of its nose to what programs guide.

    Where the table says neither a tip nor a radius, programs guide the imaginary tip towards -Z.
    """
    if at.tip or at.radius_mm > 0.0:
        tip = TIPS[at.tip]
        return inside or tip[0] > 0.0, tip
    return inside, (-_TO_THE_AXIS if inside else _TO_THE_AXIS, -1.0)
