"""Probing moves: the cycle and place of the contact, what is left of the move, and no contact (Manual 003, 4.2)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from polycnc.cnc import ProgramRun
from polycnc.errors import ConfigurationError
from polycnc.machine import Machine, MachineConfig, load_machine
from polycnc.nc import ProgramText, load_dialect
from polycnc.runner import run

AXES = """name = "probe"
[[axis]]
name = "X"
vmax_mm_s = 500
amax_mm_s2 = 5000
[[axis]]
name = "Y"
vmax_mm_s = 500
amax_mm_s2 = 5000
[[axis]]
name = "Z"
vmax_mm_s = 333
amax_mm_s2 = 4000
"""
TABLE = "[[surface]]\nhigh = { Z = -12.345 }\n"
BLOCK = "[[surface]]\nlow = { X = 20.25, Y = -5 }\nhigh = { X = 30, Y = 5 }\n"
BORE = '[[surface]]\nkind = "bore"\nhigh = { Z = 0.5 }\ncenter = { X = 3, Y = -4 }\nradius_mm = 12.5\n'
BOSS = '[[surface]]\nkind = "boss"\nhigh = { Z = 0.5 }\ncenter = { X = 40, Y = 0 }\nradius_mm = 7.5\n'


def machine(tmp_path: Path, surfaces: str) -> MachineConfig:
    file = tmp_path / "probe.toml"
    file.write_text(AXES + surfaces)
    return load_machine(file)


def started(config: MachineConfig, text: str) -> ProgramRun:
    execution = ProgramRun(Machine(config), ProgramText.from_text(text), load_dialect("bosch"))
    execution.start()
    return execution


@pytest.mark.covers("cpl.nc.G75")
def test_the_axes_brake_from_the_cycle_of_the_contact_on_and_the_rest_is_dropped(tmp_path: Path) -> None:
    execution = started(machine(tmp_path, TABLE), "N1 G75 Z-40 F600\nN2 G0 Z3\n")
    z = 0.0
    depths = [0.0]
    speed = 0.0
    while execution.active and z <= depths[-1]:
        depths.append(z)
        if execution.channel.state.probe is not None and execution.channel.state.probe.position:
            speed = speed or (depths[-2] - depths[-1]) / 0.001
        execution.advance(1)
        z = execution.machine.setpoints["Z"]
    probe = execution.channel.state.probe
    assert probe is not None
    assert probe.position == pytest.approx((0, 0, -12.345), abs=1e-12)
    contact = next(place for place, depth in enumerate(depths) if depth <= -12.345)
    braked = depths[-1]
    assert speed == pytest.approx(10.0)
    assert -12.345 - 0.01 - 10.0**2 / (2 * 4000) - 0.01 < braked < -12.345  # one cycle, then braking
    assert len(depths) - contact <= 6
    while execution.active:
        execution.advance(50)
    assert execution.machine.setpoints["Z"] == 3
    assert execution.error is None


def test_closed_form_and_every_cycle_come_to_the_same(tmp_path: Path) -> None:
    config = machine(tmp_path, TABLE)
    text = "N1 G1 X5 F3000\nN2 G75 Z-40 F600\nN3 G91 G1 Z1\nN4 G90 X7\n"
    fast, slow = run(text, config, "bosch"), run(text, config, "bosch", trace=True)
    assert fast.end_position_mm == slow.end_position_mm
    assert fast.time_s == slow.time_s
    assert slow.trace is not None
    assert fast.extents_mm["Z"][0] == pytest.approx(slow.trace.setpoint[:, 2].min(), abs=1e-9)
    assert fast.extents_mm["Z"][0] > -12.4  # not the end that was programmed
    steps = np.diff(slow.trace.setpoint[:, 2], n=2) / 1e-6
    assert np.abs(steps).max() <= 4000 * 1.0001


def test_incremental_blocks_go_on_from_where_the_axes_stopped(tmp_path: Path) -> None:
    result = run("N2 G75 Z-40 F600\nN3 G91 G1 Z2.5 F600\n", machine(tmp_path, TABLE), "bosch")
    assert -12.345 + 2.5 - 0.05 < result.end_position_mm["Z"] < -12.345 + 2.5


@pytest.mark.parametrize(
    ("surface", "before", "words", "contact"),
    [
        (BLOCK, "G0 X0 Y1", "X40", (20.25, 1, 0)),
        (BLOCK, "G0 X50 Y-3", "X0", (30, -3, 0)),
        (BLOCK, "G0 X25 Y20", "Y-20", (25, 5, 0)),
        (BLOCK, "G0 X0 Y-15", "X40 Y-5.2", None),
        (BORE, "G0 X3 Y-4", "X30", (15.5, -4, 0)),
        (BORE, "G0 X3 Y-4", "X-30", (-9.5, -4, 0)),
        (BORE, "G0 X10.5 Y-4", "Y30", (10.5, 6, 0)),
        (BORE, "G0 X30 Y-4 Z5", "Z-3", (30, -4, 0.5)),
        (BORE, "G0 X3 Y-4 Z5", "Z-3", None),
        (BOSS, "G0 X20 Y4.5", "X60", (34, 4.5, 0)),
        (BOSS, "G0 X20 Y7.6", "X60", None),
        (BOSS, "G0 X40 Y0 Z9", "Z0", (40, 0, 0.5)),
    ],
)
def test_where_surfaces_are_met(
    tmp_path: Path, surface: str, before: str, words: str, contact: tuple[float, ...] | None
) -> None:
    execution = started(machine(tmp_path, surface), f"N1 {before}\nN2 G75 {words} F1200\n")
    while execution.active:
        execution.skip()
    probe = execution.channel.state.probe
    assert probe is not None
    assert (None if probe.position is None else pytest.approx(probe.position, abs=1e-9)) == contact
    end = [float(word[1:]) for word in words.split()]
    reached = [execution.machine.setpoints[word[0]] for word in words.split()]
    assert (reached == pytest.approx(end)) is (contact is None)


@pytest.mark.covers("cpl.nc.G275")
def test_measuring_in_passing_goes_on(tmp_path: Path) -> None:
    execution = started(machine(tmp_path, TABLE), "N1 G275 Z-40 F600\nN2 G1 X1\n")
    while execution.active:
        execution.skip()
    probe = execution.channel.state.probe
    assert probe is not None
    assert probe.position == pytest.approx((0, 0, -12.345), abs=1e-12)
    assert execution.machine.setpoints == {"X": 1, "Y": 0, "Z": -40}
    error = started(machine(tmp_path, TABLE), "N1 G275 X1 Z-40 F600\n")
    error.advance(5)
    assert error.error is not None
    assert error.error.what == "G275 needs one axis"


@pytest.mark.covers("cpl.nc.G375")
def test_a_fixed_stop_is_not_passed(tmp_path: Path) -> None:
    result = run("N1 G375 Z-40 F600\nN2 G91 G1 X1 Z1\n", machine(tmp_path, TABLE), "bosch", trace=True)
    assert result.trace is not None
    assert result.trace.setpoint[:, 2].min() == pytest.approx(-12.345, abs=1e-12)
    assert result.end_position_mm["Z"] == pytest.approx(-11.345)


def test_feed_hold_within_a_probing_move_loses_nothing(tmp_path: Path) -> None:
    execution = started(machine(tmp_path, TABLE), "N1 G75 Z-40 F600\nN2 G0 Z3\n")
    for _ in range(7):
        execution.advance(190)
        execution.hold()
        while not execution.at_rest:
            execution.advance(1)
        execution.advance(20)
        execution.resume()
    while execution.active:
        execution.advance(50)
    probe = execution.channel.state.probe
    assert probe is not None
    assert probe.position == pytest.approx((0, 0, -12.345), abs=1e-12)
    assert execution.machine.setpoints["Z"] == 3


def test_a_reset_within_a_probing_move_leaves_no_trace_of_it(tmp_path: Path) -> None:
    execution = started(machine(tmp_path, TABLE), "N1 G75 Z-40 F600\nN2 G0 Z3\n")
    execution.advance(1000)
    execution.reset()
    execution.advance(100)
    execution.selection.load(ProgramText.from_text("N1 G1 Z-40 F6000\n"))
    execution.start()
    execution.advance(5000)
    assert execution.machine.setpoints["Z"] == -40


def test_the_skip_move_of_other_controls_stops_too(tmp_path: Path) -> None:
    result = run("N1 G31 Z-40. F600.\nN2 G91 G1 Z2.\n", machine(tmp_path, TABLE), "fanuc")
    assert -10.4 < result.end_position_mm["Z"] < -10.345


@pytest.mark.parametrize(
    ("surface", "what"),
    [
        ("[[surface]]\nhigh = { W = 1 }\n", "there is no axis 'W'"),
        ("[[surface]]\nlow = { X = 5 }\nhigh = { X = 5 }\n", "ends before it begins in X"),
        ("[[surface]]\n", "everywhere"),
        ('[[surface]]\nkind = "bore"\nradius_mm = 4\n', "centre in two axes"),
        ("[[surface]]\nlow = { X = 1 }\ncenter = { X = 1, Y = 2 }\nradius_mm = 4\n", "centre in two axes"),
    ],
)
def test_wrong_surfaces_are_refused(tmp_path: Path, surface: str, what: str) -> None:
    with pytest.raises(ConfigurationError, match=what):
        machine(tmp_path, surface)


@pytest.mark.parametrize("code", ["75", "275", "375"])
def test_probing_needs_an_axis_a_feed_and_no_radius_compensation(tmp_path: Path, code: str) -> None:
    config = machine(tmp_path, TABLE)
    for text in (f"N1 G{code} F600\n", f"N1 G{code} Z-40\n", f"N1 G41 G1 X1 F60\nN2 G{code} X4\n"):
        assert run(text, config, "bosch", check=False).alarms
