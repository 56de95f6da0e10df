"""Fleets: the machines of one file in several processes, with one page of figures."""

from polycnc.servers.fleets._fleet import Fleet, FleetError, this_command
from polycnc.servers.fleets._part import Part

__all__ = ["Fleet", "FleetError", "Part", "this_command"]
