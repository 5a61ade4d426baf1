"""Images that were restored or sharpened before they were measured, by the notes kept of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import ColumnElement, String, cast

from acutance.archive.columns import Columns
from acutance.archive.counted import counted
from acutance.archive.tables import images
from acutance.raster.restored_tag import OF_RESTORED
from acutance.targets.record import Record

__all__ = ["RESTORED_COLUMN", "is_restored", "restored_notes", "restored_sources"]

RESTORED_COLUMN: ColumnElement[bool] = cast(images.c.sources, String).contains(OF_RESTORED)
"""Whether the notes of an image say that it was restored."""


def is_restored(sources: Mapping[str, Any]) -> bool:
    """Whether the sources of an image have a note that it was restored."""
    notes = sources.get("notes")
    return isinstance(notes, list) and any(OF_RESTORED in str(one) for one in notes)


def restored_sources(record: Record) -> dict[str, Any]:
    """The sources of an image that is known by a measurement alone: a note if it was restored."""
    applied = record.image.restored
    return {} if applied is None else {"notes": [f"restored by {applied}: {OF_RESTORED}"]}


def restored_notes(rows: Columns, mask: NDArray[np.bool_]) -> Iterator[str]:
    """The note of a mean over images of which some were restored.

    Parameters
    ----------
    rows : Columns
        Of `acutance.Archive.measurements`.
    mask : (n,) bool array
        Which of the rows are meant.
    """
    restored = rows.columns.get("restored")
    if restored is None:
        return
    every = np.unique(rows["image_id"][mask]).size
    sharpened = np.unique(rows["image_id"][mask & restored]).size
    if not sharpened:
        return
    if sharpened == every:
        yield "The images were restored before: the numbers are those of the restored product."
    else:
        yield (
            f"{counted(sharpened, 'image')} of {every} {'was' if sharpened == 1 else 'were'} "
            "restored before, and so sharpened, and are mixed with the others: where they have a "
            "level of their own (acutance archive correct --image NAME --level restored), they are "
            "another product."
        )
