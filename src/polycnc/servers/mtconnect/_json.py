"""Documents as JSON, in the form that agents have it (version 1): an element is an object below its name."""

from __future__ import annotations

import json
from typing import Any
from xml.etree import ElementTree

_LISTS = frozenset(
    {"Devices", "DataItems", "Components", "Streams", "Samples", "Events", "Condition", "Assets", "Errors"}
)
_NUMBERS = frozenset(
    {"sequence", "instanceId", "bufferSize", "nextSequence", "firstSequence", "lastSequence", "assetBufferSize",
     "assetCount", "count"}
)  # fmt: skip


def as_json(document: bytes) -> bytes:
    """Return a document that this agent has written, as JSON on one line."""
    root = ElementTree.fromstring(document)
    body = {"jsonVersion": 1, **_body(root, sample=False)}
    return json.dumps({_name(root): body}, ensure_ascii=False, separators=(",", ":")).encode()


def _name(element: ElementTree.Element) -> str:
    return element.tag.rpartition("}")[2]


def _body(element: ElementTree.Element, *, sample: bool) -> Any:
    name = _name(element)
    if name in _LISTS:
        return [{_name(each): _body(each, sample=name == "Samples")} for each in element]
    made: dict[str, Any] = {
        key: int(value) if key in _NUMBERS else value
        for key, value in element.attrib.items()
        if "}" not in key
    }
    for each in element:
        if _name(each) == "ComponentStream":
            made.setdefault("ComponentStreams", []).append({"ComponentStream": _body(each, sample=False)})
        else:
            made[_name(each)] = _body(each, sample=False)
    text = (element.text or "").strip()
    if not made:
        return text
    if text:
        made["value"] = _number(text) if sample else text
    return made


def _number(text: str) -> Any:
    """Return a value of a sample: a number, three of them, or a word."""
    try:
        found = [float(each) for each in text.split()]
    except ValueError:
        return text
    return found[0] if len(found) == 1 else found
