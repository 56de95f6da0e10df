"""What only some machines have, by REST: PMC addresses, the memory of a card, a screen with keys, tasks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from polycnc.servers.machines import ServedMachine
from polycnc.servers.process import Machinery
from support.http_app import visit


async def refused(asked: Any, status: int) -> str:
    """Await an answer that refuses, and return what it says."""
    answer = await asked
    assert answer.status_code == status, answer.text
    said = answer.json()
    assert said["hint"]
    return str(said["detail"])


def test_addresses_of_the_pmc_are_those_of_the_library_and_g_signals_act_at_once() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        mate: Any = machine.device
        override = (await client.put("/signals/G12", json={"value": 255 - 35})).json()
        assert override["value"] == 220
        assert (await client.get("/status")).json()["overrides"]["feed"] == 0.35
        await client.put("/signals/D1859", json={"value": 77})
        await client.put("/signals/X9", json={"value": 5})
        assert mate.pmc.read("D", 1859, 1859) + mate.pmc.read("X", 9, 9) == bytes([77, 5])
        found = {each["name"]: each["value"] for each in (await client.get("/signals")).json()}
        assert found["D1859"] == 77
        assert 0 not in found.values()
        some = (await client.get("/signals", params={"names": "R7,X9"})).json()
        assert [(each["name"], each["value"], each["writable"]) for each in some] == [
            ("R7", 0, True),
            ("X9", 5, True),
        ]
        before = (await client.get("/signals")).json()
        for name in ("F7", "R9000", "K18"):
            assert "only be read" in await refused(client.put(f"/signals/{name}", json={"value": 3}), 403)
        for value in (256, -1, 2.5, True, "3", None, {"X": 3}):
            await refused(client.put("/signals/R7", json={"value": value}), 409)
        for name in ("R1000", "Q3", "g12", "G", "R-1", "D99999", "G1.5"):
            await refused(client.get(f"/signals/{name}"), 404)
        assert (await client.get("/signals")).json() == before

    visit("fanuc", Machinery("m"), ask)


def test_the_memory_of_a_card_is_read_and_written_by_name() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        card: Any = machine.device
        rows = {row["name"]: row for row in (await client.get("/parameters")).json()}
        assert set(rows["curpos"]["value"]) == {str(axis) for axis in range(card.axes)}
        assert rows["curpos"]["writable"] is False
        assert "clear" not in rows  # a write acts, there is nothing to read
        written = await client.put("/parameters/mcsmaxvel", json={"value": {"1": 12.25}})
        assert written.json()["value"]["1"] == 12.25
        assert card.read("mcsmaxvel", 1) == 12.25
        before = [
            (await client.get(f"/parameters/{name}")).json() for name in ("mcsmaxvel", "status", "stopfilt")
        ]
        await refused(client.put("/parameters/curpos", json={"value": {"1": 3}}), 403)
        for value in (3, {"99": 3}, {"x": 3}, {"1": 4e5}, {"0": 3, "99": 3}, {"1": -1e9}):
            await refused(client.put("/parameters/mcsmaxvel", json={"value": value}), 409)
        await refused(client.put("/parameters/mcsmaxvel", json={"value": {"1": "3"}}), 422)
        await refused(client.get("/parameters/nothing"), 404)
        await refused(client.get("/signals"), 404)
        await refused(client.get("/inventory"), 404)
        after = [
            (await client.get(f"/parameters/{name}")).json() for name in ("mcsmaxvel", "status", "stopfilt")
        ]
        assert after == before

    visit("imc", Machinery("m"), ask)


def test_a_program_of_cpl_writes_on_the_screen_and_gets_the_keys_that_are_pressed(tmp_path: Path) -> None:
    root = tmp_path / "root"
    root.mkdir()
    (root / "ask.npg").write_text(
        '10 PRN(4,6,"WHICH TOOL <3>?")\n20 #C%=0\n30 REPEAT\n40 #C%=INKEY\n50 UNTIL #C%<>0\n'
        '60 SFK(#K%,"LEFT","RIGHT")\nM30\n'
    )

    async def ask(client: Any, machine: ServedMachine) -> None:
        machine.device.select_program("ask.npg")  # type: ignore[attr-defined]
        machine.device.cycle_start()  # type: ignore[attr-defined]
        machine.device.advance(300)
        shown = (await client.get("/screen")).json()
        assert any("WHICH TOOL <3>?" in line for line in shown["lines"])
        assert "ENTER" in shown["keys"]
        picture = await client.get("/screen.svg")
        assert picture.headers["content-type"] == "image/svg+xml"
        assert "&lt;" in picture.text
        await refused(client.post("/screen", json={"key": "NO SUCH KEY"}), 409)
        await refused(client.post("/screen", json={"key": "3", "channel": 7}), 409)
        await refused(client.post("/screen", json={"key": ""}), 422)
        assert (await client.post("/screen", json={"key": "3"})).status_code == 200
        machine.device.advance(3000)
        assert machine.device.variables()["#C%"] == ord("3")  # type: ignore[attr-defined]
        assert "waits for" in await refused(client.post("/snapshot", json={}), 409)

    visit("bosch", Machinery("m", memory=root), ask)


def test_a_program_that_is_put_into_a_bosch_control_is_selected_and_started(tmp_path: Path) -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        async def command(name: str, **given: Any) -> int:
            answer = await client.post("/commands", json={"command": name, **given})
            return int(answer.status_code)

        assert (await client.put("/programs/PART.npg", content="N10 G4 F9\nM30\n")).status_code == 201
        (tmp_path / "ROOT.npg").write_text("N10 G4 F9\nM30\n")
        for name in ("ROOT.npg", "PART.npg"):
            assert await command("select_program", program=name) == 200
            assert await command("cycle_start") == 200
            machine.served.advance(20)
            shown = (await client.get("/status")).json()["channels"][0]
            assert (shown["program"], shown["run_state"]) == (name, "active")
            if name == "PART.npg":
                assert (await client.delete(f"/programs/{name}")).status_code == 409
            assert await command("reset") == 200
            machine.served.advance(20)
        assert (await client.delete("/programs/PART.npg")).status_code == 204
        assert await command("select_program", program="PART.npg") == 404

    visit("bosch", Machinery("m", memory=tmp_path), ask)


def test_tasks_of_a_board_are_loaded_started_and_stopped() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        empty = (await client.get("/tasks")).json()
        assert [each["state"] for each in empty] == ["no program"] * 4
        assert "cannot start" in await refused(client.post("/tasks/2", json={"do": "start"}), 409)
        wrong = await refused(client.put("/tasks/2", content=b"BEGIN CI7 := ; END."), 409)
        assert "1:" in wrong
        source = b"BEGIN\nWHILE TRUE DO\nCI7 := CI7 + 1\nEND."
        loaded = (await client.put("/tasks/2", content=source)).json()
        assert [each["state"] for each in loaded] == ["no program", "no program", "idle", "no program"]
        started = (await client.post("/tasks/2", json={"do": "start"})).json()
        assert started[2]["state"] == "running"
        machine.device.advance(50)
        assert (await client.get("/tasks")).json()[2]["line"] in (2, 3)
        stopped = (await client.post("/tasks/2", json={"do": "stop"})).json()
        assert stopped[2]["state"] == "stopped"
        await refused(client.post("/tasks/2", json={"do": "stop"}), 409)
        assert (await client.post("/tasks/2", json={"do": "continue"})).json()[2]["state"] == "running"
        await refused(client.post("/tasks/4", json={"do": "start"}), 404)
        await refused(client.put("/tasks/7", content=source), 404)
        await refused(client.post("/tasks/2", json={"do": "halt"}), 422)
        await refused(client.put("/tasks/2", content=b"\xff\xfe"), 422)
        await refused(client.put("/tasks/2", content=b" " * (1 << 20 | 1)), 413)
        assert (await client.get("/tasks")).json()[2]["state"] == "running"
        division = b"VAR i: INTEGER;\nBEGIN\ni := 0;\nCI7 := 5 DIV i\nEND."
        await client.put("/tasks/1", content=division)
        await client.post("/tasks/1", json={"do": "start"})
        machine.device.advance(50)
        failed = (await client.get("/tasks")).json()[1]
        assert failed["error"]
        assert failed["error_line"] == 4
        await refused(client.get("/screen"), 404)

    visit("apci", Machinery("m"), ask)


def test_each_kind_of_machine_says_what_it_has(tmp_path: Path) -> None:
    parts = {
        "plain": ["control", "path", "parameters", "variables", "signals"],
        "fanuc": ["control", "path", "parameters", "variables", "signals"],
        "bosch": ["control", "parameters", "variables", "signals", "screen"],
        "apci": ["tasks"],
        "imc": ["parameters"],
    }
    for kind, has in parts.items():

        async def ask(client: Any, machine: ServedMachine, has: list[str] = has) -> None:
            (told,) = (await client.get("http://localhost/api/machines")).json()
            assert told["parts"] == has
            for part in ("screen", "tasks", "signals"):
                if part not in has:
                    await refused(client.get(f"/{part}"), 404)

        visit(kind, Machinery("m", memory=tmp_path / kind), ask)
