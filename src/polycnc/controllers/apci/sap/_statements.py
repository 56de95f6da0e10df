"""Turn statements into instructions: assignments, branches and loops."""

from __future__ import annotations

from dataclasses import dataclass, field

from polycnc.controllers.apci.sap import _commands
from polycnc.controllers.apci.sap._calls import CallCompiler
from polycnc.controllers.apci.sap._commands import BOOLEAN, INTEGER
from polycnc.controllers.apci.sap._names import RoutineSymbol, VariableSymbol
from polycnc.controllers.apci.sap._syntax import (
    Assign,
    Block,
    Call,
    Case,
    Expression,
    For,
    If,
    Place,
    Qualified,
    Repeat,
    Statement,
    While,
)
from polycnc.errors import ProgramError


@dataclass
class StatementCompiler(CallCompiler):
    """Turn statements into instructions; mistakes are collected, one per statement."""

    errors: list[ProgramError] = field(default_factory=list)
    cells: list[tuple[str, int]] = field(default_factory=list)  # of the routine, or of the program
    result: VariableSymbol | None = None  # of the function that is being compiled
    function: str = ""

    def block(self, body: Block) -> None:
        """Compile statements."""
        for statement in body:
            self.line = statement.at.line
            try:
                self._statement(statement)
            except ProgramError as error:
                self.errors.append(error)

    def new_cell(self, kind: str) -> VariableSymbol:
        """Return a further variable, in the frame of the routine or in the memory of the program."""
        cell = sum(count for _, count in self.cells)
        self.cells.append((kind, 1))
        return VariableSymbol(kind, self._inside, cell)

    @property
    def _inside(self) -> bool:
        return self.function != ""

    def _statement(self, node: Statement) -> None:
        if isinstance(node, Assign):
            self._assign(node)
        elif isinstance(node, Call):
            self.call_statement(node)
        elif isinstance(node, If):
            self._if(node)
        elif isinstance(node, While):
            begin = len(self.code)
            self.value_of(BOOLEAN, node.condition, "the condition")
            leave = self.emit("jumpfalse")
            self.block(node.body)
            self.emit("jump", begin)
            self.patch(leave)
        elif isinstance(node, Repeat):
            begin = len(self.code)
            self.block(node.body)
            self.line = node.condition.at.line
            self.value_of(BOOLEAN, node.condition, "the condition")
            self.emit("jumpfalse", begin)
        elif isinstance(node, For):
            self._for(node)
        else:
            self._case(node)

    def _assign(self, node: Assign) -> None:
        target = node.target
        if isinstance(target, Qualified):
            register = self.qualifier(target)
            self._writable(register, target.name_at)
            self.value_of(register.kind, node.value, f"'{register.name}'")
            self.emit("axput", [target.axis, register.name, register.kind, register.indexed])
            return
        symbol = self.symbol(target.name)
        if isinstance(symbol, RoutineSymbol) and self.result and target.name.lower() == self.function:
            symbol = self.result
        if isinstance(symbol, VariableSymbol):
            self.array_index(target, symbol)
            self.value_of(symbol.kind, node.value, f"'{target.name}'")
            self.store(symbol)
        elif symbol is not None:
            raise self.error(target.at, f"'{target.name}' cannot be assigned to", "Only variables can.")
        else:
            system, index = self.system_variable(target)
            self._writable(system, target.at)
            self.value_of(system.kind, node.value, f"'{target.name}'")
            self.emit("sysput", [system.name, system.kind, index, target.index is not None])

    def _writable(self, register: _commands.Register, at: Place) -> None:
        if not register.writable:
            raise self.error(at, f"'{register.name}' can only be read", "The board sets it.")

    def _if(self, node: If) -> None:
        ends = []
        for condition, body in node.branches:
            self.value_of(BOOLEAN, condition, "the condition")
            skip = self.emit("jumpfalse")
            self.block(body)
            ends.append(self.emit("jump"))
            self.patch(skip)
        self.block(node.otherwise)
        for end in ends:
            self.patch(end)

    def _for(self, node: For) -> None:
        symbol = self.symbol(node.variable.name)
        if not isinstance(symbol, VariableSymbol) or symbol.kind != INTEGER or symbol.bounds is not None:
            raise self.error(
                node.variable.at, f"'{node.variable.name}' is no INTEGER variable", "Declare one."
            )
        self.value_of(INTEGER, node.first, "the first value")
        last = self.new_cell(INTEGER)
        self.value_of(INTEGER, node.last, "the last value")
        self.store(last)
        self.store(symbol)
        self._load_pair(symbol, last)
        self.emit("le" if node.step > 0 else "ge")
        leave = self.emit("jumpfalse")
        begin = len(self.code)
        self.block(node.body)
        self.line = node.at.line
        self._load_pair(symbol, last)  # compared before the step, which may leave the range of integers
        self.emit("lt" if node.step > 0 else "gt")
        end = self.emit("jumpfalse")
        self.emit(f"load{symbol.where}", symbol.cell)
        self.emit("const", node.step)
        self.emit("addi")
        self.store(symbol)
        self.emit("jump", begin)
        self.patch(leave)
        self.patch(end)

    def _load_pair(self, first: VariableSymbol, second: VariableSymbol) -> None:
        for symbol in (first, second):
            self.emit(f"load{symbol.where}", symbol.cell)

    def _case(self, node: Case) -> None:
        self.value_of(INTEGER, node.selector, "the selector")
        jumps = []
        for labels, _ in node.branches:
            for first, last in labels:
                self.emit("within", [self._label(first), self._label(last), None])
                jumps.append(len(self.code) - 1)
        self.emit("drop")
        self.block(node.otherwise)
        ends = [self.emit("jump")]
        remaining = iter(jumps)
        for labels, body in node.branches:
            for _ in labels:
                at = next(remaining)
                operation, argument, line = self.code[at]
                self.code[at] = (operation, [*argument[:2], len(self.code)], line)
            self.block(body)
            ends.append(self.emit("jump"))
        for end in ends:
            self.patch(end)

    def _label(self, node: Expression) -> int:
        value, kind = self.constant(node)
        if kind != INTEGER:
            raise self.error(node.at, "a case label must be INTEGER", "Write whole numbers or ranges, 1..5.")
        return int(value)
