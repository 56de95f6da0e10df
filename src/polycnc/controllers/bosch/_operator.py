"""Operate a device as MCOPS does: the services' words for what its operator does (Manual 003, 4.14.2)."""

from __future__ import annotations

from typing import Protocol

from polycnc.cnc import ControlError
from polycnc.controllers.bosch.ncs import Mode


class Operated(Protocol):
    """A control that can be operated; channels count from 1."""

    def has_program(self, name: str) -> bool: ...
    def select_program(self, name: str, *, channel: int = 1) -> None: ...
    def select_blocks(self, text: str, *, channel: int = 1) -> None: ...
    def cycle_start(self, *, channel: int = 1) -> None: ...
    def reset(self, *, channel: int | None = None) -> None: ...
    def leave_program(self, *, channel: int = 1) -> None: ...
    def search_block(self, start: str, *, channel: int = 1) -> int: ...
    def select_mode(self, mode: Mode, *, channel: int | None = None) -> None: ...


class DeviceOperator:
    """See `_services.Operator`."""

    def __init__(self, device: Operated) -> None:
        self._device = device

    def has_program(self, name: str) -> bool:
        """Tell whether there is a part program."""
        return self._device.has_program(name)

    def select(self, channel: int, name: str) -> None:
        """Select a part program."""
        self._device.select_program(name, channel=channel)

    def select_text(self, channel: int, text: str) -> None:
        """Select blocks put in by hand."""
        self._device.select_blocks(text, channel=channel)

    def start(self, channel: int) -> None:
        """Start, or go on."""
        self._device.cycle_start(channel=channel)

    def reset_channel(self, channel: int) -> None:
        """Break off what a channel executes."""
        self._device.reset(channel=channel)

    def leave(self, channel: int) -> None:
        """Leave the selected program."""
        self._device.leave_program(channel=channel)

    def search(self, channel: int, start: str) -> bool:
        """Let the selected program begin at a block; tell whether there is such a block."""
        try:
            self._device.search_block(start, channel=channel)
        except ControlError:
            return False
        return True

    def set_channel_mode(self, channel: int, mode: Mode) -> None:
        """Switch the mode of a channel."""
        self._device.select_mode(mode, channel=channel)
