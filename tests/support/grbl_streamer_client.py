"""Open a port by the library grbl-streamer, and send a program; each answer is a line of JSON."""

from __future__ import annotations

import importlib
import json
import os
import sys
import time
from collections.abc import Callable
from typing import Any


def say(name: str, value: object) -> None:
    print(json.dumps([name, value]), flush=True)


def main(port: str, program: list[str]) -> None:
    seen: list[tuple[Any, ...]] = []

    def until(holds: Callable[[], object]) -> None:
        end_s = time.monotonic() + 60
        while not holds():
            if time.monotonic() > end_s:
                print(f"grbl-streamer never saw it: {seen[-20:]}", file=sys.stderr, flush=True)
                os._exit(1)
            time.sleep(0.02)

    def last(name: str) -> tuple[Any, ...]:
        return next((each[1:] for each in reversed(seen) if each[0] == name), ("",))

    module: Any = importlib.import_module("grbl_streamer")
    sender = module.GrblStreamer(lambda name, *values: seen.append((name, *values)))
    sender.setup_logging()
    sender.cnect(port, 115200)
    until(lambda: any(each[0] == "on_boot" for each in seen))
    sender.poll_start()
    sender.incremental_streaming = False
    for line in program:
        sender.write(line)
    sender.job_run()
    until(lambda: sender.streaming_complete and last("on_stateupdate")[0] == "Run")
    until(lambda: last("on_stateupdate")[0] == "Idle")
    say("position", last("on_stateupdate")[1])
    sender.job_new()
    sender.write("G1 X200 F100")
    sender.job_run()
    until(lambda: last("on_stateupdate")[0] == "Run")
    sender.hold()
    until(lambda: last("on_stateupdate")[0] == "Hold:0")
    sender.abort()
    until(lambda: last("on_stateupdate")[0] == "Idle")
    say("errors", [each for each in seen if each[0] in ("on_error", "on_alarm")])
    os._exit(0)  # its threads listen on


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2].split("|"))
