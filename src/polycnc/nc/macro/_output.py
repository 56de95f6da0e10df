"""What programs put out to a device: DPRNT as text, BPRNT as bytes, between POPEN and PCLOS."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.nc.macro._functions import rounded
from polycnc.nc.macro._host import Host
from polycnc.nc.macro._syntax import Output, Printed
from polycnc.nc.macro._variables import MacroError

_BEGIN, _END = b"\x12", b"\x14"  # the device is switched on and off by these (DC2, DC4)
_LARGEST = 2**31 - 1
_MOST_TOLD = 200


class OutputDevice:
    """Take what programs put out: `sink` gets the bytes; without one messages tell the first lines of text.

    With `bare` values are put out without blanks for leading zeros and plus signs (a parameter of the controls).
    """

    def __init__(self) -> None:
        self.sink: Callable[[bytes], None] | None = None
        self.bare = False
        self.is_open = False
        self._told = 0
        self._channel: Host | None = None

    def attach(self, channel: Host) -> None:
        """Work for a channel; the device is closed."""
        self._channel = channel
        self.is_open = False

    def saved(self) -> tuple[bool, int]:
        """Return whether it is open and how many lines messages have told, to go back to."""
        return self.is_open, self._told

    def restore_state(self, saved: tuple[bool, int]) -> None:
        """Be open or closed as it was; nothing is put out for that."""
        self.is_open, self._told = saved

    def switch(self, on: bool) -> None:
        """Open or close the device (POPEN, PCLOS)."""
        self.is_open = on
        self._send(_BEGIN if on else _END)

    def write(self, output: Output, values: tuple[float, ...], line: int) -> None:
        """Put out one line of text, or bytes; `line` is that of the program.

        Raises:
            MacroError: The device is closed, or a value does not fit.
        """
        if not self.is_open:
            raise MacroError("an output to a device that is closed", "Write POPEN before.", "PS0113")
        following = iter(values)
        if output.binary:
            self._send(b"".join(_binary(piece, following.__next__) for piece in output.pieces) + b"\n")
            return
        printed = "".join(
            " " if piece == "*" else piece if isinstance(piece, str) else self._text(piece, next(following))
            for piece in output.pieces
        )
        if self.sink is None and self._channel is not None and self._told < _MOST_TOLD:
            self._told += 1
            self._channel.messages.note(f"DPRNT: {printed}", line)
        self._send(printed.encode("ascii") + b"\n")

    def _send(self, data: bytes) -> None:
        if self.sink is not None:
            self.sink(data)

    def _text(self, piece: Printed, value: float) -> str:
        """Return a value with its digits; more whole ones than there is room for are cut off, as controls do."""
        scaled = int(rounded(abs(value) * 10.0**piece.decimals))
        whole, rest = divmod(scaled, 10**piece.decimals)
        digits = str(whole)[-piece.whole :] if piece.whole else ""
        if not self.bare:
            digits = digits.rjust(piece.whole)
        point = f".{rest:0{piece.decimals}d}" if piece.decimals else ""
        sign = "-" if value < 0.0 and scaled else "" if self.bare else " "
        return sign + digits + point


def _binary(piece: str | Printed, value: Callable[[], float]) -> bytes:
    if isinstance(piece, str):
        return (" " if piece == "*" else piece).encode("ascii")
    number = value()
    scaled = rounded(number * 10.0**piece.decimals)
    if not abs(scaled) <= _LARGEST:
        raise MacroError(f"{number:g} does not fit into four bytes", "Put out fewer decimals.", "PS0119")
    return int(scaled).to_bytes(4, "big", signed=True)
