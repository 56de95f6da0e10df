"""Numbers of MACODA parameters before and since software V5.1 (Manual 003, annex A.4)."""

from __future__ import annotations

_RENUMBERED = """
1001 00001 1003 00001
1001 00002 1003 00002
1001 00003 1001 00001
1001 00004 1003 00004
1001 00005 1003 00005
1001 00006 1050 00001
1001 00007 7010 00030
1001 01003 6020 00012
1010 00003 1010 00011
1010 00004 1010 00012
1010 00006 1010 00001
1010 00009 1010 00002
1015 00001 1015 00002
1015 00006 1015 00100
1015 00007 1015 00001
1030 00004 7030 00010
1030 00005 7030 00310
1030 00008 7030 00210
1030 00009 7030 00220
1030 00010 7030 00110
1030 00101 7040 00110
1030 00301 7050 00110
1030 00302 7050 00120
1030 00303 7050 00130
1030 00201 7020 00010
1030 00202 7010 00110
1040 00011 1050 00003
1040 00012 1050 00004
"""

NEW_NUMBERS: dict[str, str] = {line[:10]: line[11:] for line in _RENUMBERED.split("\n") if line}
"""The numbers since V5.1 of parameters by their old ones, written as "1015 00006"."""


def present_number(number: str) -> str:
    """Return the number since V5.1 of a parameter that a program for an older control names.

    Numbers that mean the same in both are returned as they are; 1001 00001 and 1015 00001 stand for other parameters
    since, so only the one who knows for which software a program was written can ask.
    """
    return NEW_NUMBERS.get(number, number)
