"""OPC UA: the interface of OPC 40502 and the monitoring and production view of OPC 40501-1."""

from polycnc.servers.opcua._cnc import TYPES as CNC_TYPES
from polycnc.servers.opcua._door import OpcuaDoor
from polycnc.servers.opcua._machine_tool import TYPES as MACHINE_TOOL_TYPES

__all__ = ["CNC_TYPES", "MACHINE_TOOL_TYPES", "OpcuaDoor"]
