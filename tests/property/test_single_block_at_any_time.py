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
ALWAYS, LONG = range(4), range(4, 10_004)


def machine(cycle_s: float, acceleration: float, **path: Any) -> MachineConfig:
    axes = tuple({"name": name, "vmax_mm_s": 1000.0, "amax_mm_s2": acceleration} for name in "XYZ")
    data: dict[str, Any] = {"name": "pair", "cycle_s": cycle_s, "axis": axes, "path": path}
    return MachineConfig.model_validate(data)


SLOW = machine(0.002, 100.0)


Act = Callable[[ProgramRun], None]


class Stop(NamedTuple):
    cycle: int
    place: tuple[float, ...]


def _hold_and_start(run: ProgramRun) -> None:
    run.hold()
    run.resume()


def _off_and_on(run: ProgramRun) -> None:
    on = run.switches.single_block
    run.switches.single_block = not on
    run.switches.single_block = on


def _breakpoint(run: ProgramRun) -> None:
    run.switches.breakpoints = {*run.switches.breakpoints, Breakpoint("elsewhere.nc", 77)}


def _override(run: ProgramRun) -> None:
    before = run.overrides.feed
    run.overrides.feed = 0.75 * before
    run.overrides.feed = before


def _optional_stop(run: ProgramRun) -> None:
    run.switches.optional_stop = not run.switches.optional_stop


ACTS: dict[str, Act] = {
    "hold and start": _hold_and_start,
    "single block off and on": _off_and_on,
    "a breakpoint elsewhere": _breakpoint,
    "override there and back": _override,
    "optional stop": _optional_stop,
}


def _another_override(rng: np.random.Generator) -> Act:
    """Return an act that leaves another override."""

    def act(run: ProgramRun) -> None:
        run.overrides.feed = float(rng.uniform(0.3, 2.0))

    return act


def _random_acts(rng: np.random.Generator, acts: list[Act], behind: int) -> dict[int, Act]:
    """Return nine acts, each with its cycle."""
    return {int(rng.integers(1, behind)): acts[int(rng.integers(len(acts)))] for _ in range(9)}


def stops(
    text: str,
    config: MachineConfig,
    acts: dict[int, Act],
    *,
    override: float = 1.0,
    lines: frozenset[int] | None = None,
) -> tuple[list[Stop], float]:
    """Return where a program in single block stands, acts being done in their cycles, and its highest acceleration."""
    run = program_run(text, config, single_block=lines is None)
    run.switches.breakpoints = frozenset(Breakpoint("test.nc", line) for line in lines or ())
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


def _places(found: list[Stop]) -> list[tuple[float, ...]]:
    return [stop.place for stop in found]


def _alike(found: list[Stop], wanted: list[Stop], most: int) -> bool:
    """Tell whether stops are the same; what is planned anew from within a cycle may end up to `most` cycles apart."""
    return _places(found) == _places(wanted) and all(
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


@pytest.mark.parametrize("override", [1.0, 2.0])
def test_an_override_that_falls_and_rises_again_costs_no_time(override: float) -> None:
    config = machine(0.01, 389.0)
    text = "G91\nG1 X-8 F600\nX-1\n"
    wanted, _ = stops(text, config, {}, override=override)
    for cycle in range(1, wanted[-1].cycle, 2):
        found, acceleration = stops(text, config, {cycle: _override}, override=override)
        assert found == wanted, cycle
        assert acceleration <= 389.0 * ROUNDING, cycle


def _line(rng: np.random.Generator, size: float) -> str:
    return "G1 X{:.4f} Y{:.4f} Z{:.4f} F60000".format(*(rng.uniform(-9, 9, 3) * size))


def _arc(rng: np.random.Generator, size: float) -> str:
    """Return a part of a circle to a random place, or a whole circle, at times with a way along the third axis."""
    helix = f" Z{rng.uniform(-5, 5) * size:.4f}" if rng.random() < 0.5 else ""
    code = rng.choice(("G2", "G3"))
    i, j = rng.uniform(0.5, 9, 2) * size
    radius = rng.choice((-1, 1)) * rng.uniform(0.6, 3) * np.hypot(i, j)
    if rng.random() < 0.3:
        return f"{code} I{i:.4f} J{-j:.4f}{helix} F{rng.choice((3000, 60000))}"
    return f"G91 {code} X{i:.4f} Y{j:.4f} R{radius:.4f}{helix} F60000\nG90"


def _program(rng: np.random.Generator) -> str:
    """Return lines, arcs and helices of every length."""
    makers = [_line] if rng.random() < 0.3 else [_line, _arc]
    return "\n".join(
        makers[int(rng.integers(len(makers)))](rng, float(rng.choice((0.02, 0.3, 1.0)))) for _ in range(5)
    )


@pytest.mark.parametrize(
    "seeds", [ALWAYS, pytest.param(LONG, marks=[pytest.mark.long, pytest.mark.timeout(0)])]
)
def test_random_acts_on_random_programs_keep_stops_and_limits(seeds: range) -> None:
    """Lines, arcs, helices and rounded corners, in single block or with breakpoints, at every override."""
    for seed in seeds:
        rng = np.random.default_rng(seed)
        path = {"path_tolerance_mm": float(rng.choice((0.0, 0.05, 0.7)))}
        if rng.random() < 0.25:
            path["jerk_mm_s3"] = float(10.0 ** rng.uniform(4.0, 6.5))
        config = machine(float(rng.choice((0.002, 0.004, 0.01))), float(rng.uniform(80.0, 900.0)), **path)
        text = f"G0 X0 Y0\n{_program(rng)}\n"
        override = float(rng.choice((0.5, 1.0, rng.uniform(0.5, 2.0), 2.0)))
        lines = frozenset(rng.integers(2, 9, 3).tolist()) if rng.random() < 0.5 else None
        wanted, limit = stops(text, config, {}, override=override, lines=lines)
        assert limit <= config.axes[0].amax * ROUNDING, seed
        if not wanted:
            continue
        acts = _random_acts(rng, list(ACTS.values()), wanted[-1].cycle)
        found, acceleration = stops(text, config, acts, override=override, lines=lines)
        assert _alike(found, wanted, len(acts)), seed
        assert acceleration <= config.axes[0].amax * ROUNDING, seed
        acts = _random_acts(rng, [*ACTS.values(), _another_override(rng)], wanted[-1].cycle)
        found, acceleration = stops(text, config, acts, override=override, lines=lines)
        assert _places(found) == _places(wanted), seed
        assert acceleration <= config.axes[0].amax * ROUNDING, seed


@pytest.mark.parametrize(
    ("acceleration", "override"), [(500.0, 1.0), (500.0, 2.0), (5000.0, 1.5), (5000.0, 2.0)]
)
def test_a_short_block_ends_with_limited_jerk_too(acceleration: float, override: float) -> None:
    found, highest = stops(SHORT, machine(0.01, acceleration, **JERK), {}, override=override)
    assert [stop.place[0] for stop in found[-2:]] == pytest.approx([-16.0648, -14.4583], abs=1e-6)
    assert found[-1].cycle - found[-2].cycle <= 14
    assert highest <= acceleration * ROUNDING
