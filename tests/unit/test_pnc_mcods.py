"""MCODS on a living control, in states in which data are not what they are at power-up (Manual 003, 4.14.2).

What moves is compared with the axes of the control's status, what stands with numbers worked out by hand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from polycnc.controllers.bosch.ncs import DATA_SERVICES, Mode
from polycnc.nc.cpl import BLOCKED
from support.living_pnc import Living, padded, six

PROGRAM = """1 FXC("X",55,1)=4 : FXC("X",154,1)=1.5 : FXC("Z",254,1)=-0.5
N1 G55
N2 G154
N3 G254
N4 H3
N5 S1500 M4
N6 (MSG,TOOL 7 IS WORN)
N7 G92 Z-2
N8 G1 X100 Z50 C20 F6000
N9 X0
"""


class Case(NamedTuple):
    number: int
    channel: int
    size: int
    expected: Any
    rows: tuple[str, ...] = ()
    extra: tuple[int, ...] = ()


def moving(*names: str, plus: dict[str, float] | None = None) -> Callable[[Living], list[float]]:
    """Return where axes are, with what is added to each."""
    return lambda six: [six.pnc.axes[name].setpoint + (plus or {}).get(name, 0.0) for name in names]


ALL = ("X", "Z", "C", "X2", "U")
PHYSICAL = padded("X", "Z", "", "C", "X2", "", "U")
# G92 Z-2 stands where Z shows -42: 0.5 by the shift, -42.5 by the length
SHIFTS = {"X": -5.5, "Z": 0.5}  # of the groups; G92 and the length are no zero shifts
NO = -2147483648
MOVING = [
    Case(1, -1, 5, moving(*ALL, plus={"Z": 40.0}), ("refresh.Z",)),
    Case(3, 1, 3, [6000.0, 6000.0, 6000.0], ("3.elem.1", "3.elem.2", "3.elem.3")),
    Case(5, -1, 2, [1500.0, 0.0]),
    Case(6, -1, 5, [0, 0, 0, 1, 1], ("6.val.0", "6.val.1")),
    Case(9, 1, 1, [3], ("refresh.S",)),
    Case(10, 1, 1, [42.5]),
    Case(13, 1, 90, "K4"),
    Case(14, 1, 90, "V1"),
    Case(15, 1, 9, [4.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0, -0.5, 0.0]),
    Case(18, 1, 1, [1], ("18.val.1",)),
    Case(19, -1, 2, [4000.0, 0.0]),
    Case(24, 1, 1, [6000.0]),
    Case(25, -1, 2, [1500.0, 0.0]),
    Case(27, -1, 5, [6000.0, 4800.0, 3.0, 3600.0, 2400.0]),
    Case(28, 1, 90, "TOOL 7 IS WORN"),
    Case(30, 1, 90, "main1"),
    Case(31, 1, 1, [5], ("31.val.5", "refresh.E")),
    Case(32, 1, 2, [3, 1], ("32.elem.1", "32.elem.2", "32.sav.3", "32.ipo.1")),
    Case(33, -1, 90, PHYSICAL),
    Case(33, 1, 90, padded("X", "Z", "C")),
    Case(35, -1, 5, moving(*ALL)),
    Case(36, -1, 2, [1500.0, 0.0]),
    Case(37, -1, 5, moving(*ALL, plus=SHIFTS)),
    Case(43, -1, 8, [1, 1, -3, 1, 2, -3, -1, -3], ("43.val.n", "43.val.-1", "43.val.-3")),
    Case(44, -1, 3, [2, 5, 2], ("44.elem.1", "44.elem.2", "44.elem.3", "refresh.R")),
    Case(45, -1, 2, [5, 5], ("45.elem.1", "45.elem.2")),
    Case(47, -1, 7, [1, 1, 0, 1, 0, 0, 0], ("47.val.0", "47.val.1")),
    Case(47, 1, 4, [1, 1, 1, 0]),
    Case(48, -1, 7, [5, 5, 0, 5, 5, 0, 0]),
    Case(53, -1, 8, [1, 1, 3, 2, 1, 3, 1, 3], ("53.val.1", "53.val.2", "53.val.3")),
    Case(58, -1, 8, [1, 1, -3, 1, 2, -3, 2, -3], ("58.val.n",)),
    Case(59, 2, 90, padded("X2")),
    Case(60, 1, 90, padded("X", "Z", "C")),
    Case(61, -1, 8, [1, 1, 3, 2, 1, 3, 1, 3], ("61.val.1", "61.val.2", "61.val.3")),
    Case(63, -1, 2, [3, 0], ("63.val.3", "63.val.0")),
    Case(71, 1, 3, moving("X", "Z", "C", plus={"X": -5.5, "Z": 0.5 - 42.5})),
    Case(73, 1, 3, moving("X", "Z", "C", plus=SHIFTS)),
    Case(74, -1, 5, moving(*ALL)),
    Case(74, 2, 1, moving("X2")),
    Case(78, 1, 90, padded("X", "Z", "C")),
    Case(79, 1, 3, [0, 0, 0]),
    Case(80, 1, 3, [1, 1, 1]),
    Case(81, 1, 4, [1, 1, 2, 3], ("81.val.1", "81.val.2", "81.val.3")),
    Case(82, 1, 3, [3, 3, 3], ("82.elem.1", "82.elem.2", "82.elem.3")),
]  # fmt: skip


def marked(case: Case) -> Any:
    rows = (str(case.number), *case.rows)
    marks = pytest.mark.covers(*(f"cpl.MCODS.{row}" for row in rows))
    return pytest.param(case, marks=marks, id=f"{case.number} of {case.channel}")


@pytest.fixture(scope="module")
def middle(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Living]:
    """Return a control in the middle of N8."""
    made = six(tmp_path_factory.mktemp("six"))
    made.start(PROGRAM)
    yield made
    made.pnc.close()


@pytest.fixture
def fresh(tmp_path: Path) -> Iterator[Living]:
    made = six(tmp_path)
    yield made
    made.pnc.close()


@pytest.mark.parametrize("case", [marked(case) for case in MOVING])
@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.refresh")
def test_data_of_a_control_in_motion(middle: Living, case: Case) -> None:
    expected = case.expected(middle) if callable(case.expected) else case.expected
    found = middle.read(case.number, case.channel, case.size, *case.extra)
    assert found == (expected if isinstance(expected, str) else pytest.approx(expected, abs=1e-4))


@pytest.mark.covers("cpl.MCODS.3")
@pytest.mark.covers("cpl.MCODS.47", "cpl.MCODS.47.val.0", "cpl.MCODS.47.val.1")
@pytest.mark.covers("cpl.MCODS")
def test_an_axis_travels_whichever_way_it_goes(fresh: Living) -> None:
    fresh.start("N1 G1 F6000 X-60 C-30\nM30\n", 300)
    assert (fresh.pnc.axes["X"].velocity < 0.0, fresh.read(47, 1, 3)) == (True, [1, 0, 1])
    assert fresh.read(3, 1, 3)[:2] == pytest.approx([6000.0, 6000.0])  # a feed has no sign
    fresh.until_over()
    fresh.pnc.advance(20)
    assert fresh.read(47, 1, 3) == [0, 0, 0]


@pytest.mark.covers("cpl.MCODS.77", "cpl.MCODS.16", "cpl.MCODS.23")
@pytest.mark.covers(
    "cpl.MCODS.2", "cpl.MCODS.62", "cpl.MCODS.62.val.-2147483648", "cpl.MCODS.83", "cpl.MCODS.76"
)
@pytest.mark.covers("cpl.MCODS")
def test_whole_numbers_ends_and_what_is_left(middle: Living) -> None:
    x, c = middle.pnc.axes["X"], middle.pnc.axes["C"]
    assert middle.read(2, -1, 1) == [round(x.setpoint * 10_000)]
    assert middle.read(62, -1, 4, 1, 51) == [round(x.actual * 10_000), middle.read(62, -1, 2, 1, 51)[1], NO,
                                          round(c.actual * 10_000)]  # fmt: skip
    assert middle.read(62, -1, 1, 1, 53) == [NO]
    end = middle.read(76, 1, 3)
    assert (end[0], end[2]) == (pytest.approx(100), pytest.approx(20))
    left = middle.read(83, 1, 3)
    assert left[0] == pytest.approx(105.5 - x.setpoint, abs=1e-4)
    assert left[2] == pytest.approx(20 - c.setpoint, abs=1e-4)
    ends = middle.read(77, 1, 1), middle.read(16, -1, 1), middle.read(23, -1, 1)
    assert ends == ([pytest.approx(105.5)], [pytest.approx(105.5)], [pytest.approx(100)])


@pytest.mark.covers("cpl.MCODS.31", "cpl.MCODS.55", "cpl.MCODS.56")
@pytest.mark.covers("cpl.MCODS.34", "cpl.MCODS.42", "cpl.ncs.102", "cpl.ncs.1", "cpl.ncs.24", "cpl.ncs.18")
@pytest.mark.covers("cpl.MCODS")
def test_what_the_control_does_not_have_is_refused(middle: Living) -> None:
    assert [
        middle.read(34, -1),
        middle.read(42, 1, 1, 7),
        middle.read(31, 3),
        middle.read(55, -1, 40, 3),
    ] == [
        102,
        102,
        1,
        24,
    ]
    assert (middle.read(42, 1, 1), middle.read(55, -1, 40, 1), middle.read(56, -1, 40, 0)) == (
        18,
        "polycnc",
        "simulated",
    )


@pytest.mark.parametrize(("number", "extra"), [(number, ()) for number in (1, 3, 35, 37, 47, 71, 74, 83)])
@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.refresh.Z", "cpl.MCODS.refresh")
def test_cyclic_data_are_new_in_the_next_cycle(fresh: Living, number: int, extra: tuple[int, ...]) -> None:
    fresh.start(PROGRAM)
    channel = -1 if DATA_SERVICES[number].scope == "system" else 1
    first = fresh.read(number, channel, 2, *extra)
    assert fresh.ask(number, channel, 2, *extra) is BLOCKED
    fresh.pnc.advance(1)
    assert fresh.ask(number, channel, 2, *extra) != BLOCKED
    assert first


class Change(NamedTuple):
    """What an operator or a program does, and the data before and after."""

    number: int
    channel: int
    size: int
    before: Any
    change: Callable[[Living], object]
    after: Any
    rows: tuple[str, ...] = ()


def run(program: str, cycles: int = 5, channel: int = 1) -> Callable[[Living], object]:
    return lambda six: six.start(program, cycles, channel)


def mode(which: Mode) -> Callable[[Living], object]:
    return lambda six: six.pnc.select_mode(which, channel=1)


CHANGES = [
    Change(7, 1, 1, [10000.0], lambda six: six.pnc.control.set_overrides(feed=0.825, channel=0), [8250.0]),
    Change(8, -1, 1, [10000.0], lambda six: six.pnc.control.set_overrides(spindle=0.9), [9000.0]),
    Change(9, 1, 1, [-1], run("N1 H3\nN2 G1 X9 F60\n"), [3]),
    Change(11, 1, 1, [-1], run("N1 G18 G41 D3 G1 X5 F60000\nN2 X9 F60\n"), [3], ("11.val.-1",)),
    Change(12, 1, 1, [0.0], run("N1 G18 G41 D3 G1 X5 F60000\nN2 X9 F60\n"), [6.25]),
    Change(18, 1, 1, [1], run("N1 G70\nN2 G1 X9 F60\n"), [0], ("18.val.0",)),
    Change(29, -1, 1, [0], lambda six: six.pnc.control.set_switches(machine_lock=True), [1], ("29.val.0", "29.val.1")),
    Change(39, 1, 1, [0], run("N1 G4 F5\n"), [1], ("39.val.0", "39.val.1")),
    Change(46, 1, 3, [1, 1, 0], run("1 E%=MCOPS(8,1,2,3)\n"), [2, 3, 0],
           ("46.elem.1", "46.elem.2", "46.elem.3")),
    Change(53, 1, 2, [1, 1], run("N1 G70\nN2 G1 X9 F60\n"), [0, 0], ("53.val.0",)),
    Change(63, -1, 1, [5], run("N1 S300 M3\nN2 G1 X9 F60\n"), [1], ("63.val.5", "63.val.1")),
    Change(68, 1, 2, [0, 0], lambda six: six.pnc.control.set_switches(block_delete=frozenset({1})), [1, 1],
           ("68.elem.1", "68.elem.2")),
    Change(69, 1, 2, [0, 0], lambda six: six.pnc.control.set_switches(optional_stop=True), [1, 1],
           ("69.elem.1", "69.elem.2")),
    Change(81, 1, 2, [1, 1], run("N1 G70\nN2 G1 X9 F60\n"), [0, 0], ("81.val.0",)),
    Change(87, 1, 1, [0], run("N1 G4 F5\n"), [1], ("87.bit.0",)),
    Change(87, 1, 1, [0], run("N1 G1 X1 F60000\nN2 M0\nN3 X2\n", 500), [16], ("87.bit.4",)),
    Change(87, 1, 1, [0], lambda six: six.pnc.control.set_overrides(feed=0.0, channel=0), [8], ("87.bit.3",)),
    Change(87, 1, 1, [0], run("1 WAIT(,5000)\n", 5), [4096], ("87.bit.12",)),
    *(Change(31, 1, 1, [5], mode(which), [number], (f"31.val.{number}",))
      for number, which in {1: Mode.JOG, 2: Mode.REFERENCE, 4: Mode.MDI, 6: Mode.PROGRAM_BLOCK, 7: Mode.SINGLE_STEP,
                            10: Mode.SINGLE_BLOCK, 12: Mode.DEBUG_BLOCK, 13: Mode.DEBUG_AUTOMATIC}.items()),
    Change(48, 1, 1, [5], mode(Mode.JOG), [1]),
]  # fmt: skip


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(
            case,
            marks=pytest.mark.covers(f"cpl.MCODS.{case.number}", *(f"cpl.MCODS.{row}" for row in case.rows)),
            id=f"{case.number} becomes {case.after}",
        )
        for case in CHANGES
    ],
)
@pytest.mark.covers("cpl.MCODS")
def test_a_change_is_seen_by_who_asks_and_ends_the_wait_of_who_asked(fresh: Living, case: Change) -> None:
    fresh.start("N1 G71 G0 X0\n", 20)
    assert fresh.read(case.number, case.channel, case.size) == case.before
    case.change(fresh)
    fresh.pnc.advance(1)
    assert fresh.ask(case.number, case.channel, case.size) == pytest.approx(case.after)


@pytest.mark.covers(
    "cpl.MCODS.5", "cpl.MCODS.25", "cpl.MCODS.36", "cpl.MCODS.63.val.5", "cpl.MCODS.8", "cpl.MCODS.63"
)
@pytest.mark.covers("cpl.MCODS")
def test_a_spindle_that_stands_keeps_the_speed_that_was_programmed(fresh: Living) -> None:
    fresh.start("N1 S900 M3\nN2 G4 F0.2\nN3 M5\nN4 G4 F9\n", 100)
    fresh.pnc.control.set_overrides(spindle=0.9)
    assert [fresh.read(number, -1, 1) for number in (25, 8)] == [[900.0], [9000.0]]
    assert fresh.read(5, -1, 1) == fresh.read(36, -1, 1)
    assert 0 < fresh.read(36, -1, 1)[0] <= 900
    fresh.pnc.advance(3000)
    assert [fresh.read(number, -1, 1) for number in (25, 36, 63)] == [[900.0], [0.0], [5]]


class Scene(NamedTuple):
    """A program, how long it has run, and what services of channel 1 answer then; a size is that of the answer."""

    program: str
    cycles: int
    answers: dict[int, Any]


LONG = "AN OPERATOR IS TO TURN THE PART BY 180 DEGREES AND TO CLAMP IT WITH 40 BAR, THEN GO"
SCENES = [
    Scene("N1 G70 G1 X5 F100\n", 60, {24: [2540.0], 18: [0], 53: [0, 0, 2], 81: [0, 0, 2], 39: [0], 47: [1, 0, 0]}),
    Scene(f"N1 (MSG,{LONG})\nN2 G1 X5 F10\n", 60, {28: LONG[:80], 24: [10.0], 39: [0], 32: [3, 1], 87: [0]}),
    Scene("N1 G1 X5 F600\nN2 (MSG,LATER) G1 X9\nN3 (MSG,LAST)\nN4 X20\n", 400, {28: ""}),  # prepared ahead
    Scene("N1 G1 X5 F600\nN2 (MSG,LATER) G1 X9\nN3 (MSG,LAST)\nN4 X20\n", 700, {28: "LATER"}),
    Scene("N1 G1 X5 F600\nN2 (MSG,LATER) G1 X9\nN3 (MSG,LAST)\nN4 X20\n", 1100, {28: "LAST"}),
    Scene("N1 G0 X300\n", 90, {3: [30000.0, None, 30000.0], 32: [3, 1], 79: [0, 1, 1], 7: [10000.0]}),
    Scene("N1 G1 X-40 Z-9 F3000\n", 400, {83: "to go", 76: [-40.0, -9.0, 0.0], 77: [-40.0, -9.0, 0.0], 24: [3000.0]}),
    Scene("N1 G4 F0.1\nN2 G1 X1 F6000\nN3 G4 F0.5\nN4 X2\n", 900, {39: [0], 87: [0], 32: [1, 3], 47: [0, 0, 0]}),
    Scene("N1 G1 X1 F6000\nN2 G4 F5\n", 300, {39: [1], 87: [1], 32: [3, 1], 79: [1, 1, 1], 6: [1, 1, 1], 3: [0, 0, 0]}),
    Scene("N1 G1 X1 F6000\nN2 G4 F0.1\n", 700, {39: [0], 87: [0], 32: [1, 3], 47: [0, 0, 0]}),
    Scene("N1 M0\nN2 G1 X1 F6000\n", 90, {87: [16], 32: [2, 3], 30: "main1", 31: [5], 39: [0]}),
    Scene("N1 G1 X1 F6000\n2 A=SD(999)\n", 400, {32: [6, 3]}),
    Scene("N1 G18 G1 X9 F60000\nN2 H3 G41 D3 G1 X20\nN3 G4 F9\n", 300, {9: [3], 10: [42.5], 11: [3], 12: [6.25]}),
    Scene("N1 G18 G1 X9 F60000\nN2 H3 G41 D3 G1 X20\nN3 G40 H0 G1 X30\nN4 G4 F9\n", 400,
          {9: [-1], 10: [0], 11: [-1], 12: [0]}),
    Scene("1 TC(2,345,0)=-1.5 : TC(1,345,0)=7\nN1 G345\nN2 G1 X9 F60000\nN3 G4 F9\n", 300,
          {51: [-1.5, 7.0], 10: [0.0]}),
    Scene("1 TC(2,745,0)=-0.75 : TC(1,745,0)=2.5\nN1 G745\nN2 G18 G1 X9 F60000\nN3 H3 G41 D3 G1 X20\nN4 G4 F9\n",
          300,
          {10: [45.0], 12: [5.5], 51: [-0.75, 2.5], 9: [3], 11: [3]}),
    Scene("N1 G54 G1 X9 F60000\nN2 G22 V3\nN3 G22 K5\nN4 G4 F9\n", 300, {13: "K5", 14: "V3", 15: [0.0] * 9}),
]  # fmt: skip


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(
            each, id=str(place), marks=pytest.mark.covers(*(f"cpl.MCODS.{number}" for number in each.answers))
        )
        for place, each in enumerate(SCENES, 1)
    ],
)
@pytest.mark.covers("cpl.MCODS")
def test_services_answer_in_scenes_of_their_own(fresh: Living, scene: Scene) -> None:
    fresh.write("main1", scene.program)
    fresh.pnc.select_program("main1")
    fresh.pnc.cycle_start()
    fresh.pnc.advance(scene.cycles)
    for number, wanted in scene.answers.items():
        channel = -1 if DATA_SERVICES[number].scope == "system" else 1
        if wanted == "to go":
            left = [end - fresh.pnc.axes[name].setpoint for name, end in (("X", -40), ("Z", -9))]
            assert left[0] < -20
            wanted = [*left, 0.0]
        found = fresh.glance(number, channel, 90 if isinstance(wanted, str) else len(wanted))
        if isinstance(wanted, list):
            found = [each if known is not None else None for each, known in zip(found, wanted, strict=True)]
        assert found == (wanted if isinstance(wanted, str) else pytest.approx(wanted, abs=1e-3)), number


@pytest.mark.covers(
    "cpl.MCODS.62", "cpl.MCODS.30", "cpl.MCODS.32", "cpl.MCODS.32.sav.11", "cpl.MCODS.32.sav.1"
)
@pytest.mark.covers("cpl.MCODS.32.elem.1", "cpl.MCODS.32.elem.2")
@pytest.mark.covers("cpl.MCODS")
def test_speeds_of_drives_and_what_is_selected(fresh: Living) -> None:
    assert (fresh.glance(32, 1, 2), fresh.glance(30, 1, 9)) == ([1, 3], "")
    fresh.write("main1", "N1 G1 X-60 C-3 F6000\n")
    fresh.pnc.select_program("main1")
    fresh.pnc.advance(1)
    assert (fresh.glance(32, 1, 2), fresh.glance(30, 1, 9)) == ([11, 3], "main1")
    fresh.pnc.cycle_start()
    fresh.pnc.advance(300)
    speeds = [round(fresh.pnc.axes[name].velocity * 60) for name in ("X", "Z", "C")]
    assert speeds[0] < -5900
    assert fresh.glance(62, -1, 4, 1, 40) == [*speeds[:2], NO, speeds[2]]
    fresh.until_over()
    fresh.pnc.select_mode(Mode.MDI, channel=1)
    fresh.pnc.select_blocks("N1 G1 X5 F600")
    fresh.pnc.cycle_start()
    fresh.pnc.advance(30)
    assert (fresh.glance(32, 1, 2), fresh.glance(30, 1, 9)) == ([3, 1], "")
