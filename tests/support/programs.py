"""Part programs in tests: prepare one, list what stands in the queue, and take the state of its channel."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from polycnc.kernel import ARC, LINE, RAPID, STOP, WAIT, give_to_path
from polycnc.kernel._segments import CENTER_P, CENTER_Q, SWEEP_RAD, WAIT_EVENT, WAIT_S
from polycnc.machine import Machine, MachineConfig, parse_toml, validate
from polycnc.nc import Channel, ChannelOptions, Dialect, ProgramText, line_of, load_dialect
from polycnc.nc.modal._modal import ORDINARY
from polycnc.nc.records._block_records import LINE_MASK

AXIS = '[[axis]]\nname = "{name}"\nvmax_mm_s = 500\namax_mm_s2 = 5000\nsoft_limits_mm = [{low}, {high}]\n'
SPINDLE = "[spindle]\nmax_rpm = 10000\n"
TIMES = "[times]\ntool_change_s = 5\nspindle_start_s = 2\nauxiliary_s = 0.25\n"
OFFSETS = (
    "[offsets]\nG54 = {{ X = 0 }}\nG55 = {{ X = 100, Y = 50, Z = -20 }}\nG56 = {{ X = -10.5 }}\n"
    "G154 = {{ X = 1, Y = 2 }}\nG254 = {{ X = 0.25, Z = 5 }}\n"
)
TOOLS = (
    "[tools.1]\nlength_mm = 80\nradius_mm = 5\n"
    "[tools.2]\nlength_mm = 50\nradius_mm = 3\nwear_length_mm = -0.1\nwear_radius_mm = 0.25\n"
)
ROTARY = (
    '[[axis]]\nname = "A"\nkind = "rotary"\nvmax_deg_s = 90\namax_deg_s2 = 900\n'
    "soft_limits_deg = [-120, 120]\n"
    '[[axis]]\nname = "C"\nkind = "rotary"\nvmax_deg_s = 180\namax_deg_s2 = 1800\nmodulo = true\n'
)
LINEAR = "".join(AXIS.format(name=name, low=-300, high=300) for name in "XYZ")


def machine_config(*tables: str, name: str = "test") -> MachineConfig:
    """Return the machine that these tables describe."""
    text = f'name = "{name}"\n' + "".join(tables).replace("{{", "{").replace("}}", "}")
    return validate(MachineConfig, *parse_toml(text, f"{name}.toml"))


MILL = machine_config(LINEAR, SPINDLE)
"""X Y Z from -300 to 300 mm, without tools and work offsets."""
FIVE = machine_config(LINEAR, ROTARY, SPINDLE, TIMES, TOOLS, OFFSETS, name="five")
"""The same with A (-120 to 120 degree) and C (modulo), tools, work offsets and times."""


def prepare(
    program: str | ProgramText,
    *,
    config: MachineConfig = MILL,
    dialect: str | Dialect = "din",
    segments: int = 4096,
    ordinary_blocks: float = 0,
    collect_errors: bool = False,
    marks: bool = False,
    **arguments: Any,
) -> Channel:
    """Prepare a program completely, without running it; the compiled kernel takes what it can."""
    text = program if isinstance(program, ProgramText) else ProgramText.from_text(program, "test.nc")
    machine = Machine(config, segments=segments)
    options = ChannelOptions(ordinary_blocks=ordinary_blocks, collect_errors=collect_errors, marks=marks)
    channel = Channel(text, load_dialect(dialect), machine, options=options, **arguments)
    give_to_path(machine.state, channel.path)
    channel.fill()
    while channel.paused:
        machine.clock.tick(1)  # more is prepared with the next cycle
        channel.fill()
    assert channel.done, "the program does not fit into the queue"
    return channel


def accepted(program: str | ProgramText, **options: Any) -> Channel:
    """Prepare a program that must not be refused."""
    channel = prepare(program, **options)
    assert channel.error is None, str(channel.error)
    return channel


def moves(program: str | ProgramText, **options: Any) -> list[str]:
    """Return the listing of a program that must not be refused."""
    return listing(accepted(program, **options))


def notes(program: str, **options: Any) -> list[str]:
    """Return the messages of a program that must not be refused."""
    return [message.text for message in accepted(program, **options).messages.all()]


def refusal(program: str, **options: Any) -> str:
    """Return the first line of what is said about a program that must be refused, without the file."""
    channel = prepare(program, **options)
    assert channel.error is not None, "nothing was refused"
    position = channel.error.position
    assert position is not None
    assert channel.error.hint
    return f"{position.line}:{position.column}: {channel.error.what}"


def listing(channel: Channel, *, lines: bool = False) -> list[str]:
    """Return the channel queue, one line of text per item; with `lines` each begins with its program line."""
    state = channel.machine.state
    row = state.paths.row[channel.path]
    slots = [int(row["base"]) + n % int(row["capacity"]) for n in range(int(row["head"]), int(row["tail"]))]
    items = [_item(channel, k) for k in slots]
    if not lines:
        return items
    return [
        f"{line_of(int(state.seg.row[k]['tag'])):4d}  {item}" for k, item in zip(slots, items, strict=True)
    ]


def _item(channel: Channel, k: int) -> str:
    state = channel.machine.state
    names = channel.machine.config.axis_names
    segment, geo = state.seg.row[k], state.seg.geo[k]
    start, end = state.seg.start[k], state.seg.end[k]
    feed = "" if math.isinf(segment["feed_mm_s"]) else f" F{number(segment['feed_mm_s'] * 60.0)}"
    stop = " stop" if segment["flags"] & STOP else ""
    first = int(segment["event"])
    words = [channel.writer.events[first + count].word for count in range(int(segment["events"]))]
    stop += f" with {', '.join(words)}" if words else ""
    # An arc names both axes of its plane; a move only what moves.
    named = set(state.seg.plane[k, :2].tolist()) if segment["kind"] == ARC else set()
    point = "".join(
        f" {name}{number(value)}"
        for index, (name, value) in enumerate(zip(names, end, strict=True))
        if index in named or value != start[index]
    )
    match int(segment["kind"]):
        case 4 if geo[WAIT_EVENT] >= 0:
            return channel.writer.events[int(geo[WAIT_EVENT])].word
        case 4:
            return f"wait {number(geo[WAIT_S])}"
        case 1:
            p, q = (names[axis] for axis in state.seg.plane[k, :2])
            center = f"{p}{number(geo[CENTER_P])} {q}{number(geo[CENTER_Q])}"
            return f"arc{point} about {center} by {number(math.degrees(geo[SWEEP_RAD]))}{feed}{stop}"
        case 0:
            return f"{'rapid' if segment['flags'] & RAPID else 'line'}{point}{feed}{stop}"
        case _:
            return f"round{point}{feed}{stop}"


assert (LINE, ARC, WAIT) == (0, 1, 4)


def number(value: float) -> str:
    """Return a number with up to four decimals."""
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def queue_bytes(channel: Channel) -> list[bytes]:
    """Return the whole queue bit by bit."""
    state = channel.machine.state
    tail = int(state.paths.row[channel.path]["tail"])
    seg = state.seg
    fields = ("length", "feed_mm_s", "end_speed", "kind", "flags")
    columns = [np.ascontiguousarray(seg.row[name][:tail]) for name in fields]
    columns.append(seg.row["tag"][:tail] & LINE_MASK)  # the numbers of contexts depend on the way
    columns += [seg.start[:tail], seg.end[:tail], seg.geo[:tail], seg.plane[:tail]]
    return [column.tobytes() for column in columns]


def channel_state(channel: Channel) -> dict[str, object]:
    """Return everything that a block may change, for comparison."""
    state = channel.state
    modal = state.modal
    whole = modal.whole.copy()
    whole[ORDINARY] = 0  # only says which way the next block takes
    stage = state.compensation
    return {
        "whole": whole.tolist(),
        "real": modal.real.tolist(),
        "position": [value.hex() for value in modal.position.tolist()],
        "offset": [value.hex() for value in modal.offset.tolist()],
        "scale": modal.scale.tolist(),
        "work": state.coordinates.work,
        "shift": state.coordinates.shift.tolist(),
        "length": state.coordinates.length.tolist(),
        "length_sign": state.coordinates.length_sign,
        "plain": replace(state.plain(), feed_word=0.0),  # of the present block only
        "compensation": dict(vars(stage)) if stage.active else {},
        "messages": [(message.text, message.line, message.count) for message in channel.messages.all()],
        "tolerance": float(channel.writer.paths.row[channel.path]["tolerance_mm"]),
        "events": list(channel.writer.events.values()),
    }
