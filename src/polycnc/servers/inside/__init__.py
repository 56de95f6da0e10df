"""Machines in the process of a C program that is linked to a library of `polycnc clib --in-process`."""

from polycnc.servers.inside._inside import inside

__all__ = ["inside"]
