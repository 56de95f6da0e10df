"""A server with the base address space, which can be given up while it is being filled, and with bounds."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

from asyncua import ua
from asyncua.crypto.permission_rules import User, UserRole
from asyncua.server.history import HistoryManager
from asyncua.server.internal_server import InternalServer
from asyncua.server.internal_session import InternalSession
from asyncua.server.standard_address_space import standard_address_space

from polycnc.servers.machines import AS_USUAL, Treatment

_ANYBODY = User(role=UserRole.Anonymous)


class _GivenUpError(Exception):
    """The filling of the address space was given up."""


class _GivingUp:
    """Pass nodes on until it is given up."""

    def __init__(self, service: Any) -> None:
        self._service = service
        self.given_up = False

    def __getattr__(self, name: str) -> Any:
        if self.given_up:
            raise _GivenUpError
        return getattr(self._service, name)


async def _as_usual() -> Treatment:
    return AS_USUAL


async def _nothing() -> None:
    return


class _Session(InternalSession):
    """The session of a client, which sees the objects that there are now."""

    iserver: BoundedServer

    async def browse(self, params: ua.BrowseParameters) -> list[ua.BrowseResult]:
        await self.iserver.before()
        found: list[ua.BrowseResult] = await super().browse(params)
        return found

    async def translate_browsepaths_to_nodeids(
        self, params: list[ua.BrowsePath]
    ) -> list[ua.BrowsePathResult]:
        await self.iserver.before()
        found: list[ua.BrowsePathResult] = await super().translate_browsepaths_to_nodeids(params)
        return found


class BoundedServer(InternalServer):
    """What a server holds, with bounds for what clients may ask for.

    `treat` says what happens to a request, `before` is done before one that asks which objects there are.
    """

    treat: Callable[[], Awaitable[Treatment]] = staticmethod(_as_usual)
    before: Callable[[], Awaitable[None]] = staticmethod(_nothing)

    def create_session(self, name: str, user: User = _ANYBODY, external: bool = False) -> InternalSession:
        """Return a session for a client."""
        return _Session(self, self.aspace, self.subscription_service, name, user=user, external=external)

    async def load_standard_address_space(self, shelf_file: Any = None) -> None:
        """Fill the address space in a thread; a cancelled one ends within milliseconds, not seconds."""
        service = _GivingUp(self.node_mgt_service)
        try:
            await asyncio.to_thread(standard_address_space.fill_address_space, service)
        except asyncio.CancelledError:
            service.given_up = True
            raise


class NoHistory(HistoryManager):
    """No node has a history, which is said to whoever reads one."""

    async def read_history(self, params: ua.HistoryReadParameters) -> list[ua.HistoryReadResult]:
        """Refuse."""
        refused = ua.StatusCode(ua.StatusCodes.BadHistoryOperationUnsupported)
        return [ua.HistoryReadResult(StatusCode=refused) for _ in params.NodesToRead]


def bounded_server(user_manager: Any) -> BoundedServer:
    """Return what a server holds, bounded."""
    made = BoundedServer(user_manager=user_manager)
    made.history_manager = NoHistory(made)
    made.bind_condition_methods = 1  # the severity of the events that begin and end a refresh
    made.max_connections = 100
    made.max_subscriptions = 1000
    made.max_unacked_messages_per_subscription = 100
    made.max_monitored_item_queue_size = 100
    made.max_pending_messages_per_connection = 100
    made.max_pending_activation_seconds = 10.0
    made.max_session_timeout_ms = 600_000.0
    made.match_discovery_source_ip = True
    made.supported_tokens = (ua.AnonymousIdentityToken, ua.UserNameIdentityToken)
    return made
