"""The seam for languages inside part programs: ready-made blocks instead of text.

A channel reads a program as text unless its `Language` gives a `BlockSource` for it. A source is asked for one
item after the other with `next`, never earlier than the channel needs it, so an expression is evaluated when its
block is prepared:

- `WordsBlock`: an NC block whose words are values already. It goes to the interpreter as it is, no text is made
  of it, and its record points at the line of the source.
- `TextSpan`: some lines of plain NC text. They are read by the channel as if there were no language, through the
  compiled kernel where they are long; so a language hands over what holds no expression, in pieces as long as
  possible. A source that knows `word_values` may leave words in there whose numbers are single variables.
- `Drain`: preparation stops until everything before it has been executed; then `next` is called again. What a
  language reads in that next call (positions, system variables, answers of the PLC) is read after the drain.
  Radius compensation emits the move that it holds back.
- `CallProgram`: a sub-program with arguments, for calls that no M code makes. The language is asked for the
  source of the program that is called and gets the arguments. The caller's `next` is called again after the
  return.
- `EndSource`: `RETURN` ends the present program as an M99 would, `END` everything. `None` is a RETURN in a
  sub-program, an END in the main program.
- `Statement`: a statement of its own line has been executed. Only for stepping and breakpoints; a source that gives
  none is stepped from NC block to NC block.

A statement is no item: a source executes as many of them as it likes inside `next`. But a source must not run
for ever in there; one that loops without a block gives a `Pause` now and then, so that whoever runs the channel
can break off. `next` may raise `ProgramError` with its position: the block is refused like any other.

A block of words that calls (M98) or returns (M99) does the same as in a text. A source that enters sub-programs by
itself puts their text and the calls that led there (`calls`, the outermost first, those of the channel not among
them) into its items, and is asked by `leave` whether a return is its own affair. `close` is called exactly once, when
the program of a source is left, however that comes about; local variables end there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Protocol, TypeAlias, TypeVar, runtime_checkable

from polycnc.machine import SnapshotError
from polycnc.nc.records._block_records import Call
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan_plain import Block, Word

HostT = TypeVar("HostT", contravariant=True)
"""What a language asks of the channel that it works for, as a protocol of its own."""


@dataclass(frozen=True, slots=True)
class WordsBlock:
    """An NC block of line `line`; `offset` is where the line begins, `message` an operator message beside it.

    The `place` of each word is a byte offset in the program text: that is where errors point. `skip_level` is that of
    a skip mark. `text` is the program it stands in, the one that the source was made for if None. `profile` are the
    lines of the sub-program whose profile the block cuts.
    """

    words: tuple[Word, ...]
    line: int
    offset: int
    message: str = ""
    skip_level: int = 0
    text: ProgramText | None = None
    calls: tuple[Call, ...] = ()
    profile: tuple[Block, ...] | None = None


@dataclass(frozen=True, slots=True)
class TextSpan:
    """The lines from byte `offset` (the beginning of line `line`) to byte `end`, plain NC text."""

    offset: int
    line: int
    end: int
    text: ProgramText | None = None
    calls: tuple[Call, ...] = ()


@dataclass(frozen=True, slots=True)
class Drain:
    """Wait until everything before has been executed; `line` is the line that asks for it."""

    line: int
    text: ProgramText | None = None
    calls: tuple[Call, ...] = ()


@dataclass(frozen=True, slots=True)
class Statement:
    """A statement on `line` that has been executed, to be stepped to."""

    line: int
    text: ProgramText | None = None
    calls: tuple[Call, ...] = ()


@dataclass(frozen=True, slots=True)
class CallProgram:
    """Call sub-program `program` `repeats` times from line `line`; `arguments` are handed to its source.

    A language that finds its sub-programs itself gives the text instead of a number.
    """

    program: int | ProgramText
    line: int
    offset: int
    repeats: int = 1
    arguments: object = None


class EndSource(Enum):
    """How a source ends its program before its text ends."""

    RETURN = "return"
    END = "end"


class Pause(Enum):
    """Nothing for now: the source goes on when it is asked again."""

    PAUSE = "pause"


SourceItem: TypeAlias = WordsBlock | TextSpan | Drain | Statement | CallProgram | EndSource | Pause


class BlockSource(Protocol):
    """One execution of one program by a language."""

    def next(self) -> SourceItem | None:
        """Return what comes next, None at the end of the program.

        Raises:
            ProgramError: a statement that cannot be executed.
        """
        ...

    def leave(self) -> bool:
        """Leave the innermost program that the source has entered by itself, False if there is none (M99)."""
        ...

    def failed(self) -> None:
        """Take note that a block has an error, so that nothing more is asked for until the program is left."""
        ...

    def close(self) -> None:
        """Take note that the program has been left."""
        ...


class WordValues(Protocol):
    """What words stand for whose numbers are variables or expressions, in the text spans of one program."""

    def value(self, letter: str, text: str, place: int) -> float | None:
        """Return the number of a word, written as `text` after the letter at byte `place`; None: it does not count.

        Nothing that it reads may be changed by the blocks of a span, but by the programs that they call.

        Raises:
            ProgramError: it has none now.
        """
        ...


@runtime_checkable
class OpenSource(Protocol):
    """A source whose text spans may hold words like F#101 or X[A]."""

    @property
    def word_values(self) -> WordValues:
        """What such words stand for."""
        ...


class Language(Protocol):
    """What turns programs into block sources."""

    def source(self, text: ProgramText, offset: int, line: int, arguments: object) -> BlockSource | None:
        """Return a source for the program that begins at byte `offset`, None where plain text needs none.

        `arguments` is what `CallProgram` gave, else None. It is called anew for every repetition.

        Raises:
            ProgramError: the program cannot be translated.
        """
        ...


@runtime_checkable
class TidyLanguage(Language, Protocol):
    """A language that keeps what it has translated."""

    def tidy(self) -> None:
        """Keep no more of that than a bounded amount: there is no end of texts."""
        ...


@runtime_checkable
class FastForwardLanguage(Language, Protocol):
    """A language whose programs may wait for time to pass."""

    fast_forward: bool
    """Whether no time passes: what waits for it goes on at once."""

    def loops(self) -> bool:
        """Tell whether programs have come back to a state in which they were when this was asked before."""
        ...

    def moves_on(self) -> None:
        """Take note that something has happened since `loops` was asked."""
        ...


@runtime_checkable
class KeepingLanguage(Language, Protocol):
    """A language with values that outlive a program, in a file."""

    def kept_text(self) -> str:
        """Return the text of that file."""
        ...


@runtime_checkable
class BoundedLanguage(Language, Protocol):
    """A language whose programs may begin and end at blocks that are given."""

    def begin_between(self, first: int, last: int) -> None:
        """Let the main program that comes next look out for line `first`, and end after line `last` (0: its last)."""
        ...


@runtime_checkable
class SearchingLanguage(Language, Protocol):
    """A language whose programs may begin at another line than their first."""

    def source_at(self, text: ProgramText, offset: int, line: int, start: int) -> BlockSource | None:
        """Return what `source` does, but for beginning at byte `start`, the beginning of a line.

        Raises:
            ProgramError: the program cannot be translated, or cannot begin there.
        """
        ...


Returning: TypeAlias = Callable[[], Sequence[tuple[object, BlockSource | None]]]
"""What puts a language back to where it stood; it returns arguments and source of each program under way."""


@runtime_checkable
class LastingLanguage(Language, Protocol[HostT]):
    """A language that can tell where its programs stand, and go on from there.

    What it tells is a value of `classes` and of plain ones.
    """

    @property
    def classes(self) -> Sequence[type]:
        """The dataclasses, named tuples and enumerations in what `save` returns."""
        ...

    def save(self, under_way: Sequence[tuple[object, BlockSource | None]]) -> object:
        """Return all that it holds, with each program under way: its arguments and its source, the main one first.

        Raises:
            SnapshotError: What a program does now cannot be kept.
        """
        ...

    def restore_point(self, channel: HostT, saved: object) -> Returning:
        """Return what goes back to a state, for a channel that it is attached to by then; nothing changes yet.

        Raises:
            SnapshotError: The programs of the state cannot go on from there.
        """
        ...


@runtime_checkable
class BoundLanguage(Language, Protocol[HostT]):
    """A language that reads the state of the channel it works for."""

    def attach(self, channel: HostT) -> None:
        """Take the channel, before it begins."""
        ...


def elsewhere(text: ProgramText) -> SnapshotError:
    """Return the refusal of a snapshot in which a program stands where it cannot go on."""
    return SnapshotError(f"{text.name} cannot go on where the snapshot says", hint="use another snapshot")
