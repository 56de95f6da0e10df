"""``polycnc run``: a program in, timed motion out."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from polycnc.cli._output import console, duration, print_json, progress_bar, say_if_cold

if TYPE_CHECKING:
    from polycnc.runner import RunResult

MACHINE = typer.Option(
    "--machine", "-m", help="Preset or TOML file of the machine (default: mill3).", metavar="FILE|PRESET"
)
DIALECT = typer.Option(
    "--dialect", "-d", help="Dialect of the program: din, fanuc, bosch or a TOML file.", metavar="D"
)


def run_command(
    program: Annotated[Path, typer.Argument(help="Part program.", metavar="PROGRAM")],
    machine: Annotated[str | None, MACHINE] = None,
    dialect: Annotated[str | None, DIALECT] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of the summary.")
    ] = False,
    trace: Annotated[
        Path | None,
        typer.Option(
            "--trace", help="Write one row per control cycle to F.csv, F.npz or F.parquet.", metavar="F"
        ),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option("--plot", help="Draw path and speed to F.png or F.svg.", metavar="F")
    ] = None,
    servo: Annotated[
        bool, typer.Option("--servo", help="Simulate the position loops, not only the setpoints.")
    ] = False,
    skip: Annotated[
        list[int] | None,
        typer.Option("--skip", help="Leave out blocks marked /n (/ alone is level 1).", metavar="N"),
    ] = None,
) -> None:
    """Run a part program on a simulated machine and say how long it takes and where it goes."""
    say_if_cold()
    from polycnc import runner
    from polycnc.machine import load_machine

    config = load_machine(machine)
    with ExitStack() as stack:
        sinks = []
        if trace is not None:
            sinks.append(stack.enter_context(runner.TraceWriter(trace, config, servo)).add)
        picture = runner.PlotCollector(config) if plot is not None else None
        if picture is not None:
            sinks.append(picture.add)
        bar = stack.enter_context(progress_bar(program.name, quiet=as_json))

        def rows(piece: runner.Rows) -> None:
            for sink in sinks:
                sink(piece)

        result = runner.run(
            program,
            config,
            dialect,
            servo=servo,
            check=False,
            skip_levels=skip or (),
            rows=rows if sinks else None,
            progress=bar,
        )
    if picture is not None and plot is not None:
        runner.plot(picture.with_trace(result), plot)
    if as_json:
        print_json(result.as_dict())
    else:
        _summary(result)
        for path in (trace, plot):
            if path is not None:
                console().print(f"wrote {path}", highlight=False)
    sys.exit(0 if result.ok else 1)


def _summary(result: RunResult) -> None:
    from rich.markup import escape
    from rich.table import Table

    out = console()
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    table.add_column(style="dim")
    table.add_column()
    table.add_row(
        "program", f"{escape(result.program)}  ({result.blocks:,} blocks, dialect {result.dialect})"
    )
    table.add_row("machine", escape(result.machine))
    table.add_row("time", f"[bold]{duration(result.time_s)}[/]")
    table.add_row("  cutting", f"{duration(result.cutting_time_s)}   {result.cutting_path_mm:,.3f} mm")
    table.add_row("  rapid", f"{duration(result.rapid_time_s)}   {result.rapid_path_mm:,.3f} mm")
    if result.waiting_time_s:
        table.add_row("  waiting", duration(result.waiting_time_s))
    table.add_row("highest feed", f"{result.top_feed_mm_min:,.1f} mm/min")
    for axis, (low, high) in result.extents_mm.items():
        table.add_row(f"extent {axis}", f"{low:12.3f} … {high:.3f}   end {result.end_position_mm[axis]:.3f}")
    for message in result.messages:
        times = f" ({message.count} times)" if message.count > 1 else ""
        table.add_row("message", f"line {message.line}: {escape(message.text)}{times}")
    out.print(table, highlight=False)
    for alarm in result.alarms:
        out.print(f"[bold red]alarm:[/] {escape(alarm.text)}", highlight=False)
