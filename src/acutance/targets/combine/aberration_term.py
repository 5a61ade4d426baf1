"""An aperture with aberrations of low order as one factor of a sensor: coma, astigmatism, defocus.

The transfer function of an aberrated pupil is that of the bare one times the mean of
``exp(2 pi i D)`` over what the pupil and itself, shifted, have in common, D being the difference of
the two wavefronts. For discs of radius one about -s and s, with x along the shift and y across, the
Zernike polynomials of `acutance.optics.Aberrations` give::

    D / s = x (8 sqrt(3) d + 4 sqrt(6) a_along + 24 sqrt(5) b (2 (x^2 + y^2 + s^2) - 1))
            + y 4 sqrt(6) a_across
            + sqrt(8) (2 (9 x^2 + 3 y^2 + 3 s^2 - 3 (1 + e^2)) c_along + 12 x y c_across)

of defocus d, astigmatism a, spherical aberration b and coma c, whose components are those about
axes turned to the shift; what moves the image only is left out, by the radius e of the obscuration.
The mean is a quadrature (`acutance.targets.combine.pupil_overlap`, `pupil_means`).

Most telescopes that are out of alignment have one aberration that stands out. Where edges in two or
three directions leave open what is between them, a form with all six coefficients pays for those
that nobody needs, and forms that are none of a telescope win: so astigmatism and defocus are a
factor of their own. Their D is linear in x and y, the OTF real.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.optics.aperture import aperture_transfer
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.pupil_means import mean_cosines, mean_slopes, mean_waves
from acutance.targets.combine.pupil_overlap import overlap_nodes
from acutance.targets.combine.term import Term, Transfer, aperture, columns, one_by_one

__all__ = ["ABERRATED", "ASTIGMATIC", "diffraction"]

Complexes = NDArray[np.complex128]

_WAVES_STD = 0.04
"""Of every coefficient: .1 waves in all is a telescope that is just diffraction-limited."""
_DEFOCUS_STD, _ASTIGMATISM_STD = 0.05, 0.08
"""Of those of an aberration that stands out."""
_STEP = 1e-6
_DEFOCUS, _ASTIGMATISM = 8 * math.sqrt(3), 4 * math.sqrt(6)


def _aberrated(p: Floats, plane: Plane) -> Complexes:
    return np.asarray(diffraction(p[:2], plane) * _Difference.of(p, plane).mean)


def _slopes(p: Floats, plane: Plane) -> Complexes:
    bare, difference = diffraction(p[:2], plane), _Difference.of(p, plane)
    return np.concatenate([_slopes_by_pupil(_aberrated, p, plane), bare * difference.slopes])


def _astigmatic(p: Floats, plane: Plane) -> Floats:
    return np.asarray(diffraction(p[:2], plane) * _linear_difference(p, plane)[0])


def _astigmatic_slopes(p: Floats, plane: Plane) -> Floats:
    _, by_x, by_y = diffraction(p[:2], plane) * _linear_difference(p, plane)
    by_waves = _by_waves(by_x, by_y, plane)
    return np.concatenate([_slopes_by_pupil(_astigmatic, p, plane), 2 * math.pi * by_waves])


def _linear_difference(p: Floats, plane: Plane) -> Floats:
    """Mean of the cosine of 2 pi D, of defocus and astigmatism alone, and its derivatives by the
    angles that these give s x and s y, (3, n)."""
    s, x, y, weights = _common_part(p, plane)
    amounts = 2 * math.pi * np.stack(_tilts(p, plane))
    return mean_cosines(plane.rings[1], weights, np.stack([s * x, s * y]), amounts)


def _slopes_by_pupil(otf: Transfer, p: Floats, plane: Plane) -> NDArray[Any]:
    """Derivatives by cut-off and obscuration, (2, n), by differences."""
    steps = _STEP * np.eye(2, p.size)
    return np.stack([otf(p + step, plane) - otf(p - step, plane) for step in steps]) / (2 * _STEP)


def diffraction(p: Floats, plane: Plane) -> Floats:
    """OTF of apertures in focus, (..., n), once for every distance from zero frequency."""
    freq, where = plane.rings
    log_cutoff, logit, *_ = columns(p)
    cutoff, obscuration = aperture(log_cutoff, logit)
    return aperture_transfer(freq / cutoff, obscuration)[..., where]


@dataclass(frozen=True, eq=False)
class _Difference:
    """The difference D of the wavefronts over one half of what the pupil and itself have in common.

    At the opposite place of the other half what is odd in D, all but coma, has the other sign.

    Attributes
    ----------
    plane : Plane
    weights : (r, m) array
        Of the nodes, for every distance from zero frequency.
    odd, even : (3, r, m) and (2, r, m) array
        What D is made of: x and y, spherical aberration; coma along the shift and across it.
    by_odd, by_even : (3, n) and (2, n) array
        How much of each there is, times 2 pi.
    """

    plane: Plane
    weights: Floats
    odd: Floats
    even: Floats
    by_odd: Floats
    by_even: Floats

    @classmethod
    def of(cls, p: Floats, plane: Plane) -> _Difference:
        """Of the parameters of `ABERRATED`, at places of the plane."""
        s, x, y, weights = _common_part(p, plane)
        xx, yy, ss = x * x, y * y, s * s
        odd = np.stack([s * x, s * y, 24 * math.sqrt(5) * s * x * (2 * (xx + yy + ss) - 1)])
        _, obscuration = aperture(p[0], p[1])
        coma_along = 6 * math.sqrt(8) * s * (3 * xx + yy + ss - 1 - obscuration**2)
        even = np.stack([coma_along, 12 * math.sqrt(8) * s * x * y])
        by_x, by_y = _tilts(p, plane)
        by_odd = 2 * math.pi * np.stack([by_x, by_y, np.full_like(by_x, p[7])])
        by_even = 2 * math.pi * np.stack([p[5:7] @ plane.along, p[5:7] @ _across(plane.along)])
        return cls(plane, weights, odd, even, by_odd, by_even)

    @property
    def mean(self) -> Complexes:
        """Mean of ``exp(2 pi i D)``, (n,)."""
        return mean_waves(*self._parts)

    @property
    def slopes(self) -> Complexes:
        """Its derivatives by the six coefficients, (6, n)."""
        by_x, by_y, spherical, coma_along, coma_across = mean_slopes(*self._parts)
        along = self.plane.along
        coma = along * coma_along + _across(along) * coma_across
        by_waves = _by_waves(by_x, by_y, self.plane)
        return np.asarray(2 * math.pi * np.vstack([by_waves, coma, spherical]), complex)

    @property
    def _parts(self) -> tuple[NDArray[np.intp], Floats, Floats, Floats, Floats, Floats]:
        ring = self.plane.rings[1]
        return ring, self.weights, self.odd, self.even, self.by_odd, self.by_even


def _common_part(p: Floats, plane: Plane) -> tuple[Floats, Floats, Floats, Floats]:
    """Half the shift of the pupil, (r, 1), and nodes x and y and weights, (r, m) each: once for
    every distance from zero frequency."""
    cutoff, obscuration = aperture(p[0], p[1])
    shift = np.minimum(plane.rings[0] / cutoff, 1.0)
    return shift[:, None], *overlap_nodes(shift, float(obscuration))


def _tilts(p: Floats, plane: Plane) -> tuple[Floats, Floats]:
    """What defocus and astigmatism give D of s x and of s y, (n,) each."""
    by_x = _DEFOCUS * p[2] + _ASTIGMATISM * (p[3:5] @ plane.twice)
    return np.asarray(by_x), np.asarray(_ASTIGMATISM * (p[3:5] @ _across(plane.twice)))


def _by_waves(by_x: NDArray[Any], by_y: NDArray[Any], plane: Plane) -> NDArray[Any]:
    """Derivatives by defocus and both astigmatisms, (3, n), of those by the two tilts, (n,)."""
    astigmatism = _ASTIGMATISM * (plane.twice * by_x + _across(plane.twice) * by_y)
    return np.vstack([_DEFOCUS * by_x, astigmatism])


def _across(along: Floats) -> Floats:
    """Vectors (2, n) turned by a quarter."""
    return np.stack([-along[1], along[0]])


def _astigmatic_numbers(p: Floats) -> dict[str, float]:
    cutoff, obscuration = aperture(p[0], p[1])
    return {
        "cutoff_cpp": float(cutoff),
        "obscuration": float(obscuration),
        "defocus_waves": 2 * math.sqrt(3) * abs(float(p[2])),
        "astigmatism_waves": math.hypot(p[3], p[4]),
    }


def _numbers(p: Floats) -> dict[str, float]:
    across, along, spherical = map(float, p[5:])
    return {
        **_astigmatic_numbers(p),
        "coma_across_waves": across,
        "coma_along_waves": along,
        "spherical_waves": abs(spherical),
    }


ABERRATED = Term(
    one_by_one(_aberrated),
    (math.log(1.3), -0.5, *6 * (0.0,)),
    (0.4, 1.0, *6 * (_WAVES_STD,)),
    _numbers,
    one_by_one(_slopes),
    signed=(2, 3, 4, 7),
)
"""Cut-off and obscuration as of an aperture in focus, then the coefficients in waves: defocus,
astigmatism along 0 and 45 degrees, coma across and along, spherical aberration."""

ASTIGMATIC = Term(
    one_by_one(_astigmatic),
    ABERRATED.mean[:5],
    (*ABERRATED.std[:2], _DEFOCUS_STD, _ASTIGMATISM_STD, _ASTIGMATISM_STD),
    _astigmatic_numbers,
    one_by_one(_astigmatic_slopes),
    signed=(2, 3, 4),
)
"""The first five of them."""
