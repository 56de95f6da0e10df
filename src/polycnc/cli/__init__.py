"""The ``polycnc`` command: thin commands over the library."""

from polycnc.cli._app import main

__all__ = ["main"]
