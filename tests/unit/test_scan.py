"""The block scanners: what a word is, what flags a block gets, which errors are found where."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from polycnc.errors import ProgramError
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import (
    BAD,
    COMMENT,
    LABEL,
    MESSAGE,
    NO_TROUBLE,
    OVERSIZE,
    PERCENT,
    PLAIN,
    STATEMENT,
    WordColumns,
    scan,
    scan_rules,
    word_columns,
)
from polycnc.nc.text._scan_plain import Block, scan_block, scan_blocks

RULES = TextRules()
CPL = TextRules(line_numbers=True, semicolon_comments=False, statement_characters="[]#\"'$,*<>&?!@_%:;()")


class Fast(NamedTuple):
    """One block of the compiled scanner."""

    words: list[tuple[str, float]]
    flags: int
    skip_level: int
    line: int
    offset: int
    trouble: int


def fast(text: str, rules: TextRules = RULES, columns: WordColumns | None = None) -> list[Fast]:
    """Scan text that fits into the columns at once."""
    program = ProgramText.from_text(text.encode("latin-1"))
    columns = columns or word_columns(64)
    assert scan(program.data, 0, 1, scan_rules(rules), columns) == len(program)
    return [block_of(columns, b) for b in range(columns.n_blocks)]


def block_of(columns: WordColumns, b: int) -> Fast:
    span = range(columns.first_word[b], columns.first_word[b + 1])
    return Fast(
        [(chr(columns.letter[w]), float(columns.value[w])) for w in span],
        int(columns.flags[b]),
        int(columns.skip_level[b]),
        int(columns.line[b]),
        int(columns.offset[b]),
        int(columns.trouble[b]),
    )


def plain(text: str, rules: TextRules = RULES) -> Block:
    """Read the first line of text the ordinary way."""
    return scan_block(ProgramText.from_text(text.encode("latin-1"), name="p"), 0, 1, rules)


BOTH = [
    ("N10 G1 X1.234 Y-5.678 F1000", [("N", 10), ("G", 1), ("X", 1.234), ("Y", -5.678), ("F", 1000)]),
    ("n10g01x.75y20.z-.5a+3", [("N", 10), ("G", 1), ("X", 0.75), ("Y", 20), ("Z", -0.5), ("A", 3)]),
    ("X 1.5 Y\t-2 Z + 3", [("X", 1.5), ("Y", -2), ("Z", 3)]),
    ("X=12.5 Y = -3", [("X", 12.5), ("Y", -3)]),
    ("G1\0X1\x1a", [("G", 1), ("X", 1)]),
    ("G1 X7\x03", [("G", 1), ("X", 7)]),
    ("G5.1 G54.1", [("G", 5.1), ("G", 54.1)]),
    ("X0.1 Y123456789.123456 Z9007199254740992", [("X", 0.1), ("Y", 123456789.123456), ("Z", 2.0**53)]),
    ("X000000000000000000001.50", [("X", 1.5)]),
]


@pytest.mark.parametrize(("text", "words"), BOTH)
def test_words(text: str, words: list[tuple[str, float]]) -> None:
    (block,) = fast(text)
    assert (block.words, block.flags, block.trouble) == (words, PLAIN, NO_TROUBLE)
    slow = plain(text)
    assert [(word.letter, word.value) for word in slow.words] == words
    assert slow.flags == PLAIN


def test_words_know_their_place_and_their_point() -> None:
    columns = word_columns(4)
    fast("  N5 x1. Y-.5 z2\n", columns=columns)
    assert columns.n_words == 4
    assert columns.place[:4].tolist() == [2, 5, 9, 14]
    assert columns.point[:4].tolist() == [0, 1, 1, 0]
    slow = plain("  N5 x1. Y-.5 z2\n")
    assert [(word.place, word.point) for word in slow.words] == [
        (2, False),
        (5, True),
        (9, True),
        (14, False),
    ]


def test_minus_zero_stays_minus_zero() -> None:
    assert str(fast("X-0")[0].words[0][1]) == str(fast(" X - 0.0")[0].words[0][1]) == "-0.0"
    assert str(plain("X-0").words[0].value) == "-0.0"


@pytest.mark.parametrize(
    ("text", "flags", "words"),
    [
        ("(rough) G1", COMMENT, [("G", 1)]),
        ("G1 (a) X2 (b)", COMMENT, [("G", 1), ("X", 2)]),
        ("G1 ; (X2", COMMENT, [("G", 1)]),
        ("; only", COMMENT, []),
        ("(\xe4\xf6\xfc)", COMMENT, []),
        ("(MSG, load tool 3)", MESSAGE, []),
        ("N10 ( msg ,x) (y)", MESSAGE | COMMENT, [("N", 10)]),
        ("(MESSAGE, no)", COMMENT, []),
        ("%", PERCENT, []),
        ("  %1234 anything {", PERCENT, []),
        (":100 G1", LABEL, [(":", 100), ("G", 1)]),
        (": G1", LABEL, [("G", 1)]),
    ],
)
def test_flags(text: str, flags: int, words: list[tuple[str, float]]) -> None:
    (block,) = fast(text)
    assert (block.flags, block.words) == (flags, words)
    slow = plain(text)
    assert (slow.flags, [(word.letter, word.value) for word in slow.words]) == (flags, words)


@pytest.mark.parametrize(
    ("text", "level"), [("/G1", 1), ("/3 G1", 3), (" / N10 G1", 1), ("N10 /9 G1", 9), ("/", 1), ("G1", 0)]
)
def test_skip_marks(text: str, level: int) -> None:
    assert fast(text)[0].skip_level == plain(text).skip_level == level
    assert fast(text)[0].flags == PLAIN


@pytest.mark.parametrize(
    "text",
    [
        "X[1+2]",
        "#1=5",
        "N10 G1 X#2",
        "X-#2",
        "N10 GOTO 20",
        "COORD(1)",
        "X=Y",
        "X=",
        "X=-A",
        "X=5+A",
        "X1=[A]",
        'N1 "text"',
        "X5,R2",
        "IF X",
    ],
)
def test_statements(text: str) -> None:
    (block,) = fast(text)
    assert (block.flags, block.words, block.trouble) == (STATEMENT, [], NO_TROUBLE)
    slow = plain(f"  {text}  ")
    assert (slow.flags, slow.words, slow.statement) == (STATEMENT, (), text)


@pytest.mark.parametrize(
    "text", ["10 A=5", "10 IF A THEN", ".JUMP", "N10 X[A%]", "B$", "A%=5 : B=6", "PRN#(0)"]
)
def test_statements_of_cpl(text: str) -> None:
    assert fast(text, CPL)[0].flags == plain(text, CPL).flags == STATEMENT


def test_what_only_the_ordinary_scanner_reads() -> None:
    for text in ("X1=10", "X0.1234567890123456789", "X12345678901234567890", "X0.00000000000000000000001"):
        assert fast(text)[0].flags == STATEMENT
    indexed = plain("N5 X1=10.5 Y=2")
    assert [(word.letter, word.index, word.value) for word in indexed.words] == [
        ("N", None, 5.0),
        ("X", 1, 10.5),
        ("Y", None, 2.0),
    ]
    assert plain("X0.1234567890123456789").words[0].value == 0.1234567890123456789
    assert plain("X12345678901234567890").words[0].value == 12345678901234567890.0


@pytest.mark.parametrize(
    ("text", "column", "what"),
    [
        ("G1 X", 4, "'X' has no number"),
        ("G1 X Y5", 4, "'X' has no number"),
        ("G1 X.", 4, "'X' has no number"),
        ("G1 X--5", 4, "'X' has no number"),
        ("G1 X(5)", 4, "'X' has no number"),
        ("G1 5 X1", 4, "'5' has no letter"),
        ("G1 X1.2.3", 8, "'.3' has no letter"),
        ("-7.5", 1, "'-7.5' has no letter"),
        ("G1 {", 4, "'{' is not allowed in a block"),
        ("X{5}", 2, "'{' is not allowed in a block"),
        ("X1\xe4", 3, "byte 0xE4"),
        ("G1 (open", 4, "the comment is not closed"),
        ("G1 / X1", 4, "'/' belongs at the beginning"),
        ("/ /", 3, "'/' belongs at the beginning"),
        ("/0", 2, "'0' has no letter"),
        ("G1 % X1", 4, "'%' belongs at the beginning"),
        ("G1 :5", 4, "':' belongs at the beginning"),
    ],
)
def test_errors(text: str, column: int, what: str) -> None:
    (block,) = fast(text)
    assert (block.flags & BAD, block.words, block.trouble) == (BAD, [], column - 1)
    with pytest.raises(ProgramError, match=r"^p:1:") as caught:
        plain(text)
    assert what in caught.value.what
    assert caught.value.position is not None
    assert (caught.value.position.line, caught.value.position.column) == (1, column)
    assert caught.value.hint


def test_a_number_that_no_double_holds_is_an_error() -> None:
    with pytest.raises(ProgramError, match="too large"):
        plain(f"X{'9' * 400}")


def test_an_error_names_line_and_column_of_its_file() -> None:
    text = ProgramText.from_text("G1 X1\n\n  Y(note)\n", name="part.nc")
    with pytest.raises(ProgramError) as caught:
        list(scan_blocks(text, RULES))
    assert str(caught.value).splitlines()[:3] == [
        "part.nc:3:3: 'Y' has no number",
        "      Y(note)",
        "      ^",
    ]


def test_comments_and_messages_are_kept_by_the_ordinary_scanner() -> None:
    block = plain("N1 ( first ) (MSG, load \xe4 ) ; last ")
    assert block.comments == ("first", "last")
    assert block.message == "load \xe4"
    utf8 = scan_block(ProgramText.from_text("(MSG, 20 \u00b5m)"), 0, 1, RULES)
    assert utf8.message == "20 \u00b5m"


def test_comment_rules_of_a_dialect() -> None:
    unclosed = TextRules(unclosed_comments=True)
    assert fast("G1 (open", unclosed)[0].flags == plain("G1 (open", unclosed).flags == COMMENT
    assert plain("(MSG,open", unclosed).message == "open"
    assert fast("G1 ;x", TextRules(semicolon_comments=False))[0].flags == BAD
    assert fast("G1 (x)", TextRules(parenthesis_comments=False))[0].flags == BAD


def test_blank_lines_make_no_block_but_count() -> None:
    blocks = fast("\n  \nG1\r\n\t\r\nG2\r\rG3")
    assert [(block.line, block.words) for block in blocks] == [
        (3, [("G", 1)]),
        (5, [("G", 2)]),
        (7, [("G", 3)]),
    ]


def test_scanning_goes_on_where_the_columns_were_full() -> None:
    program = ProgramText.from_text("N1 G1\nN2\n(c)\n\nN3 G3 X3\nN4\n")
    columns = word_columns(blocks=2, words=4)
    rules = scan_rules(RULES)
    found = []
    offset, line, calls = 0, 1, 0
    while offset < len(program):
        offset = scan(program.data, offset, line, rules, columns)
        line = columns.next_line
        found += [block_of(columns, b) for b in range(columns.n_blocks)]
        calls += 1
    assert calls == 3  # N1 N2 | (c) N3 | N4
    assert [(block.line, block.offset, len(block.words)) for block in found] == [
        (1, 0, 2),
        (2, 6, 1),
        (3, 9, 0),
        (5, 14, 3),
        (6, 23, 1),
    ]


def test_a_block_that_does_not_fit_waits_for_empty_columns_or_is_oversize() -> None:
    program = ProgramText.from_text("N1\nX1 Y2 Z3\nG1 X1 Y2 Z3\nN4")
    columns = word_columns(blocks=9, words=3)
    rules = scan_rules(RULES)
    assert scan(program.data, 0, 1, rules, columns) == 3
    assert (columns.n_blocks, columns.next_line) == (1, 2)
    assert scan(program.data, 3, 2, rules, columns) == 12
    assert block_of(columns, 0).words == [("X", 1), ("Y", 2), ("Z", 3)]
    assert scan(program.data, 12, 3, rules, columns) == len(program)
    assert [(block.flags, block.words) for block in (block_of(columns, 0), block_of(columns, 1))] == [
        (OVERSIZE, []),
        (PLAIN, [("N", 4)]),
    ]
    assert block_of(columns, 0).trouble == 12 + len("G1 X1 Y2 ")


def test_an_empty_program_has_no_blocks() -> None:
    columns = word_columns(4)
    columns.counts[:] = 9
    assert scan(np.zeros(0, dtype=np.uint8), 0, 1, scan_rules(RULES), columns) == 0
    assert columns.counts.tolist() == [0, 0, 1]
