"""SD and SDR: system data by group and indices (Manual 003, 4.9 and 4.10)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from polycnc.controllers.bosch.system import Area, AxisCoupling, Moment, SystemData
from polycnc.errors import ProgramError
from polycnc.nc.cpl import Fault
from support.cpl_host import Ran, RecordingHost


def data() -> SystemData:
    """Channel 2 has the physical axes 4, 2, 7 at preparation and 4, 2 while blocks are executed."""
    programmed = Moment(
        frozenset((3, 70, 91, 66, 543, 94, 42, 7, 19, 9, 15, 57, 155, 259, 60, 38, 62, 65, 68, 745, 115, 160)),
        850.0, (2, 7), (7, 4), (1.5, -2.5, 3.25, 4.0, 5.0, 6.0, 7.0, 8.75),
        (0.25, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 0.5),
        {1: (1, 3), 2: (4, 2, 7)}, {1: 2500.0, 2: 1200.0, 5: 333.0}, {1: 4, 2: 0, 5: 19},
    )  # fmt: skip
    active = Moment(
        frozenset((1, 71, 90, 95, 40, 6, 17, 8, 14, 54, 153, 253, 67, 39, 61, 64, 69, 146, 114, 167)),
        1001.0, (4, 2), (2, 7), (11.5, -12.5, 13.0, 14.0, 15.0, 16.0, 17.0, 18.25),
        (2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.5),
        {1: (1, 3, 7), 2: (4, 2)}, {1: 2000.0, 2: 900.0, 5: 300.0}, {1: 3, 2: 19, 5: 0},
    )  # fmt: skip
    return SystemData(
        2, programmed, active, block_function=4, feed_override=83.0, rapid=24000.0,
        spindle_overrides={1: 90.0, 2: 70.0, 5: 55.5}, actual_rpm={1: 1797.0, 2: 631.0, 5: 165.0}, machining_mode=1,
        language=33, axis_names={"YP": 2, "CP": 4, "FREE": 9}, logical_names={(2, "C"): 1, (1, "Z"): 2},
        tangential=(3, 6, 12.5, -7.25),
        areas=[Area(True, 1, (10.0, 20.0), (5.0, 6.0)), Area(False, 2, (-30.0, 40.0), (7.0, 8.0)),
               Area(True, 2, (51.0, 61.0), (71.0, 81.0))],
        precision=(13.25, 4.75), couplings={3: AxisCoupling(5, 17.25, -3.0, 9.0)},
        search_positions={2: -45.125}, machining_axes=frozenset((1, 2, 3)),
    )  # fmt: skip


def _claim(function: str, row: str) -> pytest.MarkDecorator:
    rows = () if row in UNCLAIMED else (f"cpl.{function}.{row}",)
    return pytest.mark.covers(f"cpl.{function}", *rows)


UNCLAIMED = {
    "131.1",
    "131.2",
    "131.3",
    "131.4",
    "328",
    "328.1",
    "328.2",
    "200.11.i",
    "200.12.i",
    "200.21.i",
    "200.22.i",
    "581.0.m",
    "581.s.0",
    "581.s.1",
    "581.s.2",
    "581.s.3",
}
"""What no program can program here: read all the same, and 0 in a running control."""
SD = [
    ("2.1", (2, 1), 83), ("2.3", (2, 3), 90), ("2.4", (2, 4), 70), ("5.1.1", (5, 1, 1), 831),
    ("5.2.1", (5, 2, 1), 24000),
    ("5.3.1", (5, 3, 1), 1800), ("5.4.1", (5, 4, 1), 630), ("5.1.2", (5, 1, 2), 850), ("5.3.2", (5, 3, 2), 2500),
    ("5.4.2", (5, 4, 2), 1200), ("5.3.3", (5, 3, 3), 1797), ("5.4.3", (5, 4, 3), 631), ("8", (8,), 2), ("9", (9,), 0),
    ("10.1.1", (10, 1, 1), 7), ("10.1.2", (10, 1, 2), 4), ("10.2.1", (10, 2, 1), 2), ("10.2.2", (10, 2, 2), 7),
    ("11.1.1", (11, 1, 1), 2), ("11.2.1", (11, 2, 1), 7), ("11.1.2", (11, 1, 2), 4), ("11.2.2", (11, 2, 2), 2),
    ("12.1", (12, 1), 3), ("12.2", (12, 2), 4), ("12.3", (12, 3), 19), ("12.4", (12, 4), 0), ("13", (13,), 1),
    ("14", (14,), 33), ("15", (15,), 0), ("20.1", (20, 1), 3), ("20.1", (20,), 3), ("20.2", (20, 2), 2),
    ("21.n.1", (21, 1, 1), 2), ("21.n.1", (21, 1), 2), ("21.n.1", (21, 2, 1), 3), ("21.n.2", (21, 1, 2), 3),
    ("22.m.1", (22, 7, 1), 3), ("22.m.1", (22, "YP"), 2), ("22.m.1", (22, 1), 0), ("22.m.2", (22, 2, 2), 2),
    ("22.m.2", (22, 7, 2), 0), ("23.m.1", (23, 3, 1), 7), ("23.m.1", (23, "C"), 4), ("23.m.2", (23, 3, 2), 0),
    ("23.m.2", (23, 1, 2), 4), ("24.m.n.1", (24, 2, 1, 1), 3), ("24.m.n.1", (24, "Z", 1), 3),
    ("24.m.n.2", (24, 3, 1, 2), 7), ("25.m", (25, 7), 1), ("25.m", (25, "CP"), 2), ("25.m", (25, "FREE"), -1),
    ("68.1.n", (68, 1, 3), 23), ("68.2.n", (68, 2, 4), 19), ("168.1.n", (168, 1, 4), 4), ("168.2.n", (168, 2, 3), 13),
    ("268.1.n", (268, 1, 2), 10), ("268.2.n", (268, 2, 7), 8), ("131.1", (131, 1), 3), ("131.2", (131, 2), 6),
    ("200.1", (200, 1), 2), ("200.1.i", (200, 1, 2), 0), ("200.1.i", (200, 1, 3), 1), ("200.3.i", (200, 3, 2), 2),
    ("200.3.i", (200, 3, 4), 0), ("200.3.i", (200, 3, 1), 1), ("200.11.i", (200, 11, 2), -30),
    ("200.12.i", (200, 12, 3), 61), ("200.21.i", (200, 21, 1), 5), ("200.22.i", (200, 22, 2), 8),
    ("202.s", (202, 2), 70), ("205.1.s", (205, 1, 2), 630), ("205.2.s", (205, 2, 5), 333),
    ("205.3.s", (205, 3, 5), 165),
    ("212.1.s", (212, 1, 5), 0), ("212.2.s", (212, 2, 5), 19), ("328", (328,), 13), ("328.1", (328, 1), 13),
    ("328.2", (328, 2), 5), ("581.0.m", (581, 0, 5), 5), ("581.0.m", (581, 0, 3), 0), ("581.s.0", (581, 3, 0), 5),
    ("581.s.0", (581, 5, 0), 0), ("581.s.1", (581, 3, 1), 17), ("581.s.2", (581, 3, 2), -3),
    ("581.s.3", (581, 3, 3), 9),
    ("581.s.3", (581, 4, 3), 0), ("1.i.2", (1, 1, 2), 4),
]  # fmt: skip


@pytest.mark.parametrize(
    ("indices", "value"),
    [
        pytest.param(indices, value, marks=_claim("SD", row), id=f"{row} {indices}")
        for row, indices, value in SD
    ],
)
def test_integer_system_data_are_read_by_their_indices(indices: tuple[int | str, ...], value: int) -> None:
    text = ",".join(f'"{each}"' if isinstance(each, str) else str(each) for each in indices)
    system = data()
    assert Ran(f"10 #A%=SD({text})\n", RecordingHost({"SD": system.sd}))["#A%"] == value


SDR = [
    ("1.n", (1, 2), -45.125), ("1.n", (1, 3), 0.0), ("2.1", (2, 1), 83.0), ("2.3", (2, 3), 90.0),
    ("2.4", (2, 4), 70.0),
    ("202.s", (202, 5), 55.5), ("68.1.n", (68, 1, 8), 9.25), ("68.2.n", (68, 2, 8), 27.75),
    ("168.1.n", (168, 1, 2), -2.5),
    ("168.2.n", (168, 2, 2), -12.5), ("268.1.n", (268, 1, 1), 0.25), ("268.2.n", (268, 2, 8), 9.5),
    ("131.3", (131, 3), 12.5), ("131.4", (131, 4), -7.25), ("328", (328,), 13.25), ("328.1", (328, 1), 13.25),
    ("328.2", (328, 2), 4.75), ("581.0.m", (581, 0, 5), 5.0), ("581.0.m", (581, 0, 4), 0.0),
    ("581.s.0", (581, 3, 0), 5.0),
    ("581.s.1", (581, 3, 1), 17.25), ("581.s.2", (581, 3, 2), -3.0), ("581.s.3", (581, 3, 3), 9.0),
    ("581.s.1", (581, 5, 1), 0.0),
]  # fmt: skip


@pytest.mark.parametrize(
    ("indices", "value"),
    [
        pytest.param(indices, value, marks=_claim("SDR", row), id=f"{row} {indices}")
        for row, indices, value in SDR
    ],
)
def test_real_system_data_are_read_by_their_indices(indices: tuple[int, ...], value: float) -> None:
    text = ",".join(map(str, indices))
    assert Ran(f"10 #A=SDR({text})\n", RecordingHost({"SDR": data().sdr}))["#A"] == value


UNUSED = [
    ("SD.1.i.3", (1, 2, 3)), ("SD.2.2", (2, 2)), ("SD.3.1", (3, 1)), ("SD.3.2", (3, 2)), ("SD.4.1", (4, 1)),
    ("SD.4.2", (4, 2)), ("SD.6", (6, 3)), ("SD.7.1", (7, 1)), ("SD.7.2", (7, 2)), ("SD.7.3", (7, 3)),
    ("SD.16", (16, 0)), ("SD.16", (16, 1)), ("SD.16", (16,)), ("SD.17", (17,)), ("SD.17", (17, 1)), ("SD.17", (17, 32)),
    ("SD.3.1", (3,)), ("SD.4.1", (4,)), ("SD.6", (6,)), ("SD.6", (6, 1)), ("SD.6", (6, 2)), ("SD.7.1", (7,)),
    ("SDR.2.2", (2, 2, 1)), ("SDR.4", (4,)), ("SDR.5", (5,)), ("SDR.12", (12, 2)),
    ("SD.17", (17, 5)), ("SD", (1, 1, 1)), ("SD", (1, 49, 1)), ("SD", (999,)), ("SD", (8, 1)), ("SD", (68, 1, 9)),
    ("SD", (200, 1, 11)), ("SD", (22, "NONE")), ("SDR.2.2", (2, 2)), ("SDR.4", (4, 1)), ("SDR.5", (5, 1)),
    ("SDR.12", (12, 1)), ("SDR.12", (12,)), ("SDR.1.n", (1, 4)), ("SDR.1.n", (1, 9)), ("SDR", (8,)),
]  # fmt: skip


@pytest.mark.parametrize(
    ("row", "indices"), [pytest.param(*each, marks=pytest.mark.covers(f"cpl.{each[0]}")) for each in UNUSED]
)
def test_system_data_that_are_not_in_use_stop_the_program(row: str, indices: tuple[int | str, ...]) -> None:
    name = row.split(".")[0]
    text = ",".join(f'"{each}"' if isinstance(each, str) else str(each) for each in indices)
    read: Callable[..., object] = data().sd if name == "SD" else data().sdr
    with pytest.raises(ProgramError, match="INVALID PARAMETER"):
        Ran(f"10 A={name}({text})\n", RecordingHost({name: read}))


GROUPS = {
    2: (1, 3), 3: (71, 70), 4: (90, 91), 5: (-1, 66), 6: (-1, 543), 7: (95, 94), 8: (40, 42), 9: (6, 7), 10: (17, 19),
    11: (8, 9), 13: (14, 15), 17: (54, 57), 18: (153, 155), 19: (253, 259), 20: (67, 60), 21: (39, 38), 22: (61, 62),
    25: (64, 65), 26: (69, 68), 28: (146, 745), 29: (114, 115), 30: (167, 160),
}  # fmt: skip
MEMBERS = {
    2: "0 1 2 3 5 11 12 13 73", 3: "70 71", 4: "90 91 189 190 191", 5: "63 66", 6: "543", 7: "93 94 95",
    8: "40 41 42", 9: "6 7", 10: "17 18 19 20", 11: "8 9", 13: "14 15", 17: "53 54 55 56 57 58 59",
    18: "153 154 155 156 157 158 159", 19: "253 254 255 256 257 258 259", 20: "60 67", 21: "37 38 39", 22: "61 62",
    25: "64 65", 26: "68 69", 28: "145 146 245 345 445 545 645 745 845", 29: "114 115", 30: "160 167",
}  # fmt: skip


@pytest.mark.parametrize(
    "group",
    [
        pytest.param(each, marks=pytest.mark.covers(f"cpl.SD.group.{each}", "cpl.SD.1.i.1", "cpl.SD.1.i.2"))
        for each in range(2, 49)
    ],
)
@pytest.mark.covers("cpl.SD")
def test_g_functions_are_told_by_the_groups_of_the_cc_series(group: int) -> None:
    system = data()
    assert (system.sd(1, group, 1), system.sd(1, group, 2)) == GROUPS.get(group, (-1, -1))
    for code in map(int, MEMBERS.get(group, "").split()):
        system.active = replace(system.active, functions=frozenset((code,)))
        told = {each: system.sd(1, each, 1) for each in range(2, 49)}
        assert {each for each, value in told.items() if value != -1} == {group}
        assert told[group] == code


@pytest.mark.covers("cpl.SD.group.1", "cpl.SD.1.i.2")
@pytest.mark.covers("cpl.SD")
def test_group_1_tells_functions_of_one_block_in_the_next_one_only() -> None:
    system = data()
    assert system.sd(1, 1, 2) == 4
    system.block_function = 0
    assert system.sd(1, 1, 2) == 0
    with pytest.raises(Fault):
        system.sd(1, 1, 1)


@pytest.mark.covers("cpl.SD.5.1.1")
@pytest.mark.covers("cpl.SD")
def test_the_active_feed_is_rounded_up_and_whole_with_g63() -> None:
    system = data()
    assert system.sd(5, 1, 1) == 831  # 830.83
    system.feed_override = 70.0
    system.active = replace(system.active, feed=1000.0)
    assert system.sd(5, 1, 1) == 700
    system.active = replace(system.active, functions=frozenset((63,)))
    assert system.sd(5, 1, 1) == 1000


@pytest.mark.covers("cpl.SD.9")
@pytest.mark.covers("cpl.SD")
def test_a_probe_that_did_not_switch_gives_1() -> None:
    system = data()
    system.probe_missing = True
    assert system.sd(9) == 1


@pytest.mark.parametrize(
    "value",
    [pytest.param(each, marks=pytest.mark.covers(f"cpl.SD.12.val.{each}")) for each in (3, 4, 0, -1, 19)],
)
@pytest.mark.covers("cpl.SD")
def test_senses_of_rotation(value: int) -> None:
    system = data()
    senses = {} if value == -1 else {1: value}
    system.active = replace(system.active, senses=senses)
    assert (system.sd(12, 1), system.sd(12, 3), system.sd(212, 1, 1)) == (value, -1, value)


@pytest.mark.parametrize(
    "value",
    [pytest.param(each, marks=pytest.mark.covers(f"cpl.SD.13.val.{each}")) for each in (0, 1, 2, 10, 11)],
)
@pytest.mark.covers("cpl.SD", "cpl.SD.13")
def test_the_machining_mode_is_told(value: int) -> None:
    system = data()
    system.machining_mode = value
    assert system.sd(13) == value


@pytest.mark.covers("cpl.SD.2.3", "cpl.SD.2.4", "cpl.SD.5.3.1", "cpl.SD.5.4.2", "cpl.SD.5.3.3", "cpl.SD.15")
@pytest.mark.covers("cpl.SD")
def test_spindles_that_are_not_there_give_0() -> None:
    system = SystemData(1, test_without_motion=True)
    assert [system.sd(2, 3), system.sd(2, 4), system.sd(5, 3, 1), system.sd(5, 4, 2), system.sd(5, 3, 3)] == [
        0
    ] * 5
    assert system.sd(15) == 1
