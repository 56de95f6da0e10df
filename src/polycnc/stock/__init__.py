"""What a moving tool leaves of a body: tools with shape, height fields, sweeps, and what goes wrong in them."""

from polycnc.stock._cutting import Collision, CollisionKind, Cutting, Rows
from polycnc.stock._mesh import Mesh, mesh
from polycnc.stock._profile import Arc, Line, Profile, make_profile
from polycnc.stock._stock import Box, Stock
from polycnc.stock._tool import Tool, ToolKind

__all__ = [
    "Arc",
    "Box",
    "Collision",
    "CollisionKind",
    "Cutting",
    "Line",
    "Mesh",
    "Profile",
    "Rows",
    "Stock",
    "Tool",
    "ToolKind",
    "make_profile",
    "mesh",
]
