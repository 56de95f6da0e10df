"""Options and surroundings beyond reason: refused with a sentence, or harmless; never an internal error."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest

from polycnc.controllers.bosch import Pnc
from polycnc.errors import UsageError
from polycnc.runner import batches
from support.command import COMMAND, environment, polycnc, request_of

PROGRAM = "G1 X7 F612\nM30\n"
ODD = ("1e308", "1e-308", "inf", "-inf", "nan", "", "0", "-1", "9" * 400)
NUMBERS = {
    "timeout": ("batch", "a.nc", "--timeout"),
    "memory": ("batch", "a.nc", "--memory"),
    "jobs": ("batch", "a.nc", "--jobs"),
    "loop limit": ("run", "a.nc", "--loop-limit"),
    "resolution": ("run", "a.nc", "--stock", "box=-1,-1,-2,9,2,0", "--resolution"),
    "skip": ("run", "a.nc", "--skip"),
}
ENDED = (0, 1, 2)  # never 70


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "a.nc").write_text(PROGRAM)
    return tmp_path


@pytest.mark.long
@pytest.mark.parametrize("name", NUMBERS)
def test_an_odd_number_ends_no_command_in_an_internal_error(name: str, folder: Path) -> None:
    for number in ODD:
        command, *words = NUMBERS[name]
        done = subprocess.run(
            [*COMMAND, command, *words, number],
            cwd=folder,
            env=environment(),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode in ENDED, (number, done.stderr)
        assert "Traceback" not in done.stderr


REFUSED = {
    "pattern": (("batch", ".", "--pattern", ""), "'' is no pattern"),
    "dot": (("batch", ".", "--pattern", "."), "'.' is no pattern"),
    "report": (("batch", "a.nc", "-o", "r.csv", "--done", "r.csv"), "Name two files"),
    "done": (("batch", "a.nc", "--done", "a.nc"), "the command reads that file"),
    "keys": (("run", "a.nc", "--keys", "/dev/zero"), "more than 1,000,000 bytes of keys"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_meant_is_refused(case: str, folder: Path) -> None:
    words, said = REFUSED[case]
    if case == "report":
        (folder / "r.csv").write_text("of yesterday")
    assert said in " ".join(polycnc(*words, cwd=folder, status=2).stderr.split())
    assert (folder / "a.nc").read_text() == PROGRAM
    if case == "report":
        assert (folder / "r.csv").read_text() == "of yesterday"


def test_variables_of_the_compiler_and_of_notebooks_are_no_internal_errors(folder: Path) -> None:
    pytest.importorskip("matplotlib")
    said = polycnc("run", "a.nc", cwd=folder, status=2, NUMBA_NUM_THREADS="0").stderr
    assert "NUMBA_NUM_THREADS is '0'" in said
    polycnc("run", "a.nc", "--plot", "a.png", cwd=folder, MPLBACKEND="module://matplotlib_inline.none")
    assert (folder / "a.png").stat().st_size > 0


def test_standard_input_may_be_closed(folder: Path) -> None:
    command = ("sh", "-c", 'exec "$@" <&-', "sh", *COMMAND, "check", "-")
    done = subprocess.run(
        command, cwd=folder, env=environment(), capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 2, done.stderr
    assert "standard input is closed" in done.stderr


def test_a_full_disk_is_told_with_what_does_not_fit(folder: Path) -> None:
    if not Path("/dev/full").exists() or not hasattr(os, "fork"):
        pytest.skip("needs a device that is always full")
    for words in (("run", "a.nc"), ("serve", "--plain", "mill3", "--doors", "http=0")):
        said = folder / "said"
        outputs = {"outputs": ["/dev/full", str(said)]}
        status = request_of({"arguments": words, "folder": str(folder), **outputs})
        assert (status, said.read_text()) == (1, "error: the output: No space left on device\n"), words


OWN_FILES = ("wmhperm.dat", "anwperm.dat", "usrfep/anwperm.dat", "macoda.dat")


@pytest.mark.parametrize("to", ["itself", "/dev/null", "a folder"])
def test_a_link_that_leads_nowhere_in_a_root_is_a_sentence(to: str, tmp_path: Path) -> None:
    (tmp_path / "a folder").mkdir()
    for name in OWN_FILES:
        root = tmp_path / name.replace("/", "_")
        (root / name).parent.mkdir(parents=True)
        (root / name).symlink_to((root / name).name if to == "itself" else tmp_path / to)
        with pytest.raises(UsageError) as told:
            Pnc(root)
        assert str(told.value).startswith(f"{name}: ")
        assert "a link" in str(told.value)


def test_a_link_to_itself_is_no_file_for_a_program(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")
    for statement in (
        'OPENR(1,"loop")',
        'OPENW(1,"loop")',
        'ERASE("loop")',
        'FILEACCESS("loop")',
        "CALL loop",
    ):
        line = statement if statement.startswith(("OPEN", "CALL")) else f"A%={statement}"
        (tmp_path / "main.npg").write_text(f"10 {line}\nM30\n")
        with closing(Pnc(tmp_path)) as made:
            made.select_program("main.npg")
            made.cycle_start()
            made.advance(3)
            (alarm,) = made.control.alarms.active
            assert alarm.name == "program"
            assert "loop" in alarm.text or "INVALID FILE NAME" in alarm.text
    assert (tmp_path / "loop").is_symlink()


def test_a_cache_folder_that_cannot_be_is_no_error(folder: Path) -> None:
    done = polycnc("run", "a.nc", cwd=folder, POLYCNC_CACHE_DIR=f"{folder}/{5000 * 'y'}")
    assert "Traceback" not in done.stderr


INTERRUPTED = """
import os, signal, sys

class Interrupts:
    def find_spec(self, name, path=None, target=None):
        if name == "polycnc.cli._app":
            os.kill(os.getpid(), signal.SIGNAL)

sys.meta_path.insert(0, Interrupts())
from polycnc.cli import main
main()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no signals to send")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_a_signal_during_imports_shows_no_traceback(name: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED.replace("SIGNAL", name)],
        env=environment(),
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stderr) == (-int(signal.Signals[name]), "")


def test_a_batch_has_no_more_processes_than_runs(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from polycnc.runner.batches._workers import LocalWorkers

    asked: list[int] = []

    def workers(most: int) -> LocalWorkers:
        asked.append(most)
        return LocalWorkers(most)

    monkeypatch.setattr("polycnc.runner.batches._batch.LocalWorkers", workers)
    with batches.batch(folder / "a.nc", jobs=5000) as result:
        assert result.ok
    assert asked == [1]
    with pytest.raises(UsageError):
        batches.batch(folder / "a.nc", jobs=-1)
