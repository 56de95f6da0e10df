"""One line of RS274/NGC: its words, settings of parameters, O-word, comments; expressions become Python.

An expression is read as LinuxCNC reads it: `**` binds closest, then `* / MOD`, `+ -`, comparisons, `AND OR XOR`, each
from the left. Source: LinuxCNC G-code manual, Overview, "Binary Operators" and "Functions".
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from polycnc.language import Flaw
from polycnc.nc.blocks._polar_words import POLAR_LETTERS

_WORDS = ("mod", "eq", "ne", "gt", "ge", "lt", "le", "and", "or", "xor")
_POWERS = {
    "**": 5, "*": 4, "/": 4, "mod": 4, "+": 3, "-": 3,
    "eq": 2, "ne": 2, "gt": 2, "ge": 2, "lt": 2, "le": 2, "and": 1, "or": 1, "xor": 1,
}  # fmt: skip
_COMPARED = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
_FUNCTIONS = (
    "abs", "acos", "asin", "atan", "cos", "exists", "exp", "fix", "fup", "ln", "round", "sin", "sqrt", "tan",
)  # fmt: skip
_KEYWORDS = (
    "endsub", "sub", "call", "return", "elseif", "else", "endif", "if", "endwhile", "while", "do", "endrepeat",
    "repeat", "break", "continue",
)  # fmt: skip


def _any_of(words: Iterable[str], *others: str) -> re.Pattern[str]:
    """Return what matches one of some words, in whose midst blanks count for nothing."""
    return re.compile("|".join((*others, *(r"[ \t]*".join(word) for word in words))), re.IGNORECASE)


_OPERATOR = _any_of(_WORDS, r"\*\*", "[*/+-]")
_FUNCTION = _any_of(_FUNCTIONS)
_O_WORD = _any_of(_KEYWORDS)
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)")
_NAME = re.compile(r"<([^>]*)>")
_BLANKS = re.compile(r"[ \t]*")
_LOCALS = 30
_COMMON = 5000
_NESTING = 30
_EXPRESSION_HINT = "Write it like [#1 + 2]."
_SPINDLE = re.compile(r"\$[ \t]*(-?[0-9]+)")
_ROUND_HINT = "Write square brackets, like SQRT[2]: what stands in round ones is a comment."


@dataclass(slots=True)
class Expression:
    """Python that gives a number; `truth` is Python that tells whether it is not 0."""

    python: str
    truth: str = ""

    @property
    def condition(self) -> str:
        """Python that is true where the number is not 0."""
        return self.truth or f"({self.python}) != 0.0"


@dataclass(slots=True)
class OWord:
    """An O-word: `label` is Python of its name where it is computed, else the name itself; `arguments` in brackets."""

    keyword: str
    label: str
    computed: bool
    at: int
    arguments: list[Expression] = field(default_factory=list)


@dataclass(slots=True)
class Line:
    """What a line holds. Settings are Python targets with their expressions; `skip` is the number of its skip mark."""

    words: list[tuple[str, Expression, int]] = field(default_factory=list)
    settings: list[tuple[str, Expression]] = field(default_factory=list)
    o_word: OWord | None = None
    comments: list[str] = field(default_factory=list)
    skip: int = 0


def bare(text: str) -> str:
    """Return a word or a name as it is compared: without blanks, in small letters."""
    return "".join(text.split()).lower()


class LineReader:
    """Read one line of text; `number` is its number in the file."""

    def __init__(self, text: str, number: int) -> None:
        self._text = text
        self._number = number
        self._at = 0
        self._depth = 0

    def read(self) -> Line:
        """Return what the line holds.

        Raises:
            Flaw: it is not as the language wants it; offsets count in the line.
        """
        line = Line()
        if self._take("/"):
            digit = re.compile("[1-9]?").match(self._text, self._at)
            line.skip = int(digit[0] or 1) if digit else 1
            self._at += len(digit[0]) if digit else 0
        while char := self._next():
            at = self._at
            if char == ";":
                line.comments.append(self._text[at + 1 :])
                break
            if char == "(":
                line.comments.append(self._comment())
            elif char == "#":
                target = self._target()
                if not self._take("="):
                    raise Flaw(self._at, "a parameter without a value", "Write it like #1 = 2.")
                line.settings.append((target, self.value()))
            elif char.lower() == "o":
                self._at += 1
                line.o_word = self._o_word(at, line.comments)
            elif char == "$":
                self._spindle()
            elif char.isalpha() or char in POLAR_LETTERS:
                if char in "nN" and (line.words or line.settings or line.o_word):
                    raise Flaw(
                        at, "the block number N stands behind other words", "A block number begins its line."
                    )
                self._at += 1
                line.words.append((char.upper(), self.value(), at))
            else:
                raise Flaw(
                    at, f"{char!r} has no meaning here", "Write words like X1.5, settings like #1 = 2."
                )
        line.words = [word for word in line.words if word[0] != "N"]
        return line

    def _spindle(self) -> None:
        """Read the number of the spindle that S, M3 and their like are for: there is one."""
        at = self._at
        found = _SPINDLE.match(self._text, at)
        if found is None:
            raise Flaw(at, "$ without the number of a spindle", "Write $0, or remove it.")
        if float(found[1]) not in (0.0, -1.0):
            raise Flaw(at, f"there is no spindle {found[1]}", "The machine has one spindle: write $0.")
        self._at = found.end()

    # ------------------------------------------------------------------ values

    def value(self) -> Expression:
        """Read a number, a parameter, a function or an expression in brackets."""
        char = self._next()
        if char == "[":
            return self._bracket()
        if char == "#":
            return Expression(self._parameter())
        if (
            char
            and char in "+-"
            and (after := self._text[self._at + 1 : self._at + 2])
            and after not in "0123456789."
        ):
            self._at += 1
            inner = self.value().python
            return Expression(inner if char == "+" else f"(-{inner})")
        if char.isalpha():
            return self._function()
        found = _NUMBER.match(self._text, self._at)
        if found is None:
            raise Flaw(self._at, "a number is missing", _EXPRESSION_HINT)
        self._at = found.end()
        return Expression(f"({float(found[0])!r})" if found[0][0] in "+-" else repr(float(found[0])))

    def _bracket(self) -> Expression:
        begin = self._at
        self._expect("[")
        self._depth += 1
        if self._depth > _NESTING:
            raise Flaw(
                begin, f"more than {_NESTING} brackets inside each other", "Keep a part in a parameter."
            )
        found = self._chain(0)
        self._expect("]")
        self._depth -= 1
        return Expression(f"({found.python})", found.truth)

    def _chain(self, least: int) -> Expression:
        left = self.value()
        while True:
            self._next()
            found = _OPERATOR.match(self._text, self._at)
            if found is None or (power := _POWERS[bare(found[0])]) <= least:
                return left
            self._at = found.end()
            left = _applied(bare(found[0]), left, self._chain(power))

    def _function(self) -> Expression:
        found = _FUNCTION.match(self._text, self._at)
        if found is None:
            raise Flaw(
                self._at,
                f"{self._text[self._at]!r} is no function",
                f"Functions are {', '.join(_FUNCTIONS).upper()}.",
            )
        self._at = found.end()
        name = bare(found[0])
        if name == "exists":
            self._expect("[")
            self._expect("#")
            self._next()
            named = _NAME.match(self._text, self._at)
            if named is None:
                number = self.value().python
                self._expect("]")
                return Expression(f"exists_number({number})")
            self._at = named.end()
            self._expect("]")
            return Expression(f"exists({bare(named[1])!r}, N)")
        first = self._bracket().python
        if name != "atan":
            return Expression(f"{name}_({first})")
        if not self._take("/"):
            raise Flaw(self._at, "ATAN without a second part", "Write it like ATAN[1]/[2].")
        return Expression(f"atan_({first}, {self._bracket().python})")

    def _parameter(self) -> str:
        """Read a parameter and return the Python of its value."""
        return self._of_parameter("get", "named")

    def _target(self) -> str:
        """Read a parameter that is set and return Python with {} in place of the value."""
        return self._of_parameter("put", "name")

    def _of_parameter(self, numbered: str, named: str) -> str:
        self._expect("#")
        self._next()
        sets = numbered == "put"
        if found := _NAME.match(self._text, self._at):
            self._at = found.end()
            name = bare(found[1])
            if not name.startswith("_"):
                return f"N[{name!r}]" + (" = {}" if sets else "")
            if name == "_line" and not sets:
                return repr(float(self._number))
            return f"name({name!r}, {{}})" if sets else f"named({name!r})"
        found = _NUMBER.match(self._text, self._at)
        if found is not None and found[0].isdigit():
            self._at = found.end()
            number = int(found[0][:9])
            if 1 <= number <= _LOCALS:
                return f"L[{number}]" + (" = {}" if sets else "")
            if _LOCALS < number <= _COMMON:
                return f"V[{number}]" + (" = {}" if sets else "")
            return f"put({number}, {{}}, L)" if sets else f"get({number}, L)"
        index = self.value().python
        return f"put({index}, {{}}, L)" if sets else f"get({index}, L)"

    # ------------------------------------------------------------------ O-words and comments

    def _o_word(self, at: int, comments: list[str]) -> OWord:
        char = self._next()
        computed = False
        if found := _NAME.match(self._text, self._at):
            self._at = found.end()
            label = bare(found[1])
        elif char.isdigit():
            found = _NUMBER.match(self._text, self._at)
            assert found is not None
            self._at = found.end()
            label = str(int(float(found[0])))
        else:
            label, computed = self.value().python, True
        self._next()
        keyword = _O_WORD.match(self._text, self._at)
        if keyword is None:
            raise Flaw(
                at,
                "an O-word without what it does",
                "Add SUB, CALL, IF, WHILE, DO, REPEAT or what ends them.",
            )
        self._at = keyword.end()
        word = OWord(bare(keyword[0]), label, computed, at)
        if word.keyword in ("call", "return", "endsub", "if", "elseif", "while", "repeat"):
            while (char := self._next()) and char in "[(":
                if char == "(":
                    comments.append(self._comment())
                else:
                    word.arguments.append(self._bracket())
        return word

    def _comment(self) -> str:
        end = self._text.find(")", self._at)
        if end < 0:
            raise Flaw(self._at, "a comment without its end", "Add ).")
        comment = self._text[self._at + 1 : end]
        self._at = end + 1
        return comment

    # ------------------------------------------------------------------ characters

    def _next(self) -> str:
        """Skip blanks and return the next character, empty at the end."""
        blanks = _BLANKS.match(self._text, self._at)
        self._at = blanks.end() if blanks else self._at
        return self._text[self._at : self._at + 1]

    def _take(self, char: str) -> bool:
        if self._next() != char:
            return False
        self._at += 1
        return True

    def _expect(self, char: str) -> None:
        if not self._take(char):
            hint = _ROUND_HINT if self._text[self._at : self._at + 1] == "(" else _EXPRESSION_HINT
            raise Flaw(self._at, f"{char!r} is missing", hint)


def _applied(operator: str, left: Expression, right: Expression) -> Expression:
    a, b = left.python, right.python
    truth = ""
    match operator:
        case "+" | "-" | "*":
            return Expression(f"({a} {operator} {b})")
        case "/" | "**" | "mod":
            name = {"/": "divide", "**": "power", "mod": "modulo"}[operator]
            return Expression(f"{name}({a}, {b})")
        case "eq" | "ne":
            truth = f"abs_({a} - {b}) {'<' if operator == 'eq' else '>='} 0.0001"
        case "and" | "or":
            truth = f"({left.condition}) {operator} ({right.condition})"
        case "xor":
            truth = f"({left.condition}) != ({right.condition})"
        case _:
            truth = f"{a} {_COMPARED[operator]} {b}"
    return Expression(f"(1.0 if {truth} else 0.0)", truth)
