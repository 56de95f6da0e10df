"""Tell what a block of words is: a call of a program, the end of one, or words with something to calculate."""

from __future__ import annotations

from polycnc.language import Flaw
from polycnc.nc.macro._calls import ARGUMENTS_I, MacroCalls, argument_numbers
from polycnc.nc.macro._syntax import (
    Address,
    Cancel,
    Expression,
    Goto,
    Interrupt,
    MacroCall,
    Number,
    Restart,
    Statement,
    SubCall,
    Words,
)

_INTERRUPT_ON, _INTERRUPT_OFF = 96.0, 97.0
_MACRO_CALL, _MODAL_CALL, _MODAL_CALL_EACH, _CANCEL_MODAL = 65.0, 66.0, 66.1, 67.0
_RETURN = 99.0


def misplaced(at: int, what: str, hint: str) -> Flaw:
    """Return the flaw of a statement that is not as the language has it (PS0125)."""
    return Flaw(at, what, hint, code="PS0125")


class CallReader:
    """Read the words of a block; `calls` are the codes that call programs, `repeats` lets M99 begin anew."""

    def __init__(self, calls: MacroCalls, repeats: bool) -> None:
        self._calls = calls
        self._repeats = repeats

    def statement(self, at: int, words: list[Address]) -> Statement:
        """Return what a block of these words is: a call, an end of a program, or words to calculate.

        Raises:
            Flaw: Words stand together that cannot.
        """
        for index, word in enumerate(words):
            code = _constant(word.value)
            if word.letter == "G" and code is not None:
                if code in (_MACRO_CALL, _MODAL_CALL, _MODAL_CALL_EACH):
                    return self._macro_call(code, index, words)
                if code == _CANCEL_MODAL:
                    return Cancel(word.at, tuple(words[:index] + words[index + 1 :]))
                if code in self._calls.g:
                    return self._by_code(word, self._calls.g[code], index, words)
            if word.letter == "M" and code is not None:
                if code == _RETURN:
                    return self._return(word, words)
                if code in (_INTERRUPT_ON, _INTERRUPT_OFF):
                    return self._interrupt(word, code, words)
                if code in self._calls.m:
                    return self._by_code(word, self._calls.m[int(code)], index, words)
                if code in self._calls.m_sub:
                    return self._sub_call(word, self._calls.m_sub[int(code)], words)
            if word.letter == "T" and self._calls.t is not None:
                return self._sub_call(word, self._calls.t, words, word.value)
        return Words(at, tuple(words))

    def _return(self, word: Address, words: list[Address]) -> Statement:
        target = next((each for each in words if each.letter == "P"), None)
        others = [each for each in words if each is not word and each is not target]
        if target is None:
            return Restart(word.at) if self._repeats and not others else Words(words[0].at, tuple(words))
        if others:
            raise misplaced(
                others[0].at, "M99 P and other words in one block", "Write them in a block before."
            )
        return Goto(word.at, target.value, returns=True)

    def _macro_call(self, code: float, index: int, words: list[Address]) -> MacroCall:
        word = words[index]
        program = repeats = None
        arguments = []
        for each in words[index + 1 :]:
            if each.letter == "P" and program is None:
                program = each.value
            elif each.letter == "L" and repeats is None:
                repeats = each.value
            else:
                arguments.append(each)
        if program is None:
            raise Flaw(
                word.at,
                f"G{code:g} without P",
                f"Write G{code:g} P and the number of the macro.",
                code="PS0076",
            )
        if index:
            raise misplaced(
                words[0].at,
                f"words before G{code:g}",
                f"G{code:g} comes first: all other words are arguments.",
            )
        every = code == _MODAL_CALL_EACH
        if every and arguments:
            raise misplaced(
                arguments[0].at,
                "arguments beside G66.1",
                "The words of the blocks that follow are the arguments.",
            )
        argument_numbers(arguments)
        return MacroCall(
            word.at, program, repeats, tuple(arguments), modal=every or code == _MODAL_CALL, each=every
        )

    def _interrupt(self, word: Address, code: float, words: list[Address]) -> Interrupt:
        program = next((each.value for each in words if each.letter == "P"), None)
        others = [each for each in words if each is not word and each.value is not program]
        if code == _INTERRUPT_ON and program is None:
            raise Flaw(word.at, "M96 without P", "Write M96 P and the number of the program.", code="PS0076")
        if others or (code == _INTERRUPT_OFF and program is not None):
            at = others[0].at if others else word.at
            raise misplaced(at, f"M{code:g} and other words in one block", "Write them in a block before.")
        return Interrupt(word.at, program)

    def _by_code(self, word: Address, program: int, index: int, words: list[Address]) -> MacroCall:
        before = words[:index]
        repeats = next((each.value for each in words if each.letter == "L"), None)
        rest = [each for each in words[index + 1 :] if each.letter != "L"]
        if word.letter == "M" and before:
            raise misplaced(
                before[0].at,
                f"words before M{_constant(word.value):g}",
                "An M code that calls a macro comes first.",
            )
        argument_numbers([each for each in rest if each.letter not in "GP"])
        arguments = [each for each in rest if each.letter not in "G"]
        return MacroCall(
            word.at,
            Number(word.at, float(program)),
            repeats,
            tuple(each for each in arguments if each.letter in ARGUMENTS_I),
            tuple(before),
            by_code=True,
        )

    def _sub_call(
        self, word: Address, program: int, words: list[Address], tool: Expression | None = None
    ) -> SubCall:
        repeats = next((each.value for each in words if each.letter == "L"), None)
        others = tuple(each for each in words if each is not word and each.letter != "L")
        return SubCall(word.at, program, repeats, others, tool)


def _constant(value: Expression) -> float | None:
    return value.value if isinstance(value, Number) else None
