"""Commands on their way, as plain data: what a snapshot keeps of the two scans before they take effect."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import partial
from typing import Any

import numpy as np

from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.board._interpolation import Speeds, begin_interpolation, queue_interpolation
from polycnc.controllers.apci.board._jog_commands import jog, search_index, search_reference
from polycnc.controllers.apci.board._shapes import Circle, Helix, Line, SpaceCircle
from polycnc.controllers.apci.board._spool_commands import (
    add_points,
    add_special,
    aim_last_moves,
    reject_queued,
    start_spoolers,
)
from polycnc.controllers.apci.board._units import PathUnits

# How each command begins, and what shapes its path; the names stand in snapshots.
_BEGINNINGS: Mapping[str, Callable[..., Any]] = {
    "jog": jog,
    "search_index": search_index,
    "search_reference": search_reference,
    "interpolation": begin_interpolation,
    "queued_interpolation": queue_interpolation,
    "points": add_points,
    "special": add_special,
    "target_velocity": aim_last_moves,
    "reject": reject_queued,
    "start": start_spoolers,
}
_WITH_SHAPE = (begin_interpolation, queue_interpolation)
_SHAPES: Mapping[str, Callable[..., Any]] = {
    "line": Line,
    "circle": Circle,
    "helix": Helix,
    "circle_in_space": SpaceCircle,
}


def as_data(begin: partial[None]) -> dict[str, Any]:
    """Return how a command begins as plain data."""
    _, *arguments = begin.args  # the board
    name = _name(_BEGINNINGS, begin.func)
    if begin.func not in _WITH_SHAPE:
        return {"name": name, "values": arguments, "named": begin.keywords}
    units, speeds, shape = arguments
    return {
        "name": name,
        "options": begin.keywords,
        "units": [units.velocity_unit, units.acceleration_unit, units.axes, units.weight, units.distance],
        "speeds": [speeds.ac, speeds.vl, speeds.tvl],
        "shape": _name(_SHAPES, type(shape)),
        "named": {each.name: getattr(shape, each.name) for each in fields(shape)},
    }


def from_data(board: CommandedBoard, data: Mapping[str, Any]) -> partial[None]:
    """Return how a command begins on a board.

    Raises:
        KeyError: It is none that there is.
    """
    function = _BEGINNINGS[data["name"]]
    if function not in _WITH_SHAPE:
        return partial(function, board, *data["values"], **data["named"])
    units = PathUnits(*data["units"][:2], *map(np.asarray, data["units"][2:]))
    shape = _SHAPES[data["shape"]](**data["named"])
    return partial(function, board, units, Speeds(*data["speeds"]), shape, **data["options"])


def _name(table: Mapping[str, Callable[..., Any]], function: Callable[..., Any]) -> str:
    return next(name for name, each in table.items() if each is function)
