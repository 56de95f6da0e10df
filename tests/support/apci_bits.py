"""Bits of the board with the numbers that the manual prints (002, tables 12 and 15, and where it names a mode).

Tests read registers with these and not with the code's own, so that they notice a bit that moves.
"""

from __future__ import annotations


class Axst:
    """Status word of an axis."""

    eo = 1 << 1
    dnr = 1 << 2
    lslh = 1 << 3
    lsrh = 1 << 4
    lsls = 1 << 5
    lsrs = 1 << 6
    mpe = 1 << 7
    dhef = 1 << 8
    cef = 1 << 9
    pe = 1 << 12
    cl = 1 << 13
    ip = 1 << 14
    ui = 1 << 15
    lpsf = 1 << 16
    referenced = 1 << 17
    refh = 1 << 18
    saf = 1 << 19


class ErrorReg:
    """Errors of the board."""

    errAxDef = 0x00000001
    errTargetVel = 0x00000002
    errUnit = 0x00000004
    errCenterPoint = 0x00000008
    errSpoolerOverrun = 0x00000010
    ProfileTooSmall = 0x00000020
    SplineSizeErr = 0x00000040
    RotationFail = 0x00000080
    PciBusError = 0x00000100
    CheckMonitorScreen = 0x00000200
    SsfWaitRefused = 0x00000400
    SpoolerLoadError = 0x00000800
    VelocityZero = 0x00001000
    AccelZero = 0x00002000
    LimitDefError = 0x00004000
    ZeroProfile = 0x00008000
    RadiusError = 0x00010000
    SpoolerDeepTooLess = 0x00020000
    IOResetHandled = 0x00040000
    JSatSAFdone = 0x00080000


class ModeReg:
    """Modes of the board; the last five are named without a number, and have the ruled ones."""

    lookahead = 1 << 0
    bit6 = 1 << 6
    maxcheck = 1 << 7
    rotaxisunit = 1 << 10
    MS_DECEL = 1 << 15
    bit25 = 1 << 25
    WritelnStops = 1 << 26
    JSatSAF = 1 << 28
    SProfile = 1 << 16
    OvrMode = 1 << 17
    ForbidTargetVel = 1 << 18
    InhibitProfileRefuse = 1 << 19
    ClearZeroPosition = 1 << 20
