"""What a snapshot keeps of a control beside axes and programs: what is selected in words of its own, and signals."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Any

from polycnc.controllers.bosch._channel_ports import DeviceChannels
from polycnc.controllers.bosch._system import BoschSystem
from polycnc.controllers.bosch.ncs import Channel
from polycnc.controllers.bosch.system import Category, PresentError

_KEPT = ("blocks", "return_how", "return_where", "recording")
"""What an image holds that nothing else tells."""


class DeviceMoment:
    """See `polycnc.cnc.Beside`: modes, missing programs, the way of returning, interface signals, errors."""

    def __init__(self, channels: DeviceChannels, system: BoschSystem) -> None:
        self._channels = channels
        self._system = system

    def save(self) -> dict[str, Any]:
        """Return plain data."""
        self._system.note_errors()
        images = self._system.shown.image.channels
        return {
            "selected": self._channels.save(),
            "shown": [[getattr(shown, name) for name in _KEPT] for shown in images.values()],
            "signals": self._system.interface.save(),
            "errors": [
                [each.number, each.channel, int(each.category), each.text, each.at and each.at.isoformat()]
                for each in self._system.errors.errors
            ],
        }

    def restore(self, data: Mapping[str, Any]) -> None:
        """Go back to what was saved; nothing of it: as after switching on."""
        images = self._system.shown.image.channels
        self._channels.restore(data.get("selected", ({}, {})))
        for number, values in zip(images, data.get("shown") or [()] * len(images), strict=True):
            images[number] = Channel(number, **dict(zip(_KEPT, values, strict=False)))
        self._system.shown.forget()
        self._system.interface.restore(data.get("signals", ()))
        self._system.note_errors()  # those of the runs that are back are among the errors that were saved
        self._system.errors.errors = [
            PresentError(number, channel, Category(kind), text, at and datetime.fromisoformat(at))
            for number, channel, kind, text, at in data.get("errors", ())
        ]
