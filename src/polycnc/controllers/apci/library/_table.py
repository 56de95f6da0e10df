"""How read and write functions of registers are made: a register is one row, and the pair of functions comes out.

Four forms, as in the manual: through a record (TSRP), by axis number without or with a code, and for the board. A
register is read by the name of an attribute, or by a function; what else there is to say is its `Rule`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter
from typing import Annotated, Any, TypeAlias, TypeVar

from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import Status
from polycnc.controllers.apci.board._commanded import BoardAxis
from polycnc.controllers.apci.board._numbers import is_number
from polycnc.controllers.apci.board._records import TSRP
from polycnc.controllers.apci.library._call import (
    CODE,
    DOUBLE,
    DOUBLE_AT,
    INT,
    LIBRARY,
    LONG,
    LONG_AT,
    board_call,
    filled_call,
    longint,
    polled_call,
    record_call,
)
from polycnc.controllers.apci.library._session import UNKNOWN_ERROR, Exchange, Session
from polycnc.controllers.library import INOUT, Out, Refused, named

POSITION = "axis unit"
VELOCITY = "axis unit per time unit"
ACCELERATION = "axis unit per time unit²"
DISPLAY = "display unit"
PATH_VELOCITY = "unit of interpolation, PU/TU"
PATH_ACCELERATION = "unit of interpolation, PU/TU²"

F = TypeVar("F", bound=Callable[..., Any])
Get: TypeAlias = str | Callable[[Any], Any]
Put: TypeAlias = Callable[[Any, Any], object]

OnRecord: TypeAlias = Callable[[TSRP], None]
OfAxis: TypeAlias = Callable[[int], Any]
ToAxis: TypeAlias = Callable[[int, float], None]
OfAxisCoded: TypeAlias = Callable[[int], tuple[int, Any]]
ToAxisCoded: TypeAlias = Callable[[int, float], int]
OfBoard: TypeAlias = Callable[[], Any]
ToBoard: TypeAlias = Callable[[float], None]
OfBoardCoded: TypeAlias = Callable[[], tuple[int, Any]]
ToBoardCoded: TypeAlias = Callable[[float], int]


filled_at_once_call = LIBRARY.through(Session.named_in, Annotated[TSRP, INOUT])


def positive(value: float) -> bool:
    """Tell whether a number is greater than 0."""
    return value > 0.0


def not_negative(value: float) -> bool:
    """Tell whether a number is at least 0."""
    return value >= 0.0


@dataclass(frozen=True, slots=True)
class Rule:
    """What is particular about a register.

    Time passes before one is read that is `polled`. `fits` says which numbers can be written, `put` how. `field` is its
    element of the record if that has another name. `kind` is its C type, `number` that of the axis number, `out` the
    name of what is read; `done` is the code of success, and `refused` that of all failures if there is but one.
    """

    polled: bool = False
    fits: Callable[[float], bool] = is_number
    put: Put | None = None
    field: str = ""
    kind: Any = DOUBLE
    number: Any = None
    out: str = "value"
    done: int = Status.DONE
    refused: int | None = None
    note: str = ""


PLAIN = Rule()


def _text(verb: str, what: str, unit: str, rest: str, section: int, rule: Rule) -> str:
    unit, note = f" [{unit}]" if unit else "", f"\n\n{rule.note}" if rule.note else ""
    return f"{verb} {what}{unit}{rest} (Manual 002, 4.4.{section}).{note}"


def _getter(get: Get, rule: Rule) -> Callable[[Any], Any]:
    value_of = attrgetter(get) if isinstance(get, str) else get
    return value_of if rule.kind is not LONG else lambda register: longint(value_of(register))


def _storer(get: Get, rule: Rule) -> Put:
    """Return what writes a register, or refuses to."""
    owner, _, name = str(get).rpartition(".")

    def put(register: Any, value: Any) -> None:
        setattr(attrgetter(owner)(register) if owner else register, name, value)

    write = rule.put or put

    def store(register: Any, value: Any) -> None:
        if not is_number(value) or not rule.fits(value):
            raise Refused(UNKNOWN_ERROR)
        write(register, value)

    return store


def _out(rule: Rule) -> Any:
    return Annotated.__class_getitem__((rule.kind, Out(rule.out)))  # type: ignore[attr-defined]


def _coded(out: Any) -> Any:
    return tuple.__class_getitem__((CODE, out))


def _axis_call(rule: Rule, number: Any) -> Callable[..., Any]:
    find = Session.polled_axis if rule.polled else Session.axis
    return LIBRARY.through(find, rule.number or number, refused=rule.refused)


# ---------------------------------------------------------------------- through a record


def read_record(stem: str, get: Get, what: str, unit: str, section: int, rule: Rule = PLAIN) -> OnRecord:
    """Make the function that reads into an element of a record."""
    element, value_of = rule.field or stem, _getter(get, rule)

    def read(tsrp: Exchange) -> None:
        setattr(tsrp.record, element, value_of(tsrp.axis))

    text = _text("Read", what, unit, f" into `tsrp.{element}`", section, rule)
    call = filled_call if rule.polled else filled_at_once_call
    return call(named(read, f"rd{stem}", text, {"tsrp": Exchange}))


def record_pair(
    stem: str, get: Get, what: str, unit: str, read: int, write: int, rule: Rule = PLAIN
) -> tuple[OnRecord, OnRecord]:
    """Make both functions that go through an element of a record."""
    element, store = rule.field or stem, _storer(get, rule)

    def send(tsrp: Exchange) -> None:
        store(tsrp.axis, getattr(tsrp.record, element))

    text = _text("Write", what, unit, f" from `tsrp.{element}`", write, rule)
    body = named(send, f"wr{stem}", text, {"tsrp": Exchange})
    return read_record(stem, get, what, unit, read, rule), record_call(body)


# ---------------------------------------------------------------------- by axis number


def read_axis(stem: str, get: Get, what: str, unit: str, section: int, rule: Rule = PLAIN) -> OfAxis:
    """Make the function that returns a register of an axis."""
    value_of = _getter(get, rule)

    def read(an: BoardAxis) -> Any:
        return value_of(an)

    text = _text("Read", what, unit, " of axis `an`", section, rule)
    body = named(read, f"rd{stem}", text, {"an": BoardAxis}, _out(rule))
    return _axis_call(rule, LONG)(body)  # type: ignore[no-any-return]


def write_axis(stem: str, get: Get, what: str, unit: str, section: int, rule: Rule = PLAIN) -> ToAxis:
    """Make the function that writes a register of an axis."""
    store = _storer(get, rule)

    def write(an: BoardAxis, value: float) -> None:
        store(an, value)

    text = _text("Write", what, unit, " of axis `an`", section, rule)
    body = named(write, f"wr{stem}", text, {"an": BoardAxis, "value": _AT[rule.kind]})
    return LIBRARY.through(Session.axis, LONG)(body)


def axis_pair(
    stem: str, get: Get, what: str, unit: str, read: int, write: int, rule: Rule = PLAIN
) -> tuple[OfAxis, ToAxis]:
    """Make both functions by axis number."""
    return read_axis(stem, get, what, unit, read, rule), write_axis(stem, get, what, unit, write, rule)


def read_axis_coded(
    stem: str, get: Get, what: str, unit: str, section: int, rule: Rule = PLAIN
) -> OfAxisCoded:
    """Make the function that returns a code and a register of an axis."""
    value_of, done = _getter(get, rule), int(rule.done)

    def read(an: BoardAxis) -> Any:
        return done, value_of(an)

    text = _text("Read", what, unit, f" of axis `an`; {done} means done", section, rule)
    body = named(read, f"rd{stem}", text, {"an": BoardAxis}, _coded(_out(rule)))
    return _axis_call(rule, INT)(body)  # type: ignore[no-any-return]


def axis_pair_coded(
    stem: str, get: Get, what: str, unit: str, read: int, write: int, rule: Rule = PLAIN
) -> tuple[OfAxisCoded, ToAxisCoded]:
    """Make both functions by axis number that return a code."""
    store = _storer(get, rule)

    def send(an: BoardAxis, value: float) -> int:
        store(an, value)
        return int(Status.DONE)

    text = _text("Write", what, unit, " of axis `an`; 0 means done", write, rule)
    body = named(send, f"wr{stem}", text, {"an": BoardAxis, "value": DOUBLE_AT}, CODE)
    return read_axis_coded(stem, get, what, unit, read, rule), LIBRARY.through(Session.axis, INT)(body)


# ---------------------------------------------------------------------- of the board


def read_board(stem: str, get: Get, what: str, unit: str, section: int, rule: Rule = PLAIN) -> OfBoard:
    """Make the function that returns a register of the board."""
    value_of = _getter(get, rule)

    def read(board: Board) -> Any:
        return value_of(board)

    text = _text("Read", what, unit, "", section, rule)
    body = named(read, f"rd{stem}", text, {"board": Board}, _out(rule))
    return polled_call(body) if rule.polled else board_call(body)


def board_pair(
    stem: str, get: Get, what: str, unit: str, read: int, write: int, rule: Rule = PLAIN
) -> tuple[OfBoard, ToBoard]:
    """Make both functions of the board without a code."""
    store = _storer(get, rule)

    def send(board: Board, value: float) -> None:
        store(board, value)

    text = _text("Write", what, unit, "", write, rule)
    body = named(send, f"wr{stem}", text, {"board": Board, "value": _AT[rule.kind]})
    return read_board(stem, get, what, unit, read, rule), board_call(body)


def board_pair_coded(
    stem: str, get: Get, what: str, unit: str, read: int, write: int, rule: Rule = PLAIN
) -> tuple[OfBoardCoded, ToBoardCoded]:
    """Make both functions of the board that return a code."""
    value_of, store = _getter(get, rule), _storer(get, rule)

    def fetch(board: Board) -> tuple[int, float]:
        return int(Status.DONE), value_of(board)

    def send(board: Board, value: float) -> int:
        store(board, value)
        return int(Status.DONE)

    read_text = _text("Read", what, unit, "; 0 means done", read, rule)
    write_text = _text("Write", what, unit, "; 0 means done", write, rule)
    returns = tuple[CODE, Annotated[DOUBLE, Out("value")]]
    return (
        board_call(named(fetch, f"rd{stem}", read_text, {"board": Board}, returns)),
        board_call(named(send, f"wr{stem}", write_text, {"board": Board, "value": DOUBLE_AT}, CODE)),
    )


_AT: dict[Any, Any] = {DOUBLE: DOUBLE_AT, LONG: LONG_AT}
