"""Commands about programs: what is executed, the directory in its old and its new form, selection, deletion."""

from __future__ import annotations

import re
import struct

from polycnc.cnc import ProgramEntry
from polycnc.controllers.fanuc.wire import Request, text
from polycnc.servers.focas._command import (
    ATTRIBUTE,
    DATA,
    LENGTH,
    PROTECTED,
    REJECTED,
    RefusedError,
    View,
    data_of,
    longs,
)
from polycnc.units import whole

_NO_SUCH_PROGRAM = 1


def program_numbers(view: View, request: Request) -> bytes:
    """Return the numbers of the program in execution and of its main program."""
    return longs(*view.control.execution.numbers)


def sequence_number(view: View, request: Request) -> bytes:
    """Return the sequence number that was executed last."""
    return longs(view.control.execution.sequence)


_MOST_TEXT = 1400


def executed_text(view: View, request: Request) -> bytes:
    """Return the line that is executed and the program from there on."""
    most = request.arguments[0]
    if not 0 < most <= 1 << 16:
        raise RefusedError(LENGTH)
    block = view.control.execution.block
    return longs(0 if block is None else block.line) + view.control.execution.text(min(most, _MOST_TEXT))


def program_name(view: View, request: Request) -> bytes:
    """Return number and name of the program in execution."""
    number = view.control.execution.numbers[0]
    return longs(number) + text(_file(number), 36)


def program_path(view: View, request: Request) -> bytes:
    """Return the path of the program in execution."""
    return text(_path(view.control.execution.numbers[0]), _PATH)


_ROW = 72


def directory(view: View, request: Request) -> bytes:
    """Return the programs from a number on: numbers, with comments, or with sizes as well."""
    first, most, kind, _ = request.arguments
    if kind not in (0, 1, 2) or most < 0:
        raise RefusedError(DATA)
    rows = [
        struct.pack(">II", each.number, each.characters if kind == 2 else 0)
        + text(each.comment if kind else "", 64)
        for each in view.control.programs.directory(max(first, 1))
    ]
    return b"".join(rows[: min(most, _MOST_TEXT // _ROW)])


def select(view: View, request: Request) -> bytes:
    """Select a program."""
    return _select(view, request.arguments[0], RefusedError(LENGTH, _NO_SUCH_PROGRAM))


def _select(view: View, number: int, missing: RefusedError) -> bytes:
    if number not in view.control.programs:
        raise missing
    view.control.select_program(number)
    return b""


def delete(view: View, request: Request) -> bytes:
    """Delete a program that is neither selected nor protected."""
    return _delete(view, request.arguments[0])


def _delete(view: View, number: int) -> bytes:
    control = view.control
    if number not in control.programs or number == control.selected:
        raise RefusedError(DATA)
    if control.transfer is not None or control.transfers_blocked or control.programs.background_edit:
        raise RefusedError(REJECTED)
    if control.programs.key_protects or control.programs.parameter_protects(number):
        raise RefusedError(PROTECTED)
    control.programs.delete(number)
    return b""


def start(view: View, request: Request) -> bytes:
    """Press cycle start."""
    view.control.cycle_start()
    return b""


# ---------------------------------------------------------------------- programs by path

_PATH = 256
_DRIVE = "CNC_MEM"
_FOLDER = f"//{_DRIVE}/USER/PATH1/"
_FOLDERS = {f"//{_DRIVE}/": ("USER",), f"//{_DRIVE}/USER/": ("PATH1",), _FOLDER: ()}
_FILE = re.compile(r"O(\d{1,4})")
_IS_FOLDER, _IS_FILE = 0, 1
_NO_DATE = (0,) * 6


def _file(number: int) -> str:
    return f"O{number}" if number else ""


def _path(number: int) -> str:
    return _FOLDER + _file(number) if number else ""


def _asked(request: Request) -> str:
    return data_of(request, _PATH).split(b"\0")[0].decode("latin-1")


def _number(path: str) -> int:
    """Return the number of the program that a path names: in the one folder that there is."""
    name = path.removeprefix(_FOLDER)
    found = _FILE.fullmatch(name)
    if found is None:
        raise RefusedError(DATA)
    return whole(found[1])


def _in_folder(view: View, path: str) -> list[str | ProgramEntry]:
    """Return what a folder holds: the names of folders, then programs."""
    path = path if path.endswith("/") else f"{path}/"
    if path not in _FOLDERS:
        raise RefusedError(DATA)
    programs = view.control.programs.memory.directory() if path == _FOLDER else ()
    return [*_FOLDERS[path], *sorted(programs, key=lambda each: each.name)]


def drives(view: View, request: Request) -> bytes:
    """Return the names of the drives."""
    return text(_DRIVE, 12)


def current_folder(view: View, request: Request) -> bytes:
    """Return the current folder of the foreground (1) or background (2)."""
    if request.arguments[0] not in (1, 2):
        raise RefusedError(ATTRIBUTE)
    return text(_FOLDER, _PATH)


def folder_counts(view: View, request: Request) -> bytes:
    """Return how many folders and files a folder has."""
    held = _in_folder(view, _asked(request))
    folders = sum(isinstance(each, str) for each in held)
    return longs(folders, len(held) - folders)


_ENTRY = 128


def folder(view: View, request: Request) -> bytes:
    """Return entries of a folder, each with kind, date, size, attributes, name and comment."""
    first, most, _, with_size = request.arguments
    if first < 0 or most < 0:
        raise RefusedError(DATA)
    held = _in_folder(view, _asked(request))[first : first + min(most, _MOST_TEXT // _ENTRY)]
    made = b""
    for each in held:
        if isinstance(each, str):
            kind, date, size, name, comment = _IS_FOLDER, _NO_DATE, 0, each, ""
        else:
            now = each.changed
            kind, date = _IS_FILE, (now.year, now.month, now.day, now.hour, now.minute, now.second)
            size, name, comment = each.size_bytes if with_size else 0, _file(int(each.name[1:])), each.comment
        head = struct.pack(">h6H6xII", kind, *date, size, 0)
        made += head + text(name, 36) + text(comment, 52) + bytes(12)
    return made


_FILE_KIND = 0


def add(view: View, request: Request) -> bytes:
    """Make an empty program; folders cannot be made."""
    number = _number(_asked(request))
    if request.arguments[0] != _FILE_KIND:
        raise RefusedError(REJECTED)
    control = view.control
    if not number or number in control.programs:
        raise RefusedError(DATA)
    if control.programs.key_protects or control.programs.parameter_protects(number):
        raise RefusedError(PROTECTED)
    control.programs.register(number, f"O{number:04d}\n")
    return b""


def remove(view: View, request: Request) -> bytes:
    """Delete the program of a path."""
    return _delete(view, _number(_asked(request)))


def select_main(view: View, request: Request) -> bytes:
    """Select the program of a path."""
    return _select(view, _number(_asked(request)), RefusedError(DATA))


def main_path(view: View, request: Request) -> bytes:
    """Return the path of the selected program."""
    return text(_path(view.control.selected), _PATH)


def lines(view: View, request: Request) -> bytes:
    """Return so many lines of a program from one on, counted from 0."""
    first, count = request.arguments[:2]
    number = _number(_asked(request))
    if number not in view.control.programs or first < 0 or count < 1:
        raise RefusedError(DATA)
    found = view.control.programs.read(number).split(b"\n")[first : first + count]
    return b"\n".join(found)[:_MOST_TEXT]
