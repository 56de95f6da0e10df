"""The text of a part program: bytes, newlines, places of bytes as line and column."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.errors import UsageError
from polycnc.nc.text._program import ProgramText


def test_text_and_bytes_become_the_same_read_only_array() -> None:
    text = ProgramText.from_text("N1 X2\n", name="part")
    assert text.name == "part"
    assert bytes(text.data) == b"N1 X2\n"
    assert bytes(ProgramText.from_text(b"N1 X2\n").data) == b"N1 X2\n"
    assert len(text) == 6
    with pytest.raises(ValueError, match="read-only"):
        text.data[0] = 65


def test_a_file_is_read_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_bytes(b"\xef\xbb\xbfG1\r\n(\xe4)\r\n")
    text = ProgramText.from_path(path)
    assert text.name == str(path)
    assert bytes(text.data) == b"G1\r\n(\xe4)\r\n"  # without the byte-order mark
    assert text.position(5).text == "(ä)"


def test_an_empty_file_has_one_empty_line(tmp_path: Path) -> None:
    (tmp_path / "empty").write_bytes(b"")
    text = ProgramText.from_path(tmp_path / "empty")
    assert len(text) == 0
    assert str(text.position(0)) == f"{tmp_path / 'empty'}:1:1"


@pytest.mark.parametrize("newline", [b"\n", b"\r\n", b"\r"])
def test_places_with_every_newline(newline: bytes) -> None:
    text = ProgramText.from_text(newline.join([b"G1", b"", b"X10 Y", b"M30"]), name="p")
    third = 2 + 2 * len(newline)
    place = text.position(third + 4)
    assert (place.file, place.line, place.column, place.text) == ("p", 3, 5, "X10 Y")
    assert text.position(0).text == "G1"
    assert (text.position(2).line, text.position(2).column) == (1, 3)  # the newline ends its own line
    assert text.position(third).column == 1
    assert text.position(len(text)).line == 4
    assert text.line(third + 1) == "X10 Y"
    assert text.next_line(third) == third + 5 + len(newline)
    assert text.line_end(third) == third + 5


def test_mixed_newlines_count_each_once() -> None:
    text = ProgramText.from_text(b"a\rb\r\nc\n\nd\n\re")
    starts = [text.position(text.content.index(letter)).line for letter in (b"a", b"b", b"c", b"d", b"e")]
    assert starts == [1, 2, 3, 5, 7]


def test_columns_count_characters_not_bytes() -> None:
    text = ProgramText.from_text("(ä€) X", name="p")
    assert text.position(text.content.index(b"X")).column == 6
    assert text.position(text.content.index(b"X")).excerpt() == "    (ä€) X\n         ^"


def test_the_place_of_a_line_is_its_first_character() -> None:
    text = ProgramText.from_text("G0\n\t X1\n")
    place = text.line_position(2)
    assert (place.line, place.column, place.text) == (2, 3, "\t X1")


def test_what_cannot_be_read_is_a_usage_error(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no such file"):
        ProgramText.from_path(tmp_path / "missing.nc")
    with pytest.raises(UsageError, match="cannot read"):
        ProgramText.from_path(tmp_path)
    with pytest.raises(UsageError, match="UTF-16"):
        ProgramText.from_text("G1".encode("utf-16"))
    for coding in ("utf-16-le", "utf-16-be"):  # without a mark
        with pytest.raises(UsageError, match="UTF-16"):
            ProgramText.from_text("G1 X5".encode(coding))


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("before", [0, 1, 7, 23])
def test_the_first_line_that_is_too_long_is_found(newline: str, before: int) -> None:
    lines = [("x" * (n % 11)) for n in range(before)]
    short = ProgramText.from_text(newline.join([*lines, "y" * 11, *lines]))
    assert short.line_longer_than(11) is None
    text = ProgramText.from_text(newline.join([*lines, "y" * 12, *lines, "z" * 40]))
    offset = text.line_longer_than(11)
    assert offset is not None
    assert text.content[offset : offset + 12] == b"y" * 12


def test_a_file_that_is_not_there_is_told_with_the_nearest_and_a_folder_with_batch(tmp_path: Path) -> None:
    (tmp_path / "bracket.nc").touch()
    with pytest.raises(UsageError, match=r"no such file[^\n]*\n[^\n]*Did you mean [^\n]*bracket\.nc\?"):
        ProgramText.from_path(tmp_path / "braket.nc")
    with pytest.raises(UsageError, match=r"Check the name and the folder"):
        ProgramText.from_path(tmp_path / "O0700.mpf")
    with pytest.raises(UsageError, match=r"it is a folder\n[^\n]*polycnc batch "):
        ProgramText.from_path(tmp_path)
