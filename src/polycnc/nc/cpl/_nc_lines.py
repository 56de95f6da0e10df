"""NC blocks of a CPL program: which of them hold CPL, and what (Manual 003, 2.1.1 and 3.1)."""

from __future__ import annotations

import re
from operator import attrgetter

from polycnc.errors import ProgramError
from polycnc.language import Flaw
from polycnc.nc.cpl._reader import Reader
from polycnc.nc.cpl._syntax import Expression, NcBlock, NcLine, NcWord, SubCall, Wait
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import STATEMENT
from polycnc.nc.text._scan_plain import scan_block, scan_words
from polycnc.units import whole

_HEAD = re.compile(r"[ \t]*(?:/[ \t]*([1-9]?)[ \t]*)?(?:[Nn][ \t]*([0-9]+)[ \t]*)?")
_WAIT = re.compile(r"WAIT[ \t]*(\()?", re.IGNORECASE)
_REMARK = re.compile(r"\([^)]*\)?")
_CALL_NAME = re.compile(r"[Pp][ \t]*([A-Za-z_][^\s\[\](),:;]*)[ \t]*")
_CALL_NUMBER = re.compile(r"([GgMm])[ \t]*([0-9]+)(?=\[)|([Pp])[ \t]*([0-9]+)[ \t]*(?=\[)")
_CALL_ALONE = re.compile(r"([GgMmPp])[ \t]*([0-9]+)[ \t]*(?:\([^)\n]*\)[ \t]*)*\r?\Z")
_BRACKET = re.compile(r'\[(?:[^\]"]|"[^"]*")*\]?')
_ADDRESS = r"(?<![A-Za-z])([A-Za-z])(?:([0-9]{1,2})[ \t]*=|[ \t]*=)?[ \t]*"
_HOLES = re.compile(rf"{_REMARK.pattern}|(?:{_ADDRESS}|([+-])[ \t]*)?({_BRACKET.pattern})")
_HOLES_WITH_SEMICOLONS = re.compile(rf";.*|{_HOLES.pattern}", re.DOTALL)
_AFTER = re.compile(r"[ \t]*[0-9.]")
_NO_WORDS = re.compile(r"[^A-Za-z0-9 \t\r.+():/-]|[A-Za-z][A-Za-z]")
_CALLING = frozenset("GMP")
PLAIN_RULES = TextRules()
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
    text: str,
    begin: int,
    end: int,
    line: int,
    alone: frozenset[str] = frozenset(),
    rules: TextRules = PLAIN_RULES,
) -> list[NcLine | NcBlock | SubCall | Wait]:
    """Return the NC block at `text[begin:end]`; the codes of `alone` call programs without brackets.

    A message beside a call is a block before it.

    Raises:
        Flaw: The CPL in it is wrong.
    """
    head = _HEAD.match(text, begin, end)
    at = head.end() if head else begin
    level = int(head[1] or 1) if head and "/" in head[0] else 0
    letter = text[at : min(at + 1, end)].upper()
    if letter == "W" and (wait := _WAIT.match(text, at, end)):
        if wait[1] is not None or text[wait.end() : end].strip(" \t\r"):
            raise Flaw(
                at, "WAIT needs an NC block of its own", "parameters of WAIT need a CPL block: 20 WAIT(,1000)"
            )
        return [Wait(at, line, skip=level)]
    call: SubCall | None = None
    remarks = end
    if letter in _CALLING:
        named, numbered = _CALL_NAME.match(text, at, end), _CALL_NUMBER.match(text, at, end)
        if named or numbered:
            call, remarks = _sub_call(text, at, end, line, named, numbered)
        elif (code := _CALL_ALONE.match(text[at:end])) and _is_call(code, alone):
            call, remarks = SubCall(at, line, code[1].upper(), code[2].lstrip("0") or "0"), at + code.end(2)
    if call is not None:
        call.skip = level
        told = _read_words(text, remarks, end, line, rules) if text[remarks:end].strip() else None
        return [NcBlock(at, line, None, level, (), told.message), call] if told and told.message else [call]
    if not has_bracket(text[at:end]):
        _refuse_statement(text, at, end, rules)
        return [NcLine(begin, line, line)]
    return [_read_words(text, begin, end, line, rules)]


def _refuse_statement(text: str, at: int, end: int, rules: TextRules) -> None:
    """Refuse a block of CPL that has lost its number; what else is wrong with words is said when they are read.

    Raises:
        Flaw: It is one.
    """
    code = _REMARK.sub("", text[at:end])
    if not _NO_WORDS.search(code):
        return
    try:
        block = scan_block(ProgramText("", code.encode("utf-8")), 0, 1, rules)
    except ProgramError:
        return
    if block.flags & STATEMENT:
        raise Flaw(
            at,
            f"'{block.statement[:20]}' is no NC block, and has no number",
            "a CPL block begins with one: 20 A%=1",
        )


def _is_call(code: re.Match[str], alone: frozenset[str]) -> bool:
    letter = code[1].upper()
    return letter == "P" or f"{letter}{code[2].lstrip('0') or '0'}" in alone


def has_bracket(text: str) -> bool:
    """Tell whether CPL stands in a block, outside of its remarks."""
    return "[" in text and ("(" not in text or "[" in _REMARK.sub("", text))


def _sub_call(
    text: str, at: int, end: int, line: int, named: re.Match[str] | None, numbered: re.Match[str] | None
) -> tuple[SubCall, int]:
    """Return a call, and where its remarks begin."""
    found = numbered or named
    assert found is not None
    address, name = ("P", found[1])
    if numbered:
        address, name = (found[1] or found[3]).upper(), (found[2] or found[4]).lstrip("0") or "0"
    after = found.end()
    arguments: tuple[Expression | None, ...] = ()
    if text[after:end].startswith("["):
        reader = _inside(text, after, end)
        arguments, open_end = reader.arguments("]")
        if open_end or None in arguments:
            raise Flaw(after, "an argument of a sub-program is missing")
        after = reader.tokens.after
    rest = _REMARK.sub("", text[after:end]).strip(" \t\r")
    if rest:
        raise Flaw(
            after, "a sub-program call needs a block of its own", "put the other words into the next block"
        )
    given = tuple(each for each in arguments if each is not None)
    return SubCall(at, line, address, name, given), after


def _inside(text: str, at: int, end: int) -> Reader:
    """Return a reader of what stands in brackets; it does not look at what follows them."""
    found = _BRACKET.match(text, at, end)
    closed = found is not None and found[0].endswith("]")
    return Reader(text, at + 1, found.end() if found and closed else end)


def _read_words(text: str, begin: int, end: int, line: int, rules: TextRules) -> NcBlock:
    """Read a block as the control does, with a number in the place of each pair of brackets.

    So words, remarks, messages and marks are those of blocks without brackets.
    """
    holes: dict[int, NcWord] = {}  # by the place of the letter, for AXP() and texts that of the bracket
    pieces: list[str] = []
    after = begin
    for found in (_HOLES_WITH_SEMICOLONS if rules.semicolon_comments else _HOLES).finditer(text, begin, end):
        if found[4] is None:
            continue
        word = _hole(text, end, found)
        holes[word.at] = word
        opening = found.start(4)
        pieces += text[after:opening], ("0" if word.address else " ") * (found.end() - opening)
        after = found.end()
    shown = "".join((*pieces, text[after:end]))
    content = shown.encode("utf-8")
    try:
        block = scan_words(ProgramText("", content), 0, 1, rules)
    except ProgramError as error:
        column = error.position.column if error.position is not None else 1
        raise Flaw(begin + column - 1, error.what, error.hint) from None
    words = [hole for hole in holes.values() if not hole.address]
    number = None
    for each in block.words:
        if each.letter == "N" and each is block.words[0]:
            number = int(each.value)
            continue
        at = each.place if shown.isascii() else len(content[: each.place].decode("utf-8"))
        words.append(holes.get(begin + at) or NcWord(begin + at, each.letter, each.value, each.index))
    words.sort(key=_place)
    head = _HEAD.match(text, begin, end)
    first = head.end() if head else begin
    return NcBlock(first, line, number, block.skip_level, tuple(words), block.message)


_place = attrgetter("at")


def _hole(text: str, end: int, found: re.Match[str]) -> NcWord:
    """Return the word whose value stands in brackets."""
    at = found.start()
    if found[3]:
        raise Flaw(at, "a sign belongs inside the brackets", "write X[-A], not X-[A]")
    letter = (found[1] or "").upper()
    if letter and letter in "NP":
        hint = "block numbers and sub-programs are checked before the program starts"
        raise Flaw(at, f"the address {letter} takes no expression", hint)
    opening = found.start(4)
    reader = Reader(text, opening + 1, found.end() if found[4].endswith("]") else end)
    tree = reader.expression()
    reader.tokens.expect("]", "close the bracket")
    if after := _AFTER.match(text, reader.tokens.after, end):
        raise Flaw(
            after.end() - 1,
            f"'{after[0][-1]}' begins no word",
            "a word is a letter with a number or [expression]",
        )
    return NcWord(at, letter, tree, whole(found[2]) if found[2] else None)
