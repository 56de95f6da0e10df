"""Who moves the main system of an axis, and what each command does to it: one table, read by the compiled cycle.

A gear or synchronous motion that has been set up waits beside whatever moves the axis (`waits`, `prepared` of the axis)
until startsyn starts it; no motion takes it away. An error that stops the axis, leaving run and `clear` do, and then
engear, startsyn and enasyn read 0.
"""

from __future__ import annotations

import numpy as np

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._state import GEAR, GIVEN, MOVE, SPACES, SYNC, VELOCITY, CardState
from polycnc.controllers.imc.core._words import get_u16, put16
from polycnc.kernel import compiled

# Owners, the rows of OWNERSHIP.
OWNERS = (
    "idle",
    "move",
    "velocity",
    "homing",
    "synchronous motion",
    "engaging",
    "engaged",
    "path",
    "contour",
)
AT_REST, MOVES, RUNS, HOMES, SYNCHRONOUS, ENGAGING, ENGAGED, ON_PATH, ON_CONTOUR = range(len(OWNERS))

# Commands, the columns.
COMMANDS = (
    "mcsgo := FFFFh",
    "mcsgo := 0",
    "mcstgvel := v",
    "mcstgvel := 0",
    "gohome := FFFFh",
    "gohome := 0",
    "engear := FFFFh",
    "engear := FFFFh with enasyn",
    "engear := 0",
    "startsyn := FFFFh with enasyn",
    "startsyn := 0 or enasyn := 0",
)
(GO, NO_GO, RUN_AT, RUN_AT_0, HOME, NO_HOME, ENGAGE, ARM, LEAVE, START, NO_START) = range(len(COMMANDS))

# What becomes of the owner, the cells.
EFFECTS = ("goes on", "is taken over", "ends", "goes on; the command is refused")
KEEPS, TAKES, ENDS, REFUSES = range(len(EFFECTS))

# fmt: off
OWNERSHIP = np.array([
    # go      no go  run at   run at 0  home     no home engage   arm    leave  start    no start
    (TAKES,   KEEPS, TAKES,   KEEPS,    TAKES,   KEEPS,  TAKES,   KEEPS, KEEPS, TAKES,   KEEPS),  # idle
    (TAKES,   ENDS,  TAKES,   ENDS,     TAKES,   KEEPS,  TAKES,   KEEPS, KEEPS, TAKES,   KEEPS),  # move
    (TAKES,   KEEPS, TAKES,   ENDS,     TAKES,   KEEPS,  TAKES,   KEEPS, KEEPS, TAKES,   KEEPS),  # velocity
    (TAKES,   KEEPS, TAKES,   ENDS,     TAKES,   ENDS,   TAKES,   KEEPS, KEEPS, TAKES,   KEEPS),  # homing
    (TAKES,   ENDS,  TAKES,   ENDS,     TAKES,   KEEPS,  TAKES,   KEEPS, KEEPS, TAKES,   ENDS),   # synchronous motion
    (TAKES,   ENDS,  TAKES,   ENDS,     TAKES,   KEEPS,  TAKES,   KEEPS, ENDS,  TAKES,   ENDS),   # engaging
    (TAKES,   KEEPS, TAKES,   ENDS,     TAKES,   KEEPS,  TAKES,   KEEPS, ENDS,  TAKES,   KEEPS),  # engaged
    (REFUSES, KEEPS, REFUSES, KEEPS,    REFUSES, KEEPS,  REFUSES, KEEPS, KEEPS, REFUSES, KEEPS),  # path
    (REFUSES, KEEPS, REFUSES, KEEPS,    REFUSES, KEEPS,  REFUSES, KEEPS, KEEPS, REFUSES, KEEPS),  # contour
], np.int64)
# fmt: on
OWNERSHIP.setflags(write=False)


@compiled
def owner_of(s: CardState, i: int) -> int:
    """Return what moves the main system of axis `i`; what a path has just left is still on it."""
    axis, mode = s.axis[i], s.system[0, i]["mode"]
    if axis["home"] != 0:
        return HOMES
    if mode == GIVEN:
        return ON_CONTOUR if axis["by"] == SPACES else ON_PATH
    if mode == GEAR:
        return ENGAGING if axis["sync_share"] >= 0.0 else ENGAGED
    if mode == SYNC:
        return SYNCHRONOUS
    if mode == MOVE:
        return MOVES
    return RUNS if mode == VELOCITY else AT_REST


@compiled
def effect_on(s: CardState, i: int, command: int) -> int:
    """Return what a command does to what moves axis `i`."""
    return int(OWNERSHIP[owner_of(s, i), command])


@compiled
def end_sync(s: CardState, i: int) -> None:
    """Leave synchronous motion, complete or not; enasyn stays for one that waits."""
    axis = s.axis[i]
    axis["sync_share"] = -1.0
    put16(s.memory, i, addr.STARTSYN, 0)
    if axis["waits"] == 0 and axis["prepared"] == 0:
        put16(s.memory, i, addr.ENASYN, 0)


@compiled
def take_over(s: CardState, i: int) -> None:
    """End what couples or homes axis `i`, because a new motion takes it over; what waits for startsyn stays."""
    axis = s.axis[i]
    if axis["home"] != 0:
        axis["home"] = 0
        put16(s.memory, i, addr.GOHOME, 0)
    if axis["sync_share"] >= 0.0:
        end_sync(s, i)
    if s.system[0, i]["mode"] == GEAR:
        axis["locked"] = 0
        if axis["waits"] == 0:
            put16(s.memory, i, addr.ENGEAR, 0)


@compiled
def cancel_waiting(s: CardState, i: int) -> None:
    """Forget a gear or synchronous motion that waits for startsyn."""
    axis = s.axis[i]
    axis["waits"] = 0
    axis["prepared"] = 0
    axis["armed"] = 0
    if s.system[0, i]["mode"] != GEAR:
        put16(s.memory, i, addr.ENGEAR, 0)
    if axis["sync_share"] < 0.0:
        put16(s.memory, i, addr.STARTSYN, 0)
        put16(s.memory, i, addr.ENASYN, 0)


@compiled
def drop_couplings(s: CardState, i: int) -> None:
    """Leave gear, synchronous motion and homing, and forget what waits."""
    take_over(s, i)
    cancel_waiting(s, i)
    put16(s.memory, i, addr.ENGEAR, 0)
    put16(s.memory, i, addr.GOHOME, 0)


@compiled
def is_pending(s: CardState, i: int) -> bool:
    """Tell whether startsyn reads as set while nothing has started."""
    return bool(get_u16(s.memory, i, addr.STARTSYN) != 0 and s.axis[i]["sync_share"] < 0.0)
