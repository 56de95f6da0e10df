"""The process that runs programs one after the other, and the hand that holds it: waits, ends it, starts another.

Compiled code that hangs lets nothing else happen in its process, so what may hang is never run where somebody waits.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import signal
import struct
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from polycnc.errors import PolycncError
from polycnc.runner.batches._job import Answer, Job, Setup, answer_of, blank_report, report_of

_HEAD = struct.Struct("<Q")
_START_S = 600.0  # the first start on a machine compiles
_GRACE_S = 10  # by which a process outlives the time-out that its parent did not see
_ATTEMPTS = 3
_NEW_GROUP = 0x200  # of Windows
# Every run begins with large arrays of zeros of which a short program touches little. glibc fetches such from the
# system, which clears them page by page on use, until it has seen some freed; from then on it clears them whole.
_ALLOCATION = {"MALLOC_MMAP_THRESHOLD_": "131072"}
_WARM = b"G0 X1\nG1 X2 F600\nM30\n"


class BatchError(PolycncError):
    """Programs cannot be run in processes of their own, or on the cluster."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What one program may take; 0 is without limit. The limit of memory holds on Linux."""

    time_s: float = 600.0
    memory_mb: float = 4096.0


class Child:
    """A process that runs jobs; a hanging one is ended and replaced."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._process: subprocess.Popen[bytes] | None = None
        self._answers: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._said: IO[bytes] | None = None
        self._setups: Sequence[Setup] | None = None
        self._gate = threading.Lock()
        self._closed = False

    @property
    def process_id(self) -> int | None:
        """The number of the process, None while there is none."""
        return None if self._process is None else self._process.pid

    def answers(self, jobs: Sequence[Job], setups: Sequence[Setup]) -> Iterator[Answer]:
        """Run jobs one after the other; every one gives an answer.

        All of them are sent at once, so that the process never waits for somebody who is busy with what it said.

        Raises:
            BatchError: no process can be started.
        """
        done = attempts = 0
        sent = False
        while done < len(jobs):
            if self._process is None or self._setups is not setups:
                self._begin(setups)
                sent = False
            answer = self._next_answer(jobs[done], setups, () if sent else jobs[done:])
            sent = True
            if answer is None:
                attempts += 1
                how = self._ended()
                if self._closed:
                    raise BatchError("the batch was stopped")
                if attempts < _ATTEMPTS:
                    continue
                text = f"{jobs[done].name}: its process ended {_ATTEMPTS} times before the program did{how}"
                answer = answer_of(blank_report(jobs[done], setups[jobs[done].setup], "lost", text))
            yield answer
            done, attempts = done + 1, 0

    def close(self) -> None:
        """End the process, whatever it does; nothing is started any more."""
        with self._gate:
            self._closed = True
            self._end()

    def _next_answer(self, job: Job, setups: Sequence[Setup], send: Sequence[Job]) -> Answer | None:
        """Send jobs, and return the answer to the first one that is open; None if the process has ended."""
        try:
            if send:
                self._send(("jobs", list(send)))
            answer = self._answers.get(timeout=self._limits.time_s or None)
        except queue.Empty:
            self._stop()
            late = f"{job.name}: stopped after {self._limits.time_s:g} s"
            return answer_of(blank_report(job, setups[job.setup], "time-out", late))
        except OSError:
            return None
        if answer == "memory":
            self._stop()
            limit = f"{job.name}: needs more than {self._limits.memory_mb:g} MB of memory"
            return answer_of(blank_report(job, setups[job.setup], "memory", limit))
        return Answer(*answer) if isinstance(answer, tuple) else None

    def _begin(self, setups: Sequence[Setup]) -> None:
        how = ""
        for _ in range(_ATTEMPTS):
            if self._process is not None:
                break
            how = self._try_to_start()
        else:
            if self._process is None:
                raise BatchError(
                    f"no process could be started that runs programs{how}",
                    hint="Try `polycnc run` on one of the programs.",
                )
        self._setups = setups
        with contextlib.suppress(OSError):  # the first job will find out
            self._send(("setups", tuple(setups), self._limits))

    def _try_to_start(self) -> str:
        """Start the process and wait until it is warm; where that fails, tell how."""
        with self._gate:
            if self._closed:
                raise BatchError("the batch was stopped")
            self._start()
        try:
            ready = self._answers.get(timeout=_START_S)
        except queue.Empty:
            ready = None
        return "" if ready == "ready" else self._ended()

    def _start(self) -> None:
        package = str(Path(__file__).parents[3])
        path = os.pathsep.join([package, *filter(None, [os.environ.get("PYTHONPATH")])])
        group: dict[str, Any] = (
            {"creationflags": _NEW_GROUP} if sys.platform == "win32" else {"start_new_session": True}
        )  # so that Ctrl-C comes to the batch alone, which then ends its processes
        self._said = tempfile.TemporaryFile()  # noqa: SIM115  # it lives as long as the process
        self._answers = queue.SimpleQueue()
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", "from polycnc.runner.batches import serve_jobs; serve_jobs()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._said,
            env={**_ALLOCATION, **os.environ, "PYTHONPATH": path, "PYTHONUTF8": "1"},
            **group,
        )
        reader = threading.Thread(
            target=_read_all, args=(self._process.stdout, self._answers), name="polycnc answers", daemon=True
        )
        reader.start()

    def _send(self, message: object) -> None:
        process = self._process
        if process is None or process.stdin is None:
            raise BrokenPipeError
        _write(process.stdin, message)

    def _stop(self) -> None:
        with self._gate:
            self._end()

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        for stream in (process.stdin, self._said):  # the thread that reads its output closes that
            if stream is not None:
                with contextlib.suppress(OSError):
                    stream.close()

    def _ended(self) -> str:
        """Clear away a process that has ended by itself, and tell how it did."""
        said, process = self._said, self._process
        text = ""
        if process is not None and said is not None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(5.0)
            with contextlib.suppress(OSError, ValueError):
                said.seek(0)
                lines = said.read().decode("utf-8", "replace").strip().splitlines()
                status = "" if process.returncode is None else f" (status {process.returncode})"
                text = status + (f": {lines[-1]}" if lines else "")
        self._stop()
        return text


def serve_jobs() -> None:
    """Run the jobs that come on standard input, and answer each on standard output."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what is printed on the way is no answer
    questions = sys.stdin.buffer
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warm = Setup(machine=_default_machine())
    report_of(Job("", "warm", _WARM, 0), warm)
    _write(answers, "ready")
    setups: tuple[Setup, ...] = ()
    limits = Limits()
    for message in _messages(questions):
        if message[0] == "setups":
            setups, limits = message[1], message[2]
            _limit_memory(limits)
            continue
        for job in message[1]:
            _alarm(limits)
            answer = _answer(job, setups)
            _alarm(Limits(time_s=0.0))
            try:
                _write(answers, answer)
            except OSError:  # nobody waits any more
                return


def _answer(job: Job, setups: Sequence[Setup]) -> object:
    try:
        return tuple(answer_of(report_of(job, setups[job.setup])))
    except MemoryError:
        return "memory"


def _default_machine() -> Any:
    from polycnc.machine import load_machine

    return load_machine(None)


def _limit_memory(limits: Limits) -> None:
    """Let the process have so much more memory than it has now."""
    if sys.platform != "linux" or not limits.memory_mb:
        return
    import resource

    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = int(pages * resource.getpagesize() + limits.memory_mb * 2**20)
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (most if hard < 0 else min(most, hard), hard))


def _alarm(limits: Limits) -> None:
    """Let the system end the process if nobody else does: its parent may have ended while it hangs."""
    if sys.platform != "win32":
        signal.alarm(int(limits.time_s) + _GRACE_S if limits.time_s else 0)


def _messages(stream: Any) -> Iterator[Any]:
    while (message := _read(stream)) is not None:
        yield message


def _read_all(stream: Any, answers: queue.SimpleQueue[Any]) -> None:
    with contextlib.suppress(OSError, ValueError, EOFError, pickle.UnpicklingError):
        for message in _messages(stream):
            answers.put(message)
    with contextlib.suppress(OSError):
        stream.close()
    answers.put(None)


def _read(stream: Any) -> Any:
    head = stream.read(_HEAD.size)
    if len(head) < _HEAD.size:
        return None
    (size,) = _HEAD.unpack(head)
    data = stream.read(size)
    return pickle.loads(data) if len(data) == size else None


def _write(stream: Any, message: object) -> None:
    data = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(_HEAD.pack(len(data)) + data)
    stream.flush()
