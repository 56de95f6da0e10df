"""The language of a dialect, made for one run."""

from __future__ import annotations

from pathlib import Path

from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.sources._block_source import Language


def language_for(dialect: Dialect, folders: tuple[Path, ...] = ()) -> Language | None:
    """Return the language of a dialect for one run, None if it has none that needs no control.

    Sub-programs in files of their own are also looked for in `folders`.
    """
    match dialect.language:
        case "macro":
            from polycnc.nc.macro import MacroLanguage

            return MacroLanguage()
        case "rs274":
            from polycnc.nc.rs274 import NgcLanguage

            return NgcLanguage(folders)
        case _:
            return None
