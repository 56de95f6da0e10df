"""The commands by code: the name of the library's function, its arguments, and the records in its data and replies.

Client, server, dissector and reference page read this table. `each` and `data_each` repeat to the end.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from polycnc.controllers.fanuc.wire._blocks import CNC, PMC, Request
from polycnc.controllers.fanuc.wire._records import record

Values: TypeAlias = Mapping[str, Any]
Rows: TypeAlias = Sequence[Any]
"""Records that repeat: mappings by name, or plain values where a record has one field."""
Content: TypeAlias = Values | Rows | tuple[Values, Rows] | None
"""What a payload holds: the head, what repeats, or both."""


@dataclass(frozen=True, slots=True)
class Layout:
    """What is known of one command."""

    function: str
    arguments: str = ""
    head: str = ""
    each: str = ""
    data: str = ""
    data_each: str = ""

    def pack(self, content: Content) -> bytes:
        """Return the payload of a reply."""
        return _packed(self.head, self.each, content)

    def unpack(self, payload: bytes) -> tuple[dict[str, Any], list[dict[str, Any]]]:
        """Return what a reply holds: its head, and what repeats.

        Raises:
            ProtocolError: It holds something else.
        """
        return _unpacked(self.head, self.each, payload)

    def pack_data(self, content: Content) -> bytes:
        """Return the data of a request."""
        return _packed(self.data, self.data_each, content)

    def unpack_data(self, data: bytes) -> tuple[dict[str, Any], list[dict[str, Any]]]:
        """Return what the data of a request hold.

        Raises:
            ProtocolError: They hold something else.
        """
        return _unpacked(self.data, self.data_each, data)


def _packed(head: str, each: str, content: Content) -> bytes:
    if isinstance(content, Mapping):
        return record(head).pack(content)
    values, rows = content if isinstance(content, tuple) else (None, content)
    first = record(head).pack(values) if values is not None else b""
    return first + record(each).pack_all(rows) if rows else first


def _unpacked(head: str, each: str, data: bytes) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    first = record(head).unpack(data)
    at, rows = record(head).size, []
    size = record(each).size
    while each and at is not None and at < len(data):
        rows.append(record(each).unpack(data, at))
        at = None if size is None else at + size
    return first, rows


def layout_of(request: Request) -> Layout:
    """Return what is known of a request's command.

    Raises:
        KeyError: Nothing is.
    """
    return LAYOUTS[request.target, request.command]


_TOOL_LIFE = "cnc_rdngrp"
_RECORD4, _RECORD8 = "number:I axis:h type:h values:4*", "number:I axis:h type:h values:8*"
# fmt: off
LAYOUTS: dict[tuple[int, int], Layout] = {
    (CNC, 0x01): Layout("cnc_start"),
    (CNC, 0x03): Layout("cnc_search", "program"),
    (CNC, 0x05): Layout("cnc_delete", "program"),
    (CNC, 0x06): Layout("cnc_rdprogdir3", "first most kind", "", "program:I size:I comment:s64"),
    (CNC, 0x08): Layout("cnc_rdtofs", "first last type", "", "offset:8"),
    (CNC, 0x09): Layout("cnc_wrtofs", "first last type", data="increments:i base:H exponent:h"),
    (CNC, 0x0A): Layout("cnc_rdtofsinfo", "", "unknown:?2 offsets:H memory:H unknown:?2"),
    (CNC, 0x0B): Layout("cnc_rdzofs", "first last axis", "", "offset:8"),
    (CNC, 0x0C): Layout("cnc_wrzofs", "first last axis", data_each="increments:i base:H exponent:h"),
    (CNC, 0x0E): Layout("cnc_rdparam (old series)", "first last axis", "", _RECORD4),
    (CNC, 0x10): Layout("cnc_rdparainfo (old series)", "first count", "before:i behind:i", "number:i type:i"),
    (CNC, 0x15): Layout("cnc_rdmacro", "first last", "", "value:8"),
    (CNC, 0x16): Layout("cnc_wrmacro", "first last", data_each="value:8"),
    (CNC, 0x17): Layout("cnc_rdmacroinfo", "", "locals:i commons:i"),
    (CNC, 0x18): Layout("cnc_sysinfo", "", "addinfo:H max_axis:H cnc_type:s2 mt_type:s2 series:s4 version:s4 axes:s2"),
    (CNC, 0x19): Layout("cnc_statinfo", "", "aut:H run:H motion:H mstb:H emergency:H alarm:H edit:H"),
    (CNC, 0x1A): Layout("cnc_alarm2", "", "alarms:I"),
    (CNC, 0x1B): Layout("cnc_getfigure", "kind", "count:i", "input_decimals:H output_decimals:H"),
    (CNC, 0x1C): Layout("cnc_rdprgnum", "", "running:i main:i"),
    (CNC, 0x1D): Layout("cnc_rdseqnum", "", "sequence:i"),
    (CNC, 0x1F): Layout("cnc_rewind", "", "unknown:*"),
    (CNC, 0x20): Layout("cnc_rdexecprog", "most", "block:i text:s*"),
    (CNC, 0x21): Layout("cnc_modal ?", "", "unknown:*"),
    (CNC, 0x22): Layout("cnc_toolnum ?", "", "unknown:*"),
    (CNC, 0x23): Layout("cnc_rdalmmsg2", "type most mode size", "", "number:i type:i axis:i length:i text:s-"),
    (CNC, 0x24): Layout("cnc_actf", "", "feed:8"),
    (CNC, 0x25): Layout("cnc_acts", "", "rpm:8"),
    (CNC, 0x26): Layout("cnc_rdposition", "kind axis", "", "position:8"),
    (CNC, 0x29): Layout("cnc_rdset (old series)", "first last axis", "", _RECORD4),
    (CNC, 0x30): Layout("cnc_diagnoss (old series)", "first last axis", "", _RECORD4),
    (CNC, 0x34): Layout("cnc_rdopmsg3", "type", "", "number:i type:i length:i text:s256"),
    (CNC, 0x35): Layout("cnc_rdblkcount", "", "blocks:i"),
    (CNC, 0x40): Layout("cnc_rdspmeter, cnc_rdspmaxrpm, cnc_rdspgear", "kind spindle", "", "value:8"),
    (CNC, 0x45): Layout("cnc_gettimer", "half", "year:H month:H day:H hour:H minute:H second:H"),
    (CNC, 0x46): Layout("cnc_settimer", "half", data="year:H month:H day:H hour:H minute:H second:H"),
    (CNC, 0x48): Layout("cnc_rdtlusegrp", "", "unknown:?4 group:i"),
    (CNC, 0x4A): Layout(_TOOL_LIFE, "", "groups:i"),
    (CNC, 0x52): Layout("cnc_clrcntinfo", "first last"),
    (CNC, 0x56): Layout("cnc_rdsvmeter", "kind", "", "load:8"),
    (CNC, 0x57): Layout("cnc_rdopmode", "", "unknown:*"),
    (CNC, 0x5D): Layout("cnc_rdopnlsgnl", "mask", "mode:H handle_axis:H handle_step:H rapid_override:H jog_override:H "
                        "feed_override:H spindle_override:H block_delete:H single_block:H machine_lock:H dry_run:H "
                        "protect:H feed_hold:H"),
    (CNC, 0x61): Layout("cnc_rdopnlgsname ?", "", "unknown:*"),
    (CNC, 0x63): Layout("cnc_rdwkcdshft", "axis", "unknown:*"),
    (CNC, 0x88): Layout("context of cnc_rdposition and cnc_rdspeed", "kind", "unknown:*"),
    (CNC, 0x89): Layout("cnc_rdaxisname", "", "", "name:s1 suffix:s1 unknown:?2"),
    (CNC, 0x8A): Layout("cnc_rdspdlname", "", "", "name:s1 suffix:s3"),
    (CNC, 0x8B): Layout("cnc_rdlife", "group", "unknown:?2 group:H unknown:?8 life:i unknown:?4 used:i unknown:*"),
    (CNC, 0x8C): Layout("count of all axes", "", "unknown:?2 axes:H"),
    (CNC, 0x8D): Layout("cnc_rdparam", "first last axis", "", _RECORD8),
    (CNC, 0x8E): Layout("cnc_wrparam", "first last axis", data="unknown:*"),
    (CNC, 0x90): Layout("cnc_rdset", "first last axis", "", _RECORD8),
    (CNC, 0x93): Layout("cnc_diagnoss", "first last axis", "", _RECORD8),
    (CNC, 0x96): Layout("cnc_rdgcode", "group block", "", "group:H unknown:?4 code:H unknown:?2 tenths:H"),
    (CNC, 0x97): Layout("cnc_rdcommand", "address block", "", "letter:s1 which:B flag:H value:i decimals:i"),
    (CNC, 0x98): Layout("cnc_statinfo: T or M side", "", "tmmode:H"),
    (CNC, 0xA0): Layout("cnc_rdparainfo3", "number count", "before:i behind:i", "number:i size:h array:h unit:h "
                        "dimension:h input:h display:h others:h unknown:?2"),
    (CNC, 0xA2): Layout("cnc_rddiaginfo", "number count", "before:i behind:i", "number:i size:h array:h unit:h "
                        "dimension:h input:h display:h others:h unknown:?2"),
    (CNC, 0xA3): Layout("context of cnc_rdposition", "kind axis", "unknown:*"),
    (CNC, 0xA4): Layout("count of axes or spindles", "kind", "count:H"),
    (CNC, 0xA7): Layout("cnc_rdmacror2", "first count", "", "value:d"),
    (CNC, 0xA8): Layout("cnc_wrmacror2", "first count", data_each="value:d"),
    (CNC, 0xAE): Layout("cnc_rdpdf_drive", "", "", "drive:s12"),
    (CNC, 0xB0): Layout("cnc_rdpdf_curdir", "ground", "folder:s*"),
    (CNC, 0xB3): Layout("cnc_rdpdf_alldir", "first most type sizes", "", "kind:h year:H month:H day:H hour:H minute:H "
                        "second:H unknown:?6 size:I attributes:I name:s36 comment:s52 unknown:?12", "folder:s256"),
    (CNC, 0xB4): Layout("cnc_rdpdf_subdirn", "", "folders:i files:i", data="folder:s256"),
    (CNC, 0xB5): Layout("cnc_pdf_add", "kind", data="path:s256"),
    (CNC, 0xB6): Layout("cnc_pdf_del", "", data="path:s256"),
    (CNC, 0xB9): Layout("cnc_pdf_rdmain", "", "path:s*"),
    (CNC, 0xBA): Layout("cnc_pdf_slctmain", "", data="path:s256"),
    (CNC, 0xCF): Layout("cnc_exeprgname", "", "program:i name:s36"),
    (CNC, 0xE1): Layout("cnc_statinfo: handle retrace", "", "hdck:*"),
    (CNC, 0xF0): Layout("cnc_rdpdf_line", "first count", "text:s*", data="path:s256"),
    (CNC, 0xFC): Layout("cnc_exeprgname2", "", "path:s*"),
    (CNC, 0xFD): Layout("cnc_loadtorq", "motor axis", "unknown:?4"),
    (CNC, 0x120): Layout("cnc_rdtimer", "timer", "minutes:<i milliseconds:<i"),  # seen on two series
    (PMC, 0x8001): Layout("pmc_rdpmcrng", "first last area type", "values:*"),
    (PMC, 0x8002): Layout("pmc_wrpmcrng", "first last area type", data="values:*"),
    (PMC, 0x8003): Layout("pmc_rdpmcinfo", "", "unknown:*"),
}
# fmt: on
AREAS = "GFYXARTKCD"
"""Letters of PMC areas by their numbers."""
PMC_WIDTHS = (1, 2, 4)
"""Bytes of a value of the PMC, by its type."""
POSITION_KINDS = {
    0: "absolute", 1: "machine", 2: "relative", 3: "distance", 4: "absolute", 6: "relative", 7: "distance", 8: "skip",
    9: "servo_delay", 10: "acceleration_delay",
}  # fmt: skip
"""What is read as a position, by its kind; a client asks for the last kind of a name."""
