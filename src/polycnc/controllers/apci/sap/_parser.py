"""Recursive descent over the tokens of a SAP program: declarations and statements, to a tree.

A mistake ends its statement or declaration; the parser continues after it, so that every mistake of a file is
reported in one go.
"""

from __future__ import annotations

from collections.abc import Callable

from polycnc.controllers.apci.sap._lexer import END, NAME, SourceText, Token
from polycnc.controllers.apci.sap._statement_parser import StatementParser
from polycnc.controllers.apci.sap._syntax import Block, Constant, Expression, Routine, Source, Variable
from polycnc.errors import ProgramError

_TYPES = {"integer": "i", "longint": "i", "double": "d", "real": "d", "boolean": "b"}
_SECTIONS = frozenset({"const", "var", "procedure", "function", "event", "begin"})


def parse(source: SourceText, found: list[Token], errors: list[ProgramError]) -> Source:
    """Return the tree of the tokens of a source; mistakes are added to `errors`, what contains them is left out."""
    return _Parser(source, found, errors).program()


class _Parser(StatementParser):
    def program(self) -> Source:
        name = ""
        if self._take("program"):
            try:
                name = self._name("a program name").text
                self._semicolon()
            except ProgramError as error:
                self._recover(error, _SECTIONS)
        constants, variables, routines = self._declarations(inside=False)
        plain = not (name or constants or variables or routines)
        body: Block
        if self._is("begin"):
            body = self._compound()
            if self._take("."):
                if self._token.kind != END:
                    self._errors.append(
                        self._error(f"{self._token} after the end of the program", "Put it before 'END.'.")
                    )
            elif plain and (self._take(";") or self._token.kind == END):
                body += self._statements(frozenset())
            elif not self._errors:
                self._errors.append(
                    self._error(f"'.' expected, not {self._token}", "A program ends with 'END.'.")
                )
        else:
            body = self._statements(frozenset())
        return Source(name, constants, variables, routines, body, self._tokens[-1].at)

    # Declarations

    def _declarations(
        self, inside: bool
    ) -> tuple[tuple[Constant, ...], tuple[Variable, ...], tuple[Routine, ...]]:
        constants: list[Constant] = []
        variables: list[Variable] = []
        routines: list[Routine] = []
        while True:
            word = self._token
            try:
                if self._take("const"):
                    while self._token.kind == NAME and self._token.word not in _SECTIONS:
                        self._declaration(lambda: constants.append(self._constant()))
                elif self._take("var"):
                    while self._token.kind == NAME and self._token.word not in _SECTIONS:
                        self._declaration(lambda: variables.extend(self._variables()))
                elif word.word in ("procedure", "function", "event") and word.kind == NAME:
                    if inside:
                        error = self._error(
                            f"{word} inside another routine", "Declare it before or after this one."
                        )
                        self._next()
                        raise error
                    routines.append(self._routine())
                else:
                    return tuple(constants), tuple(variables), tuple(routines)
            except ProgramError as error:
                self._recover(error, _SECTIONS)

    def _declaration(self, read: Callable[[], None]) -> None:
        try:
            read()
            self._semicolon()
        except ProgramError as error:
            self._recover(error, _SECTIONS | {";"})
            self._take(";")

    def _constant(self) -> Constant:
        name = self._name("a name")
        self._expect("=", "Write a constant as 'NAME = value;'.")
        return Constant(name.text, self._expression(), name.at)

    def _variables(self) -> list[Variable]:
        names = [self._name("a name")]
        while self._take(","):
            names.append(self._name("a name"))
        self._expect(":", "Write variables as 'a, b : INTEGER;'.")
        bounds: tuple[Expression, Expression] | None = None
        if self._take("array"):
            self._expect("[", "Write an array as 'ARRAY [1..10] OF DOUBLE'.")
            first = self._expression()
            self._expect("..", "Write an array as 'ARRAY [1..10] OF DOUBLE'.")
            bounds = first, self._expression()
            self._expect("]", "Write an array as 'ARRAY [1..10] OF DOUBLE'.")
            self._expect("of", "Write an array as 'ARRAY [1..10] OF DOUBLE'.")
        kind = self._type()
        return [Variable(name.text, kind, bounds, name.at) for name in names]

    def _type(self) -> str:
        kind = _TYPES.get(self._token.word)
        if kind is None:
            raise self._error(
                f"a type expected, not {self._token}", "Types are INTEGER, DOUBLE (or REAL) and BOOLEAN."
            )
        self._next()
        return kind

    def _routine(self) -> Routine:
        word = self._next().word
        name = self._name("a name")
        parameters: list[Variable] = []
        result = condition = None
        if word == "event":
            self._expect("on", "Write an event handler as 'EVENT name ON condition; BEGIN ... END;'.")
            condition = self._expression()
        elif self._take("("):
            parameters += self._variables()
            while self._take(";"):
                parameters += self._variables()
            self._expect(")", "Write parameters as '(a, b : INTEGER; c : DOUBLE)'.")
        if word == "function":
            self._expect(":", "Write a function as 'FUNCTION name (a : DOUBLE) : DOUBLE;'.")
            result = self._type()
        self._semicolon()
        constants, variables, _ = self._declarations(inside=True)
        if not self._is("begin"):
            raise self._error(f"'BEGIN' expected, not {self._token}", f"'{name.text}' has no body yet.")
        body = self._compound()
        self._semicolon()
        return Routine(name.text, tuple(parameters), result, condition, constants, variables, body, name.at)
