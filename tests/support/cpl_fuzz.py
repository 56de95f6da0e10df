"""Wrong CPL programs by the thousand: words in any order, programs with a place changed, any characters at all."""

from __future__ import annotations

import random
import re
from typing import Any

from polycnc.errors import ProgramError
from polycnc.nc.cpl import BLOCKED, Linker, Run, holds_cpl
from support.cpl_host import RecordingHost

STEPS = 12
"""How many events of a program are asked for: one that loops for ever lets time pass every so often."""
WORDS = (
    """
    1 2.5 .5 007 99999999999 2147483648 1E5 X X% X! X? A$ #G #A$ #B? @7 @101 @_R @X% P1 P2$ P% ( ) [ ] , ; : . = <> <
    >= + - * / " "T" "" N10 X5 G1 M30 .L .L1 IF THEN ELSE ENDIF FOR TO STEP NEXT WHILE DO END REPEAT UNTIL CASE OF
    LABEL OTHERWISE ENDCASE GOTO CALL DIN SUB é ß \x01 \x00 \x03 \x0c \u2028 { } % # @ $ ' DIM PDIM WAIT
    REM AND OR XOR NOT NUL TRUE FALSE
    SIN( ACOS( TAN( SQRT( ABS( INT( ROUND( BCD( BIN( MID$( LEN( VAL( STR$( ASC( CHR$( INSTR( TRIM$( IC(
    PRN#( INP#( MPOS( MCODS( DLG FIX COM CLOCK
    """.split()  # noqa: SIM905 (a hundred words in quotes are no easier to read)
    + ["\t", "\n", "\r\n", "\r", "\n10 ", "\n20 ", "\nN30 ", " "]
)
PROGRAMS = (
    '10 DIM A$(9) : DIM F%(3,4)\n20 A$="ABC" : MID$(A$,2,1)="xy"\n30 FOR I%=0 STEP 1 TO 3\n'
    "40 F%(I%,2)=I%*7-3 : #S%=F%(I%,2)\n50 NEXT I%\nN60 G1 X[I%*2.5] Y[SIN(30)] F[#S%+1000]\n70 #T$=MID$(A$,2)\n",
    "10 X=2.75 : Y!=1.23456789012 : B?=X<Y! OR NOT (3=4)\n20 IF B? AND X<>NUL THEN Z=X/3 ELSE Z=-X ENDIF\n"
    "30 CASE INT(Z)+2 OF\n40 LABEL 1,2 : #A=1\n50 LABEL 3\n#A=2\n60 OTHERWISE\nN7 X3\n70 ENDCASE\n",
    "10 I%=0\n20 .LOOP : I%=I%+1\n30 WHILE I%<5 DO\n40 I%=I%+2 : IF I%=4 THEN GOTO .LOOP ENDIF\n50 END\n"
    "60 REPEAT\n70 I%=I%-3\n80 UNTIL I%<-20\n90 GOTO N100\nN100 G0 Z5 (text [1])\n110 CALL SUB[X,I%,2.5]\n",
    '10 A=VAL("-12.5E") : DIM S$(30)\n20 S$=STR$("##.##",A)+"/"+CHR$(65)\n30 #L%=LEN(S$)+INSTR("/",S$,2)\n'
    '40 PRN#(1,"A ##.#",A,S$;)\n50 WAIT(IC(1,2,3)=TRUE,500,R%)\nN60 WAIT\n70 @7=ROUND(A) : @8=BCD(49)\n'
    'N80 P SUB["T"]\n',
    "1 #K%=MCODS(32,1,V,W,2)\n2 FOR D!=2 STEP -0.25 TO -3 : #D!=D! : NEXT\n"
    '3 #E?="A"<"B" : #F%=5 AND 6 XOR 3\nN4 [A$] X=[@7]\n',
)
SUB = "10 PDIM P1$(5)\n20 #P=P1 : #Q%=P2%\nN1 X[P3]\n"
_PIECE = re.compile(r"[A-Za-z_#@$%!?]+|[0-9.]+|\s|.", re.DOTALL)


def source(seed: int) -> str:
    """Return the program of a seed."""
    chance = random.Random(seed)
    match seed % 4:
        case 0:
            blank = chance.choice(("", " "))
            return "1 " + blank.join(chance.choices(WORDS, k=chance.randint(1, 30)))
        case 1:
            return "".join(map(chr, chance.choices(range(1, 300), k=chance.randint(1, 60))))
        case _:
            return _changed(chance)


def _changed(chance: random.Random) -> str:
    pieces: list[str] = _PIECE.findall(chance.choice(PROGRAMS))
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(pieces))
        other = chance.randrange(len(pieces))
        match chance.randrange(5):
            case 0:
                pieces[at] = ""
            case 1:
                pieces[at] = chance.choice(WORDS)
            case 2:
                pieces.insert(at, chance.choice(WORDS))
            case 3:
                pieces[at], pieces[other] = pieces[other], pieces[at]
            case _:
                pieces[at : at + 1] = pieces[at : other + 1] * chance.choice((2, 3, 60))
    return "".join(pieces)[:20_000]


def outcome(text: str) -> list[ProgramError]:
    """Link a program and run its beginning; return what is said about it."""
    holds_cpl(text.encode())
    answers = iter((BLOCKED, 0, 3))
    host = RecordingHost(
        {
            "IC": lambda *given: True, "PRN#": lambda *given, **more: None, "DLG": lambda: None, "CLOCK": lambda: 250,
            "MCODS": lambda *given: next(answers, 7), "MPOS": lambda *given: 12.5, "INP#": lambda *given, **more: None,
        },
        {"SUB": SUB},
    )  # fmt: skip
    linker = Linker(host.program)
    main, errors = linker.link(text, "main.cpl")
    assert (main is None) == bool(errors)
    return errors if main is None else _run(main, linker, host)


def _run(*given: Any) -> list[ProgramError]:
    try:
        run = Run(*given)
        for _ in range(STEPS):
            if run.step() is None:
                break
        run.stop()
    except ProgramError as error:
        return [error]
    return []
