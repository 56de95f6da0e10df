"""A host as coroutines: commands, conditions and statuses awaited in an event loop, the device in its own thread."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncGenerator, Callable
from typing import Any, Generic, Self, TypeVar

from polycnc.machine._device import Device
from polycnc.machine._host import Host, HostError

D = TypeVar("D", bound=Device[Any])
R = TypeVar("R")


class AsyncHost(Generic[D]):
    """Command and watch the device of a `host` from the running event loop, which never waits for it.

    `async with` starts and closes the host. Threads may go on using the host itself.
    """

    def __init__(self, host: Host[D]) -> None:
        self.host = host

    @property
    def status(self) -> Any:
        """Return the status of the device that was published last, all of one cycle."""
        return self.host.status

    async def __aenter__(self) -> Self:
        self.host.start()
        return self

    async def __aexit__(self, *error: object) -> None:
        await asyncio.to_thread(self.host.close)

    async def call(self, command: Callable[[D], R]) -> R:
        """Carry out `command` with the device between two cycles and return its result.

        It runs in the thread of the host. Whoever stops waiting before it has begun takes it back.

        Raises:
            HostError: The host is not running, or the device has failed.
            Exception: Whatever the command raises.
        """
        return await asyncio.wrap_future(self.host.post(command))

    async def until(self, condition: Callable[[Any], bool], timeout_s: float | None = None) -> Any:
        """Wait until `condition` holds for a published status and return that one; not every status is seen.

        Raises:
            HostError: The host is not running, the device has failed, or `timeout_s` of the event loop is over.
        """
        try:
            async with asyncio.timeout(timeout_s):
                async with contextlib.aclosing(self.statuses()) as statuses:
                    async for status in statuses:
                        if condition(status):
                            return status
        except TimeoutError:
            raise HostError(
                f"nothing of the kind for {timeout_s} s", hint="wait for something else"
            ) from None
        raise HostError("the host is not running", hint="start it, and do not stop it before")

    async def statuses(self, interval_s: float = 0.0) -> AsyncGenerator[Any, None]:
        """Return the present status and then the newest whenever there is one, until the host stops.

        Whoever is slow, or wants them `interval_s` apart, misses those between; none is queued.

        Raises:
            HostError: The device has failed.
        """
        loop = asyncio.get_running_loop()
        published = asyncio.Event()
        asked = False  # however fast the host publishes, the loop is woken once for each status that it takes

        def told() -> None:
            nonlocal asked
            if not asked:
                return
            asked = False
            with contextlib.suppress(RuntimeError):  # the loop has ended before the host
                loop.call_soon_threadsafe(published.set)

        end = self.host.observe(told)
        try:
            while True:
                published.clear()
                asked = True
                running, status = self.host.running, self.host.status
                yield status
                if not running:
                    break
                await published.wait()
                await asyncio.sleep(interval_s)
            if self.host.failure is not None:
                raise HostError(f"the device has failed: {self.host.failure}", hint="make a new one")
        finally:
            end()
