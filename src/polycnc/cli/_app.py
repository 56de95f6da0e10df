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
    _view,
    _warmup,
)
from polycnc.cli._command import Command
from polycnc.cli._errors import INTERRUPTED, check_environment, end_on_termination, end_with_report, guarded
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


app.command("run", cls=Command, short_help="Run a part program: times, path, alarms.")(
    guarded(_run.run_command)
)
app.command("view", cls=Command, short_help="Write a page that shows a run: path, time, blocks, tools.")(
    guarded(_view.view_command)
)
app.command("batch", cls=Command, short_help="Run or check whole folders of programs.")(
    guarded(_batch.batch_command)
)
app.command("compare", cls=Command, short_help="Compare two programs, or one on two machines.")(
    guarded(_compare.compare_command)
)
app.command("debug", cls=Command, short_help="Execute a program block by block and look at it.")(
    guarded(_debug.debug_command)
)
app.command("check", cls=Command, short_help="Report every error of part programs.")(
    guarded(_check.check_command)
)
app.command("lsp", cls=Command, short_help="Serve an editor: errors and codes while you type.")(
    guarded(_lsp.lsp_command)
)
app.command("post", cls=Command, short_help="Turn a tool path into a program for a control.")(
    guarded(_post.post_command)
)
app.command("machine", cls=Command, short_help="Show a machine's axes and limits.")(
    guarded(_machine.machine_command)
)
app.command("serve", cls=Command, short_help="Serve a simulated control to clients on the network.")(
    guarded(_serve.serve_command)
)
app.command("rehearse", cls=Command, short_help="Say what happens in a scenario, without waiting for it.")(
    guarded(_rehearse.rehearse_command)
)
app.command("clib", cls=Command, short_help="Write and build a C library that old programs link against.")(
    guarded(_clib.clib_command)
)
app.command("calls", cls=Command, short_help="Serve a machine to C programs, and trace what they call.")(
    guarded(_calls.calls_command)
)
app.command("conformance", cls=Command, short_help="Show which parts of the manuals are tested.")(
    guarded(_conformance.conformance_command)
)
app.command("schema", cls=Command, short_help="Print the JSON schema of outputs and files.")(
    guarded(_schema.schema_command)
)
app.command("warmup", cls=Command, short_help="Compile beforehand what the first use would wait for.")(
    guarded(_warmup.warmup_command)
)
_focas.focas_app.command("dissect", cls=Command, short_help="Explain captured bytes of the protocol.")(
    guarded(_focas.dissect_command)
)
app.add_typer(_focas.focas_app, name="focas", short_help="Tools around the protocol of FANUC controls.")
_mtconnect.mtconnect_app.command(
    "devices", cls=Command, short_help="Write the Devices.xml of a machine for an agent."
)(guarded(_mtconnect.devices_command))
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
