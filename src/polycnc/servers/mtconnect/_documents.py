"""Write the documents of MTConnect: devices, streams, assets, errors; pure functions, the same input the same bytes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from xml.sax.saxutils import escape, quoteattr

from polycnc.servers.mtconnect._assets import Asset
from polycnc.servers.mtconnect._device import Component, DeviceModel, Item, clean, number_text
from polycnc.servers.mtconnect._errors import AgentError
from polycnc.servers.mtconnect._observations import FAULT, Observation
from polycnc.servers.mtconnect._rows import Version
from polycnc.servers.mtconnect._xpath import attributes_of

_HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
_SENDER = "polycnc"
_ORDER = {"SAMPLE": 0, "EVENT": 1, "CONDITION": 2}
_GROUPS = {"SAMPLE": "Samples", "EVENT": "Events", "CONDITION": "Condition"}
_CONDITION_ID_SINCE, _TYPED_ERRORS_SINCE, _MODEL_TIME_SINCE = (2, 3), (2, 6), (1, 7)
_NO_MESSAGE_CODE_SINCE = (2, 7)
_MOST_ORDERS = 256  # sets of items whose order is remembered


@dataclass(frozen=True, slots=True)
class Header:
    """What every document says of the agent; times are ISO texts, `since` is when the devices were last changed."""

    version: Version
    instance: int
    created: str
    since: str
    buffer_size: int = 1
    asset_size: int = 1
    assets: int = 0

    def text(self, *, buffer: bool = False, assets: bool = False, **more: int) -> str:
        """Return the element."""
        numbers = {"instanceId": self.instance, **more}
        if buffer:
            numbers["bufferSize"] = self.buffer_size
        if assets:
            numbers |= {"assetBufferSize": self.asset_size, "assetCount": self.assets}
        texts = {"creationTime": self.created, "sender": _SENDER, "version": f"{number_of(self.version)}.0.0"}
        if self.version >= _MODEL_TIME_SINCE:
            texts["deviceModelChangeTime"] = self.since
        return f"  <Header{_attributes(texts)}{_attributes(numbers)}/>\n"


def number_of(version: Version) -> str:
    """Return a version as documents name it."""
    return ".".join(map(str, version))


_quoted = lru_cache(4096)(quoteattr)  # names and ids come in every document


def _attributes(pairs: Mapping[str, object]) -> str:
    return "".join([f" {name}={_quoted(str(value))}" for name, value in pairs.items() if value != ""])


def _document(kind: str, version: Version, header: str, body: Iterable[str]) -> bytes:
    number = number_of(version)
    space = f"urn:mtconnect.org:MTConnect{kind}:{number}"
    place = f"http://schemas.mtconnect.org/schemas/MTConnect{kind}_{number}.xsd"
    root = (
        f'<MTConnect{kind} xmlns="{space}" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
        f' xsi:schemaLocation="{space} {place}">\n'
    )
    return "".join((_HEAD, root, header, *body, f"</MTConnect{kind}>\n")).encode()


# ---------------------------------------------------------------------- devices


def devices_document(devices: Sequence[DeviceModel], header: Header) -> bytes:
    """Return the answer to a probe."""
    body = ["  <Devices>\n", *(text for each in devices for text in _device(each)), "  </Devices>\n"]
    return _document("Devices", header.version, header.text(buffer=True, assets=True), body)


def _device(device: DeviceModel) -> Iterator[str]:
    more = {"uuid": device.uuid}
    described = f"<Description{_attributes({'model': device.model, 'serialNumber': device.serial})}/>"
    yield from _component(device.root, "    ", more, described)


def _component(
    component: Component, indent: str, more: Mapping[str, str] | None = None, described: str = ""
) -> Iterator[str]:
    attributes = {"id": component.id, "name": component.name, **(more or {})}
    yield f"{indent}<{component.tag}{_attributes(attributes)}>\n"
    if described:
        yield f"{indent}  {described}\n"
    if component.items:
        yield f"{indent}  <DataItems>\n"
        yield from (
            f"{indent}    <DataItem{_attributes(attributes_of(item))}/>\n" for item in component.items
        )
        yield f"{indent}  </DataItems>\n"
    if component.parts:
        yield f"{indent}  <Components>\n"
        for part in component.parts:
            yield from _component(part, indent + "    ")
        yield f"{indent}  </Components>\n"
    yield f"{indent}</{component.tag}>\n"


# ---------------------------------------------------------------------- streams


class StreamWriter:
    """Write observations by device, component and category."""

    def __init__(self, devices: Sequence[DeviceModel], version: Version) -> None:
        self._version = version
        self._slots: dict[Item, _Slot] = {}
        for device in devices:
            for component in device.root.walk():
                told = {"component": component.tag, "name": component.name, "componentId": component.id}
                begin = f"      <ComponentStream{_attributes(told)}>\n"
                for item in sorted(component.items, key=lambda each: _ORDER[each.category]):
                    self._slots[item] = _Slot(device, component, begin, len(self._slots), *_opening(item))
        self._written: dict[Item, tuple[tuple[Observation, ...], str]] = {}
        self._orders: dict[frozenset[Item], tuple[Item, ...]] = {}

    def current(
        self, state: Mapping[Item, tuple[Observation, ...]], wanted: frozenset[Item]
    ) -> Iterator[str]:
        """Return what holds, of the wanted items; what was written before is not written anew."""
        shown = ((item, self._known(item, state[item])) for item in self._in_order(wanted) if item in state)
        yield from self._streams(shown)

    def _in_order(self, wanted: frozenset[Item]) -> tuple[Item, ...]:
        """Return the wanted items as they are written: those of one machine, however many others there are."""
        if wanted not in self._orders:
            if len(self._orders) >= _MOST_ORDERS:
                self._orders.clear()
            ranks = {item: slot.rank for item in wanted if (slot := self._slots.get(item)) is not None}
            self._orders[wanted] = tuple(sorted(ranks, key=ranks.__getitem__))
        return self._orders[wanted]

    def sample(self, seen: Iterable[Observation]) -> Iterator[str]:
        """Return observations, of each item in their order."""
        by_item: dict[Item, list[Observation]] = {}
        for each in seen:
            by_item.setdefault(each.item, []).append(each)
        ordered = sorted(by_item, key=lambda item: self._slots[item].rank)
        yield from self._streams((item, self._text(item, by_item[item])) for item in ordered)

    def document(
        self, streams: Iterable[str], header: Header, first: int, last: int, following: int
    ) -> bytes:
        """Return the answer to a current or a sample; `following` is the number to go on with."""
        head = header.text(buffer=True, nextSequence=following, firstSequence=first, lastSequence=last)
        return _document("Streams", self._version, head, ["  <Streams>\n", *streams, "  </Streams>\n"])

    def _streams(self, written: Iterable[tuple[Item, str]]) -> Iterator[str]:
        device: DeviceModel | None = None
        component: Component | None = None
        category = ""
        for item, text in written:
            slot = self._slots[item]
            if slot.component is not component:
                yield from _close(category, component, device if slot.device is not device else None)
                if slot.device is not device:
                    device = slot.device
                    yield f"    <DeviceStream{_attributes({'name': device.name, 'uuid': device.uuid})}>\n"
                component, category = slot.component, ""
                yield slot.begin
            if item.category != category:
                yield from _close(category, None, None)
                category = item.category
                yield f"        <{_GROUPS[category]}>\n"
            yield text
        yield from _close(category, component, device)

    def _known(self, item: Item, held: tuple[Observation, ...]) -> str:
        known = self._written.get(item)
        if known is None or known[0] is not held:
            known = self._written[item] = held, self._text(item, held)
        return known[1]

    def _text(self, item: Item, seen: Iterable[Observation]) -> str:
        slot = self._slots[item]
        return "".join(_observation(each, slot.opening, slot.element, self._version) for each in seen)


@dataclass(frozen=True, slots=True)
class _Slot:
    """Where a data item stands in documents, and what its component and observations begin with."""

    device: DeviceModel
    component: Component
    begin: str
    rank: int
    opening: str
    element: str


def _close(category: str, component: Component | None, device: DeviceModel | None) -> Iterator[str]:
    if category:
        yield f"        </{_GROUPS[category]}>\n"
    if component is not None:
        yield "      </ComponentStream>\n"
    if device is not None:
        yield "    </DeviceStream>\n"


def _observation(seen: Observation, opening: str, element: str, version: Version) -> str:
    when = f'{opening} timestamp="{seen.time}" sequence="{seen.sequence}"'
    if seen.item.about is not None:
        return _condition(seen, when, version)
    if seen.item.representation == "DATA_SET":
        entry = f'<Entry key="CuttingTool">{seen.value}</Entry>'
        return f'          <{element} count="1"{when}>{entry}</{element}>\n'
    code = seen.code if version < _NO_MESSAGE_CODE_SINCE else ""
    more = _attributes({"nativeCode": code, "assetType": seen.kind}) if code or seen.kind else ""
    return f"          <{element}{when}{more}>{escape(seen.value)}</{element}>\n"


def _opening(item: Item) -> tuple[str, str]:
    """Return what all observations of an item begin with, and their element."""
    told = {"dataItemId": item.id, "name": item.name}
    if item.about is not None:
        told["type"] = item.type
    elif item.subtype:
        told["subType"] = item.subtype
    return _attributes(told), item.element


def _condition(seen: Observation, opening: str, version: Version) -> str:
    element = seen.value.capitalize()
    more = {"nativeCode": seen.code, "qualifier": seen.qualifier.upper()}
    if seen.value == FAULT and version >= _CONDITION_ID_SINCE:
        more["conditionId"] = seen.key
    if not seen.text:
        return f"          <{element}{opening}{_attributes(more)}/>\n"
    return f"          <{element}{opening}{_attributes(more)}>{escape(seen.text)}</{element}>\n"


# ---------------------------------------------------------------------- assets and errors


def assets_document(assets: Iterable[Asset], header: Header) -> bytes:
    """Return the answer to a request for assets."""
    body = [
        "  <Assets>\n",
        *(f"    {asset_text(each, header.version)}\n" for each in assets),
        "  </Assets>\n",
    ]
    return _document("Assets", header.version, header.text(assets=True), body)


def asset_text(asset: Asset, version: Version) -> str:
    """Return a cutting tool as an element."""
    tool = asset.tool
    told = {
        "assetId": asset.id, "timestamp": asset.time, "deviceUuid": asset.device_uuid, "serialNumber": asset.id,
        "toolId": str(asset.number), "removed": "true" if asset.removed else "",
    }  # fmt: skip
    described = f"<Description>{escape(asset.description)}</Description>" if asset.description else ""
    measured = [
        f'<FunctionalLength code="LF" nominal="{number_text(tool.length_mm)}">'
        f"{number_text(tool.length_mm + tool.wear_length_mm)}</FunctionalLength>",
        f'<CuttingDiameterMax code="DC" nominal="{number_text(2 * tool.radius_mm)}">'
        f"{number_text(2 * (tool.radius_mm + tool.wear_radius_mm))}</CuttingDiameterMax>",
    ]
    cycle = (
        "<CuttingToolLifeCycle><CutterStatus><Status>AVAILABLE</Status></CutterStatus>"
        f"<ProgramToolNumber>{asset.number}</ProgramToolNumber>"
        f"<Measurements>{''.join(measured)}</Measurements></CuttingToolLifeCycle>"
    )
    parts = (cycle, described) if version >= (2, 7) else (described, cycle)
    return f"<CuttingTool{_attributes(told)}>{''.join(parts)}</CuttingTool>"


def error_document(error: AgentError, header: Header, uri: str) -> bytes:
    """Return the answer to a request that cannot be carried out; `uri` is what was asked."""
    if header.version < _TYPED_ERRORS_SINCE:
        told = f'    <Error errorCode="{error.code.name}">{escape(error.text)}</Error>\n'
    else:
        parts = [f"<URI>{escape(clean(uri))}</URI>", f"<ErrorMessage>{escape(error.text)}</ErrorMessage>"]
        parts += [f"<Request>{error.request}</Request>"] if error.request else []
        if error.asset:
            parts.insert(0, f"<AssetId>{escape(error.asset)}</AssetId>")
        if error.parameter:
            parts.insert(0, _parameter(error))
        told = f"    <{error.element}>{''.join(parts)}</{error.element}>\n"
    body = ["  <Errors>\n", told, "  </Errors>\n"]
    return _document("Error", header.version, header.text(buffer=True), body)


def _parameter(error: AgentError) -> str:
    parts = [f"<Value>{escape(error.value)}</Value>"] if error.value else []
    if error.limits is not None:
        low, high = error.limits
        parts += [f"<Minimum>{low}</Minimum>", f"<Maximum>{high}</Maximum>"]
    return f'<QueryParameter name="{error.parameter}">{"".join(parts)}</QueryParameter>'
