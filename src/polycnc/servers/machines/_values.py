"""Parameters and variables of a machine, by their names, as its doors list, read and set them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from polycnc.cnc import ControlError, Refusal

Single: TypeAlias = bool | int | float | str | None
"""One value; None where there is none (a vacant variable)."""


@dataclass(frozen=True, slots=True)
class NamedValue:
    """A value: a single one, one for each axis by name, or several in their order.

    `low` and `high` bound numbers, `choices` are the words that can be set.
    """

    name: str
    value: Single | Mapping[str, Single] | Sequence[Single]
    what: str = ""
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()
    writable: bool = True


class Values(Protocol):
    """Values by name; refusals are `ControlError`."""

    def all(self) -> Iterable[NamedValue]:
        """Return all that have a value."""

    def get(self, name: str) -> NamedValue:
        """Return one.

        Raises:
            ControlError: There is none of this name.
        """

    def set(self, name: str, value: Single | Mapping[str, Single]) -> None:
        """Set one, some of its axes if it has one for each.

        Raises:
            ControlError: There is none of this name, it cannot be set, or not to this; nothing has changed.
        """


@dataclass(frozen=True, slots=True)
class NoValues:
    """A machine has none of this kind."""

    what: str

    def all(self) -> Iterable[NamedValue]:
        """Refuse it."""
        raise self._refusal()

    def get(self, name: str) -> NamedValue:
        """Refuse it."""
        raise self._refusal()

    def set(self, name: str, value: object) -> None:
        """Refuse it."""
        raise self._refusal()

    def _refusal(self) -> ControlError:
        return ControlError(
            Refusal.NOT_FOUND, f"this machine has no {self.what}", hint="Ask for its status or inventory."
        )


NO_PARAMETERS, NO_VARIABLES, NO_SIGNALS = map(NoValues, ("parameters", "variables", "signals"))


@dataclass(frozen=True, slots=True)
class ReadValues:
    """Values that can only be read."""

    what: str
    read: Callable[[], Mapping[str, object]]

    def all(self) -> Iterable[NamedValue]:
        """Return all of them."""
        return [NamedValue(name, _plain(value), writable=False) for name, value in self.read().items()]

    def get(self, name: str) -> NamedValue:
        """Return one."""
        found = self.read()
        if name not in found:
            raise no_such(self.what, name)
        return NamedValue(name, _plain(found[name]), writable=False)

    def set(self, name: str, value: object) -> None:
        """Refuse it."""
        self.get(name)
        raise ControlError(
            Refusal.PROTECTED, f"{self.what} '{name[:40]}' can only be read", hint="Set it in a program."
        )


def no_such(what: str, name: str) -> ControlError:
    """Return the refusal of a name."""
    return ControlError(Refusal.NOT_FOUND, f"there is no {what} '{name[:40]}'", hint="See the list of them.")


def _plain(value: object) -> Single | tuple[Single, ...]:
    """Return a value as doors can write it."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Sequence) and not isinstance(value, bytes):
        return tuple(each if isinstance(each, bool | int | float | str) else str(each) for each in value)
    return str(value)
