"""Steps, breakpoints, block search, MDI and the operator's switches of program runs."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from polycnc.cnc import Breakpoint, ProgramRun
from polycnc.errors import UsageError
from polycnc.machine import Machine
from polycnc.nc import Event, Group, ProgramText, load_dialect
from polycnc.nc.macro import MacroLanguage
from support.programs import FIVE, LINEAR, MILL, SPINDLE, TIMES, machine_config
from support.runs import executed_line, program_run, stands, to_the_end, undisturbed

MAIN = "N1 G0 X5 Y2\nN2 G91 F1200\nN3 M98 P815\nN4 G90 G1 X1 Y7\nM30\n"
SUB = "O0815\nN110 G1 X12.75\nN120 M98 P816 L2\nN130 X-4.25\nM99\n"
INNER = "O0816\nN210 Y1.5\nM99\n"


@pytest.fixture
def nested(tmp_path: Path) -> ProgramText:
    (tmp_path / "O0815.nc").write_text(SUB)
    (tmp_path / "O0816.nc").write_text(INNER)
    (tmp_path / "main.nc").write_text(MAIN)
    return ProgramText.from_path(tmp_path / "main.nc")


def at(run: ProgramRun) -> tuple[str, int]:
    record = run.reading.block
    assert record is not None
    return Path(record.program).stem, record.line


def steps(run: ProgramRun, *how: str) -> list[tuple[str, int]]:
    found = []
    for each in how:
        getattr(run, f"step_{each}")()
        to_the_end(run)
        found.append(at(run))
    return found


# --- steps


def test_stepping_into_goes_through_every_block(nested: ProgramText) -> None:
    run = program_run(nested)
    found = []
    while stands(run) != "COMPLETED":
        found += steps(run, "into")
        if stands(run) == "STOPPED_AT_BLOCK":
            assert run.at_rest
    assert found == [
        ("main", 1),
        ("main", 2),
        ("main", 3),
        ("O0815", 1),
        ("O0815", 2),
        ("O0815", 3),
        ("O0816", 1),
        ("O0816", 2),
        ("O0816", 3),
        ("O0816", 1),
        ("O0816", 2),
        ("O0816", 3),
        ("O0815", 4),
        ("O0815", 5),
        ("main", 4),
        ("main", 5),
    ]
    assert run.machine.setpoints == undisturbed(nested)[1] == {"X": 1.0, "Y": 7.0, "Z": 0.0}


def test_stepping_over_runs_a_sub_program_as_a_whole(nested: ProgramText) -> None:
    run = program_run(nested)
    assert steps(run, "over", "over", "over", "over", "over") == [
        ("main", 1),
        ("main", 2),
        ("O0815", 5),  # the last block before the program is in the main program again
        ("main", 4),
        ("main", 5),
    ]
    assert run.machine.setpoints == {"X": 1.0, "Y": 7.0, "Z": 0.0}


def test_stepping_out_ends_behind_the_sub_program(nested: ProgramText) -> None:
    run = program_run(nested)
    steps(run, *["into"] * 8)
    assert at(run) == ("O0816", 2)
    assert run.reading.position["Y"] == 3.5
    assert [call.repeat for call in run.reading.stack] == [1, 1]
    steps(run, "out")
    # The second round of the inner program is another call of the same depth: both rounds are left.
    assert run.reading.position["Y"] == 5.0
    assert at(run) == ("O0816", 3)
    assert steps(run, "into") == [("O0815", 4)]
    assert steps(run, "out") == [("O0815", 5)]
    run.resume()
    to_the_end(run)
    assert stands(run) == "COMPLETED"


def test_steps_in_motion_are_refused(nested: ProgramText) -> None:
    run = program_run(nested)
    run.start()
    run.advance(4)
    with pytest.raises(UsageError, match="the program is running"):
        run.step_over()


def test_a_step_from_a_hold_ends_with_the_block_that_is_held() -> None:
    run = program_run("N1 G1 X20 F6000\nN2 X40\nN3 X60\n")
    run.start()
    run.advance(150)
    run.hold()
    run.advance(300)
    assert 5.0 < run.reading.position["X"] < 20.0
    run.step_into()
    to_the_end(run)
    assert run.reading.position["X"] == 20.0
    assert stands(run) == "STOPPED_AT_BLOCK"


# --- breakpoints


def test_a_breakpoint_stops_before_its_block(nested: ProgramText) -> None:
    run = program_run(nested)
    run.switches.breakpoints = [Breakpoint(str(Path(nested.name).with_name("O0815.nc")), 4)]
    run.start()
    to_the_end(run)
    assert stands(run) == "STOPPED_AT_BLOCK"
    assert run.reading.position == {"X": 17.75, "Y": 5.0, "Z": 0.0}
    run.switches.breakpoints = []
    run.resume()
    to_the_end(run)
    assert stands(run) == "COMPLETED"


def test_a_breakpoint_of_no_program_holds_in_every_one_and_one_set_in_motion_counts() -> None:
    run = program_run("".join(f"G1 X{n} F3000\n" for n in range(1, 60)))
    run.start()
    run.advance(60)
    run.switches.breakpoints = [Breakpoint(line=31), Breakpoint(line=47)]
    stops = []
    while run.active:
        to_the_end(run)
        stops.append(run.reading.position["X"])
        if stands(run) == "STOPPED_AT_BLOCK":
            run.resume()
    assert stops == [30.0, 46.0, 59.0]


def test_a_breakpoint_that_comes_to_others_in_motion_counts_in_what_is_prepared() -> None:
    run = program_run("".join(f"G1 X{n} F3000\n" for n in range(1, 60)))
    run.switches.breakpoints = [Breakpoint(line=55)]
    run.start()
    run.advance(60)
    run.switches.breakpoints = [Breakpoint(line=31), Breakpoint(line=55)]
    to_the_end(run)
    assert run.reading.position["X"] == 30.0
    run.switches.breakpoints = []  # and one that is taken away does not
    run.resume()
    to_the_end(run)
    assert (stands(run), run.reading.position["X"]) == ("COMPLETED", 59.0)


def test_a_condition_stops_where_it_has_become_true_and_prepares_no_further() -> None:
    run = program_run("".join(f"G1 X{n} F3000\n" for n in range(1, 60)))
    run.switches.breakpoints = [Breakpoint(condition=lambda: run.channel.state.modal.position[0] > 17.5)]
    run.start()
    to_the_end(run)
    assert stands(run) == "STOPPED_AT_BLOCK"
    assert run.reading.position["X"] == 18.0
    assert run.channel.state.modal.position[0] == 18.0
    run.switches.breakpoints = []
    run.resume()
    to_the_end(run)
    assert run.reading.position["X"] == 59.0


# --- search


def test_a_search_without_calculation_begins_at_the_block_with_the_first_state() -> None:
    run = program_run("N10 G91 G1 X5 F600\nN20 X10\nN30 X7 F900\nM30\n")
    assert run.selection.search(sequence=30) == 3
    run.start()
    to_the_end(run)
    assert run.reading.modal is not None
    assert run.reading.modal.g[Group.DISTANCE] == "G90"
    assert run.machine.setpoints["X"] == 7.0


def test_a_search_with_calculation_goes_to_where_the_block_begins() -> None:
    program = "N10 G91 G1 X5 F600\nN15 M3 S400\nN20 X10 Y2\nN30 X7 F900\nM30\n"
    run = program_run(program, FIVE)
    words: list[str] = []
    run.events.on_event = lambda event: words.append(event.word)
    assert run.selection.search(line=4, calculate=True) == 4
    assert run.machine.setpoints["X"] == 0.0
    run.switches.single_block = True
    run.start()
    to_the_end(run)
    assert (run.reading.position["X"], run.reading.position["Y"]) == (15.0, 2.0)
    run.resume()
    to_the_end(run)
    assert run.reading.modal is not None
    assert run.reading.modal.g[Group.DISTANCE] == "G91"
    assert run.reading.modal.feed == 900.0
    assert run.reading.modal.speed == 400.0
    assert run.reading.position["X"] == 22.0
    run.resume()
    to_the_end(run)
    assert words == ["M30"]  # functions before the block are not given out
    assert run.machine.setpoints["X"] == undisturbed(program, FIVE)[1]["X"] == 22.0


def test_a_search_with_calculation_goes_through_sub_programs(nested: ProgramText) -> None:
    run = program_run(nested)
    run.selection.search(sequence=4, calculate=True)
    run.step_into()
    to_the_end(run)
    assert run.reading.position == {"X": 5.0 + 12.75 - 4.25, "Y": 2.0 + 3.0, "Z": 0.0}


def test_a_search_with_calculation_executes_macro_statements() -> None:
    """Three moves of 2, 4 and 6 mm stand before N50, which goes on from there."""
    text = "#1=0\nWHILE[#1LT3]DO1\n#1=#1+1\nN20 G91 G1 X[#1*2] F600\nEND1\nN50 Y#1\nN60 X-#1\nM30\n"
    program = ProgramText.from_text(text, "test")
    run = ProgramRun(Machine(MILL), program, load_dialect("fanuc"), language=MacroLanguage())
    assert run.selection.search(sequence=50, calculate=True) == 6
    assert run.selection.searched == (12.0, 0.0, 0.0)
    assert run.machine.setpoints["X"] == 0.0
    run.start()
    to_the_end(run)
    assert run.machine.setpoints == {"X": 9.0, "Y": 3.0, "Z": 0.0}


@pytest.mark.parametrize(
    ("where", "what"),
    [
        ({"sequence": 31}, "no block N31"),
        ({"line": 9}, "no line 9"),
        ({"line": 0}, "no line 0"),
        ({"line": 4, "calculate": True}, "the program ends before line 4"),
        ({"line": 2, "calculate": True}, "radius compensation is active at line 2"),
    ],
)
def test_a_search_for_what_is_not_there_leaves_the_program_at_its_beginning(
    where: dict[str, int], what: str
) -> None:
    run = program_run("N10 G1 G41 D1 X15 F600\nN20 X30\nM30\nN40 X50\n", FIVE)
    with pytest.raises(UsageError, match=what):
        run.selection.search(**where)  # type: ignore[arg-type]
    assert stands(run) == "READY"
    run.start()
    run.advance(30)
    assert at(run) == ("test", 1)


# --- MDI


def test_mdi_keeps_modal_words_from_one_input_to_the_next() -> None:
    run = program_run("G1 X9 F100\n")
    run.mdi("G91 G1 X4 F1300\n")
    to_the_end(run)
    run.mdi("X4\n")
    to_the_end(run)
    assert run.machine.setpoints["X"] == 8.0
    assert run.reading.modal is not None
    assert (run.reading.modal.g[Group.DISTANCE], run.reading.modal.feed) == ("G91", 1300.0)
    assert at(run) == ("MDI", 1)
    run.selection.load(ProgramText.from_text("G1 X9 F100\n", "again"))
    run.start()
    to_the_end(run)
    assert run.machine.setpoints["X"] == 9.0  # a program begins with the dialect's state


def test_mdi_while_a_program_runs_is_refused() -> None:
    run = program_run("G1 X9 F100\n")
    run.start()
    run.advance(7)
    with pytest.raises(UsageError, match="the program is active"):
        run.mdi("X2\n")
    to_the_end(run)
    assert run.machine.setpoints["X"] == 9.0


# --- switches


def test_block_delete_acts_on_blocks_prepared_afterwards() -> None:
    run = program_run("G1 X5 F600\nM0\n/2 X10\n/ X11\nY3\n")
    run.start()
    to_the_end(run)
    run.switches.block_delete = {2}
    run.resume()
    to_the_end(run)
    assert run.machine.setpoints == {"X": 11.0, "Y": 3.0, "Z": 0.0}


def test_a_dry_run_goes_with_its_own_feed() -> None:
    run = program_run("G1 X50 F600\n", dry_run_mm_s=40.0)
    run.overrides.dry_run = True
    run.start()
    assert to_the_end(run) == math.ceil((50 / 40 + 40 / 5000) / 0.001 - 1e-6)
    with pytest.raises(UsageError, match="no feed for a dry run"):
        program_run("G1 X50 F600\n").overrides.dry_run = True


def test_the_rapid_override_and_its_lowest_speed() -> None:
    times = {}
    for factor in (1.0, 0.5, 0.25, 0.0):
        run = program_run("G0 X100\n", rapid_f0_mm_s=20.0)
        run.overrides.rapid = factor
        assert run.overrides.rapid == factor
        run.start()
        times[factor] = to_the_end(run)
    speeds = {1.0: 500.0, 0.5: 250.0, 0.25: 125.0, 0.0: 20.0}
    assert times == {
        factor: math.ceil((100 / speed + speed / 5000) / 0.001 - 1e-6) for factor, speed in speeds.items()
    }
    standing = program_run("G1 X3 F600\nG0 X100\n")
    standing.overrides.rapid = 0.0
    standing.start()
    standing.advance(5000)
    assert standing.reading.position["X"] == 3.0
    standing.overrides.rapid = 1.0
    to_the_end(standing)
    assert standing.reading.position["X"] == 100.0


def test_the_machine_lock_lets_the_path_run_without_the_axes() -> None:
    run = program_run("G1 X50 F6000\nX20\n")
    run.switches.machine_lock = True
    run.start()
    run.advance(100)
    assert run.reading.position["X"] > 5.0
    assert run.machine.setpoints["X"] == 0.0
    with pytest.raises(UsageError, match="while the axes move"):
        run.switches.machine_lock = False
    to_the_end(run)
    assert run.reading.position["X"] == 20.0
    assert run.machine.setpoints["X"] == 0.0
    run.switches.machine_lock = False
    run.start()
    to_the_end(run)
    assert run.machine.setpoints["X"] == 20.0


# --- auxiliary functions


def test_the_path_stands_at_a_function_until_it_is_answered() -> None:
    config = machine_config(LINEAR, SPINDLE, TIMES)
    run = program_run("G1 X5 F600\nM8\nX10\n", config, answers=True)
    asked: list[tuple[str, float, float]] = []

    def ask(event: Event) -> bool:
        asked.append((event.word, event.default_s, run.reading.position["X"]))
        return True

    run.events.on_event = ask
    run.start()
    run.advance(4000)
    assert asked == [("M8", 0.25, 5.0)]
    assert run.active
    assert run.reading.position["X"] == 5.0
    run.events.answered()
    to_the_end(run)
    assert run.reading.position["X"] == 10.0


def test_answers_after_the_machine_files_times_take_the_cycles_of_the_queue() -> None:
    config = machine_config(LINEAR, SPINDLE, TIMES)
    program = "G1 X5 F600\nM3 S700\nX10 M8\nM6\nX12\n"
    cycles, _ = undisturbed(program, config)
    run = program_run(program, config, answers=True)
    due: list[int] = []

    def ask(event: Event) -> bool:
        due.append(run.machine.clock.cycles + round(event.default_s / 0.001))
        return due[-1] > run.machine.clock.cycles

    run.events.on_event = ask
    run.start()
    while run.active:
        run.advance(1)
        if due and run.machine.clock.cycles == due[-1]:
            run.events.answered()
    assert run.machine.clock.cycles == cycles


# --- tables that change


def test_a_work_offset_changed_while_it_runs_acts_on_blocks_prepared_afterwards() -> None:
    class Offsets(dict[str, dict[str, float]]):
        revision = 0

    offsets = Offsets(G54={"X": 0.0})
    config = FIVE.model_copy(update={"offsets": offsets})
    run = program_run("G54 G1 X5 F6000\nX6\nX7\nX8\nX9\nX10\n", config, blocks_ahead=1)
    run.start()
    run.advance(100_000, until=lambda: executed_line(run) == 3)
    offsets["G54"] = {"X": 100.0}
    offsets.revision += 1
    to_the_end(run)
    assert run.reading.position["X"] == 110.0
    assert run.reading.modal is not None
    assert run.reading.modal.zero[0] == 100.0


# --- going back


@pytest.mark.parametrize("cycle", [3, 61, 200, 777])
def test_a_run_goes_back_to_a_snapshot_and_ends_the_same(cycle: int, nested: ProgramText) -> None:
    run = program_run(nested)
    run.start()
    run.advance(cycle)
    saved, machine = run.snapshot(), run.machine.snapshot()
    record = run.reading.block

    def to_the_end() -> list[object]:
        went: list[object] = []
        while run.active:
            run.advance(1)
            went.append((run.reading.position, run.reading.block))
        return went

    first = to_the_end()
    run.restore(saved)
    run.machine.restore(machine)
    assert run.reading.block == record
    run.hold()
    run.advance(50)
    run.restore(saved)
    run.machine.restore(machine)
    assert to_the_end() == first
    assert len(first) > 20


def test_restoring_goes_back_before_a_program_that_was_loaded_since(nested: ProgramText) -> None:
    run = program_run(nested)
    run.start()
    run.advance(40)
    saved, machine = run.snapshot(), run.machine.snapshot()
    run.reset()
    run.advance(400)
    run.mdi("G1 X3 F300\n")
    run.advance(9)
    run.restore(saved)
    run.machine.restore(machine)
    to_the_end(run)
    assert run.machine.setpoints == undisturbed(nested)[1]


# --- long programs and tools


def test_contexts_that_nothing_refers_to_are_forgotten() -> None:
    # Every block has a modal state of its own: S changes in each.
    program = "".join(f"G1 X{n % 3} S{n} F9000\n" for n in range(1, 9_000))
    run = program_run(program, segments=512)
    run.start()
    most = 0
    while run.active:
        run.skip()
        most = max(most, len(run.channel.records.snapshot()[0]))
    assert most < 7000
    assert run.reading.block is not None
    assert run.reading.block.line == 8_999


def test_time_is_accounted_to_the_tool_in_the_spindle() -> None:
    program = "G1 X5 F600\nT1 M6\nG1 X25 F1200\nG0 X0\nT2\nG1 X3\nM6\nX9 F300\nM30\n"
    run = program_run(program, FIVE)
    run.start()
    to_the_end(run)
    times = run.reading.tool_times
    assert list(times) == [0, 1, 2]
    assert times[0].cutting_s == pytest.approx(5 / 10 + 10 / 5000, abs=2e-3)
    assert times[1].cutting_s == pytest.approx(20 / 20 + 20 / 5000 + 3 / 20 + 20 / 5000, abs=4e-3)
    assert times[1].rapid_s == pytest.approx(2 * math.sqrt(25 / 5000), abs=2e-3)
    assert times[2].cutting_s == pytest.approx(6 / 5 + 5 / 5000, abs=2e-3)
    assert times[2].rapid_s == 0.0
