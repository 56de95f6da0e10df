"""The directory, the program in execution, MDI, the cursor (Manual 000, 1323-2710)."""

from __future__ import annotations

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from support.fanuc_programs import covers, uploaded
from support.power_mate import OK, attached, registered, running

FORMAT = "\nO1234\nG1F0.3W10.\nM30\n%"
UPLOADED = "%\nO1234\nG1F0.3W10.\nM30\n%"
PIECES = ("\n", "O1234\n", "M3 S1200\n", "G0 Z0\n", "G0 X0 Y0\n", "G1 F500 X120. Y-30.\n", "M30\n", "%")
STORED = b"O1234\nM3S1200\nG0Z0\nG0X0Y0\nG1F500X120.Y-30.\nM30\n"


# ---------------------------------------------------------------------- directory


def _directory() -> tuple[PowerMate, int]:
    """Return a memory with the manual's four programs: comments and characters."""
    control, handle = attached()
    for number, comment, size in (
        (12, "(TEST)", 420),
        (200, "(WORK1)", 352),
        (201, "", 537),
        (9001, "(SUB-PRO1)", 781),
    ):
        head = f"O{number:04d}{comment}\n"
        control.programs.register(number, head + "X" * (size - len(head) - 1) + "\n")
    return control, handle


LISTS = {
    0: "O12O200O201O9001%",
    1: "%\nO12(TEST)\nO200(WORK1)\nO201()\nO9001(SUB-PRO1)\n%",
    2: "O12(TEST)420O200(WORK1)352O201()537O9001(SUB-PRO1)781%",
}


@pytest.mark.covers(
    "fanuc.PERCENT", "fanuc.enum.rdprogdir_type.0", "fanuc.enum.rdprogdir_type.1", "fanuc.enum.rdprogdir_type.2",
    "fanuc.example.cnc_rdprogdir", "fanuc.format.progdir_type0", "fanuc.format.progdir_type1",
    "fanuc.format.progdir_type2",
)  # fmt: skip
@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(k, marks=covers(f"enum.rdprogdir_type.{k}", f"format.progdir_type{k}"), id=str(k))
        for k in (0, 1, 2)
    ],
)
@covers("example.cnc_rdprogdir_format", "cnc_rdprogdir", "concept.truncation")
@covers("struct.PRGDIR", "PRGDIR.prg_data")
@pytest.mark.covers(
    "fanuc.concept.no_nul_termination",
    "fanuc.LF",
    "fanuc.concept.comment_rules",
    "fanuc.concept.memory_accounting",
)
def test_example_directory(kind: int) -> None:
    _, handle = _directory()
    text = LISTS[kind]
    assert len(text) == {0: 17, 1: 48, 2: 54}[kind]
    code, found = fwlib.cnc_rdprogdir(handle, kind, 1, 9999, 256)
    assert (code, found.prg_data.decode(), len(found.pack())) == (OK, text, 256)
    assert found.pack()[len(text) :] == b"\0" * (256 - len(text))
    for length in (15, 1, len(text)):
        code, found = fwlib.cnc_rdprogdir(handle, kind, 1, 9999, length)
        assert (code, found.pack().decode()) == (OK, text[:length])
    assert [fwlib.cnc_rdprogdir(handle, k, 1, 9999, 15)[1].pack() for k in (0, 1, 2)] == [
        b"O12O200O201O900",
        b"%\nO12(TEST)\nO20",
        b"O12(TEST)420O20",
    ]


@covers("example.cnc_rdprogdir")
@pytest.mark.covers("fanuc.cnc_rdprogdir")
@pytest.mark.covers("fanuc.concept.no_nul_termination", "fanuc.format.progdir_type0")
def test_example_directory_printed_program_by_program() -> None:
    _, handle = _directory()
    code, found = fwlib.cnc_rdprogdir(handle, 0, 200, 9000, 255)
    assert code == OK
    text = "".join(f"\n{each}" if each == "O" else each for each in found.prg_data.decode())
    assert text == "\nO200\nO201%"


@pytest.mark.covers("fanuc.cnc_rdprogdir")
@covers("concept.comment_rules", "concept.program_number_range")
@pytest.mark.covers(
    "fanuc.PERCENT",
    "fanuc.format.progdir_type0",
    "fanuc.format.progdir_type1",
    "fanuc.format.progdir_type2",
    "fanuc.concept.truncation",
)
def test_ranges_and_comments_of_the_directory() -> None:
    control, handle = attached()
    for kind in (0, 1, 2):
        assert fwlib.cnc_rdprogdir(handle, kind, 1, 9999, 10)[1].prg_data == b"%"
    long = "".join(chr(65 + k % 26) for k in range(53))
    registered(
        control, O1=f"({long[:48]})\nM30\n", O9999=f"({long})\nM30\n", O5="\n(NO COMMENT OF IT)\nM30\n"
    )
    assert fwlib.cnc_rdprogdir(handle, 1, 1, 9999, 500)[1].prg_data.decode() == (
        f"%\nO1({long[:48]})\nO5()\nO9999({long[:48]})\n%"
    )
    for first, last, text in ((1, 1, b"O1%"), (2, 4, b"%"), (5, 9999, b"O5O9999%"), (9999, 9999, b"O9999%")):
        assert fwlib.cnc_rdprogdir(handle, 0, first, last, 50)[1].prg_data == text
    assert fwlib.cnc_rdprogdir(handle, 2, 2, 4, 50)[1].prg_data == b"%"


@pytest.mark.covers("fanuc.cnc_rdprogdir")
@covers("cnc_rdprogdir.err.EW_LENGTH", "cnc_rdprogdir.err.EW_NUMBER", "cnc_rdprogdir.err.EW_ATTRIB")
@pytest.mark.covers("fanuc.concept.length_argument", "fanuc.concept.program_number_range")
def test_directory_requests_that_are_refused() -> None:
    _, handle = _directory()
    for length in (0, -1):
        assert fwlib.cnc_rdprogdir(handle, 3, 0, 0, length)[0] == EW.EW_LENGTH
    for first, last in ((0, 9999), (1, 10000), (-1, 5), (201, 200), (5, 0)):
        assert fwlib.cnc_rdprogdir(handle, 3, first, last, 100)[0] == EW.EW_NUMBER
    for kind in (-1, 3):
        assert fwlib.cnc_rdprogdir(handle, kind, 1, 9999, 100)[0] == EW.EW_ATTRIB


@covers(
    "cnc_rdproginfo", "enum.rdproginfo_type.0", "enum.rdproginfo_type.1", "format.proginfo_ascii",
    "example.cnc_rdproginfo", "cnc_rdproginfo.err.EW_LENGTH", "cnc_rdproginfo.err.EW_ATTRIB",
)  # fmt: skip
@pytest.mark.covers(
    "fanuc.ODBNC.u.asc",
    "fanuc.ODBNC.u.bin.reg_prg",
    "fanuc.ODBNC.u.bin.unreg_prg",
    "fanuc.ODBNC.u.bin.used_mem",
    "fanuc.ODBNC.u.bin.unused_mem",
)
@pytest.mark.covers("fanuc.struct.ODBNC")
@pytest.mark.covers("fanuc.concept.length_argument", "fanuc.PERCENT", "fanuc.concept.memory_accounting")
def test_program_information() -> None:
    _, handle = _directory()
    code, info = fwlib.cnc_rdproginfo(handle, 0, 12)
    numbers = info.u.bin
    assert code == OK
    assert (numbers.reg_prg, numbers.unreg_prg, numbers.used_mem, numbers.unused_mem) == (
        4,
        121,
        2090,
        125_910,
    )
    code, info = fwlib.cnc_rdproginfo(handle, 1, 31)
    assert (code, info.u.asc) == (OK, b"%\n4\n121\n2090\n125910\n%")
    assert info.pack()[22:] == b"\0" * 9
    for kind, length in ((0, 11), (0, 13), (0, 31), (1, 12), (1, 30), (2, 20)):
        assert fwlib.cnc_rdproginfo(handle, kind, length)[0] == EW.EW_LENGTH
    for kind, length in ((-1, 12), (2, 31)):
        assert fwlib.cnc_rdproginfo(handle, kind, length)[0] == EW.EW_ATTRIB


# ---------------------------------------------------------------------- execution


@covers("example.cnc_rdprgnum", "cnc_rdprgnum", "concept.subprogram_numbers")
@pytest.mark.covers("fanuc.ODBPRO.data", "fanuc.ODBPRO.mdata")
@pytest.mark.covers("fanuc.struct.ODBPRO")
@pytest.mark.covers("fanuc.concept.selected_program")
@pytest.mark.covers("fanuc.cnc_rdseqnum")
def test_example_program_numbers_in_a_subprogram() -> None:
    control, handle = attached()
    registered(
        control,
        O1234="\nN10 M98 P5678\nN20 M30\n",
        O5678="\nN110 M98 P9876\nN120 G4 P100\nM99\n",
        O9876="\nN210 G4 P300\nN220 M99\n",
    )
    control.select_program(1234)
    assert fwlib.cnc_rdprgnum(handle)[1] == fwlib.ODBPRO(data=1234, mdata=1234)
    seen = set()
    running(control, 1234)
    while control.programs.in_operation:
        numbers = fwlib.cnc_rdprgnum(handle)[1]
        seen.add((numbers.data, numbers.mdata, fwlib.cnc_rdseqnum(handle)[1].data))
        control.advance(10)
    assert {(9876, 1234, 210), (5678, 1234, 120)} <= seen
    assert {main for _, main, _ in seen} == {1234}
    assert fwlib.cnc_rdprgnum(handle)[1] == fwlib.ODBPRO(data=1234, mdata=1234)


@covers("example.cnc_rdseqnum", "cnc_rdseqnum", "concept.seqnum_retention")
def test_example_sequence_number_is_kept_by_blocks_without_one() -> None:
    control, handle = attached()
    registered(control, O1234="\nG4 P50\nN10 M3 S1500\nN20 T12\nN30 G0 X110.\nX90.\nN40 G0 X0\nM30\n")
    assert fwlib.cnc_rdseqnum(handle)[1].data == 0
    running(control, 1234)
    control.advance(20)
    assert fwlib.cnc_rdseqnum(handle)[1].data == 0
    found: list[tuple[int, str]] = []
    while control.programs.in_operation:
        block = control.execution.block
        assert block is not None
        found.append((fwlib.cnc_rdseqnum(handle)[1].data, block.text))
        control.advance(5)
    assert (30, "N30 G0 X110.") in found
    assert (30, "X90.") in found
    assert found[-1][0] == 40
    assert fwlib.cnc_rdseqnum(handle)[1].data == 40


@pytest.mark.covers(
    "fanuc.ODBPRO.data", "fanuc.ODBPRO.mdata", "fanuc.cnc_rddynamic", "fanuc.concept.dynamic_snapshot",
    "fanuc.concept.position_contents", "fanuc.concept.selected_program", "fanuc.enum.axis.1..m",
)  # fmt: skip
@covers("concept.seqnum_retention", "cnc_rdseqnum", "ODBSEQ.data", "concept.subprogram_numbers")
@pytest.mark.covers("fanuc.cnc_rdprgnum", "fanuc.ODBDY.seqnum")
def test_a_subprogram_without_sequence_numbers_keeps_that_of_its_caller() -> None:
    control, handle = attached()
    registered(
        control,
        O1="\nN5 G4P1\nN12345\nM98P2\nN30 M30\n",
        O2="\nG4P40\nM98P3\nM30\n",
        O3="\nG4P50\nN7 G4P60\nM99\n",
    )
    running(control, 1)
    found = []
    while control.programs.in_operation:
        numbers = fwlib.cnc_rdprgnum(handle)[1]
        found.append((numbers.mdata, numbers.data, fwlib.cnc_rdseqnum(handle)[1].data))
        assert fwlib.cnc_rddynamic(handle, 1, 38)[1].seqnum == found[-1][2]
        control.advance(5)
    in_order = list(dict.fromkeys(found))
    assert in_order[-3:] == [(1, 2, 12345), (1, 3, 12345), (1, 3, 7)]


@pytest.mark.covers("fanuc.EW_LENGTH", "fanuc.concept.length_argument")
@covers("cnc_rdexecprog", "cnc_rdexecprog.err.EW_LENGTH")
@pytest.mark.covers("fanuc.concept.subprogram_numbers", "fanuc.concept.truncation")
def test_the_program_in_execution() -> None:
    control, handle = attached()
    registered(control, O7="\nN10G1X10.F600\nN20Y5.\nN30X0\nM30\n")
    assert fwlib.cnc_rdexecprog(handle, 100) == (OK, 0, 0, b"")
    control.select_program(7)
    assert fwlib.cnc_rdexecprog(handle, 9) == (OK, 9, 0, b"O0007\nN10")
    running(control, 7, lambda: control.execution.sequence == 20)
    control.advance(1)  # the next block is read in the cycle after one has begun
    code, count, ahead, text = fwlib.cnc_rdexecprog(handle, 100)
    assert (code, text, count) == (OK, b"N20Y5.\nN30X0\nM30\n", 17)
    assert ahead == 1
    assert fwlib.cnc_rdexecprog(handle, 4)[1:] == (4, ahead, b"N20Y")
    assert fwlib.cnc_rdexecprog(handle, 0) == (EW.EW_LENGTH, 0, 0, b"")


# ---------------------------------------------------------------------- MDI


@pytest.mark.covers(
    "fanuc.EW_DATA", "fanuc.ODBAXIS.data", "fanuc.concept.position_contents", "fanuc.enum.axis.1..m",
    "fanuc.example.cnc_absolute",
)  # fmt: skip
@covers("cnc_wrmdiprog", "example.cnc_wrmdiprog_format", "concept.mdi_program", "mode.MDI")
@pytest.mark.covers("fanuc.cnc_absolute", "fanuc.cnc_wrmdiprog.err.EW_DATA")
@pytest.mark.covers("fanuc.concept.program_number_range")
def test_example_mdi_program() -> None:
    control, handle = attached(axes=1)
    control.select_mode("MDI")
    text = "\nO1234\nG1F600X10.\nM30\n%"
    assert fwlib.cnc_wrmdiprog(handle, 23, FORMAT) == OK
    assert fwlib.cnc_wrmdiprog(handle, len(text), "?" + text[:1] + text[1:]) == EW.EW_DATA  # the % is cut off
    assert fwlib.cnc_wrmdiprog(handle, len(text), text) == OK
    control.cycle_start()
    control.advance(3000)
    assert fwlib.cnc_absolute(handle, 1, 8)[1].data[0] == 10_000
    assert len(control.programs) == 0


@pytest.mark.covers(
    "fanuc.EW_DATA", "fanuc.EW_LENGTH", "fanuc.EW_MODE", "fanuc.EW_REJECT", "fanuc.concept.length_argument",
    "fanuc.mode.MEM",
)  # fmt: skip
@covers(
    "cnc_wrmdiprog.err.EW_LENGTH", "cnc_wrmdiprog.err.EW_DATA", "cnc_wrmdiprog.err.EW_MODE",
    "cnc_wrmdiprog.err.EW_REJECT", "range.mdi_length",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrmdiprog")
@pytest.mark.covers("fanuc.concept.mode_matrix", "fanuc.concept.mdi_program")
@pytest.mark.covers("fanuc.mode.MDI")
def test_mdi_programs_that_are_refused() -> None:
    control, handle = attached(axes=1)

    def put(text: str, length: int | None = None) -> EW:
        before = control.mdi.state.blocks
        code = fwlib.cnc_wrmdiprog(handle, len(text) if length is None else length, text)
        assert (control.mdi.state.blocks == before) is (code != OK)
        return code

    assert put(FORMAT) == EW.EW_MODE
    control.select_mode("MDI")
    full = "\nO1\n" + "G4P123\n" * 27 + "M30\n%\n"
    assert len(full) == 199
    assert put(full) == OK
    assert put(full + " ") == EW.EW_LENGTH
    assert put(FORMAT, 0) == EW.EW_LENGTH
    assert put(FORMAT, -3) == EW.EW_LENGTH
    assert put(FORMAT, 24) == EW.EW_LENGTH
    for text in ("\nO1\nG1X1~\n%", "\nG1X1\n%", "\nO1\n%", "\nO1\nM30\n", "O1M30%", "\nO1\nM30\nO2\nM30\n%"):
        assert put(text) == EW.EW_DATA
    control.cycle_start()
    control.advance(20)
    assert put(FORMAT) == EW.EW_REJECT
    control.reset()
    control.advance(20)
    registered(control, O5="\nM30\n")
    with control.programs.edit(5, background=True):
        assert put(FORMAT) == EW.EW_REJECT
    assert put(FORMAT) == OK


@pytest.mark.covers("fanuc.cnc_wrmdiprog")
@covers("cnc_rdmdipntr", "cnc_wrmdipntr")
@pytest.mark.covers(
    "fanuc.ODBMDIP.mdiprog", "fanuc.ODBMDIP.mdipntr", "fanuc.ODBMDIP.crntprog", "fanuc.ODBMDIP.crntpntr"
)
@pytest.mark.covers("fanuc.struct.ODBMDIP")
@pytest.mark.covers("fanuc.concept.mdi_program", "fanuc.concept.program_number_range")
def test_mdi_pointers() -> None:
    control, handle = attached(axes=1)
    registered(control, O77="\nG4P80\nM99\n")
    control.select_mode("MDI")
    text = "\nO1\nG4P100\nM98P77\nG4P120\nG4P140\nM30\n%"
    assert fwlib.cnc_wrmdiprog(handle, len(text), text) == OK

    def pointers() -> tuple[int, int, int, int]:
        code, data = fwlib.cnc_rdmdipntr(handle)
        assert code == OK
        return data.mdiprog, data.mdipntr, data.crntprog, data.crntpntr

    def seen() -> list[tuple[int, int, int, int]]:
        control.cycle_start()
        found = []
        while control.control.channels[0].active:
            control.advance(5)
            found.append(pointers())
        return list(dict.fromkeys(found))

    assert pointers() == (0, 0, 0, 0)
    # One block is read ahead, in the program where it is.
    assert seen() == [(0, 0, 77, 1), (77, 1, 0, 2), (0, 2, 0, 3), (0, 3, 0, 4), (0, 0, 0, 0)]
    assert fwlib.cnc_wrmdipntr(handle, 2) == OK
    assert pointers() == (0, 2, 0, 2)
    control.cycle_start()
    control.advance(5)
    assert pointers()[:2] == (0, 2)
    assert pointers()[3] in (3, 4)  # read ahead
    control.reset()
    assert fwlib.cnc_wrmdipntr(handle, 3) == OK
    assert fwlib.cnc_wrmdiprog(handle, len(text), text) == OK
    assert pointers() == (0, 0, 0, 0)  # another program begins at its head


@pytest.mark.covers("fanuc.EW_DATA", "fanuc.mode.MEM")
@pytest.mark.covers("fanuc.cnc_rdmdipntr", "fanuc.cnc_wrmdipntr", "fanuc.cnc_wrmdiprog")
@covers(
    "cnc_rdmdipntr.err.EW_MODE", "cnc_wrmdipntr.err.EW_DATA", "cnc_wrmdipntr.err.EW_MODE",
    "cnc_wrmdipntr.err.EW_REJECT",
    "EW_MODE", "EW_REJECT",
)  # fmt: skip
@pytest.mark.covers("fanuc.concept.mode_matrix", "fanuc.concept.mdi_program")
def test_mdi_pointers_that_are_refused() -> None:
    control, handle = attached(axes=1)
    assert fwlib.cnc_rdmdipntr(handle)[0] == EW.EW_MODE
    assert fwlib.cnc_wrmdipntr(handle, 0) == EW.EW_MODE
    control.select_mode("MDI")
    assert fwlib.cnc_wrmdipntr(handle, 0) == EW.EW_REJECT  # no program
    assert fwlib.cnc_wrmdiprog(handle, 23, FORMAT) == OK
    assert fwlib.cnc_wrmdipntr(handle, 1) == OK
    for block in (-1, 2, 99):
        assert fwlib.cnc_wrmdipntr(handle, block) == EW.EW_DATA
        assert control.mdi.state.start == 1
    registered(control, O5="\nM30\n")
    with control.programs.edit(5, background=True):
        assert fwlib.cnc_wrmdipntr(handle, 0) == EW.EW_REJECT


# ---------------------------------------------------------------------- cursor


@pytest.mark.covers(
    "fanuc.ALL_AXES", "fanuc.EW_DATA", "fanuc.ODBAXIS.data", "fanuc.ODBPRO.data", "fanuc.ODBSEQ.data",
    "fanuc.concept.position_contents", "fanuc.concept.subprogram_numbers", "fanuc.enum.axis.ALL_AXES",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdexecprog", "fanuc.cnc_rdseqnum")
@covers("cnc_seqsrch", "cnc_rewind")
@pytest.mark.covers("fanuc.cnc_absolute")
@pytest.mark.covers("fanuc.concept.seqnum_retention", "fanuc.concept.selected_program")
@pytest.mark.covers("fanuc.cnc_search", "fanuc.cnc_seqsrch.err.EW_DATA", "fanuc.enum.search.foreground")
@pytest.mark.covers("fanuc.cnc_rdprgnum")
def test_a_start_begins_at_the_sequence_number_that_was_sought() -> None:
    control, handle = attached(axes=2)
    registered(control, O7="\nN10 G1 X10. F6000\nN20 Y5.\nN30 X2.5\nM30\n")
    control.select_program(7)
    assert fwlib.cnc_seqsrch(handle, 20) == OK
    assert fwlib.cnc_rdexecprog(handle, 3)[3] == b"N20"
    assert fwlib.cnc_rdseqnum(handle)[1].data == 20
    assert fwlib.cnc_rewind(handle) == OK
    assert fwlib.cnc_rdexecprog(handle, 3)[3] == b"O00"
    assert fwlib.cnc_seqsrch(handle, 30) == OK
    assert fwlib.cnc_seqsrch(handle, 10) == OK  # from the head, wherever the cursor was
    assert fwlib.cnc_rdexecprog(handle, 3)[3] == b"N10"
    assert fwlib.cnc_seqsrch(handle, 30) == OK
    control.parameters.set(1422, 6000)
    control.programs.register(7, "O0007\nN10 G1 X10. F6000\nN20 Y5.\nN30 G1 X2.5 F6000\nM30\n")
    control.cycle_start()
    control.advance(3000)
    assert list(fwlib.cnc_absolute(handle, -1, 12)[1].data[:2]) == [2500, 0]
    control.cycle_start()  # from its head again
    control.advance(5000)
    assert list(fwlib.cnc_absolute(handle, -1, 12)[1].data[:2]) == [2500, 5000]
    registered(control, O8="\nN20 G1 Y1. F6000\nN40 X4.\nM30\n")
    assert fwlib.cnc_seqsrch(handle, 20) == OK
    assert fwlib.cnc_search(handle, 8) == OK  # the cursor is that of the selected program
    assert fwlib.cnc_rdexecprog(handle, 5)[3] == b"O0008"
    assert fwlib.cnc_seqsrch(handle, 30) == EW.EW_DATA
    assert fwlib.cnc_seqsrch(handle, 40) == OK
    assert (fwlib.cnc_rdseqnum(handle)[1].data, fwlib.cnc_rdprgnum(handle)[1].data) == (40, 8)


@pytest.mark.covers(
    "fanuc.cnc_delete",
    "fanuc.cnc_download",
    "fanuc.cnc_dwnend",
    "fanuc.cnc_rdexecprog",
    "fanuc.cnc_rdmdipntr",
    "fanuc.cnc_rdprgnum",
    "fanuc.cnc_rdproginfo",
    "fanuc.cnc_rdseqnum",
    "fanuc.cnc_rewind",
    "fanuc.cnc_search",
    "fanuc.cnc_seqsrch",
)
@covers(
    "cnc_seqsrch.err.EW_DATA", "cnc_seqsrch.err.EW_MODE", "cnc_seqsrch.err.EW_REJECT", "cnc_rewind.err.EW_MODE",
    "cnc_rewind.err.EW_REJECT", "concept.mode_matrix",
)  # fmt: skip
@pytest.mark.covers(
    "fanuc.cnc_dwnstart",
    "fanuc.cnc_dwnstart.err.EW_BUSY",
    "fanuc.cnc_rdmdipntr.err.EW_MODE",
    "fanuc.cnc_rdprogdir",
    "fanuc.cnc_wrmdiprog",
    "fanuc.cnc_wrmdiprog.err.EW_MODE",
)
@pytest.mark.covers("fanuc.concept.selected_program")
def test_searches_of_the_cursor_that_are_refused() -> None:
    control, handle = attached(axes=1)
    registered(control, O7="\nN10 G1 X10. F600\nN20 X5.\nM30\n")
    assert fwlib.cnc_seqsrch(handle, 10) == EW.EW_DATA  # nothing is selected
    assert fwlib.cnc_rewind(handle) == EW.EW_REJECT
    control.select_program(7)
    assert fwlib.cnc_seqsrch(handle, 20) == OK
    for number in (11, 0, -1, 99_999_999):
        assert fwlib.cnc_seqsrch(handle, number) == EW.EW_DATA
        assert control.state.cursor == 2
    for mode in ("MDI", "EDIT", "HND", "JOG", "T-JOG", "T-HND", "INC", "REF", "RMT"):
        control.select_mode(mode)
        assert fwlib.cnc_seqsrch(handle, 10) == EW.EW_MODE
        assert fwlib.cnc_rewind(handle) == (EW.EW_MODE if mode == "MDI" else OK)
        assert fwlib.cnc_rdmdipntr(handle)[0] == (OK if mode == "MDI" else EW.EW_MODE)
        assert fwlib.cnc_wrmdiprog(handle, 23, FORMAT) == (OK if mode == "MDI" else EW.EW_MODE)
        assert fwlib.cnc_dwnstart(handle) == (EW.EW_BUSY if mode == "MDI" else OK)
        if mode != "MDI":
            control.select_mode("MDI")
            assert fwlib.cnc_download(handle, "\n", 1) == EW.EW_BUSY
            assert fwlib.cnc_dwnend(handle) == EW.EW_BUSY
            control.select_mode(mode)
            assert fwlib.cnc_download(handle, "\nO8\nM30\n%", 9) == OK
            assert fwlib.cnc_dwnend(handle) == OK
            assert fwlib.cnc_delete(handle, 8) == OK
        assert uploaded(handle, 7).startswith("%\nO0007\nN10")
        assert fwlib.cnc_rdprogdir(handle, 0, 1, 9999, 20)[1].prg_data == b"O7%"
        assert fwlib.cnc_rdproginfo(handle, 0, 12)[0] == OK
        assert fwlib.cnc_rdprgnum(handle)[1].data == 7
        assert fwlib.cnc_rdseqnum(handle)[0] == OK
        assert fwlib.cnc_rdexecprog(handle, 5)[0] == OK
        assert fwlib.cnc_search(handle, 7) == OK
    running(control, 7)
    control.advance(100)
    assert fwlib.cnc_seqsrch(handle, 10) == EW.EW_REJECT
    assert fwlib.cnc_rewind(handle) == EW.EW_REJECT
    control.feed_hold()
    control.advance(300)
    assert fwlib.cnc_seqsrch(handle, 10) == EW.EW_REJECT
    assert fwlib.cnc_rewind(handle) == EW.EW_REJECT
    control.reset()
    control.advance(300)
    assert fwlib.cnc_seqsrch(handle, 10) == OK
    assert fwlib.cnc_rewind(handle) == OK
