"""Commands as data: what an operator can do, its parameters with ranges and units, and how it is carried out."""

from polycnc.servers.commands._asked import NUMBERS, NotMeantError, carry_out, model_of, told
from polycnc.servers.commands._rows import COMMANDS

__all__ = ["COMMANDS", "NUMBERS", "NotMeantError", "carry_out", "model_of", "told"]
