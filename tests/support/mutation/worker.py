"""Runs tests in forked children; one request a line and one answer, as JSON: `python -m mutation.worker (fresh|ready)`.

`fresh` has the heavy imports after it and imports polycnc anew for each request: `arguments` for pytest, `only` (the
tests to run, in that order, or null), `watch` (the files whose lines are asked for), `slowest_s` (of processor time,
after which a test fails) and `limit_s`. The answer has `status`, the tests' `times_s`, those that `failed` and, for
each watched file, its `lines` with the numbers of the `tests` that ran them; -1 is an import.

`ready` takes `arguments` first, collects those tests once, and runs some of them for each request with the functions
of `file` as they are in the text `after` instead of `before`, until one fails.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Generator, Iterator
from typing import Any, NoReturn, TextIO

import numba  # noqa: F401
import numpy  # noqa: F401  (what every run would import again)
import pydantic  # noqa: F401
import pytest

from ._children import TEST_LIMIT_S, Answer, answer_of, limited
from ._exchange import NotExchangeableError, exchange
from ._lines import Watch


class _TooSlow(BaseException):
    """Ends a test; no test and no hypothesis takes it for a failure of its own."""


class Choice:
    """Takes away what is not asked for and remembers how long each test took, and what it reached."""

    def __init__(self, only: list[str] | None, watch: Watch | None, slowest_s: float) -> None:
        self.only = only
        self.watch = watch
        self.slowest_s = slowest_s
        self.times_s: dict[str, float] = {}
        self.failed: set[str] = set()
        self.tests: list[str] = []
        self.lines: dict[str, dict[int, list[int]]] = {}

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        if self.only is not None:
            places = {test: place for place, test in enumerate(self.only)}
            items[:] = sorted(
                (item for item in items if item.nodeid in places), key=lambda item: places[item.nodeid]
            )

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        self.note(-1)  # what ran before belongs to no test
        try:
            return (yield)
        finally:
            self.tests.append(item.nodeid)
            self.note(len(self.tests) - 1)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Generator[None, Any, Any]:
        def end_slow(*_: object) -> NoReturn:
            raise _TooSlow

        signal.signal(signal.SIGPROF, end_slow)
        signal.setitimer(signal.ITIMER_PROF, self.slowest_s)
        try:
            return (yield)
        except _TooSlow:  # kept from pytest, which cannot tell of every place where a signal may arrive
            self.failed.add(item.nodeid)
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)

    def note(self, test: int) -> None:
        """Let what ran since the last call be of a test."""
        if self.watch is not None:
            for file, lines in self.watch.taken().items():
                seen = self.lines.setdefault(file, {})
                for line in lines:
                    seen.setdefault(line, []).append(test)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.times_s[report.nodeid] = self.times_s.get(report.nodeid, 0.0) + report.duration
        if report.failed:
            self.failed.add(report.nodeid)


def run(request: dict[str, Any]) -> Answer:
    """Run pytest in this process."""
    watch = Watch(request["watch"]) if request["watch"] else None
    if watch:
        sys.dont_write_bytecode = True  # the notes stay out of it
    choice = Choice(request["only"], watch, request["slowest_s"])
    status = pytest.main(request["arguments"], plugins=[choice])
    for file, lines in watch.imported.items() if watch else ():
        for line in lines:
            choice.lines.setdefault(file, {}).setdefault(line, []).append(-1)
    return {
        "status": int(status),
        "times_s": choice.times_s,
        "failed": sorted(choice.failed),
        "tests": choice.tests,
        "lines": choice.lines,
    }


class Ready:
    """Runs some of the collected tests for each request."""

    def __init__(self, requests: Iterator[str], answers: TextIO) -> None:
        self.requests = requests
        self.answers = answers
        self.failed = False

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        items = {item.nodeid: item for item in session.items}
        for line in self.requests:
            request = json.loads(line)

            def work(request: dict[str, Any] = request) -> Answer:
                return self.told(items, request)

            print(answer_of(work, request["limit_s"], request["output"]), file=self.answers, flush=True)
        return True

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.failed |= report.failed

    def told(self, items: dict[str, pytest.Item], request: dict[str, Any]) -> Answer:
        """Return what tests say to a change."""
        try:
            exchange(request["file"], request["before"].encode(), request["after"].encode())
        except NotExchangeableError:
            return {"status": None}
        chosen = [items[test] for test in request["only"] if test in items]
        for item, following in zip(chosen, [*chosen[1:], None], strict=True):
            limited(TEST_LIMIT_S + 10 * request["times_s"][item.nodeid])
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
            if self.failed:
                break
        limited(0.0)
        return {"status": int(self.failed), "by": item.nodeid if self.failed else ""}


def main() -> None:
    """Answer requests."""
    requests, answers = os.fdopen(os.dup(0)), os.fdopen(os.dup(1), "w")
    if sys.argv[1] == "fresh":
        for line in requests:
            request = json.loads(line)

            def work(request: dict[str, Any] = request) -> Answer:
                return run(request)

            print(answer_of(work, request["limit_s"], request["output"]), file=answers, flush=True)
        return
    first = json.loads(requests.readline())
    said = os.open(first["output"], os.O_CREAT | os.O_TRUNC | os.O_WRONLY)
    os.dup2(said, 1)
    os.dup2(said, 2)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    pytest.main(first["arguments"], plugins=[Ready(iter(requests), answers)])


if __name__ == "__main__":
    main()
