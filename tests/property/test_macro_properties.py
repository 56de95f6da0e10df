"""Custom macros against LinuxCNC's interpreter, against a plain evaluation, and against random text."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.errors import ProgramError
from polycnc.kernel import drop_queue
from polycnc.machine import Machine, load_machine
from polycnc.nc import Channel, ProgramText, load_dialect
from polycnc.nc.macro import MacroLanguage
from support.often import share
from support.rs274 import COMMAND, call

DIFFERENTIAL = share(60)
FUZZED = share(1000)
_FEED = re.compile(r"STRAIGHT_FEED\((-?[0-9.]+),")


def shallow(chance: random.Random, depth: int, known: list[int]) -> str:
    """Return one that fits into the five brackets that a control allows, with one around it."""
    while True:
        text = expression(chance, depth, known)
        level = deepest = 0
        for char in text:
            level += (char == "[") - (char == "]")
            deepest = max(deepest, level)
        if deepest < 5:
            return text


def expression(chance: random.Random, depth: int, known: list[int]) -> str:
    """Return an expression that means the same in both languages."""
    kind = chance.randrange(9 if depth else 2)
    if kind == 0 or not known:
        return f"{chance.uniform(0.1, 9.0):.3f}"
    if kind == 1:
        return f"#{chance.choice(known)}"
    left, right = (expression(chance, depth - 1, known) for _ in range(2))
    match kind:
        case 2 | 3 | 4:
            return f"[{left}{chance.choice('+-*')}{right}]"
        case 5:
            return f"[{left}/[ABS[{right}]+1.5]]"
        case 6:
            return f"{chance.choice(('SIN', 'COS', 'ABS', 'ROUND'))}[{left}]"
        case 7:
            return f"ATAN[{left}]/[ABS[{right}]+0.25]"
        case _:
            return f"SQRT[ABS[{left}]]"


class Writer:
    """Write the same random program as custom macro and with O-words."""

    def __init__(self, seed: int) -> None:
        self.chance = random.Random(seed)
        self.macro: list[str] = []
        self.words: list[str] = ["G20 F100"]
        self.known: list[int] = []
        self.labels = 0

    def both(self, line: str) -> None:
        self.macro.append(line)
        self.words.append(line)

    def assign(self) -> None:
        number = self.chance.randrange(1, 20)
        value = shallow(self.chance, 3, self.known)
        self.macro.append(f"#{number}=SIN[{value}]*5000")
        self.words.append(f"#{number}=[SIN[{value}]*5000]")
        self.both(
            f"#{number}=[ROUND[#{number}]/1000]"
        )  # loops would make much of a difference in the last bit
        self.known.append(number)

    def condition(self) -> str:
        left, right = (shallow(self.chance, 1, self.known) for _ in range(2))
        return f"[{left} {self.chance.choice(('LT', 'GT', 'LE', 'GE'))} {right}]"

    def block(self, depth: int, loop: int) -> None:
        for _ in range(self.chance.randrange(1, 4)):
            kind = self.chance.randrange(5)
            if kind <= 1 or depth == 0:
                self.assign()
            elif kind == 2:
                self.labels += 1
                label, condition = self.labels, self.condition()
                self.macro.append(f"IF {condition} GOTO {label}")
                self.words.append(f"o{label} if [{condition} EQ 0]")
                self.block(depth - 1, loop)
                self.macro.append(f"N{label}")
                self.words.append(f"o{label} endif")
            elif kind == 3 and loop <= 3:
                self.labels += 1
                label, counter = self.labels, 25 + loop
                self.both(f"#{counter}=0")
                self.macro.append(f"WHILE [#{counter} LT 3] DO{loop}")
                self.words.append(f"o{label} while [#{counter} LT 3]")
                self.both(f"#{counter}=[#{counter}+1]")
                self.block(depth - 1, loop + 1)
                self.macro.append(f"END{loop}")
                self.words.append(f"o{label} endwhile")
            else:
                number = self.chance.choice(self.known or [1])
                if self.known:
                    self.macro.append(f"#500=#500+1\n#[500+#500]=#{number}")
                    self.words.append(f"G1 X[#{number}]")


def run(text: str) -> tuple[Channel, MacroLanguage]:
    """Prepare a program to its end, or to its first error."""
    language = MacroLanguage(nat=True)  # angles are -180 to 180 there too
    language.longest_loop_pauses = 2
    made = ProgramRun(
        Machine(load_machine(None)),
        ProgramText.from_text(text, "macro.tap"),
        load_dialect("fanuc"),
        options=RunOptions(stands_at_stops=False),
        language=language,
    )
    made.start()
    for _ in range(50):
        if not made.active:
            break
        made.advance(100_000_000)
    assert not made.active
    return made.channel, language


@pytest.mark.skipif(COMMAND is None, reason="rs274 is not installed")
@pytest.mark.parametrize("count", [DIFFERENTIAL, pytest.param(2000, marks=pytest.mark.long)])
def test_random_programs_calculate_what_rs274_calculates(tmp_path: Path, count: int) -> None:
    compared = 0
    for seed in range(count):
        writer = Writer(seed)
        writer.assign()
        writer.both("#28=0")
        for _ in range(4):
            writer.block(3, 1)
        path = tmp_path / f"{seed}.ngc"
        path.write_text("\n".join([*writer.words, "M2", ""]))
        done = call(path)
        wanted = [float(each) for each in _FEED.findall(done.stdout)]
        if len(wanted) > 400:
            continue
        channel, language = run("\n".join(["#500=0", *writer.macro, "M30", ""]))
        assert channel.error is None, f"{channel.error}\n" + "\n".join(writer.macro)
        got = [
            language.variables.get(501 + index) or 0.0
            for index in range(int(language.variables.get(500) or 0))
        ]
        assert got == pytest.approx(wanted, abs=6e-5), "\n".join(writer.macro)
        compared += len(wanted)
    assert compared > 3 * count


PIECES = (
    "#1", "#[", "#100", "#500=", "#0", "=", "[", "]", "+", "-", "*", "/", "1", "2.5", "0", "99999999999",
    "SIN[", "ATAN[", "EQ", "NE", "LT", "AND", "MOD", "IF[", "IF", "THEN", "GOTO", "GOTO 1", "WHILE[", "DO1",
    "DO2", "END1", "END2", "N1", "N2", "\n", "\n", "\n", "G65P1", "G66P2", "G67", "M98P1", "M99", "M99P1",
    "O1\n", "O2\n", "%", "(X)", "(", ")", "X", "Y#1", "G1", "F#2", "G68R", "G51P", "G10L2P1", "G16",
    "#3000=1(A)", "#3006=2(B)", "#5021", "#5001", "#2001=", "#3001", "/", "/2", ";", "'", "\x00", "\u00e4",
    "ROUND[", "BIN[", "POW[", "ADP[#1]", ",", "GOTO[", "M30", "T1", " ", "G66.1P1", "M96P2", "M97", "POPEN", "PCLOS",
    "DPRNT[", "BPRNT[", "#1[53]", "#2[4]", "SETVN 500[", "A,B]", "#3003=1", "#3004=2", "M099 P1", "G065P2", "G31X1",
    "#5061", "#33=#33+1\n", "X1\n", "Y2\n", "P", "L2", "M98P2\n", "M99\n",
)  # fmt: skip


GOOD = """#1=3
M96 P2
G66 P1 A#1
N1 G1 X[#1*2] F500
WHILE [#1 GT 0] DO1
#1=#1-1
IF [#1 EQ 1] GOTO 3
G65 P2 B[#1] L2
N3 #2=SQRT[#1+1]
END1
G67
POPEN
DPRNT[X#2[53]*A]
PCLOS
M97
M98 P1
M30
O1
G66.1 P2
X#1 Y1
G67
#500=#5041
M99
O2
SETVN 500[COUNT]
#501=#501+ROUND[#2]
M99
"""


def source(chance: random.Random) -> str:
    """Return random pieces, or a good program with some of its lines cut, doubled, moved or spoilt."""
    if chance.random() < 0.6:
        return "".join(chance.choice(PIECES) for _ in range(chance.randrange(1, 25))) + "\n"
    lines = GOOD.splitlines(keepends=True)
    for _ in range(chance.randrange(1, 6)):
        at = chance.randrange(len(lines))
        kind, line = chance.randrange(5), lines[at]
        place = chance.randrange(len(line))
        if kind == 0 and len(lines) > 1:
            del lines[at]
        elif kind == 1:
            lines.insert(chance.randrange(len(lines) + 1), line)
        elif kind == 2:
            lines[at] = line[:place] + chance.choice(PIECES) + line[place:]
        elif kind == 3:
            lines[at] = line[:place] + line[place + 1 :]
        else:
            lines[at] = chance.choice(PIECES) + "\n"
    return "".join(lines)


@pytest.mark.parametrize("count", [FUZZED, pytest.param(100_000, marks=pytest.mark.long)])
def test_random_text_ends_in_a_result_or_an_error_with_its_place(count: int) -> None:
    fuzz(range(count))


def fuzz(seeds: range) -> None:
    """Prepare random sources: each ends in a result or an error with its place, and leaves nothing behind."""
    count = len(seeds)
    dialect = load_dialect("fanuc")
    machine = Machine(load_machine(None))
    refused = ran = 0
    for seed in seeds:
        chance = random.Random(seed)
        text = source(chance)
        language = MacroLanguage()
        language.longest_loop_pauses = 1
        channel = Channel(ProgramText.from_text(text, "x.tap"), dialect, machine, language=language)
        for _ in range(15):  # some programs go on for ever
            channel.fill(20)
            while channel.waits:
                channel.go_on()
                if chance.random() < 0.1:
                    language.interrupt()
            drop_queue(machine.state.seg, machine.state.paths, 0)
            if channel.done or channel.error:
                break
        if channel.error is not None:
            assert isinstance(channel.error, ProgramError)
            assert channel.error.position is not None
            refused += 1
        else:
            ran += 1
        channel.close()
        assert language.variables.level == 0, text
        assert language.codes_off == 0, text
    assert refused > count // 4
    assert ran > count // 100
