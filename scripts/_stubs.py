"""The type stubs of structures that headers declare and of functions that rows declare: what a type checker sees."""

import ctypes
import inspect
from importlib import import_module
from typing import Annotated, Any, get_args, get_origin

from polycnc.controllers.library import Element, Header

_HEAD = """# Written by scripts/reference from structures.h.
from ctypes import Array, c_double, c_int8, c_int16, c_int32, c_int64, c_uint8, c_uint16, c_uint32
from typing import Any, Final

from polycnc.controllers.library import Header, Structure, Union

HEADER: Header
"""


def stub(module: str) -> str:
    """Return the stub of a module that reads a header."""
    made = import_module(module)
    header: Header = made.HEADER
    lines = [f"{name}: Final = {value}\n" for name, value in header.constants.items()]
    for name, cls in header.classes.items():
        base = "Union" if issubclass(cls, ctypes.Union) else "Structure"
        fields = {each: _typed(element) for each, element in cls._table_.elements.items()}
        fields.update({each: python.__name__ for each, python in cls._table_.beside.items()})
        lines.append(f"class {name}({base}): " + "; ".join(f"{k}: {v}" for k, v in fields.items()) + "\n")
    public = getattr(made, "__all__", None)
    packings = "PACKINGS: dict[str, int | None]\n" if hasattr(made, "PACKINGS") else ""
    return _HEAD + packings + (f"__all__ = {public}\n" if public else "") + "".join(lines)


def functions_stub(module: str) -> str:
    """Return the stub of a module whose functions are made from rows."""
    made = import_module(module)
    lines, used = [], set[type]()
    for name in made.__all__:
        signature = inspect.signature(getattr(made, name))
        types = {each.name: _plain(each.annotation) for each in signature.parameters.values()}
        used |= {*types.values(), signature.return_annotation}
        arguments = ", ".join(f"{each}: {type_.__name__}" for each, type_ in types.items())
        lines.append(f"def {name}({arguments}) -> {signature.return_annotation.__name__}: ...\n")
    imports = sorted(f"from {each.__module__} import {each.__name__}\n" for each in used - {int, float, str})
    head = "# Written by scripts/reference from the rows.\n"
    return "".join([head, *imports, f"\n__all__ = {made.__all__}\n", *lines])


def _plain(hint: Any) -> type:
    made: type = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    return made


_FIXED = ("c_int8", "c_int16", "c_int32", "c_int64", "c_uint8", "c_uint16", "c_uint32")
_C = {getattr(ctypes, name): name for name in _FIXED}


def _typed(element: Element) -> str:
    if element.counts and element.ctype is not ctypes.c_char:
        return (
            "Array[Any]" if element.counts[1:] else f"Array[{_C.get(element.ctype, element.ctype.__name__)}]"
        )
    return "Any" if element.python is object else str(element.python.__name__)
