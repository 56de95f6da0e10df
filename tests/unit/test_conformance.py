"""Rows, claims and reasons are joined, counted and refused as the files say; covers marks are judged."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from polycnc import conformance
from polycnc.conformance import Counts, State
from polycnc.errors import ConfigurationError, UsageError

pytest_plugins = ["pytester"]

HEADER = "id\tgroup\tname\tkind\tsignature\tlines\tbehaviour\terrors"
ROWS = {
    "fanuc": ["fanuc.a", "fanuc.code.1", "fanuc.code.2", "fanuc.z"],
    "apci": ["apci.a", "sap.a"],
    "imc": ["imc.a"],
    "cpl": ["cpl.CHR$"],
    "post": [],
}


def row_line(row_id: str) -> str:
    group = "Codes" if ".code." in row_id else "Calls"
    return f"{row_id}\t{group}\tname of {row_id}\tconcept\t\t1-2\tdoes it\t"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for system, ids in ROWS.items():
        text = "\n".join([HEADER, *map(row_line, ids)]) + "\n"
        (tmp_path / f"{system}.tsv").write_text(text, encoding="utf-8")
    return tmp_path


def test_rows_keep_their_fields_and_order(folder: Path) -> None:
    rows = conformance.read_rows(folder)
    assert list(rows) == [
        "fanuc.a",
        "fanuc.code.1",
        "fanuc.code.2",
        "fanuc.z",
        "apci.a",
        "sap.a",
        "imc.a",
        "cpl.CHR$",
    ]
    assert rows["sap.a"] == conformance.Row(
        "sap.a", "apci", "Calls", "name of sap.a", "concept", "", "1-2", "does it", ""
    )


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (row_line("imc.a"), r"^imc\.tsv:3:1: row id 'imc\.a' is used twice"),
        (row_line("cpl.b"), r"^imc\.tsv:3:1: row id 'cpl\.b' does not belong to imc"),
        ("imc.b\tCalls", r"^imc\.tsv:3:1: 2 fields where 8 belong"),
    ],
)
def test_a_malformed_row_is_refused_with_its_place(folder: Path, line: str, message: str) -> None:
    with (folder / "imc.tsv").open("a", encoding="utf-8") as file:
        file.write(line + "\n")
    with pytest.raises(ConfigurationError, match=message):
        conformance.read_rows(folder)


@pytest.mark.parametrize("text", ["", "id\tgroup\n"])
def test_a_wrong_header_is_refused(folder: Path, text: str) -> None:
    (folder / "post.tsv").write_text(text, encoding="utf-8")
    with pytest.raises(ConfigurationError, match=r"^post\.tsv:1:1: wrong header"):
        conformance.read_rows(folder)


def test_a_missing_file_is_refused(folder: Path) -> None:
    (folder / "cpl.tsv").unlink()
    with pytest.raises(ConfigurationError, match=r"cpl\.tsv cannot be read"):
        conformance.read_rows(folder)


@pytest.fixture
def judged(folder: Path) -> Path:
    (folder / "claims.tsv").write_text(
        conformance.claims_text(
            [("sap.a", "tests/t.py::b"), ("fanuc.a", "tests/t.py::b"), ("fanuc.a", "tests/t.py::a")]
        ),
        encoding="utf-8",
    )
    (folder / "not_applicable.toml").write_text(
        '[fanuc]\n"fanuc.code.*" = "No such model."\n[cpl]\n"cpl.CHR$" = "Not a text."\n', encoding="utf-8"
    )
    return folder


def test_states_and_counts(judged: Path) -> None:
    picture = conformance.load_conformance(judged)
    assert picture.counts() == {
        "fanuc": Counts(rows=4, tested=1, not_applicable=2, open=1),
        "apci": Counts(rows=2, tested=1, not_applicable=0, open=1),
        "imc": Counts(rows=1, tested=0, not_applicable=0, open=1),
        "cpl": Counts(rows=1, tested=0, not_applicable=1, open=0),
        "post": Counts(rows=0, tested=0, not_applicable=0, open=0),
    }
    assert picture.total() == Counts(rows=8, tested=2, not_applicable=3, open=3)
    assert picture.claims["fanuc.a"] == ("tests/t.py::a", "tests/t.py::b")
    assert picture.as_json()["systems"]["fanuc"] == {"rows": 4, "tested": 1, "not_applicable": 2, "open": 1}
    assert picture.groups("fanuc") == {"Calls": Counts(2, 1, 0, 1), "Codes": Counts(2, 0, 2, 0)}


def test_rows_are_chosen_by_system_and_state(judged: Path) -> None:
    picture = conformance.load_conformance(judged)
    assert [row.id for row in picture.rows("apci", "open")] == ["apci.a"]
    assert [row.id for row in picture.rows(state=State.TESTED)] == ["fanuc.a", "sap.a"]
    assert len(picture.rows()) == 8


def test_unknown_system_and_state_are_refused(judged: Path) -> None:
    picture = conformance.load_conformance(judged)
    with pytest.raises(UsageError, match="unknown system 'heidenhain'\nSystems are: fanuc, apci"):
        picture.rows("heidenhain")
    with pytest.raises(UsageError, match="unknown state 'done'\nStates are: tested, not_applicable, open"):
        picture.rows("imc", "done")


def test_the_table_shows_every_system_and_the_sum(judged: Path) -> None:
    lines = conformance.summary_table(conformance.load_conformance(judged)).splitlines()
    assert [line.split() for line in lines[1:]] == [
        ["fanuc", "4", "1", "2", "1"],
        ["apci", "2", "1", "0", "1"],
        ["imc", "1", "0", "0", "1"],
        ["cpl", "1", "0", "1", "0"],
        ["post", "0", "0", "0", "0"],
        ["total", "8", "2", "3", "3"],
    ]


def test_a_listing_groups_rows_and_says_why(judged: Path) -> None:
    picture = conformance.load_conformance(judged)
    assert conformance.row_listing(picture, "fanuc", "not_applicable").splitlines() == [
        "Codes",
        "  fanuc.code.1  name of fanuc.code.1",
        "      No such model.",
        "  fanuc.code.2  name of fanuc.code.2",
        "      No such model.",
    ]
    assert "      tests/t.py::a" in conformance.row_listing(picture, "fanuc", "tested").splitlines()
    assert conformance.row_listing(picture, "cpl", "open") == "Typ3 osa / PNC CPL: no row is open."


def test_the_page_has_the_counts_and_the_reasons(judged: Path) -> None:
    page = conformance.reference_page(conformance.load_conformance(judged))
    assert "| FANUC Power Mate library | 4 | 1 | 2 | 1 |" in page
    assert "| **All** | 8 | 2 | 3 | 3 |" in page
    assert "- `cpl.CHR$`: Not a text." in page


def test_a_claim_of_an_unknown_row_is_refused_and_a_near_one_proposed(folder: Path) -> None:
    (folder / "claims.tsv").write_text("row\ttest\nfanuc.code.3\ttests/t.py::a\n", encoding="utf-8")
    with pytest.raises(
        ConfigurationError, match=r"claims\.tsv:2:1: tests/t\.py::a claims 'fanuc\.code\.3', which is no row"
    ) as caught:
        conformance.load_conformance(folder)
    assert "Is 'fanuc.code." in caught.value.hint


def test_a_row_both_claimed_and_not_applicable_is_refused(judged: Path) -> None:
    with (judged / "not_applicable.toml").open("a", encoding="utf-8") as file:
        file.write('[apci]\n"sap.*" = "Never."\n')
    with pytest.raises(
        ConfigurationError, match=r"row 'sap\.a' is claimed by tests/t\.py::b and stated as not"
    ):
        conformance.load_conformance(judged)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[imc]\n"imc.b" = "x"', r"not_applicable\.toml: 'imc\.b' fits no row"),
        ('[imc]\n"cpl.*" = "x"', r"'cpl\.\*' fits no row"),
        ('[imc]\n"imc.a" = " "', r"'imc\.a' has no reason"),
        ('[imc]\n"imc.a" = 3', r"'imc\.a' has no reason"),
        ('[imc]\n"imc.a" = "x"\n"imc.*" = "y"', r"'imc\.\*' states 'imc\.a' a second time"),
        ('[siemens]\n"a" = "x"', r"'siemens' is no table of a system"),
        ('imc = "x"', r"'imc' is no table of a system"),
        ("[imc", r"^not_applicable\.toml: .*\nMend the TOML syntax"),
    ],
)
def test_a_wrong_statement_of_not_applicable_is_refused(folder: Path, text: str, message: str) -> None:
    (folder / "not_applicable.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ConfigurationError, match=message):
        conformance.load_conformance(folder)


def test_without_claims_and_reasons_everything_is_open(folder: Path) -> None:
    assert conformance.load_conformance(folder).total() == Counts(rows=8, tested=0, not_applicable=0, open=8)


@given(st.lists(st.tuples(st.sampled_from(["b", "a", "c"]), st.sampled_from(["y", "x"]))))
def test_claims_are_written_sorted_and_once(claims: list[tuple[str, str]]) -> None:
    lines = conformance.claims_text(claims).splitlines()
    pairs = [tuple(line.split("\t")) for line in lines[1:]]
    assert lines[0] == "row\ttest"
    assert pairs == sorted(set(claims))


def bare_function() -> None:
    len("assert nothing")


def function_with_assert() -> None:
    for number in (1, 2):
        assert number


def function_with_raises() -> None:
    with pytest.raises(ZeroDivisionError):
        print(1 // 0)


def function_with_helper() -> None:
    def assert_small(number: int) -> None:
        if number > 1:
            raise AssertionError

    assert_small(1)


@given(st.integers())
def property_with_assert(number: int) -> None:
    assert number == number + 0


@given(st.integers())
def property_without_assert(number: int) -> None:
    len(str(number))


def test_what_counts_as_asserting() -> None:
    assert conformance.asserts_something(function_with_assert)
    assert conformance.asserts_something(function_with_raises)
    assert conformance.asserts_something(function_with_helper)
    assert conformance.asserts_something(property_with_assert)
    assert not conformance.asserts_something(bare_function)
    assert not conformance.asserts_something(property_without_assert)
    assert not conformance.asserts_something(eval("lambda: None"))


@pytest.fixture
def marked(pytester: pytest.Pytester) -> pytest.Pytester:
    conftest = Path(__file__).parents[1] / "conftest.py"
    pytester.makeconftest(conftest.read_text(encoding="utf-8"))
    pytester.makeini("[pytest]\nmarkers = covers\ntestpaths = tests\n")
    pytester.mkdir("tests")
    return pytester


def write_tests(pytester: pytest.Pytester, *bodies: str) -> None:
    text = "\n\n".join(["import pytest", *bodies]) + "\n"
    (pytester.path / "tests" / "test_marks.py").write_text(text, encoding="utf-8")


GOOD = "@pytest.mark.covers('fanuc.cnc_absolute', 'fanuc.cnc_machine')\ndef test_good():\n    assert True"
TABLE = (
    "@pytest.mark.parametrize('n', [pytest.param(1, marks=pytest.mark.covers('imc.IMC_Open')), 2])\n"
    "def test_table(n):\n    assert n"
)


def test_marks_of_functions_and_parameters_become_claims(marked: pytest.Pytester) -> None:
    write_tests(marked, TABLE, GOOD)
    marked.runpytest("--claims-file=claims.tsv", "-k", "good").assert_outcomes(passed=1, deselected=2)
    assert (marked.path / "claims.tsv").read_text(encoding="utf-8").splitlines() == [
        "row\ttest",
        "fanuc.cnc_absolute\ttests/test_marks.py::test_good",
        "fanuc.cnc_machine\ttests/test_marks.py::test_good",
        "imc.IMC_Open\ttests/test_marks.py::test_table",
    ]


def test_marks_of_classes_and_modules_count_for_each_of_their_tests(marked: pytest.Pytester) -> None:
    write_tests(
        marked,
        "pytestmark = pytest.mark.covers('sap.scope')",
        "@pytest.mark.covers('imc.IMC_Open')\nclass TestCard:\n    def test_one(self):\n        assert True",
    )
    marked.runpytest("--claims-file=claims.tsv").assert_outcomes(passed=1)
    assert (marked.path / "claims.tsv").read_text(encoding="utf-8").splitlines()[1:] == [
        "imc.IMC_Open\ttests/test_marks.py::TestCard::test_one",
        "sap.scope\ttests/test_marks.py::TestCard::test_one",
    ]


@pytest.mark.parametrize(
    ("row", "body", "message"),
    [
        (
            "'fanuc.cnc_absolut'",
            "assert True",
            "*names 'fanuc.cnc_absolut', which is no *Is 'fanuc.cnc_absolute' meant*",
        ),
        (
            "'cpl.abbr'",
            "assert True",
            "*names 'cpl.abbr', which not_applicable.toml states as not applicable*",
        ),
        ("'fanuc.cnc_absolute'", "len('')", "*covers marks a test whose body asserts nothing*"),
        ("7", "assert True", "*covers takes row ids, not 7*"),
    ],
)
def test_a_wrong_mark_fails_its_test(marked: pytest.Pytester, row: str, body: str, message: str) -> None:
    write_tests(marked, GOOD, f"@pytest.mark.covers({row})\ndef test_bad():\n    {body}")
    result = marked.runpytest()
    result.assert_outcomes(passed=1, errors=1)
    result.stdout.fnmatch_lines([message])


def test_no_claims_are_written_from_a_wrong_mark_or_a_part_of_the_tests(marked: pytest.Pytester) -> None:
    write_tests(marked, GOOD)
    part = marked.runpytest("--claims-file=claims.tsv", "tests/test_marks.py")
    write_tests(marked, "@pytest.mark.covers('nothing')\ndef test_bad():\n    assert True")
    wrong = marked.runpytest("--claims-file=claims.tsv")
    assert (part.ret, wrong.ret) == (pytest.ExitCode.USAGE_ERROR, pytest.ExitCode.USAGE_ERROR)
    part.stderr.fnmatch_lines(["*needs the whole test tree*"])
    wrong.stderr.fnmatch_lines(["*test_bad: covers names 'nothing'*"])
    assert not (marked.path / "claims.tsv").exists()
