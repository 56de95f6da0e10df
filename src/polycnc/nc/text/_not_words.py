"""What is wrong with a line that is no block of plain words: a slip of the pen, or a statement of a language."""

from __future__ import annotations

import re
from dataclasses import dataclass

from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import BLANK_BYTES

_BLANKS = f"[{re.escape(BLANK_BYTES.decode('ascii'))}]*+"
_MARKS = re.compile(r'[\[\]#=$"*<>?@_]')
# Words with which statements begin, or that make one; CPL's and those of custom macros.
_KEYWORDS = re.compile(
    r"(?<![A-Za-z])(?:IF|THEN|ELSE|ENDIF|GOTO[FBC]?|WHILE|DO|END|FOR|NEXT|REPEAT|UNTIL|CASE|OTHERWISE|ENDCASE|CALL|DIM|REM"
    r"|WAIT|DPRNT|BPRNT|POPEN|PCLOS|SETVN|DEF|PROC|RET|LABEL|OPENR|OPENW|CLOSE|PRN|INP|DSP|DLG|ENDDLG)(?![A-Za-z])",
    re.IGNORECASE,
)
_DECIMAL_COMMA = re.compile(
    rf"(?P<word>[A-Za-z]){_BLANKS}(?P<number>[+-]?{_BLANKS}[0-9]+),(?P<rest>[0-9]+)(?![0-9,])"
)
_BARE_COMMA = re.compile(rf"(?P<word>[A-Za-z]){_BLANKS}(?P<sign>[+-]?){_BLANKS},(?P<rest>[0-9]+)")
_THOUSANDS = re.compile(rf"[A-Za-z]{_BLANKS}[+-]?[0-9]+(?:,[0-9]+)+(?:[.,][0-9]*)?")
_BETWEEN_BLOCKS = re.compile(rf",{_BLANKS}(?P<word>[A-Za-z])")
_COMMA = re.compile(",")
_HASH_REMARK = re.compile(rf"{_BLANKS}#(?={_BLANKS}(?:[A-Za-z]{{2}}|[0-9]+[A-Za-z]|#|\Z))")
_CHECK_SUM = re.compile(rf"(?<=[0-9. \t])\*[0-9]+(?={_BLANKS}\Z)")
_AXES = "ABCUVWXYZ"
_HOME = re.compile(r"(?<![A-Z])G *28(?![0-9.])", re.IGNORECASE)
_NUMBERS = {"G": "1", "M": "3"}
_LETTERS = re.compile(r"[A-Za-z]{2,}")


@dataclass(frozen=True, slots=True)
class SyntaxHint:
    """Say what is wrong with a line: place of the character from its beginning, what, and what to do."""

    place: int
    what: str
    hint: str


def syntax_hint(line: str, rules: TextRules) -> SyntaxHint | None:
    """Return what is wrong with a line that would be words but for a slip; None for a statement of a language.

    `line` is one character a byte. A comma in a number and letters without a number are slips.
    """
    code = _without_comments(line, rules)
    if (check_sum := _CHECK_SUM.search(code)) and not _MARKS.search(code[: check_sum.start()]):
        return SyntaxHint(
            check_sum.start(),
            f"'{check_sum[0]}' is no word",
            "It is a check sum that senders add: remove it.",
        )
    if hash_mark := _HASH_REMARK.match(code):
        like = "after a semicolon: ; remark." if rules.semicolon_comments else "in brackets: (remark)."
        return SyntaxHint(hash_mark.end() - 1, "# begins no remark", f"Write remarks {like}")
    if _MARKS.search(code) or _KEYWORDS.search(code):
        return None
    finders = (_decimal_comma, _letters_and_commas)
    return next((found for finder in finders if (found := finder(code)) is not None), None)


def statements(text: ProgramText, rules: TextRules) -> tuple[int, int]:
    """Return the number of the first line that holds a statement of a language, and how many lines do."""
    first = count = 0
    offset, number = 0, 1
    while offset < len(text):
        end = text.line_end(offset)
        line = text.content[offset:end].decode("latin-1")
        if is_statement(line, rules):
            first, count = first or number, count + 1
        offset, number = text.next_line(offset), number + 1
    return first, count


def is_statement(line: str, rules: TextRules) -> bool:
    """Tell whether a line (one character a byte) holds a statement of a language."""
    code = _without_comments(line, rules)
    if code.lstrip().startswith("%") or _HASH_REMARK.match(code):
        return False
    return bool(_MARKS.search(code) or _KEYWORDS.search(code))


def _without_comments(line: str, rules: TextRules) -> str:
    """Return the line with blanks for its comments, every other character in its place."""
    if rules.parenthesis_comments:
        line = re.sub(r"\([^)]*\)?", lambda found: " " * len(found[0]), line)
    if rules.semicolon_comments and ";" in line:
        begin = line.index(";")
        line = line[:begin] + " " * (len(line) - begin)
    return line


def _decimal_comma(code: str) -> SyntaxHint | None:
    found = _DECIMAL_COMMA.search(code) or _BARE_COMMA.search(code)
    several = _THOUSANDS.search(code)
    if several is not None and (found is None or several.start() <= found.start()):
        text = several[0]
        if text.count(",") + text.count(".") > 1:
            return SyntaxHint(
                several.start(), f"'{text}' is no number", "Write it without commas, like X1250.5."
            )
    if found is None:
        return None
    groups = found.groupdict()
    whole = re.sub(r"\s", "", groups.get("number") or groups.get("sign") or "")
    return SyntaxHint(
        found.start(),
        f"'{found[0]}' has a comma in its number",
        f"Write {found['word']}{whole}.{found['rest']}: a decimal point, no comma.",
    )


def _letters_and_commas(code: str) -> SyntaxHint | None:
    letters, comma = _LETTERS.search(code), _COMMA.search(code)
    if letters is not None and (comma is None or letters.start() < comma.start()):
        return SyntaxHint(letters.start(), f"'{letters[0][0]}' has no number", _letters_hint(letters[0]))
    if comma is None:
        return None
    if between := _BETWEEN_BLOCKS.match(code, comma.start()):
        word = between["word"].upper()
        return SyntaxHint(
            comma.start(),
            f"',{word}' (a chamfer or a rounding between blocks) is not known here",
            "Write the chamfer or the rounding as a block of its own.",
        )
    return SyntaxHint(
        comma.start(), "',' is not allowed in a block", "A block holds words like X12.5; remove it."
    )


def number_hint(letter: str, before: str) -> str:
    """Return what to do with a letter without a number; `before` stands before it in its line."""
    if letter.upper() in _AXES and _HOME.search(before):
        return f"To home {letter.upper()} from where it is, write G91 G28 {letter.upper()}0, then G90."
    return f"Write the number right after the letter, like {letter}{_NUMBERS.get(letter.upper(), '10')}."


def _letters_hint(letters: str) -> str:
    if letters[1:].upper().strip("O") == "":
        return f"Write zeros instead of the letter O: {letters[0]}{'0' * (len(letters) - 1)}."
    if len(letters) > 2:
        return f"'{_shown(letters)}' is no word: write text as a comment, or remove it."
    hint = number_hint(letters[0], "")
    return f"'{letters}' is no word: {hint[0].lower()}{hint[1:]}"


def _shown(letters: str) -> str:
    return letters if len(letters) <= 20 else letters[:20] + "..."
