"""Turn a macro into Python source once, so that nothing is parsed while a program is written.

A macro becomes a function without arguments that works on a run's state: `values` of variables and words, `modes`
of the groups, `last` value and `texts` written of each function variable, and the sequence `number`.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from polycnc.language import Emitter, Flaw, Traced
from polycnc.post.macros._blocks import Piece, by_order, escaped, is_empty_test, joined, text_follows
from polycnc.post.macros._elements import Assignment, Code, Element, Initialisation, Numbering, Text, Word
from polycnc.post.macros._expression import Condition, Expression, Name, python_condition, python_value
from polycnc.post.macros._format import NumberFormat
from polycnc.post.macros._macro import If, Line, Statement, elements_of, is_blank
from polycnc.post.macros._symbols import (
    ENDOFLINE,
    LINE_TEXTS,
    OUTPUTORDER,
    SEQUENCE_NUMBER,
    STARTOFLINE,
    TOOLCHANGE,
    CodeSymbol,
    Symbols,
    VariableSymbol,
)

START_WORDS = ("STARTX", "STARTY", "STARTZ")
"""The words that say where a move starts."""

ARGUMENTS = ("values", "modes", "last", "texts", "number", "write")
"""What the compiled builder of a macro takes; it returns the macro, and of LINEAR more, else None (see `Built`)."""

ENDS = ("X", "Y", "Z")
"""The words that say where a move ends."""


@dataclass(frozen=True, slots=True)
class Style:
    """What the parameters say about blocks."""

    separator: str
    numbered: int
    number_format: NumberFormat
    number_start: int
    number_step: int
    number_highest: int

    def before(self, symbol: CodeSymbol | VariableSymbol) -> str:
        """Return what separates a code or variable from what stands before it."""
        return self.separator if symbol.separated else ""


TracedMacro: TypeAlias = Traced[tuple[int, int]]
"""A macro as Python; its places are lines of the macro, from 1, and columns, from 0."""


@dataclass(frozen=True, slots=True)
class Used:
    """Which reserved words any macro of the control file sets; the others need no code."""

    order: bool
    start: bool
    end: bool
    start_point: bool


def used_words(macros: Iterable[Sequence[Statement]], *, start_point: bool) -> Used:
    """Return which reserved words are set anywhere; `start_point`: where a move starts is named anywhere."""
    names = {each.name for macro in macros for each in elements_of(macro) if isinstance(each, Assignment)}
    return Used(OUTPUTORDER in names, STARTOFLINE in names, ENDOFLINE in names, start_point)


def compile_macro(
    name: str, statements: Sequence[Statement], symbols: Symbols, style: Style, used: Used, *, sound: bool
) -> tuple[TracedMacro | None, list[Flaw]]:
    """Return the compiled macro, or None and what is wrong with the names in it.

    A macro that is not `sound`, with lines that could not be read, is only checked for names.
    """
    writer = _Writer(symbols, style, used)
    with writer.out.block(f"def build({', '.join(ARGUMENTS)}):"):
        with writer.out.block("def macro():"):
            writer.statements(statements)
        more = "None, None"
        if name == "LINEAR" and not writer.flaws:
            writer.along(statements)
            more = "along, None"
            steady = _SteadyWriter(symbols, style, used)
            if steady.lines_of(statements):
                writer.out.take(steady.out)
                more = "along, steady"
        writer.out.put(f"return macro, {more}")
    if writer.flaws or not sound:
        return None, writer.flaws
    try:
        return writer.out.compile(f"<macro {name}>"), []
    except Flaw:
        return None, [Flaw(0, "the macro is too long for one expression or IF", "split it", line=1)]


class _Writer:
    """Collect the Python lines of a macro, and for each the place it stems from."""

    def __init__(self, symbols: Symbols, style: Style, used: Used) -> None:
        self.out = Emitter((1, 0))
        self.flaws: list[Flaw] = []
        self._symbols = symbols
        self._style = style
        self._used = used
        self._temporaries = 0

    def along(self, statements: Sequence[Statement]) -> None:
        """Write the macro as a loop over rows of positions, with the same feed for all."""
        names = (*ENDS, *(START_WORDS if self._used.start_point else ()))
        words = ", ".join(f"values[{name!r}]" for name in names)
        with (
            self.out.block("def along(rows, feed, mode):"),
            self.out.block(f"for {words} in rows:"),
        ):
            self.out.put("values['F'], values['FEEDMODE'] = feed, mode")
            self.statements(statements)
            self.out.put("yield")

    def statements(self, statements: Sequence[Statement]) -> None:
        for statement in statements:
            if isinstance(statement, Line):
                self._line(statement)
            else:
                self._if(statement)

    def _if(self, statement: If) -> None:
        for index, branch in enumerate(statement.branches):
            head = "else:"
            if branch.condition is not None:
                self.out.place = (branch.number, branch.condition.at)
                head = f"{'elif' if index else 'if'} {self._condition(branch.condition)}:"
            with self.out.block(head):
                self.statements(branch.body)

    def _condition(self, condition: Condition) -> str:
        try:
            return python_condition(condition, self._value)
        except Flaw as flaw:
            self._flaw(flaw)
            return "0"

    def _line(self, line: Line) -> None:
        pieces: list[Piece] = []
        self._temporaries = 0
        for element in line.elements:
            self.out.place = (line.number, element.at)
            try:
                pieces += self._element(element)
            except Flaw as flaw:
                self._flaw(flaw)
        self.out.place = (line.number, 0)
        if pieces:
            self._block(pieces, self._is_numbered(line))

    def _is_numbered(self, line: Line) -> bool:
        wanted = [element.wanted for element in line.elements if isinstance(element, Numbering)]
        if False in wanted:
            return False
        return self._style.numbered == 1 or (self._style.numbered == 2 and True in wanted)

    def _element(self, element: Element) -> list[Piece]:
        match element:
            case Text(text=text, order=order):
                return [Piece(order, constant=text, sure=not is_blank(element))] if text else []
            case Code():
                return self._code(element)
            case Word(name=name):
                return self._word(element, name)
            case Assignment():
                self._assign(element)
            case Initialisation():
                self._initialise(element)
            case Numbering():
                pass
        return []

    def _code(self, element: Code) -> list[Piece]:
        symbol = self._symbols.codes.get(element.key)
        if symbol is None:
            raise self._unknown(element.at, "code", element.key, self._symbols.codes)
        changes = f"modes[{symbol.group}] = {symbol.number}"
        if element.prefix == "-" and symbol.group >= 0:
            name = self._temporary()
            self.out.put(f'{name} = ""')
            self.out.put(f"if modes[{symbol.group}] != {symbol.number}:")
            self.out.put(f"    {changes}")
            self.out.put(f"    {name} = {self._style.before(symbol) + symbol.text!r}")
            return [Piece(symbol.order, variable=name, is_word=symbol.separated)] if symbol.text else []
        if symbol.group >= 0:
            self.out.put(changes)
        if element.prefix == "*" or not symbol.text:
            return []
        return [Piece(symbol.order, constant=symbol.text, is_word=symbol.separated, sure=True)]

    def _word(self, element: Word, name: str) -> list[Piece]:
        symbols = self._symbols
        if variable := symbols.variables.get(name):
            return [self._variable(variable)]
        temporary = self._temporary()
        if symbols.is_text(name):
            self.out.put(f"{temporary} = text({name!r}, {symbols.use(name)})")
            if name == TOOLCHANGE and "T" in symbols.variables:
                steps = symbols.variables["T"].format.steps("value", temporary)
                self.out.put(f"if not {temporary}:")
                for step in (f"value = {symbols.use('T')}", *steps):
                    self.out.put(f"    {step}")
        elif symbols.is_number(name):
            self.out.put(f"{temporary} = decimal({symbols.use(name)})")
        elif name in symbols.codes:
            raise Flaw(element.at, f"{name} is a code, not a word", f"write !{name}!")
        else:
            raise self._unknown(element.at, "word", name, symbols.words(), "variables need a format")
        return [Piece(symbols.orders.get(name, 0), variable=temporary)]

    def _variable(self, variable: VariableSymbol) -> Piece:
        name = self._temporary()
        memory = variable.memory
        separator = self._style.before(variable)
        self.out.put(f"value = {self._symbols.use(variable.key)}")
        steps = ("if value - value: raise OverflowError", *variable.format.steps("value", name, separator))
        if variable.modal:
            self.out.put(f'if value == last[{memory}]: {name} = ""')
            self.out.put("else:")
            steps = (
                *steps,
                f"last[{memory}] = value",
                f'if {name} == texts[{memory}]: {name} = ""',
                f"else: texts[{memory}] = {name}",
            )
        for step in steps:
            self.out.put(f"    {step}" if variable.modal else step)
        return Piece(variable.order, variable=name, is_word=variable.separated, sure=not variable.modal)

    def _assign(self, element: Assignment) -> None:
        name, symbols = element.name, self._symbols
        if isinstance(element.value, str):
            if name not in LINE_TEXTS:
                only = f"only {' and '.join(LINE_TEXTS)} can be set to one"
                raise Flaw(element.at, f"{name} does not take a text", only)
            self.out.put(f"{symbols.use(name)} = {element.value!r}")
            return
        self._check_number(Name(element.at, name))
        if name in symbols.codes:
            raise Flaw(element.at, f"{name} is a code and has no value", f"set its mode with !*{name}!")
        if symbols.is_kept(name):
            raise Flaw(
                element.at,
                f"{name} is set by events, not by macros",
                "use another name, or write strict = true in the parameters if the name is your own",
            )
        self._set(name, element.value)

    def _set(self, name: str, expression: Expression) -> None:
        """Write the assignment of a number, which is finite."""
        self.out.place = (self.out.place[0], expression.at)
        self.out.put(f"value = {python_value(expression, self._value)}")
        self.out.put("if value - value: raise OverflowError")
        self.out.put(f"{self._symbols.use(name)} = value")

    def _initialise(self, element: Initialisation) -> None:
        symbols = self._symbols
        if code := symbols.codes.get(element.key):
            if element.value is not None:
                raise Flaw(element.value.at, f"{code.key} is a code and has no value", f"write &{code.key}&")
            self._reset(code)
            return
        variable = symbols.variables.get(element.key)
        if variable is None:
            known = [*symbols.codes, *symbols.variables]
            raise self._unknown(element.at, "code or function variable", element.key, known)
        if element.value is not None:
            self._set(variable.key, element.value)
        elif variable.origin is not None:
            self.out.put(f"{symbols.use(variable.key)} = {variable.origin!r}")
        self.out.put(f"last[{variable.memory}] = texts[{variable.memory}] = None")

    def _reset(self, code: CodeSymbol) -> None:
        if code.group >= 0:
            self.out.put(f"modes[{code.group}] = 0")

    def _block(self, pieces: Sequence[Piece], numbered: bool) -> None:
        if test := is_empty_test(pieces):
            with self.out.block(f"if {test}:"):
                self._ordered(pieces, numbered)
        else:
            self._ordered(pieces, numbered)

    def _ordered(self, pieces: Sequence[Piece], numbered: bool) -> None:
        style, symbols = self._style, self._symbols
        numbers: list[Piece] = []
        if numbered:
            self._count()
            numbers = [Piece(symbols.orders[SEQUENCE_NUMBER], variable="numbered", is_word=True, sure=True)]
        ordered = by_order([*numbers, *pieces])
        if not self._used.order or ordered == (*numbers, *pieces):
            self._write(pieces, numbered)
            return
        with self.out.block(f"if {symbols.use(OUTPUTORDER)} == 1.0:"):
            if numbered and style.separator:
                self.out.put(f"numbered = {style.separator!r} + numbered")
                if test := text_follows(ordered[ordered.index(numbers[0]) + 1 :]):
                    self.out.put(f"if {test}: numbered += {style.separator!r}")
            self._write(ordered)
        with self.out.block("else:"):
            self._write(pieces, numbered)

    def _count(self) -> None:
        style = self._style
        self.out.put("count = number[0]")
        following = f"count + {style.number_step}"
        if style.number_highest:
            following += (
                f" if count + {style.number_step} <= {style.number_highest} else {style.number_start}"
            )
        self.out.put(f"number[0] = {following}")
        number = style.number_format
        before, behind = (text.replace("%", "%%") for text in (number.before, number.behind))
        self.out.put(f"numbered = {before + number.conversion + behind!r} % count")

    def _write(self, pieces: Sequence[Piece], numbered: bool = False) -> None:
        separator = self._style.separator
        start = f"{{{self._symbols.use(STARTOFLINE)}}}" if self._used.start else ""
        end = f"{{{self._symbols.use(ENDOFLINE)}}}" if self._used.end else ""
        lead = f"{{numbered}}{escaped(separator)}" if numbered else ""
        end += escaped("\n")
        block, surplus = joined(pieces, separator)
        if not surplus:
            self.out.put(f'write(f"{start}{lead}{block}{end}")')
        elif start or lead:
            self.out.put(f'line = f"{block}{end}"')
            self.out.put(f'write(f"{start}{lead}{{line[{surplus}:]}}")')
        else:
            self.out.put(f'line = f"{block}{end}"')
            self.out.put(f"write(line[{surplus}:])")

    def _value(self, name: Name) -> str:
        self._check_number(name)
        if name.text in self._symbols.codes:
            raise Flaw(name.at, f"{name.text} is a code and has no value", "use a variable of another name")
        return self._symbols.use(name.text)

    def _check_number(self, name: Name) -> None:
        if self._symbols.is_text(name.text):
            raise Flaw(name.at, f"{name.text} is a text", "expressions are made of numbers")

    def _temporary(self) -> str:
        self._temporaries += 1
        return f"t{self._temporaries}"

    def _flaw(self, flaw: Flaw) -> None:
        flaw.line = self.out.place[0]
        self.flaws.append(flaw)

    def _unknown(
        self, at: int, what: str, name: str, known: Iterable[str] | Mapping[str, object], hint: str = ""
    ) -> Flaw:
        names = list(known)
        if close := difflib.get_close_matches(name, names, n=1):
            hint = f"did you mean {close[0]}?"
        elif not hint:
            hint = f"known here: {', '.join(names)}" if names else f"the control file defines no {what}"
        return Flaw(at, f"there is no {what} {name}", hint)


class _SteadyWriter(_Writer):
    """Write a function that says what a macro writes when nothing but the end of the move changes any more.

    It returns the lines of the branches that are taken, each with whether it is numbered and its pieces: texts with
    whether they are words, or the name of an axis alone; None where the macro would change anything else.
    """

    def lines_of(self, statements: Sequence[Statement]) -> bool:
        """Write it; return whether it can be: no branch and no value hangs on where the move goes."""
        used = self._used
        self._varies = used.order or used.start or used.end
        with self.out.block("def steady():"):
            self.out.put("lines = []")
            self.statements(statements)
            self.out.put("return lines")
        return not self._varies

    def _line(self, line: Line) -> None:
        self._temporaries = 0
        self.out.put("pieces, solid = [], False")
        for element in line.elements:
            self.out.place = (line.number, element.at)
            self._steady(element)
        if any(is_blank(element) for element in line.elements):
            self.out.put(
                "if not solid: return None"
            )  # whether the blanks are written hangs on where the move goes
        self.out.put(f"if pieces: lines.append(({self._is_numbered(line)}, pieces))")

    def _steady(self, element: Element) -> None:
        match element:
            case Text(text=text) if text:
                self.out.put(f"pieces.append(({text!r}, False))")
                if not is_blank(element):
                    self.out.put("solid = True")
            case Code():
                symbol = self._symbols.codes[element.key]
                if symbol.group >= 0:
                    self.out.put(f"if modes[{symbol.group}] != {symbol.number}: return None")
                is_quiet = element.prefix == "*" or (element.prefix == "-" and symbol.group >= 0)
                if symbol.text and not is_quiet:
                    self.out.put(f"pieces.append(({symbol.text!r}, {symbol.separated}))", "solid = True")
            case Word(name=name) if name in ENDS and name in self._symbols.variables:
                self.out.put(f"pieces.append(({name!r},))")
            case Word(name=name) if variable := self._symbols.variables.get(name):
                self.out.put(f"value = {self._value_of(name)}")
                if variable.modal:
                    self.out.put(f"if value != last[{variable.memory}]: return None")
                else:
                    self.out.put("if value - value: return None")
                    self.out.put(*variable.format.steps("value", "text_of_it"))
                    self.out.put(f"pieces.append((text_of_it, {variable.separated}))", "solid = True")
            case Word(name=name):
                self._value_of(name)
                piece = self._word(element, name)[0].variable
                self.out.put(f"if {piece}: pieces.append(({piece}, False)); solid = True")
            case Assignment() | Initialisation():
                self.out.put("return None")
            case _:
                pass

    def _value(self, name: Name) -> str:
        self._value_of(name.text)
        return super()._value(name)

    def _value_of(self, name: str) -> str:
        self._varies |= name in (*ENDS, *START_WORDS)
        return self._symbols.use(name)
