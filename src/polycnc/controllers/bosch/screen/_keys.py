"""The keys of the operating panel and a script that presses them (Manual 003, INKEY and annex A.6)."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from polycnc.errors import UsageError
from polycnc.nc.cpl import Fault

KEYS: dict[str, int] = {
    "ENTER": 13,
    "DELETE": 127,
    "CURSOR_UP": 131,
    "CURSOR_DOWN": 132,
    "CURSOR_RIGHT": 133,
    "CURSOR_LEFT": 134,
    "LEVEL_RETURN": 139,
    **{f"SOFTKEY{number}": 140 + number for number in range(1, 9)},
}
"""What INKEY returns for keys with names; a character key returns its ASCII code."""
_PATIENCE = 100_000


class Keyboard:
    """Press keys in their order: each is a name of KEYS or one character.

    With `live` more may be pressed at any time: who asks waits for them.

    Raises:
        UsageError: A key has no such name.
    """

    def __init__(self, keys: Iterable[str] = (), *, live: bool = False) -> None:
        self._codes = deque(_code(key) for key in keys)
        self._given = len(self._codes)
        self._live = live
        self._in_vain = 0

    def press(self, key: str) -> None:
        """Press one more key.

        Raises:
            UsageError: It has no such name.
        """
        self._codes.append(_code(key))

    def clear(self) -> None:
        """Forget the keys that were pressed and nobody has asked for; those given at first stay."""
        while len(self._codes) > self._given:
            self._codes.pop()

    def poll(self) -> int:
        """Return the next key that was pressed, 0 if there is none.

        Raises:
            Fault: A program goes on asking although no key is left.
        """
        if self._codes:
            self._given = max(self._given - 1, 0)
            return self._codes.popleft()
        self._in_vain += not self._live
        if self._in_vain > _PATIENCE:
            raise _no_key()
        return 0

    def wait(self) -> int | None:
        """Return the next key, None if one may come.

        Raises:
            Fault: No key is left, and none will come.
        """
        if self._codes:
            return self.poll()
        if self._live:
            return None
        raise _no_key()


def _code(key: str) -> int:
    if len(key) == 1 and 0 < ord(key) < 128:
        return ord(key)
    if key not in KEYS:
        raise UsageError(
            f"there is no key '{key}'", hint=f"Write one character, or one of {', '.join(KEYS)}."
        )
    return KEYS[key]


def _no_key() -> Fault:
    return Fault("the program waits for a key, and none is pressed", "give it the keys that it asks for")
