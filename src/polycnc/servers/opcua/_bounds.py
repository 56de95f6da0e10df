"""Bounds for what clients send and ask for: chunks, connections that do not read, subscriptions, monitored items."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

from asyncua import ua
from asyncua.common.utils import Buffer, NotEnoughData
from asyncua.server.binary_server_asyncio import BinaryServer, OPCUAProtocol
from asyncua.server.internal_server import InternalServer
from asyncua.server.monitored_item_service import MonitoredItemService
from asyncua.server.subscription_service import SubscriptionService
from asyncua.ua.ua_binary import header_from_binary

CHUNK_BYTES = 65_536
MOST_CHUNKS = 32
MESSAGE_BYTES = 1 << 20
MOST_ITEMS = 20_000
LEAST_INTERVAL_MS, MOST_INTERVAL_MS = 50.0, 60_000.0
_MOST_UNREAD_BYTES = 4 << 20
_MOST_QUEUE = 100


class Connection(OPCUAProtocol):
    """One connection; one that sends too large a chunk, or does not read what it asked for, is closed."""

    _buffer: bytes

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take a client; where there are too many, the oldest without a session makes room."""
        if len(self.clients) >= self.iserver.max_connections:
            idle = next((each for each in self.clients if not _has_session(each)), None)
            if idle is not None:
                self.clients.remove(idle)
                idle.transport.abort()
        super().connection_made(transport)

    def data_received(self, data: bytes) -> None:
        """Take bytes of the client."""
        transport = self.transport
        if transport is None:
            return
        if transport.get_write_buffer_size() > _MOST_UNREAD_BYTES or not _is_bounded(self._buffer + data):
            self._buffer = b""
            transport.abort()
            return
        super().data_received(data)

    async def _process_one_msg(self, header: Any, buf: Buffer) -> bool:
        """Answer a message, unless a scenario wants something else."""
        if header.MessageType == ua.MessageType.SecureMessage and header.ChunkType == ua.ChunkType.Single:
            treatment = await self.iserver.treat()
            if treatment.drop:
                if self.transport is not None:
                    self.transport.abort()
                return False
            if treatment.delay_s:
                await asyncio.sleep(treatment.delay_s)
        answered: bool = await super()._process_one_msg(header, buf)
        return answered


def _has_session(connection: Any) -> bool:
    processor = connection.processor
    return processor is not None and processor.session is not None and processor.session.is_activated()


def _is_bounded(data: bytes) -> bool:
    """Tell whether the chunk that `data` begins with is of a kind and size that can be meant."""
    try:
        header = header_from_binary(Buffer(data[:64]))
    except NotEnoughData:
        return True
    except Exception:
        return False
    return bool(0 < header.body_size <= CHUNK_BYTES)


class Listener(BinaryServer):
    """Listen for bounded connections."""

    def _make_protocol(self) -> Connection:
        return Connection(
            iserver=self.iserver,
            policies=self._policies,
            clients=self.clients,
            closing_tasks=self.closing_tasks,
            limits=self.limits,
        )


class _Items(MonitoredItemService):
    """The monitored items of a subscription; a notification is made with its value, not with another one first."""

    async def datachange_callback(
        self, handle: int, value: ua.DataValue, error: ua.StatusCode | None = None
    ) -> None:
        """Take a value that was written, and queue it if it is another one."""
        item = self._monitored_items[self._monitored_datachange[handle]]
        if error or item.filter:
            await super().datachange_callback(handle, value, error)
        elif item.mode != ua.MonitoringMode.Disabled:
            item.mvalue.set_current_datavalue(value)
            if self._is_data_changed(item.mvalue, ua.DataChangeTrigger.StatusValue):
                notification = ua.MonitoredItemNotification(item.client_handle, value)
                await self.isub.enqueue_datachange_event(
                    item.monitored_item_id, notification, item.queue_size
                )


class Subscriptions(SubscriptionService):
    """The subscriptions of a server; `before` is done before one is made, `made` after."""

    def __init__(
        self, server: InternalServer, before: Callable[[], Awaitable[None]], made: Callable[[], None]
    ) -> None:
        super().__init__(server.aspace, iserver=server)
        self._before = before
        self._made = made

    async def create_subscription(
        self,
        params: ua.CreateSubscriptionParameters,
        callback: Callable[..., Any],
        session_id: ua.NodeId,
        request_callback: Callable[..., Any] | None = None,
    ) -> ua.CreateSubscriptionResult:
        """Make a subscription; its interval is held to what a server can keep up with."""
        wanted = params.RequestedPublishingInterval
        params.RequestedPublishingInterval = (
            min(max(wanted, LEAST_INTERVAL_MS), MOST_INTERVAL_MS) if wanted == wanted else LEAST_INTERVAL_MS
        )
        await self._before()
        made = await super().create_subscription(params, callback, session_id, request_callback)
        subscription = self.subscriptions[made.SubscriptionId]
        subscription.monitored_item_srv = _Items(subscription, self.aspace)
        self._made()
        return made

    async def create_monitored_items(
        self, params: ua.CreateMonitoredItemsParameters
    ) -> list[ua.MonitoredItemCreateResult]:
        """Monitor items, up to as many as there may be in all."""
        there = sum(len(each.monitored_item_srv._monitored_items) for each in self.subscriptions.values())
        room = max(0, MOST_ITEMS - there)
        refused = len(params.ItemsToCreate[room:])
        params.ItemsToCreate = params.ItemsToCreate[:room]
        results = await super().create_monitored_items(params)
        full = ua.StatusCode(ua.StatusCodes.BadTooManyMonitoredItems)
        return [*results, *(ua.MonitoredItemCreateResult(StatusCode=full) for _ in range(refused))]

    def modify_monitored_items(
        self, params: ua.ModifyMonitoredItemsParameters
    ) -> list[ua.MonitoredItemModifyResult]:
        """Change items; their queues stay bounded."""
        if params.SubscriptionId in self.subscriptions:
            known = self.subscriptions[params.SubscriptionId].monitored_item_srv._monitored_items
            if any(each.MonitoredItemId not in known for each in params.ItemsToModify):
                raise ua.uaerrors.BadMonitoredItemIdInvalid
        for each in params.ItemsToModify:
            each.RequestedParameters.QueueSize = min(each.RequestedParameters.QueueSize or 1, _MOST_QUEUE)
        modified: list[ua.MonitoredItemModifyResult] = super().modify_monitored_items(params)
        return modified

    async def trigger_event(self, event: Any, subscription_id: int | None = None) -> None:
        """Send an event; one of an alarm that is on is kept for whoever asks for a refresh, for each that emits it."""
        await super().trigger_event(event, subscription_id)
        if (condition := getattr(event, "NodeId", None)) is not None:
            self._conditions.pop(condition, None)
            key: Any = (condition, event.emitting_node)
            self._conditions.pop(key, None)
            if event.Retain:
                self._conditions[key] = event

    def shortest_s(self) -> float:
        """Return the shortest interval of the subscriptions (s)."""
        intervals = [each.data.RevisedPublishingInterval for each in self.subscriptions.values()]
        return max(min(intervals, default=MOST_INTERVAL_MS), LEAST_INTERVAL_MS) / 1000.0
