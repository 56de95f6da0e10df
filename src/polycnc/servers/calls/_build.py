"""Write a C library and build it with the compiler that is here."""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from polycnc import __version__
from polycnc.controllers.library.clib import CLibrary, write_definitions, write_header, write_source
from polycnc.errors import UsageError

_MOST_SHOWN = 400
_LIMIT_S = 300


@dataclass(frozen=True, slots=True)
class Target:
    """What a library is built for: its compilers in order, options behind `-o FILE NAME.c`, and how to get one."""

    compilers: tuple[str, ...]
    made: str
    options: tuple[str, ...]
    get: str
    only_on: str = ""


_WINDOWS = ("-shared", "-s", "{name}.def", "-Wl,--out-implib,{name}.lib", "-lws2_32")
TARGETS = {
    "linux": Target(
        ("gcc", "cc", "clang"),
        "lib{name}.so",
        ("-shared", "-fPIC", "-s", "-fvisibility=hidden", "-pthread"),
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


def write_library(library: CLibrary, folder: Path) -> list[Path]:
    """Write header, source and definitions into a folder; return the files.

    Raises:
        UsageError: They cannot be written.
    """
    texts = {
        f"{library.name}.h": write_header(library),
        f"{library.name}.c": write_source(library, __version__),
        f"{library.name}.def": write_definitions(library),
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            (folder / name).write_text(text, "utf-8")
    except OSError as error:
        raise UsageError(
            f"{folder}: cannot be written: {error.strerror}", hint="Name another folder with -o."
        ) from None
    return [folder / name for name in texts]


def build_command(library: CLibrary, target: str, compiler: str = "") -> list[str]:
    """Return the command that builds a library, in its folder.

    Raises:
        UsageError: There is no such target.
    """
    if target not in TARGETS:
        raise UsageError(f"there is no target '{target[:40]}'", hint=f"There are {', '.join(TARGETS)}.")
    row = TARGETS[target]
    made = row.made.format(name=library.name)
    options = [each.format(name=library.name) for each in row.options]
    return [compiler or row.compilers[0], "-std=c99", "-Os", "-o", made, f"{library.name}.c", *options]


def build_library(library: CLibrary, folder: Path, target: str) -> Path:
    """Build what `write_library` wrote; return the library.

    Raises:
        UsageError: There is no compiler for this target, or it fails.
    """
    command = build_command(library, target)
    row = TARGETS[target]
    compiler = next(filter(None, map(shutil.which, row.compilers)), None)
    if compiler is None or row.only_on not in ("", sys.platform):
        raise UsageError(
            f"{row.compilers[0]}, the compiler for {target}, is not found; the source is in {folder}",
            hint=f"{row.get} Then, there: {' '.join(command)}",
        )
    ran = subprocess.run(
        [compiler, *command[1:]], cwd=folder, capture_output=True, text=True, timeout=_LIMIT_S, check=False
    )
    if ran.returncode:
        raise UsageError(
            f"{Path(compiler).name} does not build {library.name} for {target}: {ran.stderr.strip()[:_MOST_SHOWN]}",
            hint=f"In {folder}: {' '.join(command)}",
        )
    return folder / row.made.format(name=library.name)
