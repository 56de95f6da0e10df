"""Which rows of Manual 003 a CPL program shows, by the words that it uses."""

from __future__ import annotations

import re

_FUNCTIONS = """ABS INT ROUND SQRT SIN COS TAN ASIN ACOS ATAN BCD BIN MID$ LEN INSTR ASC CHR$ STR$ VAL TRIM$ FOR WHILE
CASE IF DIM NOT AND OR XOR TRUE FALSE NUL GOTO REM REPEAT OPENW OPENR PRN# INP# REWRITE CLOSE EOF FILEPOS SEEK FILESIZE
ERASE FILEACCESS FILEDATE LJUST NJUST DSP TFO COL RGB GMD GWD MWD LIN CIR FIL GPR CLR CLS CLG DLF CSF CALL"""
_OTHERS = {
    r"#[A-Z0-9]+%": "type.INTEGER var.global",
    r"#[A-Z0-9]+!": "type.DOUBLE const.DOUBLE",
    r"[A-Z0-9]\?": "type.BOOLEAN",
    r"#[A-Z0-9]+(?![%!?$A-Z0-9])": "type.REAL const.REAL var.global",
    r"\d\.\d": "const.REAL const.list",
    r"[=(,]\d+\b(?!\.)": "const.INTEGER const.list",
    r'"': "const.STRING",
    r"\+": "op.addition",
    r"[A-Z0-9)]-": "op.subtraction",
    r"\*": "op.multiplication",
    r"/": "op.division",
    r"[-+*/=(]\(": "op.paren",
    r"\b(AND|OR|XOR|NOT)\b.*[*/+=<>-]|[*/].*[+-]": "op.precedence",
    r"\?=[^\n:]*[A-Z0-9$%!)\"]=": "op.eq",
    "<>": "op.ne",
    "<=": "op.le",
    ">=": "op.ge",
    r"<(?![>=])": "op.lt",
    r"(?<!<)>(?!=)": "op.gt",
    r":": "op.colon",
    r"\bSTEP\b": "kw.STEP",
    r"\bFOR\b": "kw.TO kw.NEXT",
    r"\bUNTIL\b": "kw.UNTIL",
    r"\bDO\b": "kw.DO kw.END",
    r"\bIF\b": "kw.THEN kw.ENDIF",
    r"\bELSE\b": "kw.ELSE",
    r"\bCASE\b": "kw.OF kw.LABEL kw.ENDCASE",
    r"\bOTHERWISE\b": "kw.OTHERWISE",
    r"\n\d+ \.[A-Z]": "label",
    r"\bDIM [A-Z]+[%!?]?\(": "type.ARRAY",
    r"\bDIM [A-Z]+\$\(": "type.CHARACTER string.functions",
    r'\$[^\n:]*"\+|\+"|\$\+': "op.chain",
    r"TRIM\$\([^,]*,\"L\"": "TRIM$.L",
    r"TRIM\$\([^,]*,\"R\"": "TRIM$.R",
    r"TRIM\$\([A-Z$]+\)": "TRIM$.none",
}  # fmt: skip


def rows_of(program: str) -> list[str]:
    """Return the rows whose statements, functions, types and operators a program uses."""
    bare = re.sub(r"(?m)\bREM\b.*$", "REM", program)
    found = [
        name
        for name in _FUNCTIONS.split()
        if re.search(rf"(?<![A-Z0-9#@]){re.escape(name)}(?![A-Z0-9%!?$])", bare)
    ]
    found += [row for pattern, rows in _OTHERS.items() if re.search(pattern, bare) for row in rows.split()]
    return [f"cpl.{row}" for row in dict.fromkeys(found)]
