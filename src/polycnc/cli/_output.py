"""What the commands print with: text in columns for people, one JSON object for programs, a bar."""

from __future__ import annotations

import errno
import json
import logging
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

_BAR_AFTER_S = 2.0
_BAR_STEP_S = 0.1


_FULL = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT if hasattr(errno, "EDQUOT") else errno.ENOSPC)


@contextmanager
def named_output() -> Iterator[None]:
    """Let an error of a full disk name the output, which has no file's name."""
    try:
        yield
    except OSError as error:
        if error.errno in _FULL and error.filename is None:
            error.filename = "the output"
        raise


def echo(text: str, *, nl: bool = True, err: bool = False) -> None:
    """Print a text as it is."""
    with named_output():
        typer.echo(text, nl=nl, err=err)


def flush() -> None:
    """Write what was printed."""
    with named_output():
        sys.stdout.flush()


def say(text: str = "", *, lead: str = "") -> None:
    """Print a line for people: `lead` as it is, then `text`."""
    echo(lead + _printable(text))


def say_error(text: str, *, lead: str = "") -> None:
    """Print an error or a remark to standard error."""
    echo(lead + _printable(text), err=True)


def bold(text: str) -> str:
    """Return `text` as a lead in bold letters, where the output is a terminal."""
    return _styled(text, bold=True)


def bold_red(text: str) -> str:
    """Return `text` as a lead in bold red letters, where the output is a terminal."""
    return _styled(text, bold=True, fg="red")


def _styled(text: str, **style: Any) -> str:
    """Return `text` in a style, which is left out where the output is no terminal or NO_COLOR is set."""
    return text if os.environ.get("NO_COLOR") else typer.style(text, **style)


def say_problem(text: str, *, lead: str = "", error: bool = False) -> None:
    """Print an error or a remark on a program: its first line bold, the caret below the place in red."""
    first, *rest = _printable(text).split("\n")
    lines = [lead + bold(first)]
    lines += [_styled(line, bold=True, fg="red") if line.strip() == "^" else line for line in rest]
    echo("\n".join(lines), err=error)


def _printable(text: str) -> str:
    """Return text without control characters, which a terminal would obey."""
    return "".join(
        char if char.isprintable() or char in "\n\t" else "\N{REPLACEMENT CHARACTER}" for char in text
    )


def columns(rows: Iterable[Sequence[str]], right: Sequence[int] = ()) -> list[str]:
    """Return rows of cells as lines with aligned columns, those numbered in `right` aligned right."""
    rows = list(rows)
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.rjust(width) if i in right else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def print_json(data: Any) -> None:
    """Print one JSON object; numbers that JSON does not have become null."""
    echo(json.dumps(_plain(data), indent=2, allow_nan=False))


def _plain(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(value) for value in data]
    if isinstance(data, float) and (data != data or data in (float("inf"), float("-inf"))):
        return None
    return data


class _Remarks(logging.Handler):
    """Prints what the packages below log: why it takes a while, and what is wrong with the cache."""

    def emit(self, record: logging.LogRecord) -> None:
        say_error(record.getMessage())


def print_remarks() -> None:
    """Print remarks of the packages below to standard error, as remarks of the command."""
    log = logging.getLogger("polycnc")
    log.addHandler(_Remarks())
    log.propagate = False


class _Bar:
    """A bar on standard error, which appears when the work has lasted a while."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._next_s = time.monotonic() + _BAR_AFTER_S
        self._display: Progress | None = None
        self._task: TaskID | None = None

    def __call__(self, part: float) -> None:
        now_s = time.monotonic()
        if now_s < self._next_s:
            return
        self._next_s = now_s + _BAR_STEP_S
        if self._display is None or self._task is None:
            self._display = _display()
            self._task = self._display.add_task(self._title, total=1.0)
            self._display.start()
        self._display.update(self._task, completed=part)

    def close(self) -> None:
        if self._display is not None:
            self._display.stop()


def _display() -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    text = TextColumn("{task.description}", markup=False)
    return Progress(
        text,
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
    )


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[[float], None] | None]:
    """Show a bar on a terminal while the body runs, if that takes long; the body calls it with parts of 1."""
    if not sys.stderr.isatty():
        yield None
        return
    bar = _Bar(_printable(title))
    try:
        yield bar
    finally:
        bar.close()
