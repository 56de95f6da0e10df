"""Check the calls of commands and procedures and turn them into instructions."""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.controllers.apci.sap import _commands
from polycnc.controllers.apci.sap._commands import DOUBLE, INTEGER, TABLE, Axes, Command
from polycnc.controllers.apci.sap._names import RoutineSymbol, VariableSymbol
from polycnc.controllers.apci.sap._syntax import Argument, Call, Name, Place, Text
from polycnc.controllers.apci.sap._values import ValueCompiler


@dataclass
class CallCompiler(ValueCompiler):
    """Turn calls that are statements into instructions."""

    def call_statement(self, node: Call) -> None:
        name = node.name.lower()
        symbol = self.symbol(name)
        if isinstance(symbol, RoutineSymbol):
            self.call_routine(node, symbol)
            if symbol.routine.result is not None:
                self.emit("drop")
        elif symbol is not None:
            raise self.error(node.at, f"'{node.name}' is no procedure", "An assignment is written with ':='.")
        elif name in _commands.COMMANDS:
            self._command(node, _commands.COMMANDS[name])
        elif name in ("write", "writeln"):
            self._write(node)
        elif name == "wt":
            self._wait(node)
        elif name in ("stop", "abort"):
            self.plain_arguments(node, 0)
            self.emit(name)
        elif name in _commands.TASK_COMMANDS:
            self.value_of(INTEGER, self.plain_arguments(node, 1)[0], "the task number")
            self.emit("task", name)
        elif name in _commands.STATEMENTS:  # WRCBx
            letter = name[4:]
            offset, value = self.plain_arguments(node, 2)
            self.value_of(INTEGER, offset, "the offset")
            self.value_of(_commands.BUFFER_LETTERS[letter][1], value, "the value")
            self.emit("wrcb", letter)
        else:
            known = [*self.globals, *_commands.COMMANDS, *_commands.STATEMENTS]
            raise self.unknown(node.at, node.name, "command", known)

    def _write(self, node: Call) -> None:
        for argument in node.arguments:
            if argument.name:
                raise self.error(argument.at, f"'{node.name}' takes plain values", "Leave out what has ':='.")
            if isinstance(argument.value, Text) and not argument.formats:
                self.emit("writetext", argument.value.value)
                continue
            kind = self.expression(argument.value)
            if len(argument.formats) == 2 and kind != DOUBLE:
                raise self.error(argument.at, "only a DOUBLE has decimals", "Write value:width.")
            for form in argument.formats:
                self.value_of(INTEGER, form, "a width")
            self.emit("write", [kind, len(argument.formats)])
        if node.name.lower() == "writeln":
            self.emit("writeln")

    def _wait(self, node: Call) -> None:
        values = [argument.value for argument in node.arguments]
        if values and all(isinstance(value, Name) and not self.is_known(value.name) for value in values):
            names: list[str] = []
            for argument in node.arguments:
                self._add_axis(names, self._axis(argument), argument.at)
            self.emit("waitaxes", names)
            return
        (time,) = self.plain_arguments(node, 1)
        self.numeric(time, "the time")
        self.emit("wait")

    def _axis(self, argument: Argument) -> str:
        value = argument.value
        if argument.name or argument.formats or not isinstance(value, Name) or value.index is not None:
            raise self.error(argument.at, "an axis name expected", "Write the axes' names, separated by ','.")
        if self.is_known(value.name):
            raise self.error(
                argument.at, f"'{value.name}' is a value, not an axis", "Write the name of an axis."
            )
        return value.name

    def _add_axis(self, names: list[str], name: str, at: Place) -> None:
        if name.lower() in map(str.lower, names):
            raise self.error(at, f"axis '{name}' twice", "Name each axis once.")
        names.append(name)

    def _command(self, node: Call, command: Command) -> None:
        axes, numbers = self._split(node, command)
        if command.axes is not Axes.NONE and not command.least <= len(axes) <= command.most:
            exactly = "" if command.least != command.most else f"exactly {command.least} "
            least = "" if exactly or command.least == 1 else f"at least {command.least} "
            what = f"'{node.name}' needs {exactly or least or 'at least 1 '}axes, not {len(axes)}"
            raise self.error(node.at, what, _shape(command))
        full = len(command.numbers)
        if len(numbers) not in (full, full - command.optional):
            missing = f"{full} number{'' if full == 1 else 's'}"
            raise self.error(node.at, f"'{node.name}' needs {missing}, not {len(numbers)}", _shape(command))
        names: list[str] = []
        for argument in axes:
            name = argument.name if command.axes is Axes.NAMED else self._axis(argument)
            self._add_axis(names, name, argument.at)
            if command.axes is Axes.NAMED:
                self.value_of(DOUBLE, argument.value, f"the value of '{name}'")
        tables = [
            self._number(argument, name, kind)
            for argument, (name, kind) in zip(numbers, command.numbers, strict=False)
        ]
        self.emit("command", [command.name, names, command.axes is Axes.NAMED, tables])

    def _split(self, node: Call, command: Command) -> tuple[list[Argument], list[Argument]]:
        """Return the arguments that name axes and those that are numbers."""
        arguments = list(node.arguments)
        if command.axes is Axes.NONE:
            return [], arguments
        if command.axes is Axes.ONE:
            return arguments[:1], arguments[1:]
        if command.axes is Axes.LIST:
            count = len(arguments) - len(command.numbers)
            return arguments[:count], arguments[count:]
        own = {name for name, _ in command.numbers}
        count = 0
        while count < len(arguments) and arguments[count].name and arguments[count].name.lower() not in own:
            count += 1
        return arguments[:count], arguments[count:]

    def _number(self, argument: Argument, name: str, kind: str) -> list[object] | None:
        """Compile a number; of a table return where it is: storage, first cell, count of cells."""
        if argument.formats or argument.name.lower() not in ("", name):
            raise self.error(argument.at, f"'{name}' expected", f"Write 'value' or '{name} := value' here.")
        if kind != TABLE:
            self.value_of(kind, argument.value, f"'{name}'")
            return None
        value = argument.value
        symbol = self.symbol(value.name) if isinstance(value, Name) and value.index is None else None
        if not isinstance(symbol, VariableSymbol) or symbol.bounds is None or symbol.kind != DOUBLE:
            raise self.error(
                argument.at, f"'{name}' must be an array of DOUBLE", "Declare ARRAY [1..n] OF DOUBLE."
            )
        return [symbol.where, symbol.cell, symbol.bounds[1] - symbol.bounds[0] + 1]


def _shape(command: Command) -> str:
    """Return how a command is written."""
    axes = {
        Axes.NONE: [],
        Axes.ONE: ["axis"],
        Axes.LIST: ["axis", "..."],
        Axes.NAMED: ["axis := value", "..."],
    }[command.axes]
    arguments = [*axes, *(name for name, _ in command.numbers)]
    return f"Write {command.name} ({', '.join(arguments)});" if arguments else f"Write {command.name};"
