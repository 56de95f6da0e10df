"""The decorators of compiled functions, for the modules of the kernel."""

from polycnc.jit import allocating, compiled, entry

__all__ = ["allocating", "compiled", "entry"]
