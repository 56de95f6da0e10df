"""How errors end a command: one message on standard error and an exit status, never a traceback.

0 clean, 1 program error or alarm, 2 usage, 70 a mistake of polycnc itself, 130 interrupted.
"""

from __future__ import annotations

import errno
import functools
import math
import os
import platform
import shlex
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import NoReturn, ParamSpec

from polycnc import __version__
from polycnc.cli._output import bold_red, flush, say_problem
from polycnc.errors import PolycncError, UsageError

P = ParamSpec("P")

PROGRAM = 1
USAGE = 2
INTERNAL = 70  # EX_SOFTWARE
INTERRUPTED = 128 + signal.SIGINT

_STANDS_ON = ("numpy", "numba", "llvmlite", "pydantic", "typer")


def guarded(command: Callable[P, None]) -> Callable[P, None]:
    """Return `command` with its errors turned into messages and exit statuses."""

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            _check_numbers(kwargs)
            command(*args, **kwargs)
            flush()
        except UsageError as error:
            _end(str(error), USAGE)
        except PolycncError as error:
            _end(str(error), PROGRAM)
        except KeyboardInterrupt:
            _end("interrupted", INTERRUPTED)
        except OSError as error:
            if _reader_left(error):
                # Nothing more can be said, at the end of the process neither.
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
                sys.exit(PROGRAM)
            name = f"{error.filename}: " if error.filename else ""
            _end(f"{name}{error.strerror or error}", PROGRAM)
        except Exception as error:  # whatever it is, it is ours: nobody is shown a traceback
            end_with_report(error)

    return run


def _check_numbers(given: Mapping[str, object]) -> None:
    """Refuse what is no number in an option of numbers: no bounds keep it out.

    Raises:
        UsageError: There is one.
    """
    for name, value in given.items():
        if isinstance(value, float) and not math.isfinite(value):
            option = f"--{name.replace('_', '-')}"
            raise UsageError(f"{option} is {value}", hint=f"Give {option} a number.")


def _reader_left(error: OSError) -> bool:
    """Tell whether whoever read the output has left; Windows calls that an invalid argument."""
    windows = sys.platform == "win32" and error.errno == errno.EINVAL and error.filename is None
    return windows or isinstance(error, BrokenPipeError)


def end_with_report(error: Exception) -> NoReturn:
    """End the process with what a mistake of polycnc says to its user; the traceback goes into a file to send."""
    text = "".join((*_circumstances(), "\n", *traceback.format_exception(error)))
    what = f"{type(error).__name__}: {error}".split("\n", 1)[0][:200]
    try:
        handle, file = tempfile.mkstemp(prefix="polycnc-error-", suffix=".txt")
        with open(handle, "w", encoding="utf-8", errors="backslashreplace") as out:
            out.write(text)
        hint = f"Please report it, with {file}; it holds versions, the command and where it happened."
    except OSError:  # not even that: better on the screen than lost
        hint = f"Please report it, with what follows.\n{text}"
    _end(f"internal error, the mistake is not yours: {what}\n{hint}", INTERNAL)


def _circumstances() -> Iterator[str]:
    """Yield what is needed to repeat a failure, line by line."""
    yield f"polycnc {__version__}, Python {platform.python_version()}, {platform.platform()}\n"
    for name in _STANDS_ON:
        try:
            yield f"{name} {version(name)}\n"
        except PackageNotFoundError:
            yield f"{name} is not installed\n"
    yield f"command: {shlex.join(sys.argv)}\n"
    try:
        yield f"folder: {os.getcwd()}\n"
    except OSError as error:  # it may have been removed
        yield f"folder: {error}\n"


def _end(text: str, status: int) -> NoReturn:
    say_problem(text, lead=bold_red("error: "), error=True)
    sys.exit(status)


def check_environment() -> None:
    """End the process where a variable of the environment keeps the compiler from being loaded."""
    os.environ.pop("MPLBACKEND", None)  # files need none, and that of a notebook is not here
    threads = os.environ.get("NUMBA_NUM_THREADS", "1")
    if not (threads.strip().isascii() and threads.strip().isdigit() and int(threads[:9]) > 0):
        _end(f"NUMBA_NUM_THREADS is '{threads[:40]}'\nSet it to 1 or more, or not at all.", USAGE)


def end_on_termination() -> None:
    """Let SIGTERM end the process as an exception does, so that no partial file stays behind."""

    def leave(number: int, _: object) -> None:
        sys.exit(128 + number)

    for name in ("SIGTERM", "SIGBREAK"):  # the latter is Ctrl-Break, and the closing of a console, of Windows
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), leave)
