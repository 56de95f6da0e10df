"""The errors of an agent: codes of the standard, with the HTTP status of each."""

from __future__ import annotations

from enum import Enum

from polycnc.errors import PolycncError
from polycnc.servers.mtconnect._device import clean

_NAMED = frozenset({"device", "deviceType", "path", "from", "count", "interval", "heartbeat"})


class Code(Enum):
    """A code, its HTTP status, and the element that it is in documents from 2.6 on."""

    NO_DEVICE = 404, "NoDevice"
    OUT_OF_RANGE = 400, "OutOfRange"
    INVALID_URI = 404, "InvalidURI"
    INVALID_REQUEST = 400, "InvalidRequest"
    INTERNAL_ERROR = 500, "InternalError"
    INVALID_XPATH = 400, "InvalidXPath"
    UNSUPPORTED = 405, "Unsupported"
    ASSET_NOT_FOUND = 404, "AssetNotFound"
    QUERY_ERROR = 400, "QueryError"
    TOO_MANY = 503, "TooMany"

    @property
    def status(self) -> int:
        """The HTTP status."""
        return self.value[0]


class AgentError(PolycncError):
    """A request that cannot be carried out.

    `parameter` with its `value` and `limits` is what was wrong in the query, `asset` which asset there is not.
    """

    def __init__(
        self,
        code: Code,
        what: str,
        *,
        hint: str = "",
        parameter: str = "",
        value: str = "",
        limits: tuple[int, int] | None = None,
        asset: str = "",
    ) -> None:
        super().__init__(what, hint=hint)
        self.code = code
        self.asset = clean(asset)
        self.request = ""
        self.limits = limits
        self.value = clean(value[:80])
        self.parameter = self._parameter(parameter)

    def _parameter(self, name: str) -> str:
        """Return a name that documents know; a sequence number is `from` there, whatever asks for it."""
        if name in _NAMED:
            return name
        return "from" if self.code is Code.OUT_OF_RANGE else ""

    @property
    def element(self) -> str:
        """The element that it is in documents from 2.6 on."""
        if self.code is Code.QUERY_ERROR and self.parameter:
            return "InvalidParameterValue"
        element: str = self.code.value[1]
        return element

    @property
    def text(self) -> str:
        """What is wrong, and what to do."""
        return clean(f"{self.what}. {self.hint}" if self.hint else self.what)
