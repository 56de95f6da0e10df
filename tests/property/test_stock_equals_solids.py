"""What random programs leave of a block, against exact bodies: a convex tool on a straight way sweeps their hull."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from polycnc import runner
from polycnc.stock import Box, Cutting, Form, Rows, Stock, Tool, ToolKind, tool_of_remark

manifold3d = pytest.importorskip("manifold3d")

LOW, HIGH = (-3.0, -2.0, -12.0), (47.0, 33.0, 1.5)
CELL_MM = 0.05
"""What is chosen for this block where no resolution is given."""
FACETS = 180


def solid(tool: Tool) -> Any:
    """Return a tool as a convex body from its tip up to 40 mm."""
    profile = tool.cutting_profile()
    if tool.kind in (ToolKind.BALL, ToolKind.BULL):  # more rings where the outline is steep
        radii = tool.radius_mm * np.sin(np.linspace(0.0, 0.5 * math.pi, 48))
    else:
        radii = np.array([0.0, 0.5 * tool.tip_mm, tool.radius_mm])
    # As much area as the circle has.
    wider = math.sqrt(2.0 * math.pi / FACETS / math.sin(2.0 * math.pi / FACETS))
    angle = np.linspace(0.0, 2.0 * math.pi, FACETS, endpoint=False)
    rings = [(r * wider, profile.height(float(min(r, tool.radius_mm)))) for r in radii]
    rings.append((tool.radius_mm * wider, 40.0))
    points = [np.column_stack((r * np.cos(angle), r * np.sin(angle), np.full(FACETS, z))) for r, z in rings]
    return manifold3d.Manifold.hull_points(np.concatenate(points))


def exact_mm3(tool: Tool, places: list[np.ndarray[Any, np.dtype[np.float64]]]) -> float:
    """Return the volume that a tool removes of the block on its way."""
    body = solid(tool)
    block = manifold3d.Manifold.cube([b - a for a, b in zip(LOW, HIGH, strict=True)]).translate(LOW)
    left = block
    for begin, end in pairwise(places):
        both = [body.translate(begin.tolist()), body.translate(end.tolist())]
        left = left - manifold3d.Manifold.batch_hull(both)
    return float(block.volume() - left.volume())


def random_tool(rng: np.random.Generator) -> Tool:
    diameter = float(rng.uniform(4.0, 12.0))
    tip = diameter * float(rng.uniform(0.05, 0.5))
    return [
        Tool(ToolKind.FLAT, diameter),
        Tool(ToolKind.BALL, diameter),
        Tool(ToolKind.BULL, diameter, corner_mm=diameter * float(rng.uniform(0.1, 0.4))),
        Tool(ToolKind.DRILL, diameter, angle_deg=float(rng.uniform(90.0, 140.0))),
        Tool(ToolKind.CHAMFER, diameter, angle_deg=float(rng.uniform(40.0, 140.0)), tip_mm=tip),
        Tool(ToolKind.TAPER, diameter, angle_deg=float(rng.uniform(10.0, 40.0)), tip_mm=tip),
    ][int(rng.integers(6))]


def compare(number: int) -> float:
    """Return by how much two volumes of a random program differ, as a part of what is removed."""
    rng = np.random.default_rng(number)
    tool = random_tool(rng)
    places = [rng.uniform((0.0, 0.0, -9.0), (44.0, 30.0, 0.5)) for _ in range(int(rng.integers(2, 6)))]
    if rng.random() < 0.5:  # level ways, as in most programs
        for place in places:
            place[2] = places[0][2]
    stock = Stock(Box(LOW, HIGH), CELL_MM)
    cutting = Cutting(stock, {4: tool})
    n = len(places)
    cutting.add(
        Rows(
            np.arange(1.0, n + 1.0),
            np.array(places),
            np.arange(n),
            np.full(n, 4),
            np.zeros(n, np.bool_),
            np.ones(n, np.bool_),
        )
    )
    exact = exact_mm3(tool, places)
    return abs(cutting.removed_mm3 - exact) / max(exact, 50.0)


@pytest.mark.parametrize("number", range(12))
def test_volumes_of_random_programs(number: int) -> None:
    assert compare(number) < 1e-3


def test_these_cells_are_chosen_where_no_resolution_is_given() -> None:
    nothing = np.zeros(0, np.int64)
    course = Rows(np.zeros(0), np.zeros((0, 3)), nothing, nothing, np.zeros(0, np.bool_), np.zeros(0))
    box = ",".join(f"{each:g}" for each in (*LOW, *HIGH))
    assert Form(f"box={box}").body(course, {}).cell_mm == CELL_MM


@pytest.mark.parametrize("angle_deg", [30.0, 60.0, 90.0])
def test_a_groove_along_the_grid_is_right_within_the_bound_of_its_cells(angle_deg: float) -> None:
    """A cell is half as wide as the groove n times: the volume is off by at most 1 / (2 n) squared."""
    slope, length, cell = math.tan(math.radians(0.5 * angle_deg)), 20.0, 0.1
    for number in range(12):
        rng = np.random.default_rng(number)
        deep, y = float(rng.uniform(0.4, 2.0)), float(rng.uniform(4.0, 4.3))
        stock = Stock(Box((0.0, 0.0, -4.0), (length, 8.0, 0.0)), cell)
        cutting = Cutting(stock, {4: Tool(ToolKind.CHAMFER, 9.0, angle_deg=angle_deg)})
        places = np.array([(-9.0, y, -deep), (length + 9.0, y, -deep)])
        two = np.arange(2, dtype=np.int64)
        cutting.add(Rows(np.array([1.0, 2.0]), places, two, np.full(2, 4), np.zeros(2, np.bool_), np.ones(2)))
        half_width = deep * slope
        off = cutting.removed_mm3 / (deep * half_width * length) - 1.0
        assert abs(off) <= (0.5 * cell / half_width) ** 2 + 1e-4


# A plane, the block that cuts in it from X20 Y15 Z-3, and where that leads after a share of its way.
ARCS: dict[str, Callable[[float], tuple[float, float, float]]] = {
    "G17 G3 X20 Y15 Z-6.3 I7 J0": lambda u: (
        27.0 - 7.0 * math.cos(2.0 * math.pi * u),
        15.0 - 7.0 * math.sin(2.0 * math.pi * u),
        -3.0 - 3.3 * u,
    ),
    "G18 G3 X32 Z-3 I6 K0": lambda u: (
        26.0 - 6.0 * math.cos(math.pi * u),
        15.0,
        -3.0 + 6.0 * math.sin(math.pi * u),
    ),
    "G18 G2 X32 Z-3 I6 K0": lambda u: (
        26.0 - 6.0 * math.cos(math.pi * u),
        15.0,
        -3.0 - 6.0 * math.sin(math.pi * u),
    ),
    "G19 G2 Y25 Z-3 J5 K0": lambda u: (
        20.0,
        20.0 - 5.0 * math.cos(math.pi * u),
        -3.0 + 5.0 * math.sin(math.pi * u),
    ),
    "G68 X20 Y15 R33\nG1 X36": lambda u: (
        20.0 + 16.0 * u * math.cos(math.radians(33.0)),
        15.0 + 16.0 * u * math.sin(math.radians(33.0)),
        -3.0,
    ),
}


@pytest.mark.long
@pytest.mark.parametrize("arc", ARCS)
@pytest.mark.parametrize("remark", ["T4 D=7. CR=3.5 - ball end mill", "T4 D=6. CR=0. - flat end mill"])
def test_volumes_of_arcs_helices_and_rotated_cuts(arc: str, remark: str) -> None:
    text = f"({remark})\nG0 X20 Y15 Z9\nT4 M6\nS900 M3\nG1 Z-3 F300\n{arc}\nM30\n"
    box = ",".join(f"{each:g}" for each in (*LOW, *HIGH))
    result = runner.run(text, None, "fanuc", stock=f"box={box}", resolution_mm=CELL_MM)
    tool = tool_of_remark(remark)
    assert tool is not None
    places = [np.array((20.0, 15.0, 9.0)), *(np.array(ARCS[arc](u)) for u in np.linspace(0.0, 1.0, 61))]
    assert result.removed_mm3 == pytest.approx(exact_mm3(tool, places), rel=3e-3)


@pytest.mark.long
def test_volumes_of_two_hundred_random_programs() -> None:
    worst = [compare(number) for number in range(100, 300)]
    assert max(worst) < 1e-3
    assert sum(worst) / len(worst) < 2e-4
