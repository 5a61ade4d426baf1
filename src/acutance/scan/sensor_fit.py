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

from acutance.curves import Estimate
from acutance.curves.grid import Floats
from acutance.numerics.one_thread import one_thread
from acutance.scan.blur_modes import COMMON_MODES, changed, edge_modes
from acutance.scan.edge_likelihoods import EdgeLikelihoods
from acutance.scan.field_fit import FieldFit, fit_field
from acutance.scan.first_sensor import Rival, first_sensor
from acutance.scan.form_agreement import agreement_of_form
from acutance.scan.information import observed_information
from acutance.scan.other_tops import blur_of_tops, log_evidence
from acutance.scan.parts import PartsFit, compare_parts
from acutance.scan.population import Membership, fit_shares
from acutance.scan.sensor_turns import SensorState, otf_samples, settled
from acutance.scan.shared_blur import SharedBlur, integrate_shared_blur
from acutance.scan.shares import SECTOR_DEG, share_covariances
from acutance.scan.softness import KINDS
from acutance.targets.combine.curves import ChiSquare
from acutance.targets.combine.fit import CombinedFit, combine_curves
from acutance.targets.combine.sensor_forms import SCENE_FORMS, SensorForm
from acutance.targets.combine.weighted_forms import CombinedOtf

__all__ = ["EdgesSeen", "IdealShare", "SensorFit", "fit_sensor"]

_SETTLED_GAIN: Final = 1e-3
_MAX_FIELD_TURNS: Final = 4
_CONSTANT: Final = 0.99
"""Chance of a field without change above which none is followed."""
_MOST_SHARE_STD: Final = 0.5
"""Nothing between 0 and 1 scatters more."""


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
        (`acutance.scan.shared_blur`, `acutance.scan.other_tops`), beside those of `combined`.
    parts : PartsFit or None
        Whether the parts of the scene agree; None of too few edges.
    agreement : ChiSquare
        Whether the edges agree with the form of the sensor.
    rivals : tuple of Rival
        The sensors to which other starts led.
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
    rivals: tuple[Rival, ...]
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
            share = Estimate(value, std, 0.0, 1.0)
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
    def forms(self) -> dict[str, float]:
        """Weights of the forms of the sensor by their names, however oblique, largest first."""
        weight: dict[str, float] = {}
        for one in self.otf.forms:
            name = SensorForm(one.form.oblique_terms).name
            weight[name] = weight.get(name, 0.0) + one.weight
        return dict(sorted(weight.items(), key=lambda item: -item[1]))

    @property
    def common_errors_px2(self) -> dict[str, Floats]:
        """Independent errors of the blurs beside those of `combined`, (r, 3), by their cause."""
        scatter = np.zeros(COMMON_MODES) if self.parts is None else self.parts.errors_px2
        return {"shared_softness": self.shared_px2, "parts_scatter": np.diag(scatter)}

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


class EdgesSeen(NamedTuple):
    """What the edges of a scene say of its sensor.

    Attributes
    ----------
    likelihoods : EdgeLikelihoods
    normal_deg : (b,) array
        Mean direction of every bin.
    guesses : sequence of (b, 2 k) arrays
        First guesses of the OTF in every direction, real parts first: the likeliest counts.
    x, y : (n,) arrays
        Places of the edges, -1 to 1 over the field.
    """

    likelihoods: EdgeLikelihoods
    normal_deg: Floats
    guesses: Sequence[Floats]
    x: Floats
    y: Floats


@one_thread
def fit_sensor(seen: EdgesSeen, workers: int = 1) -> SensorFit:
    """Fit the sensor of a scene.

    Parameters
    ----------
    seen : EdgesSeen
    workers : int, optional
        Processes that may be used; the fit is the same.
    """
    edges, normal_deg, guesses, x, y = seen
    modes = edge_modes(normal_deg, edges.freq_cpp)[:, :, :COMMON_MODES]
    state, others, rivals = first_sensor(edges, normal_deg, guesses, workers)
    field = fit_field(state.along, state.otf, state.share, x, y)
    for _ in range(_MAX_FIELD_TURNS):
        if field.chance_constant > _CONSTANT or not field.amount.any():
            break
        # Others were sought under none: their evidence is no more to be compared.
        others = ()
        moved = changed(state.otf, modes @ field.common)
        state = settled(edges, normal_deg, state._replace(otf=moved), field.log_gain)
        before, field = field, fit_field(state.along, state.otf, state.share, x, y, field)
        if np.abs(field.log_gain - before.log_gain).max() < _SETTLED_GAIN:
            break
    along = state.along.turned(np.exp(field.log_gain))
    member = fit_shares(along, state.otf, state.share)
    left = observed_information(along, state.otf, member)
    shared = integrate_shared_blur(along, state.otf, member, modes, left)
    tops = _other_tops(state, others, normal_deg, modes)
    otf = changed(state.otf, modes @ (shared.mean_px2 + tops.mean_px2))
    member = fit_shares(along, otf, member.share)
    # It is the mean already: a further step would follow what little is left of information.
    # And forms with a kernel have several optima: they begin where the turns ended.
    samples = otf_samples(normal_deg, edges.freq_cpp, otf.ravel(), left)
    return SensorFit(
        combine_curves([samples], forms=SCENE_FORMS, near=state.near),
        field, normal_deg, member, np.concatenate([shared.errors_px2, tops.errors_px2]),
        compare_parts(along, otf, member.share, x, y),
        agreement_of_form(along, otf, member),
        rivals, state.turns, state.settled,
    )  # fmt: skip


def _other_tops(
    best: SensorState, others: Sequence[SensorState], normal_deg: Floats, modes: Floats
) -> SharedBlur:
    """What sensors that are nearly as likely change of the blurs, and the errors they make."""
    found = [log_evidence(one, normal_deg) for one in (best, *others)] if others else [0.0]
    otfs = [one.otf for one in others]
    return blur_of_tops(best.otf, otfs, np.array(found), modes, best.along.freq_cpp)
