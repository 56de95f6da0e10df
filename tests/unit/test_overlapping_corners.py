"""Corners beside helices and between planes: one motion begins while the other ends, as LinuxCNC's planner does it."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

import polycnc
from polycnc.kernel import (
    BY_SHARE,
    KernelState,
    advance,
    append_arc,
    append_line,
    give_to_path,
    start_path,
)
from polycnc.kernel._cubic import ENTRY
from polycnc.kernel._geometry import segment_point, segment_tangent
from polycnc.kernel._path import mark_last
from polycnc.kernel._segments import ARC, LINE, OVERLAP
from polycnc.machine import LinearAxis, Machine, MachineConfig, PathConfig
from support.random_paths import PathSettings, machine, overload, prepare, replan, run_recorded

Floats = npt.NDArray[np.float64]

ROUTER = MachineConfig(
    name="router",
    axis=tuple(
        LinearAxis(name=name, vmax_mm_s=v, amax_mm_s2=a)
        for name, v, a in (("X", 150.0, 800.0), ("Y", 150.0, 800.0), ("Z", 80.0, 500.0))
    ),
    path=PathConfig(corner_share=0.1, rounding_share=0.5, last_share=0.5, rounding_gap_s=0.004),
)


FREE = ROUTER.model_copy(update={"path": ROUTER.path.model_copy(update={"free_overlaps": True})})


def queued(tolerance: float, *, by_share: bool = True, free: bool = False) -> KernelState:
    """Return a path: down a line, half a turn of a helix, a flat half turn in another plane, and away."""
    shares = (0.1, 0.5, 0.5) if by_share else None
    state = machine(np.random.default_rng(11), PathSettings(tolerance=tolerance, shares=shares), segments=64)
    state.paths.row[0]["free_overlaps"] = free
    where, row = state.seg, state.paths
    append_line(where, row, 0, state.limits, np.array([0.0, 0.0, -7.0]), 60.0, 0, 1)
    append_arc(where, row, 0, state.limits, np.array([8.0, 0, -4.6]), 0, 1, 4.0, 0.0, math.pi, 60.0, 0, 2)
    append_arc(where, row, 0, state.limits, np.array([8.0, 6.0, -4.6]), 1, 2, 3.0, -4.6, -math.pi, 60.0, 0, 3)
    append_line(where, row, 0, state.limits, np.array([15.0, 6.0, -3.0]), 60.0, 0, 4)
    return state


def kinds(state: KernelState) -> list[int]:
    return [int(kind) for kind in state.seg.row["kind"][: state.paths.row[0]["tail"]]]


def test_the_pieces_lie_between_the_motions_and_go_on_in_their_directions() -> None:
    state = queued(0.05)
    assert kinds(state) == [LINE, OVERLAP, ARC, OVERLAP, ARC, OVERLAP, LINE]
    before, after = np.zeros(3), np.zeros(3)
    for k in range(6):
        assert np.array_equal(state.seg.end[k], state.seg.start[k + 1])
        segment_tangent(state.seg, k, 1.0, before)
        segment_tangent(state.seg, k + 1, 0.0, after)
        assert after == pytest.approx(before, abs=2e-4), k


@pytest.mark.parametrize("tolerance", [0.003, 0.05, 0.4])
def test_the_corner_is_missed_by_no_more_than_the_tolerance(tolerance: float) -> None:
    state = queued(tolerance)
    corners = np.array([[0.0, 0.0, -7.0], [8.0, 0.0, -4.6], [8.0, 6.0, -4.6]])
    point = np.zeros(3)
    pieces = [k for k, kind in enumerate(kinds(state)) if kind == OVERLAP]
    for k, corner in zip(pieces, corners, strict=True):
        away = []
        for step in range(101):
            segment_point(state.seg, k, state.seg.row[k]["length"] * step / 100.0, point)
            away.append(float(np.linalg.norm(point - corner)))
        assert min(away) <= tolerance
        assert min(away) > 1e-4


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize("tolerance", [0.05, math.inf])
def test_every_axis_keeps_its_limits_where_motions_overlap(tolerance: float, free: bool) -> None:
    state = queued(tolerance, free=free)
    prepare(state)
    start_path(state.paths, 0)
    run_recorded(state)
    assert state.paths.position[0] == pytest.approx([15.0, 6.0, -3.0])
    assert max(overload(state)) <= 1.0 + 1e-6


def test_a_free_piece_takes_as_long_as_the_ramp_before_it_and_as_far_as_the_next_one_gets_meanwhile() -> None:
    state = queued(math.inf, free=True)
    prepare(state)
    rows, found = state.seg.row, kinds(state)
    assert found == [LINE, OVERLAP, ARC, OVERLAP, ARC, OVERLAP, LINE]
    for k in (1, 3, 5):
        entry, fastest = state.seg.geo[k, ENTRY], rows[k]["feed_mm_s"]
        faster = max(entry, 1.0 - entry)
        leaving, entering = entry / faster * fastest, (1.0 - entry) / faster * fastest
        time = rows[k - 1]["full_accel"] ** -1 * leaving
        assert rows[k]["length"] == pytest.approx(0.5 * (leaving + entering) * time, rel=1e-6)
        assert entering == pytest.approx(min(rows[k + 1]["cap"], rows[k + 1]["full_accel"] * time), rel=1e-6)
    # After the last corner comes a line, of which the way from rest is gone.
    gone = float(np.linalg.norm(state.seg.start[6] - [8.0, 6.0, -4.6]))
    assert gone == pytest.approx(entering * (time - 0.5 * entering / rows[6]["full_accel"]), rel=1e-6)


def test_an_arc_that_may_be_the_last_is_as_fast_as_its_axes_let_it_and_has_half_of_its_acceleration() -> None:
    state = Machine(ROUTER, segments=64).state
    give_to_path(state, 0)
    state.paths.row[0]["tolerance_mm"] = 0.05
    where, row = state.seg, state.paths
    append_line(where, row, 0, state.limits, np.array([0.0, -9.0, 0.4]), 50.0, 0, 1)
    append_arc(where, row, 0, state.limits, np.array([0.0, -1.0, 0.4]), 0, 1, 0.0, -5.0, math.pi, 150.0, 0, 2)
    mark_last(where, row, 0)
    prepare(state)
    assert kinds(state) == [LINE, OVERLAP, ARC]
    assert where.row[2]["cap"] == pytest.approx(math.sqrt(math.sqrt(0.75) * 800.0 * 4.0), rel=1e-9)
    assert where.row[2]["full_accel"] == pytest.approx(0.5 * 0.5 * 800.0, rel=1e-9)


def test_motions_overlap_by_the_rule_of_shares_alone() -> None:
    assert OVERLAP not in kinds(queued(0.05, by_share=False))
    assert OVERLAP not in kinds(queued(0.0))
    assert queued(0.05).paths.row[0]["corner_rule"] == BY_SHARE


def trochoid(*, lifted: bool) -> str:
    """Return half circles of 4 mm that cut, each with a way back over the workpiece."""
    found = ["F3900", "G1 X4"]
    for turn in range(12):
        x = 1.1 * turn
        found.append(f"G2 X{x - 4.0:.4f} Y0 I-4 J0")
        if lifted:
            found += [f"G2 X{x + 5.1:.4f} Y0 I4.55 J0 Z0.5", "G1 Z0"]
        else:
            found += ["G0 Z1", f"G1 X{x + 5.1:.4f} Y0", "G1 Z0"]
    return "\n".join(found)


def arches() -> str:
    """Return half circles in XZ that lines along Y join."""
    found = ["F3000"]
    for y in range(8):
        found += ["G18 G2 X10 Z0 I5 K0", f"G1 Y{y + 0.5}", "G3 X0 Z0 I-5 K0", f"G1 Y{y + 1}"]
    return "\n".join(found)


def adaptive() -> str:
    """Return half circles that cut, each with a way back that quarter helices lift and lower."""
    found = ["F4200", "G1 X4"]
    for turn in range(12):
        x = 1.0 * turn
        found += [f"G2 X{x - 4.0:.4f} Y0 I-4 J0", f"G2 X{x - 3.0:.4f} Y1 I1 J0 Z0.3"]
        found += [f"G1 X{x + 4.0:.4f} Y1 F6000", f"G2 X{x + 5.0:.4f} Y0 I0 J-1 Z0 F4200"]
    return "\n".join(found)


def threads() -> str:
    """Return threads of 1.5 mm that are milled from below, with half circles that lead in and out."""
    found = ["F2400"]
    for x in (0, 20, 40, 60):
        found += ["G0 Z2", f"G0 X{x} Y0", "G1 Z-9 F900", "F2400", f"G3 X{x + 5} Y0 I2.5 J0 Z-8.6250"]
        found += [f"G3 X{x + 5} Y0 I-5 J0 Z{-8.625 + 1.5 * turn:.4f}" for turn in (1, 2, 3)]
        found += [f"G3 X{x} Y0 I-2.5 J0 Z-3.7500", "G0 Z2"]
    return "\n".join(found)


def turns() -> str:
    """Return helices of three turns each, with corners in and out of their plane."""
    found, z = ["F3000", "G1 X4"], 0
    for _ in range(4):
        found += [f"G3 X4 Y0 I-4 J0 Z{z - 3} P3", f"G1 X4 Y0 Z{z - 2}", "G1 X6", "G1 X4"]
        z -= 2
    return "\n".join(found)


def cone() -> str:
    """Return half turns of helices that touch, each larger than the one before it."""
    found, x, z = ["F3600"], 0.0, 0.0
    for turn in range(24):
        radius = (0.5 + 0.4 * turn) * (1 if turn % 2 == 0 else -1)
        x, z = x + 2.0 * radius, z - 0.3
        found.append(f"G3 X{x:.4f} Y0 I{radius:.4f} J0 Z{z:.3f}")
    return "\n".join(found)


def waves() -> str:
    """Return helices that meet in corners and rise and fall in turn."""
    found, x, z = ["F3000"], 0.0, 0.0
    for turn in range(12):
        x, z = x + 9.0, z + (1.0, -2.0, 0.5, 0.7, -0.4, 1.5)[turn % 6]
        found.append(f"G{2 if turn % 2 else 3} X{x:.4f} Y0 R5.0 Z{z:.3f}")
    return "\n".join(found)


def climbs() -> str:
    """Return lines with steep helices between, the last of which ends the program."""
    found, x = ["F4000"], 0
    for turn in range(4):
        found += [f"G1 X{x + 3 + turn}", f"G2 X{x + 8 + turn} Y0 I2.5 J0 Z{(12, 0)[turn % 2]}"]
        x += 8 + turn
    return "\n".join(found)


def posts() -> str:
    """Return steep helices that meet."""
    turns = (f"G{3 - turn % 2} X{4.4 * turn + 4.4:.1f} Y0 I2.2 J0 Z{(12, 0)[turn % 2]}" for turn in range(5))
    return "\n".join(["F2400", *turns])


def steps() -> str:
    """Return helices with short lines between, which arcs round."""
    found = ["F4500"]
    for turn in range(6):
        x = 10 * turn
        found += [f"G2 X{x + 6} Y0 I3 J0 Z{(1, 0)[turn % 2]}", f"G1 X{x + 7} Y-0.5"]
        found += [f"G1 X{x + 9} Y-0.2", f"G1 X{x + 10} Y0"]
    return "\n".join(found)


def hooks() -> str:
    """Return helices that rise, each with a short line down, which ends the program as well."""
    found = ["F3000"]
    for turn in range(4):
        found += [f"G2 X{7 * turn + 7} Y0 I3.5 J0 Z2", "G1 Z0"]
    return "\n".join(found)


# Servo cycles of 1 ms in which LinuxCNC 2.9 moved, with the same axes.
THERE = [
    pytest.param(trochoid(lifted=True), "G64 P0.01", 13.419, id="helices back"),
    pytest.param(trochoid(lifted=True), "G64 P0.05 Q0.02", 12.488, id="helices back, wide"),
    pytest.param(trochoid(lifted=True), "G64", 10.839, id="helices back, free"),
    pytest.param(trochoid(lifted=False), "G64 P0.01", 11.281, id="lines down"),
    pytest.param(trochoid(lifted=False), "G64 P0.1", 10.728, id="lines down, wide"),
    pytest.param(arches(), "G64 P0.05 Q0.02", 12.000, id="arches"),
    pytest.param(adaptive(), "G64 P0.01", 11.790, id="quarter helices"),
    pytest.param(adaptive(), "G64 P0.1", 9.880, id="quarter helices, wide"),
    pytest.param(adaptive(), "G64", 9.593, id="quarter helices, free"),
    pytest.param(adaptive(), "G61", 10.409, id="quarter helices, exact"),
    pytest.param(threads(), "G64 P0.01", 16.916, id="threads"),
    pytest.param(threads(), "G64", 16.625, id="threads, free"),
    pytest.param(turns(), "G64 P0.1", 8.621, id="turns"),
    pytest.param(cone(), "G64 P0.01", 8.874, id="cone"),
    pytest.param(cone(), "G64 P0.1", 8.812, id="cone, wide"),
    pytest.param(waves(), "G64 P0.01", 5.306, id="helix to helix"),
    pytest.param(waves(), "G64", 3.364, id="helix to helix, free"),
    pytest.param(waves(), "G61", 4.347, id="helix to helix, exact"),
    pytest.param(climbs(), "G64", 2.061, id="ends with a steep helix, free"),
    pytest.param(climbs(), "G64 P0.05 Q0.02", 2.549, id="ends with a steep helix"),
    pytest.param(posts(), "G64", 2.009, id="steep helices that meet, free"),
    pytest.param(posts(), "G64 P0.05 Q0.02", 2.386, id="steep helices that meet"),
    pytest.param(steps(), "G64", 3.485, id="short lines with round corners"),
    pytest.param(hooks(), "G64", 1.956, id="ends with a short line"),
]


@pytest.mark.parametrize(("program", "rule", "seconds"), THERE)
def test_the_time_is_that_of_linuxcnc(program: str, rule: str, seconds: float) -> None:
    text = f"G21 G90 {rule}\nG0 X0 Y0 Z0\n{program}\nM2\n"
    assert polycnc.run(text, FREE, dialect="linuxcnc").time_s == pytest.approx(seconds, rel=0.004)


@pytest.mark.parametrize(
    ("rise", "speed", "accel"),
    # As seen on LinuxCNC 2.9: X and Y have 800 mm/s2, Z 500, and overlapping motions half of that.
    [(3.0, 46.695, 201.4), (12.0, 58.335, 435.1)],
)
def test_a_helix_turns_as_if_its_whole_rise_made_its_radius_larger(
    rise: float, speed: float, accel: float
) -> None:
    state = Machine(ROUTER, segments=64).state
    give_to_path(state, 0)
    state.paths.row[0]["tolerance_mm"] = 0.05
    where, row = state.seg, state.paths
    append_line(where, row, 0, state.limits, np.array([4.0, 0, 0]), 150.0, 0, 1)
    end = np.array([4.0, 0.0, rise])
    append_arc(where, row, 0, state.limits, end, 0, 1, 0.0, 0.0, 2.0 * math.pi, 150.0, 0, 2)
    append_line(where, row, 0, state.limits, np.array([20.0, 0, rise]), 150.0, 0, 3)
    prepare(state)
    assert kinds(state) == [LINE, OVERLAP, ARC, OVERLAP, LINE]
    assert where.row[2]["cap"] == pytest.approx(speed, rel=1e-3)
    assert where.row[2]["full_accel"] == pytest.approx(accel, rel=1e-3)


@pytest.mark.parametrize("tolerance", [0.05, math.inf])
def test_the_path_speed_goes_evenly_from_one_end_of_a_piece_to_the_other(tolerance: float) -> None:
    state = queued(tolerance)
    prepare(state)
    rows = state.seg.row
    for k in (number for number, kind in enumerate(kinds(state)) if kind == OVERLAP):
        entry = state.seg.geo[k, ENTRY]
        first, last = rows[k - 1]["junction"], rows[k]["junction"]
        assert first / (first + last) == pytest.approx(entry, rel=0.02)
        assert abs(last**2 - first**2) <= 2.0 * rows[k]["full_accel"] * rows[k]["length"] * (1.0 + 1e-3)


@pytest.mark.parametrize(("override", "free"), [(0.0, True), (0.1, False), (1.7, True)])
def test_a_hold_or_an_override_in_a_piece_breaks_no_limit(override: float, free: bool) -> None:
    for cycle in range(20, 700, 23):
        state = queued(0.4, free=free)
        prepare(state)
        start_path(state.paths, 0)
        advance(state, cycle)
        state.paths.row[0]["override"] = override
        replan(state)
        advance(state, 200)
        state.paths.row[0]["override"] = 1.0
        replan(state)
        run_recorded(state)
        assert state.paths.position[0] == pytest.approx([15.0, 6.0, -3.0])
        assert max(overload(state)) <= 1.0 + 1e-6, f"cycle {cycle}"


def test_an_axis_besides_the_three_leaves_corners_as_they_are() -> None:
    state = machine(np.random.default_rng(3), PathSettings(tolerance=0.05, shares=(0.1, 0.5, 0.5)))
    state.limits.feed_axis[2] = 0  # as a rotary axis, which rides along
    where, row = state.seg, state.paths
    append_line(where, row, 0, state.limits, np.array([8.0, 0.0, 30.0]), 60.0, 0, 1)
    append_arc(where, row, 0, state.limits, np.array([8.0, 8.0, 90.0]), 0, 1, 8.0, 4.0, math.pi, 60.0, 0, 2)
    append_line(where, row, 0, state.limits, np.array([0.0, 1.0, 90.0]), 60.0, 0, 3)
    assert kinds(state) == [LINE, ARC, LINE]
    prepare(state)
    start_path(state.paths, 0)
    run_recorded(state)
    assert max(overload(state)) <= 1.0 + 1e-6
