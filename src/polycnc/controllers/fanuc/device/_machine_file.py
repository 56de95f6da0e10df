"""The machine behind a Power Mate, made from the settings of the control: axes, kinds, speeds, limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from polycnc.controllers.fanuc.data._increment import Increment
from polycnc.errors import UsageError
from polycnc.machine import AnyAxis, LinearAxis, MachineConfig, RotaryAxis

LINEAR_NAMES = ("X", "Y", "Z", "U", "V", "W")
ROTARY_NAMES = ("A", "B", "C", "P", "Q", "R")
CYCLE_S = 0.001
MOST_AXES = {"H": 6, "D": 2}


@dataclass(frozen=True, slots=True)
class AxisSetting:
    """What parameters say about an axis, in mm or degree, per second."""

    name: str
    rotary: bool
    vmax: float
    amax: float
    soft_limits: tuple[float, float] | None
    servo_kp: float | None
    error_limit: float | None


def axis_of(setting: AxisSetting) -> AnyAxis:
    """Return the axis of a machine file."""
    unit = "deg" if setting.rotary else "mm"
    row: dict[str, object] = {
        "name": setting.name,
        f"vmax_{unit}_s": setting.vmax,
        f"amax_{unit}_s2": setting.amax,
    }
    if setting.soft_limits is not None:
        row[f"soft_limits_{unit}"] = setting.soft_limits
    if setting.servo_kp is not None:
        row["servo"] = {"kind": "pidf", "kp": setting.servo_kp, "lag_s": 0.002}
        if setting.error_limit is not None:
            row["servo"] = {**row["servo"], f"following_error_limit_{unit}": setting.error_limit}  # type: ignore[dict-item]
    return (RotaryAxis if setting.rotary else LinearAxis).model_validate(row)


def machine_of(axes: Sequence[AnyAxis], start: Mapping[str, float]) -> MachineConfig:
    """Return the machine file; without soft limits, as axes may stand beyond them."""
    free = [axis.model_copy(update={f"soft_limits_{axis.unit}": None}) for axis in axes]
    return MachineConfig.model_validate(
        {
            "name": "power mate",
            "cycle_s": CYCLE_S,
            "axis": tuple(free),
            "start": dict(start),
            "spindle": {"max_rpm": 6000.0, "acceleration_rpm_s": 6000.0},
        }
    )


def default_names(axes: int, rotary: Sequence[int | str]) -> tuple[tuple[str, bool], ...]:
    """Return name and kind (rotary or not) of the axes; `rotary` are numbers from 1, or names.

    Linear axes are X Y Z U V W in their order, rotary ones A B C P Q R.

    Raises:
        UsageError: An axis that there is not.
    """
    numbers = set()
    for each in rotary:
        number = LINEAR_NAMES.index(each) + 1 if each in LINEAR_NAMES else each
        if isinstance(number, str):  # a rotary name: the last axes, in the order of the names
            raise UsageError(
                f"rotary axis '{each}' has no place", hint="Give the numbers of the rotary axes, from 1."
            )
        if not 1 <= number <= axes:
            raise UsageError(f"there is no axis {each} to be rotary", hint=f"The axes are 1 to {axes}.")
        numbers.add(number)
    linear, turning = iter(LINEAR_NAMES), iter(ROTARY_NAMES)
    return tuple(
        (next(turning), True) if number in numbers else (next(linear), False) for number in range(1, axes + 1)
    )


def usable_names(codes: Sequence[int], rotary: Sequence[bool]) -> tuple[str, ...]:
    """Return names for axes from the codes of their letters; one that is none or is taken gets a free name."""
    letters = [chr(code) if chr(code) in LINEAR_NAMES + ROTARY_NAMES else "" for code in codes]
    names = [letter if letter not in letters[:k] else "" for k, letter in enumerate(letters)]
    for k, turns in enumerate(rotary):
        if not names[k]:
            names[k] = next(name for name in (ROTARY_NAMES if turns else LINEAR_NAMES) if name not in names)
    return tuple(names)


def axes_of(model: str, increment: str, axes: int | None) -> tuple[int, int]:
    """Return how many axes a model has at the most, and how many it gets.

    Raises:
        UsageError: There is no such model, increment system, or number of axes.
    """
    if model not in MOST_AXES:
        raise UsageError(f"there is no Power Mate-{model}", hint="Models are H and D.")
    if increment not in set(Increment):
        raise UsageError(
            f"there is no increment system '{increment}'", hint=f"There are {', '.join(Increment)}."
        )
    most = MOST_AXES[model]
    given = min(3, most) if axes is None else axes
    if not 1 <= given <= most:
        raise UsageError(f"a Power Mate-{model} has no {given} axes", hint=f"Give 1 to {most}.")
    return most, given


def defaults(
    names: Sequence[tuple[str, bool]], increment: Increment, inch_input: bool, inch_output: bool
) -> dict[tuple[int, int], int]:
    """Return the values of parameters that the arguments of a control say."""
    made: dict[tuple[int, int], int] = {
        (0, 0): 4 if inch_input else 0,
        (1001, 0): int(inch_output),
        (1004, 0): {Increment.IS_A: 1, Increment.IS_B: 0, Increment.IS_C: 2}[increment],
        (1010, 0): len(names),
    }
    for axis, (name, rotary) in enumerate(names, 1):
        made |= {
            (1006, axis): int(rotary),
            (1020, axis): ord(name),
            (1022, axis): axis if axis <= 3 and not rotary else 0,
            (1023, axis): axis,
        }
    return made
