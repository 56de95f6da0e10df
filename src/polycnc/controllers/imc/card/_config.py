"""The card file: how many axes, how deep the queues, what surrounds each axis; TOML text with strict keys.

Every key has a default, so an empty file is a card with four axes and nothing but encoders around them. Positions are
machine positions in pulses, 0 where the machine stands when it is switched on.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from polycnc.controllers.imc.core._parameters import PARAMETERS
from polycnc.machine import StrictModel, load_toml, parse_toml, problem, validate

MOST_AXES = 32
Depth: TypeAlias = Annotated[int, Field(ge=64, le=1 << 16)]
Terminal: TypeAlias = Literal["limit_positive", "limit_negative", "origin"]
Stretch: TypeAlias = Annotated[tuple[float, float], BeforeValidator(lambda value: _stretch(value))]
PASSWORD_LEAST, PASSWORD_BELOW = 4, 100


def _stretch(value: object) -> object:
    if not isinstance(value, tuple) or not all(isinstance(each, int | float) for each in value):
        return value  # the type says what is wrong
    if len(value) != 2 or not value[0] < value[1]:
        raise problem("the stretch is empty", hint="write [from, to] with from < to")
    return value


def _password(value: str) -> str:
    if value and not (PASSWORD_LEAST <= len(value) < PASSWORD_BELOW and value.isascii()):
        raise problem("this cannot be a password", hint="4 to 99 ASCII characters, or none")
    return value


def _values(value: object) -> object:
    for name, number in value.items() if isinstance(value, dict) else ():
        found = PARAMETERS.get(name)
        if found is None:
            raise problem(f"there is no parameter '{name}'", hint="names are those of the parameter header")
        try:
            raw = found.to_raw(number) if isinstance(number, int | float) else 0
        except (OverflowError, ValueError):  # inf, nan
            raise problem(f"{number} does not fit '{name}'", hint=f"it is {found.type}") from None
        bits = 16 * found.words
        if not -(1 << bits - 1) <= raw < 1 << (bits - 1 if found.is_signed else bits):
            raise problem(f"{number} does not fit '{name}'", hint=f"it is {found.type}")
    return value


Values: TypeAlias = Annotated[dict[str, float | int], BeforeValidator(_values)]


class Marks(StrictModel):
    """Pulses along an axis."""

    first: float = Field(default=0.0, description="Position of one pulse.")
    pitch: Annotated[float, Field(ge=0)] = Field(default=0.0, description="Distance of the next, 0 if none.")


class AxisConfig(StrictModel):
    """One axis: the drive, the encoder and the switches around it, in pulses."""

    counts_per_pulse: Annotated[float, Field(gt=0)] = Field(
        default=1.0, description="Counts of the main encoder for a pulse."
    )
    lag_s: Annotated[float, Field(ge=0)] = Field(
        default=0.0, description="Time constant of the drive's velocity, 0 for a drive without lag."
    )
    gain: Annotated[float, Field(gt=0)] = Field(
        default=20.0, description="Gain of the drive's position loop, 1/s; counts where lag_s is above 0."
    )
    limit_positive: float | None = Field(default=None, description="This limit switch is on from here.")
    limit_negative: float | None = Field(default=None, description="This limit switch is on up to here.")
    origin: Stretch | None = Field(default=None, description="Where the origin switch is on, [from, to].")
    low_when_on: tuple[Terminal, ...] = Field(
        default=(), description="Terminals whose level is low while their switch is on."
    )
    index: Marks | None = Field(default=None, description="Index pulses of the encoder.")
    probe: Marks | None = Field(default=None, description="Places where the probe gives a pulse.")
    parameters: Values = Field(default={}, description="Parameters of the axis from power-on, by name.")

    @model_validator(mode="after")
    def _limits_are_apart(self) -> AxisConfig:
        low, high = self.limit_negative, self.limit_positive
        if low is not None and high is not None and not low < high:
            raise problem("the limit switches overlap", hint="limit_negative must be below limit_positive")
        return self


class Depths(StrictModel):
    """How many 16-bit words each queue holds."""

    ififo: Depth = Field(default=512, description="Immediate queue.")
    qfifo: Depth = Field(default=4096, description="Instruction queue.")
    pfifo1: Depth = Field(default=4096, description="Queue of path space 1.")
    pfifo2: Depth = Field(default=4096, description="Queue of path space 2.")
    cfifo: Depth = Field(default=4096, description="Queue of contour points.")

    def of(self, fifo: int) -> int:
        """Return the depth of queue `fifo`, numbered as the card's functions number them, in words."""
        return (self.ififo, self.qfifo, self.pfifo1, self.pfifo2, self.cfifo)[fifo]


class CardConfig(StrictModel):
    """A card: its axes, queues and power-on state."""

    number_of_axes: Annotated[int, Field(ge=1, le=MOST_AXES)] = Field(
        default=4, description="Number of axes; those without a table have all defaults."
    )
    ready: bool = Field(
        default=False, description="true: every axis is enabled and in run from power-on, with usable speeds."
    )
    overflow: Literal["origin", "wrap"] = Field(
        default="origin",
        description="What a position does that leaves 32 bits: go on from 0, or from the other end.",
    )
    scale_factor: Literal["S16.32", "S16.16"] = Field(
        default="S16.32",
        description="Format of the factor of the event commands SCA32, SCA48 and their like.",
    )
    delay_unit: Literal["us", "ms"] = Field(default="us", description="What delayus counts.")
    password: Annotated[str, AfterValidator(_password)] = Field(
        default="", description="Password stored in the card, none if empty."
    )
    fwversion: Annotated[int, Field(ge=0, le=65535)] = Field(default=320, description="Firmware version.")
    hwversion: Annotated[int, Field(ge=0, le=65535)] = Field(default=100, description="Hardware version.")
    depths: Depths = Field(default=Depths(), description="Sizes of the queues, see `[depths]`.")
    parameters: Values = Field(default={}, description="Parameters of the card from power-on, by name.")
    axes: tuple[AxisConfig, ...] = Field(default=(), alias="axis", description="The axes, see `[[axis]]`.")

    @model_validator(mode="before")
    @classmethod
    def _all_axes(cls, data: Any) -> Any:
        """Complete the axes to their number, or count them."""
        given = data.get("axis", ()) if isinstance(data, dict) else None
        wanted = data.get("number_of_axes") if isinstance(data, dict) else None
        if not isinstance(given, tuple) or not (wanted is None or type(wanted) is int):
            return data
        if wanted is not None and len(given) > wanted:
            raise problem(f"there are {len(given)} axes", hint=f"number_of_axes is {wanted}", at=("axis",))
        count = wanted if wanted is not None else len(given) or 4
        more = [AxisConfig() for _ in range(min(count, MOST_AXES) - len(given))]
        return {**data, "number_of_axes": count, "axis": (*given, *more)}


def load_card(path: str | Path) -> CardConfig:
    """Read a card file.

    Raises:
        ConfigurationError: The file cannot be read, is not TOML, or has a wrong key or value.
    """
    return validate(CardConfig, *load_toml(path))


def parse_card(text: str, file: str = "card.toml") -> CardConfig:
    """Return the card with this text; `file` is its name in errors.

    Raises:
        ConfigurationError: The text is not TOML, or has a wrong key or value.
    """
    return validate(CardConfig, *parse_toml(text, file))
