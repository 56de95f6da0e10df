"""Custom macros become Python: one generator per program, which emits blocks and calculates between them."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass, field

from polycnc.language import Emitter, Flaw, Flow, Traced
from polycnc.nc.macro._calls import argument_numbers
from polycnc.nc.macro._expressions import Expressions, Value, may_overflow, no_value, no_variable_at
from polycnc.nc.macro._functions import FUNCTIONS, OPERATORS, power
from polycnc.nc.macro._shape import RESTART, Shape, last_label
from polycnc.nc.macro._statement_values import INTO_LOOP
from polycnc.nc.macro._syntax import (
    Address,
    Assignment,
    Cancel,
    Device,
    End,
    Expression,
    Goto,
    If,
    Interrupt,
    Line,
    MacroCall,
    Names,
    Number,
    Output,
    Printed,
    Refusal,
    Refused,
    Restart,
    Span,
    Statement,
    SubCall,
    While,
    Words,
)
from polycnc.nc.macro._variables import LARGEST
from polycnc.nc.sources._block_source import Drain, TextSpan
from polycnc.nc.text._silent import is_silent

ALARM, MESSAGE_STOP = 3000, 3006
_ANGLES_AND_LENGTHS = "ABCIJKQRUVWXYZ"
_SUB_CALL = 98.0


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
    """What a program becomes: its Python, the constants that it refers to by index, and where jumps lead."""

    shape: Shape
    traced: Traced[int] = field(init=False)
    spans: list[TextSpan | Drain] = field(default_factory=list)
    blocks: list[BlockSpec] = field(default_factory=list)
    calls: list[CallSpec] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)
    outputs: list[Output] = field(default_factory=list)
    refusals: list[Refusal] = field(default_factory=list)
    places: dict[object, tuple[int, int]] = field(default_factory=dict)


class _Compiler:
    def __init__(self, text: str, shape: Shape, values: Expressions, increment: float, rounds: int) -> None:
        self.flaws: list[Flaw] = []
        self._text = text
        self._increment = increment
        self._code = Code(shape)
        self._out: Emitter[int] = Emitter(0)
        self._changes = 0  # statements so far that change something
        self._flow = Flow(self._out, self, rounds=rounds, changes=lambda: self._changes)
        self._values = values
        self._line = Line(0, 0, None, 0, ())

    def compile(self, name: str) -> Code:
        code, shape = self._code, self._code.shape
        with self._out.block("def program(L, C, H):"):
            self._flow.write(shape.body, begin=shape.begin)
            self._out.put("return", "yield")
        code.places = self._flow.places
        code.traced = self._out.compile(name)
        return code

    # ------------------------------------------------------------------ what the flow asks

    def before(self, statement: object) -> None:
        """Write nothing: macros are stepped from block to block."""

    def statement(self, part: Line | Span) -> None:
        """Write a line or a stretch of plain text."""
        if isinstance(part, Span):
            self._changes += not is_silent(self._text[part.offset : part.end])
            self._span(part)
            return
        self._line = part
        self._begin(part.line)
        assigns = all(isinstance(each, Assignment) for each in part.statements)
        if not assigns:
            self._passed(part.label)
        try:
            with self._out.block(f"if not H.skips({part.skip}):") if part.skip else nullcontext():
                for each in part.statements:
                    self._statement(each)
        except Flaw as flaw:
            self.flaws.append(flaw)
        if assigns:  # what it reads is that of the blocks before
            self._passed(part.label)

    def condition(self, loop: While, number: int) -> str | None:
        """Return the condition of a loop; its block is passed whenever it is asked."""
        self._passed(loop.label)
        if loop.condition is None:
            return None
        try:
            condition = self._values.condition(loop.condition)
        except Refusal as refusal:
            self._refuse(refusal)
            return "False"
        self._flush()
        return condition.text

    def begin(self, loop: While) -> None:
        """Begin a loop."""
        self._begin(loop.line)

    def end(self, loop: While) -> None:
        """End a round: a pause is one of the loop."""
        self._out.place = loop.at

    def _span(self, part: Span) -> None:
        self._code.spans.append(TextSpan(part.offset, part.line, part.end))
        index = len(self._code.spans) - 1
        with self._out.block("if H.plain:"):
            self._out.put(f"yield S[{index}]")
        with self._out.block("else:"):
            self._out.put(f"yield from H.span({index})")
            self._after_call()
        self._passed(last_label(self._text, part))

    def _passed(self, label: int | None) -> None:
        """Write that a block number was passed (#4114)."""
        if label is not None:
            self._out.put(f"V.sequence_number = {label}")

    def _begin(self, line: int) -> None:
        self._values.before.clear()
        self._code.spans.append(Drain(line))
        self._values.drain = f"yield S[{len(self._code.spans) - 1}]"

    def _flush(self) -> None:
        self._out.put(*self._values.before)
        self._values.before.clear()

    def _statement(self, statement: Statement) -> None:
        try:
            self._write(statement)
        except Refusal as refusal:
            self._refuse(refusal)

    def _refuse(self, refusal: Refusal) -> None:
        """Write the alarm that a statement is when it is executed."""
        self._values.forget()
        self._code.refusals.append(refusal)
        self._out.place = refusal.at
        self._out.put(f"refuse({len(self._code.refusals) - 1})")

    def _write(self, statement: Statement) -> None:
        out = self._out
        out.place = statement.at
        self._changes += not isinstance(statement, If | Goto | Restart)
        match statement:
            case Assignment():
                self._assignment(statement)
            case If():
                condition = self._values.condition(statement.condition)
                self._flush()
                with out.block(f"if {condition.text}:"):
                    self._statement(statement.then)
            case Goto():
                self._goto(statement)
            case Words():
                self._words(statement.at, statement.words)
                if any(word.letter == "M" and _is(word.value, _SUB_CALL) for word in statement.words):
                    self._after_call()
            case MacroCall():
                self._macro_call(statement)
            case SubCall():
                self._sub_call(statement)
            case Cancel():
                out.put("H.cancel()")
                if statement.words:
                    self._words(statement.at, statement.words)
            case Interrupt():
                program = "None" if statement.program is None else self._values.value(statement.program).text
                self._flush()
                out.put(f"H.interrupted_by({program})")
            case Output():
                self._output(statement)
            case Device():
                out.put(f"H.device({statement.opens})")
            case Names():
                self._code.texts += statement.names
                count = len(self._code.texts)
                out.put(f"H.set_names({statement.first}, T[{count - len(statement.names)}:{count}])")
            case Restart():
                with out.block("if H.main:"):
                    self._flow.jump(RESTART)
                out.put("yield RETURN", "return")
            case Refused():
                raise statement.flaw
            case While() | End():
                raise Flaw(statement.at, "a loop begins or ends a block", "Write it alone.", code="PS0125")

    def _assignment(self, statement: Assignment) -> None:
        out = self._out
        target = statement.target
        number = target.number
        value = self._values.expression(statement.value)
        if value.truth:
            raise Flaw(statement.at, "a condition is no value", "Write IF [...] THEN #1=1.", code="PS0114")
        if target.index is not None:
            place = self._values.index(target.index)
            self._flush()
            out.put(f"put({place}, {value.python.text})")
            return
        kind = self._values.variables.kind(number)
        if kind == "null":
            what = "#0 is always vacant and cannot be written"
            raise Refusal(target.at, what, "Write another variable.", code="PS0116")
        if kind is None:
            self._system_assignment(statement, number, value)
            return
        self._flush()
        store = f"{'L' if kind == 'local' else 'C'}[{number}]"
        if may_overflow(statement.value):
            out.put(f"v = {value.python.text}")
            with out.block(f"if not {-LARGEST!r} < v < {LARGEST!r}:"):
                out.put("checked(v)")
            out.put(f"{store} = v")
        else:
            out.put(f"{store} = {value.python.text}")

    def _system_assignment(self, statement: Assignment, number: int, value: Value) -> None:
        out = self._out
        if number == ALARM:
            self._values.before.append(self._values.drain)
            self._flush()
            self._code.texts.append(statement.text)
            out.put(f"alarm({value.number().text}, T[{len(self._code.texts) - 1}])")
            return
        if number == MESSAGE_STOP:
            self._flush()
            self._code.texts.append(statement.text)
            line, text = self._line, f"T[{len(self._code.texts) - 1}]"
            out.put(f"yield stop({value.number().text}, {line.line}, {line.offset}, {text})")
            return
        if not self._values.system.has(number):
            raise no_variable_at(statement.target.at, number)
        if self._values.system.waits(number):
            self._values.before.append(self._values.drain)
        self._flush()
        out.put(f"put({number}, {value.python.text})")

    def _goto(self, statement: Goto) -> None:
        if not statement.returns and isinstance(statement.target, Number):
            self._jump(statement, int(statement.target.value))
            return
        out = self._out
        value = self._values.value(statement.target)
        self._flush()
        out.put(f"t = label({value.text})")
        if statement.returns:
            with out.block("if not H.main:"):
                out.put("H.back_to(t)", "yield RETURN", "return")
        self._open_jump(statement.at)

    def _jump(self, statement: Goto, number: int) -> None:
        found = self._code.shape.find(number, statement.at)
        if found is None:
            what, hint = f"there is no block N{number} in this program", "Check the number after GOTO."
        elif not self._flow.reaches(found):
            what, hint = f"GOTO {number} leads into a loop", INTO_LOOP
        else:
            self._flow.jump(found)
            return
        raise Refusal(getattr(statement.target, "at", 0), what, hint, code="PS0128")

    def _open_jump(self, at: int) -> None:
        """Write a jump to the block number in `t`."""
        self._flow.leap(f"find(t, {at})")
        self._out.put("into_loop(t)")

    def _after_call(self) -> None:
        """Write what M99 P of a called program leads to."""
        if self._code.shape.open_jumps:
            with self._out.block("if H.pending is not None:"):
                self._out.put("t = H.taken()")
                self._open_jump(self._out.place)

    def _words(self, at: int, words: tuple[Address, ...]) -> None:
        specs, values = [], []
        for word in words:
            if isinstance(word.value, Number):
                specs.append(WordSpec(word.letter, word.at, word.value.value, word.value.point))
            else:
                self._values.in_address = True
                value = self._values.expression(word.value)
                self._values.in_address = False
                if value.truth:
                    raise no_value(word.at)
                values.append(value.python.text)
                specs.append(WordSpec(word.letter, word.at))
        self._code.blocks.append(BlockSpec(self._line.line, self._line.offset, self._line.skip, tuple(specs)))
        self._flush()
        index = len(self._code.blocks) - 1
        with self._out.block("if H.plain:"):
            self._out.put(f"yield block({index}, {_tuple(values)})")
        with self._out.block("else:"):
            self._out.put(f"yield from H.words({index}, {_tuple(values)})")

    def _output(self, statement: Output) -> None:
        values = [
            self._values.value(each.value).text for each in statement.pieces if isinstance(each, Printed)
        ]
        self._code.outputs.append(statement)
        self._flush()
        self._out.put(f"H.put_out({len(self._code.outputs) - 1}, {_tuple(values)}, {self._line.line})")

    def _macro_call(self, call: MacroCall) -> None:
        if call.before:
            self._words(call.at, call.before)
        program = self._values.value(call.program).text
        repeats = "1.0" if call.repeats is None else self._values.value(call.repeats).text
        numbers, values = _arguments(call, self._values, self._increment)
        self._code.calls.append(CallSpec(self._line.line, call.at, numbers, call.by_code))
        self._flush()
        index = len(self._code.calls) - 1
        if call.modal:
            self._out.put(f"H.push(modal({index}, {program}, {repeats}, {_tuple(values)}, {call.each}))")
            return
        self._out.put(f"yield call({index}, {program}, {repeats}, {_tuple(values)})")
        self._after_call()

    def _sub_call(self, call: SubCall) -> None:
        if call.words:
            self._words(call.at, call.words)
        if call.tool is not None:
            value = self._values.value(call.tool)
            self._flush()
            self._out.put(f"C[149] = {value.text}")
        repeats = "1.0" if call.repeats is None else self._values.value(call.repeats).text
        self._code.calls.append(CallSpec(self._line.line, call.at, (), by_code=True))
        self._flush()
        self._out.put(f"yield sub({len(self._code.calls) - 1}, {call.program}, {repeats})")
        self._after_call()


def _arguments(
    call: MacroCall, expressions: Expressions, increment: float
) -> tuple[tuple[int, ...], list[str]]:
    """Return the local variables that the arguments of a call go to, and the arguments as Python."""
    values = []
    for word in call.arguments:
        value = expressions.expression(word.value)
        if value.truth:
            raise no_value(word.at)
        text = value.python.text
        if increment and isinstance(word.value, Number) and word.letter in _ANGLES_AND_LENGTHS:
            text = repr(word.value.value * (1.0 if word.value.point else increment))
        values.append(text)
    return tuple(argument_numbers(call.arguments)), values


def compile_program(
    text: str, shape: Shape, values: Expressions, increment: float, rounds: int, name: str
) -> tuple[Code | None, list[Flaw]]:
    """Return a program compiled, or all that is wrong with it; it pauses after so many rounds and jumps back."""
    compiler = _Compiler(text, shape, values, increment, rounds)
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


def _tuple(values: list[str]) -> str:
    return f"({', '.join(values)}{',' if len(values) == 1 else ''})"
