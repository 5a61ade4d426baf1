"""The posterior of a trend: normal densities of its coefficients, weighed by evidence.

Whether there is a drift, a season, how many steps there are and where, how heavy the tails of the
scatter are and how large it is, how much targets differ: each combination (`combinations`) gives a
normal density of the coefficients, and a weight. Rate and level are read from the combinations with
a drift, because a drift may always be there: what is taken for none has made intervals of small
drifts too short (83 % instead of 95 % held 1 % a year). Steps are weighed against drifts with the
possibility that there is none.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from acutance.archive.trends.combinations import DriftFamily, drift_family
from acutance.archive.trends.design import Design
from acutance.archive.trends.images import ImageMeans
from acutance.archive.trends.normal_mixture import NormalMixture
from acutance.archive.trends.steps import MAX_STEPS
from acutance.archive.trends.target_effects import TargetEffects
from acutance.archive.trends.tuned import DRIFT_STDS_PER_YEAR, TARGET_STDS
from acutance.curves.grid import Floats
from acutance.curves.short_repr import ShortRepr

__all__ = ["TrendPosterior", "trend_posterior"]

_MAX_NODES: Final = 300
_KEPT: Final = 0.9995


@dataclass(frozen=True, eq=False)
class TrendPosterior(ShortRepr):
    """Normal densities of the coefficients, relative to a unit; p of the design, then 3 steps.

    Attributes
    ----------
    design : Design
    unit : float
        What the coefficients are multiples of.
    share : (q,) array
        Sums to 1.
    drifts : (q,) bool array
        Whether the density allows a drift.
    has_season : (q,) bool array
    step_low, step_high : (q, 3) array
        Years between which each step lies; ``nan`` where there is none.
    mode : (q, p + 3) array
    covariance : (q, p + 3, p + 3) array
    scatter : (q,) array
        Scale of the scatter between images.
    degrees : (q,) array
    hypothesis : (2, 4) array
        Probability of a drift with 0, 1, 2, 3 steps (first row), and of none with them.
    target_std : float
        Mean deviation between targets that come again; 0 where none do.
    targets : float
        As many equal ones have as much in common as those of the images.
    """

    design: Design
    unit: float
    share: Floats
    drifts: NDArray[np.bool_]
    has_season: NDArray[np.bool_]
    step_low: Floats
    step_high: Floats
    mode: Floats
    covariance: Floats
    scatter: Floats
    degrees: Floats
    hypothesis: Floats
    target_std: float = 0.0
    targets: float = 1.0

    @property
    def targets_std(self) -> float:
        """What targets add to the deviation of the level, which more images of them leave."""
        return self.target_std / float(np.sqrt(self.targets))

    @property
    def step_probability(self) -> Floats:
        """Probability of 0, 1, 2, 3 steps, (4,)."""
        return np.asarray(self.hypothesis.sum(axis=0))

    @property
    def steady_probability(self) -> float:
        """Probability of neither a drift nor a step."""
        return float(self.hypothesis[1, 0])

    @property
    def steps(self) -> NDArray[np.int64]:
        """Number of steps of every density, (q,)."""
        return np.asarray(np.isfinite(self.step_low).sum(axis=1))

    @property
    def typical_scatter(self) -> float:
        """Mean scale of the scatter between what it was fitted to: images, or joined ones."""
        return float(self.share @ self.scatter)

    def those(self, mask: NDArray[np.bool_]) -> TrendPosterior:
        """The densities of a mask, their shares made to sum to 1."""
        share = self.share[mask]
        return replace(
            self, share=share / share.sum(), drifts=self.drifts[mask],
            has_season=self.has_season[mask], step_low=self.step_low[mask],
            step_high=self.step_high[mask], mode=self.mode[mask],
            covariance=self.covariance[mask], scatter=self.scatter[mask],
            degrees=self.degrees[mask],
        )  # fmt: skip

    def drifting(self) -> TrendPosterior:
        """The densities that allow a drift, with the probabilities of steps that all have."""
        found = self.those(self.drifts)
        own = np.bincount(found.steps, found.share, minlength=MAX_STEPS + 1)
        share = found.share * (self.step_probability / np.maximum(own, 1e-12))[found.steps]
        return replace(found, share=share / share.sum())

    def rows(self, when: Floats, *, season: bool = True) -> Floats:
        """What the coefficients are multiplied by at some dates, (q, n, p + 3)."""
        fixed = self.design.columns(when, season=season)
        middle = 0.5 * (self.step_low + self.step_high)
        with np.errstate(invalid="ignore"):
            after = (when[None, :, None] >= middle[:, None, :]).astype(float)
        repeated = np.broadcast_to(fixed, (self.share.size, *fixed.shape))
        return np.concatenate([repeated, after], axis=2)

    def rows_each(self, when: Floats) -> Floats:
        """The same, without the season, at a date of its own for every density, (q, p + 3)."""
        fixed = self.design.columns(when, season=False)
        with np.errstate(invalid="ignore"):
            after = when[:, None] >= 0.5 * (self.step_low + self.step_high)
        return np.column_stack([fixed, after])

    def of(self, rows: Floats) -> tuple[Floats, Floats]:
        """Means and standard deviations of sums of coefficients, (q, n) each.

        Parameters
        ----------
        rows : (q, n, p + 3) array
        """
        mean = np.einsum("qni,qi->qn", rows, self.mode)
        variance = np.einsum("qni,qij,qnj->qn", rows, self.covariance, rows)
        return self.unit * mean, self.unit * np.sqrt(np.maximum(variance, 0.0))

    def rate(self, when: float) -> NormalMixture:
        """The density of the drift per year at a date."""
        row = np.zeros(self.mode.shape[1])
        slopes = self.design.slopes(when)
        row[: slopes.size] = slopes
        mean, std = self.of(np.broadcast_to(row, (self.share.size, 1, row.size)))
        return NormalMixture(self.share, mean[:, 0], std[:, 0])

    def coefficient(self, index: int) -> NormalMixture:
        """The density of one coefficient."""
        std = np.sqrt(self.covariance[:, index, index])
        return NormalMixture(self.share, self.unit * self.mode[:, index], self.unit * std)


def trend_posterior(
    images: ImageMeans, design: Design, effects: TargetEffects | None = None
) -> tuple[TrendPosterior, Floats]:
    """Weigh all combinations and keep those that matter.

    Parameters
    ----------
    images : ImageMeans
    design : Design
    effects : TargetEffects, optional
        Of targets that come again.

    Returns
    -------
    TrendPosterior
    (j,) array
        What the targets of each image add to its mean.
    """
    unit = _unit(images.value)
    shared = effects or TargetEffects.none(images.size)
    targets = {std: (shared.given(std * unit), chance) for std, chance in TARGET_STDS.items()}
    if not shared.are_known:
        targets = {0.0: (shared.given(unit), 1.0)}
    prior = {**DRIFT_STDS_PER_YEAR, 0.0: 1 - sum(DRIFT_STDS_PER_YEAR.values())}
    families = [drift_family(images, design, unit, drift_std, targets) for drift_std in prior]
    log_total = np.array([family.log_evidence for family in families]) + np.log([*prior.values()])
    weight = np.exp(log_total - log_total.max())
    weight /= weight.sum()
    each = weight[:, None] * np.array([family.step_probability for family in families])
    hypothesis = np.array([each[:-1].sum(axis=0), each[-1]])
    found, effect = _joined(families, weight, design, unit, hypothesis)
    return replace(found, targets=shared.equal_targets), effect


def _unit(value: Floats) -> float:
    """The level; of numbers about 0 what they differ by, ten times."""
    median = float(np.median(value))
    scatter = 1.4826 * float(np.median(np.abs(value - median)))
    return max(abs(median), 10 * scatter) or 1.0


def _joined(
    families: list[DriftFamily], weight: Floats, design: Design, unit: float, hypothesis: Floats
) -> tuple[TrendPosterior, Floats]:
    """All densities of both families, without those of no weight; the effects in the images."""
    size = design.size + MAX_STEPS
    parts = [(family.drifts, part, node) for family, part in zip(families, weight, strict=True)
             for node in family.nodes]  # fmt: skip
    share = np.concatenate([part * node.share * node.nodes.share for _, part, node in parts])
    order = np.argsort(-share, kind="stable")
    enough = int(np.searchsorted(np.cumsum(share[order]) / share.sum(), _KEPT)) + 1
    best = order[: min(enough, _MAX_NODES)]
    # Densities with a drift answer for rate and level, however probable they are.
    own = np.concatenate([np.full(node.nodes.share.size, drifts) for drifts, _, node in parts])
    drifting = order[own[order]]
    enough = int(np.searchsorted(np.cumsum(share[drifting]) / share[drifting].sum(), _KEPT)) + 1
    best = np.unique(np.concatenate([best, drifting[: min(enough, _MAX_NODES)]]))
    mode, covariance = np.zeros((share.size, size)), np.zeros((share.size, size, size))
    at = 0
    for _, _, node in parts:
        count, own_size = node.nodes.mode.shape
        mode[at : at + count, :own_size] = node.nodes.mode
        # The inverse of a factor is symmetric but for rounding.
        symmetric = 0.5 * (node.nodes.covariance + node.nodes.covariance.transpose(0, 2, 1))
        covariance[at : at + count, :own_size, :own_size] = symmetric
        at += count

    def column(values: list[float | Floats | bool]) -> Floats:
        sizes = [node.nodes.share.size for _, _, node in parts]
        return np.asarray(np.repeat(np.array(values), sizes, axis=0)[best])

    of_nodes = np.array([part * node.share for _, part, node in parts])
    of_nodes /= of_nodes.sum()
    effect = of_nodes @ np.array([node.effect for _, _, node in parts])
    target_std = unit * float(of_nodes @ [node.state.target_std for _, _, node in parts])
    found = TrendPosterior(
        design, unit, share[best] / share[best].sum(), own[best],
        column([node.state.season for _, _, node in parts]).astype(bool),
        column([node.low for _, _, node in parts]), column([node.high for _, _, node in parts]),
        mode[best], covariance[best],
        unit * np.concatenate([node.nodes.scatter for _, _, node in parts])[best],
        column([node.state.degrees for _, _, node in parts]), hypothesis, target_std,
    )  # fmt: skip
    return found, effect
