"""What readings are made of: a status, what is fixed about a machine, and which channel or axis is meant."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from polycnc.cnc import AxisStatus, ChannelStatus, Control, Mode, Motion, RunState, Status

OPERATION_MODES = ("Manual", "MDA", "Automatic")
CHANNEL_STATES = ("Active", "Interrupted", "Reset")
PROGRAM_STATES = ("Stopped", "Running", "Waiting", "Interrupted", "Canceled")
AXIS_STATES = ("InPosition", "Moving", "Parked")
SPINDLE_STATES = ("Stopped", "InTargetArea", "Accelerating", "Decelerating", "Parked")
TURNS = ("None", "CW", "CCW")
MACHINE_MODES = ("Manual", "Automatic", "Setup", "AutoWithManualIntervention", "Service", "Other")
CHANNEL_MODES = (
    "Automatic", "MdaMdi", "JogManual", "JogIncrement", "TeachingHandle", "Remote", "Reference", "Other",
)  # fmt: skip
PRODUCTION_STATES = ("Initializing", "Running", "Ended", "Interrupted", "Aborted")

_OPERATION = {Mode.AUTO: "Automatic", Mode.EDIT: "Automatic", Mode.MDI: "MDA"}
_MACHINE = {Mode.AUTO: "Automatic", Mode.EDIT: "Automatic", Mode.MDI: "AutoWithManualIntervention"}
_CHANNEL = {
    Mode.AUTO: "Automatic", Mode.MDI: "MdaMdi", Mode.JOG: "JogManual", Mode.INC: "JogIncrement",
    Mode.HANDLE: "JogIncrement", Mode.REF: "Reference", Mode.EDIT: "Other",
}  # fmt: skip
_PROGRAM = {
    RunState.ACTIVE: "Running", RunState.HOLD: "Interrupted", RunState.RESET: "Canceled", RunState.ALARM: "Canceled",
}  # fmt: skip
_PRODUCTION = {
    RunState.READY: "Initializing", RunState.ACTIVE: "Running", RunState.COMPLETED: "Ended",
    RunState.RESET: "Aborted", RunState.ALARM: "Aborted",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Fixed:
    """What of a machine does not change while it is served; ranges by what has them: an axis, "feed", "spindle"."""

    name: str
    serial_number: str
    units: Mapping[str, str]
    spans: Mapping[str, tuple[float, float]]
    channels: tuple[tuple[str, ...], ...]
    dry_run_mm_min: float
    nodes: Mapping[str, object] = field(default_factory=dict)
    """Nodes that values name: `channel 0` and so on, and the states of the active program."""

    @classmethod
    def of(cls, name: str, control: Control, nodes: Mapping[str, object]) -> Fixed:
        """Read it from a control."""
        inventory = control.inventory()
        config, data = control.machine.config, control.data
        low_high = {
            each.name: (
                -1e6 if each.low is None else each.low,
                1e6 if each.high is None else each.high,
            )
            for each in inventory.axes
        }
        fastest = max((each.most_speed for each in inventory.axes), default=0.0) * 60.0
        spans = {
            **{f"axis {axis}": span for axis, span in low_high.items()},
            "feed": (0.0, fastest),
            "spindle": (0.0, config.spindle.max_rpm),
            "feed override": (0.0, 100.0 * data.most_feed_override),
            "rapid override": (0.0, 100.0 * max(data.rapid_overrides)),
            "spindle override": (100.0 * data.spindle_overrides[0], 100.0 * data.spindle_overrides[1]),
        }
        return cls(
            name,
            inventory.identity.serial_number,
            {each.name: each.unit for each in inventory.axes},
            spans,
            tuple(each.axes for each in control.status().channels),
            data.dry_run_mm_min,
            nodes,
        )


@dataclass(frozen=True, slots=True)
class At:
    """A status, and the channel or axis that a reading is about."""

    status: Status
    fixed: Fixed
    number: int = 0
    name: str = ""

    @property
    def channel(self) -> ChannelStatus:
        """The channel."""
        return self.status.channels[self.number]

    @property
    def axis(self) -> AxisStatus | None:
        """The axis; None if the machine has none of this name."""
        return self.status.axes.get(self.name)

    # ------------------------------------------------------------------ words of the enumerations

    @property
    def operation_mode(self) -> int:
        """The operation mode of the channel (OPC 40502); programs are edited beside Automatic."""
        return OPERATION_MODES.index(_OPERATION.get(self.channel.mode, "Manual"))

    @property
    def channel_state(self) -> int:
        """The state of the channel; after an alarm it is interrupted until a reset."""
        channel = self.channel
        if channel.interrupted or channel.run_state is RunState.ALARM:
            return CHANNEL_STATES.index("Interrupted")
        busy = channel.active or channel.motion is not Motion.NONE
        return CHANNEL_STATES.index("Active" if busy else "Reset")

    @property
    def program_state(self) -> int:
        """The state of the program."""
        channel = self.channel
        if channel.run_state is RunState.ACTIVE and channel.starved:
            return PROGRAM_STATES.index("Waiting")
        return PROGRAM_STATES.index(
            "Running" if channel.active else _PROGRAM.get(channel.run_state, "Stopped")
        )

    @property
    def machine_mode(self) -> int:
        """The operation mode of the machine (OPC 40501-1)."""
        return MACHINE_MODES.index(_MACHINE.get(self.status.mode, "Manual"))

    @property
    def channel_mode(self) -> int:
        """The mode of the channel (OPC 40501-1)."""
        return CHANNEL_MODES.index(_CHANNEL[self.channel.mode])

    @property
    def production_state(self) -> int:
        """The state of the active program (OPC 40501-1)."""
        channel = self.channel
        if channel.active:
            return PRODUCTION_STATES.index("Running")
        return PRODUCTION_STATES.index(_PRODUCTION.get(channel.run_state, "Interrupted"))

    @property
    def spindle_state(self) -> int:
        """What the spindle does (OPC 40502)."""
        spindle = self.status.spindle
        if spindle.actual_rpm == 0.0 and spindle.commanded_rpm == 0.0:
            return SPINDLE_STATES.index("Stopped")
        if spindle.reached:
            return SPINDLE_STATES.index("InTargetArea")
        slower = abs(spindle.actual_rpm) > abs(spindle.commanded_rpm)
        return SPINDLE_STATES.index("Decelerating" if slower else "Accelerating")

    @property
    def turn(self) -> int:
        """The direction in which the spindle turns."""
        rpm = self.status.spindle.actual_rpm
        return TURNS.index("None" if rpm == 0.0 else "CW" if rpm > 0.0 else "CCW")
