"""Rows of the manual on the second of two boards, through the library alone: codes, files, records, tasks, lights.

The numbers are those that the manual prints. Whatever is done here, the first board stays as it was.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.apci import pcap, sap
from polycnc.controllers.apci.board._codes import BootCode, InitCode, TransferCode
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.controllers.apci.pc._installed import InstalledBoard
from polycnc.controllers.apci.pc._slots import Slot
from polycnc.controllers.apci.sap._board_host import BoardTasks
from support.apci_bits import Axst, ErrorReg
from support.apci_pc import Pc, near

FIRST = "[[axis]]\njac = 11.0\n"
SECOND = """
board_type = "APCI-8008"
[[axis]]
[[axis]]
[[axis]]
jac = 22.5
jvl = 23.5
jtvl = -3.5
hac = 24.5
hvl = 25.5
sll = -26.5
slr = 27.5
ipw = 0.5
mpe = 28.5
gf = 1.5
kp = 29.5
ki = 30.5
kd = 31.5
kpl = 0.625
kfca = 32.5
kfcv = 33.5
[[axis]]
motor = "stepper"
[inputs]
4 = { inverted = true }
[outputs]
3 = { functions = ["PAE"] }
2 = { functions = ["PAE"], axes = ["A3"] }
5 = { functions = ["PAE"], axes = ["A1", "A2", "A4"] }
7 = { set_at_reset = true }
"""


class TwoBoards:
    """Two boards that are booted and initialised, the second selected."""

    def __init__(self, folder: Path) -> None:
        (folder / "rwmos.elf").write_bytes(b"\x7fELF\1\1")
        (folder / "first.dat").write_text(FIRST)
        (folder / "system.dat").write_text(SECOND)
        boards = [InstalledBoard(parse_system_file(text)) for text in (FIRST, SECOND)]
        self.slots: tuple[Slot, ...] = pcap.attach(*boards, booted=False, folder=folder, clock=None)
        self.tsrp, self.rosi = pcap.tsrp_array(), pcap.ROSI()
        assert pcap.BootFile("rwmos.elf", 0) == 0
        assert pcap.InitMcuSystem3(self.tsrp, self.rosi, 0, "first.dat") == (0, 4)
        assert pcap.CardSelect(1) == 1
        assert pcap.BootFile("rwmos.elf", 0) == 0

    def initialise(self, name: str = "system.dat") -> tuple[int, int]:
        """Initialise the selected board."""
        return pcap.InitMcuSystem3(self.tsrp, self.rosi, 0, name)

    @property
    def slot(self) -> Slot:
        """The place of the second board."""
        return self.slots[1]


@pytest.fixture
def two(tmp_path: Path) -> Iterator[TwoBoards]:
    yield TwoBoards(tmp_path)
    assert pcap.CardSelect(0) == 0
    pcap.rdjac(record := pcap.TSRP(an=0))
    pcap.rdap(whole := pcap.TSRP(an=0))
    assert (record.jac, whole.axst, whole.digo, whole.rp) == (11.0, Axst.pe, 0, 0.0)
    pcap.detach()


# ---------------------------------------------------------------------- codes


@pytest.mark.covers("apci.BootFile", "apci.file.rwmos_elf", "apci.BootFile.ret.0")
@pytest.mark.parametrize(
    ("code", "fault", "running"),
    [
        pytest.param(code, fault, running, marks=pytest.mark.covers(f"apci.BootFile.ret.{code}"))
        for code, fault, running in [
            (13, BootCode.BAD_ELF, False),
            (14, BootCode.START_ADDRESS, False),
            (15, BootCode.WRONG_PLATFORM, False),
            (16, BootCode.VERIFY_FAILED, False),
            (200, BootCode.FLASH_ACCESS, True),
            (201, BootCode.FLASH_SIZE, True),
            (202, BootCode.DEVICE_ADDRESSES, True),
        ]
    ],
)
def test_what_ends_booting_has_its_number_and_the_board_is_booted_after_it(
    two: TwoBoards, code: int, fault: BootCode, running: bool
) -> None:
    assert two.initialise() == (0, 32)
    pcap.cl(pcap.AS.of(2))
    two.slot.inject(fault)
    assert pcap.BootFile("rwmos.elf", 0) == code
    assert pcap.rdaxstb(2, 14) == running  # what fails before the reset leaves the board as it is
    assert two.initialise()[0] == (0 if running else 32)
    two.slot.repair(fault)
    assert pcap.BootFile("rwmos.elf", 77) == 0
    assert pcap.rdaxstb(2, 14) == 0
    assert two.initialise() == (0, 32)


@pytest.mark.covers("apci.BootFile", "apci.file.rwmos_elf")
@pytest.mark.parametrize(
    ("name", "code"),
    [
        pytest.param(name, code, marks=pytest.mark.covers(f"apci.BootFile.ret.{code}"))
        for name, code in [("", 10), ("a|b.elf", 10), ("none.elf", 11), ("system.dat", 12), ("empty.elf", 12)]
        + [("near.elf", 12), ("turned.elf", 12), ("short.elf", 12)]
    ],
)
def test_a_file_that_is_not_taken_changes_nothing(
    two: TwoBoards, tmp_path: Path, name: str, code: int
) -> None:
    wrong = {"empty": b"", "near": b"\x7fELG\1\1", "turned": b"FLE\x7f\1\1", "short": b"\x7fEL"}
    for stem, content in wrong.items():
        (tmp_path / f"{stem}.elf").write_bytes(content)
    assert two.initialise()[0] == 0
    pcap.cl(pcap.AS.of(1, 3))
    assert pcap.BootFile(name, 0) == code
    assert [pcap.rdaxstb(an, 14) for an in range(4)] == [0, 1, 0, 1]


@pytest.mark.covers("apci.BootFile", "apci.rule.dhef_reset", "apci.axst.8.dhef", "apci.rule.referenced")
@pytest.mark.covers("apci.ifs.16.pfe", "apci.ifs.20.scpfe", "apci.ifs.0.edv", "apci.ifs.1.cncrdy")
def test_booting_starts_with_open_loops_planned_outputs_and_no_errors(two: TwoBoards) -> None:
    assert two.initialise()[0] == 0
    record = pcap.TSRP(an=2)
    pcap.rdifs(record)
    assert record.ifs == 0x0011_0003
    pcap.cl(axes := pcap.AS.of(2))
    pcap.shp(pcap.TSRP(an=2, tp=7.5))
    pcap.smlr(axes, pcap.LMP(ac=-1.0, vl=1.0, dtm=[0.0, 0.0, 1.0]))
    pcap.wrdigo(pcap.TSRP(an=2, digo=0x8D))
    pcap.wrModeReg(0x81)
    pcap.rdap(record)
    kept = Axst.cl | Axst.referenced
    assert (record.axst & (kept | Axst.dhef), record.digo, record.rp) == (kept | Axst.dhef, 0x8D, 7.5)
    pcap.ol(axes)
    pcap.rdaxst(record)
    assert record.axst & Axst.dhef  # neither this nor cl ends it
    pcap.cl(axes)
    pcap.rdaxst(record)
    assert record.axst & Axst.dhef
    assert pcap.BootFile("rwmos.elf") == 0
    assert two.initialise()[0] == 0
    pcap.rdap(record)
    assert (record.axst, record.digo, record.rp, record.ifs) == (Axst.pe, 0x40, 0.0, 0x3)
    assert (pcap.rdModeReg(), pcap.rdErrorReg()) == (0, 0)


INITIALISE: list[Callable[[TwoBoards, str], int]] = [
    lambda two, name: pcap.InitMcuSystem(two.tsrp),
    lambda two, name: pcap.InitMcuSystem2(two.tsrp, 5, name),
    lambda two, name: pcap.InitMcuSystem3(two.tsrp, two.rosi, 5, name)[0],
]


@pytest.mark.covers(
    "apci.InitMcuSystem.ret.0", "apci.InitMcuSystem.ret.32", "apci.ret.bool.0", "apci.ret.bool.1"
)
@pytest.mark.covers("apci.InitMcuSystem", "apci.InitMcuSystem2", "apci.InitMcuSystem3", "apci.ROSI")
@pytest.mark.parametrize("way", range(3))
@pytest.mark.parametrize(
    ("code", "fault"),
    [
        pytest.param(code, fault, marks=pytest.mark.covers(f"apci.InitMcuSystem.ret.{code}"))
        for code, fault in [
            (33, InitCode.VERSION_MISMATCH),
            (35, InitCode.MAPPING),
            (36, InitCode.MAPPING_IN),
            (37, InitCode.MAPPING_OUT),
            (38, InitCode.BOARD_ACCESS),
            (39, InitCode.MAILBOX_ACCESS),
        ]
    ],
)
def test_what_keeps_the_board_from_being_reached_has_its_number(
    two: TwoBoards, way: int, code: int, fault: InitCode
) -> None:
    initialise = INITIALISE[way]
    two.slot.inject(fault)
    two.rosi.number_axis, two.rosi.revision = 5, "old"
    two.tsrp[2].jac = 5.5
    assert initialise(two, "system.dat") == code
    assert two.tsrp[2].jac == 5.5
    if way == 2:
        assert two.rosi == pcap.ROSI("", 0, 0)
        assert two.initialise() == (code, 0)
    assert pcap.rdSampleTime() == (0, 0)  # success is 1 here
    two.slot.repair(fault)
    two.slot.stop()
    assert initialise(two, "system.dat") == 32
    assert pcap.BootFile("rwmos.elf") == 0
    assert initialise(two, "system.dat") == 0
    assert pcap.rdSampleTime() == (1, 1280)
    assert (two.tsrp[2].jac, two.tsrp[2].an, two.tsrp[17].an) == (22.5, 2, 17)


@pytest.mark.covers("apci.txbf2", "apci.txbf", "apci.InitMcuSystem.ret.lderr", "apci.file.system_dat")
@pytest.mark.covers(*(f"apci.txbf2.ret.{code}" for code in (0, 20, 21, 22, 23, 24, 25)))
@pytest.mark.covers("apci.BoardType.32", "apci.InitMcuSystem3", "apci.mcuinit", "apci.ROSI.sysfile_loaded")
def test_what_a_transfer_returns_and_what_initialising_passes_on(two: TwoBoards, tmp_path: Path) -> None:
    files = {
        "b.dat": (b"[[axis]]\nspeed = 1\n", 24),
        "c.dat": (b"\0\1\2", 22),
        "d.cnc": (b"what is this", 22),
        "e.cnc": (sap.write_cnc(sap.compile_program("CI1 := 1;", task=3)) + b" " * (1 << 20), 21),
        "f.cnc": (sap.write_cnc(sap.compile_program("CI1 := 1;", task=3)), 0),
    }
    for name, (content, _) in files.items():
        (tmp_path / name).write_bytes(content)
    given = {"none.dat": 20, "system.dat": 0} | {name: code for name, (_, code) in files.items()}
    for name in ("none.dat", "b.dat", "c.dat"):  # no system file is loaded yet
        assert two.initialise(name) == (given[name], 32)
        assert pcap.InitMcuSystem2(two.tsrp, 0, name) == given[name]
        assert two.rosi == pcap.ROSI("V2.5.3.100", 4, 0)
    for name, code in given.items():
        assert (pcap.txbf2(name), pcap.txbf(name)) == (code, code)
        pcap.mcuinit(two.rosi)
        assert two.rosi == pcap.ROSI("V2.5.3.100", 4, int(name != "none.dat"))
        assert pcap.txbf2(str(tmp_path / name)) == code
        assert pcap.txbf(str(tmp_path / name)) == 20
    for fault, code in ((TransferCode.MEMORY, 23), (TransferCode.REMOTE, 25)):
        two.slot.inject(fault)
        assert (pcap.txbf2("system.dat"), pcap.txbf2("f.cnc")) == (code, code)
        two.slot.repair(fault)
    two.slot.stop()
    assert (pcap.txbf2("system.dat"), pcap.txbf2("none.dat")) == (25, 20)


# ---------------------------------------------------------------------- what initialising fills


@pytest.mark.covers("apci.InitMcuSystem", "apci.InitMcuSystem2", "apci.InitMcuSystem3", "apci.mcuinit")
@pytest.mark.covers("apci.ROSI.revision", "apci.ROSI.number_axis", "apci.ROSI.sysfile_loaded")
@pytest.mark.covers("apci.BoardType.32", "apci.TSRP", "apci.TSRP.an", "apci.MAXAXIS", "apci.CardSelect")
@pytest.mark.parametrize("way", range(3))
def test_initialising_reads_every_element_of_the_third_axis(two: TwoBoards, way: int) -> None:
    pcap.mcuinit(two.rosi)
    assert two.rosi == pcap.ROSI("V2.5.3.100", 4, 0)
    for record in two.tsrp:
        record.an, record.jac = 9, 1e6
    assert INITIALISE[way](two, "system.dat") == 0
    third = two.tsrp[2]
    assert (third.jac, third.jvl, third.jtv, third.hac, third.hvl) == (22.5, 23.5, -3.5, 24.5, 25.5)
    assert (third.sll, third.slr, third.ipw, third.mpe, third.gf) == (-26.5, 27.5, 0.5, 28.5, 1.5)
    assert (third.kp, third.ki, third.kd, third.kpl, third.kfca, third.kfcv) == (
        *(29.5, 30.5, 31.5, 0.625, 32.5, 33.5),
    )
    assert (third.jovr, third.rp, third.dp, third.tp, third.mcp) == (1.0, 0.0, 0.0, 0.0, 0)
    assert (third.axst, third.lsm, third.epc, third.digi) == (1 << 12, 145_000, 0, 0b1000)
    assert (third.digo, third.ifs) == (0x40, 0x0011_0003)
    assert [record.an for record in two.tsrp] == list(range(18))
    assert [record.jac for record in two.tsrp[4:]] == [1e6] * 14  # there are four axes
    pcap.mcuinit(two.rosi)
    assert two.rosi == pcap.ROSI("V2.5.3.100", 4, 1)
    # A program that comes later finds what has changed, and loads nothing.
    pcap.cl(pcap.AS.of(2))
    pcap.shp(pcap.TSRP(an=2, tp=-8.25))
    pcap.wrjac(pcap.TSRP(an=2, jac=44.5))
    pcap.wrjovr(pcap.TSRP(an=2, jovr=0.375))
    pcap.wrtp(pcap.TSRP(an=2, tp=3.25))
    pcap.smlr(pcap.AS.of(2), pcap.LMP(ac=1.0, vl=1.0, dtm=[0.0, 0.0, 1.0]))
    pcap.board().set_input(11, True)
    pcap.board().advance(1)
    assert INITIALISE[way](two, "none.dat") == 0
    assert (third.jac, third.jovr, third.rp, third.dp, third.tp) == (44.5, 0.375, -8.25, -8.25, 3.25)
    assert third.axst & (Axst.cl | Axst.referenced | Axst.pe) == Axst.cl | Axst.referenced | Axst.pe
    assert (third.digi & 0xFFFF, third.digo, third.lsm < 145_000) == (0b100_0000_1000, 0x46, True)


@pytest.mark.covers("apci.CardSelect", "apci.CardSelect.ret.minus1", "apci.getEnvStr", "apci.CppString")
@pytest.mark.covers("apci.getEnvStr.ret.positive", "apci.getEnvStr.ret.0", "apci.tool.fwsetup")
def test_every_board_has_its_own_strings(two: TwoBoards) -> None:
    assert two.initialise()[0] == 0
    two.slot.stop()
    two.slot.write_environment("Line", "x" * 1022)
    two.slot.write_environment("SerialNumber", "800822")
    assert pcap.BootFile("rwmos.elf") == 0
    assert pcap.getEnvStr("Line") == (-4, "Line")
    assert two.initialise()[0] == 0
    assert (pcap.getEnvStr("Line"), pcap.getEnvStr("SerialNumber")) == ((1022, "x" * 1022), (6, "800822"))
    assert [pcap.CardSelect(number) for number in (2, 1, -1, 1, 18)] == [-1, 1, -1, 1, -1]
    assert pcap.getEnvStr("Line") == (0, "")
    assert pcap.getEnvStr("SerialNumber")[1] != "800822"
    assert pcap.CardSelect(1) == 1


# ---------------------------------------------------------------------- records


@pytest.mark.covers("apci.scp", "apci.CTRLPARAMS")
def test_every_place_of_the_field_of_15_by_15_arrives_at_its_axis(two: TwoBoards) -> None:
    assert two.initialise()[0] == 0
    field = [[1000.25 * row - 3.5 * column for column in range(15)] for row in range(15)]
    pcap.scp(2, pcap.CTRLPARAMS(field))
    axes = pcap.board().axes
    assert axes[2].ctrlparams.tolist() == field
    assert [float(abs(axes[an].ctrlparams).sum()) for an in (0, 1, 3)] == [0.0, 0.0, 0.0]
    wrong = pcap.CTRLPARAMS([[7.0] * 15 for _ in range(15)])
    wrong.parameters[14][14] = math.inf
    pcap.scp(2, wrong)
    for an in (-1, 4):
        pcap.scp(an, pcap.CTRLPARAMS([[7.0] * 15 for _ in range(15)]))
    assert axes[2].ctrlparams.tolist() == field
    assert [float(abs(axes[an].ctrlparams).sum()) for an in (0, 1, 3)] == [0.0, 0.0, 0.0]


@pytest.mark.covers("apci.CBCNCT", "apci.CBCNCT.tasknumber", "apci.CBCNCT.size", "apci.CBCNCT.buffer")
@pytest.mark.covers("apci.rdcbcnct", "apci.wrcbcnct", "apci.const.cbsize", "apci.const.tasks")
@pytest.mark.covers("apci.cbcnct.ret.bit0", "apci.cbcnct.ret.bit1", "apci.cbcnct.ret.bit2")
def test_each_task_has_a_buffer_of_1000_bytes_and_errors_change_none(two: TwoBoards) -> None:
    assert two.initialise()[0] == 0
    sent = [bytearray((7 * k + 31 * task) % 256 for k in range(1000)) for task in range(4)]
    for task in range(4):
        assert pcap.wrcbcnct(pcap.CBCNCT(task, 1000, sent[task])) == 0
        assert pcap.wrcbcnct(pcap.CBCNCT(task, 0, bytearray(b"\xaa"))) == 0
    big, small = bytearray(b"\x55" * 1001), bytearray(b"\x55" * 3)
    for task, size, buffer, code in (
        *((4, 3, small, 0b001), (-1, 3, small, 0b001), (3, 1001, big, 0b010), (3, -1, small, 0b010)),
        *((3, 4, small, 0b100), (4, 1001, big, 0b011), (4, 4, small, 0b101)),
    ):
        assert pcap.wrcbcnct(pcap.CBCNCT(task, size, buffer)) == code
        assert pcap.rdcbcnct(pcap.CBCNCT(task, size, buffer)) == code
        assert set(buffer) == {0x55}
    for task in range(4):
        whole = bytearray(1000)
        assert pcap.rdcbcnct(pcap.CBCNCT(task, 1000, whole)) == 0
        assert whole == sent[task]
        assert pcap.rdcbcnct(pcap.CBCNCT(task, 1, part := bytearray(2))) == 0
        assert part == sent[task][:1] + b"\0"
    two.slot.stop()
    for call in (pcap.rdcbcnct, pcap.wrcbcnct):
        assert call(pcap.CBCNCT(3, 4, bytearray(4))) == 0b100  # there is no memory to be reached


@pytest.mark.covers("apci.CDBUF", "apci.CIBUF", "apci.wrci", "apci.rdci", "apci.wrcd", "apci.rdcd")
@pytest.mark.covers("apci.const.cncount", "apci.rule.commonpersist", "apci.rs")
def test_common_variables_are_of_one_board_and_survive_a_reset(two: TwoBoards) -> None:
    assert two.initialise()[0] == 0
    whole, real = pcap.CIBUF(), pcap.CDBUF()
    for k in range(1000):
        whole.ci[k], real.cd[k] = (-1) ** k * (2_147_000_000 - 1234 * k), -0.125 * k + 17.0
    for k in range(1000):
        pcap.wrci(k, whole)
        pcap.wrcd(k, real)
    for k in (-1, 1000):
        pcap.wrci(k, pcap.CIBUF())
        pcap.wrcd(k, pcap.CDBUF())
    pcap.rs()
    pcap.board().advance(2)
    pcap.rdci(1000, whole_again := pcap.CIBUF())
    pcap.rdcd(1000, real_again := pcap.CDBUF())
    assert (whole_again == whole, real_again == real) == (True, True)
    for number, read in ((99, [99]), (100, list(range(100))), (101, [101]), (1001, []), (-1, [])):
        pcap.rdci(number, some := pcap.CIBUF())
        assert [k for k in range(1000) if some.ci[k]] == read
        pcap.rdcd(number, some_real := pcap.CDBUF())
        assert [k for k in range(1000) if some_real.cd[k]] == [k for k in read if real.cd[k]]
    pcap.CardSelect(0)
    pcap.rdci(1000, other := pcap.CIBUF())
    assert other == pcap.CIBUF()


# ---------------------------------------------------------------------- tasks


@pytest.mark.covers("apci.sap", "apci.sap.multitasking", "apci.const.tasks", "apci.pcap", "apci.file.cnc")
@pytest.mark.covers("apci.startcnct", "apci.stopcnct", "apci.contcnct", "apci.stepcnct", "apci.rdcncts")
@pytest.mark.covers("apci.CNCTS", "apci.CNCTS.errnum", "apci.CNCTS.errline", "apci.CNCTS.stackfree")
@pytest.mark.covers("apci.CNCTS.running", "apci.CNCTS.running.bit0", "apci.CNCTS.csrcline", "sap.errors")
@pytest.mark.covers("apci.CNCTS.running.bit2", "apci.CNCTS.running.bit3", "apci.MODEREG.26", "sap.WRITELN")
@pytest.mark.covers("sap.EVENT", "sap.STOPCNCT", "sap.CONTCNCT", "sap.STARTCNCT", "sap.STOP", "sap.ABORT")
def test_four_tasks_are_started_stopped_and_show_what_they_do(two: TwoBoards, tmp_path: Path) -> None:
    assert two.initialise()[0] == 0
    board = pcap.board()
    programs = [
        "EVENT e ON CI40 = 1; BEGIN CI41 := CI41 + 1 END;\nBEGIN\nWHILE TRUE DO CI0 := CI0 + 1\nEND.",
        "CI1 := 5;\nwt (128);\nCI1 := CI1 DIV CI50;\nCI1 := 7;",
        "CI2 := 5;\nWRITELN ('a');\nCI2 := 6;\nSTOP;\nCI2 := 7;\nABORT;\nCI2 := 8;",
        "STOPCNCT (0);\nwt (12.8);\nCI3 := CI0;\nwt (12.8);\nCI3 := CI0 - CI3;\nCONTCNCT (0);\nSTARTCNCT (1);",
    ]
    for task, text in enumerate(programs):
        (tmp_path / "p.cnc").write_bytes(sap.write_cnc(sap.compile_program(text, task=task)))
        assert pcap.txbf2("p.cnc") == 0

    def status(task: int) -> tuple[int, ...]:
        pcap.rdcncts(task, found := pcap.CNCTS(9, 9, 9, 9, 9))
        return found.errnum, found.errline, found.running, found.csrcline

    def ci(number: int) -> int:
        pcap.rdci(number, found := pcap.CIBUF())
        return int(found.ci[number])

    for task in range(4):
        pcap.stepcnct(task)
        pcap.contcnct(task)  # none has been started
    board.advance(3)
    assert [status(task)[2] for task in range(4)] == [0, 0, 0, 0]
    assert [ci(number) for number in range(4)] == [0, 0, 0, 0]
    pcap.startcnct(1)
    board.advance(3)
    assert (status(1), ci(1)) == ((0, 0, 0b1001, 2), 5)
    pcap.stopcnct(1)
    assert status(1) == (0, 0, 0, 2)
    board.advance(200)
    pcap.stepcnct(1)
    board.advance(200)
    assert ci(1) == 5
    pcap.contcnct(1)  # the time is over by now
    board.advance(3)
    assert status(1) == (1, 3, 0, 3)  # a division by zero, in line 3
    pcap.contcnct(1)
    board.advance(3)
    assert ci(1) == 5
    pcap.wrModeReg(1 << 26)
    pcap.startcnct(2)
    board.advance(3)
    assert (status(2), ci(2)) == ((0, 0, 0b0100, 3), 5)
    assert pcap.gettskinfo(2) == (0, 0b10)
    assert [pcap.gettskinfo(task) for task in (0, 1, 3)] == [(0, 0)] * 3
    assert pcap.gettskstr(2) == (1, "a")
    pcap.contcnct(2)
    board.advance(3)
    assert (status(2), ci(2)) == ((0, 0, 0, 5), 6)
    pcap.contcnct(2)
    board.advance(3)
    pcap.contcnct(2)
    board.advance(3)
    assert (status(2)[2], ci(2)) == (0, 7)
    pcap.startcnct(0)
    board.advance(5)
    assert status(0)[2] == 1
    pcap.startcnct(3)
    board.advance(30)
    assert ci(3) == 0  # task 0 stood while task 3 waited
    before = ci(0)
    board.advance(3)
    assert (ci(0) > before, ci(1), status(1)[2]) == (True, 5, 0b1001)
    pcap.stopcnct(0)
    pcap.wrci(40, pcap.CIBUF(ci=[1] * 1000))
    board.advance(3)
    assert ci(41) == 0  # its events are not looked at
    pcap.contcnct(0)
    board.advance(3)
    assert ci(41) == 1
    pcap.rdcncts(2, found := pcap.CNCTS())
    assert found.stackfree == 32768
    pcap.rs()
    board.advance(2)
    assert [status(task)[2] for task in range(4)] == [0, 0, 0, 0]


@pytest.mark.covers("apci.sap", "apci.file.cnc", "apci.txbf2", "apci.startcnct")
def test_a_program_that_is_loaded_halts_the_one_in_its_task_and_waits_to_be_started(
    two: TwoBoards, tmp_path: Path
) -> None:
    assert two.initialise()[0] == 0
    board = pcap.board()
    for task, text in ((1, "WHILE TRUE DO CI1 := CI1 + 1;"), (2, "WHILE TRUE DO CI2 := CI2 + 1;")):
        (tmp_path / "p.cnc").write_bytes(sap.write_cnc(sap.compile_program(text, task=task)))
        assert pcap.txbf2("p.cnc") == 0
        pcap.startcnct(task)
    board.advance(3)
    (tmp_path / "p.cnc").write_bytes(sap.write_cnc(sap.compile_program("CI3 := 7;", task=1)))
    assert pcap.txbf2("p.cnc") == 0
    before = list(board.state.ci[1:4])
    board.advance(3)
    after = list(board.state.ci[1:4])
    assert (after[0], after[1] > before[1], after[2]) == (before[0], True, 0)
    pcap.rdcncts(1, status := pcap.CNCTS(9, 9, 9, 9, 9))
    assert (status.running, status.errnum) == (0, 0)
    pcap.contcnct(1)  # there is nothing to be continued
    board.advance(3)
    assert board.state.ci[3] == 0
    pcap.startcnct(1)
    board.advance(3)
    assert board.state.ci[3] == 7


@pytest.mark.covers("apci.sap", "apci.sap.multitasking", "apci.const.tasks")
def test_calls_of_four_tasks_at_once_keep_apart(two: TwoBoards, tmp_path: Path) -> None:
    assert two.initialise()[0] == 0
    for task in range(4):
        text = (
            f"PROCEDURE p (n : INTEGER); VAR k : INTEGER; BEGIN k := n; IF n > 0 THEN BEGIN p (n - 1); wt (1.28); "
            f"CI{task} := CI{task} * 2 + k END END;\nBEGIN p ({task + 3}); CI{task + 10} := 1 END."
        )
        (tmp_path / "p.cnc").write_bytes(sap.write_cnc(sap.compile_program(text, task=task)))
        assert pcap.txbf2("p.cnc") == 0
        pcap.startcnct(task)
    pcap.board().advance(40)
    pcap.rdci(100, found := pcap.CIBUF())
    assert list(found.ci[:4]) == [11, 26, 57, 120]  # ((1 * 2 + 2) * 2 + 3) * 2 + 4 ...
    assert list(found.ci[10:14]) == [1, 1, 1, 1]


@pytest.mark.covers("apci.gettskstr", "apci.const.taskstr", "apci.gettskinfo")
@pytest.mark.covers("apci.tskinfo.bit0", "apci.tskinfo.bit1", "sap.WRITE")
def test_at_most_512_bytes_of_a_string_are_returned(two: TwoBoards, tmp_path: Path) -> None:
    assert two.initialise()[0] == 0
    text = "VAR i : INTEGER; BEGIN FOR i := 1 TO 52 DO WRITE ('0123456789') END."
    (tmp_path / "p.cnc").write_bytes(sap.write_cnc(sap.compile_program(text, task=3)))
    assert pcap.txbf2("p.cnc") == 0
    for size, length in ((600, 512), (512, 512), (511, 511), (1, 1), (0, 0)):
        pcap.startcnct(3)
        pcap.board().advance(10)
        assert pcap.gettskinfo(3) == (0, 0b01)
        assert pcap.gettskstr(3, size) == (length, ("0123456789" * 52)[:length])


# ---------------------------------------------------------------------- inputs


@pytest.mark.covers(
    *(f"apci.digi.{bit}" for bit in range(16)), "sap.axis.digi", "apci.rddigi", "apci.const.digin"
)
def test_programs_read_the_inputs_that_the_pc_reads() -> None:
    pc = Pc()
    assert isinstance(pc.board.tasks, BoardTasks)
    pc.board.tasks.load(sap.compile_program("WHILE TRUE DO CI1 := A2.digi;"))
    pcap.startcnct(0)
    for levels in (0xA5C3, 0x5A3C, 0xFFFF, *(1 << bit for bit in range(16))):
        for number in range(1, 17):
            pc.board.set_input(number, bool(levels >> number - 1 & 1))
        pc.board.advance(3)
        pcap.rddigi(record := pcap.TSRP(an=1))
        assert record.digi & 0xFFFF == int(pc.board.state.ci[1]) & 0xFFFF == levels
    pcap.detach()


PLANNED = {  # function of two inputs, and the bit of axst that one of them sets
    "EO": 1,
    "DR": 2,
    "LSL_SMD": 3,
    "LSL_TOM": 3,
    "LSL_SMA": 3,
    "LSR_SMD": 4,
    "LSR_TOM": 4,
    "LSR_SMA": 4,
    "UI": 15,
    "REF": 18,
}


@pytest.mark.covers("apci.rdaxst", "apci.rdaxstb", "apci.TSRP.axst")
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize(
    "function", [pytest.param(name, marks=pytest.mark.covers(f"apci.io.{name}")) for name in PLANNED]
)
def test_each_of_several_inputs_acts_for_the_axes_that_it_is_planned_for(function: str, closed: bool) -> None:
    plan = f"functions = ['{function}']"
    system = (
        f"[inputs]\n3 = {{ {plan}, axes = ['A2'] }}\n12 = {{ {plan}, axes = ['A2', 'A3'] }}\n7 = {{ {plan} }}"
    )
    pc = Pc(f"number_of_axes = 3\n{system}")
    if closed:
        pc.close(0, 1, 2)
    bit, rest = PLANNED[function], {Axst.pe | Axst.cl * closed}
    for levels in ((), (3,), (12,), (7,), (3, 12), (3, 7, 12), (2, 4, 6, 8, 11, 13)):
        for number in range(1, 17):
            pc.board.set_input(number, number in levels)
        pc.board.advance(1)
        inputs = [sum(n in levels for n in planned) for planned in ((7,), (3, 7, 12), (7, 12))]
        shown = [count < most for count, most in zip(inputs, (1, 3, 2), strict=True)]
        shown = shown if function == "DR" else [count > 0 for count in inputs]
        for an in range(3):
            pcap.rdaxst(record := pcap.TSRP(an=an))
            assert {record.axst & ~(1 << bit)} == rest
            assert (record.axst >> bit & 1, pcap.rdaxstb(an, bit + 1)) == (shown[an], shown[an])
    pcap.detach()


# ---------------------------------------------------------------------- profiles


@pytest.mark.covers("apci.profile.move.case.v0_gt_vmax", "apci.profile.override", "apci.utrovr", "apci.smlr")
@pytest.mark.parametrize("override", [0.5, 1.0, 1.25])
def test_a_queued_move_begins_with_its_velocity_at_once_under_an_override(override: float) -> None:
    pc = Pc()
    axes = pc.close(0, 1)
    pcap.wrtrovr(override)
    pcap.utrovr(axes)
    pcap.smlr(axes, pcap.LMP(ac=1000.0, vl=20.0, tvl=20.0, dtm=[0.6, 0.8]))
    pcap.smlr(axes, pcap.LMP(ac=1000.0, vl=8.0, dtm=[0.6, 0.8]))
    pcap.ssms(axes)
    seen: list[float] = []
    while not pcap.rdaxstb(0, 13) or not seen:
        pc.board.advance(1)
        seen.append(round((pc.dv(0) ** 2 + pc.dv(1) ** 2) ** 0.5, 9))
    fastest = seen.index(20.0 * override)
    jump = next(k for k in range(fastest, len(seen)) if seen[k] != seen[fastest])
    assert seen[jump] == seen[jump + 9] == 8.0 * override
    pcap.detach()


@pytest.mark.covers("apci.ErrorReg.10.SsfWaitRefused", "apci.ssf", "apci.ssf.waitnotes", "apci.LMP.tvl")
@pytest.mark.parametrize(
    "command",
    [
        pytest.param(number, marks=pytest.mark.covers(f"apci.ssf.{number}"))
        for number in (1000, 1003, 1004, 1005, 1006, 1015, 1025)
    ],
)
def test_a_wait_behind_a_move_that_ends_at_speed_is_dropped(command: int) -> None:
    for tvl, refused in ((12.0, True), (-12.0, True), (0.0, False)):
        pc = Pc()
        axes = pc.close(1)
        pcap.smlr(axes, pcap.LMP(ac=2000.0, vl=20.0, tvl=tvl, dtm=[0.0, 2.0]))
        pcap.ssf(1, command, 6.0 if command == 1006 else 5000.0)
        pcap.ssf(1, 77, 6.0)
        pcap.ssms(axes)
        pc.board.advance(200)
        pcap.rdci(100, found := pcap.CIBUF())
        assert (pcap.rdErrorReg(), found.ci[77], found.ci[99]) == (
            (0x400, 6, 0) if refused else (0, 0, {1005: 5000, 1015: 5000, 1025: 2}.get(command, 0))
        )
        pcap.detach()


UNITS = {"mm": (0, 1.0), "inch": (1, 25.4), "m": (2, 1000.0), "counts": (6, 1e-3), "steps": (7, 1e-3)}


@pytest.mark.covers(
    "apci.ms", "apci.MODEREG.15.MS_DECEL", "apci.wrtrac", "apci.ctru", "apci.TRU", "apci.TRU.pu"
)
@pytest.mark.covers("apci.TRU.tu", "apci.tu.sec", "apci.tu.min", "apci.tu.tsample", "apci.pcap.general.units")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.covers(f"apci.pu.{name}")) for name in UNITS]
)
def test_ms_brakes_with_trac_in_the_units_of_interpolation(name: str) -> None:
    pu, unit_mm = UNITS[name]
    pc = Pc("[[axis]]\nslsp = 2000.0\ngf = 0.5\n")  # 1000 counts/mm
    axes = pc.close(0)
    pcap.wrModeReg(1 << 15)
    for tu, time_s in enumerate((1.0, 60.0, 0.00128)):
        pcap.ctru(pcap.TRU(pu=pu, tu=tu))
        ac, vl = 2540.0 / unit_mm * time_s**2, 50.8 / unit_mm * time_s
        pcap.mlr(axes, pcap.LMP(ac=ac, vl=vl, dtm=[900.0 / unit_mm]))
        pcap.wrtrac(254.0 / unit_mm * time_s**2)
        pc.board.advance(50)
        begun, velocity = pc.rp(0), pc.dv(0)
        pcap.ms(axes)
        scans = pc.scans_until_rest()
        assert velocity == near(50.8)
        assert (scans, pc.rp(0) - begun) == (157, near(5.08))  # 0.2 s, v * v / (2 * a)
    pcap.detach()


@pytest.mark.covers("apci.CMP.tvl", "apci.HMP.tvl", "apci.HMP3D.tvl", "apci.profile.target_velocity")
@pytest.mark.covers("apci.profile.move.case.negative_target_velocity")
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(way + name, marks=pytest.mark.covers(f"apci.{way}{name}"))
        for way in ("", "s")
        for name in ("mca", "mcr", "mha", "mhr", "mca3d", "mcr3d")
    ],
)
def test_a_circle_ends_with_its_target_velocity_of_either_sign(name: str) -> None:
    kind = pcap.HMP3D if name.endswith("3d") else pcap.HMP if "mh" in name else pcap.CMP
    for tvl in (6.0, -6.0):
        pc = Pc()
        axes = pc.close(0, 1, 2)
        record = kind(ac=900.0, vl=20.0, tvl=tvl, phi=90.0, dtca1=-2.0, dtca2=0.0)
        if isinstance(record, pcap.HMP3D):
            record.pn3 = 1.0
        getattr(pcap, name)(axes, record)  # a quarter about (-2, 0), to (-2, 2)
        if name.startswith("s"):
            pcap.ssms(axes)
        pc.board.advance(4)
        pc.scans_until_rest()
        assert (pc.dv(0), pc.dv(1), pc.dv(2)) == (near(-tvl), near(0.0, abs=1e-6), 0.0)
        assert (pc.rp(0), pc.rp(1)) == (near(-2.0, abs=0.02), near(2.0))
        pcap.detach()


@pytest.mark.covers(
    "apci.profile.move.preconditions", "apci.profile.acceleration", "apci.profile.max_velocity"
)
@pytest.mark.covers("apci.axst.8.dhef", "apci.rule.dhef_reset")
@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(kind, marks=pytest.mark.covers(f"apci.{kind}.ac", f"apci.{kind}.vl"), id=kind)
        for kind in ("LMP", "CMP", "HMP", "HMP3D")
    ],
)
def test_a_record_with_a_negative_acceleration_or_velocity_is_discarded(kind: str) -> None:
    record = getattr(pcap, kind)
    stem = {"LMP": "mlr", "CMP": "mcr", "HMP": "mhr", "HMP3D": "mcr3d"}[kind]
    shape: dict[str, Any] = {"dtm": [2.0, 1.0, 1.0]} if kind == "LMP" else {"phi": 90.0, "dtca1": -2.0}
    shape = shape | {"pn3": 1.0} if kind == "HMP3D" else shape
    pc = Pc()
    for name in (stem, f"s{stem}"):
        for ac, vl in ((-900.0, 20.0), (900.0, -20.0)):
            axes = pc.close(0, 1, 2)
            assert [pcap.rdaxstb(an, 9) for an in range(3)] == [0, 0, 0]
            getattr(pcap, name)(axes, record(ac=ac, vl=vl, **shape))
            assert [pcap.rdaxstb(an, 9) for an in range(3)] == [1, 1, kind != "CMP"]
            pcap.ssms(axes)
            pc.board.advance(8)
            assert [(pc.rp(an), pcap.rdMCiS(an)) for an in range(3)] == [(0.0, 0)] * 3
            pcap.ra(axes)
    pcap.detach()


IN_MINUTES = '[[axis]]\ntime_unit = "min"\nslsp = 2000.0\ngf = 0.5\n'  # 1000 counts/mm
SCAN_900_S = 0.0009


def profile(pc: Pc, scans: int) -> list[tuple[float, float]]:
    """Let scans pass and return the velocities of two axes after each, in mm/s."""
    seen = []
    for _ in range(scans):
        pc.board.advance(1)
        seen.append((pc.dv(0) / 60.0, pc.dv(1) / 60.0))
    return seen


@pytest.mark.covers("apci.rdMaxVel", "apci.rdMaxAcc", "apci.TRU.tu", "apci.tu.min", "apci.tu.tsample")
@pytest.mark.covers("apci.wrMaxVel", "apci.wrMaxAcc", "apci.wrMDVel", "apci.sstvl", "apci.var.MaxVel")
@pytest.mark.covers(
    "apci.var.MaxAcc", "apci.var.MDVEL", "apci.MODEREG.7.maxcheck", "apci.MODEREG.0.lookahead"
)
@pytest.mark.covers("apci.rule.lookahead", "apci.ctru", "apci.TRU", "apci.smlr", "apci.LMP")
@pytest.mark.parametrize(("name", "tu"), [("mm", 1), ("inch", 2), ("counts", 0)])
def test_limits_of_axes_are_in_the_units_of_interpolation(name: str, tu: int) -> None:
    pu, unit_mm = UNITS[name]
    time_s = (1.0, 60.0, SCAN_900_S)[tu]
    pc = Pc(f"sample_time_us = 900\n{IN_MINUTES}{IN_MINUTES}")
    axes = pc.close(0, 1)
    pcap.ctru(pcap.TRU(pu=pu, tu=tu))
    velocity, acceleration = time_s / unit_mm, time_s**2 / unit_mm

    def queue(x: float, y: float, ac: float, vl: float, tvl: float) -> None:
        speeds = {"ac": ac * acceleration, "vl": vl * velocity, "tvl": tvl * velocity}
        pcap.smlr(axes, pcap.LMP(**speeds, dtm=[x / unit_mm, y / unit_mm]))

    pcap.wrModeReg(0x80)
    pcap.wrMaxVel(0, 12.5 * velocity)
    pcap.wrMaxAcc(1, 160.0 * acceleration)
    queue(6.0, 8.0, 1000.0, 90.0, 0.0)  # 20.8333 mm/s and 200 mm/s2 along the path
    pcap.sstvl(axes, 7.5 * velocity)
    pcap.ssms(axes)
    assert (pcap.rdMaxVel(0), pcap.rdMaxAcc(1)) == (12.5 * velocity, 160.0 * acceleration)
    seen = profile(pc, 950)
    assert max(x for x, _ in seen) == near(12.5)
    assert seen[60] == (near(seen[59][0] + 120.0 * SCAN_900_S), near(seen[59][1] + 160.0 * SCAN_900_S))
    assert seen[-1] == (near(4.5), near(6.0))
    pcap.js(axes)
    pc.scans_until_rest()
    pcap.wrModeReg(0x1)
    pcap.wrMDVel(0, 6.5 * velocity)
    queue(3.0, 0.0, 500.0, 30.0, 30.0)
    queue(0.0, 3.0, 500.0, 30.0, 0.0)
    pcap.ssms(axes)
    seen = profile(pc, 450)
    corner = next(k for k, (_, y) in enumerate(seen) if y > 0.0)
    assert 6.5 <= seen[corner - 1][0] < 6.5 + 500.0 * SCAN_900_S
    assert 6.5 <= seen[corner][1] < 6.5 + 500.0 * SCAN_900_S
    pcap.detach()


@pytest.mark.covers("apci.TSRP.lp", "apci.rdlp", "apci.wrlp", "apci.rdlpndx", "apci.wrlpndx", "apci.szpa")
def test_latched_positions_count_from_the_zero_offset_in_force() -> None:
    pc = Pc()
    record = pcap.TSRP(an=1, lp=4.25)
    pcap.szpa(1, 2.5)
    for read, write in ((pcap.rdlp, pcap.wrlp), (pcap.rdlpndx, pcap.wrlpndx)):
        record.lp = 4.25
        write(record)
        read(record)
        assert record.lp == 4.25
    pcap.szpa(1, 0.0)
    for read in (pcap.rdlp, pcap.rdlpndx):
        read(record)
        assert record.lp == 6.75
    pcap.detach()
    assert pc.code == 0


@pytest.mark.covers("apci.ctrl.scantime", "apci.ssf.1003", "apci.rdSampleTime", "apci.wrtrovrst")
@pytest.mark.covers("apci.spd", "apci.rddv")
@pytest.mark.parametrize("scan_us", [800, 2000])
def test_what_takes_a_time_takes_as_many_scans_as_it_has(scan_us: int) -> None:
    pc = Pc(f"sample_time_us = {scan_us}\n[[axis]]\n")
    axes, scans_in_s = pc.close(0), 1_000_000 // scan_us
    assert pcap.rdSampleTime() == (1, scan_us)

    def scans_until(changed: Callable[[], bool]) -> int:
        done = 0
        while not changed():
            done += pc.board.advance(1)
        return done

    def waited(value: float) -> int:
        pcap.wrci(7, pcap.CIBUF())
        pcap.ssf(0, 1003, value)
        pcap.ssf(0, 7, 1.0)
        pcap.ssms(axes)
        return scans_until(lambda: bool(pc.board.state.ci[7]))

    assert waited(9375.0) - waited(3125.0) == scans_in_s * 2 // 5  # 64 us each
    pcap.wrtrovrst(0.8)
    pcap.wrtrovr(0.5)
    pcap.utrovr(axes)

    def override() -> float:
        pcap.rdjovr(record := pcap.TSRP(an=0))
        return float(record.jovr)

    assert scans_until(lambda: override() == 0.5) == near(scans_in_s * 2 // 5, abs=1)
    pcap.spd(0, 3, pcap.SPDBUF(position=[0.5, 1.25, 1.25, *[0.0] * 997]))
    pcap.ssms(axes)
    seen = []
    for _ in range(3):
        pc.board.advance(1)
        seen.append((pc.rp(0), pc.dv(0)))
    assert seen == [(0.5, near(0.5 * scans_in_s)), (1.25, near(0.75 * scans_in_s)), (1.25, 0.0)]
    pcap.detach()


# ---------------------------------------------------------------------- messages

_TRANSFER = {
    0: "transferred",
    20: "opened",
    21: "larger than the memory of a cnc task",
    22: "neither a system file nor a cnc file",
    23: "no memory",
    24: "no such task, or the system file is damaged",
    25: "transfer to the remote system",
}
CODES = {  # of each function, all that the manual lists, and what the text says of it
    "BootErrorReport": {
        0: "booted",
        10: "file name",
        11: "cannot be opened",
        12: "no elf file",
        13: "elf file is damaged, or its transfer",
        14: "start address",
        15: "for another board",
        16: "did not receive what was sent",
        200: "flash memory cannot be reached",
        201: "flash memory has the wrong size",
        202: "at its addresses",
    },
    "InitMcuErrorReport": {
        **_TRANSFER,
        0: "initialised",
        31: "no board",
        32: "operating system is not loaded, or has stopped",
        33: "do not belong together",
        34: "driver cannot be opened",
        35: "memory cannot be mapped (",
        36: "memory cannot be mapped in (",
        37: "memory cannot be mapped out (",
        38: "board cannot be reached",
        39: "mailbox",
    },
    "txbfErrorReport": _TRANSFER,
}


@pytest.mark.covers(*(f"apci.{name}" for name in CODES), "apci.MsgToScreen")
@pytest.mark.covers(*(f"apci.BootFile.ret.{code}" for code in CODES["BootErrorReport"]))
@pytest.mark.covers(*(f"apci.InitMcuSystem.ret.{code}" for code in (0, *range(31, 40))))
@pytest.mark.covers(*(f"apci.txbf2.ret.{code}" for code in _TRANSFER))
def test_a_report_knows_the_codes_of_its_function_and_no_others() -> None:
    shown: list[str] = []
    pcap.attach(show=shown.append)
    for name, codes in CODES.items():
        texts = {}
        for code in range(-5, 210):
            if name == "InitMcuErrorReport":
                pcap.InitMcuErrorReport(code)
            else:
                getattr(pcap, name)("some.file", code)
            texts[code] = shown.pop()
            assert texts[code].endswith(f"({code})")
            assert ("some.file" in texts[code]) == (name != "InitMcuErrorReport")
        assert [code for code, text in texts.items() if "unknown" not in text] == sorted(codes)
        for code, words in codes.items():
            assert words in texts[code].lower()
    assert not shown
    pcap.detach()


# ---------------------------------------------------------------------- interrupts, relays, errors


@pytest.mark.covers("apci.MCUG3_SetBoardIntRoutine", "apci.MCUG3_ResetBoardIntRoutine")
@pytest.mark.covers("apci.InterruptRoutine", "apci.ssf.1101", "apci.rule.interrupt", "apci.rdirqpc")
def test_the_routine_gets_the_interrupts_of_the_board_that_was_selected(two: TwoBoards) -> None:
    assert two.initialise()[0] == 0
    seen: list[int] = []
    pcap.cl(axes := pcap.AS.of(3))
    pcap.MCUG3_SetBoardIntRoutine(seen.append)
    pcap.ssf(3, 1101, 0.0)
    pcap.ssms(axes)
    pcap.board().advance(4)
    assert (seen, pcap.rdirqpc()) == ([1], 1)
    pcap.MCUG3_ResetBoardIntRoutine()
    pcap.ssf(3, 1101, 0.0)
    pcap.ssms(axes)
    pcap.board().advance(4)
    assert seen == [1]


@pytest.mark.covers("apci.rule.relays", "apci.io.PAE", "apci.cl", "apci.clv", "apci.ol", "apci.ra", "apci.rs")
def test_outputs_and_relays_follow_the_loops_of_their_axes(two: TwoBoards) -> None:
    assert two.initialise()[0] == 0

    def shown() -> tuple[int, list[bool]]:
        pcap.rddigo(record := pcap.TSRP(an=3))
        return record.digo, [axis.relay for axis in pcap.board().axes]

    pcap.wrdigo(pcap.TSRP(an=0, digo=0x81))
    assert shown() == (0x81, [False, False, False, False])
    pcap.cl(pcap.AS.of(2))
    assert shown() == (0x87, [False, False, True, False])  # output 3 is that of all axes
    pcap.clv(pcap.AS.of(3, 1))
    assert shown() == (0x97, [False, True, True, True])
    pcap.ol(pcap.AS.of(1))
    assert shown() == (0x83, [False, False, True, True])  # of an output that axes share too
    pcap.cl(pcap.AS.of(0))
    assert shown() == (0x97, [True, False, True, True])
    pcap.ra(pcap.AS.of(3))
    assert shown() == (0x40, [True, False, True, False])  # the outputs of the group are as planned
    pcap.rs()
    assert shown() == (0x40, [False, False, False, False])


@pytest.mark.covers("apci.ErrorReg.4.errSpoolerOverrun", "apci.ErrorReg.14.LimitDefError", "apci.rdErrorReg")
@pytest.mark.covers("apci.const.spdsize", "apci.SPDBUF", "apci.rdlsm", "apci.const.spoolmem")
def test_a_spooler_that_is_full_takes_nothing_more_and_says_so(two: TwoBoards) -> None:
    assert two.initialise()[0] == 0
    pcap.cl(axes := pcap.AS.of(1, 2))
    record, points = pcap.TSRP(an=2), pcap.SPDBUF(position=[0.001 * k for k in range(1000)])
    for size in (0, -1, 1001):
        pcap.spda(2, size, points, 5)
    pcap.rdlsm(record)
    assert (record.lsm, pcap.rdErrorReg()) == (145_000, 0)
    while not pcap.rdErrorReg():
        before, moves = record.lsm, pcap.rdMCiS(2)
        pcap.smlr(axes, pcap.LMP(ac=100.0, vl=10.0, dtm=[0.0, 1.0, 2.0]))
        pcap.rdlsm(record)
    assert (pcap.rdErrorReg(), record.lsm, pcap.rdMCiS(2)) == (ErrorReg.errSpoolerOverrun, before, moves)
    assert pcap.rdMCiS(1) == moves > 900
    pcap.sdels(axes)
    pcap.rdlsm(record)
    assert record.lsm == 145_000
