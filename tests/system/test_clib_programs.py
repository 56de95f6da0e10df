"""The C programs of examples/c: linked, run on this system, and as Windows programs, with the same lines everywhere."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path

import pytest

from polycnc.cli._calls import calls_command
from polycnc.errors import UsageError
from polycnc.servers.calls import build_library, library_of, missing_of, write_library
from polycnc.servers.process import Machinery
from support.c_library import Door, built
from support.command import COMMAND, environment
from support.facade_programs import C_PROGRAMS, COLLECTED, EXAMPLES, facade_says

WARNINGS = ("-Wall", "-Wextra", "-Werror", "-pedantic")
WINDOWS = {"win64": "x86_64-w64-mingw32-gcc", "win32": "i686-w64-mingw32-gcc"}
ROOTS_OF_32 = ("/usr/lib/i386-linux-gnu/wine", "/usr/lib/wine/i386-windows", "/usr/lib/wine/wine")
REFERENCE = "fanuc_macro"


def _kind(name: str) -> str:
    return name.partition("_")[0]


def _linked(name: str, to: Path) -> Path:
    kind, made = _kind(name), to / name
    folder = built(kind)
    subprocess.run(
        ["gcc", "-std=c11", *WARNINGS, "-I", folder, "-o", made, EXAMPLES / "c" / f"{name}.c", "-L", folder,
         f"-l{library_of(kind).name}", f"-Wl,-rpath,{folder}"], check=True,
    )  # fmt: skip
    return made


def _run(place: str, *command: str | Path, given: str = "") -> str:
    ran = subprocess.run(
        command,
        env=environment(POLYCNC_CALLS=place, WINEDEBUG="-all"),
        input=given,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    return ran.stdout


def _said(name: str, *command: str | Path) -> str:
    """Run a program against a machine of its own."""
    wanted = C_PROGRAMS[name]
    door = Door((_kind(name), wanted.machinery), running=True)
    try:
        return _run(door.place, *command, given=wanted.given)
    finally:
        door.close()


FEW = [
    pytest.param(name, marks=pytest.mark.long) if name.endswith(("gantry", "line_shaft")) else name
    for name in C_PROGRAMS
]
"""Those that move for seconds are long."""


@pytest.mark.covers("apci.lib.c")
@pytest.mark.parametrize("name", FEW)
def test_a_program_links_and_says_what_it_has_to(name: str, tmp_path: Path) -> None:
    assert _said(name, _linked(name, tmp_path)) == C_PROGRAMS[name].expected


def test_a_program_against_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, trace = _linked(REFERENCE, tmp_path), tmp_path / "calls.jsonl"
    process = subprocess.Popen(
        [*COMMAND, "calls", "fanuc", "--port", "0", "--trace", trace],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment(PYTHONUNBUFFERED="1"),
    )  # fmt: skip
    assert process.stdout is not None
    place = process.stdout.readline().partition(" ")[2].strip()
    assert _run(place, program) == facade_says()
    process.terminate()
    _, error = process.communicate(timeout=60)
    assert (process.returncode, error) == (143, "")
    lines = trace.read_text().splitlines()
    assert len(lines) == 7
    calls_command("fanuc", replay=trace)
    assert capsys.readouterr().out == _shown("replayed")
    shown = json.loads(_shown("traced"))
    assert {**json.loads(lines[1]), "time_s": shown["time_s"]} == shown


COLLECTORS = {
    "fanuc": ("open {}", -16, -16, "free 0\n"),
    "apci": ("init {}", -4, 31, ""),
    "imc": ("open {}", 3, 5, "close 0\n"),
}
"""How each says that it opens, what it is told when it has lost its machine and when nobody is there, and its end."""


@pytest.mark.parametrize("kind", COLLECTORS)
def test_a_collector_opens_anew_what_it_has_lost(kind: str, tmp_path: Path) -> None:
    opens, lost, nobody, end = COLLECTORS[kind]
    made, told = _linked(f"{kind}_collector", tmp_path), COLLECTED[kind]
    machinery = Machinery(axes=2) if kind == "fanuc" else C_PROGRAMS[f"{kind}_collector"].machinery
    first = Door((kind, machinery))
    port = int(first.place.rpartition(":")[2])
    with subprocess.Popen(
        [made, "127.0.0.1", str(port)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=environment(POLYCNC_CALLS=first.place),
    ) as program:
        assert program.stdin is not None
        assert program.stdout is not None

        def ask(lines: int) -> list[str]:
            assert program.stdin is not None
            assert program.stdout is not None
            program.stdin.write("go\n")
            program.stdin.flush()
            return [program.stdout.readline().rstrip() for _ in range(lines)]

        assert ask(2) == [opens.format(0), f"1: {told}"]
        assert ask(1) == [f"2: {told}"]
        first.close()
        assert ask(1) == [f"3: lost, {lost}"]
        assert ask(1) == [opens.format(nobody)]
        second = Door((kind, machinery), port=port)
        try:
            assert ask(2) == [opens.format(0), f"4: {told}"]
            program.stdin.close()
            assert program.stdout.read() == end
            assert program.wait(20) == 0
        finally:
            second.close()


def _shown(title: str) -> str:
    """Return what the tutorial shows under a title."""
    text = (EXAMPLES.parent / "docs" / "tutorials" / "your-old-program.md").read_text("utf-8")
    found = re.search(rf'^```\w+ title="{title}"\n(.*?)^```$', text, re.MULTILINE | re.DOTALL)
    assert found is not None
    return found[1]


def test_the_tutorial_shows_the_program_and_what_it_prints() -> None:
    assert _shown("program") == (EXAMPLES / "c" / "fanuc_macro.c").read_text("utf-8")
    assert _shown("output") == (EXAMPLES / "c" / "fanuc_macro.txt").read_text("utf-8") == facade_says()


def test_the_script_for_windows_tries_the_same_program() -> None:
    script = EXAMPLES / "c" / "try_on_windows.ps1"
    assert "examples/c/try_on_windows.ps1 win32" in (EXAMPLES.parent / "README.md").read_text("utf-8")
    text = script.read_text("utf-8")
    assert {f"{REFERENCE}.c", f"{REFERENCE}.txt"} <= set(re.findall(rf"{REFERENCE}\.\w+", text))
    for target, compiler in WINDOWS.items():
        assert f'{target} = "{compiler}"' in text
        if sys.platform == "win32" and shutil.which(compiler):
            ran = ["powershell", "-ExecutionPolicy", "Bypass", "-File", str(script), target]
            assert subprocess.run(ran, timeout=300, check=False).returncode == 0


@pytest.fixture(scope="module")
def windows_libraries(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, str], Path]:
    @cache
    def build(kind: str, target: str) -> Path:
        folder = tmp_path_factory.mktemp(f"{kind}_{target}")
        write_library(library_of(kind), folder)
        build_library(library_of(kind), folder, target)
        return folder

    return build


@pytest.mark.long
@pytest.mark.parametrize("target", WINDOWS)
@pytest.mark.parametrize("name", C_PROGRAMS)
def test_the_same_program_as_a_windows_one(
    name: str, target: str, windows_libraries: Callable[[str, str], Path]
) -> None:
    if shutil.which(WINDOWS[target]) is None:
        pytest.skip(f"no C compiler {WINDOWS[target]} here")
    library, folder = library_of(_kind(name)), windows_libraries(_kind(name), target)
    program = folder / f"{name}.exe"  # beside the DLL
    source = EXAMPLES / "c" / f"{name}.c"
    subprocess.run(
        [WINDOWS[target], "-std=c11", *WARNINGS, "-I", folder, "-o", program, source, folder / f"{library.name}.lib",
         "-static-libgcc"], check=True,
    )  # fmt: skip
    dump = WINDOWS[target].replace("gcc", "objdump")
    imports = subprocess.run([dump, "-p", program], capture_output=True, text=True, check=True).stdout
    names = re.findall(r"\s(\w+(?:@\d+)?)$", imports.partition(f"{library.name}.dll")[2], re.MULTILINE)
    assert len(set(names) & set(library.functions)) >= 3
    assert not any("@" in name for name in names)
    assert missing_of(program, library) == (sorted(set(names) & set(library.functions)), [])
    wine = os.environ.get("POLYCNC_WINE32", "wine") if target == "win32" else "wine"
    if shutil.which(wine) is None:
        pytest.skip("no wine here")
    if target == "win32" and wine == "wine" and not any(Path(each).exists() for each in ROOTS_OF_32):
        pytest.skip("no wine for programs of 32 bits here")
    assert _said(name, wine, program) == C_PROGRAMS[name].expected


def test_what_a_program_needs_is_read_from_a_real_file(tmp_path: Path) -> None:
    library, program, cut = library_of("fanuc"), _linked(REFERENCE, tmp_path), tmp_path / "cut"
    taken = [
        "cnc_absolute",
        "cnc_allclibhndl",
        "cnc_freelibhndl",
        "cnc_rdmacro",
        "cnc_rdparam",
        "cnc_wrmacro",
    ]
    found, missing = missing_of(program, library)
    assert (sorted(found), missing) == (taken, [])
    content, refused = program.read_bytes(), 0
    for size in range(0, len(content), len(content) // 40):
        cut.write_bytes(content[:size])
        with suppress(UsageError):
            found, missing = missing_of(cut, library)
            assert set(found) <= set(taken)
            refused -= 1
        refused += 1
    assert refused > 20
    cut.write_bytes(content.replace(b"cnc_rdmacro\0", b"cnc_rdtool1\0"))
    assert missing_of(cut, library)[1] == ["cnc_rdtool1"]
