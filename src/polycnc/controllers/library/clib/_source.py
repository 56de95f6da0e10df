"""The C source of a library: one function for each of the table, on what all share."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.resources import files

from polycnc.controllers.library._c_types import Opaque
from polycnc.controllers.library._functions import Function
from polycnc.controllers.library.clib._header_text import c_type, prototype
from polycnc.controllers.library.clib._slots import Call, CLibrary, Slot, Way

PORT = 8194
HELLO = 60
"""Bytes of what a library says first."""

_VERSION_SIZE = 16
_IN_PROCESS = "machines in the program's process call no routine of it"


def write_source(library: CLibrary, version: str, python: str = "") -> str:
    """Return the text of the source; `version` is what the library calls itself.

    `python` is the interpreter of machines in the program's own process, "" where they are served.
    """
    carrier = _text("inside.c" if python else "sockets.c")
    by_name = {each.function.name: each for each in library.calls}
    listens = bool(library.interrupts) and not python
    interrupts = _text("interrupts.c") if listens else ""
    bodies = []
    for name, function in sorted(library.functions.items()):
        if name in library.interrupts:
            bodies.append(
                _of_routine(library, by_name[name]) if listens else _left_out(library, function, _IN_PROCESS)
            )
        elif name in by_name:
            bodies.append(_function(library, by_name[name]))
        else:
            bodies.append(_left_out(library, function, library.left_out[name]))
    bodies += [
        _alias(library, alias, library.functions[name]) for alias, name in sorted(library.aliases.items())
    ]
    return "\n".join(
        (
            *_head(library, version, python),
            _text("common.c"),
            carrier,
            _text("runtime.c"),
            f'#include "{library.name}.h"\n',
            interrupts,
            library.helpers,
            *bodies,
        )
    )


def _text(name: str) -> str:
    return files(__package__).joinpath(name).read_text("utf-8")


def _head(library: CLibrary, version: str, python: str) -> Iterator[str]:
    table = ", ".join(f"0x{byte:02x}" for byte in library.table_hash)
    yield f"/* {library.name}: calls to served machines. Written by polycnc clib {library.kind}. */"
    yield "#define PC_BUILDS"
    for name, value in (
        ("PC_NAME", f'"{library.name}"'),
        ("PC_VERSION", f'"{version[: _VERSION_SIZE - 1]}"'),
        ("PC_PORT", f'"{PORT}"'),
        ("PC_PACKING", f"{library.packing} /* 0: each structure as the manual has it */"),
        ("PC_HELLO_SIZE", HELLO),
        ("PC_HANDLES", int(bool(library.through))),
        ("PC_INTERRUPTS", int(bool(library.interrupts) and not python)),
        ("PC_CODE_NOBODY", f"({library.nobody})"),
        ("PC_CODE_LOST", f"({library.lost})"),
        ("PC_CODE_NULL", f"({library.null})"),
        ("PC_CODE_HANDLE", f"({library.handle})"),
    ):
        yield f"#define {name} {value}"
    if python:
        escaped = python.replace("\\", "\\\\").replace('"', '\\"')
        yield f'#define PC_IN_PROCESS\n#define PC_PYTHON "{escaped}"'
    yield f"static const unsigned char pc_table[16] = {{{table}}};"


def _way_of(library: CLibrary, function: Function) -> str:
    if function.name == library.opens_at:
        return "PC_OPENS_AT"
    if function.name == library.frees:
        return "PC_FREES"
    if function.name in library.opens:
        return "PC_OPENS"
    first = function.arguments[0].name if function.arguments else ""
    return "PC_THROUGH" if library.through and first == library.through else "PC_PLAIN"


def _function(library: CLibrary, call: Call) -> str:
    function = call.function
    before, after = list[str](), list[str]()
    rows = [_row(slot, before, after) for slot in call.slots]
    given, count = ("given", len(rows)) if rows else ("0", 0)
    lines = [f"{prototype(library, function)}", "{", *before]
    if function.name in library.extensions:  # they return nothing
        lines.append(f"    if (!{library.is_extended.format(function.arguments[0].name)})\n        return;")
    if rows:
        lines += ["    pc_argument given[] = {", *(f"        {row}," for row in rows), "    };"]
    told = f"pc_call({call.number}, {_way_of(library, function)}, {given}, {count})"
    if function.result == "void":
        lines += [f"    {told};", *after]
    else:
        member = "real" if function.result == "double" else "whole"
        value = f"result.{member}"
        if not function.coded or function.name in library.failures:
            value = f"(result.failed ? {library.failures.get(function.name, 0)} : {value})"
        lines += [f"    pc_result result = {told};", *after]
        lines += [f"    return ({c_type(function.result)}){value};"]
    return "\n".join((*lines, "}", ""))


def _row(slot: Slot, before: list[str], after: list[str]) -> str:
    """Return what says where an argument lies; a handle, as wide as a pointer, travels as 32 bits."""
    name = slot.argument.name
    if slot.holder:
        place = f"{slot.holder} ? {slot.holder}->{slot.member} : 0"
        return (
            f"{{PC_WRITE, 0, 0, {place}, {slot.room}}}"
            if slot.writes
            else f"{{PC_READ, {place}, {slot.size}, 0, 0}}"
        )
    if _holds(slot):
        return _without_pointers(slot, before)
    opaque = isinstance(slot.argument.type, Opaque)
    if slot.way is Way.VALUE:
        if opaque:
            before.append(f"    uint32_t {name}_ = pc_opaque({name});")
            name += "_"
        return f"{{PC_VALUE, &{name}, {slot.width}, 0, 0}}"
    if opaque:
        before.append(f"    uint32_t {name}_ = 0;")
        after.append(f"    if ({name} && {name}_)")
        after.append(f"        *{name} = (IMC_HANDLE)(uintptr_t){name}_;")
        return f"{{PC_WRITE, 0, 0, {name} ? &{name}_ : 0, {slot.width}}}"
    what = {(True, False): "PC_READ", (False, True): "PC_WRITE", (True, True): "PC_BOTH"}
    read = f"{name}, {slot.size}" if slot.reads else "0, 0"
    written = f"{name}, {slot.room}" if slot.writes else "0, 0"
    return f"{{{what[slot.reads, slot.writes]}, {read}, {written}}}"


def _holds(slot: Slot) -> bool:
    return slot.way is Way.RECORD and any(each.held for each in slot.element._table_.elements.values())


def _without_pointers(slot: Slot, before: list[str]) -> str:
    """Return what says where a structure lies whose pointers stay here: a copy of all else."""
    name = slot.argument.name
    before.append(f"    unsigned char {name}_[{slot.width}] = {{0}};")
    before.append(f"    if ({name}) {{")
    for member, each in slot.element._table_.elements.items():
        if not each.held:
            place = getattr(slot.element, member)
            before.append(f"        memcpy({name}_ + {place.offset}, &{name}->{member}, {place.size});")
    before.append("    }")
    return f"{{PC_READ, {name} ? {name}_ : 0, {slot.width}, 0, 0}}"


def _of_routine(library: CLibrary, call: Call) -> str:
    """Return a function that installs the program's routine, or removes it."""
    which = f"pc_set_routine({call.number}, {call.slots[0].argument.name})" if call.slots else ""
    told = which or f"pc_reset_routine({call.number})"
    return f"{prototype(library, call.function)}\n{{\n    return {told};\n}}\n"


def _left_out(library: CLibrary, function: Function, reason: str) -> str:
    unused = "".join(f"    (void){each.name};\n" for each in function.arguments)
    code = library.failures.get(function.name, library.failed if function.coded else 0)
    answer = "" if function.result == "void" else f"    return {code};\n"
    return f"/* {reason} */\n{prototype(library, function)}\n{{\n{unused}{answer}}}\n"


def _alias(library: CLibrary, alias: str, function: Function) -> str:
    given = ", ".join(each.name for each in function.arguments)
    back = "" if function.result == "void" else "return "
    return f"{prototype(library, function, alias)}\n{{\n    {back}{function.name}({given});\n}}\n"
