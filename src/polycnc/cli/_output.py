"""What the commands print with: tables and progress for people, one JSON object for programs."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

COLD_START = "Compiling the motion kernel for this machine; this happens once after an installation and takes some seconds."


def console() -> Console:
    """Return the console for standard output."""
    from rich.console import Console

    return Console(soft_wrap=True)


def error_console() -> Console:
    """Return the console for standard error."""
    from rich.console import Console

    return Console(stderr=True, soft_wrap=True)


def print_json(data: Any) -> None:
    """Print one JSON object; numbers that JSON does not have become null."""
    sys.stdout.write(json.dumps(_plain(data), indent=2, allow_nan=False) + "\n")


def _plain(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(value) for value in data]
    if isinstance(data, float) and (data != data or data in (float("inf"), float("-inf"))):
        return None
    return data


def say_if_cold() -> None:
    """Say why the first run takes longer."""
    from polycnc.kernel import is_cold

    if is_cold():
        error_console().print(f"[dim]{COLD_START}[/]")


@contextmanager
def progress_bar(title: str, *, quiet: bool) -> Iterator[Callable[[float], None]]:
    """Show a bar on standard error while the body runs; the body calls what it is given with parts of 1."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    display = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
        console=error_console(),
        transient=True,
        disable=quiet or not sys.stderr.isatty(),
    )
    with display:
        task = display.add_task(title, total=1.0)
        yield lambda part: display.update(task, completed=part)


def duration(seconds: float) -> str:
    """Return a time as people write it: 0.250 s, 1:02.500 min, 2:03:04.500 h."""
    if seconds < 60.0:
        return f"{seconds:.3f} s"
    minutes, rest = divmod(seconds, 60.0)
    hours, minutes = divmod(int(minutes), 60)
    return f"{hours}:{minutes:02d}:{rest:06.3f} h" if hours else f"{minutes}:{rest:06.3f} min"
