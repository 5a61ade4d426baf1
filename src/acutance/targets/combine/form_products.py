"""Parametric sensors side by side: each a product of terms with diffusion and a detector.

Every term is worked out once for all sensors that have it: thirty forms of few places cost little
more than a few.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.targets.combine.detector_terms import DETECTOR_PARAMETERS, detector_terms
from acutance.targets.combine.plane import Plane
from acutance.targets.combine.sensor_terms import TERMS
from acutance.targets.combine.term import Term, Transfer

__all__ = ["FormProducts"]

Complexes = NDArray[np.complex128]
Places = NDArray[np.intp]

_STEP = 1e-5


class _Use(NamedTuple):
    """Where a term stands among the sensors.

    Attributes
    ----------
    term : Term
    sensor : (m,) int array
    factor : (m,) int array
        Which factor of the sensor it is.
    parameters : (m, k) int array
        Which parameters of the sensor are its own.
    """

    term: Term
    sensor: Places
    factor: Places
    parameters: Places

    def of(self, p: Floats) -> Floats:
        """Its parameters, (m, k), of those of all sensors, (f, p)."""
        return np.asarray(p[self.sensor[:, None], self.parameters])


@dataclass(frozen=True, eq=False)
class FormProducts:
    """Parametric sensors, the same ones several times if that is asked for.

    Parameters
    ----------
    terms : tuple of tuples of str
        Names in `TERMS` of every sensor.
    detector_px : (float, float)
        Width of the detectors across and along, in pixels.
    """

    terms: tuple[tuple[str, ...], ...]
    detector_px: tuple[float, float]

    @cached_property
    def counts(self) -> Places:
        """How many parameters every sensor has, (f,): terms', then diffusion's, the detector's."""
        own = [sum(len(TERMS[name].mean) for name in names) for names in self.terms]
        return np.array(own, np.intp) + DETECTOR_PARAMETERS

    @cached_property
    def mean(self) -> Floats:
        """Prior mean of all parameters, (f, p); 0 of those a sensor does not have."""
        return self._of_prior("mean", 0.0)

    @cached_property
    def std(self) -> Floats:
        """Prior standard deviation of all parameters, (f, p); 1 of those a sensor has not."""
        return self._of_prior("std", 1.0)

    def _of_prior(self, name: str, else_: float) -> Floats:
        found = np.full((len(self.terms), int(self.counts.max())), else_)
        for use in self._uses:
            found[use.sensor[:, None], use.parameters] = getattr(use.term, name)
        return found

    @cached_property
    def _uses(self) -> tuple[_Use, ...]:
        """Of every term that is used."""
        last = detector_terms(self.detector_px)
        found: dict[str, list[tuple[int, int, int]]] = {}
        known = {**TERMS, **last}
        for sensor, names in enumerate(self.terms):
            at = 0
            for factor, name in enumerate((*names, *last)):
                found.setdefault(name, []).append((sensor, factor, at))
                at += len(known[name].mean)
        uses = []
        for name, places in found.items():
            sensor, factor, at = np.array(places, np.intp).T
            parameters = at[:, None] + np.arange(len(known[name].mean))
            uses.append(_Use(known[name], sensor, factor, parameters))
        return tuple(uses)

    def some(self, kept: Places) -> FormProducts:
        """Some of the sensors, each at most once, in their order."""
        place = np.full(len(self.terms), -1, np.intp)
        place[kept] = np.arange(kept.size)
        found = FormProducts(tuple(self.terms[i] for i in kept.tolist()), self.detector_px)
        # All are known: what is left of every term's uses need not be sought again.
        vars(found).update(
            counts=self.counts[kept],
            mean=self.mean[kept],
            std=self.std[kept],
            _uses=tuple(self._left(place)),
        )
        return found

    def _left(self, place: Places) -> Iterator[_Use]:
        for use in self._uses:
            own = place[use.sensor]
            kept = own >= 0
            if kept.any():
                yield _Use(use.term, own[kept], use.factor[kept], use.parameters[kept])

    def factors(self, p: Floats, plane: Plane) -> Complexes:
        """OTFs of all terms, of diffusion, of the detector, (factors, f, n); 1 where none is.

        Parameters
        ----------
        p : (f, p) array
        plane : Plane
        """
        most = max(int(use.factor.max()) for use in self._uses) + 1
        found = np.ones((most, len(self.terms), plane.u_cpp.size), complex)
        for use in self._uses:
            found[use.factor, use.sensor] = use.term.otf(use.of(p), plane)
        return found

    @cached_property
    def places(self) -> tuple[Places, Places]:
        """Sensor and parameter of each of the r parameters that the sensors have, (r,) each."""
        own = np.arange(int(self.counts.max())) < self.counts[:, None]
        sensor, parameter = np.nonzero(own)
        return sensor, parameter

    def slopes(self, p: Floats, plane: Plane, factors: Complexes) -> Complexes:
        """Derivatives of the OTFs by the parameters, (f, p, n), the factors being known."""
        found = np.zeros((*p.shape, factors.shape[2]), complex)
        found[self.places] = self.own_slopes(p, plane, factors)
        return found

    def own_slopes(self, p: Floats, plane: Plane, factors: Complexes) -> Complexes:
        """The same by the parameters at `places` alone, (r, n).

        Of the forms of a scene half of the parameters of the longest are none of the others.
        """
        others = _products_of_others(factors)
        begin = np.cumsum(self.counts) - self.counts
        found = np.empty((int(self.counts.sum()), factors.shape[2]), complex)
        for use in self._uses:
            term, own = use.term, use.of(p)
            if term.slopes is None:
                slopes = _differences(term.otf, factors[use.factor, use.sensor], own, plane)
            else:
                slopes = term.slopes(own, plane)
            slopes = others[use.factor, use.sensor][:, None] * slopes
            found[begin[use.sensor, None] + use.parameters] = slopes
        return found


def _products_of_others(factors: Complexes) -> Complexes:
    """Of every factor (k, ...) the product of all others."""
    found = np.ones_like(factors)
    for i in range(1, len(factors)):
        found[i] = found[i - 1] * factors[i - 1]
    after = factors[-1].copy()
    for i in range(len(factors) - 2, -1, -1):
        found[i] *= after
        after *= factors[i]
    return found


def _differences(otf: Transfer, here: NDArray[Any], p: Floats, plane: Plane) -> NDArray[Any]:
    """Derivatives by the parameters, (m, k, n), by differences from OTFs as they are `here`.

    To one side: a step leads away from a smear or a trail of 0, which is stationary. By slopes in
    closed form a fit that comes there stays.
    """
    moved = otf(p[:, None, :] + _STEP * np.eye(p.shape[1]), plane)
    return np.asarray((moved - here[:, None]) / _STEP)
