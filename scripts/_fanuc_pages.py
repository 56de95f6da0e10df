"""The reference pages of the FANUC Power Mate, made from its function library, structures and parameter table."""

import inspect
from collections.abc import Iterator

from polycnc.controllers.fanuc import Attribute, PowerMate, fwlib, parameter_rows

_HEAD = "# {title}\n\n<!-- Written by scripts/reference. -->\n\n{text}\n"

_PARAMETERS = """Parameters of the virtual Power Mate. A library call writes them (`cnc_wrparam`), a script does with
`PowerMate.parameters.set(number, value, axis)`. *axis*: one value for each axis. Marks: **S** can be put in on the
setting screen, **P** brings alarm 000 until the power is switched off (`power_cycle`), **W** cannot be written, **R**
cannot be read. A parameter of an option can be written only where `PowerMate(options=...)` has it. Positions and limits
are increments of the machine, speeds mm/min or deg/min (on an inch machine 0.1 inch/min). One without an entry under
*what it does* is kept and has no effect.

| number | name | type | marks | option | range | default | what it does |
| ---: | --- | --- | --- | --- | --- | ---: | --- |
"""

_MARKS = {
    Attribute.SETTING: "S",
    Attribute.POWER_OFF: "P",
    Attribute.WRITE_PROTECTED: "W",
    Attribute.NOT_READABLE: "R",
    Attribute.UNSIGNED: "U",
    Attribute.SPINDLE: "D",
}
_TYPES = ("bit", "byte", "word", "2-word")


def functions_page() -> str:
    """Return the page of the function library."""
    introduction = (inspect.getdoc(fwlib) or "").replace("manual::\n", "manual:\n")
    return _HEAD.format(title="FANUC Power Mate function library", text=introduction) + "".join(_functions())


def parameters_page() -> str:
    """Return the page of the parameters."""
    lines = []
    for row in parameter_rows().values():
        kind = _TYPES[row.kind] + (", axis" if row.per_axis else "")
        marks = "".join(mark for attribute, mark in _MARKS.items() if attribute in row.attributes)
        lines.append(
            f"| {row.number:04d} | {row.name} | {kind} | {marks} | {row.option} | {row.low} to {row.high} "
            f"| {row.default} | {row.acts} |\n"
        )
    return _HEAD.format(title="FANUC Power Mate parameters", text=_PARAMETERS.rstrip("\n")) + "".join(lines)


def _functions() -> Iterator[str]:
    yield "\n## The bus\n\n| function | what it does |\n| --- | --- |\n"
    for name in ("attach", "detach"):
        function = getattr(fwlib, name)
        arguments = ", ".join(inspect.signature(function).parameters)
        yield f"| `{name}({arguments})` | {_first(function)} |\n"
    yield "\n## The control beside the library\n\n"
    yield "What the operator does, and what no function of the library reaches.\n\n"
    yield "| method of `PowerMate` | what it does |\n| --- | --- |\n"
    for name, method in vars(PowerMate).items():
        if inspect.isfunction(method) and not name.startswith("_"):
            arguments = ", ".join(list(inspect.signature(method).parameters)[1:])
            yield f"| `{name}({arguments})` | {_first(method)} |\n"
    yield "\n## Functions\n\n"
    yield "In Python the handle comes first, then what goes in; what C takes a pointer for comes back.\n\n"
    yield "| in C | what it does |\n| --- | --- |\n"
    for name, function in fwlib.FUNCTIONS.items():
        yield f"| `{function.prototype}` | {_first(getattr(fwlib, name))} |\n"
    yield "\n## Return codes\n\n| value | name | what it says |\n| ---: | --- | --- |\n"
    yield from (f"| {code.value} | `{name}` | {code.text} |\n" for name, code in fwlib.EW.__members__.items())
    yield "\n## Structures\n\nOffsets in bytes; nothing is aligned to more than two.\n\n"
    yield "| structure | bytes | elements |\n| --- | ---: | --- |\n"
    for layout in fwlib.STRUCTURES.values():
        elements = ", ".join(f"{field.offset} `{field.declaration}`" for field in layout.fields)
        yield f"| `{layout.name}` | {layout.size} | {elements} |\n"


def _first(function: object) -> str:
    """Return the first sentence of a description."""
    return (inspect.getdoc(function) or "").split("\n\n")[0].replace("\n", " ").replace("|", "\\|")
