"""What the guides for those who extend polycnc say is all that it takes: done in a copy."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import polycnc
from support.pages import REPOSITORY, Fence, fences

_PREPARES = """
import json, sys
from polycnc.machine import Machine, load_machine
from polycnc.nc import Channel, ProgramText, load_dialect
found = []
for text in sys.argv[2:]:
    channel = Channel(ProgramText.from_text(text), load_dialect(sys.argv[1]), Machine(load_machine("mill3")))
    channel.fill()
    seg, tail = channel.machine.state.seg, int(channel.machine.state.paths.row[0]["tail"])
    found.append([seg.end[:tail].tolist(), str(channel.error or "")])
print(json.dumps(found))
"""


def _prepared(source: Path, dialect: Path, *programs: str) -> list[tuple[list[list[float]], str]]:
    """Return the end points of the moves, and the error, of programs prepared by a copy of the package."""
    run = subprocess.run(
        [sys.executable, "-c", _PREPARES, str(dialect), *programs],
        env={**os.environ, "PYTHONPATH": str(source), "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    return [(ends, error) for ends, error in json.loads(run.stdout)]


def _copy(folder: Path) -> Path:
    """Return a copy of the package in a folder; what is not changed keeps its byte code, which goes by its time."""
    package = folder / "polycnc"
    shutil.copytree(
        Path(polycnc.__file__).parent, package, ignore=shutil.ignore_patterns("*-pytest-*", "front")
    )
    return package


_LINKS = """
import json, sys
from polycnc.nc.cpl import Linker, Run
from support.cpl_host import RecordingHost
found = []
for text in sys.argv[1:]:
    host = RecordingHost()
    linker = Linker(host.program)
    main, errors = linker.link(text, "main.cpl")
    run = main and Run(main, linker, host)
    while run and run.step() is not None:
        pass
    found.append([run.globals if run else {}, [str(error) for error in errors]])
print(json.dumps(found))
"""


def test_a_cpl_function_is_one_decorated_function(tmp_path: Path) -> None:
    package = _copy(tmp_path)
    page = REPOSITORY / "docs" / "how-to" / "add-a-cpl-function.md"
    (function,) = (each for each in fences(page) if each.title)
    with (package / function.title).open("a", encoding="utf-8") as file:
        file.write(f"\n\n{function.text}")
    programs = (
        "1 A=5 : #A=HYP(A,12) : #B=HYP(3,4,12)",
        "1 #A=HYP(5)",
        '1 #A=HYP(5,"12")',
        "1 HYP=3",
    )
    run = subprocess.run(
        [sys.executable, "-c", _LINKS, *programs],
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join((str(tmp_path), str(REPOSITORY / "tests"))),
            "NUMBA_DISABLE_JIT": "1",
        },
        capture_output=True,
        text=True,
        check=True,
    )
    (values, _), *refused = json.loads(run.stdout)
    assert values == {"#A": 13, "#B": 13}
    number = "HYP takes 2 to 3 arguments, not "
    whats = (f"{number}1", "HYP takes a number, not a string", f"{number}0")
    for (_, errors), what in zip(refused, whats, strict=True):
        assert what in errors[0]


def _put(file: Path, text: str, before: str) -> None:
    """Write text into a file before what stands there once."""
    content = file.read_text(encoding="utf-8")
    assert content.count(before) == 1, (file, before)
    file.write_text(content.replace(before, text + before), encoding="utf-8")


_CALLS = """
import asyncio, threading
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.imc import Card, imclib
from polycnc.machine import Host
from polycnc.runner import WallClock
from polycnc.servers.focas import FocasServer, load_profile

control = PowerMate(2)
control.programs.register(1234, "O1234\\nG4X7.\\nM30\\n")
control.select_program(1234)
control.cycle_start()
control.advance(50)
fwlib.attach(0, control)
code, handle = fwlib.cnc_allclibhndl()
print(*fwlib.cnc_exeprgname(handle))
print(fwlib.FUNCTIONS["cnc_exeprgname"].prototype, fwlib.STRUCTURES["ODBEXEPRG"].size)

ready = threading.Event()

async def serve():
    global port, end, loop
    loop, end = asyncio.get_running_loop(), asyncio.Event()
    with Host(control, WallClock(), rate=0.0) as host:
        server = FocasServer(host, control, load_profile("31i"), port=0)
        await server.start()
        port = server.port
        ready.set()
        await end.wait()
        await server.close()

thread = threading.Thread(target=lambda: asyncio.run(serve()))
thread.start()
ready.wait()
code, remote = fwlib.cnc_allclibhndl3("127.0.0.1", port, 10)
print(*fwlib.cnc_exeprgname(remote))
fwlib.cnc_freelibhndl(remote)
loop.call_soon_threadsafe(end.set)
thread.join()

imclib.attach(card := Card())
imclib.IMC_FindNetCard(imclib.NIC_INFO())
status, handle = imclib.IMC_Open(0, 0)
imclib.IMC_SetParam32(handle, imclib.mcstgvelLoc, 13 << 16, 2, imclib.SEL_IFIFO)
print(imclib.IMC_GetParam32(handle, imclib.mcstgvelLoc, 2)[1] >> 16, imclib.IMC_Stop(handle, 2, imclib.SEL_IFIFO).name)
print(imclib.IMC_GetParam32(handle, imclib.mcstgvelLoc, 2)[1], imclib.FUNCTIONS["IMC_Stop"].prototype)
"""


def test_a_library_function_is_declared_once(tmp_path: Path) -> None:
    package = _copy(tmp_path)
    structure, function, row, motion, expansion = (
        each for each in fences(REPOSITORY / "docs" / "how-to" / "add-a-library-function.md") if each.title
    )
    library = package / "controllers" / "fanuc" / "library"
    _put(package / structure.title, f"#pragma pack(2)\n{structure.text}", "#pragma pack(4)")
    module = package / function.title
    with module.open("a", encoding="utf-8") as file:
        file.write(f"\n\n{function.text}")
    _put(
        module,
        "from polycnc.controllers.fanuc.library._structs import ODBEXEPRG\n",
        "from polycnc.cnc import",
    )
    _put(library / "_remote.py", row.text, '}\n"""The functions that read one record')
    _put(package / motion.title, motion.text, '}\n"""By name: arguments before')
    _put(package / expansion.title, expansion.text, '}\n"""What each function writes')

    run = subprocess.run(
        [sys.executable, "-c", _CALLS],
        env={**os.environ, "PYTHONPATH": str(tmp_path), "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines() == [
        "0 ODBEXEPRG(name=b'O1234', o_num=1234)",
        "short cnc_exeprgname(unsigned short FlibHndl, ODBEXEPRG *exeprg) 40",
        "0 ODBEXEPRG(name=b'O1234', o_num=1234)",
        "13 IMC_OK",
        "0 IMC_STATUS IMC_Stop(IMC_HANDLE Handle, IMC32 axis, int fifoSel)",
    ]


def test_a_g_code_is_one_row_and_one_function(tmp_path: Path) -> None:
    package = _copy(tmp_path)
    row, function, dialect = (
        each for each in fences(REPOSITORY / "docs" / "how-to" / "add-a-g-code.md") if each.title
    )
    actions, module, own = package / row.title, package / function.title, tmp_path / dialect.title
    mark = "    # fmt: on\n"
    text = actions.read_text(encoding="utf-8")
    assert text.count(mark) == 1
    actions.write_text(text.replace(mark, row.text + mark), encoding="utf-8")
    with module.open("a", encoding="utf-8") as file:
        file.write(f"\n\n{function.text}")
    own.write_text(dialect.text, encoding="utf-8")

    (ends, error), (_, refused), (_, unused) = _prepared(
        tmp_path,
        own,
        "G90 G0 X3 Y4 Z5\nG31.7 X23 Y14 Z2 R17\n",
        "G31.7 X23\n",
        "G31.7 X23 R17 Q3\n",
    )
    assert error == ""
    assert ends == [[3, 4, 5], [3, 4, 17], [23, 14, 17], [23, 14, 2]]
    assert "1:1" in refused
    assert "G31.7 without a level" in refused
    assert "Add R." in refused
    assert "'Q' has no meaning in this block" in unused


def _fences(page: str) -> list[Fence]:
    """Return the blocks of a guide that go into files."""
    return [each for each in fences(REPOSITORY / "docs" / "how-to" / page) if each.title]


def _printed(source: Path, text: str) -> list[str]:
    """Return the lines that a piece of Python prints with a copy of the package."""
    run = subprocess.run(
        [sys.executable, "-c", text],
        env={**os.environ, "PYTHONPATH": str(source), "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.splitlines()


_ROUTES = """
from polycnc import run
from polycnc.nc import ProgramText, choose_dialect
from polycnc.errors import ProgramError
text = "%ROUTER\\nG91 G1 X125 Y-30 F600000\\nM30\\n"
for name, content in (("a.nc", text), ("a.rtr", "M30\\n"), ("a.nc", "M30\\n")):
    chosen = choose_dialect(ProgramText.from_text(content, name))
    print(chosen.dialect.name, chosen.reason)
result = run(ProgramText.from_text(text.partition("\\n")[2], "a.rtr"))
print({name: round(value, 9) for name, value in result.end_position_mm.items()})
try:
    run(ProgramText.from_text("G43 H3\\n", "a.rtr"))
except ProgramError as error:
    print(str(error).splitlines()[0])
"""


def test_a_dialect_is_a_file_and_its_name(tmp_path: Path) -> None:
    package = _copy(tmp_path)
    file, name, sign = _fences("add-a-dialect.md")
    (package / file.title).write_text(file.text, encoding="utf-8")
    _put(package / name.title, f"{name.text.strip()} ", '"bosch")')
    _put(package / sign.title, sign.text, '    _sign("grbl", ')
    assert _printed(tmp_path, _ROUTES) == [
        "router %ROUTER in line 1",
        "router ",
        "din ",
        "{'X': 1.25, 'Y': -0.3, 'Z': 0.0}",
        "a.rtr:1:1: G43 is not supported yet (1 block has it)",
    ]


_CURVES = """
import numpy as np
from polycnc import run
from polycnc.machine import parse_machine, preset_text
from polycnc.nc import ProgramText
text = ProgramText.from_text("G0 X0 Y0\\nG2 X0 Y0 I5 J0 F60000\\nM30\\n")
for key in ("", "curve_acceleration_mm_s2 = 720.0"):
    machine = parse_machine(preset_text("mill3") + "\\n[path]\\n" + key + "\\n", "mill.toml")
    trace = run(text, machine, trace=True).trace
    speed = np.hypot(*np.diff(trace.setpoint[:, :2], axis=0).T) / machine.cycle_s
    print(round(float(speed.max()), 3))
"""


def test_a_planner_rule_is_a_few_lines(tmp_path: Path) -> None:
    package = _copy(tmp_path)
    number, rule, key, given = _fences("add-a-planner-rule.md")
    _put(package / number.title, number.text, '        ("corner_deviation_mm", np.float64)')
    _put(package / rule.title, rule.text, '    cap = min(asked_mm_s, path["speed_limit_mm_s"], most)\n')
    _put(package / key.title, key.text, "    junction_deviation_mm: ")
    _put(package / given.title, given.text, '        rows["rounding_share"] = ')
    without, limited = map(float, _printed(tmp_path, _CURVES))
    assert without > 100.0
    assert limited == 60.0  # the root of 720 mm/s2 by 5 mm


def test_a_controller_is_a_device_and_its_functions(tmp_path: Path) -> None:
    package = _copy(tmp_path)
    page = "add-a-controller.md"
    for each in _fences(page):
        file = package / each.title
        file.parent.mkdir(exist_ok=True)
        file.write_text(each.text, encoding="utf-8")
    (program,) = (each for each in fences(REPOSITORY / "docs" / "how-to" / page) if not each.title)
    shown = """
print(*stagelib.stage_position(stage, 1))
print(stagelib.stage_move(stage, 3, 2.5, 50.0).name, stagelib.stage_move(stage, 0, 2.5, -1.0).name)
print(*stagelib.stage_position(stage + 4, 1), *stagelib.stage_open(1))
print(stagelib.FUNCTIONS["stage_position"].prototype)
print(round(stagelib.LIBRARY.default.stages[0].time_s, 3))
"""
    assert _printed(tmp_path, program.text + shown) == [
        "0 12.5",
        "NOT_THERE RANGE",
        "1 0.0 2 0",
        "int stage_position(int stage, int axis, double *position)",
        "0.261",  # 12.5 mm with 50 mm/s, ramps of 5000 mm/s2, and a cycle for the last call
    ]
