"""Measure the MTConnect agent: requests of one client, of parts of a machine, and what an idle machine costs."""

from __future__ import annotations

import asyncio
import http.client
import os
import subprocess
import sys
import time
from pathlib import Path

from _measure import Figure, at_least, at_most
from _report import run_script

PROGRAM = "N10 G90 G1 F600 X-12.5\nN20 Y7.25\nN30 X0\nN40 Y0\nM30\n"
TICKS = os.sysconf("SC_CLK_TCK")
REQUESTS = {
    "current": "/current",
    "current of a path": "/current?path=//Path",
    "a sample of 100": "/sample?count=100",
}


class Served:
    """A process that serves a machine, and a client."""

    def __init__(self, *arguments: str, door: str = "mtconnect") -> None:
        self.process = subprocess.Popen(
            [
                sys.executable,
                "-m",
                "polycnc.cli",
                "serve",
                "--plain",
                "mill3",
                "--doors",
                f"{door}=0",
                *arguments,
            ],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        assert self.process.stdout is not None
        self.said = self.process.stdout.readline().strip()
        self.port = int(self.said.rpartition(":")[2])
        self.client = http.client.HTTPConnection("127.0.0.1", self.port)

    def cpu_s(self) -> float:
        """Return the processor time that it has used."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / TICKS

    def get(self, path: str) -> bytes:
        """Return the answer to a request."""
        self.client.request("GET", path)
        return self.client.getresponse().read()

    def end(self) -> None:
        """End it."""
        self.client.close()
        self.process.terminate()
        self.process.communicate()


def _per_second(served: Served, path: str, count: int) -> tuple[float, float]:
    """Return requests for each second of the server's processor, and of the wall clock."""
    served.get(path)
    before, begin = served.cpu_s(), time.perf_counter()
    for _ in range(count):
        served.get(path)
    return count / max(served.cpu_s() - before, 1 / TICKS), count / (time.perf_counter() - begin)


class _Deaf:
    """Counts what a subscription tells."""

    count = 0

    def datachange_notification(self, node: object, value: object, data: object) -> None:
        self.count += 1


async def _monitored(url: str, served: Served, for_s: float) -> tuple[float, int]:
    """Monitor 100 variables at 10 Hz; return the share of a core that the server takes (%), and the notifications."""
    from asyncua import Client, ua

    axis = [f"machine/CncAxisList/{each}" for each in "XYZ"]
    paths = [
        f"{at}/{name}"
        for at in axis
        for name in ("PosDirect", "PosIndirect", "ActStatus", "ZeroOffset", "ActLoad")
    ]
    paths += [f"{at}/{name}/{part}" for at in axis for name in ("PosDirect", "PosIndirect")
              for part in ("ActPos", "CmdPos", "RemDist")]  # fmt: skip
    channel = "machine/CncChannelList/Channel1"
    paths += [
        f"{channel}/{name}" for name in ("ActFeedrate", "CmdFeedrate", "ActProgramLine", "ActProgramBlock")
    ]
    paths += [f"{channel}/PosTcp{system}{each}/{part}" for system in ("Bcs", "Wcs") for each in "XYZ"
              for part in ("ActPos", "CmdPos", "RemDist")]  # fmt: skip
    paths = (paths * 2)[:100]
    seen = _Deaf()
    async with Client(url, timeout=60) as client:
        subscription = await client.create_subscription(100, seen)
        await subscription.subscribe_data_change([client.get_node(ua.NodeId(path, 1)) for path in paths])
        await asyncio.sleep(2.0)
        seen.count = 0
        before, begin = served.cpu_s(), time.perf_counter()
        await asyncio.sleep(for_s)
        share = (served.cpu_s() - before) / (time.perf_counter() - begin) * 100.0
        return share, seen.count


def _opcua(for_s: float, program: Path) -> Figure:
    served = Served("--program", str(program), door="opcua")
    try:
        url = served.said.partition(" ")[2]
        share, count = asyncio.run(_monitored(url, served, for_s))
    finally:
        served.end()
    note = f"{count / for_s:,.0f} notifications/s; the machine runs a program"
    return at_most("OPC UA, 100 monitored items at 10 Hz: processor", share, "% of a core", 5.0, note)


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    made = []
    count = 500 if quick else 3_000
    program = Path(os.environ.get("TMPDIR", "/tmp")) / f"bench_plants_{os.getpid()}.nc"
    program.write_text(PROGRAM)
    served = Served("--program", str(program))
    try:
        for name, path in REQUESTS.items():
            by_processor, by_wall = max(_per_second(served, path, count) for _ in range(3))
            figure = f"MTConnect, one client, a running machine: {name}"
            note = f"{by_wall:,.0f}/s by the wall clock"
            unit = "requests/s of processor"
            made.append(
                at_least(figure, by_processor, unit, 500, note)
                if path == "/current"
                else Figure(figure, by_processor, unit, note=note)
            )
        made.append(_opcua(3.0 if quick else 10.0, program))
    finally:
        served.end()
        program.unlink()
    idle = Served()
    try:
        idle.get("/probe")
        before, begin = idle.cpu_s(), time.perf_counter()
        time.sleep(3.0 if quick else 10.0)
        share = (idle.cpu_s() - before) / (time.perf_counter() - begin) * 100.0
    finally:
        idle.end()
    return [*made, at_most("MTConnect, an idle machine: processor", share, "% of a core", 1.0)]


if __name__ == "__main__":
    run_script("MTConnect agent", figures)
