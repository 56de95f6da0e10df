"""Recursive descent over statements; a mistake ends its statement and the parser continues after it."""

from __future__ import annotations

from collections.abc import Callable, Set

from polycnc.controllers.apci.sap._expressions import ExpressionParser
from polycnc.controllers.apci.sap._lexer import END, NAME, TEXT, SourceText, Token
from polycnc.controllers.apci.sap._syntax import (
    Assign,
    Block,
    Call,
    Case,
    Expression,
    For,
    If,
    Name,
    Number,
    Repeat,
    Statement,
    While,
)
from polycnc.errors import ProgramError

_BEHIND_STATEMENT = frozenset({";", "end", "until", "else", "otherwise"})
_STARTS = frozenset({"begin", "if", "while", "repeat", "for", "case"})


class StatementParser(ExpressionParser):
    """Read statements; mistakes are collected in `errors`."""

    def __init__(self, source: SourceText, found: list[Token], errors: list[ProgramError]) -> None:
        super().__init__(source, found)
        self._errors = errors

    # Statements

    def _statements(self, stops: frozenset[str]) -> Block:
        """Read statements until one of `stops`, or the end of the file, which is left to the caller."""
        found: list[Statement] = []
        while self._token.kind != END and not (self._token.kind != TEXT and self._token.word in stops):
            if self._take(";"):
                continue
            try:
                found += self._statement()
                if not (self._is(";") or self._token.kind == END or self._token.word in stops):
                    raise self._error(f"';' expected, not {self._token}", "Write ';' between two statements.")
            except ProgramError as error:
                before = self._token
                self._recover(error, stops | {";", "end", "until"} | _STARTS)
                if self._token is before and self._token.word not in stops:
                    self._next()
        return tuple(found)

    def _compound(self) -> Block:
        begin = self._expect("begin", "")
        body = self._statements(frozenset({"end"}))
        if not self._take("end"):
            hint = f"The BEGIN of line {begin.at.line} has no END."
            self._errors.append(self._error(f"'END' expected, not {self._token}", hint))
        return body

    def _body(self) -> Block:
        """Read the one statement after THEN, ELSE, DO and case labels; it may be none."""
        if self._token.word in _BEHIND_STATEMENT:
            return ()
        with self._nested():
            return self._statement()

    def _statement(self) -> Block:
        word = self._token.word if self._token.kind == NAME else ""
        if word == "begin":
            with self._nested():
                return self._compound()
        special: dict[str, Callable[[], Statement]] = {
            "if": self._if,
            "while": self._while,
            "repeat": self._repeat,
            "for": self._for,
            "case": self._case,
        }
        if word in special:
            with self._nested():
                return (special[word](),)
        if self._token.kind != NAME or self._keyword():
            raise self._error(f"a statement expected, not {self._token}", "Is something missing before it?")
        return (self._assignment_or_call(),)

    def _assignment_or_call(self) -> Statement:
        target = self._name_or_call()
        if not self._is(":="):
            if isinstance(target, Call):
                return target
            if isinstance(target, Name) and target.index is None:
                return Call(target.name, (), target.at)
            raise self._error(
                f"':=' expected, not {self._token}", "Write an assignment as 'variable := value;'."
            )
        at = self._next().at
        if isinstance(target, Call):
            raise self._source.error(
                target.at, f"'{target.name} (...)' cannot be assigned to", "Give a variable on the left."
            )
        return Assign(target, self._expression(), at)

    def _if(self) -> If:
        at = self._token.at
        branches = []
        otherwise: Block = ()
        while True:
            self._next()
            condition = self._head("then", "Write 'IF condition THEN statement ELSE statement;'.")
            branches.append((condition, self._body()))
            if not self._take("else"):
                break
            if not self._is("if"):
                otherwise = self._body()
                break
        return If(tuple(branches), otherwise, at)

    def _while(self) -> While:
        at = self._next().at
        condition = self._head("do", "Write 'WHILE condition DO statement;'.")
        return While(condition, self._body(), at)

    def _repeat(self) -> Repeat:
        at = self._next().at
        body = self._statements(frozenset({"until"}))
        self._expect("until", f"The REPEAT of line {at.line} has no UNTIL.")
        return Repeat(body, self._expression(), at)

    def _for(self) -> For:
        at = self._next().at
        name = self._name("a variable")
        hint = "Write 'FOR i := 1 TO 10 DO statement;'."
        self._expect(":=", hint)
        first = self._expression()
        step = -1 if self._is("downto") else 1
        if not self._take("downto"):
            self._expect("to", hint)
        last = self._head("do", hint)
        return For(Name(name.text, None, name.at), first, last, step, self._body(), at)

    def _case(self) -> Case:
        at = self._next().at
        selector = self._head(
            "of", "Write 'CASE value OF 1: statement; 2..5: statement; ELSE statement; END;'."
        )
        branches = []
        otherwise: Block = ()
        ends = frozenset({"end", "else", "otherwise"})
        while self._token.kind != END and self._token.word not in ends:
            try:
                labels = [self._label()]
                while self._take(","):
                    labels.append(self._label())
                self._expect(":", "Write ':' between the values and the statement of a case.")
                branches.append((tuple(labels), self._body()))
                if self._token.word not in ends:
                    self._semicolon()
            except ProgramError as error:
                self._recover(error, ends | {";"})
                self._take(";")
        if self._take("else") or self._take("otherwise"):
            otherwise = self._statements(frozenset({"end"}))
        self._expect("end", f"The CASE of line {at.line} has no END.")
        return Case(selector, tuple(branches), otherwise, at)

    def _label(self) -> tuple[Expression, Expression]:
        first = self._expression()
        return (first, self._expression()) if self._take("..") else (first, first)

    # Recovery

    def _head(self, word: str, hint: str) -> Expression:
        """Read the expression in the head of a statement and `word` after it."""
        at = self._token.at
        try:
            value = self._expression()
            self._expect(word, hint)
        except ProgramError as error:
            self._recover(error, {word} | _BEHIND_STATEMENT | _STARTS)
            self._take(word)
            value = Number(0, at)  # nobody looks at a tree with mistakes
        return value

    def _recover(self, error: ProgramError, stops: Set[str]) -> None:
        self._errors.append(error)
        while self._token.kind != END and (self._token.kind == TEXT or self._token.word not in stops):
            self._next()
