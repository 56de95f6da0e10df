"""The compiled modal kernel and the reference interpreter give the same queue, bit for bit."""

from __future__ import annotations

import math

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings

from polycnc.machine import Machine, MachineConfig
from polycnc.nc import DIALECTS, Block, Channel, Dialect, EndSource, ProgramText, load_dialect
from polycnc.nc.channel._options import ChannelOptions
from polycnc.nc.channel._reader import Reader
from polycnc.nc.channel._running import Running
from support.block_strategies import half_circles, modes, programs, straight
from support.often import share
from support.programs import (
    FIVE,
    LINEAR,
    OFFSETS,
    ROTARY,
    TIMES,
    TOOLS,
    channel_state,
    machine_config,
    prepare,
    queue_bytes,
)

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
@settings(max_examples=share(40), suppress_health_check=[HealthCheck.too_slow])
@given(program=programs)
@example(program="G2 X10 I5\nG91 G3 X10 J-0 I5\nX1\n")
@example(program="G1 F500\n X0 F100\nG92 X1 Y2\nG91 G2 X2 I1\n")
@example(program="F500\nG5 X9 Y3 I2 J3 P1 Q-2\nX12\nX9 Y3\nG5 X0 P2 Q1\n")
# Radius compensation fails at a contour outside the limits: where it stands then, every axis counts.
@example(program="F500\nX290\nG42 D2\nG91 G2 X0 I0\nG90 X302\nG91 G2 X8 I4\n X0\n Y0\n")
def test_shipped_dialects(dialect: str, program: str) -> None:
    assert_same(*both(program, dialect, collect_errors=True))


@settings(max_examples=share(50), suppress_health_check=[HealthCheck.too_slow])
@given(programs, st.sampled_from([INCREMENTS, BLENDED]))
def test_other_settings(program: str, dialect: Dialect) -> None:
    assert_same(*both(program, dialect, collect_errors=True))


@settings(max_examples=share(50), suppress_health_check=[HealthCheck.too_slow])
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
    prepare("G21 G90\n" + plain + "M8\nM19\nG2 X9 I-20.05 J.001\n")
    assert taken == [1, 503, 504]


LASER = machine_config(
    LINEAR, ROTARY, "[spindle]\nmax_rpm = 1000\nlaser = true\n", TIMES, TOOLS, OFFSETS, name="laser"
)
ROUNDED = LASER.model_copy(
    update={"path": LASER.path.model_copy(update={"path_tolerance_mm": 0.5, "merge_mm": 0.05})}
)

lasting = st.sampled_from(
    (
        *("", "", "S300", "S300", "S17.5", "S0", "S1000", "S1001", "S-2", "S5 S6", "M3", "M4", "M4 S250"),
        *("M5", "M3 M5", "M3 M8", "M8", "M03", "M3.5", "M19", "T1", "T2.5", "T7 T8", "D1", "D9", "D-1"),
        *("T2 D2", "H1", "H2", "H0", "T2 M6", "S20 M5 T3"),
        *("M7", "M9", "M7 M8", "S55 M7", "S8 M9 T4", "M19", "M3 S70", "G96 S50", "G97 S90"),
    )
)
worded = st.builds("{} {}".format, st.one_of(straight, straight, half_circles), lasting)
lasers = st.lists(st.one_of(worded, worded, worded, lasting, modes), min_size=1, max_size=25).map(
    lambda lines: "G1 F500\n" + "\n".join(lines) + "\n"
)


def recorded(channel: Channel) -> list[object]:
    """Return what the records say of the blocks of the queue and of the marks, in their order."""
    tail = int(channel.machine.state.paths.row[channel.path]["tail"])
    tags = channel.machine.state.seg.row["tag"][:tail].tolist()
    marks = channel.writer.marks or ()
    records = [channel.records.block(tag) for tag in [*tags, *(tag for _, tag in marks)]]
    said = [[tag and float(channel.records.spindle_turns(np.array([tag]))[0]) for tag in tags]]
    return [said, [count for count, _ in marks], *((each.line, each.modal) for each in records if each)]


@settings(max_examples=share(60), suppress_health_check=[HealthCheck.too_slow])
@given(
    st.sampled_from([FIVE, LASER, ROUNDED]),
    st.sampled_from(["grbl", "din", "linuxcnc", "fanuc-lathe"]),
    lasers,
)
@example(FIVE, "din", "G43 H1\nG1 X7 H1 F300\nX9 H2\nX3 H1 T2 D1\n")
@example(FIVE, "fanuc", "M8\nG1 X1 F300 M7 S20\nX2 M8\nX3 M9 S9000\nX3 S4 M3\nM7 T2\nM19\nM3\nX5 M3 S30\n")
@example(ROUNDED, "grbl", "M4 S20\nG1 X1 F300 S30\nX2 S30\nX3 S40\nS50\nX4 M5\nX5 M3 T2 D2\n")
def test_words_that_stop_nothing(config: MachineConfig, dialect: str, program: str) -> None:
    fast, ordinary = (
        prepare(
            program, config=config, dialect=dialect, collect_errors=True, ordinary_blocks=blocks, marks=True
        )
        for blocks in (len(program) % 3, math.inf)
    )
    assert_same(fast, ordinary)
    assert recorded(fast) == recorded(ordinary)


@pytest.mark.parametrize("config", [LASER, FIVE], ids=["laser", "mill"])
def test_words_in_each_block_stay_in_the_compiled_reader(
    monkeypatch: pytest.MonkeyPatch, config: MachineConfig
) -> None:
    taken: list[int] = []
    take = Reader.take

    def noting(self: Reader, running: Running) -> Block | EndSource | None:
        block = take(self, running)
        taken.append(self.line)
        return block

    monkeypatch.setattr(Reader, "take", noting)
    words = ("S{n}", "S3 M4", "M5", "M3 T{n}", "D{n} S2", "H1", "M7", "S{n} M8", "M9")
    lines = "".join(f"G1 X{n % 50}.5 F{n + 100} {words[n % 9].format(n=n)}\n" for n in range(600))
    channel = prepare("G21 G90 G43 H1\n" + lines, config=config)
    assert channel.error is None
    assert taken == [1]


def test_functions_that_are_answered_are_no_plain_blocks() -> None:
    channel = Channel(
        ProgramText.from_text("M8\nG1 X7 F300\nM9\nX3\n", "test.nc"),
        load_dialect("din"),
        Machine(FIVE),
        options=ChannelOptions(answers=True, ordinary_blocks=0),
    )
    channel.fill()
    assert [event.word for event in channel.writer.events.values()] == ["M8"]
    assert channel.waits
