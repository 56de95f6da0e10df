"""Set the origin of an axis, and clear it: positions change, motion does not."""

from __future__ import annotations

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._errors import halt_axis
from polycnc.controllers.imc.core._planner import to_units
from polycnc.controllers.imc.core._state import CardState
from polycnc.controllers.imc.core._words import FLAG, ONE, get32, get48, get_u32, put16, put32, put48, wrap48
from polycnc.kernel import compiled


@compiled
def _place(s: CardState, i: int, position: int, actual: int) -> None:
    """Let the axis be at a command position and an actual one; what smoothing holds back stays to come."""
    m = s.memory
    put48(m, i, addr.CURPOS_FRACTION, wrap48(position))
    put48(m, i, addr.ENCP_FRACTION, wrap48(actual))
    put48(m, i, addr.POS_FRACTION, wrap48(position + s.axis[i]["pending"]))
    put48(m, i, addr.PCS + addr.POS_FRACTION, 0)


@compiled
def set_origin_here(s: CardState, i: int) -> None:
    """Make the present position the origin."""
    home = get32(s.memory, i, addr.HOMEPOS)
    put16(s.memory, i, addr.SETHOME, 0)
    _place(s, i, home * ONE, home * ONE)
    put32(s.memory, i, addr.TGPOS, home)
    put16(s.memory, i, addr.HOMED, FLAG)


@compiled
def set_origin_at(s: CardState, i: int, passed: float) -> None:
    """Make the place the origin that the axis has left `passed` pulses behind, while it moves."""
    m = s.memory
    scale = s.axis[i]["counts_per_pulse"] * (get_u32(m, i, addr.ENCPFACTOR) / 65536.0)
    actual = get32(m, i, addr.HOMEPOS) * ONE + to_units(passed * scale)
    shift = actual - get48(m, i, addr.ENCP_FRACTION)
    _place(s, i, get48(m, i, addr.CURPOS_FRACTION) + shift, actual)
    put32(m, i, addr.TGPOS, get48(m, i, addr.POS_FRACTION) >> 16)
    put16(m, i, addr.HOMED, FLAG)


@compiled
def clear_axis(s: CardState, i: int) -> None:
    """Clear positions and errors of an axis, and with them what the card counts."""
    m, n = s.memory, s.axis.shape[0]
    put16(m, i, addr.CLEAR, 0)
    halt_axis(s, i)
    _place(s, i, 0, 0)
    put32(m, i, addr.TGPOS, 0)
    put32(m, i, addr.PCS + addr.TGPOS, 0)
    put48(m, i, addr.ENCS_FRACTION, 0)
    put16(m, i, addr.STATUS, 0)
    put16(m, i, addr.ERROR, 0)
    put16(m, i, addr.AIOLAT, 0)
    put16(m, n, addr.EMSTOP, 0)
    put16(m, n, addr.HPAUSE, 0)
    put16(m, n, addr.EVENTS, 0)
    s.card[0]["events"] = 0
    put32(m, n, addr.TICKS, 0)
