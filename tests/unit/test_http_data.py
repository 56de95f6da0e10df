"""What REST shows and sets by name: parameters, variables, tools, offsets, clocks, snapshots, paths."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from polycnc.servers.machines import ServedMachine
from polycnc.servers.process import Machinery
from support.http_app import Slow, visit

PLAIN = Machinery("m", "mill3")
FANUC = Machinery("m", axes=2)
PART = b"O12\nG0 G54 X10 Y4\nG1 X30 F600\nM98 P13\nM0\nG2 X0 Y34 R30\nM30\n"


def refused(answer: Any, status: int) -> dict[str, Any]:
    """Return a refusal, which says what is wrong and what to do."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    said: dict[str, Any] = answer.json()
    assert said["status"] == status
    assert said["detail"]
    assert said["hint"]
    return said


def test_parameters_of_a_fanuc_are_read_and_written_as_its_library_does() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        rows = {row["name"]: row for row in (await client.get("/parameters")).json()}
        assert set(rows["1320"]["value"].values()) == {99999999}
        assert rows["1010"]["writable"] is False
        first = next(iter(rows["1320"]["value"]))
        written = await client.put("/parameters/1320", json={"value": {first: 123456}})
        assert written.json()["value"][first] == 123456
        assert machine.device.parameters.value(1320, 1) == 123456  # type: ignore[attr-defined]
        assert (await client.get("/parameters/1320")).json() == written.json()
        some = (await client.get("/parameters", params={"names": "20, 1010"})).json()
        assert [row["name"] for row in some] == ["20", "1010"]
        before = (await client.get("/parameters")).json()
        refused(await client.put("/parameters/1010", json={"value": 3}), 403)
        refused(await client.put("/parameters/20", json={"value": 36}), 409)
        refused(await client.put("/parameters/20", json={"value": 3.5}), 409)
        refused(await client.put("/parameters/20", json={"value": True}), 409)
        refused(await client.put("/parameters/1320", json={"value": 3}), 409)
        refused(await client.put("/parameters/1320", json={"value": {first: 5, "Q": 3}}), 409)
        refused(await client.put("/parameters/1320", json={"value": {first: 5, "more": 1}, "x": 1}), 422)
        for name in ("99999", "x", "-1", "%00", "1" * 60):
            refused(await client.get(f"/parameters/{name}"), 404)
        assert (await client.get("/parameters")).json() == before

    visit("fanuc", FANUC, ask)


def test_variables_of_a_fanuc_are_those_of_its_programs() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        assert (await client.get("/variables")).json() == []
        assert (await client.put("/variables/500", json={"value": 12.75})).json()["value"] == 12.75
        assert machine.device.macros.get(500) == 12.75  # type: ignore[attr-defined]
        machine.device.macros.set(101, -3.5)  # type: ignore[attr-defined]
        found = {row["name"]: row["value"] for row in (await client.get("/variables")).json()}
        assert found == {"#101": -3.5, "#500": 12.75}
        watched = (await client.get("/variables", params={"names": "#500,#102"})).json()
        assert [row["value"] for row in watched] == [12.75, None]
        assert (await client.put("/variables/%23500", json={"value": None})).json()["value"] is None
        refused(await client.put("/variables/500", json={"value": 1e13}), 409)
        refused(await client.put("/variables/500", json={"value": "3"}), 409)
        refused(await client.put("/variables/500", content=b'{"value": NaN}'), 422)
        refused(await client.put("/variables/7", json={"value": 3}), 403)
        refused(await client.get("/variables/77777"), 404)

    visit("fanuc", FANUC, ask)


def test_a_fanuc_has_one_offset_for_each_tool_and_its_own_work_offsets() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        assert (await client.put("/tools/7", json={"length_mm": 42.125})).status_code == 200
        assert machine.device.tool_offsets.get(7) == 42125  # type: ignore[attr-defined]
        refused(await client.put("/tools/7", json={"radius_mm": 3.0}), 409)
        refused(await client.put("/tools/100", json={"length_mm": 3.0}), 404)
        refused(await client.put("/tools/7", json={"length_mm": 1e5}), 409)
        refused(await client.put("/tools/7", json={"length_mm": 1e9}), 422)
        assert machine.device.tool_offsets.get(7) == 42125  # type: ignore[attr-defined]
        set_it = await client.put("/offsets/G55", json={"values": {"X": 12.5}})
        assert set_it.json() == {"X": 12.5}
        shifted = await client.put("/offsets/G55", json={"values": {"X": -2.25}, "add": True})
        assert shifted.json() == {"X": 10.25}
        refused(await client.put("/offsets/G60", json={"values": {"X": 1.0}}), 404)
        refused(await client.put("/offsets/G55", json={"values": {"X": 1e5}}), 409)
        refused(await client.put("/offsets/..", json={"values": {"X": 1.0}}), 404)
        assert (await client.get("/offsets")).json() == {"G55": {"X": 10.25}}

    visit("fanuc", FANUC, ask)


def test_a_plain_control_shows_what_is_set_for_it_and_sets_what_acts() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        control = machine.control
        assert control is not None
        names = {row["name"]: row["writable"] for row in (await client.get("/parameters")).json()}
        assert names["reference_required"] is True
        assert names["dry_run_mm_min"] is False
        assert (await client.put("/parameters/after_manual", json={"value": "return"})).status_code == 200
        assert control.data.after_manual.value == "return"
        assert (
            await client.put("/parameters/emergency_needs_reset", json={"value": False})
        ).status_code == 200
        await client.post("/commands", json={"command": "emergency_stop"})
        released = await client.post("/commands", json={"command": "emergency_stop", "on": False})
        assert released.json()["emergency"] == "off"
        refused(await client.put("/parameters/dry_run_mm_min", json={"value": 100.0}), 403)
        refused(await client.put("/parameters/count_parts", json={"value": 1}), 409)
        refused(await client.put("/parameters/after_manual", json={"value": "no"}), 409)
        refused(await client.get("/parameters/manual"), 404)
        refused(await client.get("/variables"), 404)

    visit("plain", PLAIN, ask)


def test_inputs_are_set_as_the_machine_would_and_outputs_are_read() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        rows = (await client.get("/signals")).json()
        assert [row["name"] for row in rows[:3]] == ["I0", "I1", "I2"]
        assert (await client.put("/signals/I13", json={"value": 1})).json()["value"] == 1
        assert (await client.put("/signals/IW7", json={"value": -4711})).status_code == 200
        io = machine.control.machine.io  # type: ignore[union-attr]
        assert (io["I13"], io["I12"], io["IW7"]) == (1, 0, -4711)
        io["O5"] = 1
        some = (await client.get("/signals", params={"names": "O5, I13"})).json()
        assert [(row["name"], row["value"], row["writable"]) for row in some] == [
            ("O5", 1, False),
            ("I13", 1, True),
        ]
        refused(await client.put("/signals/O5", json={"value": 0}), 403)
        refused(await client.put("/signals/I13", json={"value": 2}), 409)
        refused(await client.put("/signals/I13", json={"value": True}), 409)
        refused(await client.put("/signals/I64", json={"value": 1}), 404)
        assert (io["I13"], io["O5"]) == (1, 1)

    visit("plain", PLAIN, ask)


def test_values_of_a_bosch_control_can_be_read(tmp_path: Path) -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        rows = {row["name"]: row for row in (await client.get("/parameters")).json()}
        assert rows["706000010"]["value"][0] == "G1"
        assert "701000010.1" in rows
        refused(await client.put("/parameters/706000010", json={"value": 1}), 403)
        assert (await client.get("/variables")).status_code == 200

    visit("bosch", Machinery("m", memory=tmp_path / "root"), ask)


@pytest.mark.parametrize("kind", ["apci", "imc"])
def test_a_board_says_that_it_has_none(kind: str) -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        own = [] if kind == "imc" else ["parameters"]  # the memory of a card
        for part in (*own, "variables", "signals", "tools", "offsets", "programs", "path", "inventory"):
            refused(await client.get(f"/{part}"), 404)
        assert (await client.get("/status")).status_code == 200
        assert (await client.post("/clock", json={"step": 17})).json()["cycles"] == 17

    visit(kind, Machinery("m"), ask)


@pytest.mark.parametrize("kind", ["plain", "fanuc"])
def test_the_clock_freezes_steps_and_jumps_to_the_next_event(kind: str) -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        assert (await client.post("/clock", json={"rate": 2.5})).json()["rate"] == 2.5
        frozen = (await client.post("/clock", json={"freeze": True})).json()
        assert (frozen["rate"], frozen["frozen"]) == (0.0, True)
        assert (await client.post("/clock", json={"freeze": True})).json()["rate"] == 0.0
        assert (await client.post("/clock", json={"freeze": False})).json()["rate"] == 2.5
        await client.post("/clock", json={"freeze": True})
        before = (await client.get("/clock")).json()["cycles"]
        assert (await client.post("/clock", json={"step": 313})).json()["cycles"] == before + 313
        await client.put("/programs/O0012", content=b"O12\nG91 G1 X10 F600\nM0\nX5\nM30\n")
        for command in (
            {"command": "select_mode", "mode": "auto"},
            {"command": "select_program", "program": "O0012"},
            {"command": "cycle_start"},
        ):
            assert (await client.post("/commands", json=command)).status_code == 200
        runs = {"active"}
        for _ in range(20):
            await client.post("/clock", json={"jump": 100_000})
            state = (await client.get("/status")).json()["channels"][0]["run_state"]
            runs.add(state)
            if state != "active":
                break
        assert state == "program stop", runs
        moved = (await client.get("/clock")).json()["cycles"] - before
        assert moved < 10_000
        limited = (await client.get("/clock")).json()["cycles"]
        assert (await client.post("/clock", json={"jump": 77})).json()["cycles"] == limited + 77
        for asked in ({}, {"rate": -1}, {"rate": 1e9}, {"step": 0}, {"step": 1.5}, {"jump": 10**9}, {"freeze": 1},
                      {"rate": 1, "step": 1}, {"other": 1}, {"rate": "1"}):  # fmt: skip
            refused(await client.post("/clock", json=asked), 422)

    visit(kind, PLAIN if kind == "plain" else FANUC, ask)


def test_a_step_is_answered_when_it_has_passed_however_long_that_lasts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Time has a hundredth of a second in one go, and rests after it: requests find the machine in the middle."""

    async def ask(client: Any, machine: ServedMachine) -> None:
        await client.post("/clock", json={"freeze": True})
        passes = machine.served.advance

        def advance(cycles: int, **_: Any) -> int:
            wall.pass_s(0.02)
            return passes(min(cycles, 150))

        monkeypatch.setattr(machine.served, "advance", advance)
        for _ in range(3):
            before = (await client.get("/clock")).json()["cycles"]
            assert (await client.post("/clock", json={"step": 333})).json()["cycles"] == before + 333

    wall = Slow(5e-6)
    visit("plain", PLAIN, ask, wall)


def test_what_is_told_later_has_a_larger_number() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        from polycnc.servers.http._lease import Lease
        from polycnc.servers.http._stream import Stream

        stream = Stream(None, machine, 5.0, Lease(), lambda: 7)  # type: ignore[arg-type]
        holder = {"operator": "Anna", "key": "annas-key-4711"}
        numbers = []
        assert json.loads(stream._message())["number"] == 7
        for _ in range(2):
            for place, asked in (("/commands", {"command": "reset"}), ("/lease", holder)):
                answer = await client.post(place, json=asked, headers={"polycnc-key": "annas-key-4711"})
                numbers.append(int(answer.headers["polycnc-number"]))
        assert numbers == sorted(set(numbers))

    visit("plain", PLAIN, ask)


def test_a_snapshot_brings_back_the_state_bit_for_bit() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        await client.put("/programs/O0012", content=b"O12\nG1 X10 F600\nX0\nM30\n")
        await client.post("/commands", json={"command": "select_mode", "mode": "auto"})
        await client.post("/commands", json={"command": "select_program", "program": "O0012"})
        await client.post("/commands", json={"command": "cycle_start"})
        await client.post("/clock", json={"step": 301})
        kept = (await client.post("/snapshot", json={"name": "before"})).json()
        assert kept == {"name": "before", "cycle": 301}
        first = (await client.post("/clock", json={"step": 200}), (await client.get("/status")).json())[1]
        back = (await client.post("/restore", json={"name": "before"})).json()
        assert back["cycle"] == 301
        await client.post("/clock", json={"step": 200})
        again = (await client.get("/status")).json()
        assert again["axes"] == first["axes"]
        assert (await client.get("/snapshots")).json() == [kept]
        file = (await client.get("/snapshot")).content
        assert file.startswith(b"polycnc snapshot")
        assert (await client.post("/clock", json={"step": 77})).status_code == 200
        status = (await client.put("/snapshot", content=file)).json()
        assert status == again
        assert (await client.get("/snapshot")).content == file
        for wrong in (b"", b"O1", file[:-1], file[:60] + bytes([file[60] ^ 1]) + file[61:]):
            refused(await client.put("/snapshot", content=wrong), 409)
        assert (await client.get("/snapshot")).content == file
        refused(await client.post("/restore", json={"name": "other"}), 404)
        refused(await client.post("/snapshot", json={"name": "../x"}), 422)
        for number in range(15):
            assert (await client.post("/snapshot", json={"name": f"s{number}"})).status_code == 200
        refused(await client.post("/snapshot", json={"name": "one more"}), 409)
        assert (await client.delete("/snapshots/s3")).status_code == 204
        refused(await client.delete("/snapshots/s3"), 404)

    visit("plain", PLAIN, ask)


def test_a_path_is_that_of_the_program_with_the_tools_and_offsets_of_the_control() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        await client.put("/programs/O0012", content=PART)
        await client.put("/programs/O0013", content=b"O13\nG1 Y7\nM99\n")
        await client.put("/offsets/G54", json={"values": {"X": 100.0}})
        before = (await client.get("/status")).json()
        found = (await client.get("/path", params={"program": "O0012"})).json()
        assert found["errors"] == []
        x, y = found["positions"]["X"], found["positions"]["Y"]
        assert len(x) == len(y) == len(found["t_s"]) == len(found["rapid"]) == len(found["line"])
        assert x[-1] == pytest.approx(100.0)
        assert y[-1] == pytest.approx(34.0)
        assert {2, 3, 6} <= set(found["line"])
        assert any(line == 0 and 4.0 < at < 7.0 for line, at in zip(found["line"], y, strict=True))
        assert found["t_s"] == sorted(found["t_s"])
        assert (await client.get("/status")).json() == before  # it runs beside the machine
        wrong = await client.put("/programs/O0014", content=b"O14\nG1 X5 F600\nG1 X[\n")
        assert wrong.status_code in (201, 204)
        assert "O0014:3" in (await client.get("/path", params={"program": "O0014"})).json()["errors"][0]
        refused(await client.get("/path"), 404)
        refused(await client.get("/path", params={"program": "O0099"}), 404)

    visit("plain", PLAIN, ask)


def test_a_path_of_macros_reads_variables_and_changes_none() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        await client.put("/variables/500", json={"value": 8.5})
        await client.put("/programs/O0012", content=b"O12\nG1 X[#500*2.] F600.\n#500=3.\nG1 X#500\nM30\n")
        found = (await client.get("/path", params={"program": "O0012"})).json()
        assert found["errors"] == []
        assert max(found["positions"]["X"]) == pytest.approx(17.0, abs=0.01)
        assert found["positions"]["X"][-1] == pytest.approx(3.0, abs=0.001)
        assert (await client.get("/variables/500")).json()["value"] == 8.5

    visit("fanuc", FANUC, ask)


def test_the_reference_page_lists_the_questions_that_there_are() -> None:
    page = (Path(__file__).parents[2] / "docs" / "reference" / "http.md").read_text("utf-8")
    listed = re.findall(r"^[|] `([A-Z]+ /\S*)`", page, re.MULTILINE)

    async def ask(client: Any, machine: ServedMachine) -> None:
        document = (await client.get("http://localhost/openapi.json")).json()
        there = {
            f"{method.upper()} {path.replace('/api/machines/{machine}', '')}"
            for path, operations in document["paths"].items()
            for method in operations
            if path != "/health"
        }
        assert sorted(listed) == sorted(there)

    visit("plain", PLAIN, ask)


def test_a_status_is_answered_as_its_route_does_and_every_answer_is_counted() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        from polycnc.servers.http._documents import status_json

        quick = await client.get("/status")
        assert quick.content == status_json(machine)
        assert quick.headers["content-type"] == "application/json"
        routed = await client.get("/inventory")
        assert set(quick.headers) == set(routed.headers)
        refused(await client.get("../x/status"), 404)
        refused(await client.post("/status"), 405)
        refused(await client.get("/status", headers={"host": "evil.example"}), 421)
        assert (await client.get("/status", headers={"polycnc-key": "k" * 64})).content == quick.content
        refused(await client.get("/status", headers={"polycnc-key": "k" * 65}), 422)
        figures = (await client.get("http://localhost/metrics")).text
        counted = dict(re.findall(r'^polycnc_http_requests_total\{status="(\d+)"\} (\S+)$', figures, re.M))
        assert counted == {"200": "3.0", "404": "1.0", "405": "1.0", "421": "1.0", "422": "1.0"}

    visit("plain", PLAIN, ask)


@pytest.mark.parametrize("kind", ["plain", "apci", "imc"])
def test_a_status_is_as_it_is_described_with_a_control_and_without(kind: str) -> None:
    jsonschema = pytest.importorskip("jsonschema", reason="pip install jsonschema")

    async def ask(client: Any, machine: ServedMachine) -> None:
        document = (await client.get("http://localhost/openapi.json")).json()
        said = document["paths"]["/api/machines/{machine}/status"]["get"]["responses"]["200"]
        schema = {**said["content"]["application/json"]["schema"], "components": document["components"]}
        jsonschema.validate((await client.get("/status")).json(), schema)
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({"cycle": 1, "time_s": 0.0, "axes": 7}, schema)

    visit(kind, PLAIN if kind == "plain" else Machinery("m"), ask)
