"""The reference pages of the iMC card, made from its function library and its parameter table."""

import inspect
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

from polycnc.controllers.imc import imclib
from polycnc.controllers.imc.core import _bits, _ownership, _parameters
from polycnc.controllers.imc.library import _device, _expansions, _memory, _motion, _network, _path
from polycnc.controllers.imc.library._motion_rows import ROWS

_GROUPS: dict[str, tuple[ModuleType, tuple[str, ...]]] = {
    "Virtual cards": (_network, ("attach", "detach", "NetCard", "Port")),
    "Find, open, close": (_device, ()),
    "Parameters, bits, waits": (_memory, ()),
    "Paths, contours, events, captures": (_path, ()),
    "Motion": (_motion, tuple(ROWS)),
}

_HEAD = "# {title}\n\n<!-- Written by scripts/reference. -->\n\n{text}\n"

_PARAMETERS = """Every parameter has an address in a memory of 16-bit words; the macro of the header is its name
and `Loc` (`imclib.mcsposLoc`). Wider ones take two or three words, the low word first. Scope *axis*: one for each axis;
*card*: the axis of a call does not matter. Access *ro*: writing is refused; *w*: writing acts, and reading gives
something else or nothing.

| type | words | holds |
| --- | --- | --- |
| S16, U16 | 1 | whole number, with or without sign |
| F16 | 1 | flag: 0 or FFFFh, which is -1 |
| R16 | 1 | bits |
| S32, U32 | 2 | whole number |
| S16.16, U16.16 | 2 | fixed point: the number times 2¹⁶ |
| S48 | 3 | whole number |
| S16.32 | 3 | fixed point: the number times 2³² |

Positions are pulses, velocities pulses per ms, accelerations pulses per ms². A control cycle is 1 ms.

| name | address | type | scope | access | what it is |
| --- | ---: | --- | --- | --- | --- |
"""


def functions_page() -> str:
    """Return the page of the function library."""
    introduction = (inspect.getdoc(imclib) or "").replace("manual::\n", "manual:\n")
    return _HEAD.format(title="iMC function library", text=introduction) + "".join(_functions())


def parameters_page() -> str:
    """Return the page of the parameter memory."""
    rows = sorted(_parameters.PARAMETERS.values(), key=lambda each: each.address)
    scopes = {"A": "axis", "G": "card"}
    lines = (
        f"| `{each.name}` | {each.address} | {each.type} | {scopes[each.scope]} | {each.access} | {each.meaning} |\n"
        for each in rows
    )
    return _HEAD.format(title="iMC parameters", text=_PARAMETERS.rstrip("\n")) + "".join(lines)


_OWNERSHIP = """What moves the main coordinate system of an axis (rows), and what a command does to it (columns).
Superimposed moves (`pcsgo`, `pcstgvel`) touch none of it. A path or contour takes over whatever moves its axes.

A gear (`IMC_GearInDist`, `IMC_GearInTime`) or synchronous motion that has been set up waits for `startsyn` beside
whatever moves the axis, and no motion takes it away. An error that stops the axis, leaving run, an emergency stop,
`clear`, `engear := 0` and `enasyn := 0` end the wait: `engear`, `startsyn` and `enasyn` read 0 then. `startsyn` counts
when it is written after what it starts; where nothing waits and `enasyn` is 0 it reads 0 in the next cycle.

A command that takes over shows in the flags of what it ends: `mcsgo`, `gohome`, `engear`, `startsyn`, `enasyn` read 0.
A refused one reads 0 itself.
"""

_BITS = """Bits that are not named are 0 and do nothing. `stopfilt` (stops the axis), `stopmode` (at once), `exitfilt`
(clears `run`) and `emstop` (sets the bits in every axis) have the bits of `error`. To switch a limit switch on that
opens when it is reached, so that its terminal is high: `aioctr := 0003h` for the positive one, `000Ch` for the negative
one, `000Fh` for both; `C000h` more for the software limits.
"""


def axis_page() -> str:
    """Return the page of who moves an axis, and of the bits of its registers."""
    return _HEAD.format(title="iMC axes", text="".join(_axis()).strip("\n"))


def _axis() -> Iterator[str]:
    yield f"## Who moves an axis\n\n{_OWNERSHIP}\n| |"
    yield "".join(f" {command.replace('FFFFh', '-1')} |" for command in _ownership.COMMANDS)
    yield f"\n{'| --- ' * (len(_ownership.COMMANDS) + 1)}|\n"
    for owner, effects in zip(_ownership.OWNERS, _ownership.OWNERSHIP, strict=True):
        yield f"| {owner} |{''.join(f' {_ownership.EFFECTS[effect]} |' for effect in effects)}\n"
    yield f"\n## Bits\n\n{_BITS}"
    for register, bits in _bits.REGISTERS.items():
        yield f"\n### {register}\n\n| mask | name | while it is set |\n| --- | --- | --- |\n"
        yield from (f"| {bit.mask:04X}h | {bit.name} | {bit.meaning} |\n" for bit in bits)


def _functions() -> Iterator[str]:
    for title, (module, names) in _GROUPS.items():
        yield f"\n## {title}\n\n| function | what it does |\n| --- | --- |\n"
        chosen = names or [name for name in vars(module) if name.startswith("IMC_") and name in _own(module)]
        yield from (_line(name, getattr(imclib, name)) for name in chosen)
    yield "\n## Other names\n\nAs the manual misprints them, and for what its print has lost.\n\n"
    yield "| name | is |\n| --- | --- |\n"
    for name in sorted(imclib.__all__):
        value = getattr(imclib, name)
        if inspect.isfunction(value) and value.__name__ != name:
            yield f"| `{name}` | `{value.__name__}` |\n"
    yield "\n## What functions of motion write\n\nEach writes all its parameters to its axis in one control cycle, "
    yield "with one instruction, as `IMC_SetMulParam` would.\n\n| function | writes |\n| --- | --- |\n"
    for name, puts in _expansions.EXPANSIONS.items():
        yield f"| `{name}` | {', '.join(f'`{put.text}`' for put in puts)} |\n"
    yield "\n## Statuses\n\n| value | name | what it says |\n| ---: | --- | --- |\n"
    yield from (f"| {status.value} | `{status.name}` | {status.text} |\n" for status in imclib.IMC_STATUS)


def _own(module: ModuleType) -> set[str]:
    """Return the functions that are written in a module, not taken into it."""
    source = inspect.getsource(module)
    return {name for name in vars(module) if f"\ndef {name}(" in source}


def _line(name: str, function: Callable[..., Any]) -> str:
    doc = " ".join((inspect.getdoc(function) or "").partition("\n\n")[0].split())
    arguments = "" if inspect.isclass(function) else f"({', '.join(inspect.signature(function).parameters)})"
    return f"| `{name}{arguments}` | {doc} |\n"
