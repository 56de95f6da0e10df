"""A process with FOCAS and HTTP over real sockets: both doors agree, refuse what is bad, and the page operates it."""

from __future__ import annotations

import json
import re
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from hypothesis import Phase, given, settings

from polycnc.cli._snapshot import restore_command, snapshot_command
from polycnc.errors import UsageError
from support import operator_page, page_answers
from support.browser import browser, new_page
from support.command import polycnc, python
from support.focas_line import Line, free_port
from support.often import share
from support.started import started

httpx = pytest.importorskip("httpx", reason="pip install httpx")
pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")


MACHINES = """[doors]
http = 0
[[machine]]
name = "machine"
controller = "fanuc"
doors = { focas = 0 }
[[machine]]
name = "pnc"
controller = "bosch"
memory = "root"
program = "ask.npg"
[[machine]]
name = "board"
controller = "apci"
[[machine]]
name = "two"
controller = "plain"
file = "mill3"
channels = [["X", "Y"], ["Z"]]
"""
ASKS = '10 PRN(4,6,"WHICH HAND?")\n20 #K%=0\n30 SFK(#K%,"LEFT","RIGHT&HAND")\nN40 G1 X1 F60\nM30\n'


class Served:
    """A process that serves a control, a Bosch one that asks for keys, a board, one with two channels; and clients."""

    def __init__(self, folder: Path) -> None:
        (folder / "machines.toml").write_text(MACHINES)
        (folder / "ask.npg").write_text(ASKS)
        self.process = started("serve", folder / "machines.toml")
        self.focas_port = int(self.process.stdout.readline().rpartition(":")[2])
        self.url = self.process.stdout.readline().partition(" ")[2].strip()
        self.http = httpx.Client(base_url=f"{self.url}/api/machines/machine", timeout=60)
        self.line = Line(self.focas_port)

    def command(self, command: str, **values: Any) -> Any:
        return self.http.post("/commands", json={"command": command, **values})

    def rate(self, rate: float) -> None:
        """Let the time of all machines pass at a rate; that of those at which nobody looks costs as much."""
        for name in ("machine", "pnc", "board", "two"):
            httpx.post(f"{self.url}/api/machines/{name}/clock", json={"rate": rate}, timeout=60)

    def status(self) -> dict[str, Any]:
        found: dict[str, Any] = self.http.get("/status").json()
        return found

    def end(self) -> None:
        self.line.close()
        self.http.close()
        self.process.terminate()
        _, error = self.process.communicate(timeout=60)
        assert self.process.returncode == 143
        assert "Traceback" not in error, error


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    made = Served(tmp_path_factory.mktemp("served"))
    yield made
    made.end()


@pytest.fixture(autouse=True)
def _at_rest(served: Served) -> Iterator[None]:
    served.rate(0)
    served.command("emergency_stop", on=False)
    served.command("reset")
    served.http.post("/clock", json={"step": 500})
    yield
    served.rate(0)


BAD_BODIES = [
    b"", b"\xff\xfe", b"null", b"[]", b"{", b'{"command": "reset", "command": "jog"}', b'{"command": NaN}',
    b'{"command": "set_overrides", "feed": 1e308}', b'{"command": "set_overrides", "feed": 1e999}', b"[" * 100_000,
    b'{"command": "cycle_start", "line": 99999999999999999999999999}', b'{"command": "' + b"x" * 5000 + b'"}',
    b"{" + b" " * (2 << 20) + b"}",
]  # fmt: skip
BAD_NAMES = ["../x", "%2e%2e%2fx", "%00", "CON", "x" * 5000, "O12345", "O0000", "%ff", "a%2fb", "O1%0a"]


def test_bad_input_is_refused_and_changes_nothing(served: Served) -> None:
    before = served.status(), served.http.get("/inventory").json()
    for body in BAD_BODIES:
        for place in ("/commands", "/clock"):
            answer = served.http.post(place, content=body)
            assert 400 <= answer.status_code < 500, (body[:60], answer.status_code)
            assert answer.headers["content-type"] == "application/problem+json"
            assert answer.json()["hint"]
    for name in BAD_NAMES:
        for method in ("GET", "DELETE", "PUT"):
            answer = served.http.request(
                method, f"/programs/{name}", content=b"O1\nM30\n" if method == "PUT" else None
            )
            assert 400 <= answer.status_code < 500, (method, name[:20], answer.status_code)
    with socket.create_connection(("127.0.0.1", int(served.url.rpartition(":")[2])), timeout=60) as line:
        line.sendall(b"PUT /api/machines/machine/programs/O0099 HTTP/1.1\r\nHost: 127.0.0.1\r\n")
        line.sendall(b"Content-Length: 200000000\r\n\r\n")
        assert line.recv(100).startswith(b"HTTP/1.1 413 ")
    with suppress(httpx.TransportError):  # refused before all of it was sent
        chunked = served.http.put("/programs/O0099", content=iter([b"x" * (1 << 20)] * 17))
        assert chunked.status_code == 413
    for headers in ({"host": "evil.example"}, {"origin": "http://evil.example"}, {"origin": "null"}):
        assert served.http.get("/status", headers=headers).status_code in (403, 421)
    assert (served.status(), served.http.get("/inventory").json()) == before


def test_two_doors_command_at_once(served: Served) -> None:
    """What each client set last is what holds; no request fails."""
    codes: list[int] = []

    def many(client: Any, values: list[float]) -> None:
        asked = ({"command": "set_overrides", "feed": value} for value in values)
        codes.extend(client.post("/commands", json=each).status_code for each in asked)

    with httpx.Client(base_url=served.http.base_url, timeout=60) as other:
        threads = [threading.Thread(target=many, args=(c, [0.5, 0.75] * 20)) for c in (served.http, other)]
        for thread in threads:
            thread.start()
        override = Line(served.focas_port)
        for _ in range(40):
            assert 255 - override.payload(0x8001, 12, 12, 0, 0, target=2)[0] in (50, 75, 100, 120)
        override.close()
        for thread in threads:
            thread.join()
    assert set(codes) == {200}
    assert served.status()["overrides"]["feed"] == 0.75


def test_a_lost_connection_releases_the_jog_key(served: Served) -> None:
    ws = pytest.importorskip("websockets.sync.client", reason="pip install websockets")
    served.command("select_mode", mode="jog")
    with ws.connect(f"{served.url.replace('http', 'ws')}/api/machines/machine/stream?rate=50") as stream:
        while (
            served.status()["axes"]["X"]["manual"] != "jog"
        ):  # pressed anew where it was released for being late
            stream.send(json.dumps({"jog": {"axis": "X", "direction": 1}}))
            served.http.post("/clock", json={"step": 50})
    for _ in range(200):
        served.http.post("/clock", json={"step": 100})
        if served.status()["axes"]["X"]["manual"] == "none":
            return
    raise AssertionError("the axis still moves")


def test_the_tutorial_shows_what_happens(served: Served, tmp_path: Path) -> None:
    page = Path(__file__).parents[2] / "docs" / "tutorials" / "a-machine-with-a-page.md"
    shown = dict(re.findall(r'```\w+ title="([^"]+)"\n(.*?)```', page.read_text("utf-8"), re.DOTALL))
    script = shown["start_a_program.py"].replace("http://127.0.0.1:8080", served.url).replace("PART", "O0077")
    assert python(script).stdout.replace("O0077", "PART") == shown["prints"]


def test_a_taken_port_ends_it_with_its_name(served: Served) -> None:
    port = served.url.rpartition(":")[2]
    done = polycnc("serve", "--plain", "mill3", "--doors", f"http={port}", status=2)
    assert f"http: cannot listen on 127.0.0.1:{port}" in done.stderr
    assert done.stdout == ""


EXPECTED = r"409 .*/machine/(commands|scenario)"
"""What the page is refused: while another commands, and a scenario that says what cannot be."""


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser() as running:
        yield running


TABS = (
    "programs",
    "tools",
    "offsets",
    "parameters",
    "variables",
    "signals",
    "alarms",
    "snapshots",
    "connections",
)


@pytest.mark.parametrize("size", [(1280, 800), (390, 844)])
def test_the_page_operates_the_machine(size: tuple[int, int], served: Served, chromium: Any) -> None:
    served.rate(1)
    served.command("select_mode", mode="auto")
    wrong: list[str] = []
    failed: list[str] = []
    page = new_page(chromium, viewport={"width": size[0], "height": size[1]}, device_scale_factor=0.5)
    page.on("console", lambda said: wrong.append(said.text) if said.type == "error" else None)
    page.on(
        "response",
        lambda answer: failed.append(f"{answer.status} {answer.url}") if answer.status >= 400 else None,
    )
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("request", lambda asked: None if asked.url.startswith(served.url) else wrong.append(asked.url))
    page.goto(served.url)
    page.wait_for_selector("body:not(.lost)")
    page.click("#tab-programs")
    page.fill("#new", "O0044")
    page.fill("#text", "O0044\nG91 G1 X40 F60\nM30\n")
    page.click("#save")
    page.wait_for_selector("#names option[value=O0044]", state="attached")
    page.select_option("#names", "O0044")
    page.click("#select")
    page.click("#cycle_start")
    page.click("#tab-run")
    page.wait_for_selector("#lines [aria-current]")
    page.wait_for_selector("#path:not([data-done='0']):not([data-points='0']) canvas")
    assert page.locator("#charts canvas").count() == 2
    page.click("#feed_hold")
    page.wait_for_selector("#run[data-state=hold]")
    page.click("#single_block")
    page.wait_for_selector("#single_block[aria-pressed=true]")
    page.click("#single_block")
    assert page.locator("#stop").bounding_box()["y"] < size[1]
    page.click("#stop")
    page.wait_for_selector("#alarms p")
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    page.click("#stop")
    page.wait_for_selector("#stop[aria-pressed=false]")
    page.click("#reset")
    page.click("[data-mode=jog]")
    page.wait_for_selector("[data-mode=jog][aria-pressed=true]")
    before = page.text_content("#X-machine")
    page.keyboard.down("ArrowRight")
    while page.text_content("#X-machine") == before:
        page.wait_for_timeout(20)
    page.evaluate("window.dispatchEvent(new Event('blur'))")
    while served.status()["axes"]["X"]["manual"] != "none":
        page.wait_for_timeout(20)
    page.keyboard.up("ArrowRight")
    if size[0] > 1000:
        page_answers.answer_late(page, served)
        operator_page.operate(page, served)
    for width, height in {size, (820, 1180)} if size[0] > 1000 else {size}:
        page.set_viewport_size({"width": width, "height": height})
        assert page.locator("#stop").bounding_box()["y"] < height
        for tab in TABS:
            page.click(f"#tab-{tab}")
            page.wait_for_selector(f"#page-{tab}")
            assert page.evaluate("document.documentElement.scrollWidth") <= width, (width, tab)
    assert [each for each in wrong if not each.startswith("Failed to load resource")] == []
    assert [each for each in failed if not re.search(EXPECTED, each)] == []
    page.close()


def test_requests_from_the_description_are_answered_as_it_says(served: Served) -> None:
    """Status, type and form of each answer are described; what is not of the form asked for is refused."""
    schemathesis = pytest.importorskip("schemathesis", reason="pip install schemathesis")
    schema = schemathesis.openapi.from_url(f"{served.url}/openapi.json")
    codes: set[int] = set()
    for operation in (found.ok() for found in schema.get_all_operations()):

        @settings(
            max_examples=share(2), deadline=None, database=None, derandomize=True, phases=[Phase.generate]
        )
        @given(case=operation.as_strategy())
        def ask(case: Any) -> None:
            answer = case.call()
            case.validate_response(answer)
            assert answer.status_code < 500, (case.method, case.path, answer.text)
            codes.add(answer.status_code)

        ask()
    assert {200, 404} <= codes


@pytest.mark.long
def test_schemathesis_finds_nothing(tmp_path: Path) -> None:
    pytest.importorskip("schemathesis", reason="pip install schemathesis")
    served = Served(tmp_path)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "schemathesis.cli", "run", f"{served.url}/openapi.json", "--max-examples", "50"],
            capture_output=True, text=True, timeout=1800, check=False,
        )  # fmt: skip
    finally:
        served.end()
    assert done.returncode == 0, done.stdout[-5000:]


def test_a_state_is_kept_in_a_file_and_gone_back_to(
    served: Served, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("machine", "board", "two"):
        file = tmp_path / name
        snapshot_command(served.url, file, machine=name)
        restore_command(file, served.url, machine=name)
        with pytest.raises(UsageError, match="snapshot of"):
            restore_command(file, served.url, machine="board" if name != "board" else "two")
    assert capsys.readouterr().out.count(": written\n") == 3
    with pytest.raises(UsageError, match="4 machines are served") as error:
        snapshot_command(served.url, tmp_path / "none")
    assert error.value.hint == "Name one: machine, pnc, board, two."
    assert not (tmp_path / "none").exists()
    (tmp_path / "text").write_text("O1")
    refused: dict[str, Callable[[], None]] = {
        "this is not a snapshot": lambda: restore_command(tmp_path / "text", served.url, machine="two"),
        "there is no such machine": lambda: snapshot_command(served.url, tmp_path / "none", machine="other"),
        "nobody answers": lambda: snapshot_command("http://127.0.0.1:9", tmp_path / "none"),
        "is no address of a page": lambda: snapshot_command("127.0.0.1", tmp_path / "none"),
        "serves no machines": lambda: snapshot_command(f"{served.url}/?", tmp_path / "none"),
        "the command reads that file": lambda: snapshot_command(
            served.url, tmp_path / "text", token=tmp_path / "text"
        ),
        "larger than any snapshot": lambda: restore_command(Path("/dev/zero"), served.url, machine="two"),
        "cannot read": lambda: snapshot_command(served.url, tmp_path / "none", token=tmp_path / "secret"),
    }
    for what, ask in refused.items():
        with pytest.raises(UsageError, match=what):
            ask()
    assert (tmp_path / "text").read_text() == "O1"


def test_the_page_shows_the_breakpoints_of_a_process_that_was_started_anew(chromium: Any) -> None:
    """It counts what it tells from 1 again; nothing of that is taken for older than what the one before told."""
    port = free_port()

    def serve() -> Any:
        process = started("serve", "--fanuc", "--doors", f"http={port}")
        assert process.stdout.readline().startswith("http:")
        made = http.put("/programs/O0044", content=b"O0044\nG1 X1 F60\nX2\nX3\nM30\n")
        assert made.status_code == 201, made.text
        for asked in (
            {"command": "select_mode", "mode": "auto"},
            {"command": "select_program", "program": "O0044"},
        ):
            assert http.post("/commands", json=asked).status_code == 200
        return process

    http = httpx.Client(base_url=f"http://127.0.0.1:{port}/api/machines/machine", timeout=60)
    process = serve()
    page = new_page(chromium, device_scale_factor=0.5)
    page.goto(f"http://127.0.0.1:{port}")
    page.wait_for_selector("body:not(.lost)")
    clock = page.text_content("#clock")
    operator_page.until(page, lambda: page.text_content("#clock") > clock)
    page.click("#tab-run")
    page.click("#lines li:nth-child(2)")
    page.click("#breakpoint")
    operator_page.until(page, lambda: http.get("/inventory").json()["breakpoints"])
    process.kill()
    process.communicate(timeout=60)
    page.wait_for_selector("body.lost")
    process = serve()
    page.wait_for_selector("body:not(.lost)")
    http.post("/commands", json={"command": "set_breakpoints", "program": "O0044", "lines": [3, 4]})
    page.wait_for_selector("#lines li:nth-child(3).breakpoint")
    assert page.locator("#lines .breakpoint").count() == 2
    page.close()
    http.close()
    process.terminate()
    process.communicate(timeout=60)
