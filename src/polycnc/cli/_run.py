"""``polycnc run``: a program in, timed motion out."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from polycnc.cli._output import bold, bold_red, columns, print_json, progress_bar, say, say_error

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from polycnc.machine import MachineConfig
    from polycnc.runner import RunResult

    Floats = npt.NDArray[np.float64]

MACHINE = typer.Option(
    "--machine", "-m", help="The machine: a preset or a TOML file (default: mill3).", metavar="FILE|PRESET"
)
DIALECT = typer.Option(
    "--dialect",
    "-d",
    help="The dialect: din, fanuc, bosch or a TOML file (default: by the program's extension, else din).",
    metavar="FILE|NAME",
)
ROOT = typer.Option(
    "--root",
    help="The control's folder: sub-programs, files and permanent variables (default: the program's).",
    metavar="DIR",
)
IGNORE = typer.Option(
    "--ignore",
    help="Codes that count as if they were not there, like G43.4,M198; each is named in the messages.",
    metavar="CODE,...",
)
_NUMBERS = (1, 2, 3)


def codes_of(texts: list[str] | None) -> list[str]:
    """Return the codes of all --ignore options."""
    return [code for text in texts or () for code in text.replace(",", " ").split()]


def run_command(
    program: Annotated[Path, typer.Argument(help="The part program.", metavar="PROGRAM")],
    machine: Annotated[str | None, MACHINE] = None,
    dialect: Annotated[str | None, DIALECT] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of the summary.")
    ] = False,
    trace: Annotated[
        Path | None,
        typer.Option(
            help="Write one row per control cycle to a .csv, .npz or .parquet file.", metavar="FILE"
        ),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw path and speed to a .png, .svg or .pdf file.", metavar="FILE")
    ] = None,
    servo: Annotated[
        bool, typer.Option("--servo", help="Simulate the position loops; the trace gets actual positions.")
    ] = False,
    skip: Annotated[
        list[int] | None,
        typer.Option(
            help="Leave out blocks marked /N, as with block delete on; / alone is 1.",
            metavar="N",
            min=1,
            max=9,
        ),
    ] = None,
    stop_at_m0: Annotated[
        bool, typer.Option("--stop-at-m0", help="End the run at the first M0 instead of passing it.")
    ] = False,
    ignore: Annotated[list[str] | None, IGNORE] = None,
    root: Annotated[Path | None, ROOT] = None,
    keys: Annotated[
        Path | None,
        typer.Option(help="The keys that are pressed when a program asks, one a line.", metavar="FILE"),
    ] = None,
    screen: Annotated[
        Path | None,
        typer.Option(help="Write what the program shows to a .txt, .svg or .png file.", metavar="FILE"),
    ] = None,
) -> None:
    """Run a part program on a simulated machine and say how long it takes and where it goes."""
    from polycnc import runner
    from polycnc.machine import load_machine
    from polycnc.outputs import keep_apart, keep_inputs

    outputs = (("a trace", trace), ("a plot", plot), ("a screen", screen))
    for what, output in outputs:
        keep_inputs(output, (program, machine, dialect, keys), what)
    keep_apart(outputs)
    text = runner.program_text(program)
    config = load_machine(machine)
    with ExitStack() as stack:
        picture = None
        writer = None
        if plot is not None:
            runner.check_plot_file(plot)
            picture = runner.PlotCollector(config)
        if trace is not None:
            writer = stack.enter_context(runner.TraceWriter(trace, config, servo))
        if servo:
            _say_if_ideal(config)

        with progress_bar(program.name) as bar:
            result = runner.run(
                text,
                config,
                dialect,
                servo=servo,
                check=False,
                skip_levels=skip or (),
                stop_at_m0=stop_at_m0,
                rows=None if picture is None else picture.add,
                tagged_rows=None if writer is None else writer.add_tagged,
                progress=bar,
                root=root,
                keys=() if keys is None else runner.read_keys(keys),
                screen=screen,
                ignore=codes_of(ignore),
            )
        if picture is not None and plot is not None:
            runner.plot(picture.with_trace(result), plot)
    if as_json:
        print_json(result.as_dict())
    else:
        _summary(result)
        for path in (trace, plot, screen):
            if path is not None:
                say(f"wrote      {path}")
    sys.exit(0 if result.ok else 1)


def _say_if_ideal(config: MachineConfig) -> None:
    if all(axis.servo.kind == "ideal" for axis in config.axes):
        say_error(
            f"--servo changes nothing: {config.name} has ideal servos; a machine file can say otherwise."
        )


def _summary(result: RunResult) -> None:
    from polycnc.runner import counted, time_text

    say(f"program    {result.program}")
    say(f"           {counted(result.blocks, 'block')}, dialect {result.dialect}, machine {result.machine}")
    say(lead="time       " + bold(time_text(result.time_s)))
    parts = [
        ("  cutting", time_text(result.cutting_time_s), f"{result.cutting_path_mm:,.3f} mm"),
        ("  rapid", time_text(result.rapid_time_s), f"{result.rapid_path_mm:,.3f} mm"),
        ("  waiting", time_text(result.waiting_time_s), ""),
    ]
    for line in columns(parts if result.waiting_time_s else parts[:2], right=_NUMBERS):
        say(line)
    say(f"path       {result.path_mm:,.3f} mm, cut with up to {result.top_feed_mm_min:,.1f} mm/min")
    header = ("axis", "lowest", "highest", "end", "(machine coordinates)")
    axes = [
        (
            f"  {axis}",
            f"{low:,.3f}",
            f"{high:,.3f}",
            f"{result.end_position_mm[axis]:,.3f}",
            result.axis_units[axis],
        )
        for axis, (low, high) in result.extents_mm.items()
    ]
    for line in columns([header, *axes], right=_NUMBERS):
        say(line)
    for message in result.messages:
        times = f" ({message.count} times)" if message.count > 1 else ""
        say(f"message    line {message.line}: {message.text}{times}")
    for alarm in result.alarms:
        say(str(alarm), lead=bold_red("alarm: "))
