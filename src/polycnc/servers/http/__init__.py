"""HTTP: REST, a stream of statuses, and a page to operate machines. Needs `polycnc[serve]`."""

from polycnc.servers.http._door import HttpDoor

__all__ = ["HttpDoor"]
