"""``polycnc clib``: C libraries with the makers' names, which lead programs to served machines."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from polycnc.cli._errors import PROGRAM
from polycnc.cli._output import say

if TYPE_CHECKING:
    from polycnc.controllers.library.clib import CLibrary


def clib_command(
    kind: Annotated[
        str, typer.Argument(help="fanuc (fwlib32), imc (IMCnet) or apci (mcug3).", metavar="KIND")
    ],
    folder: Annotated[Path, typer.Option("--output", "-o", help="Where to write.", metavar="DIR")] = Path(),
    target: Annotated[
        str | None, typer.Option(help="linux, win32, win64 or macos; absent: this computer.", metavar="NAME")
    ] = None,
    source_only: Annotated[bool, typer.Option(help="Write header and source, and build nothing.")] = False,
    packing: Annotated[
        int,
        typer.Option(
            help="To how many bytes the program packs structures; 0: as the manual has them.",
            metavar="N",
            min=0,
            max=8,
        ),
    ] = 0,
    in_process: Annotated[
        bool, typer.Option(help="Have the machines in the program's own process (Linux, 64 bits).")
    ] = False,
    missing: Annotated[
        Path | None,
        typer.Option(
            help="Write nothing: say what this program needs and the library has not.", metavar="PROGRAM"
        ),
    ] = None,
) -> None:
    """Write header and source of a C library, and build it with gcc, clang or mingw-w64."""
    from polycnc.errors import UsageError
    from polycnc.servers.calls import build_command, build_library, library_of, target_here, write_library

    library = library_of(kind)
    if missing is not None:
        _say_missing(missing, library)
        return
    packed = library.packed(packing)
    if packed is None:
        known = ", ".join(map(str, sorted({0, *library.packings})))
        raise UsageError(f"{library.name} is not packed to {packing} bytes", hint=f"There is {known}.")
    library = packed
    wanted = target or target_here()
    build_command(library, wanted, in_process=in_process)  # refuses a target that there is not
    for path in write_library(library, folder, in_process=in_process):
        say(str(path))
    if not source_only:
        say(str(build_library(library, folder, wanted, in_process=in_process)))


def _say_missing(program: Path, library: CLibrary) -> None:
    """Say which functions of a library a program takes that we do not have; status 1 if there are any."""
    from polycnc.servers.calls import missing_of

    taken, absent = missing_of(program, library)
    say(
        f"{program.name} takes {len(taken)} functions from {library.name}, of which {len(absent)} are missing"
    )
    for name in absent:
        say(name)
    idle = [name for name in taken if name in library.left_out]
    for name in idle:
        say(f"{name} has no effect: {library.left_out[name]}")
    for name in filter(library.extensions.__contains__, taken):
        made = library.extensions[name].__name__
        say(
            f"{name} has no effect with the manual's record, which has no place for the value; {made} has one"
        )
    if absent:
        sys.exit(PROGRAM)
