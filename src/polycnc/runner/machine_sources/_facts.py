"""What a control's configuration says of its machine, in the units of a machine file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from polycnc.errors import ConfigurationError, SourcePosition

AXIS_LETTERS = "XYZABC"
ROTARY = frozenset("ABC")


@dataclass(frozen=True, slots=True)
class Entry:
    """One setting of a file: its name, its value as written, and its place."""

    name: str
    text: str
    position: SourcePosition

    @property
    def number(self) -> float:
        """Return the value as a finite number.

        Raises:
            ConfigurationError: It is none.
        """
        try:
            value = float(self.text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.error(f"'{self.name}' is no number: '{self.text}'", "Write a number like 500 or 0.01.")
        return value

    @property
    def positive(self) -> float:
        """Return the value as a number above zero.

        Raises:
            ConfigurationError: It is none.
        """
        value = self.number
        if value <= 0.0:
            raise self.error(f"'{self.name}' is {self.text}, not above zero", "Write what the machine has.")
        return value

    @property
    def switch(self) -> bool:
        """Return the value as on or off: a number that is not zero, or a word for it."""
        return self.text.strip().lower() not in ("0", "0.0", "false", "no", "off", "")

    def error(self, what: str, hint: str) -> ConfigurationError:
        """Return an error at this place."""
        return ConfigurationError(what, position=self.position, hint=hint)


@dataclass(slots=True)
class Settings:
    """All settings of one file by name; those that were read are remembered."""

    file: str
    entries: Mapping[str, Entry]
    used: set[str] = field(default_factory=set)

    def get(self, name: str) -> Entry | None:
        """Return a setting, or None, and remember that it was read."""
        entry = self.entries.get(name)
        if entry is not None:
            self.used.add(name)
        return entry

    def need(self, name: str, what: str) -> Entry:
        """Return a setting that a machine cannot do without.

        Raises:
            ConfigurationError: It is not there.
        """
        entry = self.get(name)
        if entry is None:
            raise ConfigurationError(
                f"{self.file}: there is no '{name}', {what}",
                hint="Add it, or list all settings of the control.",
            )
        return entry

    def number(self, name: str, default: float) -> float:
        """Return the number of a setting, `default` where it is absent."""
        entry = self.get(name)
        return default if entry is None else entry.number

    def positive(self, name: str, default: float) -> float:
        """Return the number above zero of a setting, `default` where it is absent."""
        entry = self.get(name)
        return default if entry is None else entry.positive

    def switch(self, name: str, default: bool = False) -> bool:
        """Return whether a setting is on, `default` where it is absent."""
        entry = self.get(name)
        return default if entry is None else entry.switch

    def unread(self) -> Iterator[Entry]:
        """Yield the settings that nobody asked for, in the order of the file."""
        return (entry for name, entry in self.entries.items() if name not in self.used)


@dataclass(frozen=True, slots=True)
class AxisFacts:
    """What is known of an axis: mm, mm/s, mm/s2, or degree instead of mm where it turns."""

    name: str
    speed: float
    acceleration: float
    jump: float | None = None
    limits: tuple[float, float] | None = None
    home: float = 0.0

    @property
    def unit(self) -> str:
        """Return "deg" for an axis that turns, else "mm"."""
        return "deg" if self.name[0] in ROTARY else "mm"


@dataclass(frozen=True, slots=True)
class LeftOut:
    """Something that a machine file has no place for, and why."""

    name: str
    why: str


@dataclass(frozen=True, slots=True)
class Facts:
    """What a configuration says of a machine; `path` and `spindle` hold keys of the machine file."""

    control: str
    axes: tuple[AxisFacts, ...]
    left_out: tuple[LeftOut, ...] = ()
    path: Mapping[str, float | str] = field(default_factory=dict)
    spindle: Mapping[str, float | bool] = field(default_factory=dict)
    offsets: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    cycle_s: float | None = None
    tools: Mapping[int, Mapping[str, float | str]] = field(default_factory=dict)
    programs: Mapping[str, object] = field(default_factory=dict)
    remaps: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


def others(settings: Settings, reasons: Mapping[str, str]) -> tuple[LeftOut, ...]:
    """Return what nobody read: with its reason where there is one, the others together at the end."""
    told, rest = [], []
    for entry in settings.unread():
        if entry.name in reasons:
            told.append(LeftOut(f"{entry.name} = {entry.text}", reasons[entry.name]))
        else:
            rest.append(entry.name)
    if rest:
        told.append(LeftOut(", ".join(rest), "nothing here depends on it"))
    return tuple(told)
