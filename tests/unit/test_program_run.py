"""Program runs: held, stepped, stopped and watched, cycle by cycle."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from polycnc.errors import UsageError
from polycnc.nc import Call, Group, ProgramText
from support.programs import FIVE
from support.runs import executed_line, program_run, stands, to_the_end, undisturbed

CONTOUR = """\
N10 G0 X12.5 Y-7.25 Z3
N20 G1 X31 Y4.5 F1450
N30 Y17.75
N40 X-8.125 F900
"""


# --- from start to end


def test_nothing_moves_before_the_start() -> None:
    run = program_run(CONTOUR)
    assert stands(run) == "READY"
    assert run.reading.block is None
    assert run.advance(57) == 57
    assert run.machine.setpoints == {"X": 0.0, "Y": 0.0, "Z": 0.0}
    assert run.machine.clock.cycles == 57


def test_a_program_runs_to_its_end_in_pieces_of_any_size() -> None:
    cycles, end = undisturbed(CONTOUR)
    run = program_run(CONTOUR)
    run.start()
    done = 0
    for piece in (1, 3, 250, 17, 10_000):
        done += run.advance(piece)
    assert stands(run) == "COMPLETED"
    assert done == cycles
    assert run.machine.setpoints == end == {"X": -8.125, "Y": 17.75, "Z": 3.0}


def test_a_finished_program_starts_again_from_its_beginning() -> None:
    run = program_run(CONTOUR)
    run.start()
    to_the_end(run)
    run.start()
    run.advance(5)
    assert run.reading.block is not None
    assert run.reading.block.sequence == 10
    to_the_end(run)
    assert run.machine.setpoints == {"X": -8.125, "Y": 17.75, "Z": 3.0}


# --- what is executed


def test_the_executed_block_is_known_in_every_cycle() -> None:
    run = program_run(CONTOUR)
    run.start()
    seen: list[object] = []
    while run.active:
        run.advance(1)
        record = run.reading.block
        assert record is not None
        if not seen or seen[-1] != record.sequence:
            seen.append(record.sequence)
            assert record.text == CONTOUR.splitlines()[record.line - 1]
            assert CONTOUR.encode()[record.offset :].startswith(record.text.encode())
            assert record.program == "test.nc"
            assert record.stack == ()
    assert seen == [10, 20, 30, 40]


def test_modal_words_are_those_of_the_executed_block_not_of_the_prepared_one() -> None:
    run = program_run("G55 G0 X1 F300\nG91 G1 X40 F1450\nG18 G90 G41 D2 G1 X60\nG40 X70\nM30\n", FIVE)
    run.start()
    run.advance(3)
    assert run.reading.modal is not None
    assert run.reading.modal.g[Group.MOTION] == "G0"
    assert run.reading.modal.g[Group.PLANE] == "G17"
    assert run.reading.modal.g[Group.DISTANCE] == "G90"
    assert run.reading.modal.g[Group.WORK_OFFSET] == "G55"
    assert run.reading.modal.feed == 300.0
    assert run.reading.modal.zero[:3] == (100.0, 50.0, -20.0)
    run.advance(10_000, until=lambda: executed_line(run) == 2)
    assert run.reading.modal.g[Group.DISTANCE] == "G91"
    assert run.reading.modal.g[Group.MOTION] == "G1"
    assert run.reading.modal.feed == 1450.0
    assert run.reading.modal.d is None
    run.advance(10_000, until=lambda: executed_line(run) == 3)
    assert run.reading.modal.g[Group.PLANE] == "G18"
    assert run.reading.modal.g[Group.RADIUS_COMPENSATION] == "G41"
    assert run.reading.modal.d == 2


def test_plain_blocks_that_went_through_the_compiled_kernel_tell_their_modal_words() -> None:
    lines = [f"N{n} G1 X{n % 7} Y{n % 3} F{200 + n}" for n in range(1, 2100)]
    lines += ["G0 X3.5 Y1", "G91 X2.25", "G1 X-1", "F77", "X2", "G90 G3 X6.75 Y3 J1", "G1 X9"]
    text = "\n".join(lines) + "\n"
    run = program_run(text)
    run.start()
    expected = {
        2100: ("G0", "G90", 2299.0),
        2101: ("G0", "G91", 2299.0),
        2102: ("G1", "G91", 2299.0),
        2104: ("G1", "G91", 77.0),
        2105: ("G3", "G90", 77.0),
        2106: ("G1", "G90", 77.0),
    }
    found = {}
    while run.active:
        run.advance(7)
        record = run.reading.block
        assert record is not None
        if record.line in expected:
            found[record.line] = (
                record.modal.g[Group.MOTION],
                record.modal.g[Group.DISTANCE],
                record.modal.feed,
            )
        elif record.line == 2050:
            assert record.modal.feed == 2250.0
    assert run.error is None
    assert found == expected


def test_auxiliary_functions_show_their_own_block_while_the_path_rests_at_them() -> None:
    run = program_run("G0 X4\nM3 S800 T2\nM6\nG1 X9 F500\n", FIVE)
    seen: list[object] = []
    run.events.on_event = lambda event: seen.append(
        (event.word, event.line, run.reading.block and run.reading.block.text)
    )
    run.start()
    to_the_end(run)
    assert seen == [("M3 S800", 2, "M3 S800 T2"), ("M6 T2", 3, "M6")]


def test_distance_to_go_is_that_of_the_block() -> None:
    run = program_run("G1 X10 F600\nX30 Y5\n")
    run.start()
    run.advance(400)
    go = run.reading.distance_to_go
    assert go["X"] == 10.0 - run.reading.position["X"] > 0.0
    assert go["Y"] == 0.0
    run.advance(10_000, until=lambda: run.reading.position["X"] > 12.0)
    assert run.reading.distance_to_go == {
        "X": 30.0 - run.reading.position["X"],
        "Y": 5.0 - run.reading.position["Y"],
        "Z": 0.0,
    }
    to_the_end(run)
    assert run.reading.distance_to_go == {"X": 0.0, "Y": 0.0, "Z": 0.0}


# --- hold


def test_a_hold_in_a_sub_program_of_its_own_file_reads_exactly_that_cycle(tmp_path: Path) -> None:
    main = tmp_path / "main.nc"
    sub = tmp_path / "O0815.nc"
    main.write_text("N1 G0 X5 Y2\nN2 G55 F1200\n\nN3 M98 P815 L2\nN4 G54 G1 X0 Y0\nM30\n")
    sub.write_text(
        "O0815\n(profile)\nN110 G91 G1 X12.75\nN120 Y6.5 F800\nN130 X-4.25 Y-1.125\nN140 G90\nM99\n"
    )
    _, end = undisturbed(ProgramText.from_path(main), FIVE)
    run = program_run(ProgramText.from_path(main), FIVE)
    run.start()
    run.advance(
        100_000,
        until=lambda: [call.repeat for call in run.reading.stack] == [2] and executed_line(run) == 4,
    )
    run.advance(60)
    run.hold()
    assert stands(run) == "HOLD"
    run.advance(5_000, until=lambda: run.at_rest)
    record = run.reading.block
    assert record is not None
    assert (record.program, record.line, record.text, record.sequence) == (str(sub), 4, "N120 Y6.5 F800", 120)
    assert record.stack == (Call(str(main), 4, 2),) == run.reading.stack
    assert record.modal.g[Group.DISTANCE] == "G91"
    assert record.modal.g[Group.WORK_OFFSET] == "G55"
    assert record.modal.feed == 800.0
    # Behind two rounds less the last block of the second: from X5 Y2, absolute from there on.
    corner = (5.0 + 12.75 - 4.25 + 12.75, 2.0 + 6.5 - 1.125)
    assert run.reading.position["X"] == corner[0]
    assert corner[1] < run.reading.position["Y"] < corner[1] + 6.5
    assert run.reading.distance_to_go["Y"] == pytest.approx(corner[1] + 6.5 - run.reading.position["Y"])
    assert run.reading.distance_to_go["X"] == 0.0
    held = run.reading.position
    run.advance(300)
    assert run.reading.position == held
    run.switches.single_block = True
    stops = []
    while stands(run) != "COMPLETED":
        run.resume()
        to_the_end(run)
        assert run.reading.block is not None
        stops.append((run.reading.block.program == str(sub), run.reading.block.line))
    assert stops[:2] == [(True, 4), (True, 5)]
    assert stops[-2:] == [(False, 5), (False, 6)]
    assert run.machine.setpoints == end


@pytest.mark.parametrize("cycle", [1, 13, 120, 121, 260, 391])
def test_holding_at_any_cycle_changes_no_position_at_the_end(cycle: int) -> None:
    cycles, end = undisturbed(CONTOUR)
    run = program_run(CONTOUR)
    run.start()
    run.advance(cycle)
    run.hold()
    run.advance(700)
    assert run.at_rest
    assert stands(run) == "HOLD"
    run.resume()
    to_the_end(run)
    assert run.machine.setpoints == end
    assert run.machine.clock.cycles > cycles + 500


def test_nothing_to_resume_is_said() -> None:
    run = program_run(CONTOUR)
    with pytest.raises(UsageError, match="nothing to resume: the program is ready"):
        run.resume()


# --- program stops


def test_m0_stands_until_resumed_and_prepares_nothing_behind_it() -> None:
    run = program_run("G1 X10 F600\nM0\nX30\nM30\n")
    run.start()
    run.advance(100_000)
    assert stands(run) == "PROGRAM_STOP"
    assert run.reading.block is not None
    assert run.reading.block.text == "M0"
    assert run.machine.setpoints["X"] == 10.0
    assert run.channel.blocks == 2
    assert run.advance(1234) == 1234
    assert run.machine.setpoints["X"] == 10.0
    run.resume()
    to_the_end(run)
    assert stands(run) == "COMPLETED"
    assert run.machine.setpoints["X"] == 30.0


@pytest.mark.parametrize(("on", "stops"), [(True, 1), (False, 0)])
def test_m1_stands_with_the_optional_stop(on: bool, stops: int) -> None:
    run = program_run("G1 X10 F600\nM1\nX30\nM30\n")
    run.start()
    run.advance(20)
    run.switches.optional_stop = on  # looked at when the path comes there
    to_the_end(run)
    assert (stands(run) == "OPTIONAL_STOP") == bool(stops)
    if stops:
        run.resume()
        to_the_end(run)
    assert stands(run) == "COMPLETED"
    assert run.machine.setpoints["X"] == 30.0


def test_a_program_stop_takes_no_time_of_its_own() -> None:
    program = "G1 X10 F600\nM0\nX30\nM30\n"
    cycles, _ = undisturbed(program)
    run = program_run(program)
    run.start()
    done = to_the_end(run)
    run.resume()
    assert done + to_the_end(run) == cycles


# --- single block


def test_single_block_stops_at_the_end_of_every_block_on_its_end_point() -> None:
    run = program_run(CONTOUR, single_block=True)
    ends = []
    run.start()
    while stands(run) != "COMPLETED":
        to_the_end(run)
        assert run.reading.block is not None
        ends.append((run.reading.block.sequence, run.reading.position["X"], run.reading.position["Y"]))
        assert run.at_rest
        if stands(run) == "STOPPED_AT_BLOCK":
            run.resume()
    assert ends[:4] == [(10, 12.5, -7.25), (20, 31.0, 4.5), (30, 31.0, 17.75), (40, -8.125, 17.75)]


def test_single_block_switched_on_in_motion_stops_at_the_next_end_that_can_be_reached() -> None:
    # Blocks of 0.5 mm at 100 mm/s: braking takes 100 ** 2 / (2 * 5000) = 1 mm, and four times that with the part of
    # the acceleration that is left whatever corners come.
    program = "G1 F6000 X10\n" + "".join(f"X{10 + 0.5 * n:g}\n" for n in range(1, 61))
    run = program_run(program)
    run.start()
    run.advance(10_000, until=lambda: executed_line(run) == 9)
    at = run.reading.position["X"]
    run.switches.single_block = True
    to_the_end(run)
    assert stands(run) == "STOPPED_AT_BLOCK"
    stopped = run.reading.position["X"]
    assert stopped * 2.0 == math.floor(stopped * 2.0)
    assert at + 1.0 < stopped < at + 6.0
    run.switches.single_block = False
    run.resume()
    to_the_end(run)
    assert run.machine.setpoints["X"] == 40.0


# --- override and reset


def test_the_feed_override_scales_the_feed_and_leaves_rapids_alone() -> None:
    times = {}
    for factor in (0.5, 1.0, 2.0):
        run = program_run("G1 X50 F600\n")
        run.overrides.feed = factor
        run.start()
        times[factor] = to_the_end(run)
    # 50 mm at 5, 10 and 20 mm/s, and a ramp of v / a.
    assert times[0.5] == math.ceil((50 / 5 + 5 / 5000) / 0.001 - 1e-6)
    assert times[1.0] == math.ceil((50 / 10 + 10 / 5000) / 0.001 - 1e-6)
    assert times[2.0] == math.ceil((50 / 20 + 20 / 5000) / 0.001 - 1e-6)
    run = program_run("G0 X50\nG1 X60 F600\n")
    run.overrides.feed = 0.0
    run.start()
    run.advance(5000)
    assert run.machine.setpoints["X"] == 50.0
    assert run.active
    run.overrides.feed = 1.0
    to_the_end(run)
    assert run.machine.setpoints["X"] == 60.0


@pytest.mark.parametrize("factor", [-0.1, 2.01, math.nan])
def test_an_override_out_of_range_changes_nothing(factor: float) -> None:
    run = program_run(CONTOUR)
    run.overrides.feed = 0.7
    with pytest.raises(UsageError, match="the feed override"):
        run.overrides.feed = factor
    assert run.overrides.feed == 0.7


def test_a_reset_brakes_on_the_path_and_the_next_start_begins_anew() -> None:
    run = program_run("G1 X50 F6000\nM0\nX80\n")
    run.start()
    run.advance(100)
    speed = float(run.machine.state.velocity[0])
    at = run.reading.position["X"]
    run.reset()
    assert stands(run) == "RESET"
    braking = not run.at_rest
    assert braking
    with pytest.raises(UsageError, match="still braking"):
        run.start()
    run.advance(200)
    assert run.at_rest
    stopped = run.reading.position["X"]
    assert stopped == pytest.approx(at + speed**2 / (2 * 5000), abs=0.2)
    run.advance(200)
    assert run.machine.setpoints["X"] == stopped
    run.start()
    run.advance(100_000)
    assert stands(run) == "PROGRAM_STOP"
    assert run.machine.setpoints["X"] == 50.0


# --- preparation


def test_blocks_ahead_is_how_far_preparation_goes() -> None:
    run = program_run("".join(f"G1 X{n % 5 + 1} Y{n} F600\n" for n in range(1, 40)), blocks_ahead=3)
    run.start()
    deepest = 0
    while run.active:
        run.advance(1)
        assert run.reading.block is not None
        if run.active:
            deepest = max(deepest, run.channel.blocks - run.reading.block.line)
            assert run.channel.blocks - run.reading.block.line <= 4
    assert deepest >= 3
    assert run.machine.setpoints["Y"] == 39.0


def test_an_error_is_an_alarm_when_the_path_has_come_there() -> None:
    run = program_run("G1 X10 F600\nX20 G987\nX30\n")
    run.start()
    to_the_end(run)
    assert stands(run) == "ALARM"
    assert run.machine.setpoints["X"] == 10.0
    assert run.error is not None
    assert run.error.position is not None
    assert run.error.position.line == 2
    with pytest.raises(UsageError, match="alarm"):
        run.start()
    run.reset()
    assert stands(run) == "RESET"
