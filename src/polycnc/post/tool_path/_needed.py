"""Records that nothing but a macro of the control file can obey: without one the part or the cut would be another."""

from __future__ import annotations

from polycnc.post.tool_path._records import Word

_NEEDED = {
    "AUXFUN": "is an M code for the control",
    "PREFUN": "is a G code for the control",
    "OPSKIP": "says which blocks the operator may skip",
    "COUPLE": "couples an axis with the spindle",
    "SYNC": "waits for another channel",
    "SYNCTR": "waits for another channel",
}
_ONE = {
    "CHANNEL": "goes to another channel",
    "HEAD": "goes to another head",
    "SWITCH": "takes another point of the tool",
}
"""Records of which the first one says what holds anyway, and another one changes it."""

_OF_CHANNELS = frozenset(("SYNC", "SYNCTR", "CHANNEL", "HEAD"))


class Needed:
    """What records that are not known have said so far."""

    def __init__(self) -> None:
        self._said: dict[str, str] = {}

    def tool_changed(self) -> None:
        """Know that another tool comes: its own point may be said."""
        self._said.pop("SWITCH", None)

    def why(self, record: Word) -> tuple[str, str] | None:
        """Return what a record would change if it were left out, and what to do; None if it may be left out."""
        name = record.name
        what = _NEEDED.get(name)
        if name == "OPSKIP" and record.first == "OFF" and name not in self._said:
            what = None
        text = "".join(record.text.split()).upper()
        before = self._said.setdefault(name, text)
        if name in _ONE and text != before:
            what = _ONE[name]
        if what is None:
            return None
        hint = f"Write the macro WORD_{name} in the control file, or take the record out of the tool path."
        if name in _OF_CHANNELS:
            hint = f"Let the CAM system write each channel by itself, or write the macro WORD_{name}."
        return f"{name}{f'/{text}' if text else ''} {what}, and the control file has no macro for it", hint
