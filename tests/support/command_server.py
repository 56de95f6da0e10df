"""Run commands in forked children of a process that has run a program already; one request a line.

A command still has a process, a folder and outputs of its own; what it is spared are the imports and the loading of
compiled functions, which cost a second and its own work a few hundredths.
A request is JSON with `arguments`, `folder` and `outputs`, the files for what it prints; the answer is its exit status.
"""

from __future__ import annotations

import atexit
import json
import os
import runpy
import sys

import polycnc.cli
import polycnc.post  # noqa: F401
from polycnc.nc import ProgramText
from polycnc.runner import run


def become(request: dict[str, object]) -> None:
    """Make this process that of a command, which ends it."""
    os.chdir(str(request["folder"]))
    files = [os.devnull, *map(str, request["outputs"])]  # type: ignore[call-overload]
    for stream, file in enumerate(files):
        mode = os.O_RDONLY if stream == 0 else os.O_WRONLY | os.O_CREAT | os.O_TRUNC
        opened = os.open(file, mode)
        os.dup2(opened, stream)
        os.close(opened)
    sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115  the old one has read ahead
    sys.argv = ["polycnc", *map(str, request["arguments"])]  # type: ignore[call-overload]
    try:
        runpy.run_module("polycnc.cli", run_name="__main__", alter_sys=True)
        status: object = 0
    except SystemExit as end:
        status = end.code or 0
    if isinstance(
        status, int
    ):  # without taking everything down piece by piece, which takes ten times as long
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
    sys.exit(str(status))


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
