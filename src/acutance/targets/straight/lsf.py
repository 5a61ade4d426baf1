"""The fitted line spread function (LSF): Gaussian through a pixel, spline and tail."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Esf, Lsf, Mtf, Response
from acutance.curves.grid import FREQ_CPP, Floats, crossing, sample
from acutance.curves.metrics import RerCentre
from acutance.curves.rounded_rows import principal_axes
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.lorentz_tail import tail_esf, tail_lsf, tail_otf
from acutance.targets.straight.pulse_halo import with_halo_error
from acutance.targets.straight.spline import (
    CENTRES,
    HALF_SUPPORT,
    SIZE,
    SplineRows,
    combine,
    edge_and_line_weights,
    edge_weights,
    transform,
    waves,
)
from acutance.targets.straight.stated_target import NOTHING_STATED, StatedTarget, with_stated_target
from acutance.targets.straight.tuned import HALO_SHARE, TAIL_WIDTH

__all__ = ["LsfModel", "SplineResponse", "of_stated_target", "with_uncertain_halo"]

_STEP_PX = 0.05
_MIN_HALF_PX = 10.0
AnyResponse = TypeVar("AnyResponse", bound=Response)
_NEGLIGIBLE = 1e-9
"""Of a variance: what is left out of the light half of a measurement."""
_Linear = tuple[Floats, SplineRows]
_Parts = tuple[Floats, NDArray[np.intp], Floats, Floats]


@dataclass(frozen=True, eq=False)
class LsfModel:
    """The response to the fitted step, not yet normalised.

    Every curve is linear in the spline's ESF coefficients and the tail: its design has one column
    for each, and its error is ``design @ latent @ z`` with z standard normal.

    Parameters
    ----------
    blur : GaussianPixel
        The first fit, which spline and tail correct.
    level : float
        Height of the blur's step, in image units.
    spline : (CELLS + 3,) array
        Coefficients of the correction of the edge spread function (ESF), in image units.
    tail : float
        Height of the tail's step, in image units.
    latent : (CELLS + 4, k) array
        Factor of the covariance of spline and tail.
    """

    blur: GaussianPixel
    level: float
    spline: Floats
    tail: float
    latent: Floats

    @property
    def height(self) -> float:
        """Bright minus dark: the integral of the LSF."""
        return float(self.level + self.spline[-1] + self.tail)

    def esf(self, s: Floats) -> Floats:
        """Normalised ESF at normal distances `s` in pixels, (n,)."""
        u = s / self.blur.width_px
        return self._sum(self.blur.esf(s), *edge_weights(u), tail_esf(u, TAIL_WIDTH)) / self.height

    def step(self, s: Floats, blurred: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
        """Response to the step and its derivative at normal distances `s`, in image units.

        `blurred` is the ESF and the LSF of the first fit there.
        """
        esf, lsf = self._parts(s, blurred)
        return self._sum(*esf), self._sum(*lsf)

    def otf(self, freq_cpp: Floats) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Normalised optical transfer function (OTF) about the LSF's centroid, and its design."""
        value, design = self.spectrum(freq_cpp)
        design[:, -2:] -= (value / self.height)[:, None]
        return value, design

    def spectrum(self, freq_cpp: Floats) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Spectrum of the LSF about its centroid in units of its height, and the exact design."""
        freq, centroid = freq_cpp * self.blur.width_px, self._centroid()
        about = waves(freq, -centroid)[0] / self.height
        design = transform(freq, centroid, 1 / self.height, further=1)
        design[:, -1] = tail_otf(freq, TAIL_WIDTH) * about
        # A real product: BLAS would start threads for a complex one of this size.
        coefficients = np.append(self.spline, self.tail)
        value = self.level * self.blur.otf(freq_cpp) * about
        value += (coefficients @ design.T.view(float)).view(complex)
        return value, design

    def half_point(self) -> float:
        """Normal distance of the 50 % point."""
        s = np.asarray(np.arange(-40, 41) * (0.05 * self.blur.width_px))
        value = self.esf(s)
        steep = int(np.argmax(value[1:] - value[:-1]))
        # The last place below one half: of a ramp any part may be the steepest.
        below = (value[: steep + 2] < 0.5).nonzero()[0]
        return crossing(s, value, 0.5, float(s[below[-1]] if below.size else s[0]))

    def response(self, middle: float) -> SplineResponse:
        """The curves on their grids, 0 at `middle`."""
        half = math.ceil(max(_MIN_HALF_PX, HALF_SUPPORT * self.blur.width_px) / _STEP_PX)
        distance = np.asarray(np.arange(-half, half + 1) * _STEP_PX)
        s = distance + middle
        (esf, esf_design), (lsf, lsf_design) = (
            self._normalised(*parts) for parts in self._parts(s, self.blur.esf_and_lsf(s))
        )
        otf, otf_design = self.otf(FREQ_CPP)
        return SplineResponse(
            Esf(distance, esf, esf_design, self.latent),
            Lsf(distance, lsf, lsf_design, self.latent),
            Mtf(FREQ_CPP, otf, otf_design, self.latent),
            model=self,
            middle_px=middle,
        )

    def half_point_std(self, response: Response) -> float:
        """Standard deviation of the 50 % point of a `response` about it."""
        steepness = float(sample(response.lsf.distance_px, response.lsf.value, 0.0))
        return float(np.linalg.norm(response.esf.gradient(0.0))) / abs(steepness)

    def _parts(self, s: Floats, blurred: tuple[Floats, Floats]) -> tuple[_Parts, _Parts]:
        """The terms of the ESF, and of the LSF per pixel."""
        width = self.blur.width_px
        u = s / width
        esf, lsf = blurred
        cell, weights, slopes = edge_and_line_weights(u)
        return (
            (esf, cell, weights, tail_esf(u, TAIL_WIDTH)),
            (lsf, cell, slopes / width, tail_lsf(u, TAIL_WIDTH) / width),
        )

    def _sum(
        self, blurred: Floats, cell: NDArray[np.intp], weights: Floats, tail: Floats
    ) -> Floats:
        """The sum of first fit, spline and tail with their fitted heights, in image units."""
        return self.level * blurred + combine(cell, weights, self.spline) + self.tail * tail

    def _normalised(
        self, blurred: Floats, cell: NDArray[np.intp], weights: Floats, tail: Floats
    ) -> _Linear:
        """The sum, of height 1, and its design."""
        height = self.height
        value = self._sum(blurred, cell, weights, tail) / height
        # The last coefficient and the tail change the height, by which the curve is divided.
        dense = np.empty((value.size, 2))
        np.multiply(value, -1 / height, out=dense[:, 0])
        np.add(dense[:, 0], tail * (1 / height), out=dense[:, 1])
        return value, SplineRows(cell, weights * (1 / height), dense, further=1)

    def _centroid(self) -> float:
        """Centroid of the LSF in widths."""
        shares = np.diff(self.spline[2 : 3 + SIZE])
        return float(shares @ CENTRES) / self.height


@dataclass(frozen=True, eq=False, kw_only=True)
class SplineResponse(Response):
    """Curves of a spline model. They are pickled as the model, which is a fifth of their size.

    Parameters
    ----------
    model : LsfModel
    middle_px : float
        Where the model's 50 % point lies.
    halo_share : float
        Standard deviation of a pulse's halo relative to itself; 0 for an edge.
    stated : StatedTarget
        What was stated of the target, which the curves allow for.
    """

    model: LsfModel
    middle_px: float
    halo_share: float = 0.0
    stated: StatedTarget = NOTHING_STATED

    def packed(self) -> SplineResponse:
        """The same curves, with as many latent variables as their deviations depend on."""
        axes = principal_axes(self.model.response(self.middle_px).covariance_factor, _NEGLIGIBLE)
        narrow = replace(self.model, latent=self.model.latent @ axes)
        return _restored(narrow, *self._parts[1:])

    @property
    def _parts(self) -> tuple[LsfModel, float, float, StatedTarget, float | None, RerCentre]:
        return (
            self.model, self.middle_px, self.halo_share, self.stated, self.gsd_m, self.rer_centre,
        )  # fmt: skip

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        return _restored, self._parts


def _restored(
    model: LsfModel,
    middle_px: float,
    halo_share: float,
    stated: StatedTarget,
    gsd_m: float | None,
    rer_centre: RerCentre,
) -> SplineResponse:
    response = model.response(middle_px)
    if halo_share > 0:
        response = with_uncertain_halo(response, halo_share)
    response = of_stated_target(response, stated)
    return replace(response, gsd_m=gsd_m, rer_centre=rer_centre)


def with_uncertain_halo(response: SplineResponse, share: float = HALO_SHARE) -> SplineResponse:
    """The curves of a pulse, whose halo is uncertain by a share of itself; see `pulse_halo`."""
    esf, lsf, mtf = with_halo_error(response, share)
    return replace(response, esf=esf, lsf=lsf, mtf=mtf, halo_share=share)


def of_stated_target(response: AnyResponse, stated: StatedTarget) -> AnyResponse:
    """The curves of the sensor, where something is stated of its target; see `stated_target`."""
    if not stated.terms:
        return response
    found = with_stated_target(response, stated)
    return replace(found, stated=stated) if isinstance(found, SplineResponse) else found
