"""Run fuzz cases in a process of its own, so that what never returns can be ended and named.

``python -m support.fuzz_worker CAMPAIGN FIRST COUNT SECONDS [TARGET ...]`` prints one JSON line for each target with
what failed. Uncompiled, if NUMBA_DISABLE_JIT says so.
"""

from __future__ import annotations

import json
import sys
import time
import warnings
from collections.abc import Iterator

from support.fuzzing import Target, failures, seed_of


def _seeds(campaign: int, first: int, count: int, until_s: float) -> Iterator[int]:
    for number in range(first, first + count):
        if number > first and time.monotonic() > until_s:
            return
        yield seed_of(campaign, number)


def main() -> None:
    """Run the cases."""
    campaign, first, count, seconds = (int(each) for each in sys.argv[1:5])
    warnings.simplefilter("ignore")
    from support.fuzz_targets import BY_NAME, TARGETS

    chosen: list[Target] = [BY_NAME[name] for name in sys.argv[5:]] or list(TARGETS)
    share_s = seconds / sum(target.weight for target in chosen)
    for target in chosen:
        begun_s = time.monotonic()
        done = 0

        def counted(target: Target = target, begun_s: float = begun_s) -> Iterator[int]:
            nonlocal done
            for seed in _seeds(campaign, first, count, begun_s + share_s * target.weight):
                done += 1
                yield seed

        print(json.dumps({"target": target.name, "begins": True}), flush=True)
        failed = [each._asdict() for each in failures(target, counted())]
        print(json.dumps({"target": target.name, "cases": done, "failed": failed,
                          "seconds": round(time.monotonic() - begun_s, 1)}), flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
