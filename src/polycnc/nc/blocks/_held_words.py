"""Codes that a dialect does not take while radius compensation is on."""

from __future__ import annotations

from polycnc.errors import ProgramError
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.modal._actions import Group
from polycnc.nc.text._scan_plain import Word


def held_words(block: BlockContext) -> None:
    """Refuse codes that the dialect holds back with radius compensation; G40 in the same block comes first.

    Raises:
        ProgramError: there is one.
    """
    held = block.dialect.held_by_compensation
    if not held or not (block.after.side or block.before.side):
        return
    for m in block.words.m:
        if block.before.side and f"M{m.code}" in held:
            raise _refusal(block, f"M{m.code}", m.word)
    for group, g in block.words.g.items():
        if group not in held:
            continue
        twice = group is Group.RADIUS_COMPENSATION
        if (twice and g.value and block.before.side) or (not twice and block.after.side):
            raise _refusal(block, f"G{g.code}", g.word)


def _refusal(block: BlockContext, code: str, word: Word) -> ProgramError:
    return block.problem(f"{code} while radius compensation is active", "Cancel it with G40 first.", word)
