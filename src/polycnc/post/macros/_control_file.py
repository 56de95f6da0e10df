"""An output control file: read, checked as a whole and compiled; then it starts runs that write programs."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from polycnc.errors import ConfigurationError, SourcePosition, UsageError, did_you_mean
from polycnc.language import Flaw
from polycnc.machine import KeyPath, Locator, parse_toml, validate
from polycnc.nc import load_dialect
from polycnc.post.macros._compile import START_WORDS, Style, TracedMacro, compile_macro, used_words
from polycnc.post.macros._control_parameters import CODECS, SECTIONS, ControlTables, Parameters
from polycnc.post.macros._control_symbols import ControlFlaw, read_symbols
from polycnc.post.macros._elements import Assignment, Text
from polycnc.post.macros._format import read_format
from polycnc.post.macros._macro import If, Statement, read_macro
from polycnc.post.macros._parameters import NO_DIALECT
from polycnc.post.macros._run import MacroRun, Write
from polycnc.post.macros._symbols import Symbols

CONTROLS: tuple[str, ...] = (
    "bosch-pnc",
    "bosch-pnc-cpl",
    "din",
    "fanuc-5axis",
    "fanuc-lathe",
    "fanuc-mill",
    "grbl",
    "haas-mill",
    "heidenhain",
    "linuxcnc-mill",
    "siemens-840d",
)
"""Names of the control files that come with polycnc."""

_SHOWN_FLAWS = 20


@dataclass(frozen=True, slots=True)
class ControlFile:
    """A control file, checked and compiled; `load_control` and `parse_control` make it."""

    file: str
    parameters: Parameters
    variables: frozenset[str]
    """Keys of the function variables."""
    _macros: Mapping[str, TracedMacro] = field(repr=False)
    _symbols: Symbols = field(repr=False)
    _style: Style = field(repr=False)
    _places: _MacroPlaces = field(repr=False)
    _texts: Mapping[str, str] = field(repr=False)

    def has(self, macro: str) -> bool:
        """Tell whether the file has a macro."""
        return macro in self._macros

    def uses(self, macro: str, word: str) -> bool:
        """Tell whether the text of a macro names a word."""
        return _are_named({macro: self._texts.get(macro, "")}, word)

    def names(self, word: str) -> bool:
        """Tell whether any macro names a word."""
        return _are_named(self._texts, word)

    def start(self, write: Write) -> MacroRun:
        """Return a run for one output program; every block goes to `write` as a line with a line feed."""
        return MacroRun(self._macros, self._symbols, self._style, write, self._places.position)


def load_control(source: str | Path) -> ControlFile:
    """Return a control file by the name of one that comes with polycnc, or from a file in UTF-8 or Shift-JIS.

    Raises:
        UsageError: There is no such file.
        ConfigurationError: It is not a control file; position and hint tell where and what to do.
    """
    if isinstance(source, str) and source in CONTROLS:
        return _shipped(source)
    path = Path(source)
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise UsageError(
            f"there is no control file '{source}'",
            hint=f"{did_you_mean(str(source), CONTROLS)}Use {', '.join(CONTROLS)}, or the path of a control file.",
        ) from None
    except (OSError, ValueError) as error:  # ValueError: no file can have this name
        why = error.strerror if isinstance(error, OSError) else error
        raise UsageError(f"cannot read '{source}': {why}", hint="Check the name.") from error
    return parse_control(_decoded(data, str(source)), str(source))


def parse_control(text: str, file: str = "control file") -> ControlFile:
    """Return the control file that `text` describes; `file` is its name in errors.

    Raises:
        ConfigurationError: A key, a value or a line of a macro is wrong. Everything is checked; the first
            problem has its position and the others follow, one per line.
    """
    data, locator = parse_toml(text, file)
    data, locator = _in_english(data, locator)
    tables = validate(ControlTables, data, locator)
    try:
        symbols = read_symbols(tables)
    except ControlFlaw as flaw:
        raise ConfigurationError(flaw.what, hint=flaw.hint, position=locator.position(flaw.at)) from None
    _check_dialect(tables, locator)
    _check_characters(tables, locator)
    places = _MacroPlaces(text, locator, tables.nc_macros)
    style = _style(tables.parameters)
    macros = _compiled(tables.nc_macros, symbols, style, places, tables.parameters.encoding)
    return ControlFile(
        file,
        tables.parameters,
        frozenset(symbols.variables),
        macros,
        symbols,
        style,
        places,
        tables.nc_macros,
    )


def shipped_text(name: str) -> str:
    """Return the text of a control file that comes with polycnc, to start one's own from."""
    return (resources.files("polycnc.post") / "control" / f"{name}.toml").read_text(encoding="utf-8")


@cache
def _shipped(name: str) -> ControlFile:
    return parse_control(shipped_text(name), f"{name}.toml")


def _decoded(data: bytes, file: str) -> str:
    found = 0
    for codec in ("utf-8-sig", "cp932"):
        try:
            text = data.decode(codec)
        except UnicodeDecodeError as error:
            found = max(found, error.start)
        else:
            if "\0" not in text:
                return text
            found = max(found, data.index(0))  # UTF-16, of which each byte may be one of Shift-JIS
    line = data.count(b"\n", 0, found) + 1
    raise ConfigurationError(
        f"'{file}' is neither UTF-8 nor Shift-JIS text: line {line} has bytes of neither",
        hint="save the file as UTF-8",
    )


def _in_english(data: dict[str, Any], locator: Locator) -> tuple[dict[str, Any], Locator]:
    """Return data and locator with the sections under their English names."""
    written: dict[str, str] = {}
    for key in data:
        name = SECTIONS.get(key, key)
        if name in written:
            raise ConfigurationError(
                f"[{key}] is the section [{written[name]}] a second time",
                hint="join the two",
                position=locator.position((key,)),
            )
        written[name] = key
    return {name: data[key] for name, key in written.items()}, _SectionLocator(locator, written)


class _SectionLocator(Locator):
    """Find keys whose first part is the English name of a section that the file writes otherwise."""

    def __init__(self, locator: Locator, written: Mapping[str, str]) -> None:
        self.__dict__.update(locator.__dict__)
        self._written = written

    def position(self, path: KeyPath) -> SourcePosition:
        if path and isinstance(path[0], str):
            path = (self._written.get(path[0], path[0]), *path[1:])
        return super().position(path)


def _are_named(texts: Mapping[str, str], *words: str) -> bool:
    """Tell whether any text names one of some words."""
    pattern = re.compile(rf"\b({'|'.join(words)})\b", re.IGNORECASE)
    return any(pattern.search(text) for text in texts.values())


def _style(parameters: Parameters) -> Style:
    return Style(
        separator=parameters.separator,
        numbered=parameters.sequence_place,
        number_format=read_format(parameters.sequence_format),
        number_step=parameters.sequence_step,
        number_start=parameters.sequence_start,
        number_highest=parameters.sequence_highest,
    )


def _compiled(
    texts: Mapping[str, str], symbols: Symbols, style: Style, places: _MacroPlaces, encoding: str
) -> dict[str, TracedMacro]:
    flaws: list[tuple[str, Flaw]] = []
    read = {name: read_macro(text) for name, text in texts.items()}
    used = used_words(
        (statements for statements, _ in read.values()), start_point=_are_named(texts, *START_WORDS)
    )
    macros: dict[str, TracedMacro] = {}
    for name, (statements, unread) in read.items():
        compiled, unknown = compile_macro(name, statements, symbols, style, used, sound=not unread)
        flaws += [(name, flaw) for flaw in (*unread, *unknown, *_unwritable(statements, encoding))]
        if compiled is not None:
            macros[name] = compiled
    if flaws:
        raise _all_flaws(flaws, places)
    return macros


def _check_dialect(tables: ControlTables, locator: Locator) -> None:
    """Refuse a dialect that there is not: the program could not be verified."""
    if tables.parameters.dialect == NO_DIALECT:
        return
    try:
        load_dialect(tables.parameters.dialect)
    except UsageError as error:
        raise ConfigurationError(
            error.what,
            hint=f'{error.hint} Write "{NO_DIALECT}" for a language that nothing here reads.',
            position=locator.position(("parameters", "dialect")),
        ) from None


def _check_characters(tables: ControlTables, locator: Locator) -> None:
    """Refuse characters outside of macros that the encoding of the program has not."""
    parameters = tables.parameters
    texts: dict[KeyPath, str] = {
        ("parameters", "separator"): parameters.separator,
        ("parameters", "sequence_format"): parameters.sequence_format,
    }
    texts |= {("nc_code", key, "code"): entry.code for key, entry in tables.nc_code.items() if entry.code}
    variables = tables.function_variables
    texts |= {("function_variables", key, "format"): entry.format for key, entry in variables.items()}
    for key, text in texts.items():
        if character := _lacking(text, parameters.encoding):
            what, hint = _cannot_be_written(character[0], parameters.encoding)
            raise ConfigurationError(what, hint=hint, position=locator.position(key))


def _unwritable(statements: Iterable[Statement], encoding: str) -> Iterator[Flaw]:
    """Yield a flaw for each text of a macro with a character that the encoding of the program has not."""
    for statement in statements:
        if isinstance(statement, If):
            for branch in statement.branches:
                yield from _unwritable(branch.body, encoding)
            continue
        for element in statement.elements:
            text = element.value if isinstance(element, Assignment) else getattr(element, "text", None)
            if isinstance(text, str) and (character := _lacking(text, encoding)):
                what, hint = _cannot_be_written(character[0], encoding)
                quote = 1 if isinstance(element, Text) and element.quoted else 0
                at = element.at + (character[1] + quote if isinstance(element, Text) else 0)
                yield Flaw(at, what, hint, line=statement.number)


def _lacking(text: str, encoding: str) -> tuple[str, int] | None:
    """Return the first character that an encoding has not, and its place."""
    try:
        text.encode(CODECS[encoding])
    except UnicodeEncodeError as error:
        return text[error.start], error.start
    return None


def _cannot_be_written(character: str, encoding: str) -> tuple[str, str]:
    return (
        f"the character '{character}' cannot be written in {encoding}",
        "use another one, or another 'encoding'",
    )


def _all_flaws(flaws: list[tuple[str, Flaw]], places: _MacroPlaces) -> ConfigurationError:
    found = []
    for macro, flaw in flaws:
        position = places.position(macro, flaw.line, flaw.at)
        found.append((position, f"[nc_macros] {macro}, line {flaw.line}: {flaw.what}", flaw.hint))
    found.sort(key=lambda each: (each[0].line, each[0].column))
    (position, what, hint), *others = found
    also = [f"also {place}: {text}" + (f" ({more})" if more else "") for place, text, more in others]
    if len(also) > _SHOWN_FLAWS:
        also = [*also[:_SHOWN_FLAWS], f"and {len(also) - _SHOWN_FLAWS} more"]
    if also and hint:
        hint = f"on line {position.line}: {hint}"
    parts = tuple(ConfigurationError(text, hint=more, position=place) for place, text, more in found)
    return ConfigurationError(what, hint="\n".join([*also, hint]).strip("\n"), position=position, parts=parts)


_VALUE = re.compile(r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')[ \t]*=[ \t]*('''|\"""|'|")(\r?\n)?""")


class _MacroPlaces:
    """Know where in the control file each line of each macro stands."""

    def __init__(self, text: str, locator: Locator, macros: Mapping[str, str]) -> None:
        lines = text.split("\n")
        self._begin: dict[str, tuple[int, int]] = {}
        self._lines = {name: macro.split("\n") for name, macro in macros.items()}
        self._locator = locator
        self._count = len(lines)
        for name in macros:
            key = locator.position(("nc_macros", name))
            rest = "\n".join(lines[key.line - 1 : key.line + 1])
            if found := _VALUE.match(rest, key.column - 1):
                begins_below = found[2] is not None and len(found[1]) == 3
                self._begin[name] = (key.line + 1, 0) if begins_below else (key.line, found.end(1))

    def position(self, macro: str, line: int, at: int) -> SourcePosition:
        """Return the place of a macro's line (from 1) and column (from 0).

        In texts with backslashes, where columns cannot be told, the macro's line is shown by itself.
        """
        text = self._lines[macro][line - 1]
        first, column = self._begin.get(macro, (0, 0))
        column = column if line == 1 else 0
        place = self._locator.position(("nc_macros", macro))
        if first and first + line - 1 <= self._count:
            place = self._locator.at_line(first + line - 1, column + at + 1)
            if place.text.startswith(text, column):
                return place
        return SourcePosition(place.file, place.line, at + 1, text)
