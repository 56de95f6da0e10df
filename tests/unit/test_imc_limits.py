"""What stops an axis: limit switches, software limits, position error, speed limits, emergency stop and recovery."""

from __future__ import annotations

import pytest

from polycnc.controllers.imc.core._parameters import address
from support.imc_card import (
    FLAG,
    IFIFO,
    QFIFO,
    enable_path,
    line,
    move_absolute,
    move_relative,
    ready_card,
    send,
    set_now,
    shows,
)

LIMITS = "[[axis]]\nlimit_positive = 1000.0\nlimit_negative = -1000.0\n[[axis]]\n"


@shows("curpos mcstgvel moving run")
@pytest.mark.covers("imc.param.aiolat")
@pytest.mark.covers(
    "imc.param.error", "imc.param.aioctr", "imc.param.stopfilt", "imc.param.aio", "imc.bit.aio.0"
)
@pytest.mark.parametrize(("way", "bit", "level"), [(1, 1, 1), (-1, 2, 2)])
def test_a_limit_switch_stops_the_motion_towards_it_only(way: int, bit: int, level: int) -> None:
    card = ready_card(LIMITS)
    set_now(card, ("aioctr", 0x000F))
    send(card, IFIFO, ("mcstgvel", 20 * way))
    card.advance(200)
    assert (card.read("error"), int(card.read("aio")) & 3, card.read("aiolat")) == (bit, level, level)
    assert (card.read("run"), card.read("moving")) == (FLAG, 0)
    assert 1000 <= card.read("curpos") * way < 1250
    here = card.read("curpos")
    move_relative(card, 100 * way)
    card.advance(30)
    assert card.read("curpos") == here
    move_absolute(card, 0)
    card.wait()
    assert card.read("curpos") == 0
    send(card, IFIFO, ("error", 0), ("aiolat", level))
    card.advance(1)
    assert (card.read("error"), card.read("aiolat")) == (0, 0)


@shows("curpos curvel gohome highvel mcsgo")
@pytest.mark.covers("imc.param.aioctr")
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.covers("imc.param.homeseq", "imc.param.mcsdist", "imc.param.mcstgvel", "imc.param.mcstgpos")
def test_at_a_limit_switch_every_command_leads_away_from_it_only(way: int) -> None:
    card = ready_card(LIMITS)
    set_now(card, ("aioctr", 0x000F))
    send(card, IFIFO, ("mcstgvel", 20 * way))
    card.advance(200)
    here = card.read("curpos")
    assert abs(here) > 1000
    for towards in (
        [("mcstgpos", here + 37 * way), ("mcsgo", FLAG)],
        [("mcstgpos", here + way), ("mcsgo", FLAG)],
        [("mcsdist", 41 * way), ("mcsgo", FLAG)],
        [("mcstgvel", 7 * way)],
        [("homeseq", 0x11 if way > 0 else 0x31), ("highvel", 5), ("gohome", FLAG)],
    ):
        send(card, IFIFO, *towards)
        card.advance(30)
        assert (card.read("curpos"), card.read("mcsgo"), card.read("gohome")) == (here, 0, 0)
    send(card, IFIFO, ("mcstgpos", here), ("mcsgo", FLAG))  # to where it stands
    card.advance(5)
    assert (card.read("curpos"), card.read("mcsgo")) == (here, 0)
    send(card, IFIFO, ("mcstgvel", -7 * way))
    card.advance(3)
    assert card.read("curvel") == -3 * way
    send(card, IFIFO, ("mcstgvel", 0))
    card.wait()
    there = card.read("curpos")
    send(card, IFIFO, ("mcsdist", -29 * way), ("mcsgo", FLAG))
    card.wait()
    assert card.read("curpos") == there - 29 * way


@shows("mcstgvel")
@pytest.mark.covers("imc.param.aioctr")
@pytest.mark.covers("imc.param.aiolat", "imc.param.clraiolat", "imc.param.aio", "imc.param.error")
@pytest.mark.parametrize(
    ("way", "name", "on", "high", "bit"), [(1, "positive", 2, 1, 1), (-1, "negative", 8, 4, 2)]
)
def test_limits_work_by_their_polarity_and_only_when_they_are_used(
    way: int, name: str, on: int, high: int, bit: int
) -> None:
    low = f'low_when_on = ["limit_{name}"]\n'
    for text, control, error in (
        ("", 0, 0),
        ("", on, bit),
        ("", on | high, bit),
        (low, on, bit),
        (low, on | high, bit),
    ):
        card = ready_card(f"[[axis]]\nlimit_{name} = {1000.0 * way}\n" + text)
        set_now(card, ("aioctr", control))
        send(card, IFIFO, ("mcstgvel", 20 * way))
        card.advance(10)
        early = card.read("error")
        card.advance(100)
        wrong_way_round = bool(text) == bool(control & high) and control != 0
        assert early == (bit if wrong_way_round else 0)
        assert card.read("error") == error
        assert bool(int(card.read("aiolat")) & bit) == (bool(text) != bool(control & high))


@pytest.mark.covers("imc.param.aiolat", "imc.param.clraiolat")
@pytest.mark.covers("imc.param.aioctr")
def test_a_latched_terminal_is_cleared_by_its_own_bit() -> None:
    card = ready_card("[[axis]]\nlimit_positive = 100.0\norigin = [30.0, 60.0]\n")
    set_now(card, ("aioctr", 0x11))  # positive limit and origin become active when they close
    move_absolute(card, 200)
    card.wait()
    latched = int(card.read("aiolat"))
    assert latched == 0b101
    for written, left in ((0b010, 0b101), (0b100, 0b001), (0b1001, 0)):
        send(card, IFIFO, ("clraiolat", written))
        card.advance(1)
        assert card.read("aiolat") == left


@shows("aioctr curpos error")
@pytest.mark.covers("imc.param.psoftlim", "imc.param.nsoftlim")
@pytest.mark.parametrize(("way", "bit"), [(1, 4), (-1, 8)])
def test_software_limits_work_when_they_are_switched_on(way: int, bit: int) -> None:
    for control, error in ((0, 0), (0xC000 - 0x10000, bit)):
        card = ready_card()
        set_now(card, ("psoftlim", 500), ("nsoftlim", -500), ("aioctr", control))
        move_absolute(card, 2000 * way)
        card.wait()
        assert card.read("error") == error
        assert (abs(card.read("curpos")) < 1200) == (error != 0)


@shows("aioctr curpos error")
@pytest.mark.covers("imc.param.stopfilt")
def test_an_error_that_no_mask_names_changes_nothing() -> None:
    card = ready_card(LIMITS)
    set_now(card, ("aioctr", 0x000F), ("stopfilt", 0))
    move_absolute(card, 3000)
    card.wait()
    assert (card.read("curpos"), card.read("error")) == (3000, 1)


@shows("aioctr curpos curvel error mcstgvel")
@pytest.mark.covers("imc.param.stopmode")
@pytest.mark.parametrize(("soft", "way", "bit"), [(0, 1, 1), (0, -1, 2), (1, 1, 4), (1, -1, 8)])
@pytest.mark.covers("imc.param.nsoftlim", "imc.param.psoftlim")
def test_stopmode_names_the_errors_that_stop_at_once_and_all_others_brake(
    soft: int, way: int, bit: int
) -> None:
    for mode, least, most in ((bit, 0, 20), (~bit, 180, 240)):  # 20 pulses/ms and 1 pulse/ms2: 200 to brake
        card = ready_card(
            "number_of_axes = 3\n[[axis]]\n[[axis]]\nlimit_positive = 500\nlimit_negative = -500\n"
        )
        set_now(card, ("aioctr", 0xC000 - 0x10000 if soft else 0x000F, 1), ("stopmode", mode, 1))
        if soft:
            set_now(card, ("psoftlim", 500, 1), ("nsoftlim", -500, 1))
        send(card, IFIFO, ("mcstgvel", 20 * way, 1), ("mcstgvel", 3, 2))
        card.advance(200)
        assert card.read("error", 1) == bit
        assert least <= card.read("curpos", 1) * way - 500 <= most
        assert (card.read("curvel", 1), card.read("curvel", 2)) == (0, 3)


@shows("stopmode stopfilt error pcsvel mcsvel pcsdecel mcsdecel pcstgvel mcstgvel")
@pytest.mark.parametrize(("mode", "after"), [(0x40, (0, 0)), (~0x40, (5, -3))])
def test_an_error_stops_both_systems_at_once_or_each_with_its_own_rate(
    mode: int, after: tuple[int, int]
) -> None:
    card = ready_card()
    set_now(card, ("mcsaccel", 9, 2), ("mcsdecel", 2, 2), ("pcsaccel", 6, 2), ("pcsdecel", 1.5, 2))
    set_now(card, ("stopmode", mode, 2), ("mcstgvel", 9, 2), ("pcstgvel", -6, 2))
    card.advance(2)
    set_now(card, ("error", 0x40, 2))
    card.advance(3)  # the last of them at speed, and two that brake
    assert [card.read(name, 2) for name in ("mcsvel", "pcsvel")] == list(after)
    card.advance(4)
    assert [card.read(name, 2) for name in ("mcsvel", "pcsvel", "curvel", "moving")] == [0] * 4


@shows("curvel mcsaccel mcsdecel mcstgvel")
@pytest.mark.covers("imc.param.stopfilt", "imc.param.stopmode", "imc.param.exitfilt", "imc.param.error")
@pytest.mark.covers("imc.param.emstop", "imc.param.run")
def test_each_bit_of_the_masks_is_for_its_own_error() -> None:
    for number in range(16):
        bit = 1 << number
        for stop, mode, leave, way, after, run in (  # after two cycles from 9 pulses/ms with 2 pulses/ms2
            (bit, ~bit, ~bit, 1, 5, FLAG),
            (bit, bit, ~bit, -1, 0, FLAG),
            (~bit, bit, ~bit, 1, 9, FLAG),
            (0, 0, bit, -1, 0, 0),
        ):
            card = ready_card(number_of_axes=2)
            set_now(card, ("mcsaccel", 9, 1), ("mcsdecel", 2, 1), ("mcstgvel", 9 * way, 1))
            set_now(card, ("stopfilt", stop, 1), ("stopmode", mode, 1), ("exitfilt", leave, 1))
            limit_of_this_way = (way > 0) == (number in (0, 2))
            card.advance(1)
            if number < 4 and not limit_of_this_way:
                continue  # a limit stops what goes towards it
            name, axis = ("emstop", 0) if number in (5, 6, 13) else ("error", 1)
            set_now(card, (name, bit, axis))
            card.advance(3)
            assert (card.read("curvel", 1) * way, card.read("run", 1)) == (after, run), (
                number,
                stop,
                mode,
                leave,
            )
            assert int(card.read("error", 1)) & 0xFFFF == bit
            set_now(card, ("mcstgvel", 4 * way, 1))  # what the mask does not name keeps from nothing
            card.advance(6)
            assert card.read("curvel", 1) * way == (4 if after == 9 else 0), (number, stop, mode, leave)


@shows("curpos homepos mcsaccel mcstgvel sethome stopfilt")
@pytest.mark.covers("imc.param.psoftlim", "imc.param.nsoftlim", "imc.param.aioctr", "imc.param.error")
@pytest.mark.parametrize(("way", "name", "bit"), [(1, "psoftlim", 4), (-1, "nsoftlim", 8)])
def test_a_software_limit_is_met_where_it_lies(way: int, name: str, bit: int) -> None:
    for beyond, error in ((0, bit), (1, 0)):
        card = ready_card()
        set_now(card, ("mcsaccel", 7), ("stopfilt", 0), ("aioctr", 0xC000), (name, way * (70_000 + beyond)))
        set_now(card, ("homepos", 69_930 * way), ("sethome", FLAG), ("mcstgvel", 7 * way))
        card.advance(9)
        assert (card.read("curpos"), card.read("error")) == (69_993 * way, 0)
        card.advance(1)
        assert (card.read("curpos"), card.read("error")) == (70_000 * way, error)


@shows("aioctr curvel error mcstgvel moving run")
@pytest.mark.covers("imc.param.exitfilt")
def test_exitfilt_names_the_errors_that_end_run() -> None:
    card = ready_card(LIMITS)
    set_now(card, ("aioctr", 0x000F), ("exitfilt", 1))
    send(card, IFIFO, ("mcstgvel", 20))
    card.advance(100)
    assert (card.read("run"), card.read("moving"), card.read("curvel")) == (0, 0, 0)
    other = ready_card(LIMITS)
    set_now(other, ("aioctr", 0x000F), ("exitfilt", 0xFFFE))
    send(other, IFIFO, ("mcstgvel", 20))
    other.advance(100)
    assert card.read("error") == other.read("error") == 1
    assert other.read("run") == FLAG  # it is not an error that the mask names


@shows("error")
@pytest.mark.covers("imc.param.poserrlim")
@pytest.mark.covers("imc.param.ena", "imc.param.poserr")
def test_a_position_error_beyond_its_limit_is_an_error() -> None:
    card = ready_card()
    set_now(card, ("poserrlim", 100), ("ena", 0))
    move_absolute(card, 3000)
    card.advance(60)
    assert card.read("error") == 0x80
    card.wait()
    assert 100 < card.read("poserr") < 300


@shows("curpos error moving")
@pytest.mark.covers("imc.param.run")
@pytest.mark.covers("imc.param.vellim", "imc.param.accellim")
@pytest.mark.parametrize(("name", "value", "bit"), [("vellim", 30, 0x2000), ("accellim", 0.5, 0x4000)])
@pytest.mark.covers("imc.param.exitfilt", "imc.param.mcsaccel", "imc.param.smooth", "imc.param.stopfilt")
def test_speed_and_acceleration_limits_end_run_whatever_the_masks_say(
    name: str, value: float, bit: int
) -> None:
    card = ready_card()
    set_now(card, (name, value), ("stopfilt", 0), ("exitfilt", 0), ("mcsaccel", 2), ("smooth", 8))
    move_absolute(card, 5000)
    card.advance(200)
    assert (card.read("error"), card.read("run"), card.read("moving")) == (bit, 0, 0)
    assert card.read("curpos") < 1000
    here = card.read("curpos")
    set_now(card, ("error", 0), (name, 1000), ("run", FLAG))
    move_absolute(card, 200)
    card.wait()
    assert (card.read("curpos"), card.read("error")) == (200, 0)
    assert here != 200


@shows("curpos error moving run")
@pytest.mark.covers("imc.param.emstop")
@pytest.mark.covers("imc.param.ena")
def test_an_emergency_stop_takes_everything_out_of_work_until_it_is_set_up_again() -> None:
    card = ready_card()
    enable_path(card, 0, 1)
    line(card, 5000, 5000, speed=20)
    send(card, IFIFO, ("mcstgvel", 20, 2))
    card.advance(50)
    send(card, IFIFO, ("emstop", 0x10))
    card.advance(1)
    here = [card.read("curpos", i) for i in range(4)]
    names = ("run", "ena", "moving", "error")
    assert [[card.read(n, i) for n in names] for i in range(4)] == [[0, 0, 0, 0x10]] * 4
    assert card.read("startpath1") == 0
    card.advance(100)
    assert [card.read("curpos", i) for i in range(4)] == here
    send(card, QFIFO, ("emstop", 0))
    card.advance(2)
    for i in range(4):
        send(card, IFIFO, ("error", 0, i), ("ena", FLAG, i), ("run", FLAG, i))
    send(card, IFIFO, ("clrPFIFO1", FLAG), ("pwaittime1", 0), ("startpath1", FLAG))
    card.advance(1)
    line(card, 100, 200, speed=20)
    card.wait()
    assert [card.read("curpos", i) for i in range(2)] == [100, 200]
    assert [card.read("error", i) for i in range(4)] == [0] * 4


@shows("error moving run")
@pytest.mark.covers("imc.param.emstop")
def test_other_bits_of_emstop_are_errors_of_every_axis() -> None:
    card = ready_card()
    send(card, IFIFO, ("mcstgvel", 20, 2), ("emstop", 0x40))
    card.advance(50)
    assert [card.read("error", i) for i in range(4)] == [0x40] * 4
    assert (card.read("moving", 2), card.read("run", 2)) == (0, FLAG)


@shows("aioctr error moving")
def test_a_limit_under_a_path_stops_the_path_along_itself() -> None:
    card = ready_card(LIMITS)
    set_now(card, ("aioctr", 0x000F))
    enable_path(card, 0, 1)
    line(card, 3000, 4000, speed=25)
    card.advance(400)
    x, y = card.read("curpos", 0), card.read("curpos", 1)
    assert 1000 <= x < 1300
    assert y == pytest.approx(x * 4 / 3, abs=1.5)
    assert (card.read("startpath1"), card.read("moving"), card.read("error")) == (0, 0, 1)


@shows("curvel engear mcstgvel run")
@pytest.mark.covers("imc.param.gearsrc")
def test_run_set_to_0_stops_at_once_and_a_gear_is_left() -> None:
    card = ready_card()
    send(card, IFIFO, ("gearratio", 1.0, 1), ("gearsrc", 227, 1), ("engear", FLAG, 1), ("mcstgvel", 10))
    card.advance(50)
    set_now(card, ("run", 0, 1))
    card.advance(20)
    assert (card.read("curvel", 1), card.read("engear", 1), card.read("curvel", 0)) == (0, 0, 10)


@shows("aio")
def test_a_card_that_is_switched_on_at_its_switches_shows_them() -> None:
    card = ready_card(
        "number_of_axes = 3\n[[axis]]\n[[axis]]\n"
        "limit_positive = -0.5\nlimit_negative = -7.0\norigin = [-0.4, 0.6]\n"
        '[[axis]]\nlimit_positive = 9.0\nlimit_negative = 0.25\norigin = [0.3, 2.0]\nlow_when_on = ["origin"]\n'
    )
    card.advance(1)
    assert [card.read("aio", i) for i in range(3)] == [7, 1 + 4, 2 + 4]


@shows("curvel error mcstgvel")
@pytest.mark.covers("imc.param.aioctr", "imc.param.aio", "imc.param.aiolat")
@pytest.mark.parametrize(
    ("control", "idle"),
    [(0, 7), (0x000A, 7), (0x0010, 3), (0x058A, 7), (0x000F, 4), (0x00BF, 0), (0x000B, 6)],
)
def test_a_terminal_without_a_switch_is_never_active(control: int, idle: int) -> None:
    card = ready_card("[[axis]]\n[[axis]]\nlimit_positive = 9.0\nlow_when_on = ['limit_negative']\n")
    for axis in (0, 1):
        set_now(card, ("aioctr", control, axis), ("mcstgvel", -5, axis))
    card.advance(20)
    assert [card.read("error", axis) for axis in (0, 1)] == [0, 0]
    assert [card.read("aiolat", axis) for axis in (0, 1)] == [0, 0]
    assert (card.read("aio", 0), int(card.read("aio", 1)) & 6) == (idle, idle & 6)
    set_now(card, ("mcstgvel", 5))
    card.advance(40)
    assert (card.read("error"), card.read("curvel"), card.read("aiolat")) == (0, 5, 0)


@shows(
    "curvel enasyn error group_x groupnum mcsaccel mcstgvel run slavedist startgroup startsyn "
    "synsrc synsrcvar syntype"
)
@pytest.mark.covers("imc.param.mcsslope", "imc.param.pcsslope")
def test_slope_is_clear_at_rest_however_the_motion_has_ended() -> None:
    card = ready_card()
    set_now(card, ("mcstgvel", 2, 0), ("pcstgvel", -1, 0), ("mcsaccel", 0.5, 1), ("stopmode", 0x40, 1))
    set_now(
        card, ("mcstgvel", 5, 1), ("syntype", FLAG, 2), ("synsrc", address("ticks"), 2), ("synsrcvar", 6, 2)
    )
    set_now(card, ("slavedist", 9, 2), ("enasyn", FLAG, 2), ("startsyn", FLAG, 2))
    set_now(card, ("group_x", 3), ("groupnum", 1), ("groupsmooth", 2), ("startgroup", FLAG))
    assert card.push_points([7, -3])
    card.advance(3)
    shown = [(card.read("mcsslope", i), card.read("pcsslope", i)) for i in range(4)]
    assert shown == [(0, 0), (FLAG, 0), (FLAG, 0), (FLAG, 0)]
    set_now(card, ("run", 0, 0), ("error", 0x40, 1))  # at once
    card.advance(6)
    assert [card.read("curvel", i) for i in range(4)] == [0] * 4
    assert [card.read(name, i) for name in ("mcsslope", "pcsslope") for i in range(4)] == [0] * 8
