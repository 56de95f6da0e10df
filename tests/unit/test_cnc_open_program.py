"""A program that is fed to a control while it is executed: what it takes, refuses, and what stays as it was."""

from __future__ import annotations

import pytest

from polycnc.cnc import Control, ControlData, ControlError, Mode, OpenProgram, Refusal, RunState
from polycnc.errors import ProgramError
from polycnc.machine import SnapshotError
from polycnc.nc.macro import MacroLanguage
from support.cnc_control import fresh, refused, x_of
from support.cnc_machine import cnc_machine


def opened(
    dialect: str = "din", mode: Mode = Mode.MDI, room_bytes: int = 65536
) -> tuple[Control, OpenProgram]:
    made = Control(cnc_machine(), dialect=dialect, data=ControlData())
    made.select_mode(mode)
    return made, made.open_program(room_bytes=room_bytes)


def until_starved(made: Control, program: OpenProgram, cycles: int = 100_000) -> None:
    made.advance(cycles, until=lambda: program.starved)


def test_lines_are_executed_as_they_come_and_the_path_rests_between() -> None:
    made, program = opened()
    program.feed("G1 X20 F6")
    made.cycle_start()
    made.advance(5)
    assert (program.lines, program.starved) == (0, True)
    program.feed("00\nX3")
    until_starved(made, program)
    assert x_of(made) == 20.0
    assert made.status().channel.starved
    assert made.status().channel.run_state is RunState.ACTIVE
    program.end()
    made.advance(100_000, until=lambda: not made.status().channel.active)
    assert x_of(made) == 3.0
    assert made.status().channel.run_state is RunState.COMPLETED
    assert not program.is_open


def test_the_words_of_a_line_hold_for_the_next_and_for_the_next_program() -> None:
    made, program = opened()
    made.cycle_start()
    program.feed("G91 G1 X2 F600\n")
    until_starved(made, program)
    program.feed("X2\n")
    program.end()
    made.advance(10_000, until=lambda: not made.status().channel.active)
    again = made.open_program()
    again.feed("X2\n")
    made.cycle_start()
    until_starved(made, again)
    assert x_of(made) == 12.5 + 6.0


def test_blocks_follow_each_other_without_a_stop_when_they_come_in_time() -> None:
    whole = Control(cnc_machine(), dialect="din")
    whole.select_mode(Mode.MDI)
    whole.set_mdi("G1 X40 F3000\nX44\nX48\n")
    whole.cycle_start()
    whole.advance(10_000, until=lambda: whole.status().channel.run_state is RunState.COMPLETED)
    made, program = opened()
    made.cycle_start()
    for line in ("G1 X40 F3000\n", "X44\n", "X48\n"):
        program.feed(line)
        made.advance(1)
    program.end()
    made.advance(10_000, until=lambda: made.status().channel.run_state is RunState.COMPLETED)
    assert whole.clock.cycles <= made.clock.cycles < whole.clock.cycles + 8  # a stop would cost 71


@pytest.mark.parametrize(
    "text",
    [
        "G1 X1000\n", "G2 X3\n", "X\n", "G77.7\n", "G1 X5\nX6\nG1 X7 X8\n", "G0 G1 X3\n", "M30\nG1 X5\n", "G1 X[1]\n",
    ],
)  # fmt: skip
def test_a_wrong_line_is_refused_with_all_of_its_text_and_disturbs_nothing(text: str) -> None:
    made, program = opened()
    made.cycle_start()
    program.feed("G1 X14 F600\nX18\n")
    made.advance(50)
    before, room = fresh(made), program.room
    with pytest.raises(ProgramError) as caught:
        program.feed(text)
    assert caught.value.position is not None
    assert caught.value.position.file == "MDI"
    assert caught.value.position.line >= 3
    assert (fresh(made), program.room, program.lines) == (before, room, 2)
    program.feed("X20\n")
    until_starved(made, program)
    assert x_of(made) == 20.0


def test_a_check_writes_no_table_and_a_block_does() -> None:
    made, program = opened("grbl")
    program.feed("G10 L2 P1 X5\nG0 X1\n")
    assert "G54" not in made.offsets or made.offsets["G54"]["X"] == 0.0
    with pytest.raises(ProgramError):
        program.feed("G10 L2 P1 X9\nX9999\n")
    made.cycle_start()
    until_starved(made, program)
    assert x_of(made) == 6.0
    assert made.offsets["G54"]["X"] == 5.0


def test_what_waits_is_bounded() -> None:
    made, program = opened(room_bytes=12)
    program.feed("G1 X14 F600")
    refused(Refusal.FULL, lambda: program.feed("\nX"), made)
    program.feed("\n")
    assert program.full
    made.cycle_start()
    made.advance(1)
    assert program.room == 12


@pytest.mark.parametrize("end", ["M30\n", "M2\n", "G1 X13\n%\n"])
def test_the_program_ends_where_it_says_so(end: str) -> None:
    made, program = opened(mode=Mode.AUTO)
    program.feed("G1 X14 F600\n")
    made.cycle_start()
    program.feed(end)
    made.advance(10_000, until=lambda: not made.status().channel.active)
    assert made.status().channel.run_state is RunState.COMPLETED
    assert not program.is_open
    refused(Refusal.IDLE, lambda: program.feed("X5\n"), made)
    refused(Refusal.IDLE, program.end, made)
    refused(Refusal.NOT_FOUND, made.cycle_start, made)


def test_a_reset_drops_what_waits() -> None:
    made, program = opened()
    made.cycle_start()
    program.feed("G1 X40 F600\nX50\nX60\n")
    made.advance(100)
    made.reset()
    made.advance(1000)
    assert not program.is_open
    assert x_of(made) < 15.0
    refused(Refusal.IDLE, lambda: program.feed("X5\n"), made)


def test_a_program_of_the_memory_is_called() -> None:
    made, program = opened("fanuc", mode=Mode.AUTO)
    made.programs.create("O7", "O7\nG91 G1 X3 F600\nM99\n")
    made.cycle_start()
    program.feed("M98 P7\nG90 X10\n")
    made.advance(100_000, until=lambda: made.status().channel.starved)
    assert x_of(made) == 10.0
    assert program.lines == 2


def test_variables_last_from_line_to_line_however_they_come() -> None:
    found = []
    for cut in (3, 7, 1000):
        made, program = opened("fanuc")
        made.cycle_start()
        text = "#101=4.\nG91 G1 X#101 F600.\n#1=#101+1.\nX#1\n"
        for begin in range(0, len(text), cut):
            program.feed(text[begin : begin + cut])
            made.advance(3)
        made.advance(100_000, until=lambda: program.starved)  # noqa: B023
        found.append(x_of(made))
    assert found == [21.5, 21.5, 21.5]


def test_a_statement_that_needs_other_lines_is_an_alarm_wherever_it_is_cut() -> None:
    made, program = opened("fanuc")
    made.cycle_start()
    program.feed("WHILE[#1LT3]DO1\n#1=#1+1\nEND1\n")
    made.advance(10)
    assert made.status().channel.run_state is RunState.ALARM
    refused(Refusal.ALARM, lambda: program.feed("X5\n"), made)


def test_single_block_stops_between_lines() -> None:
    made, program = opened()
    made.set_switches(single_block=True)
    made.cycle_start()
    program.feed("G1 X14 F600\nX16\n")
    made.advance(10_000, until=lambda: made.status().channel.interrupted)
    assert x_of(made) == 14.0
    made.cycle_start()
    made.advance(5_000)
    assert x_of(made) == 16.0
    program.feed("X18\n")
    made.advance(5_000)
    assert (x_of(made), made.status().channel.run_state) == (16.0, RunState.STOPPED_AT_BLOCK)


def test_it_is_opened_where_programs_are_executed_and_none_is() -> None:
    made, program = opened()
    made.cycle_start()
    program.feed("G1 X40 F600\n")
    made.advance(10)
    refused(Refusal.RUNNING, made.open_program, made)
    made.reset()
    made.advance(1000)
    made.select_mode(Mode.JOG)
    refused(Refusal.MODE, made.open_program, made)
    made.select_mode(Mode.AUTO)
    made.programs.create("PART", "M30\n")
    refused(Refusal.EXISTS, lambda: made.open_program("PART"), made)
    refused(Refusal.DATA, lambda: made.open_program(room_bytes=0), made)


def test_a_snapshot_is_refused_while_more_may_come_and_taken_after() -> None:
    made, program = opened()
    made.cycle_start()
    program.feed("G1 X14 F600\nX15\n")
    made.advance(10)
    with pytest.raises(SnapshotError, match="still coming"):
        made.snapshot()
    program.end()
    made.advance(10_000)
    kept = type(made.snapshot()).from_bytes(made.snapshot().to_bytes())
    status = fresh(made)
    made.restore(kept)
    assert fresh(made) == status
    block = made.status().channel.block
    assert block is not None
    assert block.text == "X15"


def test_a_search_in_it_is_refused() -> None:
    made, _ = opened(mode=Mode.AUTO)
    refused(Refusal.NOT_FOUND, lambda: made.search(line=1), made)


def test_an_alarm_closes_the_way_in() -> None:
    made, program = opened()
    made.cycle_start()
    program.feed("G1 X40 F600\n")
    made.advance(10)
    made.emergency_stop()
    made.advance(1000)
    with pytest.raises(ControlError):
        program.feed("X50\n")


def test_what_has_been_read_is_not_kept() -> None:
    language = MacroLanguage()
    made = Control(cnc_machine(), dialect="fanuc", languages=[language])
    made.select_mode(Mode.MDI)
    program = made.open_program()
    made.cycle_start()
    for n in range(200):
        program.feed(f"#100={n}\nG91 G1 X0.001 F600.\n")
        made.advance(5)
    assert max(len(each) for each in vars(language).values() if isinstance(each, dict)) <= 260
