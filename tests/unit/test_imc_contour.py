"""Contour motion point by point, and captured positions."""

from __future__ import annotations

import pytest

from polycnc.controllers.imc.core._parameters import address
from support.imc_card import (
    FLAG,
    IFIFO,
    enable_path,
    line,
    move_absolute,
    ready_card,
    send,
    set_now,
    shows,
    trace,
)


def group(card, *axes: int, cycles: int = 20) -> None:  # type: ignore[no-untyped-def]
    """Set up a contour group."""
    for name, axis in zip("xyzabcdefghijklm", axes, strict=False):
        card.write(f"group_{name}", axis)
    set_now(card, ("groupnum", len(axes)), ("groupsmooth", cycles))


@pytest.mark.covers("imc.fifo.SEL_CFIFO")
@pytest.mark.covers("imc.IMC_AddContourData")
@shows("curpos")
@pytest.mark.covers(
    "imc.concept.cfifo",
    "imc.concept.contour",
    "imc.param.groupsmooth",
    "imc.param.startgroup",
    "imc.param.groupnum",
)
@pytest.mark.covers("imc.param.contouring", "imc.param.curvel")
def test_each_point_is_spread_evenly_over_its_cycles() -> None:
    card = ready_card()
    group(card, 2, 0, 1)
    assert card.push_points([100, -40, 7] * 10)
    card.advance(30)
    assert (card.waiting_words(4), card.read("curpos", 2)) == (30, 0)
    send(card, IFIFO, ("startgroup", FLAG))
    assert trace(card, "curvel", 20, 2) == [5.0] * 20
    assert [card.read("curpos", i) for i in range(3)] == [-40, 7, 100]
    assert card.read("contouring", 2) == FLAG
    card.wait()
    assert card.clock.cycles == 30 + 200 + 1
    assert [card.read("curpos", i) for i in range(3)] == [-400, 70, 1000]
    assert [card.read("contouring", i) for i in range(3)] == [0, 0, 0]


@pytest.mark.covers("imc.IMC_AddContourData", "imc.concept.contour")
@shows("curpos startgroup")
@pytest.mark.covers(*(f"imc.param.group_{name}" for name in "xyzabcdefghijklm"))
def test_each_of_sixteen_coordinates_moves_its_axis() -> None:
    card = ready_card(number_of_axes=16)
    axes = [(5 * k + 3) % 16 for k in range(16)]
    group(card, *axes, cycles=4)
    card.push_points([10 * (k + 1) for k in range(16)])
    send(card, IFIFO, ("startgroup", FLAG))
    card.advance(2)
    assert [card.read("contouring", i) for i in axes] == [FLAG] * 16
    card.advance(3)
    assert [card.read("curpos", i) for i in axes] == [10 * (k + 1) for k in range(16)]
    assert [card.read("contouring", i) + card.read("moving", i) for i in axes] == [0] * 16


@shows("curpos startgroup")
@pytest.mark.covers("imc.param.contouring")
def test_contouring_shows_in_the_axes_of_the_group_while_points_are_carried_out() -> None:
    card = ready_card()
    group(card, 3, 1, cycles=6)
    card.push_points([30, -42] * 4)
    send(card, IFIFO, ("startgroup", FLAG))
    for _ in range(4 * 6):
        card.advance(1)
        assert [card.read("contouring", i) for i in range(4)] == [0, FLAG, 0, FLAG]
    card.advance(1)
    assert [card.read("contouring", i) for i in range(4)] == [0] * 4
    assert [card.read("curpos", i) for i in range(4)] == [0, -168, 0, 120]


@pytest.mark.covers("imc.fifo.SEL_CFIFO")
@pytest.mark.covers("imc.concept.cfifo", "imc.concept.contour")
@shows("curpos startgroup")
@pytest.mark.covers("imc.param.contouring")
def test_an_empty_queue_ends_contouring_and_new_points_go_on() -> None:
    card = ready_card()
    group(card, 0, cycles=3)
    card.push_points([10])
    send(card, IFIFO, ("startgroup", FLAG))
    card.advance(4)
    assert (card.read("contouring"), card.read("curpos")) == (0, 10)
    card.push_points([-4])
    card.advance(4)
    assert card.read("curpos") == 6
    card.push_points([50, 50])
    card.advance(2)
    send(card, IFIFO, ("startgroup", 0))
    card.advance(5)
    assert card.read("curpos") == 6 + 50 * 2 // 3


@shows("startgroup")
@pytest.mark.covers("imc.param.vellim", "imc.param.error")
@pytest.mark.covers("imc.param.moving", "imc.param.run")
def test_too_large_a_displacement_is_a_speed_error() -> None:
    card = ready_card()
    set_now(card, ("vellim", 30))
    group(card, 0)
    card.push_points([400, 4000, 400])
    send(card, IFIFO, ("startgroup", FLAG))
    card.advance(60)
    assert (card.read("error"), card.read("run"), card.read("moving")) == (0x2000, 0, 0)


@pytest.mark.covers("imc.concept.contour")
@shows("startgroup")
def test_an_odd_displacement_arrives_whole() -> None:
    card = ready_card()
    group(card, 0, 1, cycles=7)
    card.push_points([1, -1, 3, -3])
    send(card, IFIFO, ("startgroup", FLAG))
    card.wait()
    assert [card.read_raw(224, i, 3) for i in (0, 1)] == [4 * 65536, -4 * 65536]


@pytest.mark.covers("imc.IMC_GetCapData")
@shows("mcsgo")
@pytest.mark.covers("imc.concept.capfifo", "imc.bit.encpctr.10", "imc.param.encpctr")
@pytest.mark.covers("imc.param.mcsmaxvel")
def test_probe_pulses_are_captured_while_capture_is_on() -> None:
    card = ready_card("[[axis]]\nprobe = { first = 105.0, pitch = 100.0 }\n")
    set_now(card, ("mcsmaxvel", 30))
    move_absolute(card, 450)
    card.wait()
    assert card.read_capture(0, 120) == ((), 0)
    for other in (0x3, 0xF0, 0x300, 0x800, 0x7000, 0x7BFF):  # no other bit lets it capture
        set_now(
            card,
            ("encpctr", other),
            ("mcsdist", 120 if other in (0x3, 0x300, 0x7000) else -120),
            ("mcsgo", FLAG),
        )
        card.wait()
    assert card.read_capture(0, 120) == ((), 0)
    set_now(card, ("encpctr", 0x400), ("counter", 0))
    move_absolute(card, 90)
    card.wait()
    assert card.read("counter") == 4
    assert (card.read("clrcapfifo"), card.read("capfifo")) == (4, 405)
    assert card.read_capture(0, 3) == ((405, 305, 205), 1)
    assert card.read_capture(0, 3) == ((105,), 0)
    move_absolute(card, 250)
    card.wait()
    send(card, IFIFO, ("popcapfifo", FLAG))
    card.advance(1)
    assert card.read("capfifo") == 205
    send(card, IFIFO, ("clrcapfifo", FLAG))
    card.advance(1)
    assert card.read_capture(0, 3) == ((), 0)


@pytest.mark.covers("imc.param.capture", "imc.param.cappos")
@pytest.mark.parametrize(("name", "value"), [("capture", FLAG), ("capture2", 0), ("capture", 0)])
@pytest.mark.covers("imc.param.curpos", "imc.param.encp", "imc.param.encpfactor", "imc.param.mcstgvel")
def test_a_write_captures_the_position_of_this_moment(name: str, value: int) -> None:
    card = ready_card()
    set_now(card, ("encpfactor", 0.5))  # the encoder, not the command, is captured
    send(card, IFIFO, ("mcstgvel", 10))
    card.advance(33)
    here = card.read("encp")
    assert 0 < here < card.read("curpos")
    send(card, IFIFO, (name, value))
    card.advance(10)
    assert card.read("cappos") == here < card.read("encp")
    assert card.read_capture(0, 5) == ((here,), 0)


@pytest.mark.covers("imc.IMC_GetCapData", "imc.bit.encpctr.10", "imc.concept.capfifo")
@pytest.mark.covers("imc.param.encpctr")
@pytest.mark.covers("imc.param.encp", "imc.param.mcstgvel")
def test_a_touch_of_the_probe_captures_once() -> None:
    card = ready_card()
    set_now(card, ("encpctr", 0x400), ("mcstgvel", 5))
    card.advance(20)
    card.touch_probe(0)
    card.advance(10)
    assert card.read_capture(0, 5)[0] == (card.read("encp") - 5 * 9,)
    assert card.read_raw(address("counter")) == 1


@shows("curpos")
@pytest.mark.covers("imc.param.aioctr", "imc.param.curvel", "imc.param.error", "imc.param.startgroup")
def test_an_axis_that_is_stopped_ends_the_contour_and_does_not_jump_later() -> None:
    card = ready_card("number_of_axes = 4\n[[axis]]\nlimit_positive = 70.0\n")
    set_now(card, ("aioctr", 0x3))
    group(card, 0, 1, cycles=10)
    card.push_points([40, 30] * 8)
    send(card, IFIFO, ("startgroup", FLAG))
    steps = trace(card, "curvel", 60)
    assert max(steps) == 4
    assert card.read("curpos") == 72
    assert (int(card.read("error")) & 1, card.read("startgroup"), card.read("curvel", 1)) == (1, 0, 0)
    set_now(card, ("error", 0), ("aioctr", 0))
    move_absolute(card, 20)
    steps = trace(card, "curvel", 60)
    assert max(steps) == 0
    assert card.read("curpos") == 20


@pytest.mark.covers(
    "imc.param.contouring", "imc.param.curpos", "imc.param.curvel", "imc.param.run", "imc.param.startgroup"
)
def test_an_axis_out_of_run_keeps_nothing_of_the_contour_for_a_later_path() -> None:
    card = ready_card()
    group(card, 0, cycles=50)
    card.push_points([500] * 3)
    send(card, IFIFO, ("startgroup", FLAG))
    card.advance(7)
    send(card, IFIFO, ("run", 0))
    card.advance(20)
    assert (card.read("startgroup"), card.read("contouring"), card.read("curpos")) == (0, 0, 70)
    set_now(card, ("run", FLAG), ("clrCFIFO", FLAG))
    enable_path(card, 0)
    line(card, 100, speed=4)
    assert max(trace(card, "curvel", 30)) == 4
    assert card.read("curpos") == 100


@shows("startgroup")
@pytest.mark.covers("imc.param.emstop", "imc.param.ena", "imc.param.error", "imc.param.run")
def test_an_emergency_stop_ends_the_contour_for_good() -> None:
    card = ready_card()
    group(card, 0, cycles=4)
    card.push_points([40] * 30)
    send(card, IFIFO, ("startgroup", FLAG))
    card.advance(6)
    send(card, IFIFO, ("emstop", 0x10))
    card.advance(2)
    here = card.read("curpos")
    set_now(card, ("emstop", 0), ("error", 0), ("ena", FLAG), ("run", FLAG))
    card.advance(50)
    assert (card.read("curpos"), card.read("startgroup"), card.waiting_words(4) > 0) == (here, 0, True)


@pytest.mark.covers("imc.param.curpos", "imc.param.startgroup")
def test_a_contour_waits_for_an_axis_that_is_on_a_path() -> None:
    card = ready_card()
    enable_path(card, 0)
    line(card, 123, speed=6)
    card.advance(4)
    group(card, 0, 1, cycles=5)
    card.push_points([7, 11] * 2)
    send(card, IFIFO, ("startgroup", FLAG))
    card.advance(80)
    assert (card.read("curpos", 0), card.read("curpos", 1)) == (123 + 14, 22)
