"""The bit tables against the manual's numbers and masks."""

import pytest

from polycnc.controllers.apci.board import _codes as codes
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.controllers.apci.core._registers import (
    INPUT_PINS,
    MODE_BITS_RULED,
    OUTPUT_PINS,
    STROBE_INPUT_OF_AXIS,
    Axst,
    Bits,
    BoardType,
    Digi,
    Digo,
    ErrorReg,
    Ifs,
    ModeReg,
    Running,
    TskInfo,
    assigned_inputs,
    bit_of,
    board_name,
    with_output,
)

AXST = (
    "1 eo 2 dnr 3 lslh 4 lsrh 5 lsls 6 lsrs 7 mpe 8 dhef 9 cef 12 pe 13 cl 14 ip 15 ui 16 lpsf "
    "17 referenced 18 refh 19 saf"
)
SIGNALS = "index encoder_error index_latched strobe_latched AEA AEB AEN AES"
ERROR_REG = (
    "0 errAxDef 1 errTargetVel 2 errUnit 3 errCenterPoint 4 errSpoolerOverrun 5 ProfileTooSmall 6 SplineSizeErr "
    "7 RotationFail 8 PciBusError 9 CheckMonitorScreen 10 SsfWaitRefused 11 SpoolerLoadError 12 VelocityZero "
    "13 AccelZero 14 LimitDefError 15 ZeroProfile 16 RadiusError 17 SpoolerDeepTooLess 18 IOResetHandled "
    "19 JSatSAFdone 20 reserved"
)
MODE_REG = "0 lookahead 6 bit6 7 maxcheck 10 rotaxisunit 15 MS_DECEL 25 bit25 26 WritelnStops 28 JSatSAF"
TSK_INFO = "0 incomplete 1 complete"
RUNNING = "0 running 1 single_step 2 stopped_by_writeln 3 waiting"
DIGI = " ".join(f"{n} input{n + 1}" for n in range(16)) + (
    " 16 index 17 encoder_error 18 index_latched 19 strobe_latched 20 AEA 21 AEB 22 AEN 23 AES"
)
DIGO = " ".join(f"{n} output{n + 1}" for n in range(8))
IFS = "0 edv 1 cncrdy 16 pfe 17 wdog 18 iae 19 scwdog 20 scpfe 21 BusError 22 EpmBaseResetFlag 23 EpmOpmfResetFlag"


def _rows(form: str, bits: str, *without: int) -> pytest.MarkDecorator:
    """Return the claim of the rows of a table's bits, which are called as `form` says."""
    words = bits.split()
    numbered = zip(map(int, words[::2]), words[1::2], strict=True)
    return pytest.mark.covers(*(form.format(bit, name) for bit, name in numbered if bit not in without))


@pytest.mark.parametrize(
    ("table", "bits"),
    [
        pytest.param(Axst, AXST, marks=_rows("apci.axst.{}.{}", AXST)),
        pytest.param(ErrorReg, ERROR_REG, marks=_rows("apci.ErrorReg.{}.{}", ERROR_REG, 6, 7, 20)),
        pytest.param(Running, RUNNING, marks=_rows("apci.CNCTS.running.bit{}", RUNNING, 1)),
        pytest.param(TskInfo, TSK_INFO, marks=_rows("apci.tskinfo.bit{}", TSK_INFO)),
        pytest.param(Digi, DIGI, marks=_rows("apci.digi.{}", DIGI)),
        pytest.param(Digo, DIGO, marks=_rows("apci.digo.{}", DIGO)),
        pytest.param(Ifs, IFS, marks=_rows("apci.ifs.{}.{}", IFS)),
    ],
)
def test_a_table_has_the_manual_s_bits_and_no_others(table: type[Bits], bits: str) -> None:
    words = bits.split()
    wanted = dict(zip(words[1::2], map(int, words[::2]), strict=True))
    assert {bit.name: bit.number for bit in table} == wanted
    assert {bit.name: int(bit) for bit in table} == {name: 1 << number for name, number in wanted.items()}
    assert all(bit.meaning for bit in table)
    assert table.assigned() == sum(1 << number for number in wanted.values())


@pytest.mark.covers(
    "apci.MODEREG.ForbidTargetVel",
    "apci.MODEREG.InhibitProfileRefuse",
    "apci.MODEREG.OvrMode",
    "apci.MODEREG.ClearZeroPosition",
    "apci.MODEREG.SProfile",
    "apci.MODEREG.0.lookahead",
    "apci.MODEREG.7.maxcheck",
    "apci.MODEREG.10.rotaxisunit",
    "apci.MODEREG.15.MS_DECEL",
    "apci.MODEREG.26",
    "apci.MODEREG.28.JSatSAF",
)
def test_modes_have_the_stated_numbers_and_the_ruled_ones_are_free() -> None:
    words = MODE_REG.split()
    stated = dict(zip(words[1::2], map(int, words[::2]), strict=True))
    assert {bit.name: bit.number for bit in ModeReg if bit not in MODE_BITS_RULED} == stated
    assert {bit.name for bit in MODE_BITS_RULED} == {
        "SProfile",
        "OvrMode",
        "ForbidTargetVel",
        "InhibitProfileRefuse",
        "ClearZeroPosition",
    }
    assert len({bit.number for bit in ModeReg}) == len(stated) + 5


def test_bits_are_counted_from_1() -> None:
    assert bit_of(Axst.pe, 13) == 1  # the manual's examples
    assert bit_of(Axst.pe, 12) == bit_of(Axst.pe, 14) == 0
    assert bit_of(Ifs.edv, 1) == 1
    assert bit_of(-1, 32) == 1
    assert [bit_of(-1, number) for number in (0, -1, 33)] == [0, 0, 0]


@pytest.mark.parametrize(
    ("number", "signal", "pin"),
    [
        pytest.param(n, f"input{n}", pin, marks=pytest.mark.covers(f"apci.rddigib.bitnr.{n}"))
        for n, pin in zip(
            range(1, 17), [9, 10, 11, 12, 13, 14, 15, 16, 42, 43, 44, 45, 46, 47, 48, 49], strict=True
        )
    ]
    + [
        pytest.param(n, signal, None, marks=pytest.mark.covers(f"apci.rddigib.bitnr.{n}"))
        for n, signal in zip(
            range(17, 25),
            SIGNALS.split(),
            strict=True,
        )
    ],
)
def test_a_number_of_rddigib_asks_for_its_signal(number: int, signal: str, pin: int | None) -> None:
    assert bit_of(Digi[signal], number) == 1
    assert bit_of(~Digi[signal], number) == 0
    assert pin is None or INPUT_PINS[number - 1] == pin


@pytest.mark.covers(
    "apci.rddigib.bitnr.25-32", "apci.digi.20", "apci.digi.21", "apci.digi.22", "apci.digi.23"
)
def test_the_encoder_s_alarms_are_there_on_an_apci_8008_only() -> None:
    assert assigned_inputs(BoardType.APCI_8008) == 0x00FF_FFFF
    assert assigned_inputs(BoardType.APCI_8001) == 0x000F_FFFF
    for number in range(25, 33):
        assert bit_of(assigned_inputs(BoardType.APCI_8008), number) == 0
    for number in range(21, 25):
        assert bit_of(assigned_inputs(BoardType.APCI_8001), number) == 0


@pytest.mark.parametrize(
    "number",
    [pytest.param(n, marks=pytest.mark.covers(f"apci.digi.{n - 1}")) for n in range(1, 14)] + [14, 15, 16],
)
def test_an_input_is_1_while_it_is_active(number: int) -> None:
    bit = Digi[f"input{number}"]
    plain, inverted = parse_system_file(""), parse_system_file(f"[inputs.{number}]\ninverted = true\n")
    assert plain.active_inputs(1 << number - 1) == bit
    assert plain.active_inputs(0) == 0
    assert inverted.active_inputs(1 << number - 1) == 0
    assert inverted.active_inputs(0) == bit


def test_three_inputs_latch_the_first_three_axes() -> None:
    assert STROBE_INPUT_OF_AXIS == (14, 15, 16)


@pytest.mark.covers("apci.rdigi")
def test_rdigi_clears_the_four_signals_of_the_encoder() -> None:
    assert Digi.cleared(0x00FF_FFFF, "rdigi") == 0x00F0_FFFF


@pytest.mark.parametrize(
    ("number", "pin"),
    [pytest.param(n, 25 + n, marks=pytest.mark.covers(f"apci.wrdigob.bitnr.{n}")) for n in range(1, 9)],
)
def test_a_number_of_wrdigob_sets_and_resets_its_output(number: int, pin: int) -> None:
    bit = Digo[f"output{number}"]
    assert with_output(0, number, 1) == with_output(0, number, -5) == bit
    assert with_output(0xFF, number, 0) == 0xFF & ~bit
    assert OUTPUT_PINS[number - 1] == pin


@pytest.mark.covers("apci.wrdigob.bitnr.9-32", "apci.digo.8-31")
def test_numbers_without_an_output_change_nothing() -> None:
    for number in (*range(9, 33), 0, -1, 33):
        assert with_output(0x5A, number, 1) == with_output(0x5A, number, 0) == 0x5A
    assert Digo.assigned() == 0xFF


def test_what_clears_a_bit() -> None:
    everything = Axst.assigned()
    assert everything & ~Axst.cleared(everything, "reading lp") == Axst.lpsf
    assert everything & ~Axst.cleared(everything, "BootFile") == Axst.dhef | Axst.referenced
    assert everything & ~Axst.cleared(everything, "rs") == Axst.dhef | Axst.referenced | Axst.lsls | Axst.lsrs
    assert (
        everything & ~Axst.cleared(everything, "ra")
        == Axst.dhef | Axst.referenced | Axst.lsls | Axst.lsrs | Axst.saf
    )
    assert everything & ~Axst.cleared(everything, "direct move") == Axst.saf
    assert TskInfo.cleared(3, "gettskstr") == 0


def test_the_board_s_name_follows_from_its_type() -> None:
    assert [board_name(number) for number in (1, 2, 4, 32)] == ["PA 8000", "PS 840", "APCI-8001", "APCI-8008"]
    assert "unknown" in board_name(0)
    assert board_name(64) == "newer product 64"


@pytest.mark.parametrize(
    ("text", "known"),
    [
        (codes.boot_text, [0, *range(10, 17), 200, 201, 202]),
        (codes.init_text, [0, *range(31, 40), *range(20, 26)]),
        (codes.transfer_text, [0, *range(20, 26)]),
        (codes.status_text, [0, -1, -4]),
    ],
)
def test_every_code_has_its_own_text(text: object, known: list[int]) -> None:
    assert callable(text)
    texts = [text(code) for code in known]
    assert len(set(texts)) == len(known)
    assert not any("unknown error" in each for each in texts)
    assert text(99) == "unknown error 99"
