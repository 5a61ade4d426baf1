"""The images of a batch: files of paths and patterns, and what identifies their contents."""

from __future__ import annotations

import glob
import hashlib
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

from acutance.batch.plan import StatedOfImages, is_plan_file
from acutance.errors import OptionError
from acutance.raster.metadata.files_beside import files_beside

__all__ = ["ImageFile", "content_of", "list_images", "require_stated_images", "stated_of"]

_BLOCK_BYTES = 2**20


@dataclass(frozen=True)
class ImageFile:
    """An image of a batch.

    Parameters
    ----------
    path : str
    stamp : str
        Sizes and times of change of the file and the documents beside it: while it stays the
        same, so does what is remembered of the image. Empty if there is no such file.
    size : int
        Bytes.
    changed_ns : int
        When it was changed last.
    """

    path: str
    stamp: str
    size: int
    changed_ns: int = 0

    @property
    def has_changed(self) -> bool:
        """Whether it is another file by now, or gone."""
        try:
            now = os.stat(self.path)
        except OSError:
            return True
        return (now.st_size, now.st_mtime_ns) != (self.size, self.changed_ns)


def list_images(patterns: Iterable[str]) -> list[ImageFile]:
    """The images of paths and patterns, each once, in their order.

    Raises
    ------
    OptionError
        If a pattern matches no file, a path is a folder or a plan, or there are no images. Folders
        with the names of files are images that cannot be read, unless there are no others.
    """
    found: dict[str, ImageFile] = {}
    empty, folders, plans = [], [], []
    for pattern in patterns:
        is_path = os.path.exists(pattern) or not glob.has_magic(pattern)
        paths = [pattern] if is_path else sorted(glob.glob(pattern, recursive=True))
        if not paths:
            empty.append(pattern)
        for path in paths:
            if is_plan_file(path):
                plans.append(path)
            elif is_path and os.path.isdir(path) and not _is_called_a_file(path):
                folders.append(path)
            elif is_path or os.path.isfile(path) or _leads_nowhere(path):
                found.setdefault(os.path.realpath(path), _image_file(path))
    called = [one.path for one in found.values() if os.path.isdir(one.path)]
    if len(called) == len(found):
        folders += called
    faults = [
        *_fault("no file matches", empty, "correct the names of the images"),
        *_fault("no images but folders:", folders, f"write {_inside(folders)}"),
        *_fault("no images but plans:", plans, "give a plan alone, it names its images"),
    ]
    if faults:
        raise OptionError("; ".join(faults))
    if not found:
        raise OptionError("there are no images: name files, or a pattern such as images/*.tif")
    return list(found.values())


def _is_called_a_file(folder: str) -> bool:
    """Whether a folder has the name of a file: a shell's *.tif names it among images.

    It is refused by itself, as an image that cannot be read, and the others are measured.
    """
    return bool(os.path.splitext(folder.rstrip(os.sep))[1])


def _leads_nowhere(path: str) -> bool:
    """Whether a path is a link to what is not there: an image that is missing, and no folder."""
    return os.path.islink(path) and not os.path.exists(path)


def _fault(what: str, paths: Sequence[str], advice: str) -> list[str]:
    return [f"{what} {', '.join(paths)}: {advice}"] if paths else []


def _inside(folders: Sequence[str]) -> str:
    """Patterns of the images in folders, as examples."""
    return " ".join(os.path.join(folder, "*.tif") for folder in folders)


def _image_file(path: str) -> ImageFile:
    try:
        own = os.stat(path)
    except OSError:
        return ImageFile(path, "", 0)
    beside = [(one.name, *_stat(one)) for one in files_beside(path)]
    stamp = repr([own.st_size, own.st_mtime_ns, beside])
    return ImageFile(path, stamp, own.st_size, own.st_mtime_ns)


def _stat(path: Path) -> tuple[int, int]:
    try:
        found = path.stat()
    except OSError:
        return 0, 0
    return found.st_size, found.st_mtime_ns


def content_of(path: str) -> str | None:
    """SHA-256 of a file's bytes; None if they cannot be read."""
    digest = hashlib.sha256()
    try:
        with open(path, "rb") as file:
            while block := file.read(_BLOCK_BYTES):
                digest.update(block)
    except OSError:
        return None
    return digest.hexdigest()


def require_stated_images(files: Sequence[ImageFile], stated: Sequence[StatedOfImages]) -> None:
    """Refuse patterns of the plan by which something is stated of no image.

    Raises
    ------
    OptionError
        If there are some: they are mistyped, and what they state would go unsaid.
    """
    for number, one in enumerate(stated, start=1):
        idle = [name for name in one.images if not any(_matches(file.path, name) for file in files)]
        if idle:
            raise OptionError(
                f"stated {number} is of images that match {', '.join(idle)}, and none does: "
                "correct the names, or leave them out"
            )


def stated_of(path: str, stated: Sequence[StatedOfImages]) -> StatedOfImages:
    """What the plan states of one image: all that match it, later ones before earlier ones."""
    values: dict[str, object] = {}
    for one in stated:
        if not one.images or any(_matches(path, pattern) for pattern in one.images):
            values.update({name: value for name, value in vars(one).items() if value is not None})
    values.pop("images", None)
    return StatedOfImages(**values)  # type: ignore[arg-type]


def _matches(path: str, pattern: str) -> bool:
    """Whether a path is that of a pattern, by its end: "K3_*.tif" matches in every folder."""
    wanted = [Path(os.path.abspath(pattern)).parts]
    if not os.path.isabs(pattern):
        wanted.append(("**", *Path(pattern).parts))
    ways = [Path(os.path.abspath(path)).parts, Path(os.path.realpath(path)).parts]
    return any(_parts_match(way, one) for way in ways for one in wanted)


def _parts_match(parts: Sequence[str], wanted: Sequence[str]) -> bool:
    """Whether folders and a name are those of a pattern, in which ** is any number of folders."""
    if not wanted:
        return not parts
    if wanted[0] == "**":
        return any(_parts_match(parts[start:], wanted[1:]) for start in range(len(parts) + 1))
    return bool(parts) and fnmatch(parts[0], wanted[0]) and _parts_match(parts[1:], wanted[1:])
