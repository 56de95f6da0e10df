"""Which lines of a program are more than plain words, and which programs it calls and returns into."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from polycnc.nc.macro._calls import MacroCalls
from polycnc.nc.macro._plain_lines import OpenLines
from polycnc.units import whole

_B = r"[ \t]*"
_ANYWHERE = r"[#\[\]=]|(?<![A-Z])(?:GOTO|DPRNT|BPRNT|POPEN|PCLOS|SETVN|(?:DO|END?)[ \t]*[0-9])"
_MACRO_CODES = rf"G{_B}0*6[567](?![0-9])|M{_B}0*9[67](?![0-9.])"
_RETURNS = ("M99", "M099", "M0099", "M 99", "M 099", "M\t99")
_SUB_CALL = rf"M{_B}0*98(?![0-9.])"
_NEWLINE = re.compile(r"\r\n|\r|\n")
_COMMENT = re.compile(r"\([^)\r\n]*\)")


@dataclass(frozen=True, slots=True)
class Special:
    """What is found in lines that are more than plain words: a pattern, and texts without which it is not there.

    `codes` are patterns of the words among it.
    """

    pattern: re.Pattern[str]
    needles: tuple[bytes, ...]
    codes: list[str]

    def lines(
        self, text: str, folded: bytes, begin: int, end: int, without: OpenLines | None = None
    ) -> Iterator[tuple[int, int]]:
        """Yield begin and end of such lines but those that `without` tells; `folded` is the text in capitals."""
        places = dict.fromkeys(self.needles, -1)
        at = begin
        while at < end:
            for needle, place in places.items():
                if place < at:
                    found = folded.find(needle, at, end)
                    places[needle] = end if found < 0 else found
            first = min(places.values())
            if first >= end:
                return
            start = max(text.rfind("\n", at, first) + 1, text.rfind("\r", at, first) + 1, at)
            if without is not None and (behind := without.end(text, start, end)) > start:
                at = behind
                continue
            newline = _NEWLINE.search(text, first, end)
            stop = newline.start() if newline else end
            bare = without_comments(text[start:stop])
            if self.pattern.search(bare) or _returns_to(bare):
                yield start, stop
            at = newline.end() if newline else end


def special(calls: MacroCalls, *, restarts: bool = False, returns: bool = False) -> Special:
    """Return what makes a line special; with `returns` callers are to be returned into."""
    codes = [_MACRO_CODES]
    needles = ["#", "[", "=", "O", "D", "EN", "G6", "G06", "G006", "G 6", "G\t6", *_RETURNS]
    needles += ["M96", "M096", "M 96", "M97", "M097", "M 97"]
    for code in calls.g:
        codes.append(rf"G{_B}0*{re.escape(f'{code:g}')}(?![0-9.])")
        needles += _written("G", code)
    for code in (*calls.m, *calls.m_sub):
        codes.append(rf"M{_B}0*{code}(?![0-9.])")
        needles += _written("M", code)
    if calls.t is not None:
        codes.append(rf"T{_B}[0-9]")
        needles.append("T")
    if restarts:
        codes.append(rf"M{_B}0*99(?![0-9.])")
    if returns:
        codes.append(_SUB_CALL)
        needles += _written("M", 98)
    pattern = re.compile("|".join((_ANYWHERE, *codes)), re.IGNORECASE)
    return Special(pattern, tuple(dict.fromkeys(needle.encode() for needle in needles)), codes)


def _written(letter: str, code: float) -> list[str]:
    return [f"{letter}{code:g}", f"{letter}0{code:g}", f"{letter} {code:g}"]


_M99 = re.compile(rf"M{_B}0*99(?![0-9.])", re.IGNORECASE)
_CALLS = re.compile(
    rb"(?:M[ \t]*0*98|G[ \t]*0*6[56](?:\.1)?)(?![0-9.])[^\r\n]{0,200}?P[ \t]*(?:0*([0-9]+)|[#\[])",
    re.IGNORECASE,
)
_CALL_NEEDLES = tuple(
    each.encode() for code in ("M98", "G65", "G66") for each in _written(code[0], int(code[1:]))
)
_PROGRAM_DIGITS = 10_000


def without_comments(line: str) -> str:
    """Return a line with blanks in place of its comments; its cost grows with its length alone."""
    last = line.rfind(")") + 1
    return _COMMENT.sub(lambda match: " " * len(match[0]), line[:last]) + line[last:]


def _returns_to(bare: str) -> bool:
    """Tell whether a line without comments returns to a block of the calling program."""
    return ("P" in bare or "p" in bare) and _M99.search(bare) is not None


def returns_to_a_block(content: bytes) -> bool:
    """Tell whether a text has a line that returns to a block of the calling program."""
    text = content.decode("latin-1")
    at = 0
    while found := _M99.search(text, at):  # a line once, whatever it repeats
        begin = text.rfind("\n", at, found.start()) + 1 or at
        begin = text.rfind("\r", begin, found.start()) + 1 or begin
        newline = _NEWLINE.search(text, found.end())
        at = newline.end() if newline else len(text)
        if _returns_to(without_comments(text[begin:at])):
            return True
    return False


def called_programs(content: bytes, calls: MacroCalls) -> set[int] | None:
    """Return the numbers of the programs that a text calls, None where it calculates one."""
    found = {*calls.g.values(), *calls.m.values(), *calls.m_sub.values()}
    found |= set() if calls.t is None else {calls.t}
    if any(needle in content or needle.lower() in content for needle in _CALL_NEEDLES):
        for match in _CALLS.finditer(content):
            if match[1] is None:
                return None
            number = whole(match[1])
            found |= {number, number % _PROGRAM_DIGITS}  # the digits before are how often
    return found
