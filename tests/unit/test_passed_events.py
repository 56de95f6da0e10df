"""Functions at which nobody waits are noted while the path goes on: when they come, and all that follows, stays."""

from __future__ import annotations

import math
from functools import partial

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings

import polycnc
from polycnc.cnc import Passed, PassedRun, ProgramRun, RunOptions, ToolTime
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import Event, EventRun, ProgramText, load_dialect
from polycnc.nc.blocks._events import PendingEvents
from polycnc.nc.channel._options import ChannelOptions
from polycnc.runner import RunEvent
from support.programs import LINEAR, TOOLS, machine_config

TIMED = machine_config(
    LINEAR,
    "[times]\nspindle_start_s = 0.0125\nauxiliary_s = 0.003\ntool_change_s = 0.4\n",
    TOOLS,
    name="timed",
)
SWIFT = machine_config(LINEAR, TOOLS, name="swift")
Found = tuple[float, int, str, ToolTime]

functions = st.sampled_from(
    (
        "",
        "",
        "S70",
        "S300 M3",
        "M3",
        "M4 S9",
        "M8",
        "M7",
        "M9",
        "S5 M8",
        "M5",
        "M0",
        "T2 M6",
        "T1 M6",
        "M30 M9",
    )
)
moves = st.sampled_from(
    ("", "G1 X7.5", "G1 X3 Y2", "G0 Z4", "G4 P0.1", "G2 X4 Y2.5 R3", "G1 X8", "G1 Z1.5 F900")
)
programs = st.lists(st.builds("{} {}".format, moves, functions), min_size=1, max_size=30).map(
    lambda lines: "G21 G90 F600\n" + "\n".join(line for line in lines if "M30 M9" not in line) + "\n"
)


def ran(
    program: str, config: MachineConfig, *, passes: bool, closed: bool, compiled: bool
) -> tuple[object, list[Found]]:
    """Run a program to its end; return what is known of the run, and its events."""
    found: list[Found] = []

    def passed(each: Passed | PassedRun) -> None:
        several = [each] if isinstance(each, Passed) else [each[at] for at in range(len(each.events))]
        found.extend((one.time_s, one.event.line, one.event.word, one.moved) for one in several)

    def met(event: Event) -> None:
        found.append((run.machine.time_s, event.line, event.word, run.reading.path_times))

    with pytest.MonkeyPatch.context() as patch:
        options = partial(ChannelOptions, ordinary_blocks=0 if compiled else math.inf)
        patch.setattr("polycnc.cnc._run_channels.ChannelOptions", options)
        run = ProgramRun(
            Machine(config),
            ProgramText.from_text(program, "part.nc"),
            load_dialect("din"),
            options=RunOptions(stands_at_stops=False),
            on_event=met,
            on_passed=passed if passes else None,
        )
    run.start()
    while run.active:
        if closed:
            run.skip()
        else:
            run.advance(37)
    last = run.reading.block
    said = None if last is None else (last.line, last.modal)
    return (run.machine.time_s, run.reading.tool_times, run.machine.setpoints, said, str(run.error)), found


@settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow])
@given(programs, st.sampled_from([TIMED, SWIFT]), st.booleans())
@example("G1 X2 F300 S20\n" + "M8\n" * 40 + "X3 M9\n" + "S3\n" * 17, SWIFT, True)
@example("M8\n" * 33 + "G1 X2 F300 S20 M5\nM0\n" + "M7\n" * 16 + "X4\n", SWIFT, False)
def test_events_that_pass_come_when_they_would_stop(
    program: str, config: MachineConfig, closed: bool
) -> None:
    met = ran(program, config, passes=False, closed=closed, compiled=False)
    for compiled in (False, True):
        assert ran(program, config, passes=True, closed=closed, compiled=compiled) == met


def test_many_events_are_columns_and_read_as_a_list() -> None:
    program = "G1 F6000\n" + "".join(f"X{n % 7}.5 S{n % 11 + 3}\n" for n in range(2600)) + "M8\n"
    result = polycnc.run(program, dialect="din")
    assert [each.word for each in result.events[2300:2303]] == ["S4", "S5", "S6"]
    assert result.events[-1] == RunEvent(result.time_s, 2602, "M8")
    assert [each.line for each in result.events] == list(range(2, 2603))
    assert all(a.time_s < b.time_s for a, b in zip(result.events[:-2], result.events[1:-1], strict=True))
    # A function as plain as all others, but after a remark, begins an operation.
    assert [each.name for each in polycnc.run(program + "(the last slot)\nS9\nX3 S8\n").operations] == [
        "",
        "the last slot",
    ]


def test_after_going_back_the_same_numbers_come_again() -> None:
    events = EventRun(np.array([3.0, 4.0, 5.0]), np.full(3, -1.0), np.full(3, -1.0), np.array([7, 8, 9]))
    pending = PendingEvents()
    pending.add_run(20, events)
    before = pending.snapshot()
    assert pending.pop(20).word == "S3"
    assert len(pending.pop_some(21, 9)) == 2  # type: ignore[arg-type]
    for is_cleared in (False, True):
        if is_cleared:
            pending.clear()
        else:
            pending.restore({})
        pending.add_run(20, events)
        assert pending.snapshot() == before
        assert pending.pop(21).word == "S4"
        with pytest.raises(KeyError):
            pending.pop(20)
        with pytest.raises(KeyError):
            pending.pop(40)
