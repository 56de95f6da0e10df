"""What happened and what was asked, one JSON object a line."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TextIO

from polycnc.errors import UsageError


class Log:
    """Write lines to a file, appended; without one they are forgotten.

    Raises:
        UsageError: The file cannot be opened.
        OSError: There is no room for what is written; it names the file.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._file: TextIO | None = None
        if path is not None:
            try:
                self._file = path.open("a", encoding="utf-8")
            except OSError as error:
                raise UsageError(
                    f"{path}: cannot be written: {error.strerror}", hint="Name a file that can be written."
                ) from None

    def write(self, event: str, **fields: Any) -> None:
        """Write what happened, with the time of the computer (ISO, UTC)."""
        if self._file is not None:
            line = {"time": datetime.now(UTC).isoformat(timespec="milliseconds"), "event": event, **fields}
            with _named(self._file):
                self._file.write(json.dumps(line, ensure_ascii=True, default=str) + "\n")
                self._file.flush()

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            file, self._file = self._file, None
            with _named(file):
                file.close()


@contextmanager
def _named(file: TextIO) -> Iterator[None]:
    """Let an error of a file tell its name: that of a full disk does not."""
    try:
        yield
    except OSError as error:
        error.filename = error.filename or file.name
        raise
