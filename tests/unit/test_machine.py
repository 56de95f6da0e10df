"""The machine as a whole: a configuration brought to life, stepped, stopped, and taken back in time."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from polycnc.errors import UsageError
from polycnc.machine import (
    Free,
    LinearAxis,
    LinearServo,
    Machine,
    MachineConfig,
    Reason,
    Step,
    load_machine,
)


def test_a_move_takes_its_closed_form_time_and_ends_on_the_target() -> None:
    machine = Machine(load_machine("mill3"))
    axis = machine.config.axes[0]
    machine.move("X", 100.0, speed=50.0)
    cycles = machine.advance(100_000, until=Reason.PROFILE_ENDED)
    ramp_s = 50.0 / axis.amax
    assert cycles == int(np.ceil((100.0 / 50.0 + ramp_s) / machine.config.cycle_s - 1e-6))
    assert machine.raised is Reason.PROFILE_ENDED
    assert machine.setpoints == {"X": 100.0, "Y": 0.0, "Z": 0.0}
    assert machine.actual == machine.setpoints
    assert machine.time_s == cycles * machine.config.cycle_s


def test_a_new_target_on_the_way_is_taken_without_a_step_of_the_velocity() -> None:
    machine = Machine(load_machine("mill3"), record_cycles=4000)
    amax = machine.config.axes[1].amax
    machine.move("Y", 200.0)
    Step(150).run(machine)
    machine.move("Y", -20.0)
    Step(2000).run(machine)
    recorder = machine.state.recorder
    positions = recorder.rows[: int(recorder.filled[0]), 4 + 1]
    acceleration = np.diff(positions, 2) / machine.config.cycle_s**2
    assert np.max(np.abs(acceleration)) <= amax * (1.0 + 1e-9)
    assert positions[-1] == -20.0


def test_the_servos_follow_as_they_are_described() -> None:
    """A lag-free drive at a speed v: kp is v over the following error, and kfcv 1 leaves none."""
    axes = (
        LinearAxis(name="X", vmax_mm_s=90, amax_mm_s2=900, servo=LinearServo(kind="pidf", kp=35.0)),
        LinearAxis(
            name="Y",
            vmax_mm_s=90,
            amax_mm_s2=900,
            servo=LinearServo(kind="pidf", kp=50.0, kfcv=0.4, following_error_limit_mm=0.8),
        ),
        LinearAxis(name="Z", vmax_mm_s=90, amax_mm_s2=900, servo=LinearServo(kind="pidf", kp=20.0, kfcv=1.0)),
    )
    machine = Machine(MachineConfig(name="three", axis=axes), servo=True)
    for name in "XYZ":
        machine.move(name, 500.0)
    Step(3000).run(machine)
    error = machine.state.setpoint - machine.state.servo.actual
    assert error == pytest.approx([90.0 / 35.0, 90.0 * (1.0 - 0.4) / 50.0, 0.0], rel=0.05, abs=0.02)
    assert machine.state.servo.error_tripped.tolist() == [0, 1, 0]


def test_the_same_steps_from_a_snapshot_are_the_same_to_the_last_bit() -> None:
    machine = Machine(load_machine("card6"), servo=True)
    for name, target in zip("XYZ", (12.3, -45.6, 7.8), strict=True):
        machine.move(name, target)
    Step(137).run(machine)
    saved = machine.snapshot()
    Step(300).run(machine)
    first = (machine.state.setpoint.copy(), machine.state.servo.actual.copy(), machine.clock.cycles)
    machine.restore(saved)
    assert machine.clock.cycles == 137
    Step(300).run(machine)
    assert np.array_equal(machine.state.setpoint, first[0])
    assert np.array_equal(machine.state.servo.actual, first[1])
    assert machine.clock.cycles == first[2]


def test_free_running_ends_with_its_condition() -> None:
    machine = Machine(load_machine("mill3"))
    machine.move("Z", -30.0)
    way = Free(lambda: machine.setpoints["Z"] <= -15.0, limit_cycles=100_000, look_every_cycles=1)
    way.run(machine)
    before = machine.setpoints["Z"]
    assert before <= -15.0
    assert before > -15.5
    assert machine.clock.now == datetime(2000, 1, 1, microsecond=round(machine.time_s * 1e6))


@pytest.mark.parametrize(
    ("axis", "target", "speed", "message"),
    [
        ("W", 1.0, None, "there is no axis 'W'"),
        ("X", 1.0, 0.0, "axis X cannot move like that"),
        ("X", float("nan"), None, "axis X cannot go to nan mm"),
    ],
)
def test_a_move_that_cannot_be_meant_is_refused_and_changes_nothing(
    axis: str, target: float, speed: float | None, message: str
) -> None:
    machine = Machine(load_machine("mill3"))
    with pytest.raises(UsageError, match=message):
        machine.move(axis, target, speed=speed)
    Step(100).run(machine)
    assert machine.setpoints == {"X": 0.0, "Y": 0.0, "Z": 0.0}


def test_a_limit_switch_edge_stops_the_run_in_its_cycle() -> None:
    machine = Machine(load_machine("card6"))
    machine.move("X", 600.0)
    machine.advance(100_000, until=Reason.SWITCH_EDGE)
    assert machine.raised & Reason.SWITCH_EDGE
    assert 500.0 <= machine.actual["X"] < 500.0 + machine.config.axes[0].vmax * machine.config.cycle_s
    assert machine.state.switches.switch[0, 1]["rising_position"] == 500.0


def test_memory_lasts_in_its_file(tmp_path: Path) -> None:
    file = tmp_path / "machine.db"
    machine = Machine(load_machine("mill3"), memory=file)
    machine.memory.area("parameters", of=float).put("lead", 0.25)
    machine.memory.close()
    again = Machine(load_machine("mill3"), memory=file)
    assert again.memory.area("parameters", of=float)["lead"] == 0.25
    again.memory.close()
