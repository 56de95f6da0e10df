"""Small programs and the motion they mean, as texts that a person can read and check.

`program.txt` lists the channel queue of `program.nc`: the program line, then what happens, then the messages.
`errors/program.txt` is what is said about `errors/program.nc`, whose last line is refused. After a wanted change:
`pytest tests/golden --update-goldens`, and read the difference.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from polycnc.machine import MachineConfig, load_machine
from polycnc.nc import Channel, ProgramText
from support.programs import channel_state, listing, prepare, queue_bytes

HERE = Path(__file__).parent
PROGRAMS = sorted(path for path in HERE.glob("*.nc") if path.name != "O0200.nc")  # which another calls
ERRORS = sorted((HERE / "errors").glob("*.nc"))
MACHINE: MachineConfig = load_machine(HERE / "machine.toml")
HEADING = "(line) what happens, in machine coordinates (mm, degree, mm/min, s)"
DIALECT = re.compile(r"\(dialect (\w+)\)")


def prepared(text: ProgramText, *, collect_errors: bool = False) -> Channel:
    """Prepare a program in the dialect that its first line names."""
    named = DIALECT.match(text.content.decode())
    dialect = named[1] if named else "din"
    return prepare(text, config=MACHINE, dialect=dialect, segments=1 << 14, collect_errors=collect_errors)


def compare(golden: Path, found: str, request: pytest.FixtureRequest) -> None:
    if request.config.getoption("update_goldens"):
        golden.write_text(found, encoding="utf-8")
    assert golden.is_file(), "run pytest tests/golden --update-goldens, then read what it wrote"
    assert found == golden.read_text(encoding="utf-8")


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_motion(program: Path, request: pytest.FixtureRequest) -> None:
    channel = prepared(ProgramText.from_path(program))
    assert channel.errors == []
    messages = [f"{each.line:4d}  # {each.text}" for each in channel.messages.all()]
    found = "\n".join([HEADING, *listing(channel, lines=True), *messages, ""])
    compare(program.with_suffix(".txt"), found, request)


@pytest.mark.parametrize("program", ERRORS, ids=lambda path: path.stem)
def test_refusal(program: Path, request: pytest.FixtureRequest) -> None:
    content = program.read_text(encoding="utf-8")
    channel = prepared(ProgramText.from_text(content, program.name))
    assert len(channel.errors) == 1
    assert channel.errors[0].hint
    compare(program.with_suffix(".txt"), f"{channel.errors[0]}\n", request)
    # Nothing has moved or changed since the lines before.
    lines = content.splitlines()
    without = "\n".join([*lines[:-1], "(left out)", ""])
    before = prepared(ProgramText.from_text(without, program.name))
    assert before.errors == []
    if channel.state.compensation.active:  # it gives out at the end what it holds back
        assert before.writer.events.values() == channel.writer.events.values()
        assert listing(before)[: len(listing(channel))] == listing(channel)
        return
    assert queue_bytes(channel) == queue_bytes(before)
    assert channel_state(channel) == channel_state(before)


def test_every_golden_text_has_its_program() -> None:
    found = (*HERE.glob("*.txt"), *(HERE / "errors").glob("*.txt"))
    texts = {path.relative_to(HERE).with_suffix("") for path in found}
    programs = {path.relative_to(HERE).with_suffix("") for path in (*PROGRAMS, *ERRORS)}
    assert texts == programs
