"""The tables of a control file as models: strict keys, each with its meaning, from which the reference is written."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from polycnc.machine import StrictModel, problem
from polycnc.post.macros._format import FormatError, Zeros, read_format
from polycnc.post.macros._parameters import MotionParameters

CODECS = {"utf-8": "utf-8", "ascii": "ascii", "shift-jis": "cp932"}
"""The codec of each encoding of a program."""


def _one_line(text: str) -> str:
    if "\n" in text or "\r" in text:
        raise problem("the text has more than one line", hint="write it in one line")
    return text


class Parameters(MotionParameters):
    """The parameter section: the control, its blocks and numbers, and how moves are made."""

    name: str = Field(default="", description="Name of the control.")
    description: str = Field(default="", description="Any text.")
    strict: bool = Field(
        default=False,
        description="Only what Manual 001 has: the events and words that are marked as additions do not exist, and "
        "their names are free for variables.",
    )
    encoding: Literal["utf-8", "ascii", "shift-jis"] = Field(
        default="utf-8", description="Encoding of the program."
    )
    line_end: Literal["lf", "crlf"] = Field(default="lf", description="What ends a line of the program.")
    separator: str = Field(
        default="",
        max_length=8,
        description="Text before each code and function variable that does not begin its block, and after a "
        "sequence number.",
    )
    sequence_place: Literal[0, 1, 2] = Field(
        default=0,
        description="Blocks with a sequence number. 0: none; 1: all; 2: those whose macro line has `@1@`.",
    )
    sequence_start: Annotated[int, Field(ge=0)] = Field(default=10, description="First sequence number.")
    sequence_step: Annotated[int, Field(ge=1)] = Field(default=10, description="Step of sequence numbers.")
    sequence_highest: Annotated[int, Field(ge=0)] = Field(
        default=0, description="Numbers above begin at the first one again; 0: no limit."
    )
    sequence_format: str = Field(default="N%d", description="How a sequence number is written; with %d.")
    machining_origin: dict[Literal["X", "Y", "Z"], float] = Field(
        default={},
        description="Values that X, Y, Z begin with and that `&X&`, `&Y&`, `&Z&` give them; absent: 0.",
    )

    _separator = field_validator("separator")(_one_line)

    @field_validator("sequence_format")
    @classmethod
    def _is_format(cls, text: str) -> str:
        try:
            whole = read_format(text).conversion.endswith(".0f")
        except FormatError as flaw:
            raise problem(str(flaw), hint='write it like "N%d" or "N%04d"') from None
        if not whole:
            raise problem(f"'{text}' does not write whole numbers", hint='write it like "N%d" or "N%04d"')
        return text


class NcCode(StrictModel):
    """An entry of the NC code section."""

    code: str | None = Field(
        default=None, description="Text of a G or M code in the program; absent: the search key."
    )
    order: Annotated[int, Field(ge=-999_999_999, le=999_999_999)] = Field(
        default=0, description="Place within the block if OUTPUTORDER is 1; small numbers come first."
    )
    separator: bool = Field(
        default=True, description="False: the `separator` of the parameters is not written before this one."
    )

    _code = field_validator("code")(lambda text: text if text is None else _one_line(text))


class CodeKey(StrictModel):
    """An entry of the G code or M code section."""

    group: str = Field(
        default="",
        description="Modal group: of the codes of a group one is in force. Absent: the code has no mode.",
    )


class FunctionVariable(StrictModel):
    """An entry of the function variable section."""

    format: str = Field(description="Text with one number: `%.3f`, `%d` or `%g`, like `X%.3f`.")
    zeros: Zeros = Field(
        default="keep",
        description='Zeros at the end of decimals. "keep": X1.500, X2.000; "trim": X1.5, X2; "point": X1.5, X2.',
    )
    scale: float = Field(default=1.0, description="The number is multiplied by it before it is written.")
    modal: bool = Field(default=True, description="Written only if it differs from what was written last.")
    initial: float | None = Field(
        default=None, description="First value; absent: the machining origin for X, Y, Z, else 0."
    )

    _format = field_validator("format")(_one_line)


class ControlTables(StrictModel):
    """A control file as it is read."""

    parameters: Parameters = Field(default=Parameters(), description="The parameters.")
    nc_code: dict[str, NcCode] = Field(default={}, description="Texts and order of what blocks are made of.")
    g_code: dict[str, CodeKey] = Field(default={}, description="Search keys of G codes.")
    m_code: dict[str, CodeKey] = Field(default={}, description="Search keys of M codes.")
    function_variables: dict[str, FunctionVariable] = Field(
        default={}, description="Numbers with a format, like X, F, S, T."
    )
    nc_macros: dict[str, str] = Field(description="The macros, by the name of their event.")


SECTIONS = {
    "パラメータ部": "parameters",
    "NCコード部": "nc_code",
    "Gコード部": "g_code",
    "Mコード部": "m_code",
    "機能変数": "function_variables",
    "NCマクロ部": "nc_macros",
}
"""The manual's names of the sections, which a file may use instead (Manual 001)."""
