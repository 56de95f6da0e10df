"""C libraries in tests: built once, loaded fresh, memory that ends at a page nobody may touch, a door in a thread."""

from __future__ import annotations

import asyncio
import ctypes
import mmap
import shutil
import threading
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import pytest

from polycnc.machine import Device
from polycnc.runner import WallClock
from polycnc.servers.calls import CallsServer, build_library, library_of, write_library
from polycnc.servers.machines import Log, Wanted
from polycnc.servers.process import DOORS, Machinery, MachineWanted, Serving

NO_COMPILER = "no C compiler gcc here"
_PAGE = mmap.PAGESIZE
_FILL = 0xA5


@cache
def folder_of(kind: str, packing: int = 0) -> Path:
    """Return the folder of a library that is built for this computer, once; the end of the tests removes it."""
    import atexit

    folder = Path(mkdtemp(prefix="polycnc_clib_"))
    atexit.register(shutil.rmtree, folder, True)
    library = library_of(kind).packed(packing)
    assert library is not None
    write_library(library, folder)
    build_library(library, folder, "linux")
    return folder


def built(kind: str, packing: int = 0) -> Path:
    """Return the folder of a library, or skip the test where nothing builds it."""
    if shutil.which("gcc") is None:
        pytest.skip(NO_COMPILER)
    return folder_of(kind, packing)


def loaded(kind: str, folder: Path, packing: int = 0) -> Any:
    """Load a library as a program of its own has it: with no connection yet."""
    name = library_of(kind).name
    own = folder / f"lib{name}_{len(list(folder.iterdir()))}.so"
    shutil.copy(built(kind, packing) / f"lib{name}.so", own)
    return ctypes.CDLL(str(own))


class _StandingWall:
    """A clock of the computer that stands still, so that no time passes by itself."""

    def now_s(self) -> float:
        """Return the same as before."""
        return 3.5

    def sleep_s(self, _: float) -> None:
        """Do not sleep."""


class Door:
    """Machines with the door `calls`, in a thread; no time passes by itself, unless they are running."""

    def __init__(
        self, *machines: tuple[str, Machinery], focas: bool = False, running: bool = False, port: int = 0
    ) -> None:
        self._ready = threading.Event()
        self._machines, self._focas, self._running, self._port = machines, focas, running, port
        self.loop: asyncio.AbstractEventLoop | None = None
        self._end: asyncio.Event | None = None
        self.devices: Sequence[Device[Any]] = ()
        self.place = self.first_place = ""
        self._door: object = None
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve()), daemon=True)
        self._thread.start()
        assert self._ready.wait(60)

    async def _serve(self) -> None:
        self.loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        at = Wanted(port=0)
        own = ((DOORS["focas"], at),) if self._focas else ()
        wanted = [MachineWanted(kind, machinery, doors=own) for kind, machinery in self._machines]
        wall = WallClock() if self._running else _StandingWall()
        serving = Serving(wall, Log(), lambda _: None)
        try:
            await serving.open(wanted, [(DOORS["calls"], Wanted(port=self._port))])
            self.devices = [each.device for each in serving.machines]
            self._door = serving.doors[-1][1]
            self.place, self.first_place = serving.doors[-1][1].said, serving.doors[0][1].said
            if self._running:
                await serving.begin()
            self._ready.set()
            await self._end.wait()
        finally:
            await serving.close()

    def clients(self) -> int:
        """Return how many clients are there, once all that has come before has been looked at."""
        assert self.loop is not None
        assert isinstance(self._door, CallsServer)

        async def look() -> None:
            for _ in range(200):
                await asyncio.sleep(0)  # one look at all sockets

        asyncio.run_coroutine_threadsafe(look(), self.loop).result(60)
        return len(self._door.lines)

    def close(self) -> None:
        """End it, and every connection."""
        assert self.loop is not None
        assert self._end is not None
        with suppress(RuntimeError):
            self.loop.call_soon_threadsafe(self._end.set)
        self._thread.join(60)
        assert not self._thread.is_alive()


def at_door(monkeypatch: pytest.MonkeyPatch, door: Door) -> None:
    """Let libraries that are loaded from now on find a door."""
    monkeypatch.setenv("POLYCNC_CALLS", door.place)


class Guarded:
    """So many bytes between pages that nobody may touch: the last one lies before the one behind them, or, where they
    lie `low`, the first one behind the one before them; what is left between is a pattern.
    """

    def __init__(self, size: int, content: bytes = b"", *, low: bool = False) -> None:
        libc = ctypes.CDLL(None, use_errno=True)
        pages = max(1, -(-size // _PAGE))
        self._map = mmap.mmap(-1, (pages + 2) * _PAGE)
        below = ctypes.addressof(ctypes.c_char.from_buffer(self._map))
        first, guard = below + _PAGE, below + (pages + 1) * _PAGE
        for page in (below, guard):
            assert libc.mprotect(ctypes.c_void_p(page), ctypes.c_size_t(_PAGE), 0) == 0
        self.address = first if low else guard - size
        self.size, self._first, self._guard = size, first, guard
        ctypes.memset(first, _FILL, pages * _PAGE)
        ctypes.memmove(self.address, content[:size], min(size, len(content)))
        self._around = self._pattern()

    def _pattern(self) -> bytes:
        end = self.address + self.size
        return ctypes.string_at(self._first, self.address - self._first) + ctypes.string_at(
            end, self._guard - end
        )

    @property
    def content(self) -> bytes:
        """Return the bytes."""
        return ctypes.string_at(self.address, self.size)

    @property
    def is_kept(self) -> bool:
        """Tell whether nothing was written before them or behind them."""
        return self._pattern() == self._around


PATTERN = bytes([_FILL])
