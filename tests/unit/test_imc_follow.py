"""Coupled motion: gears of every source, leaving them, handwheel, phasing, led-in engagement, synchronous motion."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise

import pytest

from polycnc.controllers.imc import Card
from polycnc.controllers.imc.core._instructions import WriteMany
from polycnc.controllers.imc.core._parameters import address
from support.imc_card import (
    FLAG,
    IFIFO,
    PFIFO1,
    enable_path,
    event,
    install,
    line,
    move_absolute,
    move_relative,
    ready_card,
    send,
    set_now,
    setting,
    shows,
    trace,
)

CURVEL, ENCPVEL, MCSVEL, PCSVEL, ENCSVEL = (
    address(name) for name in ("curvel", "encpvel", "mcsvel", "pcsvel", "encsvel")
)


def gear(card, ratio: float, source: int = CURVEL, master: int = 0, axis: int = 1) -> None:  # type: ignore[no-untyped-def]
    """Engage a gear as the library does."""
    send(
        card,
        IFIFO,
        ("gearratio", ratio, axis),
        ("master", master, axis),
        ("gearsrc", source, axis),
        ("engear", FLAG, axis),
    )


@pytest.mark.covers("imc.IMC_GearFree")
@pytest.mark.covers("imc.param.gearratio", "imc.param.mcsaccel", "imc.param.mcsdecel")
@pytest.mark.covers("imc.param.engear", "imc.param.master", "imc.param.gearsrc", "imc.concept.gear_law")
@pytest.mark.covers("imc.param.mcsslope", "imc.param.mcstgvel", "imc.param.mcsvel")
def test_a_free_gear_ramps_to_ratio_times_the_source_and_follows_a_new_ratio() -> None:
    card = ready_card()
    send(card, IFIFO, ("mcstgvel", 10, 2))
    card.advance(20)
    set_now(card, ("mcsaccel", 0.5, 1), ("mcsdecel", 2, 1))
    gear(card, 0.5, master=2)
    assert trace(card, "mcsvel", 12, 1)[:3] == [0.5, 1, 1.5]
    assert card.read("mcsvel", 1) == 5
    assert card.read("mcsslope", 1) == 0
    set_now(card, ("gearratio", -1, 1))
    assert trace(card, "mcsvel", 4, 1) == [3, 1, 0, -0.5]
    card.advance(30)
    assert card.read("mcsvel", 1) == -10
    set_now(card, ("mcstgvel", 30, 2))  # the locked slave keeps up whatever its own rates are
    card.advance(15)
    assert card.read("mcsvel", 1) == -card.read("mcsvel", 2) < -20


@pytest.mark.covers("imc.IMC_GearFree", "imc.type.S16.32")
@pytest.mark.covers("imc.param.gearratio", "imc.concept.gear_law")
@pytest.mark.covers("imc.param.mcspos")
def test_a_ratio_is_exact_over_any_time() -> None:
    card = ready_card()
    gear(card, 0)
    card.advance(1)
    raw = round(2**32 / 3)
    card.write_raw(address("gearratio"), raw, 1, 3)
    card.advance(1)
    move_absolute(card, 300_001)
    card.wait()
    exact = Fraction(300_001 * raw, 2**32)
    units = card.read_raw(address("mcspos") - 1, 1, 3)
    assert units == (exact * 65536).__floor__()
    move_absolute(card, 0)
    card.wait()
    assert abs(card.read_raw(address("mcspos") - 1, 1, 3)) <= 1


@pytest.mark.covers("imc.IMC_GearFree", "imc.IMC_HandWheel")
@shows("curpos")
@pytest.mark.covers(*(f"imc.sourcetype.{k}" for k in range(5)), "imc.const.sourcetype")
@pytest.mark.parametrize(
    ("source", "moved"), [(CURVEL, 1100), (ENCPVEL, 1100), (MCSVEL, 1000), (PCSVEL, 100), (ENCSVEL, 7)]
)
@pytest.mark.covers("imc.param.shiftmaster")
def test_a_gear_follows_the_parameter_that_it_points_to(source: int, moved: int) -> None:
    card = ready_card()
    set_now(card, ("shiftmaster", FLAG))
    gear(card, 1.0, source)
    card.advance(1)
    move_absolute(card, 1000)
    move_relative(card, 100, system="pcs")
    card.turn_handwheel(0, 7)
    card.wait()
    card.advance(1)
    assert card.read("curpos", 0) == 1100
    assert card.read("curpos", 1) == moved


@pytest.mark.covers("imc.IMC_Phasing", "imc.IMC_GearFree", "imc.concept.superposition")
@shows("curpos")
def test_phasing_of_a_master_does_not_reach_a_slave_of_its_main_system() -> None:
    for source, slave in ((MCSVEL, 0), (CURVEL, 50)):
        card = ready_card()
        gear(card, 0.5, source)
        card.advance(1)
        move_relative(card, 100, 0, system="pcs")
        card.wait()
        assert (card.read("curpos", 0), card.read("curpos", 1)) == (100, slave)


@pytest.mark.covers("imc.IMC_GearFree", "imc.concept.gear_law")
@shows("mcstgvel")
@pytest.mark.covers("imc.param.gearoutmod", "imc.param.gearoutvel", "imc.param.engear")
@pytest.mark.parametrize(("mode", "speed", "after"), [(0, 3, 5), (FLAG, 3, 3), (FLAG, 0, 0)])
@pytest.mark.covers("imc.param.mcsvel")
def test_a_slave_that_leaves_keeps_its_speed_or_takes_another(mode: int, speed: float, after: float) -> None:
    card = ready_card()
    send(card, IFIFO, ("mcstgvel", 10), ("gearoutmod", mode, 1), ("gearoutvel", speed, 1))
    gear(card, 0.5)
    card.advance(30)
    send(card, IFIFO, ("engear", 0, 1))
    card.advance(10)
    assert card.read("mcsvel", 1) == after
    send(card, IFIFO, ("mcstgvel", 20))
    card.advance(30)
    assert card.read("mcsvel", 1) == after


@pytest.mark.covers("imc.IMC_HandWheel")
@shows("curpos master")
@pytest.mark.covers("imc.param.engear")
@pytest.mark.covers("imc.param.encs", "imc.param.encsvel", "imc.param.encsfactor", "imc.param.clrencs")
def test_a_handwheel_moves_its_axis_by_counts_times_ratio() -> None:
    card = ready_card()
    gear(card, 10, ENCSVEL, master=3, axis=0)
    card.advance(1)
    card.turn_handwheel(3, 4)
    card.advance(3)
    assert (card.read("encs", 3), card.read("curpos", 0)) == (4, 40)
    set_now(card, ("encsfactor", 0.5, 3))
    card.turn_handwheel(3, -6)
    card.advance(1)
    assert (card.read("encs", 3), card.read("encsvel", 3)) == (1, -3)
    card.advance(1)
    assert (card.read("curpos", 0), card.read("encsvel", 3)) == (10, 0)
    set_now(card, ("clrencs", FLAG, 3), ("engear", 0, 0))
    card.turn_handwheel(3, 2)
    card.advance(3)
    assert (card.read("encs", 3), card.read("curpos", 0)) == (1, 10)


@pytest.mark.covers("imc.IMC_HandWheel")
@shows("curpos")
@pytest.mark.covers("imc.param.encs")
def test_a_steady_handwheel_gives_a_steady_speed() -> None:
    card = ready_card()
    gear(card, 2, ENCSVEL)
    card.spin_handwheel(0, 0.25)
    card.advance(401)
    assert (card.read("encs"), card.read("curpos", 1)) == (100, 200)


def _in_distance(card, start: bool) -> None:  # type: ignore[no-untyped-def]
    set_now(card, ("synsrc", address("curpos"), 1), ("synaxis", 0, 1), ("synsrcvar", 1000, 1))
    set_now(card, ("syntype", 0, 1), ("enasyn", FLAG, 1))
    gear(card, 1.0)
    if start:
        send(card, IFIFO, ("startsyn", FLAG, 1))


@pytest.mark.covers("imc.IMC_GearInDist")
@shows("curvel engear mcstgvel startsyn")
@pytest.mark.covers(
    "imc.concept.gear_dist_law", "imc.param.synsrc", "imc.param.synaxis", "imc.param.synsrcvar"
)
@pytest.mark.covers("imc.param.enasyn")
def test_a_gear_engages_over_a_distance_of_its_pacing_parameter() -> None:
    card = ready_card()
    _in_distance(card, start=True)
    card.advance(1)
    send(card, IFIFO, ("mcstgvel", 10))
    while card.read("curpos", 0) < 500:
        card.advance(1)
    assert card.read("curvel", 1) == pytest.approx(5, abs=0.15)
    while card.read("curpos", 0) < 1100:
        card.advance(1)
    # the linear law: half the way while it engages, all of it after that
    behind = card.read_raw(224, 0, 3) - card.read_raw(224, 1, 3)
    assert behind / 65536 == pytest.approx(500, abs=0.01)
    assert card.read("curvel", 1) == 10
    assert (card.read("startsyn", 1), card.read("enasyn", 1), card.read("engear", 1)) == (0, 0, FLAG)


@pytest.mark.covers("imc.IMC_GearInDist")
@shows("curpos moving")
@pytest.mark.covers("imc.param.startsyn", "imc.concept.startsyn")
def test_nothing_engages_before_startsyn() -> None:
    card = ready_card()
    _in_distance(card, start=False)
    send(card, IFIFO, ("mcstgvel", 10))
    card.advance(300)
    assert (card.read("curpos", 1), card.read("moving", 1)) == (0, 0)


@pytest.mark.covers("imc.IMC_GearInDist", "imc.IMC_InstallEvent", "imc.concept.startsyn")
@shows("curpos curvel mcstgvel startsyn")
def test_an_event_starts_the_engagement() -> None:
    card = ready_card()
    _in_distance(card, start=False)
    install(
        card,
        event("CMP32i", first=225, constant=1000),
        event("SET16", "Edge_GreatEqu", constant=-1, target=address("startsyn"), target_axis=1),
    )
    send(card, IFIFO, ("mcstgvel", 10))
    card.advance(100)
    assert card.read("curpos", 1) == 0
    card.advance(200)
    assert card.read("curvel", 1) == 10


@pytest.mark.covers("imc.IMC_GearInTime", "imc.concept.startsyn")
@shows("curvel mcstgvel")
@pytest.mark.covers("imc.param.synsrc", "imc.param.synsrcvar", "imc.param.enasyn", "imc.param.startsyn")
@pytest.mark.covers("imc.concept.gear_time_law")
@pytest.mark.covers("imc.param.ticks")
def test_a_gear_engages_over_a_time() -> None:
    card = ready_card()
    send(card, IFIFO, ("mcstgvel", 10))
    card.advance(20)
    set_now(card, ("synsrc", address("ticks"), 1), ("synsrcvar", 200, 1), ("enasyn", FLAG, 1))
    gear(card, -2.0)
    card.advance(10)
    assert card.read("curvel", 1) == 0
    send(card, IFIFO, ("startsyn", FLAG, 1))
    card.advance(100)
    assert card.read("curvel", 1) == pytest.approx(-10, abs=0.11)
    card.advance(100)
    assert card.read("startsyn", 1) == 0
    card.advance(1)
    assert card.read("curvel", 1) == -20
    assert card.read("curpos", 1) == pytest.approx(-20 * 100 - 20, abs=1)


def _timed(card, cycles: int, axis: int = 1) -> None:  # type: ignore[no-untyped-def]
    set_now(card, ("synsrc", address("ticks"), axis), ("synsrcvar", cycles, axis), ("enasyn", FLAG, axis))


@pytest.mark.covers("imc.IMC_MoveTP", "imc.concept.startsyn")
@shows("curpos curvel")
@pytest.mark.covers("imc.param.synsrcvar", "imc.param.enasyn", "imc.param.startsyn")
@pytest.mark.covers("imc.param.syntype", "imc.param.slavedist", "imc.param.slaveabs", "imc.concept.sync_laws")
@pytest.mark.parametrize(("absolute", "distance", "end"), [(0, 5000, 5100), (FLAG, 5000, 5000), (0, -70, 30)])
@pytest.mark.covers("imc.param.moving")
def test_a_distance_is_moved_in_a_time_and_ends_at_rest(absolute: int, distance: int, end: int) -> None:
    card = ready_card()
    move_absolute(card, 100, 1)
    card.wait()
    set_now(card, ("syntype", FLAG, 1), ("slavedist", distance, 1), ("slaveabs", absolute, 1))
    _timed(card, 1000)
    card.advance(50)
    assert card.read("curpos", 1) == 100
    send(card, IFIFO, ("startsyn", FLAG, 1))
    card.advance(500)
    assert card.read("curpos", 1) == pytest.approx((100 + end) / 2, abs=1)
    card.advance(499)
    assert (card.read_raw(224, 1, 3) == end * 65536, card.read("startsyn", 1)) == (False, FLAG)
    card.advance(1)
    assert (card.read("curpos", 1), card.read("startsyn", 1), card.read("enasyn", 1)) == (end, 0, 0)
    card.advance(1)
    assert (card.read("curvel", 1), card.read("moving", 1), card.read("curpos", 1)) == (0, 0, end)


@pytest.mark.covers("imc.IMC_MovePP", "imc.concept.startsyn", "imc.concept.sync_laws")
@shows("curpos moving")
@pytest.mark.covers(
    "imc.param.syntype", "imc.param.synsrc", "imc.param.synaxis", "imc.param.synsrcvar", "imc.param.slavedist"
)
@pytest.mark.covers("imc.param.enasyn")
@pytest.mark.parametrize("name", ["curpos", "encp", "mcspos", "pcspos", "encs"])
@pytest.mark.covers(
    "imc.param.encp",
    "imc.param.encs",
    "imc.param.mcspos",
    "imc.param.mcstgvel",
    "imc.param.pcspos",
    "imc.param.pcstgvel",
    "imc.param.startsyn",
)
def test_a_distance_is_moved_within_the_distance_of_another_parameter(name: str) -> None:
    card = ready_card()
    set_now(card, ("synsrc", address(name), 1), ("synaxis", 0, 1), ("synsrcvar", 2000, 1))
    set_now(card, ("syntype", FLAG, 1), ("slavedist", 500, 1), ("startsyn", FLAG, 1))
    start = {"pcspos": "pcstgvel", "encs": ""}.get(name, "mcstgvel")
    if start:
        send(card, IFIFO, (start, 10))
    else:
        card.spin_handwheel(0, 10)
    card.advance(150)
    assert card.read("curpos", 1) == 0  # enasyn is not set
    send(card, IFIFO, ("startsyn", 0, 1), ("startsyn", FLAG, 1), ("enasyn", FLAG, 1))
    began = card.read(name)
    while card.read(name) < began + 1000:
        card.advance(1)
    assert card.read("curpos", 1) == pytest.approx(250, abs=8)
    while card.read(name) < began + 2030:
        card.advance(1)
    assert (card.read("curpos", 1), card.read("moving", 1), card.read("startsyn", 1)) == (500, 0, 0)


@pytest.mark.covers("imc.IMC_MoveTV", "imc.concept.sync_laws")
@shows("mcstgvel mcsvel startsyn")
@pytest.mark.covers("imc.param.syntype")
def test_a_velocity_is_reached_in_a_time_and_kept() -> None:
    card = ready_card()
    send(card, IFIFO, ("mcstgvel", 20, 1))
    card.advance(30)
    set_now(card, ("syntype", 0, 1))
    _timed(card, 500)
    send(card, IFIFO, ("mcstgvel", 100, 1), ("startsyn", FLAG, 1))
    card.advance(250)
    assert card.read("mcsvel", 1) == 60
    card.advance(250)
    assert (card.read("mcsvel", 1), card.read("startsyn", 1)) == (100, 0)
    card.advance(100)
    assert card.read("mcsvel", 1) == 100
    send(card, IFIFO, ("mcstgvel", 0, 1))
    card.wait()
    assert card.read("mcsvel", 1) == 0


@pytest.mark.covers("imc.IMC_MovePV", "imc.concept.sync_laws")
@shows("mcstgvel mcsvel startsyn")
@pytest.mark.covers("imc.param.synsrc", "imc.param.synaxis", "imc.param.synsrcvar", "imc.param.enasyn")
@pytest.mark.covers("imc.param.mcspos")
def test_a_velocity_is_reached_within_a_distance_of_another_axis() -> None:
    card = ready_card()
    set_now(card, ("synsrc", address("mcspos"), 1), ("synaxis", 2, 1), ("synsrcvar", 1000, 1))
    send(card, IFIFO, ("mcstgvel", 40, 1), ("startsyn", FLAG, 1), ("mcstgvel", 10, 2))
    card.advance(50)
    assert card.read("mcsvel", 1) == 0
    began = card.read("mcspos", 2)
    send(card, IFIFO, ("enasyn", FLAG, 1))
    while card.read("mcspos", 2) < began + 500:
        card.advance(1)
    assert card.read("mcsvel", 1) == pytest.approx(20, abs=0.5)
    card.advance(60)
    assert (card.read("mcsvel", 1), card.read("enasyn", 1), card.read("startsyn", 1)) == (40, 0, 0)


@pytest.mark.covers("imc.IMC_MoveTP")
@shows("moving slavedist startsyn syntype")
def test_synchronous_motion_that_is_given_up_brakes() -> None:
    card = ready_card()
    set_now(card, ("syntype", FLAG, 1), ("slavedist", 5000, 1))
    _timed(card, 1000)
    send(card, IFIFO, ("startsyn", FLAG, 1))
    card.advance(300)
    send(card, IFIFO, ("startsyn", 0, 1))
    card.wait()
    assert card.read("moving", 1) == 0
    assert 500 < card.read("curpos", 1) < 2500


@pytest.mark.covers("imc.IMC_GearFree", "imc.concept.gear_law")
@pytest.mark.covers("imc.param.curpos", "imc.param.curvel")
def test_a_chain_of_gears_acts_within_the_cycle() -> None:
    card = ready_card()
    gear(card, 2, CURVEL, 0, 1)
    gear(card, -0.5, CURVEL, 1, 2)
    card.advance(1)
    move_absolute(card, 1000)
    for _ in range(40):
        card.advance(1)
        assert card.read("curvel", 1) == 2 * card.read("curvel", 0)
        assert card.read("curvel", 2) == -card.read("curvel", 0)
    card.wait()
    assert [card.read("curpos", i) for i in range(3)] == [1000, 2000, -1000]


@pytest.mark.covers("imc.IMC_MoveSuperimposed", "imc.concept.superposition")
def test_a_superimposed_move_shifts_a_slave() -> None:
    card = ready_card()
    gear(card, 1.0)
    send(card, IFIFO, ("mcstgvel", 10))
    card.advance(100)
    ahead = card.read("curpos", 1) - card.read("curpos", 0)
    move_relative(card, 250, 1, system="pcs")
    card.advance(100)
    assert card.read("curpos", 1) - card.read("curpos", 0) == ahead + 250


def _tgvel_in(card, cycles: int, speed: float, axis: int = 1) -> None:  # type: ignore[no-untyped-def]
    """Set up a motion to a velocity in a time with one instruction, as the library does."""
    values = {"syntype": 0, "synsrc": address("ticks"), "synaxis": 0, "synsrcvar": cycles, "mcstgvel": speed}
    writes = (*values.items(), ("enasyn", FLAG))
    assert card.push(IFIFO, WriteMany(tuple(setting(name, value, axis) for name, value in writes)))


def _event_stop(card) -> None:  # type: ignore[no-untyped-def]
    install(
        card,
        event("CMP32i", first=address("user32b3"), constant=7),
        event("SET32", "Edge_GreatEqu", constant=0, target=address("mcstgvel"), target_axis=1),
    )
    card.advance(2)
    set_now(card, ("user32b3", 9))


STOPS: dict[str, Callable[[Card], None]] = {
    "velocity 0": lambda card: send(card, IFIFO, ("mcstgvel", 0, 1)),
    "event": _event_stop,
    "go 0": lambda card: send(card, IFIFO, ("mcsgo", 0, 1)),
}


@pytest.mark.covers("imc.IMC_MoveTV", "imc.IMC_MoveTP", "imc.IMC_GearInDist")
@shows("curvel enasyn engear mcstgvel moving")
@pytest.mark.parametrize("stop", ["velocity 0", "event"])
@pytest.mark.parametrize("pending", ["tgvel", "gear", "gear left", "distance"])
@pytest.mark.covers("imc.param.slavedist", "imc.param.synsrcvar", "imc.param.syntype")
def test_a_synchronous_motion_that_never_started_swallows_no_stop(pending: str, stop: str) -> None:
    card = ready_card()
    send(card, IFIFO, ("mcstgvel", 13, 1))
    card.advance(20)
    if pending == "tgvel":
        _tgvel_in(card, 300, 41)
    elif pending == "distance":
        set_now(card, ("syntype", FLAG, 1), ("slavedist", 377, 1), ("synsrcvar", 210, 1), ("enasyn", FLAG, 1))
    else:
        _in_distance(card, start=False)
    card.advance(5)
    assert card.read("curvel", 1) == 13
    if pending == "gear left":
        send(card, IFIFO, ("engear", 0, 1))
        card.advance(2)
        assert card.read("curvel", 1) == 13
    STOPS[stop](card)
    card.wait([1], 1.0)
    assert (card.read("curvel", 1), card.read("moving", 1)) == (0, 0)


@pytest.mark.covers("imc.IMC_MovePV", "imc.IMC_MovePP", "imc.IMC_GearInDist")
@shows("curvel enasyn engear mcstgvel moving startsyn synsrcvar")
@pytest.mark.parametrize("stop", STOPS)
@pytest.mark.parametrize("running", ["tgvel", "gear", "distance"])
@pytest.mark.covers("imc.param.slavedist", "imc.param.synaxis", "imc.param.synsrc", "imc.param.syntype")
def test_a_synchronous_motion_whose_source_stands_still_swallows_no_stop(running: str, stop: str) -> None:
    card = ready_card()
    send(card, IFIFO, ("mcstgvel", 13, 1))
    card.advance(20)
    set_now(card, ("synsrc", address("curpos"), 1), ("synaxis", 2, 1), ("synsrcvar", 777, 1))
    if running == "distance":
        set_now(card, ("syntype", FLAG, 1), ("slavedist", 377, 1))
    if running == "gear":
        _in_distance(card, start=True)
    else:
        send(card, IFIFO, ("enasyn", FLAG, 1), ("startsyn", FLAG, 1))
    card.advance(5)
    STOPS[stop](card)
    card.wait([1], 1.0)
    assert (card.read("curvel", 1), card.read("moving", 1)) == (0, 0)
    assert [card.read(name, 1) for name in ("startsyn", "enasyn", "engear")] == [0, 0, 0]


@pytest.mark.covers("imc.IMC_MoveTV", "imc.concept.startsyn")
@shows("curpos mcstgvel mcsvel moving startsyn")
def test_the_goal_of_a_synchronous_motion_does_not_move_its_axis_before_the_start() -> None:
    card = ready_card()
    _tgvel_in(card, 250, 37)
    card.advance(30)
    assert (card.read("curpos", 1), card.read("moving", 1), card.read("mcstgvel", 1)) == (0, 0, 37)
    send(card, IFIFO, ("startsyn", FLAG, 1))
    card.advance(250)
    assert (card.read("mcsvel", 1), card.read("startsyn", 1)) == (37, 0)
    _tgvel_in(card, 100, 0)  # a goal of 0 is a goal
    card.advance(30)
    assert card.read("mcsvel", 1) == 37
    send(card, IFIFO, ("startsyn", FLAG, 1))
    card.advance(50)
    assert card.read("mcsvel", 1) == 18.5
    card.advance(51)
    assert card.read("moving", 1) == 0


@pytest.mark.covers("imc.IMC_MoveTV")
@shows("enasyn mcstgvel mcsvel startsyn synsrc synsrcvar")
def test_the_goal_may_come_in_a_later_instruction_than_the_change_of_the_source() -> None:
    card = ready_card()
    for name, value in (("synsrc", address("ticks")), ("synsrcvar", 120), ("mcstgvel", 24), ("enasyn", FLAG)):
        send(card, IFIFO, (name, value, 1))
        card.advance(1)
    assert card.read("mcsvel", 1) == 0
    send(card, IFIFO, ("startsyn", FLAG, 1))
    card.advance(30)
    assert card.read("mcsvel", 1) == 6


@pytest.mark.covers("imc.IMC_MoveTP", "imc.IMC_GearInTime")
@shows("curpos enasyn engear startsyn")
@pytest.mark.covers(
    "imc.param.clear",
    "imc.param.slaveabs",
    "imc.param.slavedist",
    "imc.param.synsrc",
    "imc.param.syntype",
    "imc.param.ticks",
)
def test_clear_and_leaving_the_gear_end_a_synchronous_motion_so_that_the_next_one_starts() -> None:
    for name in ("clear", "engear"):
        card = ready_card()
        send(card, IFIFO, ("mcstgvel", 10))
        card.advance(20)
        set_now(card, ("synsrc", address("ticks"), 1), ("synsrcvar", 400, 1), ("enasyn", FLAG, 1))
        gear(card, 0.7)
        card.advance(1)
        send(card, IFIFO, ("startsyn", FLAG, 1))
        card.advance(100)
        send(card, IFIFO, (name, FLAG if name == "clear" else 0, 1))
        card.advance(1)
        flags = ("startsyn", "enasyn", "engear")
        assert [card.read(flag, 1) for flag in flags] == [0, 0, 0]
        STOPS["velocity 0"](card)
        card.wait([1], 1.0)
        began = card.read("curpos", 1)
        set_now(card, ("syntype", FLAG, 1), ("slavedist", 333, 1), ("slaveabs", 0, 1))
        _timed(card, 130)
        send(card, IFIFO, ("startsyn", FLAG, 1))
        card.advance(131)
        assert (card.read("curpos", 1), card.read("startsyn", 1)) == (began + 333, 0)


@shows("curpos moving")
def test_a_gear_that_waits_for_its_start_is_left_without_touching_a_move() -> None:
    card = ready_card()
    move_absolute(card, 1234, 1)
    card.advance(10)
    _in_distance(card, start=False)
    card.advance(3)
    send(card, IFIFO, ("engear", 0, 1))
    card.wait()
    assert (card.read("curpos", 1), card.read("moving", 1)) == (1234, 0)


@pytest.mark.covers(
    "imc.param.enasyn", "imc.param.engear", "imc.param.run", "imc.param.startsyn", "imc.param.synsrcvar"
)
def test_a_coupling_that_cannot_begin_shows_that_it_was_refused() -> None:
    card = ready_card()
    set_now(card, ("run", 0, 1), ("enasyn", FLAG, 1), ("synsrcvar", 77, 1))
    send(card, IFIFO, ("engear", FLAG, 1), ("startsyn", FLAG, 1))
    card.advance(1)
    assert (card.read("engear", 1), card.read("startsyn", 1)) == (0, 0)


@pytest.mark.covers("imc.IMC_GearFree")
@shows("curpos mcstgvel")
@pytest.mark.covers(
    "imc.param.engear", "imc.param.gearratio", "imc.param.gearsrc", "imc.param.master", "imc.param.mcsvel"
)
def test_a_gear_engaged_on_a_path_is_refused_and_behind_it_follows() -> None:
    for queue, follows in ((IFIFO, False), (PFIFO1, True)):
        card = ready_card()
        enable_path(card, 1, 2)
        line(card, 150, 70, speed=10)
        card.advance(5)
        for name, value in (("gearratio", 0.75), ("master", 0), ("gearsrc", MCSVEL), ("engear", FLAG)):
            send(card, queue, (name, value, 1))
        card.advance(3)
        if not follows:
            assert card.read("engear", 1) == 0
        card.advance(40)
        assert [card.read("curpos", i) for i in range(3)] == [0, 150, 70]
        send(card, IFIFO, ("mcstgvel", 8))
        card.advance(40)
        assert (card.read("engear", 1), card.read("mcsvel", 1)) == ((FLAG, 6) if follows else (0, 0))


@pytest.mark.covers("imc.IMC_GearFree")
@shows("curpos engear mcstgvel moving startgroup")
@pytest.mark.parametrize("mover", ["path", "contour"])
@pytest.mark.covers("imc.param.group_x", "imc.param.groupnum", "imc.param.groupsmooth")
def test_a_path_or_contour_takes_a_slave_out_of_its_gear(mover: str) -> None:
    card = ready_card()
    send(card, IFIFO, ("mcstgvel", 9))
    gear(card, 0.6)
    card.advance(30)
    began = card.read("curpos", 1)
    if mover == "path":
        enable_path(card, 1)
        set_now(card, ("pathabs", 0, 1))
        line(card, 207, speed=10)
    else:
        set_now(card, ("group_x", 1), ("groupnum", 1), ("groupsmooth", 30), ("startgroup", FLAG))
        card.push_points([207])
    card.advance(60)
    assert (card.read("curpos", 1), card.read("engear", 1)) == (began + 207, 0)
    card.advance(10)
    assert card.read("moving", 1) == 0


@shows("curvel moving slavedist syntype")
@pytest.mark.covers("imc.param.mcsdecel", "imc.param.startsyn")
@pytest.mark.covers("imc.param.pcsmoving")
def test_taking_startsyn_back_brakes_with_the_rate_of_the_axis() -> None:
    card = ready_card()
    set_now(card, ("syntype", FLAG, 1), ("slavedist", 5000, 1), ("mcsdecel", 2, 1))
    _timed(card, 400)
    send(card, IFIFO, ("startsyn", FLAG, 1))
    card.advance(150)
    speed, place = card.read("curvel", 1), card.read("curpos", 1)
    assert speed > 15
    send(card, IFIFO, ("startsyn", 0, 1))
    steps = trace(card, "curvel", 30, 1)
    assert [a - b for a, b in pairwise(steps[1:6])] == [2.0] * 4
    assert (steps[-1], card.read("moving", 1), card.read("pcsmoving", 1)) == (0, 0, 0)
    assert place + speed * speed / 4 - speed < card.read("curpos", 1) < place + speed * speed / 4 + speed


@pytest.mark.covers("imc.IMC_GearFree")
@shows("engear mcstgvel mcsvel")
@pytest.mark.covers("imc.param.error", "imc.param.stopfilt")
def test_a_slave_whose_move_cannot_be_leaves_the_gear_and_stops() -> None:
    card = ready_card()
    set_now(card, ("stopfilt", 0, 1), ("mcstgvel", 10))
    gear(card, -0.5)
    card.advance(30)
    assert card.read("mcsvel", 1) == -5
    move_relative(card, -(2**31) + 3, 1)
    card.advance(20)
    assert (card.read("error", 1), card.read("engear", 1), card.read("mcsvel", 1)) == (0x200, 0, 0)
    assert card.read("mcsvel", 0) == 10


@pytest.mark.covers("imc.IMC_MovePP")
@shows("cirpos enasyn mcsaccel mcspos mcstgvel slavedist startsyn synaxis syntype")
@pytest.mark.covers("imc.param.synsrc", "imc.param.synsrcvar", "imc.param.ciraxis", "imc.concept.sync_laws")
@pytest.mark.parametrize("source", ["curpos", "mcspos", "encp"])
@pytest.mark.parametrize("speed", [7, -7])
def test_what_a_ring_axis_paces_does_not_notice_its_turns(source: str, speed: int) -> None:
    card = ready_card()
    set_now(card, ("cirpos", 90), ("ciraxis", FLAG), ("mcstgvel", speed), ("mcsaccel", 10))
    card.advance(5)
    pace = (("synsrc", address(source), 2), ("synaxis", 0, 2), ("synsrcvar", 280, 2))
    set_now(
        card, *pace, ("syntype", FLAG, 2), ("slavedist", 1000, 2), ("enasyn", FLAG, 2), ("startsyn", FLAG, 2)
    )
    card.advance(20)  # 140 pulses, more than a turn: half of the way, with a cubic that is symmetric
    assert card.read("mcspos", 2) == pytest.approx(500, abs=40)
    assert card.read("startsyn", 2) == FLAG
    card.advance(22)
    assert (card.read("mcspos", 2), card.read("startsyn", 2)) == (1000, 0)


@pytest.mark.covers("imc.IMC_GearFree")
@shows("gearratio gearsrc master mcsaccel mcstgvel mcsvel")
@pytest.mark.covers(
    "imc.param.engear", "imc.param.gearoutmod", "imc.param.gearoutvel", "imc.concept.gear_law"
)
@pytest.mark.parametrize(("mode", "after"), [(0, 3.0), (FLAG, -2.25)])
def test_a_gear_that_is_left_on_its_ramp_keeps_its_speed_or_goes_to_gearoutvel(
    mode: int, after: float
) -> None:
    card = ready_card()
    set_now(card, ("mcstgvel", 10), ("mcsaccel", 10), ("mcsaccel", 0.5, 2), ("gearoutmod", mode, 2))
    card.advance(3)
    set_now(
        card, ("gearsrc", address("mcsvel"), 2), ("master", 0, 2), ("gearratio", 1, 2), ("engear", FLAG, 2)
    )
    card.advance(6)
    assert card.read("mcsvel", 2) == 3.0
    set_now(card, ("gearoutvel", -2.25, 2), ("engear", 0, 2))
    card.advance(20)
    assert (card.read("mcsvel", 2), card.read("engear", 2)) == (after, 0)
