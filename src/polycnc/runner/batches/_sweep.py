"""Sweeps: one program under several overrides, tolerances or machines."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path

from polycnc.errors import UsageError
from polycnc.machine import MachineConfig, load_machine
from polycnc.nc import Dialect, load_dialect
from polycnc.runner._settings import LATHE, RunSettings
from polycnc.runner.batches._job import Setup

SWEEPS = ("override", "machine", "tolerance")
_MOST = 10_000
_EXAMPLE = "Write it like override=80:120:5, tolerance=0,0.01,0.05 or machine=mill3,shop.toml."


def parse_sweep(text: str) -> tuple[str, tuple[float | str, ...]]:
    """Return name and values of a sweep: `override=80:120:5` (from, to, step), `tolerance=0,0.01`, `machine=a,b`.

    Raises:
        UsageError: no such sweep, or its values are none.
    """
    name, equals, values = text.partition("=")
    name = name.strip()
    if not equals or name not in SWEEPS:
        raise UsageError(f"'{text}' is no sweep", hint=_EXAMPLE)
    if name == "machine":
        machines = tuple(each.strip() for each in values.split(",") if each.strip())
        if not machines:
            raise UsageError(f"'{text}' names no machine", hint=_EXAMPLE)
        return name, machines
    try:
        numbers = _range(values) if ":" in values else tuple(float(each) for each in values.split(","))
    except UsageError:  # it is a ValueError too
        raise
    except ValueError:
        raise UsageError(f"'{text}' has values that are no numbers", hint=_EXAMPLE) from None
    if not numbers or not all(map(math.isfinite, numbers)):
        raise UsageError(f"'{text}' has no values", hint=_EXAMPLE)
    return name, numbers


def _range(text: str) -> tuple[float, ...]:
    """Return the numbers from, to and by a step; the end belongs to it."""
    first, last, step = (float(each) for each in text.split(":"))
    if not all(map(math.isfinite, (first, last, step))) or step == 0.0 or (last - first) / step < 0.0:
        return ()
    count = math.floor((last - first) / step + 1e-9) + 1
    if count > _MOST:
        raise UsageError(f"a sweep of {count:,} values", hint=f"Take a greater step: {_MOST:,} is the most.")
    return tuple(round(first + number * step, 12) for number in range(count))


def setups_of(
    machine: str | Path | MachineConfig | None,
    dialect: str | Path | Dialect | None,
    sweep: Mapping[str, Sequence[float | str | Path | MachineConfig]],
    *,
    check_only: bool,
    detail: bool,
    stock: str | None = None,
    resolution_mm: float | None = None,
    fixtures: Sequence[str] = (),
) -> list[Setup]:
    """Return every combination of what a sweep varies.

    Raises:
        UsageError: no such sweep, machine or dialect, a value that cannot be, or stock from a file.
    """
    machines = [load_machine(each) for each in sweep.get("machine", (machine,))]  # type: ignore[arg-type]
    on_machines = [each for config in machines for each in (config.stock, *config.fixtures) if each]
    for text in (stock or "", *fixtures, *(each.form for each in on_machines)):
        if text.lower().endswith(".stl"):
            raise UsageError(
                f"'{text}' for a batch", hint="Give auto, a box or a cylinder: files are for one program."
            )
    for config in machines:  # refuses what cannot be
        RunSettings(config, stock=stock, resolution_mm=resolution_mm, fixtures=tuple(fixtures)).with_stock_of(
            config
        )
    unknown = set(sweep) - set(SWEEPS)
    if unknown:
        raise UsageError(f"'{min(unknown)}' cannot be swept", hint=f"Sweeps are: {', '.join(SWEEPS)}.")
    if machine is not None and "machine" in sweep:
        raise UsageError("a machine and a sweep over machines", hint="Give one of them.")
    read = dialect if dialect is None or isinstance(dialect, Dialect) else load_dialect(dialect)
    lathe = load_machine(LATHE) if machine is None and "machine" not in sweep else None
    found = []
    for config, tolerance, override in product(
        machines, sweep.get("tolerance", (None,)), sweep.get("override", (100.0,))
    ):
        found.append(
            Setup(
                _with_tolerance(config, tolerance),
                read,
                _override(override),
                check_only=check_only,
                detail=detail,
                stock=stock,
                resolution_mm=resolution_mm,
                fixtures=tuple(fixtures),
                lathe=None if lathe is None else _with_tolerance(lathe, tolerance),
            )
        )
    return found


def _with_tolerance(config: MachineConfig, tolerance: object) -> MachineConfig:
    if tolerance is None:
        return config
    if not isinstance(tolerance, int | float) or not 0.0 <= tolerance < math.inf:
        raise UsageError(f"a path tolerance of {tolerance} mm", hint="Give 0 or more.")
    path = config.path.model_copy(update={"path_tolerance_mm": float(tolerance)})
    return config.model_copy(update={"path": path})


def _override(percent: object) -> float:
    if not isinstance(percent, int | float) or not 1.0 <= percent <= 200.0:
        raise UsageError(f"an override of {percent} %", hint="Give 1 to 200.")
    return float(percent)
