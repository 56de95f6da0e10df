"""A machine as MTConnect describes it: components and data items, made from what a control is made of."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite
from typing import Any

from polycnc.cnc import AxisStatus, ChannelStatus, Control, Status
from polycnc.servers.mtconnect._rows import (
    CONDITION_SCOPES,
    CONDITIONS,
    ON_DEVICE,
    ON_FIRST_PATH,
    ROWS,
    Row,
    Version,
)
from polycnc.servers.plant import FACTS, About, Place, Scope, Seen, Shape, Value, asset_id, places, shape_of

_DIGITS = 4
MOST_TEXT = 255
"""How long a text of an observation may be; longer ones are cut."""


@dataclass(frozen=True, slots=True, eq=False)
class Item:
    """A data item; `read` returns its value, which `write` makes a text of, None where there is none now.

    It gets what `part_of` returns for the item's `place`. What is not read of a status (conditions, messages, assets)
    has no `read`.
    """

    id: str
    name: str
    category: str
    type: str
    subtype: str = ""
    units: str = ""
    system: str = ""
    representation: str = ""
    discrete: bool = False
    read: Callable[[Seen, Any], Value] | None = None
    place: Place | None = None
    write: Callable[[Value], str | None] = field(default=lambda value: value_text(value))
    about: tuple[About, str, int] | None = None  # of a condition: what, of which axis and channel

    @property
    def element(self) -> str:
        """The name of its observations' element; conditions have that of their level."""
        return "".join(part.capitalize() for part in self.type.split("_")) + _SUFFIX.get(
            self.representation, ""
        )


_SUFFIX = {"DATA_SET": "DataSet"}


@dataclass(slots=True, eq=False)
class Component:
    """A component: the name of its element, its id and name, its data items, and the components in it."""

    tag: str
    id: str
    name: str
    items: list[Item] = field(default_factory=list)
    parts: list[Component] = field(default_factory=list)

    def walk(self) -> Iterator[Component]:
        """Return it and all components in it, as a document has them."""
        yield self
        for part in self.parts:
            yield from part.walk()


@dataclass(eq=False)
class DeviceModel:
    """A machine: its name, what tells it from all others, its components, and what reads it."""

    name: str
    uuid: str
    serial: str
    model: str
    version: Version
    root: Component

    @cached_property
    def items(self) -> tuple[Item, ...]:
        """Every data item, as documents have them."""
        return tuple(item for component in self.root.walk() for item in component.items)

    @cached_property
    def values(self) -> tuple[Item, ...]:
        """Those that are read of a status."""
        return tuple(item for item in self.items if item.read is not None)

    @cached_property
    def conditions(self) -> Mapping[tuple[About, str, int], Item]:
        """The conditions, by what they are about."""
        return {item.about: item for item in self.items if item.about is not None}

    @cached_property
    def special(self) -> Mapping[str, Item]:
        """The message and what is said of assets, by type."""
        found = (item for item in self.items if item.read is None and item.about is None)
        return {item.type: item for item in found}


def number_text(value: float) -> str:
    """Return a number as documents have it: at most four decimals, no exponent, no minus zero."""
    text = f"{value:.{_DIGITS}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def plain_text(text: str) -> str:
    """Return a text without what XML and lines cannot hold, cut to what is allowed."""
    return clean(text[:MOST_TEXT])


def clean(text: str) -> str:
    """Return a text without characters that are no letters or signs, which XML and lines cannot hold."""
    return text if text.isprintable() else "".join(char if char.isprintable() else "?" for char in text)


def value_text(value: Value) -> str | None:
    """Return a value as documents have it, None where there is none."""
    match value:
        case None:
            return None
        case str():
            return plain_text(value)
        case int():
            return str(value)
        case float():
            return number_text(value) if isfinite(value) else None
        case _:
            return " ".join(map(number_text, value))


def part_of(place: Place, status: Status) -> ChannelStatus | AxisStatus | None:
    """Return the part of a status that the items of a place are read of: a channel, an axis, or none of its own."""
    if place.scope is Scope.CHANNEL:
        return status.channels[place.number]
    return status.axes[place.name] if place.scope is Scope.AXIS else None


def _reader(row: Row) -> Callable[[Seen, Any], Value]:
    read, share = FACTS[row.fact].read, row.share
    if share == 1.0:
        return read
    return lambda seen, of: share * read(seen, of)  # type: ignore[operator]


def _key(pattern: str, place: Place) -> str:
    if place.scope is Scope.AXIS:
        return pattern.format(place.name)
    return pattern.format("" if place.number == 0 else place.number + 1)


class _Maker:
    """Make the components of one machine."""

    def __init__(self, name: str, shape: Shape, version: Version) -> None:
        self._shape = shape
        self._version = version
        self._name = name
        self._prefix = ("_" if name[0].isdigit() else "") + name

    def id_of(self, key: str) -> str:
        return f"{self._prefix}.{key}"

    def items(self, place: Place, wanted: Callable[[str], bool] = lambda key: True) -> list[Item]:
        """Return the data items of a place, conditions last."""
        found = [
            self._item(row, place)
            for row in ROWS
            if FACTS[row.fact].scope is place.scope
            and row.is_in(self._version)
            and row.only in ("", place.unit)
            and wanted(row.key)
        ]
        return [item for item in found if item is not None]

    def conditions(self, place: Place) -> list[Item]:
        """Return the conditions of a place."""
        axis, channel = place.name, place.number if place.scope is Scope.CHANNEL else 0
        return [
            Item(self.id_of(key), key, "CONDITION", row.type, about=(row.about, axis, channel))
            for row in CONDITIONS
            if CONDITION_SCOPES[row.about] is place.scope
            for key in (_key(row.key, place),)
        ]

    def _item(self, row: Row, place: Place) -> Item | None:
        if row.fact == "path_position" and not self._has_space(place.number):
            return None
        key = _key(row.key, place)
        words = row.older if self._version < row.older_until else row.words
        return Item(
            self.id_of(key),
            key,
            "SAMPLE" if row.sample else "EVENT",
            row.type,
            row.subtype if self._version >= row.subtype_since else "",
            row.units(place.unit) if row.sample else "",
            row.system,
            read=_reader(row),
            place=place,
            write=value_text if words is None else words.get,
        )

    def _has_space(self, channel: int) -> bool:
        units = dict(self._shape.axes)
        return all(name in self._shape.channels[channel] and units[name] == "mm" for name in ("X", "Y", "Z"))

    def tool_asset(self, place: Place) -> Item:
        """Return the item that names the tool in the spindle as an asset."""
        name = self._name

        def read(seen: Seen, channel: ChannelStatus) -> str | None:
            tool = channel.tool.number
            return asset_id(name, tool) if tool in seen.inventory.tools else None

        key = _key("tool_asset_id{}", place)
        return Item(self.id_of(key), key, "EVENT", "TOOL_ASSET_ID", read=read, place=place)

    def special(self, key: str, kind: str, since: Version, **more: str) -> list[Item]:
        """Return a data item that is not read of a status, if the version has it."""
        if self._version < since:
            return []
        return [Item(self.id_of(key), key, "EVENT", kind, **more)]  # type: ignore[arg-type]

    def component(self, tag: str, key: str, name: str, items: list[Item], *parts: Component) -> Component:
        return Component(tag, self.id_of(key), name, items, list(parts))


def device_model(
    name: str, shape: Shape, version: Version, *, uuid: str = "", serial: str = "", model: str = ""
) -> DeviceModel:
    """Return the description of a machine in a version; `uuid` is made of its name if it is not given."""
    make = _Maker(name, shape, version)
    (machine,), (spindle,) = places(shape, Scope.MACHINE), places(shape, Scope.SPINDLE)
    axes = [
        make.component(
            "Rotary" if place.unit == "deg" else "Linear",
            f"axis_{place.name}", place.name, [*make.items(place), *make.conditions(place)],
        )
        for place in places(shape, Scope.AXIS)
    ]  # fmt: skip
    axes.append(make.component("Rotary", "spindle", "S1", [*make.items(spindle), *make.conditions(spindle)]))
    of_machine = make.items(machine, lambda key: key in ON_FIRST_PATH)
    paths = [
        make.component(
            "Path", f"path{place.number + 1}", f"path{place.number + 1}",
            [*(of_machine if place.number == 0 else ()), *make.items(place), make.tool_asset(place),
             *make.conditions(place)],
        )
        for place in places(shape, Scope.CHANNEL)
    ]  # fmt: skip
    on_controller = [
        *make.items(machine, lambda key: key not in ON_DEVICE | ON_FIRST_PATH),
        *make.special("message", "MESSAGE", (1, 1)),
        *make.conditions(machine),
    ]
    on_device = [
        *make.items(machine, lambda key: key in ON_DEVICE),
        *make.special("asset_chg", "ASSET_CHANGED", (1, 2)),
        *make.special("asset_rem", "ASSET_REMOVED", (1, 3)),
        *make.special("asset_count", "ASSET_COUNT", (2, 0), representation="DATA_SET"),
    ]
    root = make.component(
        "Device", "device", name, on_device,
        make.component("Axes", "axes", "axes", [], *axes),
        make.component("Controller", "controller", "controller", on_controller, *paths),
    )  # fmt: skip
    return DeviceModel(name, uuid or f"polycnc.{name}", serial, model or name, version, root)


def model_of(name: str, control: Control, version: Version) -> DeviceModel:
    """Return the description of a control that is served under a name."""
    identity = control.inventory().identity
    return device_model(
        name, shape_of(control.status()), version, serial=identity.serial_number, model=identity.machine
    )
