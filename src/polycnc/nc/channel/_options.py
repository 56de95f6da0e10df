"""How a channel prepares its programs, whatever they are."""

from __future__ import annotations

from dataclasses import dataclass

ORDINARY_BLOCKS = 2000


@dataclass(frozen=True, slots=True)
class ChannelOptions:
    """Say how a channel prepares.

    With `stands_at_stops` preparation waits at M0 and M1 for `Channel.go_on`; else they are events like any other. With
    `answers` the path waits at auxiliary functions for whoever runs it, not for the machine file's times; with `marks`
    blocks that leave nothing in the queue are noted (see `QueueWriter`). With `collect_errors` a refused block is noted
    and left out; else preparation ends there. With `mark_refused` the queue says where it was, with
    `past_refused` its feed counts and its contour is passed over, so that no errors follow from it.
    The reference interpreter gives the same queue as the compiled kernel, which takes over after the first
    `ordinary_blocks`: loading it, and once compiling it, takes longer than they do.
    """

    stands_at_stops: bool = False
    answers: bool = False
    marks: bool = False
    collect_errors: bool = False
    mark_refused: bool = False
    past_refused: bool = False
    ordinary_blocks: float = ORDINARY_BLOCKS
