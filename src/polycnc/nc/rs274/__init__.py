"""RS274/NGC, the language of LinuxCNC: parameters, expressions, O-words."""

from polycnc.nc.rs274._language import NgcLanguage

__all__ = ["NgcLanguage"]
