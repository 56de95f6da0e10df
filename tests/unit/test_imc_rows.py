"""Every parameter that the manual prints, asked at the printed address and width of each axis of a card.

Addresses and widths are those of the inventory, not of the code's own table; what each word does with a number is
written out below.
"""

from __future__ import annotations

import csv
import re

import pytest

from polycnc import conformance
from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.imc.card._config import CardConfig
from polycnc.controllers.imc.core._instructions import Write
from support.imc_card import IFIFO

AXES = 4
BITS = {"S16": 16, "U16": 16, "F16": 16, "R16": 16, "S32": 32, "U32": 32, "S16.16": 32, "U16.16": 32}
BITS |= {"S16.32": 48, "U16.32": 48}
PATTERNS = (
    0x5A3C_7E1F_6B2D,
    -0x5A3C_7E1F_6B2D,
    0,
    -0x0180_0100_2003,
    -7,
)  # each is cut to the width of a word; the last is -1 for axis 3

# What belongs to the card: the number that was written last stays for every axis.
SHARED = {
    "startgroup", "groupnum", "groupsmooth", *(f"group_{letter}" for letter in "xyzabcdefghijklm"),
    *(f"user16b{k}" for k in range(10)), *(f"user32b{k}" for k in range(10)), *(f"user48b{k}" for k in range(5)),
    "waitfilt", "waitequ", "emstop", "hpause", "eventid", "gio", "giod", "eventbase", "out1", "out2",
}  # fmt: skip
# Commands that an axis out of run does not take, counts of what is empty, and what an axis at rest shows: 0.
NOTHING = {
    "mcsvel", "mcsslope", "mcsgo", "mcsmoving", "pcsvel", "pcsslope", "pcsgo", "pcsmoving", "encpvel", "encsvel",
    "status", "gohome", "sethome", "capture", "clear", "engear", "startsyn", "profiling", "smoothing", "contouring",
    "moving", "motion", "outsettle", "outtrack", "poserr", "curpos", "curvel", "cappos", "clrencs", "aiolat",
    "clraiolat", "events", "clrififo", "cfifocnt", "clrqfifo",
}  # fmt: skip
# What has counted once in the cycle, by how much; the delay counts microseconds.
COUNTING = {"timer": -1, "ticks": 1, "delayus": -1000, "delayout": -1000}
FIXED = {"naxis": AXES, "fwversion": 320, "hwversion": 100, "sysclk": 100_000_000, "clkdiv": 1}


def printed() -> list[tuple[str, str, int, int]]:
    """Return row, name, address and words of each parameter whose address the manual prints."""
    with (conformance.data_folder() / "imc.tsv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))
    found = [(row, re.search(r"(\d+) //(\S+)", row["signature"])) for row in rows]
    return [
        (row["id"], row["name"].split()[0], int(at[1]), (BITS.get(at[2]) or int(at[2])) // 16)
        for row, at in found
        if at and row["id"].startswith("imc.param.")
    ]


def signed(value: int, words: int) -> int:
    """Return the low words of a number as a signed one."""
    half = 1 << 16 * words - 1
    return (value + half) % (2 * half) - half


def expected(name: str, words: int, written: list[int]) -> list[int]:
    """Return what a parameter shows for each axis a cycle after something was written to it for each."""
    if name in FIXED or name in NOTHING:
        return [FIXED.get(name, 0)] * AXES
    if name in COUNTING:  # without a sign, and a delay ends at 0
        left = written[-1] % (1 << 16 * words) + COUNTING[name]
        return [signed(max(left, 0), words)] * AXES
    if name in SHARED:
        return [written[-1]] * AXES
    if name == "aio":  # terminals 0 to 2 have no switch, which is active low
        return [value | 7 for value in written]
    return written


@pytest.mark.covers(*(row for row, *_ in printed()))
def test_a_word_keeps_what_is_written_for_its_axis_or_for_the_card() -> None:
    assert len(printed()) == 162
    for _, name, at, words in printed():
        card = Card(CardConfig(number_of_axes=AXES))
        for pattern in PATTERNS:
            written = [signed(pattern, words) ^ axis << 1 for axis in range(AXES)]
            for axis, value in enumerate(written):
                assert card.push(IFIFO, Write(at, value, axis, words))
            card.advance(1)
            shown = [card.read_raw(at, axis, words) for axis in range(AXES)]
            assert shown == expected(name, words, written), name
