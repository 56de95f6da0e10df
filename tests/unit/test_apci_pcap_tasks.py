"""CNC tasks from the PC, common variables and buffers, and loading files."""

import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from polycnc.controllers.apci import pcap, sap
from support.apci_pc import Pc

COUNT_FOREVER = "WHILE TRUE DO CI1 := CI1 + 1;"


@pytest.fixture
def pc(tmp_path: Path) -> Iterator[Pc]:
    yield Pc(folder=tmp_path)
    pcap.detach()


def load(folder: Path, text: str, task: int = 0) -> None:
    """Compile a program and transfer it as the IDE's users do."""
    (folder / "program.cnc").write_bytes(sap.write_cnc(sap.compile_program(text, task=task)))
    assert pcap.txbf2("program.cnc") == 0


def ci(number: int) -> int:
    cibuf = pcap.CIBUF()
    pcap.rdci(number, cibuf)
    return cibuf.ci[number]


@pytest.mark.covers(
    "apci.txbf2", "apci.startcnct", "apci.stopcnct", "apci.contcnct", "apci.rdcncts", "apci.CNCTS"
)
@pytest.mark.covers("apci.CNCTS.running.bit0", "apci.file.cnc")
def test_a_program_is_loaded_started_stopped_and_continued(pc: Pc, tmp_path: Path) -> None:
    load(tmp_path, "CI1 := 0; " + COUNT_FOREVER, task=2)
    status = pcap.CNCTS()
    pc.board.advance(10)
    assert ci(1) == 0
    pcap.startcnct(2)
    pc.board.advance(10)
    pcap.rdcncts(2, status)
    assert (status.errnum, status.running & 1) == (0, 1)
    before = ci(1)
    assert before > 0
    pcap.stopcnct(2)
    pc.board.advance(10)
    pcap.rdcncts(2, status)
    assert (ci(1), status.running & 1) == (before, 0)
    pcap.contcnct(2)
    pc.board.advance(10)
    assert ci(1) > before  # goes on
    before = ci(1)
    pcap.startcnct(2)  # stops it first, and begins at the beginning
    pc.board.advance(1)
    assert 0 < ci(1) < before
    load(tmp_path, "CI2 := 5;", task=2)  # halts the task
    pc.board.advance(5)
    pcap.rdcncts(2, status)
    assert status.running & 1 == 0
    pcap.startcnct(2)
    pc.board.advance(5)
    assert ci(2) == 5


@pytest.mark.covers("apci.contcnct")
def test_an_aborted_program_can_only_be_restarted(pc: Pc, tmp_path: Path) -> None:
    load(tmp_path, "CI1 := CI1 + 1; ABORT; CI2 := 1;")
    pcap.startcnct(0)
    pc.board.advance(5)
    pcap.contcnct(0)
    pc.board.advance(5)
    assert (ci(1), ci(2)) == (1, 0)
    pcap.startcnct(0)
    pc.board.advance(5)
    assert (ci(1), ci(2)) == (2, 0)


@pytest.mark.covers("apci.stepcnct")
def test_single_steps_are_not_implemented(pc: Pc, tmp_path: Path) -> None:
    load(tmp_path, "CI1 := 1; CI1 := 2;")
    pcap.stepcnct(0)
    pc.board.advance(5)
    assert ci(1) == 0


@pytest.mark.covers("apci.rdcncts")
def test_tasks_that_do_not_exist_do_nothing(pc: Pc) -> None:
    status = pcap.CNCTS(1, 2, 3, 4, 5)
    for task in (-1, 4):
        for function in (pcap.startcnct, pcap.stopcnct, pcap.contcnct, pcap.stepcnct):
            function(task)
        assert pcap.gettskinfo(task)[0] not in (0, -1, -4)
        assert pcap.gettskstr(task) == (0, "")
    pcap.rdcncts(4, status)
    assert status == pcap.CNCTS()


@pytest.mark.covers("apci.gettskinfo", "apci.gettskstr", "apci.tskinfo.bit0", "apci.tskinfo.bit1")
@pytest.mark.covers("apci.const.taskstr")
def test_the_output_of_a_task_is_asked_for_and_read(pc: Pc, tmp_path: Path) -> None:
    assert pcap.gettskinfo(1) == (0, 0)
    load(tmp_path, "WRITE ('half'); wt (128); WRITELN (' whole');", task=1)
    pcap.startcnct(1)
    pc.board.advance(2)
    code, bits = pcap.gettskinfo(1)
    assert (code, bits & 0x1) == (0, 1)
    pc.board.advance(100)  # 128 ms
    code, bits = pcap.gettskinfo(1)
    assert (code, bits & 0x2) == (0, 2)
    assert pcap.gettskstr(1, 4) == (4, "half")
    assert pcap.gettskinfo(1) == (0, 0)  # reading resets the bits
    load(tmp_path, "; ".join(["WRITE ('0123456789')"] * 60) + "; WRITELN ('');", task=1)
    pcap.startcnct(1)
    pc.board.advance(50)
    count, text = pcap.gettskstr(1, 1000)
    assert (count, len(text)) == (512, 512)


@pytest.mark.covers("apci.rdcd", "apci.wrcd", "apci.CDBUF", "apci.const.cncount")
def test_common_doubles_singly_and_all_at_once(pc: Pc) -> None:
    written, read = pcap.CDBUF(), pcap.CDBUF()
    for number in range(1000):
        written.cd[number] = 0.5 - number * 98765.25
        pcap.wrcd(number, written)
    pcap.rdcd(7, read)
    assert (read.cd[6], read.cd[7], read.cd[8]) == (0.0, -691356.25, 0.0)
    for number in (101, 999):
        alone = pcap.CDBUF()
        pcap.rdcd(number, alone)
        assert {k: value for k, value in enumerate(alone.cd) if value} == {number: 0.5 - number * 98765.25}
    pcap.rdcd(100, read)  # the first hundred: CD100 cannot be read by itself
    assert read.cd[:100] == written.cd[:100]
    assert read.cd[100:] == [0.0] * 900
    pcap.rdcd(1000, read)
    assert read.cd == written.cd
    for number in (-1, 1000, 1001):
        pcap.wrcd(number, pcap.CDBUF())
    pcap.rdcd(1001, read)
    written.cd[5] = math.nan
    pcap.wrcd(5, written)
    pcap.rdcd(5, read)
    assert read.cd[5] == -493825.75


@pytest.mark.covers("apci.rdci", "apci.wrci", "apci.CIBUF", "apci.const.cncount")
def test_common_integers_singly_and_all_at_once(pc: Pc) -> None:
    written, read = pcap.CIBUF(), pcap.CIBUF()
    for number in range(1000):
        written.ci[number] = -number * 1_234_567
        pcap.wrci(number, written)
    pcap.rdci(7, read)
    assert (read.ci[6], read.ci[7], read.ci[8]) == (0, -7 * 1_234_567, 0)
    for number in (101, 999):
        alone = pcap.CIBUF()
        pcap.rdci(number, alone)
        assert {k: value for k, value in enumerate(alone.ci) if value} == {number: -number * 1_234_567}
    pcap.rdci(100, read)
    assert read.ci[:100] == written.ci[:100]
    assert read.ci[100:] == [0] * 900
    pcap.rdci(1000, read)
    assert read.ci == written.ci
    written.ci[3] = 2**31
    pcap.wrci(3, written)
    assert ci(3) == -(2**31)  # 32 bits


@pytest.mark.covers(
    "apci.rdcbcnct", "apci.wrcbcnct", "apci.CBCNCT", "apci.CBCNCT.tasknumber", "apci.CBCNCT.size"
)
@pytest.mark.covers(
    "apci.CBCNCT.buffer", "apci.cbcnct.ret.bit0", "apci.cbcnct.ret.bit1", "apci.cbcnct.ret.bit2"
)
@pytest.mark.covers("apci.const.cbsize")
def test_common_buffers_are_copied_from_their_beginning(pc: Pc) -> None:
    sent = bytearray(range(250)) * 4
    assert pcap.wrcbcnct(pcap.CBCNCT(3, 1000, sent)) == 0
    assert pcap.wrcbcnct(pcap.CBCNCT(3, 2, bytearray(b"\xff\xfe"))) == 0
    assert pcap.wrcbcnct(pcap.CBCNCT(1, 3, bytearray(b"abcdef"))) == 0
    assert pc.board.variables.buffers[1][:5] == b"abc\0\0"
    memory = bytearray(b"......")
    assert pcap.rdcbcnct(pcap.CBCNCT(1, 4, memory)) == 0
    assert memory == b"abc\0.."
    into = bytearray(1001)
    assert pcap.rdcbcnct(pcap.CBCNCT(3, 1000, into)) == 0
    assert into == b"\xff\xfe" + sent[2:] + b"\0"
    other = bytearray(4)
    assert pcap.rdcbcnct(pcap.CBCNCT(2, 4, other)) == 0
    assert other == bytes(4)
    for function in (pcap.rdcbcnct, pcap.wrcbcnct):
        assert function(pcap.CBCNCT(4, 4, bytearray(4))) == 0x1
        assert function(pcap.CBCNCT(-1, 1, bytearray(1))) == 0x1
        assert function(pcap.CBCNCT(4, 10, bytearray(9))) == 0x5
        assert function(pcap.CBCNCT(0, 1001, bytearray(2000))) == 0x2
        assert function(pcap.CBCNCT(0, 4, bytearray(3))) == 0x4
        assert function(pcap.CBCNCT(-1, 1001, bytearray())) == 0x3
    assert pc.board.variables.buffers[0] == bytearray(1000)
    assert pcap.rdcbcnct(pcap.CBCNCT(3, 4, into)) == 0
    assert into[:4] == b"\xff\xfe\x02\x03"


@pytest.mark.covers("apci.txbf2", "apci.file.system_dat", "apci.axst.9.cef")
def test_a_system_file_overwrites_what_was_changed_and_is_checked_against_the_board(
    pc: Pc, tmp_path: Path
) -> None:
    (tmp_path / "other.dat").write_text("[[axis]]\njac = 321.0\nkp = 7.0\n[[axis]]\n[[axis]]\n")
    record = pcap.TSRP(an=0, jac=5.0)
    pcap.wrjac(record)
    assert pcap.txbf2("other.dat") == 0
    pcap.rdjac(record)
    assert record.jac == 321.0
    assert pc.board.kernel.servo.row[0]["kp"] == 7.0  # as uf does
    assert pcap.rdaxstb(0, 10) == 0
    (tmp_path / "other.dat").write_text('[[axis]]\nmotor = "stepper"\n[[axis]]\n[[axis]]\n')
    assert pcap.txbf2("other.dat") == 0
    pc.board.state.axis["cef"] = 0
    pcap.rs()  # looks again
    assert pcap.rdaxstb(0, 10) == 1  # cef: the board has servos
    assert pcap.txbf2("missing.dat") == 20
    (tmp_path / "bad.cnc").write_bytes(b"no program")
    assert pcap.txbf2("bad.cnc") == 22


@pytest.mark.covers("apci.txbf2.ret.21")
def test_a_program_larger_than_the_memory_of_a_task_is_refused(pc: Pc, tmp_path: Path) -> None:
    small = sap.compile_program("CI0 := 7;\n", task=1)
    (tmp_path / "small.cnc").write_bytes(sap.write_cnc(small))
    assert pcap.txbf2("small.cnc") == 0
    large = sap.write_cnc(sap.compile_program("CI1 := 8;\n" * 100)) + b" " * (1 << 20)
    (tmp_path / "large.cnc").write_bytes(large)
    assert pcap.txbf2("large.cnc") == 21
    pcap.startcnct(1)  # what was loaded before is still there
    pc.board.advance(3)
    assert int(pc.board.state.ci[0]) == 7
