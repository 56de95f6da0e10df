"""``polycnc run``: a program in, timed motion out."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from polycnc.cli._output import bold, print_json, progress_bar, say, say_error
from polycnc.cli._programs import dialect_names, machine_names, read_program
from polycnc.cli._summary import Units, print_summary
from polycnc.errors import UsageError

if TYPE_CHECKING:
    from polycnc.machine import MachineConfig
    from polycnc.runner import RunResult

MACHINE = typer.Option(
    "--machine",
    "-m",
    help="The machine: a preset or a TOML file (default: mill3).",
    metavar="FILE|PRESET",
    autocompletion=machine_names,
)
DIALECT = typer.Option(
    "--dialect",
    "-d",
    help="The dialect: din, fanuc, haas, ... or a TOML file (default: by the program's extension, else din).",
    metavar="FILE|NAME",
    autocompletion=dialect_names,
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


def codes_of(texts: list[str] | None) -> list[str]:
    """Return the codes of all --ignore options."""
    return [code for text in texts or () for code in text.replace(",", " ").split()]


def run_command(
    programs: Annotated[
        list[Path], typer.Argument(help="The part programs; - is standard input.", metavar="PROGRAM")
    ],
    machine: Annotated[str | None, MACHINE] = None,
    dialect: Annotated[str | None, DIALECT] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of the summary.")
    ] = False,
    units: Annotated[
        Units, typer.Option(help="Units of lengths and feeds in the summary.", metavar="mm|inch")
    ] = Units.MM,
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
    loop_limit: Annotated[
        float | None,
        typer.Option(
            help="How long a CPL loop may go round without a block or a WAIT (10 s of the machine's time).",
            metavar="S",
        ),
    ] = None,
) -> None:
    """Run part programs on a simulated machine and say how long they take and where they go."""
    from polycnc import runner
    from polycnc.machine import load_machine
    from polycnc.outputs import keep_apart, keep_inputs

    outputs = (("a trace", trace), ("a plot", plot), ("a screen", screen))
    for what, output in outputs:
        if output is not None and len(programs) > 1:
            raise UsageError(f"{what} of {len(programs)} programs", hint="Run them one by one.")
        keep_inputs(output, (*programs, machine, dialect, keys), what)
    keep_apart(outputs)
    texts = [read_program(program) for program in programs]
    config = load_machine(machine)
    if servo:
        _say_if_ideal(config)
    results = []
    for text in texts:
        with ExitStack() as stack:
            picture = None
            writer = None
            if plot is not None:
                runner.check_plot_file(plot)
                picture = runner.TrackCollector(tuple(axis.unit for axis in config.axes))
            if trace is not None:
                writer = stack.enter_context(runner.TraceWriter(trace, config, servo))
            sinks = [
                *([picture.add] if picture is not None else []),
                *([writer.add_tagged] if writer is not None else []),
            ]
            with progress_bar(Path(text.name).name) as bar:
                result = runner.run(
                    text,
                    config,
                    dialect,
                    servo=servo,
                    check=False,
                    skip_levels=skip or (),
                    stop_at_m0=stop_at_m0,
                    tagged_rows=_to_all(sinks),
                    progress=bar,
                    root=root,
                    keys=() if keys is None else runner.read_keys(keys),
                    screen=screen,
                    ignore=codes_of(ignore),
                    loop_limit_s=runner.LOOP_LIMIT_S if loop_limit is None else loop_limit,
                )
            if picture is not None and plot is not None:
                names = tuple((axis.name, axis.unit) for axis in config.axes)
                runner.plot_track(result, names, picture.track(picture.execution()), plot)
        results.append(result)
        if not as_json:
            print_summary(result, units)
    if as_json:
        print_json(results[0].as_dict() if len(results) == 1 else _all_as_dict(results))
    else:
        if len(results) > 1:
            total = sum(result.time_s for result in results)
            say(
                lead="total      "
                + bold(f"{runner.time_text(total)}, {runner.counted(len(results), 'program')}")
            )
        for path in (trace, plot, screen):
            if path is not None:
                say(f"wrote      {path}")
    sys.exit(0 if all(result.ok for result in results) else 1)


def _to_all(sinks: Sequence[Callable[..., None]]) -> Callable[..., None] | None:
    """Return what gives each piece of the record to all of them; None where there is none."""

    def give(*piece: Any) -> None:
        for sink in sinks:
            sink(*piece)

    return give if sinks else None


def _all_as_dict(results: list[RunResult]) -> dict[str, Any]:
    return {
        "time_s": sum(result.time_s for result in results),
        "programs": [result.as_dict() for result in results],
    }


def _say_if_ideal(config: MachineConfig) -> None:
    if all(axis.servo.kind == "ideal" for axis in config.axes):
        say_error(
            f"--servo changes nothing: {config.name} has ideal servos; a machine file can say otherwise."
        )
