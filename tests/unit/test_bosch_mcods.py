"""MCODS: the data services of the NCS coupling, numbers from the manual (Manual 003, 4.14.2)."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import pytest

from polycnc.controllers.bosch.ncs import (
    OVERVIEW,
    Coupling,
    Image,
    Ipo,
    Mode,
    NcsServer,
    Partner,
    Sav,
    SpindleMotion,
    ToolCompensation,
    Unit,
    Wait,
)
from polycnc.nc.cpl import BLOCKED, OMITTED, Box, CharacterField, Fault, Field
from support.ncs_system import system

Change = Callable[[Image], object]
Variable = Field | CharacterField | Box


class Asking:
    """A program that asks: its version variable, and what was answered."""

    def __init__(self, image: Image | None = None) -> None:
        self.image = image or system()
        self.partner = Partner(self.image)
        self.server = NcsServer(self.partner)
        self.coupling = Coupling(self.server)
        self.version = Box("VERS", "R", 0.0)

    def __call__(self, number: int, channel: int, buffer: Variable, size: int, *extra: object) -> object:
        return self.coupling.mcods(number, channel, self.version, buffer, size, *extra)

    def values(
        self, number: int, channel: int, kind: str, size: int, *extra: object
    ) -> list[object] | str | None:
        """Return what a service writes at once: a text, or the elements of a field from 1 on."""
        self.version.value = 0
        buffer = variable(kind, size)
        assert self(number, channel, buffer, size, *extra) == 0
        if isinstance(buffer, CharacterField):
            return buffer.text
        assert isinstance(buffer, Field)
        return [buffer[index] for index in range(1, size + 1)]


def variable(kind: str, size: int) -> CharacterField | Field:
    return CharacterField(size) if kind == "S" else Field(kind, (size,))  # type: ignore[arg-type]


class Case(NamedTuple):
    number: int
    channel: int
    refresh: str
    kind: str
    expected: tuple[object, ...] | str
    change: Change | None = None
    extra: tuple[object, ...] = ()


def put(place: str, value: object) -> Change:
    """Return a change of an attribute: "channel.1.dwell", "axis.3.travel", "spindle.1.group", "test_mode"."""

    def change(image: Image) -> None:
        *rest, name = place.split(".")
        lists: dict[str, Any] = {"channel": image.channels, "axis": image.axes, "spindle": image.spindles}
        owner: Any = lists[rest[0]][int(rest[1])] if rest else image
        assert getattr(owner, name) != value
        setattr(owner, name, value)

    return change


def coordinate(name: str, value: object) -> Change:
    def change(image: Image) -> None:
        assert getattr(image.channels[1].coordinates[0], name) != value
        setattr(image.channels[1].coordinates[0], name, value)

    return change


def fewer_coordinates(image: Image) -> None:
    image.channels[1].coordinates = image.channels[1].coordinates[:-1]


Z = "\0"
CASES = [
    # axes: X=1 Y=2 Z=3 (gap 4) B=5 S=6 C=7 U=8; feed and auxiliary axes are X Y Z B C U
    Case(1, -1, "Z", "D", (112.5, -3.75, 88.0, 359.5, 15.0, 5.0625)),
    Case(2, -1, "Z", "I", (1125000, -37500, 880000, 3595000, 150000, 50625)),
    Case(3, 1, "Z", "R", (1500.0, 1200.5, 1350.25)),
    Case(4, -1, "Z", "R", (0.25, 0.0, 0.0, 0.0, 0.0, 1.75, 0.0, 0.0)),
    Case(5, -1, "Z", "R", (2400.0, 0.0, 90.0, 0.0)),
    Case(6, -1, "Z", "I", (0, 1, 0, 1, 1, 0)),
    Case(7, 1, "Z", "R", (8250.0,)),
    Case(8, -1, "Z", "R", (9000.0, 0.0, 5000.0)),
    Case(9, 1, "S", "I", (14,)),
    Case(10, 1, "S", "R", (73.25,)),
    Case(11, 1, "S", "I", (9,)),
    Case(12, 1, "S", "R", (6.349999904632568,)),
    Case(13, 1, "S", "S", "K4"),
    Case(14, 1, "S", "S", "V2.npv"),
    Case(15, 1, "S", "R", (1.5, 2.0, 0.25, -0.5, -3.0, 0.75)),
    Case(16, 0, "S", "R", (38.875, 43.75, 3.0, 90.5, 30.0, 6.5)),
    Case(18, 1, "S", "I", (0,)),
    Case(19, 0, "S", "R", (2400.0, 0.0, 4500.0, 0.0)),
    Case(20, 0, "S", "R", (80.0, 0.0, 25.0, 0.0)),
    Case(23, 0, "S", "R", (40.0, 41.5, -8.5, 90.5, 30.0, 6.5)),
    Case(24, 1, "S", "R", (1600.0,)),
    Case(25, 0, "S", "R", (3000.0, 0.0, 700.0)),
    Case(26, -1, "E", "I", (1, 0, 1, 1, 0, 1), put("axis.2.referenced", True)),
    Case(27, -1, "E", "R", (2200.0, 1800.0, 900.0, 12.0, 3.5, 650.0), put("axis.5.jog_speed", 13.0)),
    Case(28, 1, "E", "S", "TOOL 7 IS WORN", put("channel.1.message", "")),
    Case(29, 0, "E", "I", (1,), put("test_mode", False)),
    Case(30, 1, "-", "S", "/usr/user/p1.cnc"),
    Case(31, 1, "E", "I", (10,), put("channel.1.mode", Mode.AUTOMATIC)),
    Case(32, 1, "E", "I", (2, 2), put("channel.1.ipo", 3)),
    Case(
        33, -1, "R", "S",
        f"X       {Z}YLONGNAM{Z}Z       {Z}{Z * 9}B       {Z}S       {Z}C       {Z}U       {Z}",
    ),
    Case(33, 2, "R", "S", f"Z       {Z}C       {Z}"),
    Case(35, -1, "Z", "R", (12.25, -3.5, 87.5, 359.25, 14.5, 5.0)),
    Case(36, -1, "Z", "R", (2399.5, 0.0, 640.5, 0.0)),
    Case(37, -1, "Z", "D", (13.75, -6.0, 82.0, 359.5, 15.0, 5.0625)),
    Case(38, -1, "Z", "D", (7.75, -3.5, 87.5, 359.25, 14.5, 5.0)),
    Case(39, 2, "E", "I", (1,), put("channel.2.dwell", False)),
    Case(40, 2, "E", "I", (1,), put("channel.2.auxiliary_waits", False)),
    Case(41, 2, "E", "I", (1,), put("channel.2.transfer_inhibit", False)),
    Case(42, 1, "E", "R", (1.5, 2.5), lambda image: image.customer.update({(1, 4660): (3.5,)}), (4660,)),
    Case(43, -1, "E", "I", (1, 1, 2, -3, -1, -2, 2, -1, -3), put("axis.3.channel", None)),
    Case(44, -1, "R", "I", (2, 5, 9)),
    Case(45, -1, "R", "I", (6, 7)),
    Case(46, 1, "E", "I", (2, 3, 1), put("channel.1.recording", False)),
    Case(47, -1, "Z", "I", (1, 0, 0, 0, 0, 0, 0, 1)),
    Case(47, 1, "Z", "I", (1, 0, 0, 1)),
    Case(48, -1, "E", "I", (10, 10, 1, 0, 1, 0, 1, 2), put("axis.8.mode", Mode.NONE)),
    Case(48, 2, "E", "I", (1, 1, 1, 2), put("channel.2.mode", Mode.MDI)),
    Case(49, -1, "E", "I", (0, 1, 0, 0, 0, 0, 0, 1), put("axis.2.feed_inhibit", False)),
    Case(49, 2, "E", "I", (0, 0, 0, 1), put("axis.8.feed_inhibit", False)),
    Case(
        50, -1, "E", "R", (7300.0, 7400.0, 7500.0, 0.0, 7600.0, 7700.0, 7800.0, 7900.0),
        put("axis.1.potentiometer", 1.0),
    ),
    Case(50, 1, "E", "R", (8250.0, 8250.0, 7600.0, 7900.0), put("channel.1.potentiometer", 1.0)),
    Case(51, 1, "S", "R", (2.75, 18.5)),
    Case(52, 1, "S", "R", (0.125, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)),
    Case(53, -1, "E", "I", (0, 0, 1, 3, 2, 2, 4, 0, 3), put("channel.1.inch", False)),
    Case(53, 2, "E", "I", (1, 4, 2, 0, 3), put("axis.8.mode", Mode.NONE)),
    Case(54, 1, "S", "R", (5.5, 31.0, 11.0, 21.0, 45.5, 3.0)),
    Case(55, -1, "R", "S", "HSM01.1-FW", extra=(1,)),
    Case(56, -1, "R", "S", "DIAX04", extra=(0,)),
    Case(57, -1, "R", "S", "MKD071B", extra=(1,)),
    Case(58, -1, "R", "I", (1, 1, 1, -3, -1, -2, 2, 2, -3)),
    Case(59, 1, "E", "S", f"XL      {Z}YLONGNAM{Z}", put("axis.2.logical_name", "YY")),
    Case(60, 1, "R", "S", f"XD      {Z}YLONGNAM{Z}"),
    Case(61, -1, "R", "I", (1, 1, 1, 3, 2, 2, 4, 0, 3)),
    Case(61, 2, "R", "I", (1, 4, 3)),
    Case(62, -1, "Z", "I", (125000, *7 * (-2147483648,)), extra=(1, 51)),
    Case(63, -1, "E", "I", (2, 0, 6, 0), put("spindle.1.motion", SpindleMotion.STOP)),
    Case(64, -1, "E", "I", (42, 0, 48), put("spindle.1.gear_range", 43)),
    Case(65, -1, "E", "I", (3, 0, 1), put("spindle.3.group", 4)),
    Case(66, -1, "E", "I", (1, 0, 0), put("spindle.1.automatic_gear", False)),
    Case(67, -1, "E", "I", (0, 0, 1), put("spindle.1.gear_switching", True)),
    Case(68, 1, "E", "I", (0, 1), put("channel.1.skip", (True, True))),
    Case(69, 1, "E", "I", (1, 0), put("channel.1.optional_stop", (True, True))),
    Case(70, 1, "I", "I", (1,)),
    Case(71, 1, "Z", "R", (31.5, 21.5)),
    Case(72, 1, "Z", "R", (32.5, 22.5)),
    Case(73, -1, "Z", "R", (61.5, 63.5, 65.5, 67.5, 69.5, 71.5)),
    Case(73, 2, "Z", "R", (65.5, 69.5)),
    Case(74, -1, "Z", "R", (62.25, 64.75, 66.75, 68.75, 70.75, 72.75)),
    Case(74, 1, "Z", "R", (62.25, 64.75)),
    Case(75, 1, "Z", "R", (33.5, 23.5)),
    Case(76, 1, "S", "R", (34.5, 24.5)),
    Case(77, 1, "S", "R", (35.5, 25.5)),
    Case(78, 1, "E", "S", f"R       {Z}X       {Z}", coordinate("name", "Q")),
    Case(79, 1, "Z", "I", (0, 0)),
    Case(80, 1, "E", "I", (0, 1), put("axis.2.referenced", True)),
    Case(81, 1, "E", "I", (2, 1, 3), coordinate("unit", Unit.INCH)),
    Case(82, 1, "E", "I", (2, 2, 1), fewer_coordinates),
    Case(83, 1, "Z", "R", (36.5, 26.5)),
    Case(87, 2, "E", "I", (15,), put("channel.2.dwell", False)),
    Case(89, 1, "E", "R", (0.25, 0.75), coordinate("correction", 0.5)),
    Case(90, 1, "E", "I", (1, 0), coordinate("correction_active", True)),
]  # fmt: skip
OF_VALUES = {
    3: "elem.1 elem.2 elem.3", 6: "val.0 val.1", 18: "val.0", 26: "val.0 val.1", 29: "val.1", 31: "val.10",
    32: "elem.1 elem.2", 39: "val.1", 40: "val.1", 43: "val.n val.-1 val.-3", 44: "elem.1 elem.2 elem.3",
    45: "elem.1 elem.2", 46: "elem.1 elem.2 elem.3", 47: "val.0 val.1", 51: "elem.1 elem.2",
    52: " ".join(f"elem.{n}" for n in range(1, 9)), 53: "val.0 val.1 val.2 val.3",
    54: " ".join(f"elem.{n}" for n in range(1, 7)), 58: "val.n val.-1", 61: "val.1 val.2 val.3",
    62: "val.-2147483648", 63: "val.0 val.2 val.6", 66: "val.1", 68: "elem.1 elem.2", 69: "elem.1 elem.2", 70: "val.1",
    81: "val.1 val.2 val.3", 82: "elem.1 elem.2 elem.3",
}  # fmt: skip
"""Rows that the data of a case show besides that of the service."""
NOT_SIMULATED = (41, 49, 65, 67, 89, 90)
NARROWER = {"D": "R", "R": "I", "I": "S", "S": "I"}


def rows(number: int, *more: str) -> pytest.MarkDecorator:
    """Return the claims of a service and of rows below it, of those that a living control shows too."""
    shown = () if number in NOT_SIMULATED else ("", *(f".{each}" for each in more))
    return pytest.mark.covers("cpl.MCODS", *(f"cpl.MCODS.{number}{each}" for each in shown))


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(
            case,
            id=f"{case.number} of {case.channel}",
            marks=rows(case.number, *OF_VALUES.get(case.number, "").split()),
        )
        for case in CASES
    ],
)
@pytest.mark.covers("cpl.MCODS.refresh", "cpl.MCODS.buffertype", "cpl.ncs.1", "cpl.ncs.0")
def test_a_data_service_supplies_its_data_when_the_manual_says(case: Case) -> None:
    asking = Asking()
    image = asking.image
    expected = case.expected
    size = len(expected)
    values = asking.values(case.number, case.channel, case.kind, size, *case.extra)
    assert values == (expected if isinstance(expected, str) else list(expected))
    with pytest.raises(Fault, match="INVALID PARAMETER"):
        asking(case.number, case.channel, variable(NARROWER[case.kind], size), size, *case.extra)
    assert asking(case.number, 9, variable(case.kind, size), size, *case.extra) == 1

    buffer = variable(case.kind, size)
    asking.version.value = 0
    assert asking(case.number, case.channel, buffer, size, *case.extra) == 0
    kept = asking.version.value
    assert kept
    again = asking(case.number, case.channel, buffer, size, *case.extra)
    if case.refresh in "-I":
        assert again == 0
        return
    assert again is BLOCKED
    image.cycle += 1
    again = asking(case.number, case.channel, buffer, size, *case.extra)
    assert (again is BLOCKED) == (case.refresh != "Z")
    if case.refresh == "Z":
        assert asking.version.value != kept
        return
    image.channels[1].blocks += 1
    image.channels[2].blocks += 1
    again = asking(case.number, case.channel, buffer, size, *case.extra)
    assert (again is BLOCKED) == (case.refresh != "S")
    if case.refresh == "E":
        assert case.change is not None
        case.change(image)
        assert asking(case.number, case.channel, buffer, size, *case.extra) == 0
        assert asking.values(case.number, case.channel, case.kind, size, *case.extra) != values


@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.39", "cpl.MCODS.refresh", "cpl.MCODS.refresh.E")
def test_a_change_between_two_calls_ends_the_wait_even_if_it_was_taken_back() -> None:
    asking = Asking()
    buffer = Field("I", (1,))
    assert asking(39, 2, buffer, 1) == 0
    assert asking(39, 2, buffer, 1) is BLOCKED
    assert asking.server.is_awake
    for dwell in (False, True):
        asking.image.channels[2].dwell = dwell
        asking.server.look()
        assert not asking.server.is_awake  # they are new already: nothing is left to note
    assert asking(39, 2, buffer, 1) == 0
    assert buffer[1] == 1
    assert asking(39, 2, buffer, 1) is BLOCKED
    assert asking.server.is_awake


@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.refresh")
def test_versions_of_other_data_do_not_make_a_call_wait() -> None:
    asking = Asking()
    buffer = Field("R", (8,))
    for number in (7, 3, 12, 7):
        before = asking.version.value
        assert asking(number, 1, buffer, 3) == 0
        assert asking.version.value != before


@pytest.mark.covers("cpl.MCODS.30")
def test_the_version_is_ignored_for_the_main_program_and_31_bytes_hold_it() -> None:
    asking = Asking()
    asking.image.channels[1].program = "/usr/user/a_rather_long_one.cnc"
    buffer = CharacterField(31)
    for _ in range(3):
        assert asking(30, 1, buffer, 31) == 0
    assert buffer.text == "/usr/user/a_rather_long_one.cnc"
    assert asking(30, 1, buffer, 9) == 0
    assert buffer.text == "/usr/user"


@pytest.mark.parametrize(
    ("inch", "kinds", "value"),
    [
        pytest.param(True, "linear", 0, marks=rows(18, "val.0")),
        pytest.param(False, "linear", 1, marks=rows(18, "val.1")),
        pytest.param(True, "rotary", 2, marks=rows(18)),
        pytest.param(True, None, 3, marks=rows(18)),
    ],
)
def test_the_type_of_programming_follows_the_axes_of_the_channel(inch: bool, kinds: Any, value: int) -> None:
    image = system()
    image.channels[1].inch = inch
    for axis in image.channel_axes(1):
        axis.kind = kinds or axis.kind
        axis.channel = 1 if kinds else None
    assert Asking(image).values(18, 1, "I", 1) == [value]


MODES = [
    ("NONE", 0), ("JOG", 1), ("REFERENCE", 2), ("MDI", 4), ("AUTOMATIC", 5), ("PROGRAM_BLOCK", 6),
    ("SINGLE_STEP", 7), ("SINGLE_BLOCK", 10), ("RETURN_TO_PATH", 11), ("DEBUG_BLOCK", 12), ("DEBUG_AUTOMATIC", 13),
]  # fmt: skip


@pytest.mark.covers("cpl.MCODS.48")
@pytest.mark.parametrize(
    ("name", "number"),
    [
        pytest.param(name, number, marks=rows(31, f"val.{number}") if number != 11 else rows(48))
        for name, number in MODES
    ],
)
def test_modes_have_the_numbers_of_the_manual(name: str, number: int) -> None:
    asking = Asking()
    asking.image.channels[1].mode = Mode[name]
    assert asking.values(31, 1, "I", 1) == [number]
    if number < 12:
        assert asking.values(48, 1, "I", 2) == [number, number]


SAVS = {
    "INACTIVE": 1, "READY": 2, "ACTIVE": 3, "ERROR": 6, "RESET": 8, "PREPARING": 9, "CANCELLING": 10, "AT_START": 11,
    "BUFFER_EMPTY": 12,
}  # fmt: skip
IPOS = {"RUNNING": 1, "RUNNING_DOWN": 2, "STOPPED": 3}


@pytest.mark.covers(
    "cpl.MCODS.32",
    "cpl.MCODS.32.elem.1",
    "cpl.MCODS.32.elem.2",
    "cpl.MCODS.32.sav.1",
    "cpl.MCODS.32.sav.2",
    "cpl.MCODS.32.sav.3",
    "cpl.MCODS.32.sav.6",
    "cpl.MCODS.32.sav.8",
    "cpl.MCODS.32.sav.11",
    "cpl.MCODS.32.sav.12",
    "cpl.MCODS.32.ipo.1",
    "cpl.MCODS.32.ipo.2",
    "cpl.MCODS.32.ipo.3",
)
def test_states_have_the_numbers_of_the_manual() -> None:
    asking = Asking()
    for (sav, number), (ipo, other) in itertools.product(SAVS.items(), IPOS.items()):
        asking.image.channels[1].sav, asking.image.channels[1].ipo = Sav[sav], Ipo[ipo]
        assert asking.values(32, 1, "I", 2) == [number, other]


@rows(6, "val.0", "val.1")
def test_an_axis_is_in_position_in_its_window_without_a_travel_command() -> None:
    image = system()
    one, other = image.axes[1], image.axes[2]
    one.in_window, one.travel = True, True
    other.in_window, other.travel = True, False
    assert Asking(image).values(6, -1, "I", 2) == [0, 1]
    one.travel = False
    assert Asking(image).values(6, -1, "I", 2) == [1, 1]
    one.in_window = False
    assert Asking(image).values(6, -1, "I", 2) == [0, 1]


FLAGS = [
    (26, -1, "axis.2.referenced", 1, 0, 1),
    (29, 0, "test_mode", 0, 1, 0),
    (39, 2, "channel.2.dwell", 0, 1, 0),
    (40, 2, "channel.2.auxiliary_waits", 0, 1, 0),
    (41, 2, "channel.2.transfer_inhibit", 0, 1, 0),
    (47, 1, "axis.2.travel", 1, 0, 1),
    (49, 1, "axis.2.feed_inhibit", 1, 1, 0),
    (66, -1, "spindle.1.automatic_gear", 0, 1, 0),
    (67, -1, "spindle.1.gear_switching", 0, 0, 1),
    (70, 1, "channel.1.reselection", 0, 1, 0),
]


@pytest.mark.parametrize(
    ("number", "channel", "place", "index", "before", "after"),
    [
        pytest.param(
            *row,
            id=str(row[0]),
            marks=rows(row[0], *(f"val.{each}" for each in row[4:] if row[0] != 66)),
        )
        for row in FLAGS
    ],
)
def test_states_are_1_and_0(
    number: int, channel: int, place: str, index: int, before: int, after: int
) -> None:
    asking = Asking()
    values = asking.values(number, channel, "I", index + 1)
    assert values is not None
    assert values[index] == before
    put(place, bool(after))(asking.image)
    values = asking.values(number, channel, "I", index + 1)
    assert values is not None
    assert values[index] == after


WAITS = [
    (0, "DWELL"), (1, "AUXILIARY"), (2, "TRANSFER_INHIBIT"), (3, "FEED_ZERO"), (4, "PROGRAM_STOP"),
    (5, "FEED_HOLD"), (6, "FEED_INHIBIT"), (7, "CUSTOMER_INHIBIT"), (8, "SYNCHRONOUS_STOP"),
    (9, "AXIS_EXCHANGE"), (10, "PERMANENT_VARIABLE"), (11, "SIGNAL_ACTIVE"), (12, "SIGNAL_OR_TIME"),
    (13, "DATA_SERVICE"),
]  # fmt: skip
SHOWN_WAITS = (0, 1, 3, 4, 5, 12, 13)
DERIVED = {
    0: ("dwell", True), 1: ("auxiliary_waits", True), 2: ("transfer_inhibit", True), 3: ("potentiometer", 0.0),
    6: ("feed_inhibit", True),
}  # fmt: skip


@pytest.mark.parametrize(
    ("bit", "name"),
    [
        pytest.param(bit, name, marks=rows(87, *([f"bit.{bit}"] if bit in SHOWN_WAITS else [])))
        for bit, name in WAITS
    ],
)
def test_a_waiting_channel_says_why(bit: int, name: str) -> None:
    asking = Asking()
    channel = asking.image.channels[1]
    asking.image.axes[2].feed_inhibit = False
    assert asking.values(87, 1, "I", 1) == [0]
    if bit in DERIVED:
        setattr(channel, *DERIVED[bit])
    else:
        channel.other_waits = Wait[name]
    assert asking.values(87, 1, "I", 1) == [2**bit]


def test_a_channel_waits_for_the_feed_inhibit_of_its_axes_only() -> None:
    asking = Asking()
    assert asking.values(87, 1, "I", 1) == [64]
    asking.image.axes[2].channel = None
    assert asking.values(87, 1, "I", 1) == [0]


@rows(87, "bit.13")
def test_a_channel_that_waits_in_mcods_shows_it() -> None:
    asking = Asking()
    mine = Coupling(asking.server, asking.image, 1)
    version, buffer = Box("V%", "I", 0), Field("I", (2,))
    assert mine.mcods(32, 2, version, buffer, 2) == 0
    assert mine.mcods(32, 2, version, buffer, 2) is BLOCKED
    asking.image.axes[2].feed_inhibit = False
    assert asking.values(87, 1, "I", 1) == [8192]
    asking.image.channels[2].sav = Sav.ACTIVE
    assert mine.mcods(32, 2, version, buffer, 2) == 0
    assert buffer[1] == 3
    assert asking.values(87, 1, "I", 1) == [0]
    assert mine.mcods(32, 2, version, buffer, 2) is BLOCKED
    mine.release()
    assert asking.values(87, 1, "I", 1) == [0]


MOTIONS = [
    "NONE",
    "CLOCKWISE",
    "CLOCKWISE_COOLANT",
    "COUNTER_CLOCKWISE",
    "COUNTER_CLOCKWISE_COOLANT",
    "STOP",
    "ORIENTATION",
]


@pytest.mark.parametrize(
    ("value", "name"),
    [pytest.param(value, name, marks=rows(63, f"val.{value}")) for value, name in enumerate(MOTIONS)],
)
def test_movements_of_spindles_have_the_numbers_of_the_manual(value: int, name: str) -> None:
    asking = Asking()
    asking.image.spindles[3].motion = SpindleMotion[name]
    assert asking.values(63, -1, "I", 8) == [2, 0, value, 0, 0, 0, 0, 0]


@rows(64)
@pytest.mark.parametrize(
    "value",
    [40, 41, 42, 43, 44, 48],
)
def test_gear_ranges_are_passed_on(value: int) -> None:
    asking = Asking()
    asking.image.spindles[3].gear_range = value
    assert asking.values(64, -1, "I", 3) == [42, 0, value]


@pytest.mark.parametrize("value", range(5))
def test_groups_of_spindles_are_passed_on(value: int) -> None:
    asking = Asking()
    asking.image.spindles[1].group = value
    assert asking.values(65, -1, "I", 3) == [value, 0, 1]


@pytest.mark.parametrize(
    "value", [pytest.param(value, marks=rows(54, f"type.{value}", "elem.6")) for value in range(5)]
)
def test_the_compensation_type_stands_sixth(value: int) -> None:
    asking = Asking()
    asking.image.channels[1].tool.kind = value
    assert asking.values(54, 1, "R", 6) == [5.5, 31.0, 11.0, 21.0, 45.5, float(value)]
    asking.image.channels[1].tool = ToolCompensation()
    assert asking.values(54, 1, "R", 6) == [0.0] * 6


@rows(52, *(f"elem.{n}" for n in range(1, 9)))
def test_external_shifts_stand_in_the_order_of_the_logical_axes() -> None:
    image = system()
    for number in range(1, 12):
        image.axes.setdefault(number, type(image.axes[1])(number, f"A{number}"))
        image.axes[number].channel = 1
        image.axes[number].kind = "linear"
        image.axes[number].external_shift = number + 0.5
    expected: list[object] = [1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5, None]
    assert Asking(image).values(52, 1, "R", 9) == expected


@rows(9, "val.-1")
@rows(11, "val.-1")
@rows(51, "elem.1", "elem.2")
@pytest.mark.covers("cpl.MCODS.10", "cpl.MCODS.12", "cpl.MCODS.13", "cpl.MCODS.14")
def test_without_compensation_numbers_are_minus_1_and_tables_three_blanks() -> None:
    asking = Asking()
    assert asking.values(9, 2, "I", 1) == [-1]
    assert asking.values(11, 2, "I", 1) == [-1]
    assert asking.values(10, 2, "R", 1) == [0.0]
    assert asking.values(12, 2, "R", 1) == [0.0]
    assert asking.values(13, 2, "S", 20) == "   "
    assert asking.values(14, 2, "S", 20) == "   "
    assert asking.values(51, 2, "R", 2) == [0.0, 0.0]


@rows(81, "val.0", "val.1", "val.2", "val.3")
def test_coordinates_have_units() -> None:
    asking = Asking()
    coordinate("unit", Unit.INCH)(asking.image)
    assert asking.values(81, 1, "I", 3) == [2, 0, 3]
    assert asking.values(81, 2, "I", 2) == [1, 2]


@rows(53, "val.0", "val.1", "val.2", "val.3")
def test_the_unit_of_an_axis_depends_on_what_it_does() -> None:
    image = system()
    image.channels[1].inch = False
    assert Asking(image).values(53, -1, "I", 2) == [1, 1]
    image.channels[1].mode = Mode.JOG
    assert Asking(image).values(53, -1, "I", 2) == [0, 1]
    assert Asking(image).values(53, -1, "I", 8) == [0, 1, 1, 3, 2, 2, 4, 0]
    image.axes[8].mode = Mode.NONE
    assert Asking(image).values(53, -1, "I", 8) == [0, 1, 1, 3, 2, 2, 4, 1]


@rows(28)
def test_a_message_has_80_characters_at_most() -> None:
    asking = Asking()
    asking.image.channels[1].message = "MEASURE " * 12
    text = asking.values(28, 1, "S", 80)
    assert text == "MEASURE " * 10


@rows(55)
@rows(56)
@rows(57)
@pytest.mark.covers("cpl.ncs.24", "cpl.ncs.18")
def test_drives_are_asked_by_physical_axis() -> None:
    asking = Asking()
    asking.image.axes[5].drive.motor = "M" * 50
    asking.image.axes[5].drive.version = "V5"
    asking.image.axes[5].drive.controller = "C5"
    assert asking.values(57, -1, "S", 60, 5) == "M" * 40
    assert asking.values(55, -1, "S", 60, 5) == "V5"
    assert asking.values(56, -1, "S", 60, 5) == "C5"
    assert asking.values(57, -1, "S", 60, 0) == "MKD071B"
    for number in (55, 56, 57):
        asking.version.value = 0
        assert asking(number, -1, CharacterField(60), 60, 4) == 24
        assert asking(number, -1, CharacterField(60), 60) == 18


@rows(62)
@pytest.mark.covers("cpl.ncs.18")
def test_a_value_of_the_cyclic_telegram_is_asked_by_its_id() -> None:
    asking = Asking()
    assert asking.values(62, -1, "I", 1, 1, 40) == [4711]
    assert asking.values(62, -1, "I", 1, OMITTED, 51) == [125000]
    asking.version.value = 0
    assert asking(62, -1, Field("I", (1,)), 1, 1) == 18


@rows(42)
@pytest.mark.covers("cpl.ncs.18", "cpl.ncs.102")
def test_customers_data_are_selected_by_a_number_of_16_bits() -> None:
    asking = Asking()
    asking.image.customer[1, 0] = "SERIAL 0815"
    asking.image.customer[2, 65535] = (77,)
    assert asking.values(42, 1, "S", 20, 0) == "SERIAL 0815"
    assert asking.values(42, 2, "I", 1, 65535) == [77]
    asking.version.value = 0
    assert asking(42, 1, Field("I", (1,)), 1, 65536) == 18
    assert asking(42, 1, Field("I", (1,)), 1) == 18
    assert asking(42, 1, Field("I", (1,)), 1, 3) == 102


@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.34", "cpl.ncs.102")
@pytest.mark.parametrize(
    "number",
    [-1, 0, 17, 21, 22, 34, 84, 85, 86, 88, 91],
)
def test_what_the_manual_does_not_describe_is_not_available(number: int) -> None:
    asking = Asking()
    buffer = Field("I", (3,))
    assert asking(number, -1, buffer, 3) == 102
    assert buffer[1] is None
    assert asking.version.value == 0


@pytest.mark.covers("cpl.MCODS", "cpl.ncs.1", "cpl.MCODS.7", "cpl.MCODS.33", "cpl.MCODS.1")
@pytest.mark.parametrize(("number", "channel"), [(7, -1), (7, 0), (7, 3), (33, 0), (33, 3), (1, 3), (1, -2)])
def test_a_channel_that_does_not_exist_is_refused(number: int, channel: int) -> None:
    asking = Asking()
    buffer = CharacterField(9) if number == 33 else Field("D", (6,))
    assert asking(number, channel, buffer, 6) == 1
    assert asking.version.value == 0


@pytest.mark.covers("cpl.ncs.100", "cpl.ncs.101", "cpl.MCODS", "cpl.MCOPS")
def test_a_broken_connection_and_a_strange_message_are_told() -> None:
    asking = Asking()
    stranger = Coupling(asking.server, magic=4711)
    version, buffer = Box("V%", "I", 0), Field("R", (1,))
    assert stranger.mcods(7, 1, version, buffer, 1) == 100
    assert stranger.mcops(6, 1) == 100
    asking.server.connected = False
    assert asking(7, 1, buffer, 1) == 101
    assert asking.coupling.mcops(6, 1) == 101
    assert buffer[1] is None
    asking.server.connected = True
    assert asking(7, 1, buffer, 1) == 0


@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.buffertype", "cpl.err.INVALID_FIELD_LIMIT")
@pytest.mark.parametrize(
    ("number", "buffer", "size", "what"),
    [
        (1, Field("R", (6,)), 6, "INVALID PARAMETER"),
        (3, Field("I", (3,)), 3, "INVALID PARAMETER"),
        (3, Field("R", (3, 2)), 3, "INVALID PARAMETER"),
        (3, Field("B", (3,)), 3, "INVALID PARAMETER"),
        (28, Box("Q$", "S", None), 80, "INVALID PARAMETER"),
        (28, Field("S", (3, 80)), 80, "INVALID PARAMETER"),
        (3, Field("R", (3,)), 4, "INVALID FIELD LIMIT"),
        (3, Field("R", (3,)), 0, "INVALID FIELD LIMIT"),
        (28, CharacterField(79), 80, "INVALID FIELD LIMIT"),
        (7, Box("Q", "R", None), 2, "INVALID FIELD LIMIT"),
    ],
)
def test_the_buffer_has_to_fit_the_data(number: int, buffer: Variable, size: int, what: str) -> None:
    asking = Asking()
    with pytest.raises(Fault, match=what):
        asking(number, -1 if number == 1 else 1, buffer, size)


@pytest.mark.covers("cpl.MCODS.buffertype", "cpl.MCODS.45", "cpl.MCODS.45.elem.1", "cpl.MCODS.32")
def test_whole_numbers_go_into_wider_variables_and_single_ones_into_simple_variables() -> None:
    asking = Asking()
    wide = Field("D", (2,))
    assert asking(32, 1, wide, 2) == 0
    assert [wide[1], wide[2]] == [2.0, 2.0]
    assert isinstance(wide[1], float)
    simple = Box("N", "R", None)
    assert asking(45, -1, simple, 1) == 0
    assert simple.value == 6.0


@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.refresh")
@pytest.mark.parametrize(
    "version", [Box("V", "R", None), Box("V!", "D", 0.0), Box("V", "R", 1.5), Box("V?", "B", True)]
)
def test_the_version_has_to_be_an_initialised_integer_or_real(version: Box) -> None:
    coupling = Asking().coupling
    with pytest.raises(Fault, match="INVALID PARAMETER"):
        coupling.mcods(7, 1, version, Box("B", "R", None), 1)


@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.refresh")
def test_versions_fit_into_a_real_variable() -> None:
    asking = Asking()
    asking.server.ledger.last = 2**24 - 2
    buffer = Field("R", (1,))
    assert asking(7, 1, buffer, 1) == 0
    assert asking.version.value == 2**24 - 1
    asking.image.cycle += 1
    assert asking(7, 1, buffer, 1) == 0
    assert asking.version.value == 1


CATEGORIES = {
    "Positions": "1 2 35 38 4 37 16 23",
    "Speed and spindle speed": "3 24 27 5 36 19 20 25",
    "States": "6 29 26 39 40 41 47 49 32",
    "Potentiometers": "7 8 50",
    "Compensations": "9 10 11 12 13 14 15 51 52 54",
    "Operation modes": "31 48",
    "System structure": "34 44 45 33 59 60 43 58 62",
    "Units of measurement": "61 53 18",
    "Spindles": "63 64 65 66 67",
    "Drive": "55 56 57",
    "Miscellaneous": "28 46 42 68 69 70",
}


@pytest.mark.parametrize(
    ("category", "numbers"),
    [
        pytest.param(name, numbers, marks=pytest.mark.covers(f"cpl.MCODS.cat.{name.replace(' ', '_')}"))
        for name, numbers in CATEGORIES.items()
    ],
)
def test_the_overview_lists_what_the_control_answers(category: str, numbers: str) -> None:
    listed = [int(number) for number in numbers.split()]
    beyond = [30, 87] if category == "Miscellaneous" else []  # which the manual's list leaves out
    assert list(OVERVIEW[category]) == [*listed, *beyond]
    asking = Asking()
    asking.image.customer[1, 1] = (1, 2)
    for number in listed:
        answers = set()
        for kind in "DRIS":
            asking.version.value = 0
            try:
                answers.add(
                    asking(number, 1, variable(kind, 144), 144, *((1, 51) if number in LONGER else ()))
                )
            except Fault:
                continue
        assert answers == ({102} if number == 34 else {0})


LONGER = (42, 55, 56, 57, 62)
