"""What a system file says of one axis: motor, units, default parameters by the manual's names, simulated plant."""

from __future__ import annotations

import re
from typing import Annotated, Literal, TypeAlias

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from polycnc.controllers.apci.board._units import DEGREES, PositionUnit, TimeUnit, ratio
from polycnc.machine import StrictModel, problem

PositionUnitName: TypeAlias = Literal["mm", "inch", "m", "rev", "deg", "rad", "counts", "steps"]
TimeUnitName: TypeAlias = Literal["sec", "min", "tsample"]
LimitFunction: TypeAlias = Literal["none", "TOM", "SMA", "SMD"]
Positive: TypeAlias = Annotated[float, Field(gt=0)]
LEAST = 1e-100
"""What positions are multiplied and divided by is this at least, and at most its inverse: so are its products."""
Factor: TypeAlias = Annotated[float, Field(ge=LEAST, le=1.0 / LEAST)]
NotNegative: TypeAlias = Annotated[float, Field(ge=0)]
Share: TypeAlias = Annotated[float, Field(ge=0, le=1)]

SERVO_MCP_LIMIT = 32767  # is 10 V
STEPPER_MCP_LIMIT = 1_048_574
_DEFAULT_AT_10_V = 200.0


def _stretch(value: object) -> object:
    if not isinstance(value, tuple) or not all(isinstance(each, int | float) for each in value):
        return value  # the type says what is wrong
    if len(value) != 2 or not value[0] < value[1]:
        raise problem("the stretch is empty", hint="write [from, to] with from < to")
    return value


def _identifier(value: str) -> str:
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", value):
        raise problem(
            f"'{value}' is not an axis name", hint="use letters, digits and _, beginning with a letter"
        )
    return value


Stretch: TypeAlias = Annotated[tuple[float, float], BeforeValidator(_stretch)]


class PlantConfig(StrictModel):
    """The simulated drive, its encoder and its switches; positions in the axis' unit, 0 where it is switched on."""

    kind: Literal["ideal", "lag"] = Field(
        default="ideal",
        description='"ideal": the axis is where its setpoint is; "lag": the loop and a drive are simulated.',
    )
    lag_s: NotNegative = Field(default=0.0, description='Time constant of the drive\'s velocity; for "lag".')
    velocity_at_10_v: Positive = Field(
        default=_DEFAULT_AT_10_V, description="Velocity of a servo at 10 V, in the axis' units."
    )
    encoder: Literal["exact", "counts"] = Field(
        default="exact", description='"counts": the actual position is read in whole counts.'
    )
    play: NotNegative = Field(default=0.0, description="Motion lost when the direction reverses.")
    limit_left: float | None = Field(default=None, description="The left limit switch is on up to here.")
    limit_right: float | None = Field(default=None, description="The right limit switch is on from here.")
    reference: Stretch | None = Field(
        default=None, description="Where the reference switch is on, [from, to]."
    )
    index: float | None = Field(
        default=None, description="An index pulse of the encoder; each turn of the motor has one."
    )

    @model_validator(mode="after")
    def _fits_together(self) -> PlantConfig:
        if self.kind == "ideal" and self.lag_s != 0.0:
            raise problem("'lag_s' has no effect on an ideal plant", hint='write kind = "lag"', at=("lag_s",))
        if None not in (left := self.limit_left, right := self.limit_right) and not left < right:  # type: ignore[operator]
            raise problem(
                "the limit switches overlap", hint="limit_left must be below limit_right", at=("limit_right",)
            )
        return self


class AxisSetup(StrictModel):
    """One axis. Jog values are in `unit` and `time_unit`; MaxVel, MaxAcc, MDVEL, effradius in `pu` and `tu`."""

    name: Annotated[str, AfterValidator(_identifier)] = Field(
        description="Name of the axis in SAP programs; absent: A1, A2, ... by its place."
    )
    motor: Literal["servo", "stepper"] = Field(default="servo", description="Kind of motor.")
    unit: PositionUnitName = Field(default="mm", description="Unit of positions.")
    time_unit: TimeUnitName = Field(default="sec", description="Unit of time in velocities, accelerations.")
    display_unit: PositionUnitName | None = Field(
        default=None, description="Unit of the positions that rddpd, rdrpd, rdtpd read; absent: `unit`."
    )
    display_factor: Factor = Field(default=1.0, description="Multiplies positions in the display unit.")
    slsp: Factor = Field(default=10_000.0, description="Slits or steps per turn of the motor.")
    gf: Factor = Field(default=0.1, description="Gear factor: turns of the motor per unit of position.")
    effradius: NotNegative = Field(
        default=0.0, description="Radius at which a rotary axis works; 0: it counts in its own unit."
    )

    jac: Positive = Field(default=1000.0, description="Jog acceleration.")
    jvl: Positive = Field(default=100.0, description="Jog velocity.")
    jtvl: float = Field(default=0.0, description="Jog target velocity, along the direction of travel.")
    hac: Positive = Field(default=500.0, description="Acceleration of reference travel.")
    hvl: Positive = Field(default=20.0, description="Velocity of reference travel.")
    sdec: NotNegative = Field(default=2000.0, description="Stop deceleration; 0: stops at once.")
    jerkrel: Share = Field(default=1.0, description="Share of an S-shaped ramp that its edges take.")
    MaxVel: NotNegative = Field(default=0.0, description="Velocity in interpolation; 0: not checked.")
    MaxAcc: NotNegative = Field(default=0.0, description="Acceleration in interpolation; 0: not checked.")
    MDVEL: NotNegative = Field(default=0.0, description="Velocity jump in look-ahead; 0: not checked.")

    kp: NotNegative = Field(default=20.0, description="Proportional gain; 0: off, like the five below.")
    ki: NotNegative = Field(default=0.0, description="Integral gain.")
    kd: NotNegative = Field(default=0.0, description="Differential gain.")
    kpl: Share = Field(default=0.0, description="Share of the filter's delay that is taken away.")
    kfca: NotNegative = Field(default=0.0, description="Feed-forward of the acceleration.")
    kfcv: NotNegative = Field(default=0.0, description="Feed-forward of the velocity.")
    ipw: NotNegative = Field(default=0.0, description="In-position window; 0: not watched.")
    mpe: NotNegative = Field(default=0.0, description="Largest position error; 0: not watched.")

    sll: float = Field(default=0.0, description="Left software limit.")
    slr: float = Field(default=0.0, description="Right software limit.")
    soft_left: LimitFunction = Field(default="none", description="What the left software limit does.")
    soft_right: LimitFunction = Field(default="none", description="What the right software limit does.")
    backlash: NotNegative = Field(default=0.0, description="Play that the board compensates.")

    mcpmax: int | None = Field(default=None, description="Highest motor command; absent: what it can hold.")
    mcpmin: int | None = Field(default=None, description="Lowest motor command; absent: what it can hold.")
    mcpcp: int = Field(default=0, description="Added to positive motor commands.")
    mcpcn: int = Field(default=0, description="Added to negative motor commands.")
    mcp_inverted: bool = Field(default=False, description="true: positive commands turn the motor left.")

    plant: PlantConfig = Field(default=PlantConfig(), description="What is simulated, see `[axis.plant]`.")

    @model_validator(mode="after")
    def _fits_together(self) -> AxisSetup:
        if abs(self.jtvl) > self.jvl:
            raise problem("'jtvl' is faster than 'jvl'", hint=f"at most {self.jvl}", at=("jtvl",))
        if {self.soft_left, self.soft_right} != {"none"} and not self.sll < self.slr:
            raise problem("the software limits leave no room", hint="sll must be below slr", at=("slr",))
        if self.display_ratio(self.counts_per_unit) is None:
            raise problem(
                f"positions in {self.unit} cannot be shown in {self.display_unit}",
                hint="use a unit of the same kind, and display_factor",
                at=("display_unit",),
            )
        if self.effradius and not self.is_rotary:
            raise problem(
                "'effradius' has no effect: the axis is not rotary",
                hint='write unit = "deg", "rad" or "rev"',
                at=("effradius",),
            )
        if self.motor == "stepper" and self.plant.velocity_at_10_v != _DEFAULT_AT_10_V:
            raise problem(
                "'velocity_at_10_v' has no effect: steps move a stepper",
                hint="remove it",
                at=("plant", "velocity_at_10_v"),
            )
        return self

    @property
    def position_unit(self) -> PositionUnit:
        """Return the number of `unit`."""
        return PositionUnit[self.unit]

    @property
    def velocity_time_unit(self) -> TimeUnit:
        """Return the number of `time_unit`."""
        return TimeUnit[self.time_unit]

    @property
    def is_rotary(self) -> bool:
        """Tell whether positions are angles."""
        return self.position_unit in DEGREES

    @property
    def counts_per_unit(self) -> float:
        """Return the counts in a unit of position, with the planned `slsp` and `gf`."""
        return self.slsp * self.gf

    def display_ratio(self, counts_per_unit: float) -> float | None:
        """Return what a position is multiplied with for display; counts follow a changed `slsp` or `gf`."""
        shown = PositionUnit[self.display_unit or self.unit]
        factor = ratio(self.position_unit, shown, counts_per_unit)
        return None if factor is None else factor * self.display_factor

    @property
    def mcp_limit(self) -> int:
        """Return the largest motor command that can be written, either sign."""
        return SERVO_MCP_LIMIT if self.motor == "servo" else STEPPER_MCP_LIMIT

    @property
    def mcp_range(self) -> tuple[int, int]:
        """Return the lowest and the highest motor command."""
        low, high, limit = self.mcpmin, self.mcpmax, self.mcp_limit
        return (-limit if low is None else low, limit if high is None else high)

    @property
    def mcp_limits_are_possible(self) -> bool:
        """Tell whether the motor command's limits can be meant; otherwise the board sets LimitDefError."""
        low, high = self.mcp_range
        return (
            -self.mcp_limit <= low <= self.mcpcn <= 0 <= self.mcpcp <= high <= self.mcp_limit and low < high
        )
