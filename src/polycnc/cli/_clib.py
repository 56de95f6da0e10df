"""``polycnc clib``: C libraries with the makers' names, which lead programs to served machines."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from polycnc.cli._output import say


def clib_command(
    kind: Annotated[
        str, typer.Argument(help="fanuc (fwlib32), imc (IMCnet) or apci (mcug3).", metavar="KIND")
    ],
    folder: Annotated[Path, typer.Option("--output", "-o", help="Where to write.", metavar="DIR")] = Path(),
    target: Annotated[
        str | None, typer.Option(help="linux, win32, win64 or macos; absent: this computer.", metavar="NAME")
    ] = None,
    source_only: Annotated[bool, typer.Option(help="Write header and source, and build nothing.")] = False,
) -> None:
    """Write header and source of a C library, and build it with gcc, clang or mingw-w64."""
    from polycnc.servers.calls import build_command, build_library, library_of, target_here, write_library

    library = library_of(kind)
    wanted = target or target_here()
    build_command(library, wanted)  # refuses a target that there is not
    for path in write_library(library, folder):
        say(str(path))
    if not source_only:
        say(str(build_library(library, folder, wanted)))
