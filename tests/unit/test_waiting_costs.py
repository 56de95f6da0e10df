"""What a cycle of a program costs that waits for something or goes round for ever, in lines of Python carried out."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

from polycnc.cnc import Control, RunState
from polycnc.controllers.apci import Board, BoardTasks, parse_system_file
from polycnc.controllers.apci.sap import compile_program
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.fanuc import PowerMate
from polycnc.nc.macro import MacroLanguage
from support.cnc_machine import cnc_machine

CYCLES = 4
A_WAIT = 2000
"""Lines in a cycle of a program that waits: a look at the condition, and what a cycle costs anyway."""
A_LOOP = 100_000
"""Lines in a cycle of a program that works without end."""
WRITING = 15_000
"""Lines in a cycle of a program that writes, shows or draws without end: a millisecond or two."""

CPL = {
    "WAIT": "10 WAIT(,900000)",
    "WAIT for a signal": "10 WAIT(IC(4)=TRUE)",
    "GOTO, CLOCK": "10 IF CLOCK<900000 THEN GOTO 10 ENDIF",
    "WHILE, CLOCK": "10 WHILE CLOCK<900000 DO\n20 END",
    "REPEAT, CLOCK": "10 REPEAT\n20 UNTIL CLOCK>900000",
    "TIME": '5 DIM A$(9)\n6 A$=TIME\n10 IF TIME<>"23.59.58" THEN GOTO 10 ENDIF',
    "DATE": '10 IF DATE<>"29.02." THEN GOTO 10 ENDIF',
    "SD": "10 IF SD(8)<99 THEN GOTO 10 ENDIF",
    "IC": "10 WHILE IC(4)=FALSE DO\n20 END",
    "MPOS": "10 IF MPOS(1)<900 THEN GOTO 10 ENDIF",
    "INKEY": "10 IF INKEY=0 THEN GOTO 10 ENDIF",
    "file": '10 IF FILEACCESS("go")=-1 THEN GOTO 10 ENDIF',
    "permanent, GOTO": "10 @A%=0\n20 IF @A%=0 THEN GOTO 20 ENDIF",
    "permanent, WHILE": "10 @A%=0\n20 WHILE @A%=0 DO\n30 END",
    "permanent, REPEAT": "10 @A%=0\n20 REPEAT\n30 UNTIL @A%=7",
    "permanent, inner": "10 @A%=0\n20 WHILE @A%=0 DO\n30 IF IC(4) THEN N%=5 ENDIF\n40 END",
    "two waits": "10 IF CLOCK<900000 THEN GOTO 20 ENDIF\n20 IF IC(4)=FALSE THEN GOTO 10 ENDIF",
    "counting, CLOCK": "10 N%=0\n20 N%=N%+1\n30 IF CLOCK<900000 THEN GOTO 20 ENDIF",
    "counting, IC": "10 N%=0\n20 N%=N%+1\n30 IF IC(4)=FALSE THEN GOTO 20 ENDIF",
    "kept, CLOCK": "10 T%=CLOCK\n20 IF T%<900000 THEN GOTO 10 ENDIF",
    "empty blocks": "N10 (waits)\n20 IF IC(4)=FALSE THEN GOTO N10 ENDIF",
    "nothing": "10 GOTO 10",
}  # fmt: skip
WRITING_CPL = {
    "writes": '5 N%=5\n10 OPENW(1,"out")\n20 PRN#(1,N%)\n30 GOTO 20',
    "shows": '10 DSP(2,3,"on")\n20 GOTO 10',
    "erases": '10 R%=ERASE("none")\n20 GOTO 10',
    "draws": "10 LIN(5,7,630,300)\n20 GOTO 10",
    "circles": "10 CIR(300,200,150)\n20 GOTO 10",
}
MACROS = {
    "variable, WHILE": "#500=0\nWHILE[#500EQ0]DO1\nEND1",
    "variable, GOTO": "#500=0\nN10IF[#500EQ0]GOTO10",
    "variable, two blocks": "#500=0\nN10\nN20IF[#500EQ0]GOTO10",
    "nothing": "N10GOTO10",
    "endless": "DO1\nEND1",
}
SIGNALS = {
    "signal": "WHILE[#1000EQ0]DO1\nEND1",
    "timer": "WHILE[#3001LT1000000]DO1\nEND1",
    "position": "WHILE[#5041LT1]DO1\nEND1",
    "counting": "WHILE[#5041LT1]DO1\n#1=#1+1\nEND1",
    "restart": "IF[#500EQ1]GOTO5\nM99\nN5",
}
O_WORDS = {
    "M66": "M66 P3 L1 Q99",
    "WHILE": "o1 while [#5 EQ 0]\no1 endwhile",
    "DO": "o1 do\no1 while [#5 EQ 0]",
    "a comment": "o1 while [#5 EQ 0]\n(waits)\n\no1 endwhile",
    "position": "o1 while [#5420 LT 5]\no1 endwhile",
    "branches": "o1 while [#5 EQ 0]\no2 if [#6 GT 3]\no2 endif\no1 endwhile",
}
ENDLESS_MACROS = {
    "counts": "#500=0\nWHILE[#500EQ0]DO1\n#1=#1+1\nEND1",
    "GOTO by number": "#500=0\n#1=10\nN10IF[#500EQ0]GOTO#1",
    "calls a sub-program": "WHILE[1EQ1]DO1\nM98P9\nEND1",
    "calls a macro": "WHILE[1EQ1]DO1\nG65P9A1\nEND1",
    "repeats a call": "WHILE[1EQ1]DO1\nM98P9L9999\nEND1",
    "no motion": "WHILE[1EQ1]DO1\nG90\nEND1",
    "no time": "WHILE[1EQ1]DO1\nG4P0\nEND1",
}
ENDLESS_O_WORDS = {
    "counts": "o1 while [#5 EQ 0]\n#1=[#1+1]\no1 endwhile",
    "repeats": "o1 repeat [100000000]\no1 endrepeat",
    "calls": "o2 sub\no2 endsub\no1 while [#5 EQ 0]\no2 call\no1 endwhile",
    "calls by number": "o1 while [#5 EQ 0]\nM98 P70\no1 endwhile\nM2\nO70\nM99",
    "repeats a call": "M98 P70 L99999999\nM2\nO70\nM99",
    "calls in calls": "\n".join(f"o{n} sub\n" + f"o{n + 1} call\n" * 9 + f"o{n} endsub" for n in range(2, 8))
    + "\no8 sub\no8 endsub\no2 call",
    "no motion": "o1 while [#5 EQ 0]\nG90\no1 endwhile",
}
ENDLESS_CPL = {
    "counts": "10 N%=0\n20 N%=N%+1\n30 IF N%<2000000000 THEN GOTO 20 ENDIF",
    "counts, permanent": "10 @A%=0\n15 N%=0\n20 N%=N%+1\n40 IF @A%=0 THEN GOTO 20 ENDIF",
    "counts in a FOR": "10 FOR I%=1 TO 2000000000\n20 NEXT I%",
    "calls": "10 CALL sub\n20 GOTO 10",
}
TASKS = {
    "position": "while A1.rp < 5 do begin end",
    "common variable": "while CI7 = 0 do begin end",
    "counting": "while CI7 = 0 do begin n := n + 1 end",
}


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the root of a PNC, which its devices use one after the other."""
    made = tmp_path_factory.mktemp("root")
    (made / "anwperm.dat").write_text("DEF INT @A ;\n")
    (made / "sub").write_text("10 IF @A%=9 THEN @A%=2 ENDIF\n")
    return made


def lines_a_cycle(device: Any) -> float:
    """Return how many lines of Python a cycle of a device that is under way carries out."""
    device.advance(3)
    lines = 0

    def count(_frame: FrameType, event: str, _value: object) -> Callable[..., Any]:
        nonlocal lines
        lines += event == "line"
        return count

    before = sys.gettrace()
    sys.settrace(count)
    try:
        assert device.advance(CYCLES) == CYCLES
    finally:
        sys.settrace(before)
    channels = getattr(getattr(device, "control", device), "channels", ())
    assert all(each.run_state is RunState.ACTIVE for each in channels if each.run is not None)
    return lines / CYCLES


def bounded(
    waits: dict[str, str], loops: dict[str, str], writes: dict[str, str] | None = None
) -> pytest.MarkDecorator:
    writes = writes or {}
    cases = [(waits[each], A_WAIT) for each in waits] + [(loops[each], A_LOOP) for each in loops]
    cases += [(writes[each], WRITING) for each in writes]
    return pytest.mark.parametrize(
        ("text", "most"), cases, ids=[*waits, *(f"works: {each}" for each in (*loops, *writes))]
    )


@bounded(CPL, ENDLESS_CPL, WRITING_CPL)
def test_a_cycle_of_a_cpl_program_is_bounded(root: Path, text: str, most: int) -> None:
    (root / "main.npg").write_text(f"{text}\nM30\n")
    with closing(Pnc(root)) as made:
        made.select_program("main.npg")
        made.cycle_start()
        assert lines_a_cycle(made) < most


@bounded(MACROS | SIGNALS, ENDLESS_MACROS)
def test_a_cycle_of_a_power_mates_program_is_bounded(text: str, most: int) -> None:
    made = PowerMate(2)
    made.programs.register(1, f"O0001\n{text}\nM30\n")
    made.programs.register(9, "O0009\nIF[#1EQ9]GOTO5\nM99\nN5M99\n")
    made.select_mode("MEM")
    made.select_program(1)
    made.cycle_start()
    assert lines_a_cycle(made) < most


@bounded(MACROS, ENDLESS_MACROS)
def test_a_cycle_of_a_program_with_macros_is_bounded(text: str, most: int) -> None:
    made = Control(cnc_machine(), dialect="fanuc", languages=(MacroLanguage(),))
    made.programs.create("O0001", f"{text}\nM30\n")
    made.programs.create("O0009", "IF[#1EQ9]GOTO5\nM99\nN5M99\n")
    made.select_program("O0001")
    for axis in made.machine.config.axis_names:
        made.manual.referenced[axis] = True
    made.cycle_start()
    assert lines_a_cycle(made) < most


@bounded(O_WORDS, ENDLESS_O_WORDS)
def test_a_cycle_of_a_program_with_o_words_is_bounded(text: str, most: int) -> None:
    made = Control(dialect="linuxcnc")
    made.programs.create("part.ngc", f"{text}\nM2\n")
    made.select_program("part.ngc")
    made.cycle_start()
    assert lines_a_cycle(made) < most


@bounded(TASKS, {})
def test_a_cycle_of_a_sap_task_that_waits_is_bounded(text: str, most: int) -> None:
    made = Board(parse_system_file("number_of_axes = 2"))
    tasks = BoardTasks(made)
    tasks.load(compile_program(f"program one; var n: longint; begin n := 0; {text} end.", task=2))
    tasks.startcnct(2)
    assert lines_a_cycle(made) < most


def test_a_wait_ends_in_the_cycle_after_its_variable(root: Path) -> None:
    """One look in a cycle misses nothing: what another writes is seen in the cycle after it."""
    (root / "main.npg").write_text("10 @A%=0\n20 WHILE @A%<>47 DO\n30 END\n40 @A%=53\nM30\n")
    with closing(Pnc(root)) as made:
        made.select_program("main.npg")
        made.cycle_start()
        made.advance(31)
        made.system.kept.memory["@A%"] = 47
        made.advance(1)
        assert made.system.kept.memory["@A%"] == 53
