"""The commands and what they share; they import what they need when they run, so ``--help`` is quick."""

from __future__ import annotations

import sys

import typer

from polycnc import __version__
from polycnc.cli import (
    _batch,
    _calls,
    _check,
    _clib,
    _compare,
    _conformance,
    _debug,
    _focas,
    _lsp,
    _machine,
    _mtconnect,
    _post,
    _rehearse,
    _run,
    _sap,
    _schema,
    _serve,
    _snapshot,
    _view,
    _warmup,
)
from polycnc.cli._command import add_command
from polycnc.cli._errors import INTERRUPTED, check_environment, end_on_termination, end_with_report
from polycnc.cli._output import print_remarks

app = typer.Typer(
    name="polycnc",
    help="A virtual CNC and motion controller: run, time and inspect NC programs without a machine.",
    epilog="Exit status: 0 clean, 1 program error or alarm, 2 wrong usage, 70 internal error, 130 interrupted.",
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
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


_COMMANDS = (
    ("run", _run.run_command, "Run a part program: times, path, alarms."),
    ("view", _view.view_command, "Write a page that shows a run: path, time, blocks, tools."),
    ("batch", _batch.batch_command, "Run or check whole folders of programs."),
    ("compare", _compare.compare_command, "Compare two programs, or one on two machines."),
    ("debug", _debug.debug_command, "Execute a program block by block and look at it."),
    ("check", _check.check_command, "Report every error of part programs."),
    ("lsp", _lsp.lsp_command, "Serve an editor: errors and codes while you type."),
    ("post", _post.post_command, "Turn a tool path into a program for a control."),
    ("machine", _machine.machine_command, "Show a machine's axes and limits."),
    ("serve", _serve.serve_command, "Serve a simulated control to clients on the network."),
    ("rehearse", _rehearse.rehearse_command, "Say what happens in a scenario, without waiting for it."),
    ("snapshot", _snapshot.snapshot_command, "Keep the state of a served machine in a file."),
    ("restore", _snapshot.restore_command, "Let a served machine go back to a kept state."),
    ("clib", _clib.clib_command, "Write and build a C library that old programs link against."),
    ("calls", _calls.calls_command, "Serve a machine to C programs, and trace what they call."),
    ("conformance", _conformance.conformance_command, "Show which parts of the manuals are tested."),
    ("schema", _schema.schema_command, "Print the JSON schema of outputs and files."),
    ("warmup", _warmup.warmup_command, "Compile beforehand what the first use would wait for."),
)
for _name, _function, _says in _COMMANDS:
    add_command(app, _name, _function, _says)
app.add_typer(_focas.focas_app, name="focas", short_help="Tools around the protocol of FANUC controls.")
app.add_typer(_mtconnect.mtconnect_app, name="mtconnect", short_help="Tools around MTConnect.")
app.add_typer(_sap.sap_app, name="sap", short_help="Compile stand-alone programs of the APCI board.")


def main() -> None:
    """Run the command line."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal may lack a character of a file name
    if "scipy" not in sys.modules:
        sys.modules["scipy"] = None  # type: ignore[assignment]  # numba would load it: 0.3 s, for nothing here
    end_on_termination()
    check_environment()
    print_remarks()
    try:
        app(prog_name="polycnc")
    except Exception as error:  # of the command line itself; the commands are guarded
        end_with_report(error)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
