"""What a board keeps in its memory file: programming cycles, environment strings, programs of the tasks."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.apci import Board, pcap, sap
from polycnc.machine import Store, StoreError

SOURCE = "program p;\nbegin\n writeln('seven');\n ci[3] := 21;\nend.\n"


def loaded(folder: Path, memory: Path | Store | None, *boards: Board) -> tuple[Any, ...]:
    slots = pcap.attach(*(boards or (Board(),)), clock=None, folder=folder, memory=memory)
    pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "system.dat")
    return slots


@pytest.fixture
def memory(tmp_path: Path) -> Path:
    """Leave a memory file as a session of a program leaves it."""
    (tmp_path / "p.CNC").write_bytes(sap.write_cnc(sap.compile_program(SOURCE, "p.sap", 2)))
    path = tmp_path / "board.db"
    (slot,) = loaded(tmp_path, path)
    slot.board.eprom_cycles = 37
    slot.stop()
    slot.write_environment("SerialNumber", "77001133")
    slot.running = True
    assert pcap.txbf2("p.CNC") == 0
    pcap.detach()
    return path


@pytest.mark.covers("apci.rdepc", "apci.TSRP.epc")
def test_everything_is_there_again_when_it_is_switched_on(memory: Path, tmp_path: Path) -> None:
    (slot,) = loaded(tmp_path, memory)
    records = pcap.tsrp_array()
    records[0].an = 0
    pcap.rdepc(records[0])
    assert records[0].epc == 37
    assert slot.environment.read("SerialNumber") == (8, "77001133")
    pcap.board().advance(3)
    assert pcap.gettskstr(2, 100)[-1] == ""  # loaded, not started
    pcap.startcnct(2)
    pcap.board().advance(3)
    assert pcap.gettskstr(2, 100)[-1].startswith("seven")
    pcap.detach()


def test_without_a_memory_file_nothing_is_kept(memory: Path, tmp_path: Path) -> None:
    (slot,) = loaded(tmp_path, None)
    assert slot.board.eprom_cycles == 0
    assert slot.environment.read("SerialNumber") == (8, "80010001")
    pcap.detach()


def test_boards_of_one_memory_do_not_see_each_other(memory: Path, tmp_path: Path) -> None:
    first, second = loaded(tmp_path, memory, Board(), Board())
    assert [slot.board.eprom_cycles for slot in (first, second)] == [37, 0]
    second.board.eprom_cycles = 5
    pcap.detach()
    first, second = loaded(tmp_path, memory, Board(), Board())
    assert [slot.board.eprom_cycles for slot in (first, second)] == [37, 5]
    pcap.detach()


def test_a_session_lets_go_of_its_file_and_keeps_a_store_that_was_lent(memory: Path, tmp_path: Path) -> None:
    with Store(memory) as store:
        loaded(tmp_path, store)
        pcap.detach()
        assert store.area("apci.board0.eeprom", int)["cycles"] == 37
    loaded(tmp_path, memory)
    with pytest.raises(StoreError):
        Store(memory)
    pcap.detach()
    Store(memory).close()


def test_a_damaged_program_is_left_out_with_a_remark(
    memory: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with Store(memory) as store:
        store.area("apci.board0.tasks", bytes)[2] = b"junk"
    with caplog.at_level(logging.WARNING):
        loaded(tmp_path, memory)
    assert "the program of task 2 in the memory file is damaged" in caplog.text
    pcap.detach()


def test_a_file_that_is_no_store_is_refused(tmp_path: Path) -> None:
    (tmp_path / "m.db").write_text("junk" * 99)
    with pytest.raises(StoreError, match="not a store"):
        loaded(tmp_path, tmp_path / "m.db")
    pcap.detach()
