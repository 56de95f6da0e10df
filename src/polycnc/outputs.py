"""Output files: checked before the work begins, never over an input, under their name only when they are complete.

Every command writes through this module. A device, a pipe or what a link points to is written itself; any other
file is made beside its place, under a name that nobody can guess and that is opened for this process alone, and gets
its name in one step. What killed processes have left of such files is swept by the next one that writes the same file.
"""

from __future__ import annotations

import errno
import os
import re
import secrets
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from polycnc.errors import UsageError

if sys.platform == "win32":

    def _lock(descriptor: int) -> None:
        """Do nothing: a file that is open cannot be removed there, which serves as well."""

else:
    import fcntl

    def _lock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


RENAMES_OPEN_FILES = os.name != "nt"
_TOKEN_BYTES = 8
_FULL = (errno.ENOSPC, errno.EFBIG, errno.EIO, getattr(errno, "EDQUOT", errno.ENOSPC))
_ATTEMPTS = 16
_BESIDE = r"\.before|-journal|-wal|-shm"  # what writers make beside the file that they write
_NO_LINK = getattr(os, "O_NOFOLLOW", 0)


def _listed(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} or {names[-1]}" if len(names) > 1 else names[0]


def check_output(path: str | Path, extensions: Sequence[str], what: str) -> Path:
    """Return `path`, where `what` ("a trace") could be written; with `extensions` its name must end with one of them.

    Raises:
        UsageError: an extension that is not in `extensions`, no such folder, or a folder of that name.
    """
    path = Path(path)
    with _named(path, what):
        special = is_special(path)
        is_folder, has_folder = path.is_dir(), path.resolve().parent.is_dir()
    if extensions and path.suffix.lower() not in extensions and not (special and not path.suffix):
        trouble = f"'{path.suffix}' is none of its formats" if path.suffix else "the name tells no format"
        raise UsageError(
            f"{what} cannot be written to {path}: {trouble}",
            hint=f"Use a name that ends with {_listed(extensions)}.",
        )
    if is_folder:
        raise UsageError(f"{what} cannot be written to {path}: it is a folder", hint="Give a file name.")
    folder = path.parent
    if not has_folder:
        raise UsageError(
            f"{what} cannot be written to {path}: there is no folder {folder}",
            hint="Make the folder first, or name another one.",
        )
    if not special and not os.access(path.resolve().parent, os.W_OK):
        raise UsageError(
            f"{what} cannot be written to {path}: the folder {folder} is read-only",
            hint="Name another folder, or change its access rights.",
        )
    return path


def format_of(path: Path, extensions: Sequence[str]) -> str:
    """Return the extension that tells the format of an output that was checked; of a device the first."""
    return path.suffix.lower() or extensions[0]


def keep_inputs(output: str | Path | None, inputs: Iterable[str | Path | None], what: str) -> None:
    """Refuse to write `what` over a file that is read; other names of a file, links among them, count.

    Raises:
        UsageError: `output` is one of `inputs`.
    """
    if output is None:
        return
    with _named(Path(output), what):
        if not Path(output).is_file():
            return
    for each in inputs:
        if each is not None and _is_same(Path(output), Path(each)):
            raise UsageError(
                f"{what} cannot be written to {output}: the command reads that file",
                hint="Name another file.",
            )


def _is_same(output: Path, other: Path) -> bool:
    try:
        return other.is_file() and output.samefile(other)
    except (OSError, ValueError):  # what is no file is no file that is read
        return False


def keep_apart(outputs: Iterable[tuple[str, str | Path | None]]) -> None:
    """Refuse two outputs, each with what it is ("a trace"), in one file.

    Raises:
        UsageError: Two have the same name, or are the same file by links.
    """
    seen: dict[Path, str] = {}
    for what, output in outputs:
        if output is None:
            continue
        with _named(Path(output), what):
            if is_special(Path(output)):
                continue
            place = Path(output).resolve()
        if place in seen:
            raise UsageError(
                f"{what} cannot be written to {output}: {seen[place]} goes there",
                hint="Name another file.",
            )
        seen[place] = what


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Name the file in what the system says of a full disk: it names none where bytes are written."""
    try:
        yield
    except OSError as error:
        if error.filename is not None or error.errno not in _FULL:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


@contextmanager
def complete_or_absent(path: Path, *, durable: bool = False, rewritten: bool = False) -> Iterator[Path]:
    """Yield a name to write to; the file gets its real name when the body ends well, else it is removed.

    A link is followed. A device or a pipe is written itself, so what is yielded is `path`. With `durable` the content
    is on the disk before the name is, so that a power failure cannot leave an empty file in the place of an old one.
    With `rewritten` the body reads and writes the file more than once: a device gets what it comes to at the end.

    Raises:
        UsageError: The file cannot be made.
    """
    with _named(path, "a file"):
        special = is_special(path)
        target = path if special else path.resolve()
    if special:
        if rewritten:
            yield from _copied(path)
        else:
            with _told(path):
                yield path
        return
    if not target.name or target.is_dir():
        raise UsageError(f"{path} is a folder", hint="Give the name of a file.")
    partial, descriptor = target, -1
    try:  # a signal may come at any time: what is made has its name noted before
        try:
            sweep(target)
            for _ in range(_ATTEMPTS):
                partial = target.with_name(_partial_name(target))
                descriptor = _made(partial)
                if descriptor >= 0:
                    break
            else:
                raise FileNotFoundError(2, "somebody removes the file while it is written")
        except OSError as error:
            if isinstance(error, FileExistsError):  # that of somebody else
                partial = target
            raise UsageError(
                f"{path} cannot be written: {error.strerror}", hint="Check the folder and its access rights."
            ) from error
        with _told(path):
            yield partial
            if durable:
                _synchronize(partial)
        with suppress(OSError):
            os.chmod(partial, stat.S_IMODE(target.stat().st_mode))
        if not RENAMES_OPEN_FILES:
            os.close(descriptor)
            descriptor = -1
        partial.replace(target)
        if durable:
            _synchronize(target.parent)
    finally:
        if descriptor >= 0 and not RENAMES_OPEN_FILES:  # nor removes them
            os.close(descriptor)
            descriptor = -1
        if partial != target:
            with suppress(OSError):
                partial.unlink(missing_ok=True)
        if descriptor >= 0:
            os.close(descriptor)


def _copied(path: Path) -> Iterator[Path]:
    """Yield a file elsewhere, and write what it comes to into a device."""
    with tempfile.TemporaryDirectory(prefix="polycnc-") as folder:
        content = Path(folder, path.name)
        yield content
        with _told(path), content.open("rb") as source, path.open("wb") as sink:
            shutil.copyfileobj(source, sink)


def sweep(target: Path) -> None:
    """Remove what killed processes have left of files that were to become `target`."""
    pattern = re.compile(
        rf"(\.{re.escape(target.stem)}\.[0-9a-f]{{{2 * _TOKEN_BYTES}}}\.partial{re.escape(target.suffix)})({_BESIDE})?"
    )
    beside: list[tuple[Path, Path]] = []
    for path in target.parent.iterdir() if os.access(target.parent, os.R_OK) else ():
        found = pattern.fullmatch(path.name)
        if found is None or path.is_symlink():
            continue
        with suppress(OSError):
            if not found[2]:
                _remove_if_left(path)
            beside.append((path, path.with_name(found[1])))
    for path, partial in beside:  # what is beside a file goes with it
        if not partial.exists():
            path.unlink(missing_ok=True)


def _remove_if_left(path: Path) -> None:
    descriptor = os.open(path, os.O_RDWR | _NO_LINK | getattr(os, "O_NONBLOCK", 0))
    try:
        _lock(descriptor)  # refused while its writer lives
        path.unlink()
    finally:
        os.close(descriptor)


def _partial_name(target: Path) -> str:
    return f".{target.stem}.{secrets.token_hex(_TOKEN_BYTES)}.partial{target.suffix}"


def _made(partial: Path) -> int:
    """Make a file and lock it for as long as it is written; return -1 if somebody has swept it before the lock."""
    descriptor = os.open(partial, os.O_RDWR | os.O_CREAT | os.O_EXCL | _NO_LINK, 0o666)
    with suppress(OSError):  # a file system without locks
        _lock(descriptor)
    with suppress(OSError):
        if os.path.samestat(os.fstat(descriptor), partial.stat()):
            return descriptor
    os.close(descriptor)
    return -1


def is_special(path: Path) -> bool:
    """Tell whether there is something at `path` that is no file and no folder: a device, a pipe, a socket."""
    return path.exists() and not path.is_file() and not path.is_dir()


@contextmanager
def _named(path: Path, what: str) -> Iterator[None]:
    """Turn what the file system says of an impossible name into an error."""
    try:
        yield
    except UsageError:
        raise
    except (OSError, ValueError, RuntimeError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        raise UsageError(f"{what} cannot be written to {path}: {why}", hint="Check the name.") from error


def _synchronize(path: Path) -> None:
    """Bring a file, or the names in a folder, to the disk; a file system that cannot says so, and that is all."""
    with suppress(OSError):
        descriptor = os.open(path, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
