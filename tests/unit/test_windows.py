"""What Windows does differently, as far as it can be simulated elsewhere: paths, console, signals, processes."""

from __future__ import annotations

import errno
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import polycnc
from polycnc.cli import _errors
from polycnc.errors import ConfigurationError, UsageError
from polycnc.runner.batches import Limits, find_programs
from polycnc.runner.batches import _child as child
from support.command import COMMAND, environment


@pytest.fixture
def windows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "win32")


def test_a_path_with_a_drive_is_a_machine_file_and_no_preset() -> None:
    with pytest.raises(ConfigurationError, match=r"cannot read 'C:\\shop\\mill\.toml'"):
        polycnc.load_machine(r"C:\shop\mill.toml")
    with pytest.raises(ConfigurationError, match=r"cannot read 'shop\\mill'"):
        polycnc.load_machine(r"shop\mill")


def test_an_error_in_a_file_on_a_drive_names_it_whole() -> None:
    from polycnc.nc import ProgramText

    (error,) = polycnc.check(ProgramText.from_text("G1 X10 F100\r\nG1 X Q7\r\n", r"C:\parts\a.nc"))
    assert str(error).splitlines()[0] == r"C:\parts\a.nc:2:4: 'X' has no number"


def test_programs_as_windows_writes_them(tmp_path: Path) -> None:
    """Endings in capitals, CR LF, a mark of UTF-8 at the beginning."""
    (tmp_path / "PART.NC").write_bytes(b"\xef\xbb\xbfG1 X10 F600\r\nG1 X17.5\r\nM30\r\n")
    (path,) = find_programs([tmp_path])
    assert polycnc.run(path).end_position_mm["X"] == 17.5


@pytest.mark.usefixtures("windows")
def test_a_reader_that_has_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """`polycnc run part.nc | more`, left with q: an invalid argument when the output is flushed."""
    closed: list[tuple[int, int]] = []
    monkeypatch.setattr("os.dup2", lambda *descriptors: closed.append(descriptors))

    def left() -> None:
        raise OSError(errno.EINVAL, "Invalid argument")

    with pytest.raises(SystemExit) as end:
        _errors.guarded(left)()
    assert (end.value.code, len(closed)) == (1, 1)


@pytest.mark.usefixtures("windows")
def test_a_file_with_a_wrong_name_is_an_error_still(capsys: pytest.CaptureFixture[str]) -> None:
    def wrong() -> None:
        raise OSError(errno.EINVAL, "Invalid argument", "a?.csv")

    with pytest.raises(SystemExit):
        _errors.guarded(wrong)()
    assert "a?.csv: Invalid argument" in capsys.readouterr().err


def test_ctrl_break_and_a_closed_console_end_as_termination_does(monkeypatch: pytest.MonkeyPatch) -> None:
    handled: dict[int, Any] = {}
    monkeypatch.setattr(signal, "SIGBREAK", 21, raising=False)
    monkeypatch.setattr(signal, "signal", handled.__setitem__)
    _errors.end_on_termination()
    with pytest.raises(SystemExit) as end:
        handled[21](21, None)
    assert end.value.code == 149
    assert signal.SIGTERM in handled


@pytest.mark.parametrize("encoding", ["cp437", "cp1252"])
def test_a_console_that_lacks_the_letters_of_a_name(tmp_path: Path, encoding: str) -> None:
    name = "деталь.nc"
    (tmp_path / name).write_text("G1 X10 F600\nG1 X Q\n", encoding="utf-8")
    done = subprocess.run(
        [*COMMAND, "check", name],
        cwd=tmp_path,
        env=environment(PYTHONUTF8="0", PYTHONIOENCODING=encoding),
        capture_output=True,
        timeout=240,
        check=False,
    )
    assert (done.returncode, b"Traceback" in done.stderr) == (1, False)
    assert b"??????.nc:2:4: 'X' has no number" in done.stdout


class _Started:
    stdin = stdout = None
    pid = 4711


@pytest.mark.usefixtures("windows")
def test_processes_of_a_batch_have_a_group_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C goes to a whole group there: only the batch itself is to get it."""
    given: dict[str, Any] = {}

    def start(command: list[str], **options: Any) -> _Started:
        given.update(options)
        return _Started()

    monkeypatch.setattr("subprocess.Popen", start)
    monkeypatch.setattr(child, "_read_all", lambda stream, answers: answers.put("ready"))
    started = child.Child(Limits())
    assert started._try_to_start() == ""
    assert started._said is not None
    started._said.close()
    assert given["creationflags"] == 0x200
    assert "start_new_session" not in given


@pytest.mark.usefixtures("windows")
def test_what_only_posix_has_is_not_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(signal, "alarm")
    monkeypatch.setitem(sys.modules, "resource", None)
    child._alarm(Limits())
    child._limit_memory(Limits())


def test_a_batch_keeps_keys_apart_by_whole_names() -> None:
    with pytest.raises(UsageError, match="no such file or folder"):
        find_programs([r"C:\parts\none.nc"])
