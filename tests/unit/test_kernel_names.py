"""Names of the kernel carry their units: rad beside deg and mm/s beside mm/min look alike as bare numbers."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from types import ModuleType

import numpy as np
import pytest

from polycnc import kernel

PHYSICAL = frozenset(
    (
        *("acceleration", "accel", "deceleration", "feed", "jerk", "speed", "velocity"),
        *("dwell", "duration", "time"),
        *("angle", "sweep", "turn"),
        *("distance", "length", "radius", "tolerance"),
    )
)
UNITS = ("_mm", "_deg", "_rad", "_s", "_mm_s", "_mm_s2", "_mm_s3", "_cycles")

# Algebra that holds in any unit: the module says at its top which ones its numbers are in.
STATED_AT_THE_TOP = frozenset(
    [
        "_braking",
        "_jerk",
        "_plant",
        "_point_to_point",
        "_profile",
        "_profile_shape",
        "_ramps",
        "_servo",
        "_touching",
    ]
)
# A field of these words is a trap: programs give mm/min and deg for the same thing.
TRAPS = frozenset(["angle", "dwell", "feed", "sweep", "tolerance"])


def modules() -> list[ModuleType]:
    """Return the modules of the kernel."""
    names = (module.name for module in pkgutil.iter_modules(kernel.__path__))
    return [importlib.import_module(f"{kernel.__name__}.{name}") for name in names]


def is_bare(name: str, words: frozenset[str] = PHYSICAL) -> bool:
    """Tell whether a name speaks of a physical quantity and ends without its unit."""
    return not words.isdisjoint(name.split("_")) and not name.endswith(UNITS)


def functions(module: ModuleType) -> Iterator[tuple[str, inspect.Signature]]:
    """Yield what a module itself defines for others."""
    for name, value in vars(module).items():
        plain = getattr(value, "py_func", value)
        if not name.startswith("_") and inspect.isfunction(plain) and plain.__module__ == module.__name__:
            yield name, inspect.signature(plain)


def short(module: ModuleType) -> str:
    """Return the name of a module within the kernel."""
    return module.__name__.rpartition(".")[2]


def bare_parameters(module: ModuleType) -> list[str]:
    """Return the numbers that a module's functions take under a name without a unit."""
    return [
        f"{short(module)}.{name}({parameter.name})"
        for name, signature in functions(module)
        for parameter in signature.parameters.values()
        if parameter.annotation in ("float", float) and is_bare(parameter.name)
    ]


@pytest.mark.parametrize(
    ("name", "bare"),
    [
        ("sweep", True),
        ("sweep_rad", False),
        ("target_velocity", True),
        ("speed_mm_s", False),
        ("along", False),
    ],
)
def test_what_a_bare_name_is(name: str, bare: bool) -> None:
    assert is_bare(name) is bare


def test_parameters_carry_their_units() -> None:
    assert sum(len(list(functions(module))) for module in modules()) > 100  # compiled ones are seen too
    assert [
        name
        for module in modules()
        if short(module) not in STATED_AT_THE_TOP
        for name in bare_parameters(module)
    ] == []


@pytest.mark.parametrize("name", sorted(STATED_AT_THE_TOP))
def test_a_module_of_bare_names_states_its_units(name: str) -> None:
    module = importlib.import_module(f"{kernel.__name__}.{name}")
    assert "\nUnits: " in (module.__doc__ or "")
    assert bare_parameters(module), "an exception that none needs"


def test_fields_that_are_mistaken_carry_their_units() -> None:
    rows = [
        (f"{short(module)}.{name}", value.names)
        for module in modules()
        for name, value in vars(module).items()
        if isinstance(value, np.dtype) and value.names
    ]
    assert len(rows) > 3
    assert [(row, field) for row, fields in rows for field in fields or () if is_bare(field, TRAPS)] == []
