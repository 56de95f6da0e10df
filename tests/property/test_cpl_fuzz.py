"""Wrong CPL programs: each runs or is refused at its place, without a traceback and in bounded time."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

import pytest

from support.cpl_fuzz import outcome, source

CPU_S = 120.0
"""The processor time after which a program is taken to hang: the slowest needs less than a hundredth of it."""


class Hangs(BaseException):
    """A program does not come to its end; no reader catches it."""


@contextmanager
def bounded() -> Iterator[None]:
    def late(_signal: int, _frame: FrameType | None) -> None:
        raise Hangs

    before = signal.signal(signal.SIGVTALRM, late)
    signal.setitimer(signal.ITIMER_VIRTUAL, CPU_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


@pytest.mark.parametrize("count", [500, pytest.param(100_000, marks=pytest.mark.long)])
def test_no_source_gives_a_traceback_or_hangs(count: int) -> None:
    ran = 0
    for seed in range(count):
        text = source(seed)
        with bounded():
            errors = outcome(text)
        ran += not errors
        for error in errors:
            assert error.position is not None, f"{seed}: {error}"
            assert error.position.file in ("main.cpl", "SUB"), seed
            lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
            if error.position.file == "main.cpl":
                assert error.position.text == lines[error.position.line - 1], seed
            assert error.what, seed
            assert len(str(error).splitlines()) >= 2, seed
    assert 0.1 * count < ran < 0.5 * count  # neither refuses all, nor takes all
