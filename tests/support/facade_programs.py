"""The C programs of examples/c: what each needs, is given to read, and has to print."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.servers.process import Machinery

EXAMPLES = Path(__file__).parents[2] / "examples"
SYSTEM = EXAMPLES / "apci_system.dat"


def facade_says() -> str:
    """Return what the program `fanuc_macro` prints."""
    session = fwlib.Session()
    session.attach(0, PowerMate(3, characters=128_000))
    _, handle = session.cnc_allclibhndl()
    write = session.cnc_wrmacro(handle, 103, 10, 271828, 5)
    code, macro = session.cnc_rdmacro(handle, 103, 10)
    read, at = session.cnc_absolute(handle, fwlib.ALL_AXES, 16)
    short, _ = session.cnc_absolute(handle, fwlib.ALL_AXES, 15)
    found, parameter = session.cnc_rdparam(handle, 1420, 1, 8)
    lines = (
        "open 0", f"write {write:d}", f"macro {code:d}: {macro.mcr_val} {macro.dec_val}",
        f"position {read:d}: {at.data[0]} {at.data[1]} {at.data[2]}", f"too short {short:d}",
        f"parameter {found:d}: {parameter.u.ldata}", "free 0",
    )  # fmt: skip
    return "".join(f"{line}\n" for line in lines)


@dataclass(frozen=True)
class CProgram:
    """A program: `said` is what it prints when it reads `given`; `file` is the file of its machine."""

    said: str | Callable[[], str]
    given: str = ""
    file: str = ""

    @property
    def expected(self) -> str:
        """What it prints."""
        return self.said if isinstance(self.said, str) else self.said()

    @property
    def machinery(self) -> Machinery:
        """The machine that it is for."""
        return Machinery(file=EXAMPLES / self.file if self.file else None)


_TWICE = "go\ngo\n"
COLLECTED = {
    "fanuc": "mode 1, run 0, program 0, at 0 0, feed 0, alarms 0",
    "apci": "at 0.000 0.000 0.000, real 0.000, velocity 100.0, errors 0",
    "imc": "at 0 0, encoders 0 0, errors 0 0",
}
"""What a collector says of a sample, by the kind of its machine."""
C_PROGRAMS = {
    "fanuc_macro": CProgram(facade_says),
    "fanuc_events": CProgram(
        "mode 1, run 0, motion 0, emergency 0, alarm 0\n#500 = 3.0\n#501 = 1.0\n#502 = 0.0\n"
        "too short 2\nfree 0\nfree again -8\n"
    ),
    # What the samples of the manual print and read: the directory of 6.6, ` 00001.500` and `-00001.500`, 250 as a word.
    "fanuc_manual": CProgram(
        "open 0\ncontrol PM H of 6 axes,  3 of them controlled\nNO ALARM\npreset 0, read 0: 120005\nedit 0\n"
        "download 0, 0\nupload 0 10[%|O0012(TE] 10[ST)|G1F0.3] 10[W10.|M30|%] end 0\n"
        "directory 0: O12O1234%\ndirectory 0: %|O12(TEST)|O1234()|%\ndirectory 0: O12(TEST)27O1234()47%\n"
        "search 0, delete 0, again 5, without a start 1, start 0, twice -1, nothing came 5\n"
        "offsets 0, read 0: 1000 to 1686, one 0: 1014\nM codes 0, the last 0: 69\nlimit 0, read 0: 400000\n"
        "axes 0: X Y Z\nmacro 0, read 0 [ 00001.500]\n"
        "macros 0, read 0 [ 00001.500] [-00001.500] [ 00000.025]\n"
        "D100 0, read 0: 250, bytes 0: 250 0\nR200 0, read 0: all bytes together 0\nfree 0\n"
    ),
    "fanuc_gantry": CProgram("open 0\nhome 0 0\nat 5000 20000\nwaited for a buffer 1\nfree 0\n"),
    "apci_jog": CProgram("init 0, board 4, 3 axes\nat 12.500\n", file="apci_system.dat"),
    # the arc of the gantry is half a circle around (60, 25) from (60, 0)
    "apci_gantry": CProgram(
        "init 0, 3 axes\nhomed 3 axes\nat 60.000 50.000 0.000\nerrors 0\n", file="apci_system.dat"
    ),
    # the slave of the shaft turns by 0.5, 0.25 and 0.4 of the master's 20, 10 and -25 mm
    "apci_shaft": CProgram(
        "init 0\nturn 1: at 20.000 10.000, mark passed 1 times\n"
        "turn 2: at 30.000 12.500, mark passed 0 times\nturn 3: at 5.000 2.500, mark passed 1 times\nerrors 0\n",
        file="apci_system.dat",
    ),
    "apci_collector": CProgram(
        f"init 0\n1: {COLLECTED['apci']}\n2: {COLLECTED['apci']}\n", _TWICE, "apci_system.dat"
    ),
    "imc_move": CProgram(
        "adapters 0: 1\nopen 0\nmove 0\nat 6250, moving 0\nclose 0\n", file="imc_gantry.toml"
    ),
    "imc_contour": CProgram("open 0\nat 3000 6000\nerrors 0\nclose 0\n", file="imc_gantry.toml"),
    # the gears of the shaft are 0.5 and -1
    "imc_line_shaft": CProgram(
        "open 0\nbefore: the cutter is at 0\nafter: the cutter runs as the master: 1\n"
        "slaves by the master: 0.50 -1.00\nclose 0\n",
        file="imc_gantry.toml",
    ),
    "imc_gantry": CProgram("open 0\nhomed 2 axes\nat 2000 6000\nclose 0\n", file="imc_gantry.toml"),
    "imc_collector": CProgram(
        f"open 0\n1: {COLLECTED['imc']}\n2: {COLLECTED['imc']}\nclose 0\n", _TWICE, "imc_gantry.toml"
    ),
}
"""By name, which begins with the kind of the library. `fanuc_collector` is told where the control is."""
