"""Compile a SAP program: declarations, routines and the main part, to a `Program`."""

from __future__ import annotations

from collections.abc import Iterable

from polycnc.controllers.apci.core._turn_state import TASKS
from polycnc.controllers.apci.sap import _commands
from polycnc.controllers.apci.sap._arithmetic import FUNCTIONS
from polycnc.controllers.apci.sap._commands import BOOLEAN, INTEGER
from polycnc.controllers.apci.sap._lexer import SourceText, tokens
from polycnc.controllers.apci.sap._names import (
    PREDEFINED,
    ConstantSymbol,
    RoutineSymbol,
    Symbol,
    VariableSymbol,
)
from polycnc.controllers.apci.sap._parser import parse
from polycnc.controllers.apci.sap._program import Entry, Program
from polycnc.controllers.apci.sap._statements import StatementCompiler
from polycnc.controllers.apci.sap._syntax import Constant, Place, Routine, Source, Variable
from polycnc.errors import ProgramError, UsageError

MEMORY_CELLS = 65_536
"""Ruling: variables of a program, 512 kByte; an array counts with each of its elements."""

_READS = {f"rdcb{letter}" for letter in _commands.BUFFER_LETTERS}
_RESERVED = {
    *_commands.COMMANDS,
    *_commands.SYSTEM_VARIABLES,
    *_commands.STATEMENTS,
    *FUNCTIONS,
    *PREDEFINED,
    *_READS,
}


def check(text: str, file: str = "<text>", task: int = 0) -> tuple[Program | None, list[ProgramError]]:
    """Compile a program and return it with all its mistakes; with a mistake there is no program.

    Raises:
        UsageError: `task` is not 0 to 3.
    """
    if not 0 <= task < TASKS:
        raise UsageError(f"there is no task {task}", hint=f"Tasks are 0 to {TASKS - 1}.")
    source = SourceText(text, file)
    errors: list[ProgramError] = []
    found = tokens(source, errors)
    tree = None if errors else parse(source, found, errors)
    if tree is None or errors:  # what a mistake hides would only be reported as missing
        return None, _in_order(errors)
    compiler = _ProgramCompiler(source)
    program = compiler.program(tree, task)
    return (None, _in_order(compiler.errors)) if compiler.errors else (program, [])


def compile_program(text: str, file: str = "<text>", task: int = 0) -> Program:
    """Compile a program for a task.

    Raises:
        ProgramError: The first mistake of the program.
        UsageError: `task` is not 0 to 3.
    """
    program, errors = check(text, file, task)
    if program is None:
        raise errors[0]
    return program


def _in_order(errors: list[ProgramError]) -> list[ProgramError]:
    return sorted(
        errors, key=lambda error: (error.position.line, error.position.column) if error.position else (0, 0)
    )


class _ProgramCompiler(StatementCompiler):
    def program(self, tree: Source, task: int) -> Program:
        self._declare_all(tree.constants, tree.variables, self.globals, local=False)
        routines = [routine for routine in tree.routines if routine.condition is None]
        events = [routine for routine in tree.routines if routine.condition is not None]
        for index, routine in enumerate(routines):
            self._declare(self.globals, routine.name, RoutineSymbol(index, routine), routine.at)
        self.block(tree.body)
        self.line = tree.end.line
        self.emit("end")
        variables = self.cells
        entries = [self._routine(routine) for routine in routines]
        handlers = []
        for event in events:
            handlers.append((self._condition(event), len(entries)))
            entries.append(self._routine(event))
        return Program(tree.name, task, tuple(variables), tuple(self.code), tuple(entries), tuple(handlers))

    def _condition(self, event: Routine) -> int:
        begin = len(self.code)
        self.line = event.at.line
        self.in_condition = True
        try:
            if event.condition is not None:
                self.value_of(BOOLEAN, event.condition, "the condition")
        except ProgramError as error:
            self.errors.append(error)
        self.in_condition = False
        self.emit("endcondition")
        return begin

    def _routine(self, routine: Routine) -> Entry:
        self.locals, self.cells = {}, []
        self.function = routine.name.lower()
        for parameter in routine.parameters:
            if parameter.bounds is not None:
                self.errors.append(
                    self.error(
                        parameter.at,
                        f"'{parameter.name}' cannot be an array",
                        "Use a variable of the program.",
                    )
                )
        self._declare_all((), routine.parameters, self.locals, local=True)
        self.result = self.new_cell(routine.result) if routine.result else None
        self._declare_all(routine.constants, routine.variables, self.locals, local=True)
        begin = len(self.code)
        self.block(routine.body)
        if routine.condition is not None:
            self.emit("endevent")
        else:
            self.emit("return", self.result.cell if self.result else None)
        parameters = len(routine.parameters)
        entry = Entry(begin, parameters, tuple(self.cells[parameters:]))
        self.locals, self.cells, self.function, self.result = {}, [], "", None
        return entry

    def _declare_all(
        self,
        constants: Iterable[Constant],
        variables: Iterable[Variable],
        scope: dict[str, Symbol],
        local: bool,
    ) -> None:
        for constant in constants:
            try:
                value, kind = self.constant(constant.value)
                self._declare(scope, constant.name, ConstantSymbol(value, kind), constant.at)
            except ProgramError as error:
                self.errors.append(error)
        for variable in variables:
            try:
                bounds = self._bounds(variable)
                count = 1 if bounds is None else bounds[1] - bounds[0] + 1
                cell = sum(cells for _, cells in self.cells)
                if cell + count > MEMORY_CELLS:
                    raise self.error(
                        variable.at,
                        f"no memory for '{variable.name}'",
                        f"There is room for {MEMORY_CELLS} values.",
                    )
                self.cells.append((variable.kind, count))
                symbol = VariableSymbol(variable.kind, local, cell, bounds)
                self._declare(scope, variable.name, symbol, variable.at)
            except ProgramError as error:
                self.errors.append(error)

    def _bounds(self, variable: Variable) -> tuple[int, int] | None:
        if variable.bounds is None:
            return None
        (first, kind), (last, other) = map(self.constant, variable.bounds)
        if kind != INTEGER or other != INTEGER or last < first:
            hint = "Write the first and the last index as whole numbers, ARRAY [1..10]."
            raise self.error(variable.at, f"array '{variable.name}' has wrong bounds", hint)
        return int(first), int(last)

    def _declare(self, scope: dict[str, Symbol], name: str, symbol: Symbol, at: Place) -> None:
        low = name.lower()
        if low in _RESERVED or _commands.common_variable(low) is not None:
            raise self.error(at, f"'{name}' is a word of the board", "Choose another name.")
        if low in scope:
            raise self.error(at, f"'{name}' is declared twice", "Choose another name for one of the two.")
        scope[low] = symbol
