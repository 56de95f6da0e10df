"""Clients of the plant doors and of the page: each reads what its door says of the machine at one instant."""

from __future__ import annotations

import http.client
import socket
from collections.abc import Mapping
from typing import Any
from xml.etree import ElementTree

from support.browser import new_page
from support.mtconnect import values_of

CHANNEL, SPINDLE = "machine/CncChannelList/Channel1", "machine/CncSpindleList/Spindle1"
MONITORED = "Machines/machine/Monitoring/Channel1"
OPCUA = {
    **{name: f"{CHANNEL}/{name}" for name in (
        "ActOperationMode", "ActStatus", "ActProgramStatus", "ActProgramName", "ActProgramLine", "ActProgramBlock",
        "ActFeedrate", "ActOverride", "FeedHold", "BlockMode", "ToolId", "ActMainProgramName",
    )},
    "ActSpeed": f"{SPINDLE}/ActSpeed",
    "ChannelMode": f"{MONITORED}/ChannelMode",
    "ChannelState": f"{MONITORED}/ChannelState",
    "FeedOverride": f"{MONITORED}/FeedOverride",
    "Production": "Machines/machine/Production/ActiveProgram/State/CurrentState/Number",
    "ActiveJob": "Machines/machine/Production/ActiveProgram/JobIdentifier",
    **{f"job {name}": f"Machines/machine/Production/ProductionPlan/Job1/{name}" for name in (
        "Identifier", "RunsPlanned", "RunsPlanned/IsValid", "RunsCompleted", "State/CurrentState/Number",
        "ProductionPrograms/Program1/Name",
    )},
    **{f"{axis}/{part}": f"machine/CncAxisList/{axis}/PosDirect/{part}"
       for axis in "XYZ" for part in ("ActPos", "CmdPos", "RemDist")},
}  # fmt: skip
"""The variables that are read, by short names."""


class Shdr:
    """An agent that reads an adapter, and keeps what it was told last."""

    def __init__(self, port: int, axes: str = "XYZ") -> None:
        self.line = socket.create_connection(("127.0.0.1", port), timeout=60)
        self._held = b""
        self.values: dict[str, str] = {}
        self.assets: dict[str, str] = {}
        self.conditions = frozenset({"system", "logic", "comms", "motion", "S1servo"}) | {
            f"{axis}{kind}" for axis in axes for kind in ("travel", "servo")
        }

    def _read(self) -> str:
        while b"\n" not in self._held:
            data = self.line.recv(65536)
            assert data
            self._held += data
        line, _, self._held = self._held.partition(b"\n")
        return line.decode()

    def sync(self, pieces: tuple[bytes, ...] = (b"* PI", b"NG\n")) -> dict[str, str]:
        """Ask whether it lives, cut anywhere, and take everything that comes before the answer."""
        for piece in pieces:
            self.line.sendall(piece)
        while not (line := self._read()).startswith("* PONG"):
            fields = line.replace("\\|", "\x00").split("|")
            if fields[1] == "@ASSET@":
                text = self._read()
                assert self._read() == fields[4]
                self.assets[fields[2]] = text
            elif fields[1] == "@REMOVE_ASSET@":
                del self.assets[fields[2]]
            elif fields[1] in self.conditions:
                self.values[fields[1]] = fields[2].capitalize()
            elif fields[1] == "message":
                self.values[fields[1]] = fields[3]
            else:
                pairs = zip(fields[1::2], fields[2::2], strict=True)
                self.values |= {name: value.strip('"').replace("\x00", "|") for name, value in pairs}
        assert line == "* PONG 10000"
        return self.values


class Agent:
    """A client of an MTConnect agent."""

    def __init__(self, port: int) -> None:
        self._client = http.client.HTTPConnection("127.0.0.1", port, timeout=60)

    def get(self, path: str, **headers: str) -> tuple[int, bytes]:
        """Return the status and the document of a request."""
        return self.ask("GET", path, None, headers)

    def ask(
        self, method: str, path: str, body: bytes | None = None, headers: Mapping[str, str] | None = None
    ) -> tuple[int, bytes]:
        """Return the status and the document of a request of any method."""
        self._client.request(method, path, body=body, headers=headers or {})
        answer = self._client.getresponse()
        return answer.status, answer.read()

    def current(self) -> dict[str, str]:
        """Return what it observes now, by name."""
        code, document = self.get("/current")
        assert code == 200
        return values_of(ElementTree.fromstring(document))

    def close(self) -> None:
        """End the connection."""
        self._client.close()


class Opcua:
    """A client of OPC UA, in a thread of its own."""

    def __init__(self, url: str) -> None:
        from asyncua import ua
        from asyncua.sync import Client

        self._ua = ua
        self._client = Client(url, timeout=60)
        self._client.connect()
        self._nodes = [self._client.get_node(ua.NodeId(path, 1)) for path in OPCUA.values()]

    def read(self) -> dict[str, Any]:
        """Return the variables in one read."""
        return dict(zip(OPCUA, self._client.read_values(self._nodes), strict=True))

    def tools(self) -> dict[str, tuple[int, str]]:
        """Return the tools of its list, number and name, by what each of them is called."""
        at = "Machines/machine/Equipment/Tools"
        found = {}
        for child in self._client.get_node(self._ua.NodeId(at, 1)).get_children(refs=47):
            name, number, identifier = self._client.read_values(
                [self._client.get_node(self._ua.NodeId(f"{child.nodeid.Identifier}/{each}", 1))
                 for each in ("Name", "ControlIdentifier1", "Identifier")]
            )  # fmt: skip
            found[identifier] = number, name
        return found

    def close(self) -> None:
        """End the session."""
        self._client.disconnect()


_SHOWN = """() => {
    const text = (id) => document.getElementById(id).textContent;
    const lines = [...document.getElementById("lines").children];
    return {
        mode: document.querySelector("[data-mode][aria-pressed=true]")?.dataset.mode ?? "",
        run: document.getElementById("run").dataset.state,
        machine: ["X", "Y", "Z"].map((axis) => Number(text(`${axis}-machine`))),
        work: ["X", "Y", "Z"].map((axis) => Number(text(`${axis}-work`))),
        feed: text("figure2"),
        override: text("override-feed-is"),
        alarms: [...document.getElementById("alarms").children].map((each) => each.firstChild.textContent),
        program: text("name"),
        line: lines.findIndex((each) => each.hasAttribute("aria-current")) + 1,
        stopped: document.getElementById("stop").getAttribute("aria-pressed") === "true",
        lost: document.body.classList.contains("lost"),
    };
}"""


_SAME = "return Object.keys(expected).every((key) => JSON.stringify(shown[key]) === JSON.stringify(expected[key]));"
WAIT_MS = 60_000


class Page:
    """The operator's page in a browser."""

    def __init__(self, browser: Any, url: str) -> None:
        self._page = new_page(browser, device_scale_factor=0.5)
        self._page.goto(url)
        self._page.wait_for_selector("body:not(.lost)")

    def shows(self) -> dict[str, Any]:
        """Return what it shows."""
        found: dict[str, Any] = self._page.evaluate(_SHOWN)
        return found

    def comes_to(self, expected: dict[str, Any]) -> bool:
        """Wait until it shows what it shall; false if it does not within some seconds."""
        text = f"(expected) => {{ const shown = ({_SHOWN})(); {_SAME} }}"
        try:
            self._page.wait_for_function(text, arg=expected, timeout=WAIT_MS)
        except Exception:  # Playwright's own, which is not there without it
            return False
        return True
