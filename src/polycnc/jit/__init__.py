"""Compile functions with numba, and keep what was compiled on disk under what it was made from.

A kept function is found again by the content of all it reaches, not by the time or the place of files: a second
checkout, a reinstallation and a copied cache compile nothing, nor does a change that no compiled function reaches.
"""

from polycnc.jit._cache import FILES
from polycnc.jit._compile import OPEN_INTERNALS, allocating, compiled, entry, versions
from polycnc.jit._detached import Detached, Ready, call_at, detached
from polycnc.jit._files import CACHE_FOLDER, SHIPPED_FOLDER, Files
from polycnc.jit._notice import COMPILING
from polycnc.jit._pipeline import KNOWN as KNOWN_NUMBA
from polycnc.jit._plain import compile_at_once
from polycnc.jit._reach import Fingerprints, NotKnownError
from polycnc.jit._warm import compile_entries

__all__ = [
    "CACHE_FOLDER",
    "COMPILING",
    "FILES",
    "KNOWN_NUMBA",
    "OPEN_INTERNALS",
    "SHIPPED_FOLDER",
    "Detached",
    "Files",
    "Fingerprints",
    "NotKnownError",
    "Ready",
    "allocating",
    "call_at",
    "compile_at_once",
    "compile_entries",
    "compiled",
    "detached",
    "entry",
    "versions",
]
