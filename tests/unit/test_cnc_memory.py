"""The program memory and line-by-line edits: what is in it, what it refuses, and that nothing changes then."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from polycnc.cnc import ControlError, Found, MemoryData, ProgramEdit, ProgramMemory, Refusal
from polycnc.machine import Clock, Store

PART = b"%\nO12(FLANGE 7)\nG0 X3.5\nM30\n%\n"


@pytest.fixture
def clock() -> Clock:
    return Clock(0.001, datetime(2026, 3, 4, 5, 6, 7))


@pytest.fixture
def running() -> set[str]:
    """The programs that are being executed."""
    return set()


@pytest.fixture
def memory(clock: Clock, running: set[str]) -> ProgramMemory:
    return ProgramMemory(Store(), clock, running=lambda: frozenset(running))


def refused(reason: Refusal, call: Callable[[], object]) -> None:
    with pytest.raises(ControlError) as caught:
        call()
    assert caught.value.reason is reason
    assert caught.value.hint


def test_the_directory_tells_size_comment_date_and_protection(memory: ProgramMemory, clock: Clock) -> None:
    memory.create("O12", PART)
    clock.tick(90_000)
    memory.create("LONG", "N1 G1 X7\n" * 40)
    memory.protect("LONG")
    first, second = memory.directory()
    assert (second.name, second.size_bytes, second.comment) == ("O12", 30, "FLANGE 7")
    assert second.changed == datetime(2026, 3, 4, 5, 6, 7)
    assert (first.name, first.size_bytes, first.comment, first.protected) == ("LONG", 360, "", True)
    assert first.changed == datetime(2026, 3, 4, 5, 7, 37)
    assert memory.used_bytes == 390
    assert memory.text("O12").content == PART
    assert list(memory) == ["LONG", "O12"]


def test_rename_copy_delete_and_search(memory: ProgramMemory, clock: Clock) -> None:
    memory.create("O12", PART)
    memory.protect("O12")
    clock.tick(2000)
    memory.copy("O12", "O13")
    assert memory.read("O13") == PART
    assert not memory.entry("O13").protected
    assert memory.entry("O13").changed == datetime(2026, 3, 4, 5, 6, 9)
    memory.rename("O13", "O14")
    assert memory.entry("O14").changed == datetime(2026, 3, 4, 5, 6, 9)
    assert "O13" not in memory
    assert memory.search("X3.5") == (Found("O12", 3, "G0 X3.5"), Found("O14", 3, "G0 X3.5"))
    assert memory.delete_all() == 1
    assert list(memory) == ["O12"]


def test_what_is_refused_changes_nothing(memory: ProgramMemory, running: set[str]) -> None:
    memory.create("A", PART)
    memory.create("RUNS", PART)
    memory.create("SAFE", PART)
    memory.create("OPEN", PART)
    memory.protect("SAFE")
    running.add("RUNS")
    memory.begin_edit("OPEN")
    before = (memory.directory(), [memory.read(name) for name in memory])
    refused(Refusal.EXISTS, lambda: memory.create("A", b""))
    refused(Refusal.DATA, lambda: memory.create("a/b", b""))
    refused(Refusal.DATA, lambda: memory.create("", b""))
    refused(Refusal.DATA, lambda: memory.create("B", b"\xff\xfeG\0"))
    refused(Refusal.DATA, lambda: memory.create("B", "G0 \udc80"))
    refused(Refusal.EXISTS, lambda: memory.rename("A", "SAFE"))
    refused(Refusal.NOT_FOUND, lambda: memory.rename("NONE", "B"))
    refused(Refusal.NOT_FOUND, lambda: memory.read("NONE"))
    refused(Refusal.NOT_FOUND, lambda: memory.delete("NONE"))
    refused(Refusal.DATA, lambda: memory.search(""))
    for name, reason in (
        ("RUNS", Refusal.IN_USE),
        ("SAFE", Refusal.PROTECTED),
        ("OPEN", Refusal.IN_USE),
    ):
        refused(reason, lambda name=name: memory.delete(name))  # type: ignore[misc]
        refused(reason, lambda name=name: memory.rename(name, "B"))  # type: ignore[misc]
        refused(reason, lambda name=name: memory.write(name, b"M2"))  # type: ignore[misc]
        refused(reason, lambda name=name: ProgramEdit(memory, name))  # type: ignore[misc]
    refused(Refusal.IN_USE, memory.delete_all)
    memory.write_protected = True
    for call in (
        lambda: memory.create("B", b""),
        lambda: memory.write("A", b""),
        lambda: memory.delete("A"),
        lambda: memory.delete_all(),
        lambda: memory.rename("A", "B"),
        lambda: memory.copy("A", "B"),
        lambda: memory.protect("A"),
    ):
        refused(Refusal.PROTECTED, call)
    assert (memory.directory(), [memory.read(name) for name in memory]) == before


def test_a_full_memory_takes_no_more(clock: Clock) -> None:
    memory = ProgramMemory(Store(), clock, MemoryData(capacity_bytes=69, most_programs=2))
    memory.create("A", PART)
    assert memory.free_bytes == 39
    refused(Refusal.FULL, lambda: memory.create("B", b"x" * 40))
    memory.create("B", b"x" * 39)
    refused(Refusal.FULL, lambda: memory.create("C", b""))
    refused(Refusal.FULL, lambda: memory.write("A", PART + b"M"))
    memory.write("A", PART[:-2] + b"Z\n")
    with ProgramEdit(memory, "A") as edit:
        refused(Refusal.FULL, lambda: edit.replace(3, "G0 X3.55"))
        assert edit.line(3) == "G0 X3.5"
        edit.replace(3, "G0 X3.")
        edit.replace(3, "G0 X3.5")
    memory.delete("B")
    assert memory.free_bytes == 39


def test_an_edit_changes_lines_and_keeps_the_other_bytes(memory: ProgramMemory) -> None:
    memory.create("P", b"G0 X1\r\n(\xe9\xff)\nG1 X2\rM2")
    with ProgramEdit(memory, "P") as edit:
        assert len(edit) == 4
        edit.insert(5, "%")
        assert memory.read("P") == b"G0 X1\r\n(\xe9\xff)\nG1 X2\rM2\r\n%\r\n"
        edit.replace(3, "G1 X2.5 F80")
        edit.insert(1, "N1")
        edit.delete(5, 6)
        assert memory.read("P") == b"N1\r\nG0 X1\r\n(\xe9\xff)\nG1 X2.5 F80\r"
        assert edit.find("X", after=2) == 4
        assert edit.find("Q") is None
        assert edit.substitute("X", "Y") == 2
        assert edit.line(4) == "G1 Y2.5 F80"
        before = memory.read("P")
        refused(Refusal.NOT_FOUND, lambda: edit.delete(5))
        refused(Refusal.NOT_FOUND, lambda: edit.delete(0, 2))
        refused(Refusal.NOT_FOUND, lambda: edit.delete(2, 5))
        refused(Refusal.NOT_FOUND, lambda: edit.line(0))
        refused(Refusal.NOT_FOUND, lambda: edit.insert(6, "M30"))
        refused(Refusal.DATA, lambda: edit.delete(3, 2))
        refused(Refusal.DATA, lambda: edit.replace(1, "a\nb"))
        refused(Refusal.DATA, lambda: edit.substitute("", "b"))
        refused(Refusal.DATA, lambda: edit.substitute("Y", "b\r"))
        memory.write_protected = True
        refused(Refusal.PROTECTED, lambda: edit.delete(1))
        memory.write_protected = False
        assert memory.read("P") == before
        assert len(edit) == 4
    refused(Refusal.IDLE, lambda: edit.delete(1))
    memory.delete("P")


def test_a_program_that_starts_to_run_can_no_longer_be_edited(
    memory: ProgramMemory, running: set[str]
) -> None:
    memory.create("P", PART)
    with ProgramEdit(memory, "P") as edit:
        running.add("P")
        refused(Refusal.IN_USE, lambda: edit.delete(1))
    assert memory.read("P") == PART


@given(
    content=st.lists(st.sampled_from([b"G0 X1", b"", b"\xff", b"M2"]), max_size=6).flatmap(
        lambda lines: st.tuples(
            st.just(lines), st.lists(st.sampled_from([b"\n", b"\r\n", b"\r"]), min_size=6, max_size=6)
        )
    ),
    place=st.integers(1, 7),
)
def test_inserting_and_deleting_a_line_gives_the_program_back(
    content: tuple[list[bytes], list[bytes]], place: int
) -> None:
    lines, ends = content
    text = b"".join(line + end for line, end in zip(lines, ends, strict=False))
    memory = ProgramMemory(Store(), Clock(0.001))
    memory.create("P", text)
    with ProgramEdit(memory, "P") as edit:
        if place <= len(edit) + 1:
            edit.insert(place, "N5")
            assert edit.line(place) == "N5"
            edit.delete(place)
    assert memory.read("P") == text


WRITER = """
import itertools, sys
from polycnc.cnc import ProgramEdit, ProgramMemory
from polycnc.machine import Clock, Store

memory = ProgramMemory(Store(sys.argv[1]), Clock(0.001))
memory.create("P", b"")
edit = ProgramEdit(memory, "P")
for number in itertools.count(1):
    edit.insert(number, f"N{number}")
    print(number, flush=True)
"""


def test_a_killed_process_loses_no_edit_that_was_acknowledged(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    arguments = [sys.executable, "-c", WRITER, str(tmp_path / "m.store")]
    with subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        acknowledged = 0
        for line in process.stdout:
            acknowledged = int(line)
            if acknowledged == 25:
                process.kill()
                break
    memory = ProgramMemory(Store(tmp_path / "m.store"), Clock(0.001))
    lines = memory.read("P").decode().splitlines()
    assert len(lines) >= acknowledged
    assert lines == [f"N{number}" for number in range(1, len(lines) + 1)]
    assert memory.entry("P").size_bytes == len(memory.read("P"))
    memory.delete("P")  # an edit does not outlive its process
