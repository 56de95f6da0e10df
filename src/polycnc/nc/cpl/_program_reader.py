"""Read a program: its lines, their instructions, and the structures that these make."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial

from polycnc.language import END, Flaw, Jump, Mark, Source, whole_value
from polycnc.nc.cpl._faults import NESTING_TOO_DEEP, Fault
from polycnc.nc.cpl._fields import check_sizes
from polycnc.nc.cpl._functions import FUNCTIONS
from polycnc.nc.cpl._lexicon import RESERVED
from polycnc.nc.cpl._nc_lines import PLAIN_RULES, read_nc_line, sequence_number
from polycnc.nc.cpl._open_lines import open_line
from polycnc.nc.cpl._reader import Reader, assignment_missing
from polycnc.nc.cpl._structures import Consequence, Structure, Structures, Unreachable
from polycnc.nc.cpl._syntax import (
    Assign,
    Call,
    Case,
    Command,
    Dim,
    For,
    If,
    Name,
    NcLine,
    Repeat,
    Statement,
    SubCall,
    Wait,
    While,
)
from polycnc.nc.cpl._variables import variable
from polycnc.nc.text._program import TextRules

CASES = 10
"""How deep CASE may be nested (Manual 003, 2.5.7)."""
_NUMBERED = re.compile(r"[ \t]*([0-9]+)")
_JUMPS = re.compile(r"GOTO[ \t]*(N?)0*([0-9]+)", re.IGNORECASE)
_NC_JUMP = re.compile(r"N([0-9]+)")
_PROGRAM_NAME = re.compile(r"[A-Za-z0-9_/][^\s\[\]:,=]*")
_ENDS = frozenset(("ELSE", "ENDIF", "NEXT", "UNTIL", "END", "ENDCASE", "LABEL", "OTHERWISE", "REM", ":"))
_LARGEST = (1 << 31) - 1


def read_program(
    source: Source,
    alone: frozenset[str] = frozenset(),
    rules: TextRules = PLAIN_RULES,
    *,
    in_text: bool = False,
) -> tuple[list[Statement], list[Flaw]]:
    """Return the statements of a program, and all that is wrong with its lines.

    The codes of `alone` call programs where they stand alone in a block; `rules` say how blocks are read.
    """
    read = Structures()
    reader = _ProgramReader(source, alone, rules, in_text, read)
    for line in range(1, source.line_count + 1):
        reader.line(line, source.begin(line), source.end(line))
    return read.top, read.ended()


class _ProgramReader:
    def __init__(
        self, source: Source, alone: frozenset[str], rules: TextRules, opened: bool, read: Structures
    ) -> None:
        self._opened = opened
        self._rules = rules
        self._alone = alone
        self._read = read
        self._text = source.text
        self._jumps = {f"{letter.upper()}{number}" for letter, number in _JUMPS.findall(source.text)}
        self._goes_on = False
        self._in_block = 0  # instructions that the present block has so far
        self._line = 0
        close = self._close
        self._instructions: dict[str, Callable[[Reader, int], None]] = {
            "IF": self._if, "ELSE": self._else, "ENDIF": partial(close, If, "ENDIF"),
            "FOR": self._for, "NEXT": self._next, "WHILE": self._while, "END": partial(close, While, "END"),
            "REPEAT": self._repeat, "UNTIL": self._until, "CASE": self._case, "LABEL": self._label,
            "OTHERWISE": self._otherwise, "ENDCASE": partial(close, Case, "ENDCASE"), "GOTO": self._goto,
            "DIM": self._dim, "PDIM": self._dim, "CALL": self._call, "WAIT": self._wait,
        }  # fmt: skip

    def line(self, number: int, begin: int, end: int) -> None:
        found = _NUMBERED.match(self._text, begin, end)
        if found is None and not self._text[begin:end].strip(" \t"):
            return
        self._line = number
        goes_on, self._goes_on = self._goes_on, False
        try:
            if found:
                self._in_block = 0
                if self._jumps:
                    self._target(found.start(1), found[1].lstrip("0") or "0")
                self._cpl(found.end(), end)
            elif goes_on:
                self._cpl(begin, end)
            else:
                if self._jumps:
                    self._target(begin, sequence_number(self._text[begin:end]))
                self._nc(begin, end, number)
        except Flaw as flaw:
            self._read.flaws.append(flaw)
        except Consequence:
            pass

    def _target(self, at: int, name: str) -> None:
        """Note a place that is jumped to; most numbers are not."""
        if name in self._jumps:
            self._read.body.append(Mark(at, name))

    def _nc(self, begin: int, end: int, number: int) -> None:
        opened = open_line(self._text, begin, end, number) if self._opened else None
        read = [opened] if opened else read_nc_line(self._text, begin, end, number, self._alone, self._rules)
        for statement in read:
            before = self._read.body[-1] if self._read.body else None
            if isinstance(statement, NcLine) and isinstance(before, NcLine) and before.last == number - 1:
                before.last = number
                for variable, name in statement.names.items():
                    before.names.setdefault(variable, name)
            else:
                self._read.body.append(statement)

    def _cpl(self, begin: int, end: int) -> None:
        reader = Reader(self._text, begin, end)
        tokens = reader.tokens
        while tokens.token.kind != END:
            token = tokens.token
            if token.word == "REM":
                return
            if token.word == ":":
                tokens.step()
                self._goes_on = tokens.token.kind == END
            elif token.kind == "label":
                tokens.step()
                self._read.body.append(Mark(token.at, token.word))
            elif instruction := self._instructions.get(token.word):
                tokens.step()
                instruction(reader, token.at)
                self._in_block += 1
            else:
                self._plain(reader)
                self._in_block += 1

    def _plain(self, reader: Reader) -> None:
        """Read an assignment or a command."""
        token = reader.tokens.token
        if token.kind != "name":
            raise Flaw(
                token.at, f"no instruction begins with {token}", "an NC block begins with N or a letter"
            )
        target: Name | Call
        if token.word in RESERVED:
            target = reader.call()
            function = FUNCTIONS[token.word]
            if reader.tokens.token.word != "=":
                if function.run is not None:
                    raise Flaw(
                        token.at, f"{token.word} does nothing by itself", "assign its value to a variable"
                    )
                self._read.body.append(Command(token.at, target))
                _ends(reader)
                return
            if not function.settable:
                raise Flaw(token.at, f"nothing can be assigned to {token.word}")
        else:
            target = reader.name("a variable")
            if reader.tokens.token.word != "=":
                raise assignment_missing(reader)
        reader.tokens.step()
        self._read.body.append(Assign(token.at, target, reader.expression()))
        _ends(reader)

    # Structures

    def _close(self, kind: type[Structure], keyword: str, reader: Reader, at: int) -> None:
        self._read.finish(kind, keyword, at)
        _ends(reader)

    def _if(self, reader: Reader, at: int) -> None:
        condition = reader.expression()
        reader.tokens.expect("THEN", "the condition ends with THEN, in the line of its IF")
        statement = If(at, condition)
        self._read.begin(statement, statement.then)

    def _else(self, reader: Reader, at: int) -> None:
        statement = self._read.top_of(If, "ELSE", at)
        assert isinstance(statement, If)
        if statement.has_else:
            raise Flaw(at, "a second ELSE", "an IF has one ELSE at most")
        statement.has_else = True
        self._read.body = statement.otherwise

    def _for(self, reader: Reader, at: int) -> None:
        counter = reader.name("the counting variable")
        if counter.variable.kind not in ("I", "R", "D"):
            raise Flaw(counter.at, "a counting variable is a number")
        if counter.indices:
            raise Flaw(counter.at, "a counting variable is no field")
        reader.tokens.expect("=", "FOR I%=1 STEP 2 TO 9")
        start = reader.expression()
        step = reader.expression() if reader.tokens.take("STEP") else None
        reader.tokens.expect("TO", "STEP comes before TO: FOR I%=1 STEP 2 TO 9")
        statement = For(at, counter, start, step, reader.expression())
        self._read.begin(statement, statement.body)
        _ends(reader)

    def _next(self, reader: Reader, at: int) -> None:
        statement = self._read.finish(For, "NEXT", at)
        assert isinstance(statement, For)
        token = reader.tokens.token
        if token.kind == "name" and token.word not in RESERVED:
            name = reader.name("the counting variable")
            if name.variable != statement.counter.variable:
                raise Flaw(name.at, f"this NEXT ends the FOR of {statement.counter.variable.name}")
        _ends(reader)

    def _while(self, reader: Reader, at: int) -> None:
        condition = reader.expression()
        if reader.tokens.token.kind != END:
            reader.tokens.expect("DO", "the condition ends with DO")
        statement = While(at, condition)
        self._read.begin(statement, statement.body)

    def _repeat(self, reader: Reader, at: int) -> None:
        statement = Repeat(at)
        self._read.begin(statement, statement.body)

    def _until(self, reader: Reader, at: int) -> None:
        statement = self._read.finish(Repeat, "UNTIL", at)
        assert isinstance(statement, Repeat)
        statement.condition = reader.expression()
        _ends(reader)

    def _case(self, reader: Reader, at: int) -> None:
        selector = reader.expression()
        reader.tokens.expect("OF", "CASE X% OF")
        if sum(isinstance(each, Case) for each in self._read.open) >= CASES:
            raise Flaw(at, NESTING_TOO_DEEP.what, f"at most {CASES} CASE inside each other", code="2153")
        statement = Case(at, selector)
        self._read.begin(statement, Unreachable(self._read.flaws))

    def _label(self, reader: Reader, at: int) -> None:
        statement = self._read.top_of(Case, "LABEL", at)
        assert isinstance(statement, Case)
        if statement.branches and not statement.branches[-1][0]:
            raise Flaw(at, "LABEL after OTHERWISE", "OTHERWISE is the last part of its CASE")
        values = [_constant(reader)]
        while reader.tokens.take(","):
            values.append(_constant(reader))
        self._read.body = []
        statement.branches.append((tuple(values), self._read.body))

    def _otherwise(self, reader: Reader, at: int) -> None:
        statement = self._read.top_of(Case, "OTHERWISE", at)
        assert isinstance(statement, Case)
        if statement.branches and not statement.branches[-1][0]:
            raise Flaw(at, "a second OTHERWISE")
        self._read.body = []
        statement.branches.append(((), self._read.body))

    # Others

    def _goto(self, reader: Reader, at: int) -> None:
        token = reader.tokens.token
        found = _NC_JUMP.fullmatch(token.word)
        if token.kind == "label":
            name = token.word
        elif found:
            name = f"N{found[1].lstrip('0') or '0'}"
        elif token.kind == "number" and token.text.isdigit():
            name = token.text.lstrip("0") or "0"
        else:
            raise Flaw(token.at, f"{token} is no jump destination", "GOTO N20, GOTO 120 or GOTO .LABEL")
        reader.tokens.step()
        self._read.body.append(Jump(token.at, name))
        _ends(reader)

    def _dim(self, reader: Reader, at: int) -> None:
        parameter = self._text[at : at + 4].upper() == "PDIM"
        token = reader.tokens.token
        if token.kind != "name" or token.word in RESERVED:
            raise Flaw(token.at, f"a variable is missing before {token}")
        target = variable(token)
        if target.scope == "permanent":
            raise Flaw(
                token.at,
                "permanent variables are not dimensioned",
                "they are declared in wmhperm.dat, anwperm.dat",
            )
        if parameter != (target.scope == "parameter"):
            raise Flaw(token.at, "PDIM takes a parameter like P1$, DIM other variables")
        reader.tokens.step()
        opening = reader.tokens.expect("(", "DIM NAME(size) or DIM NAME(size,size)")
        sizes = [_constant(reader)]
        if reader.tokens.take(","):
            sizes.append(_constant(reader))
        reader.tokens.expect(")", "a field has one dimension or two")
        try:
            check_sizes(target.kind, tuple(sizes))
        except Fault as fault:
            raise Flaw(opening.at, fault.what, fault.hint) from None
        self._read.body.append(Dim(at, target, tuple(sizes), parameter))
        _ends(reader)

    def _call(self, reader: Reader, at: int) -> None:
        tokens = reader.tokens
        found = _PROGRAM_NAME.match(self._text, tokens.token.at)
        if found is None or tokens.token.kind == END:
            raise Flaw(tokens.token.at, f"the name of a program is missing before {tokens.token}")
        tokens.jump(found.end())
        arguments: tuple[object, ...] = ()
        if tokens.take("["):
            arguments, open_end = reader.arguments("]")
            if open_end or None in arguments:
                raise Flaw(found.end(), "an argument of a sub-program is missing")
        unlinked = tokens.take("DIN")
        if self._in_block or tokens.token.kind != END:
            raise Flaw(
                at, "CALL needs a block of its own", "put the other instructions into blocks of their own"
            )
        self._read.body.append(SubCall(at, self._line, "", found[0], arguments, unlinked))  # type: ignore[arg-type]

    def _wait(self, reader: Reader, at: int) -> None:
        tokens = reader.tokens
        statement = Wait(at, self._line)
        if tokens.take("("):
            statement = _wait_parameters(reader, at, self._line)
        if self._in_block or tokens.token.word == ":":
            raise Flaw(
                at, "a block with WAIT has no colon", "put the other instructions into blocks of their own"
            )
        self._read.body.append(statement)
        _ends(reader)


def _ends(reader: Reader) -> None:
    token = reader.tokens.token
    if token.kind != END and token.word not in _ENDS:
        raise Flaw(
            token.at, f"the instruction does not go on with {token}", "a colon separates two instructions"
        )


def _constant(reader: Reader) -> int:
    sign = -1 if reader.tokens.take("-") else 1
    token = reader.tokens.token
    if token.kind != "number" or not token.text.isdigit():
        raise Flaw(token.at, f"an INTEGER constant is missing before {token}")
    reader.tokens.step()
    return sign * whole_value(token, _LARGEST)


def _wait_parameters(reader: Reader, at: int, line: int) -> Wait:
    tokens = reader.tokens
    condition, state, negated = None, None, False
    duration, result = None, None
    if tokens.token.word not in (",", ")"):
        negated = tokens.take("NOT")
        in_parentheses = tokens.take("(")
        if tokens.token.word != "IC":
            raise Flaw(tokens.token.at, "the condition of WAIT is IC(...)", "WAIT(IC(1,1,1)=TRUE)")
        condition = reader.call()
        if in_parentheses:
            tokens.expect(")", "close the parenthesis")
        if tokens.take("="):
            state = reader.expression()
    if tokens.take(",") and tokens.token.word not in (",", ")"):
        duration = reader.expression()
    if tokens.take(","):
        result = reader.name("the result variable")
    tokens.expect(")", "WAIT(condition,duration,result)")
    if condition is None and duration is None:
        raise Flaw(at, "WAIT with parentheses has a condition or a duration")
    return Wait(at, line, condition, state, negated, duration, result)
