"""A refused block leaves no trace: a program without its refused blocks gives the same state and queue."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, assume, given, settings

from polycnc.nc import DIALECTS, Channel
from support.block_strategies import programs
from support.programs import FIVE, channel_state, prepare, queue_bytes


def refused_lines(channel: Channel) -> set[int]:
    """Return the numbers of the refused lines."""
    return {error.position.line for error in channel.errors if error.position is not None}


@pytest.mark.parametrize("dialect", DIALECTS)
@settings(max_examples=70, suppress_health_check=[HealthCheck.too_slow])
@given(program=programs)
def test_without_its_refused_blocks_a_program_does_the_same(dialect: str, program: str) -> None:
    whole = prepare(program, config=FIVE, dialect=dialect, collect_errors=True)
    # An error that only the next move shows is about a block that has been carried out.
    assume(not any("compensat" in error.what for error in whole.errors))
    refused = refused_lines(whole)
    lines = program.splitlines()
    if any("program flow" in error.what for error in whole.errors):  # one error for all of them
        refused |= {n for n, line in enumerate(lines, 1) if line.startswith("#")}
    rest = "\n".join("(left out)" if n in refused else line for n, line in enumerate(lines, 1)) + "\n"
    without = prepare(rest, config=FIVE, dialect=dialect, collect_errors=True)
    assert without.errors == []
    assert queue_bytes(without) == queue_bytes(whole)
    assert channel_state(without) == channel_state(whole)
