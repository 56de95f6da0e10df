"""What the services of a living control tell in every state, written down in `tests/golden/cpl_b/NAME.txt`.

The numbers themselves are asserted from the manual elsewhere; here nothing can change unseen, on any axis, in either
channel, whoever asks. After a wanted change: `--update-goldens`, and read the difference.
"""

from __future__ import annotations

from fnmatch import fnmatchcase
from itertools import zip_longest
from pathlib import Path

import pytest

from polycnc.conformance import State, load_conformance
from support import cpl_scenes_b_data, cpl_scenes_b_more, cpl_scenes_b_screen, cpl_scenes_b_states
from support.cpl_scenes_b import REFERENCES, SCENES, Bench

RECORDED = Path(__file__).parents[1] / "golden" / "cpl_b"
assert cpl_scenes_b_data, cpl_scenes_b_screen and cpl_scenes_b_states and cpl_scenes_b_more
CONFORMANCE = load_conformance()
SHOWN = {
    name: patterns.split()
    for name, _, patterns in (
        each.partition(":") for each in (RECORDED / "rows.txt").read_text().replace("\n  ", " ").splitlines()
    )
}
"""The rows of each scene, as patterns of their names; and what patterns match and only scenes show that name it."""


def rows_of(name: str) -> list[str]:
    """Return the rows that a scene shows."""
    found = []
    for row in CONFORMANCE.rows("cpl"):
        short = row.id.removeprefix("cpl.")
        if CONFORMANCE.state(row.id) is State.NOT_APPLICABLE:
            continue
        if short in SHOWN["unseen"] and short not in SHOWN[name]:
            continue
        if any(fnmatchcase(short, pattern) for pattern in SHOWN[name]):
            found.append(row.id)
    return found


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.covers(*rows_of(name))) for name in SCENES]
)
def test_a_control_tells_what_is_written_down(
    name: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    bench = Bench(tmp_path, references=name in REFERENCES)
    try:
        SCENES[name](bench)
    except Exception:
        print("\n".join(bench.lines))
        raise
    finally:
        bench.pnc.close()
    file, found = RECORDED / f"{name}.txt", "\n".join([f"# {SCENES[name].__doc__}", *bench.lines, ""])
    if request.config.getoption("update_goldens"):
        file.write_text(found, encoding="utf-8")
    pairs = zip_longest(found.splitlines(), file.read_text(encoding="utf-8").splitlines())
    assert not [f"found {one!r}, written {other!r}" for one, other in pairs if one != other][:9]
