"""A CPL program as Python source: a generator that yields NC blocks, calls and waits."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence

from polycnc.language import Chain, Emitter, Flaw, Link, Python, Source, Traced
from polycnc.nc.cpl._faults import INVALID_ASSIGNMENT
from polycnc.nc.cpl._reader import single
from polycnc.nc.cpl._shape import taken_apart
from polycnc.nc.cpl._syntax import (
    Assign,
    Call,
    Case,
    Command,
    Dim,
    Expression,
    For,
    Goto,
    If,
    Name,
    NcBlock,
    NcLine,
    NcWord,
    Number,
    Repeat,
    Statement,
    SubCall,
    Target,
    Wait,
    While,
    Word,
)
from polycnc.nc.cpl._values import NUMERIC, Typed, Values
from polycnc.nc.cpl._variables import KIND_NAMES, Variable

SLICE = 20_000
"""How often a program jumps back before it lets time pass."""
_GROUP = 32
_LABEL = re.compile("\x01([0-9]+)\x01")  # no text constant holds it: repr() writes it otherwise
_NUMBER = "+-0123456789"
_CONVERSIONS = {"I": "to_integer", "R": "to_real", "D": "to_double", "B": "to_boolean"}


class Compiler:
    """Write the Python of one program; what is wrong with it is collected in `flaws`."""

    def __init__(self, source: Source, *, stepping: bool = False) -> None:
        self.flaws: list[Flaw] = []
        self.variables: dict[Variable, int] = {}
        self._pythons: dict[Variable, str] = {}
        self._source = source
        self._stepping = stepping
        self._hosts: dict[str, tuple[str, int]] = {}
        self._values = Values(self._use, self._host, self._box, self._temporary)
        self._boxes: list[tuple[str, Name]] = []
        self._count = 0
        self._out: Emitter[int] = Emitter(0)
        self._segments: list[Emitter[int]] = [self._out]
        self._labels: dict[int, int] = {}
        self._targets: dict[str, int] = {}
        self._apart: set[int] = set()
        self._gotos: set[str] = set()
        self._jumps = False
        self._loops = 0

    def compile(
        self, statements: list[Statement], whole: Iterable[Statement], name: str
    ) -> Traced[int] | None:
        """Return the program compiled, None if something is wrong with it; `whole` are the inner statements too."""
        for statement in whole:
            if isinstance(statement, Dim):
                self._values.fields[statement.variable.name] = len(statement.sizes) * (
                    not statement.parameter
                )
            elif isinstance(statement, Goto):
                self._gotos.add(statement.target)
        self._apart, self._jumps = taken_apart(statements, self._gotos)
        self._body(statements)
        if self.flaws:
            return None
        try:
            return self._assembled().compile(name)
        except Flaw as flaw:
            self.flaws.append(flaw)
            return None

    # Assembly

    def _assembled(self) -> Emitter[int]:
        whole: Emitter[int] = Emitter(0)
        with whole.block("def program(G, M, host, arguments):"):
            whole.put("if 0: yield", "F = cell()", f"t = {SLICE}")
            for variable, at in self.variables.items():
                whole.place = at
                if variable.scope == "local":
                    whole.put(f"{variable.python} = None")
                elif variable.scope == "parameter":
                    whole.put(
                        f"{variable.python} = parameter(arguments, {variable.name!r}, {variable.kind!r})"
                    )
                elif variable.scope == "global":
                    whole.put(f"G.setdefault({variable.name!r})")
            for python, (made, at) in self._hosts.items():
                whole.place = at
                whole.put(f"{python} = {made}")
            if self._jumps:
                whole.put("pc = 0")
                with whole.block("while True:"):
                    self._put_segments(whole)
                    whole.put("return")
            else:
                self._copy(self._segments[0], whole)
        return whole

    def _put_segments(self, whole: Emitter[int]) -> None:
        grouped = len(self._segments) > _GROUP
        for first in range(0, len(self._segments), _GROUP):
            group = self._segments[first : first + _GROUP]
            if grouped:
                with whole.block(f"if pc < {first + len(group)}:"):
                    self._put_group(whole, group, first)
            else:
                self._put_group(whole, group, first)

    def _put_group(self, whole: Emitter[int], group: Sequence[Emitter[int]], first: int) -> None:
        for number, segment in enumerate(group, first):
            with whole.block(f"if pc <= {number}:"):
                self._copy(segment, whole)

    def _copy(self, segment: Emitter[int], whole: Emitter[int]) -> None:
        if self._jumps:
            labels = self._labels
            segment.lines = [
                _LABEL.sub(lambda found: str(labels[int(found[1])]), line) if "\x01" in line else line
                for line in segment.lines
            ]
        whole.take(segment)

    # Jumps

    def _new_label(self) -> int:
        self._count += 1
        return self._count

    def _mark(self, label: int) -> None:
        """Begin a segment that `label` leads to."""
        place = self._out.place
        self._out = Emitter(place)
        self._segments.append(self._out)
        self._labels[label] = len(self._segments) - 1

    def _jump(self, label: int) -> None:
        self._out.put(f"pc = \x01{label}\x01; continue")

    def _tick(self) -> None:
        self._out.put("t -= 1")
        with self._out.block("if t < 0:"):
            self._out.put(f"t = {SLICE}", "yield PAUSE")

    # Names

    def _use(self, variable: Variable, at: int) -> str:
        python = self._pythons.get(variable)
        if python is None:
            self.variables[variable] = at
            self._pythons[variable] = python = variable.python
        return python

    def _host(self, name: str, at: int, door: str = "function") -> str:
        python = f"{door}_{name.replace('#', '_n').replace('$', '_s')}"
        self._hosts.setdefault(python, (f"host.{door}({name!r})", at))
        return python

    def _box(self, name: Name) -> str:
        self._count += 1
        self._boxes.append((f"b{self._count}", name))
        return f"b{self._count}"

    def _temporary(self) -> str:
        self._count += 1
        return f"t{self._count}"

    def _new_boxes(self) -> list[tuple[str, Name]]:
        """Return where the variables are collected that functions set in what is turned into Python next."""
        self._boxes = []
        return self._boxes

    def _open_boxes(self, boxes: list[tuple[str, Name]]) -> None:
        for python, name in boxes:
            place, index = self._values.element(name)
            now = f"{place}[{index}]" if index else place
            variable = name.variable
            self._out.put(f"{python} = handed({variable.name!r}, {variable.kind!r}, {now})")

    def _close_boxes(self, boxes: list[tuple[str, Name]]) -> None:
        for python, name in boxes:
            with self._out.block(f"if {python}.__class__ is Box and {python}.is_set:"):
                self._store(name, Typed(Python(f"{python}.value"), "X", leaf=True))

    # Statements

    def _body(self, statements: list[Statement]) -> None:
        line = 0
        for statement in statements:
            self._out.place = statement.at
            if self._stepping and not isinstance(statement, Target | NcLine):
                here = self._source.line_of(statement.at)
                if here != line:
                    self._out.put(f"yield Step({here})")
                line = here
            try:
                self._statement(statement)
            except Flaw as flaw:
                self.flaws.append(flaw)

    def _statement(self, statement: Statement) -> None:
        match statement:
            case Assign():
                self._assign(statement, self._new_boxes())
            case Command():
                boxes = self._new_boxes()
                text = self._values.host_call(statement.call)
                self._open_boxes(boxes)
                self._out.put(text)
                self._close_boxes(boxes)
            case NcLine():
                self._lines(statement)
            case NcBlock():
                self._nc_block(statement)
            case Goto():
                self._goto(statement)
            case Target():
                if statement.name in self._gotos:
                    self._mark(self._target(statement.name))
            case If():
                (self._jumped_if if id(statement) in self._apart else self._if)(statement)
            case Case():
                (self._jumped_case if id(statement) in self._apart else self._case)(statement)
            case For() | While() | Repeat():
                self._loops += 1
                self._any_loop(statement)
                self._loops -= 1
            case Dim():
                self._dim(statement)
            case SubCall():
                self._sub_call(statement)
            case Wait():
                self._wait(statement)

    def _sub_call(self, statement: SubCall) -> None:
        boxes = self._new_boxes()
        arguments = f"({''.join(f'{self._passed(tree)}, ' for tree in statement.arguments)})"
        if boxes:
            self._open_boxes(boxes)
            values = self._temporary()
            self._out.put(f"{values} = {arguments}")
            self._close_boxes(boxes)
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
            self._open_boxes(boxes)
            self._out.put(text)
            self._close_boxes(boxes)
            return
        if target.variable.kind == "S":
            self._assign_text(target, statement.value, boxes)
            return
        typed = self._values.value(statement.value, target.variable.kind)
        place = self._values.element(target) if target.indices else None
        self._open_boxes(boxes)
        self._store(target, typed, place)
        self._close_boxes(boxes)

    def _assign_text(self, target: Name, value: Expression, boxes: list[tuple[str, Name]]) -> None:
        python, index = self._values.element(target)
        stored = self._values.stored(value)
        new = self._values.makes_text(value)
        if target.variable.scope == "permanent":
            if isinstance(value, Word):
                raise Flaw(value.at, INVALID_ASSIGNMENT.what, "a permanent variable cannot be deleted")
            stored = f"kept({stored})"
        self._open_boxes(boxes)
        place = f"{python}[{index}]" if index else python
        self._out.put(f"{place} = {'put_new' if new else 'put'}({place}, {stored})")
        self._close_boxes(boxes)

    def _set_system(self, statement: Assign, target: Call) -> str:
        if target.function == "MID$":
            first, *others = target.arguments
            if not isinstance(first, Name) or first.variable.kind != "S" or None in others:
                raise Flaw(target.at, "MID$ sets a part of a character field", "MID$(A$,start[,number])=text")
            places = [self._values.assigned(tree) for tree in others if tree is not None]
            start, number = (*places, "None")[:2]
            field, text = self._values.stored(first), self._values.text(statement.value)
            return f"put_part({field}, {start}, {number}, {text})"
        value = self._passed(statement.value)
        setter = self._host(target.function, target.at, "setter")
        return f"{setter}({', '.join((value, *self._values.arguments(target)))})"

    def _store(self, target: Name, typed: Typed, place: tuple[str, str] | None = None) -> None:
        """Assign a value to a variable that is no text; `place` is its element where that is known."""
        kind, given = target.variable.kind, typed.kind
        if kind == "S":
            python, index = place or self._values.element(target)
            whole = f"{python}[{index}]" if index else python
            self._out.put(f"{whole} = put({whole}, {typed.python.text})")
            return
        if given == "S" or ((given == "B") != (kind == "B") and given not in ("X", "N")):
            raise Flaw(
                target.at, INVALID_ASSIGNMENT.what, f"{target.variable.name} takes no {KIND_NAMES[given]}"
            )
        python, index = place or self._values.element(target)
        if index:
            key = self._temporary()
            self._out.put(f"{key} = {index}", f"{python}[{key}]")  # so that a wrong index is found first
            index = key
        whole = f"{python}[{index}]" if index else python
        if target.variable.scope == "permanent":
            if given == "N":
                raise Flaw(target.at, INVALID_ASSIGNMENT.what, "a permanent variable cannot be deleted")
            if typed.leaf:
                typed = typed._replace(python=Python(f"kept({typed.python.text})"))
        direct = target.variable.scope in ("local", "parameter") and not index
        self._put_value(whole, direct, kind, typed)

    def _put_value(self, place: str, direct: bool, kind: str, typed: Typed) -> None:
        put, text, given = self._out.put, typed.python.text, typed.kind
        constant = _constant(text)
        if given == "N":
            put(f"{place} = None")
        elif constant is not None and kind in ("R", "D") and given in ("I", "R", "D"):
            put(f"{place} = {single(constant) if kind == 'R' else float(constant)!r}")
        elif _fits(kind, typed, constant):
            put(f"{place} = {text}")
        elif typed.leaf or (kind == "I" and given != "I") or not self._is_hot:
            put(f"{place} = {_CONVERSIONS[kind]}({text})")
        else:
            self._put_checked(place, direct, kind, text)

    @property
    def _is_hot(self) -> bool:
        """Whether what is written now may run many times: then it is worth the longer Python of `_put_checked`."""
        return self._jumps or self._loops > 0

    def _put_checked(self, place: str, direct: bool, kind: str, text: str) -> None:
        """Assign what was reckoned: bring it to its type and see that it is in range."""
        name = place if direct else self._temporary()
        if kind == "I":
            self._out.put(
                f"{name} = {text}", f"if not -2147483648 <= {name} <= 2147483647: raise OverflowError"
            )
        elif kind == "R":
            self._out.put(f"F[0] = {text}", f"{name} = F[0]", f"if {name} - {name}: raise OverflowError")
        else:
            self._out.put(f"{name} = ({text}) * 1.0", f"if {name} - {name}: raise OverflowError")
        if not direct:
            self._out.put(f"{place} = {name}")

    def _dim(self, statement: Dim) -> None:
        variable, sizes = statement.variable, statement.sizes
        place = self._use(variable, statement.at)
        if statement.parameter:
            self._out.put(f"{place} = parameter_field(arguments, {variable.name!r}, {sizes[0]})")
        elif variable.kind == "S" and len(sizes) == 1:
            self._out.put(f"{place} = dimension({place}, {sizes[0]})")
        else:
            self._out.put(f"{place} = dimension_field({place}, {variable.kind!r}, {sizes!r})")

    def _passed(self, tree: Expression) -> str:
        if self._values.is_text(tree):
            return self._values.text(tree)
        return self._values.rounded(self._values.value(tree)).text

    def _wait(self, statement: Wait) -> None:
        if statement.condition is None and statement.duration_ms is None:
            skip = f", {statement.skip}" * (statement.skip != 0)
            self._out.put(f"yield Waiting({statement.line}, None, None{skip})")
            return
        boxes = self._new_boxes()
        condition = "None"
        if statement.condition is not None:
            state = "True" if statement.state is None else self._values.condition(statement.state)
            asked = self._host("IC", statement.condition.at), *self._values.arguments(statement.condition)
            condition = f"ic_condition({state}, {statement.negated}, {', '.join(asked)})"
        duration = (
            "None"
            if statement.duration_ms is None
            else f"duration({self._values.integer(statement.duration_ms)})"
        )
        answer = self._temporary()
        self._open_boxes(boxes)
        self._out.put(f"{answer} = yield Waiting({statement.line}, {condition}, {duration})")
        self._close_boxes(boxes)
        if statement.result is not None:
            if statement.result.variable.kind != "I":
                raise Flaw(statement.result.at, "the result variable of WAIT is INTEGER")
            self._store(statement.result, Typed(Python(answer), "X", leaf=True))

    def _nc_block(self, statement: NcBlock) -> None:
        boxes = self._new_boxes()
        first = self._source.begin(statement.line) - 1
        words = "".join([f"{self._word(word, word.at - first)}, " for word in statement.words])
        self._open_boxes(boxes)
        fixed = f"{statement.line}, {statement.number}, {statement.skip}"
        self._out.put(f"yield NcValues({fixed}, ({words}), {statement.message!r})")
        self._close_boxes(boxes)

    def _word(self, word: NcWord, column: int) -> str:
        if isinstance(word.value, float):
            return f"BlockWord({word.address!r}, {word.index}, {word.value!r}, {column})"
        if not word.address:
            value = (
                self._values.text(word.value)
                if self._values.is_text(word.value)
                else self._passed(word.value)
            )
            return f"*inserted(host, {value}, {column})"
        typed = self._values.value(word.value)
        if typed.kind not in NUMERIC:
            raise Flaw(word.at, f"the address {word.address} takes a number, not {KIND_NAMES[typed.kind]}")
        value = self._values.rounded(typed).text
        return f"BlockWord({word.address!r}, {word.index}, as_word({value}), {column})"

    # Control flow

    def _target(self, name: str) -> int:
        if name not in self._targets:
            self._targets[name] = self._new_label()
        return self._targets[name]

    def _goto(self, statement: Goto) -> None:
        self._tick()
        self._jump(self._target(statement.target))

    def _tested(self, make: Callable[[], str]) -> str:
        """Write what a condition needs before it, and return it."""
        boxes = self._new_boxes()
        text = make()
        if not boxes:
            return text
        self._open_boxes(boxes)
        name = self._temporary()
        self._out.put(f"{name} = {text}")
        self._close_boxes(boxes)
        return name

    def _if(self, statement: If) -> None:
        with self._out.block(f"if {self._tested(lambda: self._values.condition(statement.condition))}:"):
            self._body(statement.then)
        if statement.otherwise:
            with self._out.block("else:"):
                self._body(statement.otherwise)

    def _jumped_if(self, statement: If) -> None:
        otherwise, end = self._new_label(), self._new_label()
        condition = self._tested(lambda: self._values.condition(statement.condition))
        self._out.put(f"if not ({condition}): pc = \x01{otherwise}\x01; continue")
        self._body(statement.then)
        self._jump(end)
        self._mark(otherwise)
        self._body(statement.otherwise)
        self._mark(end)

    def _selector(self, statement: Case) -> str:
        name = self._temporary()
        selector = self._tested(lambda: self._values.integer(statement.selector))
        self._out.put(f"{name} = ({selector}) + 0")
        return name

    def _case(self, statement: Case) -> None:
        name = self._selector(statement)
        keyword = "if"
        for labels, body in statement.branches:
            if labels:
                head = f"{keyword} {_is_one_of(name, labels)}:"
            else:
                head = "else:" if keyword == "elif" else "if True:"
            with self._out.block(head):
                self._body(body)
            keyword = "elif"

    def _jumped_case(self, statement: Case) -> None:
        name = self._selector(statement)
        end = self._new_label()
        places = [self._new_label() for _ in statement.branches]
        otherwise = end
        for (labels, _), place in zip(statement.branches, places, strict=True):
            if labels:
                self._out.put(f"if {_is_one_of(name, labels)}: pc = \x01{place}\x01; continue")
            else:
                otherwise = place
        self._jump(otherwise)
        for (_, body), place in zip(statement.branches, places, strict=True):
            self._mark(place)
            self._body(body)
            self._jump(end)
        self._mark(end)

    def _for(self, statement: For) -> None:
        counter, step, at = statement.counter, statement.step, statement.at
        boxes = self._new_boxes()
        start = self._values.value(statement.start, counter.variable.kind)
        self._open_boxes(boxes)
        self._store(counter, start)
        self._close_boxes(boxes)
        increment = Number(at, 1) if step is None else step
        sign = _sign(increment)

        def condition() -> str:
            up, down = (self._compared(counter, operator, statement.end) for operator in ("<=", ">="))
            if sign is not None:
                return up if sign > 0 else down
            return f"({up}) if {self._compared(increment, '>=', Number(at, 0))} else ({down})"

        def next_one() -> None:
            self._out.place = at
            total: Expression = Chain(at, counter, (Link(at, "+", increment),))
            boxes = self._new_boxes()
            value = self._values.value(total, counter.variable.kind)
            self._open_boxes(boxes)
            self._store(counter, value)
            self._close_boxes(boxes)

        self._loop(statement, condition, next_one)

    def _compared(self, left: Expression, operator: str, right: Expression) -> str:
        return self._values.condition(Chain(left.at, left, (Link(left.at, operator, right),)))

    def _loop(
        self, statement: For | While, condition: Callable[[], str], behind: Callable[[], None] = lambda: None
    ) -> None:
        if id(statement) in self._apart:
            begin, end = self._new_label(), self._new_label()
            self._mark(begin)
            self._out.put(f"if not ({self._tested(condition)}): pc = \x01{end}\x01; continue")
            self._body(statement.body)
            behind()
            self._tick()
            self._jump(begin)
            self._mark(end)
            return
        boxes = self._new_boxes()
        text = condition()
        with self._out.block("while True:" if boxes else f"while {text}:"):
            if boxes:
                with self._out.block(f"if not ({self._tested(condition)}):"):
                    self._out.put("break")
            self._body(statement.body)
            behind()
            self._tick()

    def _any_loop(self, statement: For | While | Repeat) -> None:
        match statement:
            case For():
                self._for(statement)
            case While():
                self._loop(statement, lambda: self._values.condition(statement.condition))
            case Repeat():
                self._repeat(statement)

    def _repeat(self, statement: Repeat) -> None:
        until = statement.condition
        assert until is not None
        if id(statement) in self._apart:
            begin = self._new_label()
            self._mark(begin)
            self._body(statement.body)
            self._out.place = until.at
            self._tick()
            self._out.put(
                f"if not ({self._tested(lambda: self._values.condition(until))}): pc = \x01{begin}\x01; continue"
            )
            return
        with self._out.block("while True:"):
            self._body(statement.body)
            self._out.place = until.at
            self._out.put(f"if {self._tested(lambda: self._values.condition(until))}: break")
            self._tick()


def _fits(kind: str, typed: Typed, constant: float | None) -> bool:
    """Tell whether a value can be stored as it is, with nothing to convert and nothing to check."""
    given = typed.kind
    if kind == "B":
        return given == "B"
    if kind == "I" and given == "I" and constant is not None:
        return abs(constant) < 1 << 31
    return typed.leaf and (given == kind or (kind == "D" and given == "R"))


def _constant(text: str) -> float | None:
    if text[0] not in _NUMBER:  # most of what is stored begins with a name
        return None
    try:
        return float(text)
    except ValueError:
        return None


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
