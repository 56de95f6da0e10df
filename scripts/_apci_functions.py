"""The reference page of the APCI function library, made from the functions themselves."""

import inspect
from collections.abc import Iterator
from types import ModuleType

from polycnc.controllers.apci import pcap
from polycnc.controllers.apci.library import (
    _control,
    _io,
    _latch,
    _motion,
    _parameters,
    _session,
    _special_variables,
    _spool,
    _system,
    _tasks,
)

_GROUPS: dict[ModuleType, str] = {  # where pcap gets its functions from, and what they are
    _session: "Virtual boards",
    _system: "Booting and initialising",
    _control: "Loops, resets, zeros, overrides",
    _motion: "Motion, at once and queued",
    _spool: "The spooler",
    _parameters: "Parameters, positions, system variables",
    _io: "Inputs, outputs, lights, interrupts",
    _latch: "Latches and recording",
    _tasks: "CNC tasks and common variables",
    _special_variables: "Variables of special firmware",
}
_HEAD = """# APCI function library

<!-- Written by scripts/reference. -->

{introduction}

"""


def page() -> str:
    """Return the page."""
    introduction = inspect.getdoc(pcap) or ""
    return _HEAD.format(introduction=_as_markdown(introduction)) + "\n".join(_groups(pcap))


def _as_markdown(text: str) -> str:
    """Turn the literal block of a docstring into one that Markdown shows."""
    return text.replace("manual::\n", "manual:\n")


def _groups(library: ModuleType) -> Iterator[str]:
    for module, title in _GROUPS.items():
        yield f"## {title}\n\n| function | what it does |\n| --- | --- |"
        names = ("attach", "board", "detach") if module is _session else module.__all__
        yield from (_line(name, getattr(library, name)) for name in names)
        yield ""


def _line(name: str, function: object) -> str:
    doc = " ".join((inspect.getdoc(function) or "").partition("\n\n")[0].split())
    row = pcap.FUNCTIONS.get(name)
    prototype = f"{name}({', '.join(inspect.signature(function).parameters)})"  # type: ignore[arg-type]
    return f"| `{row.prototype if row else prototype}` | {doc} |"
