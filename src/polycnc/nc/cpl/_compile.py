"""A CPL program as Python source: a generator that yields NC blocks, calls and waits."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

from polycnc.language import Chain, Emitter, Flaw, Flow, Jump, Link, Mark, Python, Source, Traced
from polycnc.nc.cpl._faults import INVALID_ASSIGNMENT
from polycnc.nc.cpl._functions import work_of
from polycnc.nc.cpl._operators import NUMERIC, Typed
from polycnc.nc.cpl._stores import Stores
from polycnc.nc.cpl._syntax import (
    Assign,
    Call,
    Case,
    Command,
    Dim,
    Expression,
    For,
    If,
    Name,
    NcBlock,
    NcLine,
    NcWord,
    Number,
    Repeat,
    Statement,
    SubCall,
    Wait,
    While,
    Word,
)
from polycnc.nc.cpl._values import is_text, makes_text
from polycnc.nc.cpl._variables import KIND_NAMES, Variable
from polycnc.nc.text._silent import is_silent

SLICE = 20_000
"""How much a program does, in assignments, before it lets time pass."""
_CALL = 4
_SUB_PROGRAM = 2000
_CALLS_OF_CONTROL = re.compile(r"\b(?:function|setter)_([A-Z]\w*)\(")
_SUB_PROGRAMS = re.compile(r"\byield SubProgram\(")


def _work(lines: Iterable[str]) -> int:
    """Return how much lines of Python do, in assignments: what they call, and what the control is asked for."""
    text = "\n".join(lines)
    return (
        text.count("\n")
        + 1
        + _CALL * text.count("(")
        + sum(work_of(name) for name in _CALLS_OF_CONTROL.findall(text))
        + _SUB_PROGRAM * len(_SUB_PROGRAMS.findall(text))
    )


class Compiler:
    """Write the Python of one program; what is wrong with it is collected in `flaws`."""

    def __init__(self, source: Source, *, stepping: bool = False) -> None:
        self.flaws: list[Flaw] = []
        self._source = source
        self._stepping = stepping
        self._out: Emitter[int] = Emitter(0)
        self._stores = Stores(self._out)
        self._values = self._stores.values
        self._line = 0
        self._selectors: dict[int, str] = {}

    @property
    def variables(self) -> dict[Variable, int]:
        """The variables of the program, each with the place where it is first."""
        return self._stores.variables

    def compile(
        self, statements: list[Statement], whole: Iterable[Statement], name: str
    ) -> Traced[int] | None:
        """Return the program compiled, None if something is wrong with it; `whole` are the inner statements too."""
        gotos = set()
        for statement in whole:
            if isinstance(statement, Dim):
                self._values.fields[statement.variable.name] = len(statement.sizes) * (
                    not statement.parameter
                )
            elif isinstance(statement, Jump):
                gotos.add(statement.target)
        self._stores.hot = bool(gotos)
        out = self._out
        out.divert()
        flow = Flow(out, self, rounds=SLICE, weigh=_work, changes=lambda: self._stores.changes)
        flow.write(statements, used=gotos)
        body = out.diverted()
        if self.flaws:
            return None
        out.place = 0
        with out.block("def program(G, M, host, arguments):"):
            self._head()
            out.take(body)
        try:
            return out.compile(name)
        except Flaw as flaw:
            self.flaws.append(flaw)
            return None

    def _head(self) -> None:
        out = self._out
        out.put("if 0: yield", "F = cell()")
        for variable, at in self.variables.items():
            out.place = at
            if variable.scope == "local":
                out.put(f"{variable.python} = None")
            elif variable.scope == "parameter":
                out.put(f"{variable.python} = parameter(arguments, {variable.name!r}, {variable.kind!r})")
            elif variable.scope == "global":
                out.put(f"G.setdefault({variable.name!r})")
        for python, (made, at) in self._stores.hosts.items():
            out.place = at
            out.put(f"{python} = {made}")

    # What the flow asks

    def before(self, statement: Statement) -> None:
        """Write the step to the line of a statement, of a program for stepping."""
        if self._stepping and not isinstance(statement, Mark | NcLine):
            here = self._source.line_of(statement.at)
            if here != self._line:
                self._out.put(f"yield Step({here})")
            self._line = here

    def statement(self, statement: Statement) -> None:
        """Write a statement that is no flow."""
        self._stores.changes += not (isinstance(statement, NcLine) and _is_silent(self._source, statement))
        try:
            self._statement(statement)
        except Flaw as flaw:
            self.flaws.append(flaw)

    def begin(self, structure: If | Case | For | While | Repeat) -> None:
        """Write what comes once before a structure."""
        if isinstance(structure, If):
            return
        self._stores.hot += not isinstance(structure, Case)
        self._stores.changes += isinstance(structure, For)
        try:
            if isinstance(structure, For):
                self._set(structure.counter, structure.start)
            elif isinstance(structure, Case):
                name = self._selectors[id(structure)] = self._stores.temporary()
                selector = self._stores.tested(lambda: self._values.integer(structure.selector))
                self._out.put(f"{name} = ({selector}) + 0")
        except Flaw as flaw:
            self.flaws.append(flaw)

    def condition(self, structure: If | Case | For | While | Repeat, number: int) -> str | None:
        """Return the condition of a branch, or of a round."""
        match structure:
            case Case():
                labels = structure.branches[number][0]
                return _is_one_of(self._selectors[id(structure)], labels) if labels else None
            case If():
                return self._tested(structure.condition) if number == 0 else None
            case While():
                return self._tested(structure.condition)
            case For():
                return self._asked(lambda: self._counts(structure))
            case Repeat():
                return None

    def end(self, loop: For | While | Repeat) -> str | None:
        """Write what a round ends with; return the condition of UNTIL."""
        ends = None
        if isinstance(loop, For):
            self._stores.changes += 1
            self._out.place = loop.at
            total: Expression = Chain(loop.at, loop.counter, (Link(loop.at, "+", _step(loop)),))
            try:
                self._set(loop.counter, total)
            except Flaw as flaw:
                self.flaws.append(flaw)
        elif isinstance(loop, Repeat):
            assert loop.condition is not None
            self._out.place = loop.condition.at
            ends = self._tested(loop.condition)
        self._stores.hot -= 1
        return ends

    def _tested(self, tree: Expression) -> str:
        return self._asked(lambda: self._values.condition(tree))

    def _asked(self, make: Callable[[], str]) -> str:
        try:
            return self._stores.tested(make)
        except Flaw as flaw:
            self.flaws.append(flaw)
            return "False"

    def _counts(self, loop: For) -> str:
        """Return the condition under which a counting loop goes on."""
        step = _step(loop)
        up, down = (self._compared(loop.counter, operator, loop.end) for operator in ("<=", ">="))
        if (sign := _sign(step)) is not None:
            return up if sign > 0 else down
        return f"({up}) if {self._compared(step, '>=', Number(loop.at, 0))} else ({down})"

    def _compared(self, left: Expression, operator: str, right: Expression) -> str:
        return self._values.condition(Chain(left.at, left, (Link(left.at, operator, right),)))

    def _set(self, counter: Name, tree: Expression) -> None:
        boxes = self._stores.new_boxes()
        value = self._values.value(tree, counter.variable.kind)
        self._stores.open_boxes(boxes)
        self._stores.store(counter, value)
        self._stores.close_boxes(boxes)

    # Statements

    def _statement(self, statement: Statement) -> None:
        match statement:
            case Assign():
                self._assign(statement, self._stores.new_boxes())
            case Command():
                boxes = self._stores.new_boxes()
                text = self._values.host_call(statement.call)
                self._stores.open_boxes(boxes)
                self._out.put(text)
                self._stores.close_boxes(boxes)
            case NcLine():
                self._lines(statement)
            case NcBlock():
                self._nc_block(statement)
            case Dim():
                self._stores.dimension(statement)
            case SubCall():
                self._sub_call(statement)
            case Wait():
                self._wait(statement)

    def _sub_call(self, statement: SubCall) -> None:
        boxes = self._stores.new_boxes()
        arguments = f"({''.join(f'{self._stores.passed(tree)}, ' for tree in statement.arguments)})"
        if boxes:
            self._stores.open_boxes(boxes)
            values = self._stores.temporary()
            self._out.put(f"{values} = {arguments}")
            self._stores.close_boxes(boxes)
            arguments = values
        line, address, name = statement.line, statement.address, statement.name
        skip = f", {statement.skip}" * (statement.skip != 0)
        self._out.put(
            f"yield SubProgram({line}, {address!r}, {name!r}, {arguments}, {statement.unlinked}{skip})"
        )

    def _lines(self, statement: NcLine) -> None:
        for name in statement.names.values():
            self._values.value(name)
        if self._stepping:
            for line in range(statement.line, statement.last + 1):
                self._out.put(f"yield Step({line})", f"yield Lines({line}, {line})")
        else:
            self._out.put(f"yield Lines({statement.line}, {statement.last})")

    def _assign(self, statement: Assign, boxes: list[tuple[str, Name]]) -> None:
        target = statement.target
        if isinstance(target, Call):
            text = self._set_system(statement, target)
            self._stores.open_boxes(boxes)
            self._out.put(text)
            self._stores.close_boxes(boxes)
            return
        if target.variable.kind == "S":
            self._assign_text(target, statement.value, boxes)
            return
        typed = self._values.value(statement.value, target.variable.kind)
        place = self._values.element(target) if target.indices else None
        self._stores.open_boxes(boxes)
        self._stores.store(target, typed, place)
        self._stores.close_boxes(boxes)

    def _assign_text(self, target: Name, value: Expression, boxes: list[tuple[str, Name]]) -> None:
        python, index = self._values.element(target)
        stored, put = self._values.stored(value), "put_new" if makes_text(value) else "put"
        if target.variable.scope == "permanent":
            if isinstance(value, Word):
                raise Flaw(value.at, INVALID_ASSIGNMENT.what, "a permanent variable cannot be deleted")
            stored = f"kept({stored})"
        self._stores.open_boxes(boxes)
        place = f"{python}[{index}]" if index else python
        self._stores.guard(target, place)
        self._out.put(f"{place} = {put}({place}, {stored})")
        self._stores.close_boxes(boxes)

    def _set_system(self, statement: Assign, target: Call) -> str:
        if target.function == "MID$":
            first, *others = target.arguments
            if not isinstance(first, Name) or first.variable.kind != "S" or None in others:
                raise Flaw(target.at, "MID$ sets a part of a character field", "MID$(A$,start[,number])=text")
            places = [self._values.assigned(tree) for tree in others if tree is not None]
            start, number = (*places, "None")[:2]
            field, text = self._values.stored(first), self._values.text(statement.value)
            return f"put_part({field}, {start}, {number}, {text})"
        value = self._stores.passed(statement.value)
        setter = self._stores.host(target.function, target.at, "setter")
        return f"{setter}({', '.join((value, *self._values.arguments(target)))})"

    def _wait(self, statement: Wait) -> None:
        if statement.condition is None and statement.duration_ms is None:
            skip = f", {statement.skip}" * (statement.skip != 0)
            self._out.put(f"yield Waiting({statement.line}, None, None{skip})")
            return
        boxes = self._stores.new_boxes()
        condition = "None"
        if statement.condition is not None:
            state = "True" if statement.state is None else self._values.condition(statement.state)
            asked = (
                self._stores.host("IC", statement.condition.at),
                *self._values.arguments(statement.condition),
            )
            condition = f"ic_condition({state}, {statement.negated}, {', '.join(asked)})"
        duration = (
            "None"
            if statement.duration_ms is None
            else f"duration({self._values.integer(statement.duration_ms)})"
        )
        answer = self._stores.temporary()
        self._stores.open_boxes(boxes)
        self._out.put(f"{answer} = yield Waiting({statement.line}, {condition}, {duration})")
        self._stores.close_boxes(boxes)
        if statement.result is not None:
            if statement.result.variable.kind != "I":
                raise Flaw(statement.result.at, "the result variable of WAIT is INTEGER")
            self._stores.store(statement.result, Typed(Python(answer), "X", leaf=True))

    def _nc_block(self, statement: NcBlock) -> None:
        boxes = self._stores.new_boxes()
        first = self._source.begin(statement.line) - 1
        words = [f"{self._word(word, word.at - first)}," for word in statement.words]
        self._stores.open_boxes(boxes)
        begun = f"yield NcValues({statement.line}, {statement.number}, {statement.skip}, ("
        ended = f"), {statement.message!r})"
        if all(isinstance(word.value, float) for word in statement.words):
            self._out.put(f"{begun}{' '.join(words)}{ended}")
        else:
            _put_words(self._out, self._source, begun, list(zip(statement.words, words, strict=True)), ended)
        self._stores.close_boxes(boxes)

    def _word(self, word: NcWord, column: int) -> str:
        if isinstance(word.value, float):
            return f"BlockWord({word.address!r}, {word.index}, {word.value!r}, {column})"
        if not word.address:
            value = self._values.text(word.value) if is_text(word.value) else self._stores.passed(word.value)
            return f"*inserted(host, {value}, {column})"
        typed = self._values.value(word.value)
        if typed.kind not in NUMERIC:
            raise Flaw(word.at, f"the address {word.address} takes a number, not {KIND_NAMES[typed.kind]}")
        value = self._values.rounded(typed).text
        return f"BlockWord({word.address!r}, {word.index}, as_word({value}), {column})"


def _is_silent(source: Source, lines: NcLine) -> bool:
    return all(is_silent(source.line(each)) for each in range(lines.line, lines.last + 1))


def _step(loop: For) -> Expression:
    return Number(loop.at, 1) if loop.step is None else loop.step


def _is_one_of(name: str, labels: tuple[int, ...]) -> str:
    return f"{name} == {labels[0]}" if len(labels) == 1 else f"{name} in {labels!r}"


def _sign(step: Expression) -> int | None:
    """Return the sign of a step that is a constant."""
    match step:
        case Number():
            return 1
        case Chain() | Name() | Call():
            return None
    operand = getattr(step, "operand", None)
    if isinstance(operand, Number) and getattr(step, "operator", "") in ("+", "-"):
        return -1 if getattr(step, "operator", "") == "-" else 1
    return None


def _put_words(
    out: Emitter[int], source: Source, begun: str, words: list[tuple[NcWord, str]], ended: str
) -> None:
    """Write a block on several lines: what goes wrong in brackets is said there."""
    at = out.place
    out.put(begun)
    for word, python in words:
        out.place = at if isinstance(word.value, float) else source.text.index("[", word.at)
        out.put(python)
    out.place = at
    out.put(ended)
