"""All curves near any optical transfer function (OTF), the light of each integrated out.

Pixels show a spectrum, the OTF times the light h of the image. A whitened one is ``h w + e``, with
``w = R^T f + level`` linear in the OTF f (`acutance.targets.otf_likelihood`) and errors e of unit
variance. With a prior as wide as ``dh / h`` the integral over h is, to second order about its
largest value at ``h = w y / w w``, the density there times the same number for every OTF: a
variable projection (G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10, 413, 1973). Of the
slopes those of the projected OTF are kept (L. Kaufman, BIT 15, 49, 1975): the gradient of the sum
of squares is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.targets.combine.curves import WhitenedCurves

__all__ = ["LitCurves"]

Complexes = NDArray[np.complex128]
Places = NDArray[np.intp]

_NO_LIGHT = 1e-30


@dataclass(frozen=True, eq=False)
class LitCurves:
    """All curves about an OTF, or about several, each in the light that suits it best.

    Parameters
    ----------
    data : WhitenedCurves
    otf : (..., n) complex array
        At all places.
    """

    data: WhitenedCurves
    otf: Complexes

    @cached_property
    def _whole(self) -> Floats:
        """The OTF as a whitened spectrum of unit light, (..., size)."""
        return self.data.of(self.otf) + self.data.level

    @cached_property
    def _square(self) -> Floats:
        """Its square, of every curve, (..., curves)."""
        return np.maximum(self.data.sums(self._whole**2), _NO_LIGHT)

    @cached_property
    def light(self) -> Floats:
        """The light of every value's spectrum, (..., size); 1 of curves that are no spectra."""
        seen = self.data.sums(self._whole * self.data.values)
        return self.data.of_spectra(seen / self._square, 1.0)

    @cached_property
    def residual(self) -> Floats:
        """What the OTF leaves of all values, (..., size)."""
        return self.data.values - self.light * self._whole

    def of(self, values: Complexes) -> Floats:
        """Changes of the OTF, (..., n) or (..., p, n), whitened, less what light makes up for."""
        whitened = self.data.of(values)
        return self.apart(_beside(self.light, whitened) * whitened)

    def apart(self, whitened: Floats) -> Floats:
        """Whitened values (..., size) or (..., p, size), less their part along each spectrum."""
        whole, square = (_beside(one, whitened) for one in (self._whole, self._square))
        along = self.data.of_spectra(self.data.sums(whole * whitened) / square, 0.0)
        return np.asarray(whitened - whole * along)

    def put(self, values: Complexes, places: tuple[Places, Places], found: Floats) -> None:
        """Put changes of several OTFs (r, n) at their places (OTF, which) of (b, p, size).

        Whitened, less what light makes up for, as `of` has them; in one walk over them.
        """
        starts, is_lit = self.data.spectra
        _put(
            self.data.of(values), *places, self.light, self._whole, self._square, starts, is_lit,
            found,
        )  # fmt: skip

    def some(self, kept: NDArray[np.intp]) -> LitCurves:
        """Those about some of several OTFs; what is known of them is not worked out again."""
        known = {name: values[kept] for name, values in vars(self).items() if name != "data"}
        found = LitCurves(self.data, known["otf"])
        vars(found).update(known)
        return found


@compiled
def _put(
    whitened: Floats, owner: Places, number: Places, light: Floats, whole: Floats, square: Floats,
    starts: Places, is_lit: NDArray[np.bool_], found: Floats,
) -> None:  # fmt: skip
    for row in range(owner.size):
        one = owner[row]
        out = found[one, number[row]]
        for curve in range(is_lit.size):
            first, end = starts[curve], starts[curve + 1]
            if not is_lit[curve]:
                for i in range(first, end):
                    out[i] = whitened[row, i]
                continue
            along = 0.0
            for i in range(first, end):
                along += whole[one, i] * whitened[row, i]
            own = light[one, first]
            along *= own / square[one, curve]
            for i in range(first, end):
                out[i] = own * whitened[row, i] - along * whole[one, i]


def _beside(own: Floats, others: Floats) -> Floats:
    """One for each OTF, for arithmetic with several for each."""
    return own if own.ndim == others.ndim else own[..., None, :]
