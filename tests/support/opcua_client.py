"""A client of o6, which is built on open62541: it reads, writes and subscribes; each answer is a line of JSON."""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import o6

CHANNEL = "ns=1;s=machine/CncChannelList/Channel1"


def say(name: str, value: Any) -> None:
    print(json.dumps([name, value]), flush=True)


def refused(write: Any) -> str:
    try:
        return str(write())
    except o6.StatusCodeError as error:
        return str(error)


def main(url: str) -> None:
    with o6.Client(url) as client:
        say("state", int(client.read(f"{CHANNEL}/ActStatus")))
        seen: list[float] = []
        client.monitor(f"{CHANNEL}/ActOverride", lambda value, *_: seen.append(value))
        say("write", refused(lambda: client.write(f"{CHANNEL}/CmdOverride", 63.0)))
        say("too much", refused(lambda: client.write(f"{CHANNEL}/CmdOverride", 630.0)))
        say("fixed", refused(lambda: client.write(f"{CHANNEL}/ActOverride", 63.0)))
        say("override", float(client.read(f"{CHANNEL}/ActOverride")))
        end = time.monotonic() + 60.0
        while not any("63" in str(each) for each in seen) and time.monotonic() < end:
            client.read(f"{CHANNEL}/Id")
        say("changed", any("63" in str(each) for each in seen))


if __name__ == "__main__":
    main(sys.argv[1])
