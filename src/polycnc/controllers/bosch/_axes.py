"""Physical and logical axes, channels, coordinates: what an axis selection of a program means (Manual 003, 4.2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from polycnc.nc import of_another_channel
from polycnc.nc.cpl import OMITTED, CharacterField, Fault, Text, text_of

PHYSICAL, OWN = 0, 1
INVALID_PARAMETER = "INVALID PARAMETER"
AXIS_INDEX = Text(INVALID_PARAMETER, "1938")
AXIS_OF_ANOTHER = Text(INVALID_PARAMETER, "1970")
AXIS_OF_CHANNEL = Text(INVALID_PARAMETER, "1971")
"""Axis index error, axis belongs to another channel, axis of a channel that is named, by the manual's numbers."""


@dataclass
class SystemAxes:
    """The axes of a system.

    `names` are those of the machine's axes in their order, `numbers` their physical indices (1 to 64, ascending,
    maybe with gaps). `channels` are the physical indices of each channel's axes; an axis in none is asynchronous.
    `logical` are other names of axes, by channel and physical index.
    """

    names: Sequence[str]
    numbers: Sequence[int] = ()
    channels: dict[int, tuple[int, ...]] = field(default_factory=dict)
    logical: dict[tuple[int, int], str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.numbers = tuple(self.numbers) or tuple(range(1, len(self.names) + 1))
        if not self.channels:
            self.channels = {1: tuple(self.numbers)}
        self.defaults = dict(self.channels)

    def set_channels(self, shares: Sequence[Sequence[str]]) -> None:
        """Give channels 1 and up their axes by name."""
        numbered = dict(zip(self.names, self.numbers, strict=True))
        self.channels = {
            place: tuple(sorted(numbered[name] for name in share)) for place, share in enumerate(shares, 1)
        }
        self.defaults = dict(self.channels)

    def index(self, physical: int) -> int:
        """Return the place of an axis in the machine, from 0."""
        return list(self.numbers).index(physical)

    def physical_name(self, physical: int) -> str:
        """Return the name of a physical axis."""
        return self.names[self.index(physical)]

    def logical_name(self, channel: int, physical: int) -> str:
        """Return the name of an axis in its channel."""
        return self.logical.get((channel, physical)) or self.physical_name(physical)

    def channel_of(self, physical: int) -> int | None:
        """Return the channel that an axis belongs to now, None for an asynchronous one."""
        return next((channel for channel, axes in self.channels.items() if physical in axes), None)

    def names_in(self, channel: int) -> list[str]:
        """Return the names of the machine's axes in a channel; no word of a program has those that it does not have."""
        own = self.channels[channel]
        return [
            self.logical_name(channel, number) if number in own else of_another_channel(name)
            for number, name in zip(self.numbers, self.names, strict=True)
        ]

    def move(self, physical: int, channel: int | None) -> None:
        """Give an axis to a channel, or to none; logical indices ascend with physical ones."""
        for number, axes in self.channels.items():
            rest = tuple(each for each in axes if each != physical)
            self.channels[number] = tuple(sorted((*rest, physical))) if number == channel else rest

    # ------------------------------------------------------------------ what programs name

    def physical(self, axis: object) -> int:
        """Return the axis of a physical index or name, wherever it is.

        Raises:
            Fault: There is none.
        """
        if is_name(axis):
            name = text_of(axis) or ""
            if name in self.names:
                return self.numbers[list(self.names).index(name)]
            raise Fault(AXIS_INDEX, f"there is no axis {name}; there are {', '.join(self.names)}")
        if type(axis) is int and axis in self.numbers:
            return axis
        raise Fault(AXIS_INDEX, f"physical axes are {', '.join(map(str, self.numbers))}")

    def axis(self, own: int, axis: object, kind: object = OMITTED, channel: object = OMITTED) -> int:
        """Return the physical index of an axis or coordinate that a program of channel `own` selects.

        A name is one of the channel, else a physical one; an index is one of the channel, with `kind` 0 a physical one.

        Raises:
            Fault: There is none, a physical axis is given with a channel, or `kind` is neither 0 nor 1.
        """
        if kind is not OMITTED and (isinstance(kind, bool) or kind not in (PHYSICAL, OWN)):
            raise Fault(INVALID_PARAMETER, "0 selects the physical axis, 1 that of the channel")
        if channel is not OMITTED and (type(channel) is not int or channel not in self.channels):
            raise Fault(INVALID_PARAMETER, f"there is no channel {channel}")
        number = own if channel is OMITTED else int(str(channel))
        axes = self.channels[number]
        if is_name(axis):
            name = text_of(axis) or ""
            found = next((each for each in axes if self.logical_name(number, each) == name), None)
            if found is not None:
                return found
            if channel is not OMITTED:
                raise Fault(AXIS_OF_CHANNEL, f"channel {number} has no axis {name}")
            return self.physical(axis)
        if kind == PHYSICAL:
            if channel is not OMITTED:
                raise Fault(INVALID_PARAMETER, "a physical axis takes no channel")
            return self.physical(axis)
        if type(axis) is not int or not 1 <= axis <= len(axes):
            raise Fault(AXIS_INDEX, f"axes of channel {number} are 1 to {len(axes)}")
        return axes[axis - 1]

    def own_axis(self, own: int, axis: object, kind: object = OMITTED) -> int:
        """Return the same of an axis that has to belong to the channel itself.

        Raises:
            Fault: It does not.
        """
        found = self.axis(own, axis, kind)
        if found not in self.channels[own]:
            raise Fault(AXIS_OF_ANOTHER, f"axis {self.physical_name(found)} does not belong to channel {own}")
        return found

    def logical_names(self) -> Mapping[tuple[int, str], int]:
        """Return the logical indices of axes by channel and name."""
        return {
            (channel, self.logical_name(channel, number)): place
            for channel, axes in self.channels.items()
            for place, number in enumerate(axes, 1)
        }


def is_name(axis: object) -> bool:
    """Tell whether an axis is selected by a name."""
    return isinstance(axis, str | CharacterField) or not isinstance(axis, int | float)
