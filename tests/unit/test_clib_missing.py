"""What a program imports that a library does not have: PE files of both widths, ELF files, and broken ones."""

from __future__ import annotations

import struct
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from polycnc.cli._app import app
from polycnc.errors import UsageError
from polycnc.servers.calls import library_of, missing_of
from support.often import share

_AT = 0x3000  # where the only section begins when the program is loaded
_SIZE = 0x18000


def _pe(names: list[str | int], *, wide: bool, library: str = "FWLIB32.dll", rows: int = 1) -> bytes:
    """Return a program for Windows with two libraries, the second in so many rows (Microsoft's format PE, 6.4)."""
    optional = 240 if wide else 224
    directories = bytearray(16 * 8)
    struct.pack_into("<II", directories, 8, _AT, 60)
    head = struct.pack("<H", 0x20B if wide else 0x10B).ljust(optional - 132, b"\0")
    body = head + struct.pack("<I", 16) + bytes(directories)
    section = struct.pack("<8sIIII16x", b".idata", _SIZE, _AT, _SIZE, 0x400)
    coff = struct.pack("<HHIIIHH", 0x8664 if wide else 0x14C, 1, 0, 0, 0, optional, 0x102)
    header = b"MZ".ljust(0x3C, b"\0") + struct.pack("<I", 0x40) + b"PE\0\0" + coff + body + section
    form, top = ("<Q", 1 << 63) if wide else ("<I", 1 << 31)
    data, thunks = bytearray(20 * (rows + 2)), list[int]()
    for name in names:
        thunks.append(name | top if isinstance(name, int) else _AT + len(data))
        if isinstance(name, str):
            data += struct.pack("<H", 7) + name.encode() + b"\0"
    other = _AT + len(data)
    data += b"KERNEL32.dll\0"
    own = _AT + len(data)
    data += library.encode() + b"\0"
    table = _AT + len(data)
    data += b"".join(struct.pack(form, each) for each in [*thunks, 0])
    nothing = _AT + len(data)
    data += struct.pack(form, 0)
    struct.pack_into("<IIIII", data, 0, nothing, 0, 0, other, nothing)
    for row in range(rows):
        struct.pack_into("<IIIII", data, 20 * (row + 1), table, 0, 0, own, table)
    return header.ljust(0x400, b"\0") + bytes(data).ljust(_SIZE, b"\0")


def _elf(names: list[str]) -> bytes:
    """Return a 64-bit Linux program with a table of symbols, the first ones undefined (ELF-64, sections 5 and 6)."""
    texts = b"\0" + b"\0".join(each.encode() for each in names) + b"\0main\0"
    rows = bytes(24)
    for each in names:
        rows += struct.pack("<IBBHQQ", texts.index(b"\0" + each.encode() + b"\0") + 1, 0x12, 0, 0, 0, 0)
    rows += struct.pack("<IBBHQQ", texts.index(b"main"), 0x12, 0, 5, 0x1130, 9)
    sections = 64 + len(rows) + len(texts)
    header = b"\x7fELF\2\1\1".ljust(16, b"\0")
    header += struct.pack("<HHIQQQIHHHHHH", 3, 62, 1, 0, 0, sections, 0, 64, 0, 0, 64, 3, 0)
    made = header + rows + texts + bytes(64)
    made += struct.pack("<IIQQQQIIQQ", 0, 11, 0, 0, 64, len(rows), 2, 1, 8, 24)
    return made + struct.pack("<IIQQQQIIQQ", 0, 3, 0, 0, 64 + len(rows), len(texts), 0, 0, 1, 0)


@pytest.mark.parametrize("wide", [False, True])
def test_a_windows_program_tells_what_it_takes_and_what_is_missing(wide: bool, tmp_path: Path) -> None:
    program = tmp_path / "old.exe"
    program.write_bytes(_pe(["cnc_statinfo", "cnc_rdspmeter", 77, "cnc_absolute", "cnc_statinfo"], wide=wide))
    taken, missing = missing_of(program, library_of("fanuc"))
    assert taken == ["cnc_statinfo", "cnc_rdspmeter", "#77", "cnc_absolute"]
    assert missing == ["cnc_rdspmeter", "#77"]
    assert missing_of(program, library_of("imc")) == ([], [])


def test_a_linux_program_tells_names_that_begin_as_those_of_the_library(tmp_path: Path) -> None:
    program = tmp_path / "collector"
    program.write_bytes(_elf(["printf", "cnc_rdcnt", "cnc_alarm", "pmc_rdpmcrng", "cncurses"]))
    assert missing_of(program, library_of("fanuc")) == (
        ["cnc_rdcnt", "cnc_alarm", "pmc_rdpmcrng"],
        ["cnc_rdcnt"],
    )
    with pytest.raises(UsageError, match="does not say what it takes from mcug3"):
        missing_of(program, library_of("apci"))


def test_the_command_says_what_is_missing_and_what_has_no_effect(tmp_path: Path) -> None:
    program = tmp_path / "OLD.EXE"
    program.write_bytes(_pe(["rdtrvl", "wraux", "BootFile", "openport"], wide=False, library="mcug3.DLL"))
    done = CliRunner().invoke(app, ["clib", "apci", "--missing", str(program)])
    assert done.exit_code == 1
    assert done.stdout.splitlines() == [
        "OLD.EXE takes 4 functions from mcug3, of which 1 are missing",
        "openport",
        "BootFile has no effect: booting a served board would make another one than the one that is served; it "
        "answers 202",
        "wraux has no effect with the manual's record, which has no place for the value; TSRPX has one",
    ]
    program.write_bytes(_pe(["rdtrvl"], wide=True, library="MCUG3"))
    assert CliRunner().invoke(app, ["clib", "apci", "--missing", str(program)]).exit_code == 0
    assert list(tmp_path.iterdir()) == [program]


_WHOLE = (
    _pe(["cnc_statinfo", "cnc_rdspmeter", 77], wide=False),
    _pe(["cnc_statinfo", "cnc_rdspmeter", 77], wide=True),
    _elf(["cnc_rdcnt", "cnc_alarm"]),
)


@settings(max_examples=share(150), deadline=None)
@given(st.sampled_from(_WHOLE), st.data())
def test_a_cut_or_changed_program_is_read_or_refused_in_a_sentence(
    tmp_path_factory: pytest.TempPathFactory, whole: bytes, data: st.DataObject
) -> None:
    content = bytearray(whole[: data.draw(st.integers(0, len(whole)))])
    for _ in range(data.draw(st.integers(0, 6))):
        if content:
            at = data.draw(st.integers(0, len(content) - 1))
            content[at : at + 4] = data.draw(st.binary(min_size=1, max_size=4))
    program = tmp_path_factory.getbasetemp() / "hostile"
    program.write_bytes(content)
    taken, missing = list[str](), list[str]()
    with suppress(UsageError):
        taken, missing = missing_of(program, library_of("fanuc"))
    assert set(missing) <= set(taken)


def test_rows_that_share_a_long_table_cost_no_memory(tmp_path: Path) -> None:
    """Each row and each table is as long as it may be by itself; together they would be 65,620 names."""
    program = tmp_path / "shared.exe"
    program.write_bytes(_pe([7] * 20, wide=False, rows=3281))
    with pytest.raises(UsageError, match="is cut or broken"):
        missing_of(program, library_of("fanuc"))
    program.write_bytes(_pe([7] * 20, wide=False, rows=3270))
    assert missing_of(program, library_of("fanuc")) == (["#7"], ["#7"])


def test_what_is_no_program_is_refused(tmp_path: Path) -> None:
    text = tmp_path / "notes.txt"
    text.write_text("cnc_statinfo")
    with pytest.raises(UsageError, match="is no program for Windows or Linux"):
        missing_of(text, library_of("fanuc"))
    with pytest.raises(UsageError, match="cannot be read"):
        missing_of(tmp_path / "absent.exe", library_of("fanuc"))
