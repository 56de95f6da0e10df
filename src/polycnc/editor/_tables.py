"""TOML files of polycnc: what is wrong with them, what their keys mean, their completion and outline."""

from __future__ import annotations

import re
from collections.abc import Iterator
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from polycnc.editor._codes import Completion
from polycnc.editor._kinds import Kind, model_of
from polycnc.editor._names import VARIABLE, Name, Role
from polycnc.editor._outline import Symbol, sections
from polycnc.editor._place import MOST_LINE, Span
from polycnc.errors import ConfigurationError, UsageError
from polycnc.machine import MachineConfig, parse_toml, range_text, validate
from polycnc.nc import Dialect

_HEADER = re.compile(r"[ \t]*\[{1,2}([^\[\]#]*)\]{0,2}")
_KEY = re.compile(r"""[ \t]*(["']?)([^\s=\[\]"'#]+)\1[ \t]*(=?)""")
_PART = re.compile(r"""[ \t]*(?:"([^"]*)"|'([^']*)'|([^.\s]+))[ \t]*(?:\.|\Z)""")


def problems(text: str, name: str, kind: Kind) -> list[ConfigurationError]:
    """Return everything that is wrong with a TOML file, as what loads it says it."""
    try:
        if kind is Kind.CONTROL:
            from polycnc.post import parse_control

            parse_control(text, name)
        elif kind is Kind.MACHINE:
            validate(MachineConfig, *parse_toml(text, name))
        elif kind is Kind.DIALECT:
            validate(Dialect, *parse_toml(text, name))
    except ConfigurationError as error:
        return list(error.parts or (error,))
    except UsageError as error:
        return [ConfigurationError(error.what, hint=error.hint)]
    return []


def key_hover(lines: list[str], line: int, character: int, kind: Kind) -> tuple[str, Span] | None:
    """Return what the key or table at a place means, as Markdown, and where it stands."""
    model = model_of(kind)
    if model is None or not 0 <= line < len(lines) or len(lines[line]) > MOST_LINE:
        return None
    if header := _HEADER.match(lines[line]):
        parts = _parts(header[1])
        span = Span(line, header.start(1), header.end(1))
    elif (key := _KEY.match(lines[line])) and key[3] and not _in_text(lines, line):
        parts = [*_table_at(lines, line), *_parts(key[2])]
        span = Span(line, key.start(2), key.end(2))
    else:
        return None
    if not span.begin <= character <= span.end or not parts:
        return None
    for field in _fields(model, parts):
        allowed = range_text(field)
        lines_of_text = [f"**{parts[-1]}**: {field.description or 'a table'}"]
        lines_of_text += [f"Range: {allowed.replace('value', parts[-1])}"] if allowed else []
        if not field.is_required() and isinstance(field.default, str | int | float | bool):
            lines_of_text.append(f"Default: {field.default}")
        return "  \n".join(lines_of_text), span
    return None


def key_completions(lines: list[str], line: int, character: int, kind: Kind) -> list[Completion]:
    """Return the keys that the table at a place may have, or the values of the key that stands before it."""
    model = model_of(kind)
    if model is None or not 0 <= line < len(lines) or len(lines[line]) > MOST_LINE:
        return []
    before = lines[line][:character]
    if before.lstrip().startswith("["):
        return [
            Completion(field.alias or name, field.description or "")
            for name, field in model.model_fields.items()
            if any(True for _ in _models(field.annotation))
        ]
    key = _KEY.match(before)
    if key is not None and key[3]:
        fields = _fields(model, [*_table_at(lines, line), *_parts(key[2])])
        return [Completion(value, "") for field in fields for value in _choices(field.annotation)]
    if _in_text(lines, line):
        return symbols_of_macros(lines)
    found: dict[str, Completion] = {}
    for each in _inside(model, _table_at(lines, line)):
        for name, field in each.model_fields.items():
            found.setdefault(field.alias or name, Completion(field.alias or name, field.description or ""))
    return list(found.values())


_SYMBOL = re.compile(r"[ \t]*([A-Z][A-Z0-9_]*)[ \t]*=")


def symbols_of_macros(lines: list[str]) -> list[Completion]:
    """Return what the macros of a control file may name: its codes, function variables and macros."""
    table = ""
    found = {}
    for line in lines:
        if header := _HEADER.match(line):
            table = header[1].strip()
        elif (symbol := _SYMBOL.match(line)) and table not in ("", "parameters"):
            found[symbol[1]] = Completion(symbol[1], f"[{table}]")
    return list(found.values())


def control_names(lines: list[str]) -> list[Name]:
    """Return the names of a control file: where a table gives them, and where macros use them."""
    known = {each.label for each in symbols_of_macros(lines)}
    found = []
    marks = 0
    for number, line in enumerate(lines):
        if len(line) > MOST_LINE:
            continue
        symbol = _SYMBOL.match(line) if marks % 2 == 0 else None
        for word in _WORD.finditer(line):
            given = symbol is not None and word.start() == symbol.start(1)
            if word[0] in known and (given or marks % 2):
                role = Role.GIVEN if given else Role.USED
                found.append(Name(VARIABLE, word[0], Span(number, *word.span()), role))
        marks += line.count("'''") + line.count('"""')
    return found


_WORD = re.compile(r"\b[A-Z][A-Z0-9_]*\b")


def table_outline(lines: list[str]) -> list[Symbol]:
    """Return the tables of a file."""
    heads = [
        Symbol(header[1].strip(), "", True, number)
        for number, line in enumerate(lines)
        if len(line) <= MOST_LINE and (header := _HEADER.match(line)) and header[1].strip()
    ]
    return sections(heads, len(lines))


def _table_at(lines: list[str], line: int) -> list[str]:
    for above in range(line, -1, -1):
        if len(lines[above]) <= MOST_LINE and (header := _HEADER.match(lines[above])):
            return _parts(header[1])
    return []


def _in_text(lines: list[str], line: int) -> bool:
    """Tell whether a line lies within a text of several lines, like a macro."""
    marks = sum(each.count("'''") + each.count('"""') for each in lines[:line])
    return marks % 2 == 1


def _parts(key: str) -> list[str]:
    from polycnc.post import SECTIONS

    found = [each[1] or each[2] or each[3] for each in _PART.finditer(key)]
    return [SECTIONS.get(found[0], found[0]), *found[1:]] if found else []


def _fields(model: type[BaseModel], parts: list[str]) -> list[FieldInfo]:
    """Return the fields that a key may be: in tables of several kinds, each of them."""
    *tables, key = parts
    return [
        field
        for each in _inside(model, tables)
        for name, field in each.model_fields.items()
        if key in (name, field.alias)
    ]


def _inside(model: type[BaseModel], tables: list[str]) -> list[type[BaseModel]]:
    nodes: list[Any] = [model]
    for part in tables:
        after: list[Any] = []
        for node in nodes:
            if isinstance(node, type) and issubclass(node, BaseModel):
                after += [
                    field.annotation
                    for name, field in node.model_fields.items()
                    if part in (name, field.alias)
                ]
            else:
                after.append(get_args(node)[1])
        nodes = [found for each in after for found in _models(each)]
    return [node for node in nodes if isinstance(node, type)]


def _models(annotation: Any) -> Iterator[Any]:
    """Yield the tables that an annotation allows: models, and dictionaries of them."""
    origin = get_origin(annotation)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    elif origin is Annotated:
        yield from _models(get_args(annotation)[0])
    elif origin is dict:
        yield annotation
    elif origin in (Union, UnionType, tuple):
        for each in get_args(annotation):
            yield from _models(each)


def _choices(annotation: Any) -> Iterator[str]:
    """Yield the texts that an annotation allows, as TOML writes them."""
    if get_origin(annotation) is Literal:
        yield from (f'"{each}"' for each in get_args(annotation) if isinstance(each, str))
    elif annotation is bool:
        yield from ("true", "false")
    else:
        for each in get_args(annotation):
            yield from _choices(each)
