"""A port on which an application answers HTTP, in the event loop of the machines. Needs `polycnc[serve]`."""

from polycnc.servers.asgi._connection import Refused, refused_in_text
from polycnc.servers.asgi._door import AsgiDoor

__all__ = ["AsgiDoor", "Refused", "refused_in_text"]
