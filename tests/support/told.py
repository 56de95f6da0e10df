"""Ask a living control by programs: what expressions are worth there, and what stops a program."""

from __future__ import annotations

from support.living_pnc import Living


def told(living: Living, program: str, *expressions: str, channel: int = 1) -> list[float]:
    """Return what expressions are worth behind a program's blocks; TRUE is 1, and those that give it begin with ?."""
    names = [f"#V{place}{'?' if each.startswith('?') else '!'}" for place, each in enumerate(expressions)]
    asked = zip(names, expressions, strict=True)
    lines = [f"{5000 + place} {name}={each.lstrip('?')}" for place, (name, each) in enumerate(asked)]
    alarm = carried_out(living, "\n".join([program, *lines, ""]), channel)
    assert not alarm, alarm
    found = living.pnc.variables(channel)
    return [float(str(found[name])) if name.endswith("!") else float(bool(found[name])) for name in names]


def stopped(living: Living, statement: str, before: str = "10 A=1", channel: int = 1) -> str:
    """Return the text of the error that a statement stops its program with; it stands in the second line."""
    text = carried_out(living, f"{before}\n20 {statement}\n30 #NEVER%=1\n", channel)
    assert living.pnc.variables(channel).get("#NEVER%") is None
    place, _, what = text.partition(": ")
    assert place.split(":")[1:2] == [str(before.count("\n") + 2)], f"{statement}: {text}"
    return what


def carried_out(living: Living, program: str, channel: int) -> str:
    """Carry out a program; return the text of the alarm that stops it, "" for none."""
    living.write(f"main{channel}", program)
    living.pnc.select_program(f"main{channel}", channel=channel)
    living.pnc.cycle_start(channel=channel)
    living.until_over(channel)
    alarms = living.pnc.status().alarms
    if alarms:
        living.pnc.reset(channel=channel)
    return alarms[0].text if alarms else ""
