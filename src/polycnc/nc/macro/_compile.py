"""Custom macros become Python: one generator per program, which gives out blocks and calculates between them.

Local variables are the list `L`, common ones the list `C`, both indexed by number. A vacant variable is None:
`(x or 0.0)` is its value in a calculation, and Python's == and != compare as the control's EQ and NE do. A region
that GOTO leads into is a loop around its pieces: `at` says which of them is next.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

from polycnc.language import Chain, Emitter, Flaw, Python, Traced, Unary, infix, prefix
from polycnc.nc.macro._functions import FUNCTIONS, OPERATORS, power
from polycnc.nc.macro._reader import COMPARISONS, argument_numbers
from polycnc.nc.macro._shape import Label, Region, Shape, last_label
from polycnc.nc.macro._syntax import (
    Address,
    Assignment,
    Cancel,
    Device,
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
    Part,
    Printed,
    Restart,
    Span,
    Statement,
    SubCall,
    Variable,
    Words,
)
from polycnc.nc.macro._variables import LARGEST
from polycnc.nc.sources._block_source import Drain, TextSpan

ALARM, MESSAGE_STOP = 3000, 3006
_ANGLES_AND_LENGTHS = "ABCIJKQRUVWXYZ"
_SMALL = 1e6  # adding so little at a time never gets a variable out of range
_ARITHMETIC = "+-*/"
_SUB_CALL = 98.0


class Numbers(Protocol):
    """What the compiler asks about variables."""

    def kind(self, number: int) -> str | None:
        """Return the sort of a variable that is none of the system's, None if there is none."""
        ...

    def has(self, number: int) -> bool:
        """Tell whether there is a system variable."""
        ...

    def waits(self, number: int) -> bool:
        """Tell whether reading a system variable waits for all blocks before."""
        ...


@dataclass(frozen=True, slots=True)
class WordSpec:
    """A word of a block: its value, None for the next one that has been calculated."""

    letter: str
    at: int
    value: float | None = None
    point: bool = True


@dataclass(frozen=True, slots=True)
class BlockSpec:
    """A block whose values are calculated: its line, where it begins, its skip level and its words."""

    line: int
    offset: int
    skip: int
    words: tuple[WordSpec, ...]


@dataclass(frozen=True, slots=True)
class CallSpec:
    """A call: where it stands, and the local variables that its arguments go to, in their order."""

    line: int
    offset: int
    numbers: tuple[int, ...] = ()
    by_code: bool = False


@dataclass
class Code:
    """What a program becomes: its Python, and the constants that it refers to by index."""

    traced: Traced[int]
    spans: list[TextSpan | Drain]
    blocks: list[BlockSpec]
    calls: list[CallSpec]
    texts: list[str]
    outputs: list[Output]
    shape: Shape


@dataclass(frozen=True, slots=True)
class _Value:
    python: Python
    vacant: bool = False
    truth: bool = False

    def number(self) -> Python:
        return Python(f"({self.python.text} or 0.0)") if self.vacant else self.python


@dataclass
class _Compiler:
    text: str
    shape: Shape
    numbers: Numbers
    increment: float
    out: Emitter[int] = field(default_factory=lambda: Emitter(0))
    spans: list[TextSpan | Drain] = field(default_factory=list)
    blocks: list[BlockSpec] = field(default_factory=list)
    calls: list[CallSpec] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)
    outputs: list[Output] = field(default_factory=list)
    flaws: list[Flaw] = field(default_factory=list)
    before: list[str] = field(default_factory=list)  # lines that an expression needs before its own
    loops: list[Region | None] = field(
        default_factory=list
    )  # Python loops around: of a region's pieces, else None
    escapes: list[set[int]] = field(default_factory=list)  # regions that are jumped to out of each of them
    line: Line | None = None
    drain: str = ""
    temporaries: int = 0
    in_address: bool = False

    def compile(self, name: str) -> Code:
        out = self.out
        with out.block("def program(L, C, H):"):
            out.put("n = 0", "go = -1")
            self.region(self.shape.main)
            out.put("return", "yield")
        return Code(
            out.compile(name), self.spans, self.blocks, self.calls, self.texts, self.outputs, self.shape
        )

    # ------------------------------------------------------------------ flow

    def region(self, region: Region) -> None:
        """Emit a region: straight, or in pieces where GOTO leads into it."""
        if not region.targets and not (region.number == 0 and self.has_restart(region)):
            for part in region.parts:
                self.part(part, region)
            return
        out = self.out
        at = f"at{region.number}"
        out.put(f"{at} = {self.shape.start if region is self.shape.main else 0}")
        self.loops.append(region)
        self.escapes.append(set())
        with out.block("while True:"):
            starts = [0, *sorted(region.targets)]
            for piece, (first, last) in enumerate(zip(starts, [*starts[1:], len(region.parts)], strict=True)):
                if first == last:
                    continue
                with out.block(f"if {at} <= {piece}:"):
                    for part in region.parts[first:last]:
                        self.part(part, region)
            out.put("break")
        self.leave_loop()

    def has_restart(self, region: Region) -> bool:
        return any(
            isinstance(statement, Restart)
            for each in self.shape.regions
            for part in each.parts
            if isinstance(part, Line)
            for statement in part.statements
        )

    def turn(self) -> None:
        self.out.put("n += 1")
        with self.out.block("if n > JUMPS:"):
            self.out.put("n = 0", "yield PAUSE")

    def leave_loop(self) -> None:
        """Go on with a jump out of the loop that ends here."""
        self.loops.pop()
        targets = self.escapes.pop()
        if not targets:
            return
        inner = self.loops[-1] if self.loops else None
        assert self.loops
        if inner is not None and inner.number in targets:
            with self.out.block(f"if go == {inner.number}:"):
                self.out.put("go = -1", "continue")
            targets.discard(inner.number)
        if targets:
            self.escapes[-1] |= targets
            with self.out.block("if go >= 0:"):
                self.out.put("break")

    def jump(self, region: Region, place: str, *, back: bool = True) -> None:
        """Emit a jump to a piece of a region around."""
        if back:
            self.turn()
        self.out.put(f"at{region.number} = {place}")
        if self.loops[-1] is region:
            self.out.put("continue")
            return
        self.escapes[-1].add(region.number)
        self.out.put(f"go = {region.number}", "break")

    def loop(self, region: Region) -> None:
        out = self.out
        head = region.head
        assert head is not None
        out.place = head.at
        self.begin(region.line)
        condition = None if head.condition is None else self.condition(head.condition)
        if condition is None:
            start = "while True:"
        elif self.before:
            start, condition = "while True:", prefix("not", condition)
        else:
            start, condition = f"while {condition.text}:", None
        before, self.before = self.before, []
        self.loops.append(None)
        self.escapes.append(set())
        with out.block(start):
            self.turn()
            self.passed(region.label)
            out.put(*before)
            if condition is not None:
                out.put(f"if {condition.text}: break")
            self.region(region)
        self.leave_loop()

    def part(self, part: Part | Region, region: Region) -> None:
        if isinstance(part, Region):
            self.loop(part)
        elif isinstance(part, Span):
            self.out.place = part.offset
            self.spans.append(TextSpan(part.offset, part.line, part.end))
            index = len(self.spans) - 1
            with self.out.block("if H.plain:"):
                self.out.put(f"yield S[{index}]")
            with self.out.block("else:"):
                self.out.put(f"yield from H.span({index})")
                self.after_call(region)
            self.passed(last_label(self.text, part))
        else:
            self.line = part
            self.begin(part.line)
            assigns = all(isinstance(each, Assignment) for each in part.statements)
            if not assigns:
                self.passed(part.label)
            try:
                if part.skip:
                    with self.out.block(f"if not H.skips({part.skip}):"):
                        for statement in part.statements:
                            self.statement(statement, region)
                else:
                    for statement in part.statements:
                        self.statement(statement, region)
            except Flaw as flaw:
                self.flaws.append(flaw)
            if assigns:  # what it reads is that of the blocks before
                self.passed(part.label)

    def passed(self, label: int | None) -> None:
        """Emit that a block number was passed (#4114)."""
        if label is not None:
            self.out.put(f"V.sequence_number = {label}")

    def begin(self, line: int) -> None:
        self.before = []
        self.spans.append(Drain(line))
        self.drain = f"yield S[{len(self.spans) - 1}]"

    # ------------------------------------------------------------------ statements

    def statement(self, statement: Statement, region: Region) -> None:
        out = self.out
        out.place = statement.at
        match statement:
            case Assignment():
                self.assignment(statement)
            case If():
                condition = self.condition(statement.condition)
                self.flush()
                with out.block(f"if {condition.text}:"):
                    self.statement(statement.then, region)
            case Goto():
                self.goto(statement, region)
            case Words():
                self.words(statement.at, statement.words)
                if any(word.letter == "M" and _is(word.value, _SUB_CALL) for word in statement.words):
                    self.after_call(region)
            case MacroCall():
                self.macro_call(statement, region)
            case SubCall():
                self.sub_call(statement, region)
            case Cancel():
                out.put("H.cancel()")
                if statement.words:
                    self.words(statement.at, statement.words)
            case Interrupt():
                program = "None" if statement.program is None else self.value(statement.program).text
                self.flush()
                out.put(f"H.interrupted_by({program})")
            case Output():
                self.output(statement)
            case Device():
                out.put(f"H.device({statement.opens})")
            case Names():
                self.texts += statement.names
                count = len(self.texts)
                out.put(f"H.set_names({statement.first}, T[{count - len(statement.names)}:{count}])")
            case Restart():
                with out.block("if H.main:"):
                    self.jump(self.shape.main, "0")
                out.put("yield RETURN", "return")
            case _:
                raise Flaw(statement.at, "a loop begins or ends a block", "Write it alone.", code="PS0125")

    def flush(self) -> None:
        self.out.put(*self.before)
        self.before = []

    def assignment(self, statement: Assignment) -> None:
        out = self.out
        target = statement.target
        number = target.number
        value = self.expression(statement.value)
        if value.truth:
            raise Flaw(statement.at, "a condition is no value", "Write IF [...] THEN #1=1.", code="PS0114")
        if target.index is not None:
            place = self.index(target.index)
            self.flush()
            out.put(f"put({place}, {value.python.text})")
            return
        kind = self.numbers.kind(number)
        if kind == "null":
            raise Flaw(
                target.at,
                "#0 is always vacant and cannot be written",
                "Write another variable.",
                code="PS0116",
            )
        if kind is None:
            self.system_assignment(statement, number, value)
            return
        self.flush()
        store = f"{'L' if kind == 'local' else 'C'}[{number}]"
        if _may_overflow(statement.value):
            out.put(f"v = {value.python.text}")
            with out.block(f"if not {-LARGEST!r} < v < {LARGEST!r}:"):
                out.put("checked(v)")
            out.put(f"{store} = v")
        else:
            out.put(f"{store} = {value.python.text}")

    def system_assignment(self, statement: Assignment, number: int, value: _Value) -> None:
        out = self.out
        if number == ALARM:
            self.before.append(self.drain)
            self.flush()
            self.texts.append(statement.text)
            out.put(f"alarm({value.number().text}, T[{len(self.texts) - 1}])")
            return
        if number == MESSAGE_STOP:
            self.flush()
            assert self.line is not None
            self.texts.append(statement.text)
            out.put(
                f"yield stop({value.number().text}, {self.line.line}, {self.line.offset}, T[{len(self.texts) - 1}])"
            )
            return
        if not self.numbers.has(number):
            raise Flaw(
                statement.target.at,
                f"there is no variable #{number}",
                "See the table of variables.",
                code="PS0115",
            )
        if self.numbers.waits(number):
            self.before.append(self.drain)
        self.flush()
        out.put(f"put({number}, {value.python.text})")

    def goto(self, statement: Goto, region: Region) -> None:
        out = self.out
        if statement.returns:
            value = self.value(statement.target)
            self.flush()
            out.put(f"t = label({value.text})")
            with out.block("if not H.main:"):
                out.put("H.back_to(t)", "yield RETURN", "return")
            self.open_jump(statement.at, region)
            return
        if not isinstance(statement.target, Number):
            value = self.value(statement.target)
            self.flush()
            out.put(f"t = label({value.text})")
            self.open_jump(statement.at, region)
            return
        number = int(statement.target.value)
        found = self.shape.find(number, statement.at)
        if found is None:
            raise Flaw(
                statement.target.at,
                f"there is no block N{number} in this program",
                "Check the number behind GOTO.",
                code="PS0128",
            )
        if all(each is not found.region for each in region.chain()):
            raise Flaw(
                statement.target.at,
                f"GOTO {number} leads into a loop",
                "Jump out of loops or inside them, never into one.",
                code="PS0128",
            )
        self.jump(found.region, str(_piece(found)), back=found.offset <= statement.at)

    def open_jump(self, at: int, region: Region) -> None:
        """Emit a jump to the label in `t`."""
        self.out.put(f"to, k = find(t, {at})")
        for each in region.chain():
            if each.targets:
                with self.out.block(f"if to == {each.number}:"):
                    self.jump(each, "k")
        self.out.put("into_loop(t)")

    def after_call(self, region: Region) -> None:
        """Emit what M99 P of a called program leads to."""
        if not self.shape.open_jumps:
            return
        with self.out.block("if H.pending is not None:"):
            self.out.put("t = H.taken()")
            self.open_jump(self.out.place, region)

    def words(self, at: int, words: tuple[Address, ...]) -> None:
        assert self.line is not None
        specs, values = [], []
        for word in words:
            if isinstance(word.value, Number):
                specs.append(WordSpec(word.letter, word.at, word.value.value, word.value.point))
            else:
                self.in_address = True
                value = self.expression(word.value)
                self.in_address = False
                if value.truth:
                    raise _no_value(word.at)
                values.append(value.python.text)
                specs.append(WordSpec(word.letter, word.at))
        self.blocks.append(BlockSpec(self.line.line, self.line.offset, self.line.skip, tuple(specs)))
        self.flush()
        index = len(self.blocks) - 1
        with self.out.block("if H.plain:"):
            self.out.put(f"yield block({index}, {_tuple(values)})")
        with self.out.block("else:"):
            self.out.put(f"yield from H.words({index}, {_tuple(values)})")

    def output(self, statement: Output) -> None:
        assert self.line is not None
        values = [self.value(each.value).text for each in statement.pieces if isinstance(each, Printed)]
        self.outputs.append(statement)
        self.flush()
        self.out.put(f"H.put_out({len(self.outputs) - 1}, {_tuple(values)}, {self.line.line})")

    def arguments(self, call: MacroCall) -> tuple[tuple[int, ...], list[str]]:
        values = []
        for word in call.arguments:
            value = self.expression(word.value)
            if value.truth:
                raise _no_value(word.at)
            text = value.python.text
            if (
                self.increment
                and isinstance(word.value, Number)
                and not word.value.point
                and word.letter in _ANGLES_AND_LENGTHS
            ):
                text = repr(word.value.value * self.increment)
            values.append(text)
        return tuple(argument_numbers(call.arguments)), values

    def macro_call(self, call: MacroCall, region: Region) -> None:
        assert self.line is not None
        if call.before:
            self.words(call.at, call.before)
        program = self.value(call.program).text
        repeats = "1.0" if call.repeats is None else self.value(call.repeats).text
        numbers, values = self.arguments(call)
        self.calls.append(CallSpec(self.line.line, call.at, numbers, call.by_code))
        self.flush()
        index = len(self.calls) - 1
        if call.modal:
            self.out.put(f"H.push(modal({index}, {program}, {repeats}, {_tuple(values)}, {call.each}))")
            return
        self.out.put(f"yield call({index}, {program}, {repeats}, {_tuple(values)})")
        self.after_call(region)

    def sub_call(self, call: SubCall, region: Region) -> None:
        assert self.line is not None
        if call.words:
            self.words(call.at, call.words)
        if call.tool is not None:
            value = self.value(call.tool)
            self.flush()
            self.out.put(f"C[149] = {value.text}")
        repeats = "1.0" if call.repeats is None else self.value(call.repeats).text
        self.calls.append(CallSpec(self.line.line, call.at, (), by_code=True))
        self.flush()
        self.out.put(f"yield sub({len(self.calls) - 1}, {call.program}, {repeats})")
        self.after_call(region)

    # ------------------------------------------------------------------ expressions

    def value(self, tree: Expression) -> Python:
        value = self.expression(tree)
        if value.truth:
            raise _no_value(getattr(tree, "at", 0))
        return value.number()

    def condition(self, tree: Expression) -> Python:
        value = self.expression(tree)
        if not value.truth:
            raise Flaw(
                getattr(tree, "at", 0),
                "this is no condition",
                "Compare two values with EQ, NE, GT, GE, LT or LE.",
                code="PS0114",
            )
        return value.python

    def expression(self, tree: Expression) -> _Value:
        match tree:
            case Number():
                return _Value(Python(repr(tree.value)))
            case Variable():
                return self.variable(tree)
            case Function():
                return self.function(tree)
            case Name():
                self.texts.append(tree.text)
                return _Value(Python(f"H.named(T[{len(self.texts) - 1}])"))
            case Unary():
                operand = self.expression(tree.operand)
                if operand.truth:
                    raise _no_value(tree.at)
                if operand.vacant and self.in_address:
                    if tree.operator == "+":
                        return operand
                    return _Value(Python(f"negative({operand.python.text})"), vacant=True)
                return _Value(prefix(tree.operator, operand.number()))
            case Chain():
                return self.chain(tree)

    def variable(self, tree: Variable) -> _Value:
        number = tree.number
        if tree.index is not None:
            return _Value(Python(f"get({self.index(tree.index)})"), vacant=True)
        match self.numbers.kind(number):
            case "null":
                return _Value(Python("None"), vacant=True)
            case "local":
                return _Value(Python(f"L[{number}]"), vacant=True)
            case None:
                if not self.numbers.has(number):
                    raise Flaw(
                        tree.at,
                        f"there is no variable #{number}",
                        "See the table of variables.",
                        code="PS0115",
                    )
                if self.numbers.waits(number) and self.drain not in self.before:
                    self.before.append(self.drain)
                return _Value(Python(f"get({number})"), vacant=True)
            case _:
                return _Value(Python(f"C[{number}]"), vacant=True)

    def index(self, tree: Expression) -> str:
        """Emit the number of a variable that is calculated; return the Python name that holds it."""
        value = self.value(tree)
        self.temporaries += 1
        name = f"i{self.temporaries}"
        self.before.append(f"{name} = number({value.text})")
        self.before.append(f"if {name} > 999 and waits({name}): {self.drain}")
        return name

    def function(self, tree: Function) -> _Value:
        name = tree.name
        if name == "ADP":
            (argument,) = tree.arguments
            return _Value(Python(f"adp({self.value(argument).text})"))
        values = ", ".join(self.value(each).text for each in tree.arguments)
        if name in ("ROUND", "RND") and self.in_address:
            return _Value(Python(f"H.increments({values})"))
        return _Value(Python(f"f_{name}({values})"))

    def chain(self, tree: Chain[Number | Variable | Function | Name]) -> _Value:
        left = self.expression(tree.first)
        for link in tree.links:
            right = self.expression(link.operand)
            left = self.linked(left, link.operator, right, link.at)
        return left

    def linked(self, left: _Value, operator: str, right: _Value, at: int) -> _Value:
        if left.truth or right.truth:
            if left.truth and right.truth and operator in ("AND", "OR", "XOR"):
                word = {"AND": "and", "OR": "or", "XOR": "!="}[operator]
                return _Value(infix(left.python, word, right.python), truth=True)
            raise _no_value(at)
        if operator in ("EQ", "NE"):
            return _Value(infix(left.python, COMPARISONS[operator], right.python), truth=True)
        if operator in COMPARISONS:
            return _Value(infix(left.number(), COMPARISONS[operator], right.number()), truth=True)
        if operator in _ARITHMETIC:
            return _Value(infix(left.number(), operator, right.number()))
        return _Value(Python(f"o_{operator}({left.number().text}, {right.number().text})"))


def compile_program(
    text: str, shape: Shape, numbers: Numbers, increment: float, name: str
) -> tuple[Code | None, list[Flaw]]:
    """Return a program compiled, or all that is wrong with it."""
    compiler = _Compiler(text, shape, numbers, increment)
    try:
        code = compiler.compile(name)
    except Flaw as flaw:
        return None, [*compiler.flaws, flaw]
    return (None, compiler.flaws) if compiler.flaws else (code, [])


def names() -> dict[str, object]:
    """Return the functions and operators as compiled programs call them."""
    found: dict[str, object] = {f"f_{name}": function for name, function in FUNCTIONS.items()}
    found["f_POW"] = power
    found.update({f"o_{name}": function for name, function in OPERATORS.items()})
    return found


def _is(tree: Expression, value: float) -> bool:
    return isinstance(tree, Number) and tree.value == value


def _piece(label: Label) -> int:
    return label.region.targets[label.part]


def _tuple(values: list[str]) -> str:
    return f"({', '.join(values)}{',' if len(values) == 1 else ''})"


def _no_value(at: int) -> Flaw:
    return Flaw(at, "a condition stands where a number must", "Compare only in IF and WHILE.", code="PS0114")


def _may_overflow(tree: Expression) -> bool:
    if isinstance(tree, (Number, Variable)):
        return False
    if isinstance(tree, Chain):
        variables = [
            each
            for each in (tree.first, *(link.operand for link in tree.links))
            if not isinstance(each, Number)
        ]
        constants = [
            each.value
            for each in (tree.first, *(link.operand for link in tree.links))
            if isinstance(each, Number)
        ]
        small = len(variables) <= 1 and all(abs(each) <= _SMALL for each in constants)
        plus = all(link.operator in "+-" for link in tree.links)
        return not (small and plus and all(isinstance(each, Variable) for each in variables))
    return not (isinstance(tree, Unary) and isinstance(tree.operand, (Number, Variable)))
