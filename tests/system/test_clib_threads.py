"""Threads, forks and small stacks: a control that never answers stops no call to another one."""

from __future__ import annotations

import ctypes
import socket
import struct
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from polycnc.controllers.fanuc import fwlib
from polycnc.servers.process import Machinery
from support.c_library import Door, at_door, built, loaded
from support.command import environment

WARNINGS = ("-Wall", "-Wextra", "-Werror", "-pedantic")
PROGRAM = """\
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
#include "fwlib32.h"
static unsigned short silent_port, handle;
static short opened = 77;
static void *opens(void *given)
{
    unsigned short own;
    (void)given;
    opened = cnc_allclibhndl3("127.0.0.1", silent_port, 0, &own);
    return NULL;
}
static short reads(void)
{
    ODBST state;
    ODBAXIS at;
    short code = cnc_statinfo(handle, &state);
    return code ? code : cnc_absolute(handle, ALL_AXES, 4 + 4 * MAX_AXIS, &at);
}
static void *calls(void *given)
{
    *(short *)given = reads();
    return NULL;
}
static short in_thread(void *(*routine)(void *), size_t stack, pthread_t *thread)
{
    static short code;
    pthread_attr_t small;
    code = 77;
    pthread_attr_init(&small);
    if (pthread_attr_setstacksize(&small, stack) || pthread_create(thread, &small, routine, &code))
        return 78;
    return routine == calls ? (pthread_join(*thread, NULL), code) : 0;
}
int main(int count, char **given)
{
    pthread_t waiting, other;
    char line[8];
    int state;
    silent_port = (unsigned short)atoi(given[count - 1]);
    alarm(50);
    printf("thread %d\\n", in_thread(opens, 32768, &waiting));
    fflush(stdout);
    if (!fgets(line, sizeof line, stdin))
        return 1;
    printf("open %d, ", cnc_allclibhndl(&handle));
    printf("read %d\\n", reads());
    fflush(stdout);
    if (!fork()) {
        alarm(20);
        exit(reads() != EW_HANDLE || cnc_allclibhndl(&handle) || reads() ? 1 : 42);
    }
    wait(&state);
    printf("child %d, parent %d\\n", WIFEXITED(state) ? WEXITSTATUS(state) : -1, reads());
    printf("small stack %d\\n", in_thread(calls, 16384, &other));
    printf("waits %d\\n", opened);
    fflush(stdout);
    if (!fgets(line, sizeof line, stdin))
        return 1;
    pthread_join(waiting, NULL);
    printf("lost %d\\n", opened);
    return 0;
}
"""


def test_a_control_that_never_answers_stops_neither_calls_nor_forks(tmp_path: Path) -> None:
    folder, made, source = built("fanuc"), tmp_path / "client", tmp_path / "client.c"
    source.write_text(PROGRAM)
    subprocess.run(
        ["gcc", "-std=gnu11", *WARNINGS, "-pthread", "-I", folder, "-o", made, source, "-L", folder, "-lfwlib32",
         f"-Wl,-rpath,{folder}"], check=True,
    )  # fmt: skip
    door = Door(("fanuc", Machinery(axes=2)))
    try:
        with (
            socket.create_server(("127.0.0.1", 0)) as silent,
            subprocess.Popen(
                [made, str(silent.getsockname()[1])], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                env=environment(POLYCNC_CALLS=door.place),
            ) as program,
        ):  # fmt: skip
            assert program.stdin is not None
            assert program.stdout is not None
            line, _ = silent.accept()
            assert line.recv(60, socket.MSG_WAITALL)[:8] == b"PNCCALL1"
            program.stdin.write("go\n")
            program.stdin.flush()
            said = [program.stdout.readline() for _ in range(5)]
            line.close()
            silent.close()
            program.stdin.write("go\n")
            program.stdin.flush()
            said.append(program.stdout.readline())
        assert "".join(said) == (
            "thread 0\nopen 0, read 0\nchild 42, parent 0\nsmall stack 0\nwaits 77\nlost -16\n"
        )
    finally:
        door.close()


@contextmanager
def _brief_controls(count: int) -> Iterator[int]:
    """Have a door that welcomes so many clients, gives each a handle, and ends its connection; yield its port."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            for _ in range(count):
                line, _ = server.accept()
                with line:
                    line.recv(60, socket.MSG_WAITALL)
                    line.sendall(b"PNCCALL1" + bytes(4))
                    size, number, serial = struct.unpack("<IHH", line.recv(8, socket.MSG_WAITALL))
                    line.recv(size - 4, socket.MSG_WAITALL)
                    line.sendall(struct.pack("<IHHIqIH", 22, number, serial, 0, 0, 2, 1))

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield server.getsockname()[1]
        thread.join(20)


def test_a_collector_that_never_frees_what_it_has_lost_opens_for_ever(tmp_path: Path) -> None:
    library, handles, state = loaded("fanuc", tmp_path), list[int](), (ctypes.c_uint8 * 18)(*[7] * 18)
    with _brief_controls(70) as port:
        for _ in range(70):
            handle = ctypes.c_uint16()
            assert library.cnc_allclibhndl3(b"127.0.0.1", port, 20, ctypes.byref(handle)) == 0
            assert library.cnc_statinfo(handle, state) == fwlib.EW_SOCKET
            handles.append(handle.value)
    assert len(set(handles)) == 70
    for each in handles:
        assert library.cnc_statinfo(each, state) == fwlib.EW_SOCKET
        assert library.cnc_freelibhndl(each) == 0
        assert library.cnc_statinfo(each, state) == fwlib.EW_HANDLE
    assert bytes(state) == b"\7" * 18


def test_a_lost_control_is_not_mistaken_for_the_one_that_was_opened_after_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    library, handle, other = loaded("fanuc", tmp_path), ctypes.c_uint16(), ctypes.c_uint16()
    door = Door(("fanuc", Machinery(axes=2)))
    try:
        with _brief_controls(1) as port:
            monkeypatch.setenv("POLYCNC_CALLS", f"127.0.0.1:{port}")
            assert library.cnc_allclibhndl(ctypes.byref(handle)) == 0
        assert library.cnc_statinfo(handle, bytes(18)) == fwlib.EW_SOCKET
        assert library.cnc_freelibhndl(handle) == 0
        at = int(door.place.rpartition(":")[2])
        assert library.cnc_allclibhndl3(b"127.0.0.1", at, 20, ctypes.byref(other)) == 0
        assert library.cnc_allclibhndl(ctypes.byref(handle)) == fwlib.EW_HSSB
    finally:
        door.close()


def test_threads_that_open_at_once_share_a_connection(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    library, door, codes = loaded("fanuc", tmp_path), Door(("fanuc", Machinery(axes=2))), list[int]()
    at_door(monkeypatch, door)

    def opens() -> None:
        handle = ctypes.c_uint16()
        codes.append(library.cnc_allclibhndl(ctypes.byref(handle)))

    threads = [threading.Thread(target=opens) for _ in range(24)]
    try:
        for each in threads:
            each.start()
        for each in threads:
            each.join(20)
        assert codes == [0] * 24
        assert door.clients() == 1
    finally:
        door.close()
