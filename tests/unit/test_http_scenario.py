"""Programs are checked and scenarios are begun by HTTP: what is wrong has its place, and changes nothing."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate
from polycnc.servers.focas import FaultKind, FocasServer, PresentFaults, load_profile
from polycnc.servers.machines import ServedMachine
from polycnc.servers.process import Machinery
from support.http_app import visit

PLAIN, FANUC = Machinery("m", "mill3"), Machinery("m")
DAY = """title = "Tuesday"
[[step]]
name = "stop"
do = "emergency_stop"
at_s = 0.25
for_s = 0.5
[[step]]
name = "slow"
do = "set_overrides"
with = { feed = 0.37 }
at_s = 0.25
"""
FAR = '[[step]]\nname = "away"\ndo = "drop"\ndoor = "focas"\nat_s = 0.0\nfor_s = 3.0\n'


async def step(client: Any, cycles: int) -> Any:
    assert (await client.post("/clock", json={"step": cycles})).status_code == 200
    return (await client.get("/scenario")).json()


@pytest.mark.parametrize(
    ("machinery", "kind", "text", "places"),
    [
        (PLAIN, "plain", "G1 X7 F300\nG2 X9 R0.5\nG1 X5 Y\nM98 P13\nM30\n", [(2, 7), (3, 7)]),
        (FANUC, "fanuc", "O7\n#1=3.\nG1 X[#500*2.] F600.\nG1 X#1 Q[\nM30\n", [(4, 10)]),
        (FANUC, "fanuc", "O7\nG1 X[#501] F600.\nM30\n", []),
    ],
)
def test_a_text_is_checked_as_a_program(
    machinery: Machinery, kind: str, text: str, places: list[Any]
) -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        await client.put("/programs/O0013", content=b"O13\nG1 Y7\nM99\n")
        before = (await client.get("/status")).json(), (await client.get("/inventory")).json()
        found = (await client.post("/check", params={"program": "O0007"}, content=text)).json()
        assert [(each["line"], each["column"]) for each in found] == places, found
        assert all(each["text"] and each["hint"] for each in found)
        assert ((await client.get("/status")).json(), (await client.get("/inventory")).json()) == before
        assert (await client.post("/check", content=b"x" * ((1 << 20) + 1))).status_code == 413

    visit(kind, machinery, ask)


def test_an_error_of_a_sub_program_has_no_line_of_the_text() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        await client.put("/programs/O0013", content=b"O13\nG1 Y[\nM99\n")
        (found,) = (await client.post("/check", content="G1 X7 F300\nM98 P13\nM30\n")).json()
        assert found["line"] == 0
        assert found["text"].startswith("O0013:2:")

    visit("plain", PLAIN, ask)


def test_statements_of_cpl_are_checked_with_the_programs_of_the_control(tmp_path: Path) -> None:
    root = tmp_path / "root"
    root.mkdir()
    (root / "sub.npg").write_text("N1 G1 X3\nM30\n")

    async def ask(client: Any, machine: ServedMachine) -> None:
        good = "10 A%=3\n20 CALL sub.npg\nM30\n"
        assert (await client.post("/check", content=good)).json() == []
        found = (await client.post("/check", content="10 A%=3\n20 B%=A%*\n30 CALL none.npg\nM30\n")).json()
        assert {2, 3} <= {each["line"] for each in found}, found
        assert (await client.post("/check", content="N1 G1 X3 F200\nN2 G2 X9 Y3 I2\nM30\n")).json()[0][
            "line"
        ] == 2
        assert (await client.post("/check", content="N1 G1 X3 F200\nM30\n")).json() == []

    visit("bosch", Machinery("m", memory=root), ask)


def test_a_scenario_is_begun_followed_and_ended() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        assert (await client.get("/scenario")).json()["steps"] == []
        assert (await client.post("/scenario", json={"do": "start"})).status_code == 404
        await step(client, 300)
        shown = (await client.put("/scenario", content=DAY)).json()
        assert shown["source"] == DAY
        assert (shown["title"], shown["running"], shown["happened"]) == ("Tuesday", True, [])
        assert shown["steps"][1]["step"]["with"] == {"feed": 0.37}
        assert (await step(client, 249))["happened"] == []
        shown = await step(client, 2)
        assert [(each["done"], each["on"]) for each in shown["steps"]] == [(1, True), (1, True)]
        assert [(each["cycle"], each["what"]) for each in shown["happened"]] == [(550, "began")] * 2
        status = (await client.get("/status")).json()
        assert (status["emergency"], status["overrides"]["feed"]) == ("on", 0.37)
        ended = (await client.post("/scenario", json={"do": "stop"})).json()
        assert (ended["running"], [each["on"] for each in ended["steps"]]) == (False, [False, False])
        status = (await client.get("/status")).json()
        assert (status["emergency"] != "on", status["overrides"]["feed"]) == (True, 1.0)
        again = (await client.post("/scenario", json={"do": "start"})).json()
        assert (again["running"], again["steps"][0]["done"]) == (True, 0)
        assert (await step(client, 251))["steps"][0]["on"]

    visit("plain", PLAIN, ask)


def test_a_wrong_scenario_is_refused_with_its_place_and_the_one_before_goes_on() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        await client.put("/scenario", content=DAY)
        for text, place in ((DAY.replace("for_s", "for"), ":6:"), ("[[step]]\nname = \n", ":2:")):
            answer = await client.put("/scenario", content=text)
            assert answer.status_code == 409
            assert place in answer.json()["errors"][0]
        wrong = await client.put(
            "/scenario", content=FAR.replace("drop", "power_cut").replace("for_s = 3.0\n", "")
        )
        assert wrong.status_code == 409
        shown = await step(client, 260)
        assert (shown["source"], shown["running"], shown["steps"][0]["done"]) == (DAY, True, 1)

    visit("plain", PLAIN, ask)


def test_a_scenario_that_is_begun_later_acts_on_the_connections_of_focas() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        faults = PresentFaults(lambda: machine.served.scenario)
        told: list[bool] = []
        machine.served.on_scenario(lambda: told.append(faults.knows(FaultKind.DROP)))
        assert machine.is_usual
        assert not faults.has(FaultKind.DROP)
        await client.put("/scenario", content=FAR)
        await step(client, 10)
        assert faults.has(FaultKind.DROP)
        assert isinstance(machine.device, PowerMate)
        assert faults.request(machine.device).kind is FaultKind.DROP
        await client.post("/scenario", json={"do": "stop"})
        assert (faults.has(FaultKind.DROP), machine.is_usual, told) == (False, True, [True, False])

    visit("fanuc", FANUC, ask)


def test_a_door_that_listens_follows_a_scenario_that_is_begun_later() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        door = FocasServer.of(machine, load_profile("31i"), address="127.0.0.1", port=0)
        await door.start()

        async def comes(wanted: bool) -> None:
            for _ in range(1000):
                try:
                    _, line = await asyncio.open_connection("127.0.0.1", door.port)
                except OSError:
                    listens = False
                else:
                    listens = True
                    line.close()
                if listens is wanted:
                    return
                await asyncio.sleep(0.01)
            raise AssertionError(f"it does not come to {wanted}")

        try:
            await comes(True)
            await client.put("/scenario", content=FAR.replace("drop", "unreachable"))
            await step(client, 10)
            await comes(False)
            await client.post("/scenario", json={"do": "stop"})
            await comes(True)
        finally:
            await door.close()

    visit("fanuc", FANUC, ask)
