"""Twenty served machines whose programs all wait: every door answers at once, and SIGTERM ends the process."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from support.command import slow_s
from support.focas_line import Line, free_port, serve

MACHINES = 20
MEDIAN_S, END_S = 0.25, 10.0  # 0.01 s and 0.1 s on a computer of its own; they never answered, nor ended
PROGRAMS = {
    "a signal": "O0001\nWHILE[#1000EQ0]DO1\nEND1\nM30\n",
    "functions": "O0001\nWHILE[1EQ1]DO1\nM50\nEND1\nM30\n",
}


@pytest.mark.parametrize("kind", PROGRAMS)
def test_machines_that_wait_answer_and_end(kind: str, tmp_path: Path) -> None:
    program = tmp_path / "wait.nc"
    program.write_text(PROGRAMS[kind])
    process, port = serve(
        "--count",
        str(MACHINES),
        "--program",
        program,
        port=free_port(),
    )
    lines: list[Line] = []
    try:
        lines += [Line(port, address=f"127.0.0.{k}") for k in range(1, MACHINES + 1)]
        took_s = []
        for _ in range(2):
            for line in lines:
                begun_s = time.perf_counter()
                assert line.payload(0x19)
                took_s.append(time.perf_counter() - begun_s)
        took_s.sort()
    finally:
        for line in lines:
            line.close()
        begun_s = time.perf_counter()
        process.terminate()
        _, error = process.communicate(timeout=60)
    ended_s, slow = time.perf_counter() - begun_s, slow_s()  # other tests run beside
    assert ended_s < END_S + 25 * slow
    assert "Traceback" not in error
    assert took_s[len(took_s) // 2] < MEDIAN_S + 5 * slow
