"""Scenes of the macro language: files with cases to read, and under each what the living post-processor makes of it.

A case begins with `== ` and its title. Then stand settings as TOML (words in capitals; a list of values calls the
macros once for each; `control` names the control file beside, `whole` says that the lines are one, `saved` its
encoding, all else are parameters), and after `  > ` the lines; `---` begins the next macro. What comes out is
written under it:

    |block|     what the macros write, called one after the other, the last one as LINEAR
    +|block|    what the last one writes for three more moves with another feed: one by one, along a path, at once alike
    =|block|    what shows the state that they leave: STOP of the control file
    ! line      an error, as a user reads it
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.errors import PolycncError
from polycnc.post import (
    BlockMap,
    ControlFile,
    MacroRun,
    load_control,
    parse_control,
    parse_tool_path,
    post_program,
    program_file,
)

RECORDED = Path(__file__).resolve().parents[1] / "golden" / "post" / "scenes"
_CODECS = {"utf-8": "utf-8", "ascii": "ascii", "shift-jis": "cp932"}
_MACROS = ("PATH_START", "RAPID", "PATH_END", "LINEAR")
_ROW = ("X", "Y", "Z", "STARTX", "STARTY", "STARTZ")
_STEPS = np.array([[1.25, -2.5, 0.0], [1.25, -2.5, 0.75], [-30.5, 0.0625, 0.75]])
_OUTPUT = ("  |", "  +", "  =", "  !", "  .")

Rows = npt.NDArray[np.float64]
Feed = tuple[float, float]
Moves = Callable[[MacroRun, Rows, Feed], str | None]


@dataclass
class Case:
    """A case of a scene: its settings, its lines, and all its input as it stands."""

    settings: dict[str, Any] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)
    source: list[str] = field(default_factory=list)


def read_cases(text: str) -> Iterator[Case]:
    """Yield the cases of a scene, without what is written of them; first what stands before them."""
    case = Case()
    for line in text.split("\n"):
        if line.startswith(_OUTPUT):
            continue
        if line.startswith("== "):
            yield case
            case = Case()
        case.source.append(line)
        if line.startswith("  >") or line == "---":
            case.lines.append(line.removeprefix("  >").removeprefix(" "))
        elif line and not line.startswith(("#", "==")):
            case.settings |= tomllib.loads(line)
    yield case


def lines_of(scene: str) -> list[str]:
    """Return the lines of all cases of a scene."""
    text = (RECORDED / f"{scene}.txt").read_text(encoding="utf-8")
    return ["\n".join(case.lines) for case in read_cases(text)]


def played(scene: str, folder: Path) -> str:
    """Return a scene with what its cases write now."""
    found: list[str] = []
    for case in read_cases((RECORDED / f"{scene}.txt").read_text(encoding="utf-8")):
        source = case.source
        while source and not source[-1]:
            source.pop()
        found += source
        if source and source[0].startswith("== "):
            found += _outcome(case, folder)
        found.append("")
    return "\n".join(found[:-1]) + "\n"


def _outcome(case: Case, folder: Path) -> list[str]:
    settings = dict(case.settings)
    words = {name: settings.pop(name) for name in list(settings) if name.isupper()}
    names: tuple[str, ...]
    try:
        if name := settings.pop("posted", ""):
            return _posted("\n".join(case.lines), _control({}, {"control": name, **settings}), folder)
        if settings.pop("whole", False):
            names = ("LINEAR",)
            control = _saved("\n".join(case.lines), settings.pop("saved", "utf-8"), folder)
        else:
            macros = "\n".join(case.lines).split("\n---\n")
            names = _MACROS[-len(macros) :]
            control = _control(dict(zip(names, macros, strict=True)), settings)
    except PolycncError as error:
        return _error(error)
    ways = [_way(control, names, words, way) for way in (_one_by_one, _along, _at_once)]
    assert all(way in (ways[0], None) for way in ways), f"{case.source[0]}: the ways of moves differ: {ways}"
    return ways[0] or []


def _control(macros: Mapping[str, str], settings: dict[str, Any]) -> ControlFile:
    text = (RECORDED / f"{settings.pop('control', 'mill')}.toml").read_text(encoding="utf-8")
    if origin := settings.pop("origin", None):
        settings["machining_origin"] = dict(zip("XYZ", origin, strict=True))
    for key, value in settings.items():
        text = re.sub(rf"(?m)^{key} = .*\n", "", text, count=1)
        line = f"{key} = {_toml(value)}"
        text = text.replace("[parameters]\n", f"[parameters]\n{line}\n", 1)
    body = "".join(f"{name} = '''\n{lines}'''\n" for name, lines in macros.items())
    return parse_control(f"{text}\n{body}", "scene.toml")


def _toml(value: object) -> str:
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {_toml(each)}' for key, each in value.items())} }}"
    return json.dumps(value, ensure_ascii=False)


def _saved(text: str, encoding: str, folder: Path) -> ControlFile:
    """Read a control file as it is read from a disk."""
    path = folder / "scene.toml"
    path.write_bytes(text.encode(encoding))
    return load_control(path)


def _posted(path: str, control: ControlFile, folder: Path) -> list[str]:
    """Post a tool path into a file; return its blocks with the lines that they come from, and what is remarked."""
    file, codec, blocks = folder / "scene.nc", _CODECS[control.parameters.encoding], BlockMap()
    file.unlink(missing_ok=True)
    try:
        with program_file(file, control.parameters) as out:
            summary = post_program(parse_tool_path(path, "scene.cl"), control, out.write, block_map=blocks)
    except (PolycncError, UnicodeEncodeError) as error:
        assert not file.exists()
        return _error(error)
    found = []
    at = 0
    for number, block in enumerate(file.read_bytes().decode(codec).removesuffix("\n").split("\n"), 1):
        while blocks.last_block[at] < number:
            at += 1
        found.append(f"  |{blocks.line[at] or 'end'}: {block}|".replace("\r", "\\r"))
    lengths = f"{summary.feed_mm:.3f} mm by feed, {summary.rapid_mm:.3f} mm by rapid"
    counts = f"{summary.arcs} arcs, {summary.holes} holes, {summary.tools} tools"
    found.append(f"  . {summary.records} records, {summary.blocks} blocks, {lengths}, {counts}")
    return found + [f"  ! {remark.line}: {remark.text}" for remark in summary.remarks]


def _way(
    control: ControlFile, names: tuple[str, ...], words: Mapping[str, Any], more: Moves
) -> list[str] | None:
    found: list[str] = []
    sign = ""
    run = control.start(lambda block: found.append(f"  {sign}|{block.removesuffix(chr(10))}|"))
    given: dict[str, Any] = {}
    lists = {name: value for name, value in words.items() if isinstance(value, list)}
    for place in range(max(map(len, lists.values()), default=1)):
        given |= {name: value[place] if name in lists else value for name, value in words.items()}
        if lists:
            found.append("  . " + " ".join(f"{name}={given[name]}" for name in lists))
        try:
            for name in names:
                run.call(name, given)
        except PolycncError as error:
            found += _error(error)
    sign = "+"
    given = dict.fromkeys(("X", "Y", "Z", "F"), 0.0) | given
    first = np.array([float(given[name]) for name in "XYZ"])
    rows = np.hstack([first + _STEPS, first - _STEPS])
    if not any(map(control.names, _ROW[3:])):
        rows = rows[:, :3]
    try:
        text = more(run, rows, (float(given["F"]) + 12.5, 95.0))
        if text is None:
            return None
        found += [f"  +|{block}|" for block in text.splitlines()]
    except PolycncError as error:
        found += _error(error)
    sign = "="
    run.call("STOP")
    return found


def _one_by_one(run: MacroRun, rows: Rows, feed: Feed) -> str:
    for row in rows.tolist():
        run.call(
            "LINEAR", dict(zip(_ROW, row, strict=False)) | dict(zip(("F", "FEEDMODE"), feed, strict=True))
        )
    return ""


def _along(run: MacroRun, rows: Rows, feed: Feed) -> str:
    for _ in run.call_along(rows.tolist(), *feed):
        pass
    return ""


def _at_once(run: MacroRun, rows: Rows, feed: Feed) -> str | None:
    run.keep(dict(zip(("F", "FEEDMODE"), feed, strict=True)))
    if run.rows() is None:
        _along(run, rows[:1], feed)  # the first makes modal what is
        rows = rows[1:]
    steady = run.rows()
    if steady is None:
        return None
    text, blocks, done = run.write_rows(steady, rows, np.zeros(len(rows), np.int64))
    assert (text.count("\n"), done) == (blocks, len(rows))
    return text


def _error(error: Exception) -> list[str]:
    text = re.sub(r"[^\s']*scene\.toml", "scene.toml", str(error))
    return [f"  ! {line}".rstrip() for line in text.splitlines()]
