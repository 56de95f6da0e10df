"""What tools of every shape leave, against closed forms and against the tool set at many places along its way."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.stock import Box, Cutting, Rows, Stock, Tool, ToolKind
from polycnc.stock._sweep import _steps
from support.often import share

TOOLS = {
    "flat": Tool(ToolKind.FLAT, 8.0),
    "ball": Tool(ToolKind.BALL, 6.0),
    "bull": Tool(ToolKind.BULL, 7.0, corner_mm=1.5),
    "drill": Tool(ToolKind.DRILL, 6.6, angle_deg=118.0),
    "chamfer": Tool(ToolKind.CHAMFER, 9.0, angle_deg=90.0, tip_mm=1.0),
    "taper": Tool(ToolKind.TAPER, 5.0, angle_deg=7.0, tip_mm=3.0),
}


def rows(places: list[tuple[float, float, float]], *, rapid: bool = False, turns: bool = True) -> Rows:
    """Return rows of a tool 1 at these places, one a block, the first of which has no way."""
    n = len(places)
    return Rows(
        t_s=0.25 + np.arange(n, dtype=np.float64),
        tip=np.array(places, np.float64),
        block=np.arange(n),
        tool=np.ones(n, np.int64),
        rapid=np.full(n, rapid),
        turns=np.full(n, turns),
    )


def block_of(cell_mm: float = 0.1) -> Stock:
    return Stock(Box((-3.0, -2.0, -12.0), (57.0, 38.0, 1.5)), cell_mm)


def cut(stock: Stock, tool: Tool, places: list[tuple[float, float, float]]) -> Cutting:
    cutting = Cutting(stock, {1: tool})
    cutting.add(rows(places))
    return cutting


def test_a_slot_has_the_volume_of_its_plan() -> None:
    stock = block_of()
    before = stock.volume_mm3
    found = cut(stock, TOOLS["flat"], [(11.0, 17.0, -2.5), (43.0, 17.0, -2.5)])
    exact = (32.0 * 8.0 + math.pi * 16.0) * 4.0
    assert found.removed_mm3 == pytest.approx(exact, rel=1e-3)
    assert before - stock.volume_mm3 == pytest.approx(found.removed_mm3, rel=1e-9)
    assert stock.height(27.0, 20.9) == -2.5
    assert stock.height(27.0, 21.1) == 1.5


@pytest.mark.parametrize("name", TOOLS)
def test_a_plunge_leaves_the_shape_of_the_tool(name: str) -> None:
    stock, tool = block_of(0.05), TOOLS[name]
    found = cut(stock, tool, [(21.0, 15.0, 5.0), (21.0, 15.0, -4.0)])
    assert found.removed_mm3 == pytest.approx(tool.cutting_profile().volume_below(5.5), rel=3e-3)


def test_a_drilled_hole_through_the_body_ends_at_its_bottom() -> None:
    stock = block_of(0.05)
    cut(stock, TOOLS["drill"], [(21.0, 15.0, 5.0), (21.0, 15.0, -20.0)])
    point = 3.3 / math.tan(math.radians(59.0))
    assert -20.0 + point < stock.box.low[2]
    hole = stock.box.high[2] - stock.box.low[2]
    removed = 60.0 * 40.0 * 13.5 - stock.volume_mm3
    assert removed == pytest.approx(math.pi * 3.3**2 * hole, rel=2e-3)
    assert stock.height(21.0, 15.0) == stock.box.low[2]


coordinates = st.tuples(st.floats(2.0, 50.0), st.floats(2.0, 34.0), st.floats(-9.0, 1.0))


@settings(max_examples=share(60))
@given(name=st.sampled_from(sorted(TOOLS)), begin=coordinates, end=coordinates)
def test_a_way_leaves_what_the_tool_leaves_at_all_of_its_places(
    name: str, begin: tuple[float, float, float], end: tuple[float, float, float]
) -> None:
    stock, tool = block_of(0.5), TOOLS[name]
    cut(stock, tool, [begin, end])
    share = np.linspace(0.0, 1.0, 3001)[:, None]
    way = np.array(begin) + share * (np.array(end) - np.array(begin))
    radii = np.linspace(0.0, tool.radius_mm, 3001)
    profile = tool.cutting_profile()
    outline = np.array([profile.height(float(r)) for r in radii])
    x, y = stock.grid.x, stock.grid.y
    steep = abs(end[2] - begin[2]) / 3000.0 + 1e-6
    near = np.random.default_rng(5).integers(0, stock.heights.size, 150)
    for iy, ix in zip(*np.unravel_index(near, stock.heights.shape), strict=True):
        away = np.hypot(way[:, 0] - x[ix], way[:, 1] - y[iy])
        under = away <= tool.radius_mm
        if under.any():
            lowest = (way[:, 2] + np.interp(away, radii, outline))[under].min()
            expected = min(1.5, float(lowest))
            got = stock.heights[iy, ix]
            assert got <= expected + 1e-9, (x[ix], y[iy])  # what it leaves is never more
            if np.abs(away - tool.radius_mm).min() > 0.05:
                assert got >= expected - 40.0 * steep - 0.02, (x[ix], y[iy])
        elif away.min() > tool.radius_mm + 0.02:
            assert stock.heights[iy, ix] == 1.5


@given(
    name=st.sampled_from(sorted(TOOLS)),
    places=st.lists(coordinates, min_size=3, max_size=6),
    at=st.integers(1, 4),
)
@settings(max_examples=share(40))
def test_a_record_may_be_cut_anywhere(name: str, places: list[tuple[float, float, float]], at: int) -> None:
    whole, parts = Cutting(block_of(0.5), {1: TOOLS[name]}), Cutting(block_of(0.5), {1: TOOLS[name]})
    piece = rows(places)
    whole.add(piece)
    for part in (slice(None, at), slice(at, None)):
        parts.add(piece.at(np.arange(len(piece.t_s))[part]))
    assert np.array_equal(whole.stock.heights, parts.stock.heights)
    assert whole.removed_mm3 == pytest.approx(parts.removed_mm3, rel=1e-12)


def test_the_surface_is_closed_and_has_the_volume_of_the_body() -> None:
    stock = block_of(0.25)
    cut(stock, TOOLS["ball"], [(11.0, 17.0, 5.0), (11.0, 17.0, -2.5), (43.0, 21.0, -6.5)])
    cut(stock, TOOLS["drill"], [(50.0, 30.0, 5.0), (50.0, 30.0, -20.0)])
    surface = stock.mesh()
    edges = np.sort(surface.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, uses = np.unique(edges, axis=0, return_counts=True)
    assert np.all(uses % 2 == 0)
    assert surface.volume_mm3 == pytest.approx(stock.volume_mm3, rel=2e-3)


def test_steps_count_the_cells_that_lie_within_reach_of_the_ways() -> None:
    """A way of 8 mm with a cutter of 3 mm and no holder, twice; cells outside of the body cost nothing."""
    grid = Stock(Box((0.0, 0.0, -5.0), (40.0, 20.0, 0.0)), 0.1).grid
    rows = Tool(ToolKind.FLAT, 6.0).cutting_profile().rows
    inside = np.array([[10.0, 9.0, -1.0], [18.0, 9.0, -1.0]])
    cells = 14.0 * 6.0 / 0.01
    assert _steps(grid, inside, rows, rows[:0]) == pytest.approx(cells / 5, rel=0.01)
    assert _steps(grid, inside, rows, rows) == pytest.approx(2 * cells / 5, rel=0.01)
    assert _steps(grid, inside + (100.0, 0.0, 0.0), rows, rows[:0]) == 2
    assert _steps(grid, inside + (23.0, 0.0, 0.0), rows, rows[:0]) == pytest.approx(10 * 6 / 0.05, rel=0.01)
