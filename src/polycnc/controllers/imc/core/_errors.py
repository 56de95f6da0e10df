"""What stops an axis: limits, windows, emergency stop; braking it, taking it out of run."""

from __future__ import annotations

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._bits import (
    NLIM,
    NLIM_ON,
    NSOF,
    NSOFT_ON,
    PLIM,
    PLIM_HIGH,
    PLIM_ON,
    POSERR_LIMIT,
    PSOF,
    PSOFT_ON,
    STOP,
)
from polycnc.controllers.imc.core._ownership import drop_couplings
from polycnc.controllers.imc.core._path import stop_space
from polycnc.controllers.imc.core._planner import rest_system, start_velocity
from polycnc.controllers.imc.core._state import AXIS_ERROR, GIVEN, IDLE, RELEASED, SPACES, VELOCITY, CardState
from polycnc.controllers.imc.core._words import get16, get32, get48, get_u16, put16, put48, wrap48
from polycnc.kernel import compiled

_POSITIVE = PLIM | PSOF
_NEGATIVE = NLIM | NSOF
_LIMITS = _POSITIVE | _NEGATIVE


@compiled
def is_blocked(s: CardState, i: int, direction: int) -> bool:
    """Tell whether the errors of axis `i` allow no motion in a direction (0: any)."""
    met = get_u16(s.memory, i, addr.ERROR) & get_u16(s.memory, i, addr.STOPFILT)
    if met & ~_LIMITS:
        return True
    return bool((met & _POSITIVE and direction >= 0) or (met & _NEGATIVE and direction <= 0))


@compiled
def halt_axis(s: CardState, i: int) -> None:
    """Let axis `i` plan nothing any more, at once: what smoothing holds back is dropped as well."""
    axis = s.axis[i]
    if s.system[0, i]["mode"] == GIVEN and axis["by"] != RELEASED:
        by = axis["by"]
        put16(
            s.memory, s.axis.shape[0], addr.STARTPATH + by * addr.SPACE if by < SPACES else addr.STARTGROUP, 0
        )
    rest_system(s, 0, i)
    rest_system(s, 1, i)
    drop_couplings(s, i)
    axis["given"] = 0
    if axis["pending"] != 0 or axis["recent"] != 0 or axis["lag"] != 0:
        position = get48(s.memory, i, addr.POS_FRACTION) - axis["pending"]
        put48(s.memory, i, addr.POS_FRACTION, wrap48(position))
        axis["pending"] = 0
        axis["recent"] = 0
        axis["lag"] = 0
        axis["smooth"] = 0


@compiled
def _brake(s: CardState, i: int, at_once: bool) -> None:
    """Stop axis `i`, with its deceleration unless `at_once`."""
    axis = s.axis[i]
    drop_couplings(s, i)
    for layer in range(2):
        row = s.system[layer, i]
        if row["mode"] == GIVEN:
            if axis["by"] < SPACES:
                stop_space(s, axis["by"], at_once)
            else:
                if axis["by"] != RELEASED:
                    put16(s.memory, s.axis.shape[0], addr.STARTGROUP, 0)
                rest_system(s, layer, i)
        elif at_once:
            rest_system(s, layer, i)
        elif row["mode"] != IDLE and not (row["mode"] == VELOCITY and row["target"] == 0):
            start_velocity(s, layer, i, 0)


@compiled
def _emergency_stop(s: CardState) -> None:
    """Take every axis and both path spaces out of work."""
    n = s.axis.shape[0]
    for g in range(SPACES):
        put16(s.memory, n, addr.STARTPATH + g * addr.SPACE, 0)
    put16(s.memory, n, addr.STARTGROUP, 0)
    for i in range(n):
        put16(s.memory, i, addr.RUN, 0)
        put16(s.memory, i, addr.ENA, 0)
        halt_axis(s, i)


@compiled
def _new_errors(s: CardState, i: int, levels: int) -> int:
    """Return the error bits that this cycle brings."""
    m = s.memory
    found = 0
    poserr = get16(m, i, addr.POSERR)
    if abs(poserr) > get_u16(m, i, addr.POSERRLIM):
        found |= POSERR_LIMIT
    control = get_u16(m, i, addr.AIOCTR)
    if control == 0:
        return found
    velocity = get32(m, i, addr.CURVEL)
    position = get48(m, i, addr.CURPOS_FRACTION) >> 16
    if velocity > 0:
        if control & PLIM_ON and (levels & 1) == (control & PLIM_HIGH):
            found |= PLIM
        if control & PSOFT_ON and position >= get32(m, i, addr.PSOFTLIM):
            found |= PSOF
    elif velocity < 0:
        if control & NLIM_ON and (levels >> 1 & 1) == (control >> 2 & 1):
            found |= NLIM
        if control & NSOFT_ON and position <= get32(m, i, addr.NSOFTLIM):
            found |= NSOF
    return found


@compiled
def errors_cycle(s: CardState) -> None:
    """Carry out an emergency stop that has been asked for."""
    bits = get_u16(s.memory, s.axis.shape[0], addr.EMSTOP)
    if bits & STOP and s.card[0]["stopped"] == 0:
        s.card[0]["stopped"] = 1
        _emergency_stop(s)
    elif not bits & STOP:
        s.card[0]["stopped"] = 0


@compiled
def axis_errors(s: CardState, i: int, levels: int) -> None:
    """Bring the error of axis `i` up to date, and stop it or take it out of run where the masks say so."""
    m, axis = s.memory, s.axis[i]
    error = get_u16(m, i, addr.ERROR) | _new_errors(s, i, levels) | get_u16(m, s.axis.shape[0], addr.EMSTOP)
    if error == 0 and axis["last_error"] == 0:
        return
    if error & ~axis["last_error"]:
        s.card[0]["attention"] |= AXIS_ERROR
    axis["last_error"] = error
    put16(m, i, addr.ERROR, error)
    if error & get_u16(m, i, addr.EXITFILT):
        put16(m, i, addr.RUN, 0)
        halt_axis(s, i)
        return
    velocity = get32(m, i, addr.VEL) + get32(m, i, addr.PCS + addr.VEL)
    moving = velocity != 0 or s.system[0, i]["mode"] != IDLE or s.system[1, i]["mode"] != IDLE
    if moving and error & get_u16(m, i, addr.STOPFILT):
        way = 1 if velocity > 0 else (-1 if velocity < 0 else 0)
        if is_blocked(s, i, way):
            _brake(s, i, error & get_u16(m, i, addr.STOPMODE) != 0)
