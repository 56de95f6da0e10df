"""Leave out what is not known of a course: where nobody set the machine's own positions, what unknown tools leave."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from polycnc.nc import ProgramText
from polycnc.runner._blocks import Blocks
from polycnc.runner._remarks import HOMING
from polycnc.stock import Contact, ContactKind, Rows, runs

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

NOWHERE = -1
"""The number of no tool."""
_REACH_MM = 10.0
"""How far beside its tip a tool of unknown shape may have cut."""
_IN_STOCK = (ContactKind.RAPID, ContactKind.HOLDER, ContactKind.SHANK, ContactKind.FLUTES)
_HOMING = re.compile(HOMING.pattern.encode())


def without_homing(course: Rows, height: Floats, blocks: Blocks, texts: Mapping[str, ProgramText]) -> Rows:
    """Return a course with no tool where G28, G30 or G53 lower it, until it comes down by other blocks.

    That is for a part at the machine's zero: where its home really is, far from the part, is not known. `height` is
    that of the tool's tip [rows], from the axis on a lathe.
    """
    homing = course.rapid & np.isin(course.block, _homing(blocks, texts))
    same = course.tool[1:] == course.tool[:-1]
    down = np.flatnonzero(same & (height[1:] < height[:-1]) & ~homing[1:]) + 1
    still = np.zeros(len(height), np.bool_)
    still[1:] = np.all(course.tip[1:] == course.tip[:-1], axis=1)
    tool = course.tool.copy()
    for first, last in runs(homing.astype(np.int64)):
        if homing[first] and height[last - 1] < height[max(first - 1, 0)]:
            end = down[np.searchsorted(down, last)] if len(down) and last <= down[-1] else len(tool)
            way = slice(first, end)
            tool[way] = np.where(course.rapid[way] | still[way], NOWHERE, tool[way])
    return replace(course, tool=tool)


def _homing(blocks: Blocks, texts: Mapping[str, ProgramText]) -> npt.NDArray[np.int64]:
    """Return the numbers of the blocks that name a position of the machine."""
    found = np.zeros(len(blocks), np.bool_)
    for number, name in enumerate(blocks.names):
        if (text := texts.get(name)) is not None:
            lines = np.fromiter(_homing_lines(text), np.int64)
            found |= (blocks.program == number) & np.isin(blocks.line, lines)
    return np.flatnonzero(found)


def _homing_lines(text: ProgramText) -> Iterator[int]:
    line, counted = text.first_line, 0
    for each in _HOMING.finditer(text.content):
        line += text.content.count(b"\n", counted, each.start())
        counted = each.start()
        yield line


def without_doubtful(contacts: Sequence[Contact], course: Rows, unknown: Collection[int]) -> list[Contact]:
    """Return contacts without those in stock at places where tools of unknown shape have been fed before."""
    fed = np.isin(course.tool, list(unknown)) & ~course.rapid
    tips, t_s = course.tip[fed], course.t_s[fed]
    low, high = np.minimum.accumulate(tips) - _REACH_MM, np.maximum.accumulate(tips) + _REACH_MM
    return [each for each in contacts if each.kind not in _IN_STOCK or not _is_between(each, low, high, t_s)]


def _is_between(contact: Contact, low: Floats, high: Floats, t_s: Floats) -> bool:
    last = int(np.searchsorted(t_s, contact.t_s)) - 1
    return last >= 0 and bool(np.all((low[last] <= contact.place) & (contact.place <= high[last])))
