"""What a program run is doing, what is set for it, and what it tells."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from polycnc.nc import ChannelOptions


class RunState(StrEnum):
    """What a program run is doing."""

    READY = "ready"  # a program is selected and stands at its beginning
    RESET = "reset"  # broken off; it begins anew with the next start
    ACTIVE = "active"
    HOLD = "hold"  # feed hold: the axes brake or stand
    STOPPED_AT_BLOCK = "stopped at block"  # single block, or a breakpoint
    PROGRAM_STOP = "program stop"
    OPTIONAL_STOP = "optional stop"
    COMPLETED = "completed"
    ALARM = "alarm"


STANDING = frozenset({RunState.STOPPED_AT_BLOCK, RunState.PROGRAM_STOP, RunState.OPTIONAL_STOP})
"""States in which a program stands between blocks and can go on."""
INTERRUPTED = STANDING | {RunState.HOLD}
"""States in which a program stands and can go on."""
GOING = frozenset({RunState.ACTIVE, RunState.HOLD})
"""States in which a program is being executed."""
OVER = frozenset({RunState.READY, RunState.RESET, RunState.COMPLETED, RunState.ALARM})
"""States in which no program is under way."""


@dataclass(frozen=True, slots=True)
class RunOptions:
    """Set how a program is run: what an operator has set before it starts.

    `block_delete` are the numbers of the skip marks whose blocks are left out. `stands_at_stops` lets M0, and with
    `optional_stop` M1, wait for `resume`; without, they are passed, and single block and steps pass blocks that neither
    move nor wait. `blocks_ahead` is how many blocks are prepared beyond the executed one, None as the dialect says.
    `single_block` stops at the end of every block. With `answers` the path waits at an auxiliary function only for the
    answer of `on_event`, not for the machine file's times. `rapid_f0_mm_s` is the path speed of a rapid override of 0
    (0: it stands), `dry_run_mm_s` that of a dry run. `most_feed_override` is the largest factor of the feeds. So many
    `ordinary_blocks` are prepared before compiled code takes over. With `past_refused` no errors follow from another.
    """

    block_delete: frozenset[int] = frozenset()
    stands_at_stops: bool = True
    optional_stop: bool = False
    blocks_ahead: int | None = None
    single_block: bool = False
    answers: bool = False
    rapid_f0_mm_s: float = 0.0
    dry_run_mm_s: float = 0.0
    most_feed_override: float = 2.0
    collect_errors: bool = False
    mark_refused: bool = False
    past_refused: bool = False
    ordinary_blocks: float = ChannelOptions().ordinary_blocks


@dataclass(frozen=True, slots=True)
class RunAlarm:
    """Why the machine stopped a run: a text, a stable code, the tag of the block, the cycle."""

    text: str
    code: str
    tag: int
    cycle: int
