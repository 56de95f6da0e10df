"""The decorators of compiled functions, for the modules of the kernel."""

from polycnc.jit import allocating, call_at, compiled, detached, entry

__all__ = ["allocating", "call_at", "compiled", "detached", "entry"]
