"""The reference page of the keys of an APCI system file, made from the model that reads it."""

from collections.abc import Iterator
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic_core import PydanticUndefined

from polycnc.controllers.apci import SystemFile

_HEAD = """# APCI system file

<!-- Written by scripts/reference. -->

What stands for `system.dat` is a text file in TOML. Every key has a default, so an empty file is a board with three
servo axes; an unknown key is an error. `InitMcuSystem3` and `txbf2` load it, `SystemFile`, `load_system_file` and
`parse_system_file` of `polycnc.controllers.apci` make it in Python, and `system_file_text` writes it.

```toml
sample_time_us = 1280

[[axis]]
name = "X"
jac = 500.0

[axis.plant]
reference = [-5.0, 0.0]

[inputs]
3 = { functions = ["REF"], axes = ["X"] }
```
"""


def page() -> str:
    """Return the page."""
    return _HEAD + "\n".join(_tables(SystemFile, ""))


def _tables(model: type[BaseModel], path: str) -> Iterator[str]:
    inner: list[tuple[type[BaseModel], str]] = []
    yield f"\n## {path or 'The file'}\n"
    yield (model.__doc__ or "").strip() + "\n"
    yield "| key | value | default | meaning |"
    yield "| --- | --- | --- | --- |"
    for name, field in model.model_fields.items():
        key = field.alias or name
        below = _model_in(field.annotation)
        if below is not None:
            brackets = "[[{}]]" if get_origin(field.annotation) is tuple else "[{}]"
            inner.append((below, brackets.format(f"{path.strip('[]')}.{key}".lstrip("."))))
        default = "" if field.default is PydanticUndefined or below is not None else _shown(field.default)
        yield f"| `{key}` | {_kind(field.annotation)} | {default} | {field.description} |"
    for below, where in inner:
        yield from _tables(
            below, where.replace("inputs]", "inputs] number =").replace("outputs]", "outputs] number =")
        )


def _model_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for each in get_args(annotation) if (found := _model_in(each)) is not None), None)


def _kind(annotation: Any) -> str:
    if get_origin(annotation) is Literal:
        return ", ".join(f'`"{each}"`' for each in get_args(annotation))
    if _model_in(annotation) is not None:
        return "tables" if get_origin(annotation) is tuple else "table"
    if get_origin(annotation) in (tuple, dict):
        return "list" if get_origin(annotation) is tuple else "table"
    names = {int: "whole number", float: "number", str: "text", bool: "`true`, `false`"}
    if annotation in names:
        return names[annotation]
    return next((_kind(each) for each in get_args(annotation) if each is not type(None)), "value")


def _shown(value: object) -> str:
    if value is None or value in ((), {}):
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    return f'`"{value}"`' if isinstance(value, str) else f"`{value}`"
