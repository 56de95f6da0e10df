"""Moves of an axis in both coordinate systems: to a position, by a distance, at a velocity; smoothing, pause, stops."""

from __future__ import annotations

import math

import pytest

from polycnc.controllers.imc.core._instructions import Segment, Write, WriteMany
from polycnc.controllers.imc.core._parameters import address
from support.imc_card import (
    FLAG,
    IFIFO,
    PFIFO1,
    QFIFO,
    move_absolute,
    move_relative,
    ready_card,
    send,
    set_now,
    setting,
    shows,
    trace,
)


@pytest.mark.covers("imc.IMC_MoveAbsolute", "imc.concept.ptp_modes")
@shows("curpos curvel encp mcsvel moving")
@pytest.mark.covers("imc.param.motion")
@pytest.mark.covers(
    "imc.param.mcsgo", "imc.param.mcstgpos", "imc.param.mcsmoving", "imc.param.mcspos", "imc.concept.units"
)
@pytest.mark.covers("imc.param.profiling")
def test_an_absolute_move_ends_on_its_target_in_the_time_of_its_ramps() -> None:
    card = ready_card()
    move_absolute(card, 6250, 1)
    card.advance(1)
    assert [card.read(n, 1) for n in ("mcsgo", "mcsmoving", "moving", "profiling", "motion")] == [FLAG] * 5
    card.wait()
    # 1 pulse/ms2 up to sqrt(6250) = 79 pulses/ms and down again: 158.1 ms, then one cycle at rest
    assert card.clock.cycles == math.ceil(2 * math.sqrt(6250)) + 1
    assert [card.read(n, 1) for n in ("mcspos", "curpos", "encp")] == [6250] * 3
    assert [card.read(n, 1) for n in ("mcsgo", "mcsmoving", "moving", "mcsvel", "curvel")] == [0] * 5


@pytest.mark.covers("imc.IMC_MoveAbsolute")
@shows("mcspos mcstgpos moving")
def test_writing_the_target_alone_starts_nothing() -> None:
    card = ready_card()
    send(card, IFIFO, ("mcstgpos", 100))
    card.advance(20)
    assert (card.read("mcstgpos"), card.read("mcspos"), card.read("moving")) == (100, 0, 0)


@pytest.mark.covers("imc.IMC_MoveAbsolute")
@shows("mcsvel")
@pytest.mark.covers("imc.param.mcsmaxvel", "imc.param.mcsaccel", "imc.param.mcsdecel", "imc.param.mcsslope")
def test_a_long_move_has_its_speed_and_its_two_rates() -> None:
    card = ready_card()
    set_now(card, ("mcsmaxvel", 10), ("mcsaccel", 0.5), ("mcsdecel", 0.25))
    move_absolute(card, 1000)
    velocities = trace(card, "mcsvel", 140)
    assert velocities[19] == 9.75  # mean of the twentieth cycle of a ramp of 0.5
    assert set(velocities[20:80]) == {10.0}
    assert velocities[90] - velocities[91] == 0.25
    assert sum(velocities) == 1000


@pytest.mark.covers(
    "imc.IMC_MoveRelative", "imc.IMC_MoveSuperimposed", "imc.IMC_Phasing", "imc.concept.mcs_pcs"
)
@shows("run")
@pytest.mark.parametrize("system", ["mcs", "pcs"])
@pytest.mark.covers(
    *(f"imc.param.{system}{name}" for system in ("mcs", "pcs") for name in ("maxvel", "accel", "decel", "go", "dist")),
    "imc.param.pcsvel", "imc.param.mcsvel",
)  # fmt: skip
def test_each_system_moves_backwards_with_its_own_speed_and_rates(system: str) -> None:
    card = ready_card()
    for name, value in (("maxvel", 10), ("accel", 0.5), ("decel", 0.25)):
        other = "pcs" if system == "mcs" else "mcs"
        set_now(card, (f"{system}{name}", value, 2), (f"{other}{name}", 3 * value, 2))
    move_relative(card, -1000, 2, system=system)
    velocities = trace(card, f"{system}vel", 95, 2)
    assert card.read(f"{system}go", 2) == FLAG
    assert velocities[19] == -9.75
    assert set(velocities[20:80]) == {-10.0}
    assert velocities[91] - velocities[90] == 0.25
    set_now(card, ("run", 0, 2))  # stops at once, and what was commanded is over
    card.advance(1)
    assert [card.read(f"{system}{name}", 2) for name in ("go", "vel", "moving")] == [0, 0, 0]


@shows("mcstgvel mcsvel")
@pytest.mark.covers("imc.param.mcsslope")
def test_slope_is_set_while_the_velocity_changes() -> None:
    card = ready_card()
    set_now(card, ("mcstgvel", 3))
    assert trace(card, "mcsslope", 5) == [FLAG, FLAG, FLAG, 0, 0]
    assert card.read("mcsvel") == 3


@pytest.mark.covers("imc.IMC_MoveRelative", "imc.concept.ptp_modes")
@shows("mcspos mcstgpos")
@pytest.mark.covers("imc.param.mcsdist")
def test_a_relative_move_counts_from_where_the_axis_is_when_it_begins() -> None:
    card = ready_card()
    set_now(card, ("mcstgvel", 10))
    card.advance(100)
    move_relative(card, -200, fifo=QFIFO)
    here = card.read("mcspos")
    card.advance(1)
    assert card.read("mcstgpos") == here - 200
    assert card.read("mcsdist") == 0
    card.wait()
    assert card.read("mcspos") == here - 200


@pytest.mark.covers("imc.IMC_MoveAbsolute")
@shows("curpos")
def test_a_move_can_be_given_a_new_target_under_way() -> None:
    card = ready_card()
    move_absolute(card, 5000)
    card.advance(60)
    move_absolute(card, -300)
    card.wait()
    assert card.read("curpos") == -300


@shows("moving")
@pytest.mark.covers("imc.param.mcsgo")
def test_a_move_is_stopped_by_writing_0_to_go() -> None:
    card = ready_card()
    move_absolute(card, 5000)
    card.advance(20)
    position, velocity = card.read("mcspos"), card.read("mcsvel")
    send(card, IFIFO, ("mcsgo", 0))
    card.wait()
    assert card.read("mcspos") == pytest.approx(position + velocity * velocity / 2, abs=velocity)
    assert card.read("moving") == 0


@shows("curpos mcspos mcsvel moving")
@pytest.mark.covers("imc.param.smooth")
def test_an_abrupt_stop_zeroes_the_velocity() -> None:
    card = ready_card()
    move_absolute(card, 50000)
    card.advance(50)
    position = card.read("mcspos")
    send(card, IFIFO, ("smooth", 0), ("mcsgo", 0), ("mcsvel", 0), ("mcstgvel", 0))
    card.advance(2)
    assert (card.read("mcspos"), card.read("curpos"), card.read("moving")) == (position, position, 0)


@shows("curpos mcsgo mcstgpos moving")
@pytest.mark.covers("imc.param.mcstrack", "imc.concept.ptp_modes")
def test_a_tracking_move_follows_its_target() -> None:
    card = ready_card()
    set_now(card, ("mcstrack", FLAG))
    move_absolute(card, 500)
    card.advance(100)
    assert (card.read("curpos"), card.read("moving"), card.read("mcsgo")) == (500, 0, FLAG)
    send(card, IFIFO, ("mcstgpos", -100))
    card.advance(100)
    assert card.read("curpos") == -100
    set_now(card, ("mcsgo", 0), ("mcstrack", 0), ("mcstgpos", 900))
    card.advance(100)
    assert card.read("curpos") == -100


@pytest.mark.covers("imc.IMC_MoveVelocity", "imc.concept.units")
@shows("mcspos moving")
@pytest.mark.covers("imc.concept.jog", "imc.param.mcstgvel", "imc.param.mcsvel")
def test_continuous_motion_ramps_to_its_velocity_and_back_to_rest() -> None:
    card = ready_card()
    card.push(IFIFO, Write(address("mcstgvel"), 100 * 65536, 0, 2))
    velocities = trace(card, "mcsvel", 150)
    assert velocities[:3] == [1, 2, 3]
    assert set(velocities[99:]) == {100.0}
    card.push(IFIFO, Write(address("mcstgvel"), 0, 0, 2))
    card.wait()
    assert (card.read("mcsvel"), card.read("moving")) == (0, 0)
    assert card.read("mcspos") == sum(range(100)) + 100 * 51 + sum(range(100))


@pytest.mark.covers("imc.IMC_MoveVelocity", "imc.concept.jog")
@shows("mcstgvel mcsvel")
@pytest.mark.covers("imc.param.mcsdecel")
def test_continuous_motion_turns_through_standstill() -> None:
    card = ready_card()
    set_now(card, ("mcstgvel", 2.5), ("mcsdecel", 2))
    card.advance(5)
    set_now(card, ("mcstgvel", -2))
    assert trace(card, "mcsvel", 5) == [0.5, 0, -1, -2, -2]


@pytest.mark.covers("imc.IMC_MoveVelocity")
@shows(
    "curpos curvel enasyn encp error homepos mcspos mcstgvel outsettle outtrack poserr "
    "poserrlim settlewin slavedist startsyn synsrc synsrcvar syntype trackwin"
)
@pytest.mark.covers("imc.concept.position_overflow")
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(("overflow", "after"), [("origin", 50.0), ("wrap", -(2.0**31) + 50)])
@pytest.mark.covers("imc.param.mcsaccel", "imc.param.sethome")
def test_a_position_that_leaves_32_bits_does_not_disturb_the_motion(
    overflow: str, after: float, way: int
) -> None:
    card = ready_card(f'overflow = "{overflow}"\n[[axis]]\nlag_s = 0.005\ngain = 50.0\n[[axis]]\n')
    set_now(card, ("homepos", (2**31 - 150) * way), ("sethome", FLAG))
    card.advance(1)
    set_now(
        card,
        ("mcstgvel", 100 * way),
        ("mcsaccel", 100),
        ("poserrlim", 2000),
        ("trackwin", 2000),
        ("settlewin", 2000),
    )
    pace = (
        ("synsrc", address("curpos"), 1),
        ("syntype", FLAG, 1),
        ("synsrcvar", 400, 1),
        ("slavedist", 90, 1),
    )
    set_now(card, *pace, ("enasyn", FLAG, 1), ("startsyn", FLAG, 1))
    card.advance(2)
    names = ("curpos", "mcspos", "curvel", "error")
    assert [card.read(name) for name in names] == [after * way, after * way, 100 * way, 0]
    assert card.read("mcspos", 1) == 45  # half of the way of 400
    places = []
    for _ in range(40):
        card.advance(1)
        places.append((card.read("poserr"), card.read("curpos") - card.read("encp")))
        assert (card.read("outtrack"), card.read("outsettle"), card.read("error")) == (0, 0, 0)
    assert all((shown - between) % 2**32 == 0 for shown, between in places)
    assert (card.read("mcspos", 1), card.read("startsyn", 1)) == (90, 0)


@shows("curpos error homepos mcsgo")
@pytest.mark.covers("imc.param.sethome")
def test_a_relative_move_beyond_32_bits_is_refused_with_an_error_bit() -> None:
    card = ready_card()
    set_now(card, ("homepos", 2**31 - 100), ("sethome", FLAG), ("stopfilt", 0))
    card.advance(1)
    move_relative(card, 200)
    card.advance(5)
    assert (card.read("curpos"), card.read("error"), card.read("mcsgo")) == (2**31 - 100, 0x200, 0)


@pytest.mark.covers("imc.IMC_MoveSuperimposed")
@shows("curpos curvel mcspos mcstgpos mcsvel")
@pytest.mark.covers(
    "imc.concept.superposition",
    "imc.concept.mcs_pcs",
    "imc.param.pcsgo",
    "imc.param.pcsdist",
    "imc.param.pcspos",
)
@pytest.mark.covers("imc.param.pcsmoving", "imc.param.pcstgpos", "imc.param.pcsvel", "imc.param.shiftmaster")
def test_a_superimposed_move_adds_to_whatever_the_axis_does() -> None:
    card = ready_card()
    set_now(card, ("shiftmaster", FLAG))
    move_absolute(card, 4000)
    card.advance(30)
    move_relative(card, 500, system="pcs")
    card.advance(2)
    assert card.read("pcsmoving") == FLAG
    assert card.read("curvel") == card.read("mcsvel") + card.read("pcsvel")
    card.wait()
    assert [card.read(n) for n in ("mcspos", "pcspos", "curpos", "mcstgpos")] == [4000, 500, 4500, 4000]
    assert card.read("pcstgpos") == 500


@pytest.mark.covers("imc.IMC_MoveSuperimposed")
@shows("mcstgpos")
@pytest.mark.covers("imc.param.shiftmaster", "imc.param.pcsdist")
def test_shiftmaster_decides_whether_the_target_takes_part_in_a_superimposed_move() -> None:
    for shift, distance, target in ((0, 500, 600), (0, -700, -600), (FLAG, 500, 100), (1, -700, 100)):
        card = ready_card()
        set_now(card, ("shiftmaster", shift), ("mcstgpos", 100))
        move_relative(card, distance, system="pcs")
        card.wait()
        assert card.read("mcstgpos") == target


@pytest.mark.covers("imc.concept.mcs_pcs")
@shows("curpos curvel mcspos mcsvel")
@pytest.mark.covers(
    "imc.param.pcstgvel",
    "imc.param.pcsvel",
    "imc.param.pcsmaxvel",
    "imc.param.pcsaccel",
    "imc.param.pcsdecel",
    "imc.param.pcsslope",
    "imc.param.pcstgpos",
    "imc.param.pcstrack",
    "imc.param.pcsmoving",
)
@pytest.mark.covers("imc.param.pcsgo", "imc.param.pcspos")
def test_the_auxiliary_system_has_the_motions_of_the_main_one() -> None:
    card = ready_card()
    set_now(card, ("pcstgvel", 4), ("pcsaccel", 2))
    assert trace(card, "pcsslope", 3) == [FLAG, FLAG, 0]
    assert (card.read("pcsvel"), card.read("mcsvel"), card.read("curvel")) == (4, 0, 4)
    set_now(card, ("pcstgvel", 0), ("pcsdecel", 4))
    card.advance(2)
    assert (card.read("pcsmoving"), card.read("pcspos")) == (0, 2 + 4 + 4)
    set_now(card, ("pcstrack", FLAG), ("pcsmaxvel", 2), ("pcstgpos", 50), ("pcsgo", FLAG))
    assert max(trace(card, "pcsvel", 60)) == 2
    set_now(card, ("pcstgpos", 10))
    card.advance(60)
    assert (card.read("pcspos"), card.read("curpos"), card.read("mcspos")) == (10, 10, 0)


@shows("mcsaccel mcsdecel moving")
@pytest.mark.covers("imc.param.smooth", "imc.param.smoothing", "imc.param.curvel", "imc.param.curpos")
@pytest.mark.parametrize("span", [2, 17, 64])
def test_smoothing_is_the_mean_of_the_last_increments_and_loses_nothing(span: int) -> None:
    plain, smooth = ready_card(), ready_card()
    set_now(smooth, ("smooth", span))
    steps = []
    for card in (plain, smooth):
        set_now(card, ("mcsaccel", 3.7), ("mcsdecel", 5.3))
        move_absolute(card, 1234)
        steps.append(trace(card, "curvel", 200))
    padded = [0.0] * span + steps[0]
    mean = [sum(padded[k + 1 : k + 1 + span]) / span for k in range(len(steps[0]))]
    assert steps[1] == pytest.approx(mean, abs=2 / 65536)
    assert (smooth.read("curpos"), smooth.read("moving"), smooth.read("smoothing")) == (1234, 0, 0)


@shows("curpos")
@pytest.mark.covers("imc.param.smooth")
@pytest.mark.covers("imc.param.profiling", "imc.param.smoothing", "imc.param.moving", "imc.param.mcsmoving")
def test_moving_lasts_as_long_as_smoothing_does() -> None:
    card = ready_card()
    set_now(card, ("smooth", 32))
    move_absolute(card, 400)
    card.advance(42)
    assert [card.read(n) for n in ("mcsmoving", "profiling", "smoothing", "moving")] == [0, 0, FLAG, FLAG]
    card.advance(32)
    assert (card.read("moving"), card.read("curpos")) == (0, 400)


@shows("curpos curvel mcstgvel moving")
@pytest.mark.covers("imc.param.hpause")
@pytest.mark.covers("imc.param.pcstgvel")
def test_pause_brakes_every_axis_and_lets_it_go_on() -> None:
    card = ready_card()
    move_absolute(card, 3000, 0)
    set_now(card, ("mcstgvel", 20, 1), ("mcstgvel", -17, 3), ("pcstgvel", 6, 2))
    card.advance(40)
    send(card, IFIFO, ("hpause", FLAG))
    card.advance(60)
    held = card.read("curpos", 0)
    assert [card.read("curvel", i) for i in range(4)] == [0] * 4
    assert card.read("moving", 0) == FLAG
    card.advance(50)
    assert card.read("curpos", 0) == held < 3000
    send(card, IFIFO, ("hpause", 0))
    card.advance(300)
    assert card.read("curpos", 0) == 3000
    assert [card.read("curvel", i) for i in (1, 2, 3)] == [20, 6, -17]


@shows("curvel mcstgvel")
def test_haltstep_pauses_one_axis_at_once_or_with_its_deceleration() -> None:
    for mode, after in ((0, 0.0), (FLAG, 19.0)):
        card = ready_card()
        set_now(card, ("mcstgvel", 20), ("haltmode", mode))
        card.advance(30)
        set_now(card, ("haltstep", FLAG))
        card.advance(1)
        assert card.read("curvel") == after
        set_now(card, ("haltstep", 0))
        card.advance(30)
        assert card.read("curvel") == 20


@shows("curpos encp mcsgo")
@pytest.mark.covers("imc.param.run", "imc.param.ena")
@pytest.mark.covers("imc.param.poserr")
def test_an_axis_out_of_run_plans_nothing_and_one_without_ena_moves_nothing() -> None:
    card = ready_card()
    set_now(card, ("run", 0, 1), ("ena", 0, 2))
    for i in range(3):
        move_absolute(card, 100, i)
    card.advance(60)
    assert [card.read("curpos", i) for i in range(3)] == [100, 0, 100]
    assert card.read("mcsgo", 1) == 0
    assert [card.kernel.servo.actual[i] for i in range(3)] == [100, 0, 0]
    assert (card.read("encp", 2), card.read("poserr", 2)) == (0, 100)


@shows("run ena hpause startgroup contouring groupnum groupsmooth group_x")
@pytest.mark.covers("imc.param.pfifoenable", "imc.param.segabs", "imc.type.F16")
@pytest.mark.parametrize("flag", [FLAG, 1, 0x2000])
def test_any_number_but_0_sets_the_flags_of_an_axis_and_of_the_card(flag: int) -> None:
    card = ready_card()
    set_now(card, ("run", 0, 1), ("ena", 0, 1))
    card.advance(1)
    set_now(card, ("run", flag, 1), ("ena", flag, 1), ("mcstgvel", -3, 1))
    card.advance(8)
    set_now(card, ("hpause", flag))
    card.advance(9)
    here = [card.read("curpos", 1), card.kernel.servo.actual[1], card.read("curvel", 1)]
    assert here == [-24, -24, 0]  # 1 + 2 + 6 * 3, and 2 + 1 to rest
    set_now(card, ("hpause", 0), ("mcstgvel", 0, 1))
    set_now(card, ("groupnum", 1), ("group_x", 1), ("groupsmooth", 4), ("startgroup", flag))
    assert card.push_points([-20])
    card.advance(2)
    assert (card.read("curpos", 1), card.read("contouring", 1)) == (-34, FLAG)
    card.advance(8)
    set_now(card, ("startgroup", 0), ("segmap_x1", 1), ("pathabs", flag, 1), ("startpath1", flag))
    assert card.push(PFIFO1, Segment((-61,)))
    card.wait()
    assert card.kernel.servo.actual[1] == -61


@shows("curpos encp mcsmaxvel moving")
@pytest.mark.covers(
    "imc.param.motion",
    "imc.param.settlewin",
    "imc.param.settlen",
    "imc.param.trackwin",
    "imc.param.outsettle",
    "imc.param.outtrack",
    "imc.param.poserr",
)
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(("window", "length"), [(3, 11), (7, 23)])
def test_motion_ends_when_the_error_has_stayed_in_its_window(way: int, window: int, length: int) -> None:
    card = ready_card("[[axis]]\nlag_s = 0.02\ngain = 40.0\n")
    set_now(card, ("settlewin", window), ("settlen", length), ("trackwin", 37), ("mcsmaxvel", 20))
    move_absolute(card, 1000 * way)
    names = ("poserr", "curpos", "encp", "outsettle", "outtrack", "moving", "motion")
    seen = []
    for _ in range(600):
        card.advance(1)
        seen.append(dict(zip(names, (card.read(name) for name in names), strict=True)))
    errors = [each["poserr"] for each in seen]
    assert max(error * way for error in errors) > 100  # what is commanded runs ahead
    quiet = 0
    for each in seen:
        assert each["poserr"] == each["curpos"] - each["encp"]
        assert (each["outsettle"] == FLAG) == (abs(each["poserr"]) > window)
        assert (each["outtrack"] == FLAG) == (abs(each["poserr"]) > 37)
        quiet = 0 if each["moving"] or each["outsettle"] else quiet + 1
        assert (each["motion"] == 0) == (quiet >= length)
    assert (seen[-1]["motion"], {each["outtrack"] for each in seen}) == (0, {0, FLAG})
    moved = sum(each["moving"] != 0 for each in seen)
    assert sum(each["motion"] != 0 for each in seen) > moved + length


@shows("mcsgo")
@pytest.mark.covers("imc.param.settlen", "imc.param.motion", "imc.param.outtrack")
@pytest.mark.covers("imc.param.profiling", "imc.param.moving")
def test_motion_of_an_ideal_axis_lasts_settlen_cycles_longer() -> None:
    card = ready_card()
    set_now(card, ("settlen", 7))
    move_absolute(card, 400)
    shown = dict.fromkeys(("mcsgo", "profiling", "moving", "motion", "outtrack"), 0)
    for _ in range(100):
        card.advance(1)
        for name in shown:
            shown[name] += card.read(name) != 0
    assert shown == {"mcsgo": 39, "profiling": 40, "moving": 40, "motion": 46, "outtrack": 0}


@pytest.mark.covers("imc.param.breakp", "imc.param.status")
def test_status_tells_whether_the_breakpoint_is_passed() -> None:
    card = ready_card()
    set_now(card, ("breakp", 50))
    move_absolute(card, 100)
    seen = []
    for _ in range(40):
        card.advance(1)
        seen.append((card.read("curpos") >= 50, card.read("status") == 1))
    assert all(a == b for a, b in seen)
    assert (seen[0][1], seen[-1][1]) == (False, True)


@shows("curpos encp mcspos poserr")
@pytest.mark.covers("imc.param.sethome", "imc.param.homepos")
@pytest.mark.covers("imc.param.pcspos")
def test_sethome_makes_the_present_position_the_origin() -> None:
    card = ready_card()
    move_absolute(card, 700)
    move_relative(card, 50, system="pcs")
    card.wait()
    set_now(card, ("gohome", 0), ("homepos", 25), ("sethome", FLAG))
    card.advance(1)
    assert [card.read(n) for n in ("curpos", "encp", "mcspos", "pcspos", "poserr")] == [25, 25, 25, 0, 0]
    assert (card.read("homed"), card.read("sethome")) == (FLAG, 0)
    move_absolute(card, 0)
    card.wait()
    assert card.kernel.servo.actual[0] == 725


@pytest.mark.covers("imc.IMC_SetMulParam")
@pytest.mark.covers("imc.param.mcsdist")
def test_moves_of_several_axes_in_one_instruction_start_together() -> None:
    card = ready_card()
    writes = [setting("mcsdist", 300, i) for i in range(4)] + [setting("mcsgo", FLAG, i) for i in range(4)]
    card.push(QFIFO, WriteMany(tuple(writes)))
    card.advance(10)
    assert len({card.read("mcspos", i) for i in range(4)}) == 1


@shows("curpos encp error mcspos mcstgpos")
@pytest.mark.covers("imc.param.clear")
@pytest.mark.covers("imc.param.aiolat", "imc.param.encs", "imc.param.pcspos", "imc.param.pcstgpos")
def test_clear_puts_an_axis_at_zero_without_errors() -> None:
    card = ready_card()
    move_absolute(card, 500)
    card.wait()
    card.turn_handwheel(0, 70)
    card.state.memory[0, address("aiolat")] = 5
    set_now(card, ("error", 3), ("pcsdist", -37), ("pcsgo", FLAG), ("breakp", -1000))
    card.advance(70)
    names = ("mcspos", "mcstgpos", "curpos", "encp", "pcspos", "pcstgpos", "error", "encs", "aiolat")
    assert all(card.read(n) != 0 for n in names if not n.startswith("pcs"))
    set_now(card, ("clear", FLAG))
    card.advance(1)
    assert [card.read(n) for n in (*names, "clear")] == [0] * 10


@shows("curpos encp mcspos")
@pytest.mark.covers("imc.param.ciraxis", "imc.param.cirpos")
def test_a_ring_axis_counts_its_turns() -> None:
    card = ready_card()
    set_now(card, ("cirpos", 1000), ("ciraxis", FLAG))
    move_relative(card, 3600)
    card.wait()
    assert [card.read(n) for n in ("curpos", "mcspos", "encp", "cirswap")] == [600, 600, 600, 3]
    move_relative(card, -700)
    card.wait()
    assert (card.read("curpos"), card.read("cirswap")) == (900, 2)
    assert card.kernel.servo.actual[0] == 2900


@shows("curpos")
@pytest.mark.covers("imc.param.cirpos", "imc.param.ciraxis")
def test_a_two_way_ring_goes_below_zero() -> None:
    card = ready_card()
    set_now(card, ("cirpos", 1000), ("ciraxis", FLAG), ("biciraxis", FLAG))
    move_relative(card, -1300)
    card.wait()
    assert (card.read("curpos"), card.read("cirswap")) == (-300, -1)


@shows("curpos mcsaccel mcstgvel")
@pytest.mark.covers("imc.param.encp", "imc.param.encpvel", "imc.param.encpfactor")
def test_the_main_encoder_is_scaled_and_shows_its_speed() -> None:
    card = ready_card("[[axis]]\ncounts_per_pulse = 4.0\n")
    set_now(card, ("encpfactor", 0.25), ("mcstgvel", 10), ("mcsaccel", 10))
    card.advance(10)
    assert (card.read("encp"), card.read("encpvel"), card.read("curpos")) == (100, 10, 100)
    set_now(card, ("encpfactor", 1.0))
    card.advance(1)
    assert (card.read("encp"), card.read("encpvel")) == (140, 40)
    set_now(card, ("encpfactor", 0.3125))
    for k in range(1, 12):  # 12.5 a cycle: halves are kept
        card.advance(1)
        assert (card.read("encp"), card.read("encpvel")) == (140 + 25 * k // 2, 12.5)


@shows("encp encpvel")
@pytest.mark.covers("imc.param.ena", "imc.param.encpctr")
@pytest.mark.covers("imc.param.poserr")
def test_feedback_can_follow_the_command() -> None:
    card = ready_card()
    set_now(card, ("encpctr", -0x8000), ("ena", 0), ("smooth", 5), ("pcstgvel", 3), ("mcsmaxvel", 8))
    move_absolute(card, 100)
    card.advance(7)
    assert 0 != card.read("encpvel") == card.read("curvel") != card.read("mcsvel")
    assert 0 < card.read("encp") == card.read("curpos") < card.read("mcspos") + card.read("pcspos")
    set_now(card, ("pcstgvel", 0), ("pcstgpos", 0))
    card.wait()
    set_now(card, ("mcstgpos", 100 - int(card.read("pcspos"))), ("mcsgo", FLAG))
    card.wait()
    assert (card.read("encp"), card.read("poserr"), card.kernel.servo.actual[0]) == (100, 0, 0)


@shows("mcsgo mcstgvel")
@pytest.mark.covers("imc.param.profiling", "imc.param.moving", "imc.param.mcsmoving", "imc.param.pcsmoving")
@pytest.mark.covers("imc.param.motion")
@pytest.mark.parametrize("name", ["mcsgo", "pcsgo", "mcstgvel", "pcstgvel"])
@pytest.mark.covers("imc.param.pcsgo", "imc.param.pcstgvel")
def test_an_axis_that_has_just_been_told_to_move_shows_it_before_the_next_cycle(name: str) -> None:
    card = ready_card()
    system = name[:3]
    set_now(card, (f"{system}tgpos", 500, 3), (name, FLAG if name.endswith("go") else 7, 3))
    shown = ("mcsmoving", "pcsmoving", "profiling", "moving", "motion")
    expected = [FLAG if word[:3] in (system, "pro", "mov", "mot") else 0 for word in shown]
    assert [card.read(word, 3) for word in shown] == expected
    assert [card.read(word, 2) for word in shown] == [0] * 5


@shows("curpos encp homepos mcspos poserr")
@pytest.mark.covers("imc.param.encpfactor", "imc.param.sethome")
@pytest.mark.covers("imc.param.encpvel")
def test_the_origin_is_set_in_the_scale_of_the_encoder() -> None:
    card = ready_card("number_of_axes = 3\n[[axis]]\n[[axis]]\n[[axis]]\ncounts_per_pulse = 4.0\n")
    move_absolute(card, 700, 2)
    card.wait()
    set_now(card, ("encpfactor", 0.375, 2), ("homepos", 25, 2), ("sethome", FLAG, 2))
    card.advance(1)
    assert [card.read(name, 2) for name in ("curpos", "encp", "mcspos", "poserr")] == [25, 25, 25, 0]
    card.advance(5)
    assert [card.read(name, 2) for name in ("curpos", "encp", "encpvel")] == [25, 25, 0]
    move_relative(card, 40, 2)
    card.wait()
    assert [card.read(name, 2) for name in ("curpos", "encp")] == [65, 25 + 60]


@pytest.mark.covers("imc.IMC_MoveVelocity", "imc.IMC_MoveRelative")
@pytest.mark.parametrize("system", ["mcs", "pcs"])
def test_of_a_move_and_a_velocity_in_one_cycle_the_last_counts(system: str) -> None:
    go = (setting(f"{system}dist", 7000, 1), setting(f"{system}go", FLAG, 1))
    velocity = setting(f"{system}tgvel", -3, 1)
    for writes, after in (((*go, velocity), -3), ((velocity, *go), 10)):
        card = ready_card()
        set_now(card, (f"{system}maxvel", 10, 1))
        assert card.push(IFIFO, WriteMany(writes))
        card.advance(40)
        assert card.read(f"{system}vel", 1) == after
