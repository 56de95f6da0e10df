"""The iMC motion card: 16-bit parameter memory, instruction queues, events, coupling and homing in compiled code.

`imclib` is the library that programs call, by the manual's names; `Card` is the virtual card behind it.
"""

from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.imc.card._config import CardConfig, load_card, parse_card
from polycnc.controllers.imc.card._status import CardStatus
from polycnc.controllers.imc.core._parameters import PARAMETERS, Parameter

__all__ = ["PARAMETERS", "Card", "CardConfig", "CardStatus", "Parameter", "load_card", "parse_card"]
