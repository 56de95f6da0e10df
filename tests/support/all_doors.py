"""A process that serves one FANUC control by all doors, and a client of each door; it has three axes."""

from __future__ import annotations

import json
import re
import socket
from contextlib import ExitStack
from typing import Any

import httpx
from websockets.sync.client import connect

from support.focas_line import Line, values
from support.plant_doors import Agent, Opcua, Shdr
from support.started import started

_DOORS = "focas=0,http=0,grbl=0,mtconnect=0,shdr=0,opcua=0"
AUT = {0: "mdi", 1: "auto", 3: "edit", 4: "handle", 5: "jog", 8: "inc", 9: "ref"}
RUN = {0: "reset", 1: "stop", 2: "hold", 3: "start"}


class AllDoors:
    """The process, and what each of its doors says of the machine."""

    def __init__(self, *more: str) -> None:
        self.process = started("serve", "--fanuc", "--doors", _DOORS, *more)
        assert self.process.stdout is not None
        said = {
            name: at.strip()
            for name, _, at in (self.process.stdout.readline().partition(" ") for _ in range(6))
        }
        self.said = said
        port = {name: int(at.partition(";")[0].rpartition(":")[2]) for name, at in said.items()}
        self.http = httpx.Client(base_url=f"{said['http:']}/api/machines/machine", timeout=60)
        self.line = Line(port["focas:"])
        self.sender = socket.create_connection(("127.0.0.1", port["grbl:"]), timeout=60)
        self.agent, self.shdr = Agent(port["mtconnect:"]), Shdr(port["shdr:"])
        self.opcua = Opcua(said["opcua:"])
        self._reader = self.sender.makefile("rb")
        self._open = ExitStack()
        self.stream = self._open.enter_context(
            connect(
                f"{said['http:'].replace('http', 'ws')}/api/machines/machine/stream?rate=50",
                close_timeout=0.2,
            )
        )

    def end(self) -> str:
        """End it; return what it said on standard error."""
        self._open.close()
        self.opcua.close()
        self.agent.close()
        self.shdr.line.close()
        self.sender.close()
        self._reader.close()
        self.line.close()
        self.http.close()
        self.process.terminate()
        _, error = self.process.communicate(timeout=60)
        return error

    def command(self, command: str, **given: Any) -> int:
        """Give a command; return the status code."""
        return self.http.post("/commands", json={"command": command, **given}).status_code

    def clock(self, **asked: Any) -> dict[str, Any]:
        """Change the clock."""
        answer = self.http.post("/clock", json=asked)
        assert answer.status_code == 200, answer.text
        found: dict[str, Any] = answer.json()
        return found

    def key(self, byte: bytes) -> None:
        """Press a real-time key of the sender, and wait until it has been seen."""
        self.sender.sendall(byte)
        self.report()

    def report(self) -> dict[str, str]:
        """Return the fields of the sender's status line, with overrides."""
        for _ in range(40):
            self.sender.sendall(b"?")
            while not (line := self._reader.readline().decode()).startswith("<"):
                assert line, "the sender door has ended"
            state, *fields = line.strip().strip("<>").split("|")
            found = {"state": state, **dict(each.split(":", 1) for each in fields)}
            if "Ov" in found:
                return found
        raise AssertionError("no overrides are reported")

    def streamed(self, cycle: int) -> dict[str, Any]:
        """Return what the stream shows of a cycle."""
        while (status := json.loads(self.stream.recv(timeout=60))["status"])["cycle"] < cycle:
            pass
        found: dict[str, Any] = status
        return found

    def rest(self) -> dict[str, Any]:
        """Return the status by REST."""
        found: dict[str, Any] = self.http.get("/status").json()
        return found

    def focas(self) -> dict[str, Any]:
        """Return what FOCAS says, in the words of the status."""
        state = self.line.payload(0x19)
        aut, run, _, _, emergency, alarm, _ = (
            int.from_bytes(state[at : at + 2], "big") for at in range(0, 14, 2)
        )
        (program,) = re.findall(rb"O[0-9]+", self.line.payload(0xCF)[4:]) or [b""]
        return {
            "mode": AUT[aut],
            "run": RUN[run],
            "emergency": emergency,
            "alarm": bool(alarm),
            "alarms": int.from_bytes(self.line.payload(0x1A)[:4], "big") != 0,
            "program": f"O{int(program[1:] or 0):04d}",
            "line": int.from_bytes(self.line.payload(0x20, 64)[:4], "big"),
            "sequence": int.from_bytes(self.line.payload(0x1D)[:4], "big"),
            "machine": values(self.line.payload(0x26, 1, -1))[:3],
            "absolute": values(self.line.payload(0x26, 4, -1))[:3],
            "feed": values(self.line.payload(0x24))[0],
            "override": 255 - self.line.payload(0x8001, 12, 12, 0, 0, target=2)[0],
            "rpm": values(self.line.payload(0x25))[0],
        }
