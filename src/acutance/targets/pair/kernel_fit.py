"""The free fit of a pair: the kernel as the parametric one and Gaussian processes about it.

The low pixels are linear in the kernel, so all that they hold of it is in one small matrix; the
processes' amplitudes are those of the largest marginal likelihood, and the covariance is in closed
form (`acutance.numerics.marginal_likelihood`). Three things keep it true:

- the mean of every tile is left out, and residuals are whitened by an autoregression;
- the reference's noise makes the kernel too small (errors in the variables): its expected part of
  the normal equations is taken off, and what is uncertain of it goes into the covariance;
- the residuals of separate regions must scatter as the covariance states: where they scatter more,
  it is inflated (`kernel_otf`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.numerics.combined_prior import CombinedPrior
from acutance.numerics.marginal_likelihood import Posterior
from acutance.numerics.noise import outlier_weights, robust_scale
from acutance.numerics.normal_equations import Normal
from acutance.targets.pair import tuned
from acutance.targets.pair.gaussian_fit import GaussianFit
from acutance.targets.pair.kernel_basis import KernelBasis
from acutance.targets.pair.kernel_covariance import KernelCovariance
from acutance.targets.pair.kernel_prior import kernel_prior
from acutance.targets.pair.noise import (
    NO_NOISE,
    WHITE,
    HighNoise,
    Whitening,
    noise_gram,
    whitening_of,
)
from acutance.targets.pair.reference_otf import ReferenceOtf
from acutance.targets.pair.tile import (
    PairTile,
    TapGrid,
    Tiles,
    blurred,
    blurred_far,
    core,
    correlated,
)

__all__ = ["Kernel", "KernelFit", "fit_kernel", "square_root", "without_noise"]


_BANDS: Final = 4
_MIN_PIXELS: Final = 8


@dataclass(frozen=True, eq=False)
class Kernel:
    """A kernel as it acts on a tile.

    Parameters
    ----------
    taps : (taps down, taps across) array
        Weights of the reference's samples.
    far : (2 FAR_PX + 1, 2 FAR_PX + 1) array
        Weights of the low pixels around, beyond the taps.
    """

    taps: Floats
    far: Floats

    @classmethod
    def of(cls, basis: KernelBasis, beta: Floats) -> Kernel:
        """The kernel of coefficients (k,)."""
        return cls(np.tensordot(beta, basis.taps(), 1), beta[-1] * basis.far_tail)

    def low_pixels(self, tile: PairTile, grid: TapGrid) -> Floats:
        """The low pixels it makes of the reference, (h, w)."""
        near = blurred(tile, grid, self.taps)
        return near + blurred_far(tile, self.far) if self.far.any() else near

    def light_from_beyond(self, tile: PairTile) -> Floats:
        """What it makes of the ground beyond the image, which is guessed, (h, w)."""
        if tile.beyond is None:
            return np.zeros(tile.low.shape)
        return correlated(tile.beyond, self.far)


@dataclass(frozen=True, eq=False)
class KernelFit:
    """The kernel of a pair, with its covariance.

    Parameters
    ----------
    grid : TapGrid
    basis : KernelBasis
    posterior : Posterior
        Of the coefficients of the basis; the first is the gain.
    covariance : KernelCovariance
        The posterior's, and what the reference's noise and the scatter of regions add.
    prior : CombinedPrior
    whitening : Whitening
    noise : float
        Robust standard deviation of the residuals, before whitening.
    high_noise : HighNoise
        The reference's noise that was allowed for.
    used : int
        Low pixels with more than a twentieth of their weight.
    left_out : int
        Low pixels with less: clouds, changes, defects.
    robust : bool
        Whether such pixels are left out.
    """

    grid: TapGrid
    basis: KernelBasis
    posterior: Posterior
    covariance: KernelCovariance
    prior: CombinedPrior
    whitening: Whitening
    noise: float
    high_noise: HighNoise
    used: int
    left_out: int
    robust: bool

    @property
    def beta(self) -> Floats:
        """Coefficients of the basis, (k,)."""
        return self.posterior.beta

    @cached_property
    def kernel(self) -> Kernel:
        """The kernel, gain included."""
        return Kernel.of(self.basis, self.beta)

    def residuals(self, tiles: Tiles) -> Iterator[Floats]:
        """Residuals of every tile about its own mean, pads included; NaN where left out."""
        return _Residuals(tiles, self.grid, self.kernel, WHITE, self.noise, self.robust).fields()


def fit_kernel(
    tiles: Tiles,
    grid: TapGrid,
    gaussian: GaussianFit,
    *,
    reference: ReferenceOtf | None = None,
    processes: int = 3,
    high_noise: HighNoise = NO_NOISE,
    robust: bool = True,
) -> KernelFit:
    """Fit the kernel freely about its parametric form.

    Parameters
    ----------
    tiles : Tiles
    grid : TapGrid
    gaussian : GaussianFit
        The parametric fit.
    reference : ReferenceOtf, optional
        The high image's own transfer, where it is known.
    processes : int, optional
        How many of the basis' processes.
    high_noise : HighNoise, optional
        The reference's noise in a sample.
    robust : bool, optional
        Leave out what fits badly.

    Raises
    ------
    TargetError
        If the noise of the high image cannot be taken off.
    """
    basis = KernelBasis(grid, gaussian.down, gaussian.across, processes)
    prior = kernel_prior(basis, gaussian.gain, reference)
    first = _Residuals(tiles, grid, Kernel.of(basis, prior.mean), WHITE, gaussian.noise, robust)
    normals, _ = first.normals(basis)
    rough = _regressed(basis, prior, normals, gaussian.noise, high_noise, WHITE, None)
    kernel = Kernel.of(basis, rough.beta)
    noise = _Residuals(tiles, grid, kernel, WHITE, 0.0, robust).scale()
    coloured = _Residuals(tiles, grid, kernel, WHITE, noise, robust)
    whitening = whitening_of(coloured.fields())
    white_noise = replace(coloured, whitening=whitening).scale()
    white = replace(coloured, whitening=whitening, white_noise=white_noise)
    regions, beyond = white.normals(basis)
    posterior = _regressed(basis, prior, regions, gaussian.noise, high_noise, whitening, rough)
    used, left_out = white.counts()
    return KernelFit(
        grid=grid, basis=basis, posterior=posterior,
        covariance=_covariance(
            basis, prior, posterior, regions, beyond, high_noise, whitening
        ),
        prior=prior, whitening=whitening, noise=noise, high_noise=high_noise, used=used,
        left_out=left_out, robust=robust,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Residuals:
    """Residuals of a kernel, tile by tile, and the normal equations about it."""

    tiles: Tiles
    grid: TapGrid
    kernel: Kernel
    whitening: Whitening
    noise: float
    robust: bool
    white_noise: float = 0.0

    def fields(self) -> Iterator[Floats]:
        """Residuals of every tile about its own mean, pads included; NaN where left out."""
        for tile in self.tiles():
            yield self._residual(tile.low - self.kernel.low_pixels(tile, self.grid))

    def _residual(self, rest: Floats) -> Floats:
        usable = np.isfinite(rest)
        if not usable.any():
            return rest
        rest = rest - np.median(rest[usable])
        if self.robust and self.noise > 0:
            weight = outlier_weights(np.where(usable, rest, 0.0) / self.noise)
            rest = np.where(weight >= tuned.LOST_WEIGHT, rest, np.nan)
            if np.isfinite(rest).any():
                rest = rest - np.nanmean(rest)
        return rest

    def scale(self) -> float:
        """Robust standard deviation of the whitened residuals."""
        whitened = [_finite(self.whitening(rest)) for rest in self.fields()]
        every = np.concatenate(whitened) if whitened else np.zeros(0)
        return robust_scale(every) if every.size else 0.0

    def normals(self, basis: KernelBasis) -> tuple[list[Normal], Floats]:
        """Normal equations of every region, tile means left out.

        Also, (k, regions), what their right sides change by if the ground beyond the image is
        another. A TargetError, if no tile keeps enough low pixels.
        """
        found: dict[int, Normal] = {}
        for tile in self.tiles():
            rest = self._residual(tile.low - self.kernel.low_pixels(tile, self.grid))
            left = self.whitening(rest)
            usable = np.isfinite(left)
            if usable.sum() < _MIN_PIXELS:
                continue
            y = self.whitening(np.where(np.isfinite(rest), tile.low, np.nan))[usable]
            fields = np.dstack([basis.columns(tile), self.kernel.light_from_beyond(tile)])
            columns = self.whitening(fields)[usable]
            scale = self.white_noise or self.noise
            weight = np.ones(y.size)
            if self.robust and scale > 0:
                weight = outlier_weights(left[usable] / scale)
            of = core(tile.regions)[usable]
            for region in np.unique(of).tolist():
                own = of == region
                part = _centred(columns[own], y[own], weight[own])
                before = found.get(region)
                found[region] = part if before is None else _sum([before, part])
        if not found:
            raise TargetError(
                f"no part of the region keeps {_MIN_PIXELS} low pixels that follow the high image: "
                "one of the two is even but for a few outlying values; choose a region with more "
                "structure, or state the value of pixels without data (nodata, --nodata)"
            )
        beyond = [one.gram[:-1, -1] for one in found.values()]
        return [_without_last(one) for one in found.values()], np.stack(beyond, axis=1)

    def counts(self) -> tuple[int, int]:
        """Low pixels used and left out."""
        used = lost = 0
        for tile in self.tiles():
            usable = np.isfinite(core(tile.low))
            kept = np.isfinite(
                core(self._residual(tile.low - self.kernel.low_pixels(tile, self.grid)))
            )
            used += int(kept.sum())
            lost += int((usable & ~kept).sum())
        return used, lost


def _centred(columns: Floats, y: Floats, weight: Floats) -> Normal:
    """Normal equations of some pixels about their mean."""
    total = float(weight.sum())
    y = y - weight @ y / total
    columns = columns - weight @ columns / total
    pulled = columns * weight[:, None]
    return Normal(pulled.T @ columns, pulled.T @ y, float(weight @ y**2), max(total - 1, 0.0))


def _without_last(normal: Normal) -> Normal:
    return replace(normal, gram=normal.gram[:-1, :-1], projection=normal.projection[:-1])


def _finite(field: Floats) -> Floats:
    return field[np.isfinite(field)]


def _sum(normals: Sequence[Normal]) -> Normal:
    return Normal(
        sum((one.gram for one in normals[1:]), normals[0].gram),
        sum((one.projection for one in normals[1:]), normals[0].projection),
        sum(one.data for one in normals),
        sum(one.count for one in normals),
    )


def square_root(gram: Floats) -> Floats:
    """A factor of products (k, k), which rounding may have left with powers below zero."""
    power, axes = np.linalg.eigh(gram)
    return np.asarray(axes * np.sqrt(np.maximum(power, 0.0)))


def without_noise(normal: Normal, products: Floats, beta: Floats) -> Normal:
    """Normal equations less what the reference's noise is expected to add.

    The effective noise it makes in the low pixels stays in the residual's power. Where noise
    seems to be most of a direction's power, only half of that is taken off.

    Raises
    ------
    TargetError
        If the noise is no finite number, or so small that its products are not positive.
    """
    expected = normal.count * products
    try:
        root = np.linalg.cholesky(expected + 1e-9 * np.trace(expected) * np.eye(beta.size))
        inner = np.linalg.solve(root, np.linalg.solve(root, normal.gram).T)
        power, axes = np.linalg.eigh(0.5 * (inner + inner.T))
    except np.linalg.LinAlgError as error:
        raise TargetError(
            f"the noise of the high image cannot be taken off ({error}): state its standard "
            "deviation (noise_high, --high-noise), 0 for none"
        ) from error
    taken = np.minimum(1.0, tuned.MAX_NOISE_SHARE * np.maximum(power, 0.0))
    shape = root @ axes
    removed = (shape * taken) @ shape.T
    return replace(
        normal, gram=normal.gram - removed, data=normal.data + float(beta @ removed @ beta)
    )


def _regressed(
    basis: KernelBasis,
    prior: CombinedPrior,
    regions: Sequence[Normal],
    noise: float,
    high_noise: HighNoise,
    whitening: Whitening,
    earlier: Posterior | None,
) -> Posterior:
    """The posterior that all regions give together, the reference's noise taken off."""
    normal = _sum(regions)
    if high_noise.power > 0:
        products = high_noise.power * noise_gram(basis.taps(), basis.grid, whitening)
        normal = without_noise(normal, products, prior.mean if earlier is None else earlier.beta)
    # Less leaves equations of smooth scenes without a solution.
    floor = 5e-4 * float(np.sqrt(normal.data / max(normal.count, 1.0)))
    return prior.posterior(normal, noise**2, noise_floor=floor, earlier=earlier)


def _covariance(
    basis: KernelBasis,
    prior: CombinedPrior,
    posterior: Posterior,
    regions: Sequence[Normal],
    beyond: Floats,
    high_noise: HighNoise,
    whitening: Whitening,
) -> KernelCovariance:
    """How noise, and single regions, move the coefficients."""
    beta = posterior.beta
    response = prior.response(posterior, posterior.variance)
    unit = noise_gram(basis.taps(), basis.grid, whitening)
    products = high_noise.power * unit
    scores = [one.projection - (one.gram - one.count * products) @ beta for one in regions]
    total = _sum(regions)
    moves = response @ np.stack(scores, axis=1)
    return KernelCovariance(
        posterior=posterior.factor,
        reference_noise=high_noise.power_std * response @ (total.count * unit @ beta)[:, None],
        scatter=moves - moves.mean(axis=1, keepdims=True),
        white=np.sqrt(posterior.variance) * response @ square_root(total.gram),
        beyond=_beyond_factor(response @ beyond),
    )


def _beyond_factor(moves: Floats) -> Floats:
    """Factor (k, 5) of the covariance by light from beyond the image, from moves (k, regions).

    What it does to all regions together is no accident: ground next to a bright border is darker
    in the mean, so that the tail comes out too small. The rest scatters between bands of regions.
    """
    parts = np.array_split(moves, _BANDS, axis=1)
    bands = np.stack([part.sum(axis=1) for part in parts], axis=1)
    together = bands.sum(axis=1, keepdims=True)
    return np.hstack([together, bands - together / _BANDS])
