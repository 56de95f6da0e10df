"""The read and write functions of parameters, positions and system variables: the table (Manual 002, 4.4.43 ff.)."""

# ruff: noqa: N802, N816  the names are the manual's

from __future__ import annotations

from collections.abc import Callable
from operator import attrgetter
from typing import Any

import numpy as np

from polycnc.controllers.apci.board._axis_commands import write_dp, write_mcp, write_rp
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import Success
from polycnc.controllers.apci.board._records import CTRLPARAMS, TRU, TSRP
from polycnc.controllers.apci.board._spool_commands import free_bytes, moves_queued
from polycnc.controllers.apci.board._units import PositionUnit, TimeUnit
from polycnc.controllers.apci.core._registers import ErrorReg
from polycnc.controllers.apci.library._library import (
    is_number,
    library,
    longint,
    revision,
    status_mask,
    usable_axis,
    usable_board,
)
from polycnc.controllers.apci.library._table import (
    ACCELERATION,
    PATH_ACCELERATION,
    PATH_VELOCITY,
    POSITION,
    VELOCITY,
    AxisRegister,
    BoardRegister,
)

_RECORD_ELEMENTS = {element.name for element in TSRP.ELEMENTS} - {"an", "scratch"}
_FILTER = ("kp", "ki", "kd", "kpl", "kfca", "kfcv")


def _at(name: str) -> Callable[[Any, Any], object]:
    def put(owner: Any, value: Any) -> None:
        setattr(owner, name, value)

    return put


def _variable(name: str) -> Callable[[Board, Any], object]:
    def put(board: Board, value: Any) -> None:
        setattr(board.variables, name, value)

    return put


def _positive(value: float) -> bool:
    return value > 0.0


def _not_negative(value: float) -> bool:
    return value >= 0.0


def _parameter(
    stem: str,
    name: str,
    what: str,
    unit: str,
    *sections: int,
    fits: Callable[[float], bool] = is_number,
    note: str = "",
) -> AxisRegister[float]:
    return AxisRegister(stem, what, 0.0, attrgetter(name), _at(name), unit, sections, fits=fits, note=note)


def _limit(stem: str, name: str, what: str, unit: str, *sections: int) -> AxisRegister[float]:
    return _parameter(stem, name, what, unit, *sections, fits=_not_negative, note="0: not checked.")


def _flags(stem: str, what: str, *sections: int) -> AxisRegister[int]:
    return AxisRegister(stem, what, 0, attrgetter(stem), _at(stem), "", sections)


def _system(
    stem: str, what: str, unit: str, *sections: int, fits: Callable[[float], bool] = is_number
) -> BoardRegister[float]:
    return BoardRegister(
        stem, what, 0.0, attrgetter(f"variables.{stem}"), _variable(stem), unit, sections, fits=fits
    )


# ---------------------------------------------------------------------- parameters of an axis, through TSRP

rdjac, wrjac = _parameter("jac", "jac", "the jog acceleration", ACCELERATION, 75, 150).in_record("jac")
rdjvl, wrjvl = _parameter("jvl", "jvl", "the jog velocity", VELOCITY, 78, 154).in_record("jvl")
rdjtvl, wrjtvl = _parameter("jtvl", "jtvl", "the jog target velocity", VELOCITY, 77, 153).in_record("jtv")
rdjovr, wrjovr = AxisRegister(
    "jovr",
    "the jog override",
    0.0,
    attrgetter("jovr"),
    _at("jovr"),
    sections=(152, 152),
    polled=True,
    fits=_positive,
    note="During a change of the trajectory override it is the override in force. rdjovr is only named in the manual.",
).in_record("jovr")
rdhac, wrhac = _parameter(
    "hac", "hac", "the acceleration of reference travel", ACCELERATION, 68, 147
).in_record("hac")
rdhvl, wrhvl = _parameter("hvl", "hvl", "the velocity of reference travel", VELOCITY, 69, 148).in_record(
    "hvl"
)
rdsdec, wrsdec = _parameter(
    "sdec", "sdec", "the stop deceleration", ACCELERATION, 99, 168, fits=_not_negative
).in_record("sdec")
rdsll, wrsll = _parameter("sll", "sll", "the left software limit", POSITION, 100, 169).in_record("sll")
rdslr, wrslr = _parameter("slr", "slr", "the right software limit", POSITION, 101, 170).in_record("slr")
rdipw, wripw = _parameter("ipw", "ipw", "the in-position window", POSITION, 73, 149).in_record("ipw")
rdmpe, wrmpe = _parameter("mpe", "mpe", "the limit of the position error", POSITION, 91, 165).in_record("mpe")
rdgf, wrgf = _parameter("gf", "gf", "the gear factor", "", 66, 145, fits=_positive).in_record("gf")
rdaux, wraux = _parameter("aux", "aux", "the auxiliary register", "", 44, 133).in_record("aux")
rdtp, wrtp = AxisRegister(
    "tp",
    "the absolute target of the last travel command",
    0.0,
    attrgetter("tp"),
    _at("tp"),
    POSITION,
    sections=(103, 172),
    polled=True,
).in_record("tp")

# ---------------------------------------------------------------------- positions and velocities

rdrp, wrrp = AxisRegister(
    "rp",
    "the actual position",
    0.0,
    attrgetter("rp"),
    lambda axis, value: write_rp(axis.board, axis.index, value),
    POSITION,
    sections=(95, 167),
    polled=True,
    note="Written with open loop only; that shifts the machine zero, and the axis is not referenced any more.",
).in_record("rp")
rddp, wrdp = AxisRegister(
    "dp",
    "the setpoint",
    0.0,
    attrgetter("dp"),
    lambda axis, value: write_dp(axis.board, axis.index, value),
    POSITION,
    sections=(56, 140),
    polled=True,
    note="Written with closed loop only; the axis goes there as fast as it can.",
).in_record("dp")
rdrpd = AxisRegister(
    "rpd", "the actual position", 0.0, lambda a: a.displayed(a.rp), None, "display unit", (96,), True
).read_record("rp")
rddpd = AxisRegister(
    "dpd", "the setpoint", 0.0, lambda a: a.displayed(a.dp), None, "display unit", (58,), True
).read_record("dp")
rdtpd = AxisRegister(
    "tpd",
    "the absolute target of the last travel command",
    0.0,
    lambda a: a.displayed(a.tp),
    None,
    "display unit",
    (104,),
    True,
).read_record("tp")
rddv = AxisRegister(
    "dv", "the velocity of the profile", 0.0, attrgetter("dv"), None, VELOCITY, (59,), True
).read_record("dv")
rdrv = AxisRegister("rv", "the actual velocity", 0.0, attrgetter("rv"), None, VELOCITY, (97,), True).read()
rdPosErr = AxisRegister(
    "PosErr", "the position error", 0.0, attrgetter("position_error"), None, POSITION, (93,), True
).read()
rdlp, wrlp = AxisRegister(
    "lp",
    "the latched position",
    0.0,
    attrgetter("lp"),
    _at("lp"),
    POSITION,
    sections=(82, 158),
    polled=True,
    note="Reading it clears the status bit lpsf.",
).in_record("lp")
rdlpndx, wrlpndx = AxisRegister(
    "lpndx",
    "the position latched at the encoder's index",
    0.0,
    attrgetter("lpndx"),
    _at("lpndx"),
    POSITION,
    sections=(83, 159),
    polled=True,
).in_record("lp")
rdmcp, wrmcp = AxisRegister(
    "mcp",
    "the motor command port",
    0,
    attrgetter("mcp"),
    lambda axis, value: write_mcp(axis.board, axis.index, value),
    sections=(88, 162),
    polled=True,
    note=(
        "Servo: -32767 to 32767 is -10 to 10 V. Stepper: the frequency is CLOCK / 2 / (|mcp| + 1) in the direction of "
        "the sign, 0 stops. It lasts only while the loop is open."
    ),
).in_record("mcp")

# ---------------------------------------------------------------------- status words and counters, read only

rdaxst = AxisRegister(
    "axst",
    "the axis status",
    0,
    lambda axis: axis.status_word & status_mask(revision()),
    None,
    "",
    (45,),
    True,
).read_record("axst")
rdlsm = AxisRegister(
    "lsm",
    "the free spooler memory",
    0,
    lambda axis: free_bytes(axis.board, axis.index),
    unit="byte",
    sections=(84,),
    polled=True,
).read_record("lsm")
rdMCiS = AxisRegister(
    "MCiS",
    "the number of motion commands in the spooler",
    0,
    lambda axis: moves_queued(axis.board, axis.index),
    sections=(87,),
    polled=True,
).read()
rdPcapIndex = AxisRegister(
    "PcapIndex",
    "the index of the spooled command that is being executed",
    0,
    lambda axis: int(axis.row["pcap_index"]),
    sections=(94,),
    polled=True,
    note="-1 until a command with an index has been executed.",
).read_coded()

# ---------------------------------------------------------------------- parameters of an axis, by its number

rdEffRadius, wrEffRadius = _parameter(
    "EffRadius", "effradius", "the effective radius", "PU", 61, 143, fits=_not_negative
).both()
rdJerkRel, wrJerkRel = _parameter(
    "JerkRel", "jerkrel", "the relative jerk", "", 76, 151, note="0 to 1; other values are limited to it."
).both()
rdMaxAcc, wrMaxAcc = _limit("MaxAcc", "MaxAcc", "the maximum acceleration", PATH_ACCELERATION, 85, 160).both()
rdMaxVel, wrMaxVel = _limit("MaxVel", "MaxVel", "the maximum velocity", PATH_VELOCITY, 86, 161).both()
rdMDVel, wrMDVel = _limit("MDVel", "MDVEL", "the maximum velocity jump", PATH_VELOCITY, 89, 163).both()
rdGCR, wrGCR = _flags("GCR", "the gear configuration register", 65, 144).both()
rdControllerFlags, wrControllerFlags = _flags(
    "ControllerFlags", "the flags of the control algorithm", 51, 137
).both()
_slsp = _parameter("slsp", "slsp", "the slits or steps of a motor turn", "", 102, 171, fits=_positive)
rdslsp = _slsp.read_coded(Success.DONE, Success.FAILED)
_, wrslsp = _slsp.both()
rddpoffset, wrdpoffset = _parameter(
    "dpoffset", "dpoffset", "the offset added to the setpoint", POSITION, 57, 141
).coded()
rddvoffset, wrdvoffset = _parameter(
    "dvoffset", "dvoffset", "the velocity at which dpoffset changes", VELOCITY, 60, 142, note="0: at once."
).coded()
rdgfaux, wrgfaux = _parameter(
    "gfaux", "gfaux", "the ratio of motor steps to encoder counts", "", 67, 146
).coded()
rdZeroOffset = AxisRegister(
    "ZeroOffset", "the zero offset in force", 0.0, lambda a: float(a.row["offset"]), None, POSITION, (110,)
).read_coded()

# ---------------------------------------------------------------------- the board

rdModeReg, wrModeReg = BoardRegister(
    "ModeReg", "the mode register", 0, lambda board: longint(board.modereg), _at("modereg"), "", (90, 164)
).both()
rdnfrax, wrnfrax = BoardRegister(
    "nfrax",
    "the axes that do not count for the path, bit by bit",
    0,
    lambda board: longint(board.nfrax),
    _at("nfrax"),
    sections=(92, 166),
).both()
rdErrorReg = BoardRegister(
    "ErrorReg", "the error register", 0, lambda board: int(board.errorreg), None, "", (63,), True
).read()
rdtrovr, wrtrovr = BoardRegister(
    "trovr",
    "the trajectory override as it is programmed",
    0.0,
    attrgetter("trovr"),
    _at("trovr"),
    sections=(106, 174),
    fits=_positive,
    note="utrovr puts it in force.",
).both()
rdtrovrst, wrtrovrst = BoardRegister(
    "trovrst",
    "the time in which the trajectory override changes by 1",
    0.0,
    attrgetter("trovrst"),
    _at("trovrst"),
    "s",
    (107, 175),
    fits=_not_negative,
    note="0: at once.",
).coded()
rdtrac, wrtrac = _system(
    "trac",
    "TRAC, the trajectory acceleration of SAP programs",
    PATH_ACCELERATION,
    105,
    173,
    fits=_not_negative,
).coded()
rdtrvl, wrtrvl = _system(
    "trvl", "TRVL, the trajectory velocity of SAP programs", PATH_VELOCITY, 108, 176, fits=_not_negative
).coded()
rdtrtvl, wrtrtvl = _system(
    "trtvl", "TRTVL, the trajectory target velocity of SAP programs", PATH_VELOCITY, 109, 177
).coded()


def rdSampleTime() -> tuple[int, int]:
    """Return 1 and the time of a scan in whole microseconds, (0, 0) without a board (Manual 002, 4.4.98)."""
    board = usable_board()
    return (int(Success.FAILED), 0) if board is None else (int(Success.DONE), board.config.sample_time_us)


def rdepc(tsrp: TSRP) -> None:
    """Read the number of EEPROM programming cycles into `tsrp.epc` (Manual 002, 4.4.62)."""
    installed = library().installed()
    if installed is not None and usable_axis(tsrp.an) is not None:
        tsrp.epc = installed.eprom_cycles


# ---------------------------------------------------------------------- several at once


def rdap(tsrp: TSRP) -> None:
    """Read all elements of `tsrp` that table 3 of the manual lists (Manual 002, 4.4.43)."""
    installed = library().installed()
    axis = usable_axis(tsrp.an, polled=True)
    if installed is None or axis is None:
        return
    for name, value in installed.axis_parameters(axis.index).items():
        if name in _RECORD_ELEMENTS:
            setattr(tsrp, name, value)
    tsrp.axst &= status_mask(revision())


def rdf(tsrp: TSRP) -> None:
    """Read the six coefficients of the position loop into `tsrp` (Manual 002, 4.4.64)."""
    axis = usable_axis(tsrp.an)
    if axis is not None:
        for name in _FILTER:
            setattr(tsrp, name, getattr(axis, name))


def uf(tsrp: TSRP) -> None:
    """Send the six coefficients of the position loop, at any time (Manual 002, 4.4.131)."""
    axis = usable_axis(tsrp.an)
    if axis is not None and all(is_number(getattr(tsrp, name)) for name in _FILTER):
        for name in _FILTER:
            setattr(axis, name, getattr(tsrp, name))
        axis.board.update_filter(axis.index)


def scp(an: int, ctrlparams: CTRLPARAMS) -> None:
    """Send the field of 15 by 15 parameters for extensions of an axis (Manual 002, 4.4.114)."""
    axis = usable_axis(an)
    if axis is None:
        return
    field = np.array(ctrlparams.parameters, np.float64)
    if field.shape == axis.ctrlparams.shape and bool(np.isfinite(field).all()):
        axis.ctrlparams[:] = field


def ctru(tru: TRU) -> None:
    """Select the units of position and time of all interpolation (Manual 002, 4.4.11).

    An index that is no unit leaves the units and sets ErrorReg.errUnit.
    """
    board = usable_board()
    if board is None:
        return
    if tru.pu in set(PositionUnit) and tru.tu in set(TimeUnit):
        board.variables.pu, board.variables.tu = int(tru.pu), int(tru.tu)
    else:
        board.raise_error(ErrorReg.errUnit)
