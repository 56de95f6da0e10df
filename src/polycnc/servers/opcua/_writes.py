"""What clients write: it acts through the commands of the operator, or is refused with its status code."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from asyncua import ua
from asyncua.crypto.permission_rules import User, UserRole
from asyncua.server.address_space import AddressSpace, AttributeService

from polycnc.cnc import ControlError, Refusal
from polycnc.errors import PolycncError
from polycnc.servers.commands import carry_out
from polycnc.servers.machines import Log
from polycnc.servers.opcua._publish import Publisher
from polycnc.servers.opcua._space import Bound, data_of, words_of
from polycnc.servers.opcua._tree import span_of

_CODES = ua.StatusCodes


class Writes(AttributeService):
    """Read as the library does; write by commands."""

    def __init__(self, space: AddressSpace, index: Mapping[str, int], log: Log) -> None:
        super().__init__(space)
        self._space = space
        self._index = index
        self._log = log
        self._rows: dict[ua.NodeId, tuple[Publisher, Bound]] = {}

    def add(self, publisher: Publisher, bound: Bound) -> None:
        """Let a member be written."""
        self._rows[bound.node] = publisher, bound

    async def write(
        self,
        params: ua.WriteParameters,
        user: User = User(role=UserRole.Admin),  # noqa: B008
    ) -> list[ua.StatusCode]:
        """Write values one after another; each of them acts, or changes nothing."""
        if user.role is UserRole.Admin:  # the server itself; no client has this role
            written: list[ua.StatusCode] = await super().write(params, user)
            return written
        return [ua.StatusCode(await self._one(each)) for each in params.NodesToWrite]

    async def _one(self, asked: ua.WriteValue) -> int:
        if asked.NodeId not in self._space:
            return int(_CODES.BadNodeIdUnknown)
        row = self._rows.get(asked.NodeId)
        if row is None or asked.AttributeId != ua.AttributeIds.Value:
            return int(_CODES.BadNotWritable)
        if asked.IndexRange:
            return int(_CODES.BadIndexRangeInvalid)
        if asked.Value.StatusCode is not None and not asked.Value.StatusCode.is_good():
            return int(_CODES.BadWriteNotSupported)
        publisher, bound = row
        variant = asked.Value.Value
        if (
            variant is None
            or variant.VariantType is not data_of(bound.member, self._index)[0]
            or variant.is_array
        ):
            return int(_CODES.BadTypeMismatch)
        if not _in_range(bound, publisher, variant.Value):
            return int(_CODES.BadOutOfRange)
        return await self._act(publisher, bound, variant.Value)

    async def _act(self, publisher: Publisher, bound: Bound, value: Any) -> int:
        machine, write = publisher.machine, bound.member.write
        assert write is not None

        def act() -> Mapping[str, Any] | None:
            asked = write(publisher.at(bound.item.channel, bound.item.about), value)
            if asked is not None:
                carry_out(machine, asked)
            return asked

        try:
            asked = await machine.ask(act)
            self._log.write("command", machine=machine.name, door="opcua", asked=asked)
            await publisher.refresh()
        except ControlError as refused:
            out = refused.reason is Refusal.DATA
            return int(_CODES.BadOutOfRange if out else _CODES.BadInvalidState)
        except PolycncError:
            return int(_CODES.BadDeviceFailure)
        return int(_CODES.Good)


def _in_range(bound: Bound, publisher: Publisher, value: Any) -> bool:
    words = words_of(bound.member)
    if words is not None:
        return bool(0 <= value < words)
    if isinstance(value, float):
        low, high = span_of(bound.member, bound.item, publisher.fixed)
        return math.isfinite(value) and low <= value <= high
    return True
