"""Compile functions with numba, and keep what was compiled on disk under what it was made from.

A kept function is found again by the content of all it reaches, not by the time or the place of files: a second
checkout, a reinstallation and a copied cache compile nothing, nor does a change that no compiled function reaches.
"""

from collections.abc import Callable, Iterable

from polycnc.jit._detached import Detached, Ready, call_at, detached
from polycnc.jit._entry import allocating, apart, compiled, entry, versions
from polycnc.jit._files import CACHE_FOLDER, FILES, SHIPPED_FOLDER, Files
from polycnc.jit._marks import OPEN_INTERNALS
from polycnc.jit._notice import COMPILING
from polycnc.jit._plain import compile_at_once
from polycnc.jit._reach import Fingerprints, NotKnownError

__all__ = [
    "CACHE_FOLDER",
    "COMPILING",
    "FILES",
    "OPEN_INTERNALS",
    "SHIPPED_FOLDER",
    "Detached",
    "Files",
    "Fingerprints",
    "NotKnownError",
    "Ready",
    "allocating",
    "apart",
    "call_at",
    "compile_at_once",
    "compile_entries",
    "compiled",
    "detached",
    "entry",
    "versions",
]


def compile_entries(package: str, states: Iterable[object], progress: Callable[[str, float], None]) -> int:
    """Compile, or load, the entries of a package whose arguments are numbers and named tuples like `states`.

    The package must have been imported. `progress` is called with the name of each entry and the part that is done.
    Returns how many entries were left out, because they take something else.
    """
    from polycnc.jit._warm import compile_all

    return compile_all(package, states, progress)
