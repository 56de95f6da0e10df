"""Write the page of a view: what it says and shows, as plain data and arrays."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig
from polycnc.nc import ProgramText
from polycnc.runner._blocks import KINDS
from polycnc.runner._outcome import RunOutcome, counted, time_text
from polycnc.runner._rotation import turning_axes
from polycnc.runner.view._film import Film, film_of
from polycnc.runner.view._listing import Listing
from polycnc.runner.view._load import loads
from polycnc.runner.view._motion import DERIVATIVES
from polycnc.runner.view._part_frame import with_part_frame
from polycnc.runner.view._picture import Axes, columns_of, kinematics, places, tool_shapes, zero_of_work
from polycnc.runner.view._track import Track
from polycnc.web import Page

_TYPES = {
    np.dtype(np.float64): "f8",
    np.dtype(np.float32): "f4",
    np.dtype(np.int32): "i4",
    np.dtype(np.uint16): "u2",
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
    result: RunOutcome,
    axes: Axes,
    track: Track,
    texts: dict[str, ProgramText],
    beside: Beside | None = None,
    *,
    inch: bool | None = None,
    rest: Track | None = None,
) -> str:
    """Return the HTML of a view; `axes` are names and units, with `inch` lengths are shown so, else as programmed.

    `rest` is what could be read after an alarm.
    """
    machine = result.config
    if machine is not None and [axis.name for axis in machine.axes] != [name for name, _ in axes]:
        machine = None
    if machine is not None and beside is None and turning_axes(machine):
        track = with_part_frame(track, machine)
    listing = Listing(result, track, texts)
    columns = _columns(track, listing, axes, machine, beside)
    if rest is not None:
        columns["rest_tip"] = _single(places(rest, axes, machine if "tip" in columns else None))
        columns["rest_rapid"] = rest.rapid.astype(np.uint8)
    zero, programmed_inch = zero_of_work(track, axes, machine)
    about = _about(result, axes, track, listing, beside)
    about |= {
        "zero": zero,
        "inch": programmed_inch if inch is None else inch,
        "tips": columns_of(axes) if "tip" not in columns else None,
        "chain": kinematics(machine) if "tip" in columns else [],
        "shapes": tool_shapes(
            sorted(set(track.blocks.tool.tolist())),
            machine,
            texts,
            None if result.machined is None else result.machined.tools,
        ),
        "lathe": _is_lathe(axes, machine),
    }
    if result.machined is not None:
        about["stock"] = _stock(film_of(result.machined), result.machined.zero_mm, columns)
        found, about["load_s"] = loads(
            result.machined.engagement, float(track.t_s[-1]) if len(track.t_s) else 0.0
        )
        columns |= {f"load_{name}": each for name, each in found.items()}
    blob, about["columns"] = _packed(columns)
    shell = Page(_own("page.html"), _own("page.css"), "view.js", _modules(), "polycnc view")
    title = result.program.encode("utf-8", "replace").decode()
    return shell.html(title, {"about": json.dumps(about, allow_nan=False).encode(), "data": blob})


def _stock(
    film: Film, zero_mm: tuple[float, float, float], columns: dict[str, npt.NDArray[Any]]
) -> dict[str, Any]:
    """Add the columns of a body that is cut; return what they mean, in machine coordinates."""
    columns["stock_begin"] = film.begin
    columns["stock_s"] = film.ends
    columns["stock_counts"] = film.counts
    columns["stock_cells"] = np.diff(film.cells, prepend=np.int32(0)).astype(np.int32)
    columns["stock_levels"] = film.levels
    return {
        "kind": film.kind,
        "first": [first + zero for first, zero in zip(film.first_mm, zero_mm, strict=True)],
        "cell": film.cell_mm,
        "level": film.level,
        "size": list(film.begin.shape[::-1]),
    }


def _modules() -> dict[str, str]:
    """Return the modules that only a view has."""
    folder = resources.files("polycnc.runner.view")
    return {each.name: each.read_text("utf-8") for each in folder.iterdir() if each.name.endswith(".js")}


def _is_lathe(axes: Axes, machine: MachineConfig | None) -> dict[str, bool] | None:
    """Return what is special in the picture of a lathe, None for another machine."""
    if [name for name, unit in axes if unit == "mm"] != ["X", "Z"]:
        return None
    return {"diameters": machine is not None and any(axis.is_diameter for axis in machine.axes)}


def _columns(
    track: Track, listing: Listing, axes: Axes, machine: MachineConfig | None, beside: Beside | None
) -> dict[str, npt.NDArray[Any]]:
    """Return what the page shows, as arrays."""
    own = track.position[:, : len(axes)]
    columns: dict[str, npt.NDArray[Any]] = {
        "t_s": track.t_s,
        "position": _single(own),
        "feed": (track.feed_mm_s * 60.0).astype(np.float32),
        "rapid": track.rapid.astype(np.uint8),
        "start_s": np.ascontiguousarray(track.start_s, dtype=np.float64),
        "number": track.number.astype(np.int32),
        "block_row": listing.rows_of(track.blocks),
        "block_tool": np.ascontiguousarray(track.blocks.tool),
        "block_kind": np.ascontiguousarray(track.blocks.kind),
        "line": listing.lines.astype(np.int32),
        "zero_s": np.array(track.zeros.start, np.float64) * track.cycle_s,
        "zero": np.ascontiguousarray(track.zeros.offsets(len(axes)).T),
    }
    if track.power is not None:
        columns["power"] = track.power.astype(np.float32)
    tips = places(track, axes, machine)
    if not np.array_equal(tips, places(track, axes, None)):
        columns["tip"] = _single(tips)
    motion = track.motion
    if motion.low.shape[2] == len(axes):
        columns["motion_low"] = np.ascontiguousarray(motion.low.transpose(1, 2, 0), dtype=np.float32)
        columns["motion_high"] = np.ascontiguousarray(motion.high.transpose(1, 2, 0), dtype=np.float32)
    if beside is not None:
        columns["other_t_s"] = beside.track.t_s
        columns["other_tip"] = _single(places(beside.track, axes, None))
    return columns


def _single(rows: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    """Return rows as columns, one after the other, in single precision."""
    return np.ascontiguousarray(rows.T, dtype=np.float32)


def _about(
    result: RunOutcome, axes: Axes, track: Track, listing: Listing, beside: Beside | None
) -> dict[str, Any]:
    """Return what the page says of the run."""
    begins = np.cumsum([0.0, *(each.time_s for each in result.operations)]).tolist()
    about: dict[str, Any] = {
        "program": result.program,
        "machine": result.machine,
        "dialect": result.dialect,
        "ok": result.ok,
        "time_s": result.time_s,
        "summary": f"{time_text(result.time_s)} · {counted(result.blocks, 'block')}",
        "path_mm": result.path_mm,
        "axes": [{"name": name, "unit": unit} for name, unit in axes],
        "operations": [
            {
                "name": each.name,
                "tool": each.tool,
                "start_s": begin,
                "time_s": each.time_s,
                "cutting_s": each.cutting_s,
                "row": listing.row_of(each.line),
            }
            for begin, each in zip(begins, result.operations, strict=False)
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
    }
    if beside is not None:
        about["other"] = {
            "name": beside.name,
            "own": beside.own_name,
            "marks": [
                {"text": mark.text, "place": _place(mark.position, axes), "time_s": mark.time_s}
                for mark in beside.marks
            ],
        }
    return about


def _place(position: tuple[float, ...], axes: Axes) -> list[float]:
    return [0.0 if axis is None else position[axis] for axis in columns_of(axes)]


def _note(track: Track, listing: Listing) -> str:
    parts = [f"The path is shown within {track.tolerance_mm:.3g} mm of the record."]
    if track.thinned or not listing.whole:
        parts.append("The program is long: blocks that the picture does not need are left out.")
    return " ".join(parts)


def _packed(columns: dict[str, npt.NDArray[Any]]) -> tuple[bytes, dict[str, dict[str, Any]]]:
    """Return arrays one after the other, each at a multiple of 8 bytes, and where each is."""
    pieces: list[bytes] = []
    places: dict[str, dict[str, Any]] = {}
    at = 0
    for name, column in columns.items():
        data = column.astype(column.dtype.newbyteorder("<"), copy=False).tobytes()
        places[name] = {"type": _TYPES[column.dtype], "at": at, "length": column.size}
        pieces.append(data + bytes(-len(data) % 8))
        at += len(pieces[-1])
    return b"".join(pieces), places


def _own(name: str) -> str:
    return (resources.files("polycnc.runner.view") / name).read_text("utf-8")
