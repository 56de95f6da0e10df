"""Batches of programs: everything once, in order, whatever hangs or breaks; reports, sweeps, what is done is kept."""

from __future__ import annotations

import base64
import csv
import gzip
import json
import os
import re
import signal
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar

import pytest

import polycnc
from polycnc.errors import UsageError
from polycnc.runner import batches
from polycnc.runner.batches import BatchResult, Limits, ProgramReport, _workers
from polycnc.runner.batches._child import Child
from polycnc.runner.batches._job import Answer, Job, Setup
from support.command import polycnc as command

GOOD = "G0 X{0} Y2\nG1 X{1} F{2}\nM30\n"
BAD = "G1 X7 F300\nG1 X9 Q\n"


class Kept:
    """A process that a batch leaves to the next one with the same limits, unless broken off: starts cost most."""

    free: ClassVar[list[tuple[Limits, Child]]] = []

    def __init__(self, limits: Limits) -> None:
        found = next((each for each in self.free if each[0] == limits), None)
        if found is not None:
            self.free.remove(found)
        self._limits = limits
        self._child = found[1] if found is not None else Child(limits)
        self._rests = True

    def answers(self, jobs: Sequence[Job], setups: Sequence[Setup]) -> Iterator[Answer]:
        """Run jobs as the child does."""
        self._rests = False
        yield from self._child.answers(jobs, setups)
        self._rests = True

    def close(self) -> None:
        """Leave the process to the next batch, or end it."""
        if self._rests and self._child.process_id is not None:
            self.free.append((self._limits, self._child))
        else:
            self._child.close()


@pytest.fixture(scope="module")
def kept() -> Iterator[None]:
    yield
    for _, child in Kept.free:
        child.close()
    Kept.free.clear()


@pytest.fixture(autouse=True)
def _few_starts(kept: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_workers, "Child", Kept)


def _store(folder: Path, count: int = 7) -> list[Path]:
    """Write programs into a folder and one under it; the third is broken."""
    (folder / "more").mkdir(parents=True, exist_ok=True)
    paths = []
    for number in range(count):
        path = folder / ("more" if number % 2 else ".") / f"p{number:04}.nc"
        path.write_text(BAD if number == 2 else GOOD.format(number, 30 + number, 300 + number))
        paths.append(path)
    return paths


def _reports(result: BatchResult) -> list[dict[str, Any]]:
    with result:
        return [report.as_dict() for report in result]


def _fill(folder: Path) -> Path:
    _store(folder)
    (folder / "notes.txt").write_text("not a program\n")
    (folder / ".hidden.nc").write_text(BAD)
    (folder / "O4711").write_text("G1 X3 F500\nM30\n")
    return folder


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return _fill(tmp_path / "parts")


@pytest.fixture(scope="module")
def detailed(kept: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, BatchResult]]:
    """Run a folder once, with everything that a report has, on two processes."""
    folder = _fill(tmp_path_factory.mktemp("detailed") / "parts")
    with polycnc.batch(folder, jobs=2, detail=True) as result:
        yield folder, result


def test_reports_are_those_of_single_runs(detailed: tuple[Path, BatchResult]) -> None:
    folder, result = detailed
    reports = [report.as_dict() for report in result]
    names = [str(Path(each["program"]).relative_to(folder).as_posix()) for each in reports]
    assert names == sorted(names, key=lambda name: (folder / name).as_posix())
    assert set(names) == {
        *(f"p000{n}.nc" for n in (0, 2, 4, 6)),
        *(f"more/p000{n}.nc" for n in (1, 3, 5)),
        "O4711",
    }
    for each in reports:
        single = polycnc.run(each["program"], check=False)
        assert each["time_s"] == single.time_s
        assert each["path_mm"] == single.path_mm
        assert each["extents"] == [(axis, *extent) for axis, extent in single.extents_mm.items()]
        assert each["tools"] == [(tool, t.cutting_s, t.rapid_s) for tool, t in single.tool_times.items()]
        assert each["errors"] == [str(alarm) for alarm in single.alarms]
        assert each["ok"] == single.ok == (Path(each["program"]).name != "p0002.nc")


def test_one_process_or_two_give_the_same_bits(detailed: tuple[Path, BatchResult]) -> None:
    folder, result = detailed
    one = _reports(polycnc.batch(folder, jobs=1, detail=True))
    assert one == [report.as_dict() for report in result]
    assert any(each["thumbnail"] for each in one)


def test_slowest_blocks_and_picture(tmp_path: Path) -> None:
    (tmp_path / "a.nc").write_text("G0 X5\nG1 X47 Y13 F600\nG4 X9.\nX5\nM98 P7\nM30\n" + "O7\nX9 F60\nM99\n")
    (report,) = _reports(polycnc.batch(tmp_path / "a.nc", "mill3", "fanuc", jobs=1, detail=True))
    assert report["errors"] == []
    line, text, time_s = report["slowest"][1]
    assert (line, text) == (2, "G1 X47 Y13 F600")
    assert time_s == pytest.approx((42.0**2 + 13.0**2) ** 0.5 / 10.0, abs=0.01)
    assert sum(each[2] for each in report["slowest"]) == pytest.approx(report["time_s"], abs=0.001)
    cuts, rapids = report["thumbnail"]
    assert re.fullmatch(r"(M[-\d. ]+(L[-\d. ]+)+)+", cuts)
    assert rapids.startswith("M")


def test_check_only_finds_what_check_finds(folder: Path) -> None:
    reports = _reports(polycnc.batch(folder, jobs=1, check_only=True))
    broken = [each for each in reports if not each["ok"]]
    assert [Path(each["program"]).name for each in broken] == ["p0002.nc"]
    assert broken[0]["errors"] == [str(error) for error in polycnc.check(broken[0]["program"])]
    assert broken[0]["time_s"] is None


def test_what_is_done_is_not_done_again(folder: Path, tmp_path: Path) -> None:
    done = tmp_path / "kept.done"
    with polycnc.batch(folder, jobs=1, done=done) as first:
        before = [report.as_dict() for report in first]
        assert (first.counts.total, first.counts.ok, first.counts.earlier) == (8, 7, 0)
    with polycnc.batch(folder, jobs=1, done=done) as second:
        assert [report.as_dict() for report in second] == before
        assert (second.counts.ok, second.counts.earlier, second.ok) == (7, 8, False)
    (folder / "p0004.nc").write_text("G1 X99 F900\n")
    with polycnc.batch(folder, jobs=1, done=done) as third:
        assert third.counts.earlier == 7
        assert [report.extents[0] for report in third if report.program.endswith("p0004.nc")] == [
            ("X", 0.0, 99.0)
        ]
    with polycnc.batch(folder, "mill5", jobs=1, done=done) as other:
        assert other.counts.earlier == 0
    with polycnc.batch(folder, jobs=1, done=done, check_only=True) as checked:
        assert checked.counts.earlier == 0


def test_a_batch_that_is_broken_off_goes_on(folder: Path, tmp_path: Path) -> None:
    done = tmp_path / "kept.done"
    seen: list[int] = []

    def stop(number: int, total: int) -> None:
        seen.append(number)
        if number == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        polycnc.batch(folder, jobs=1, done=done, progress=stop)
    assert seen == [1, 2, 3]
    with polycnc.batch(folder, jobs=1, done=done) as rest:
        assert rest.counts.earlier == 3
        assert len({report.program for report in rest}) == 8


def test_a_program_that_hangs_is_stopped_alone(folder: Path, tmp_path: Path) -> None:
    """A loop without end in a macro: its process is ended, the rest is run by another."""
    (folder / "endless.tap").write_text("#1=0\nWHILE [1 EQ 1] DO1\n#1=#1+1\nEND1\nM30\n")
    done = tmp_path / "kept.done"
    reports = _reports(polycnc.batch(folder, jobs=1, timeout_s=1.5, done=done))
    stopped = [each for each in reports if each["status"] == "time-out"]
    assert [Path(each["program"]).name for each in stopped] == ["endless.tap"]
    assert stopped[0]["errors"] == [f"{folder / 'endless.tap'}: stopped after 1.5 s"]
    assert sum(each["ok"] for each in reports) == 7
    with polycnc.batch(folder, jobs=1, timeout_s=0.2, done=done) as again:
        assert again.counts.earlier == 8  # the one that hung is tried again


@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited on Linux")
def test_a_program_that_wants_all_memory_is_stopped_alone(tmp_path: Path) -> None:
    (tmp_path / "a.nc").write_text("G1 X3 F500\nM30\n")
    (tmp_path / "big.nc").write_text("G1 X1 F900\nX2\n" * 400_000)
    (tmp_path / "z.nc").write_text("G1 X4 F500\nM30\n")
    reports = _reports(polycnc.batch(tmp_path, jobs=1, memory_mb=48.0))
    assert [each["status"] for each in reports] == ["ok", "memory", "ok"]
    assert "needs more than 48 MB of memory" in reports[1]["errors"][0]


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
def test_a_process_that_is_killed_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_workers, "Child", Child)
    for _, child in Kept.free:
        child.close()
    Kept.free.clear()
    paths = _store(tmp_path / "parts", 20)
    killed: list[int] = []

    def kill(seen: int, total: int) -> None:
        if seen >= 5 and not killed:
            killed.append(_kill_a_child())

    reports = _reports(polycnc.batch(tmp_path / "parts", jobs=2, progress=kill))
    assert killed
    assert len(reports) == len(paths)
    assert len({each["program"] for each in reports}) == len(paths)
    assert [each["status"] for each in reports].count("ok") == len(paths) - 1


def _kill_a_child() -> int:
    """Kill one of the processes that run programs, as the system does when memory is short."""
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = status.read_text().rpartition(")")[2].split()
            command_line = (status.parent / "cmdline").read_bytes()
        except OSError:
            continue
        if int(fields[1]) == os.getpid() and b"serve_jobs" in command_line:
            os.kill(int(status.parent.name), signal.SIGKILL)
            return int(status.parent.name)
    raise AssertionError("no process runs programs")


def test_a_language_runs_on_a_copy_of_its_folder(tmp_path: Path) -> None:
    """A CPL program that writes a file: twice the same report, and nothing is written beside the program."""
    (tmp_path / "log.npg").write_text(
        '10 OPENW(1,"out.txt",500,"A file") : REWRITE(1)\n20 PRN#(1,"hello")\n30 CLOSE(1)\n'
        "N10 G1 X17 F600\nM30\n"
    )
    before = sorted(path.name for path in tmp_path.iterdir())
    reports = [_reports(polycnc.batch(tmp_path / "log.npg", jobs=1)) for _ in range(2)]
    assert reports[0] == reports[1]
    assert reports[0][0]["errors"] == []
    assert reports[0][0]["extents"][0] == ("X", 0.0, 17.0)
    assert sorted(path.name for path in tmp_path.iterdir()) == before


def test_sweeps(tmp_path: Path) -> None:
    (tmp_path / "a.nc").write_text("G1 X60 F900\nM30\n")
    sweep = {"override": (50, 100, 200), "machine": ("mill3", "mill5")}
    reports = _reports(polycnc.batch(tmp_path, jobs=1, sweep=sweep))
    assert [(each["machine"], each["override_percent"]) for each in reports] == [
        (machine, override) for machine in ("mill3", "mill5") for override in (50.0, 100.0, 200.0)
    ]
    assert reports[0]["time_s"] == pytest.approx(8.0, abs=0.02)
    assert reports[1]["time_s"] == pytest.approx(4.0, abs=0.02)
    assert reports[2]["time_s"] == pytest.approx(2.0, abs=0.02)
    corner = tmp_path / "a.nc"
    corner.write_text("G1 X60 F9000\nY60\nM30\n")
    times = [
        each["time_s"] for each in _reports(polycnc.batch(corner, jobs=1, sweep={"tolerance": (0, 0.5)}))
    ]
    assert times[1] < times[0]


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("override=80:120:5", (80.0, 85.0, 90.0, 95.0, 100.0, 105.0, 110.0, 115.0, 120.0)),
        ("override=90:80:-5", (90.0, 85.0, 80.0)),
        ("tolerance=0:0.3:0.1", (0.0, 0.1, 0.2, 0.3)),
        ("tolerance=0.02", (0.02,)),
        ("machine=mill3, lathe2", ("mill3", "lathe2")),
    ],
)
def test_sweeps_are_written_like_this(text: str, values: tuple[object, ...]) -> None:
    assert batches.parse_sweep(text) == (text.partition("=")[0], values)


@pytest.mark.parametrize(
    "text",
    ["override", "speed=3", "override=", "override=5:1:1", "override=1:9:0", "override=1:2", "override=a",
     "override=nan", "override=1:2:3:4", "machine=", "override=0:1e9:1e-3"],
)  # fmt: skip
def test_what_is_no_sweep_is_refused(text: str) -> None:
    with pytest.raises(UsageError):
        batches.parse_sweep(text)


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"sweep": {"override": (0,)}}, "an override of 0 %"),
        ({"sweep": {"override": (201,)}}, "an override of 201 %"),
        ({"sweep": {"tolerance": (-1,)}}, "a path tolerance of -1 mm"),
        ({"sweep": {"feed": (1,)}}, "'feed' cannot be swept"),
        ({"sweep": {"machine": ("mill3",)}, "machine": "mill5"}, "a machine and a sweep over machines"),
        ({"machine": "mill9"}, "no machine 'mill9'"),
        ({"dialect": "klingon"}, "no dialect 'klingon'"),
        ({"jobs": -1}, "-1 processes"),
        ({"timeout_s": float("nan")}, "a time-out of nan"),
        ({"root": "nowhere"}, "no such folder: nowhere"),
        ({"patterns": ("*.xyz",)}, "there is no program in"),
    ],
)
def test_refusals(folder: Path, arguments: dict[str, Any], match: str) -> None:
    with pytest.raises(UsageError, match=match):
        polycnc.batch(folder, **arguments)


def test_a_program_that_cannot_be_read_is_one_error(folder: Path) -> None:
    (folder / "gone.nc").symlink_to(folder / "nowhere.nc")
    (folder / "wide.nc").write_bytes("G1 X5 F100\n".encode("utf-16"))
    paths = [*sorted(folder.glob("p*.nc")), folder / "wide.nc"]
    reports = _reports(polycnc.batch(paths, jobs=1))
    assert "UTF-16" in reports[-1]["errors"][0]
    assert [each["status"] for each in reports] == ["ok", "error", "ok", "ok", "error"]


def test_another_file_is_not_taken_for_what_is_done(folder: Path, tmp_path: Path) -> None:
    other = tmp_path / "parts.db"
    other.write_bytes(b"my own data, much of it" * 100)
    with pytest.raises(UsageError, match="cannot keep what is done"):
        polycnc.batch(folder, jobs=1, done=other)
    assert other.read_bytes() == b"my own data, much of it" * 100


def test_tables(detailed: tuple[Path, BatchResult], tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    _, result = detailed
    result.save(tmp_path / "out.csv")
    result.save(tmp_path / "out.parquet")
    reports = list(result)
    with pytest.raises(UsageError, match="cannot be written"):
        result.save(tmp_path / "out.pdf")
    table = parquet.read_table(tmp_path / "out.parquet")
    assert table.column_names[:7] == [
        "program",
        "ok",
        "time_s",
        "cutting_time_s",
        "path_mm",
        "errors",
        "messages",
    ]
    assert [row["time_s"] for row in table.to_pylist()] == [report.time_s for report in reports]
    assert [row["errors"] for row in table.to_pylist()] == [report.errors for report in reports]
    first = table.to_pylist()[1]
    assert (first["tools"][0]["cutting_time_s"], first["slowest"][0]["line"]) == (
        reports[1].tools[0][1],
        reports[1].slowest[0][0],
    )
    with (tmp_path / "out.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["path_mm"]) for row in rows] == [report.path_mm for report in reports]
    assert [row["ok"] for row in rows].count("false") == 1


def test_the_page_holds_every_report_and_loads_nothing(
    detailed: tuple[Path, BatchResult], tmp_path: Path
) -> None:
    _, result = detailed
    page = result.save(tmp_path / "out.html").read_text("utf-8")
    reports = list(result)
    assert "http" not in page.replace("http-equiv", "").replace("http://www.w3.org/2000/svg", "")
    found = re.search(r'id="data">([^<]*)<', page)
    assert found is not None
    rows = json.loads(gzip.decompress(base64.b64decode(found[1])))
    assert [row["program"] for row in rows] == [report.program for report in reports]
    assert [row["errors"] for row in rows] == [report.errors for report in reports]
    assert rows[1]["slowest"][0][2] == reports[1].slowest[0][2]


def test_the_command(folder: Path, tmp_path: Path) -> None:
    done = command("batch", "parts", "-o", "out.html", "--jobs", "1", cwd=tmp_path, status=1)
    assert "8 runs, 1 with errors\n" in done.stdout
    assert "p0002.nc:2:7: 'Q' has no number\n    G1 X9 Q\n" in done.stdout
    again = command("batch", "parts", "-o", "out.html", "--jobs", "1", cwd=tmp_path, status=1)
    assert "done before and unchanged: 8\n" in again.stdout
    (folder / "p0002.nc").unlink()
    swept = command(
        "batch", "parts/O4711", "--sweep", "override=80:120:20", "--json", "-j", "1", cwd=tmp_path
    )
    data = json.loads(swept.stdout)
    assert [each["override_percent"] for each in data["reports"]] == [80.0, 100.0, 120.0]
    over = command("batch", "parts", "-o", "parts/O4711", cwd=tmp_path, status=2)
    assert "error: a report cannot be written" in over.stderr
    missing = command("batch", "elsewhere", cwd=tmp_path, status=2)
    assert "no such file or folder: elsewhere" in missing.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
def test_ctrl_c_leaves_no_process_behind(tmp_path: Path) -> None:
    import subprocess

    from support.command import COMMAND, environment

    (tmp_path / "endless.tap").write_text("WHILE [1 EQ 1] DO1\n#1=#1+1\nEND1\n")
    running = subprocess.Popen(
        [*COMMAND, "batch", "endless.tap", "-j", "1"],
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    child = _child_of(running.pid)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=120)
    assert running.returncode == 130
    assert said.decode().strip().endswith("error: interrupted")
    assert not Path(f"/proc/{child}").exists()


def _child_of(parent: int) -> int:
    """Wait until a process has a child, and return its number."""
    ends_s = time.monotonic() + 120.0
    gate = threading.Event()
    while time.monotonic() < ends_s:
        for status in Path("/proc").glob("[0-9]*/stat"):
            try:
                fields = status.read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if int(fields[1]) == parent:
                return int(status.parent.name)
        gate.wait(0.05)
    raise AssertionError("no process was started")


def test_reports_are_plain_data() -> None:
    report = ProgramReport("a.nc", "mill3", tools=[(4, 1.5, 0.25)])
    assert json.loads(json.dumps(report.as_dict()))["tools"] == [[4, 1.5, 0.25]]
