"""Who moves an axis against every command: all pairs, with and without a gear that waits for startsyn beside it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import pytest

from polycnc.controllers.imc import Card
from polycnc.controllers.imc.core import _ownership as own
from polycnc.controllers.imc.core._homing import home_sequence
from polycnc.controllers.imc.core._instructions import WriteMany
from polycnc.controllers.imc.core._parameters import address
from support.imc_card import (
    FLAG,
    IFIFO,
    enable_path,
    line,
    ready_card,
    send,
    set_now,
    setting,
    shows,
    trace,
)

SLAVE = 1
FLAGS = ("mcsgo", "gohome", "engear", "startsyn", "enasyn")


def write(card: Card, **values: float) -> None:
    """Write parameters of the slave with one instruction."""
    assert card.push(IFIFO, WriteMany(tuple(setting(name, value, SLAVE) for name, value in values.items())))
    card.advance(1)


def master(card: Card) -> None:
    send(card, IFIFO, ("mcstgvel", 10, 0))
    card.advance(20)


def arm(card: Card, ratio: float = 0.7, cycles: int = 40) -> None:
    """Call IMC_GearInTime."""
    write(
        card,
        master=0,
        gearsrc=address("curvel"),
        gearratio=ratio,
        syntype=0,
        synsrc=address("ticks"),
        synaxis=0,
        synsrcvar=cycles,
        enasyn=FLAG,
        engear=FLAG,
    )


def move_in_time(card: Card) -> None:
    """Call IMC_MoveInTime."""
    ticks = address("ticks")
    write(card, syntype=FLAG, synsrc=ticks, synaxis=0, synsrcvar=300, slavedist=3210, slaveabs=0, enasyn=FLAG)


def engage(card: Card) -> None:
    """Call IMC_GearFree."""
    write(card, master=0, gearsrc=address("curvel"), gearratio=0.3, syntype=0, enasyn=0, engear=FLAG)


def start(card: Card) -> None:
    move_in_time(card)
    write(card, startsyn=FLAG)


def begin_engaging(card: Card) -> None:
    arm(card, 0.4, 80)
    write(card, startsyn=FLAG)


def begin_path(card: Card) -> None:
    enable_path(card, SLAVE)
    line(card, 4000, speed=3)


def begin_contour(card: Card) -> None:
    set_now(card, ("group_x", SLAVE), ("groupnum", 1), ("groupsmooth", 30), ("startgroup", FLAG))
    card.push_points([60] * 30)


def home(card: Card) -> None:
    way = home_sequence(switch=True, index=False, negative=True, rising=True, go_to=False)
    write(card, highvel=2.5, homeseq=way, gohome=FLAG)


OWNERS: dict[int, Callable[[Card], None]] = {
    own.AT_REST: lambda card: None,
    own.MOVES: lambda card: write(card, mcstgpos=6000, mcsgo=FLAG),
    own.RUNS: lambda card: write(card, mcstgvel=6),
    own.HOMES: home,
    own.SYNCHRONOUS: start,
    own.ENGAGING: begin_engaging,
    own.ENGAGED: engage,
    own.ON_PATH: begin_path,
    own.ON_CONTOUR: begin_contour,
}
COMMANDS: dict[int, Callable[[Card], None]] = {
    own.GO: lambda card: write(card, mcstgpos=-700, mcsgo=FLAG),
    own.NO_GO: lambda card: write(card, mcsgo=0),
    own.RUN_AT: lambda card: write(card, mcstgvel=-4),
    own.RUN_AT_0: lambda card: write(card, mcstgvel=0),
    own.HOME: home,
    own.NO_HOME: lambda card: write(card, gohome=0),
    own.ENGAGE: engage,
    own.ARM: arm,
    own.LEAVE: lambda card: write(card, engear=0),
    own.START: start,
    own.NO_START: lambda card: write(card, startsyn=0),
}
TAKEN = {
    own.GO: own.MOVES,
    own.RUN_AT: own.RUNS,
    own.HOME: own.HOMES,
    own.ENGAGE: own.ENGAGED,
    own.START: own.SYNCHRONOUS,
}
SHOWN = {  # flags that an owner keeps set
    own.MOVES: {"mcsgo"},
    own.HOMES: {"gohome"},
    own.SYNCHRONOUS: {"startsyn", "enasyn"},
    own.ENGAGING: {"startsyn", "enasyn", "engear"},
    own.ENGAGED: {"engear"},
}
WAITING = {"engear", "enasyn"}
OF_COUPLINGS = {own.ENGAGE, own.ARM, own.LEAVE, own.START, own.NO_START}


def owned(owner: int) -> Card:
    card = ready_card()
    set_now(card, ("mcsdecel", 0.25, SLAVE))
    master(card)
    OWNERS[owner](card)
    card.advance(30)
    assert own.owner_of(card.state, SLAVE) == owner
    return card


def flags(card: Card) -> set[str]:
    return {name for name in FLAGS if card.read(name, SLAVE) != 0}


def expected_owner(owner: int, command: int) -> int:
    effect = own.OWNERSHIP[owner, command]
    if effect in (own.KEEPS, own.REFUSES):
        return owner
    if effect == own.TAKES:
        return TAKEN[command]
    return (
        own.ENGAGED if (owner, command) == (own.ENGAGING, own.NO_START) else own.RUNS
    )  # it brakes, or runs on


@pytest.mark.covers("imc.concept.startsyn", "imc.IMC_GearFree", "imc.IMC_GearInTime", "imc.IMC_MoveTP")
@shows(
    "enasyn engear error gearratio gearsrc gohome group_x groupnum groupsmooth highvel "
    "homeseq master mcsdecel mcsgo mcstgpos mcstgvel mcsvel segmap_x1 slaveabs slavedist "
    "startgroup startsyn synaxis synsrc synsrcvar syntype"
)
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("owner", OWNERS)
def test_a_command_does_to_the_owner_of_an_axis_what_the_table_says(owner: int, command: int) -> None:
    card = owned(owner)
    COMMANDS[command](card)
    card.advance(1)
    after = expected_owner(owner, command)
    assert own.owner_of(card.state, SLAVE) == after
    waiting = {own.ARM: WAITING, own.START: {"enasyn"}}.get(command, set())
    kept = own.OWNERSHIP[owner, command] in (own.KEEPS, own.REFUSES)
    assert flags(card) == SHOWN.get(after, set()) | (waiting if kept else set())
    assert card.read("error", SLAVE) == 0
    speeds = trace(card, "mcsvel", 40, SLAVE)
    assert max(abs(b - a) for a, b in pairwise(speeds)) <= 1.01  # nothing stops dead


@shows(
    "curvel enasyn engear gearratio gearsrc gohome group_x groupnum groupsmooth highvel "
    "homeseq master mcsdecel mcsgo mcstgpos mcstgvel segmap_x1 slaveabs slavedist startgroup "
    "startsyn synaxis synsrc synsrcvar syntype"
)
@pytest.mark.parametrize("command", sorted(set(COMMANDS) - OF_COUPLINGS))
@pytest.mark.parametrize("owner", OWNERS)
@pytest.mark.covers("imc.IMC_GearInTime")
def test_a_gear_that_waits_outlives_every_motion_of_its_slave(owner: int, command: int) -> None:
    card = owned(owner)
    arm(card)
    COMMANDS[command](card)
    card.advance(20)
    assert flags(card) >= WAITING
    for stop in ("startpath1", "startgroup"):
        set_now(card, (stop, 0))
    write(card, mcstgvel=0)
    card.advance(240)
    assert (card.read("curvel", SLAVE), flags(card) >= WAITING) == (0, True)
    write(card, startsyn=FLAG)
    card.advance(45)
    assert card.read("curvel", SLAVE) == pytest.approx(7, abs=1e-4)
    assert flags(card) == {"engear"}


@shows(
    "enasyn engear gearratio gearsrc gohome group_x groupnum groupsmooth master mcsdecel "
    "mcsgo mcstgvel segmap_x1 startgroup startsyn synaxis synsrc synsrcvar syntype"
)
@pytest.mark.parametrize("owner", [own.ON_PATH, own.ON_CONTOUR])
def test_startsyn_on_a_path_is_refused_and_the_gear_waits_on(owner: int) -> None:
    card = owned(owner)
    arm(card)
    write(card, startsyn=FLAG)
    assert (own.owner_of(card.state, SLAVE), flags(card)) == (owner, WAITING)


@pytest.mark.covers("imc.IMC_GearInTime")
@shows(
    "curvel enasyn engear gearratio gearsrc master mcsdecel mcstgvel slaveabs slavedist "
    "startsyn synaxis synsrc synsrcvar syntype"
)
@pytest.mark.parametrize("owner", [own.SYNCHRONOUS, own.ENGAGING, own.ENGAGED])
def test_a_gear_that_waits_changes_nothing_of_the_coupling_that_runs(owner: int) -> None:
    plain, armed = owned(owner), owned(owner)
    arm(armed, -3.0, 17)
    plain.advance(1)
    before = trace(plain, "curvel", 50, SLAVE)
    assert trace(armed, "curvel", 50, SLAVE) == before


@pytest.mark.covers("imc.IMC_GearInTime", "imc.concept.startsyn")
@shows(
    "curvel enasyn engear gearratio gearsrc gohome master mcsdecel mcsgo mcstgvel slaveabs "
    "slavedist startsyn synaxis synsrc synsrcvar syntype"
)
@pytest.mark.parametrize("owner", [own.SYNCHRONOUS, own.ENGAGING])
def test_a_gear_that_waits_starts_when_startsyn_is_set_again_while_another_coupling_runs(owner: int) -> None:
    card = owned(owner)
    arm(card)
    write(card, startsyn=FLAG)
    card.advance(45)
    assert card.read("curvel", SLAVE) == pytest.approx(7, abs=1e-4)
    assert flags(card) == {"engear"}


@pytest.mark.covers("imc.IMC_MoveTP")
@shows("curpos enasyn engear gohome mcsgo slavedist startsyn synsrc synsrcvar syntype")
def test_a_gear_that_waits_is_kept_when_the_coupling_before_it_is_complete() -> None:
    card = owned(own.SYNCHRONOUS)
    arm(card)
    card.advance(1000)
    assert (card.read("curpos", SLAVE), flags(card)) == (3210, WAITING)


@shows(
    "emstop enasyn engear gearratio gearsrc gohome master mcsdecel mcsgo mcstgvel run "
    "startsyn synaxis synsrc synsrcvar syntype"
)
@pytest.mark.parametrize("ended", ["run", "clear", "stop"])
@pytest.mark.covers("imc.param.clear")
def test_what_ends_a_gear_that_waits_shows_in_its_flags_and_startsyn_does_not_stay(ended: str) -> None:
    card = owned(own.RUNS)
    arm(card)
    if ended == "stop":
        card.write("emstop", 0x10)
    else:
        write(card, **{ended: 0 if ended == "run" else FLAG})
    card.advance(2)
    assert flags(card) == set()
    write(card, startsyn=FLAG)
    assert flags(card) == set()


@shows("curpos enasyn engear gohome mcsgo startsyn")
@pytest.mark.covers("imc.IMC_GearInDist")
def test_startsyn_after_a_refused_gear_reads_0_and_moves_nothing() -> None:
    card = ready_card()
    master(card)
    write(card, run=0)
    arm(card)
    assert flags(card) == set()
    write(card, run=FLAG, mcstgvel=0)
    write(card, startsyn=FLAG)
    card.advance(60)
    assert (flags(card), card.read("curpos", SLAVE)) == (set(), 0)


@pytest.mark.covers("imc.concept.startsyn", "imc.IMC_GearInTime")
@shows("curpos enasyn engear gohome mcsgo startsyn synsrcvar")
def test_a_startsyn_from_before_a_gear_does_not_start_it() -> None:
    card = ready_card()
    master(card)
    write(card, synsrcvar=50)
    write(card, startsyn=FLAG)  # waits for enasyn
    assert flags(card) == {"startsyn"}
    arm(card)
    card.advance(60)
    assert (flags(card), card.read("curpos", SLAVE)) == (WAITING, 0)


@shows("enasyn engear gohome mcsgo startsyn")
def test_enasyn_taken_back_ends_the_wait() -> None:
    card = ready_card()
    arm(card)
    write(card, enasyn=0)
    assert flags(card) == set()


@shows("curvel error mcsaccel mcsdecel mcsgo mcsmaxvel mcstgpos mcstgvel stopfilt")
@pytest.mark.parametrize("register", ["mcsmaxvel", "mcsaccel", "mcsdecel"])
def test_a_move_without_speed_or_rate_is_a_bad_instruction_and_the_axis_brakes(register: str) -> None:
    card = owned(own.RUNS)
    deceleration = 0.5
    set_now(card, ("mcsdecel", deceleration, SLAVE))
    if register == "mcsdecel":
        set_now(card, ("stopfilt", 0, SLAVE))
    write(card, **{register: 0, "mcstgpos": 9000, "mcsgo": FLAG})
    assert (card.read("error", SLAVE), card.read("mcsgo", SLAVE)) == (0x1000, 0)
    speeds = trace(card, "curvel", 30, SLAVE)
    steps = [a - b for a, b in pairwise(speeds)]
    if register == "mcsdecel":
        assert set(speeds) == {6}  # not masked, so the jog goes on
    else:
        assert (max(steps), speeds[-1]) == (deceleration, 0)


@shows("mcsmaxvel mcsaccel mcsdecel error mcsgo stopfilt curvel")
@pytest.mark.parametrize("value", [0, -1.5])
@pytest.mark.parametrize("register", ["mcsmaxvel", "mcsaccel", "mcsdecel"])
def test_a_move_that_cannot_be_leaves_what_runs_alone_where_no_mask_stops_it(
    register: str, value: float
) -> None:
    card = owned(own.RUNS)
    set_now(card, ("stopfilt", 0, SLAVE))
    write(card, **{register: value, "mcstgpos": 9000, "mcsgo": FLAG})
    assert (card.read("error", SLAVE), card.read("mcsgo", SLAVE)) == (0x1000, 0)
    assert set(trace(card, "curvel", 20, SLAVE)) == {6}
