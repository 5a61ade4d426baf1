"""The fitted line spread function: a plain blur, a spline and a tail, with their covariance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Esf, Lsf, Mtf, Response
from acutance.curves.grid import Floats, crossing
from acutance.fit.blur import Blur
from acutance.fit.prior import tail_esf, tail_lsf, tail_otf
from acutance.fit.spline import (
    CENTRES,
    HALF_SUPPORT,
    SIZE,
    combine,
    edge_weights,
    line_weights,
    spread,
    transform,
)

__all__ = ["LsfModel"]

_FREQ_CPP: Floats = np.arange(101) * 0.01
_STEP_PX = 0.05
_MIN_HALF_PX = 10.0


@dataclass(frozen=True, eq=False)
class LsfModel:
    """The response to the fitted step, not yet normalised.

    Every curve is linear in the spline's ESF coefficients and the tail: its design has one column
    for each, and its error is ``design @ latent @ z`` with z standard normal.

    Parameters
    ----------
    blur : Blur
        The plain blur the spline departs from.
    level : float
        Height of the blur's step, in image units.
    spline : (CELLS + 3,) array
        ESF coefficients of the departure, in image units.
    tail : float
        Height of the tail's step, in image units.
    latent : (CELLS + 4, k) array
        Factor of the covariance of spline and tail.
    """

    blur: Blur
    level: float
    spline: Floats
    tail: float
    latent: Floats

    @property
    def height(self) -> float:
        """Bright less dark: the integral of the LSF."""
        return float(self.level + self.spline[-1] + self.tail)

    def esf(self, s: Floats) -> Floats:
        """Normalised ESF at normal distances `s` in pixels, (n,)."""
        u = s / self.blur.width_px
        departure = combine(*edge_weights(u), self.spline)
        sums = self.level * self.blur.esf(s) + departure + self.tail * tail_esf(u)
        return np.asarray(sums / self.height)

    def half_point(self) -> float:
        """Normal distance of the 50 % point."""
        s: Floats = np.arange(-40, 41) * (0.05 * self.blur.width_px)
        value = self.esf(s)
        steep = int(np.argmax(np.diff(value)))
        return crossing(s, value, 0.5, float(s[max(steep - 8, 0)]))

    def response(self, middle: float) -> Response:
        """The curves on their grids, 0 at `middle`."""
        half = math.ceil(max(_MIN_HALF_PX, HALF_SUPPORT * self.blur.width_px) / _STEP_PX)
        distance: Floats = np.arange(-half, half + 1) * _STEP_PX
        esf, esf_design = self._esf(distance + middle)
        lsf, lsf_design = self._lsf(distance + middle)
        otf, otf_design = self._otf(_FREQ_CPP)
        return Response(
            Esf(distance, esf, esf_design, self.latent),
            Lsf(distance, lsf, lsf_design, self.latent),
            Mtf(_FREQ_CPP, otf, otf_design, self.latent),
        )

    def half_point_std(self, response: Response) -> float:
        """Standard deviation of the 50 % point of a `response` about it."""
        return response.esf(0.0).std / abs(response.lsf(0.0).value)

    def _esf(self, s: Floats) -> tuple[Floats, Floats]:
        """Normalised ESF and its design."""
        u = s / self.blur.width_px
        cell, weights = edge_weights(u)
        tail = tail_esf(u)
        value = self.level * self.blur.esf(s) + combine(cell, weights, self.spline)
        value = (value + self.tail * tail) / self.height
        design = spread(cell, weights / self.height, further=1)
        design[:, -1] = tail / self.height
        return value, self._normalised(design, value)

    def _lsf(self, s: Floats) -> tuple[Floats, Floats]:
        """Normalised LSF, per pixel, and its design."""
        width = self.blur.width_px
        u = s / width
        cell, weights = line_weights(u)
        tail = tail_lsf(u) / width
        value = self.level * self.blur.lsf(s) + combine(cell, weights, self.spline) / width
        value = (value + self.tail * tail) / self.height
        design = spread(cell, weights / (width * self.height), further=1)
        design[:, -1] = tail / self.height
        return value, self._normalised(design, value)

    def _otf(self, freq_cpp: Floats) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Normalised OTF about the LSF's centroid, and its design."""
        freq = freq_cpp * self.blur.width_px
        about = self._turn_to_centroid(freq_cpp) / self.height
        spline = transform(freq) * about[:, None]
        tail = tail_otf(freq) * about
        value = self.level * self.blur.otf(freq_cpp) * about + spline @ self.spline
        value += self.tail * tail
        return value, self._normalised(np.column_stack([spline, tail]), value)

    def _turn_to_centroid(self, freq_cpp: Floats) -> NDArray[np.complex128]:
        """What moving the origin to the LSF's centroid multiplies the OTF by."""
        shares = np.diff(self.spline[2 : 3 + SIZE])
        centroid = self.blur.width_px * float(shares @ CENTRES) / self.height
        return np.exp(2j * np.pi * freq_cpp * centroid)

    def _normalised(self, design: NDArray[Any], value: NDArray[Any]) -> NDArray[Any]:
        """A design divided by the height: what lifts the height lowers the curve."""
        design[:, -2:] -= (value / self.height)[:, None]
        return design
