"""Everything that a program run holds at one cycle, to go back to."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from polycnc.cnc._path_feed import FeedSnapshot
from polycnc.cnc._stops import Stopper
from polycnc.nc import Channel, ChannelSnapshot, ProgramText

if TYPE_CHECKING:
    from polycnc.cnc._program_run import ProgramRun

# Plain values that a run holds besides its channel.
_SAVED = (
    "optional_stop", "alarm", "_block_delete", "_single_block", "_state", "_hold", "_stop",
    "_met", "_dropping", "_locked", "_unanswered", "_approach", "_tool_times", "_probing",
    "skip_signal", "_suppressed", "_held_back",
)  # fmt: skip


class RunSnapshot(NamedTuple):
    """What a run holds; its machine has a snapshot of its own."""

    program: ProgramText
    channel: Channel
    prepared: ChannelSnapshot
    feed: FeedSnapshot
    stopper: Stopper
    override_kept: float | None
    fields: dict[str, Any]


def taken_of(run: ProgramRun) -> RunSnapshot:
    """Return what a run holds now.

    Raises:
        UsageError: a language executes the program; where that stands cannot be kept.
    """
    return RunSnapshot(
        run.program,
        run.channel,
        run.channel.snapshot(),
        run.feed.snapshot(),
        replace(run.stopper),
        run.overrides.kept,
        {name: getattr(run, name) for name in _SAVED},
    )


def put_back(run: ProgramRun, saved: RunSnapshot) -> None:
    """Let a run hold again what it held."""
    run.program = saved.program
    run.channel = run.feed.channel = saved.channel
    run.channel.restore(saved.prepared)
    run.feed.restore(saved.feed)
    run.stopper.records = saved.stopper.records
    run.stopper.step, run.stopper.depth = saved.stopper.step, saved.stopper.depth
    run.stopper.breakpoints = saved.stopper.breakpoints
    run.overrides.kept = saved.override_kept
    for name, value in saved.fields.items():
        setattr(run, name, value)
    run.channel.skip_levels = run.block_delete
