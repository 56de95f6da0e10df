"""The functions of the library over the network, in process: bytes of both directions, and what comes out of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from unittest.mock import patch

from polycnc.controllers.fanuc import fwlib
from polycnc.controllers.fanuc.fwlib import ALL_AXES
from polycnc.servers.focas import FocasControl, Session, load_profile
from support.fanuc_scenes_a import Bench, registered, short, shown, stream


class Cable:
    """What a client takes for a socket: a session behind it answers at once."""

    def __init__(self, control: FocasControl, note: Callable[[str, bytes], None]) -> None:
        self._session = Session(control)
        self._note = note
        self._come = b""

    def sendall(self, data: bytes) -> None:
        """Hand bytes to the session."""
        self._note(">", data)
        self._come += self._session.receive(data)

    def recv(self, most: int) -> bytes:
        """Return what the session has answered, or has more of."""
        while not self._come and self._session.more:
            self._come = self._session.receive(b"")
        data, self._come = self._come[:most], self._come[most:]
        self._note("<", data)
        return data

    def setsockopt(self, *_: int) -> None:
        """Take options."""

    def close(self) -> None:
        """End the session."""
        self._session.lost()


READ: tuple[tuple[str, tuple[Any, ...]], ...] = (
    ("actf", ()), ("absolute", (-1, 28)), ("absolute", (2, 8)), ("machine", (-1, 28)), ("relative", (-1, 28)),
    ("distance", (-1, 28)),
    ("skip", (-1, 28)), ("srvdelay", (-1, 28)), ("accdecdly", (-1, 28)), ("rddynamic", (-1, 118)),
    ("rddynamic", (3, 38)),
    ("rdprgnum", ()), ("rdseqnum", ()), ("rdparam", (1320, -1, 28)), ("rdparam", (1320, 2, 8)),
    ("rdparam", (1620, 3, 6)),
    ("rdparam", (6080, 0, 5)), ("rdparam", (12, -1, 10)), ("rdmacro", (500, 10)), ("rdmacro", (501, 10)),
    ("rdmacror", (500, 503, 30)),
    ("getmactype", ()),
)  # fmt: skip
REFUSED: tuple[tuple[str, tuple[Any, ...]], ...] = (
    ("absolute", (4, 8)), ("absolute", (0, 8)), ("absolute", (-1, 7)), ("machine", (7, 8)),
    ("rddynamic", (-1, 21)), ("rddynamic", (5, 38)),
    ("rdparam", (2, 0, 8)), ("rdparam", (1320, 7, 8)), ("rdparam", (1320, 1, 3)), ("rdmacro", (1000, 10)),
    ("rdmacro", (500, 9)),
    ("wrmacro", (1, 10, 5, 0)), ("wrmacro", (500, 10, 5, 9)), ("wrmacro", (500, 9, 5, 0)),
    ("rdmacror", (149, 500, 600)),
    ("search", (99,)), ("search", (0,)), ("delete", (99,)), ("delete", (7,)), ("delete", (9001,)),
    ("upstart", (99,)), ("upload", (3,)),
    ("upend", ()), ("download", (b"\n", 1)), ("dwnend", ()), ("wrtofs", (1, 0, 8, 1)), ("seqsrch", (1,)),
    ("rewind", ()), ("rdproginfo", (0, 12)),
)  # fmt: skip


def wire(b: Bench) -> None:
    """The same control asked over the network: what the bytes are, and that both ways say the same."""
    device = b.control(axes=3, rotary=(3,))
    registered(device, O7=";N70G90G54G1X9.Y-8.A7.F3000;M30", O8=";N8X1.;M30", O9001=";M99")
    device.parameters.set(3202, 16)
    device.parameters.set(1320, -123456, 2)
    device.parameters.set(1620, 300, 3)
    device.parameters.set(6080, 96)
    device.parameters.set(12, 129, 2)
    for number, mantissa, decimals in ((500, -70000, 3), (502, 5, 8), (503, 99999999, 0)):
        b.code("cnc_wrmacro", number, 10, mantissa, decimals)
    device.control.offsets.set("G54", {"X": 1.5, "A": -20.25})
    b.code("cnc_wrrelpos", 8, fwlib.IDBWRR(type=2, data=[-70000]))
    device.select_program(7)
    device.cycle_start()
    device.advance(60)
    device.skip_signal(True)
    device.advance(60)
    device.raise_alarm(1007)
    control = FocasControl(device, load_profile("power-mate"))
    heard: list[str] = []
    loud = True

    def note(way: str, data: bytes) -> None:
        if loud:
            heard.append(f"  {way} {data.hex(' ', -4)}")

    with patch("socket.create_connection", lambda *_: Cable(control, note)):
        _, remote = fwlib.cnc_allclibhndl3("control", 8193, 1)
        b.title("bytes, and what is read")
        for name, given in READ:
            heard.clear()
            answer = getattr(fwlib, f"cnc_{name}")(remote, *given)
            b.say(f"{name}{given}: {short(answer[0])} {', '.join(map(shown, answer[1:]))}")
            near = getattr(fwlib, f"cnc_{name}")(b.handle, *given)
            if repr(near) != repr(answer):
                b.say(f"  near the control: {short(near[0])} {', '.join(map(shown, near[1:]))}")
            b.lines += heard
        loud = False
        b.title("refusals, and near the control")
        for name, given in REFUSED:
            answers = [getattr(fwlib, f"cnc_{name}")(handle, *given) for handle in (remote, b.handle)]
            codes = [short(each[0] if isinstance(each, tuple) else each) for each in answers]
            b.say(f"{name}{given}: {' | '.join(codes)}")
        b.title("writing")
        device.reset()
        device.advance(300)
        _written(b, remote)
        fwlib.cnc_freelibhndl(remote)


def _written(b: Bench, remote: int) -> None:
    b.look(data=True)

    def do(name: str, *given: Any) -> None:
        answer = getattr(fwlib, f"cnc_{name}")(remote, *given)
        code, rest = (answer[0], answer[1:]) if isinstance(answer, tuple) else (answer, ())
        b.say(f"{name}({', '.join(map(shown, given))}): {short(code)} {' '.join(map(shown, rest))}".rstrip())

    data = stream("O12(FAR)", "N5 G1 X1.", "M30")
    record = fwlib.IODBMR(datano_s=510, datano_e=511)
    record.data[0].mcr_val, record.data[0].dec_val = -15, 1
    record.data[1].mcr_val, record.data[1].dec_val = 0, -1
    for name, given in (
        ("wrmacro", (500, 10, 31, 4)), ("wrmacro", (502, 10, 0, -1)), ("wrmacror", (18, record)),
        ("setmactype", (1,)), ("getmactype", ()),
        ("rdmacro", (510, 10)), ("setmactype", (0,)), ("dwnstart", ()), ("dwnstart", ()),
        ("download", (data, len(data))), ("dwnend", ()),
        ("upstart", (12,)), ("upstart", (12,)), ("upload", (10,)), ("upload", (99,)), ("upload", (99,)),
        ("upend", ()), ("search", (8,)),
        ("delete", (12,)), ("delete", (12,)),
    ):  # fmt: skip
        do(name, *given)
        b.look(data=True)
    b.call("cnc_absolute", ALL_AXES, 28)
