"""The result of a measurement of a Siemens star."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from acutance.curves import Estimate, Mtf, Otf2d
from acutance.curves.direction import unit_vector
from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP, mtf_crossing
from acutance.curves.short_repr import ShortRepr
from acutance.curves.transfer import mtf_and_std
from acutance.geometry.star_geometry import SiemensStar
from acutance.targets.measurement import Measurement
from acutance.targets.periodic.fit_star import SIDE_MARGIN_PX
from acutance.targets.periodic.periodic_details import PeriodicDetails
from acutance.targets.record import rounded

__all__ = ["Rings", "StarDetails", "StarMeasurement", "mean_over_directions"]

_FREQ_CPP: Floats = np.asarray(np.arange(101) * 0.01)
_DIRECTION_STEP_DEG = 5.0


@dataclass(frozen=True, eq=False)
class Rings(ShortRepr):
    """The plain reading of a star: a sinusoid fitted to every ring of pixels.

    Attributes
    ----------
    freq_cpp : (n,) array
        Frequency of the spokes in the ring.
    modulation : (n,) array
        Amplitude of the sinusoid over that before the sensor: the MTF, as far as a ring shows
        one frequency. Near the centre it does not: spokes change within the blur.
    std : (n,) array
        Its standard deviation by the noise alone.
    """

    freq_cpp: Floats
    modulation: Floats
    std: Floats

    def to_dict(self) -> dict[str, list[float]]:
        """Frequencies, modulations and standard deviations as lists."""
        return {
            "freq_cpp": np.round(self.freq_cpp, 6).tolist(),
            "modulation": rounded(self.modulation),
            "std": rounded(self.std, 4),
        }


class StarDetails(PeriodicDetails):
    """The heavy half of a measurement of a star: pixels and residuals."""


@dataclass(frozen=True, eq=False, kw_only=True)
class StarMeasurement(Measurement):
    """A measurement of one star.

    Parameters
    ----------
    star : SiemensStar
        Where the star is, in pixels of the whole image.
    centre_std_px : (float, float)
        Standard deviation of the centre's row and column.
    level : Estimate
        Amplitude of the spokes before the sensor (of a square wave, its fundamental's).
    reach_cpp : (float, float)
        Lowest and highest frequency of the spokes used: the MTF is continued beyond.
    rings : Rings
        The plain reading.
    """

    star: SiemensStar
    centre_std_px: tuple[float, float]
    level: Estimate
    reach_cpp: tuple[float, float]
    rings: Rings
    details: StarDetails | None = None

    @cached_property
    def mean_mtf(self) -> Mtf:
        """Mean of the MTF over `directions_deg`."""
        return mean_over_directions(self.otf, self.directions_deg)

    @property
    def directions_deg(self) -> Floats:
        """Directions across the spokes, from the column axis towards the row axis, (n,).

        Of a fan those in which it shows Nyquist's frequency (or the highest it does): its spokes
        are that fine near the centre, where the margin margin its straight sides takes most.
        """
        star = self.star
        first, sweep = star.first_deg, star.sweep_deg
        if sweep < 360:
            fine_px = star.radius_at(min(NYQUIST_CPP, self.reach_cpp[1]))
            margin = math.degrees(SIDE_MARGIN_PX / fine_px)
            # Of a fan that is too narrow at that radius the middle remains.
            margin = min(margin, 0.5 * sweep)
            first, sweep = first + margin, sweep - 2 * margin
        # Opposite spokes show the same direction: half a turn is all.
        sweep = min(sweep, 180.0)
        count = max(round(sweep / _DIRECTION_STEP_DEG), 1)
        return np.asarray(first + 90 + (np.arange(count) + 0.5) * sweep / count)

    def mtf_by_direction(self, freq_cpp: float, directions_deg: Floats) -> tuple[Floats, Floats]:
        """MTF at one frequency in some directions, and its standard deviation, (n,) each."""
        x, y = unit_vector(directions_deg)
        u, v = freq_cpp * x, freq_cpp * y
        return mtf_and_std(self.otf.model.otf(u, v), self.otf.model.factor(u, v))

    @property
    def mean_mtf_nyquist(self) -> Estimate:
        """Mean MTF at 0.5 cycles per pixel."""
        return self.mean_mtf(NYQUIST_CPP)

    @property
    def mean_mtf50_cpp(self) -> Estimate:
        """Frequency at which the mean MTF falls to one half."""
        return mtf_crossing(self.mean_mtf, 0.5).estimate()

    @property
    def centre(self) -> tuple[Estimate, Estimate]:
        """Row and column of the centre in the whole image."""
        row_std, col_std = self.centre_std_px
        return Estimate(self.star.row, row_std), Estimate(self.star.col, col_std)

    @property
    def nyquist_px(self) -> float:
        """Radius within which spokes across the grid are undersampled."""
        return self.star.radius_at(NYQUIST_CPP)

    def target_document(self) -> dict[str, Any]:
        """Star, mean over the directions, and rings, for JSON."""
        row, col = self.centre
        return {
            "star": {
                "row": row.to_dict(),
                "col": col.to_dict(),
                "cycles": self.star.cycles,
                "rim_px": self.star.rim_px,
                "first_deg": self.star.first_deg,
                "sweep_deg": self.star.sweep_deg,
                "level": self.level.to_dict(),
                "reach_cpp": list(self.reach_cpp),
                "nyquist_px": self.nyquist_px,
            },
            "mean": {
                "mtf_nyquist": self.mean_mtf_nyquist.to_dict(),
                "mtf50_cpp": self.mean_mtf50_cpp.to_dict(),
                "mtf": {name: rounded(part) for name, part in self.mean_mtf.to_dict().items()},
            },
            "rings": self.rings.to_dict(),
        }


def mean_over_directions(otf: Otf2d, directions_deg: Floats) -> Mtf:
    """Mean MTF over some directions, as a curve with its covariance."""
    value, factor = np.zeros(_FREQ_CPP.size), np.zeros((_FREQ_CPP.size, 1))
    for x, y in zip(*unit_vector(directions_deg), strict=True):
        u, v = _FREQ_CPP * x, _FREQ_CPP * y
        one = Mtf(_FREQ_CPP, otf.model.otf(u, v), otf.model.factor(u, v))
        value = value + one.value
        factor = factor + one.covariance_factor
    count = directions_deg.size
    return Mtf(_FREQ_CPP, (value / count).astype(complex), (factor / count).astype(complex))
