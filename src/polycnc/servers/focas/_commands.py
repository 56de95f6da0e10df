"""What each command reads or does, by its code; what a series does not know is answered with code 1.

What stands in requests and replies is in `wire.LAYOUTS`; commands of which no layout is known are not answered.
"""

from __future__ import annotations

from polycnc.controllers.fanuc.wire import CNC, PMC, Request
from polycnc.servers.focas import _data_commands as data
from polycnc.servers.focas import _program_commands as programs
from polycnc.servers.focas import _state_commands as state
from polycnc.servers.focas._command import Command
from polycnc.servers.focas._profile import Profile

COMMANDS: dict[tuple[int, int], Command] = {
    (CNC, 0x01): programs.start,
    (CNC, 0x03): programs.select,
    (CNC, 0x05): programs.delete,
    (CNC, 0x06): programs.directory,
    (CNC, 0x08): data.read_tool_offsets,
    (CNC, 0x09): data.write_tool_offset,
    (CNC, 0x0A): data.tool_offset_range,
    (CNC, 0x0B): data.read_work_offset,
    (CNC, 0x0C): data.write_work_offset,
    (CNC, 0x0E): data.parameters,
    (CNC, 0x10): data.parameter_types,
    (CNC, 0x15): data.read_macros,
    (CNC, 0x16): data.write_macros,
    (CNC, 0x17): data.macro_range,
    (CNC, 0x18): state.system,
    (CNC, 0x19): state.state,
    (CNC, 0x1A): state.alarm_bits,
    (CNC, 0x1B): state.figures,
    (CNC, 0x1C): programs.program_numbers,
    (CNC, 0x1D): programs.sequence_number,
    (CNC, 0x20): programs.executed_text,
    (CNC, 0x23): state.alarms,
    (CNC, 0x24): state.feed,
    (CNC, 0x25): state.spindle_speed,
    (CNC, 0x26): state.positions,
    (CNC, 0x29): data.settings,
    (CNC, 0x30): data.diagnosis,
    (CNC, 0x34): state.messages,
    (CNC, 0x40): state.spindle,
    (CNC, 0x45): state.clock,
    (CNC, 0x46): state.set_clock,
    (CNC, 0x48): data.no_tool_life,
    (CNC, 0x4A): data.no_tool_life,
    (CNC, 0x52): data.no_tool_life,
    (CNC, 0x56): state.servo_meter,
    (CNC, 0x5D): state.panel,
    (CNC, 0x89): state.axis_names,
    (CNC, 0x8A): state.spindle_names,
    (CNC, 0x8B): data.no_tool_life,
    (CNC, 0x8D): data.parameters,
    (CNC, 0x90): data.settings,
    (CNC, 0x93): data.diagnosis,
    (CNC, 0x96): state.modal_code,
    (CNC, 0x97): state.commanded,
    (CNC, 0x98): state.machining_type,
    (CNC, 0xA4): state.counts,
    (CNC, 0xA7): data.read_doubles,
    (CNC, 0xA8): data.write_double,
    (CNC, 0xAE): programs.drives,
    (CNC, 0xB0): programs.current_folder,
    (CNC, 0xB3): programs.folder,
    (CNC, 0xB4): programs.folder_counts,
    (CNC, 0xB5): programs.add,
    (CNC, 0xB6): programs.remove,
    (CNC, 0xB9): programs.main_path,
    (CNC, 0xBA): programs.select_main,
    (CNC, 0xCF): programs.program_name,
    (CNC, 0xE1): state.handle_retrace,
    (CNC, 0xF0): programs.lines,
    (CNC, 0xFC): programs.program_path,
    (CNC, 0x120): data.timer,
    (PMC, 0x8001): data.read_pmc,
    (PMC, 0x8002): data.write_pmc,
}
"""The commands that are answered, by target and code."""

WRITING = frozenset(
    {(CNC, code) for code in (0x01, 0x03, 0x05, 0x09, 0x0C, 0x16, 0x46, 0xA8, 0xB5, 0xB6, 0xBA)}
    | {(PMC, 0x8002)}
)
"""Those that change something."""

_NARROW = frozenset({0x0E, 0x10, 0x29, 0x30})
_WIDE = frozenset({0x8D, 0x90, 0x93})


def known(profile: Profile, request: Request) -> Command | None:
    """Return what answers a request, None where this series does not know it."""
    if request.command in profile.refused or request.command in (_NARROW if profile.wide_values else _WIDE):
        return None
    return COMMANDS.get((request.target, request.command))
