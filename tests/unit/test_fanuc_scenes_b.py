"""What a Power Mate does with each function of the manual's second half, all of it, in `tests/golden/fanuc_b/NAME.txt`.

A scene drives a whole control through states; every call with its answer, and everything that the library can read and
that has changed by it, is written down. After a wanted change: `--update-goldens`, and read the difference.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from polycnc.conformance import State, load_conformance
from support import (
    fanuc_scenes_b_calls,
    fanuc_scenes_b_elsewhere,
    fanuc_scenes_b_history,
    fanuc_scenes_b_matrix,
    fanuc_scenes_b_motion,
    fanuc_scenes_b_panel,
    fanuc_scenes_b_state,
)
from support.fanuc_rows_shown import rows_shown
from support.fanuc_scenes_b import Bench

RECORDED = Path(__file__).parents[1] / "golden" / "fanuc_b"
PARTS = (
    fanuc_scenes_b_panel, fanuc_scenes_b_motion, fanuc_scenes_b_state, fanuc_scenes_b_history, fanuc_scenes_b_calls,
    fanuc_scenes_b_matrix, fanuc_scenes_b_elsewhere,
)  # fmt: skip
SCENES: dict[str, Callable[[Bench], None]] = {act.__name__: act for part in PARTS for act in part.SCENES}

# What each scene shows of the manual beside what follows from its lines by themselves.
SHOWS = {
    "panel_values": r"cnc_(rd|wr)opnlsgnl.*|IODBSGNL.*",
    "panel_at_work": r"cnc_wropnlsgnl|IODBSGNL.*|ODBST|ODBST\.(aut|run)\b.*",
    "panel_general": r"cnc_(rd|wr)opnlg.*|IODBGNRL.*|IODBRDNA.*",
    "pmc_areas": r"pmc.*|EW_NOPMC|IODBPMC.*|ODBPMCINF.*",
    "signals_idle": r"pmc_(rd|wr)pmcrng|pmc\.adr_type\.[013]",
    "signals_at_work": r"pmc_wrpmcrng|pmc\.adr_type\.[01]",
    "pmc_functions": r"ODBST\.mstb.*|param\.3030",
    "signals_of_operation": r"cnc_opdi.*|ODBOPDI.*",
    "signals_in_a_program": r"cnc_opdi.*|ODBOPDI.*",
    "direct_commands": (
        r"cnc_(refpoint|abspoint|incpoint|dwell|coordre|exebufstat|finstate|setfin)|ODBEXEC.*|ODBFIN.*|ODBPOS.*|nmod.*"
        r"|param\.80.*|concept\.direct_command|example\.cnc_(ref|abs|inc)point"
    ),
    "direct_at_work": (
        r"cnc_(refpoint|abspoint|incpoint|dwell|coordre|exebufstat|finstate|setfin)|ODBEXEC.*|ODBFIN.*|ODBPOS"
        r"|ODBPOS\.[il]data|nmod.*|concept\.direct_command|cnc_opdi(\.(number\.|sig)([1-4]|10)\b.*)?"
    ),
    "direct_units": r"ODBPOS.*|cnc_(refpoint|abspoint|incpoint|coordre)|concept\.not_on_pmd|param\.(0000_2|100.*)",
    "configurations": r"cnc_sys(info|config)|ODBSYSC?(\..*)?|example\.cnc_sysinfo",
    "figures": r"cnc_getfigure.*|getfigure.*|concept\.increment_system|param\.(0000_2|100.*)",
    "states": r"cnc_statinfo|ODBST(\..*)?",
    "alarms": r"cnc_alarm|ODBALM.*|cnc_rdalminfo.*|ALMINFO.*|ODBHIS\.alm_grp.*|ODBST\.alarm.*|ODBAHIS.*",
    "real_alarms": r"cnc_alarm|ODBALM(\.data)?|cnc_rdalminfo|ALMINFO.*|ODBST\.alarm.*",
    "modal": r"cnc_modal.*|ODBMDL.*|modal.*|param\.3030",
    "diagnosis": r"cnc_diagnos.*|ODBDGN.*|diag.*",
    "servo_values": r"cnc_rd(current|srvspeed|loopgain)|param\.2086",
    "messages": r"cnc_rdopmsg.*|OPMSG.*|option\.external.*|MSG_SIZE",
    "history_table": r"cnc_(rd|wr)hissgnl.*|IODBSIG.*",
    "history_signals": r"cnc_(wrhissgnl|rdophistry)|IODBSIG.*|ODBHIS(\..*sig.*)?|concept\.history_record_kinds",
    "history_records": (
        r"cnc_(stop|start|clear|rd)ophis.*|cnc_rdalmhis.*|ODBHIS(?!\.(alm_grp|sig)).*|ODBAHIS.*"
        r"|concept\.history.*"
    ),
    "reads_in_states": (
        r"ODBPOS(\.idata)?|(cnc_getfigure\.data_|cnc_rdalminfo\.|pmc\.(adr|data)_)type.*|nmod.*"
        r"|cnc_modal\.type\.(0_20|100_126|200_205)|pmc_rdpmcinfo|ODBPMCINF.*"
    ),
    "areas_in_states": r"IODBPMC\.(type_[ad]|datano_[se])",
    "over_the_network": r"ODBST|ODBALM|ODBSYS|cnc_(statinfo|alarm|sysinfo)|IODBPMC.*",
    "diagnosis_elsewhere": r"ODBDGN.*|diag\.(axis|kind|type_attr).*",
    "modal_elsewhere": r"param\.3030",
    "signals_in_states": r"cnc_opdi(\.(number|sig).*)?|ODBOPDI.*|ODBST|ODBST\.(aut|run|motion|mstb|emergency|alarm)",
    "panel_in_states": r"ODBST|ODBST\.(aut|run|motion|mstb|emergency|alarm)",
    "figures_elsewhere": (
        r"getfigure\.(valid.*|dec\.(\w+\.IS-[ABC]\.mm|\w+\.IS-[BC]\.inch|axis\.IS-[ABC]\.deg))"
        r"|concept\.increment_system|param\.(0000_2|100.*)"
    ),
    "configurations_elsewhere": r"ODBSYS\.(mt_type|cnc_type).*|ODBSYSC\.(sv[135]min|sicmin|posmin|hdiio).*",
    "commands_in_states": r"param\.80.*|ODBEXEC\.state.*|concept\.direct_command",
    "faults": (
        r"cnc_(opdi|exebufstat|finstate|setfin|refpoint|abspoint|incpoint|dwell|coordre)\.err\.EW_BUSY"
        r"|common\.handle2"
    ),
}
CONFORMANCE = load_conformance()
STATED = [row.id for row in CONFORMANCE.rows("fanuc") if CONFORMANCE.state(row.id) is State.TESTED]
# Alarms, states and addresses that no scene brings about.
OF_ALL = r"ODBST(\.(aut|run|motion|emergency|alarm)(\.\d+)?)?"
# What holds in every state and mode that these go through.
IN_ALL = r"common\.allmode|example\.cnc_rdopmsg|OPMSG\.datano\.-1|cnc_rdopmsg(\.type\.0)?"
MANY_STATES = (
    "states",
    "alarms",
    "reads_in_states",
    "commands_in_states",
    "signals_in_states",
    "over_the_network",
)
AT_WORK = (
    "panel_at_work",
    "signals_at_work",
    "signals_in_a_program",
    "direct_at_work",
    "real_alarms",
    "servo_values",
)
ELSEWHERE = re.compile(r"fanuc\.(modal\.G\.20\..*|.*EW_OK)")


def shown(name: str) -> list[str]:
    """Return the rows that a scene shows."""
    more = [OF_ALL] * (name in AT_WORK) + [IN_ALL] * (name in MANY_STATES)
    wanted = re.compile(rf"fanuc\.({'|'.join([SHOWS.get(name, ''), *more])})")
    file = RECORDED / f"{name}.txt"
    seen = {f"fanuc.{row}" for row in rows_shown(file.read_text(encoding="utf-8") if file.exists() else "")}
    return [row for row in STATED if (row in seen or wanted.fullmatch(row)) and not ELSEWHERE.fullmatch(row)]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.covers(*shown(name))) for name in SCENES]
)
def test_a_power_mate_does_what_is_written_down(name: str, request: pytest.FixtureRequest) -> None:
    bench = Bench()
    SCENES[name](bench)
    file, found = RECORDED / f"{name}.txt", bench.text()
    if request.config.getoption("update_goldens"):
        file.write_text(found, encoding="utf-8")
    assert found.splitlines() == file.read_text(encoding="utf-8").splitlines()
