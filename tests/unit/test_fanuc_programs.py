"""Programs: transfer, search, deletion, comparison (Manual 000, 1323-2710)."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from polycnc.cnc import ControlError
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from support.fanuc_programs import covers, sent, unchanged, uploaded
from support.power_mate import OK, attached, registered, running

FORMAT = "\nO1234\nG1F0.3W10.\nM30\n%"
UPLOADED = "%\nO1234\nG1F0.3W10.\nM30\n%"
PIECES = ("\n", "O1234\n", "M3 S1200\n", "G0 Z0\n", "G0 X0 Y0\n", "G1 F500 X120. Y-30.\n", "M30\n", "%")
STORED = b"O1234\nM3S1200\nG0Z0\nG0X0Y0\nG1F500X120.Y-30.\nM30\n"


# ---------------------------------------------------------------------- download


@covers("example.cnc_download", "cnc_dwnstart", "cnc_download", "cnc_dwnend", "LF", "PERCENT")
@pytest.mark.covers("fanuc.format.download", "fanuc.concept.download_session")
def test_example_download_in_eight_pieces() -> None:
    control, handle = attached()
    assert sum(map(len, PIECES)) == 56
    assert sent(handle, *PIECES) == (OK, OK)
    assert control.programs.read(1234) == STORED
    assert [each.number for each in control.programs.directory()] == [1234]


@pytest.mark.covers(
    "fanuc.cnc_download", "fanuc.cnc_dwnend", "fanuc.cnc_dwnstart", "fanuc.example.cnc_download",
)  # fmt: skip
@covers("example.cnc_download_format", "format.download")
@pytest.mark.parametrize("cut", [(23,), (1, 6, 11, 4, 1), (1,) * 23, (9, 9, 5), (2, 21)])
@pytest.mark.covers("fanuc.LF")
def test_example_download_cut_anywhere(cut: tuple[int, ...]) -> None:
    control, handle = attached()
    assert (len(FORMAT), sum(cut)) == (23, 23)
    pieces, at = [], 0
    for size in cut:
        pieces.append(FORMAT[at : at + size])
        at += size
    assert sent(handle, *pieces) == (OK, OK)
    assert control.programs.read(1234) == b"O1234\nG1F0.3W10.\nM30\n"


@covers("PERCENT", "LF", "cnc_download", "cnc_dwnend", "format.download")
def test_what_stands_before_the_first_line_feed_and_behind_the_percent_is_ignored() -> None:
    control, handle = attached()
    assert sent(handle, "%jun", "k~\r(\nO7(PLATE", " 2)\nM30\n%", "\nO8\n~~~") == (OK, OK)
    assert control.programs.read(7) == b"O0007(PLATE 2)\nM30\n"
    assert len(control.programs) == 1


@pytest.mark.covers("fanuc.format.download", "fanuc.concept.duplicate_program")
def test_several_programs_come_together_or_not_at_all() -> None:
    control, handle = attached()
    assert sent(handle, "\nO7\nM99\nO12(B)\nG4P1\nM99\n%") == (OK, OK)
    assert [(each.number, each.comment) for each in control.programs.directory()] == [(7, ""), (12, "B")]
    unchanged(control, lambda: sent(handle, "\nO8\nM99\nO12\nM99\n%")[1], EW.EW_DATA)
    unchanged(control, lambda: sent(handle, "\nO8\nM99\nO8\nM99\n%")[1], EW.EW_DATA)


@pytest.mark.covers("fanuc.cnc_dwnstart")
@pytest.mark.covers("fanuc.format.download", "fanuc.PERCENT", "fanuc.concept.download_session")
def test_a_stream_that_is_cut_leaves_no_half_program() -> None:
    control, handle = attached()
    unchanged(control, lambda: sent(handle, "\nO8\nG1X1.\nM30\n")[1], EW.EW_DATA)
    unchanged(control, lambda: sent(handle)[1], EW.EW_DATA)
    unchanged(control, lambda: sent(handle, "\n%")[1], EW.EW_DATA)
    assert fwlib.cnc_dwnstart(handle) == OK


@pytest.mark.covers("fanuc.cnc_dwnstart")
@pytest.mark.covers("fanuc.cnc_search")
@covers("concept.download_session", "cnc_download.err.EW_FUNC", "cnc_dwnend.err.EW_FUNC")
@pytest.mark.covers(
    "fanuc.cnc_download",
    "fanuc.cnc_download.err.EW_DATA",
    "fanuc.cnc_dwnend",
    "fanuc.cnc_dwnend.err.EW_DATA",
    "fanuc.cnc_dwnstart.err.EW_BUSY",
    "fanuc.cnc_search.err.EW_BUSY",
)
@pytest.mark.covers("fanuc.concept.program_busy_conditions", "fanuc.concept.mode_matrix")
@pytest.mark.covers("fanuc.mode.MDI")
@pytest.mark.covers("fanuc.cnc_allclibhndl")
def test_download_session() -> None:
    control, handle = attached()
    assert fwlib.cnc_download(handle, "\n", 1) == EW.EW_FUNC
    assert fwlib.cnc_dwnend(handle) == EW.EW_FUNC
    assert fwlib.cnc_dwnstart(handle) == OK
    assert fwlib.cnc_dwnstart(handle) == EW.EW_BUSY
    _, other = fwlib.cnc_allclibhndl()
    assert fwlib.cnc_dwnstart(other) == EW.EW_BUSY  # one per control
    assert fwlib.cnc_download(handle, "\nO1\n~", 5) == OK
    assert fwlib.cnc_download(handle, "\n", 1) == EW.EW_DATA
    assert fwlib.cnc_download(handle, "M30\n%", 5) == EW.EW_DATA  # open, and still wrong
    assert fwlib.cnc_search(handle, 1) == EW.EW_BUSY
    assert fwlib.cnc_dwnend(handle) == EW.EW_DATA
    assert fwlib.cnc_dwnend(handle) == EW.EW_FUNC
    assert control.transfer is None
    assert sent(handle, FORMAT) == (OK, OK)


@pytest.mark.covers("fanuc.cnc_dwnend")
@covers("cnc_download.err.EW_LENGTH", "range.download_number")
@pytest.mark.covers("fanuc.cnc_download", "fanuc.cnc_dwnstart")
@pytest.mark.covers("fanuc.concept.download_session")
def test_a_piece_has_1_to_256_characters() -> None:
    control, handle = attached()
    long = "\nO7\n" + "X1234567\n" * 28
    assert len(long) == 256
    assert fwlib.cnc_dwnstart(handle) == OK
    assert fwlib.cnc_download(handle, long + " ", 257) == EW.EW_LENGTH
    assert fwlib.cnc_download(handle, "", 0) == EW.EW_LENGTH
    assert fwlib.cnc_download(handle, "X", -1) == EW.EW_LENGTH
    assert fwlib.cnc_download(handle, "X", 2) == EW.EW_LENGTH
    assert fwlib.cnc_download(handle, long + "behind the number", 256) == OK
    assert fwlib.cnc_download(handle, "%", 1) == OK
    assert fwlib.cnc_dwnend(handle) == OK
    assert control.programs.read(7).count(b"X1234567\n") == 28


@pytest.mark.covers("fanuc.EW_DATA", "fanuc.cnc_dwnstart")
@covers("cnc_download.err.EW_DATA", "cnc_dwnend.err.EW_DATA", "concept.duplicate_program")
@pytest.mark.parametrize(
    "stream",
    [
        "\nO7\nM30\n%",  # registered
        "\nO55\nM30\n%",  # selected
        "\nO1\nG1X1~\nM30\n%",
        "\nO1\ng1x1\nM30\n%",
        "\nO1\r\nM30\n%",
        "\nO1\nM30(A\n%",
        "\nO1\nM30)\n%",
        "\nM30\n%",
        "\nO0\nM30\n%",
        "\nO10000\nM30\n%",
        "\nO\nM30\n%",
    ],
)
@pytest.mark.covers("fanuc.cnc_download", "fanuc.cnc_dwnend")
@pytest.mark.covers(
    "fanuc.format.download",
    "fanuc.concept.download_session",
    "fanuc.concept.tv_check",
    "fanuc.concept.selected_program",
    "fanuc.concept.program_number_range",
)
def test_streams_that_are_refused(stream: str) -> None:
    control, handle = attached()
    registered(control, O7="\nM30\n", O55="\nM30\n")
    control.select_program(55)
    unchanged(control, lambda: sent(handle, *stream)[0], EW.EW_DATA)
    unchanged(control, lambda: sent(handle, *stream)[1], EW.EW_DATA)  # the end tells it again
    assert sent(handle, FORMAT) == (OK, OK)


@pytest.mark.covers("fanuc.cnc_download", "fanuc.cnc_dwnstart")
@pytest.mark.covers(
    "fanuc.format.download", "fanuc.concept.download_session", "fanuc.concept.duplicate_program"
)
@pytest.mark.covers("fanuc.cnc_dwnend", "fanuc.cnc_dwnend.err.EW_DATA")
def test_the_last_pieces_are_judged_at_the_end() -> None:
    control, handle = attached()
    assert fwlib.cnc_dwnstart(handle) == OK
    assert fwlib.cnc_download(handle, "\nO7\nM30\n%", 9) == OK
    registered(control, O7="(OPERATOR)\nM30\n")
    unchanged(control, lambda: fwlib.cnc_dwnend(handle), EW.EW_DATA)


@covers("concept.tv_check", "ncparam.0000_0")
@pytest.mark.covers("fanuc.cnc_wrmdiprog", "fanuc.cnc_wrmdiprog.err.EW_DATA")
def test_tv_check_counts_the_characters_of_a_block() -> None:
    control, handle = attached()
    assert sent(handle, FORMAT) == (OK, OK)
    control.parameters.set(0, 1)
    odd = "\nO1235\nG1F0.3W10.\nM30\n%"
    unchanged(control, lambda: sent(handle, odd)[0], EW.EW_DATA)
    assert sent(handle, "\nO1235\nG1F0.3W10. \nM30\n%") == (OK, OK)
    control.select_mode("MDI")
    assert fwlib.cnc_wrmdiprog(handle, len(odd), odd) == EW.EW_DATA
    control.parameters.set(0, 0)
    assert fwlib.cnc_wrmdiprog(handle, len(odd), odd) == OK


@covers("ncparam.3201_2", "ncparam.3201_6")
@pytest.mark.covers("fanuc.format.download", "fanuc.concept.duplicate_program")
def test_parameters_of_registration() -> None:
    control, handle = attached()
    registered(control, O7="\nM30\n", O55="\nM30\n")
    control.select_program(55)
    stream = "\nO7\nG4P5\nM30\nG4P6\nM99\n%"
    unchanged(control, lambda: sent(handle, stream)[1], EW.EW_DATA)
    control.parameters.set(3201, 1 << 6 | 1 << 2)
    assert sent(handle, stream) == (OK, OK)
    assert control.programs.read(7) == b"O0007\nG4P5\nM30\nG4P6\nM99\n"
    unchanged(control, lambda: sent(handle, "\nO55\nM30\n%")[1], EW.EW_DATA)  # never the selected one
    control.parameters.set(3201, 1 << 2)
    unchanged(
        control, lambda: sent(handle, stream)[0], EW.EW_DATA
    )  # M30 ends a program, and no O word follows
    assert sent(handle, "\nO7\nM2\nO8(M30)\nG4P30\nM099\n%") == (OK, OK)
    assert (control.programs.read(7), len(control.programs)) == (b"O0007\nM2\n", 3)


@pytest.mark.covers("fanuc.EW_OVRFLOW")
@pytest.mark.covers("fanuc.cnc_delete")
@covers("cnc_download.err.EW_OVRFLOW", "cnc_dwnend.err.EW_OVRFLOW", "concept.memory_accounting")
@pytest.mark.covers("fanuc.cnc_download", "fanuc.cnc_dwnend")
def test_a_full_memory() -> None:
    control, handle = attached(characters=60, most_programs=2)
    assert sent(handle, FORMAT) == (OK, OK)
    assert control.programs.memory.free_bytes == 60 - 21
    unchanged(control, lambda: sent(handle, "\nO7\n", "X1.\n" * 9, "M30\n%")[0], EW.EW_OVRFLOW)
    unchanged(control, lambda: sent(handle, "\nO7\n", "X1.\n" * 9, "M30\n%")[1], EW.EW_OVRFLOW)
    unchanged(control, lambda: sent(handle, "\nO7\n" + "X" * 40)[0], EW.EW_OVRFLOW)
    assert sent(handle, "\nO7\n", "X1.\n" * 8, "%") == (OK, OK)
    assert control.programs.memory.free_bytes == 1
    assert fwlib.cnc_delete(handle, 7) == OK
    assert sent(handle, "\nO8\n%") == (OK, OK)
    unchanged(control, lambda: sent(handle, "\nO9\n%")[1], EW.EW_OVRFLOW)  # two programs are all


@pytest.mark.covers("fanuc.EW_RESET")
@covers("cnc_download.err.EW_RESET")
@pytest.mark.parametrize("button", ["reset", "feed_hold"])
@pytest.mark.covers("fanuc.cnc_download", "fanuc.cnc_dwnend", "fanuc.cnc_dwnstart")
@pytest.mark.covers("fanuc.concept.download_session")
def test_reset_and_stop_end_a_download(button: str) -> None:
    control, handle = attached()
    assert fwlib.cnc_dwnstart(handle) == OK
    assert fwlib.cnc_download(handle, "\nO7\nM30\n%", 9) == OK
    getattr(control, button)()
    assert fwlib.cnc_download(handle, "M30\n", 4) == EW.EW_RESET
    assert fwlib.cnc_download(handle, "M30\n", 4) == EW.EW_RESET
    assert fwlib.cnc_dwnend(handle) == OK
    assert len(control.programs) == 0
    assert sent(handle, FORMAT) == (OK, OK)


@covers("concept.blocking_download")
def test_a_download_never_answers_that_a_buffer_is_full() -> None:
    control, handle = attached(characters=200_000)
    pieces = ["\nO7\n", *["G1X12.345Y-6.7\n" * 17] * 500, "M30\n%"]
    assert sent(handle, *pieces) == (OK, OK)
    assert len(control.programs.read(7)) == 6 + 15 * 17 * 500 + 4


# ---------------------------------------------------------------------- upload


@covers("example.cnc_upload_format", "cnc_upstart", "cnc_upload", "cnc_upend", "format.upload")
@covers("concept.no_nul_termination")
@pytest.mark.covers("fanuc.ODBUP.data")
@pytest.mark.covers("fanuc.struct.ODBUP")
@pytest.mark.covers("fanuc.PERCENT", "fanuc.LF", "fanuc.concept.upload_session")
def test_example_upload_in_pieces() -> None:
    _, handle = attached()
    assert sent(handle, FORMAT) == (OK, OK)
    for size, expected in ((1000, (24, 0, 0)), (10, (10, 10, 4, 0))):
        assert fwlib.cnc_upstart(handle, 1234) == OK
        found = [fwlib.cnc_upload(handle, size) for _ in expected]
        assert [code for code, _, _ in found] == [OK] * len(expected)
        assert tuple(count for _, _, count in found) == expected
        assert "".join(bytes(piece.data).decode() for _, piece, _ in found) == UPLOADED
        assert fwlib.cnc_upend(handle) == OK
    assert [bytes(piece.data) for _, piece, _ in found[:3]] == [b"%\nO1234\nG1", b"F0.3W10.\nM", b"30\n%"]
    assert found[0][1].pack()[:4] == b"\0\0\0\0"
    assert len(found[0][1].pack()) == 14  # the piece fills its buffer


@pytest.mark.covers("fanuc.cnc_upend", "fanuc.cnc_upstart")
@covers("example.cnc_upload")
@pytest.mark.covers("fanuc.cnc_upload")
@pytest.mark.covers(
    "fanuc.concept.no_nul_termination", "fanuc.PERCENT", "fanuc.format.upload", "fanuc.concept.upload_session"
)
def test_example_upload_loop_until_the_percent() -> None:
    _, handle = attached()
    assert sent(handle, *PIECES) == (OK, OK)
    assert fwlib.cnc_upstart(handle, 1234) == OK
    text = ""
    while True:
        code, piece, number = fwlib.cnc_upload(handle, 39)
        assert code == OK
        text += bytes(piece.data)[:number].decode()
        if text[-1] == "%":
            break
    assert fwlib.cnc_upend(handle) == OK
    assert text == "%\n" + STORED.decode() + "%"
    assert uploaded(handle, 1234, 1) == text


@pytest.mark.covers("fanuc.cnc_upend", "fanuc.cnc_upload")
@covers(
    "concept.upload_session", "cnc_upstart.err.EW_BUSY", "cnc_upstart.err.EW_DATA", "cnc_upload.err.EW_FUNC",
    "cnc_upload.err.EW_LENGTH", "cnc_upend.err.EW_FUNC",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_upstart")
@pytest.mark.covers("fanuc.format.upload", "fanuc.concept.program_busy_conditions")
@pytest.mark.covers("fanuc.cnc_allclibhndl")
def test_upload_session() -> None:
    control, handle = attached()
    assert sent(handle, FORMAT) == (OK, OK)
    assert fwlib.cnc_upload(handle, 5)[0] == EW.EW_FUNC
    assert fwlib.cnc_upend(handle) == EW.EW_FUNC
    registered(control, O12="\nM30\n")
    for selected in (12, 1234):  # no number stands for the selected program
        control.select_program(selected)
        for number in (1235, 0, -1, -1234, 10000):
            assert fwlib.cnc_upstart(handle, number) == EW.EW_DATA
    assert fwlib.cnc_upstart(handle, 1234) == OK
    assert fwlib.cnc_upstart(handle, 1234) == EW.EW_BUSY
    code, _, number = fwlib.cnc_upload(handle, 0)
    assert (code, number) == (EW.EW_LENGTH, 0)
    assert fwlib.cnc_upload(handle, 24)[2] == 24
    assert fwlib.cnc_upload(handle, 24)[::2] == (OK, 0)
    _, other = fwlib.cnc_allclibhndl()
    assert uploaded(other, 1234) == UPLOADED  # one per handle
    assert fwlib.cnc_upend(handle) == OK
    assert fwlib.cnc_upend(handle) == EW.EW_FUNC
    control.raise_alarm(101)
    assert fwlib.cnc_upstart(handle, 1234) == EW.EW_BUSY


# ---------------------------------------------------------------------- search and deletion


def _memory(*, selected: int = 201, **keys: object) -> tuple[PowerMate, int]:
    control, handle = attached(**keys)
    registered(
        control, O12="(TEST)\nM30\n", O200="(WORK1)\nM30\n", O201="\nG1X50.F600\nM30\n", O9001="\nM99\n"
    )
    control.select_program(selected)
    return control, handle


@pytest.mark.covers("fanuc.cnc_upload", "fanuc.cnc_upstart")
@pytest.mark.covers(
    "fanuc.cnc_download",
    "fanuc.cnc_download.err.EW_FUNC",
    "fanuc.cnc_dwnstart",
    "fanuc.cnc_statinfo",
    "fanuc.cnc_upload.err.EW_FUNC",
)
@pytest.mark.covers("fanuc.concept.download_session", "fanuc.concept.upload_session")
def test_transfers_end_with_the_power() -> None:
    control, handle = attached()
    registered(control, O7="\nG4X7.\nM30\n")
    assert fwlib.cnc_upstart(handle, 7) == OK
    assert fwlib.cnc_upload(handle, 5)[2] == 5
    assert fwlib.cnc_dwnstart(handle) == OK
    control.power_cycle()
    assert fwlib.cnc_statinfo(handle)[1].edit == 0
    assert fwlib.cnc_upload(handle, 5)[0] == EW.EW_FUNC
    assert fwlib.cnc_download(handle, "\nO8", 3) == EW.EW_FUNC
    assert uploaded(handle, 7) == "%\nO0007\nG4X7.\nM30\n%"


@pytest.mark.covers(
    "fanuc.EW_DATA", "fanuc.ODBPRO.data", "fanuc.concept.program_number_range", "fanuc.concept.subprogram_numbers",
)  # fmt: skip
@covers(
    "cnc_search", "enum.search.foreground", "enum.search.background", "mode.MEM", "mode.EDIT", "mode.OTHER",
    "concept.selected_program", "example.cnc_search", "cnc_search.err.EW_DATA",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdprgnum")
@pytest.mark.covers("fanuc.concept.mode_matrix")
def test_search_selects_in_mem_and_edit_only() -> None:
    control, handle = _memory()
    for mode in ("MEM", "EDIT"):
        control.select_mode(mode)
        for number in (12, 200):
            assert fwlib.cnc_search(handle, number) == OK
            assert fwlib.cnc_rdprgnum(handle)[1].data == control.programs.selected == number
    for mode in ("MDI", "HND", "JOG", "T-JOG", "T-HND", "INC", "REF", "RMT"):
        control.select_mode(mode)
        assert fwlib.cnc_search(handle, 12) == OK
        assert control.programs.selected == 200
    for mode in ("MEM", "JOG"):
        control.select_mode(mode)
        for number in (13, 0, -1, 10000):
            unchanged(control, lambda number=number: fwlib.cnc_search(handle, number), EW.EW_DATA)  # type: ignore[misc]


@pytest.mark.covers("fanuc.EW_DATA", "fanuc.concept.program_number_range")
@covers("cnc_delete", "example.cnc_delete", "cnc_delete.err.EW_DATA")
@pytest.mark.covers(
    "fanuc.concept.program_busy_conditions", "fanuc.concept.mode_matrix", "fanuc.concept.selected_program"
)
@pytest.mark.covers("fanuc.mode.OTHER")
def test_delete_takes_one_program_in_any_mode_but_mdi() -> None:
    control, handle = _memory()
    assert fwlib.cnc_delete(handle, 12) == OK  # in MEM
    unchanged(control, lambda: fwlib.cnc_delete(handle, 12), EW.EW_DATA)
    unchanged(control, lambda: fwlib.cnc_delete(handle, 0), EW.EW_DATA)
    control.select_mode("JOG")
    assert fwlib.cnc_delete(handle, 9001) == OK
    assert [each.number for each in control.programs.directory()] == [200, 201]


@pytest.mark.covers("fanuc.ODBPRO.data", "fanuc.concept.subprogram_numbers")
@pytest.mark.covers("fanuc.cnc_rdprgnum")
@covers("cnc_delall", "example.cnc_delall")
@pytest.mark.covers(
    "fanuc.concept.write_protection_programs",
    "fanuc.concept.program_busy_conditions",
    "fanuc.concept.mode_matrix",
    "fanuc.concept.selected_program",
    "fanuc.ncparam.3202_0",
)
@pytest.mark.covers("fanuc.mode.EDIT")
def test_delall_takes_every_program_and_the_selection() -> None:
    control, handle = _memory()
    control.select_mode("EDIT")
    assert fwlib.cnc_delall(handle) == OK
    assert (len(control.programs), fwlib.cnc_rdprgnum(handle)[1].data) == (0, 0)
    assert fwlib.cnc_delall(handle) == OK
    control.select_mode("MEM")
    with pytest.raises(ControlError):
        control.cycle_start()


CALLS: dict[str, Callable[[int], EW]] = {
    "dwnstart": lambda handle: fwlib.cnc_dwnstart(handle),
    "upstart": lambda handle: fwlib.cnc_upstart(handle, 12),
    "search": lambda handle: fwlib.cnc_search(handle, 12),
    "delete": lambda handle: fwlib.cnc_delete(handle, 12),
    "delall": lambda handle: fwlib.cnc_delall(handle),
}


def _background(control: PowerMate, handle: int) -> None:
    control.programs.edit(9001, background=True)


def _foreground(control: PowerMate, handle: int) -> None:
    control.programs.edit(9001)


def _download(control: PowerMate, handle: int) -> None:
    assert fwlib.cnc_dwnstart(handle) == OK


def _compare(control: PowerMate, handle: int) -> None:
    control.start_compare()


def _alarm_000(control: PowerMate, handle: int) -> None:
    control.raise_alarm(0)


def _alarm_101(control: PowerMate, handle: int) -> None:
    control.raise_alarm(101)


def _alarm_100(control: PowerMate, handle: int) -> None:
    control.raise_alarm(100)


def _uploading(control: PowerMate, handle: int) -> None:
    assert fwlib.cnc_upstart(handle, 200) == OK


def _waits(control: PowerMate, word: str) -> None:
    registered(control, O300=f"\n{word}\nM30\n")
    control.optional_stop()
    running(control, 300)
    control.advance(500)
    assert control.control.channel_status().interrupted
    control.select_mode("EDIT")


def _program_stop(control: PowerMate, handle: int) -> None:
    _waits(control, "M0")


def _optional_stop(control: PowerMate, handle: int) -> None:
    _waits(control, "M1")


def _mdi(control: PowerMate, handle: int) -> None:
    control.select_mode("MDI")


def _mem(control: PowerMate, handle: int) -> None:
    control.select_mode("MEM")


def _running(control: PowerMate, handle: int) -> None:
    running(control, 201)
    control.advance(100)
    control.feed_hold()
    control.advance(500)
    control.select_mode("EDIT")


def _key(control: PowerMate, handle: int) -> None:
    control.protect_key(True)


# What each call answers in a state of the control; a state is entered from EDIT. Every other answer is success.
BUSY, PROT = EW.EW_BUSY, EW.EW_PROT
MATRIX: list[tuple[Callable[[PowerMate, int], None], dict[str, EW]]] = [
    (_background, {"dwnstart": BUSY, "delete": BUSY, "delall": BUSY}),
    (_foreground, {"delall": BUSY}),
    (_download, {"dwnstart": BUSY, "search": BUSY, "delete": BUSY, "delall": BUSY}),
    (_compare, {"dwnstart": BUSY, "delete": BUSY, "delall": BUSY}),
    (_alarm_000, dict.fromkeys(CALLS, BUSY)),
    (_alarm_101, dict.fromkeys(CALLS, BUSY)),
    (_alarm_100, {}),
    (_uploading, {"upstart": BUSY}),
    (_mdi, {"dwnstart": BUSY, "delete": BUSY, "delall": BUSY}),
    (_mem, {"delall": BUSY}),
    (_running, {"search": BUSY, "delete": BUSY, "delall": BUSY}),
    (_program_stop, {"search": BUSY, "delete": BUSY, "delall": BUSY}),
    (_optional_stop, {"search": BUSY, "delete": BUSY, "delall": BUSY}),
    (_key, {"dwnstart": PROT, "delete": PROT, "delall": PROT}),
]


@pytest.mark.covers("fanuc.EW_PROT", "fanuc.cnc_upstart", "fanuc.cnc_upstart.err.EW_BUSY")
@pytest.mark.covers("fanuc.cnc_delall.err.EW_PROT", "fanuc.cnc_delete.err.EW_PROT")
@covers(
    "cnc_dwnstart.err.EW_BUSY", "cnc_dwnstart.err.EW_PROT", "cnc_search.err.EW_BUSY", "cnc_delall.err.EW_BUSY",
    "cnc_delete.err.EW_BUSY", "concept.program_busy_conditions", "concept.alarm_ps000_ps101", "concept.op_signal",
    "concept.protect_key", "concept.background_edit", "concept.compare_running", "EW_BUSY", "mode.MEM",
)  # fmt: skip
@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize(("state", "answers"), [pytest.param(*each, id=each[0].__name__) for each in MATRIX])
@pytest.mark.covers("fanuc.cnc_delall", "fanuc.cnc_delete", "fanuc.cnc_dwnstart", "fanuc.cnc_search")
@pytest.mark.covers(
    "fanuc.concept.download_session",
    "fanuc.concept.upload_session",
    "fanuc.concept.write_protection_programs",
    "fanuc.concept.mode_matrix",
    "fanuc.concept.selected_program",
)
@pytest.mark.covers("fanuc.mode.EDIT", "fanuc.mode.MDI", "fanuc.enum.search.foreground")
def test_refusal_matrix(state: Callable[[PowerMate, int], None], answers: dict[str, EW], call: str) -> None:
    control, handle = _memory()
    control.select_mode("EDIT")
    state(control, handle)
    if (expected := answers.get(call, OK)) == OK:
        assert CALLS[call](handle) == OK
    else:
        unchanged(control, lambda: CALLS[call](handle), expected)
        assert (control.transfer is not None) is (state in (_download, _compare))


@pytest.mark.covers("fanuc.EW_BUSY", "fanuc.mode.MEM")
@covers("cnc_delete.err.EW_BUSY")
@pytest.mark.covers("fanuc.cnc_delete", "fanuc.cnc_search")
@pytest.mark.covers(
    "fanuc.concept.program_busy_conditions", "fanuc.concept.op_signal", "fanuc.concept.selected_program"
)
def test_the_selected_program_is_not_deleted() -> None:
    control, handle = _memory()
    unchanged(control, lambda: fwlib.cnc_delete(handle, 201), EW.EW_BUSY)
    assert fwlib.cnc_search(handle, 12) == OK
    assert fwlib.cnc_delete(handle, 201) == OK


@pytest.mark.covers("fanuc.cnc_delete", "fanuc.cnc_search")
@pytest.mark.covers("fanuc.concept.program_busy_conditions", "fanuc.concept.op_signal")
@pytest.mark.covers(
    "fanuc.cnc_delall", "fanuc.cnc_delall.err.EW_BUSY", "fanuc.mode.OTHER", "fanuc.enum.search.background"
)
def test_in_other_modes_than_edit_and_mem_the_op_signal_does_not_matter() -> None:
    control, handle = _memory()
    _running(control, handle)
    control.select_mode("JOG")
    assert fwlib.cnc_search(handle, 12) == OK
    assert fwlib.cnc_delete(handle, 12) == OK
    unchanged(control, lambda: fwlib.cnc_delall(handle), BUSY)  # O201 is being executed


@pytest.mark.covers("fanuc.EW_PROT", "fanuc.cnc_dwnstart")
@pytest.mark.covers("fanuc.cnc_delall")
@covers(
    "concept.write_protection_programs", "cnc_delall.err.EW_PROT", "cnc_delete.err.EW_PROT", "ncparam.3202_0",
    "ncparam.3202_4", "cnc_download.err.EW_PROT", "cnc_dwnend.err.EW_PROT",
)  # fmt: skip
@pytest.mark.parametrize(
    ("parameter", "value", "guarded", "free"),
    [
        (3202, 1, (8000, 8999), (7999, 9000)),
        (3202, 16, (9000, 9999), (8999, 7)),
        (3202, 0xEF, (8001, 8500), (7999, 9999)),  # the other bits say nothing of programs
        (3202, 0xFE, (9001, 9998), (8000, 1)),
        (3210, 55, (9000, 9001), (8999, 1)),
    ],
)
@pytest.mark.covers("fanuc.cnc_delete")
@pytest.mark.covers("fanuc.cnc_download", "fanuc.cnc_dwnend")
@pytest.mark.covers("fanuc.concept.program_number_range")
def test_parameters_protect_programs(
    parameter: int, value: int, guarded: tuple[int, int], free: tuple[int, int]
) -> None:
    control, handle = attached()
    control.select_mode("EDIT")
    registered(control, **{f"O{number}": "\nM99\n" for number in (guarded[0], free[0])})
    control.parameters.set(parameter, value)
    unchanged(control, lambda: sent(handle, f"\nO{guarded[1]}\nM99\n%")[0], PROT)
    unchanged(control, lambda: sent(handle, f"\nO{guarded[1]}\nM99\n%")[1], PROT)
    assert sent(handle, f"\nO{free[1]}\nM99\n%") == (OK, OK)
    unchanged(control, lambda: fwlib.cnc_delete(handle, guarded[0]), PROT)
    assert fwlib.cnc_delete(handle, free[0]) == OK
    assert fwlib.cnc_delall(handle) == PROT
    assert [each.number for each in control.programs.directory()] == [guarded[0]]
    if parameter == 3210:
        control.parameters.set(3211, 55)  # the key word
    else:
        control.parameters.set(parameter, 0)
    assert fwlib.cnc_delall(handle) == OK
    assert len(control.programs) == 0


@pytest.mark.covers("fanuc.EW_PROT")
@covers("ncparam.3290_7")
@pytest.mark.covers("fanuc.cnc_delete")
@pytest.mark.covers("fanuc.concept.write_protection_programs", "fanuc.concept.protect_key")
@pytest.mark.covers("fanuc.cnc_delete.err.EW_PROT", "fanuc.cnc_dwnstart", "fanuc.cnc_dwnstart.err.EW_PROT")
def test_which_key_protects_programs() -> None:
    control, handle = _memory()
    control.protect_key(key=1)
    assert fwlib.cnc_delete(handle, 12) == OK
    control.parameters.set(3290, 1 << 7)
    unchanged(control, lambda: fwlib.cnc_delete(handle, 200), PROT)
    control.protect_key(False, key=1)
    control.protect_key(key=3)
    assert fwlib.cnc_delete(handle, 200) == OK
    control.parameters.set(3290, 0)
    unchanged(control, lambda: fwlib.cnc_dwnstart(handle), PROT)


@pytest.mark.covers(
    "fanuc.EW_DATA", "fanuc.cnc_dwnend.err.EW_DATA", "fanuc.cnc_dwnstart", "fanuc.concept.program_number_range",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_download")
@pytest.mark.covers("fanuc.concept.compare_running")
@pytest.mark.covers("fanuc.cnc_dwnend")
def test_a_comparison_tells_whether_programs_are_the_same_and_changes_nothing() -> None:
    control, handle = attached()
    assert sent(handle, FORMAT) == (OK, OK)
    for stream, code in (
        (FORMAT, OK),
        (FORMAT.replace("10.", "11."), EW.EW_DATA),
        ("\nO9\nM30\n%", EW.EW_DATA),
        ("\nO1234\nG1 F0.3 W10.\nM30\n%", OK),
    ):
        control.start_compare()
        assert fwlib.cnc_download(handle, stream, len(stream)) == OK
        unchanged(control, lambda code=code: fwlib.cnc_dwnend(handle), code)  # type: ignore[misc]
