"""Basic functions of the library on a card: parameters, bits, waits, segments, contours, events, captures."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import pytest

from polycnc.controllers.imc import imclib as lib
from support.imc_card import shows
from support.imc_network import Program

IF, Q, P1, P2, C = lib.FIFO_SEL


@pytest.fixture
def program() -> Iterator[Program]:
    yield Program()
    lib.detach()


@shows("user16b0 user16b1 user16b2 user32b0 user32b1")
@pytest.mark.covers("imc.IMC_SetParam16", "imc.IMC_SetParam32", "imc.IMC_SetParam48", "imc.type.IMC16")
@pytest.mark.covers("imc.param.gearratio")
def test_width_of_a_write_decides_which_words_change(program: Program) -> None:
    card = program.card
    program.ok(lib.IMC_SetParam32, lib.mcstgposLoc, 0x00010002, 0, IF)
    program.run(1)
    assert card.read_words(12, 0, 2) == (2, 1)
    program.ok(lib.IMC_SetParam16, lib.mcstgposLoc, 5, 0, IF)
    program.run(1)
    assert card.read_words(12, 0, 2) == (5, 1)
    program.ok(lib.IMC_SetParam48, lib.gearratioLoc, -(3 << 31), 2, IF)
    program.run(1)
    assert card.read_words(175, 2, 3) == (0x0000, 0x8000, 0xFFFE)
    assert card.read("gearratio", 2) == -1.5
    # Too wide: 32 bits at user16b0 reach user16b1, 48 bits at user32b0 the low word of user32b1.
    program.ok(lib.IMC_SetParam32, lib.user16b0Loc, -1, 0, IF)
    program.ok(lib.IMC_SetParam48, lib.user32b0Loc, 0x000300020001, 0, IF)
    program.run(1)
    assert (program.get("user16b0"), program.get("user16b1"), program.get("user16b2")) == (-1, -1, 0)
    assert (program.get("user32b0"), program.get("user32b1")) == (0x20001, 3)


@pytest.mark.covers(
    "imc.type.S16", "imc.type.S32", "imc.type.S16.16", "imc.type.S16.32", "imc.type.F16", "imc.type.R16"
)
@pytest.mark.covers(
    "imc.type.IMC16", "imc.type.IMC32", "imc.type.__int64", "imc.param.user48b2", "imc.param.user48b1"
)
@pytest.mark.covers("imc.param.user16b4", "imc.param.user32b7", "imc.param.gearratio", "imc.IMC_SetParam48")
@pytest.mark.covers("imc.IMC_GetParam16", "imc.IMC_GetParam32", "imc.IMC_GetParam48")
@pytest.mark.parametrize(
    ("name", "raw"),
    [
        ("user16b4", -12_345), ("mcstgpos", -123_456_789), ("gearoutvel", -70_001), ("gearratio", -(1 << 40) - 5),
        ("user48b2", (1 << 46) + (5 << 32) + 3), ("user48b1", -(1 << 46) - 7), ("stopfilt", -2),
        ("mcstrack", -1), ("user32b7", 2_000_000_000),
    ],
)  # fmt: skip
@pytest.mark.covers("imc.param.gearoutvel", "imc.param.mcstgpos", "imc.param.mcstrack", "imc.param.stopfilt")
def test_a_number_is_written_and_read_with_its_sign(program: Program, name: str, raw: int) -> None:
    axis = 3 if name in ("mcstgpos", "gearoutvel", "gearratio", "stopfilt", "mcstrack") else 0
    program.set(name, raw, axis)
    program.run(1)
    assert program.get(name, axis) == raw


@shows("curpos")
@pytest.mark.covers("imc.IMC_SetParam32", "imc.param.gohome", "imc.param.homepos")
def test_two_flags_beside_each_other_are_both_set_by_a_wide_write(program: Program) -> None:
    program.set("homepos", 4321)
    program.ok(lib.IMC_SetParam32, lib.gohomeLoc, -1, 0, IF)  # sethome is the next word
    program.run(1)
    assert program.get("curpos") == 4321


@shows("user16b0 user16b1")
@pytest.mark.covers(
    "imc.IMC_GetParam16", "imc.IMC_GetParam32", "imc.IMC_GetParam48", "imc.type.IMC32", "imc.type.__int64"
)
@pytest.mark.covers("imc.param.gearratio", "imc.param.mcstgpos")
def test_width_of_a_read_decides_what_is_seen(program: Program) -> None:
    program.card.write("mcstgpos", -7, axis=1)
    program.card.write("gearratio", -0.5, axis=1)
    program.card.write("user16b0", -1)
    assert lib.IMC_GetParam32(program.handle, lib.mcstgposLoc, 1) == (lib.IMC_OK, -7)
    assert lib.IMC_GetParam16(program.handle, lib.mcstgposLoc, 1) == (lib.IMC_OK, -7)
    assert lib.IMC_GetParam48(program.handle, lib.gearratioLoc, 1) == (lib.IMC_OK, -(1 << 31))
    assert lib.IMC_GetParam32(program.handle, lib.user16b0Loc, 0) == (lib.IMC_OK, 0xFFFF)
    program.card.write("user16b0", 0)
    program.card.write("user16b1", -1)
    assert lib.IMC_GetParam32(program.handle, lib.user16b0Loc, 0) == (lib.IMC_OK, -0x10000)


@pytest.mark.covers("imc.IMC_SetMulParam")
@pytest.mark.covers("imc.param.mcsgo", "imc.param.mcspos", "imc.param.mcstgpos")
def test_several_parameters_are_written_in_the_same_cycle(program: Program) -> None:
    go = [
        lib.WR_MUL_DES.of(at, axis, words, value)
        for axis in range(4)
        for at, words, value in ((lib.mcstgposLoc, 2, 500), (lib.mcsgoLoc, 1, -1))
    ]
    program.ok(lib.IMC_SetMulParam, go, len(go), Q)
    seen = []
    for _ in range(40):
        program.run(1)
        positions = {program.get("mcspos", axis) for axis in range(4)}
        assert len(positions) == 1
        seen.append(positions.pop())
    assert seen[0] >= 0
    program.rest(0, 1, 2, 3)
    assert program.get("mcspos", 3) == 500


@shows("error")
@pytest.mark.covers("imc.struct.WR_MUL_DES", "imc.param.encp")
@pytest.mark.covers("imc.IMC_GetMulParam")
def test_several_parameters_are_read_at_one_moment(program: Program) -> None:
    for axis in range(4):
        program.card.write("encp", -100_000 * axis, axis=axis)
        program.card.write("error", axis, axis=axis)
    errors = [lib.WR_MUL_DES.of(lib.errorLoc, axis) for axis in range(4)]
    places = [lib.WR_MUL_DES.of(lib.encpLoc, axis, 2) for axis in range(4)]
    program.ok(lib.IMC_GetMulParam, errors + places, 8)
    assert [each.data[0] for each in errors] == [0, 1, 2, 3]
    assert [each.value for each in places] == [0, -100_000, -200_000, -300_000]
    assert places[1].data[0] + (places[1].data[1] << 16) == -100_000 & 0xFFFFFFFF


@pytest.mark.covers("imc.concept.atomic_rmw", "imc.param.gio")
@pytest.mark.covers(
    "imc.IMC_SetParamBit", "imc.IMC_ORXORParam", "imc.IMC_TurnParamBit", "imc.IMC_GetParamBit"
)
def test_bits_are_changed_in_the_card(program: Program) -> None:
    program.card.write("gio", 0x00F0)
    program.ok(lib.IMC_ORXORParam, lib.gioLoc, 0x000F, 0x00F0, 0, IF)
    program.run(1)
    assert program.get("gio") == 0x000F
    program.ok(lib.IMC_SetParamBit, lib.gioLoc, 15, 1, 0, IF)
    program.ok(lib.IMC_SetParamBit, lib.gioLoc, 0, 0, 0, IF)
    program.ok(lib.IMC_TurnParamBit, lib.gioLoc, 1, 0, IF)
    program.ok(lib.IMC_TurnParamBit, lib.gioLoc, 4, 0, IF)
    program.run(4)
    assert program.get("gio") & 0xFFFF == 0x801C
    bits = [lib.IMC_GetParamBit(program.handle, lib.gioLoc, bit, 0)[1] for bit in range(16)]
    assert bits == [int(bit in (2, 3, 4, 15)) for bit in range(16)]


@shows("user16b0 user16b1")
@pytest.mark.covers("imc.IMC_WaitTime")
def test_a_wait_holds_its_queue_and_no_other(program: Program) -> None:
    program.ok(lib.IMC_WaitTime, 50, Q)
    program.set("user16b0", 1, fifo=Q)
    program.set("user16b1", 1, fifo=IF)
    program.run(1)
    assert (program.get("user16b0"), program.get("user16b1")) == (0, 1)
    shown = [program.get("qwaittime")]
    for _ in range(49):
        assert program.get("user16b0") == 0
        program.run(1)
        shown.append(program.get("qwaittime"))
    assert shown == list(range(50, 0, -1))
    program.run(2)
    assert program.get("user16b0") == 1


@pytest.mark.covers("imc.IMC_WaitTime", "imc.IMC_WaitParam", "imc.IMC_WaitParamBit", "imc.IMC_WaitParamMask")
def test_a_long_wait_is_shown_with_all_its_time(program: Program) -> None:
    for name, arguments in (
        ("IMC_WaitTime", (2_000_000_003,)),
        ("IMC_WaitParam", (lib.user16b0Loc, 5, 1_900_000_005, 0)),
        ("IMC_WaitParamBit", (lib.user16b0Loc, 5, 1, 1_800_000_007, 0)),
        ("IMC_WaitParamMask", (lib.user16b0Loc, 5, 1, 1_700_000_009, 0)),
    ):
        for fifo, shown in ((Q, "qwaittime"), (P1, "pwaittime1"), (P2, "pwaittime2")):
            program.card.write("startpath1", -1)
            program.card.write("startpath2", -1)
            program.ok(getattr(lib, name), *arguments, fifo)
            program.run(3)
            assert program.get(shown) == next(each for each in arguments if each > 1 << 20) - 2
            program.ok(lib.IMC_ClearFIFO, fifo)


@pytest.mark.covers("imc.IMC_WaitTime")
@pytest.mark.covers("imc.IMC_ClearFIFO")
@pytest.mark.parametrize("endless", [0, -1])
def test_clearing_ends_an_endless_wait(program: Program, endless: int) -> None:
    program.ok(lib.IMC_WaitTime, endless, Q)
    program.set("user16b0", 1, fifo=Q)
    program.run(3000)
    assert program.get("user16b0") == 0
    program.ok(lib.IMC_ClearFIFO, Q)
    program.run(5)
    assert (program.get("user16b0"), program.get("qfifocnt")) == (0, 0)  # what was after it is gone too
    program.set("user16b0", 2, fifo=Q)
    program.run(2)
    assert program.get("user16b0") == 2


WAITS = [  # function, what is waited for, what the word is before and what it becomes
    pytest.param("IMC_WaitParam", (-2,), 0xFFFA, 0xFFFE, marks=pytest.mark.covers("imc.IMC_WaitParam")),
    *(
        pytest.param("IMC_WaitParamBit", *each, marks=pytest.mark.covers("imc.IMC_WaitParamBit"))
        for each in (((3, 1), 0xFFF7, 0x0008), ((13, 0), 0x2400, 0x5C3F))
    ),
    pytest.param(
        "IMC_WaitParamMask",
        (0x00F6, 0x0034),
        0x1231,
        0x4A3D,
        marks=pytest.mark.covers("imc.IMC_WaitParamMask"),
    ),
]


@shows("user16b1 user16b4")
@pytest.mark.parametrize("timeout", [0, -1, 90])
@pytest.mark.parametrize(("name", "arguments", "before", "met"), WAITS)
def test_waits_for_a_parameter(
    program: Program, name: str, arguments: tuple[int, ...], before: int, met: int, timeout: int
) -> None:
    program.set("user16b4", before)
    program.run(1)
    program.ok(getattr(lib, name), lib.user16b4Loc, *arguments, timeout, 0, Q)
    program.set("user16b1", 23, fifo=Q)
    program.run(70)
    assert program.get("user16b1") == 0
    program.set("user16b4", met)
    program.run(3)
    assert program.get("user16b1") == 23


@shows("error user16b1 user16b4")
@pytest.mark.parametrize(("name", "arguments", "before", "met"), WAITS)
def test_waits_end_with_their_time_and_without_an_error(
    program: Program, name: str, arguments: tuple[int, ...], before: int, met: int
) -> None:
    program.set("user16b4", before)
    program.run(1)
    program.ok(getattr(lib, name), lib.user16b4Loc, *arguments, 57, 0, Q)
    program.set("user16b1", 23, fifo=Q)
    program.run(57)
    assert program.get("user16b1") == 0
    program.run(3)
    assert (program.get("user16b1"), program.get("error"), program.get("user16b4") & 0xFFFF) == (
        23,
        0,
        before,
    )


@shows("error user16b0 user16b1")
@pytest.mark.covers("imc.IMC_WaitParamMask")
def test_a_mask_that_cannot_be_met_ends_with_its_time(program: Program) -> None:
    program.card.write("user16b0", 0x1234)
    program.ok(lib.IMC_WaitParamMask, lib.user16b0Loc, 0x00FF, 0x1234, 50, 0, Q)
    program.set("user16b1", 1, fifo=Q)
    program.run(49)
    assert program.get("user16b1") == 0
    program.run(4)
    assert (program.get("user16b1"), program.get("error")) == (1, 0)


def prepare(program: Program, *axes: int, absolute: bool = True) -> None:
    """Prepare path space 1: a coordinate for each axis, 20 pulses/ms, 1 pulse/ms²."""
    program.set("startpath1", -1)
    program.set("pathaxisnum1", len(axes))
    for name, axis in zip("xyz", axes, strict=False):
        program.set(f"segmap_{name}1", axis)
        program.set("pathabs", -1 if absolute else 0, axis)
    program.set("pathacc1", 65536)
    program.set("segtgvel1", 20 * 65536)
    program.set("segendvel1", 0)
    program.run(20)


def follow(program: Program, *axes: int) -> list[tuple[int, ...]]:
    """Let the path run to its end; return the positions of all cycles."""
    track = []
    for _ in range(20_000):
        program.run(1)
        track.append(tuple(program.get("curpos", axis) for axis in axes))
        if program.get("pathmoving1") == 0 and program.get("PFIFOcnt1") == 0:
            return track
    raise AssertionError("the path does not end")


@shows("curpos user16b0")
@pytest.mark.covers("imc.IMC_AddLineN", "imc.IMC_AddLineNWithVel", "imc.concept.segment_blocking")
def test_lines_run_one_after_the_other_and_hold_what_comes_behind(program: Program) -> None:
    prepare(program, 1, 0)  # X is axis 1, Y is axis 0
    program.ok(lib.IMC_AddLineN, lib.PFIFOSegData.of(4000, 3000), P1)
    program.set("user16b0", 7, fifo=P1)
    fast = lib.PFIFOSegInfo.of(40 * 65536, 0, lib.PFIFOSegData.of(0, 0))
    program.ok(lib.IMC_AddLineNWithVel, fast, P1)
    track = []
    for _ in range(2000):
        program.run(1)
        track.append((program.get("curpos", 1), program.get("curpos", 0)))
        if program.get("user16b0") != 0:
            break
    speeds = [math.dist(a, b) for a, b in itertools.pairwise(track)]
    assert max(speeds) == pytest.approx(20.0, abs=1.5)  # positions are whole pulses
    assert track[-1] == (4000, 3000)
    assert all(abs(3 * x - 4 * y) <= 8 for x, y in track)
    back = follow(program, 1, 0)
    assert back[-1] == (0, 0)
    assert max(math.dist(a, b) for a, b in itertools.pairwise(back)) == pytest.approx(40.0, abs=1.5)


CENTRE = (400, -800)
START = (700, -400, 130)  # 500 from the centre, which lies on no axis
END = (0, -500, 780)  # a quarter further counter-clockwise


def arc_call(name: str, clockwise: bool) -> tuple[object, ...]:
    """Return the arguments of a function for the arc from `START` to `END`; the structures count the other way."""
    (x, y, z), speeds = END, (10 * 65536, 0) if name.endswith("WithVel") else ()
    if "ArcLine" in name:
        data = lib.PFIFOSegData.of(x, y, z, center=CENTRE, direction=0 if clockwise else -1)
        return (lib.PFIFOSegInfo.of(*speeds, data) if speeds else data,)
    return (*speeds, x, y, *((z,) if "Spiral" in name else ()), *CENTRE, int(clockwise))


@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(f"IMC_Add{kind}{speeds}", marks=pytest.mark.covers(f"imc.IMC_Add{kind}{speeds}"))
        for kind in ("Arc", "ArcLine", "Spiral")
        for speeds in ("", "WithVel")
    ],
)
@pytest.mark.covers("imc.param.mcspos")
def test_arcs(program: Program, name: str, clockwise: bool) -> None:
    third = name not in ("IMC_AddArc", "IMC_AddArcWithVel")
    for axis, place in enumerate(START):
        program.card.write("mcspos", place, axis=axis)
    prepare(program, 0, 1, *((2,) if third else ()))
    assert [program.get("mcspos", axis) for axis in range(3)] == list(START)
    program.ok(getattr(lib, name), *arc_call(name, clockwise), P1)
    track = []
    for _ in range(3000):
        program.run(1)
        track.append(tuple(program.get("mcspos", axis) for axis in range(3)))
        if program.get("pathmoving1") == 0 and program.get("PFIFOcnt1") == 0:
            break
    assert track[-1] == (END if third else (*END[:2], START[2]))
    arms = [(x - CENTRE[0], y - CENTRE[1]) for x, y, _ in track]
    assert all(abs(math.hypot(*arm) - 500) < 1.5 for arm in arms)
    angles = [math.atan2(y, x) for x, y in arms]
    turned = [math.degrees(math.remainder(b - a, math.tau)) for a, b in itertools.pairwise(angles)]
    whole = -270 if clockwise else 90
    assert sum(turned) == pytest.approx(whole, abs=1.0)
    if third:  # the third axis keeps pace with the angle
        part = sum(turned[: len(turned) // 3]) / whole
        assert track[len(turned) // 3][2] == pytest.approx(130 + 650 * part, abs=5)
    speeds = [math.dist(a[:2], b[:2]) for a, b in itertools.pairwise(track)]
    if name.endswith("WithVel"):
        assert max(speeds) == pytest.approx(10.0, abs=1.5)


@pytest.mark.covers("imc.IMC_AddLineN", "imc.IMC_AddArc")
def test_relative_segments_count_from_where_the_axes_are(program: Program) -> None:
    prepare(program, 0, 1, absolute=False)
    program.ok(lib.IMC_AddLineN, lib.PFIFOSegData.of(300, 100), P1)
    program.ok(lib.IMC_AddArc, -240, 180, -120, 90, 0, P1)  # half a circle about a point up to the left
    track = follow(program, 0, 1)
    assert track[-1] == (60, 280)
    # counter-clockwise from its lower right end: over the top right of (180, 190), 150 away
    assert max(x for x, _ in track) == pytest.approx(330, abs=2)
    assert max(y for _, y in track) == pytest.approx(340, abs=2)


@shows("curpos")
@pytest.mark.covers(
    "imc.concept.contour",
    "imc.concept.cfifo",
    "imc.param.groupnum",
    "imc.param.groupsmooth",
    "imc.param.cfifocnt",
    "imc.param.startgroup",
    "imc.param.contouring",
)
@pytest.mark.covers("imc.IMC_AddContourData")
def test_contour_points_are_spread_over_their_cycles(program: Program) -> None:
    program.set("groupnum", 3)
    for k, name in enumerate("xyz"):
        program.set(f"group_{name}", k)
    program.set("groupsmooth", 20)
    program.run(5)
    points = [(100, -40, 20)] * 9 + [(0, 0, -180)]
    values = [value for point in points for value in point]
    program.ok(lib.IMC_PutContourData, values, 30, C)
    assert program.get("cfifocnt") == 30
    program.run(10)
    assert program.get("curpos", 0) == 0
    program.set("startgroup", -1)
    program.run(2)
    first = program.get("curpos", 0)
    program.run(10)
    assert program.get("curpos", 0) - first == 50  # 100 pulses in 20 cycles are 5 a cycle
    program.run(300)
    assert [program.get("curpos", axis) for axis in range(3)] == [900, -360, 0]
    assert program.get("contouring", 0) == 0


@shows("curpos events user16b0")
@pytest.mark.covers("imc.event.CMD_CMP32i", "imc.event.CMD_SET16", "imc.concept.event_flags")
@pytest.mark.covers("imc.IMC_InstallEvent")
@pytest.mark.covers("imc.IMC_MoveVelocity")
def test_an_event_starts_something_when_a_position_is_reached(program: Program) -> None:
    reached = [
        lib.EventInfo.of(lib.CMD_CMP32i, src1=(lib.curposLoc, 0), src2=1000),
        lib.EventInfo.of(lib.CMD_SET16, lib.IMC_Edge_GreatEqu, src2=-1, dest=(lib.user16b0Loc, 0)),
    ]
    program.ok(lib.IMC_InstallEvent, reached, 2, IF)
    program.ok(lib.IMC_MoveVelocity, 10 * 65536, 0, IF)
    program.until(lambda: program.get("user16b0") != 0)
    assert 1000 <= program.get("curpos") < 1020
    assert program.get("events") == 2
    program.set("user16b0", 0)
    program.run(5)
    assert program.get("user16b0") == 0  # only once


@pytest.mark.covers("imc.concept.event_space", "imc.param.events", "imc.const.limits")
@pytest.mark.covers("imc.IMC_InstallEvent")
def test_the_card_holds_128_events(program: Program) -> None:
    event = lib.EventInfo.of(lib.CMD_ADD32i, src1=(317, 0), src2=1, dest=(317, 0))
    assert lib.IMC_InstallEvent(program.handle, [event] * 32, 32, IF) == lib.IMC_OUT_OF_RANGE
    for _ in range(4):
        program.ok(lib.IMC_InstallEvent, [event] * 31, 31, IF)
        program.run(1)
    assert lib.IMC_InstallEvent(program.handle, [event] * 5, 5, IF) == lib.IMC_OUT_OF_RANGE
    program.ok(lib.IMC_InstallEvent, [event] * 4, 4, IF)
    program.run(1)
    assert program.get("events") == 128
    assert lib.IMC_InstallEvent(program.handle, [event], 1, IF) == lib.IMC_OUT_OF_RANGE
    program.set("events", 0)
    program.run(1)
    program.ok(lib.IMC_InstallEvent, [event], 1, IF)


@shows("user16b0 user16b1")
@pytest.mark.covers("imc.IMC_GetCapData")
@pytest.mark.covers("imc.concept.rbfifo")
@pytest.mark.covers("imc.IMC_WaitTime")
def test_reading_back_needs_no_queue(program: Program) -> None:
    for fifo in (Q, P1, P2):
        program.ok(lib.IMC_WaitTime, 0, fifo)
        program.set("user16b0", 5, fifo=fifo)
    program.run(10)
    program.card.write("user16b1", 7)
    assert program.get("user16b1") == 7  # at once, while every queue waits; never IMC_RBFIFO_EMPTY
    assert program.get("user16b0") == 0
    assert lib.IMC_GetCapData(program.handle, 5, 0) == (lib.IMC_OK, [], 0, 0)


@shows("encp")
@pytest.mark.covers("imc.IMC_SetParamBit", "imc.bit.encpctr.10", "imc.concept.capfifo", "imc.param.encpctr")
@pytest.mark.covers("imc.IMC_GetCapData")
@pytest.mark.covers("imc.IMC_MoveVelocity")
def test_the_probe_captures_while_it_is_let(program: Program) -> None:
    program.ok(lib.IMC_MoveVelocity, 10 * 65536, 0, IF)
    program.run(50)
    program.card.touch_probe(0)
    program.run(1)
    assert lib.IMC_GetCapData(program.handle, 10, 0) == (lib.IMC_OK, [], 0, 0)
    program.ok(lib.IMC_SetParamBit, lib.encpctrLoc, 10, 1, 0, IF)
    program.run(1)
    places = []
    for _ in range(5):
        program.card.touch_probe(0)
        program.run(1)
        places.append(program.get("encp"))
        program.run(9)
    status, first, number, left = lib.IMC_GetCapData(program.handle, 3, 0)
    assert (status, number, left) == (lib.IMC_OK, 3, 2)
    status, rest, number, left = lib.IMC_GetCapData(program.handle, 120, 0)
    assert (status, number, left) == (lib.IMC_OK, 2, 0)
    assert first + rest == pytest.approx(places, abs=10)
    assert [b - a for a, b in itertools.pairwise(first)] == [100, 100]
