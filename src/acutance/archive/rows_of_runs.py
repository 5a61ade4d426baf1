"""What batches and imports ask of an archive and write down, row by row, by keys."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from acutance.archive.connection import Database
from acutance.archive.contradictions import Differing, kept_otherwise
from acutance.archive.entry import ImageEntry
from acutance.archive.outcomes import Outcome, kept_outcomes
from acutance.archive.removing import earlier_contents, remove_images, remove_rejections
from acutance.archive.runs import end_run, kept_keys, start_run
from acutance.arguments import require_kind, require_texts, require_whole

__all__ = ["RowsOfRuns"]


class RowsOfRuns:
    """Runs, and rows by their keys."""

    _database: Database

    def keys(self, *, run: int | None = None, images: Iterable[str] | None = None) -> set[str]:
        """Keys of what is kept, measured or rejected.

        Parameters
        ----------
        run : int, optional
            What this run wrote.
        images : iterable of str, optional
            Of images with this content (SHA-256).
        """
        if run is not None:
            require_whole(0, run=run)
            run = int(run)
        contents = None if images is None else list(require_texts("images", images))
        return kept_keys(self._database, run, contents)

    def outcomes(self, images: Iterable[str]) -> dict[str, Outcome]:
        """How the rows of some images came out, by key: their verdict, or why they have none.

        Parameters
        ----------
        images : iterable of str
            Contents of images (SHA-256).
        """
        return kept_outcomes(self._database, require_texts("images", images))

    def start_run(self, plan: Mapping[str, Any]) -> int:
        """Write down that a run began, with its plan; returns its number."""
        require_kind(Mapping, plan=plan)
        return start_run(self._database, plan)

    def end_run(self, run: int, summary: Mapping[str, Any]) -> None:
        """Write down that a run ended, with its summary."""
        require_whole(0, run=run)
        require_kind(Mapping, summary=summary)
        end_run(self._database, run, summary)

    def kept_otherwise(
        self,
        stated: Mapping[str, ImageEntry],
        said: Mapping[str, ImageEntry] = MappingProxyType({}),
    ) -> dict[str, Differing]:
        """What is known of images and is not what is kept: `correct_images` changes that.

        Parameters
        ----------
        stated : mapping of str to ImageEntry
            By the keys of rows; those that are not there are passed over.
        said : mapping of str to ImageEntry, optional
            By the keys of rows what images say of themselves; it counts where nothing is kept.

        Returns
        -------
        dict of str to mapping
            By the path of the image in the archive, and by the name of what is known ("sensor"):
            what is kept, and what is known.
        """
        require_kind(Mapping, stated=stated, said=said)
        return kept_otherwise(self._database, stated, said)

    def remove_rejections(self, keys: Iterable[str]) -> int:
        """Remove rejections that hold no longer, and images of which nothing else is kept.

        Parameters
        ----------
        keys : iterable of str
            Those of measurements are passed over.

        Returns
        -------
        int
            How many were removed.
        """
        return remove_rejections(self._database, require_texts("keys", keys))

    def earlier_contents(self, now: Mapping[str, str]) -> dict[str, list[str]]:
        """Contents that files had before and of which there still are rows, by path.

        Parameters
        ----------
        now : mapping of str to str
            By path the SHA-256 of the file as it is.

        Returns
        -------
        dict of str to list of str
            SHA-256; paths that have no other content are left out.
        """
        require_kind(Mapping, now=now)
        return earlier_contents(self._database, now)

    def remove_images(self, images: Sequence[str], *, dry_run: bool = False) -> int:
        """Remove images with all their measurements and rejections.

        Parameters
        ----------
        images : sequence of str
            Paths, file names, SHA-256 or patterns.
        dry_run : bool, optional
            Change nothing, count what would go.

        Returns
        -------
        int
            How many measurements and rejections were removed.

        Raises
        ------
        OptionError
            If a name means no image, or a file name that several have: nothing is removed.
        ArchiveError
            If the archive cannot be written.
        """
        return remove_images(self._database, images, dry_run=dry_run)
