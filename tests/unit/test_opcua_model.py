"""What the tables of OPC UA say: words of the enumerations from statuses, units, bounds, certificates, node sets."""

from __future__ import annotations

import asyncio
import os
import random
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("asyncua", reason="pip install 'polycnc[opcua]'")

from asyncua import ua
from asyncua.server.address_space import AttributeValue, NodeData

from polycnc.cnc import Control, Mode, RunState
from polycnc.errors import UsageError
from polycnc.servers.machines import Log
from polycnc.servers.opcua import CNC_TYPES, MACHINE_TOOL_TYPES, _bounds
from polycnc.servers.opcua._cnc import CHANNEL as CNC_CHANNEL
from polycnc.servers.opcua._identity import CERTIFICATE, KEY, Users, identity_of
from polycnc.servers.opcua._machine_tool import CHANNEL as TOOL_CHANNEL
from polycnc.servers.opcua._machine_tool import PRODUCTION_STATE
from polycnc.servers.opcua._model import UNITS, Type
from polycnc.servers.opcua._moment import At, Fixed
from polycnc.servers.opcua._node_sets import IN_ORDER, find_node_sets
from polycnc.servers.opcua._publish import Publisher, _plain
from polycnc.servers.opcua._standard import bounded_server
from polycnc.servers.opcua._writes import Writes
from polycnc.servers.plant import FACTS, see
from polycnc.servers.process import Machinery
from support.http_app import served_machine


def at(**fields: Any) -> At:
    """Return a status of a mill whose channel has these fields."""
    control = Control("mill3")
    fixed = Fixed.of("m", control, {})
    seen = see(lambda: control)()
    status = seen.status
    return At(replace(seen, status=status._replace(channels=(status.channel._replace(**fields),))), fixed)


def shown(of: Type, name: str, **fields: Any) -> Any:
    """Return what a member shows of a status whose channel has these fields."""
    member = next(each for each in of.members if each.name == name)
    assert member.read is not None
    return member.read(at(**fields))


# OPC 40502, tables of CncChannelStatus (0 active, 1 interrupted, 2 reset) and CncChannelProgramStatus (0 stopped, 1
# running, 2 waiting, 3 interrupted, 4 canceled); OPC 40501-1: 0 initializing, 1 running, 2 ended, 3 interrupted,
# 4 aborted
@pytest.mark.parametrize(
    ("state", "channel", "program", "production"),
    [
        (RunState.READY, 2, 0, 0), (RunState.ACTIVE, 0, 1, 1), (RunState.HOLD, 1, 3, 3),
        (RunState.STOPPED_AT_BLOCK, 1, 0, 3), (RunState.PROGRAM_STOP, 1, 0, 3), (RunState.OPTIONAL_STOP, 1, 0, 3),
        (RunState.COMPLETED, 2, 0, 2), (RunState.RESET, 2, 4, 4), (RunState.ALARM, 1, 4, 4),
    ],
)  # fmt: skip
def test_states_of_a_run(state: RunState, channel: int, program: int, production: int) -> None:
    assert shown(CNC_CHANNEL, "ActStatus", run_state=state) == channel
    assert shown(TOOL_CHANNEL, "ChannelState", run_state=state) == channel
    assert shown(CNC_CHANNEL, "ActProgramStatus", run_state=state) == program
    assert shown(PRODUCTION_STATE, "CurrentState/Number", run_state=state) == production


def test_a_run_that_waits_for_its_program_is_waiting() -> None:
    assert shown(CNC_CHANNEL, "ActProgramStatus", run_state=RunState.ACTIVE, starved=True) == 2


@pytest.mark.parametrize(
    ("mode", "operation", "channel"),
    [
        (Mode.AUTO, 2, 0), (Mode.MDI, 1, 1), (Mode.JOG, 0, 2), (Mode.INC, 0, 3), (Mode.HANDLE, 0, 3), (Mode.REF, 0, 6),
        (Mode.EDIT, 2, 7),
    ],
)  # fmt: skip
def test_modes(mode: Mode, operation: int, channel: int) -> None:
    assert shown(CNC_CHANNEL, "ActOperationMode", mode=mode) == operation
    assert shown(TOOL_CHANNEL, "ChannelMode", mode=mode) == channel


def test_every_value_of_a_machine_is_a_fact_or_fixed() -> None:
    for row in (*CNC_TYPES, *MACHINE_TOOL_TYPES):
        for member in row.members:
            facts = getattr(member.read, "facts", (getattr(member.read, "fact", None),))
            assert all(each is None or each in FACTS for each in facts), member.name


def test_units_have_the_numbers_of_their_codes() -> None:
    # OPC 10000-8: the UnitId of MMT is 5066068, of DD 17476
    assert {UNITS["mm"].number, UNITS["deg"].number} == {5066068, 17476}


def test_each_type_comes_after_its_base_and_numbers_are_given_once() -> None:
    for types in (CNC_TYPES, MACHINE_TOOL_TYPES):
        known: set[tuple[str, int]] = set()
        for row in types:
            assert isinstance(row.base, int) or (row.base.space, row.base.number) in known
            numbers = [each.number for each in row.members if each.number]
            for number in [row.number, *numbers]:
                assert (row.space, number) not in known, (row.name, number)
                known.add((row.space, number))


def _run(visit: Any) -> Any:
    return asyncio.run(visit)


async def nothing(*_: object) -> None:
    return


def test_monitored_items_are_bounded_over_all_subscriptions(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_bounds, "MOST_ITEMS", 7)

    async def visit() -> list[int]:
        server = bounded_server(Users(None))
        node = ua.NodeId("x", 1)
        data = server.aspace[node] = NodeData(node)
        data.attributes[ua.AttributeIds.Value] = AttributeValue(ua.DataValue(ua.Variant(1.5)))
        service = _bounds.Subscriptions(server, nothing, lambda: None)
        codes = []
        for wanted in (0.0, float("nan"), 1e300):
            made = await service.create_subscription(
                ua.CreateSubscriptionParameters(RequestedPublishingInterval=wanted), nothing, ua.NodeId(3)
            )
            assert 50.0 <= made.RevisedPublishingInterval <= 60_000.0
            item = ua.MonitoredItemCreateRequest(
                ItemToMonitor=ua.ReadValueId(NodeId=node, AttributeId=ua.AttributeIds.Value),
                RequestedParameters=ua.MonitoringParameters(QueueSize=2**31),
            )
            asked = ua.CreateMonitoredItemsParameters(
                SubscriptionId=made.SubscriptionId, ItemsToCreate=[item, item, item]
            )
            results = await service.create_monitored_items(asked)
            codes += [each.StatusCode.value for each in results]
            assert all(each.RevisedQueueSize <= 100 for each in results)
        await service.delete_subscriptions(list(service.subscriptions))
        server.method_service.stop()
        return codes

    full = ua.StatusCodes.BadTooManyMonitoredItems
    assert _run(visit()) == [0] * 7 + [full] * 2


@pytest.mark.parametrize("size", [1, 3, 100])
def test_what_changes_is_notified_in_order_up_to_the_size_of_the_queue(size: int) -> None:
    draws = random.Random(size)
    values = [draws.choice([None, 0.25, 0.5, 0.5, 0.75]) for _ in range(60)]

    async def visit() -> list[Any]:
        server = bounded_server(Users(None))
        node = ua.NodeId("x", 1)
        data = server.aspace[node] = NodeData(node)
        data.attributes[ua.AttributeIds.Value] = AttributeValue(_plain(9.0, ua.VariantType.Double, None))
        service = _bounds.Subscriptions(server, nothing, lambda: None)
        told: list[Any] = []

        async def published(result: ua.PublishResult) -> None:
            told.extend(
                item for part in result.NotificationMessage.NotificationData for item in part.MonitoredItems
            )

        made = await service.create_subscription(ua.CreateSubscriptionParameters(), published, ua.NodeId(3))
        item = ua.MonitoredItemCreateRequest(
            ItemToMonitor=ua.ReadValueId(NodeId=node, AttributeId=ua.AttributeIds.Value),
            MonitoringMode=ua.MonitoringMode.Reporting,
            RequestedParameters=ua.MonitoringParameters(ClientHandle=7, QueueSize=size),
        )
        await service.create_monitored_items(
            ua.CreateMonitoredItemsParameters(SubscriptionId=made.SubscriptionId, ItemsToCreate=[item])
        )
        subscription = service.subscriptions[made.SubscriptionId]
        await subscription.publish_results()
        for value in values:
            await server.aspace.write_attribute_value(
                node, ua.AttributeIds.Value, _plain(value, ua.VariantType.Double, None)
            )
        await subscription.publish_results()
        await service.delete_subscriptions([made.SubscriptionId])
        server.method_service.stop()
        assert {each.ClientHandle for each in told} == {7}
        return [each.Value.Value.Value for each in told]

    changes = [value for before, value in pairwise([9.0, *values]) if value != before]
    assert _run(visit()) == [9.0, *changes[-size:]]


def test_a_feed_hold_is_good_only_where_a_program_is_held() -> None:
    """The stop button of a Power Mate can be pressed at any time; what is written to `FeedHold` is so afterwards."""
    member = next(each for each in CNC_CHANNEL.members if each.name == "FeedHold")
    node, good = ua.NodeId("hold", 1), ua.StatusCode(ua.StatusCodes.Good)

    async def run() -> list[tuple[int, str]]:
        machine = served_machine("fanuc", Machinery("m"))
        assert machine.find_control is not None
        control, look = machine.find_control(), see(machine.find_control)
        fixed, device = Fixed.of("m", control, {}), machine.device

        async def refresh() -> None:
            pass

        publisher: Any = SimpleNamespace(
            machine=machine, fixed=fixed, refresh=refresh, at=lambda *_: At(look(), fixed)
        )
        bound: Any = SimpleNamespace(member=member, node=node, item=SimpleNamespace(channel=0, about=""))
        writes = Writes({node: None}, {}, Log())
        writes.add(publisher, bound)

        async def write(on: bool, status: ua.StatusCode = good) -> tuple[int, str]:
            value = ua.DataValue(ua.Variant(on, ua.VariantType.Boolean), status)
            asked = ua.WriteValue(node, ua.AttributeIds.Value, None, value)
            return await writes._one(asked), control.channel_status().run_state.value

        found = [await write(True), await write(False)]
        device.select_mode("MDI")  # type: ignore[attr-defined]
        control.set_mdi("G4 X9.\n")
        device.cycle_start()  # type: ignore[attr-defined]
        machine.served.advance(10)
        uncertain = ua.StatusCode(ua.StatusCodes.UncertainInitialValue)
        found += [await write(True, uncertain), await write(True), await write(True), await write(False)]
        machine.close()
        return found

    codes = ua.StatusCodes
    assert asyncio.run(run()) == [
        (codes.BadInvalidState, "ready"), (codes.Good, "ready"), (codes.BadWriteNotSupported, "active"),
        (codes.Good, "hold"), (codes.Good, "hold"), (codes.Good, "active"),
    ]  # fmt: skip


def test_a_certificate_is_kept_and_used_again(tmp_path: Path) -> None:
    folder = tmp_path / "machine.doors"
    made = identity_of(folder)
    assert identity_of(folder) == made
    (folder / KEY).write_bytes(b"x")
    with pytest.raises(UsageError, match="no certificate and key can be kept there") as refused:
        identity_of(folder)
    assert "Remove certificate.der and key.pem" in refused.value.hint
    (folder / KEY).write_bytes(identity_of(None).key)
    with pytest.raises(UsageError, match="do not belong together"):
        identity_of(folder)
    assert (folder / CERTIFICATE).read_bytes() == made.certificate


def test_a_secret_is_asked_for_where_there_is_one() -> None:
    assert Users(None).get_user(None) is not None
    users = Users("a secret of many letters")
    assert users.get_user(None) is None
    assert users.get_user(None, "me", "another") is None
    assert users.get_user(None, "me", "ä") is None
    assert users.get_user(None, "me", "a secret of many letters") is not None


def test_node_sets_are_found_by_their_namespace_and_a_missing_one_is_named(tmp_path: Path) -> None:
    for number, uri in enumerate(IN_ORDER):
        text = f"<UANodeSet><NamespaceUris>\n <Uri>{uri}</Uri><Uri>other</Uri></NamespaceUris></UANodeSet>"
        (tmp_path / f"{number}.XML").write_text(text)
    assert list(find_node_sets(tmp_path)) == list(IN_ORDER)
    (tmp_path / "5.XML").unlink()
    with pytest.raises(UsageError, match=r"there is no node set of \S+/UA/MachineTool/\n"):
        find_node_sets(tmp_path)
    with pytest.raises(UsageError, match="node sets cannot be read"):
        find_node_sets(tmp_path / "none")


def official() -> Path | None:
    """Return the folder of the official node sets, if it is there."""
    beside = Path(__file__).parents[3] / "shared" / "data"
    folder = Path(os.environ.get("POLYCNC_DATA") or beside) / "opcua"
    return folder if folder.is_dir() else None


@pytest.mark.long
@pytest.mark.skipif(official() is None, reason="needs the official node sets (POLYCNC_DATA with opcua/)")
def test_the_tables_are_those_of_the_official_node_sets() -> None:
    import xml.etree.ElementTree as ElementTree

    folder = official()
    assert folder is not None
    files = find_node_sets(folder)
    numbers: dict[str, Mapping[int, str]] = {}
    for uri, path in files.items():
        found = {}
        for each in ElementTree.parse(path).getroot():
            node, name = each.get("NodeId", ""), each.get("BrowseName", "")
            if node.startswith("ns=1;i="):
                found[int(node[7:])] = name.rpartition(":")[2]
        numbers[uri] = found
    for row in (*CNC_TYPES, *MACHINE_TOOL_TYPES):
        assert numbers[row.space][row.number] == row.name
        for member in row.members:
            if member.number:
                assert numbers[row.space][member.number] == member.name, (row.name, member.name)


def test_the_page_names_every_member() -> None:
    page = (Path(__file__).parents[2] / "docs/reference/opcua.md").read_text(encoding="utf-8")
    for row in (*CNC_TYPES, *MACHINE_TOOL_TYPES):
        for member in row.members:
            name = member.name.rpartition("/")[2]
            assert f"`{name}`" in page or row.name == "CncAlarmType", (row.name, name)


def test_what_is_published_is_never_older_than_what_was_before() -> None:
    """A client writes while the values of an earlier cycle are still being written."""
    cycles, written = iter(range(1, 9)), []

    class Told(Publisher):
        def _read(self) -> Any:
            return next(cycles), 0

        async def _publish(self, seen: Any, revision: int) -> None:
            for _ in range(3):
                await asyncio.sleep(0)
                written.append(seen)

    async def ask(question: Any) -> Any:
        return question()

    async def run() -> None:
        machine: Any = SimpleNamespace(ask=ask, control=None)
        other: Any = SimpleNamespace()
        told = Told(machine, other, (), other, {}, other, other)
        await asyncio.gather(*(told.refresh() for _ in range(3)))

    asyncio.run(run())
    assert written == sorted(written)
    assert len(written) == 9
