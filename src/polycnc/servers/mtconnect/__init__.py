"""MTConnect: an agent of its own for served machines, and the description of a machine for a foreign one."""

from typing import TYPE_CHECKING

from polycnc.on_demand import names_on_demand
from polycnc.servers.mtconnect._rows import CONDITIONS, ROWS, USUAL_VERSION, VERSIONS, Row, Version

if TYPE_CHECKING:
    from polycnc.servers.mtconnect._agent import Agent, Answer, StreamAsked
    from polycnc.servers.mtconnect._device import DeviceModel, Item, device_model, model_of, value_text
    from polycnc.servers.mtconnect._documents import Header, asset_text, devices_document
    from polycnc.servers.mtconnect._door import MTConnectDoor
    from polycnc.servers.mtconnect._errors import Code
    from polycnc.servers.mtconnect._observations import Buffer, Observation
    from polycnc.servers.mtconnect._recorder import Change, Looked, Recorder, time_text
    from polycnc.servers.mtconnect._xpath import PathError, choose, tree_of

__all__ = [
    "CONDITIONS",
    "ROWS",
    "USUAL_VERSION",
    "VERSIONS",
    "Agent",
    "Answer",
    "Buffer",
    "Change",
    "Code",
    "DeviceModel",
    "Header",
    "Item",
    "Looked",
    "MTConnectDoor",
    "Observation",
    "PathError",
    "Recorder",
    "Row",
    "StreamAsked",
    "Version",
    "asset_text",
    "choose",
    "device_model",
    "devices_document",
    "model_of",
    "time_text",
    "tree_of",
    "value_text",
]

__getattr__ = names_on_demand(__name__)
