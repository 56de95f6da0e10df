"""Trace files: exact numbers, the same columns in every format, complete or absent."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import polycnc
from polycnc.errors import ProgramError
from polycnc.machine import MachineConfig
from polycnc.nc import BlockRecords
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


MAIN = "N1 G1 X4.5 F900\nN2 M98 P31\nN3 G1 X0.5\nN4 M30\n"
SUB = "O0031\nN7 G1 Y2.25\nN8 M98 P32\nN9 M99\n"
INNER = "O0032\nG1 Z-1.25\nM99\n"


@pytest.mark.parametrize("name", ["part.nc", 'a, "b"\u00e4.nc'])
@pytest.mark.parametrize("ending", TRACE_FORMATS)
def test_rows_of_sub_programs_in_files_of_their_own_name_them(tmp_path: Path, ending: str, name: str) -> None:
    for file, text in ((name, MAIN), ("O0031.nc", SUB), ("O0032.nc", INNER)):
        (tmp_path / file).write_text(text, encoding="utf-8")
    path = tmp_path / f"trace{ending}"
    program = tmp_path / name
    with TraceWriter(path, MILL, actual=False) as writer:
        given = polycnc.run(program, trace=True, tagged_rows=in_pieces(writer, 97)).trace
    trace = polycnc.read_trace(path)
    assert given is not None
    assert given.program is not None
    assert trace.program is not None
    assert trace.program.tolist() == given.program.tolist()
    assert np.array_equal(trace.setpoint, given.setpoint)
    assert np.array_equal(trace.block, given.block)
    # The axis that moves says which program a row belongs to; a cycle with a corner in it belongs to the block after.
    moves = np.diff(trace.setpoint, axis=0, prepend=np.zeros((1, 3)))
    wanted = {0: str(program), 1: str(tmp_path / "O0031.nc"), 2: str(tmp_path / "O0032.nc")}
    for axis, owner in wanted.items():
        alone = (moves[:, axis] != 0.0) & (np.count_nonzero(moves, axis=1) == 1)
        assert np.count_nonzero(alone) > 80
        assert set(trace.program[alone].tolist()) == {owner}
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted(
        [name, "O0031.nc", "O0032.nc", path.name]
    )


def in_pieces(writer: TraceWriter, size: int) -> Callable[[np.ndarray, np.ndarray, BlockRecords], None]:
    """Return a sink that hands rows on in small pieces, so that programs begin within one and between two."""

    def add(rows: np.ndarray, tags: np.ndarray, records: BlockRecords) -> None:
        for start in range(0, len(rows), size):
            writer.add_tagged(rows[start : start + size], tags[start : start + size], records)

    return add


@pytest.mark.parametrize("ending", TRACE_FORMATS)
def test_one_program_needs_no_column(tmp_path: Path, ending: str) -> None:
    text = "G1 X4.5 F900\nM98 P7\nM30\nO7\nG1 Y2.25\nM99\n"
    (tmp_path / "part.nc").write_text(text)
    path = tmp_path / f"trace{ending}"
    with TraceWriter(path, MILL, actual=False) as writer:
        given = polycnc.run(tmp_path / "part.nc", trace=True, tagged_rows=in_pieces(writer, 100)).trace
    trace = polycnc.read_trace(path)
    assert trace.program is None
    assert given is not None
    assert given.program is None
    assert trace.setpoint[-1].tolist() == [4.5, 2.25, 0.0]


def test_a_break_after_the_second_program_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "part.nc").write_text(MAIN)
    (tmp_path / "O0031.nc").write_text(SUB)  # and no 32
    path = tmp_path / "trace.csv"

    def run() -> None:
        with TraceWriter(path, MILL, actual=False) as writer:
            polycnc.run(tmp_path / "part.nc", tagged_rows=writer.add_tagged)

    with pytest.raises(ProgramError):
        run()
    assert sorted(each.name for each in tmp_path.iterdir()) == ["O0031.nc", "part.nc"]
