"""M codes that say how the program goes on: calls of sub-programs, returns, stops and ends."""

from __future__ import annotations

from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._outcomes import NEXT, Continuation, Outcome
from polycnc.nc.blocks._words import whole_number
from polycnc.nc.modal._actions import MAction
from polycnc.nc.text._scan_plain import Word

_OUTCOMES = {
    MAction.PROGRAM_END: Outcome(Continuation.END),
    MAction.PROGRAM_STOP: Outcome(Continuation.STOP),
    MAction.OPTIONAL_STOP: Outcome(Continuation.STOP),
    MAction.SUB_RETURN: Outcome(Continuation.RETURN),
}


def outcome(block: BlockContext) -> Outcome:
    """Return how the program goes on by the M codes of a block."""
    for m in block.words.m:
        if m.action is MAction.SUB_CALL:
            return _call(block, f"M{m.code}", m.word)
        if m.action is MAction.SUB_RETURN and "P" in block.words.by_letter:
            raise block.problem(
                f"M{m.code} P: a return to a block number cannot be carried out",
                "Remove P, or call another sub-program.",
                block.words.by_letter["P"],
            )
        if m.action in _OUTCOMES:
            return _OUTCOMES[m.action]
    return NEXT


def _call(block: BlockContext, code: str, at: Word) -> Outcome:
    p_word, l_word = block.words.take("P"), block.words.take("L")
    if p_word is None:
        raise block.problem(f"{code} without a sub-program", "Add P and the number of the sub-program.", at)
    program = whole_number(p_word, "the number of a program", block.problem)
    repeats = 1 if l_word is None else whole_number(l_word, "a number of repetitions", block.problem)
    if l_word is None and program > 9999 and block.dialect.sub_program.repeats_in_p:
        repeats, program = divmod(program, 10_000)
    if problem := block.rules.call_problem(program, block.text, p_word.place):
        what, hint, number = problem
        error = block.problem(what, hint, p_word)
        error.code = number
        raise error
    return Outcome(Continuation.CALL, program, repeats)
