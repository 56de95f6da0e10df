"""Carry out a trace once more, on another machine, at the same machine times, and compare the answers."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from polycnc.controllers.library.clib import Call
from polycnc.errors import UsageError
from polycnc.machine import Device
from polycnc.servers.calls._caller import Caller
from polycnc.servers.calls._frames import CallError
from polycnc.servers.calls._trace import given_of, outputs

_MOST_LINE = 1 << 20
_HINT = "Replay a file of --trace."
_MOST_S = 1e6
_LATE = 1e-6  # cycles that rounding may be short of


@dataclass(frozen=True, slots=True)
class Replayed:
    """A call of a trace, on its line from 1: what the trace says, and what came."""

    line: int
    call: str
    expected: tuple[Any, Any]
    """Code and outputs."""
    came: tuple[Any, Any]

    @property
    def is_equal(self) -> bool:
        """Whether both are the same."""
        return json.dumps(self.expected) == json.dumps(self.came)  # a number that is none equals itself


def replay(path: Path, device: Device[Any], make: Callable[[], Caller]) -> Iterator[Replayed]:
    """Carry out the calls of a trace on a device, each client with a caller of its own that `make` returns.

    Raises:
        UsageError: The file cannot be read, or a line is none of a trace; what comes before it is carried out.
    """
    callers: dict[int, Caller] = {}
    table: dict[str, Call] = {}
    for number, text in _lines(path):
        place = f"{path}:{number}"
        try:
            row = json.loads(text)
            time_s, client, name = float(row["time_s"]), int(row["client"]), str(row["call"])
            caller = callers.get(client) or callers.setdefault(client, make())
            table = table or {each.function.name: each for each in caller.library.calls}
            if name not in table:
                raise UsageError(
                    f"{place}: {caller.library.name} has no function '{name[:60]}'",
                    hint="Name the kind that the trace was made with.",
                )
            given = given_of(table[name], row["in"], row.get("room", {}))
            expected = row["code"], row["out"]
        except (AttributeError, KeyError, TypeError, ValueError, OverflowError) as error:
            raise UsageError(f"{place}: no line of a trace: {error}"[:300], hint=_HINT) from None
        _pass(device, time_s, place)
        try:
            done = caller.carry_out_given(table[name], given)
        except CallError as error:
            raise UsageError(f"{place}: {error}", hint=_HINT) from None
        yield Replayed(number, name, expected, (done.code, outputs(given, done)))


def _pass(device: Device[Any], time_s: float, place: str) -> None:
    """Let time pass until it is this late."""
    clock = device.clock
    if not clock.now_s - clock.cycle_s * 0.5 <= time_s <= clock.now_s + _MOST_S:
        raise UsageError(
            f"{place}: the time {time_s:g} s is before that of another call", hint="Replay a whole trace."
        )
    while (due := round((time_s - clock.now_s) / clock.cycle_s + _LATE)) > 0:
        if not device.advance(due):
            raise UsageError(
                f"{place}: the machine's time does not pass", hint="Replay it on another machine."
            )


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    try:
        with path.open(encoding="utf-8") as file:
            number = 0
            while text := file.readline(_MOST_LINE):
                number += 1
                if len(text) == _MOST_LINE:
                    raise UsageError(
                        f"{path}:{number}: a line of more than {_MOST_LINE} characters",
                        hint=_HINT,
                    )
                if text.strip():
                    yield number, text
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "it is no text"
        raise UsageError(f"{path}: cannot be read: {why}", hint="Name a file of --trace.") from None
