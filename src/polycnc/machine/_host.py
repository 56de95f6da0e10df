"""A thread that owns a device, so that many others can command and watch it.

Nobody but the owner touches the device: others post commands, which are carried out one after the other between two
`advance` calls, and read the status that was published last. There is no lock below this.
"""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from types import TracebackType
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
    """Let the time of `device` pass in a thread of its own, at the pace of a lent wall clock.

    `rate` is seconds of the device for each second outside, 0 to begin with it frozen; `pace` changes it while it runs.
    `events` are the reasons of the device that end a jump of the pace. At least every `slice_s` commands are looked at.
    The device is the host's until `close`, which whoever made the host has to call (or use it in a `with` statement).
    """

    def __init__(
        self, device: D, wall: Wall, *, rate: float = 1.0, events: int | None = None, slice_s: float = 0.01
    ) -> None:
        if not 0.0 < slice_s < math.inf:
            raise UsageError(f"a slice of {slice_s} s", hint="give a time above 0")
        self.pace = _AwakePace(wall, rate, self._wake)
        self._device = device
        self._events = events
        self._slice_s = slice_s
        self._changed = threading.Condition()  # guards what follows
        self._posted: deque[tuple[Callable[[D], Any], Future[Any]]] = deque()
        self._status: Any = device.status()
        self._awake = False
        self._closing = False
        self._failure: BaseException | None = None
        self._thread = threading.Thread(target=self._own, name="polycnc host", daemon=True)
        self._running = False

    # ------------------------------------------------------------------ from any thread

    @property
    def status(self) -> Any:
        """Return the status of the device that was published last, all of one cycle."""
        return self._status

    @property
    def failure(self) -> BaseException | None:
        """Return what ended the device's time for good; None while all is well."""
        return self._failure

    def start(self) -> None:
        """Let the owner begin.

        Raises:
            HostError: The host is closed, or was started before.
        """
        with self._changed:
            if self._closing or self._running:
                raise HostError("the host was started before", hint="make a new one")
            self._running = True
            self._thread.start()

    def post(self, command: Callable[[D], R]) -> Future[R]:
        """Have `command` called with the device between two cycles; return its result, when there is one.

        Commands are carried out in the order in which they were posted. When the result is there, a status behind the
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
        if threading.current_thread() is self._thread:
            raise HostError("a command waits for another command", hint="call the device itself")
        try:
            return self.post(command).result()
        except CancelledError:
            raise HostError("the host was closed before the command", hint="make a new one") from None

    def wait(self, condition: Callable[[Any], bool], timeout_s: float | None = None) -> Any:
        """Wait until `condition` holds for a published status and return that one.

        Raises:
            HostError: The host is closed or the device has failed before, or `timeout_s` is over.
        """
        with self._changed:
            while True:
                status = self._status
                if condition(status):
                    return status
                self._refuse()
                if not self._changed.wait(timeout_s):
                    raise HostError(f"nothing happened for {timeout_s} s", hint="wait for something else")

    def close(self) -> None:
        """End the thread after the cycle that it is in; what was posted before is carried out.

        The device is the caller's again. Closing twice does nothing.
        """
        with self._changed:
            self._closing = self._awake = True
            self._changed.notify_all()
        if self._running and threading.current_thread() is not self._thread:
            self._thread.join()

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _wake(self) -> None:
        with self._changed:
            self._awake = True
            self._changed.notify_all()

    def _refuse(self) -> None:
        if self._failure is not None:
            raise HostError(
                f"the device has failed: {self._failure}", hint="make a new one"
            ) from self._failure
        if self._closing or not self._running:
            raise HostError("the host is not running", hint="start it, and do not close it before")

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
            self._failure, self._closing = failure, True
            left = list(self._posted)
            self._posted.clear()
            self._changed.notify_all()
        for _, future in left:
            if future.set_running_or_notify_cancel():
                error = HostError(f"the device has failed: {failure}", hint="make a new one")
                error.__cause__ = failure
                future.set_exception(error)

    def _carry_out(self) -> bool:
        """Do what was posted and publish; return whether there is anything to be done later."""
        with self._changed:
            commands = list(self._posted)
            self._posted.clear()
            self._awake = False
            closing = self._closing
        answers: list[Callable[[], None]] = []
        for command, future in commands:
            if future.set_running_or_notify_cancel():
                answers.append(_answer(command, self._device, future))
        if commands:
            self._publish()
        for answer in answers:
            answer()
        return not closing

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
            self._changed.notify_all()


class _AwakePace(Pace):
    """A pace that wakes the owner when it changes."""

    def __init__(self, wall: Wall, rate: float, wake: Callable[[], None]) -> None:
        super().__init__(wall, rate)
        self._wake = wake

    @property
    def rate(self) -> float:
        """Seconds of the device for each second of the wall clock."""
        return super().rate

    @rate.setter
    def rate(self, rate: float) -> None:
        Pace.rate.__set__(self, rate)  # type: ignore[attr-defined]
        self._wake()
