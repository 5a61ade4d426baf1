"""What point sources give: numbers and curves of all directions, the sources, the survey."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr
from acutance.targets.measurement import Measurement
from acutance.targets.points.detect import RejectedSpot
from acutance.targets.points.pads import Pads
from acutance.targets.points.points_fit import PointsFit
from acutance.targets.points.published import AlignedFit, PublishedMirrors
from acutance.targets.points.sources import PointSource, SourceStamp
from acutance.targets.points.survey import SurveyErrors
from acutance.targets.slices import OtfSlices

__all__ = ["PointsDetails", "PointsMeasurement"]


@dataclass(frozen=True, eq=False)
class PointsDetails(ShortRepr):
    """The pixels of a measurement, and what was fitted to them.

    Parameters
    ----------
    pixels : (rows, cols) array
        Of the region; unusable pixels are NaN.
    stamps : tuple of SourceStamp
        The pixels around each source, in the order of `PointsMeasurement.sources`.
    fit : PointsFit, optional
        The joint fit (method "psf-fit"), in pixels of the region.
    published : PublishedMirrors, optional
        The aligned samples and their Gaussian (method "gaussian-2003"), in pixels of the region.
    """

    pixels: Floats
    stamps: Sequence[SourceStamp]
    fit: PointsFit | None = None
    published: PublishedMirrors | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class PointsMeasurement(Measurement):
    """A measurement of point sources.

    Parameters
    ----------
    sources : tuple of PointSource
        What was fitted.
    rejected : tuple of RejectedSpot
        Bright spots and stated places that are not usable, with the reason, in pixels of the whole
        image.
    noise_std : float
        Standard deviation of the background's noise.
    noise_gain : float, optional
        Variance of the noise per unit of light (method "psf-fit").
    aligned : AlignedFit, optional
        The Gaussian of the aligned samples (method "gaussian-2003").
    survey : SurveyErrors, optional
        Measured against surveyed places.
    pads : Pads, optional
        Mounts under the sources, where the pixels ask for them (method "psf-fit").

    Notes
    -----
    Of `without_details` the record, and so the document and the numbers, are those of the whole
    measurement. Its curves are kept with the 40 most important directions of their covariance at
    half precision: standard deviations of numbers read from them anew agree within 6 %.
    """

    sources: tuple[PointSource, ...]
    rejected: tuple[RejectedSpot, ...]
    noise_std: float
    noise_gain: float | None = None
    aligned: AlignedFit | None = None
    survey: SurveyErrors | None = None
    pads: Pads | None = None

    @property
    def positions(self) -> Floats:
        """Places of the sources as (row, col) in the whole image, (n, 2)."""
        return np.array([(one.row.value, one.col.value) for one in self.sources])

    @cached_property
    def slices(self) -> OtfSlices:
        """Slices of the OTF, their covariance, and what the pixels alone say of them."""
        if self._is_light:
            return self.record.slices
        slices = OtfSlices.of_otf2d(self.otf)
        fit = None if self.details is None else self.details.fit
        if fit is None or fit.pixels_alone is None:
            return slices
        return replace(slices, likelihood=fit.pixels_alone.likelihood(fit.model, *slices.places))

    def target_document(self) -> dict[str, Any]:
        """Sources, what was rejected, the survey, the noise or the aligned samples."""
        document: dict[str, Any] = {
            "sources": [one.to_dict() for one in self.sources],
            "rejected": [dict(vars(one)) for one in self.rejected],
            "survey": None if self.survey is None else self.survey.to_dict(),
        }
        if self.noise_gain is not None:
            document["noise"] = {"std": self.noise_std, "gain": self.noise_gain}
        if self.pads is not None:
            document["pads"] = self.pads.to_dict()
        if self.aligned is not None:
            document["aligned"] = self.aligned.to_dict()
        return document
