"""OTFs of several weighted forms of sensor at places of the plane, and how they change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.targets.combine.form_products import FormProducts
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.sensor_forms import SensorForm

if TYPE_CHECKING:
    from acutance.targets.combine.weighted_forms import WeightedForm

__all__ = ["FormsOnPlane"]

Complexes = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class FormsOnPlane:
    """Forms at places of the plane: their terms are worked out together.

    Parameters
    ----------
    forms : sequence of WeightedForm
        With detectors of one width.
    plane : Plane
        Of n places.
    """

    forms: Sequence[WeightedForm]
    plane: Plane

    @cached_property
    def otfs(self) -> Complexes:
        """OTF of every form, (f, n), exactly 1 at zero frequency."""
        found = np.asarray(self._factors.prod(axis=0))
        for own, one in zip(found, self.forms, strict=True):
            if one.weights.size:
                own += self._directions[id(one.correction)] @ one.weights
        return found

    @cached_property
    def mean(self) -> Complexes:
        """Their mean by weight, (n,)."""
        return np.asarray(np.array([one.weight for one in self.forms]) @ self.otfs)

    @cached_property
    def slopes(self) -> list[Complexes]:
        """Derivatives of every OTF by parameters and weights of the correction, (n, p + m)."""
        slopes = self._products.slopes(self._parameters, self.plane, self._factors)
        found = []
        for own, one in zip(slopes, self.forms, strict=True):
            by_parameters = own[: one.parameters.size].T
            if one.weights.size:
                by_weights = self._directions[id(one.correction)]
                by_parameters = np.concatenate([by_parameters, by_weights], axis=1)
            found.append(by_parameters)
        return found

    @cached_property
    def _products(self) -> FormProducts:
        return _products(tuple(one.form for one in self.forms))

    @cached_property
    def _parameters(self) -> Floats:
        found = np.zeros_like(self._products.mean)
        for own, one in zip(found, self.forms, strict=True):
            own[: one.parameters.size] = one.parameters
        return found

    @cached_property
    def _factors(self) -> Complexes:
        return self._products.factors(self._parameters, self.plane)

    @cached_property
    def _directions(self) -> dict[int, Complexes]:
        """Of every correction that is used, by its identity, (n, m): most forms share one."""
        used = {id(one.correction): one.correction for one in self.forms if one.weights.size}
        return {name: one.directions_on(self.plane) for name, one in used.items()}


@lru_cache(maxsize=64)
def _products(forms: tuple[SensorForm, ...]) -> FormProducts:
    return FormProducts(tuple(one.terms for one in forms), forms[0].detector_px)
