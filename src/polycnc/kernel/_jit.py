"""The decorators of compiled functions, for the modules of the kernel."""

from polycnc.jit import allocating, apart, call_at, compiled, detached, entry

__all__ = ["allocating", "apart", "call_at", "compiled", "detached", "entry"]
