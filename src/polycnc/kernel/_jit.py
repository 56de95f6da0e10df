"""Compile kernel functions with numba, cached on disk under a stamp of all compiled sources.

numba's own cache notices a change in the file of a function but not in the files of the functions it calls.
A unit (the kernel, the part programs, each controller) has a stamp of its own modules and of those below it, so a stale
callee is never loaded, and a change of one controller leaves everything else compiled.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba
from numba.core.registry import CPUDispatcher

P = ParamSpec("P")
R = TypeVar("R")

# numba's own annotations leave out the options and settings that are used here.
_CONFIG: Any = numba.config
_njit: Any = numba.njit

OPEN_INTERNALS = bool(os.environ.get("POLYCNC_OPEN_INTERNALS"))
"""Whether Python may call functions that are not entries: tests may, at the price of longer compilation."""


_PACKAGE = Path(__file__).resolve().parents[1]
_BELOW = ("units.py", "errors.py", "kernel", "machine")  # what compiled functions anywhere may use


def _unit_of(module: str) -> str:
    """Return the package that a module's compiled functions stand or fall with: a layer, or one controller."""
    parts = module.split(".")[1:]
    return "/".join(parts[:2] if parts[:1] == ["controllers"] else parts[:1])


def _sources(unit: str) -> list[Path]:
    places = ("units.py", "errors.py", unit) if unit == "kernel" else (*_BELOW, unit)
    found: list[Path] = []
    for place in places:
        path = _PACKAGE / place
        found += [path] if path.suffix else sorted(path.rglob("*.py"))
    return found


def _source_stamp(unit: str) -> str:
    digest = hashlib.blake2b(digest_size=8)
    for source in _sources(unit):
        info = source.stat()
        digest.update(f"{source.relative_to(_PACKAGE)}:{info.st_size}:{info.st_mtime_ns};".encode())
    return digest.hexdigest()


def _cache_base() -> Path:
    base = (
        os.environ.get("POLYCNC_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    )
    return Path(base) / "polycnc"


CACHE_BASE = _cache_base()
_KEPT_FOLDERS = 8


@lru_cache
def _cache_folder(unit: str) -> Path:
    """Return the folder of one unit's compiled functions, for this source tree as it is now (not created yet)."""
    tree = hashlib.blake2b(str(_PACKAGE).encode(), digest_size=4).hexdigest()
    name = f"{tree}-{unit.replace('/', '.')}"
    folder = CACHE_BASE / f"{name}-{_source_stamp(unit)}{'-open' if OPEN_INTERNALS else ''}"
    if not folder.exists():
        with contextlib.suppress(OSError):
            _forget_old_folders(name)
    return folder


def _forget_old_folders(name: str) -> None:
    """Remove the oldest folders of earlier versions of a unit."""
    siblings = CACHE_BASE.glob(f"{name}-*")
    old = sorted((each for each in siblings if each.is_dir()), key=lambda each: each.stat().st_mtime)
    for folder in old[: -_KEPT_FOLDERS or None]:
        shutil.rmtree(folder, ignore_errors=True)


def is_cold(name: str) -> bool:
    """Tell whether the kernel's entry of this name still has to be compiled on this machine."""
    return not _CONFIG.DISABLE_JIT and not any(_cache_folder("kernel").rglob(f"*.{name}-*.nbi"))


class _Internal(CPUDispatcher):
    """A compiled function without a wrapper: numba would crash if Python called it."""

    def __call__(self, *args: object, **kwargs: object) -> object:
        raise TypeError(
            f"{self.py_func.__name__} is internal to compiled code: decorate it with `entry`, "
            "or set POLYCNC_OPEN_INTERNALS=1 in tests"
        )


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` for compiled callers; IEEE arithmetic, so it equals its uncompiled self exactly.

    Python cannot call it: the wrapper for that costs more compile time than most functions do (see `entry`).
    It cannot allocate arrays: without numba's reference counts a control cycle takes a tenth of the time (see
    `allocating`).
    """
    return _internal(function, counted=False)


def allocating(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` for compiled callers, as `compiled` does, but allowed to allocate arrays."""
    return _internal(function, counted=True)


def _internal(function: Callable[P, R], *, counted: bool) -> Callable[P, R]:
    if OPEN_INTERNALS or _CONFIG.DISABLE_JIT:
        return _cached(function, counted=counted)
    # A state is hundreds of words, which a real call puts on the stack one by one. That costs more than most
    # functions do, so they all become part of their callers. It changes no result.
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "forceinline": True}
    dispatcher = _njit(error_model="numpy", fastmath=False, _nrt=counted, **options)(function)
    dispatcher.__class__ = _Internal
    return cast("Callable[P, R]", dispatcher)


def entry(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` for Python and compiled callers, and keep the result on disk."""
    return _cached(function, counted=True)


def _cached(function: Callable[P, R], *, counted: bool) -> Callable[P, R]:
    before = _CONFIG.CACHE_DIR
    _CONFIG.CACHE_DIR = str(_cache_folder(_unit_of(function.__module__)))
    try:
        dispatcher = _njit(cache=True, error_model="numpy", fastmath=False, _nrt=counted)(function)
        return cast("Callable[P, R]", dispatcher)
    finally:
        _CONFIG.CACHE_DIR = before
