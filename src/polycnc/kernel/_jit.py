"""The decorators of compiled functions, for the modules of the kernel."""

from polycnc.jit import allocating, compiled, entry, is_cold

__all__ = ["allocating", "compiled", "entry", "is_cold"]
