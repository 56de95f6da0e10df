"""The C programs of examples/c: linked, run on this system, and as Windows programs, with the same lines everywhere."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from polycnc.cli._calls import calls_command
from polycnc.servers.calls import build_library, library_of, write_library
from polycnc.servers.process import Machinery
from support.c_library import Door, built
from support.command import COMMAND, environment
from support.facade_programs import SYSTEM, facade_says

EXAMPLES = Path(__file__).parents[2] / "examples"
WARNINGS = ("-Wall", "-Wextra", "-Werror", "-pedantic")
PROGRAMS = {"fanuc": "fanuc_macro", "apci": "apci_jog", "imc": "imc_move"}
SAID = {
    "apci": "init 0, board 4, 3 axes\nat 12.500\n",
    "imc": "adapters 0: 1\nopen 0\nmove 0\nat 6250, moving 0\nclose 0\n",
}
WINDOWS = {"win64": "x86_64-w64-mingw32-gcc", "win32": "i686-w64-mingw32-gcc"}
ROOTS_OF_32 = ("/usr/lib/i386-linux-gnu/wine", "/usr/lib/wine/i386-windows", "/usr/lib/wine/wine")


def _said(kind: str) -> str:
    return SAID.get(kind) or facade_says()


def _linked(kind: str, folder: Path, to: Path, name: str = "") -> Path:
    made = to / (name or PROGRAMS[kind])
    source = EXAMPLES / "c" / f"{made.name}.c"
    subprocess.run(
        ["gcc", "-std=c11", *WARNINGS, "-I", folder, "-o", made, source, "-L", folder,
         f"-l{library_of(kind).name}", f"-Wl,-rpath,{folder}"], check=True,
    )  # fmt: skip
    return made


def _run(place: str, *command: str | Path) -> str:
    ran = subprocess.run(
        command,
        env=environment(POLYCNC_CALLS=place, WINEDEBUG="-all"),
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    return ran.stdout


@pytest.fixture(scope="module")
def doors(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Door]]:
    card = tmp_path_factory.mktemp("card") / "card.toml"
    card.write_text("number_of_axes = 2\nready = true\n")
    files = {"apci": SYSTEM, "imc": card}
    made = {kind: Door((kind, Machinery(file=files.get(kind))), running=True) for kind in PROGRAMS}
    yield made
    for door in made.values():
        door.close()


@pytest.mark.covers("apci.lib.c")
@pytest.mark.parametrize("kind", PROGRAMS)
def test_a_program_links_and_says_what_it_has_to(kind: str, tmp_path: Path, doors: dict[str, Door]) -> None:
    assert _run(doors[kind].place, _linked(kind, built(kind), tmp_path)) == _said(kind)


LONGER = {
    "fanuc_events": "mode 1, run 0, motion 0, emergency 0, alarm 0\n#500 = 3.0\n#501 = 1.0\n#502 = 0.0\n"
    "too short 2\nfree 0\nfree again -8\n",
    "apci_shaft": "init 0\nturn 1: at 20.000 10.000, mark passed 1 times\n"
    "turn 2: at 30.000 12.500, mark passed 0 times\nturn 3: at 5.000 2.500, mark passed 1 times\nerrors 0\n",
    "imc_contour": "open 0\nat 3000 6000\nerrors 0\nclose 0\n",
}
"""The slave of the shaft turns by 0.5, 0.25 and 0.4 of the master's 20, 10 and -25 mm."""


@pytest.mark.parametrize("name", LONGER)
def test_a_longer_program_says_what_it_has_to(name: str, tmp_path: Path, doors: dict[str, Door]) -> None:
    kind = name.partition("_")[0]
    assert _run(doors[kind].place, _linked(kind, built(kind), tmp_path, name)) == LONGER[name]


def test_a_program_against_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, trace = _linked("fanuc", built("fanuc"), tmp_path), tmp_path / "calls.jsonl"
    process = subprocess.Popen(
        [*COMMAND, "calls", "fanuc", "--port", "0", "--trace", trace],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment(PYTHONUNBUFFERED="1"),
    )  # fmt: skip
    assert process.stdout is not None
    place = process.stdout.readline().partition(" ")[2].strip()
    assert _run(place, program) == facade_says()
    process.terminate()
    _, error = process.communicate(timeout=30)
    assert (process.returncode, error) == (143, "")
    lines = trace.read_text().splitlines()
    assert len(lines) == 7
    calls_command("fanuc", replay=trace)
    assert capsys.readouterr().out == _shown("replayed")
    shown = json.loads(_shown("traced"))
    assert {**json.loads(lines[1]), "time_s": shown["time_s"]} == shown


def test_a_collector_opens_anew_what_it_has_lost(tmp_path: Path) -> None:
    folder, made = built("fanuc"), tmp_path / "collector"
    subprocess.run(
        ["gcc", "-std=c11", *WARNINGS, "-I", folder, "-o", made, EXAMPLES / "c" / "fanuc_collector.c",
         "-L", folder, "-lfwlib32", f"-Wl,-rpath,{folder}"], check=True,
    )  # fmt: skip
    first = Door(("fanuc", Machinery(axes=2)))
    port = int(first.place.rpartition(":")[2])
    with subprocess.Popen(
        [made, "127.0.0.1", str(port)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=environment(),
    ) as program:
        assert program.stdin is not None
        assert program.stdout is not None

        def ask(lines: int) -> list[str]:
            assert program.stdin is not None
            assert program.stdout is not None
            program.stdin.write("go\n")
            program.stdin.flush()
            return [program.stdout.readline().rstrip() for _ in range(lines)]

        told = "mode 1, run 0, program 0, at 0 0, feed 0, alarms 0"
        assert ask(2) == ["open 0", f"1: {told}"]
        assert ask(1) == [f"2: {told}"]
        first.close()
        assert ask(1) == ["3: lost, -16"]
        assert ask(1) == ["open -16"]
        second = Door(("fanuc", Machinery(axes=2)), port=port)
        try:
            assert ask(2) == ["open 0", f"4: {told}"]
            program.stdin.close()
            assert program.stdout.read() == "free 0\n"
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
    assert _shown("output") == facade_says()


@pytest.mark.long
@pytest.mark.parametrize("target", WINDOWS)
@pytest.mark.parametrize("kind", PROGRAMS)
def test_the_same_program_as_a_windows_one(
    kind: str, target: str, tmp_path: Path, doors: dict[str, Door]
) -> None:
    if shutil.which(WINDOWS[target]) is None:
        pytest.skip(f"no C compiler {WINDOWS[target]} here")
    library = library_of(kind)
    write_library(library, tmp_path)
    build_library(library, tmp_path, target)
    program = tmp_path / "client.exe"
    source = EXAMPLES / "c" / f"{PROGRAMS[kind]}.c"
    subprocess.run(
        [WINDOWS[target], "-std=c11", *WARNINGS, "-I", tmp_path, "-o", program, source,
         tmp_path / f"{library.name}.lib", "-static-libgcc"], check=True,
    )  # fmt: skip
    dump = WINDOWS[target].replace("gcc", "objdump")
    imports = subprocess.run([dump, "-p", program], capture_output=True, text=True, check=True).stdout
    names = re.findall(r"\s(\w+(?:@\d+)?)$", imports.partition(f"{library.name}.dll")[2], re.MULTILINE)
    assert len(set(names) & set(library.functions)) >= 5
    assert not any("@" in name for name in names)
    wine = os.environ.get("POLYCNC_WINE32", "wine") if target == "win32" else "wine"
    if shutil.which(wine) is None:
        pytest.skip("no wine here")
    if target == "win32" and wine == "wine" and not any(Path(each).exists() for each in ROOTS_OF_32):
        pytest.skip("no wine for programs of 32 bits here")
    assert _run(doors[kind].place, wine, program) == _said(kind)
