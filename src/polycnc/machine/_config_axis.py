"""What an axis is. Its keys carry a unit (`vmax_mm_s`, `vmax_deg_s`), its properties do not (`axis.vmax`).

The code that uses an axis reads the properties, so that nothing else branches on the kind of an axis.
"""

from __future__ import annotations

import math
import re
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, model_validator

from polycnc.machine._bounds import LARGEST_POSITION, LEAST_RATE, MOST_RATE
from polycnc.machine._toml import StrictModel, problem

AXIS_NAME = re.compile(r"[ABCPQRUVWXYZ][0-9]{0,2}")


def _pair(value: object) -> object:
    if isinstance(value, tuple) and len(value) != 2:
        raise problem("a range needs exactly two numbers", hint="write [low, high]")
    return value


def _ordered(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] >= value[1]:
        raise problem(
            f"the range [{value[0]}, {value[1]}] is empty", hint="write [low, high] with low < high"
        )
    return value


def _axis_name(value: str) -> str:
    if not AXIS_NAME.fullmatch(value):
        raise problem(
            f"'{value}' is not an axis name",
            hint="use one of A B C P Q R U V W X Y Z, or such a letter and a number",
        )
    return value


Positive: TypeAlias = Annotated[float, Field(gt=0)]
NotNegative: TypeAlias = Annotated[float, Field(ge=0)]
Rate: TypeAlias = Annotated[float, Field(ge=LEAST_RATE, le=MOST_RATE)]
"""A speed or an acceleration: what moves at all arrives some day (`_bounds`)."""
Jump: TypeAlias = Annotated[float, Field(ge=0, le=MOST_RATE)]
Position: TypeAlias = Annotated[float, Field(ge=-LARGEST_POSITION, le=LARGEST_POSITION)]
Share: TypeAlias = Annotated[float, Field(ge=0, le=1)]
Limits: TypeAlias = Annotated[tuple[float, float], BeforeValidator(_pair), AfterValidator(_ordered)]
AxisName: TypeAlias = Annotated[str, AfterValidator(_axis_name)]
References: TypeAlias = Annotated[tuple[Position, ...], Field(max_length=3)]
Unit: TypeAlias = Literal["mm", "deg"]

_ENDLESS = (-math.inf, math.inf)


class _InUnit(StrictModel):
    """A table of an axis whose keys carry the axis's unit."""

    unit: ClassVar[Unit] = "mm"

    @model_validator(mode="before")
    @classmethod
    def _right_unit(cls, data: Any) -> Any:
        other, kind = ("deg", "rotary") if cls.unit == "mm" else ("mm", "linear")
        own_kind = "linear" if cls.unit == "mm" else "rotary"
        for key in data if isinstance(data, dict) else ():
            fitting = re.sub(rf"_{other}(?=_|$)", f"_{cls.unit}", str(key))
            if fitting != key and fitting in cls.model_fields:
                raise problem(
                    f"'{key}' is for a {kind} axis, and this axis is {own_kind}",
                    hint=f"write '{fitting}', or give the axis kind = \"{kind}\"",
                    at=(key,),
                )
        return data

    def _value(self, name: str, per: str = "") -> Any:
        return getattr(self, f"{name}_{self.unit}{per}")


class ServoConfig(_InUnit):
    """Describe the position loop of an axis and the drive behind it.

    The loop turns the position error into a speed command; the drive follows it as a first-order lag.
    """

    kind: Literal["ideal", "pidf"] = Field(
        default="ideal",
        description='"ideal": the actual position is the setpoint; "pidf": the loop is simulated.',
    )
    kp: NotNegative = Field(
        default=0.0, description="Proportional gain: speed command per position error, 1/s."
    )
    ki: NotNegative = Field(default=0.0, description="Integral gain, 1/s²; 0 switches the term off.")
    kd: NotNegative = Field(
        default=0.0, description="Differential gain, without unit; 0 switches the term off."
    )
    kpl: Share = Field(
        default=0.0, description="Share of the loop's own delay of half a cycle that is taken away."
    )
    kfcv: NotNegative = Field(default=0.0, description="Speed feed-forward; 1 adds the whole setpoint speed.")
    kfca: NotNegative = Field(
        default=0.0, description="Acceleration feed-forward, s; the lag of the drive cancels it."
    )
    lag_s: NotNegative = Field(default=0.0, description="Time constant of the drive, s.")

    @model_validator(mode="after")
    def _gains_are_read(self) -> ServoConfig:
        if self.kind == "pidf" and self.kp == 0.0:
            raise problem('a servo of kind "pidf" needs a gain', hint="add a line 'kp = ...' greater than 0")
        fields = type(self).model_fields
        unread = [
            key for key, field in fields.items() if key != "kind" and getattr(self, key) != field.default
        ]
        if self.kind == "ideal" and unread:
            raise problem(
                f"'{unread[0]}' has no effect on an ideal servo",
                hint='add kind = "pidf" to this table, or remove the key',
                at=(unread[0],),
            )
        return self

    @property
    def in_position(self) -> float:
        """Return the largest position error that counts as arrived (mm or deg); inf if not watched."""
        value = self._value("in_position")
        return math.inf if value is None else float(value)

    @property
    def following_error_limit(self) -> float:
        """Return the position error that stops the machine (mm or deg); inf if not watched."""
        value = self._value("following_error_limit")
        return math.inf if value is None else float(value)


_IN_POSITION = "Largest position error that counts as arrived; absent: not watched."
_FOLLOWING = "Position error that stops the machine; absent: not watched."


class LinearServo(ServoConfig):
    """Servo of a linear axis."""

    in_position_mm: Positive | None = Field(default=None, description=_IN_POSITION)
    following_error_limit_mm: Positive | None = Field(default=None, description=_FOLLOWING)


class RotaryServo(ServoConfig):
    """Servo of a rotary axis."""

    unit: ClassVar[Unit] = "deg"
    in_position_deg: Positive | None = Field(default=None, description=_IN_POSITION)
    following_error_limit_deg: Positive | None = Field(default=None, description=_FOLLOWING)


class AxisConfig(_InUnit):
    """Describe one axis; `LinearAxis` and `RotaryAxis` are the two kinds.

    The properties are in `unit`: mm and mm/s, or deg and deg/s.
    """

    name: AxisName = Field(description="Name of the axis in programs; each name once.")

    @property
    def vmax(self) -> float:
        """Return the highest speed (unit/s)."""
        return float(self._value("vmax", "_s"))

    @property
    def amax(self) -> float:
        """Return the highest acceleration (unit/s²)."""
        return float(self._value("amax", "_s2"))

    @property
    def jump(self) -> float | None:
        """Return the speed step allowed at a junction (unit/s); None: what `amax` gives in one cycle."""
        value = self._value("jump", "_s")
        return None if value is None else float(value)

    @property
    def soft_limits(self) -> tuple[float, float]:
        """Return the travel programs may use, low and high; infinite where there is no limit."""
        return self._value("soft_limits") or _ENDLESS

    @property
    def limit_switches(self) -> tuple[float, float]:
        """Return where the limit switches trip, low and high; infinite where there are none."""
        return self._value("limit_switches") or _ENDLESS

    @property
    def home(self) -> float:
        """Return the home (reference) position."""
        return float(self._value("home"))

    @property
    def is_diameter(self) -> bool:
        """Return whether positions in programs are diameters."""
        return bool(getattr(self, "diameter", False))

    @property
    def reference_positions(self) -> tuple[float, ...]:
        """Return the second and further reference positions, as far as there are any."""
        return tuple(self._value("reference_positions"))

    def reference_position(self, number: int) -> float:
        """Return reference position `number`, from 1 (home); home stands for one that is not given."""
        others = self.reference_positions
        return others[number - 2] if 2 <= number < len(others) + 2 else self.home

    @property
    def resolution(self) -> float:
        """Return the step of the encoder; 0 is an ideal encoder."""
        return float(self._value("resolution"))

    @property
    def reference_switch(self) -> float | None:
        """Return where the reference switch trips, or None."""
        value = self._value("reference_switch")
        return None if value is None else float(value)

    @property
    def index_pulse(self) -> float | None:
        """Return where the encoder's index pulse is, or None."""
        value = self._value("index_pulse")
        return None if value is None else float(value)

    @property
    def backlash(self) -> float:
        """Return the lost motion on reversal."""
        return float(self._value("backlash"))


_TEXT = {
    "kind": '"linear": the axis moves straight, in mm; "rotary": it turns, in degree.',
    "vmax": "Highest speed; rapid moves use it.",
    "amax": "Highest acceleration and deceleration.",
    "jump": "Speed step allowed at a block junction; absent: what the acceleration gives in one cycle.",
    "soft_limits": "Travel that programs may use; absent: no limit.",
    "home": "Position of the axis when it is referenced.",
    "reference_positions": "Up to three more reference positions, from the second on.",
    "resolution": "Step of the encoder; 0 is an ideal encoder.",
    "limit_switches": "Where the limit switches trip; absent: none.",
    "reference_switch": "Where the reference switch trips; absent: none.",
    "index_pulse": "Where the encoder gives its index pulse; absent: none.",
    "backlash": "Play in the transmission: motion lost when the direction reverses.",
}


class LinearAxis(AxisConfig):
    """An axis that moves straight, in mm."""

    kind: Literal["linear"] = Field(default="linear", description=_TEXT["kind"])
    vmax_mm_s: Rate = Field(description=_TEXT["vmax"])
    amax_mm_s2: Rate = Field(description=_TEXT["amax"])
    jump_mm_s: Jump | None = Field(default=None, description=_TEXT["jump"])
    soft_limits_mm: Limits | None = Field(default=None, description=_TEXT["soft_limits"])
    home_mm: Position = Field(default=0.0, description=_TEXT["home"])
    reference_positions_mm: References = Field(default=(), description=_TEXT["reference_positions"])
    resolution_mm: NotNegative = Field(default=0.0, description=_TEXT["resolution"])
    limit_switches_mm: Limits | None = Field(default=None, description=_TEXT["limit_switches"])
    reference_switch_mm: float | None = Field(default=None, description=_TEXT["reference_switch"])
    index_pulse_mm: float | None = Field(default=None, description=_TEXT["index_pulse"])
    backlash_mm: NotNegative = Field(default=0.0, description=_TEXT["backlash"])
    servo: LinearServo = Field(default=LinearServo(), description="Position loop, see `[axis.servo]`.")

    modulo: ClassVar[bool] = False
    diameter: bool = Field(
        default=False,
        description="true: positions in programs are diameters; here and in results they are radii.",
    )


class RotaryAxis(AxisConfig):
    """An axis that turns, in degree."""

    unit: ClassVar[Unit] = "deg"
    kind: Literal["rotary"] = Field(default="rotary", description=_TEXT["kind"])
    vmax_deg_s: Rate = Field(description=_TEXT["vmax"])
    amax_deg_s2: Rate = Field(description=_TEXT["amax"])
    jump_deg_s: Jump | None = Field(default=None, description=_TEXT["jump"])
    modulo: bool = Field(default=False, description="true: positions repeat every 360 degree.")
    soft_limits_deg: Limits | None = Field(default=None, description=_TEXT["soft_limits"])
    home_deg: Position = Field(default=0.0, description=_TEXT["home"])
    reference_positions_deg: References = Field(default=(), description=_TEXT["reference_positions"])
    resolution_deg: NotNegative = Field(default=0.0, description=_TEXT["resolution"])
    limit_switches_deg: Limits | None = Field(default=None, description=_TEXT["limit_switches"])
    reference_switch_deg: float | None = Field(default=None, description=_TEXT["reference_switch"])
    index_pulse_deg: float | None = Field(default=None, description=_TEXT["index_pulse"])
    backlash_deg: NotNegative = Field(default=0.0, description=_TEXT["backlash"])
    carries: Literal["nothing", "part", "tool"] = Field(
        default="nothing",
        description='What the axis turns: "part" for a table, "tool" for a head; views and plots then show the path on '
        "the part, and a posted program is verified with these places. Tables are listed from the machine to the part, "
        "heads from the machine to the tool. A positive angle turns the tool by the right-hand rule on the part.",
    )
    center_mm: tuple[Position, Position, Position] = Field(
        default=(0.0, 0.0, 0.0),
        description="A point of the line that it turns about, with all angles at 0: of a table X, Y, Z of the machine, "
        "of a head as seen from the nose of the spindle, so that Z is the length of its pivot.",
    )
    direction: tuple[Position, Position, Position] | None = Field(
        default=None, description="The direction of that line; absent: A turns about X, B about Y, C about Z."
    )
    servo: RotaryServo = Field(default=RotaryServo(), description="Position loop, see `[axis.servo]`.")

    _ABOUT: ClassVar = {"A": (1.0, 0.0, 0.0), "B": (0.0, 1.0, 0.0), "C": (0.0, 0.0, 1.0)}

    @property
    def about(self) -> tuple[float, float, float]:
        """The direction of the line that an axis which carries something turns about."""
        return self.direction or self._ABOUT[self.name[0]]

    @model_validator(mode="after")
    def _turns_about_a_direction(self) -> RotaryAxis:
        if self.direction is not None and not any(self.direction):
            raise problem(
                "'direction' has no length", hint="write it like direction = [0, 1, 1]", at=("direction",)
            )
        if self.carries != "nothing" and self.direction is None and self.name[0] not in self._ABOUT:
            raise problem(
                f"nothing says what axis {self.name} turns about",
                hint="write its direction, like direction = [0, 1, 1]",
                at=("carries",),
            )
        return self

    @model_validator(mode="after")
    def _modulo_has_no_ends(self) -> RotaryAxis:
        for key in ("soft_limits_deg", "limit_switches_deg"):
            if self.modulo and getattr(self, key) is not None:
                raise problem(
                    f"'{key}' on an axis whose positions repeat",
                    hint=f"remove '{key}' or modulo = true",
                    at=(key,),
                )
        return self


def _kind_of_axis(value: Any) -> str:
    return str(value.get("kind", "linear") if isinstance(value, dict) else getattr(value, "kind", "linear"))


AnyAxis: TypeAlias = Annotated[
    Annotated[LinearAxis, Tag("linear")] | Annotated[RotaryAxis, Tag("rotary")],
    Discriminator(
        _kind_of_axis,
        custom_error_type="problem",
        custom_error_message="{message}",
        custom_error_context={
            "message": '\'kind\' is neither "linear" nor "rotary"',
            "hint": 'write kind = "linear" (mm) or kind = "rotary" (degree)',
            "at": ("kind",),
        },
    ),
]
