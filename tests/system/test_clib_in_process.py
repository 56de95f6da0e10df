"""The library with the machines in the program's own process: the same answers and bytes; time passes by polling."""

from __future__ import annotations

import ctypes
import random
import shutil
import subprocess
import sysconfig
from pathlib import Path

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.clib import FWLIB
from polycnc.errors import UsageError
from polycnc.machine import Poll
from polycnc.servers.calls import build_command, build_library, library_of, write_library
from polycnc.servers.inside import inside
from support.c_hold import Hold
from support.c_library import NO_COMPILER
from support.command import environment
from support.facade_programs import C_PROGRAMS, EXAMPLES
from support.fwlib_calls import AT_HOME, HANDLE, before, number_of, size_of

FORKS = """\
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
#include "fwlib32.h"
int main(void)
{
    unsigned short handle, other;
    ODBST state;
    int status, code = cnc_allclibhndl(&handle);
    if (!fork()) {
        alarm(20);
        exit(cnc_statinfo(handle, &state) == EW_HANDLE && cnc_allclibhndl(&other) == EW_HSSB ? 42 : 1);
    }
    wait(&status);
    printf("open %d, child %d, ", code, WIFEXITED(status) ? WEXITSTATUS(status) : -1);
    printf("read %d\\n", cnc_statinfo(handle, &state));
    return 0;
}
"""


def _built(kind: str, folder: Path) -> Path:
    if shutil.which("gcc") is None:
        pytest.skip(NO_COMPILER)
    told = sysconfig.get_config_vars()
    if not told["Py_ENABLE_SHARED"] or not (Path(told["INCLUDEPY"]) / "Python.h").exists():
        pytest.skip("no shared library of Python, or no Python.h, here")
    write_library(library_of(kind), folder, in_process=True)
    return build_library(library_of(kind), folder, "linux", in_process=True)


def _linked(kind: str, source: Path, folder: Path) -> Path:
    subprocess.run(
        ["gcc", "-std=gnu11", "-I", folder, "-o", folder / "client", source, "-L", folder,
         f"-l{library_of(kind).name}", f"-Wl,-rpath,{folder}"], check=True,
    )  # fmt: skip
    return folder / "client"


def test_functions_answer_and_write_as_the_facade_in_the_same_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("POLYCNC_SERVED", raising=False)
    library = ctypes.CDLL(str(_built("fanuc", tmp_path)))
    session = fwlib.Session()
    twin = PowerMate(3, characters=128_000)
    twin.advance(1)
    session.attach(0, twin, Poll(1))
    handle = ctypes.c_uint16()
    assert (library.cnc_allclibhndl(ctypes.byref(handle)), handle.value) == (0, HANDLE)
    assert session.cnc_allclibhndl() == (0, HANDLE)
    hold = Hold(FWLIB, library, session, random.Random(31), number_of, size_of, before)
    calls = [each for each in FWLIB.calls if each.function.name not in AT_HOME]
    for _ in range(4):
        for call in hold.dice.sample(calls, len(calls)):
            hold.call(call)
    assert {0, 2, 3, 5, -8} <= hold.codes
    assert library.cnc_freelibhndl(handle) == 0
    assert library.cnc_statinfo(handle, None) == fwlib.EW_HANDLE


@pytest.mark.long
@pytest.mark.parametrize("name", C_PROGRAMS)
def test_a_program_says_the_same_without_a_server(name: str, tmp_path: Path) -> None:
    kind, wanted, file = name.partition("_")[0], C_PROGRAMS[name], tmp_path / "plant.toml"
    _built(kind, tmp_path)
    program = _linked(kind, EXAMPLES / "c" / f"{name}.c", tmp_path)
    machine = f'file = "{EXAMPLES / wanted.file}"\n' if wanted.file else ""
    file.write_text(f'[doors]\nhttp = 0\n[[machine]]\nname = "a"\ncontroller = "{kind}"\n{machine}')
    ran = subprocess.run(
        [program], env=environment(POLYCNC_SERVED=str(file)), input=wanted.given, capture_output=True, text=True,
        timeout=600, check=False,
    )  # fmt: skip
    assert (ran.stdout, ran.stderr) == (wanted.expected, "")


@pytest.mark.long
def test_the_child_of_a_fork_has_no_machines(tmp_path: Path) -> None:
    _built("fanuc", tmp_path)
    (tmp_path / "forks.c").write_text(FORKS)
    program = _linked("fanuc", tmp_path / "forks.c", tmp_path)
    ran = subprocess.run(
        [program], env=environment(), capture_output=True, text=True, timeout=600, check=True
    )
    assert ran.stdout == "open 0, child 42, read 0\n"


def test_a_file_without_such_a_machine_has_none(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    file = tmp_path / "plant.toml"
    file.write_text('[doors]\nhttp = 0\n[[machine]]\nname = "a"\ncontroller = "plain"\n')
    monkeypatch.setenv("POLYCNC_SERVED", str(file))
    assert inside("fwlib32").devices == []
    with pytest.raises(UsageError, match="there is no C library 'mcug7'"):
        inside("mcug7")


@pytest.mark.parametrize("target", ["win32", "win64", "macos"])
def test_it_is_for_linux_alone(target: str) -> None:
    with pytest.raises(UsageError, match=f"is not built for {target}"):
        build_command(library_of("fanuc"), target, in_process=True)


def test_an_interpreter_without_a_shared_library_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sysconfig, "get_config_vars", lambda: {"Py_ENABLE_SHARED": 0})
    with pytest.raises(UsageError, match="has no shared library"):
        build_command(library_of("fanuc"), "linux", in_process=True)
