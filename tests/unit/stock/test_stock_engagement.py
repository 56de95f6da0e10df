"""How hard tools cut: removal, depth, width and chips of single cuts against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

import polycnc
from polycnc.runner.view._load import STRETCHES, loads
from polycnc.stock import Insert, InsertKind, Rows, Tool, grooving_tool, threading_tool, tool_of_remark
from polycnc.stock._engagement import EngagementLog
from polycnc.stock._sweep import DEPTH_MM, FIGURES, VOLUME_MM3
from polycnc.stock._ways import WaysOfRows

MILLED = """(T1 D=10. CR=0. - 3 flute flat end mill)
(T4 drill 8 mm)
G21 G90 G17 G94 G54
T1 M6
S6000 M3
G0 X-8 Y12 Z20
Z-4
G1 X70 F1500
G0 Y21
G1 X-8 F1500
G0 Y28.5
G1 X70 S8000 F2400
G0 Z20
T4 M6
G0 X30 Y36
Z2
G1 Z-11.5 F180
G0 Z20
M30
"""
STOCK = "box=0,0,-12,62,41,0"
LINES = {  # line: rate (mm3/s), depth, width, chip (mm); widths above half the diameter have the chip of a full one
    8: (25.0 * 40.0, 4.0, 10.0, 1500.0 / 6000.0 / 3.0),
    10: (25.0 * 36.0, 4.0, 9.0, 1500.0 / 6000.0 / 3.0),
    12: (40.0 * 30.0, 4.0, 7.5, 2400.0 / 8000.0 / 3.0),
    17: (3.0 * math.pi * 16.0, None, 8.0, None),
}


@pytest.fixture(scope="module")
def milled() -> polycnc.RunResult:
    return polycnc.run(MILLED, "mill3", "fanuc", stock=STOCK, resolution_mm=0.1)


def test_each_line_has_its_greatest_figures(milled: polycnc.RunResult) -> None:
    assert milled.machined is not None
    found = milled.machined.as_dict()["engagement"]
    assert [each["line"] for each in found["by_line"]] == list(LINES)
    for each, (rate, depth, width, chip) in zip(found["by_line"], LINES.values(), strict=True):
        assert each["rate_mm3_s"] == pytest.approx(rate, rel=0.01)
        assert each["axial_mm"] == (None if depth is None else pytest.approx(depth, rel=1e-3))
        assert each["radial_mm"] == pytest.approx(width, rel=1e-3)
        assert each["chip_mm"] == (None if chip is None else pytest.approx(chip, rel=1e-3))
        assert 0.0 < each["mean_mm3_s"] < each["rate_mm3_s"]
    assert found["rate_mm3_s"] == pytest.approx(1200.0, rel=0.01)
    assert found["axial_mm"] == pytest.approx(4.0, rel=1e-3)
    removed = sum(each["mean_mm3_s"] * each["cutting_s"] for each in found["by_line"])
    assert removed == pytest.approx(milled.removed_mm3, rel=1e-9)


def test_chips_are_thinner_where_a_cut_is_narrow(milled: polycnc.RunResult) -> None:
    """A cut of a twelfth of the diameter: the tooth leaves it at an angle whose sine is 2 sqrt(1/12 * 11/12)."""
    program = MILLED.replace("Y21", "Y12.833333").replace("G1 X-8", "G1 X-8")
    found = polycnc.run(program, "mill3", "fanuc", stock=STOCK, resolution_mm=0.05)
    assert found.machined is not None
    line = next(each for each in found.machined.as_dict()["engagement"]["by_line"] if each["line"] == 10)
    assert line["radial_mm"] == pytest.approx(10.0 / 12.0, rel=0.07)  # of whole cells
    share = line["radial_mm"] / 10.0
    angle = math.acos(1.0 - 2.0 * share)
    assert line["chip_mm"] == pytest.approx(1500.0 / 6000.0 / 3.0 * math.sin(angle), rel=1e-3)


def test_a_page_has_the_same_volume_over_time(milled: polycnc.RunResult) -> None:
    assert milled.machined is not None
    columns, stretch_s = loads(milled.machined.engagement, milled.time_s)
    assert stretch_s == pytest.approx(milled.time_s / STRETCHES)
    assert columns["rate"].sum() * stretch_s == pytest.approx(milled.removed_mm3, rel=1e-4)
    assert set(columns) == {"rate", "axial", "radial", "chip"}
    assert columns["axial"].max() == pytest.approx(4.0, rel=1e-3)
    cutting_s = milled.machined.engagement.duration_s.sum()
    assert np.count_nonzero(columns["radial"]) * stretch_s == pytest.approx(cutting_s, rel=0.03)


@pytest.mark.parametrize("speed", ["G97 S800", f"G96 S{math.pi * 26.0 * 0.8:.3f}", "G50 S800\nG96 S900"])
def test_a_turning_tool_has_a_depth_and_no_width(speed: str) -> None:
    """It turns 800 times a minute, also where its surface speed says so, or its clamp."""
    text = f"(T1 CNMG120408 roughing)\nG21 G18 G98\nT0101\n{speed} M4\nG0 X26 Z2\nG1 Z-20 F150\nG0 X60\nM30\n"
    found = polycnc.run(text, "lathe2", "fanuc-lathe", stock="cylinder=30,-40,0")
    assert found.machined is not None
    rate, depth, width, chip = found.machined.engagement.most
    assert rate == pytest.approx(150.0 / 60.0 * math.pi * (15.0**2 - 13.0**2), rel=0.02)
    assert depth == pytest.approx(2.0, rel=1e-3)
    assert width == 0.0
    assert chip == pytest.approx(150.0 / 800.0, rel=0.003)


@pytest.mark.parametrize(
    ("remark", "teeth"),
    [
        ("T1 D=10 CR=0 - 3 flute flat end mill", 3),
        ("T2 12 mm end mill, 4FL", 4),
        ("T3 6 mm 2-flute ball", 2),
        ("T4 1/4 inch end mill, 12 teeth", 12),
        ("T5 D=10 flat end mill, 30 flute length", 0),
        ("T6 10 mm end mill", 0),
    ],
)
def test_remarks_say_how_many_teeth(remark: str, teeth: int) -> None:
    tool = tool_of_remark(remark)
    assert isinstance(tool, Tool)
    assert tool.teeth == teeth


@pytest.mark.parametrize(
    ("insert", "step", "chip"),
    [
        (Insert(InsertKind.TURNING, 0.0, 45.0, 30.0, 16.0), (0.0, -6.0), 0.25 * math.sin(math.radians(45.0))),
        (Insert(InsertKind.TURNING, 0.0, 45.0, 30.0, 16.0), (0.0, 6.0), 0.25 * math.sin(math.radians(30.0))),
        (Insert(InsertKind.TURNING, 0.8, 90.0, 5.0, 16.0), (0.0, -6.0), 0.25),
        (
            Insert(InsertKind.TURNING, 4.0, 90.0, 5.0, 16.0),
            (0.0, -6.0),
            0.25 * math.sqrt(1.0 - (1.0 - 1.1 / 4.0) ** 2),
        ),
        (grooving_tool(3.0), (-6.0, 0.0), 0.25),
        (threading_tool(), (0.0, -6.0), math.nan),
    ],
)
def test_chips_of_turning_tools(insert: Insert, step: tuple[float, float], chip: float) -> None:
    """0.25 mm a turn at 480 turns a minute, 1.1 mm deep."""
    places = np.array([(20.0, 0.0, 0.0), (20.0 + step[0], 0.0, step[1])])
    two = np.arange(2)
    rows = Rows(np.array([0.0, 3.0]), places, two, np.full(2, 4), np.zeros(2, np.bool_), np.full(2, -480.0))
    ways = next(WaysOfRows(0.01, {4: 100.0}).of(rows))
    figures = np.zeros((1, FIGURES))
    figures[0, VOLUME_MM3], figures[0, DEPTH_MM] = 50.0, 1.1
    log = EngagementLog()
    log.add(ways, figures, insert)
    assert log.all().chip_mm.tolist() == [pytest.approx(chip, nan_ok=True)]
