"""Read the statements of custom macros, line by line; errors carry the control's alarm numbers."""

from __future__ import annotations

import re

from polycnc.language import END as TEXT_END
from polycnc.language import Flaw, Tokens, real_value
from polycnc.nc.macro._call_reader import CallReader, misplaced
from polycnc.nc.macro._calls import MacroCalls
from polycnc.nc.macro._operand_reader import LEXICON, UNSUPPORTED, OperandReader
from polycnc.nc.macro._syntax import (
    Address,
    Assignment,
    Device,
    End,
    Expression,
    Goto,
    If,
    Line,
    Names,
    Number,
    Output,
    Printed,
    Statement,
    While,
    Words,
)

LOOPS = 3
LARGEST_LABEL = 99_999_999
_COMMENT = re.compile(r"\(([^)\r\n]*)\)")
_PRINTED_TEXT = re.compile(r"[A-Z0-9*/+\-?@&=. ]", re.IGNORECASE)
_FORMAT_DIGITS = re.compile(r"[ \t]*\[[ \t]*([0-9])[ \t]*([0-9])?[ \t]*\]")
_NAME_LIST = re.compile(r"[ \t]*([0-9]+)[ \t]*\[([^\]\r\n]*)\]")
_LONGEST_NAME = 8
_MOST_DIGITS = 8


class LineReader:
    """Read lines of `text` (one character a byte). `calls` are codes that call programs, None in such a program."""

    def __init__(self, text: str, calls: MacroCalls, *, repeats: bool) -> None:
        self._text = text
        self._calls = CallReader(calls, repeats)

    def read(self, offset: int, end: int, line: int) -> Line:
        """Read the line from `offset` up to its newline at `end`.

        Raises:
            Flaw: It is no statement.
        """
        try:
            return _Statements(self._text, offset, end, self._calls).line(line)
        except Flaw as flaw:
            flaw.code = flaw.code or "PS0114"
            raise


class _Statements:
    """Read one line."""

    def __init__(self, text: str, offset: int, end: int, calls: CallReader) -> None:
        self._tokens = tokens = Tokens(LEXICON, text, offset, end)
        self._operands = OperandReader(tokens, text, end)
        self._calls = calls
        self._text = text
        self._offset = offset
        self._end = end

    def line(self, number: int) -> Line:
        skip, label = self._skip(0), None
        tokens = self._tokens
        if tokens.token.word == "O" and tokens.token.kind == "letter":
            tokens.step()
            self._digits("the program number")
        if tokens.token.word == "N" and tokens.token.kind == "letter":
            tokens.step()
            label = self._digits("the block number")
            skip = self._skip(skip)
        statements: list[Statement] = []
        while self._tokens.token.kind != TEXT_END:
            if statements and not (isinstance(statements[-1], Assignment) and self._tokens.token.word == "#"):
                raise self._mixed(statements[-1])
            statements.append(self._statement())
        if statements and isinstance(statements[0], (While, End)) and skip:
            raise misplaced(statements[0].at, "a loop cannot be skipped", "Remove the '/'.")
        return Line(number, self._offset, label, skip, tuple(statements))

    def _mixed(self, before: Statement) -> Flaw:
        token = self._tokens.token
        if token.kind == "letter":
            return Flaw(
                token.at,
                "a macro statement and NC words in one block",
                "Write them in two blocks.",
                code="PS0127",
            )
        if isinstance(before, Words) and token.word == "," and before.words:
            at = before.words[-1].at
            return Flaw(
                at,
                f"'{before.words[-1].letter}' has a comma in its number",
                "Write a decimal point, like 1.5.",
            )
        return misplaced(token.at, f"the statement does not go on with {token}", "Check it.")

    def _skip(self, level: int) -> int:
        tokens = self._tokens
        if level or tokens.token.word != "/":
            return level
        tokens.step()
        if tokens.token.kind == "number" and tokens.token.text in tuple("123456789"):
            return int(tokens.step().text)
        return 1

    def _digits(self, what: str) -> int:
        token = self._tokens.token
        if token.kind != "number" or "." in token.text:
            raise Flaw(token.at, f"{what} is missing before {token}", "Write digits.", code="PS0128")
        return self._label(real_value(token), self._tokens.step().at)

    @staticmethod
    def _label(value: float, at: int) -> int:
        if not 0 <= value <= LARGEST_LABEL or not value.is_integer():
            raise Flaw(
                at,
                f"{value:g} is not a block number",
                f"Write a whole number up to {LARGEST_LABEL}.",
                code="PS0128",
            )
        return int(value)

    # ------------------------------------------------------------------ statements

    def _statement(self) -> Statement:
        tokens = self._tokens
        token = tokens.token
        if token.word == "#":
            return self._assignment()
        if token.kind == "word":
            if token.word in UNSUPPORTED:
                raise misplaced(
                    token.at, f"{token.word} ({UNSUPPORTED[token.word]}) is not supported yet", "Remove it."
                )
            match token.word:
                case "IF":
                    return self._if()
                case "GOTO":
                    return self._goto()
                case "WHILE":
                    return self._while()
                case "DO":
                    tokens.step()
                    return While(token.at, self._loop(), None)
                case "END":
                    tokens.step()
                    return End(token.at, self._loop())
                case "POPEN" | "PCLOS":
                    tokens.step()
                    return Device(token.at, token.word == "POPEN")
                case "DPRNT" | "BPRNT":
                    return self._output(token.at, token.word == "BPRNT")
                case "SETVN":
                    return self._set_names(token.at)
        if token.kind == "letter":
            return self._words()
        raise misplaced(token.at, f"{token} begins no statement", "Check the block.")

    def _output(self, at: int, binary: bool) -> Output:
        """Read an output: characters as they stand ('*' is a blank), `#n[fd]` values with their digits."""
        text, place = self._text, self._tokens.next_at
        if not text.startswith("[", place):
            raise misplaced(at, "'[' is missing after the output", "Write DPRNT[X#1[53]].")
        place += 1
        pieces: list[str | Printed] = []
        while not text.startswith("]", place):
            if place >= self._end:
                raise misplaced(at, "the output is not closed", "Write ']' at its end.")
            if text[place] == "#":
                self._tokens.jump(place)
                value = self._operands.variable()
                place = self._tokens.token.at
                found = _FORMAT_DIGITS.match(text, place, self._end)
                if found is None or (not binary and found[2] is None):
                    raise misplaced(
                        place,
                        "the digits of the value are missing",
                        "Write #1[53]: five before the point, three after it (BPRNT: #1[3]).",
                    )
                first, second = int(found[1]), int(found[2] or 0)
                whole, decimals = (0, first) if binary else (first, second)
                if not binary and not 0 < whole + decimals <= _MOST_DIGITS:
                    raise misplaced(place, "a value has 1 to 8 digits", "Write fewer, like [53].")
                pieces.append(Printed(value, whole, decimals))
                place = found.end()
            elif _PRINTED_TEXT.match(text, place):
                pieces.append(text[place])
                place += 1
            else:
                raise misplaced(place, f"'{text[place]}' cannot be put out", "Use letters, digits, * / + -.")
        self._tokens.jump(place + 1)
        return Output(at, binary, tuple(pieces))

    def _set_names(self, at: int) -> Names:
        found = _NAME_LIST.match(self._text, self._tokens.next_at, self._end)
        if found is None:
            raise misplaced(at, "SETVN without a number and names", "Write SETVN 510[DEPTH,WIDTH].")
        names = tuple(name.strip() for name in found[2].split(","))
        if any(len(name) > _LONGEST_NAME for name in names):
            raise misplaced(
                found.start(2), f"a name is longer than {_LONGEST_NAME} characters", "Shorten it."
            )
        self._tokens.jump(found.end())
        return Names(at, int(self._label(float(found[1]), found.start(1))), names)

    def _assignment(self) -> Assignment:
        at = self._tokens.token.at
        target = self._operands.variable()
        if self._tokens.token.word != "=":
            raise misplaced(
                self._tokens.token.at,
                f"'=' is missing before {self._tokens.token}",
                "Write an assignment like #1=10.",
            )
        self._tokens.step()
        value = self._operands.expression()
        return Assignment(at, target, value, self._comment())

    def _comment(self) -> str:
        found = _COMMENT.search(self._text, self._tokens.after, self._end)
        return "" if found is None else found[1].strip()

    def _if(self) -> If:
        tokens = self._tokens
        at = tokens.step().at
        condition = self._condition("IF")
        word = tokens.token.word
        if word == "GOTO":
            return If(at, condition, self._goto())
        if word != "THEN":
            raise misplaced(
                tokens.token.at,
                f"GOTO or THEN is missing before {tokens.token}",
                "Write IF [...] GOTO 10, or IF [...] THEN #1=0.",
            )
        tokens.step()
        if tokens.token.word == "GOTO":
            return If(at, condition, self._goto())
        if tokens.token.word != "#":
            raise misplaced(
                tokens.token.at,
                "only an assignment may follow THEN",
                "Write IF [...] GOTO and jump over the block.",
            )
        return If(at, condition, self._assignment())

    def _condition(self, word: str) -> Expression:
        token = self._tokens.token
        if token.word != "[":
            raise misplaced(token.at, f"'[' is missing after {word}", f"Write {word} [#1 EQ 0] ...")
        return self._operands.bracket()

    def _goto(self) -> Goto:
        at = self._tokens.step().at
        token = self._tokens.token
        if token.kind == "number":
            number = Number(token.at, float(self._digits("the block number")))
            return Goto(at, number)
        if token.word not in ("#", "["):
            raise misplaced(token.at, f"the block number is missing before {token}", "Write GOTO 10.")
        return Goto(at, self._operands.number())

    def _while(self) -> While:
        tokens = self._tokens
        at = tokens.step().at
        condition = self._condition("WHILE")
        if tokens.token.word != "DO":
            raise misplaced(
                tokens.token.at, f"DO is missing before {tokens.token}", "Write WHILE [...] DO 1."
            )
        tokens.step()
        return While(at, self._loop(), condition)

    def _loop(self) -> int:
        token = self._tokens.token
        if token.kind != "number" or token.text not in ("1", "2", "3"):
            raise Flaw(
                token.at,
                f"{token} is not the number of a loop",
                f"Loops are numbered 1 to {LOOPS}.",
                code="PS0126",
            )
        return int(self._tokens.step().text)

    def _words(self) -> Statement:
        words: list[Address] = []
        tokens = self._tokens
        at = tokens.token.at
        while tokens.token.kind == "letter":
            letter = tokens.step()
            if tokens.token.word == "=":
                raise misplaced(
                    tokens.token.at,
                    f"'=' after the address {letter.word}",
                    f"Write {letter.word}#1, or {letter.word}[...].",
                )
            words.append(Address(letter.at, letter.word, self._operands.number()))
        return self._calls.statement(at, words)
