"""The reference page of the post-processor's events, made from their table."""

from polycnc.post.macros._events import EVENTS, WORDS

_HEAD = """# Events of a tool path

<!-- Written by scripts/reference. -->

A tool path is a row of events. Each calls the macro of its name in the [control file](post-control-file.md), after it
has set the words that the macro may write. What statements of a tool path are which event is told in
[tool paths](post-tool-paths.md).

## Events

"""
_MISSING = """
What happens if the control file has no such macro: without RAPID and LINEAR a tool path that moves is an error; holes
become moves (RAPID, LINEAR, DWELL) and arcs become lines; for the events marked * it is remarked that nothing was
written; the others need no macro.

## Words

Lengths are in the units of the program (`units` of the control file), angles in degree, times in seconds. Words of one
letter are written by the function variables of that name. A word keeps its value until an event sets it anew.

"""


def page() -> str:
    """Return the page."""
    events = ["| macro | when | words |", "| --- | --- | --- |"]
    for event in EVENTS:
        mark = " *" if event.group == "state" else ""
        events.append(f"| `{event.macro}`{mark} | {event.when} | {', '.join(event.words)} |")
    words = ["| word | is | meaning |", "| --- | --- | --- |"]
    words += [f"| {word.name} | {word.kind} | {word.meaning} |" for word in WORDS]
    return _HEAD + "\n".join(events) + "\n" + _MISSING + "\n".join(words) + "\n"
