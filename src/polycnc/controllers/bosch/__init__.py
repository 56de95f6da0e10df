"""Bosch Rexroth Typ3 osa and PNC: what their part programs can ask of the control (Manual 003)."""

from polycnc.controllers.bosch._macoda import NEW_NUMBERS, present_number

__all__ = ["NEW_NUMBERS", "present_number"]
