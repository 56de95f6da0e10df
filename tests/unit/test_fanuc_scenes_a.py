"""What a whole Power Mate tells programs on a PC, written down in `tests/golden/fanuc_a/NAME.txt`.

Manual 000, first half; the numbers were compared with it when they were written down. Here nothing can change unseen:
positions in every unit, refusals with every argument, each program function in every state, each parameter with both
ends of its range. After a wanted change: `--update-goldens`, and read the difference.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any

import pytest

from polycnc.conformance import State, load_conformance
from polycnc.controllers.fanuc import fwlib
from polycnc.controllers.fanuc.fwlib import EW
from support import fanuc_scenes_a_axes as axes
from support import fanuc_scenes_a_data as data
from support import fanuc_scenes_a_macros as macros
from support import fanuc_scenes_a_mixed as mixed
from support import fanuc_scenes_a_more as more
from support import fanuc_scenes_a_products as products
from support import fanuc_scenes_a_programs as programs
from support import fanuc_scenes_a_walk as walk
from support import fanuc_scenes_a_wire as wire
from support.fanuc_scenes_a import Bench, short

RECORDED = Path(__file__).parents[1] / "golden" / "fanuc_a"
AXES = "actf|absolute|machine|relative|distance|skip|srvdelay|accdecdly|rddynamic|wrrelpos"
OF_AXES = rf"(example\.)?cnc_({AXES})|(struct\.)?(ODBACT|ODBAXIS|ODBDY|IDBWRR)(\..*)?"
STRUCTURES = (
    r"ODBACT|ODBAXIS|ODBDY|IDBWRR|ODBUP|PRGDIR|ODBNC|ODBPRO|ODBSEQ|ODBMDIP|ODBTOFS|IODBTO|ODBTLINF|IODBPSD|ODBPARAIF|ODBM|IODBMR"
    r"|ODBMVINF"
)
CODES = r"EW_(LENGTH|NUMBER|ATTRIB|DATA|BUSY|FUNC|PROT|OVRFLOW|RESET|MODE|REJECT|NOOPT|OK)|concept\.return_convention"
PROGRAMS = (
    r"dwnstart|download|dwnend|upstart|upload|upend|search|delall|delete|rdprogdir|rdproginfo|rdprgnum|rdseqnum|rdexecprog"
    r"|wrmdiprog|rdmdipntr|wrmdipntr|seqsrch|rewind"
)
PARAMETERS = r"rdparam|wrparam|rdparar|wrparas|rdparainfo|rdsetr|wrsets"
OF_PARAMETERS = r"(struct\.)?(IODBPSD|ODBPARAIF)(\..*)?|paramtype\..*"
MACROS = r"rdmacro|wrmacro|rdmacror|wrmacror|rdmacroinfo|getmactype|setmactype"
OFFSETS = r"rdtofs|wrtofs|rdtofsr|wrtofsr|rdtofsinfo"
TRANSFERS = (
    r"(example\.)?cnc_(download|dwnstart|dwnend|upstart|upload|upend)(_format)?(\.err\..*)?|format\.(download|upload)|LF|PERCENT|MAX_RBUF"
    r"|concept\.((down|up)load_session|tv_check|duplicate_program|program_number_range|memory_accounting|no_nul_termination)"
    r"|range\.download_number|(struct\.)?ODBUP(\..*)?|ncparam\.(0000_0|3201_[26])"
)

MIXED = (
    rf"(example\.)?cnc_({AXES}|{PROGRAMS}|{PARAMETERS}|{MACROS}|{OFFSETS})(\.err\.(?!EW_RESET).*)?|{CODES}|mode\..*|units\..*|paramtype\..*"
    rf"|(struct\.)?({STRUCTURES})(\..*)?|enum\..*|option\..*|range\.(?!node).*|MAX_AXIS|ALL_AXES|format\..*"
    r"|concept\.(?!function_index|header|c_types|handle_lifecycle|truncation).*"
)
PRODUCTS = (
    rf"cnc_({AXES}|{OFFSETS}|{MACROS}|{PARAMETERS}|rdprogdir|rdproginfo|upstart|upload|upend|search|seqsrch|wrmdipntr|wrmdiprog|rewind|download)"
    r"(\.err\.EW_(LENGTH|NUMBER|ATTRIB|DATA|NOOPT|PROT|MODE|REJECT))?|range\.(download_number|mdi_length)|ALL_AXES"
    r"|EW_(LENGTH|NUMBER|ATTRIB|DATA|PROT|MODE)|enum\.(param_axis|offset_type|rdprog.*|macro_type)\..*"
    r"|concept\.(length_argument|axis_param_rule|macro_local_scope|macro_out_of_range|setting_subset|program_number_range|param_record_stream)"
    r"|ODB(AXIS|DY|TOFS|M|PARAIF)\..*|IODBMR\..*|IODBTO\..*|IODBPSD\..*|enum\.(axis|prm_attr)\..*|paramtype\..*|concept\.bit_param_rmw"
    r"|ncparam\.(?!1004).*|example\.cnc_(rd|wr)(tofsr|parar|paras|macror)|concept\.(length_argument|axis_number|sparse_parameters)|MAX_AXIS"
)

SCENES: dict[str, tuple[Callable[[Bench], None], str]] = {
    "moves": (
        axes.moves,
        rf"{OF_AXES}|ALL_AXES|MAX_AXIS|concept\.(position_contents|dynamic_snapshot|decimal_point|axis_number)|enum\.axis\..*"
        r"|units\..*|ncparam\.1004_.|concept\.seqnum_retention|cnc_(rdexecprog|rdprgnum|rdseqnum)",
    ),
    "refusals": (
        axes.refusals,
        rf"cnc_({AXES})\.err\..*|cnc_wrrelpos|example\.cnc_wrrelpos|enum\.axis\..*|concept\.(length_argument|axis_number)|ALL_AXES"
        r"|MAX_AXIS|IDBWRR\..*|ODBDY\.pos.*|EW_(LENGTH|ATTRIB|DATA)",
    ),
    "structures": (
        axes.structures,
        rf"(struct\.)?({STRUCTURES})(\.(?!prm_type\.bit).*)?|concept\.(c_types|struct_packing|no_nul_termination)|MAX_AXIS",
    ),
    "alarms": (
        axes.alarms,
        r"ODBDY\.alarm.*|concept\.(ps000_after_write|alarm_ps000_ps101|dynamic_snapshot)|cnc_rddynamic|ncparam\.132[01]",
    ),
    "feeds": (
        walk.feeds,
        r"(example\.)?cnc_actf|ODBACT\..*|ODBDY\.actf|cnc_rddynamic|cnc_(absolute|machine|distance)",
    ),
    "transfers": (programs.transfers, TRANSFERS),
    "rules": (
        programs.rules,
        rf"{TRANSFERS}|(example\.)?cnc_(delete|delall|search|wrmdiprog)(\.err\.EW_(PROT|DATA|BUSY))?"
        r"|concept\.(write_protection_programs|protect_key|selected_program|tv_check)|ncparam\.(3202_.|3290_7)"
        r"|EW_(PROT|OVRFLOW|DATA)|cnc_rdproginfo|ODBNC\..*",
    ),
    "directory": (
        programs.directory,
        r"(example\.)?cnc_(rdprogdir|rdproginfo)(_format)?(\.err\..*)?|format\.prog.*|enum\.rdprog.*|(struct\.)?(PRGDIR|ODBNC)(\..*)?"
        r"|MAX_PBUF|concept\.(comment_rules|memory_accounting|truncation|no_nul_termination|program_number_range)|LF|PERCENT",
    ),
    "execution": (
        programs.execution,
        r"(example\.)?cnc_(rdprgnum|rdseqnum|rdexecprog|seqsrch|rewind|search)(\.err\..*)?|(struct\.)?(ODBPRO|ODBSEQ)(\..*)?"
        r"|ODBDY\.(prgnum|prgmnum|seqnum)|concept\.(subprogram_numbers|seqnum_retention|selected_program)|enum\.search\..*",
    ),
    "mdi": (
        programs.mdi,
        r"(example\.)?cnc_(wrmdiprog|rdmdipntr|wrmdipntr)(_format)?(\.err\..*)?|(struct\.)?ODBMDIP(\..*)?|concept\.mdi_program"
        r"|range\.mdi_length|mode\.MDI|cnc_(rdexecprog|rdprgnum|rdseqnum)|concept\.subprogram_numbers",
    ),
    "states": (
        programs.states,
        rf"cnc_({PROGRAMS})(\.err\..*)?|example\.cnc_(search|delete|delall)|mode\..*|enum\.search\..*|{CODES}"
        r"|concept\.((down|up)load_session|program_busy_conditions|alarm_ps000_ps101|op_signal|mode_matrix|mdi_program|protect_key"
        r"|background_edit|compare_running|selected_program|write_protection_programs|blocking_download)|ncparam\.3202_4",
    ),
    "offsets": (
        data.offsets,
        rf"(example\.)?cnc_({OFFSETS})(\.err\..*)?|(struct\.)?(ODBTOFS|IODBTO|ODBTLINF)(\..*)?|units\..*|ncparam\.1004_."
        r"|enum\.offset_type\..*|concept\.(tool_offset_memory|length_argument|position_contents)",
    ),
    "parameters": (
        data.parameters,
        rf"(example\.)?cnc_({PARAMETERS})(\.err\..*)?|{OF_PARAMETERS}|enum\.(prm_attr|param_axis)\..*"
        r"|concept\.(axis_param_rule|bit_param_rmw|ps000_after_write|sparse_parameters|length_argument|axis_number)"
        r"|ncparam\.(1020|132[01]|608.)|EW_(LENGTH|NUMBER|ATTRIB|DATA|PROT)",
    ),
    "ranges": (
        data.ranges,
        rf"(example\.)?cnc_({PARAMETERS})(\.err\..*)?|{OF_PARAMETERS}|enum\.(prm_attr|param_axis)\..*"
        r"|concept\.(param_record_stream|axis_param_rule|range_growth|setting_subset|option_none|length_argument)|option\.param_write"
        r"|ALL_AXES|MAX_AXIS|EW_(LENGTH|NUMBER|ATTRIB|DATA|NOOPT|PROT)",
    ),
    "effects": (
        data.effects,
        r"ncparam\.(1004_.|1020|132[01]|608.)|concept\.(ps000_after_write|tool_offset_memory|decimal_point)|ODBPARAIF\.prm_type\.bit6"
        r"|example\.cnc_(wrparam|wrparas)|units\..*",
    ),
    "macros": (
        macros.macros,
        rf"(example\.)?cnc_({MACROS})(\.err\..*)?|(struct\.)?(ODBM|IODBMR|ODBMVINF)(\..*)?|enum\.(use_no2|macro_type)\..*"
        r"|concept\.macro_.*|concept\.length_argument",
    ),
    "everywhere": (
        macros.everywhere,
        rf"(example\.)?cnc_({AXES}|{PARAMETERS}|{OFFSETS}|{MACROS}|rdprogdir|rdproginfo|rdprgnum|rdseqnum|rdexecprog)(\.err\..*)?|mode\..*"
        r"|(struct\.)?(ODBAXIS|ODBDY|ODBPRO|ODBSEQ|IDBWRR|ODBTOFS|IODBTO|IODBPSD|ODBM|IODBMR|ODBMVINF|ODBTLINF)(\..*)?|paramtype\..*"
        r"|concept\.(option_none|mode_matrix|macro_local_scope|axis_number)|option\.param_write|MAX_AXIS|ALL_AXES"
        r"|EW_(LENGTH|NUMBER|ATTRIB|DATA|PROT|NOOPT)",
    ),
    "mixed": (mixed.mixed, MIXED),
    "products": (products.products, PRODUCTS),
    "elsewhere": (
        more.elsewhere,
        r"ncparam\.(0000_0|132[01]|608.|3201_2|3202_.|3290_7)|cnc_dwnstart\.err\.EW_PROT|concept\.(power_mate_d_limit|protect_key|duplicate_program|handle_lifecycle|write_protection_programs|selected_program)"
        r"|cnc_(freelibhndl|dwnstart|rdprogdir)|cnc_(download|dwnend)\.err\.EW_(DATA|PROT|RESET|FUNC)|units\..*|ODBDY\.alarm(\.bit[34])?|concept\.(tv_check|tool_offset_memory|position_contents)"
        r"|cnc_(absolute|machine|rddynamic|rdmacror|rdtofs|wrtofs|wrparam|download|dwnend|wrmdiprog)(\.err\.EW_DATA)?|EW_(DATA|NOOPT)"
        r"|cnc_wrparam\.err\.EW_NOOPT|option\.param_write|IODBMR\.data\..*|enum\.axis\.ALL_AXES|ALL_AXES|MAX_AXIS",
    ),
    "handles": (
        macros.handles,
        r"concept\.power_mate_d_limit|EW_(?!NOPMC).*|cnc_(allclibhndl2?|freelibhndl)|concept\.(handle_lifecycle|return_convention|upload_session|download_session)|range\.node"
        r"|cnc_(getmactype|setmactype)",
    ),
    "wire": (
        wire.wire,
        r"cnc_(actf|absolute|machine|relative|skip|rdparam|rdmacror?|wrmacror?|rdprgnum|rdseqnum|search|delete)",
    ),
    **{
        name: (
            partial(walk.walk, name),
            rf"cnc_({AXES}|{PROGRAMS}|{PARAMETERS}|{OFFSETS}|{MACROS})(\.err\.EW_(LENGTH|NUMBER|ATTRIB|DATA|MODE|FUNC))?|ODBDY\..*",
        )
        for name in walk.WALKS
    },
}
CONFORMANCE = load_conformance()
ROWS = [row.id for row in CONFORMANCE.rows("fanuc") if CONFORMANCE.state(row.id) is not State.NOT_APPLICABLE]


# What every look reads.
LOOK = re.compile(
    rf"(example\.)?cnc_({AXES.removesuffix('|wrrelpos')}|rdprgnum|rdseqnum|rdexecprog|rdmdipntr|rdprogdir|rdproginfo)"
    r"|format\.prog.*|(ODBAXIS|ODBDY|ODBACT|ODBPRO|ODBSEQ|ODBMDIP|ODBNC|PRGDIR)\..*|enum\.(rdprog.*|axis\..*)|concept\.dynamic_snapshot"
)
LOOKS = ("moves", "transfers", "rules", "directory", "execution", "mdi", "macros", *walk.WALKS)


WORD = re.compile(r"\b[A-Z]{2,}\b")  # a code that stands in what is written down is claimed


def _scene(name: str) -> Any:
    shown = re.compile(f"{SCENES[name][1]}|{LOOK.pattern}" if name in LOOKS else SCENES[name][1])
    file = RECORDED / f"{name}.txt"
    words = set(WORD.findall(file.read_text(encoding="utf-8"))) if file.exists() else set()
    codes = {f"fanuc.{code.name}" for code in EW if short(code) in words}
    rows = [row for row in ROWS if row in codes or shown.fullmatch(row.removeprefix("fanuc."))]
    return pytest.param(name, marks=pytest.mark.covers(*rows))


@pytest.mark.parametrize("name", [_scene(name) for name in SCENES])
def test_a_control_tells_what_is_written_down(name: str, request: pytest.FixtureRequest) -> None:
    bench = Bench()
    SCENES[name][0](bench)
    fwlib.detach()
    file = RECORDED / f"{name}.txt"
    if request.config.getoption("update_goldens"):
        file.write_text("\n".join([*bench.lines, ""]), encoding="utf-8")
    wanted = file.read_text(encoding="utf-8").splitlines()
    different = next(
        (pair for pair in zip_longest(bench.lines, wanted, fillvalue="nothing") if pair[0] != pair[1]), None
    )
    assert different is None, f"{different[0]} instead of {different[1]}"
