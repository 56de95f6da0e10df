"""Whatever is pressed while a path brakes for the end of a block, it stops there, within its limits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

from polycnc.cnc import Breakpoint, ProgramRun, RunState
from polycnc.machine import MachineConfig
from support.runs import program_run

THREE = "G1 X-6.2821 Y-12.9552 F60000\nG1 X-6.2388 Y-12.9415\nG1 X10 Y-25\n"
SHORT = "F6000\nG1 X-16.0648\nG1 X-14.4583\nX5\n"
JERK = {"jerk_mm_s3": 2e6}
ROUNDING = 1.0 + 1e-6
ALWAYS, LONG = range(4), range(4, 400)


def machine(cycle_s: float, acceleration: float, **path: Any) -> MachineConfig:
    axes = tuple({"name": name, "vmax_mm_s": 1000.0, "amax_mm_s2": acceleration} for name in "XY")
    data: dict[str, Any] = {"name": "pair", "cycle_s": cycle_s, "axis": axes, "path": path}
    return MachineConfig.model_validate(data)


SLOW = machine(0.002, 100.0)


class Stop(NamedTuple):
    cycle: int
    place: tuple[float, ...]


def _hold_and_start(run: ProgramRun) -> None:
    run.hold()
    run.resume()


def _off_and_on(run: ProgramRun) -> None:
    run.switches.single_block = False
    run.switches.single_block = True


def _breakpoint(run: ProgramRun) -> None:
    run.switches.breakpoints = {*run.switches.breakpoints, Breakpoint("elsewhere.nc", 77)}


def _override(run: ProgramRun) -> None:
    run.overrides.feed = 0.75
    run.overrides.feed = 1.0


def _optional_stop(run: ProgramRun) -> None:
    run.switches.optional_stop = not run.switches.optional_stop


ACTS: dict[str, Callable[[ProgramRun], None]] = {
    "hold and start": _hold_and_start,
    "single block off and on": _off_and_on,
    "a breakpoint elsewhere": _breakpoint,
    "override there and back": _override,
    "optional stop": _optional_stop,
}


def stops(
    text: str, config: MachineConfig, acts: dict[int, Callable[[ProgramRun], None]], *, override: float = 1.0
) -> tuple[list[Stop], float]:
    """Return where a program in single block stands, acts being done in their cycles, and its highest acceleration."""
    run = program_run(text, config, single_block=True)
    run.overrides.feed = override
    run.start()
    state = run.machine.state
    points, found = [state.setpoint.copy()], []
    while run.state is not RunState.COMPLETED and len(points) < 9000:
        if (act := acts.get(len(points))) is not None and run.active:
            act(run)
        if run.advance(1):
            points.append(state.setpoint.copy())
        if run.state is RunState.STOPPED_AT_BLOCK:
            found.append(Stop(len(points), tuple(state.setpoint.tolist())))
            run.start()
    assert run.state is RunState.COMPLETED, (len(points), found)
    speeds = np.diff(np.array(points), axis=0) / config.cycle_s
    return found, float(np.abs(np.diff(speeds, axis=0)).max()) / config.cycle_s


def _alike(found: list[Stop], wanted: list[Stop], most: int) -> bool:
    """Tell whether stops are the same; what is planned anew from within a cycle may end up to `most` cycles apart."""
    return [stop.place for stop in found] == [stop.place for stop in wanted] and all(
        abs(one.cycle - other.cycle) <= most for one, other in zip(found, wanted, strict=True)
    )


@pytest.mark.parametrize("act", ACTS)
def test_no_act_moves_a_planned_stop(act: str) -> None:
    wanted, _ = stops(THREE, SLOW, {})
    assert [stop.place[0] for stop in wanted] == pytest.approx([-6.2821, -6.2388], abs=1e-9)
    for cycle in (*range(3, wanted[0].cycle, 83), *range(wanted[0].cycle - 5, wanted[1].cycle + 3, 6)):
        found, acceleration = stops(THREE, SLOW, {cycle: ACTS[act]})
        assert _alike(found, wanted, 1), cycle
        assert acceleration <= 100.0 * ROUNDING, cycle


@pytest.mark.parametrize(
    "seeds", [ALWAYS, pytest.param(LONG, marks=[pytest.mark.long, pytest.mark.timeout(0)])]
)
def test_random_acts_on_random_programs_keep_stops_and_limits(seeds: range) -> None:
    for seed in seeds:
        rng = np.random.default_rng(seed)
        config = machine(0.004, float(rng.uniform(80.0, 900.0)))
        lines = [
            "G1 X{:.4f} Y{:.4f} F60000".format(*(rng.uniform(-9, 9, 2) * rng.choice((0.02, 1.0))))
            for _ in range(5)
        ]
        text = "\n".join(lines) + "\n"
        wanted, _ = stops(text, config, {})
        names = list(ACTS)
        acts = {
            int(rng.integers(1, wanted[-1].cycle)): ACTS[names[int(rng.integers(len(names)))]]
            for _ in range(9)
        }
        found, acceleration = stops(text, config, acts)
        assert _alike(found, wanted, len(acts)), seed
        assert acceleration <= config.axes[0].amax * ROUNDING, seed


@pytest.mark.parametrize(
    ("acceleration", "override"), [(500.0, 1.0), (500.0, 2.0), (5000.0, 1.5), (5000.0, 2.0)]
)
def test_a_short_block_ends_with_limited_jerk_too(acceleration: float, override: float) -> None:
    found, highest = stops(SHORT, machine(0.01, acceleration, **JERK), {}, override=override)
    assert [stop.place[0] for stop in found[-2:]] == pytest.approx([-16.0648, -14.4583], abs=1e-6)
    assert found[-1].cycle - found[-2].cycle <= 14
    assert highest <= acceleration * ROUNDING
