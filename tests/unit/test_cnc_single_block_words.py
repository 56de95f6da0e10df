"""Single block stops once per block, at its end, whatever words the block has and whether corners are rounded."""

from __future__ import annotations

import pytest

from polycnc.cnc import Control, RunState
from support.cnc_control import x_of
from support.cnc_machine import cnc_machine


def stops(program: str, dialect: str) -> list[tuple[RunState, float]]:
    """Return how the program stands, and where X is, after each start."""
    made = Control(cnc_machine(), dialect=dialect)
    made.programs.create("WORDS", program)
    made.set_switches(single_block=True)
    made.select_program("WORDS")
    found: list[tuple[RunState, float]] = []
    while not found or found[-1][0] is not RunState.COMPLETED:
        made.cycle_start()
        for _ in range(200):
            made.advance(20)
            if (state := made.status().channel.run_state) is not RunState.ACTIVE:
                break
        found.append((state, round(x_of(made), 6)))
        assert state is not RunState.ACTIVE, "the block does not end"
    return found


@pytest.mark.parametrize(
    ("dialect", "block"),
    [
        ("fanuc", "M8 G1 X13"),
        ("fanuc", "M3 S100 M8 G1 X13 T1"),
        ("linuxcnc", "M62 P1 G1 X13"),
        ("linuxcnc", "M66 P1 L0 G1 X13"),
        ("linuxcnc", "M68 E1 Q3 G1 X13"),
        ("linuxcnc", "M101 P1 G1 X13"),
    ],
)
def test_a_block_with_functions_and_a_move_is_one_stop(dialect: str, block: str) -> None:
    at_block = RunState.STOPPED_AT_BLOCK
    assert stops(f"G21 G90 F3000\nG1 X11\n{block}\nG1 X15\nM2\n", dialect) == [
        (at_block, 12.5),
        (at_block, 11.0),
        (at_block, 13.0),
        (at_block, 15.0),
        (RunState.COMPLETED, 15.0),
    ]


@pytest.mark.parametrize(
    ("dialect", "rule"), [("linuxcnc", "G64"), ("linuxcnc", "G64 P0.1 Q0.02"), ("din", "G64 P0.1")]
)
def test_blocks_that_would_be_rounded_end_at_their_ends(dialect: str, rule: str) -> None:
    at_block = RunState.STOPPED_AT_BLOCK
    assert stops(f"G21 G90 {rule} F3000\nG1 X11\nG1 Y3\nG1 X14\nM2\n", dialect) == [
        (at_block, 12.5),
        (at_block, 11.0),
        (at_block, 11.0),
        (at_block, 14.0),
        (RunState.COMPLETED, 14.0),
    ]
