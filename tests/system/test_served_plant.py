"""A process with MTConnect, SHDR and HTTP over real sockets: all doors agree, bad input is refused."""

from __future__ import annotations

import http.client
import json
import random
import re
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from support.command import polycnc, script
from support.mtconnect import assert_valid, header_of, values_of
from support.plant_doors import Agent, Shdr
from support.started import started

pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

PROGRAM = "N10 G90 G1 F1200 X40 S800 M3\nN20 Y30\nM0\nN30 G2 X0 Y0 R30\nN40 X-20\nM30\n"
ACTIONS: list[tuple[str, dict[str, Any]]] = [
    ("cycle_start", {}), ("cycle_start", {}), ("feed_hold", {}), ("reset", {}), ("emergency_stop", {"on": True}),
    ("emergency_stop", {"on": False}), ("set_overrides", {"feed": 0.5}), ("set_overrides", {"spindle": 1.2}),
    ("select_mode", {"mode": "auto"}), ("select_mode", {"mode": "mdi"}), ("select_mode", {"mode": "jog"}),
    ("set_switches", {"single_block": True}), ("set_switches", {"single_block": False}),
    ("set_tool", {"number": 4, "values": {"length_mm": 33.5}}), ("select_program", {"program": "PART|1"}),
]  # fmt: skip


class Served:
    """A process that serves a control, and a client of each door."""

    def __init__(self) -> None:
        self.process = started(
            "serve", "--plain", "mill3", "--doors", "shdr=0,http=0,mtconnect=0", "--rate", "0"
        )
        lines = [self.process.stdout.readline() for _ in range(3)]
        self.ports = {line.partition(":")[0]: int(line.strip().rpartition(":")[2]) for line in lines}
        self.rest = http.client.HTTPConnection("127.0.0.1", self.ports["http"], timeout=60)
        self.agent = Agent(self.ports["mtconnect"])
        self.get = self.agent.get
        self.shdr = Shdr(self.ports["shdr"])

    def ask(self, method: str, path: str, body: Any = None) -> Any:
        text = body if isinstance(body, str) else json.dumps(body)
        self.rest.request(method, f"/api/machines/machine{path}", body=text.encode())
        answer = self.rest.getresponse()
        content = answer.read()
        return json.loads(content) if content else None

    def end(self) -> None:
        self.shdr.line.close()
        self.rest.close()
        self.agent.close()
        self.process.terminate()
        _, error = self.process.communicate(timeout=60)
        assert self.process.returncode == 143
        assert "Traceback" not in error, error


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    made = Served()
    yield made
    made.end()


def test_an_adapter_sends_what_the_agent_observes(served: Served) -> None:
    """Names of programs have bars in them, tools are assets; what is said of a run is in the test of all doors."""
    chosen = random.Random(20261125)
    served.ask("PUT", "/programs/PART%7C1", PROGRAM)
    for name, values in chosen.choices(ACTIONS, k=16):
        served.ask("POST", "/commands", {"command": name, **values})
        served.ask("POST", "/clock", {"step": chosen.randint(1, 700)})
        code, document = served.get("/current")
        assert code == 200
        shown, sent = values_of(ElementTree.fromstring(document)), served.shdr.sync()
        assert {name: shown[name] for name in sent} == sent
        assert set(shown) - set(sent) == {"asset_chg", "asset_rem", "asset_count"}
    assert shown["program"] == "PART|1"
    assert "machine.T4" in served.shdr.assets
    assert_valid(served.get("/current")[1], "2.7")


def test_sequences_go_on_without_a_gap(served: Served) -> None:
    served.ask("POST", "/clock", {"step": 50})
    number, got = int(header_of(served.get("/current")[1])["firstSequence"]), list[int]()
    while True:
        code, document = served.get(f"/sample?from={number}&count=37")
        assert code == 200
        header = header_of(document)
        tree = ElementTree.fromstring(document)
        got += sorted(int(each.attrib["sequence"]) for each in tree.iter() if "dataItemId" in each.attrib)
        number = int(header["nextSequence"])
        if number == int(header["lastSequence"]) + 1:
            break
    assert got == list(range(got[0], number))


def test_a_stream_sends_what_changes_and_a_heartbeat(served: Served) -> None:
    last = header_of(served.get("/current")[1])["nextSequence"]
    line = socket.create_connection(("127.0.0.1", served.ports["mtconnect"]), timeout=60)
    path = f"/sample?from={last}&interval=10&heartbeat=50&path=//DataItem[@name='Fovr']"
    line.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
    held = b""
    while held.count(b"</MTConnectStreams>") < 2:
        held += line.recv(65536)
    assert b"multipart/x-mixed-replace" in held
    assert b"PathFeedrateOverride" not in held
    served.ask("POST", "/commands", {"command": "set_overrides", "feed": 0.77})
    while b">77</PathFeedrateOverride>" not in held:
        held += line.recv(65536)
    line.close()
    code, document = served.get("/current?interval=abc")
    assert (code, b"InvalidParameterValue" in document) == (400, True)


def test_pymtconnect_reads_it(served: Served) -> None:
    client = pytest.importorskip("pymtconnect.mtconnect_client", reason="pip install pymtconnect requests")
    url = f"http://127.0.0.1:{served.ports['mtconnect']}"
    header, (device,) = client.probe(url)
    assert device.name == "machine"
    for header, events, conditions in (client.current(url), client.sample(url, count=300)):
        assert int(header.next_sequence) > int(header.first_sequence)
        assert {"Execution", "ControllerMode", "EmergencyStop"} <= {each.type for each in events}
        assert conditions


def test_bad_requests_are_refused_with_documents(served: Served) -> None:
    documents = []
    for path, status, word in (
        ("/nobody/current", 404, b"NoDevice"), ("/current?at=0", 400, b"OutOfRange"),
        ("/sample?count=1000000000000000000", 400, b"OutOfRange"), ("/current?path=//%5B", 400, b"InvalidXPath"),
        ("/current?path=" + "//*" * 900, 400, b"InvalidXPath"), ("/asset/none", 404, b"AssetNotFound"),
        ("/%00/%ff", 404, b"InvalidURI"), ("/current?" + "a" * 5000, 400, b"InvalidRequest"),
    ):  # fmt: skip
        code, document = served.get(path)
        assert (code, word in document) == (status, True), (path[:60], document)
        documents.append(document)
    assert served.get("/probe", Host="evil.example")[0] == 400
    for method in ("POST", "PUT", "DELETE"):
        code, document = served.agent.ask(method, "/machine", b"x" * 100)
        assert (code, b"Unsupported" in document) == (405, True)
    assert served.agent.ask("HEAD", "/probe") == (200, b"")
    for document in documents:
        assert_valid(document, "2.7")


def test_commands_of_agents_may_be_cut_anywhere(served: Served) -> None:
    served.shdr.sync((b"*", b" ", b"P", b"I", b"N", b"G", b"\r", b"\n"))
    served.shdr.sync((b"what\n\n* ping\n" + b"x" * 70_000 + b"\n* PING\n",))
    other = Shdr(served.ports["shdr"])
    other.sync()
    assert other.values == served.shdr.values
    assert other.assets == served.shdr.assets
    other.line.close()


def test_the_pages_show_what_happens(tmp_path: Path) -> None:
    docs = Path(__file__).parents[2] / "docs"
    pages = [
        docs / "tutorials" / "a-machine-for-your-collector.md",
        docs / "how-to" / "read-a-machine-with-your-agent.md",
    ]
    shown = {
        name: text
        for page in pages
        for name, text in re.findall(r'```\w+ title="([^"]+)"\n(.*?)```', page.read_text("utf-8"), re.DOTALL)
        if name != "prints"
    }
    prints = [
        re.findall(r'title="prints"\n(.*?)```', page.read_text("utf-8"), re.DOTALL)[0] for page in pages
    ]
    (tmp_path / "plate.nc").write_text(shown["plate.nc"])
    program = str(tmp_path / "plate.nc")
    process = started("serve", "--plain", "mill3", "--program", program, "--doors", "mtconnect=0,shdr=0")
    try:
        shdr, agent = (process.stdout.readline().strip() for _ in range(2))
        assert shdr.startswith("shdr: 127.0.0.1:")
        assert agent.startswith("mtconnect: http://127.0.0.1:")
        ports = {"5000": agent.rpartition(":")[2], "7878": shdr.rpartition(":")[2]}
        for name, expected in (
            ("read_it.py", prints[0]), ("follow_it.py", shown["follows"]), ("is_it_there.py", prints[1]),
        ):  # fmt: skip
            (tmp_path / name).write_text(re.sub(r"5000|7878", lambda found: ports[found[0]], shown[name]))
            assert script(tmp_path / name, "", tmp_path).stdout == expected, name
    finally:
        process.terminate()
        process.communicate(timeout=60)
    command = re.findall(r"```sh\npolycnc (mtconnect .*?)\n```", pages[1].read_text("utf-8"))[0]
    polycnc(*command.split(), cwd=tmp_path)
    assert 'name="Mill4"' in (tmp_path / "Devices.xml").read_text("utf-8")
