"""Programs that go on where they stood: a generator's place and names as plain values, and one made anew from them.

Python cannot put a generator to a place. But a program's Python is known, and it stands after one of its `yield`s,
each on a line of its own; so the way from its head to that line is cut out of its syntax tree, the loops around it go
on with their rest, and the code that comes of it stands at the same place as soon as it has begun.
"""

from __future__ import annotations

import ast
from collections.abc import Collection
from inspect import GEN_CREATED, getgeneratorstate
from typing import Any, TypeAlias

from polycnc.language._python import Place, Traced

Suspended: TypeAlias = Any
"""A generator."""
INNER = "yield from"
"""The name under which a resumed program is given the iterator that it gave out from, where it did."""
_FLAG = "resumed_"
_SAVED = "saved_"


def line_of(generator: Suspended) -> int | None:
    """Return the line of Python that a generator stands at: 0 where it has not begun, None where it has ended."""
    frame = generator.gi_frame
    if frame is None:
        return None
    return 0 if getgeneratorstate(generator) == GEN_CREATED else frame.f_lineno


def names_of(generator: Suspended) -> dict[str, Any]:
    """Return the names of a generator that stands, without those that going on has made."""
    found: dict[str, Any] = {} if generator.gi_frame is None else generator.gi_frame.f_locals
    return {name: value for name, value in found.items() if not name.startswith(_FLAG) and name != _SAVED}


def inner_of(generator: Suspended) -> object:
    """Return the iterator that a generator emits from now, None if it gives by itself."""
    if generator.gi_yieldfrom is not None or generator.gi_frame is None:
        return generator.gi_yieldfrom
    return generator.gi_frame.f_locals.get(_SAVED, {}).get(INNER)  # it is about to go on with it


def resumed(
    traced: Traced[Place], line: int, names: Collection[str], *, again: bool = False
) -> Traced[Place]:
    """Return code whose function stands after the `yield` of a line once it has given its first item, a None.

    The function takes one argument more: the values of `names`, by name, and the iterator of a `yield from` as `INNER`.
    What the function sets before that line and is not among `names` it sets again. With `again` the `yield` itself is
    gone through anew, and its item is what is given first.

    Raises:
        ValueError: There is no `yield` on this line, or Python cannot go on there.
    """
    try:
        return _resumed(traced, line, names, again=again)
    except (RecursionError, MemoryError, SyntaxError) as error:
        raise ValueError(f"the program cannot go on at line {line}") from error


def _resumed(traced: Traced[Place], line: int, names: Collection[str], *, again: bool) -> Traced[Place]:
    tree = ast.parse("\n".join(traced.lines))
    (function,) = tree.body
    if not isinstance(function, ast.FunctionDef):
        raise ValueError("a program is one function")
    place = next((n for n, each in enumerate(function.body) if _holds(each, line)), None)
    rest = None if place is None else _Rest(line, again=again).of_block(function.body)
    if place is None or rest is None:
        raise ValueError(f"there is no yield on line {line}")
    head = [each for each in function.body[:place] if _sets_another(each, names)]
    put = [
        ast.Assign([ast.Name(name, ast.Store())], _item(name))
        for name in names
        if name not in {argument.arg for argument in function.args.args}
    ]
    function.args.args.append(ast.arg(_SAVED))
    function.body = [*head, *put, *rest]
    for each in put:
        ast.copy_location(each, function)
    ast.fix_missing_locations(tree)
    code = compile(tree, traced.name, "exec", dont_inherit=True)
    return Traced(traced.name, traced.lines, traced.places, code)


class _Rest:
    """Find what is left of blocks of statements after the `yield` of a line."""

    def __init__(self, line: int, *, again: bool) -> None:
        self._line = line
        self._again = again
        self._loops = 0

    def of_block(self, statements: list[ast.stmt]) -> list[ast.stmt] | None:
        """Return the rest of a block, None if the line is not in it."""
        for place, statement in enumerate(statements):
            if _holds(statement, self._line):
                rest = self._of_statement(statement)
                return None if rest is None else [*rest, *statements[place + 1 :]]
        return None

    def _of_statement(self, statement: ast.stmt) -> list[ast.stmt] | None:
        match statement:
            case ast.If():
                rest = self.of_block(statement.body)
                return self.of_block(statement.orelse) if rest is None else rest
            case ast.While():
                return self._of_loop(statement)
            case ast.Expr(value=ast.Yield() | ast.YieldFrom()) | ast.Assign(value=ast.Yield()):
                return self._of_yield(statement)
        return None

    def _of_yield(self, statement: ast.Expr | ast.Assign) -> list[ast.stmt]:
        if self._again:
            return [statement]
        nothing = ast.copy_location(ast.Yield(None), statement.value)
        if isinstance(statement, ast.Assign):
            return [ast.copy_location(ast.Assign(statement.targets, nothing), statement)]
        found: list[ast.stmt] = [ast.copy_location(ast.Expr(nothing), statement)]
        if isinstance(statement.value, ast.YieldFrom):
            inner = ast.copy_location(ast.YieldFrom(_item(INNER)), statement.value)
            found.append(ast.copy_location(ast.Expr(inner), statement))
            found.append(
                ast.copy_location(ast.Assign([ast.Name(_SAVED, ast.Store())], ast.Dict([], [])), statement)
            )
        return found

    def _of_loop(self, loop: ast.While) -> list[ast.stmt] | None:
        """Return a loop whose first round is the rest of one."""
        rest = self.of_block(loop.body)
        if rest is None:
            return None
        self._loops += 1
        flag = f"{_FLAG}{self._loops}"
        test = ast.BoolOp(ast.Or(), [ast.Name(flag, ast.Load()), loop.test])
        first = ast.If(ast.Name(flag, ast.Load()), [_set(flag, False), *rest], loop.body)
        found: list[ast.stmt] = [_set(flag, True), ast.While(test, [first], loop.orelse)]
        return [ast.copy_location(each, loop) for each in found]


def _holds(statement: ast.stmt, line: int) -> bool:
    return statement.lineno <= line <= (statement.end_lineno or 0)


def _sets_another(statement: ast.stmt, names: Collection[str]) -> bool:
    """Tell whether a statement sets one name, and none of `names`."""
    match statement:
        case ast.Assign(targets=[ast.Name(id=name)], value=value):
            return name not in names and not isinstance(value, ast.Yield)
    return False


def _set(name: str, value: bool) -> ast.stmt:
    return ast.Assign([ast.Name(name, ast.Store())], ast.Constant(value))


def _item(name: str) -> ast.expr:
    return ast.Subscript(ast.Name(_SAVED, ast.Load()), ast.Constant(name), ast.Load())
