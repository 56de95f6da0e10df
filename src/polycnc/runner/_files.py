"""Output files: checked before the work begins, and under their name only when they are complete."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from polycnc.errors import UsageError


def check_output(path: str | Path, extensions: Sequence[str], what: str) -> Path:
    """Return `path`, where `what` ("a trace") could be written.

    Raises:
        UsageError: an extension that is not in `extensions`, no such folder, or a folder of that name.
    """
    path = Path(path)
    if path.suffix.lower() not in extensions:
        trouble = f"'{path.suffix}' is none of its formats" if path.suffix else "the name tells no format"
        raise UsageError(
            f"{what} cannot be written to {path}: {trouble}",
            hint=f"Use a name that ends with {', '.join(extensions[:-1])} or {extensions[-1]}.",
        )
    if path.is_dir():
        raise UsageError(f"{what} cannot be written to {path}: it is a folder", hint="Give a file name.")
    if not path.parent.is_dir():
        raise UsageError(
            f"{what} cannot be written to {path}: there is no folder {path.parent}",
            hint="Make the folder first, or name another one.",
        )
    if not os.access(path.parent, os.W_OK):
        raise UsageError(
            f"{what} cannot be written to {path}: the folder {path.parent} is read-only",
            hint="Name another folder, or change its access rights.",
        )
    return path


def keep_inputs(output: str | Path | None, inputs: Iterable[str | Path | None], what: str) -> None:
    """Refuse to write `what` over a file that is read; other names of a file, links among them, count.

    Raises:
        UsageError: `output` is one of `inputs`.
    """
    if output is None or not Path(output).exists():
        return
    for each in inputs:
        if each is not None and Path(each).exists() and Path(output).samefile(each):
            raise UsageError(
                f"{what} cannot be written to {output}: the command reads that file",
                hint="Name another file.",
            )


@contextmanager
def complete_or_absent(path: Path) -> Iterator[Path]:
    """Yield a name to write to; the file gets its real name when the body ends well, else it is removed."""
    partial = path.with_name(f".{path.stem}.{os.getpid()}.partial{path.suffix}")
    try:
        yield partial
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
