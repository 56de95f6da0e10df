"""A refused block leaves no trace: a program without its refused blocks gives the same state and queue.

A block is a value: until it is committed nothing of the state before it changes, whether it is refused or not.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, assume, given, settings

from polycnc.machine import load_machine
from polycnc.nc import DIALECTS, Channel
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._interpreter import Interpreter
from polycnc.nc.modal._modal import changing
from support.block_strategies import programs
from support.often import share
from support.programs import FIVE, channel_state, prepare, queue_bytes


def refused_lines(channel: Channel) -> set[int]:
    """Return the numbers of the refused lines."""
    return {error.position.line for error in channel.errors if error.position is not None}


@pytest.mark.parametrize("dialect", DIALECTS)
@settings(max_examples=share(40), suppress_health_check=[HealthCheck.too_slow])
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


def kept(state: ChannelState) -> tuple[object, ...]:
    """Return all of a state that a block could change."""
    return (
        changing(state.modal).tobytes(),
        state.plain(),
        id(state.coordinates),
        id(state.compensation),
        state.compensation.saved(),
    )


@contextlib.contextmanager
def watched() -> Iterator[list[int]]:
    """Compare the state before every block with itself after the block's steps; give the lines that were executed."""
    run, lines = Interpreter._run, []

    def compared(self: Interpreter, block: BlockContext) -> None:
        before = kept(block.before)
        try:
            run(self, block)
        finally:
            assert kept(block.before) == before, f"line {block.line} has changed the state before it"
            lines.append(block.line)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Interpreter, "_run", compared)
        yield lines


@pytest.mark.parametrize("dialect", DIALECTS)
@settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow])
@given(program=programs)
def test_steps_change_nothing_of_the_state_before(dialect: str, program: str) -> None:
    with watched():
        prepare(program, config=FIVE, dialect=dialect, collect_errors=True)


CONTOUR = """G0 X60. Z5. F0.2 S500 M3
G71 U2. R1.
G71 P10 Q40 U0.4 W0.1
N10 G0 X20.
N20 G1 Z-15.
N30 X40. Z-31.
N40 X60.
G70 P10 Q40
"""


def test_contours_are_executed_on_states_of_their_own() -> None:
    with watched() as lines:
        channel = prepare(CONTOUR, config=load_machine("lathe2"), dialect="fanuc-lathe")
    assert channel.error is None, channel.error
    assert lines.count(5) == 2  # measured for roughing, and executed for finishing
    assert lines[-1] == 8
