"""Requests and commands made of chance: always a document or an answer, nothing raised, nothing changed."""

from __future__ import annotations

import random
import time
from xml.etree import ElementTree

import pytest

from polycnc.servers.mtconnect import Answer, StreamAsked
from polycnc.servers.shdr import Session
from support.fuzzing import NUMBERS, changed_bytes
from support.mtconnect import Rig

PATHS = (
    "/probe",
    "/current",
    "/sample",
    "/assets",
    "/asset/mill.T3",
    "/mill/current",
    "/mill/sample",
    "/",
    "/polycnc.mill/probe",
)
QUERIES = (
    "at=3", "from=1&count=7", "count=-7", "path=//Axes//DataItem[@type=%22POSITION%22 and @subType='ACTUAL']",
    "interval=100&heartbeat=300&from=2", "type=CuttingTool&count=3&removed=true", "path=//*[not(@a)]|//Path&at=9",
    "from=3&to=9", "deviceType=Device&pretty=true", "path=//DataItem[contains(@name,'act')]",
)  # fmt: skip


PIECES = (
    "//", "/", "*", "[", "]", "(", ")", "@", "=", "&", "|", "'", '"', "%", "%00", "%FF", "%2F", ";", "..", "\0",
    "é", "\ufffd", "DataItem", "path=", "not(", " and ", " or ", "count=", "from=", "-", "9" * 25, "\ud800", "x" * 1200,
    "?", "#", "+", ",",
)  # fmt: skip


def _changed(chance: random.Random, text: str) -> str:
    """Return a text with pieces put in, left out or repeated."""
    for _ in range(chance.randint(1, 3)):
        at, end = sorted(chance.choices(range(len(text) + 1), k=2))
        piece = chance.choice((text[at:end], *chance.choices(PIECES, k=2)))
        text = text[:at] + piece + text[chance.choice((at, at, end)) :]
    return text[:6000]


def _request(chance: random.Random) -> tuple[str, bytes]:
    path, query = chance.choice(PATHS), chance.choice(QUERIES)
    if chance.random() < 0.4:
        path = _changed(chance, path)
    if chance.random() < 0.8:
        query = _changed(chance, query)
    if chance.random() < 0.2:
        name = chance.choice(("at", "from", "to", "count", "interval", "heartbeat"))
        query = f"{name}={chance.choice(NUMBERS)}"
    return path, query.encode("utf-8", "replace")


def requests(seed: int, count: int) -> None:
    rig = Rig("mill3", size=40)
    rig.control.tools.set(3, length_mm=5.5)
    rig.observe()
    chance = random.Random(seed)
    before = rig.get("/current"), rig.agent.buffer.next
    slowest = 0.0
    for _ in range(count):
        path, query = _request(chance)
        begin = time.process_time()
        answer = rig.agent.get(path, query)
        slowest = max(slowest, time.process_time() - begin)
        if isinstance(answer, StreamAsked):
            assert answer.interval_s >= 0.0
            document, following = answer.next(max(answer.first, rig.agent.buffer.first), True)
            assert document is not None
            assert following <= rig.agent.buffer.next
            continue
        assert isinstance(answer, Answer)
        assert answer.status in (200, 400, 404), (path, query)
        ElementTree.fromstring(answer.document)
    assert (rig.get("/current"), rig.agent.buffer.next) == before
    assert slowest < 2.0


def commands(seed: int, count: int) -> None:
    chance = random.Random(seed)
    session = Session()
    for _ in range(count):
        data = changed_bytes(chance, b"* PING\n* PING\r\n*\n@ASSET@|x\n")
        answer = session.receive(data[: chance.randint(0, len(data))])
        assert answer == b"* PONG 10000\n" * (len(answer) // 13)
        assert len(answer) <= 13 * data.count(b"\n")
    assert session.receive(b"\n* PING\n") == b"* PONG 10000\n"


def test_10_000_requests() -> None:
    requests(1, 10_000)


def test_10_000_pieces_of_commands() -> None:
    commands(2, 10_000)


@pytest.mark.long
@pytest.mark.timeout(0)
def test_many_requests_and_commands(request: pytest.FixtureRequest) -> None:
    count = int(request.config.getoption("--fuzz-cases"))
    number = int(request.config.getoption("--fuzz-campaign"))
    requests(number, 200 * count)
    commands(number, 200 * count)
