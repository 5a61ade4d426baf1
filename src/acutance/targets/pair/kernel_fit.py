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

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.numerics.marginal_likelihood import Posterior, Prior, regress
from acutance.numerics.noise import outlier_weights, robust_scale
from acutance.numerics.normal_equations import Normal
from acutance.targets.pair import tuned
from acutance.targets.pair.gaussian_fit import GaussianFit
from acutance.targets.pair.kernel_basis import KernelBasis
from acutance.targets.pair.kernel_covariance import KernelCovariance
from acutance.targets.pair.noise import WHITE, Whitening, noise_gram, whitening_of
from acutance.targets.pair.tile import PairTile, TapGrid, Tiles, blurred, blurred_far, core

__all__ = ["Kernel", "KernelFit", "fit_kernel", "kernel_prior", "square_root", "without_noise"]


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
    whitening : Whitening
    noise : float
        Robust standard deviation of the residuals, before whitening.
    noise_high : float
        Standard deviation of the reference's noise that was allowed for.
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
    whitening: Whitening
    noise: float
    noise_high: float
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
    processes: int = 3,
    noise_high: float = 0.0,
    robust: bool = True,
) -> KernelFit:
    """Fit the kernel freely about its parametric form.

    Parameters
    ----------
    tiles : Tiles
    grid : TapGrid
    gaussian : GaussianFit
        The parametric fit.
    processes : int, optional
        How many of the basis' processes.
    noise_high : float, optional
        Standard deviation of the reference's noise in a sample.
    robust : bool, optional
        Leave out what fits badly.

    Raises
    ------
    TargetError
        If the noise of the high image cannot be taken off.
    """
    basis = KernelBasis(grid, gaussian.down, gaussian.across, processes)
    prior = kernel_prior(basis, gaussian.gain)
    first = _Residuals(tiles, grid, Kernel.of(basis, prior.mean), WHITE, gaussian.noise, robust)
    normals = first.normals(basis).values()
    rough = _regressed(basis, prior, normals, gaussian.noise, noise_high, WHITE, None)
    kernel = Kernel.of(basis, rough.beta)
    noise = _Residuals(tiles, grid, kernel, WHITE, 0.0, robust).scale()
    coloured = _Residuals(tiles, grid, kernel, WHITE, noise, robust)
    whitening = whitening_of(coloured.fields())
    white_noise = replace(coloured, whitening=whitening).scale()
    white = replace(coloured, whitening=whitening, white_noise=white_noise)
    regions = white.normals(basis)
    posterior = _regressed(
        basis, prior, regions.values(), gaussian.noise, noise_high, whitening, rough
    )
    used, left_out = white.counts()
    return KernelFit(
        grid=grid, basis=basis, posterior=posterior,
        covariance=_covariance(basis, posterior, list(regions.values()), noise_high, whitening),
        whitening=whitening, noise=noise, noise_high=noise_high, used=used, left_out=left_out,
        robust=robust,
    )  # fmt: skip


def kernel_prior(basis: KernelBasis, gain: float) -> Prior:
    """Prior of the coefficients about the parametric kernel of a gain."""
    mean = np.zeros(basis.size)
    mean[0] = gain
    return Prior(
        block=np.asarray(basis.blocks, float),
        scale=basis.scale,
        mean=mean,
        log_amplitude=basis.log_amplitude,
        log_amplitude_std=tuned.LOG_AMPLITUDE_STD,
        height=abs(gain),
        noise_floor=1e-3,
    )


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

    def normals(self, basis: KernelBasis) -> Mapping[int, Normal]:
        """Normal equations of every region, tile means left out."""
        found: dict[int, Normal] = {}
        for tile in self.tiles():
            rest = self._residual(tile.low - self.kernel.low_pixels(tile, self.grid))
            left = self.whitening(rest)
            usable = np.isfinite(left)
            if usable.sum() < 8:
                continue
            y = self.whitening(np.where(np.isfinite(rest), tile.low, np.nan))[usable]
            columns = self.whitening(basis.columns(tile))[usable]
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
        return found

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
    prior: Prior,
    regions: Iterable[Normal],
    noise: float,
    noise_high: float,
    whitening: Whitening,
    earlier: Posterior | None,
) -> Posterior:
    """The posterior that all regions give together, the reference's noise taken off."""
    normal = _sum(list(regions))
    if noise_high > 0:
        products = noise_high**2 * noise_gram(basis.taps(), basis.grid, whitening)
        normal = without_noise(normal, products, prior.mean if earlier is None else earlier.beta)
    floor = 1e-5 * float(np.sqrt(normal.data / max(normal.count, 1.0)))
    return regress(normal, replace(prior, noise_floor=floor), noise**2, 1.0, earlier)


def _covariance(
    basis: KernelBasis,
    posterior: Posterior,
    regions: Sequence[Normal],
    noise_high: float,
    whitening: Whitening,
) -> KernelCovariance:
    """How noise, and single regions, move the coefficients."""
    beta, k = posterior.beta, basis.size
    # Conditional covariance: what the amplitudes add is no answer to the residuals.
    response = posterior.factor[:, :k] @ posterior.factor[:, :k].T / posterior.variance
    products = noise_high**2 * noise_gram(basis.taps(), basis.grid, whitening)
    scores = [one.projection - (one.gram - one.count * products) @ beta for one in regions]
    total = _sum(regions)
    moves = response @ np.stack(scores, axis=1)
    return KernelCovariance(
        posterior=posterior.factor,
        reference_noise=tuned.NOISE_POWER_STD * response @ (total.count * products @ beta),
        scatter=moves - moves.mean(axis=1, keepdims=True),
        white=np.sqrt(posterior.variance) * response @ square_root(total.gram),
    )
