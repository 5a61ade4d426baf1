"""The sensor of a scene: one optical transfer function (OTF) over the plane, under all edges.

Expectation and maximisation by turns: what every edge is, given the sensor (`population`); the
sensor, given that, as the combination of all directions (`acutance.targets.combine`). The last
turn takes the information that is left when what the edges are is integrated out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.numerics.stacked import unstacked
from acutance.scan.population import (
    EdgeLikelihoods,
    Membership,
    expected_information,
    fit_shares,
    observed_information,
    share_std,
)
from acutance.targets.combine.curves import OtfSamples
from acutance.targets.combine.fit import CombinedFit, combine_curves
from acutance.targets.combine.sensor_forms import FORMS
from acutance.targets.combine.weighted_forms import CombinedOtf
from acutance.targets.otf_likelihood import OtfLikelihood
from acutance.targets.slices import places_along

__all__ = ["SensorFit", "fit_sensor"]

_START: Final[Floats] = np.array([0.6, 0.1, 0.1, 0.1, 0.1])
_SETTLED: Final = 1e-3
_MAX_TURNS: Final = 12
_COMMON_STD, _COMMON_CPP = 3e-3, 0.15
"""Error of the transfer function that all edges of a sensor have in common, and over which
frequencies: what the prior of an edge's line spread function does not allow for does not average
out (benchmarks/scenes.py: errors of .000 to .004 at Nyquist, by the shape of the sensor)."""
_GAINS: Final = (0.7, 1.4)
"""Between these the sensor along an edge's normal is of that along its bin."""
_LEAST: Final = 1e3
"""Information of a direction whose edges are all strange: it has no part in a turn."""
_EXACT: Final = 1e7
"""One over the error of what is exact."""
_UNSEEN: Final = 1.0
"""Information of combinations that edges do not show: the OTF is between 0 and 1."""


@dataclass(frozen=True, eq=False)
class SensorFit:
    """The sensor and the objects of a scene.

    Attributes
    ----------
    combined : CombinedFit
        The sensor, fitted to all directions.
    normal_deg : (b,) array
        Mean direction of every bin.
    share, share_std : (5,) arrays
        Of `population.PARTS`.
    member : Membership
        What every edge is.
    turns : int
    settled : bool
    """

    combined: CombinedFit
    normal_deg: Floats
    share: Floats
    share_std: Floats
    member: Membership
    turns: int
    settled: bool

    @property
    def otf(self) -> CombinedOtf:
        """The sensor. Its edges are one measurement: there is nothing it could disagree with."""
        return CombinedOtf(self.combined.otf.forms, 1.0)


def fit_sensor(edges: EdgeLikelihoods, normal_deg: Floats, guesses: Sequence[Floats]) -> SensorFit:
    """Fit the sensor of a scene.

    Parameters
    ----------
    edges : EdgeLikelihoods
    normal_deg : (b,) array
        Mean direction of every bin.
    guesses : sequence of (b, 2 k) arrays
        First guesses of the OTF in every direction, real parts first: the likeliest counts.
    """
    otf = max(guesses, key=lambda one: fit_shares(edges, one, _START)[1].log_likelihood)
    share, forms, seen = _START, FORMS, edges
    turns, settled = 0, False
    while turns < _MAX_TURNS and not settled:
        turns += 1
        share, member = fit_shares(seen, otf, share)
        information, projection = expected_information(seen, member)
        curves = [
            _samples(normal_deg[[b]], edges.freq_cpp, otf[b], own, pull - own @ otf[b])
            for b, (own, pull) in enumerate(zip(information, projection, strict=True))
            if np.trace(own) > _LEAST
        ]
        combined = combine_curves(curves, forms=forms).otf
        # Forms without any weight have none in the next turn, either.
        forms = tuple({form.form.terms: None for form in combined.forms})
        found = _along(combined, normal_deg, edges.freq_cpp)
        updated = np.hstack([found.real, found.imag])
        settled = float(np.abs(updated - otf)[:, _in_band(edges.freq_cpp)].max()) < _SETTLED
        otf, seen = updated, _along_bins(edges, normal_deg, combined)
    share, member = fit_shares(seen, otf, share)
    left, gradient = observed_information(seen, otf, member, share)
    samples = _samples(normal_deg, edges.freq_cpp, otf.ravel(), left, gradient)
    return SensorFit(
        combine_curves([samples]), normal_deg, share, share_std(member, share), member, turns,
        settled,
    )  # fmt: skip


def _along_bins(edges: EdgeLikelihoods, normal_deg: Floats, sensor: CombinedOtf) -> EdgeLikelihoods:
    """What the edges say of the sensor along their bins; along their own normals it differs."""
    own, mean = (
        np.abs(_along(sensor, angle, edges.freq_cpp)) for angle in (edges.normal_deg, normal_deg)
    )
    low, high = _GAINS
    return edges.turned(np.clip(own / np.maximum(mean[edges.bin], 1e-3), low, high))


def _in_band(freq_cpp: Floats) -> NDArray[np.bool_]:
    """Which of the real and imaginary parts lie below Nyquist."""
    return np.tile(freq_cpp <= NYQUIST_CPP, 2)


def _along(sensor: CombinedOtf, normal_deg: Floats, freq_cpp: Floats) -> NDArray[np.complex128]:
    """The OTF in every direction, (b, k)."""
    otf = sensor.otf(*places_along(normal_deg, freq_cpp))
    return np.asarray(otf.reshape(normal_deg.size, freq_cpp.size))


def _samples(
    normal_deg: Floats, freq_cpp: Floats, otf: Floats, information: Floats, pull: Floats
) -> OtfSamples:
    """A likelihood about an OTF: its information, and its gradient there.

    Parameters
    ----------
    normal_deg : (b,) array
    freq_cpp : (k,) array
    otf, pull : (b * 2 k,) arrays
        Direction by direction, of each the real parts first.
    information : (b * 2 k, b * 2 k) array
    """
    order = _real_first(normal_deg.size, freq_cpp.size)
    size, axes = np.linalg.eigh(information[np.ix_(order, order)])
    seen = size > _UNSEEN
    root = axes[:, seen] * np.sqrt(size[seen])
    values = root.T @ otf[order] + (root / size[seen]).T @ pull[order]
    # One more value: at zero frequency the OTF is 1, whatever light an image has.
    root = np.column_stack([root, np.zeros(len(root))])
    level = np.append(np.zeros(values.size), _EXACT)
    likelihood = OtfLikelihood(unstacked(root), level, np.append(values, _EXACT))
    likelihood = likelihood.with_errors(_common_errors(normal_deg.size, freq_cpp))
    u, v = places_along(normal_deg, freq_cpp)
    about = unstacked(otf[order])
    return OtfSamples("edges", u, v, about, np.zeros((about.size, 1), complex), likelihood)


def _common_errors(bins: int, freq_cpp: Floats) -> NDArray[np.complex128]:
    """Factor of the errors that all edges have in common, the same in all directions."""
    away = (freq_cpp[:, None] - freq_cpp) / _COMMON_CPP
    size, axes = np.linalg.eigh(np.exp(-0.5 * away**2))
    root = np.tile(_COMMON_STD * axes * np.sqrt(np.maximum(size, 0.0)), (bins, 1))
    return np.hstack([root, 1j * root])


def _real_first(bins: int, frequencies: int) -> Floats:
    """Where all real parts stand, then all imaginary ones."""
    places = np.arange(bins * 2 * frequencies).reshape(bins, 2, frequencies)
    return np.asarray(places.transpose(1, 0, 2).ravel())
