"""What readings are made of: the facts of a plant, what is fixed about a machine, which channel or axis is meant."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from polycnc.cnc import Control, Mode
from polycnc.servers.plant import FACTS, Scope, Seen

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
TOOL_MANAGEMENT = ("NumberBased", "GroupBased", "Other")
TOOL_LOCKED = ("CapabilityUnavailable", "ByOperator", "ToolBreak", "ToolLife", "MeasurementError", "Other")
PRODUCTION_STATES = ("Initializing", "Running", "Ended", "Interrupted", "Aborted")

_OPERATION = {Mode.AUTO: "Automatic", Mode.EDIT: "Automatic", Mode.MDI: "MDA"}
_MACHINE = {Mode.AUTO: "Automatic", Mode.EDIT: "Automatic", Mode.MDI: "AutoWithManualIntervention"}
_CHANNEL = {
    Mode.AUTO: "Automatic", Mode.MDI: "MdaMdi", Mode.JOG: "JogManual", Mode.INC: "JogIncrement",
    Mode.HANDLE: "JogIncrement", Mode.REF: "Reference", Mode.EDIT: "Other",
}  # fmt: skip


def operation_mode(mode: Any) -> int:
    """Return the operation mode of a channel (OPC 40502); programs are edited beside Automatic."""
    return OPERATION_MODES.index(_OPERATION.get(mode, "Manual"))


def machine_mode(mode: Any) -> int:
    """Return the operation mode of a machine (OPC 40501-1)."""
    return MACHINE_MODES.index(_MACHINE.get(mode, "Manual"))


def channel_mode(mode: Any) -> int:
    """Return the mode of a channel (OPC 40501-1)."""
    return CHANNEL_MODES.index(_CHANNEL[mode])


def word_of(words: Sequence[str]) -> Callable[[Any], int]:
    """Return what finds a word of a fact (`in target area`) among those of OPC UA (`InTargetArea`), by its number."""
    numbers = {word.lower(): number for number, word in enumerate(words)}
    return lambda value: numbers[value.replace(" ", "")]


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
    """Nodes that values name: `channel 0` and so on, `job`, `none`, and states as `program Running`, `job Running`."""

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
    """A machine at one cycle, and the channel or axis that a reading is about."""

    seen: Seen
    fixed: Fixed
    number: int = 0
    name: str = ""
    versions: Mapping[str, int] = field(default_factory=dict)
    """How often each list has changed that objects come to and go from, by its path."""

    def read(self, fact: str) -> Any:
        """Return the value of a fact; None of an axis that the machine does not have."""
        row, status = FACTS[fact], self.seen.status
        if row.scope is Scope.AXIS:
            axis = status.axes.get(self.name)
            return None if axis is None else row.read(self.seen, axis)
        return row.read(self.seen, status.channels[self.number] if row.scope is Scope.CHANNEL else None)


@dataclass(frozen=True, slots=True)
class Of:
    """A reading: the value of a fact, of which `turn` makes one of OPC UA; `otherwise` where there is none."""

    fact: str
    turn: Callable[[Any], Any] = lambda value: value
    otherwise: Any = None
    axis: str = ""

    def __call__(self, at: At) -> Any:
        value = (At(at.seen, at.fixed, at.number, self.axis) if self.axis else at).read(self.fact)
        return self.otherwise if value is None else self.turn(value)


@dataclass(frozen=True, slots=True)
class Several:
    """A reading of several facts as one value; None if one of them has none."""

    facts: tuple[str, ...]
    join: Callable[..., Any] = lambda *values: values
    axis: str = ""

    def __call__(self, at: At) -> Any:
        of = At(at.seen, at.fixed, at.number, self.axis) if self.axis else at
        values = tuple(map(of.read, self.facts))
        return None if None in values else self.join(*values)
