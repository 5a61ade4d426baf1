"""The light half of a measurement: numbers, curves, covariance, checks and provenance, no pixels.

A `Record` is the JSON document ``acutance/measurement/1`` with names to read it by. It is what
files, archives, pages and combinations keep of a measurement; stored it takes some ten kB.
"""

from __future__ import annotations

import json
import lzma
import math
import pickle
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from acutance.curves import METRICS
from acutance.curves.direction import gsd_along
from acutance.curves.short_repr import ShortRepr
from acutance.errors import OptionError
from acutance.raster.band_label import label_band
from acutance.raster.image import AlongTrack
from acutance.targets.check import Check, HasChecks, count_failed
from acutance.targets.directions import HasDirections
from acutance.targets.document_fields import refuse_damaged, require_document
from acutance.targets.recorded_direction import RecordedDirection
from acutance.targets.slices import OtfSlices
from acutance.targets.uncertainty_budget import BudgetTerm

__all__ = [
    "SCHEMA",
    "ImageInfo",
    "Record",
    "rounded",
    "strict_json",
]

SCHEMA = "acutance/measurement/1"

_REQUIRED = ("schema", "kind", "method", "image", "snr", "checks", "options", "measured_at")
_SQUARE = 1e-9
_NOTHING = 1e-280
"""Numbers below it are written as zero: their digits have no power of ten to be rounded by."""
_MAX_QUICK = 15_000
"""Bytes of a pickled record, compressed quickly; one that is larger is compressed well."""


@dataclass(frozen=True)
class ImageInfo:
    """Where the pixels came from.

    Parameters
    ----------
    path : str or None
        The file; ``None`` for an array in memory.
    band : int
        From 1.
    roi : (int, int, int, int)
        Row, column, height and width of the region, in pixels of the whole image.
    crs : str or None
    along_track : {"y", "x"}
        The image axis the satellite flew along.
    pixel_gsd_m : (float, float) or None
        GSD from row to row and from column to column.
    linearized : str or None
        The characteristic curve that stored values were turned back through, in words; ``None``
        if they were taken as they are.
    file_gsd_m : (float, float) or None
        GSD that the image has of itself, where the stated one is another.
    band_name : str or None
        As the file or a document beside it states it.
    band_count : int or None
        Bands of the file; ``None`` where it is not known.
    region : str or None
        What the region is called, where it has a name.
    restored : str or None
        The filter that `acutance.restore` applied to the band before it was measured: the numbers
        are those of the restored product.
    is_polygon : bool
        Whether the region leaves out pixels of `roi`.
    stated_nodata : float or None
        The nodata value that was stated when the image was opened.
    """

    path: str | None = None
    band: int = 1
    roi: tuple[int, int, int, int] = (0, 0, 0, 0)
    crs: str | None = None
    along_track: AlongTrack = "y"
    pixel_gsd_m: tuple[float, float] | None = None
    linearized: str | None = None
    file_gsd_m: tuple[float, float] | None = None
    band_name: str | None = None
    band_count: int | None = None
    region: str | None = None
    restored: str | None = None

    # Two facts for the command that repeats a measurement, which documents do not have.
    is_polygon: bool = field(default=False, compare=False)
    stated_nodata: float | None = field(default=None, compare=False)

    @property
    def band_label(self) -> str:
        """Number and name of the band: "2 (B3)"."""
        return label_band(self.band, self.band_name)

    @property
    def band_told_apart(self) -> str | None:
        """The name of the band; without one its number where the file has several."""
        is_one_of_several = self.band_count is not None and self.band_count > 1
        return self.band_name or (str(self.band) if is_one_of_several else None)

    @property
    def gsd_m(self) -> float | None:
        """The GSD of square pixels; ``None`` where it is not known, or differs by direction."""
        if self.pixel_gsd_m is None:
            return None
        row_m, col_m = self.pixel_gsd_m
        return col_m if math.isclose(row_m, col_m, rel_tol=_SQUARE) else None

    def gsd_along(self, normal_deg: float) -> float | None:
        """GSD along a direction, from the column axis (0) towards the row axis (90)."""
        if self.pixel_gsd_m is None:
            return None
        return gsd_along(self.pixel_gsd_m, normal_deg)

    def to_dict(self) -> dict[str, Any]:
        """All fields by name, for JSON."""
        return {
            "path": self.path,
            "band": self.band,
            "gsd_m": self.gsd_m,
            "pixel_gsd_m": None if self.pixel_gsd_m is None else list(self.pixel_gsd_m),
            "roi": list(self.roi),
            "crs": self.crs,
            "along_track": self.along_track,
            "linearized": self.linearized,
            "file_gsd_m": None if self.file_gsd_m is None else list(self.file_gsd_m),
            "band_name": self.band_name,
            "band_count": self.band_count,
            "region": self.region,
            "restored": self.restored,
        }

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> ImageInfo:
        """What `to_dict` wrote; older documents knew but one GSD, of square pixels.

        Raises
        ------
        OptionError
            If it is none, or damaged.
        """
        with refuse_damaged("the image of a measurement", "give what to_dict() returned"):
            return cls._read(document)

    @classmethod
    def _read(cls, document: Mapping[str, Any]) -> ImageInfo:
        row, col, height, width = document["roi"]
        sides, gsd_m = document.get("pixel_gsd_m"), document.get("gsd_m")
        of_file = document.get("file_gsd_m")
        if sides is None and gsd_m is not None:
            sides = (gsd_m, gsd_m)
        return cls(
            document["path"],
            int(document.get("band", 1)),
            (int(row), int(col), int(height), int(width)),
            document.get("crs"),
            "x" if document.get("along_track", "y") == "x" else "y",
            None if sides is None else (float(sides[0]), float(sides[1])),
            document.get("linearized"),
            None if of_file is None else (float(of_file[0]), float(of_file[1])),
            document.get("band_name"),
            document.get("band_count"),
            document.get("region"),
            document.get("restored"),
        )


@dataclass(frozen=True, eq=False)
class Record(ShortRepr, HasDirections[RecordedDirection], HasChecks):
    """A measurement without its pixels: the document ``acutance/measurement/1``, read by name.

    Parameters
    ----------
    fields : mapping
        The document, in strict JSON types. Fields that this version does not have are kept as they
        are.

    Raises
    ------
    OptionError
        If it is no such document. What its fields hold is checked by `from_dict`.

    Examples
    --------
    >>> record = ac.Record.from_dict(json.loads(text))  # doctest: +SKIP
    >>> record.across.mtf_nyquist, record.verdict.word  # doctest: +SKIP
    """

    fields: Mapping[str, Any]

    def __post_init__(self) -> None:
        advice = "write one with a measuring command and --json, or with to_dict()"
        require_document(self.fields, SCHEMA, _REQUIRED, name="the document", advice=advice)

    @cached_property
    def document(self) -> dict[str, Any]:
        """All fields."""
        return dict(self.fields)

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Record:
        """The record of a document.

        Raises
        ------
        OptionError
            If it is none of a measurement, or damaged.
        """
        record = cls(document)
        with refuse_damaged("the document", "give one that acutance wrote", "a measurement"):
            _ = record.image, record.checks, record.budget, record.snr, record.measured_at
            _ = {name: one.numbers for name, one in record.directions.items()}
            _ = [record.directions[name] for name in record.measured_directions]
        return record

    def __getattr__(self, name: str) -> Any:
        # Who comes from a measurement of one direction looks for its numbers here.
        if name in (*METRICS, "mtf", "lsf", "esf"):
            first = next(iter(self.directions))
            raise AttributeError(
                f"a Record has its numbers by direction: read .{first}.{name}", name=name, obj=self
            )
        raise AttributeError(f"'Record' object has no attribute {name!r}", name=name, obj=self)

    def to_dict(self) -> dict[str, Any]:
        """The document; nothing is lost by `from_dict`."""
        return dict(self.document)

    def to_bytes(self) -> bytes:
        """The document as JSON, compressed by LZMA: what an archive stores."""
        text = json.dumps(strict_json(self.document), ensure_ascii=False, separators=(",", ":"))
        return lzma.compress(text.encode())

    @classmethod
    def from_bytes(cls, stored: bytes) -> Record:
        """The record that `to_bytes` stored.

        Raises
        ------
        OptionError
            If they are other bytes, or damaged.
        """
        try:
            document = json.loads(lzma.decompress(stored))
        except (TypeError, ValueError, EOFError, lzma.LZMAError) as error:
            raise OptionError(
                f"{_sized(stored)} are no stored record ({error}): give what to_bytes() returned"
            ) from error
        return cls.from_dict(document)

    def __reduce__(self) -> tuple[Any, tuple[bytes]]:
        # Thousands of edges cross processes: LZMA would take longer than to measure them.
        packed = zlib.compress(pickle.dumps(self.document, pickle.HIGHEST_PROTOCOL), 1)
        if len(packed) > _MAX_QUICK:
            return Record.from_bytes, (self.to_bytes(),)
        return _unpacked, (packed,)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Record):
            return NotImplemented
        return bool(strict_json(self.document) == strict_json(other.document))

    __hash__ = None  # type: ignore[assignment]

    @property
    def kind(self) -> str:
        """The target."""
        return str(self.fields["kind"])

    @property
    def method(self) -> str:
        """The estimator."""
        return str(self.fields["method"])

    @cached_property
    def image(self) -> ImageInfo:
        """Where the pixels came from."""
        return ImageInfo.from_dict(self.fields["image"])

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """The checks of the target."""
        return tuple(map(Check.from_dict, self.fields["checks"]))

    @cached_property
    def directions(self) -> dict[str, RecordedDirection]:
        """Numbers and curves by direction: "across", "along", or both."""
        if "orientation" in self.fields:
            return {str(self.fields["orientation"]): RecordedDirection(self.fields)}
        return {name: RecordedDirection(self.fields[name]) for name in ("across", "along")}

    @property
    def measured_directions(self) -> tuple[str, ...]:
        """The directions that the target showed; in older documents all of them."""
        return tuple(self.fields.get("measured_directions", self.directions))

    @cached_property
    def slices(self) -> OtfSlices:
        """The OTF along the measured directions, with its covariance.

        Raises
        ------
        OptionError
            If the document does not hold them.
        """
        if "plane" not in self.fields:
            raise OptionError(
                "the document holds no slices of the OTF (plane): write it again with this version"
            )
        return OtfSlices.from_dict(self.fields["plane"])

    @cached_property
    def budget(self) -> tuple[BudgetTerm, ...]:
        """The uncertainty budget; of older documents nothing."""
        return tuple(map(BudgetTerm.from_dict, self.fields.get("budget", ())))

    @property
    def is_ratio(self) -> bool:
        """Whether the curves are a sensor's MTF over another's, and not its own."""
        return self.fields.get("quantity") == "mtf_low_over_mtf_high"

    @property
    def snr(self) -> float:
        """Signal to noise ratio; ``nan`` where none is known."""
        snr = self.fields["snr"]
        return math.nan if snr is None else float(snr)

    @property
    def options(self) -> Mapping[str, Any]:
        """The options of the measurement."""
        options: Mapping[str, Any] = self.fields["options"]
        return options

    @property
    def measured_at(self) -> datetime:
        """When (UTC)."""
        return datetime.fromisoformat(self.fields["measured_at"])

    def summary(self) -> str:
        """Target and method, the main numbers, and how many checks failed."""
        named = (f"{name}: {self.directions[name].summary()}" for name in self.measured_directions)
        return f"{self.kind} by {self.method}, {', '.join(named)}, {count_failed(self.checks)}"


def _sized(stored: object) -> str:
    """What was to be unpacked, in a few words."""
    if isinstance(stored, bytes | bytearray):
        return f"{len(stored)} bytes"
    return f"the contents of {stored!r:.80}"


def _unpacked(packed: bytes) -> Record:
    return Record(pickle.loads(zlib.decompress(packed)))


def rounded(values: ArrayLike, digits: int = 6) -> list[Any]:
    """Numbers of a curve as lists, with so many significant digits: a document has no more."""
    array = np.asarray(values, float)
    size = np.abs(array)
    scale = np.where((size > _NOTHING) & (size < np.inf), size, 1.0)
    np.log10(scale, out=scale)
    np.subtract(digits - 1, np.floor(scale, out=scale), out=scale)
    np.power(10.0, scale, out=scale)
    listed: list[Any] = (np.rint(array * scale) / scale).tolist()
    return listed


def strict_json(value: Any) -> Any:
    """A document as strict JSON types: what is not a finite number becomes null."""
    if isinstance(value, Mapping):
        return {str(key): strict_json(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        # A covariance is a million numbers: no call for each.
        if set(map(type, value)) == {float}:
            return [item if math.isfinite(item) else None for item in value]
        return [strict_json(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
