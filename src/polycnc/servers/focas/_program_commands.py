"""Commands about programs: what is executed, the directory in its old and its new form, selection, deletion."""

from __future__ import annotations

import re

from polycnc.cnc import ProgramEntry
from polycnc.controllers.fanuc import Objection, delete_program, search_program
from polycnc.controllers.fanuc.wire import Content, Request, text
from polycnc.servers.focas._command import (
    ATTRIBUTE,
    BUSY,
    DATA,
    LENGTH,
    PROTECTED,
    REJECTED,
    RefusedError,
    View,
    answers,
    given,
    moment,
)
from polycnc.units import whole

_NO_SUCH_PROGRAM = 1
_OBJECTIONS = {Objection.BUSY: BUSY, Objection.MISSING: DATA, Objection.PROTECTED: PROTECTED}


@answers(0x1C)
def program_numbers(view: View, request: Request) -> Content:
    """Return the numbers of the program in execution and of its main program."""
    running, main = view.control.execution.numbers
    return {"running": running, "main": main}


@answers(0x1D)
def sequence_number(view: View, request: Request) -> Content:
    """Return the sequence number that was executed last."""
    return {"sequence": view.control.execution.sequence}


_MOST_TEXT = 1400


@answers(0x35)
def block_count(view: View, request: Request) -> Content:
    """Return how many blocks have been executed since the program began."""
    return {"blocks": view.control.execution.count}


@answers(0x20)
def executed_text(view: View, request: Request) -> Content:
    """Return the line that is executed and the program from there on."""
    most = request.arguments[0]
    if not 0 < most <= 1 << 16:
        raise RefusedError(LENGTH)
    block = view.control.execution.block
    text = view.control.execution.text(min(most, _MOST_TEXT))
    return {"block": 0 if block is None else block.line, "text": text}


@answers(0xCF)
def program_name(view: View, request: Request) -> Content:
    """Return number and name of the program in execution."""
    number = view.control.execution.numbers[0]
    return {"program": number, "name": _file(number)}


@answers(0xFC)
def program_path(view: View, request: Request) -> Content:
    """Return the path of the program in execution."""
    return {"path": text(_path(view.control.execution.numbers[0]), _PATH)}


_ROW = 72


@answers(0x06)
def directory(view: View, request: Request) -> Content:
    """Return the programs from a number on: numbers, with comments, or with sizes as well."""
    first, most, kind, _ = request.arguments
    if kind not in (0, 1, 2) or most < 0:
        raise RefusedError(DATA)
    rows = [
        {
            "program": each.number,
            "size": each.characters if kind == 2 else 0,
            "comment": each.comment if kind else "",
        }
        for each in view.control.programs.directory(max(first, 1))
    ]
    return rows[: min(most, _MOST_TEXT // _ROW)]


@answers(0x03, writes=True)
def select(view: View, request: Request) -> Content:
    """Select a program in MEM and EDIT, in other modes only look for it."""
    _object(
        search_program(view.control, request.arguments[0]), missing=RefusedError(LENGTH, _NO_SUCH_PROGRAM)
    )
    return None


@answers(0x05, writes=True)
def delete(view: View, request: Request) -> Content:
    """Delete a program that is neither selected nor protected."""
    _object(delete_program(view.control, request.arguments[0]))
    return None


def _object(objection: Objection | None, missing: RefusedError | None = None) -> None:
    if objection is Objection.MISSING and missing is not None:
        raise missing
    if objection is not None:
        raise RefusedError(_OBJECTIONS[objection])


@answers(0x01, writes=True)
def start(view: View, request: Request) -> Content:
    """Press cycle start."""
    view.control.cycle_start()
    return None


# ---------------------------------------------------------------------- programs by path

_PATH = 256
_DRIVE = "CNC_MEM"
_FOLDER = f"//{_DRIVE}/USER/PATH1/"
_FOLDERS = {f"//{_DRIVE}/": ("USER",), f"//{_DRIVE}/USER/": ("PATH1",), _FOLDER: ()}
_FILE = re.compile(r"O(\d{1,4})")
_IS_FOLDER, _IS_FILE = 0, 1
_NO_DATE = ("year", "month", "day", "hour", "minute", "second")


def _file(number: int) -> str:
    return f"O{number}" if number else ""


def _path(number: int) -> str:
    return _FOLDER + _file(number) if number else ""


def _asked(request: Request) -> str:
    (path,) = given(request).values()
    return str(path.split(b"\0")[0], "latin-1")


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


@answers(0xAE)
def drives(view: View, request: Request) -> Content:
    """Return the names of the drives."""
    return [{"drive": _DRIVE}]


@answers(0xB0)
def current_folder(view: View, request: Request) -> Content:
    """Return the current folder of the foreground (1) or background (2)."""
    if request.arguments[0] not in (1, 2):
        raise RefusedError(ATTRIBUTE)
    return {"folder": text(_FOLDER, _PATH)}


@answers(0xB4)
def folder_counts(view: View, request: Request) -> Content:
    """Return how many folders and files a folder has."""
    held = _in_folder(view, _asked(request))
    folders = sum(isinstance(each, str) for each in held)
    return {"folders": folders, "files": len(held) - folders}


_ENTRY = 128


@answers(0xB3)
def folder(view: View, request: Request) -> Content:
    """Return entries of a folder, each with kind, date, size, attributes, name and comment."""
    first, most, _, with_size = request.arguments
    if first < 0 or most < 0:
        raise RefusedError(DATA)
    held = _in_folder(view, _asked(request))[first : first + min(most, _MOST_TEXT // _ENTRY)]
    made = []
    for each in held:
        if isinstance(each, str):
            entry = dict.fromkeys(_NO_DATE, 0) | {"kind": _IS_FOLDER, "size": 0, "name": each, "comment": ""}
        else:
            size, name = each.size_bytes if with_size else 0, _file(int(each.name[1:]))
            entry = moment(each.changed) | {
                "kind": _IS_FILE,
                "size": size,
                "name": name,
                "comment": each.comment,
            }
        made.append(entry | {"attributes": 0})
    return made


_FILE_KIND = 0


@answers(0xB5, writes=True)
def add(view: View, request: Request) -> Content:
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
    return None


@answers(0xB6, writes=True)
def remove(view: View, request: Request) -> Content:
    """Delete the program of a path."""
    _object(delete_program(view.control, _number(_asked(request))))
    return None


@answers(0xBA, writes=True)
def select_main(view: View, request: Request) -> Content:
    """Select the program of a path."""
    number = _number(_asked(request))
    if number not in view.control.programs:
        raise RefusedError(DATA)
    view.control.select_program(number)
    return None


@answers(0xB9)
def main_path(view: View, request: Request) -> Content:
    """Return the path of the selected program."""
    return {"path": text(_path(view.control.programs.selected), _PATH)}


@answers(0xF0)
def lines(view: View, request: Request) -> Content:
    """Return so many lines of a program from one on, counted from 0."""
    first, count = request.arguments[:2]
    number = _number(_asked(request))
    if number not in view.control.programs or first < 0 or count < 1:
        raise RefusedError(DATA)
    found = view.control.programs.read(number).split(b"\n")[first : first + count]
    return {"text": b"\n".join(found)[:_MOST_TEXT]}
