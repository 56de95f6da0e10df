"""Tools by their outline: form mills on a field of heights, and tools that undercut in a grid of points."""

from __future__ import annotations

import math

import numpy as np
import pytest

import polycnc
from polycnc.errors import UsageError
from polycnc.machine import ToolConfig, load_machine
from polycnc.stock import Box as StockBox
from polycnc.stock import ContactKind, Cutting, Rows, Stock, Tool, ToolKind, Voxels

SLOT_MM, LENGTH_MM = 8.0, 40.0
UNDER = {  # outline, and the area that it cuts beside the slot of its neck, which the mill before has cut
    "T-slot": (((0, 0), (8, 0), (8, 4), (3, 4)), 4.0 * (16.0 - SLOT_MM)),
    "dovetail": (((0, 0), (7, 0), (3, 6)), 2.0 * 0.5 * 3.0 * 4.5),
    "V, thread": (((0, 0), (4, 0), (7.1, 3.05), (4, 6.1)), 2.0 * 0.5 * 3.1 * 6.1),
    "lollipop": (
        tuple((6.0 * math.cos(a), 6.0 + 6.0 * math.sin(a)) for a in np.linspace(-math.pi / 2, 1.0, 60)),
        2.0 * 36.0 * (math.acos(4.0 / 6.0) - 4.0 / 6.0 * math.sqrt(1.0 - (4.0 / 6.0) ** 2)),
    ),
}
PROGRAM = """(T1 D=8 flat end mill)
G21 G90
T1 M6
S900 M3
G0 X-20 Y0 Z10
Z-14
G1 X60 F900
G0 Z10
T2 M6
G0 X-20
G1 Z-14 F2000
X60 F900
G0 Z10
M30
"""
STOCK = "box=0,-15,-20,40,15,0"


def _outline(name: str) -> tuple[tuple[float, float], ...]:
    others = UNDER[name][0][1:]
    return ((0.0, 0.0), *((round(r, 9), round(z, 9)) for r, z in others))


@pytest.mark.parametrize("name", UNDER)
def test_what_lies_under_something_else_is_cut(name: str) -> None:
    outline = _outline(name)
    config = load_machine("mill3")
    config = config.model_copy(update={"tools": {2: ToolConfig(shape="form", outline=outline)}})
    machined = polycnc.run(PROGRAM, config, "fanuc", stock=STOCK, resolution_mm=0.25, check=False).machined
    assert machined is not None
    assert isinstance(machined.stock, Voxels)
    beside = machined.by_tool_mm3[2] / LENGTH_MM
    assert beside == pytest.approx(UNDER[name][1], rel=0.003)
    assert machined.stock.holds(20.0, 5.0, -3.0)  # above it there is material still
    assert machined.collisions == []


def test_a_neck_in_the_material_is_a_collision() -> None:
    """Without the slot before it: the neck has no way; and across it at rapid."""
    config = load_machine("mill3")
    config = config.model_copy(update={"tools": {2: ToolConfig(shape="form", outline=_outline("T-slot"))}})
    text = PROGRAM.replace("G1 X60 F900\nG0 Z10\nT2", "G0 Z10\nT2")
    found = polycnc.run(text, config, "fanuc", stock=STOCK, resolution_mm=0.5, check=False)
    assert [(each.kind, each.line) for each in found.collisions] == [(ContactKind.SHANK, 11)]
    across = PROGRAM.replace("G1 Z-14 F2000\nX60 F900", "Z-14\nX60 M3")
    found = polycnc.run(across, config, "fanuc", stock=STOCK, resolution_mm=0.5, check=False)
    assert {each.kind for each in found.collisions} == {ContactKind.RAPID}


def test_a_form_that_only_rises_cuts_a_field() -> None:
    """A stepped form mill along a line: the area of its profile below the surface, and its body at the ends."""
    tool = Tool(ToolKind.FORM, 12.0, outline=((0.0, 0.0), (2.0, 0.0), (4.0, 1.5), (4.0, 2.5), (6.0, 3.0)))
    stock = Stock(StockBox((-10.0, -10.0, -9.0), (40.0, 10.0, 0.0)), 0.1)
    cutting = Cutting(stock, {1: tool})
    tip = np.array([[0.0, 0.0, 5.0], [0.0, 0.0, -4.0], [30.0, 0.0, -4.0]])
    ones = np.ones(3, np.int64)
    cutting.add(Rows(np.arange(3.0), tip, np.arange(3), ones, np.zeros(3, bool), np.ones(3)))
    area = 2.0 * (2.0 * 4.0 + 2.0 * (4.0 + 2.5) / 2.0 + 2.0 * (1.5 + 1.0) / 2.0)
    assert cutting.removed_mm3 == pytest.approx(
        30.0 * area + tool.cutting_profile().volume_below(4.0), rel=2e-3
    )
    assert not tool.undercuts


@pytest.mark.parametrize(
    ("outline", "diameter", "wrong"),
    [
        ((), 10.0, "an outline of 0 points"),
        (((0.0, 0.0), (5.0, 0.0), (5.0, -2.0)), 10.0, "no tool's"),
        (((1.0, 0.0), (5.0, 0.0)), 10.0, "no tool's"),
        (((0.0, 0.0), (5.0, 1.0), (3.0, 2.0), (4.0, 3.0)), 10.0, "no tool's"),
        (((0.0, 0.0), (5.0, math.nan)), 10.0, "no tool's"),
        (((0.0, 0.0), (5.0, 1.0)), 12.0, "an outline of 10 mm"),
        (((0.0, 0.0), (5.0, 1.0), (0.0, 2.0)), 10.0, "without a neck"),
    ],
)
def test_outlines_that_no_tool_has(
    outline: tuple[tuple[float, float], ...], diameter: float, wrong: str
) -> None:
    with pytest.raises(UsageError, match=wrong):
        Tool(ToolKind.FORM, diameter, outline=outline)
