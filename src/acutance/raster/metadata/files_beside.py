"""Which documents beside an image belong to it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from pathlib import Path

__all__ = ["files_beside"]

_TILE = re.compile(r"_R\d+C\d+$", re.IGNORECASE)
_LANDSAT_BAND = re.compile(r"_(?:SR_|ST_)?(?:B\d+(?:_VCID_\d)?|BQA|QA\w*)$", re.IGNORECASE)
_OF_STEM = (".xml", ".imd", ".json", ".dim", "_metadata.xml", "_metadata.json", ".stac.json")
_OF_FOLDER = ("metadata.dim", "item.json", "stac.json", "stac-item.json")
_LANDSAT = ("_mtl.txt", "_mtl.xml", "_mtl.json")
_TILE_FILE = "mtd_tl.xml"
_PRODUCT_FILE = re.compile(r"^mtd_msil(1c|2a)\.xml$")
_ANCESTORS = 5
_MOST_FILES = 20_000


def files_beside(image: str | os.PathLike[str]) -> list[Path]:
    """Documents that may be about an image: what they say of it decides.

    Parameters
    ----------
    image : str or path
        A file; a name of GDAL's own has nothing beside it.
    """
    path = Path(image)
    folder, stem = path.parent, path.stem
    found = list(_in_folder(folder, stem)) if folder.is_dir() else []
    return [*dict.fromkeys([*found, *_above(path)])]


def _in_folder(folder: Path, stem: str) -> Iterator[Path]:
    names = _names(str(folder), folder.stat().st_mtime_ns)
    whole = _TILE.sub("", stem)
    for base in dict.fromkeys((stem, whole)):
        yield from _existing(folder, names, (base.lower() + ending for ending in _OF_STEM))
    product = _LANDSAT_BAND.sub("", stem).lower()
    yield from _existing(folder, names, (product + ending for ending in _LANDSAT))
    if whole.upper().startswith("IMG_"):
        yield from _existing(folder, names, (f"dim_{whole[4:].lower()}.xml",))
    for name in names:
        if name.endswith("_aux.xml") and stem.lower().startswith(name.removesuffix("_aux.xml")):
            yield folder / names[name]
    yield from _existing(folder, names, (*_OF_FOLDER, f"{folder.name.lower()}.json"))


def _existing(folder: Path, names: dict[str, str], wanted: Iterable[str]) -> Iterator[Path]:
    for name in wanted:
        if name in names:
            yield folder / names[name]


@lru_cache(maxsize=64)
def _names(folder: str, modified: int) -> dict[str, str]:
    """Files of a folder by their names in lower case, those of images left out."""
    endings = (".xml", ".imd", ".json", ".dim", ".txt")
    found = (name for name in os.listdir(folder) if name.lower().endswith(endings))
    return {name.lower(): name for name, _ in zip(sorted(found), range(_MOST_FILES), strict=False)}


def _above(path: Path) -> Iterator[Path]:
    """Documents of a Sentinel-2 granule and of its product, in folders above."""
    if "IMG_DATA" not in path.parts and "GRANULE" not in path.parts:
        folders = [path.parent]
    else:
        folders = list(path.parents)[:_ANCESTORS]
    for folder in folders:
        if not folder.is_dir():
            continue
        names = _names(str(folder), folder.stat().st_mtime_ns)
        for name in names:
            if name == _TILE_FILE or _PRODUCT_FILE.match(name):
                yield folder / names[name]
