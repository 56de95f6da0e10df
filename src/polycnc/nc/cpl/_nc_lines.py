"""NC blocks of a CPL program: which of them hold CPL, and what (Manual 003, 2.1.1 and 3.1)."""

from __future__ import annotations

import re

from polycnc.language import Flaw
from polycnc.nc.cpl._reader import Reader
from polycnc.nc.cpl._syntax import Expression, NcBlock, NcLine, NcWord, SubCall, Wait
from polycnc.units import whole

_HEAD = re.compile(r"[ \t]*(?:/[ \t]*([1-9]?)[ \t]*)?(?:[Nn][ \t]*([0-9]+)[ \t]*)?")
_WAIT = re.compile(r"WAIT[ \t]*(\()?", re.IGNORECASE)
_REMARK = re.compile(r"\([^)]*\)?")
_MESSAGE = re.compile(r"\([ \t]*MSG[ \t]*,(.*)\)[ \t]*\Z", re.IGNORECASE)
_CALL_NAME = re.compile(r"[Pp][ \t]*([A-Za-z_][^\s\[\](),:;]*)[ \t]*")
_CALL_NUMBER = re.compile(r"([GgMmPp])[ \t]*([0-9]+)(?=\[)")
_CALL_ALONE = re.compile(r"([GgMmPp])[ \t]*([0-9]+)[ \t]*(?:\([^)\n]*\)[ \t]*)*\r?\Z")
_ADDRESS = re.compile(r"([A-Za-z])(?:([0-9]{1,2})[ \t]*=|[ \t]*=)?[ \t]*(?=\[)")
_WORD = re.compile(
    r"([A-Za-z])(?:([0-9]{1,2})[ \t]*=|[ \t]*=)?[ \t]*([+-]?)[ \t]*([0-9]++\.?[0-9]*+|\.[0-9]++)(?![0-9]*+\])"
)
_BRACKET = re.compile(r'\[(?:[^\]"]|"[^"]*")*\]')
_CALLING = frozenset("GMP")
_DIN = re.compile(r"[ \t]*(?:[Nn][ \t]*[0-9]+)?[ \t]*\([ \t]*DIN[ \t]*\)", re.IGNORECASE)
_TYP2 = re.compile(r"\s*(?:[Nn][ \t]*[0-9]+)?[ \t]*\([ \t]*TYP2[ \t]*\)", re.IGNORECASE)


def is_marked_din(line: str) -> bool:
    """Tell whether a program's first line takes it out of linking."""
    return _DIN.match(line) is not None


def is_marked_typ2(text: str) -> bool:
    """Tell whether a program says by its first instruction that its dialogs are those of older controls."""
    return _TYP2.match(text) is not None


def sequence_number(text: str) -> str:
    """Return the number of an NC block as a jump names it: "N20", or "" without one."""
    found = _HEAD.match(text)
    return f"N{found[2].lstrip('0') or '0'}" if found and found[2] else ""


def read_nc_line(
    text: str, begin: int, end: int, line: int, alone: frozenset[str] = frozenset()
) -> NcLine | NcBlock | SubCall | Wait:
    """Return the NC block at `text[begin:end]`; the codes of `alone` call programs without brackets.

    Raises:
        Flaw: The CPL in it is wrong.
    """
    head = _HEAD.match(text, begin, end)
    at = head.end() if head else begin
    letter = text[at : min(at + 1, end)].upper()
    if letter == "W" and (wait := _WAIT.match(text, at, end)):
        if wait[1] is not None or text[wait.end() : end].strip(" \t\r"):
            raise Flaw(
                at, "WAIT in an NC block stands alone", "parameters of WAIT need a CPL block: 20 WAIT(,1000)"
            )
        return Wait(at, line)
    calls = letter in _CALLING
    if calls:
        named, numbered = _CALL_NAME.match(text, at, end), _CALL_NUMBER.match(text, at, end)
        if named or numbered:
            return _sub_call(text, at, end, line, named, numbered)
    if not has_bracket(text[at:end]):
        if calls and (code := _CALL_ALONE.match(text[at:end])) and _is_call(code, alone):
            return SubCall(at, line, code[1].upper(), code[2].lstrip("0") or "0")
        return NcLine(begin, line, line)
    words, message = _Words(text, at, end).read()
    level = int(head[1] or 1) if head and "/" in head[0] else 0
    number = int(head[2][-9:]) if head and head[2] else None
    return NcBlock(at, line, number, level, tuple(words), message)


def _is_call(code: re.Match[str], alone: frozenset[str]) -> bool:
    letter = code[1].upper()
    return letter == "P" or f"{letter}{code[2].lstrip('0') or '0'}" in alone


def has_bracket(text: str) -> bool:
    """Tell whether CPL stands in a block, outside of its remarks."""
    return "[" in text and ("(" not in text or "[" in _REMARK.sub("", text))


def _sub_call(
    text: str, at: int, end: int, line: int, named: re.Match[str] | None, numbered: re.Match[str] | None
) -> SubCall:
    found = numbered or named
    assert found is not None
    address, name = (found[1].upper(), found[2]) if numbered else ("P", found[1])
    behind = found.end()
    arguments: tuple[Expression | None, ...] = ()
    if text[behind:end].startswith("["):
        reader = _inside(text, behind, end)
        arguments, open_end = reader.arguments("]")
        if open_end or None in arguments:
            raise Flaw(behind, "an argument of a sub-program is missing")
        behind = reader.tokens.behind
    rest = _REMARK.sub("", text[behind:end]).strip(" \t\r")
    if rest:
        raise Flaw(
            behind, "a sub-program call stands alone in its block", "put the other words into the next block"
        )
    return SubCall(at, line, address, name, tuple(each for each in arguments if each is not None))


def _inside(text: str, at: int, end: int) -> Reader:
    """Return a reader of what stands in brackets; it does not look at what follows them."""
    found = _BRACKET.match(text, at, end)
    return Reader(text, at + 1, found.end() if found else end)


class _Words:
    """Read the words of a block with brackets."""

    def __init__(self, text: str, at: int, end: int) -> None:
        self._text = text
        self._at = at
        self._end = end

    def read(self) -> tuple[list[NcWord], str]:
        """Return the words, and the text of a message."""
        words: list[NcWord] = []
        while True:
            while self._at < self._end and self._text[self._at] in " \t":
                self._at += 1
            if self._at >= self._end or self._text[self._at] == "\r":
                return words, ""
            if self._text[self._at] == "(":
                if message := _MESSAGE.match(self._text, self._at, self._end):
                    return words, message[1]
                remark = _REMARK.match(self._text, self._at, self._end)
                self._at = remark.end() if remark else self._end
                continue
            words.append(self._word())

    def _word(self) -> NcWord:
        text, at = self._text, self._at
        if text[at] == "[":
            return NcWord(at, "", self._bracket(at))
        if found := _ADDRESS.match(text, at, self._end):
            address = found[1].upper()
            if address in "NP":
                hint = "block numbers and sub-programs are checked before the program starts"
                raise Flaw(at, f"the address {address} takes no expression", hint)
            return NcWord(at, address, self._bracket(found.end()), whole(found[2]) if found[2] else None)
        found = _WORD.match(text, at, self._end)
        if found is None:
            raise Flaw(at, f"'{text[at]}' begins no word", "a word is a letter with a number or [expression]")
        self._at = found.end()
        value = float(f"{found[3]}{found[4]}")
        if value - value:
            raise Flaw(at, "the number is too large")
        return NcWord(at, found[1].upper(), value, whole(found[2]) if found[2] else None)

    def _bracket(self, at: int) -> Expression:
        reader = _inside(self._text, at, self._end)
        tree = reader.expression()
        reader.tokens.expect("]", "close the bracket")
        self._at = reader.tokens.behind
        return tree
