"""The flow machine: choices, loops, marks and jumps of any language as Python, which has no jump.

The compiler of a language is the `Words`: it writes its own statements and conditions into the same `Emitter`. The
flow machine writes what is around them. A body that jumps lead into becomes a *region*: a loop over its pieces, of
which `at` says which one is next; a jump sets it and goes on with that loop, through the loops in between (`go` says
how far). Every round and every jump back counts, by itself or with the work that it comes back over, and after so much
the program gives a `PAUSE`; a round over nothing that changes anything waits, and gives one at once.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Hashable, Sequence
from contextlib import ExitStack
from typing import Any, Protocol, TypeAlias

from polycnc.language._flow_tree import Again, Choice, Jump, Leave, Loop, Mark, Plan
from polycnc.language._python import Emitter, Piece

_GROUP = 32
_LEAP_WORK = 50  # at most, where what it comes back over is not known
_LEAP_ROUNDS = 10  # what a leap counts where rounds count the same: the mark has to be found
_LABEL = re.compile("\x01([0-9]+)\x01")  # no text constant holds it: repr() writes it otherwise


Weigh: TypeAlias = Callable[[Sequence[str]], int]


class Words(Protocol):
    """What a language knows: its statements and conditions, which it writes where it is asked."""

    def before(self, statement: Any) -> None:
        """Write what comes before any statement, those of the flow too: a step of a debugger."""
        ...

    def statement(self, statement: Any) -> None:
        """Write a statement that is no flow; jumps may be part of it."""
        ...

    def condition(self, structure: Any, number: int) -> str | None:
        """Return the condition of a branch, or of a round (number 0), None for none; write what it needs before."""
        ...

    def begin(self, structure: Any) -> None:
        """Write what comes once, before a choice or a loop."""
        ...

    def end(self, loop: Any) -> str | None:
        """Write what a round ends with; return the Python condition under which the loop ends there.

        The place of the emitter then is that of a pause.
        """
        ...


class _Around:
    """A Python loop around what is written: what jumps out of an inner one do here, by their number."""

    def __init__(self, loop: Loop | None) -> None:
        self.loop = loop
        self.actions: dict[int, str] = {}
        self.passing: set[int] = set()
        """The numbers of the jumps that lead out of it."""


class _Region:
    """A body in pieces, with the loop that executes them."""

    def __init__(self, number: int, around: _Around) -> None:
        self.number = number
        self.around = around
        self.pieces: list[Piece[Any]] = []


class _Rounds:
    """Count rounds with what they come back over, and write their pauses (see `Flow`)."""

    def __init__(
        self, out: Emitter[Any], rounds: int, weigh: Weigh | None, changes: Callable[[], int] | None
    ) -> None:
        self.work = 0  # of all that is written
        self._out = out
        self._most = rounds
        self._weigh = weigh
        self._changes = changes
        self._begun: dict[
            int, tuple[int, int]
        ] = {}  # work and changes before labels, and loops by their identity

    def add(self, lines: Sequence[str]) -> None:
        """Add the work of lines."""
        if self._weigh is not None:
            self.work += self._weigh(lines)

    def begin(self, key: int) -> None:
        """Take note that a label or a loop begins."""
        self._begun[key] = self.work, 0 if self._changes is None else self._changes()

    def end(self, key: int) -> None:
        """Write the count of a round that comes back to a label or a loop."""
        work, changes = self._begun[key]
        if self._changes is not None and self._changes() == changes:
            self._out.put(f"n = {self._most}", "yield PAUSE")
        else:
            self.count(1 if self._weigh is None else 1 + self.work - work)

    def leap(self) -> None:
        """Write the count of a jump whose place is calculated."""
        self.count(_LEAP_ROUNDS if self._weigh is None else min(1 + self.work, _LEAP_WORK))

    def count(self, work: int) -> None:
        """Write that so much was done."""
        self._out.put(f"n -= {work}")
        with self._out.block("if n < 0:"):
            self._out.put(f"n = {self._most}", "yield PAUSE")


class Flow:
    """Write a program with its flow; a pause comes after `rounds` rounds and jumps back.

    With `weigh`, which tells how much lines of Python do, a round counts as much as what it comes back over. `changes`
    counts what has been written that changes something: a round over none of it is a wait, with a pause of its own.
    """

    def __init__(
        self,
        out: Emitter[Any],
        words: Words,
        *,
        rounds: int,
        weigh: Weigh | None = None,
        changes: Callable[[], int] | None = None,
    ) -> None:
        self.places: dict[Hashable, tuple[int, int]] = {}
        """Region and piece of each mark, when all is written: what `leap` is given."""
        self._out = out
        self._words = words
        self._rounds = rounds
        self._turns = _Rounds(out, rounds, weigh, changes)
        self._count = 0
        self._around: list[_Around] = []
        self._regions: list[_Region] = []
        self._labels: dict[Hashable, tuple[int, _Region]] = {}
        self._numbers: dict[int, int] = {}  # of the piece that each label begins
        self._apart: dict[int, tuple[int, int, _Region]] = {}  # labels of loops: next round, end

    def write(
        self, statements: list[Any], *, used: Collection[Hashable] | None = None, begin: Hashable = None
    ) -> None:
        """Write the body of a program: its places in Python are the generator's that is written now.

        Only marks of `used` count, None for all. The program begins at the mark `begin`, if there is one, which has to
        be outside of all structures.
        """
        out = self._out
        self._plan = Plan(statements, used)
        out.put(f"n = {self._rounds}", "go = -1")
        start = len(out.lines)
        self._body(statements, begin)
        self.places = {
            key: (region.number, self._numbers[label]) for key, (label, region) in self._labels.items()
        }
        if self._numbers:
            numbers = self._numbers
            out.lines[start:] = [
                _LABEL.sub(lambda found: str(numbers[int(found[1])]), line) if "\x01" in line else line
                for line in out.lines[start:]
            ]

    def reaches(self, key: Hashable) -> bool:
        """Tell whether what is written now can jump to a mark: it is in no structure that is not around."""
        found = self._labels.get(key)
        return found is not None and found[1] in self._regions

    def jump(self, key: Hashable) -> None:
        """Write a jump to a mark."""
        label, region = self._labels[key]
        if label in self._numbers:
            self._turns.end(label)
        self._go(region, f"\x01{label}\x01")

    def leap(self, place: str) -> None:
        """Write a jump to what `place` is when it is executed, one of `places`; what follows refuses any other."""
        self._out.put(f"to, k = {place}")
        for region in reversed(self._regions):
            with self._out.block(f"if to == {region.number}:"):
                self._turns.leap()
                self._go(region, "k")

    # ------------------------------------------------------------------ bodies

    def _body(self, statements: list[Any], begin: Hashable = None) -> None:
        """Write a body that stays one: straight, or as a region."""
        if id(statements) not in self._plan.regions:
            self._statements(statements)
            return
        out = self._out
        around = _Around(None)
        region = _Region(self._new_number(), around)
        around.actions[region.number] = "continue"
        for key in self._plan.regions[id(statements)]:
            self._labels[key] = self._new_number(), region
        self._around.append(around)
        self._regions.append(region)
        out.divert()
        self._statements(statements)
        region.pieces.append(out.diverted())
        self._regions.pop()
        first = 0 if begin is None else self._numbers[self._labels[begin][0]]
        out.put(f"at{region.number} = {first}")
        with out.block("while True:"):
            self._put_pieces(f"at{region.number}", region.pieces)
            out.put("break")
        self._leave_loop()

    def _put_pieces(self, at: str, pieces: Sequence[Piece[Any]]) -> None:
        out = self._out
        for first in range(0, len(pieces), _GROUP):
            group = pieces[first : first + _GROUP]
            with ExitStack() as inside:
                if len(pieces) > _GROUP:
                    inside.enter_context(out.block(f"if {at} < {first + len(group)}:"))
                for number, piece in enumerate(group, first):
                    with out.block(f"if {at} <= {number}:"):
                        out.take(piece)

    def _statements(self, statements: list[Any]) -> None:
        out, words = self._out, self._words
        for statement in statements:
            out.place = statement.at
            words.before(statement)
            if isinstance(statement, Choice):
                words.begin(statement)
                (self._parts_of_choice if id(statement) in self._plan.apart else self._choice)(statement)
            elif isinstance(statement, Loop):
                words.begin(statement)
                (self._parts_of_loop if id(statement) in self._plan.apart else self._loop)(statement)
            elif isinstance(statement, Mark):
                if (label := self._labels.get(statement.key)) is not None:
                    self._mark(label[0])
            elif isinstance(statement, Jump):
                self.jump(statement.target)
            elif isinstance(statement, (Leave, Again)):
                self._end_of_loop(statement)
            else:
                before = len(out.lines)
                words.statement(statement)
                self._turns.add(out.lines[before:])

    def _condition(self, structure: Any, number: int) -> str | None:
        before = len(self._out.lines)
        test = self._words.condition(structure, number)
        self._turns.add([*self._out.lines[before:], test or ""])
        return test

    def _end(self, loop: Loop) -> str | None:
        before = len(self._out.lines)
        ends = self._words.end(loop)
        self._turns.add([*self._out.lines[before:], ends or ""])
        return ends

    # ------------------------------------------------------------------ structures

    def _choice(self, choice: Choice) -> None:
        out = self._out
        with ExitStack() as inside:
            keyword = "if"
            for number, body in enumerate(choice.bodies):
                out.divert()
                test = self._condition(choice, number)
                before = out.diverted()
                if before.lines:
                    if number:
                        inside.enter_context(out.block("else:"))
                        keyword = "if"
                    out.take(before)
                if test is not None:
                    head = f"{keyword} {test}:"
                elif number and not body:
                    continue
                else:
                    head = "else:" if keyword == "elif" else "if True:"
                with out.block(head):
                    self._body(body)
                keyword = "elif"

    def _parts_of_choice(self, choice: Choice) -> None:
        out, end = self._out, self._new_number()
        places = [self._new_number() for _ in choice.bodies]
        for number, place in enumerate(places):
            test = self._condition(choice, number)
            if test is None:
                self._next(place)
                break
            with out.block(f"if {test}:"):
                self._next(place)
        else:
            self._next(end)
        for place, body in zip(places, choice.bodies, strict=True):
            self._mark(place)
            self._statements(body)
            self._next(end)
        self._mark(end)

    def _loop(self, loop: Loop) -> None:
        out = self._out
        self._turns.begin(id(loop))
        out.divert()
        test = self._condition(loop, 0)
        before = out.diverted()
        self._around.append(_Around(loop))
        with out.block("while True:" if test is None or before.lines else f"while {test}:"):
            if before.lines:
                out.take(before)
                if test is not None:
                    out.put(f"if not ({test}): break")
            self._body(loop.body)
            if (ends := self._end(loop)) is not None:
                out.put(f"if {ends}: break")
            self._turns.end(id(loop))
        self._leave_loop()

    def _parts_of_loop(self, loop: Loop) -> None:
        out = self._out
        begin, close, end = (self._new_number() for _ in range(3))
        self._apart[id(loop)] = close if loop.closes else begin, end, self._regions[-1]
        self._mark(begin)
        self._turns.begin(id(loop))
        if (test := self._condition(loop, 0)) is not None:
            with out.block(f"if not ({test}):"):
                self._next(end)
        self._statements(loop.body)
        if loop.closes:
            self._mark(close)
        if (ends := self._end(loop)) is not None:
            with out.block(f"if {ends}:"):
                self._next(end)
        self._turns.end(id(loop))
        self._next(begin)
        self._mark(end)

    def _end_of_loop(self, statement: Leave | Again) -> None:
        ends = isinstance(statement, Leave)
        if not ends:
            self._turns.end(id(statement.loop))
        if apart := self._apart.get(id(statement.loop)):
            close, end, region = apart
            self._go(region, f"\x01{end if ends else close}\x01")
            return
        (around,) = (each for each in self._around if each.loop is statement.loop)
        action = "break" if ends else "continue"
        number = next((n for n, each in around.actions.items() if each == action), None)
        if number is None:
            number = self._new_number()
            around.actions[number] = action
        self._out_to(around, number)

    # ------------------------------------------------------------------ jumps

    def _new_number(self) -> int:
        self._count += 1
        return self._count

    def _mark(self, label: int) -> None:
        """Begin a piece that `label` leads to."""
        pieces = self._regions[-1].pieces
        if self._out.lines:
            pieces.append(self._out.diverted())
            self._out.divert()
        self._numbers[label] = len(pieces)
        self._turns.begin(label)

    def _next(self, label: int) -> None:
        """Go on at a label of the present region, which is in no loop."""
        self._out.put(f"at{self._regions[-1].number} = \x01{label}\x01", "continue")

    def _go(self, region: _Region, place: str) -> None:
        self._out.put(f"at{region.number} = {place}")
        self._out_to(region.around, region.number)

    def _out_to(self, around: _Around, number: int) -> None:
        """Leave the loops inside of one; there the action of the number is executed."""
        if self._around[-1] is around:
            self._out.put(around.actions[number])
            return
        self._around[-1].passing.add(number)
        self._out.put(f"go = {number}", "break")

    def _leave_loop(self) -> None:
        """Go on with jumps out of the loop that ends here."""
        passing = self._around.pop().passing
        if not passing:
            return
        outer = self._around[-1]
        for number in sorted(passing & outer.actions.keys()):
            with self._out.block(f"if go == {number}:"):
                self._out.put("go = -1", outer.actions[number])
        if passing := passing - outer.actions.keys():
            outer.passing |= passing
            with self._out.block("if go >= 0:"):
                self._out.put("break")
