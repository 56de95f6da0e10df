"""Open a port by the sender of bCNC, without its window, and send a program; each answer is a line of JSON."""

from __future__ import annotations

import builtins
import contextlib
import importlib
import io
import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any


def say(name: str, value: object) -> None:
    print(json.dumps([name, value]), file=sys.__stdout__, flush=True)


def until(holds: Callable[[], object]) -> None:
    end_s = time.monotonic() + 60
    while not holds():
        if time.monotonic() > end_s:
            print("bCNC never saw it", file=sys.stderr, flush=True)
            os._exit(1)
        time.sleep(0.02)


def main(port: str, program: list[str]) -> None:
    home = Path(str(importlib.import_module("bCNC").__file__)).parent
    sys.path[:0] = [str(home / each) for each in (".", "lib", "controllers", "plugins")]
    vars(builtins)["_"] = lambda text: text  # its translations
    utils: Any = importlib.import_module("Utils")
    utils.loadConfiguration()
    cnc: Any = importlib.import_module("CNC").CNC
    module: Any = importlib.import_module("Sender")
    sender = module.Sender()
    sender.disable = sender.enable = lambda: None  # what only its window has
    sender.open(port, 115200)
    until(lambda: cnc.vars["state"] == "Idle")
    sender.viewSettings()
    until(lambda: "grbl_110" in cnc.vars)
    say("fastest", cnc.vars["grbl_110"])
    sender.initRun()
    for line in program:
        sender.queue.put(f"{line}\n")
    sender._runLines = len(program)
    until(lambda: cnc.vars["state"] == "Run")
    sender.feedHold()
    until(lambda: cnc.vars["state"].startswith("Hold"))
    cnc.vars["_OvFeed"], cnc.vars["_OvChanged"] = 150, True
    sender.resume()
    until(lambda: cnc.vars["OvFeed"] == 150)
    say("override", cnc.vars["OvFeed"])
    until(lambda: sender._gcount >= len(program) and cnc.vars["state"] == "Idle")
    say("position", [cnc.vars[f"m{axis}"] for axis in "xyz"])
    errors = []
    while not sender.log.empty():
        kind, text = sender.log.get()
        if kind == module.Sender.MSG_ERROR:
            errors.append(text)
    say("errors", errors)
    os._exit(0)  # its thread listens on


if __name__ == "__main__":
    with contextlib.redirect_stdout(io.StringIO()):
        main(sys.argv[1], sys.argv[2].split("|"))
