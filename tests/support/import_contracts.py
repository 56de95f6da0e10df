"""A contract for import-linter: what one package keeps private, no other package imports."""

from __future__ import annotations

from typing import Any

from importlinter import Contract, ContractCheck, fields, output

_FAMILIES = ("controllers", "servers")  # packages of packages: each member keeps its own secrets


def package_of(module: str, root: str) -> str:
    """Return the package whose private modules `module` may import: a layer, or one controller or server."""
    parts = module.removeprefix(f"{root}.").split(".")
    return ".".join(parts[:2] if parts[0] in _FAMILIES else parts[:1])


def is_private(module: str) -> bool:
    """Tell whether a module or a package above it has a leading underscore."""
    return any(part.startswith("_") for part in module.split("."))


class PrivateModules(Contract):
    """No module imports a private module of another package."""

    root = fields.StringField()

    def check(self, graph: Any, verbose: bool) -> ContractCheck:
        """Look at every import of a private module."""
        root = str(self.root)
        found = [
            (importer, imported)
            for imported in sorted(graph.modules)
            if imported.startswith(f"{root}.") and is_private(imported)
            for importer in sorted(graph.find_modules_that_directly_import(imported))
            if package_of(importer, root) != package_of(imported, root)
        ]
        return ContractCheck(kept=not found, metadata={"found": found})

    def render_broken_contract(self, check: ContractCheck) -> None:
        """Print each forbidden import."""
        for importer, imported in check.metadata["found"]:
            output.print_error(f"{importer} imports {imported}, which its package keeps private")
