"""Where ranges of a living control begin and end: overrides above 100 %, axis 8 of 9, spindle 8, channel 2, inches."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from polycnc.controllers.bosch._axes import SystemAxes
from polycnc.nc.cpl import OMITTED, Fault
from support.living_pnc import AXIS, Living
from support.told import stopped, told

NINE = ("X", "Y", "Z", "B", "U", "V", "W", "A", "C")
FAST = '[[axis]]\nname = "B"\nkind = "rotary"\nvmax_deg_s = 900\namax_deg_s2 = 9000\n'
WIDE = (
    'name = "wide"\n' + "".join(FAST if each == "B" else AXIS.format(each, 500) for each in NINE)
    + AXIS.format("X2", 300) + "[spindle]\nmax_rpm = 4000\n"
)  # fmt: skip


@pytest.fixture(scope="module")
def wide(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Living]:
    """Return a control with nine axes in channel 1, of which B turns faster than the others go, and X2 in channel 2."""
    made = Living(tmp_path_factory.mktemp("wide"), WIDE, [NINE, ("X2",)])
    yield made
    made.pnc.close()


def rows(*names: str) -> list[str]:
    return [f"cpl.{name}" for name in names]


@pytest.mark.covers(
    *rows("SD", "SDR", "SD.2.1", "SDR.2.1", "SD.2.3", "SDR.2.3", "SD.202.s", "SDR.202.s", "SD.5.1.1", "SD.5.3.1"),
    *rows("SD.205.1.s", "SD.205.2.s", "SD.205.3.s", "SD.5.1.2", "SD.5.3.2", "MCODS.7", "MCODS.8", "MCODS.50"),
)  # fmt: skip
def test_overrides_above_100_percent_are_told_and_count(wide: Living) -> None:
    wide.pnc.control.set_overrides(feed=1.25, spindle=1.5)
    asked = {
        "SD(2,1)": 125, "SDR(2,1)": 125, "SD(2,3)": 150, "SDR(2,3)": 150, "SD(202,1)": 150, "SDR(202,1)": 150,
        "SD(5,1,1)": 501, "SD(5,1,2)": 400, "SD(5,3,1)": 1800, "SD(205,1,1)": 1800, "SD(5,3,2)": 1200,
        "SD(205,2,1)": 1200, "SD(205,3,1)": 1800,
    }  # fmt: skip
    found = told(wide, "N1 M3 S1200\nN2 G1 X1 F400.1\n3 WAIT", *asked)
    shown = [wide.glance(7), wide.glance(8, -1), wide.glance(50, 1, 9), wide.glance(50, -1, 10)]
    wide.pnc.control.set_overrides(feed=1.0, spindle=1.0)
    assert dict(zip(asked, found, strict=True)) == asked
    assert shown == [[12500.0], [15000.0], [12500.0] * 9, [12500.0] * 10]


@pytest.mark.covers(
    *rows("SD", "SDR", "SD.202.s", "SDR.202.s", "SD.205.1.s", "SD.205.2.s", "SD.205.3.s", "SD.212.1.s", "SD.212.2.s"),
    *rows("SD.9", "SD.5.2.1", "SD.20.1", "SD.20.2", "SD.21.n.1", "SD.21.n.2", "SD.22.m.1", "SD.22.m.2", "SD.23.m.1"),
    *rows("SD.23.m.2", "SD.24.m.n.1", "SD.24.m.n.2", "SD.25.m", "SD.11.1.1", "SD.11.2.1", "SD.11.1.2", "SD.11.2.2"),
    *rows("SD.68.1.n", "SD.68.2.n", "SD.168.1.n", "SD.168.2.n", "SD.268.1.n", "SD.268.2.n", "SDR.68.1.n", "SDR.68.2.n"),
    *rows("SDR.168.1.n", "SDR.168.2.n", "SDR.268.1.n", "SDR.268.2.n", "SDR.1.n", "SD.2.4", "changed.SD_22"),
)  # fmt: skip
def test_indices_go_to_the_last_of_their_range(wide: Living) -> None:
    """The spindles are 8, the axes and channels 64; a shift is told of axis 8, in inches where they are programmed."""
    asked = {
        "SD(202,8)": 0, "SDR(202,8)": 0, "SD(205,1,8)": 0, "SD(205,2,8)": 0, "SD(205,3,8)": 0, "SD(212,1,8)": -1,
        "SD(212,2,8)": -1, "SD(9)": 0, "SD(5,2,1)": 1181, "SD(20)": 9, "SD(20,1)": 9, "SD(20,2)": 9, "SD(21,1)": 9,
        "SD(21,2)": 1, "SD(21,2,2)": 1, "SD(21,64)": 0, "SD(21,64,2)": 0, "SD(22,9)": 9, "SD(22,10)": 0,
        "SD(22,64)": 0, 'SD(22,"X2",2)': 0, "SD(23,9)": 9, "SD(23,10)": 0, "SD(23,64,2)": 0, "SD(24,1,2)": 10,
        "SD(24,1,2,2)": 10, "SD(24,2,2)": 0, "SD(24,2,2,2)": 0, "SD(24,64,64)": 0, "SD(25,10)": 2, "SD(25,64)": -1,
        "SD(11,1,1)": 2, "SD(11,2,1)": 3, "SD(11,1,2)": 2, "SD(11,2,2)": 3, "SDR(168,1,8)": 1.5, "SDR(168,2,8)": 1.5,
        "SDR(268,1,8)": 0.25, "SDR(268,2,8)": 0.25, "SDR(68,1,8)": 1.75, "SDR(68,2,8)": 1.75, "SD(168,1,8)": 2,
        "SD(168,2,8)": 2, "SD(268,1,8)": 0, "SD(268,2,8)": 0, "SD(68,1,8)": 2, "SD(68,2,8)": 2, "SDR(168,1,4)": 30,
        "SDR(168,2,4)": 30, "SDR(1,8)": 0,
    }  # fmt: skip
    before = "N1 G70\nN2 G168 A1.5 B30\nN3 G268 A0.25\nN4 G19\nN5 G1 X0 F40\n6 WAIT"
    assert dict(zip(asked, told(wide, before, *asked), strict=True)) == pytest.approx(asked)
    for data in (
        "SD(202,0)", "SD(202,9)", "SDR(202,9)", "SD(205,1,0)", "SD(205,3,9)", "SD(212,1,9)", "SD(212,2,0)",
        "SD(21,0)", "SD(21,65)", "SD(22,0)", "SD(22,65)", "SD(23,65)", "SD(24,1,65)", 'SD(24,"X",2)', 'SD(24,"X",2,2)',
        "SD(25,65)", "SD(168,1,0)", "SD(268,2,9)", "SDR(68,1,9)", "SDR(1,9)",
    ):  # fmt: skip
        assert stopped(wide, f"A={data}") == "INVALID PARAMETER", data


@pytest.mark.covers(*rows("SD.1.i.1", "SD.1.i.2", "SD.1.i.3", "SD.17", "SD.6", "SD.3.1", "SD.2.2", "SD.13"))
def test_groups_are_2_to_48_and_of_two_moments(wide: Living) -> None:
    assert told(wide, "N1 G1 X0 F40\n2 WAIT", "SD(1,48,1)", "SD(1,48,2)", "SD(1,1,2)") == [-1, -1, 0]
    for data in (
        "SD(1,49,1)",
        "SD(1,49,2)",
        "SD(1,0,2)",
        "SD(1,1,1)",
        "SD(1,2,3)",
        "SD(17,32)",
        "SD(6,6)",
        "SD(13,1)",
    ):
        assert stopped(wide, f"A={data}") == "INVALID PARAMETER", data


@pytest.mark.covers(*rows("axis.physical", "axis.logical", "axistype.0", "axistype.1"))
def test_a_name_is_one_of_the_channel_before_it_is_a_physical_one() -> None:
    """In channel 1 axis 2 is called X, as axis 1 is elsewhere."""
    axes = SystemAxes(("X", "Y", "Z"), logical={(1, 2): "X", (1, 1): "Q"})
    assert [axes.axis(1, name) for name in ("X", "Q", "Y", "Z")] == [2, 1, 2, 3]
    assert axes.physical("X") == 1
    assert axes.axis(1, "X", 0) == 2
    assert axes.axis(1, "X", OMITTED, 1) == 2
    with pytest.raises(Fault) as refused:
        axes.axis(1, "Y", OMITTED, 1)
    assert refused.value.code == "1971"


@pytest.mark.covers(
    *rows("err.1938", "err.1970", "err.1971", "axistype.0", "axistype.1", "WPOS", "MPOS", "CPOS", "AXO")
)
@pytest.mark.covers(*rows("axis.physical", "axis.logical", "cs.MCS", "cs.WCS"))
def test_axes_are_counted_from_1_to_the_last_of_their_channel(wide: Living) -> None:
    before = "N1 G1 C3.5 F60000\n2 WAIT\n3 A=1"
    found = told(
        wide,
        before,
        "CPOS(9)",
        "WPOS(9)",
        "MPOS(9,0)",
        "MPOS(10,0)",
        "MPOS(1,1,2)",
        "WPOS(1,1,2)",
        "APOS(10)",
    )
    assert found == [3.5, 3.5, 3.5, 0, 0, 0, 0]
    for call, code in {
        "CPOS(0)": 1938, "CPOS(10)": 1938, "WPOS(0)": 1938, "MPOS(0)": 1938, "MPOS(0,0)": 1938, "MPOS(11,0)": 1938,
        "MPOS(-1)": 1938, "APOS(0)": 1938, "APOS(11)": 1938, "SPOS(0)": 1938, "AXO(0)": 1938, "CPOS(10,0)": 1970,
        'WPOS("X2",1,1)': 1971, 'MPOS("X",1,2)': 1971, "MPOS(2,1,2)": 1938,
    }.items():  # fmt: skip
        assert stopped(wide, f"A={call}") == f"INVALID PARAMETER [{code}]", call
    for call in ("MPOS(1,0,2)", "WPOS(1,2)", "MPOS(1,-1)", "WPOS(1,1,0)", "WPOS(1,1,3)"):
        assert stopped(wide, f"A={call}") == "INVALID PARAMETER", call
