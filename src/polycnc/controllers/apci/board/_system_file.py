"""The system file: what the planning program stores about a board, as TOML text with strict keys.

It stands for `system.dat`. Every key has a default, so an empty file is a board with three servo axes.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import BeforeValidator, Field, model_validator

from polycnc.controllers.apci.board._records import MAXAXIS, axis_number
from polycnc.controllers.apci.board._system_axis import AxisSetup, NotNegative, PositionUnitName, TimeUnitName
from polycnc.controllers.apci.core._registers import INPUTS, OUTPUTS, BoardType, ModeReg
from polycnc.errors import UsageError
from polycnc.machine import KeyPath, StrictModel, load_toml, parse_toml, problem, validate

InputFunction: TypeAlias = Literal[
    "EO", "DR", "LSL_TOM", "LSL_SMA", "LSL_SMD", "LSR_TOM", "LSR_SMA", "LSR_SMD", "UI", "REF", "LP"
]
STEPPER_CLOCK_HZ = {"APCI-8001": 70e6, "APCI-8008": 66.66666e6}


def _terminal(count: int) -> BeforeValidator:
    """Turn the key of a numbered table, which TOML reads as text, into the number of a terminal."""

    def number(value: object) -> object:
        if isinstance(value, str) and (not re.fullmatch("[1-9][0-9]?", value) or int(value) > count):
            raise problem(f"there is no number '{value}'", hint=f"they are numbered 1 to {count}")
        return int(value) if isinstance(value, str) else value

    return BeforeValidator(number)


def _modes(value: object) -> object:
    for name in value if isinstance(value, tuple) else ():
        if name not in ModeReg.__members__:
            raise problem(f"there is no mode '{name}'", hint=f"modes are {', '.join(ModeReg.__members__)}")
    return value


class InputPlan(StrictModel):
    """What a digital input is used for."""

    functions: tuple[InputFunction, ...] = Field(default=(), description="What the input does.")
    axes: tuple[str, ...] = Field(default=(), description="Names of the axes it does that for; absent: all.")
    inverted: bool = Field(default=False, description="true: the input is active while its level is low.")


class OutputPlan(StrictModel):
    """What a digital output is used for."""

    functions: tuple[Literal["PAE"], ...] = Field(default=(), description='"PAE" follows the position loop.')
    axes: tuple[str, ...] = Field(default=(), description="Names of the axes it follows; absent: all.")
    set_at_reset: bool = Field(default=False, description="State after a reset.")


class BoardVariables(StrictModel):
    """Variables of the whole board; loading the file writes them."""

    pu: PositionUnitName = Field(default="mm", description="Position unit of interpolation.")
    tu: TimeUnitName = Field(default="sec", description="Time unit of interpolation.")
    trac: NotNegative = Field(default=1000.0, description="Trajectory acceleration of SAP programs.")
    trvl: NotNegative = Field(default=100.0, description="Trajectory velocity of SAP programs.")
    trtvl: float = Field(default=0.0, description="Trajectory target velocity of SAP programs.")
    trovrst: NotNegative = Field(default=0.0, description="Seconds for a change of the override by 1.")
    modereg: Annotated[tuple[str, ...], BeforeValidator(_modes)] = Field(
        default=(), description='Modes that are on, like "lookahead".'
    )
    nfrax: tuple[str, ...] = Field(default=(), description="Names of axes that do not count for the path.")


class Rulings(StrictModel):
    """What the manual leaves open and a board may do otherwise."""

    instructions_per_scan: Annotated[int, Field(gt=0, le=100_000)] = Field(
        default=100, description="Instructions that each SAP task runs in a scan."
    )
    ssms_undoes_sstps: bool = Field(
        default=True,
        description="true: ssms takes a pause back while the last entry before it runs; false: it does nothing then.",
    )


class SystemFile(StrictModel):
    """A board: its type, axes, terminals and variables."""

    board_type: Literal["APCI-8001", "APCI-8008"] = Field(default="APCI-8001", description="Type of board.")
    sample_time_us: Annotated[int, Field(gt=0, le=100_000)] = Field(
        default=1280, description="Time of a scan, whole microseconds."
    )
    number_of_axes: Annotated[int, Field(gt=0, le=MAXAXIS)] = Field(
        default=3, description="Number of axes; those without a table are A1, A2, ... with all defaults."
    )
    axes: tuple[AxisSetup, ...] = Field(default=(), alias="axis", description="The axes, see `[[axis]]`.")
    board: BoardVariables = Field(default=BoardVariables(), description="Variables, see `[board]`.")
    inputs: dict[Annotated[int, _terminal(INPUTS)], InputPlan] = Field(
        default={}, description="Use of the inputs, like `1 = { functions = ['REF'], axes = ['A1'] }`."
    )
    outputs: dict[Annotated[int, _terminal(OUTPUTS)], OutputPlan] = Field(
        default={}, description="Use of the outputs, like `1 = { functions = ['PAE'] }`."
    )
    rulings: Rulings = Field(default=Rulings(), description="What the manual leaves open, see `[rulings]`.")
    environment: dict[str, str] = Field(
        default={}, description="Environment strings; the board has them from when it is switched on."
    )

    @model_validator(mode="before")
    @classmethod
    def _all_axes(cls, data: Any) -> Any:
        """Complete the axes to their number, or count them."""
        given = data.get("axis", ()) if isinstance(data, dict) else None
        wanted = data.get("number_of_axes") if isinstance(data, dict) else None
        if not isinstance(given, tuple) or not (wanted is None or type(wanted) is int):
            return data
        if len(given) > MAXAXIS or (wanted is not None and len(given) > wanted):
            limit = MAXAXIS if wanted is None else wanted
            raise problem(f"there are {len(given)} axes", hint=f"at most {limit} here", at=("axis", limit))
        count = wanted if wanted is not None and 0 < wanted <= MAXAXIS else len(given) or 3
        named = [
            {"name": f"A{number}", **each} if isinstance(each, dict) else each
            for number, each in enumerate(given, 1)
        ]
        more = [AxisSetup(name=f"A{number}") for number in range(len(given) + 1, count + 1)]
        return {**data, "number_of_axes": count if wanted is None else wanted, "axis": (*named, *more)}

    @model_validator(mode="after")
    def _names_fit(self) -> SystemFile:
        seen: set[str] = set()
        for index, name in enumerate(self.axis_names):
            if name.upper() in seen:
                raise problem(f"there are two axes '{name}'", hint="rename one", at=("axis", index, "name"))
            seen.add(name.upper())
        lists: list[tuple[KeyPath, tuple[str, ...]]] = [(("board", "nfrax"), self.board.nfrax)]
        for table, plans in (("inputs", self.inputs), ("outputs", self.outputs)):
            lists += [((table, str(number), "axes"), plan.axes) for number, plan in plans.items()]
        for place, names in lists:
            for name in names:
                if name not in self.axis_names:
                    axes = ", ".join(self.axis_names)
                    raise problem(f"there is no axis '{name}'", hint=f"the axes are {axes}", at=place)
        return self

    @property
    def axis_names(self) -> tuple[str, ...]:
        """Return the names of the axes, in their order."""
        return tuple(axis.name for axis in self.axes)

    @property
    def type_number(self) -> BoardType:
        """Return the type of board as InitMcuSystem3 gives it."""
        return {"APCI-8001": BoardType.APCI_8001, "APCI-8008": BoardType.APCI_8008}[self.board_type]

    @property
    def sample_time_s(self) -> float:
        """Return the time of a scan."""
        return self.sample_time_us / 1_000_000

    @property
    def stepper_clock_hz(self) -> float:
        """Return the clock that step pulses are made from."""
        return STEPPER_CLOCK_HZ[self.board_type]

    @property
    def modereg(self) -> ModeReg:
        """Return the planned modes as a register."""
        return ModeReg(sum(ModeReg[name] for name in set(self.board.modereg)))

    @property
    def nfrax(self) -> int:
        """Return the axes that do not count for the path, bit by index."""
        return sum(1 << self.axis_names.index(name) for name in set(self.board.nfrax))

    @property
    def inverted_inputs(self) -> int:
        """Return the mask of inputs that are active while low; input 1 is bit 0."""
        return sum(1 << number - 1 for number, plan in self.inputs.items() if plan.inverted)

    def active_inputs(self, levels: int) -> int:
        """Return the input bits of digi for the levels at the terminals; input 1 is bit 0 of both."""
        return (levels ^ self.inverted_inputs) & (1 << INPUTS) - 1

    def inputs_for(self, function: InputFunction, axis: int) -> int:
        """Return the mask of inputs planned with `function` for an axis; input 1 is bit 0.

        Raises:
            UsageError: There is no such axis.
        """
        name = self.axis_names[axis_number(axis, len(self.axes))]
        plans = self.inputs.items()
        return sum(1 << n - 1 for n, p in plans if function in p.functions and (not p.axes or name in p.axes))

    def outputs_for(self, axis: int) -> int:
        """Return the mask of outputs planned PAE for an axis; output 1 is bit 0.

        Raises:
            UsageError: There is no such axis.
        """
        name = self.axis_names[axis_number(axis, len(self.axes))]
        plans = self.outputs.items()
        return sum(1 << n - 1 for n, p in plans if "PAE" in p.functions and (not p.axes or name in p.axes))

    @property
    def outputs_at_reset(self) -> int:
        """Return the outputs that are set after a reset; output 1 is bit 0."""
        return sum(1 << number - 1 for number, plan in self.outputs.items() if plan.set_at_reset)

    def axis_index(self, name: str) -> int:
        """Return the number of the axis called `name`, in any case.

        Raises:
            UsageError: There is no such axis.
        """
        names = [each.upper() for each in self.axis_names]
        if name.upper() not in names:
            raise UsageError(f"there is no axis '{name}'", hint=f"the axes are {', '.join(self.axis_names)}")
        return names.index(name.upper())

    def differences(self, board: SystemFile) -> tuple[str, ...]:
        """Return in what this file does not describe `board`, the file a board was built from; any sets cef."""
        found = [
            name for name in ("board_type", "number_of_axes") if getattr(self, name) != getattr(board, name)
        ]
        pairs = zip(self.axes, board.axes, strict=False)
        return (*found, *(f"motor of axis {n}" for n, (a, b) in enumerate(pairs) if a.motor != b.motor))


def load_system_file(path: str | Path) -> SystemFile:
    """Read a system file.

    Raises:
        ConfigurationError: The file cannot be read, is not TOML, or has a wrong key or value.
    """
    return validate(SystemFile, *load_toml(path))


def parse_system_file(text: str, file: str = "system.dat") -> SystemFile:
    """Return the system file with this text; `file` is its name in errors.

    Raises:
        ConfigurationError: The text is not TOML, or has a wrong key or value.
    """
    return validate(SystemFile, *parse_toml(text, file))
