"""One execution of a program: what its Python gives next, its errors at their places, where it stands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from polycnc.errors import ProgramError
from polycnc.language._python import Traced, frame_of
from polycnc.language._resume import INNER, Suspended, inner_of, line_of, names_of, resumed

Explain = Callable[[Exception, int], ProgramError]


class Fault(Exception):  # noqa: N818 (never leaves the languages: an execution makes a ProgramError of it)
    """Something that goes wrong while a program runs: what is wrong, what to do, the control's own number.

    Who raises it need not know where in the program.
    """

    def __init__(self, what: str, hint: str = "", code: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.hint = hint
        self.code = code


class Execution:
    """A generator that the Python of a program makes.

    `names` are what it knows of Python, `arguments` what its function takes; `explain` makes the error of one that was
    raised at a place in the program.
    """

    def __init__(
        self,
        traced: Traced[int],
        names: Mapping[str, object],
        arguments: tuple[object, ...],
        explain: Explain,
    ) -> None:
        self._traced = traced
        self._names = names
        self._arguments = arguments
        self._explain = explain
        self._generator = self._made(traced)

    def _made(self, traced: Traced[int], *more: object) -> Suspended:
        return traced.load(self._names)["program"](*self._arguments, *more)

    def next(self, answer: object = None) -> Any:
        """Return what the program gives next, None at its end; `answer` is that to what it gave last.

        Raises:
            ProgramError: The program does what it must not.
        """
        try:
            return self._generator.send(answer)
        except StopIteration:
            return None
        except (Fault, ArithmeticError, TypeError, ValueError) as error:
            frame = frame_of(error, {self._traced.name: self._traced}.get)
            if frame is None:
                raise
            raise self._explain(error, frame.place) from error

    def close(self) -> None:
        """End the program."""
        self._generator.close()

    # ------------------------------------------------------------------ where it stands

    @property
    def at(self) -> int | None:
        """The place in the program of what is executed, None at its end."""
        frame = self._generator.gi_frame
        return None if frame is None else self._traced.places[frame.f_lineno - 1]

    @property
    def place(self) -> int | None:
        """The line of its Python at which it stands, 0 before the first and None at the end: what `go_on` takes."""
        return line_of(self._generator)

    @property
    def names(self) -> dict[str, Any]:
        """The names of its Python."""
        return names_of(self._generator)

    @property
    def inner(self) -> object:
        """The iterator that it gives from now, None if it gives by itself."""
        return inner_of(self._generator)

    def state(self) -> dict[str, object]:
        """Return its names and its very place; of one that has ended nothing."""
        frame = self._generator.gi_frame
        return {} if frame is None else {**frame.f_locals, "": frame.f_lasti}

    def go_on(self, traced: Traced[int] | None, names: Mapping[str, object], inner: object = None) -> Any:
        """Stand where another execution stood: `traced` is what `standing` has made, `names` and `inner` were its own.

        Return what it gives there, if it stands at a `yield` that is executed anew.
        """
        self._generator.close()
        if traced is None:
            return None
        if traced is self._traced:
            self._generator = self._made(traced)
            return None
        given = dict(names) if inner is None else {**names, INNER: inner}
        self._generator = self._made(traced, given)
        return next(self._generator)


def standing(
    traced: Traced[int], place: int | None, names: Mapping[str, object], *, again: bool = False
) -> Traced[int] | None:
    """Return the code of an execution that stands at a place, None at the end; see `resumed`.

    Raises:
        ValueError: It cannot stand there.
    """
    if place is None:
        return None
    return resumed(traced, place, names, again=again) if place else traced
