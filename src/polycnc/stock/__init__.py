"""What a moving tool leaves of a body: tools with shape, height fields, sweeps, and what goes wrong in them."""

from polycnc.stock._course import Course
from polycnc.stock._cutting import Contact, ContactKind, Cutting, Rows
from polycnc.stock._form import Form, NoStockError, around
from polycnc.stock._mesh import Mesh
from polycnc.stock._mesh_files import MESH_FORMATS
from polycnc.stock._profile import Arc, Line, Profile, make_profile
from polycnc.stock._solid import read_stl
from polycnc.stock._stock import Box, Stock
from polycnc.stock._tool import Tool, ToolKind
from polycnc.stock._tool_text import tool_number, tool_of_remark

__all__ = [
    "MESH_FORMATS",
    "Arc",
    "Box",
    "Contact",
    "ContactKind",
    "Course",
    "Cutting",
    "Form",
    "Line",
    "Mesh",
    "NoStockError",
    "Profile",
    "Rows",
    "Stock",
    "Tool",
    "ToolKind",
    "around",
    "make_profile",
    "read_stl",
    "tool_number",
    "tool_of_remark",
]
