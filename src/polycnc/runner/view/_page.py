"""Write the page of a view: template, library and data in one file that loads nothing from elsewhere."""

from __future__ import annotations

import base64
import gzip
import html
import json
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.nc import ProgramText
from polycnc.runner._blocks import KINDS, Blocks
from polycnc.runner._result import RunResult, counted, time_text
from polycnc.runner.view._motion import DERIVATIVES
from polycnc.runner.view._part_frame import turning_axes, with_part_frame
from polycnc.runner.view._track import Track

_MOST_LINES = 250_000  # of a listing; of longer programs only the lines that the path shows are listed
_MOST_COLUMNS = 400  # of a listed line
_TYPES = {
    np.dtype(np.float64): "f8",
    np.dtype(np.float32): "f4",
    np.dtype(np.int32): "i4",
    np.dtype(np.uint8): "u1",
}


@dataclass(frozen=True)
class Beside:
    """A second path that a view shows beside its own, with the same axes, and places that are to be marked."""

    name: str
    own_name: str
    track: Track
    marks: tuple[Mark, ...] = ()


@dataclass(frozen=True, slots=True)
class Mark:
    """A place that a view marks: what there is, positions of the axes, and when the view's own path comes there."""

    text: str
    position: tuple[float, ...]
    time_s: float | None = None


def page(
    result: RunResult,
    axes: tuple[tuple[str, str], ...],
    track: Track,
    texts: dict[str, ProgramText],
    beside: Beside | None = None,
) -> str:
    """Return the HTML of a view; `axes` are names and units.

    Raises:
        UsageError: plotly is not installed.
    """
    library = plotly_source()
    machine = result.config
    framed = machine is not None and [axis.name for axis in machine.axes] == [name for name, _ in axes]
    if machine is not None and framed and beside is None and turning_axes(machine):
        track = with_part_frame(track, machine)
    listing = _Listing(result, track, texts)
    blob, places = _packed(_columns(track, listing, len(axes), beside))
    about = _about(result, axes, track, listing, places, beside)
    return _filled(
        TITLE=html.escape(result.program.encode("utf-8", "replace").decode()),
        STYLE=_asset("page.css"),
        LIBRARY=library,
        ABOUT=_compressed(json.dumps(about, allow_nan=False).encode()),
        DATA=_compressed(blob),
        SCRIPT=_asset("page.js"),
    )


def _columns(
    track: Track, listing: _Listing, axes: int, beside: Beside | None
) -> dict[str, npt.NDArray[Any]]:
    """Return what the page shows, as arrays."""
    columns: dict[str, npt.NDArray[Any]] = {
        "t_s": track.t_s,
        "position": np.ascontiguousarray(track.position.T, dtype=np.float32),
        "feed": (track.feed_mm_s * 60.0).astype(np.float32),
        "rapid": track.rapid.astype(np.uint8),
        "start_s": np.ascontiguousarray(track.start_s, dtype=np.float64),
        "number": track.number.astype(np.int32),
        "block_row": listing.rows_of(track.blocks),
        "block_tool": np.ascontiguousarray(track.blocks.tool),
        "block_kind": np.ascontiguousarray(track.blocks.kind),
        "line": listing.lines.astype(np.int32),
    }
    motion = track.motion
    if motion.low.shape[2] == axes:
        columns["motion_low"] = np.ascontiguousarray(motion.low.transpose(1, 2, 0), dtype=np.float32)
        columns["motion_high"] = np.ascontiguousarray(motion.high.transpose(1, 2, 0), dtype=np.float32)
    if beside is not None:
        columns["other_t_s"] = beside.track.t_s
        columns["other_position"] = np.ascontiguousarray(beside.track.position.T, dtype=np.float32)
    return columns


def _about(
    result: RunResult,
    axes: tuple[tuple[str, str], ...],
    track: Track,
    listing: _Listing,
    places: dict[str, dict[str, Any]],
    beside: Beside | None,
) -> dict[str, Any]:
    """Return what the page says of the run, and what its arrays mean."""
    on_part = track.position.shape[1] - len(axes)
    about: dict[str, Any] = {
        "program": result.program,
        "machine": result.machine,
        "dialect": result.dialect,
        "ok": result.ok,
        "time_s": result.time_s,
        "summary": f"{time_text(result.time_s)} · {counted(result.blocks, 'block')} · {result.path_mm:,.0f} mm",
        "axes": [
            *({"name": name, "unit": unit} for name, unit in axes),
            *({"name": f"{name} on part", "unit": "mm", "part": True} for name in "XYZ"[:on_part]),
        ],
        "operations": [
            {
                "name": each.name,
                "tool": each.tool,
                "time_s": each.time_s,
                "cutting_s": each.cutting_s,
                "row": listing.row_of(each.line),
            }
            for each in result.operations
        ],
        "derivatives": DERIVATIVES,
        "stretch_s": track.motion.stretch_s,
        "kinds": KINDS,
        "tools": [
            {"tool": tool, "cutting_s": each.cutting_s, "rapid_s": each.rapid_s}
            for tool, each in sorted(result.tool_times.items())
        ],
        "remarks": listing.remarks(result),
        "note": _note(track, listing),
        "text": listing.texts,
        "columns": places,
    }
    if beside is not None:
        about["other"] = {
            "name": beside.name,
            "own": beside.own_name,
            "marks": [
                {"text": mark.text, "position": mark.position, "time_s": mark.time_s} for mark in beside.marks
            ],
        }
    return about


def plotly_source() -> str:
    """Return plotly's JavaScript as its Python package brings it.

    Raises:
        UsageError: plotly is not installed.
    """
    try:
        script = resources.files("plotly") / "package_data" / "plotly.min.js"
    except ModuleNotFoundError:
        raise UsageError("a view needs plotly", hint="Install it: pip install 'polycnc[view]'.") from None
    return script.read_text("utf-8").replace("</script", r"<\/script")


class _Listing:
    """The lines beside the path: of each program that was executed, the main program first."""

    def __init__(self, result: RunResult, track: Track, texts: dict[str, ProgramText]) -> None:
        if result.source is not None:
            texts = {result.source.name: result.source, **texts}
        self.whole = sum(text.content.count(b"\n") + 1 for text in texts.values()) <= _MOST_LINES
        self.texts: list[str] = []
        self._shown: dict[str, tuple[npt.NDArray[np.int64], int]] = {}  # lines, and the row of the first one
        lines: list[npt.NDArray[np.int64]] = []  # 0 for the name of a program
        executed = track.blocks.program[track.number], track.blocks.line[track.number]
        for name, text in texts.items():
            if len(texts) > 1:
                lines.append(np.zeros(1, np.int64))
                self.texts.append(name)
            if self.whole:
                rows = _lines(text)
                shown = np.arange(1, len(rows) + 1)
            else:
                number = track.blocks.names.index(name) if name in track.blocks.names else -1
                shown = np.unique(executed[1][executed[0] == number]).astype(np.int64)
                shown = shown[shown >= 1]
                rows = [text.line(text.line_start(line)) for line in shown.tolist()]
            self._shown[name] = shown, len(self.texts)
            lines.append(shown)
            self.texts += [row[:_MOST_COLUMNS] for row in rows]
        self.lines = np.concatenate([np.zeros(0, np.int64), *lines])
        self._main = next(iter(texts), "")

    def rows_of(self, blocks: Blocks) -> npt.NDArray[np.int32]:
        """Return the row of each block, -1 for one that is not listed."""
        found = np.full(len(blocks), -1, np.int32)
        for number, name in enumerate(blocks.names):
            here = blocks.program == number
            found[here] = self._rows(name, blocks.line[here])
        return found

    def row_of(self, line: int, name: str | None = None) -> int:
        """Return the row of a line of a program, or of the main one; -1 where it is not listed."""
        return int(self._rows(self._main if name is None else name, np.array([line]))[0])

    def _rows(self, name: str, lines: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        shown, first = self._shown.get(name, (np.zeros(0, np.int64), 0))
        if not len(shown):
            return np.full(len(lines), -1)
        place = np.minimum(np.searchsorted(shown, lines), len(shown) - 1)
        return np.where(shown[place] == lines, first + place, -1)

    def remarks(self, result: RunResult) -> list[dict[str, Any]]:
        """Return alarms and remarks with the rows that they are about, -1 where there is none."""
        alarms = [
            {
                "kind": "alarm",
                "text": alarm.text + (f" {alarm.hint}" if alarm.hint else ""),
                "line": alarm.line,
                "row": self.row_of(alarm.line, alarm.file or None),
                "time_s": alarm.time_s,
            }
            for alarm in result.alarms
        ]
        return alarms + [
            {
                "kind": "remark",
                "text": message.text + (f" ({message.count} times)" if message.count > 1 else ""),
                "line": message.line,
                "row": self.row_of(message.line),
                "time_s": None,
            }
            for message in result.messages
        ]


def _lines(text: ProgramText) -> list[str]:
    try:
        decoded = text.content.decode("utf-8")
    except UnicodeDecodeError:
        decoded = text.content.decode("latin-1")
    return decoded.replace("\r\n", "\n").replace("\r", "\n").removesuffix("\n").split("\n")


def _note(track: Track, listing: _Listing) -> str:
    parts = [f"The path is shown within {track.tolerance_mm:.3g} mm of the record."]
    if track.thinned or not listing.whole:
        parts.append("The program is long: blocks that the picture does not need are left out.")
    return " ".join(parts)


def _packed(columns: dict[str, npt.NDArray[Any]]) -> tuple[bytes, dict[str, dict[str, Any]]]:
    """Return arrays one behind the other, each at a multiple of 8 bytes, and where each is."""
    pieces: list[bytes] = []
    places: dict[str, dict[str, Any]] = {}
    at = 0
    for name, column in columns.items():
        data = column.astype(column.dtype.newbyteorder("<"), copy=False).tobytes()
        places[name] = {"type": _TYPES[column.dtype], "at": at, "length": column.size}
        pieces.append(data + bytes(-len(data) % 8))
        at += len(pieces[-1])
    return b"".join(pieces), places


def _compressed(data: bytes) -> str:
    return base64.b64encode(gzip.compress(data, 6, mtime=0)).decode("ascii")


def _asset(name: str) -> str:
    return (resources.files("polycnc.runner.view") / name).read_text("utf-8")


def _filled(**parts: str) -> str:
    """Return the template with its places filled in one pass, so that no filled text is looked at again."""
    pieces = _asset("page.html").split("%%")
    return "".join(parts[piece] if i % 2 else piece for i, piece in enumerate(pieces))
