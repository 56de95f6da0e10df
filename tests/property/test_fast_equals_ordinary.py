"""The compiled modal kernel and the reference interpreter give the same queue, bit for bit."""

from __future__ import annotations

import math

import hypothesis.strategies as st
import pytest
from hypothesis import HealthCheck, example, given, settings

from polycnc.nc import DIALECTS, Block, Channel, Dialect, EndSource, load_dialect
from polycnc.nc.channel._reader import Reader
from polycnc.nc.channel._running import Running
from support.block_strategies import programs
from support.programs import FIVE, channel_state, prepare, queue_bytes

INCREMENTS = load_dialect("fanuc").model_copy(
    update={"numbers": load_dialect("fanuc").numbers.model_copy(update={"decimal_point": "least_input"})}
)
BLENDED = load_dialect("din").model_copy(
    update={"initial": load_dialect("din").initial.model_copy(update={"units": "inch"})}
)


def both(program: str, dialect: str | Dialect, *, collect_errors: bool) -> tuple[Channel, Channel]:
    """Prepare a program both ways; the compiled kernel takes over early or late."""
    fast, ordinary = (
        prepare(program, config=FIVE, dialect=dialect, collect_errors=collect_errors, ordinary_blocks=blocks)
        for blocks in (len(program) % 3, math.inf)
    )
    return fast, ordinary


def assert_same(fast: Channel, ordinary: Channel) -> None:
    assert [str(error) for error in fast.errors] == [str(error) for error in ordinary.errors]
    assert queue_bytes(fast) == queue_bytes(ordinary)
    assert channel_state(fast) == channel_state(ordinary)
    assert fast.blocks == ordinary.blocks


@pytest.mark.parametrize("dialect", DIALECTS)
@settings(max_examples=70, suppress_health_check=[HealthCheck.too_slow])
@given(program=programs)
@example(program="G2 X10 I5\nG91 G3 X10 J-0 I5\nX1\n")
@example(program="G1 F500\n X0 F100\nG92 X1 Y2\nG91 G2 X2 I1\n")
@example(program="F500\nG5 X9 Y3 I2 J3 P1 Q-2\nX12\nX9 Y3\nG5 X0 P2 Q1\n")
# Radius compensation fails at a contour outside the limits: where it stands then, every axis counts.
@example(program="F500\nX290\nG42 D2\nG91 G2 X0 I0\nG90 X302\nG91 G2 X8 I4\n X0\n Y0\n")
def test_shipped_dialects(dialect: str, program: str) -> None:
    assert_same(*both(program, dialect, collect_errors=True))


@settings(max_examples=50, suppress_health_check=[HealthCheck.too_slow])
@given(programs, st.sampled_from([INCREMENTS, BLENDED]))
def test_other_settings(program: str, dialect: Dialect) -> None:
    assert_same(*both(program, dialect, collect_errors=True))


@settings(max_examples=50, suppress_health_check=[HealthCheck.too_slow])
@given(programs)
def test_both_stop_at_the_same_error(program: str) -> None:
    assert_same(*both(program, "din", collect_errors=False))


def test_the_fast_path_takes_plain_blocks_and_only_those(monkeypatch: pytest.MonkeyPatch) -> None:
    """The comparison is worth something only if both ways are gone."""
    taken: list[int] = []
    take = Reader.take

    def noting(self: Reader, running: Running) -> Block | EndSource | None:
        block = take(self, running)
        taken.append(self.line)
        return block

    monkeypatch.setattr(Reader, "take", noting)
    plain = "".join(f"N{n} G1 X{n % 50} Y.{n} F1000\n" for n in range(500))
    prepare("G21 G90\n" + plain + "M8\nG2 X9 I-20.05 J.001\n")
    assert taken == [1, 502, 503]
