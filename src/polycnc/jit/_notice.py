"""The one line that says why it takes a while."""

from __future__ import annotations

import logging

_LOG = logging.getLogger("polycnc")

COMPILING = (
    "Compiling the motion code; this happens once after an installation and takes some seconds "
    "(`polycnc warmup` does it beforehand)."
)


class _Notice:
    said = False


def announce() -> None:
    """Say, once in a process, that something is being compiled: a warning of the logger `polycnc`."""
    if not _Notice.said:
        _Notice.said = True
        _LOG.warning(COMPILING)
