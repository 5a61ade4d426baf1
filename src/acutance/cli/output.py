"""Files a command writes: refused before the work, or written whole."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path

from acutance.cli.terminal import say
from acutance.errors import OptionError

__all__ = [
    "OutputFile",
    "check_optional",
    "check_output",
    "make_folder",
    "outputs_of_a_run",
    "require_folder",
    "require_own_file",
]

Identity = str | tuple[int, int]

_outputs: ContextVar[dict[Identity, str] | None] = ContextVar("outputs", default=None)
"""The files that the run writes, and the options that named them."""


@dataclass(frozen=True)
class OutputFile:
    """A file that was found writable.

    Parameters
    ----------
    option : str
        The option that named it, for messages.
    path : Path
        As the user named it.
    """

    option: str
    path: Path

    @property
    def place(self) -> Path:
        """Where the content goes: a symbolic link is followed, and stays a link."""
        return _place(self.path)

    @property
    def ending(self) -> str:
        """What the name ends in, lower case, with its dot."""
        return self.path.suffix.lower()

    def write(self, content: str | bytes) -> None:
        """Write the file under another name and rename it, so that it is whole or not there.

        Raises
        ------
        OptionError
            If the file system refuses.
        """
        data = content.encode() if isinstance(content, str) else content
        try:
            with _part_path(self.place) as part:
                part.write_bytes(data)
                os.replace(part, self.place)
        except OSError as error:
            raise OptionError(_refusal(self.option, self.path, error)) from error

    def deliver(self, content: str | bytes) -> None:
        """Write the file, and name it on stderr."""
        self.write(content)
        say(f"wrote {self.path}")


def check_output(
    option: str, name: str, endings: Sequence[str], *, keep: Iterable[str | None] = ()
) -> OutputFile:
    """Make sure that a file can be written, before any work is done for it.

    Parameters
    ----------
    option : str
        The option that named it, as typed: ``"--figure"``.
    name : str
        The path.
    endings : sequence of str
        What the name may end in, with the dot.
    keep : iterable of str or None
        Files that must not be overwritten: the inputs. What is no file (a missing one, a region
        in numbers, the name of a preset) is passed over.

    Raises
    ------
    OptionError
        If the ending is none of `endings`, the folder is missing or not writable, the path is a
        folder, or it is an input, also by another name or through a link.
    """
    path = Path(name)
    if path.suffix.lower() not in endings:
        found = f'"{path.suffix}"' if path.suffix else "nothing"
        raise OptionError(f"{option} {name} ends in {found}, it has to be {' or '.join(endings)}")
    require_folder(option, name)
    if path.is_dir():
        raise OptionError(f"{option} {name} is a folder: give the name of a file")
    place = _place(path)
    if path.exists() and not path.is_file():
        raise OptionError(f"{option} {name} leads to {place}, no ordinary file: name another")
    if not place.parent.is_dir():
        raise OptionError(
            f"{option} {name} is a link into the folder {place.parent}, which does not exist: make "
            "it first, or remove the link"
        )
    require_own_file(option, name, keep=keep)
    try:
        with _part_path(place) as part:
            part.write_bytes(b"")
    except OSError as error:
        raise OptionError(_refusal(option, path, error)) from error
    return OutputFile(option, path)


def check_optional(
    option: str, name: str | None, endings: Sequence[str], *, keep: Iterable[str | None] = ()
) -> OutputFile | None:
    """The file of `check_output`, or None where none was asked for."""
    return None if name is None else check_output(option, name, endings, keep=keep)


def require_folder(option: str, name: str) -> None:
    """Make sure that the folder of a file is there.

    Raises
    ------
    OptionError
        If it is not.
    """
    folder = Path(name).parent
    if not folder.is_dir():
        raise OptionError(f"{option} {name}: the folder {folder} does not exist, make it first")


def require_own_file(option: str, name: str, *, keep: Iterable[str | None] = ()) -> None:
    """Make sure that what a command writes there overwrites nothing that it reads or writes.

    Parameters
    ----------
    option, name, keep
        As of `check_output`, which calls this; for files that are added to, or of any ending.

    Raises
    ------
    OptionError
        If it is an input or another output of the run, by whatever name, be it there yet or not.
    """
    own = _identities(name)
    for known in keep:
        if known is not None and not own.isdisjoint(_identities(known)):
            raise OptionError(
                f"{option} {name} is the input {known}, which it would overwrite: give another name"
            )
    outputs = _outputs.get()
    if outputs is None:
        return
    for one in own:
        # A command may ask for a file again before it writes it, by the same option.
        other = outputs.setdefault(one, option)
        if other != option:
            raise OptionError(f"{other} and {option} name the same file, {name}: give two")


@contextmanager
def outputs_of_a_run() -> Iterator[None]:
    """What is found writable inside belongs to one run: no two options may name one file."""
    before = _outputs.set({})
    try:
        yield
    finally:
        _outputs.reset(before)


def make_folder(called: str, name: str) -> Path:
    """A folder to write into, made if it does not exist; `called` is what the user knows it as.

    Raises
    ------
    OptionError
        If it cannot be made.
    """
    folder = Path(name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise OptionError(f"{called} {name} cannot be made ({reason}): name a folder") from error
    return folder


def _identities(name: str) -> set[Identity]:
    """What two names of one file share: its path without links, and its number if it is there."""
    found: set[Identity] = set()
    # Words that can be no path at all are refused by the system, and are no file.
    with suppress(OSError, ValueError):
        found.add(os.path.realpath(name))
        about = os.stat(name)
        found.add((about.st_dev, about.st_ino))
    return found


def _place(path: Path) -> Path:
    # Path.resolve raises where links form a loop; realpath leaves that to the writing.
    return Path(os.path.realpath(path))


@contextmanager
def _part_path(place: Path) -> Iterator[Path]:
    """A name on the file system where the content goes, so that a rename puts it in place."""
    # Help, which writes nothing, does without numpy.
    from acutance.execution.partial_folder import partial_folder

    with partial_folder(place) as folder:
        yield Path(folder, place.name)


def _refusal(option: str, path: Path, error: OSError) -> str:
    reason = error.strerror or str(error)
    return f"{option} {path} cannot be written ({reason}): choose a folder you may write to"
