"""How errors end a command: one message on standard error and an exit status, never a traceback.

0 clean, 1 program error or alarm, 2 usage, 130 interrupted.
"""

from __future__ import annotations

import functools
import os
import signal
import sys
from collections.abc import Callable
from typing import NoReturn, ParamSpec

from polycnc.cli._output import bold_red, say_problem
from polycnc.errors import PolycncError, UsageError

P = ParamSpec("P")

PROGRAM = 1
USAGE = 2
INTERRUPTED = 128 + signal.SIGINT


def guarded(command: Callable[P, None]) -> Callable[P, None]:
    """Return `command` with its errors turned into messages and exit statuses."""

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            command(*args, **kwargs)
            sys.stdout.flush()
        except UsageError as error:
            _end(str(error), USAGE)
        except PolycncError as error:
            _end(str(error), PROGRAM)
        except KeyboardInterrupt:
            _end("interrupted", INTERRUPTED)
        except BrokenPipeError:
            # Whoever read the output has left; nothing more can be said, at the end of the process neither.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            sys.exit(PROGRAM)
        except OSError as error:
            name = f"{error.filename}: " if error.filename else ""
            _end(f"{name}{error.strerror or error}", PROGRAM)

    return run


def _end(text: str, status: int) -> NoReturn:
    say_problem(text, lead=bold_red("error: "), error=True)
    sys.exit(status)


def end_on_termination() -> None:
    """Let SIGTERM end the process as an exception does, so that no partial file stays behind."""

    def leave(number: int, _: object) -> None:
        sys.exit(128 + number)

    signal.signal(signal.SIGTERM, leave)
