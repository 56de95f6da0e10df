"""Write a program so that its file is whole or absent: into a temporary file that gets its name at the end."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from polycnc.errors import UsageError
from polycnc.outputs import complete_or_absent
from polycnc.post.macros._control_parameters import CODECS, Parameters

_LINE_ENDS = {"lf": "\n", "crlf": "\r\n"}


@contextmanager
def program_file(path: str | Path, parameters: Parameters) -> Iterator[TextIO]:
    """Open a file for a program, in the encoding and with the line ends of the control file.

    The file gets its name when the body ends well; until then, and after an error, what was there stays.

    Raises:
        UsageError: The file cannot be written.
    """
    with complete_or_absent(Path(path), durable=True) as partial:
        try:
            file = partial.open(
                "w", encoding=CODECS[parameters.encoding], newline=_LINE_ENDS[parameters.line_end]
            )
        except OSError as error:
            raise UsageError(
                f"{path} cannot be written: {error.strerror}", hint="Check the folder and its access rights."
            ) from error
        with file:
            yield file
