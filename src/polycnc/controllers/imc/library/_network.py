"""The network that the library works in: adapters of the PC, cards on them, handles, and how time passes.

A session is one program with the library loaded; `attach` loads it anew. The functions of the module share one.
"""

# ruff: noqa: N801  the names are the manual's

from __future__ import annotations

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
)
from polycnc.controllers.imc.library._declared import ADAPTERS_MOST, DESCRIPTION_SIZE
from polycnc.controllers.library import Refused
from polycnc.controllers.library import Session as AnySession
from polycnc.errors import UsageError
from polycnc.machine import Poll, Polling, Step, Way

IDS = 64
"""Ruling: ids that the switch on a card can show, 0 to 63."""

VERSION = 320
"""The library's version, 3.20. Ruling: it works with cards whose firmware has the same first digit."""

PASSWORD_LEAST, PASSWORD_MOST = 4, 99
DEFAULT_TIMEOUT_MS = 40
EVENTS = AXIS_RESTED | AXIS_ERROR


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

    __slots__ = ("_closed", "_port", "_session", "_timeout_ms")

    def __init__(self, session: Session, port: Port, timeout_ms: int) -> None:
        self._session = session
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
        self._session.let_time_pass(card)
        return card

    @property
    def card(self) -> CardLike:
        """Return the card itself, whatever the network does."""
        return self._port.card

    @property
    def session(self) -> Session:
        """Return whose handle it is."""
        return self._session


def _try_line(port: Port, timeout_ms: float) -> None:
    if port.fault != IMC_OK:
        raise Refused(port.fault)
    if not port.connected or port.reply_ms > timeout_ms:
        raise Refused(IMC_TIME_OUT)


class Session(AnySession):
    """A program that has loaded the library: its network, its handles, its time."""

    def __init__(self) -> None:
        super().__init__()
        self.ports: tuple[Port, ...] = ()
        self.adapters: tuple[NetCard, ...] = (NetCard(),)
        self.polling = Polling(None, self._cards)
        self._sent: dict[CardLike, int] = {}  # in which cycle
        self.handles: set[IMC_HANDLE] = set()

    def attach(
        self,
        *cards: CardLike | Port,
        clock: Way | None = Poll(1),  # noqa: B008  immutable
        adapters: Sequence[NetCard | str] = (NetCard(),),
    ) -> tuple[Port, ...]:
        """Put cards on the network and load the library anew; return where they are.

        A card without a `Port` gets the first free id on adapter 0. `clock` says what a call that reads the same as
        another one in this cycle, or is told that a queue is full, does to the time of the cards: `Poll(1)` lets one
        control cycle pass, `Poll(1000)` the time until something happens on an axis but at most 1000 cycles. An
        instruction for IFIFO takes one cycle. With `Elapsed` a call lets the time pass that has passed for the program.
        With `None` no call takes time: only `Card.advance` lets it pass, and IFIFO waits for that too.

        Raises:
            UsageError: Two cards are in the same place, or one on an adapter that is not there.
        """
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
        with self.lock:
            self.ports, self.adapters = tuple(placed), tuple(nets)
            self.polling = Polling(clock, self._cards)
            self.handles.clear()
            self._sent.clear()
        return tuple(placed)

    def detach(self) -> None:
        """Take all cards off the network."""
        self.attach(clock=None)

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

    def find(self, handle: IMC_HANDLE) -> IMC_HANDLE:
        """Return a handle of an open card.

        Raises:
            Refused: It is none.
        """
        if isinstance(handle, IMC_HANDLE) and handle in self.handles:
            self.polling.call(handle.card)
            return handle
        closed = isinstance(handle, IMC_HANDLE) and handle._closed
        raise Refused(IMC_DEVICE_NOT_OPEN if closed else IMC_INVALID_HANDLE)

    def close(self, handle: object) -> IMC_STATUS:
        """Let a handle go."""
        if not isinstance(handle, IMC_HANDLE) or handle not in self.handles:
            return IMC_INVALID_HANDLE
        self.handles.remove(handle)
        handle._closed = True
        return IMC_OK

    def let_time_pass(self, card: CardLike) -> None:
        """Do what a call that reads does to the time of a card, and keep the other cards in step with it.

        What has been sent in this cycle is taken first, or a program that waits for it would not even see it begin.
        """
        if self._sent.pop(card, -1) == card.clock.cycles:
            self.polling.let_pass(card, until=EVENTS)
        self.polling.read(card, self.asked, until=EVENTS)

    def note_sent(self, card: CardLike) -> None:
        """Note that an instruction waits for the next cycle of a card."""
        self._sent[card] = card.clock.cycles

    def let_queue_run(self, card: CardLike) -> None:
        """Do what finding a queue full does to the time of a card."""
        self.polling.let_pass(card, until=EVENTS)

    def let_cycle_pass(self, card: CardLike) -> None:
        """Let one control cycle pass, the time of a call that a card answers at once."""
        self.polling.let_pass(card, Step(1))

    def _cards(self) -> list[CardLike]:
        return [port.card for port in self.ports]


def is_password(text: str | bytes) -> bool:
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
