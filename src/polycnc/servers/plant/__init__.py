"""What a plant wants to know of a machine: one table of facts, read from its status, for every door."""

from polycnc.servers.plant._conditions import About, Trouble, troubles
from polycnc.servers.plant._facts import FACTS, Execution, Scope, Seen, Unit, Value, asset_id, see
from polycnc.servers.plant._places import Place, Shape, places, shape_of

__all__ = [
    "FACTS",
    "About",
    "Execution",
    "Place",
    "Scope",
    "Seen",
    "Shape",
    "Trouble",
    "Unit",
    "Value",
    "asset_id",
    "places",
    "see",
    "shape_of",
    "troubles",
]
