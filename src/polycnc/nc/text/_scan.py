"""The compiled block scanner: program bytes into columns of words and blocks, one pass, no Python objects.

It takes what nearly every block of a long program is, words with plain numbers. A block that needs more is
only flagged, and the ordinary scanner (`_scan_plain`) or a language front end reads its line again.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled, entry
from polycnc.nc.text._program import TextRules

# Flags of a block; a block with none of them, or with COMMENT alone, is words with numbers and nothing else.
PLAIN = 0
STATEMENT = 1
"""Something beyond words with plain numbers: the block has no words here; its line is to be read again."""
BAD = 2
"""An error, at the place in `trouble`: the block has no words."""
PERCENT = 4
"""A line that begins with %; what follows on the line is skipped."""
LABEL = 8
"""A colon opens the block (alignment block, program number); a number after it is a word of letter ':'."""
COMMENT = 16
MESSAGE = 32
"""A comment of the form (MSG, text)."""
OVERSIZE = 64
"""More words than the columns hold: the block has no words, the place in `trouble` is the first too many."""

NO_TROUBLE = -1

OPEN_VALUE = 2
"""In the place of a point: a language knows the number; `value` is the byte offset at which its text begins."""

# What a byte can be; everything else is OTHER.
OTHER, BLANK, NEWLINE, LETTER, DIGIT, SIGN, POINT, OPEN, SEMICOLON, SLASH, COLON, PERCENT_SIGN, ENDS = range(
    13
)

BLANK_BYTES = b" \t\v\f\0\x03\x11\x12\x13\x14\x1a\x7f"
"""Blanks, and the tape and transmission controls that machines skip: NUL, ETX, DC1 to DC4, SUB, DEL."""

_OPEN_TEXT = re.compile(rb"[+-]?(?:#(?:[0-9]+|<[^>\r\n]*>)|\[[^\]\r\n]*\])")
_LIMIT = 1 << 53  # whole numbers up to here are exact doubles
_EASY_DIGITS = 15  # so many digits stay below that limit whatever they are
_MAX_PLACES = 22  # 10 ** 22 is the last power of ten that is an exact double
_EQUALS = ord("=")
_RETURN = ord("\r")
_FEED = ord("\n")
_CLOSE = ord(")")
_ZERO, _NINE = ord("0"), ord("9")
_UPPER = 0xDF  # clears the bit that tells small letters from capitals
_MINUS, _POINT, _SPACE = ord("-"), ord("."), ord(" ")
_COMMA = ord(",")
_A, _Z, _N = ord("A"), ord("Z"), ord("N")
_MARK, _BRACKET, _CLOSING, _ANGLE, _CLOSING_ANGLE = ord("#"), ord("["), ord("]"), ord("<"), ord(">")
_M, _S, _G = ord("M"), ord("S"), ord("G")


class ScanRules(NamedTuple):
    """What each byte is: `classes` uint8[256], `statement` uint8[256] (1: hands the block on); switches.

    With `open_words` a word may have a variable or an expression in brackets for its number: see `OPEN_VALUE`.
    """

    classes: npt.NDArray[np.uint8]
    statement: npt.NDArray[np.uint8]
    powers: npt.NDArray[np.float64]
    unclosed_comments: bool
    line_numbers: bool
    open_words: bool


class WordColumns(NamedTuple):
    """Hold the words and blocks of one piece of a program, column by column.

    Words of block b are `first_word[b]` up to `first_word[b + 1]`. `letter` is upper-case ASCII, `place` the
    byte offset of the letter, `point` 1 for a number with a decimal point, or OPEN_VALUE. `offset` is where the line
    of a block begins, `line` its 1-based number, `skip_level` 0 without a slash, 1 for '/', else its digit; `trouble`
    is NO_TROUBLE or the byte offset of an error.
    `counts` is words, blocks and the line number at the offset that `scan` returned.
    """

    letter: npt.NDArray[np.uint8]
    value: npt.NDArray[np.float64]
    place: npt.NDArray[np.int64]
    point: npt.NDArray[np.uint8]
    first_word: npt.NDArray[np.int32]
    offset: npt.NDArray[np.int64]
    line: npt.NDArray[np.int32]
    flags: npt.NDArray[np.int32]
    skip_level: npt.NDArray[np.uint8]
    trouble: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int64]

    @property
    def n_words(self) -> int:
        """How many words are filled."""
        return int(self.counts[0])

    @property
    def n_blocks(self) -> int:
        """How many blocks are filled."""
        return int(self.counts[1])

    @property
    def next_line(self) -> int:
        """The line number to go on with."""
        return int(self.counts[2])


def word_columns(blocks: int = 65536, words: int = 0) -> WordColumns:
    """Make empty columns for so many blocks and words (0: eight words a block)."""
    size = words or 8 * blocks
    return WordColumns(
        letter=np.zeros(size, dtype=np.uint8),
        value=np.zeros(size, dtype=np.float64),
        place=np.zeros(size, dtype=np.int64),
        point=np.zeros(size, dtype=np.uint8),
        first_word=np.zeros(blocks + 1, dtype=np.int32),
        offset=np.zeros(blocks, dtype=np.int64),
        line=np.zeros(blocks, dtype=np.int32),
        flags=np.zeros(blocks, dtype=np.int32),
        skip_level=np.zeros(blocks, dtype=np.uint8),
        trouble=np.zeros(blocks, dtype=np.int64),
        counts=np.zeros(3, dtype=np.int64),
    )


def scan_rules(rules: TextRules) -> ScanRules:
    """Turn the text rules of a dialect into the tables of the compiled scanner."""
    classes = np.full(256, OTHER, dtype=np.uint8)
    for members, kind in (
        (BLANK_BYTES, BLANK),
        (b"\r\n", NEWLINE),
        (bytes(range(ord("A"), ord("Z") + 1)) + bytes(range(ord("a"), ord("z") + 1)), LETTER),
        (b"0123456789", DIGIT),
        (b"+-", SIGN),
        (b".", POINT),
        (b"/", SLASH),
        (b":", COLON),
        (b"%", PERCENT_SIGN),
        (b"(" if rules.parenthesis_comments else b"", OPEN),
        (b";" if rules.semicolon_ends else b"", ENDS),
        (b";" if rules.semicolon_comments else b"", SEMICOLON),
    ):
        classes[list(members)] = kind
    statement = np.zeros(256, dtype=np.uint8)
    statement[list(rules.statement_characters.encode("ascii") + b"=")] = 1
    powers = np.array([float(10**exponent) for exponent in range(_MAX_PLACES + 1)])
    return ScanRules(
        classes, statement, powers, rules.unclosed_comments, rules.line_numbers, open_words=False
    )


def open_text(content: bytes, begin: int) -> str:
    """Return what stands in a text from byte `begin` on for the number of a word."""
    found = _OPEN_TEXT.match(content, begin)
    return "" if found is None else found[0].decode("latin-1")


@entry(steps=lambda data, offset, *_: (len(data) - offset) // 16 + 1)
def scan(data: npt.NDArray[np.uint8], offset: int, line: int, rules: ScanRules, columns: WordColumns) -> int:
    """Fill the columns with whole blocks from byte `offset` on and return the offset to go on from.

    `line` is the number of the line at `offset`; the one to go on with is `columns.counts[2]`. Returns the
    length of `data` when all of it is done. Blank lines make no block.
    """
    end = len(data)
    position = offset
    blocks = 0
    words = 0
    while position < end:
        position, line, blocks, words = _scan_easy_blocks(data, position, line, blocks, words, rules, columns)
        if position == end or blocks == len(columns.offset):
            break
        after, words_now, is_block = _scan_block(data, position, words, blocks, rules, columns)
        if is_block:
            if columns.flags[blocks] & OVERSIZE and blocks > 0:
                break  # it may fit into empty columns
            columns.first_word[blocks] = words
            columns.offset[blocks] = position
            columns.line[blocks] = line
            words = words_now
            blocks += 1
        position = _after_newline(data, after)
        line += 1
    columns.first_word[blocks] = words
    columns.counts[0] = words
    columns.counts[1] = blocks
    columns.counts[2] = line
    return position


@compiled
def _scan_easy_blocks(
    data: npt.NDArray[np.uint8],
    position: int,
    line: int,
    blocks: int,
    words: int,
    rules: ScanRules,
    columns: WordColumns,
) -> tuple[int, int, int, int]:
    """Scan lines of the form that programs use most: letter, perhaps a minus, at most 15 digits, and spaces.

    Stops before the first line with anything else in it, or when the columns are full. No byte table is read:
    what it accepts means the same in every dialect. Returns offset, line, blocks and words by then.
    """
    end = len(data)
    powers = rules.powers
    letter, value, place, point = columns.letter, columns.value, columns.place, columns.point
    first_word, block_offset, block_line = columns.first_word, columns.offset, columns.line
    flags, skip_level, trouble = columns.flags, columns.skip_level, columns.trouble
    word_capacity = len(letter)
    block_capacity = len(block_offset)
    while position < end and blocks < block_capacity:
        start = position
        first = words
        while position < end:
            byte = data[position]
            capital = byte & _UPPER
            if _A <= capital <= _Z:
                at = position
                position += 1
                negative = position < end and data[position] == _MINUS
                if negative:
                    position += 1
                mantissa = 0
                begin = position
                while position < end and _ZERO <= data[position] <= _NINE:
                    mantissa = mantissa * 10 + int(data[position] - _ZERO)
                    position += 1
                digits = position - begin
                places = 0
                has_point = position < end and data[position] == _POINT
                if has_point:
                    position += 1
                    begin = position
                    while position < end and _ZERO <= data[position] <= _NINE:
                        mantissa = mantissa * 10 + int(data[position] - _ZERO)
                        position += 1
                    places = position - begin
                    digits += places
                if digits == 0 or digits > _EASY_DIGITS or words == word_capacity:
                    return start, line, blocks, first
                number = float(mantissa)
                if places > 0:
                    number /= powers[places]
                letter[words] = capital
                value[words] = -number if negative else number
                place[words] = at
                point[words] = has_point
                words += 1
            elif byte == _SPACE:
                position += 1
            elif byte in (_FEED, _RETURN):
                break
            else:
                return start, line, blocks, first
        if words > first:
            first_word[blocks] = first
            block_offset[blocks] = start
            block_line[blocks] = line
            flags[blocks] = PLAIN
            skip_level[blocks] = 0
            trouble[blocks] = NO_TROUBLE
            blocks += 1
        position = _after_newline(data, position)
        line += 1
    return position, line, blocks, words


@compiled
def _scan_block(
    data: npt.NDArray[np.uint8], position: int, first: int, block: int, rules: ScanRules, columns: WordColumns
) -> tuple[int, int, bool]:
    """Scan any line; return where it ends, the words by then, and whether it is a block (it is not blank)."""
    end = len(data)
    classes = rules.classes
    position = _skip_blanks(data, position, classes)
    if position == end or classes[data[position]] == NEWLINE:
        return position, first, False
    words = first
    flags = PLAIN
    skip_level = 0
    trouble = NO_TROUBLE
    if classes[data[position]] == PERCENT_SIGN:
        flags = PERCENT
        position = _find_newline(data, position)
    while position < end:
        byte = data[position]
        kind = classes[byte]
        if kind == BLANK:
            position += 1
        elif kind == LETTER:
            if words == len(columns.letter):
                flags |= OVERSIZE
                trouble = position
                break
            after, value, point, found = _scan_value(data, position, rules)
            if found != PLAIN:
                flags |= found
                trouble = after if found == BAD else NO_TROUBLE
                break
            columns.letter[words] = byte & _UPPER
            columns.value[words] = value
            columns.place[words] = position
            columns.point[words] = point
            words += 1
            position = after
        elif kind == NEWLINE:
            break
        elif kind == OPEN:
            closing = _find_close(data, position, rules)
            if closing == NO_TROUBLE:
                flags |= BAD
                trouble = position
                break
            flags |= MESSAGE if _is_message(data, position + 1, rules) else COMMENT
            position = closing
        elif kind == SEMICOLON:
            flags |= COMMENT
            break
        elif kind == ENDS and _is_last(data, position + 1, rules):
            position += 1
        elif kind == SLASH and skip_level == 0 and _is_opening(columns.letter, first, words):
            position, skip_level = _scan_skip_mark(data, position)
        elif kind == COLON and words == first and not flags & LABEL:
            flags |= LABEL
            position, words, found = _scan_label(data, position, words, rules, columns)
            if found != PLAIN:
                flags |= found
                trouble = position if found == OVERSIZE else NO_TROUBLE
                break
        else:
            opening = words == first and not flags & LABEL
            if rules.statement[byte] or (rules.line_numbers and opening and kind in (DIGIT, POINT)):
                flags |= STATEMENT
            else:
                flags |= BAD
                trouble = position
            break
    if flags & (STATEMENT | BAD | OVERSIZE):
        words = first
    columns.flags[block] = flags
    columns.skip_level[block] = skip_level
    columns.trouble[block] = trouble
    return _find_newline(data, position), words, True


@compiled
def _scan_value(data: npt.NDArray[np.uint8], letter: int, rules: ScanRules) -> tuple[int, float, int, int]:
    """Read the number after a letter; return the offset after it (or of the error), value, point, flag."""
    end = len(data)
    position = _skip_blanks(data, letter + 1, rules.classes)
    if position < end and data[position] == _EQUALS:
        after, value, point, found = _scan_number(data, position + 1, rules)
        if found == PLAIN and _is_word_end(data, after, rules):
            return after, value, point, PLAIN
        return letter, 0.0, 0, STATEMENT
    after, value, point, found = _scan_number(data, position, rules)
    if found != BAD:
        return after, value, point, found
    if rules.open_words and after < end:
        behind = _find_open_end(data, after)
        if behind > after:
            return behind, float(position), OPEN_VALUE, PLAIN
    if after < end:
        kind = rules.classes[data[after]]
        if rules.statement[data[after]] or (kind == LETTER and after == letter + 1):
            return letter, 0.0, 0, STATEMENT
        if kind == OTHER:
            return after, 0.0, 0, BAD
    return letter, 0.0, 0, BAD


@compiled
def _find_open_end(data: npt.NDArray[np.uint8], begin: int) -> int:
    """Return the offset after #12, #<name> or [...]; `begin` where none of them is complete on its line."""
    end = len(data)
    position = begin + 1
    if data[begin] == _BRACKET:
        depth = 1
        while position < end and depth > 0 and data[position] != _FEED and data[position] != _RETURN:
            if data[position] == _BRACKET:
                depth += 1
            elif data[position] == _CLOSING:
                depth -= 1
            position += 1
        return begin if depth > 0 else position
    if data[begin] != _MARK or position == end:
        return begin
    if data[position] == _ANGLE:
        while position < end and data[position] != _FEED and data[position] != _RETURN:
            position += 1
            if data[position - 1] == _CLOSING_ANGLE:
                return position
        return begin
    while position < end and _ZERO <= data[position] <= _NINE:
        position += 1
    return begin if position == begin + 1 else position


@compiled
def _scan_number(data: npt.NDArray[np.uint8], position: int, rules: ScanRules) -> tuple[int, float, int, int]:
    """Read blanks, a sign and a decimal number; flag BAD when there is none, STATEMENT when it is too long.

    The digits make one whole number below 2 ** 53 and the power of ten is at most 22: both are exact, so the
    one division rounds as `float()` does (Clinger, How to read floating point numbers accurately, 1990).
    """
    end = len(data)
    classes = rules.classes
    negative = False
    position = _skip_blanks(data, position, classes)
    if position < end and classes[data[position]] == SIGN:
        negative = data[position] == _MINUS
        position = _skip_blanks(data, position + 1, classes)
    mantissa = 0
    begin = position
    while position < end and classes[data[position]] == DIGIT:
        if mantissa <= _LIMIT:
            mantissa = mantissa * 10 + int(data[position] - _ZERO)
        position += 1
    digits = position - begin
    point = 0
    places = 0
    if position < end and classes[data[position]] == POINT:
        point = 1
        position += 1
        begin = position
        while position < end and classes[data[position]] == DIGIT:
            if mantissa <= _LIMIT:
                mantissa = mantissa * 10 + int(data[position] - _ZERO)
            position += 1
        places = position - begin
    if digits + places == 0:
        return position, 0.0, 0, BAD
    if mantissa > _LIMIT or places > _MAX_PLACES:
        return position, 0.0, 0, STATEMENT
    value = mantissa / rules.powers[places]
    return position, -value if negative else value, point, PLAIN


@compiled
def _scan_skip_mark(data: npt.NDArray[np.uint8], slash: int) -> tuple[int, int]:
    """Read '/' or '/1' to '/9'; return the offset after it and the level."""
    after = slash + 1
    if after < len(data) and _ZERO < data[after] <= _ZERO + 9:
        return after + 1, int(data[after] - _ZERO)
    return after, 1


@compiled
def _scan_label(
    data: npt.NDArray[np.uint8], colon: int, word: int, rules: ScanRules, columns: WordColumns
) -> tuple[int, int, int]:
    """Read ':' and the number after it, if any, as a word; return the offset after it, words, a flag."""
    end = len(data)
    position = _skip_blanks(data, colon + 1, rules.classes)
    if position == end or rules.classes[data[position]] != DIGIT:
        return position, word, PLAIN
    after, value, point, found = _scan_number(data, position, rules)
    if found != PLAIN:
        return position, word, found
    if word == len(columns.letter):
        return position, word, OVERSIZE
    columns.letter[word] = data[colon]
    columns.value[word] = value
    columns.place[word] = colon
    columns.point[word] = point
    return after, word + 1, PLAIN


@compiled
def _is_opening(letter: npt.NDArray[np.uint8], first: int, words: int) -> bool:
    """Tell whether nothing but a block number stands before: there a skip mark may stand."""
    return words == first or (words == first + 1 and letter[first] == _N)


@compiled
def _is_word_end(data: npt.NDArray[np.uint8], position: int, rules: ScanRules) -> bool:
    """Tell whether a value given with '=' is done: a word, a comment or the end of the line follows."""
    end = len(data)
    position = _skip_blanks(data, position, rules.classes)
    if position == end:
        return True
    kind = rules.classes[data[position]]
    return bool(kind in (LETTER, NEWLINE, OPEN, SEMICOLON))


@compiled
def _is_last(data: npt.NDArray[np.uint8], position: int, rules: ScanRules) -> bool:
    """Tell whether nothing but blanks and comments stands from here to the end of the line."""
    in_comment = False
    while position < len(data) and rules.classes[data[position]] != NEWLINE:
        kind = rules.classes[data[position]]
        if in_comment:
            in_comment = data[position] != _CLOSE
        elif kind == OPEN:
            in_comment = True
        elif kind != BLANK:
            return False
        position += 1
    return True


@compiled
def _find_close(data: npt.NDArray[np.uint8], position: int, rules: ScanRules) -> int:
    """Return the offset after the comment that opens here, NO_TROUBLE when it is not closed and must be."""
    end = len(data)
    while position < end and rules.classes[data[position]] != NEWLINE:
        if data[position] == _CLOSE:
            return position + 1
        position += 1
    return position if rules.unclosed_comments else NO_TROUBLE


@compiled
def _is_message(data: npt.NDArray[np.uint8], position: int, rules: ScanRules) -> bool:
    """Tell whether a comment begins with MSG and a comma."""
    end = len(data)
    position = _skip_blanks(data, position, rules.classes)
    if position + 3 > end or data[position] & _UPPER != _M:
        return False
    if data[position + 1] & _UPPER != _S or data[position + 2] & _UPPER != _G:
        return False
    position += 3
    position = _skip_blanks(data, position, rules.classes)
    return position < end and data[position] == _COMMA


@compiled
def _skip_blanks(data: npt.NDArray[np.uint8], position: int, classes: npt.NDArray[np.uint8]) -> int:
    """Return the offset of the next byte that is no blank, or the length."""
    while position < len(data) and classes[data[position]] == BLANK:
        position += 1
    return position


@compiled
def _after_newline(data: npt.NDArray[np.uint8], position: int) -> int:
    """Return the offset after the newline at `position`: LF, CR LF or CR, or nothing at the end."""
    if position + 1 < len(data) and data[position] == _RETURN and data[position + 1] == _FEED:
        return position + 2
    return min(position + 1, len(data))


@compiled
def _find_newline(data: npt.NDArray[np.uint8], position: int) -> int:
    """Return the offset of the next CR or LF, or the length."""
    end = len(data)
    while position < end and data[position] != _FEED and data[position] != _RETURN:
        position += 1
    return position
