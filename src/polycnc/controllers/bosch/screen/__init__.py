"""The dialog window of a CPL program: 79 x 46 characters on 633 x 415 pixels, no device (Manual 003, chapters 7, 8)."""

from polycnc.controllers.bosch.screen._bitmap import Image, read_bitmap
from polycnc.controllers.bosch.screen._dialog import Dialog
from polycnc.controllers.bosch.screen._keys import KEYS, Keyboard
from polycnc.controllers.bosch.screen._surface import COLUMNS, HEIGHT, LINES, WIDTH, Surface

__all__ = [
    "COLUMNS",
    "HEIGHT",
    "KEYS",
    "LINES",
    "WIDTH",
    "Dialog",
    "Image",
    "Keyboard",
    "Surface",
    "read_bitmap",
]
