"""Check expressions and turn them into instructions for a stack of values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from polycnc.controllers.apci.sap import _commands
from polycnc.controllers.apci.sap._arithmetic import BINARY, FUNCTIONS, UNARY
from polycnc.controllers.apci.sap._commands import BOOLEAN, DOUBLE, INTEGER
from polycnc.controllers.apci.sap._faults import Fault
from polycnc.controllers.apci.sap._names import ConstantSymbol, NameCompiler, RoutineSymbol, VariableSymbol
from polycnc.controllers.apci.sap._syntax import (
    Binary,
    Call,
    Expression,
    Name,
    Number,
    Place,
    Qualified,
    Unary,
)
from polycnc.errors import ProgramError

_TYPE_NAMES = {INTEGER: "INTEGER", DOUBLE: "DOUBLE", BOOLEAN: "BOOLEAN"}
_NUMBERS = (INTEGER, DOUBLE)
_ARITHMETIC = {"+": "add", "-": "sub", "*": "mul"}
_WHOLE = {"div": "divi", "mod": "modi", "shl": "shli", "shr": "shri"}
_LOGIC = {"and": "andi", "or": "ori", "xor": "xori"}
_COMPARISONS = {"<": "lt", "<=": "le", ">": "gt", ">=": "ge", "=": "eq", "<>": "ne"}


@dataclass
class ValueCompiler(NameCompiler):
    """Turn expressions into instructions appended to `code`."""

    def numeric(self, node: Expression, what: str) -> str:
        """Compile an expression that must be a number."""
        kind = self.expression(node)
        if kind not in _NUMBERS:
            raise self.error(
                node.at, f"{what} must be a number, not {_TYPE_NAMES[kind]}", "Compare it, or use IF."
            )
        return kind

    def value_of(self, wanted: str, node: Expression, what: str) -> None:
        """Compile an expression and convert it to the type `wanted`."""
        self.convert(self.expression(node), wanted, node.at, what)

    def convert(self, kind: str, wanted: str, at: Place, what: str) -> None:
        """Convert the topmost value from `kind` to `wanted`, which is possible from integer to double only."""
        if kind == INTEGER and wanted == DOUBLE:
            self.emit("double")
        elif kind != wanted:
            hint = "Use TRUNC or ROUND." if (kind, wanted) == (DOUBLE, INTEGER) else "Change one of the two."
            raise self.error(at, f"{what} must be {_TYPE_NAMES[wanted]}, not {_TYPE_NAMES[kind]}", hint)

    def expression(self, node: Expression) -> str:
        """Compile an expression, which leaves one value on the stack, and return its type."""
        spine: list[Binary] = []
        while isinstance(node, Binary):  # a long sum is a deep tree to the left
            spine.append(node)
            node = node.left
        kind = self._operand(node)
        for binary in reversed(spine):
            kind = self._binary(binary, kind)
        return kind

    def _operand(self, node: Expression) -> str:
        if isinstance(node, Number):
            self.emit("const", node.value)
            return INTEGER if isinstance(node.value, int) else DOUBLE
        if isinstance(node, Name):
            return self._name(node)
        if isinstance(node, Qualified):
            register = self.qualifier(node)
            self.emit("axget", [node.axis, register.name, register.kind, register.indexed])
            return register.kind
        if isinstance(node, Call):
            return self._call(node)
        if isinstance(node, Unary):
            return self._unary(node)
        raise self.error(node.at, "text has no value here", "Text can only be written: WRITE ('...').")

    def _unary(self, node: Unary) -> str:
        if node.operator == "-" and isinstance(node.operand, Number):
            self.emit("const", -node.operand.value)
            return INTEGER if isinstance(node.operand.value, int) else DOUBLE
        kind = self.expression(node.operand)
        if node.operator == "not" and kind in (INTEGER, BOOLEAN):
            self.emit(f"not{kind}")
        elif node.operator in "+-" and kind in _NUMBERS:
            if node.operator == "-":
                self.emit(f"neg{kind}")
        else:
            raise self.error(
                node.at,
                f"{node.operator.upper()} cannot take {_TYPE_NAMES[kind]}",
                "Check the operand's type.",
            )
        return kind

    def _binary(self, node: Binary, left: str) -> str:
        """Compile operator and right operand; the left one is on the stack."""
        name = node.operator
        if left == BOOLEAN and name in (
            "and",
            "or",
        ):  # the right side counts only if the left one does not decide
            jump = self.emit("unless" if name == "and" else "when")
            self._same(node, left, self.expression(node.right))
            self.patch(jump)
            return BOOLEAN
        right = self.expression(node.right)
        numbers = left in _NUMBERS and right in _NUMBERS
        if numbers and name in _ARITHMETIC:
            kind = DOUBLE if DOUBLE in (left, right) else INTEGER
            self.emit(_ARITHMETIC[name] + kind)
            return kind
        if numbers and name == "/":
            self.emit("slashd")
            return DOUBLE
        if name in _COMPARISONS and (numbers or (left == right and name in ("=", "<>"))):
            self.emit(_COMPARISONS[name])
            return BOOLEAN
        self._same(node, left, right)
        if left == INTEGER and (name in _WHOLE or name in _LOGIC):
            self.emit(_WHOLE.get(name) or _LOGIC[name])
            return INTEGER
        if left == BOOLEAN and name == "xor":
            self.emit("ne")
            return BOOLEAN
        raise self._cannot(node, left, right)

    def _same(self, node: Binary, left: str, right: str) -> None:
        if left != right:
            raise self._cannot(node, left, right)

    def _cannot(self, node: Binary, left: str, right: str) -> ProgramError:
        what = f"{node.operator.upper()} cannot take {_TYPE_NAMES[left]} and {_TYPE_NAMES[right]}"
        hint = "Check the operands' types; comparisons beside AND, OR need brackets."
        return self.error(node.at, what, hint)

    def _name(self, node: Name) -> str:
        symbol = self.symbol(node.name)
        if isinstance(symbol, ConstantSymbol) and node.index is None:
            self.emit("const", symbol.value)
            return symbol.kind
        if isinstance(symbol, VariableSymbol):
            self.array_index(node, symbol)
            self._access("load", symbol)
            return symbol.kind
        if isinstance(symbol, RoutineSymbol) and node.index is None:
            return self._call(Call(node.name, (), node.at))
        if symbol is not None:
            raise self.error(node.at, f"'{node.name}' is no array", "Only arrays take an index.")
        register, index = self.system_variable(node)
        self.emit("sysget", [register.name, register.kind, index, node.index is not None])
        return register.kind

    def array_index(self, node: Name, symbol: VariableSymbol) -> None:
        """Compile the index of an array; refuse one where there is none, and none where there must be one."""
        if (symbol.bounds is None) != (node.index is None):
            what = "is no array" if symbol.bounds is None else "is an array"
            hint = "Only arrays take an index." if symbol.bounds is None else f"Write {node.name}[index]."
            raise self.error(node.at, f"'{node.name}' {what}", hint)
        if node.index is not None:
            self.value_of(INTEGER, node.index, "an index")

    def store(self, symbol: VariableSymbol) -> None:
        """Take the topmost value into a variable."""
        self._access("store", symbol)

    def _access(self, what: str, symbol: VariableSymbol) -> None:
        if symbol.bounds is None:
            self.emit(what + symbol.where, symbol.cell)
        else:
            self.emit(f"{what}x{symbol.where}", [symbol.cell, *symbol.bounds])

    def system_variable(self, node: Name) -> tuple[_commands.Register, int | None]:
        """Return the system variable of a name with its fixed index; compile an index that is written."""
        common = _commands.common_variable(node.name)
        register = common[0] if common else _commands.SYSTEM_VARIABLES.get(node.name.lower())
        if register is None:
            raise self.unknown(
                node.at,
                node.name,
                "name",
                [*self.locals, *self.globals, *_commands.SYSTEM_VARIABLES, *FUNCTIONS],
            )
        if common is not None and not 0 <= common[1] < _commands.COMMON_COUNT:
            hint = f"There are {node.name[:2]}0 to {node.name[:2]}{_commands.COMMON_COUNT - 1}."
            raise self.error(node.at, f"'{node.name}' does not exist", hint)
        self._register_index(node.index, node.name, node.at, register.indexed and common is None)
        return register, common[1] if common else None

    def qualifier(self, node: Qualified) -> _commands.Register:
        """Return the register of an axis qualifier; compile its index."""
        if isinstance(self.symbol(node.axis), VariableSymbol):
            raise self.error(
                node.at, f"'{node.axis}' is a variable, not an axis", "Give the variable another name."
            )
        register = _commands.AXIS_QUALIFIERS.get(node.name.lower())
        if register is None:
            raise self.unknown(node.name_at, node.name, "axis qualifier", _commands.AXIS_QUALIFIERS)
        self._register_index(node.index, node.name, node.name_at, register.indexed)
        return register

    def _register_index(self, index: Expression | None, name: str, at: Place, indexed: bool) -> None:
        if indexed and index is None:
            raise self.error(at, f"'{name}' needs an index", f"Write {name}[index].")
        if not indexed and index is not None:
            raise self.error(at, f"'{name}' takes no index", "Leave the brackets out.")
        if index is not None:
            self.value_of(INTEGER, index, "an index")

    # Calls

    def _call(self, node: Call) -> str:
        name = node.name.lower()
        symbol = self.symbol(name)
        if isinstance(symbol, RoutineSymbol):
            if symbol.routine.result is None:
                raise self.error(node.at, f"'{node.name}' returns nothing", "Only a function has a value.")
            self.call_routine(node, symbol)
            return symbol.routine.result
        if symbol is not None:
            raise self.error(node.at, f"'{node.name}' is no function", "Write indices in [ ].")
        if name in FUNCTIONS:
            return self._function(node, name)
        if name.startswith("rdcb") and name[4:] in _commands.BUFFER_LETTERS:
            (offset,) = self.plain_arguments(node, 1)
            self.value_of(INTEGER, offset, "an offset")
            self.emit("rdcb", name[4:])
            return _commands.BUFFER_LETTERS[name[4:]][1]
        reads = [f"rdcb{letter}" for letter in _commands.BUFFER_LETTERS]
        raise self.unknown(node.at, node.name, "function", [*self.globals, *FUNCTIONS, *reads])

    def _function(self, node: Call, name: str) -> str:
        wanted, result = FUNCTIONS[name]
        (argument,) = self.plain_arguments(node, 1)
        kind = self.numeric(argument, f"the argument of {node.name}")
        if wanted == INTEGER:
            self.convert(kind, wanted, argument.at, f"the argument of {node.name}")
        self.emit(name if result is not None else name + kind)
        return result or kind

    def call_routine(self, node: Call, symbol: RoutineSymbol) -> None:
        """Compile the call of a procedure or function."""
        if self.in_condition:
            raise self.error(
                node.at, "a condition of an EVENT cannot call a function", "Use its expression instead."
            )
        parameters = symbol.routine.parameters
        for value, parameter in zip(self.plain_arguments(node, len(parameters)), parameters, strict=True):
            self.value_of(parameter.kind, value, f"'{parameter.name}'")
        self.emit("call", symbol.index)

    def plain_arguments(self, node: Call, count: int) -> list[Expression]:
        """Return the arguments of a call, which must be `count` plain values."""
        if len(node.arguments) != count:
            what = (
                f"'{node.name}' takes {count} argument{'' if count == 1 else 's'}, not {len(node.arguments)}"
            )
            raise self.error(node.at, what, "Add or remove arguments.")
        for argument in node.arguments:
            if argument.name or argument.formats:
                raise self.error(argument.at, f"'{node.name}' takes plain values", "Leave out what has ':'.")
        return [argument.value for argument in node.arguments]

    # Constants

    def constant(self, node: Expression) -> tuple[int | float | bool, str]:
        """Return value and type of an expression that is known before the program runs."""
        begin = len(self.code)
        try:
            kind = self.expression(node)
            stack: list[Any] = []
            for operation, argument, _ in self.code[begin:]:
                if operation == "const":
                    stack.append(argument)
                elif operation in UNARY:
                    stack.append(UNARY[operation](stack.pop()))
                elif operation in BINARY:
                    right = stack.pop()
                    stack.append(BINARY[operation](stack.pop(), right))
                else:
                    raise self.error(
                        node.at, "a constant expected", "Variables are not known before the run."
                    )
        except Fault as fault:
            raise self.error(node.at, f"no constant: {fault}", "Correct the value.") from None
        finally:
            del self.code[begin:]
        return stack[0], kind
