"""One client may command alone: the others are refused, may hold and stop, and may take it over."""

from __future__ import annotations

import asyncio
from typing import Any

from polycnc.servers.machines import ServedMachine
from polycnc.servers.process import Machinery
from support.http_app import visit

PLAIN = Machinery("m", "mill3")
ANNA = {"operator": "Anna", "key": "annas-key-4711", "seconds": 30.0}
BERT = {"operator": "Bert", "key": "berts-key-0815", "seconds": 20.0}


def shows(key: str) -> dict[str, str]:
    """Return the header of a holder."""
    return {"polycnc-key": key}


def test_whoever_does_not_hold_it_changes_nothing_but_may_hold_and_stop() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        assert (await client.get("/lease")).json() == {"holder": None, "left_s": 0.0, "turn": 0}
        assert (await client.post("/lease", json=ANNA)).json()["holder"] == "Anna"
        before = (await client.get("/status")).json(), (await client.get("/inventory")).json()
        asked = [
            ("POST", "/commands", {"command": "select_mode", "mode": "jog"}), ("PUT", "/programs/P", None),
            ("DELETE", "/programs/P", None), ("PUT", "/parameters/count_parts", {"value": True}),
            ("PUT", "/tools/3", {"length_mm": 7.5}), ("DELETE", "/tools/3", None),
            ("PUT", "/offsets/G55", {"values": {"X": 3}}),
            ("POST", "/clock", {"rate": 0}), ("POST", "/snapshot", {"name": "s"}), ("POST", "/restore", {"name": "s"}),
            ("PUT", "/variables/x", {"value": 3}), ("DELETE", "/snapshots/s", None),
            ("PUT", "/snapshot", None),
        ]  # fmt: skip
        for keys in ({}, shows("berts-key-0815")):
            for method, path, body in asked:
                answer = await client.request(method, path, json=body, headers=keys)
                assert answer.status_code == 409, (method, path, answer.text)
                assert answer.json()["detail"] == "Anna commands this machine"
        assert ((await client.get("/status")).json(), (await client.get("/inventory")).json()) == before
        held = await client.post("/commands", json={"command": "feed_hold"})
        stopped = await client.post("/commands", json={"command": "emergency_stop"})
        assert held.json()["detail"] != "Anna commands this machine"
        assert stopped.status_code == 200
        released = await client.post("/commands", json={"command": "emergency_stop", "on": False})
        assert released.status_code == 409
        assert stopped.json()["emergency"] == "on"
        own = await client.post(
            "/commands", json={"command": "emergency_stop", "on": False}, headers=shows("annas-key-4711")
        )
        assert own.json()["emergency"] != "on"

    visit("plain", PLAIN, ask)


def test_it_is_taken_over_given_back_and_ends_by_itself() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        await client.post("/lease", json=ANNA)
        refused = await client.post("/lease", json=BERT)
        assert refused.status_code == 409
        assert "take it over" in refused.json()["hint"]
        taken = (await client.post("/lease", json=BERT | {"take": True})).json()
        assert (taken["holder"], taken["turn"]) == ("Bert", 2)
        assert (await client.post("/lease", json=BERT)).json()["turn"] == 2  # going on is no new turn
        assert 19.0 < taken["left_s"] <= 20.0
        assert (await client.delete("/lease", headers=shows("annas-key-4711"))).status_code == 409
        assert (await client.post("/lease", json=ANNA)).status_code == 409
        assert (await client.delete("/lease", headers=shows("berts-key-0815"))).status_code == 204
        assert (await client.get("/lease")).json()["holder"] is None
        await client.post("/lease", json=ANNA | {"seconds": 0.002})
        await asyncio.sleep(0.003)
        assert (await client.get("/lease")).json()["holder"] is None
        reset = await client.post("/commands", json={"command": "reset"})
        assert reset.status_code == 200

    visit("plain", PLAIN, ask)


def test_what_is_no_lease_is_refused() -> None:
    async def ask(client: Any, machine: ServedMachine) -> None:
        for wrong in (
            {"key": "short"}, {"key": "with blanks in it"}, {"operator": ""}, {"operator": "x" * 41},
            {"operator": "a\nb"},
            {"seconds": 0}, {"seconds": 601}, {"seconds": "ten"}, {"more": 1},
        ):  # fmt: skip
            assert (await client.post("/lease", json=ANNA | wrong)).status_code == 422, wrong
        assert (await client.post("/lease", content=b'{"operator": NaN}')).status_code == 422
        assert (await client.get("http://localhost/api/machines/x/lease")).status_code == 404
        assert (await client.post("/commands", json={}, headers=shows("x" * 65))).status_code == 422
        assert (await client.get("/lease")).json()["holder"] is None

    visit("plain", PLAIN, ask)
