"""One pass of the reference estimator: the linear model of a target, solved at given weights."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.compiled import compiled
from acutance.numerics.marginal_likelihood import Posterior, regress
from acutance.numerics.normal_equations import Normal
from acutance.targets.straight.coloured_noise import ColouredNoise
from acutance.targets.straight.linear_model import Linear, NoiseModel
from acutance.targets.straight.lsf import LsfModel
from acutance.targets.straight.random_profile import RandomProfile, random_profile
from acutance.targets.straight.spline_equations import accumulate, renewed

__all__ = ["OUTLYING", "Solution", "solved_pass"]

_STEEP: Final = 0.25
_MIN_STEEP: Final = 20
_SIGNIFICANT: Final = 4.0
OUTLYING: Final = 4.0
"""Standard deviations from which on a residual may be an outlier's."""


@dataclass(frozen=True, eq=False)
class Solution:
    """One pass: the linear model solved at given weights.

    Attributes
    ----------
    linear : Linear
    weight : (n,) array
        Weights of the pixels.
    columns : list of (q, n) arrays
        Regressors other than the spline.
    normal : Normal
        The equations of the pixels, of spline and regressors.
    random_profile : RandomProfile or None
        What correlated noise adds to the profile across an edge; none of noise that is white.
    left : Normal
        The equations without what the random profile explains.
    equations : Normal
        The same in the unknowns.
    inflation : float
        Variance of the noise that counts in these equations, over that of the pixels' residuals.
    posterior : Posterior
        Of the unknowns.
    residual : (n,) array
        Of every pixel, in image units.
    standard : (n,) array
        The same in standard deviations of the pixel's noise.
    side_noise : (float, float)
        Standard deviation of the noise on the dark and on the bright plateau.
    noise_log_ratio : float
        Logarithm of the ratio of their variances that the weights assume.
    roughness : float
        Noise variance that the edge roughness adds where the image is steepest, relative to the
        rest.
    """

    linear: Linear
    weight: Floats
    columns: list[Floats]
    normal: Normal
    random_profile: RandomProfile | None
    left: Normal
    equations: Normal
    inflation: float
    posterior: Posterior
    residual: Floats
    standard: Floats
    side_noise: tuple[float, float]
    noise_log_ratio: float
    roughness: float

    @property
    def model(self) -> LsfModel:
        """The LSF of this pass."""
        return self.linear.model(self.posterior)

    @property
    def mean_model(self) -> LsfModel:
        """The same without its covariance: the next pass takes no more of it."""
        return self.linear.mean_model(self.posterior)

    @property
    def likeliest_noise(self) -> Floats:
        """What the random profile adds to every pixel, in image units, (n,)."""
        if self.random_profile is None:
            return np.zeros(self.linear.s.size)
        return self.random_profile.likeliest(self.linear.coefficients(self.posterior.beta))

    @property
    def rotation_rad(self) -> float:
        """Rotation of the line in this pass."""
        return float(self.posterior.beta[-self.linear.derivatives])

    @property
    def rotation_std_rad(self) -> float:
        """Standard deviation of the rotation."""
        return _norm(self.posterior.factor[-self.linear.derivatives])

    @property
    def curvature_per_px(self) -> float:
        """What the line bends in this pass."""
        return float(self.posterior.beta[1 - self.linear.derivatives])

    @property
    def curvature_std_per_px(self) -> float:
        """Standard deviation of the curvature."""
        return _norm(self.posterior.factor[1 - self.linear.derivatives])

    @property
    def updates(self) -> Floats:
        """Changes of a pulse's width (if free) and of its height ratio in this pass, (k,)."""
        return self.posterior.beta[self._first_update :]

    @property
    def updates_std(self) -> Floats:
        """Standard deviations of the updates, (k,)."""
        return np.array([_norm(row) for row in self.posterior.factor[self._first_update :]])

    @property
    def _first_update(self) -> int:
        return self.posterior.beta.size - self.linear.derivatives + 2


def solved_pass(
    linear: Linear,
    outlier: Floats,
    inflation: float,
    coloured: ColouredNoise | None,
    roughness: float,
    earlier: Solution | None,
) -> Solution:
    """Solve for the correction of the LSF, the levels, the line and the profile.

    Parameters
    ----------
    linear : Linear
    outlier : (n,) array
        Weight of every pixel, 1 where it is no outlier.
    inflation : float
        Factor on the noise variance for noise that correlates, where no colour of it is known.
    coloured : ColouredNoise or None
        What is known of it.
    roughness : float
        As of a solution.
    earlier : Solution or None
        The pass before.
    """
    # What the first fit leaves beside an edge is structure of the ground: weights have to know it.
    before = linear.first_residual
    if earlier is not None and not linear.first_fit.profile.is_edge:
        before = earlier.residual
    noise = linear.noise(before, outlier, roughness)
    relative, per_fitted = noise.relative, 1.0
    if coloured is not None:
        # What is there beside the white part is smooth, but for the roughness of the edge.
        relative = noise.relative - linear.over_pixels(noise.sides * (1 - coloured.white))
        # Residuals are as large as all of the noise, at weights for its white part.
        per_fitted = inflation = 1 / float(np.mean(noise.relative / relative))
    weight = outlier / relative
    columns = linear.columns(None if earlier is None else earlier.mean_model)
    normal = left = _equations(linear, weight, columns, float(np.add.reduce(outlier)), earlier)
    equations = pixels = normal.combined(linear.design)
    profile = None
    if coloured is not None:
        profile = random_profile(linear, noise, coloured, weight, columns)
        left = profile.integrated_out(
            normal, _disturbing(columns, relative, noise, coloured, profile)
        )
        equations = left.combined(linear.design)
    posterior = regress(
        equations, linear.prior, noise.scale / per_fitted, inflation,
        None if earlier is None else earlier.posterior, pixels,
    )  # fmt: skip
    residual = linear.first_residual - linear.image(columns, linear.coefficients(posterior.beta))
    variance = posterior.variance * per_fitted
    standard = residual / np.sqrt(variance * noise.relative)
    dark, bright = np.sqrt(variance * noise.sides).tolist()
    return Solution(
        linear, weight, columns, normal, profile, left, equations, inflation, posterior, residual,
        standard, (dark, bright), noise.log_ratio,
        _edge_roughness(standard, linear.steepness, roughness),
    )  # fmt: skip


def _disturbing(
    columns: list[Floats],
    relative: Floats,
    noise: NoiseModel,
    coloured: ColouredNoise,
    profile: RandomProfile,
) -> Floats:
    """Variance of the noise that disturbs every regressor, over that of its white part.

    Beside what the random profile follows of a regressor.
    """
    weighted = np.concatenate(columns) / np.sqrt(relative)
    varying = weighted - profile.followed(weighted)
    share = np.sum(varying**2, axis=1) / np.maximum(np.sum(weighted**2, axis=1), 1e-300)
    white = float(np.mean(noise.sides * coloured.white))
    return np.asarray(1 + share * (coloured.disturbing(varying, noise.sides) / white - 1))


def _equations(
    linear: Linear, weight: Floats, columns: list[Floats], count: float, earlier: Solution | None
) -> Normal:
    """The pixels' equations; those that do not depend on the LSF are kept from an earlier pass."""
    stencils, residual = linear.stencils, linear.first_residual
    if (
        earlier is None
        or earlier.linear is not linear
        or not np.array_equal(earlier.weight, weight)
    ):
        return accumulate(stencils, residual, weight, columns, count)
    return renewed(earlier.normal, stencils, residual, weight, columns)


@compiled
def _edge_roughness(standard: Floats, steep: Floats, assumed: float) -> float:
    """Excess noise variance of the steep pixels, beyond chance, relative to the rest.

    Of those that are no outliers.
    """
    count, square, steepness = 0, 0.0, 0.0
    for k in range(standard.size):
        if steep[k] > _STEEP and abs(standard[k]) < OUTLYING:
            count += 1
            # In units of the noise without edge roughness.
            square += standard[k] ** 2 * (1 + assumed * steep[k])
            steepness += steep[k]
    if count < _MIN_STEEP:
        return assumed
    power = square / count
    if assumed == 0 and power < 1 + _SIGNIFICANT * math.sqrt(2 / count):
        return 0.0
    return max((power - 1) * count / steepness, 0.0)


def _norm(row: Floats) -> float:
    """Standard deviation that a row of a factor stands for."""
    return math.sqrt(float(row @ row))
