"""The card's parameter memory: widths, words, scopes, read-only words, what shared words do."""

from __future__ import annotations

import csv
import re

import pytest

from polycnc import conformance
from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.imc.card._config import CardConfig, parse_card
from polycnc.controllers.imc.core._instructions import ChangeBits, Write, WriteMany
from polycnc.controllers.imc.core._parameters import (
    PARAMETERS,
    Parameter,
    address,
    is_listed,
    is_read_only,
    parameter,
)
from polycnc.errors import ConfigurationError, UsageError
from support.imc_card import FLAG, IFIFO, ready_card, send, set_now, setting, shows

# What belongs to the card and not to an axis: contour, cells, waits, events, stops, queues, inputs, outputs, versions.
CARD_ADDRESSES = {
    *range(256, 352), *range(479, 482), 489, *range(500, 504), 509, 511, 513, 519, 521, 549, 560, 561, 568, 624, 625,
    628, 634, 635, 704,
}  # fmt: skip
_BITS = {"S16": 16, "U16": 16, "F16": 16, "R16": 16, "S32": 32, "U32": 32, "S16.16": 32, "U16.16": 32}
_BITS |= {"S16.32": 48, "U16.32": 48}


def _rows() -> list[dict[str, str]]:
    path = conformance.data_folder() / "imc.tsv"
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))


def _printed() -> list[tuple[str, str, int, int]]:
    """Return row, name, address and bits of each parameter whose address the manual prints."""
    printed = []
    for row in _rows():
        found = re.search(r"(\d+) //(\S+)", row["signature"])
        if row["id"].startswith("imc.param.") and found:
            bits = _BITS.get(found[2], int(found[2]) if found[2].isdigit() else 0)
            printed.append((row["id"], row["name"].split()[0], int(found[1]), bits))
    return printed


@pytest.mark.parametrize(
    ("name", "at", "bits"),
    [pytest.param(*each, marks=pytest.mark.covers(row), id=str(each[0])) for row, *each in _printed()],
)
def test_a_parameter_of_the_manual_is_at_its_address_with_its_width(name: str, at: int, bits: int) -> None:
    each = PARAMETERS[name]
    assert (each.address, each.words * 16) == (at, bits)


def test_every_parameter_of_the_manual_has_an_address() -> None:
    assert len(_printed()) == 162


@pytest.mark.covers("imc.concept.word_memory")
def test_a_write_touches_only_the_words_it_is_wide() -> None:
    card = ready_card()
    card.push(IFIFO, Write(12, 0x0001_0002, 0, 2))
    card.advance(1)
    assert card.read_words(12, 0, 2) == (2, 1)
    card.push(IFIFO, Write(12, 5))
    card.advance(1)
    assert card.read_raw(12, 0, 2) == 0x0001_0005
    card.push(IFIFO, Write(12, 100, 0, 2))
    card.advance(1)
    assert card.read_words(12, 0, 2) == (0x64, 0)


@pytest.mark.covers("imc.concept.word_memory", "imc.IMC_SetParam32")
@shows("curpos")
@pytest.mark.covers("imc.param.homepos")
def test_a_write_that_is_too_wide_also_writes_the_neighbour() -> None:
    card = ready_card()
    card.write_raw(address("homepos"), 77, 0, 2)
    card.push(IFIFO, Write(address("gohome"), -1, 0, 2))
    card.advance(1)
    assert card.read("homed") == FLAG  # sethome, the next word, has been carried out
    assert card.read("curpos") == 77


@pytest.mark.covers("imc.concept.word_memory", "imc.IMC_GetParam32")
def test_a_read_that_is_too_wide_shows_the_neighbour() -> None:
    card = Card()
    card.state.memory[0, 152] = -1
    assert card.read_raw(152, 0, 2) == 0x0000FFFF
    card.state.memory[0, 152], card.state.memory[0, 153] = 0, -1
    assert card.read_raw(152, 0, 2) == -65536


@shows("gearratio mcstgpos stopfilt ticks user16b0")
@pytest.mark.covers(
    *(f"imc.type.{kind}" for kind in ("S32", "U32", "S16", "U16", "F16", "R16", "S16.32", "S16.16", "U16.16"))
)
@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("mcstgpos", -2147483648, 2147483647),
        ("ticks", 0, 4294967295),
        ("user16b0", -32768, 32767),
        ("timer", 0, 65535),
        ("mcstrack", -1, 0),
        ("stopfilt", -32768, 32767),
        ("gearratio", -32768.0, 32767.999999999767),
        ("gearoutvel", -32768.0, 32767.999984741211),
        ("encsfactor", 0.0, 65535.999984741211),
    ],
)
@pytest.mark.covers("imc.param.encsfactor", "imc.param.gearoutvel", "imc.param.mcstrack", "imc.param.timer")
def test_a_type_has_its_width_and_range(name: str, low: float, high: float) -> None:
    card = Card()
    each = parameter(name)
    assert each.words * 16 == _BITS[each.type.replace("S48", "S16.32")]
    for value in (low, high, 0):
        card.write(name, value)
        assert card.read(name) == pytest.approx(value, abs=1e-12)
    if each.type[0] in "SU":  # in a card file, and for other programs, too
        assert [each.least, each.most] == pytest.approx([low, high], abs=1e-12)
        values, step = f"parameters = {{ {name} = %r }}\n", 1 if each.fraction_bits == 0 else 1.0
        text = values if each.scope == "G" else "[[axis]]\n" + values
        assert parse_card(text % low)
        assert parse_card(text % high)
        for beyond in (high + step, *([low - step] if low < 0 else [])):
            with pytest.raises(ConfigurationError, match="does not fit"):
                parse_card(text % beyond)
    raw = 1 << (16 * each.words)
    assert each.to_raw(high) == raw // (2 if low < 0 else 1) - 1 or each.type in ("F16", "R16")


@shows("gearoutvel gearratio")
@pytest.mark.covers("imc.type.S16.32", "imc.type.S16.16")
def test_ratios_have_exact_words() -> None:
    card = Card()
    # rounded to the nearest: 2/3 is AAAA AAAA.AAA...
    thirds = ((2 / 3, (0xAAAB, 0xAAAA, 0)), (-2 / 3, (0x5555, 0x5555, 0xFFFF)))
    for ratio, words in ((0.5, (0, 0x8000, 0)), (-1.5, (0, 0x8000, 0xFFFE)), *thirds):
        card.write("gearratio", ratio)
        assert card.read_words(175, 0, 3) == words
    card.write("gearratio", 32767.999999999767)
    assert card.read_raw(175, 0, 3) == 0x7FFF_FFFF_FFFF
    card.write("gearoutvel", -2 / 3)
    assert card.read_words(address("gearoutvel"), 0, 2) == (0x5555, 0xFFFF)
    card.write("gearoutvel", 100)
    assert card.read_raw(address("gearoutvel"), 0, 2) == 100 * 65536


@shows("homepos")
@pytest.mark.covers(*(row for row, _, at, _ in _printed() if at in CARD_ADDRESSES))
def test_words_of_the_card_are_the_same_for_every_axis() -> None:
    card = Card()
    cells = [
        each
        for each in PARAMETERS.values()
        if re.fullmatch(r"user\d+b\d|group.+|out[12]|gio|giod|event(id|base)", each.name)
    ]
    assert len(cells) > 40
    for k, each in enumerate(cells, 1):
        card.write_raw(each.address, 300 * k + 7, k % 4, each.words)
    for k, each in enumerate(cells, 1):
        assert {card.read_raw(each.address, axis, each.words) for axis in range(4)} == {300 * k + 7}, (
            each.name
        )
    for _, name, *_ in _printed():
        assert (PARAMETERS[name].scope == "G") == (PARAMETERS[name].address in CARD_ADDRESSES), name
    card.write_raw(address("homepos"), 9, 1, 2)
    assert [card.read("homepos", i) for i in range(4)] == [0, 9, 0, 0]


@pytest.mark.covers("imc.param.fwversion", "imc.param.naxis")
def test_read_only_words_refuse_to_be_written() -> None:
    card = ready_card(number_of_axes=3)
    for name in ("naxis", "curpos", "moving", "fwversion", "gin1"):
        assert is_read_only(address(name))
        before = card.read(name)
        send(card, IFIFO, (name, 1234))
        card.advance(1)
        assert card.read(name) == before
    assert card.read("naxis") == 3


@shows("profiling")
def test_a_write_past_a_read_only_word_leaves_that_word_alone() -> None:
    card = ready_card()
    card.push(IFIFO, Write(address("cirswap"), 0x7FFF_0003, 0, 2))
    card.advance(1)
    assert (card.read("cirswap"), card.read("profiling")) == (3, 0)


@pytest.mark.covers("imc.IMC_SetParamBit", "imc.IMC_TurnParamBit", "imc.IMC_ORXORParam")
@shows("user16b0")
@pytest.mark.parametrize(
    ("old", "ors", "xors", "new"),
    [(0x00F0, 0x000F, 0x00F0, 0x000F), (0b110, 0b10, 0b10, 0b100), (0, 1 << 15, 0, 0x8000), (5, 0, 1, 4)],
)
@pytest.mark.covers("imc.concept.atomic_rmw")
def test_bits_are_set_cleared_and_turned_when_the_instruction_leaves_the_queue(
    old: int, ors: int, xors: int, new: int
) -> None:
    card = ready_card()
    card.push(IFIFO, ChangeBits(address("user16b0"), ors, xors))
    card.write("user16b0", old if old < 0x8000 else old - 0x10000)  # after sending, before it is carried out
    card.advance(1)
    assert card.read_words(address("user16b0"), 0, 1) == (new,)


@pytest.mark.covers("imc.IMC_SetMulParam")
@shows("mcsdist mcsgo")
def test_several_writes_of_one_instruction_act_in_the_same_cycle() -> None:
    card = ready_card()
    writes = tuple(
        Write(at, value, axis, words)
        for axis in (0, 1, 2)
        for at, value, words in ((address("mcsdist"), 1000, 2), (address("mcsgo"), -1, 1))
    )
    card.push(IFIFO, WriteMany(writes))
    card.advance(1)
    assert len({card.read("mcsvel", i) for i in (0, 1, 2)}) == 1
    assert card.read("mcsvel") > 0


@shows("clear emstop error events hpause ticks user16b0")
@pytest.mark.covers("imc.param.breakp")
def test_clear_of_one_axis_clears_what_the_card_counts() -> None:
    card = ready_card()
    set_now(card, ("emstop", 2), ("hpause", FLAG), ("breakp", -5))
    card.advance(5)
    assert card.read("ticks") == 5
    send(card, IFIFO, ("clear", FLAG, 1), ("user16b0", 7))
    card.advance(1)
    shown = [card.read(name) for name in ("emstop", "hpause", "events", "ticks")]
    assert shown == [0, 0, 0, 0]
    assert card.read("error", 1) == 0
    assert card.read("error", 0) == 2  # what it had been given stays
    assert card.read("user16b0") == 0  # the queue goes on with the next cycle
    card.advance(1)
    assert card.read("user16b0") == 7


@pytest.mark.covers("imc.param.hpause")
def test_a_wide_write_to_hpause_writes_the_low_word_of_ticks() -> None:
    card = ready_card()
    card.advance(70_000)
    assert card.read("ticks") == 70_000
    card.push(IFIFO, Write(address("hpause"), 0, 0, 2))
    card.advance(1)
    assert card.read("ticks") == 65536 + 1


def test_an_unknown_place_is_refused_and_nothing_is_written() -> None:
    card = Card()
    before = card.state.memory.copy()
    for at, axis in ((-1, 0), (1024, 0), (4, 4), (4, -1)):
        with pytest.raises(UsageError):
            card.write_raw(at, 1, axis)
        with pytest.raises(UsageError):
            card.read_words(at, axis, 1)
    assert (card.state.memory == before).all()
    assert not is_listed(9)
    with pytest.raises(UsageError, match="no parameter 'curposs'"):
        card.read("curposs")


@pytest.mark.covers("imc.param.naxis")
@pytest.mark.covers("imc.param.groupsmooth")
def test_a_card_file_gives_axes_queues_and_power_on_values() -> None:
    card = Card(
        parse_card(
            """
            delay_unit = "ms"
            parameters = { groupsmooth = 20 }
            [depths]
            qfifo = 128
            [[axis]]
            parameters = { mcsmaxvel = 12.5 }
            [[axis]]
            """
        )
    )
    assert (card.axes, card.read("naxis"), card.read("groupsmooth")) == (2, 2, 20)
    assert (card.read("mcsmaxvel", 0), card.read("mcsmaxvel", 1)) == (12.5, 0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("number_of_axis = 4", "number_of_axis"),
        ('password = "abc"', "cannot be a password"),
        ("[[axis]]\norigin = [5.0, 1.0]", "stretch is empty"),
        ("[[axis]]\nparameters = { mcsmaxvels = 1 }", "no parameter 'mcsmaxvels'"),
        ("[[axis]]\nparameters = { mcsmaxvel = 40000 }", "does not fit"),
        ("[[axis]]\nlimit_negative = 5.0\nlimit_positive = 1.0", "overlap"),
        ("number_of_axes = 1\n[[axis]]\n[[axis]]", "2 axes"),
    ],
)
@pytest.mark.covers(
    "imc.param.mcsmaxvel",
)
def test_a_wrong_card_file_says_where(text: str, message: str) -> None:
    with pytest.raises(ConfigurationError, match=message) as caught:
        parse_card(text)
    assert caught.value.position is not None


def test_defaults_make_a_card_of_four_idle_axes() -> None:
    card = Card(CardConfig())
    card.advance(10)
    assert card.axes == 4
    assert [card.read("moving", i) for i in range(4)] == [0] * 4
    assert card.time_s == pytest.approx(0.01)


@pytest.mark.covers(
    *(f"imc.param.user16b{k}" for k in range(10)),
    *(f"imc.param.user32b{k}" for k in range(10)),
    *(f"imc.param.user48b{k}" for k in range(5)),
)
@pytest.mark.parametrize(("width", "count"), [(16, 10), (32, 10), (48, 5)])
def test_each_free_cell_keeps_what_is_written_and_no_other_changes(width: int, count: int) -> None:
    card = ready_card()
    for k in range(count):
        value = -(1 << (width - 1)) + k
        card.push(IFIFO, setting(f"user{width}b{k}", value))
    card.advance(1)
    for k in range(count):
        assert card.read(f"user{width}b{k}") == -(1 << (width - 1)) + k
    others = [w for w in (16, 32, 48) if w != width]
    assert all(card.read(f"user{w}b{k}") == 0 for w in others for k in range(5))


@pytest.mark.covers(
    "imc.param.encsctr",
    "imc.param.aiod",
    "imc.param.stepmod",
    "imc.param.dirtime",
    "imc.param.steptime",
    "imc.param.fixvel",
)
@pytest.mark.parametrize("name", ["encsctr", "aiod", "stepmod", "dirtime", "steptime", "fixvel"])
def test_settings_of_an_axis_that_the_simulation_does_not_use_are_kept_for_each_axis(name: str) -> None:
    card = ready_card()
    for i in range(4):
        send(card, IFIFO, (name, 1.375 * i - 2.5 if name == "fixvel" else 100 + i, i))
    card.advance(1)
    assert [card.read(name, i) for i in range(4)] == [
        1.375 * i - 2.5 if name == "fixvel" else 100 + i for i in range(4)
    ]
    assert card.read("moving") == 0


@pytest.mark.covers(
    "imc.param.waitfilt",
    "imc.param.waitequ",
    "imc.param.eventid",
    "imc.param.eventbase",
    "imc.param.out1",
    "imc.param.out2",
)
@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("waitfilt", 479),
        ("waitequ", 480),
        ("giod", 561),
        ("eventid", 549),
        ("eventbase", 568),
        ("out1", 624),
        ("out2", 625),
    ],
)
def test_settings_of_the_card_without_a_known_meaning_are_kept_at_their_address(
    name: str, printed: int
) -> None:
    card = ready_card()
    send(card, IFIFO, (name, 3, 2))
    card.advance(1)
    assert [card.read_raw(printed, i) for i in range(4)] == [3] * 4
    card.write_raw(printed, -7)
    assert card.read_raw(printed, 1) == -7
    assert int(card.read(name)) & 0xFFFF == 0xFFF9


@pytest.mark.covers(
    "imc.param.clkdiv", "imc.param.fwversion", "imc.param.sysclk", "imc.param.naxis", "imc.param.hwversion"
)
def test_what_the_card_is_can_be_read_and_not_written() -> None:
    card = Card(parse_card("number_of_axes = 6\nfwversion = 512\nhwversion = 7\n"))
    names = ("naxis", "fwversion", "hwversion", "sysclk", "clkdiv")
    shown = [card.read(name) for name in names]
    assert shown[:3] == [6, 512, 7]
    assert shown[3] > 0
    assert shown[4] > 0
    send(card, IFIFO, *((name, 1) for name in names))
    card.advance(1)
    assert [card.read(name) for name in names] == shown
    assert shown[3:] == [100_000_000, 1]
    high = Card(parse_card("number_of_axes = 32\nfwversion = 65021\nhwversion = 43690\n"))
    assert [high.read(name) for name in names[:3]] == [32, 65021, 43690]


@pytest.mark.covers("imc.type.U16.32")
def test_48_bits_without_a_sign_reach_to_65536() -> None:
    unsigned = Parameter("any", 0, "U16.32", "A", "rw", "")
    assert (unsigned.words, unsigned.fraction_bits, unsigned.is_signed) == (3, 32, False)
    assert unsigned.to_raw(65536 - 2**-32) == 2**48 - 1
    assert unsigned.from_raw(2**48 - 1) == 65536 - 2**-32
    assert (unsigned.least, unsigned.most) == (0, 65536 - 2**-32)
