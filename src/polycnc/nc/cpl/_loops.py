"""Tell loops without end: the program comes back to a state in which it was, and did nothing in between."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, MutableMapping
from typing import Any

from polycnc.nc.cpl._fields import Field
from polycnc.nc.cpl._functions import PATIENT, STEADY
from polycnc.nc.cpl._host import Host
from polycnc.nc.cpl._run import Execution
from polycnc.nc.cpl._strings import CharacterField, Part

_SIMPLE = (int, float, str, bool, type(None))


class WatchedHost:
    """A control that counts in `effects` what was done, and what may answer another time otherwise.

    Of these it counts in `asked` what somebody else may answer.
    """

    def __init__(self, host: Host) -> None:
        self._host = host
        self.effects = self.asked = 0

    @property
    def permanent(self) -> MutableMapping[str, Any]:
        """Return the permanent variables."""
        return self._host.permanent

    def function(self, name: str) -> Callable[..., object]:
        """Return a function of the control."""
        found = self._host.function(name)
        return found if name in STEADY else self._counted(found, asks=name in PATIENT)

    def setter(self, name: str) -> Callable[..., None]:
        """Return what an assignment does."""
        return self._counted(self._host.setter(name))

    def insert(self, value: object) -> tuple[tuple[str, int | None, float], ...]:
        """Return the words that something in brackets stands for."""
        return self._host.insert(value)

    def program(self, address: str, name: str) -> tuple[str, str] | None:
        """Return a sub-program."""
        return self._host.program(address, name)

    def _counted(self, function: Callable[..., Any], *, asks: bool = False) -> Callable[..., Any]:
        def call(*arguments: object, **named: object) -> Any:
            self.effects += 1
            self.asked += asks
            return function(*arguments, **named)

        return call


class LoopWatch:
    """Compare states of programs that only compute; each is kept for twice as many comparisons as the one before."""

    def __init__(self) -> None:
        self._kept: tuple[tuple[object, ...], tuple[object, ...]] | None = None
        self._left = 0
        self._power = 1
        self._since: tuple[int, int] | None = None

    def forget(self) -> None:
        """Begin anew: something has happened."""
        self._kept, self._left, self._power, self._since = None, 0, 1, None

    def only_computes(self, host: WatchedHost) -> bool:
        """Tell whether nothing was done, nor asked for that may be answered otherwise, since it was looked at first."""
        return self._since == (host.effects, host.asked)

    def asks_nobody(self, host: WatchedHost) -> bool:
        """Tell whether nothing was asked for that somebody else may answer, since it was looked at first."""
        return self._since is not None and self._since[1] == host.asked

    def repeats(
        self, host: WatchedHost, running: Iterable[Execution], shared: Iterable[Mapping[str, Any]]
    ) -> bool:
        """Tell whether the present state is one that was kept."""
        if self._since is None:
            self._since = host.effects, host.asked
        simple: list[object] = [host.effects]
        large: list[object] = []
        for values in (*(execution.state() for execution in running), *shared):
            for value in values.values():
                (simple if isinstance(value, _SIMPLE) else large).append(value)
        now = tuple(simple)
        if self._kept is not None and self._kept[0] == now and self._kept[1] == tuple(map(_frozen, large)):
            return True
        if not self._left:
            self._kept = now, tuple(map(_frozen, large))
            self._left = self._power
            self._power *= 2
        self._left -= 1
        return False


def _frozen(value: object) -> object:
    """Return the content of a field, or of a part of one."""
    if isinstance(value, Field):
        return tuple(map(_frozen, value.values()))
    if isinstance(value, CharacterField):
        return value.size, value.text
    if isinstance(value, Part):
        return id(value.field), value.begin, value.length, value.field.text
    return value
