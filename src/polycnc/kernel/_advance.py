"""Run control cycles: every source gives its part, the sum is the setpoint, the servos follow, the record is kept.

`advance` never enters Python between two cycles. A controller with logic of its own per cycle writes a compiled loop
around `cycle`, or around its two halves where it has to see or change the setpoints between them.
"""

from __future__ import annotations

from polycnc.kernel._in_step import note_begun
from polycnc.kernel._interpolate import path_cycle, settle, skip_path
from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._path import EVENT, IDLE, READY, RESTED
from polycnc.kernel._point_to_point import ADDED, MAIN, place_axis, profile_cycle
from polycnc.kernel._recorder import is_full, record
from polycnc.kernel._segments import RAPID
from polycnc.kernel._servo import servo_cycle, servo_place
from polycnc.kernel._state import (
    FOLLOWING_ERROR,
    PATH_EVENT,
    PATH_RESTED,
    POINT_TO_POINT,
    PROFILE_ENDED,
    QUEUE_LOW,
    RECORDER_FULL,
    SOFT_LIMIT,
    SWITCH_EDGE,
    KernelState,
)
from polycnc.kernel._switches import SOFT_INSIDE, SWITCHES_PER_AXIS, soft_limit, switches_cycle


@compiled
def _settle_path(state: KernelState, g: int, now: int) -> None:
    """Report what stands where path `g` rests in cycle `now`: an event, or nothing more to come."""
    row = state.paths.row[g]
    while settle(state.seg, state.paths, g, now) == EVENT:
        state.clock[0]["raised"] |= PATH_EVENT
        if state.clock[0]["mask"] & PATH_EVENT:
            break
    if row["state"] == READY and row["head"] >= min(row["tail"], row["limit"]):
        state.clock[0]["raised"] |= PATH_RESTED


@compiled
def _run_paths(state: KernelState, dt: float) -> None:
    for g in range(state.paths.row.shape[0]):
        row = state.paths.row[g]
        if row["state"] == IDLE:
            continue
        rested = path_cycle(state.seg, state.paths, g, dt) == RESTED
        now = state.clock[0]["cycle"] + 1
        if row["in_step"] > 0 and note_begun(state.seg, state.paths, g, now):
            state.clock[0]["raised"] |= PATH_EVENT
        if rested:
            _settle_path(state, g, now)
        if row["closed"] == 0 and row["planned"] - row["head"] <= row["low_water"]:
            state.clock[0]["raised"] |= QUEUE_LOW


@compiled
def _position_sources(state: KernelState, dt: float) -> None:
    """Put what owns each axis, and what is added to it, into the setpoints."""
    for i in range(state.setpoint.shape[0]):
        if profile_cycle(state.ptp, ADDED, i, dt):
            state.clock[0]["raised"] |= PROFILE_ENDED
            state.clock[0]["axis"] = i
        if state.owner[i] == POINT_TO_POINT:
            if profile_cycle(state.ptp, MAIN, i, dt):
                state.clock[0]["raised"] |= PROFILE_ENDED
                state.clock[0]["axis"] = i
            state.base[i] = state.ptp.row[MAIN, i]["position"]
    for g in range(state.paths.row.shape[0]):
        for m in range(state.paths.axis.shape[1]):
            axis = state.paths.axis[g, m]
            if axis >= 0 and state.owner[axis] == g:
                state.base[axis] = state.paths.position[g, m]
    for i in range(state.setpoint.shape[0]):
        state.setpoint[i] = state.base[i] + state.ptp.row[ADDED, i]["position"]


@compiled
def _follow(state: KernelState, i: int, last_setpoint: float, dt: float) -> None:
    """Let the servo of axis `i` follow its setpoint, and watch its switches and limits."""
    velocity = (state.setpoint[i] - last_setpoint) / dt
    state.acceleration[i] = (velocity - state.velocity[i]) / dt
    state.velocity[i] = velocity
    last_actual = state.servo.actual[i]
    state.servo.profile_at_rest[i] = 1 if velocity == 0.0 else 0
    servo_cycle(i, state.servo, state.plant, state.setpoint[i], velocity, state.acceleration[i], dt)
    if state.servo.error_tripped[i] != 0:
        state.clock[0]["raised"] |= FOLLOWING_ERROR
        state.clock[0]["axis"] = i
    switches_cycle(i, state.switches, state.servo.actual[i], last_actual)
    for j in range(SWITCHES_PER_AXIS):
        if state.switches.rising[i, j] != 0 or state.switches.falling[i, j] != 0:
            state.clock[0]["raised"] |= SWITCH_EDGE
            state.clock[0]["axis"] = i
    if soft_limit(i, state.switches, state.setpoint[i]) != SOFT_INSIDE:
        state.clock[0]["raised"] |= SOFT_LIMIT
        state.clock[0]["axis"] = i


@compiled
def sources_cycle(state: KernelState) -> None:
    """Begin a control cycle: let every source give its part; the sum is in `setpoint`."""
    clock = state.clock[0]
    dt = clock["dt"]
    clock["raised"] = 0
    clock["axis"] = -1
    last = state.work[0]
    for i in range(last.shape[0]):
        last[i] = state.setpoint[i]
    _run_paths(state, dt)
    _position_sources(state, dt)


@compiled
def follow_cycle(state: KernelState) -> None:
    """End a control cycle: let the servos follow `setpoint`, watch the switches, keep the record."""
    clock = state.clock[0]
    dt = clock["dt"]
    last = state.work[0]
    for i in range(last.shape[0]):
        _follow(state, i, last[i], dt)
    clock["cycle"] += 1
    main = clock["main_path"]
    path = state.paths.row[main]
    time_s = clock["cycle"] * dt
    rapid = path["flags"] & RAPID
    record(state.recorder, time_s, path["tag"], path["speed"], rapid, state.setpoint, state.servo.actual)
    if is_full(state.recorder):
        clock["raised"] |= RECORDER_FULL


@compiled
def cycle(state: KernelState) -> None:
    """Run one control cycle."""
    sources_cycle(state)
    follow_cycle(state)


@entry(steps=lambda state, cycles: cycles * (2 + 2 * len(state.setpoint)))
def advance(state: KernelState, cycles: int) -> int:
    """Run up to `cycles` control cycles; return how many were run.

    Stops after a cycle in which a reason in the clock's `mask` was met; the clock's `raised` tells which. Stops at
    once, with 0, when a path stands at waits of no duration that lead to an event or to the end of the queue.
    """
    clock = state.clock[0]
    clock["raised"] = 0
    clock["axis"] = -1
    for g in range(state.paths.row.shape[0]):
        row = state.paths.row[g]
        row["event"] = -1
        row["passed_at"] = clock["cycle"] if row["passes"] != 0 else -1
        if row["state"] == READY and row["head"] < row["prepared"] and not clock["raised"] & PATH_EVENT:
            _settle_path(state, g, clock["cycle"])
    if clock["raised"] & clock["mask"]:
        return 0
    for done in range(cycles):
        cycle(state)
        if clock["raised"] & clock["mask"]:
            return done + 1
    return cycles


def skip(state: KernelState, g: int, until: int) -> int:
    """Go along path `g` in closed form up to segment count `until` or the next event; return the cycles it took.

    The clock goes on as if all cycles had been run; servos are taken as ideal and nothing is recorded.
    """
    clock, paths = state.clock[0], state.paths
    cycles = int(skip_path(state.seg, paths, g, clock["dt"], until, clock["cycle"]))
    clock["cycle"] += cycles
    for m, axis in enumerate(paths.axis[g]):
        if axis >= 0 and state.owner[axis] == g:
            state.base[axis] = paths.position[g, m]
            state.setpoint[axis] = state.base[axis]
    return cycles


def give_to_path(state: KernelState, g: int) -> None:
    """Hand the axes of path `g` over to it, at rest where they are; its queue must be empty."""
    for m, axis in enumerate(state.paths.axis[g]):
        if axis >= 0:
            state.paths.position[g, m] = state.base[axis]
            state.paths.queued[g, m] = state.base[axis]
            state.owner[axis] = g


def give_to_point_to_point(state: KernelState, axis: int) -> None:
    """Hand an axis over to its point-to-point source, at rest where it is."""
    place_axis(state.ptp, MAIN, axis, state.base[axis])
    state.owner[axis] = POINT_TO_POINT


def place_machine(state: KernelState, axis: int, position: float) -> None:
    """Put an axis at rest at `position`: setpoint, actual position and point-to-point source alike."""
    place_axis(state.ptp, MAIN, axis, position)
    place_axis(state.ptp, ADDED, axis, 0.0)
    state.owner[axis] = POINT_TO_POINT
    state.base[axis] = position
    state.setpoint[axis] = position
    state.velocity[axis] = 0.0
    state.acceleration[axis] = 0.0
    servo_place(axis, state.servo, state.plant, position)
