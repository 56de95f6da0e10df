"""Ask an MTConnect agent once a second; print a line for each machine whose state, program or parts have changed."""

from __future__ import annotations

import sys
import time
from urllib.request import urlopen
from xml.etree import ElementTree

COLUMNS = {"Execution": "execution", "Program": "program", "PartCount": "parts"}


def states(url: str) -> dict[str, tuple[str, ...]]:
    """Return what each machine does now, in the order of the columns."""
    with urlopen(f"{url}/current", timeout=10) as answer:
        root = ElementTree.parse(answer).getroot()
    found = {}
    for device in root.findall(".//{*}DeviceStream"):
        values = {
            each.tag.rpartition("}")[2]: each.text or "" for each in device.iter() if each.get("dataItemId")
        }
        found[device.get("name", "")] = tuple(values.get(name, "") for name in COLUMNS)
    return found


def collect(url: str, rounds: int, every_s: float = 1.0) -> None:
    """Ask so many times; -1 for without end."""
    print("machine", *COLUMNS.values(), sep=",")
    before: dict[str, tuple[str, ...]] = {}
    while rounds:
        now = states(url)
        for machine, values in now.items():
            if before.get(machine) != values:
                print(machine, *values, sep=",")
        before, rounds = now, rounds - 1
        if rounds:
            time.sleep(every_s)


if __name__ == "__main__":
    collect(sys.argv[1], -1)
