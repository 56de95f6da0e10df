"""Where ranges of a living control begin and end: overrides above 100 %, axis 8 of 9, spindle 8, channel 2, inches."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from polycnc.controllers.bosch._axes import SystemAxes
from polycnc.controllers.bosch.ncs import Mode
from polycnc.nc.cpl import BLOCKED, OMITTED, Fault
from support.living_pnc import AXIS, LAGGING, MACHINE, Living, padded, six
from support.told import carried_out, stopped, told

NINE = ("X", "Y", "Z", "B", "U", "V", "W", "A", "C")
FAST = '[[axis]]\nname = "B"\nkind = "rotary"\nmodulo = true\nvmax_deg_s = 900\namax_deg_s2 = 9000\n'
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
    *rows(
        "AXP", "err.1938", "err.1970", "err.1971", "axistype.0", "axistype.1", "WPOS", "MPOS", "CPOS", "AXO"
    )
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
    for word in (
        "AXP(10,1,0)",
        "AXP(1.5,1)",
        "AXP(0,1)",
        "AXP(10,1)",
        "AXP(11,1,0)",
        "AXP(1,1,2)",
        "AXP(1,1,-1)",
    ):
        assert "INVALID PARAMETER" in carried_out(wide, f"10 A=1\nN30 G1 [{word}] F600\n", 1), word
    for call in ("MPOS(1,0,2)", "WPOS(1,2)", "MPOS(1,-1)", "WPOS(1,1,0)", "WPOS(1,1,3)"):
        assert stopped(wide, f"A={call}") == "INVALID PARAMETER", call


@pytest.mark.covers(
    *rows("AXO", "CPOS", "WPOS", "MPOS", "SPOS", "APOS", "units.pos", "nc.G92", "nc.G70_G71", "cs.PCS")
)
def test_positions_are_inches_where_the_channel_has_inches(wide: Living) -> None:
    told(wide, "N1 G1 X2=12.7 F60000\n2 WAIT", "1", channel=2)
    asked = {
        "AXO(1)": 1, "CPOS(1)": 1, "WPOS(1)": 2, "MPOS(1)": 2, "SPOS(1)": 2, "APOS(1)": 2, 'AXO("B")': -10,
        "CPOS(4)": 40, "MPOS(4)": 30, 'SPOS("B")': 30, "APOS(4)": 30, "MPOS(10,0)": 0.5, "APOS(10)": 0.5,
        "SPOS(10)": 0.5, "WPOS(1,1,2)": 0.5,
    }  # fmt: skip
    found = told(wide, "N1 G1 X50.8 B30 F60000\nN2 G92 X25.4 B40\nN3 G70\n4 WAIT", *asked)
    told(wide, "N1 G1 X2=0 F60000\n2 WAIT", "1", channel=2)
    told(wide, "N1 G1 X0 B0 F60000\n2 WAIT", "1")
    assert dict(zip(asked, found, strict=True)) == pytest.approx(asked)


# ---------------------------------------------------------------------- services of the coupling


@pytest.mark.covers(
    *rows("MCODS", "MCODS.1", "MCODS.2", "MCODS.16", "MCODS.23", "MCODS.37", "MCODS.72", "MCODS.73", "MCODS.74"),
    *rows("MCODS.75", "MCODS.76", "MCODS.77", "MCODS.71", "MCODS.15", "MCODS.52", "MCODS.52.elem.1", "MCODS.52.elem.2"),
    *rows("MCODS.62", "MCODS.10", "MCODS.9", "MCODS.51", "MCODS.51.elem.1", "MCODS.51.elem.2", "cs.BCS", "cs.ACS"),
)  # fmt: skip
def test_an_external_shift_lies_among_those_of_the_tables(wide: Living) -> None:
    """X stands at 1.23456, shifted by 3, 0.25 and from outside 40; a length from outside needs an H."""
    wide.start(
        '1 FXC("X",160,0)=40 : FXC("X",54,1)=3 : FXC("X",254,1)=0.25 : TC(1,745,0)=2.5 : TC(2,745,0)=-0.75\n'
        "N1 G54\nN2 G254\nN3 G160\nN4 G745\nN5 G1 X1.23456 F60000\nN6 G4 F9\n",
        400,
    )
    program, machine = 1.23456, 44.48456
    wanted = {
        1: machine, 2: 444846, 16: machine, 23: program, 37: program + 40, 72: program, 73: program, 74: machine,
        75: program, 76: program, 77: machine, 71: program, 52: 40, 10: 0, 9: -1,
    }  # fmt: skip
    found = {number: wide.glance(number, 1)[0] for number in wanted}
    kept = (
        wide.glance(62, -1, 1, 1, 51),
        wide.glance(15, 1, 27)[::9],
        wide.glance(51, 1, 2),
        wide.glance(52, 1, 8)[1:],
    )
    wide.pnc.reset(channel=1)
    told(wide, "N1 G53\nN2 G153\nN3 G253\nN4 G167\nN5 G146\nN6 G1 X0 F60000")
    assert found == pytest.approx(wanted, abs=1e-4)
    assert kept == ([444846], [3, 0, 0.25], [-0.75, 2.5], [0.0] * 7)


@pytest.mark.covers(
    *rows("MCODS", "MCODS.18", "MCODS.18.val.0", "MCODS.18.val.1", "MCODS.24", "MCODS.29", "MCODS.29.val.1"),
    *rows("MCODS.53", "MCODS.53.val.0", "MCODS.53.val.1", "MCODS.81", "MCODS.81.val.0", "MCODS.81.val.1", "MCODS.7"),
    *rows("MCODS.50", "MCODS.87", "MCODS.87.bit.0", "MCODS.39", "MCODS.31", "MCODS.48", "MCODS.68", "MCODS.68.elem.1"),
    *rows("MCODS.68.elem.2", "MCODS.69", "MCODS.69.elem.1", "MCODS.69.elem.2", "MCODS.28", "MCODS.32", "MCODS.30"),
    *rows("MCODS.47", "MCODS.47.val.1", "MCODS.47.val.0", "MCODS.6", "MCODS.79", "MCODS.83", "MCODS.32.elem.1"),
    *rows("MCODS.32.sav.3", "MCODS.46", "MCODS.46.elem.1", "MCODS.46.elem.2", "MCODS.87.bit.3", "MCODS.29.val.0"),
    *rows("MCODS.87.bit.4", "MCODS.32.sav.2", "MCODS.32.ipo.3"),
)  # fmt: skip
def test_what_another_channel_does_is_told_of_it_alone(wide: Living) -> None:
    control = wide.pnc.control
    assert wide.glance(29, -1) == [0]
    control.set_switches(optional_stop=True, block_delete=frozenset({1}), channel=1)
    wide.start("N1 G70 (MSG,SECOND)\nN2 G1 X2=-9 F10\n", 300, channel=2)
    control.set_overrides(feed=1.5, channel=1)
    wide.pnc.advance(5)
    wanted: dict[int, tuple[object, object]] = {
        18: ([1], [0]), 24: (None, [254.0]), 28: (None, "SECOND"), 30: (None, "main2"), 31: ([5], [5]),
        81: ([1, 1, 1, 2], [0, 3]), 7: ([10000.0], [15000.0]), 68: ([0, 0], [1, 1]), 69: ([0, 0], [1, 1]),
        39: ([0], [0]), 47: ([0, 0], [1]), 79: ([1, 1], [0]), 32: (None, [3, 1]), 46: ([1, 1], [1, 1]),
        50: ([10000.0] * 9, [15000.0]),
    }  # fmt: skip
    for number, both in wanted.items():
        for channel, expected in enumerate(both, 1):
            if expected is not None:
                size = 40 if isinstance(expected, str) else len(expected)  # type: ignore[arg-type]
                assert wide.glance(number, channel, size) == expected, (number, channel)
    assert [wide.glance(29, -1), wide.glance(53, -1, 11), wide.glance(6, -1, 10)] == [
        [0], [1, 1, 1, 2, 1, 1, 1, 1, 1, 0, 3], [1] * 9 + [0],
    ]  # fmt: skip
    assert wide.glance(50, -1, 10) == [10000.0] * 9 + [15000.0]
    control.set_overrides(feed=0.0, channel=1)
    wide.pnc.advance(1)
    assert (wide.glance(87, 2), wide.glance(87, 1)) == ([8], [0])
    control.set_overrides(feed=1.0, channel=1)
    wide.pnc.reset(channel=2)
    wide.pnc.advance(50)
    wide.start("N1 G1 X2=0 F60000\nN2 M1\n", 300, channel=2)
    assert (wide.glance(87, 2), wide.glance(32, 2, 2), wide.glance(87, 1)) == ([16], [2, 3], [0])
    wide.pnc.reset(channel=2)
    wide.pnc.advance(50)
    control.set_switches(machine_lock=True, optional_stop=False, block_delete=frozenset(), channel=1)
    assert wide.glance(29, -1) == [1]
    control.set_switches(machine_lock=False, channel=1)
    assert [wide.glance(29, -1), wide.glance(68, 2, 2), wide.glance(69, 2, 2)] == [[0], [0, 0], [0, 0]]


@pytest.mark.covers(
    *rows(
        "MCODS",
        "MCODS.36",
        "MCODS.5",
        "MCODS.25",
        "MCODS.8",
        "SD.5.3.3",
        "SD.5.3.1",
        "SD.205.3.s",
        "SD.5.3.2",
        "SD.205.2.s",
        "SD.12.2",
    )
)
def test_a_spindle_whose_override_is_0_stands_and_is_told_to_turn(wide: Living) -> None:
    wide.start("N1 S900 M3\nN2 G4 F9\n", 300)
    wide.pnc.control.set_overrides(spindle=0.0)
    wide.pnc.advance(300)
    found = [wide.glance(number, -1)[0] for number in (25, 5, 36, 8, 63)]
    sd = wide.pnc.system.functions(1)["SD"]
    speeds = sd(5, 3, 1), sd(5, 3, 3), sd(205, 3, 1), sd(5, 3, 2), sd(12, 1)
    wide.pnc.control.set_overrides(spindle=1.0)
    wide.pnc.reset(channel=1)
    still = told(wide, "N1 S950 M5\nN2 G1 X0 F60000\n3 WAIT", "SD(5,3,2)", "SD(205,2,1)", "SD(12,2)")
    assert still == [950, 950, 0]
    assert found == [900, 0, 0, 0, 1]
    assert speeds == (0, 0, 0, 900, 3)


@pytest.mark.covers(
    *rows("MCODS", "MCODS.42", "ncs.18", "ncs.102", "ncs.1", "ncs.24", "MCODS.55", "MCODS.56", "MCODS.57")
)
def test_selections_of_services_go_to_their_last(wide: Living) -> None:
    answers = [wide.read(42, 1, 1, each) for each in (-1, 0, 65535, 65536)]
    assert answers == [18, 102, 102, 18]
    for number in (55, 56, 57):
        assert [wide.read(number, -1, 40, axis) for axis in (11, -1)] == [24, 24]
        assert wide.read(number, -1, 40, 0) == wide.read(number, -1, 40, 1)
        assert wide.read(number, -1, 40) == 18
    assert wide.read(57, -1, 40, 4) == "simulated rotary"
    for number in (7, 9, 28, 32, 52, 87):  # of a channel
        assert [wide.read(number, channel) for channel in (-2, -1, 0, 3)] == [1] * 4
    for number in (1, 4, 29, 35, 63):  # of the system: no channel is asked for, and none that is not there
        assert [wide.read(number, channel) for channel in (-2, 3)] == [1] * 2
        assert [isinstance(wide.read(number, channel), list) for channel in (-1, 0, 2)] == [True] * 3
    for number in (47, 48, 50, 53, 73):  # of either
        assert [wide.read(number, channel) for channel in (-2, 0, 3)] == [1] * 3


@pytest.mark.covers(
    *rows(
        "units.pos",
        "SPOS",
        "APOS",
        "MCODS",
        "MCODS.73",
        "MCODS.74",
        "MCODS.43",
        "MCODS.43.val.-1",
        "MCODS.58",
        "axis.sync",
        "SD.25.m",
    )
)
def test_an_axis_in_no_channel_is_told_where_it_stands(tmp_path: Path) -> None:
    living = Living(tmp_path, MACHINE, [("X", "Z", "C"), ("X2", "U")])
    living.start("N1 G1 U7.5 F60000\n", 400, channel=2)
    living.pnc.transfer_axis("U", None)
    living.pnc.advance(5)
    told_of = [living.read(number, -1, 5) for number in (73, 74, 43, 58)]
    channel = told(living, "N1 G70\n2 WAIT", "SD(25,5)", "SD(22,5)", "SD(21,2)", "SPOS(5)", 'APOS("U")')
    living.pnc.close()
    assert told_of == [[0, 0, 0, 0, 7.5], [0, 0, 0, 0, 7.5], [1, 1, 1, 2, -1], [1, 1, 1, 2, 2]]
    assert channel == [-1, 0, 1, 7.5, 7.5]


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.covers(
    *rows("MCODS.6", "MCODS.6.val.0", "MCODS.6.val.1", "MCODS.79", "MCODS.4", "MCODS.3", "MCODS.3.elem.1")
)
def test_an_axis_that_stands_beside_its_window_is_not_in_position(tmp_path: Path, way: int) -> None:
    living = six(tmp_path, LAGGING, servo=True)
    living.start(f"N1 G0 X{20 * way}\nN2 G4 F3\n", 20)
    living.pnc.control.set_overrides(feed=0.5, channel=0)
    living.pnc.advance(5)
    feeds = living.glance(3, 1, 3)
    x = "X"
    living.pnc.advance(2000, until=lambda: living.pnc.axes[x].setpoint == 20 * way)
    living.pnc.advance(2)
    apart = living.pnc.axes[x].setpoint - living.pnc.axes[x].actual
    found = living.glance(6, -1), living.glance(79, 1), living.glance(4, -1), living.glance(47, 1)
    living.pnc.close()
    assert apart * way > 0.01
    assert found[:3] == ([0], [0], [pytest.approx(apart, abs=1e-5)])
    assert feeds[0] == feeds[2] == 30000 > feeds[1] > 0


@pytest.mark.covers(
    *rows("MCODS", *(f"MCODS.{n}" for n in (71, 72, 75, 76, 77, 78, 81, 82, 83)), "MCODS.81.val.2")
)
def test_a_channel_that_has_run_nothing_tells_where_it_stands(tmp_path: Path) -> None:
    living = Living(tmp_path, MACHINE, [("X", "Z", "C"), ("X2", "U")])
    first = living.glance(81, 1, 4), living.glance(78, 1, 60), living.glance(82, 1, 3)
    living.pnc.select_mode(Mode.JOG, channel=1)
    living.pnc.control.jog("X", 1)
    living.pnc.advance(100)
    x = living.pnc.axes["X"].setpoint
    shown = [living.glance(number, 1, 3) for number in (71, 72, 75, 76, 77, 83)]
    living.pnc.close()
    assert first == ([1, 1, 2, 3], padded("X", "Z", "C"), [3, 3, 3])
    assert x > 1
    assert shown == [pytest.approx([x, 0, 0])] * 5 + [[0, 0, 0]]


@pytest.mark.covers(
    *rows("MCODS", "MCODS.refresh", "MCODS.refresh.S", "MCODS.refresh.R", "MCODS.16", "MCODS.23", "MCODS.44")
)
def test_data_of_all_channels_are_new_with_a_block_of_any(wide: Living) -> None:
    wide.start("N1 G4 F0.1\nN2 G1 X2=3 F60000\nN3 G4 F9\n", 20, channel=2)
    wide.read(16, -1, 10)
    before = wide.ask(16, -1, 10)
    wide.pnc.advance(200)
    after = wide.ask(16, -1, 10)[9], wide.ask(16, -1, 10)
    wide.read(44, -1, 3)
    wide.pnc.advance(1000)
    never = wide.ask(44, -1, 3)
    wide.pnc.reset(channel=2)
    told(wide, "N1 G1 X2=0 F60000\n2 WAIT", "1", channel=2)
    assert (before, after, never) == (BLOCKED, (3, BLOCKED), BLOCKED)


# ---------------------------------------------------------------------- tables


@pytest.mark.covers(
    *rows("FXC", "FXCR", "FXDEL", "FXINS", "FXC.table.file", "FXC.table.0", "FXC.unit.0", "FXC.unit.2")
)
@pytest.mark.covers(*rows("FXC.G.160", "FXC.G.54", "FXC.G.59", "FXC.G.154", "FXC.G.254", "FXCR.channel.0"))
@pytest.mark.covers(*rows("FXINS.type.0", "FXINS.type.1", "FXCR.class.0", "FXCR.class.1", "err.FXC_FOREIGN"))
def test_tables_of_shifts_have_64_columns_and_external_ones_8(wide: Living) -> None:
    (wide.folder / "INCH.npv").write_text("ZERO SHIFT TABLE INCH\nAXES X B:ROTARY\nG54 2.0 7.0\n\x03\n")
    more = " : ".join(f'FXINS("W.npv",{at},"Q{at}")' for at in range(10, 64))
    found = told(
        wide,
        f'1 FXCR(0,"W.npv")\n2 {more}\n3 FXC(64,54,"W.npv")=5.5 : FXC(-64,54,"W.npv")=0.25 : FXC(63,59,"W.npv",2)=1\n'
        '4 FXC(1,160,0)=40 : FXC(8,160,0)=3 : FXC(-8,160,0)=0.5 : FXC("C",160,0)=2\n'
        '5 FXCR("INCH.npv","LIKE.npv",1) : FXC(-1,54,"W.npv")=-4',
        *(
            'FXC(64,54,"W.npv")',
            'FXC("X2",54,"W.npv")',
            'FXC(63,59,"W.npv")',
            'FXC("A",160,0)',
            'FXC("C",160,0)',
        ),
        *('FXC(1,54,"LIKE.npv")', 'FXC(2,54,"LIKE.npv")', 'FXC(1,54,"INCH.npv")', 'FXC(1,54,"INCH.npv",0)'),
        *('FXC(2,54,"INCH.npv",0)', 'FXC(1,54,"W.npv")', "FXC(1,160)"),
    )
    told(wide, '1 FXC(8,160,0)=0 : FXC("C",160,0)=0', "1")
    assert found == pytest.approx([5.75, 5.75, 25.4, 3.5, 2, 0, 0, 2, 50.8, 7, -4, 40])
    head = (wide.folder / "LIKE.npv").read_text().splitlines()[:2]
    assert head == ["ZERO SHIFT TABLE MM STRICT", "AXES X B:ROTARY"]
    kept = (wide.folder / "W.npv").read_text()
    for statement in (
        'FXINS("W.npv",64,"ONE")', 'FXINS("W.npv",65,"ONE")', 'FXINS("W.npv",0,"ONE")', 'FXINS("W.npv",1,"X2")',
        'FXINS("W.npv",1,"ONE",2)', 'A=FXC(65,54,"W.npv")', 'A=FXC(0,54,"W.npv")', 'FXC(-65,54,"W.npv")=1',
        'FXDEL("W.npv",65)', 'FXDEL("W.npv",0)', 'FXDEL("W.npv",-1)', 'FXDEL("W.npv","-X")', "A=FXC(9,160,0)",
        "FXC(9,260,0)=1", 'FXC("X2",160,0)=1', 'A=FXC(1,54,"W.npv",1)', "A=FXC(1,160,0,0)", "A=FXC(1,53,1)",
        "A=FXC(1,60,1)", "A=FXC(1,153,1)", "A=FXC(1,260,3)", "A=FXC(1,54,0)", "A=FXC(1,54,4)", 'FXCR(3,"N.npv")',
        'FXCR(-1,"N.npv")', 'FXCR(1,"N.npv",2)',
    ):  # fmt: skip
        assert stopped(wide, statement) == "INVALID PARAMETER", statement
    assert (wide.folder / "W.npv").read_text() == kept
    assert not (wide.folder / "N.npv").exists()


@pytest.mark.covers(
    *rows("TC", "TC.sel.1", "TC.sel.2", "TC.sel.3", "TC.sel.5", "TC.sel.8", "TC.table.0", "TC.table.4")
)
@pytest.mark.covers(
    *rows("TC.table.5", "TC.group.1-48", "TC.group.845", "TC.group.847", "TC.group.145", "TC.group.147")
)
def test_groups_of_compensations_are_1_to_48_and_those_of_g145_to_g847(wide: Living) -> None:
    found = told(
        wide,
        "1 TC(1,48,4)=8.5 : TC(-2,48,4)=-1.5 : TC(1,1,5,2)=1 : TC(1,845,0)=3 : TC(-8,847,0)=4 : TC(-8,847,0)=0.5\n"
        "2 TC(5,847,0)=45 : TC(1,147,0)=6",
        *(
            "TC(1,48,4)",
            "TC(2,48)",
            "TC(1,1,5)",
            "TC(1,1,5,2)",
            "TC(-1,845,0)",
            "TC(8,847,0)",
            "TC(5,847,0)",
            "TC(1,147)",
        ),
    )
    told(wide, "1 TC(1,845,0)=0", "1")
    assert found == pytest.approx([8.5, -1.5, 25.4, 1, 3, 4.5, 45, 6])
    for statement in (
        "TC(1,49,4)=1", "A=TC(1,49,4)", "TC(1,0,4)=1", "TC(3,1,4)=1", "TC(0,1,4)=1", "TC(-3,1,4)=1", "TC(3,845,0)=1",
        "TC(1,945,0)=1", "TC(1,947,0)=1", "TC(1,45,0)=1", "TC(1,47,0)=1", "TC(9,847,0)=1", "TC(1,17,3)=1",
        "TC(1,17,6)=1", "TC(1,845,4)=1", "TC(1,147,5)=1", "TC(1,845,0,0)=1", "TC(1,17,4,1)=1", "A=TC(9)", "A=TC(0)",
        "A=TC(6,845,0)", "A=TC(6,17,4)",
    ):  # fmt: skip
        assert stopped(wide, statement) == "INVALID PARAMETER", statement


@pytest.mark.covers(
    *rows(
        "TDA",
        "err.ERASE_WARNING",
        *(f"TDA.field.{n}" for n in range(1, 50)),
        "GETERR",
        "err.SCS_LIST",
        "SCSL",
    )
)
@pytest.mark.covers(
    *rows(
        "GETERR.ret.-1",
        "SCSL.result.0",
        "param.1001_00004",
        "param.5010_00001",
        "param.5010_00002",
        "SCS",
        "SCS.idtype.S",
        "SCS.idtype.P",
        "MCA",
        "SCL",
        "NCF",
        "IC",
        "IC.group.0",
    )
)
def test_tool_data_errors_drives_and_signals_at_their_edges(wide: Living) -> None:
    found = told(
        wide,
        "1 DIM A$(40) : DIM F%(2,4)\n2 TDA(1,1,3)=-2147483648 : TDA(1,1,48)=2147483647 : A$=TDA(1,2,49)\n"
        '3 E%=GETERR(-1,0,F%,1) : SCSL(1,"S",51,"ONE",G%)\n4 IC(80)=TRUE : IC(95)=TRUE',
        *(
            "TDA(1,1,3)",
            "TDA(1,1,48)",
            "LEN(A$)",
            "TDA(1,1,4,1)",
            "E%",
            "G%",
            "MCA(100300004,3)",
            "MCA(100300004,0)",
            "MCA(501000001,15)",
            "MCA(501000002,15)",
            "MCA(100300004,9)",
        ),
        *("?IC(80,3)", "?IC(95,3)", "?IC(81,3)", "?IC(94,3)", 'LEN(NCF("M8"))'),
    )
    assert found == [-(2**31), 2**31 - 1, 0, 0, 0, 0, 3, 1, 0, 0, 1, 1, 1, 0, 0, 0]
    assert (wide.folder / "ONE").read_bytes() == b"0\n\x03\n"
    for statement in (
        "A%=TDA(1,1,3,0)", "A%=TDA(1,1,3,2)", "A%=TDA(1,1,50)", "A%=TDA(1,1,0)", "A%=TDA(1,0,3)", "A%=TDA(0,1,3)",
        "A=SCL(0,,1)", "IC(79)=TRUE", "IC(96)=TRUE", "IC(80,3)=TRUE",
        "A=MCA(501000001,16)", "A=MCA(501000002,16)", "A=MCA(100300004,10)", "A=MCA(100300004,0,3)",
        'A=SCS(1,"s",51)', 'A=SCS(1,"SP",51)', 'A=SCS(1,"S",32768)', 'A=SCS(1,"S",-1)',
    ):  # fmt: skip
        assert stopped(wide, statement) == "INVALID PARAMETER", statement
    assert stopped(wide, "TDA(1,1,3)=1.5").startswith("inconsistent data")
    fields = [*range(3, 8), *range(9, 49)]
    lines = "\n".join(f"{field} TDA(2,2,{field})={2_000_000_000 + field}" for field in fields)
    values = told(wide, lines, *(f"TDA(2,2,{field})" for field in fields))
    assert values == [2_000_000_000 + field for field in fields]
    warned = told(
        wide, '1 DIM F%(1,3) : A%=ERASE("NONE") : E%=GETERR(2,7,F%)', "E%", "F%(1,2)", "A%", channel=2
    )
    assert warned == [1, 2, 1]
    assert stopped(wide, "A%=GETERR(1,0,F%,1)", "10 DIM F%(2,2)") == "INVALID PARAMETER"
