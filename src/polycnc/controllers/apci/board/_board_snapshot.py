"""The whole state of a board: its arrays, and what Python holds beside them.

Everything is read and made before anything is changed, so a snapshot that does not fit leaves the board as it was.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from polycnc.controllers.apci.board._axis import Axis
from polycnc.controllers.apci.board._beginnings import as_data, from_data
from polycnc.controllers.apci.board._command import Command
from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.controllers.apci.board._system_text import system_file_text
from polycnc.errors import UsageError
from polycnc.machine import Array, Snapshot, arrays_of, damaged_snapshot

_KIND = "board"
_AXIS_VALUES = ("ControllerFlags", "GCR", "alarms")
_BOARD_VALUES = ("pu", "tu", "trac", "trvl", "trtvl", "ledgn", "ledrd", "ledyl", "irqpc")


def take_snapshot(board: CommandedBoard) -> Snapshot:
    """Return the state of a board, with that of its tasks."""
    return Snapshot.take(_KIND, _made_from(board), board.clock.cycles, _arrays(board), _beside(board))


def restore_state(board: CommandedBoard, snapshot: Snapshot) -> None:
    """Go back to a snapshot.

    Raises:
        SnapshotError: It is not of a board like this, or damaged; nothing has changed.
    """
    arrays = _arrays(board)
    snapshot.check(_KIND, _made_from(board), arrays)
    epoch, data = snapshot.moment("epoch"), snapshot.data()
    try:
        changes = _changes(board, data)
    except (KeyError, IndexError, TypeError, ValueError, UsageError) as error:
        raise damaged_snapshot(error, _KIND) from error
    snapshot.restore_state(arrays)
    board.clock.go_back(snapshot.cycle, epoch)
    for change in changes:
        change()


def _made_from(board: CommandedBoard) -> str:
    return f"{board.config.model_dump_json()} {'with' if board.tasks else 'without'} tasks"


def _arrays(board: CommandedBoard) -> list[Array]:
    axes = tuple((axis.varint, axis.vardbl, axis.ctrlparams) for axis in board.axes)
    return arrays_of((board.kernel, board.state, board.sysvarint, board.sysvardbl, axes))


def _beside(board: CommandedBoard) -> dict[str, Any]:
    variables = board.variables
    return {
        "epoch": board.clock.epoch.isoformat(),
        "planned": system_file_text(board.planned),
        "variables": {name: getattr(variables, name) for name in _BOARD_VALUES},
        "buffers": [bytes(each) for each in variables.buffers],
        "interface": list(variables.interface.bits),
        "axes": [
            {name: getattr(axis, name) for name in _AXIS_VALUES} | {"zero_offsets": axis.zero_offsets}
            for axis in board.axes
        ],
        "orders": board.orders,
        "pending": [
            [each.due, each.axes, each.orders, as_data(each.begin), each.moves] for each in board.pending
        ],
        "tasks": None if board.tasks is None else board.tasks.save(),
    }


def _changes(board: CommandedBoard, data: Mapping[str, Any]) -> list[Callable[[], None]]:
    """Return what puts the state beside the arrays back; nothing of it can fail any more."""
    planned = parse_system_file(data["planned"])
    variables = {name: data["variables"][name] for name in _BOARD_VALUES}
    buffers = [bytes(each) for each in data["buffers"]]
    sizes = [len(each) for each in board.variables.buffers]
    hardware, word, down = map(int, data["interface"])
    axes = [({name: int(each[name]) for name in _AXIS_VALUES}, each["zero_offsets"]) for each in data["axes"]]
    orders = [int(each) for each in data["orders"]]
    pending = [
        Command(int(due), tuple(on), tuple(given), from_data(board, begin), bool(moves))
        for due, on, given, begin, moves in data["pending"]
    ]
    if len(axes) != len(board.axes) or len(orders) != len(axes) or [len(each) for each in buffers] != sizes:
        raise ValueError("it has other axes or buffers")
    tasks = None if board.tasks is None else board.tasks.read_saved(data["tasks"])

    def put() -> None:
        board.planned = planned
        for name, value in variables.items():
            setattr(board.variables, name, value)
        for buffer, content in zip(board.variables.buffers, buffers, strict=True):
            buffer[:] = content
        board.variables.interface.bits = (hardware, word, down)
        for axis, (values, offsets) in zip(board.axes, axes, strict=True):
            _put_axis(axis, values, offsets)
        board.orders[:] = orders
        board.pending[:] = pending
        board.units_in_use.clear()

    return [put, *([tasks] if tasks is not None else [])]


def _put_axis(axis: Axis, values: Mapping[str, int], offsets: list[float]) -> None:
    for name, value in values.items():
        setattr(axis, name, value)
    axis.zero_offsets[:] = offsets
