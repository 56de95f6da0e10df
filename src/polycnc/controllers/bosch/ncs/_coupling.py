"""MCODS and MCOPS of a channel: calls of its part programs as requests to a control (Manual 003, 4.14)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Protocol

from polycnc.controllers.bosch.ncs._buffers import check_buffer, fill, integer, known_version, parameters
from polycnc.controllers.bosch.ncs._codes import NcsCode, NcsError
from polycnc.controllers.bosch.ncs._data_services import DATA_SERVICES, DataService
from polycnc.controllers.bosch.ncs._image import Image, Wait
from polycnc.controllers.bosch.ncs._process_services import (
    PROCESS_SERVICES,
    WHOLE_SYSTEM,
    ProcessService,
    ProcessServices,
)
from polycnc.controllers.bosch.ncs._versions import Key, Ledger
from polycnc.nc.cpl import BLOCKED, OMITTED, Box, Fault

MAGIC = 0x4E4353


class Control(ProcessServices, Protocol):
    """A control that can be asked: it shows an image, and does what process services say."""

    @property
    def image(self) -> Image:
        """What it shows."""


@dataclass(slots=True)
class NcsServer:
    """The interface of a control to its clients: versions of its data, and the state of the connection."""

    control: Control
    magic: int = MAGIC
    connected: bool = True
    ledger: Ledger = field(default_factory=Ledger)
    orders: list[Iterator[None]] = field(default_factory=list)
    """What is carried out after the cycle: it ends the program that has asked for it."""

    def check(self, magic: int) -> None:
        """Make sure that a message can be received.

        Raises:
            NcsError: It cannot.
        """
        if not self.connected:
            raise NcsError(NcsCode.DISRUPTED)
        if magic != self.magic:
            raise NcsError(NcsCode.BAD_MAGIC)

    @property
    def is_awake(self) -> bool:
        """Whether there is anything to note: data were asked for that can change and change back."""
        return self.ledger.is_used or bool(self.orders)

    def look(self) -> None:
        """Note what changed; once in every cycle of the control, so that nothing is missed between two calls."""
        orders, self.orders = self.orders, []
        for order in orders:
            with suppress(StopIteration, NcsError):  # nobody is left to tell
                next(order)
                self.orders.append(order)
        if self.ledger.is_used:
            self.ledger.look(self.control.image)


class Coupling:
    """What MCODS and MCOPS of one channel do; its methods are the functions of that channel's Host.

    Args:
        server: The control that is asked.
        home: The image of the control that the channel belongs to, to show that it waits; None: nowhere.
        channel: The calling channel's number.
        magic: What its messages begin with.
    """

    def __init__(
        self, server: NcsServer, home: Image | None = None, channel: int = 1, *, magic: int = MAGIC
    ) -> None:
        self._server = server
        self._home = home
        self._channel = channel
        self._magic = magic
        self._under_way: tuple[tuple[object, ...], Iterator[None]] | None = None

    @property
    def is_waiting(self) -> bool:
        """Whether an order of the program has not been answered."""
        return self._under_way is not None

    def mcods(self, *arguments: object) -> object:
        """Read data of the control into a variable; return the answer's code, or BLOCKED until data are new.

        Raises:
            Fault: An argument has the wrong type, or the buffer is too small.
        """
        self._waits(False)
        number, channel = integer(arguments[0], "type"), integer(arguments[1], "channel")
        version, buffer = arguments[2], arguments[3]
        size = integer(arguments[4], "size")
        extra = tuple(None if each is OMITTED else integer(each, "parameter") for each in arguments[5:])
        known = known_version(version)
        try:
            self._server.check(self._magic)
            service = DATA_SERVICES.get(number)
            if service is None:
                raise NcsError(NcsCode.NOT_AVAILABLE)
            image = self._server.control.image
            values, new = self._server.ledger.read(image, _key(service, channel, extra, image))
        except NcsError as refused:
            return int(refused.code)
        check_buffer(service, values, buffer, size)
        if service.versioned and service.refresh != "I" and known == new:
            self._waits(True)
            return BLOCKED
        fill(service, values, buffer, size)
        assert isinstance(version, Box)
        version.value = new
        return int(NcsCode.DONE)

    def mcops(self, *arguments: object) -> object:
        """Have the control do something; return the answer's code, or BLOCKED while there is none.

        Raises:
            Fault: An argument has the wrong type.
        """
        if arguments[-1] is OMITTED:
            raise Fault("INVALID PARAMETER", "there is no comma before the closing bracket")
        if self._under_way is not None and self._under_way[0] == arguments:
            work = self._under_way[1]
        else:
            self.release()
            number, channel = integer(arguments[0], "function"), integer(arguments[1], "channel")
            service = PROCESS_SERVICES.get(number)
            try:
                self._server.check(self._magic)
                if service is None:
                    raise NcsError(NcsCode.NOT_AVAILABLE)
                values = parameters(arguments[2:], service.parameters)
                begun = service.do(self._server.control, self, channel, *values)
            except NcsError as refused:
                return int(refused.code)
            if begun is None:
                return int(NcsCode.DONE)
            if self._ends_by(service, channel, values):
                self._server.orders.append(begun)
                begun = _never()
            work = begun
        try:
            self._server.check(self._magic)
            next(work)
        except StopIteration:
            self._under_way = None
            return int(NcsCode.DONE)
        except NcsError as refused:
            self._under_way = None
            return int(refused.code)
        self._under_way = (arguments, work)
        return BLOCKED

    def release(self) -> None:
        """Give up what is waited for: the program was stopped."""
        self._under_way = None
        self._waits(False)

    def _ends_by(self, service: ProcessService, channel: int, values: list[int | str]) -> bool:
        """Tell whether a service ends the program that asks for it."""
        own = channel in (self._channel, WHOLE_SYSTEM) and self._server.control.image is self._home
        return own and service.ends(values)

    def _waits(self, on: bool) -> None:
        shown = None if self._home is None else self._home.channels.get(self._channel)
        if shown is not None:
            shown.other_waits = (
                shown.other_waits | Wait.DATA_SERVICE if on else shown.other_waits & ~Wait.DATA_SERVICE
            )


def _never() -> Iterator[None]:
    while True:
        yield


def _key(service: DataService, channel: int, extra: tuple[int | None, ...], image: Image) -> Key:
    if channel not in image.channels and channel not in {"system": (-1, 0), "either": (-1,)}.get(
        service.scope, ()
    ):
        raise NcsError(NcsCode.NO_CHANNEL)
    return service.number, -1 if service.scope == "system" else channel, extra
