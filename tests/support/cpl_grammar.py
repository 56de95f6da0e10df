"""A second reading of CPL: a grammar for lark, programs generated at random, and an evaluator of expressions.

The grammar is typed, as CPL's names are: what joins an INTEGER with a text has no derivation. It leaves out what
stands alone in its block (WAIT, CALL), jumps and fields, which a grammar does not tell apart.
"""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
from lark import Lark, Token, Tree
from lark.exceptions import LarkError

GRAMMAR = r"""
program: LINE body
body: _seps? (unit (_seps unit)*)? _seps?
unit: MARK+ | MARK* statement
statement: assign | cond | case | for | while | repeat
assign: (IVAR | RVAR | DVAR) "=" number | BVAR "=" truth | SVAR "=" text | (IVAR | RVAR | DVAR | BVAR | SVAR) "=" _nul
cond: "IF" truth "THEN" body ("ELSE" body)? "ENDIF"
case: "CASE" number "OF" (_sep | MARK)* branch* ("OTHERWISE" body)? "ENDCASE"
branch: "LABEL" constant ("," constant)* body
constant: "-"? INT
for: "FOR" counter "=" (number | _nul) ("STEP" number)? "TO" number passes "NEXT" counter?
passes: _seps? | _seps unit (_seps unit)* _seps?
counter: IVAR | RVAR | DVAR
while: "WHILE" truth ("DO" body | _NEWLINE body) "END"
repeat: "REPEAT" body "UNTIL" truth
_nul: "NUL" | "(" _nul ")"
_seps: _sep+
_sep: _COLON | _NEWLINE

truth: orhood | number relation number -> compared | text relation text -> compared
     | truth equality orhood -> compared
     | (number | text | truth) equality _nul -> with_nul | _nul equality (number | text | orhood | _nul) -> nul_with
orhood: andhood | orhood (OR | XOR) andhood -> joined
andhood: denial | andhood AND denial -> joined
denial: "NOT" denial -> denied | "(" truth ")" | TRUE | FALSE | BVAR
relation: "=" -> eq | "<>" -> ne | "<" -> lt | "<=" -> le | ">" -> gt | ">=" -> ge
equality: "=" -> eq | "<>" -> ne

number: isum | rsum
isum: iterm | isum (PLUS | MINUS | OR | XOR) iterm -> joined
iterm: ifactor | iterm (STAR | AND) ifactor -> joined
ifactor: iprimary | (PLUS | MINUS) iprimary -> signed | "NOT" ifactor -> denied
iprimary: INT | IVAR | "(" isum ")" | "INT" "(" number ")" -> whole | "ROUND" "(" number ")" -> nearest
        | "ABS" "(" isum ")" -> absolute | "LEN" "(" text ")" -> length
rsum: rterm | rsum (PLUS | MINUS) (iterm | rterm) -> joined | isum (PLUS | MINUS) rterm -> joined
rterm: rfactor | (iterm | rterm) SLASH (ifactor | rfactor) -> joined | rterm STAR (ifactor | rfactor) -> joined
     | iterm STAR rfactor -> joined
rfactor: rprimary | (PLUS | MINUS) rprimary -> signed
rprimary: REAL | RVAR | DVAR | "(" rsum ")" | "SQRT" "(" number ")" -> root | "ABS" "(" rsum ")" -> absolute

text: piece | text PLUS piece -> joined
piece: STRING | SVAR | "(" text ")" | "CHR$" "(" number ")" -> character
     | "MID$" "(" (text | _nul) "," number ("," number)? ")" -> middle

AND.2: "AND"
OR.2: "OR"
XOR.2: "XOR"
TRUE.2: "TRUE"
FALSE.2: "FALSE"
PLUS: "+"
MINUS: "-"
STAR: "*"
SLASH: "/"
LINE.3: /^[0-9]+ /
_NEWLINE.4: /\n[0-9]+ /
_COLON: ":"
MARK: /\.[A-Z][A-Z0-9]*/
REAL.2: /[0-9]+\.[0-9]*/
INT: /[0-9]+/
STRING: /"[^"\n]*"/
IVAR: /[IJK][A-Z0-9]*%/
RVAR: /[QRS][0-9]+/
DVAR: /[DE][0-9]*!/
BVAR: /[BC][0-9]*\?/
SVAR: /[TU][0-9]*\$/
%ignore " "
"""


class Reading:
    """The grammar at work: whether it takes a program, and what an expression is worth."""

    def __init__(self) -> None:
        self._lark = Lark(GRAMMAR, parser="earley", lexer="basic", start=["program", "number", "truth"])

    def takes(self, text: str) -> bool:
        """Tell whether the grammar derives a program."""
        try:
            tree = self._lark.parse(text, start="program")
        except LarkError:
            return False
        return all(len(_counters(each)) == 1 for each in tree.find_data("for"))

    def value(
        self, text: str, variables: dict[str, Any], *, truth: bool = False, double: bool = False
    ) -> Any:
        """Return what an expression is worth; ArithmeticError or TypeError where it has no value."""
        tree = self._lark.parse(f"({text})", start="truth" if truth else "number")
        return _Evaluator(variables, np.float64 if double else np.float32).of(tree)


def _counters(loop: Tree[Token]) -> set[str]:
    """Return the variables that a FOR and its NEXT name: what a grammar does not compare."""
    return {
        str(each.children[0]) for each in loop.children if isinstance(each, Tree) and each.data == "counter"
    }


class _Evaluator:
    """Reckon a tree: whole numbers as Python has them, all others in the precision of the expression."""

    def __init__(self, variables: dict[str, Any], real: type) -> None:
        self._variables = variables
        self._real = real

    def of(self, node: Any) -> Any:
        if isinstance(node, Token):
            return self._leaf(node)
        parts = list(node.children)
        name = str(node.data)
        method = getattr(self, f"_{name}", None)
        if method is not None:
            return method(*parts)
        assert len(parts) == 1, node
        return self.of(parts[0])

    def _leaf(self, token: Token) -> Any:
        match token.type:
            case "INT":
                return int(token)
            case "REAL":
                return self._real(float(token))
            case "TRUE" | "FALSE":
                return token == "TRUE"
        value = self._variables[str(token)]
        if isinstance(value, float):
            return self._real(np.float32(value) if token.type == "RVAR" else value)
        return value

    def _joined(self, left: Any, operator: Token, right: Any) -> Any:
        one, two = self.of(left), self.of(right)
        if one is None or two is None:
            raise TypeError
        match str(operator):
            case "AND":
                return one & two
            case "OR":
                return one | two
            case "XOR":
                return one ^ two
        if isinstance(one, int) and isinstance(two, int) and operator != "/":
            return one + two if operator == "+" else one - two if operator == "-" else one * two
        first, second = self._real(one), self._real(two)
        if operator == "/" and not second:
            raise ZeroDivisionError
        match str(operator):
            case "+":
                return first + second
            case "-":
                return first - second
            case "*":
                return first * second
        return first / second

    def _signed(self, sign: Token, operand: Any) -> Any:
        value = self.of(operand)
        if value is None:
            raise TypeError
        return -value if sign == "-" else value

    def _denied(self, operand: Any) -> Any:
        value = self.of(operand)
        if value is None:
            raise TypeError
        return (not value) if isinstance(value, bool) else -value - 1

    def _number_of(self, operand: Any) -> Any:
        value = self.of(operand)
        if value is None:
            raise TypeError
        return value

    def _whole(self, operand: Any) -> int:
        return math.trunc(float(self._number_of(operand)))

    def _nearest(self, operand: Any) -> int:
        value = float(self._number_of(operand))
        return math.floor(abs(value) + 0.5) * (1 if value >= 0 else -1)

    def _absolute(self, operand: Any) -> Any:
        return abs(self._number_of(operand))

    def _root(self, operand: Any) -> Any:
        value = self._number_of(operand)
        if value < 0:
            raise ArithmeticError
        return self._real(np.sqrt(self._real(value)))

    def _compared(self, left: Any, relation: Tree[Token], right: Any) -> bool:
        one, two = self.of(left), self.of(right)
        if relation.data in ("eq", "ne") and (one is None or two is None):
            return (one is two) == (relation.data == "eq")
        if one is None or two is None:
            raise TypeError
        if not (isinstance(one, int) and isinstance(two, int)):
            one, two = self._real(one), self._real(two)
        return bool(
            {
                "eq": one == two,
                "ne": one != two,
                "lt": one < two,
                "le": one <= two,
                "gt": one > two,
                "ge": one >= two,
            }[str(relation.data)]
        )

    def _with_nul(self, operand: Any, equality: Tree[Token]) -> bool:
        return (self.of(operand) is None) == (equality.data == "eq")

    def _nul_with(self, equality: Tree[Token], operand: Any = None) -> bool:
        return (operand is None or self.of(operand) is None) == (equality.data == "eq")


class Author:
    """Write programs that the grammar derives, as words with blanks between."""

    def __init__(self, chance: random.Random, *, depth: int = 3, plain: bool = False) -> None:
        self._chance = chance
        self._depth = depth
        self._plain = plain  # only what an evaluator knows: no texts

    def program(self) -> list[str]:
        """Return the words of a program; a line feed with the number of its line is one of them."""
        words = self._body(self._depth)
        number = 1
        for place, word in enumerate(words):
            if word == "\n":
                number += 1
                words[place] = f"\n{number}"
        return ["1", *words]

    def _separator(self) -> list[str]:
        return [self._chance.choice(("\n", "\n", ":"))] * self._chance.choice((1, 1, 1, 2))

    def _body(self, depth: int) -> list[str]:
        words: list[str] = self._separator() if self._chance.random() < 0.3 else []
        for count in range(self._chance.randint(0 if depth < self._depth else 1, 2)):
            words += (self._separator() if count else []) + self._statement(depth)
        return words + (self._separator() if self._chance.random() < 0.5 else [])

    def _statement(self, depth: int) -> list[str]:
        chance = self._chance
        mark = [f".L{chance.randint(1, 9)}"] if chance.random() < 0.1 else []
        kind = chance.randrange(12) if depth else 0
        inner = depth - 1
        match kind:
            case 0 | 1 | 2 | 3 | 4 | 5:
                return mark + self._assignment()
            case 6 | 7:
                words = ["IF", *self.truth(), "THEN", *self._body(inner)]
                return (
                    mark + words + (["ELSE", *self._body(inner)] if chance.random() < 0.5 else []) + ["ENDIF"]
                )
            case 8:
                words = ["CASE", *self.number(), "OF", *(self._separator() if chance.random() < 0.7 else [])]
                for _ in range(chance.randint(0, 2)):
                    words += ["LABEL", str(chance.randint(0, 5)), *self._body(inner)]
                words += ["OTHERWISE", *self._body(inner)] if chance.random() < 0.3 else []
                return mark + [*words, "ENDCASE"]
            case 9:
                name = chance.choice(("I%", "K2%", "Q1", "D2!"))
                step = ["STEP", *self.number()] if chance.random() < 0.4 else []
                words = ["FOR", name, "=", *self.number(), *step, "TO", *self.number(), *self._separator()]
                return mark + [*words, *self._body(inner), "NEXT", *([name] if chance.random() < 0.3 else [])]
            case 10:
                do = ["DO"] if chance.random() < 0.8 else ["\n"]
                return mark + ["WHILE", *self.truth(), *do, *self._body(inner), "END"]
        return mark + ["REPEAT", *self._body(inner), "UNTIL", *self.truth()]

    def _assignment(self) -> list[str]:
        chance = self._chance
        if chance.random() < 0.08:
            return [chance.choice(("I%", "Q1", "D!", "B?", "T$")), "=", "NUL"]
        match chance.randrange(4):
            case 0:
                return [chance.choice(("B?", "C1?")), "=", *self.truth()]
            case 1:
                return [chance.choice(("T$", "U2$")), "=", *self.text()]
        return [chance.choice(("I%", "J3%", "Q1", "S22", "D!")), "=", *self.number()]

    def truth(self, depth: int = 2) -> list[str]:
        """Return the words of a condition."""
        chance = self._chance
        match chance.randrange(7 if depth else 3):
            case 0:
                return [*self.number(1), chance.choice(("=", "<>", "<", "<=", ">", ">=")), *self.number(1)]
            case 1:
                return [*self.number(0), chance.choice(("=", "<>")), "NUL"]
            case 2 | 6:
                if self._plain or chance.random() < 0.5:
                    return [chance.choice(("TRUE", "FALSE", "B?", "C1?"))]
                return [*self.text(), chance.choice(("=", "<", "<>")), *self.text()]
            case 3:
                return ["NOT", *self._denial(depth - 1)]
        joined = [*self._denial(depth - 1), chance.choice(("AND", "OR", "XOR")), *self._denial(depth - 1)]
        return [*joined, chance.choice(("=", "<>")), "TRUE"] if chance.random() < 0.2 else joined

    def _denial(self, depth: int) -> list[str]:
        if self._chance.random() < 0.4:
            return [self._chance.choice(("TRUE", "FALSE", "B?", "C1?"))]
        return ["(", *self.truth(depth), ")"]

    def number(self, depth: int = 2) -> list[str]:
        """Return the words of a number."""
        chance = self._chance
        match chance.randrange(7 if depth else 2):
            case 0:
                return [chance.choice(("7", "2", "13", "I%", "J3%", "K2%"))]
            case 1:
                return [chance.choice(("2.5", "0.1", "31.4", "Q1", "S22", "R7", "D!", "3."))]
            case 2:
                return ["(", *self.number(depth - 1), ")"]
            case 3:
                return [chance.choice(("-", "+")), "(", *self.number(depth - 1), ")"]
            case 4:
                functions = ("INT", "ROUND", "ABS", "SQRT")
                return [chance.choice(functions), "(", *self.number(depth - 1), ")"]
            case 5:
                whole = ("7", "12", "I%", "J3%", "NOT 5")
                return [
                    chance.choice(whole),
                    chance.choice(("AND", "OR", "XOR", "+", "*")),
                    chance.choice(whole),
                ]
        return [*self.number(depth - 1), chance.choice(("+", "-", "*", "/")), *self.number(depth - 1)]

    def text(self) -> list[str]:
        """Return the words of a text."""
        chance = self._chance
        match chance.randrange(5):
            case 0:
                return ["T$"]
            case 1:
                return ["CHR$", "(", *self.number(1), ")"]
            case 2:
                return ["MID$", "(", "U2$", ",", *self.number(1), ")"]
            case 3:
                return [chance.choice(('"AB"', '""')), "+", "T$"]
        return [chance.choice(('"AB"', '"X Y"'))]


def changed(words: list[str], chance: random.Random) -> list[str]:
    """Return the words of a program with one place changed."""
    words = list(words)
    at = chance.randrange(1, len(words)) if len(words) > 1 else 0
    other = chance.randrange(1, len(words)) if len(words) > 1 else 0
    if not at:
        return words
    match chance.randrange(4):
        case 0:
            del words[at]
        case 1:
            words.insert(at, words[other])
        case 2:
            words[at], words[other] = words[other], words[at]
        case _:
            words[at] = chance.choice(
                (*words[1:], "(", ")", ",", "=", ":", "NUL", "TO", "NOT", "-", "B?", "I%", "2.5")
            )
    return words
