"""Special functions of the spoolers (ssf): write variables and outputs, raise an interrupt, wait.

Waits are looked at for all axes from one state at the start of a scan, so that those that wait for the same thing go
on together (Manual 002, 4.4.123).
"""

from __future__ import annotations

import math

from polycnc.controllers.apci.core._command_port import write_command
from polycnc.controllers.apci.core._registers import OUTPUTS, ErrorReg
from polycnc.controllers.apci.core._state import SPOOL_ENTRIES, WAITING, BoardState
from polycnc.kernel import KernelState, compiled

_WAIT_REFUSED = int(ErrorReg.SsfWaitRefused)
_OUTPUT_MASK = (1 << OUTPUTS) - 1
_INTERRUPT = 1  # bit of `attention`

SYNC_VARIABLE = 99  # CI99
WAIT_UNIT_S = 64e-6  # of a wait (ssf 1003)
_WORD = 4294967296.0
_ALL_WHOLE = 9e15  # beyond it a double has no fraction
_LONGEST_WAIT = 1 << 62  # scans

# What a spooled command says.
MET = 0
NOT_MET = 1
STOPS = 2


@compiled
def longint(value: float) -> int:
    """Return a number as the 32 bits of an integer hold it: without its fraction, modulo 2**32."""
    whole = float(int(value)) if abs(value) < _ALL_WHOLE else value
    word = int(whole % _WORD)
    return word - 0x100000000 if word >= 0x80000000 else word


@compiled
def carry_out(b: BoardState, state: KernelState, i: int, e: int) -> int:
    """Carry out the spooled command `e` of axis `i`, or begin to wait."""
    row, entry = b.axis[i], b.entry[e]
    command = int(entry["command"])
    if command in (1000, 1003, 1004, 1005, 1006, 1015, 1025):
        if row["ends_at_speed"] != 0:
            b.board[0]["error_register"] |= _WAIT_REFUSED
            return MET
        return _arrive(b, i, e)
    if command < 1000 or command >= 10000:
        _write_variable(b, command, entry["value"])
        return MET
    value = longint(entry["value"])
    board = b.board[0]
    if command == 1001:
        board["outputs"] |= value & _OUTPUT_MASK
    elif command == 1002:
        board["outputs"] &= ~value
    elif command == 1101:
        board["irq"] = 1
        board["attention"] |= _INTERRUPT
    elif 1200 <= command <= 1207 and command - 1200 < b.axis.shape[0]:
        write_command(b, state, command - 1200, value)
    return MET


@compiled
def _write_variable(b: BoardState, command: int, value: float) -> None:
    if command < 1000:
        b.ci[command] = longint(value)
    elif 10000 <= command < 11000:
        b.ci[command - 10000] |= longint(value)
    elif 11000 <= command < 12000:
        b.ci[command - 11000] &= ~longint(value)
    elif 20000 <= command < 21000:
        b.cd[command - 20000] = value


@compiled
def _arrive(b: BoardState, i: int, e: int) -> int:
    """Begin the wait `e` of axis `i`, which is at rest; tell whether there is nothing to wait for."""
    row, entry = b.axis[i], b.entry[e]
    command, value = int(entry["command"]), longint(entry["value"])
    row["met"] = 0
    if command == 1000:
        return STOPS
    if command == 1003:
        scans = math.ceil(min(entry["value"] * WAIT_UNIT_S / b.board[0]["dt"] - 1e-9, _LONGEST_WAIT))
        row["wait_scans"] = scans
        return MET if scans <= 0 else NOT_MET
    if command == 1004:
        return MET if b.board[0]["inputs"] & value == value else NOT_MET
    if command == 1005:
        b.ci[SYNC_VARIABLE] = value
    elif command == 1015:
        b.ci[SYNC_VARIABLE] = longint(float(b.ci[SYNC_VARIABLE]) + value)
    elif command == 1025:
        b.ci[SYNC_VARIABLE] |= 1 << i
    return NOT_MET


@compiled
def look_at_waits(b: BoardState) -> None:
    """Find out which waits are over, for all axes from one state, so that they go on in the same scan."""
    for i in range(b.axis.shape[0]):
        row = b.axis[i]
        if row["motion"] == WAITING:
            row["met"] = 1 if _is_over(b, i) else 0


@compiled
def _is_over(b: BoardState, i: int) -> bool:
    row = b.axis[i]
    entry = b.entry[b.ring[i, row["head"] % SPOOL_ENTRIES]]
    command, value = int(entry["command"]), longint(entry["value"])
    if command == 1003:
        row["wait_scans"] -= 1
        return bool(row["wait_scans"] <= 0 or row["skip_wait"] != 0)
    if command == 1004:
        return bool(b.board[0]["inputs"] & value == value or row["skip_wait"] != 0)
    if command == 1006:
        return _all_arrived(b, value)
    if command == 1025:
        return bool(b.ci[SYNC_VARIABLE] & (1 << i) == 0)
    return bool(b.ci[SYNC_VARIABLE] == 0)


@compiled
def _all_arrived(b: BoardState, mask: int) -> bool:
    """Tell whether every axis of a barrier stands at it."""
    for j in range(b.axis.shape[0]):
        if mask >> j & 1:
            row = b.axis[j]
            if row["motion"] != WAITING:
                return False
            entry = b.entry[b.ring[j, row["head"] % SPOOL_ENTRIES]]
            if entry["command"] != 1006 or longint(entry["value"]) != mask:
                return False
    return True
