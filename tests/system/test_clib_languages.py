"""Programs of other languages than C: a unit of Pascal, a class of C#, a module of Basic, a library loaded by name."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.apci.clib import MCUG3
from polycnc.controllers.library.clib import CLibrary, Way, write_basic
from polycnc.servers.calls import library_of
from polycnc.servers.process import Machinery
from support.c_library import Door, built
from support.command import environment
from support.facade_programs import SYSTEM, facade_says
from support.visual_basic import DotNet, declarations, statements

EXAMPLES = Path(__file__).parents[2] / "examples"
KINDS = ("apci", "fanuc", "imc")


def _run(*command: str | Path, cwd: Path | None = None, at: dict[str, str] | None = None) -> str:
    ran = subprocess.run(
        command,
        cwd=cwd,
        env=environment(**(at or {})),
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


def _need(compiler: str, package: str) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"no compiler {compiler} here (Debian: apt-get install {package})")


@pytest.fixture(scope="module")
def doors(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Door]]:
    files = {"apci": SYSTEM, "fanuc": None, "imc": None}
    made = {kind: Door((kind, Machinery(file=file)), running=True) for kind, file in files.items()}
    yield made
    for door in made.values():
        door.close()


def _at(door: Door, folder: Path) -> dict[str, str]:
    return {"POLYCNC_CALLS": door.place, "LD_LIBRARY_PATH": str(folder)}


def _pascal(source: Path, folder: Path, to: Path) -> Path:
    _run("fpc", "-vw0", f"-Fu{folder}", f"-Fl{folder}", f"-FE{to}", f"-FU{to}", source, cwd=to)
    return to / source.stem


@pytest.mark.covers("apci.lib.delphi")
def test_a_program_of_pascal_moves_an_axis(tmp_path: Path, doors: dict[str, Door]) -> None:
    _need("fpc", "fp-compiler")
    folder = built("apci")
    program = _pascal(EXAMPLES / "pascal" / "apci_jog.pas", folder, tmp_path)
    assert _run(program, at=_at(doors["apci"], folder)) == "init 0, board 4, 3 axes\nat 12.500\n"


@pytest.mark.long
def test_a_program_of_csharp_says_what_one_of_c_says(tmp_path: Path, doors: dict[str, Door]) -> None:
    _need("mcs", "mono-mcs")
    folder, made = built("fanuc"), tmp_path / "client.exe"
    _run("mcs", f"-out:{made}", EXAMPLES / "csharp" / "FanucMacro.cs", folder / "fwlib32.cs")
    assert _run("mono", made, at=_at(doors["fanuc"], folder)) == facade_says()


def test_a_program_that_loads_the_library_by_name(tmp_path: Path, doors: dict[str, Door]) -> None:
    folder, made = built("imc"), tmp_path / "client"
    source = EXAMPLES / "c" / "imc_by_name.c"
    _run("gcc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-I", folder, "-o", made, source, "-ldl")
    assert _run(made, at=_at(doors["imc"], folder)) == "found 1\nopen 0\naxis 1 0: 0\nclose 0\n"
    assert "IMCnet" not in subprocess.run(["ldd", made], capture_output=True, text=True, check=True).stdout


def _sized(library: CLibrary) -> dict[str, Any]:
    return {
        name: cls
        for name, cls in library.header.classes.items()
        if not any(each.held for each in cls._table_.elements.values())
    }


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_records_of_pascal_are_as_large_as_in_c(kind: str, tmp_path: Path) -> None:
    _need("fpc", "fp-compiler")
    library, folder = library_of(kind), built(kind)
    names = [f"{name}_" if name.lower() in ("as",) else name for name in _sized(library)]
    lines = "\n".join(f"  WriteLn(SizeOf({name}));" for name in names)
    (tmp_path / "sizes.pas").write_text(f"program sizes;\nuses {library.name};\nbegin\n{lines}\nend.\n")
    said = _run(_pascal(tmp_path / "sizes.pas", folder, tmp_path), at={"LD_LIBRARY_PATH": str(folder)})
    assert [int(each) for each in said.split()] == [ctypes.sizeof(cls) for cls in _sized(library).values()]


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_structures_of_csharp_lie_as_in_c(kind: str, tmp_path: Path) -> None:
    _need("mcs", "mono-mcs")
    library, folder, made = library_of(kind), built(kind), tmp_path / "sizes.exe"
    place = library.name.capitalize()
    rows = [f"Console.WriteLine(Marshal.SizeOf(typeof({place}.{name})));" for name in _sized(library)]
    (tmp_path / "sizes.cs").write_text(
        "using System; using System.Runtime.InteropServices;\n"
        f"static class P {{ static void Main() {{ {' '.join(rows)} }} }}\n"
    )
    _run("mcs", f"-out:{made}", tmp_path / "sizes.cs", folder / f"{library.name}.cs")
    sizes = [int(each) for each in _run("mono", made).split()]
    assert sizes == [ctypes.sizeof(cls) for cls in _sized(library).values()]


NUMBERS_OF_BASIC = {"Byte": 1, "Integer": 2, "Long": 4, "Double": 8}
_MEMBER = re.compile(r"    (\w+)(?:\(0 To (\d+)\))? As (?:String \* (\d+)|(\w+))")
_DECLARED = re.compile(
    r'Public Declare (Sub|Function) (\w+) Lib "mcug3\.dll" \((.*)\)(?: As (\w+))?$', re.MULTILINE
)
_ARGUMENT = re.compile(r"(ByVal|ByRef) \w+ As (\w+)")


def _size_in_basic(name: str, types: dict[str, str]) -> int:
    """Return what Visual Basic gives a type: elements at multiples of their size, at most of 4."""
    at, widest = 0, 1
    for _, last, text, kind in _MEMBER.findall(types[name]):
        count = int(last) + 1 if last else 1
        if text:
            at += int(text)
            continue
        size = NUMBERS_OF_BASIC.get(kind) or _size_in_basic(kind, types)
        align = min(4, size) if kind in NUMBERS_OF_BASIC else 4
        widest = max(widest, align)
        at = -(-at // align) * align + count * size
    return -(-at // widest) * widest


@pytest.mark.covers("apci.lib.vb")
def test_the_module_of_basic_declares_every_function_and_type_as_c_has_it() -> None:
    text = write_basic(MCUG3).replace("\r\n", "\n")
    declared = {found[1]: found for found in _DECLARED.findall(text)}
    assert set(declared) == {*MCUG3.functions, *MCUG3.aliases} - {"rdlsM"}  # which is rdlsm
    by_name = {each.function.name: each for each in MCUG3.calls}
    for name, call in by_name.items():
        kind, _, given, result = declared[name]
        assert (kind == "Sub") == (call.function.result == "void"), name
        assert result == {"void": "", "double": "Double"}.get(call.function.result, "Long"), name
        arguments = _ARGUMENT.findall(given)
        slots = [slot for slot in call.slots if not slot.holder]
        assert len(arguments) == len(slots), name
        for (how, kind), slot in zip(arguments, slots, strict=True):
            by_value = slot.way in (Way.VALUE, Way.TEXT)
            assert (how == "ByVal") == by_value, f"{name}: {slot.argument.name}"
            if slot.way in (Way.VALUE, Way.NUMBERS):
                assert NUMBERS_OF_BASIC[kind] == slot.width, f"{name}: {slot.argument.name}"
    types = dict(re.findall(r"Public Type (\w+)\n(.*?)End Type", text, re.DOTALL))
    for name, cls in _sized(MCUG3).items():
        assert _size_in_basic("AS_" if name == "AS" else name, types) == ctypes.sizeof(cls), name
    assert "Public Const MAXAXIS As Long = 18" in text


def _basic(folder: Path) -> str:
    shutil.copy(
        built("apci") / "libmcug3.so", folder / "mcug3.dll"
    )  # found by the name that the module gives
    return declarations((built("apci") / "mcug3.bas").read_text("ascii"))


@pytest.mark.covers("apci.lib.vb")
def test_a_program_of_basic_moves_an_axis(tmp_path: Path, doors: dict[str, Door]) -> None:
    program = (EXAMPLES / "basic" / "apci_jog.bas").read_text("utf-8")
    sources = {"mcug3.vb": _basic(tmp_path), "apci_jog.vb": statements(program)}
    assert (
        DotNet().says(sources, tmp_path, _at(doors["apci"], tmp_path))
        == "init 0, board 4, 3 axes\nat 12.500\n"
    )


@pytest.mark.long
@pytest.mark.covers("apci.lib.vb")
def test_types_of_basic_are_as_large_as_in_c(tmp_path: Path) -> None:
    sized = {"AS_" if name == "AS" else name: ctypes.sizeof(cls) for name, cls in _sized(MCUG3).items()}
    rows = "\n".join(f"Debug.Print Marshal.SizeOf(GetType({name}))" for name in sized)
    sources = {
        "mcug3.vb": _basic(tmp_path),
        "sizes.vb": statements(f"Sub Main()\n{rows}\nEnd Sub".replace("Debug", "    Debug")),
    }
    said = DotNet().says(sources, tmp_path, {})
    assert [int(each) for each in said.split()] == list(sized.values())
