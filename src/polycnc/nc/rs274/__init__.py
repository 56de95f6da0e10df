"""RS274/NGC, the language of LinuxCNC: parameters, expressions, O-words."""

from polycnc.nc.rs274._functions import FUNCTIONS
from polycnc.nc.rs274._known_names import KNOWN_NAMES
from polycnc.nc.rs274._language import NgcLanguage
from polycnc.nc.rs274._source import sub_program_file

__all__ = ["FUNCTIONS", "KNOWN_NAMES", "NgcLanguage", "sub_program_file"]
