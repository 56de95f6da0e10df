"""The structures of the function library (Manual 004, 6), read from `structures.h`."""

from polycnc.controllers.library import Header

HEADER = Header.beside(__name__)
globals().update(HEADER.names)
