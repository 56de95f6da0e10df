"""The C header of a library: constants, structures, prototypes."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from typing import Any

from polycnc.controllers.library._functions import Argument, Direction, Function
from polycnc.controllers.library.clib._slots import CLibrary

_BEGIN = """\
/* {name}: the functions, structures and constants of the library, for C11 and C++17.

   Written by polycnc clib {kind}. `PC_LONG` has 32 bits: where long is wider, it is int. */
#ifndef POLYCNC_{guard}_H
#define POLYCNC_{guard}_H

#include <limits.h>
#include <stddef.h>
#include <stdint.h>

#if LONG_MAX == 2147483647L
typedef long PC_LONG;
typedef unsigned long PC_ULONG;
#else
typedef int PC_LONG;
typedef unsigned int PC_ULONG;
#endif

#if defined(_WIN32) && {stdcall}
#define PC_CALL __stdcall
#else
#define PC_CALL
#endif
#if defined(_WIN32)
#if defined(PC_BUILDS)
#define PC_API
#else
#define PC_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define PC_API __attribute__((visibility("default")))
#else
#define PC_API
#endif

#ifdef __cplusplus
extern "C" {{
#define PC_ASSERT static_assert
#else
#define PC_ASSERT _Static_assert
#endif

"""
_END = """
#undef PC_ASSERT
#ifdef __cplusplus
}
#endif
#endif
"""
_TYPES = {
    "long": "PC_LONG",
    "unsigned long": "PC_ULONG",
    "__int64": "int64_t",
}  # of 8 bytes at an address that 8 divides, where the packing lets it


def write_header(library: CLibrary) -> str:
    """Return the text of the header."""
    begin = _BEGIN.format(
        name=library.name, kind=library.kind, guard=library.name.upper(), stdcall=int(library.stdcall)
    )
    parts = [
        begin,
        *(f"#define {name} {_value(value)}\n" for name, value in library.constants.items()),
        "\n",
        *_typedefs(library),
        "\n",
        *_structures(library),
        "\n",
        library.declarations,
        "\n",
        *_prototypes(library),
        _END,
    ]
    return "".join(parts)


def _value(value: int) -> str:
    return f"({value})" if value < 0 else str(value)


def c_type(c: str) -> str:
    """Return a type of the tables as the header writes it."""
    stars = "*" * c.count("*")
    plain = c.replace("*", "").strip()
    return f"{_TYPES.get(plain, plain)} {stars}".strip()


def declared(c: str, name: str) -> str:
    """Return a declaration."""
    made = c_type(c)
    return f"{made}{'' if made.endswith('*') else ' '}{name}"


def prototype(library: CLibrary, function: Function, name: str = "") -> str:
    """Return a function's head; a text that it only reads is constant, so that C++ may pass a literal."""
    arguments = (
        ", ".join(_constant(each) + declared(each.c, each.name) for each in function.arguments) or "void"
    )
    return f"PC_API {c_type(function.result)} PC_CALL {name or function.name}({arguments})"


def _constant(argument: Argument) -> str:
    return "const " if argument.direction is Direction.IN and c_type(argument.c) == "char *" else ""


def _prototypes(library: CLibrary) -> Iterator[str]:
    for _, each in sorted(library.functions.items()):
        yield f"{prototype(library, each)};\n"
    for alias, name in sorted(library.aliases.items()):
        yield f"{prototype(library, library.functions[name], alias)};\n"


def _typedefs(library: CLibrary) -> Iterator[str]:
    for name, old in library.header.typedefs.items():
        yield f"typedef {c_type(old)} {name};\n"


def _structures(library: CLibrary) -> Iterator[str]:
    for name, cls in library.classes.items():
        yield from _structure(name, cls)


def _structure(name: str, cls: Any) -> Iterator[str]:
    table = cls._table_
    kind = "union" if issubclass(cls, ctypes.Union) else "struct"
    yield f"#pragma pack(push, {table.pack or 8})\ntypedef {kind} {name.lower()} {{\n"
    for member, each in table.elements.items():
        counts = "".join(f"[{count}]" for count in each.counts)
        c = each.c if not each.held else "void *"
        yield f"    {declared(c, member)}{counts};\n"
    yield f"}} {name};\n#pragma pack(pop)\n"
    if any(each.held for each in table.elements.values()):
        return  # its size is that of the program's pointers
    yield f'PC_ASSERT(sizeof({name}) == {ctypes.sizeof(cls)}, "{name}");\n'
    for member in table.elements:
        offset = getattr(cls, member).offset
        yield f'PC_ASSERT(offsetof({name}, {member}) == {offset}, "{name}.{member}");\n'
