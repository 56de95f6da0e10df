"""Run a program to its end: in closed form, or cycle by cycle where the cycles are wanted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from polycnc.cnc import ProgramRun
from polycnc.kernel import FEED_LENGTH, FEED_S, RAPID_LENGTH, RAPID_S, TOP_SPEED, WAIT_S
from polycnc.nc import BlockRecords

if TYPE_CHECKING:
    from polycnc.controllers.bosch import ChannelHost

Floats = npt.NDArray[np.float64]
Rows = Callable[[Floats], None]
TaggedRows = Callable[[Floats, npt.NDArray[np.int64], BlockRecords], None]
Progress = Callable[[float], None]

_STEP_CYCLES = 1 << 16
_MOVING_CYCLES = 1 << 8  # what a program asks of the control is seen this often
_PATIENCE_S = 1.0  # nothing changes the inputs of a run: what does not hold then never will
_GROWTH = 50  # a wait for an input is looked at ever more rarely
LOOP_LIMIT_S = 10.0
"""How long a program may loop without a block or a WAIT, in time of the machine."""


@dataclass(frozen=True, slots=True)
class Totals:
    """Times and lengths of what the path went along."""

    rapid_s: float
    feed_s: float
    wait_s: float
    rapid_length: float
    feed_length: float
    top_speed: float


def run_to_end(
    run: ProgramRun,
    *,
    every_cycle: bool,
    progress: Progress | None = None,
    control: ChannelHost | None = None,
    loop_limit_s: float = LOOP_LIMIT_S,
) -> None:
    """Run until the program has ended and everything has stopped, a program stop where it stands, or an alarm.

    With `every_cycle` every control cycle is run, as simulated servos, limit switches and the recorder need it;
    without, the same cycles are counted in closed form. A `control` that executes the program is asked again and again
    while the path stands: time passes up to the end of its wait.

    Raises:
        ProgramError: The program waits or loops without end, or loops for longer than `loop_limit_s`.
    """
    run.start()
    if control is not None:
        _run_with(control, run, loop_limit_s, every_cycle=every_cycle, progress=progress)
        return
    while run.active:
        if every_cycle:
            run.advance(_STEP_CYCLES)
        else:
            run.skip()
        if progress is not None:
            progress(run.channel.progress)
    run.drain()


def _run_with(
    control: ChannelHost,
    run: ProgramRun,
    loop_limit_s: float,
    *,
    every_cycle: bool,
    progress: Progress | None = None,
) -> None:
    idle, rounds, blocks = 0, 0, -1
    patience = run.machine.clock.cycles_for(_PATIENCE_S)
    while run.active:
        if every_cycle:
            run.advance(1 if run.at_rest else _MOVING_CYCLES)
        else:
            run.skip()
        if progress is not None:
            progress(run.channel.progress)
        wakes_s = control.wakes_in_s()
        stands = run.active and run.at_rest and wakes_s is None and run.channel.blocks == blocks
        rounds, blocks = rounds + 1 if stands else 0, run.channel.blocks
        if (endless := control.looping(rounds, loop_limit_s)) is not None:
            run.channel.close()
            raise endless
        if wakes_s is None or not run.active or not run.at_rest:
            idle = 0
            continue
        if wakes_s < float("inf"):
            cycles = run.machine.clock.cycles_for(wakes_s)
        elif idle > patience and (error := control.stuck()) is not None:
            run.channel.close()
            raise error
        else:
            cycles = idle // _GROWTH
        idle += max(run.advance(max(cycles, 1), asleep=True), 1)
    run.drain()


def totals(run: ProgramRun) -> Totals:
    """Return times and lengths so far."""
    row = run.machine.state.paths.totals[run.path]
    columns = (RAPID_S, FEED_S, WAIT_S, RAPID_LENGTH, FEED_LENGTH, TOP_SPEED)
    return Totals(*(float(row[column]) for column in columns))
