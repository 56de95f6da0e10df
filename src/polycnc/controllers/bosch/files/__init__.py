"""The files of a CPL program on a real directory, the root of the control (Manual 003, chapter 6)."""

from polycnc.controllers.bosch.files._commands import FileCommands
from polycnc.controllers.bosch.files._directory import STORE, Directory, is_file
from polycnc.controllers.bosch.files._owner import RootOwner
from polycnc.controllers.bosch.files._print import Output, as_output
from polycnc.controllers.bosch.files._selected_block import CALL, SelectedBlock
from polycnc.controllers.bosch.files._stored import StoredFile

__all__ = [
    "CALL",
    "STORE",
    "Directory",
    "FileCommands",
    "Output",
    "RootOwner",
    "SelectedBlock",
    "StoredFile",
    "as_output",
    "is_file",
]
