"""Outputs: never over an input, through links, devices and pipes, whole or absent, nothing left of the killed."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from polycnc import outputs
from polycnc.cli._app import app
from polycnc.controllers.bosch.screen import Surface
from polycnc.errors import UsageError
from polycnc.runner import post_file, read_trace
from polycnc.servers.machines._log import Log

TOOL_PATH = (
    "UNITS/MM\nPARTNO A\nFROM/0,0,50\nRAPID\nGOTO/10,20,5\nFEDRAT/300\nGOTO/10,20,-3\nGOTO/17,23,-3\nFINI\n"
)
SAP = "program p;\nbegin\n writeln;\nend.\n"


def polycnc(*arguments: str | Path, status: int = 0) -> str:
    """Run a command in this process, hold it to an exit status and return what it printed."""
    done = CliRunner().invoke(app, [str(each) for each in arguments])
    assert done.exit_code == status, f"{done.output}\n{done.stderr}"
    return done.stderr if status else done.stdout


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("p.nc").write_text("G1 X3 Y2 F300\nX7\nM30\n")
    Path("p.cls").write_text(TOOL_PATH)
    Path("p.sap").write_text(SAP)
    return tmp_path


OVER_INPUTS = {
    "trace over program": ("run", "p.csv", "--trace", "p.csv"),
    "trace over machine": ("run", "p.nc", "-m", "m.csv", "--trace", "m.csv"),
    "trace over tools": ("run", "p.nc", "--tools", "inch=k.csv", "--trace", "k.csv"),
    "trace over keys": ("run", "p.nc", "--keys", "k.csv", "--trace", "./k.csv"),
    "trace over a link to it": ("run", "p.nc", "-m", "m.toml", "--trace", "link.csv"),
    "trace and plot in one": ("run", "p.nc", "--trace", "t.csv", "--screen", "t.csv"),
    "program over tool path": ("post", "p.cls", "-c", "din", "-o", "p.cls"),
    "program over control file": ("post", "p.cls", "-c", "c.toml", "-o", "c.toml"),
    "program over machine": ("post", "p.cls", "-c", "din", "-m", "m.toml", "--verify", "-o", "m.toml"),
    "compiled over source": ("sap", "compile", "p.sap", "-o", "p.sap"),
    "compiled over a hard link": ("sap", "compile", "p.sap", "-o", "hard.CNC"),
    "stock over stock": ("run", "p.nc", "--stock", "s.stl", "--save-stock", "./s.stl"),
    "stock over stock turned over": ("run", "p.nc", "--stock", "x-turned=s.stl", "--save-stock", "s.stl"),
    "stock over a machine's": ("run", "p.nc", "-m", "turned.toml", "--save-stock", "s.stl"),
    "stock over a fixture": ("run", "p.nc", "--stock", "auto", "--fixture", "s.stl", "--save-stock", "s.stl"),
    "page over machine": ("view", "p.nc", "-m", "m.html", "-o", "m.html"),
}


@pytest.mark.parametrize("case", OVER_INPUTS)
def test_no_output_goes_over_an_input(case: str, here: Path) -> None:
    Path("p.csv").write_text("G1 X3 F300\nM30\n")
    for name in ("m.csv", "m.toml", "m.html"):
        Path(name).write_text(polycnc("machine", "mill3", "--toml"))
    Path("turned.toml").write_text(f'{Path("m.toml").read_text()}\n[stock]\nform = "Y-turned=s.stl"\n')
    Path("s.stl").write_text("solid s\nendsolid s\n")
    Path("k.csv").write_text("ENTER\n")
    Path("c.toml").write_text(polycnc("post", "-c", "din", "--show-control"))
    Path("link.csv").symlink_to("m.toml")
    os.link("p.sap", "hard.CNC")
    before = {path.name: path.read_bytes() for path in here.iterdir()}
    refused = polycnc(*OVER_INPUTS[case], status=2)
    assert "cannot be written to" in refused
    assert {path.name: path.read_bytes() for path in here.iterdir()} == before


WRITERS = {
    "trace": (("run", "p.nc", "--trace"), "csv"),
    "screen": (("run", "s.osa", "--dialect", "bosch", "--screen"), "txt"),
    "program": (("post", "p.cls", "-c", "din", "-o"), "nc"),
    "compiled": (("sap", "compile", "p.sap", "-o"), "CNC"),
}


@pytest.mark.parametrize("case", WRITERS)
def test_outputs_go_through_links_and_pipes_and_keep_rights(case: str, here: Path) -> None:
    Path("s.osa").write_text('10 PRN#(0,"SEVEN")\nM30\n')
    command, suffix = WRITERS[case]
    folder = here / "elsewhere"
    folder.mkdir()
    (folder / f"real.{suffix}").write_text("old")
    (folder / f"real.{suffix}").chmod(0o640)
    link, plain, pipe = (here / f"{name}.{suffix}" for name in ("link", "plain", "pipe"))
    link.symlink_to(folder / f"real.{suffix}")
    polycnc(*command, plain)
    polycnc(*command, link)
    expected = plain.read_bytes()
    assert len(expected) > 20
    assert link.is_symlink()
    assert link.read_bytes() == expected
    assert (folder / f"real.{suffix}").stat().st_mode & 0o777 == 0o640
    os.mkfifo(pipe)
    got: list[bytes] = []
    reader = threading.Thread(target=lambda: got.append(pipe.read_bytes()))
    reader.start()
    polycnc(*command, pipe)
    reader.join(60)
    assert got == [expected]
    assert pipe.is_fifo()
    polycnc(*command, "/dev/null")
    assert not list(here.rglob(".*"))


def test_a_verified_program_may_go_into_a_pipe(here: Path) -> None:
    os.mkfifo("pipe.nc")
    got: list[bytes] = []
    reader = threading.Thread(target=lambda: got.append(Path("pipe.nc").read_bytes()))
    reader.start()
    result = post_file("p.cls", "din", "pipe.nc", verify=True)
    reader.join(60)
    assert result.verification is not None
    assert result.verification.ok
    assert got == [post_file("p.cls", "din").text.encode()]  # type: ignore[union-attr]


@pytest.mark.parametrize("name", [".", "", "no/such/x.nc", "a\0b.nc", "\ud800.nc", "x" * 300 + ".nc"])
def test_names_that_cannot_be_written_are_refused(name: str, here: Path) -> None:
    with pytest.raises(UsageError):
        post_file("p.cls", "din", name)
    with pytest.raises(UsageError):
        Surface().save(Path(name))


KILLED = """
import os, sys
from pathlib import Path
from polycnc.outputs import complete_or_absent
with complete_or_absent(Path(sys.argv[1])) as partial:
    partial.write_text("half")
    os.kill(os.getpid(), 9)
"""


def test_what_killed_runs_left_is_swept_and_what_others_write_is_not(here: Path) -> None:
    target = here / "t.csv"
    for _ in range(2):
        subprocess.run([sys.executable, "-c", KILLED, str(target)], check=False)
    mine = here / ".t.0123456789abcdeX.partial.csv"
    mine.write_text("of somebody else")
    with outputs.complete_or_absent(target) as first:
        assert [path.name for path in sorted(here.glob(".t.*"))] == sorted([mine.name, first.name])
        first.write_text("first")
        with outputs.complete_or_absent(target) as second:
            second.write_text("second")
        assert first.exists()  # swept neither by the second nor by its end
        assert target.read_text() == "second"
    assert target.read_text() == "first"
    assert [path.name for path in here.glob(".t.*")] == [mine.name]


def test_a_temporary_name_cannot_be_taken_before(here: Path) -> None:
    """Names differ from run to run, and a link that lies there already is not followed."""
    names = set()
    for _ in range(5):
        with outputs.complete_or_absent(here / "t.csv") as partial:
            names.add(partial.name)
            partial.write_text("x")
    assert len(names) == 5
    assert all(len(name) >= len(".t..partial.csv") + 16 for name in names)


@pytest.mark.parametrize("moment", ["_lock", "sweep", "_synchronize"])
def test_a_signal_at_any_moment_leaves_no_file(
    moment: str, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken_off(_: object) -> None:
        raise KeyboardInterrupt

    before = sorted(here.iterdir())
    monkeypatch.setattr(outputs, moment, broken_off)
    with (
        pytest.raises(KeyboardInterrupt),
        outputs.complete_or_absent(here / "new.txt", durable=True) as partial,
    ):
        partial.write_text("half of it")
    assert sorted(here.iterdir()) == before


def test_an_error_within_leaves_the_old_file(here: Path) -> None:
    target = here / "t.csv"
    target.write_text("old")

    def fail() -> None:
        with outputs.complete_or_absent(target) as partial:
            partial.write_text("new")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert target.read_text() == "old"
    assert sorted(path.name for path in here.iterdir()) == ["p.cls", "p.nc", "p.sap", "t.csv"]


DAMAGED = {
    "empty.csv": b"",
    "narrow.csv": b"t_s,block,feed_mm_s,X_mm\n1,2,3\n",
    "words.csv": b"t_s,block,feed_mm_s,X_mm\na,b,c,d\n",
    "nan.csv": b"t_s,block,feed_mm_s,X_mm\n1,nan,3,4\n",
    "far.csv": b"t_s,block,feed_mm_s,X_mm\n1,1e300,3,4\n",
    "bytes.csv": b"t_s,block,feed_mm_s,X_mm\n\xff\xfe\n",
    "double.csv": b"t_s,block,feed_mm_s,X_mm,X_mm\n1,2,3,4,5\n",
    "actual.csv": b"t_s,block,feed_mm_s,X_actual_mm\n1,2,3,4\n",
    "cut.csv": b"t_s,block,feed_mm_s,X_mm,Y_mm\n1,2,3,4,5\n1,2",
    "junk.npz": b"junk",
    "empty.npz": b"",
    "zip.npz": b"PK\x05\x06" + b"\0" * 18,
    "junk.parquet": b"junk",
    "empty.parquet": b"",
}


@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_trace_is_refused(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(DAMAGED[name])
    with pytest.raises(UsageError, match=name.replace(".", r"\.")) as refused:
        read_trace(tmp_path / name)
    assert refused.value.hint


def test_where_open_files_cannot_be_renamed_the_file_is_closed_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on Windows, where a rename or a removal of an open file is refused."""
    closed: list[int] = []
    renamed: list[int] = []
    close, replace = os.close, Path.replace

    def noted_close(descriptor: int) -> None:
        closed.append(descriptor)
        close(descriptor)

    def noted_replace(self: Path, target: Path) -> Path:
        renamed.append(len(closed))
        return replace(self, target)

    monkeypatch.setattr(outputs, "RENAMES_OPEN_FILES", False)
    monkeypatch.setattr(os, "close", noted_close)
    monkeypatch.setattr(Path, "replace", noted_replace)
    with outputs.complete_or_absent(tmp_path / "part.txt") as partial:
        partial.write_text("content")
    assert (tmp_path / "part.txt").read_text() == "content"
    assert (len(closed), renamed) == (1, [1])
    with pytest.raises(ZeroDivisionError), outputs.complete_or_absent(tmp_path / "part.txt") as partial:
        raise ZeroDivisionError
    assert len(closed) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["part.txt"]


def _fill(path: Path) -> None:
    if path != Path("/dev/full"):
        raise OSError(errno.ENOSPC, "No space left on device")
    path.write_bytes(b"x" * 99)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs the device of a full disk")
@pytest.mark.parametrize("special", [True, False])
def test_a_full_disk_is_told_with_the_file(special: bool, here: Path) -> None:
    path = Path("/dev/full") if special else here / "page.html"
    with pytest.raises(OSError, match="No space left") as caught, outputs.complete_or_absent(path) as partial:
        _fill(partial)
    assert caught.value.filename == str(path)
    assert special or list(here.glob("*page*")) == []


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs the device of a full disk")
def test_a_full_device_is_told_where_the_file_is_copied_to_it() -> None:
    path = Path("/dev/full")
    with pytest.raises(OSError, match="No space left") as caught:  # noqa: SIM117
        with outputs.complete_or_absent(path, rewritten=True) as partial:
            partial.write_bytes(b"x" * 99)
    assert caught.value.filename == "/dev/full"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs the device of a full disk")
def test_a_log_on_a_full_disk_is_told_with_the_file() -> None:
    log = Log(Path("/dev/full"))
    acts: list[Callable[[], None]] = [lambda: log.write("ready", port=8193), log.close]
    for act in acts:
        with pytest.raises(OSError, match="No space left") as caught:
            act()
        assert caught.value.filename == "/dev/full"
    log.close()
