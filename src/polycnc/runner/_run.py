"""Run or check part programs: from a file or a text to a typed result."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, overload

import numpy as np
import numpy.typing as npt

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.errors import ProgramError, UsageError
from polycnc.kernel import BLOCK
from polycnc.machine import Machine, MachineConfig, load_machine
from polycnc.nc import Dialect, Event, MAction, ProgramText, Stop, dialect_for, line_of
from polycnc.nc.macro import language_for
from polycnc.outputs import keep_inputs
from polycnc.runner._execution import (
    LOOP_LIMIT_S,
    Floats,
    Progress,
    Rows,
    TaggedRows,
    run_to_end,
    totals,
)
from polycnc.runner._operations import OperationCollector
from polycnc.runner._program_control import Surroundings, check_screen_file, control_for, root_of
from polycnc.runner._rehearsal import rehearsed
from polycnc.runner._remarks import MachiningWatch, Remark, empty_remark, times_remark
from polycnc.runner._result import Alarm, RunEvent, RunMessage, RunResult, TracedResult
from polycnc.runner._trace import TraceCollector


@dataclass(frozen=True, slots=True)
class CheckReport:
    """What is wrong with a part program, and what is no error but seldom meant."""

    errors: list[ProgramError]
    remarks: list[Remark]


_RECORD_CYCLES = 1 << 14


@overload
def run(
    program: str | Path | ProgramText,
    machine: str | Path | MachineConfig | None = None,
    dialect: str | Dialect | None = None,
    *,
    trace: Literal[True],
    servo: bool = False,
    check: bool = True,
    feed_override: float = 1.0,
    skip_levels: Iterable[int] = (),
    stop_at_m0: bool = False,
    rows: Rows | None = None,
    tagged_rows: TaggedRows | None = None,
    progress: Progress | None = None,
    root: str | Path | None = None,
    keys: Iterable[str] = (),
    screen: str | Path | None = None,
    ignore: Iterable[str] = (),
    loop_limit_s: float = LOOP_LIMIT_S,
) -> TracedResult: ...


@overload
def run(
    program: str | Path | ProgramText,
    machine: str | Path | MachineConfig | None = None,
    dialect: str | Dialect | None = None,
    *,
    trace: bool = False,
    servo: bool = False,
    check: bool = True,
    feed_override: float = 1.0,
    skip_levels: Iterable[int] = (),
    stop_at_m0: bool = False,
    rows: Rows | None = None,
    tagged_rows: TaggedRows | None = None,
    progress: Progress | None = None,
    root: str | Path | None = None,
    keys: Iterable[str] = (),
    screen: str | Path | None = None,
    ignore: Iterable[str] = (),
    loop_limit_s: float = LOOP_LIMIT_S,
) -> RunResult: ...


def run(
    program: str | Path | ProgramText,
    machine: str | Path | MachineConfig | None = None,
    dialect: str | Dialect | None = None,
    *,
    trace: bool = False,
    servo: bool = False,
    check: bool = True,
    skip_levels: Iterable[int] = (),
    stop_at_m0: bool = False,
    feed_override: float = 1.0,
    rows: Rows | None = None,
    tagged_rows: TaggedRows | None = None,
    progress: Progress | None = None,
    root: str | Path | None = None,
    keys: Iterable[str] = (),
    screen: str | Path | None = None,
    ignore: Iterable[str] = (),
    loop_limit_s: float = LOOP_LIMIT_S,
) -> RunResult:
    """Run a part program on a simulated machine and return times, lengths, extents and messages.

    `program` is a path, or the text itself if it has more than one line. `machine` is a preset, a TOML file
    or a configuration (the 3-axis mill if absent), `dialect` a name (chosen by the file's extension, else
    DIN). With `trace` the result holds one row per control cycle; `rows` gets the same in pieces,
    [cycles, columns], as it is recorded, `tagged_rows` gets with each piece the tags of its blocks and the records that
    read them. `servo` simulates the position loops. Blocks with a skip mark `/n`
    are left out for n in `skip_levels`. Program stops are passed, and told in the messages; with `stop_at_m0` the
    run ends at the first M0. `feed_override` is the operator's, up to 2. `progress` is called now and then with the
    part that is done, 0 to 1; it goes back where sub-programs repeat. `ignore` names G and M codes, like "G43.4", that
    count as if they were not there.

    Where the dialect has a language (CPL), `root` is the folder with the control's files, that of the program if
    absent; `keys` are pressed when the program asks for one, and what it has shown at the end is written to
    `screen` (.txt, .svg or .png). A loop of its statements may go round for `loop_limit_s` of the machine's time
    without a block or a WAIT; one that comes back to where it was is an error at once.

    Raises:
        ProgramError: with `check`, the program cannot be run as written; what ran before it is in `.result`.
        AlarmError: with `check`, the machine stopped.
        UsageError: no such file, machine or dialect.
    """
    if not loop_limit_s > 0.0:
        raise UsageError(f"a limit of {loop_limit_s:g} s for loops", hint="Give seconds above 0.")
    if not feed_override > 0.0:
        raise UsageError(f"a feed override of {feed_override:g}", hint="Give more than 0, up to 2.")
    text = program_text(program)
    config = load_machine(machine)
    collector = TraceCollector(config, servo) if trace else None
    sinks: list[Rows] = [] if rows is None else [rows]
    tagged = [sink for sink in (collector.add_tagged if collector else None, tagged_rows) if sink is not None]
    every_cycle = bool(sinks or tagged) or servo or _has_limit_switches(config)
    if every_cycle and progress is not None:
        sinks.append(_progress_by_line(text, progress))
    recorded = bool(sinks or tagged)
    simulated = Machine(config, servo=servo, record_cycles=_RECORD_CYCLES if recorded else 0)
    events: list[RunEvent] = []
    operations = OperationCollector(text)

    def to_all(piece: Floats, tags: npt.NDArray[np.int64]) -> None:
        for sink in sinks:
            sink(piece)
        for tagged_sink in tagged:
            tagged_sink(piece, tags, execution.channel.records)

    chosen = _dialect_of(text, dialect, ignore)
    levels = frozenset(skip_levels)
    surroundings = Surroundings(root_of(program, root), tuple(keys), levels)
    control = control_for(chosen, text, simulated, surroundings)
    if screen is not None:
        keep_inputs(
            screen, (each for each in (program, machine, dialect) if isinstance(each, str | Path)), "a screen"
        )
        check_screen_file(screen, text, control)
    execution = ProgramRun(
        simulated,
        text,
        chosen,
        language=language_for(chosen) if control is None else control.language,
        config=None if control is None else control.config,
        options=RunOptions(block_delete=levels, stands_at_stops=stop_at_m0),
        rows=to_all if recorded else None,
        on_event=lambda event: _note(event, events, operations, execution),
    )
    if feed_override != 1.0:
        execution.feed_override = feed_override
    stuck: ProgramError | None = None
    if control is None:
        run_to_end(execution, every_cycle=every_cycle, progress=None if every_cycle else progress)
    else:
        control.attach(execution)
        try:
            told = None if every_cycle else progress
            run_to_end(
                execution, every_cycle=every_cycle, control=control, progress=told, loop_limit_s=loop_limit_s
            )
        except ProgramError as error:
            stuck = error
        finally:
            control.finish()
        if screen is not None:
            control.screen.save(Path(screen))
    if (empty := empty_remark(text)) is not None:
        execution.channel.messages.note(empty.text, 0)
    if remark := times_remark(config, chosen, [event.word for event in events]):
        execution.channel.messages.note(remark, 0)
    result = _result(execution, events, operations, collector, stuck)
    if control is not None:
        result.variables.update(control.variables())
    if check:
        result.raise_for_alarms()
    return result


def check(
    program: str | Path | ProgramText,
    machine: str | Path | MachineConfig | None = None,
    dialect: str | Dialect | None = None,
    *,
    root: str | Path | None = None,
    ignore: Iterable[str] = (),
    strict: bool = False,
) -> list[ProgramError]:
    """Return every error of a part program, not only the first; an empty list if there is none.

    `ignore` names G and M codes that count as if they were not there. With `strict` the remarks of `inspect` are errors
    too.

    A program with statements of a language (CPL) is linked with the sub-programs in `root`, but not run; with `strict`
    in a copy of that folder, which finds what is wrong with the blocks that it gives.

    Raises:
        UsageError: no such file, machine or dialect.
    """
    report = inspect(program, machine, dialect, root=root, ignore=ignore, rehearse=strict)
    if not strict:
        return report.errors
    return [*report.errors, *map(_as_error, report.remarks)]


def _as_error(remark: Remark) -> ProgramError:
    return ProgramError(
        remark.text,
        code=remark.key,
        position=remark.position,
        hint="Strict checking makes this remark an error.",
    )


def inspect(
    program: str | Path | ProgramText,
    machine: str | Path | MachineConfig | None = None,
    dialect: str | Dialect | None = None,
    *,
    root: str | Path | None = None,
    ignore: Iterable[str] = (),
    rehearse: bool = True,
) -> CheckReport:
    """Return the errors of a part program as `check` does, and what a machinist would remark on it.

    Remarked are cutting with the spindle at rest or without a tool, rapids across where the part has been cut,
    program stops, and a program in which nothing stands. A program with statements of a language (CPL) that is linked
    without an error is run in a copy of `root` for that, and for errors of the blocks that it gives, unless `rehearse`
    is off or the folder is larger than 500 files or 32 MB; that, and where its run ended early, is logged.

    Raises:
        UsageError: no such file, machine or dialect.
    """
    text = program_text(program)
    simulated = Machine(load_machine(machine))
    chosen = _dialect_of(text, dialect, ignore)
    control = control_for(chosen, text, simulated, Surroundings(root_of(program, root)))
    if control is not None and control.has_statements(text):
        errors = control.check(text)
        if errors or not rehearse:
            return CheckReport(errors, [])
        return CheckReport(*rehearsed(text, simulated.config, chosen, root_of(program, root)))
    options = RunOptions(stands_at_stops=False, collect_errors=True)
    language = language_for(chosen) if control is None else control.language
    config = None if control is None else control.config
    execution = ProgramRun(simulated, text, chosen, options=options, language=language, config=config)
    if control is not None:
        control.attach(execution)
    watch = MachiningWatch(execution.channel)
    execution.channel.on_filled = watch.look
    run_to_end(execution, every_cycle=False)
    empty = empty_remark(text)
    return CheckReport(execution.channel.errors, watch.remarks if empty is None else [empty])


def _dialect_of(text: ProgramText, dialect: str | Dialect | None, ignore: Iterable[str]) -> Dialect:
    chosen = dialect_for(text.name, dialect)
    codes = tuple(ignore)
    return chosen.leaving_out(codes) if codes else chosen


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


def _note(
    event: Event, events: list[RunEvent], operations: OperationCollector, execution: ProgramRun
) -> None:
    """Keep an event of the run; say what becomes of program stops."""
    events.append(RunEvent(execution.machine.time_s, event.line, event.word))
    records = execution.channel.records
    record = records.block(event.tag)
    if record is not None and not record.stack and record.program == execution.program.name:
        code = event.word[1:].partition(" ")[0]
        action = execution.dialect.m_action(int(code)) if event.word[:1] == "M" and code.isdigit() else None
        tool = records.tool(event.tag)
        changes = action is MAction.TOOL_CHANGE or event.word[:1] == "T"
        operations.function(event.line, tool, changes, execution.machine.time_s, execution.path_times)
    if event.stop in (Stop.PROGRAM, Stop.OPTIONAL):
        what = "the run stops here" if execution.stands_at(event.stop) else "passed without stopping"
        execution.channel.messages.note(f"{event.word}: {event.stop.value}, {what}", event.line)


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
    execution: ProgramRun,
    events: list[RunEvent],
    operations: OperationCollector,
    collector: TraceCollector | None,
    stuck: ProgramError | None = None,
) -> RunResult:
    machine, channel = execution.machine, execution.channel
    config, state = machine.config, machine.state
    sums = totals(execution)
    alarms = [_program_alarm(error, machine.time_s) for error in channel.errors]
    if stuck is not None:
        alarms.append(_program_alarm(stuck, machine.time_s))
    if (alarm := execution.alarm) is not None:
        alarms.insert(0, Alarm("machine", alarm.text, alarm.code, line_of(alarm.tag), 0, machine.time_s))
    names = config.axis_names
    return (TracedResult if collector else RunResult)(
        program=execution.program.name,
        dialect=channel.dialect.name,
        machine=config.name,
        blocks=channel.blocks,
        cycles=int(state.clock[0]["cycle"]),
        time_s=machine.time_s,
        cutting_time_s=sums.feed_s,
        rapid_time_s=sums.rapid_s,
        waiting_time_s=sums.wait_s,
        cutting_path_mm=sums.feed_length,
        rapid_path_mm=sums.rapid_length,
        top_feed_mm_min=sums.top_speed * 60.0,
        axis_units={axis.name: axis.unit for axis in config.axes},
        end_position_mm={name: float(value) for name, value in zip(names, state.setpoint, strict=True)},
        extents_mm={
            name: (float(low), float(high))
            for name, low, high in zip(names, execution.feed.low, execution.feed.high, strict=True)
        },
        alarms=alarms,
        messages=[RunMessage(m.text, m.line, m.count) for m in channel.messages.all()],
        tool_times=execution.tool_times,
        operations=operations.operations(machine.time_s, execution.path_times),
        events=events,
        source=execution.program,
        config=config,
        trace=collector.trace() if collector else None,
    )
