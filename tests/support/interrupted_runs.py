"""Runs that are held, overridden and stepped at random, and what is measured of their paths."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.cnc import ProgramRun
from polycnc.machine import MachineConfig
from support.programs import LINEAR, SPINDLE, TIMES, machine_config
from support.runs import program_run

Floats = npt.NDArray[np.float64]

CYCLE_S = 0.001
ROUNDING = 1.0 + 1e-6
MOST_COMMANDS = 60
SHARP = machine_config(LINEAR, SPINDLE, TIMES)
JERK = machine_config(LINEAR, SPINDLE, TIMES, "[path]\njerkrel = 0.4\n")
SOFT = machine_config(LINEAR, SPINDLE, TIMES, "[path]\njerk_mm_s3 = 60000\n")
SHORT = machine_config(LINEAR, SPINDLE, TIMES, "[path]\nlook_ahead_blocks = 7\n")
ROUND = machine_config(LINEAR, SPINDLE, TIMES, "[path]\npath_tolerance_mm = 0.03\n")


def random_program(rng: np.random.Generator) -> str:
    """Return a program of lines, arcs, rapids, functions and calls."""
    lines = ["G17 G90 G1 X3.5 Y-2.25 F1800"]
    for _ in range(int(rng.integers(12, 40))):
        x, y, z = (round(float(value), 3) for value in rng.uniform(-12.0, 12.0, 3))
        match int(rng.integers(0, 12)):
            case 0:
                lines.append(f"G0 X{x} Y{y} Z{z}")
            case 1:
                lines.append(f"G91 G{rng.choice((2, 3))} X{x / 4:.3f} Y{y / 4 + 4:.3f} R{20 + abs(z):.3f}")
                lines.append("G90 G1")
            case 2:
                lines.append(f"M{rng.choice((8, 9))}")
            case 3:
                lines.append("M98 P7 L2")
                lines.append("G90")
            case 4:
                lines += [f"G91 G1 X{(-1) ** n * 0.31:.3f} Y0.17" for n in range(8)]
                lines.append("G90")
            case 5:
                lines.append(f"G4 P{abs(x) / 100:.3f}")
            case _:
                lines.append(f"G1 X{x} Y{y} F{int(rng.integers(300, 9000))}")
    return "\n".join([*lines, "M30", "O7", "G91 G1 X1.25 Z0.5 F2100", "Y-0.75", "M99", ""])


def positions(run: ProgramRun, cycles: int) -> list[list[float]]:
    """Let a run go on cycle by cycle and return the setpoints and the path speed."""
    found = []
    for _ in range(cycles):
        if run.advance(1) == 0:
            break
        state = run.machine.state
        found.append([*state.setpoint.tolist(), float(state.paths.row[0]["speed"])])
    return found


def interrupted(
    program: str, config: MachineConfig, rng: np.random.Generator
) -> tuple[Floats, Floats, ProgramRun]:
    """Run a program with random commands and return every setpoint and path speed."""
    run = program_run(program, config, blocks_ahead=None if rng.integers(0, 2) else int(rng.integers(1, 9)))
    found: list[list[float]] = []
    run.start()
    for _ in range(MOST_COMMANDS):
        found += positions(run, int(rng.integers(1, 120)))
        match int(rng.integers(0, 7)):
            case 0:
                run.hold()
            case 1:
                run.overrides.feed = float(rng.choice((0.0, 0.13, 0.5, 1.0, 1.7, 2.0)))
            case 2:
                run.overrides.rapid = float(rng.choice((0.25, 0.5, 1.0)))
            case 3:
                run.switches.single_block = bool(rng.integers(0, 2))
            case 4 if run.state.value in ("hold", "stopped at block"):
                (run.step_into, run.step_over, run.step_out)[int(rng.integers(0, 3))]()
            case _ if run.state.value in ("hold", "stopped at block"):
                run.resume()
    run.overrides.feed = run.overrides.rapid = 1.0
    run.switches.single_block = False
    while run.state.value != "completed":
        if run.state.value != "active":
            run.resume()
        found += positions(run, 1000)
        assert len(found) < 200_000
    rows = np.array(found)
    return rows[:, :-1], rows[:, -1], run


def highest_jerk(speeds: Floats) -> float:
    """Return the greatest change of the path's acceleration, from rest to rest."""
    rates = np.diff(np.concatenate([np.zeros(2), speeds, np.zeros(2)])) / CYCLE_S
    return float(np.abs(np.diff(rates)).max()) / CYCLE_S


def overload(points: Floats, config: MachineConfig) -> float:
    """Return the highest part of an axis' limits that any cycle uses."""
    path = np.vstack([np.zeros((2, points.shape[1])), points, points[-1:]])
    speed = np.diff(path, axis=0) / CYCLE_S
    acceleration = np.diff(speed, axis=0) / CYCLE_S
    return max(
        float(np.max(np.abs(speed) / [axis.vmax for axis in config.axes])),
        float(np.max(np.abs(acceleration) / [axis.amax for axis in config.axes])),
    )


def farthest(points: Floats, path: Floats) -> float:
    """Return how far the farthest of `points` lies from the polyline `path`."""
    begin, along = path[:-1], np.diff(path, axis=0)
    square = np.maximum(np.einsum("ij,ij->i", along, along), 1e-30)
    worst = 0.0
    for point in points:
        part = np.clip(np.einsum("ij,ij->i", point - begin, along) / square, 0.0, 1.0)
        off = begin + part[:, None] * along - point
        worst = max(worst, math.sqrt(float(np.min(np.einsum("ij,ij->i", off, off)))))
    return worst


def fine_path(program: str, config: MachineConfig) -> Floats:
    """Return points of the path close together: the run at a twentieth of its feeds and rapids."""
    run = program_run(program, config, stands_at_stops=False)
    run.overrides.feed = run.overrides.rapid = 0.05
    run.start()
    found = [run.machine.state.setpoint.tolist()]
    while run.active:
        run.advance(4)
        found.append(run.machine.state.setpoint.tolist())
    return np.array(found)
