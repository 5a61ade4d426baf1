"""Rows that were added without the name of their band get one.

A name that is given to all unnamed rows of an image must not make one of two bands: the number of
the band is in every document, and an image with several numbers is refused.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from sqlalchemy import Connection, select, update

from acutance.archive.connection import in_chunks
from acutance.archive.packing import unpacked
from acutance.archive.tables import documents, measurements
from acutance.errors import OptionError

__all__ = ["name_bands", "require_one_band", "unnamed_rows"]

_MANY = 500
"""Documents in one answer."""


def unnamed_rows(connection: Connection, image_ids: Collection[int]) -> set[int]:
    """Images, among some, that have rows without the name of a band."""
    found: set[int] = set()
    for some in in_chunks(image_ids):
        asked = select(measurements.c.image_id).distinct()
        asked = asked.where(measurements.c.image_id.in_(some), measurements.c.band.is_(None))
        found.update(connection.execute(asked).scalars())
    return found


def require_one_band(connection: Connection, images: Sequence[Mapping[str, Any]]) -> None:
    """Refuse images with rows of several bands, by their numbers.

    Parameters
    ----------
    connection : Connection
    images : sequence of mapping
        Rows of the table of images; those of one content are one image.

    Raises
    ------
    OptionError
        If there is one.
    """
    names = {row["id"]: str(row["path"] or row["content"] or row["id"]) for row in images}
    contents = {row["id"]: row["content"] or row["id"] for row in images}
    numbers: dict[str | int, set[int]] = {}
    for image_id, number in _numbers_of_bands(connection, names):
        own = numbers.setdefault(contents[image_id], set())
        own.add(number)
        if len(own) > 1:
            listed = " and ".join(map(str, sorted(own)))
            raise OptionError(
                f"nothing is corrected: {names[image_id]} was measured in bands {listed}, and one "
                "name would make one band of them: add its measurements anew, with names "
                "(archive import --band NAME; band_names below [[stated]] of a batch)"
            )


def name_bands(connection: Connection, bands: Mapping[int, str]) -> None:
    """Name the band of all rows without one, by the numbers of images."""
    for band in dict.fromkeys(bands.values()):
        for some in in_chunks([number for number, one in bands.items() if one == band]):
            named = update(measurements).values(band=band)
            named = named.where(measurements.c.band.is_(None), measurements.c.image_id.in_(some))
            connection.execute(named)


def _numbers_of_bands(
    connection: Connection, image_ids: Collection[int]
) -> Iterator[tuple[int, int]]:
    """The image and the number of the band of all rows that have one."""
    columns = (
        measurements.c.id, measurements.c.image_id, measurements.c.rejected_values,
        documents.c.document,
    )  # fmt: skip
    joined = measurements.outerjoin(documents)
    for some in in_chunks(image_ids, _MANY):
        asked = select(*columns).select_from(joined).where(measurements.c.image_id.in_(some))
        for row_id, image_id, values, document in connection.execute(asked):
            stated = values or {} if document is None else unpacked(document, row_id)["image"]
            number = str(stated.get("band", ""))
            if number.isdecimal():
                yield image_id, int(number)
