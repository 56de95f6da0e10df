"""Events: arithmetic of all commands, triggers, flags of the last unconditional event, limits of the space."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.controllers.imc import imclib
from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.imc.core._event_codes import EventCommand, EventType, constant_words
from polycnc.controllers.imc.core._events import scale
from polycnc.controllers.imc.core._instructions import Event, InstallEvents
from polycnc.controllers.imc.core._parameters import address
from support.imc_card import (
    FLAG,
    IFIFO,
    QFIFO,
    event,
    install,
    move_absolute,
    ready_card,
    send,
    set_now,
    shows,
)
from support.imc_network import opened
from support.often import share

A16, B16, R16 = (address(f"user16b{k}") for k in (1, 2, 0))
A32, B32, R32 = (address(f"user32b{k}") for k in (1, 2, 0))
A48, B48, R48 = (address(f"user48b{k}") for k in (1, 2, 0))


def _signed(value: int, bits: int) -> int:
    value &= (1 << bits) - 1
    return value - (1 << bits) if value >> (bits - 1) else value


def _flag(value: int) -> int:
    return -1 if value else 0


# By command: width of the first operand, of the second, of the result, and the result itself.
ARITHMETIC: dict[str, tuple[int, int, int, Callable[[int, int], int]]] = {
    "ADD32": (32, 32, 32, lambda a, b: a + b),
    "ADD48": (48, 48, 48, lambda a, b: a + b),
    "CMP32": (32, 32, 32, lambda a, b: a - b),
    "CMP48": (48, 48, 48, lambda a, b: a - b),
    "SCA32": (32, 48, 32, lambda a, b: a * b >> 32),
    "SCA48": (48, 48, 48, lambda a, b: a * b >> 32),
    "MUL32L": (32, 32, 32, lambda a, b: a * b),
    "MUL32A": (32, 32, 48, lambda a, b: a * b),
    "COP16": (16, 16, 16, lambda a, b: b),
    "COP32": (32, 32, 32, lambda a, b: b),
    "COP48": (48, 48, 48, lambda a, b: b),
    "SET16": (16, 16, 16, lambda a, b: b),
    "SET32": (32, 32, 32, lambda a, b: b),
    "SET48": (48, 48, 48, lambda a, b: b),
    "OR16": (16, 16, 16, lambda a, b: a | b),
    "OR16B": (16, 16, 16, lambda a, b: _flag(a | b)),
    "AND16": (16, 16, 16, lambda a, b: a & b),
    "AND16B": (16, 16, 16, lambda a, b: _flag(a & b)),
    "XOR16": (16, 16, 16, lambda a, b: a ^ b),
    "XOR16B": (16, 16, 16, lambda a, b: _flag(a ^ b)),
}
CELLS = {16: (A16, B16, R16), 32: (A32, B32, R32), 48: (A48, B48, R48)}
OPERANDS = [
    (0, 0),
    (1, -1),
    (5, 3),
    (-7, 12345),
    (1_000_000, 22_222),
    (2**31 - 1, 1),
    (-(2**31), -1),
    (2**47 - 1, 2**47 - 1),
    (-(2**47), 3 << 31),
    (0x7F0F, -0x00F1),
]


def _names() -> list[tuple[str, bool]]:
    names = []
    for command in EventCommand:
        name = command.name.removeprefix("CMD_")
        plain = name.replace("i", "")
        names.append((name, plain != name or plain.startswith("SET")))
    return names


def _result(card: Card, command: str, immediate: bool, a: int, b: int) -> tuple[int, int]:
    """Return what the card has stored for a command, and what it should have stored."""
    first, second, result, compute = ARITHMETIC[command.replace("i", "")]
    a, b = _signed(a, first), _signed(b, second)
    card.write_raw(CELLS[first][0], a, 0, first // 16)
    operands: dict[str, int] = {"first": CELLS[first][0], "target": CELLS[result][2]}
    if immediate:
        operands["constant"] = b
    else:
        where = CELLS[second][1]
        card.write_raw(where, b, 0, second // 16)
        operands["second"] = where
    card.write("events", 0)
    behind = operands["target"] + result // 16
    before = card.read_raw(behind, 0)
    install(card, event(command, "Allways", **operands))
    card.advance(1)
    assert card.read_raw(behind, 0) == before  # the result is as wide as it is
    return card.read_raw(CELLS[result][2], 0, result // 16), _signed(compute(a, b), result)


@pytest.mark.covers(*(f"imc.event.{command.name}" for command in EventCommand), "imc.enum.IMC_EVENT_CMD")
@pytest.mark.parametrize(("command", "immediate"), _names())
def test_every_command_computes_in_twos_complement(command: str, immediate: bool) -> None:
    card = ready_card(number_of_axes=1)
    for a, b in OPERANDS:
        stored, expected = _result(card, command, immediate, a, b)
        assert stored == expected, (a, b)


OF_AN_AXIS = {16: address("trackwin"), 32: address("breakp"), 48: address("gearratio")}


@pytest.mark.covers(*(f"imc.event.{command.name}" for command in EventCommand), "imc.struct.EventInfo")
@pytest.mark.covers("imc.struct.EventInfo.Src2.param", "imc.enum.IMC_EVENT_CMD", "imc.IMC_InstallEvent")
@pytest.mark.parametrize("by_library", [False, True])
def test_operands_and_result_are_those_of_their_axes(by_library: bool) -> None:
    card = ready_card(number_of_axes=4)
    handle = opened(card)
    for name, immediate in _names():
        first, second, result, compute = ARITHMETIC[name.replace("i", "")]
        values = {
            bits: [_signed(0x5A31_7E4F_6B2D * (3 + 2 * axis), bits) for axis in range(4)]
            for bits in OF_AN_AXIS
        }
        for bits, at in OF_AN_AXIS.items():
            for axis, value in enumerate(values[bits]):
                card.write_raw(at, value, axis, bits // 16)
        operands = {
            "first": OF_AN_AXIS[first],
            "first_axis": 2,
            "target": OF_AN_AXIS[result],
            "target_axis": 3,
        }
        if immediate:
            operands["constant"] = values[second][1]
        else:
            operands |= {"second": OF_AN_AXIS[second], "second_axis": 1}
        if by_library:
            second_operand = operands.get("constant", (OF_AN_AXIS[second], 1))
            command = EventCommand[f"CMD_{name}"]
            source, target = (OF_AN_AXIS[first], 2), (OF_AN_AXIS[result], 3)
            info = imclib.EventInfo.of(command, src1=source, src2=second_operand, dest=target)
            assert imclib.IMC_InstallEvent(handle, [info], 1, imclib.SEL_IFIFO) == imclib.IMC_OK
        else:
            install(card, event(name, "Allways", **operands))
        card.advance(1)
        values[result][3] = _signed(compute(values[first][2], values[second][1]), result)
        for bits, at in OF_AN_AXIS.items():
            assert [card.read_raw(at, axis, bits // 16) for axis in range(4)] == values[bits], name
        set_now(card, ("events", 0))
    imclib.detach()


@pytest.mark.covers(
    "imc.event.CMD_SCA32", "imc.event.CMD_SCA48", "imc.event.CMD_SCA32i", "imc.event.CMD_SCA48i"
)
@settings(deadline=None, max_examples=share(100))
@given(st.integers(-(2**47), 2**47 - 1), st.integers(-(2**47), 2**47 - 1))
def test_scaling_is_exact_and_rounds_down(value: int, factor: int) -> None:
    exact = value * factor >> 32
    if -(2**63) <= exact < 2**63:
        assert scale(value, factor) == exact


@pytest.mark.covers(
    "imc.event.CMD_MUL32iL",
    "imc.event.CMD_MUL32iA",
    "imc.event.CMD_SET48",
    "imc.event.CMD_SCA32i",
    "imc.struct.EventInfo.Src2.data32",
    "imc.struct.EventInfo.Src2.data48",
)
def test_numbers_of_the_manual() -> None:
    card = ready_card(number_of_axes=1)
    assert _result(card, "MUL32iL", True, 1_000_000, 22_222) == (747_163_520, 747_163_520)
    assert _result(card, "MUL32iA", True, 1_000_000, 22_222)[0] == 22_222_000_000
    assert _result(card, "SET48", True, 0, 12_345_678_000)[0] == 12_345_678_000
    assert _result(card, "SCA32i", True, 1_000_000, 65_536)[0] == 15
    assert [
        constant_words(EventCommand[f"CMD_{n}"]) for n in ("SCA32i", "SET48", "ADD32i", "OR16i", "COP16")
    ] == [
        3,
        3,
        2,
        1,
        0,
    ]


@pytest.mark.covers(
    "imc.event.CMD_ADD32", "imc.etype.IMC_Allways", "imc.struct.EventInfo.Src2.param", "imc.IMC_InstallEvent"
)
@shows("user32b0")
def test_positions_of_two_axes_are_added_every_cycle() -> None:
    card = ready_card()
    install(card, event("ADD32", first=225, first_axis=0, second=225, second_axis=1, target=R32))
    move_absolute(card, 100, 0)
    move_absolute(card, -30, 1)
    card.wait()
    card.advance(1)
    assert card.read("user32b0") == 70


CONDITIONS = {
    "Zero": lambda d: d == 0,
    "NotZero": lambda d: d != 0,
    "Great": lambda d: d > 0,
    "GreatEqu": lambda d: d >= 0,
    "Little": lambda d: d < 0,
}


@shows("user32b0 user32b1 user32b2")
@pytest.mark.covers(
    "imc.etype.IMC_Allways",
    *(f"imc.etype.IMC_{kind}_{name}" for kind in ("Edge", "IF") for name in CONDITIONS),
    "imc.concept.event_flags",
)
@pytest.mark.parametrize("name", CONDITIONS)
def test_levels_act_as_long_and_edges_when_their_condition_comes(name: str) -> None:
    card = ready_card(number_of_axes=1)
    install(
        card,
        event("CMP32i", first=A32, constant=10),
        event("ADD32i", f"Edge_{name}", first=R32, constant=1, target=R32),
        event("ADD32i", f"IF_{name}", first=B32, constant=1, target=B32),
    )
    edges = levels = 0
    before = None
    for value in (10, 10, 11, 12, 5, 5, 10, 9, 10, 11, 3, 11):
        set_now(card, ("user32b1", value))
        card.advance(1)
        holds = CONDITIONS[name](value - 10)
        levels += holds
        edges += holds and before is False
        before = holds
        assert (card.read("user32b0"), card.read("user32b2")) == (edges, levels)
    assert edges > 0


@shows("user32b1")
@pytest.mark.covers(
    "imc.etype.IMC_Edge_Carry",
    "imc.etype.IMC_Edge_NotCarry",
    "imc.etype.IMC_IF_Carry",
    "imc.etype.IMC_IF_NotCarry",
)
@pytest.mark.parametrize(
    ("command", "other", "carries"),
    [
        ("ADD32i", 1, {-1: True, 2**31 - 1: False, 0: False, -5: False}),
        ("CMP32i", 10, {9: True, 10: False, 11: False, -1: False}),
    ],
)
def test_carry_is_the_carry_of_a_sum_and_the_borrow_of_a_comparison(
    command: str, other: int, carries: dict[int, bool]
) -> None:
    card = ready_card(number_of_axes=1)
    kinds = ("IF_Carry", "IF_NotCarry", "Edge_Carry", "Edge_NotCarry")
    install(
        card,
        event(command, first=A32, constant=other),
        *(
            event("ADD32i", kind, first=at, constant=1, target=at)
            for kind, at in zip(kinds, (317, 321, 323, 325), strict=True)
        ),
    )
    counts = [0, 0, 0, 0]
    before = None
    for value in [*carries, *carries]:
        set_now(card, ("user32b1", value))
        card.advance(1)
        now = carries[value]
        counts[0] += now
        counts[1] += not now
        counts[2] += now and before is False
        counts[3] += not now and before is True
        before = now
        assert [card.read_raw(at, 0, 2) for at in (317, 321, 323, 325)] == counts


NAMES = ("Zero", "NotZero", "Great", "GreatEqu", "Little", "Carry", "NotCarry")
ALL_CONDITIONS = (*(f"IF_{name}" for name in NAMES), *(f"Edge_{name}" for name in NAMES))
# A command, two numbers, and which of the conditions hold for its result.
AT_THE_ENDS = (
    ("CMP32", 2**31 - 1, -1, "NotZero Great GreatEqu Carry"),
    ("CMP32", -(2**31), 3, "NotZero Little NotCarry"),
    ("CMP48", 2**47 - 1, -5, "NotZero Great GreatEqu Carry"),
    ("CMP48", 77, 77, "Zero GreatEqu NotCarry"),
    ("ADD32", -1, 0, "NotZero Little NotCarry"),
    ("ADD32", -3, 3, "Zero GreatEqu Carry"),
    ("ADD32", 2**31 - 1, 2**31 - 1, "NotZero Little NotCarry"),
    ("ADD48", -2, 1, "NotZero Little NotCarry"),
    ("ADD48", -2, 3, "NotZero Great GreatEqu Carry"),
    ("ADD48", 2**32, 2**33, "NotZero Great GreatEqu NotCarry"),
    ("CMP48", -(2**40), 2**33, "NotZero Little NotCarry"),
    ("CMP32", 70_000, 70_000 - 2**16, "NotZero Great GreatEqu NotCarry"),
)


@pytest.mark.covers(*(f"imc.etype.IMC_{name}" for name in ALL_CONDITIONS), "imc.enum.IMC_EventType")
@pytest.mark.covers(
    "imc.concept.event_flags", "imc.event.CMD_CMP32", "imc.event.CMD_CMP48", "imc.event.CMD_ADD32"
)
@pytest.mark.covers(
    "imc.event.CMD_CMP32i", "imc.event.CMD_CMP48i", "imc.event.CMD_ADD48", "imc.event.CMD_ADD32i"
)
def test_conditions_at_the_ends_of_the_numbers() -> None:
    for command, a, b, holds in AT_THE_ENDS:
        card = ready_card(number_of_axes=1)
        first, second, _ = CELLS[int(command[-2:])]
        words = int(command[-2:]) // 16
        sum_or_difference = (
            event(command, first=first, second=second)
            if a % 2
            else event(f"{command}i", first=first, constant=b)
        )
        tested = [sum_or_difference]
        for k, name in enumerate(ALL_CONDITIONS):
            add = event("ADD32i", name, first=R32, constant=1 << k, target=R32)
            tested.append(
                add
                if name.startswith("IF")
                else event("OR16i", name, first=R16, constant=1 << k - 7, target=R16)
            )
        card.write_raw(second, b if a % 2 else 0, 0, words)
        install(card, *tested)
        for _ in range(2):  # edges need a cycle in which the condition does not hold
            card.write_raw(first, b if holds.startswith("NotZero") else b + 9, 0, words)
            card.advance(1)
        for cell, width in ((R32, 2), (R16, 1)):
            card.write_raw(cell, 0, 0, width)
        card.write_raw(first, a, 0, words)
        card.advance(1)
        wanted = sum(1 << k for k, name in enumerate(NAMES) if name in holds.split())
        assert card.read_raw(R32, 0, 2) == wanted, (command, a, b)
        edges = card.read_raw(R16, 0)
        assert edges & ~wanted == 0
        if command.startswith("CMP"):  # two equal numbers before, or a greater first one
            held = "Zero GreatEqu NotCarry" if "NotZero" in holds else "NotZero Great GreatEqu NotCarry"
            assert edges == wanted & ~sum(1 << k for k, name in enumerate(NAMES) if name in held.split())


@shows("user32b0 user32b1")
@pytest.mark.covers("imc.concept.event_flags", "imc.etype.IMC_Allways", "imc.event.CMD_CMP32i")
def test_a_conditional_event_does_not_change_what_the_next_one_tests() -> None:
    card = ready_card(number_of_axes=1)
    install(
        card,
        event("CMP32i", first=A32, constant=10),
        event("CMP32i", "IF_Great", first=A32, constant=5000),  # less
        event("ADD32i", "IF_Great", first=B32, constant=-60000, target=B32),  # negative
        event("AND16i", "IF_Great", first=A16, constant=0, target=A16),  # 0
        event("ADD32i", "IF_Great", first=R32, constant=3, target=R32),
        event("ADD32i", "IF_Little", first=R32, constant=1000, target=R32),
        event("ADD32i", "IF_Carry", first=R32, constant=20000, target=R32),
    )
    set_now(card, ("user32b1", 700))
    card.advance(3)
    assert card.read("user32b0") == 9


@pytest.mark.covers(
    "imc.event.CMD_AND16i", "imc.event.CMD_OR16i", "imc.etype.IMC_Edge_Zero", "imc.etype.IMC_Edge_NotZero"
)
@shows("user16b0 user16b1")
@pytest.mark.covers("imc.concept.event_space")
def test_several_conditional_events_test_the_same_unconditional_one() -> None:
    card = ready_card(number_of_axes=1)
    install(
        card,
        event("AND16i", first=A16, constant=4),
        event("OR16i", "Edge_NotZero", first=560, constant=1, target=560),
        event("AND16i", "Edge_Zero", first=560, constant=-2, target=560),
        event("OR16i", "Edge_NotZero", first=R16, constant=8, target=R16),
    )
    for level, output in ((0, False), (4, True), (4, True), (0, False), (6, True)):
        set_now(card, ("user16b1", level))
        card.advance(1)
        assert card.output(1) is output
    assert card.read("user16b0") == 8


@pytest.mark.covers(
    "imc.etype.IMC_Edge_GreatEqu",
    "imc.etype.IMC_IF_GreatEqu",
    "imc.event.CMD_CMP32i",
    "imc.event.CMD_SET16",
    "imc.IMC_InstallEvent",
)
@shows("user16b0")
def test_an_event_sets_a_flag_once_when_a_position_is_reached_or_in_every_cycle() -> None:
    for kind, again in (("Edge_GreatEqu", 0), ("IF_GreatEqu", FLAG)):
        card = ready_card()
        install(
            card,
            event("CMP32i", first=225, constant=1000),
            event("SET16", kind, constant=-1, target=address("user16b0")),
        )
        move_absolute(card, 2000)
        card.advance(30)
        assert card.read("user16b0") == 0
        card.wait()
        assert card.read("user16b0") == FLAG
        set_now(card, ("user16b0", 0))
        card.advance(2)
        assert card.read("user16b0") == again


@pytest.mark.covers(
    "imc.event.CMD_SET32", "imc.event.CMD_SET16", "imc.etype.IMC_Edge_Great", "imc.IMC_InstallEvent"
)
@pytest.mark.covers(
    "imc.param.curpos", "imc.param.curvel", "imc.param.homepos", "imc.param.mcstgvel", "imc.param.sethome"
)
def test_an_event_stops_an_axis_and_sets_its_origin() -> None:
    card = ready_card()
    install(
        card,
        event("CMP32i", first=225, constant=500),
        event("SET32", "Edge_Great", constant=0, target=address("mcstgvel")),
        event("SET32", "Edge_Great", constant=0, target=address("homepos")),
        event("SET16", "Edge_Great", constant=-1, target=address("sethome")),
    )
    send(card, IFIFO, ("mcstgvel", 10))
    card.advance(100)
    assert (card.read("curvel"), card.read("homed")) == (0, FLAG)
    assert card.read("curpos") == 45  # 9 + 8 + ... + 1 from where the event made it 0
    assert card.kernel.servo.actual[0] > 500


@pytest.mark.covers("imc.IMC_InstallEvent")
@shows("user32b0")
@pytest.mark.covers(
    "imc.param.events", "imc.etype.IMC_Allways", "imc.event.CMD_ADD32i", "imc.concept.event_space"
)
def test_the_space_holds_128_events_and_0_removes_them() -> None:
    card = ready_card()
    one = event("ADD32i", first=R32, constant=1, target=R32)
    for _ in range(5):
        install(card, *[one] * 31, fifo=QFIFO)
        card.advance(1)
    assert (card.read("events"), card.room_for_events) == (128, 0)
    before = card.read("user32b0")
    card.advance(1)
    assert card.read("user32b0") == before + 128
    send(card, IFIFO, ("events", 5))  # only 0 does anything
    card.advance(1)
    assert card.read("events") == 128
    send(card, IFIFO, ("events", 0))
    card.advance(3)
    assert (card.read("events"), card.read("user32b0")) == (0, before + 256)


@pytest.mark.covers("imc.struct.EventInfo", "imc.IMC_InstallEvent")
@pytest.mark.covers("imc.param.events", "imc.param.ticks")
def test_a_destination_of_0_stores_nothing() -> None:
    card = ready_card()
    card.advance(1)
    before = card.state.memory.copy()
    install(card, event("ADD32i", first=A32, constant=77), event("SET48", constant=-1))
    card.advance(5)
    changed = {int(at) for row, at in zip(*(card.state.memory != before).nonzero(), strict=True)}
    assert changed == {address("events"), address("ticks")}


@pytest.mark.covers("imc.enum.IMC_EVENT_CMD", "imc.enum.IMC_EventType")
def test_commands_and_types_are_numbered_in_the_manuals_order() -> None:
    assert [command.value for command in EventCommand] == list(range(34))
    assert [kind.value for kind in EventType] == list(range(15))


@pytest.mark.covers("imc.param.events")
def test_an_event_on_an_axis_that_is_not_there_does_nothing() -> None:
    card = ready_card(number_of_axes=2)
    card.advance(1)
    before = card.state.memory.copy()
    bad = Event(EventCommand.CMD_ADD32i, EventType.IMC_Allways, 225, 7, constant=1, target=225, target_axis=9)
    assert card.push(IFIFO, InstallEvents((bad,)))
    card.advance(3)
    assert (card.state.memory[:2] == before[:2]).all()


@pytest.mark.parametrize(("command", "bits"), [("SCA32i", 32), ("SCA48i", 48)])
@pytest.mark.covers("imc.param.events", "imc.param.ticks")
def test_a_card_may_take_factors_with_16_fraction_bits(command: str, bits: int) -> None:
    for value, factor in ((1_000_003, 65_536), (-77_777, 163_841), (1_234_567, -98_305), (-3, 1)):
        for text, fraction in (("S16.32", 32), ("S16.16", 16)):
            card = ready_card(f'number_of_axes = 1\nscale_factor = "{text}"\n')
            assert _result(card, command, True, value, factor)[0] == value * factor >> fraction


@pytest.mark.covers(
    "imc.concept.event_flags",
    "imc.etype.IMC_IF_NotCarry",
    "imc.etype.IMC_IF_Zero",
    "imc.etype.IMC_IF_Carry",
    "imc.etype.IMC_IF_NotZero",
    "imc.etype.IMC_IF_Great",
)
def test_before_the_first_result_of_a_cycle_there_is_neither_a_value_nor_a_carry() -> None:
    card = ready_card()
    kinds = ("IF_Carry", "IF_NotCarry", "IF_Zero", "IF_NotZero", "IF_Great")
    install(
        card,
        *(
            event("SET16", kind, constant=31 + k, target=address(f"user16b{k}"))
            for k, kind in enumerate(kinds)
        ),
    )
    card.advance(2)
    assert [card.read(f"user16b{k}") for k in range(5)] == [0, 32, 33, 0, 0]
