"""The blocks of a contour that a turning cycle names by their sequence numbers."""

from __future__ import annotations

import dataclasses
import re
from typing import NamedTuple

from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import Action, Family, of_family
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import STATEMENT
from polycnc.nc.text._scan_plain import Block, scan_block

MOST_CONTOUR_BLOCKS = 10_000
_CYCLES = of_family(Family.TURNING_CYCLE, Family.CONTOUR_CYCLE)
_COMPENSATION = (Action.COMP_LEFT, Action.COMP_RIGHT, Action.COMP_OFF)


class ContourProblem(NamedTuple):
    """What is wrong with a contour, and what to do."""

    what: str
    hint: str


def numbered_block(text: ProgramText, number: int, begin: int, end: int, rules: TextRules) -> Block | None:
    """Return the first block with a sequence number that begins between two offsets."""
    pattern = re.compile(rb"^[ \t]*/?[ \t]*[Nn][ \t]*0*%d(?![0-9])" % number, re.MULTILINE)
    match = pattern.search(text.content, begin, end)
    if match is None:
        return None
    offset = match.start()
    return scan_block(text, offset, text.position(offset).line, rules)


def contour_blocks(
    text: ProgramText, begin: Block | None, numbers: tuple[int, int], rules: TextRules
) -> list[Block] | ContourProblem:
    """Return the blocks from `begin`, the first of the two numbers, to the last one."""
    first, last = numbers
    if begin is None:
        return ContourProblem(f"there is no block N{first}", "P names the first block of the contour.")
    blocks = [begin]
    while not (blocks[-1].flags & STATEMENT or _is_numbered(blocks[-1], last)):
        after = text.next_line(blocks[-1].offset)
        if after >= len(text) or len(blocks) > MOST_CONTOUR_BLOCKS:
            return ContourProblem(
                f"there is no block N{last} after N{first}", "Q names the last block of the contour."
            )
        blocks.append(scan_block(text, after, blocks[-1].line + 1, rules))
    if blocks[-1].flags & STATEMENT:
        return ContourProblem(
            "a contour that is cut apart by statements is not supported yet",
            "Write the contour in plain words.",
        )
    return blocks


def _is_numbered(block: Block, number: int) -> bool:
    return any(word.letter == "N" and word.value == number for word in block.words)


def holds_cycle(block: Block, dialect: Dialect) -> bool:
    """Tell whether a block of a contour holds a cycle itself."""
    actions = {dialect.g_action(word.value) for word in block.words if word.letter == "G"}
    return not actions.isdisjoint(_CYCLES)


def without_compensation(block: Block, dialect: Dialect) -> Block:
    """Return a block of a contour without the words of radius compensation."""
    words = tuple(
        word
        for word in block.words
        if word.letter != "G" or dialect.g_action(word.value) not in _COMPENSATION
    )
    return dataclasses.replace(block, words=words)


def names_x_and_z(block: Block, dialect: Dialect) -> bool:
    """Tell whether a block names both axes of the contour, by positions or ways."""
    names = {dialect.incremental.get(word.letter, word.letter) for word in block.words}
    return {"X", "Z"} <= names
