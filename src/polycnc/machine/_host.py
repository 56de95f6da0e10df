"""A thread that owns a device, so that many others can command and watch it.

Nobody but the owner touches the device: others post commands, which are carried out one after the other between two
`advance` calls, and read the status that was published last. There is no lock below this.
"""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from typing import Any, Generic, Self, TypeVar

from polycnc.errors import PolycncError, UsageError
from polycnc.machine._device import Device
from polycnc.machine._pace import Pace, Wall
from polycnc.machine._ways import slice_cycles

D = TypeVar("D", bound=Device[Any])
R = TypeVar("R")
_LONGEST_WAIT_S = 1.0  # for the wall clock; whoever posts a command wakes the owner at once


class HostError(PolycncError):
    """A host that is closed, or whose device has failed."""


class Host(Generic[D]):
    """Let the time of `device` pass in a thread of its own, at the pace of a wall clock that is passed in.

    `rate` is seconds of the device for each second outside, 0 to begin with it frozen; `pace` changes it while it runs.
    `events` are the reasons of the device that end a jump of the pace. At least every `slice_s` commands are looked at.
    From `start` to `stop` or `close` the device is the host's; a `with` statement does both.
    """

    def __init__(
        self, device: D, wall: Wall, *, rate: float = 1.0, events: int | None = None, slice_s: float = 0.01
    ) -> None:
        if not 0.0 < slice_s < math.inf:
            raise UsageError(f"a slice of {slice_s} s", hint="give a time above 0")
        self.pace = Pace(wall, rate, changed=self._wake)
        self._wall = wall
        self._device = device
        self._events = events
        self._slice_s = slice_s
        self._changed = threading.Condition()  # guards what follows
        self._posted: deque[tuple[Callable[[D], Any], Future[Any]]] = deque()
        self._status: Any = device.status()
        self._published = 0
        self._awake = False
        self._stopping = self._closed = False
        self._failure: BaseException | None = None
        self._thread: threading.Thread | None = None  # None: it does not run
        self._observers: list[Callable[[], object]] = []

    # ------------------------------------------------------------------ from any thread

    @property
    def status(self) -> Any:
        """Return the status of the device that was published last, all of one cycle."""
        return self._status

    @property
    def running(self) -> bool:
        """Tell whether the owner lets time pass."""
        return self._thread is not None

    @property
    def failure(self) -> BaseException | None:
        """Return what ended the device's time for good; None while all is well."""
        return self._failure

    def start(self) -> None:
        """Let the owner begin, or go on after `stop`; time that has passed outside until now is not caught up with.

        Raises:
            HostError: The host is closed or runs, or the device has failed.
        """
        with self._changed:
            if self._closed or self._failure is not None or self._thread is not None:
                raise HostError("the host cannot be started", hint="start it once, or again after `stop`")
            self._status = self._device.status()
            self._published += 1
            self._stopping = False
            self._thread = threading.Thread(target=self._own, name="polycnc host", daemon=True)
            self.pace.forget()
            self._thread.start()

    def post(self, command: Callable[[D], R]) -> Future[R]:
        """Have `command` called with the device between two cycles; return its result, when there is one.

        Commands are carried out in the order in which they were posted. When the result is there, a status after the
        command has been published. A command that raises an error does so to whoever asks for its result.

        Raises:
            HostError: The host is not running, or the device has failed.
        """
        future: Future[R] = Future()
        with self._changed:
            self._refuse()
            self._posted.append((command, future))
            self._awake = True
            self._changed.notify_all()
        return future

    def call(self, command: Callable[[D], R]) -> R:
        """Carry out `command` like `post`, wait for it and return its result.

        Raises:
            HostError: The host is not running, or the device has failed; or this is the owner, who would wait for
                itself.
            Exception: Whatever the command raises.
        """
        self._refuse_owner()
        return self.post(command).result()

    def wait(self, condition: Callable[[Any], bool], timeout_s: float | None = None) -> Any:
        """Wait until `condition` holds for a published status and return that one; not every status is seen.

        Raises:
            HostError: The host is closed or the device has failed before, or `timeout_s` of the wall
                clock is over.
        """
        self._refuse_owner()
        end_s = math.inf if timeout_s is None else self._wall.now_s() + timeout_s
        while True:
            with self._changed:
                status, published = self._status, self._published
            if condition(status):
                return status
            left_s = end_s - self._wall.now_s()
            if left_s <= 0.0:
                raise HostError(f"nothing of the kind for {timeout_s} s", hint="wait for something else")
            with self._changed:
                if self._published == published:
                    self._refuse()
                    self._changed.wait(min(left_s, _LONGEST_WAIT_S))

    def observe(self, told: Callable[[], object]) -> Callable[[], None]:
        """Call `told` in the owner's thread after each published status and at its end; return what ends that."""
        with self._changed:
            self._observers = [*self._observers, told]

        def end() -> None:
            with self._changed:
                self._observers = [each for each in self._observers if each is not told]

        return end

    def stop(self) -> None:
        """End the thread after the cycle that it is in; what was posted before is carried out.

        Until `start` the device is the caller's. Stopping twice does nothing.
        """
        with self._changed:
            thread = self._thread
            self._stopping = self._awake = True
            self._changed.notify_all()
        if thread is not None and threading.current_thread() is not thread:
            thread.join()

    def close(self) -> None:
        """Stop for good. Closing twice does nothing."""
        self._closed = True
        self.stop()

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _wake(self) -> None:
        with self._changed:
            self._awake = True
            self._changed.notify_all()

    def _refuse_owner(self) -> None:
        if threading.current_thread() is self._thread:
            raise HostError("a command waits for another command", hint="call the device itself")

    def _refuse(self) -> None:
        if self._failure is not None:
            raise _failed(self._failure)
        if self._stopping or self._thread is None:
            raise HostError("the host is not running", hint="start it, and do not stop it before")

    # ------------------------------------------------------------------ the owner

    def _own(self) -> None:
        try:
            while self._carry_out():
                self._let_time_pass()
        except BaseException as error:
            self._end(error)
        else:
            self._end(None)

    def _end(self, failure: BaseException | None) -> None:
        """Answer whoever waits; nobody is left without."""
        with self._changed:
            self._failure, self._thread = failure, None
            left = list(self._posted)
            self._posted.clear()
            self._changed.notify_all()
        for _, future in left if failure is not None else ():
            if future.set_running_or_notify_cancel():
                future.set_exception(_failed(failure))
        self._tell()

    def _carry_out(self) -> bool:
        """Do what was posted and publish; return whether there is anything to be done later."""
        with self._changed:
            commands = list(self._posted)
            self._posted.clear()
            self._awake = False
            stopping = self._stopping
        answers: list[Callable[[], None]] = []
        for command, future in commands:
            if future.set_running_or_notify_cancel():
                answers.append(_answer(command, self._device, future))
        try:
            if commands:
                self._publish()
        finally:
            for answer in answers:
                answer()
        return not stopping

    def _let_time_pass(self) -> None:
        cycle_s = self._device.clock.cycle_s
        most = slice_cycles(self.pace.rate, cycle_s, self._slice_s)
        jump = self.pace.take_jump()
        due = jump or self.pace.due(cycle_s, most)
        moved = self._device.advance(due, until=self._events if jump else None) if due else 0
        if moved:
            if not jump:
                self.pace.count(moved)
            self._publish()
        else:
            self._sleep(self.pace.wait_s(cycle_s, most) if due == 0 else self._slice_s)

    def _sleep(self, duration_s: float) -> None:
        """Wait for the next command, for at most about `duration_s`."""
        with self._changed:
            if not self._awake:
                self._changed.wait(None if duration_s == math.inf else min(duration_s, _LONGEST_WAIT_S))

    def _publish(self) -> None:
        status = self._device.status()
        with self._changed:
            self._status = status
            self._published += 1
            self._changed.notify_all()
        self._tell()

    def _tell(self) -> None:
        for told in self._observers:
            told()


def _failed(failure: BaseException | None) -> HostError:
    error = HostError(f"the device has failed: {type(failure).__name__}: {failure}", hint="make a new one")
    error.__cause__ = failure
    return error


def _answer(command: Callable[[D], R], device: D, future: Future[R]) -> Callable[[], None]:
    """Carry out a command and return what tells its result."""
    try:
        result = command(device)
    except BaseException as error:
        return partial(future.set_exception, error)
    return partial(future.set_result, result)
