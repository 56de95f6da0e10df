"""Write a C library and build it with the compiler that is here."""

from __future__ import annotations

import shutil
import subprocess
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

from polycnc import __version__
from polycnc.controllers.library.clib import (
    CLibrary,
    write_basic,
    write_csharp,
    write_definitions,
    write_header,
    write_pascal,
    write_source,
)
from polycnc.errors import UsageError

_MOST_SHOWN = 400
_LIMIT_S = 300
_MARK = "Written by polycnc clib"
"""In the first line of the source: what lies beside it is ours, and may be written anew."""


@dataclass(frozen=True, slots=True)
class Target:
    """What a library is built for: its compilers in order, options after `-o FILE NAME.c`, and how to get one.

    `only_on` is the one system that can build it, `then` a second command.
    """

    compilers: tuple[str, ...]
    made: str
    options: tuple[str, ...]
    get: str
    only_on: str = ""
    then: tuple[str, ...] = ()


_WINDOWS = ("-shared", "-s", "{name}.def", "-Wl,--out-implib,{name}.lib", "-lws2_32")
TARGETS = {
    "linux": Target(
        ("gcc", "cc", "clang"),
        "lib{name}.so",
        (
            "-shared",
            "-fPIC",
            "-s",
            "-fvisibility=hidden",
            "-pthread",
            "-ldl",
            "-Wl,-z,nodelete",
        ),  # it may have a thread
        "Install gcc: on Debian, apt-get install gcc.",
    ),
    "macos": Target(
        ("clang", "cc"),
        "lib{name}.dylib",
        ("-dynamiclib", "-fvisibility=hidden"),
        "On a Mac: xcode-select --install.",
        "darwin",
    ),
    "win32": Target(
        ("i686-w64-mingw32-gcc",),
        "{name}.dll",
        (*_WINDOWS, "-Wl,--kill-at,--enable-stdcall-fixup", "-static-libgcc"),
        "Install mingw-w64: on Debian, apt-get install gcc-mingw-w64-i686.",
        # Clients name their functions with the size of the stack, which no DLL of the makers does.
        then=("i686-w64-mingw32-dlltool", "--kill-at", "-d", "{name}_win32.def", "-l", "{name}.lib"),
    ),
    "win64": Target(
        ("x86_64-w64-mingw32-gcc",),
        "{name}.dll",
        (*_WINDOWS, "-static-libgcc"),
        "Install mingw-w64: on Debian, apt-get install gcc-mingw-w64-x86-64.",
    ),
}
"""By name."""

_HERE = {"linux": "linux", "darwin": "macos", "win32": "win64"}


def target_here() -> str:
    """Return the target of this computer."""
    return _HERE.get(sys.platform, "linux")


def write_library(library: CLibrary, folder: Path, *, in_process: bool = False) -> list[Path]:
    """Write header, source, definitions and declarations for other languages into a folder; return the files.

    `in_process` has the machines in the program's own process, in this interpreter of Python.

    Raises:
        UsageError: They cannot be written, or files of these names are there that are not of `polycnc clib`.
    """
    texts = {
        f"{library.name}.h": write_header(library),
        f"{library.name}.c": write_source(library, __version__, sys.executable if in_process else ""),
        f"{library.name}.def": write_definitions(library),
        f"{library.name}_win32.def": write_definitions(library, decorated=True),
        f"{library.name}.pas": write_pascal(library),
        f"{library.name}.cs": write_csharp(library),
    }
    if library.basic:
        texts[f"{library.name}.bas"] = write_basic(library)
    made = [row.made.format(name=library.name) for row in TARGETS.values()]
    try:
        _refuse_foreign(folder, f"{library.name}.c", [*texts, *made, f"{library.name}.lib"])
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            (folder / name).write_bytes(text.encode())
    except OSError as error:
        raise UsageError(
            f"{folder}: cannot be written: {error.strerror}", hint="Name another folder with -o."
        ) from None
    return [folder / name for name in texts]


def _refuse_foreign(folder: Path, source: str, names: list[str]) -> None:
    """Refuse a folder in which a file of the maker's, or of somebody else, would be replaced.

    Raises:
        OSError: The source that is there cannot be read.
        UsageError: There is such a file.
    """
    if (folder / source).is_file():
        with (folder / source).open("rb") as file:
            if _MARK.encode() in file.read(_MOST_SHOWN):
                return
    if found := [name for name in names if (folder / name).exists()]:
        raise UsageError(
            f"{folder / found[0]} is there already, and not of polycnc clib",
            hint="Name another folder with -o: the maker's files have the same names.",
        )


def build_command(
    library: CLibrary, target: str, compiler: str = "", *, in_process: bool = False
) -> list[str]:
    """Return the command that builds a library, in its folder.

    Raises:
        UsageError: There is no such target, or no interpreter that it can have in the program's process.
    """
    if target not in TARGETS:
        raise UsageError(f"there is no target '{target[:40]}'", hint=f"There are {', '.join(TARGETS)}.")
    row = TARGETS[target]
    made = row.made.format(name=library.name)
    options = [each.format(name=library.name) for each in row.options]
    if in_process:
        options += _interpreter(target)
    return [compiler or row.compilers[0], "-std=c99", "-Os", "-o", made, f"{library.name}.c", *options]


def _interpreter(target: str) -> list[str]:
    """Return what links the interpreter that runs now.

    Raises:
        UsageError: It has no shared library, or the target is another system.
    """
    if target != "linux" or target_here() != "linux" or sys.maxsize < 1 << 32:
        raise UsageError(
            f"a library with the machines in the program's process is not built for {target}",
            hint="It is for Linux of 64 bits; leave --in-process away.",
        )
    told = sysconfig.get_config_vars()
    if not told.get("Py_ENABLE_SHARED"):
        raise UsageError(
            "this interpreter has no shared library, which the program would load",
            hint="Use a Python that was built with --enable-shared; those of Linux distributions are.",
        )
    name, folder = f"python{told['LDVERSION']}", told["LIBDIR"]
    return ["-I", told["INCLUDEPY"], "-L", folder, f"-l{name}", f"-Wl,-rpath,{folder}"]


def build_library(library: CLibrary, folder: Path, target: str, *, in_process: bool = False) -> Path:
    """Build what `write_library` wrote; return the library.

    Raises:
        UsageError: There is no compiler for this target, or it fails.
    """
    command = build_command(library, target, in_process=in_process)
    row = TARGETS[target]
    compiler = next(filter(None, map(shutil.which, row.compilers)), None)
    if compiler is None or row.only_on not in ("", sys.platform):
        raise UsageError(
            f"{row.compilers[0]}, the compiler for {target}, is not found; the source is in {folder}",
            hint=f"{row.get} Then, there: {' '.join(command)}",
        )
    _run(folder, [compiler, *command[1:]])
    if row.then:
        _run(folder, [each.format(name=library.name) for each in row.then])
    return folder / row.made.format(name=library.name)


def _run(folder: Path, command: list[str]) -> None:
    """Run a command of the compiler.

    Raises:
        UsageError: It fails.
    """
    hint = f"In {folder}: {' '.join(command)}"
    name = Path(command[0]).name
    try:
        ran = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, timeout=_LIMIT_S, check=False
        )
    except subprocess.TimeoutExpired:
        raise UsageError(f"{name} takes longer than {_LIMIT_S} s", hint=hint) from None
    except OSError as error:
        raise UsageError(f"{name} cannot be run: {error.strerror}", hint=hint) from None
    if ran.returncode:
        raise UsageError(f"{name} fails: {ran.stderr.strip()[:_MOST_SHOWN]}", hint=hint)
