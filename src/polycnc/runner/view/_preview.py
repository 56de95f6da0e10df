"""The path of a program before it runs, as a view shows it: the points that matter, their time, line and kind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from polycnc.cnc import ProgramRun, RunOptions, let_pass
from polycnc.errors import ProgramError
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import Dialect, Language, ProgramText
from polycnc.runner._execution import Progress, run_to_end
from polycnc.runner._record import Record
from polycnc.runner.view._track import TrackCollector


@dataclass(frozen=True, slots=True)
class Preview:
    """Where a program goes: `t_s`, `positions` by axis (mm or deg), `rapid` and `line` have one entry for each point.

    `line` is that of the program's own text, 0 where a sub-program moves. `tolerance_mm` is how far the tool may be
    from the path between two points. `errors` are what cannot be read; the path goes up to the first of them.
    """

    program: str
    units: Mapping[str, str]
    time_s: float
    t_s: list[float]
    positions: dict[str, list[float]]
    rapid: list[bool]
    line: list[int]
    tolerance_mm: float
    errors: list[str]


def preview(
    text: ProgramText,
    config: MachineConfig,
    dialect: Dialect,
    *,
    language: Language | None = None,
    texts: Mapping[int, ProgramText] | None = None,
    most: int = 20_000,
    progress: Progress | None = None,
) -> Preview:
    """Run a program on a machine of its own and return its path; stops are passed, sub-programs come from `texts`.

    `progress` is called now and then; what it raises ends the run.
    """
    machine_units = {axis.name: axis.unit for axis in config.axes}
    collector = TrackCollector(tuple(machine_units.values()), most=most)
    record = Record(text, config, servo=False, rows=None, tagged=[collector.add], progress=progress)
    options = RunOptions(stands_at_stops=False, collect_errors=True)
    run = ProgramRun(
        Machine(config, record_cycles=record.cycles), text, dialect, language=language, config=config,
        library=(texts or {}).get, options=options, on_passed=let_pass,
        rows=lambda piece, tags: record.take(piece, tags, run.channel.records),
    )  # fmt: skip
    errors: list[ProgramError] = []
    try:
        run_to_end(run, every_cycle=True)
    except ProgramError as error:
        errors.append(error)
    errors = [*run.channel.errors, *errors]
    alarms = [str(run.alarm)] if run.alarm is not None and not errors else []
    execution = collector.execution()
    track = collector.track(execution)
    blocks, at = execution.blocks, track.block_at()
    own = np.array([name == text.name for name in blocks.names] or [False])
    line = (
        np.where(own[blocks.program[at]], blocks.line[at], 0) if len(blocks) else np.zeros(len(at), np.int64)
    )
    position = np.round(track.position, 4)
    return Preview(
        text.name, machine_units, run.machine.clock.now_s, np.round(track.t_s, 4).tolist(),
        {name: position[:, column].tolist() for column, name in enumerate(machine_units)},
        track.rapid.tolist(), line.tolist(), track.tolerance_mm, [*map(str, errors), *alarms],
    )  # fmt: skip
