"""What a machine shows, as JSON: a status and an inventory to a document; the same for REST, stream and page."""

from __future__ import annotations

from dataclasses import is_dataclass
from functools import cache
from typing import Any

from pydantic import TypeAdapter
from pydantic_core import to_json

from polycnc.cnc import Inventory, Status
from polycnc.servers.machines import ServedMachine


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(kind)


def as_json(value: object) -> bytes:
    """Return a status or an inventory as JSON; numbers that are none are null."""
    kind: Any = type(value)
    if isinstance(value, Status | Inventory) or is_dataclass(value):
        return _adapter(kind).dump_json(value)
    return to_json(value, inf_nan_mode="null")


def status_json(machine: ServedMachine) -> bytes:
    """Return the status of a machine at its present cycle."""
    return as_json(machine.device.status())


def inventory_parts(machine: ServedMachine, known: dict[str, int]) -> dict[str, Any]:
    """Return the parts of the inventory that have changed since `known`, which is brought up to date."""
    control = machine.control
    if control is None:
        return {}
    inventory = control.inventory()
    changed = [name for name, number in inventory.revisions.items() if known.get(name) != number]
    known.update(inventory.revisions)
    if not changed:
        return {}
    import json

    whole = json.loads(as_json(inventory))
    return {name: whole[name] for name in ("revisions", *changed)}


_DEVICE_STATUS: dict[str, Any] = {
    "title": "DeviceStatus",
    "description": "What a device without a control shows; more is there by its kind.",
    "type": "object",
    "required": ["cycle", "time_s", "axes"],
    "properties": {
        "cycle": {"type": "integer"},
        "time_s": {"type": "number"},
        "axes": {"type": "array", "items": {"type": "object"}},
    },
}


def schemas() -> dict[str, Any]:
    """Return JSON schemas by name: statuses, the inventory of a control, and what they are made of."""
    found: dict[str, Any] = {"DeviceStatus": _DEVICE_STATUS}
    for kind in (Status, Inventory):
        made = TypeAdapter(kind).json_schema(
            mode="serialization", ref_template="#/components/schemas/{model}"
        )
        found |= made.pop("$defs", {})
        found[kind.__name__] = made
    for each in found.values():
        for field in each.get("properties", {}).values():
            if field.get("format") == "date-time":
                del field["format"]  # a machine's clock has no time zone
    return found
