"""Which lines of a module run: the module is loaded with a note before each statement of its functions."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator
from importlib.machinery import SourceFileLoader
from pathlib import Path
from typing import Any

NOTE = "__note_that_a_line_runs__"


class Watch:
    """Notes which lines of some files run; what is outside of functions runs with the import.

    It costs a call for each statement of those files and nothing elsewhere, unlike tracing. It has to be made before
    the files are imported.
    """

    def __init__(self, files: list[str]) -> None:
        self.imported: dict[str, set[int]] = {file: set() for file in files}
        self._spans: list[tuple[str, list[int]]] = []
        self._seen: set[int] = set()
        setattr(builtins, NOTE, self._seen.add)
        compiled_as_it_is = SourceFileLoader.source_to_code

        def with_notes(loader: SourceFileLoader, data: Any, path: Any, **options: Any) -> Any:
            if path in self.imported and isinstance(data, bytes):
                data = self._noting(path, data)
            return compiled_as_it_is(loader, data, path, **options)

        SourceFileLoader.source_to_code = with_notes  # type: ignore[method-assign,assignment]
        for file in files:
            forget_bytecode(Path(file))

    def taken(self) -> dict[str, set[int]]:
        """Return the lines of each file that ran since the last call."""
        lines: dict[str, set[int]] = {}
        for number in self._seen:
            file, own = self._spans[number]
            lines.setdefault(file, set()).update(own)
        self._seen.clear()
        return lines

    def _noting(self, file: str, source: bytes) -> ast.Module:
        tree = ast.parse(source)
        for node in _outside_of_functions(tree):
            self.imported[file].update(_own_lines(node))
        for function in [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]:
            for holder in [function, *_within(function)]:
                for name in ("body", "orelse", "finalbody"):
                    statements = getattr(holder, name, None)
                    if isinstance(statements, list) and statements and isinstance(statements[0], ast.stmt):
                        setattr(holder, name, list(self._noted(file, statements, holder)))
        return ast.fix_missing_locations(tree)

    def _noted(self, file: str, statements: list[ast.stmt], holder: ast.AST) -> Iterator[ast.stmt]:
        for place, statement in enumerate(statements):
            documents = isinstance(holder, ast.FunctionDef) and place == 0 and _is_text(statement)
            if not documents and not _is_note(statement):
                self._spans.append((file, sorted(_own_lines(statement))))
                call = ast.Call(ast.Name(NOTE, ast.Load()), [ast.Constant(len(self._spans) - 1)], [])
                yield ast.copy_location(ast.Expr(ast.copy_location(call, statement)), statement)
            yield statement


def forget_bytecode(module: Path) -> None:
    """Remove what Python keeps of a module: it is told from its source by size and second alone."""
    for stale in (module.parent / "__pycache__").glob(f"{module.stem}.*.pyc"):
        stale.unlink()


def _within(function: ast.AST) -> Iterator[ast.AST]:
    """Yield what is in a function but not in a function inside it."""
    waiting = list(ast.iter_child_nodes(function))
    while waiting:
        node = waiting.pop()
        if not isinstance(node, ast.FunctionDef):
            yield node
            waiting += ast.iter_child_nodes(node)


def _outside_of_functions(tree: ast.Module) -> Iterator[ast.stmt]:
    waiting: list[ast.AST] = [tree]
    while waiting:
        for child in ast.iter_child_nodes(waiting.pop()):
            if isinstance(child, ast.stmt):
                yield child
            if not isinstance(child, ast.FunctionDef):
                waiting.append(child)


def _own_lines(statement: ast.stmt) -> set[int]:
    """Return the lines of a statement that are not those of a statement inside it."""
    lines = set(range(statement.lineno, (statement.end_lineno or statement.lineno) + 1))
    for inner in ast.walk(statement):
        if isinstance(inner, ast.stmt) and inner is not statement:
            lines -= set(range(inner.lineno, (inner.end_lineno or inner.lineno) + 1))
    return lines | {statement.lineno}


def _is_text(statement: ast.stmt) -> bool:
    return (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    )


def _is_note(statement: ast.stmt) -> bool:
    match statement:
        case ast.Expr(value=ast.Call(func=ast.Name(id=name))):
            return name == NOTE
    return False
