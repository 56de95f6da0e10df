"""Stand-alone programs (SAP): the rw_SymPas compiler, its .CNC files, and the four CNC tasks that run them.

Part 1 of the manual prints fragments of rw_SymPas only. Those work as printed; the rest of the language is a
reconstructed plain Pascal, marked so in docs/reference/sap-language.md.
"""

from polycnc.controllers.apci.core._turn_state import BUFFER_BYTES, TASKS
from polycnc.controllers.apci.sap._cnc_file import CncFileError, read_cnc, write_cnc
from polycnc.controllers.apci.sap._commands import AXIS_QUALIFIERS, COMMANDS, SYSTEM_VARIABLES
from polycnc.controllers.apci.sap._compile import check, compile_program
from polycnc.controllers.apci.sap._faults import FAULTS
from polycnc.controllers.apci.sap._host import Call, Host
from polycnc.controllers.apci.sap._lexer import KEYWORDS, NAME, SourceText, tokens
from polycnc.controllers.apci.sap._program import Program
from polycnc.controllers.apci.sap._task import WAITING, Task, TaskStatus
from polycnc.controllers.apci.sap._tasks import Tasks

__all__ = [
    "AXIS_QUALIFIERS",
    "BUFFER_BYTES",
    "COMMANDS",
    "FAULTS",
    "KEYWORDS",
    "NAME",
    "SYSTEM_VARIABLES",
    "TASKS",
    "WAITING",
    "Call",
    "CncFileError",
    "Host",
    "Program",
    "SourceText",
    "Task",
    "TaskStatus",
    "Tasks",
    "check",
    "compile_program",
    "read_cnc",
    "tokens",
    "write_cnc",
]
