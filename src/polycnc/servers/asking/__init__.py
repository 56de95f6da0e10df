"""Ask a machine that another process serves."""

from polycnc.servers.asking._asked import Asked

__all__ = ["Asked"]
