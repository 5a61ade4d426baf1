"""How what is kept came out, row by row: what a batch asks before it begins."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any, NamedTuple

from sqlalchemy import Connection, Select, select

from acutance.archive.connection import Database, in_chunks
from acutance.archive.tables import VERDICTS, images, measurements

__all__ = ["Outcome", "kept_outcomes"]

_MANY = 500
"""Images that one question names."""


class Outcome(NamedTuple):
    """How a row came out.

    Attributes
    ----------
    content : str or None
        SHA-256 of its image.
    verdict : str or None
        None for a rejection.
    why : str or None
        Of a rejection: in a word or two, else its stage.
    reason : str or None
        The same in full.
    has_gsd : bool
        Whether a GSD of its image is kept.
    """

    content: str | None
    verdict: str | None
    why: str | None
    reason: str | None
    has_gsd: bool


def kept_outcomes(database: Database, contents: Iterable[str]) -> dict[str, Outcome]:
    """Rows of images with some contents, by key.

    Parameters
    ----------
    database : Database
    contents : iterable of str
        SHA-256 of the images.

    Raises
    ------
    ArchiveError
        If the archive cannot be read.
    """
    found: dict[str, Outcome] = {}
    columns = (
        measurements.c.key,
        images.c.content,
        measurements.c.verdict,
        measurements.c.stage,
        measurements.c.rejected_values,
        measurements.c.reason,
        images.c.gsd_row_m,
    )
    for some in in_chunks(contents, _MANY):
        asked = select(*columns).join(images).where(images.c.content.in_(some))
        for key, content, verdict, stage, values, reason, gsd_m in database.read(
            partial(_rows, asked=asked)
        ):
            word = None if verdict is None else VERDICTS[verdict]
            why = None if word is not None else str((values or {}).get("why") or stage)
            found[key] = Outcome(content, word, why, reason, gsd_m is not None)
    return found


def _rows(connection: Connection, asked: Select[Any]) -> list[Any]:
    return list(connection.execute(asked))
