"""What happened and what was asked, one JSON object a line."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TextIO

from polycnc.errors import UsageError


class Log:
    """Write lines to a file, appended; without one they are forgotten.

    Raises:
        UsageError: The file cannot be written.
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
            self._file.write(json.dumps(line, ensure_ascii=True, default=str) + "\n")
            self._file.flush()

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()
            self._file = None
