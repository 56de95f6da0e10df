"""The function library as a client of a served control: handles of the network (cnc_allclibhndl3)."""

from __future__ import annotations

import asyncio
import socket
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from polycnc.controllers.library import variant
from polycnc.machine import Host
from polycnc.runner import WallClock
from polycnc.servers.focas import PROFILES, FocasServer, load_profile

OK = EW.EW_OK
PROGRAM = "O0007\nN10G90G1X50.F600\nN20G4X1000.\nM30\n"


class Served:
    """A control behind a server of its own thread."""

    def __init__(self, profile: str, **keys: Any) -> None:
        self.control = PowerMate(**keys)
        self.port = 0
        self._profile = profile
        self._ready = threading.Event()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._end: asyncio.Event | None = None
        self._thread = threading.Thread(target=lambda: asyncio.run(self._run()))
        self._thread.start()
        assert self._ready.wait(60)

    async def _run(self) -> None:
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        with Host(self.control, WallClock(), rate=0.0) as host:
            server = FocasServer(host, self.control, load_profile(self._profile), port=0)
            await server.start()
            self.port = server.port
            self._ready.set()
            await self._end.wait()
            await server.close()

    def close(self) -> None:
        assert self._loop is not None
        assert self._end is not None
        self._loop.call_soon_threadsafe(self._end.set)
        self._thread.join(60)


@pytest.fixture
def session() -> Iterator[Any]:
    """Give a program of its own, whose handles are closed in the end."""
    session = fwlib.Session()
    yield session
    for handle in [handle for handle, _ in session.open.items()]:
        session.free(handle)


@pytest.fixture(scope="module", params=PROFILES)
def served(request: pytest.FixtureRequest) -> Iterator[Served]:
    made = Served(request.param)
    control = made.control
    control.programs.register(7, PROGRAM)
    control.select_program(7)
    control.cycle_start()
    control.advance(500)
    yield made
    made.close()


def connected(session: Any, served: Served) -> int:
    code, handle = session.cnc_allclibhndl3("127.0.0.1", served.port, 10)
    assert code == OK
    return int(handle)


def test_reads_agree_with_the_control_itself(served: Served, session: Any) -> None:
    remote = connected(session, served)
    session.attach(0, served.control)
    _, local = session.cnc_allclibhndl()
    for name in ("cnc_absolute", "cnc_machine", "cnc_relative", "cnc_srvdelay", "cnc_accdecdly"):
        function = getattr(session, name)
        there, here = function(remote, -1, 28), function(local, -1, 28)
        assert (there[0], list(there[1].data)[:3]) == (OK, list(here[1].data)[:3]), name
        assert function(remote, 2, 8)[1].data[0] == here[1].data[1], name
    assert session.cnc_absolute(remote, 1, 8)[1].data[0] > 1000
    dynamic, here = session.cnc_rddynamic(remote, -1, 118)[1], session.cnc_rddynamic(local, -1, 118)[1]
    assert list(dynamic.pos.faxis.absolute)[:3] == list(here.pos.faxis.absolute)[:3]
    assert (dynamic.prgnum, dynamic.prgmnum, dynamic.seqnum) == (7, 7, 10)
    assert dynamic.actf == here.actf > 0
    one = session.cnc_rddynamic(remote, 1, 38)[1]
    assert one.pos.oaxis.machine == here.pos.faxis.machine[0]
    assert session.cnc_rdprgnum(remote)[1].data == 7
    assert session.cnc_rdseqnum(remote)[1].data == 10
    assert session.cnc_actf(remote)[1].data == here.actf
    code, state = session.cnc_statinfo(remote)
    assert (code, state.aut) == (OK, 1)
    assert state.run in (3, 4)  # START, in the numbers of the series
    code, system = session.cnc_sysinfo(remote)
    assert (code, system.cnc_type) == (OK, load_profile(served._profile).cnc_type.encode())
    assert session.cnc_alarm(remote)[1].data == 0


def test_macros_and_parameters_and_pmc(served: Served, session: Any) -> None:
    handle = connected(session, served)
    assert session.cnc_wrmacro(handle, 500, 10, -2625, 3) == OK
    assert served.control.macros.get(500) == -2.625
    _, macro = session.cnc_rdmacro(handle, 500, 10)
    assert (macro.mcr_val, macro.dec_val) == (-2625, 3)
    assert session.cnc_wrmacro(handle, 500, 10, 0, -1) == OK
    assert served.control.macros.get(500) is None
    _, macro = session.cnc_rdmacro(handle, 500, 10)
    assert (macro.mcr_val, macro.dec_val) == (0, -1)
    served.control.macros.set(501, 0.375)
    _, many = session.cnc_rdmacror(handle, 500, 502, 24)
    assert [(each.mcr_val, each.dec_val) for each in many.data] == [(0, -1), (375, 3), (0, -1)]
    data = fwlib.IODBMR(datano_s=510, datano_e=511)
    data.data[0].mcr_val, data.data[1].mcr_val, data.data[1].dec_val = 7, -25, 1
    assert session.cnc_wrmacror(handle, 18, data) == OK
    assert [served.control.macros.get(number) for number in (510, 511)] == [7.0, -2.5]
    data.data[1].dec_val = 9
    assert session.cnc_wrmacror(handle, 18, data) == EW.EW_DATA
    assert served.control.macros.get(510) == 7.0
    assert session.cnc_setmactype(handle, 1) == OK
    _, macro = session.cnc_rdmacro(handle, 501, 10)
    assert (macro.mcr_val, macro.dec_val) == (3, 3)
    assert session.cnc_rdmacro(handle, 4000, 10)[0] == EW.EW_NUMBER
    assert session.cnc_rdmacro(handle, 500, 9)[0] == EW.EW_LENGTH
    served.control.parameters.set(6711, 1234567)
    assert session.cnc_rdparam(handle, 6711, 0, 8)[1].u.ldata == 1234567
    served.control.parameters.set(1320, -4321, 2)
    assert session.cnc_rdparam(handle, 1320, 2, 8)[1].u.ldata == -4321
    assert session.cnc_rdparam(handle, 9999, 0, 8)[0] == EW.EW_NUMBER
    block = fwlib.IODBPMC(type_a=5, type_d=1, datano_s=100, datano_e=103)
    block.u.idata[0], block.u.idata[1] = 0x1234, -2
    assert session.pmc_wrpmcrng(handle, 12, block) == OK
    assert served.control.pmc.read("R", 100, 103) == b"\x34\x12\xfe\xff"
    _, found = session.pmc_rdpmcrng(handle, 5, 1, 100, 103, 12)
    assert [found.u.idata[0], found.u.idata[1]] == [0x1234, -2]
    assert (
        session.pmc_wrpmcrng(handle, 9, variant(fwlib.IODBPMC)(type_a=1, datano_s=0, datano_e=0))
        == EW.EW_PROT
    )


def test_programs_go_both_ways(served: Served, session: Any) -> None:
    handle = connected(session, served)
    text = b"\nO1234\nG1F0.3W10.\nM30\n%"
    assert session.cnc_download(handle, b"x", 1) == EW.EW_FUNC
    assert session.cnc_dwnstart(handle) == OK
    assert session.cnc_dwnstart(handle) == EW.EW_BUSY
    for at in range(0, len(text), 10):
        assert session.cnc_download(handle, text[at : at + 10], len(text[at : at + 10])) == OK
    assert session.cnc_dwnend(handle) == OK
    assert session.cnc_dwnend(handle) == EW.EW_FUNC
    assert served.control.programs.read(1234) == b"O1234\nG1F0.3W10.\nM30\n"
    assert session.cnc_upstart(handle, 1234) == OK
    pieces = []
    while (answer := session.cnc_upload(handle, 10))[2]:
        pieces.append(bytes(answer[1].data)[: answer[2]])
    assert b"".join(pieces).split() == [b"%", b"O1234", b"G1F0.3W10.", b"M30", b"%"]
    assert session.cnc_upend(handle) == OK
    assert session.cnc_upstart(handle, 4321) == EW.EW_DATA
    assert session.cnc_dwnstart(handle) == OK
    assert session.cnc_download(handle, text, len(text)) == OK
    assert session.cnc_dwnend(handle) == EW.EW_DATA  # registered already
    assert session.cnc_delete(handle, 1234) == EW.EW_BUSY  # a program is executed
    served.control.reset()
    assert session.cnc_delete(handle, 1234) == OK
    assert 1234 not in served.control.programs


REFUSED = {
    "MDI": {"delete 1": -1, "delete 77": -1, "search 2": 0, "search 77": 5, "selected": 7},
    "JOG": {"delete 7": -1, "delete 77": 5, "search 77": 5, "search 2": 0, "selected": 7, "delete 1": 0},
    "MEM": {"delete 7": -1, "delete 8001": 0, "search 77": 5, "search 2": 0, "selected": 2, "delete 7 ": 0},
    "running": {"delete 1": -1, "delete 77": -1, "search 2": -1, "search 77": -1, "selected": 7},
}  # fmt: skip
"""What deleting and searching answer in a mode, one after another, and which program is selected (Manual 000)."""


@pytest.mark.covers("fanuc.cnc_delete", "fanuc.cnc_search")
def test_programs_are_deleted_and_sought_over_the_network_as_in_the_library(session: Any) -> None:
    served = Served(PROFILES[0])
    _, far = session.cnc_allclibhndl3("127.0.0.1", served.port, 10)
    session.attach(0, near := PowerMate())
    for control, handle in ((near, session.cnc_allclibhndl()[1]), (served.control, far)):
        for scene, answers in REFUSED.items():
            control.reset()
            control.select_mode("MEM")
            for number in (1, 2, 7, 8001):
                if number not in control.programs:
                    control.programs.register(number, PROGRAM.replace("0007", f"{number:04d}"))
            control.select_program(7)
            if scene == "running":
                control.cycle_start()
                control.advance(3)
            else:
                control.select_mode(scene)
            told = dict[str, int]()
            for asked in answers:
                name, _, which = asked.partition(" ")
                called = getattr(session, f"cnc_{name}", None)
                told[asked] = int(called(handle, int(which))) if called else control.programs.selected
            assert told == answers, scene
    assert session.cnc_rdparam(far, 1320, 1, 8)[0] == OK
    assert session.cnc_rdparam(far, 1320, 1, 7)[0] == session.cnc_rdparam(far, 1320, -1, 7)[0] == EW.EW_LENGTH
    served.close()


def test_functions_without_a_request_are_not_there(served: Served, session: Any) -> None:
    handle = connected(session, served)
    assert session.cnc_rdophisno(handle)[0] == EW.EW_FUNC
    assert session.cnc_rewind(handle) == EW.EW_FUNC
    assert session.cnc_freelibhndl(handle) == OK
    assert session.cnc_statinfo(handle)[0] == EW.EW_HANDLE


def test_nobody_listens_or_something_else_does(session: Any) -> None:
    def answer(listener: socket.socket) -> None:
        with listener.accept()[0] as line:
            line.sendall(b"HTTP/1.1 400 Bad Request\r\n")
            line.recv(100)

    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
        other = threading.Thread(target=answer, args=(listener,))
        other.start()
        assert session.cnc_allclibhndl3("127.0.0.1", port, 5) == (EW.EW_PROTOCOL, 0)
        other.join()
    assert session.cnc_allclibhndl3("127.0.0.1", port, 5) == (EW.EW_SOCKET, 0)
    assert session.cnc_allclibhndl3("127.0.0.1", 0, 5)[0] == EW.EW_SOCKET
    assert session.cnc_allclibhndl3("no.such.host.invalid", 8193, 5)[0] == EW.EW_SOCKET


def test_a_connection_that_is_lost_answers_with_a_code_from_then_on(session: Any) -> None:
    served = Served("31i")
    handle = connected(session, served)
    served.close()
    assert session.cnc_statinfo(handle)[0] == EW.EW_SOCKET
    assert session.cnc_rdmacro(handle, 500, 10)[0] == EW.EW_SOCKET


def test_one_session_too_many_is_refused(session: Any) -> None:
    served = Served("0i-d")
    try:
        most = load_profile("0i-d").most_sessions
        handles = [connected(session, served) for _ in range(most)]
        code, _ = session.cnc_allclibhndl3("127.0.0.1", served.port, 5)
        assert code not in (OK, EW.EW_SOCKET)
        assert session.cnc_freelibhndl(handles[0]) == OK
        assert session.cnc_rdprgnum(handles[1])[0] == OK
    finally:
        served.close()
