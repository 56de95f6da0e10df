"""What grbl 1.1 calls its errors and alarms, by number; each is a line of its documented interface."""

from __future__ import annotations

from polycnc.controllers.library import Code


class GrblError(Code):
    """Why a line was refused: `error:n`."""

    LETTER = 1, "G-code words consist of a letter and a value; the letter was not found"
    NUMBER = 2, "The value of a word is missing or no number"
    STATEMENT = 3, "The $ command is not known"
    NEGATIVE = 4, "A value that must not be negative is"
    NO_HOMING = 5, "Homing is not enabled ($22)"
    NOT_IDLE = 8, "The command needs a machine that is idle"
    LOCKED = 9, "G-code is locked out by an alarm or a jog"
    NEEDS_HOMING = 10, "Soft limits need homing ($22)"
    OVERFLOW = 11, "The line is longer than 79 characters"
    TRAVEL = 15, "The target of a jog is beyond the travel"
    JOG = 16, "The jog has no '=', or words that a jog does not take"
    UNSUPPORTED = 20, "The G-code command is not supported"
    GROUP = 21, "Two commands of one modal group"
    NO_FEED = 22, "No feed rate is set"
    INTEGER = 23, "The command needs a whole number"
    TWO_AXIS_COMMANDS = 24, "Two commands use the axis words"
    REPEATED = 25, "A word is repeated"
    NO_AXES = 26, "The command needs axis words"
    LINE_NUMBER = 27, "The line number is not between 1 and 9,999,999"
    MISSING = 28, "P or L is missing"
    NO_SYSTEM = 29, "Work coordinate systems are G54 to G59"
    MACHINE_MOTION = 30, "G53 goes with G0 and G1 only"
    NO_MOTION = 31, "Axis words, and no command that uses them"
    ARC_AXES = 32, "The arc has no axis word of its plane"
    TARGET = 33, "The target of the motion is invalid"
    ARC_RADIUS = 34, "The arc cannot be computed with this radius"
    ARC_OFFSETS = 35, "The arc has no offset word of its plane"
    UNUSED = 36, "Words that no command uses"


class GrblAlarm(Code):
    """Why the machine is locked: `ALARM:n`."""

    HARD_LIMIT = 1, "A limit switch was met, or a drive failed: the position may be lost"
    SOFT_LIMIT = 2, "A target is beyond the travel; the position is kept"
    ABORTED = 3, "Reset while in motion, or the emergency stop: the position may be lost"
    PROBE_NO_CONTACT = 5, "The probe met nothing within its travel"
    HOMING_RESET = 6, "Reset while homing"
    HOMING_FAILED = 9, "Homing found no switch"


class RefusedError(Exception):
    """A line is refused with a number; `message` says more where grbl's own number says little."""

    def __init__(self, error: GrblError, message: str = "") -> None:
        super().__init__(error.text)
        self.error = error
        self.message = message
