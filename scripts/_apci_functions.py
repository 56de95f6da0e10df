"""The reference page of the APCI function library, made from the functions themselves."""

import ast
import inspect
from collections.abc import Iterator
from types import ModuleType

from polycnc.controllers.apci import pcap

_GROUPS = {  # where pcap gets its functions from, and what they are
    "_library": "Virtual boards",
    "_system": "Booting and initialising",
    "_control": "Loops, resets, zeros, overrides",
    "_motion": "Motion at once",
    "_spool": "The spooler",
    "_parameters": "Parameters, positions, system variables",
    "_io": "Inputs, outputs, lights, interrupts",
    "_latch": "Latches and recording",
    "_tasks": "CNC tasks and common variables",
    "_special_variables": "Variables of special firmware",
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
    for module, names in _imports(library).items():
        if module in _GROUPS:
            yield f"## {_GROUPS[module]}\n\n| function | what it does |\n| --- | --- |"
            yield from (_line(name, getattr(library, name)) for name in names)
            yield ""


def _imports(library: ModuleType) -> dict[str, list[str]]:
    """Return the names that the library takes from each of its modules."""
    tree = ast.parse(inspect.getsource(library))
    taken = (node for node in tree.body if isinstance(node, ast.ImportFrom) and node.module)
    return {str(node.module).rpartition(".")[2]: [each.name for each in node.names] for node in taken}


def _line(name: str, function: object) -> str:
    doc = " ".join((inspect.getdoc(function) or "").partition("\n\n")[0].split())
    signature = "" if inspect.isclass(function) else _signature(function)
    return f"| `{name}{signature}` | {doc} |".replace("||", "|")


def _signature(function: object) -> str:
    """Return the arguments and the type of the result, without defaults and the modules of types."""
    signature = inspect.signature(function)  # type: ignore[arg-type]
    names = [
        ("*" if each.kind is each.VAR_POSITIONAL else "") + each.name
        for each in signature.parameters.values()
    ]
    result = str(signature.return_annotation) if signature.return_annotation else ""
    return f"({', '.join(names)})" + ("" if result in ("None", "") else f" -> {result}")
