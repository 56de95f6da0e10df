"""Functions of motion (manual 004, 4), made from their rows."""

from polycnc.controllers.imc.library._motion_rows import FUNCTIONS

globals().update(FUNCTIONS)
__all__ = [*FUNCTIONS]
