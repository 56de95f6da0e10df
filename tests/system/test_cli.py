"""The command line as users meet it: whole processes, what they print and leave behind, and how they end."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import polycnc as library
from support.command import COMMAND, environment, polycnc
from support.started import started

# 20 mm at 10 mm/s with ramps of 2 ms on both sides, and a rapid of 5 mm up.
PROGRAM = "G1 X20 F600\nG0 Z5\nM30\n"
LONG = "".join(f"G1 X{1000 * (i % 2)} F1000\n" for i in range(1, 200))  # 3 hours of machining


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """Write the small program into a folder of its own."""
    (tmp_path / "part.nc").write_text(PROGRAM)
    return tmp_path


def test_run_prints_a_summary(part: Path) -> None:
    printed = polycnc("run", "part.nc", cwd=part).stdout.splitlines()
    assert printed[0] == "program    part.nc"
    assert printed[1] == "           3 blocks, dialect din, machine mill3"
    assert printed[2] == "time       2.073 s"
    assert printed[3].split() == ["cutting", "2.002", "s", "20.000", "mm"]
    assert printed[4].split() == ["rapid", "0.071", "s", "5.000", "mm"]
    assert printed[5] == "path       25.000 mm, cut with up to 600.0 mm/min"
    assert [line.split() for line in printed[7:]] == [
        ["X", "0.000", "20.000", "20.000", "mm"],
        ["Y", "0.000", "0.000", "0.000", "mm"],
        ["Z", "0.000", "5.000", "5.000", "mm"],
    ]
    assert all(line == line.rstrip() and len(line) <= 80 for line in printed)


def test_long_paths_are_not_wrapped(part: Path) -> None:
    folder = part / ("a folder with a long name " * 5).strip()
    folder.mkdir()
    (folder / "part.nc").write_text(PROGRAM)
    printed = polycnc("run", folder / "part.nc", "--trace", folder / "t.csv", COLUMNS="40").stdout
    assert f"program    {folder / 'part.nc'}\n" in printed
    assert printed.endswith(f"wrote      {folder / 't.csv'}\n")


def test_run_json(part: Path) -> None:
    report = json.loads(polycnc("run", "part.nc", "--json", cwd=part).stdout)
    assert report["program"] == "part.nc"
    assert (report["dialect"], report["machine"], report["blocks"]) == ("din", "mill3", 3)
    assert report["cutting_time_s"] == pytest.approx(2.002, abs=1e-9)
    # Z: up to speed and down again with 4 m/s²: 2 * sqrt(5 / 4000) s, and on to the end of the cycle.
    assert report["rapid_time_s"] == pytest.approx(0.071, abs=1e-3)
    assert report["time_s"] == pytest.approx(2.073, abs=1e-9)
    assert report["path_mm"] == pytest.approx(25.0)
    assert report["end_position_mm"] == {"X": 20.0, "Y": 0.0, "Z": 5.0}
    assert report["extents_mm"] == {"X": [0.0, 20.0], "Y": [0.0, 0.0], "Z": [0.0, 5.0]}
    assert report["alarms"] == []
    assert report["messages"] == []


def test_run_json_of_a_program_with_an_error(tmp_path: Path) -> None:
    (tmp_path / "wrong.nc").write_text("G1 X20 F600\nG1 Y5 Q\nG1 X0\n")
    done = polycnc("run", "wrong.nc", "--json", "--trace", "wrong.csv", cwd=tmp_path, status=1)
    report = json.loads(done.stdout)
    assert done.stderr == ""
    (alarm,) = report["alarms"]
    assert (alarm["kind"], alarm["file"], alarm["line"], alarm["column"]) == ("program", "wrong.nc", 2, 7)
    assert alarm["text"] == "'Q' has no number"
    assert alarm["hint"]
    assert alarm["time_s"] == report["time_s"] == pytest.approx(2.002, abs=2e-3)
    # What stood before the error has run, and the trace shows it.
    assert report["end_position_mm"]["X"] == 20.0
    assert (tmp_path / "wrong.csv").read_text().splitlines()[-1].split(",")[3] == "20.0"


def test_an_error_in_the_summary_has_its_place_and_a_caret(tmp_path: Path) -> None:
    (tmp_path / "wrong.nc").write_text("G1 X20 F600\nG1 Y5 Q\n")
    printed = polycnc("run", "wrong.nc", cwd=tmp_path, status=1).stdout
    assert "alarm: wrong.nc:2:7: 'Q' has no number\n    G1 Y5 Q\n          ^\n" in printed


@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
def test_traces_hold_what_the_library_gives(part: Path, ending: str) -> None:
    printed = polycnc("run", "part.nc", "--trace", f"part.{ending}", cwd=part).stdout
    assert printed.endswith(f"wrote      part.{ending}\n")
    written = library.read_trace(part / f"part.{ending}")
    trace = library.run(PROGRAM, trace=True).trace
    assert trace is not None
    for name in ("t_s", "block", "feed_mm_s", "setpoint"):
        assert np.array_equal(getattr(written, name), getattr(trace, name)), name
    assert written.axes == ("X", "Y", "Z")
    assert written.setpoint[-1].tolist() == [20.0, 0.0, 5.0]
    assert sorted(path.name for path in part.iterdir()) == sorted([f"part.{ending}", "part.nc"])


def test_servo_adds_actual_positions(part: Path) -> None:
    polycnc("run", "part.nc", "--machine", "card6", "--servo", "--trace", "part.csv", cwd=part)
    header = (part / "part.csv").read_text().partition("\n")[0]
    axes = "XYZUVW"
    assert header == ",".join(
        ["t_s", "block", "feed_mm_s", *(f"{a}_mm" for a in axes), *(f"{a}_actual_mm" for a in axes)]
    )


def test_servo_on_ideal_servos_is_remarked_on(part: Path) -> None:
    assert "mill3 has ideal servos" in polycnc("run", "part.nc", "--servo", cwd=part).stderr


def test_plot(part: Path) -> None:  # the other formats: tests/unit/test_plot.py
    assert "wrote      part.png" in polycnc("run", "part.nc", "--plot", "part.png", cwd=part).stdout
    assert (part / "part.png").read_bytes().startswith(b"\x89PNG")


def test_a_program_without_motion_gives_empty_files(tmp_path: Path) -> None:
    (tmp_path / "still.nc").write_text("")
    report = json.loads(
        polycnc("run", "still.nc", "--json", "--trace", "t.csv", "--plot", "t.png", cwd=tmp_path).stdout
    )
    assert report["time_s"] == 0.0
    assert (tmp_path / "t.csv").read_text() == "t_s,block,feed_mm_s,X_mm,Y_mm,Z_mm\n"
    assert (tmp_path / "t.png").stat().st_size > 0


def test_block_delete(tmp_path: Path) -> None:
    (tmp_path / "part.nc").write_text("G1 X10 F600\n/G1 X20\n/2 G1 X30\n")
    end = {}
    for levels in ((), ("--skip", "1"), ("--skip", "1", "--skip", "2")):
        report = json.loads(polycnc("run", "part.nc", "--json", *levels, cwd=tmp_path).stdout)
        end[levels[1::2]] = report["extents_mm"]["X"][1], report["end_position_mm"]["X"]
    assert end == {(): (30.0, 30.0), ("1",): (30.0, 30.0), ("1", "2"): (10.0, 10.0)}


# ---------------------------------------------------------------------- check


def test_check_reports_every_error_of_every_program(tmp_path: Path) -> None:
    (tmp_path / "good.nc").write_text(PROGRAM)
    (tmp_path / "wrong.nc").write_text("G1 X10\nG1 X20 F100 Q\nG777\n")
    done = polycnc("check", "wrong.nc", "good.nc", cwd=tmp_path, status=1)
    places = [line for line in done.stdout.splitlines() if line.startswith("wrong.nc:")]
    assert [place.split(": ")[0] for place in places] == ["wrong.nc:1:1", "wrong.nc:2:13", "wrong.nc:3:1"]
    assert "good.nc: no errors\n" in done.stdout
    assert done.stdout.endswith("3 errors\n")
    report = json.loads(polycnc("check", "wrong.nc", "good.nc", "--json", cwd=tmp_path, status=1).stdout)
    assert report["errors"] == 3
    assert [error["line"] for error in report["programs"]["wrong.nc"]] == [1, 2, 3]
    assert report["programs"]["good.nc"] == []


def test_check_of_good_programs_is_clean(part: Path) -> None:
    (part / "part.nc").write_text("T1 M6\nM3 S500\n" + PROGRAM)
    assert polycnc("check", "part.nc", cwd=part).stdout == "part.nc: no errors\n"


def test_check_tells_remarks_and_strict_checking_makes_them_errors(part: Path) -> None:
    told = polycnc("check", "part.nc", cwd=part).stdout.splitlines()
    assert told == [
        "remark: part.nc:1:1: cuts with the spindle at rest",
        "remark: part.nc:1:1: cuts without a tool in the spindle",
        "part.nc: no errors",
    ]
    strict = polycnc("check", "part.nc", "--strict", cwd=part, status=1).stdout.splitlines()
    assert strict[0] == "error: part.nc:1:1: cuts with the spindle at rest"
    assert strict[-1] == "2 errors"
    report = json.loads(polycnc("check", "part.nc", "--json", cwd=part).stdout)
    assert report["errors"] == 0
    assert [(each["code"], each["line"], each["count"]) for each in report["remarks"]["part.nc"]] == [
        ("spindle_off", 1, 1),
        ("no_tool", 1, 1),
    ]


def test_check_goes_on_behind_a_file_that_cannot_be_read(part: Path) -> None:
    (part / "wrong.nc").write_text("G1 X5\n")
    done = polycnc("check", "missing.nc", "wrong.nc", "part.nc", cwd=part, status=2)
    assert "wrong.nc:1:1: a feed move without a feed" in done.stdout
    assert "part.nc: no errors" in done.stdout
    assert done.stdout.endswith("2 errors\n")
    assert "error: no such file: missing.nc" in done.stderr
    report = json.loads(polycnc("check", "missing.nc", "wrong.nc", "--json", cwd=part, status=2).stdout)
    assert report["unreadable"]["missing.nc"]["text"] == "no such file: missing.nc"
    assert len(report["programs"]["wrong.nc"]) == 1


def test_several_programs_and_standard_input_run_one_after_the_other(part: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "polycnc", "run", "part.nc", "-", "--units", "inch"],
        cwd=part,
        env=environment(),
        input="G1 X25.4 F1524\nM30\n",
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert [line for line in done.splitlines() if line.startswith("program")] == [
        "program    part.nc",
        "program    <stdin>",
    ]
    assert "  cutting  1.006 s  1.0000 in" in done
    assert "cut with up to 60.00 in/min" in done
    assert done.splitlines()[-1] == "total      3.079 s, 2 programs"
    report = json.loads(polycnc("run", "part.nc", "part.nc", "--json", cwd=part).stdout)
    assert len(report["programs"]) == 2
    assert report["time_s"] == pytest.approx(2 * report["programs"][0]["time_s"])
    told = polycnc("run", "part.nc", "part.nc", "--trace", "t.csv", cwd=part, status=2).stderr
    assert told.startswith("error: a trace of 2 programs")


def test_codes_are_left_out_on_demand(part: Path) -> None:
    (part / "five.tap").write_text("G43.4 H1 Z5.\nM198 P7\nM30\n")
    polycnc("run", "five.tap", cwd=part, status=1)
    told = polycnc("run", "five.tap", "--ignore", "G43.4,M198", cwd=part).stdout
    assert "message    line 1: G43.4 is left out, as told" in told
    assert "message    line 2: M198 is left out, as told" in told
    assert polycnc("check", "five.tap", "--ignore", "X5", cwd=part, status=2).stderr.startswith(
        "error: 'X5' is no"
    )


def test_colours_are_for_terminals_and_can_be_switched_off() -> None:
    import typer

    from polycnc.cli._output import bold_red

    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("NO_COLOR", raising=False)
        assert bold_red("error") == typer.style("error", bold=True, fg="red") != "error"
        patch.setenv("NO_COLOR", "1")
        assert bold_red("error") == "error"


def test_the_shell_is_taught_to_complete() -> None:
    from polycnc.cli._programs import dialect_names, machine_names

    assert machine_names("mill") == ["mill3", "mill5"]
    assert "fanuc-lathe" in dialect_names("fan")
    assert "--show-completion" in polycnc("--help").stdout


# ---------------------------------------------------------------------- machine, conformance, help


def test_machine_table_and_json() -> None:
    printed = polycnc("machine").stdout
    assert printed.startswith("mill3  Three-axis mill")
    assert "presets: card6, lathe2, mill3, mill5" in printed
    described = json.loads(polycnc("machine", "mill5", "--json").stdout)
    assert described["cycle_s"] == 0.001
    tilt = described["axes"][3]
    assert (tilt["name"], tilt["kind"]) == ("A", "rotary")
    assert (tilt["vmax"], tilt["vmax_unit"]) == (180.0, "deg/s")
    assert (tilt["amax"], tilt["amax_unit"]) == (1200.0, "deg/s2")
    assert (tilt["soft_limits"], tilt["soft_limits_unit"]) == ([-120.0, 120.0], "deg")
    assert described["axes"][0]["soft_limits"] is None


def test_machine_file_of_a_preset_is_a_machine(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(polycnc("machine", "lathe2", "--toml").stdout)
    assert polycnc("machine", "./mine.toml", cwd=tmp_path).stdout.startswith("lathe2  ")


def test_conformance_counts_and_lists() -> None:
    counts = json.loads(polycnc("conformance", "--json").stdout)
    assert set(counts["systems"]) == {"fanuc", "apci", "imc", "cpl", "post"}
    assert polycnc("conformance").stdout.splitlines()[0].split()[:3] == ["system", "rows", "tested"]
    assert list(json.loads(polycnc("conformance", "apci", "--json").stdout)["systems"]) == ["apci"]


def test_help_is_plain_and_fits() -> None:
    for command in ((), ("run",), ("check",), ("machine",), ("conformance",)):
        printed = polycnc(*command, "--help").stdout
        assert printed.startswith("Usage: polycnc")
        assert all(len(line) <= 80 for line in printed.splitlines())
    assert polycnc("--version").stdout == f"polycnc {library.__version__}\n"


# ---------------------------------------------------------------------- how it ends

WRONG_USAGE = {
    "no such file": ("run", "missing.nc"),
    "folder as program": ("run", "folder"),
    "UTF-16 program": ("run", "utf16.nc"),
    "unknown preset": ("run", "part.nc", "--machine", "mil3"),
    "broken TOML": ("run", "part.nc", "--machine", "broken.toml"),
    "unknown key": ("machine", "unknown.toml"),
    "unknown dialect": ("run", "part.nc", "--dialect", "klingon"),
    "trace ending": ("run", "part.nc", "--trace", "part.txt"),
    "trace folder": ("run", "part.nc", "--trace", "nowhere/part.csv"),
    "plot ending": ("run", "part.nc", "--plot", "part.jpg"),
    "plot folder": ("run", "part.nc", "--plot", "nowhere/part.png"),
    "unknown option": ("run", "part.nc", "--frobnicate"),
    "no program": ("run",),
    "unknown command": ("walk",),
    "skip level": ("run", "part.nc", "--skip", "10"),
    "one missing of two": ("run", "part.nc", "missing.nc"),
    "unknown system": ("conformance", "heidenhain"),
    "state of nothing": ("conformance", "--list", "open"),
}


@pytest.mark.parametrize("arguments", WRONG_USAGE.values(), ids=WRONG_USAGE)
def test_wrong_usage_ends_with_2_before_any_work(part: Path, arguments: tuple[str, ...]) -> None:
    (part / "folder").mkdir()
    (part / "utf16.nc").write_bytes("G0 X1\n".encode("utf-16"))
    (part / "broken.toml").write_text("name = = 3\n")
    (part / "unknown.toml").write_text('name = "x"\nspeed = 3\n')
    before = sorted(part.iterdir())
    done = polycnc(*arguments, cwd=part, status=2)
    assert done.stdout == ""
    lines = done.stderr.strip().splitlines()
    assert len(lines) >= 2, "an error says what is wrong and what to do"
    assert any(line.lower().startswith("error: ") for line in lines)
    assert sorted(part.iterdir()) == before


def test_bytes_that_are_no_utf8_may_stand_in_comments_only(tmp_path: Path) -> None:
    (tmp_path / "remark.nc").write_bytes(b"G1 X1 F100 (caf\xe9)\n")
    polycnc("run", "remark.nc", cwd=tmp_path)
    (tmp_path / "word.nc").write_bytes(b"G1 X1 F100\nG1 \xe9\x1b[31m\n")
    done = polycnc("run", "word.nc", cwd=tmp_path, status=1)
    assert "alarm: word.nc:2:4:" in done.stdout
    assert "\x1b" not in done.stdout, "a program cannot send control characters to the terminal"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_unreadable_program(part: Path) -> None:
    (part / "part.nc").chmod(0)
    assert "cannot read part.nc" in polycnc("run", "part.nc", cwd=part, status=2).stderr


def test_a_disk_that_is_full_is_told(part: Path) -> None:
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("no /dev/full here")
    with full.open("w") as output:
        done = subprocess.run(
            [*COMMAND, "machine"],
            stdout=output,
            stderr=subprocess.PIPE,
            env=environment(),
            text=True,
            check=False,
        )
    assert done.returncode == 1
    assert done.stderr.startswith("error: ")
    assert "Traceback" not in done.stderr


def test_output_that_nobody_reads_ends_quietly(part: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "wb") as pipe:
        done = subprocess.run(
            [*COMMAND, "conformance", "apci"],
            stdout=pipe,
            stderr=subprocess.PIPE,
            env=environment(),
            check=False,
        )
    assert (done.returncode, done.stderr) == (1, b"")


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interrupted_run_leaves_no_trace(tmp_path: Path, number: signal.Signals, status: int) -> None:
    (tmp_path / "long.nc").write_text(LONG)
    process = started("run", "long.nc", "--trace", "long.csv", "--plot", "long.png", cwd=tmp_path)
    for _ in range(2400):  # until it writes
        if any(path.stat().st_size > 0 for path in tmp_path.glob(".long.*.partial.csv")):
            break
        time.sleep(0.05)
    process.send_signal(number)
    printed, errors = process.communicate(timeout=60)
    assert process.returncode == status, errors
    assert "Traceback" not in errors
    assert printed == ""
    assert [path.name for path in tmp_path.iterdir()] == ["long.nc"]


def test_warmup_makes_a_job_ready_and_knows_its_jobs(tmp_path: Path) -> None:
    assert re.fullmatch(r"run +ready after \d+ s\n", polycnc("warmup", "run").stdout)
    wrong = polycnc("warmup", "drilling", status=2)
    assert "unknown job 'drilling'" in wrong.stderr
    assert "run, stock, post, apci, imc, all" in wrong.stderr
    # What was warmed up is not compiled again: the line that says so is absent.
    part = tmp_path / "part.nc"
    part.write_text("G0 X1 Y2\nG1 X10 F600\nG2 X20 I5 J0\nM30\n")
    command = [*COMMAND, "run", str(part)]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=True, timeout=240)
    assert done.stderr == ""


def test_view_writes_a_page_and_never_over_an_input(part: Path) -> None:
    printed = polycnc("view", "part.nc", cwd=part).stdout
    assert printed == "time       2.073 s\nwrote      part.html\n"
    assert (part / "part.html").read_text("utf-8").startswith("<!doctype html>")
    (part / "text.html").write_text(PROGRAM)
    (part / "two.nc").write_text("G1 X10 Z-1 F600\nT2 M6\nG1 X0\nM30\n")
    cut = polycnc("view", "two.nc", "--stock", "box=0,0,-5,9,9,0", "--resolution", "1", cwd=part).stdout
    assert "message    no tool is in the spindle in some cuts" in cut
    assert "the shape of tool 2 is not known: it cuts nothing here; a comment like (T2 D=10)" in cut
    refused = polycnc("view", "text.html", cwd=part, status=2).stderr
    assert "a view cannot be written to text.html: the command reads that file" in refused
    assert (part / "text.html").read_text() == PROGRAM


def test_view_shows_the_run_up_to_an_alarm(tmp_path: Path) -> None:
    (tmp_path / "wrong.nc").write_text("G1 X20 F600\nG1 Y5 Q\n")
    printed = polycnc("view", "wrong.nc", "-o", "w.html", cwd=tmp_path, status=1).stdout
    assert "alarm: wrong.nc:2:7: 'Q' has no number" in printed
    assert (tmp_path / "w.html").is_file()


@pytest.mark.parametrize(
    ("command", "option", "victim"),
    [
        ("run", "--trace", "p.csv"),
        ("run", "--plot", "p.png"),
        ("run", "--trace", "link.csv"),
        ("view", "-o", "p.html"),
        ("post", "-o", "p.cl"),
        ("post", "-o", "c.toml"),
    ],
)
def test_an_output_never_replaces_an_input(tmp_path: Path, command: str, option: str, victim: str) -> None:
    (tmp_path / "c.toml").write_text(polycnc("post", "--control", "din", "--show-control").stdout)
    (tmp_path / "p.cl").write_text("GOTO/1,2,3\nFINI\n")
    for name in ("p.csv", "p.png", "p.html"):
        (tmp_path / name).write_text(PROGRAM)
    (tmp_path / "link.csv").symlink_to("p.csv")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    read = {"run": ["p.csv" if victim == "link.csv" else victim, "--dialect", "din"], "view": [victim]}
    given = read.get(command, ["p.cl", "--control", "c.toml"])
    failed = polycnc(command, *given, option, victim, cwd=tmp_path, status=2)
    assert "the command reads that file" in failed.stderr
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
