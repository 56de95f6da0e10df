"""Rows of MCODS that need a living control in a state of their own, one run for each group (Manual 003, 4.14.2).

A program is brought to a place, then a table of data is read there.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from polycnc.cnc import Answer, Function, RunState
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.ncs import OVERVIEW, Coupling, Mode
from polycnc.nc.cpl import BLOCKED, Box, Field
from support.living_pnc import AXIS, LAGGING, ROTARY, Living, padded, six

MANY = [("X", 1), ("Y", 1), ("Z", 1), ("A", 0), ("B", 0), ("C", 0), ("U", 1), ("V", 1), ("W", 1)]
NINE = 'name = "nine"\n' + "".join(AXIS.format(n, 400) if linear else ROTARY.format(n) for n, linear in MANY)


class Case(NamedTuple):
    """What a service answers: numbers, or a text; `rows` are those of the manual besides that of the service."""

    number: int
    channel: int
    expected: Any
    rows: tuple[str, ...] = ()
    extra: tuple[int, ...] = ()

    def read(self, living: Living) -> Any:
        size = 60 if isinstance(self.expected, str) else len(self.expected)
        return living.read(self.number, self.channel, size, *self.extra)


def cases(*rows: Case) -> pytest.MarkDecorator:
    return pytest.mark.parametrize(
        "case",
        [
            pytest.param(
                case,
                id=f"{case.number} of {case.channel}",
                marks=pytest.mark.covers(
                    f"cpl.MCODS.{case.number}", *(f"cpl.MCODS.{row}" for row in case.rows)
                ),
            )
            for case in rows
        ],
    )


def close(found: Any, expected: Any) -> bool:
    return bool(found == (expected if isinstance(expected, str) else pytest.approx(expected, abs=1e-3)))


# ---------------------------------------------------------------------- axes that lag, on a path that is too fast


@pytest.fixture(scope="module")
def lagging(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Living]:
    """Return a control whose axes lag, with shifts in force, while its path gets faster than they can follow."""
    made = six(tmp_path_factory.mktemp("lagging"), LAGGING, servo=True)
    made.start(
        '1 FXC("X",55,1)=4 : FXC("X",154,1)=1.5 : FXC("Z",254,1)=-0.5\nN1 G55\nN2 G154\nN3 G254\nN4 H3\n'
        "N5 G1 X300 Z75 F60000\n",
        20,
    )
    made.pnc.control.set_overrides(feed=0.6, channel=0)
    made.pnc.advance(50)
    yield made
    made.pnc.close()


@pytest.mark.covers("cpl.SPOS", "cpl.APOS", "cpl.MPOS", "cpl.WPOS", "cpl.ex.1712", "cpl.ex.1683")
def test_programs_read_setpoints_by_spos_and_actual_values_by_apos(lagging: Living) -> None:
    x, z = lagging.pnc.axes["X"], lagging.pnc.axes["Z"]
    c, x2 = lagging.pnc.axes["C"], lagging.pnc.axes["X2"]
    functions = lagging.pnc.system.functions(1)
    for name, axis in ((1, x), ("X", x), (2, z), ("Z", z), (4, c), ("C", c), (5, x2), ("X2", x2)):
        assert functions["SPOS"](name) == pytest.approx(axis.setpoint)
        assert functions["APOS"](name) == pytest.approx(axis.actual)
    assert functions["MPOS"](2) == functions["SPOS"]("Z")
    assert functions["WPOS"](1) == pytest.approx(x.setpoint - 5.5)


@pytest.mark.covers("cpl.MCODS.4", "cpl.MCODS.35", "cpl.MCODS.38", "cpl.MCODS.75", "cpl.MCODS.72")
@pytest.mark.covers("cpl.MCODS")
def test_setpoints_actual_values_and_lag_are_told_apart(lagging: Living) -> None:
    x, z = lagging.pnc.axes["X"], lagging.pnc.axes["Z"]
    assert x.setpoint > x.actual + 3 > 9
    assert z.setpoint > z.actual + 1
    lag = lagging.read(4, -1, 7)
    assert close(lag, [x.setpoint - x.actual, z.setpoint - z.actual, 0, 0, 0, 0, 0])
    for number in (35, 38):  # no transformation: the Cartesian values are those of the axes
        assert close(lagging.read(number, -1, 3), [x.actual, z.actual, 0])
    # basis coordinates: without the shifts of both groups, with the length
    assert close(lagging.read(72, 1, 3), [x.setpoint - 5.5, z.setpoint + 0.5, 0])
    assert close(lagging.read(75, 1, 3), [x.actual - 5.5, z.actual + 0.5, 0])


@pytest.mark.covers(
    "cpl.cs.WCS", "cpl.cs.BCS", "cpl.cs.ACS", "cpl.cs.MCS", "cpl.MCODS.71", "cpl.MCODS.72", "cpl.MCODS.73"
)
@pytest.mark.covers("cpl.MCODS.74", "cpl.SPOS", "cpl.WPOS", "cpl.MPOS", "cpl.APOS", "cpl.MCODS.37")
@pytest.mark.covers("cpl.MCODS")
def test_each_system_of_coordinates_has_its_shifts(lagging: Living) -> None:
    """The shifts of axes lie between machine and axis coordinates, the length before the workpiece's."""
    x, z = lagging.pnc.axes["X"].setpoint, lagging.pnc.axes["Z"].setpoint
    wanted = {71: (x - 5.5, z + 0.5 - 42.5), 72: (x - 5.5, z + 0.5), 73: (x - 5.5, z + 0.5), 74: (x, z)}
    assert {number: tuple(lagging.read(number, 1, 2)) for number in wanted} == {
        number: pytest.approx(values, abs=1e-3) for number, values in wanted.items()
    }
    functions = lagging.pnc.system.functions(1)
    assert (functions["WPOS"]("X"), functions["WPOS"](2)) == pytest.approx(wanted[71])
    assert (functions["MPOS"](1), functions["MPOS"]("Z")) == pytest.approx(wanted[74])
    assert (functions["SPOS"](1), functions["SPOS"]("Z")) == pytest.approx(wanted[74])
    actual = lagging.pnc.axes["X"].actual, lagging.pnc.axes["Z"].actual
    assert (functions["APOS"]("X"), functions["APOS"](2)) == pytest.approx(actual)
    assert abs(actual[0] - x) > 0.1


@cases(
    Case(16, 0, [305.5, 117.0, 0, 0, 0], ("refresh",)),
    Case(23, 0, [300.0, 117.5, 0, 0, 0]),
    Case(76, 1, [300.0, 75.0, 0]),
    Case(77, 1, [305.5, 117.0, 0]),
    Case(20, 0, [0.0, 0.0]),
    Case(50, -1, [6000, 6000, 0, 6000, 10000, 0, 10000]),
    Case(50, 1, [6000, 6000, 6000, 10000]),
    Case(27, -1, [3600.0, 2880.0, 1.8, 3600.0, 2400.0]),
    Case(7, 1, [6000]),
    Case(57, -1, "simulated rotary", extra=(4,)),
    Case(57, -1, "simulated linear", extra=(0,)),
    Case(55, -1, "polycnc", extra=(7,)),
    Case(56, -1, "simulated", extra=(0,)),
    Case(64, -1, [40], ("64.val.40",)),
    Case(66, -1, [1], ("66.val.1",)),
    Case(70, 1, [0], ("70.val.0",)),
    Case(48, -1, [5, 5, 0, 5, 5, 0, 0], ("31.val.0",)),
    Case(9, 2, [-1], ("9.val.-1",)),
)
@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.31")
def test_ends_compensations_and_what_stands(lagging: Living, case: Case) -> None:
    assert close(case.read(lagging), case.expected)


def test_what_is_never_there_is_0(lagging: Living) -> None:
    """Inhibits of the PLC, groups and gears of spindles, online corrections."""
    assert [lagging.read(number, 1, 3) for number in (89, 90)] == [[0.0] * 3, [0] * 3]
    assert [lagging.read(number, -1)[0] for number in (49, 65, 67)] == [0, 0, 0]
    assert lagging.read(41, 1) == [0]


@pytest.mark.covers("cpl.MCODS.3.elem.1", "cpl.MCODS.3.elem.2", "cpl.MCODS.3.elem.3", "cpl.MCODS.3")
@pytest.mark.covers("cpl.MCODS")
def test_path_feeds_are_asked_for_present_and_allowed(lagging: Living) -> None:
    """F60000 with 60 % is 36000; X, which has 30000, takes 305.5 of the 327.1 mm of the path."""
    feed = lagging.pnc.status().channel.feed
    allowed = 30000 * 327.1379 / 305.5
    assert 5000 < feed.actual < 28000
    assert lagging.read(3, 1, 3) == pytest.approx([36000, feed.actual, allowed], rel=1e-4)


@pytest.mark.covers(
    *(f"cpl.MCODS.cat.{each.replace(' ', '_')}" for each in OVERVIEW if each != "Coordinates")
)
@pytest.mark.covers("cpl.MCODS")
def test_the_control_answers_whatever_the_overview_lists(lagging: Living) -> None:
    """34 is reserved, and there are no data of a customer; everything else is answered, and as what it is."""
    listed = {
        "Positions": [1, 2, 35, 38, 4, 37, 16, 23],
        "Speed and spindle speed": [3, 24, 27, 5, 36, 19, 20, 25],
        "States": [6, 29, 26, 39, 40, 41, 47, 49, 32],
        "Potentiometers": [7, 8, 50],
        "Compensations": [9, 10, 11, 12, 13, 14, 15, 51, 52, 54],
        "Operation modes": [31, 48],
        "System structure": [34, 44, 45, 33, 59, 60, 43, 58, 62],
        "Units of measurement": [61, 53, 18],
        "Spindles": [63, 64, 65, 66, 67],
        "Drive": [55, 56, 57],
        "Miscellaneous": [28, 46, 42, 68, 69, 70],
    }
    for category, numbers in listed.items():
        beyond = [30, 87] if category == "Miscellaneous" else []  # which the manual's list leaves out
        assert list(OVERVIEW[category]) == [*numbers, *beyond]
        for number in numbers:
            answer = lagging.read(number, 1, 1, 1, 51)
            assert answer == 102 if number in (34, 42) else isinstance(answer, list | str), number


# ---------------------------------------------------------------------- axes that lag, on their way back


@pytest.fixture(scope="module")
def back(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Living]:
    """Return a control whose axes lag on their way back, with other tables, a length from outside and G92 in force."""
    made = six(tmp_path_factory.mktemp("back"), LAGGING, servo=True)
    made.start(
        '1 TC(1,9,5)=31.25 : TC(1,745,0)=2.5 : FXC("X",55,2)=4\nN1 G22 K5\nN2 G22 V2\nN3 G745\nN4 H9\nN5 G55\n'
        "N6 G92 X7.25\nN7 G1 X-180.123 Z-60 F60000\nN8 G4 F2\n",
        70,
    )
    yield made
    made.pnc.close()


@pytest.mark.covers(
    "cpl.MCODS.1", "cpl.MCODS.2", "cpl.MCODS.4", "cpl.MCODS.6", "cpl.MCODS.6.val.0", "cpl.MCODS.6.val.1"
)
@pytest.mark.covers("cpl.MCODS.79", "cpl.MCODS.35", "cpl.MCODS.47")
@pytest.mark.covers("cpl.MCODS")
def test_positions_of_axes_that_lag_behind_on_their_way_back(back: Living) -> None:
    x, z = back.pnc.axes["X"], back.pnc.axes["Z"]
    assert (x.setpoint < x.actual - 1, z.setpoint < z.actual - 0.4) == (True, True)
    shown = back.read(1, -1, 2)
    preset = shown[0] - x.setpoint
    assert abs(preset) > 3  # where X showed 0 less the shift, it shows 7.25 since
    assert shown[1] == pytest.approx(z.setpoint)
    assert back.read(2, -1, 2) == [round((x.setpoint + preset) * 1e4), round(z.setpoint * 1e4)]
    assert close(back.read(4, -1, 2), [x.setpoint - x.actual, z.setpoint - z.actual])
    assert close(back.read(35, -1, 2), [x.actual, z.actual])
    assert [back.read(number, channel, 3) for number, channel in ((6, -1), (79, 1), (47, 1))] == [
        [0, 0, 1], [0, 0, 1], [1, 1, 0],
    ]  # fmt: skip


@pytest.mark.covers("cpl.MCODS.1")
@pytest.mark.covers("cpl.MCODS")
def test_a_shift_of_a_block_to_come_is_not_shown_yet(tmp_path: Path) -> None:
    living = six(tmp_path)
    living.start("N1 G1 X10 F60000\nN2 G92 X4\nN3 G1 X30\nN4 G4 F2\n", 20)
    pnc = living.pnc
    seen = set()
    for _ in range(40):
        block = pnc.status().channel.block
        assert block is not None
        shift = living.read(1, 1, 1)[0] - pnc.axes["X"].setpoint
        seen.add((block.sequence, round(shift, 6)))
        pnc.advance(2)
    pnc.close()
    assert {(1, 0.0), (3, -6.0)} <= seen <= {(1, 0.0), (2, -6.0), (3, -6.0), (4, -6.0)}


def test_a_shift_that_another_takes_back_is_shown(tmp_path: Path) -> None:
    living = six(tmp_path)
    living.start("N1 G1 X10 F60000\nN2 G92 X4\nN3 G168 X-6\nN4 G1 X30\nN5 G4 F2\n", 400)
    shift = living.read(1, 1, 1)[0] - living.pnc.axes["X"].setpoint
    living.pnc.close()
    assert shift == pytest.approx(-6.0)


@cases(
    Case(9, 1, [9]),
    Case(10, 1, [33.75]),
    Case(13, 1, "K5"),
    Case(14, 1, "V2"),
    Case(51, 1, [0, 2.5]),
    Case(9, 2, [-1], ("9.val.-1",)),
    Case(15, 1, [4, 0, 0, 0, 0, 0, 0, 0, 0]),
)
@pytest.mark.covers("cpl.MCODS")
def test_tables_and_lengths_are_those_that_were_selected(back: Living, case: Case) -> None:
    assert close(case.read(back), case.expected)


@pytest.mark.covers("cpl.MCODS.6", "cpl.MCODS.6.val.1", "cpl.MCODS.79", "cpl.MCODS.9.val.-1", "cpl.MCODS.9")
@pytest.mark.covers("cpl.MCODS")
def test_an_axis_is_in_position_within_its_window(tmp_path: Path) -> None:
    living = six(tmp_path, LAGGING, servo=True)
    living.start("N1 G1 X2 F6000\nN2 G4 F3\nN3 H3\nN4 G4 F1", 20)
    x = "X"
    assert (living.glance(6, -1, 1), living.glance(79, 1, 1), living.glance(9, 1)) == ([0], [0], [-1])
    living.pnc.advance(
        2000, until=lambda: abs(living.pnc.axes[x].setpoint - living.pnc.axes[x].actual) < 0.009
    )
    assert abs(living.pnc.axes[x].setpoint - living.pnc.axes[x].actual) > 0.001
    assert (living.glance(6, -1, 1), living.glance(79, 1, 1)) == ([1], [1])
    living.pnc.close()


# ---------------------------------------------------------------------- compensations and shifts of a long channel


@pytest.fixture(scope="module")
def nine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Living]:
    """Return a control with nine axes, external shifts for each and two kinds of tool compensation in force."""
    made = Living(tmp_path_factory.mktemp("nine"), NINE)
    shifts = " : ".join(f'FXC("{name}",260,0)={2 * place + 1.5}' for place, (name, _) in enumerate(MANY))
    made.pnc.system.tools.values[347, 6] = 3.0  # entered by the operator: programs cannot set it
    made.start(
        f"1 {shifts}\n2 TC(1,745,0)=18.5 : TC(2,745,0)=-0.75\n"
        "3 TC(1,347,0)=31 : TC(2,347,0)=5.5 : TC(3,347,0)=11 : TC(4,347,0)=21 : TC(5,347,0)=45.5\n"
        "N1 G260\nN2 G745\nN3 G347\nN4 G4 F0.3\nN5 G146\nN6 G148\nN7 G167\nN8 G4 F9\n",
        30,
    )
    yield made
    made.pnc.close()


@cases(
    Case(51, 1, [-0.75, 18.5], ("51.elem.1", "51.elem.2")),
    Case(52, 1, [1.5, 3.5, 5.5, 7.5, 9.5, 11.5, 13.5, 15.5], tuple(f"52.elem.{n}" for n in range(1, 9))),
    Case(54, 1, [5.5, 31, 11, 21, 45.5, 3], tuple(f"54.elem.{n}" for n in range(1, 7))),
)
@pytest.mark.covers("cpl.MCODS")
def test_external_and_general_compensations_in_force(nine: Living, case: Case) -> None:
    assert close(case.read(nine), case.expected)


@pytest.mark.covers("cpl.MCODS.54")
@pytest.mark.parametrize(
    "kind", [pytest.param(each, marks=pytest.mark.covers(f"cpl.MCODS.54.type.{each}")) for each in range(5)]
)
@pytest.mark.covers("cpl.MCODS")
def test_the_kind_of_tool_is_that_of_the_compensation(nine: Living, kind: int) -> None:
    nine.pnc.system.tools.values[347, 6] = float(kind)
    assert nine.read(54, 1, 6)[5] == kind
    nine.pnc.system.tools.values[447, 6] = 9.0  # of another compensation
    assert nine.read(54, 1, 6)[5] == kind


@pytest.mark.covers(
    "cpl.MCODS.51",
    "cpl.MCODS.52",
    "cpl.MCODS.54",
    "cpl.MCODS.refresh.S",
    "cpl.MCODS.refresh",
    *(
        f"cpl.MCODS.{number}.elem.{n}"
        for number, last in ((51, 2), (52, 8), (54, 6))
        for n in range(1, last + 1)
    ),
)
@pytest.mark.covers("cpl.MCODS")
def test_data_of_blocks_are_new_with_the_next_block(nine: Living) -> None:
    first = nine.read(52, 1, 8)
    nine.pnc.advance(3)
    assert nine.ask(52, 1, 8) is BLOCKED
    nine.pnc.advance(300)
    assert first[0] == 1.5
    assert nine.ask(52, 1, 8) == [0.0] * 8
    assert (nine.read(51, 1, 2), nine.read(54, 1, 6)) == ([0.0, 0.0], [0.0] * 6)


# ---------------------------------------------------------------------- waits, spindles, references, channels


@pytest.mark.covers(
    "cpl.MCODS.40",
    "cpl.MCODS.40.val.0",
    "cpl.MCODS.40.val.1",
    "cpl.MCODS.87.bit.1",
    "cpl.MCODS.refresh.E",
    "cpl.MCODS.87",
    "cpl.MCODS.refresh",
)
@pytest.mark.covers("cpl.MCODS")
def test_an_auxiliary_function_waits_until_the_plc_acknowledges_it(tmp_path: Path) -> None:
    living = six(tmp_path, script={(Function.M, 27): Answer(after_s=0.06)})
    living.start("N1 G1 X1 F6000\nN2 M27\nN3 X2\n", 3)
    seen: list[tuple[tuple[int, int], int]] = []
    for _ in range(110):
        now = living.glance(40, 1)[0], living.glance(87, 1)[0]
        if not seen or seen[-1][0] != now:
            seen.append((now, living.pnc.clock.cycles))
        living.pnc.advance(1)
    assert [state for state, _ in seen] == [(0, 0), (1, 2), (0, 0)]
    assert seen[2][1] - seen[1][1] == pytest.approx(60, abs=2)
    assert living.read(40, 2) == [0]
    living.start("N1 M27\nN2 X2=2\n", 3, channel=2)  # in the other channel: the first one waits for nothing
    assert [living.glance(number, channel)[0] for number in (40, 87) for channel in (1, 2)] == [0, 1, 0, 2]
    living.pnc.close()


@pytest.mark.parametrize(
    ("words", "value"),
    [
        pytest.param("M3", 1, marks=pytest.mark.covers("cpl.MCODS.63.val.1")),
        pytest.param("M3 M8", 2, marks=pytest.mark.covers("cpl.MCODS.63.val.2")),
        pytest.param("M7 M3", 2, marks=pytest.mark.covers("cpl.MCODS.63.val.2")),
        pytest.param("M4", 3, marks=pytest.mark.covers("cpl.MCODS.63.val.3")),
        pytest.param("M4 M7", 4, marks=pytest.mark.covers("cpl.MCODS.63.val.4")),
        pytest.param("M8 M4", 4, marks=pytest.mark.covers("cpl.MCODS.63.val.4")),
        pytest.param("M8 M5", 5, marks=pytest.mark.covers("cpl.MCODS.63.val.5")),
        pytest.param("M8 M19", 6, marks=pytest.mark.covers("cpl.MCODS.63.val.6")),
    ],
)
@pytest.mark.covers("cpl.MCODS.63")
@pytest.mark.covers("cpl.MCODS")
def test_a_spindle_turns_with_or_without_coolant(tmp_path: Path, words: str, value: int) -> None:
    living = six(tmp_path)
    one_each = "".join(f"N{place} {word}\n" for place, word in enumerate(words.split(), 2))
    living.start(f"N1 S3700\n{one_each}N6 G1 X1 F60\nN7 M9\nN8 X20\n", 300)
    assert living.glance(63, -1, 2) == [value, 0]
    living.pnc.advance(2000)
    assert living.glance(63, -1, 1) == [{2: 1, 4: 3}.get(value, value)]
    living.pnc.close()


@pytest.mark.covers("cpl.MCOPS.6")
@pytest.mark.covers("cpl.ncs.5", "cpl.MCODS.26", "cpl.MCODS.26.val.0", "cpl.MCODS.26.val.1", "cpl.MCODS.80")
@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS")
def test_axes_are_referenced_before_a_program_starts(tmp_path: Path) -> None:
    machine = 'name = "three"\n' + "".join(AXIS.format(name, 400) for name in "XYZ")
    living = Living(tmp_path, machine, [("X", "Z"), ("Y",)], references=True)
    pnc, mcops = living.pnc, living.coupling.mcops
    living.write("PART", "N1 G1 Y7 F6000\n")
    pnc.select_program("PART", channel=2)
    assert (mcops(6, 2), living.glance(26, -1, 3)) == (5, [0, 0, 0])
    for axis, expected in (("Z", [0, 0, 1]), ("X", [1, 0, 1])):
        pnc.select_mode(Mode.REFERENCE, channel=1)
        pnc.control.reference(axis)
        pnc.advance(3000)
        assert living.glance(26, -1, 3) == expected
    assert (living.glance(80, 1, 2), living.glance(80, 2, 1), mcops(6, 2)) == ([1, 1], [0], 5)
    pnc.select_mode(Mode.REFERENCE, channel=2)
    pnc.control.reference("Y")
    pnc.advance(3000)
    pnc.select_mode(Mode.AUTOMATIC, channel=2)
    assert (living.glance(26, -1, 3), mcops(6, 2)) == ([1, 1, 1], 0)
    living.until_over(2)
    assert pnc.axes["Y"].setpoint == 7
    pnc.close()


@pytest.mark.covers("cpl.MCODS.33")
@pytest.mark.covers(
    "cpl.MCODS.18.val.2",
    "cpl.MCODS.18.val.3",
    "cpl.MCODS.58.val.-1",
    "cpl.MCODS.58",
    "cpl.MCODS.43.val.-1",
    "cpl.MCODS.18",
    "cpl.MCODS.43",
)
@pytest.mark.covers("cpl.MCODS")
def test_channels_of_rotary_axes_of_none_and_axes_of_no_channel(tmp_path: Path) -> None:
    axes = AXIS.format("X", 400), ROTARY.format("C"), AXIS.format("U", 300), AXIS.format("Y", 90)
    machine = 'name = "four"\n' + "".join(axes)
    living = Living(tmp_path, machine, [("X",), ("C",), ("Y",)], (1, 3, 4, 6))
    assert [living.glance(18, channel) for channel in (1, 2, 3)] == [[1], [2], [1]]
    assert living.glance(58, -1, 7) == [1, -3, 2, -1, -3, 3, -3]
    assert living.glance(43, -1, 7) == [1, -3, 2, -1, -3, 3, -3]
    living.pnc.transfer_axis("Y", 1)
    assert [living.glance(18, channel) for channel in (1, 3)] == [[1], [3]]
    assert living.glance(43, -1, 6) == [1, -3, 2, -1, -3, 1]
    assert living.glance(58, -1, 6) == [1, -3, 2, -1, -3, 3]
    living.pnc.transfer_axis("U", 2)
    living.start("N1 G1 U5 C7 F6000\n", 500, channel=2)
    assert (living.pnc.axes["U"].setpoint, living.pnc.axes["C"].setpoint) == (5, 7)
    assert living.read(33, -1, 54) == padded("X", "", "C", "U", "", "Y")
    living.pnc.close()


@pytest.mark.covers("cpl.MCOPS.6", "cpl.MCODS.7")
@pytest.mark.covers("cpl.ncs.100", "cpl.ncs.101", "cpl.ncs.return")
@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS")
def test_a_program_is_told_that_the_coupling_is_broken_or_strange(tmp_path: Path) -> None:
    living = six(tmp_path)
    stranger = Coupling(living.pnc.ncs, magic=4711)
    buffer = Field("R", (1,))
    assert (stranger.mcods(7, 1, Box("V%", "I", 0), buffer, 1), stranger.mcops(6, 1)) == (100, 100)
    living.pnc.ncs.connected = False
    living.start("1 V=0 : B=7.5 : #E%=MCODS(7,1,V,B,1) : #F%=MCOPS(6,2) : #B=B : #V=V\n", 20)
    found = living.pnc.variables()
    assert [found[name] for name in ("#E%", "#F%", "#B", "#V")] == [101, 101, 7.5, 0]
    living.pnc.ncs.connected = True
    living.start("1 V=0 : B=7.5 : #E%=MCODS(7,1,V,B,1) : #F%=MCOPS(6,2) : #B=B\n", 20)
    found = living.pnc.variables()
    assert [found[name] for name in ("#E%", "#F%", "#B")] == [0, 10, 10000]
    living.pnc.close()


def test_an_axis_in_no_channel_is_asynchronous_from_the_start(tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text('name = "two"\n' + AXIS.format("X", 400) + AXIS.format("U", 300))
    pnc = Pnc(tmp_path, tmp_path / "two.toml", channels=[("X",)])
    assert pnc.status().channel.axes == ("X",)
    pnc.close()


def test_only_what_is_asked_for_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program that waits for data of a channel has no axis read, whatever else the control shows."""
    (tmp_path / "main.npg").write_text("10 DIM B%(4)\n20 V%=0\n30 R%=MCODS(31,1,V%,B%,1)\n40 GOTO 30\nM30\n")
    made = Pnc(tmp_path)
    made.select_program("main.npg")
    made.cycle_start()
    made.advance(3)
    read: list[int] = []
    shown = made.system.shown
    axis = shown.image.axes._read  # type: ignore[attr-defined]

    def noted(number: int) -> Any:
        read.append(number)
        return axis(number)

    monkeypatch.setattr(shown.image.axes, "_read", noted)
    assert made.advance(7) == 7
    assert made.run_state(1) is RunState.ACTIVE
    assert read == []
    assert shown.renew().axes[2].number == 2
    assert read == [2]
