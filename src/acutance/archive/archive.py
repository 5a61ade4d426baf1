"""An archive: measurements kept over years, in a file or on a server."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from types import TracebackType
from typing import TYPE_CHECKING, Self, Unpack

from acutance.archive.adding import add_entries, add_entry, record_of
from acutance.archive.connection import open_database
from acutance.archive.contradictions import contradictions
from acutance.archive.dates import When, as_utc
from acutance.archive.entry import Entry, ImageEntry, Kept, TargetEntry
from acutance.archive.image_corrections import CorrectedImage, ImageCorrection, correct_images
from acutance.archive.measurements import (
    Measurements,
    Rejections,
    select_measurements,
    select_rejections,
)
from acutance.archive.migrations import ensure_schema
from acutance.archive.overview import Overview, overview_of
from acutance.archive.questions import Questions
from acutance.archive.restored_images import restored_sources
from acutance.archive.rows_of_runs import RowsOfRuns
from acutance.archive.selection import Selection, SelectionWords
from acutance.archive.stored_entries import select_ids, stored_entries, undamaged_entries
from acutance.arguments import require_flags, require_optional, require_paths, require_whole
from acutance.errors import OptionError
from acutance.targets.measurement import Measurement
from acutance.targets.record import Record

if TYPE_CHECKING:
    from acutance.archive.exchange.importing import Imported
    from acutance.targets.combine import CombinedMeasurement

__all__ = ["Archive"]


class Archive(Questions, RowsOfRuns):
    """Measurements with their images, targets and runs, in a file of SQLite or in PostgreSQL.

    Many processes may add at once; what is added twice is kept once. The tables are made where
    there are none, and those of an older version brought forward.

    Parameters
    ----------
    place : path or str
        A file, or a URL ``postgresql+psycopg://USER@HOST/DATABASE``.
    read_only : bool, optional
        Change nothing, not even the tables of an older version.

    Raises
    ------
    ArchiveError
        If the place is of another program or a newer version, or cannot be reached.

    Examples
    --------
    >>> with ac.Archive("campaign.db") as archive:  # doctest: +SKIP
    ...     archive.add(measurement, sensor="QB02", acquired="2026-05-01", target="Stennis tarp")
    ...     archive.measurements(sensor="QB02", kind="edge").to_pandas()
    """

    def __init__(self, place: str | os.PathLike[str], *, read_only: bool = False) -> None:
        require_flags(read_only=read_only)
        self._database = open_database(place, read_only=read_only)
        try:
            ensure_schema(self._database)
        except BaseException:
            self.close()
            raise

    @property
    def place(self) -> str:
        """Where it is kept: the file, or the URL without its password."""
        return self._database.place

    def close(self) -> None:
        """Close the connections. What was read from the archive stays."""
        self._database.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Archive: {self.place}>"

    def add(
        self,
        measurement: Measurement | Record,
        *,
        sensor: str | None = None,
        acquired: When | None = None,
        target: str | TargetEntry | None = None,
        image: ImageEntry | None = None,
        band: str | None = None,
        key: str | None = None,
        run: int | None = None,
    ) -> Kept:
        """Keep a measurement.

        Parameters
        ----------
        measurement : Measurement or Record
        sensor : str, optional
        acquired : datetime, date or str, optional
            When the image was taken; without a time zone UTC.
        target : str or TargetEntry, optional
            Without it the name of the measured region, if it has one.
        image : ImageEntry, optional
            What is known of the image, instead of `sensor` and `acquired`.
        band : str, optional
            The name of the band, "pan"; without it that of the image, or the number of one of
            several bands without a name.
        key : str, optional
            What makes it the same as one that is kept; see `acutance.archive.identity`.
        run : int, optional
            Of `start_run`.

        Returns
        -------
        Kept
            The number of its row, and whether it was new.

        Raises
        ------
        OptionError
            If it is no measurement, or described twice, or kept already with another sensor, date
            or level than is stated now: `correct_images` changes what is kept.
        ArchiveError
            If it cannot be kept.
        """
        record = record_of(measurement)
        if image is not None and (sensor is not None or acquired is not None):
            raise OptionError("sensor and acquired are part of image: give them there")
        if image is None:
            image = ImageEntry(
                path=record.image.path,
                sensor=sensor,
                acquired=None if acquired is None else as_utc(acquired, "acquired"),
                gsd_m=record.image.pixel_gsd_m,
                sources=restored_sources(record),
            )
        if target is None:
            target = record.image.region
        if isinstance(target, str):
            target = TargetEntry(name=target, kind=record.kind)
        if not isinstance(target, TargetEntry | None):
            raise OptionError(f"target is a {type(target).__name__}: give a name or a TargetEntry")
        if band is None:
            band = record.image.band_told_apart
        entry = Entry(record=record, image=image, target=target, band=band, key=key)
        kept = add_entry(self._database, entry, run)
        if not kept.new:
            for reason in contradictions(self._database, {kept.key: image}).values():
                raise OptionError(reason)
        return kept

    def add_entries(
        self,
        entries: Iterable[Entry],
        *,
        run: int | None = None,
        progress: Callable[[int], None] | None = None,
    ) -> int:
        """Keep entries, measured and rejected, in transactions of two thousand.

        Parameters
        ----------
        entries : iterable of Entry
        run : int, optional
            Of `start_run`.
        progress : callable, optional
            Called after each transaction with how many were read.

        Returns
        -------
        int
            How many were new.

        Raises
        ------
        OptionError, ArchiveError
            If one cannot be kept; transactions before stay.
        """
        return add_entries(self._database, entries, run, progress)

    def correct_images(
        self, corrections: Iterable[ImageCorrection], *, dry_run: bool = False
    ) -> list[CorrectedImage]:
        """Correct what is known of images that are kept already, all of them or none.

        Measurements stay as they are, and batches do not make them again.

        Parameters
        ----------
        corrections : iterable of ImageCorrection
            Later ones go before earlier ones; two names of one image must not give it two values.
        dry_run : bool, optional
            Change nothing, only return what would change.

        Returns
        -------
        list of CorrectedImage
            Images of which something changes.

        Raises
        ------
        OptionError
            If a correction means no image, or a file name that several have, or two of them give
            one image two values under different names.
        """
        return correct_images(self._database, corrections, dry_run=dry_run)

    def measurements(self, **selection: Unpack[SelectionWords]) -> Measurements:
        """Measurements as columns, a row for each measurement and direction.

        Parameters
        ----------
        **selection
            Filters: fields of `acutance.archive.selection.Selection`.

        Raises
        ------
        OptionError
            If there is no such filter, or a value it cannot have.
        """
        return select_measurements(self._database, Selection.of(selection))

    def entries(self, **selection: Unpack[SelectionWords]) -> Iterator[Entry]:
        """Measurements and rejections as they were added, with their images and targets.

        Those whose documents are damaged are left out; a warning at the end names them.

        Parameters
        ----------
        **selection
            Filters, as of `measurements`.
        """
        ids = select_ids(self._database, Selection.of(selection))
        return undamaged_entries(self._database, ids)

    def entry(self, number: int) -> Entry:
        """What was added under a number (`Kept.id`, or the column "id").

        Raises
        ------
        OptionError
            If there is none, or it is no whole number.
        ArchiveError
            If its document is damaged.
        """
        require_whole(0, number=number)
        # SQLite knows no whole numbers of numpy, which a column "id" has.
        number = int(number)
        found = list(stored_entries(self._database, [number]))
        if not found:
            raise OptionError(f"there is no measurement {number} in the archive")
        return found[0]

    def overview(self) -> Overview:
        """How many measurements, rejections, images and targets, by sensor."""
        return overview_of(self._database)

    def combine(self, **selection: Unpack[SelectionWords]) -> CombinedMeasurement:
        """What the selected measurements of one sensor say together, see `acutance.combine`.

        Parameters
        ----------
        **selection
            Filters, as of `measurements`. A measurement is taken with all its directions.

        Raises
        ------
        OptionError
            If there are none, or they cannot be combined.
        """
        from acutance.targets.combine import combine

        records = self.measurements(**selection).records()
        if not records:
            raise OptionError("the selection holds no measurement to combine: widen it")
        return combine(records)

    def export(
        self,
        place: str | os.PathLike[str],
        *,
        to: str,
        progress: Callable[[int, int], None] | None = None,
        **selection: Unpack[SelectionWords],
    ) -> int:
        """Write measurements and rejections into a file.

        Parameters
        ----------
        place : path
            A file; of "stac" a new folder.
        to : {"jsonl", "parquet", "csv", "csv-documents", "stac"}
            All but "csv" lose nothing, and can be imported.
        progress : callable, optional
            Called with how many of how many were read.
        **selection
            Filters, as of `measurements`.

        Returns
        -------
        int
            How many were written.

        Raises
        ------
        OptionError
            If a library is missing, or the place cannot be written or is that of an archive.
        """
        from acutance.archive.exchange.exporting import export_entries

        return export_entries(self._database, Selection.of(selection), place, to, progress)

    def import_documents(
        self,
        paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
        *,
        sensor: str | None = None,
        level: str | None = None,
        acquired: When | None = None,
        target: str | TargetEntry | None = None,
        band: str | None = None,
        run: int | None = None,
        progress: Callable[[int], None] | None = None,
    ) -> Imported:
        """Add documents of files: what commands print with ``--json``, and what `export` wrote.

        Parameters
        ----------
        paths : path or iterable of path
            JSON, JSON lines, CSV with documents, Parquet, and folders of them or of STAC.
        sensor, level, acquired, target, band : optional
            Of documents that do not know it; what was exported has its own.
        run : int, optional
            Of `start_run`.
        progress : callable, optional
            Called now and then with how many entries were read.

        Returns
        -------
        Imported
            How many were read, how many were new, and which files were refused: also those whose
            measurements are kept already with another sensor, date or level than is stated now.

        Raises
        ------
        OptionError
            If an argument is of the wrong kind.
        """
        require_optional(str, sensor=sensor, level=level, band=band)
        from acutance.archive.exchange.documents import Stated
        from acutance.archive.exchange.importing import import_files

        stated = Stated(
            sensor=sensor,
            level=level,
            band=band,
            acquired=None if acquired is None else as_utc(acquired, "acquired"),
            target=target,
        )
        several = [paths] if isinstance(paths, str | os.PathLike) else require_paths("paths", paths)
        return import_files(self._database, several, stated, run, progress)

    def rejected(self, **selection: Unpack[SelectionWords]) -> Rejections:
        """What was not measured, and why, as columns.

        Parameters
        ----------
        **selection
            Filters, as of `measurements`; not those of directions, verdicts and numbers.
        """
        return select_rejections(self._database, Selection.of(selection))
