"""A port on which an application answers HTTP, in the event loop of the machines. Needs `polycnc[serve]`."""

from polycnc.servers.asgi._connection import Refused, refused_in_text
from polycnc.servers.asgi._door import AsgiDoor
from polycnc.servers.asgi._repeated import Again, Said, again_of, answers_again

__all__ = ["Again", "AsgiDoor", "Refused", "Said", "again_of", "answers_again", "refused_in_text"]
