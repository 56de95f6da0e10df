"""What a door says of a write is so: a success is seen through another door, a refusal has changed nothing anywhere.

Each write of a Power Mate by FOCAS and by REST, in each state of the machine: running, held, with an alarm, ...
"""

from __future__ import annotations

import json
import os
import random
import struct
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Any

import pytest

from polycnc.cnc import ControlError
from polycnc.controllers.fanuc.wire import (
    Frame,
    FrameReader,
    FrameType,
    Request,
    Value8,
    read_replies,
    write_requests,
)
from polycnc.servers.commands import carry_out
from polycnc.servers.focas import FocasControl, Session, load_profile
from polycnc.servers.machines import ServedMachine
from polycnc.servers.process import Machinery
from support.focas_line import values
from support.http_app import visit
from support.often import ALL_CASES

FOLDER = b"//CNC_MEM/USER/PATH1/"
PROGRAMS = {
    "O0012": "O0012\nN10 G4 X1.\nN20 M0\nN30 G4 X20.\nM30\n",
    "O0013": "O0013\nM30\n",
    "O9001": "O9001\nM99\n",
}
LONG_MDI = "G91 G1 X20. F100.\n"


@dataclass
class Rig:
    """A machine with a client of REST and one of FOCAS, whose time passes only here."""

    client: Any
    machine: ServedMachine
    commands: Session
    transfer: Session
    before: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, client: Any, machine: ServedMachine) -> Rig:
        control = FocasControl(machine.device, load_profile("31i"))  # type: ignore[arg-type]
        made = cls(client, machine, Session(control), Session(control))
        made.commands.receive(bytes(Frame(FrameType.OPEN, b"\0\2")))
        made.transfer.receive(bytes(Frame(FrameType.OPEN, b"\0\1")))
        return made

    @property
    def device(self) -> Any:
        return self.machine.device

    def operate(self, command: str, **given: Any) -> None:
        carry_out(self.machine, {"command": command, **given})

    def pass_time(self, cycles: int) -> None:
        self.machine.served.advance(cycles)

    def ask(self, code: int, *arguments: int, data: bytes = b"", target: int = 1) -> tuple[int, bytes]:
        """Return code and payload of a command of FOCAS."""
        first, second, third, fourth = (*arguments, 0, 0, 0, 0)[:4]
        request = Request(code, (first, second, third, fourth), data, target)
        sent = self.commands.receive(bytes(Frame(FrameType.COMMANDS, write_requests([request]))))
        (frame,) = FrameReader().feed(sent)
        ((_, reply),) = read_replies(frame.body)
        return reply.status, reply.payload

    def number(self, code: int, *arguments: int) -> float | None:
        """Return the first number of a payload."""
        status, payload = self.ask(code, *arguments)
        assert status == 0
        return values(payload)[0]

    def parameter(self, number: int) -> int:
        """Return the first value of a parameter of all axes."""
        return int(values(self.ask(0x8D, number, number, -1)[1][12:])[0] or 0)

    def download(self, text: bytes) -> bool:
        """Send programs; tell whether they were taken."""

        def frames(kind: FrameType, body: bytes = b"") -> list[Frame]:
            return list(FrameReader().feed(self.transfer.receive(bytes(Frame(kind, body)))))

        (began,) = frames(FrameType.DOWNLOAD_START, b"\0\0\0\1" + FOLDER.ljust(512, b"\0"))
        if began.type == FrameType.DOWNLOAD_START_STATUS:
            return False
        frames(FrameType.DOWNLOAD_DATA, text)
        (ended,) = frames(FrameType.DOWNLOAD_END)
        return ended.type == FrameType.DOWNLOAD_ENDED

    def upload(self, name: bytes) -> bytes:
        """Return the text of a program, or nothing."""
        body = b"\0\0\0\1" + (FOLDER + name).ljust(512, b"\0")
        sent = self.transfer.receive(bytes(Frame(FrameType.UPLOAD_START, body)))
        while self.transfer.more:
            sent += self.transfer.receive(b"")
        frames = [each for each in FrameReader().feed(sent) if each.type == FrameType.UPLOAD_DATA]
        return b"".join(each.body for each in frames)

    async def get(self, path: str) -> Any:
        answer = await self.client.get(path)
        return answer.json() if answer.status_code == 200 else None

    def facts(self) -> dict[str, Any]:
        """Return all that the machine shows and keeps."""
        from polycnc.servers.http._documents import as_json, status_json

        machine, control = self.machine, self.machine.control
        assert control is not None
        inventory = json.loads(as_json(control.inventory()))
        return {
            "status": json.loads(status_json(machine)),
            "alarms": inventory["alarms"],
            "breakpoints": inventory["breakpoints"],
            "tools": inventory["tools"],
            "offsets": inventory["offsets"],
            "directory": inventory["programs"],
            "axes": inventory["axes"],
            "programs": {name: control.programs.read(name) for name in control.programs},
            "parameters": {each.name: each.value for each in machine.parameters.all()},
            "variables": {each.name: each.value for each in machine.variables.all()},
            "signals": {each.name: each.value for each in machine.signals.all()},
            "selected": self.device.programs.selected,
            "cursor": self.device.state.cursor,
        }


def setup(rig: Rig) -> None:
    """Bring the machine to rest in AUTO, with its programs, and nothing protected."""
    device, machine = rig.device, rig.machine
    device.protect_key(False)
    machine.signals.set("G8", 48)
    for number in ("20", "3202"):
        machine.parameters.set(number, 0)
    device.emergency_stop(False)
    rig.operate("reset")
    rig.pass_time(1000)
    rig.operate("reset")
    rig.operate("select_mode", mode="auto")
    rig.operate("set_switches", single_block=False, machine_lock=False, dry_run=False, block_delete=[])
    rig.operate("set_breakpoints", program="O0012", lines=[])
    rig.operate("set_overrides", feed=1.0, rapid=1.0)
    for each in set(PROGRAMS) | set(machine.control.programs):  # type: ignore[union-attr]
        if each not in PROGRAMS:
            machine.control.programs.delete(each)  # type: ignore[union-attr]
        else:
            device.programs.register(int(each[1:]), PROGRAMS[each])
    rig.operate("select_program", program="O0012")
    rig.operate("set_offset", name="G54", values={"X": 0.0, "Y": 0.0, "Z": 0.0})


def run(rig: Rig, cycles: int = 300) -> None:
    rig.operate("cycle_start")
    rig.pass_time(cycles)


def hold(rig: Rig) -> None:
    run(rig)
    rig.operate("feed_hold")
    rig.pass_time(300)


def mode(name: str) -> Callable[[Rig], None]:
    return lambda rig: rig.operate("select_mode", mode=name)


def mdi_runs(rig: Rig) -> None:
    rig.operate("select_mode", mode="mdi")
    rig.operate("set_mdi", text=LONG_MDI)
    run(rig)


def jogs(rig: Rig) -> None:
    rig.operate("select_mode", mode="jog")
    rig.operate("jog", axis="Y", direction=1)
    rig.pass_time(100)


STATES: dict[str, Callable[[Rig], None]] = {
    "ready": lambda rig: None,
    "running": run,
    "held": hold,
    "program stop": lambda rig: run(rig, 1500),
    "alarm": lambda rig: rig.device.raise_alarm(10, "WRONG"),
    "emergency stop": lambda rig: rig.operate("emergency_stop"),
    "MDI": mode("mdi"),
    "MDI runs": mdi_runs,
    "edit": mode("edit"),
    "jog": jogs,
    "key": lambda rig: rig.device.protect_key(True),
    "protected": lambda rig: rig.machine.parameters.set("3202", 17),
    "stop signal": lambda rig: rig.machine.signals.set("G8", 16),
    "machine lock": lambda rig: rig.operate("set_switches", machine_lock=True),
}
Seen = Callable[[Rig], Awaitable[bool]]


@dataclass(frozen=True)
class Write:
    """A write: how it is done (it tells whether it was accepted), how another door shows it, what it may change."""

    do: Callable[[Rig], Awaitable[bool]]
    seen: Seen
    touches: str


def focas(code: int, *arguments: int, data: bytes = b"", target: int = 1) -> Callable[[Rig], Awaitable[bool]]:
    async def do(rig: Rig) -> bool:
        return rig.ask(code, *arguments, data=data, target=target)[0] == 0

    return do


def rest(method: str, path: str, **given: Any) -> Callable[[Rig], Awaitable[bool]]:
    async def do(rig: Rig) -> bool:
        answer = await rig.client.request(method, path, **given)
        assert answer.status_code < 500, answer.text
        return bool(answer.status_code < 300)

    return do


def command(name: str, **given: Any) -> Callable[[Rig], Awaitable[bool]]:
    return rest("POST", "/commands", json={"command": name, **given})


def download(text: bytes) -> Callable[[Rig], Awaitable[bool]]:
    async def do(rig: Rig) -> bool:
        return rig.download(text)

    return do


def by_rest(path: str, wanted: Callable[[Any], bool]) -> Seen:
    async def seen(rig: Rig) -> bool:
        return wanted(await rig.get(path))

    return seen


def by_focas(wanted: Callable[[Rig], bool]) -> Seen:
    async def seen(rig: Rig) -> bool:
        return wanted(rig)

    return seen


def has_text(name: str, text: str | None) -> Seen:
    async def seen(rig: Rig) -> bool:
        answer = await rig.client.get(f"/programs/{name}")
        return (answer.text if answer.status_code == 200 else None) == text

    return seen


def status(wanted: Callable[[dict[str, Any]], bool]) -> Seen:
    """See by REST, within one cycle."""

    async def seen(rig: Rig) -> bool:
        rig.pass_time(1)
        return wanted(await rig.get("/status"))

    return seen


def statinfo(place: int, wanted: int) -> Seen:
    """See a word of the state by FOCAS, within one cycle."""

    def seen(rig: Rig) -> bool:
        rig.pass_time(1)
        return rig.ask(0x19)[1][2 * place : 2 * place + 2] == wanted.to_bytes(2, "big")

    return by_focas(seen)


def number(value: float) -> bytes:
    return bytes(Value8.of(value, 3))


def one_of(rows: list[dict[str, Any]], name: str) -> Any:
    return next((each["value"] for each in rows if each["name"] == name), None)


def path(name: bytes) -> bytes:
    return (FOLDER + name).ljust(256, b"\0")


MOVES = "status signals alarms variables cursor parameters"
"""What anything may change that starts, stops or moves."""
MEMORY, CHOICE, ZERO = "programs directory", "status selected cursor", "offsets parameters"
AUT, RUN, START, STOPPED = 0, 1, 3, 0
WRITES = {
    "wrmacro": Write(focas(0x16, 500, 501, data=number(1.5) + number(-2.25)),
        by_rest("/variables", lambda rows: (one_of(rows, "#500"), one_of(rows, "#501")) == (1.5, -2.25)), "variables"),
    "wrmacro of a local variable": Write(focas(0x16, 33, 33, data=number(1.5)),
        by_rest("/variables/33", lambda row: row["value"] == 1.5), "variables"),
    "wrmacro of an offset": Write(focas(0x16, 5221, 5222, data=number(3.5) + number(4.5)),
        by_rest("/offsets", lambda rows: (rows["G54"]["X"], rows["G54"]["Y"]) == (3.5, 4.5)), f"{ZERO} status"),
    "wrmacro of an offset and more": Write(focas(0x16, 5221, 5222, data=number(3.5) + number(99999.0)),
        by_rest("/offsets", lambda rows: rows["G54"]["Y"] == 99999.0), f"{ZERO} status"),
    "wrmacror2": Write(focas(0xA8, 502, 1, data=struct.pack(">d", 7.125)),
        by_rest("/variables/502", lambda row: row["value"] == 7.125), "variables"),
    "wrmacror2 of too much": Write(focas(0xA8, 502, 1, data=struct.pack(">d", 1e300)),
        by_rest("/variables/502", lambda row: row["value"] == 1e300), "variables"),
    "wrtofs": Write(focas(0x09, 3, 3, 0, data=struct.pack(">iHh", 1234, 0, -1)),
        by_rest("/tools", lambda rows: rows["3"]["length_mm"] == 1.234), "tools"),
    "wrtofs of too much": Write(focas(0x09, 3, 3, 0, data=struct.pack(">iHh", 2**31 - 1, 0, -1)),
        by_rest("/tools", lambda rows: rows["3"]["length_mm"] > 1e6), "tools"),
    "wrzofs": Write(focas(0x0C, 2, 2, 1, data=struct.pack(">iHh", -2500, 0, -1)),
        by_rest("/offsets", lambda rows: rows["G55"]["X"] == -2.5), ZERO),
    "pmc_wrpmcrng": Write(focas(0x8002, 100, 100, 5, 0, data=b"\x5a", target=2),
        by_rest("/signals/R100", lambda row: row["value"] == 0x5A), "signals"),
    "pmc_wrpmcrng of F": Write(focas(0x8002, 100, 100, 1, 0, data=b"\x5a", target=2),
        by_rest("/signals/F100", lambda row: row["value"] == 0x5A), "signals"),
    "override by a signal": Write(focas(0x8002, 12, 12, 0, 0, data=bytes([255 - 70]), target=2),
        status(lambda now: now["overrides"]["feed"] == 0.7), "signals status"),
    "emergency stop by a signal": Write(focas(0x8002, 8, 8, 0, 0, data=b"\x20", target=2),
        status(lambda now: now["emergency"] == "on"), MOVES),
    "start": Write(focas(0x01), status(lambda now: now["channels"][0]["run_state"] == "active"), MOVES),
    "search": Write(focas(0x03, 13), status(lambda now: now["channels"][0]["program"] == "O0013"), CHOICE),
    "slctmain": Write(focas(0xBA, data=path(b"O13")),
        status(lambda now: now["channels"][0]["program"] == "O0013"), CHOICE),
    "delete": Write(focas(0x05, 13), has_text("O0013", None), MEMORY),
    "delete of the selected one": Write(focas(0x05, 12), has_text("O0012", None), MEMORY),
    "delete of 9001": Write(focas(0x05, 9001), has_text("O9001", None), MEMORY),
    "pdf_add": Write(focas(0xB5, 0, data=path(b"O77")), has_text("O0077", "O0077\n"), MEMORY),
    "pdf_add elsewhere": Write(focas(0xB5, 0, data=path(b"../O77")), has_text("O0077", "O0077\n"), MEMORY),
    "pdf_del": Write(focas(0xB6, data=path(b"O13")), has_text("O0013", None), MEMORY),
    "settimer": Write(focas(0x46, 0, data=struct.pack(">6H", 2031, 5, 6, 0, 0, 0)),
        status(lambda now: now["now"].startswith("2031-05-06")), "status"),
    "settimer of no date": Write(focas(0x46, 0, data=struct.pack(">6H", 2031, 2, 30, 0, 0, 0)),
        status(lambda now: now["now"].startswith("2031-02-30")), "status"),
    "download": Write(download(b"\nO55\nG1X1\nM30\n%"), has_text("O0055", "O0055\nG1X1\nM30\n"), MEMORY),
    "download of two": Write(download(b"\nO56\nM30\nO12\nM30\n%"), has_text("O0056", "O0056\nM30\n"), MEMORY),
    "PUT a program": Write(rest("PUT", "/programs/O0055", content="%\nO0055\nG4 X1.\nM30\n%\n"),
        by_focas(lambda rig: rig.upload(b"O55") == b"%\nO0055\nG4 X1.\nM30\n%"), MEMORY),
    "PUT one without a number": Write(rest("PUT", "/programs/O0055", content="\ufeffG4 X1.\r\nM30\r\n"),
        by_focas(lambda rig: rig.upload(b"O55") == b"%\nO0055\nG4 X1.\nM30\n%"), MEMORY),
    "PUT one of another number": Write(rest("PUT", "/programs/O0055", content="O0099\nM30\n"),
        by_focas(lambda rig: rig.upload(b"O55") == b"%\nO0055\nM30\n%"), MEMORY),
    "PUT one in UTF-16": Write(rest("PUT", "/programs/O0055", content="M30\n".encode("utf-16")),
        by_focas(lambda rig: rig.upload(b"O55") == b"%\nO0055\nM30\n%"), MEMORY),
    "PUT the selected one": Write(rest("PUT", "/programs/O0012", content="O0012\nM30\n"),
        by_focas(lambda rig: rig.upload(b"O12") == b"%\nO0012\nM30\n%"), MEMORY),
    "PUT 9001": Write(rest("PUT", "/programs/O9001", content="O9001\nM30\n"),
        by_focas(lambda rig: rig.upload(b"O9001") == b"%\nO9001\nM30\n%"), MEMORY),
    "PUT a name of none": Write(rest("PUT", "/programs/%2e%2e", content="M30\n"), has_text("..", "M30\n"), ""),
    "DELETE a program": Write(rest("DELETE", "/programs/O0013"), by_focas(lambda rig: not rig.upload(b"O13")),
        MEMORY),
    "DELETE the selected one": Write(rest("DELETE", "/programs/O0012"), by_focas(lambda rig: not rig.upload(b"O12")),
        MEMORY),
    "DELETE 9001": Write(rest("DELETE", "/programs/O9001"), by_focas(lambda rig: not rig.upload(b"O9001")),
        MEMORY),
    "PUT a parameter": Write(rest("PUT", "/parameters/1320", json={"value": {"X": 555555}}),
        by_focas(lambda rig: rig.device.parameters.value(1320, 1) == 555555), "parameters axes"),
    "PUT a variable": Write(rest("PUT", "/variables/503", json={"value": 7.5}),
        by_focas(lambda rig: rig.number(0x15, 503, 503) == 7.5), "variables"),
    "PUT a signal": Write(rest("PUT", "/signals/R101", json={"value": 77}),
        by_focas(lambda rig: rig.ask(0x8001, 101, 101, 5, 0, target=2)[1] == b"\x4d"), "signals"),
    "PUT a tool": Write(rest("PUT", "/tools/4", json={"length_mm": 1.5}),
        by_focas(lambda rig: rig.number(0x08, 4, 4, 0) == 1.5), "tools"),
    "PUT nothing of a tool": Write(rest("PUT", "/tools/4", json={}),
        by_focas(lambda rig: rig.number(0x08, 4, 4, 0) == rig.before["tools"].get("4", {}).get("length_mm", 0.0)),
        "tools"),
    "PUT an offset": Write(rest("PUT", "/offsets/G56", json={"values": {"X": 3.25}}),
        by_focas(lambda rig: rig.number(0x0B, 3, 3, 1) == 3.25), ZERO),
    "PUT too much of an offset": Write(rest("PUT", "/offsets/G56", json={"values": {"X": 3.5, "Y": 99999.0}}),
        by_focas(lambda rig: rig.number(0x0B, 3, 3, 2) == 99999.0), ZERO),
    "cycle_start": Write(command("cycle_start"), statinfo(RUN, START), MOVES),
    "cycle_start at a line": Write(command("cycle_start", line=4), statinfo(RUN, START), MOVES),
    "cycle_start at no line": Write(command("cycle_start", line=999), statinfo(RUN, START), MOVES),
    "cycle_start elsewhere": Write(command("cycle_start", channel=7), statinfo(RUN, START), MOVES),
    "reset": Write(command("reset"), statinfo(RUN, STOPPED), MOVES),
    "reset elsewhere": Write(command("reset", channel=7), statinfo(RUN, STOPPED), ""),
    "select_mode mdi": Write(command("select_mode", mode="mdi"), statinfo(AUT, 0), MOVES),
    "select_mode jog": Write(command("select_mode", mode="jog"), statinfo(AUT, 5), MOVES),
    "select_mode elsewhere": Write(command("select_mode", mode="jog", channel=7), statinfo(AUT, 99), ""),
    "select_program": Write(command("select_program", program="O0013"),
        by_focas(lambda rig: rig.ask(0xB9)[1].startswith(FOLDER + b"O13\0")), CHOICE),
    "set_overrides": Write(command("set_overrides", feed=0.55),
        by_focas(lambda rig: rig.ask(0x8001, 12, 12, 0, 0, target=2)[1] == bytes([255 - 55])), "status signals"),
    "set_overrides of too much": Write(command("set_overrides", feed=3.0, rapid=1.0), statinfo(RUN, 99), ""),
    "set_switches": Write(command("set_switches", single_block=True, machine_lock=True),
        by_focas(lambda rig: rig.ask(0x8001, 46, 46, 0, 0, target=2)[1][0] & 2 != 0), "status signals"),
    "emergency_stop": Write(command("emergency_stop"), statinfo(4, 1), MOVES),
}  # fmt: skip
"""The writes by name; those that no machine can carry out are always refused."""


async def check(rig: Rig, state: str, name: str) -> bool:
    """Do a write in a state; return whether it was accepted."""
    setup(rig)
    STATES[state](rig)
    write = WRITES[name]
    rig.before = rig.facts()
    accepted = await write.do(rig)
    after = rig.facts()
    changed = {fact for fact in after if after[fact] != rig.before[fact]}
    allowed = set(write.touches.split()) if accepted else set()
    assert changed <= allowed, (state, name, accepted, {fact: after[fact] for fact in changed - allowed})
    if accepted:
        assert await write.seen(rig), (state, name, "is not so")
    return accepted


IMPOSSIBLE = frozenset(name for name in WRITES if "too much" in name or "elsewhere" in name or " no " in name) | {
    "wrmacro of a local variable", "wrmacro of an offset and more", "pmc_wrpmcrng of F", "delete of the selected one",
    "download of two", "PUT one of another number", "PUT one in UTF-16", "PUT a name of none",
    "DELETE the selected one",
}  # fmt: skip
_ORDINARY = 25


def test_each_answer_to_a_write_is_so() -> None:
    """A part of the pairs of state and write in an ordinary run, each write in the ready state, all of them else."""
    pairs = [(state, name) for state in STATES for name in WRITES]
    random.Random(26).shuffle(pairs)
    if ALL_CASES not in os.environ:
        pairs = [("ready", name) for name in WRITES] + pairs[:_ORDINARY]

    async def visitor(client: Any, machine: ServedMachine) -> set[str]:
        rig = Rig.of(client, machine)
        return {name for state, name in pairs if await check(rig, state, name)}

    accepted = visit("fanuc", Machinery("m", axes=3), visitor)
    assert accepted == set(WRITES) - IMPOSSIBLE


@pytest.mark.parametrize("state", ["alarm", "held"])
def test_a_start_at_a_line_that_is_refused_leaves_the_cursor(state: str) -> None:
    async def visitor(client: Any, machine: ServedMachine) -> None:
        rig = Rig.of(client, machine)
        setup(rig)
        STATES[state](rig)
        with pytest.raises(ControlError):
            rig.operate("cycle_start", line=4)
        rig.operate("reset")
        rig.pass_time(1000)
        rig.operate("cycle_start")
        rig.pass_time(5)
        assert rig.device.status().channel.block.line <= 2

    visit("fanuc", Machinery("m", axes=3), visitor)
