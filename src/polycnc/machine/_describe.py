"""Tell people and programs what a machine is, and write the reference page of the machine file."""

from __future__ import annotations

import json
from datetime import datetime
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from polycnc.machine._config import (
    IoConfig,
    MachineConfig,
    PathConfig,
    SpindleConfig,
    TimesConfig,
)
from polycnc.machine._config_axis import AxisConfig, LinearAxis, LinearServo, RotaryAxis, RotaryServo
from polycnc.machine._config_probe import SurfaceConfig
from polycnc.machine._config_programs import ProgramsConfig
from polycnc.machine._config_stock import FixtureConfig, StockConfig
from polycnc.machine._config_tool import ToolConfig
from polycnc.machine._toml import range_text

AXIS_COLUMNS = ("axis", "kind", "vmax", "amax", "soft limits", "home", "servo")


def describe_machine(config: MachineConfig) -> dict[str, Any]:
    """Return the machine as JSON values: every number beside its unit, null for what it does not have."""
    tables = config.model_dump(mode="json", by_alias=True, exclude={"axes", "start"})
    start = dict(zip(config.axis_names, config.start_positions, strict=True))
    return {**tables, "axes": [_describe_axis(axis, start[axis.name]) for axis in config.axes]}


def axis_rows(config: MachineConfig) -> list[tuple[str, ...]]:
    """Return one row of text per axis, with the columns `AXIS_COLUMNS`."""
    return [
        (
            axis.name,
            f"{axis.kind}, repeats" if axis.modulo else axis.kind,
            f"{axis.vmax:g} {axis.unit}/s",
            f"{axis.amax:g} {axis.unit}/s²",
            _range(axis.soft_limits, axis.unit) if _given(axis, "soft_limits") else "none",
            f"{axis.home:g} {axis.unit}",
            axis.servo.kind,
        )
        for axis in config.axes
    ]


def machine_row(config: MachineConfig) -> tuple[str, str, str]:
    """Return the row of a machine in a list of machines: name, axes, description."""
    return config.name, " ".join(config.axis_names), config.description


def machine_file_reference() -> str:
    """Return the Markdown page that explains every key of a machine file."""
    parts = [_INTRODUCTION]
    for title, text, linear, rotary in _SECTIONS:
        rows = "\n".join(_key_row(name, linear, rotary) for name in rotary.model_fields)
        parts.append(f"## {title}\n\n{text}\n\n{_TABLE_HEAD}\n{rows}")
    return "\n\n".join(parts) + "\n"


_INTRODUCTION = """\
# The machine file

A machine file is a [TOML](https://toml.io) file. It says what a machine is: its axes, how it joins blocks to
a path, how long things take, its tools and offsets, and its inputs and outputs. A key that is not on this
page is an error, and so is a value of the wrong kind: the message names the line, the key and what to write.

Keys carry their unit: `_mm`, `_mm_s` (mm/s), `_mm_s2` (mm/s²), `_deg`, `_deg_s`, `_deg_s2`, `_s` (seconds). A
linear axis has the keys in mm, a rotary axis the same keys in degree. `[low, high]` is a pair of numbers with
low < high.

[Describe a machine](../how-to/describe-a-machine.md) shows how to write one."""

_TABLE_HEAD = "| key | value | range | default | meaning |\n|---|---|---|---|---|"
_SECTIONS: tuple[tuple[str, str, type[BaseModel], type[BaseModel]], ...] = (
    (
        "The machine",
        "Plain values come at the top of the file, before the first table. Positions in `offsets` and "
        "`start` are in mm or degree as the axis has it; an axis that an offset leaves out has 0 there.",
        MachineConfig,
        MachineConfig,
    ),
    (
        "`[[axis]]`",
        "One table for each axis, in the order of the machine's coordinates.",
        LinearAxis,
        RotaryAxis,
    ),
    (
        "`[axis.servo]`",
        'Stands below the `[[axis]]` it belongs to. With `kind = "ideal"` there are no other keys; with '
        '`kind = "pidf"`, `kp` must be greater than 0.',
        LinearServo,
        RotaryServo,
    ),
    ("`[path]`", "How blocks are joined.", PathConfig, PathConfig),
    ("`[times]`", "The time of functions that are not motion.", TimesConfig, TimesConfig),
    ("`[spindle]`", "The spindle.", SpindleConfig, SpindleConfig),
    (
        "`[tools.N]`",
        "One table for each tool; N is its number. What follows `description` is for [stock](../how-to/cut-stock.md).",
        ToolConfig,
        ToolConfig,
    ),
    (
        "`[[surface]]`",
        "What a probe meets, in machine coordinates. One table each; an axis that is not named does not count.",
        SurfaceConfig,
        SurfaceConfig,
    ),
    (
        "`[stock]`",
        "What programs cut, as if [`--stock`](../how-to/cut-stock.md) said it; that and `--resolution` overrule it.",
        StockConfig,
        StockConfig,
    ),
    (
        "`[[fixture]]`",
        "What holds the stock: no part of a tool may touch it where stock is cut. `--fixture` replaces all of them.",
        FixtureConfig,
        FixtureConfig,
    ),
    ("`[io]`", "The inputs and outputs: bits, and words of 32 bits with sign.", IoConfig, IoConfig),
    (
        "`[programs]`",
        "What programs in [LinuxCNC's language](linuxcnc-language.md) find beside them.",
        ProgramsConfig,
        ProgramsConfig,
    ),
)


def _describe_axis(axis: LinearAxis | RotaryAxis, start: float) -> dict[str, Any]:
    unit = axis.unit
    servo = axis.servo
    limits = list(axis.soft_limits) if _given(axis, "soft_limits") else None
    switches = list(axis.limit_switches) if _given(axis, "limit_switches") else None
    gains = {key: getattr(servo, key) for key in ("kp", "ki", "kd", "kpl", "kfcv", "kfca", "lag_s")}
    return {
        "name": axis.name,
        "kind": axis.kind,
        "unit": unit,
        "modulo": axis.modulo,
        **_with_unit("vmax", axis.vmax, f"{unit}/s"),
        **_with_unit("amax", axis.amax, f"{unit}/s2"),
        **_with_unit("jump", axis.jump, f"{unit}/s"),
        **_with_unit("soft_limits", limits, unit),
        **_with_unit("home", axis.home, unit),
        **_with_unit("start", start, unit),
        **_with_unit("resolution", axis.resolution, unit),
        **_with_unit("limit_switches", switches, unit),
        **_with_unit("reference_switch", axis.reference_switch, unit),
        **_with_unit("index_pulse", axis.index_pulse, unit),
        **_with_unit("backlash", axis.backlash, unit),
        "servo": {
            "kind": servo.kind,
            **(gains if servo.kind == "pidf" else {}),
            **_with_unit("in_position", _finite(servo.in_position), unit),
            **_with_unit("following_error_limit", _finite(servo.following_error_limit), unit),
        },
    }


def _with_unit(name: str, value: object, unit: str) -> dict[str, object]:
    return {name: value, f"{name}_unit": unit}


def _finite(value: float) -> float | None:
    return None if value == float("inf") else value


def _given(axis: AxisConfig, name: str) -> bool:
    return getattr(axis, f"{name}_{axis.unit}") is not None


def _range(limits: tuple[float, float], unit: str) -> str:
    return f"{limits[0]:g} to {limits[1]:g} {unit}"


def _key_row(name: str, linear: type[BaseModel], rotary: type[BaseModel]) -> str:
    field = rotary.model_fields[name]
    twin = name.replace("_deg", "_mm")
    other = linear.model_fields.get(twin)
    key = f"`{field.alias or name}`"
    if other is None:
        key += " (rotary)"
    elif twin != name:
        key = f"`{twin}`, {key}"
    kinds = dict.fromkeys(_value_text(each.annotation) for each in (other, field) if each)
    allowed = range_text(field).replace("<=", "≤").replace(">=", "≥")
    cells = (key, " or ".join(kinds), allowed, _default_text(other or field), field.description or "")
    return f"| {' | '.join(cells)} |"


_PLAIN = {float: "number", int: "whole number", bool: "true or false", str: "text", datetime: "date and time"}


def _value_text(annotation: Any) -> str:
    choices = get_args(annotation)
    match get_origin(annotation):
        case origin if origin is Annotated:
            return _value_text(choices[0])
        case origin if origin is Literal:
            return " or ".join(json.dumps(choice) for choice in choices)
        case origin if origin is Union or origin is UnionType:
            return " or ".join(_value_text(choice) for choice in choices if choice is not type(None))
        case origin if origin is dict:
            return "table"
        case origin if origin is tuple:
            if choices[-1] is not Ellipsis:
                return "[low, high]"
            return "numbers" if _value_text(choices[0]) == "number" else "tables"
        case _:
            return _PLAIN.get(annotation, "table")


def _default_text(field: FieldInfo) -> str:
    value = field.default
    if field.is_required():
        return "required"
    if value is None:
        return "none"
    if isinstance(value, BaseModel):
        return "defaults"
    if isinstance(value, datetime):
        return value.isoformat()
    if isinstance(value, float):
        return f"{value:g}"
    return "empty" if value == {} else json.dumps(value)
