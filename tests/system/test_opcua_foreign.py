"""Clients of OPC UA that others have written, against a served machine; each is skipped where it is not installed."""

from __future__ import annotations

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from support.started import started

pytest.importorskip("asyncua", reason="pip install 'polycnc[opcua]'")
pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

SUPPORT = Path(__file__).parents[1] / "support"
NODE = Path(os.environ.get("POLYCNC_NODE", Path.home() / ".cache" / "polycnc" / "node")) / "node_modules"


@pytest.fixture(scope="module")
def urls() -> Iterator[dict[str, str]]:
    process = started("serve", "--plain", "mill3", "--doors", "opcua=0,http=0")
    said = [process.stdout.readline().partition(" ") for _ in range(2)]
    yield {name: at.strip() for name, _, at in said}
    process.terminate()
    _, error = process.communicate(timeout=60)
    assert "Traceback" not in error, error


def _python_of(command: str) -> Path | None:
    """Return the Python that a command on the PATH belongs to."""
    found = shutil.which(command)
    return Path(found).resolve().with_name("python") if found else None


def answers(*command: str | Path, **environment: str) -> dict[str, Any]:
    done = subprocess.run(
        [str(each) for each in command], capture_output=True, text=True, timeout=120, check=False,
        env={**os.environ, **environment},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return dict(json.loads(line) for line in done.stdout.splitlines() if line.startswith("["))


@pytest.mark.parametrize("secured", ["no", "yes"])
@pytest.mark.skipif(
    shutil.which("node") is None or not (NODE / "node-opcua-client").is_dir(),
    reason="no node-opcua: npm install --prefix ~/.cache/polycnc/node node-opcua-client",
)
def test_node_opcua_reads_writes_subscribes_and_calls(secured: str, request: pytest.FixtureRequest) -> None:
    urls = request.getfixturevalue("urls")
    said = answers(
        "node", SUPPORT / "opcua_client.cjs", urls["opcua:"], urls["http:"], secured, NODE_PATH=str(NODE)
    )
    assert {"CncAxisList", "CncChannelList", "CncSpindleList", "VendorName"} <= set(said.pop("below"))
    assert said == {
        "position": [0, 0, 0], "unit": 20529, "unknown": "BadNotSupported", "write": "Good",
        "too much": "BadOutOfRange", "other type": "BadTypeMismatch", "fixed": "BadNotWritable", "changed": 63,
        "event": ["emergency stop", 1000, True], "refresh": "Good", "history": "BadHistoryOperationUnsupported",
    }  # fmt: skip


@pytest.mark.skipif(importlib.util.find_spec("o6") is None, reason="no o6: pip install o6")
def test_o6_reads_writes_and_subscribes(request: pytest.FixtureRequest) -> None:
    urls = request.getfixturevalue("urls")
    said = answers(sys.executable, SUPPORT / "opcua_client.py", urls["opcua:"])
    assert said == {
        "state": 2, "write": "GOOD", "too much": "BAD_OUT_OF_RANGE", "fixed": "BAD_NOT_WRITABLE", "override": 63.0,
        "changed": True,
    }  # fmt: skip


@pytest.mark.skipif(_python_of("opcua-client") is None, reason="no opcua-client: pip install opcua-client")
def test_opcua_client_shows_every_node_writes_and_is_told(
    request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    python, urls = _python_of("opcua-client"), request.getfixturevalue("urls")
    assert python is not None
    window = SUPPORT / "opcua_window.py"
    said = answers(python, window, urls["opcua:"], urls["http:"], XDG_CONFIG_HOME=str(tmp_path))
    assert said == {
        "errors": [], "shown": True, "too much": "BadOutOfRange", "changed": True, "event": [["emergency stop", 1000]],
    }  # fmt: skip
