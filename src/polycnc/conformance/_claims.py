"""Read and judge what is said about rows: which tests claim them, and which do not apply to polycnc.

``claims.tsv`` is generated from the tests' ``covers`` marks; ``not_applicable.toml`` is written by hand.
"""

from __future__ import annotations

import ast
import difflib
import functools
import inspect
import linecache
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping
from fnmatch import translate
from pathlib import Path

from polycnc.conformance._rows import SYSTEMS, Row, table_lines
from polycnc.errors import ConfigurationError

CLAIMS_FILE = "claims.tsv"
NOT_APPLICABLE_FILE = "not_applicable.toml"
STAND_INS_FILE = "stand_ins.toml"
CLAIM_COLUMNS = ("row", "test")

_ASSERTING_CALLS = ("raises", "warns", "fail")


def claims_text(claims: Iterable[tuple[str, str]]) -> str:
    """Return the contents of ``claims.tsv`` for pairs of row id and test: sorted, none twice."""
    lines = ["\t".join(CLAIM_COLUMNS), *("\t".join(pair) for pair in sorted(set(claims)))]
    return "\n".join(lines) + "\n"


def read_claims(folder: Path, rows: Mapping[str, Row]) -> dict[str, tuple[str, ...]]:
    """Return the tests that claim each claimed row; none when there is no claims file yet.

    Raises:
        ConfigurationError: The file is malformed or claims a row that does not exist.
    """
    path = folder / CLAIMS_FILE
    claims: dict[str, tuple[str, ...]] = {}
    if not path.exists():
        return claims
    for (row_id, test), place in table_lines(path, CLAIM_COLUMNS):
        if row_id not in rows:
            raise ConfigurationError(
                f"{test} claims '{row_id}', which is no row",
                hint=f"{_similar(row_id, rows)}Mend the mark, then run scripts/reference.",
                position=place,
            )
        claims[row_id] = (*claims.get(row_id, ()), test)
    return claims


def read_not_applicable(folder: Path, rows: Mapping[str, Row]) -> dict[str, str]:
    """Return the reason for each row stated as not applicable, patterns expanded; none without the file.

    Raises:
        ConfigurationError: A pattern fits no row, a row is stated twice, a reason is missing.
    """
    path = folder / NOT_APPLICABLE_FILE
    if not path.exists():
        return {}
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise ConfigurationError(f"{path.name}: {error}", hint="Mend the TOML syntax there.") from error
    reasons: dict[str, str] = {}
    for system, table in tables.items():
        if system not in SYSTEMS or not isinstance(table, dict):
            raise ConfigurationError(
                f"{path.name}: '{system}' is no table of a system", hint=f"Tables are: {', '.join(SYSTEMS)}"
            )
        ids = [row.id for row in rows.values() if row.system == system]
        for pattern, reason in table.items():
            fits = re.compile(translate(pattern)).match
            fitting = [row_id for row_id in ids if fits(row_id)]
            _check_entry(f"{path.name}: '{pattern}'", reason, fitting, reasons)
            reasons |= {row_id: str(reason) for row_id in fitting}
    return reasons


def read_stand_ins(folder: Path) -> dict[str, str]:
    """Return what the tests of a file run against instead of the control, by file; none without the file.

    Raises:
        ConfigurationError: The file is malformed.
    """
    path = folder / STAND_INS_FILE
    if not path.exists():
        return {}
    try:
        stand_ins = tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise ConfigurationError(f"{path.name}: {error}", hint="Mend the TOML syntax there.") from error
    for file, what in stand_ins.items():
        if not isinstance(what, str) or not what.strip():
            raise ConfigurationError(f"{path.name}: '{file}' does not say what stands in", hint="Say it.")
    return stand_ins


def invalid_claim(row_id: object, rows: Mapping[str, Row], not_applicable: Mapping[str, str]) -> str:
    """Return what is wrong with a test's claim of a row, or an empty string."""
    if not isinstance(row_id, str):
        return f"covers takes row ids, not {row_id!r}"
    if row_id not in rows:
        return f"covers names '{row_id}', which is no conformance row. {_similar(row_id, rows)}".rstrip()
    if row_id in not_applicable:
        return (
            f"covers names '{row_id}', which {NOT_APPLICABLE_FILE} states as not applicable "
            f"({not_applicable[row_id]}). Remove one of the two."
        )
    return ""


def asserts_something(function: Callable[..., object]) -> bool:
    """Tell whether a test function's own body can fail on a wrong behaviour.

    What counts: an assert, ``pytest.raises``, ``warns`` or ``fail``, and a call named ``assert_...``.
    A function whose source cannot be found is taken as asserting nothing.
    """
    handle = getattr(function, "hypothesis", None)  # what @given wraps
    inner = inspect.unwrap(getattr(handle, "inner_test", function))
    code = getattr(inner, "__code__", None)
    body = None if code is None else _functions(code.co_filename).get(code.co_firstlineno)
    return body is not None and any(_asserts(node) for node in ast.walk(body))


@functools.cache
def _functions(path: str) -> dict[int, ast.AST]:
    """Return the functions of a file by the line in which they, or their decorators, begin."""
    try:
        tree = ast.parse("".join(linecache.getlines(path)))
    except SyntaxError:
        return {}
    return {
        min([node.lineno, *(each.lineno for each in node.decorator_list)]): node
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    }


def _asserts(node: ast.AST) -> bool:
    if isinstance(node, ast.Assert):
        return True
    if not isinstance(node, ast.Call):
        return False
    called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    return called in _ASSERTING_CALLS or called.lstrip("_").startswith("assert_")


def _check_entry(entry: str, reason: object, fitting: list[str], stated: Mapping[str, str]) -> None:
    if not fitting:
        raise ConfigurationError(
            f"{entry} fits no row of its table's system", hint="Write a row's id, or a pattern with * or ?."
        )
    if not isinstance(reason, str) or not reason.strip():
        raise ConfigurationError(f"{entry} has no reason", hint="Say in a sentence why it cannot apply.")
    twice = [row_id for row_id in fitting if row_id in stated]
    if twice:
        raise ConfigurationError(f"{entry} states '{twice[0]}' a second time", hint="Leave one of the two.")


def _similar(row_id: str, rows: Mapping[str, Row]) -> str:
    close = difflib.get_close_matches(row_id, rows, n=1, cutoff=0.7)
    return f"Is '{close[0]}' meant? " if close else ""
