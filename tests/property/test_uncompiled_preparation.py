"""Programs are prepared the same with compiled and with plain Python code, bit for bit."""

from __future__ import annotations

import hashlib
import os
import random
import subprocess
import sys
from pathlib import Path

from support.programs import FIVE, channel_state, prepare, queue_bytes

PRINT_DIGEST = "from property.test_uncompiled_preparation import digest; print(digest())"


def random_program(seed: int) -> str:
    """Return a program of moves in all the ways that the compiled kernel takes."""
    rng = random.Random(seed)

    def at() -> str:
        return f"{rng.uniform(-40.0, 40.0):.3f}"

    def block() -> str:
        half = rng.randint(1, 20)
        return rng.choice(
            [
                f"G1 X{at()} Y{at()} A{at()}",
                f"G0 C{at()} Z{at()}",
                f"G91 G2 X{2 * half} I{half} Z1\nG90 Z0",
                f"G3 X{at()} Y{at()} R{rng.randint(60, 90)}",
                f"G2 J{at()}\nF{rng.randint(1, 900)}",
                rng.choice(["G20", "G21", "G55", "G54", "G64 P.1", "G64", "G61", "M8", "G17"]),
            ]
        )

    return "F500 G1\n" + "".join(f"{block()}\n" for _ in range(100))


def digest() -> str:
    """Return a digest of what some programs put into the queue, and of the state after them."""
    found = hashlib.sha256()
    for seed in range(4):
        channel = prepare(random_program(seed), config=FIVE, collect_errors=True)
        for column in queue_bytes(channel):
            found.update(column)
        found.update(repr(channel_state(channel)).encode())
    return found.hexdigest()


def test_compiled_and_uncompiled_preparation_are_the_same_to_the_last_bit() -> None:
    folders = [str(Path(__file__).parents[1]), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = dict(os.environ, NUMBA_DISABLE_JIT="1", PYTHONPATH=os.pathsep.join(folders))
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", PRINT_DIGEST],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == digest()
