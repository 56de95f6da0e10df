"""The words of CPL: how they are cut out of a line, which are reserved, how tightly operators bind."""

from __future__ import annotations

from polycnc.language import Infix, Lexicon, Operators, Prefix

RESERVED = frozenset(
    """
    ABS ACOS AND APOS ASC ASIN ATAN AXO AXP BCD BIN BMP CALL CASE CHR$ CIR CLG CLOCK CLOSE CLR CLS COF COL
    COM COS CPOS CPROBE CSF DATE DIM DLF DLG DO DPC DSP ELSE END ENDCASE ENDDLG ENDIF EOF ERASE FALSE FIL
    FILEACCESS FILEDATE FILEPOS FILESIZE FIX FIXB FIXE FOR FXC FXCR FXDEL FXINS GETERR GMD GOTO GPR GWD IC IF
    INKEY INP INP# INSTR INT LABEL LEN LIN LJUST MCA MCODS MCOPS MIC MID$ MMC MPOS MWD NCF NEXT NJUST NOT NUL
    OF OPENR OPENW OR OTHERWISE PDIM PLC PPOS PRN PRN# PROBE REM REPEAT REWRITE RGB ROUND SCL SCS SCSL SD SDR
    SEEK SFK SIN SPOS SQRT STEP STR$ TAN TC TD TDA TDR TFO THEN TIME TO TRIM$ TRUE TXT$ UNTIL VAL WAIT WHILE
    WPOS XOR
    """.split()  # noqa: SIM905 (a list of 120 words in quotes is no easier to read)
)
"""Words that no variable may have as its name (Manual 003, 2.4.1; with TO and SCSL, which its list leaves out)."""
UNUSED = frozenset(("COM", "FIX", "FIXB", "FIXE", "MIC", "TD", "TDR", "TXT$"))
"""Reserved words without a function."""

LEXICON = Lexicon(
    (
        ("name", r"(?:PRN|INP)\#|[#@]?[A-Za-z_][A-Za-z0-9_]*[%!?$]?|@[0-9]+[A-Za-z0-9_]*%?"),
        ("number", r"[0-9]+(?:\.[0-9]*)?|\.[0-9]+"),
        ("text", r'"[^"]*"'),
        ("label", r"\.[A-Za-z][^\s:,]*"),
        ("mark", r"<>|<=|>=|[-+*/=<>(),;:\[\]]"),
    ),
    folded=("name", "label"),
    unfinished={
        '"': ("the text has no end", 'write " behind it, in the same line'),
        "#": ("# stands before no name", "a global variable is written #NAME"),
        "@": ("@ stands before no name", "a permanent variable is written @1 or @NAME"),
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
