"""The NCS coupling: what part programs ask of other channels and controls by MCODS, MCOPS and MMC."""

from polycnc.controllers.bosch.ncs._blocks import find_block
from polycnc.controllers.bosch.ncs._clients import Client, ClientError, Clients, Mmc, MmcResult, Sent
from polycnc.controllers.bosch.ncs._codes import NcsCode, NcsError
from polycnc.controllers.bosch.ncs._coupling import MAGIC, Control, Coupling, NcsServer
from polycnc.controllers.bosch.ncs._data_services import DATA_SERVICES, NOT_IN_TELEGRAM, OVERVIEW, DataService
from polycnc.controllers.bosch.ncs._image import (
    Axis,
    Channel,
    Coordinate,
    Drive,
    Image,
    Ipo,
    Mode,
    Sav,
    Spindle,
    SpindleMotion,
    ToolCompensation,
    Unit,
    Wait,
)
from polycnc.controllers.bosch.ncs._partner import Partner, Station
from polycnc.controllers.bosch.ncs._process_services import (
    AUTOMATIC,
    MODES,
    PROCESS_SERVICES,
    WHOLE_SYSTEM,
    ProcessService,
    ProcessServices,
    Selection,
)

__all__ = [
    "AUTOMATIC",
    "DATA_SERVICES",
    "MAGIC",
    "MODES",
    "NOT_IN_TELEGRAM",
    "OVERVIEW",
    "PROCESS_SERVICES",
    "WHOLE_SYSTEM",
    "Axis",
    "Channel",
    "Client",
    "ClientError",
    "Clients",
    "Control",
    "Coordinate",
    "Coupling",
    "DataService",
    "Drive",
    "Image",
    "Ipo",
    "Mmc",
    "MmcResult",
    "Mode",
    "NcsCode",
    "NcsError",
    "NcsServer",
    "Partner",
    "ProcessService",
    "ProcessServices",
    "Sav",
    "Selection",
    "Sent",
    "Spindle",
    "SpindleMotion",
    "Station",
    "ToolCompensation",
    "Unit",
    "Wait",
    "find_block",
]
