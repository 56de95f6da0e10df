"""Files of CPL programs, byte for byte (Manual 003, chapter 6)."""

from __future__ import annotations

import os
from datetime import datetime
from pathlib import Path

import pytest

from support.cpl_rows import rows_of
from support.cpl_runs import Root

END = b"\x03\n"


@pytest.fixture
def root(tmp_path: Path) -> Root:
    return Root(tmp_path)


# ---------------------------------------------------------------------- sequential files


@pytest.mark.covers("cpl.ex.4063", "cpl.file.seq", "cpl.CLOSE", "cpl.PRN#.n.1-9", "cpl.PRN#")
def test_records_end_with_lf_and_the_file_with_etx_lf(root: Root) -> None:
    text = (
        '1 OPENW(1,"P2",300,"TEST PRN COMMAND")\n2 A$="TEST"\n3 B$="FOR"\n4 C$="PRN COMMAND"\n5 PRN#(1,A$)\n'
        "6 PRN#(1,B$)\n7 PRN#(1,C$)\n8 PRN#(1,A$;)\n9 PRN#(1,B$;)\n10 PRN#(1,C$;)\n{}"
    )
    root.run(text.format("11 CLOSE(1)"))
    assert root.read("P2") == b"TEST\nFOR\nPRN COMMAND\nTESTFORPRN COMMAND\n" + END
    root.write("P2", b"")
    root.run(text.format(""))  # the end of the program closes it as well
    assert root.read("P2") == b"TEST\nFOR\nPRN COMMAND\nTESTFORPRN COMMAND\n" + END


@pytest.mark.covers("cpl.OPENW", "cpl.REWRITE")
def test_an_opened_file_is_appended_to_unless_rewritten(root: Root) -> None:
    root.run('1 OPENW(1,"P5")\n2 PRN#(1,"ONE")\n3 CLOSE(1)\n4 OPENW(1,"P5")\n5 PRN#(1,"TWO")')
    assert root.read("P5") == b"ONE\nTWO\n" + END
    root.run('1 OPENW(3,"P5")\n2 REWRITE(3)\n3 PRN#(3,"3")\n4 CLOSE(3)')
    assert root.read("P5") == b"3\n" + END
    root.run(
        '1 OPENW(3,"P6",1000,4)\n2 PRN#(3,"ABCD")\n3 PRN#(3,"EFGH")\n4 REWRITE(3)\n5 PRN#(3,"X")\n6 CLOSE(3)'
    )
    assert root.read("P6") == b"X   \n" + END


def test_a_program_that_a_program_has_written_runs(root: Root) -> None:
    root.run(
        '1 OPENW(1,"MADE")\n2 PRN#(1,"N1 G0 X37")\n3 PRN#(1,"2 WAIT")\n4 PRN#(1,"3 #X=MPOS(1)")\n5 CLOSE(1)'
    )
    made = root.read("MADE")
    assert made.endswith(END)
    assert root.run(made.decode("ascii")).variables["#X"] == 37
    assert root.run("N5 P MADE").variables["#X"] == 37
    assert root.run("N1 G0 X29\nM30\n\x03\n").end_position_mm["X"] == 29


CALLS = [
    "{n} CALL MADE{din}",
    "N{n} P MADE",
    '{n} IF FILEACCESS("MADE")>0 THEN\n{n}1 CALL MADE{din}\n{n}2 ENDIF',
]


@pytest.mark.covers("cpl.CALL", "cpl.link")
@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("marked", [False, True])
def test_what_a_program_has_written_is_what_it_calls(root: Root, call: str, marked: bool) -> None:
    """The texts have one length, and are written faster than the clock of some disks goes on."""
    root.write("MADE", b"N1 (DIN)\nN2 G0 X11\n" if marked else b"N2 G0 X11\n")
    head = '{n} PRN#(1,"N1 (DIN)")\n' if marked else ""
    write = f'{{n}} OPENW(1,"MADE") : REWRITE(1)\n{head}{{n}} PRN#(1,"N2 G0 X{{x}}") : CLOSE(1)\n'
    lines = [call.format(n=10, din="")]
    for n, x in ((20, 37), (30, 29), (40, 53)):
        lines += [
            write.format(n=n, x=x),
            call.format(n=n + 1, din=" DIN" * (x == 29)),
            f"{n + 2} WAIT",
            f"{n + 3} #X{x}=MPOS(1)",
        ]
    variables = root.run("\n".join(lines)).variables
    assert [variables[f"#X{x}"] for x in (37, 29, 53)] == [37, 29, 53]


@pytest.mark.covers("cpl.CALL")
def test_a_program_left_out_of_linking_may_be_written_before_it_is_called(root: Root) -> None:
    write = '1 OPENW(1,"MADE") : PRN#(1,"N2 G0 X37") : CLOSE(1)\n'
    assert root.run(write + "2 CALL MADE DIN").end_position_mm["X"] == 37
    (root.folder / "MADE").unlink()
    assert root.error(write + "2 CALL MADE") == "2: there is no sub-program MADE"
    assert root.error("1 A=1\n2 CALL MADE DIN") == "2: there is no sub-program MADE"


def test_a_program_that_was_wrong_runs_once_it_is_written_anew(root: Root) -> None:
    write = '{} OPENW(1,"MADE") : REWRITE(1) : PRN#(1,"{}") : CLOSE(1)\n'
    wrong = root.run(write.format(1, "1 A%=") + "2 CALL MADE DIN", check=False)
    assert [Path(each.file).name for each in wrong.alarms] == ["MADE"]
    root.write("MADE", b"N2 G0 X11\n")
    assert root.run(write.format(1, "1 #A=3") + "2 CALL MADE").variables["#A"] == 3


def test_a_file_from_an_editor_is_continued_on_a_new_line(root: Root) -> None:
    root.write("P5", b"N10 X5\nN20 M30")
    root.run('1 OPENW(1,"P5")\n2 PRN#(1,"N30")\n3 CLOSE(1)')
    assert root.read("P5") == b"N10 X5\nN20 M30\nN30\n" + END


@pytest.mark.covers("cpl.ex.4183", "cpl.OPENR")
def test_what_was_written_is_read_back(root: Root) -> None:
    text = (
        "90 DIM A$(35)\nN5 G1 X12.5 Y-3.75 F9000\n95 WAIT\n100 XPOS=MPOS(1)\n110 YPOS=MPOS(2)\n"
        '120 OPENW(1,"P5",500,"AXISPOS")\n130 REWRITE(1)\n140 PRN#(1,"X AXIS",XPOS,"Y AXIS",YPOS)\n150 CLOSE(1)\n'
        '160 OPENR(1,"P5")\n170 INP#(1,A$)\n175 #L%=LEN(A$) : PRN#(0,A$)\n180 CLOSE(1)'
    )
    result = root.run(text)
    assert root.read("P5") == b"X AXIS  12.500Y AXIS  -3.750\n" + END
    assert result.variables["#L%"] == 28
    assert result.messages[-1].text == "MSG: X AXIS  12.500Y AXIS  -3.750"
    assert result.messages[-1].line == 12


@pytest.mark.covers("cpl.ex.4241", "cpl.FILEPOS.mode.1", "cpl.SEEK", "cpl.FILEPOS")
def test_places_in_a_sequential_file_are_bytes(root: Root) -> None:
    found = root.run(
        '1 OPENW(1,"P2",200,"TEST")\n2 FOR I%= 1 TO 10\n3 PRN#(1,"TEST FOR FILEPOS")\n4 NEXT\n5 CLOSE(1)\n'
        '6 OPENR(1,"P2")\n7 SEEK(1,3)\n8 #A%=FILEPOS(1)\n9 #B%=FILEPOS(1,1)\n11 SEEK(1,0)\n12 #C%=FILEPOS(1)\n'
        "13 #D%=FILEPOS(1,1)\n14 CLOSE(1)"
    ).variables
    assert [found[f"#{name}%"] for name in "ABCD"] == [3, 3, 171, 171]


@pytest.mark.covers("cpl.ex.4340", "cpl.FILESIZE.k.1", "cpl.FILESIZE.k.2", "cpl.FILESIZE")
def test_the_size_counts_every_byte_up_to_the_end(root: Root) -> None:
    # 15 bytes a record: the text of the example has lost a character
    found = root.run(
        '1 OPENW(1,2,1000)\n2 FOR I% = 1 TO 20\n3 PRN#(1,"TEST  FILESIZE")\n4 NEXT\n5 CLOSE(1)\n6 OPENR(2,2)\n'
        "7 #A%=FILESIZE(2)\n9 #B%=FILESIZE(2,1)\n10 #C%=FILESIZE(2,2)\n11 CLOSE(2)"
    ).variables
    assert [found[f"#{name}%"] for name in "ABC"] == [302, 302, 300]
    assert len(root.read("P2")) == 302


@pytest.mark.covers("cpl.ex.4288")
def test_a_file_is_read_byte_by_byte(root: Root) -> None:
    record = "!/-!/-!/-!/-!/-!/-!/-!/-"
    said = root.said(
        f'1DIM A$(1):LJUST:OPENW(1,"P271",130,"TEST"):FOR I%=1 TO 10:\nPRN#(1,"{record}"):NEXT:\n'
        'CLOSE(1):OPENR(2,"P271"):FOR I%=1 TO FILESIZE(2,2)-28:\n'
        "IF NOT (EOF(2)) THEN SEEK(2,I%):INP#(2,A$) ENDIF:\n"
        'IF (EOF(2)) THEN PRN#(0,"###",I%,". BYTE: <EOF>"):\nELSE PRN#(0,"###",I%,". BYTE: <",A$,">") ENDIF:\n'
        "NEXT I%:CLOSE(2)\nM30"
    )
    assert len(said) == 10 * 25 - 28
    assert said[:3] == ["1. BYTE: <!>", "2. BYTE: </>", "3. BYTE: <->"]
    assert said[24] == "25. BYTE: <>"  # the LF ends the record
    assert said[25] == "26. BYTE: <!>"


@pytest.mark.covers("cpl.ex.4165", "cpl.EOF")
def test_eof_ends_a_loop_over_all_records(root: Root) -> None:
    root.write("P", b"".join(bytes([65 + n]) * (n + 4) + b"\n" for n in range(7)) + END)
    found = root.run(
        '9 DIM A$(10)\n10 OPENR(1,"P") : #I%=0\n11 WHILE NOT (EOF(1)) DO\n12 INP#(1,A$)\n13 #I%=#I%+1\n14 END\n'
        "15 CLOSE(1)\n16 #A$=A$ : #L%=LEN(A$)"
    ).variables
    assert found["#I%"] == 7
    assert found["#L%"] == 10


@pytest.mark.covers("cpl.PRN#.grow", "cpl.PRN#")
def test_a_file_grows_beyond_what_was_reserved(root: Root) -> None:
    root.run('1 OPENW(1,"P2",130)\n2 FOR I%=1 TO 40\n3 PRN#(1,"0123456789")\n4 NEXT\n5 CLOSE(1)')
    assert root.read("P2") == b"0123456789\n" * 40 + END


# ---------------------------------------------------------------------- random files


@pytest.mark.covers("cpl.ex.3937", "cpl.file.random")
def test_records_of_one_length_are_padded(root: Root) -> None:
    root.run('10 OPENW(2,"P200",1024,10)\n20 FOR I% = 1 TO 3\n30 PRN#(2,"TEST")\n40 NEXT I%\n50 CLOSE(2)')
    assert root.read("P200") == b"TEST      \n" * 3 + END
    root.run(
        '1 OPENW(2,"P201",1024,10)\n2 PRN#(2,"0123456789A")\n3 PRN#(2,"0123456789")\n4 PRN#(2,"")\n5 CLOSE(2)'
    )
    assert root.read("P201") == b"0123456789\n" * 2 + b" " * 10 + b"\n" + END


@pytest.mark.covers("cpl.ex.3953")
def test_another_record_length_is_refused(root: Root) -> None:
    text = '1 OPENW(2,"P200",130,"TEST",10)\n2 PRN#(2,"ABC")\n3 CLOSE(2)\n4 OPENR(1,"P200",{})\n5 CLOSE(1)'
    assert root.error(text.format(5)) == "4: INVALID COMPONENT LENGTH"
    root.run(text.format(10))
    root.write("P200", b"ABC       \nAB      \n" + END)
    assert root.error('1 OPENW(1,"P200",200,10)') == "1: INVALID COMPONENT LENGTH"


@pytest.mark.covers("cpl.ex.3965")
def test_a_program_is_copied_into_records(root: Root) -> None:
    lines = ["N10 G1F10000X1000Y1000Z1000", '1 A$="01234567890123456789"', '2 B$="TEST"', "N20 X0", "M30"]
    root.write("P1", "".join(line + "\n" for line in lines).encode() + END)
    root.run(
        '1 OPENW(1,"PMeas_PRG",500,"RANDOM FILE",10)\n2 OPENR(2,"P1")\n3 DIM A$(30)\n4 FOR I% = 1 TO 5\n'
        "5 INP#(2,A$)\n6 PRN#(1,A$)\n7 NEXT\n8 CLOSE(2)\n9 CLOSE(1)"
    )
    expected = b'N10 G1F100\n1 A$="0123\n2 B$="TEST\nN20 X0    \nM30       \n'
    assert root.read("PMeas_PRG") == expected + END


@pytest.mark.covers("cpl.ex.4043")
def test_a_semicolon_keeps_the_rest_of_an_overwritten_record(root: Root) -> None:
    root.run(
        '1 OPENW(2,"PProg123.PRG",200,36)\n2 PRN#(2,"TEST1 FOR PRN COMMAND WITH SEMICOLON")\n'
        '3 PRN#(2,"TEST2 FOR PRN COMMAND WITH SEMICOLON")\n4 PRN#(2,"TEST3 FOR PRN COMMAND WITH SEMICOLON")\n'
        '6 SEEK(2,1)\n7 PRN#(2,"OVERWRITE";)\n8 CLOSE(2)'
    )
    assert root.read("PProg123.PRG") == (
        b"OVERWRITE PRN COMMAND WITH SEMICOLON\nTEST2 FOR PRN COMMAND WITH SEMICOLON\n"
        b"TEST3 FOR PRN COMMAND WITH SEMICOLON\n" + END
    )


@pytest.mark.covers("cpl.ex.4051")
def test_without_a_semicolon_the_rest_becomes_blanks(root: Root) -> None:
    root.run(
        '1 OPENW(2,"P2",1000,35)\n1 REWRITE(2)\n2 PRN#(2,"TEST1 FOR PRN COMMAND W/O SEMICOLON")\n'
        '3 PRN#(2,"TEST2 FOR PRN COMMAND W/O SEMICOLON")\n4 PRN#(2,"TEST3 FOR PRN COMMAND W/O SEMICOLON")\n'
        '6 SEEK(2,1)\n7 PRN#(2,"OVERWRITE")\n8 CLOSE(2)'
    )
    assert root.read("P2") == (
        b"OVERWRITE"
        + b" " * 26
        + b"\nTEST2 FOR PRN COMMAND W/O SEMICOLON\nTEST3 FOR PRN COMMAND W/O SEMICOLON\n"
        + END
    )


@pytest.mark.covers("cpl.ex.4260", "cpl.FILEPOS", "cpl.FILEPOS.mode.2", "cpl.FILEPOS.mode.3")
def test_places_in_a_random_file_are_records(root: Root) -> None:
    # the printed results belong to records of 127 characters
    asked = " : ".join(f"#{{0}}{n}%=FILEPOS({call})" for n, call in enumerate(("1", "1,1", "1,2", "1,3")))
    found = root.run(
        '1 OPENW(1,"P2",200,"TEST",127)\n2 FOR I%= 1 TO 10\n3 PRN#(1,"TEST FOR FILEPOS")\n4 NEXT\n5 SEEK(1,3,2)\n'
        f"6 {asked.format('A')}\n"
        '10 PRN#(1,"OVERWRITING OF 3RD RECORD FROM BYTE 2 WITH THIS TEXT")\n'
        f"11 SEEK(1,0)\n12 {asked.format('B')}\n13 CLOSE(1)"
    ).variables
    assert [found[f"#A{n}%"] for n in range(4)] == [3, 258, 3, 2]
    assert [found[f"#B{n}%"] for n in range(4)] == [11, 1281, 11, 1]
    third = root.read("P2").split(b"\n")[2]
    assert third == b"TOVERWRITING OF 3RD RECORD FROM BYTE 2 WITH THIS TEXT".ljust(127)


@pytest.mark.covers("cpl.ex.4301", "cpl.LJUST")
def test_records_are_overwritten_and_added_where_seek_goes(root: Root) -> None:
    root.run(
        '1 OPENW(1,27272,200,"TEST",127):LJUST\n2 FOR I%= 1 TO 10\n3 PRN#(1,I%,". Record")\n4 NEXT\n'
        '5 SEEK(1,3,4)\n6 PRN#(1,"OVERWRITE THE 3RD RECORD FROM BYTE 4 WITH THIS TEXT")\n'
        '7 SEEK(1,11):PRN#(1,"11th record")\n8 SEEK(1,11,5):PRN#(1,"@@")\n9 SEEK(1,0):PRN#(1,"new <EOF>")\n11 CLOSE(1)'
    )
    records = root.read("P27272").split(b"\n")
    assert [len(record) for record in records[:12]] == [127] * 12
    assert records[0].rstrip() == b"1. Record"
    assert records[2].rstrip() == b"3. OVERWRITE THE 3RD RECORD FROM BYTE 4 WITH THIS TEXT"
    assert records[9].rstrip() == b"10. Record"
    assert records[10].rstrip() == b"11th@@"
    assert records[11].rstrip() == b"new <EOF>"
    assert records[12:] == [b"\x03", b""]


@pytest.mark.covers("cpl.ex.4357", "cpl.FILESIZE", "cpl.FILESIZE.k.3", "cpl.FILESIZE.k.4")
def test_the_size_of_a_random_file_is_in_records_too(root: Root) -> None:
    found = root.run(
        '1 OPENW(1,"P2",1000,10)\n2 FOR I%= 1 TO 20\n3 PRN#(1,"TEST FILESIZE")\n4 NEXT\n5 CLOSE(1)\n6 OPENR(2,2,10)\n'
        "7 #A%=FILESIZE(2)\n9 #B%=FILESIZE(2,1)\n10 #C%=FILESIZE(2,2)\n10 #D%=FILESIZE(2,3)\n10 #E%=FILESIZE(2,4)\n"
        "11 CLOSE(2)"
    ).variables
    assert [found[f"#{name}%"] for name in "ABCDE"] == [222, 222, 220, 20, 20]


# ---------------------------------------------------------------------- formats


@pytest.mark.covers("cpl.ex.4080")
def test_formats_take_the_numbers_behind_them(root: Root) -> None:
    root.run(
        '10 DIM E$(50)\n20 OPENW(1,"P2",300,"TEST2")\n30 A=5000\n40 R=1.231\n50 B!=4/3\n60 D$="ABCDE"\n'
        '70 E$="CDEFGHI"\n80 PRN#(1,"10";)\n90 PRN#(1,"######","###.###","#.#####",A,R,B!,D$,E$)\n95 CLOSE(1)'
    )
    assert root.read("P2") == b"10  5000  1.2311.33333ABCDECDEFGHI\n" + END


@pytest.mark.covers("cpl.PRN#", "cpl.PRN#.n.0", "cpl.PRN#.hash", "cpl.NJUST")
def test_messages_are_formatted_as_files_are(root: Root) -> None:
    said = root.said(
        '10 PRN#(0,"A=",7," B=",2.5," C=",TRUE)\n20 PRN#(0,"## ## ##",1,2)\n30 PRN#(0,"T ",CHR$(35)," ",TRUE)\n'
        '40 PRN#(0,"#.## of ",TRUE," ###",2.25,"!",41)\n50 LJUST\n60 PRN#(0,"N",10," X",2.5," Y",10.0)\n70 NJUST\n'
        '80 PRN#(0,"X",2.5)\n90 PRN#(0,"##.##",123.4)'
    )
    assert said == [
        "A=        7 B=   2.500 C=TRUE", " 1  2 ##", "T # TRUE", "2.25 of TRUE  41!", "N10 X2.5 Y10", "X   2.500",
        "PRN FORMAT INCORRECT: ##.##", "*****",
    ]  # fmt: skip


@pytest.mark.covers("cpl.PRN#.control", "cpl.PRN#")
def test_chr_13_begins_the_next_record(root: Root) -> None:
    root.run('1 OPENW(1,"P2")\n2 PRN#(1,"ONE",CHR$(13),"TWO",CHR$(9),"3")\n3 CLOSE(1)')
    assert root.read("P2") == b"ONE\nTWO\t3\n" + END
    root.run('1 OPENW(1,"P3",200,4)\n2 PRN#(1,"ONE",CHR$(13),"LONGER")\n3 CLOSE(1)')
    assert root.read("P3") == b"ONE \nLONG\n" + END


# ---------------------------------------------------------------------- reading


@pytest.mark.covers("cpl.ex.4132")
def test_what_does_not_suit_a_variable_stays_in_the_record(root: Root) -> None:
    root.write("P2", b"ABC123456789ABC\n" + END)
    found = root.run(
        '1 OPENR(2,"P2")\n2 DIM C$(3)\n3 DIM D$(3)\n3 I%=1 : J=2 : L?=TRUE\n4 INP#(2,I%,J,L?,C$,K%,D$)\n5 CLOSE(2)\n'
        '6 #I?=I%=NUL : #J?=J=NUL : #L?=L?=NUL : #K%=K%\n7 PRN#(0,C$,"-",D$)'
    )
    assert [found.variables[name] for name in ("#I?", "#J?", "#L?", "#K%")] == [True, True, True, 123456789]
    assert found.messages[-1].text == "MSG: ABC-ABC"


@pytest.mark.covers("cpl.ex.4142", "cpl.INP#", "cpl.INP#.semicolon")
def test_a_record_is_split_into_variables(root: Root) -> None:
    found = root.run(
        '1 OPENW(1,"P2",200,"TEST",22)\n2 PRN#(1,"-12TEST1.23V12ABCD2.4A")\n3 PRN#(1,"-12TEST1.23V12ABCD2.4A")\n'
        '4 PRN#(1,"-12TEST1.23V12ABCD2.4A")\n5 CLOSE(1)\n6 DIM A$(3)\n7 DIM C$(5)\n8 DIM D$(4)\n9 DIM E$(4)\n'
        '10 DIM G$(25)\n11 DIM H$(7)\n12 DIM I$(7)\n13 DIM J$(25)\n14 DIM R(1,2)\n15 OPENR(2,"P2",22)\n'
        "16 INP#(2,B%,D$,R(1,1),MID$(E$,1,1),R(1,2),A$,C$)\n17 INP#(2,G$)\n18 INP#(2,H$;)\n19 INP#(2,I$;)\n"
        '20 INP#(2,J$)\n21 #E?=EOF(2) : CLOSE(2)\n22 PRN#(0,B%,",",D$,",",R(1,1),",",E$,",",R(1,2),",",A$,",",C$)\n'
        '23 PRN#(0,G$) : PRN#(0,H$,",",I$,",",J$)'
    )
    assert [message.text for message in found.messages] == [
        "MSG:       -12,TEST,   1.230,V,  12.000,ABC,D2.4A",
        "MSG: -12TEST1.23V12ABCD2.4A",
        "MSG: -12TEST,1.23V12,ABCD2.4A",
    ]
    assert found.variables["#E?"] is True


@pytest.mark.parametrize(
    ("record", "variable", "what"),
    [
        pytest.param(
            b"2147483648",
            "A%",
            "INVALID INTEGER VALUE",
            marks=pytest.mark.covers("cpl.err.INVALID_INTEGER_VALUE"),
        ),
        pytest.param(
            b"4" + b"0" * 38 + b".5",
            "A",
            "INVALID FLOAT VALUE",
            marks=pytest.mark.covers("cpl.err.INVALID_FLOAT_VALUE"),
        ),
        (b"1" + b"0" * 309, "A!", "INVALID FLOAT VALUE"),
        (b"ABC", "A$", "inadmissible assignment to a non-dimensioned STRING variable"),
    ],
)
def test_a_number_that_is_too_large_is_refused(root: Root, record: bytes, variable: str, what: str) -> None:
    root.write("P2", record + b"\n" + END)
    assert root.error(f'1 OPENR(1,"P2")\n2 INP#(1,{variable})') == f"2: {what}"


def test_numbers_at_their_limits_are_read(root: Root) -> None:
    root.write("P2", b"-2147483648 +17 4.5TRUEFALSE" + b"\n" + END)
    found = root.run('1 OPENR(1,"P2")\n2 INP#(1,#A%,#B%,#C!,#D?,#E?)').variables
    assert [found[f"#{name}"] for name in ("A%", "B%", "C!", "D?", "E?")] == [-(2**31), 17, 4.5, True, False]


# ---------------------------------------------------------------------- the last that is allowed


@pytest.mark.covers(
    *(f"cpl.{each}" for each in (
        "OPENW", "OPENR", "CLOSE", "PRN#", "INP#", "INP#.semicolon", "EOF", "REWRITE", "FILEPOS", "FILEPOS.mode.1",
        "FILEPOS.mode.2", "FILEPOS.mode.3", "SEEK", "FILESIZE", "FILESIZE.k.1", "FILESIZE.k.2", "FILESIZE.k.3",
        "FILESIZE.k.4", "ERASE", "ERASE.ret.0", "FILEDATE", "FILEDATE.mode.1", "FILEACCESS", "file.random", "file.seq",
        "file.name", "err.BLOCK_EXCEEDS_1024", "err.ILLEGAL_FILE_SIZE", "err.INVALID_COMPONENT_LENGTH",
        "err.INVALID_LOGICAL_NUMBER", "err.INVALID_FILE_NAME", "err.INVALID_COMPONENT", "PRN#.n.1-9",
    ))
)  # fmt: skip
def test_files_take_the_last_that_is_allowed(root: Root) -> None:
    """Nine files; 130 bytes, records of 1 and 1024 characters, of 512 twice, a place behind the last."""
    name = "P2345678901234567890123456789X"
    (root.folder / "A_LONG_FOLDER").mkdir()
    found = root.run(
        f'1 OPENW(9,"ONE",130,1) : OPENW(8,"{name}",130,1024) : DIM L$(1024) : DIM H$(512) : DIM R$(1024)\n'
        f'2 H$="{"H" * 512}" : L$=H$+H$ : OPENW(1,"SEQ",130)\n'
        "3 PRN#(9,CHR$(65)) : PRN#(9,CHR$(66)) : PRN#(8,L$) : PRN#(1,L$) : PRN#(1,H$;) : PRN#(1,H$)\n"
        "4 #A%=FILEPOS(9) : SEEK(9,3) : #B%=FILEPOS(9) : #C%=FILEPOS(9,1) : SEEK(9,2,2) : #D%=FILEPOS(9,3)\n"
        '5 CLOSE(9) : CLOSE(8) : CLOSE(1) : OPENR(9,"ONE",1) : OPENR(1,"SEQ") : OPENR(8,"{0}",1024)\n'
        "6 #E%=FILESIZE(9) : #F%=FILESIZE(9,2) : #G%=FILESIZE(9,3) : #H%=FILESIZE(9,4) : #I%=FILESIZE(8,4)\n"
        "7 #J%=FILESIZE(1) : #K%=FILESIZE(1,2) : SEEK(1,2051) : #L?=EOF(1) : SEEK(1,2050) : #M?=EOF(1)\n"
        "8 #N%=FILEPOS(1) : SEEK(1,1) : INP#(1,R$;) : #O%=FILEPOS(1) : INP#(1,R$) : #P%=LEN(R$) : #Q?=EOF(1)\n"
        '9 CLOSE(1) : CLOSE(8) : CLOSE(9) : DIM F$(60) : F$="A_LONG_FOLDER/{0}" : OPENW(2,F$) : CLOSE(2)\n'
        '10 DIM D$(9) : D$=FILEDATE("ONE") : #R?=D$=FILEDATE("ONE",1) : #S%=LEN(D$) : #T%=ERASE(F$)\n'
        "11 #U%=FILEACCESS(F$)".replace("{0}", name)
    ).variables
    numbers = {each: found[f"#{each}%"] for each in "ABCDEFGHIJKNOPSTU"}
    assert numbers == {
        "A": 3, "B": 3, "C": 5, "D": 2, "E": 6, "F": 4, "G": 2, "H": 2, "I": 1, "J": 2052, "K": 2050, "N": 2050,
        "O": 1026, "P": 1024, "S": 8, "T": 0, "U": -1,
    }  # fmt: skip
    assert [found[f"#{each}?"] for each in "LMQR"] == [True, False, True, True]


@pytest.mark.covers("cpl.INP#", "cpl.err.INVALID_INTEGER_VALUE", "cpl.err.INVALID_FLOAT_VALUE")
@pytest.mark.covers("cpl.INP#.semicolon")
def test_numbers_are_read_up_to_the_largest(root: Root) -> None:
    largest = b"340282346638528859811704183484516925440"
    root.write("P2", b"2147483647 -2147483648\n-2147483649\n" + largest + b" .5 -.25 7.\nAB\nCD\n" + END)
    found = root.run(
        '1 OPENR(1,"P2")\n2 INP#(1,#A%,#B%)\n3 INP#(1,Q$)\n4 INP#(1,#C,#D,#E,#F)\n'.replace("Q$", "DUMMY!")
        + '5 DIM R$(2) : INP#(1,R$;) : #P%=FILEPOS(1) : INP#(1,R$;) : #Q?=R$="CD"'
    ).variables
    assert [found[f"#{each}%"] for each in "AB"] == [2**31 - 1, -(2**31)]
    assert [found[f"#{each}"] for each in "CDEF"] == [float(largest), 0.5, -0.25, 7.0]
    assert (found["#P%"], found["#Q?"]) == (90, True)
    assert root.error('1 OPENR(1,"P2")\n2 SEEK(1,24)\n3 INP#(1,A%)') == "3: INVALID INTEGER VALUE"


# ---------------------------------------------------------------------- refusals


REFUSED = [
    ('1 OPENW(0,"P1")', "1: INVALID LOGICAL NUMBER"),
    ('1 OPENW(10,"P1")', "1: INVALID LOGICAL NUMBER", "cpl.err.INVALID_LOGICAL_NUMBER"),
    ('1 OPENW(1,"P1",129)', "1: ILLEGAL FILE SIZE", "cpl.err.ILLEGAL_FILE_SIZE"),
    ('1 OPENW(1,"P1",0)', "1: ILLEGAL FILE SIZE", "cpl.err.ILLEGAL_FILE_SIZE"),
    ('1 OPENW(1,"P1",-130)', "1: ILLEGAL FILE SIZE", "cpl.err.ILLEGAL_FILE_SIZE"),
    ('1 OPENW(1,"P1",130,1025)', "1: INVALID COMPONENT LENGTH", "cpl.err.INVALID_COMPONENT_LENGTH"),
    ('1 OPENW(1,"P1",130,0)', "1: INVALID COMPONENT LENGTH"),
    ('1 OPENW(1,"P1")\n2 OPENR(1,"P1")', "2: INVALID LOGICAL NUMBER"),
    ('1 OPENW(1,"P1")\n2 OPENW(2,"P1")', "2: FILE ALREADY OPEN"),
    ('1 OPENW(1,"main.npg")', "1: FILE ALREADY OPEN"),
    ('1 OPENR(1,"P1")\n2 PRN#(1,"A")', "2: INVALID LOGICAL NUMBER"),
    ('1 OPENW(1,"P1")\n2 INP#(1,A%)', "2: INVALID LOGICAL NUMBER"),
    ("1 CLOSE(4)", "1: INVALID LOGICAL NUMBER"),
    ("1 A%=FILEPOS(10)", "1: INVALID FILE NUMBER", "cpl.err.INVALID_FILE_NUMBER"),
    ('1 OPENR(1,"P1")\n2 A%=FILEPOS(1,2)', "2: INVALID PARAMETER"),
    ('1 OPENW(1,"P1",200,8)\n2 A%=FILEPOS(1,4)', "2: INVALID PARAMETER"),
    ("1 SEEK(11,1)", "1: INVALID FILE NUMBER"),
    ('1 OPENR(1,"P1")\n2 SEEK(1,1,1)', "2: INVALID PARAMETER"),
    ('1 OPENR(1,"P1")\n2 SEEK(1,2)', "2: INVALID COMPONENT"),
    ('1 OPENW(1,"P1",200,8)\n2 PRN#(1,"A")\n3 SEEK(1,3)', "3: INVALID COMPONENT", "cpl.err.INVALID_COMPONENT"),
    ('1 OPENW(1,"P1",200,8)\n2 PRN#(1,"A")\n3 SEEK(1,1,10)', "3: INVALID PARAMETER"),
    ('1 OPENW(1,"P1",200,8)\n2 PRN#(1,"A")\n3 SEEK(1,1,0)', "3: INVALID PARAMETER"),
    ('1 OPENW(1,"P1",200,8)\n2 SEEK(1,-1)', "2: INVALID COMPONENT"),
    ('1 OPENR(1,"P1")\n2 SEEK(1,-1)', "2: INVALID COMPONENT"),
    ('1 OPENW(1,"P1")\n2 PRN#(1,"AB")\n3 CLOSE(1)\n4 OPENR(1,"P1")\n5 SEEK(1,5)', "5: INVALID COMPONENT"),
    ('1 OPENR(1,"P1",0)', "1: INVALID COMPONENT LENGTH"),
    ('1 OPENR(1,"P1",1025)', "1: INVALID COMPONENT LENGTH"),
    ('1 OPENR(0,"P1")', "1: INVALID LOGICAL NUMBER"),
    ("1 A?=EOF(0)", "1: INVALID LOGICAL NUMBER"),
    ('1 OPENR(1,"P1")\n2 A%=FILESIZE(1,0)', "2: INVALID PARAMETER"),
    ('1 OPENR(1,"P1",8)\n2 A%=FILESIZE(1,5)', "2: INVALID PARAMETER"),
    ('1 OPENR(1,"P1",8)\n2 A%=FILEPOS(1,0)', "2: INVALID PARAMETER"),
    ('1 OPENR(1,"P1")\n2 A%=FILEPOS(1,3)', "2: INVALID PARAMETER"),
    ('1 OPENR(1,"P1")\n2 REWRITE(1)', "2: INVALID LOGICAL NUMBER"),
    ('1 DIM D$(9) : D$=FILEDATE("P1",0)', "1: INVALID PARAMETER"),
    ('1 DIM D$(9) : D$=FILEDATE("P1",3)', "1: INVALID PARAMETER"),
    ("1 A%=FILESIZE(0)", "1: INVALID FILE NUMBER"),
    ('1 OPENR(1,"P1")\n2 A%=FILESIZE(1,3)', "2: INVALID PARAMETER"),
    ('1 I%=ERASE("P234567890123456789012345678901")', "1: INVALID FILE NAME", "cpl.err.INVALID_FILE_NAME"),
    ('1 OPENW(1,"..")', "1: INVALID FILE NAME"),
    ('1 OPENW(1,"../P1")', "1: INVALID FILE NAME"),
    ('1 OPENW(1,"OUT/P1")', "1: INVALID FILE NAME"),
    ('1 OPENR(1,"LINK")', "1: INVALID FILE NAME"),
    ('1 OPENR(1,"PIPE")', "1: INVALID FILE NAME"),
    ('1 OPENR(1,"cpl.store")', "1: INVALID FILE NAME"),
    ('1 OPENR(1,"A/P1")', "1: FILE CANNOT BE WRITTEN"),
    ('1 DIM A$(1000)\n2 A$="' + "A" * 600 + '"\n3 OPENW(1,"P1")\n4 PRN#(1,A$,A$)',
                     "4: BLOCK EXCEEDS 1024 BYTES", "cpl.err.BLOCK_EXCEEDS_1024"),
    ('1 DIM A$(1000)\n2 A$="' + "A" * 600 + '"\n3 OPENW(1,"P1")\n4 PRN#(1,A$;)\n5 PRN#(1,A$)',
         "5: BLOCK EXCEEDS 1024 BYTES"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("program", "what"),
    [
        pytest.param(program, what, marks=pytest.mark.covers(*rows_of(program), *rows))
        for program, what, *rows in REFUSED
    ],
)
def test_file_commands_refuse(root: Root, program: str, what: str) -> None:
    outside = root.folder.parent / f"{root.folder.name}_outside"
    outside.mkdir()
    (outside / "P1").write_bytes(b"secret\n")
    (root.folder / "OUT").symlink_to(outside)
    (root.folder / "LINK").symlink_to(outside / "P1")
    os.mkfifo(root.folder / "PIPE")
    assert root.error(program) == what
    assert [path.name for path in outside.iterdir()] == ["P1"]


@pytest.mark.covers("cpl.file.name")
def test_names_have_capitals_folders_and_30_characters(root: Root) -> None:
    (root.folder / "usr").mkdir()
    root.run(
        '1 OPENW(1,"P12_Data_Dial") : OPENW(2,"P12_DATA_DIAL") : OPENW(3,"/usr/P123456789.PRG")\n'
        '2 PRN#(1,"a") : PRN#(2,"b") : PRN#(3,"c") : OPENW(4,"P2345678901234567890123456.890")'
    )
    assert root.read("P12_Data_Dial") == b"a\n" + END
    assert root.read("P12_DATA_DIAL") == b"b\n" + END
    assert root.read("usr/P123456789.PRG") == b"c\n" + END
    assert root.read("P2345678901234567890123456.890") == END
    assert root.error('1 OPENW(4,"P23456789012345678901234567.890")') == "1: INVALID FILE NAME"
    assert root.error('1 OPENW(4,"P1*")') == "1: INVALID FILE NAME"


@pytest.mark.covers("cpl.file.system")
def test_files_in_folders_are_opened_before_access_and_closed_behind(root: Root) -> None:
    (root.folder / "usr" / "data").mkdir(parents=True)
    root.write("usr/data/P1", b"17\n" + END)
    opened = '1 OPENR(3,"usr/data/P1")\n2 INP#(3,#A%)\n3 CLOSE(3)\n'
    assert root.run(opened).variables["#A%"] == 17
    assert root.error(opened + "4 INP#(3,#A%)") == "4: INVALID LOGICAL NUMBER"
    assert root.error('1 PRN#(3,"A")') == "1: INVALID LOGICAL NUMBER"
    assert root.error('1 OPENR(3,"none/P1")') == "1: FILE CANNOT BE WRITTEN"


# ---------------------------------------------------------------------- files by name


@pytest.mark.covers("cpl.ex.4398", "cpl.ERASE", "cpl.ERASE.ret.0", "cpl.ERASE.ret.1", "cpl.ERASE.ret.3")
def test_erase_tells_what_became_of_the_file(root: Root) -> None:
    result = root.run(
        '10 OPENW(1,"P2",200)\n11 OPENW(2,"P3",200)\n12 OPENW(3,"P4")\n20 PRN#(1,"TEST1 FOR ERASE")\n31 CLOSE(1)\n'
        '32 CLOSE(2)\n40 #A%=ERASE("P2")\n43 A$="P3"\n44 ERASE(A$)\n45 #B%=ERASE("P2")\n46 #C%=ERASE("P4")\n'
        '47 IF ERASE("P9")<>0 THEN #D%=5 ENDIF\n48 #E%=ERASE("main.npg")'
    )
    assert [result.variables[f"#{name}%"] for name in "ABCDE"] == [0, 1, 3, 5, 1]
    assert sorted(path.name for path in root.folder.iterdir()) == ["P4"]
    assert "MSG: P4 was not erased: it is active" in [message.text for message in result.messages]


@pytest.mark.covers("cpl.ERASE")
@pytest.mark.covers("cpl.ERASE.ret.2")
def test_a_protected_file_is_not_erased(root: Root) -> None:
    root.write("P2", END)
    (root.folder / "P2").chmod(0o444)
    assert root.run('1 #A%=ERASE("P2")').variables["#A%"] == 2
    assert root.read("P2") == END


@pytest.mark.covers(
    "cpl.FILEACCESS", "cpl.FILEACCESS.bit.1", "cpl.FILEACCESS.bit.2", "cpl.FILEACCESS.bit.3", "cpl.FILEACCESS.bit.4",
    "cpl.FILEACCESS.bit.5", "cpl.FILEACCESS.ret.-1", "cpl.FILEACCESS.ret.0", "cpl.FILEACCESS.active", "cpl.ex.4429",
)  # fmt: skip
@pytest.mark.parametrize(
    ("mode", "open_", "code"),
    [
        (0o644, "", 6),
        (0o444, "", 4),
        (0o555, "", 5),
        (0o200, "", 2),
        (0o000, "", 0),
        (0o644, 'OPENR(1,"P2")', 22),
    ],
)
def test_file_access_tells_rights(root: Root, mode: int, open_: str, code: int) -> None:
    (root.folder / "usr").mkdir()
    root.write("P2", END)
    root.write("usr/test.cnc", b"")
    (root.folder / "P2").chmod(mode)
    found = root.run(
        f'1 #A%=FILEACCESS("P3") : {open_ or "B%=0"}\n2 #B%=FILEACCESS("P2") : #C%=FILEACCESS("usr")\n'
        '3 #D%=FILEACCESS("/usr/test.cnc")'
    ).variables
    assert found == {**found, "#A%": -1, "#B%": code, "#C%": 15, "#D%": 6}


def test_a_program_that_runs_is_active(root: Root) -> None:
    root.write("SP", b'1 #B%=FILEACCESS("SP") : #C%=ERASE("SP")\n')
    root.write("main.npg", b"10 CALL SP\n")
    found = root.run('10 #A%=FILEACCESS("SP")\n20 CALL SP\n30 #D%=FILEACCESS("main.npg")').variables
    assert [found[f"#{name}%"] for name in "ABCD"] == [6, 22, 3, 22]


@pytest.mark.covers("cpl.FILEDATE", "cpl.FILEDATE.mode.1", "cpl.FILEDATE.mode.2", "cpl.ex.4446")
def test_file_date_tells_day_and_time(root: Root) -> None:
    (root.folder / "usr").mkdir()
    root.write("usr/Test.txt", b"")
    at = datetime(2003, 11, 7, 14, 5, 9).timestamp()
    os.utime(root.folder / "usr/Test.txt", (at, at))
    text = (
        '10 DIM DATE$(10)\n20 DATE$=FILEDATE("/usr/Test.txt",{})\n30 IF LEN(DATE$)>0 THEN\n'
        '40 PRN#(0,"File date: ",DATE$)\n50 ENDIF\n60 DATE$=FILEDATE("none") : #L%=LEN(DATE$)'
    )
    assert root.said(text.format(1)) == ["File date: 07.11.03"]
    assert root.said(text.format(2)) == ["File date: 14.05.09"]
    assert root.run(text.format(2)).variables["#L%"] == 0


@pytest.mark.covers("cpl.ex.3925")
def test_names_and_remarks_are_texts_or_variables(root: Root) -> None:
    root.run(
        '50 OPENW(1,"P500",1024,"This is my best program")\n55 A$="P501" : B1$="This is my best program"\n'
        '60 OPENW(9,A$,1024,B1$)\n70 OPENW(7,"PData Meas.DAT",1024,"Store measurement data")'
    )
    assert sorted(path.name for path in root.folder.iterdir()) == ["P500", "P501", "PData Meas.DAT"]


# ---------------------------------------------------------------------- when something goes wrong


def test_an_error_leaves_files_complete_and_permanent_variables_kept(root: Root) -> None:
    text = '1 @7=@7+5 : OPENW(1,"P2")\n2 PRN#(1,"ONE") : PRN#(1,"TW";)\n3 A=1/0'
    root.run("1 @7=2")
    assert root.error(text) == "3: division by zero"
    assert root.read("P2") == b"ONE\nTW\n" + END
    assert root.run("1 A%=@7").variables["@7"] == 7


def test_a_full_disk_is_an_error_of_the_program_and_loses_nothing(
    root: Root, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = os.write

    def full(descriptor: int, data: bytes) -> int:
        if b"THREE" in bytes(data):
            if len(data) > 4:
                return real(descriptor, bytes(data)[:4])
            raise OSError(28, "No space left on device")
        if b"E\n\x03" in bytes(data) and not bytes(data).startswith(b"ONE"):
            raise OSError(28, "No space left on device")
        return real(descriptor, data)

    monkeypatch.setattr("polycnc.controllers.bosch.files._stored.os.write", full)
    error = root.error('1 OPENW(1,"P2")\n2 PRN#(1,"ONE")\n3 PRN#(1,"THREE")\n4 PRN#(1,"FOUR")')
    assert error == "3: FILE CANNOT BE WRITTEN"
    assert root.read("P2") == b"ONE\n" + END


def test_a_reader_sees_what_the_writer_adds(root: Root) -> None:
    said = root.said(
        '1 DIM A$(9)\n2 OPENW(1,"P2")\n3 PRN#(1,"ONE")\n4 OPENR(2,"P2")\n5 INP#(2,A$) : PRN#(0,A$)\n6 PRN#(1,"TWO")\n'
        '7 INP#(2,A$) : PRN#(0,A$) : CLOSE(1)\n8 IF EOF(2) THEN PRN#(0,"END") ENDIF'
    )
    assert said == ["ONE", "TWO", "END"]
