"""Trace files: exact numbers, the same columns in every format, complete or absent."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import polycnc
from polycnc.machine import MachineConfig
from polycnc.runner import TRACE_FORMATS, TraceWriter, trace_columns

MILL = polycnc.load_machine("mill3")
# Numbers that are hard to write: tiny, huge, no short decimals, zeros of both signs, repeated ones.
HARD = [0.1, 0.1, 1.0 / 3.0, -1e-300, 5e-324, 1.7976931348623157e308, -0.0, 0.0, 123456789.12345679, 20.0]


def _rows(axes: int = 3) -> np.ndarray:
    """Return recorder rows: time, block, feed, rapid, setpoints."""
    n = len(HARD)
    rows = np.zeros((n, 4 + axes))
    rows[:, 0] = np.arange(1, n + 1) * 0.001
    rows[:, 1] = np.arange(n) // 3 + 1
    rows[:, 2] = HARD
    for axis in range(axes):
        rows[:, 4 + axis] = np.roll(HARD, axis)
    return rows


def _write(path: Path, rows: np.ndarray, machine: MachineConfig = MILL, actual: bool = False) -> None:
    with TraceWriter(path, machine, actual) as writer:
        for piece in np.array_split(rows, 3):
            writer.add(piece)


@pytest.mark.parametrize("ending", TRACE_FORMATS)
def test_every_format_keeps_every_bit(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"trace{ending}"
    rows = _rows()
    _write(path, rows)
    trace = polycnc.read_trace(path)
    assert trace.axes == ("X", "Y", "Z")
    assert trace.units == ("mm", "mm", "mm")
    assert trace.block.tolist() == rows[:, 1].astype(int).tolist()
    assert trace.block.dtype == np.int64
    for got, wanted in (
        (trace.t_s, rows[:, 0]),
        (trace.feed_mm_s, rows[:, 2]),
        (trace.setpoint, rows[:, 4:]),
    ):
        assert np.array_equal(got, wanted)
        assert np.array_equal(np.signbit(got), np.signbit(wanted))
    assert trace.actual is None
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_csv_text(tmp_path: Path) -> None:
    path = tmp_path / "trace.csv"
    rows = np.array([[0.001, 7.0, 4.0, 1.0, 0.1, -0.5, 1e-7], [0.002, 7.0, 4.0, 1.0, 0.1 + 0.2, -0.5, 0.0]])
    _write(path, rows)
    assert path.read_bytes() == (
        b"t_s,block,feed_mm_s,X_mm,Y_mm,Z_mm\n"
        b"0.001,7,4.0,0.1,-0.5,1e-07\n"
        b"0.002,7,4.0,0.30000000000000004,-0.5,0.0\n"
    )


@pytest.mark.parametrize("ending", TRACE_FORMATS)
def test_actual_positions_and_units(tmp_path: Path, ending: str) -> None:
    machine = polycnc.load_machine("mill5")
    rows = np.arange(2 * 14, dtype=float).reshape(2, 14)
    path = tmp_path / f"trace{ending}"
    _write(path, rows, machine, actual=True)
    trace = polycnc.read_trace(path)
    assert trace.units == ("mm", "mm", "mm", "deg", "deg")
    assert np.array_equal(trace.setpoint, rows[:, 4:9])
    assert trace.actual is not None
    assert np.array_equal(trace.actual, rows[:, 9:])
    assert trace_columns(machine, actual=True)[-2:] == ["A_actual_deg", "C_actual_deg"]


@pytest.mark.parametrize("ending", TRACE_FORMATS)
def test_a_trace_without_rows(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"trace{ending}"
    _write(path, np.zeros((0, 7)))
    trace = polycnc.read_trace(path)
    assert len(trace) == 0
    assert trace.setpoint.shape == (0, 3)


@pytest.mark.parametrize("ending", TRACE_FORMATS)
def test_a_run_that_is_broken_off_leaves_the_old_file(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"trace{ending}"
    path.write_text("old")

    def run() -> None:
        with TraceWriter(path, MILL, actual=False) as writer:
            writer.add(_rows())
            assert len(list(tmp_path.iterdir())) == 2
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run()
    assert path.read_text() == "old"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_a_writer_that_cannot_finish_leaves_nothing(tmp_path: Path) -> None:
    class Broken(Exception):
        pass

    writer = TraceWriter(tmp_path / "trace.csv", MILL, actual=False)

    close = writer._file.close

    def broken(complete: bool) -> None:
        close(complete)
        raise Broken

    writer._file.close = broken  # type: ignore[method-assign]
    with pytest.raises(Broken), writer:
        pass
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["trace.txt", "trace", "nowhere/trace.csv", "folder.csv"])
def test_names_that_cannot_be_written(tmp_path: Path, name: str) -> None:
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(polycnc.UsageError, match="a trace cannot be written to"):
        TraceWriter(tmp_path / name, MILL, actual=False)
    assert [each.name for each in tmp_path.iterdir()] == ["folder.csv"]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_is_read_only(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(polycnc.UsageError, match="read-only"):
        TraceWriter(tmp_path / "trace.csv", MILL, actual=False)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("trace.txt", "", "is no trace file"),
        ("missing.csv", None, "no such file"),
        ("trace.csv", "a,b\n1,2\n", "does not hold a trace"),
    ],
)
def test_files_that_are_no_traces(tmp_path: Path, name: str, content: str | None, message: str) -> None:
    if content is not None:
        (tmp_path / name).write_text(content)
    with pytest.raises(polycnc.UsageError, match=message):
        polycnc.read_trace(tmp_path / name)
