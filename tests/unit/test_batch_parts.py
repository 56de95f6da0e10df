"""The parts of a batch, each by itself and in this process: jobs, reports, sweeps, what is kept, pictures."""

from __future__ import annotations

import base64
import csv
import gzip
import io
import json
import re
import signal
import sqlite3
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import polycnc
from polycnc.errors import UsageError
from polycnc.machine import MachineConfig, StockConfig
from polycnc.nc import ProgramText
from polycnc.runner import Trace, batches
from polycnc.runner._blocks import execution_by_lines
from polycnc.runner.batches import Limits, ProgramReport, _batch, _child, _job, _report, _workers, _write
from polycnc.runner.batches._job import Answer, Job, Setup, answer_of, blank_report, report_in, report_of
from polycnc.runner.batches._store import ResultStore, folder_digest, forget_done, key_of, version_digest
from polycnc.runner.batches._sweep import parse_sweep, setups_of
from polycnc.runner.batches._thumbnail import picture, thumbnail
from polycnc.runner.view import Track, TrackCollector

MILL = polycnc.load_machine("mill3")


def _job_of(text: str, name: str = "a.nc") -> Job:
    return Job("key", name, text.encode(), 0)


# --- reports


def test_a_report_says_what_the_run_says() -> None:
    text = "G0 X5 Y1\nG4 F0.25\nG1 X17 F600\nM0\nG1 Y9 F300\nM0\nG1 X2 Q\n"
    report = report_of(_job_of(text), Setup(MILL))
    run = polycnc.run(ProgramText.from_text(text, "a.nc"), MILL, check=False)
    for name in (
        "time_s", "cutting_time_s", "rapid_time_s", "waiting_time_s", "path_mm", "cutting_path_mm",
        "top_feed_mm_min", "blocks", "cycles", "dialect", "machine",
    ):  # fmt: skip
        assert getattr(report, name) == getattr(run, name) != 0, name
    assert (report.status, report.ok) == ("error", False)
    assert report.errors == [str(run.alarms[0])]
    assert report.messages[0] == "line 4: M0: program stop, passed without stopping (2 times)"
    assert not any(each.startswith("line 0") for each in report.messages)
    assert "M0" not in report_of(_job_of("G1 X1 F9000\nM0\n"), Setup(MILL)).messages[0].partition("(")[2]
    assert report_in(answer_of(report).text) == report


TURNED = "O0001\nT0101\nG97 S500 M3\nG0 X40. Z2.\nG1 Z-20. F0.2\nG0 X60. Z10.\nM30\n"


@pytest.mark.parametrize("named", [None, "mill3"])
@pytest.mark.parametrize("text", [TURNED, "G0 X5 Y1\nG1 X17 F600\n"])
def test_without_a_machine_a_program_runs_where_run_has_it(text: str, named: str | None) -> None:
    (setup,) = setups_of(named, None, {"tolerance": (0.05,)}, check_only=False, detail=True)
    report = report_of(_job_of(text), setup)
    run = polycnc.run(ProgramText.from_text(text, "a.nc"), named, check=False)
    assert (report.machine, report.time_s, report.status) == (
        run.machine,
        run.time_s,
        "ok" if run.ok else "error",
    )
    assert report.tolerance_mm == 0.05
    assert blank_report(_job_of(text), setup, "lost").machine == run.machine


def test_of_very_many_errors_the_first_are_told() -> None:
    setup = Setup(MILL, check_only=True)
    most = report_of(_job_of("G1 Q\n" * 50), setup)
    assert (len(most.errors), most.status) == (50, "error")
    more = report_of(_job_of("G1 Q\n" * 61), setup)
    assert more.errors[:50] == most.errors
    assert more.errors[50:] == ["and 11 more errors"]


def test_a_report_of_nothing_names_the_setup() -> None:
    setups = setups_of(None, None, {"tolerance": (0.25,), "override": (70,)}, check_only=False, detail=False)
    report = blank_report(_job_of(""), setups[0], "time-out", "late")
    assert (report.override_percent, report.tolerance_mm, report.status) == (70.0, 0.25, "time-out")
    assert (report.errors, report.time_s) == (["late"], None)
    path = MILL.path.model_copy(update={"path_tolerance_mm": "free"})
    free = blank_report(_job_of(""), Setup(MILL.model_copy(update={"path": path})), "lost")
    assert free.tolerance_mm is None


def test_what_fails_on_a_program_is_in_its_report(monkeypatch: pytest.MonkeyPatch) -> None:
    errors = iter((ZeroDivisionError("by nothing"), UsageError("not so"), MemoryError()))

    def fail(*_: object, **__: object) -> None:
        raise next(errors)

    monkeypatch.setattr(_job, "run_program", fail)
    first, second = (report_of(_job_of("G0 X1\n"), Setup(MILL)) for _ in range(2))
    assert first.errors == ["polycnc failed on it: ZeroDivisionError: by nothing"]
    assert (second.errors, second.status) == (["not so"], "error")
    with pytest.raises(MemoryError):
        report_of(_job_of("G0 X1\n"), Setup(MILL))


def test_the_five_slowest_blocks_the_slowest_first() -> None:
    lines = [f"G1 X{x} F600" for x in (10, 15, 45, 47, 67, 69, 84)]  # 10, 5, 30, 2, 20, 2, 15 mm
    text = "\n".join([lines[0] + " (" + "c" * 200 + ")", *lines[1:], "M30"])
    report = report_of(_job_of(text), Setup(MILL, detail=True))
    assert [row[0] for row in report.slowest] == [3, 5, 7, 1, 2]
    assert [row[2] for row in report.slowest] == pytest.approx([3.0, 2.0, 1.5, 1.0, 0.5], abs=0.01)
    assert report.slowest[3][1] == (lines[0] + " (" + "c" * 200)[:120]
    assert report_of(_job_of("M30\n"), Setup(MILL, detail=True)).slowest == []


# --- pictures


def _track(text: str, machine: MachineConfig = MILL) -> Track:
    trace = polycnc.run(text, machine, trace=True).trace
    execution = trace.execution or execution_by_lines(trace.block)
    collector = TrackCollector(trace.units)
    collector.add_trace(trace, execution)
    return collector.track(execution)


def test_a_path_fills_its_box() -> None:
    """90 by 58 mm fit into 96 by 64 with an edge of 3: a millimetre is a unit, and Y goes up."""
    text = "G1 X90 F6000\nY58\nX0\nY0\nG0 X30 Y20\nM30\n"
    assert thumbnail(_track(text), MILL) == (
        "M3.0 61.0L93.0 61.0L93.0 3.0L3.0 3.0L3.0 61.0",
        "M3.0 61.0L33.0 41.0",
    )
    half = "G1 X45 F6000\nG0 Y500\n"  # 2 units to a millimetre; what leaves the box at rapid is cut off
    assert thumbnail(_track(half), MILL) == ("M3.0 32.0L93.0 32.0", "M93.0 32.0L93.0 -96.0")
    assert thumbnail(_track("G0 X90\n"), MILL) == ("", "M3.0 32.0L93.0 32.0")
    assert thumbnail(_track("G1 Z5 F900\n"), MILL) is None
    assert thumbnail(_track("M30\n"), MILL) is None


def test_a_picture_shows_tools_start_and_end() -> None:
    text = "T4 M6\nG1 X90 F6000\nT9 M6\nY58\nG0 X30\nM30\n"
    svg = picture(_track(text), MILL, 320)
    assert svg.startswith('<svg viewBox="0 0 96 64" width="320"')
    cuts = re.findall(r'<path d="([^"]*)" fill="none" stroke="(#\w+)" stroke-width="0.8"><title>(\w+)<', svg)
    assert cuts == [("M3.0 61.0L93.0 61.0", "#0072b2", "T4"), ("M93.0 61.0L93.0 3.0", "#d55e00", "T9")]
    assert '<path d="M93.0 3.0L33.0 3.0" fill="none" stroke="#8a949d"' in svg
    assert '<circle cx="3.0" cy="61.0" r="1.3"' in svg
    assert '<path d="M32.1 2.1l1.8 1.8m0 -1.8l-1.8 1.8"' in svg
    assert "H96" not in svg
    far = picture(_track("G0 X-50 Y-90\nG1 X40 F6000\nG0 X500 Y900\n"), MILL, 20)
    assert '<circle cx="48.0"' not in far
    assert re.search(r'<path d="M93\.6 0\.6l1\.8', far)  # an end outside is shown at the edge
    assert picture(_track("M30\n"), MILL, 20) == ""


def test_a_lathe_is_drawn_in_profile_with_its_axis() -> None:
    lathe = polycnc.load_machine("lathe2")
    svg = picture(_track("G0 X58 Z90\nG1 Z0 F6000\n", lathe), lathe, 96)
    radius = 2.0 if getattr(lathe.axes[0], "diameter", False) else 1.0
    axis = re.search(r'd="M0 ([\d.]+)H96"', svg)
    assert axis is not None
    assert float(axis[1]) == pytest.approx(32.0 + 58.0 / radius / 2.0, abs=0.1)
    cuts, _ = thumbnail(_track("G0 X58 Z90\nG1 Z0 F6000\n", lathe), lathe) or ("", "")
    y = 32.0 - 58.0 / radius / 2.0
    assert cuts == f"M93.0 {y:.1f}L3.0 {y:.1f}"  # Z to the right, X up


def test_a_picture_of_very_much_is_small() -> None:
    """A zigzag of 450 corners: one of a unit is thinned away, one of 20 units is cut off after 400 points."""
    rows = 450
    for height, most in ((1.0, 1), (20.0, 399)):
        zigzag = np.column_stack((np.arange(rows) * 0.2, height * (np.arange(rows) % 2), np.zeros(rows)))
        trace = Trace(
            ("X", "Y", "Z"), ("mm", "mm", "mm"), np.arange(1, rows + 1, dtype=np.float64) * 0.001,
            np.ones(rows, np.int64), np.zeros(rows), np.zeros(rows, np.bool_), zigzag,
        )  # fmt: skip
        collector = TrackCollector(trace.units)
        collector.add_trace(trace, execution_by_lines(trace.block))
        cuts, _ = thumbnail(collector.track(execution_by_lines(trace.block)), MILL) or ("", "")
        assert cuts.count("L") == most


# --- sweeps


def test_sweeps_combine_in_their_order() -> None:
    sweep: dict[str, Sequence[Any]] = {
        "override": (1, 200),
        "tolerance": (0, 0.5),
        "machine": ("mill3", "mill5"),
    }
    setups = setups_of(None, "fanuc", sweep, check_only=False, detail=True)
    found = [(s.machine.name, s.machine.path.path_tolerance_mm, s.override_percent) for s in setups]
    assert found == [(m, t, o) for m in ("mill3", "mill5") for t in (0.0, 0.5) for o in (1.0, 200.0)]
    assert all(each.detail and not each.check_only for each in setups)
    (plain,) = setups_of("mill5", None, {}, check_only=True, detail=False)
    assert (plain.check_only, plain.detail, plain.override_percent, plain.dialect) == (
        True,
        False,
        100.0,
        None,
    )
    for name, value in (
        ("override", 0.99),
        ("override", 200.1),
        ("override", "5"),
        ("tolerance", float("inf")),
    ):
        with pytest.raises(UsageError, match=r"an override of|a path tolerance of"):
            setups_of(None, None, {name: (value,)}, check_only=False, detail=False)


def test_ranges_of_a_sweep_end_where_they_say() -> None:
    assert len(parse_sweep("override=1:10000:1")[1]) == 10_000
    with pytest.raises(UsageError, match="a sweep of 10,001 values"):
        parse_sweep("override=0:10000:1")
    assert parse_sweep("tolerance=0.1:0.7:0.2")[1] == (0.1, 0.3, 0.5, 0.7)
    assert parse_sweep("override=80:99:5")[1] == (80.0, 85.0, 90.0, 95.0)
    assert parse_sweep("override=7:7:1")[1] == (7.0,)
    assert parse_sweep(" override = 5, 9") == ("override", (5.0, 9.0))


# --- chunks


class _Here:
    """Workers that answer in this process; they keep the chunks that they got."""

    def __init__(self, status: str = "ok") -> None:
        self.chunks: list[list[Job]] = []
        self._status = status

    def run(
        self, chunks: Iterator[list[Job]], setups: Sequence[Setup], limits: Limits
    ) -> Iterator[list[tuple[str, Answer]]]:
        for chunk in chunks:
            self.chunks.append(chunk)
            yield [(job.key, answer_of(blank_report(job, setups[job.setup], self._status))) for job in chunk]


def _programs(folder: Path, count: int, content: str = "G1 X{} F300\n") -> list[Path]:
    paths = [folder / f"p{number:05}.nc" for number in range(count)]
    for number, path in enumerate(paths):
        path.write_text(content.format(number))
    return paths


def _run(programs: list[Path], store: ResultStore, workers: _Here, **given: Any) -> _batch._Run:
    setups = given.get("setups", [Setup(MILL)])
    run = _batch._Run(programs, setups, store, given.get("root"), given.get("progress"))
    run.to_end(workers, Limits())
    return run


@pytest.mark.parametrize(("count", "sizes"), [(127, {1}), (128, {2}), (1100, {16, 12})])
def test_many_small_programs_travel_together(tmp_path: Path, count: int, sizes: set[int]) -> None:
    workers, seen = _Here(), list[tuple[int, int]]()
    store = ResultStore(None)
    run = _run(_programs(tmp_path, count), store, workers, progress=lambda *at: seen.append(at))
    assert {len(chunk) for chunk in workers.chunks} == sizes
    assert run.counts() == batches.BatchCounts(count, count, 0)
    assert seen[-1] == (count, count)
    assert len(set(run.keys)) == count
    result = batches.BatchResult(store, run.keys, run.counts())
    assert (len(result), result.ok) == (count, True)
    assert result[3].program == str(tmp_path / "p00003.nc")
    assert next(iter(result)).program == str(tmp_path / "p00000.nc")


def test_large_programs_travel_alone(tmp_path: Path) -> None:
    text = "G1 X5 F300\n"
    for comment, together, pairs in (
        ((1 << 16) - 14, 1, 20),
        ((1 << 16) - 15, 2, 70),
    ):  # 64 KiB, and a byte less
        content = "(" + "c" * comment + ")\n" + text
        workers = _Here()
        _run(_programs(tmp_path, 2, content) * pairs, ResultStore(None), workers)
        assert {len(chunk) for chunk in workers.chunks} == {together}


def test_what_is_kept_is_what_depends_on_the_program_alone(tmp_path: Path) -> None:
    programs = _programs(tmp_path, 3)
    for status, earlier, ok in (
        ("ok", 3, 3),
        ("error", 3, 0),
        ("time-out", 0, 3),
        ("memory", 0, 3),
        ("lost", 0, 3),
    ):
        store = ResultStore(tmp_path / f"{status}.done")
        first = _run(programs, store, _Here(status)).counts()
        assert (first.total, first.earlier, first.ok) == (3, 0, 3 if status == "ok" else 0)
        again = _run(programs, store, _Here()).counts()
        assert (again.earlier, again.ok) == (earlier, ok)
        store.close()


def test_what_cannot_be_read_is_reported_and_not_run(tmp_path: Path) -> None:
    programs = [tmp_path / "gone.nc", *_programs(tmp_path, 1)]
    store, workers, seen = ResultStore(None), _Here(), list[tuple[int, int]]()
    run = _run(programs, store, workers, progress=lambda *at: seen.append(at))
    assert [[Path(job.name).name for job in chunk] for chunk in workers.chunks] == [["p00000.nc"]]
    assert run.counts() == batches.BatchCounts(2, 1, 0)
    assert seen == [(1, 2), (2, 2)]
    report = store.report(run.keys[0])
    assert report.status == "error"
    assert report.errors == [f"cannot read {programs[0]}: No such file or directory"]


def test_a_folder_that_is_too_large_is_not_copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_batch, "_MOST_FILES", 3)
    program = tmp_path / "part.npg"
    program.write_text("N10 G1 X17 F600\nM30\n")
    for name in ("a.txt", "b.txt"):
        (tmp_path / name).write_text(name)
    workers, store = _Here(), ResultStore(None)
    before = _run([program], store, workers).keys
    ((job,),) = workers.chunks
    assert job.root == str(tmp_path.resolve())
    (tmp_path / "b.txt").write_text("another")
    assert _run([program], store, _Here()).keys != before
    (tmp_path / "c.txt").write_text("one too many")
    refused = _Here()
    (key,) = _run([program], store, refused).keys
    assert refused.chunks == []
    assert "is too large to run it on a copy. Name the folder" in store.report(key).errors[0]
    (tmp_path / "own").mkdir()
    named = _Here()
    _run([program], store, named, root=tmp_path / "own")
    assert [job.root for (job,) in named.chunks] == [str((tmp_path / "own").resolve())]


# --- what is kept


def test_keys_tell_parts_apart() -> None:
    assert key_of(b"ab", b"c") != key_of(b"a", b"bc")
    assert key_of(b"ab") == key_of(b"ab") != key_of(b"ab", b"")
    assert len(key_of()) == 40


def test_a_digest_of_a_folder_is_of_names_and_contents(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "a").write_bytes(b"1")
    found = [folder_digest(tmp_path)]
    (tmp_path / "sub" / "a").write_bytes(b"2")
    found.append(folder_digest(tmp_path))
    (tmp_path / "sub" / "a").rename(tmp_path / "sub" / "b")
    found.append(folder_digest(tmp_path))
    (tmp_path / "sub" / "b").rename(tmp_path / "b")
    found.append(folder_digest(tmp_path))
    assert len(set(found)) == 4
    (tmp_path / "empty").mkdir()
    assert folder_digest(tmp_path) == found[-1]


def test_a_file_that_keeps_what_is_done_is_forgotten_whole(tmp_path: Path) -> None:
    path = tmp_path / "kept.done"
    with pytest.raises(UsageError, match="cannot keep what is done"):
        ResultStore(tmp_path / "nowhere" / "kept.done")
    store = ResultStore(path)
    store.keep([("one", Answer("ok", "{}"))])
    assert (store.done("one"), store.done("two")) == ("ok", None)
    store.close()
    reopened = ResultStore(path)
    assert reopened.done("one") == "ok"
    reopened.close()
    forget_done(path)
    forget_done(path)  # there is none
    assert list(tmp_path.iterdir()) == []
    with sqlite3.connect(path) as other:
        other.execute("CREATE TABLE mine (x)")
    other.close()
    for refused in (ResultStore, forget_done):
        with pytest.raises(UsageError, match="is a database of something else"):
            refused(path)
    assert path.exists()


# --- pages and tables


def _rows_of(page: Path) -> list[dict[str, Any]]:
    found = re.search(r'id="data">([^<]*)<', page.read_text("utf-8"))
    assert found is not None
    rows: list[dict[str, Any]] = json.loads(gzip.decompress(base64.b64decode(found[1])))
    return rows


class _Reports(list[ProgramReport]):
    pass


def test_a_page_bounds_messages_and_leaves_out_pictures_of_very_many(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = [f"remark {number}" for number in range(1021)]
    reports = _Reports(
        ProgramReport(
            "a.nc", "mill3", messages=told[:count], slowest=[(3, "G1", 2.0)], thumbnail=("M0 0", "")
        )
        for count in (20, 21, 1021)
    )
    monkeypatch.setattr(_report, "MOST_DETAILED", 3)
    page = tmp_path / "out.html"
    _write.write_batch(reports, page)
    rows = _rows_of(page)
    assert rows[0]["messages"] == told[:20]
    assert rows[1]["messages"] == [*told[:20], "and 1 more"]
    assert rows[2]["messages"] == [*told[:20], "and 1,001 more"]
    assert [(row["slowest"], row["thumbnail"]) for row in rows] == [([[3, "G1", 2.0]], ["M0 0", ""])] * 3
    assert not {"cycles", "rapid_time_s", "cutting_path_mm"} & set(rows[0])
    _write.write_batch(_Reports([*reports, *reports]), page)
    assert [(row["slowest"], row["thumbnail"]) for row in _rows_of(page)] == [([], None)] * 6
    _write.write_batch(_Reports(), page)
    assert _rows_of(page) == []


def test_a_table_has_one_row_for_each_report(tmp_path: Path) -> None:
    report = ProgramReport(
        "a.nc", "mill3", "din", 80.0, None, "error", time_s=1.5, errors=["one", "two"], blocks=7
    )
    path = _write.write_batch(_Reports([report]), tmp_path / "out.csv")
    with path.open(newline="", encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    assert row == {
        "program": "a.nc", "ok": "false", "time_s": "1.5", "cutting_time_s": "", "path_mm": "", "errors": "one\ntwo",
        "messages": "", "status": "error", "machine": "mill3", "dialect": "din", "override_percent": "80.0",
        "tolerance_mm": "", "rapid_time_s": "", "waiting_time_s": "", "cutting_path_mm": "", "top_feed_mm_min": "",
        "blocks": "7", "cycles": "", "removed_mm3": "",
    }  # fmt: skip


def test_a_large_parquet_table_comes_in_pieces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr(_write, "_PIECE", 3)
    reports = _Reports(
        ProgramReport(
            f"{number}.nc",
            "mill3",
            tools=[(4, 1.5, 0.25)],
            extents=[("X", -2.0, 9.0)],
            slowest=[(3, "G1", 2.0)],
        )
        for number in range(7)
    )
    rows = parquet.read_table(_write.write_batch(reports, tmp_path / "out.parquet")).to_pylist()
    assert [row["program"] for row in rows] == [f"{number}.nc" for number in range(7)]
    assert rows[6]["tools"] == [{"tool": 4, "cutting_time_s": 1.5, "rapid_time_s": 0.25}]
    assert rows[6]["extents"] == [{"axis": "X", "lowest": -2.0, "highest": 9.0}]
    assert rows[6]["slowest"] == [{"line": 3, "block": "G1", "time_s": 2.0}]


# --- which files


def test_which_files_of_a_folder_are_programs(tmp_path: Path) -> None:
    wanted = ["%4711", "O0001", "a.nc", "b.NC", "p12345678", "sub/c.ngc"]
    other = [".d.nc", ".git/e.nc", "O123456789", "Ox", "f.txt", "O12.bak"]
    for name in (*wanted, *other):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("M30\n")
    (tmp_path / "folder.nc").mkdir()

    def found(*paths: Path, patterns: Sequence[str] = ()) -> list[str]:
        return [each.relative_to(tmp_path).as_posix() for each in batches.find_programs(paths, patterns)]

    assert found(tmp_path) == wanted
    assert found(tmp_path / "f.txt", tmp_path, tmp_path / "a.nc") == ["f.txt", *wanted]
    assert found(tmp_path, patterns=("*.txt", "c.*")) == ["f.txt", "sub/c.ngc"]
    with pytest.raises(UsageError, match="no such file or folder"):
        found(tmp_path / "none")
    (tmp_path / "bare").mkdir()
    with pytest.raises(UsageError, match=r"there is no program in nothing"):
        found()
    with pytest.raises(UsageError, match=r"there is no program in .*bare") as caught:
        found(tmp_path / "bare", patterns=("*.x", "*.y"))
    assert caught.value.hint is not None
    assert caught.value.hint.startswith("Looked for *.x or *.y; ")


# --- processes


def test_limits_of_a_program() -> None:
    assert _batch._limits(0.0, 0.0) == Limits(0.0, 0.0)
    for given, match in (
        ((-1.0, 5.0), "a time-out of -1"),
        ((5.0, float("inf")), "a limit of memory of inf"),
    ):
        with pytest.raises(UsageError, match=match):
            _batch._limits(*given)


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
def test_a_process_outlives_its_time_out_by_a_little(monkeypatch: pytest.MonkeyPatch) -> None:
    set_s: list[int] = []
    monkeypatch.setattr(signal, "alarm", set_s.append)
    _child._alarm(Limits(time_s=7.5))
    _child._alarm(Limits(time_s=0.0))
    assert set_s == [17, 0]


def test_messages_that_break_off_are_none() -> None:
    pipe = io.BytesIO()
    _child._write(pipe, ("jobs", [1, 2]))
    _child._write(pipe, "ready")
    whole = pipe.getvalue()
    assert list(_child._messages(io.BytesIO(whole))) == [("jobs", [1, 2]), "ready"]
    assert list(_child._messages(io.BytesIO(whole[:-1]))) == [("jobs", [1, 2])]
    assert list(_child._messages(io.BytesIO(whole[:5]))) == []


class _Cluster:
    def __init__(self, found: dict[str, bytes] | None) -> None:
        self._found = found

    def run(self, function: object) -> dict[str, bytes]:
        if self._found is None:
            raise ImportError("No module named 'polycnc'")
        return self._found


def test_workers_with_another_version_are_refused() -> None:
    own = version_digest()
    _workers._check_versions(_Cluster({"tcp://a": own, "tcp://b": own}))
    with pytest.raises(UsageError, match=r"another polycnc runs on tcp://a, tcp://c, tcp://d\n"):
        _workers._check_versions(
            _Cluster({"tcp://b": own, **dict.fromkeys(("tcp://d", "tcp://c", "tcp://a"), b"x")})
        )
    five = dict.fromkeys((f"tcp://{name}" for name in "edcba"), b"x")
    with pytest.raises(UsageError, match=r"runs on tcp://a, tcp://b, tcp://c and 2 more workers\n"):
        _workers._check_versions(_Cluster(five))
    with pytest.raises(UsageError, match="the workers of the cluster cannot run polycnc: No module"):
        _workers._check_versions(_Cluster(None))
    lost = _workers._lost(_job_of(""), [Setup(MILL)], ValueError("why"))
    assert lost.status == "lost"
    assert report_in(lost.text).errors == [
        "a.nc: the workers that ran it were lost, one after the other (ValueError)"
    ]


class _Failing:
    """A process whose hand has a fault of its own, at the second of its jobs."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits

    def answers(self, jobs: Sequence[Job], setups: Sequence[Setup]) -> Iterator[Answer]:
        for job in jobs:
            if job.name == "b.nc":
                raise ZeroDivisionError("a fault")
            yield Answer("ok", job.name)

    def close(self) -> None:
        pass


@pytest.mark.timeout(60)
def test_a_fault_of_its_own_ends_a_batch_and_lets_nobody_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_workers, "Child", _Failing)
    names = ("a.nc", "c.nc", "d.nc")
    chunks = [[Job(name, name, b"", 0)] for name in names]
    workers = _workers.LocalWorkers(2)
    found = list(workers.run(iter(chunks), [Setup(MILL)], Limits()))
    assert sorted(found) == [[(name, Answer("ok", name))] for name in names]
    chunks.append([Job("b.nc", "b.nc", b"", 0)])
    with pytest.raises(ZeroDivisionError):
        list(workers.run(iter(chunks), [Setup(MILL)], Limits()))


def test_a_collision_is_an_error_of_its_program_and_what_cuts_nothing_is_none() -> None:
    setup = Setup(
        MILL, "fanuc", stock="box=0,0,-9,20,20,0", resolution_mm=0.5, fixtures=("box=0,-20,-9,20,-9,3",)
    )
    text = "(T1 D=6. - flat end mill)\nT1 M6\nS900 M3\nG0 X-5 Y8\nZ-3\nG1 X25 F900\nM30\n"
    right = report_of(_job_of(text), setup)
    assert (right.status, right.errors) == ("ok", [])
    assert right.removed_mm3 == pytest.approx(20.0 * 6.0 * 3.0, rel=0.02)
    wrong = report_of(_job_of(text.replace("G1 X25 F900", "G0 X25")), setup)
    assert wrong.status == "error"
    assert "rapid through stock, 3.000 mm deep" in wrong.errors[0]
    of_machine = Setup(MILL.model_copy(update={"stock": StockConfig(form="auto")}), "fanuc")
    for without in (replace(setup, stock="auto"), of_machine):
        nothing = report_of(_job_of("G0 X3\nM30\n"), without)
        assert (nothing.status, nothing.removed_mm3) == ("ok", None)
        assert nothing.messages[-1] == "the program cuts nothing: no stock can be told"


def test_a_batch_cuts_no_files() -> None:
    for options in ({"stock": "part.stl"}, {"stock": "auto", "fixtures": ["vice.stl"]}):
        with pytest.raises(UsageError, match="for a batch"):
            setups_of(None, None, {}, check_only=False, detail=False, **options)
    machine = MILL.model_copy(update={"stock": StockConfig(form="part.stl")})
    with pytest.raises(UsageError, match="for a batch"):
        setups_of(machine, None, {}, check_only=False, detail=False)
    with pytest.raises(UsageError, match="no stock"):
        setups_of(None, None, {}, check_only=False, detail=False, stock="ball")
