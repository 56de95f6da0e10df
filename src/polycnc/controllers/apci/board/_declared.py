"""The records that programs exchange with the board, tables 2 to 11 of Manual 002, read from `structures.h`."""

from polycnc.controllers.library import Header

HEADER = Header.beside(__name__, characters=str, checked=True)
globals().update(HEADER.names)
