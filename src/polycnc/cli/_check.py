"""``polycnc check``: every error of a program, not only the first, and what a machinist would remark."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from polycnc.cli import _options as options
from polycnc.cli._errors import PROGRAM, USAGE
from polycnc.cli._output import bold, bold_red, print_json, say, say_problem
from polycnc.cli._programs import read_program
from polycnc.errors import SourcePosition, UsageError

if TYPE_CHECKING:
    from polycnc.errors import ProgramError
    from polycnc.runner import CheckReport


@dataclass
class _Findings:
    """What has been found in all programs; `unreadable` says why a file could not be read."""

    reports: dict[str, CheckReport] = field(default_factory=dict)
    unreadable: dict[str, UsageError] = field(default_factory=dict)

    @property
    def errors(self) -> int:
        return sum(len(report.errors) for report in self.reports.values()) + len(self.unreadable)

    @property
    def remarks(self) -> int:
        return sum(len(report.remarks) for report in self.reports.values())


def check_command(
    programs: options.Programs,
    machine: options.Machine = None,
    dialect: options.Dialect = None,
    strict: options.Strict = False,
    ignore: options.Ignore = None,
    root: options.Root = None,
    stock: options.Stock = None,
    resolution: options.Resolution = None,
    fixture: options.Fixtures = None,
    target: options.Target = None,
    tolerance: options.Tolerance = None,
    tools: options.Tools = None,
    as_json: options.AsJson = False,
) -> None:
    """Report every error of part programs, each with its place and what to do, and remarks on the machining."""
    from polycnc import runner
    from polycnc.machine import load_machine
    from polycnc.nc import load_dialect

    load_machine(machine)
    if dialect is not None:
        load_dialect(dialect)
    found = _Findings()
    for program in programs:
        try:
            text = read_program(program)
        except UsageError as error:
            found.unreadable[str(program)] = error
            continue
        found.reports[text.name] = runner.inspect(
            text,
            machine,
            dialect,
            root=root,
            ignore=options.codes_of(ignore),
            **options.body_of(stock, resolution, fixture, target, tolerance, tools),
        )
    if as_json:
        print_json(_as_dict(found, strict))
    else:
        _print(found, strict)
    if found.unreadable:
        sys.exit(USAGE)
    sys.exit(PROGRAM if found.errors or (strict and found.remarks) else 0)


def _print(found: _Findings, strict: bool) -> None:
    from polycnc.runner import counted

    for name, report in found.reports.items():
        for error in report.errors:
            say_problem(str(error))
        for remark in report.remarks:
            say_problem(str(remark), lead=bold_red("error: ") if strict else "remark: ")
        if not report.errors and not (strict and report.remarks):
            say(f"{name}: no errors" + (f" ({report.guessed})" if report.guessed else ""))
        elif report.guessed:
            say(f"{name}: {report.guessed}")
    for unreadable in found.unreadable.values():
        say_problem(str(unreadable), lead=bold_red("error: "), error=True)
    total = found.errors + (found.remarks if strict else 0)
    if total:
        say(lead=bold(counted(total, "error")))


def _as_dict(found: _Findings, strict: bool) -> dict[str, Any]:
    return {
        "errors": found.errors + (found.remarks if strict else 0),
        "programs": {
            name: [_plain(error) for error in report.errors] for name, report in found.reports.items()
        },
        "remarks": {
            name: [
                {"text": each.text, "code": each.key, "count": each.count, **_place(each.position)}
                for each in report.remarks
            ]
            for name, report in found.reports.items()
        },
        "guessed": {name: report.guessed for name, report in found.reports.items() if report.guessed},
        "unreadable": {name: {"text": e.what, "hint": e.hint} for name, e in found.unreadable.items()},
    }


def _plain(error: ProgramError) -> dict[str, Any]:
    return {"text": error.what, "hint": error.hint, "code": error.code, **_place(error.position)}


def _place(at: SourcePosition | None) -> dict[str, Any]:
    return {"file": at.file if at else "", "line": at.line if at else 0, "column": at.column if at else 0}
