"""A control of another dialect behind the interface of grbl: its state and its keys, no blocks.

A line of a sender means something else where programs are read in another dialect (`X10` may be 0.01 mm): each one
is refused. Status reports show the control as it is, and real-time bytes press its keys.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from polycnc.cnc import Control, ControlError, Emergency, Status
from polycnc.servers.grbl._codes import GrblAlarm, GrblError
from polycnc.servers.grbl._lines import LINE, RX_BYTES, LineReader
from polycnc.servers.grbl._overrides import override_of
from polycnc.servers.grbl._reports import HELP, PLANNER_BLOCKS, VERSION, WELCOME, StatusReport, Units
from polycnc.servers.grbl._settings import GrblSettings

_KEYS = {ord("~"): "cycle_start", ord("!"): "feed_hold", 0x18: "reset"}
_STATUS, _RESET = ord("?"), 0x18


class GrblWatch:
    """Answer one sender for a control that reads programs of its own; `press` carries commands out by their names."""

    def __init__(self, control: Callable[[], Control], press: Callable[[Mapping[str, Any]], object]) -> None:
        self._control = control
        self._press = press
        self._reader = LineReader()
        self._out: list[str] = []
        self._settings = GrblSettings(control())
        self._report = StatusReport(self._settings, Units(self._settings))
        self._alarmed = False

    @property
    def busy(self) -> bool:
        """Whether something that was begun has not ended: never."""
        return False

    def greet(self) -> bytes:
        """Return what a sender sees first."""
        self._out += ["", WELCOME, f"[MSG:{self._refusal}]"]
        self._report.begin()
        self._alarmed = False
        return self.turn()

    def receive(self, data: bytes) -> bytes:
        """Take bytes of the sender; return what it gets."""
        for byte in self._reader.read(data):
            if byte == LINE:
                self._line(self._reader.take().text)
            elif byte == _STATUS:
                self._out.append(self._status())
            elif byte in _KEYS:
                self._do({"command": _KEYS[byte]})
                if byte == _RESET:
                    self._reader.clear()
                    self._out += ["", WELCOME]
            else:
                override = override_of(byte, self._control().channel_status().overrides)
                if override:
                    self._do({"command": "set_overrides", **override})
        return self._given()

    def turn(self) -> bytes:
        """Tell an alarm that has come."""
        alarms = self._control().alarms.active
        if alarms and not self._alarmed:
            number = GrblAlarm.ABORTED if "emergency" in alarms[0].name else GrblAlarm.HARD_LIMIT
            self._out += [f"[MSG:{alarms[0].text}]", f"ALARM:{int(number)}"]
        self._alarmed = bool(alarms)
        return self._given()

    @property
    def _refusal(self) -> str:
        return f"Blocks are not taken: programs are read in dialect {self._control().dialect.name}"

    def _given(self) -> bytes:
        given = "".join(line + "\r\n" for line in self._out).encode("ascii", "replace")
        self._out.clear()
        return given

    def _line(self, text: str) -> None:
        match text:
            case "":
                pass
            case "$":
                self._out.append(HELP)
            case "$I":
                self._out.append(f"[VER:{VERSION}.polycnc:{self._control().machine.config.name}]")
                self._out.append(f"[OPT:VM,{PLANNER_BLOCKS},{RX_BYTES}]")
            case _:
                self._out += [f"[MSG:{self._refusal}]", f"error:{int(GrblError.UNSUPPORTED)}"]
                return
        self._out.append("ok")

    def _do(self, asked: Mapping[str, Any]) -> None:
        try:
            self._press(asked)
        except ControlError as error:
            self._out.append(f"[MSG:{error.what}]")

    def _status(self) -> str:
        control = self._control()
        status = control.status()
        state = state_of(status, braking=not control.channels[0].at_rest)
        return self._report.text(state, status, self._zero(status), self._reader.free, 0, "", "")

    def _zero(self, status: Status) -> tuple[float, ...]:
        """Return program zero in machine coordinates."""
        axes = (status.axes[name] for name in self._settings.names)
        return tuple(axis.machine - axis.work for axis in axes)


def state_of(status: Status, *, braking: bool) -> str:
    """Return the state that a status report names."""
    channel = status.channel
    by_hand = {axis.manual for axis in status.axes.values()}
    if status.alarms or status.emergency is not Emergency.OFF:
        return "Alarm"
    if "reference" in by_hand:
        return "Home"
    if by_hand - {"none"}:
        return "Jog"
    if channel.interrupted:
        return "Hold:1" if braking else "Hold:0"
    if channel.switches.machine_lock:
        return "Check"
    return "Run" if braking or (channel.active and not channel.starved) else "Idle"
