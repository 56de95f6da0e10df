"""Lines that are no words: what is wrong with them."""

from __future__ import annotations

from polycnc.errors import ProgramError
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.text._not_words import statements, syntax_hint
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan_plain import Block

_LANGUAGES = (
    "Name the dialect of the control that they are for, like --dialect fanuc for custom macros or bosch for CPL, "
    "or post the program without them."
)


class Unread(ProgramError):  # noqa: N818  it is one like any
    """A statement that the language of the dialect has left, as it refused the program."""


class NotBlocks:
    """Say what is wrong with lines that are no words; statements of a language make one error a program."""

    def __init__(self, dialect: Dialect) -> None:
        self._name = dialect.name
        self._has_language = dialect.language != "none"
        self._rules = dialect.text_rules()
        self._known: tuple[ProgramText, int, int] | None = None  # a program, its first statement, how many

    def problem(self, text: ProgramText, block: Block) -> ProgramError:
        """Return what is wrong with a line."""
        wrong = syntax_hint(
            text.content[block.offset : text.line_end(block.offset)].decode("latin-1"), self._rules
        )
        if wrong is not None:
            position = text.position(block.offset + wrong.place)
            return ProgramError(wrong.what, position=position, hint=wrong.hint)
        if self._has_language:
            what = f"dialect '{self._name}' reads no statement like this"
            return Unread(what, position=text.line_position(block.line), hint="Check the line.")
        if self._known is None or self._known[0] is not text:
            self._known = (text, *statements(text, self._rules))
        _, first, count = self._known
        blocks = "1 block has them" if count <= 1 else f"{count} blocks have them, this is the first"
        return ProgramError(
            f"dialect '{self._name}' reads no variables, expressions or program flow ({blocks})",
            position=text.line_position(first or block.line),
            hint=_LANGUAGES,
        )
