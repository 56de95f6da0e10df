"""The reference page of the NCS coupling of the PNC, made from the tables of its services."""

from polycnc.controllers.bosch.ncs import DATA_SERVICES, OVERVIEW, PROCESS_SERVICES, NcsCode, Selection

_HEAD = """# NCS coupling of the PNC: MCODS and MCOPS

<!-- Written by scripts/reference. -->

CPL programs read data of channels by `MCODS(number,channel,version,buffer,size[,...])` and have channels do something
by `MCOPS(number,channel[,...])`. Both return an [answer](#answers). With the version that the last call left in its
variable, MCODS waits until the data are new: in each cycle (Z), with each block (S), when they change (E); those marked
I never wait, those marked R never change. The channel is -1 where data are those of the whole system; "either" takes
both. Data go into variables of their type or a wider one (INTEGER, REAL, DOUBLE), texts into dimensioned strings.

"""
_KINDS = {"I": "INTEGER", "R": "REAL", "D": "DOUBLE", "S": "text", "X": "as the data"}


def page() -> str:
    """Return the page."""
    parts = [_HEAD + "## Data: MCODS\n"]
    for heading, numbers in OVERVIEW.items():
        parts += [
            f"\n### {heading}\n\n",
            "| number | data | type | new | of |\n| --- | --- | --- | --- | --- |\n",
        ]
        for number in numbers:
            row = DATA_SERVICES[number]
            parts.append(f"| {number} | {row.name} | {_KINDS[row.kind]} | {row.refresh} | {row.scope} |\n")
    parts.append(
        "\n## Services: MCOPS\n\n| number | service | parameters after the channel |\n| --- | --- | --- |\n"
    )
    for service in PROCESS_SERVICES.values():
        kinds = ", ".join(
            f"{'text' if kind == 'S' else 'number'}{' (needed)' if default is None else ''}"
            for kind, default in service.parameters
        )
        parts.append(f"| {service.number} | {service.name} | {kinds} |\n")
    parts.append("\nTypes of a selection (MCOPS 4) add up: ")
    parts.append(
        ", ".join(f"{flag.value} {(flag.name or '').lower().replace('_', ' ')}" for flag in Selection) + ".\n"
    )
    parts.append("\n## Answers\n\n| answer | meaning |\n| --- | --- |\n")
    parts += [f"| {code.value} | {code.text} |\n" for code in NcsCode]
    return "".join(parts)
