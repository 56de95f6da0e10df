"""Devices that are under way with a random program, for those who cut their time into calls."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

from polycnc.cnc import Control
from polycnc.controllers.apci import Board, BoardTasks, parse_system_file
from polycnc.controllers.apci.board._axis_commands import cl
from polycnc.controllers.apci.board._jog_commands import ja
from polycnc.controllers.apci.sap import compile_program
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.fanuc import PowerMate
from polycnc.controllers.imc import Card, CardConfig
from polycnc.nc.macro import MacroLanguage
from support.cnc_machine import cnc_machine

AXES = 'name = "pair"\n' + "".join(
    f'[[axis]]\nname = "{name}"\nvmax_mm_s = 400\namax_mm_s2 = 3000\n' for name in ("X", "Y", "X2", "Y2")
)


def macro_program(rng: random.Random) -> str:
    """Return a program with custom macros that moves, counts, looks at timers and positions, and calls."""
    number = iter(range(10, 10_000, 10))
    lines = ["G90 G21", "#1=0", "#3=0"]
    for _ in range(rng.randint(3, 8)):
        n = next(number)
        lines += rng.choice(
            [
                [f"G1 X{rng.uniform(-9, 40):.3f} Y{rng.uniform(-9, 20):.3f} F{rng.randint(400, 9000)}"],
                [f"G0 X[#3+{rng.uniform(1, 9):.3f}]", "#3=#3+0.75"],
                ["#1=0", f"WHILE[#1LT{rng.randint(2, 4000)}]DO1", "#1=#1+1", "END1"],
                ["#3001=0", f"WHILE[#3001LT{rng.randint(3, 90)}]DO1", "#4=#4+1", "END1"],
                ["#3001=0", f"N{n} #5=#5+1", f"IF[#3001LT{rng.randint(3, 70)}]GOTO{n}"],
                ["#101=#5041", f"G91 G1 X[#101*0.125+{rng.uniform(0.1, 2):.3f}] F2500", "G90"],
                [f"G4 X{rng.uniform(0.004, 0.09):.3f}"],
                ["M8"],
                [f"G65 P7 A{rng.randint(1, 40)} B{rng.uniform(0.5, 3):.2f}"],
                [
                    f"G1 X{rng.uniform(1, 30):.2f} F5000",
                    "G91",
                    *["X0.25 Y-0.125"] * rng.randint(2, 30),
                    "G90",
                ],
            ]
        )
    return "\n".join(lines) + "\nM30\n"


CALLED = "#2=#2+1\nWHILE[#1GT0]DO1\n#1=#1-1\nIF[#1GT12]GOTO5\nG91 G1 Y#2 F3000\nN5 END1\nG90\nM99\n"


def _cpl_program(rng: random.Random, x: str, y: str) -> str:
    lines = [
        "1 I%=0",
        f"N2 G1 {y}{rng.uniform(-2, 2):.3f} F600",
        "3 IF @A%=NUL THEN @A%=0 ENDIF",
        "5 IF @B%=NUL THEN @B%=0 ENDIF",
    ]
    number = iter(range(10, 10_000, 10))
    for _ in range(rng.randint(3, 7)):
        a, b, c = next(number), next(number), next(number)
        lines += rng.choice(
            [
                [f"N{a} G1 {rng.choice((x, y))}{rng.uniform(-9, 40):.3f} F{rng.randint(400, 9000)}"],
                [f"N{a} G0 {x}[I%+{rng.uniform(1, 9):.3f}]", f"{b} I%=I%+1"],
                [f"{a} FOR J%=1 TO {rng.randint(2, 3000)}", f"{b} I%=I%+1", f"{c} NEXT J%"],
                [f"{a} WAIT(,{rng.randint(3, 90)})"],
                [f"{a} WAIT", f"{b} P!=MPOS(1)", f"N{c} {x}[P!+1]"],
                [f"{a} T!=CLOCK", f"{b} IF CLOCK-T!<{rng.randint(3, 40)} THEN GOTO {b} ENDIF"],
                [f"{a} @B%=@A%", f"{b} IF CLOCK<{rng.randint(3, 900)} THEN GOTO {b} ENDIF", f"{c} @B%=@A%+7"],
                [
                    f"{a} WHILE MPOS(1)<{rng.randint(1, 9)} DO",
                    f"{b} IF CLOCK>900 THEN GOTO {c} ENDIF",
                    f"{c} END",
                ],
                [
                    f"{a} N%=0",
                    f"{b} N%=N%+1",
                    f"{c} IF (@B%<3) AND (N%<{rng.randint(2, 30_000)}) THEN GOTO {b} ENDIF",
                ],
                [f"{a} @A%=@A%+1", f"{b} IF @A%<{rng.randint(1, 4)} THEN GOTO {a} ENDIF"],
                [f"N{a} M8"],
            ]
        )
    return "\n".join(lines) + "\nM30\n"


def o_word_program(rng: random.Random) -> str:
    """Return a program in LinuxCNC's language that moves, counts, waits, calls and reads places."""
    number = iter(range(10, 10_000))
    lines = ["G21 G90 G61", "#1 = 0", "#3 = 0.5"]
    for _ in range(rng.randint(3, 8)):
        n = next(number)
        lines += rng.choice(
            [
                [f"G1 X{rng.uniform(-9, 40):.3f} Y{rng.uniform(-9, 20):.3f} F{rng.randint(400, 9000)}"],
                [f"G0 X[#3 + {rng.uniform(1, 9):.3f}]", "#3 = [#3 + 0.75]"],
                ["#1 = 0", f"o{n} while [#1 LT {rng.randint(2, 60_000)}]", "#1 = [#1 + 1]", f"o{n} endwhile"],
                [f"M66 P3 L{rng.randint(1, 3)} Q{rng.uniform(0.003, 0.2):.3f}", "#4 = [#4 + #5399]"],
                [f"M66 E1 L0 G1 X[#5420 * 0.125 + {rng.uniform(1, 9):.2f}] F2500"],
                [
                    f"o{n} repeat [{rng.randint(2, 400)}]",
                    f"o900 call [{rng.uniform(1, 4):.2f}]",
                    f"o{n} endrepeat",
                ],
                [f"o{n} do", "#5 = [#5 + 1]", f"o{n} while [#5 LT {rng.randint(2, 90)}]"],
                [f"G1 Z[#3 * 2] F{rng.randint(900, 5000)}", "M98 P70 L2"],
                [f"G4 P{rng.uniform(0.004, 0.09):.3f}"],
                ["M8"],
                [
                    f"G1 X{rng.uniform(1, 30):.2f} F5000",
                    "G91",
                    *["X0.25 Y-0.125"] * rng.randint(2, 30),
                    "G90",
                ],
            ]
        )
    return "\n".join(
        ["o900 sub", "#31 = [#31 + #1]", "o900 endsub", *lines, "M2", "O70", "G91 X0.5", "G90", "M99"]
    )


def _power_mate(rng: random.Random, _folder: Path) -> PowerMate:
    made = PowerMate(rng.randint(2, 4))
    made.programs.register(1, f"O0001\n{macro_program(rng)}")
    made.programs.register(7, f"O0007\n{CALLED}")
    made.select_mode("MEM")
    made.select_program(1)
    made.cycle_start()
    return made


def _control(rng: random.Random, _folder: Path) -> Control:
    made = Control(cnc_machine(), dialect="fanuc", languages=(MacroLanguage(),), servo=rng.random() < 0.3)
    made.programs.create("O0001", macro_program(rng))
    made.programs.create("O0007", CALLED)
    made.select_program("O0001")
    made.set_switches(single_block=rng.random() < 0.1)
    for axis in made.machine.config.axis_names:
        made.manual.referenced[axis] = True
    made.cycle_start()
    return made


def _o_words(rng: random.Random, _folder: Path) -> Control:
    made = Control(dialect="linuxcnc", servo=rng.random() < 0.3)
    made.programs.create("part.ngc", o_word_program(rng))
    made.select_program("part.ngc")
    made.set_switches(single_block=rng.random() < 0.1)
    made.cycle_start()
    return made


def _pnc(rng: random.Random, folder: Path) -> Pnc:
    (folder / "anwperm.dat").write_text("DEF INT @A ;\nDEF INT @B ;\n")
    config = folder / "machine.toml"
    config.write_text(AXES)
    made = Pnc(folder, config, channels=[("X", "Y"), ("X2", "Y2")])
    for channel in (1, 2):
        (folder / f"p{channel}.npg").write_text(
            _cpl_program(rng, *("X", "Y") if channel == 1 else ("X2=", "Y2="))
        )
        made.select_program(f"p{channel}.npg", channel=channel)
        made.cycle_start(channel=channel)
    return made


def _board(rng: random.Random, _folder: Path) -> Board:
    made = Board(parse_system_file("number_of_axes = 3"))
    cl(made, (0, 1, 2))
    made.advance(3)
    for axis in made.axes:
        axis.jac, axis.jvl = rng.uniform(100, 900), rng.uniform(5, 90)
    ja(made, (0,), (rng.uniform(0.1, 3),))
    tasks = BoardTasks(made)
    waits = f"while A2.rp < {rng.uniform(0.1, 0.9):.3f} do begin n := n + 1; CI7 := n end; "
    tasks.load(
        compile_program(
            f"program one; var n: longint; begin n := 0; jr (A2 := {rng.uniform(1, 2):.2f}); {waits}"
            f"while n < {rng.randint(10, 90_000)} do begin n := n + 1; CI8 := n end; "
            f"ja (A1 := {rng.uniform(1, 2):.2f}) end.",
            task=2,
        )
    )
    tasks.startcnct(2)
    return made


def _card(rng: random.Random, _folder: Path) -> Card:
    made = Card(CardConfig(number_of_axes=3, ready=True))
    for axis in range(3):
        made.write("mcstgpos", rng.randint(-9000, 9000), axis)
        made.write("mcsgo", -1, axis)
    return made


DEVICES: dict[str, Callable[[random.Random, Path], Any]] = {
    "power mate": _power_mate,
    "control": _control,
    "o-words": _o_words,
    "pnc": _pnc,
    "board": _board,
    "card": _card,
}
"""What makes a device that is under way, from random numbers and a folder of its own."""
