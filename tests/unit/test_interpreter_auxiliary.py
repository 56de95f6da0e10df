"""Spindle, coolant, stops, the program end, skip marks: what they queue, in which order, and for how long."""

from __future__ import annotations

import pytest

from polycnc.nc import Dialect, load_dialect
from support.programs import FIVE, accepted, moves, notes, refusal


def test_functions_come_before_the_motion_and_stops_behind_it() -> None:
    assert moves("F100 X1 M8 M3 S500 M0\nX2 M30\n") == [
        "M3 S500",
        "M8",
        "line X1 F100 stop",
        "M0",
        "line X2 F100 stop",
        "M30",
    ]


def test_the_tool_is_changed_before_the_spindle_starts() -> None:
    assert moves("M8 M3 M6 T1 S100\n") == ["M6 T1", "M3 S100", "M8"]


def test_all_functions_of_a_mill() -> None:
    program = "S500\nM3\nM4\nM5\nM7\nM8\nM9\nM0\nM1\nM19\nM123\nM2\n"
    assert moves(program) == [
        *("S500", "M3", "M4", "M5", "M7", "M8", "M9", "M0", "M1", "M19", "M123", "M2"),
    ]


def test_both_coolants_at_once() -> None:
    assert moves("M7 M8\n") == ["M7", "M8"]


def test_functions_take_the_times_of_the_machine() -> None:
    # The table says: tool change 5 s, spindle start 2 s, others 0.25 s.
    assert moves("T1 M6\nM3 S100\nM3\nM3 S200\nM5\nM5\nM8\nM30\n", config=FIVE) == [
        *("M6 T1", "wait 5"),
        *("M3 S100", "wait 2"),
        "M3",  # it turns already
        *("M3 S200", "wait 2"),
        *("M5", "wait 2"),
        "M5",
        *("M8", "wait 0.25"),
        "M30",
    ]


def test_the_path_comes_to_rest_at_a_function() -> None:
    assert moves("F100 X1\nX2 M8\nX3\n") == ["line X1 F100 stop", "M8", "line X2 F100", "line X3 F100"]


@pytest.mark.parametrize("end", ["M2", "M30"])
@pytest.mark.parametrize("dialect", ["din", "fanuc", "bosch"])
def test_nothing_comes_behind_the_program_end(end: str, dialect: str) -> None:
    assert moves(f"G0 X1\n{end}\nG0 X2\nnonsense\n", dialect=dialect) == ["rapid X1 stop", end]


def test_a_speed_alone_is_an_event() -> None:
    assert moves("S12000.5\n", config=FIVE) == ["S12000.5"]
    assert notes("S12000.5\n", config=FIVE) == ["S is above the spindle's 10000 rpm: it turns at that speed"]


@pytest.mark.parametrize(
    ("block", "text"),
    [
        ("M3 M4", "1:4: M3 and M4 exclude each other (group 'spindle')"),
        ("M5 M3", "1:4: M5 and M3 exclude each other (group 'spindle')"),
        ("M8 M9", "1:4: M8 and M9 exclude each other (group 'coolant')"),
        ("M9 M7", "1:4: M9 and M7 exclude each other (group 'coolant')"),
        ("M8 M8", "1:4: M8 is given twice in this block"),
        ("M0 M30", "1:4: M0 and M30 exclude each other (group 'stop')"),
        ("M98 P1 M30", "1:8: M98 and M30 exclude each other (group 'stop')"),
        ("M1.5", "1:1: there is no M1.5"),
        ("M-1", "1:1: there is no M-1"),
        ("M100000", "1:1: there is no M100000"),
        ("S-1", "1:1: the spindle speed -1 is negative"),
    ],
)
def test_functions_that_are_refused(block: str, text: str) -> None:
    assert refusal(f"{block}\n") == text


def test_a_dialect_may_refuse_m_codes_it_does_not_list() -> None:
    strict = load_dialect("din").model_copy(update={"other_m": "error"})
    assert refusal("M77\n", dialect=strict) == "1:1: M77 is not known in dialect 'din'"


def test_ignored_codes_are_said_once_and_may_share_a_block() -> None:
    bosch = load_dialect("bosch")
    two = Dialect.model_validate(bosch.model_dump() | {"g": {**bosch.g, "900": "ignored"}})
    assert notes("G63 G900\nG63\n", dialect=two) == [
        "G63 has no effect here and is ignored",
        "G900 has no effect here and is ignored",
    ]


# --- skip marks

SKIPS = "G0 X1\n/X2\n/2 X3\nN5 /3 X4\n/ #1=nonsense\n"


@pytest.mark.parametrize(
    ("levels", "ends"),
    [({1}, ["X1", "X3", "X4"]), ({1, 2}, ["X1", "X4"]), ({1, 3}, ["X1", "X3"]), ({1, 2, 3}, ["X1"])],
)
def test_blocks_with_a_skip_mark_are_left_out(levels: set[int], ends: list[str]) -> None:
    skipped = moves(SKIPS, skip_levels=frozenset(levels))
    assert skipped == [f"rapid {end} stop" for end in ends]


def test_else_they_are_blocks_like_others() -> None:
    assert moves("G0 X1\n/X2\n/9 X3\n") == ["rapid X1 stop", "rapid X2 stop", "rapid X3 stop"]
    assert refusal(SKIPS).startswith("5:1: dialect 'din' reads no variables")


def test_every_block_counts() -> None:
    assert accepted("G0 X1\n/X2\n(remark)\n\nM8\n%\n").blocks == 4
