"""One device of each kind, made and moved the same way each time: what its snapshots are, as digests.

Run as a program it writes them as JSON, so that a test can compare processes with each other.
"""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from polycnc.cnc import Control
from polycnc.controllers.apci import Board, BoardTasks, parse_system_file
from polycnc.controllers.apci.board._axis_commands import cl
from polycnc.controllers.apci.board._jog_commands import ja, js
from polycnc.controllers.apci.sap import compile_program
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.fanuc import PowerMate
from polycnc.controllers.imc import Card, CardConfig
from polycnc.machine import Machine, load_machine
from polycnc.nc import ProgramText

SAP = "program p; var n: longint;\nbegin\n  while true do begin n := n + 1; ci[7] := n end\nend.\n"
BLOCKS = "G1 X7.3 F900\nG2 X9.1 Y2.7 I3 J1\nG1 X0.4 Y11\nM30\n"


def machine() -> Iterator[Any]:
    made = Machine(load_machine("mill3"), segments=64)
    yield made
    made.move("Y", 31.7, speed=9.0)
    made.advance(40)
    yield made
    made.move("Y", 3.1, speed=5.0)  # anew, from its speed
    made.advance(17)
    yield made


def board() -> Iterator[Any]:
    made = Board(parse_system_file("number_of_axes = 3"))
    tasks = BoardTasks(made)
    yield made
    tasks.load(compile_program(SAP, task=2))
    tasks.startcnct(2)
    cl(made, (0, 1, 2))
    made.advance(3)
    for axis in made.axes:
        axis.jac, axis.jvl, axis.dvoffset = 400.0, 70.0, 3.0
    made.axes[1].dpoffset = 2.5  # a profile on top
    ja(made, (0, 1), (17.3, -4.1))
    made.advance(60)
    yield made
    js(made, (0,))
    made.advance(9)
    yield made


def card() -> Iterator[Any]:
    made = Card(CardConfig(number_of_axes=3, ready=True))
    yield made
    made.write("mcstgpos", 8_765, 1)
    made.write("mcsgo", -1, 1)
    made.advance(60)
    made.write("mcstgvel", -3, 1)
    made.advance(20)
    yield made


def control() -> Iterator[Any]:
    made = Control(load_machine("mill3"))
    yield made
    made.select_program(ProgramText.from_text(BLOCKS, "part"))
    made.cycle_start()
    made.advance(250)
    yield made
    made.feed_hold()
    made.advance(90)
    yield made


def power_mate() -> Iterator[Any]:
    made = PowerMate()
    yield made
    made.programs.register(7, "O0007\n#101=3.7\nG1X#101F600\nG4X2.\nX9.\nM30\n")
    made.select_mode("MEM")
    made.select_program(7)
    made.cycle_start()
    made.advance(500)
    yield made


def pnc() -> Iterator[Any]:
    with tempfile.TemporaryDirectory() as root:
        (Path(root) / "p1").write_text("10 FOR I%=1 TO 3\nN20 G1 F900 X[I%*3.7]\n30 NEXT\nM30\n")
        made = Pnc(root, "mill3")
        yield made
        made.select_program("p1")
        made.cycle_start()
        made.advance(400)
        yield made
        made.close()


KINDS: dict[str, Callable[[], Iterator[Any]]] = {
    each.__name__: each for each in (machine, board, card, control, power_mate, pnc)
}


def digests(kind: str) -> list[str]:
    """Return the digests of the snapshots of a device of a kind, along its way."""
    return [hashlib.sha256(each.snapshot().to_bytes()).hexdigest() for each in KINDS[kind]()]


if __name__ == "__main__":
    print(json.dumps({kind: digests(kind) for kind in KINDS}))
