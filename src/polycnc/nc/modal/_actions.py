"""What G and M codes can do, whatever number a dialect gives them, and which of them exclude each other."""

from __future__ import annotations

from enum import Enum, IntEnum, StrEnum

from polycnc.nc.modal import _modal as modal


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
    DIAMETERS = "diameters"
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


class Family(StrEnum):
    """Codes of one group that are carried out in one way: the modes of motion, and functions of their own block."""

    MOVE = "move"
    SPLINE = "spline"
    CURVE = "curve"
    DRILLING = "drilling"
    TURNING = "turning"
    TURNING_CYCLE = "turning cycle"
    CONTOUR_CYCLE = "contour cycle"
    PROFILE = "profile"
    FRAME = "frame"
    PLACING = "placing"
    PATH = "path"

    @property
    def group(self) -> Group:
        """The modal group of its codes."""
        return Group.MOTION if self in _MODES_OF_MOTION else Group.NON_MODAL


_MODES_OF_MOTION = (Family.MOVE, Family.SPLINE, Family.CURVE, Family.DRILLING, Family.TURNING)


class Action(IntEnum):
    """What a G code does: one row for each, and its only one.

    A row is the modal group or the family, the words that the code takes ("axes" are the channel's axis words, "time"
    the addresses of a dwell), a sentence, and the value of its group in the modal state where one number tells it.
    Numbers are private to this process; names stand in dialect files.
    """

    group: Group
    family: Family | None
    takes: tuple[str, ...]
    sentence: str
    sets: int | None

    def __new__(cls, kind: Group | Family, takes: str, sentence: str, sets: int | None = None) -> Action:
        """Make the member of a row; members are numbered from 1."""
        member = int.__new__(cls, len(cls.__members__) + 1)
        member._value_ = int(member)
        member.group, member.family = (kind.group, kind) if isinstance(kind, Family) else (kind, None)
        member.takes, member.sentence, member.sets = tuple(takes.split()), sentence, sets
        return member

    # fmt: off
    RAPID = Family.MOVE, "axes", "Straight to a point as fast as the axes can", modal.MOTION_RAPID
    LINEAR = Family.MOVE, "axes R C", "Straight at feed; R or C rounds or chamfers the corner", modal.MOTION_LINEAR
    ARC_CW = Family.MOVE, "axes I J K R P", "Clockwise arc or helix by centre or radius", modal.MOTION_ARC_CW
    ARC_CCW = Family.MOVE, "axes I J K R P", "The same counter-clockwise", modal.MOTION_ARC_CCW
    CUBIC_SPLINE = Family.SPLINE, "axes I J P Q", "Cubic spline by its two inner control points", modal.MOTION_CUBIC
    QUADRATIC_SPLINE = Family.SPLINE, "axes I J", "Quadratic spline by its inner control point", modal.MOTION_QUADRATIC
    NURBS = Family.CURVE, "axes P L", "Begin a curve by weighted control points, or add one", modal.MOTION_NURBS
    NURBS_END = Family.CURVE, "", "End the curve and follow it", modal.MOTION_NURBS
    MOTION_OFF = Family.MOVE, "", "No motion in force: axis words alone are an error", modal.MOTION_NONE
    THREAD = Family.TURNING, "axes", "Thread with the lead F"
    THREAD_CHANGING = Family.TURNING, "axes K", "Thread whose lead changes by K with each turn"
    SYNCHRONIZED = Family.TURNING, "axes K", "Straight, by K with each turn of the spindle"
    TAP_AND_BACK = Family.TURNING, "axes K", "The same and back, with the spindle turning the other way"
    THREADING = Family.TURNING, "axes P I J K R Q H E L", "Cut a thread in several passes down to K"
    TURN_CYCLE = Family.TURNING, "axes R", "Turning in one cut and back; R is the taper"
    THREAD_CYCLE = Family.TURNING, "axes R", "Threading in one cut and back"
    FACE_CYCLE = Family.TURNING, "axes R", "Facing in one cut and back"
    DWELL = Group.DWELL, "time", "Wait"
    EXACT_STOP_BLOCK = Group.EXACT_STOP_BLOCK, "", "Come to rest at the end of this block"
    PLANE_XY = Group.PLANE, "", "Working plane X Y", modal.PLANE_XY
    PLANE_ZX = Group.PLANE, "", "Working plane Z X", modal.PLANE_ZX
    PLANE_YZ = Group.PLANE, "", "Working plane Y Z", modal.PLANE_YZ
    INCH = Group.UNITS, "", "Lengths and feeds are inches", 1
    METRIC = Group.UNITS, "", "Lengths and feeds are millimetres", 0
    DIAMETERS = Group.DIAMETERS, "", "X is a diameter"
    RADII = Group.DIAMETERS, "", "X is a radius"
    REFERENCE_RETURN = Family.PATH, "axes", "Go to the reference position through a point"
    REFERENCE_POINT = Family.PATH, "axes P", "The same to reference position P, 2 without it"
    KEEP_REFERENCE = Family.PATH, "", "Make the present position the reference position"
    KEEP_REFERENCE_POINT = Family.PATH, "", "Make it the second reference position"
    COMP_OFF = Group.RADIUS_COMPENSATION, "D", "Radius compensation off", 0
    COMP_LEFT = Group.RADIUS_COMPENSATION, "D", "Tool left of the path by its radius", 1
    COMP_RIGHT = Group.RADIUS_COMPENSATION, "D", "Tool right of the path by its radius", -1
    COMP_LEFT_DIAMETER = Group.RADIUS_COMPENSATION, "D L", "Tool left of the path by half of D; L places its tip", 1
    COMP_RIGHT_DIAMETER = Group.RADIUS_COMPENSATION, "D L", "The same on the right", -1
    LENGTH_PLUS = Group.LENGTH_COMPENSATION, "H", "Add the length of tool H", 1
    LENGTH_MINUS = Group.LENGTH_COMPENSATION, "H", "Subtract the length of tool H", -1
    LENGTH_OFF = Group.LENGTH_COMPENSATION, "H", "Length compensation off", 0
    TOOL_OFFSET = Group.LENGTH_COMPENSATION, "H", "Shift axes by the offsets of tool H, or of the present one", 1
    TOOL_OFFSET_VALUES = Group.LENGTH_COMPENSATION, "axes", "Shift these axes as if by a tool", 1
    TOOL_OFFSET_ADD = Group.LENGTH_COMPENSATION, "H", "Add the offsets of tool H to those in force", 1
    MACHINE_COORDINATES = Family.PATH, "axes", "A straight move of this block is in machine coordinates"
    WORK_OFFSET = Group.WORK_OFFSET, "", "Select the work offset of this code"
    WORK_OFFSET_OFF = Group.WORK_OFFSET, "", "Leave the work offset of this group"
    EXACT_STOP = Group.STOPPING, "", "Come to rest at the end of every block"
    EXACT_PATH = Group.STOPPING, "", "Follow the path exactly; rest only in corners"
    CONTINUOUS = Group.STOPPING, "P Q", "Go through corners: rounded by up to P, lines merged within Q"
    ABSOLUTE = Group.DISTANCE, "", "Axis words are positions", 1
    INCREMENTAL = Group.DISTANCE, "", "Axis words are ways", 0
    ARC_CENTER_ABSOLUTE = Group.ARC_DISTANCE, "", "I J K are the position of an arc's centre", 1
    ARC_CENTER_INCREMENTAL = Group.ARC_DISTANCE, "", "I J K are ways from an arc's start to its centre", 0
    SET_POSITION = Family.PATH, "axes S", "Make the present position read these values; S clamps the spindle"
    CLEAR_SET_POSITION = Family.PATH, "", "Cancel that shift"
    SUSPEND_POSITION = Family.PATH, "", "Suspend that shift, and keep it"
    RESUME_POSITION = Family.PATH, "", "Put a shift that was kept in force again"
    SET_SHIFT = Family.PATH, "axes", "Make the shift of these axes what the words say"
    FEED_INVERSE_TIME = Group.FEED_MODE, "", "1/F minutes for each block", modal.FEED_INVERSE_TIME
    FEED_PER_MINUTE = Group.FEED_MODE, "", "F is a way per minute", modal.FEED_PER_MINUTE
    FEED_PER_REVOLUTION = Group.FEED_MODE, "", "F is a way per revolution of the spindle", modal.FEED_PER_REVOLUTION
    CONSTANT_SURFACE_SPEED = Group.SPINDLE_MODE, "S", "S is a cutting speed", 1
    SPINDLE_RPM = Group.SPINDLE_MODE, "S", "S is a number of revolutions per minute", 0
    CYCLE_CANCEL = Group.CYCLE_CANCEL, "", "Drilling cycle off"
    CYCLE_CHIP_BREAK = Family.DRILLING, "axes R P Q L K", "Drill, breaking the chip every Q"
    CYCLE_FINE_BORE = Family.DRILLING, "axes R P Q I J L K", "Bore, orient, shift and retract"
    CYCLE_DRILL = Family.DRILLING, "axes R P Q L K", "Drill"
    CYCLE_DWELL = Family.DRILLING, "axes R P Q L K", "Drill with a dwell P at the bottom"
    CYCLE_DEEP = Family.DRILLING, "axes R P Q L K", "Drill, retracting every Q"
    CYCLE_TAP = Family.DRILLING, "axes R P Q L K", "Tap a right-hand thread"
    CYCLE_TAP_LEFT = Family.DRILLING, "axes R P Q L K", "Tap a left-hand thread"
    CYCLE_BORE = Family.DRILLING, "axes R P Q L K", "Bore, retract at feed"
    CYCLE_BORE_STOP = Family.DRILLING, "axes R P Q L K", "Bore, stop the spindle, retract at rapid"
    CYCLE_BACK_BORE = Family.DRILLING, "axes R P Q I J L K", "Bore from below, up to level K"
    CYCLE_BACK_BORE_UP = Family.DRILLING, "axes R P Q I J L K", "Bore from R up to Z"
    CYCLE_BORE_MANUAL = Family.DRILLING, "axes R P Q L K", "Bore, stop, retract by hand"
    CYCLE_BORE_DWELL = Family.DRILLING, "axes R P Q L K", "Bore with a dwell, retract at feed"
    RETRACT_INITIAL = Group.RETRACT, "", "Cycles retract to where the first one began", 1
    RETRACT_R = Group.RETRACT, "", "Cycles retract to level R", 0
    SET_DATA = Family.FRAME, "axes L P Q R C", "Set work offsets (L2, L20) and tool offsets (L10 to L13)"
    SET_WORK_ZERO = Family.FRAME, "axes L P", "Set G54 to G59 by value (L2) or by position (L20)"
    SET_TABLES = Family.FRAME, "axes L P R Q", "Set work offsets (L2, L20; R turns) and tools (L1, L10, L11)"
    LOCAL_COORDINATES = Family.FRAME, "axes", "Shift every work coordinate system"
    SCALING = Family.FRAME, "axes P I J K", "Scale about a point, by P or by I J K"
    SCALING_OFF = Family.FRAME, "", "Scaling off"
    MIRROR = Family.FRAME, "axes", "Mirror these axes about these positions"
    MIRROR_OFF = Family.FRAME, "axes", "Mirroring of these axes off, of all without any"
    ROTATION = Group.ROTATION, "axes R", "Turn the plane about a point by the angle R"
    ROTATION_OFF = Group.ROTATION, "", "Rotation off"
    POLAR = Group.POLAR, "", "The words of the plane are radius and angle"
    POLAR_OFF = Group.POLAR, "", "Polar coordinates off"
    ADDITIONAL_OFFSET = Group.WORK_OFFSET, "P", "Select additional work offset P"
    ADDITIONAL_OFFSET_110 = Group.WORK_OFFSET, "", "Select additional work offset 1 by G110, 2 by G111 and so on"
    POCKET_CW = Family.PATH, "axes I K Q D L", "Mill a circular pocket from its centre, clockwise"
    POCKET_CCW = Family.PATH, "axes I K Q D L", "Mill a circular pocket from its centre, counter-clockwise"
    SKIP_MOVE = Family.PATH, "axes", "Straight at feed until the skip signal comes"
    TURN_FINISH = Family.CONTOUR_CYCLE, "P Q", "Finish the contour of blocks P to Q"
    TURN_ROUGH = Family.CONTOUR_CYCLE, "P Q U W R D", "Rough the contour along Z"
    FACE_ROUGH = Family.CONTOUR_CYCLE, "P Q U W R D", "Rough the contour along X"
    TURN_REPEAT = Family.CONTOUR_CYCLE, "P Q U W R", "Repeat the contour, closer each time"
    FACE_PECK = Family.TURNING_CYCLE, "axes P Q R I K D", "Peck along Z, also grooves on a face"
    TURN_PECK = Family.TURNING_CYCLE, "axes P Q R I K D", "Peck along X: grooves, parting off"
    THREAD_PASSES = Family.TURNING_CYCLE, "axes P Q R K D I A", "Cut a thread in several passes"
    UNSUPPORTED = Group.IGNORED, "", "Refused: not supported yet"
    NOTHING = Group.IGNORED, "P Q", "A cancel that has nothing to cancel"
    IGNORED = Group.IGNORED, "", "Reported once, changes nothing"
    CONTOUR_SHIFT = Family.PLACING, "axes", "Shift of the contour"
    CONTOUR_SHIFT_OFF = Family.PLACING, "", "That shift off"
    PROGRAM_SHIFT = Family.PLACING, "axes", "Shift of program zero"
    PROGRAM_SHIFT_ADD = Family.PLACING, "axes", "Further shift of program zero"
    PROGRAM_SHIFT_OFF = Family.PLACING, "", "Both shifts of program zero off"
    PROGRAM_SHIFT_ADD_OFF = Family.PLACING, "", "The further shift off"
    WORKPIECE_POSITION = Family.PLACING, "axes R", "Where the workpiece lies, and how it is turned"
    WORKPIECE_POSITION_OFF = Family.PLACING, "", "The workpiece lies at zero"
    POLE = Family.PLACING, "axes", "The pole that scaling and rotation are about"
    POLE_SCALING = Family.PLACING, "axes R", "Scale axes about the pole, turn the plane by R"
    POLE_SCALING_OFF = Family.PLACING, "", "Pole, scaling and rotation off"
    EXTERNAL_OFFSET = Family.PLACING, "", "Add the external work offset of this code"
    EXTERNAL_OFFSET_OFF = Family.PLACING, "", "External work offsets off"
    EXTERNAL_TOOL = Family.PLACING, "", "Add the external tool data of this code"
    EXTERNAL_TOOL_OFF = Family.PLACING, "", "External tool data off"
    GENERAL_TOOL = Family.PLACING, "", "Add the general tool data of this code"
    GENERAL_TOOL_OFF = Family.PLACING, "", "General tool data off"
    SELECT_TABLES = Family.PLACING, "K V", "Select tables of tools (K) and work offsets (V)"
    PLANE_BY_AXES = Family.PLACING, "axes", "Working plane by two axes, main axis first"
    PROBE_MOVE = Family.PATH, "axes", "Straight at feed until the probe switches"
    PROBE_CONTACT = Family.PATH, "axes", "The same; refused without a contact, or one from the beginning"
    PROBE_TOWARDS = Family.PATH, "axes", "The same, but without a contact the program goes on"
    PROBE_LEAVE = Family.PATH, "axes", "Straight at feed until the probe is free; refused where it does not come free"
    PROBE_AWAY = Family.PATH, "axes", "The same, but the program goes on where it does not come free"
    PROBE_IN_PASSING = Family.PATH, "axes", "Measure one axis in passing"
    PROBE_FIXED_STOP = Family.PATH, "axes", "Straight at feed up to a fixed stop"
    LEFT_OUT = Group.IGNORED, "", "As if it were not there"
    PROFILE_FINISH = Family.PROFILE, "X Z Q D E P", "Finish the profile of sub-program Q"
    PROFILE_ROUGH = Family.PROFILE, "X Z Q D I R U W", "Rough the profile of sub-program Q along Z"
    PROFILE_FACE = Family.PROFILE, "X Z Q D I R U W", "The same along X"
    # fmt: on

    @property
    def title(self) -> str:
        """The name in dialect files."""
        return self.name.lower()


IN_FORCE = {(action.group, action.sets): action for action in reversed(Action) if action.sets is not None}
"""The action that tells a value of its group in the modal state."""


def of_family(*families: Family) -> frozenset[Action]:
    """Return the actions of these families."""
    return frozenset(action for action in Action if action.family in families)


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
    AUXILIARY_WORDS = ("auxiliary_words", "")
    OUTPUT_IN_STEP = ("output_in_step", "")
    OUTPUT_AT_ONCE = ("output_at_once", "")
    SET_TOOL = ("set_tool", "tool")
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


SPINDLE_SENSES = {MAction.SPINDLE_CW: 1, MAction.SPINDLE_CCW: -1, MAction.SPINDLE_STOP: 0}
"""Which way M codes let the spindle turn, 1 clockwise."""

NO_SENSE, COOLANT_ON, COOLANT_OFF, OUTPUT_BIT, OUTPUT_VALUE = 2, 3, 4, 5, 6
OUTPUT_SENSES = {"P!": OUTPUT_BIT, "E!Q!": OUTPUT_VALUE}
"""What an output in step with motion is by the words that it takes: P a bit, E with the value Q."""
M_SENSES = {
    **SPINDLE_SENSES,
    MAction.COOLANT_MIST: COOLANT_ON,
    MAction.COOLANT_FLOOD: COOLANT_ON,
    MAction.COOLANT_OFF: COOLANT_OFF,
}
"""What M codes do that blocks of a compiled run may say: turn the spindle or switch coolant; others are NO_SENSE."""


def sense_of(action: MAction, takes: str) -> int:
    """Return what an M code does that takes these words, see `M_SENSES` and `OUTPUT_SENSES`."""
    if action is MAction.OUTPUT_IN_STEP:
        return OUTPUT_SENSES.get(takes, NO_SENSE)
    return M_SENSES.get(action, NO_SENSE)


def coolant_with(coolant: tuple[int, ...], code: int, sense: int) -> tuple[int, ...]:
    """Return the codes of the coolant that is on after an M code that switches coolant."""
    if sense == COOLANT_OFF:
        return ()
    return (*(other for other in coolant if other != code), code)


M_ACTIONS: dict[str, MAction] = {action.title: action for action in MAction}
"""M actions by their name in dialect files."""
