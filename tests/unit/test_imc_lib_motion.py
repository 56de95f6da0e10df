"""Functions of motion on a card: moves, homing, gears, synchronous motion."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from polycnc.controllers.imc import Card, parse_card
from polycnc.controllers.imc import imclib as lib
from polycnc.machine import Poll
from support.imc_card import shows
from support.imc_network import Program

IF, Q, P1, P2, C = lib.FIFO_SEL


@pytest.fixture
def program() -> Iterator[Program]:
    yield Program()
    lib.detach()


@shows("curpos")
@pytest.mark.covers("imc.param.mcstgpos", "imc.param.mcsdist", "imc.param.mcsgo")
@pytest.mark.covers("imc.IMC_MoveAbsolute")
def test_absolute_move(program: Program) -> None:
    program.ok(lib.IMC_MoveAbsolute, 6250, 1, Q)
    program.rest(1)
    assert (program.get("curpos", 1), program.get("mcsgo", 1)) == (6250, 0)
    program.card.write("mcsdist", 999, axis=1)  # left over: the function does not become relative
    program.ok(lib.IMC_MoveAbsolute, -100, 1, IF)
    program.rest(1)
    assert (program.get("curpos", 1), program.get("curpos", 0)) == (-100, 0)


@shows("curpos")
@pytest.mark.covers("imc.IMC_MoveAbsolute", "imc.IMC_WaitParam", "imc.param.moving")
@pytest.mark.covers("imc.IMC_MoveRelative")
def test_relative_move_counts_from_where_the_axis_is_when_it_starts(program: Program) -> None:
    program.ok(lib.IMC_MoveAbsolute, 1000, 0, Q)
    program.ok(lib.IMC_WaitParam, lib.movingLoc, 0, 0, 0, Q)
    program.ok(lib.IMC_MoveRelative, -300, 0, Q)
    program.ok(lib.IMC_WaitParam, lib.movingLoc, 0, 0, 0, Q)
    program.ok(lib.IMC_MoveRelative, 50, 0, Q)
    program.run(1000)
    assert program.get("curpos") == 750


@shows("curpos")
@pytest.mark.covers("imc.IMC_MoveRelative", "imc.IMC_MoveSuperimposed", "imc.IMC_Phasing")
@pytest.mark.parametrize(
    ("move", "system"), [("IMC_MoveRelative", "mcs"), ("IMC_MoveSuperimposed", "pcs"), ("IMC_Phasing", "pcs")]
)
def test_a_relative_move_by_nothing_goes_nowhere(program: Program, move: str, system: str) -> None:
    program.card.write(f"{system}tgpos", 5000)
    program.ok(getattr(lib, move), 0, 0, IF)
    program.run(500)
    assert program.get("curpos") == 0


@shows("curpos mcsvel")
@pytest.mark.covers(
    "imc.IMC_MoveVelocity",
    "imc.concept.mcs_pcs",
    "imc.concept.superposition",
    "imc.param.pcsdist",
    "imc.param.pcspos",
)
@pytest.mark.covers("imc.IMC_MoveSuperimposed")
def test_superimposed_move_adds_to_what_the_axis_does(program: Program) -> None:
    for axis in (0, 1):
        program.ok(lib.IMC_MoveVelocity, 10 * 65536, axis, IF)
    program.run(100)
    program.ok(lib.IMC_MoveSuperimposed, 250, 1, IF)
    program.run(200)
    assert program.get("curpos", 1) - program.get("curpos", 0) == 250
    assert (program.get("pcspos", 1), program.get("mcsvel", 1)) == (250, 10 * 65536)


@shows("curpos curvel")
@pytest.mark.covers("imc.concept.jog", "imc.concept.units", "imc.param.mcsvel")
@pytest.mark.covers("imc.IMC_MoveVelocity")
def test_velocity_is_kept_until_another_is_given(program: Program) -> None:
    program.ok(lib.IMC_MoveVelocity, 100 * 65536, 0, IF)
    program.run(200)
    assert program.get("mcsvel") == 100 * 65536 == 0x640000
    before = program.get("curpos")
    program.run(1000)
    assert program.get("curpos") - before == 100_000
    program.ok(lib.IMC_MoveVelocity, -50 * 65536, 0, IF)
    program.run(200)
    assert program.get("mcsvel") == -50 * 65536
    program.ok(lib.IMC_MoveVelocity, 0, 0, IF)
    program.rest(0)
    assert program.get("curvel") == 0


@shows("curpos")
@pytest.mark.covers("imc.IMC_GearFree", "imc.param.pcsdist")
@pytest.mark.covers("imc.IMC_Phasing", "imc.concept.superposition")
@pytest.mark.parametrize(("source", "passed_on"), [(2, 0), (0, 100)])
def test_phasing_shifts_a_master_against_slaves_that_follow_its_mcsvel(
    program: Program, source: int, passed_on: int
) -> None:
    program.ok(lib.IMC_GearFree, 1.0, 0, source, 1, IF)
    program.ok(lib.IMC_MoveVelocity, 10 * 65536, 0, IF)
    program.run(200)
    before = program.get("curpos", 0) - program.get("curpos", 1)
    program.ok(lib.IMC_Phasing, 100, 0, IF)
    program.run(400)
    shifted = program.get("curpos", 0) - program.get("curpos", 1) - before
    assert shifted == pytest.approx(100 - passed_on, abs=12 if source == 0 else 0)


# The origin switch is on from 5000 to 5600; index pulses are at 130 + 400 k.
HOMING = """
ready = true
[[axis]]
[[axis]]
[[axis]]
origin = [5000, 5600]
index = { first = 130, pitch = 400 }
parameters = { highvel = 20.0, lowvel = 2.0, homepos = 0, homestpos = 77, indexNum = 2 }
[[axis]]
"""


def homed(name: str, *arguments: int, start: int = 0) -> tuple[int, int]:
    """Home an axis that is not the first; return where the origin is, as a machine position, and where it ends."""
    program = Program(HOMING)
    if start:
        program.ok(lib.IMC_MoveAbsolute, start, 2, IF)
        program.rest(2)
    program.ok(getattr(lib, name), *arguments, 2, IF)
    program.rest(2)
    assert (program.get("homed", 2), program.get("gohome", 2)) == (-1, 0)
    assert program.get("encp", 2) == program.get("curpos", 2)
    assert [program.get(word, axis) for word in ("homed", "curpos") for axis in (0, 1, 3)] == [0] * 6
    end = program.get("curpos", 2)
    machine = round(program.card.state.axis[2]["machine"] / 65536)
    lib.detach()
    return machine - end, end


@pytest.mark.covers("imc.const.direction", "imc.const.RiseEdge", "imc.const.stop")
@pytest.mark.parametrize(
    ("name", "arguments", "start", "origin", "end"),
    [
        # One pass at 20 pulses/ms: the end is beyond the origin by the way of braking, 20²/2 pulses.
        pytest.param(
            "IMC_HomeSwitch1", (0, 1, 0), 0, 5000, 200, marks=pytest.mark.covers("imc.IMC_HomeSwitch1")
        ),
        ("IMC_HomeSwitch1", (0, 0, 0), 0, 5600, 200),
        ("IMC_HomeSwitch1", (1, 1, 0), 9000, 5600, -200),
        ("IMC_HomeSwitch1", (1, 0, 0), 9000, 5000, -200),
        ("IMC_HomeSwitch1", (0, 1, 1), 0, 5000, 77),
        # Back at 2 pulses/ms: braking takes 2 pulses.
        pytest.param(
            "IMC_HomeSwitch2", (0, 1, 0), 0, 5000, -2, marks=pytest.mark.covers("imc.IMC_HomeSwitch2")
        ),
        ("IMC_HomeSwitch2", (1, 1, 0), 9000, 5600, 2),
        ("IMC_HomeSwitch2", (0, 0, 1), 0, 5600, 77),
        pytest.param(
            "IMC_HomeSwitch3", (0, 1, 0), 0, 5000, 2, marks=pytest.mark.covers("imc.IMC_HomeSwitch3")
        ),
        ("IMC_HomeSwitch3", (1, 0, 0), 9000, 5000, -2),
        # Pulses after the edge at 5000 are at 5330 and 5730; in front of it at 4930 and 4530.
        pytest.param(
            "IMC_HomeSwitchIndex1",
            (0, 1, 0),
            0,
            5730,
            200,
            marks=pytest.mark.covers("imc.IMC_HomeSwitchIndex1"),
        ),
        pytest.param(
            "IMC_HomeSwitchIndex2",
            (0, 1, 0),
            0,
            4530,
            -2,
            marks=pytest.mark.covers("imc.IMC_HomeSwitchIndex2"),
        ),
        pytest.param(
            "IMC_HomeSwitchIndex3",
            (0, 1, 1),
            0,
            5730,
            77,
            marks=pytest.mark.covers("imc.IMC_HomeSwitchIndex3"),
        ),
        pytest.param("IMC_HomeIndex", (0, 0), 0, 530, 200, marks=pytest.mark.covers("imc.IMC_HomeIndex")),
        ("IMC_HomeIndex", (1, 1), 1000, 530, 77),
    ],
)
def test_homing(name: str, arguments: tuple[int, ...], start: int, origin: int, end: int) -> None:
    found, stopped = homed(name, *arguments, start=start)
    assert found == pytest.approx(origin, abs=1)
    assert stopped == pytest.approx(end, abs=12 if abs(end) == 200 else 2)


HOMING_SPEEDS = {  # the speeds that an axis has on its ways, one after the other, in the direction of the search
    "IMC_HomeSwitch1": [20],
    "IMC_HomeSwitch2": [20, -2],
    "IMC_HomeSwitch3": [20, -2, 2],
    "IMC_HomeSwitchIndex1": [20],
    "IMC_HomeSwitchIndex2": [20, -2],
    "IMC_HomeSwitchIndex3": [20, -2, 2],
    "IMC_HomeIndex": [20],
}


@shows("gohome homepos mcsaccel mcsdecel mcsvel")
@pytest.mark.covers("imc.concept.homing", "imc.param.highvel", "imc.param.lowvel", "imc.const.direction")
@pytest.mark.parametrize(
    ("name", "speeds"),
    [
        pytest.param(name, speeds, marks=pytest.mark.covers(f"imc.{name}"))
        for name, speeds in HOMING_SPEEDS.items()
    ],
)
def test_homing_has_its_two_speeds(program: Program, name: str, speeds: list[int]) -> None:
    lib.detach()
    for way in (1, -1):
        program = Program(HOMING)
        for rate in ("mcsaccel", "mcsdecel"):  # so high that every speed is reached at once
            program.card.write(rate, 2.5, axis=2)
        if way < 0:
            program.card.write("homepos", 9000, axis=2)
            program.ok(lib.IMC_MoveAbsolute, 9000, 2, IF)
            program.rest(2)
        edge = () if name == "IMC_HomeIndex" else (1,)
        program.ok(getattr(lib, name), int(way < 0), *edge, 0, 2, IF)
        tops: list[int] = []
        before = 0
        for _ in range(1500):
            speed = program.get("mcsvel", 2)
            if speed * before <= 0 and speed != 0:
                tops.append(0)
            if abs(speed) > abs(tops[-1] if tops else 0):
                tops[-1] = speed
            before = speed
            if program.get("gohome", 2) == 0 and tops:
                break
            program.run(1)
        assert tops == [each * way * 65536 for each in speeds]
        assert program.get("homed", 2) == -1
        lib.detach()


@shows("mcsvel")
@pytest.mark.covers("imc.concept.gear_law", "imc.param.engear", "imc.param.gearoutmod", "imc.param.mcsaccel")
@pytest.mark.covers("imc.IMC_GearFree")
def test_free_gear_follows_with_the_ramp_of_the_slave(program: Program) -> None:
    program.ok(lib.IMC_MoveVelocity, 10 * 65536, 0, IF)
    program.run(100)
    program.card.write("mcsaccel", 0.5, axis=1)
    program.ok(lib.IMC_GearFree, 0.5, 0, 0, 1, IF)
    program.run(6)
    assert 0 < program.get("mcsvel", 1) < 5 * 65536
    program.run(20)
    assert program.get("mcsvel", 1) == 5 * 65536
    program.ok(lib.IMC_GearFree, -1.0, 0, 0, 1, IF)
    program.run(10)
    assert -10 * 65536 < program.get("mcsvel", 1) < 5 * 65536
    program.run(100)
    assert program.get("mcsvel", 1) == -10 * 65536
    program.set("engear", 0, 1)
    program.ok(lib.IMC_MoveVelocity, 0, 0, IF)
    program.run(200)
    assert (program.get("mcsvel", 0), program.get("mcsvel", 1)) == (0, -10 * 65536)  # gearoutmod 0


@shows("curpos mcsvel")
@pytest.mark.covers("imc.concept.startsyn", "imc.param.startsyn")
@pytest.mark.covers("imc.IMC_GearInDist", "imc.concept.gear_dist_law")
def test_gear_over_a_distance_waits_for_startsyn(program: Program) -> None:
    program.ok(lib.IMC_GearInDist, 1.0, 0, 0, 0, 0, 1000, 1, IF)
    program.ok(lib.IMC_MoveVelocity, 10 * 65536, 0, IF)
    program.run(300)
    assert program.get("curpos", 1) == 0
    program.set("startsyn", -1, 1)
    program.run(1)
    start = program.get("curpos", 0)
    program.until(lambda: program.get("startsyn", 1) == 0)
    assert program.get("curpos", 0) - start == pytest.approx(1000, abs=20)
    assert program.get("curpos", 1) == pytest.approx(500, abs=15)
    program.run(1)
    assert program.get("mcsvel", 1) == 10 * 65536
    gap = program.get("curpos", 0) - program.get("curpos", 1)
    program.run(500)
    assert program.get("curpos", 0) - program.get("curpos", 1) == pytest.approx(gap, abs=1)


@shows("curpos mcsvel")
@pytest.mark.covers("imc.concept.startsyn", "imc.param.startsyn")
@pytest.mark.covers("imc.IMC_GearInTime", "imc.concept.gear_time_law")
def test_gear_over_a_time_waits_for_startsyn(program: Program) -> None:
    program.ok(lib.IMC_MoveVelocity, 10 * 65536, 0, IF)
    program.ok(lib.IMC_GearInTime, 2.0, 0, 0, 200, 1, IF)
    program.run(300)
    assert program.get("curpos", 1) == 0
    program.set("startsyn", -1, 1)
    cycles = program.until(lambda: program.get("mcsvel", 1) == 20 * 65536)
    assert cycles == pytest.approx(200, abs=2)
    assert program.get("curpos", 1) == pytest.approx(2000, abs=40)


@shows("curpos")
@pytest.mark.covers("imc.param.gearoutmod", "imc.param.engear")
@pytest.mark.covers("imc.IMC_HandWheel")
def test_handwheel(program: Program) -> None:
    program.ok(lib.IMC_HandWheel, 10.0, 2, 1, IF)
    program.run(5)
    program.card.turn_handwheel(2, 4)
    program.run(100)
    assert program.get("curpos", 1) == 40
    program.set("gearoutmod", -1, 1)
    program.set("engear", 0, 1)
    program.run(5)
    program.card.turn_handwheel(2, 4)
    program.run(100)
    assert program.get("curpos", 1) == 40


@shows("curpos enasyn mcsvel")
@pytest.mark.covers(
    "imc.concept.sync_laws", "imc.concept.startsyn", "imc.param.startsyn", "imc.param.slaveabs"
)
@pytest.mark.covers("imc.IMC_MoveTP")
def test_position_over_time(program: Program) -> None:
    program.ok(lib.IMC_MoveInTime, 1000, 5000, 1, IF)
    program.run(100)
    assert program.get("curpos", 1) == 0
    program.set("startsyn", -1, 1)
    program.run(1)
    speeds = []
    for _ in range(990):
        program.run(1)
        speeds.append(program.get("mcsvel", 1) / 65536)
    # from rest to rest with one rise: half as fast again as the mean at half time, and as slow in the end as at first
    assert speeds[0] < 0.1
    assert speeds[989] < 0.4
    assert max(speeds) == pytest.approx(7.5, abs=0.1)
    assert max(speeds) - speeds[498] < 0.01
    assert 4900 < program.get("curpos", 1) < 5000
    program.run(12)
    assert (program.get("curpos", 1), program.get("mcsvel", 1)) == (5000, 0)
    assert (program.get("startsyn", 1), program.get("enasyn", 1)) == (0, 0)
    program.card.write("slaveabs", -1, axis=1)  # left over: it is a distance all the same
    program.ok(lib.IMC_MoveInTime, 300, -700, 1, IF)
    program.set("startsyn", -1, 1)
    program.run(305)
    assert program.get("curpos", 1) == 4300


@shows("curpos mcsvel")
@pytest.mark.covers("imc.concept.sync_laws", "imc.param.enasyn", "imc.param.startsyn")
@pytest.mark.covers("imc.IMC_MovePP", "imc.concept.startsyn")
def test_position_over_the_way_of_another_axis(program: Program) -> None:
    program.ok(lib.IMC_MoveInDist, 2000, 0, 500, 1, IF)
    program.set("startsyn", -1, 1)
    program.ok(lib.IMC_MoveVelocity, 10 * 65536, 0, IF)
    program.run(100)
    assert program.get("curpos", 1) == 0  # enasyn is not set
    program.set("startsyn", 0, 1)
    program.set("enasyn", -1, 1)
    program.set("startsyn", -1, 1)
    program.run(1)
    start = program.get("curpos", 0)
    program.until(lambda: program.get("curpos", 0) - start >= 1000)
    assert program.get("curpos", 1) == pytest.approx(250, abs=15)
    program.until(lambda: program.get("startsyn", 1) == 0)
    assert program.get("curpos", 0) - start == pytest.approx(2000, abs=20)
    program.run(200)
    assert (program.get("curpos", 1), program.get("mcsvel", 1)) == (500, 0)


@shows("curpos mcsvel startsyn")
@pytest.mark.covers("imc.concept.sync_laws", "imc.concept.startsyn")
@pytest.mark.covers("imc.IMC_MoveTV")
def test_velocity_over_time(program: Program) -> None:
    program.ok(lib.IMC_TgvelInTime, 500, 100 * 65536, 1, IF)
    program.run(100)
    assert program.get("curpos", 1) == 0
    program.set("startsyn", -1, 1)
    program.run(1)
    program.run(250)
    assert program.get("mcsvel", 1) == pytest.approx(50 * 65536, rel=0.01)
    program.run(252)
    assert program.get("mcsvel", 1) == 100 * 65536
    program.run(500)
    assert program.get("mcsvel", 1) == 100 * 65536


@shows("curpos mcsvel startsyn")
@pytest.mark.covers("imc.concept.startsyn", "imc.param.enasyn")
@pytest.mark.covers("imc.IMC_MovePV", "imc.concept.sync_laws")
def test_velocity_over_the_way_of_another_axis(program: Program) -> None:
    program.ok(lib.IMC_MoveVelocity, 10 * 65536, 0, IF)
    program.run(100)
    program.ok(lib.IMC_TgvelInDist, 1000, 0, -20 * 65536, 1, IF)
    program.run(50)
    assert program.get("curpos", 1) == 0
    program.set("enasyn", -1, 1)
    program.set("startsyn", -1, 1)
    program.run(1)
    cycles = program.until(lambda: program.get("startsyn", 1) == 0)
    assert cycles == pytest.approx(100, abs=2)
    program.run(300)
    assert program.get("mcsvel", 1) == -20 * 65536


@shows("curpos")
@pytest.mark.covers("imc.IMC_MoveAbsolute")
def test_a_poll_may_go_to_the_next_rest_of_an_axis() -> None:
    program = Program(clock=Poll(1000))
    program.ok(lib.IMC_MoveAbsolute, 6250, 0, Q)
    polls = 1
    while program.get("moving") != 0:
        polls += 1
    assert (polls, program.get("curpos")) == (1, 6250)
    assert program.card.clock.cycles == pytest.approx(160, abs=3)  # curpos was read in the same cycle
    lib.detach()


@pytest.mark.covers("imc.IMC_GetParam32", "imc.IMC_Open")
def test_two_cards_keep_in_step() -> None:
    cards = Card(parse_card("ready = true")), Card(parse_card("ready = true"))
    lib.attach(*cards)
    handles = [lib.IMC_Open(0, number)[1] for number in (0, 1)]
    for handle in handles:
        assert handle is not None
        assert lib.IMC_MoveVelocity(handle, 10 * 65536, 0, Q) == lib.IMC_OK
    first = handles[0]
    assert first is not None
    while lib.IMC_GetParam32(first, lib.curposLoc, 0)[1] < 1000:
        pass
    assert cards[0].clock.cycles == cards[1].clock.cycles
    assert cards[0].read("curpos") == cards[1].read("curpos") >= 1000
    lib.detach()


@pytest.mark.covers("imc.param.encpfactor")
@pytest.mark.parametrize(
    ("code", "cycles"),
    [
        pytest.param(code, cycles, marks=pytest.mark.covers(f"imc.synsourcetype.{code}"))
        for code, cycles in enumerate((420, 210, 700, 1050, 300))
    ],
)
@pytest.mark.covers("imc.IMC_GearInDist", "imc.const.synsourcetype")
@pytest.mark.covers("imc.param.pcstgvel")
def test_each_sync_source_paces_the_engagement_by_its_own_quantity(
    program: Program, code: int, cycles: int
) -> None:
    # Axis 2 shows five speeds: curpos 5, encp 10 (by its factor), mcspos 3, pcspos 2, encs 7 pulses per cycle.
    program.card.write("encpfactor", 2, 2)
    program.card.spin_handwheel(2, 7)
    program.ok(lib.IMC_MoveVelocity, 3 * 65536, 2, IF)
    program.set("pcstgvel", 2 * 65536, 2)
    program.ok(lib.IMC_MoveVelocity, 8 * 65536, 0, IF)
    program.run(50)
    program.ok(lib.IMC_GearInDist, 0.5, 0, 0, 2, code, 2100, 1, IF)
    program.set("startsyn", -1, 1)
    program.run(1)
    needed = program.until(lambda: program.get("startsyn", 1) == 0)
    assert needed == pytest.approx(cycles, abs=3)
    program.run(1)
    assert program.get("curvel", 1) == 4 * 65536
