"""The compiled and the ordinary block scanner read the same blocks, bit for bit, and refuse the same ones."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import hypothesis.strategies as st
import pytest
from hypothesis import example, given, settings

from polycnc.errors import ProgramError
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import BAD, OVERSIZE, STATEMENT, WordColumns, scan, scan_rules, word_columns
from polycnc.nc.text._scan_plain import Block, scan_block
from support.often import share

PLAIN_RULES = TextRules()
CPL_RULES = TextRules(
    unclosed_comments=True,
    line_numbers=True,
    statement_characters="[]#\"'$,*<>&?!@_%:()",
    semicolon_comments=False,
)
BARE_RULES = TextRules(
    parenthesis_comments=False, statement_characters="", semicolon_comments=False, semicolon_ends=True
)
ALL_RULES = (PLAIN_RULES, CPL_RULES, BARE_RULES)

digits = st.text("0123456789", max_size=9)
numbers = st.one_of(
    st.builds(lambda a, b: f"{a}.{b}", digits, digits),
    digits,
    st.floats(-1e6, 1e6).map(lambda value: f"{value:.6f}"),
    st.text("0123456789", min_size=14, max_size=26),
    st.builds(lambda a, b: f"{a}.{b}", digits, st.text("0123456789", min_size=10, max_size=25)),
)
blanks = st.sampled_from(["", "", "", " ", "\t", "  ", "\0"])
words = st.builds(
    "".join,
    st.tuples(st.sampled_from("NGXYZxyzFMiA"), blanks, st.sampled_from(["", "", "-", "+", "- "]), numbers),
)
easy_words = st.builds(
    lambda letter, value: f"{letter}{value}", st.sampled_from("GXYZ"), st.integers(-999, 999)
)
pieces = st.one_of(
    words,
    words,
    easy_words,
    st.builds(lambda letter, number: f"{letter}={number}", st.sampled_from("XY"), numbers),
    st.builds(lambda number: f"X1={number}", numbers),
    st.sampled_from(["(note)", "(MSG, hello)", "( msg ,x)", "(open", "; rest", "; ", "(\xe4\xf6)", "()"]),
    st.sampled_from(["/", "/3", "/0", ":", ":100", "%", "%1234", "N5", "N5 /2"]),
    st.sampled_from(
        ["GOTO", "X[1+2]", "#1=5", "A$", "X=Y", "X=-", "X-#1", '"', "X = 5 *2", "P,C5", "IF", ".L"]
    ),
    st.sampled_from(["X", "X-", "X.", "7", "-.5", "X1.2.3", "X--1", "\xe9", "&", ")", "X{", "X-&", "=", "."]),
    st.text("NGX019.-+/:%()[]#;=, \t$", max_size=6),
)
lines = st.lists(st.builds("".join, st.tuples(blanks, pieces)), max_size=6).map("".join)
newlines = st.sampled_from(["\n", "\r\n", "\r", "\n\n", "\n \r\n"])
programs = st.lists(st.builds(lambda line, newline: line + newline, lines, newlines), max_size=12).map(
    "".join
)


@dataclass
class FastBlock:
    words: list[tuple[str, str, int, bool]]
    flags: int
    skip_level: int
    offset: int
    line: int
    trouble: int


def fast_blocks(text: ProgramText, rules: TextRules, columns: WordColumns) -> list[FastBlock]:
    """Scan all of the text piece by piece."""
    compiled_rules = scan_rules(rules)
    offset, line, blocks = 0, 1, []
    while offset < len(text):
        before = offset
        offset = scan(text.data, offset, line, compiled_rules, columns)
        line = columns.next_line
        assert offset > before
        for b in range(columns.n_blocks):
            span = range(columns.first_word[b], columns.first_word[b + 1])
            blocks.append(
                FastBlock(
                    words=[
                        (
                            chr(columns.letter[w]),
                            float(columns.value[w]).hex(),
                            int(columns.place[w]),
                            bool(columns.point[w]),
                        )
                        for w in span
                    ],
                    flags=int(columns.flags[b]),
                    skip_level=int(columns.skip_level[b]),
                    offset=int(columns.offset[b]),
                    line=int(columns.line[b]),
                    trouble=int(columns.trouble[b]),
                )
            )
    return blocks


def plain_blocks(text: ProgramText, rules: TextRules) -> list[tuple[int, int, Block | ProgramError]]:
    """Read all of the text line by line; an error stands in the place of its block."""
    found: list[tuple[int, int, Block | ProgramError]] = []
    offset, line = 0, 1
    while offset < len(text):
        try:
            block = scan_block(text, offset, line, rules)
        except ProgramError as error:
            found.append((offset, line, error))
        else:
            if not block.is_blank:
                found.append((offset, line, block))
        offset = text.next_line(offset)
        line += 1
    return found


def assert_same(text: ProgramText, rules: TextRules, columns: WordColumns) -> None:
    fast = fast_blocks(text, rules, columns)
    plain = plain_blocks(text, rules)
    assert [(block.offset, block.line) for block in fast] == [(offset, line) for offset, line, _ in plain]
    for quick, (_, _, slow) in zip(fast, plain, strict=True):
        if quick.flags & OVERSIZE:
            assert not quick.words
        elif quick.flags & BAD:
            assert isinstance(slow, ProgramError)
            assert slow.position == text.position(quick.trouble)
        elif quick.flags & STATEMENT:
            assert not quick.words
            if isinstance(slow, Block) and not slow.flags & STATEMENT:
                assert any(word.index is not None or _is_long(text, word.place) for word in slow.words)
        else:
            assert isinstance(slow, Block)
            assert slow.flags == quick.flags
            assert slow.skip_level == quick.skip_level
            assert [(w.letter, w.value.hex(), w.place, w.point) for w in slow.words] == quick.words
            assert all(word.index is None for word in slow.words)


def _is_long(text: ProgramText, place: int) -> bool:
    """Tell whether the number at `place` is beyond exact conversion: over 2 ** 53, or over 22 decimals."""
    number = text.content[place + 1 :].lstrip(b" \t\0=+-")
    digits = 0
    while digits < len(number) and number[digits : digits + 1] in b"0123456789.":
        digits += 1
    whole, _, fraction = number[:digits].partition(b".")
    return int(whole + fraction) > 2**53 or len(fraction) > 22


@example("N. (note)\n", PLAIN_RULES, (1, 4))
@settings(max_examples=share(100))
@given(programs, st.sampled_from(ALL_RULES), st.sampled_from([(1, 4), (3, 7), (64, 512)]))
def test_both_scanners_read_the_same(program: str, rules: TextRules, size: tuple[int, int]) -> None:
    assert_same(ProgramText.from_text(program.encode("latin-1")), rules, word_columns(*size))


@settings(max_examples=share(100))
@given(st.binary(max_size=60), st.sampled_from(ALL_RULES))
def test_any_bytes(content: bytes, rules: TextRules) -> None:
    if content[:2] not in (b"\xff\xfe", b"\xfe\xff"):
        assert_same(ProgramText.from_text(content), rules, word_columns(8, 16))


@settings(max_examples=share(50))
@given(st.lists(words, min_size=1, max_size=30).map(" ".join))
def test_values_are_those_of_float(line: str) -> None:
    columns = word_columns(2, 64)
    text = ProgramText.from_text(line)
    scan(text.data, 0, 1, scan_rules(PLAIN_RULES), columns)
    for w in range(columns.n_words):
        end = columns.place[w + 1] if w + 1 < columns.n_words else len(line)
        written = line[columns.place[w] + 1 : end].replace("\t", "").replace(" ", "").replace("\0", "")
        assert float(columns.value[w]).hex() == float(written).hex()


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("blocks", [7, 4096])
def test_whole_files(newline: str, blocks: int) -> None:
    shapes = [
        "%",
        "O1234 (part 1)",
        "",
        "N{n} G1 X{x:.3f} Y-{n}.5 F1000",
        "  n{n} g1 x {x:.4f} ; remark",
        "/N{n} G0 Z+{n}",
        "(only a remark)",
        "N{n} G{n}",
        "X={x:.2f} Y = -{n}",
        "#1=[{n}]",
        "N{n} G1 X1Y2Z3.",
    ]
    rows = [shapes[n % len(shapes)].format(n=n, x=n * 0.37) for n in range(600)]
    text = ProgramText.from_text(newline.join(rows))
    columns = word_columns(blocks)
    assert_same(text, PLAIN_RULES, columns)
    found = fast_blocks(text, PLAIN_RULES, columns)
    assert len(found) == sum(1 for row in rows if row)
    assert [block.line for block in found] == [number for number, row in enumerate(rows, 1) if row]


def test_public_programs(data_nc: Path) -> None:
    columns = word_columns(1024)
    files = sorted(data_nc.glob("*.gcode"))
    assert files
    for file in files:
        text = ProgramText.from_path(file)
        assert_same(text, PLAIN_RULES, columns)
        assert not any(block.flags & (BAD | STATEMENT) for block in fast_blocks(text, PLAIN_RULES, columns))
