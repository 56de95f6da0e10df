"""Custom macros of FANUC controls: variables, expressions, program flow, and calls with arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from polycnc.on_demand import names_on_demand

if TYPE_CHECKING:
    from polycnc.nc.macro._calls import Arguments, MacroCalls
    from polycnc.nc.macro._functions import FUNCTIONS, OPERATORS
    from polycnc.nc.macro._language import MacroLanguage
    from polycnc.nc.macro._macro_source import MacroSource
    from polycnc.nc.macro._system import SystemVariables
    from polycnc.nc.macro._variables import LARGEST, LEVELS, LOCALS, MacroError, MacroVariables, Value

__all__ = [
    "FUNCTIONS",
    "LARGEST",
    "LEVELS",
    "LOCALS",
    "OPERATORS",
    "Arguments",
    "MacroCalls",
    "MacroError",
    "MacroLanguage",
    "MacroSource",
    "MacroVariables",
    "SystemVariables",
    "Value",
]

__getattr__ = names_on_demand(__name__)
