"""Public names of a package that are loaded when they are first used, so that importing it stays quick."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import Any


def names_on_demand(package: str) -> Callable[[str], Any]:
    """Return the `__getattr__` of a package that loads what it imports under `if TYPE_CHECKING:`.

    `dir` of the package shows its public names then, loaded or not.
    """
    homes: dict[str, str] = {}
    module = vars(sys.modules[package])
    module["__dir__"] = lambda: sorted([*module["__all__"], *(name for name in module if name[:2] == "__")])

    def get(name: str) -> Any:
        if not homes:
            homes.update(_homes(_source(sys.modules[package])))
        if name not in homes:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        found = getattr(import_module(homes[name]), name)
        setattr(sys.modules[package], name, found)
        return found

    return get


def _source(module: ModuleType) -> str:
    """Return the source of a module, whatever has loaded it: pytest's loader, for one, cannot say."""
    import linecache  # from an archive too

    return "".join(linecache.getlines(str(module.__file__), vars(module)))


def _homes(source: str) -> dict[str, str]:
    """Return the module of each name that a source imports for its types alone."""
    import ast  # takes a while to load, and a command that helps needs none

    return {
        alias.name: str(node.module)
        for block in ast.parse(source).body
        if isinstance(block, ast.If)
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
