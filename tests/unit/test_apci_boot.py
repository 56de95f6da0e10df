"""From the empty PC to an initialised board: every code of booting, initialising and transferring files."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from polycnc.controllers.apci.board._codes import BootCode, InitCode, Status, TransferCode, status_text
from polycnc.controllers.apci.board._declared import ROSI, TSRP, CppString
from polycnc.controllers.apci.board._environment import (
    LED_PLACES,
    EnvironmentStrings,
    InterfaceStatus,
    InterruptLine,
    InterruptRoutine,
    Leds,
    Messages,
)
from polycnc.controllers.apci.board._records import tsrp_array
from polycnc.controllers.apci.board._system_file import SystemFile, parse_system_file
from polycnc.controllers.apci.core._registers import Ifs, assigned_inputs, board_name
from polycnc.controllers.apci.pc._boot import Application
from polycnc.controllers.apci.pc._slots import FAULTS, Pc, Slot, revision_numbers
from polycnc.controllers.library import Code
from polycnc.errors import UsageError


class Board:
    """A board that only remembers what was done to it."""

    def __init__(self, number_of_axes: int = 3, board_type: int = 4) -> None:
        self.number_of_axes = number_of_axes
        self.board_type = board_type
        self.done: list[str] = []
        self.jac = 0.0
        self.answer = 0
        self.is_described = True

    def reset(self) -> None:
        self.done.append("reset")
        self.jac = 0.0

    def load_system(self, config: SystemFile) -> None:
        self.done.append("system")
        self.jac = config.axes[0].jac

    def load_program(self, content: bytes) -> int:
        self.done.append(f"program {content!r}")
        return self.answer

    def axis_parameters(self, axis: int) -> Mapping[str, float]:
        return {"jac": self.jac + axis, "mcp": -axis}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rwmos.elf").write_bytes(b"\x7fELF and more")
    (tmp_path / "system.dat").write_text("[[axis]]\njac = 77.0\n")
    return tmp_path


def equipped(folder: Path, *boards: Board) -> tuple[Application, list[Slot]]:
    pc = Pc()
    for board in boards:
        pc.attach(board, environment={"SerialNumber": "4711", "Empty": ""})
    return Application(pc, folder), pc.slots


def booted(folder: Path) -> tuple[Application, Slot, Board]:
    board = Board()
    application, (slot,) = equipped(folder, board)
    assert application.boot_file("rwmos.elf", 0) == 0
    return application, slot, board


def ready(folder: Path) -> tuple[Application, Slot, Board]:
    application, slot, board = booted(folder)
    assert application.init_mcu_system3(tsrp_array(), ROSI(), 0, "system.dat") == (0, 4)
    return application, slot, board


# --- booting


@pytest.mark.covers("apci.BootFile.ret.0")
def test_booting_resets_the_board_and_starts_its_operating_system(folder: Path) -> None:
    application, slot, board = booted(folder)
    assert board.done == ["reset"]
    assert (slot.running, slot.sysfile_loaded, slot.boots) == (True, False, 1)
    assert application.boot_file(str(folder / "rwmos.elf")) == BootCode.DONE  # with its folder
    assert slot.boots == 2


@pytest.mark.parametrize(
    ("name", "code"),
    [
        pytest.param(name, code, marks=pytest.mark.covers(f"apci.BootFile.ret.{code}"))
        for name, code in [
            ("", 10),
            ("rw\0mos.elf", 10),
            ("rwmos?.elf", 10),
            (" ", 10),
            ("none.elf", 11),
            (".", 11),
        ]
    ]
    + [pytest.param("system.dat", 12, marks=pytest.mark.covers("apci.BootFile.ret.12"))],
)
def test_a_file_that_cannot_be_booted_leaves_the_board_alone(folder: Path, name: str, code: int) -> None:
    application, slot, board = ready(folder)
    done = list(board.done)
    assert application.boot_file(name) == code
    assert board.done == done
    assert (slot.running, slot.sysfile_loaded, slot.boots) == (True, True, 1)
    assert application.status() == Status.DONE


@pytest.mark.covers("apci.BootFile")
@pytest.mark.parametrize(
    ("code", "resets"),
    [
        pytest.param(code, code < 200, marks=pytest.mark.covers(f"apci.BootFile.ret.{code}"))
        for code in (13, 14, 15, 16, 200, 201, 202)
    ],
)
def test_a_fault_of_the_hardware_ends_booting(folder: Path, code: int, resets: bool) -> None:
    application, slot, board = booted(folder)
    slot.inject(BootCode(code))
    assert application.boot_file("rwmos.elf", 0) == code
    assert slot.running is not resets
    assert board.done == ["reset"] * (2 if resets else 1)
    slot.repair(BootCode(code))
    assert application.boot_file("rwmos.elf", 0) == 0
    assert slot.running


@pytest.mark.covers("apci.BootFile", "apci.file.rwmos_elf")
def test_booting_needs_a_board_an_elf_file_and_initialisation_afterwards(folder: Path) -> None:
    assert Application(Pc(), folder).boot_file("rwmos.elf") == 202
    application, slot, board = ready(folder)
    assert application.status() == Status.DONE
    assert application.boot_file("rwmos.elf", 5) == 0  # the second argument has no meaning
    assert application.status() == Status.TIMEOUT
    assert not slot.sysfile_loaded
    assert application.init_mcu_system2(tsrp_array(), 0, "system.dat") == 0
    assert application.status() == Status.DONE
    assert board.done == ["reset", "system", "reset", "system"]
    slot.inject(InitCode.VERSION_MISMATCH)  # what was loaded does not fit the library
    assert application.init_mcu_system2(tsrp_array(), 0, "system.dat") == 33


def test_only_faults_of_the_hardware_can_be_made_to_happen() -> None:
    slot = Slot(Board())
    for code in (
        BootCode.DONE,
        BootCode.CANNOT_OPEN,
        InitCode.NOT_BOOTED,
        TransferCode.DAMAGED,
        Status.TIMEOUT,
    ):
        with pytest.raises(UsageError, match="no fault of the hardware"):
            slot.inject(code)
    assert len(FAULTS) == len(set(FAULTS)) == 7 + 6 + 2


# --- initialising


def initialise(application: Application, way: int, tsrp: list[TSRP], name: str = "system.dat") -> int:
    if way == 1:
        return application.init_mcu_system(tsrp)
    if way == 2:
        return application.init_mcu_system2(tsrp, 0, name)
    return application.init_mcu_system3(tsrp, ROSI(), 0, name)[0]


@pytest.mark.parametrize("way", [1, 2, 3])
@pytest.mark.covers(
    "apci.InitMcuSystem", "apci.InitMcuSystem2", "apci.InitMcuSystem3", "apci.InitMcuSystem.ret.0"
)
def test_initialising_fills_the_records_and_loads_the_system_file_once(folder: Path, way: int) -> None:
    application, slot, board = booted(folder)
    tsrp = tsrp_array()
    assert application.status() == Status.TIMEOUT
    assert initialise(application, way, tsrp) == 0
    assert application.status() == Status.DONE
    assert [record.an for record in tsrp] == list(range(18))
    assert [record.jac for record in tsrp[:4]] == [77.0, 78.0, 79.0, 0.0]  # three axes
    assert [record.mcp for record in tsrp[:4]] == [0, -1, -2, 0]
    assert board.done == ["reset", "system"]
    board.jac = 5.0  # changed while running, and kept by the next program
    assert initialise(application, way, tsrp) == 0
    assert board.done == ["reset", "system"]
    assert tsrp[0].jac == 5.0
    assert slot.sysfile_loaded
    with pytest.raises(UsageError, match="17 TSRP records"):
        initialise(application, way, tsrp[:17])


@pytest.mark.parametrize("way", [1, 2, 3])
@pytest.mark.parametrize(
    "code", [pytest.param(n, marks=pytest.mark.covers(f"apci.InitMcuSystem.ret.{n}")) for n in range(31, 40)]
)
def test_every_reason_not_to_reach_the_board_has_its_code(folder: Path, way: int, code: int) -> None:
    application, slot, board = booted(folder)
    if code == 31:
        application.pc.slots.clear()
    elif code == 32:
        slot.stop()
    elif code == 34:
        application.pc.driver_installed = False
    else:
        slot.inject(InitCode(code))
    tsrp = tsrp_array()
    assert initialise(application, way, tsrp) == code
    assert application.status() == Status.TIMEOUT
    assert tsrp == tsrp_array()
    assert board.done == ["reset"]


@pytest.mark.parametrize("way", [1, 2, 3])
@pytest.mark.covers("apci.InitMcuSystem.ret.lderr")
def test_the_code_of_the_transfer_is_passed_on(folder: Path, way: int) -> None:
    application, slot, _board = booted(folder)
    (folder / "system.dat").unlink()
    assert initialise(application, way, tsrp_array()) == 20
    (folder / "system.dat").write_bytes(b"\0\xff")
    assert initialise(application, way, tsrp_array()) == 22
    (folder / "system.dat").write_text("speed = 3")
    assert initialise(application, way, tsrp_array()) == 24
    for fault in (TransferCode.MEMORY, TransferCode.REMOTE):
        slot.inject(fault)
        assert initialise(application, way, tsrp_array()) == fault
        slot.repair(fault)


def test_the_outermost_reason_comes_first(folder: Path) -> None:
    application, (slot,) = equipped(folder, Board())
    slot.inject(InitCode.VERSION_MISMATCH)
    slot.inject(InitCode.MAILBOX_ACCESS)
    slot.inject(InitCode.MAPPING)
    application.pc.driver_installed = False
    codes = [initialise(application, 2, tsrp_array())]
    application.pc.driver_installed = True
    codes.append(initialise(application, 2, tsrp_array()))
    slot.repair(InitCode.MAPPING)
    codes.append(initialise(application, 2, tsrp_array()))
    slot.repair(InitCode.MAILBOX_ACCESS)
    codes.append(initialise(application, 2, tsrp_array()))
    assert application.boot_file("rwmos.elf") == 0
    codes.append(initialise(application, 2, tsrp_array()))
    slot.repair(InitCode.VERSION_MISMATCH)
    codes.append(initialise(application, 2, tsrp_array()))
    assert codes == [34, 35, 39, 32, 33, 0]


@pytest.mark.parametrize(
    ("board_type", "name"),
    [
        pytest.param(number, name, marks=pytest.mark.covers(f"apci.BoardType.{row}"))
        for number, name, row in [
            (1, "PA 8000", "1"),
            (2, "PS 840", "2"),
            (4, "APCI-8001", "4"),
            (32, "APCI-8008", "32"),
            (0, "unknown", "0"),
            (64, "newer", "other"),
        ]
    ],
)
def test_initialising_tells_the_type_of_the_board(folder: Path, board_type: int, name: str) -> None:
    application, _ = equipped(folder, Board(board_type=board_type))
    assert application.init_mcu_system3(tsrp_array(), ROSI(), 0, "system.dat") == (32, 0)
    application.boot_file("rwmos.elf")
    assert application.init_mcu_system3(tsrp_array(), ROSI(), 0, "system.dat") == (0, board_type)
    assert name in board_name(board_type)


@pytest.mark.covers("apci.ROSI.revision", "apci.ROSI.number_axis", "apci.ROSI.sysfile_loaded", "apci.mcuinit")
def test_rosi_says_what_runs_on_the_board_or_nothing(folder: Path) -> None:
    application, slot, board = booted(folder)
    rosi = ROSI("old", 7, 7)
    slot.stop()
    application.mcuinit(rosi)
    assert rosi == ROSI("", 0, 0)
    application.boot_file("rwmos.elf")
    done = list(board.done)
    application.mcuinit(rosi)
    assert rosi == ROSI("V2.5.3.100", 3, 0)
    assert board.done == done  # no reset
    assert application.txbf2("system.dat") == 0  # the connection is there
    application.mcuinit(rosi)
    assert rosi.sysfile_loaded == 1
    application.boot_file("rwmos.elf")  # once per boot
    code, _ = application.init_mcu_system3(tsrp_array(), rosi, 0, "none.dat")
    assert (code, rosi) == (20, ROSI("V2.5.3.100", 3, 0))
    application.init_mcu_system3(tsrp_array(), rosi, 0, "system.dat")
    assert rosi == ROSI("V2.5.3.100", 3, 1)
    slot.inject(InitCode.BOARD_ACCESS)
    assert application.init_mcu_system3(tsrp_array(), rosi, 0, "system.dat") == (38, 0)
    assert rosi == ROSI("", 0, 0)


@pytest.mark.covers("apci.CardSelect", "apci.CardSelect.ret.minus1")
def test_a_board_is_selected_among_those_that_initialising_has_found(folder: Path) -> None:
    boards = [Board(1), Board(2), Board(3)]
    application, slots = equipped(folder, *boards[:2])
    assert application.card_select(1) == -1  # no list yet
    assert application.slot is slots[0]
    application.boot_file("rwmos.elf")
    assert initialise(application, 2, tsrp_array()) == 0
    assert application.card_select(1) == 1
    assert application.slot is slots[1]
    application.boot_file("rwmos.elf")
    assert [board.done for board in boards] == [["reset", "system"], ["reset"], []]
    rosi = ROSI()
    application.mcuinit(rosi)
    assert rosi.number_axis == 2
    application.pc.attach(boards[2])
    assert application.card_select(2) == -1  # not in the list yet
    assert application.slot is slots[0]
    assert initialise(application, 2, tsrp_array()) == 0
    assert application.card_select(2) == 2
    assert application.card_select(-1) == -1
    assert application.slot is slots[0]
    application.card_select(2)
    assert Application(application.pc).slot is slots[0]  # another program has its own selection


@pytest.mark.covers(
    "apci.pcap.general.timeout", "apci.ret.0", "apci.ret.minus1", "apci.ret.minus4", "apci.ret.other"
)
def test_a_board_that_stops_is_reached_again_only_after_booting_and_initialising(folder: Path) -> None:
    application, slot, _board = ready(folder)
    other = Application(application.pc, folder)
    assert (application.status(), other.status()) == (0, -4)
    assert application.status("V2.5.3.100") == 0
    assert application.status("V2.5.3.101") == application.status("V2.10") == -1
    slot.inject(InitCode.MAILBOX_ACCESS)
    assert application.status() == -4
    slot.repair(InitCode.MAILBOX_ACCESS)
    assert application.status() == 0
    slot.stop()
    assert application.status() == application.status("V9") == -4
    assert initialise(application, 3, tsrp_array()) == 32
    assert other.boot_file("rwmos.elf") == 0
    assert application.status() == -4
    assert initialise(application, 3, tsrp_array()) == 0
    assert application.status() == 0
    texts = [status_text(code) for code in (0, -1, -4)]
    assert [status_text(code) for code in (3, -2)] == ["unknown error 3", "unknown error -2"]
    assert len({*texts}) == 3


# --- files


@pytest.mark.covers("apci.txbf2.ret.0", "apci.txbf2.ret.20")
def test_a_file_is_searched_in_the_current_folder_and_then_along_the_path(folder: Path) -> None:
    first, second = folder / "first", folder / "second"
    for place, jac in ((first, 1.0), (second, 2.0)):
        place.mkdir()
        (place / "axes.dat").write_text(f"[[axis]]\njac = {jac}\n")
    (second / "deep").mkdir()
    (second / "deep" / "axes.dat").write_text("[[axis]]\njac = 3.0\n")
    _, slot, board = ready(folder)
    application = Application(Pc([slot]), folder, [first, second])
    initialise(application, 2, tsrp_array())
    for name, jac in (
        ("axes.dat", 1.0),
        ("system.dat", 77.0),
        ("deep/axes.dat", 3.0),
        (str(second / "axes.dat"), 2.0),
    ):
        assert application.txbf2(name) == 0
        assert board.jac == jac
    done = list(board.done)
    for name in ("", "none.dat", "none/system.dat", "first", "bad\0name", str(folder / "none.dat")):
        assert application.txbf2(name) == 20
    assert board.done == done


@pytest.mark.covers("apci.txbf2.ret.22", "apci.txbf2.ret.24")
def test_what_is_no_system_file_and_what_is_a_damaged_one(folder: Path) -> None:
    application, _slot, board = ready(folder)
    done = list(board.done)
    for content in (b"\x7fELF\xff\xfe", b"jac\0"):
        (folder / "other.dat").write_bytes(content)
        assert application.txbf2("other.dat") == 22
    assert application.problem is None
    (folder / "other.dat").write_text("[[axis]]\njack = 3.0\n")
    assert application.txbf2("other.dat") == 24
    assert "other.dat:2:1: unknown key 'jack'" in str(application.problem)
    (folder / "other.dat").write_text("[[axis\n")
    assert application.txbf2("other.dat") == 24
    assert board.done == done
    board.answer = 24  # the task that the program names does not exist
    (folder / "drill.cnc").write_bytes(b"\x01")
    assert application.txbf2("drill.cnc") == 24


@pytest.mark.covers("apci.txbf2.ret.23", "apci.txbf2.ret.25")
def test_a_transfer_fails(folder: Path) -> None:
    application, slot, board = ready(folder)
    done = list(board.done)
    for code in (23, 25):
        slot.inject(TransferCode(code))
        assert application.txbf2("system.dat") == code
        slot.repair(TransferCode(code))
    slot.stop()
    assert application.txbf2("system.dat") == 25
    assert board.done == done
    assert Application(Pc(), folder).txbf2("system.dat") == 25


def test_a_cnc_file_goes_to_the_board_as_it_is(folder: Path) -> None:
    application, _slot, board = ready(folder)
    (folder / "Drill.CNC").write_bytes(b"\0\xff")
    assert application.txbf2("Drill.CNC") == 0
    assert board.done[-1] == "program b'\\x00\\xff'"


@pytest.mark.covers("apci.txbf")
def test_the_old_transfer_takes_no_drive_or_folder(folder: Path) -> None:
    application, _slot, _board = ready(folder)
    assert application.txbf("system.dat") == 0
    for name in ("./system.dat", str(folder / "system.dat"), "C:system.dat", "a\\system.dat", "none.dat"):
        assert application.txbf(name) == 20


# --- what surrounds the motion


@pytest.mark.covers(
    "apci.getEnvStr",
    "apci.getEnvStr.ret.positive",
    "apci.getEnvStr.ret.0",
    "apci.getEnvStr.ret.minus1",
    "apci.getEnvStr.ret.minus4",
    "apci.CppString",
    "apci.rule.versions",
)
def test_an_environment_string_replaces_its_name(folder: Path) -> None:
    application, slot, _board = booted(folder)
    env = CppString("SerialNumber")
    assert application.get_env_str(env) == -4
    assert env.text == "SerialNumber"
    initialise(application, 2, tsrp_array())
    assert application.get_env_str(env) == 4
    assert env.text == "4711"
    assert env.pack()[:5] == b"4711\0"
    for name in ("Empty", "Unknown", "serialnumber", " SerialNumber", "SerialNumber ", "SerialNumbe", ""):
        env.text = name
        assert application.get_env_str(env) == 0
        assert env.text == ""
    slot.revision = "V2.5.3.36"
    env.text = "SerialNumber"
    assert application.get_env_str(env) == -1
    slot.revision = "V2.5.3.37"
    assert application.get_env_str(env) == 4


@pytest.mark.covers("apci.tool.fwsetup")
def test_environment_strings_are_written_only_before_booting(folder: Path) -> None:
    application, (slot,) = equipped(folder, Board())
    slot.write_environment("Colour", "green")
    application.boot_file("rwmos.elf")
    with pytest.raises(UsageError, match="the board is booted"):
        slot.write_environment("Colour", "red")
    assert slot.environment.read("Colour") == (5, "green")
    slot.stop()
    slot.write_environment("Colour", "x" * 1023)
    assert slot.environment.read("Colour")[0] == 1023
    with pytest.raises(UsageError, match="1024 characters"):
        EnvironmentStrings({"Colour": "x" * 1024})


@pytest.mark.parametrize(
    ("bit", "name"),
    [
        pytest.param(bit, name, marks=pytest.mark.covers(f"apci.ifs.{bit}.{name}"))
        for bit, name in [(16, "pfe"), (17, "wdog"), (18, "iae"), (19, "scwdog"), (20, "scpfe")]
    ],
)
def test_errors_that_the_hardware_collects_show_once_after_booting(bit: int, name: str) -> None:
    power_up = bit in (16, 20)
    flag = Ifs[name]
    assert flag == 1 << bit
    status = InterfaceStatus()
    assert status.word == 0
    status.start_firmware()
    assert bool(status.word & flag) is power_up  # switching on counts as a power failure
    status.start_firmware()
    assert not status.word & flag
    status.report_to_hardware(flag)
    for other in (Ifs.pfe, Ifs.wdog, Ifs.iae, Ifs.scwdog, Ifs.scpfe):  # one error does not hide another
        status.report_to_hardware(other)
    assert not status.word & flag
    status.start_firmware()
    assert status.word == 0x001F_0003
    status.reset_errors()
    assert not status.word & flag
    status.report(flag)
    assert status.word & flag
    status.start_firmware()
    assert not status.word & flag


@pytest.mark.covers(
    "apci.ifs.0.edv",
    "apci.ifs.21.BusError",
    "apci.ifs.22.EpmBaseResetFlag",
    "apci.ifs.23.EpmOpmfResetFlag",
    "apci.ifs.2-15",
    "apci.ifs.24-31",
)
def test_the_other_bits_of_the_interface_status() -> None:
    status = InterfaceStatus()
    status.start_firmware()
    assert status.word & 0b11 == 0b11  # valid data, relay closed
    for bit in (21, 22, 23):
        status.report(1 << bit)
        assert status.word >> bit & 1
    status.reset_errors()
    assert status.word == 0x00E0_0003
    status.report(0xFF00_FFFC)
    status.report_to_hardware(0xFF00_FFFC)
    assert status.word == 0x00E0_0003
    status.start_firmware()
    assert status.word == 0x3


@pytest.mark.covers(
    "apci.BootErrorReport", "apci.InitMcuErrorReport", "apci.txbfErrorReport", "apci.MsgToScreen"
)
def test_reports_hand_over_their_text_unless_messages_are_off() -> None:
    shown: list[str] = []
    messages = Messages(shown.append)
    messages.boot_error_report("rwmos.elf", BootCode.UNKNOWN_FORMAT)
    messages.init_mcu_error_report(32)
    messages.init_mcu_error_report(24)
    messages.txbf_error_report("system.dat", 24)
    messages.txbf_error_report("system.dat", 77)
    assert shown == [
        "BootFile rwmos.elf: the file is no ELF file (12)",
        "InitMcuSystem: the operating system is not loaded, or has stopped; boot the board (32)",
        "InitMcuSystem: there is no such task, or the system file is damaged (24)",
        "txbf2 system.dat: there is no such task, or the system file is damaged (24)",
        "txbf2 system.dat: unknown error 77 (77)",
    ]
    messages.msg_to_screen(0)
    messages.boot_error_report("rwmos.elf", 12)
    messages.init_mcu_error_report(32)
    messages.txbf_error_report("system.dat", 24)
    assert len(shown) == 5
    messages.msg_to_screen(1)
    messages.init_mcu_error_report(32)
    assert len(shown) == 6


@pytest.mark.covers(
    "apci.MCUG3_SetBoardIntRoutine", "apci.MCUG3_ResetBoardIntRoutine", "apci.InterruptRoutine"
)
def test_the_program_s_routine_is_called_while_it_is_installed() -> None:
    seen: list[int] = []
    routine: InterruptRoutine = seen.append
    line = InterruptLine()
    line.raise_interrupt(1)
    assert isinstance(line.set_routine(routine), int)
    line.raise_interrupt(5)
    assert seen == [5]
    other: list[int] = []
    line.set_routine(other.append)
    line.raise_interrupt(2)
    assert (seen, other) == ([5], [2])
    assert isinstance(line.reset_routine(), int)
    line.raise_interrupt(3)
    assert (seen, other) == ([5], [2])


@pytest.mark.covers("apci.scope.family")
def test_what_tells_the_boards_of_the_family_apart() -> None:
    boards = [parse_system_file(f'board_type = "APCI-{number}"') for number in (8001, 8008)]
    assert [board.type_number for board in boards] == [4, 32]
    assert [board.stepper_clock_hz for board in boards] == [70e6, 66.66666e6]
    assert [assigned_inputs(board.type_number) >> 20 for board in boards] == [0, 0b1111]
    assert [LED_PLACES[board.type_number] for board in boards] == [
        ("D29", "D30", "D31"),
        ("D53", "D55", "D56"),
    ]


def test_a_light_is_on_or_off() -> None:
    leds = Leds()
    assert (leds.green, leds.yellow, leds.red) == (0, 0, 0)
    leds.green, leds.red = 1, -7
    assert (leds.green, leds.yellow, leds.red) == (1, 0, 1)
    leds.green = 0
    assert leds.green == 0
    with pytest.raises(AttributeError):
        leds.blue = 1


def test_revisions_are_compared_by_their_numbers() -> None:
    assert revision_numbers("V2.5.3.100") > revision_numbers("V2.5.3.37") > revision_numbers("V2.5.3")
    assert all(isinstance(fault, Code) for fault in FAULTS)
