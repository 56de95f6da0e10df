"""What G and M codes can do, whatever number a dialect gives them, and which of them exclude each other."""

from __future__ import annotations

from enum import Enum, IntEnum, StrEnum, auto


class Group(StrEnum):
    """Modal groups: of each, a block may hold one word.

    Leaving a cycle is a group of its own: CAM systems begin programs with G0 and G80 in one block.
    """

    MOTION = "motion"
    CYCLE_CANCEL = "cycle_cancel"
    NON_MODAL = "non_modal"
    DWELL = "dwell"
    PLANE = "plane"
    UNITS = "units"
    DISTANCE = "distance"
    ARC_DISTANCE = "arc_distance"
    FEED_MODE = "feed_mode"
    SPINDLE_MODE = "spindle_mode"
    RADIUS_COMPENSATION = "radius_compensation"
    LENGTH_COMPENSATION = "length_compensation"
    WORK_OFFSET = "work_offset"
    ROTATION = "rotation"
    POLAR = "polar"
    STOPPING = "stopping"
    EXACT_STOP_BLOCK = "exact_stop_block"
    RETRACT = "retract"
    IGNORED = "ignored"


class Action(IntEnum):
    """What a G code does. Numbers are private to this process; names stand in dialect files."""

    RAPID = auto()
    LINEAR = auto()
    ARC_CW = auto()
    ARC_CCW = auto()
    CUBIC_SPLINE = auto()
    QUADRATIC_SPLINE = auto()
    NURBS = auto()
    NURBS_END = auto()
    MOTION_OFF = auto()
    THREAD = auto()
    THREAD_CHANGING = auto()
    TURN_CYCLE = auto()
    THREAD_CYCLE = auto()
    FACE_CYCLE = auto()
    DWELL = auto()
    EXACT_STOP_BLOCK = auto()
    PLANE_XY = auto()
    PLANE_ZX = auto()
    PLANE_YZ = auto()
    INCH = auto()
    METRIC = auto()
    REFERENCE_RETURN = auto()
    REFERENCE_POINT = auto()
    COMP_OFF = auto()
    COMP_LEFT = auto()
    COMP_RIGHT = auto()
    LENGTH_PLUS = auto()
    LENGTH_MINUS = auto()
    LENGTH_OFF = auto()
    MACHINE_COORDINATES = auto()
    WORK_OFFSET = auto()
    WORK_OFFSET_OFF = auto()
    EXACT_STOP = auto()
    EXACT_PATH = auto()
    CONTINUOUS = auto()
    ABSOLUTE = auto()
    INCREMENTAL = auto()
    ARC_CENTER_ABSOLUTE = auto()
    ARC_CENTER_INCREMENTAL = auto()
    SET_POSITION = auto()
    CLEAR_SET_POSITION = auto()
    FEED_INVERSE_TIME = auto()
    FEED_PER_MINUTE = auto()
    FEED_PER_REVOLUTION = auto()
    CONSTANT_SURFACE_SPEED = auto()
    SPINDLE_RPM = auto()
    CYCLE_CANCEL = auto()
    CYCLE_CHIP_BREAK = auto()
    CYCLE_FINE_BORE = auto()
    CYCLE_DRILL = auto()
    CYCLE_DWELL = auto()
    CYCLE_DEEP = auto()
    CYCLE_TAP = auto()
    CYCLE_TAP_LEFT = auto()
    CYCLE_BORE = auto()
    CYCLE_BORE_STOP = auto()
    CYCLE_BACK_BORE = auto()
    CYCLE_BACK_BORE_UP = auto()
    CYCLE_BORE_MANUAL = auto()
    CYCLE_BORE_DWELL = auto()
    RETRACT_INITIAL = auto()
    RETRACT_R = auto()
    SET_DATA = auto()
    SET_WORK_ZERO = auto()
    LOCAL_COORDINATES = auto()
    SCALING = auto()
    SCALING_OFF = auto()
    MIRROR = auto()
    MIRROR_OFF = auto()
    ROTATION = auto()
    ROTATION_OFF = auto()
    POLAR = auto()
    POLAR_OFF = auto()
    ADDITIONAL_OFFSET = auto()
    ADDITIONAL_OFFSET_110 = auto()
    SKIP_MOVE = auto()
    TURN_FINISH = auto()
    TURN_ROUGH = auto()
    FACE_ROUGH = auto()
    TURN_REPEAT = auto()
    FACE_PECK = auto()
    TURN_PECK = auto()
    THREAD_PASSES = auto()
    UNSUPPORTED = auto()
    NOTHING = auto()
    IGNORED = auto()
    CONTOUR_SHIFT = auto()
    CONTOUR_SHIFT_OFF = auto()
    PROGRAM_SHIFT = auto()
    PROGRAM_SHIFT_ADD = auto()
    PROGRAM_SHIFT_OFF = auto()
    PROGRAM_SHIFT_ADD_OFF = auto()
    WORKPIECE_POSITION = auto()
    WORKPIECE_POSITION_OFF = auto()
    POLE = auto()
    POLE_SCALING = auto()
    POLE_SCALING_OFF = auto()
    EXTERNAL_OFFSET = auto()
    EXTERNAL_OFFSET_OFF = auto()
    EXTERNAL_TOOL = auto()
    EXTERNAL_TOOL_OFF = auto()
    GENERAL_TOOL = auto()
    GENERAL_TOOL_OFF = auto()
    SELECT_TABLES = auto()
    PLANE_BY_AXES = auto()
    PROBE_MOVE = auto()
    PROBE_IN_PASSING = auto()
    PROBE_FIXED_STOP = auto()
    LEFT_OUT = auto()


_BY_GROUP: dict[Group, tuple[Action, ...]] = {
    Group.MOTION: (
        Action.RAPID,
        Action.LINEAR,
        Action.ARC_CW,
        Action.ARC_CCW,
        Action.CUBIC_SPLINE,
        Action.QUADRATIC_SPLINE,
        Action.NURBS,
        Action.NURBS_END,
        Action.MOTION_OFF,
        Action.THREAD,
        Action.THREAD_CHANGING,
        Action.TURN_CYCLE,
        Action.THREAD_CYCLE,
        Action.FACE_CYCLE,
        Action.CYCLE_CHIP_BREAK,
        Action.CYCLE_FINE_BORE,
        Action.CYCLE_DRILL,
        Action.CYCLE_DWELL,
        Action.CYCLE_DEEP,
        Action.CYCLE_TAP,
        Action.CYCLE_TAP_LEFT,
        Action.CYCLE_BORE,
        Action.CYCLE_BORE_STOP,
        Action.CYCLE_BACK_BORE,
        Action.CYCLE_BACK_BORE_UP,
        Action.CYCLE_BORE_MANUAL,
        Action.CYCLE_BORE_DWELL,
    ),
    Group.CYCLE_CANCEL: (Action.CYCLE_CANCEL,),
    Group.NON_MODAL: (
        Action.REFERENCE_RETURN,
        Action.REFERENCE_POINT,
        Action.MACHINE_COORDINATES,
        Action.SET_POSITION,
        Action.CLEAR_SET_POSITION,
        Action.SET_DATA,
        Action.SET_WORK_ZERO,
        Action.LOCAL_COORDINATES,
        Action.SCALING,
        Action.SCALING_OFF,
        Action.MIRROR,
        Action.MIRROR_OFF,
        Action.SKIP_MOVE,
        Action.TURN_FINISH,
        Action.TURN_ROUGH,
        Action.FACE_ROUGH,
        Action.TURN_REPEAT,
        Action.FACE_PECK,
        Action.TURN_PECK,
        Action.THREAD_PASSES,
        Action.CONTOUR_SHIFT,
        Action.CONTOUR_SHIFT_OFF,
        Action.PROGRAM_SHIFT,
        Action.PROGRAM_SHIFT_ADD,
        Action.PROGRAM_SHIFT_OFF,
        Action.PROGRAM_SHIFT_ADD_OFF,
        Action.WORKPIECE_POSITION,
        Action.WORKPIECE_POSITION_OFF,
        Action.POLE,
        Action.POLE_SCALING,
        Action.POLE_SCALING_OFF,
        Action.EXTERNAL_OFFSET,
        Action.EXTERNAL_OFFSET_OFF,
        Action.EXTERNAL_TOOL,
        Action.EXTERNAL_TOOL_OFF,
        Action.GENERAL_TOOL,
        Action.GENERAL_TOOL_OFF,
        Action.SELECT_TABLES,
        Action.PLANE_BY_AXES,
        Action.PROBE_MOVE,
        Action.PROBE_IN_PASSING,
        Action.PROBE_FIXED_STOP,
    ),
    Group.ROTATION: (Action.ROTATION, Action.ROTATION_OFF),
    Group.POLAR: (Action.POLAR, Action.POLAR_OFF),
    Group.DWELL: (Action.DWELL,),
    Group.PLANE: (Action.PLANE_XY, Action.PLANE_ZX, Action.PLANE_YZ),
    Group.UNITS: (Action.INCH, Action.METRIC),
    Group.DISTANCE: (Action.ABSOLUTE, Action.INCREMENTAL),
    Group.ARC_DISTANCE: (Action.ARC_CENTER_ABSOLUTE, Action.ARC_CENTER_INCREMENTAL),
    Group.FEED_MODE: (Action.FEED_INVERSE_TIME, Action.FEED_PER_MINUTE, Action.FEED_PER_REVOLUTION),
    Group.SPINDLE_MODE: (Action.CONSTANT_SURFACE_SPEED, Action.SPINDLE_RPM),
    Group.RADIUS_COMPENSATION: (Action.COMP_OFF, Action.COMP_LEFT, Action.COMP_RIGHT),
    Group.LENGTH_COMPENSATION: (Action.LENGTH_PLUS, Action.LENGTH_MINUS, Action.LENGTH_OFF),
    Group.WORK_OFFSET: (
        Action.WORK_OFFSET,
        Action.WORK_OFFSET_OFF,
        Action.ADDITIONAL_OFFSET,
        Action.ADDITIONAL_OFFSET_110,
    ),
    Group.STOPPING: (Action.EXACT_STOP, Action.EXACT_PATH, Action.CONTINUOUS),
    Group.EXACT_STOP_BLOCK: (Action.EXACT_STOP_BLOCK,),
    Group.RETRACT: (Action.RETRACT_INITIAL, Action.RETRACT_R),
    Group.IGNORED: (Action.IGNORED, Action.NOTHING, Action.UNSUPPORTED, Action.LEFT_OUT),
}

GROUP_OF: dict[Action, Group] = {action: group for group, actions in _BY_GROUP.items() for action in actions}
"""The modal group of every action."""


class MAction(Enum):
    """What an M code does; the value tells its modal group."""

    PROGRAM_STOP = ("program_stop", "stop")
    OPTIONAL_STOP = ("optional_stop", "stop")
    PROGRAM_END = ("program_end", "stop")
    SPINDLE_CW = ("spindle_cw", "spindle")
    SPINDLE_CCW = ("spindle_ccw", "spindle")
    SPINDLE_STOP = ("spindle_stop", "spindle")
    SPINDLE_ORIENT = ("spindle_orient", "")
    TOOL_CHANGE = ("tool_change", "tool")
    COOLANT_MIST = ("coolant_mist", "")
    COOLANT_FLOOD = ("coolant_flood", "")
    COOLANT_OFF = ("coolant_off", "")
    SUB_CALL = ("sub_call", "stop")
    SUB_RETURN = ("sub_return", "stop")
    RIGID_TAP = ("rigid_tap", "")
    AUXILIARY = ("auxiliary", "")
    UNSUPPORTED = ("unsupported", "")
    LEFT_OUT = ("left_out", "")

    @property
    def group(self) -> str:
        """The modal group; empty if any number may stand in a block."""
        return self.value[1]

    @property
    def title(self) -> str:
        """The name in dialect files."""
        return self.value[0]


M_ACTIONS: dict[str, MAction] = {action.title: action for action in MAction}
"""M actions by their name in dialect files."""
