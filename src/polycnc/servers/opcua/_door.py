"""The door: OPC UA on a port, in the event loop of the machines."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from asyncua import Server, ua
from asyncua.common.callback import CallbackType
from asyncua.common.events import get_event_obj_from_type_node
from asyncua.server.internal_session import InternalSession

from polycnc import __version__
from polycnc.errors import PolycncError, UsageError
from polycnc.servers.machines import (
    LOOPBACK,
    ServedMachine,
    Treatment,
    Wanted,
    peers_of,
    treatment_of,
)
from polycnc.servers.opcua import _cnc as cnc
from polycnc.servers.opcua import _machine_tool as tool
from polycnc.servers.opcua._alarms import AlarmEvents
from polycnc.servers.opcua._bounds import CHUNK_BYTES, MESSAGE_BYTES, MOST_CHUNKS, Listener, Subscriptions
from polycnc.servers.opcua._identity import Users, application_uri, identity_of
from polycnc.servers.opcua._lists import Lists
from polycnc.servers.opcua._model import MACHINE_TOOL, MACHINERY, SPACES
from polycnc.servers.opcua._moment import PRODUCTION_STATES, Fixed
from polycnc.servers.opcua._node_sets import find_node_sets, load_node_sets
from polycnc.servers.opcua._publish import Publisher
from polycnc.servers.opcua._space import Space
from polycnc.servers.opcua._standard import bounded_server
from polycnc.servers.opcua._tree import JOB, MESSAGES, channel_path, interface_items, machine_tool_items
from polycnc.servers.opcua._writes import Writes

PORT = 4840
_END_S = 0.5
_OBJECTS, _SERVER = 85, 2253
_TOKENS = {True: [ua.AnonymousIdentityToken, ua.UserNameIdentityToken], False: [ua.UserNameIdentityToken]}
_POLICY = ua.SecurityPolicyType

_LOGGER = logging.getLogger("asyncua")
_LOGGER.propagate = False  # what clients do wrong is answered to them, no lines on the screen
_LOGGER.addHandler(logging.NullHandler())


class _Server(Server):
    """The library's server, with a listener that has bounds."""

    async def start(self) -> None:
        await self._setup_server_nodes()
        await self.iserver.start()
        self.bserver = Listener(self.iserver, *self._get_bind_socket_info(), self.limits)
        self.bserver.set_policies(self._policies)
        await self.bserver.start()


class OpcuaDoor:
    """Serve machines by OPC UA on one port."""

    def __init__(self, machines: Sequence[ServedMachine], wanted: Wanted) -> None:
        self._machines = machines
        self._wanted = wanted
        self._port = PORT if wanted.port is None else wanted.port
        self._server: _Server | None = None
        self._publishers: list[Publisher] = []
        self._tasks: list[asyncio.Task[None]] = []
        self._subscribed = asyncio.Event()

    @property
    def said(self) -> str:
        """The URL of the endpoint."""
        address = self._wanted.address
        return f"opc.tcp://{f'[{address}]' if ':' in address else address}:{self._port}"

    @property
    def clients(self) -> list[str]:
        """The addresses of the clients that are connected now."""
        listener = None if self._server is None else self._server.bserver
        return [] if listener is None else peers_of(each.transport for each in listener.clients)

    async def start(self) -> None:
        """Build the address space and listen.

        Raises:
            UsageError: The address or port cannot be listened on, or a file that is needed cannot be used.
        """
        wanted = self._wanted
        files = None if wanted.node_sets is None else find_node_sets(wanted.node_sets)
        identity = await asyncio.to_thread(identity_of, wanted.keep)
        server = self._server = _Server(iserver=bounded_server(Users(wanted.token)))
        self._take_over(server)
        await server.init()
        await self._name(server)
        index = {uri: await server.register_namespace(uri) for uri in SPACES}
        space = Space(server, index)
        space.register_position()
        if files is None:
            space.add_types()
        else:
            await load_node_sets(server, files)
        writes = Writes(server.iserver.aspace, space.index, wanted.log)
        for machine in self._machines:
            await self._add(machine, space, writes)
        server.iserver.attribute_service = writes
        await server.load_certificate(identity.certificate, "der")
        await server.load_private_key(identity.key, format="pem")
        try:
            await server.start()
        except OSError as error:
            raise UsageError(
                f"opcua: cannot listen on {wanted.address}:{self._port}: {error.strerror or error}",
                hint="Choose another port (--doors opcua=0 takes a free one); another server may have this one.",
            ) from None
        assert server.bserver is not None
        self._port = server.bserver.port
        self._tasks = [asyncio.create_task(self._follow()), asyncio.create_task(self._tell_time(server))]

    async def close(self) -> None:
        """Stop listening and end every connection."""
        for task in self._tasks:
            task.cancel()
        if self._server is not None:
            listener = self._server.bserver
            for client in [] if listener is None else list(listener.clients):
                if client.transport is not None:
                    client.transport.abort()
            if listener is not None:
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(listener.stop(), _END_S)
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(self._server.iserver.stop(), _END_S)

    # ------------------------------------------------------------------ making

    def _take_over(self, server: Server) -> None:
        """Put the door's own parts in place of the library's."""
        inner = server.iserver
        inner.subscription_service = Subscriptions(inner, self._refresh, self._subscribed.set)
        inner.isession = InternalSession(
            inner, inner.aspace, inner.subscription_service, "Internal", user=inner.isession.user
        )
        server.nodes = type(server.nodes)(inner.isession)
        server.disable_clock()
        server.limits.max_recv_buffer = server.limits.max_send_buffer = CHUNK_BYTES
        server.limits.max_chunk_count = MOST_CHUNKS
        server.limits.max_message_size = MESSAGE_BYTES
        local = _is_local(self._wanted.address)
        server.set_security_policy(
            [*([_POLICY.NoSecurity] if local else []),
             _POLICY.Basic256Sha256_SignAndEncrypt, _POLICY.Basic256Sha256_Sign]
        )  # fmt: skip
        server.set_identity_tokens(_TOKENS[local and self._wanted.token is None])
        inner.treat, inner.before = self._treat, self._refresh
        inner.callback_service.addListener(CallbackType.PreRead, self._before_read)

    async def _name(self, server: Server) -> None:
        server.set_server_name("polycnc")
        server.set_endpoint(self.said)
        server.application_type = ua.ApplicationType.Server
        server.product_uri = "urn:polycnc"
        await server.set_application_uri(application_uri())
        built = datetime(2026, 1, 1, tzinfo=UTC)
        await server.set_build_info("urn:polycnc", "polycnc", "polycnc", __version__, "0", built)

    async def _add(self, machine: ServedMachine, space: Space, writes: Writes) -> None:
        assert self._server is not None
        assert machine.control is not None
        name = machine.name
        state_space = space.index[MACHINE_TOOL]
        nodes: dict[str, Any] = {
            f"channel {number}": ua.NodeId(f"{name}/{channel_path(number)}", space.own)
            for number in range(len(machine.control.channels))
        }
        nodes |= {
            f"{machine_name} {word}": ua.NodeId(number, state_space)
            for machine_name, of in (("program", tool.PRODUCTION_STATE), ("job", tool.JOB_STATE))
            for word, number in zip(PRODUCTION_STATES, tool.STATE_NODES[of], strict=True)
        }
        place = f"Machines/{name}"
        nodes |= {"job": space.at(place, JOB), "none": ua.NodeId()}
        fixed = Fixed.of(name, machine.control, nodes)
        folder = ua.NodeId(tool.MACHINES_NUMBER, space.index[MACHINERY])
        bound = space.add_items(name, ua.NodeId(_OBJECTS), name, interface_items(fixed), fixed)
        bound += space.add_items(place, folder, name, machine_tool_items(fixed), fixed)
        interface, messages = ua.NodeId(name, space.own), ua.NodeId(f"{place}/{MESSAGES}", space.own)
        for node in (interface, messages):
            space.let_emit(node)
        server = self._server
        kinds = [
            (
                await _event(server, space.node_of(cnc.ALARM)),
                "AlarmIdentifier",
                (interface, ua.NodeId(_SERVER)),
            ),
            (await _event(server, space.node_of(tool.ALERT)), "ErrorCode", (messages,)),
        ]
        alarms = AlarmEvents(server.iserver.subscription_service, kinds, name, interface)
        changes = await _event(server, ua.NodeId(ua.ObjectIds.GeneralModelChangeEventType))
        lists = Lists(space, place, fixed, changes, server.iserver.subscription_service.trigger_event)
        publisher = Publisher(machine, fixed, bound, server.iserver.aspace, space.index, lists, alarms)
        for each in bound:
            if each.member.write is not None:
                writes.add(publisher, each)
        await publisher.begin()
        self._publishers.append(publisher)

    # ------------------------------------------------------------------ serving

    async def _refresh(self) -> None:
        for publisher in self._publishers:
            with contextlib.suppress(PolycncError):
                await publisher.refresh()

    async def _treat(self) -> Treatment:
        return treatment_of(self._machines, "opcua")

    async def _before_read(self, event: Any, _: Any) -> None:
        if event.is_external:
            await self._refresh()

    async def _follow(self) -> None:
        """Write what changes for as long as somebody has subscribed, as often as the fastest of them wants it."""
        assert self._server is not None
        subscriptions: Any = self._server.iserver.subscription_service
        while True:
            await self._subscribed.wait()
            await self._refresh()
            if not subscriptions.subscriptions:
                self._subscribed.clear()
                continue
            await asyncio.sleep(min(subscriptions.shortest_s(), 1.0))

    @staticmethod
    async def _tell_time(server: Server) -> None:
        inner = server.iserver
        while True:
            now = datetime.now(UTC)
            status = await inner.server_status_node.read_value()
            status.CurrentTime = now
            await inner.server_status_node.write_value(status)
            await inner.current_time_node.write_value(now)
            await asyncio.sleep(1.0)


async def _event(server: Server, node: ua.NodeId) -> Any:
    """Return an event of a type, to be filled in."""
    event = await get_event_obj_from_type_node(server.get_node(node))
    event.add_property("NodeId", None, ua.VariantType.NodeId)
    return event


def _is_local(address: str) -> bool:
    return address.startswith("127.") or address in (LOOPBACK, "localhost", "::1")
