"""A laser: S, M3, M4 and M5 change its power at speed, and with M4 it follows the speed."""

from __future__ import annotations

import base64
import gzip
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from polycnc import runner
from polycnc.errors import ConfigurationError, ProgramError, UsageError
from polycnc.machine import MachineConfig
from polycnc.runner import view_program
from polycnc.runner.view import TrackCollector
from polycnc.servers.grbl import GrblCore, grbl_control
from support.grbl_sender import Bench
from support.programs import LINEAR, TIMES, machine_config, moves, refusal

LASER = machine_config(LINEAR, "[spindle]\nmax_rpm = 900\nlaser = true\n", name="laser")
DRY = machine_config(LINEAR, "[spindle]\nmax_rpm = 900\n", name="dry")
MERGING = LASER.model_copy(
    update={"path": LASER.path.model_copy(update={"path_tolerance_mm": 0.2, "merge_mm": 0.02})}
)


def _content(html: str) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Return what a page says, and its columns."""

    def unpacked(name: str) -> bytes:
        found = re.search(rf'<script type="text/plain" class="data" id="{name}">([^<]*)</script>', html)
        assert found is not None
        return gzip.decompress(base64.b64decode(found[1]))

    about, blob = json.loads(unpacked("about")), unpacked("data")
    places = about["columns"].items()
    return about, {name: np.frombuffer(blob, f"<{at['type']}", at["length"], at["at"]) for name, at in places}


def traced(program: str, config: MachineConfig = LASER) -> runner.Trace:
    return runner.run(program, config, "grbl", trace=True).trace


def power_of(trace: runner.Trace) -> np.ndarray:
    assert trace.power is not None
    return trace.power


def test_power_follows_the_speed_with_m4() -> None:
    # 5000 mm/s2 up to 6000 mm/min = 100 mm/s: 20 ms. After 5 ms 25 mm/s, a quarter of 720.
    trace = traced("M4 S720\nG1 X60 F6000\n")
    power = power_of(trace)
    assert power[4] == pytest.approx(180.0)
    assert power[300] == pytest.approx(720.0)
    assert power[-1] == pytest.approx(0.0)
    np.testing.assert_allclose(power, 720.0 * trace.feed_mm_s / 100.0)


def test_power_stays_with_m3_and_rests_at_rapid_and_behind_m5() -> None:
    trace = traced("M3 S300\nG1 X20 F3000\nG4 P0.05\nG0 X35\nG1 X40\nM5\nX50\n")
    power = power_of(trace)
    for block, expected in ((2, 300.0), (3, 300.0), (4, 0.0), (5, 300.0), (7, 0.0)):
        rows = power[(trace.block == block)]
        assert len(rows)
        assert set(rows.tolist()) == {expected}, block


def test_changes_pass_at_speed() -> None:
    lines = "".join(f"X{n} S{n * 7 % 500} {('M3', 'M4', '')[n % 3]}\n" for n in range(1, 40))
    trace = traced(f"M3 S50\nG1 F3000\n{lines}")
    middle = (trace.setpoint[:, 0] > 2.0) & (trace.setpoint[:, 0] < 38.0)
    np.testing.assert_allclose(trace.feed_mm_s[middle], 50.0)
    power = power_of(trace)
    for n in (5, 17, 30):
        inside = np.abs(trace.setpoint[:, 0] - (n - 0.5)) < 0.4
        assert set(np.round(power[inside], 9).tolist()) == {float(n * 7 % 500)}


def test_the_same_without_a_laser_stops_at_each_word() -> None:
    program = "M3 S50\nG1 F3000 X10\nX20 S60\n"
    assert moves(program, config=DRY) == ["M3 S50", "line X10 F3000 stop", "S60", "line X20 F3000"]
    assert moves(program, config=LASER) == ["line X10 F3000", "line X20 F3000"]


@pytest.mark.parametrize("config", [LASER, MERGING], ids=["exact", "merging"])
def test_power_in_each_block_costs_no_time(config: MachineConfig) -> None:
    """Merging aside: lines of two powers are two lines."""
    points = [(0.4 * n, 3.0 * np.sin(0.1 * n)) for n in range(1, 300)]
    plain = "".join(f"X{x:.3f} Y{y:.3f}\n" for x, y in points)
    words = "".join(f"X{x:.3f} Y{y:.3f} S{n * 13 % 900}\n" for n, (x, y) in enumerate(points))
    times = [runner.run(f"M4 S9\nG1 F2400\n{blocks}M5\n", config, "grbl").time_s for blocks in (plain, words)]
    assert times[1] == pytest.approx(times[0], rel=0.01)


def test_lines_of_two_powers_are_not_merged() -> None:
    program = "M3 S{}\nG1 F600 X4 Y5\nX8 Y10\nX12 Y15 S20\nX16 Y20\nM5\nX20 Y25\n"
    assert len(moves(program.format(20), config=MERGING, dialect="grbl")) == 2
    assert len(moves(program.format(10), config=MERGING, dialect="grbl")) == 3


def test_feed_in_inches_and_an_override_scale_the_power() -> None:
    program = "G20\nM4 S600\nG1 X2 F100\n"
    full = runner.run(program, LASER, "grbl", trace=True)
    half = runner.run(program, LASER, "grbl", trace=True, feed_override=0.5)
    assert full.trace.power is not None
    assert half.trace.power is not None
    assert full.trace.power.max() == pytest.approx(600.0)
    assert half.trace.power.max() == pytest.approx(300.0)
    more = runner.run(program, LASER, "grbl", trace=True, feed_override=2.0)
    assert more.trace.power is not None
    assert more.trace.power.max() == 900.0  # the most there is


@pytest.mark.parametrize("extension", ["csv", "npz"])
def test_trace_files_have_the_power(tmp_path: Path, extension: str) -> None:
    program, path = "M4 S720\nG1 X60 F6000\nX70 S350\n", tmp_path / f"trace.{extension}"
    with runner.TraceWriter(path, LASER, False) as writer:
        runner.run(program, LASER, "grbl", tagged_rows=writer.add_tagged)
    np.testing.assert_array_equal(power_of(runner.read_trace(path)), power_of(traced(program)))
    with pytest.raises(UsageError, match="power"), runner.TraceWriter(path, LASER, False) as writer:
        writer.add(np.zeros((1, 8)))


def test_other_machines_have_no_power(tmp_path: Path) -> None:
    path = tmp_path / "trace.csv"
    with runner.TraceWriter(path, DRY, False) as writer:
        runner.run("M3 S9\nG1 X3 F600\n", DRY, "grbl", tagged_rows=writer.add_tagged)
    assert "power" not in path.read_text().splitlines()[0]
    assert runner.read_trace(path).power is None


def test_power_that_would_follow_no_speed_is_refused() -> None:
    assert refusal("M4 S20\nG93 G1 X5 F2\n", config=LASER) == (
        "2:5: the power of the laser follows the feed (M4), and this feed is no speed"
    )
    moves("M3 S20\nG93 G1 X5 F2\n", config=LASER)


def test_constant_surface_speed_is_refused() -> None:
    assert refusal("G96 S20\n", config=LASER) == "1:1: G96 on a machine with a laser"


def test_a_laser_does_not_ramp() -> None:
    with pytest.raises(ConfigurationError, match="'acceleration_rpm_s' has no meaning for a laser"):
        machine_config(LINEAR, "[spindle]\nlaser = true\nacceleration_rpm_s = 5\n")


def test_nothing_is_queued_for_a_refused_power() -> None:
    with pytest.raises(ProgramError, match="negative"):
        runner.run("M3 S20\nG1 X5 F300 S-4\n", LASER, "grbl")


class LaserBench(Bench):
    """A sender at a machine with a laser, or without."""

    def __init__(self, *tables: str) -> None:
        self.control = grbl_control(machine_config(LINEAR, *tables))
        self.core = GrblCore(self.control)
        self.core.greet()

    def shown(self) -> list[float]:
        """Return feed and power of a status report."""
        report = self.send("?")[-1].partition("FS:")[2].partition("|")[0]
        return [float(each) for each in report.rstrip(">").split(",")]


def test_a_control_shows_the_power_as_it_is_now() -> None:
    bench = LaserBench("[spindle]\nmax_rpm = 900\nlaser = true\n", TIMES)
    bench.send("M4 S720\nG1 X60 F6000\nX90 S180\n")
    while not 0.0 < (begun := bench.shown())[0] < 6000.0:
        bench.passed(1)
    assert begun[1] == pytest.approx(720.0 * begun[0] / 6000.0, abs=1.0)
    for place, power in ((30.0, 720.0), (80.0, 180.0)):
        while bench.x() < place:
            bench.passed(3)
        assert bench.shown() == [6000.0, power]
    bench.passed(2000)
    assert bench.shown() == [0.0, 0.0]


def test_a_laser_of_a_control_is_off_at_rapid_and_behind_the_end() -> None:
    bench = LaserBench("[spindle]\nmax_rpm = 900\nlaser = true\n")
    bench.send("M3 S300\nG1 X20 F3000\nG0 X80\nG1 X90\nM2\n")
    seen = {}
    for _ in range(3000):
        bench.passed(1)
        seen[round(bench.x())] = bench.control.spindle.state().actual_rpm
    assert (seen[10], seen[50], seen[86]) == (300.0, 0.0, 300.0)
    assert bench.control.spindle.state().actual_rpm == 0.0


@pytest.mark.parametrize("words", ["M3 S310", "M4 S310"])
def test_a_laser_that_is_held_does_not_burn_where_it_stands(words: str) -> None:
    bench = LaserBench("[spindle]\nmax_rpm = 900\nlaser = true\n")
    bench.send(f"{words}\nG1 X80 F3000\n")
    while bench.x() < 23.0:
        bench.passed(1)
    bench.send("!")
    bench.passed(2000)
    assert bench.shown() == [0.0, 0.0]
    bench.send("~")
    bench.passed(400)
    assert 23.0 < bench.x() < 80.0
    assert bench.shown() == [3000.0, 310.0]


@pytest.mark.parametrize("laser", [True, False])
def test_a_control_has_the_laser_that_its_machine_file_has(laser: bool) -> None:
    bench = LaserBench(f"[spindle]\nlaser = {str(laser).lower()}\n")
    assert f"$32={int(laser)}" in bench.send("$$\n", 100)
    assert bench.send(f"$32={int(laser)}\n", 100)[-1] == "ok"
    assert bench.send(f"$32={int(not laser)}\n", 100)[-1] == "error:3"
    assert f"$32={int(laser)}" in bench.send("$$\n", 100)


def test_a_view_has_the_power_of_its_points() -> None:
    program = "M4 S720\nG1 X60 F6000\nX70 S350\nG0 X90\nX95\nM3 S20\nG1 X99\n"
    collector = TrackCollector(("mm", "mm", "mm"), laser=LASER)
    result = runner.run(program, LASER, "grbl", trace=True, tagged_rows=collector.add)
    track, power = collector.track(collector.execution()), power_of(result.trace)
    assert track.power is not None
    thinned = np.interp(result.trace.t_s, track.t_s, track.power)
    # a step between two cycles is drawn as a slope between the points beside it
    assert np.abs(thinned - power).max() <= 9.0 + np.abs(np.diff(power)).max()
    assert np.mean(np.abs(thinned - power) > 9.5) < 0.01
    about, columns = _content(runner.run(program, LASER, "grbl", trace=True).view().html)
    assert about["columns"]["power"]["length"] == len(columns["t_s"])
    np.testing.assert_allclose(columns["power"], track.power, rtol=1e-6)
    assert "power" in _content(view_program(program, LASER, "grbl").html)[1]
    assert "power" not in _content(view_program("G1 X5 F300\n", DRY, "grbl").html)[1]


@pytest.mark.parametrize("seed", [3, 8])
def test_each_cycle_of_a_long_program_has_the_power_that_its_line_says(seed: int) -> None:
    """Read again by hand, line by line, through blocks that are read one by one and blocks that are read together."""
    rng = np.random.default_rng(seed)
    lines, said = ["G21 G90 G1 F1200"], [(0.0, 0, 20.0, False)]
    power, direction, feed, rapid = 0.0, 0, 20.0, False
    for n in range(700):
        words = [f"X{n % 9 + rng.integers(1, 9) * 0.1:.1f} Y{n % 4}"]
        if rng.random() < 0.02:
            words = ["G4 P0.01"]  # moves nothing, and is read by itself
        elif rng.random() < 0.3:
            rapid = bool(rng.random() < 0.3)
            words.insert(0, f"G{int(not rapid)}")
        if rng.random() < 0.2:
            feed = float(rng.integers(5, 60))
            words.append(f"F{feed * 60.0:.0f}")
        if rng.random() < 0.6:
            power = float(rng.integers(0, 900))
            words.append(f"S{power:.0f}")
        if rng.random() < 0.2:
            direction = int(rng.choice((1, -1, 0)))
            words.append({1: "M3", -1: "M4", 0: "M5"}[direction])
        lines.append(" ".join(words))
        said.append((power, direction, feed, rapid))
    trace = traced("\n".join(lines) + "\n")
    speed, sense, feeds, rapids = (np.array(column) for column in zip(*said, strict=True))
    at = trace.block - 1
    assert len(set(at.tolist())) > 600
    follows = np.where(sense[at] > 0, 1.0, np.where(sense[at] < 0, trace.feed_mm_s / feeds[at], 0.0))
    waits = np.array([line.startswith("G4") for line in lines])[at]
    expected = np.where(rapids[at] & ~waits, 0.0, np.minimum(speed[at] * follows, 900.0))
    np.testing.assert_allclose(power_of(trace), expected, atol=1e-9)


def test_m67_is_a_power_that_stops_nothing_and_m68_one_at_rest() -> None:
    words = "M3 S200\nG1 X10 F3000\n{}X20\n{}X30\nM2\n"
    trace = runner.run(words.format("M67 E0 Q450\n", "M67 E0 Q700\n"), LASER, "linuxcnc", trace=True).trace
    plain = runner.run(words.format("", ""), LASER, "linuxcnc", trace=True).trace
    np.testing.assert_array_equal(trace.setpoint, plain.setpoint)
    places = [int(np.abs(trace.setpoint[:, 0] - x).argmin()) for x in (7.0, 13.0, 27.0)]
    assert power_of(trace)[places].tolist() == [200.0, 450.0, 700.0]
    at_rest = runner.run(words.format("M68 E0 Q450\n", ""), LASER, "linuxcnc", trace=True)
    assert [(each.line, each.word) for each in at_rest.events][:1] == [(3, "M68 E0 Q450")]
    assert len(at_rest.trace) == len(plain) + 10  # braking from 50 mm/s and on again, with 5000 mm/s2
    assert power_of(at_rest.trace)[int(np.abs(at_rest.trace.setpoint[:, 0] - 13.0).argmin())] == 450.0


def test_other_outputs_and_machines_keep_m67_as_a_function() -> None:
    program = "G1 X1 F300\nM67 E{} Q20\nX2\nM2\n"
    for config, output in ((LASER, 1), (DRY, 0)):
        listed = moves(program.format(output), config=config, dialect="linuxcnc")
        assert f"line X2 F300 stop with M67 E{output} Q20" in listed
    assert refusal("G1 X1 F300\nM67 E0\n", config=LASER, dialect="linuxcnc") == "2:1: M67 without Q"
