"""A process with OPC UA and HTTP: a client of the library reads, writes, subscribes; both doors agree."""

from __future__ import annotations

import asyncio
import json
import math
import os
import socket
import struct
import time
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

from support.command import slow_s
from support.started import started

httpx = pytest.importorskip("httpx", reason="pip install httpx")
pytest.importorskip("asyncua", reason="pip install 'polycnc[opcua]'")
pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

from asyncua import Client, ua  # noqa: E402
from asyncua.crypto.security_policies import SecurityPolicyBasic256Sha256  # noqa: E402

from polycnc.servers.opcua import CNC_TYPES, MACHINE_TOOL_TYPES  # noqa: E402

CNC = "http://opcfoundation.org/UA/CNC"
TOOL = "http://opcfoundation.org/UA/MachineTool/"
CHANNEL = "machine/CncChannelList/Channel1"
SPINDLE = "machine/CncSpindleList/Spindle1"
MONITORED = "Machines/machine/Monitoring/Channel1"
PROGRAM = "N10 G90 G1 F1230 X40 S820 M3\nN20 Y31\nM0\nN30 G2 X0 Y0 R30\nN40 X-20\nM30\n"
GOOD, OUT_OF_RANGE = ua.StatusCodes.Good, ua.StatusCodes.BadOutOfRange


class Served:
    """A process that serves a mill, and a client of its page."""

    log: Path

    def __init__(self, *more: str) -> None:
        self.process = started("serve", "--plain", "mill3", "--doors", "opcua=0,http=0", *more)
        self.opcua = self.process.stdout.readline().partition(" ")[2].strip()
        self.url = self.process.stdout.readline().partition(" ")[2].strip()
        self.http = httpx.Client(base_url=f"{self.url}/api/machines/machine", timeout=60)

    @property
    def port(self) -> int:
        return int(self.opcua.rpartition(":")[2])

    def command(self, command: str, **values: Any) -> Any:
        return self.http.post("/commands", json={"command": command, **values})

    def step(self, cycles: int) -> None:
        assert self.http.post("/clock", json={"step": cycles}).status_code == 200

    def status(self) -> dict[str, Any]:
        found: dict[str, Any] = self.http.get("/status").json()
        return found

    def end(self) -> str:
        self.http.close()
        self.process.terminate()
        _, error = self.process.communicate(timeout=60)
        assert self.process.returncode == 143, error
        return error


SCENARIO = """
[[step]]
name = "at the begin"
at_s = 0.0005
do = "message"
with = { number = 1, text = "good morning" }

[[step]]
name = "the network is cut"
when = { value = "channels.0.switches.optional_stop", equals = true }
do = "drop"
door = "opcua"
for_s = 0.5
"""


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    scenario = tmp_path_factory.mktemp("scenario") / "cut.toml"
    scenario.write_text(SCENARIO)
    made = Served("--scenario", str(scenario), "--log", str(scenario.with_name("log.jsonl")))
    made.log = scenario.with_name("log.jsonl")
    yield made
    error = made.end()
    said, late = (
        "opcua builds its address space of thousands of nodes: this takes a few seconds\n",
        "the clocks of the",
    )
    assert error.startswith(said)
    assert all(line.startswith(late) for line in error[len(said) :].splitlines()), error


@pytest.fixture(autouse=True)
def _at_rest(served: Served) -> Iterator[None]:
    served.http.post("/clock", json={"rate": 0})
    served.command("emergency_stop", on=False)
    served.command("reset")
    served.step(500)
    yield
    served.http.post("/clock", json={"rate": 1})


@asynccontextmanager
async def connected(served: Served) -> AsyncIterator[Client]:
    client = Client(served.opcua, timeout=60)
    async with client:
        yield client


def with_client(served: Served, visit: Callable[[Client], Coroutine[Any, Any, None]]) -> None:
    async def run() -> None:
        async with connected(served) as client:
            await visit(client)

    asyncio.run(run())


async def values(client: Client, *paths: str) -> list[ua.DataValue]:
    nodes = [client.get_node(ua.NodeId(path, 1)) for path in paths]
    read: list[ua.DataValue] = await client.uaclient.read_attributes(
        [each.nodeid for each in nodes], ua.AttributeIds.Value
    )
    return read


async def value(client: Client, path: str) -> Any:
    (read,) = await values(client, path)
    read.StatusCode.check()
    return read.Value.Value


async def write(client: Client, path: str, written: Any, kind: ua.VariantType) -> int:
    try:
        await client.get_node(ua.NodeId(path, 1)).write_value(ua.DataValue(ua.Variant(written, kind)))
    except ua.UaStatusCodeError as refused:
        return int(refused.code)
    return int(GOOD)


async def names_below(client: Client, node: Any) -> dict[str, Any]:
    return {each.BrowseName.Name: client.get_node(each.NodeId) for each in await node.get_references(refs=33)
            if each.IsForward}  # fmt: skip


def test_the_tree_has_what_the_tables_say(served: Served) -> None:
    async def visit(client: Client) -> None:
        index = {uri: await client.get_namespace_index(uri) for uri in (CNC, TOOL)}
        by_type = {(each.number, index.get(each.space)): each for each in (*CNC_TYPES, *MACHINE_TOOL_TYPES)}
        seen = set()

        async def look(node: Any) -> None:
            of = await node.read_type_definition()
            row = by_type.get((of.Identifier, of.NamespaceIndex))
            below = await names_below(client, node)
            if row is not None:
                seen.add(row.name)
                asked = {each.name for each in row.all_members if "/" not in each.name}
                assert asked <= set(below), row.name
                others = [each for name, each in below.items() if name not in asked]
                for other in others:
                    assert await other.read_node_class() is ua.NodeClass.Object
                for member in row.all_members:
                    if member.unit:
                        assert {"EngineeringUnits", "EURange"} <= set(
                            await names_below(client, below[member.name])
                        )
            for each in below.values():
                if await each.read_node_class() is ua.NodeClass.Object:
                    await look(each)

        below = await names_below(client, client.nodes.objects)
        await look(below["machine"])
        await look((await names_below(client, below["Machines"]))["machine"])
        assert "test" not in below
        for kind in (ua.ObjectIds.Structure, ua.ObjectIds.Enumeration):
            for each in await client.get_node(kind).get_children(refs=ua.ObjectIds.HasSubtype):
                if each.nodeid.NamespaceIndex in index.values():
                    is_abstract = await each.read_attribute(ua.AttributeIds.IsAbstract)
                    assert is_abstract.Value.Value is False, each
        assert {
            "CncInterfaceType",
            "CncChannelType",
            "CncAxisType",
            "CncSpindleType",
            "MachineToolType",
        } <= seen
        assert {"ChannelMonitoringType", "SpindleMonitoringType", "MachineToolIdentificationType"} <= seen

    with_client(served, visit)


def test_units_have_their_unece_codes_and_ranges_those_of_the_machine(served: Served) -> None:
    async def visit(client: Client) -> None:
        # the numbers that OPC 10000-8 gives for MMT, P1, RPM and H81
        for path, number in (
            ("machine/CncAxisList/Y/PosDirect", 5066068), (f"{CHANNEL}/CmdOverride", 20529),
            (f"{SPINDLE}/ActSpeed", 5394509), (f"{CHANNEL}/ActFeedrate", 4732977),
        ):  # fmt: skip
            unit = await value(client, f"{path}/EngineeringUnits")
            assert unit.UnitId == number
            assert unit.NamespaceUri.endswith("units/un/cefact")
        override = await value(client, f"{CHANNEL}/CmdOverride/EURange")
        assert (override.Low, override.High) == (0.0, 200.0)

    with_client(served, visit)


def test_positions_are_structures_and_variables_of_one_cycle(served: Served) -> None:
    """What the other variables say of a run is in the test of all doors."""

    async def visit(client: Client) -> None:
        await client.load_data_type_definitions()
        served.command("select_mode", mode="mdi")
        served.command("set_mdi", text="G91 G1 X-5.25 Y3 F900\n")
        served.command("cycle_start")
        served.step(83)
        for axis in served.status()["axes"].values():
            path = f"machine/CncAxisList/{axis['name']}"
            position, actual, moving = await values(
                client, f"{path}/PosDirect", f"{path}/PosDirect/ActPos", f"{path}/ActStatus"
            )
            at = position.Value.Value
            assert (at.ActPos, at.CmdPos, at.RemDist) == (axis["machine"], axis["setpoint"], axis["to_go"])
            assert actual.Value.Value == axis["machine"]
            assert moving.Value.Value == int(axis["moving"])
            work = await value(client, f"{CHANNEL}/PosTcpWcs{axis['name']}")
            assert work.ActPos == axis["work"]

    with_client(served, visit)
    assert served.status()["channels"][0]["run_state"] == "active"


def test_what_is_written_acts_and_what_cannot_be_changes_nothing(served: Served) -> None:
    double, boolean, integer = ua.VariantType.Double, ua.VariantType.Boolean, ua.VariantType.Int32

    async def visit(client: Client) -> None:
        assert await write(client, f"{CHANNEL}/CmdOverride", 73.0, double) == GOOD
        assert served.status()["overrides"]["feed"] == pytest.approx(0.73)
        assert await value(client, f"{CHANNEL}/ActOverride") == pytest.approx(73.0)
        assert await write(client, f"{SPINDLE}/CmdOverride", 120.0, double) == GOOD
        assert served.status()["overrides"]["spindle"] == pytest.approx(1.2)
        assert await write(client, f"{CHANNEL}/CmdOperationMode", 1, integer) == GOOD
        assert served.status()["mode"] == "mdi"
        assert await write(client, f"{CHANNEL}/CmdOperationMode", 2, integer) == GOOD
        served.http.put("/programs/PART.nc", content=PROGRAM)
        served.command("select_program", program="PART.nc")
        served.command("cycle_start")
        served.step(40)
        assert await write(client, f"{CHANNEL}/FeedHold", True, boolean) == GOOD
        served.step(400)
        assert served.status()["channels"][0]["run_state"] == "hold"
        assert await write(client, f"{CHANNEL}/FeedHold", False, boolean) == GOOD
        served.step(7)
        assert served.status()["channels"][0]["run_state"] == "active"

        before = served.status()
        not_writable, mismatch = ua.StatusCodes.BadNotWritable, ua.StatusCodes.BadTypeMismatch
        for path, written, kind, code in (
            (f"{CHANNEL}/CmdOverride", 200.5, double, OUT_OF_RANGE),
            (f"{CHANNEL}/CmdOverride", -1.0, double, OUT_OF_RANGE),
            (f"{CHANNEL}/CmdOverride", math.nan, double, OUT_OF_RANGE),
            (f"{CHANNEL}/CmdOverride", math.inf, double, OUT_OF_RANGE),
            (f"{CHANNEL}/CmdOverride", 50, integer, mismatch), (f"{CHANNEL}/CmdOverride", [50.0], double, mismatch),
            (f"{CHANNEL}/CmdOverride", "50", ua.VariantType.String, mismatch),
            (f"{CHANNEL}/CmdOperationMode", 3, integer, OUT_OF_RANGE),
            (f"{CHANNEL}/CmdOperationMode", -1, integer, OUT_OF_RANGE),
            (f"{CHANNEL}/CmdOperationMode", 0, integer, ua.StatusCodes.BadInvalidState),
            (f"{CHANNEL}/ActOverride", 50.0, double, not_writable),
            (f"{CHANNEL}/ToolId", 3, ua.VariantType.UInt32, not_writable),
            (f"{CHANNEL}/CmdOverride/EURange", ua.Range(0, 9), ua.VariantType.ExtensionObject, not_writable),
            ("machine/none", 1.0, double, ua.StatusCodes.BadNodeIdUnknown),
        ):  # fmt: skip
            assert await write(client, path, written, kind) == code, (path, written)
            assert served.status() == before, (path, written)

    with_client(served, visit)


def test_tools_and_the_job_come_and_go_and_clients_are_told(served: Served) -> None:
    """Whatever changes the tool table, its list has the same tools, without a read between; so with the job."""

    async def visit(client: Client) -> None:
        tools, plan = (client.get_node(ua.NodeId(f"Machines/machine/{each}", 1)) for each in (
            "Equipment/Tools", "Production/ProductionPlan"))  # fmt: skip
        seen = Seen()
        subscription = await client.create_subscription(50, seen)
        await subscription.subscribe_events(client.nodes.server, ua.ObjectIds.GeneralModelChangeEventType)
        versions = {await value(client, f"{tools.nodeid.Identifier}/NodeVersion")}
        name = client.get_node(ua.NodeId(f"{tools.nodeid.Identifier}/Tool17/Name", 1))
        there: dict[int, str] = {}
        for number, text in ((17, "drill 5"), (4, ""), (17, "tap M6"), (4, None), (300, "mill"), (17, None)):
            if text is None:
                served.http.delete(f"/tools/{number}").raise_for_status()
                del there[number]
            else:
                served.http.put(f"/tools/{number}", json={"description": text}).raise_for_status()
                there[number] = text
            if (number, text) == (17, "tap M6"):
                await subscription.subscribe_data_change(name)
            listed = {
                each.BrowseName.Name: each.NodeId for each in await tools.get_children_descriptions(refs=47)
            }
            assert set(listed) == {f"Tool{each}" for each in there}
            for each, called in there.items():
                at = f"{tools.nodeid.Identifier}/Tool{each}"
                members = "ControlIdentifier1", "Name", "Identifier"
                read = await values(client, *(f"{at}/{member}" for member in members))
                assert [of.Value.Value for of in read] == [each, called, f"machine.T{each}"]
            versions.add(await value(client, f"{tools.nodeid.Identifier}/NodeVersion"))
        assert len(versions) == 6, "it differs with each tool that came or went"
        await seen.until(
            lambda: any(node == name.nodeid.Identifier and not text for node, text, _ in seen.values)
        )
        await seen.until(lambda: len(seen.events) >= 5)
        changes = [each for event in seen.events for each in event.Changes]
        told = [(each.Affected.Identifier.rpartition("/")[2], each.Verb) for each in changes]
        assert told == [("Tool17", 1), ("Tool4", 1), ("Tool4", 2), ("Tool300", 1), ("Tool17", 2)]
        with pytest.raises(ua.uaerrors.BadNodeIdUnknown):
            await name.read_value()
        served.http.put("/programs/PART.nc", content=PROGRAM)
        served.command("select_mode", mode="auto")
        served.command("select_program", program="PART.nc")
        (job,) = await plan.get_children(refs=ua.ObjectIds.HasOrderedComponent)
        active = "Machines/machine/Production/ActiveProgram"
        assert await value(client, f"{active}/JobNodeId") == job.nodeid
        space = await client.get_namespace_index(TOOL)
        state = await (await job.get_child([f"{space}:State", "0:CurrentState", "0:Id"])).read_value()
        shown = await value(client, f"{job.nodeid.Identifier}/State/CurrentState")
        assert (await client.get_node(state).read_browse_name()).Name == shown.Text
        of = await client.get_node(f"ns=1;s={job.nodeid.Identifier}/State").read_type_definition()
        parent = await client.get_node(state).get_parent()
        assert parent.nodeid == of, "the state is one of the machine's type"

    with_client(served, visit)


class Seen:
    """What a subscription has told."""

    def __init__(self) -> None:
        self.values: list[tuple[str, Any, Any]] = []
        self.events: list[Any] = []
        self.news = asyncio.Event()

    def datachange_notification(self, node: Any, value: Any, data: Any) -> None:
        self.values.append((node.nodeid.Identifier, value, data.monitored_item.Value.SourceTimestamp))
        self.news.set()

    def event_notification(self, event: Any) -> None:
        self.events.append(event)
        self.news.set()

    async def until(self, done: Callable[[], bool]) -> None:
        while not done():
            self.news.clear()
            await asyncio.wait_for(self.news.wait(), 60)


async def see_refreshed(client: Client, served: Served) -> None:
    """An alarm that was on before a client came is repeated for it, between the events that say so."""
    served.command("emergency_stop", on=True)
    seen = Seen()
    subscription = await client.create_subscription(50, seen)
    messages = client.get_node(ua.NodeId("Machines/machine/Notification/Messages", 1))
    alert = client.get_node(ua.NodeId(39, await client.get_namespace_index(TOOL)))
    await subscription.subscribe_events(messages, alert)
    condition = client.get_node(ua.ObjectIds.ConditionType)
    await condition.call_method(
        ua.NodeId(ua.ObjectIds.ConditionType_ConditionRefresh),
        ua.Variant(subscription.subscription_id, ua.VariantType.UInt32),
    )
    await seen.until(lambda: bool(seen.events))
    (event,) = seen.events
    assert (event.ErrorCode, event.Message.Text) == ("400", "emergency stop")
    await subscription.delete()
    with pytest.raises(ua.uaerrors.BadHistoryOperationUnsupported):
        await client.get_node(ua.NodeId(f"{CHANNEL}/Id", 1)).read_raw_history()


def test_a_subscription_follows_without_being_asked_and_alarms_are_events(served: Served) -> None:
    async def visit(client: Client) -> None:
        index = await client.get_namespace_index(CNC)
        served.step(300)
        seen = Seen()
        subscription = await client.create_subscription(1, seen)  # held to what a server can keep up with
        await subscription.subscribe_data_change(
            [client.get_node(ua.NodeId(f"{CHANNEL}/{name}", 1)) for name in ("ActOverride", "ActFeedrate")]
        )
        alarm = client.get_node(ua.NodeId(1006, index))
        await subscription.subscribe_events(client.get_node(ua.NodeId("machine", 1)), alarm)
        await seen.until(lambda: len(seen.values) >= 2)
        served.command("set_overrides", feed=0.41)
        await seen.until(lambda: any(each[1] == pytest.approx(41.0) for each in seen.values))
        now = served.status()["now"]
        assert seen.values[-1][2].replace(tzinfo=None).isoformat() == now
        served.command("emergency_stop", on=True)
        await seen.until(lambda: bool(seen.events))
        served.command("emergency_stop", on=False)
        served.command("reset")
        served.step(100)
        await seen.until(lambda: len(seen.events) >= 2)
        came, went = seen.events[:2]
        assert came.EventType == ua.NodeId(1006, index)
        assert (came.AlarmIdentifier, came.Message.Text, came.Severity) == ("400", "emergency stop", 1000)
        assert getattr(came, "ActiveState/Id") is True
        assert getattr(went, "ActiveState/Id") is False
        await subscription.delete()
        await see_refreshed(client, served)

    with_client(served, visit)


def test_a_scenario_cuts_the_connections_for_as_long_as_it_says(served: Served) -> None:
    async def cut() -> None:
        client = Client(served.opcua, timeout=60)
        await client.connect()
        served.command("set_switches", optional_stop=True)
        served.step(40)
        with pytest.raises((ConnectionError, asyncio.TimeoutError, ua.UaError)):
            await value(client, f"{CHANNEL}/Id")
        with suppress(Exception):
            await client.disconnect()
        served.command("set_switches", optional_stop=False)
        served.step(500)

    async def again(client: Client) -> None:
        assert await value(client, f"{CHANNEL}/Id") == 1

    asyncio.run(cut())
    with_client(served, again)


def test_no_machine_time_passes_while_the_door_opens(served: Served) -> None:
    """The scenario began at cycle 0, and so did its first step, although the door took seconds to open."""
    first = next(json.loads(line) for line in served.log.read_text().splitlines() if "at the begin" in line)
    assert first["cycle"] == 1  # the one that makes the machine ready


def _hello(more: int = 0) -> bytes:
    url = b"opc.tcp://127.0.0.1"
    body = struct.pack("<IIIIII", 0, 65536, 65536, 0, 0, len(url)) + url
    return b"HELF" + struct.pack("<I", 8 + len(body) + more) + body


@pytest.mark.parametrize(
    ("sent", "ends"),
    [
        (b"HELF\xff\xff\xff\xff" + b"x" * 500_000, True),
        (_hello() + b"OPNF\x00\x00\x00\x00" + b"x" * 100, True),
        (_hello() + b"MSGC\x00\x01\x00\x00" + b"\x00" * 248 + b"MSGC\x00\x01\x00\x00" * 900, False),
        (b"GET / HTTP/1.1\r\nHost: x\r\n\r\n" * 40, True),
        (_hello() + b"MSGF\x18\x00\x02\x00" + b"\xff" * 200_000, True),
    ],
)
def test_floods_and_nonsense_end_the_connection_and_nothing_else(
    served: Served, sent: bytes, ends: bool
) -> None:
    with socket.create_connection(("127.0.0.1", served.port), timeout=60) as line:
        with suppress(ConnectionError):
            line.sendall(sent)
        with suppress(ConnectionError):
            while ends and line.recv(65536):
                pass

    async def visit(client: Client) -> None:
        assert await value(client, f"{CHANNEL}/Id") == 1

    with_client(served, visit)


def test_connections_that_only_begin_make_room_for_others(served: Served) -> None:
    hello = _hello()

    async def crowded(client: Client) -> None:
        lines = [socket.create_connection(("127.0.0.1", served.port), timeout=60) for _ in range(130)]
        for number, line in enumerate(lines):
            with suppress(ConnectionError):
                line.sendall(hello[: number % len(hello)])

        async def visit() -> None:
            async with connected(served) as other:
                assert await value(other, f"{CHANNEL}/Id") == 1

        await visit()
        assert await value(client, f"{CHANNEL}/Id") == 1  # who has a session keeps it
        for line in lines:
            line.close()

    with_client(served, crowded)


async def _secured(served: Served, folder: Path) -> Client:
    """Return a client with a certificate of its own, which signs and encrypts."""
    from asyncua.crypto.cert_gen import setup_self_signed_certificate
    from cryptography.x509.oid import ExtendedKeyUsageOID

    key, certificate, uri = folder / "key.pem", folder / "certificate.der", "urn:test:client"
    await setup_self_signed_certificate(
        key, certificate, uri, "localhost", [ExtendedKeyUsageOID.CLIENT_AUTH], {"organizationName": "test"}
    )
    client = Client(served.opcua.replace("0.0.0.0", "127.0.0.1"), timeout=60)
    client.application_uri = uri
    await client.set_security(SecurityPolicyBasic256Sha256, certificate, key)
    return client


def test_on_this_computer_a_client_may_encrypt(served: Served, tmp_path: Path) -> None:
    async def visit() -> None:
        async with await _secured(served, tmp_path) as client:
            assert await value(client, f"{CHANNEL}/Id") == 1
            assert await write(client, f"{CHANNEL}/CmdOverride", 84.0, ua.VariantType.Double) == GOOD

    asyncio.run(visit())
    assert served.status()["overrides"]["feed"] == pytest.approx(0.84)


@pytest.mark.long
def test_for_other_computers_there_is_no_door_without_encryption_and_the_secret(tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_text("a secret of many letters".replace(" ", "-"))
    own = Served("--expose", "0.0.0.0", "--token", str(secret))

    async def visit() -> None:
        with pytest.raises((ua.UaError, ConnectionError, asyncio.TimeoutError)):
            async with Client(own.opcua.replace("0.0.0.0", "127.0.0.1"), timeout=60):
                pass
        for user, shown in (("me", "another-secret-of-many"), (None, None), ("me", "")):
            client = await _secured(own, tmp_path)
            if user is not None:
                client.set_user(user)
                client.set_password(shown)
            with pytest.raises((ua.UaError, ConnectionError, asyncio.TimeoutError)):
                async with client:
                    pass
        client = await _secured(own, tmp_path)
        client.set_user("me")
        client.set_password(secret.read_text())
        async with client:
            assert await value(client, f"{CHANNEL}/Id") == 1
            endpoints = await client.get_endpoints()
            assert {each.SecurityMode.name for each in endpoints} == {"Sign", "SignAndEncrypt"}

    try:
        asyncio.run(visit())
    finally:
        own.end()


@pytest.mark.long
def test_official_node_sets_give_the_same_tree_without_the_stray_object() -> None:
    folder = Path(os.environ.get("POLYCNC_DATA") or Path(__file__).parents[3] / "shared" / "data") / "opcua"
    if not folder.is_dir():
        pytest.skip("needs the official node sets (POLYCNC_DATA with opcua/)")
    own = Served("--opcua-nodesets", str(folder))
    own.http.post("/clock", json={"rate": 0})
    try:
        test_the_tree_has_what_the_tables_say(own)
        test_what_is_written_acts_and_what_cannot_be_changes_nothing(own)
    finally:
        own.end()


@pytest.mark.long
def test_it_ends_within_a_second_with_a_client_that_has_subscribed(tmp_path: Path) -> None:
    own = Served("--memory", str(tmp_path / "machine.sqlite"))

    async def visit() -> float:
        client = Client(own.opcua, timeout=60)
        await client.connect()
        seen = Seen()
        subscription = await client.create_subscription(50, seen)
        await subscription.subscribe_data_change(client.get_node(ua.NodeId(f"{CHANNEL}/ToolId", 1)))
        await seen.until(lambda: bool(seen.values))
        begin = time.monotonic()
        own.end()
        took = time.monotonic() - begin
        with suppress(Exception):
            await asyncio.wait_for(client.disconnect(), 5)
        return took

    assert asyncio.run(visit()) < 5.0 + 25 * slow_s()  # a second, on a computer that has others to serve
    kept = tmp_path / "machine.sqlite.doors"
    assert {each.name for each in kept.iterdir()} == {"certificate.der", "key.pem"}
    assert (kept / "key.pem").stat().st_mode & 0o077 == 0
