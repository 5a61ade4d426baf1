"""The start of every fit of points: one elliptical Gaussian through a pixel for all sources."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acutance.curves.grid import Floats
from acutance.numerics.gaussian_pixel_2d import FOOT_WIDTHS, BlurSlopes, PlaneBlur
from acutance.numerics.noise import robust_scale
from acutance.targets.points.per_source import eliminate
from acutance.targets.points.stamps import Stamps

__all__ = ["BlurredPoints", "fit_blurred_points", "own_columns", "unlike_sources"]

_MAX_STEPS = 25
_SETTLED = 3e-4
_LONGEST_STEP_PX = 0.4
_FOOT = (-0.6, 1.5)
_SIGMAS_PX = (0.4, 0.7, 1.2, 2.0)
_CORE_PX = 3.0
_UNLIKE = 0.05
_TIMES_USUAL = 3.0


@dataclass(frozen=True, eq=False)
class BlurredPoints:
    """Sources seen through one plain blur with a foot.

    Parameters
    ----------
    blur : PlaneBlur
    foot : float
        Share of a broader blur that is added: light around the core, or missing there.
    places : (k, 2) array
        Sources as (row, col).
    fluxes : (k,) array
        Light of each, summed over pixels.
    grounds : (k, 3) array
        Background under each source, and its slopes down and to the right.
    residual : (n,) array
        What is left of every pixel.
    """

    blur: PlaneBlur
    foot: float
    places: Floats
    fluxes: Floats
    grounds: Floats
    residual: Floats

    def slopes(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
        """The PSF, not normalised, and its slopes by x and y at places (x, y), (n,)."""
        return self.both(self.blur.slopes(x, y), self.blur.widened(FOOT_WIDTHS).slopes(x, y))

    def both(self, core: BlurSlopes, foot: BlurSlopes) -> tuple[Floats, Floats, Floats]:
        """PSF and slopes, from those of core and foot."""
        psf, by_x, by_y = (core[i] + self.foot * foot[i] for i in range(3))
        return psf, by_x, by_y

    def psf(self, x: Floats, y: Floats) -> Floats:
        """The PSF, not normalised, at places (x, y), (n,)."""
        core = self.blur.psf(x, y)
        return core + self.foot * self.blur.widened(FOOT_WIDTHS).psf(x, y) if self.foot else core


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


def fit_blurred_points(stamps: Stamps, places: Floats) -> BlurredPoints:
    """Fit flux, place and background of every source, and one blur for all.

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


def unlike_sources(stamps: Stamps, found: BlurredPoints) -> tuple[Floats, NDArray[np.bool_]]:
    """How much each source departs from the common blur, and which ones do so unlike the others.

    Returns
    -------
    departure : (k,) array
        Root mean square residual within three pixels, less what noise explains, over the peak.
    unlike : (k,) bool array
        Where that is significant, large, and several times what is usual.
    """
    noise = max(robust_scale(found.residual), 1e-300)
    x, y = stamps.offsets(found.places)
    core = np.hypot(x, y) <= _CORE_PX
    count = np.maximum(np.bincount(stamps.owner[core], minlength=found.fluxes.size), 1)
    power = np.bincount(stamps.owner[core], found.residual[core] ** 2, found.fluxes.size) / count
    peak = found.fluxes * found.blur.peak * (1 + found.foot / FOOT_WIDTHS**2)
    departure = np.sqrt(np.maximum(power - noise**2, 0.0)) / peak
    surely = np.sqrt(np.maximum(power - noise**2 * (1 + 3 * np.sqrt(2 / count)), 0.0)) / peak
    return departure, surely > max(_UNLIKE, _TIMES_USUAL * float(np.median(surely)))


def _cost(found: BlurredPoints) -> float:
    return float(found.residual @ found.residual)


def _levels(stamps: Stamps, places: Floats, sigma_px: float) -> BlurredPoints:
    """Fluxes and backgrounds for a round blur at given places."""
    blur = PlaneBlur(sigma_px**2, 0.0, sigma_px**2)
    psf = blur.psf(*stamps.offsets(places))
    ones = np.ones(places.shape[0])
    columns = own_columns(stamps, places, ones, (psf, psf, psf))[:, [0, 3, 4, 5]]
    empty = np.empty((stamps.value.size, 0))
    flat = np.ones(stamps.value.size)
    own = eliminate(columns, empty, stamps.value, flat, stamps.starts).own(np.empty(0))
    fluxes = np.maximum(own[:, 0], 1e-9 * float(np.abs(own[:, 0]).max()))
    return _seen(stamps, BlurredPoints(blur, 0.0, places, fluxes, own[:, 1:], flat))


def _seen(stamps: Stamps, found: BlurredPoints) -> BlurredPoints:
    """The same with its residuals."""
    light = stamps.seen(found.places, found.fluxes, found.psf)
    columns = own_columns(stamps, found.places, found.fluxes, (light, light, light))[:, 3:]
    ground = np.einsum("ij,ij->i", columns, found.grounds[stamps.owner])
    return replace(found, residual=stamps.value - light - ground)


def _step(stamps: Stamps, found: BlurredPoints) -> tuple[Floats, Floats]:
    """One Gauss-Newton step: of Sigma and foot, (4,), and of every source's unknowns, (k, 6)."""
    x, y = stamps.offsets(found.places)
    core, foot = found.blur.slopes(x, y), found.blur.widened(FOOT_WIDTHS).slopes(x, y)
    own = own_columns(stamps, found.places, found.fluxes, found.both(core, foot))
    flux = found.fluxes[stamps.owner]
    columns = [*core[3:6], foot.psf]
    shared = np.stack(columns, axis=1) * flux[:, None]
    blocks = eliminate(own, shared, found.residual, np.ones(flux.size), stamps.starts)
    normal = blocks.normal
    ridge = 1e-6 * normal.gram.diagonal() + 1e-300
    step = np.asarray(np.linalg.solve(normal.gram + np.diag(ridge), normal.projection), float)
    return step, blocks.own(step)


def _bounded(
    stamps: Stamps, found: BlurredPoints, shape: Floats, own: Floats
) -> BlurredPoints | None:
    """The step, or the part of it that makes the residuals smaller; None if there is none."""
    moves = own[:, [2, 1]]
    longest = np.hypot(moves[:, 0], moves[:, 1])
    moves = moves * np.minimum(1.0, _LONGEST_STEP_PX / np.maximum(longest, 1e-12))[:, None]
    for share in (1.0, 0.4, 0.1, 0.02):
        fluxes = found.fluxes + share * own[:, 0]
        tried = BlurredPoints(
            found.blur.moved(*(share * shape[:3]).tolist()),
            float(np.clip(found.foot + share * shape[3], *_FOOT)),
            found.places + share * moves,
            np.maximum(fluxes, 0.1 * found.fluxes),
            found.grounds + share * own[:, 3:],
            found.residual,
        )
        tried = _seen(stamps, tried)
        if _cost(tried) <= _cost(found):
            return tried
    return None
