"""Follow one block through the code, for docs/explanation/life-of-a-block.md.

The page is prose with fenced blocks that have a title; the blocks named here are replaced by what the code
computes. Where a number follows from a formula, the formula is worked out here too and must agree.
"""

import math
import re
import tempfile
from pathlib import Path

import numpy as np

from polycnc.kernel import PATH_RESTED, advance, give_to_path, prepare_path, start_path
from polycnc.kernel._path import LENGTH, SPEED_IN, SPEED_OUT, SPEED_PEAK, TIME_CRUISE, TIME_IN, TIME_OUT
from polycnc.machine import Machine, load_machine
from polycnc.nc import Channel, ChannelOptions, ProgramText, dialect_for
from polycnc.nc.modal._modal import ABSOLUTE, FEED, MOTION
from polycnc.nc.text._scan import scan, scan_rules, word_columns
from polycnc.runner import TraceWriter

PAGE = Path(__file__).resolve().parents[1] / "docs" / "explanation" / "life-of-a-block.md"
PROGRAM = "G1 X20 Y5 F600\nG1 X20 Y25\n"
_FENCE = re.compile(r'^```text title="([^"]+)"\n.*?^```$', re.MULTILINE | re.DOTALL)
_KEPT_CYCLES = 4096
_AT_CORNER = range(2061, 2068)


def page() -> str:
    """Return the page with all its numbers computed anew."""
    found = stations()

    def fenced(match: re.Match[str]) -> str:
        return f'```text title="{match[1]}"\n{found.pop(match[1])}\n```'

    text = _FENCE.sub(fenced, PAGE.read_text(encoding="utf-8"))
    assert not found, f"the page does not show: {', '.join(found)}"
    return text


def stations() -> dict[str, str]:
    """Run the program station by station; return what there is to see at each."""
    text = _program()
    config = load_machine("mill3")
    machine = Machine(config, record_cycles=_KEPT_CYCLES)
    channel = Channel(text, dialect_for(text), machine, options=ChannelOptions(ordinary_blocks=0))
    found = {"word columns": _words(channel)}
    before = _modal(channel)
    channel.fill()
    found["modal state"] = _table([("", "before", "after both blocks"), *_beside(before, _modal(channel))])
    state = machine.state
    found["segment"] = _segments(state.seg, ("length", "feed_mm_s", "tag", "flags"), corners=True)
    give_to_path(state, 0)
    start_path(state.paths, 0)
    state.paths.row[0]["closed"] = True  # nothing follows
    prepare_path(state.seg, state.paths, 0, state.limits, config.cycle_s, state.work)
    found["limits and junction"] = _segments(
        state.seg, ("cap", "full_accel", "accel", "junction", "yield_before", "gain", "out")
    )
    found["by hand"] = _by_hand(state, config.cycle_s)
    advance(state, 1)
    found["ramps"] = _ramps(state.paths.ramps[0])
    state.clock[0]["mask"] = PATH_RESTED
    advance(state, _KEPT_CYCLES - 1)
    rows = state.recorder.rows[: state.recorder.filled[0]]
    found["first setpoints"] = _setpoints(rows, range(1, 6))
    found["setpoints at the corner"] = _setpoints(rows, _AT_CORNER)
    found["trace"] = _trace(config, rows)
    return found


def _program() -> ProgramText:
    return ProgramText.from_text(PROGRAM, "part.nc")


def _table(rows: list[tuple[str, ...]]) -> str:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = (
        "  ".join([row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))])
        for row in rows
    )
    return "\n".join(line.rstrip() for line in lines)


def _number(value: float) -> str:
    return f"{value:.9g}"


def _words(channel: Channel) -> str:
    words = word_columns(2, 8)
    scan(_program().data, 0, 1, scan_rules(channel.dialect.text), words)
    n = words.n_words
    header = ("", *(f"[{i}]" for i in range(n)))
    return (
        _table(
            [
                header,
                ("letter", *(chr(letter) for letter in words.letter[:n])),
                ("value", *(_number(value) for value in words.value[:n])),
                ("place", *(str(place) for place in words.place[:n])),
            ]
        )
        + "\n\n"
        + _table(
            [
                ("", "[0]", "[1]", "[2]"),
                ("first_word", *(str(word) for word in words.first_word[:3])),
                ("line", *(str(line) for line in words.line[:2]), ""),
                ("flags", *(str(flag) for flag in words.flags[:2]), ""),
            ]
        )
    )


def _modal(channel: Channel) -> list[tuple[str, str]]:
    modal = channel.state.modal
    return [
        ("MOTION", str(modal.whole[MOTION])),
        ("ABSOLUTE", str(modal.whole[ABSOLUTE])),
        ("FEED", _number(modal.real[FEED])),
        *((f"position {name}", _number(at)) for name, at in zip("XYZ", modal.position, strict=True)),
    ]


def _beside(first: list[tuple[str, str]], second: list[tuple[str, str]]) -> list[tuple[str, ...]]:
    return [(name, a, b) for (name, a), (_, b) in zip(first, second, strict=True)]


def _segments(seg, names, corners=False) -> str:  # type: ignore[no-untyped-def]
    rows = [("", "segment 0", "segment 1")]
    rows += [(name, *(_value(name, seg.row[k][name]) for k in range(2))) for name in names]
    if corners:
        rows += [
            (name, *(" ".join(map(_number, points[k])) for k in range(2)))
            for name, points in (("start", seg.start), ("end", seg.end))
        ]
    return _table(rows)


def _value(name: str, value: float) -> str:
    return f"{int(value):#x}" if name == "tag" else _number(value)


def _by_hand(state, cycle_s: float) -> str:  # type: ignore[no-untyped-def]
    """Work out the first segment's numbers from the block, and hold them against the kernel's."""
    row = state.seg.row[0]
    length = math.hypot(20.0, 5.0)
    part = 20.0 / length
    full = 5000.0 / part
    corner = 0.5 * 5000.0 * cycle_s / part
    share = 0.5**2
    beside = (corner + 0.5 * full * (1.0 - share) * cycle_s) * cycle_s
    gain = 2.0 * full * (length - share * beside)
    for name, value in (
        ("length", length),
        ("full_accel", full),
        ("junction", corner),
        ("yield_before", share / corner),
        ("gain", gain),
    ):
        assert math.isclose(row[name], value, rel_tol=1e-12), name
    return "\n".join(
        (
            f"length      sqrt(20² + 5²) mm               = {length:.6f} mm",
            f"full_accel  5000 mm/s² · length / 20 mm     = {full:.3f} mm/s²    X needs most of it",
            f"junction    0.5 · 5000 mm/s² · 0.001 s / {part:.6f} = {corner:.6f} mm/s",
            f"given away  0.5²                            = {share}",
            f"over        ({corner:.3f} mm/s + (1 - 0.25) / 2 · {full:.0f} mm/s² · 0.001 s) · 0.001 s"
            f" = {beside:.6f} mm",
            f"gain        2 · full_accel · (length - 0.25 · {beside:.6f} mm) = {gain:.3f} mm²/s²",
        )
    )


def _ramps(ramps) -> str:  # type: ignore[no-untyped-def]
    names = {
        "SPEED_IN": (SPEED_IN, "mm/s"),
        "SPEED_PEAK": (SPEED_PEAK, "mm/s"),
        "SPEED_OUT": (SPEED_OUT, "mm/s"),
        "TIME_IN": (TIME_IN, "s"),
        "TIME_CRUISE": (TIME_CRUISE, "s"),
        "TIME_OUT": (TIME_OUT, "s"),
        "LENGTH": (LENGTH, "mm"),
    }
    return _table([(name, _number(ramps[index]), unit) for name, (index, unit) in names.items()])


def _setpoints(rows, cycles) -> str:  # type: ignore[no-untyped-def]
    table = [("cycle", "block", "speed mm/s", "X mm", "Y mm")]
    for cycle in cycles:
        time_s, block, speed, _, x, y, _ = rows[cycle - 1]
        assert math.isclose(time_s, cycle * 0.001)
        table.append((str(cycle), f"{block:.0f}", f"{speed:.6f}", f"{x:.9f}", f"{y:.9f}"))
    return _table(table)


def _trace(config, rows) -> str:  # type: ignore[no-untyped-def]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.csv"
        with TraceWriter(path, config, actual=False) as writer:
            writer.add(np.ascontiguousarray(rows))
        lines = path.read_text(encoding="ascii").splitlines()
    assert lines[-1].split(",")[3:5] == ["20.0", "25.0"]
    return "\n".join([*lines[:4], "...", lines[-1]])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
