"""What a flag or an effect depends on, one condition at a time: each alone makes the difference, worked out by hand."""

from __future__ import annotations

import pytest

from polycnc.controllers.imc.core._instructions import WaitParam
from polycnc.controllers.imc.core._parameters import PARAMETERS, address
from support.imc_card import (
    FLAG,
    IFIFO,
    QFIFO,
    event,
    install,
    ready_card,
    send,
    set_now,
    setting,
    shows,
    trace,
)

QUICK = [(f"{system}{name}", 1000.0, 1) for system in ("mcs", "pcs") for name in ("accel", "decel")]


@shows("smoothing smooth moving profiling curvel pcstgvel mcstgvel")
def test_smoothing_lasts_while_increments_that_cancel_are_not_all_given() -> None:
    card = ready_card()
    set_now(card, *QUICK, ("smooth", 6, 1), ("mcstgvel", 1, 1))
    card.advance(1)
    set_now(card, ("pcstgvel", -2, 1))
    card.advance(1)  # 1 and then 1 - 2
    set_now(card, ("pcstgvel", 0, 1), ("mcstgvel", 0, 1))
    card.advance(2)
    names = ("profiling", "mcsmoving", "pcsmoving", "curvel", "smoothing", "moving")
    assert [card.read(name, 1) for name in names] == [0, 0, 0, 0, FLAG, FLAG]
    card.advance(2)  # 1 leaves the mean, -1 is in it
    assert (card.read("smoothing", 1), card.read("moving", 1)) == (FLAG, FLAG)
    card.advance(3)
    assert [card.read(name, 1) for name in (*names, "curpos")] == [0] * 7


@shows("smoothing smooth")
def test_smoothing_is_shown_whichever_of_its_sums_is_0() -> None:
    card = ready_card()
    set_now(card, *QUICK, ("smooth", 3, 1), ("mcstgvel", 2, 1))
    card.advance(1)
    set_now(card, ("pcstgvel", -3, 1))
    for _ in range(2):  # 2, -1: nothing is left to give; 2, -1, -1: the mean is 0
        card.advance(1)
        assert (card.read("smoothing", 1), card.read("moving", 1)) == (FLAG, FLAG)


@shows("moving curvel vellim run profiling mcsmoving")
def test_moving_is_set_in_the_cycle_of_a_velocity_after_which_nothing_is_planned() -> None:
    card = ready_card()
    set_now(card, ("mcsaccel", 3, 1), ("vellim", 5, 1), ("mcstgvel", 40, 1))
    card.advance(2)  # 3, then 6
    names = ("run", "profiling", "mcsmoving", "curvel", "moving", "motion")
    assert [card.read(name, 1) for name in names] == [0, 0, 0, 6, FLAG, FLAG]
    card.advance(1)
    assert [card.read(name, 1) for name in names] == [0] * 6


@shows("mcsmoving profiling moving motion engear mcsvel")
@pytest.mark.covers("imc.IMC_GearFree", "imc.concept.gear_law")
def test_a_slave_is_planned_until_it_has_the_speed_of_its_gear_and_at_rest_with_its_master() -> None:
    card = ready_card()
    set_now(card, ("mcstgvel", 8, 2), ("mcsaccel", 8, 2), ("mcsdecel", 8, 2), ("mcsaccel", 1, 1))
    set_now(card, ("gearratio", 0.5, 1), ("master", 2, 1), ("gearsrc", 4, 1), ("engear", FLAG, 1))
    names = ("mcsvel", "mcsmoving", "profiling", "moving", "engear")
    card.advance(3)
    assert [card.read(name, 1) for name in names] == [3, FLAG, FLAG, FLAG, FLAG]
    card.advance(2)
    set_now(card, ("mcstgvel", 0, 2))
    card.advance(1)
    assert [card.read(name, 1) for name in names] == [0, 0, 0, 0, FLAG]
    assert card.read("motion", 1) == 0


@shows("emstop startgroup run ena error pfifoenable")
def test_an_emergency_stop_switches_off_what_has_nothing_to_do_and_does_not_switch_it_on_again() -> None:
    card = ready_card()
    on = [("startgroup", FLAG), ("startpath1", FLAG), ("startpath2", FLAG)]
    set_now(card, *on, ("emstop", 0x2F))  # every bit but that of the stop
    card.advance(2)
    assert [card.read(name) for name, _ in on] == [FLAG] * 3
    assert [card.read(name, 3) for name in ("run", "ena", "error")] == [FLAG, FLAG, 0x2F]
    set_now(card, ("emstop", 0x10))
    card.advance(1)
    assert [card.read(name) for name, _ in on] == [0] * 3
    assert [[card.read(name, axis) for name in ("run", "ena")] for axis in range(4)] == [[0, 0]] * 4
    assert [int(card.read("error", axis)) & 0xFFFF for axis in range(4)] == [0x3F] * 4
    send(card, IFIFO, ("emstop", 0), *on)
    card.advance(3)
    assert [card.read(name, 1) for name in ("run", "ena", "error")] == [0, 0, 0x3F]
    assert [card.read(name) for name, _ in on] == [FLAG] * 3
    set_now(card, ("emstop", 0x10))
    card.advance(1)
    assert [card.read(name) for name, _ in on] == [0] * 3


# What nothing in the card reads or writes: of each axis, and of the card.
KEPT_BY_AXIS = (
    "fixvel",
    "encsctr",
    "aiod",
    "stepmod",
    "dirtime",
    "steptime",
    "psoftlim",
    "vellim",
    "homepos",
    "gearratio",
)
KEPT_BY_CARD = (
    "waitfilt",
    "waitequ",
    "eventid",
    "eventbase",
    "out1",
    "out2",
    "gio",
    "giod",
    "groupnum",
    "group_k",
)
CELLS = [f"user{width}b{k}" for width, count in ((16, 10), (32, 10), (48, 5)) for k in range(count)]


@shows(" ".join((*KEPT_BY_AXIS, *KEPT_BY_CARD, *CELLS)))
def test_what_is_kept_outlives_everything_that_clears_stops_or_refers_the_axes() -> None:
    card = ready_card()
    written: dict[tuple[str, int], int] = {}
    names = (*KEPT_BY_AXIS, *KEPT_BY_CARD, *CELLS)
    for k, name in enumerate((*names, *reversed(names))):  # each neighbour is written before and after
        each = PARAMETERS[name]
        for axis in range(4) if each.scope == "A" else (k % 4,):
            value = (0x1A51 + 97 * k + 7 * axis) << 16 * (each.words - 1) | 1 + axis
            written[name, axis if each.scope == "A" else 0] = value
            card.write_raw(each.address, value, axis, each.words)
    for name in ("sethome", "clear", "gohome", "mcsgo", "engear", "capture"):
        set_now(card, *((name, FLAG, axis) for axis in range(4)))
        card.advance(2)
    set_now(
        card,
        ("error", 0x40, 1),
        ("run", 0, 2),
        ("clrencs", 0, 3),
        ("events", 0),
        ("clearimc", 0),
        ("emstop", 0x10),
    )
    card.advance(3)
    set_now(
        card,
        ("emstop", 0),
        ("clrqfifo", 0),
        *((name, 0, axis) for name in ("error", "ena") for axis in range(4)),
    )
    card.advance(2)
    for (name, axis), value in written.items():
        each = PARAMETERS[name]
        assert card.read_raw(each.address, axis, each.words) == value, (name, axis)


@shows("moving profiling motion curvel hpause mcsdecel mcsaccel mcsvel mcsmaxvel mcsgo")
@shows("pcsdecel pcsaccel pcsvel pcsmaxvel pcsgo")
@pytest.mark.parametrize("system", ["mcs", "pcs"])
@pytest.mark.parametrize("pause", ["hpause", "haltstep"])
def test_a_move_pauses_with_its_deceleration_and_goes_on_with_its_acceleration(
    pause: str, system: str
) -> None:
    card = ready_card()
    rates = {"maxvel": 6, "accel": 2, "decel": 0.5, "dist": -4000, "go": FLAG}
    set_now(card, *((f"{system}{name}", value, 2) for name, value in rates.items()))
    card.advance(10)
    set_now(card, (pause, 0x200, 2))
    assert trace(card, f"{system}vel", 13, 2) == [-5.5 + 0.5 * k for k in range(12)] + [0]
    assert [card.read(f"{system}{name}", 2) for name in ("go", "moving")] == [FLAG, FLAG]
    assert [card.read(name, 2) for name in ("curvel", "profiling", "moving", "motion")] == [
        0,
        FLAG,
        FLAG,
        FLAG,
    ]
    set_now(card, (pause, 0, 2))
    assert trace(card, f"{system}vel", 4, 2) == [-1, -3, -5, -6]  # means of the cycles of a ramp of 2


@shows("master gearsrc engear mcsvel")
@pytest.mark.covers("imc.IMC_GearFree", "imc.concept.gear_law")
def test_an_engaged_slave_follows_another_master_or_another_of_its_parameters_at_once() -> None:
    card = ready_card()
    set_now(card, ("mcsaccel", 100, 2), ("mcsaccel", 100, 3), ("mcsaccel", 100, 1), ("mcstgvel", 8, 2))
    set_now(card, ("mcstgvel", -6, 3), ("pcstgvel", 1, 3), ("pcsaccel", 100, 3))
    card.advance(2)
    set_now(card, ("gearratio", 0.5, 1), ("master", 2, 1), ("gearsrc", 4, 1), ("engear", FLAG, 1))
    card.advance(3)
    followed = [card.read("mcsvel", 1)]
    for name, value in (("master", 3), ("gearsrc", 27), ("gearsrc", 227), ("master", 0), ("master", 2)):
        set_now(card, (name, value, 1))  # mcsvel, pcsvel, curvel
        card.advance(1)
        followed.append(card.read("mcsvel", 1))
    assert followed == [4, -3, 0.5, -2.5, 0, 4]


@shows("highvel lowvel homeseq gohome")
@pytest.mark.covers("imc.concept.homing", "imc.IMC_HomeSwitch2", "imc.IMC_HomeIndex", "imc.const.direction")
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("way", "sequence", "speeds"), [(1, 0x34, (7, -3)), (-1, 0x35, (-7, 3)), (-1, 0x09, (-7, 0))]
)
def test_speeds_of_a_search_count_without_their_sign(
    sign: int, way: int, sequence: int, speeds: tuple[int, int]
) -> None:
    card = ready_card("[[axis]]\norigin = [-2, 2]\nindex = { first = 200, pitch = 400 }\n")
    set_now(
        card,
        ("mcsaccel", 7),
        ("mcsdecel", 7),
        ("highvel", 7 * sign),
        ("lowvel", -3 * sign),
        ("mcstgpos", -90 * way),
    )
    set_now(card, ("mcsgo", FLAG))
    card.wait()
    set_now(card, ("homeseq", sequence), ("gohome", FLAG))
    seen = trace(card, "mcsvel", 80)
    assert card.read("gohome") == 0
    assert (max(seen, key=abs), min(seen) if way > 0 else max(seen)) == speeds


@shows("delayus timer ticks")
def test_what_counts_has_no_sign() -> None:
    card = ready_card()
    set_now(card, ("delayus", 3_000_000_500), ("timer", 40_000), ("ticks", 2**31 - 3))
    card.advance(5)
    assert [card.read(name) for name in ("delayus", "timer", "ticks")] == [2_999_995_500, 39_995, 2**31 + 2]
    set_now(card, ("delayus", 2500), ("timer", 2), ("ticks", 2**32 - 2))
    card.advance(3)
    assert [card.read(name) for name in ("delayus", "timer", "ticks")] == [0, 0, 1]


@shows("master synaxis gearsrc synsrc engear startsyn mcsvel")
@pytest.mark.covers("imc.const.AXISNUM", "imc.concept.gear_law", "imc.concept.sync_laws")
@pytest.mark.parametrize("nobody", [3, 4, 32767, 65535])
def test_an_axis_that_is_not_there_is_not_followed(nobody: int) -> None:
    card = ready_card("number_of_axes = 3\n")
    set_now(
        card, *((name, value, axis) for axis in (0, 2) for name, value in (("mcsaccel", 9), ("mcstgvel", 9)))
    )
    set_now(card, ("gearratio", 1, 1), ("master", nobody, 1), ("gearsrc", 4, 1), ("engear", FLAG, 1))
    card.advance(12)
    assert [card.read(name, 1) for name in ("engear", "mcsvel", "curpos")] == [FLAG, 0, 0]
    set_now(card, ("engear", 0, 1))
    card.advance(1)
    set_now(card, ("syntype", FLAG, 1), ("synaxis", nobody, 1), ("synsrc", 225, 1))
    set_now(card, ("synsrcvar", 50, 1), ("slavedist", 70, 1), ("enasyn", FLAG, 1), ("startsyn", FLAG, 1))
    card.advance(12)
    assert [card.read(name, 1) for name in ("startsyn", "mcsvel", "curpos")] == [FLAG, 0, 0]


NO_EFFECT = {
    "fixvel": -3.5, "encsctr": -1, "aiod": -1, "stepmod": 0x5A5A, "dirtime": 40_000, "steptime": -0x5A5B,
    "waitfilt": -1, "waitequ": 0x1234, "eventid": 60_000, "eventbase": 300, "out1": -1, "out2": 0x300,
    "gio": 0x7FFF, "giod": -2,
}  # fmt: skip


@shows(" ".join(NO_EFFECT))
def test_what_has_no_known_meaning_has_no_effect() -> None:
    runs = []
    for values in ({}, NO_EFFECT):
        card = ready_card(
            "number_of_axes = 3\n[[axis]]\nlimit_positive = 90\nprobe = { first = 11, pitch = 20 }\n"
            "[[axis]]\norigin = [40, 60]\nindex = { first = 43, pitch = 9 }\n[[axis]]\nlag_s = 0.003\ngain = 80.0\n"
        )
        axes = [(name, value, i) for i in range(3) for name, value in values.items()]
        set_now(card, *axes, ("aioctr", 3, 0), ("encpctr", 0x400, 0), ("mcstgvel", 6, 0), ("smooth", 3, 2))
        set_now(
            card,
            ("homeseq", 0x2C, 1),
            ("gohome", FLAG, 1),
            ("mcsdist", 300, 2),
            ("mcsgo", FLAG, 2),
            ("timer", 70),
        )
        install(card, event("ADD32i", first=317, constant=3, target=317))
        card.push(QFIFO, WaitParam(address("user16b3"), 5, 20))
        card.push(QFIFO, setting("pcstgvel", 2, 2))
        card.turn_handwheel(1, 33)
        card.advance(70)
        memory = card.state.memory.copy()
        for name in NO_EFFECT:
            each = PARAMETERS[name]
            memory[:, each.address : each.address + each.words] = 0
        runs.append((memory, card.kernel.servo.actual.copy()))
    (plain, places), (marked, others) = runs
    assert (plain == marked).all()
    assert list(places) == list(others)
    assert all(abs(place) > 20 for place in places)


@shows("vellim accellim curvel error run")
@pytest.mark.covers("imc.concept.mcs_pcs", "imc.concept.superposition")
@pytest.mark.parametrize("way", [1, -1])
def test_the_limits_of_any_motion_are_for_both_systems_together(way: int) -> None:
    names = ("curvel", "error", "run")
    for accels, goals, limits, expected in (
        ((1, 1), (3, 3), (5, 9), (6, 0x2000, 0)),  # 2, 4, 6: each alone is slow enough
        ((2, 1), (6, -3), (5, 9), (3, 0, FLAG)),  # 6 alone would be too fast
        ((2, 2), (6, 6), (99, 3), (4, 0x4000, 0)),  # from 0 to 4 at once
        ((4, 2), (12, -6), (99, 3), (6, 0, FLAG)),
    ):
        card = ready_card()
        given = zip(("mcsaccel", "pcsaccel", "vellim", "accellim"), (*accels, *limits), strict=True)
        set_now(card, *((name, value, 2) for name, value in given))
        set_now(card, ("mcstgvel", goals[0] * way, 2), ("pcstgvel", goals[1] * way, 2))
        card.advance(1 if expected[1] == 0x4000 else 3)
        assert tuple(card.read(name, 2) for name in names) == (expected[0] * way, *expected[1:])


@shows("mcsgo mcsvel mcsdecel mcsmoving pcsgo pcsvel pcsdecel pcsmoving")
@pytest.mark.covers("imc.IMC_MoveSuperimposed", "imc.IMC_MoveRelative", "imc.concept.superposition")
@pytest.mark.parametrize(("system", "other"), [("mcs", "pcs"), ("pcs", "mcs")])
def test_a_move_of_either_system_is_stopped_alone_and_with_its_own_rate(system: str, other: str) -> None:
    card = ready_card()
    for each, speed, decel in ((system, 6, 0.5), (other, 4, 3)):
        rates = {"maxvel": speed, "accel": 2, "decel": decel, "dist": -4000, "go": FLAG}
        set_now(card, *((f"{each}{name}", value, 1) for name, value in rates.items()))
    card.advance(10)
    set_now(card, (f"{system}go", 0, 1))
    assert trace(card, f"{system}vel", 12, 1) == [-5.5 + 0.5 * k for k in range(12)]
    card.advance(1)
    assert [card.read(f"{system}{name}", 1) for name in ("go", "moving", "vel")] == [0, 0, 0]
    assert [card.read(f"{other}{name}", 1) for name in ("go", "moving", "vel")] == [FLAG, FLAG, -4]
