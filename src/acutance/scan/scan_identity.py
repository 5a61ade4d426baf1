"""What a scan is of: anything that changes an edge changes it."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from acutance.raster import Box, Gsd, Image, Region
from acutance.raster.disk_copy import named_from_root
from acutance.scan.options import ScanOptions

__all__ = ["difference", "scan_identity"]

_OF_THE_ANSWER = ("limits", "places", "target_softness_m", "target_softness_px")
"""Options that change no edge."""
_STRIP_PIXELS = 2**21
_WORDS = {
    "version": "version of acutance",
    "images": "image or band",
    "modified": "image, as it was before it changed",
    "box": "region",
    "region": "region",
    "gsd": "GSD",
}
_IMAGE_WORDS = {
    "path": "name of the image",
    "band": "band",
    "nodata": "nodata value (nodata, --nodata)",
    "saturation_level": "saturation level",
    "curve": "characteristic curve (linearize, --gamma, --linearize)",
}


def scan_identity(
    images: Sequence[Image],
    box: Box,
    region: Region | None,
    gsd: Gsd | None,
    options: ScanOptions,
) -> dict[str, Any]:
    """What is scanned, and how, for JSON.

    Files are identified by name, size and time of change, pixels in memory by a checksum.

    Parameters
    ----------
    images : sequence of Image
        The bands.
    box : Box
        The part that is read.
    region : Region or None
        The part of it that is used.
    gsd : Gsd or None
        Instead of the images' own.
    options : ScanOptions
    """
    from acutance import __version__

    own = _content(options)
    return {
        "version": __version__,
        "images": [_image(image) for image in images],
        "modified": [_modified(image) for image in images],
        "box": list(box.as_tuple()),
        "region": _content(region),
        "gsd": _content(gsd),
        **{name: value for name, value in own.items() if name not in _OF_THE_ANSWER},
    }


def difference(one: Mapping[str, Any], other: Mapping[str, Any]) -> str | None:
    """What two scans differ in first, in a word or two; None if they are one."""
    for name in dict.fromkeys((*one, *other)):
        # As text: NaN, a nodata value, equals itself there.
        if json.dumps(one.get(name)) != json.dumps(other.get(name)):
            words = _WORDS.get(name, name)
            if name == "images":
                return _difference_of_images(one.get(name), other.get(name)) or words
            return words
    return None


def _difference_of_images(some: Any, others: Any) -> str | None:
    """What the images of two scans differ in, where that is one thing with a name."""
    if not (isinstance(some, list) and isinstance(others, list)):
        return None
    if len(some) != len(others):
        return "number of bands"
    found = {
        name
        for one, other in zip(map(_reading, some), map(_reading, others), strict=True)
        for name in (*one, *other)
        if json.dumps(one.get(name)) != json.dumps(other.get(name))
    }
    return next((words for name, words in _IMAGE_WORDS.items() if name in found), None)


def _reading(image: Mapping[str, Any]) -> dict[str, Any]:
    """How an image is read, that behind a characteristic curve beside the curve."""
    return {**image.get("source", {}), **image}


def _image(image: Image) -> Any:
    """An image by its name and how it is read; one in memory by its pixels."""
    named = named_from_root(image)
    if image.path is None:
        return {"pixels": _checksum(image), "saturation_level": image.saturation_level}
    return {"shape": list(image.shape), "band": image.band, **_content(named.source)}


def _modified(image: Image) -> Any:
    """What changes with the content of a file."""
    if image.path is None:
        return None
    try:
        found = os.stat(image.path)
    except OSError:
        # A name of GDAL's own: inside a packed file, at another host.
        return _checksum(image)
    return [found.st_size, found.st_mtime_ns]


def _checksum(image: Image) -> str:
    """Of all pixels, as they are read."""
    rows, cols = image.shape
    step = max(1, _STRIP_PIXELS // cols)
    found = hashlib.sha256(repr(image.shape).encode())
    for row in range(0, rows, step):
        found.update(image.read(Box(row, 0, min(step, rows - row), cols)).tobytes())
    return found.hexdigest()


def _content(thing: Any) -> Any:
    """Anything made of dataclasses, numbers, text and arrays, for JSON; arrays as checksums."""
    if is_dataclass(thing):
        return {one.name: _content(getattr(thing, one.name)) for one in fields(thing)}
    if isinstance(thing, np.ndarray):
        values = np.ascontiguousarray(thing)
        return hashlib.sha256(repr(values.shape).encode() + values.tobytes()).hexdigest()
    if isinstance(thing, Mapping):
        return {str(name): _content(one) for name, one in thing.items()}
    if isinstance(thing, tuple | list):
        return [_content(one) for one in thing]
    return thing.item() if isinstance(thing, np.generic) else thing
