"""A machine behind the door for senders, in a process of its own: port, terminal, and seconds in a second."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable
from typing import Any

from polycnc.cnc import Control
from polycnc.machine import Pace
from polycnc.runner import WallClock
from polycnc.servers.grbl import GrblCore, GrblServer, grbl_control


class InTheLoop:
    """Let the time of a control pass in the event loop, as the wall clock says."""

    def __init__(self, control: Control, rate: float) -> None:
        self.control = control
        self.pace = Pace(WallClock(), rate)

    def submit(self, command: Callable[[], Any], done: Callable[[Any], None]) -> bool:
        self.catch_up()
        done(command())
        return True

    def catch_up(self) -> None:
        due = self.pace.due(self.control.clock.cycle_s, 1000)
        if due:
            self.pace.count(self.control.advance(due))


async def main(port: str, terminal: str, rate: str) -> None:
    control = grbl_control("mill3")
    control.advance(1)
    owner = InTheLoop(control, float(rate))
    server = GrblServer(owner, GrblCore(control), port=int(port), terminal=terminal)
    await server.start()
    print(f"grbl: {server.said}", flush=True)
    try:
        while True:
            owner.catch_up()
            await asyncio.sleep(0.01)
    finally:
        await server.close()


try:
    asyncio.run(main(*sys.argv[1:]))
except KeyboardInterrupt:
    print("ended")
