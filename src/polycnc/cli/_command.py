"""Commands that speak in words of options and what is wrong with them, not in those of the library that reads them."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import typer
from typer.core import TyperCommand

_NUMBER = ("float_parsing", "int_parsing", "int_parsing_size", "int_from_float", "finite_number")
_ARGUMENT = re.compile(r"^\[?([^\]<]+)\]? <.*>$")
_TYPE = re.compile(
    r"<(?:(?P<number>int|float)(?: range)?|(?P<file>path|file)|(?P<choice>[^<>]*\|[^<>]*)|[^<>]*)>"
)
_BETWEEN = re.compile(r"([-+.\de]+)<=x<=([-+.\de]+)")
_BOUNDS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")


class Command(TyperCommand):
    """A command whose help names what is given, and whose refusals of options are sentences."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Take the words of the command line.

        Raises:
            typer.BadParameter: One of them does not do.
        """
        try:
            return super().parse_args(ctx, args)
        except typer.BadParameter as error:
            error.message = _in_words(error)
            raise

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """Return the usage line's words: arguments as their names, in brackets where they may be absent."""
        return [
            piece.replace("{", "").replace("}", "").replace("[[", "[").replace("]]", "]")
            for piece in super().collect_usage_pieces(ctx)
        ]

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments and options without the types of the code."""
        rows: dict[str, list[tuple[str, str]]] = {"argument": [], "option": []}
        for param in self.get_params(ctx):
            if (record := param.get_help_record(ctx)) is not None:
                name, text = record
                name = _ARGUMENT.sub(r"\1", name) if param.param_type_name == "argument" else name
                rows[param.param_type_name].append((_TYPE.sub(_kind, name), _BETWEEN.sub(_range, text)))
        for title, found in (("Arguments", rows["argument"]), ("Options", rows["option"])):
            if found:
                with formatter.section(title):
                    formatter.write_dl(found)


def _kind(found: re.Match[str]) -> str:
    """Return what is given in place of a type."""
    if found["number"]:
        return "N"
    return "FILE" if found["file"] else found["choice"] or "TEXT"


def _range(found: re.Match[str]) -> str:
    return " to ".join(f"{float(bound):.12g}" for bound in found.groups())


def _in_words(error: typer.BadParameter) -> str:
    """Return what is wrong; pydantic's own text only where it is not known what it is about."""
    found: Callable[[], list[dict[str, Any]]] | None = getattr(error.__cause__, "errors", None)
    if found is None:
        return error.message
    first = found()[0]
    given = f"'{str(first['input'])[:40]}'"
    least, most = (getattr(error.param, name, None) for name in ("min", "max"))
    if first["type"] in _BOUNDS and least is not None and most is not None:
        return f"{given} is not between {least:g} and {most:g}."
    if first["type"] in _NUMBER:
        return f"{given} is no {'whole number' if 'int' in first['type'] else 'number'}."
    return error.message.removeprefix("Value error, ")
