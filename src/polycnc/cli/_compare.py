"""``polycnc compare``: what two programs, or one on two machines, do differently."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from polycnc.cli import _options as options
from polycnc.cli._output import bold, bold_red, columns, print_json, progress_bar, say

if TYPE_CHECKING:
    from polycnc.runner import Comparison, PathDeviation

_SHOWN_MM = 0.00005  # what is less has no figure that is shown


def compare_command(
    a: Annotated[Path, typer.Argument(help="A program, or a trace (.csv, .npz, .parquet).", metavar="A")],
    b: Annotated[
        Path | None,
        typer.Argument(
            help="Another; absent: A once more, on --machine-b or with --dialect-b.", metavar="[B]"
        ),
    ] = None,
    machine: options.Machine = None,
    dialect: options.Dialect = None,
    machine_b: Annotated[
        str | None, typer.Option(help="The machine of B (default: that of A).", metavar="FILE|PRESET")
    ] = None,
    dialect_b: Annotated[
        str | None, typer.Option(help="The dialect of B (default: that of A).", metavar="FILE|NAME")
    ] = None,
    tolerance: Annotated[
        float,
        typer.Option(
            help="How far apart the paths may be, mm; more is exit status 1.", metavar="MM", min=0.0, max=1e6
        ),
    ] = 0.01,
    as_json: options.AsJson = False,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Write both paths as one page, an .html file.", metavar="FILE"),
    ] = None,
) -> None:
    """Compare two programs, a program and a trace, or one program on two machines."""
    from polycnc import runner

    other = a if b is None else b
    given = [Path(each) for each in (machine, dialect, machine_b, dialect_b) if each is not None]
    if output is not None:
        runner.check_view_file(output, (a, other, *given))
    with progress_bar(f"{a.name} and {other.name}") as bar:
        found = runner.compare(
            a,
            b,
            machine,
            dialect,
            machine_b=machine_b,
            dialect_b=dialect_b,
            tolerance_mm=tolerance,
            progress=bar,
        )
    if output is not None:
        found.view().save(output)
    if as_json:
        print_json(found.as_dict())
    else:
        _tell(found)
        if output is not None:
            say(f"wrote      {output}")
    sys.exit(0 if found.ok else 1)


def _tell(found: Comparison) -> None:
    for name, side in (("A", found.a), ("B", found.b)):
        say(f"{name}          {side.name}" + (f" on {side.machine}" if side.machine else ""))
    say("path       A from B " + _deviation(found.a_from_b))
    say("           B from A " + _deviation(found.b_from_a))
    if found.cuts_a_from_b is not None and found.cuts_b_from_a is not None:
        say("  cuts     A from B " + _deviation(found.cuts_a_from_b))
        say("           B from A " + _deviation(found.cuts_b_from_a))
    if found.parts_at is not None:
        (_, line_a), (_, line_b) = found.parts_at
        say(f"order      the paths part at line {line_a} of A and line {line_b} of B")
    elif found.same_order:
        say("order      the same")
    if found.tools is not None and found.tools[0] != found.tools[1]:
        for name, tools in zip("AB", found.tools, strict=True):
            say(f"tools      {name}: {', '.join(f'T{tool}' for tool in tools)}")
    if found.lone_axes:
        say(f"axes       only one machine has {', '.join(found.lone_axes)}, which move there")
    first = found.first_difference
    if first is not None:
        for name, number, text in (("A", first.line_a, first.text_a), ("B", first.line_b, first.text_b)):
            say(f"differs    {name} " + (f"line {number}: {text}" if number else "has ended"))
    for line in columns(_table(found), right=(1, 2, 3)):
        say(line)
    for name, side in (("A", found.a), ("B", found.b)):
        for alarm in side.result.alarms if side.result is not None else ():
            say(str(alarm), lead=bold_red(f"alarm in {name}: "))
    verdict = "the same" if found.ok else "not the same"
    say(lead=bold(f"{verdict} within {found.tolerance_mm:g} mm"))


def _deviation(found: PathDeviation) -> str:
    if not found.position:
        return "nothing moves"
    if found.mm == float("inf"):
        return f"nothing there to compare with, from line {found.line} on"
    if found.mm < _SHOWN_MM:
        return "0 mm"
    place = " ".join(f"{axis}{value:.3f}" for axis, value in found.position.items())
    return f"{found.mm:.4f} mm at {place}, line {found.line}, {found.time_s:.3f} s"


def _table(found: Comparison) -> list[tuple[str, str, str, str]]:
    rows = [("", "A", "B", "B - A"), _row("time [s]", found.a.time_s, found.b.time_s)]
    one, other = found.a.result, found.b.result
    if one is not None and other is not None:
        rows += [
            _row("  cutting", one.cutting_time_s, other.cutting_time_s),
            _row("  rapid", one.rapid_time_s, other.rapid_time_s),
            _row("  waiting", one.waiting_time_s, other.waiting_time_s),
        ]
        for tool in sorted(set(one.tool_times) | set(other.tool_times)):
            times = (each.tool_times.get(tool) for each in (one, other))
            a_s, b_s = (0.0 if time is None else time.cutting_s + time.rapid_s for time in times)
            rows.append(_row(f"  T{tool}", a_s, b_s))
    rows.append(_row("path [mm]", found.a.path_mm, found.b.path_mm))
    if one is not None and other is not None:
        rows.append(_row("  cutting", one.cutting_path_mm, other.cutting_path_mm))
    a_feed, b_feed = found.a.top_feed_mm_min, found.b.top_feed_mm_min
    if a_feed is not None and b_feed is not None:
        rows.append(_row("top feed [mm/min]", a_feed, b_feed))
    for axis in [axis for axis in found.a.extents_mm if axis in found.b.extents_mm]:
        (low, high), (other_low, other_high) = found.a.extents_mm[axis], found.b.extents_mm[axis]
        rows += [_row(f"{axis} lowest", low, other_low), _row(f"{axis} highest", high, other_high)]
    return rows


def _row(name: str, a: float, b: float) -> tuple[str, str, str, str]:
    return name, f"{a:,.3f}", f"{b:,.3f}", f"{b - a:+,.3f}"
