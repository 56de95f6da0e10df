"""The structures of the function library (Manual 000), read from `structures.h`.

`HEADER.packed(PACKINGS[...])` has them as the manual packs them, or as later headers of the same library do: a range of
n macro variables has 6 + 6 n bytes there, 8 + 8 n here.
"""

from polycnc.controllers.library import Header

HEADER = Header.beside(__name__)
PACKINGS = {"manual": None, "later": 4}
globals().update(HEADER.names)

__all__ = [*HEADER.classes, "MAX_AXIS", "MAX_PBUF", "MAX_RBUF", "MSG_SIZE"]  # noqa: F822
