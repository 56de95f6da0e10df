"""Control files for tests of the post-processor: a plain one that can be changed, and how to post a text with it."""

from __future__ import annotations

from polycnc.post import ControlFile, parse_control
from polycnc.post.output._program import BlockMap, PostSummary, post_program
from polycnc.post.tool_path._tool_path import ToolPath, parse_tool_path

# Every event writes one block, so that a test can read what was called with which words.
MACROS = {
    "PROGRAM_START": '@0@"%"\n!G90!!G94!!G40!\nG21',
    "PROGRAM_END": "!M30!",
    "TOOL_CHANGE": "&X&&Y&&Z&&F&\n$T$!M06!",
    "SPINDLE_CW": "$S$!M03!",
    "SPINDLE_CCW": "$S$!M04!",
    "SPINDLE_OFF": "!M05!",
    "COOLANT_FLOOD": "!M08!",
    "COOLANT_OFF": "!M09!",
    "RAPID": "!-G00!$X$$Y$$Z$",
    "LINEAR": "!-G01!$X$$Y$$Z$$F$",
    "ARC_CW": "<N=PLANE>\nIF(N==17)\n!-G17!!-G02!$X$$Y$$Z$$I$$J$$F$\nELSE IF(N==18)\n!-G18!!-G02!$X$$Y$$Z$$I$$K$$F$\n"
    "ELSE\n!-G19!!-G02!$X$$Y$$Z$$J$$K$$F$\nENDIF",
    "ARC_CCW": "<N=PLANE>\nIF(N==17)\n!-G17!!-G03!$X$$Y$$Z$$I$$J$$F$\nELSE IF(N==18)\n!-G18!!-G03!$X$$Y$$Z$$I$$K$$F$\n"
    "ELSE\n!-G19!!-G03!$X$$Y$$Z$$J$$K$$F$\nENDIF",
    "COMP_LEFT": '"G41"',
    "DWELL": "<P=DWELL>!G04!$P$",
    "STOP": "!M00!",
    "OPTIONAL_STOP": "!M01!",
    "COMMENT": '"("$COMMENT$")"',
}
_FIRST_HOLE = "IF(HOLE==1)\n!-G17!\n&X*X&&Y*Y&&Z*Z&&R*R&&Q*Q&\nENDIF\n"
CYCLES = {
    macro: f"{_FIRST_HOLE}IF(RETRACT==98)\n!-G98!!-{code}!$X$$Y$$Z$$R${words}$F$\n"
    f"ELSE\n!-G99!!-{code}!$X$$Y$$Z$$R${words}$F$\nENDIF"
    for macro, code, words in (
        ("CYCLE_DRILL", "G81", ""),
        ("CYCLE_DWELL", "G82", "$P$"),
        ("CYCLE_DEEP", "G83", "$Q$"),
        ("CYCLE_CHIP_BREAK", "G73", "$Q$"),
        ("CYCLE_BORE", "G85", ""),
    )
} | {"CYCLE_OFF": "!G80!\n&Z&\n&R&\n&Q&\n&P&\n!*G00!\n&G00&"}

_GROUPS = {
    "motion": ("G00", "G01", "G02", "G03", "G73", "G81", "G82", "G83", "G85", "G80"),
    "plane": ("G17", "G18", "G19"),
    "retract": ("G98", "G99"),
    "": ("G04", "G40", "G90", "G94", "G95"),
}
_MODAL = ("X", "Y", "Z", "A", "B", "C", "F", "R", "Q", "S", "T")
_NOT_MODAL = ("I", "J", "K", "P")


def control_text(
    parameters: dict[str, str | int | float | bool] | None = None,
    macros: dict[str, str] | None = None,
    decimals: int = 3,
    cycles: bool = True,
) -> str:
    """Return a control file: the plain one with other parameters and macros; an empty macro is left out."""
    lines = ["[parameters]", f"decimals = {decimals}"]
    for key, value in (parameters or {}).items():
        shown = str(value).lower() if isinstance(value, bool) else repr(value)
        lines.append(f"{key} = {shown}")
    for group, keys in _GROUPS.items():
        lines += [f'[g_code.{key}]\ngroup = "{group}"' if group else f"[g_code.{key}]" for key in keys]
    lines += [f"[m_code.M{number:02d}]" for number in (0, 1, 3, 4, 5, 6, 8, 9, 30)]
    for letter in (*_MODAL, *_NOT_MODAL):
        whole = letter in "ST"
        form = "%d" if whole else f"%.{decimals}f"
        modal = "false" if letter in _NOT_MODAL else "true"
        lines.append(f'[function_variables.{letter}]\nformat = "{letter}{form}"\nmodal = {modal}')
    lines.append(f'[function_variables.RADIUS]\nformat = "R%.{decimals}f"\nmodal = false')
    lines.append("[nc_macros]")
    chosen = {**MACROS, **(CYCLES if cycles else {}), **(macros or {})}
    lines += [f"{name} = '''\n{text}'''" for name, text in chosen.items() if text]
    return "\n".join(lines) + "\n"


def control(
    parameters: dict[str, str | int | float | bool] | None = None,
    macros: dict[str, str] | None = None,
    decimals: int = 3,
    cycles: bool = True,
) -> ControlFile:
    """Return the plain control file with other parameters and macros."""
    return parse_control(control_text(parameters, macros, decimals, cycles), "test.toml")


def posted(
    text: str | ToolPath, used: ControlFile | None = None, block_map: BlockMap | None = None
) -> tuple[list[str], PostSummary]:
    """Return the blocks of a tool path and the summary."""
    tool_path = parse_tool_path(text, "part.cl") if isinstance(text, str) else text
    pieces: list[str] = []
    summary = post_program(tool_path, used or control(), pieces.append, block_map=block_map)
    return "".join(pieces).splitlines(), summary
