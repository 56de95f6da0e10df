"""Whatever is pressed in any cycle: threads, skips, dwells and feeds by revolution keep limits, stops and ends."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

from polycnc.cnc import Breakpoint, Control, RunState
from polycnc.machine import MachineConfig
from polycnc.nc import load_dialect
from polycnc.nc.macro import MacroLanguage

ALWAYS, LONG = range(3), range(3, 3003)
ROUNDING = 1.0 + 1e-6
MOST = 12_000
CYCLE_S = 0.004
SURFACE = {"low": {"X": 22.0}, "high": {"X": 90.0}}

Act = Callable[[Control, np.random.Generator], None]


class Seen(NamedTuple):
    """Where a program stood, the highest share of an acceleration, and the steps along Z while it cut threads."""

    stops: list[tuple[int, tuple[float, ...]]]
    holds: set[tuple[int, tuple[float, ...]]]
    acceleration: float
    threads: list[float]
    state: RunState


def machine(rng: np.random.Generator) -> MachineConfig:
    path: dict[str, Any] = {"path_tolerance_mm": float(rng.choice((0.0, 0.05)))}
    if rng.random() < 0.3:
        path["jerk_mm_s3"] = float(10.0 ** rng.uniform(4.3, 6.5))
    axes = tuple(
        {"name": name, "vmax_mm_s": 300.0, "amax_mm_s2": float(rng.uniform(300.0, 3000.0))} for name in "XYZ"
    )
    times = {"auxiliary_s": 0.02}
    data: dict[str, Any] = {"name": "taps", "cycle_s": CYCLE_S, "axis": axes, "path": path, "times": times}
    data |= {"spindle": {"max_rpm": 6000.0}, "surface": (SURFACE,)}
    return MachineConfig.model_validate(data)


def program(rng: np.random.Generator) -> str:
    """Return a program whose blocks end where they say, but for its skips."""
    u = rng.uniform
    lines = ["G90 G21 G0 X0 Y0 Z2", "M3 S900"]
    for _ in range(4):
        lines += [
            [f"G1 X{u(-4, 12):.3f} Y{u(-9, 9):.3f} F{u(900, 9000):.0f}"],
            [f"G84 X{u(0, 9):.2f} Z{u(-5, -2):.2f} R-1. F{u(900, 1500):.0f}", "G80"],
            [f"M29 S{u(500, 900):.0f}", f"G84 Z{u(-5, -3):.2f} R-1. F1200", "G80", "M3 S900"],
            [f"G31 X{u(25, 40):.2f} F{u(900, 5000):.0f}", "G0 X9."],
            ["G95", f"G1 X{u(-4, 12):.2f} Z{u(-4, 2):.2f} F{u(0.5, 3.0):.2f}", "G94 F1500"],
            [f"G4 P{u(5, 60):.0f}"],
            [f"G2 X{u(4, 9):.3f} Y{u(1, 9):.3f} R40. F{u(900, 6000):.0f}"],
            ["G91 G1 F3000", *[f"X{u(0.01, 0.4):.3f} Y{u(-0.2, 0.2):.3f}" for _ in range(6)], "G90"],
        ][int(rng.integers(8))]
    return "\n".join([*lines, "M30", ""])


def cut_threads(rng: np.random.Generator) -> str:
    """Return a program of LinuxCNC that cuts threads with a die, on a cone and as a tap, and moves between them."""
    u = rng.uniform
    lines = ["G90 G21 G0 X0 Y0 Z2", "M3 S600", "G64 P0.01", "F3000"]
    for _ in range(4):
        lines += [
            [f"G33 Z{u(-6, -2):.3f} K{u(0.5, 2.0):.2f}", "G0 X1", "Z2"],
            [f"G33 X{u(0, 3):.3f} Z{u(-6, -2):.3f} K{u(0.5, 2.0):.2f}", "G0 Z2"],
            [f"G33.1 Z{u(-6, -2):.3f} K{u(0.5, 1.5):.2f}"],
            [f"G1 X{u(-4, 12):.3f} Y{u(-9, 9):.3f} F{u(900, 9000):.0f}"],
            [f"G4 P{u(0.005, 0.06):.3f}"],
        ][int(rng.integers(5))]
    return "\n".join([*lines, "M30", ""])


PROGRAMS = {"fanuc": program, "linuxcnc": cut_threads}


def run(
    text: str,
    config: MachineConfig,
    acts: dict[int, Act],
    *,
    name: str,
    seed: int,
    ahead: int | None,
) -> Seen:
    """Execute a program in single block, or without, acts being done in their cycles."""
    rng = np.random.default_rng(seed)
    dialect = load_dialect(name).model_copy(update={"blocks_ahead": ahead})
    control = Control(config, dialect=dialect, languages=[MacroLanguage()] if name == "fanuc" else ())
    control.programs.create("P", text)
    control.select_program("P")
    for axis in config.axis_names:
        control.manual.referenced[axis] = True
    control.set_switches(single_block=seed % 4 > 0)
    control.cycle_start()
    channel, state, stops = control.channels[0], control.machine.state, list[tuple[int, tuple[float, ...]]]()
    points, threads, holds = [state.setpoint.copy()], [], set()
    while channel.run_state is not RunState.COMPLETED and len(points) < MOST:
        if (act := acts.get(len(points))) is not None:
            act(control, rng)
        if control.advance(1):
            points.append(state.setpoint.copy())
        run = channel.run
        if run is not None and run.feed.cuts_thread:
            threads.append(float(points[-1][2] - points[-2][2]))
        executed = channel.executed
        here = 0 if executed is None else executed.line, tuple(state.setpoint.tolist())
        if channel.run_state is RunState.STOPPED_AT_BLOCK:
            stops.append(here)
            control.cycle_start()
        elif channel.run_state is RunState.HOLD and channel.at_rest:
            holds.add(here)
            control.cycle_start()
        assert channel.run_state is not RunState.ALARM, control.alarms.active
    found = np.diff(np.array(points), n=2, axis=0) / CYCLE_S**2
    shares = np.abs(found).max(axis=0) / [axis.amax for axis in config.axes]
    return Seen(stops, holds, float(shares.max()), threads, channel.run_state)


def _hold(control: Control, _: np.random.Generator) -> None:
    if control.channels[0].active:
        control.feed_hold()


def _off_and_on(control: Control, _: np.random.Generator) -> None:
    on = control.channels[0].run is not None and control.switches.single_block
    control.set_switches(single_block=not on)
    control.set_switches(single_block=on)


ACTS: tuple[Act, ...] = (
    _hold,
    _off_and_on,
    lambda control, _: control.channels[0].set_breakpoints(frozenset({Breakpoint("elsewhere", 77)})),
    lambda control, rng: control.set_overrides(feed=float(rng.choice((0.0, 0.3, 0.8, 1.0, 1.7)))),
    lambda control, rng: control.set_overrides(rapid=float(rng.choice((0.25, 0.5, 1.0)))),
    lambda control, _: control.set_overrides(feed=1.0),
    lambda control, _: control.restore(control.snapshot()),
)


@pytest.mark.parametrize(
    "seeds", [ALWAYS, pytest.param(LONG, marks=[pytest.mark.long, pytest.mark.timeout(0)])]
)
@pytest.mark.parametrize("name", PROGRAMS)
def test_no_act_in_any_cycle_spoils_a_thread_a_stop_or_an_end(name: str, seeds: range) -> None:
    for seed in seeds:
        rng = np.random.default_rng(seed)
        config, text = machine(rng), PROGRAMS[name](rng)
        ahead = [None, None, 0, 1, 2][int(rng.integers(5))] if name == "fanuc" else None
        skips = {n for n, line in enumerate(text.split("\n"), 1) if line.startswith("G31")}
        wanted = run(text, config, {}, name=name, seed=seed, ahead=ahead)
        assert wanted.state is RunState.COMPLETED, seed
        acts = {
            int(rng.integers(1, 900)): ACTS[int(rng.integers(len(ACTS)))]
            for _ in range(int(rng.integers(1, 60)))
        }
        acts[max(acts) + 1] = ACTS[5]
        found = run(text, config, acts, name=name, seed=seed, ahead=ahead)
        assert found.state is RunState.COMPLETED, seed
        assert found.acceleration <= ROUNDING, seed
        begun = text.count("G84") + text.count("G33")  # each within a cycle
        assert abs(len(found.threads) - len(wanted.threads)) <= 4 * begun, seed
        assert min(found.threads, default=0.0) == pytest.approx(min(wanted.threads, default=0.0), abs=1e-9), (
            seed
        )
        if name == "fanuc":  # where all of them come back as they went
            assert max(found.threads, default=0.0) == pytest.approx(
                max(wanted.threads, default=0.0), abs=1e-9
            ), seed
        if seed % 4:
            due = [each for each in wanted.stops if each[0] not in skips]
            stood = [each for each in found.stops if each[0] not in skips]
            assert stood == [each for each in due if each in stood], seed  # in their order
            assert {*due} <= {*stood} | found.holds, seed  # a hold where a block ends stops there as well
