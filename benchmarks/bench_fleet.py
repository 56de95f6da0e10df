"""Measure fleets: what many machines cost at 1x, and whether their clocks are on time.

The processor is counted against the time that passed in the machines, so it is right on a computer that is late, too.
Lateness is by the wall clock: how long the processes waited for a core that others had stands beside it.
"""

from __future__ import annotations

import asyncio
import os
import re
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

from _measure import Figure, at_most
from _report import run_script

PROGRAM = "N10 G90 G1 F600 X-12.5\nN20 Y7.25\nN30 X0\nN40 Y0\nM30\n"
FLEET = '{head}\n[[machine]]\nname = "m"\ncount = {count}\ncontroller = "plain"\nfile = "mill3"\n{program}\n'
TICKS = os.sysconf("SC_CLK_TCK")
SETTLE_S = 8.0  # the machines of a process begin one after the other within 5 s
FORGOTTEN_S = 62.0  # after so long machines are looked at less often that nobody asks about


class Running:
    """A file of machines that is served."""

    def __init__(self, head: str, count: int, *, runs: bool = True) -> None:
        self._folder = tempfile.TemporaryDirectory()
        folder = Path(self._folder.name)
        (folder / "part.nc").write_text(PROGRAM)
        program = 'program = "part.nc"' if runs else ""
        (folder / "fleet.toml").write_text(FLEET.format(head=head, count=count, program=program))
        self.process = subprocess.Popen(
            [sys.executable, "-m", "polycnc.cli", "serve", str(folder / "fleet.toml")],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        assert self.process.stdout is not None
        self.said: dict[str, str] = {}
        last = "ready" if "processes" in head else "http"
        while last not in self.said:
            name, _, at = self.process.stdout.readline().partition(": ")
            self.said[name] = at.strip()

    def spent_s(self) -> tuple[float, float]:
        """Return the processor time of all its processes, and how long they waited for a core."""
        ticks = waited_ns = 0
        for stat in Path("/proc").glob("[0-9]*/stat"):
            try:
                fields = stat.read_text().rpartition(")")[2].split()
                if self.process.pid not in (int(stat.parent.name), int(fields[1])):
                    continue
                waited_ns += int(stat.with_name("schedstat").read_text().split()[1])
            except OSError:
                continue
            ticks += int(fields[11]) + int(fields[12])
        return ticks / TICKS, waited_ns / 1e9

    def figures(self, page: str) -> tuple[float, float]:
        """Return the worst lateness since this was asked last, and the time of all machines together."""
        with urllib.request.urlopen(page) as answer:
            text = answer.read().decode()
        late_s, time_s = (
            [
                float(each)
                for each in re.findall(rf"^polycnc_machine_{name}_seconds\{{.*\}} (\S+)$", text, re.M)
            ]
            for name in ("lateness", "time")
        )
        return max(late_s), sum(time_s)

    def end(self) -> None:
        """End it."""
        self.process.terminate()
        self.process.communicate()
        self._folder.cleanup()


async def _poll(port: int, path: str, until_s: float) -> None:
    """Ask once a second, on one connection."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    await asyncio.sleep(hash(path) % 100 / 100)
    while time.monotonic() < until_s:
        writer.write(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
        head = await reader.readuntil(b"\r\n\r\n")
        length = int(re.search(rb"content-length: (\d+)", head.lower())[1])  # type: ignore[index]
        await reader.readexactly(length)
        await asyncio.sleep(1.0)
    writer.close()


async def _polled(port: int, count: int, for_s: float) -> None:
    until_s = time.monotonic() + for_s
    paths = [f"/api/machines/m{k + 1}/status" for k in range(count) for _ in range(3)]
    await asyncio.gather(*(_poll(port, path, until_s) for path in paths))


async def _asked(said: dict[str, str], for_s: float) -> None:
    until_s = time.monotonic() + for_s
    doors = [(name.split()[0], at) for name, at in said.items() if name.endswith(" mtconnect")]
    await asyncio.gather(
        *(_poll(int(at.rpartition(":")[2]), f"/{name}/current", until_s) for name, at in doors)
    )


def _fleet(count: int, processes: int, for_s: float, *, asked: bool) -> list[Figure]:
    """Measure a fleet whose machines are asked once a second each, or that nobody asks."""
    running = Running(f"processes = {processes}\nmetrics = 0\n[doors]\nmtconnect = 0", count)
    try:
        time.sleep(SETTLE_S if asked else FORGOTTEN_S)
        _, begin_s = running.figures(running.said["metrics"])
        before_s, waited_before_s = running.spent_s()
        if asked:
            asyncio.run(_asked(running.said, for_s))
        else:
            time.sleep(for_s)
        after_s, waited_s = running.spent_s()
        late_s, end_s = running.figures(running.said["metrics"])
        share = (after_s - before_s) / (end_s - begin_s) * count * 100.0
    finally:
        running.end()
    whose = "each asked once a second" if asked else "that nobody asks"
    what = f"{count} running machines with MTConnect in {processes} processes, {whose}"
    return [
        at_most(f"{what}: worst lateness", late_s, "s", 0.05),
        Figure(f"{what}: processor", share, "% of a core"),
        Figure(f"{what}: waited for a core", waited_s - waited_before_s, "s"),
    ]


def _one(count: int, for_s: float, *, runs: bool) -> list[Figure]:
    running = Running("[doors]\nhttp = 0", count, runs=runs)
    try:
        port = int(running.said["http"].rpartition(":")[2])
        time.sleep(SETTLE_S)
        page = f"{running.said['http']}/metrics"
        _, begin_s = running.figures(page)
        before_s, waited_before_s = running.spent_s()
        asyncio.run(_polled(port, count, for_s))
        after_s, waited_s = running.spent_s()
        late_s, end_s = running.figures(page)
        share = (after_s - before_s) / (end_s - begin_s) * count * 100.0
    finally:
        running.end()
    what = f"{count} {'running' if runs else 'idle'} machines in one process, three clients each"
    return [
        at_most(f"{what}: processor", share, "% of a core", 20.0),
        at_most(f"{what}: worst lateness", late_s, "s", 0.02),
        Figure(f"{what}: waited for a core", waited_s - waited_before_s, "s"),
    ]


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    for_s = 5.0 if quick else 20.0
    return [
        *_fleet(20 if quick else 200, 2 if quick else 4, for_s, asked=True),
        *([] if quick else _fleet(200, 4, for_s, asked=False)),
        *_one(50, for_s, runs=True),
        *_one(50, for_s, runs=False),
    ]


if __name__ == "__main__":
    run_script("Fleets", figures)
