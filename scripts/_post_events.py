"""The reference page of the post-processor's events, made from their table."""

from polycnc.post.macros._events import EVENTS, STATES, WORDS, WordRow

_HEAD = """# Events of a tool path

<!-- Written by scripts/reference. -->

A tool path is a row of events. Each calls the macro of its name in the [control file](post-control-file.md), after it
has set the words that the macro may write. What statements of a tool path are which event is described in
[tool paths](post-tool-paths.md).

## Events

"""
_MISSING = """
What happens if the control file has no such macro: without RAPID and LINEAR a tool path that moves is an error; holes
become moves (RAPID, LINEAR, DWELL) and arcs become lines; for the events marked * it is remarked that nothing was
written, but COMP_LEFT, COMP_RIGHT, INSERT and TOOL_CHANGE (for a second tool) are errors; the others need no macro.

Macros marked + are additions to those of Manual 001, as are the words marked so; with `strict = true` in the
[control file](post-control-file.md) there are none of them, and their names are free for variables.

A record that nothing here takes calls `WORD`. A condition cannot compare texts, so a macro of its own can take it: by
its name, like `WORD_AUXFUN`, or by its name and the first word after the slash, like `WORD_OPSKIP_ON`. The narrowest
is called; without any the record is remarked, or an error where it would change the part (`PREFUN`, `SYNC`, ...:
[tool paths](post-tool-paths.md)). What moves the tool or its coordinates is an error, whatever macros there are.

```toml
[nc_macros]
WORD_AUXFUN = '''
"M"$NUMBER1$
'''
WORD_OPSKIP_ON = '''
<STARTOFLINE="/">
'''
WORD_OPSKIP_OFF = '''
<STARTOFLINE="">
'''
```

## Words

Lengths are in the units of the program (`units` of the control file), angles in degree, times in seconds. Words of one
letter are written by the function variables of that name. A word keeps its value until an event sets it anew.

"""
_STATES = """
## Words that hold in every macro

What the tool path has switched, up to the event at hand and whatever a tool change does in between. Macros cannot set
these, nor the words of `WORD`. A function variable of the same name gives a number its format, like
`NEXTTOOL = { format = "T%02d" }`.

"""


def page() -> str:
    """Return the page."""
    events = ["| macro | when | words |", "| --- | --- | --- |"]
    for event in EVENTS:
        mark = (" *" if event.group == "state" else "") + (" +" if event.added else "")
        events.append(f"| `{event.macro}`{mark} | {event.when} | {', '.join(event.words)} |")
    words = ["| word | is | meaning |", "| --- | --- | --- |"]
    words += [_row(word) for word in WORDS]
    states = [*words[:2], *(_row(word) for word in STATES)]
    return (
        _HEAD
        + "\n".join(events)
        + "\n"
        + _MISSING
        + "\n".join(words)
        + "\n"
        + _STATES
        + "\n".join(states)
        + "\n"
    )


def _row(word: WordRow) -> str:
    return f"| {word.name}{' +' if word.added else ''} | {word.kind} | {word.meaning} |"
