"""What goes wrong while a tool cuts is found at its block, and only there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.errors import UsageError
from polycnc.stock import Arc, Box, ContactKind, Cutting, Line, Rows, Stock, Tool, ToolKind, make_profile
from support.often import share

PLACES = [(-19.0, 11.0, 4.0), (-19.0, 11.0, -3.0), (47.0, 11.0, -3.0), (47.0, 11.0, 4.0), (-19.0, 25.0, 4.0)]
RAPID = np.array([True, True, False, False, True])


def record(places: list[tuple[float, float, float]] = PLACES, tool: int = 7) -> Rows:
    n = len(places)
    return Rows(
        0.5 * np.arange(1.0, n + 1.0),
        np.array(places),
        np.arange(10, 10 + n),
        np.full(n, tool),
        RAPID[:n].copy(),
        np.ones(n, np.bool_),
    )


def cutting(tool: Tool) -> Cutting:
    return Cutting(Stock(Box((0.0, 0.0, -20.0), (30.0, 40.0, 0.0)), 0.25), {7: tool})


END_MILL = Tool(ToolKind.FLAT, 6.0, flute_mm=12.0, holder=((21.0, 14.0),))


def test_a_right_program_has_no_collision() -> None:
    found = cutting(END_MILL)
    found.add(record())
    assert found.removed_mm3 == pytest.approx(30.0 * 6.0 * 3.0, rel=0.03)
    assert found.contacts == []
    assert found.by_tool_mm3 == {7: found.removed_mm3}
    assert found.by_block_mm3[12] == found.removed_mm3


def test_a_rapid_through_stock_is_found_at_its_block() -> None:
    found = cutting(END_MILL)
    found.add(replace(record(), rapid=np.array([True, True, True, False, True])))
    [collision] = found.contacts
    assert (collision.kind, collision.block) == (ContactKind.RAPID, 12)
    assert collision.depth_mm == 3.0
    assert collision.t_s == 1.5
    assert collision.place[2] == -3.0


def test_a_spindle_at_rest_is_found() -> None:
    found = cutting(END_MILL)
    found.add(replace(record(), turns=np.array([True, True, False, True, True])))
    assert [(each.kind, each.block) for each in found.contacts] == [(ContactKind.SPINDLE, 12)]


def test_short_flutes_and_a_low_holder_are_found() -> None:
    deep = [(x, y, -15.0 if z < 0.0 else z) for x, y, z in PLACES]
    found = cutting(END_MILL)
    found.add(record(deep))
    assert [(each.kind, each.depth_mm) for each in found.contacts] == [(ContactKind.FLUTES, 15.0)]
    low = cutting(replace(END_MILL, flute_mm=30.0, holder=((13.5, 14.0),)))
    low.add(record(deep))
    assert [(each.kind, each.block, each.depth_mm) for each in low.contacts] == [
        (ContactKind.HOLDER, 12, 1.5)
    ]


DRILL = Tool(ToolKind.DRILL, 6.0, angle_deg=118.0, flute_mm=12.0)
LEVELS = (-5.0, -10.0, -11.9, -15.0)


@pytest.mark.parametrize(
    ("tool", "found_in"),
    [
        (DRILL, [(ContactKind.FLUTES, 42, 15.0)]),
        (replace(DRILL, shank=((12.0, 2.5),)), [(ContactKind.FLUTES, 42, 15.0)]),
        (replace(DRILL, flute_mm=15.1), []),
        (replace(END_MILL, holder=()), [(ContactKind.FLUTES, 42, 15.0)]),
        (replace(END_MILL, holder=(), shank=((12.0, 2.5),)), []),  # a neck
    ],
)
@pytest.mark.parametrize("across", [0.0, 8.0])
def test_a_hole_deeper_than_the_flutes_is_found_peck_by_peck(
    tool: Tool, found_in: list[tuple[ContactKind, int, float]], across: float
) -> None:
    """So are levels of a slot, each of them shallower than the flutes are long."""
    places, blocks = [(9.1, 17.2, 4.0)], [10]
    for number, z in enumerate(LEVELS):
        places += [(9.1, 17.2, z), (9.1 + across, 17.2, z), (9.1 + across, 17.2, 4.0), (9.1, 17.2, 4.0)]
        blocks += [12 + 10 * number] * 4
    n = len(places)
    rapid = np.array([True] + [False, False, True, True] * len(LEVELS))
    found = cutting(tool)
    found.add(
        Rows(np.arange(1.0, n + 1.0), np.array(places), np.array(blocks), np.full(n, 7), rapid, np.ones(n))
    )
    assert [(each.kind, each.block, each.depth_mm) for each in found.contacts] == found_in


@given(
    x=st.integers(-20, 100),
    y=st.integers(0, 140),
    radius=st.integers(2, 20),
    along=st.integers(-60, 60),
    cell=st.sampled_from([0.25, 0.2, 0.1]),
)
@settings(max_examples=share(40))
def test_a_tool_leaves_what_it_has_cut_without_touching(
    x: int, y: int, radius: int, along: int, cell: float
) -> None:
    """Whatever cells its rim falls on: up at rapid, and back at rapid along the slot that it came by."""
    begin, end = (x * 0.25, y * 0.25), ((x + along) * 0.25, y * 0.25 + 0.05 * along)
    places = [(*begin, 4.0), (*begin, -3.0), (*end, -3.0), (*begin, -3.0), (*end, -3.0), (*end, 4.0)]
    rows = Rows(
        np.arange(1.0, 7.0),
        np.array(places),
        np.arange(6),
        np.full(6, 7),
        np.array([True, False, False, True, True, True]),
        np.ones(6, np.bool_),
    )
    found = Cutting(
        Stock(Box((0.0, 0.0, -20.0), (30.0, 40.0, 0.0)), cell), {7: Tool(ToolKind.FLAT, 0.5 * radius)}
    )
    found.add(rows)
    assert found.contacts == []


def test_the_holder_follows_the_cutter() -> None:
    """A holder in the slot that its own cutter has just made touches nothing."""
    found = cutting(replace(END_MILL, flute_mm=30.0, holder=((13.5, 2.9),)))
    found.add(record([(x, y, -15.0 if z < 0.0 else z) for x, y, z in PLACES]))
    assert found.contacts == []


def test_an_unknown_tool_cuts_nothing_and_is_named() -> None:
    found = cutting(END_MILL)
    found.add(record(tool=8))
    assert found.removed_mm3 == 0.0
    assert found.unknown_tools == {8}


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        (lambda: Tool(ToolKind.FLAT, 0.0), "0 mm"),
        (lambda: Tool(ToolKind.FLAT, float("nan")), "nan"),
        (lambda: Tool(ToolKind.FLAT, 1e9), "1e\\+09"),
        (lambda: Tool(ToolKind.BULL, 6.0, corner_mm=3.1), "3.1"),
        (lambda: Tool(ToolKind.DRILL, 6.0), "angle of 0"),
        (lambda: Tool(ToolKind.CHAMFER, 6.0, angle_deg=90.0, tip_mm=6.0), "tip of 6"),
        (lambda: Tool(ToolKind.FLAT, 6.0, flute_mm=0.0), "without flutes"),
        (lambda: Tool(ToolKind.FLAT, 6.0, holder=((30.0, 9.0), (20.0, 12.0))), "do not rise"),
        (lambda: Stock(Box((0.0, 0.0, 0.0), (10.0, 0.0, 5.0)), 0.1), "no volume"),
        (lambda: Stock(Box((0.0, 0.0, 0.0), (10.0, float("inf"), 5.0)), 0.1), "corner at inf"),
        (lambda: Box((-1e308, 0.0, 0.0), (1e308, 1.0, 1.0)), "corner at -1e\\+308"),
        (lambda: Box((0.0, 0.0, float("nan")), (1.0, 1.0, 1.0)), "corner at"),
        (lambda: Stock(Box((0.0, 0.0, 0.0), (10.0, 10.0, 5.0)), 1e308), "resolution of 1e\\+308"),
        (lambda: Stock(Box((0.0, 0.0, 0.0), (10.0, 10.0, 5.0)), 1e-308), "resolution of 1e-308"),
        (lambda: Stock(Box((0.0, 0.0, 0.0), (10.0, 10.0, 5.0)), 0.0), "resolution of 0 mm"),
        (lambda: Stock(Box((0.0, 0.0, 0.0), (1000.0, 800.0, 5.0)), 0.01), "8,000,000,000 cells"),
    ],
)
def test_what_no_tool_and_no_body_has_is_refused(wrong: object, text: str) -> None:
    with pytest.raises(UsageError, match=text) as refused:
        wrong()  # type: ignore[operator]
    assert refused.value.hint


def test_outlines_that_fall_are_refused() -> None:
    for pieces in (
        (Line(0.0, 2.0, 1.0, 0.0),),
        (Line(0.0, 2.0, 0.0, 1.0), Line(2.5, 3.0, 1.0, 1.0)),
        (Arc(0.0, 2.0, 1.0, 1.0, 1.0),),
    ):
        with pytest.raises(ValueError, match=r"outline|profile|pieces|arc"):
            make_profile(pieces)
