"""The hidden folder in which a file grows until it gets its name, and those of killed runs."""

from __future__ import annotations

import os
import re
import shutil
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from acutance.errors import AcutanceError, OptionError

__all__ = ["named_whole_file", "partial_folder", "whole_file"]


@contextmanager
def partial_folder(target: Path) -> Iterator[str]:
    """A folder beside a file that is to be written, which goes with the end of the block.

    A process that is killed leaves its folder behind: the next one that writes beside it removes
    it.

    Parameters
    ----------
    target : Path
        The file; on the same file system, a finished one is renamed at once.

    Yields
    ------
    str
    """
    _remove_left_behind(target.parent)
    prefix = f".acutance-{_system()}-{os.getpid()}-"
    with TemporaryDirectory(prefix=prefix, dir=target.parent) as folder:
        yield folder


@contextmanager
def whole_file(target: str | os.PathLike[str]) -> Iterator[Path]:
    """A name to write under; at the end the file is renamed, or removed after an error.

    A file that was there stays as it is until then. Links are followed, and what is no ordinary
    file (a pipe, a terminal) is written to as it is. What the file system refuses is its own error.

    Parameters
    ----------
    target : str or path

    Yields
    ------
    Path
    """
    place = Path(os.path.realpath(target))
    if place.exists() and not place.is_file():
        yield place
        return
    with partial_folder(place) as folder:
        part = Path(folder, place.name)
        yield part
        os.replace(part, place)


@contextmanager
def named_whole_file(
    path: str | os.PathLike[str], refusal: type[AcutanceError] = OptionError
) -> Iterator[Path]:
    """A whole file that a caller named: what the system refuses is said in words.

    Parameters
    ----------
    path : str or path
    refusal : class of error, optional

    Yields
    ------
    Path

    Raises
    ------
    OptionError
        If the file cannot be written, where `refusal` names no other class.
    """
    try:
        with whole_file(path) as part:
            yield part
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise refusal(f"{path} cannot be written ({reason}): choose another path") from error


def _system() -> str:
    """Where the number of a process means the same process: the host, and the container on it."""
    namespace = Path("/proc/self/ns/pid")
    number = namespace.stat().st_ino if namespace.exists() else 0
    host = os.uname().nodename if os.name == "posix" else ""
    return f"{zlib.crc32(f'{host} {number}'.encode()):08x}"


def _remove_left_behind(folder: Path) -> None:
    """Remove what processes of this system and user left that are no more."""
    if os.name != "posix":
        # Elsewhere no signal asks for a process without an effect on it.
        return
    pattern = re.compile(rf"\.acutance-{_system()}-(\d+)-\w+")
    # What cannot be listed, or goes meanwhile, is no reason not to write.
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            named = pattern.fullmatch(entry.name)
            if named is None or not entry.is_dir(follow_symlinks=False):
                continue
            own = entry.stat(follow_symlinks=False).st_uid == os.getuid()
            if own and not _is_running(int(named[1])):
                shutil.rmtree(entry.path, ignore_errors=True)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OverflowError, PermissionError):
        # Not the number of a process, or that of another user's.
        return True
    return True
