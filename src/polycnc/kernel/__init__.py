"""What happens in one control cycle: profiles, path geometry, look-ahead, interpolation, coupling, servo."""

from polycnc.kernel._advance import advance, cycle, give_to_path, give_to_point_to_point, place_machine, skip
from polycnc.kernel._append import add_line, append_arc, append_line, append_wait
from polycnc.kernel._geometry import segment_point
from polycnc.kernel._interpolate import replan_path, start_path
from polycnc.kernel._jit import compiled, entry, is_cold
from polycnc.kernel._limits import AxisLimits, make_limits
from polycnc.kernel._lookahead import measure_queue, prepare_path
from polycnc.kernel._path import (
    FEED_LENGTH,
    FEED_S,
    RAPID_LENGTH,
    RAPID_S,
    SEGMENTS,
    TOP_SPEED,
    WAIT_S,
    Paths,
    free_slots,
    make_paths,
    slot,
)
from polycnc.kernel._point_to_point import ADDED, MAIN, PointToPoint, move_to, stop_axis
from polycnc.kernel._profile import SHORT_JUMP, SHORT_OVERSHOOT, SHORT_REDUCE_START
from polycnc.kernel._recorder import BLOCK, FEED, IS_RAPID, LEADING, TIME_S
from polycnc.kernel._segments import ARC, LINE, RAPID, STOP, WAIT, Segments, make_segments
from polycnc.kernel._servo import IDEAL, PIDF
from polycnc.kernel._state import (
    FOLLOWING_ERROR,
    PATH_EVENT,
    PATH_RESTED,
    POINT_TO_POINT,
    PROFILE_ENDED,
    QUEUE_LOW,
    RECORDER_FULL,
    SOFT_LIMIT,
    SWITCH_EDGE,
    TABLE_EMPTY,
    KernelState,
    make_state,
)
from polycnc.kernel._switches import LIMIT_HIGH, LIMIT_LOW, REFERENCE

__all__ = [
    "ADDED",
    "ARC",
    "BLOCK",
    "FEED",
    "FEED_LENGTH",
    "FEED_S",
    "FOLLOWING_ERROR",
    "IDEAL",
    "IS_RAPID",
    "LEADING",
    "LIMIT_HIGH",
    "LIMIT_LOW",
    "LINE",
    "MAIN",
    "PATH_EVENT",
    "PATH_RESTED",
    "PIDF",
    "POINT_TO_POINT",
    "PROFILE_ENDED",
    "QUEUE_LOW",
    "RAPID",
    "RAPID_LENGTH",
    "RAPID_S",
    "RECORDER_FULL",
    "REFERENCE",
    "SEGMENTS",
    "SHORT_JUMP",
    "SHORT_OVERSHOOT",
    "SHORT_REDUCE_START",
    "SOFT_LIMIT",
    "STOP",
    "SWITCH_EDGE",
    "TABLE_EMPTY",
    "TIME_S",
    "TOP_SPEED",
    "WAIT",
    "WAIT_S",
    "AxisLimits",
    "KernelState",
    "Paths",
    "PointToPoint",
    "Segments",
    "add_line",
    "advance",
    "append_arc",
    "append_line",
    "append_wait",
    "compiled",
    "cycle",
    "entry",
    "free_slots",
    "give_to_path",
    "give_to_point_to_point",
    "is_cold",
    "make_limits",
    "make_paths",
    "make_segments",
    "make_state",
    "measure_queue",
    "move_to",
    "place_machine",
    "prepare_path",
    "replan_path",
    "segment_point",
    "skip",
    "slot",
    "start_path",
    "stop_axis",
]
