"""Run commands in forked children of a process that has run a program already; one request a line.

A command still has a process, a folder and outputs of its own; what it is spared are the imports and the loading of
compiled functions, which cost a second and its own work a few hundredths.
A request is JSON with `folder`, `outputs` (the files for what it prints), and the `arguments` of a command, or those
of a `script` (a file) or of `code` with the `text` that it reads and more of an `environment`; the answer is its exit
status. With `status`, a FIFO, the answer comes at once, and the process goes on: its number and in the end its exit
status are written there.
"""

from __future__ import annotations

import atexit
import contextlib
import functools
import importlib
import io
import json
import os
import runpy
import sys
import tempfile
from pathlib import Path
from typing import Any

import typer.main

import polycnc.post  # noqa: F401
from polycnc.cli._app import app


def become(request: dict[str, Any]) -> None:
    """Make this process that of a command or a script, which ends it."""
    os.chdir(request["folder"])
    for stream, file in enumerate((os.devnull, *request["outputs"])):
        mode = os.O_RDONLY if stream == 0 else os.O_WRONLY | os.O_CREAT | os.O_TRUNC
        opened = os.open(file, mode)
        os.dup2(opened, stream)
        os.close(opened)
    if "status" in request:  # streams that know that these files are pipes
        sys.stdout = open(1, "w", encoding="utf-8", buffering=1, closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", encoding="utf-8", buffering=1, closefd=False)  # noqa: SIM115
    os.environ.update(request.get("environment", {}))
    try:
        if "script" in request or "code" in request:
            sys.stdin = io.StringIO(request.get("text", ""))
            sys.argv = [request.get("script", "-c"), *request.get("arguments", ())]
            if "script" in request:
                sys.path[0] = os.path.dirname(request["script"])
                runpy.run_path(request["script"], run_name="__main__")
            else:
                exec(compile(request["code"], "<string>", "exec"), {"__name__": "__main__"})
        else:
            sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115  the old one has read ahead
            sys.argv = ["polycnc", *request["arguments"]]
            runpy.run_module("polycnc.cli", run_name="__main__", alter_sys=True)
        status: object = 0
    except SystemExit as end:
        status = end.code or 0
    if not isinstance(status, int):
        sys.exit(str(status))
    # Taking everything down piece by piece takes ten times as long as a short command.
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def load_commands() -> None:
    """Load what every command needs: the command line as it is built, the shipped files, the compiled functions."""
    vars(typer.main)["get_command"] = functools.cache(typer.main.get_command)
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        program = Path(folder, "part.nc")
        program.write_text("G1 X1 F99\nM30\n")
        for words in (["run"], ["run", "--json"], ["check"]):
            with contextlib.suppress(SystemExit):
                app([*words, str(program)], prog_name="polycnc")


def load_plots() -> None:
    """Load what draws, which takes a second."""
    with contextlib.suppress(ModuleNotFoundError):
        for name in ("figure", "backends.backend_agg", "backends.backend_svg"):
            importlib.import_module(f"matplotlib.{name}")


def load_servers() -> None:
    """Load what `polycnc serve` needs, and make a machine of the kinds that are served most."""
    from polycnc.servers.process import KINDS, Machinery

    for name in ("focas", "grbl", "http", "mtconnect", "opcua", "setup", "shdr"):
        with contextlib.suppress(ModuleNotFoundError):
            importlib.import_module(f"polycnc.servers.{name}")
    for kind in ("plain", "fanuc"):
        made = KINDS[kind](Machinery())
        made.device.advance(2)
        made.end()


def go_on(request: dict[str, Any]) -> None:
    """Let a process become a command that goes on, while this one waits for its end."""
    child = os.fork()
    if child == 0:
        os.setsid()
        become(request)
    with open(request["status"], "w", encoding="utf-8") as status:
        print(child, file=status, flush=True)
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), file=status)
    os._exit(0)


def serve() -> None:
    """Answer requests until there are no more; a child leaves with its command."""
    load_commands()
    loaded = set()
    for line in sys.stdin:
        request = json.loads(line)
        goes_on = "status" in request
        is_command = "code" not in request and "script" not in request
        for load, wanted in ((load_servers, goes_on), (load_plots, "--plot" in request.get("arguments", ()))):
            if is_command and wanted and load not in loaded:
                load()
                loaded.add(load)
        child = os.fork()
        if child == 0:
            if not goes_on:
                become(request)
            elif os.fork() == 0:
                go_on(request)
            os._exit(0)
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)


if __name__ == "__main__":
    serve()
