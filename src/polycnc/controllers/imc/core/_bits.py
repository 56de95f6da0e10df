"""The bits of the registers error, aioctr, encpctr, homeseq, aio, status: one table, for the code and the reference.

Manual 004 prints the names of these registers and no bits. What is known comes from client programs and the vendor's
public headers; the bits of homeseq are this project's own.
"""

from __future__ import annotations

from typing import NamedTuple

# error; the same positions in stopfilt, stopmode, exitfilt, emstop
PLIM, NLIM, PSOF, NSOF, STOP, ALM = 0x1, 0x2, 0x4, 0x8, 0x10, 0x40
POSERR_LIMIT, TGPOS_RANGE, POS_RANGE, INSERR = 0x80, 0x200, 0x400, 0x1000
VEL_LIMIT, ACC_LIMIT = 0x2000, 0x4000

# aioctr
PLIM_HIGH, PLIM_ON, NLIM_HIGH, NLIM_ON, ORIGIN_HIGH = 0x1, 0x2, 0x4, 0x8, 0x10
PSOFT_ON, NSOFT_ON = 0x4000, 0x8000

# encpctr
CAPTURE_ON = 0x0400
FOLLOW_COMMAND = 0x8000

# homeseq
HOME_NEGATIVE, HOME_GO_TO, HOME_SWITCH, HOME_INDEX, HOME_RISING = 0x01, 0x02, 0x04, 0x08, 0x10
HOME_RETURNS = 0x60


class Bit(NamedTuple):
    """Some bits of a register, and what is so while they are set."""

    mask: int
    name: str
    meaning: str


REGISTERS: dict[str, tuple[Bit, ...]] = {
    "error": (
        Bit(PLIM, "PLIM", "positive limit switch; blocks motion in positive direction"),
        Bit(NLIM, "NLIM", "negative limit switch; blocks motion in negative direction"),
        Bit(PSOF, "PSOF", "`curpos` has reached `psoftlim`"),
        Bit(NSOF, "NSOF", "`curpos` has reached `nsoftlim`"),
        Bit(STOP, "STOP", "emergency stop, from `emstop`"),
        Bit(ALM, "ALM", "alarm of the servo; the simulated drive has none"),
        Bit(POSERR_LIMIT, "POSERRLIM", "`poserr` is beyond `poserrlim`"),
        Bit(TGPOS_RANGE, "TGPOSOV", "the target of a move is beyond 32 bits; the move is refused"),
        Bit(POS_RANGE, "POSOV", "the command position is out of range; never set here"),
        Bit(
            INSERR,
            "INSERR",
            "bad instruction: a segment of axes that are not free, a move without speed, acceleration or deceleration",
        ),
        Bit(VEL_LIMIT, "VELLIM", "faster than `vellim`; takes the axis out of run, whatever the masks say"),
        Bit(ACC_LIMIT, "ACCLIM", "more acceleration than `accellim`; takes the axis out of run as well"),
    ),
    "aioctr": (
        Bit(
            PLIM_HIGH,
            "positive limit high",
            "the positive limit is active while its terminal is high, 0: low",
        ),
        Bit(PLIM_ON, "positive limit on", "the positive limit switch is looked at"),
        Bit(
            NLIM_HIGH,
            "negative limit high",
            "the negative limit is active while its terminal is high, 0: low",
        ),
        Bit(NLIM_ON, "negative limit on", "the negative limit switch is looked at"),
        Bit(
            ORIGIN_HIGH, "origin high", "the origin switch is active while its terminal is high, for `aiolat`"
        ),
        Bit(PSOFT_ON, "positive software limit on", "`psoftlim` is looked at"),
        Bit(NSOFT_ON, "negative software limit on", "`nsoftlim` is looked at"),
    ),
    "encpctr": (
        Bit(CAPTURE_ON, "capture", "a pulse of the probe captures the position"),
        Bit(FOLLOW_COMMAND, "virtual feedback", "`encp` follows the command; 0: the encoder"),
    ),
    "homeseq": (
        Bit(HOME_NEGATIVE, "negative", "search in negative direction"),
        Bit(HOME_GO_TO, "go to", "in the end move to `homestpos`, 0: stop"),
        Bit(HOME_SWITCH, "switch", "search the origin switch"),
        Bit(HOME_INDEX, "index", "count `indexNum` index pulses, after the switch where both are set"),
        Bit(HOME_RISING, "rising", "the rising edge of the switch counts, 0: the falling one"),
        Bit(HOME_RETURNS, "returns", "how often the axis comes back to the edge, 0 to 2"),
    ),
    "aio": (
        Bit(0x1, "positive limit", "its terminal is high"),
        Bit(0x2, "negative limit", "its terminal is high"),
        Bit(0x4, "origin", "the terminal of the origin switch is high"),
    ),
    "status": (Bit(0x1, "BREAKP", "`curpos` is at or beyond `breakp`"),),
}
"""Registers of an axis whose bits are known."""
