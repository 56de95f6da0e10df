"""Operate a device as MCOPS does: the services' words for what its operator does (Manual 003, 4.14.2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from polycnc.cnc import Control, ControlError, Refusal
from polycnc.controllers.bosch._block_buffer import BlockBuffer, check_room
from polycnc.controllers.bosch._channel_host import ChannelHost
from polycnc.controllers.bosch._channel_ports import DeviceChannels
from polycnc.controllers.bosch.ncs import Mode
from polycnc.controllers.bosch.system import Category
from polycnc.nc import ProgramText
from polycnc.nc.cpl import Fault


class Operated(Protocol):
    """A control that can be operated; channels count from 1."""

    def select_program(self, name: str, *, channel: int = 1) -> None: ...
    def select_blocks(self, text: str, *, channel: int = 1) -> None: ...
    def cycle_start(self, *, channel: int = 1) -> None: ...
    def reset(self, *, channel: int | None = None) -> None: ...
    def search_block(self, start: str = "", end: str = "", *, channel: int = 1) -> int: ...
    def select_mode(self, mode: Mode, *, channel: int | None = None) -> None: ...


class DeviceOperator:
    """See `_services.Operator`; `hosts` are those of the channels, in their order."""

    def __init__(
        self, device: Operated, control: Control, channels: DeviceChannels, hosts: Sequence[ChannelHost]
    ) -> None:
        self._device = device
        self._control = control
        self._channels = channels
        self._hosts = hosts

    def has_program(self, name: str) -> bool:
        """Tell whether there is a part program."""
        return self._text(name) is not None

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

    def leave(self, channel: int, *, again: bool) -> None:
        """Leave what is selected; with `again` the program is selected from its beginning."""
        self._control.reset(channel=channel - 1)
        self._hosts[channel - 1].buffer = None
        self._channels.leave(channel, again=again)

    def miss(self, channel: int, name: str) -> None:
        """Select a program that does not exist."""
        self._channels.miss(channel, name)
        what = f"there is no program {name}, or it cannot be executed"
        self._hosts[channel - 1].system.note_error(channel, "", Category.PART_PROGRAM, what)

    def link(self, channel: int, name: str) -> bool:
        """Link a program with its sub-programs, which leaves its table; tell whether nothing is wrong with it."""
        text = self._text(name)
        return text is not None and not self._hosts[channel - 1].check(ProgramText.from_text(text, name))

    def buffer(self, channel: int, text: str) -> None:
        """Put blocks after those put in by hand, also while these are executed; they begin if there are none.

        Raises:
            ControlError: See `Control.set_mdi`; the buffer has no room.
        """
        host, blocks = self._hosts[channel - 1], text.split("\n")
        check_room([*(() if host.buffer is None else host.buffer.waiting), *blocks])
        if host.buffer is None:
            self._control.set_mdi(text, channel=channel - 1)
            mdi = self._control.channels[channel - 1].mdi
            assert mdi is not None
            host.buffer = BlockBuffer(mdi)
            host.system.reset_signal(channel, False)
        host.buffer.waiting.extend(blocks)

    def search(self, channel: int, start: str, end: str) -> bool:
        """Let the selected program begin and end at blocks; tell whether there are such blocks.

        Without its first it begins at its beginning, without its last it ends at its end (Manual 003: MCOPS(3)).
        """
        for first, last in ((start, end), ("", end), (start, ""), ("", "")):
            try:
                self._device.search_block(first, last, channel=channel)
            except ControlError as error:
                if error.reason is not Refusal.NOT_FOUND:
                    raise
            else:
                return (first, last) == (start, end)
        return False

    def set_channel_mode(self, channel: int, mode: Mode) -> None:
        """Switch the mode of a channel."""
        self._device.select_mode(mode, channel=channel)

    def _text(self, name: str) -> str | None:
        try:
            return self._hosts[0].directory.text(name)
        except Fault:
            return None
