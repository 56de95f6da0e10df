"""Run a program to its end: in closed form, or cycle by cycle where the cycles are wanted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from polycnc.cnc import ProgramRun
from polycnc.kernel import FEED_LENGTH, FEED_S, RAPID_LENGTH, RAPID_S, TOP_SPEED, WAIT_S
from polycnc.nc import BlockRecords

Floats = npt.NDArray[np.float64]
Rows = Callable[[Floats], None]
TaggedRows = Callable[[Floats, npt.NDArray[np.int64], BlockRecords], None]
Progress = Callable[[float], None]

_STEP_CYCLES = 1 << 16


@dataclass(frozen=True, slots=True)
class Totals:
    """Times and lengths of what the path went along."""

    rapid_s: float
    feed_s: float
    wait_s: float
    rapid_length: float
    feed_length: float
    top_speed: float


def run_to_end(run: ProgramRun, *, every_cycle: bool, progress: Progress | None = None) -> None:
    """Run until the program has ended and everything has stopped, a program stop where it stands, or an alarm.

    With `every_cycle` every control cycle is run, as simulated servos, limit switches and the recorder need it;
    without, the same cycles are counted in closed form.
    """
    run.start()
    while run.active:
        if every_cycle:
            run.advance(_STEP_CYCLES)
        else:
            run.skip()
        if progress is not None:
            progress(run.channel.progress)
    run.drain()


def totals(run: ProgramRun) -> Totals:
    """Return times and lengths so far."""
    row = run.machine.state.paths.totals[run.path]
    columns = (RAPID_S, FEED_S, WAIT_S, RAPID_LENGTH, FEED_LENGTH, TOP_SPEED)
    return Totals(*(float(row[column]) for column in columns))
