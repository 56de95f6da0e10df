"""Collect what the sections of a control file define, and check what no single key can tell."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping

from polycnc.machine import KeyPath
from polycnc.post.macros._control_parameters import CodeKey, ControlTables, NcCode
from polycnc.post.macros._elements import KEY
from polycnc.post.macros._events import MACROS, is_added_macro, is_macro
from polycnc.post.macros._format import FormatError, read_format
from polycnc.post.macros._symbols import SEQUENCE_NUMBER, CodeSymbol, Symbols, VariableSymbol, reserved

_DEFAULT_SEQUENCE_ORDER = -100
_ORIGIN_AXES = ("X", "Y", "Z")
_VARIABLE_KEY = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


class ControlFlaw(Exception):  # noqa: N818 (never leaves the package)
    """Something wrong with a key of a control file."""

    def __init__(self, what: str, hint: str, at: KeyPath) -> None:
        super().__init__(what)
        self.what = what
        self.hint = hint
        self.at = at


def read_symbols(tables: ControlTables) -> Symbols:
    """Return the names that the macros of a control file may use.

    Raises:
        ControlFlaw: A key is no name, is defined twice, or is given for nothing; a format is none.
    """
    symbols = Symbols(strict=tables.parameters.strict)
    entries = _entries(tables)
    taken: dict[str, str] = {}
    for section, codes in (("g_code", tables.g_code), ("m_code", tables.m_code)):
        _add_codes(section, codes, entries, symbols, taken)
    _add_variables(tables, entries, symbols, taken)
    words = {*symbols.words(), SEQUENCE_NUMBER}
    for key, (path, entry) in entries.items():
        if key not in taken and key not in words:
            known = [*taken, *sorted(words)]
            close = difflib.get_close_matches(key, known, n=1)
            hint = f"did you mean {close[0]}?" if close else "define it in its own section too"
            raise ControlFlaw(f"[nc_code] gives '{path[-1]}', which no other section defines", hint, path)
        if entry.code is not None and key not in symbols.codes:
            raise ControlFlaw(
                f"'{path[-1]}' is no G or M code and has no code text",
                "give only its order; the text of a function variable is in its format",
                (*path, "code"),
            )
        if not entry.separator and key not in symbols.codes and key not in symbols.variables:
            raise ControlFlaw(
                f"there is no separator before '{path[-1]}'",
                "only codes and function variables have one; leave the key out",
                (*path, "separator"),
            )
        symbols.orders[key] = entry.order
    symbols.orders.setdefault(SEQUENCE_NUMBER, _DEFAULT_SEQUENCE_ORDER)
    _check_macros(tables.nc_macros, tables.parameters.strict)
    return symbols


def _entries(tables: ControlTables) -> dict[str, tuple[KeyPath, NcCode]]:
    entries: dict[str, tuple[KeyPath, NcCode]] = {}
    for key, entry in tables.nc_code.items():
        path = ("nc_code", key)
        if key.upper() in entries:
            raise ControlFlaw(f"[nc_code] gives '{key}' twice", "capitals make no difference", path)
        entries[key.upper()] = (path, entry)
    return entries


def _add_codes(
    section: str,
    codes: Mapping[str, CodeKey],
    entries: Mapping[str, tuple[KeyPath, NcCode]],
    symbols: Symbols,
    taken: dict[str, str],
) -> None:
    for key, code in codes.items():
        name = _new_name(section, key, KEY, taken, symbols.strict)
        entry = entries[name][1] if name in entries else NcCode()
        text = key if entry.code is None else entry.code
        group = symbols.group(f"{section} {code.group}" if code.group else "")
        symbols.codes[name] = CodeSymbol(
            name, text, entry.order, group, len(symbols.codes) + 1, entry.separator
        )


def _add_variables(
    tables: ControlTables,
    entries: Mapping[str, tuple[KeyPath, NcCode]],
    symbols: Symbols,
    taken: dict[str, str],
) -> None:
    origins = {str(axis): value for axis, value in tables.parameters.machining_origin.items()}
    for key, variable in tables.function_variables.items():
        name = _new_name("function_variables", key, _VARIABLE_KEY, taken, symbols.strict)
        try:
            number = read_format(variable.format, variable.zeros, variable.scale)
        except FormatError as flaw:
            path = ("function_variables", key, "format")
            raise ControlFlaw(str(flaw), 'write text with one number, like "X%.3f"', path) from None
        origin = origins.get(name, 0.0) if name in _ORIGIN_AXES else None
        initial = variable.initial if variable.initial is not None else origin or 0.0
        entry = entries[name][1] if name in entries else NcCode()
        symbols.variables[name] = VariableSymbol(
            name,
            entry.order,
            number,
            variable.modal,
            len(symbols.variables),
            origin,
            initial,
            entry.separator,
        )


def _new_name(section: str, key: str, spelling: re.Pattern[str], taken: dict[str, str], strict: bool) -> str:
    path = (section, key)
    name = key.upper()
    if not spelling.fullmatch(key):
        raise ControlFlaw(
            f"'{key}' is not a search key", "begin with a letter, go on with letters, digits and _", path
        )
    if name in reserved(strict):
        raise ControlFlaw(f"'{key}' is a reserved word", "choose another search key", path)
    if name in taken:
        raise ControlFlaw(
            f"the search key '{key}' is in [{taken[name]}] too",
            "a search key is used once; capitals make no difference",
            path,
        )
    taken[name] = section
    return name


def _check_macros(macros: Mapping[str, str], strict: bool) -> None:
    for name in macros:
        if strict and is_added_macro(name):
            raise ControlFlaw(
                f"the event of '{name}' is an addition to the manual's",
                "leave the macro out, or 'strict' in the parameters",
                ("nc_macros", name),
            )
        if not is_macro(name):
            close = difflib.get_close_matches(name.upper(), MACROS, n=1)
            hint = f"did you mean {close[0]}?" if close else f"macros: {', '.join(sorted(MACROS))}"
            raise ControlFlaw(f"no event calls a macro '{name}'", hint, ("nc_macros", name))
