"""A sender at a machine in a process of its own: over TCP and over a pseudo terminal, as the tutorial shows it."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from support.grbl_sender import stream
from support.started import started, started_python

MACHINE = Path(__file__).parents[1] / "support" / "grbl_machine.py"
NODE = Path(os.environ.get("POLYCNC_NODE", Path.home() / ".cache" / "polycnc" / "node")) / "node_modules"
SENDERS = Path(os.environ.get("POLYCNC_SENDERS", Path.home() / ".cache" / "polycnc" / "senders"))
TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorials" / "your-sender.md"
PROGRAM = (
    "G21 G90\n" + "".join(f"G1 X{n % 9} Y{n % 5} F6000\n" for n in range(60)) + "G2 X1\nG0 X3 Y0\nG4 P0\n"
)
ANSWERS = ["ok"] * 61 + ["error:35"] + ["ok"] * 2


def shown() -> dict[str, str]:
    """Return the titled blocks of the tutorial."""
    text = TUTORIAL.read_text(encoding="utf-8")
    return dict(re.findall(r'```\w+ title="([^"]+)"\n(.*?)```', text, re.DOTALL))


class Link:
    """A link to the machine by its file descriptor; it reads line by line."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor
        self._read = b""

    def write(self, data: bytes) -> None:
        while data:
            data = data[os.write(self.descriptor, data) :]

    def read_line(self) -> str:
        while b"\n" not in self._read:
            piece = os.read(self.descriptor, 4096)
            assert piece, "the machine has gone"
            self._read += piece
        line, self._read = self._read.split(b"\n", 1)
        return line.decode().strip()


@contextmanager
def machine(process: Any, expected: str) -> Iterator[int]:
    """Take a process that serves a machine; yield its port."""
    try:
        said = process.stdout.readline()
        found = re.fullmatch(rf"grbl: 127\.0\.0\.1:(\d+){expected}\n", said)
        assert found, said + str(process.stderr and process.stderr.read())
        yield int(found[1])
    finally:
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        assert "Traceback" not in errors, errors


@pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo terminals")
def test_a_program_is_streamed_over_tcp_and_over_the_terminal(tmp_path: Path) -> None:
    terminal = tmp_path / "tty"
    with (
        started_python(MACHINE, "0", str(terminal), "20") as process,
        machine(process, f" and {re.escape(str(terminal))}") as port,
    ):
        with socket.create_connection(("127.0.0.1", port), timeout=60) as connection:
            link = Link(connection.fileno())
            connection.settimeout(None)
            assert [link.read_line(), link.read_line()] == ["", "Grbl 1.1h ['$' for help]"]
            assert stream(PROGRAM, link.write, link.read_line) == ANSWERS
            link.write(b"?")
            assert link.read_line().startswith("<Idle|MPos:3.000,0.000,0.000|")
            with socket.create_connection(("127.0.0.1", port), timeout=60) as second:
                assert b"Another sender" in second.recv(100)
        descriptor = os.open(terminal, os.O_RDWR | os.O_NOCTTY)
        try:
            link = Link(descriptor)
            while link.read_line() != "Grbl 1.1h ['$' for help]":
                pass
            link.write(b"\n")
            while link.read_line() != "ok":  # the port is known to be free a moment later
                link.write(b"\n")
            assert stream(PROGRAM, link.write, link.read_line) == ANSWERS
        finally:
            os.close(descriptor)
    assert not terminal.is_symlink()


@contextmanager
def cncjs(folder: Path) -> Iterator[str]:
    """Run the server of CNCjs, with nobody to sign in; yield its URL."""
    (folder / "cncjs.json").write_text("{}")
    program, settings = NODE / "cncjs" / "bin" / "cncjs", folder / "cncjs.json"
    command = ["node", str(program), "-H", "127.0.0.1", "-p", "0", "-c", str(settings)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as server:
        try:
            said: list[str] = []
            for line in server.stdout or ():
                said.append(line)
                if found := re.search(r"Starting the server at \S*?(http://127\.0\.0\.1:\d+)", line):
                    break
            else:
                raise AssertionError("".join(said))
            yield found[1]
        finally:
            server.kill()


@pytest.mark.skipif(
    shutil.which("node") is None or not (NODE / "cncjs").is_dir(),
    reason="no CNCjs: npm install --prefix ~/.cache/polycnc/node cncjs",
)
def test_cncjs_opens_the_terminal_and_sends_a_program(tmp_path: Path) -> None:
    terminal = tmp_path / "tty"
    client = Path(__file__).parents[1] / "support" / "cncjs_client.cjs"
    with (
        started_python(MACHINE, "0", str(terminal), "20") as process,
        machine(process, f" and {re.escape(str(terminal))}"),
        cncjs(tmp_path) as url,
    ):
        program = "G21 G90|G1 X20 Y5 F6000|G2 X1|G0 X7.5 Y0|G4 P0.1"
        done = subprocess.run(
            ["node", client, url, terminal, program], capture_output=True, text=True, timeout=120, check=False,
            env={**os.environ, "NODE_PATH": str(NODE)},
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    said = dict(json.loads(line) for line in done.stdout.splitlines())
    assert said.pop("refused").startswith("error:35 ")
    assert said == {
        "modal": "G21", "fastest": "30000.000", "load": None, "sent": [6, 6, 6],
        "position": {"x": "7.500", "y": "0.000", "z": "0.000"},
    }  # fmt: skip


@pytest.mark.skipif(
    not any(SENDERS.glob("lib/python*/site-packages/bCNC")),
    reason="no bCNC: python -m venv ~/.cache/polycnc/senders, and its pip install bCNC grbl-streamer",
)
@pytest.mark.parametrize(
    ("client", "over", "expected"),
    [
        ("bcnc_client.py", "tcp", {"fastest": "30000.000", "override": 150}),
        ("grbl_streamer_client.py", "terminal", {}),
    ],
)
def test_senders_of_others_send_hold_and_override(
    client: str, over: str, expected: dict[str, Any], tmp_path: Path
) -> None:
    """bCNC's own sender, without its window, and grbl-streamer, which counts characters."""
    terminal = tmp_path / "tty"
    with (
        started_python(MACHINE, "0", str(terminal), "1") as process,
        machine(process, f" and {re.escape(str(terminal))}") as port,
    ):
        program = "G21 G90|G1 X20 Y5 F600|G2 X1 I-9.5 J0|G0 X7.5 Y0|G4 P0.1"
        done = subprocess.run(
            [SENDERS / "bin" / "python", MACHINE.with_name(client),
             f"socket://127.0.0.1:{port}" if over == "tcp" else terminal, program],
            capture_output=True, text=True, timeout=150, check=False, env={**os.environ, "HOME": str(tmp_path)},
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    said = dict(json.loads(line) for line in done.stdout.splitlines())
    assert said == {"position": [7.5, 0.0, 0.0], "errors": [], **expected}


def test_the_conversation_of_the_tutorial() -> None:
    talk = shown()["talk"].splitlines()
    assert shown()["said"] == "grbl: 127.0.0.1:8123 and /tmp/ttyGRBL\n"
    process = started("serve", "--plain", "mill3", "--doors", "grbl=0")
    with machine(process, "") as port, socket.create_connection(("127.0.0.1", port)) as connection:
        link = Link(connection.fileno())
        assert [link.read_line(), link.read_line()] == ["", "Grbl 1.1h ['$' for help]"]
        for line in talk:
            if line.startswith("> "):
                text = line.removeprefix("> ")
                link.write(text.encode() if text == "?" else text.encode() + b"\n")
            else:
                assert link.read_line() == line
