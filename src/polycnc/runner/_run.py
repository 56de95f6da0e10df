"""Run part programs: from a file or a text to a typed result."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal, overload

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.errors import ProgramError
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import Dialect, KeepingLanguage, ProgramText, line_of
from polycnc.outputs import complete_or_absent
from polycnc.runner._event_log import EventLog
from polycnc.runner._execution import LOOP_LIMIT_S, Progress, Rows, TaggedRows, run_to_end, totals
from polycnc.runner._outcome import Alarm, RunMessage
from polycnc.runner._program_control import control_for, run_under
from polycnc.runner._record import Record
from polycnc.runner._remarks import added_axes_remark, empty_remark, times_remark
from polycnc.runner._result import RunResult, TracedResult
from polycnc.runner._settings import RunSettings, program_text
from polycnc.runner._trace import TraceCollector

if TYPE_CHECKING:
    from polycnc.controllers.bosch import ChannelHost
    from polycnc.runner._machining import MachiningCollector
    from polycnc.stock import Body, Form


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
    stock: str | Body | None = None,
    resolution_mm: float | None = None,
    fixtures: Iterable[str] = (),
    target: str | None = None,
    tolerance_mm: float | None = None,
    tools: str | Path | None = None,
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
    stock: str | Body | None = None,
    resolution_mm: float | None = None,
    fixtures: Iterable[str] = (),
    target: str | None = None,
    tolerance_mm: float | None = None,
    tools: str | Path | None = None,
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
    stock: str | Body | None = None,
    resolution_mm: float | None = None,
    fixtures: Iterable[str] = (),
    target: str | None = None,
    tolerance_mm: float | None = None,
    tools: str | Path | None = None,
) -> RunResult:
    """Run a part program on a simulated machine and return times, lengths, extents and messages.

    `program` is a path, or the text itself if it has more than one line. `machine` is a preset, a TOML file or a
    configuration (if absent the 3-axis mill, or a lathe where the dialect is one of lathes), `dialect` a name (chosen
    by what the program says and its extension; `guessed` in the result says why). With `trace` the result holds one
    row per control cycle; `rows` gets the same in pieces, [cycles, columns], as it is recorded, `tagged_rows` gets
    with each piece the tags of its blocks and the records that read them. `servo` simulates the position loops.
    Blocks with a skip mark `/n` are left out for n in `skip_levels`. Program stops are passed, and told in the
    messages; with `stop_at_m0` the run ends at the first M0. `feed_override` is the operator's, up to 2. `progress`
    is called now and then with the part that is done, 0 to 1; it goes back where sub-programs repeat. `ignore` names
    G and M codes, like "G43.4", that count as if they were not there.

    Where the dialect has a language (CPL), `root` is the folder with the control's files, that of the program if
    absent; `keys` are pressed when the program asks for one, and what it has shown at the end is written to
    `screen` (.txt, .svg or .png). A loop of its statements may go round for `loop_limit_s` of the machine's time
    without a block or a WAIT; one that comes back to where it was is an error at once.

    With `stock` the tools cut a body: `auto`, `box=X0,Y0,Z0,X1,Y1,Z1`, `cylinder=D,Z0,Z1` (mm, work coordinates), an
    STL file, in cells of `resolution_mm`, or the body that a run before left (`result.stock`, which stays as it is).
    `fixtures` are boxes and STL files that nothing may touch, `target` is the STL file of what is to come out, within
    `tolerance_mm` (0.02 mm if absent). What is left, what was removed and what went wrong are in the result: `stock`,
    `removed_mm3`, `collisions`, `machined`. A machine file may say what is cut, and what holds it, where these
    arguments do not. `tools` is a tool table of LinuxCNC (.tbl) or a list (.csv) whose tools replace the machine's.

    Raises:
        ProgramError: with `check`, the program cannot be run as written; what ran before it is in `.result`.
        AlarmError: with `check`, the machine stopped.
        UsageError: no such file, machine or dialect.
    """
    settings = RunSettings(
        machine,
        dialect,
        servo=servo,
        skip_levels=frozenset(skip_levels),
        stop_at_m0=stop_at_m0,
        feed_override=feed_override,
        root=root,
        keys=tuple(keys),
        screen=screen,
        ignore=tuple(ignore),
        loop_limit_s=loop_limit_s,
        stock=stock,
        resolution_mm=resolution_mm,
        fixtures=tuple(fixtures),
        target=target,
        tolerance_mm=tolerance_mm,
        tools=tools,
    )
    return run_program(
        program, settings, trace=trace, check=check, rows=rows, tagged_rows=tagged_rows, progress=progress
    )


def run_program(
    program: str | Path | ProgramText,
    settings: RunSettings,
    *,
    trace: bool = False,
    check: bool = True,
    rows: Rows | None = None,
    tagged_rows: TaggedRows | None = None,
    progress: Progress | None = None,
) -> RunResult:
    """Run a part program as `run` does, with settings that serve many programs.

    Raises:
        ProgramError: with `check`, the program cannot be run as written; what ran before it is in `.result`.
        AlarmError: with `check`, the machine stopped.
        UsageError: no such file, machine or dialect.
    """
    text = program_text(program)
    config = settings.machine_of(text)
    settings = settings.with_stock_of(config)
    collector = TraceCollector(config, settings.servo) if trace else None
    tagged = [sink for sink in (collector.add_tagged if collector else None, tagged_rows) if sink is not None]
    form, machining = settings.form(), None
    if form is not None:
        from polycnc.runner._machining import MachiningCollector

        machining = MachiningCollector(config)
        tagged.append(machining.add)
    record = Record(text, config, servo=settings.servo, rows=rows, tagged=tagged, progress=progress)
    simulated = Machine(config, servo=settings.servo, record_cycles=record.cycles)
    dialect = (chosen := settings.dialect_of(text)).dialect
    control = control_for(dialect, text, simulated, settings.surroundings_of(program))
    settings.check_screen(program, text, control)
    settings.check_parameters(program, dialect)
    log = EventLog(text)
    options = RunOptions(
        block_delete=settings.skip_levels,
        stands_at_stops=settings.stop_at_m0,
        collect_errors=settings.past_errors,
        mark_refused=settings.past_errors,
    )
    execution = run_under(
        control,
        simulated,
        text,
        dialect,
        options,
        root=settings.root_of(program),
        rows=(lambda piece, tags: record.take(piece, tags, execution.channel.records))
        if record.is_wanted
        else None,
        on_event=lambda event: log.note(event, execution),
        on_passed=lambda passed: log.note_passed(passed, execution),
    )
    stuck = chosen.problem or _kept(execution, _to_end(execution, control, settings, record), settings)
    added = added_axes_remark(config) if settings.machine is None else ""
    _remark(execution, text, added, times_remark(config, dialect, log.counts))
    result = replace(
        _result(execution, log, collector, stuck), guessed=chosen.reason, refused_s=log.refused_s
    )
    if form is not None and machining is not None:
        result = _with_stock(result, machining, form)
    if control is not None:
        result.variables.update(control.variables())
    if check:
        result.raise_for_alarms()
    return result


def _with_stock(result: RunResult, machining: MachiningCollector, form: Form) -> RunResult:
    """Return a result with what was cut; after an alarm before the first cut without."""
    from polycnc.stock import NoStockError

    try:
        machined = machining.machined(form)
    except NoStockError as error:
        if result.ok:
            raise
        return replace(result, messages=[*result.messages, RunMessage(error.what, 0, 1)])
    notes = [RunMessage(text, 0, 1) for text in machined.messages]
    return replace(result, machined=machined, messages=[*result.messages, *notes])


def _remark(execution: ProgramRun, text: ProgramText, *remarks: str) -> None:
    """Note what is to be said of the whole program: that it is empty, and of a machine that nobody has named."""
    messages = execution.channel.messages
    if (empty := empty_remark(text)) is not None:
        messages.note(empty.text, 0)
    for each in filter(None, remarks):
        messages.note(each, 0)


def _to_end(
    execution: ProgramRun, control: ChannelHost | None, settings: RunSettings, record: Record
) -> ProgramError | None:
    """Run a program to its end; return the error of one that waits or loops without end."""
    if settings.feed_override != 1.0:
        execution.overrides.feed = settings.feed_override
    if control is None:
        run_to_end(execution, every_cycle=record.every_cycle, progress=record.asked)
        return None
    stuck: ProgramError | None = None
    try:
        run_to_end(
            execution,
            every_cycle=record.every_cycle,
            control=control,
            progress=record.asked,
            loop_limit_s=settings.loop_limit_s,
        )
    except ProgramError as error:
        stuck = error
    finally:
        control.finish()
    if settings.screen is not None:
        control.screen.save(Path(settings.screen))
    return stuck


def _kept(execution: ProgramRun, stuck: ProgramError | None, settings: RunSettings) -> ProgramError | None:
    """Write the parameters that outlive the program where that was asked for; return the error that ended it."""
    if settings.save_parameters is not None and isinstance(execution.language, KeepingLanguage):
        with complete_or_absent(Path(settings.save_parameters)) as file:
            file.write_text(execution.language.kept_text(), encoding="ascii")
    return stuck


def _program_alarm(error: ProgramError, time_s: float) -> Alarm:
    file, line, column = (at.file, at.line, at.column) if (at := error.position) else ("", 0, 0)
    return Alarm("program", error.what, error.code, line, column, time_s, file, error.hint, error)


def _result(
    execution: ProgramRun, log: EventLog, collector: TraceCollector | None, stuck: ProgramError | None
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
        tool_times=execution.reading.tool_times,
        operations=log.operations(execution),
        events=log.events(),
        source=execution.program,
        config=config,
        trace=collector.trace() if collector else None,
    )
