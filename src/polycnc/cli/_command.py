"""Commands whose help and refusals are in words, and not in those of the library that checks the options."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import typer
from typer.core import TyperArgument, TyperCommand, TyperOption

from polycnc.cli._errors import guarded

_NUMBER = ("float_parsing", "int_parsing", "int_parsing_size", "int_from_float", "finite_number")
_BOUNDS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")


_WORDS = {
    "<int range>": "N",
    "<int>": "N",
    "<float range>": "X",
    "<float>": "X",
    "<path>": "FILE",
    "<str>": "NAME",
}


class _Argument(TyperArgument):
    """An argument that is shown by its name alone."""

    def get_usage_pieces(self, ctx: Any) -> list[str]:
        """Return the argument as a line of usage shows it."""
        name = self.display_name_raw.strip("[]")
        return [(name if self.required else f"[{name}]") + ("..." if self.nargs != 1 else "")]

    def display_type_rich(self, ctx: Any) -> str | None:
        """Return nothing: the help says what it is."""
        return None


class _Option(TyperOption):
    """An option whose value has a word."""

    def display_type(self, ctx: Any) -> str:
        """Return what stands for the value."""
        shown = super().display_type(ctx)
        return _WORDS.get(shown, shown)

    def _get_number_range_help_str(self) -> str | None:
        if self.min is None or self.max is None:
            return super()._get_number_range_help_str()
        return f"{self.min:.12g} to {self.max:.12g}"


class Command(TyperCommand):
    """A command whose refusals of options are sentences."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        for each in self.params:
            if isinstance(each, TyperArgument):
                each.__class__ = _Argument
            elif isinstance(each, TyperOption):
                each.__class__ = _Option

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


def add_command(app: typer.Typer, name: str, function: Callable[..., None], short_help: str) -> None:
    """Give an application a command that ends with a message and an exit status whatever happens."""
    app.command(name, cls=Command, short_help=short_help)(guarded(function))


def group(text: str) -> typer.Typer:
    """Return an application for the commands below a command; `text` is its help."""
    return typer.Typer(help=text, no_args_is_help=True, rich_markup_mode=None)


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
