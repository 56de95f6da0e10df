"""Runs tests in forked children of a process that has the heavy imports behind it; one request a line, as JSON.

A request has `output` (the file for what pytest says), `arguments` for pytest, `only` (the tests to run, in that order,
or null), `trace` (the files whose lines are watched) and `limit_s`; an answer has `status`, the tests' `times_s`, those
that `failed` and, for each traced file, its `lines`.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import sys
import threading
import time
import traceback
from types import FrameType
from typing import Any

import numba  # noqa: F401
import numpy  # noqa: F401  (what every run would import again)
import pydantic  # noqa: F401
import pytest

TIMEOUT = "timeout"


class Choice:
    """Takes away what is not asked for and remembers how long each test took."""

    def __init__(self, only: list[str] | None) -> None:
        self.only = only
        self.times_s: dict[str, float] = {}
        self.failed: set[str] = set()

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        if self.only is not None:
            places = {test: place for place, test in enumerate(self.only)}
            items[:] = sorted(
                (item for item in items if item.nodeid in places), key=lambda item: places[item.nodeid]
            )

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.times_s[report.nodeid] = self.times_s.get(report.nodeid, 0.0) + report.duration
        if report.failed:
            self.failed.add(report.nodeid)


class Watch:
    """Notes which test runs which line of some files."""

    def __init__(self, files: list[str]) -> None:
        self.lines: dict[str, dict[int, set[str]]] = {file: {} for file in files}
        self.test = ""  # imports belong to no test
        sys.settrace(self.enter)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Any:
        self.test = item.nodeid
        sys.settrace(self.enter)
        threading.settrace(self.enter)
        try:
            return (yield)
        finally:
            self.test = ""
            threading.settrace(None)

    def enter(self, frame: FrameType, event: str, argument: object) -> Any:
        seen = self.lines.get(frame.f_code.co_filename)
        if seen is None:
            return None
        test = self.test

        def line(frame: FrameType, event: str, argument: object) -> Any:
            seen.setdefault(frame.f_lineno, set()).add(test)
            return line

        return line(frame, event, argument)


def run(request: dict[str, Any], answer: int) -> None:
    """Run pytest in this process and write what came out of it to a pipe."""
    os.setsid()
    nothing, said = (
        os.open(os.devnull, os.O_RDONLY),
        os.open(request["output"], os.O_CREAT | os.O_TRUNC | os.O_WRONLY),
    )
    for stream, to in ((0, nothing), (1, said), (2, said)):
        os.dup2(to, stream)
    choice = Choice(request["only"])
    watches = [Watch(request["trace"])] if request["trace"] else []
    status = pytest.main(request["arguments"], plugins=[choice, *watches])
    sys.settrace(None)
    lines = {
        file: {line: sorted(tests) for line, tests in seen.items()}
        for watch in watches
        for file, seen in watch.lines.items()
    }
    with os.fdopen(answer, "w") as pipe:
        found = {
            "status": int(status),
            "times_s": choice.times_s,
            "failed": sorted(choice.failed),
            "lines": lines,
        }
        json.dump(found, pipe)


def answered(request: dict[str, Any]) -> str:
    """Return the answer of a child, or that it ran out of time."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        try:
            run(request, writing)
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(0)
    os.close(writing)
    late = threading.Timer(request["limit_s"], end, [child])
    late.start()
    begun = time.monotonic()
    with os.fdopen(reading) as stream:
        text = stream.read()
    late.cancel()
    end(child)  # what a test left running
    os.waitpid(child, 0)
    if text:
        return text
    in_time = time.monotonic() - begun < request["limit_s"]
    return json.dumps({"status": "crash" if in_time else TIMEOUT, "times_s": {}, "failed": [], "lines": {}})


def end(child: int) -> None:
    """End a child and what it started; both may have ended by themselves."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)


if __name__ == "__main__":
    for text in sys.stdin:
        print(answered(json.loads(text)), flush=True)
