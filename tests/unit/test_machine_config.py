import math
import re
from pathlib import Path
from typing import Any

import pydantic
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.errors import ConfigurationError, UsageError
from polycnc.machine._config import IoConfig, MachineConfig
from polycnc.machine._config_axis import LinearAxis, LinearServo, RotaryAxis, RotaryServo
from polycnc.machine._toml import StrictModel, load_toml, parse_toml, validate
from polycnc.machine._toml_locator import KeyPath
from support.often import share

AXIS_X = 'name = "m"\n[[axis]]\nname = "X"\nvmax_mm_s = 500\namax_mm_s2 = 5000\n'  # lines 1 to 5
AXIS_A = (
    'name = "m"\n[[axis]]\nname = "A"\nkind = "rotary"\nvmax_deg_s = 90\namax_deg_s2 = 900\n'  # lines 1 to 6
)


def machine(text: str) -> MachineConfig:
    data, locator = parse_toml(text, "m.toml")
    return validate(MachineConfig, data, locator)


def refused(text: str) -> ConfigurationError:
    with pytest.raises(ConfigurationError) as caught:
        machine(text)
    return caught.value


# --- values


def test_a_short_file_gets_the_documented_defaults() -> None:
    config = machine(AXIS_X)
    assert config.cycle_s == 0.001
    assert config.epoch.isoformat() == "2000-01-01T00:00:00"
    assert config.path.look_ahead_blocks == "unlimited"
    assert config.path.look_ahead_limit is None
    assert (config.path.path_tolerance_mm, config.path.jerkrel) == (0.0, 0.0)
    assert (config.times.tool_change_s, config.times.spindle_start_s, config.times.auxiliary_s) == (
        0.0,
        0.0,
        0.0,
    )
    assert config.spindle.max_rpm == 24000.0
    assert config.tools == {}
    assert config.offsets == {}
    axis = config.axes[0]
    assert axis.soft_limits == axis.limit_switches == (-math.inf, math.inf)
    assert axis.jump is axis.reference_switch is axis.index_pulse is None
    assert (axis.home, axis.resolution, axis.backlash) == (0.0, 0.0, 0.0)
    assert axis.servo.kind == "ideal"
    assert axis.servo.in_position == axis.servo.following_error_limit == math.inf


def test_linear_and_rotary_axes_are_read_through_the_same_properties() -> None:
    config = machine("""
        name = "m"
        [[axis]]
        name = "X1"
        vmax_mm_s = 10
        amax_mm_s2 = 20
        jump_mm_s = 0.5
        soft_limits_mm = [-1, 2.5]
        home_mm = 0.25
        resolution_mm = 0.001
        limit_switches_mm = [-3, 4]
        reference_switch_mm = -2
        index_pulse_mm = -1.5
        backlash_mm = 0.02
        [axis.servo]
        kind = "pidf"
        kp = 40
        in_position_mm = 0.01
        following_error_limit_mm = 3
        [[axis]]
        name = "A"
        kind = "rotary"
        vmax_deg_s = 10
        amax_deg_s2 = 20
        jump_deg_s = 0.5
        soft_limits_deg = [-1, 2.5]
        home_deg = 0.25
        resolution_deg = 0.001
        limit_switches_deg = [-3, 4]
        reference_switch_deg = -2
        index_pulse_deg = -1.5
        backlash_deg = 0.02
        [axis.servo]
        kind = "pidf"
        kp = 40
        in_position_deg = 0.01
        following_error_limit_deg = 3
        """)
    assert [axis.unit for axis in config.axes] == ["mm", "deg"]
    for axis in config.axes:
        assert (axis.vmax, axis.amax, axis.jump) == (10.0, 20.0, 0.5)
        assert axis.soft_limits == (-1.0, 2.5)
        assert (axis.home, axis.resolution, axis.backlash) == (0.25, 0.001, 0.02)
        assert axis.limit_switches == (-3.0, 4.0)
        assert (axis.reference_switch, axis.index_pulse) == (-2.0, -1.5)
        assert (axis.servo.kp, axis.servo.in_position, axis.servo.following_error_limit) == (40.0, 0.01, 3.0)
        assert not axis.modulo


def test_tools_offsets_and_start_positions() -> None:
    config = machine(
        AXIS_X
        + '[[axis]]\nname = "Z"\nvmax_mm_s = 1\namax_mm_s2 = 1\nhome_mm = 7\n'
        + "[tools.12]\nlength_mm = 80.5\nwear_length_mm = -0.1\n[start]\nX = -3\n"
        + "[offsets]\nG54 = { Z = 100 }\nG259.X = 5\n"
    )
    assert config.tools[12].length_mm == 80.5
    assert config.tools[12].wear_length_mm == -0.1
    assert config.start_positions == (-3.0, 7.0)
    assert config.work_offset("G54") == (0.0, 100.0)
    assert config.work_offset("G259") == (5.0, 0.0)
    assert config.work_offset("G55") == (0.0, 0.0)


def test_axis_index_finds_an_axis_or_names_them_all() -> None:
    config = machine(AXIS_X + '[[axis]]\nname = "Z"\nvmax_mm_s = 1\namax_mm_s2 = 1\n')
    assert (config.axis_index("X"), config.axis_index("Z")) == (0, 1)
    with pytest.raises(UsageError, match="there is no axis 'Y'\nthe axes are X, Z"):
        config.axis_index("Y")


@pytest.mark.parametrize("name", ["X", "Y", "Z", "A", "B", "C", "U", "V", "W", "P", "Q", "R", "X1", "Z12"])
def test_axis_names(name: str) -> None:
    assert LinearAxis(name=name, vmax_mm_s=1, amax_mm_s2=1).name == name


def test_a_configuration_cannot_be_changed_and_has_no_other_attributes() -> None:
    config = machine(AXIS_X)
    with pytest.raises(pydantic.ValidationError, match="frozen"):
        config.axes[0].vmax_mm_s = 1  # type: ignore[union-attr]
    with pytest.raises(pydantic.ValidationError):
        config.cycles = 1  # type: ignore[attr-defined]


def test_a_machine_can_be_made_and_varied_without_a_file() -> None:
    config = MachineConfig(
        name="bench",
        axis=(
            LinearAxis(name="X", vmax_mm_s=100, amax_mm_s2=1000, servo=LinearServo(kind="pidf", kp=30.0)),
            RotaryAxis(name="C", vmax_deg_s=90, amax_deg_s2=900, modulo=True),
        ),
    )
    varied = MachineConfig.model_validate({**config.model_dump(by_alias=True), "cycle_s": 0.002})
    assert varied.axes == config.axes
    assert varied.cycle_s == 0.002


# --- refusals: (text, line, column, what, hint)

REFUSALS = {
    "unknown key, one letter missing": (
        AXIS_X + "soft_limit_mm = [0, 1]",
        (6, 1, "unknown key 'soft_limit_mm' in [[axis]]", "did you mean 'soft_limits_mm'?"),
    ),
    "unknown key unlike any other": (
        AXIS_X + "[spindle]\npower_kw = 7",
        (7, 1, "unknown key 'power_kw' in [spindle]", "known here: max_rpm, acceleration_rpm_s"),
    ),
    "a wrong name for a required key is one problem, not two": (
        'name = "m"\n[[axis]]\nname = "X"\nvmax_m_s = 500\namax_mm_s2 = 1',
        (4, 1, "unknown key 'vmax_m_s' in [[axis]]", "did you mean 'vmax_mm_s'?"),
    ),
    "missing key stands at its table": (
        'name = "m"\n\n[[axis]]\nname = "X"\nvmax_mm_s = 5',
        (3, 1, "[[axis]] has no 'amax_mm_s2'", "add the line 'amax_mm_s2 = ...'"),
    ),
    "no axes": ('name = "m"', (1, 1, "the file has no 'axis'", "add the line [[axis]]")),
    "empty axes": (
        'name = "m"\naxis = []',
        (2, 1, "the machine has no axis", "add a table [[axis]] for each axis"),
    ),
    "degrees on a linear axis": (
        AXIS_X + "home_deg = 1",
        (6, 1, "'home_deg' is for a rotary axis", "write 'home_mm', or give the axis kind = \"rotary\""),
    ),
    "mm on a rotary axis": (
        AXIS_A + "home_mm = 1",
        (7, 1, "'home_mm' is for a linear axis", "write 'home_deg', or give the axis kind = \"linear\""),
    ),
    "degrees in the servo of a linear axis": (
        AXIS_X + '[axis.servo]\nkind = "pidf"\nkp = 1\nin_position_deg = 1',
        (9, 1, "'in_position_deg' is for a rotary axis", "write 'in_position_mm'"),
    ),
    "kind": (AXIS_X + '  kind = "rotaty"', (6, 3, "'kind' is neither", 'write kind = "linear" (mm) or')),
    "modulo on a linear axis": (
        AXIS_X + "modulo = true",
        (6, 1, "unknown key 'modulo'", "known here: name,"),
    ),
    "limits of an endless axis": (
        AXIS_A + "modulo = true\nsoft_limits_deg = [0, 90]",
        (
            8,
            1,
            "'soft_limits_deg' on an axis whose positions repeat",
            "remove 'soft_limits_deg' or modulo = true",
        ),
    ),
    "range with one bound": (
        AXIS_X + "backlash_mm = -1",
        (6, 1, "'backlash_mm' is -1, which is out of range", "allowed: backlash_mm >= 0"),
    ),
    "range of an optional key": (
        AXIS_X + "jump_mm_s = -1",
        (6, 1, "'jump_mm_s' is -1, which is out of range", "allowed: 0 <= jump_mm_s <= 1e+09"),
    ),
    "range with two bounds": (
        AXIS_X + "[path]\njerkrel = 1.5",
        (7, 1, "'jerkrel' is 1.5, which is out of range", "allowed: 0 <= jerkrel <= 1"),
    ),
    "cycle 0": (
        "cycle_s = 0\n" + AXIS_X,
        (1, 1, "'cycle_s' is 0, which is out of range", "allowed: 1e-06 <= cycle_s <= 1"),
    ),
    "text for a number": (
        AXIS_X + "home_mm = 'zero'",
        (6, 1, "'home_mm' must be a number, not \"zero\"", "write a number, like 1.5"),
    ),
    "true is not 1": (
        AXIS_X + "home_mm = true",
        (6, 1, "'home_mm' must be a number, not true", "write a number"),
    ),
    "nan": (
        AXIS_X + "home_mm = nan",
        (6, 1, "'home_mm' must be a finite number, not nan", "write a finite number"),
    ),
    "inf": (
        AXIS_X + "home_mm = inf",
        (6, 1, "'home_mm' must be a finite number, not inf", "write a finite number"),
    ),
    "half an input": (
        AXIS_X + "[io]\ninputs = 3.5",
        (7, 1, "'inputs' must be a whole number, not 3.5", "write a whole number, like 2"),
    ),
    "one number for a pair": (
        AXIS_X + "soft_limits_mm = [0]",
        (6, 1, "a range needs exactly two numbers", "write [low, high]"),
    ),
    "three numbers for a pair": (
        AXIS_X + "soft_limits_mm = [0, 1, 2]",
        (6, 1, "a range needs exactly two numbers", "write [low, high]"),
    ),
    "an element of an array has its own column": (
        AXIS_X + "soft_limits_mm = [0.0, 'a']",
        (6, 24, "an element of 'soft_limits_mm' must be a number, not \"a\"", "write a number"),
    ),
    "pair upside down": (
        AXIS_X + "soft_limits_mm = [5, 1]",
        (6, 1, "the range [5.0, 1.0] is empty", "write [low, high] with low < high"),
    ),
    "a table instead of a number": (
        AXIS_X + "home_mm = { a = 1 }",
        (6, 1, "'home_mm' must be a number, not a table", "write a number"),
    ),
    "a number instead of a table": (
        "path = 3\n" + AXIS_X,
        (1, 1, "'path' must be a table, not 3", "write a table"),
    ),
    "home 0 outside the limits": (
        AXIS_X + "soft_limits_mm = [5, 10]",
        (
            6,
            1,
            "axis 'X' would start at 0.0, outside its soft limits [5.0, 10.0]",
            "set home_mm, or X in [start]",
        ),
    ),
    "home outside the limits": (
        AXIS_X + "home_mm = 1\nsoft_limits_mm = [5, 10]",
        (6, 1, "axis 'X' would start at 1.0, outside its soft limits [5.0, 10.0]", "set home_mm"),
    ),
    "start outside the limits": (
        AXIS_X + "soft_limits_mm = [-5, 10]\n[start]\nX = 11",
        (8, 1, "axis 'X' would start at 11.0, outside its soft limits [-5.0, 10.0]", "set home_mm"),
    ),
    "start of no axis": (AXIS_X + "[start]\nY = 1", (7, 1, "there is no axis 'Y'", "the axes are X")),
    "two axes of one name": (
        AXIS_X + '[[axis]]\nname = "X"\nvmax_mm_s = 1\namax_mm_s2 = 1',
        (7, 1, "there are two axes 'X'", "rename one"),
    ),
    "no axis name": (
        AXIS_X.replace("X", "G"),
        (3, 1, "'G' is not an axis name", "use one of A B C P Q R U V W X Y Z"),
    ),
    "unknown offset": (
        AXIS_X + "[offsets]\nG53 = { X = 1 }",
        (7, 1, "'G53' is not a work offset", "use G54 to G59,"),
    ),
    "offset of no axis": (
        AXIS_X + "[offsets]\nG54 = { X = 1, Y = 2 }",
        (7, 16, "there is no axis 'Y'", "the axes are X"),
    ),
    "tool without a number": (
        AXIS_X + "[tools.drill]\nlength_mm = 1",
        (6, 1, "'drill' is not a number", "for example [tools.12]"),
    ),
    "tool, unknown key": (
        AXIS_X + "[tools.3]\nlenght_mm = 1",
        (7, 1, "unknown key 'lenght_mm' in [tools.3]", "did you mean 'length_mm'?"),
    ),
    "look-ahead of 1": (
        AXIS_X + "[path]\nlook_ahead_blocks = 1",
        (7, 1, "'look_ahead_blocks' must be a whole number from 2 up", 'or write "unlimited"'),
    ),
    "look-ahead in words": (
        AXIS_X + '[path]\nlook_ahead_blocks = "all"',
        (7, 1, "'look_ahead_blocks' must be a whole number from 2 up", 'or write "unlimited"'),
    ),
    "servo kind": (
        AXIS_X + '[axis.servo]\nkind = "pid"',
        (7, 1, "'kind' must be 'ideal' or 'pidf', not \"pid\"", "did you mean 'pidf'?"),
    ),
    "servo without gain": (
        AXIS_X + '[axis.servo]\nkind = "pidf"',
        (6, 1, 'a servo of kind "pidf" needs a gain', "add a line 'kp = ...' greater than 0"),
    ),
    "gain of an ideal servo": (
        AXIS_X + "[axis.servo]\nkp = 1",
        (7, 1, "'kp' has no effect on an ideal servo", 'add kind = "pidf"'),
    ),
    "time zone": (
        "epoch = 1999-01-01T00:00:00Z\n" + AXIS_X,
        (1, 1, "the machine's date and time have no time zone", "write it like 2000-01-01T00:00:00"),
    ),
    "no address": (
        AXIS_X + '[io.points]\ndoor = "B7"',
        (7, 1, "'B7' is not an address", 'write it like "I3"'),
    ),
    "address too high": (
        AXIS_X + '[io]\ninputs = 8\npoints = { door = "I8" }',
        (8, 12, "'I8' does not exist: there are 8 of this sort", "numbers start at 0"),
    ),
    "an address as a name": (
        AXIS_X + '[io.points]\nI3 = "I4"',
        (7, 1, "'I3' is an address", "use another name"),
    ),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_what_is_refused_names_the_line_the_key_and_the_way_out(case: str) -> None:
    text, (line, column, what, hint) = REFUSALS[case]
    error = refused(text)
    assert error.position is not None
    assert (error.position.line, error.position.column) == (line, column)
    assert error.position.text == text.split("\n")[line - 1]
    assert error.what.startswith(what)
    assert hint in error.hint
    assert "also" not in error.hint
    assert str(error).startswith(f"m.toml:{line}:{column}: {what}")


def test_all_problems_are_told_in_the_order_of_the_file() -> None:
    error = refused("cycle_s = 2\nnam = 'q'\n[[axis]]\nname = 'X'\nvmax_mm_s = -1\namax_mm_s2 = 1\n")
    assert str(error).split("\n") == [
        "m.toml:1:1: 'cycle_s' is 2, which is out of range",
        "    cycle_s = 2",
        "    ^",
        "also m.toml:2:1: unknown key 'nam' in the file (did you mean 'name'?)",
        "also m.toml:5:1: 'vmax_mm_s' is -1, which is out of range (allowed: 0.001 <= vmax_mm_s <= 1e+09)",
        "on line 1: allowed: 1e-06 <= cycle_s <= 1",
    ]


@pytest.mark.parametrize("model", [LinearAxis, RotaryAxis, LinearServo, RotaryServo])
def test_every_key_of_the_other_unit_is_led_to_its_own(model: type[StrictModel]) -> None:
    is_rotary = "rotary" in model.__name__.lower()
    head = AXIS_A if is_rotary else AXIS_X
    if "Servo" in model.__name__:
        head += '[axis.servo]\nkind = "pidf"\nkp = 1\n'
    own, other = ("deg", "mm") if is_rotary else ("mm", "deg")
    keys = [key for key in model.model_fields if re.search(rf"_{own}(_|$)", key)]
    assert len(keys) >= 2
    for key in keys:
        error = refused(head + re.sub(rf"_{own}(?=_|$)", f"_{other}", key) + " = 1\n")
        assert f"write '{key}', or" in error.hint


@pytest.mark.parametrize("model", [LinearAxis, RotaryAxis])
def test_every_key_with_a_letter_missing_is_recognised(model: type[StrictModel]) -> None:
    for key in set(model.model_fields) - {"name", "kind", "servo"}:
        head = AXIS_A if model is RotaryAxis else AXIS_X
        assert f"did you mean '{key}'?" in refused(f"{head}{key[:2]}{key[3:]} = 1\n").hint


# --- the text


@pytest.mark.parametrize(
    ("text", "line", "column", "what"),
    [
        ("a = 1\nb = \n", 2, 5, "not valid TOML: Invalid value"),
        ("a = 1\n[path\nb = 1", 2, 6, "not valid TOML: Expected ']' at the end of a table declaration"),
        ("a = 1\r\na = 2\r\n", 2, 6, "not valid TOML: Cannot overwrite a value"),
        ('a = 1\nb = "x', 2, 7, "not valid TOML: Unterminated string at the end of the file"),
        ("a = 1\nb = [1,\n", 3, 1, "not valid TOML: Invalid value at the end of the file"),
    ],
)
def test_syntax_errors_have_a_place(text: str, line: int, column: int, what: str) -> None:
    with pytest.raises(ConfigurationError) as caught:
        parse_toml(text, "m.toml")
    position = caught.value.position
    assert position is not None
    assert (position.line, position.column, caught.value.what) == (line, column, what)
    assert "\r" not in position.text
    assert caught.value.hint


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"cannot read '.*none\.toml': No such file"):
        load_toml(tmp_path / "none.toml")
    (tmp_path / "latin.toml").write_bytes(b'name = "fr\xe4se"')
    with pytest.raises(ConfigurationError, match="is not UTF-8 text: byte 10 is invalid"):
        load_toml(tmp_path / "latin.toml")


def test_a_byte_order_mark_and_windows_line_ends_do_not_shift_positions(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_bytes(b"\xef\xbb\xbf" + (AXIS_X + "home = 1\n").replace("\n", "\r\n").encode())
    data, locator = load_toml(path)
    with pytest.raises(ConfigurationError) as caught:
        validate(MachineConfig, data, locator)
    assert str(caught.value).startswith(f"{path}:6:1: unknown key 'home' in [[axis]]\n    home = 1\n    ^\n")


# Each mark stands right before the text that the path on its line must lead to.
LOCATED = r'''
# comment = 1, [not.a.table]
top = 1                                     # ("top",)
"quoted \" key" = "a = 2 # [x]"             # ('quoted " key',)
dotted . 'in side' = 3                      # ("dotted", "in side")
text = """
[fake]
key = 1 \""" "still" """""
raw = \'\'\'
[[fake]]\'\'\'
list = [ 1, [ 2,
    3 ], # comment ]
    { a = "]", b = [ 5 ] } ]
date = 1979-05-27 07:32:00
[table]                                     # ("table",)
inline = { x.y = 1, z = { w = 2 } }
[[item]]
name = 1
[item.part]
size = 1
[[item.hole]]
depth = 1
[[item.hole]]
depth = 2
[[item]]
name = 2
[[item.hole]]
depth = 3
[a.b]
c = 1
[a]
d = 1
'''.replace(r"\'", "'")


@pytest.mark.parametrize(
    ("path", "start"),
    [
        (("top",), "top = 1"),
        (('quoted " key',), '"quoted'),
        (("dotted",), "dotted ."),
        (("dotted", "in side"), "'in side' = 3"),
        (("text",), 'text = """'),
        (("raw",), "raw = "),
        (("list",), "list = ["),
        (("list", 0), "1, [ 2"),
        (("list", 1), "[ 2,"),
        (("list", 1, 1), "3 ],"),
        (("list", 2, "a"), 'a = "]"'),
        (("list", 2, "b", 0), "5 ] }"),
        (("date",), "date = "),
        (("table",), "[table]"),
        (("table", "inline", "x", "y"), "y = 1, z"),
        (("table", "inline", "z", "w"), "w = 2"),
        (("item", 0), "[[item]]\nname = 1"),
        (("item", 0, "part", "size"), "size = 1"),
        (("item", 0, "hole", 1, "depth"), "depth = 2"),
        (("item", 1), "[[item]]\nname = 2"),
        (("item", 1, "hole", 0, "depth"), "depth = 3"),
        (("a", "b", "c"), "c = 1"),
        (("a",), "[a]"),
        (("a", "d"), "d = 1"),
        (("item", 1, "absent"), "[[item]]\nname = 2"),
        (("absent", "deeply"), "\n# comment"),
    ],
)
def test_the_locator_follows_all_of_toml(path: KeyPath, start: str) -> None:
    _, locator = parse_toml(LOCATED, "m.toml")
    position = locator.position(path)
    before = LOCATED[: LOCATED.index(start)]
    assert position.line == before.count("\n") + 1
    assert position.column == len(before) - (before.rfind("\n") + 1) + 1
    assert position.text == LOCATED.split("\n")[position.line - 1]


keys = st.text("abXY_-09", min_size=1, max_size=4)
leaves = st.integers(-5, 5) | st.sampled_from(['"#]}"', "'[a]\"'", '"""\n[x]\n"""', "true", "[ 1, '2' ,[]]"])
tables: st.SearchStrategy[dict[str, Any]] = st.recursive(
    st.dictionaries(keys, leaves, max_size=3),
    lambda inner: st.dictionaries(keys, leaves | inner | st.lists(inner, min_size=1, max_size=3), max_size=4),
    max_leaves=12,
)


def written(
    table: dict[str, Any], path: str, at: KeyPath, lines: list[str], places: dict[KeyPath, int]
) -> None:
    """Write a table as TOML lines; note the line of every key."""
    for key, value in table.items():
        if not isinstance(value, dict | list):
            places[*at, key] = len(lines) + 1
            lines.extend(f"{key} = {value}  # {key} = 0".split("\n"))
    for key, value in table.items():
        for index, each in enumerate(value if isinstance(value, list) else []):
            places[*at, key, index] = len(lines) + 1
            lines.append(f"[[ {path}{key} ]]")
            written(each, f"{path}{key}.", (*at, key, index), lines, places)
        if isinstance(value, dict):
            places[*at, key] = len(lines) + 1
            lines.append(f"[{path}{key}]")
            written(value, f"{path}{key}.", (*at, key), lines, places)


@settings(deadline=None, max_examples=share(100))
@given(tables)
def test_the_locator_finds_every_key_of_any_file(table: dict[str, Any]) -> None:
    lines: list[str] = []
    places: dict[KeyPath, int] = {}
    written(table, "", (), lines, places)
    _, locator = parse_toml("\n".join(lines), "m.toml")
    assert {path: locator.position(path).line for path in places} == places


# --- the validation is not only for machines


class Word(StrictModel):
    letters: tuple[str, ...] = ()
    digits: int | None = None


class Dialect(StrictModel):
    name: str
    words: dict[str, Word]
    point: Word | None = None


def test_validate_serves_any_strict_model() -> None:
    data, locator = parse_toml(
        'name = "d"\n[words.feed]\nletters = ["F", "E"]\n[point]\ndigits = 3\n', "d.toml"
    )
    dialect = validate(Dialect, data, locator)
    assert dialect.words["feed"].letters == ("F", "E")
    assert dialect.point == Word(digits=3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[words.feed]\nletter = 1", "d.toml:3:1: unknown key 'letter' in [words.feed]"),
        ("[words]\n[point]\ndigit = 1", "d.toml:4:1: unknown key 'digit' in [point]"),
        (
            "[words.feed]\nletters = ['F', 2]",
            "d.toml:3:17: an element of 'letters' must be text in quotes, not 2",
        ),
        ("words = 2", "d.toml:2:1: 'words' must be a table, not 2"),
    ],
)
def test_validate_names_keys_in_any_strict_model(text: str, message: str) -> None:
    data, locator = parse_toml(f'name = "d"\n{text}', "d.toml")
    with pytest.raises(ConfigurationError) as caught:
        validate(Dialect, data, locator)
    assert str(caught.value).split("\n")[0] == message


def test_sizes_of_the_io_image_are_bounded() -> None:
    with pytest.raises(pydantic.ValidationError, match="less than or equal to 65536"):
        IoConfig(inputs=65537)


def test_two_shapes_of_ramps_are_refused() -> None:
    error = refused(AXIS_X + "[path]\njerk_mm_s3 = 40000\njerkrel = 0.3\n")
    assert "two shapes for the same ramps" in str(error)
    assert "m.toml:8" in str(error)


def test_two_rules_for_the_same_corners_are_refused() -> None:
    error = refused(AXIS_X + "[path]\njunction_deviation_mm = 0.01\nsquare_corner_mm_s = 5\n")
    assert "two rules for the same corners" in str(error)
    assert "m.toml:8" in str(error)
