"""What is to be served, from flags and files: machines, doors, addresses, secrets; and what describes them."""

from typing import TYPE_CHECKING

from polycnc.on_demand import names_on_demand
from polycnc.servers.setup._file import load_serve_file
from polycnc.servers.setup._plan import Flags, Plan, plan_of

if TYPE_CHECKING:
    from polycnc.servers.setup._describe import describe_devices

__all__ = ["Flags", "Plan", "describe_devices", "load_serve_file", "plan_of"]

__getattr__ = names_on_demand(__name__)
