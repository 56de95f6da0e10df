"""Compare the time of programs here and on LinuxCNC's own trajectory planner, under three corner rules.

    python benchmarks/linuxcnc_times.py [PROGRAM...]

Needs `linuxcnc` (Debian: linuxcnc-uspace) and an ordinary user; it runs in wall time, some fifteen minutes, but counts
servo cycles, so that other work on the computer does not matter. Without programs it makes some as CAM systems write
them. The machine is a router of 150 mm/s and 800 mm/s² (Z 80 and 500), here as `polycnc machine --from` makes it.
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
from itertools import cycle
from pathlib import Path

import numpy as np

import polycnc
from polycnc.runner import machine_from

AXES = {"X": (150.0, 800.0), "Y": (150.0, 800.0), "Z": (80.0, 500.0)}  # mm/s, mm/s2
RULES = {"G61": "G61", "G64 P0.01": "G64 P0.01", "G64 P0.1": "G64 P0.1", "G64": "G64"}
CYCLE_S = 0.001


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
            files[name, rule] = folder / f"{name}_{rule}.ngc".replace(" ", "_")
            files[name, rule].write_text(f"G21 G90 {code}\nG0 X0 Y0 Z0\n{text}\nM2\n")
    write_configuration(folder)
    machine = folder / "router.toml"
    machine.write_text(machine_from(folder / "sim.ini"))
    theirs = run_linuxcnc(folder, list(files.values()))
    deviations: dict[str, list[float]] = {rule: [] for rule in RULES}
    print(f"{'program':24} {'rule':10} {'LinuxCNC':>9} {'polycnc':>9} {'deviation':>9}")
    for (name, rule), file in files.items():
        ours = polycnc.run(file, machine, dialect="linuxcnc").time_s
        there = theirs[file.name]
        deviations[rule].append(ours / there - 1.0)
        print(f"{name:24} {rule:10} {there:9.2f} {ours:9.2f} {100.0 * deviations[rule][-1]:+8.2f} %")
    for rule, values in deviations.items():
        sizes = [abs(value) for value in values]
        print(f"{rule:10} median {100 * statistics.median(sizes):.2f} %, worst {100 * max(sizes):.2f} %")
    sizes = [abs(value) for values in deviations.values() for value in values]
    within = sum(size <= 0.005 for size in sizes)
    print(
        f"all        median {100 * statistics.median(sizes):.2f} %, worst {100 * max(sizes):.2f} %, ", end=""
    )
    print(f"{within} of {len(sizes)} within 0.5 %")


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
    facets = lines(corners[:, 0], corners[:, 1], np.zeros(40), 4200.0)
    yield "facets", facets
    yield (
        "long chords",
        lines(30 * np.sin(turn[::4]), 30 - 30 * np.cos(turn[::4]), 0.0 * turn[::4], 6000.0),
    )
    yield "zigzag arcs", zigzag(12, 6000.0)
    holes = rng.uniform(-40.0, 40.0, size=(25, 2))
    yield (
        "holes",
        "G0 Z5\n" + "\n".join(f"G0 X{x:.3f} Y{y:.3f}\nG1 Z-4 F900\nG0 Z5" for x, y in holes),
    )
    yield "islands", islands(rng.uniform(0.0, 60.0, size=(8, 2)), 3000.0)
    yield "slots", slots(25, 4500.0)
    yield "scallops", scallops(24, 5.0, 4000.0)
    yield "chain", chain(np.random.default_rng(1), 40, 3000.0)
    yield "feeds", with_feeds(facets, (1500, 3000, 4500, 2400))
    yield "lifted trochoid", lifted_trochoid(12, 4.0, 1.1, 3900.0)
    yield "adaptive", adaptive(12, 4.0, 1.0, 4200.0)
    yield "threads", threads(4, 5.0, 1.5, 2400.0)
    yield "helical pocket", helical_pocket(8, 6.0, 0.8, 3000.0)
    yield "cone", cone(24, 0.4, 0.3, 3600.0)
    yield "waves", waves(12, 9.0, 3000.0)


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


def lifted_trochoid(turns: int, radius: float, step: float, feed: float) -> str:
    """Return a program of half circles that cut, each with a way back on a helix that lifts the tool, and a plunge."""
    found = [f"F{feed:g}", f"G1 X{radius:g}"]
    for turn in range(turns):
        x = step * turn
        found.append(f"G2 X{x - radius:.4f} Y0 I{-radius:g} J0")
        found.append(f"G2 X{x + radius + step:.4f} Y0 I{radius + 0.5 * step:g} J0 Z0.5")
        found.append("G1 Z0")
    return "\n".join(found)


def adaptive(turns: int, radius: float, step: float, feed: float) -> str:
    """Return a program of half circles that cut, each with a way back that quarter helices lift and lower."""
    found = [f"F{feed:g}", f"G1 X{radius:g}"]
    for turn in range(turns):
        x = step * turn
        found.append(f"G2 X{x - radius:.4f} Y0 I{-radius:g} J0")
        found.append(f"G2 X{x - radius + 1.0:.4f} Y1 I1 J0 Z0.3")
        found.append(f"G1 X{x + radius + step - 1.0:.4f} Y1 F6000")
        found.append(f"G2 X{x + radius + step:.4f} Y0 I0 J-1 Z0 F{feed:g}")
    return "\n".join(found)


def threads(count: int, radius: float, pitch: float, feed: float) -> str:
    """Return a program that mills threads from below, with half circles that lead in and out."""
    found = []
    for hole in range(count):
        x, z = 20 * hole, -9.0 + 0.25 * pitch
        found += ["G0 Z2", f"G0 X{x} Y0", "G1 Z-9 F900", f"F{feed:g}"]
        found.append(f"G3 X{x + radius:g} Y0 I{0.5 * radius:g} J0 Z{z:.4f}")
        for _ in range(3):
            z += pitch
            found.append(f"G3 X{x + radius:g} Y0 I{-radius:g} J0 Z{z:.4f}")
        found += [f"G3 X{x} Y0 I{-0.5 * radius:g} J0 Z{z + 0.25 * pitch:.4f}", "G0 Z2"]
    return "\n".join(found)


def helical_pocket(turns: int, radius: float, pitch: float, feed: float) -> str:
    """Return a program that goes down on full circles and clears the bottom."""
    down = [f"G3 X{radius:g} Y0 I{-radius:g} J0 Z{-pitch * turn:.3f}" for turn in range(1, turns + 1)]
    first = [f"F{feed:g}", f"G1 X{radius:g}"]
    return "\n".join([*first, *down, f"G3 X{radius:g} Y0 I{-radius:g} J0", "G1 X0", "G0 Z5"])


def cone(turns: int, growth: float, pitch: float, feed: float) -> str:
    """Return a program of half turns of helices that touch, each larger than the one before it."""
    found, x = [f"F{feed:g}"], 0.0
    for turn in range(turns):
        radius = (0.5 + growth * turn) * (1 if turn % 2 == 0 else -1)
        x += 2.0 * radius
        found.append(f"G3 X{x:.4f} Y0 I{radius:.4f} J0 Z{-pitch * (turn + 1):.3f}")
    return "\n".join(found)


def waves(count: int, width: float, feed: float) -> str:
    """Return a program of helices that meet in corners and rise and fall in turn."""
    found, z = [f"F{feed:g}"], 0.0
    for number, rise in zip(range(count), cycle((1.0, -2.0, 0.5, 0.7, -0.4, 1.5)), strict=False):
        z += rise
        x = width * (number + 1)
        found.append(f"G{2 if number % 2 else 3} X{x:.4f} Y0 R{width / 1.8:.4f} Z{z:.3f}")
    return "\n".join(found)


def zigzag(turns: int, feed: float) -> str:
    """Return a program of long lines joined by half circles that touch them."""
    found = [f"F{feed:g}"]
    for y in 3.2 * np.arange(turns):
        found += [f"G1 X30 Y{y:.3f}", f"G3 X30 Y{y + 1.6:.3f} I0 J0.8"]
        found += [f"G1 X0 Y{y + 1.6:.3f}", f"G2 X0 Y{y + 3.2:.3f} I0 J0.8"]
    return "\n".join(found)


def islands(centers: np.ndarray, feed: float) -> str:
    """Return a program that positions, plunges, and goes round an island of 39 lines, for each centre."""
    turn = np.linspace(0.0, 2.0 * math.pi, 40)
    radius = 6.0 + 1.2 * np.sin(5.0 * turn)
    found = []
    for x, y in centers:
        found += ["G0 Z3", f"G0 X{x + 6.0:.4f} Y{y:.4f}", "G1 Z-1 F600"]
        found.append(lines(x + radius * np.cos(turn), y + radius * np.sin(turn), -1.0 + 0.0 * turn, feed))
    return "\n".join([*found, "G0 Z5"])


def slots(count: int, feed: float) -> str:
    """Return a program of lines and arcs that meet at angles."""
    found, y = [f"F{feed:g}"], 0.0
    for number in range(count):
        x = 1.5 * number
        found += [f"G1 X{x + 8.0:.4f} Y{y:.4f}", f"G2 X{x + 8.0:.4f} Y{y - 3.0:.4f} I-1 J-1.5"]
        found.append(f"G1 X{x:.4f} Y{y - 6.0:.4f}")
        y = -6.0 if number % 2 else -2.0
        found.append(f"G1 X{x + 1.5:.4f} Y{y:.4f}")
    return "\n".join(found)


def scallops(count: int, radius: float, feed: float) -> str:
    """Return a program of arcs that meet in cusps, every third on the other side."""
    width = 2.0 * radius * math.sin(1.0)
    codes = [f"G{2 if number % 3 else 3}" for number in range(count)]
    blocks = (f"{code} X{width * number:.4f} Y0 R{radius:.4f}" for number, code in enumerate(codes, 1))
    return f"F{feed:g}\n" + "\n".join(blocks)


def chain(rng: np.random.Generator, count: int, feed: float) -> str:
    """Return a program of lines of 1 to 20 mm and arcs of 1 to 12 mm radius that meet at any angle."""
    found, x, y, heading = [f"F{feed:g}"], 0.0, 0.0, 0.0
    for _ in range(count):
        heading += rng.uniform(-2.6, 2.6)
        if rng.random() < 0.5:
            radius, side = math.exp(rng.uniform(0.0, math.log(12.0))), rng.choice([-1, 1])
            sweep = side * rng.uniform(0.3, 4.5)
            center_x = round(x - side * radius * math.sin(heading), 5)
            center_y = round(y + side * radius * math.cos(heading), 5)
            radius = math.hypot(x - center_x, y - center_y)
            angle = math.atan2(y - center_y, x - center_x) + sweep
            end_x = round(center_x + radius * math.cos(angle), 5)
            end_y = round(center_y + radius * math.sin(angle), 5)
            word = f"G{3 if side > 0 else 2} X{end_x:.5f} Y{end_y:.5f}"
            found.append(f"{word} I{center_x - x:.5f} J{center_y - y:.5f}")
            heading += sweep
        else:
            length = math.exp(rng.uniform(0.0, math.log(20.0)))
            end_x, end_y = round(x + length * math.cos(heading), 5), round(y + length * math.sin(heading), 5)
            found.append(f"G1 X{end_x:.5f} Y{end_y:.5f}")
        x, y = end_x, end_y
    return "\n".join(found)


def with_feeds(program: str, feeds: tuple[int, ...]) -> str:
    """Return a program whose blocks have these feeds in turn."""
    first, *blocks = program.splitlines()
    return "\n".join(
        [first, *(f"{block} F{feed}" for block, feed in zip(blocks, cycle(feeds), strict=False))]
    )


def run_linuxcnc(folder: Path, files: list[Path]) -> dict[str, float]:
    """Return the time in which the path moved, s, by the name of the file."""
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
    found = dict(re.findall(r"^RESULT (\S+) (\d+)$", done.stdout, re.MULTILINE))
    missing = [file.name for file in files if file.name not in found]
    if missing:
        sys.exit(f"LinuxCNC did not run {missing[0]}:\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    return {name: CYCLE_S * int(cycles) for name, cycles in found.items()}


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
loadrt sampler depth=60000 cfg=fff
addf sampler.0 servo-thread
net x joint.0.motor-pos-cmd => joint.0.motor-pos-fb
net y joint.1.motor-pos-cmd => joint.1.motor-pos-fb
net z joint.2.motor-pos-cmd => joint.2.motor-pos-fb
net x => sampler.0.pin.0
net y => sampler.0.pin.1
net z => sampler.0.pin.2
net enable iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net change iocontrol.0.tool-change => iocontrol.0.tool-changed
"""
DISPLAY = '''\
#!/usr/bin/env python3
"""Run the listed programs one after the other; print in how many servo cycles the path moved."""
import os, subprocess, time
import linuxcnc
MOVES_MM = 2e-6  # in a cycle
PAUSE = 200  # cycles; what lies before is the way to the start
def cycles(name):
    moving, last = [], None
    for line in open(name):
        words = line.split()
        if len(words) != 4:
            continue
        point = [float(word) for word in words[1:]]
        if last and max(abs(a - b) for a, b in zip(point, last)) > MOVES_MM:
            moving.append(int(words[0]))
        last = point
    first = moving[0]
    for before, after in zip(moving, moving[1:]):
        if after - before > PAUSE:
            first = after
    return moving[-1] - first
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
    sampler = subprocess.Popen(["halsampler", "-t", name + ".trace"])
    time.sleep(0.5)
    command.mode(linuxcnc.MODE_AUTO); done()
    command.program_open(name); done()
    began = time.monotonic()
    command.auto(linuxcnc.AUTO_RUN, 0)
    while time.monotonic() - began < 600.0:
        status.poll()
        if time.monotonic() - began > 0.3 and status.interp_state == linuxcnc.INTERP_IDLE:
            break
        time.sleep(0.01)
    time.sleep(0.1)
    sampler.terminate(); sampler.wait()
    print("RESULT %s %d" % (os.path.basename(name), cycles(name + ".trace")), flush=True)
    os.remove(name + ".trace")
'''

if __name__ == "__main__":
    main()
