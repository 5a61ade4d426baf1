"""An aperture with aberrations of low order as one factor of a sensor: coma, astigmatism, defocus.

The transfer function of an aberrated pupil is that of the bare one times the mean of
``exp(2 pi i D)`` over what the pupil and itself, shifted, have in common, D being the difference of
the two wavefronts. For discs of radius one about -s and s, with x along the shift and y across, the
Zernike polynomials of `acutance.optics.Aberrations` give::

    D / s = x (8 sqrt(3) d + 4 sqrt(6) a_along + 24 sqrt(5) b (2 (x^2 + y^2 + s^2) - 1))
            + y 4 sqrt(6) a_across
            + sqrt(8) (2 (9 x^2 + 3 y^2 + 3 s^2 - 3) c_along + 12 x y c_across)

of defocus d, astigmatism a, spherical aberration b and coma c, whose components are those about
axes turned to the shift; what moves the image only, 2 sqrt(8) s c_along, is left out. The mean is a
quadrature over the open pupil. Where it is obscured, other coefficients stand for it: fitted to
twelve telescopes that were drawn (`acutance.optics.FAMILIES`) a form with this factor leaves .0001
to .006 of the OTF, in root mean square.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.optics.aperture import aperture_transfer
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.term import Term, aperture, columns, one_by_one

__all__ = ["ABERRATED", "diffraction"]

Complexes = NDArray[np.complex128]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_WAVES_MEAN = (0.03, 0.0, 0.0, 0.0, 0.0, 0.0)
"""At no defocus and no astigmatism both are stationary: a fit that begins there stays."""
_WAVES_STD = 0.04
"""Of every coefficient: .1 waves in all is a telescope that is just diffraction-limited."""
_STEP = 1e-5
_DEFOCUS, _ASTIGMATISM = 8 * math.sqrt(3), 4 * math.sqrt(6)


def _aberrated(p: Floats, plane: Plane) -> Complexes:
    return np.asarray(diffraction(p[:2], plane) * _Difference.of(p, plane).mean)


def _slopes(p: Floats, plane: Plane) -> Complexes:
    bare, difference = diffraction(p[:2], plane), _Difference.of(p, plane)
    cutoff, obscuration = _STEP * np.eye(2, p.size)
    by_cutoff = _aberrated(p + cutoff, plane) - _aberrated(p - cutoff, plane)
    by_obscuration = diffraction(p + obscuration, plane) - diffraction(p - obscuration, plane)
    by_pupil = np.stack([by_cutoff, by_obscuration * difference.mean]) / (2 * _STEP)
    return np.concatenate([by_pupil, bare * difference.slopes])


def diffraction(p: Floats, plane: Plane) -> Floats:
    """OTF of apertures in focus, (..., n), once for every distance from zero frequency."""
    freq, where = plane.rings
    log_cutoff, logit, *_ = columns(p)
    cutoff, obscuration = aperture(log_cutoff, logit)
    return aperture_transfer(freq / cutoff, obscuration)[..., where]


@dataclass(frozen=True, eq=False)
class _Difference:
    """The difference D of the wavefronts over what the pupil and itself, shifted, have in common.

    Attributes
    ----------
    along, twice : (2, n) array
        Unit vectors of the shifts, and of twice their angle.
    shapes : (5, n, m) array
        What D is made of: x and y, spherical aberration, coma along the shift and across it.
    waves : (n, m) complex array
        ``exp(2 pi i D)`` times the weights of the nodes.
    """

    along: Floats
    twice: Floats
    shapes: Floats
    waves: Complexes

    @classmethod
    def of(cls, p: Floats, plane: Plane) -> _Difference:
        """Of the parameters of `ABERRATED`, at places of the plane."""
        shift = np.minimum(plane.waves / (2 * math.pi * math.exp(p[0])), 1.0)
        x, y, weights = _common_part(shift)
        s = shift[:, None]
        spherical = 24 * math.sqrt(5) * s * x * (2 * (x**2 + y**2 + s**2) - 1)
        coma_along = 2 * math.sqrt(8) * s * (9 * x**2 + 3 * y**2 + 3 * s**2 - 3)
        coma_across = 12 * math.sqrt(8) * s * x * y
        shapes = np.stack([s * x, s * y, spherical, coma_along, coma_across])
        length = np.maximum(np.hypot(plane.u_cpp, plane.v_cpp), 1e-12)
        along = np.stack([plane.u_cpp, plane.v_cpp]) / length
        twice = np.stack([along[0] ** 2 - along[1] ** 2, 2 * along[0] * along[1]])
        amounts = np.stack(
            [
                _DEFOCUS * p[2] + _ASTIGMATISM * (p[3:5] @ twice),
                _ASTIGMATISM * (p[3:5] @ _across(twice)),
                np.full(shift.size, p[7]),
                p[5:7] @ along,
                p[5:7] @ _across(along),
            ]
        )
        difference = np.einsum("kn,knm->nm", amounts, shapes)
        return cls(along, twice, shapes, weights * np.exp(2j * math.pi * difference))

    @property
    def mean(self) -> Complexes:
        """Mean of ``exp(2 pi i D)``, (n,)."""
        return np.asarray(self.waves.sum(axis=1))

    @property
    def slopes(self) -> Complexes:
        """Its derivatives by the six coefficients, (6, n)."""
        by_x, by_y, spherical, coma_along, coma_across = np.sum(self.waves * self.shapes, axis=2)
        astigmatism = _ASTIGMATISM * (self.twice * by_x + _across(self.twice) * by_y)
        coma = self.along * coma_along + _across(self.along) * coma_across
        return 2j * math.pi * np.vstack([_DEFOCUS * by_x, astigmatism, coma, spherical])


def _across(along: Floats) -> Floats:
    """Vectors (2, n) turned by a quarter."""
    return np.stack([-along[1], along[0]])


def _common_part(shift: Floats) -> tuple[Floats, Floats, Floats]:
    """Nodes x and y and weights of what two discs have in common, by shift, (n, m) each."""
    # By the angle on the farther disc's rim: its chords have no infinite slope.
    end = np.arccos(shift)[:, None]
    angle = 0.5 * end * (_NODES + 1)
    x, chord = np.cos(angle) - shift[:, None], np.sin(angle)
    strip = _WEIGHTS * chord**2
    x, chord = np.hstack([x, -x])[..., None], np.hstack([chord, chord])[..., None]
    weights = np.hstack([strip, strip])[..., None] * _WEIGHTS
    total = np.maximum(weights.sum(axis=(1, 2), keepdims=True), 1e-300)
    rows = shift.size
    return (
        np.broadcast_to(x, weights.shape).reshape(rows, -1),
        (chord * _NODES).reshape(rows, -1),
        (weights / total).reshape(rows, -1),
    )


def _numbers(p: Floats) -> dict[str, float]:
    cutoff, obscuration = aperture(p[0], p[1])
    defocus, astigmatism, astigmatism_45, across, along, spherical = map(float, p[2:])
    return {
        "cutoff_cpp": float(cutoff),
        "obscuration": float(obscuration),
        "defocus_waves": 2 * math.sqrt(3) * abs(defocus),
        "astigmatism_waves": math.hypot(astigmatism, astigmatism_45),
        "coma_across_waves": across,
        "coma_along_waves": along,
        "spherical_waves": abs(spherical),
    }


ABERRATED = Term(
    one_by_one(_aberrated),
    (math.log(1.3), -0.5, *_WAVES_MEAN),
    (0.4, 1.0, *6 * (_WAVES_STD,)),
    _numbers,
    one_by_one(_slopes),
)
"""Cut-off and obscuration as of an aperture in focus, then the coefficients in waves: defocus,
astigmatism along 0 and 45 degrees, coma across and along, spherical aberration."""
