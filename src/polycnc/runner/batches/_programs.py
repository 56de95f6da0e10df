"""Which files of folders are part programs."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from polycnc.errors import UsageError
from polycnc.nc import DIALECTS, load_dialect

_COMMON = (".nc", ".cnc", ".iso", ".din", ".mpf", ".spf", ".ngc", ".gcode", ".eia", ".min", ".pim", ".ptp")
_NUMBERED = re.compile(r"[OP%][0-9]{1,8}", re.IGNORECASE)


def program_extensions() -> tuple[str, ...]:
    """Return the endings of files that are taken for part programs in a folder."""
    known = {extension for name in DIALECTS for extension in load_dialect(name).extensions}
    return tuple(sorted({*_COMMON, *known}))


def find_programs(paths: Iterable[str | Path], patterns: Sequence[str] = ()) -> list[Path]:
    """Return the programs that paths name: files as they are, and what looks like programs under folders.

    With `patterns` ("*.txt") those of a folder are the files whose names match one.

    Raises:
        UsageError: there is no such file or folder, no program anywhere, or a pattern is empty.
    """
    for pattern in patterns:
        if not Path(pattern).parts:
            raise UsageError(f"'{pattern}' is no pattern of names", hint="Write one like '*.txt'.")
    found: dict[Path, None] = {}
    given = [Path(path) for path in paths]
    for path in given:
        if path.is_dir():
            found |= dict.fromkeys(each for each in sorted(path.rglob("*")) if _wanted(each, path, patterns))
        elif path.exists():
            found[path] = None
        else:
            raise UsageError(f"no such file or folder: {path}", hint="Check the name and the folder.")
    if not found:
        places = ", ".join(map(str, given)) or "nothing"
        what = " or ".join(patterns) if patterns else ", ".join(program_extensions())
        raise UsageError(
            f"there is no program in {places}",
            hint=f"Looked for {what}; --pattern '*.xyz' looks for other names.",
        )
    return list(found)


def _wanted(path: Path, folder: Path, patterns: Sequence[str]) -> bool:
    if any(part.startswith(".") for part in path.relative_to(folder).parts) or not path.is_file():
        return False
    if patterns:
        return any(path.match(pattern) for pattern in patterns)
    return path.suffix.lower() in program_extensions() or _NUMBERED.fullmatch(path.name) is not None
