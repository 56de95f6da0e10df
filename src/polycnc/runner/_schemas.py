"""JSON schemas of what the commands print with ``--json``, and of machine and dialect files.

Every key is in them and no other is allowed, so a test that validates real output notices one that was forgotten.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from polycnc.errors import UsageError, did_you_mean
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect

Schema = dict[str, Any]
_DRAFT = "https://json-schema.org/draft/2020-12/schema"

_TEXT: Schema = {"type": "string"}
_FLAG: Schema = {"type": "boolean"}
_LINE: Schema = {"type": "integer", "minimum": 0, "description": "From 1; 0 where there is none."}
_COUNT: Schema = {"type": "integer", "minimum": 0}


def _number(description: str, *, low: float | None = None) -> Schema:
    found: Schema = {"type": "number", "description": description}
    return found if low is None else {**found, "minimum": low}


def _time(description: str) -> Schema:
    return _number(f"{description}, s.", low=0.0)


def _length(description: str) -> Schema:
    return _number(f"{description}, mm.", low=0.0)


def _list(items: Schema, **more: Any) -> Schema:
    return {"type": "array", "items": items, **more}


def _map(values: Schema, description: str) -> Schema:
    return {"type": "object", "additionalProperties": values, "description": description}


def _object(properties: dict[str, Schema], optional: tuple[str, ...] = ()) -> Schema:
    required = [name for name in properties if name not in optional]
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": False}


def _or_null(schema: Schema) -> Schema:
    return {"anyOf": [schema, {"type": "null"}]}


_EXTENTS = _map(
    _list({"type": "number"}, minItems=2, maxItems=2),
    "Lowest and highest position of each axis in machine coordinates, mm or degree.",
)
_ALARM = _object(
    {
        "kind": {"enum": ["program", "machine"]},
        "code": {"type": "string", "description": "The control's own number, where it has one."},
        "text": _TEXT,
        "hint": {"type": "string", "description": "What to do."},
        "file": _TEXT,
        "line": _LINE,
        "column": _LINE,
        "time_s": _time("When"),
    }
)
_TOOL_TIMES = _map(
    _object({"cutting_time_s": _time("Cutting"), "rapid_time_s": _time("Positioning")}),
    "Times by the number of the tool.",
)


def _result() -> Schema:
    return _object(
        {
            "program": _TEXT,
            "dialect": _TEXT,
            "guessed": _TEXT,
            "machine": _TEXT,
            "blocks": _COUNT,
            "cycles": _COUNT,
            "time_s": _time("From the start to the end"),
            "cutting_time_s": _time("Everything that is neither rapid nor waiting"),
            "rapid_time_s": _time("Rapids"),
            "waiting_time_s": _time("Dwells and functions that take time"),
            "path_mm": _length("The whole path"),
            "cutting_path_mm": _length("All but rapids"),
            "rapid_path_mm": _length("Rapids"),
            "top_feed_mm_min": _number("Highest speed of a cut, mm/min.", low=0.0),
            "axis_units": _map({"enum": ["mm", "deg"]}, "The unit of each axis."),
            "end_position_mm": _map({"type": "number"}, "Where each axis is at the end, mm or degree."),
            "extents_mm": _EXTENTS,
            "alarms": _list(_ALARM),
            "tool_times": _TOOL_TIMES,
            "operations": _list(
                _object(
                    {
                        "name": _TEXT,
                        "line": _LINE,
                        "tool": _COUNT,
                        "time_s": _time("All of it"),
                        "cutting_time_s": _time("Cutting"),
                        "rapid_time_s": _time("Positioning"),
                    }
                )
            ),
            "messages": _list(_object({"text": _TEXT, "line": _LINE, "count": _COUNT})),
            "events": _list(_object({"time_s": _time("When"), "line": _LINE, "word": _TEXT})),
            "variables": {"type": "object", "description": "Variables of the program's language, by name."},
            "stock": _stock(),
        },
        ("variables", "stock"),
    )


def _stock() -> Schema:
    place = _list({"type": "number"}, minItems=3, maxItems=3, description="X, Y, Z, mm.")
    volume = _number("Volume, mm3.", low=0.0)
    return _object(
        {
            "low_mm": place,
            "high_mm": place,
            "cell_mm": _length("Width of a cell"),
            "volume_mm3": volume,
            "removed_mm3": volume,
            "removed_by_tool_mm3": _map(volume, "What each tool has removed, by its number."),
            "removed_by_line_mm3": _list(_object({"program": _TEXT, "line": _LINE, "volume_mm3": volume})),
            "engagement": _engagement(),
            "collisions": _list(
                _object(
                    {
                        "kind": _TEXT,
                        "text": _TEXT,
                        "program": _TEXT,
                        "line": _LINE,
                        "time_s": _time("When it began"),
                        "place_mm": place,
                        "depth_mm": _length("Greatest depth"),
                    }
                )
            ),
            "idle_s": _time("Feed that removed nothing"),
            "idle": _list(
                _object(
                    {
                        "text": _TEXT,
                        "program": _TEXT,
                        "line": _LINE,
                        "time_s": _time("When it began"),
                        "duration_s": _time("For how long a block fed through air"),
                        "place_mm": place,
                    }
                )
            ),
            "target": _object(
                {
                    "tolerance_mm": _length("How far the part may differ"),
                    "gouge_mm3": volume,
                    "rest_mm3": volume,
                    "rest_mm": _length("The highest of what is left"),
                    "rest_place_mm": _list({"type": "number"}, maxItems=3, description="Where that is."),
                }
            ),
        },
        ("target",),
    )


def _engagement() -> Schema:
    most = {
        "rate_mm3_s": _or_null(_number("Greatest removal in a second, mm3/s.", low=0.0)),
        "axial_mm": _or_null(
            _length("Greatest depth of a cut, along the tool; of a turning tool towards the axis")
        ),
        "radial_mm": _or_null(_length("Greatest width of a cut; null: not known, as of turning tools")),
        "chip_mm": _or_null(_length("Greatest thickness of a chip; null: teeth or speed are not known")),
    }
    mean = _number("Mean removal in a second while it cut, mm3/s.", low=0.0)
    line = {
        "program": _TEXT,
        "line": _LINE,
        "cutting_s": _time("In the material"),
        "mean_mm3_s": mean,
        **most,
    }
    return _object({**most, "by_line": _list(_object(line))})


def _check() -> Schema:
    error = _object(
        {"text": _TEXT, "hint": _TEXT, "code": _TEXT, "file": _TEXT, "line": _LINE, "column": _LINE}
    )
    place = {"file": _TEXT, "line": _LINE, "column": _LINE}
    remark = _object({"text": _TEXT, "code": _TEXT, "count": _COUNT, **place})
    return _object(
        {
            "errors": _COUNT,
            "programs": _map(_list(error), "The errors of each program."),
            "remarks": _map(_list(remark), "What is no error and seldom meant, for each program."),
            "guessed": _map(_TEXT, "The dialect of a program and why it was guessed."),
            "unreadable": _map(_object({"text": _TEXT, "hint": _TEXT}), "Files that could not be read."),
        }
    )


def _comparison() -> Schema:
    distance = _or_null(_number("mm; null where the other side has nothing to be compared with.", low=0.0))
    deviation = _object(
        {
            "mm": distance,
            "position": _map({"type": "number"}, "Where, by axis, mm or degree."),
            "program": _TEXT,
            "line": _LINE,
            "time_s": _time("When"),
        }
    )
    side = _object(
        {
            "name": _TEXT,
            "machine": _TEXT,
            "ok": _FLAG,
            "time_s": _time("From the start to the end"),
            "path_mm": _length("The whole path"),
            "top_feed_mm_min": _or_null(
                _number("Highest speed of a cut, mm/min; null for a trace file.", low=0.0)
            ),
            "extents_mm": _EXTENTS,
            "cutting_time_s": _time("Cutting"),
            "cutting_path_mm": _length("All but rapids"),
            "tool_times": _TOOL_TIMES,
            "alarms": _list(_ALARM),
        },
        ("cutting_time_s", "cutting_path_mm", "tool_times", "alarms"),
    )
    place = _object({"program": _TEXT, "line": _LINE})
    block = _object({"line": _LINE, "text": _TEXT})
    return _object(
        {
            "ok": _FLAG,
            "tolerance_mm": _length("How far apart the paths may be"),
            "deviation_mm": distance,
            "a_from_b": deviation,
            "b_from_a": deviation,
            "cuts_a_from_b": _or_null(deviation),
            "cuts_b_from_a": _or_null(deviation),
            "same_order": _or_null(_FLAG),
            "parts_at": _or_null(_object({"a": place, "b": place})),
            "tools": _or_null(_list(_list({"type": "integer"}), minItems=2, maxItems=2)),
            "lone_axes": _list(_TEXT),
            "first_difference": _or_null(_object({"a": block, "b": block})),
            "a": side,
            "b": side,
        }
    )


def _batch() -> Schema:
    def row(*items: Schema) -> Schema:
        return {"type": "array", "prefixItems": list(items), "items": False, "minItems": len(items)}

    time, length, count = _or_null(_time("Time")), _or_null(_length("Length")), _or_null(_COUNT)
    number: Schema = {"type": "number"}
    report = _object(
        {
            "ok": _FLAG,
            "program": _TEXT,
            "machine": _TEXT,
            "dialect": _TEXT,
            "override_percent": _number("The feed override, %.", low=1.0),
            "tolerance_mm": _or_null(_length("How far the path may leave a corner; null: free")),
            "status": {"enum": ["ok", "error", "time-out", "memory", "lost"]},
            "time_s": time,
            "cutting_time_s": time,
            "rapid_time_s": time,
            "waiting_time_s": time,
            "path_mm": length,
            "cutting_path_mm": length,
            "top_feed_mm_min": _or_null(_number("mm/min", low=0.0)),
            "blocks": count,
            "cycles": count,
            "removed_mm3": _or_null(
                _number("What was removed of the stock, mm3; null: none was cut", low=0.0)
            ),
            "errors": _list(_TEXT),
            "messages": _list(_TEXT),
            "tools": _list(row(_COUNT, number, number), description="Tool, cutting and rapid time, s."),
            "extents": _list(row(_TEXT, number, number), description="Axis, lowest, highest position."),
            "slowest": _list(row(_COUNT, _TEXT, number), description="Line, block, time, s."),
        }
    )
    return _object({"programs": _COUNT, "ok": _COUNT, "done_before": _COUNT, "reports": _list(report)})


_SCHEMAS: dict[str, tuple[str, Callable[[], Schema]]] = {
    "run": ("polycnc run --json", _result),
    "check": ("polycnc check --json", _check),
    "compare": ("polycnc compare --json", _comparison),
    "batch": ("polycnc batch --json", _batch),
    "machine": ("machine file", MachineConfig.model_json_schema),
    "dialect": ("dialect file", Dialect.model_json_schema),
}
SCHEMAS = tuple(_SCHEMAS)
"""The names of the schemas: commands whose `--json` they describe, and files."""


def json_schema(name: str) -> Schema:
    """Return the JSON schema (2020-12) of what a command prints, or of a machine or dialect file.

    A machine file is TOML: its tables are objects, its dates texts.

    Raises:
        UsageError: there is no such schema.
    """
    if name not in _SCHEMAS:
        raise UsageError(
            f"there is no schema '{name}'",
            hint=f"{did_you_mean(name, SCHEMAS)}Schemas are: {', '.join(SCHEMAS)}.",
        )
    title, make = _SCHEMAS[name]
    return {"$schema": _DRAFT, **make(), "title": title}
