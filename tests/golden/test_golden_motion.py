"""Small motions of the kernel, cycle by cycle, as transcripts that a person can read and check.

`motion/*.txt`: what follows `>` is done, what follows it is what it came to. A row is the cycle, the setpoints of X, Y
and Z, the path speed, the actual positions where a servo is at work, the tag of the segment, and what was reported.
After a wanted change: `pytest tests/golden --update-goldens`, and read the difference.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from support.motion_script import Player

TRANSCRIPTS = sorted((Path(__file__).parent / "motion").glob("*.txt"))
LAST_DIGIT = 1.5e-6


def played(transcript: str) -> str:
    player, lines = Player(), []
    for line in transcript.splitlines():
        if line.startswith("#") or not line:
            lines.append(line)
        elif line.startswith("> "):
            lines += [line, *player.play(line[2:])]
    return "\n".join([*lines, ""])


def same(one: str, other: str) -> bool:
    """Tell whether two lines are equal, numbers within their last digit."""
    words, others = one.split(), other.split()
    if len(words) != len(others):
        return False
    for left, right in zip(words, others, strict=True):
        if left != right and not ("." in left and abs(float(left) - float(right)) <= LAST_DIGIT):
            return False
    return True


@pytest.mark.parametrize("path", TRANSCRIPTS, ids=lambda path: path.stem)
def test_motion(path: Path, request: pytest.FixtureRequest) -> None:
    wanted = path.read_text(encoding="utf-8")
    found = played(wanted)
    if request.config.getoption("update_goldens"):
        path.write_text(found, encoding="utf-8")
        return
    for line, (is_found, is_wanted) in enumerate(
        zip(found.splitlines(), wanted.splitlines(), strict=False), 1
    ):
        assert same(is_found, is_wanted), f"line {line}: {is_found}"
    assert len(found.splitlines()) == len(wanted.splitlines())
