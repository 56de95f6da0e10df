"""One scan of the board, and many: commands of the queues, profiles, limits, position control, searches, latches.

Python is entered again only when something happens that it waits for (`attention`).
"""

from __future__ import annotations

import numpy as np

from polycnc.controllers.apci.core._analysis import analysis_cycle
from polycnc.controllers.apci.core._backlash import backlash_cycle
from polycnc.controllers.apci.core._command_port import command_cycle
from polycnc.controllers.apci.core._latches import INDEX, latches_cycle
from polycnc.controllers.apci.core._limits import limits_cycle
from polycnc.controllers.apci.core._motion import (
    INSIDE,
    PASSED,
    axis_velocity,
    brake,
    has_ended,
    override_cycle,
    position_at,
    rest,
    sample,
)
from polycnc.controllers.apci.core._registers import ErrorReg, ModeReg
from polycnc.controllers.apci.core._special_functions import look_at_waits
from polycnc.controllers.apci.core._spool import (
    end_entry,
    leave_path,
    stop_out_of_step,
    take_next,
    watch_step,
)
from polycnc.controllers.apci.core._state import (
    BY_COMMAND,
    IDLE,
    JOG,
    MOVE,
    NO_SEARCH,
    POINTS,
    SEARCH_ENDS,
    SEARCH_INDEX,
    SEARCH_REFERENCE,
    TABLE,
    WAITING,
    BoardState,
    Whole,
)
from polycnc.kernel import (
    LIMIT_HIGH,
    LIMIT_LOW,
    REFERENCE,
    KernelState,
    call_at,
    compiled,
    entry,
    follow_cycle,
    sources_cycle,
)

_TARGET_VELOCITY = int(ErrorReg.errTargetVel)
_FORBID_TARGET_VELOCITY = int(ModeReg.ForbidTargetVel)

# What stops `run_scans`, bits of `attention` and of its mask.
INTERRUPT = 1  # the board interrupts the PC
PROFILE_END = 2  # an axis came to its profile end
RESET = 4  # the board demands a reset of itself

_ALWAYS = 1 << 60
NO_TURNS: Whole = np.zeros(4, np.int64)


@compiled
def _read_inputs(b: BoardState, state: KernelState) -> None:
    """Bring the input register up to date: what is wired to terminals, and the simulated switches."""
    board = b.board[0]
    inputs = board["external"]
    for i in range(b.axis.shape[0]):
        plan = b.plan[i]
        if state.switches.switch[i, LIMIT_LOW]["level"] != 0:
            inputs |= plan["left_switch"]
        if state.switches.switch[i, LIMIT_HIGH]["level"] != 0:
            inputs |= plan["right_switch"]
        if state.switches.switch[i, REFERENCE]["level"] != 0:
            inputs |= plan["reference_switch"]
    if board["io_down"] != 0:  # no level reaches the board
        inputs = 0
    board["inputs"] = inputs ^ board["inverted"]


@compiled
def _table_cycle(b: BoardState, state: KernelState, i: int) -> bool:
    """Give axis `i` the next point of its table; False when there is none."""
    row = b.axis[i]
    table = b.entry[row["entry"]]
    if row["point"] >= table["points"]:
        return False
    value = b.points[i, (table["first"] + row["point"]) % POINTS]
    if table["relative"] != 0:  # each point from the one before
        row["anchor"] += value
        value = row["anchor"]
    if table["index"] >= 0:
        row["pcap_index"] = table["index"] + row["point"]
    row["speed"] = (value - state.base[i]) / b.board[0]["dt"]
    state.base[i] = value
    row["point"] += 1
    return True


@compiled
def _end_of_queue(b: BoardState, state: KernelState, i: int, lead: float) -> None:
    """Let axis `i` go on with the velocity its last entry ended with, or demand a reset where that is forbidden."""
    row, board = b.axis[i], b.board[0]
    position, velocity = position_at(b, i, row["place"]), axis_velocity(b, i)
    if row["direct"] == 0:
        forbidden = row["running"] != 0 and board["mode_register"] & _FORBID_TARGET_VELOCITY != 0
        if forbidden:
            board["error_register"] |= _TARGET_VELOCITY
            board["attention"] |= RESET
        row["running"] = 0
    end_entry(b, i)
    leave_path(b, state, i, position, velocity, lead)


@compiled
def _path_goes_on(b: BoardState, state: KernelState, i: int) -> bool:
    """Take axis `i` over the end of an entry that it passes with a velocity; False if that was the last."""
    row = b.axis[i]
    lead = row["lead"] + row["cycles"] * b.board[0]["dt"] - row["duration"]
    if row["direct"] != 0 or row["running"] == 0 or row["tail"] - row["head"] < 2:
        _end_of_queue(b, state, i, lead)
        return False
    position, speed = position_at(b, i, row["place"]), abs(row["speed"])
    velocity = axis_velocity(b, i)
    end_entry(b, i)
    state.base[i] = position
    if take_next(b, state, i, speed, lead):
        return True
    row["entry"] = -1
    if row["motion"] != WAITING:
        leave_path(b, state, i, position, velocity, lead)
    return False


@compiled
def _profile_cycle(b: BoardState, state: KernelState, i: int) -> None:
    """Take axis `i` one scan on along its profile, and over the ends of as many entries as that takes."""
    row = b.axis[i]
    row["cycles"] += 1
    while True:
        result = sample(b, state, i)
        if result == INSIDE:
            return
        if row["motion"] == MOVE:
            if result == PASSED:
                if not _path_goes_on(b, state, i):
                    return
                if row["motion"] == TABLE:
                    _table_cycle(b, state, i)
                    return
                continue
            end_entry(b, i)
        elif result == PASSED:  # a jog goes on with its target velocity
            row["endless"] = 1
            row["past"] = 1
            continue
        rest(b, i)  # a queue that holds more goes on with the next scan
        if row["head"] >= row["tail"]:
            row["running"] = 0
            row["short_entries"] = 0
        return


@compiled
def _axis_cycle(b: BoardState, state: KernelState, i: int) -> None:
    """Let whatever moves axis `i` give its part of the setpoint."""
    row = b.axis[i]
    override_cycle(b, i)
    if row["motion"] == WAITING or (row["motion"] == IDLE and row["running"] != 0):
        if row["motion"] == WAITING and row["met"] == 0:
            return
        if not take_next(b, state, i, 0.0, 0.0):
            return
    if row["motion"] == TABLE:
        if _table_cycle(b, state, i):
            return
        end_entry(b, i)
        if not take_next(b, state, i, 0.0, 0.0):
            if row["motion"] == IDLE:
                rest(b, i)
            return
        if row["motion"] == TABLE:
            _table_cycle(b, state, i)
            return
    if row["motion"] == JOG or row["motion"] == MOVE:
        _profile_cycle(b, state, i)


@compiled
def _search_cycle(b: BoardState, state: KernelState, i: int) -> None:
    """End the search run of axis `i` when it has found what it searches."""
    row = b.axis[i]
    if row["search"] == NO_SEARCH or row["search"] == SEARCH_ENDS:
        return
    found = row["search"] == SEARCH_REFERENCE and b.board[0]["inputs"] & b.plan[i]["REF"] != 0
    found = found or (row["search"] == SEARCH_INDEX and row["signals"] & INDEX != 0)
    if found:
        row["search"] = SEARCH_ENDS
        brake(b, i, state.base[i], row["speed"], row["hac"], BY_COMMAND)


@compiled
def _profile_ends(b: BoardState, i: int) -> None:
    row = b.axis[i]
    ended = 1 if has_ended(row) else 0
    if ended > row["pe"]:
        b.board[0]["attention"] |= PROFILE_END
    row["pe"] = ended


@compiled
def scan(b: BoardState, state: KernelState) -> None:
    """Run one scan of the board."""
    board = b.board[0]
    n = b.axis.shape[0]
    board["scan"] += 1
    _read_inputs(b, state)
    look_at_waits(b)
    stop_out_of_step(b, state)
    for i in range(n):
        _axis_cycle(b, state, i)
    watch_step(b)
    sources_cycle(state)
    for i in range(n):
        backlash_cycle(b, state, i)
        limits_cycle(b, state, i)
        _profile_ends(b, i)
    follow_cycle(state)
    for i in range(n):
        command_cycle(b, state, i)
        latches_cycle(b, state, i)
        _search_cycle(b, state, i)
    analysis_cycle(b, state)


def _steps(b: BoardState, state: KernelState, turns: Whole, scans: int, mask: int, cycle: int) -> int:
    """Return how much work scans are; turns are compiled, and only compiled code can call them."""
    return scans * 5 * len(state.setpoint) if turns[0] == 0 else _ALWAYS


@entry(steps=lambda turns, begin, cycle: _ALWAYS)
def first_turns(turns: Whole, begin: int, cycle: int) -> int:
    """Give the tasks from `begin` on their turns in scan `cycle`; return 0 if they have had them all."""
    return call_at(turns[0], (turns[1], turns[2], turns[3]), (begin, cycle))


@entry(steps=_steps)
def run_scans(b: BoardState, state: KernelState, turns: Whole, scans: int, mask: int, cycle: int) -> int:
    """Run up to `scans` scans, fewer when something of `mask` happens; return how many were run.

    Between two scans the tasks have their turns; if one needs Python for it, no more scans are run. `turns` is the call
    that gives them (`_turns`), made ready, and zeros without tasks. `cycle` is the number of the first scan, in which
    they have had theirs.
    """
    board = b.board[0]
    for done in range(1, scans + 1):
        board["attention"] = 0
        scan(b, state)
        if board["attention"] & mask:
            return done
        # Here, and looked up every time: in front of the scan this made LLVM compile all of it twice.
        if turns[0] != 0 and done < scans:
            places = (turns[1], turns[2], turns[3])
            if call_at(turns[0], places, (0, cycle + done)) != 0:
                return done
    return scans
