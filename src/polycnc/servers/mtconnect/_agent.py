"""The agent without sockets: devices and what was observed of them, requests to documents."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from polycnc.servers.mtconnect._assets import CUTTING_TOOL, MOST_ASSETS, Asset
from polycnc.servers.mtconnect._device import DeviceModel, Item
from polycnc.servers.mtconnect._documents import (
    Header,
    StreamWriter,
    assets_document,
    devices_document,
    error_document,
)
from polycnc.servers.mtconnect._errors import AgentError, Code
from polycnc.servers.mtconnect._observations import Buffer
from polycnc.servers.mtconnect._query import MOST_INTERVAL_MS, Asked, asked_of
from polycnc.servers.mtconnect._recorder import Recorder, time_text
from polycnc.servers.mtconnect._rows import Version
from polycnc.servers.mtconnect._xpath import Node, PathError, choose, tree_of
from polycnc.servers.plant import Seen

BUFFER_SIZE = 1 << 16
_USUAL_COUNT = 100
_USUAL_HEARTBEAT_MS = 10_000
_MOST_CHOSEN = 256  # paths whose items are remembered


@dataclass(frozen=True, slots=True)
class Answer:
    """An answer: its HTTP status, and its document."""

    status: int
    document: bytes


@dataclass(frozen=True, slots=True)
class StreamAsked:
    """A stream that is asked for: how often something is sent, and after how long without anything, in s.

    `next` returns a document and the number to go on with; None in place of a document: nothing new. `first` is the
    number to begin with.
    """

    interval_s: float
    heartbeat_s: float
    first: int
    next: Callable[[int, bool], tuple[bytes | None, int]]


class Agent:
    """Answer for devices of one version; `instance` tells this run of the agent from others.

    What is observed is given to `observe`. The time in headers is that of the machine that was observed last.
    """

    def __init__(
        self, devices: Sequence[DeviceModel], version: Version, instance: int, *, size: int = BUFFER_SIZE
    ) -> None:
        self.devices = tuple(devices)
        self._numbers = {name: k for k, device in enumerate(devices) for name in (device.uuid, device.name)}
        self.buffer = Buffer(size)
        self._recorders = [Recorder(device) for device in devices]
        self._version = version
        self._instance = instance
        self._since = self._now = "1970-01-01T00:00:00.000Z"
        self._writer = StreamWriter(self.devices, version)
        self._chosen: dict[tuple[str, str], frozenset[Item]] = {}
        self._trees: dict[tuple[int, ...], Node] = {}
        self._all = frozenset(item for device in devices for item in device.items)

    def observe(self, number: int, seen: Seen) -> None:
        """Take over what has changed in a device (by its number, from 0)."""
        looked = self._recorders[number].look(seen)
        self._now = time_text(seen.status)
        if self.buffer.next == 1:
            self._since = looked.time
        for change in looked.changes:
            self.buffer.add(change.item, looked.time, *change[1:])

    def numbers(self, asked: Asked) -> list[int]:
        """Return the numbers of the devices that a request is about.

        Raises:
            AgentError: There is no such device.
        """
        if asked.text("deviceType") not in (None, "Device"):
            raise AgentError(Code.NO_DEVICE, "there are devices of the type Device only")
        if not asked.device:
            return list(range(len(self.devices)))
        found = self._numbers.get(asked.device)
        if found is None:
            raise AgentError(
                Code.NO_DEVICE, f"there is no device {asked.device[:64]}", hint="See /probe for their names."
            )
        return [found]

    def answer(self, asked: Asked) -> Answer | StreamAsked:
        """Return what is asked; errors as a document are made by `refusal`.

        Raises:
            AgentError: It cannot be answered.
        """
        match asked.request:
            case "probe":
                devices = [self.devices[number] for number in self.numbers(asked)]
                return Answer(200, devices_document(devices, self._header()))
            case "current":
                return self._current(asked)
            case "sample":
                return self._sample(asked)
            case _:
                return Answer(200, assets_document(self._assets(asked), self._header()))

    def refusal(self, error: AgentError, uri: str) -> Answer:
        """Return the answer to a request that cannot be carried out."""
        return Answer(error.code.status, error_document(error, self._header(), uri))

    def get(self, path: str, query: bytes = b"") -> Answer | StreamAsked:
        """Return the answer to a request, a refusal too."""
        try:
            return self.answer(asked_of(path, query))
        except AgentError as error:
            return self.refusal(error, path)

    # ------------------------------------------------------------------ streams

    def _header(self) -> Header:
        count = sum(recorder.assets.count for recorder in self._recorders)
        size = MOST_ASSETS * max(1, len(self.devices))
        return Header(self._version, self._instance, self._now, self._since, self.buffer.size, size, count)

    def _wanted(self, asked: Asked) -> frozenset[Item]:
        """Return the data items of a request."""
        numbers, path = self.numbers(asked), asked.text("path")
        if path is None and not asked.device:
            return self._all
        key = asked.device, path if path is not None else ""
        if key not in self._chosen:
            if path is None:
                found = frozenset(item for number in numbers for item in self.devices[number].items)
            else:
                try:
                    found = choose(path, self._tree(numbers))
                except PathError as error:
                    raise AgentError(Code.INVALID_XPATH, error.what, hint=error.hint) from None
            if len(self._chosen) >= _MOST_CHOSEN:
                self._chosen.clear()
            self._chosen[key] = found
        return self._chosen[key]

    def _tree(self, numbers: list[int]) -> Node:
        """Return the description of devices as paths go through it: of all, or of one."""
        key = tuple(numbers)
        if key not in self._trees:
            self._trees[key] = tree_of([self.devices[number] for number in numbers])
        return self._trees[key]

    def _current(self, asked: Asked) -> Answer | StreamAsked:
        wanted = self._wanted(asked)
        at = asked.number("at", self.buffer.first, self.buffer.last)
        interval = asked.number("interval", 0, MOST_INTERVAL_MS)
        if interval is None:
            return Answer(200, self._current_document(wanted, at))
        if at is not None:
            raise AgentError(
                Code.INVALID_REQUEST, "at and interval cannot be asked at once", hint="Leave one out."
            )
        every_s = interval / 1000
        return StreamAsked(
            every_s, every_s, 0, lambda _, __: (self._current_document(wanted, None), 0)
        )  # fmt: skip

    def _current_document(self, wanted: frozenset[Item], at: int | None) -> bytes:
        state = self.buffer.now() if at is None else self.buffer.at(at)
        return self._document(self._writer.current(state, wanted), self.buffer.next)

    def _document(self, streams: Iterator[str], following: int) -> bytes:
        return self._writer.document(streams, self._header(), self.buffer.first, self.buffer.last, following)

    def _sample(self, asked: Asked) -> Answer | StreamAsked:
        wanted = self._wanted(asked)
        size = self.buffer.size
        start = asked.number("from", self.buffer.first, self.buffer.next)
        end = asked.number("to", start or self.buffer.first, self.buffer.next)
        count = asked.number("count", 1 if end is not None else -size, size)
        if count == 0:
            raise AgentError(
                Code.OUT_OF_RANGE, "count is 0", hint="Give another.", parameter="count", value="0", limits=(1, size)
            )  # fmt: skip
        count = _USUAL_COUNT if count is None else count
        interval = asked.number("interval", 0, MOST_INTERVAL_MS)
        heartbeat = asked.number("heartbeat", 1, MOST_INTERVAL_MS) or _USUAL_HEARTBEAT_MS
        if interval is None:
            return Answer(200, self._sample_document(wanted, start, count, end)[0])
        if count < 0 or end is not None:
            raise AgentError(
                Code.INVALID_REQUEST, "a stream goes up and has no end", hint="Leave count or interval out."
            )

        def following(number: int, empty: bool) -> tuple[bytes | None, int]:
            if number < self.buffer.first:
                raise AgentError(
                    Code.OUT_OF_RANGE, "the client reads too slowly", hint="Ask for less.", parameter="from",
                    value=str(number), limits=(self.buffer.first, self.buffer.next),
                )  # fmt: skip
            document, after, some = self._sample_document(wanted, number, count, None)
            return (document if some or empty else None), after

        first = self.buffer.first if start is None else start
        return StreamAsked(interval / 1000, heartbeat / 1000, first, following)

    def _sample_document(
        self, wanted: frozenset[Item], start: int | None, count: int, end: int | None
    ) -> tuple[bytes, int, bool]:
        seen, following = self.buffer.sample(start, count, wanted.__contains__)
        if end is not None:
            seen = [each for each in seen if each.sequence <= end]
            following = min(following, end + 1)
        return self._document(self._writer.sample(seen), following), following, bool(seen)

    # ------------------------------------------------------------------ assets

    def _assets(self, asked: Asked) -> list[Asset]:
        numbers = self.numbers(asked)
        if asked.ids:
            return [self._asset(name) for name in asked.ids]
        count = asked.number("count", 1, MOST_ASSETS * max(1, len(self.devices))) or _USUAL_COUNT
        removed = asked.text("removed") or "false"
        if removed not in ("true", "false"):
            raise AgentError(
                Code.QUERY_ERROR, f"removed is neither true nor false: {removed[:40]}", parameter="removed"
            )
        if asked.text("type") not in (None, CUTTING_TOOL):
            return []
        found = [
            each
            for number in numbers
            for each in self._recorders[number].assets.all(removed=removed == "true")
        ]
        return found[:count]

    def _asset(self, name: str) -> Asset:
        for recorder in self._recorders:
            if (found := recorder.assets.find(name)) is not None:
                return found
        raise AgentError(
            Code.ASSET_NOT_FOUND,
            f"there is no asset {name[:64]}",
            hint="See /assets.",
            asset=name[:64] or "-",
        )
