"""Control files: their sections, strict keys, encodings and errors; those that come with polycnc; safe writing."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from polycnc.errors import ConfigurationError, ProgramError, UsageError
from polycnc.post import (
    CONTROLS,
    NO_DIALECT,
    control_file_reference,
    load_control,
    parse_control,
    parse_tool_path,
    program_file,
    shipped_text,
)
from polycnc.runner import post_file
from support.post_controls import control, posted

DOCS = Path(__file__).resolve().parents[2] / "docs"
SMALL = """\
[parameters]
name = "test"

[nc_code]
G00 = { code = "G0", order = 10 }

[g_code]
G00 = { group = "motion" }

[m_code]
M05 = { group = "spindle" }

[function_variables]
X = { format = "X%.2f" }

[nc_macros]
RAPID = '''
!-G00!$X$
'''
STOP = '''!M05!'''
"""
JAPANESE = """\
# 出力制御ファイル

["パラメータ部"]
name = "工具交換"
encoding = "shift-jis"

["NCコード部"]
G00 = { code = "G0" }

["Gコード部"]
G00 = { group = "移動" }

["Mコード部"]
M05 = {}

["機能変数"]
X = { format = "X%.2f" }

["NCマクロ部"]
RAPID = '''
(工具 $COMMENT$)
!-G00!$X$
'''
"""


def _rapid(control_text: str) -> list[str]:
    written: list[str] = []
    parse_control(control_text).start(written.append).call("RAPID", {"X": 1.5})
    return written


def _refused(text: str) -> ConfigurationError:
    with pytest.raises(ConfigurationError) as error:
        parse_control(text, "mill.toml")
    return error.value


@pytest.mark.covers(
    "post.file.output_control_file",
    "post.section.nc_macro",
    "post.sec.nc_code",
    "post.sec.g_code",
    "post.sec.m_code",
    "post.sec.parameter",
    "post.sec.function_var",
)
def test_the_six_sections_have_two_names_each() -> None:
    control = parse_control(SMALL)
    assert control.parameters.name == "test"
    assert control.variables == {"X"}
    assert (control.has("RAPID"), control.has("STOP"), control.has("LINEAR")) == (True, True, False)
    assert _rapid(SMALL) == ["G0 X1.50\n".replace(" ", "")]
    assert _rapid(JAPANESE) == ["(工具 )\n", "G0X1.50\n"]
    assert parse_control(JAPANESE).parameters.name == "工具交換"


def test_errors_in_sections_with_the_manuals_names_have_their_place() -> None:
    error = _refused(JAPANESE.replace("M05 = {}", "M05 = { gruop = 5 }"))
    assert error.position is not None
    assert error.position.text == "M05 = { gruop = 5 }"
    assert "did you mean 'group'?" in error.hint
    assert "[パラメータ部] is the section [parameters] a second time" in (
        _refused('[parameters]\n["パラメータ部"]\n[nc_macros]\n').what
    )


@pytest.mark.covers("post.sec.g_code", "post.sec.m_code", "post.sec.nc_code")
def test_without_an_entry_a_code_is_its_key() -> None:
    text = SMALL.replace('G00 = { code = "G0", order = 10 }', "").replace("!-G00!", "!-G00!!M05!")
    assert _rapid(text) == ["G00M05X1.50\n"]


@pytest.mark.covers("post.sec.parameter", "post.block.sequence_number", "post.order.sort")
def test_numbers_begin_with_10_and_step_by_10_if_nothing_else_is_said() -> None:
    text = SMALL.replace('name = "test"', "sequence_place = 1").replace("$X$", "\n$X$")
    assert _rapid(text) == ["N10G0\n", "N20X1.50\n"]
    text = text.replace("!-G00!", "<OUTPUTORDER=1>'b,-99'!-G00!'a,-101'")
    assert _rapid(text) == ["aN10bG0\n", "N20X1.50\n"]


@pytest.mark.covers("post.file.output_control_file")
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp932"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_files_in_utf_8_and_shift_jis(tmp_path: Path, encoding: str, line_end: str) -> None:
    path = tmp_path / "制御.toml"
    text = JAPANESE.replace("# 出力", "# ①髙 出力").replace("(工具 ", "(①髙 工具 ")  # in cp932 alone
    path.write_bytes(text.replace("\n", line_end).encode(encoding))
    control = load_control(path)
    assert control.parameters.name == "工具交換"
    written: list[str] = []
    control.start(written.append).call("RAPID", {"COMMENT": "ソ表"})  # their second byte is a backslash
    assert written[0] == "(①髙 工具 ソ表)\n"
    path.write_bytes(JAPANESE.replace("$X$", "$X").replace("\n", line_end).encode(encoding))
    with pytest.raises(ConfigurationError) as error:
        load_control(path)
    position = error.value.position
    assert position is not None
    assert (position.line, position.column, position.text) == (22, 7, "!-G00!$X")


def test_files_of_neither_encoding(tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_bytes(b'[parameters]\nname = "caf\xe9"\n')
    with pytest.raises(ConfigurationError, match=r"neither UTF-8 nor Shift-JIS text: line 2"):
        load_control(path)


def test_files_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no control file 'fanuc'") as error:
        load_control("fanuc")
    assert "fanuc-mill" in error.value.hint
    with pytest.raises(UsageError, match="cannot read"):
        load_control(tmp_path)


WRONG = [
    ('name = "test"', "nam = 1", "unknown key 'nam' in [parameters]", "did you mean 'name'?"),
    ("[m_code]", "[mcode]", "unknown key 'mcode'", "did you mean 'm_code'?"),
    ('format = "X%.2f"', "fromat = 1", "unknown key 'fromat'", "did you mean 'format'?"),
    ('name = "test"', 'units = "cm"', "'units' must be 'mm' or 'inch'", ""),
    ('name = "test"', "sequence_place = 3", "'sequence_place' must be 0, 1 or 2", ""),
    ('name = "test"', "sequence_step = 0", "'sequence_step' is 0, which is out of range", ""),
    ('name = "test"', 'sequence_format = "N%.3f"', "'N%.3f' does not write whole numbers", 'like "N%d"'),
    ('name = "test"', 'sequence_format = "N"', "'N' is not a format with one number", ""),
    ('name = "test"', "machining_origin = { A = 1.0 }", "'X', 'Y' or 'Z'", ""),
    ('name = "test"', 'separator = "\\n"', "more than one line", ""),
    ('"X%.2f"', '"X"', "'X' is not a format with one number", 'like "X%.3f"'),
    ('"X%.2f"', '"X%s"', "'X%s' is not a format with one number", ""),
    ('"X%.2f"', '"%d%d"', "'%d%d' is not a format with one number", ""),
    ('"X%.2f"', '"X%.2d"', "gives decimals to a whole number", ""),
    ('"X%.2f"', '"X%d", zeros = "trim"', "has no decimals to trim", ""),
    ('"X%.2f"', '"X%.2f\\n"', "more than one line", ""),
    ("X = {", "'X Y' = {", "'X Y' is not a search key", "begin with a letter"),
    ("X = {", "outputorder = {", "'outputorder' is a reserved word", ""),
    ("X = {", "m05 = {", "the search key 'm05' is in [m_code] too", "used once"),
    ("G00 = { code", "G01 = { code", "[nc_code] gives 'G01', which no other section defines", "mean G00?"),
    ("G00 = { code", "X = { code", "'X' is no G or M code and has no code text", ""),
    ("[g_code]", "g00 = {}\n[g_code]", "[nc_code] gives 'g00' twice", ""),
    ("RAPID =", "RAPIT =", "no event calls a macro 'RAPIT'", "did you mean RAPID?"),
    ("RAPID =", "rapid =", "no event calls a macro 'rapid'", "did you mean RAPID?"),
    ("!-G00!$X$", "!-G00!$Y$", "[nc_macros] RAPID, line 1: there is no word Y", ""),
]


@pytest.mark.covers("post.file.output_control_file")
@pytest.mark.parametrize(("right", "wrong", "what", "hint"), WRONG)
def test_what_a_file_may_not_hold(right: str, wrong: str, what: str, hint: str) -> None:
    error = _refused(SMALL.replace(right, wrong))
    assert what in error.what
    assert hint in error.hint
    assert error.position is not None
    assert str(error).startswith("mill.toml:")
    key = re.findall(r"[\w']+", wrong.splitlines()[0])[0]
    assert key in error.position.text or wrong in error.position.text


@pytest.mark.covers("post.section.nc_macro")
def test_errors_show_section_macro_line_and_column() -> None:
    error = _refused(SMALL.replace("!-G00!$X$", "ABC\n  !-G10!$X$"))
    assert str(error) == (
        "mill.toml:19:3: [nc_macros] RAPID, line 2: there is no code G10\n"
        "      !-G10!$X$\n"
        "      ^\n"
        "did you mean G00?"
    )


def test_all_errors_of_a_file_are_told_at_once() -> None:
    error = _refused(SMALL.replace("!-G00!$X$", "!G1!\n$Q$<\nIF(1=1)").replace("!M05!", "A>"))
    lines = str(error).splitlines()
    assert lines[0] == "mill.toml:18:1: [nc_macros] RAPID, line 1: there is no code G1"
    assert lines[3].startswith("also mill.toml:19:4: [nc_macros] RAPID, line 2: < begins no assignment")
    assert lines[4].startswith("also mill.toml:20:1: [nc_macros] RAPID, line 3: the IF has no ENDIF")
    assert lines[5].startswith("also mill.toml:20:5: [nc_macros] RAPID, line 3: '=' has no meaning")
    assert lines[6].startswith("also mill.toml:22:12: [nc_macros] STOP, line 1: > ends nothing here")
    assert lines[7] == "on line 18: known here: G00, M05"
    many = str(_refused(SMALL.replace("!M05!", "\n" + "!G7!\n" * 50)))
    assert "and 29 more" in many


@pytest.mark.parametrize(
    ("value", "line", "column", "text"),
    [
        ("'''\n!G7!'''", 18, 1, "!G7!'''"),
        ("'!G7!'", 17, 10, "RAPID = '!G7!'"),
        ('"!G7!"', 17, 10, 'RAPID = "!G7!"'),
        ('"""\n!G00!\n A!G7!"""', 19, 3, ' A!G7!"""'),
        ("''' !G7!\n'''", 17, 13, "RAPID = ''' !G7!"),
        ('"\\u0041!G7!"', 17, 2, "A!G7!"),  # columns cannot be told after a backslash
    ],
)
def test_errors_have_their_place_in_every_kind_of_text(value: str, line: int, column: int, text: str) -> None:
    error = _refused(SMALL.replace("'''\n!-G00!$X$\n'''", value))
    assert error.position is not None
    assert (error.position.line, error.position.column, error.position.text) == (line, column, text)


# --- the control files that come with polycnc


# Not those that write another language.
@pytest.mark.parametrize(
    "name", [each for each in CONTROLS if f'\ndialect = "{NO_DIALECT}"' not in shipped_text(each)]
)
def test_shipped_files_write_plain_blocks(name: str) -> None:
    control = load_control(name)
    assert control.parameters.dialect != NO_DIALECT
    written: list[str] = []
    run = control.start(written.append)
    run.call("PROGRAM_START", {"PARTNAME": "PART 1", "UNITS": 21})
    run.call("TOOL_CHANGE", {"T": 2, "H": 2, "D": 2})
    run.call("SPINDLE_CW", {"S": 1500.4, "SPINDLEMODE": 97})
    run.call("RAPID", {"X": 10.0, "Y": 0.0, "Z": 2.5})
    run.call("LINEAR", {"X": 10.0, "Y": 0.0, "Z": -1.0, "F": 120.0, "FEEDMODE": 94})
    run.call("LINEAR", {"X": 12.0, "Y": 0.0, "Z": -1.0, "F": 120.0, "FEEDMODE": 94})
    run.call("LINEAR", {"X": 12.0, "Y": 0.0, "Z": -3.0, "F": 120.0, "FEEDMODE": 95})
    run.call("PROGRAM_END")
    text = "".join(written)
    assert "(PART 1)" in text
    assert re.search(r"S1500 M0?3$", text, re.MULTILINE)
    assert re.search(r"G9[48] G0?1 Z-1\.?(000)? F120\.?$", text, re.MULTILINE) or re.search(
        r"^(N\d+ )?G0?1 Z-1\.?(000)? F120\.?$", text, re.MULTILINE
    )
    assert re.search(r"^(N\d+ )?X(12|24)\.?(000)?$", text, re.MULTILINE)
    anew = re.search(r"^(N\d+ )?G9[59] Z-3\.?(000)? F120\.?$", text, re.MULTILINE)  # F anew with its mode
    assert anew or not control.names("FEEDMODE")
    assert "M30" in text


def test_shipped_drilling_cycles_repeat_only_what_changes() -> None:
    for name in ("fanuc-mill", "bosch-pnc"):
        written: list[str] = []
        run = load_control(name).start(written.append)
        run.call("RAPID", {"X": 0.0, "Y": 0.0, "Z": 5.0})
        words = {"Y": 3.0, "Z": -8.0, "R": 1.0, "Q": 2.0, "P": 0.5, "F": 90.0, "RETRACT": 99}
        for hole, x in enumerate((10.0, 20.0), 1):
            run.call("CYCLE_DEEP", {**words, "X": x, "HOLE": hole})
        run.call("CYCLE_OFF")
        run.call("RAPID", {"X": 20.0, "Y": 3.0, "Z": 5.0})
        blocks = [re.sub(r"^N\d+ |(?<=\d)\.(?!\d)", "", block.strip()) for block in written]
        assert blocks[-4:] == ["G99 G83 X10 Y3 Z-8 R1 Q2 F90", "X20", "G80", "G00 X20 Y3 Z5"]


@pytest.mark.parametrize("name", CONTROLS)
def test_shipped_files_are_places_to_begin(name: str, tmp_path: Path) -> None:
    text = shipped_text(name)
    assert text.startswith("# ")
    own = tmp_path / "own.toml"
    own.write_text(text.replace('extension = "', 'extension = ".own'), encoding="utf-8")
    assert load_control(own).parameters.extension.startswith(".own.")
    assert load_control(own).parameters.dialect in (
        "fanuc",
        "fanuc-lathe",
        "bosch",
        "din",
        "grbl",
        "haas",
        "linuxcnc",
        NO_DIALECT,
    )


# --- files


def test_a_program_file_is_whole_or_absent(tmp_path: Path) -> None:
    parameters = parse_control(JAPANESE).parameters
    path = tmp_path / "part.nc"
    path.write_text("old")
    control = parse_control(JAPANESE.replace("$X$", "<X=1/X>$X$"))
    with pytest.raises(ProgramError, match="division by zero"), program_file(path, parameters) as file:
        control.start(file.write).call("RAPID")
    assert path.read_text() == "old"
    with program_file(path, parameters) as file:
        file.write("(工具)\n")
        assert path.read_text() == "old"
    assert path.read_bytes() == "(工具)\n".encode("cp932")
    assert list(tmp_path.iterdir()) == [path]


def test_line_ends_and_characters_of_a_program(tmp_path: Path) -> None:
    control = parse_control(
        JAPANESE.replace('"shift-jis"', '"ascii"\nline_end = "crlf"').replace("(工具 ", "(")
    )
    path = tmp_path / "part.nc"
    with program_file(path, control.parameters) as file:
        control.start(file.write).call("RAPID", {"COMMENT": "A"})
    assert path.read_bytes() == b"(A)\r\nG0X0.00\r\n"
    with (
        pytest.raises(ProgramError, match=r"RAPID, line 1: the character '具' cannot be written in ascii"),
        program_file(path, control.parameters) as file,
    ):
        control.start(file.write).call("RAPID", {"COMMENT": "A具"})
    assert path.read_bytes() == b"(A)\r\nG0X0.00\r\n"


def test_program_files_that_cannot_be_written(tmp_path: Path) -> None:
    parameters = parse_control(SMALL).parameters
    with pytest.raises(UsageError, match="is a folder"), program_file(tmp_path, parameters):
        pass
    with (
        pytest.raises(UsageError, match="cannot be written"),
        program_file(tmp_path / "no" / "a", parameters),
    ):
        pass


# --- the page


def test_the_reference_page_is_up_to_date() -> None:
    page = (DOCS / "reference" / "post-control-file.md").read_text(encoding="utf-8")
    assert page == control_file_reference(), (
        "write it again: python -c 'from pathlib import Path; from polycnc.post import *; "
        'Path("docs/reference/post-control-file.md").write_text(control_file_reference(), encoding="utf-8")\''
    )


def test_the_reference_page_explains_every_key() -> None:
    page = control_file_reference()
    for key in (
        "sequence_place",
        "machining_origin",
        "arc_split",
        "order",
        "group",
        "zeros",
        "modal",
        "scale",
    ):
        assert f"| `{key}` |" in page
    assert all(line.count("|") >= 4 for line in page.splitlines() if line.startswith("| `"))
    assert "{" + "nested_ifs" not in page
    assert "up to 5 `&&` and `||`" in page


def test_an_unknown_dialect_is_found_when_the_file_is_read() -> None:
    with pytest.raises(ConfigurationError) as caught:
        parse_control("[parameters]\nname = 'x'\ndialect = 'fanuk'\n[nc_macros]\n", "mine.toml")
    assert caught.value.what == "there is no dialect 'fanuk'"
    assert str(caught.value.position) == "mine.toml:3:1"


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("[nc_macros]\nSTOP = '''\nIF(S>0)\n(Grün)\nENDIF\n'''\n", "mine.toml:6:4"),
        ('[nc_macros]\nSTOP = """\n"(Grün)"\n"""\n', "mine.toml:5:5"),
        ("[nc_macros]\nSTOP = '''\n<ENDOFLINE=\"ü\">\nM0\n'''\n", "mine.toml:5:1"),
        ("[nc_code]\nM00 = { code = 'Mü' }\n[m_code]\nM00 = {}\n[nc_macros]\n", "mine.toml:4:9"),
        ("[function_variables]\nX = { format = 'ü%d' }\n[nc_macros]\n", "mine.toml:4:7"),
    ],
)
def test_a_character_that_the_encoding_has_not_is_found_when_the_file_is_read(text: str, place: str) -> None:
    head = "[parameters]\nencoding = '{}'\n"
    with pytest.raises(ConfigurationError) as caught:
        parse_control(head.format("ascii") + text, "mine.toml")
    assert "the character 'ü' cannot be written in ascii" in caught.value.what
    assert str(caught.value.position) == place
    parse_control(head.format("utf-8") + text, "mine.toml")


@pytest.mark.parametrize(
    "line", ["<X=5>  ", "  <X=5>", "<X=5> \t<Y=2>", "&X*X&  ", "@1@ <X=5> ", "!-G17!   "]
)
def test_blanks_beside_what_writes_nothing_make_no_block(line: str) -> None:
    used = control({"sequence_place": 1}, {"STOP": f"!*G17!\n{line}", "PROGRAM_END": "", "PROGRAM_START": ""})
    assert posted("STOP\n", used)[0] == []


@pytest.mark.parametrize("there", ["ARC_CW", "ARC_CCW"])
def test_an_arc_macro_without_the_other_one_is_remarked(there: str) -> None:
    missing = "ARC_CCW" if there == "ARC_CW" else "ARC_CW"
    control = parse_control(
        shipped_text("grbl").replace(f"\n{missing} = '''", "\nWORD_UNUSED = '''"), "mine.toml"
    )
    path = "LOADTL/1\nRAPID\nGOTO/0,-3.5,2\nFEDRAT/700,MMPM\nCIRCLE/0,0,2,0,0,1,3.5\nGOTO/3.5,0,2\n"
    remarks = post_file(parse_tool_path(path), control).summary.remarks
    text = f"the macro {there} is never called: without {missing} all arcs become lines"
    assert [(remark.line, remark.text) for remark in remarks] == [(0, text)]
    straight = path.split("CIRCLE")[0] + "GOTO/3,4,2\n"
    assert post_file(parse_tool_path(straight), control).summary.remarks == ()


def test_a_macro_for_a_word_that_is_left_out_is_remarked() -> None:
    control = parse_control(shipped_text("grbl") + "\nWORD_REWIND = '''\n!M00!\n'''\n", "mine.toml")
    remarks = post_file(parse_tool_path("LOADTL/1\nREWIND/1\nRAPID\nGOTO/1,2,3\n"), control).summary.remarks
    assert [remark.text for remark in remarks] == [
        "the macro WORD_REWIND is never called: REWIND says nothing to a control, and is left out"
    ]
