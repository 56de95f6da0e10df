# ruff: noqa: E501
"""The reference page of the FOCAS server, made from its tables: sessions, commands, series, faults."""

from polycnc.controllers.fanuc.wire import LAYOUTS, PMC, Request
from polycnc.servers.focas import COMMANDS, PROFILES, TRANSITIONS, WRITING, State, load_profile
from polycnc.servers.focas import known as known_command

_HEAD = """# The FOCAS protocol as it is served

<!-- Written by scripts/reference. -->

Software reads FANUC controls over TCP, on port 8193, by a protocol without a public description. This page says what
`polycnc serve --fanuc` answers. It stands on bytes that were seen on controls and on what clients of others send and read;
what nobody is known to know is not answered with guesses, but with code 1, as a control answers that has not got a function.

## Frames

Everything is big-endian, timers excepted. A frame is `a0 a0 a0 a0`, a version (clients: 1; controls: 2 to 5, see the
series), a type, the length of the body, the body. Commands travel in blocks: length, target (1 CNC, 2 PMC), path, command,
four numbers, a tag and the length of data that follow. Each block is answered by one in the same order: length, target,
path and command again, a status, two details, the length of the payload, the payload. A block that fails leaves the others
valid. What does not fit the largest frame of the series (1,450, 2,910 or 3,470 bytes) is answered with code 2.

A number of eight bytes is a mantissa, a base (10 or 2) and an exponent: mantissa / base ^ exponent. `00000000 ffffffff` is
a value that is not set.

## Sessions

The first frame opens a session and says what the connection is for: programs (1) or commands (2). A frame that a state does
not have resets the connection, and only that one. The reply to UPLOAD_START leaves alone, the program in frames of its own later:
20 ms after it the first, every 5 ms another.

"""
_COMPARED = """
## What was compared

Read, and held to each other; bytes of captures are in the tests.

| source | what it shows | how it is held here |
| --- | --- | --- |
| pyfocas 0.1.1 (PyPI) | a client of identity, state and macro variables | it reads and writes every series over a real socket |
| diohpix/pyfanuc: `pyfanuc.py` | a client of 20 commands, program upload, folders | sizes and layouts of its requests and replies |
| diohpix/pyfanuc: `sample_multipacket.md` | a 31i with four axes: counts, names, servo loads in one frame | the same request; each block's length, head and unused places |
| diohpix/pyfanuc: `sample_with_error.md` | a 160i: nine blocks, two of them refused | the same request; each block's length |
| diohpix/pyfanuc: `compare_read_diag.md` | diagnosis records of a 160i and a 31i | records of both forms, byte for byte |
| dooooling/mesa: fixture tests | which requests the maker's library sends for identity and state (40 and 96 bytes) | the request of three blocks in the golden files |
| huienming/nclink-c: `focas_values.c` | numbers of eight bytes, vacant variables, codes of transfers | numbers, vacancy, status of a finished download |

The maker's own library was never run against this server, and no control was at hand. Where sources contradict each other
the one that shows captured bytes was followed.

## What clients ask, and what is answered

| client | call | answer | source |
| --- | --- | --- | --- |
| all | a command that the series does not know | 1 (EW_FUNC) | diohpix/pyfanuc, `sample_with_error.md`: a 160i |
| all | another path than the first | 11 (EW_PATH) | Manual 000, return values |
| all | a range whose end is before its begin, or with a number that is not there | 3 (EW_NUMBER) | Manual 000, return values |
| all | a range that no frame of the series holds | 2 (EW_LENGTH) | Manual 000, return values; sizes of frames as the maker's library takes them |
| Ladder99, mtconnect | `cnc_rdalmmsg2` of a type beyond the last group (15, on 0i-D and 31i 19), or another form of text than 0 to 2 | 4 (EW_ATTRIB) | Manual 000, return values; groups as public headers name them |
| Ladder99, mtconnect, Hsl | `cnc_rdsvmeter` of kind 1 | load of each axis in percent | diohpix/pyfanuc, `sample_multipacket.md` |
| `cnc_rdaxisdata` of amperes | `cnc_rdsvmeter` of kinds 0, 2 and 3 (3: amperes, which this control does not know) | 1 (EW_FUNC) | none |
| | `cnc_rdsvmeter` of any other kind | 4 (EW_ATTRIB) | Manual 000, return values |
| Ladder99, node-red-contrib-fanuc-focas | `cnc_rdtimer` 0 to 4 | power on, operating, cutting, cycle, external signal (6755, 6756); others 3 (EW_NUMBER) | requests of collectors to controls |
| Ladder99 | `cnc_rdblkcount` | blocks executed since the program began, of those that move, dwell or have functions | layout as clients read it; what counts: none |
| Ladder99 | `cnc_rdparainfo3`, `cnc_rddiaginfo` | number, bytes of a value (0: bits), 0 one value, 3 one for each axis, 4 for each spindle, type word; nothing else is known | layout as clients read it; values: none |
| Ladder99 | `cnc_diagnoss` 308, 309, 403 | 25 degrees Celsius: motors have no temperature here | numbers as public manuals of the series name them; value: none |
| Ladder99 | `cnc_diagnoss` 410, 411 | load (%) and speed of the spindle | as above; the load is that of `cnc_rdspmeter` |
| Ladder99 | `cnc_diagnoss` 400, 408, 418, 425, 710, 712 | 0: no serial spindle, no errors, no lag | as above; value: none |
| Ladder99 | `cnc_diagnoss` 417, 445, 1520, 1521, 4901, 4902 | 3 (EW_NUMBER): no position coder, revolutions and power are not counted | none |
| Ladder99 | `cnc_rdparam` 3281 (language of the display) | 0, English, or what was written | numbers as public manuals of the series name them |
| pyfanuc, Hsl | `cnc_rdmacro` of #4001 to #4022 as one range | the codes of each group, 0 for groups without codes | requests of collectors to controls |
| Hsl | `cnc_wrmacro` of tool offsets (#2001, #10001 on) and work offsets (#5201, #7001 on) | they are set, within their range (else 5, EW_DATA) | macros of the series write them |
| | `cnc_wrmacro` of other system variables | 3 (EW_NUMBER) | none |

What is this control's own and not proven by anybody: the flags of commanded words (those of `cnc_modal`), the type of the
tool offset memory, and sizes of the reply that accepts a session on old series.
"""


def _diagram() -> str:
    arrows = [
        f"    {row.state.name} --> {row.next.name}: {row.frame.name}{' for commands' if row.frame.name == 'OPEN' else ''}"
        for row in TRANSITIONS
    ]
    lines = ["```mermaid", "stateDiagram-v2", "    [*] --> NEW", *arrows]
    lines += ["    NEW --> TRANSFER: OPEN for programs", "    ENDED --> [*]", "```", ""]
    names = [f"- `{state.name}`: {state.value}" for state in State]
    return "\n".join([*lines, *names, ""])


def _series() -> str:
    lines = [
        "\n## Series\n",
        "| profile | version | identity | axes there is room for | values | does not know |",
        "| --- | ---: | --- | ---: | --- | --- |",
    ]
    for name in PROFILES:
        profile = load_profile(name)
        identity = (
            f"{profile.cnc_type.strip()} {profile.machine_type.strip()} {profile.series} {profile.software}"
        )
        width = "8 bytes" if profile.wide_values else "4 bytes"
        refused = ", ".join(f"0x{code:02X}" for code in profile.refused)
        lines.append(
            f"| `{name}` | {profile.frame_version} | {identity} | {profile.most_axes} | {width} | {refused} |"
        )
    return "\n".join(lines) + "\n"


def _commands() -> str:
    lines = [
        "\n## Commands\n",
        "Fields are `name:code`: codes of Python's `struct`, `8` a number of eight bytes, `sN` a text, `?N` bytes of which "
        "nothing is known, `4*` and `8*` one value for each axis that the series has room for. *each* repeats. "
        "**W**: changes something. A command without series is known by name only and answered with code 1.\n",
        "| code | function | arguments | data | reply | each | series |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for (target, code), layout in LAYOUTS.items():
        series = [
            name
            for name in PROFILES
            if known_command(load_profile(name), Request(code, target=target)) is not None
        ]
        shown = "all" if len(series) == len(PROFILES) else ", ".join(series)
        mark = " **W**" if (target, code) in WRITING else ""
        where = "PMC " if target == PMC else ""
        data = layout.data or layout.data_each
        cells = [layout.arguments, data, layout.head, layout.each]
        quoted = " | ".join(f"`{cell}`" if cell else "" for cell in cells)
        lines.append(f"| {where}0x{code:02X} | {layout.function}{mark} | {quoted} | {shown} |")
    assert set(COMMANDS) <= set(LAYOUTS)
    return "\n".join(lines) + "\n"


def page() -> str:
    """Return the page."""
    return _HEAD + _diagram() + _series() + _commands() + _COMPARED
