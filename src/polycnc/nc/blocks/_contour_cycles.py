"""Turning cycles about a contour, which other blocks of the program hold, named by sequence numbers: G70 to G73.

Depths, retracts and tapers are radii, allowances along X diameters where X is one.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks import _turning_moves as turns
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._corner_blocks import refuse_open
from polycnc.nc.blocks._handlers import carries_out
from polycnc.nc.blocks._moves import Arc, GeometryError, Line, QueueItem, Spline
from polycnc.nc.blocks._outcomes import NEXT
from polycnc.nc.blocks._turning import (
    SAME_MM,
    Piece,
    Roughing,
    Step,
    Turning,
    exchanged,
    repeat,
    rough,
)
from polycnc.nc.blocks._turning_pockets import rough_pockets
from polycnc.nc.blocks._word_checks import refuse_unused
from polycnc.nc.blocks._words import GWord, whole_number
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import Action, Family, of_family
from polycnc.nc.modal._modal import length_scale
from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import STATEMENT
from polycnc.nc.text._scan_plain import Block, scan_block

_DEPTHS = {Action.TURN_ROUGH: ("rough", "U"), Action.FACE_ROUGH: ("face", "W")}  # depth of a cut, and escape


@carries_out(Action.TURN_FINISH)
def finish(block: BlockContext, g: GWord) -> list[QueueItem]:
    """Return the moves of the contour, executed as its blocks stand there, and the rapid back."""
    if _gives_parameters(block):
        raise block.problem(f"G{g.code} without a contour", "Add P and Q, its first and last block.", g.word)
    blocks = _contour(block, g)
    x, z = turns.axes(block)
    start = block.start
    refuse_unused(block)
    found = [item for each in blocks for item in _executed(block, each, block.after, g)]
    refuse_open(block, block.after, g)
    back = Step((start[x], start[z]), rapid=True)
    return [*found, *turns.items(block, [back], block.start)]


@carries_out(Action.TURN_ROUGH, Action.FACE_ROUGH, Action.TURN_REPEAT)
def rough_contour(block: BlockContext, g: GWord) -> list[QueueItem]:
    """Return the moves of a cycle that cuts up to the contour; none where the block gives parameters only."""
    if _gives_parameters(block):
        set_parameters(block, g)
        return []
    blocks = _contour(block, g)
    state = block.after.copy()
    moves = [
        item
        for each in blocks
        for item in _executed(block, without_compensation(each, block.dialect), state, g, measured=True)
        if isinstance(item, (Line, Arc))
    ]
    refuse_open(block, state, g)
    both = names_x_and_z(blocks[0], block.dialect) if blocks else False
    return contour_cycle(block, g, moves, both_axes=both)


def _gives_parameters(block: BlockContext) -> bool:
    return "P" not in block.words.by_letter and "Q" not in block.words.by_letter


def _executed(
    block: BlockContext, other: Block, state: ChannelState, g: GWord, *, measured: bool = False
) -> list[QueueItem]:
    """Execute a block of a contour within the present block; return its moves."""
    inner = block.within(other, state, measured=measured)
    block.rules.execute(inner)
    if inner.outcome is not NEXT or any(isinstance(item, Spline) for item in inner.items):
        raise inner.problem(*_moves_only(g), None)
    motion.note_position(inner)
    return inner.items


def _moves_only(g: GWord) -> tuple[str, str]:
    return f"a contour of G{g.code} with a call, a cycle, a stop or an end", "Let it hold moves only."


def _contour(block: BlockContext, g: GWord) -> list[Block]:
    """Return the blocks of the contour; where they follow here, the program goes on after them."""
    numbers = _contour_numbers(block, g)
    text, rules = block.text, block.rules.text_rules
    here = text.next_line(block.block.offset)
    begin = numbered_block(text, numbers[0], here, len(text), rules)
    blocks = contour_blocks(text, begin or numbered_block(text, numbers[0], 0, here, rules), numbers, rules)
    if isinstance(blocks, ContourProblem):
        raise block.problem(*blocks, g.word)
    if any(each.flags & STATEMENT for each in blocks):
        raise block.problem(
            f"a contour of G{g.code} with statements is not supported yet", "Write plain words.", g.word
        )
    if any(holds_cycle(each, block.dialect) for each in blocks):
        raise block.problem(*_moves_only(g), g.word)
    after = text.next_line(blocks[-1].offset)
    block.goes_on = Place(text, after, blocks[-1].line + 1) if begin else None
    return [each for each in blocks if each.words]


def _contour_numbers(block: BlockContext, g: GWord) -> tuple[int, int]:
    """Take P and Q, the first and the last block."""
    numbers = []
    for letter in "PQ":
        word = block.words.take(letter)
        if word is None:
            raise block.problem(
                f"G{g.code} without {letter}", "Give P and Q, the first and last block.", g.word
            )
        numbers.append(whole_number(word, "a block number", block.problem))
    return numbers[0], numbers[1]


def set_parameters(block: BlockContext, g: GWord) -> None:
    """Keep what the first block of G71, G72 or G73 says."""
    turning = block.after.turning
    if g.action is Action.TURN_REPEAT:
        u, w, passes = turning.relief
        u, w = _or(turns.length(block, "U"), u), _or(turns.length(block, "W"), w)
        if (word := block.words.take("R")) is not None:
            passes = whole_number(word, "a number of passes", block.problem)
        turning = replace(turning, relief=(u, w, passes))
    else:
        field, letter = _DEPTHS[g.action]
        depth, escape = getattr(turning, field)
        numbers = _or(turns.length(block, letter), depth), _or(turns.length(block, "R"), escape)
        changed: dict[str, Any] = {field: numbers}
        turning = replace(turning, **changed)
    block.after.turning = turning


def contour_cycle(
    block: BlockContext, g: GWord, moves: Sequence[Line | Arc], *, both_axes: bool
) -> list[QueueItem]:
    """Return the moves of G71, G72 or G73 about a contour; `both_axes`: its first block names X and Z.

    Raises:
        ProgramError: the contour cannot be roughed, a word makes no sense, a limit would be passed.
    """
    turns.refuse_compensation(block)
    turning = _with_depth(block, g)
    u, w = turns.length(block, "U") or 0.0, turns.length(block, "W") or 0.0
    modal, (x, _) = block.after.modal, turns.axes(block)
    is_diameter = float(modal.scale[x]) < 0.75 * length_scale(modal)
    allowance = u * (0.5 if is_diameter else 1.0), w
    pieces = _pieces(block, moves)
    if g.action in _DEPTHS and _leads_back(pieces, moves, along=int(g.action is Action.TURN_ROUGH)):
        pieces.pop()
    if not pieces:
        raise block.problem(f"G{g.code}: the contour moves nothing", "Check P and Q.", g.word)
    first_rapid = bool(getattr(moves[0], "rapid", False))
    cut = rough_pockets if both_axes else rough
    try:
        if g.action is Action.TURN_ROUGH:
            steps = cut(pieces, Roughing(*turning.rough, allowance), first_rapid=first_rapid)
        elif g.action is Action.FACE_ROUGH:
            turned = [piece.exchanged() for piece in pieces]
            numbers = Roughing(*turning.face, allowance[::-1])
            steps = exchanged(cut(turned, numbers, first_rapid=first_rapid))
        else:
            relief = turning.relief
            steps = repeat(pieces, relief[:2], relief[2], allowance, first_rapid=first_rapid)
    except GeometryError as error:
        raise block.problem(f"G{g.code}: {error.what}", error.hint, g.word) from None
    return list(turns.items(block, steps, block.start))


def _with_depth(block: BlockContext, g: GWord) -> Turning:
    """Return what is in force for a cycle in one block, whose D is the depth of a cut."""
    turning = block.after.turning
    if g.action not in _DEPTHS or "D" not in block.words.by_letter:
        return turning
    field, _ = _DEPTHS[g.action]
    changed: dict[str, Any] = {field: (turns.increments(block, "D"), getattr(turning, field)[1])}
    return replace(turning, **changed)


def _pieces(block: BlockContext, moves: Sequence[Line | Arc]) -> list[Piece]:
    pieces = []
    for move in moves:
        start, end = turns.plane_point(block, move.start), turns.plane_point(block, move.end)
        if isinstance(move, Arc):
            pieces.append(Piece(start, end, (move.center[1], move.center[0]), move.sweep_rad))
        elif start != end:
            pieces.append(Piece(start, end))
    return pieces


def _leads_back(pieces: list[Piece], moves: Sequence[Line | Arc], *, along: int) -> bool:
    """Tell whether a contour ends with a rapid back to where it began along an axis: nothing is cut there."""
    back = len(pieces) > 2 and abs(pieces[-1].end[along] - pieces[0].end[along]) <= SAME_MM
    return back and bool(getattr(moves[-1], "rapid", False))


def _or(value: float | None, other: float) -> float:
    return other if value is None else value


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
