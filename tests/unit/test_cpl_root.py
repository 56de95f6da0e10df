"""The root of a control belongs to one control at a time, and its memory to no program (Manual 003, 2.4.3, 6.1.1)."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
from pathlib import Path

import pytest

from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.files import STORE, RootOwner
from polycnc.errors import UsageError
from polycnc.machine import Store
from support.cpl_runs import Root
from support.programs import MILL

REFUSED = "1: INVALID FILE NAME"
HOT = bytes.fromhex("d9d505f920a163d7") + struct.pack(">IIIII", 0, 0, 0, 512, 4096)
"""The head of a rollback journal that SQLite plays back when it opens the file beside it: the file becomes empty."""
COMPANIONS = [f"{STORE}{ending}" for ending in ("", "-journal", "-wal", "-shm", "-lock", "-mj0123ABCD")]
OTHERWISE = [
    *COMPANIONS,
    "CPL.STORE",
    "Cpl.Store-Journal",
    "cpl.store.",
    "cpl.store-wal .",
    "sub/cpl.store-journal",
]
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
HOLDER = """
import sys
from pathlib import Path
from polycnc.controllers.bosch.files import RootOwner
owner = RootOwner(Path(sys.argv[1]))
owner.take()
print("taken", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def root(tmp_path: Path) -> Root:
    return Root(tmp_path)


def kept(root: Root) -> object:
    return root.run("1 @7=@7").variables["@7"]


@pytest.fixture
def counted(root: Root) -> Root:
    """Return a root that keeps a permanent variable."""
    (root.folder / "sub").mkdir()
    root.run("1 @7=-41")
    return root


# ---------------------------------------------------------------------- the memory is no program's


@pytest.mark.covers("cpl.file.name")
@pytest.mark.parametrize("name", OTHERWISE)
def test_no_statement_reaches_the_memory_by_any_spelling(counted: Root, name: str) -> None:
    for statement in ('OPENW(1,"{}")', 'OPENR(1,"{}")', 'I%=ERASE("{}")', 'I%=FILEACCESS("{}")'):
        assert counted.error("1 " + statement.format(name)) == REFUSED
    assert kept(counted) == -41


def test_a_hot_journal_can_be_written_by_no_program(counted: Root) -> None:
    characters = "+".join(f"CHR$({each})" for each in HOT)
    assert counted.error(f'1 OPENW(1,"{STORE}-journal") : PRN#(1,{characters})') == REFUSED
    assert kept(counted) == -41
    counted.write(f"{STORE}-journal", HOT.ljust(512, b"\0"))  # what it would do, were the name not refused
    with Store(counted.folder / STORE) as erased:
        assert not erased.area("cpl.permanent", dict)


@pytest.mark.covers("cpl.ERASE")
@pytest.mark.parametrize("name", COMPANIONS)
def test_no_link_leads_to_the_memory(counted: Root, name: str) -> None:
    (counted.folder / "sub" / "up").symlink_to("..")
    (counted.folder / "alias").symlink_to(name)
    assert counted.error(f'1 OPENW(1,"sub/up/{name}")') == REFUSED
    assert counted.error('1 OPENW(1,"alias")') == REFUSED
    assert counted.error('1 I%=ERASE("sub/up/alias")') == REFUSED
    os.link(counted.folder / STORE, counted.folder / "sub" / "hard")
    assert counted.error('1 OPENW(1,"sub/hard")') == REFUSED
    assert kept(counted) == -41


def test_a_file_with_two_names_is_written_unless_it_is_the_memory(counted: Root) -> None:
    counted.write("P1", b"\x03\n")
    os.link(counted.folder / "P1", counted.folder / "P2")
    counted.run('1 OPENW(1,"P2") : PRN#(1,"OWN")')
    assert counted.read("P1") == b"OWN\n\x03\n"
    counted.run('1 OPENW(1,"cpl.stores") : OPENW(2,"mycpl.store") : OPENW(3,"cpl_store-wal")')


def test_a_name_that_cannot_be_one_is_refused(root: Root) -> None:
    (root.folder / "ring").symlink_to("ring")
    for name in ("ring", "ring/P1", f"{'D' * 300}/P1"):
        assert root.error(f'1 OPENW(1,"{name}")') == REFUSED


# ---------------------------------------------------------------------- one owner


def test_a_root_is_owned_by_one_control_at_a_time(counted: Root) -> None:
    before = (counted.folder / STORE).read_bytes()
    owner = RootOwner(counted.folder)
    owner.take()
    owner.take()
    for program in ("1 @7=@7+1", "N10 G1 X5 F500\nN20 M30\n"):
        with pytest.raises(UsageError, match=r"a control runs in .* already") as refused:
            counted.run(program)
        assert "wait for the end" in refused.value.hint
    with pytest.raises(UsageError, match="a control runs in"):
        Pnc(counted.folder, MILL)
    assert (counted.folder / STORE).read_bytes() == before
    owner.release()
    assert counted.run("1 @7=@7+1").variables["@7"] == -40


def test_a_device_owns_its_root_until_it_is_closed(counted: Root) -> None:
    pnc = Pnc(counted.folder, MILL)
    with pytest.raises(UsageError, match="a control runs in"):
        counted.run("1 @7=1")
    with pytest.raises(UsageError, match="a control runs in"):
        Pnc(counted.folder, MILL)
    pnc.close()
    assert kept(counted) == -41


def test_plain_programs_share_a_root_without_a_memory(root: Root) -> None:
    owner = RootOwner(root.folder)
    owner.take()
    root.run("N10 G1 X5 F500\nN20 M30\n")
    owner.release()
    assert list(root.folder.iterdir()) == []


def test_a_plain_program_owns_the_root_from_the_first_statement_that_it_calls(counted: Root) -> None:
    counted.write("P5", b"1 @7=@7*2\n")
    counted.run("N10 G1 X5 F500\nN20 P5\nN30 M30\n")
    assert kept(counted) == -82


def test_a_program_that_fails_lets_the_root_go(counted: Root) -> None:
    assert counted.error("1 @7=3 : A%=1.5").startswith("1: ")
    with pytest.raises(UsageError):
        counted.run("1 @7=4\nN2 G1 X1 F100\n", screen="main.npg")
    assert kept(counted) == 3


def test_the_owner_is_another_process_until_it_is_killed(counted: Root) -> None:
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(counted.folder)],
        env=ENVIRONMENT, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    )  # fmt: skip
    try:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"taken\n"
        with pytest.raises(UsageError, match="a control runs in"):
            counted.run("1 @7=5")
    finally:
        holder.kill()
        holder.communicate()
    assert kept(counted) == -41


def test_no_count_is_lost_by_programs_that_run_at_once(counted: Root) -> None:
    program = counted.folder / "count.npg"
    program.write_text("1 FOR I%=1 TO 300\n2 @7=@7+1\n3 NEXT\n")
    command = [sys.executable, "-m", "polycnc", "run", str(program), "--dialect", "bosch"]
    runs = [
        subprocess.Popen(command, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    told = [(each.communicate()[1], each.returncode) for each in runs]
    done = sum(code == 0 for _, code in told)
    assert done >= 1
    for text, code in told:
        assert code in (0, 2)
        assert code == 0 or "a control runs in" in text
    assert kept(counted) == 300 * done - 41
