"""The door of the agent: several machines as several devices, streams, slow readers; and descriptions for others."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar
from xml.etree import ElementTree

import pytest
from typer.testing import CliRunner

from polycnc.cli._app import app as cli
from polycnc.machine import Wall
from polycnc.servers.machines import Keeper, ServedDevice, ServedMachine
from polycnc.servers.process import DOORS, KINDS, Machinery
from polycnc.servers.setup import Flags, plan_of
from support.mtconnect import assert_valid, plain, values_of

door = pytest.importorskip("polycnc.servers.mtconnect._door", reason="pip install 'polycnc[serve]'")
R = TypeVar("R")
LIMIT_S = 60.0


class Still(Wall):
    """A wall clock that does not move."""

    def now_s(self) -> float:
        return 0.0


class Asked:
    """One request to an application: what it sends is kept; `most` pieces are read, then it waits."""

    def __init__(self, app: Any, path: str, query: str = "", *, most: int = 10_000, **headers: str) -> None:
        self.sent: list[dict[str, Any]] = []
        self._most = most
        self._read = asyncio.Event()
        self._gone = asyncio.Event()
        told = {"host": "127.0.0.1:5000", **headers}
        self._scope = {
            "type": "http", "method": "GET", "path": path, "query_string": query.encode(),
            "headers": [(name.encode(), value.encode()) for name, value in told.items()],
        }  # fmt: skip
        self._app = app
        self.pieces = 0

    async def run(self) -> Asked:
        await asyncio.wait_for(self._app(self._scope, self._receive, self._send), LIMIT_S)
        return self

    def leave(self) -> None:
        self._gone.set()

    def go_on(self) -> None:
        self._read.set()

    async def _receive(self) -> dict[str, Any]:
        await self._gone.wait()
        return {"type": "http.disconnect"}

    async def _send(self, message: dict[str, Any]) -> None:
        self.sent.append(message)
        self.pieces += 1
        if self.pieces == self._most:
            await self._read.wait()

    @property
    def body(self) -> bytes:
        return b"".join(each.get("body", b"") for each in self.sent)


def served(names: dict[str, str]) -> list[ServedMachine]:
    """Return machines of these kinds, by their names."""
    machines = []
    for name, kind in names.items():
        made = KINDS[kind](Machinery(name, "mill3" if kind == "plain" else None))
        device: ServedDevice[Any] = ServedDevice(made.device, made.find_control)
        keeper = Keeper(device, Still())
        machines.append(ServedMachine(**made.all(), name=name, kind=kind, served=device, keeper=keeper))
    return machines


def test_a_machine_is_followed_while_it_is_young_and_for_a_minute_after_its_history_is_asked() -> None:
    async def visit(app: Any, machines: list[ServedMachine]) -> list[bool]:
        (machine,) = machines
        cycles_for = machine.served.clock.cycles_for
        found = [machine.served.is_followed]
        for cycles in (cycles_for(10.0) - 1, 1):
            machine.served.advance(cycles)
            found.append(machine.served.is_followed)
        for path in ("/m/current", "/m/sample"):
            await Asked(app, path, "").run()
            found.append(machine.served.is_followed)
        for cycles in (cycles_for(60.0) - 1, 1):
            machine.served.advance(cycles)
            found.append(machine.served.is_followed)
        return found

    assert with_door({"m": "plain"}, visit) == [True, True, False, False, True, True, False]


def with_door(names: dict[str, str], visit: Callable[[Any, list[ServedMachine]], Any]) -> Any:
    """Visit the application of a door of these machines."""

    async def run() -> Any:
        machines = served(names)
        try:
            observed = door.Observed(machines, (2, 7), 5)
            return await visit(door.App(observed, frozenset({"127.0.0.1"})), machines)
        finally:
            for machine in machines:
                machine.close()

    return asyncio.run(run())


def test_several_machines_are_several_devices() -> None:
    async def visit(app: Any, machines: list[ServedMachine]) -> list[bytes]:
        machines[1].control.set_overrides(feed=0.6)  # type: ignore[union-attr]
        asked = [
            ("/probe", ""),
            ("/current", ""),
            ("/9-b/current", ""),
            ("/polycnc.a/current", "path=//Path"),
        ]
        return [(await Asked(app, path, query).run()).body for path, query in asked]

    documents = with_door({"a": "plain", "9-b": "fanuc"}, visit)
    for document in documents:
        assert_valid(document, "2.7")
    probe, current, one, other = map(ElementTree.fromstring, documents)
    assert [each.attrib["name"] for each in probe[1]] == ["a", "9-b"]
    ids = [each.attrib["id"] for each in probe.iter() if "id" in each.attrib]
    assert len(ids) == len(set(ids))
    assert {"a.Xact", "_9-b.Xact"} <= set(ids)
    assert [each.attrib["name"] for each in current[1]] == ["a", "9-b"]
    assert values_of(one)["Fovr"] == "60"
    assert [each.attrib["uuid"] for each in other[1]] == ["polycnc.a"]


def test_clients_that_ask_for_json_get_it() -> None:
    async def visit(app: Any, machines: list[ServedMachine]) -> list[Asked]:
        asked = [("/current", ""), ("/probe", ""), ("/current", "at=0")]
        return [await Asked(app, path, query, accept="application/json").run() for path, query in asked]

    current, probe, error = with_door({"m": "plain"}, visit)
    for each in (current, probe, error):
        assert (b"content-type", b"application/json") in each.sent[0]["headers"]
    streams = json.loads(current.body)["MTConnectStreams"]
    assert streams["Header"]["nextSequence"] == streams["Header"]["lastSequence"] + 1
    (device,) = (each["DeviceStream"] for each in streams["Streams"])
    parts = {each["ComponentStream"]["name"]: each["ComponentStream"] for each in device["ComponentStreams"]}
    values = {
        body["name"]: body["value"]
        for group in ("Samples", "Events")
        for each in parts["path1"][group]
        for body in each.values()
    }
    assert (values["path_position"], values["f_program"]) == ([0.0, 0.0, 0.0], 0.0)
    assert (values["Fovr"], values["mode"]) == ("100", "AUTOMATIC")
    assert [list(each) for each in parts["path1"]["Condition"]] == [["Normal"]]
    (described,) = json.loads(probe.body)["MTConnectDevices"]["Devices"]
    assert described["Device"]["DataItems"][0]["DataItem"]["id"] == "m.avail"
    (refused,) = json.loads(error.body)["MTConnectError"]["Errors"]
    assert refused["OutOfRange"]["QueryParameter"] == {
        "name": "from",
        "Value": "0",
        "Minimum": "1",
        "Maximum": "73",
    }


def test_a_slow_reader_is_told_what_it_has_missed(monkeypatch: pytest.MonkeyPatch) -> None:

    async def visit(app: Any, machines: list[ServedMachine]) -> tuple[Asked, list[int]]:
        slow = Asked(app, "/sample", "interval=0&count=5", most=3)
        task = asyncio.ensure_future(slow.run())
        while slow.pieces < 3:
            await asyncio.sleep(0)
        control = machines[0].control
        assert control is not None
        sizes = []
        for k in range(200):
            control.set_overrides(feed=(k % 90 + 10) / 100)
            await machines[0].ask(lambda: None)
            app._observed._looks[0]()
            sizes.append(slow.pieces)
        slow.go_on()
        await task
        return slow, sizes

    monkeypatch.setattr(door.Agent, "__init__", _small(door.Agent.__init__))
    slow, sizes = with_door({"m": "plain"}, visit)
    assert set(sizes) == {3}  # nothing queues up for it
    last = slow.body.split(b"\r\n\r\n")[-1].partition(b"\r\n--")[0]
    tree = ElementTree.fromstring(last)
    assert plain(tree[1][0].tag) == "OutOfRange"
    assert slow.body.endswith(b"--\r\n")


def _small(initialise: Any) -> Any:
    def small(self: Any, *arguments: Any) -> None:
        initialise(self, *arguments, size=80)

    return small


def test_a_client_that_leaves_ends_its_stream() -> None:
    async def visit(app: Any, machines: list[ServedMachine]) -> tuple[int, bytes]:
        asked = Asked(app, "/current", "interval=1")
        task = asyncio.ensure_future(asked.run())
        while asked.pieces < 4:
            await asyncio.sleep(0)
        asked.leave()
        await task
        return app._streams, asked.body

    streams, body = with_door({"m": "plain"}, visit)
    assert streams == 0
    assert body.count(b"Content-length: ") >= 3
    for part in body.split(b"\r\n\r\n")[1:3]:
        ElementTree.fromstring(part.partition(b"\r\n--")[0])


def test_a_machine_that_has_failed_is_an_internal_error() -> None:
    async def visit(app: Any, machines: list[ServedMachine]) -> tuple[int, bytes]:
        machines[0].keeper.close()
        asked = await Asked(app, "/current").run()
        return asked.sent[0]["status"], asked.body

    status, body = with_door({"m": "plain"}, visit)
    assert (status, b"InternalError" in body) == (500, True)
    assert_valid(body, "2.7")


def test_boards_without_a_control_have_no_such_doors() -> None:
    plan = plan_of(Flags(None, {"imc": ""}, doors="all"))
    names = [kind.name for kind, _ in (*plan.machines[0].doors, *plan.shared)]
    assert not {"mtconnect", "shdr"} & set(names)
    assert DOORS["mtconnect"].controllers == DOORS["shdr"].controllers == {"plain", "fanuc", "bosch"}


def test_whoever_exposes_them_is_told_that_they_are_read() -> None:
    flags = Flags(
        None, {"plain": "mill3"}, doors="mtconnect,shdr", expose="0.0.0.0", insecure="mtconnect,shdr"
    )
    plan = plan_of(flags)
    assert len(plan.warnings) == 2
    assert all(each.endswith("can read the machine") for each in plan.warnings)


def test_devices_are_written_for_agents_of_others(tmp_path: Path) -> None:
    run = CliRunner().invoke
    told = run(cli, ["mtconnect", "devices", "--plain", "mill3", "--name", "Mill-4"])
    assert told.exit_code == 0, told.output
    assert_valid(told.stdout.encode(), "2.7")
    (device,) = ElementTree.fromstring(told.stdout)[1]
    assert device.attrib["name"] == "Mill-4"
    path = tmp_path / "Devices.xml"
    (tmp_path / "fleet.toml").write_text(
        '[[machine]]\nname = "a"\ncontroller = "plain"\n[[machine]]\nname = "b"\ncontroller = "fanuc"\naxes = 2\n'
    )
    arguments = [
        "mtconnect",
        "devices",
        str(tmp_path / "fleet.toml"),
        "-o",
        str(path),
        "--mtconnect-version",
        "1.3",
    ]
    assert run(cli, arguments).exit_code == 0
    devices = ElementTree.fromstring(path.read_bytes())[1]
    assert [each.attrib["name"] for each in devices] == ["a", "b"]
    before = path.read_bytes()
    for bad in (
        ["--mtconnect-version", "1.1", "--fanuc"],
        [],
        ["--fanuc", "--plain", "mill3"],
        ["--plain", "nothing"],
    ):
        refused = run(cli, ["mtconnect", "devices", *bad, "-o", str(path)])
        assert refused.exit_code == 2, bad
        assert "Traceback" not in refused.output
    assert path.read_bytes() == before
    assert run(cli, ["mtconnect", "devices", "--fanuc", "-o", str(tmp_path / "x.txt")]).exit_code == 2
