"""The view of a program, run for it in memory that does not grow with the length of the run."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from polycnc.machine import MachineConfig
from polycnc.nc import Dialect, ProgramText
from polycnc.runner._execution import Progress
from polycnc.runner._run import run_program
from polycnc.runner._settings import RunSettings, program_text
from polycnc.runner.view._page import page
from polycnc.runner.view._rest import rest_of
from polycnc.runner.view._track import TrackCollector
from polycnc.runner.view._view import View, files_of


def view_program(
    program: str | Path | ProgramText,
    machine: str | Path | MachineConfig | None = None,
    dialect: str | Dialect | None = None,
    *,
    skip_levels: Iterable[int] = (),
    inch: bool | None = None,
    stock: str | None = None,
    resolution_mm: float | None = None,
    tools: str | Path | None = None,
    progress: Progress | None = None,
) -> View:
    """Run a program and return its view, in memory that does not grow with the length of the run.

    Alarms are in the view and in its `result`; after one the rest that can be read is drawn grey. Arguments are those
    of `run`. Lengths are shown in inches or not (`inch`), as the program has them if that is None.

    Raises:
        UsageError: no such file, machine or dialect.
    """
    text = program_text(program)
    settings = RunSettings(
        machine,
        dialect,
        skip_levels=frozenset(skip_levels),
        stock=stock,
        resolution_mm=resolution_mm,
        tools=tools,
    )
    config = settings.machine_of(text)
    collector = TrackCollector(tuple(axis.unit for axis in config.axes), laser=config)
    result = run_program(text, settings, check=False, tagged_rows=collector.add, progress=progress)
    execution = collector.execution()
    axes = tuple((axis.name, axis.unit) for axis in config.axes)
    rest = rest_of(text, settings, result)
    shown = page(result, axes, collector.track(execution), execution.texts, inch=inch, rest=rest)
    given = (Path(each) for each in (machine, dialect) if isinstance(each, str | Path))
    return View(shown, result, (*files_of(execution.texts, text), *given))
