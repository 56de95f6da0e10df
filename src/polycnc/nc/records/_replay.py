"""What the words of a run of plain blocks say, read again from its text when somebody asks."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.nc.dialect._dialect import DialectTables
from polycnc.nc.modal._actions import (
    COOLANT_OFF,
    COOLANT_ON,
    NO_SENSE,
    OUTPUT_VALUE,
    SPINDLE_SENSES,
    Action,
    coolant_with,
)
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import OPEN_VALUE, WordColumns, open_text

PLAIN_MOTIONS = (Action.RAPID, Action.LINEAR, Action.ARC_CW, Action.ARC_CCW)
_DISTANCES = (Action.ABSOLUTE, Action.INCREMENTAL)
_F, _G, _M = ord("F"), ord("G"), ord("M")

Floats = npt.NDArray[np.float64]
Feeds: TypeAlias = tuple[tuple[str, float], ...]
"""What F words mean that have a variable for their number: how that is written, and its value."""


class RunBegin(NamedTuple):
    """Where a run of plain blocks begins, and the `feeds` in it; None where every word has a number."""

    offset: int
    line: int
    feeds: Feeds | None = None


Said: TypeAlias = tuple[list[int], list[float]]


class Replay(NamedTuple):
    """What the plain blocks of a run say: block numbers and values of each; `direction` and `m` by M words.

    `coolant` are the M codes that switch coolant.
    """

    lines: list[int]
    motion: Said
    absolute: Said
    feed: Said
    speed: Said
    direction: Said
    m: Said
    coolant: Said
    next_tool: Said
    d: Said


def replay_of(
    columns: WordColumns, tables: DialectTables, text: ProgramText, feeds: Feeds | None, *, laser: bool
) -> Replay:
    """Return what the words in `columns`, a piece of `text`, say; `feeds` are the numbers of F words without one.

    The value of output 0 in step with motion is S where that is the power of a `laser`.
    """
    words, blocks = columns.n_words, columns.n_blocks
    letter, value = columns.letter[:words], columns.value[:words]
    block = np.searchsorted(columns.first_word[: blocks + 1], np.arange(words), side="right") - 1
    is_g = letter == _G
    codes = np.rint(value[is_g] * 10.0)
    inside = (codes >= 0.0) & (codes < len(tables.g_action))
    actions = tables.g_action[np.where(inside, codes, 0.0).astype(np.int64)]
    actions = np.where(inside, actions, 0)
    is_f = letter == _F
    if feeds:
        is_f = _with_feeds(text, columns, is_f, dict(feeds))

    def of(here: npt.NDArray[np.bool_]) -> Said:
        return block[here].tolist(), value[here].tolist()

    is_m = letter == _M
    senses = np.full(words, NO_SENSE)
    senses[is_m] = senses_of(value[is_m], tables.m_sense)
    is_speed = letter == ord("S")
    if laser:
        powers = np.intersect1d(block[senses == OUTPUT_VALUE], block[(letter == ord("E")) & (value == 0.0)])
        is_speed |= (letter == ord("Q")) & np.isin(block, powers)
    turns = np.isin(senses, list(SPINDLE_SENSES.values()))
    return Replay(
        lines=columns.line[:blocks].tolist(),
        motion=_said(block[is_g], actions, PLAIN_MOTIONS),
        absolute=_said(block[is_g], actions, _DISTANCES),
        feed=of(is_f),
        speed=of(is_speed),
        direction=(block[turns].tolist(), senses[turns].astype(float).tolist()),
        m=of(is_m),
        coolant=of(np.isin(senses, (COOLANT_ON, COOLANT_OFF))),
        next_tool=of(letter == ord("T")),
        d=of(letter == ord("D")),
    )


def senses_of(codes: Floats, m_sense: npt.NDArray[np.int8]) -> npt.NDArray[np.int8]:
    """Return what M codes switch, see `M_SENSES`."""
    inside = (codes >= 0.0) & (codes < len(m_sense)) & (codes == np.floor(codes))
    found = m_sense[np.where(inside, codes, 0.0).astype(np.int64)]
    return np.where(inside, found, NO_SENSE).astype(np.int8)


def coolant_after(
    coolant: tuple[int, ...], codes: Sequence[float] | Floats, m_sense: npt.NDArray[np.int8]
) -> tuple[int, ...]:
    """Return the codes of the coolant that is on after M codes, among which others count for nothing."""
    said = np.asarray(codes, np.float64)
    senses = senses_of(said, m_sense)
    off = np.flatnonzero(senses == COOLANT_OFF)
    if len(off):
        coolant, said, senses = (), said[off[-1] + 1 :], senses[off[-1] + 1 :]
    on = said[senses == COOLANT_ON].astype(np.int64)
    latest_first = on[::-1]
    places = np.sort(np.unique(latest_first, return_index=True)[1])
    for code in latest_first[places][::-1].tolist():
        coolant = coolant_with(coolant, code, COOLANT_ON)
    return coolant


def _with_feeds(
    text: ProgramText, columns: WordColumns, is_f: npt.NDArray[np.bool_], feeds: Mapping[str, float]
) -> npt.NDArray[np.bool_]:
    """Give F words that have a variable for their number its value; return which F words count."""
    counts = is_f.copy()
    for word in np.flatnonzero(is_f & (columns.point[: len(is_f)] == OPEN_VALUE)).tolist():
        value = feeds.get(open_text(text.content, int(columns.value[word])))
        counts[word] = value is not None
        columns.value[word] = value or 0.0
    return counts


def _said(
    blocks: npt.NDArray[np.int64], actions: npt.NDArray[np.signedinteger[Any]], words: tuple[Action, ...]
) -> Said:
    values = {int(word): float(word.sets or 0) for word in words}
    found = np.isin(actions, list(values))
    return blocks[found].tolist(), [values[action] for action in actions[found].tolist()]


def latest(said: Said, block: int, before: float) -> float:
    """Return what was said last up to a block, `before` if nothing was."""
    index = bisect_right(said[0], block)
    return said[1][index - 1] if index else before
