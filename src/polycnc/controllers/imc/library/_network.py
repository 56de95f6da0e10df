"""The network that the library works in: adapters of the PC, cards on them, handles, and how time passes.

This holds the only state of the library: `attach` makes it, as loading the library into a program does.
"""

# ruff: noqa: N801  the names are the manual's

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass

from polycnc.controllers.imc.core._state import AXIS_ERROR, AXIS_RESTED
from polycnc.controllers.imc.library._attachable import CardLike
from polycnc.controllers.imc.library._codes import (
    IMC_DEVICE_NOT_FOUND,
    IMC_DEVICE_NOT_OPEN,
    IMC_INVALID_HANDLE,
    IMC_OK,
    IMC_OUT_OF_RANGE,
    IMC_STATUS,
    IMC_TIME_OUT,
    IMC_VERSION_ERROR,
    Refused,
)
from polycnc.controllers.imc.library._structs import ADAPTERS_MOST, DESCRIPTION_SIZE
from polycnc.errors import UsageError
from polycnc.machine import Poll, Step, Way

IDS = 64
"""Ruling: ids that the switch on a card can show, 0 to 63."""

VERSION = 320
"""The library's version, 3.20. Ruling: it works with cards whose firmware has the same first digit."""

PASSWORD_LEAST, PASSWORD_MOST = 4, 99
DEFAULT_TIMEOUT_MS = 40


@dataclass(frozen=True, slots=True)
class NetCard:
    """A network adapter of the PC; some, above all wireless ones, have no promiscuous mode."""

    description: str = "Virtual Ethernet adapter"
    promiscuous: bool = True


@dataclass(slots=True, eq=False)
class Port:
    """A card on a network adapter.

    `id` is what the switch on the card shows. The rest is for trying what a program makes of a bad line: `reply_ms` is
    how long the card takes to answer, `connected` False unplugs it, and `fault` is a status that calls return instead
    of reaching it.
    """

    card: CardLike
    id: int
    adapter: int = 0
    reply_ms: float = 1.0
    connected: bool = True
    fault: IMC_STATUS = IMC_OK


class IMC_HANDLE:
    """An open card; a program only passes it on."""

    __slots__ = ("_closed", "_library", "_port", "_timeout_ms")

    def __init__(self, library: Library, port: Port, timeout_ms: int) -> None:
        self._library = library
        self._port = port
        self._timeout_ms = timeout_ms
        self._closed = False

    def __repr__(self) -> str:
        state = "closed" if self._closed else "open"
        return f"<IMC_HANDLE of card {self._port.id} on adapter {self._port.adapter}, {state}>"

    @property
    def axis_count(self) -> int:
        """Return how many axes the card has, as the library learnt when it opened it."""
        return self._port.card.axes

    def reach(self) -> CardLike:
        """Return the card, over the network.

        Raises:
            Refused: It does not answer.
        """
        _try_line(self._port, self._timeout_ms)
        return self._port.card

    def reach_later(self) -> CardLike:
        """Return the card after the time that a status call of a polling program lets pass."""
        card = self.reach()
        self._library.let_time_pass(card)
        return card

    def let_cycle_pass(self) -> None:
        """Let the card carry out what is to be done at once."""
        self._library.let_cycle_pass()


def _try_line(port: Port, timeout_ms: float) -> None:
    if port.fault != IMC_OK:
        raise Refused(port.fault)
    if not port.connected or port.reply_ms > timeout_ms:
        raise Refused(IMC_TIME_OUT)


class Library:
    """The library in one program."""

    def __init__(self, ports: Sequence[Port], adapters: Sequence[NetCard], clock: Way | None) -> None:
        self.ports = tuple(ports)
        self.adapters = tuple(adapters)
        self.clock = clock
        self.lock = threading.RLock()
        self.handles: set[IMC_HANDLE] = set()

    def open(self, netcardsel: int, imcid: int, timeout_ms: int, *, promiscuous: bool) -> Port:
        """Return the card with this id on this adapter.

        Raises:
            Refused: There is none, or it does not answer.
        """
        if not 0 <= netcardsel < ADAPTERS_MOST or not 0 <= imcid < IDS:
            raise Refused(IMC_OUT_OF_RANGE)
        deaf = netcardsel >= len(self.adapters) or (promiscuous and not self.adapters[netcardsel].promiscuous)
        for port in self.ports:
            if (port.adapter, port.id) == (netcardsel, imcid) and port.connected and not deaf:
                _try_line(port, timeout_ms)
                if port.card.config.fwversion // 100 != VERSION // 100:
                    raise Refused(IMC_VERSION_ERROR)
                return port
        raise Refused(IMC_DEVICE_NOT_FOUND)

    def add_handle(self, port: Port, timeout_ms: int) -> IMC_HANDLE:
        """Return a new handle of a card."""
        handle = IMC_HANDLE(self, port, timeout_ms)
        self.handles.add(handle)
        return handle

    def close(self, handle: object) -> IMC_STATUS:
        """Let a handle go."""
        if not isinstance(handle, IMC_HANDLE) or handle not in self.handles:
            return IMC_INVALID_HANDLE
        self.handles.remove(handle)
        handle._closed = True
        return IMC_OK

    def check(self, handle: object) -> None:
        """Make sure that this is the handle of an open card.

        Raises:
            Refused: It is not.
        """
        if isinstance(handle, IMC_HANDLE) and handle in self.handles:
            return
        closed = isinstance(handle, IMC_HANDLE) and handle._closed
        raise Refused(IMC_DEVICE_NOT_OPEN if closed else IMC_INVALID_HANDLE)

    def let_time_pass(self, card: CardLike) -> None:
        """Do what a status call does to the time of a card, and keep the other cards in step with it."""
        if self.clock is None:
            return
        done = self.clock.run(card, until=AXIS_RESTED | AXIS_ERROR)
        for port in self.ports:
            if port.card is not card:
                Step(done).run(port.card)

    def let_cycle_pass(self) -> None:
        """Let one control cycle pass, the time of a call that a card answers at once."""
        if self.clock is not None:
            for port in self.ports:
                port.card.advance(1)


_library = Library((), (NetCard(),), None)


def library() -> Library:
    """Return the library as `attach` made it."""
    return _library


def attach(
    *cards: CardLike | Port,
    clock: Way | None = Poll(1),  # noqa: B008  immutable
    adapters: Sequence[NetCard | str] = (NetCard(),),
) -> tuple[Port, ...]:
    """Put cards on the network and load the library anew; return where they are.

    A card without a `Port` gets the first free id on adapter 0. `clock` says what a call that reads from a card, or is
    told that a queue is full, does to the time of the cards: `Poll(1)` lets one control cycle pass, `Poll(1000)` the
    time until something happens on an axis but at most 1000 cycles. An instruction for IFIFO takes one cycle. With
    `None` no call takes time: only `Card.advance` lets it pass, and IFIFO waits for that too.

    Raises:
        UsageError: Two cards are in the same place, or one on an adapter that is not there.
    """
    global _library
    nets = [each if isinstance(each, NetCard) else NetCard(each) for each in adapters]
    if len(nets) > ADAPTERS_MOST or any(len(net.description) >= DESCRIPTION_SIZE for net in nets):
        raise UsageError(
            f"{len(nets)} network adapters, or one with a long description",
            hint=f"the library knows {ADAPTERS_MOST}, with {DESCRIPTION_SIZE - 1} characters each",
        )
    ports: list[Port] = [each for each in cards if isinstance(each, Port)]
    taken = {(port.adapter, port.id) for port in ports}
    if len(taken) < len(ports):
        raise UsageError("two cards have the same adapter and id", hint="set another id on one of them")
    placed: list[Port] = []
    for each in cards:
        port = each if isinstance(each, Port) else Port(each, _free_id(taken))
        taken.add((port.adapter, port.id))
        _check_place(port, len(nets))
        placed.append(port)
    _library = Library(placed, nets, clock)
    return tuple(placed)


def detach() -> None:
    """Take all cards off the network."""
    attach(clock=None)


def is_password(text: str) -> bool:
    """Tell whether a card can be given this password."""
    return text.isascii() and PASSWORD_LEAST <= len(text) <= PASSWORD_MOST


def _free_id(taken: set[tuple[int, int]]) -> int:
    return next(number for number in range(IDS + 1) if (0, number) not in taken)


def _check_place(port: Port, adapters: int) -> None:
    if not 0 <= port.id < IDS or not 0 <= port.adapter < adapters:
        raise UsageError(
            f"there is no place for card {port.id} on adapter {port.adapter}",
            hint=f"ids are 0 to {IDS - 1}, adapters 0 to {adapters - 1}",
        )
