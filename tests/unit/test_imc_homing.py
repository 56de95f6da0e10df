"""Search of the origin: the seven schemes in both directions and on both edges, where they end, giving up."""

from __future__ import annotations

from itertools import pairwise

import pytest

from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.imc.core._homing import home_sequence
from support.imc_card import FLAG, IFIFO, ready_card, send, set_now, shows

AXIS = """
[[axis]]
origin = [5000.0, 5600.0]
index = { first = 37.0, pitch = 1000.0 }
"""


def home(card: Card, *, negative: bool = False, rising: bool = True, go_to: bool = False, **how: int) -> None:
    """Start a search as the library does."""
    sequence = home_sequence(
        switch=how.get("switch", 1) != 0,
        index=how.get("index", 0) != 0,
        negative=negative,
        rising=rising,
        go_to=go_to,
        returns=how.get("returns", 0),
    )
    send(card, IFIFO, ("homeseq", sequence), ("gohome", FLAG))


def run_home(card: Card) -> list[float]:
    """Run until the search is over; return the machine positions passed."""
    card.advance(1)
    ways = []
    while card.read("gohome") != 0:
        assert card.clock.cycles < 30_000
        card.advance(1)
        ways.append(float(card.kernel.servo.actual[0]))
    return ways


def origin(card: Card) -> float:
    """Return the machine position of the axis' zero."""
    return float(card.kernel.servo.actual[0]) - card.read("curpos")


def turns(ways: list[float]) -> list[float]:
    """Return where the motion turned round."""
    found: list[float] = []
    for a, b, c in zip(ways, ways[1:], ways[2:], strict=False):
        if (b - a) * (c - b) < 0 or (b != a and b == c and (not found or found[-1] != b)):
            found.append(b)
    return found


@pytest.mark.covers("imc.IMC_HomeSwitch1")
@shows("curpos moving")
@pytest.mark.covers(
    "imc.concept.homing",
    "imc.param.gohome",
    "imc.param.homeseq",
    "imc.param.highvel",
    "imc.const.direction",
    "imc.const.RiseEdge",
)
@pytest.mark.parametrize(("start", "negative"), [(0, False), (9000, True)])
@pytest.mark.parametrize("rising", [True, False])
def test_one_pass_sets_the_origin_at_the_edge_while_moving(start: int, negative: bool, rising: bool) -> None:
    card = ready_card(AXIS)
    _place(card, start)
    home(card, negative=negative, rising=rising)
    ways = run_home(card)
    # the switch is on from 5000 to 5600: it rises where the axis enters it, and falls where it leaves it
    edge = {(False, True): 5000, (False, False): 5600, (True, True): 5600, (True, False): 5000}[
        negative, rising
    ]
    assert origin(card) == edge
    assert (card.read("homed"), card.read("moving")) == (FLAG, 0)
    beyond = card.read("curpos") * (-1 if negative else 1)
    assert 40 < beyond < 61  # the way to brake from 10 at 1, and what was left of the cycle of the edge
    assert max(abs(b - a) for a, b in pairwise(ways)) == 10


def _place(card: Card, position: int) -> None:
    send(card, IFIFO, ("mcstgpos", position), ("mcsgo", FLAG))
    card.wait()


@pytest.mark.covers("imc.IMC_HomeSwitch2", "imc.IMC_HomeSwitch3")
@shows("curpos")
@pytest.mark.covers("imc.concept.homing")
@pytest.mark.covers("imc.concept.same_edge", "imc.param.lowvel")
@pytest.mark.parametrize(
    ("start", "negative", "rising"), [(0, False, True), (9000, True, False), (0, False, False)]
)
@pytest.mark.parametrize("returns", [1, 2])
def test_passes_come_back_to_the_same_place(start: int, negative: bool, rising: bool, returns: int) -> None:
    card = ready_card(AXIS)
    _place(card, start)
    home(card, negative=negative, rising=rising, returns=returns)
    ways = run_home(card)
    edge = 5000 if (start, rising) in ((0, True), (9000, False)) else 5600
    assert origin(card) == edge
    forward = -1 if negative else 1
    assert len(turns(ways)) in (returns, returns + 1)  # and it stops in the end
    # after one return it passes the edge backwards, after two forwards; it ends beyond the edge that way
    assert card.read("curpos") * forward * (1 if returns == 2 else -1) >= 0
    assert abs(card.read("curpos")) <= 2
    late = [abs(b - a) for a, b in pairwise(ways)][-45:]
    assert max(late) <= 1


@pytest.mark.covers(
    "imc.IMC_HomeSwitchIndex1", "imc.IMC_HomeSwitchIndex2", "imc.IMC_HomeSwitchIndex3", "imc.concept.homing"
)
@pytest.mark.covers("imc.param.indexNum")
@pytest.mark.parametrize(
    ("returns", "number", "pulse"),
    [(0, 1, 5037), (0, 3, 7037), (1, 1, 4037), (1, 2, 3037), (2, 1, 5037), (2, 2, 6037)],
)
def test_index_pulses_count_from_the_edge(returns: int, number: int, pulse: int) -> None:
    card = ready_card(AXIS)
    set_now(card, ("indexNum", number))
    home(card, index=1, returns=returns)
    run_home(card)
    assert origin(card) == pulse


@pytest.mark.covers("imc.IMC_HomeSwitchIndex1", "imc.IMC_HomeSwitchIndex2", "imc.IMC_HomeSwitchIndex3")
@shows("highvel lowvel homeseq gohome")
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(
    ("returns", "first", "pulse"), [(0, 49.5, 59.5), (1, 50.5, 40.5), (1, 49.5, 49.5), (2, 49.5, 59.5)]
)
def test_a_pulse_just_before_the_edge_does_not_count(
    returns: int, first: float, pulse: float, way: int
) -> None:
    switch = sorted((50 * way, 90 * way))
    card = ready_card(f"[[axis]]\norigin = {switch}\nindex = {{ first = {first * way}, pitch = 10.0 }}\n")
    set_now(card, ("highvel", 4), ("lowvel", 2))
    home(card, index=1, returns=returns, negative=way < 0)
    run_home(card)
    assert origin(card) == pytest.approx(pulse * way, abs=1)


@pytest.mark.covers("imc.IMC_HomeIndex")
@pytest.mark.covers("imc.param.indexNum")
@pytest.mark.parametrize(
    ("negative", "number", "pulse"), [(False, 1, 37), (False, 4, 3037), (True, 2, -1963)]
)
def test_index_pulses_alone_count_from_the_start(negative: bool, number: int, pulse: int) -> None:
    card = ready_card(AXIS)
    set_now(card, ("indexNum", number))
    home(card, switch=0, index=1, negative=negative)
    run_home(card)
    assert origin(card) == pulse
    assert card.read("counter") == number


@pytest.mark.covers("imc.concept.homing")
@shows("curpos moving")
@pytest.mark.covers("imc.param.homepos")
@pytest.mark.covers("imc.const.stop")
@pytest.mark.parametrize("returns", [0, 1, 2])
@pytest.mark.covers("imc.param.mcsgo", "imc.param.poserr")
def test_it_can_go_to_a_place_in_the_end(returns: int) -> None:
    card = ready_card(AXIS)
    set_now(card, ("homestpos", -250), ("homepos", 100))
    home(card, returns=returns, go_to=True)
    run_home(card)
    assert card.read("curpos") == -250
    assert card.kernel.servo.actual[0] == 5000 - 100 - 250
    assert [card.read(name) for name in ("homed", "moving", "mcsgo", "poserr")] == [FLAG, 0, 0, 0]


@pytest.mark.covers("imc.const.stop", "imc.concept.homing")
@shows("curpos error")
@pytest.mark.covers("imc.param.lowvel", "imc.param.highvel")
@pytest.mark.parametrize("index", [0, 1])
@pytest.mark.parametrize("returns", [0, 1, 2])
@pytest.mark.parametrize("top", [0, 55])
@pytest.mark.covers("imc.param.mcsdecel", "imc.param.mcsmaxvel")
def test_the_closing_move_has_the_speed_of_the_last_stage_whatever_mcsmaxvel_is(
    returns: int, index: int, top: int
) -> None:
    card = ready_card(AXIS)
    set_now(card, ("homestpos", 4321), ("mcsmaxvel", top), ("highvel", 8), ("lowvel", 3), ("mcsdecel", 0.5))
    home(card, returns=returns, index=index, go_to=True)
    ways = run_home(card)
    speeds = [abs(b - a) for a, b in pairwise(ways)]
    assert [card.read(name) for name in ("curpos", "homed", "error")] == [4321, FLAG, 0]
    assert (max(speeds), max(speeds[-300:])) == (8, 8 if returns == 0 else 3)
    assert max(abs(b - a) for a, b in pairwise(speeds)) <= 2  # mcsaccel, in whole pulses: it never stops dead


@pytest.mark.covers("imc.IMC_HomeIndex", "imc.const.stop")
@shows("curpos")
@pytest.mark.covers("imc.param.highvel")
@pytest.mark.parametrize("top", [0, 55])
@pytest.mark.covers("imc.param.lowvel", "imc.param.mcsmaxvel")
def test_the_closing_move_after_index_pulses_alone_has_highvel(top: int) -> None:
    card = ready_card(AXIS)
    set_now(card, ("homestpos", 2222), ("mcsmaxvel", top), ("highvel", 7), ("lowvel", 3))
    home(card, switch=0, index=1, go_to=True)
    ways = run_home(card)
    assert (card.read("curpos"), max(abs(b - a) for a, b in pairwise(ways))) == (2222, 7)


@pytest.mark.covers("imc.IMC_HomeSwitch1", "imc.concept.homing")
def test_an_origin_switch_that_is_low_when_on_has_its_edges_the_other_way() -> None:
    card = ready_card(AXIS + 'low_when_on = ["origin"]\n')
    home(card, rising=True)
    run_home(card)
    assert origin(card) == 5600


@pytest.mark.covers("imc.IMC_HomeSwitch1")
@pytest.mark.covers("imc.param.homeseq", "imc.param.gohome")
def test_the_known_value_of_homeseq_searches_the_switch_in_positive_direction() -> None:
    card = ready_card(AXIS)
    send(card, IFIFO, ("homeseq", 0x14), ("gohome", FLAG))
    run_home(card)
    assert origin(card) == 5000


@shows("moving")
@pytest.mark.covers("imc.param.gohome")
def test_a_search_can_be_given_up() -> None:
    card = ready_card(AXIS)
    home(card)
    card.advance(100)
    send(card, IFIFO, ("gohome", 0))
    card.wait()
    assert (card.read("homed"), card.read("moving")) == (0, 0)
    card.advance(500)
    assert 900 < card.read("curpos") < 1100


@shows("moving")
@pytest.mark.covers("imc.param.aioctr", "imc.param.error", "imc.param.gohome")
def test_a_search_that_runs_into_a_limit_ends_without_an_origin() -> None:
    card = ready_card("[[axis]]\norigin = [5000.0, 5600.0]\nlimit_negative = -300.0\n")
    set_now(card, ("aioctr", 0x000F))
    home(card, negative=True)
    run_home(card)
    card.wait()
    assert [card.read(name) for name in ("homed", "gohome", "error", "moving")] == [0, 0, 2, 0]
    assert -360 <= card.read("curpos") < -300


@pytest.mark.covers("imc.param.highvel")
def test_a_switch_that_is_passed_within_a_cycle_is_found() -> None:
    card = ready_card("[[axis]]\norigin = [5001.0, 5004.0]\n")
    set_now(card, ("highvel", 50))
    home(card)
    run_home(card)
    assert origin(card) == 5001


@shows("curpos")
@pytest.mark.covers("imc.param.poserr")
def test_with_a_lagging_drive_the_origin_is_where_the_encoder_was_at_the_edge() -> None:
    card = ready_card("[[axis]]\norigin = [5000.0, 5600.0]\nlag_s = 0.005\ngain = 30.0\n")
    home(card, go_to=True)
    run_home(card)
    card.advance(2000)
    assert card.read("curpos") == 0
    assert card.kernel.servo.actual[0] == pytest.approx(5000, abs=1)
    assert abs(card.read("poserr")) <= 1


@shows("curpos run")
@pytest.mark.parametrize("lacking", [("run", 0), ("highvel", 0)])
@pytest.mark.covers("imc.param.gohome", "imc.param.highvel")
def test_a_search_that_cannot_begin_takes_its_flag_back(lacking: tuple[str, float]) -> None:
    card = ready_card(AXIS)
    set_now(card, ("highvel", 7), lacking)
    home(card)
    card.advance(1)
    assert (card.read("gohome"), card.read("curpos"), card.read("homed")) == (0, 0, 0)
    card.advance(40)
    assert (card.read("gohome"), card.read("curpos")) == (0, 0)


@shows("gohome")
@pytest.mark.covers("imc.param.highvel")
def test_any_value_but_0_starts_a_search_and_shows_as_a_flag() -> None:
    card = ready_card(AXIS)
    set_now(card, ("highvel", 7))
    home(card)
    send(card, IFIFO, ("gohome", 5))
    card.advance(2)
    assert card.read("gohome") == FLAG
    assert card.read("curvel") > 0


@pytest.mark.covers("imc.param.encpfactor", "imc.param.homepos")
@pytest.mark.covers("imc.param.encp")
def test_the_origin_that_is_passed_counts_in_the_scale_of_the_encoder() -> None:
    card = ready_card(AXIS + "counts_per_pulse = 4.0\n")
    set_now(card, ("encpfactor", 0.375), ("homepos", 230))
    home(card)
    run_home(card)
    beyond = float(card.kernel.servo.actual[0]) - 5000
    assert beyond > 40
    assert card.read("encp") == pytest.approx(230 + 1.5 * beyond, abs=1.5)
