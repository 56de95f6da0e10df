"""Start `polycnc serve`, or Python, as a process that goes on: forked where that is possible, see `command_server`."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any, cast

from support.command import COMMAND, environment, request_of


class Started:
    """What tests use of `subprocess.Popen`, for a process that another one has forked."""

    def __init__(self, words: list[str], cwd: Path | None, **what: str) -> None:
        self._folder = tempfile.TemporaryDirectory()
        names = [os.path.join(self._folder.name, name) for name in ("stdout", "stderr", "status")]
        for name in names:
            os.mkfifo(name)
        self.returncode: int | None = None
        self.args = [*COMMAND, *words]
        place = {"folder": str(cwd or Path.cwd()), "outputs": names[:2], "status": names[2]}
        request_of({"arguments": words, **what, **place})
        self._status: IO[str] = open(names[2], encoding="utf-8")  # noqa: SIM115
        self.pid = int(self._status.readline())
        self.stdout: IO[str] = open(names[0], encoding="utf-8")  # noqa: SIM115
        self.stderr: IO[str] = open(names[1], encoding="utf-8")  # noqa: SIM115
        self._said = ["", "", ""]
        self._readers: list[threading.Thread] = []

    def send_signal(self, number: int) -> None:
        """Send a signal, if it has not ended."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.pid, number)

    def terminate(self) -> None:
        """Ask it to end."""
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        """End it."""
        self.send_signal(signal.SIGKILL)

    def communicate(self, timeout: float | None = None) -> tuple[str, str]:
        """Wait until it has ended; return what it printed since it was last read.

        Raises:
            subprocess.TimeoutExpired: It has not ended within the time.
        """
        said, outputs = self._said, (self.stdout, self.stderr, self._status)

        def read(number: int, of: IO[str]) -> None:
            said[number] = of.read()

        if not self._readers:  # those of a call that has timed out go on reading
            self._readers = [
                threading.Thread(target=read, args=each, daemon=True) for each in enumerate(outputs)
            ]
            for each in self._readers:
                each.start()
        for each in reversed(self._readers):
            each.join(timeout)
            if each.is_alive():
                raise subprocess.TimeoutExpired(self.args, timeout or 0.0)
        for output in outputs:
            output.close()
        self.returncode = int(said[2])
        self._folder.cleanup()
        return said[0], said[1]

    def wait(self, timeout: float | None = None) -> int:
        """Wait until it has ended; return its exit status."""
        self.communicate(timeout)
        assert self.returncode is not None
        return self.returncode


def started(*arguments: str | Path, cwd: Path | None = None) -> Started:
    """Start a command whose outputs are read line by line."""
    words = [str(each) for each in arguments]
    if hasattr(os, "fork"):
        return Started(words, cwd)
    process: Any = subprocess.Popen(
        [*COMMAND, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cwd,
        env=environment(PYTHONUNBUFFERED="1"),
    )  # fmt: skip
    return cast(Started, process)


@contextlib.contextmanager
def started_python(code: str | Path, *arguments: str | Path, cwd: Path | None = None) -> Iterator[Started]:
    """Start a script, or code as after `python -c`; it is killed and awaited at the end."""
    words = [str(each) for each in arguments]
    if hasattr(os, "fork"):
        kind = {"code": code} if isinstance(code, str) else {"script": str(code)}
        process = Started(words, cwd, **kind)
    else:
        what = ["-c", code] if isinstance(code, str) else [str(code)]
        running: Any = subprocess.Popen(
            [sys.executable, *what, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cwd,
            env=environment(),
        )  # fmt: skip
        process = cast(Started, running)
    try:
        yield process
    finally:
        if process.returncode is None:
            process.kill()
            process.communicate(timeout=60)
