"""The commands, their shared options, and how errors end them.

Exit status: 0 clean, 1 program error or alarm, 2 usage. Commands import what they need when they run, so that
``polycnc --help`` is quick.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

import typer

from polycnc import __version__
from polycnc.cli import _check, _conformance, _machine, _run
from polycnc.cli._output import error_console
from polycnc.errors import PolycncError, UsageError

app = typer.Typer(
    name="polycnc",
    help="A virtual CNC and motion controller: run, time and inspect NC programs with no machine on the desk.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"polycnc {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: bool = typer.Option(
        False, "--version", help="Print the version.", callback=_print_version, is_eager=True
    ),
) -> None:
    """Hold the options of the command itself."""


app.command("run")(_run.run_command)
app.command("check")(_check.check_command)
app.command("machine")(_machine.machine_command)
app.command("conformance")(_conformance.conformance_command)


@contextmanager
def _errors_end_the_command() -> Iterator[None]:
    try:
        yield
    except UsageError as error:
        error_console().print(f"[bold red]error:[/] {_escaped(error)}", highlight=False)
        sys.exit(2)
    except PolycncError as error:
        error_console().print(f"[bold red]error:[/] {_escaped(error)}", highlight=False)
        sys.exit(1)
    except BrokenPipeError:
        sys.exit(1)


def _escaped(error: PolycncError) -> str:
    from rich.markup import escape

    return escape(str(error))


def main() -> None:
    """Run the command line."""
    with _errors_end_the_command():
        app()
