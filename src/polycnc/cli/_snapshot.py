"""``polycnc snapshot`` and ``polycnc restore``: the state of a served machine as a file, and back."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from polycnc.cli._output import say

_MOST_BYTES = 16 << 20  # that a server takes
_At = Annotated[str, typer.Argument(help="Where its page is, like http://127.0.0.1:8080.", metavar="URL")]
_Machine = Annotated[
    str | None, typer.Option("--machine", "-m", help="Its name, where several are served.", metavar="NAME")
]
_Token = Annotated[Path | None, typer.Option(help="The file with the secret of the server.", metavar="FILE")]


def snapshot_command(
    url: _At,
    file: Annotated[Path, typer.Argument(help="The file to write.", metavar="FILE")],
    machine: _Machine = None,
    token: _Token = None,
) -> None:
    """Keep the whole state of a served machine, which runs on, in a file."""
    from polycnc.outputs import check_output, complete_or_absent, keep_inputs
    from polycnc.servers.asking import Asked

    path = check_output(file, (), "the snapshot")
    keep_inputs(path, (token,), "the snapshot")
    asked = Asked(url, token)
    with complete_or_absent(path) as partial:
        partial.write_bytes(asked.snapshot(machine))
    say(f"{file}: written")


def restore_command(
    file: Annotated[Path, typer.Argument(help="The file of a snapshot.", metavar="FILE")],
    url: _At,
    machine: _Machine = None,
    token: _Token = None,
) -> None:
    """Let a served machine go back to the state of a file: this one, or another that was made alike."""
    from polycnc.errors import UsageError
    from polycnc.servers.asking import Asked

    try:
        with file.open("rb") as stream:
            content = stream.read(_MOST_BYTES + 1)
    except OSError as error:
        raise UsageError(f"{file}: {error.strerror or error}", hint="Give the file of a snapshot.") from None
    if len(content) > _MOST_BYTES:
        raise UsageError(f"{file}: larger than any snapshot", hint="Give the file of a snapshot.")
    status: dict[str, Any] = Asked(url, token).restore(content, machine)
    say(f"{status.get('time_s', 0.0):.3f} s")
