"""A virtual APCI board with closed loops whose every setpoint is kept, and profiles integrated step by step."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from polycnc.controllers.apci.board._axis_commands import cl
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._commanded import LATENCY_SCANS
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.kernel import LEADING

SCAN_S = 0.00128
LATENCY = LATENCY_SCANS
Floats = npt.NDArray[np.float64]


class Rig:
    """A board made from the text of a system file; loops closed, one scan gone by."""

    def __init__(self, system: str = "", *, axes: int = 3, closed: bool = True, keep: int = 20_000) -> None:
        self.board = Board(parse_system_file(system or f"number_of_axes = {axes}"), record_scans=keep)
        self.n = len(self.board.axes)
        self.all = tuple(range(self.n))
        if closed:
            cl(self.board, self.all)
        self.board.advance(1)
        self.forget()

    def forget(self) -> None:
        """Forget the setpoints kept so far."""
        self.board.kernel.recorder.filled[0] = 0

    def setpoints(self, i: int = 0) -> Floats:
        """Return the machine setpoints of an axis, one a scan since they were forgotten."""
        recorder = self.board.kernel.recorder
        return np.array(recorder.rows[: recorder.filled[0], LEADING + i])

    def scans_until_end(self, axes: Sequence[int] | None = None, limit: int = 19_000) -> int:
        """Let scans pass until the profiles of `axes` (all if None) have ended; return how many."""
        begin = self.board.clock.cycles
        self.board.wait(None if axes is None else tuple(axes), limit * SCAN_S)
        return self.board.clock.cycles - begin

    def set_jog(
        self, i: int = 0, *, jac: float = 100.0, jdec: float = 100.0, jvl: float = 50.0, jtvl: float = 0.0
    ) -> None:
        """Write the jog parameters of an axis; units of a system file are mm and seconds."""
        axis = self.board.axes[i]
        axis.jac = jac
        axis.jac = -jdec
        axis.jvl, axis.jtvl = jvl, jtvl

    def bits(self, i: int = 0) -> int:
        """Return the status word of an axis."""
        return int(self.board.axes[i].axst)

    def free_entries(self) -> int:
        """Return how many spooler entries nobody uses."""
        return int(self.board.state.board[0]["free"])


def scans_for(duration_s: float) -> int:
    """Return the scan in which a profile of this duration has ended: the first at or after its end."""
    return int(np.ceil(duration_s / SCAN_S - 1e-6))


@functools.cache
def integrated(
    distance: float, first: float, top: float, last: float, up: float, down: float, step_s: float = 1e-5
) -> tuple[Floats, Floats, Floats]:
    """Return times, positions and velocities of a profile, integrated in small steps from the manual's words.

    The axis speeds up to `top`, brakes as late as it can to have the velocity `last` at `distance`, first turns round
    if it goes the wrong way, and with a negative `last` goes past the target and comes back. Source: Manual 002, 2.2.
    """
    turn = distance if last >= 0.0 else distance + last * last / (2.0 * down)
    end_speed = max(last, 0.0)
    t, p, v = 0.0, 0.0, first
    rows = [(t, p, v)]
    while p < turn:
        if v < 0.0:
            rate = down
        elif v > top or v * v - end_speed * end_speed >= 2.0 * down * (turn - p):
            rate = -down
        else:
            rate = up if v < top else 0.0
        new = v + rate * step_s
        if rate > 0.0 and v <= top < new:
            new = top
        if rate < 0.0 and v > 0.0 >= new:
            break
        p += 0.5 * (v + new) * step_s
        v = new
        t += step_s
        rows.append((t, p, v))
    if last < 0.0:
        v = 0.0
        while v > last:
            new = max(v - up * step_s, last)
            p += 0.5 * (v + new) * step_s
            v = new
            t += step_s
            rows.append((t, p, v))
    times, positions, velocities = np.array(rows).T
    return times, positions, velocities
