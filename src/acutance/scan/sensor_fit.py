"""The sensor of a scene: one optical transfer function (OTF) over the plane, under all edges.

By turns: how much of the blur is the sensor's (`acutance.scan.blur_modes`); how it changes over
the field (`acutance.scan.field_fit`); what every edge is, given both (`acutance.scan.population`);
the sensor, given that, as the combination of all directions (`acutance.targets.combine`). The last
turn takes the information that is left when what the edges are is integrated out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.curves.metrics import NYQUIST_CPP
from acutance.numerics.stacked import stacked, unstacked
from acutance.scan.blur_modes import ALL_AROUND, COMMON_MODES, changed, edge_modes, fit_modes
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.field_fit import FieldFit, fit_field
from acutance.scan.form_agreement import agreement_of_form, common_errors
from acutance.scan.information import expected_information, observed_information
from acutance.scan.parts import PartsFit, compare_parts
from acutance.scan.population import Membership, fit_shares
from acutance.scan.shared_blur import integrate_shared_blur
from acutance.scan.shares import SECTOR_DEG, START, share_covariances
from acutance.scan.softness import KINDS
from acutance.targets.combine.curves import ChiSquare, OtfSamples
from acutance.targets.combine.fit import CombinedFit, combine_curves
from acutance.targets.combine.sensor_forms import FORMS
from acutance.targets.combine.weighted_forms import CombinedOtf, WeightedForm
from acutance.targets.otf_likelihood import OtfLikelihood
from acutance.targets.slices import places_along

__all__ = ["IdealShare", "SensorFit", "fit_sensor"]

_SETTLED: Final = 0.1
"""Square of a turn's change, in standard deviations of what the edges say."""
_SETTLED_GAIN: Final = 1e-3
_MAX_TURNS: Final = 12
_MAX_FIELD_TURNS: Final = 4
_CONSTANT: Final = 0.99
"""Chance of a field without change above which none is followed."""
_GAINS: Final = (0.7, 1.4)
"""Between these the sensor along an edge's normal is of that along its bin."""
_LEAST: Final = 1e3
"""Information of a direction whose edges are all strange: it has no part in a turn."""
_EXACT: Final = 1e7
"""One over the error of what is exact."""
_MOST_SHARE_STD: Final = 0.5
"""Nothing between 0 and 1 scatters more."""
_UNSEEN: Final = 1.0
"""Information of combinations that edges do not show: the OTF is between 0 and 1."""
_BLUR_STARTS_PX2: Final = (-0.03, -0.015, 0.0, 0.015, 0.03, 0.05)
"""Blur that is added to first guesses: the sharpest edges are so by their noise, too."""
_ALIKE: Final = 0.005
"""Mean difference of transfer functions within the band that is none."""
_FREE_PX2: Final = 0.1
"""Prior standard deviation of the modes by which first guesses may change."""


class IdealShare(NamedTuple):
    """How many objects are ideal among those that edges of about one direction show.

    Attributes
    ----------
    normal_deg : float
        Middle of the directions of their normals, 0 to 180.
    edges : int
    share : Estimate
    """

    normal_deg: float
    edges: int
    share: Estimate


@dataclass(frozen=True, eq=False)
class SensorFit:
    """The sensor and the objects of a scene.

    Attributes
    ----------
    combined : CombinedFit
        The sensor in the middle of the edges, all directions together.
    field : FieldFit
        Its change over the field.
    normal_deg : (b,) array
        Mean direction of every bin.
    member : Membership
        What every edge is.
    shared_px2 : (r, 3) array
        Independent errors of the blurs that may be the sensor's or the objects'
        (`acutance.scan.shared_blur`), beside those of `combined`.
    parts : PartsFit or None
        Whether the parts of the scene agree; None of too few edges.
    agreement : ChiSquare
        Whether the edges agree with the form of the sensor.
    turns : int
    settled : bool
    """

    combined: CombinedFit
    field: FieldFit
    normal_deg: Floats
    member: Membership
    shared_px2: Floats
    parts: PartsFit | None
    agreement: ChiSquare
    turns: int
    settled: bool

    @property
    def share(self) -> Floats:
        """Shares of `softness.PARTS` among all edges, (p,)."""
        return np.asarray(self.member.share[self.member.sector].mean(axis=0))

    @property
    def kinds(self) -> dict[str, tuple[float, float]]:
        """Shares of ideal, soft and strange edges, and their standard deviations."""
        covariance = np.tensordot((self._counts / self._counts.sum()) ** 2, self._covariances, 1)
        return {name: _share_of(one, self.share, covariance) for name, one in KINDS.items()}

    @property
    def ideal_by_direction(self) -> tuple[IdealShare, ...]:
        """Shares of ideal objects by the direction of the edges, where there are any."""
        found = []
        for g in np.flatnonzero(self._counts).tolist():
            value, std = _share_of(KINDS["ideal"], self.member.share[g], self._covariances[g])
            share = Estimate(value, std, 0.0)
            found.append(IdealShare(float(SECTOR_DEG[g]), int(self._counts[g]), share))
        return tuple(found)

    @cached_property
    def _counts(self) -> Floats:
        return np.bincount(self.member.sector, minlength=SECTOR_DEG.size).astype(float)

    @cached_property
    def _covariances(self) -> Floats:
        member = self.member
        return share_covariances(member.part, member.sector, member.share)

    @property
    def common_errors_px2(self) -> dict[str, Floats]:
        """Independent errors of the blurs beside those of `combined`, (r, 3), by their cause."""
        scatter = np.zeros((1, COMMON_MODES))
        scatter[0, ALL_AROUND] = 0.0 if self.parts is None else self.parts.scatter_px2
        return {"shared_softness": self.shared_px2, "parts_scatter": scatter}

    @property
    def otf(self) -> CombinedOtf:
        """The sensor in the middle of the edges, under the sharpest objects.

        They are one measurement: there is nothing it could disagree with.
        """
        return self.combined.unwidened


def _share_of(weight: Floats, share: Floats, covariance: Floats) -> tuple[float, float]:
    """Sum of shares of parts by their weights, and its standard deviation."""
    std = math.sqrt(max(float(weight @ covariance @ weight), 0.0))
    return float(weight @ share), min(std, _MOST_SHARE_STD)


def fit_sensor(
    edges: EdgeLikelihoods, normal_deg: Floats, guesses: Sequence[Floats], x: Floats, y: Floats
) -> SensorFit:
    """Fit the sensor of a scene.

    Parameters
    ----------
    edges : EdgeLikelihoods
    normal_deg : (b,) array
        Mean direction of every bin.
    guesses : sequence of (b, 2 k) arrays
        First guesses of the OTF in every direction, real parts first: the likeliest counts.
    x, y : (n,) arrays
        Places of the edges, -1 to 1 over the field.
    """
    modes = edge_modes(normal_deg, edges.freq_cpp)[:, :, :COMMON_MODES]
    nothing = np.zeros((edges.size, edges.freq_cpp.size))
    ends: list[_State] = []
    for start in _starts(edges, normal_deg, guesses):
        near = ends[-1].near if ends else ()
        ends.append(_settled(edges, normal_deg, start._replace(near=near), nothing))
    state = max(ends, key=lambda one: fit_shares(one.along, one.otf, one.share).log_likelihood)
    field = fit_field(state.along, state.otf, state.share, x, y)
    for _ in range(_MAX_FIELD_TURNS):
        if field.chance_constant > _CONSTANT or not field.amount.any():
            break
        moved = changed(state.otf, modes @ field.common)
        state = _settled(edges, normal_deg, state._replace(otf=moved), field.log_gain)
        before, field = field, fit_field(state.along, state.otf, state.share, x, y, field)
        if np.abs(field.log_gain - before.log_gain).max() < _SETTLED_GAIN:
            break
    seen = state.along.turned(np.exp(field.log_gain))
    member = fit_shares(seen, state.otf, state.share)
    left = observed_information(seen, state.otf, member)
    shared = integrate_shared_blur(seen, state.otf, member, modes, left)
    otf = changed(state.otf, modes @ shared.mean_px2)
    member = fit_shares(seen, otf, member.share)
    # It is the mean already: a further step would follow what little is left of information.
    # And forms with a kernel have several optima: they begin where the turns ended.
    samples = _samples(normal_deg, edges.freq_cpp, otf.ravel(), left)
    return SensorFit(
        combine_curves([samples], near=state.near),
        field, normal_deg, member, shared.errors_px2,
        compare_parts(seen, otf, member.share, x, y),
        agreement_of_form(seen, otf, member),
        state.turns, state.settled,
    )  # fmt: skip


class _State(NamedTuple):
    """A sensor between two turns.

    Attributes
    ----------
    otf : (b, 2 k) array
        Along the bins, in the middle of the edges.
    share : (g, p) array
    forms : sequence of tuples of str
        Forms of sensors that have some weight.
    near : sequence of WeightedForm
        Such forms where they were fitted last.
    along : EdgeLikelihoods
        What the edges say of the sensor along their bins.
    turns : int
    settled : bool
    """

    otf: Floats
    share: Floats
    forms: Sequence[tuple[str, ...]]
    near: Sequence[WeightedForm]
    along: EdgeLikelihoods
    turns: int
    settled: bool


def _starts(edges: EdgeLikelihoods, normal_deg: Floats, guesses: Sequence[Floats]) -> list[_State]:
    """The likeliest sensors near the guesses, of free shape, as far as they differ.

    The likelihood has several tops where few edges are sharp: a soft sensor whose sharpest edges
    are noise, and a sharp one under soft objects.
    """
    modes = edge_modes(normal_deg, edges.freq_cpp)
    steeper = (edges.freq_cpp[:, None] / NYQUIST_CPP) ** 2
    free = np.concatenate([modes, modes[:, :, :COMMON_MODES] * steeper], axis=2)
    in_band = np.tile(edges.freq_cpp <= NYQUIST_CPP, 2)
    found: list[_State] = []
    for guess in guesses:
        tried = [changed(guess, modes[:, :, 0] * blur) for blur in _BLUR_STARTS_PX2]
        start = max(tried, key=lambda one: fit_shares(edges, one, START).log_likelihood)
        fit = fit_modes(edges, start, START, free[edges.bin], std=_FREE_PX2)
        otf = changed(start, free @ fit.amount)
        apart = [float(np.abs(otf - one.otf)[:, in_band].mean()) for one in found]
        if min(apart, default=np.inf) > _ALIKE:
            found.append(_State(otf, fit.share, FORMS, (), edges, 0, settled=False))
    return found


def _settled(edges: EdgeLikelihoods, normal_deg: Floats, state: _State, log_gain: Floats) -> _State:
    """The sensor after as many turns as it needs, under a given change over the field (n, k)."""
    modes = edge_modes(normal_deg, edges.freq_cpp)[:, :, :COMMON_MODES]
    otf, share, forms, near, along, turns, _ = state
    before: Floats | None = None
    moved = np.zeros_like(otf)
    for turn in range(_MAX_TURNS + 1):
        seen = along.turned(np.exp(log_gain))
        found = fit_modes(seen, otf, share, modes[edges.bin])
        otf = changed(otf, modes @ found.amount)
        if before is not None:
            moved = _calmed(otf - before, moved)
            otf = before + moved
        member = fit_shares(seen, otf, found.share)
        share = member.share
        information, projection = expected_information(seen, member)
        size = float(np.einsum("bk,bkl,bl", moved, information, moved))
        if before is not None and size < _SETTLED:
            return _State(otf, share, forms, near, along, turns + turn, settled=True)
        before = otf
        combined = _combined(edges.freq_cpp, normal_deg, otf, information, projection, forms, near)
        near = combined.forms
        # Forms without any weight have none in the next turn, either.
        forms = tuple({form.form.oblique_terms: None for form in combined.forms})
        stepped = _along(combined, normal_deg, edges.freq_cpp)
        otf, along = stacked(stepped.T).T, _along_bins(edges, normal_deg, combined)
    return _State(otf, share, forms, near, along, turns + _MAX_TURNS, settled=False)


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
) -> CombinedOtf:
    """The sensor, if it is known what the edges are; near that of the turn before."""
    curves = [
        _samples(normal_deg[[b]], freq_cpp, otf[b], own, pull - own @ otf[b])
        for b, (own, pull) in enumerate(zip(information, projection, strict=True))
        if np.trace(own) > _LEAST
    ]
    return combine_curves(curves, forms=forms, near=near).unwidened


def _along_bins(edges: EdgeLikelihoods, normal_deg: Floats, sensor: CombinedOtf) -> EdgeLikelihoods:
    """What the edges say of the sensor along their bins; along their own normals it differs."""
    own, mean = (
        np.abs(_along(sensor, angle, edges.freq_cpp)) for angle in (edges.normal_deg, normal_deg)
    )
    low, high = _GAINS
    return edges.turned(np.clip(own / np.maximum(mean[edges.bin], 1e-3), low, high))


def _along(sensor: CombinedOtf, normal_deg: Floats, freq_cpp: Floats) -> NDArray[np.complex128]:
    """The OTF in every direction, (b, k)."""
    otf = sensor.otf(*places_along(normal_deg, freq_cpp))
    return np.asarray(otf.reshape(normal_deg.size, freq_cpp.size))


def _samples(
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
    # One more value: at zero frequency the OTF is 1, whatever light an image has.
    root = np.column_stack([root, np.zeros(len(root))])
    level = np.append(np.zeros(values.size), _EXACT)
    likelihood = OtfLikelihood(unstacked(root), level, np.append(values, _EXACT))
    likelihood = likelihood.with_errors(common_errors(normal_deg.size, freq_cpp))
    u, v = places_along(normal_deg, freq_cpp)
    about = unstacked(otf[order])
    return OtfSamples("edges", u, v, about, np.zeros((about.size, 1), complex), likelihood)


def _real_first(bins: int, frequencies: int) -> Floats:
    """Where all real parts stand, then all imaginary ones."""
    places = np.arange(bins * 2 * frequencies).reshape(bins, 2, frequencies)
    return np.asarray(places.transpose(1, 0, 2).ravel())
