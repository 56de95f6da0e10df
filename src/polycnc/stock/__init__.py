"""What a moving tool leaves of a body: tools with shape, height fields, sweeps, and what goes wrong in them."""

from polycnc.stock._auto import NoStockError, around
from polycnc.stock._contacts import Contact, ContactKind, Idle
from polycnc.stock._course import Course
from polycnc.stock._cutting import Cutting
from polycnc.stock._engagement import Engagement
from polycnc.stock._fixtures import check_fixtures, fixtures_of, solid_fixtures_of
from polycnc.stock._form import Body, Form, file_of
from polycnc.stock._insert import Insert, InsertKind, grooving_tool, iso_insert, threading_tool
from polycnc.stock._mesh import Mesh
from polycnc.stock._mesh_files import MESH_FORMATS
from polycnc.stock._profile import Arc, Line, Profile, make_profile
from polycnc.stock._removing import Removing
from polycnc.stock._rows import Rows
from polycnc.stock._solid import check_closed, read_stl
from polycnc.stock._stock import Box, Stock
from polycnc.stock._stock_text import stock_of_remarks
from polycnc.stock._tally import Tally
from polycnc.stock._target import TOLERANCE_MM, Target, TargetComparison
from polycnc.stock._tool import Tool, ToolKind
from polycnc.stock._tool_text import CHAMFER_DEG, POINT_DEG, tool_number, tool_of_remark
from polycnc.stock._turned import Turned
from polycnc.stock._turned_cutting import TurnedCutting
from polycnc.stock._turned_solid import TurnedTarget, turned_fixtures_of
from polycnc.stock._turning import TurningCutting
from polycnc.stock._voxels import Voxels
from polycnc.stock._ways import runs

__all__ = [
    "CHAMFER_DEG",
    "MESH_FORMATS",
    "POINT_DEG",
    "TOLERANCE_MM",
    "Arc",
    "Body",
    "Box",
    "Contact",
    "ContactKind",
    "Course",
    "Cutting",
    "Engagement",
    "Form",
    "Idle",
    "Insert",
    "InsertKind",
    "Line",
    "Mesh",
    "NoStockError",
    "Profile",
    "Removing",
    "Rows",
    "Stock",
    "Tally",
    "Target",
    "TargetComparison",
    "Tool",
    "ToolKind",
    "Turned",
    "TurnedCutting",
    "TurnedTarget",
    "TurningCutting",
    "Voxels",
    "around",
    "check_closed",
    "check_fixtures",
    "file_of",
    "fixtures_of",
    "grooving_tool",
    "iso_insert",
    "make_profile",
    "read_stl",
    "runs",
    "solid_fixtures_of",
    "stock_of_remarks",
    "threading_tool",
    "tool_number",
    "tool_of_remark",
    "turned_fixtures_of",
]
