"""How numba makes machine code here: internal functions stay LLVM code until an entry takes them in.

numba gives every function machine code of its own, and links into it all that it calls. Internal functions become
part of the entry that calls them anyway, so that work is thrown away: it is done once, in the entry.

This reaches into numba. `KNOWN` are the versions for which it was tried; with others numba's own way is used, which
takes longer and gives the same results.

Nothing links an entry: what is kept of it is its machine code and the names of its functions. Its LLVM code, which
numba keeps for others to link, is three times as long, and takes ten times its length of memory when it is read.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import llvmlite.binding as llvm
import numba
from numba.core import codegen, compiler, typed_passes
from numba.core.compiler_machinery import register_pass

KNOWN = ("0.68.",)
"""How the versions of numba begin for which the shortened way was tried."""

_Library: Any = codegen.JITCodeLibrary
_Lowering: Any = typed_passes.NativeLowering
_Compiler: Any = compiler.CompilerBase
_Builder: Any = compiler.DefaultPassBuilder
_LowerResult: Any = compiler._LowerResult
_parse_assembly: Any = llvm.parse_assembly
_make_function: Any = import_module("numba._dynfunc").make_function
_register: Any = register_pass


class _InternalLibrary(_Library):  # type: ignore[misc]
    """A function as LLVM code, which is never run by itself."""

    def finalize(self) -> None:
        """Close the library; what it calls is linked into the entry."""
        self._raise_if_finalized()
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: there is no machine code."""
        return 0


class _EntryLibrary(_Library):  # type: ignore[misc]
    """An entry: all that it reaches is linked into it, once."""

    def finalize(self) -> None:
        """Link, optimise and make machine code."""
        reached: list[Any] = []
        _collect(self, reached, set())
        # Callers first: LLVM takes in only what something calls that is there already.
        self._linking_libraries = reached[::-1]
        super().finalize()

    def serialize_using_object_code(self) -> tuple[str, str, tuple[bytes, bytes]]:
        """Return what is kept: the machine code, and a module that has its functions' names and does nothing."""
        names = [each.name for each in self.get_defined_functions()]
        empty = "".join(f'define void @"{name}"() {{ ret void }}\n' for name in names)
        return self.name, "object", (self._get_compiled_object(), _parse_assembly(empty).as_bitcode())

    def _verify_declare_only_symbols(self) -> None:
        missing = [each.name for each in self._final_module.functions if each.is_declaration]
        missing = [
            name for name in missing if name.startswith("_ZN")
        ]  # compiled by numba, not of the C library
        if missing:
            raise AssertionError(f"not linked: {missing}")


def _collect(library: Any, reached: list[Any], seen: set[int]) -> None:
    """Add what a library calls to `reached`, callees first."""
    for each in library._linking_libraries:
        if id(each) not in seen:
            seen.add(id(each))
            if isinstance(each, _InternalLibrary):
                _collect(each, reached, seen)
            reached.append(each)


def _new_library(state: Any, kind: Any) -> None:
    state.library = kind(state.targetctx.codegen(), state.func_id.func_qualname)
    state.library.enable_object_caching()


@_register(mutates_CFG=True, analysis_only=False)
class _InternalLowering(_Lowering):  # type: ignore[misc]
    """Lower a function that is called by compiled code alone."""

    _name = "polycnc_internal_lowering"

    def run_pass(self, state: Any) -> bool:
        """Lower to LLVM code, and make that known to callers."""
        _new_library(state, _InternalLibrary)
        state.flags.no_compile = True
        super().run_pass(state)
        state.flags.no_compile = False
        library, result = state.library, state.cr
        library.finalize()
        about = result.fndesc
        name = about.qualname.rpartition(".")[2]
        handle = _make_function(about.lookup_module(), name, "internal", 0, result.env, (library,))
        state.targetctx.insert_user_function(handle, about, [library])
        state.reload_init.extend(library._reload_init)
        state.cr = _LowerResult(about, result.call_helper, cfunc=handle, env=result.env)
        return True


@_register(mutates_CFG=True, analysis_only=False)
class _EntryLowering(_Lowering):  # type: ignore[misc]
    """Lower a function that Python calls."""

    _name = "polycnc_entry_lowering"

    def run_pass(self, state: Any) -> bool:
        """Lower, link, and make machine code."""
        _new_library(state, _EntryLibrary)
        return bool(super().run_pass(state))


def _pipeline(state: Any, lowering: Any) -> list[Any]:
    manager = _Builder.define_nopython_pipeline(state)
    manager.passes[:] = [(lowering if each is _Lowering else each, text) for each, text in manager.passes]
    manager.finalize()
    return [manager]


class _InternalCompiler(_Compiler):  # type: ignore[misc]
    def define_pipelines(self) -> list[Any]:
        return _pipeline(self.state, _InternalLowering)


class _EntryCompiler(_Compiler):  # type: ignore[misc]
    def define_pipelines(self) -> list[Any]:
        return _pipeline(self.state, _EntryLowering)


def pipelines() -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the options that choose the compiler of internal functions and that of entries."""
    if not numba.__version__.startswith(KNOWN):
        return {}, {}
    return {"pipeline_class": _InternalCompiler}, {"pipeline_class": _EntryCompiler}
