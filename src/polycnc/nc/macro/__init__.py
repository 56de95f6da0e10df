"""Custom macros of FANUC controls: variables, expressions, program flow, and calls with arguments."""

from polycnc.nc.macro._calls import Arguments, MacroCalls
from polycnc.nc.macro._language import MacroLanguage, MacroSource, language_for
from polycnc.nc.macro._system import SystemVariables
from polycnc.nc.macro._variables import LARGEST, LEVELS, LOCALS, MacroError, MacroVariables, Value

__all__ = [
    "LARGEST",
    "LEVELS",
    "LOCALS",
    "Arguments",
    "MacroCalls",
    "MacroError",
    "MacroLanguage",
    "MacroSource",
    "MacroVariables",
    "SystemVariables",
    "Value",
    "language_for",
]
