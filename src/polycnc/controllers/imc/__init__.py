"""The iMC motion card: 16-bit parameter memory, instruction queues, events, coupling and homing in compiled code.

`imclib` is the library that programs call, by the manual's names; `Card` is the virtual card behind it.
"""

from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.imc.card._config import CardConfig, load_card, parse_card
from polycnc.controllers.imc.card._status import CardStatus

__all__ = ["Card", "CardConfig", "CardStatus", "load_card", "parse_card"]
