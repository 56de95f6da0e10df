"""No module reaches itself by imports, those for typing and those within functions included."""

from __future__ import annotations

import grimp
import pytest


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


def test_there_is_no_circle(found: set[str]) -> None:
    assert found == set(), "let what is below name what it needs as a Protocol"


def test_circles_of_every_length_are_found() -> None:
    imports = {"a": {"b"}, "b": {"c"}, "c": {"d"}, "d": {"b", "e"}, "e": {"f"}, "f": set(), "g": {"g"}}
    assert in_circles(imports) == {"b", "c", "d", "g"}
