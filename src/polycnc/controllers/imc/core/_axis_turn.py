"""One axis' turn: both coordinate systems, smoothing, the composite command, ring wrap, the limits of any motion."""

from __future__ import annotations

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._bits import ACC_LIMIT, VEL_LIMIT
from polycnc.controllers.imc.core._commands import take_commands
from polycnc.controllers.imc.core._errors import halt_axis
from polycnc.controllers.imc.core._follow import follow_step
from polycnc.controllers.imc.core._planner import advance_system, moved, show_slope, system_step
from polycnc.controllers.imc.core._state import AXIS_ERROR, GEAR, IDLE, SMOOTH_ROWS, SYNC, CardState
from polycnc.controllers.imc.core._words import (
    ONE,
    clip32,
    get16,
    get32,
    get48,
    get_u16,
    put16,
    put32,
    put48,
    wrap32,
    wrap48,
)
from polycnc.kernel import compiled


@compiled
def follows(s: CardState, i: int) -> bool:
    """Tell whether axis `i` is a slave, which has its turn after those it follows."""
    mode = s.system[0, i]["mode"]
    return bool(mode in (GEAR, SYNC))


@compiled
def _take_over_smooth(s: CardState, i: int, wanted: int) -> None:
    """Begin to smooth over another number of cycles, as if nothing had moved before."""
    axis = s.axis[i]
    axis["smooth"] = wanted
    axis["pending"] = 0
    now = s.card[0]["cycle"]
    for j in range(wanted):
        s.history[i, (now - 1 - j) & (SMOOTH_ROWS - 1)] = 0


@compiled
def smoothed(s: CardState, i: int, step: int) -> int:
    """Return the increment of the composite: the mean of the last `smooth` increments, without losing anything."""
    axis = s.axis[i]
    wanted = get_u16(s.memory, i, addr.SMOOTH)
    if wanted != axis["smooth"] and axis["lag"] == 0 and axis["recent"] == 0:
        _take_over_smooth(s, i, wanted)
    span = axis["smooth"]
    if span < 2:
        return step
    now = s.card[0]["cycle"]
    oldest = s.history[i, (now - span + 1) & (SMOOTH_ROWS - 1)]
    s.history[i, now & (SMOOTH_ROWS - 1)] = step
    axis["lag"] += step * (span - 1) - axis["recent"]
    axis["recent"] += step - oldest
    before = axis["pending"]
    axis["pending"] = axis["lag"] // span
    return int(step + before - axis["pending"])


@compiled
def _shift_pace(s: CardState, i: int, jump: int) -> None:
    """Let what the positions of axis `i` pace not notice that they have gone back by a turn."""
    for j in range(s.axis.shape[0]):
        axis = s.axis[j]
        source = axis["sync_source"] - 1
        if (
            axis["sync_share"] >= 0.0
            and axis["sync_axis"] == i
            and source in (addr.CURPOS_FRACTION, addr.POS_FRACTION, addr.ENCP_FRACTION)
        ):
            axis["sync_from"] = wrap32(axis["sync_from"] + jump)


@compiled
def _move_command(s: CardState, i: int, velocity: int) -> None:
    """Move the composite command; where it restarts at the origin, the encoder's position goes with it."""
    m = s.memory
    before = get48(m, i, addr.CURPOS_FRACTION)
    position = moved(s, before, velocity)
    put48(m, i, addr.CURPOS_FRACTION, position)
    jump = position - before - velocity
    if jump != 0:
        put48(m, i, addr.ENCP_FRACTION, wrap48(get48(m, i, addr.ENCP_FRACTION) + jump))


@compiled
def _wrap_ring(s: CardState, i: int) -> None:
    """Keep a ring axis within its ring: the coordinates go back by a turn, the motion does not notice."""
    m = s.memory
    size = get32(m, i, addr.CIRPOS) * ONE
    if size <= 0:
        return
    position = get48(m, i, addr.CURPOS_FRACTION)
    turn = 0
    if position >= size:
        turn = 1
    elif position <= -size or (position < 0 and m[i, addr.BICIRAXIS] == 0):
        turn = -1
    if turn == 0:
        return
    put48(m, i, addr.CURPOS_FRACTION, position - turn * size)
    put48(m, i, addr.POS_FRACTION, wrap48(get48(m, i, addr.POS_FRACTION) - turn * size))
    put48(m, i, addr.ENCP_FRACTION, wrap48(get48(m, i, addr.ENCP_FRACTION) - turn * size))
    put16(m, i, addr.CIRSWAP, get16(m, i, addr.CIRSWAP) + turn)
    _shift_pace(s, i, -turn * (size >> 16))


@compiled
def _check(s: CardState, i: int, before: int, velocity: int) -> None:
    """Take the axis out of run if it is faster than it may be, or changes its speed faster; no mask helps."""
    m = s.memory
    error = 0
    if abs(velocity) > get32(m, i, addr.VELLIM):
        error |= VEL_LIMIT
    if abs(velocity - before) > get32(m, i, addr.ACCELLIM):
        error |= ACC_LIMIT
    if error:
        put16(m, i, addr.ERROR, get_u16(m, i, addr.ERROR) | error)
        put16(m, i, addr.RUN, 0)
        s.card[0]["attention"] |= AXIS_ERROR
        halt_axis(s, i)


@compiled
def axis_turn(s: CardState, i: int) -> None:
    """Let axis `i` plan this cycle, and add what it moves to its command."""
    m, axis = s.memory, s.axis[i]
    before0, before1 = get32(m, i, addr.VEL), get32(m, i, addr.PCS + addr.VEL)
    first, second = s.system[0, i], s.system[1, i]
    if (
        first["mode"] == IDLE
        and second["mode"] == IDLE
        and before0 == 0
        and before1 == 0
        and axis["lag"] == 0
        and axis["recent"] == 0
        and get32(m, i, addr.CURVEL) == 0
        and m[i, addr.SLOPE] == 0
        and m[i, addr.PCS + addr.SLOPE] == 0
        and get_u16(m, i, addr.SMOOTH) == axis["smooth"]
    ):
        return
    total = 0
    for layer in range(2):
        step = follow_step(s, i) if layer == 0 and follows(s, i) else system_step(s, layer, i)
        show_slope(s, layer, i, before0 if layer == 0 else before1, step)
        advance_system(s, layer, i, step)
        total += step
    axis["given"] = 0
    velocity = smoothed(s, i, total)
    before = get32(m, i, addr.CURVEL)
    put32(m, i, addr.CURVEL, clip32(velocity))
    if velocity != 0:
        _move_command(s, i, velocity)
        if m[i, addr.ENA] != 0:
            axis["machine"] += velocity
        if m[i, addr.CIRAXIS] != 0:
            _wrap_ring(s, i)
    _check(s, i, before, velocity)


@compiled
def axes_turn(s: CardState) -> None:
    """Give every axis its turn, slaves last, so that they see what their masters do in this cycle."""
    n = s.axis.shape[0]
    for i in range(n):
        if s.axis[i]["commands"] != 0:
            take_commands(s, i)
    for turn in range(2):
        for i in range(n):
            if follows(s, i) == (turn == 1):
                axis_turn(s, i)
