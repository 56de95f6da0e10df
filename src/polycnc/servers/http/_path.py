"""The path of a program before it runs, computed beside the machines, one program at a time."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable
from typing import Annotated

from fastapi import APIRouter, Query, Response

from polycnc.cnc import Control, ControlError, Refusal
from polycnc.errors import PolycncError
from polycnc.nc import ProgramText, language_for
from polycnc.nc.macro import MacroLanguage, MacroVariables
from polycnc.runner.view import Preview, preview
from polycnc.servers.http._documents import as_json
from polycnc.servers.http._found import JSON, ONE, Found, answer
from polycnc.servers.machines import MachineError, Programs

MOST_S = 20.0
MOST_POINTS = 20_000
MOST_WAITING = 4
_MOST_BYTES = 16 << 20
_SCHEMA = {"type": "object", "required": ["program", "time_s", "t_s", "positions", "rapid", "line", "errors"]}


class _Stopped(Exception):  # noqa: N818 - no error: nobody waits any more
    pass


class PathRoutes:
    """Show where programs go, as `polycnc view` draws it."""

    def __init__(self, found: Found, router: APIRouter) -> None:
        self._found = found
        self._turn = asyncio.Lock()
        self._waiting = 0
        router.get(f"{ONE}/path", summary="Where a program goes, before it runs.", response_class=Response,
            responses=answer(_SCHEMA))(self.show)  # fmt: skip

    async def show(
        self,
        machine: str,
        program: Annotated[str, Query(max_length=64, description="Its name; else the selected one.")] = "",
    ) -> Response:
        """Return the path of a program of the memory, on a machine of its own with these tools and offsets."""
        found, control = self._found.operated(machine)
        programs = found.programs
        assert programs is not None
        if self._waiting >= MOST_WAITING:
            raise MachineError("too many paths are asked for at once", hint="Ask again.")
        self._waiting += 1
        try:
            async with self._turn:
                work = await found.ask(lambda: _work(control(), programs, program))
                return Response(await _beside(work), media_type=JSON)
        finally:
            self._waiting -= 1


Check = Callable[[float], None]


def _work(control: Control, programs: Programs, name: str) -> Callable[[Check], bytes]:
    """Return what computes a path, from copies of what the control has now."""
    if not name:
        name = control.channel_status().program or ""
        if not name:
            raise ControlError(Refusal.NOT_FOUND, "no program is selected", hint="Name one.")
    if control.dialect.language == "cpl":
        raise ControlError(
            Refusal.DATA,
            "statements of CPL run on their control alone",
            hint="Run the program, or use polycnc view.",
        )
    text = ProgramText(name, programs.read(name))
    config = control.machine.config.model_copy(
        update={
            "tools": dict(control.tools),
            "offsets": {key: dict(each) for key, each in control.offsets.items()},
        }
    )
    texts = _SubPrograms(control, programs)
    live = control.channels[0].runs.language
    language = language_for(control.dialect)
    if isinstance(live, MacroLanguage) and isinstance(language, MacroLanguage):
        copy = MacroVariables()
        copy.ranges = live.variables.ranges
        copy.restore_state(live.variables.saved(lasting=True))
        copy.leave_all()
        language = MacroLanguage(copy)
    dialect = control.dialect

    def compute(check: Check) -> bytes:
        shown: Preview = preview(
            text, config, dialect, language=language, texts=texts, most=MOST_POINTS, progress=check
        )
        return as_json(shown)

    return compute


class _SubPrograms(dict[int, ProgramText]):
    """The programs that can be called by number, as they are now."""

    def __init__(self, control: Control, programs: Programs) -> None:
        super().__init__()
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
            self[number] = ProgramText(entry.name, content)


async def _beside(work: Callable[[Check], bytes]) -> bytes:
    """Compute in a thread that ends with the process, for so long at most, or as long as somebody waits."""
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
            result = ControlError(
                Refusal.FULL, f"this path takes more than {MOST_S:g} s to compute", hint="Use polycnc view."
            )
        except Exception as error:
            result = error if isinstance(error, PolycncError) else MachineError(f"no path: {error!r:.200}")
        if not is_over.is_set():
            loop.call_soon_threadsafe(told, result)

    threading.Thread(target=run, name="path", daemon=True).start()
    try:
        return await done
    finally:
        is_over.set()
