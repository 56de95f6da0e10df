"""What a CPL program needs of the control that runs it, and what it hands over: blocks, calls and waits as values.

A program is a generator. It yields what the control has to do before it can go on, and is sent the answer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping
from dataclasses import dataclass, field
from typing import Any, Final, NamedTuple, Protocol, TypeAlias, runtime_checkable

from polycnc.nc.cpl._variables import Kind


class Omitted:
    """The class of OMITTED."""

    def __repr__(self) -> str:
        return "OMITTED"


OMITTED: Final = Omitted()
"""An argument that is left out between commas; one left out at the end is not passed at all."""


class Blocked:
    """The class of BLOCKED."""

    def __repr__(self) -> str:
        return "BLOCKED"


BLOCKED: Final = Blocked()
"""What a waiting function returns while it has no answer: time passes, then it is asked again."""


class Item(NamedTuple):
    """An argument of a command that depends on types: PRN#, DSP, MMC."""

    kind: Kind
    value: object


@dataclass(slots=True)
class Box:
    """A variable as an argument: what the function leaves in `value` is assigned to it (converted to its type)."""

    name: str
    kind: Kind
    value: object
    _given: object = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        self._given = self.value

    @property
    def is_set(self) -> bool:
        """Whether the function has set it."""
        return self.value is not self._given


class Lines(NamedTuple):
    """NC blocks without CPL from line `first` to line `last`: the control reads them where they stand."""

    first: int
    last: int


class BlockWord(NamedTuple):
    """A word of an NC block: address in capitals, extension (X1=10 has 1) or None, value, column from 1."""

    address: str
    extension: int | None
    value: float
    column: int


class NcValues(NamedTuple):
    """An NC block whose words were computed: line, N number or None, level of /, words, and text of (MSG,...)."""

    line: int
    number: int | None
    skip: int
    words: tuple[BlockWord, ...]
    message: str


class SubProgram(NamedTuple):
    """A sub-program call: address "" for CALL, else G, M or P; `unlinked` by the word DIN; `skip` as of `NcValues`."""

    line: int
    address: str
    name: str
    arguments: tuple[object, ...]
    unlinked: bool
    skip: int = 0


class Waiting(NamedTuple):
    """WAIT: drain the queue; with a condition or a duration, answer 0, 1 or 2 (cpl.WAIT.result)."""

    line: int
    condition: Callable[[], bool] | None
    duration_ms: int | None
    skip: int = 0


class Step(NamedTuple):
    """A line is about to be executed (only of programs linked for stepping)."""

    line: int


class Pause:
    """The class of PAUSE."""

    def __repr__(self) -> str:
        return "PAUSE"


PAUSE: Final = Pause()
"""Nothing to do, but let time pass: a loop has run for a while, or a function waits for its answer."""

Event: TypeAlias = Lines | NcValues | SubProgram | Waiting | Step | Pause
Running: TypeAlias = Iterator[Event]


class Host(Protocol):
    """The control as a CPL program sees it."""

    @property
    def permanent(self) -> MutableMapping[str, Any]:
        """Permanent variables by name ("@20", "@ABCD%", "@_R"): values, Fields and CharacterFields."""

    def function(self, name: str) -> Callable[..., object]:
        """Return what a function or command of the control does ("MPOS", "PRN#").

        It takes its arguments in their order, OMITTED for one left out in between; a variable that it sets as a Box, or
        as a Field or CharacterField where it is one; after its fixed ones, a `listed` command takes Items or Boxes,
        and `open=True` if a semicolon ends them. It returns its value (int, float, bool, str, or None for NUL), or
        raises a Fault.

        Raises:
            Fault: The control has no such function.
        """

    def setter(self, name: str) -> Callable[..., None]:
        """Return what an assignment to a system value does: ``IC(80,0,1)=TRUE`` calls it with TRUE, 80, 0, 1.

        Raises:
            Fault: It cannot be set.
        """

    def insert(self, value: object) -> tuple[tuple[str, int | None, float], ...]:
        """Return the words (address, extension, value) that a text or AXP() in brackets by itself stands for."""

    def program(self, address: str, name: str) -> tuple[str, str] | None:
        """Return name of file and text of a sub-program, None if there is none."""


@runtime_checkable
class KeepingHost(Protocol):
    """A control that says what of it is under way and cannot be kept in a snapshot."""

    def under_way(self) -> str:
        """Return what is, as "a file is open"; empty if nothing is."""
        ...


def wait_for(function: Callable[..., object], *arguments: object, **named: object) -> Any:
    """Call a function until it has an answer; for `yield from`."""
    while (answer := function(*arguments, **named)) is BLOCKED:
        yield PAUSE
    return answer
