"""A trace in the tables of other libraries has the columns of a trace file; notebooks show tables."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import polycnc
from polycnc.errors import UsageError
from polycnc.nc import ProgramText, dialect_for
from polycnc.runner import Trace, TraceWriter
from polycnc.runner._run import run_program
from polycnc.runner._settings import RunSettings

PROGRAM = "G0 X3 Y2\nG1 X7.5 F900\n"


@pytest.fixture(scope="module")
def trace() -> Trace:
    found = polycnc.run(PROGRAM, "mill3", trace=True, servo=True).trace
    assert found is not None
    return found


def test_columns_are_those_of_a_trace_file(trace: Trace, tmp_path: Path) -> None:
    columns = trace.columns()
    mill = polycnc.load_machine("mill3")
    with TraceWriter(tmp_path / "t.csv", mill, actual=True) as writer:
        run_program(
            ProgramText.from_text(PROGRAM),
            RunSettings(mill, dialect_for(ProgramText.from_text(PROGRAM), None), servo=True),
            tagged_rows=writer.add_tagged,
        )
    heads = (tmp_path / "t.csv").read_text().partition("\n")[0].split(",")
    assert list(columns) == [*heads, "rapid"]
    again = polycnc.read_trace(tmp_path / "t.csv").columns()
    for head in heads:
        assert np.array_equal(columns[head], again[head])
    assert columns["rapid"].any()
    assert not columns["rapid"].all()


def test_as_an_array_the_numbers_stand_side_by_side(trace: Trace) -> None:
    found = np.asarray(trace)
    assert found.shape == (len(trace), 3 + 3 + 3)
    assert found.dtype == np.float64
    assert np.array_equal(found[:, 3:6], trace.setpoint)
    assert np.array_equal(found[:, 1], trace.block)
    assert np.asarray(trace, np.float32).dtype == np.float32
    with pytest.raises(ValueError, match="copying"):
        np.array(trace, copy=False)


def test_as_a_table_of_arrow_and_as_its_stream(trace: Trace) -> None:
    arrow = pytest.importorskip("pyarrow", reason="pip install 'polycnc[parquet]'")
    table = trace.to_arrow()
    assert table.column_names == list(trace.columns())
    assert np.array_equal(table["X_mm"].to_numpy(), trace.setpoint[:, 0])
    assert arrow.RecordBatchReader.from_stream(trace).read_all().equals(table)


def test_as_a_data_frame(trace: Trace, monkeypatch: pytest.MonkeyPatch) -> None:
    class Pandas:
        DataFrame = dict

    monkeypatch.setitem(sys.modules, "pandas", Pandas)
    assert list(trace.to_pandas()) == list(trace.columns())


def test_a_library_that_is_not_there_is_named(trace: Trace, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("pandas", "pyarrow"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(UsageError, match="needs pandas") as error:
        trace.to_pandas()
    assert "pip install" in error.value.hint
    with pytest.raises(UsageError, match="needs pyarrow"):
        trace.to_arrow()


def test_sub_programs_are_named_in_every_row(tmp_path: Path) -> None:
    (tmp_path / "part.nc").write_text("G0 X4\nM98 P7\nM30\n")
    (tmp_path / "O0007").write_text("O7\nG0 Y6\nM99\n")
    trace = polycnc.run(tmp_path / "part.nc", "mill3", trace=True).trace
    assert trace is not None
    if trace.program is None:
        pytest.fail("there are two programs")
    assert list(trace.columns())[-1] == "program"
    assert np.asarray(trace).shape[1] == 6


def test_comparisons_and_machines_are_tables_in_a_notebook() -> None:
    shown = polycnc.compare(PROGRAM, "G0 X3 Y2 <b>\nG1 X7.5 Y2.25 F900\n".replace(" <b>", ""), "mill3")
    html = shown._repr_html_()
    assert "differ" in html
    assert "0.2500 mm, line 2" in html
    assert html.count("<th>") == 3
    mill = polycnc.load_machine("mill3").model_copy(update={"description": "a <b>"})
    html = mill._repr_html_()
    assert "a &lt;b&gt;" in html
    assert all(f"<td>{axis}</td>" in html for axis in "XYZ")


def test_one_program_on_two_machines_is_compared_as_the_command_does() -> None:
    mill = polycnc.load_machine("mill3")
    slow = mill.model_copy(
        update={"axes": tuple(axis.model_copy(update={"amax_mm_s2": axis.amax / 16}) for axis in mill.axes)}
    )
    found = polycnc.compare(PROGRAM, machine=mill, machine_b=slow)
    assert found.ok
    assert found.b.time_s > found.a.time_s
    for side in (PROGRAM, "part.nc"):
        with pytest.raises(UsageError, match="nothing to be compared with"):
            polycnc.compare(side)
    with pytest.raises(UsageError, match="has run already"):
        polycnc.compare("trace.npz", machine_b=slow)
