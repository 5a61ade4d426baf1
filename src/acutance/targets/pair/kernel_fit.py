"""The free fit of a pair: the kernel as the parametric one and Gaussian processes about it.

The low pixels are linear in the kernel, so all that they say of it is in one small matrix; the
processes' amplitudes are those of the largest marginal likelihood (`fit.posterior`), and the
covariance is in closed form. Three things keep it honest:

- the mean of every tile is left out, and residuals are whitened by an autoregression;
- the reference's noise makes the kernel too small (errors in the variables): its expected part of
  the normal equations is taken off, and what is uncertain of it goes into the covariance;
- what the residuals of separate regions say together must agree with the stated covariance;
  where they disagree by more, the covariance is inflated (`SandwichRatio`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from acutance.curves.grid import Floats
from acutance.numerics.marginal_likelihood import Posterior, Prior, regress
from acutance.numerics.noise import outlier_weights
from acutance.numerics.normal_equations import Normal
from acutance.targets.pair.first_fit import BlurFit
from acutance.targets.pair.kernel_basis import LOG_AMPLITUDE_STD, KernelBasis
from acutance.targets.pair.noise import WHITE, Whitening, noise_gram, whitening_of
from acutance.targets.pair.tile import PairTile, TapGrid, Tiles, blurred, blurred_far, core

__all__ = ["Kernel", "KernelFit", "fit_kernel"]

_MOST_NOISE: Final = 0.5
"""Share of a direction's power in the reference that may be taken for noise."""
_NOISE_STD: Final = 0.3
"""Relative standard deviation of the reference's noise power, as it is estimated."""
_LOST = 0.05
"""Weight below which a pixel is left out altogether: clouds, changes."""


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

    def seen(self, tile: PairTile, grid: TapGrid) -> Floats:
        """The low pixels it makes of the reference, (h, w)."""
        near = blurred(tile, grid, self.taps)
        return near + blurred_far(tile, self.far) if self.far.any() else near


@dataclass(frozen=True, eq=False)
class KernelFit:
    """What the pair says of the kernel.

    Parameters
    ----------
    grid : TapGrid
    basis : KernelBasis
    posterior : Posterior
        Of the coefficients of the basis; the first is the gain.
    noise_factor : (k,) array
        Change of the coefficients for one standard deviation of the reference's noise power.
    scores : (k, regions) array
        What the residuals of every region would move the coefficients by.
    white_factor : (k, k) array
        Factor of the covariance that white residuals give the coefficients.
    whitening : Whitening
    noise : float
        Robust standard deviation of the residuals, before whitening.
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
    noise_factor: Floats
    scores: Floats
    white_factor: Floats
    whitening: Whitening
    noise: float
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
        return _Pass(tiles, self.grid, self.kernel, WHITE, self.noise, self.robust).residuals()


def fit_kernel(
    tiles: Tiles,
    grid: TapGrid,
    blur: BlurFit,
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
    blur : BlurFit
        The parametric fit.
    processes : int, optional
        How many of the basis' processes.
    noise_high : float, optional
        Standard deviation of the reference's noise in a sample.
    robust : bool, optional
        Leave out what fits badly.
    """
    basis = KernelBasis(grid, blur.down, blur.across, processes)
    start = np.zeros(basis.size)
    start[0] = blur.gain
    first = _Pass(tiles, grid, Kernel.of(basis, start), WHITE, blur.noise, robust)
    rough = _regressed(basis, first.normals(basis), blur, noise_high, WHITE, None)
    kernel = Kernel.of(basis, rough.beta)
    noise = _Pass(tiles, grid, kernel, WHITE, 0.0, robust).scale()
    seen = _Pass(tiles, grid, kernel, WHITE, noise, robust)
    whitening = whitening_of(seen.residuals())
    white_noise = replace(seen, whitening=whitening).scale()
    last = replace(seen, whitening=whitening, white_noise=white_noise)
    normals = last.normals(basis)
    posterior = _regressed(basis, normals, blur, noise_high, whitening, rough)
    return _finish(grid, basis, posterior, normals, noise_high, whitening, noise, last)


@dataclass(frozen=True, eq=False)
class _Pass:
    """One way through all tiles, with what was known of the kernel before."""

    tiles: Tiles
    grid: TapGrid
    kernel: Kernel
    whitening: Whitening
    noise: float
    robust: bool
    white_noise: float = 0.0

    def residuals(self) -> Iterator[Floats]:
        """Residuals of every tile about its own mean, pads included; NaN where left out."""
        for tile in self.tiles():
            yield self._residual(tile.low - self.kernel.seen(tile, self.grid))

    def _residual(self, rest: Floats) -> Floats:
        usable = np.isfinite(rest)
        if not usable.any():
            return rest
        rest = rest - np.median(rest[usable])
        if self.robust and self.noise > 0:
            weight = outlier_weights(np.where(usable, rest, 0.0) / self.noise)
            rest = np.where(weight >= _LOST, rest, np.nan)
            if np.isfinite(rest).any():
                rest = rest - np.nanmean(rest)
        return rest

    def scale(self) -> float:
        """Robust standard deviation of the whitened residuals."""
        sizes = [np.abs(_finite(self.whitening(rest))) for rest in self.residuals()]
        every = np.concatenate(sizes) if sizes else np.zeros(0)
        return 1.4826 * float(np.median(every)) if every.size else 0.0

    def normals(self, basis: KernelBasis) -> Mapping[int, Normal]:
        """Normal equations of every region, tile means left out."""
        found: dict[int, Normal] = {}
        for tile in self.tiles():
            rest = self._residual(tile.low - self.kernel.seen(tile, self.grid))
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
            kept = np.isfinite(core(self._residual(tile.low - self.kernel.seen(tile, self.grid))))
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


def _sum(normals: list[Normal]) -> Normal:
    return Normal(
        sum((one.gram for one in normals[1:]), normals[0].gram),
        sum((one.projection for one in normals[1:]), normals[0].projection),
        sum(one.data for one in normals),
        sum(one.count for one in normals),
    )


def _without_noise(normal: Normal, products: Floats, beta: Floats) -> Normal:
    """Normal equations less what the reference's noise is expected to add.

    The effective noise it makes in the low pixels stays in the residual's power. Where noise
    seems to be most of a direction's power, only half of that is taken off.
    """
    expected = normal.count * products
    root = np.linalg.cholesky(expected + 1e-9 * np.trace(expected) * np.eye(beta.size))
    inner = np.linalg.solve(root, np.linalg.solve(root, normal.gram).T)
    power, axes = np.linalg.eigh(0.5 * (inner + inner.T))
    taken = np.minimum(1.0, _MOST_NOISE * np.maximum(power, 0.0))
    shape = root @ axes
    removed = (shape * taken) @ shape.T
    return replace(
        normal, gram=normal.gram - removed, data=normal.data + float(beta @ removed @ beta)
    )


def _regressed(
    basis: KernelBasis,
    normals: Mapping[int, Normal],
    blur: BlurFit,
    noise_high: float,
    whitening: Whitening,
    earlier: Posterior | None,
) -> Posterior:
    normal = _sum(list(normals.values()))
    start = np.zeros(basis.size)
    start[0] = blur.gain
    if noise_high > 0:
        products = noise_high**2 * noise_gram(basis.taps(), basis.grid, whitening)
        known = start if earlier is None else earlier.beta
        normal = _without_noise(normal, products, known)
    prior = Prior(
        block=np.asarray(basis.blocks, float),
        scale=basis.scale,
        mean=start,
        log_amplitude=basis.log_amplitude,
        log_amplitude_std=LOG_AMPLITUDE_STD,
        height=abs(blur.gain),
        noise_floor=1e-5 * float(np.sqrt(normal.data / max(normal.count, 1.0))),
    )
    return regress(normal, prior, blur.noise**2, 1.0, earlier)


def _finish(
    grid: TapGrid,
    basis: KernelBasis,
    posterior: Posterior,
    normals: Mapping[int, Normal],
    noise_high: float,
    whitening: Whitening,
    noise: float,
    last: _Pass,
) -> KernelFit:
    """Put the fit together with the moves that noise and single regions make."""
    beta, k = posterior.beta, basis.size
    # Conditional covariance: what the amplitudes add is no answer to the residuals.
    response = posterior.factor[:, :k] @ posterior.factor[:, :k].T / posterior.variance
    products = noise_high**2 * noise_gram(basis.taps(), grid, whitening)
    scores = [one.projection - (one.gram - one.count * products) @ beta for one in normals.values()]
    total = _sum(list(normals.values()))
    power, axes = np.linalg.eigh(total.gram)
    root = axes * np.sqrt(np.maximum(power, 0.0))
    used, lost = last.counts()
    return KernelFit(
        grid=grid,
        basis=basis,
        posterior=posterior,
        noise_factor=_NOISE_STD * response @ (total.count * products @ beta),
        scores=response @ np.stack(scores, axis=1),
        white_factor=np.sqrt(posterior.variance) * response @ root,
        whitening=whitening,
        noise=noise,
        used=used,
        left_out=lost,
        robust=last.robust,
    )
