"""``polycnc run``: a program in, timed motion out."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from polycnc.cli import _options as options
from polycnc.cli._output import bold, print_json, progress_bar, say, say_error
from polycnc.cli._programs import read_program
from polycnc.cli._summary import Units, print_summary
from polycnc.errors import UsageError

if TYPE_CHECKING:
    from polycnc.machine import MachineConfig
    from polycnc.nc import ProgramText
    from polycnc.runner import RunResult, RunSettings


@dataclass(frozen=True, slots=True)
class _Outputs:
    """The files that a run writes besides its summary."""

    trace: Path | None
    plot: Path | None
    screen: Path | None
    stock: Path | None
    parameters: Path | None

    def check(self, programs: Sequence[Path], inputs: Iterable[str | Path | None]) -> None:
        """Refuse files of several programs, and those that are read or written twice."""
        from polycnc.outputs import keep_apart, keep_inputs

        outputs = (
            ("a trace", self.trace),
            ("a plot", self.plot),
            ("a screen", self.screen),
            ("stock", self.stock),
            ("a file of parameters", self.parameters),
        )
        read = tuple(inputs)
        for what, output in outputs:
            if output is not None and len(programs) > 1:
                raise UsageError(f"{what} of {len(programs)} programs", hint="Run them one by one.")
            keep_inputs(output, read, what)
        keep_apart(outputs)

    def say(self) -> None:
        """Say what has been written."""
        for path in (self.trace, self.plot, self.screen, self.stock, self.parameters):
            if path is not None:
                say(f"wrote      {path}")


def run_command(
    programs: options.Programs,
    machine: options.Machine = None,
    dialect: options.Dialect = None,
    as_json: options.AsJsonSummary = False,
    units: options.SummaryUnits = Units.MM,
    trace: options.Trace = None,
    plot: options.Plot = None,
    servo: options.Servo = False,
    skip: options.Skip = None,
    stop_at_m0: options.StopAtM0 = False,
    ignore: options.Ignore = None,
    root: options.Root = None,
    keys: options.Keys = None,
    screen: options.Screen = None,
    loop_limit: options.LoopLimit = None,
    stock: options.Stock = None,
    fixture: options.Fixtures = None,
    target: options.Target = None,
    tolerance: options.Tolerance = None,
    resolution: options.Resolution = None,
    tools: options.Tools = None,
    save_stock: options.SaveStock = None,
    save_parameters: options.SaveParameters = None,
) -> None:
    """Run part programs on a simulated machine and say how long they take and where they go."""
    from polycnc import load_machine, runner

    outputs = _Outputs(trace, plot, screen, save_stock, save_parameters)
    files = options.file_of_tools(tools), *_files(stock, *(fixture or ()))
    outputs.check(programs, (*programs, machine, dialect, keys, target, *files))
    named = load_machine(machine)
    check_stock_file(save_stock, stock if stock is not None or named.stock is None else named.stock.form)
    outputs.check(programs, _files(*(each.form for each in (named.stock, *named.fixtures) if each)))
    texts = [read_program(program) for program in programs]
    settings = runner.RunSettings(
        machine,
        dialect,
        servo=servo,
        skip_levels=frozenset(skip or ()),
        stop_at_m0=stop_at_m0,
        root=root,
        keys=() if keys is None else runner.read_keys(keys),
        screen=screen,
        ignore=options.codes_of(ignore),
        loop_limit_s=runner.LOOP_LIMIT_S if loop_limit is None else loop_limit,
        save_parameters=save_parameters,
        **options.body_of(stock, resolution, fixture, target, tolerance, tools),
    )
    _say_if_ideal(settings.machine_of(texts[0]), servo)
    results = []
    for text in texts:
        results.append(_run(text, settings, outputs))
        if not as_json:
            print_summary(results[-1], units)
    if as_json:
        print_json(results[0].as_dict() if len(results) == 1 else _all_as_dict(results))
    else:
        _say_total(results)
        outputs.say()
    sys.exit(0 if all(result.ok and not result.collisions for result in results) else 1)


def _run(text: ProgramText, settings: RunSettings, outputs: _Outputs) -> RunResult:
    """Run a program, and write its trace and its plot."""
    from polycnc import runner

    config = settings.machine_of(text)
    with ExitStack() as stack:
        sinks: list[Callable[..., None]] = []
        picture = None
        if outputs.plot is not None:
            runner.check_plot_file(outputs.plot)
            picture = runner.TrackCollector(tuple(axis.unit for axis in config.axes))
            sinks.append(picture.add)
        if outputs.trace is not None:
            writer = stack.enter_context(runner.TraceWriter(outputs.trace, config, settings.servo))
            sinks.append(writer.add_tagged)
        with progress_bar(Path(text.name).name) as bar:
            result = runner.run_program(text, settings, check=False, tagged_rows=_to_all(sinks), progress=bar)
        if picture is not None and outputs.plot is not None:
            names = tuple((axis.name, axis.unit) for axis in config.axes)
            runner.plot_track(result, names, picture.track(picture.execution()), outputs.plot)
        if outputs.stock is not None and result.stock is not None:
            result.stock.mesh().write(outputs.stock)
    return result


def check_stock_file(path: Path | None, stock: str | None) -> None:
    """Check that what is left of the stock can be written where it should.

    Raises:
        UsageError: nothing is cut, or no .stl or .3mf file.
    """
    from polycnc.outputs import check_output
    from polycnc.stock import MESH_FORMATS

    if path is None:
        return
    if stock is None:
        raise UsageError("there is no stock to save", hint="Say what is cut: --stock auto.")
    check_output(path, MESH_FORMATS, "stock")


def _files(*bodies: str | None) -> list[Path]:
    """Return the files that bodies are read from."""
    if not any(bodies):
        return []
    from polycnc.stock import file_of

    return [file for body in bodies if body and (file := file_of(body)) is not None]


def _say_total(results: Sequence[RunResult]) -> None:
    from polycnc.runner import counted, time_text

    if len(results) > 1:
        total = sum(result.time_s for result in results)
        say(lead="total      " + bold(f"{time_text(total)}, {counted(len(results), 'program')}"))


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


def _say_if_ideal(config: MachineConfig, servo: bool) -> None:
    if servo and all(axis.servo.kind == "ideal" for axis in config.axes):
        say_error(
            f"--servo changes nothing: {config.name} has ideal servos; a machine file can say otherwise."
        )
