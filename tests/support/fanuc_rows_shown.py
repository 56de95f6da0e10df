"""Which rows of the manual's second half the text of a scene shows: if they broke, its lines would be others."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator

from support.fanuc_scenes_b import LETTERS

AREAS = {
    "G": ("0000_0255", "1000_1255"), "F": ("0000_0255", "1000_1255"), "Y": ("0000_0127", "1000_1063"),
    "X": ("0000_0127", "1000_1063"), "A": ("0000_0024",), "R": ("0000_0999", "9000_9117"), "T": ("0000_0079",),
    "K": ("0000_0019",), "C": ("0000_0079",), "D": ("0000_1859",),
}  # fmt: skip
PANEL = {
    "mode": 0, "rpd_ovrd": 3, "jog_ovrd": 4, "feed_ovrd": 5, "blck_del": 7, "sngl_blck": 8, "machn_lock": 9,
    "dry_run": 10, "mem_prtct": 11, "feed_hold": 12,
}  # fmt: skip
PASSED = {
    "cnc_wropnlsgnl": "IODBSGNL", "cnc_wropnlgnrl": "IODBGNRL", "cnc_wropnlgsname": "IODBRDNA",
    "cnc_sysinfo": "ODBSYS", "cnc_sysconfig": "ODBSYSC", "cnc_rdopmsg": "OPMSG",
}  # fmt: skip
NUMBERED = {
    "cnc_clearophis": "slct",
    "cnc_getfigure": "data_type",
    "cnc_rdalminfo": "type",
    "cnc_modal": "type",
}
RECORDS = {"key": "mdi", "signal": "sgn", "alarm": "alm", "date": "date", "time": "time"}
KINDS = ("bit", "byte", "word", "2word")
FLAGS = {0x80: "bit7", 0x40: "bit6", 0x20: "bit5", 0x10: "bit4", 0x0F: "bits3_0"}
SIGNAL_KINDS = "?XGYF"

Found = Iterator[str]


def _bits(row: str, value: int) -> Found:
    return (f"{row}.bit{bit}" for bit in range(16) if value >> bit & 1)


def _whole(name: str, function: str, member: str, *values: int) -> Found:
    """Yield a structure, the function that reads or writes it, a member, and its values."""
    yield from (name, function, f"{name}.{member}")
    for value in values:
        yield f"{name}.{member}.{value}"
        yield from _bits(f"{name}.{member}", value)


def _state(member: str, *values: str) -> Found:
    return _whole("ODBST", "cnc_statinfo", member, *map(int, values))


def _panel(member: str, *values: str) -> Found:
    yield from _whole("IODBSGNL", "cnc_rdopnlsgnl", member, *map(int, values))
    if member in PANEL:
        yield f"cnc_rdopnlsgnl.slct_data.bit{PANEL[member]}"


def _general(*values: str) -> Found:
    numbers = [int(value, 2) for value in values]
    yield from _whole("IODBGNRL", "cnc_rdopnlgnrl", "sgnal", *numbers)
    for number in numbers:
        yield from _bits("cnc_rdopnlgnrl.slct_data", number)


def _name(signal: str) -> Found:
    yield from _whole("IODBRDNA", "cnc_rdopnlgsname", f"sgnl{signal}_name")
    yield f"cnc_rdopnlgsname.slct_data.bit{int(signal) - 1}"


def _groups(*values: str) -> Found:
    for value in values:
        yield from _whole("ODBALM", "cnc_alarm", "data", int(value, 16))
        yield from _bits("cnc_rdalminfo.alm_type", int(value, 16))


def _alarm() -> Found:
    yield from ("ALMINFO", "cnc_rdalminfo", "cnc_rdalminfo.type.1", "ALMINFO.data_end")
    yield from (f"ALMINFO.alm.{member}" for member in ("axis", "alm_no", "msg_len", "alm_msg"))


def _message(old: str, new: str) -> Found:
    yield from ("OPMSG", "cnc_rdopmsg", "cnc_rdopmsg.type.0", "OPMSG.datano")
    for text in (old, new):
        yield "OPMSG.datano.-1" if "datano=-1" in text else "OPMSG.datano.range"
        yield from (f"OPMSG.{member}" for member in ("char_num", "data") if member in text)


def _diagnosis(axis: str, kind: str) -> Found:
    yield from ("cnc_diagnosr", "ODBDGN", "diag.axis.-1", f"diag.type_attr.{kind}")
    yield f"diag.kind.{KINDS[int(kind)]}{'_axis' if axis == '255' else ''}"


def _group(block: str, group: str, *values: str) -> Found:
    yield from ("cnc_modal", f"cnc_modal.block.{block}", "cnc_modal.type.-1", "ODBMDL", "ODBMDL.g_rdata")
    for value in (int(each, 16) for each in values if each != "-"):
        yield from (f"modal.G.{group}.{value & 0x7F}", "ODBMDL.g_data.bits6_0")
        if value & 0x80:
            yield "ODBMDL.g_data.bit7"


def _word(block: str, number: str, *values: str) -> Found:
    of_axis = int(number) >= 200
    yield from ("cnc_modal", f"cnc_modal.block.{block}", f"cnc_modal.type.{-3 if of_axis else -2}", "ODBMDL")
    yield from (f"modal.{'axis' if of_axis else 'addr'}.{number}", f"ODBMDL.raux{1 + of_axis}")
    for _, first, second in (each.split() for each in values if each != "-"):
        yield from (f"ODBMDL.flag1.{name}" for mask, name in FLAGS.items() if int(first, 16) & mask)
        if int(second, 16):
            yield "ODBMDL.flag2.bits2_0"


def _buffers(name: str, function: str, texts: Iterable[str]) -> Found:
    yield from (name, f"{name}.cdata", function)
    for text in texts:
        for row, part in enumerate(text.split()[-2:] if name == "ODBEXEC" else text.split()[-1:], 1):
            yield from (f"{name}.EMNT{row}{k}" for k in range(1, 7) if bytes.fromhex(part)[k - 1])


def _of_pmc(function: str, letter: str, address: str, data_type: str = "0") -> Found:
    kind = LETTERS.index(letter)
    yield from (function, f"pmc.adr_type.{kind}", f"pmc.data_type.{data_type}", "IODBPMC", "IODBPMC.u")
    yield f"IODBPMC.u.{'cil'[int(data_type)]}data"
    for area in AREAS[letter]:
        low, high = map(int, area.split("_"))
        if low <= int(address) <= high:
            yield f"pmc.area.{letter}.{area}"


def _members(name: str, text: str) -> Found:
    for member, value in re.findall(r"(\w+)=(-?\w*)", text):
        yield from (f"{name}.{member}", f"{name}.{member}.{value}")
        if value.isdigit():
            yield from _bits(f"{name}.{member}", int(value))


def _operation(kind: str, text: str) -> Found:
    yield from ("cnc_rdophistry", "cnc_rdophisno", "ODBHIS", f"ODBHIS.rec_{RECORDS[kind]}", "ODBHIS.rec_type")
    yield f"ODBHIS.rec_type.{list(RECORDS).index(kind)}"
    yield from _members("ODBHIS", text)
    values = dict(re.findall(r"(\w+)=(-?\d+)", text))
    yield from _bits("ODBHIS.alm_grp", int(values.get("alm_grp", 0)) & 0xFFFF)
    if "sig_name" in values:
        yield f"ODBHIS.sig_no.{SIGNAL_KINDS[int(values['sig_name'])]}"


def _past_alarm(text: str) -> Found:
    yield from ("cnc_rdalmhistry", "cnc_rdalmhisno", "ODBAHIS", "ODBAHIS.alm_his.alm_grp")
    yield from _members("ODBAHIS.alm_his", text)


def _call(name: str, given: str, code: str, answer: str) -> Found:
    if code != "EW_OK":
        yield f"{name}.err.{code}"
        return
    yield name
    numbers = [int(each) for each in re.findall(r"(?<![\w=])-?\d+", given)]
    if name in PASSED:
        yield PASSED[name]
        yield from _members(PASSED[name], f"{given} {answer}")
    if name in NUMBERED:
        yield f"{name}.{NUMBERED[name]}.{numbers[0]}"
    if name.startswith("cnc_rdopnl"):
        yield from _bits(f"{name}.slct_data", numbers[0] & 0xFFFF)
    if name == "cnc_wropnlgnrl":
        yield from _bits(f"{name}.type", int(re.findall(r"type=(-?\d+)|$", given)[0] or 0) & 0xFF)
    if name == "cnc_diagnoss":
        yield from ("ODBDGN", f"diag.axis.{'1..m' if numbers[1] > 0 else numbers[1]}")
    if name == "pmc_rdpmcrng":
        yield from _of_pmc(name, LETTERS[numbers[0]], str(numbers[2]), str(numbers[1]))


def _signal(number: str, axis: str, value: str, code: str) -> Found:
    if code == "EW_NUMBER":
        yield "cnc_opdi.number.undefined"
    if code != "EW_OK":
        return
    sign = f"cnc_opdi.sig{number}"
    yield from ("cnc_opdi", "ODBOPDI", "ODBOPDI.u.cdata", f"cnc_opdi.number.{number}")
    yield from (f"{sign}.cdata.{value}", f"{sign}.mode.{value}", f"{sign}.{value}")
    yield from _bits(f"{sign}.cdata", int(value))
    if axis:
        yield from ("ODBOPDI.axis", f"{sign}.axis")


def _command(name: str, flag: str, given: str, code: str, answer: str) -> Found:
    if code != "EW_OK":
        yield f"cnc_{name}.err.{code}"
        return
    yield from (f"cnc_{name}", "concept.direct_command", f"nmod.{flag}")
    if given:
        yield from ("ODBPOS", "ODBPOS.idata", "ODBPOS.ldata")
    yield from _buffers("ODBEXEC", "ODBEXEC", [answer])


def _panel_written(member: str, value: str) -> Found:
    if member in PANEL:
        yield from _whole("IODBSGNL", "cnc_wropnlsgnl", member, int(value))
        yield from ("IODBSGNL.type", f"IODBSGNL.type.bit{PANEL[member]}")


RULES: tuple[tuple[str, Callable[..., Found]], ...] = (
    (r"    state (\w+): (\d+) > (\d+)", _state),
    (r"    panel (\w+): (\d+) > (\d+)", _panel),
    (r"    general: (\d{8}) > (\d{8})", _general),
    (r"    name (\d): .*", _name),
    (r"    alarm groups: (\w{4}) > (\w{4})", _groups),
    (r"    alarm \d+: .*", _alarm),
    (r"    message: (.*) > (.*)", _message),
    (r"    diagnosis \d+, axis (\d+), type (\d): .* > .*", _diagnosis),
    (r"    block (\d) group (\d+): (\S+) > (\S+)", _group),
    (r"    block (\d) word (\d+): (.+) > (.+)", _word),
    (r"    exebufstat: ([0-9a-f ]+) > ([0-9a-f ]+)", lambda *two: _buffers("ODBEXEC", "cnc_exebufstat", two)),
    (r"    finstate: ([0-9a-f ]+) > ([0-9a-f ]+)", lambda *two: _buffers("ODBFIN", "cnc_finstate", two)),
    (rf"    ([{LETTERS}])(\d+)(?:\.\.\d+)?: .*", lambda *place: _of_pmc("pmc_rdpmcrng", *place)),
    (r"    .*\bcurrent -?\d.*", lambda: iter(["cnc_rdcurrent"])),
    (r"    .*\bsrvspeed -?\d.*", lambda: iter(["cnc_rdsrvspeed"])),
    (r"    .*\bloopgain -?\d.*", lambda: iter(["cnc_rdloopgain"])),
    (r"    operation \d+: (\w+) (.*)", _operation),
    (r"    past alarm \d+: (.*)", _past_alarm),
    (r"((?:cnc|pmc)_\w+)\((.*?)\) (EW_\w+)(.*)", _call),
    (r"signal (\d+)( axis \d+)? <- (\d+) (EW_\w+), .*", lambda number, axis, *more: _signal(number, axis or "", *more)),
    (r"(incpoint|abspoint|refpoint|dwell|coordre) -?\d+ (-?\d+) [^\[]*\[(.*)\] (EW_\w+)(.*)", _command),
    (r"(\w+) <- (\d+) EW_OK", _panel_written),
    (rf"([{LETTERS}])(\d+) <- .* EW_OK.*", lambda *place: _of_pmc("pmc_wrpmcrng", *place)),
)  # fmt: skip
"""Lines of a scene, and what follows from each; several may fit one line."""


def rows_shown(text: str) -> set[str]:
    """Return what may be rows, without the system's name, of all that stands in a scene's text."""
    found: set[str] = set()
    for pattern, rows in RULES:
        for line in set(re.findall(rf"^{pattern}$", text, re.MULTILINE)):
            groups = line if isinstance(line, tuple) else (line,)
            found.update(rows(*groups[: re.compile(pattern).groups]))
    return found
