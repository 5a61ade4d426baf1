"""What makes a row of an archive the same: the image's content, the target, the band, the options.

When it was measured, by which version and from which folder does not count.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from acutance.batch.image_list import content_of
from acutance.batch.plan_options import ChosenOptions
from acutance.raster.linearization import table_of
from acutance.raster.surveyed_targets import SurveyedTarget

__all__ = [
    "Reading",
    "day_of",
    "reading_of",
    "row_key",
    "statement_digest",
    "target_digest",
    "unreadable_key",
]

_FREE = ("description", "source")


def target_digest(target: SurveyedTarget, chosen: ChosenOptions) -> str:
    """Of a target as it is described, and of how it is measured."""
    definition = dict(target.definition)
    properties = dict(definition.get("properties") or {})
    definition["properties"] = {key: one for key, one in properties.items() if key not in _FREE}
    return _digest({"name": target.name, "target": definition, "options": chosen.document})


@dataclass(frozen=True)
class Reading:
    """Digests of how an image is read.

    Parameters
    ----------
    pixels : str
        Of how its pixels are.
    at_height : str
        Together with the stated height of the ground.
    """

    pixels: str
    at_height: str

    def of(self, target: SurveyedTarget, by_rpc: bool) -> str:
        """The digest for a target: a height counts where the target is placed by it."""
        is_placed = bool(target.points) and not target.in_pixels
        by_height = by_rpc and is_placed and target.height_m is None
        return self.at_height if by_height else self.pixels


def reading_of(stated: Mapping[str, Any]) -> Reading:
    """The digests of what is stated of an image; of a table of a curve its content counts."""
    at_height = {key: one for key, one in stated.items() if one is not None}
    table = table_of(at_height.get("linearize"))
    if table is not None:
        at_height["linearize"] = content_of(table) or table
    pixels = {key: one for key, one in at_height.items() if key != "height_m"}
    return Reading(_digest(pixels), _digest(at_height))


def statement_digest(stated: Mapping[str, Any]) -> str:
    """Of what is stated of an image, None left out: bands and day are found out by it."""
    return _digest({key: one for key, one in stated.items() if one is not None})


def row_key(content: str, reading: str, target: str, band: int, day: str | None) -> str:
    """The key of a row.

    Parameters
    ----------
    content : str
        SHA-256 of the image.
    reading, target : str
        Digests of how it is read, and of the target with its options.
    band : int
    day : str or None
        Of the acquisition, for a target that is there at times only.
    """
    parts = f"{content}/{reading}/{target}/{band}/{day or ''}"
    return hashlib.sha256(parts.encode()).hexdigest()


def day_of(target: SurveyedTarget, day: str | None) -> str | None:
    """The day of an image, where it decides whether the target is there."""
    return None if target.valid_from is None and target.valid_to is None else day


def unreadable_key(content: str | None, path: str) -> str:
    """The key of the one row of an image that cannot be read.

    Parameters
    ----------
    content : str or None
        SHA-256 of the image.
    path : str
        Where its content is not known: the absolute path, since many folders have images of one
        name. Version 0.1 took the path as it was typed.
    """
    # Names of files may be no UTF-8.
    text = f"unreadable/{content or path}".encode("utf-8", "backslashreplace")
    return hashlib.sha256(text).hexdigest()


def _digest(document: Any) -> str:
    text = json.dumps(document, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()
