"""The tables of the dialects' page: the keys of a dialect and the rows of the codes. The prose is written by hand."""

import json
import re
from pathlib import Path

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from polycnc.nc import DIALECTS, Action, Dialect, MAction, load_dialect

PAGE = Path(__file__).resolve().parents[1] / "docs" / "reference" / "dialects.md"


def page() -> str:
    """Return the page with its tables written anew: each stands in the section of its heading."""
    text = PAGE.read_text(encoding="utf-8")
    for heading, rows in _tables().items():
        head, begin, section = text.partition(f"\n## {heading}\n")
        if not begin:
            raise ValueError(f"the page has no section '{heading}'")
        section, end, tail = section.partition("\n## ")
        table = "".join(f"{row}\n" for row in rows).replace("\\", r"\\")
        text = head + begin + re.sub(r"(?:^\|.*\n)+", table, section, count=1, flags=re.M) + end + tail
    return text


def _tables() -> dict[str, list[str]]:
    tables = {"The file": _keys(Dialect), "Actions of G codes": _g_codes(), "Actions of M codes": _m_codes()}
    for key, field in Dialect.model_fields.items():
        if isinstance(field.default, BaseModel):
            tables[f"`[{key}]`"] = _keys(type(field.default))
    return tables


def _keys(model: type[BaseModel]) -> list[str]:
    fields = model.model_fields.items()
    rows = [f"| `{key}` | {_default(field)} | {field.description} |" for key, field in fields]
    return ["| key | default | meaning |", "| --- | --- | --- |", *rows]


def _default(field: FieldInfo) -> str:
    value = field.default
    if field.is_required():
        return "required"
    if isinstance(value, BaseModel):
        return "defaults"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {json.dumps(each)}" for key, each in value.items()) + " }"
    return json.dumps(value, ensure_ascii=False)


def _g_codes() -> list[str]:
    tables = [load_dialect(name).g for name in DIALECTS]
    rows = [
        f"| `{each.title}` | {each.sentence} | {', '.join(each.takes) or '-'} | {each.group} | "
        f"{_codes(tables, 'G', each.title)} |"
        for each in Action
    ]
    return [*_head("action", "what it does", "words", "group"), *rows]


def _m_codes() -> list[str]:
    tables = [load_dialect(name).m for name in DIALECTS]
    rows = [
        f"| `{each.title}` | {each.group or '-'} | {_codes(tables, 'M', each.title)} |" for each in MAction
    ]
    return [*_head("action", "group"), *rows]


def _head(*columns: str) -> list[str]:
    names = (*columns, *DIALECTS)
    return [f"| {' | '.join(names)} |", f"| {' | '.join('---' for _ in names)} |"]


def _codes(tables: list[dict[str, str]], letter: str, action: str) -> str:
    found = (sorted(float(code) for code, name in table.items() if name == action) for table in tables)
    return " | ".join(" ".join(f"{letter}{code:g}" for code in codes) or "-" for codes in found)
