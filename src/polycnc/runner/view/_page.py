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
from polycnc.runner._blocks import KINDS, ExecutedBlock
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
    on_part = track.position.shape[1] - len(axes)
    listing = _Listing(result, track, texts)
    columns: dict[str, npt.NDArray[Any]] = {
        "t_s": track.t_s,
        "position": np.ascontiguousarray(track.position.T, dtype=np.float32),
        "feed": (track.feed_mm_s * 60.0).astype(np.float32),
        "rapid": track.rapid.astype(np.uint8),
        "start_s": np.ascontiguousarray(track.start_s, dtype=np.float64),
        "number": track.number.astype(np.int32),
        "block_row": listing.rows_of(track.blocks),
        "block_tool": np.array([block.tool for block in track.blocks], np.int32),
        "block_kind": np.array([KINDS.index(block.kind) for block in track.blocks], np.uint8),
        "line": np.array(listing.lines, np.int32),
    }
    motion = track.motion
    if motion.low.shape[2] == len(axes):
        columns["motion_low"] = np.ascontiguousarray(motion.low.transpose(1, 2, 0), dtype=np.float32)
        columns["motion_high"] = np.ascontiguousarray(motion.high.transpose(1, 2, 0), dtype=np.float32)
    if beside is not None:
        columns["other_t_s"] = beside.track.t_s
        columns["other_position"] = np.ascontiguousarray(beside.track.position.T, dtype=np.float32)
    blob, places = _packed(columns)
    about = {
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
        "stretch_s": motion.stretch_s,
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
    return _filled(
        TITLE=html.escape(result.program.encode("utf-8", "replace").decode()),
        STYLE=_asset("page.css"),
        LIBRARY=library,
        ABOUT=_compressed(json.dumps(about, allow_nan=False).encode()),
        DATA=_compressed(blob),
        SCRIPT=_asset("page.js"),
    )


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
        self.lines: list[int] = []  # 0 for the name of a program
        self.texts: list[str] = []
        self._row: dict[tuple[str, int], int] = {}
        executed: dict[str, set[int]] = {}
        for number in np.unique(track.number).tolist():
            executed.setdefault(track.blocks[number].program, set()).add(track.blocks[number].line)
        for name, text in texts.items():
            if len(texts) > 1:
                self.lines.append(0)
                self.texts.append(name)
            rows = _lines(text)
            shown = range(1, len(rows) + 1) if self.whole else sorted(executed.get(name, ()))
            for line in shown:
                self._row[name, line] = len(self.lines)
                self.lines.append(line)
                self.texts.append(rows[line - 1][:_MOST_COLUMNS])
        self._main = next(iter(texts), "")

    def rows_of(self, blocks: tuple[ExecutedBlock, ...]) -> npt.NDArray[np.int32]:
        """Return the row of each block, -1 for one that is not listed."""
        return np.array([self._row.get((block.program, block.line), -1) for block in blocks], np.int32)

    def row_of(self, line: int) -> int:
        """Return the row of a line of the main program, -1 where it is not listed."""
        return self._row.get((self._main, line), -1)

    def remarks(self, result: RunResult) -> list[dict[str, Any]]:
        """Return alarms and remarks with the rows that they are about, -1 where there is none."""
        alarms = [
            {
                "kind": "alarm",
                "text": alarm.text + (f" {alarm.hint}" if alarm.hint else ""),
                "line": alarm.line,
                "row": self._row.get((alarm.file or self._main, alarm.line), -1),
                "time_s": alarm.time_s,
            }
            for alarm in result.alarms
        ]
        return alarms + [
            {
                "kind": "remark",
                "text": message.text + (f" ({message.count} times)" if message.count > 1 else ""),
                "line": message.line,
                "row": self._row.get((self._main, message.line), -1),
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
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode("ascii")


def _asset(name: str) -> str:
    return (resources.files("polycnc.runner.view") / name).read_text("utf-8")


def _filled(**parts: str) -> str:
    """Return the template with its places filled in one pass, so that no filled text is looked at again."""
    pieces = _asset("page.html").split("%%")
    return "".join(parts[piece] if i % 2 else piece for i, piece in enumerate(pieces))
