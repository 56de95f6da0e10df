"""How a program goes on behind a block: calls of sub-programs, returns, stops and ends."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from polycnc.nc.blocks._auxiliary import whole_number
from polycnc.nc.blocks._words import BlockWords, Fail
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import MAction
from polycnc.nc.text._place import Place
from polycnc.nc.text._scan_plain import Word

Trouble = tuple[str, str, str]
"""What is wrong, what to do and its code, of something that is not a matter of the block's words alone."""


class Control(Enum):
    """What comes after a block."""

    NEXT = "next"
    CALL = "call"
    RETURN = "return"
    STOP = "stop"
    END = "end"
    GO_ON = "go on"


@dataclass(frozen=True, slots=True)
class Outcome:
    """Say how the program goes on; a call names the sub-program and how often it runs, GO_ON a place."""

    control: Control = Control.NEXT
    program: int = 0
    repeats: int = 1
    place: Place | None = None


NEXT = Outcome()
JUMPS = (MAction.SUB_CALL, MAction.SUB_RETURN)  # never leave the control
_OUTCOMES = {
    MAction.PROGRAM_END: Outcome(Control.END),
    MAction.PROGRAM_STOP: Outcome(Control.STOP),
    MAction.OPTIONAL_STOP: Outcome(Control.STOP),
    MAction.SUB_RETURN: Outcome(Control.RETURN),
}


class Outcomes:
    """Say how the program goes on; `call_trouble` says what is against a call from an offset, None if nothing is."""

    def __init__(
        self, dialect: Dialect, fail: Fail, call_trouble: Callable[[int, int], Trouble | None]
    ) -> None:
        self._dialect = dialect
        self._fail = fail
        self._call_trouble = call_trouble

    def outcome(self, words: BlockWords) -> Outcome:
        """Return how the program goes on by the M codes of a block."""
        for m in words.m:
            if m.action is MAction.SUB_CALL:
                return self._call(words, f"M{m.code}", m.word)
            if m.action is MAction.SUB_RETURN and "P" in words.by_letter:
                raise self._fail(
                    f"M{m.code} P: a return to a block number cannot be carried out",
                    "Take P out, or call another sub-program.",
                    words.by_letter["P"],
                )
            if m.action in _OUTCOMES:
                return _OUTCOMES[m.action]
        return NEXT

    def _call(self, words: BlockWords, code: str, at: Word) -> Outcome:
        p_word, l_word = words.take("P"), words.take("L")
        if p_word is None:
            raise self._fail(f"{code} without a sub-program", "Add P and the number of the sub-program.", at)
        program = whole_number(p_word, "the number of a program", self._fail)
        repeats = 1 if l_word is None else whole_number(l_word, "a number of repetitions", self._fail)
        if l_word is None and program > 9999 and self._dialect.sub_program.repeats_in_p:
            repeats, program = divmod(program, 10_000)
        if trouble := self._call_trouble(program, p_word.place):
            what, hint, number = trouble
            error = self._fail(what, hint, p_word)
            error.code = number
            raise error
        return Outcome(Control.CALL, program, repeats)
