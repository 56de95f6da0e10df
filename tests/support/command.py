"""Run the command line as users do: a process of its own, in a folder of its own."""

from __future__ import annotations

import atexit
import functools
import json
import os
import select
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from polycnc.jit import COMPILING

COMMAND = (sys.executable, "-m", "polycnc.cli")
TIMEOUT_S = 240.0
_LATE = {"COLUMNS"}  # variables that are looked at when something is printed


def environment(**more: str) -> dict[str, str]:
    """Return the environment of a user's process: without what tests set, and 80 columns wide."""
    # One of pytest's variables is another one in every test, which would mean a server for each of them.
    own = ("POLYCNC_OPEN_INTERNALS", "POLYCNC_COMPILE_AT_ONCE")
    kept = {
        name: value
        for name, value in os.environ.items()
        if name not in own and not name.startswith("PYTEST_")
    }
    return {**kept, "COLUMNS": "80", "PYTHONUTF8": "1", **more}


def polycnc(
    *arguments: str | Path, cwd: Path | None = None, status: int = 0, **more: str
) -> subprocess.CompletedProcess[str]:
    """Run the command, hold it to an exit status, and return what it printed."""
    words = [str(each) for each in arguments]
    is_forked = hasattr(os, "fork") and _LATE.issuperset(more)
    done = _forked(words, cwd, more) if is_forked else _from_nothing(words, cwd, more)
    assert done.returncode == status, f"exit status {done.returncode}\n{done.stdout}\n{done.stderr}"
    assert "Traceback" not in done.stderr, done.stderr
    done.stderr = done.stderr.replace(f"{COMPILING}\n", "")  # said or not, depending on what ran before
    return done


def _from_nothing(
    words: list[str], cwd: Path | None, more: dict[str, str]
) -> subprocess.CompletedProcess[str]:
    """Start a Python for the command, as the settings in `more` act from the beginning."""
    return subprocess.run(
        [*COMMAND, *words],
        cwd=cwd,
        env=environment(**more),
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=TIMEOUT_S,
        stdin=subprocess.DEVNULL,
        check=False,
    )


def _forked(words: list[str], cwd: Path | None, more: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """Let a process that has its imports after it become the command."""
    return _answered(words, cwd, {"arguments": words, "environment": more})


def script(path: Path, text: str, cwd: Path, **more: str) -> subprocess.CompletedProcess[str]:
    """Let such a process become a Python script that reads a text; `more` is not seen by what is imported already."""
    if not hasattr(os, "fork"):
        return subprocess.run(
            [sys.executable, str(path)], input=text, cwd=cwd, env=environment(**more), capture_output=True, text=True,
            encoding="utf-8", timeout=TIMEOUT_S, check=False,
        )  # fmt: skip
    return _answered([str(path)], cwd, {"script": str(path), "text": text, "environment": more})


def python(
    code: str | Path, *arguments: str | Path, cwd: Path | None = None, status: int | None = 0
) -> subprocess.CompletedProcess[str]:
    """Let such a process become a script, or code as after `python -c`; hold it to an exit status, if there is one."""
    words = [str(each) for each in arguments]
    what = ["-c", code] if isinstance(code, str) else [str(code)]
    if hasattr(os, "fork"):
        kind = {"code": code} if isinstance(code, str) else {"script": str(code)}
        done = _answered([*what, *words], cwd, {**kind, "arguments": words})
    else:
        done = subprocess.run(
            [sys.executable, *what, *words], cwd=cwd, env=environment(), capture_output=True, text=True,
            encoding="utf-8", timeout=TIMEOUT_S, check=False,
        )  # fmt: skip
    assert status is None or done.returncode == status, f"exit status {done.returncode}\n{done.stderr}"
    return done


def slow_s() -> float:
    """Return how long this computer takes now for what it does in 0.02 s when it has time."""
    begun_s = time.perf_counter()
    subprocess.run([sys.executable, "-S", "-c", "pass"], check=True)
    return time.perf_counter() - begun_s


def _answered(
    words: list[str], cwd: Path | None, request: dict[str, object]
) -> subprocess.CompletedProcess[str]:
    with tempfile.TemporaryDirectory() as folder:
        outputs = [Path(folder, name) for name in ("stdout", "stderr")]
        place = {"folder": str(cwd or Path.cwd()), "outputs": [str(path) for path in outputs]}
        answer = request_of({**request, **place})
        said = [path.read_text(encoding="utf-8") for path in outputs]
    return subprocess.CompletedProcess([*COMMAND, *words], answer, *said)


def request_of(request: dict[str, object]) -> int:
    """Send a request to the process that forks; return its answer."""
    server = _server(tuple(sorted(environment().items())))
    assert server.stdin is not None
    assert server.stdout is not None
    server.stdin.write(json.dumps(request) + "\n")
    server.stdin.flush()
    if not select.select([server.stdout], [], [], TIMEOUT_S)[0]:
        _server.cache_clear()
        _end(server)
        raise subprocess.TimeoutExpired([*COMMAND, str(request.get("arguments"))], TIMEOUT_S)
    return int(server.stdout.readline())


@functools.lru_cache(maxsize=1)
def _server(environment: tuple[tuple[str, str], ...]) -> subprocess.Popen[str]:
    """Return the running server; another where a test has changed the environment."""
    server = subprocess.Popen(
        [sys.executable, str(Path(__file__).with_name("command_server.py"))],
        env={**dict(environment), "POLYCNC_COMPILE_AT_ONCE": "1"},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        encoding="utf-8",
    )
    atexit.register(_end, server)
    return server


def _end(server: subprocess.Popen[str]) -> None:
    """End it, and wait until it has: what is left running is complained about at the end of the tests."""
    server.kill()
    server.communicate()
