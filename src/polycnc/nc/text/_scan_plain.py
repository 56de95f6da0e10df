"""The ordinary block scanner: one line at a time, with exact errors and all that the compiled one leaves out.

It reads the same blocks as `_scan` but shares no code with it, so that a test can hold the two against each
other. Besides it knows numbers of any length and indexed addresses (X1=10), and it says what is wrong where.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from polycnc.errors import ProgramError
from polycnc.nc.text._not_words import number_hint
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import BLANK_BYTES, COMMENT, LABEL, MESSAGE, PERCENT, PLAIN, STATEMENT
from polycnc.units import whole

_B = f"[{re.escape(BLANK_BYTES.decode('ascii'))}]*+"  # blanks; '+' gives nothing back
_NUMBER = rf"([+-]?){_B}([0-9]++\.?[0-9]*+|\.[0-9]++)"
_LETTER = "([A-Za-z])"

_BLANKS = re.compile(_B)
_REMARKS = re.compile(rf"{_B}(?:\([^)]*+\)?{_B})*+")
_WORD = re.compile(_LETTER + "()" + _B + _NUMBER)  # letter, index, sign, digits
# The same with blanks among digits and point.
_WIDE_NUMBER = rf"([+-]?){_B}((?:[0-9]{_B})+(?:\.(?:{_B}[0-9])*)?|\.(?:{_B}[0-9])+)"
_WIDE_WORD = re.compile(_LETTER + "()" + _B + _WIDE_NUMBER)
_ALL_BLANKS = re.compile(f"[{re.escape(BLANK_BYTES.decode('ascii'))}]+")
_HALF_WORD = re.compile(rf"[A-Za-z]{_B}(?:[+-]{_B})?\.?")
_ASSIGNMENT = re.compile(rf"[A-Za-z]{_B}=")
_LABEL = re.compile(rf":(?:{_B}(?P<digits>[0-9]++\.?[0-9]*+))?")
_SKIP = re.compile(r"/(?P<level>[1-9]?)")
_BARE = re.compile(r"[0-9.+-]+")
_MESSAGE = re.compile(rf"{_B}MSG{_B},(?P<text>.*)", re.IGNORECASE | re.ASCII)

_KNOWN = re.compile(rf"[A-Za-z0-9+\-./:%{re.escape(BLANK_BYTES.decode('ascii'))}]")

_REMARK_HINT = "A block holds words like X12.5; remarks go into a comment."
_SENDER_COMMAND = re.compile(r"\$(?:\$|[#GNIX]|[0-9]+=[^;(]*)?[ \t]*(?=[;(]|\Z)|[?~]", re.IGNORECASE)
"""What asks a control for something, unlocks it or sets it, and moves nothing."""
_HOMING = re.compile(r"\$H[XYZABC]*[ \t]*(?=[;(]|\Z)", re.IGNORECASE)
_HEAD_BYTES = 1 << 14
_NO_WORDS = re.compile(r"(?:[ \t]*(?:\([^)\r\n]*\)[ \t]*)*(?:[%$?~;][^\r\n]*)?(?:\r\n?|\n))*")
_NESTED_NOTE = (
    "brackets within a comment: it is read up to where they match, controls may end it at the first ')'"
)
_SENDER_HINT = "It is a command that a sender gives the control, no block of a program: remove the line."


@dataclass(frozen=True, slots=True)
class Word:
    """Hold one word: upper-case letter, number, byte offset of the letter, whether it had a decimal point.

    `index` is set for an indexed address: X1=10 is letter X, index 1, value 10.
    """

    letter: str
    value: float
    place: int
    point: bool
    index: int | None = None


@dataclass(frozen=True, slots=True)
class Block:
    """Hold one block: its words, or, flagged STATEMENT, its raw line in `statement` and no words.

    `offset` is where its line begins. `message` is the text of the last
    (MSG, text), `comments` are the texts of all other comments, `profile` the lines of the sub-program whose profile
    the block cuts.
    """

    words: tuple[Word, ...]
    flags: int
    skip_level: int
    offset: int
    line: int
    statement: str = ""
    message: str = ""
    comments: tuple[str, ...] = ()
    profile: tuple[Block, ...] | None = None
    note: str = ""
    """What is to be said of the line, besides errors."""

    @property
    def is_blank(self) -> bool:
        """Whether the line holds nothing at all."""
        return not self.words and self.flags == PLAIN and self.skip_level == 0


def scan_block(text: ProgramText, offset: int, line: int, rules: TextRules) -> Block:
    """Read the block whose line begins at byte `offset`; `line` is its 1-based number.

    Raises:
        ProgramError: an illegal character, a letter without a number, a number without a letter, a comment
            that is not closed, or a number too large.
    """
    return _LineReader(text, offset, line, rules).read()


def scan_words(text: ProgramText, offset: int, line: int, rules: TextRules) -> Block:
    """Read a block that can only be words, remarks and marks.

    Raises:
        ProgramError: as `scan_block`, and where a statement of a language stands.
    """
    reader = _LineReader(text, offset, line, rules)
    block = reader.read()
    if block.flags & (STATEMENT | PERCENT | LABEL):
        raise reader.no_word()
    return block


def scan_blocks(text: ProgramText, rules: TextRules) -> Iterator[Block]:
    """Read all blocks, leaving out blank lines.

    Raises:
        ProgramError: as `scan_block`, when the block is reached.
    """
    offset, line = 0, 1
    while offset < len(text):
        block = scan_block(text, offset, line, rules)
        if not block.is_blank:
            yield block
        offset = text.next_line(offset)
        line += 1


@lru_cache(maxsize=8)
def _word_patterns(rules: TextRules) -> tuple[re.Pattern[str], ...]:
    """Return the patterns of X1=10, X=10 and X10, in the order to try; their groups are those of `_WORD`.

    Behind a number with '=' only a word, a comment or the end may follow.
    """
    openers = "(" * rules.parenthesis_comments + ";" * rules.semicolon_comments
    value = rf"{_B}={_B}{_NUMBER}(?={_B}(?:[A-Za-z{openers}]|\Z))"
    return re.compile(_LETTER + "([0-9]++)" + value), re.compile(_LETTER + "()" + value), _WORD


_LETTER_O = re.compile(r"([A-Za-z][+-]?[0-9.]+)[Oo]\Z")  # X1O, typed for X10


class _LineReader:
    """Read one line from left to right; the first error, or the first sign of a statement, decides."""

    def __init__(self, text: ProgramText, offset: int, line: int, rules: TextRules) -> None:
        self.text = text
        self.offset = offset
        self.line_number = line
        self.rules = rules
        # One character a byte, so that a place in the line is a place in the file.
        self.line = text.content[offset : text.line_end(offset)].decode("latin-1")
        plain = _WIDE_WORD if rules.blanks_in_numbers else _WORD
        self.word_patterns = _word_patterns(rules) if "=" in self.line else (plain,)
        self.place = 0
        self.words: list[Word] = []
        self.flags = PLAIN
        self.skip_level = 0
        self.comments: list[str] = []
        self.message = ""
        self.note = ""

    def read(self) -> Block:
        self._skip_blanks()
        if self._next() == "%":
            self.flags = PERCENT
            self.place = len(self.line)
        while self.place < len(self.line) and not self.flags & STATEMENT:
            self._read_item(self._next())
            self._skip_blanks()
        is_statement = bool(self.flags & STATEMENT)
        return Block(
            words=() if is_statement else tuple(self.words),
            flags=self.flags,
            skip_level=self.skip_level,
            offset=self.offset,
            line=self.line_number,
            statement=_utf8(self.line).strip() if is_statement else "",
            message=self.message,
            comments=tuple(self.comments),
            note=self.note,
        )

    def no_word(self) -> ProgramError:
        """Return the error of what stands where reading ended."""
        place = min(self.place, len(self.line.rstrip()) - 1)
        self.place = place if self.flags & STATEMENT else len(self.line) - len(self.line.lstrip())
        return self._error(
            f"'{_utf8(self.line[self.place :])[:1]}' begins no word", "A word is a letter with a number."
        )

    def _read_item(self, char: str) -> None:
        at_start = not self.words and not self.flags & LABEL
        if _is_letter(char):
            self._read_word()
        elif char == "(" and self.rules.parenthesis_comments:
            self._read_parenthesis()
        elif char == ";" and self.rules.semicolon_comments:
            self._keep_comment(self.line[self.place + 1 :])
            self.place = len(self.line)
        elif char == ";" and self.rules.semicolon_ends and self._ends_here():
            self.place += 1
        elif char == "/" and self.skip_level == 0 and self._may_skip():
            match = _matched(_SKIP, self.line, self.place)
            self.skip_level = whole(match["level"] or "1")
            self.place = match.end()
        else:
            self._read_mark(char, at_start=at_start)

    def _read_mark(self, char: str, *, at_start: bool) -> None:
        """Read a label, a command to the control, or what makes the line a statement."""
        if char == ":" and at_start:
            self._read_label()
        elif self.rules.sender_commands and char in "$?~" and (command := self._sender_command()):
            self._note(f"{command[0].strip()}: a command to the control, which is not carried out")
            self.place = command.end()
        elif self._is_statement(char) or (at_start and self.rules.line_numbers and char in "0123456789."):
            self.flags |= STATEMENT
        else:
            raise self._misplaced(char)

    def _read_word(self) -> None:
        for pattern in self.word_patterns:
            if match := pattern.match(self.line, self.place):
                letter, index, sign, digits = match.groups()
                digits = _ALL_BLANKS.sub("", digits)
                self._add(letter.upper(), sign, digits, whole(index) if index else None)
                self.place = match.end()
                return
        if _ASSIGNMENT.match(self.line, self.place):
            self.flags |= STATEMENT
            return
        after = _matched(_HALF_WORD, self.line, self.place).end()
        char = self.line[after : after + 1]
        if self._is_statement(char) or (_is_letter(char) and after == self.place + 1):
            self.flags |= STATEMENT
        elif char and not _KNOWN.match(char) and not self._opens_comment(char):
            self.place = after
            raise self._misplaced(char)
        else:
            letter = self.line[self.place]
            if found := _LETTER_O.search(self.line, 0, self.place + 1):
                self.place = found.start()
                raise self._error(
                    f"'{found[0]}' has the letter O in its number", f"Write {found[1]}0 with the digit 0."
                )
            raise self._error(f"'{letter}' has no number", number_hint(letter, self.line[: self.place]))

    def _add(self, letter: str, sign: str, digits: str, index: int | None = None) -> None:
        value = float(sign + digits)
        if math.isinf(value):
            raise self._error(f"the number of '{letter}' is too large", "Write a number below 1e308.")
        self.words.append(Word(letter, value, self.offset + self.place, "." in digits, index))

    def _read_label(self) -> None:
        self.flags |= LABEL
        match = _matched(_LABEL, self.line, self.place)
        if match["digits"]:
            self._add(":", "", match["digits"])
        self.place = match.end()

    def _read_parenthesis(self) -> None:
        close = self.line.find(")", self.place)
        if close < 0 and not self.rules.unclosed_comments:
            raise self._error("the comment is not closed", "Write ')' at its end, on the same line.")
        if self.rules.nested_comments and "(" in self.line[self.place + 1 : close]:
            close = self._matching(close)
        end = len(self.line) if close < 0 else close
        comment = self.line[self.place + 1 : end]
        if match := _MESSAGE.match(comment):
            self.flags |= MESSAGE
            self.message = _utf8(match["text"]).strip()
        else:
            self._keep_comment(comment)
        self.place = end if close < 0 else end + 1

    def _matching(self, first: int) -> int:
        """Return where the comment that begins here ends with brackets within it, `first` where they do not match."""
        depth = 0
        for place in range(self.place, len(self.line)):
            depth += {"(": 1, ")": -1}.get(self.line[place], 0)
            if depth == 0:
                self._note(_NESTED_NOTE)
                return place
        return first

    def _note(self, text: str) -> None:
        self.flags |= MESSAGE
        self.note = text

    def _keep_comment(self, comment: str) -> None:
        self.flags |= COMMENT
        self.comments.append(_utf8(comment).strip())

    def _ends_here(self) -> bool:
        """Tell whether nothing but comments follows the present character."""
        pattern = _REMARKS if self.rules.parenthesis_comments else _BLANKS
        return pattern.fullmatch(self.line, self.place + 1) is not None

    def _sender_command(self) -> re.Match[str] | None:
        """Return the command to the control that the line is; homing counts before the first block alone."""
        if self.line[: self.place].strip():
            return None
        found = _SENDER_COMMAND.match(self.line, self.place)
        is_early = self.offset <= _HEAD_BYTES
        if found is None and is_early and (homing := _HOMING.match(self.line, self.place)):
            before = self.text.content[: self.offset].decode("latin-1")
            found = homing if _NO_WORDS.fullmatch(before) else None
        return found

    def _may_skip(self) -> bool:
        return not self.words or (len(self.words) == 1 and self.words[0].letter == "N")

    def _is_statement(self, char: str) -> bool:
        return char != "" and (char == "=" or char in self.rules.statement_characters)

    def _opens_comment(self, char: str) -> bool:
        return (char == "(" and self.rules.parenthesis_comments) or (
            char == ";" and self.rules.semicolon_comments
        )

    def _skip_blanks(self) -> None:
        self.place = _matched(_BLANKS, self.line, self.place).end()

    def _next(self) -> str:
        return self.line[self.place : self.place + 1]

    def _misplaced(self, char: str) -> ProgramError:
        if char in "0123456789.+-":
            number = _matched(_BARE, self.line, self.place)[0]
            return self._error(f"'{number}' has no letter", "Write the address before it, like X12.5.")
        if char in "/:%":
            return self._error(f"'{char}' belongs at the beginning of a block", _REMARK_HINT)
        shown = char if char.isascii() and char.isprintable() else f"byte 0x{ord(char):02X}"
        hint = _REMARK_HINT
        if char in "$?~!" and self.line[: self.place].strip() == "":
            hint = _SENDER_HINT
        elif char == ")" and self.rules.parenthesis_comments:
            hint = "A comment ends at its first ')': write no brackets in it."
        elif char == ";" and self.rules.semicolon_ends:
            hint = "It ends a block: write what follows into a line of its own."
        return self._error(f"'{shown}' is not allowed in a block", hint)

    def _error(self, what: str, hint: str) -> ProgramError:
        return ProgramError(what, position=self.text.position(self.offset + self.place), hint=hint)


def _is_letter(char: str) -> bool:
    return char.isascii() and char.isalpha()


def _matched(pattern: re.Pattern[str], line: str, place: int) -> re.Match[str]:
    match = pattern.match(line, place)
    if match is None:
        raise AssertionError(f"{pattern.pattern!r} matches whatever stands here")
    return match


def _utf8(text: str) -> str:
    """Undo the one-character-a-byte reading for text that people will see."""
    try:
        return text.encode("latin-1").decode("utf-8")
    except UnicodeDecodeError:
        return text
