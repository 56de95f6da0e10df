"""One program of a batch: what is to be run, and what came out, as plain values that travel between processes.

A report is a pure function of its job: program, machine, dialect and options alone make it, wherever it is run.
"""

from __future__ import annotations

import json
import shutil
import tempfile
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from polycnc.errors import PolycncError, UsageError
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect, ProgramText, choose_dialect
from polycnc.runner._blocks import Execution
from polycnc.runner._check import check
from polycnc.runner._result import RunResult
from polycnc.runner._run import run_program
from polycnc.runner._settings import RunSettings, machine_for
from polycnc.runner.batches._thumbnail import thumbnail
from polycnc.runner.view import TrackCollector

_SLOWEST = 5
_THUMBNAIL_POINTS = 2_000
_MOST_ERRORS = 50  # of one program; the rest is counted


@dataclass(frozen=True, slots=True)
class Setup:
    """On what programs are run, and how: one for each combination of a sweep.

    With `detail` a report has the slowest blocks and a picture of the path, for which every cycle is looked at. With
    `stock` (no file) the tools cut it beside `fixtures`. Programs of lathes run on `lathe`, where no machine was named.
    """

    machine: MachineConfig
    dialect: str | Dialect | None = None
    override_percent: float = 100.0
    check_only: bool = False
    detail: bool = False
    stock: str | None = None
    resolution_mm: float | None = None
    fixtures: tuple[str, ...] = ()
    lathe: MachineConfig | None = None

    def of(self, job: Job) -> Setup:
        """Return the setup with the machine for a program."""
        if self.lathe is None:
            return self
        try:
            text = ProgramText(job.name, job.content)
            dialect = choose_dialect(text, self.dialect).dialect
        except UsageError:  # the program cannot be read, as its report says
            return self
        machine = self.lathe
        if not dialect.diameter_axes:
            machine = machine_for(None, dialect, text).model_copy(update={"path": self.machine.path})
        return replace(self, machine=machine, lathe=None)


@dataclass(frozen=True, slots=True)
class Job:
    """A program and the number of its setup; `root` is the folder of the control's files where it needs one."""

    key: str
    name: str
    content: bytes
    setup: int
    root: str | None = None


@dataclass(slots=True)
class ProgramReport:
    """Say how one program of a batch ran.

    `status` is "ok", "error", "time-out", "memory" (it needed more than it may), or "lost" (its process ended again and
    again). Times (s) and lengths (mm) are None where it was only checked or did not come to a result. `tools` are rows
    of tool, cutting and rapid time, `extents` rows of axis, lowest and highest position, `slowest` rows of line, text
    and time.
    """

    program: str
    machine: str
    dialect: str = ""
    override_percent: float = 100.0
    tolerance_mm: float | None = 0.0
    status: str = "ok"
    time_s: float | None = None
    cutting_time_s: float | None = None
    rapid_time_s: float | None = None
    waiting_time_s: float | None = None
    path_mm: float | None = None
    cutting_path_mm: float | None = None
    top_feed_mm_min: float | None = None
    blocks: int | None = None
    cycles: int | None = None
    removed_mm3: float | None = None
    errors: list[str] = field(default_factory=list)
    messages: list[str] = field(default_factory=list)
    tools: list[tuple[int, float, float]] = field(default_factory=list)
    extents: list[tuple[str, float, float]] = field(default_factory=list)
    slowest: list[tuple[int, str, float]] = field(default_factory=list)
    thumbnail: tuple[str, str] | None = None
    """Paths of the cuts and of the rapids as SVG path data, in a box of 96 x 64."""

    @property
    def ok(self) -> bool:
        """Whether the program has no error and ran to its end."""
        return self.status == "ok"

    def as_dict(self) -> dict[str, Any]:
        """Return plain data."""
        return {"ok": self.ok, **asdict(self)}


class Answer(NamedTuple):
    """A report as it travels and is kept: its status, and the report as JSON."""

    status: str
    text: str

    @property
    def ok(self) -> bool:
        """Whether the program has no error and ran to its end."""
        return self.status == "ok"


_FIELDS = tuple(each.name for each in fields(ProgramReport))
_TUPLES = ("tools", "extents", "slowest")


def answer_of(report: ProgramReport) -> Answer:
    """Return a report as it is kept."""
    data = {name: getattr(report, name) for name in _FIELDS}
    return Answer(report.status, json.dumps(data, separators=(",", ":")))


def report_in(text: str) -> ProgramReport:
    """Return the report that was kept."""
    data: dict[str, Any] = json.loads(text)
    for name in _TUPLES:
        data[name] = [tuple(row) for row in data[name]]
    if data["thumbnail"] is not None:
        data["thumbnail"] = tuple(data["thumbnail"])
    return ProgramReport(**data)


def blank_report(job: Job, setup: Setup, status: str, *errors: str) -> ProgramReport:
    """Return the report of a program that gave no result."""
    setup = setup.of(job)
    tolerance = setup.machine.path.path_tolerance_mm
    return ProgramReport(
        job.name,
        setup.machine.name,
        override_percent=setup.override_percent,
        tolerance_mm=None if tolerance == "free" else tolerance,
        status=status,
        errors=list(errors),
    )


def report_of(job: Job, setup: Setup) -> ProgramReport:
    """Run or check a program; whatever is wrong with it is in the report."""
    try:
        if job.root is None:
            return _report(job, setup, None)
        with tempfile.TemporaryDirectory(prefix="polycnc-") as folder:  # what the program writes stays here
            root = Path(folder) / "root"
            shutil.copytree(job.root, root)
            return _report(job, setup, root)
    except MemoryError:
        raise
    except PolycncError as error:
        return blank_report(job, setup, "error", str(error))
    except Exception as error:  # one broken program stops nothing, whatever it has found
        return blank_report(job, setup, "error", f"polycnc failed on it: {type(error).__name__}: {error}")


def _report(job: Job, setup: Setup, root: Path | None) -> ProgramReport:
    from polycnc.stock import NoStockError

    text, setup = ProgramText(job.name, job.content), setup.of(job)
    report = blank_report(job, setup, "ok")
    if setup.check_only:
        found = check(text, setup.machine, setup.dialect, root=root)
        report.errors = _bounded([str(error) for error in found])
        report.status = "error" if found else "ok"
        return report
    collector = None
    if setup.detail:
        units = tuple(axis.unit for axis in setup.machine.axes)
        collector = TrackCollector(units, most=_THUMBNAIL_POINTS)
    override = setup.override_percent / 100.0
    settings = RunSettings(
        setup.machine,
        setup.dialect,
        feed_override=override,
        root=root,
        stock=setup.stock,
        resolution_mm=setup.resolution_mm,
        fixtures=setup.fixtures,
    )
    tagged = None if collector is None else collector.add
    try:
        result = run_program(text, settings, check=False, tagged_rows=tagged)
    except NoStockError as error:  # that is no fault of the program
        report = _report(job, _without_stock(setup), root)
        report.messages.append(error.what)
        return report
    _fill(report, result)
    if collector is not None:
        execution = collector.execution()
        report.slowest = _slowest(result, execution)
        report.thumbnail = thumbnail(collector.track(execution), setup.machine)
    return report


def _without_stock(setup: Setup) -> Setup:
    machine = setup.machine.model_copy(update={"stock": None, "fixtures": ()})
    return replace(setup, machine=machine, stock=None, resolution_mm=None, fixtures=())


def _fill(report: ProgramReport, result: RunResult) -> None:
    report.dialect = result.dialect
    report.status = "ok" if result.ok and not result.collisions else "error"
    report.time_s = result.time_s
    report.cutting_time_s = result.cutting_time_s
    report.rapid_time_s = result.rapid_time_s
    report.waiting_time_s = result.waiting_time_s
    report.path_mm = result.path_mm
    report.cutting_path_mm = result.cutting_path_mm
    report.top_feed_mm_min = result.top_feed_mm_min
    report.blocks = result.blocks
    report.cycles = result.cycles
    collisions = [
        str(each) if each.position is None else f"{each.position}: {each}" for each in result.collisions
    ]
    report.errors = _bounded([*(str(alarm) for alarm in result.alarms), *collisions])
    report.removed_mm3 = None if result.machined is None else result.removed_mm3
    report.messages = [
        (f"line {each.line}: " if each.line else "")
        + each.text
        + (f" ({each.count} times)" if each.count > 1 else "")
        for each in result.messages
    ]
    report.tools = [(tool, each.cutting_s, each.rapid_s) for tool, each in sorted(result.tool_times.items())]
    report.extents = [(axis, low, high) for axis, (low, high) in result.extents_mm.items()]


def _bounded(errors: list[str]) -> list[str]:
    if len(errors) <= _MOST_ERRORS:
        return errors
    return [*errors[:_MOST_ERRORS], f"and {len(errors) - _MOST_ERRORS:,} more errors"]


def _slowest(result: RunResult, execution: Execution) -> list[tuple[int, str, float]]:
    """Return the blocks that took longest, all their executions together; each with its program's text."""
    if not len(execution.start):
        return []
    cycles = np.diff(execution.start, append=result.cycles)
    counts = np.bincount(execution.number, weights=cycles, minlength=len(execution.blocks))
    times_s = counts * (result.time_s / max(result.cycles, 1))
    found = []
    for number in np.argsort(-times_s, kind="stable")[:_SLOWEST].tolist():
        block = execution.blocks[number]
        text = execution.texts.get(block.program)
        shown = "" if text is None or not block.line else text.line(text.line_start(block.line)).strip()[:120]
        found.append((block.line, shown, float(times_s[number])))
    return found
