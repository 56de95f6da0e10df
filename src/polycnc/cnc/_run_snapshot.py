"""Everything that a program run holds at one cycle, to go back to."""

from __future__ import annotations

from typing import NamedTuple

from polycnc.cnc._path_feed import FeedSnapshot
from polycnc.cnc._run_moment import RunMoment
from polycnc.cnc._stops import Stopper
from polycnc.nc import Channel, ChannelSnapshot, ProgramText


class RunSnapshot(NamedTuple):
    """What a run holds; its machine has a snapshot of its own."""

    program: ProgramText
    channel: Channel
    prepared: ChannelSnapshot
    feed: FeedSnapshot
    stopper: Stopper
    override_kept: float | None
    moment: RunMoment
