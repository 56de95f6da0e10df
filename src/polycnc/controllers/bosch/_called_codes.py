"""Codes that call programs: the drilling cycles, and those that programs are named after (Manual 003, 3.1)."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Container

from polycnc.controllers.bosch._system import BoschSystem
from polycnc.nc import Dialect
from polycnc.nc.cpl import CodeCalls

DRILLING = {f"G{code}": f"999990{code}" for code in range(81, 87)}
"""The programs of the drilling cycles: permanently assigned, modal, ended by G80."""
_NAMES = re.compile(r"[GM][1-9][0-9]{0,3}|[GM]0")
_CANCELS = ("cycle_cancel",)
_STANDS = (
    "dwell", "set_position", "contour_shift", "program_shift", "program_shift_add", "workpiece_position", "pole",
    "pole_scaling", "external_offset", "plane_by_axes", "select_tables",
)  # fmt: skip


def called_codes(system: BoschSystem, dialect: Dialect, axes: Callable[[], Container[str]]) -> CodeCalls:
    """Return which codes call programs of the root; `axes` tells the axes of the channel."""
    actions = {float(code): action for code, action in dialect.g.items()}
    own = {f"G{code}" for code in dialect.g} | {f"M{code}" for code in dialect.m}

    def alone() -> frozenset[str]:
        named = {name for name in _listed(system) if _NAMES.fullmatch(name)} - own
        return frozenset(named | {code for code, name in DRILLING.items() if system.program_of(name)})

    return CodeCalls(
        alone=alone,
        modal=frozenset(DRILLING),
        cancels=frozenset(code for code, action in actions.items() if action in _CANCELS),
        stands=frozenset(code for code, action in actions.items() if action in _STANDS),
        axes=axes,
        rules=dialect.text,
    )


def _listed(system: BoschSystem) -> set[str]:
    """Return the names in the folders of the search path."""
    found: set[str] = set()
    for folder in system.search_path:
        path = (system.directory.root / folder).resolve()
        if path.is_relative_to(system.directory.root) and path.is_dir():
            with os.scandir(path) as entries:
                found.update(entry.name for entry in entries)
    return found
