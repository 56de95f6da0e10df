"""The reference page of CPL, made from the rows of its statements, functions and errors."""

from polycnc.nc.cpl import ERRORS, FUNCTION_GROUPS, KIND_NAMES, RESERVED, STATEMENTS, UNUSED, Function

_HEAD = """# CPL

<!-- Written by scripts/reference. -->

The Customer Programming Language of Typ3 osa and PNC controls (dialect `bosch`): statements, functions and commands,
reserved words, and what programs end with. What stands in `[brackets]` may be left out, what stands in `{braces}` may
follow any number of times. Statements stand in blocks that begin with a number; in NC blocks expressions stand in
brackets: `N10 G1 X[A%*2]`. How the manual is read where it leaves something open is among the [rulings](rulings.md);
the services MCODS and MCOPS have [a page of their own](bosch-ncs.md).

Operators from tight to loose: `NOT` and signs; `* / AND`; `+ - OR XOR`; `= <> < <= > >=`. The last character of a name
is its type: `%` INTEGER, none REAL, `!` DOUBLE, `?` BOOLEAN, `$` string; `#NAME` is global, `@NAME` permanent, `P1` a
parameter.
"""


def _result(row: Function) -> str:
    if row.command:
        return ""
    kind = {"S": "text", "X": "as the data"}.get(row.kind, KIND_NAMES[row.kind])
    return "as its argument" if row.keeps_type else kind


def _notes(row: Function) -> str:
    notes = (
        (row.settable, "can be set"),
        (bool(row.results) and row.name != "MMC", "sets variables"),
        (row.waiting, "waits for its answer"),
    )
    return ", ".join(note for holds, note in notes if holds)


def page() -> str:
    """Return the page."""
    parts = [_HEAD, "\n## Statements\n\n| statement | what it does |\n| --- | --- |\n"]
    parts += [f"| `{usage}` | {sentence} |\n" for usage, sentence in STATEMENTS.items()]
    parts.append(
        "\n## Functions and commands\n\nThose without a value are commands, and stand by themselves.\n"
    )
    for heading, rows in FUNCTION_GROUPS.items():
        parts.append(f"\n### {heading}\n\n| | value | what it does | |\n| --- | --- | --- | --- |\n")
        parts += [f"| `{row.usage}` | {_result(row)} | {row.sentence} | {_notes(row)} |\n" for row in rows]
    words, unused = (" ".join(f"`{word}`" for word in sorted(each)) for each in (RESERVED, UNUSED))
    parts.append(f"\n## Reserved words\n\nNo variable has one of these names: {words}.\n")
    parts.append(f"\nWithout a function: {unused}.\n")
    parts.append("\n## Errors\n\n| error | number | when |\n| --- | --- | --- |\n")
    parts += [f"| {what} | {number} | {when} |\n" for what, (number, when) in ERRORS.items()]
    return "".join(parts)
