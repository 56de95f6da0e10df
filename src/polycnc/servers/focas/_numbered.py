"""The number of a program in a file, and the text that a control registers."""

from __future__ import annotations

import re

from polycnc.units import whole

_NUMBER = re.compile(rb"\s*O(\d{1,4})\b")


def numbered(content: bytes) -> tuple[int, bytes]:
    """Return the number of a program and its text from the O word on; one without a number becomes O1."""
    text = content.replace(b"\r\n", b"\n").strip().removeprefix(b"%").lstrip().partition(b"\n%")[0] + b"\n"
    found = _NUMBER.match(text)
    return (whole(found[1]), text) if found else (1, b"O1\n" + text)
