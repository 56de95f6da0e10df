"""Block search as a command of a control: by line, by sequence number, with and without what stands before."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from polycnc.cnc import Control, ControlError, ControlEvent, Mode, Refusal, RunState
from support.cnc_machine import cnc_machine

PROGRAM = """N10 G1 X20.5 F600
N20 G91 Y3.25
N30 G90 G1 X-7.5 Z1.5 F900
/N40 M8
N50 X30.25
N60 M30
"""
END = 100_000


def control(program: str = PROGRAM) -> Control:
    made = Control(cnc_machine())
    made.programs.create("PART", program)
    made.select_program("PART")
    return made


def refused(reason: Refusal, call: Callable[[], object], made: Control) -> None:
    before, beside = made.status(), made.snapshot().beside
    with pytest.raises(ControlError) as caught:
        call()
    assert caught.value.reason is reason
    assert caught.value.hint
    assert made.status() == before
    assert made.snapshot().beside == beside


def ended(made: Control) -> dict[str, float]:
    made.advance(END, until=ControlEvent.RUN_STATE)
    assert made.status().channel.run_state is RunState.COMPLETED
    return {name: axis.machine for name, axis in made.status().axes.items()}


def test_by_line_without_calculation_modal_state_is_what_it_was() -> None:
    made = control("N10 G1 G91 X3.5 F600\nN20 G90 Y2\nN30 G1 X14.75 F900\nM30\n")
    assert made.search(line=3) == 3
    made.cycle_start()
    assert ended(made) == {"X": 14.75, "Y": 0.0, "Z": 3.0, "B": 0.0}


def test_by_number_with_calculation_the_axes_go_where_the_block_begins() -> None:
    made = control()
    assert made.search(sequence=50, calculate=True) == 5
    at_rest = made.status().axes["X"].machine
    made.advance(100)
    assert made.status().axes["X"].machine == at_rest == 12.5
    made.cycle_start()
    made.advance(END, until=lambda: made.status().channel.feed.rapid is False and made.clock.cycles > 110)
    status = made.status()
    assert status.channel.block is not None
    assert status.channel.block.sequence == 50
    assert status.channel.modal is not None
    assert status.channel.modal.feed == 900.0
    assert ended(made) == {"X": 30.25, "Y": 3.25, "Z": 1.5, "B": 0.0}
    made.cycle_start()  # the search was for one start: now from the beginning, whose G91 block adds
    made.advance(200)
    block = made.status().channel.block
    assert block is not None
    assert block.sequence == 10


def test_wrong_numbers_are_refused_and_nothing_has_changed() -> None:
    made = control()
    for wrong in ({"line": 0}, {"line": 7}, {"line": -3}, {"sequence": 35}, {"sequence": -1}):
        for calculate in (False, True):
            refused(
                Refusal.NOT_FOUND,
                lambda wrong=wrong, calculate=calculate: made.search(**wrong, calculate=calculate),  # type: ignore[misc]
                made,
            )
    refused(Refusal.DATA, lambda: made.search(line=2, channel=1), made)
    made.search(sequence=30)
    refused(Refusal.NOT_FOUND, lambda: made.search(sequence=51), made)
    made.cycle_start()  # the search before still holds
    assert ended(made) == {"X": 30.25, "Y": 0.0, "Z": 1.5, "B": 0.0}


def test_a_block_that_is_never_reached_or_behind_an_error_is_refused() -> None:
    made = control("N10 G1 X20.5 F600\nN20 M30\nN30 G1 Y2\n")
    made.cycle_start()
    ended(made)
    refused(Refusal.NOT_FOUND, lambda: made.search(sequence=30, calculate=True), made)
    made.programs.write("PART", "N10 G1 X200 F600\nN20 G1 Y2\nM30\n")
    refused(Refusal.NOT_FOUND, lambda: made.search(sequence=20, calculate=True), made)
    made.programs.write("PART", "N10 G1 X21.5 F600\nN20 G1 Y2\nM30\n")
    made.search(sequence=20, calculate=True)
    made.programs.write("PART", "N10 G1 X22.5 F600\nM30\n")  # and now the block is gone
    refused(Refusal.NOT_FOUND, made.cycle_start, made)


def test_only_in_auto_and_only_where_nothing_is_under_way() -> None:
    made = control()
    for mode in set(Mode) - {Mode.AUTO}:
        made.select_mode(mode)
        refused(Refusal.MODE, lambda: made.search(line=3), made)
    made.select_mode(Mode.JOG)
    made.jog("X", 1)
    made.advance(50)
    made.select_mode(Mode.AUTO)
    refused(Refusal.RUNNING, lambda: made.search(line=3), made)
    made.advance(500)
    made.cycle_start()
    made.advance(100)
    refused(Refusal.RUNNING, lambda: made.search(line=3), made)
    made.feed_hold()
    made.advance(200)
    refused(Refusal.RUNNING, lambda: made.search(line=3), made)
    made.emergency_stop()
    made.advance(200)
    refused(Refusal.EMERGENCY, lambda: made.search(line=3), made)
    with_nothing = Control(cnc_machine())
    refused(Refusal.NOT_FOUND, lambda: with_nothing.search(line=1), with_nothing)


@pytest.mark.parametrize("what", ["reset", "select", "mdi"])
def test_what_ends_a_search(what: str) -> None:
    made = control("N10 G1 X20.5 F600\nN20 G1 Y2.5 F600\nM30\n")
    made.search(sequence=20)
    if what == "reset":
        made.reset()
    elif what == "select":
        made.select_program("PART")
    else:
        made.select_mode(Mode.MDI)
        made.set_mdi("G1 Z-4.5 F900")
        made.cycle_start()
        assert ended(made)["Z"] == -4.5
        made.select_mode(Mode.AUTO)
    made.cycle_start()
    x = ended(made)["X"]
    assert x == 20.5


def test_a_search_is_part_of_a_snapshot() -> None:
    made = control("N10 G1 X20.5 F600\nN20 G1 Y2.5 F600\nM30\n")
    made.search(sequence=20)
    saved = made.snapshot()
    made.reset()
    made.restore(saved)
    made.cycle_start()
    assert ended(made) == {"X": 12.5, "Y": 2.5, "Z": 3.0, "B": 0.0}
