"""Measure the C library: a call over the socket beside the same one in Python, a client's first call, size, leaks."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from _measure import Figure, at_most
from _report import run_script
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.machine import Poll, Way
from polycnc.servers.calls import build_library, library_of, target_here, write_library

_AXES = 3
_LENGTH = 4 + 4 * _AXES
_AT_ONCE = 10  # calls of a batch: few enough that some batches are not interrupted
_BATCHES = """\
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <time.h>
#include "fwlib32.h"
int main(void)
{
    unsigned short handle;
    ODBAXIS at;
    char line[8];
    struct timespec from, to;
    int k, code = cnc_allclibhndl(&handle);
    while (fgets(line, sizeof line, stdin)) {
        clock_gettime(CLOCK_MONOTONIC, &from);
        for (k = 0; k < AT_ONCE; k++)
            code |= cnc_absolute(handle, ALL_AXES, 16, &at);
        clock_gettime(CLOCK_MONOTONIC, &to);
        printf("%.9f\\n", code ? -1.0 : to.tv_sec - from.tv_sec + 1e-9 * (to.tv_nsec - from.tv_nsec));
        fflush(stdout);
    }
    return code | cnc_freelibhndl(handle);
}
"""
_CLIENT = """\
#include <stdio.h>
#include "fwlib32.h"
int main(void)
{
    unsigned short handle;
    ODBAXIS at;
    int code = cnc_allclibhndl(&handle);
    code |= cnc_absolute(handle, ALL_AXES, 16, &at);
    return code | cnc_freelibhndl(handle);
}
"""


def _best_s(batches: int, *ways: Callable[[], float]) -> list[float]:
    """Return the time of a call in each way's quickest batch; batches take turns, so that all meet the same load."""
    best_s = [float("inf")] * len(ways)
    for _ in range(batches):
        for k, batch_s in enumerate(ways):
            best_s[k] = min(best_s[k], batch_s() / _AT_ONCE)
    return best_s


def _timed(call: Callable[[], object]) -> Callable[[], float]:
    """Return what does a batch of calls and returns how long it took (s)."""

    def batch_s() -> float:
        begin = time.perf_counter()
        for _ in range(_AT_ONCE):
            call()
        return time.perf_counter() - begin

    return batch_s


def _facade(clock: Way | None = None) -> Callable[[], object]:
    session = fwlib.Session()
    session.attach(0, PowerMate(_AXES, characters=128_000), clock)
    _, handle = session.cnc_allclibhndl()
    return lambda: session.cnc_absolute(handle, fwlib.ALL_AXES, _LENGTH)


def _in_process(batches: int) -> Figure:
    """Both let a cycle pass with each call, since it reads the same again."""
    with tempfile.TemporaryDirectory() as name:
        folder, kind = Path(name), library_of("fanuc")
        write_library(kind, folder, in_process=True)
        built = build_library(kind, folder, target_here(), in_process=True)
        call, facade = _from_python(ctypes.CDLL(str(built))), _facade(Poll(1))
    inside_s, python_s = _best_s(batches, _timed(call), _timed(facade))
    return at_most(
        "C library: a call in process, as ratio to Python", inside_s / python_s, "", 1.3,
        f"cnc_absolute and a cycle: {inside_s * 1e6:.0f} us, in Python {python_s * 1e6:.0f} us",
    )  # fmt: skip


def _from_python(library: Any) -> Callable[[], object]:
    handle, at = ctypes.c_ushort(), fwlib.ODBAXIS()
    if library.cnc_allclibhndl(ctypes.byref(handle)):
        raise RuntimeError("the server is not found")
    function, given = library.cnc_absolute, (handle, ctypes.c_short(-1), ctypes.c_short(_LENGTH))
    to = ctypes.byref(at)
    return lambda: function(*given, to)


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_library(library_of("fanuc"), folder)
        built = build_library(library_of("fanuc"), folder, target_here())
        served = subprocess.Popen(
            [sys.executable, "-m", "polycnc.cli", "calls", "fanuc", "--port", "0"],
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        try:
            assert served.stdout is not None
            place = served.stdout.readline().decode().split()[1]
            os.environ["POLYCNC_CALLS"] = place
            return _figures(quick, folder, built, served.pid)
        finally:
            served.terminate()
            served.communicate()


def _figures(quick: bool, folder: Path, built: Path, server: int) -> list[Figure]:
    batches = 400 if quick else 2_000
    over_s, python_s = _over_socket(folder, batches)
    size = at_most("C library: size of libfwlib32", built.stat().st_size / 1e3, "kB", 200)
    client = _program(folder, "client", _CLIENT)
    count = 50 if quick else 1_000
    first_ms = min(_run_ms(client) for _ in range(20))
    before_kb, files = _held_kb(server), _files(server)
    for _ in range(count):
        _run_ms(client)
    return [
        at_most(
            "C library: a call over the socket, as ratio to Python", over_s / python_s, "", 2.5,
            f"cnc_absolute: {over_s * 1e6:.0f} us, in Python {python_s * 1e6:.0f} us",
        ),
        _in_process(batches),
        at_most("C library: a program that opens, calls and frees", first_ms, "ms", 50),
        size,
        at_most(f"C library: memory after {count} programs", _held_kb(server) - before_kb, "kB more", 2_000),
        at_most(f"C library: open files after {count} programs", _files(server) - files, "more", 0),
    ]  # fmt: skip


def _over_socket(folder: Path, batches: int) -> list[float]:
    """Return the time of a call of a C program, and of the same one in Python (s)."""
    program = _program(folder, "batches", _BATCHES)
    with subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as ran:
        assert ran.stdin is not None
        assert ran.stdout is not None
        to, said = ran.stdin, ran.stdout

        def batch_s() -> float:
            to.write("go\n")
            to.flush()
            lasted_s = float(said.readline())
            if lasted_s < 0.0:
                raise RuntimeError("a call was refused")
            return lasted_s

        return _best_s(batches, batch_s, _timed(_facade()))


def _program(folder: Path, name: str, text: str) -> Path:
    source, made = folder / f"{name}.c", folder / name
    source.write_text(text)
    subprocess.run(
        ["cc", f"-DAT_ONCE={_AT_ONCE}", "-O2", "-o", made, source, "-I", folder, "-L", folder, "-lfwlib32",
         f"-Wl,-rpath,{folder}"], check=True,
    )  # fmt: skip
    return made


def _run_ms(client: Path) -> float:
    begin = time.perf_counter()
    subprocess.run([client], check=True)
    return (time.perf_counter() - begin) * 1e3


def _held_kb(process: int) -> float:
    return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e3


def _files(process: int) -> int:
    return len(list(Path(f"/proc/{process}/fd").iterdir()))


if __name__ == "__main__":
    run_script("C library", figures)
