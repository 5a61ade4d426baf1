"""Sharpness over the field of view: the blur of a sensor as a smooth surface.

At a place p of the field the logarithm of the optical transfer function (OTF) is that of the
middle plus modes of blur (`acutance.scan.blur_modes`), whose amounts are polynomials of p of the
second degree at most::

    ln H(u, v; p) = ln H(u, v) + sum over j, m of (P_j(p) - c_jm) a_jm psi_m(u, v)

P_j are Legendre polynomials over the field, whose mean is zero; c_jm is the mean of P_j over the
edges, each weighted by what it tells of mode m, so that errors of H and of a are independent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.curves.otf2d import OtfModel, PackableOtf
from acutance.curves.short_repr import ShortRepr
from acutance.scan.blur_modes import blur_modes

__all__ = ["DEGREES", "Field", "FieldOtf", "field_places", "field_polynomials"]

Complexes = NDArray[np.complex128]

DEGREES: Final = (1, 1, 2, 2, 2)
"""Of the polynomials: columns, rows, columns twice, both, rows twice."""
_MAX_LOG_GAIN: Final = 1.0
"""Beyond the band a change would grow without bounds, of light that is not there."""
_EVERY_DEG: Final[Floats] = np.linspace(0.0, 180.0, 361)
"""A sensor is computed along these: a scene may have more edges than it has directions."""


def field_places(roi: tuple[int, int, int, int], row: Floats, col: Floats) -> tuple[Floats, Floats]:
    """Places in a field (row, col, height, width), -1 to 1 along columns (x) and rows (y)."""
    return _centred(col, *roi[1::2]), _centred(row, *roi[::2])


def field_polynomials(x: Floats, y: Floats) -> Floats:
    """Legendre polynomials of places, -1 to 1 over the field, (n, 5)."""
    parts = [x, y, 1.5 * x * x - 0.5, x * y, 1.5 * y * y - 0.5]
    return np.asarray(np.stack(parts, axis=-1))


@dataclass(frozen=True, eq=False)
class FieldOtf(ShortRepr):
    """The OTF at a place of the field, an `acutance.curves.OtfModel`.

    Parameters
    ----------
    base : OtfModel
        In the middle of the edges.
    weight : (5, 4) array
        Of the polynomials at the place, by mode.
    amount : (20,) array
    root : (20, r) array
        Factor of its covariance.
    """

    base: OtfModel
    weight: Floats
    amount: Floats
    root: Floats

    @property
    def band_cpp(self) -> float:
        """Highest frequency that is transferred."""
        return self.base.band_cpp

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), exactly 1 at zero frequency."""
        return np.asarray(self.base.otf(u_cpp, v_cpp) * self._gain(u_cpp, v_cpp))

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k): of the middle, and of the change."""
        gain = self._gain(u_cpp, v_cpp)[:, None]
        change = self.base.otf(u_cpp, v_cpp)[:, None] * (self._modes(u_cpp, v_cpp) @ self.root)
        own = self.base.factor(u_cpp, v_cpp)
        return np.asarray(np.concatenate([own, change], axis=1) * gain)

    def packed(self) -> FieldOtf:
        """The same in fewer bytes, where the middle has a lighter form."""
        if not isinstance(self.base, PackableOtf):
            return self
        return replace(self, base=self.base.packed())

    def _modes(self, u_cpp: Floats, v_cpp: Floats) -> Floats:
        """Change of the logarithm of the OTF by a unit of every amount, (n, 20)."""
        each = self.weight[None] * blur_modes(u_cpp, v_cpp)[:, None]
        return np.asarray(each.reshape(len(each), -1))

    def _gain(self, u_cpp: Floats, v_cpp: Floats) -> Floats:
        log_gain = self._modes(u_cpp, v_cpp) @ self.amount
        return np.asarray(np.exp(np.minimum(log_gain, _MAX_LOG_GAIN)))


@dataclass(frozen=True, eq=False)
class Field(ShortRepr):
    """How the blur of a sensor changes over the part of an image that was scanned.

    Parameters
    ----------
    roi : (row, col, height, width)
        The part.
    middle : (5, 4) array
        Means of the polynomials over the edges, by mode.
    amount : (20,) array
        Of polynomials and modes, px^2.
    root : (20, r) array
        Factor of its covariance.
    chance_constant : float
        Probability that sharpness is the same everywhere, 0 to 1; ``nan`` of too few edges (see
        `is_fitted`), which tell nothing of it.
    """

    roi: tuple[int, int, int, int]
    middle: Floats
    amount: Floats
    root: Floats
    chance_constant: float

    def __post_init__(self) -> None:
        # What the fit has then is what was taken for likely before any edge was seen.
        if not self.is_fitted:
            object.__setattr__(self, "chance_constant", math.nan)

    @property
    def is_fitted(self) -> bool:
        """Whether there were edges enough to ask how sharpness changes."""
        return self.root.size > 0

    def mean_of(self, base: OtfModel) -> FieldOtf:
        """The mean over the field of a sensor that is `base` in the middle of the edges."""
        return FieldOtf(base, -self.middle, self.amount, self.root)

    def at(self, base: OtfModel, row: float, col: float) -> FieldOtf:
        """The sensor at a place, in pixels of the image."""
        weight = field_polynomials(*self.places(np.array(row), np.array(col)))
        return FieldOtf(base, weight[:, None] - self.middle, self.amount, self.root)

    def mtf_nyquist(self, base: OtfModel, row: Floats, col: Floats, normal_deg: Floats) -> Floats:
        """MTF at Nyquist at places (n,) along normals (n,): that of `at`, of many at once.

        Parameters
        ----------
        base : OtfModel
            In the middle of the edges.
        row, col : (n,) arrays
            In pixels of the image.
        normal_deg : (n,) array
        """
        every = np.abs(base.otf(*_nyquist(_EVERY_DEG)))
        middle = np.interp(np.mod(normal_deg, 180.0), _EVERY_DEG, every)
        weight = field_polynomials(*self.places(row, col))[:, :, None] - self.middle
        by_mode = np.sum(weight * self.amount.reshape(len(DEGREES), -1), axis=1)
        log_gain = np.sum(by_mode * blur_modes(*_nyquist(normal_deg)), axis=1)
        return np.asarray(middle * np.exp(log_gain))

    def change(self, row: float, col: float, u_cpp: Floats, v_cpp: Floats) -> tuple[Floats, Floats]:
        """Logarithm of the MTF at a place over its mean, and its standard deviation, (n,) each."""
        place = field_polynomials(*self.places(np.array(row), np.array(col)))
        modes = place[None, :, None] * blur_modes(u_cpp, v_cpp)[:, None]
        modes = modes.reshape(len(modes), -1)
        return modes @ self.amount, np.linalg.norm(modes @ self.root, axis=1)

    def places(self, row: Floats, col: Floats) -> tuple[Floats, Floats]:
        """Places in the field, -1 to 1 along columns (x) and rows (y)."""
        return field_places(self.roi, row, col)

    def grid(self, rows: int, cols: int) -> tuple[Floats, Floats]:
        """Rows and columns of the middles of so many equal parts of the field."""
        row, col, height, width = self.roi
        return _middles(row, height, rows), _middles(col, width, cols)

    def holds(self, row: Floats, col: Floats) -> NDArray[np.bool_]:
        """Whether places lie in the field."""
        x, y = self.places(row, col)
        return np.asarray((np.abs(x) <= 1.0) & (np.abs(y) <= 1.0))

    def summary(self) -> str:
        """How likely it is that nothing changes."""
        if not self.is_fitted:
            return "taken for constant: too few edges to ask"
        return f"constant with a chance of {self.chance_constant:.2g}"

    def to_dict(self) -> dict[str, Any]:
        """The chance of no change, for JSON; None where the edges are too few to ask."""
        return {"chance_constant": round(self.chance_constant, 4) if self.is_fitted else None}


def _centred(values: Floats, start: int, size: int) -> Floats:
    half = 0.5 * size
    return np.asarray((values - (start - 0.5) - half) / half)


def _middles(start: int, size: int, count: int) -> Floats:
    return np.asarray(start - 0.5 + size * (np.arange(count) + 0.5) / count)


def _nyquist(normal_deg: Floats) -> tuple[Floats, Floats]:
    """Frequencies u and v of Nyquist along normals."""
    angle = np.radians(normal_deg)
    return NYQUIST_CPP * np.cos(angle), NYQUIST_CPP * np.sin(angle)
