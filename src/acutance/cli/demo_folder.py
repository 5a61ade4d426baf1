"""The folder a demonstration is written into: no file of others is overwritten."""

from __future__ import annotations

import json
from pathlib import Path

from acutance.cli.output import check_output, make_folder
from acutance.errors import OptionError

__all__ = ["FILES", "MARK", "demo_folder", "file_of"]

MARK = "truth.json"
"""Written first: a folder with a scene of ours in it is that of an earlier demonstration."""

_SCHEMA = "acutance/scene/1"
_TARGETS = (
    "vertical edge", "horizontal edge", "pulse tarp", "mirrors", "bars", "star", "combined",
    "landscape",
)  # fmt: skip


def file_of(name: str) -> str:
    """The stem of the files of a target, by its name."""
    return name.replace(" ", "-")


FILES = (
    MARK,
    "site.tif",
    "landscape.tif",
    "landscape.truth.geojson",
    "comparison.json",
    "index.html",
    "targets.geojson",
    "year.html",
    "year.db",
    "site-restored.tif",
    "restoration.json",
    "restoration.html",
    *(f"{file_of(name)}{ending}" for name in _TARGETS for ending in (".html", ".json")),
)
"""Everything that a demonstration writes."""


def demo_folder(name: str) -> Path:
    """The folder, made if it does not exist, and found fit for every file before any work.

    Raises
    ------
    OptionError
        If it cannot be made or written to, or holds files that would be overwritten and that no
        demonstration wrote.
    """
    folder = make_folder("the folder", name)
    there = [file for file in FILES if (folder / file).exists()]
    if there and not _is_demonstration(folder):
        some = ", ".join(there[:3]) + (" and others" if len(there) > 3 else "")
        raise OptionError(
            f"the folder {name} holds {some}, which would be overwritten and which no "
            "demonstration wrote: give another folder, or move them away"
        )
    for file in FILES:
        check_output("DIR", str(folder / file), (Path(file).suffix,))
    return folder


def _is_demonstration(folder: Path) -> bool:
    try:
        document = json.loads((folder / MARK).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(document, dict) and document.get("schema") == _SCHEMA
