"""The queues: one instruction a cycle or all at once, waits, counts, clearing, what is refused."""

from __future__ import annotations

import pytest

from polycnc.controllers.imc.card._card import Fifo
from polycnc.controllers.imc.core._event_codes import EventCommand, EventType
from polycnc.controllers.imc.core._instructions import (
    ChangeBits,
    Event,
    InstallEvents,
    Points,
    Segment,
    WaitParam,
    WaitTime,
    Write,
    WriteMany,
)
from polycnc.controllers.imc.core._parameters import address
from polycnc.errors import UsageError
from support.imc_card import (
    FLAG,
    IFIFO,
    PFIFO1,
    PFIFO2,
    QFIFO,
    enable_path,
    line,
    move_absolute,
    ready_card,
    send,
    set_now,
    setting,
    shows,
    wait_for,
)

CELLS = ("user16b0", "user16b1", "user16b2")


def _cells(card) -> list[float]:  # type: ignore[no-untyped-def]
    return [card.read(name) for name in CELLS]


@pytest.mark.covers("imc.fifo.SEL_QFIFO")
@pytest.mark.covers("imc.concept.qfifo", "imc.concept.control_cycle")
def test_qfifo_carries_out_one_instruction_a_cycle() -> None:
    card = ready_card()
    send(card, QFIFO, *((name, 1) for name in CELLS))
    assert _cells(card) == [0, 0, 0]
    for done in ([1, 0, 0], [1, 1, 0], [1, 1, 1]):
        card.advance(1)
        assert _cells(card) == done


@pytest.mark.covers("imc.fifo.SEL_IFIFO", "imc.concept.control_cycle")
@pytest.mark.covers("imc.concept.ififo")
def test_ififo_carries_out_all_it_holds_in_the_next_cycle() -> None:
    card = ready_card()
    send(card, IFIFO, *((name, 1) for name in CELLS))
    card.advance(1)
    assert _cells(card) == [1, 1, 1]


@pytest.mark.covers("imc.concept.fifo_independence")
def test_a_wait_for_ever_in_one_queue_leaves_the_others_alone() -> None:
    card = ready_card()
    card.push(QFIFO, WaitTime(0))
    send(card, QFIFO, ("user16b0", 1))
    send(card, IFIFO, ("user16b1", 1))
    card.advance(5000)
    assert _cells(card) == [0, 1, 0]
    card.clear_fifo(QFIFO)
    send(card, QFIFO, ("user16b2", 1))
    card.advance(1)
    assert _cells(card) == [0, 1, 1]


@pytest.mark.covers("imc.IMC_WaitTime")
@shows("user16b0")
@pytest.mark.parametrize("release", ["qwaittime", "clrqfifo", "clearimc"])
@pytest.mark.covers("imc.param.clrqfifo")
def test_a_wait_is_released_by_its_time_register_or_by_clearing(release: str) -> None:
    card = ready_card()
    card.push(QFIFO, WaitTime(-1))
    send(card, QFIFO, ("user16b0", 1))
    card.advance(100)
    send(card, IFIFO, (release, 0 if release == "qwaittime" else FLAG))
    card.advance(2)
    assert _cells(card)[0] == (1 if release == "qwaittime" else 0)
    assert card.waiting_words(QFIFO) == 0


@pytest.mark.covers("imc.fifo.SEL_QFIFO", "imc.fifo.SEL_PFIFO1", "imc.fifo.SEL_PFIFO2")
@pytest.mark.covers("imc.IMC_ClearFIFO", "imc.IMC_WaitTime")
@pytest.mark.parametrize(
    ("queue", "shown"), [(QFIFO, "qwaittime"), (PFIFO1, "pwaittime1"), (PFIFO2, "pwaittime2")]
)
def test_a_queue_that_is_emptied_waits_no_longer(queue: Fifo, shown: str) -> None:
    card = ready_card()
    enable_path(card)
    enable_path(card, space=2)
    card.push(queue, WaitTime(50))
    card.advance(20)
    assert card.read(shown) == 50 - 19
    card.clear_fifo(queue)
    card.advance(1)
    assert card.read(shown) == 0


@pytest.mark.covers("imc.fifo.SEL_QFIFO", "imc.fifo.SEL_PFIFO1", "imc.fifo.SEL_PFIFO2")
@pytest.mark.covers("imc.IMC_WaitTime", "imc.concept.qfifo", "imc.concept.pfifo1", "imc.concept.pfifo2")
@shows("user16b0")
@pytest.mark.parametrize("queue", [QFIFO, PFIFO1, PFIFO2])
def test_a_wait_of_time_lasts_its_milliseconds(queue: Fifo) -> None:
    card = ready_card()
    enable_path(card)
    enable_path(card, space=2)
    card.push(queue, WaitTime(50))
    send(card, queue, ("user16b0", 1))
    card.advance(50)
    assert _cells(card)[0] == 0
    card.advance(1)
    assert _cells(card)[0] == 1


@pytest.mark.covers("imc.IMC_WaitParam")
@shows("error user16b0")
def test_a_wait_that_is_never_met_goes_on_after_its_time() -> None:
    card = ready_card()
    wait_for(card, QFIFO, "user16b1", 5, timeout=50)
    send(card, QFIFO, ("user16b0", 1))
    card.advance(30)
    assert card.read("qwaittime") == 50 - 29
    card.advance(20)
    assert _cells(card)[0] == 0
    card.advance(1)
    assert (_cells(card)[0], card.read("error"), card.read("qwaittime")) == (1, 0, 0)


@pytest.mark.covers("imc.IMC_WaitParamMask")
@shows("user16b0 user16b1")
@pytest.mark.parametrize(
    ("mask", "data", "met"), [(0x00FF, 0x0034, True), (0x00FF, 0x1234, False), (0xFFFF, 0x1234, True)]
)
@pytest.mark.covers("imc.IMC_WaitParam")
def test_a_masked_wait_compares_with_data_as_given(mask: int, data: int, met: bool) -> None:
    card = ready_card()
    set_now(card, ("user16b1", 0x1234))
    card.push(QFIFO, WaitParam(address("user16b1"), data, 0, 0, mask))
    send(card, QFIFO, ("user16b0", 1))
    card.advance(100)
    assert _cells(card)[0] == int(met)


@pytest.mark.covers("imc.IMC_WaitParam", "imc.concept.qfifo", "imc.concept.pfifo1")
@shows("curpos user16b0")
def test_a_wait_for_the_end_of_a_move_behind_that_move_is_not_met_too_early() -> None:
    for queue in (QFIFO, PFIFO1):
        card = ready_card()
        enable_path(card)
        move_absolute(card, 1000, 1, queue)
        wait_for(card, queue, "moving", 0, 1)
        send(card, queue, ("user16b0", 1))
        card.advance(40)
        assert _cells(card)[0] == 0
        card.advance(40)
        assert (_cells(card)[0], card.read("curpos", 1)) == (1, 1000)


@pytest.mark.covers("imc.fifo.SEL_PFIFO1", "imc.fifo.SEL_PFIFO2")
@shows("user16b0")
@pytest.mark.covers("imc.concept.pfifo1", "imc.concept.pfifo2", "imc.param.pfifoenable")
@pytest.mark.parametrize(("space", "on"), [(1, FLAG), (2, FLAG), (1, 1), (2, 0x4000)])
def test_a_path_queue_is_off_until_it_is_enabled(space: int, on: int) -> None:
    card = ready_card()
    queue = PFIFO1 + space - 1
    send(card, queue, ("user16b0", 1))
    card.advance(10)
    assert (_cells(card)[0], card.waiting_words(queue)) == (0, 3)
    for k in range(1, 4):
        send(card, queue, (f"user16b{k}", 5 * k))
    send(card, IFIFO, (f"startpath{3 - space}", FLAG))  # the other space is another queue
    card.advance(3)
    assert (_cells(card)[0], card.waiting_words(queue)) == (0, 12)
    send(card, IFIFO, (f"startpath{3 - space}", 0), (f"startpath{space}", on))
    card.advance(1)  # and carries out in a cycle whatever does not take time
    assert (_cells(card)[:3], card.waiting_words(queue)) == ([1, 5, 10], 0)


@pytest.mark.covers(
    "imc.fifo.SEL_IFIFO",
    "imc.fifo.SEL_QFIFO",
    "imc.fifo.SEL_PFIFO1",
    "imc.fifo.SEL_PFIFO2",
    "imc.fifo.SEL_CFIFO",
    "imc.enum.FIFO_SEL",
)
@pytest.mark.covers("imc.status.IMC_FIFO_FULL", "imc.concept.ififo", "imc.concept.qfifo")
@shows("user16b0 user16b1")
def test_a_full_queue_takes_nothing_and_drains_with_time() -> None:
    depths = {"ififo": 64, "qfifo": 70, "pfifo1": 78, "pfifo2": 87, "cfifo": 99}
    card = ready_card("[depths]\n" + "".join(f"{name} = {depth}\n" for name, depth in depths.items()))
    for queue, depth in zip((IFIFO, QFIFO, PFIFO1, PFIFO2), depths.values(), strict=False):
        assert card.config.depths.of(queue) == depth
        taken = 0
        while card.push(queue, setting("user16b0", 100 * queue + taken)):
            taken += 1
        assert (taken, card.waiting_words(queue)) == (depth // 3, depth // 3 * 3)
    assert card.push_points(range(99))
    assert not card.push_points([1])
    assert card.config.depths.of(Fifo.SEL_CFIFO) == card.waiting_words(Fifo.SEL_CFIFO) == 99
    card.advance(1)
    assert [card.waiting_words(queue) for queue in Fifo] == [0, 66, 78, 87, 99]
    for queue in (IFIFO, QFIFO):
        assert card.push(queue, setting(f"user16b{1 + queue}", 99))
    card.advance(64)
    assert _cells(card) == [122, 99, 99]
    for queue, last in ((PFIFO1, 225), (PFIFO2, 328)):
        card.write(f"startpath{queue - 1}", FLAG)
        card.advance(1)
        assert (_cells(card)[0], card.waiting_words(queue)) == (last, 0)


@pytest.mark.covers(
    "imc.fifo.SEL_IFIFO",
    "imc.fifo.SEL_QFIFO",
    "imc.fifo.SEL_PFIFO1",
    "imc.fifo.SEL_PFIFO2",
    "imc.fifo.SEL_CFIFO",
    "imc.IMC_ClearFIFO",
)
@pytest.mark.covers("imc.param.clrififo", "imc.param.cfifocnt", "imc.param.clrqfifo")
def test_count_registers_show_the_words_that_wait_and_clear_when_written() -> None:
    card = ready_card()
    names = ("clrififo", "clrqfifo", "clrPFIFO1", "clrPFIFO2", "cfifocnt")
    card.push(QFIFO, WaitTime(0))
    card.advance(1)
    for k, queue in enumerate((IFIFO, QFIFO, PFIFO1, PFIFO2)):
        for _ in range(7 + 2 * k):
            card.push(queue, Write(address("user32b0"), 1, 0, 2))
    card.push_points(range(301))
    assert [card.read(name) for name in names] == [28, 36, 44, 52, 301]
    for k, name in enumerate(names):
        card.write(name, FLAG)
        assert [card.read(each) for each in names] == [0] * (k + 1) + [28, 36, 44, 52, 301][k + 1 :]
    card.push(PFIFO1, WaitTime(1))
    send(card, IFIFO, ("clearimc", FLAG))
    card.advance(1)
    assert [card.waiting_words(queue) for queue in range(5)] == [0] * 5


@shows("user16b0")
@pytest.mark.covers("imc.param.clrqfifo")
def test_a_queue_can_clear_itself() -> None:
    card = ready_card()
    send(card, QFIFO, ("clrqfifo", FLAG), ("user16b0", 1))
    card.advance(5)
    assert (_cells(card)[0], card.waiting_words(QFIFO)) == (0, 0)
    send(card, QFIFO, ("user16b0", 2))
    card.advance(1)
    assert _cells(card)[0] == 2


@pytest.mark.covers("imc.concept.instruction_fifos")
def test_queues_refuse_what_is_not_for_them() -> None:
    card = ready_card()
    event = Event(EventCommand.CMD_SET16, EventType.IMC_Allways, target=address("user16b0"))
    refused = [
        (IFIFO, WaitTime(5)),
        (IFIFO, WaitParam(address("moving"), 0)),
        (QFIFO, Segment((1, 2))),
        (4, setting("user16b0", 1)),
        (5, setting("user16b0", 1)),
        (PFIFO1, Segment(())),
        (PFIFO1, Segment((0,) * 17)),
        (PFIFO1, Segment((1,), (0, 0))),
        (QFIFO, InstallEvents(())),
        (QFIFO, InstallEvents((event,) * 32)),
    ]
    for queue, instruction in refused:
        with pytest.raises(UsageError):
            card.push(queue, instruction)  # type: ignore[arg-type]
    with pytest.raises(UsageError):
        card.clear_fifo(5)
    card.advance(5)
    assert [card.waiting_words(queue) for queue in range(5)] == [0] * 5


@pytest.mark.covers("imc.fifo.SEL_QFIFO", "imc.concept.qfifo", "imc.IMC_SetMulParam")
@shows("user16b0 user32b0")
def test_long_traffic_goes_round_the_ring() -> None:
    card = ready_card("[depths]\nqfifo = 64\n")
    for value in range(400):
        assert card.push(QFIFO, WriteMany((setting("user16b0", value), setting("user32b0", -value))))
        card.advance(1)
        assert (card.read("user16b0"), card.read("user32b0")) == (value, -value)


@pytest.mark.covers("imc.param.timer", "imc.param.ticks", "imc.param.delayus", "imc.param.delayout")
def test_timers_count_cycles() -> None:
    for unit, left in (("us", 5000), ("ms", 14990)):
        card = ready_card(f'delay_unit = "{unit}"')
        set_now(card, ("timer", 7), ("delayus", 15000))
        card.advance(5)
        assert (card.read("timer"), card.read("ticks")) == (2, 5)
        card.advance(5)
        assert (card.read("timer"), card.read("delayout")) == (0, left)
        card.advance(20)
        assert (card.read("delayout") == 0) == (unit == "us")


def test_general_inputs_read_0_when_closed_and_latch() -> None:
    card = ready_card()
    assert card.read_words(address("gin1"), 0, 2) == (0xFFFF, 0xFFFF)
    card.set_input(3, True)
    card.set_input(17, True)
    assert card.read_words(address("gin1"), 0, 2) == (0xFFFB, 0xFFFE)
    assert card.read_words(address("gin1lat"), 0, 2) == (4, 1)
    card.set_input(3, False)
    send(card, IFIFO, ("gin1lat", 4))
    card.advance(1)
    assert (card.read("gin1"), card.read("gin1lat"), card.read("gin2lat")) == (-1, 0, 1)


@pytest.mark.covers("imc.param.gio", "imc.param.giod")
def test_general_outputs_follow_their_registers() -> None:
    card = ready_card()
    send(card, IFIFO, ("gio", 0b101), ("giod", 0b10), ("gout3", -0x8000))
    card.advance(1)
    assert [number for number in range(1, 49) if card.output(number)] == [1, 3, 18, 48]
    for number in (-1, 0, 49, 64):
        with pytest.raises(UsageError, match=f"there is no output {number}"):
            card.output(number)


@pytest.mark.covers("imc.fifo.SEL_PFIFO1", "imc.fifo.SEL_PFIFO2")
@pytest.mark.covers("imc.concept.segment_blocking", "imc.concept.fifo_independence")
@shows("curpos user16b0 user16b1 user16b2")
def test_a_segment_holds_its_own_queue_only() -> None:
    card = ready_card()
    enable_path(card, 0, 1)
    enable_path(card, 2, space=2)
    line(card, 500, 0, speed=10)
    send(card, PFIFO1, ("user16b0", 1))
    send(card, PFIFO2, ("user16b1", 1))
    send(card, QFIFO, ("user16b2", 1))
    card.advance(2)
    assert _cells(card) == [0, 1, 1]
    card.wait()
    assert (_cells(card), card.read("curpos")) == ([1, 1, 1], 500)


@pytest.mark.covers("imc.concept.instruction_fifos", "imc.fifo.SEL_CFIFO", "imc.fifo.SEL_QFIFO")
def test_what_never_fits_into_a_queue_is_refused_and_not_put_off() -> None:
    card = ready_card("[depths]\nqfifo = 64\ncfifo = 100\n")
    writes = WriteMany(tuple(setting("user16b0", k) for k in range(22)))
    with pytest.raises(UsageError, match="66 words never fit into SEL_QFIFO"):
        card.push(QFIFO, writes)
    assert card.push(PFIFO1, writes)
    assert card.push_points([5] * 60)
    assert not card.push_points([5] * 60)
    with pytest.raises(UsageError, match="101 words never fit into SEL_CFIFO"):
        card.push_points([5] * 101)
    assert (card.waiting_words(1), card.waiting_words(4)) == (0, 60)
    for queue in (IFIFO, QFIFO):
        with pytest.raises(UsageError, match="for a path space"):
            card.push(queue, Points((1, 2)))
    with pytest.raises(UsageError, match="no points"):
        card.push(PFIFO1, Points(()))


@pytest.mark.covers(
    "imc.fifo.SEL_IFIFO",
    "imc.fifo.SEL_QFIFO",
    "imc.fifo.SEL_PFIFO1",
    "imc.fifo.SEL_PFIFO2",
    "imc.concept.ififo",
    "imc.concept.qfifo",
    "imc.concept.pfifo1",
    "imc.concept.pfifo2",
    "imc.concept.control_cycle",
)
@shows("user16b0 user16b1")
@pytest.mark.covers("imc.concept.instruction_fifos")
@pytest.mark.parametrize(("queue", "cycles"), [(IFIFO, 1), (QFIFO, 3), (PFIFO1, 1), (PFIFO2, 1)])
def test_every_queue_takes_the_same_instructions_and_carries_them_out_in_order(
    queue: Fifo, cycles: int
) -> None:
    card = ready_card()
    set_now(card, ("startpath1", FLAG), ("startpath2", FLAG))
    assert card.push(queue, setting("user16b0", 11))
    assert card.push(queue, ChangeBits(address("user16b0"), 0x4, 0x1))
    assert card.push(queue, WriteMany((setting("user16b1", 23), setting("user16b0", 37))))
    assert _cells(card) == [0, 0, 0]
    assert card.waiting_words(queue) == 3 + 4 + 6
    card.advance(cycles - 1)
    assert _cells(card)[:2] == ([14, 0] if cycles == 3 else [0, 0])
    card.advance(1)
    assert _cells(card)[:2] == [37, 23]
    assert card.waiting_words(queue) == 0


@pytest.mark.covers("imc.fifo.SEL_QFIFO", "imc.fifo.SEL_PFIFO1", "imc.fifo.SEL_PFIFO2")
@pytest.mark.covers(
    "imc.IMC_ClearFIFO", "imc.concept.instruction_fifos", "imc.concept.ififo", "imc.fifo.SEL_IFIFO"
)
@shows("clrqfifo user16b0 user16b1 user16b2")
@pytest.mark.parametrize("before", [0, 1, 3])
@pytest.mark.parametrize("times", [1, 2])
@pytest.mark.parametrize(
    ("fifo", "name"),
    [
        (QFIFO, "clrqfifo"),
        (PFIFO1, "clrPFIFO1"),
        (PFIFO2, "clrPFIFO2"),
        (QFIFO, "clearimc"),
        (PFIFO1, "clearimc"),
    ],
)
def test_emptying_at_once_spares_what_is_sent_after_it(
    fifo: Fifo, name: str, times: int, before: int
) -> None:
    card = ready_card()
    for space in (1, 2):
        enable_path(card, space - 1, space=space)
    for _ in range(before):
        send(card, fifo, ("user16b0", 7))
    for _ in range(times):
        send(card, IFIFO, (name, FLAG), ("user16b2", 3))
    send(card, fifo, ("user16b1", 5))
    card.advance(before + 2)
    assert [card.read(cell) for cell in CELLS] == [0, 5, 3]
    assert card.waiting_words(fifo) == 0


@pytest.mark.covers(
    "imc.IMC_ClearFIFO", "imc.concept.pfifo1", "imc.fifo.SEL_PFIFO1", "imc.IMC_AddLineNWithVel"
)
@shows("mcspos")
def test_lines_sent_right_after_an_emptying_are_gone_along() -> None:
    card = ready_card()
    enable_path(card, 0)
    line(card, 7000, speed=10.0)
    send(card, IFIFO, ("clrPFIFO1", FLAG))
    line(card, 1000, speed=10.0)
    card.wait()
    assert card.read("mcspos") == 1000


@pytest.mark.covers("imc.fifo.SEL_CFIFO", "imc.concept.cfifo", "imc.IMC_ClearFIFO", "imc.IMC_AddContourData")
@pytest.mark.covers("imc.concept.instruction_fifos")
@shows("cfifocnt")
def test_points_sent_right_after_an_emptying_stay() -> None:
    card = ready_card()
    assert card.push_points([1, 2, 3])
    send(card, IFIFO, ("clrCFIFO", FLAG))
    assert card.push_points([4, 5])
    card.advance(1)
    assert card.waiting_words(Fifo.SEL_CFIFO) == card.read("cfifocnt") == 2
