"""Sub-programs called by G, M and P words, and those that are called again after every move."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.nc import ProgramText
from polycnc.nc.cpl import holds_cpl
from polycnc.runner import check
from support.cpl_runs import Root
from support.programs import MILL

COUNT = b"1 IF #N%=NUL THEN #N%=0 ENDIF\n2 #N%=#N%+1 : #S=P1\n"


@pytest.fixture
def root(tmp_path: Path) -> Root:
    return Root(tmp_path)


@pytest.mark.covers("cpl.sub.GMP")
@pytest.mark.parametrize(
    ("file", "block"),
    [
        ("G322", "N10 G322"),
        ("G322", "G322[2.5]"),
        ("M50", "N10 M050 (remark)"),
        ("M50", "N10 M50[2.5]"),
        ("P999", "N10 P999"),
        ("999", "N10 P 999 (a) (b)"),
        ("999", "P999[2.5]"),
        ("SP", "N10 P SP[2.5]"),
    ],
)
@pytest.mark.covers("cpl.sub")
def test_codes_call_the_programs_of_their_names(root: Root, file: str, block: str) -> None:
    root.write(file, COUNT)
    found = root.run(f"{block}\nN20 G0 X30\n{block}\nM30").variables
    assert (found["#N%"], found["#S"]) == (2, 2.5 if "[" in block else None)


@pytest.mark.covers("cpl.sub.GMP")
@pytest.mark.covers("cpl.sub")
def test_codes_of_the_control_and_unknown_ones_call_nothing(root: Root) -> None:
    for name in ("G1", "M3", "M50.bak"):
        root.write(name, COUNT)
    found = root.run("1 #A%=5\nN10 G1\nN20 M3 S300\nN30 M3\nN40 M50\nN50 X7 F600").variables
    assert found == {**found, "#A%": 5}
    assert "#N%" not in found
    root.write("M50", COUNT)
    assert root.run("1 #A%=5\nN10 M50 X3 F600\nN20 M50").variables["#N%"] == 1
    assert root.error("N10 P77") == "1: there is no sub-program 77"


def test_a_code_alone_makes_a_program_one_with_calls() -> None:
    alone = frozenset(("G322", "M50"))
    for line in (b"G322", b"N3 M050 (x)", b"/ N3 G322", b"\tg 322"):
        assert holds_cpl(b"N1 X1\n" + line + b"\r\nM30\n", alone), line
        assert not holds_cpl(b"N1 X1\n" + line + b"\r\nM30\n"), line
    for line in (b"G3220", b"M5", b"X G322.5", b"G322.1", b"(G322)"):
        assert not holds_cpl(b"N1 X1\n" + line + b"\nM30\n", alone), line
    assert holds_cpl(b"N1 X1\nN5 P 999 (remark)\r\n")
    assert not holds_cpl(b"N1 X1\nP999 X3\nG4 P2\n")


HOLE = (
    b"1 IF #N%=NUL THEN #N%=0 : DIM #P(9) ENDIF\n"
    b"2 #N%=#N%+1 : #P(#N%)=CPOS(1) : #Q=P1\nN3 G91 G0 Z-2\nN4 Z2\nN5 G90\n"
)


@pytest.mark.covers("cpl.nc.G81_G86", "cpl.sub.modal")
@pytest.mark.covers("cpl.sub")
def test_drilling_programs_follow_every_move_until_they_are_cancelled(root: Root) -> None:
    root.write("99999083", HOLE)
    found = root.run(
        "1 X=40\nN10 G0 X5\nN20 G83[3.5]\nN30 G0 X10\nN40 Y7\nN50 G4 F0.1\nN60 F900\nN65 G92 X33\n70 IF X>3 THEN\n"
        "N80 G1 X[X] M8\n90 ENDIF\nN100 G80\nN110 X50\nN120 X60"
    ).variables
    assert isinstance(found["#P"], list)
    assert (found["#P"][1:5], found["#N%"], found["#Q"]) == ([5, 10, 10, 40], 4, 3.5)


@pytest.mark.covers("cpl.nc.G81_G86", "cpl.sub.GMP")
@pytest.mark.parametrize("code", range(81, 87))
def test_each_drilling_cycle_has_its_program(root: Root, code: int) -> None:
    root.write(f"999990{code}", f"1 #C%={code}\n".encode())
    assert root.run(f"1 #A=1\nN10 G{code}").variables["#C%"] == code
    assert root.run(f"N10 G{code}").variables["#C%"] == code
    assert root.run(f"N10 G{code}[4]").variables["#C%"] == code


@pytest.mark.covers("cpl.sub.modal")
@pytest.mark.covers("cpl.sub")
def test_modal_calls_reach_sub_programs_but_not_their_own(root: Root) -> None:
    root.write("99999081", HOLE)
    root.write("ROW", b"N1 G0 X10\nN2 X20\n")
    found = root.run(
        "1 #A=1\nN10 G81[1.5]\n20 CALL ROW\n/N25 X99\nN30 P ROW\nN40 G80 X70\n50 CALL ROW"
    ).variables
    assert isinstance(found["#P"], list)
    assert (found["#P"][1:7], found["#N%"]) == ([0, 10, 20, 99, 10, 20], 6)
    again = root.run("1 #A=1\nN10 G0 X10\nN20 X20").variables
    assert "#N%" not in again


@pytest.mark.covers("cpl.sub.modal")
@pytest.mark.covers("cpl.sub")
def test_the_last_modal_call_is_the_one_that_holds(root: Root) -> None:
    root.write("99999081", b"1 IF #A%=NUL THEN #A%=0 ENDIF\n2 #A%=#A%+P1%\n")
    root.write("99999082", b"1 IF #B%=NUL THEN #B%=0 ENDIF\n2 #B%=#B%+P1%\n")
    found = root.run("1 C=3\nN10 G81[7]\nN20 G0 X3\nN30 G82[11]\nN40 X5\nN50 X7\nN60 G81[13]\nM30").variables
    assert (found["#A%"], found["#B%"]) == (27, 33)


def test_a_cycle_without_a_program_of_its_own_stays_the_control_s(root: Root) -> None:
    result = root.run("1 Z=-4\nN10 G0 Z5\nN20 G81 X10 Y3 Z[Z] R2 F600\nN30 X20\nN40 G80")
    assert result.extents_mm["Z"][0] == -4


@pytest.mark.covers("cpl.remark.nc", "cpl.TYP2", "cpl.changed.TYP2")
def test_an_old_program_has_five_softkeys(root: Root) -> None:
    program = '10 SFK(#K%,"A","B","C","D","E","F","G","H")\n20 SFK(#L%,"A")'
    keys = ("SOFTKEY7", "SOFTKEY3", "SOFTKEY8", "SOFTKEY5")
    new = root.run(program, keys=keys).variables
    assert (new["#K%"], new["#L%"]) == (7, 3)
    old = root.run(f"\nN10 (TYP2)\n{program}", keys=keys).variables
    assert (old["#K%"], old["#L%"]) == (3, 5)
    later = root.run(f"N5 G0 X1\nN10 (TYP2)\n{program}", keys=keys).variables
    assert (later["#K%"], later["#L%"]) == (7, 3)
    root.run('N10 (TYP2)\n10 SFK(#K%,"A","B","C","D","LAST","GONE")', keys=("SOFTKEY1",), screen="s.txt")


@pytest.mark.covers("cpl.var.defperm")
def test_declarations_are_looked_for_in_root_and_feproms(root: Root) -> None:
    for folder in ("usrfep", "fep"):
        (root.folder / folder).mkdir()
    root.write("fep/wmhperm.dat", b"DEF INT @MAKER ;\n")
    root.write("fep/anwperm.dat", b"DEF INT @LAST ;\n")
    root.write("usrfep/anwperm.dat", b"DEF INT @SECONDSECONDSECOND ;\n")
    root.run("1 @MAKER%=7 : @SECONDSECONDSECX%=9")
    found = root.run("1 #A%=@MAKER%*3").variables
    assert (found["#A%"], found["@SECONDSECONDSEC%"], "@LAST%" in found) == (21, 9, False)
    root.write("anwperm.dat", b"DEF BOOL @FIRST ;\nDEF REAL @F2(9,3) ;\n")
    found = root.run("1 @FIRST?=TRUE : @F2(9,3)=0.2").variables
    assert (found["@FIRST?"], "@SECONDSECONDSEC%" in found, found["@MAKER%"]) == (True, False, 7)
    root.write("usrfep/wmhperm.dat", b"DEF INT @A ;\nDEF NOTHING @B ;\n")
    alarms = root.run("1 A=1", check=False).alarms
    assert [(alarm.file, alarm.line) for alarm in alarms] == [("usrfep/wmhperm.dat", 2)]
    root.write("usrfep/wmhperm.dat", b"DEF CHAR @A(1024) ;\nDEF DOUBLE @B(13000) ;\n")
    assert [message.text for message in root.run("1 A=1").messages] == ["MSG: @B! not installed. Memory full"]
    errors = check(ProgramText.from_text("1 A=1", "main.npg"), MILL, "bosch", root=root.folder)
    assert [error.code for error in errors] == ["1869"]
