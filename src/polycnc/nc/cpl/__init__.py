"""CPL: the language inside part programs, and what it needs of the control that runs it (Manual 003)."""

from polycnc.nc.cpl._blocks import CplLanguage, CplSource
from polycnc.nc.cpl._code_calls import CodeCalls
from polycnc.nc.cpl._faults import ERRORS, Fault, Text
from polycnc.nc.cpl._fields import Field
from polycnc.nc.cpl._formats import default_format, groups, number_in
from polycnc.nc.cpl._function import Function
from polycnc.nc.cpl._functions import GROUPS as FUNCTION_GROUPS
from polycnc.nc.cpl._functions import MOST_OF_MMC
from polycnc.nc.cpl._host import (
    BLOCKED,
    OMITTED,
    PAUSE,
    BlockWord,
    Box,
    Event,
    Host,
    Item,
    Lines,
    NcValues,
    Step,
    SubProgram,
    Waiting,
)
from polycnc.nc.cpl._lexicon import LEXICON, RESERVED, STATEMENTS, UNUSED
from polycnc.nc.cpl._link_table import LinkTable, LinkTables, read_table, written_table
from polycnc.nc.cpl._nc_lines import is_marked_typ2
from polycnc.nc.cpl._permanent import PermanentMemory
from polycnc.nc.cpl._program import Linker, Program, compile_program, holds_cpl
from polycnc.nc.cpl._run import Execution, Run, undeclared
from polycnc.nc.cpl._strings import CharacterField, Section, text_of
from polycnc.nc.cpl._variables import KIND_NAMES

__all__ = [
    "BLOCKED",
    "ERRORS",
    "FUNCTION_GROUPS",
    "KIND_NAMES",
    "LEXICON",
    "MOST_OF_MMC",
    "OMITTED",
    "PAUSE",
    "RESERVED",
    "STATEMENTS",
    "UNUSED",
    "BlockWord",
    "Box",
    "CharacterField",
    "CodeCalls",
    "CplLanguage",
    "CplSource",
    "Event",
    "Execution",
    "Fault",
    "Field",
    "Function",
    "Host",
    "Item",
    "Lines",
    "LinkTable",
    "LinkTables",
    "Linker",
    "NcValues",
    "PermanentMemory",
    "Program",
    "Run",
    "Section",
    "Step",
    "SubProgram",
    "Text",
    "Waiting",
    "compile_program",
    "default_format",
    "groups",
    "holds_cpl",
    "is_marked_typ2",
    "number_in",
    "read_table",
    "text_of",
    "undeclared",
    "written_table",
]
