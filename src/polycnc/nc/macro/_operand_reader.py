"""Read the expressions of custom macros: numbers, variables, functions, brackets."""

from __future__ import annotations

import re

from polycnc.language import Flaw, Infix, Lexicon, Operators, Prefix, Tokens, read_expression, real_value
from polycnc.nc.macro._functions import FUNCTIONS
from polycnc.nc.macro._syntax import Expression, Function, Name, Number, Variable

_MOST_BRACKETS = 5
COMPARISONS = {"EQ": "==", "NE": "!=", "GT": ">", "LT": "<", "GE": ">=", "LE": "<="}
_LARGEST_NUMBER = 1e15
_BLANKS = r"[ \t\x00\x03\x0b\x0c\x11-\x14\x1a\x7f]"
_WORDS = (
    "WHILE", "GOTO", "THEN", "IF", "DO", "END", "DPRNT", "BPRNT", "POPEN", "PCLOS", "SETVN", "POW", "ADP", "PRM",
    *COMPARISONS, "AND", "XOR", "OR", "MOD", *sorted(FUNCTIONS, key=len, reverse=True),
)  # fmt: skip
_SHORT = {"WH": "WHILE", "EN": "END", "TH": "THEN", "EX": "EXP"} | {
    name[:2]: name for name in FUNCTIONS if name not in ("SQR", "RND", "LN", "EXP")
}
# A short word is one where it can be nothing else. GO is none: in GO1 a zero is meant.
_SHORT_WORDS = rf"WH(?={_BLANKS}*\[)|EN(?={_BLANKS}*[1-3])|TH(?={_BLANKS}*[#G])|" + "|".join(
    rf"{short}(?={_BLANKS}*\[)" for short, name in _SHORT.items() if name in FUNCTIONS
)
LEXICON = Lexicon(
    (
        ("number", r"[0-9]+\.?[0-9]*|\.[0-9]+"),
        ("word", "(?i:" + "|".join((*_WORDS, _SHORT_WORDS)) + ")"),
        ("letter", "[A-Za-z]"),
        ("mark", r"[\[\]#=+\-*/,]"),
    ),
    skip=rf"(?:{_BLANKS}|\([^)\r\n]*\))*",
    folded=("word", "letter"),
    short=_SHORT,
    unfinished={
        "(": ("the comment is not closed", "Write ')' at its end, on the same line."),
        "<": ("'<' has no meaning here", "Compare with LT or LE."),
        ">": ("'>' has no meaning here", "Compare with GT or GE, or NE for <>."),
    },
)
_OPERATORS = Operators(
    infix={
        **{name: Infix(1, single=True) for name in COMPARISONS},
        "+": Infix(2), "-": Infix(2), "OR": Infix(2), "XOR": Infix(2),
        "*": Infix(3), "/": Infix(3), "AND": Infix(3), "MOD": Infix(3),
    },
    prefix={"-": Prefix(4), "+": Prefix(4)},
)  # fmt: skip
UNSUPPORTED = {"PRM": "reading parameters"}
_NAME = re.compile(r"\[[ \t]*([A-Za-z_][A-Za-z0-9_]*)[ \t]*\]")


class OperandReader:
    """Read expressions from `tokens` of `text`, which ends at `end`; what is wrong in them is a Flaw."""

    def __init__(self, tokens: Tokens, text: str, end: int) -> None:
        self._tokens = tokens
        self._text = text
        self._end = end
        self._brackets = 0

    def expression(self) -> Expression:
        """Read an expression, of values and functions."""
        return read_expression(self._tokens, _OPERATORS, self._operand)

    def number(self) -> Expression:
        """Read what may stand after an address: a number, a variable or brackets, with a sign.

        Raises:
            Flaw: Something else comes.
        """
        if self._tokens.token.word in ("+", "-"):
            return read_expression(self._tokens, _OPERATORS, self._plain_operand, 4)
        return self._plain_operand()

    def _plain_operand(self) -> Expression:
        token = self._tokens.token
        if token.kind == "number" or token.word in ("#", "["):
            return self._operand()
        if token.kind == "word" and (token.word in FUNCTIONS or token.word in ("POW", "ADP")):
            raise Flaw(
                token.at,
                f"{token.word} right after an address",
                f"Write brackets around it: [{token.word}[...]].",
            )
        raise Flaw(token.at, f"a number is missing before {token}", "Write a number, #1 or [...].")

    def _operand(self) -> Expression:
        tokens = self._tokens
        token = tokens.token
        if token.kind == "number":
            value = real_value(token, _LARGEST_NUMBER)
            tokens.step()
            return Number(token.at, value, "." in token.text)
        if token.word == "#":
            return self.variable()
        if token.word == "[":
            return self.bracket()
        if token.kind == "word" and token.word in FUNCTIONS:
            return self._function()
        if token.word == "POW":
            tokens.step()
            return Function(token.at, "POW", self._list(2))
        if token.word == "ADP":
            tokens.step()
            (argument,) = self._list(1)
            if not isinstance(argument, Variable) or not 1 <= argument.number <= 33:
                raise Flaw(token.at, "ADP takes a local variable", "Write ADP[#1].")
            return Function(token.at, "ADP", (argument,))
        if token.word in UNSUPPORTED:
            raise Flaw(token.at, f"{token.word} is not supported yet", "Remove it.")
        raise Flaw(
            token.at,
            f"a value is missing before {token}",
            "Write a number, a variable, a function or brackets.",
        )

    def variable(self) -> Variable:
        """Read a variable, which begins at the present token."""
        tokens = self._tokens
        at = tokens.step().at
        token = tokens.token
        if token.kind == "number":
            if "." in token.text:
                raise Flaw(
                    token.at,
                    f"{token} is no number of a variable",
                    "Write it without a point.",
                    code="PS0115",
                )
            number = real_value(token, _LARGEST_NUMBER)
            tokens.step()
            return Variable(at, int(number))
        if found := _NAME.match(self._text, token.at, self._end):
            tokens.jump(found.end())
            return Variable(at, -1, Name(found.start(1), found[1].upper()))
        if token.word == "[":
            return Variable(at, -1, self.bracket())
        raise Flaw(
            token.at,
            f"the number of the variable is missing before {token}",
            "Write #1, #[...] with an expression, or #[NAME].",
        )

    def _function(self) -> Function:
        tokens = self._tokens
        name = tokens.step()
        if name.word != "ATAN":
            return Function(name.at, name.word, self._list(1))
        arguments = self._list(1, 2)
        if len(arguments) == 1 and tokens.token.word == "/" and self._bracket_follows():
            tokens.step()
            arguments = (*arguments, self.bracket())
        return Function(name.at, "ATAN" if len(arguments) == 1 else "ATAN2", arguments)

    def _bracket_follows(self) -> bool:
        return self._text[self._tokens.next_at : self._end].lstrip(" \t").startswith("[")

    def bracket(self) -> Expression:
        """Read an expression in brackets."""
        return self._list(1)[0]

    def _list(self, count: int, most: int = 0) -> tuple[Expression, ...]:
        tokens = self._tokens
        token = tokens.token
        if token.word != "[":
            raise Flaw(token.at, f"'[' is missing before {token}", "Write brackets.")
        if self._brackets >= _MOST_BRACKETS:
            raise Flaw(
                token.at,
                f"more than {_MOST_BRACKETS} brackets inside each other",
                "Keep a part in a variable.",
                code="PS0118",
            )
        self._brackets += 1
        tokens.step()
        found = [self.expression()]
        while len(found) < max(count, most) and tokens.token.word == ",":
            tokens.step()
            found.append(self.expression())
        if tokens.token.word != "]" or len(found) < count:
            missing = "']'" if len(found) >= count else "','"
            raise Flaw(tokens.token.at, f"{missing} is missing before {tokens.token}", "Check the brackets.")
        tokens.step()
        self._brackets -= 1
        return tuple(found)
