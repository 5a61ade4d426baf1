"""Turns by which the sensor of a scene is found: what the edges are, and the sensor given that.

Each turn asks how the sensor may change (`acutance.scan.form_modes`), what every edge is
(`acutance.scan.population`), and what sensor all directions together have then
(`acutance.targets.combine`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.numerics.stacked import stacked, unstacked
from acutance.scan.blur_modes import changed, fit_modes
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.form_agreement import common_errors
from acutance.scan.form_modes import blur_ways, form_ways
from acutance.scan.information import expected_information
from acutance.scan.population import fit_shares
from acutance.targets.combine.curves import OtfSamples
from acutance.targets.combine.fit import CombinedFit, combine_curves
from acutance.targets.combine.weighted_forms import CombinedOtf, WeightedForm
from acutance.targets.otf_likelihood import OtfLikelihood
from acutance.targets.slices import places_along

__all__ = ["AS_LIKELY", "SAME", "SensorState", "along_bins", "apart", "otf_samples", "settled"]

_SETTLED: Final = 0.1
"""Square of a turn's change, in standard deviations of what the edges say."""
_MAX_TURNS: Final = 24
_GAINS: Final = (0.7, 1.4)
"""Between these the sensor along an edge's normal is of that along its bin."""
_LEAST: Final = 1e3
"""Information of a direction whose edges are all strange: it has no part in a turn."""
_UNSEEN: Final = 1.0
"""Information of combinations that edges do not show: the OTF is between 0 and 1."""
SAME: Final = 0.003
"""Root mean square difference of the MTF of sensors that are one."""
_FIRST_TURNS: Final = 2
_RISE: Final = 1.0
"""Of the log likelihood in a turn: as long as it rises by so much, the next turn goes along the
ways of the form. A mean over forms is none of them, and would go to and fro."""
AS_LIKELY: Final = 4.0
"""Sensors that are less likely by no more than this, in the log likelihood, count with the best."""
_PATIENCE: Final = 5.0
"""Turns rise less and less: a start that lies behind by more than so many rises is given up."""
_FINE_DEG: Final[Floats] = np.linspace(-90.0, 90.0, 181)
"""Directions between which the modulus of a sensor is linear."""


class SensorState(NamedTuple):
    """A sensor between two turns.

    Attributes
    ----------
    otf : (b, 2 k) array
        Along the bins, in the middle of the edges.
    share : (g, p) array
    forms : sequence of tuples of str
        Forms of sensors that have some weight.
    combined : CombinedFit or None
        Such forms where they were fitted last.
    along : EdgeLikelihoods
        What the edges say of the sensor along their bins.
    log_likelihood : float
        Of the edges.
    turns : int
    settled : bool
    """

    otf: Floats
    share: Floats
    forms: Sequence[tuple[str, ...]]
    combined: CombinedFit | None
    along: EdgeLikelihoods
    log_likelihood: float
    turns: int
    settled: bool

    @property
    def near(self) -> Sequence[WeightedForm]:
        """Forms where they were fitted last, if they were."""
        return () if self.combined is None else self.combined.near


def apart(one: Floats, other: Floats, freq_cpp: Floats) -> float:
    """Root mean square difference of two sensors' MTF along the bins, up to Nyquist."""
    below = freq_cpp <= NYQUIST_CPP
    moduli = (np.abs(unstacked(otf.T))[below] for otf in (one, other))
    return float(np.sqrt(np.mean(np.subtract(*moduli) ** 2)))


def settled(
    edges: EdgeLikelihoods,
    normal_deg: Floats,
    state: SensorState,
    log_gain: Floats,
    rival: SensorState | None = None,
) -> SensorState:
    """The sensor after as many turns as it needs, under a given change over the field (n, k).

    Or after so many that it will not reach the log likelihood of a `rival`, or is where that is.
    """
    ways = blur_ways(normal_deg, edges.freq_cpp)
    otf, share, forms, combined, along, _, turns, _ = state
    near = state.near
    before: Floats | None = None
    moved, last, is_rising = np.zeros_like(otf), -np.inf, True
    for turn in range(_MAX_TURNS + 1):
        seen = along.turned(np.exp(log_gain))
        found = fit_modes(
            seen, otf, share, ways.modes[edges.bin],
            mean=ways.mean, std=ways.std, longest=ways.longest,
        )  # fmt: skip
        otf = changed(otf, ways.modes @ found.amount)
        if before is not None:
            moved = _calmed(otf - before, moved)
            otf = before + moved
        member = fit_shares(seen, otf, found.share)
        share, reached = member.share, member.log_likelihood
        is_rising = is_rising and (turn < _FIRST_TURNS or reached > last + _RISE)
        information, projection = expected_information(seen, member)
        size = float(np.einsum("bk,bkl,bl", moved, information, moved))
        is_settled = before is not None and size < _SETTLED
        if is_settled or turn == _MAX_TURNS:
            break
        rise = reached - last
        if rival is not None and _leads_nowhere(otf, reached, rise, rival, edges.freq_cpp):
            break
        # Before the first turn the sensor has no form, and may be likelier than with one.
        before, last = otf, reached if turn > 0 else -np.inf
        combined = _combined(edges.freq_cpp, normal_deg, otf, information, projection, forms, near)
        near, sensor = combined.near, combined.unwidened
        # Forms without any weight have none in the next turn, either.
        forms = tuple({form.form.oblique_terms: None for form in sensor.forms})
        otf = stacked(_along(sensor, normal_deg, edges.freq_cpp).T).T
        along = along_bins(edges, normal_deg, sensor)
        if is_rising:
            ways = form_ways(combined.forms[0], normal_deg, edges.freq_cpp)
        else:
            ways = blur_ways(normal_deg, edges.freq_cpp)
    return SensorState(otf, share, forms, combined, along, reached, turns + turn, is_settled)


def _leads_nowhere(
    otf: Floats, reached: float, rise: float, rival: SensorState, freq_cpp: Floats
) -> bool:
    """Whether turns will not reach the log likelihood of a rival, or have come to where it is."""
    if rival.log_likelihood - reached > max(_PATIENCE * rise, AS_LIKELY):
        return True
    return apart(otf, rival.otf, freq_cpp) < SAME


def _calmed(move: Floats, last: Floats) -> Floats:
    """A turn's move; half of one that goes back: turns may go in circles."""
    return 0.5 * move if float(np.vdot(move, last)) < 0 else move


def _combined(
    freq_cpp: Floats,
    normal_deg: Floats,
    otf: Floats,
    information: Floats,
    projection: Floats,
    forms: Sequence[tuple[str, ...]],
    near: Sequence[WeightedForm],
) -> CombinedFit:
    """The sensor, if it is known what the edges are; near that of the turn before."""
    curves = [
        otf_samples(normal_deg[[b]], freq_cpp, otf[b], own, pull - own @ otf[b])
        for b, (own, pull) in enumerate(zip(information, projection, strict=True))
        if np.trace(own) > _LEAST
    ]
    return combine_curves(curves, forms=forms, near=near)


def along_bins(edges: EdgeLikelihoods, normal_deg: Floats, sensor: CombinedOtf) -> EdgeLikelihoods:
    """What the edges say of the sensor along their bins; along their own normals it differs."""
    # Of few edges the directions themselves are fewer.
    fine_deg = _FINE_DEG if edges.size > _FINE_DEG.size else np.sort(edges.normal_deg)
    fine, mean = (np.abs(_along(sensor, one, edges.freq_cpp)) for one in (fine_deg, normal_deg))
    own = [np.interp(edges.normal_deg, fine_deg, column) for column in fine.T]
    low, high = _GAINS
    gain = np.transpose(own) / np.maximum(mean[edges.bin], 1e-3)
    return edges.turned(np.clip(gain, low, high))


def _along(sensor: CombinedOtf, normal_deg: Floats, freq_cpp: Floats) -> NDArray[np.complex128]:
    """The OTF in every direction, (b, k)."""
    otf = sensor.otf(*places_along(normal_deg, freq_cpp))
    return np.asarray(otf.reshape(normal_deg.size, freq_cpp.size))


def otf_samples(
    normal_deg: Floats,
    freq_cpp: Floats,
    otf: Floats,
    information: Floats,
    pull: Floats | float = 0.0,
) -> OtfSamples:
    """A likelihood about an OTF: its information, and its gradient there.

    Parameters
    ----------
    normal_deg : (b,) array
    freq_cpp : (k,) array
    otf : (b * 2 k,) array
        Direction by direction, of each the real parts first.
    information : (b * 2 k, b * 2 k) array
    pull : (b * 2 k,) array, optional
        Gradient; none where the OTF is the likeliest.
    """
    pull = np.broadcast_to(pull, otf.shape)
    order = _real_first(normal_deg.size, freq_cpp.size)
    size, axes = np.linalg.eigh(information[np.ix_(order, order)])
    seen = size > _UNSEEN
    root = axes[:, seen] * np.sqrt(size[seen])
    values = root.T @ otf[order] + (root / size[seen]).T @ pull[order]
    likelihood = OtfLikelihood(unstacked(root), np.zeros(values.size), values)
    likelihood = likelihood.with_errors(common_errors(normal_deg.size, freq_cpp)).of_known_light()
    u, v = places_along(normal_deg, freq_cpp)
    about = unstacked(otf[order])
    return OtfSamples("edges", u, v, about, np.zeros((about.size, 1), complex), likelihood)


def _real_first(bins: int, frequencies: int) -> Floats:
    """Where all real parts stand, then all imaginary ones."""
    places = np.arange(bins * 2 * frequencies).reshape(bins, 2, frequencies)
    return np.asarray(places.transpose(1, 0, 2).ravel())
