"""What is to be served, from flags and files: machines, doors, addresses, secrets; and what describes them."""

from polycnc.servers.setup._describe import describe_devices
from polycnc.servers.setup._file import load_serve_file
from polycnc.servers.setup._plan import Flags, Plan, plan_of

__all__ = ["Flags", "Plan", "describe_devices", "load_serve_file", "plan_of"]
