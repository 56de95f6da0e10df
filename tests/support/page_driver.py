"""Do what a documentation page says, step by step: steps come as JSON, what they print goes back.

Python blocks share their variables, as in one session; a failing step ends the process with its traceback.
"""

from __future__ import annotations

import io
import json
import subprocess
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

from polycnc.cli import main


def _polycnc(command: str) -> int:
    sys.argv = command.split()
    try:
        main()
    except SystemExit as end:
        return int(end.code or 0)
    return 0


def _step(kind: str, what: str, text: str, session: dict[str, Any]) -> int:
    if kind == "file":
        Path(what).parent.mkdir(parents=True, exist_ok=True)
        Path(what).write_text(text, encoding="utf-8")
    elif kind == "polycnc":
        return _polycnc(what)
    elif kind == "shell":
        command, _, target = what.partition(" > ")
        done = subprocess.run(command.split(), capture_output=True, text=True, check=False)
        if target:
            Path(target).write_text(done.stdout, encoding="utf-8")
        else:
            print(done.stdout, end="")
        return done.returncode
    else:
        exec(compile(text, what, "exec"), session)
    return 0


def drive() -> None:
    """Run the steps that stand in standard input."""
    session: dict[str, Any] = {"__name__": "__main__"}
    results = []
    for kind, what, text in json.load(sys.stdin):
        with redirect_stdout(io.StringIO()) as printed:
            status = _step(kind, what, text, session)
        results.append((status, printed.getvalue()))
    json.dump(results, sys.stdout)


if __name__ == "__main__":
    drive()
