"""A dialect: which code does what on a control, as a table in a TOML file.

The interpreter knows actions, never code numbers of a vendor; a new control is a new file.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from functools import cache, cached_property
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt
from pydantic import AfterValidator, Field, model_validator

from polycnc.errors import ConfigurationError, UsageError, did_you_mean
from polycnc.machine import Locator, PathConfig, StrictModel, load_toml, parse_toml, problem, validate
from polycnc.nc.dialect._arc_settings import Arcs
from polycnc.nc.dialect._base import CODE, on_base
from polycnc.nc.dialect._cycle_settings import Cycles
from polycnc.nc.modal._actions import M_ACTIONS, NO_SENSE, Action, Family, Group, MAction, of_family, sense_of
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    EXACT_STOP,
    FEED,
    FEED_MODE,
    FEED_NUMBER,
    FEED_PER_MINUTE,
    FEED_PER_REVOLUTION,
    MOTION,
    MOTION_LINEAR,
    MOTION_NONE,
    MOTION_RAPID,
    PLANE_XY,
    PLANE_YZ,
    PLANE_ZX,
    RAPID_STOP,
    Modal,
    set_inch,
    set_plane,
)
from polycnc.nc.text._program import TextRules

G_CODES = 10000  # G0 to G999.9
_LOW_M = 100  # M0 to M99 are looked at for what they switch

_PLANES = {"xy": PLANE_XY, "zx": PLANE_ZX, "yz": PLANE_YZ}
_MOTIONS = {"none": MOTION_NONE, "rapid": MOTION_RAPID, "linear": MOTION_LINEAR}
Refused: TypeAlias = Literal[
    "G84 with M4",
    "motion code alone",
    "axis codes beside a motion",
    "words of another cycle",
    "two coolants",
    "unknown tools",
    "D alone",
    "half a centre",
    "compensation outside X Y and X Z",
    "feeds of before",
    "N behind words",
]
_ACTIONS = {action.title: action for action in Action}


def _known_actions(table: dict[str, str]) -> dict[str, str]:
    for code, action in table.items():
        if not code.replace(".", "", 1).isdigit() or not 0.0 <= float(code) < G_CODES / 10:
            raise problem(f"'{code}' is not a G code", hint="write it like 0, 17 or 54.1", at=(code,))
        if action not in _ACTIONS:
            raise problem(
                f"'{action}' is not an action", hint=f"use one of {', '.join(_ACTIONS)}", at=(code,)
            )
    return table


def _known_m_actions(table: dict[str, str]) -> dict[str, str]:
    for code, action in table.items():
        if not code.isdigit():
            raise problem(f"'{code}' is not an M code", hint="write it like 3 or 30", at=(code,))
        if action not in M_ACTIONS:
            raise problem(
                f"'{action}' is not an action", hint=f"use one of {', '.join(M_ACTIONS)}", at=(code,)
            )
    return table


def _groups_or_m_codes(names: tuple[str, ...]) -> tuple[str, ...]:
    for name in names:
        if name not in set(Group) and not re.fullmatch(r"M[0-9]{1,3}", name):
            raise problem(f"'{name}' is no group", hint=f"use M6, or one of {', '.join(Group)}")
    return names


class Numbers(StrictModel):
    """How numbers without a decimal point are read."""

    decimal_point: Literal["calculator", "least_input"] = Field(
        default="calculator", description='"calculator": X10 is 10 units; "least_input": it is 10 increments.'
    )
    least_input: Annotated[float, Field(gt=0)] = Field(
        default=0.001, description="Size of an increment in mm or degree; a tenth of the number in inch."
    )
    feed_least_input: Annotated[float, Field(ge=0)] = Field(
        default=0.0,
        description="What F without a point counts, in mm; a tenth of the number in inch. 0: it is a plain number.",
    )

    @model_validator(mode="after")
    def _feeds_count_where_lengths_do(self) -> Numbers:
        if self.feed_least_input and self.decimal_point != "least_input":
            raise problem(
                "F counts increments only where lengths do",
                hint='add decimal_point = "least_input"',
                at=("feed_least_input",),
            )
        return self


class SubPrograms(StrictModel):
    """How sub-programs are called."""

    depth: Annotated[int, Field(ge=1)] = Field(default=7, description="How deep calls may be nested.")
    repeats_in_p: bool = Field(
        default=False, description="P of more than four digits: the last four are the program, the others L."
    )
    end_returns: bool = Field(
        default=False, description="An end of program (M2, M30) in a sub-program returns to its caller."
    )


class Initial(StrictModel):
    """The modal state at program start."""

    motion: Literal["none", "rapid", "linear"] = Field(default="linear", description="Motion in force.")
    units: Literal["metric", "inch"] = Field(default="metric", description="Units of lengths and feeds.")
    plane: Literal["xy", "zx", "yz"] = Field(default="xy", description="Working plane.")
    absolute: bool = Field(default=True, description="Positions are absolute.")
    exact_stop: bool = Field(default=False, description="Every block comes to rest.")
    feed_mode: Literal["per_minute", "per_revolution"] = Field(default="per_minute", description="Feed mode.")
    retract: Literal["initial", "r"] = Field(
        default="initial", description="Where drilling cycles go back to: as with G98, or with G99."
    )
    feed_mm_min: Annotated[float, Field(ge=0)] = Field(
        default=0.0, description="Feed until the first F; 0 is none."
    )


_OTHER_M = {"auxiliary": MAction.AUXILIARY, "auxiliary_words": MAction.AUXILIARY_WORDS}


class Dialect(StrictModel):
    """Describe a dialect completely; see docs/reference/dialects.md for the keys."""

    name: str = Field(min_length=1, description="Name of the dialect.")
    description: str = Field(default="", description="Any text.")
    extensions: tuple[str, ...] = Field(default=(), description="File extensions that mean this dialect.")
    base: str | None = Field(
        default=None,
        description="A dialect, by name or file: what this file does not say is as there. Codes and the keys of tables "
        "are taken one by one.",
    )
    without: tuple[str, ...] = Field(
        default=(), description='Codes of the base that are none here, like `["G32", "M19"]`.'
    )
    g: Annotated[dict[str, str], AfterValidator(_known_actions)] = Field(
        description="G code = action, see the table of actions."
    )
    m: Annotated[dict[str, str], AfterValidator(_known_m_actions)] = Field(
        description="M code = action, see the table of M actions."
    )
    other_m: Literal["auxiliary", "auxiliary_words", "error"] = Field(
        default="auxiliary", description="What any other M code is."
    )
    dwell: dict[str, Literal["s", "ms", "s_or_ms", "rev"]] = Field(
        default={"P": "s", "X": "s", "F": "s"},
        description='Addresses of a dwell and their unit; "s_or_ms": seconds with a decimal point, else ms.',
    )
    ignored_addresses: tuple[str, ...] = Field(
        default=(), description="Addresses that are allowed anywhere, without effect."
    )
    blocks_ahead: Annotated[int, Field(ge=1)] | None = Field(
        default=None,
        description="How many blocks are prepared beyond the one that is executed; absent: as many as fit.",
    )
    language: Literal["none", "cpl", "macro", "rs274"] = Field(
        default="none",
        description='The language that programs may hold besides NC blocks: "cpl" of Bosch, custom macros ("macro"), '
        '"rs274" of LinuxCNC.',
    )
    h_compensates: bool = Field(
        default=False,
        description="H alone compensates the tool length, H0 cancels; else G43 or G44 is needed.",
    )
    notes_codes: bool = Field(
        default=False, description="The G codes that were programmed are kept, for those who ask for them."
    )
    diameter_axes: tuple[str, ...] = Field(
        default=(),
        description="Axes whose positions are diameters, besides those that the machine file names.",
    )
    incremental: dict[str, str] = Field(
        default={}, description='Addresses of ways = the axis that goes them, like `U = "X"`.'
    )
    corner_words: bool = Field(
        default=False, description="R and C of a straight move round or chamfer the corner to the next one."
    )
    same_group: Literal["error", "last"] = Field(
        default="error",
        description='Two codes of one group in a block: "error" refuses them, "last" takes the last and says so.',
    )
    soft_limits: Literal["before", "at_limit"] = Field(
        default="before",
        description='A move past a soft limit: "before" refuses its block, "at_limit" carries it out up to the limit.',
    )
    tool_word: Literal["select", "turret"] = Field(
        default="select",
        description='"select": T chooses the tool of the next change; "turret": T0203 turns to tool 2 with offset 3.',
    )
    two_tools: bool = Field(
        default=False, description="T01 T02 M6 changes to tool 1 and lets tool 2 be the next one."
    )
    rapid_exact_stop: bool = Field(default=True, description="Rapid moves come to rest at both ends.")
    free_corners: bool = Field(
        default=False,
        description="Without a tolerance (G64 without P) corners are rounded as far as a quarter of the shorter move.",
    )
    machine_coordinates_in_g91: bool = Field(
        default=True,
        description="Moves in machine coordinates (G53) are allowed where positions are incremental.",
    )
    held_by_compensation: Annotated[tuple[str, ...], AfterValidator(_groups_or_m_codes)] = Field(
        default=(),
        description='Modal groups and M codes that are refused while radius compensation is on: `"stopping"`, `"M6"`.',
    )
    dwell_before_move: bool = Field(
        default=False, description="A block may dwell (G4) and move, in this order."
    )
    retraced_rad: Annotated[float, Field(gt=0, lt=0.1)] = Field(
        default=1e-7,
        description="With radius compensation a corner that lacks less than this of a half turn is a path traced back.",
    )
    rapids_across_corners: bool = Field(
        default=False,
        description="With radius compensation a rapid move goes straight across an outside corner before it.",
    )
    refuses: tuple[Refused, ...] = Field(
        default=(), description="What is refused here and taken elsewhere: see the table of refusals."
    )
    m_words: dict[str, str] = Field(
        default={},
        description='Words that M codes take ("auxiliary_words", "spindle_orient", outputs), like `62 = "P!"`: a '
        'letter with ! must be there; "other" are codes without a line of their own.',
    )
    tool_change_stops_spindle: bool = Field(default=False, description="M6 stops the spindle.")
    d_limits_spindle: bool = Field(
        default=False, description="D beside G96 is the highest speed of the spindle, none without it."
    )
    lead_in_by_arc: bool = Field(
        default=False,
        description="Radius compensation may start with an arc: from where the tool is to beside its end.",
    )
    lead_in_beside_itself: bool = Field(
        default=False,
        description="A straight lead-in ends beside its own end, and the corner after it is one like others.",
    )
    leads_out_at_once: bool = Field(
        default=False,
        description="After G40 the next straight move leads out, also one that does not move in the plane.",
    )
    inverse_time_as_programmed: bool = Field(
        default=False,
        description="With radius compensation G93 counts the programmed way, not that of the tool.",
    )
    merges_lines: bool = Field(
        default=False,
        description="G64 P merges lines into one while every point between lies within Q of it, within P without Q.",
    )
    numbers: Numbers = Field(default=Numbers(), description="See `[numbers]`.")
    arcs: Arcs = Field(default=Arcs(), description="See `[arcs]`.")
    scaling_unit: Annotated[float, Field(gt=0)] = Field(
        default=0.001, description="What a scaling factor without a decimal point counts."
    )
    sub_program: SubPrograms = Field(default=SubPrograms(), description="See `[sub_program]`.")
    cycles: Cycles = Field(default=Cycles(), description="See `[cycles]`.")
    text: TextRules = Field(default=TextRules(), description="See `[text]`.")
    initial: Initial = Field(default=Initial(), description="See `[initial]`.")

    @model_validator(mode="after")
    def _leaves_out_of_a_base(self) -> Dialect:
        if self.without and self.base is None:
            raise problem("there is no base to leave codes out of", hint="name a base", at=("without",))
        return self

    @model_validator(mode="after")
    def _extensions_have_dots(self) -> Dialect:
        for extension in self.extensions:
            if not extension.startswith("."):
                raise problem(f"'{extension}' has no dot", hint=f"write '.{extension}'", at=("extensions",))
        return self

    @cached_property
    def _by_code(self) -> dict[int, Action]:
        return {round(float(code) * 10): _ACTIONS[action] for code, action in self.g.items()}

    @cached_property
    def _by_m(self) -> dict[int, MAction]:
        return {int(code): M_ACTIONS[action] for code, action in self.m.items()}

    @property
    def has_tool_change(self) -> bool:
        """Whether programs can change the tool."""
        return MAction.TOOL_CHANGE in self._by_m.values() or self.tool_word == "turret"

    @property
    def reads_contours(self) -> bool:
        """Whether a cycle can name the blocks of a contour that come after it."""
        return not of_family(Family.CONTOUR_CYCLE).isdisjoint(self._by_code.values())

    @cached_property
    def turns_work(self) -> bool:
        """Whether a work offset can turn the plane of X and Y."""
        return Action.SET_TABLES in self._by_code.values()

    @cached_property
    def shifts_by_code_alone(self) -> bool:
        """Whether H compensates the tool length beside its code only."""
        return Action.TOOL_OFFSET in self._by_code.values()

    @property
    def sets_work_offsets(self) -> bool:
        """Whether programs can set work offsets: then they begin in G54."""
        return not {Action.SET_DATA, Action.SET_WORK_ZERO, Action.SET_TABLES}.isdisjoint(
            self._by_code.values()
        )

    def path_tolerance_mm(self, path: PathConfig) -> float:
        """Return how far corners may be rounded where the program says nothing, mm; inf if it is free."""
        return math.inf if self.free_corners and path.tolerance_mm == 0.0 else path.tolerance_mm

    def g_action(self, code: float) -> Action | None:
        """Return what a G code does, None if the dialect does not know it."""
        tenths = round(code * 10)
        return self._by_code.get(tenths) if abs(code * 10 - tenths) < 1e-6 else None

    def g_codes(self) -> dict[float, Action]:
        """Return what all G codes do, by their number as programs write it."""
        return {float(code): _ACTIONS[action] for code, action in self.g.items()}

    def m_action(self, code: int) -> MAction | None:
        """Return what an M code does, None if the dialect refuses it."""
        other = _OTHER_M.get(self.other_m)
        return self._by_m.get(code, other)

    def leaving_out(self, codes: Iterable[str]) -> Dialect:
        """Return the same dialect without these G and M codes, which count as if they were not there.

        Raises:
            UsageError: something else than a G or M code, like G43.4 or M98.
        """
        g, m = dict(self.g), dict(self.m)
        for code in codes:
            found = CODE.fullmatch(code.strip())
            if found is None:
                raise UsageError(f"'{code}' is no G or M code", hint="Write codes like G43.4 or M98.")
            table, action = (g, "left_out") if found[1] in "Gg" else (m, "left_out")
            number = f"{float(found[2]):g}"
            if table is g and float(number) >= G_CODES / 10:
                raise UsageError(f"'{code}' is no G code", hint="G codes are G0 to G999.9.")
            if table is m and "." in number:
                raise UsageError(f"'{code}' is no M code", hint="M codes are whole numbers.")
            for key in [key for key in table if float(key) == float(number)]:
                del table[key]
            table[number] = action
        changed = {name: getattr(self, name) for name in type(self).model_fields}
        return type(self).model_construct(**{**changed, "g": g, "m": m})

    @property
    def increment(self) -> float:
        """Size of an increment for numbers without a decimal point; 0: they are plain numbers."""
        return self.numbers.least_input if self.numbers.decimal_point == "least_input" else 0.0

    def tables(self) -> DialectTables:
        """Return what the compiled kernel needs of the dialect."""
        g_action = np.zeros(G_CODES, np.int16)
        for tenths, action in self._by_code.items():
            # Only ordinary blocks are noted, and forget the feed.
            ordinary = self.notes_codes or "feeds of before" in self.refuses
            if not (ordinary and action is Action.FEED_PER_MINUTE):
                g_action[tenths] = action
        m_sense = np.full(_LOW_M, NO_SENSE, np.int8)
        for code, m_action in self._by_m.items():
            if code < _LOW_M:
                m_sense[code] = sense_of(m_action, self.m_words.get(str(code), ""))
        return DialectTables(g_action, self.increment, m_sense, self.tool_word == "select")

    def set_initial_state(self, modal: Modal) -> None:
        """Put the modal state that programs start with in force."""
        initial = self.initial
        set_plane(modal, _PLANES[initial.plane])
        set_inch(modal, initial.units == "inch")
        modal.whole[MOTION] = _MOTIONS[initial.motion]
        modal.whole[ABSOLUTE] = initial.absolute
        modal.whole[EXACT_STOP] = initial.exact_stop
        modal.whole[RAPID_STOP] = self.rapid_exact_stop
        modal.whole[FEED_MODE] = FEED_PER_MINUTE if initial.feed_mode == "per_minute" else FEED_PER_REVOLUTION
        modal.real[FEED] = modal.real[FEED_NUMBER] = initial.feed_mm_min
        self.arcs.put_in_force(modal)


class DialectTables(NamedTuple):
    """The dialect as the compiled kernel reads it: actions by tenths of the G code, increment of numbers.

    `m_sense` says of each M code what it does (`M_SENSES`, `OUTPUT_SENSES`), or NO_SENSE; with `selects` T is for the
    next tool change and nothing else.
    """

    g_action: npt.NDArray[np.int16]
    least_input: float
    m_sense: npt.NDArray[np.int8]
    selects: bool


_SHIPPED = ("din", "fanuc", "fanuc-lathe", "fanuc-lathe-b", "haas", "grbl", "linuxcnc", "bosch")
DEFAULT_DIALECT = "din"
DIALECTS: tuple[str, ...] = _SHIPPED
"""Names of the shipped dialects."""


_MOST_BASES = 8


def _shipped_data(name: str) -> tuple[dict[str, Any], Locator]:
    file = resources.files("polycnc.nc") / "dialects" / f"{name}.toml"
    data, locator = parse_toml(file.read_text(encoding="utf-8"), f"{name}.toml")
    return _whole(data, locator, Path()), locator


@cache
def _shipped(name: str) -> Dialect:
    return validate(Dialect, *_shipped_data(name))


def _whole(data: dict[str, Any], locator: Locator, folder: Path, over: int = 0) -> dict[str, Any]:
    """Return what a file says with what its base says; `over` files stand on it."""
    base = data.get("base")
    if not isinstance(base, str):
        return data
    position = locator.position(("base",))
    if base in _SHIPPED:
        return on_base(data, _shipped_data(base)[0], locator)
    path = folder / base
    if path.suffix != ".toml":
        hint = f"{did_you_mean(base, _SHIPPED)}Use {', '.join(_SHIPPED)}, or a TOML file beside this one."
        raise ConfigurationError(f"there is no dialect '{base}'", hint=hint, position=position)
    if over == _MOST_BASES:
        hint = "A dialect may not be its own base."
        raise ConfigurationError(
            f"{over + 1} dialects, each the base of the one before", hint=hint, position=position
        )
    below, its_locator = load_toml(path)
    whole = _whole(below, its_locator, path.parent, over + 1)
    validate(Dialect, whole, its_locator)
    return on_base(data, whole, locator)


def load_dialect(source: str | Path | Dialect | None = None) -> Dialect:
    """Return a dialect by name, from a TOML file, or the default one.

    Raises:
        UsageError: there is no such dialect.
        ConfigurationError: the file is not a dialect.
    """
    if isinstance(source, Dialect):
        return source
    if source is None:
        return _shipped(DEFAULT_DIALECT)
    if isinstance(source, str) and source in _SHIPPED:
        return _shipped(source)
    path = Path(source)
    if path.suffix == ".toml" or path.is_file():
        data, locator = load_toml(path)
        return validate(Dialect, _whole(data, locator, path.parent), locator)
    raise UsageError(
        f"there is no dialect '{source}'",
        hint=f"{did_you_mean(str(source), _SHIPPED)}Use {', '.join(_SHIPPED)}, or a TOML file that describes one.",
    )
