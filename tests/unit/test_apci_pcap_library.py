"""The library in a program: attaching, booting, selecting, time, codes of a board that does not answer, its table."""

import inspect
import logging
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from polycnc.conformance import load_conformance
from polycnc.controllers.apci import pcap
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import InitCode
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.controllers.apci.library._call import LIBRARY
from polycnc.controllers.apci.pc._installed import InstalledBoard
from polycnc.controllers.library import IN
from polycnc.errors import UsageError
from polycnc.machine import Elapsed, Poll
from support.apci_pc import LATENCY, SCAN_S, Pc, near
from support.time_sources import FakeWall

NUMBERED = ("an", "axis")


@pytest.fixture(autouse=True)
def empty_pc() -> Iterator[None]:
    yield
    pcap.detach()


def initialise(name: str = "system.dat") -> tuple[int, int]:
    return pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, name)


# ---------------------------------------------------------------------- booting and selecting


@pytest.mark.covers("apci.BootFile", "apci.InitMcuSystem3", "apci.mcuinit", "apci.ROSI")
@pytest.mark.covers("apci.ifs.16.pfe", "apci.ifs.20.scpfe")
def test_a_program_boots_a_board_and_initialises_the_system(tmp_path: Path) -> None:
    (tmp_path / "rwmos.elf").write_bytes(b"\x7fELF")
    (tmp_path / "system.dat").write_text("[[axis]]\njac = 321.0\n[[axis]]\n")
    pcap.attach(InstalledBoard(), booted=False, folder=tmp_path)
    assert initialise() == (32, 0)
    assert pcap.BootFile("rwmos.elf", 0) == 0
    rosi = pcap.ROSI()
    pcap.mcuinit(rosi)
    assert (rosi.revision, rosi.sysfile_loaded) == ("V2.5.3.100", 0)
    tsrp = pcap.tsrp_array()
    assert pcap.InitMcuSystem3(tsrp, rosi, 0, "system.dat") == (0, 4)
    assert ([record.an for record in tsrp], tsrp[0].jac) == (list(range(18)), 321.0)
    assert (rosi.number_axis, rosi.sysfile_loaded) == (2, 1)
    pcap.rdifs(tsrp[0])
    assert tsrp[0].ifs == 0x0011_0003  # switched on: both power failures are shown
    axes = pcap.AS.of(0)
    pcap.cl(axes)
    tsrp[0].tp = 1.0
    pcap.ja(axes, tsrp)
    while not pcap.rdaxstb(0, 13):
        pass
    pcap.rdrp(tsrp[0])
    assert tsrp[0].rp == 1.0
    assert pcap.BootFile("rwmos.elf", 0) == 0
    pcap.rdrp(tsrp[0])
    assert (tsrp[0].rp, pcap.rdaxstb(0, 13)) == (1.0, 0)  # not read: it must be initialised again
    assert pcap.InitMcuSystem3(tsrp, rosi, 0, "system.dat") == (0, 4)
    pcap.rdifs(tsrp[0])
    assert tsrp[0].ifs == 0x0000_0003  # a second boot has lost them


@pytest.mark.covers("apci.InitMcuSystem", "apci.InitMcuSystem2", "apci.InitMcuSystem3", "apci.txbf")
def test_the_older_ways_to_initialise(tmp_path: Path) -> None:
    (tmp_path / "rwmos.elf").write_bytes(b"\x7fELF")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "my.dat").write_text("[[axis]]\njac = 55.0\n")
    for way in (1, 2):
        pcap.attach(InstalledBoard(), booted=False, folder=tmp_path)
        assert pcap.BootFile("rwmos.elf") == 0
        tsrp = pcap.tsrp_array()
        if way == 1:
            assert pcap.InitMcuSystem(tsrp) == 20  # there is no system.dat
            (tmp_path / "system.dat").write_text("[[axis]]\njac = 55.0\n")
            assert pcap.txbf("folder/my.dat") == 20
            assert pcap.InitMcuSystem(tsrp) == 0
        else:
            assert pcap.InitMcuSystem2(tsrp, 0, "folder/my.dat") == 0
        assert tsrp[0].jac == 55.0
    # A board that runs with its defaults takes the file that is named, even by the oldest of them.
    for initialise_it in (
        pcap.InitMcuSystem,
        lambda tsrp: pcap.InitMcuSystem2(tsrp, 0, "system.dat"),
        lambda tsrp: pcap.InitMcuSystem3(tsrp, pcap.ROSI(), 0, "system.dat")[0],
    ):
        pcap.attach(Board(), folder=tmp_path)
        tsrp = pcap.tsrp_array()
        assert initialise_it(tsrp) == 0
        assert (tsrp[0].jac, tsrp[17].an) == (55.0, 17)


@pytest.mark.covers("apci.InitMcuSystem.ret.31", "apci.InitMcuSystem.ret.34")
def test_without_a_board_or_driver_every_call_says_so_or_does_nothing() -> None:
    assert initialise() == (InitCode.NO_BOARD, 0)
    with pytest.raises(LookupError):
        pcap.board()
    assert pcap.MCUG3_SetBoardIntRoutine(print) == pcap.MCUG3_ResetBoardIntRoutine() == 0
    pcap.attach(Board(), driver_installed=False)
    assert initialise() == (InitCode.NO_DRIVER, 0)


@pytest.mark.covers("apci.CardSelect", "apci.CardSelect.ret.minus1")
def test_the_selected_board_gets_all_calls() -> None:
    first, second = (
        Board(parse_system_file("[[axis]]\njac = 11.0\n")),
        Board(parse_system_file("[[axis]]\njac = 22.0\n")),
    )
    pcap.attach(first, second, clock=None)
    record = pcap.TSRP(an=0)
    for card, jac in ((0, 11.0), (1, 22.0)):
        initialise()
        assert pcap.CardSelect(card) == card
        initialise()
        pcap.rdjac(record)
        assert record.jac == jac
        pcap.cl(pcap.AS.of(0))
        assert pcap.board() is (first, second)[card]
    assert pcap.CardSelect(2) == -1
    pcap.rdjac(record)
    assert record.jac == 11.0
    assert pcap.rdaxstb(0, 14) == 1


@pytest.mark.covers("apci.getEnvStr")
def test_an_environment_string_comes_with_its_length() -> None:
    Pc('[environment]\nSerialNumber = "4711"\n')
    assert pcap.getEnvStr("SerialNumber") == (4, "4711")
    assert pcap.getEnvStr("nothing") == (0, "")
    Pc(revision="V2.5.3.36")
    assert pcap.getEnvStr("SerialNumber")[0] == -1
    pcap.detach()
    assert pcap.getEnvStr("SerialNumber")[0] == -4


@pytest.mark.covers(
    "apci.MsgToScreen", "apci.BootErrorReport", "apci.InitMcuErrorReport", "apci.txbfErrorReport"
)
def test_messages_go_where_the_program_wants(caplog: pytest.LogCaptureFixture) -> None:
    shown: list[str] = []
    pcap.attach(show=shown.append)
    pcap.BootErrorReport("rwmos.elf", 11)
    pcap.InitMcuErrorReport(32)
    pcap.txbfErrorReport("system.dat", 20)
    assert ["rwmos.elf" in shown[0], "(32)" in shown[1], "system.dat" in shown[2]] == [True] * 3
    pcap.MsgToScreen(0)
    pcap.InitMcuErrorReport(32)
    assert len(shown) == 3
    pcap.attach()
    with caplog.at_level(logging.WARNING, "polycnc.apci"):
        pcap.InitMcuErrorReport(31)
    assert "(31)" in caplog.text


# ---------------------------------------------------------------------- time


def test_reading_the_same_again_lets_one_scan_pass_and_other_calls_none() -> None:
    pc = Pc(clock=Poll(1))
    start = pc.board.clock.cycles
    axes = pc.close(0)
    pcap.rdjac(pc.tsrp[0])
    pcap.rdtrac()
    pc.tsrp[0].tp = 1.0
    pcap.jr(axes, pc.tsrp)
    pcap.rdEffRadius(0)
    pcap.rdEffRadius(0)
    for axis in (0, 1):  # all of one scan
        pcap.rdrp(pc.tsrp[axis])
        pcap.rdaxst(pc.tsrp[axis])
        pcap.rdaxstb(axis, 13)
        pcap.rdaxstb(axis, 14)
    pcap.rdErrorReg()
    assert pc.board.clock.cycles == start
    pcap.rdrp(pc.tsrp[1])
    assert pc.board.clock.cycles == start + 1
    pcap.rdaxstb(1, 14)
    pcap.rdErrorReg()
    assert pc.board.clock.cycles == start + 1
    pcap.rdErrorReg()
    pcap.rdaxstb(1, 14)
    pcap.rdaxstb(1, 14)
    assert pc.board.clock.cycles == start + 3
    pcap.rdrp(pcap.TSRP(an=9))
    pcap.rdrp(pcap.TSRP(an=9))
    assert pc.board.clock.cycles == start + 3


def test_a_program_that_sleeps_between_its_polls_sees_a_board_in_real_time() -> None:
    wall = FakeWall()
    pc = Pc("[[axis]]\njac = 100.0\njvl = 10.0\n", clock=Elapsed(wall))
    axes = pc.close(0)
    pc.tsrp[0].tp = 14.0  # 0.1 s to 10 units/s, 1.3 s at it, 0.1 s to rest
    start_s = wall.time_s
    pcap.ja(axes, pc.tsrp)
    while not pcap.rdaxstb(0, 13):
        wall.time_s += 0.01
    assert wall.time_s - start_s == near(1.5, abs=0.02)
    assert pc.board.clock.now_s == near(wall.time_s - start_s, abs=2 * SCAN_S)


def test_polling_to_the_next_event_ends_at_once_and_gives_the_same_motion() -> None:
    ends = []
    for clock, most in ((Poll(1), 10_000), (Poll(100_000), 2)):
        pc = Pc(clock=clock)
        axes = pc.close(0)
        pc.tsrp[0].tp = 100.0
        pcap.ja(axes, pc.tsrp)
        calls = 0
        while not pcap.rdaxstb(0, 13):
            calls += 1
        assert calls <= most
        ends.append((pc.board.clock.cycles, pc.rp(0)))
    assert ends[0][0] == ends[1][0]
    assert ends[0][1] == ends[1][1] == 100.0


def test_without_a_clock_only_the_board_moves_time() -> None:
    pc = Pc(clock=None)
    for _ in range(10):
        pcap.rdaxstb(0, 13)
    assert pc.board.clock.cycles == 0
    pc.board.advance(LATENCY)
    assert pcap.board().clock.cycles == LATENCY


# ---------------------------------------------------------------------- codes


def code_functions() -> dict[str, tuple[object, ...]]:
    """Return the functions with the usual status, and arguments for them."""
    by_axis = ("dpoffset", "dvoffset", "gfaux")
    of_board = ("trac", "trvl", "trtvl", "trovrst")
    return {
        **{f"rd{name}": (0,) for name in (*by_axis, "PcapIndex", "ZeroOffset")},
        **{f"wr{name}": (0, 0.5) for name in by_axis},
        **{f"rd{name}": () for name in of_board},
        **{f"wr{name}": (0.5,) for name in of_board},
        "gettskinfo": (0,),
        "rdifs": (pcap.TSRP(),),
    }


@pytest.mark.parametrize(("name", "arguments"), code_functions().items(), ids=code_functions())
@pytest.mark.covers("apci.ret.0", "apci.ret.minus4", "apci.pcap.general.timeout")
def test_a_status_is_0_or_minus_4_when_the_operating_system_has_stopped(
    name: str, arguments: tuple[object, ...]
) -> None:
    pc = Pc()

    def code() -> int:
        returned = getattr(pcap, name)(*arguments)
        return int(returned[0] if isinstance(returned, tuple) else returned)

    assert code() == 0
    pc.slot.stop()
    assert code() == -4
    assert initialise() == (32, 0)


@pytest.mark.parametrize(
    "name", ["wrdpoffset", "wrdvoffset", "wrgfaux", "rddpoffset", "rdPcapIndex", "rdZeroOffset"]
)
@pytest.mark.covers("apci.ret.other", "apci.gettskinfo", "apci.const.tasks")
def test_an_unknown_axis_is_an_unknown_error(name: str) -> None:
    Pc()
    returned = getattr(pcap, name)(*((3, 0.5) if name.startswith("wr") else (3,)))
    assert returned == ((1, 0) if isinstance(returned, tuple) else 1)
    assert [pcap.gettskinfo(task) for task in (-1, 3, 4)] == [(1, 0), (0, 0), (1, 0)]  # nor is there a task 4


@pytest.mark.covers("apci.rdErrorReg", "apci.rdirqpc", "apci.rdrv")
@pytest.mark.covers("apci.pcap.general.timeout")
def test_functions_without_a_status_do_nothing_when_the_board_does_not_answer() -> None:
    pc = Pc()
    axes = pc.close(0)
    pc.slot.stop()
    pc.tsrp[0].tp, pc.tsrp[0].jac = 5.0, 7.0
    before = pc.board.axes[0].jac
    pcap.ja(axes, pc.tsrp)
    pcap.ol(axes)
    pcap.wrjac(pc.tsrp[0])
    pcap.rs()
    pcap.wrdigob(0, 1, 1)
    pcap.wrledgn(1)
    pcap.ctru(pcap.TRU(1, 1))
    pcap.azo(1)
    pcap.wrModeReg(1)
    pc.board.advance(100)
    axis = pc.board.axes[0]
    assert (axis.jac, axis.rp, int(axis.row["closed"]), pc.board.outputs) == (before, 0.0, 1, 0)
    assert (pc.board.variables.pu, pc.board.variables.ledgn, pc.board.modereg) == (0, 0, 0)
    assert (pcap.rdaxstb(0, 14), pcap.rdErrorReg(), pcap.rdrv(0), pcap.rdJerkRel(0), pcap.rdirqpc()) == (
        0,
    ) * 5
    record = pcap.TSRP(an=0, jac=7.0, rp=8.0)
    for read in (pcap.rdjac, pcap.rdrp, pcap.rdap, pcap.rdf):
        read(record)
    assert record == pcap.TSRP(an=0, jac=7.0, rp=8.0)


# ---------------------------------------------------------------------- the table


ROW_OF = {
    row.id.removeprefix("apci."): row.signature
    for row in load_conformance().rows("apci")
    if row.kind == "function"
}
# Part 1 names these functions, but prints no prototype of them.
WITHOUT_PROTOTYPE = {
    *("rdSysVarInt", "rdSysVarDbl", "wrSysVarInt", "wrSysVarDbl"),
    *("rdAxVarInt", "rdAxVarDbl", "wrAxVarInt", "wrAxVarDbl"),
    *("txbf", "rdjovr", "smlai", "smlri", "ssfi", "ssfni"),
}


def printed(signature: str) -> str:
    """Return the C prototype of a row, without what says nothing: far, struct, blanks around stars."""
    found = re.match(r"C: (.*?\))", signature)
    assert found, signature
    plain = re.sub(r"\b(far|struct) ?", "", found[1])
    return re.sub(r" ?\* ?", " *", plain)


@pytest.mark.parametrize("name", ROW_OF)
@pytest.mark.covers("apci.pcap", "apci.lib.dll")
def test_every_function_of_the_manual_is_there_with_its_prototype_and_a_description(name: str) -> None:
    function, row = getattr(pcap, name), pcap.FUNCTIONS[name]
    assert name in pcap.__all__
    assert function.__name__ == name
    assert "Manual 002" in inspect.getdoc(function)  # type: ignore[operator]
    assert [each.name.replace("as", "asel") if each.name == "as" else each.name for each in row.passed] == [
        each.rstrip("_") for each in inspect.signature(function).parameters
    ]
    assert (name in WITHOUT_PROTOTYPE) == (not ROW_OF[name].startswith("C: "))
    if name not in WITHOUT_PROTOTYPE:
        assert row.prototype == printed(ROW_OF[name])


def test_the_table_has_the_functions_of_the_manual_and_no_others() -> None:
    assert set(pcap.FUNCTIONS) == set(ROW_OF)
    assert (len(ROW_OF), len(WITHOUT_PROTOTYPE)) == (197, 14)


RECORDS_READ_AND_FILLED = {
    *(
        "InitMcuSystem",
        "InitMcuSystem2",
        "InitMcuSystem3",
        "rdap",
        "rdaux",
        "rdaxst",
        "rddigi",
        "rddigo",
        "rddp",
        "rddpd",
    ),
    *(
        "rddv",
        "rdepc",
        "rdf",
        "rdgf",
        "rdhac",
        "rdhvl",
        "rdifs",
        "rdipw",
        "rdjac",
        "rdjovr",
        "rdjtvl",
        "rdjvl",
        "rdlp",
    ),
    *("rdlpndx", "rdlsm", "rdmcp", "rdmpe", "rdrp", "rdrpd", "rdsdec", "rdsll", "rdslr", "rdtp", "rdtpd"),
}


def test_every_argument_has_a_direction() -> None:
    filled = {
        (name, each.name)
        for name, row in pcap.FUNCTIONS.items()
        for each in row.arguments
        if each.direction is not IN and not each.returned
    }
    assert filled == {(name, "tsrp") for name in RECORDS_READ_AND_FILLED} | {
        ("InitMcuSystem3", "rosi"),
        ("mcuinit", "rosi"),
        ("rdcncts", "cncts"),
        ("rdcd", "cdbuf"),
        ("rdci", "cibuf"),
        ("rdcbcnct", "cbcnct"),
    }
    returned = {
        name: [each.name for each in row.arguments if each.returned] for name, row in pcap.FUNCTIONS.items()
    }
    assert {name for name, names in returned.items() if names == ["value"]} == {
        name
        for name, signature in ROW_OF.items()
        if name.startswith("rd") and re.search(r"(long|double) ?\* ?value\)", signature)
    }
    assert {name: names for name, names in returned.items() if names not in ([], ["value"])} == {
        "getEnvStr": ["EnvStr"],
        "gettskinfo": ["tskinfo"],
        "gettskstr": ["buffer"],
        "InitMcuSystem3": ["BoardType"],
        "rdErrorReg": ["ErrorReg"],
        "rdPcapIndex": ["PcapIndex"],
    }
    assert {
        name for name, row in pcap.FUNCTIONS.items() if any(each.length_of for each in row.arguments)
    } == {
        *("gettskstr", "spd", "spda", "spdr"),
    }


def test_two_programs_have_their_own_boards_and_time() -> None:
    here, there = pcap.Session(), pcap.Session()
    mine, theirs = Board(), Board()
    here.attach(mine, clock=Poll(3))
    there.attach(theirs, clock=Poll(5))
    tsrp = pcap.tsrp_array()
    assert here.InitMcuSystem3(tsrp, pcap.ROSI(), 0, "system.dat")[0] == 0
    assert there.rdrv(0) == 0.0  # it has not initialised
    assert (mine.clock.cycles, theirs.clock.cycles) == (0, 0)
    here.rdrp(tsrp[0])
    here.rdrp(tsrp[0])
    assert (mine.clock.cycles, theirs.clock.cycles) == (3, 0)
    assert pcap.CardSelect(0) == -1
    assert here.CardSelect(0) == 0
    assert (here.board(), there.board()) == (mine, theirs)


def test_what_no_c_compiler_takes_is_told_with_the_prototype() -> None:
    Pc()
    calls: list[tuple[Any, ...]] = [(pcap.cl, None), (pcap.cl, pcap.LMP()), (pcap.rdrv, "x")]
    for call, *given in [*calls, (pcap.mla, pcap.AS.of(0), pcap.CMP())]:
        with pytest.raises(UsageError, match="cannot be") as told:
            call(*given)
        assert call.__name__ in str(told.value.hint)


def test_a_wrong_number_of_arguments_of_any_function_is_reported_with_its_prototype() -> None:
    Pc()
    for name, function in LIBRARY.functions.items():
        call = getattr(pcap, name)
        parameters = inspect.signature(call).parameters.values()
        needed = sum(each.default is inspect.Parameter.empty for each in parameters)
        for given in ((0,) * count for count in (*range(needed), len(function.passed) + 1)):
            with pytest.raises(UsageError, match=name) as told:
                call(*given)
            assert told.value.hint == function.prototype
            assert f"{name}(" in str(told.value.hint)
    with pytest.raises(UsageError, match=r"wrgf: .*speed"):
        pcap.wrgf(pcap.TSRP(an=0), speed=3)  # type: ignore[call-arg]


def test_the_library_keeps_no_state_but_what_is_attached() -> None:
    pc = Pc()
    pcap.wrjac(pcap.TSRP(an=0, jac=5.0))
    other = Pc()
    pcap.rdjac(record := pcap.TSRP(an=0))
    assert (record.jac, pc.board.axes[0].jac) == (other.board.axes[0].jac, 5.0)
