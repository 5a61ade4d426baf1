"""The mean of a series over its images, whatever their dates.

Images are random effects, and so are targets and sites where several come again: a mean over forty
images of four targets is one of four targets. How much targets differ is told by their differences
within images, and by what images of one target have in common; a prior has the rest to say, since
two or three targets hardly show it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from scipy.special import logsumexp

from acutance.archive.trends.images import ImageMeans, image_means
from acutance.archive.trends.normal_mixture import NormalMixture
from acutance.archive.trends.series import Series
from acutance.archive.trends.target_effects import (
    EffectsGiven,
    TargetEffects,
    effects_and_images,
)
from acutance.archive.trends.tuned import SCATTER, TARGET_STDS
from acutance.archive.weighted_means import WeightedMean, weighted_mean
from acutance.curves.metric_bounds import lowest_of
from acutance.errors import OptionError

__all__ = ["mean_of_images"]

_SCATTERS: Final = np.geomspace(1e-3, 0.5, 16)
"""Relative scatters between images over which their density is summed."""


def mean_of_images(series: Series) -> WeightedMean:
    """The mean over images with random effects, of targets and sites too where they come again.

    Parameters
    ----------
    series : Series

    Raises
    ------
    OptionError
        If no measurement has a value.
    """
    known = series.known()
    if known.size == 0:
        raise OptionError(f"no measurement has a value of {series.metric}: choose another number")
    lowest = lowest_of(series.metric)
    if np.unique(known.image).size == 1:
        # No other image shows how much they scatter: the targets of this one stand in.
        systematic = 0.0
        if known.systematic_std is not None:
            systematic = float(np.nan_to_num(known.systematic_std).mean())
        found = weighted_mean(known.value, known.std, systematic_std=systematic, lowest=lowest)
        return replace(found, count=1)
    undated = replace(known, when=np.zeros(known.size))
    effects, cleared = effects_and_images(undated)
    images = image_means(undated) if effects.are_known else cleared
    found = weighted_mean(
        images.value, np.sqrt(images.variance), systematic_std=images.systematic_std, lowest=lowest
    )
    return _with_targets(found, effects, cleared) if effects.are_known else found


def _with_targets(found: WeightedMean, effects: TargetEffects, images: ImageMeans) -> WeightedMean:
    """The same mean, with what is peculiar to targets in its deviation."""
    level = abs(found.mean.value) or 1.0
    stds = np.array([*TARGET_STDS]) * level
    log_weight = np.log([*TARGET_STDS.values()])
    log_weight += [_log_density(effects.given(std), images, level) for std in stds.tolist()]
    share = np.exp(log_weight - log_weight.max())
    share /= share.sum()
    variance = found.mean.std**2 + stds**2 / effects.equal_targets
    density = NormalMixture(share, np.full(stds.size, found.mean.value), np.sqrt(variance))
    return replace(found, mean=density.estimate(found.mean.lowest))


def _log_density(effects: EffectsGiven, images: ImageMeans, level: float) -> float:
    """Of the images, and of what targets differ by within them, if the effects are these.

    The mean is flat, the scatter between images has the prior of trends (half-Cauchy).
    """
    value, columns = images.value - effects.shift, effects.columns
    found = []
    for scatter in (_SCATTERS * level).tolist():
        weight = 1 / (images.variance + scatter**2)
        # V^-1 of V = diag + columns columns^T (Woodbury).
        inner = np.eye(columns.shape[1]) + (columns * weight[:, None]).T @ columns
        ones, seen = (
            weight * one - weight * (columns @ np.linalg.solve(inner, columns.T @ (weight * one)))
            for one in (np.ones_like(value), value)
        )
        total = float(ones.sum())
        square = float(value @ seen) - float(ones @ value) ** 2 / total
        volume = float(np.linalg.slogdet(inner)[1]) - float(np.log(weight).sum()) + np.log(total)
        prior = np.log(scatter / (1 + (scatter / (SCATTER * level)) ** 2))
        found.append(prior - 0.5 * (volume + square))
    return effects.log_evidence + float(logsumexp(found))
