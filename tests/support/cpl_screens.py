"""CPL programs that draw: what stands on the screen of their control."""

from __future__ import annotations

from pathlib import Path

from polycnc.controllers.bosch import BoschSystem, ChannelHost
from polycnc.machine import Clock
from polycnc.nc.cpl import Linker, Run
from support.programs import MILL


class Shown:
    """A program without NC blocks that ran to its end on a control of its own: its screen and global variables."""

    def __init__(self, text: str, folder: Path, *keys: str, finish: bool = True) -> None:
        host = ChannelHost(BoschSystem(folder, Clock(0.001), MILL), keys=keys)
        linker = Linker(host.program)
        main, errors = linker.link(text, "main.npg")
        assert main is not None, str(errors[0])
        run = Run(main, linker, host)
        while run.step() is not None:
            pass
        if finish:
            host.dialog.finish()
        self.globals = run.globals
        self.surface = host.screen
        self.lines = self.surface.lines()

    def __getitem__(self, line: int) -> str:
        return self.lines[line - 1].rstrip()

    def colour(self, x: int, y: int) -> int:
        return int(self.surface.pixels[y + 40, x])
