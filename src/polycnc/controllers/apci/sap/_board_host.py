"""The board as its SAP tasks see it: commands, system variables and axis qualifiers by the manual's names."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from polycnc.controllers.apci.board import _axis_commands as axis_commands
from polycnc.controllers.apci.board import _jog_commands as jogs
from polycnc.controllers.apci.board import _spool_commands as spooler
from polycnc.controllers.apci.board._move_commands import (
    MOVES,
    Circle,
    Helix,
    Kind,
    Line,
    SpaceCircle,
    Speeds,
    go,
    queue,
)
from polycnc.controllers.apci.board._numbers import is_number
from polycnc.controllers.apci.core._state import Whole
from polycnc.controllers.apci.sap import AXIS_QUALIFIERS, Call, Tasks
from polycnc.controllers.apci.sap._commands import INTEGER
from polycnc.controllers.apci.sap._compiled_turns import CompiledTurns
from polycnc.errors import UsageError

if TYPE_CHECKING:
    from polycnc.controllers.apci.board._board import Board

Command: TypeAlias = Callable[["Board", Call], None]


def _numbers(call: Call) -> tuple[float, ...]:
    """Return the arguments of a call that are plain numbers."""
    return tuple(number for number in call.numbers if not isinstance(number, tuple))


def _speeds(call: Call) -> Speeds:
    return Speeds(*(call.path or (0.0, 0.0, 0.0)))


def _with_values(command: Callable[[Board, Sequence[int], Sequence[float]], None]) -> Command:
    return lambda board, call: command(board, call.axes, call.values)


def _with_axes(command: Callable[[Board, Sequence[int]], None]) -> Command:
    return lambda board, call: command(board, call.axes)


def _helix(call: Call) -> tuple[Sequence[float], float, Sequence[float]]:
    phi, *end = _numbers(call)
    return call.values[:2], phi, (*(end or (0.0, 0.0)), *call.values[2:])


def _space(call: Call) -> tuple[Sequence[float], Sequence[float], float]:
    *normal, phi = _numbers(call)
    return call.values, normal, phi


_SHAPES: Mapping[Kind, Callable[[Call], tuple[Any, ...]]] = {  # what a statement gives to each
    Line: lambda call: (call.values,),
    Circle: lambda call: (call.values, _numbers(call)[0]),
    Helix: _helix,
    SpaceCircle: _space,
}


def _move(kind: Kind, relative: bool, verb: Callable[..., None]) -> Command:
    def run(board: Board, call: Call) -> None:
        verb(board, call.axes, kind(*_SHAPES[kind](call), relative=relative), _speeds(call))

    return run


def _points(relative: bool) -> Command:
    def run(board: Board, call: Call) -> None:
        size, points, *index = call.numbers
        if isinstance(size, tuple) or not isinstance(points, tuple):
            raise UsageError(f"{call.name} takes a count and an array", hint="give both")
        chosen = points[: int(size)]
        number = -1 if not index or isinstance(index[0], tuple) else int(index[0])
        spooler.spd(board, call.axes[0], chosen, relative=relative, index=number)

    return run


def _ssf(board: Board, call: Call) -> None:
    command, value = _numbers(call)
    spooler.ssf(board, call.axes[0], int(command), value)


def _shp(board: Board, call: Call) -> None:
    for axis, position in zip(call.axes, call.values, strict=True):
        axis_commands.shp(board, axis, position)


def _uf(board: Board, call: Call) -> None:
    for axis in call.axes:
        board.update_filter(axis)


def _lps(board: Board, call: Call) -> None:
    axis_commands.lps(board, call.axes[0], int(_numbers(call)[0]))


def _clear_ci99(board: Board, _: Call) -> None:
    board.state.ci[99] = 0


def _rdigi(board: Board, call: Call) -> None:
    for i in call.axes:
        board.axes[i].reset_signals()


def _rifs(board: Board, _: Call) -> None:
    board.variables.interface.reset_errors()


COMMANDS: Mapping[str, Command] = {
    **{name: _move(*move, go) for name, move in MOVES.items()},
    **{f"s{name}": _move(*move, queue) for name, move in MOVES.items()},
    **{name: _with_values(getattr(jogs, name)) for name in ("ja", "jr", "jhi")},
    **{name: _with_axes(getattr(jogs, name)) for name in ("jhl", "jhr", "js", "ms")},
    **{
        name: _with_axes(getattr(axis_commands, name))
        for name in ("cl", "clv", "ol", "ra", "utrovr", "RPtoDP")
    },
    **{name: _with_axes(getattr(spooler, name)) for name in ("ssms", "sstps", "sdels")},
    "shp": _shp,
    "uf": _uf,
    "lps": _lps,
    "ssf": _ssf,
    "spd": _points(False),
    "spda": _points(False),
    "spdr": _points(True),
    "sstvl": lambda board, call: spooler.sstvl(board, call.axes, _numbers(call)[0]),
    "szpa": lambda board, call: axis_commands.szpa(board, call.axes[0], _numbers(call)[0]),
    "szpr": lambda board, call: axis_commands.szpr(board, call.axes[0], _numbers(call)[0]),
    "azo": lambda board, call: axis_commands.azo(board, int(_numbers(call)[0])),
    "rs": lambda board, call: board.reset(),
    "ClearCI99": _clear_ci99,
    "rdigi": _rdigi,
    "rifs": _rifs,
}

_ON_BOARD = ("modereg", "nfrax", "trovr", "trovrst")
_LIGHTS = ("ledgn", "ledrd", "ledyl")
_VARIABLES = ("pu", "tu", "trac", "trvl", "trtvl", "irqpc", *_LIGHTS)


class BoardHost:
    """Lend a board to its tasks; see `sap.Host`."""

    def __init__(self, board: Board) -> None:
        self.board = board

    @property
    def scan(self) -> int:
        """Number of the present scan."""
        return self.board.clock.cycles

    @property
    def scan_s(self) -> float:
        """Scan time (s)."""
        return self.board.clock.cycle_s

    def axis_index(self, name: str) -> int | None:
        """Return the index of the axis called `name`, or A1, A2, ... by its number; None if there is none."""
        given = [each.upper() for each in self.board.config.axis_names]
        numbered = [f"A{number}" for number in range(1, len(given) + 1)]
        known = given if name.upper() in given else numbered
        return known.index(name.upper()) if name.upper() in known else None

    def call(self, call: Call) -> None:
        """Give a command; one with a number that no board can be given does nothing, as from the PC."""
        numbers = (*call.values, *_flat(call.numbers), *(call.path or ()))
        if all(map(is_number, numbers)):
            COMMANDS[call.name](self.board, call)

    def profile_ended(self, axes: tuple[int, ...]) -> bool:
        """Tell whether all of `axes` have reached the end of their profiles."""
        return not any(self.board.axes[i].is_busy for i in axes)

    def read_system(self, name: str, index: int | None) -> float:
        """Return a system variable."""
        board = self.board
        if name in _VARIABLES:
            return float(getattr(board.variables, name))
        if name in _ON_BOARD or name == "errorreg":
            return float(getattr(board, name))
        return float(self.system_field(name)[_checked(index)])

    def write_system(self, name: str, index: int | None, value: float) -> None:
        """Set a system variable; the overrides not to a number that no board can be given."""
        board = self.board
        if name in ("trovr", "trovrst") and not is_number(value):
            return
        if name == "irqpc":
            board.raise_interrupt(bool(value))
        elif name in _VARIABLES:
            kind = float if name in ("trac", "trvl", "trtvl") else int
            setattr(board.variables, name, int(value != 0) if name in _LIGHTS else kind(value))
        elif name in _ON_BOARD:
            setattr(board, name, value if name in ("trovr", "trovrst") else int(value))
        else:
            self.system_field(name)[_checked(index)] = value

    def system_field(self, name: str) -> Any:
        """Return a field of system variables."""
        board = self.board
        fields = {
            "ci": board.state.ci,
            "cd": board.state.cd,
            "sysvarint": board.sysvarint,
            "sysvardbl": board.sysvardbl,
        }
        return fields[name]

    def axis_field(self, axis: int, name: str) -> Any:
        """Return a field of variables of an axis."""
        return {"varint": self.board.axes[axis].varint, "vardbl": self.board.axes[axis].vardbl}[name]

    def velocity_unit_s(self, axis: int) -> float:
        """Return by what velocities of an axis are multiplied for programs."""
        return self.board.axes[axis].time_unit_s

    def alarms(self, axis: int) -> int:
        """Return the bits of digi that no scan changes."""
        return self.board.axes[axis].alarms

    def read_axis(self, axis: int, name: str, index: int | None) -> float:
        """Return an axis qualifier."""
        one = self.board.axes[axis]
        if index is not None:
            return float(self.axis_field(axis, name)[_checked(index, 100)])
        return float(getattr(one, name))

    def write_axis(self, axis: int, name: str, index: int | None, value: float) -> None:
        """Set an axis qualifier; to a number that no board can be given only where it is just a variable."""
        if index is None and not is_number(value):
            return
        if index is not None:
            self.axis_field(axis, name)[_checked(index, 100)] = value
        else:
            is_whole = AXIS_QUALIFIERS[name.lower()].kind == INTEGER
            setattr(self.board.axes[axis], name, int(value) if is_whole else value)

    def common_buffer(self, task: int) -> bytearray:
        """Return the common buffer of a task."""
        return self.board.variables.buffers[task]


def _flat(numbers: Sequence[float | tuple[float, ...]]) -> list[float]:
    """Return numbers and those of tables one after another."""
    return [each for part in numbers for each in (part if isinstance(part, tuple) else (part,))]


def _checked(index: int | None, count: int = 1000) -> int:
    if index is None or not 0 <= index < count:
        raise UsageError(f"there is no variable {index}", hint=f"they have the numbers 0 to {count - 1}")
    return index


class BoardTasks(Tasks):
    """The four tasks of a board, in its time."""

    def __init__(self, board: Board) -> None:
        host = BoardHost(board)
        super().__init__(host)
        budget = board.config.rulings.instructions_per_scan
        self._turns = CompiledTurns(self.each, host, (board.state, board.kernel), budget)
        board.tasks = self

    def turns(self) -> Whole:
        """Give the tasks their turns in this scan; return the call that gives them those of the scans that follow."""
        return self._turns.give()
