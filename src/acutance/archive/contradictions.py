"""What is stated of a measurement that is kept already, where the archive has something else.

A measurement is kept once, whatever is stated of its image: the key does not depend on it
(`acutance.archive.identity`), so that corrections make no measurement another one. What is stated
anew is therefore not written, and has to be told.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from datetime import datetime, time
from functools import partial
from types import MappingProxyType
from typing import Any, Final

from sqlalchemy import Connection, select

from acutance.archive.connection import Database, in_chunks
from acutance.archive.entry import ImageEntry
from acutance.archive.rows import image_row
from acutance.archive.tables import images, measurements

__all__ = ["Differing", "contradictions", "in_words", "kept_otherwise", "written"]

Differing = Mapping[str, tuple[Any, Any]]
"""By name: what is kept, and what is stated."""
Comparison = Callable[[Mapping[str, Any], Mapping[str, Any]], Iterator[tuple[str, tuple[Any, Any]]]]

_STATED: Final = (
    "sensor", "level", "acquired", "view_zenith_deg", "view_azimuth_deg", "sun_elevation_deg",
    "sun_azimuth_deg",
)  # fmt: skip
"""What callers state of an image; the GSD is that of the measurement."""
_GSD: Final = ("gsd_row_m", "gsd_col_m")


def contradictions(database: Database, stated: Mapping[str, ImageEntry]) -> dict[str, str]:
    """What is stated of images and is not what is kept, by the keys of their measurements.

    Parameters
    ----------
    database : Database
    stated : mapping of str to ImageEntry
        By the keys of measurements that are kept.

    Returns
    -------
    dict of str to str
        A sentence each, with both; keys without a contradiction are left out.
    """
    found: dict[str, str] = {}
    for row, differing in _contradicting(database, stated, _differing):
        found[row["key"]] = (
            f"the archive has this measurement already, as number {row['id']}, with "
            f"{in_words(differing)}, and keeps a measurement once: {_advice(row)}"
        )
    return found


def kept_otherwise(
    database: Database,
    stated: Mapping[str, ImageEntry],
    said: Mapping[str, ImageEntry] = MappingProxyType({}),
) -> dict[str, Differing]:
    """What is known of images and is not what is kept, by the paths that the archive has.

    Parameters
    ----------
    database : Database
    stated : mapping of str to ImageEntry
        By keys; those that are not there are passed over.
    said : mapping of str to ImageEntry, optional
        By keys what images say of themselves, which counts where nothing is kept: values that
        are kept may have been corrected.

    Returns
    -------
    dict of str to mapping
        By image, and by the name of what is known: what is kept, and what is known.
    """
    found: dict[str, Differing] = {}
    for row, differing in _contradicting(database, stated, _differing):
        image = _name(row)
        found[image] = {**found.get(image, {}), **differing}
    for row, differing in _contradicting(database, said, _new):
        image = _name(row)
        found[image] = {**differing, **found.get(image, {})}
    return dict(sorted(found.items()))


def _name(row: Mapping[str, Any]) -> str:
    return str(row["path"] or row["content"] or f"image {row['image_id']}")


def in_words(differing: Differing) -> str:
    """Values that are kept, and those that are stated."""
    return " and ".join(
        f"{name} {written(kept)}, not {written(stated)}"
        for name, (kept, stated) in differing.items()
    )


def _contradicting(
    database: Database, stated: Mapping[str, ImageEntry], compare: Comparison
) -> Iterator[tuple[Mapping[str, Any], Differing]]:
    """Rows of measurements and their images, with what is stated otherwise."""
    # All rows of an image of a batch have one entry: it is made a row once.
    entries = {id(one): one for one in stated.values()}
    rows = {own: image_row(one) for own, one in entries.items()}
    for some in in_chunks(stated):
        for row in database.read(partial(_kept, keys=some)):
            differing = dict(compare(row, rows[id(stated[row["key"]])]))
            if differing:
                yield row, differing


def _kept(connection: Connection, keys: list[str]) -> list[Mapping[str, Any]]:
    """What is kept of the images of some measurements."""
    asked = (
        select(
            measurements.c.key,
            measurements.c.id,
            measurements.c.image_id,
            *(images.c[name] for name in ("name", "path", "content", *_STATED, *_GSD)),
        )
        .join(images, images.c.id == measurements.c.image_id)
        .where(measurements.c.key.in_(keys))
    )
    return [dict(row) for row in connection.execute(asked).mappings()]


def _differing(
    kept: Mapping[str, Any], stated: Mapping[str, Any]
) -> Iterator[tuple[str, tuple[Any, Any]]]:
    """What is stated and is not what is kept, by name."""
    for name in _STATED:
        if stated[name] is not None and not _agree(kept[name], stated[name]):
            yield name, (kept[name], stated[name])


def _new(kept: Mapping[str, Any], said: Mapping[str, Any]) -> Iterator[tuple[str, tuple[Any, Any]]]:
    """What is known where nothing is kept, by name."""
    for name in _STATED:
        if kept[name] is None and said[name] is not None:
            yield name, (None, said[name])
    row_m, col_m = (said[name] for name in _GSD)
    if kept[_GSD[0]] is None and row_m is not None:
        yield "gsd_m", (None, (row_m, col_m))


def _agree(kept: Any, stated: Any) -> bool:
    """Whether what is stated is kept: of a day, which is written as its beginning, any time."""
    if isinstance(kept, datetime) and isinstance(stated, datetime) and stated.time() == time.min:
        return kept.date() == stated.date()
    return bool(kept == stated)


def _advice(row: Mapping[str, Any]) -> str:
    if row["name"] is None:
        return (
            "its image has no name to correct it by, give it a key of its own (key=) to keep both"
        )
    return (
        f"correct the image {row['name']} where the archive is wrong (acutance archive correct, "
        "correct_images)"
    )


def written(value: Any) -> str:
    """A value of an image, as `archive correct` reads it."""
    if value is None:
        return "not known"
    return value.isoformat() if hasattr(value, "isoformat") else str(value)
