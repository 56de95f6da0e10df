"""Read TOML strictly: every problem names the file, the line, the key, and what to write instead.

A pydantic model says what is wrong, a `Locator` says where; `validate` joins the two.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args, get_origin

import annotated_types
from pydantic import BaseModel, ConfigDict, Tag, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails, PydanticCustomError

from polycnc.errors import ConfigurationError, SourcePosition
from polycnc.machine._toml_locator import KeyPath, Locator

M = TypeVar("M", bound=BaseModel)


MOST_NESTING = 32
"""How deep tables and arrays may lie in each other: ten times what any file needs."""

_TOO_DEEP = f"tables or arrays nested more than {MOST_NESTING} deep"
_PART = r"""(?:[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')[ \t]*"""
_LONG_KEY = re.compile(rf"^[ \t]*(?:\[\[?[ \t]*)?(?:{_PART}\.[ \t]*){{{MOST_NESTING}}}", re.MULTILINE)
_DEEP = re.compile(rf"(?:[\[{{][^\[\]{{}}\n]*){{{MOST_NESTING}}}")
_LONG_NUMBER = re.compile(r"[0-9_]{1000,}")


class StrictModel(BaseModel):
    """Base of every configuration table: unknown keys refused, no conversions, immutable, no NaN."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


def problem(message: str, *, hint: str = "", at: KeyPath = ()) -> PydanticCustomError:
    """Return the error a validator raises; `at` leads from the validated table to the key that is wrong."""
    return PydanticCustomError("problem", "{message}", {"message": message, "hint": hint, "at": at})


def load_toml(path: str | Path) -> tuple[dict[str, Any], Locator]:
    """Read a TOML file and return its data and the locator of its keys.

    Raises:
        ConfigurationError: The file cannot be read, is not UTF-8, or is not TOML.
    """
    try:
        text = Path(path).read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ConfigurationError(
            f"'{path}' is not UTF-8 text: byte {error.start} is invalid", hint="save the file as UTF-8"
        ) from error
    except (OSError, ValueError) as error:  # ValueError: no file can have this name
        why = error.strerror if isinstance(error, OSError) else error
        raise ConfigurationError(
            f"cannot read '{path}': {why}", hint="check the name and the access rights of the file"
        ) from error
    return parse_toml(text, str(path))


def parse_toml(text: str, file: str) -> tuple[dict[str, Any], Locator]:
    """Parse TOML text and return its data and the locator of its keys; `file` is the name used in errors.

    Raises:
        ConfigurationError: The text is not TOML, or nested deeper than any file needs.
    """
    if found := _LONG_KEY.search(text):  # tomllib would take hours for a key of a million parts
        raise _unreasonable(text, file, found.start(), _TOO_DEEP)
    try:
        data = tomllib.loads(text)
        if is_nested_beyond(data, MOST_NESTING):
            raise RecursionError
    except tomllib.TOMLDecodeError as error:
        what, line, column = _syntax_error(text, str(error))
        row = text.split("\n")[line - 1].rstrip("\r")
        raise ConfigurationError(
            what,
            hint="correct the line; a file is TOML: [table] headers and key = value lines",
            position=SourcePosition(file, line, column, row),
        ) from None
    except RecursionError:
        found = _DEEP.search(text)
        raise _unreasonable(text, file, found.start() if found else 0, _TOO_DEEP) from None
    except ValueError:  # Python reads no number of so many digits
        found = _LONG_NUMBER.search(text)
        what = "a number with more digits than any number needs"
        raise _unreasonable(text, file, found.start() if found else 0, what) from None
    return data, Locator(text, file)


def is_nested_beyond(data: object, levels: int) -> bool:
    """Tell whether tables and arrays lie deeper in each other than `levels`."""
    here: list[object] = [data]
    for _ in range(levels + 1):
        here = [
            inner
            for each in here
            if isinstance(each, Mapping | list)
            for inner in (each.values() if isinstance(each, Mapping) else each)
            if isinstance(inner, Mapping | list)
        ]
        if not here:
            return False
    return True


def _unreasonable(text: str, file: str, offset: int, what: str) -> ConfigurationError:
    line = text.count("\n", 0, offset) + 1
    begin = text.rfind("\n", 0, offset) + 1
    row = text[begin : text.find("\n", begin) if "\n" in text[begin:] else len(text)].rstrip("\r")
    position = SourcePosition(file, line, offset - begin + 1, row)
    return ConfigurationError(what, hint="correct the line", position=position)


def validate(model: type[M], data: Mapping[str, Any], locator: Locator) -> M:
    """Return `data` as an instance of `model`.

    Arrays reach the model as tuples, which is what a frozen model should hold.

    Raises:
        ConfigurationError: One or more keys are unknown, missing or wrong. Position and hint are those of the
            first in the file; the others follow, one per line.
    """
    try:
        return model.model_validate(_with_tuples(data))
    except ValidationError as error:
        problems = _without_echoes([_explain(model, data, locator, detail) for detail in error.errors()])
    first, *others = sorted(problems, key=lambda each: (each.position.line, each.position.column))
    also = [
        f"also {each.position}: {each.what}" + (f" ({each.hint})" if each.hint else "") for each in others
    ]
    hint = f"on line {first.position.line}: {first.hint}" if also and first.hint else first.hint
    parts = tuple(
        ConfigurationError(each.what, hint=each.hint, position=each.position) for each in (first, *others)
    )
    raise ConfigurationError(
        first.what, hint="\n".join([*also, hint]).strip("\n"), position=first.position, parts=parts
    )


def range_text(field: FieldInfo) -> str:
    """Return the numbers a field accepts, as "0 <= value <= 1"; empty if there is no bound."""
    low: tuple[object, str, str] | None = None
    high = ""
    for bound in _marks(field):
        match bound:
            case annotated_types.Gt(gt=limit):
                low = (limit, "<", ">")
            case annotated_types.Ge(ge=limit):
                low = (limit, "<=", ">=")
            case annotated_types.Lt(lt=limit):
                high = f" < {_number(limit)}"
            case annotated_types.Le(le=limit):
                high = f" <= {_number(limit)}"
            case _:
                pass
    if low is None:
        return f"value{high}" if high else ""
    limit = _number(low[0])
    return f"{limit} {low[1]} value{high}" if high else f"value {low[2]} {limit}"


def _number(limit: object) -> str:
    return f"{limit:g}" if isinstance(limit, float) else str(limit)


def _marks(field: FieldInfo) -> Iterator[object]:
    """Yield the marks on a field, also those on the X of `X | None`."""
    yield from field.metadata
    for choice in get_args(field.annotation):
        for mark in get_args(choice)[1:]:
            yield from mark.metadata if isinstance(mark, FieldInfo) else ()


def _syntax_error(text: str, message: str) -> tuple[str, int, int]:
    """Split a tomllib message into the words and a 1-based line and column."""
    lines = text.split("\n")
    if place := re.search(r" \(at line (\d+), column (\d+)\)$", message):
        line, column = int(place[1]), int(place[2])
        if line <= len(lines):
            return f"not valid TOML: {message[: place.start()]}", line, column
    what = message.removesuffix(" (at end of document)")
    return f"not valid TOML: {what} at the end of the file", len(lines), len(lines[-1]) + 1


@dataclass(frozen=True, slots=True)
class _Problem:
    path: KeyPath
    kind: str
    what: str
    hint: str
    position: SourcePosition


_WANTED = {
    "float_type": ("a number", "1.5"),
    "finite_number": ("a finite number", "1.5"),
    "int_type": ("a whole number", "2"),
    "int_from_float": ("a whole number", "2"),
    "bool_type": ("true or false", "true"),
    "string_type": ("text in quotes", '"text"'),
    "tuple_type": ("an array", "[...]"),
    "dict_type": ("a table", "{ ... }"),
    "model_type": ("a table", "{ ... }"),
    "date_type": ("a date", "2000-01-31"),
    "datetime_type": ("a date and time", "2000-01-31T12:00:00"),
}
_BOUNDS = {"greater_than": ">", "greater_than_equal": ">=", "less_than": "<", "less_than_equal": "<="}


def _explain(
    model: type[BaseModel], data: Mapping[str, Any], locator: Locator, detail: ErrorDetails
) -> _Problem:
    kind, context = detail["type"], detail.get("ctx", {})
    path = _data_path(data, detail["loc"], is_missing=kind == "missing") + tuple(context.get("at", ()))
    owner = _owner(model, detail["loc"])
    key = next((part for part in reversed(path) if isinstance(part, str)), "")
    field = _field(owner, key)
    shown = _as_toml(detail["input"])
    hint = ""
    match kind:
        case "problem":
            what, hint = context["message"], context["hint"]
        case "value_error":
            what = str(context["error"])
        case "extra_forbidden":
            what = f"unknown key '{key}' in {_table_name(path[:-1])}"
            hint = _suggest(key, _keys(owner))
        case "missing":
            what = f"{_table_name(path[:-1])} has no '{key}'"
            hint = f"add the line {_opening(field, key)}"
        case "string_pattern_mismatch":
            what = f"'{key}' cannot be {shown}"
            hint = f"allowed: {field.description}" if field and field.description else ""
        case "too_short" | "too_long" | "string_too_short" | "string_too_long":
            what = f"'{key}' {_length_text(context, 'character' if kind.startswith('string') else 'element')}"
        case "literal_error":
            what = f"'{key}' must be {context['expected']}, not {shown}"
            hint = _suggest(str(detail["input"]), re.findall(r"'([^']*)'", context["expected"]))
        case _ if kind in _BOUNDS:
            allowed = range_text(field) if field else ""
            what = f"'{key}' is {shown}, which is out of range"
            limit = next(iter(context.values()), "")
            hint = f"allowed: {(allowed or f'value {_BOUNDS[kind]} {limit}').replace('value', key)}"
        case _ if kind in _WANTED:
            wanted, example = _wanted(kind, field, key)
            is_element = bool(path) and isinstance(path[-1], int)
            what = f"{'an element of ' if is_element else ''}'{key}' must be {wanted}, not {shown}"
            hint = f"write {wanted}, like {example}"
        case _:
            what = f"'{key}': {detail['msg'][:1].lower()}{detail['msg'][1:]}"
    return _Problem(path, kind, what, hint, locator.position(path))


def _wanted(kind: str, field: FieldInfo | None, key: str) -> tuple[str, str]:
    """Return what a key has to be, and how that is written."""
    if kind == "tuple_type" and (opening := _opening(field, key)).startswith("[["):
        return "an array of tables", opening
    return _WANTED[kind]


def _length_text(context: Mapping[str, Any], what: str) -> str:
    for bound, word in (("min_length", "at least"), ("max_length", "at most")):
        if (count := context.get(bound)) is not None:
            return f"must have {word} {count} {what}{'s' if count != 1 else ''}"
    return "has the wrong length"


def _without_echoes(problems: list[_Problem]) -> list[_Problem]:
    """Drop what follows from another problem.

    That is "has no 'speed'" where the same table has an unknown key whose hint already says 'speed', and an array that
    is too short only because its elements are wrong.
    """
    wrong = {each.path[:length] for each in problems for length in range(len(each.path))}
    suggested = {
        (*each.path[:-1], key)
        for each in problems
        if each.kind == "extra_forbidden"
        for key in re.findall(r"did you mean '([^']*)'", each.hint)
    }
    echoes = {"missing": suggested, "too_short": wrong}
    return [each for each in problems if each.path not in echoes.get(each.kind, ())]


def _suggest(key: str, known: Sequence[str]) -> str:
    from difflib import get_close_matches

    if close := get_close_matches(key, known, n=1):
        return f"did you mean '{close[0]}'?"
    return f"known here: {', '.join(known)}" if known else ""


def _opening(field: FieldInfo | None, key: str) -> str:
    """Return how a table or a key is begun in the file."""
    annotation = field.annotation if field else None
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return f"[{key}]"
    if get_origin(annotation) is tuple:
        element = get_args(annotation)[0]  # a model, or a choice of models with tags
        is_model = isinstance(element, type) and issubclass(element, BaseModel)
        if is_model or get_origin(element) is not None:
            return f"[[{key}]]"
    return f"'{key} = ...'"


def _table_name(path: KeyPath) -> str:
    if not path:
        return "the file"
    name = ".".join(part for part in path if isinstance(part, str))
    return f"[[{name}]]" if isinstance(path[-1], int) else f"[{name}]"


def _as_toml(value: object) -> str:
    if isinstance(value, Mapping | BaseModel):
        return "a table"
    if isinstance(value, tuple):
        return f"[{', '.join(map(_as_toml, value))}]"
    shown = json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else str(value)
    return shown if len(shown) <= 40 else f"{shown[:37]}..."


def _with_tuples(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _with_tuples(each) for key, each in value.items()}
    if isinstance(value, list):
        return tuple(_with_tuples(each) for each in value)
    return value


def _data_path(data: Any, loc: tuple[str | int, ...], *, is_missing: bool) -> KeyPath:
    """Strip from a pydantic location what is not in the data: union tags and "[key]" marks."""
    path: KeyPath = ()
    for depth, part in enumerate(loc, 1):
        is_element = isinstance(data, list | tuple) and isinstance(part, int) and part < len(data)
        if is_element or (isinstance(data, Mapping) and part in data):
            data = data[part]
            path += (part,)
        elif is_missing and depth == len(loc):
            path += (part,)
    return path


def _owner(model: type[BaseModel], loc: tuple[str | int, ...]) -> type[BaseModel] | None:
    """Follow a pydantic location through the annotations to the model that holds its last key."""
    node: Any = model
    for part in loc[:-1]:
        node = _step(node, part)
    node = _bare(node)
    return node if isinstance(node, type) and issubclass(node, BaseModel) else None


def _step(node: Any, part: str | int) -> Any:
    node = _bare(node)
    if isinstance(node, type) and issubclass(node, BaseModel):
        field = _field(node, str(part))
        return field.annotation if field else None
    choices = get_args(node)
    if get_origin(node) is tuple:
        return choices[0] if choices[-1] is Ellipsis else choices[min(int(part), len(choices) - 1)]
    if get_origin(node) is dict:
        return choices[1]
    tagged = [
        each for each in choices if any(isinstance(mark, Tag) and mark.tag == part for mark in get_args(each))
    ]
    # `X | None`: pydantic names no tag, so the step belongs to X itself.
    return (
        tagged[0] if tagged else next((_step(each, part) for each in choices if each is not type(None)), None)
    )


def _bare(node: Any) -> Any:
    while get_origin(node) is Annotated:
        node = get_args(node)[0]
    return node


def _keys(owner: type[BaseModel] | None) -> list[str]:
    return [] if owner is None else [field.alias or name for name, field in owner.model_fields.items()]


def _field(owner: type[BaseModel] | None, key: str) -> FieldInfo | None:
    fields = {} if owner is None else owner.model_fields
    return next((field for name, field in fields.items() if key in (name, field.alias)), None)
