"""What each command reads or does; what a series does not know is answered with code 1.

What stands in requests and replies is in `wire.LAYOUTS`; commands of which no layout is known are not answered.
"""

from __future__ import annotations

from polycnc.controllers.fanuc.wire import Request
from polycnc.servers.focas import _data_commands, _program_commands, _state_commands  # noqa: F401  they fill the table
from polycnc.servers.focas._command import COMMANDS, WRITING, Command
from polycnc.servers.focas._profile import Profile

_NARROW = frozenset({0x0E, 0x10, 0x29, 0x30})
_WIDE = frozenset({0x8D, 0x90, 0x93, 0xA0, 0xA2})


def known(profile: Profile, request: Request) -> Command | None:
    """Return what answers a request, None where this series does not know it."""
    if request.command in profile.refused or request.command in (_NARROW if profile.wide_values else _WIDE):
        return None
    return COMMANDS.get((request.target, request.command))


__all__ = ["COMMANDS", "WRITING", "known"]
