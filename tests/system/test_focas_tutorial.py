"""The tutorials about served controls: what they show is what happens."""

from __future__ import annotations

import re
from pathlib import Path

from support.command import polycnc, python
from support.focas_line import end, serve

TUTORIALS = Path(__file__).parents[2] / "docs" / "tutorials"
REFERENCE = TUTORIALS.parent / "reference"


def blocks(page: str) -> dict[str, str]:
    """Return the titled blocks of a page."""
    text = (TUTORIALS / page).read_text(encoding="utf-8")
    return dict(re.findall(r'```\w+ title="([^"]+)"\n(.*?)```', text, re.DOTALL))


def test_the_collector_sees_what_the_tutorial_shows(tmp_path: Path) -> None:
    shown = blocks("test-your-collector.md")
    for name in ("collector.py", "faults.toml", "without_network.py"):
        (tmp_path / name).write_text(shown[name], encoding="utf-8")
    for _ in range(2):  # a server started anew counts anew
        process, port = serve("--faults", tmp_path / "faults.toml")
        try:
            assert python(tmp_path / "collector.py", str(port), cwd=tmp_path).stdout == shown["output"]
        finally:
            assert "Traceback" not in end(process)
    assert python(tmp_path / "without_network.py", cwd=tmp_path).stdout == shown["prints"]


def test_dissect_explains_a_file_and_refuses_others(tmp_path: Path) -> None:
    (tmp_path / "talk.hex").write_text("a0 a0 a0 a0 00 01 01 01 00 02 00 02  # OPEN\n")
    said = polycnc("focas", "dissect", "talk.hex", cwd=tmp_path).stdout
    assert said.splitlines()[0] == "frame at 0, client: OPEN"
    assert said.splitlines()[-1].endswith("channel 2: commands")
    (tmp_path / "talk.txt").write_text("hello\n")
    refused = polycnc("focas", "dissect", "talk.txt", cwd=tmp_path, status=2)
    assert "talk.txt:1: 'hello' is no byte in hex" in refused.stderr
    missing = polycnc("focas", "dissect", "none.pcap", cwd=tmp_path, status=2)
    assert "none.pcap: No such file" in missing.stderr


def test_the_options_of_serve_are_in_the_reference() -> None:
    said = polycnc("serve", "--help").stdout
    text = (REFERENCE / "command-line.md").read_text(encoding="utf-8")
    options = set(re.findall(r"--[a-z]+", said)) - {"--help"}
    assert {"--count", "--memory", "--faults"} <= options
    assert [option for option in sorted(options) if f"| `{option}" not in text] == []
