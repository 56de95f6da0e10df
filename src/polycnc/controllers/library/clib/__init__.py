"""C libraries of the façades: how a call becomes bytes, and C text that does it.

A `CLibrary` says what the table of functions leaves open: how much lies behind a pointer, what a call answers when
nobody is there. `Slot` is an argument as bytes; `write_header`, `write_source`, `write_definitions` make the C text.
"""

from polycnc.controllers.library.clib._declarations import write_basic, write_csharp, write_pascal
from polycnc.controllers.library.clib._header_text import write_header
from polycnc.controllers.library.clib._names import write_definitions
from polycnc.controllers.library.clib._packing import alike, copied, length_in
from polycnc.controllers.library.clib._slots import Call, CLibrary, Slot, Way
from polycnc.controllers.library.clib._source import PORT, write_source

__all__ = [
    "PORT",
    "CLibrary",
    "Call",
    "Slot",
    "Way",
    "alike",
    "copied",
    "length_in",
    "write_basic",
    "write_csharp",
    "write_definitions",
    "write_header",
    "write_pascal",
    "write_source",
]
