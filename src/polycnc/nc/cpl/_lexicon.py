"""The words of CPL: how they are cut out of a line, which are reserved, how tightly operators bind."""

from __future__ import annotations

import re

from polycnc.language import Infix, Lexicon, Operators, Prefix
from polycnc.nc.cpl._functions import FUNCTIONS

STATEMENTS = {
    "IF condition THEN ... [ELSE ...] ENDIF": "carries out one of two routines",
    "CASE number OF LABEL constant{,constant} ... [OTHERWISE ...] ENDCASE": "carries out the routine of a number",
    "FOR variable=start [STEP step] TO end ... NEXT [variable]": "counts; the end is tested before each round",
    "WHILE condition DO ... END": "repeats as long as a condition holds, tested before each round",
    "REPEAT ... UNTIL condition": "repeats until a condition holds, tested after each round",
    "GOTO N20, GOTO 120, GOTO .LABEL": "goes on at an NC block, a CPL block or a label",
    "CALL program[[value{,value}]] [DIN]": "calls a sub-program; with DIN it is excluded from linking",
    "DIM variable(size[,size])": "makes a variable a field, a string a character field",
    "PDIM parameter$(size)": "makes room for a text that a program is called with",
    "WAIT[([IC(...)[=state]][,ms[,result%]])]": "waits until all blocks before it are executed, or a signal, or a time",
    "REM": "begins a remark up to the end of the line",
}
"""The statements of CPL, as they are written, and what each does."""
_OTHERS = ("AND", "OR", "XOR", "NOT", "TRUE", "FALSE", "NUL")
UNUSED = frozenset(("COM", "FIX", "FIXB", "FIXE", "MIC", "TD", "TDR", "TXT$"))
"""Reserved words without a function."""
_KEYWORD = re.compile(r"\b[A-Z]{2,}\b")
_KEYWORDS = frozenset(_KEYWORD.findall(" ".join(STATEMENTS))) - {"DIN"}
RESERVED = frozenset(FUNCTIONS) | UNUSED | _KEYWORDS | frozenset(_OTHERS)
"""Words that no variable may have as its name (Manual 003, 2.4.1; with TO and SCSL, which its list leaves out)."""

LEXICON = Lexicon(
    (
        ("name", r"(?i:PRN|INP)\#|[#@]?[A-Za-z_][A-Za-z0-9_]*[%!?$]?|@[0-9]+[A-Za-z0-9_]*%?"),
        ("number", r"[0-9]+(?:\.[0-9]*)?|\.[0-9]+"),
        ("text", r'"[^"]*"'),
        ("label", r"\.[A-Za-z][^\s:,]*"),
        ("mark", r"<>|<=|>=|[-+*/=<>(),;:\[\]]"),
    ),
    folded=("name", "label"),
    unfinished={
        '"': ("the text has no end", 'write " after it, in the same line'),
        "#": ("# has no name after it", "a global variable is written #NAME"),
        "@": ("@ has no name after it", "a permanent variable is written @1 or @NAME"),
    },
)

OPERATORS = Operators(
    infix={
        **dict.fromkeys(("=", "<>", "<", "<=", ">", ">="), Infix(1)),
        **dict.fromkeys(("+", "-", "OR", "XOR"), Infix(2)),
        **dict.fromkeys(("*", "/", "AND"), Infix(3)),
    },
    prefix={"NOT": Prefix(4, repeats=True), "-": Prefix(4), "+": Prefix(4)},
)
"""Pascal's order, which the manual's example `@20 AND 1 <> 0` needs."""
