"""Run commands in forked children of a process that has run a program already; one request a line.

A command still has a process, a folder and outputs of its own; what it is spared are the imports and the loading of
compiled functions, which cost a second and its own work a few hundredths.
A request is JSON with `folder`, `outputs` (the files for what it prints), and the `arguments` of a command, or a
`script` with the `text` that it reads and more of an `environment`; the answer is its exit status.
"""

from __future__ import annotations

import atexit
import io
import json
import os
import runpy
import sys
from typing import Any

import polycnc.cli
import polycnc.post  # noqa: F401
from polycnc.nc import ProgramText
from polycnc.runner import run


def become(request: dict[str, Any]) -> None:
    """Make this process that of a command or a script, which ends it."""
    os.chdir(request["folder"])
    for stream, file in enumerate((os.devnull, *request["outputs"])):
        mode = os.O_RDONLY if stream == 0 else os.O_WRONLY | os.O_CREAT | os.O_TRUNC
        opened = os.open(file, mode)
        os.dup2(opened, stream)
        os.close(opened)
    os.environ.update(request.get("environment", {}))
    try:
        if "script" in request:
            sys.stdin = io.StringIO(request["text"])
            runpy.run_path(request["script"], run_name="__main__")
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


def serve() -> None:
    """Answer requests until there are no more; a child leaves with its command."""
    run(ProgramText.from_text("G1 X1 F99\nM30\n"), "mill3")
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            become(json.loads(line))
            return
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)


if __name__ == "__main__":
    serve()
