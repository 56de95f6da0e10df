"""Everything that one board is made of in the scan, as arrays that Python and the compiled scan share.

Positions are machine positions in axis units; what a caller calls zero is subtracted at the edges (`zero`). Paths are
traversed in *path units*: millimetres, degrees or counts, by the position unit in force when the entry was made.
`weight` is path units per axis unit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel import PROFILE_COLUMNS, PROFILE_PHASES, Segments, make_segments

Floats = npt.NDArray[np.float64]
Whole = npt.NDArray[np.int64]

# What moves an axis.
IDLE = 0
JOG = 1  # a profile in the axis' own coordinate
MOVE = 2  # a profile along the path of an entry
TABLE = 3  # one setpoint a scan
WAITING = 4  # at rest in the spooler, in front of a command that is not met yet

# What ends a search run.
NO_SEARCH = 0
SEARCH_INDEX = 1
SEARCH_REFERENCE = 2
SEARCH_ENDS = 3  # found: brakes to rest, then it is a motion like any other

# Who brakes a stopping axis.
BY_COMMAND = 1
BY_SYSTEM = 2  # a limit, or the monitor of the spoolers

# Limit functions, and the sides they act on.
NO_LIMIT = 0
TOM = 1  # turn off motor
SMA = 2  # stop motor abruptly
SMD = 3  # stop motor with deceleration
LEFT = 1
RIGHT = 2

_PARAMETERS = (
    *("jac", "jdec", "jvl", "jtvl", "jovr", "hac", "hvl", "sdec", "sll", "slr", "ipw", "mpe"),
    *("gf", "gfaux", "slsp", "effradius", "MaxVel", "MaxAcc", "MDVEL", "jerkrel", "dpoffset"),
    *("dvoffset", "aux", "tp", "kp", "ki", "kd", "kpl", "kfca", "kfcv"),
)

AXIS_ROW = np.dtype(
    [
        # Parameters, in axis units and seconds; a negative jac has set jdec.
        *((name, np.float64) for name in _PARAMETERS),
        ("GCR", np.int64),
        ("ControllerFlags", np.int64),
        ("stepper", np.int64),
        ("rotary", np.int64),
        ("soft_left", np.int64),  # limit functions of the software limits
        ("soft_right", np.int64),
        # Coordinates.
        ("zero", np.float64),  # machine position of the axis' machine zero
        ("offset", np.float64),  # zero offset in force, from the machine zero
        # The motion.
        ("motion", np.int64),
        ("search", np.int64),
        ("stopping", np.int64),  # brakes to rest: the override and the limits leave it alone
        ("past", np.int64),  # goes on past the end of its profile
        ("commanded", np.int64),  # direct commands on their way to it
        ("direct", np.int64),  # the MOVE was commanded directly
        ("entry", np.int64),  # what a MOVE or a TABLE goes along
        ("target", np.float64),
        ("tvl", np.float64),
        ("vl", np.float64),
        ("ac", np.float64),
        ("dec", np.float64),
        ("policy", np.int64),
        ("endless", np.int64),
        ("lead", np.float64),  # time into the profile at sample 0
        ("cycles", np.int64),  # samples taken of it
        ("duration", np.float64),
        ("phases", np.int64),
        ("place", np.float64),  # of the last sample: position (JOG) or path length (MOVE)
        ("speed", np.float64),  # of the last sample, in the same coordinate
        ("tovr", np.float64),  # trajectory override in force
        ("override_goal", np.float64),  # `tovr` moves there
        ("point", np.int64),  # of a TABLE: rows taken
        ("anchor", np.float64),  # of a TABLE: where relative setpoints count from
        ("heading", np.int64),  # direction of the last movement, for the backlash
        ("backlash", np.float64),
        ("shift", np.float64),  # by which the backlash has the setpoint moved
        # The spooler.
        ("running", np.int64),
        ("head", np.int64),
        ("tail", np.int64),
        ("used", np.int64),  # bytes of its memory
        ("points", np.int64),  # rows of the points store ever filled
        ("ends_at_speed", np.int64),  # the last move was to end with a velocity
        ("wait_scans", np.int64),  # left of a wait
        ("met", np.int64),  # the wait it stands at is over
        ("skip_wait", np.int64),  # ssms ends a wait of time or inputs
        ("short_entries", np.int64),  # profiles shorter than a scan in a row
        ("pcap_index", np.int64),
        # Status.
        ("closed", np.int64),
        ("pe", np.int64),
        ("saf", np.int64),
        ("referenced", np.int64),
        ("position_error", np.int64),
        ("in_position", np.int64),
        ("hard_limit", np.int64),  # bits LEFT and RIGHT
        ("soft_limit", np.int64),
        ("held", np.int64),  # SMA: the setpoint is held at `held_at`, side as a sign, twofold by software
        ("held_at", np.float64),
        ("dhef", np.int64),
        ("cef", np.int64),
        # Latches.
        ("lpsf", np.int64),
        ("lp_source", np.int64),
        ("lp_level", np.int64),  # of its input in the last scan
        ("strobe_level", np.int64),
        ("signals", np.int64),  # of the encoder, as bits of digi
        ("lp", np.float64),
        ("lpndx", np.float64),
        ("latch_scans", np.int64),  # latch every so many scans, 0 off
        ("latch_count", np.int64),
        ("rv", np.float64),
        # The motor command port.
        ("mcp", np.int64),  # as it was written with the loop open
        ("mcp_low", np.int64),
        ("mcp_high", np.int64),
        ("mcp_gain", np.float64),  # of a servo: velocity per count; its sign is the planned inversion
        ("mcp_clock", np.float64),  # of a stepper: velocity of one step per half clock pulse, signed
    ],
    align=True,
)

ENTRY_ROW = np.dtype(
    [
        ("kind", np.int64),  # MOVE, TABLE, or SPECIAL
        ("mask", np.int64),  # axes that take part, bit by index
        ("refs", np.int64),  # axes that have not finished it
        ("ac", np.float64),  # in path units and seconds
        ("vl", np.float64),
        ("tvl", np.float64),
        ("out", np.float64),  # target velocity that the look-ahead allows; NaN if it did not look
        ("join", np.float64),  # at which sstvl lets it end in front of a table or nothing
        ("started", np.int64),  # scan in which its first axis began, -1 none
        ("lead", np.float64),  # time into that scan
        ("begun", np.int64),  # axes that have begun
        ("command", np.int64),
        ("value", np.float64),
        ("first", np.int64),  # of a TABLE: row of the points store
        ("points", np.int64),
        ("relative", np.int64),
        ("index", np.int64),  # PcapIndex of the first point, -1 none
    ],
    align=True,
)
SPECIAL = 5

BOARD_ROW = np.dtype(
    [
        ("scan", np.int64),
        ("dt", np.float64),
        ("error_register", np.int64),
        ("mode_register", np.int64),
        ("trovr", np.float64),
        ("trovrst", np.float64),
        ("external", np.int64),  # levels at the terminals, input 1 is bit 0
        ("inverted", np.int64),  # inputs that are active when low
        ("inputs", np.int64),  # active inputs
        ("outputs", np.int64),
        ("irq", np.int64),  # interrupts raised that nobody has fetched
        ("free", np.int64),  # entries on the free list
        ("stop_all", np.int64),  # axes out of step: all are to brake
        ("attention", np.int64),  # something happened that Python waits for
        ("nfrax", np.int64),
        ("io_down", np.int64),  # inputs and outputs have been reset by an error
        # Recording for the graphical system analysis.
        ("record_axes", np.int64),  # bit by index
        ("record_every", np.int64),  # scans, 0 off
        ("record_count", np.int64),
        ("recorded", np.int64),  # rows filled
    ],
    align=True,
)

# Digital inputs planned for an axis, as bit masks of inputs; one row per axis.
_PLANNED = (
    *("EO", "DR", "UI", "REF", "LP", "strobe"),
    *("LSL_TOM", "LSL_SMA", "LSL_SMD", "LSR_TOM", "LSR_SMA", "LSR_SMD"),
    *("left_switch", "right_switch", "reference_switch"),  # that the simulated switches drive
    "PAE",  # outputs
)
PLAN_ROW = np.dtype([(name, np.int64) for name in _PLANNED], align=True)

ENTRY_BYTES = 145  # of the 145 kByte of spooler memory of an axis
POINT_BYTES = 8
SPOOL_BYTES = 145_000
SPOOL_ENTRIES = SPOOL_BYTES // ENTRY_BYTES
POINTS = SPOOL_BYTES // POINT_BYTES
ANALYSIS_ROWS = 4096
QUANTITIES = 3  # recorded of each axis: setpoint and actual machine position, commanded velocity


class BoardState(NamedTuple):
    """A board of n axes; its kernel state stands beside it."""

    board: npt.NDArray[np.void]  # [1] of BOARD_ROW
    axis: npt.NDArray[np.void]  # [n] of AXIS_ROW
    plan: npt.NDArray[np.void]  # [n] of PLAN_ROW
    weight: Floats  # [E, n] path units per axis unit, on the path of each entry
    phases: Floats  # [n, PROFILE_PHASES, PROFILE_COLUMNS]
    ring: Whole  # [n, SPOOL_ENTRIES] entries queued, by axis
    entry: npt.NDArray[np.void]  # [E] of ENTRY_ROW
    free: Whole  # [E] stack of free entries
    seg: Segments  # [E] the path of each MOVE, in path units
    points: Floats  # [n, POINTS] setpoints of tables, a ring for each axis
    feed_axis: npt.NDArray[np.uint8]  # [n] counts for the length of paths
    work: Floats  # [2, n] scratch
    analysis: Floats  # [ANALYSIS_ROWS, n, QUANTITIES] what lpr and lprs record
    ci: npt.NDArray[np.int32]  # [1000] common integer variables
    cd: Floats  # [1000]


def make_board_state(axes: int, dt: float) -> BoardState:
    """Allocate a board of `axes` axes, all at rest at 0 with open loops."""
    entries = axes * SPOOL_ENTRIES + axes
    board = np.zeros(1, BOARD_ROW)
    board["dt"] = dt
    board["trovr"] = 1.0
    board["free"] = entries
    axis = np.zeros(axes, AXIS_ROW)
    for name in ("jovr", "tovr", "override_goal", "jerkrel", "gf", "gfaux", "slsp"):
        axis[name] = 1.0
    axis["pe"] = 1
    axis["entry"] = -1
    axis["pcap_index"] = -1
    return BoardState(
        board=board,
        axis=axis,
        plan=np.zeros(axes, PLAN_ROW),
        weight=np.ones((entries, axes)),
        phases=np.zeros((axes, PROFILE_PHASES, PROFILE_COLUMNS)),
        ring=np.zeros((axes, SPOOL_ENTRIES), np.int64),
        entry=np.zeros(entries, ENTRY_ROW),
        free=np.arange(entries - 1, -1, -1),
        seg=make_segments(entries, axes),
        points=np.zeros((axes, POINTS)),
        feed_axis=np.ones(axes, np.uint8),
        work=np.zeros((2, axes)),
        analysis=np.zeros((ANALYSIS_ROWS, axes, QUANTITIES)),
        ci=np.zeros(1000, np.int32),
        cd=np.zeros(1000),
    )
