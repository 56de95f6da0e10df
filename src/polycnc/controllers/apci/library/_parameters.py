"""The read and write functions of parameters, positions and system variables: the table (Manual 002, 4.4.43 ff.)."""

# ruff: noqa: E501, N802, N816  the names are the manual's

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np

from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import Success
from polycnc.controllers.apci.board._commanded import BoardAxis
from polycnc.controllers.apci.board._numbers import is_number
from polycnc.controllers.apci.board._records import CTRLPARAMS, STRUCTURES, TRU
from polycnc.controllers.apci.board._units import PositionUnit, TimeUnit
from polycnc.controllers.apci.core._registers import ErrorReg
from polycnc.controllers.apci.library._call import (
    CODE,
    INT,
    INT_AT,
    LIBRARY,
    LONG,
    board_call,
    filled_call,
    record_call,
)
from polycnc.controllers.apci.library._session import UNKNOWN_ERROR, Exchange, Session
from polycnc.controllers.apci.library._table import (
    ACCELERATION,
    DISPLAY,
    PATH_ACCELERATION,
    PATH_VELOCITY,
    POSITION,
    VELOCITY,
    Rule,
    axis_pair,
    axis_pair_coded,
    board_pair,
    board_pair_coded,
    filled_at_once_call,
    not_negative,
    positive,
    read_axis,
    read_axis_coded,
    read_board,
    read_record,
    record_pair,
    write_axis,
)
from polycnc.controllers.library import Out, Refused

_RECORD_ELEMENTS = {each.name for each in STRUCTURES["TSRP"].fields} - {"an", "scratch"}
_FILTER = ("kp", "ki", "kd", "kpl", "kfca", "kfcv")


def _displayed(name: str) -> Callable[[BoardAxis], float]:
    return lambda axis: axis.displayed(getattr(axis, name))


_PORT = (
    "Servo: -32767 to 32767 is -10 to 10 V. Stepper: the frequency is CLOCK / 2 / (|mcp| + 1) in the direction of "
    "the sign, 0 stops. It lasts only while the loop is open."
)
_OVERRIDE = "During a change of the trajectory override it is the override in force. rdjovr is only named in the manual."
_OPEN_ONLY = (
    "Written with open loop only; that shifts the machine zero, and the axis is not referenced any more."
)
_CLOSED_ONLY = "Written with closed loop only; the axis goes there as fast as it can."

# What is particular about a register: see `Rule`.
LIVE, LIVE_LONG, FLAGS = Rule(polled=True), Rule(polled=True, kind=LONG), Rule(kind=LONG)
LIVE_AT = Rule(polled=True, number=INT_AT)
ABOVE_0, LEAST_0 = Rule(fits=positive), Rule(fits=not_negative)
LIMIT, TIME = Rule(fits=not_negative, note="0: not checked."), Rule(fits=not_negative, note="0: at once.")
AT_ONCE, JERK = Rule(note="0: at once."), Rule(note="0 to 1; other values are limited to it.")
TROVR = Rule(fits=positive, note="utrovr puts it in force.")
JTV, JOVR = Rule(field="jtv"), Rule(fits=positive, polled=True, note=_OVERRIDE)
RP, DP = Rule(polled=True, note=_OPEN_ONLY), Rule(polled=True, note=_CLOSED_ONLY)
LP, INDEX = Rule(polled=True, note="Reading it clears the status bit lpsf."), Rule(polled=True, field="lp")
MCP = Rule(polled=True, note=_PORT)
SHOWN_RP, SHOWN_DP, SHOWN_TP = (Rule(polled=True, field=name) for name in ("rp", "dp", "tp"))
SLSP = Rule(number=LONG, done=Success.DONE, refused=Success.FAILED)
PCAP = Rule(
    polled=True, kind=INT, out="PcapIndex", note="-1 until a command with an index has been executed."
)
ERROR = Rule(kind=LONG, polled=True, out="ErrorReg")

# fmt: off
# ---------------------------------------------------------------------- parameters of an axis, through TSRP
#                             stem    register  what                                   unit          read write
rdjac,  wrjac  = record_pair("jac",  "jac",  "the jog acceleration",                  ACCELERATION,  75, 150)
rdjvl,  wrjvl  = record_pair("jvl",  "jvl",  "the jog velocity",                      VELOCITY,      78, 154)
rdjtvl, wrjtvl = record_pair("jtvl", "jtvl", "the jog target velocity",               VELOCITY,      77, 153, JTV)
rdhac,  wrhac  = record_pair("hac",  "hac",  "the acceleration of reference travel",  ACCELERATION,  68, 147)
rdhvl,  wrhvl  = record_pair("hvl",  "hvl",  "the velocity of reference travel",      VELOCITY,      69, 148)
rdsdec, wrsdec = record_pair("sdec", "sdec", "the stop deceleration",                 ACCELERATION,  99, 168, LEAST_0)
rdsll,  wrsll  = record_pair("sll",  "sll",  "the left software limit",               POSITION,     100, 169)
rdslr,  wrslr  = record_pair("slr",  "slr",  "the right software limit",              POSITION,     101, 170)
rdipw,  wripw  = record_pair("ipw",  "ipw",  "the in-position window",                POSITION,      73, 149)
rdmpe,  wrmpe  = record_pair("mpe",  "mpe",  "the limit of the position error",       POSITION,      91, 165)
rdgf,   wrgf   = record_pair("gf",   "gf",   "the gear factor",                       "",            66, 145, ABOVE_0)
rdaux,  wraux  = record_pair("aux",  "aux",  "the auxiliary register",                "",            44, 133)
rdjovr, wrjovr = record_pair("jovr", "jovr", "the jog override",                      "",           152, 152, JOVR)

# ---------------------------------------------------------------------- positions, velocities, counters: they change
rdtp,  wrtp      = record_pair("tp",  "tp",  "the absolute target of the last travel command", POSITION, 103, 172, LIVE)
rdrp,  wrrp      = record_pair("rp",  "rp",  "the actual position",                            POSITION,  95, 167, RP)
rddp,  wrdp      = record_pair("dp",  "dp",  "the setpoint",                                   POSITION,  56, 140, DP)
rdlp,  wrlp      = record_pair("lp",  "lp",  "the latched position",                           POSITION,  82, 158, LP)
rdlpndx, wrlpndx = record_pair("lpndx", "lpndx", "the position latched at the encoder's index", POSITION, 83, 159, INDEX)
rdmcp, wrmcp     = record_pair("mcp", "mcp", "the motor command port",                         "",        88, 162, MCP)
rdrpd = read_record("rpd", _displayed("rp"), "the actual position",                            DISPLAY,   96, SHOWN_RP)
rddpd = read_record("dpd", _displayed("dp"), "the setpoint",                                   DISPLAY,   58, SHOWN_DP)
rdtpd = read_record("tpd", _displayed("tp"), "the absolute target of the last travel command", DISPLAY,  104, SHOWN_TP)
rddv  = read_record("dv",  "dv",             "the velocity of the profile",                    VELOCITY,  59, LIVE)
rdlsm = read_record("lsm", "lsm",            "the free spooler memory",                        "byte",    84, LIVE)
rdrv     = read_axis("rv",     "rv",             "the actual velocity",                        VELOCITY,  97, LIVE_AT)
rdPosErr = read_axis("PosErr", "PosErr",         "the position error",                         POSITION,  93, LIVE)
rdMCiS   = read_axis("MCiS",   "MCiS",           "the number of motion commands in the spooler", "",      87, LIVE_LONG)
rdPcapIndex = read_axis_coded("PcapIndex", "PcapIndex", "the index of the spooled command that is being executed", "", 94, PCAP)

# ---------------------------------------------------------------------- parameters of an axis, by its number
rdEffRadius, wrEffRadius = axis_pair("EffRadius", "effradius", "the effective radius",      "PU",              61, 143, LEAST_0)
rdJerkRel, wrJerkRel     = axis_pair("JerkRel",   "jerkrel",   "the relative jerk",         "",                76, 151, JERK)
rdMaxAcc,  wrMaxAcc      = axis_pair("MaxAcc",    "MaxAcc",    "the maximum acceleration",  PATH_ACCELERATION, 85, 160, LIMIT)
rdMaxVel,  wrMaxVel      = axis_pair("MaxVel",    "MaxVel",    "the maximum velocity",      PATH_VELOCITY,     86, 161, LIMIT)
rdMDVel,   wrMDVel       = axis_pair("MDVel",     "MDVEL",     "the maximum velocity jump", PATH_VELOCITY,     89, 163, LIMIT)
rdGCR,     wrGCR         = axis_pair("GCR",       "GCR",       "the gear configuration register", "",          65, 144, FLAGS)
rdControllerFlags, wrControllerFlags = axis_pair("ControllerFlags", "ControllerFlags", "the flags of the control algorithm", "", 51, 137, FLAGS)
rdslsp = read_axis_coded("slsp", "slsp", "the slits or steps of a motor turn", "", 102, SLSP)
wrslsp =      write_axis("slsp", "slsp", "the slits or steps of a motor turn", "", 171, ABOVE_0)
rddpoffset, wrdpoffset = axis_pair_coded("dpoffset", "dpoffset", "the offset added to the setpoint",           POSITION, 57, 141)
rddvoffset, wrdvoffset = axis_pair_coded("dvoffset", "dvoffset", "the velocity at which dpoffset changes",     VELOCITY, 60, 142, AT_ONCE)
rdgfaux,    wrgfaux    = axis_pair_coded("gfaux",    "gfaux",    "the ratio of motor steps to encoder counts", "",       67, 146)
rdZeroOffset           = read_axis_coded("ZeroOffset", "ZeroOffset", "the zero offset in force",                   POSITION, 110)

# ---------------------------------------------------------------------- the board
rdModeReg, wrModeReg = board_pair("ModeReg",  "modereg",   "the mode register",                                     "", 90, 164, FLAGS)
rdnfrax,   wrnfrax   = board_pair("nfrax",    "nfrax",     "the axes that do not count for the path, bit by bit",   "", 92, 166, FLAGS)
rdtrovr,   wrtrovr   = board_pair("trovr",    "trovr",     "the trajectory override as it is programmed",           "", 106, 174, TROVR)
rdErrorReg           = read_board("ErrorReg", "errorreg",  "the error register",                                    "", 63, ERROR)
rdtrovrst, wrtrovrst = board_pair_coded("trovrst", "trovrst", "the time in which the trajectory override changes by 1", "s", 107, 175, TIME)
rdtrac,    wrtrac    = board_pair_coded("trac",  "variables.trac",  "TRAC, the trajectory acceleration of SAP programs",    PATH_ACCELERATION, 105, 173, LEAST_0)
rdtrvl,    wrtrvl    = board_pair_coded("trvl",  "variables.trvl",  "TRVL, the trajectory velocity of SAP programs",        PATH_VELOCITY,     108, 176, LEAST_0)
rdtrtvl,   wrtrtvl   = board_pair_coded("trtvl", "variables.trtvl", "TRTVL, the trajectory target velocity of SAP programs", PATH_VELOCITY,    109, 177)
# fmt: on


@LIBRARY.on(Session.usable, refused=Success.FAILED)
def rdSampleTime(board: Board) -> tuple[CODE, Annotated[LONG, Out("value")]]:
    """Return 1 and the time of a scan in whole microseconds, (0, 0) without a board (Manual 002, 4.4.98)."""
    return int(Success.DONE), board.config.sample_time_us


@filled_at_once_call
def rdepc(tsrp: Exchange) -> None:
    """Read the number of EEPROM programming cycles into `tsrp.epc` (Manual 002, 4.4.62)."""
    tsrp.record.epc = tsrp.session.installed().eprom_cycles


# ---------------------------------------------------------------------- several at once


@filled_call
def rdaxst(tsrp: Exchange) -> None:
    """Read the axis status into `tsrp.axst` (Manual 002, 4.4.45)."""
    tsrp.record.axst = tsrp.session.status_of(tsrp.axis)


@filled_call
def rdap(tsrp: Exchange) -> None:
    """Read all elements of `tsrp` that table 3 of the manual lists (Manual 002, 4.4.43)."""
    values = tsrp.session.installed().axis_parameters(tsrp.axis.index)
    for name in _RECORD_ELEMENTS.intersection(values):
        setattr(tsrp.record, name, values[name])
    tsrp.record.axst = tsrp.session.status_of(tsrp.axis)


@filled_at_once_call
def rdf(tsrp: Exchange) -> None:
    """Read the six coefficients of the position loop into `tsrp` (Manual 002, 4.4.64)."""
    for name in _FILTER:
        setattr(tsrp.record, name, getattr(tsrp.axis, name))


@record_call
def uf(tsrp: Exchange) -> None:
    """Send the six coefficients of the position loop, at any time (Manual 002, 4.4.131)."""
    values = {name: getattr(tsrp.record, name) for name in _FILTER}
    if not all(map(is_number, values.values())):
        raise Refused(UNKNOWN_ERROR)
    for name, value in values.items():
        setattr(tsrp.axis, name, value)
    tsrp.axis.update_filter()


@LIBRARY.through(Session.axis, LONG)
def scp(an: BoardAxis, ctrlparams: CTRLPARAMS) -> None:
    """Send the field of 15 by 15 parameters for extensions of an axis (Manual 002, 4.4.114)."""
    field = np.array(ctrlparams.parameters, np.float64)
    if not bool(np.isfinite(field).all()):
        raise Refused(UNKNOWN_ERROR)
    an.ctrlparams[:] = field


@board_call
def ctru(board: Board, tru: TRU) -> None:
    """Select the units of position and time of all interpolation (Manual 002, 4.4.11).

    An index that is no unit leaves the units and sets ErrorReg.errUnit.
    """
    if tru.pu in set(PositionUnit) and tru.tu in set(TimeUnit):
        board.variables.pu, board.variables.tu = int(tru.pu), int(tru.tu)
    else:
        board.raise_error(ErrorReg.errUnit)


# fmt: off
__all__ = [
    "ctru", "rdControllerFlags", "rdEffRadius", "rdErrorReg", "rdGCR", "rdJerkRel", "rdMCiS", "rdMDVel",
    "rdMaxAcc", "rdMaxVel", "rdModeReg", "rdPcapIndex", "rdPosErr", "rdSampleTime", "rdZeroOffset",
    "rdap", "rdaux", "rdaxst", "rddp", "rddpd", "rddpoffset", "rddv", "rddvoffset", "rdepc", "rdf",
    "rdgf", "rdgfaux", "rdhac", "rdhvl", "rdipw", "rdjac", "rdjovr", "rdjtvl", "rdjvl", "rdlp", "rdlpndx",
    "rdlsm", "rdmcp", "rdmpe", "rdnfrax", "rdrp", "rdrpd", "rdrv", "rdsdec", "rdsll", "rdslr", "rdslsp",
    "rdtp", "rdtpd", "rdtrac", "rdtrovr", "rdtrovrst", "rdtrtvl", "rdtrvl", "scp", "uf",
    "wrControllerFlags", "wrEffRadius", "wrGCR", "wrJerkRel", "wrMDVel", "wrMaxAcc", "wrMaxVel",
    "wrModeReg", "wraux", "wrdp", "wrdpoffset", "wrdvoffset", "wrgf", "wrgfaux", "wrhac", "wrhvl",
    "wripw", "wrjac", "wrjovr", "wrjtvl", "wrjvl", "wrlp", "wrlpndx", "wrmcp", "wrmpe", "wrnfrax", "wrrp",
    "wrsdec", "wrsll", "wrslr", "wrslsp", "wrtp", "wrtrac", "wrtrovr", "wrtrovrst", "wrtrtvl", "wrtrvl",
]
# fmt: on
