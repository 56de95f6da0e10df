"""The status word of an axis (axst), the one that the PC and programs read."""

from __future__ import annotations

from polycnc.controllers.apci.core._registers import Axst
from polycnc.controllers.apci.core._state import LEFT, RIGHT, BoardState
from polycnc.kernel import entry

_MPE, _DHEF, _CEF, _PE = int(Axst.mpe), int(Axst.dhef), int(Axst.cef), int(Axst.pe)
_CL, _IP, _LPSF = int(Axst.cl), int(Axst.ip), int(Axst.lpsf)
_REFERENCED, _SAF = int(Axst.referenced), int(Axst.saf)
_EO, _DNR, _UI, _REFH = int(Axst.eo), int(Axst.dnr), int(Axst.ui), int(Axst.refh)
_LSLH, _LSRH, _LSLS, _LSRS = int(Axst.lslh), int(Axst.lsrh), int(Axst.lsls), int(Axst.lsrs)


@entry
def status_word(b: BoardState, i: int) -> int:
    """Return the status word of axis `i`."""
    row, plan, inputs = b.axis[i], b.plan[i], b.board[0]["inputs"]
    word = _EO if inputs & plan["EO"] != 0 else 0
    word |= _DNR if inputs & plan["DR"] != plan["DR"] else 0
    word |= _LSLH if row["hard_limit"] & LEFT != 0 else 0
    word |= _LSRH if row["hard_limit"] & RIGHT != 0 else 0
    word |= _LSLS if row["soft_limit"] & LEFT != 0 else 0
    word |= _LSRS if row["soft_limit"] & RIGHT != 0 else 0
    word |= _MPE if row["position_error"] != 0 else 0
    word |= _DHEF if row["dhef"] != 0 else 0
    word |= _CEF if row["cef"] != 0 else 0
    word |= _PE if row["pe"] != 0 else 0
    word |= _CL if row["closed"] != 0 else 0
    word |= _IP if row["in_position"] != 0 else 0
    word |= _UI if inputs & plan["UI"] != 0 else 0
    word |= _LPSF if row["lpsf"] != 0 else 0
    word |= _REFERENCED if row["referenced"] != 0 else 0
    word |= _REFH if inputs & plan["REF"] != 0 else 0
    word |= _SAF if row["saf"] != 0 else 0
    return int(word)
