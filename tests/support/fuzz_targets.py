# ruff: noqa: E501  (programs and numbers are longer than lines)
"""The fuzz targets: every reader, the commands, and the calls of every function library."""

from __future__ import annotations

import contextlib
import io
import json
import os
import random
import shutil
import tempfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from typer.testing import CliRunner

from polycnc import runner
from polycnc.cli._app import app
from polycnc.cnc import Control
from polycnc.controllers.apci import Board, pcap, sap
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.wire import Frame, FrameType, Request, write_requests
from polycnc.controllers.imc import Card, imclib, parse_card
from polycnc.errors import PolycncError
from polycnc.machine import Machine, Snapshot, Store, load_machine, parse_toml, preset_text
from polycnc.nc import ProgramText
from polycnc.post import CONTROLS, parse_control, shipped_text
from polycnc.servers.focas import COMMANDS, PROFILES, FocasControl, Session, load_profile
from support.fuzzing import NUMBERS, Target, TookTooLong, changed, changed_bytes, value_for
from support.imc_network import opened
from support.power_mate import attached
from support.sap_board import FakeBoard

ENDLESS = (TookTooLong,)
ROOT = Path(__file__).resolve().parents[2]
MILL = load_machine("mill3")


def _texts(*places: str) -> tuple[str, ...]:
    paths = [path for place in places for path in sorted(ROOT.glob(place))]
    assert paths, places
    return tuple(path.read_text("utf-8", "replace")[:4000] for path in paths)


def _changed_one_of(texts: tuple[str, ...]) -> Callable[[random.Random], str]:
    return lambda chance: changed(chance, chance.choice(texts))


WORDS = (
    "G0 X10 Y5 Z3\nG1 Z-2 F200\nG2 X20 Y5 I5 J0\nG3 X10 Y5 R5\nG41 D1 G1 X30 Y9\nX40\nG40 Y0\nG4 P2\nM3 S900\nM5\nM30\n",
    "G90 G54\nG81 X1 Y2 Z-5 R2 F100\nX9\nG83 X3 Z-9 R1 Q2\nG80\nG93 G1 X3 F2\nG94 F90\nG95 S600 M3 F.2 X9\nM30\n",
    "G92 X3\nG68 X0 Y0 R30\nG1 X9 F90\nG69\nG51 X0 Y0 P2\nX3\nG50\nG16 X9 Y30\nG15\nG10 L2 P1 X3\nM98 P1000 L3\nM30\nO1000\nG1 X1 F90\nM99\n",
)
MACROS = (
    "O1\n#1=3\n#100=#1*[2+SIN[30]]\nIF [#100 GT 4] GOTO 20\nN10 G1 X#100 F200\nN20 WHILE [#1 LT 6] DO1\n#1=#1+1\nG1 X[#1*2] F90\nEND1\n"
    "G65 P100 A1 B2 I3\nM30\nO100\n#33=#1/#2\nG1 Y#33\nM99\n",
    "#500=ROUND[1.5]\n#501=FIX[2.7] MOD 2\n#[500+2]=ATAN[1]/[2]\nG66 P7 X3\nX1\nX2\nG67\nM30\nO7\n#3000=1(STOP)\nM99\n",
)
CPL = (
    '10 A%=3\n20 B=SIN(A%*10)\n30 IF A%>2 THEN\nG1 X[A%] F100\n40 ELSE\nG1 Y[B] F100\n50 ENDIF\n60 FOR I%=1 TO 3\nX[I%*2]\n70 NEXT I%\n75 DIM T$(20)\n80 T$="AB"+STR$(B)\n'
    '90 WAIT(,5)\n100 DIM F(3)\n110 F(2)=F(1)+1\n120 OPENW(1,"X",20)\n130 PRN#(1,A%,T$)\n140 CLOSE(1)\nM30\n',
    "5 I%=0\n10 REPEAT\n20 I%=I%+1\n30 UNTIL I%=3\n40 CASE I% OF\n50 LABEL 1: X=1\n60 LABEL 2,3: X=2\n70 ENDCASE\n80 WHILE I%<5 DO\n90 I%=I%+1\n100 END\nM30\n",
)
SAP = (
    "program p;\nvar a: array[1..5] of integer; i: integer; x: double;\nevent e on a[2] = 7; begin a[3] := 1; end;\n"
    "function f(y: double): double; begin f := y * 2; end;\nbegin\n for i := 1 to 3 do a[i] := i * 2;\n x := f(1.5);\n"
    " writeln('n', i:4, x:7:2);\n repeat i := i + 1 until i > 9;\n case i of 1: x := 1; 2..9: x := 2 end;\n wt(3);\n jr(A1:=100, A2:=50); A1.jac := 3;\nend.\n",
)
CARD = (
    "number_of_axes = 2\nready = true\n[depths]\nqfifo = 64\n[parameters]\ndelayus = 3\n[[axis]]\nlag_s = 0.01\norigin = [3.0, 9.0]\n"
    "[axis.index]\nfirst = 2.0\npitch = 100.0\n[axis.parameters]\nmaxvel = 3.5\n",
)
DIALECTS = tuple(
    path.read_text("utf-8") for path in sorted((ROOT / "src/polycnc/nc/dialects").glob("*.toml"))
)
PROGRAMS = (*WORDS, *_texts("tests/golden/*.nc", "examples/*.nc"))
TOOL_PATHS = (
    *_texts("examples/*.cl"),
    "UNITS/MM\nPARTNO A\nFROM/0,0,50\nLOADTL/3,LENGTH,20\nSPINDL/RPM,900,CLW\nCOOLNT/ON\nRAPID\nGOTO/10,20,5\nFEDRAT/300,MMPM\n"
    "GOTO/10,20,-3\nCIRCLE/15,20,-3,0,0,1,5\nGOTO/20,20,-3\nCYCLE/DRILL,9,MMPM,90,3\nGOTO/1,2,3\nCYCLE/OFF\nDELAY/2\nFINI\n",
)


class Places:
    """A folder for the files of cases, emptied for each."""

    def __init__(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="polycnc-fuzz-"))
        self._back = Path.cwd()

    def __enter__(self) -> Path:
        self._back = Path.cwd()
        for path in self.folder.iterdir():
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink()
        return self.folder

    def __exit__(self, *_: object) -> None:
        os.chdir(self._back)

    def write(self, name: str, content: str | bytes) -> Path:
        """Write a file; text that no file can hold is replaced."""
        with self as folder:
            path = folder / name
            path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8", "replace"))
            return path


PLACES = Places()

# ------------------------------------------------------------------ programs


def _program(dialect: str) -> Callable[[str], None]:
    def run(text: str) -> None:
        program = ProgramText.from_text(text, str(PLACES.folder / "p.nc"))
        runner.check(program, MILL, dialect, root=PLACES.folder)
        runner.run(program, MILL, dialect, check=False, root=PLACES.folder)

    return run


def _cpl(text: str) -> None:
    with PLACES as folder:
        program = ProgramText.from_text(text, str(folder / "p.npg"))
        runner.check(program, MILL, "bosch", root=folder)
        runner.run(program, MILL, "bosch", check=False, root=folder, keys=("ENTER", "F1", "A"))


# ------------------------------------------------------------------ readers


def _posted(name: str) -> Callable[[Any], None]:
    def run(case: tuple[str, str]) -> None:
        text, control = case
        runner.post_file(PLACES.write(name, text), control)

    return run


def _tool_path_case(texts: tuple[str, ...]) -> Callable[[random.Random], tuple[str, str]]:
    return lambda chance: (changed(chance, chance.choice(texts)), chance.choice(tuple(CONTROLS)))


def _control(text: str) -> None:
    control = parse_control(text, "c.toml")
    runner.post_file(PLACES.write("p.cls", TOOL_PATHS[-1]), control)


def _compiled(text: str) -> None:
    program, errors = sap.check(text, "p.sap", 0)
    if program is None:
        assert errors
        return
    _tasks(sap.write_cnc(program))


def _tasks(content: bytes) -> None:
    program = sap.read_cnc(content)
    board = FakeBoard()
    board.tasks.load(program)
    board.tasks.startcnct(program.task)
    for _ in range(8):
        board.scan += 1
        board.run_scan()
    board.tasks.rdcncts(program.task)


def _forged_case(chance: random.Random) -> bytes:
    body = json.loads(sap.write_cnc(sap.compile_program(SAP[0], "p.sap")).split(b"\n", 1)[1])
    for _ in range(chance.randint(1, 3)):
        code = chance.choice(body["code"])
        code[chance.randrange(3)] = chance.choice(
            (None, -1, 0, 1, 10**9, 2**70, 1e300, "x", [], [1], [0, 1, 3], {}, True, ["A1", "rp", "d", False])
        )
    data = json.dumps(body).encode()
    return b"POLYCNC-SAP 1 task=0 crc32=%08x size=%d\n" % (zlib.crc32(data), len(data)) + data


def _trace_case(chance: random.Random) -> tuple[str, bytes]:
    kind = chance.choice(("csv", "npz", "parquet"))
    if kind == "csv":
        text = (
            "t_s,block,feed_mm_s,X_mm,Y_mm\n0.001,1,10.0,0.5,0\n0.002,1,10.0,0.51,0\n0.003,2,9.5,0.52,0.25\n"
        )
        return kind, changed(chance, text).encode("utf-8", "replace")
    sink = io.BytesIO()
    columns = {name: np.arange(3.0) for name in ("t_s", "block", "feed_mm_s", "X_mm")}
    if kind == "npz":
        np.savez(sink, **columns)  # type: ignore[arg-type]
    else:
        import pyarrow
        import pyarrow.parquet

        pyarrow.parquet.write_table(pyarrow.table(columns), sink)
    return kind, changed_bytes(chance, sink.getvalue())


def _trace(case: tuple[str, bytes]) -> None:
    kind, content = case
    trace = runner.read_trace(PLACES.write(f"t.{kind}", content))
    assert trace.setpoint.shape == (len(trace.t_s), len(trace.axes))


_SNAPSHOT = Machine(MILL, segments=16).snapshot().to_bytes()


def _snapshot(content: bytes) -> None:
    Machine(MILL, segments=16).restore(Snapshot.from_bytes(content))


def _store_bytes() -> bytes:
    with PLACES as folder:
        with Store(folder / "m.db") as store:
            store.area("tools", dict).save({number: {"length": number * 1.5} for number in range(9)})
            store.history("alarms").append({"number": 7})
        return (folder / "m.db").read_bytes()


_STORE = _store_bytes()


def _store(content: bytes) -> None:
    path = PLACES.write("m.db", content)
    with Store(path) as store:
        area = store.area("tools", dict)
        for key in area:
            area.attributes(key)
        area.load()
        store.history("alarms").read()
        store.history("alarms").append({"number": 8})
        area[3] = {"length": 2.5}


_CODES = tuple(key[-1] if isinstance(key, tuple) else key for key in COMMANDS)


def _frames_case(chance: random.Random) -> bytes:
    requests = [Request(chance.choice(_CODES), (chance.choice((0, 1, -1, 9000)), 2, 3, 0)) for _ in range(3)]
    kinds = [FrameType.COMMANDS, chance.choice(tuple(FrameType)), FrameType.CLOSE]
    content = bytes(Frame(FrameType.OPEN, b"\0\2"))
    content += b"".join(bytes(Frame(kind, write_requests(requests))) for kind in kinds)
    return (
        changed_bytes(chance, content) if chance.random() < 0.9 else chance.randbytes(chance.randint(0, 300))
    )


_POWER_MATE: list[PowerMate] = []


def _frames(content: bytes) -> None:
    if not _POWER_MATE:
        _POWER_MATE.append(PowerMate())
    session = Session(FocasControl(_POWER_MATE[0], load_profile(next(iter(PROFILES)))))
    half = len(content) // 2
    session.receive(content[:half])
    session.receive(content[half:])
    session.lost()


def _parameter_file(text: str) -> None:
    control, handle = attached()
    for line in text.split("\n"):
        fwlib.cnc_dwnstart(handle)
        fwlib.cnc_download(handle, line.encode("utf-8", "replace")[:256], min(len(line), 256))
        fwlib.cnc_dwnend(handle)
    control.advance(3)


# ------------------------------------------------------------------ commands


def _command_case(chance: random.Random) -> list[Any]:
    machine, control = preset_text("mill3"), shipped_text("din")
    texts = {
        "p.nc": chance.choice(WORDS), "p.npg": CPL[0], "m.toml": machine, "p.cls": TOOL_PATHS[-1],
        "c.toml": control, "p.sap": SAP[0], "k.txt": "ENTER\nA\n",
    }  # fmt: skip
    name = chance.choice(tuple(texts))
    texts[name] = changed(chance, texts[name])
    word = chance.choice(
        (
            ".",
            "",
            "none/x.csv",
            "t.csv",
            "p.nc",
            "m.toml",
            "/dev/null",
            "x" * 300,
            "t.npz",
            "-",
            "-1",
            *NUMBERS[:14],
        )
    )
    lines = (
        ["run", "p.nc", "--json"], ["run", "p.nc", "-m", "m.toml"], ["run", "p.npg", "-d", "bosch", "--keys", "k.txt"],
        ["run", "p.nc", "--trace", word], ["run", "p.nc", "--skip", word], ["run", word], ["run", "p.nc", "-d", word],
        ["check", "p.nc", "p.npg", word], ["check", "p.nc", "-m", "m.toml"], ["post", "p.cls", "-c", "c.toml"],
        ["post", "p.cls", "-c", "din", "-o", word], ["post", "p.cls", "-c", "din", "--verify", "-m", "m.toml"],
        ["post", word, "-c", word], ["machine", "m.toml"], ["machine", word], ["machine", word, "--json"],
        ["sap", "compile", "p.sap"], ["sap", "compile", "p.sap", "-o", word, "--task", word], ["conformance", word],
        ["run", "p.npg", "-d", "bosch", "--screen", word], ["view", "p.nc", "-o", word], [word, word],
        ["post", "-c", word, "--show-control"], ["machine", "m.toml", "--toml"], ["debug", "p.nc", word],
    )  # fmt: skip
    return [texts, chance.choice(lines)]


def _command(case: list[Any]) -> None:
    texts, arguments = case
    with PLACES as folder:
        for name, text in texts.items():
            (folder / name).write_bytes(text.encode("utf-8", "replace"))
        os.chdir(folder)
        if any("\0" in each or "\ud800" in each for each in arguments):
            return  # no process can be started so
        told = CliRunner().invoke(app, arguments)
        assert told.exit_code in (0, 1, 2), (told.exit_code, told.output, told.stderr)
        assert "Traceback" not in told.output + told.stderr
        left = sorted(
            path.name for path in folder.iterdir() if path.name.startswith(".") and path.name not in arguments
        )
        assert not left, left


# ------------------------------------------------------------------ libraries


def _calls(names: tuple[str, ...], most: int = 6) -> Callable[[random.Random], list[Any]]:
    def case(chance: random.Random) -> list[Any]:
        return [(chance.choice(names), chance.getrandbits(48)) for _ in range(most)]

    return case


_USUAL = (0, 1, 2, 3, 5, -1, 100, 1000, 0.5, 2.5)


def _pcap_argument(chance: random.Random, c: str, records: Any) -> Any:
    kind = c.replace("*", "").strip()
    if kind == "TSRP" and chance.random() < 0.9:
        record = records[chance.randrange(len(records))]
        for field in ("rp", "dp", "tp", "tv", "jac", "jvl", "jtvl", "mcp", "kp", "n"):
            if chance.random() < 0.2 and hasattr(record, field):
                with contextlib.suppress(TypeError, ValueError, OverflowError):
                    setattr(record, field, value_for(chance, (1.0, 100.0)))
        return record
    if kind == "AS" and chance.random() < 0.9:
        with contextlib.suppress(TypeError, ValueError, OverflowError, IndexError):
            return pcap.AS.of(*(chance.choice((0, 1, 2, 7)) for _ in range(chance.randint(0, 3))))
    made = getattr(pcap, kind, None)
    if isinstance(made, type) and chance.random() < 0.8:
        return made()
    return value_for(chance, _USUAL)


def _pcap(calls: list[Any]) -> None:
    board = Board(parse_system_file(""))
    records, rosi = pcap.tsrp_array(), pcap.ROSI()
    pcap.attach(board, clock=None)
    pcap.InitMcuSystem3(records, rosi, 0, "system.dat")
    try:
        for name, seed in calls:
            chance = random.Random(seed)
            given = [_pcap_argument(chance, each.c, records) for each in pcap.FUNCTIONS[name].passed]
            with contextlib.suppress(PolycncError):
                getattr(pcap, name)(*given)
            board.advance(2)
        for axis in board.status().axes:
            assert axis is not None
    finally:
        pcap.detach()


def _imc(calls: list[Any]) -> None:
    card = Card(parse_card(CARD[0]))
    handle = opened(card, clock=None)
    for name, seed in calls:
        chance = random.Random(seed)
        function = imclib.FUNCTIONS[name]
        given = []
        for each in function.passed:
            made = getattr(imclib, each.c.replace("*", "").strip(), None)
            if "andle" in each.name and chance.random() < 0.95:
                given.append(handle)
            elif isinstance(made, type) and chance.random() < 0.7:
                given.append(made())
            else:
                given.append(value_for(chance, _USUAL))
        with contextlib.suppress(PolycncError):
            getattr(imclib, name)(*given)
        card.advance(2)


def _fwlib(calls: list[Any]) -> None:
    control, handle = attached()
    for name, seed in calls:
        chance = random.Random(seed)
        given = []
        for each in fwlib.FUNCTIONS[name].passed:
            made = getattr(fwlib, each.c.replace("*", "").strip(), None)
            if each.name == "FlibHndl" and chance.random() < 0.97:
                given.append(handle)
            elif isinstance(made, type) and chance.random() < 0.7:
                given.append(made())
            else:
                given.append(value_for(chance, (*_USUAL, 4, 8, 24, 500, 9000)))
        with contextlib.suppress(PolycncError):
            getattr(fwlib, name)(*given)
        control.advance(2)


_CONTROL_CALLS = ("select_mode", "set_overrides", "jog", "increment", "handwheel", "reference", "cycle_start", "reset",
                  "emergency_stop", "select_program", "feed_hold", "advance")  # fmt: skip


def _control_calls(calls: list[Any]) -> None:
    control = Control(MILL)
    for name, seed in calls:
        chance = random.Random(seed)
        given = [
            value_for(chance, ("X", "Y", "auto", "jog", 1, 0.5, "ref")) for _ in range(chance.randint(0, 2))
        ]
        if name == "advance":
            given = [chance.choice((0, 1, 5, -1))]
        with contextlib.suppress(
            PolycncError, TypeError, ValueError, AttributeError
        ):  # of Python: no mode, no text
            getattr(control, name)(*given)
        control.advance(2)


def _names(table: Any, but: tuple[str, ...] = ()) -> tuple[str, ...]:
    return tuple(sorted(set(table) - set(but)))


TARGETS = (
    Target("nc din", _changed_one_of(PROGRAMS), _program("din"), weight=2.0),
    Target("nc fanuc", _changed_one_of(PROGRAMS), _program("fanuc"), ENDLESS, limit_s=1.5, weight=2.0),
    Target("nc bosch", _changed_one_of(PROGRAMS), _program("bosch"), weight=2.0),
    Target("macro", _changed_one_of(MACROS), _program("fanuc"), ENDLESS, limit_s=1.5, weight=2.0),
    Target("cpl", _changed_one_of(CPL), _cpl, ENDLESS, limit_s=1.5, weight=2.0),
    Target("tool path", _tool_path_case(TOOL_PATHS), _posted("p.cls"), weight=2.0),
    Target("json path", _tool_path_case(_texts("examples/badge.json")), _posted("p.json")),
    Target("control file", _changed_one_of(tuple(map(shipped_text, CONTROLS))), _control),
    Target("machine file", _changed_one_of((preset_text("mill3"), preset_text("mill5"))), lambda text: load_machine(PLACES.write("m.toml", text))),
    Target("card file", _changed_one_of(CARD), parse_card),
    Target("system file", _changed_one_of(_texts("examples/apci_system.dat")), parse_system_file),
    Target("dialect file", _changed_one_of(DIALECTS), lambda text: runner.check("G1 X1 F9\nM30\n", MILL, str(PLACES.write("d.toml", text)))),
    Target("toml", _changed_one_of(('[a]\nb = [1, {c = "x"}]\n[[d.e]]\n"f g" = 1979-05-27\nh = """\nx\n"""\n',)), lambda text: parse_toml(text, "x.toml")),
    Target("sap", _changed_one_of(SAP), _compiled),
    Target("compiled sap", _forged_case, _tasks),
    Target("compiled sap bytes", lambda chance: changed_bytes(chance, _forged_case(chance)), _tasks),
    Target("trace", _trace_case, _trace),
    Target("snapshot", lambda chance: changed_bytes(chance, _SNAPSHOT), _snapshot),
    Target("store", lambda chance: changed_bytes(chance, _STORE), _store, (KeyError,)),
    Target("frames", _frames_case, _frames),
    Target("program transfer", _changed_one_of(("%\nO7\nN10 G1 X5. F6000\nM30\n%", "%\nN0100 P1\nN1020 A1P88 A2P90\n%")), _parameter_file, weight=0.3),
    Target("commands", _command_case, _command, ENDLESS, limit_s=4.0, weight=1.0),
    Target("pcap", _calls(_names(pcap.FUNCTIONS)), _pcap, weight=0.5),
    Target("imclib", _calls(_names(imclib.FUNCTIONS)), _imc, weight=0.5),
    Target("fwlib", _calls(_names(fwlib.FUNCTIONS), 10), _fwlib, weight=0.5),
    Target("control", _calls(_CONTROL_CALLS, 12), _control_calls, weight=0.3),
)  # fmt: skip
BY_NAME = {target.name: target for target in TARGETS}
