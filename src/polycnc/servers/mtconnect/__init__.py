"""MTConnect: an agent of its own for served machines, and the description of a machine for a foreign one."""

from polycnc.servers.mtconnect._agent import Agent, Answer, StreamAsked
from polycnc.servers.mtconnect._device import DeviceModel, Item, asset_id, device_model
from polycnc.servers.mtconnect._documents import Header, asset_text, devices_document
from polycnc.servers.mtconnect._errors import AgentError, Code
from polycnc.servers.mtconnect._observations import Buffer, Observation
from polycnc.servers.mtconnect._query import Asked, asked_of
from polycnc.servers.mtconnect._recorder import Change, Looked, Recorder
from polycnc.servers.mtconnect._rows import CONDITIONS, ROWS, VERSIONS, ConditionRow, Row, Version
from polycnc.servers.mtconnect._xpath import PathError, choose, tree_of

__all__ = [
    "CONDITIONS",
    "ROWS",
    "VERSIONS",
    "Agent",
    "AgentError",
    "Answer",
    "Asked",
    "Buffer",
    "Change",
    "Code",
    "ConditionRow",
    "DeviceModel",
    "Header",
    "Item",
    "Looked",
    "Observation",
    "PathError",
    "Recorder",
    "Row",
    "StreamAsked",
    "Version",
    "asked_of",
    "asset_id",
    "asset_text",
    "choose",
    "device_model",
    "devices_document",
    "tree_of",
]
