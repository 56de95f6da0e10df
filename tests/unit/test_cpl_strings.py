"""CPL: character fields, references to their parts, functions of texts (Manual 003, chapter 5)."""

from __future__ import annotations

import pytest

from polycnc.errors import ProgramError
from polycnc.nc.cpl import text_of
from support.cpl_host import Ran, RecordingHost


def results(*lines: str, host: RecordingHost | None = None) -> dict[str, object]:
    """Return the global variables after instructions, one a line; texts as texts."""
    ran = Ran("\n".join(f"{number} {line}" for number, line in enumerate(lines, 1)), host)
    return {
        name: value if isinstance(value, int | float) else text_of(value)
        for name, value in ran.run.globals.items()
    }


def failure(*lines: str) -> str:
    with pytest.raises(ProgramError) as caught:
        results(*lines)
    assert caught.value.position is not None
    assert caught.value.position.line == len(lines)
    return caught.value.what


INADMISSIBLE = "inadmissible assignment to a non-dimensioned STRING variable"
GAP = "CHARACTER FIELD NOT ASSIGNED (CHARACTER AREA NOT USED)"


@pytest.mark.covers("cpl.LEN")
@pytest.mark.covers("cpl.type.CHARACTER", "cpl.ex.721", "cpl.string.assign", "cpl.ex.3713", "cpl.ex.3702")
def test_a_dimensioned_string_holds_as_much_as_its_dimension() -> None:
    lines = (
        "DIM AB$(10)",
        "DIM CD$(3,5)",
        'AB$="Z"',
        'CD$(2)="ABC"',
        "#A%=LEN(AB$)",
        "#C%=LEN(CD$(2))",
        "#N%=LEN(CD$(1))",
    )
    assert results(*lines) == {"#A%": 1, "#C%": 3, "#N%": -1}
    assert results("DIM #X$(16)", '#X$=" "', "#N%=LEN(#X$)") == {"#X$": " ", "#N%": 1}
    assert results("DIM #X$(3)", '#X$="ABCDEF"', "#N%=LEN(#X$)") == {"#X$": "ABC", "#N%": 3}
    assert results("DIM #X$(9)", '#X$="ABCDEF"', '#X$="XY"') == {"#X$": "XY"}
    for size in ("0", "1025", "5,1025"):
        assert failure(f"DIM A$({size})") == "INVALID FIELD LIMIT"
    assert failure("DIM CD$(3,5)", 'CD$(4)="A"') == "INVALID FIELD LIMIT"
    assert failure("DIM CD$(3,5)", 'CD$="A"') == "CD$ has 1 indices, not 0"


@pytest.mark.covers("cpl.type.STRINGVAR", "cpl.ex.3394", "cpl.MID$")
def test_a_string_variable_without_dimension_refers_to_its_source() -> None:
    lines = (
        "DIM #A$(10)",
        "DIM #B$(5)",
        '#A$="ABCDEFGHIJ"',
        "#B$=MID$(#A$,2,5)",
        "#C$=MID$(#A$,2,5)",
        "#D$=#C$",
        "#E$=#A$",
    )
    before = results(*lines)
    assert (before["#B$"], before["#C$"], before["#D$"], before["#E$"]) == (
        "BCDEF",
        "BCDEF",
        "BCDEF",
        "ABCDEFGHIJ",
    )
    after = results(*lines, '#A$="QRSTUVWXYZ"')
    assert (after["#B$"], after["#C$"], after["#D$"], after["#E$"]) == (
        "BCDEF",
        "RSTUV",
        "RSTUV",
        "QRSTUVWXYZ",
    )
    part = results(*lines, "#F$=MID$(#C$,3,9)", '#A$="QRSTUVWXYZ"')
    assert part["#F$"] == "TUV"


@pytest.mark.covers("cpl.LEN")
@pytest.mark.covers("cpl.string.assign.fromfield")
@pytest.mark.covers("cpl.string.assign")
def test_only_the_written_part_of_a_field_is_passed_on() -> None:
    assert results("DIM A$(10)", 'A$="ABC"', "#B$=A$", "#N%=LEN(#B$)", 'A$="UVWXYZ"', "#C$=#B$") == {
        "#B$": "UVW", "#N%": 3, "#C$": "UVW",
    }  # fmt: skip


@pytest.mark.covers("cpl.MID$.stmt", "cpl.ex.3417", "cpl.ex.3423", "cpl.err.CHARACTER_FIELD_NOT_ASSIGNED")
@pytest.mark.covers("cpl.MID$")
def test_mid_writes_without_leaving_a_gap() -> None:
    assert results("DIM #A$(10)", '#A$="ABC"', 'MID$(#A$,4,3)="DEF"') == {"#A$": "ABCDEF"}
    assert failure("DIM #A$(10)", '#A$="ABC"', 'MID$(#A$,5,3)="DEF"') == GAP
    for place in ("0", "1025", "-1"):
        assert failure("DIM A$(10)", f'MID$(A$,{place})="A"') == "INVALID PARAMETER"


@pytest.mark.covers("cpl.ex.3439", "cpl.LEN", "cpl.ex.3809")
def test_len() -> None:
    lines = ("DIM X$(10)", 'X$="ABC"', "#I%=LEN(X$)", 'X$=""', "#J%=LEN(X$)", "X$=NUL", "#K%=LEN(X$)")
    assert results(*lines) == {"#I%": 3, "#J%": 0, "#K%": -1}
    lines = (
        "DIM S$(20)",
        'Z$="TEST"',
        'S$="TEST"',
        '#A%=LEN("TEST")',
        "#B%=LEN(Z$)",
        "#C%=LEN(S$)",
        "#D%=LEN(S$+Z$+S$)",
    )
    assert results(*lines) == {"#A%": 4, "#B%": 4, "#C%": 4, "#D%": 12}


@pytest.mark.covers("cpl.INSTR", "cpl.ex.3463")
def test_instr() -> None:
    lines = (
        "DIM A$(8)", "DIM B$(16)", 'A$ = "A" : MID$(A$,2) = "UVWXYZ"', 'B$ = "ABCDEF UVWXYZ GH"',
        "#P%=INSTR(MID$(A$,2),B$,4)", "#Q%=INSTR(MID$(A$,2,4),B$,10)", "#R%=INSTR(MID$(A$,2),B$)", "#S%=INSTR(C$,B$)",
    )  # fmt: skip
    assert results(*lines) == {"#P%": 8, "#Q%": 0, "#R%": 8, "#S%": 0}
    for place in ("0", "1025"):
        assert failure(f'#P%=INSTR("A","AB",{place})') == "INVALID PARAMETER"


@pytest.mark.covers("cpl.ASC", "cpl.CHR$", "cpl.ex.3490", "cpl.ex.3510")
def test_codes() -> None:
    lines = (
        "DIM A$(1)",
        'A$="ABC"',
        'B$="BCD"',
        "#I%=ASC(A$)",
        "#J%=ASC(B$)",
        'A$=""',
        "#K%=ASC(A$)",
        "A$=NUL",
        "#L%=ASC(A$)",
    )
    assert results(*lines) == {"#I%": 65, "#J%": 66, "#K%": -1, "#L%": -1}
    assert results("I%=65", "#A$=CHR$(I%)", "#N%=ASC(CHR$(255))") == {"#A$": "A", "#N%": 255}
    assert failure("#A$=CHR$(256)") == "INVALID PARAMETER"
    assert failure("#A$=CHR$(I%)").startswith("INVALID VARIABLE")


@pytest.mark.covers("cpl.STR$", "cpl.ex.3530", "cpl.ex.3797")
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('STR$("number = ##.###",(37/3))', "number = 12.333"), ('STR$("A$ = ##.###",(37/3))', "A$ = 12.333"),
        ('STR$("##.###",(38/3))', "12.667"), ('STR$("###.##",-(20/3))', " -6.67"),
        ("STR$(2.5)", "   2.500"), ("STR$(7)", "        7"), ("STR$(-1234567)", " -1234567"),
        ("STR$(D!)", "        2.345679"),
        ('STR$("##",-5)', "-5"), ('STR$("####.#",2.25)', "   2.2"), ('STR$("[#]",-0.4)', "[0]"),
    ],
)  # fmt: skip
def test_numbers_as_text(text: str, expected: str) -> None:
    assert results("DIM #A$(40)", "D!=2.3456789", f"#A$={text}")["#A$"] == expected


@pytest.mark.covers("cpl.STR$")
def test_what_str_cannot_write() -> None:
    for text in ('STR$("#",12)', 'STR$("none",1)'):
        assert failure("DIM A$(9)", f"A$={text}") == "FORMAT NOT PERMITTED"
    assert failure("DIM A$(9)", "A$=STR$(X)").startswith("INVALID VARIABLE")
    assert failure("DIM A$(9)", 'A$=STR$("A")') == "STR$ takes a number, not a string"


@pytest.mark.covers("cpl.VAL", "cpl.err.INVALID_ASSIGNMENT", "cpl.ex.3549")
def test_val_ends_where_the_number_does() -> None:
    assert failure('I%=VAL("1.23DE")') == "INVALID ASSIGNMENT"
    assert results('#N%=VAL("-2147483648")') == {"#N%": -2147483648}
    for digits in ("2147483648", "9" * 900):
        assert failure(f'N%=VAL("{digits}")') == "the value is out of the range of its type"
    assert failure(f'D!=VAL("{"9" * 900}.5")') == "the value is out of the range of its type"
    assert results("#N%=VAL(A$)", '#M%=VAL("-")') == {"#N%": None, "#M%": None}


@pytest.mark.covers("cpl.VAL")
@pytest.mark.covers("cpl.ex.3550", "cpl.ex.3551", "cpl.ex.3552", "cpl.ex.3553", "cpl.ex.3555")
@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("#K%", "123DE", 123), ("#J%", "ABC", None), ("#X", "ABC1.23DE", None), ("#R!", "-1.23DE", -1.23),
        ("#Z", "+ 000001234TEST4365", 1234.0), ("#D!", "1234567.234567", 1234567.234567),
        ("#N%", "0", 0), ("#R!", ".5", 0.5),
    ],
)  # fmt: skip
def test_val(name: str, text: str, expected: object) -> None:
    assert results(f'{name}=VAL("{text}")')[name] == expected


@pytest.mark.covers("cpl.ex.3803")
def test_val_of_parts() -> None:
    lines = (
        'A$="XVALUE -0001.234 MM"',
        "#A!=VAL(MID$(A$,7))",
        "#B%=VAL(MID$(A$,7,6))",
        "#C%=VAL(MID$(A$,15,5))",
        "#D%=VAL(MID$(A$,18))",
    )
    assert results(*lines) == {"#A!": -1.234, "#B%": -1, "#C%": 34, "#D%": None}


@pytest.mark.covers("cpl.TRIM$", "cpl.TRIM$.L", "cpl.TRIM$.R", "cpl.ex.3587")
def test_trim() -> None:
    lines = ("DIM #A$(8)", '#A$=" ABCDEF "', '#L$=TRIM$(#A$,"L")', '#R$=TRIM$(#A$,"R")', "#B$=TRIM$(#A$)")
    assert results(*lines) == {"#A$": " ABCDEF ", "#L$": "ABCDEF ", "#R$": " ABCDEF", "#B$": "ABCDEF"}
    assert results(*lines, '#A$=" UVWXYZ "')["#B$"] == "UVWXYZ"
    assert results('#A$=TRIM$("   ")', "#B$=TRIM$(C$)") == {"#A$": "", "#B$": None}
    assert failure('#A$=TRIM$("A","X")') == "INVALID PARAMETER"
    tabs = results("DIM #A$(9)", '#A$=" "+CHR$(9)+" A"+CHR$(10)+" "', "#B$=TRIM$(#A$)", '#L$=TRIM$(#A$,"L")')
    assert (tabs["#B$"], tabs["#L$"]) == ("\t A\n", "\t A\n ")  # blanks only


@pytest.mark.covers("cpl.ex.3829")
def test_trim_of_a_part() -> None:
    lines = (
        'X$="XVALUE  0.123 "', "#A$=MID$(X$,8)", "#B$=TRIM$(MID$(X$,8))", '#C$=TRIM$(MID$(X$,8),"L")',
        '#D$=TRIM$(MID$(X$,8),"R")',
    )  # fmt: skip
    assert results(*lines) == {"#A$": " 0.123 ", "#B$": "0.123", "#C$": "0.123 ", "#D$": " 0.123"}
    found = results("DIM X$(20)", *lines)  # of a field it is a part of the field
    assert {name: found[name] for name in ("#A$", "#B$", "#C$", "#D$")} == {
        "#A$": " 0.123 ", "#B$": "0.123", "#C$": "0.123 ", "#D$": " 0.123",
    }  # fmt: skip


@pytest.mark.covers("cpl.ex.3599", "cpl.ex.3610", "cpl.err.INADMISSIBLE_STRING")
def test_what_a_string_without_dimension_takes() -> None:
    permitted = results('#A$="ABCDE"', "#B$=CHR$(10)", "#D$=MID$(#A$,2,1)", "#C$=MID$(#A$,4,4)")
    assert permitted == {"#A$": "ABCDE", "#B$": "\n", "#D$": "B", "#C$": "DE"}
    for line in (
        'MID$(A$,1,4)="ABCD"',
        "A$=MID$(A$,1,3) + MID$(A$,4,1)",
        "A$=B$ + A$",
        "A$=STR$(5)",
        'A$=TRIM$("A"+"B")',
    ):
        assert failure('A$="ABCDE"', 'B$="X"', line) == INADMISSIBLE


@pytest.mark.covers("cpl.ex.3623")
def test_a_single_character() -> None:
    assert results("DIM V$(13)", 'V$="TEST TEST TES"', "I%=12", "#A$=MID$(V$,12,1)", "#B$=MID$(V$,I%,1)") == {
        "#A$": "E",
        "#B$": "E",
    }


@pytest.mark.covers(
    "cpl.ex.3637",
    "cpl.ex.3646",
    "cpl.ex.3654",
    "cpl.ex.3664",
    "cpl.ex.3674",
    "cpl.ex.3686",
    "cpl.err.CHARACTER_AREA_NOT_USED",
)
def test_parts_of_a_field_are_written_one_behind_the_other() -> None:
    b = 'B$="ABCDE"'
    assert results("DIM #X$(15)", b, "MID$(#X$,1,5)=B$", "MID$(#X$,6,5)=B$") == {"#X$": "ABCDEABCDE"}
    assert failure("DIM #X$(15)", b, "MID$(#X$,6,5)=B$") == GAP
    once = ("DIM #X$(100)", b, "MID$(#X$,1,10)=B$", "#N%=LEN(#X$)")
    assert results(*once) == {"#X$": "ABCDE", "#N%": 5}
    assert results(*once, 'MID$(#X$,6,3)="T"', "#N%=LEN(#X$)") == {"#X$": "ABCDET", "#N%": 6}
    digits = ("DIM #X$(20)", 'MID$(#X$,1,10)="1234567890"', 'MID$(#X$,3,3)="T"', "#N%=LEN(#X$)")
    assert results(*digits) == {"#X$": "12T4567890", "#N%": 10}
    assert failure("DIM #X$(20)", 'MID$(#X$,1,6)="ABCDEF"', 'MID$(#X$,9,5)="TESTE"') == GAP


@pytest.mark.covers("cpl.ex.3722")
def test_a_part_that_is_too_long_is_cut_off() -> None:
    lines = ["DIM #X$(16)", 'A$="DAS "', 'B$="IST EIN TEST"', "MID$(#X$,1,4)=A$"]
    assert results(*lines) == {"#X$": "DAS "}
    lines.append("MID$(#X$,5,6)=B$")
    assert results(*lines) == {"#X$": "DAS IST EI"}
    lines.append("MID$(#X$,5,12)=B$")
    assert results(*lines) == {"#X$": "DAS IST EIN TEST"}


@pytest.mark.covers("cpl.ex.3753")
def test_comparing_texts() -> None:
    lines = [
        f'{name}$="{text}"' for name, text in (("A", "ANTON"), ("B", "WILLY"), ("C", "ABCDE"), ("D", "VWXYZ"))
    ]
    tests = (
        "A$<B$",
        "MID$(A$,2,3)=MID$(B$,1,3)",
        'A$<>"TEST"',
        '"A"<="C"',
        "C$>D$",
        "A$=C$",
        '"TE"<MID$(D$,2,2)',
    )
    found = results(*lines, *(f"#E{number}?={test}" for number, test in enumerate(tests)))
    assert list(found.values()) == [True, False, True, True, False, False, True]


@pytest.mark.covers("cpl.ex.3781", "cpl.op.chain")
def test_chains_go_into_fields() -> None:
    dims = [
        f"DIM #{name}$({size})"
        for name, size in (
            ("C", 10),
            ("D", 10),
            ("K", 10),
            ("E", 20),
            ("F", 5),
            ("G", 10),
            ("H", 12),
            ("I", 5),
        )
    ]
    given = ['A$="THIS "', 'B$="IS A TEST"', 'X$="ABC"', 'Y$="DEFG"']
    chains = [
        "MID$(#C$,1,6)=A$+B$", "MID$(#D$,1,10)=MID$(A$,1,1)+MID$(B$,1,2)", "#E$=A$+MID$(B$,1)", "#F$=X$+Y$",
        "#G$=X$+A$", '#H$=X$+A$+"TEST"', '#I$="TES"+"T1"', "MID$(#K$,1,9)=X$+A$",
    ]  # fmt: skip
    assert results(*dims, *given, *chains) == {
        "#C$": "THIS I", "#D$": "TIS", "#E$": "THIS IS A TEST", "#F$": "ABCDE", "#G$": "ABCTHIS ",
        "#H$": "ABCTHIS TEST",
        "#I$": "TEST1",
        "#K$": "ABCTHIS ",
    }  # fmt: skip
    assert failure("DIM A$(9)", "A$=B$+C$").startswith("INVALID VARIABLE")
    assert failure("DIM A$(9)", 'A$="A"-"B"') == "texts are joined by +, not by -"


@pytest.mark.covers("cpl.ex.3785")
@pytest.mark.parametrize("chain", ["A$+B$", "B$+C$", 'A$+B$+"TEST"', '"TEST"+"TEST1"'])
def test_chains_need_a_field(chain: str) -> None:
    assert failure('A$="A"', 'B$="B"', 'C$="C"', f"D$={chain}") == INADMISSIBLE


@pytest.mark.covers("cpl.err.2153")
def test_chains_are_nested_three_deep() -> None:
    assert results("DIM #A$(9)", '#A$="A"+("B"+("C"+("D"+"E")))') == {"#A$": "ABCDE"}
    assert failure("DIM #A$(9)", '#A$="A"+("B"+("C"+("D"+("E"+"F"))))') == "NESTING TOO DEEP"


@pytest.mark.covers("cpl.ex.3821", "cpl.ex.3825")
def test_parts_read_and_written() -> None:
    lines = ["DIM A$(4)", "DIM #D$(10)", 'A$="ABCD"', 'B$="1234567890"', 'C$="E"', 'F$="B"']
    reads = {
        "MID$(A$,2,2)": "BC",
        "MID$(A$,2,5)": "BCD",
        "MID$(A$,5,1)": None,
        "MID$(A$,2)": "BCD",
        "MID$(F$,1,1)": "B",
    }
    for read, expected in reads.items():
        assert results(*lines, f"#R$={read}")["#R$"] == expected
    for line, expected in (
        ("#D$=A$", "ABCD"),
        ("MID$(#D$,2,3)=B$", "A123"),
        ("MID$(#D$,5,1)=C$", "A123E"),
        ("MID$(#D$,4)=B$", "A121234567"),
    ):
        lines.append(line)
        assert results(*lines)["#D$"] == expected


@pytest.mark.covers("cpl.string.functions")
def test_texts_of_the_control_are_taken_too() -> None:
    host = RecordingHost(
        {"DATE": lambda: "24.12.", "NCF": lambda name: f"{name}!", "FILEDATE": lambda *given: None}
    )
    lines = ("#A$=DATE", "DIM #B$(4)", '#B$=NCF("G1")', '#C%=LEN(FILEDATE("X"))', "#D!=VAL(DATE)*2")
    assert results(*lines, host=host) == {"#A$": "24.12.", "#B$": "G1!", "#C%": -1, "#D!": 48.24}
