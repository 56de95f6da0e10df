"""What holds before a line of a program and how long it takes, in words."""

from __future__ import annotations

from polycnc.machine import MachineConfig
from polycnc.nc import Action, Dialect, Group, ModalWords
from polycnc.runner import LineTime, time_text
from polycnc.units import MM_PER_INCH

_TURNS = {1: "clockwise", -1: "counter-clockwise", 0: "at rest"}


def held(modal: ModalWords, position: dict[str, float], config: MachineConfig, dialect: Dialect) -> str:
    """Return the modal words and the position before a line, as Markdown."""
    codes = " ".join(dict.fromkeys(modal.g.values()))
    turns = "oriented" if modal.spindle_oriented else _TURNS[modal.spindle_direction]
    words = [
        f"tool T{modal.tool}" + (f" (next T{modal.next_tool})" if modal.next_tool != modal.tool else ""),
        f"F{modal.feed:g} {feed_unit(modal, dialect)}",
        f"S{modal.speed:g} {speed_unit(modal, dialect)}, {turns}",
    ]
    if modal.d:
        words.append(f"D{modal.d}")
    if modal.h:
        words.append(f"H{modal.h}")
    words += [f"M{code}" for code in modal.coolant]
    scale = MM_PER_INCH if modal.inch else 1.0
    places = []
    for axis, zero in zip(config.axes, modal.zero, strict=True):
        value = position[axis.name] - zero
        value = value / scale if axis.unit == "mm" else value
        places.append(f"{axis.name}{round(value, 4) + 0.0:g}")
    unit = "inch" if modal.inch else "mm"
    return (
        f"Before this line: {codes}  \n{'; '.join(words)}  \nat {' '.join(places)} ({unit}, work coordinates)"
    )


def taken(time: LineTime | None) -> str:
    """Return how long a line takes, as a sentence."""
    if time is None:
        return "This line takes no time."
    rounds = f" in {time.count} rounds" if time.count > 1 else ""
    text = f"{time.time_s:.3f} s" if time.time_s < 60.0 else time_text(time.time_s)
    return f"This line takes {text}{rounds}."


def feed_unit(modal: ModalWords, dialect: Dialect) -> str:
    """Return the unit of F words."""
    length = "inch" if modal.inch else "mm"
    match _action(modal, Group.FEED_MODE, dialect):
        case Action.FEED_PER_REVOLUTION:
            return f"{length}/rev"
        case Action.FEED_INVERSE_TIME:
            return "1/min"
        case _:
            return f"{length}/min"


def speed_unit(modal: ModalWords, dialect: Dialect) -> str:
    """Return the unit of S words."""
    mode = _action(modal, Group.SPINDLE_MODE, dialect)
    return "of cutting speed" if mode is Action.CONSTANT_SURFACE_SPEED else "rpm"


def _action(modal: ModalWords, group: Group, dialect: Dialect) -> Action | None:
    code = modal.g.get(group, "")[1:]
    return dialect.g_action(float(code)) if code else None


def word_meaning(letter: str, modal: ModalWords, config: MachineConfig, dialect: Dialect) -> str:
    """Return what an address other than G and M is before a line, and its unit; empty where that is not fixed."""
    match letter:
        case "F":
            return f"Feed, {feed_unit(modal, dialect)}"
        case "S":
            return f"Speed of the spindle, {speed_unit(modal, dialect)}"
        case "T":
            turret = dialect.tool_word == "turret"
            return "Tool and its offset" if turret else "Tool of the next tool change"
        case "N":
            return "Number of the block"
        case _:
            axis = next((axis for axis in config.axes if axis.name == letter), None)
    if axis is None:
        return ""
    unit = axis.unit if axis.unit != "mm" or not modal.inch else "inch"
    relative = _action(modal, Group.DISTANCE, dialect) is Action.INCREMENTAL
    return f"Axis {letter}, {'way' if relative else 'position'} in {unit}"
