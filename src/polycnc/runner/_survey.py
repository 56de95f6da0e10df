"""What a program does line by line: how long each block takes, its operations, and what holds before a line."""

from __future__ import annotations

from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.errors import PolycncError
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import LINE_MASK, Dialect, ModalWords, ProgramText
from polycnc.runner._event_log import EventLog
from polycnc.runner._execution import Progress, run_to_end
from polycnc.runner._operations import Operation
from polycnc.runner._program_control import Surroundings, control_for, run_under


@dataclass(frozen=True, slots=True)
class LineTime:
    """How long a line of a program takes in all, s, and how often it is executed with a motion or a wait."""

    time_s: float
    count: int


@dataclass(frozen=True, slots=True)
class Survey:
    """How long a program takes, s, its operations, and the times of its lines.

    Refused blocks are left out. `lines` has those of the program's text, with the sub-programs in it, by their number
    from 1, but those that take no time.
    """

    time_s: float
    operations: list[Operation]
    lines: dict[int, LineTime]


class _TimedMachine(Machine):
    """Note in closed form how many cycles each block takes, and how often it comes up."""

    def __init__(self, config: MachineConfig) -> None:
        super().__init__(config)
        self.cycles: Counter[int] = Counter()
        self.rounds: Counter[int] = Counter()
        self._last = -1

    def skip(self, path: int, until: int) -> int:
        """Go along a path to segment count `until` or the next event, segment by segment; return the cycles."""
        row = self.state.paths.row[path]
        base, capacity, tags = int(row["base"]), int(row["capacity"]), self.state.seg.row["tag"]
        done = 0
        while (head := int(row["head"])) < until:
            tag = int(tags[base + head % capacity])
            cycles = super().skip(path, head + 1)
            self.cycles[tag] += cycles
            self.rounds[tag] += tag != self._last  # two executions in a row have different tags
            self._last = tag
            done += cycles
            if row["event"] >= 0 or int(row["head"]) == head:
                break
        return done


def survey(
    text: ProgramText,
    config: MachineConfig,
    dialect: Dialect,
    *,
    root: Path,
    progress: Progress | None = None,
) -> Survey | None:
    """Return what a program does line by line; None for one whose statements (CPL) might change files.

    `progress` is called now and then, and may end the survey by what it raises.
    """
    machine = _TimedMachine(config)
    control = control_for(dialect, text, machine, Surroundings(root))
    if control is not None and control.has_statements(text):
        return None
    log = EventLog(text)
    run = run_under(
        control,
        machine,
        text,
        dialect,
        RunOptions(stands_at_stops=False, collect_errors=True),
        root=root,
        on_event=lambda event: log.note(event, run),
    )
    times: dict[int, LineTime] = {}

    def gather(part: float) -> None:
        _gather(machine, run, times)
        if progress is not None:
            progress(part)

    with suppress(PolycncError):  # of a program that does not end, which is for a check to tell
        run_to_end(run, every_cycle=False, progress=gather)
    _gather(machine, run, times)
    return Survey(machine.time_s, log.operations(run), times)


def _gather(machine: _TimedMachine, run: ProgramRun, times: dict[int, LineTime]) -> None:
    """Add the cycles noted so far to the lines of the program's text, while their tags can be read."""
    records, cycle_s = run.channel.records, machine.config.cycle_s
    for tag, cycles in machine.cycles.items():
        if not cycles or records.program(tag) != run.program.name:
            continue
        line = tag & LINE_MASK
        before = times.get(line, LineTime(0.0, 0))
        times[line] = LineTime(before.time_s + cycles * cycle_s, before.count + machine.rounds[tag])
    machine.cycles.clear()
    machine.rounds.clear()


def holds_before(
    text: ProgramText, line: int, config: MachineConfig, dialect: Dialect, *, root: Path
) -> tuple[ModalWords, dict[str, float]] | None:
    """Return the modal words in force before a line, and the programmed position of each axis (machine coordinates).

    None where the line is not reached by execution, in radius compensation, and for statements (CPL), which might
    change files.
    """
    machine = Machine(config)
    control = control_for(dialect, text, machine, Surroundings(root))
    if control is not None and control.has_statements(text):
        return None
    options = RunOptions(stands_at_stops=False, collect_errors=True)
    if line > options.ordinary_blocks:
        options = replace(options, ordinary_blocks=0.0)  # compiled code is worth loading, or has been
    run = run_under(control, machine, text, dialect, options, root=root)
    try:
        run.selection.search(line=line, calculate=True)
    except PolycncError:
        return None
    channel = run.channel
    position = dict(zip(config.axis_names, channel.state.modal.position.tolist(), strict=True))
    return channel.records.words(text, channel.state.snapshot()), position
