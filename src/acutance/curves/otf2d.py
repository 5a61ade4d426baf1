"""The 2-D transfer function: slices in any direction, and the point spread function."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from numbers import Real
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from acutance.curves.direction import gsd_along, unit_vector
from acutance.curves.grid import DISTANCE_PX, FREQ_CPP, Floats, crossing
from acutance.curves.response import Response
from acutance.curves.short_repr import ShortRepr
from acutance.curves.spread import Esf, Lsf
from acutance.curves.transfer import Mtf
from acutance.errors import OptionError

__all__ = ["Otf2d", "OtfModel", "PackableOtf"]

Complexes = NDArray[np.complex128]

PERIOD_PX = 64
"""Length over which the curves of a slice repeat: light must have died away within half of it."""


class OtfModel(Protocol):
    """An OTF over the plane of frequencies, with its covariance.

    Frequencies are in cycles per pixel: `u_cpp` across (along the rows of pixels, x), `v_cpp`
    along (down the columns, y). Sign of the phase: the optical transfer function (OTF) is the
    Fourier transform of the point spread function with the kernel ``exp(-2 pi i (u x + v y))``.
    """

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which nothing is transferred."""
        ...

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), exactly 1 at zero frequency."""
        ...

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k), exactly 0 at zero frequency."""
        ...


@runtime_checkable
class PackableOtf(OtfModel, Protocol):
    """An OTF that has a lighter form, its covariance rounded."""

    def packed(self) -> OtfModel:
        """The same OTF in fewer bytes."""
        ...


@dataclass(frozen=True, eq=False)
class Otf2d(ShortRepr):
    """A 2-D OTF, from which the curves of every direction follow.

    Parameters
    ----------
    model : OtfModel
        The OTF and its covariance at any frequencies.
    gsd_m : (float, float), optional
        Distance from row to row and from column to column in metres.
    """

    model: OtfModel
    gsd_m: tuple[float, float] | None = None

    def packed(self) -> Otf2d:
        """The same OTF in fewer bytes, where its model has a lighter form."""
        model = self.model.packed() if isinstance(self.model, PackableOtf) else self.model
        return Otf2d(model, self.gsd_m)

    def response(self, normal_deg: float) -> Response:
        """ESF, LSF and MTF along a direction: an edge whose normal points there would show them.

        The MTF is the slice of the OTF, and the line spread function (LSF) its inverse Fourier
        transform: the PSF integrated over the other axis (projection-slice theorem).

        Parameters
        ----------
        normal_deg : float
            From the column axis (0: across) towards the row axis (90: along).

        Raises
        ------
        OptionError
            If the direction is no finite number.
        """
        mtf = self.mtf(normal_deg)
        freq = np.asarray(np.arange(round(PERIOD_PX * self.model.band_cpp) + 1) / PERIOD_PX)
        esf, lsf, esf_factor, lsf_factor = _spread(freq, *self._slice(normal_deg, freq))
        return Response(
            Esf(DISTANCE_PX, esf, esf_factor),
            Lsf(DISTANCE_PX, lsf, lsf_factor),
            mtf,
            gsd_m=None if self.gsd_m is None else gsd_along(self.gsd_m, normal_deg),
        )

    def mtf(self, normal_deg: float) -> Mtf:
        """MTF along a direction, without the spread functions of `response`.

        Parameters
        ----------
        normal_deg : float
            From the column axis (0: across) towards the row axis (90: along).

        Raises
        ------
        OptionError
            If the direction is no finite number.
        """
        if not (isinstance(normal_deg, Real) and math.isfinite(normal_deg)):
            raise OptionError(
                f"the direction is {normal_deg!r:.80}: give a finite number of degrees, from the "
                "column axis (0: across) towards the row axis (90: along)"
            )
        return Mtf(FREQ_CPP, *self._slice(normal_deg, FREQ_CPP))

    def psf(self, half_width_px: float = 5.0, step_px: float = 0.1) -> tuple[Floats, Floats]:
        """Point spread function around its origin, pixel area included.

        Parameters
        ----------
        half_width_px, step_px : float, optional
            Half the width of the returned square and the spacing of its grid.

        Returns
        -------
        distance_px : (n,) array
            Places along either axis.
        psf : (n, n) array
            Light per square pixel at (row, column) distances; its integral over the plane is 1.
        """
        reach = round(half_width_px / step_px)
        distance: Floats = np.asarray(np.arange(-reach, reach + 1) * step_px)
        period = 2 * (math.ceil(half_width_px) + 8)
        half = np.arange(round(period * self.model.band_cpp) + 1) / period
        u, v = half, np.concatenate([-half[:0:-1], half])
        plane = self.model.otf(np.tile(u, v.size), np.repeat(v, u.size)).reshape(v.size, u.size)
        weights = np.where(u == 0, 1.0, 2.0) / period**2
        down = np.exp(2j * math.pi * np.outer(distance, v))
        across = np.exp(2j * math.pi * np.outer(u, distance)) * weights[:, None]
        return distance, np.asarray((down @ plane @ across).real)

    def _slice(self, normal_deg: float, freq_cpp: Floats) -> tuple[Complexes, Complexes]:
        """OTF along a direction, about the centroid, and the factor of its covariance."""
        u, v = _along(normal_deg, freq_cpp)
        turn = np.exp(2j * math.pi * freq_cpp * self._centroid(normal_deg))
        return self.model.otf(u, v) * turn, self.model.factor(u, v) * turn[:, None]

    def _centroid(self, normal_deg: float) -> float:
        """Centroid of the LSF, from the slope of the phase at zero frequency."""
        step = 1e-5
        phase = np.angle(self.model.otf(*_along(normal_deg, np.array([step]))))
        return -float(phase[0]) / (2 * math.pi * step)


def _along(normal_deg: float, freq_cpp: Floats) -> tuple[Floats, Floats]:
    x, y = unit_vector(normal_deg)
    return freq_cpp * x, freq_cpp * y


def _spread(
    freq: Floats, otf: Complexes, factor: Complexes
) -> tuple[Floats, Floats, Floats, Floats]:
    """Edge spread function (ESF) and LSF about the 50 % point, with their covariance factors.

    Sums over a regular grid of frequencies: the integral of the repeated LSF, whose mean is taken
    out and put back as a straight line.
    """
    integral = 1 / (2j * math.pi * freq[1:])
    esf = 0.5 + DISTANCE_PX / PERIOD_PX + _synthesised(otf[1:] * integral)
    half = crossing(DISTANCE_PX, esf, 0.5, float(DISTANCE_PX[_steep(esf)]))
    half = 0.0 if math.isnan(half) else half
    turn = np.exp(2j * math.pi * freq[1:] * half)
    spectra = np.column_stack([otf, factor])[1:] * turn[:, None]
    esfs = _synthesised(spectra * integral[:, None])
    esfs[:, 0] += 0.5 + (DISTANCE_PX + half) / PERIOD_PX
    lsfs = _synthesised(spectra)
    lsfs[:, 0] += 1 / PERIOD_PX
    return esfs[:, 0], lsfs[:, 0], esfs[:, 1:], lsfs[:, 1:]


def _synthesised(spectrum: Complexes) -> Floats:
    """Sum of the waves of a spectrum, (f, ...) from the first frequency, at the grid's places."""
    parts = np.concatenate([spectrum.real, spectrum.imag])
    return np.asarray(2 / PERIOD_PX * (_waves(spectrum.shape[0]) @ parts))


@cache
def _waves(count: int) -> Floats:
    """Cosines and negative sines of `count` frequencies at the grid's places, (n, 2 count)."""
    phase = 2 * math.pi * np.outer(DISTANCE_PX, np.arange(1, count + 1) / PERIOD_PX)
    return np.hstack([np.cos(phase), -np.sin(phase)])


def _steep(esf: Floats) -> int:
    """A place on the dark side of the steepest rise, from where 50 % is the next crossing."""
    steepest = int(np.argmax(np.diff(esf)))
    below = np.flatnonzero(esf[: steepest + 2] < 0.5)
    return int(below[-1]) if below.size else 0
