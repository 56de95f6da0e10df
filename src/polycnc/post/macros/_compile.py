"""Turn a macro into Python source once, so that nothing is parsed while a program is written.

A macro becomes a function without arguments that works on a run's state: `values` of variables and words, `modes`
of the groups, `last` value and `texts` written of each function variable, and the sequence `number`.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import CodeType

from polycnc.post.macros._blocks import Piece, by_order, escaped, is_empty_test, joined, text_follows
from polycnc.post.macros._elements import Assignment, Code, Element, Initialisation, Numbering, Text, Word
from polycnc.post.macros._expression import Flaw, Formula, Name
from polycnc.post.macros._format import NumberFormat
from polycnc.post.macros._macro import If, Line, Statement, elements_of
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

ARGUMENTS = ("values", "modes", "last", "texts", "number", "write")
"""What the compiled builder of a macro takes; it returns the macro."""


@dataclass(frozen=True, slots=True)
class Style:
    """What the parameters say about blocks."""

    separator: str
    numbered: int
    number_format: NumberFormat
    number_start: int
    number_step: int
    number_highest: int


@dataclass(frozen=True, slots=True)
class Compiled:
    """A macro as Python, and the place in the macro (line from 1, column from 0) of every line of it."""

    code: CodeType
    lines: tuple[str, ...]
    places: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class Used:
    """Which reserved words any macro of the control file sets; the others need no code."""

    order: bool
    start: bool
    end: bool


def used_words(macros: Iterable[Sequence[Statement]]) -> Used:
    """Return which reserved words are set anywhere."""
    names = {each.name for macro in macros for each in elements_of(macro) if isinstance(each, Assignment)}
    return Used(OUTPUTORDER in names, STARTOFLINE in names, ENDOFLINE in names)


def compile_macro(
    name: str, statements: Sequence[Statement], symbols: Symbols, style: Style, used: Used, *, sound: bool
) -> tuple[Compiled | None, list[Flaw]]:
    """Return the compiled macro, or None and what is wrong with the names in it.

    A macro that is not `sound`, with lines that could not be read, is only checked for names.
    """
    writer = _Writer(symbols, style, used)
    writer.statements(statements, 2)
    if writer.flaws or not sound:
        return None, writer.flaws
    head = (f"def build({', '.join(ARGUMENTS)}):", "    def macro():")
    lines = (*head, *(writer.lines or ["        pass"]), "    return macro")
    try:
        code = compile("\n".join(lines), f"<macro {name}>", "exec")
    except (RecursionError, MemoryError, SyntaxError):
        return None, [Flaw(0, "the macro is too long for one expression or IF", "split it", 1)]
    return Compiled(code, lines, ((1, 0), (1, 0), *writer.places)), []


class _Writer:
    """Collect the Python lines of a macro, and for each the place it stems from."""

    def __init__(self, symbols: Symbols, style: Style, used: Used) -> None:
        self.lines: list[str] = []
        self.places: list[tuple[int, int]] = []
        self.flaws: list[Flaw] = []
        self._symbols = symbols
        self._style = style
        self._used = used
        self._indent = ""
        self._place = (1, 0)
        self._temporaries = 0

    def statements(self, statements: Sequence[Statement], depth: int) -> None:
        for statement in statements:
            self._indent = "    " * depth
            if isinstance(statement, Line):
                self._line(statement)
            else:
                self._if(statement, depth)

    def _if(self, statement: If, depth: int) -> None:
        for index, branch in enumerate(statement.branches):
            self._indent = "    " * depth
            if branch.condition is None:
                self._put("else:")
            else:
                self._place = (branch.number, branch.condition.at)
                try:
                    condition = self._python(branch.condition)
                except Flaw as flaw:
                    self._flaw(flaw)
                    condition = "0"
                self._put(f"{'elif' if index else 'if'} {condition}:")
            before = len(self.lines)
            self.statements(branch.body, depth + 1)
            if len(self.lines) == before:
                self._indent = "    " * (depth + 1)
                self._put("pass")

    def _line(self, line: Line) -> None:
        pieces: list[Piece] = []
        self._temporaries = 0
        for element in line.elements:
            self._place = (line.number, element.at)
            try:
                pieces += self._element(element)
            except Flaw as flaw:
                self._flaw(flaw)
        self._place = (line.number, 0)
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
                return [Piece(order, constant=text, sure=True)] if text else []
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
            self._put(f'{name} = ""')
            self._put(f"if modes[{symbol.group}] != {symbol.number}:")
            self._put(f"    {changes}")
            self._put(f"    {name} = {self._style.separator + symbol.text!r}")
            return [Piece(symbol.order, variable=name, is_word=True)] if symbol.text else []
        if symbol.group >= 0:
            self._put(changes)
        if element.prefix == "*" or not symbol.text:
            return []
        return [Piece(symbol.order, constant=symbol.text, is_word=True, sure=True)]

    def _word(self, element: Word, name: str) -> list[Piece]:
        symbols = self._symbols
        if variable := symbols.variables.get(name):
            return [self._variable(variable)]
        temporary = self._temporary()
        if symbols.is_text(name):
            self._put(f"{temporary} = text({name!r}, {symbols.use(name)})")
            if name == TOOLCHANGE and "T" in symbols.variables:
                steps = symbols.variables["T"].format.steps("value", temporary)
                self._put(f"if not {temporary}:")
                for step in (f"value = {symbols.use('T')}", *steps):
                    self._put(f"    {step}")
        elif symbols.is_number(name):
            self._put(f"{temporary} = decimal({symbols.use(name)})")
        elif name in symbols.codes:
            raise Flaw(element.at, f"{name} is a code, not a word", f"write !{name}!")
        else:
            raise self._unknown(element.at, "word", name, symbols.words(), "variables need a format")
        return [Piece(symbols.orders.get(name, 0), variable=temporary)]

    def _variable(self, variable: VariableSymbol) -> Piece:
        name = self._temporary()
        memory = variable.memory
        separator = self._style.separator
        self._put(f"value = {self._symbols.use(variable.key)}")
        steps = ("if value - value: raise OverflowError", *variable.format.steps("value", name, separator))
        if variable.modal:
            self._put(f'if value == last[{memory}]: {name} = ""')
            self._put("else:")
            steps = (
                *steps,
                f"last[{memory}] = value",
                f'if {name} == texts[{memory}]: {name} = ""',
                f"else: texts[{memory}] = {name}",
            )
        for step in steps:
            self._put(f"    {step}" if variable.modal else step)
        return Piece(variable.order, variable=name, is_word=True, sure=not variable.modal)

    def _assign(self, element: Assignment) -> None:
        name, symbols = element.name, self._symbols
        if isinstance(element.value, str):
            if name not in LINE_TEXTS:
                only = f"only {' and '.join(LINE_TEXTS)} can be set to one"
                raise Flaw(element.at, f"{name} does not take a text", only)
            self._put(f"{symbols.use(name)} = {element.value!r}")
            return
        self._check_number(Name(name, element.at))
        if name in symbols.codes:
            raise Flaw(element.at, f"{name} is a code and has no value", f"set its mode with !*{name}!")
        self._place = (self._place[0], element.value.at)
        self._put(f"value = {self._python(element.value)}")
        self._put("if value - value: raise OverflowError")
        self._put(f"{symbols.use(name)} = value")

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
            self._place = (self._place[0], element.value.at)
            self._put(f"{symbols.use(variable.key)} = {self._python(element.value)}")
        elif variable.origin is not None:
            self._put(f"{symbols.use(variable.key)} = {variable.origin!r}")
        self._put(f"last[{variable.memory}] = texts[{variable.memory}] = None")

    def _reset(self, code: CodeSymbol) -> None:
        if code.group >= 0:
            self._put(f"modes[{code.group}] = 0")

    def _block(self, pieces: Sequence[Piece], numbered: bool) -> None:
        style, symbols = self._style, self._symbols
        test = is_empty_test(pieces)
        if test:
            self._put(f"if {test}:")
            self._indent += "    "
        numbers: list[Piece] = []
        if numbered:
            self._count()
            numbers = [Piece(symbols.orders[SEQUENCE_NUMBER], variable="numbered", is_word=True, sure=True)]
        ordered = by_order([*numbers, *pieces])
        if not self._used.order or ordered == (*numbers, *pieces):
            self._write(pieces, numbered)
            return
        self._put(f"if {symbols.use(OUTPUTORDER)} == 1.0:")
        self._indent += "    "
        if numbered and style.separator:
            self._put(f"numbered = {style.separator!r} + numbered")
            if test := text_follows(ordered[ordered.index(numbers[0]) + 1 :]):
                self._put(f"if {test}: numbered += {style.separator!r}")
        self._write(ordered)
        self._indent = self._indent[:-4]
        self._put("else:")
        self._indent += "    "
        self._write(pieces, numbered)

    def _count(self) -> None:
        style = self._style
        self._put("count = number[0]")
        following = f"count + {style.number_step}"
        if style.number_highest:
            following += (
                f" if count + {style.number_step} <= {style.number_highest} else {style.number_start}"
            )
        self._put(f"number[0] = {following}")
        number = style.number_format
        before, behind = (text.replace("%", "%%") for text in (number.before, number.behind))
        self._put(f"numbered = {before + number.conversion + behind!r} % count")

    def _write(self, pieces: Sequence[Piece], numbered: bool = False) -> None:
        separator = self._style.separator
        start = f"{{{self._symbols.use(STARTOFLINE)}}}" if self._used.start else ""
        end = f"{{{self._symbols.use(ENDOFLINE)}}}" if self._used.end else ""
        lead = f"{{numbered}}{escaped(separator)}" if numbered else ""
        end += escaped("\n")
        block, surplus = joined(pieces, separator)
        if not surplus:
            self._put(f'write(f"{start}{lead}{block}{end}")')
        elif start or lead:
            self._put(f'line = f"{block}{end}"')
            self._put(f'write(f"{start}{lead}{{line[{surplus}:]}}")')
        else:
            self._put(f'line = f"{block}{end}"')
            self._put(f"write(line[{surplus}:])")

    def _python(self, formula: Formula) -> str:
        return "".join(piece if isinstance(piece, str) else self._value(piece) for piece in formula.pieces)

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

    def _put(self, line: str) -> None:
        self.lines.append(self._indent + line)
        self.places.append(self._place)

    def _flaw(self, flaw: Flaw) -> None:
        flaw.line = self._place[0]
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
