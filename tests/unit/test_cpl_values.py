"""CPL: constants, variables, operators and functions, by the manual's own examples (Manual 003, chapters 2 and 5)."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable

import numpy as np
import pytest

from polycnc.errors import ProgramError
from polycnc.nc.cpl import CharacterField, Field, PermanentMemory, compile_program, text_of
from support.cpl_host import Ran, RecordingHost


def value(text: str, name: str = "#A", host: RecordingHost | None = None) -> object:
    """Return a global variable after a program that is made of instructions, a line each."""
    lines = [line.strip() for line in text.strip().split("\n")]
    numbered = "\n".join(f"{10 * number} {line}" for number, line in enumerate(lines, 1))
    return Ran(numbered, host)[name]


def failure(text: str, host: RecordingHost | None = None) -> ProgramError:
    with pytest.raises(ProgramError) as caught:
        value(text, host=host)
    assert caught.value.position is not None
    return caught.value


def shown(value: object) -> object:
    return text_of(value) if not isinstance(value, int | float) else value


# Constants


@pytest.mark.covers("cpl.const.INTEGER", "cpl.type.INTEGER", "cpl.var.global")
def test_whole_constants_are_integers_of_32_bits() -> None:
    assert value("#N%=2147483647", "#N%") == 2147483647
    assert value("#N%=-2147483648", "#N%") == -2147483648
    assert isinstance(value("#N%=4", "#N%"), int)
    assert value("#D!=-123456789012345", "#D!") == -123456789012345.0
    assert failure("#N%=2147483648").what == "the value is out of the range of its type"
    assert failure("#N%=2147483647\n#N%=#N%+1").position.line == 2  # type: ignore[union-attr]
    assert failure("#N%=3000000000").what == "INVALID ASSIGNMENT"


@pytest.mark.covers("cpl.const.REAL", "cpl.type.REAL", "cpl.const.list")
def test_real_is_single_precision() -> None:
    assert value("#A=3.141593") == float(np.float32(3.141593))
    assert value("#A=0.1\n#A=#A+0.2\n#A=#A*3") == float((np.float32(0.1) + np.float32(0.2)) * np.float32(3))
    assert value("#A=16777216\n#A=#A+1") == 16777216.0
    assert value("#B=0.1\n#A?=#B*3=0.3", "#A?") is bool(np.float32(0.1) * np.float32(3) == np.float32(0.3))
    assert failure("#A=3.5E").what == "the instruction does not go on with 'E'"
    assert failure("#A=1\n#A=" + "9" * 40 + ".5").what == "the number is too large for REAL"
    assert failure("#A=10000000000000000000.0*10000000000000000000.0\n#A=#A*10.0").position.line == 2  # type: ignore[union-attr]


def test_intermediate_results_are_rounded_as_a_32_bit_machine_does() -> None:
    a, b, c = (np.float32(each) for each in (0.3, 1234.567, 7.77))
    program = "#B=0.3\n#C=1234.567\n#D=7.77\n#A=#B*#C-#D/#B+#C*#D"
    assert value(program) == float(a * b - c / a + b * c)
    assert value(program.replace("#A=", "#A!="), "#A!") == (
        float(a) * float(b) - float(c) / float(a) + float(b) * float(c)
    )


@pytest.mark.covers("cpl.const.DOUBLE", "cpl.type.DOUBLE", "cpl.ex.490", "cpl.ex.490b")
def test_constants_beside_a_double_have_15_digits() -> None:
    assert value("#D5!=-1234.123456 + 12345 + 1234.234567", "#D5!") == pytest.approx(12345.111111, abs=1e-11)
    names = {
        "#D0!": "123456789.123456",
        "#D1!": "1.12345678901234",
        "#D2!": "-123456789012345",
        "#D3!": "-1234.123456",
    }
    given = "\n".join(f"{name}={number}" for name, number in names.items())
    for name, number in names.items():
        assert value(f"{given}\nIF {name} = {number} THEN #E?=TRUE ELSE #E?=FALSE ENDIF", "#E?") is True
        assert value(f"{given}", name) == float(number)
    for left in ("#D0! + 2.1 + 3.1", "(#D0! + 2.1) + 3.1"):
        text = f"{given}\nIF {left} = 123456789.123456 + 2.1 + 3.1 THEN\n#E?=TRUE\nELSE\n#E?=FALSE\nENDIF"
        assert value(text, "#E?") is True
    assert value("#D!=0.1\n#A=#D!\n#E?=#A=#D!", "#E?") is False


@pytest.mark.covers("cpl.const.STRING")
def test_string_constants_stand_in_quotes() -> None:
    assert value('#E$="This is a character string"', "#E$") == "This is a character string"
    assert value('#E$=""', "#E$") == ""
    error = failure('#E$="no end')
    assert (error.what, error.position.column) == ("the text has no end", 8)  # type: ignore[union-attr]


@pytest.mark.covers("cpl.TRUE", "cpl.FALSE", "cpl.type.BOOLEAN")
def test_booleans_are_true_or_false() -> None:
    assert value("#A?=TRUE", "#A?") is True
    assert value("#A?=FALSE", "#A?") is False
    assert value("#A%=7\n#A?=#A%>5", "#A?") is True
    assert failure("#A?=1").what == "INVALID ASSIGNMENT"
    for number in ("0", "1", "2.5", "-1"):  # nor by a variable, whose type is not known before
        assert failure(f"P={number}\n#A?=P").what == "INVALID ASSIGNMENT"
        assert failure(f"@1={number}\n#A?=@1").what == "INVALID ASSIGNMENT"
    assert failure("#A%=TRUE").what == "INVALID ASSIGNMENT"
    assert failure("IF 1 THEN #A=1 ENDIF").what == "a condition is TRUE or FALSE, not INTEGER"


@pytest.mark.covers("cpl.NUL", "cpl.ex.764")
def test_nul_is_a_third_state() -> None:
    printed: list[object] = []
    host = RecordingHost({"PRN#": lambda number, *items: printed.append((number, *items))})
    value('XSET=NUL\nIF XSET=NUL THEN\nPRN#(0,"Variable not assigned.")\nENDIF\n#A=0', host=host)
    assert printed == [(0, ("S", "Variable not assigned."))]
    assert value("#E?=X=NUL", "#E?") is True
    assert value("X=0\n#E?=X=NUL", "#E?") is False
    assert value("X=7\nX=NUL\n#E?=X<>NUL", "#E?") is False
    assert value("#A=7\n#A=NUL") is None
    assert value("#A=7\n#A=X") is None
    assert value("#N%=3\n#E?=B?=NUL", "#E?") is True
    assert value("#L%=LEN(A$)", "#L%") == -1
    for text, name in (
        ("#A=X+1", "X"),
        ("#A=SIN(X)", "X"),
        ("IF X<1 THEN #A=1 ENDIF", "X"),
        ("IF E? THEN #A=1 ENDIF", "E?"),
        ("#N%=NOT I%", "I%"),
        ("#E?=A? AND TRUE", "A?"),
    ):
        assert failure(text).what == f"INVALID VARIABLE: {name} has no value (NUL)", text
    assert failure("#E?=NUL<X").what == "NUL is only compared by = and <>"


# Variables


@pytest.mark.covers("cpl.var.name", "cpl.var.overview")
def test_eight_characters_of_a_name_count() -> None:
    assert value("LONGNAMEA=2.5\nLONGNAMEB=3.5\n#A=LONGNAMEA") == 3.5
    assert value("LONGNAM1=2.5\nLONGNAM2=3.5\n#A=LONGNAM1") == 2.5
    assert value("#SEVENCHX=2.5\n#SEVENCHY=3.5", "#SEVENCH") == 3.5
    assert value("#SIXCHAX=2.5\n#SIXCHAY=3.5", "#SIXCHAX") == 2.5
    assert value("A%=2\nA=3.5\nA!=4.5\nA?=TRUE\n#A=A%+A", "#A") == 5.5
    for keyword in ("TO", "STEP", "SIN", "ENDIF"):
        assert failure(f"#A=2\n{keyword}=3").position.line == 2  # type: ignore[union-attr]


@pytest.mark.covers("cpl.symbol", "cpl.err.2167", "cpl.op.assign", "cpl.ex.443")
def test_a_word_that_stands_alone_is_an_assignment_without_its_sign() -> None:
    error = failure("#A=1\nGOTO10")
    assert (error.what, error.code) == ("= MISSING", "2167")
    assert str(error).startswith("main.cpl:2:10: = MISSING [2167]\n    20 GOTO10\n")
    assert Ran("5 GOTO 10\n7 #A=1\n10 #B=2").run.globals == {"#B": 2.0, "#A": None}
    assert value("STEP%=3\nEND%=4\nTIME%=5\n#A=STEP%*END%*TIME%") == 60.0
    assert value("GOTO10=7\nFOR1=2\nSIN3=4\nIFX=3\nAND2=5\n#A=GOTO10*FOR1+SIN3*IFX+AND2") == 31.0


@pytest.mark.covers("cpl.var.local", "cpl.var.groups")
def test_local_variables_belong_to_their_program() -> None:
    host = RecordingHost(programs={"SP": "1 X=5\n2 #INNER=X\n3 #OUTER=Y"})
    ran = Ran("1 X=2.5 : Y=3.5\n2 CALL SP\n3 #AFTER=X", host)
    assert ran.run.globals == {"#INNER": 5.0, "#OUTER": None, "#AFTER": 2.5}
    twice = Ran("1 CALL SP\n2 CALL SP", RecordingHost(programs={"SP": "1 #OLD=X : X=5"}))
    assert twice["#OLD"] is None


@pytest.mark.covers("cpl.ex.750")
def test_a_variable_takes_the_value_of_another() -> None:
    assert value("XMIN!=1.23456789\nXSET=XMIN!\n#A=XSET") == float(np.float32(1.23456789))
    assert value("N%=7\n#D!=N%", "#D!") == 7.0
    assert isinstance(value("N%=7\n#A=N%"), float)
    assert failure("X=2.5\n#N%=X").what == "INVALID ASSIGNMENT"
    assert failure("#N%=3.0").what == "INVALID ASSIGNMENT"
    assert failure("#N%=4/2").what == "INVALID ASSIGNMENT"


@pytest.mark.covers("cpl.type.ARRAY", "cpl.DIM", "cpl.err.INVALID_FIELD_LIMIT")
def test_fields_have_their_elements_and_no_others() -> None:
    assert value("DIM F(3)\nF(1)=2.5\nF(3)=3.5\n#A=F(1)*F(3)") == 8.75
    assert value("DIM F%(2,3)\nI%=2\nF%(I%,I%+1)=7\nF%(1,3)=5\n#N%=F%(2,3)-F%(1,3)", "#N%") == 2
    assert value("DIM F(3)\n#A=F(2)") is None
    assert value("DIM F(3)\nF(0)=4.5\n#A=F(0)") == 4.5
    assert value("DIM F?(2)\nF?(2)=TRUE\n#E?=F?(2)", "#E?") is True
    assert value("DIM F!(2)\nF!(1)=1.12345678901234\n#D!=F!(1)", "#D!") == 1.12345678901234
    for text in (
        "DIM F(3)\n#A=F(4)",
        "DIM F(3)\nF(4)=1",
        "DIM F(3)\nI%=-1\n#A=F(I%)",
        "DIM F(2,3)\nF(3,2)=1",
    ):
        error = failure(text)
        assert (error.what, error.position.line) == ("INVALID FIELD LIMIT", text.count("\n") + 1)  # type: ignore[union-attr]
    for size in ("0", "65537", "300,300"):
        assert failure(f"DIM F({size})").what == "INVALID FIELD LIMIT"
    assert failure("DIM F(N%)").what.startswith("an INTEGER constant is missing")
    assert failure("F(1)=2").what == "F has 0 indices, not 1"
    assert failure("DIM F(3)\n#A=F").what == "F has 1 indices, not 0"
    assert failure("#F(1)=2").what == "INVALID VARIABLE: the field is not dimensioned"
    assert failure("DIM @X(3)").what == "permanent variables are not dimensioned"
    assert failure("DIM F(3)\nDIM F(4)").what == "INVALID FIELD LIMIT"
    assert failure("DIM F(3)\n#A=F(X%)").what.startswith("INVALID VARIABLE")


@pytest.mark.covers("cpl.ex.690")
def test_positions_fill_a_field() -> None:
    host = RecordingHost({"MPOS": lambda axis: axis * 10.5, "CPOS": lambda axis: axis * 0.25})
    lines = [
        f"FIELDVAR({row},{axis}) = {name}({axis})"
        for axis in (1, 2, 3)
        for row, name in ((1, "MPOS"), (2, "CPOS"))
    ]
    total = "+".join(f"FIELDVAR(1,{axis})*FIELDVAR(2,{axis})" for axis in (1, 2, 3))
    assert value("\n".join(("DIM FIELDVAR(2,3)", *lines, f"#A={total}")), host=host) == 10.5 * 0.25 * 14


# Permanent variables

DECLARED = """DEF INT @ABCD ;simple INTEGER variable
DEF REAL @EFGH ;
DEF DOUBLE @IJKL ;
DEF BOOL @MNOP ;
DEF CHAR @PSTR1(3) ;
DEF INT @WZNR(9) ;
DEF REAL @WZKOR(9,2) ;
DEF CHAR @PSTR2(9,2) ;
"""


def declared(text: str = DECLARED) -> PermanentMemory:
    memory = PermanentMemory()
    assert memory.declare([("wmhperm.dat", text)]) == []
    return memory


@pytest.mark.covers("cpl.var.permanent", "cpl.var.@_R", "cpl.ex.517")
def test_permanent_variables_outlive_the_program() -> None:
    host = RecordingHost(permanent=declared())
    assert {f"@{number}" for number in range(1, 101)} <= set(declared())
    Ran("10 NUMBER1% = 1\n20 #NUMBER2% = 2\n30 @36% = 3\n40 @ABCD% = 4\n50 @_R(100)=1.12345678901234", host)
    assert (host.permanent["@36"], host.permanent["@ABCD%"]) == (3, 4)
    assert host.permanent["@_R"][100] == 1.12345678901234
    assert Ran("10 #A=@36+@ABCD% : #B!=@_R(100)*2", host).run.globals == {"#A": 7.0, "#B!": 2.24691357802468}
    assert failure("@36=NUL").what == "INVALID ASSIGNMENT"
    assert failure("@36=X%").what == "INVALID ASSIGNMENT"
    Ran("10 @1=7 : @100=8", host)
    assert (host.permanent["@1"], host.permanent["@100"]) == (7, 8)
    assert failure("@101=1").what == "there is no permanent variable @101"
    assert failure("@0=1").what == "there is no permanent variable @0"
    assert failure("@" + "9" * 5000 + "=1").what.startswith("there is no permanent variable @999")
    assert failure("@7=2.5").what == "INVALID ASSIGNMENT"


@pytest.mark.covers("cpl.var.@_RES_DOUBLE", "cpl.var.@_RES_DWORD")
@pytest.mark.parametrize("name", ["@_RES_DOUBLE", "@_RES_DWORD"])
def test_internal_variables_are_refused(name: str) -> None:
    assert failure(f"{name}=1").what == f"{name} is reserved for the control itself"


@pytest.mark.covers(
    "cpl.ex.637", "cpl.ex.574", "cpl.ex.623", "cpl.file.wmhperm.dat", "cpl.perm.DEF.INT",
    "cpl.perm.DEF.REAL", "cpl.perm.DEF.DOUBLE", "cpl.perm.DEF.BOOL", "cpl.perm.DEF.CHAR",
)  # fmt: skip
def test_declared_variables_take_the_values_of_their_types() -> None:
    host = RecordingHost(permanent=(memory := declared()))
    host.permanent = memory
    Ran(
        "10 @1 = 1\n15 @2_COUNTER = 2\n20 @ABCD% = 3\n25 @EFGH = 4.1\n30 @IJKL! = 5.12345\n35 @MNOP? = TRUE\n"
        '40 @PSTR1$ = "ABCD"\n45 @WZNR%(2) = 6\n50 @WZKOR(3,2) = 7.6\n55 @PSTR2$(3) = "DE"\n60 @WZNR%(1)=4',
        host,
    )
    assert [memory[name] for name in ("@1", "@2", "@ABCD%", "@EFGH", "@IJKL!", "@MNOP?")] == [
        1, 2, 3, float(np.float32(4.1)), 5.12345, True,
    ]  # fmt: skip
    assert text_of(memory["@PSTR1$"]) == "ABC"
    assert (memory["@WZNR%"][1], memory["@WZNR%"][2]) == (4, 6)
    assert memory["@WZKOR"][3, 2] == float(np.float32(7.6))
    assert text_of(memory["@PSTR2$"][3]) == "DE"
    assert (memory["@WZNR%"].sizes, memory["@PSTR2$"].sizes) == ((9,), (9, 2))
    for whole in ("@_R=1", "@_R%=1", "@WZNR%=A%", "FOR @WZKOR=1 TO 2\nNEXT @WZKOR", '@PSTR2$="AB"'):
        assert failure(f"A%=1\n{whole}", host).what == "INVALID VARIABLE"  # a field keeps its elements
    assert (memory["@WZNR%"][2], memory["@_R"].sizes) == (6, (100,))
    error = failure("#A=1\n@ABCD=3", host)
    assert (error.what, error.position.line) == ("there is no permanent variable @ABCD", 2)  # type: ignore[union-attr]
    assert (
        value("@SIXTEENCHARACTX%=5\n#N%=@SIXTEENCHARACTXYZ%", "#N%", _host("DEF INT @SIXTEENCHARACTX;")) == 5
    )


def _host(text: str) -> RecordingHost:
    host = RecordingHost()
    host.permanent = declared(text)
    return host


def test_declaring_anew_keeps_values_makes_new_ones_and_deletes_the_others() -> None:
    memory = declared()
    memory["@ABCD%"], memory["@EFGH"] = 7, 2.5
    assert memory.declare([("a", "DEF INT @ABCD;\nDEF DOUBLE @EFGH;\n"), ("b", "DEF INT @NEW;")]) == []
    assert (memory["@ABCD%"], memory["@EFGH!"], memory["@NEW%"]) == (7, None, None)
    assert "@EFGH" not in memory
    assert "@WZNR%" not in memory


@pytest.mark.covers("cpl.perm.memory", "cpl.err.PERM_MEMORY", "cpl.err.1869")
def test_the_memory_for_permanent_variables_is_limited() -> None:
    assert PermanentMemory().free == 100678
    for kind, length, most in (("DOUBLE", 16, 2288), ("INT", 16, 2516), ("INT", 8, 3146)):
        lines = [f"DEF {kind} @{number:A>{length - 1}};" for number in range(most + 1)]
        memory = PermanentMemory()
        errors = memory.declare([("anwperm.dat", "\n".join(lines))])
        assert len(errors) == 1, kind
        assert (errors[0].code, errors[0].position.line) == ("1869", most + 1)  # type: ignore[union-attr]
        assert "Memory full" in errors[0].what
    for kind, most in (("INT", 25160), ("DOUBLE", 12580)):
        assert PermanentMemory().declare([("w", f"DEF {kind} @SIXTEENCHARACTE({most});")]) == []
        assert len(PermanentMemory().declare([("w", f"DEF {kind} @SIXTEENCHARACTE({most + 1});")])) == 1


@pytest.mark.covers("cpl.file.wmhperm.dat")
@pytest.mark.parametrize(
    "line", ["DEF INT ABCD;", "DEF LONG @A;", "DEF INT @A", "DEF INT @a;", "DEF INT @A(0);", "DEF CHAR @A(1025);",
             "DEF INT @A(65536);", "DEF INT @A(" + "9" * 5000 + ");", "X", "DEF INT @A;\nDEF INT @A;"],
)  # fmt: skip
def test_a_line_that_declares_nothing_is_refused(line: str) -> None:
    memory = PermanentMemory()
    errors = memory.declare([("wmhperm.dat", line)])
    assert len(errors) == 1
    assert str(errors[0]).startswith(f"wmhperm.dat:{line.count(chr(10)) + 1}:")


# Operators


@pytest.mark.covers("cpl.op.addition", "cpl.op.subtraction", "cpl.op.multiplication", "cpl.ex.784")
def test_arithmetic_has_its_order() -> None:
    assert value("I%=25: XACTUAL=10\n#A=150/(100-I%)+XACTUAL") == 12.0
    assert value("#N%=2+3*5-7-1", "#N%") == 9
    assert value("#N%=-(2+3)*5", "#N%") == -25
    assert value("#N%=2*-3", "#N%") == -6


@pytest.mark.covers("cpl.op.division")
def test_division_is_never_whole() -> None:
    assert value("#A=4/3") == float(np.float32(4 / 3))
    assert value("#A!=37/3", "#A!") == 37 / 3
    assert failure("I%=4/2").what == "INVALID ASSIGNMENT"
    error = failure("X=0\n#A=1/X")
    assert (error.what, error.position.line) == ("division by zero", 2)  # type: ignore[union-attr]


@pytest.mark.covers("cpl.SIN")
@pytest.mark.covers("cpl.op.paren", "cpl.op.precedence", "cpl.ex.870")
def test_and_binds_tighter_than_a_comparison() -> None:
    for number, expected in ((5, "SET"), (4, "UNSET"), (2, "UNSET"), (3, "SET")):
        host = RecordingHost()
        Ran(
            f"10 @20={number}\n20 IF @20 AND 1 <> 0 THEN GOTO .SET\n30 ELSE GOTO .UNSET ENDIF\n"
            "40 .SET : @1=1 : GOTO .DONE\n50 .UNSET : @1=2\n60 .DONE",
            host,
        )
        assert host.permanent["@1"] == {"SET": 1, "UNSET": 2}[expected]
    assert value("#N%=1 OR 6 AND 12", "#N%") == 1 | (6 & 12)
    assert value("#N%=(1 OR 6) AND 12", "#N%") == (1 | 6) & 12
    assert value("#E?=NOT FALSE AND FALSE", "#E?") is False
    assert value("#E?=NOT (FALSE AND FALSE)", "#E?") is True
    assert value("#A=" + "(" * 7 + "2.5" + ")" * 7) == 2.5
    error = failure("#A=" + "(" * 8 + "2.5" + ")" * 8)
    assert (error.what, error.code, error.position.column) == ("NESTING TOO DEEP", "2153", 14)  # type: ignore[union-attr]
    assert failure("#A=" + "(" * 5000 + "2.5" + ")" * 5000).code == "2153"
    assert "more than" in failure("#A=" + "SIN(" * 5000 + "2.5" + ")" * 5000).what


@pytest.mark.covers("cpl.NOT", "cpl.AND", "cpl.OR", "cpl.XOR")
def test_logic_follows_the_table_for_booleans_and_bits() -> None:
    operators: dict[str, Callable[[int, int], int]] = {
        "AND": operator.and_,
        "OR": operator.or_,
        "XOR": operator.xor,
    }
    words = {False: "FALSE", True: "TRUE"}
    for name, function in operators.items():
        for left in (False, True):
            for right in (False, True):
                assert value(f"#E?={words[left]} {name} {words[right]}", "#E?") is function(left, right)
        assert value(f"#N%=-13 {name} 27", "#N%") == function(-13, 27)
    assert value("#E?=NOT TRUE", "#E?") is False
    assert value("#N%=NOT 12", "#N%") == -13
    assert (
        failure("#E?=TRUE AND 1").what
        == "AND takes two BOOLEAN or two INTEGER values, not BOOLEAN and INTEGER"
    )
    assert failure("#N%=2.5 OR 1").what.startswith("OR takes two")
    assert failure("#A=NOT 2.5").what == "NOT takes BOOLEAN or INTEGER, not REAL"


@pytest.mark.covers(
    "cpl.op.eq", "cpl.op.ge", "cpl.op.gt", "cpl.op.ne", "cpl.op.le", "cpl.op.lt", "cpl.string.compare"
)
@pytest.mark.parametrize(
    ("operator", "less", "equal", "greater"),
    [("=", 0, 1, 0), (">=", 0, 1, 1), (">", 0, 0, 1), ("<>", 1, 0, 1), ("<=", 1, 1, 0), ("<", 1, 0, 0)],
)
def test_comparisons(operator: str, less: int, equal: int, greater: int) -> None:
    for left, right, expected in (("2", "3.5", less), ("3.5", "3.5", equal), ("7", "-3.5", greater)):
        assert value(f"X={left}\nY={right}\n#E?=X{operator}Y", "#E?") is bool(expected)
    for left, right, expected in (("ANTON", "WILLY", less), ("A", "A", equal), ("AB", "A", greater)):
        assert value(f'A$="{left}"\n#E?=A${operator}"{right}"', "#E?") is bool(expected)
    assert failure(f'#E?="A"{operator}1').what == "a string is not compared with INTEGER"


def test_strings_are_compared_as_the_manual_does() -> None:
    names = 'A$="ANTON"\nB$="WILLY"\nC$="ABCDE"\nD$="VWXYZ"'
    tests = {
        "A$<B$": True, "MID$(A$,2,3)=MID$(B$,1,3)": False, 'A$<>"TEST"': True, '"A"<="C"': True, "C$>D$": False,
        "A$=C$": False, '"TE"<"WX"': True,
    }  # fmt: skip
    for test, expected in tests.items():
        assert value(f"{names}\n#E?={test}", "#E?") is expected, test


# Functions


@pytest.mark.covers("cpl.ABS", "cpl.SQRT", "cpl.ex.797", "cpl.ex.828")
def test_roots_and_absolute_values() -> None:
    assert value("I% = -125\n#A = 2*SQRT(ABS(100+I%))") == 10.0
    assert value("I% = 44\n#A = 4*SQRT(100+I%)") == 48.0
    assert isinstance(value("#N%=ABS(-7)", "#N%"), int)
    assert value("#A=ABS(2.5)") == 2.5
    assert value("#D!=SQRT(2)", "#D!") == math.sqrt(2)
    assert failure("X=-0.5\n#A=SQRT(X)").what == "INVALID PARAMETER"


@pytest.mark.covers("cpl.INT", "cpl.ROUND", "cpl.ex.808", "cpl.ex.818")
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("INT(10.9)", 10), ("INT(-10.9)", -10), ("Round(10.9)", 11), ("Round(5.5)", 6), ("Round(5.49)", 5),
        ("ROUND(-2.5)", -3), ("INT(7)", 7), ("ROUND(2147483646.7!*1)", None),
    ],
)  # fmt: skip
def test_whole_numbers(text: str, expected: int | None) -> None:
    if expected is None:
        assert failure("#N%=INT(3000000000)").what == "the value is out of the range of its type"
    else:
        assert value(f"#N%={text}", "#N%") == expected


@pytest.mark.covers("cpl.SIN", "cpl.ASIN", "cpl.ex.843")
def test_sine() -> None:
    assert value("ANGLE = 30\nXVALUE = SIN(ANGLE)\nYVALUE = ASIN(XVALUE)\n#A=XVALUE\n#B=YVALUE", "#B") == 30.0
    for angle in (0, 30, 90, 150, 180, 210, 270, 330, 360, -30, -90, 750, 12.5, 1e6 + 0.25):
        assert value(f"#D!=SIN({angle})", "#D!") == pytest.approx(
            math.sin(math.radians(angle % 360)), abs=1e-9
        )
    assert value("#D!=SIN(30)", "#D!") == 0.5
    assert value("#D!=SIN(-180)", "#D!") == 0.0
    assert value("#D!=ASIN(0.5)", "#D!") == 30.0
    assert failure("#A=ASIN(1.5)").what == "INVALID PARAMETER"


@pytest.mark.covers("cpl.COS", "cpl.ACOS")
def test_cosine() -> None:
    for angle in (0, 60, 90, 120, 180, 240, 270, 300, -60, 12.5, 400):
        assert value(f"#D!=COS({angle})", "#D!") == pytest.approx(math.cos(math.radians(angle)), abs=1e-12)
    assert [value(f"#D!=COS({angle})", "#D!") for angle in (60, 90, 120, 180, -300)] == [
        0.5,
        0.0,
        -0.5,
        -1.0,
        0.5,
    ]
    assert value("#D!=ACOS(0.5)", "#D!") == 60.0
    assert value("#D!=ACOS(-0.25)", "#D!") == pytest.approx(math.degrees(math.acos(-0.25)), abs=1e-12)
    assert failure("#A=ACOS(-1.5)").what == "INVALID PARAMETER"


@pytest.mark.covers("cpl.TAN", "cpl.ATAN")
def test_tangent() -> None:
    for angle in (12.5, 45, 135, -45, 225, 80):
        assert value(f"#D!=TAN({angle})", "#D!") == pytest.approx(math.tan(math.radians(angle)), rel=1e-12)
    assert [value(f"#D!=TAN({angle})", "#D!") for angle in (45, 135, -45, -135, 180)] == [
        1.0,
        -1.0,
        -1.0,
        1.0,
        0.0,
    ]
    assert value("#D!=ATAN(1)", "#D!") == 45.0
    assert value("#D!=ATAN(-0.3)", "#D!") == pytest.approx(math.degrees(math.atan(-0.3)), abs=1e-12)
    assert failure("#A=TAN(90)").what == "INVALID PARAMETER"


@pytest.mark.covers("cpl.BCD", "cpl.BIN", "cpl.ex.884", "cpl.ex.897")
def test_numbers_of_four_bit_digits() -> None:
    assert value("#A=BCD(49)") == 73.0
    assert value("#A=BIN(49)") == 31.0
    for number in (0, 7, 10, 1234567, 79999999):
        assert value(f"#N%=BCD({number})", "#N%") == int(str(number), 16)
        assert value(f"#N%=BIN(BCD({number}))", "#N%") == number
    for text in ("BCD(-1)", "BCD(80000000)", "BIN(10)", "BIN(-1)"):
        assert failure(f"#N%={text}").what == "INVALID PARAMETER"


def test_wrong_uses_of_functions_are_refused_before_the_start() -> None:
    for text, what in {
        "#A=SIN()": "SIN takes 1 arguments, not 0",
        "#A=SIN(1,2)": "SIN takes 1 arguments, not 2",
        '#A=SIN("A")': "SIN takes a number, not a string",
        "#A=FIX(1)": "FIX has no function",
        "#A=CLOSE(1)": "CLOSE is a command and has no value",
        "SIN(1)": "SIN does nothing by itself",
        "SIN(1)=2": "nothing can be assigned to SIN",
        "#A=TRUE+1": "+ does not take BOOLEAN",
        "#A=2+": "a value is missing before the end",
        "#A=2 #B=3": "the instruction does not go on with '#B'",
        "#A=)": "a value is missing before ')'",
    }.items():
        assert failure(text).what == what


RESERVED = """
    ABS ACOS AND APOS ASC ASIN ATAN AXO AXP BCD BIN BMP CASE CALL CHR$ CIR CLG CLOCK CLOSE CLR CLS COF COL COS CPROBE
    CPOS CSF DATE DIM DLG DLF DO DSP DPC ELSE END ENDDLG ENDIF ENDCASE EOF ERASE FALSE FIL FILEACCESS FILEDATE FILEPOS
    FILESIZE FOR FXC FXCR FXDEL FXINS GETERR GMD GOTO GPR GWD IC IF INKEY INP INP# INSTR INT LABEL LEN LIN LJUST MCA
    MCODS MCOPS MID$ MMC MPOS MWD NCF NEXT NJUST NOT NUL OF OPENR OPENW OR OTHERWISE PDIM PLC PPOS PRN PRN# PROBE REM
    REPEAT REWRITE RGB ROUND SCL SCS SD SDR SEEK SFK SIN SPOS SQRT STEP STR$ TAN TC TDA TFO THEN TIME TRIM$ TRUE UNTIL
    VAL WAIT WHILE WPOS XOR
"""


@pytest.mark.covers("cpl.reserved")
def test_reserved_words_are_no_variables() -> None:
    for word in RESERVED.split():
        assert word == "REM" or compile_program(f"10 {word}=5", "x")[0] is None, word
        assert compile_program(f"10 DIM {word}(5)", "x")[0] is None, word
        assert compile_program(f"10 CALL P [{word}XY%]", "x")[0] is not None or "#" in word or "$" in word, (
            word
        )


@pytest.mark.covers(
    "cpl.kw.COM",
    "cpl.kw.FIX",
    "cpl.kw.FIXB",
    "cpl.kw.FIXE",
    "cpl.kw.MIC",
    "cpl.kw.TD",
    "cpl.kw.TDR",
    "cpl.kw.TXT$",
)
@pytest.mark.parametrize("word", ["COM", "FIX", "FIXB", "FIXE", "MIC", "TD", "TDR", "TXT$"])
def test_words_without_a_function_are_reserved_all_the_same(word: str) -> None:
    for text in (f"{word}=5", word, f"{word}(1)", f"#A={word}"):
        assert failure(text).what == f"{word} has no function", text


@pytest.mark.covers("cpl.codechars")
def test_points_and_commas_are_text_within_strings() -> None:
    assert value('#A$="1,5.7:#@%?!;=" : #B$="(["', "#A$") == "1,5.7:#@%?!;="
    assert value("#A=.5+5.") == 5.5
    assert value("GOTO .THERE:#A=1\n.THERE:#A=2") == 2.0
    assert failure("#A=1,5").what == "the instruction does not go on with ','"
    assert failure("#A=1 & 2").what == "'&' has no meaning here"


def test_fields_and_strings_keep_their_python_types() -> None:
    ran = Ran('10 DIM #F(2) : #F(1)=2.5 : DIM #S$(4) : #S$="ABCDEF" : #T$=MID$(#S$,2,2)')
    assert isinstance(ran["#F"], Field)
    assert isinstance(ran["#S$"], CharacterField)
    assert shown(ran["#T$"]) == "BC"
