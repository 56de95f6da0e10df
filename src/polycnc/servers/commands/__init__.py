"""Commands as data: what an operator can do, its parameters with ranges and units, and how it is carried out."""

from polycnc.servers.commands._asked import NUMBERS, Asked, NotMeantError, carry_out, first_problem, model_of
from polycnc.servers.commands._rows import COMMANDS, Command, Parameter

__all__ = [
    "COMMANDS",
    "NUMBERS",
    "Asked",
    "Command",
    "NotMeantError",
    "Parameter",
    "carry_out",
    "first_problem",
    "model_of",
]
