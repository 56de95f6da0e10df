"""Read the statements of custom macros, line by line; errors carry the control's alarm numbers."""

from __future__ import annotations

import re

from polycnc.language import END as TEXT_END
from polycnc.language import Flaw, Infix, Lexicon, Operators, Prefix, Tokens, read_expression, real_value
from polycnc.nc.macro._calls import ABC, ARGUMENTS_I, FIRST_REPEATED, IJK, MOST_REPEATS, MacroCalls
from polycnc.nc.macro._functions import FUNCTIONS
from polycnc.nc.macro._syntax import (
    Address,
    Assignment,
    Cancel,
    Device,
    End,
    Expression,
    Function,
    Goto,
    If,
    Interrupt,
    Line,
    MacroCall,
    Name,
    Names,
    Number,
    Output,
    Printed,
    Restart,
    Statement,
    SubCall,
    Variable,
    While,
    Words,
)

MOST_BRACKETS = 5
LOOPS = 3
LARGEST_LABEL = 99_999_999
COMPARISONS = {"EQ": "==", "NE": "!=", "GT": ">", "LT": "<", "GE": ">=", "LE": "<="}
_LARGEST_NUMBER = 1e15
_FORMAT = "PS0114"
_STATEMENT = "PS0125"
_BLANKS = r"[ \t\x00\x03\x0b\x0c\x11-\x14\x1a\x7f]"
_WORDS = (
    "WHILE", "GOTO", "THEN", "IF", "DO", "END", "DPRNT", "BPRNT", "POPEN", "PCLOS", "SETVN", "POW", "ADP", "PRM",
    *COMPARISONS, "AND", "XOR", "OR", "MOD", *sorted(FUNCTIONS, key=len, reverse=True),
)  # fmt: skip
_LEXICON = Lexicon(
    (
        ("number", r"[0-9]+\.?[0-9]*|\.[0-9]+"),
        ("word", "(?i:" + "|".join(_WORDS) + ")"),
        ("letter", "[A-Za-z]"),
        ("mark", r"[\[\]#=+\-*/,]"),
    ),
    skip=rf"(?:{_BLANKS}|\([^)\r\n]*\))*",
    folded=("word", "letter"),
    unfinished={"(": ("the comment is not closed", "Write ')' at its end, on the same line.")},
)
_OPERATORS = Operators(
    infix={
        **{name: Infix(1, single=True) for name in COMPARISONS},
        "+": Infix(2), "-": Infix(2), "OR": Infix(2), "XOR": Infix(2),
        "*": Infix(3), "/": Infix(3), "AND": Infix(3), "MOD": Infix(3),
    },
    prefix={"-": Prefix(4), "+": Prefix(4)},
)  # fmt: skip
_COMMENT = re.compile(r"\(([^)\r\n]*)\)")
_UNSUPPORTED = {"PRM": "reading parameters"}
_PRINTED_TEXT = re.compile(r"[A-Z0-9*/+\-?@&=. ]", re.IGNORECASE)
_FORMAT_DIGITS = re.compile(r"[ \t]*\[[ \t]*([0-9])[ \t]*([0-9])?[ \t]*\]")
_NAME_LIST = re.compile(r"[ \t]*([0-9]+)[ \t]*\[([^\]\r\n]*)\]")
_LONGEST_NAME = 8
_NAME = re.compile(r"\[[ \t]*([A-Za-z_][A-Za-z0-9_]*)[ \t]*\]")
_MOST_DIGITS = 8
_INTERRUPT_ON, _INTERRUPT_OFF = 96.0, 97.0
_MACRO_CALL, _MODAL_CALL, _MODAL_CALL_EACH, _CANCEL_MODAL = 65.0, 66.0, 66.1, 67.0
_RETURN = 99.0


class LineReader:
    """Read lines of `text` (one character a byte). `calls` are codes that call programs, None in such a program."""

    def __init__(self, text: str, calls: MacroCalls, *, repeats: bool) -> None:
        self._text = text
        self._calls = calls
        self._repeats = repeats

    def read(self, offset: int, end: int, line: int) -> Line:
        """Read the line from `offset` up to its newline at `end`.

        Raises:
            Flaw: It is no statement.
        """
        text = self._text
        try:
            reader = _Statements(Tokens(_LEXICON, text, offset, end), text, offset, end)
            reader.calls, reader.repeats = self._calls, self._repeats
            return reader.line(line)
        except Flaw as flaw:
            flaw.code = flaw.code or _FORMAT
            raise


class _Statements:
    """Read one line."""

    calls = MacroCalls()
    repeats = False

    def __init__(self, tokens: Tokens, text: str, offset: int, end: int) -> None:
        self._tokens = tokens
        self._text = text
        self._offset = offset
        self._end = end
        self._brackets = 0

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
            raise Flaw(statements[0].at, "a loop cannot be skipped", "Take the '/' out.", code=_STATEMENT)
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
                code=_FORMAT,
            )
        return Flaw(token.at, f"the statement does not go on with {token}", "Check it.", code=_STATEMENT)

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
            if token.word in _UNSUPPORTED:
                raise Flaw(
                    token.at,
                    f"{token.word} ({_UNSUPPORTED[token.word]}) is not supported yet",
                    "Remove it.",
                    code=_STATEMENT,
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
        raise Flaw(token.at, f"{token} begins no statement", "Check the block.", code=_STATEMENT)

    def _go_on_at(self, place: int) -> None:
        self._tokens = Tokens(_LEXICON, self._text, place, self._end)

    def _output(self, at: int, binary: bool) -> Output:
        """Read an output: characters as they stand ('*' is a blank), `#n[fd]` values with their digits."""
        text, place = self._text, self._tokens.next_at
        if not text.startswith("[", place):
            raise Flaw(at, "'[' is missing after the output", "Write DPRNT[X#1[53]].", code=_STATEMENT)
        place += 1
        pieces: list[str | Printed] = []
        while not text.startswith("]", place):
            if place >= self._end:
                raise Flaw(at, "the output is not closed", "Write ']' at its end.", code=_STATEMENT)
            if text[place] == "#":
                self._go_on_at(place)
                value = self._variable()
                place = self._tokens.token.at
                found = _FORMAT_DIGITS.match(text, place, self._end)
                if found is None or (not binary and found[2] is None):
                    raise Flaw(
                        place,
                        "the digits of the value are missing",
                        "Write #1[53]: five before the point, three after it (BPRNT: #1[3]).",
                        code=_STATEMENT,
                    )
                first, second = int(found[1]), int(found[2] or 0)
                whole, decimals = (0, first) if binary else (first, second)
                if not binary and not 0 < whole + decimals <= _MOST_DIGITS:
                    raise Flaw(place, "a value has 1 to 8 digits", "Write fewer, like [53].", code=_STATEMENT)
                pieces.append(Printed(value, whole, decimals))
                place = found.end()
            elif _PRINTED_TEXT.match(text, place):
                pieces.append(text[place])
                place += 1
            else:
                raise Flaw(
                    place,
                    f"'{text[place]}' cannot be put out",
                    "Use letters, digits, * / + -.",
                    code=_STATEMENT,
                )
        self._go_on_at(place + 1)
        return Output(at, binary, tuple(pieces))

    def _set_names(self, at: int) -> Names:
        found = _NAME_LIST.match(self._text, self._tokens.next_at, self._end)
        if found is None:
            raise Flaw(
                at, "SETVN without a number and names", "Write SETVN 510[DEPTH,WIDTH].", code=_STATEMENT
            )
        names = tuple(name.strip() for name in found[2].split(","))
        if any(len(name) > _LONGEST_NAME for name in names):
            raise Flaw(
                found.start(2),
                f"a name is longer than {_LONGEST_NAME} characters",
                "Shorten it.",
                code=_STATEMENT,
            )
        self._go_on_at(found.end())
        return Names(at, int(self._label(float(found[1]), found.start(1))), names)

    def _assignment(self) -> Assignment:
        at = self._tokens.token.at
        target = self._variable()
        if self._tokens.token.word != "=":
            raise Flaw(
                self._tokens.token.at,
                f"'=' is missing before {self._tokens.token}",
                "Write an assignment like #1=10.",
                code=_STATEMENT,
            )
        self._tokens.step()
        value = self._expression()
        return Assignment(at, target, value, self._comment())

    def _comment(self) -> str:
        found = _COMMENT.search(self._text, self._tokens.behind, self._end)
        return "" if found is None else found[1].strip()

    def _if(self) -> If:
        tokens = self._tokens
        at = tokens.step().at
        condition = self._condition("IF")
        word = tokens.token.word
        if word == "GOTO":
            return If(at, condition, self._goto())
        if word != "THEN":
            raise Flaw(
                tokens.token.at,
                f"GOTO or THEN is missing before {tokens.token}",
                "Write IF [...] GOTO 10, or IF [...] THEN #1=0.",
                code=_STATEMENT,
            )
        tokens.step()
        if tokens.token.word == "GOTO":
            return If(at, condition, self._goto())
        if tokens.token.word != "#":
            raise Flaw(
                tokens.token.at,
                "only an assignment may follow THEN",
                "Write IF [...] GOTO and jump over the block.",
                code=_STATEMENT,
            )
        return If(at, condition, self._assignment())

    def _condition(self, word: str) -> Expression:
        token = self._tokens.token
        if token.word != "[":
            raise Flaw(
                token.at, f"'[' is missing after {word}", f"Write {word} [#1 EQ 0] ...", code=_STATEMENT
            )
        return self._bracket()

    def _goto(self) -> Goto:
        at = self._tokens.step().at
        token = self._tokens.token
        if token.kind == "number":
            number = Number(token.at, float(self._digits("the block number")))
            return Goto(at, number)
        if token.word not in ("#", "["):
            raise Flaw(
                token.at, f"the block number is missing before {token}", "Write GOTO 10.", code=_STATEMENT
            )
        return Goto(at, self._expression(operand_only=True))

    def _while(self) -> While:
        tokens = self._tokens
        at = tokens.step().at
        condition = self._condition("WHILE")
        if tokens.token.word != "DO":
            raise Flaw(
                tokens.token.at,
                f"DO is missing before {tokens.token}",
                "Write WHILE [...] DO 1.",
                code=_STATEMENT,
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

    # ------------------------------------------------------------------ words

    def _words(self) -> Statement:
        words: list[Address] = []
        tokens = self._tokens
        at = tokens.token.at
        while tokens.token.kind == "letter":
            letter = tokens.step()
            if tokens.token.word == "=":
                raise Flaw(
                    tokens.token.at,
                    f"'=' after the address {letter.word}",
                    f"Write {letter.word}#1, or {letter.word}[...].",
                    code=_STATEMENT,
                )
            words.append(Address(letter.at, letter.word, self._expression(operand_only=True)))
        return self._sorted(at, words)

    def _sorted(self, at: int, words: list[Address]) -> Statement:
        for index, word in enumerate(words):
            code = _constant(word.value)
            if word.letter == "G" and code is not None:
                if code in (_MACRO_CALL, _MODAL_CALL, _MODAL_CALL_EACH):
                    return self._macro_call(code, index, words)
                if code == _CANCEL_MODAL:
                    return Cancel(word.at, tuple(words[:index] + words[index + 1 :]))
                if code in self.calls.g:
                    return self._by_code(word, self.calls.g[code], index, words)
            if word.letter == "M" and code is not None:
                if code == _RETURN:
                    return self._return(word, words)
                if code in (_INTERRUPT_ON, _INTERRUPT_OFF):
                    return self._interrupt(word, code, words)
                if code in self.calls.m:
                    return self._by_code(word, self.calls.m[int(code)], index, words)
                if code in self.calls.m_sub:
                    return self._sub_call(word, self.calls.m_sub[int(code)], words)
            if word.letter == "T" and self.calls.t is not None:
                return self._sub_call(word, self.calls.t, words, word.value)
        return Words(at, tuple(words))

    def _return(self, word: Address, words: list[Address]) -> Statement:
        target = next((each for each in words if each.letter == "P"), None)
        others = [each for each in words if each is not word and each is not target]
        if target is None:
            return Restart(word.at) if self.repeats and not others else Words(words[0].at, tuple(words))
        if others:
            raise Flaw(
                others[0].at,
                "M99 P and other words in one block",
                "Write them in a block before.",
                code=_STATEMENT,
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
            raise Flaw(
                words[0].at,
                f"words before G{code:g}",
                f"G{code:g} comes first: all other words are arguments.",
                code=_STATEMENT,
            )
        every = code == _MODAL_CALL_EACH
        if every and arguments:
            raise Flaw(
                arguments[0].at,
                "arguments beside G66.1",
                "The words of the blocks that follow are the arguments.",
                code=_STATEMENT,
            )
        check_arguments(arguments)
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
            raise Flaw(
                at,
                f"M{code:g} and other words in one block",
                "Write them in a block before.",
                code=_STATEMENT,
            )
        return Interrupt(word.at, program)

    def _by_code(self, word: Address, program: int, index: int, words: list[Address]) -> MacroCall:
        before = words[:index]
        repeats = next((each.value for each in words if each.letter == "L"), None)
        rest = [each for each in words[index + 1 :] if each.letter != "L"]
        if word.letter == "M" and before:
            raise Flaw(
                before[0].at,
                f"words before M{_constant(word.value):g}",
                "An M code that calls a macro comes first.",
                code=_STATEMENT,
            )
        check_arguments([each for each in rest if each.letter not in "GP"])
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

    # ------------------------------------------------------------------ expressions

    def _expression(self, operand_only: bool = False) -> Expression:
        if operand_only:
            if self._tokens.token.word in ("+", "-"):
                return read_expression(self._tokens, _OPERATORS, self._plain_operand, 4)
            return self._plain_operand()
        return read_expression(self._tokens, _OPERATORS, self._operand)

    def _plain_operand(self) -> Expression:
        token = self._tokens.token
        if token.kind == "number" or token.word in ("#", "["):
            return self._operand()
        if token.kind == "word" and (token.word in FUNCTIONS or token.word in ("POW", "ADP")):
            raise Flaw(
                token.at,
                f"{token.word} right after an address",
                f"Write brackets around it: [{token.word}[...]].",
                code=_FORMAT,
            )
        raise Flaw(
            token.at, f"a number is missing before {token}", "Write a number, #1 or [...].", code=_FORMAT
        )

    def _operand(self) -> Expression:
        tokens = self._tokens
        token = tokens.token
        if token.kind == "number":
            value = real_value(token, _LARGEST_NUMBER)
            tokens.step()
            return Number(token.at, value, "." in token.text)
        if token.word == "#":
            return self._variable()
        if token.word == "[":
            return self._bracket()
        if token.kind == "word" and token.word in FUNCTIONS:
            return self._function()
        if token.word == "POW":
            tokens.step()
            return Function(token.at, "POW", self._list(2))
        if token.word == "ADP":
            tokens.step()
            (argument,) = self._list(1)
            if not isinstance(argument, Variable) or not 1 <= argument.number <= 33:
                raise Flaw(token.at, "ADP takes a local variable", "Write ADP[#1].", code=_FORMAT)
            return Function(token.at, "ADP", (argument,))
        if token.word in _UNSUPPORTED:
            raise Flaw(token.at, f"{token.word} is not supported yet", "Remove it.", code=_FORMAT)
        raise Flaw(
            token.at,
            f"a value is missing before {token}",
            "Write a number, a variable, a function or brackets.",
            code=_FORMAT,
        )

    def _variable(self) -> Variable:
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
            return Variable(at, -1, self._bracket())
        raise Flaw(
            token.at,
            f"the number of the variable is missing before {token}",
            "Write #1, #[...] with an expression, or #[NAME].",
            code=_FORMAT,
        )

    def _function(self) -> Function:
        tokens = self._tokens
        name = tokens.step()
        if name.word != "ATAN":
            return Function(name.at, name.word, self._list(1))
        arguments = self._list(1, 2)
        if len(arguments) == 1 and tokens.token.word == "/" and self._bracket_follows():
            tokens.step()
            arguments = (*arguments, self._bracket())
        return Function(name.at, "ATAN" if len(arguments) == 1 else "ATAN2", arguments)

    def _bracket_follows(self) -> bool:
        return self._text[self._tokens.next_at : self._end].lstrip(" \t").startswith("[")

    def _bracket(self) -> Expression:
        return self._list(1)[0]

    def _list(self, count: int, most: int = 0) -> tuple[Expression, ...]:
        tokens = self._tokens
        token = tokens.token
        if token.word != "[":
            raise Flaw(token.at, f"'[' is missing before {token}", "Write brackets.", code=_FORMAT)
        if self._brackets >= MOST_BRACKETS:
            raise Flaw(
                token.at,
                f"more than {MOST_BRACKETS} brackets inside each other",
                "Keep a part in a variable.",
                code="PS0118",
            )
        self._brackets += 1
        tokens.step()
        found = [self._expression()]
        while len(found) < max(count, most) and tokens.token.word == ",":
            tokens.step()
            found.append(self._expression())
        if tokens.token.word != "]" or len(found) < count:
            missing = "']'" if len(found) >= count else "','"
            raise Flaw(
                tokens.token.at,
                f"{missing} is missing before {tokens.token}",
                "Check the brackets.",
                code=_FORMAT,
            )
        tokens.step()
        self._brackets -= 1
        return tuple(found)


def check_arguments(arguments: list[Address]) -> None:
    """Refuse what cannot be an argument.

    Raises:
        Flaw: An address that has no local variable, or one that stands twice in the first form.
    """
    argument_numbers(arguments)


def argument_numbers(arguments: list[Address] | tuple[Address, ...]) -> list[int]:
    """Return the local variable of each argument.

    I, J and K of which one repeats are the second form; a number given twice counts last.

    Raises:
        Flaw: An address that has no local variable, more repetitions than there are variables.
    """
    numbers = []
    seen: set[str] = set()
    row, last = 0, -1
    repeated = _repeats(arguments)
    for word in arguments:
        letter = word.letter
        if letter not in ARGUMENTS_I:
            raise Flaw(
                word.at,
                f"{letter} cannot be an argument of a macro",
                "G, L, N, O and P have no local variable.",
                code="PS0129" if letter == "G" else "PS0119",
            )
        if repeated and letter in IJK:
            place = IJK.index(letter)
            if place <= last:
                row += 1
            last = place
            if row >= MOST_REPEATS:
                raise Flaw(
                    word.at, f"{letter} for the 11th time", "I, J and K repeat up to 10 times.", code="PS0129"
                )
            numbers.append(FIRST_REPEATED + 3 * row + place)
            continue
        if letter in seen:
            raise Flaw(word.at, f"the argument {letter} stands twice", "Write it once.", code="PS0129")
        seen.add(letter)
        numbers.append(ABC.get(letter, ARGUMENTS_I[letter]))
    return numbers


def _repeats(arguments: list[Address] | tuple[Address, ...]) -> bool:
    letters = [word.letter for word in arguments if word.letter in IJK]
    return len(set(letters)) < len(letters)


def _constant(value: Expression) -> float | None:
    return value.value if isinstance(value, Number) else None
