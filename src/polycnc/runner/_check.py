"""Check part programs: every error, and what a machinist would remark."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from polycnc.cnc import ProgramRun, RunOptions, let_pass
from polycnc.errors import ProgramError
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import Dialect, Language, ProgramText
from polycnc.runner._execution import Progress, run_to_end
from polycnc.runner._program_control import control_for, run_under
from polycnc.runner._rehearsal import rehearsed
from polycnc.runner._remarks import MachiningWatch, Remark, empty_remark, unread_remarks
from polycnc.runner._run import run_program
from polycnc.runner._settings import RunSettings, program_text


@dataclass(frozen=True, slots=True)
class CheckReport:
    """What is wrong with a part program, and what is no error but seldom meant."""

    errors: list[ProgramError]
    remarks: list[Remark]
    guessed: str = ""
    """The dialect and why it was guessed, like "dialect fanuc: O1000 in line 2"; empty where it was named."""


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


def errors_in(
    text: ProgramText,
    config: MachineConfig,
    dialect: Dialect,
    *,
    language: Language | None = None,
    texts: Mapping[int, ProgramText] | None = None,
    progress: Progress | None = None,
) -> list[ProgramError]:
    """Return every error of a program of NC blocks or macros on a machine of its own; sub-programs come from `texts`.

    `progress` is called now and then; what it raises ends the check.
    """
    if (endless := text.endless_line()) is not None:
        return [endless]
    options = RunOptions(stands_at_stops=False, collect_errors=True, past_refused=True)
    run = ProgramRun(
        Machine(config), text, dialect, language=language, config=config, library=(texts or {}).get,
        options=options, on_passed=let_pass,
    )  # fmt: skip
    try:
        run_to_end(run, every_cycle=False, progress=progress)
    except ProgramError as error:
        return [*run.channel.errors, error]
    return run.channel.errors


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
    stock: str | None = None,
    resolution_mm: float | None = None,
    fixtures: Iterable[str] = (),
    target: str | None = None,
    tolerance_mm: float | None = None,
    tools: str | Path | None = None,
    progress: Progress | None = None,
) -> CheckReport:
    """Return the errors of a part program as `check` does, and what a machinist would remark on it.

    Remarked are cutting with the spindle at rest or without a tool, rapids across where the part has been cut,
    program stops, and a program in which nothing stands. A program with statements of a language (CPL) that is linked
    without an error is run in a copy of `root` for that, and for errors of the blocks that it gives, unless `rehearse`
    is off or the folder is larger than 500 files or 32 MB; that, and where its run ended early, is logged. With
    `stock`, `fixtures` and `target` (as in `run`) a program without an error cuts it, and collisions are remarked too,
    feeding through air for long, and what is left on the target. `progress` is called now and then with the part that
    is done, 0 to 1, and may end the check by what it raises.

    Raises:
        UsageError: no such file, machine or dialect.
    """
    settings = RunSettings(
        machine,
        dialect,
        root=root,
        ignore=tuple(ignore),
        stock=stock,
        resolution_mm=resolution_mm,
        fixtures=tuple(fixtures),
        target=target,
        tolerance_mm=tolerance_mm,
        tools=tools,
    )
    text = program_text(program)
    read = settings.dialect_of(text)
    if read.problem is not None:
        return CheckReport([read.problem], [])
    report = _inspected(program, text, read.dialect, settings, rehearse=rehearse, progress=progress)
    return replace(report, guessed=f"dialect {read.dialect.name}: {read.reason}" if read.reason else "")


def _inspected(
    program: str | Path | ProgramText,
    text: ProgramText,
    chosen: Dialect,
    settings: RunSettings,
    *,
    rehearse: bool,
    progress: Progress | None,
) -> CheckReport:
    if (endless := text.endless_line()) is not None:
        return CheckReport([endless], [])
    config = settings.machine_of(text)
    settings = settings.with_stock_of(config)
    simulated = Machine(config)
    control = control_for(chosen, text, simulated, settings.surroundings_of(program))
    if control is not None and control.has_statements(text):
        errors = control.check(text)
        if errors or not rehearse:
            return CheckReport(errors, [])
        return CheckReport(*rehearsed(text, simulated.config, chosen, settings.root_of(program), progress))
    options = RunOptions(stands_at_stops=False, collect_errors=True, past_refused=True)
    execution = run_under(
        control, simulated, text, chosen, options, root=settings.root_of(program), on_passed=let_pass
    )
    watch = MachiningWatch(execution.channel)
    execution.channel.on_filled = watch.look
    run_to_end(execution, every_cycle=False, progress=progress)
    if (empty := empty_remark(text)) is not None:
        return CheckReport(execution.channel.errors, [empty])
    remarks = [*unread_remarks(execution.channel, text), *watch.remarks]
    if settings.stock is None or execution.channel.errors:
        return CheckReport(execution.channel.errors, remarks)
    return CheckReport([], [*remarks, *_collisions(text, settings)])


def _collisions(text: ProgramText, settings: RunSettings) -> list[Remark]:
    from polycnc.stock import NoStockError

    begin = text.line_position(1)
    try:
        machined = run_program(text, settings, check=False).machined
    except NoStockError as error:
        return [Remark("no_stock", error.what, begin)]
    if machined is None:
        return []
    unknown = [
        Remark("no_stock" if each == machined.missed else "unknown_tool", each, begin)
        for each in machined.messages[1:]
    ]
    wrong = [
        Remark(each.kind.name.lower(), str(each), each.position or begin) for each in machined.collisions
    ]
    if (left := machined.comparison) is not None and left.rest_place is not None:
        unknown.append(Remark("rest", str(left), begin))
    return unknown + wrong + [Remark("air", str(each), each.position or begin) for each in machined.idle]
