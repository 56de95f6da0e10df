"""Write a program so that its file is whole or absent: into a temporary file that gets its name at the end."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from polycnc.errors import UsageError
from polycnc.post.macros._control_parameters import CODECS, Parameters

_LINE_ENDS = {"lf": "\n", "crlf": "\r\n"}


@contextmanager
def program_file(path: str | Path, parameters: Parameters) -> Iterator[TextIO]:
    """Open a file for a program, in the encoding and with the line ends of the control file.

    The file gets its name when the body ends well; until then, and after an error, what was there stays.

    Raises:
        UsageError: The file cannot be written.
    """
    path = Path(path)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    if path.is_dir():
        raise UsageError(f"{path} is a folder", hint="give the name of a file")
    try:
        file = open(  # noqa: SIM115 (closed below, before the file gets its name)
            partial, "w", encoding=CODECS[parameters.encoding], newline=_LINE_ENDS[parameters.line_end]
        )
    except OSError as error:
        raise UsageError(
            f"{path} cannot be written: {error.strerror}", hint="check the folder and its access rights"
        ) from error
    try:
        with file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
