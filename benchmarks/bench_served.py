"""Measure a served machine with a page: what a viewer costs beside the machine, a status as JSON, and the start."""

from __future__ import annotations

import asyncio
import os
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

from _measure import Figure, at_most
from _report import run_script

AXES = "XYZABC"
AXIS = '[[axis]]\nname = "{name}"\nkind = "{kind}"\nvmax_{unit}_s = 500\namax_{unit}_s2 = 3000\n'
BLOCKS = 4_000
TICKS = os.sysconf("SC_CLK_TCK")


def _machine() -> str:
    axes = (
        AXIS.format(name=name, kind="linear", unit="mm")
        if name in "XYZ"
        else AXIS.format(name=name, kind="rotary", unit="deg")
        for name in AXES
    )
    return 'name = "six"\ncycle_s = 0.002\n' + "".join(axes)


def _program() -> str:
    lines = (
        f"G1 X{k % 7 * 3.25} Y{k % 5 * 2.5} Z{k % 3 * 1.75} A{k % 11} B{k % 13} C{k % 17} F3000"
        for k in range(BLOCKS)
    )
    return "\n".join((*lines, "M30")) + "\n"


class Served:
    """A process that serves a machine of six axes which runs a program."""

    def __init__(self, folder: Path) -> None:
        (folder / "six.toml").write_text(_machine())
        (folder / "part.nc").write_text(_program())
        command = ["serve", "--plain", str(folder / "six.toml"), "--doors", "http=0"]
        begin_s = time.perf_counter()
        self.process = subprocess.Popen(
            [sys.executable, "-m", "polycnc.cli", *command, "--program", str(folder / "part.nc")],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().partition(" ")[2].strip()
        with urllib.request.urlopen(f"{self.url}/health") as answer:
            answer.read()
        self.start_s = time.perf_counter() - begin_s

    def cpu_s(self) -> float:
        """Return the processor time that it has used."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / TICKS

    def share(self, for_s: float) -> float:
        """Return the share of a core that it takes (%)."""
        before, begin_s = self.cpu_s(), time.perf_counter()
        time.sleep(for_s)
        return (self.cpu_s() - before) / (time.perf_counter() - begin_s) * 100.0

    def end(self) -> None:
        """End it."""
        self.process.terminate()
        self.process.communicate()


async def _viewed(served: Served, for_s: float) -> tuple[float, float, int]:
    """Look at the stream as a page does; return the share of a core (%), updates per second, and bytes of one."""
    from websockets.asyncio.client import connect

    url = served.url.replace("http", "ws") + "/api/machines/machine/stream?rate=25"
    async with connect(url, max_size=None) as socket:
        await socket.recv()  # the whole inventory
        before, begin_s, count, text = served.cpu_s(), time.perf_counter(), 0, ""
        while time.perf_counter() - begin_s < for_s:
            text = str(await socket.recv())
            count += 1
        for_s = time.perf_counter() - begin_s
    return (served.cpu_s() - before) / for_s * 100.0, count / for_s, len(text)


def _status_us() -> tuple[float, float]:
    """Return the times to read a status after a cycle, with many blocks ahead, and to make JSON of it."""
    from pydantic import TypeAdapter

    from polycnc.cnc import Control, Status
    from polycnc.machine import load_machine
    from polycnc.nc import ProgramText

    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "six.toml"
        file.write_text(_machine())
        control = Control(load_machine(file))
    control.select_program(ProgramText.from_text(_program()))
    control.cycle_start()
    control.advance(100)
    adapter = TypeAdapter(Status)
    read: list[float] = []
    written: list[float] = []
    for _ in range(1_500):
        control.advance(1)
        begin_s = time.perf_counter()
        status = control.status()
        middle_s = time.perf_counter()
        adapter.dump_json(status)
        read.append((middle_s - begin_s) * 1e6)
        written.append((time.perf_counter() - middle_s) * 1e6)
    return statistics.median(read), statistics.median(written)


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    for_s = 4.0 if quick else 10.0
    with tempfile.TemporaryDirectory() as name:
        starts = []
        for _ in range(2 if quick else 4):
            served = Served(Path(name))
            starts.append(served.start_s)
            served.end()
        served = Served(Path(name))
        try:
            time.sleep(2.0)
            alone = served.share(for_s)
            viewed, rate, size = asyncio.run(_viewed(served, for_s))
            alone = (alone + served.share(for_s)) / 2.0
        finally:
            served.end()
    read_us, written_us = _status_us()
    note = f"{rate:.1f} updates/s of {size:,} bytes; the machine alone {alone:.1f} %"
    return [
        at_most("a page at 25 updates/s, six axes that move: processor beside the machine", viewed - alone,
                "% of a core", 5.0, note),
        at_most("a status of six axes that move as JSON", written_us, "us", 100.0),
        Figure("reading it after a cycle, thousands of blocks ahead", read_us, "us"),
        at_most("serve --doors http: from its start to an answer, warm", min(starts[1:]), "s", 2.0),
    ]  # fmt: skip


if __name__ == "__main__":
    run_script("Served machine", figures)
