"""Two people at one machine: nobody loses what was acknowledged, no stop is lost, and time goes on."""

from __future__ import annotations

import asyncio
import os
import random
from collections.abc import Callable
from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate
from polycnc.servers.machines import ServedMachine
from polycnc.servers.process import Machinery
from support.http_app import visit
from support.often import ALL_CASES

TURNS = 40
SEEDS = range(60 if ALL_CASES in os.environ else 2)
MODES = ("auto", "mdi", "jog", "edit")


class Seen:
    """What was acknowledged last: a stop that holds until a start, the emergency stop, values by who wrote them."""

    def __init__(self) -> None:
        self.stopped = self.emergency = False
        self.kept: dict[str, Any] = {}


class Person:
    """One of them: commands as chance says; variables, an offset, a tool and a program are this person's alone."""

    def __init__(self, number: int, client: Any, machine: ServedMachine, seen: Seen, seed: int) -> None:
        self._client, self._machine, self._seen = client, machine, seen
        self._chance = random.Random(10 * seed + number)
        self._program = f"O006{number}"
        self._own: dict[str, tuple[str, Callable[[Any], Any]]] = {
            f"/variables/%2350{number}": ("value", lambda told: told["value"]),
            f"/offsets/G5{4 + number}": ("X", lambda told: told[f"G5{4 + number}"]["X"]),
            f"/tools/{1 + number}": ("length_mm", lambda told: told[str(1 + number)]["length_mm"]),
        }

    async def work(self) -> None:
        for _ in range(TURNS):
            for _ in range(self._chance.randrange(4)):
                await asyncio.sleep(0)  # the other one, and answers, come in between
            await self._chance.choice((self._command, self._command, self._write, self._look, self._edit))()

    async def _ask(self, method: str, path: str, **given: Any) -> Any:
        answer = await self._client.request(method, path, **given)
        assert answer.status_code < 500, answer.text
        return answer

    async def _command(self) -> None:
        name = self._chance.choice(
            ("cycle_start", "feed_hold", "reset", "select_mode", "select_program", "emergency_stop", "")
        )
        if not name:
            self._machine.served.advance(self._chance.randrange(400))
            return
        given: dict[str, Any] = {"command": name}
        if name == "select_mode":
            given["mode"] = self._chance.choice(MODES)
        if name == "select_program":
            given["program"] = f"O006{self._chance.randrange(2)}"
        if name == "emergency_stop":
            given["on"] = self._chance.random() < 0.4
        if (await self._ask("POST", "/commands", json=given)).status_code < 300:
            if name == "emergency_stop":
                self._seen.emergency = given["on"]
            if name in ("cycle_start", "feed_hold", "reset"):
                self._seen.stopped = name != "cycle_start"

    async def _write(self) -> None:
        path = self._chance.choice(tuple(self._own))
        value = self._chance.randrange(1000) / 8
        field = self._own[path][0]
        given = {"values": {field: value}} if field == "X" else {field: value}
        if (await self._ask("PUT", path, json=given)).status_code < 300:
            self._seen.kept[path] = value

    async def _edit(self) -> None:
        text = f"{self._program}\nG91 G1 X{self._chance.randrange(9)}. F600.\nG4 X2.\nM30\n"
        method = self._chance.choice(("PUT", "PUT", "DELETE"))
        given = {"content": text} if method == "PUT" else {}
        if (await self._ask(method, f"/programs/{self._program}", **given)).status_code < 300:
            self._seen.kept[self._program] = text if method == "PUT" else None

    async def _look(self) -> None:
        for path, (_, value) in self._own.items():
            if path in self._seen.kept:
                told = await self._ask("GET", path if "variables" in path else path.rpartition("/")[0])
                assert value(told.json()) == self._seen.kept[path], path
        if self._program in self._seen.kept:
            answer = await self._ask("GET", f"/programs/{self._program}")
            there = answer.text if answer.status_code == 200 else None
            assert there == self._seen.kept[self._program]


@pytest.mark.parametrize("kind", ["plain", "fanuc"])
def test_nobody_loses_what_was_acknowledged(kind: str) -> None:
    async def visitor(client: Any, machine: ServedMachine) -> None:
        control, seen, device = machine.control, Seen(), machine.device
        assert control is not None
        if isinstance(device, PowerMate):
            device.protect_key(False)
        for seed in SEEDS:
            cycle = control.status().cycle
            await asyncio.gather(*(Person(n, client, machine, seen, seed).work() for n in range(2)))
            machine.served.advance(700)
            status = control.status()
            assert not (seen.stopped and status.channel.active), seed
            assert (status.emergency == "on") is seen.emergency, seed
            assert status.cycle > cycle + 600, seed
        assert len(seen.kept) >= 6

    visit(kind, Machinery("m", None if kind == "fanuc" else "mill3"), visitor)
