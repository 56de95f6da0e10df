"""What SAP programs compute and read, in the compiled scan: bit for bit what Python makes of it.

A kind of -1 stands for a result that there is none, such as a quotient by 0: Python looks into it and says why.
"""

from __future__ import annotations

import math

from polycnc.controllers.apci.core import _turn_state as ts
from polycnc.controllers.apci.core._motion import axis_velocity
from polycnc.controllers.apci.core._state import (
    MOVE,
    SPOOL_BYTES,
    SPOOL_ENTRIES,
    TABLE,
    BoardState,
)
from polycnc.controllers.apci.core._status_word import status_word
from polycnc.controllers.apci.core._turn_state import BOOLEAN, DOUBLE, INTEGER, Turns
from polycnc.kernel import KernelState, compiled

# Registers of an axis that a scan can change.
(STATUS, SIGNALS, OUTPUTS, ACTUAL, SETPOINT, ACTUAL_VELOCITY, VELOCITY, TARGET, AT_INDEX) = range(9)
(JOG_OVERRIDE, FREE, MOVES, POINT, DIFFERENCE, ERRORS) = range(9, 15)

_HALF = 1 << 31
_MASK = (1 << 32) - 1
_PARTS = 2.0**52  # of a double between two powers of 2
_SMALLEST = 2.0**-1022
_GREATEST_POWER = 709.0  # of e that is a double


@compiled
def wrapped(value: int) -> float:
    """Return the low 32 bits of `value` as a signed number."""
    return float(((value + _HALF) & _MASK) - _HALF)


@compiled
def _of_two_whole(what: int, a: int, b: int) -> tuple[float, int]:
    """Compute with two integers."""
    if what == ts.ADD_WHOLE:
        return wrapped(a + b), INTEGER
    if what == ts.SUBTRACT_WHOLE:
        return wrapped(a - b), INTEGER
    if what == ts.MULTIPLY_WHOLE:
        return wrapped(a * b), INTEGER
    if what == ts.AND:
        return float(a & b), INTEGER
    if what == ts.OR:
        return float(a | b), INTEGER
    if what == ts.XOR:
        return float(a ^ b), INTEGER
    if what == ts.SHIFT_LEFT:
        return wrapped((a & _MASK) << (b & 31)), INTEGER
    if what == ts.SHIFT_RIGHT:
        return wrapped((a & _MASK) >> (b & 31)), INTEGER
    if b == 0:
        return 0.0, -1
    if what == ts.DIV:
        whole = abs(a) // abs(b)
        return wrapped(whole if (a < 0) == (b < 0) else -whole), INTEGER
    rest = abs(a) % abs(b)
    return float(-rest if a < 0 else rest), INTEGER


@compiled
def of_two(what: int, a: float, kind_a: int, b: float, kind_b: int) -> tuple[float, int]:
    """Return what a function of two values gives, and its kind."""
    if what >= ts.LESS:
        if what == ts.LESS:
            holds = a < b
        elif what == ts.LESS_EQUAL:
            holds = a <= b
        elif what == ts.MORE:
            holds = a > b
        elif what == ts.MORE_EQUAL:
            holds = a >= b
        else:
            holds = (a == b) == (what == ts.EQUAL)
        return (1.0 if holds else 0.0), BOOLEAN
    if what <= ts.SHIFT_RIGHT:
        if kind_a != INTEGER or kind_b != INTEGER:
            return 0.0, -1
        return _of_two_whole(what, int(a), int(b))
    if what == ts.DIVIDE:
        if b == 0.0 or kind_a == BOOLEAN or kind_b == BOOLEAN:
            return 0.0, -1
        return a / b, DOUBLE
    if kind_a + kind_b == INTEGER or kind_a == BOOLEAN or kind_b == BOOLEAN:
        return 0.0, -1
    if what == ts.ADD:
        return a + b, DOUBLE
    return (a - b if what == ts.SUBTRACT else a * b), DOUBLE


@compiled
def _whole_of(what: int, a: float) -> tuple[float, int]:
    """Return a double as an integer: cut off, or the nearest one with halves away from zero."""
    if not -_HALF - 1.0 < a < _HALF + 1.0:
        return 0.0, -1
    whole = math.trunc(a)
    if what == ts.ROUND:
        rest = a - whole
        whole += (1 if rest >= 0.5 else 0) - (1 if rest <= -0.5 else 0)
    elif a < -_HALF:
        return 0.0, -1
    return (float(whole), INTEGER) if -_HALF <= whole < _HALF else (0.0, -1)


@compiled
def _of_curve(what: int, a: float) -> tuple[float, int]:
    """Return a transcendental function; where Python may raise an error it is left to it."""
    if not math.isfinite(a):
        return 0.0, -1
    if what == ts.SINE:
        return math.sin(a), DOUBLE
    if what == ts.COSINE:
        return math.cos(a), DOUBLE
    if what == ts.TANGENT:
        return math.tan(a), DOUBLE
    if what == ts.ARC_TANGENT:
        return math.atan(a), DOUBLE
    if what == ts.LOGARITHM:
        return (math.log(a), DOUBLE) if a > 0.0 else (0.0, -1)
    return (math.exp(a), DOUBLE) if a < _GREATEST_POWER else (0.0, -1)


@compiled
def of_one(what: int, a: float, kind: int) -> tuple[float, int]:
    """Return what a function of one value gives, and its kind."""
    if what == ts.NOT:
        return (1.0 if a == 0.0 else 0.0), BOOLEAN
    if kind == BOOLEAN:
        return 0.0, -1
    if what == ts.TO_DOUBLE:
        return a, DOUBLE
    if what == ts.ROOT:
        return (0.0, -1) if a < 0.0 else (math.sqrt(a), DOUBLE)
    if what >= ts.SINE:
        return _of_curve(what, a)
    if kind == DOUBLE:
        if what == ts.NEGATE:
            return -a, DOUBLE
        if what == ts.ABS:
            return abs(a), DOUBLE
        if what == ts.SQUARE:
            return a * a, DOUBLE
        if what == ts.TRUNC or what == ts.ROUND:
            return _whole_of(what, a)
        return 0.0, -1
    whole = int(a)
    if what == ts.NEGATE_WHOLE:
        return wrapped(-whole), INTEGER
    if what == ts.NOT_WHOLE:
        return float(-1 - whole), INTEGER
    if what == ts.ABS_WHOLE:
        return wrapped(abs(whole)), INTEGER
    if what == ts.SQUARE_WHOLE:
        return wrapped(whole * whole), INTEGER
    if what == ts.ODD:
        return float(whole & 1), BOOLEAN
    return 0.0, -1


@compiled
def _moves(b: BoardState, i: int) -> int:
    """Return the number of motion commands in the spooler of axis `i`."""
    moves = 0
    for count in range(b.axis[i]["head"], b.axis[i]["tail"]):
        kind = b.entry[b.ring[i, count % SPOOL_ENTRIES]]["kind"]
        moves += 1 if kind in (MOVE, TABLE) else 0
    return moves


@compiled
def register(b: BoardState, state: KernelState, what: int, i: int, factor: float, alarms: float) -> float:
    """Return a register of axis `i`; velocities are in units of `factor`."""
    row, board = b.axis[i], b.board[0]
    if what == ACTUAL:
        return float(state.servo.actual[i] - row["shift"] - (row["zero"] + row["offset"]))
    if what == SETPOINT:
        return float(state.setpoint[i] - row["shift"] - (row["zero"] + row["offset"]))
    if what == ACTUAL_VELOCITY:
        return float(row["rv"] * factor)
    if what == VELOCITY:
        return axis_velocity(b, i) * factor
    if what == DIFFERENCE:
        return float(state.servo.row[i]["following_error"])
    if what == STATUS:
        return wrapped(status_word(b, i))
    if what == SIGNALS:
        return wrapped(board["inputs"] | row["signals"] | int(alarms))
    if what == OUTPUTS:
        return 0.0 if board["io_down"] != 0 else wrapped(board["outputs"])
    if what == TARGET:
        return float(row["tp"])
    if what == AT_INDEX:
        return float(row["lpndx"] - row["offset"])
    if what == JOG_OVERRIDE:
        return float(row["jovr"])
    if what == FREE:
        return float(SPOOL_BYTES - row["used"])
    if what == MOVES:
        return float(_moves(b, i))
    return float(row["pcap_index"]) if what == POINT else wrapped(board["error_register"])


@compiled
def from_buffer(t: Turns, k: int, letter: int, offset: int) -> tuple[float, int]:
    """Return a byte (0), an integer (1) or a double (2) from the common buffer of task `k`, and its kind."""
    if letter == 0:
        return float(t.buffer[k, offset]), INTEGER
    low, high = 0, 0
    for byte in range(4):
        low |= int(t.buffer[k, offset + byte]) << 8 * byte
        if letter == 2:
            high |= int(t.buffer[k, offset + byte + 4]) << 8 * byte
    if letter == 1:
        return wrapped(low), INTEGER
    exponent = high >> 20 & 0x7FF
    if exponent == 0x7FF:  # no number
        return 0.0, -1
    part = float((high & 0xFFFFF) << 32 | low)
    value = part / _PARTS * _SMALLEST if exponent == 0 else (1.0 + part / _PARTS) * 2.0 ** (exponent - 1023)
    return (-value if high >> 31 else value), DOUBLE
