"""What a LinuxCNC INI file names beside it: folders of programs, parameters, tools; and its own numbers."""

from __future__ import annotations

import math
import re
from pathlib import Path

from polycnc.runner.machine_sources._facts import LeftOut, Settings
from polycnc.runner.machine_sources._tool_table import LARGEST_BYTES, Tool, table_rows

_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?")
_SECTION = re.compile(r"\s*\[([^\]]+)\]")
_REMAP = re.compile(r"REMAP\s*=\s*([A-Za-z](?:[0-9]+(?:\.[0-9])?)?)(?![^\s])")
_DOES = re.compile(r"\b(?:ngc|python)\s*=\s*[\w.-]+")
_FOLDERS = ("DISPLAY.PROGRAM_PREFIX", "RS274NGC.SUBROUTINE_PATH")
_MOST_SETTINGS = 10_000


def programs_of(settings: Settings, *, inch: bool) -> tuple[dict[str, object], tuple[LeftOut, ...]]:
    """Return the table `programs` of a machine file, and what of it is not there."""
    folder = Path(settings.file).parent
    left: list[LeftOut] = []
    programs: dict[str, object] = {}
    folders: list[str] = []
    for name in _FOLDERS:
        entry = settings.get(name)
        for part in [] if entry is None else entry.text.split(":"):
            path = _beside(folder, part)
            if path is not None and path.is_dir():
                folders.append(str(path.resolve()))
            elif part.strip():
                left.append(LeftOut(f"{name} = {part.strip()}", "there is no such folder"))
    if folders:
        programs["folders"] = tuple(dict.fromkeys(folders))
    if (entry := settings.get("RS274NGC.PARAMETER_FILE")) is not None:
        path = _beside(folder, entry.text)
        if path is not None and path.is_file():
            programs["parameter_file"] = str(path.resolve())
            if inch:
                programs["parameters_inch"] = True
        else:
            left.append(LeftOut(f"RS274NGC.PARAMETER_FILE = {entry.text}", "there is no such file"))
    return programs, tuple(left)


def remaps_of(text: str, file: str) -> dict[str, str]:
    """Return the codes that the file defines anew, with where it says so and what it puts in their place."""
    found: dict[str, str] = {}
    section = ""
    for number, line in enumerate(text.splitlines(), 1):
        if match := _SECTION.match(line):
            section = match[1]
        elif section == "RS274NGC" and (match := _REMAP.match(line)):
            what = f" ({does[0]})" if (does := _DOES.search(line)) else ""
            found.setdefault(match[1].upper(), f"line {number} of {Path(file).name}{what}")
    return found


def numbers_of(settings: Settings) -> dict[str, dict[str, float]]:
    """Return every number of the file by section and name, which programs can read."""
    found: dict[str, dict[str, float]] = {}
    for name, entry in list(settings.entries.items())[:_MOST_SETTINGS]:
        section, _, key = name.partition(".")
        if _NUMBER.fullmatch(entry.text) and math.isfinite(value := float(entry.text)):
            found.setdefault(section, {})[key] = value
    return found


def tools_of(settings: Settings, to_mm: float) -> tuple[dict[int, Tool], tuple[LeftOut, ...]]:
    """Return the tools of the table that the file names, and what of them has no place.

    Raises:
        ConfigurationError: a line of the table is wrong.
    """
    entry = settings.get("EMCIO.TOOL_TABLE")
    if entry is None:
        return {}, ()
    path = _beside(Path(settings.file).parent, entry.text)
    try:
        if path is None or not path.is_file():
            raise OSError
        with path.open("rb") as file:
            content = file.read(LARGEST_BYTES + 1)
    except (OSError, ValueError):
        return {}, (LeftOut(f"EMCIO.TOOL_TABLE = {entry.text}", "there is no such file"),)
    if len(content) > LARGEST_BYTES:
        raise entry.error(f"the tool table {path} is too large", "Name another file.")
    found = dict(table_rows(content.decode("utf-8", "replace"), str(path), to_mm))
    left = (
        LeftOut(f"{letter} of tool {number}", "tools shift X, Y and Z")
        for number, (_, letters) in found.items()
        for letter in letters
    )
    return {number: tool for number, (tool, _) in found.items()}, tuple(left)


def _beside(folder: Path, name: str) -> Path | None:
    """Return a path that an INI file names, relative to its folder; None where no file can have that name."""
    name = name.strip()
    if not name or "\0" in name:
        return None
    try:
        path = Path(name).expanduser()
    except RuntimeError:
        return None
    return path if path.is_absolute() else folder / path
