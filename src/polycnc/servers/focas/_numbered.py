"""The number of a program in a file, and the text that a control registers."""

from __future__ import annotations

import re

from polycnc.units import whole

_MARK = b"\xef\xbb\xbf"  # that editors put before UTF-8
_NUMBER = re.compile(rb"\s*O(\d{1,4})\b")


def unframed(content: bytes) -> bytes:
    """Return the text of a program as a control keeps it: without what frames it in a file."""
    text = content.removeprefix(_MARK).replace(b"\r\n", b"\n").strip().removeprefix(b"%").lstrip()
    return (b"\n" + text).partition(b"\n%")[0].removeprefix(b"\n") + b"\n"


def number_in(text: bytes) -> int | None:
    """Return the number that the text of a program begins with, if it does."""
    found = _NUMBER.match(text)
    return whole(found[1]) if found else None


def numbered(content: bytes) -> tuple[int, bytes]:
    """Return the number of a program and its text from the O word on; one without a number becomes O1."""
    text = unframed(content)
    number = number_in(text)
    return (1, b"O1\n" + text) if number is None else (number, text)
