"""The façade desk: what every vendor's function library needs, in terms of C and of none of them.

A call is data: a Python function whose annotations say the C type and direction of every argument. A `Facade` keeps the
table of them and makes the functions that programs call; around each call it locks, converts and checks the arguments,
finds what the call is for, and turns refusals into codes. A `Session` is one client with all its state. A `Structure`
is memory with a table of what lies where; a `Header` reads them from C text.
"""

from polycnc.controllers.library import _c_types, _codes, _facade, _functions, _header, _structures
from polycnc.controllers.library._c_types import *  # noqa: F403
from polycnc.controllers.library._codes import *  # noqa: F403
from polycnc.controllers.library._facade import *  # noqa: F403
from polycnc.controllers.library._functions import *  # noqa: F403
from polycnc.controllers.library._header import *  # noqa: F403
from polycnc.controllers.library._structures import *  # noqa: F403

__all__ = [
    *_c_types.__all__,
    *_codes.__all__,
    *_facade.__all__,
    *_functions.__all__,
    *_header.__all__,
    *_structures.__all__,
]
