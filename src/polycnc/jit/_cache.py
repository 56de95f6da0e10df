"""A cache for numba that knows a compiled function by its content: code, types of arguments, compiler and processor."""

from __future__ import annotations

import hashlib
import pickle
import sys
from collections.abc import Callable
from functools import lru_cache
from importlib import resources
from typing import Any

import llvmlite
import numba
import numpy as np
from numba.core import compiler, serialize
from numba.core.caching import _Cache
from numba.core.runtime import nrt

from polycnc.jit._files import CACHE_FOLDER, FILES, SHIPPED_FOLDER, Files, Lock
from polycnc.jit._marks import Mark
from polycnc.jit._notice import announce
from polycnc.jit._reach import Fingerprints
from polycnc.jit._reference import described

_SHIPPED = Files(SHIPPED_FOLDER) if SHIPPED_FOLDER.is_dir() else None
FINGERPRINTS = Fingerprints()

# numba's own annotations leave these out.
_config: Any = numba.config
_rebuild: Any = compiler.CompileResult._rebuild
_dumps: Any = serialize.dumps
_runtime: Any = nrt.rtsys
ANY_PROCESSOR = ("generic", "")  # name and features by which numba makes code for every processor of a kind
_MAKERS = (
    "_calls.py",
    "_compile.py",
    "_pipeline.py",
    "_reference.py",
)  # what a compiled function depends on here
_SETTINGS = ("OPT", "DEBUGINFO_DEFAULT", "BOUNDSCHECK", "LOOP_VECTORIZE", "SLP_VECTORIZE", "LLVM_PASS_OPT")


@lru_cache
def _compiler() -> str:
    """Return what compiles: this package, interpreter, numba, what it stands on, and its settings."""
    here = resources.files(__package__)
    sources = [here.joinpath(name).read_bytes() for name in _MAKERS]
    own = hashlib.blake2b(b"".join(each.replace(b"\r\n", b"\n") for each in sources)).hexdigest()
    versions = (
        sys.implementation.cache_tag,
        getattr(sys, "abiflags", ""),
        numba.__version__,
        llvmlite.__version__,
        np.__version__,
    )
    return repr((own, versions, [getattr(_config, name, None) for name in _SETTINGS]))


def _hexadecimal(*parts: str) -> str:
    return hashlib.blake2b("\n".join(parts).encode(), digest_size=10).hexdigest()


def _family(mark: Mark) -> str:
    function: Any = mark.py_func
    return f"{function.__module__}.{function.__qualname__}".replace("<locals>", "-")


def version(mark: Mark) -> str:
    """Return how the stems of a function as it is now begin, for all types of arguments."""
    return f"{_family(mark)}-{_hexadecimal(FINGERPRINTS.of(mark), _compiler())}"


class ContentCache(_Cache):
    """The kept files of one compiled function; holds the lock of a file from a miss until it is written."""

    def __init__(self, mark: Mark, kind: str, missing: Callable[[], None]) -> None:
        self._mark = mark
        self._kind = kind
        self._missing = missing  # called when the function has to be compiled
        self._lock = Lock(None)
        self._enabled = True

    @property
    def cache_path(self) -> str:
        """The folder of the files."""
        return str(CACHE_FOLDER)

    def is_kept(self, sig: tuple[Any, ...], target_context: Any) -> bool:
        """Tell whether there is a file for these types of arguments, without waiting for who makes it."""
        processor = target_context.codegen().magic_tuple()
        stems = ((_SHIPPED, (processor[0], *ANY_PROCESSOR)), (FILES, processor))
        return any(files is not None and files.has(self._stem(sig, kind)) for files, kind in stems)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the function for these types of arguments; when it is not there, hold others from making it."""
        _runtime.initialize(target_context)  # not `refresh`, which loads all that compiling takes
        if not self._enabled:
            return self._not_there()
        processor = target_context.codegen().magic_tuple()
        if _SHIPPED is not None:
            found = self._read(_SHIPPED, self._stem(sig, (processor[0], *ANY_PROCESSOR)), target_context)
            if found is not None:
                return found
        stem = self._stem(sig, processor)
        found = self._read(FILES, stem, target_context)
        if found is None:
            self.release()
            self._lock = FILES.lock(stem)
            found = self._read(FILES, stem, target_context)  # another process may have made it meanwhile
            if found is None:
                return self._not_there()
            self.release()
        return found

    def _not_there(self) -> None:
        announce()
        self._missing()

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a function that was just compiled."""
        keeps = (
            self._enabled and not data.library.has_dynamic_globals and all(x.can_cache for x in data.lifted)
        )
        if keeps:
            FILES.write(
                self._stem(sig, data.codegen.magic_tuple()), _family(self._mark), _dumps(data._reduce())
            )
        self.release()

    def release(self) -> None:
        """Let other processes make what this one was going to make."""
        self._lock.release()

    def enable(self) -> None:
        """Look for files and write them."""
        self._enabled = True

    def disable(self) -> None:
        """Neither look for files nor write them."""
        self._enabled = False

    def flush(self) -> None:
        """Do nothing: what is kept is right as long as its key is."""

    def _stem(self, sig: Any, processor: tuple[str, str, str]) -> str:
        arguments = sig if isinstance(sig, tuple) else (*sig.args, sig.return_type)
        texts = (text for argument in arguments for text in described(argument))
        return f"{version(self._mark)}-{_hexadecimal(self._kind, repr(processor), *texts)}"

    def _read(self, files: Files, stem: str, target_context: Any) -> Any:
        data = files.read(stem)
        if data is None:
            return None
        try:
            return _rebuild(target_context, *pickle.loads(data))
        except Exception as error:  # whole but strange: whatever it raises, the way out is to compile
            files.remark(f"{stem} cannot be loaded ({type(error).__name__}: {error}); it is compiled anew")
            return None
