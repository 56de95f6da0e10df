"""Link tables on disk: made by linking, used again while the program stays as it is, never trusted further."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from polycnc.controllers.bosch import Pnc
from polycnc.nc import ProgramText
from polycnc.nc.cpl import Linker, LinkTable, read_table, written_table
from polycnc.nc.cpl._link_table import LinkedCall, text_digest
from polycnc.runner import check, run
from support.cpl_runs import Root
from support.programs import MILL

MAIN = "10 #A%=3\n20 CALL SUB[#A%]\nM30\n"
SUB = "1 #B%=P1%*7\n2 CALL DEEP\n"
DEEP = "1 #C%=#B%+2\n"


@pytest.fixture
def root(tmp_path: Path) -> Root:
    root = Root(tmp_path)
    for name, text in (("main.npg", MAIN), ("SUB", SUB), ("DEEP", DEEP)):
        root.write(name, text.encode())
    return root


def ran(root: Root, *, name: str = "main.npg") -> tuple[dict[str, object], list[str], list[str]]:
    """Return variables, remarks and errors of a run of a program on disk."""
    result = run(root.folder / name, MILL, "bosch", root=root.folder, check=False)
    remarks = [message.text for message in result.messages if "link table" in message.text]
    return result.variables, remarks, [f"{alarm.file}:{alarm.line}: {alarm.text}" for alarm in result.alarms]


def tables(root: Root) -> list[str]:
    return sorted(path.relative_to(root.folder).as_posix() for path in root.folder.rglob("*.l"))


def made_at(root: Root) -> dict[str, int]:
    return {name: (root.folder / name).stat().st_mtime_ns for name in tables(root)}


@pytest.mark.covers("cpl.link", "cpl.param.3080_00004")
def test_linking_leaves_tables_and_uses_them_until_a_program_changes(root: Root) -> None:
    found, remarks, errors = ran(root)
    assert (found["#C%"], remarks, errors) == (23, [], [])
    assert tables(root) == ["DEEP.l", "SUB.l", "main.npg.l"]
    program, table = read_table((root.folder / "SUB.l").read_text()) or ("", None)
    assert program == "SUB"
    assert table == LinkTable(text_digest(SUB), (LinkedCall(14, 2, "", "DEEP", False),))
    before = made_at(root)
    assert ran(root)[0]["#C%"] == 23
    assert made_at(root) == before
    root.write("SUB", SUB.replace("7", "9").encode())
    assert ran(root)[0]["#C%"] == 29
    after = made_at(root)
    assert [name for name in before if after[name] != before[name]] == ["SUB.l"]


@pytest.mark.covers("cpl.param.3080_00004")
def test_tables_lie_in_the_folder_that_the_parameter_names(root: Root) -> None:
    root.write("macoda.dat", b'3080 00004 = "/made/of/it"\n')
    (root.folder / "made" / "of" / "it").mkdir(parents=True)
    assert ran(root)[0]["#C%"] == 23
    names = [f"made/of/it/{name}.l" for name in ("DEEP", "SUB", "main.npg")]
    assert tables(root) == names
    before = made_at(root)
    assert ran(root)[1:] == ([], [])
    assert made_at(root) == before


@pytest.mark.covers("cpl.link")
def test_a_sub_program_with_a_table_is_not_linked_again(root: Root) -> None:
    wrong = "1 #B%=\n"
    root.write("main.npg", b"10 IF 3=5 THEN\n20 CALL SUB[2]\n30 ENDIF\n40 #A%=11\n")
    root.write("SUB", wrong.encode())
    assert ran(root)[2] == ["SUB:1: a value is missing before the end"]
    assert tables(root) == []
    root.write("SUB.l", written_table("SUB", LinkTable(text_digest(wrong), ())).encode())
    assert ran(root)[0]["#A%"] == 11  # linking believes the table, and nothing calls the program
    root.write("main.npg", b"20 CALL SUB[2]\n")
    assert ran(root)[2] == ["SUB:1: a value is missing before the end"]
    assert tables(root) == ["main.npg.l"]


def test_calls_of_a_linked_sub_program_are_followed(root: Root) -> None:
    ran(root)
    (root.folder / "DEEP").unlink()
    assert ran(root)[2] == ["SUB:2: there is no sub-program DEEP"]
    assert tables(root) == []
    root.write("DEEP", b"1 CALL SUB\n")
    assert ran(root)[2] == ["DEEP:1: SUB calls itself"]


@pytest.mark.covers("cpl.link")
def test_a_refused_program_leaves_no_table(root: Root) -> None:
    ran(root)
    root.write("DEEP", b"1 GOTO .NONE\n")
    assert ran(root)[2] == ["DEEP:1: there is no jump destination .NONE"]
    assert tables(root) == []
    root.write("DEEP", b"1 #C%=@UNKNOWN%\n")
    assert ran(root)[2] == ["DEEP:1: there is no permanent variable @UNKNOWN%"]
    assert tables(root) == ["SUB.l", "main.npg.l"]


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"CPL LINK V7.3 \x00\x07\xff",
        b"[" * 9000,
        json.dumps({"polycnc CPL link table": 2, "content": {}, "check": ""}).encode(),
        written_table("SUB", LinkTable(text_digest(SUB), ())).replace('"SUB"', '"BUS"').encode(),
        written_table("SUB", LinkTable(text_digest(SUB), ((3, "x", 5),))).encode(),  # type: ignore[arg-type]
        written_table("SUB", LinkTable(text_digest(SUB), (LinkedCall(-4, 2, "", "DEEP", False),))).encode(),
        written_table("SUB", LinkTable(text_digest(SUB), (LinkedCall(4, 2, "Q", "DEEP", False),))).encode(),
    ],
)
def test_a_table_that_is_no_good_is_written_anew_with_one_remark(root: Root, content: bytes) -> None:
    ran(root)
    right = root.read("SUB.l")
    root.write("SUB.l", content)
    found, remarks, errors = ran(root)
    assert (found["#C%"], errors) == (23, [])
    assert remarks == ["the link table SUB.l is damaged or not of this control: it is written anew"]
    assert root.read("SUB.l") == right
    assert ran(root)[1] == []


@pytest.mark.covers("cpl.link", "cpl.param.3080_00001")
def test_tables_lie_in_their_folder_and_go_with_their_programs(root: Root) -> None:
    root.write("macoda.dat", b'3080 00004 = "/tables"\n3080 00001 = "/", "/usr/parts"\n')
    (root.folder / "usr" / "parts").mkdir(parents=True)
    (root.folder / "DEEP").rename(root.folder / "usr" / "parts" / "DEEP")
    assert ran(root)[0]["#C%"] == 23
    assert tables(root) == ["tables/DEEP.l", "tables/SUB.l", "tables/main.npg.l"]
    root.write("tables/notes.l", b"no table at all")
    (root.folder / "SUB").unlink()
    Pnc(root.folder, MILL).close()
    assert tables(root) == ["tables/DEEP.l", "tables/main.npg.l", "tables/notes.l"]
    (root.folder / "usr" / "parts" / "DEEP").rename(root.folder / "usr" / "DEEP")  # beside the search path
    Pnc(root.folder, MILL).close()
    assert tables(root) == ["tables/main.npg.l", "tables/notes.l"]


@pytest.mark.covers("cpl.option.DIN")
def test_programs_that_are_not_linked_have_no_table(root: Root, tmp_path: Path) -> None:
    root.write("main.npg", b"10 CALL SUB DIN\n20 CALL DEEP\n30 CALL PLAIN\n")
    root.write("SUB", b"N10 G0 X3\n")
    root.write("DEEP", b"(DIN)\nN10 G0 X5\n")
    root.write("PLAIN", b"N10 G0 X7\n")
    assert ran(root)[2] == []
    assert tables(root) == ["main.npg.l"]
    outside = tmp_path.parent / f"{tmp_path.name}.npg"
    outside.write_text("10 #A%=13\n")
    result = run(outside, MILL, "bosch", root=root.folder)
    assert result.variables["#A%"] == 13
    assert not outside.with_name(f"{outside.name}.l").exists()
    assert check(root.folder / "main.npg", MILL, "bosch", root=root.folder) == []
    text = ProgramText.from_text("10 #A%=17\n", str(root.folder / "unsaved.npg"))
    assert run(text, MILL, "bosch", root=root.folder).variables["#A%"] == 17
    assert tables(root) == ["main.npg.l"]


def test_a_table_that_cannot_be_kept_is_a_remark(root: Root, tmp_path: Path) -> None:
    long = "A_PROGRAM_WITH_A_LONG_NAME.npg"
    assert len(long) == 30
    root.write(long, b"10 #A%=19\n")
    found, remarks, errors = ran(root, name=long)
    assert (found["#A%"], errors, tables(root)) == (19, [], [])
    assert remarks == [f"the link table {long}.l cannot be kept: a name has at most 30 characters"]
    root.write("macoda.dat", b'3080 00004 = "/blocked"\n')
    root.write("blocked", b"a file")
    found, remarks, errors = ran(root)
    assert (found["#C%"], errors) == (23, [])
    assert [remark.partition(":")[0] for remark in remarks] == [
        f"the link table {name}.l cannot be kept" for name in ("DEEP", "SUB", "main.npg")
    ]


def test_a_link_leads_no_table_out_of_the_root(root: Root, tmp_path: Path) -> None:
    outside = tmp_path.parent / f"{tmp_path.name}.kept"
    outside.write_bytes(b"kept")
    (root.folder / "SUB.l").symlink_to(outside)
    assert ran(root)[0]["#C%"] == 23
    assert outside.read_bytes() == b"kept"


def test_what_a_faulty_program_calls_is_looked_at_too() -> None:
    """Missing sub-programs and their errors are said although the main program has an error of its own."""
    texts = {"SIDE": "10 B%=\nP DEEP\nP GONE\n", "DEEP": "10 C%=1+\n", "RIGHT": "N1 X1\n"}

    def find(_address: str, name: str) -> tuple[str, str] | None:
        return (name, texts[name]) if name in texts else None

    main = "10 A%=\nP NONE\nP SIDE\nP RIGHT\n20 IF A%=1 THEN\nP NONE2\n30 ENDIF\nP SIDE\n"
    linked, errors = Linker(find).link(main, "main")
    assert linked is None
    found = [
        (each.position.file, each.position.line, each.what) for each in errors if each.position is not None
    ]
    assert len(found) == len(set(found)) == len(errors)
    assert {(file, line) for file, line, _ in found} == {
        ("main", 1), ("main", 2), ("main", 6), ("SIDE", 1), ("DEEP", 1), ("SIDE", 3),
    }  # fmt: skip
    assert [what for _, _, what in found if "no sub-program" in what] == [
        "there is no sub-program NONE",
        "there is no sub-program GONE",
        "there is no sub-program NONE2",
    ]
