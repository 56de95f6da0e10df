"""What a run returns: times, lengths, ends, alarms, and how errors come out of the library."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import polycnc
from polycnc.runner import time_text

# mill3 reaches 5000 mm/s² in X and Y and 4000 mm/s² in Z; a cycle is 1 ms.
PROGRAM = "G1 X20 F600\nG4 P0.5\nG0 Z5\nM8\n"


def test_times_lengths_and_ends_by_hand() -> None:
    result = polycnc.run(PROGRAM)
    # 20 mm at 10 mm/s, plus half a ramp at each end: v / a = 2 ms in all.
    assert result.cutting_time_s == pytest.approx(2.002, abs=1e-12)
    assert result.waiting_time_s == pytest.approx(0.5, abs=1e-12)
    # 5 mm up and down the speed of a triangle: 2 sqrt(5 / 4000) s = 70.7 ms, at rest in the 71st cycle.
    assert result.rapid_time_s == pytest.approx(2.0 * np.sqrt(5.0 / 4000.0), abs=1e-3)
    assert result.cycles == 2002 + 500 + 71
    assert result.time_s == pytest.approx(2.573, abs=1e-12)
    assert (result.cutting_path_mm, result.rapid_path_mm, result.path_mm) == (20.0, 5.0, 25.0)
    assert result.top_feed_mm_min == pytest.approx(600.0)
    assert result.end_position_mm == {"X": 20.0, "Y": 0.0, "Z": 5.0}
    assert result.extents_mm == {"X": (0.0, 20.0), "Y": (0.0, 0.0), "Z": (0.0, 5.0)}
    assert result.axis_units == {"X": "mm", "Y": "mm", "Z": "mm"}
    assert result.blocks == 4
    assert [(event.word, event.line, event.time_s) for event in result.events] == [("M8", 4, 2.573)]


def test_the_same_with_and_without_cycles() -> None:
    counted = polycnc.run(PROGRAM)
    stepped = polycnc.run(PROGRAM, trace=True)
    assert counted.as_dict() == stepped.as_dict()
    assert counted.trace is None
    assert stepped.trace is not None
    assert len(stepped.trace) == counted.cycles


def test_trace_arrays() -> None:
    result = polycnc.run(PROGRAM, trace=True, servo=True, machine="card6")
    trace = result.trace
    assert trace is not None
    assert trace.axes == ("X", "Y", "Z", "U", "V", "W")
    assert trace.t_s[0] == 0.001
    assert trace.t_s[-1] == result.time_s
    assert trace.setpoint[-1].tolist() == list(result.end_position_mm.values())
    assert trace.actual is not None
    assert trace.actual.shape == trace.setpoint.shape == (result.cycles, 6)
    assert sorted(set(trace.block.tolist())) == [1, 2, 3]
    assert trace.rapid.tolist() == (trace.block >= 3).tolist()
    assert np.diff(trace.t_s) == pytest.approx(0.001)


def test_rotary_axes_alone_take_time_but_make_no_path() -> None:
    result = polycnc.run("G0 C90\nG1 A-10 F300\nG1 X6 A-20\n", machine="mill5")
    assert result.path_mm == result.cutting_path_mm == pytest.approx(6.0)
    assert result.rapid_path_mm == 0.0
    assert result.rapid_time_s > 0.0
    assert result.axis_units["C"] == "deg"
    # 10 degrees at 300 degrees a minute; then 6 mm at 300 mm a minute. Feed is that of the path in mm.
    assert result.cutting_time_s == pytest.approx(2.0 + 1.2, abs=0.05)
    assert result.top_feed_mm_min == pytest.approx(300.0)


def test_rows_come_in_pieces_that_make_the_trace() -> None:
    pieces: list[np.ndarray] = []
    done: list[float] = []
    result = polycnc.run(
        "G1 X100 F200\n", trace=True, rows=lambda rows: pieces.append(rows.copy()), progress=done.append
    )
    assert result.trace is not None
    assert len(pieces) > 1
    assert np.array_equal(np.concatenate(pieces)[:, 4:], result.trace.setpoint)
    assert done == [1.0] * len(pieces)


def test_progress_goes_by_lines() -> None:
    done: list[float] = []
    polycnc.run("".join(f"G1 X{i} F60\n" for i in range(1, 101)), trace=True, progress=done.append)
    assert done == sorted(done)
    assert 0.0 < done[0] < 0.3
    assert done[-1] == 1.0
    assert len(done) > 5


def test_progress_without_cycles() -> None:
    done: list[float] = []
    polycnc.run(PROGRAM, progress=done.append)
    assert done[-1] == 1.0


def test_program_error_raises_with_the_result_so_far() -> None:
    with pytest.raises(polycnc.ProgramError) as caught:
        polycnc.run("G1 X10 F600\nG1 X20 Q\n")
    result = caught.value.result
    assert isinstance(result, polycnc.RunResult)
    assert result.end_position_mm["X"] == 10.0
    (alarm,) = result.alarms
    assert (alarm.kind, alarm.line, alarm.column, alarm.text) == ("program", 2, 8, "'Q' has no number")
    assert alarm.time_s == result.time_s > 1.0
    assert str(alarm) == str(caught.value)
    assert "\n           ^\n" in str(alarm)


def test_of_a_long_line_the_part_around_the_error_is_shown() -> None:
    blocks = "G1 X1 F500" + " " * 300 + "Q" + " " * 300
    error = polycnc.check(f"{blocks}\n")[0]
    _, line, caret, _ = str(error).splitlines()
    assert len(line) == 4 + 100
    assert line[caret.index("^")] == "Q"


def test_program_error_without_raising() -> None:
    result = polycnc.run("G1 X10 F600\nG1 X20 Q\n", check=False)
    assert not result.ok
    assert str(result).endswith(", until line 2: 'Q' has no number")
    with pytest.raises(polycnc.ProgramError):
        result.raise_for_alarms()


def test_machine_alarm() -> None:
    machine = polycnc.load_machine("card6")
    x = machine.axes[0]
    weak = x.model_copy(update={"servo": x.servo.model_copy(update={"following_error_limit_mm": 0.01})})
    machine = machine.model_copy(update={"axes": (weak, *machine.axes[1:])})
    with pytest.raises(polycnc.AlarmError) as caught:
        polycnc.run("G0 X100\n", machine, servo=True)
    result = caught.value.result
    assert isinstance(result, polycnc.RunResult)
    (alarm,) = result.alarms
    assert (alarm.kind, alarm.code) == ("machine", "following_error")
    assert alarm.text.startswith("axis X: following error 0.01")
    assert 0.0 < alarm.time_s == result.time_s < 0.1
    assert f"at {alarm.time_s:.3f} s" in str(alarm)


def test_result_is_json() -> None:
    result = polycnc.run("G1 X10 F600\nG1 X20 Q\n", check=False)
    back = json.loads(json.dumps(result.as_dict()))
    assert back["alarms"][0]["hint"] == "Write the number right after the letter, like Q10."
    assert "trace" not in back


def test_representation_is_short() -> None:
    result = polycnc.run("G1 X100 F200\n", trace=True)
    assert len(repr(result)) < 1000
    assert str(result) == "<text> on mill3: 30.001 s, 1 block, to its end"


def test_a_program_that_is_neither_file_nor_text() -> None:
    with pytest.raises(polycnc.UsageError, match="no such file: G1 X10 F100") as caught:
        polycnc.run("G1 X10 F100")
    assert "newline" in caught.value.hint


def test_check_returns_every_error(tmp_path: Path) -> None:
    program = tmp_path / "part.nc"
    program.write_text("G1 X10\nG777\n")
    errors = polycnc.check(program)
    assert [error.position.line for error in errors if error.position] == [1, 2]
    assert polycnc.check("G1 X10 F100\n") == []


def test_skip_levels() -> None:
    text = "G1 X10 F600\n/2 G1 X20\n"
    assert polycnc.run(text).end_position_mm["X"] == 20.0
    assert polycnc.run(text, skip_levels=[1]).end_position_mm["X"] == 20.0
    assert polycnc.run(text, skip_levels=[2]).end_position_mm["X"] == 10.0


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0.000 s"),
        (0.25, "0.250 s"),
        (59.9994, "59.999 s"),
        (59.9996, "1:00.000 min"),
        (62.5, "1:02.500 min"),
        (3599.9999, "1:00:00.000 h"),
        (7384.5, "2:03:04.500 h"),
    ],
)
def test_time_text(seconds: float, text: str) -> None:
    assert time_text(seconds) == text


def test_program_stops_are_passed_and_told() -> None:
    result = polycnc.run("G1 X5 F600\nM0\nX7\nM1\nX9\nM0\n")
    assert result.end_position_mm["X"] == 9.0
    assert [(message.text, message.line, message.count) for message in result.messages] == [
        ("M0: program stop, passed without stopping", 2, 2),
        ("M1: optional stop, passed without stopping", 4, 1),
    ]
    assert [event.word for event in result.events] == ["M0", "M1", "M0"]


@pytest.mark.parametrize("trace", [False, True])
def test_a_run_may_end_at_the_first_m0(trace: bool) -> None:
    result = polycnc.run("G1 X5 F600\nM1\nX7\nM0\nX9\n", stop_at_m0=True, trace=trace)
    assert result.ok
    assert result.end_position_mm["X"] == 7.0
    assert [message.text for message in result.messages] == [
        "M1: optional stop, passed without stopping",
        "M0: program stop, the run stops here",
    ]


def test_time_per_tool_is_in_the_result_and_in_its_json() -> None:
    result = polycnc.run("G1 X5 F600\nT3 M6\nX25 F1200\nG0 X0\n")
    assert list(result.tool_times) == [0, 3]
    assert sum(time.cutting_s for time in result.tool_times.values()) == pytest.approx(result.cutting_time_s)
    assert result.tool_times[3].rapid_s == pytest.approx(result.rapid_time_s)
    assert json.loads(json.dumps(result.as_dict()))["tool_times"]["3"]["rapid_time_s"] == pytest.approx(
        result.rapid_time_s
    )


def test_a_trace_in_a_notebook_has_the_ends_of_each_axis() -> None:
    trace = polycnc.run("G0 X12.5 Y3 Z2\nG1 X-4.25 Y7.75 F6000\nM30\n", trace=True).trace
    assert trace is not None
    shown = trace._repr_html_()
    for number in ("12.5", "-4.25", "7.75"):
        assert number in shown
