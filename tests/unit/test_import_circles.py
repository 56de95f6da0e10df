"""No module reaches itself by imports, those for typing and those within functions included."""

from __future__ import annotations

import grimp
import pytest

# Circles that are left, by package and the modules in them; a module that leaves its circle leaves this table.
KNOWN = {
    "polycnc.controllers.imc.card": "_card _status",
    "polycnc.runner": (
        "_check _result _run _trace batches batches._batch batches._child batches._job batches._on_worker "
        "batches._report batches._store batches._sweep batches._thumbnail batches._workers batches._write "
        "comparison._both comparison._compare plots plots._over_time plots._paths plots._plot plots._scene "
        "view view._listing view._page view._part_frame view._picture view._track view._view"
    ),
}


def in_circles(imports: dict[str, set[str]]) -> set[str]:
    """Return the modules that reach themselves; what imports nothing or is imported by nothing is peeled off."""
    left = {module: set(found) for module, found in imports.items()}
    while True:
        imported = set().union(*left.values()) if left else set()
        dead = {module for module, found in left.items() if not found or module not in imported}
        if not dead:
            break
        left = {module: found - dead for module, found in left.items() if module not in dead}
    return {module for module in left if _reaches(module, left)}


def _reaches(module: str, imports: dict[str, set[str]]) -> bool:
    seen: set[str] = set()
    todo = [module]
    while todo:
        for each in imports[todo.pop()] - seen:
            if each == module:
                return True
            seen.add(each)
            todo.append(each)
    return False


@pytest.fixture(scope="module")
def found() -> set[str]:
    """The modules of the package that are in circles."""
    graph = grimp.build_graph("polycnc", cache_dir=None)
    return in_circles({each: set(graph.find_modules_directly_imported_by(each)) for each in graph.modules})


def known() -> set[str]:
    """Return the modules that the table names."""
    return {f"{package}.{name}" for package, names in KNOWN.items() for name in names.split()}


def test_no_circle_beside_the_known_ones(found: set[str]) -> None:
    assert found - known() == set(), "let what is below name what it needs as a Protocol"


def test_the_table_of_known_circles_only_shrinks(found: set[str]) -> None:
    assert known() - found == set(), "these are in no circle any more: take them out of the table"


def test_circles_of_every_length_are_found() -> None:
    imports = {"a": {"b"}, "b": {"c"}, "c": {"d"}, "d": {"b", "e"}, "e": {"f"}, "f": set(), "g": {"g"}}
    assert in_circles(imports) == {"b", "c", "d", "g"}
