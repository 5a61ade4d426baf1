"""What came out of a batch."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from acutance.archive.counted import counted
from acutance.archive.elsewhere import ELSEWHERE
from acutance.archive.packing import plain_json
from acutance.archive.restored_images import is_restored
from acutance.batch.reason_words import UNREADABLE, in_words
from acutance.batch.selected_bands import Band, without_band
from acutance.curves.short_repr import ShortRepr

if TYPE_CHECKING:
    from acutance.archive.contradictions import Differing
    from acutance.archive.entry import ImageEntry
    from acutance.archive.outcomes import Outcome
    from acutance.batch.measure_image import MeasuredImage

__all__ = ["BatchSummary", "Tally"]

NO_FILE = "no such file"
"""Why an image that is not there has no measurement."""
_CHANGED = "it was changed while the batch ran, and nothing of it is kept: run the batch again"
VERDICTS = ("good", "usable", "doubtful", "invalid")


@dataclass(frozen=True, eq=False)
class BatchSummary(ShortRepr):
    """Counts of a batch: rows of the archive, those that were there before among them.

    Parameters
    ----------
    archive : str
    images : int
        Of the plan.
    unreadable : tuple of str
        Images that could not be read, or some pixels of them, now or before.
    missing : tuple of str
        Those among them that do not exist.
    faults : mapping of str to str
        By path why an image could not be read.
    copies : mapping of str to str
        Images with the content of another, which stands for them; by path that of the other.
    kept_otherwise : mapping of str to mapping
        By image, and by the name of what is stated of it and is not what the archive has
        ("sensor"): what is kept, and what is stated; what the image says itself by now, by a
        document beside it, where nothing is kept. Rows that are there stay as they are.
    earlier_contents : mapping of str to sequence of str
        By path the contents (SHA-256) that a changed file had before and of which the archive
        still has rows: they count beside the new ones until they are removed.
    restored : tuple of str
        Images read now that were restored or sharpened before, by their tags or documents: their
        numbers are those of the restored product.
    missing_bands : tuple of (str or int)
        Bands that were asked for and that no image has.
    bands : tuple of str
        Those that images have, as "1" or "2 (red)".
    done_before : int
        Rows that were there already.
    kept : int
        Rows that were added.
    verdicts : mapping of str to int
        Measured rows by verdict.
    reasons : mapping of str to int
        Rejected rows by their reason in a word or two.
    measuring_s : float
        Processor time of the measurements, over all workers.
    elapsed_s : float
    run : int or None
        Number of the run in the archive; None if there was nothing to do.
    """

    archive: str
    images: int
    unreadable: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    faults: Mapping[str, str] = field(default_factory=dict)
    copies: Mapping[str, str] = field(default_factory=dict)
    kept_otherwise: Mapping[str, Differing] = field(default_factory=dict)
    earlier_contents: Mapping[str, Sequence[str]] = field(default_factory=dict)
    restored: tuple[str, ...] = ()
    missing_bands: tuple[str | int, ...] = ()
    bands: tuple[str, ...] = ()
    done_before: int = 0
    kept: int = 0
    verdicts: Mapping[str, int] = field(default_factory=dict)
    reasons: Mapping[str, int] = field(default_factory=dict)
    measuring_s: float = 0.0
    elapsed_s: float = 0.0
    run: int | None = None

    @property
    def measured(self) -> int:
        """Rows with a measurement."""
        return sum(self.verdicts.values())

    @property
    def rejected(self) -> int:
        """Rows without one, targets that the images do not show among them."""
        return sum(self.reasons.values())

    @property
    def failed(self) -> int:
        """Rows that ``--strict`` objects to: rejected in their image, doubtful or invalid."""
        elsewhere = sum(self.reasons.get(one, 0) for one in ELSEWHERE)
        weak = self.verdicts.get("doubtful", 0) + self.verdicts.get("invalid", 0)
        return self.rejected - elsewhere + weak

    def summary(self) -> str:
        """Rows, and how they came out."""
        by_verdict = ", ".join(f"{self.verdicts[one]} {one}" for one in self.verdicts)
        otherwise = counted(len(self.kept_otherwise), "image")
        return (
            f"{counted(self.images, 'image')}, {counted(self.kept, 'row')} added, "
            f"{self.done_before} there before; "
            f"measured {self.measured} ({by_verdict or 'none'}), rejected {self.rejected}"
            + (f"; {otherwise} kept otherwise than stated" if self.kept_otherwise else "")
        )

    def to_dict(self) -> dict[str, Any]:
        """All counts, for JSON."""
        return {
            "schema": "acutance/batch/1",
            "archive": self.archive,
            "images": self.images,
            "unreadable": list(self.unreadable),
            "missing": list(self.missing),
            "faults": dict(self.faults),
            "copies": dict(self.copies),
            "kept_otherwise": plain_json(self.kept_otherwise),
            "earlier_contents": {path: list(one) for path, one in self.earlier_contents.items()},
            "restored": list(self.restored),
            "missing_bands": list(self.missing_bands),
            "done_before": self.done_before,
            "kept": self.kept,
            "measured": self.measured,
            "rejected": self.rejected,
            "verdicts": dict(self.verdicts),
            "reasons": dict(self.reasons),
            "measuring_s": round(self.measuring_s, 3),
            "elapsed_s": round(self.elapsed_s, 3),
            "run": self.run,
        }


class Tally:
    """Rows counted while they come."""

    def __init__(self) -> None:
        self.verdicts: Counter[str] = Counter()
        self.reasons: Counter[str] = Counter()
        self.earlier, self.kept, self.measuring_s = 0, 0, 0.0
        self.faults: dict[str, str] = {}
        self.missing: list[str] = []
        self.copies: dict[str, str] = {}
        self.restored: list[str] = []
        self.bands: set[Band] = set()
        self.stated: dict[str, ImageEntry] = {}
        """By keys of rows what is stated of their images."""
        self.said: dict[str, ImageEntry] = {}
        """By keys of rows what their images say of themselves."""
        self.outlived: set[str] = set()
        """Keys of rejections that hold no longer: of files that were missing, dates not known."""

    def add_earlier(self, path: str, rows: Sequence[Outcome]) -> None:
        """Count rows of an image that were there before; one that cannot be read is named again."""
        self.earlier += len(rows)
        for one in rows:
            self._count(one.verdict, one.why)
            if one.verdict is None and in_words(one.why or "") == UNREADABLE:
                self.faults.setdefault(path, one.reason or "")

    def add_image(self, path: str, found: MeasuredImage, new: int) -> None:
        """Count the rows of an image, of which so many were new: another batch may be faster."""
        self.kept += new
        self.earlier += len(found.entries) - new
        self.measuring_s += found.measuring_s
        if found.bands is None:
            self.faults[path] = next((one.rejected.reason for one in found.entries
                                      if one.rejected is not None), _CHANGED)  # fmt: skip
        else:
            self.bands.update(found.bands)
        if found.image is not None and is_restored(found.image.sources):
            self.restored.append(path)
        for entry in found.entries:
            if entry.record is not None:
                self._count(entry.record.verdict.word, None)
            elif entry.rejected is not None:
                why = str(entry.rejected.values.get("why") or entry.rejected.stage)
                self._count(None, why)
                if in_words(why) == UNREADABLE:
                    # The header of a file that is cut off can be read, its pixels cannot.
                    self.faults.setdefault(path, entry.rejected.reason)
                if why == NO_FILE:
                    self.missing.append(path)

    def add_stated(self, keys: Iterable[str], image: ImageEntry | None) -> None:
        """Note what is stated of the image of some rows; None if that is nothing."""
        if image is not None:
            self.stated.update(dict.fromkeys(keys, image))

    def add_said(self, keys: Iterable[str], image: ImageEntry) -> None:
        """Note what the image of some rows says of itself."""
        self.said.update(dict.fromkeys(keys, image))

    def _count(self, verdict: str | None, why: str | None) -> None:
        if verdict is not None:
            self.verdicts[verdict] += 1
        else:
            self.reasons[in_words(why or "rejected")] += 1

    def to_dict(self) -> dict[str, Any]:
        """Counts so far, for JSON."""
        return {
            "kept": self.kept,
            "done_before": self.earlier,
            "verdicts": {one: self.verdicts[one] for one in VERDICTS if self.verdicts[one]},
            "reasons": dict(self.reasons.most_common()),
        }

    def summary(
        self,
        archive: str,
        images: int,
        elapsed_s: float,
        run: int | None,
        bands: Iterable[str | int] = (),
        kept_otherwise: Mapping[str, Differing] | None = None,
        earlier_contents: Mapping[str, Sequence[str]] | None = None,
    ) -> BatchSummary:
        """What came out, verdicts from the best, reasons from the most frequent.

        `bands` are those that were asked for.
        """
        counts = self.to_dict()
        there = sorted(self.bands, key=lambda band: (band.number, band.name or ""))
        return BatchSummary(
            archive=archive,
            images=images,
            unreadable=tuple(self.faults),
            missing=tuple(self.missing),
            faults=self.faults,
            copies=self.copies,
            restored=tuple(self.restored),
            kept_otherwise=kept_otherwise or {},
            earlier_contents=earlier_contents or {},
            missing_bands=without_band(bands, there) if there else (),
            bands=tuple(
                f"{one.number} ({one.name})" if one.name else f"{one.number}" for one in there
            ),
            measuring_s=self.measuring_s,
            elapsed_s=elapsed_s,
            run=run,
            **counts,
        )
