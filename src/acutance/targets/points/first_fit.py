"""The first fit of points: one elliptical Gaussian through a pixel for all sources."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel_2d import WIDE_WIDTHS, GaussianPixel2d, PixelSlopes
from acutance.targets.points import tuned
from acutance.targets.points.per_source import SourceProblem
from acutance.targets.points.stamps import Stamps

__all__ = ["FirstFit", "fit_first_gaussian", "own_columns", "unlike_sources"]

_MAX_STEPS = 25
_SETTLED = 3e-4
_MAX_STEP_PX = 0.4
_WINGS_BOUNDS = (-0.6, 1.5)
_SIGMAS_PX = (0.4, 0.7, 1.2, 2.0)
_CORE_PX = 3.0


@dataclass(frozen=True, eq=False)
class FirstFit:
    """Sources seen through one Gaussian, pixel and wings.

    Parameters
    ----------
    blur : GaussianPixel2d
    wings : float
        Share of a Gaussian twice as wide that is added: light around the core, or missing there.
    places : (k, 2) array
        Sources as (row, col).
    fluxes : (k,) array
        Light of each, summed over pixels.
    backgrounds : (k, 3) array
        Background under each source, and its slopes down and to the right.
    residual : (n,) array
        What is left of every pixel.
    """

    blur: GaussianPixel2d
    wings: float
    places: Floats
    fluxes: Floats
    backgrounds: Floats
    residual: Floats

    def both(self, core: PixelSlopes, wings: PixelSlopes) -> tuple[Floats, Floats, Floats]:
        """PSF and slopes, from those of core and wings."""
        psf, by_x, by_y = (core[i] + self.wings * wings[i] for i in range(3))
        return psf, by_x, by_y

    def psf(self, x: Floats, y: Floats) -> Floats:
        """The PSF, not normalised, at places (x, y), (n,)."""
        core = self.blur.psf(x, y)
        return core + self.wings * self.blur.widened(WIDE_WIDTHS).psf(x, y) if self.wings else core


def own_columns(
    stamps: Stamps, places: Floats, fluxes: Floats, psf: tuple[Floats, Floats, Floats]
) -> Floats:
    """What each source's own unknowns do to its pixels, (n, 6).

    The unknowns are flux, place across and along, background and its slopes down and right;
    `psf` holds the PSF and its slopes by x and y at the pixels, for unit flux.
    """
    x, y = stamps.offsets(np.rint(places))
    flux = fluxes[stamps.owner]
    return np.stack([psf[0], -flux * psf[1], -flux * psf[2], np.ones(x.size), y, x], axis=1)


def fit_first_gaussian(stamps: Stamps, places: Floats) -> FirstFit:
    """Fit flux, place and background of every source, and one blur for all.

    This is plain least squares, but six of the unknowns of each source touch its own pixels alone:
    eliminated source by source, a step costs as many times more as there are sources.
    ``scipy.optimize.least_squares`` needs twice the time with a dense Jacobian of 20 sources, 1.5
    times with a sparse one of 150.

    Parameters
    ----------
    stamps : Stamps
    places : (k, 2) array
        First guess of the sources' (row, col), to a pixel.
    """
    best = min((_levels(stamps, places, sigma) for sigma in _SIGMAS_PX), key=_cost)
    for _ in range(_MAX_STEPS):
        step = _step(stamps, best)
        better = _bounded(stamps, best, *step)
        if better is None:
            break
        gained = 1 - _cost(better) / max(_cost(best), 1e-300)
        best = better
        if gained < _SETTLED and np.abs(step[1][:, 1:3]).max() < 1e-3:
            break
    return best


def unlike_sources(stamps: Stamps, found: FirstFit) -> tuple[Floats, NDArray[np.bool_]]:
    """What the common blur leaves of each source, and of which ones far more than of the others.

    Returns
    -------
    share : (k,) array
        Root mean square residual within three pixels, less what noise explains, over the peak.
    unlike : (k,) bool array
        Where that is significant, large, and several times what is usual.
    """
    noise = max(stamps.noise_of(found.residual), 1e-300)
    x, y = stamps.offsets(found.places)
    core = np.hypot(x, y) <= _CORE_PX
    count = np.maximum(np.bincount(stamps.owner[core], minlength=found.fluxes.size), 1)
    power = np.bincount(stamps.owner[core], found.residual[core] ** 2, found.fluxes.size) / count
    peak = found.fluxes * found.blur.peak * (1 + found.wings / WIDE_WIDTHS**2)
    share = np.sqrt(np.maximum(power - noise**2, 0.0)) / peak
    surely = np.sqrt(np.maximum(power - noise**2 * (1 + 3 * np.sqrt(2 / count)), 0.0)) / peak
    usual = float(np.median(surely))
    return share, surely > max(tuned.UNLIKE_SHARE, tuned.TIMES_USUAL * usual)


def _cost(found: FirstFit) -> float:
    return float(found.residual @ found.residual)


def _levels(stamps: Stamps, places: Floats, sigma_px: float) -> FirstFit:
    """Fluxes and backgrounds for a round blur at given places."""
    blur = GaussianPixel2d(sigma_px**2, 0.0, sigma_px**2)
    values = blur.psf(*stamps.all_offsets(places))
    psf = values[: stamps.value.size]
    ones = np.ones(places.shape[0])
    columns = own_columns(stamps, places, ones, (psf, psf, psf))[:, [0, 3, 4, 5]]
    empty = np.empty((stamps.value.size, 0))
    flat = np.ones(stamps.value.size)
    own = SourceProblem(columns, empty, stamps.value, stamps.starts).eliminated(flat).own(empty[0])
    fluxes = np.maximum(own[:, 0], 1e-9 * float(np.abs(own[:, 0]).max()))
    found = FirstFit(blur, 0.0, places, fluxes, own[:, 1:], flat)
    return replace(found, residual=_residual(stamps, found, values))


def _residual(stamps: Stamps, found: FirstFit, values: Floats) -> Floats:
    """What is left of every pixel, from the PSF at `Stamps.all_offsets`."""
    light = stamps.summed(found.fluxes, values)
    return stamps.value - light - stamps.levels(found.places, found.backgrounds)


def _step(stamps: Stamps, found: FirstFit) -> tuple[Floats, Floats]:
    """One Gauss-Newton step: of Sigma and wings, (4,), and of every source's unknowns, (k, 6)."""
    x, y = stamps.offsets(found.places)
    core, wings = found.blur.slopes(x, y), found.blur.widened(WIDE_WIDTHS).slopes(x, y)
    own = own_columns(stamps, found.places, found.fluxes, found.both(core, wings))
    flux = found.fluxes[stamps.owner]
    columns = [*core[3:6], wings.psf]
    shared = np.stack(columns, axis=1) * flux[:, None]
    problem = SourceProblem(own, shared, found.residual, stamps.starts)
    blocks = problem.eliminated(np.ones(flux.size))
    normal = blocks.normal
    ridge = 1e-6 * normal.gram.diagonal() + 1e-300
    step = np.asarray(np.linalg.solve(normal.gram + np.diag(ridge), normal.projection), float)
    return step, blocks.own(step)


def _bounded(stamps: Stamps, found: FirstFit, shape: Floats, own: Floats) -> FirstFit | None:
    """The step, or the part of it that makes the residuals smaller; None if there is none."""
    moves = own[:, [2, 1]]
    longest = np.hypot(moves[:, 0], moves[:, 1])
    moves = moves * np.minimum(1.0, _MAX_STEP_PX / np.maximum(longest, 1e-12))[:, None]
    for share in (1.0, 0.4, 0.1, 0.02):
        fluxes = found.fluxes + share * own[:, 0]
        tried = FirstFit(
            found.blur.moved(*(share * shape[:3]).tolist()),
            float(np.clip(found.wings + share * shape[3], *_WINGS_BOUNDS)),
            found.places + share * moves,
            np.maximum(fluxes, 0.1 * found.fluxes),
            found.backgrounds + share * own[:, 3:],
            found.residual,
        )
        values = tried.psf(*stamps.all_offsets(tried.places))
        tried = replace(tried, residual=_residual(stamps, tried, values))
        if _cost(tried) <= _cost(found):
            return tried
    return None
