"""The C text of the libraries: every function of the tables, all lengths known, headers that compile; the command."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from polycnc.controllers.library.clib import write_definitions, write_header, write_source
from polycnc.errors import UsageError
from polycnc.servers.calls import LIBRARIES, build_command, build_library, library_of, write_library
from support.command import polycnc

COUNTS = {"fanuc": 96, "imc": 53, "apci": 197}
FILES = ("fwlib32.h", "fwlib32.c", "fwlib32.def", "fwlib32_win32.def", "fwlib32.pas", "fwlib32.cs")
KINDS = sorted(LIBRARIES)
FEW = [each if each == "fanuc" else pytest.param(each, marks=pytest.mark.long) for each in KINDS]
CONSTANT = {
    "apci": 'txbf("axes.dat")',
    "fanuc": 'cnc_allclibhndl3("127.0.0.1", 8193, 1, 0) + cnc_download(1, "M2;", 3)',
    "imc": 'IMC_OpenUsePassword(0, 0, 0, "none")',
}
"""Calls with literals, which C++ takes for constant texts alone."""
WINDOWS = {"win32": "i686-w64-mingw32-gcc", "win64": "x86_64-w64-mingw32-gcc"}


@pytest.mark.parametrize("kind", KINDS)
def test_every_function_of_the_table_is_generated_or_left_out_with_a_reason(kind: str) -> None:
    library = library_of(kind)
    assert len(library.functions) == COUNTS[kind]
    names = {each.function.name for each in library.calls}
    assert names | set(library.left_out) == set(library.functions)
    assert not names & set(library.left_out)
    for text in (write_header(library), write_source(library, "7.5")):
        for name in (*library.functions, *library.aliases):
            assert re.search(rf"PC_CALL {name}\(", text), name
    exported = write_definitions(library).split("EXPORTS")[1].split()
    assert exported == sorted((*library.functions, *library.aliases))


def test_two_tables_have_two_hashes() -> None:
    assert len({library_of(kind).table_hash for kind in KINDS}) == len(KINDS)


@pytest.mark.parametrize(("kind", "packing"), [*((each, 0) for each in KINDS), ("fanuc", 4)])
@pytest.mark.parametrize(
    ("compiler", "language"), [("gcc", "c11"), ("g++", "c++17"), (WINDOWS["win32"], "c11")]
)
def test_the_header_compiles_without_a_warning(
    kind: str, packing: int, compiler: str, language: str, tmp_path: Path
) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"no C compiler {compiler} here")
    library = library_of(kind).packed(packing)
    assert library is not None
    write_library(library, tmp_path)
    source = tmp_path / ("client.cpp" if "+" in language else "client.c")
    calls = CONSTANT[kind]
    source.write_text(f'#include "{library_of(kind).name}.h"\nint main(void) {{ return {calls}; }}\n')
    command = [
        compiler,
        f"-std={language}",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-pedantic",
        "-fsyntax-only",
        str(source),
    ]
    assert subprocess.run(command, capture_output=True, text=True, check=False).stderr == ""


@pytest.mark.parametrize("kind", FEW)
@pytest.mark.parametrize("target", WINDOWS)
def test_the_windows_library_exports_plain_names(kind: str, target: str, tmp_path: Path) -> None:
    if shutil.which(WINDOWS[target]) is None:
        pytest.skip(f"no C compiler {WINDOWS[target]} here")
    library = library_of(kind)
    write_library(library, tmp_path)
    made = build_library(library, tmp_path, target)
    assert made.name == f"{library.name}.dll"
    assert made.stat().st_size < 200_000
    dump = WINDOWS[target].replace("gcc", "objdump")
    listed = subprocess.run([dump, "-p", made], capture_output=True, text=True, check=True).stdout
    names = re.findall(r"^\s*\[\s*\d+\] (?:\+base\[\s*\d+\]\s+\w+ )?([A-Za-z_]\w*)$", listed, re.MULTILINE)
    assert sorted(names) == sorted((*library.functions, *library.aliases))


def test_the_command_writes_the_source_alone(tmp_path: Path) -> None:
    said = polycnc("clib", "fanuc", "-o", "made", "--source-only", cwd=tmp_path).stdout
    assert said.split() == [f"made/{name}" for name in FILES]
    assert sorted(each.name for each in (tmp_path / "made").iterdir()) == sorted(FILES)


@pytest.mark.parametrize("name", ["fwlib32.h", "fwlib32.dll", "fwlib32.lib", "fwlib32.c"])
def test_files_of_the_maker_are_not_replaced(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(b"the maker's own")
    with pytest.raises(UsageError, match="not of polycnc clib"):
        write_library(library_of("fanuc"), tmp_path)
    assert [(each.name, each.read_bytes()) for each in tmp_path.iterdir()] == [(name, b"the maker's own")]


def test_the_command_replaces_no_file_of_the_maker(tmp_path: Path) -> None:
    (tmp_path / "fwlib32.dll").write_bytes(b"the maker's own")
    assert "not of polycnc clib" in polycnc("clib", "fanuc", cwd=tmp_path, status=2).stderr
    assert [each.name for each in tmp_path.iterdir()] == ["fwlib32.dll"]


def test_what_it_wrote_is_written_anew(tmp_path: Path) -> None:
    for _ in range(2):
        write_library(library_of("fanuc"), tmp_path)
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted(FILES)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("siemens",), "there is no C library of 'siemens'"),
        (("imc", "--packing", "4"), "IMCnet is not packed to 4 bytes"),
        (("fanuc", "--target", "amiga"), "there is no target 'amiga'"),
    ],
)
def test_what_there_is_not_is_refused(words: tuple[str, ...], told: str, tmp_path: Path) -> None:
    assert told in polycnc("clib", *words, cwd=tmp_path, status=2).stderr
    assert list(tmp_path.iterdir()) == []


def test_without_a_compiler_it_says_what_to_install_and_run(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    library = library_of("fanuc")
    write_library(library, tmp_path)
    with pytest.raises(UsageError) as refused:
        build_library(library, tmp_path, "win32")
    assert "i686-w64-mingw32-gcc, the compiler for win32, is not found" in str(refused.value)
    assert " ".join(build_command(library, "win32")) in (refused.value.hint or "")
