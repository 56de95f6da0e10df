"""Work in a forked child that can be ended, with an answer in JSON."""

from __future__ import annotations

import contextlib
import json
import os
import resource
import signal
import threading
import traceback
from collections.abc import Callable
from typing import Any

TIMEOUT, CRASH = "timeout", "crash"
MEMORY_BYTES = 6 << 30  # a change can ask for everything there is
TEST_LIMIT_S = 10.0

Answer = dict[str, Any]


def answer_of(work: Callable[[], Answer], limit_s: float, output: str) -> str:
    """Return what `work` says in a child, as JSON; its `status` is "timeout" or "crash" where it says nothing."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        try:
            _quiet(output)
            said = json.dumps(work())
            with os.fdopen(writing, "w") as pipe:
                pipe.write(said)
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(0)
    os.close(writing)
    late = threading.Event()

    def end_late() -> None:
        late.set()
        end(child)

    timer = threading.Timer(limit_s, end_late)
    timer.start()
    with os.fdopen(reading) as stream:
        text = stream.read()
    timer.cancel()
    end(child)  # what a test left running
    status = os.waitpid(child, 0)[1]
    if text:
        return text
    slow = late.is_set() or (os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGPROF)
    return json.dumps({"status": TIMEOUT if slow else CRASH})


def limited(limit_s: float) -> None:
    """End this process if it is not called again within a processor time; 0 for never."""
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_PROF, limit_s)


def end(child: int) -> None:
    """End a child and what it started; both may have ended by themselves."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)


def _quiet(output: str) -> None:
    """Read nothing and print into a file."""
    os.setsid()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    nothing = os.open(os.devnull, os.O_RDONLY)
    said = os.open(output, os.O_CREAT | os.O_TRUNC | os.O_WRONLY)
    for stream, to in ((0, nothing), (1, said), (2, said)):
        os.dup2(to, stream)
