"""What takes long is computed beside the machines, from copies of what a control has, one piece at a time."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from polycnc.cnc import Control, ControlError, Refusal
from polycnc.errors import PolycncError
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect, Language, ProgramText, language_for
from polycnc.nc.macro import MacroLanguage, MacroVariables
from polycnc.servers.machines import MachineError, Programs

MOST_S = 20.0
MOST_WAITING = 4
_MOST_BYTES = 16 << 20
Check = Callable[[float], None]
"""Called now and then by what computes; it ends it when nobody waits any more."""
Work = Callable[[Check], bytes]


class _Stopped(Exception):  # noqa: N818 - no error: nobody waits any more
    pass


@dataclass(frozen=True, slots=True)
class Copies:
    """What programs of a control are read and run with: its tools and offsets, variables and sub-programs of now."""

    config: MachineConfig
    dialect: Dialect
    language: Language | None
    texts: dict[int, ProgramText]


def copies_of(control: Control, programs: Programs) -> Copies:
    """Return copies of what a control has."""
    tables = {
        "tools": dict(control.tools),
        "offsets": {key: dict(each) for key, each in control.offsets.items()},
    }
    live = control.channels[0].runs.language
    language = language_for(control.dialect)
    if isinstance(live, MacroLanguage) and isinstance(language, MacroLanguage):
        copy = MacroVariables()
        copy.ranges = live.variables.ranges
        copy.restore_state(live.variables.saved(lasting=True))
        copy.leave_all()
        language = MacroLanguage(copy)
    config = control.machine.config.model_copy(update=tables)
    return Copies(config, control.dialect, language, _sub_programs(control, programs))


def _sub_programs(control: Control, programs: Programs) -> dict[int, ProgramText]:
    """Return the programs that can be called by number."""
    found: dict[int, ProgramText] = {}
    left = _MOST_BYTES
    for entry in programs.directory():
        digits = entry.name.removeprefix("O")
        if not digits.isascii() or not digits.isdecimal() or len(digits) > 8:
            continue
        number = int(digits)
        if entry.name not in {each.format(number=number) for each in control.data.sub_program_names}:
            continue
        content = programs.read(entry.name)
        left -= len(content)
        if left < 0:
            break
        found[number] = ProgramText(entry.name, content)
    return found


class Beside:
    """Compute one after the other, in threads that end with the process; `what` is what is computed."""

    def __init__(self, what: str, hint: str) -> None:
        self._what = what
        self._hint = hint
        self._turn = asyncio.Lock()
        self._waiting = 0

    async def run(self, make: Callable[[], Awaitable[Work]]) -> bytes:
        """Make the work when its turn has come, and return what it computes.

        Raises:
            MachineError: Too many wait.
            ControlError: It takes too long.
            PolycncError: What the work raises.
        """
        if self._waiting >= MOST_WAITING:
            raise MachineError(f"too many {self._what}s are asked for at once", hint="Ask again.")
        self._waiting += 1
        try:
            async with self._turn:
                return await self._compute(await make())
        finally:
            self._waiting -= 1

    async def _compute(self, work: Work) -> bytes:
        """Compute for so long at most, or as long as somebody waits."""
        loop = asyncio.get_running_loop()
        done: asyncio.Future[bytes] = loop.create_future()
        end_s = time.monotonic() + MOST_S
        is_over = threading.Event()

        def check(_: float) -> None:
            if is_over.is_set() or time.monotonic() > end_s:
                raise _Stopped

        def told(result: bytes | Exception) -> None:
            if done.done():
                return
            if isinstance(result, bytes):
                done.set_result(result)
            else:
                done.set_exception(result)

        def run() -> None:
            result: bytes | Exception
            try:
                result = work(check)
            except _Stopped:
                what = f"this {self._what} takes more than {MOST_S:g} s to compute"
                result = ControlError(Refusal.FULL, what, hint=self._hint)
            except Exception as error:
                known = isinstance(error, PolycncError)
                result = error if known else MachineError(f"no {self._what}: {error!r:.200}")
            if not is_over.is_set():
                loop.call_soon_threadsafe(told, result)

        threading.Thread(target=run, name=self._what, daemon=True).start()
        try:
            return await done
        finally:
            is_over.set()
