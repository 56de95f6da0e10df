"""What a snapshot keeps of a control beside axes and programs: what is selected in words of its own, and signals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any, TypeAlias

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Field,
    StrictBool,
    StrictInt,
    StrictStr,
    TypeAdapter,
    ValidationError,
)

from polycnc.controllers.bosch._channel_ports import MODES, DeviceChannels
from polycnc.controllers.bosch._system import BoschSystem
from polycnc.controllers.bosch.ncs import Channel
from polycnc.controllers.bosch.ncs import Mode as BoschMode
from polycnc.controllers.bosch.system import Category, PresentError
from polycnc.machine import damaged_snapshot

_KEPT = ("blocks", "return_how", "return_where", "recording")
"""What an image holds that nothing else tells."""


def _number(key: str) -> str:
    if not (key.isascii() and key.isdecimal()):
        raise ValueError("channels are numbers")
    return key


def _mode(value: int) -> int:
    if value not in MODES:
        raise ValueError("there is no such mode")
    return value


def _time(value: object) -> datetime:
    if not isinstance(value, str):
        raise ValueError("a time is an ISO text")
    return datetime.fromisoformat(value)


_Number: TypeAlias = Annotated[str, AfterValidator(_number)]
_Mode: TypeAlias = Annotated[StrictInt, AfterValidator(_mode)]
_Count: TypeAlias = Annotated[StrictInt, Field(ge=0)]
_Way: TypeAlias = Annotated[StrictInt, Field(ge=1, le=3)]
_Category: TypeAlias = Annotated[StrictInt, Field(ge=min(Category), le=max(Category))]
_Time: TypeAlias = Annotated[datetime, BeforeValidator(_time)]


@dataclass(frozen=True, slots=True)
class _Moment:
    """What a snapshot holds; nothing of it: as after switching on."""

    __pydantic_config__ = ConfigDict(extra="forbid")

    selected: tuple[dict[_Number, _Mode], dict[_Number, StrictStr]] = ({}, {})
    shown: tuple[tuple[_Count, _Way, _Way, StrictBool], ...] = ()
    signals: tuple[tuple[StrictInt, StrictInt, _Count], ...] = ()
    errors: tuple[tuple[StrictInt, StrictInt, _Category, StrictStr, _Time | None], ...] = ()


_MOMENT = TypeAdapter(_Moment)


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

    def restore_point(self, data: Mapping[str, Any]) -> Callable[[], None]:
        """Return what goes back to what was saved; nothing of it: as after switching on.

        Raises:
            SnapshotError: It is not what `save` returns of a control like this one.
        """
        try:
            moment = _MOMENT.validate_python(dict(data))
        except ValidationError as error:
            raise damaged_snapshot(error.errors()[0]["msg"], "control") from error
        numbers = self._system.shown.image.channels.keys()
        named = {int(number) for each in moment.selected for number in each}
        present = {channel for _, channel, *_ in moment.errors}
        if named - numbers or present - numbers - {-1} or len(moment.shown) not in (0, len(numbers)):
            raise damaged_snapshot("it has other channels", "control")
        if not all(self._system.interface.has(*signals) for signals in moment.signals):
            raise damaged_snapshot("it has other signals", "control")
        return lambda: self._restore(moment)

    def _restore(self, moment: _Moment) -> None:
        images = self._system.shown.image.channels
        modes, missing = moment.selected
        self._channels.restore(
            {int(number): BoschMode(mode) for number, mode in modes.items()},
            {int(number): name for number, name in missing.items()},
        )
        for place, number in enumerate(images):
            images[number] = image = Channel(number)
            for name, value in zip(_KEPT, moment.shown[place] if moment.shown else (), strict=False):
                setattr(image, name, value)
        self._system.shown.forget()
        self._system.interface.restore(moment.signals)
        self._system.note_errors()  # those of the runs that are back are among the errors that were saved
        self._system.errors.errors = [
            PresentError(number, channel, Category(kind), text, at)
            for number, channel, kind, text, at in moment.errors
        ]
