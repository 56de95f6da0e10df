"""Write the reference page of control files from the tables that read them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from types import UnionType
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from polycnc.errors import ConfigurationError
from polycnc.post.macros._control_file import CONTROLS, load_control, parse_control
from polycnc.post.macros._control_parameters import (
    SECTIONS,
    CodeKey,
    ControlTables,
    FunctionVariable,
    NcCode,
    Parameters,
)
from polycnc.post.macros._expression import EQUAL_WITHIN, LOGICAL_OPERATORS, NESTED_PARENTHESES
from polycnc.post.macros._macro import NESTED_IFS
from polycnc.post.macros._parameters import FiveAxis, RotaryAxis
from polycnc.post.macros._reference_text import (
    AFTER_SECTIONS,
    ELEMENTS,
    ENTRIES,
    INTRODUCTION,
    LANGUAGE,
    MISTAKEN,
    RULINGS,
)

_ENTRIES: tuple[tuple[str, str, type[BaseModel]], ...] = (
    ("`[parameters]`", ENTRIES["parameters"], Parameters),
    ("`[parameters.five_axis]`", ENTRIES["five_axis"], FiveAxis),
    ("`[[parameters.five_axis.axis]]`", ENTRIES["rotary_axis"], RotaryAxis),
    ("`[nc_code]`", ENTRIES["nc_code"], NcCode),
    ("`[g_code]` and `[m_code]`", ENTRIES["codes"], CodeKey),
    ("`[function_variables]`", ENTRIES["function_variables"], FunctionVariable),
)


def control_file_reference() -> str:
    """Return the Markdown page that explains control files and the language of their macros."""
    limits = {
        "nested_ifs": NESTED_IFS,
        "operators": LOGICAL_OPERATORS,
        "equal": f"{EQUAL_WITHIN:.4f}",
        "parentheses": NESTED_PARENTHESES,
    }
    parts = [INTRODUCTION.format(error=_error()), _shipped(), "## Sections\n\n" + _sections(), AFTER_SECTIONS]
    for title, text, model in _ENTRIES:
        rows = [_key_row(name, field) for name, field in model.model_fields.items()]
        parts.append(f"## {title}\n\n{text}\n\n" + _table(("key", "value", "default", "meaning"), rows))
    parts += ["## `[nc_macros]`\n\n" + ENTRIES["nc_macros"], "## Elements\n\n" + ELEMENTS]
    parts += [LANGUAGE.format(**limits), "## Rulings\n\n" + _table(("ruling", "reading", "where"), RULINGS)]
    return "\n\n".join(part.strip("\n") for part in parts) + "\n"


def _error() -> str:
    try:
        parse_control(MISTAKEN, "mill.toml")
    except ConfigurationError as error:
        return str(error)
    raise AssertionError


def _shipped() -> str:
    rows = []
    for name in CONTROLS:
        parameters = load_control(name).parameters
        kept = (name, parameters.description, parameters.dialect, parameters.machine, parameters.extension)
        rows.append(tuple(f"`{cell}`" if index != 1 else cell for index, cell in enumerate(kept)))
    return _table(("control file", "what for", "dialect", "machine", "extension"), rows)


def _sections() -> str:
    rows = [
        (f"`[{name}]`", title, ControlTables.model_fields[name].description or "")
        for title, name in SECTIONS.items()
    ]
    return _table(("section", "the manual's name", "holds"), rows)


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _key_row(name: str, field: FieldInfo) -> tuple[str, ...]:
    return f"`{name}`", _value(field.annotation), _default(field), field.description or ""


_PLAIN = {float: "number", int: "whole number", bool: "true or false", str: "text"}


def _value(annotation: Any) -> str:
    choices = get_args(annotation)
    match get_origin(annotation):
        case origin if origin is Literal:
            return ", ".join(json.dumps(choice) for choice in choices)
        case origin if origin is Annotated:
            return _value(choices[0])
        case origin if origin is UnionType:
            return " or ".join(_value(choice) for choice in choices if choice is not type(None))
        case origin if origin is tuple:
            each = _value(choices[0])
            return f"list of {each}" if choices[-1] is Ellipsis else f"list of {len(choices)} {each}s"
        case origin if origin is dict:
            return f"table of {_value(choices[0])}"
        case _ if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            return "table"
        case _:
            return _PLAIN[annotation]


def _default(field: FieldInfo) -> str:
    value = field.default
    if field.is_required():
        return "required"
    if value is None:
        return "none"
    if value == {}:
        return "empty"
    return f"{value:g}" if isinstance(value, float) else json.dumps(value)
