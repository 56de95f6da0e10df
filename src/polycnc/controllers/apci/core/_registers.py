"""The bit registers of the board, each as one table: number, name, meaning, and what clears the bit.

Names are the manual's. Bits that it calls undefined have no name here, and are 0 on this board.
"""

# ruff: noqa: N815  the names are the manual's

from __future__ import annotations

from enum import IntEnum, IntFlag
from typing import Self

WORD_BITS = 32


class Bits(IntFlag):
    """Base of the tables: a bit has a `number` from 0, a `meaning`, and names what it is `cleared_by`."""

    number: int
    meaning: str
    cleared_by: tuple[str, ...]

    def __new__(cls, number: int, meaning: str = "", *cleared_by: str) -> Self:
        """Make the bit with this number."""
        bit = int.__new__(cls, 1 << number)
        bit._value_ = 1 << number
        bit.number, bit.meaning, bit.cleared_by = number, meaning, cleared_by
        return bit

    def __str__(self) -> str:
        """Return the names of the bits, and what has none as a number."""
        rest = int(self) & ~type(self).assigned()
        names = [str(bit.name) for bit in type(self) if bit in self]
        return " | ".join([*names, *([f"{rest:#x}"] if rest else [])]) or "0"

    def __format__(self, spec: str) -> str:
        """Return the names of the bits, or the number where a format is given."""
        return format(int(self), spec) if spec else str(self)

    @classmethod
    def assigned(cls) -> int:
        """Return the mask of all bits that have a meaning."""
        return sum(cls)

    @classmethod
    def cleared(cls, word: int, cause: str) -> int:
        """Return `word` without the bits that `cause` (a command, "BootFile", "reading ...") clears."""
        return word & ~sum(bit for bit in cls if cause in bit.cleared_by)


def bit_of(word: int, number: int) -> int:
    """Return bit `number` of `word`, counted from 1 as the single-bit functions do; 0 outside 1 to 32.

    Source: manual 002, 4.4.46, 4.4.53, 4.4.71: pe, bit 12 of axst, has the number 13.
    """
    return word >> (number - 1) & 1 if 1 <= number <= WORD_BITS else 0


class Axst(Bits):
    """Axis status, table 12."""

    eo = 1, "an input planned EO is active: emergency out"
    dnr = 2, "an input planned DR is inactive: the drive is not ready"
    lslh = 3, "an input planned LSL_TOM, LSL_SMA or LSL_SMD is active"
    lsrh = 4, "an input planned LSR_TOM, LSR_SMA or LSR_SMD is active"
    lsls = 5, "the setpoint is left of sll", "cl", "ra", "rs"
    lsrs = 6, "the setpoint is right of slr", "cl", "ra", "rs"
    mpe = 7, "the position error has exceeded mpe"
    dhef = 8, "the operating system found wrong data, see ErrorReg", "BootFile", "ra", "rs"
    cef = 9, "the board is not what the system file describes"
    pe = 12, "the profile has ended"
    cl = 13, "the position loop is closed"
    ip = 14, "the profile has ended and the position error is inside ipw"
    ui = 15, "an input planned UI is active"
    lpsf = 16, "a position was latched", "reading lp"
    referenced = (
        17,
        "shp has set the machine zero; of a stepper also cl and ol clear it",
        "BootFile",
        "ra",
        "rs",
        "writing rp",
    )
    refh = 18, "an input planned REF is active"
    saf = 19, "the spooler is out of step with the other axes", "cl", "ra", "jog", "direct move"


class ErrorReg(Bits):
    """Errors of the operating system, table 15. The manual names nothing that clears them."""

    errAxDef = 0, "an axis is named twice in the selection of a command"
    errTargetVel = 1, "the spooler ran empty at speed although ForbidTargetVel is set; the system was reset"
    errUnit = 2, "a unit that does not exist"
    errCenterPoint = 3, "a circle with an impossible centre or no radius"
    errSpoolerOverrun = 4, "the spooler of an axis is full"
    ProfileTooSmall = 5, "two spooled profiles in a row took less than one scan each"
    SplineSizeErr = 6, "too many splines are loaded"
    RotationFail = 7, "the rotation of axes failed"
    PciBusError = 8, "the bridge to the PCI bus reported an error"
    CheckMonitorScreen = 9, "a wrong output to the monitor screen"
    SsfWaitRefused = 10, "a wait in the spooler was skipped because the profile before it ends at speed"
    SpoolerLoadError = 11, "a command reached the spooler while the system was making a profile itself"
    VelocityZero = 12, "an interpolation with velocity 0"
    AccelZero = 13, "an interpolation with acceleration 0"
    LimitDefError = 14, "mcpmax, mcpmin, mcpcp or mcpcn is impossible"
    ZeroProfile = 15, "an interpolation over hardly any distance was refused"
    RadiusError = 16, "a circle or helix with hardly any radius was refused"
    SpoolerDeepTooLess = 17, "the spooler held too few profiles to look ahead"
    IOResetHandled = 18, "the inputs and outputs were reset unexpectedly"
    JSatSAFdone = 19, "an axis out of step was stopped and left the interpolation"
    reserved = 20, "kept for an option"


class Digi(Bits):
    """Digital inputs and signals of the encoder, table 13; 1 is active."""

    input1 = 0, "input 1"
    input2 = 1, "input 2"
    input3 = 2, "input 3"
    input4 = 3, "input 4"
    input5 = 4, "input 5"
    input6 = 5, "input 6"
    input7 = 6, "input 7"
    input8 = 7, "input 8"
    input9 = 8, "input 9"
    input10 = 9, "input 10"
    input11 = 10, "input 11"
    input12 = 11, "input 12"
    input13 = 12, "input 13"
    input14 = 13, "input 14; also latches the position of axis 0"
    input15 = 14, "input 15; also latches the position of axis 1"
    input16 = 15, "input 16; also latches the position of axis 2"
    index = 16, "the encoder's index signal", "rdigi"
    encoder_error = 17, "the encoder was read wrongly", "rdigi"
    index_latched = 18, "the index signal was seen", "rdigi"
    strobe_latched = 19, "the hardware strobe was seen", "rdigi"
    AEA = 20, "APCI-8008: alarm of encoder channel A"
    AEB = 21, "APCI-8008: alarm of encoder channel B"
    AEN = 22, "APCI-8008: alarm of the encoder's index channel"
    AES = 23, "APCI-8008: group alarm of the encoder"


INPUTS = 16
INPUT_PINS = (*range(9, 17), *range(42, 50))  # of connector X1, input 1 first
STROBE_INPUT_OF_AXIS = (14, 15, 16)  # inputs that latch the position of axes 0, 1, 2
DIGI_8008_ONLY = Digi.AEA | Digi.AEB | Digi.AEN | Digi.AES


class Digo(Bits):
    """Digital outputs, table of 4.4.138; 1 is set."""

    output1 = 0, "output 1"
    output2 = 1, "output 2"
    output3 = 2, "output 3"
    output4 = 3, "output 4"
    output5 = 4, "output 5"
    output6 = 5, "output 6"
    output7 = 6, "output 7"
    output8 = 7, "output 8"


OUTPUTS = 8
OUTPUT_PINS = tuple(range(26, 34))  # of connector X1, output 1 first


def with_output(word: int, number: int, value: int) -> int:
    """Return the output word with output `number` (from 1) set or reset; a number without output changes nothing."""
    if not 1 <= number <= OUTPUTS:
        return word
    mask = 1 << (number - 1)
    return word | mask if value else word & ~mask


class Ifs(Bits):
    """State of the board's interfaces, table 16."""

    edv = 0, "the data in the EPROM are valid"
    cncrdy = 1, "the ready relay is closed"
    pfe = 16, "the supply fell below 2.85 V, or the board was switched on", "rifs", "second BootFile"
    wdog = 17, "the watchdog has tripped", "rifs", "second BootFile"
    iae = 18, "the operating system made an invalid access", "rifs", "second BootFile"
    scwdog = 19, "the watchdog of the secondary circuit has tripped", "rifs", "second BootFile"
    scpfe = 20, "the supply fell below 4.75 V, or the board was switched on", "rifs", "second BootFile"
    BusError = 21, "an ENDAT, SSI or EtherCAT connection failed", "BootFile"
    EpmBaseResetFlag = 22, "the I/O of the motherboard were reset unexpectedly", "BootFile"
    EpmOpmfResetFlag = 23, "the I/O of the option board were reset unexpectedly", "BootFile"


class ModeReg(Bits):
    """Modes of the whole board, as far as part 1 of the manual tells.

    Bits 6 and 25 are mentioned without their meaning: they are kept and have no effect. The last five are named
    without a number; the numbers are this project's ruling.
    """

    lookahead = 0, "look ahead over the spooler; MDVEL limits the jump of each axis"
    bit6 = 6, "without effect: belongs to the check of MDVEL"
    maxcheck = 7, "MaxVel and MaxAcc limit spooled linear interpolation"
    rotaxisunit = 10, "distances of rotary axes are given in the axis' own unit"
    MS_DECEL = 15, "ms of the PC brakes with TRAC"
    bit25 = 25, "without effect: belongs to the adaptation of the override"
    WritelnStops = 26, "WRITELN stops its task"
    JSatSAF = 28, "axes out of step are stopped as by js"
    SProfile = 16, "velocity profiles are S-shaped, see jerkrel"
    OvrMode = 17, "utrovr leaves jovr alone"
    ForbidTargetVel = 18, "a spooler that runs empty at speed resets the system"
    InhibitProfileRefuse = 19, "profiles without velocity or acceleration are not refused"
    ClearZeroPosition = 20, "without effect: belongs to the zero offsets"


MODE_BITS_RULED = (
    ModeReg.SProfile,
    ModeReg.OvrMode,
    ModeReg.ForbidTargetVel,
    ModeReg.InhibitProfileRefuse,
    ModeReg.ClearZeroPosition,
)


class Running(Bits):
    """What a CNC task does: CNCTS.running, table 11."""

    running = 0, "the task executes a program"
    single_step = 1, "the task waits for stepcnct or contcnct"
    stopped_by_writeln = 2, "WRITELN has stopped the task"
    waiting = 3, "the task waits, for a time or the end of a profile"


class TskInfo(Bits):
    """Output of a CNC task that nobody has read, 4.4.13."""

    incomplete = 0, "WRITE has left a string without end", "gettskstr"
    complete = 1, "WRITELN has ended a string", "gettskstr"


class BoardType(IntEnum):
    """What InitMcuSystem3 says about the board, 4.4.18. Any other number is a newer product."""

    UNKNOWN = 0
    PA_8000 = 1
    PS_840 = 2
    APCI_8001 = 4
    APCI_8008 = 32


def board_name(number: int) -> str:
    """Return the name of the board with this type number."""
    names = {
        BoardType.UNKNOWN: "unknown board, or an old operating system",
        BoardType.PA_8000: "PA 8000",
        BoardType.PS_840: "PS 840",
        BoardType.APCI_8001: "APCI-8001",
        BoardType.APCI_8008: "APCI-8008",
    }
    return names.get(BoardType(number), "") if number in set(BoardType) else f"newer product {number}"


def assigned_inputs(board_type: int) -> int:
    """Return the mask of the digi bits that this type of board has."""
    return Digi.assigned() & ~(0 if board_type == BoardType.APCI_8008 else int(DIGI_8008_ONLY))
