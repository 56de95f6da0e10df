"""Run or check part programs: from a file or a text to a typed result."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.errors import ProgramError, UsageError
from polycnc.kernel import BLOCK
from polycnc.machine import Machine, MachineConfig, load_machine
from polycnc.nc import Channel, Dialect, ProgramText, dialect_for
from polycnc.runner._execution import Execution, Progress, Rows
from polycnc.runner._result import Alarm, RunMessage, RunResult
from polycnc.runner._trace import TraceCollector

_RECORD_CYCLES = 1 << 14


def run(
    program: str | Path | ProgramText,
    machine: str | Path | MachineConfig | None = None,
    dialect: str | Dialect | None = None,
    *,
    trace: bool = False,
    servo: bool = False,
    check: bool = True,
    skip_levels: Iterable[int] = (),
    rows: Rows | None = None,
    progress: Progress | None = None,
) -> RunResult:
    """Run a part program on a simulated machine and return times, lengths, extents and messages.

    `program` is a path, or the text itself if it has more than one line. `machine` is a preset, a TOML file
    or a configuration (the 3-axis mill if absent), `dialect` a name (chosen by the file's extension, else
    DIN). With `trace` the result holds one row per control cycle; `rows` gets the same in pieces,
    [cycles, columns], as it is recorded. `servo` simulates the position loops. Blocks with a skip mark `/n`
    are left out for n in `skip_levels`. `progress` is called now and then with the part that is done, 0 to 1;
    it goes back where sub-programs repeat.

    Raises:
        ProgramError: with `check`, the program cannot be run as written; what ran before it is in `.result`.
        AlarmError: with `check`, the machine stopped.
        UsageError: no such file, machine or dialect.
    """
    text = program_text(program)
    config = load_machine(machine)
    collector = TraceCollector(config, servo) if trace else None
    sinks = [sink for sink in (collector.add if collector else None, rows) if sink is not None]
    every_cycle = bool(sinks) or servo or _has_limit_switches(config)
    if every_cycle and progress is not None:
        sinks.append(_progress_by_line(text, progress))
    simulated = Machine(config, servo=servo, record_cycles=_RECORD_CYCLES if sinks else 0)
    channel = Channel(text, dialect_for(text.name, dialect), simulated, skip_levels=frozenset(skip_levels))
    execution = Execution(
        simulated,
        channel,
        rows=_to_all(sinks) if sinks else None,
        progress=None if every_cycle else progress,
        every_cycle=every_cycle,
    )
    execution.run()
    result = _result(text, config, channel, execution, collector)
    if check:
        result.raise_for_alarms()
    return result


def check(
    program: str | Path | ProgramText,
    machine: str | Path | MachineConfig | None = None,
    dialect: str | Dialect | None = None,
) -> list[ProgramError]:
    """Return every error of a part program, not only the first; an empty list if there is none.

    Raises:
        UsageError: no such file, machine or dialect.
    """
    text = program_text(program)
    simulated = Machine(load_machine(machine))
    channel = Channel(text, dialect_for(text.name, dialect), simulated, collect_errors=True)
    Execution(simulated, channel).run()
    return channel.errors


def program_text(program: str | Path | ProgramText) -> ProgramText:
    """Return a program from a path, or from a text of several lines."""
    if isinstance(program, ProgramText):
        return program
    if isinstance(program, str) and ("\n" in program or "\r" in program):
        return ProgramText.from_text(program)
    try:
        return ProgramText.from_path(program)
    except UsageError as error:
        if isinstance(program, str) and " " in program:
            error.hint = "Check the name and the folder; a program text needs a newline at its end."
        raise


def _to_all(sinks: list[Rows]) -> Rows:
    if len(sinks) == 1:
        return sinks[0]

    def to_all(rows: npt.NDArray[np.float64]) -> None:
        for sink in sinks:
            sink(rows)

    return to_all


def _progress_by_line(text: ProgramText, progress: Progress) -> Rows:
    """Return a sink that tells how far the line of the last row is into the program."""
    lines = max(text.content.count(b"\n"), text.content.count(b"\r"), 1)

    def tell(rows: npt.NDArray[np.float64]) -> None:
        progress(min(float(rows[-1, BLOCK]) / lines, 1.0))

    return tell


def _has_limit_switches(config: MachineConfig) -> bool:
    return any(
        limit not in (float("inf"), float("-inf")) for axis in config.axes for limit in axis.limit_switches
    )


def _program_alarm(error: ProgramError, time_s: float) -> Alarm:
    file, line, column = (at.file, at.line, at.column) if (at := error.position) else ("", 0, 0)
    return Alarm("program", error.what, error.code, line, column, time_s, file, error.hint, error)


def _result(
    text: ProgramText,
    config: MachineConfig,
    channel: Channel,
    execution: Execution,
    collector: TraceCollector | None,
) -> RunResult:
    state = execution.machine.state
    totals = execution.totals()
    alarms = [_program_alarm(error, execution.machine.time_s) for error in channel.errors]
    if execution.alarm is not None:
        alarms.insert(0, execution.alarm)
    names = config.axis_names
    return RunResult(
        program=text.name,
        dialect=channel.dialect.name,
        machine=config.name,
        blocks=channel.blocks,
        cycles=int(state.clock[0]["cycle"]),
        time_s=execution.machine.time_s,
        cutting_time_s=totals.feed_s,
        rapid_time_s=totals.rapid_s,
        waiting_time_s=totals.wait_s,
        cutting_path_mm=totals.feed_length,
        rapid_path_mm=totals.rapid_length,
        top_feed_mm_min=totals.top_speed * 60.0,
        axis_units={axis.name: axis.unit for axis in config.axes},
        end_position_mm={name: float(value) for name, value in zip(names, state.setpoint, strict=True)},
        extents_mm={
            name: (float(low), float(high))
            for name, low, high in zip(names, execution.low, execution.high, strict=True)
        },
        alarms=alarms,
        messages=[RunMessage(m.text, m.line, m.count) for m in channel.messages.all()],
        events=execution.events,
        trace=collector.trace() if collector else None,
    )
