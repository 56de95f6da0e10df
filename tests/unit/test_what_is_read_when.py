"""What a program reads, and when: values of a PC, offsets and tools count for blocks not prepared yet."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from polycnc.cnc import Answer, Control, ControlData, ControlEvent, Function, RunState
from polycnc.controllers.fanuc import PowerMate
from support.cnc_machine import cnc_machine

TEXT = "O0001\nG90G1X10.F600\nX20.\nX[#500]\nY[#501]\nM30\n"


def started(text: str = TEXT) -> PowerMate:
    made = PowerMate(2)
    made.macros.set(500, 5.0)
    made.macros.set(501, 2.0)
    made.programs.register(1, text)
    made.select_mode("MEM")
    made.select_program(1)
    made.cycle_start()
    return made


def sequence_is(made: PowerMate, line: int) -> Callable[[], bool]:
    return lambda: made.execution.block is not None and made.execution.block.line == line


def end_of(made: PowerMate) -> dict[str, float]:
    for _ in range(9):
        made.advance(100_000, until=ControlEvent.RUN_STATE)
        if made.status().channel.run_state is RunState.COMPLETED:
            break
        made.cycle_start()
    assert made.status().channel.run_state is RunState.COMPLETED
    return {name: round(axis.machine, 6) for name, axis in made.status().axes.items()}


def test_a_power_mate_reads_one_block_ahead() -> None:
    made = started()
    made.advance(300)  # within the first block
    made.macros.set(500, 33.0)
    made.advance(100_000, until=sequence_is(made, 4))
    made.advance(2)
    assert made.status().axes["X"].machine == pytest.approx(20.0, abs=0.1)
    made.macros.set(500, 44.0)  # this block is executed
    made.macros.set(501, 7.5)  # and this one has been read
    assert end_of(made) == {"X": 33.0, "Y": 2.0}


@pytest.mark.parametrize("state", ["moving", "held", "between blocks"])
def test_what_is_written_before_a_block_is_read_counts_in_every_state(state: str) -> None:
    made = started()
    made.advance(300)
    if state == "held":
        made.control.feed_hold()
        made.advance(500)
    if state == "between blocks":
        made.control.set_switches(single_block=True)
        made.advance(100_000, until=ControlEvent.RUN_STATE)
        assert made.status().channel.run_state is RunState.STOPPED_AT_BLOCK
    made.macros.set(500, 33.0)
    if state != "moving":
        made.control.set_switches(single_block=False)
        made.cycle_start()
    assert end_of(made) == {"X": 33.0, "Y": 2.0}


def test_tool_offsets_count_for_blocks_that_have_not_been_read() -> None:
    made = started("O0001\nG90G1X10.F600\nX20.\nX#2003\nY#2004\nM30\n")
    made.advance(300)
    made.tool_offsets.set_all({3: 21_500, 4: 3_250})
    assert end_of(made) == {"X": 21.5, "Y": 3.25}


@pytest.mark.parametrize("words", ["M6", "T2 M6", "M8", "S900 M3"])
@pytest.mark.parametrize("cut", [1, 211])
def test_what_the_plc_changes_counts_behind_its_function(words: str, cut: int) -> None:
    """While a function waits for its answer nothing behind it is read: offsets that are measured then count."""
    made = Control(
        cnc_machine(),
        dialect="fanuc",
        data=ControlData(reference_required=False),
        script={(each, None): Answer(after_s=None) for each in Function},
    )
    made.programs.create("PART", f"G1 X3 F3000\n{words}\nG54 X5\nM30\n")
    made.select_program("PART")
    made.cycle_start()
    while not made.waiting_functions(0):
        made.advance(cut)
    made.offsets.set("G54", {"X": 1.25})
    while made.waiting_functions(0):
        made.plc.answer()
        made.advance(1)
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert made.status().axes["X"].machine == pytest.approx(6.25)
