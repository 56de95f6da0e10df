"""Modal data of the executed block and of the two that come next: G codes by group, and other addresses.

Ruling: what was commanded last is read from the program texts on the way to a block: its callers up to their calls,
then its program from the head. The next blocks are the next ones of the text.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from polycnc.controllers.fanuc.data._increment import scale
from polycnc.controllers.fanuc.data._parameters import Parameters
from polycnc.controllers.fanuc.device._device_state import MdiState
from polycnc.controllers.fanuc.device._execution import Execution
from polycnc.controllers.fanuc.device._programs import Programs, number_of
from polycnc.controllers.fanuc.device._units import Units
from polycnc.nc import BlockRecord, Group

GROUPS = 21
ADDRESSES = (
    "B", "D", "E", "F", "H", "L", "M", "S", "T", "R", "P", "Q", "A", "C", "I", "J", "K", "N", "O", "U", "V", "W",
    "X", "Y", "Z", "M2", "M3",
)  # fmt: skip
"""Addresses in the order of their numbers from 100 (Manual 000, cnc_modal)."""

CODES = {
    0: {"0": 0, "1": 1, "2": 2, "3": 3},
    1: {"17": 0, "19": 4, "18": 8},
    2: {"90": 0, "91": 1},
    4: {"94": 0, "95": 1},
    5: {"20": 0, "21": 1},
    7: {"49": 0, "43": 1, "44": 2},
    11: {"67": 0, "66": 1},
    20: {"13.1": 0, "12.1": 1},
}
"""G codes and what stands for them, by group; the other groups have none in the manual."""

_GROUP_NAMES = {
    0: Group.MOTION,
    1: Group.PLANE,
    2: Group.DISTANCE,
    4: Group.FEED_MODE,
    5: Group.UNITS,
    7: Group.LENGTH_COMPENSATION,
}
_WORD = re.compile(r"([A-Z])\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))")
_STATEMENT = re.compile(r"=|\b(?:GOTO|IF|WHILE|DO|END|DPRNT|BPRNT|POPEN|PCLOS|SETVN)|GOTO")
_STATEMENT_BEGINS = re.compile(r"\s*(?:/[1-9]?\s*)?(?:N\s*[0-9]+)?")
_COMMENT = re.compile(r"\([^)]*\)")
_LENGTHS = frozenset("IJKRQ")
_BLOCKS = 3


@dataclass(frozen=True, slots=True)
class Word:
    """The last word of an address: the number as it is written, whether this block holds it, and in which unit."""

    text: str = ""
    here: bool = False
    inch: bool = False


@dataclass(frozen=True, slots=True)
class ModalBlock:
    """What holds with a block: codes of groups with whether they are commanded in it, and words by address."""

    g: dict[int, tuple[int, bool]]
    words: dict[str, Word]


class ModalData:
    """Read modal data of a Power Mate."""

    def __init__(
        self, execution: Execution, programs: Programs, mdi: MdiState, parameters: Parameters, units: Units
    ) -> None:
        self._execution = execution
        self._programs = programs
        self._mdi = mdi
        self._parameters = parameters
        self._units = units

    def block(self, ahead: int) -> ModalBlock:
        """Return what holds with the executed block (0), the next one (1) or the one after it (2)."""
        executed = self._execution.block
        if executed is None:
            return ModalBlock(self._at_start(), {})
        lines = self._lines(executed.program)
        place = executed.line - 1
        there = [place, *(k for k in range(place + 1, len(lines)) if _words(lines[k]))]
        here = there[ahead] if ahead < len(there) else -1
        passed = [line for call in executed.stack for line in self._lines(call.program)[: call.line]]
        passed += lines[: there[min(ahead, len(there) - 1)] + 1]
        commanded = _words(lines[here]) if 0 <= here < len(lines) else []
        later = [word for k in there[1 : ahead + 1] for word in _words(lines[k])]
        every = [word for line in passed for word in _words(line)]
        return ModalBlock(
            self._codes(executed, later, every, commanded), self._words(executed, passed, commanded)
        )

    def _lines(self, program: str) -> list[str]:
        number = number_of(program)
        if number == 0:
            return list(self._mdi.blocks)
        return self._programs.read(number).decode("latin-1").split("\n")

    def _at_start(self) -> dict[int, tuple[int, bool]]:
        codes = dict.fromkeys(range(GROUPS), (0, False))
        codes[5] = (0 if self._units.inch_input else 1, False)
        return codes

    def _codes(
        self,
        executed: BlockRecord,
        later: list[tuple[str, str]],
        every: list[tuple[str, str]],
        commanded: list[tuple[str, str]],
    ) -> dict[int, tuple[int, bool]]:
        made = self._at_start()
        for group, codes in CODES.items():
            name = _GROUP_NAMES.get(group)
            known = None if name is None else executed.modal.g.get(name)
            value = codes.get(known.removeprefix("G"), 0) if known else _last(codes, every)
            if any(_code(word) in codes for word in later):
                value = _last(codes, later)
            made[group] = value, any(_code(word) in codes for word in commanded)
        return made

    def _words(
        self, executed: BlockRecord, passed: list[str], commanded: list[tuple[str, str]]
    ) -> dict[str, Word]:
        modal = executed.modal
        found = {
            "F": Word(f"{modal.feed:g}"),
            "S": Word(f"{modal.speed:g}"),
            "T": Word(str(modal.next_tool or modal.tool)),
            "H": Word(str(modal.h)),
            "D": Word(str(modal.d or 0)),
        }
        codes = [word for line in passed for word in _words(line)]
        inch = next((units == "20" for units in map(_code, codes) if units in CODES[5]), modal.inch)
        for line in passed:
            words = _words(line)
            inch = next((units == "20" for units in map(_code, reversed(words)) if units in CODES[5]), inch)
            auxiliary = [number for letter, number in words if letter == "M"]
            if auxiliary:
                for k in range(_BLOCKS):
                    found[("M", "M2", "M3")[k]] = Word(auxiliary[k] if k < len(auxiliary) else "0")
            found |= {letter: Word(number, inch=inch) for letter, number in words if letter not in "GM"}
        here = {letter for letter, _ in commanded}
        several = sum(letter == "M" for letter, _ in commanded)
        for name, word in found.items():
            on = several >= int(name[1:]) if len(name) > 1 else name in here
            found[name] = replace(word, here=on)
        return found

    # ------------------------------------------------------------------ values

    def value(self, name: str, word: Word) -> int:
        """Return the number of a word as a program reads it: lengths and angles in increments of the unit it is in."""
        text = word.text
        if not text:
            return 0
        digits = text.replace(".", "")
        if name == "F":
            return int(digits)
        names = self._units.axis_names
        is_length = name in names or name in _LENGTHS
        axis = names.index(name) + 1 if name in names else 1
        linear = not self._units.is_rotary(axis)
        decimals = scale(self._units.increment, linear=linear, inch=word.inch).decimals
        if "." in text or (is_length and self._parameters.bit(3401, 0)):
            increments: float = float(text) * 10.0**decimals
            return round(increments)
        return int(digits)


def _words(line: str) -> list[tuple[str, str]]:
    """Return the words of a block; statements of macros have none but the block number, expressions no number."""
    bare = _COMMENT.sub("", line).upper()
    if _STATEMENT.search(bare):
        bare = bare[: _STATEMENT_BEGINS.match(bare).end()]  # type: ignore[union-attr]
    return _WORD.findall(bare)


def _code(word: tuple[str, str]) -> str:
    return f"{float(word[1]):g}" if word[0] == "G" else ""


def _last(codes: dict[str, int], words: list[tuple[str, str]]) -> int:
    return next((codes[_code(word)] for word in reversed(words) if _code(word) in codes), 0)
