"""Compare the time of programs here and on LinuxCNC's own trajectory planner, under three corner rules.

    python benchmarks/linuxcnc_times.py [PROGRAM...]

Needs `linuxcnc` (Debian: linuxcnc-uspace) and an ordinary user; it runs in wall time, some ten minutes. Without
programs it makes some as CAM systems write them. The machine is a router of 150 mm/s and 800 mm/s² (Z 80 and 500).
"""

from __future__ import annotations

import math
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import polycnc

AXES = {"X": (150.0, 800.0), "Y": (150.0, 800.0), "Z": (80.0, 500.0)}  # mm/s, mm/s2
RULES = {"G61": "G61", "G64 P0.01": "G64 P0.01", "G64 P0.1": "G64 P0.1", "G64": "G64"}
FREE_TOLERANCE = "free"


def main() -> None:
    """Print a table: program, corner rule, both times, deviation."""
    if shutil.which("linuxcnc") is None:
        sys.exit("linuxcnc is not installed (Debian: apt install linuxcnc-uspace)")
    if os.geteuid() == 0:
        sys.exit("linuxcnc refuses root: run this as an ordinary user")
    with tempfile.TemporaryDirectory() as folder:
        given = {Path(name).stem: Path(name).read_text() for name in sys.argv[1:]}
        compare(Path(folder), given or dict(made_programs()))


def compare(folder: Path, programs: dict[str, str]) -> None:
    """Run every program under every rule on both, and print what each took."""
    files: dict[tuple[str, str], Path] = {}
    for name, text in programs.items():
        for rule, code in RULES.items():
            files[name, rule] = folder / f"{name}_{rule.replace(' ', '_')}.ngc"
            files[name, rule].write_text(f"G21 G90 {code}\nG0 X0 Y0 Z0\n{text}\nM2\n")
    theirs = run_linuxcnc(folder, list(files.values()))
    deviations: dict[str, list[float]] = {rule: [] for rule in RULES}
    print(f"{'program':24} {'rule':10} {'LinuxCNC':>9} {'polycnc':>9} {'deviation':>9}")
    for (name, rule), file in files.items():
        ours = polycnc.run(file, write_machine(folder), dialect="linuxcnc").time_s
        there = theirs[file.name]
        deviations[rule].append(ours / there - 1.0)
        print(f"{name:24} {rule:10} {there:9.2f} {ours:9.2f} {100.0 * deviations[rule][-1]:+8.2f} %")
    for rule, values in deviations.items():
        sizes = [abs(value) for value in values]
        print(f"{rule:10} median {100 * statistics.median(sizes):.2f} %, worst {100 * max(sizes):.2f} %")


def made_programs() -> Iterator[tuple[str, str]]:
    """Yield programs of the kinds that CAM systems write: name and text, from the origin."""
    rng = np.random.default_rng(4)
    turn = np.linspace(0.0, 8.0 * math.pi, 500)
    yield "pocket spiral", lines(turn * np.cos(turn), turn * np.sin(turn), 0.0 * turn, 4800.0)
    x = np.tile(np.concatenate([np.linspace(0, 60, 100), np.linspace(60, 0, 100)]), 3)
    y = np.repeat(np.arange(6) * 1.3, 100)
    yield "surface raster", lines(x, y, 3.0 * np.sin(x / 7.0) * np.cos(y / 5.0), 3600.0)
    yield "trochoid arcs", arcs(10, 4.0, 1.1, 3900.0)
    heading = np.cumsum(rng.normal(size=250) * 0.4)
    yield (
        "engraving",
        lines(np.cumsum(0.35 * np.cos(heading)), np.cumsum(0.35 * np.sin(heading)), 0.0 * heading, 2400.0),
    )
    boxes = [(b * k, b * j) for b in np.arange(4.0, 25.0, 3.0) for k, j in ((1, 0), (1, 1), (0, 1), (0, 0))]
    yield "box offsets", lines(np.array(boxes)[:, 0], np.array(boxes)[:, 1], np.zeros(len(boxes)), 5400.0)
    corners = np.cumsum(rng.uniform(-25.0, 25.0, size=(40, 2)), axis=0)
    yield "facets", lines(corners[:, 0], corners[:, 1], np.zeros(40), 4200.0)
    yield (
        "long chords",
        lines(30 * np.sin(turn[::4]), 30 - 30 * np.cos(turn[::4]), 0.0 * turn[::4], 6000.0),
    )


def lines(x: np.ndarray, y: np.ndarray, z: np.ndarray, feed: float) -> str:
    """Return a program of lines through points, mm, at a feed in mm/min."""
    points = (f"G1 X{a:.4f} Y{b:.4f} Z{c:.4f}" for a, b, c in zip(x, y, z, strict=True))
    return f"F{feed:g}\n" + "\n".join(points)


def arcs(turns: int, radius: float, step: float, feed: float) -> str:
    """Return a program of full circles that move on by a step after each turn."""
    found = [f"F{feed:g}", f"G1 X{radius:g}"]
    for turn in range(turns):
        found.append(f"G2 X{turn * step - radius:.4f} Y0 I{-radius:g} J0")
        found.append(f"G2 X{turn * step + step + radius:.4f} Y0 I{radius + 0.5 * step:.4f} J0")
    return "\n".join(found)


def write_machine(folder: Path) -> Path:
    """Write the machine file."""
    axes = "".join(
        f'[[axis]]\nname = "{name}"\nvmax_mm_s = {speed}\namax_mm_s2 = {accel}\n'
        for name, (speed, accel) in AXES.items()
    )
    path = folder / "router.toml"
    path.write_text(f'name = "router"\n{axes}[path]\npath_tolerance_mm = "{FREE_TOLERANCE}"\n')
    return path


def run_linuxcnc(folder: Path, files: list[Path]) -> dict[str, float]:
    """Return the time in which the path moved, s, by the name of the file."""
    write_configuration(folder)
    (folder / "list.txt").write_text("\n".join(map(str, files)))
    (folder / "sim.tbl").touch()
    (folder / "sim.var").touch()
    done = subprocess.run(
        ["linuxcnc", "-r", "sim.ini"],
        cwd=folder,
        env={**os.environ, "PROGRAMS": str(folder / "list.txt")},
        capture_output=True,
        text=True,
        check=False,
    )
    found = dict(re.findall(r"^RESULT (\S+) ([\d.]+)$", done.stdout, re.MULTILINE))
    missing = [file.name for file in files if file.name not in found]
    if missing:
        sys.exit(f"LinuxCNC did not run {missing[0]}:\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    return {name: float(seconds) for name, seconds in found.items()}


def write_configuration(folder: Path) -> None:
    """Write a configuration without hardware, and the program that runs the others."""
    parts = [CONFIGURATION]
    for joint, (name, (speed, accel)) in enumerate(AXES.items()):
        limits = f"MAX_VELOCITY = {speed}\nMAX_ACCELERATION = {accel}\nMIN_LIMIT = -1e5\nMAX_LIMIT = 1e5\n"
        parts.append(f"[AXIS_{name}]\n{limits}[JOINT_{joint}]\nTYPE = LINEAR\nHOME = 0\n{limits}")
        parts.append(
            "FERROR = 1e5\nMIN_FERROR = 1e5\nHOME_SEARCH_VEL = 0\nHOME_LATCH_VEL = 0\nHOME_SEQUENCE = 0\n"
        )
    (folder / "sim.ini").write_text("".join(parts))
    (folder / "sim.hal").write_text(SIGNALS)
    display = folder / "run-all.py"
    display.write_text(DISPLAY)
    display.chmod(0o755)


CONFIGURATION = """\
[EMC]
VERSION = 1.1
MACHINE = router
[DISPLAY]
DISPLAY = ./run-all.py
[TASK]
TASK = milltask
CYCLE_TIME = 0.001
[RS274NGC]
PARAMETER_FILE = sim.var
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 4.0
SERVO_PERIOD = 1000000
[HAL]
HALFILE = sim.hal
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.1
TOOL_TABLE = sim.tbl
[TRAJ]
COORDINATES = XYZ
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
DEFAULT_LINEAR_VELOCITY = 50
MAX_LINEAR_VELOCITY = 2000
NO_FORCE_HOMING = 1
ARC_BLEND_ENABLE = 1
[KINS]
KINEMATICS = trivkins
JOINTS = 3
"""
SIGNALS = """\
loadrt trivkins coordinates=XYZ
loadrt motmod servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=3
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net x joint.0.motor-pos-cmd => joint.0.motor-pos-fb
net y joint.1.motor-pos-cmd => joint.1.motor-pos-fb
net z joint.2.motor-pos-cmd => joint.2.motor-pos-fb
net enable iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net change iocontrol.0.tool-change => iocontrol.0.tool-changed
"""
DISPLAY = '''\
#!/usr/bin/env python3
"""Run the listed programs one after the other; print the time in which the path moved."""
import os, time
import linuxcnc
command, status = linuxcnc.command(), linuxcnc.stat()
time.sleep(1.5)
def done(): command.wait_complete(10)
command.state(linuxcnc.STATE_ESTOP_RESET); done()
command.state(linuxcnc.STATE_ON); done()
command.mode(linuxcnc.MODE_MANUAL); done()
command.teleop_enable(0); done()
for joint in range(3):
    command.home(joint)
while True:
    status.poll()
    if all(status.homed[:3]): break
    time.sleep(0.1)
for name in open(os.environ["PROGRAMS"]).read().split("\\n"):
    command.mode(linuxcnc.MODE_MDI); done()
    command.mdi("G21 G90 G64 G0 X0 Y0 Z0"); done()
    time.sleep(0.2)
    command.mode(linuxcnc.MODE_AUTO); done()
    command.program_open(name); done()
    began = time.monotonic()
    command.auto(linuxcnc.AUTO_RUN, 0)
    first = last = None
    while time.monotonic() - began < 600.0:
        status.poll()
        now = time.monotonic()
        if abs(status.current_vel) > 1e-6:
            first, last = first or now, now
        if now - began > 0.3 and status.interp_state == linuxcnc.INTERP_IDLE:
            break
        time.sleep(0.001)
    print("RESULT %s %.3f" % (os.path.basename(name), (last or 0.0) - (first or 0.0)), flush=True)
'''

if __name__ == "__main__":
    main()
