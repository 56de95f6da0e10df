"""The single changes that a module can suffer, found in its syntax tree and made in its text."""

from __future__ import annotations

import ast
import difflib
from collections.abc import Iterator
from dataclasses import dataclass

COMPARISONS: dict[type[ast.cmpop], tuple[str, str]] = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
}
OPERATORS: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "*"),
    ast.Mod: ("%", "*"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
    ast.LShift: ("<<", ">>"),
    ast.RShift: (">>", "<<"),
}
SYMMETRICAL = {"min", "max", "hypot", "gcd", "dist", "isclose", "minimum", "maximum", "array_equal"}


@dataclass(frozen=True)
class Mutant:
    """One change of a module: bytes `start` to `end` of its text become `new`; `lines` are those it touches."""

    kind: str
    start: int
    end: int
    new: bytes
    lines: range

    def applied(self, source: bytes) -> bytes:
        """Return the module's text with the change made."""
        return source[: self.start] + self.new + source[self.end :]

    def diff(self, source: bytes) -> str:
        """Return the changed lines as a diff without context."""
        before, after = source.decode().splitlines(), self.applied(source).decode().splitlines()
        lines = list(difflib.unified_diff(before, after, n=0, lineterm=""))[3:]
        return "\n".join(lines)


def mutants_of(source: bytes) -> list[Mutant]:
    """Return every change of a module's text that this module knows, in the order of their places."""
    return sorted(_Finder(source).found(), key=lambda each: (each.start, each.end, each.new))


class _Finder:
    """Walks the syntax tree; types, decorators and docstrings are left alone."""

    def __init__(self, source: bytes) -> None:
        self.source = source
        self.line_starts = [0]
        for line in source.splitlines(keepends=True):
            self.line_starts.append(self.line_starts[-1] + len(line))

    def found(self) -> Iterator[Mutant]:
        waiting: list[ast.AST] = [ast.parse(self.source)]
        while waiting:
            node = waiting.pop()
            yield from self._of(node)
            for name, value in ast.iter_fields(node):
                if name in ("annotation", "returns", "decorator_list", "type_params"):
                    continue
                children = value if isinstance(value, list) else [value]
                waiting += [each for each in children if isinstance(each, ast.AST) and not _left_alone(each)]

    def _of(self, node: ast.AST) -> Iterator[Mutant]:
        match node:
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                yield from self._between("comparison", left, right, COMPARISONS[type(op)])
            case ast.BinOp(left=left, op=operator, right=right) if type(operator) in OPERATORS:
                yield from self._between("arithmetic", left, right, OPERATORS[type(operator)])
            case ast.BoolOp(op=op, values=[first, second, *_]):
                change = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
                yield from self._between("logic", first, second, change)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                yield self._mutant("sign", node, self._text(operand))
            case ast.Constant(value=bool(value)):
                yield self._mutant("constant", node, str(not value).encode())
            case ast.Constant(value=int() | float() as value):
                # One of the two, by place, so that a run is short; -1 for 0 would be the last place, often the same.
                step = 1 if value == 0 or self._place(node)[0] % 2 else -1
                yield self._mutant("constant", node, repr(value + step).encode())
            case ast.If(test=test) | ast.While(test=test) | ast.IfExp(test=test) if not _is_equality(test):
                yield self._mutant("condition", test, b"not (" + self._text(test) + b")")
            case (
                ast.Subscript(slice=ast.Name(id=name) as at)
                | ast.Subscript(slice=ast.Tuple(elts=[ast.Name(id=name) as at, *_]))
            ) if len(name) == 1:
                yield self._mutant("index", at, b"0")  # what happens to the first alone
            case ast.Return(value=ast.Tuple(elts=[first, second, *_])):
                yield from self._swapped("return", first, second)
            case ast.Call(args=[*_, first, second]) if not _is_symmetrical(node):
                yield from self._swapped("arguments", first, second)
        if isinstance(node, ast.AugAssign) or _is_effect(node):
            yield self._mutant("dropped", node, b"pass")

    def _between(
        self, kind: str, left: ast.expr, right: ast.expr, change: tuple[str, str]
    ) -> Iterator[Mutant]:
        """Change an operator; between its operands there is nothing else but brackets, blanks and remarks."""
        old, new = (each.encode() for each in change)
        gap_start, gap_end = self._place(left)[1], self._place(right)[0]
        at = self.source.find(old, gap_start, gap_end)
        if at >= 0 and b"#" not in self.source[gap_start:gap_end]:
            yield Mutant(kind, at, at + len(old), new, self._lines(left, right))

    def _swapped(self, kind: str, first: ast.expr, second: ast.expr) -> Iterator[Mutant]:
        (start, first_end), (second_start, end) = self._place(first), self._place(second)
        middle = self.source[first_end:second_start]
        if self._text(first) != self._text(second) and middle.strip() == b",":
            new = self._text(second) + middle + self._text(first)
            yield Mutant(kind, start, end, new, self._lines(first, second))

    def _mutant(self, kind: str, node: ast.AST, new: bytes) -> Mutant:
        return Mutant(kind, *self._place(node), new, self._lines(node, node))

    def _place(self, node: ast.AST) -> tuple[int, int]:
        assert isinstance(node, (ast.expr, ast.stmt))
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        start = self.line_starts[node.lineno - 1] + node.col_offset
        return start, self.line_starts[node.end_lineno - 1] + node.end_col_offset

    def _lines(self, first: ast.AST, last: ast.AST) -> range:
        assert isinstance(first, (ast.expr, ast.stmt))
        assert isinstance(last, (ast.expr, ast.stmt))
        return range(first.lineno, (last.end_lineno or last.lineno) + 1)

    def _text(self, node: ast.AST) -> bytes:
        start, end = self._place(node)
        return self.source[start:end]


def _is_effect(node: ast.AST) -> bool:
    """Tell whether a statement can go without leaving a name undefined."""
    match node:
        case ast.Expr(value=ast.Call()):
            return True
        case ast.Assign(targets=[ast.Subscript() | ast.Attribute()]):
            return True
    return False


def _is_symmetrical(call: ast.Call) -> bool:
    """Tell whether the order of a call's arguments makes no difference, or cannot be told."""
    name = getattr(call.func, "attr", getattr(call.func, "id", ""))
    return name in SYMMETRICAL or any(isinstance(each, ast.Starred) for each in call.args)


def _is_equality(test: ast.expr) -> bool:
    """Tell whether changing the comparison negates the condition already."""
    return isinstance(test, ast.Compare) and not isinstance(test.ops[0], (ast.Lt, ast.LtE, ast.Gt, ast.GtE))


def _left_alone(node: ast.AST) -> bool:
    """Tell whether a part says nothing about behaviour: `__all__`, the guard of imports for types."""
    match node:
        case ast.Assign(targets=[ast.Name(id="__all__")]) | ast.AnnAssign(target=ast.Name(id="__all__")):
            return True
        case ast.If(test=ast.Name(id="TYPE_CHECKING")):
            return True
    return False
