"""Public names of a package that are loaded when they are first used, so that importing it stays quick."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any


def names_on_demand(package: str) -> Callable[[str], Any]:
    """Return the `__getattr__` of a package that loads what it imports under `if TYPE_CHECKING:`."""
    homes: dict[str, str] = {}

    def get(name: str) -> Any:
        if not homes:
            loader: Any = sys.modules[package].__loader__
            homes.update(_homes(loader.get_source(package)))
        if name not in homes:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        found = getattr(import_module(homes[name]), name)
        setattr(sys.modules[package], name, found)
        return found

    return get


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
