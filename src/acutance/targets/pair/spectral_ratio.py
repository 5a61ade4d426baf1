"""The second estimator: the ratio of cross spectrum to power spectrum, weighted by coherence.

With L and R the spectra of the low and of the high image in windows of the same ground,
``T = <L R*> / <|R|^2>`` is the kernel's transfer: what is aliased in the low image, or seen by one
sensor alone, has no fixed phase against the reference and averages out. The coherence
``g^2 = |<L R*>|^2 / (<|L|^2> <|R|^2>)`` gives the variance ``(1 - g^2) / (g^2 K) |T|^2`` of N
windows, half of it in phase (Bendat and Piersol, Random Data, chapter 9). The kernel is the one of
`kernel_basis`, fitted to T at all frequencies of the plane up to the reference's Nyquist.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter

from acutance.curves.grid import Floats
from acutance.errors import TargetError
from acutance.numerics.normal_equations import Normal
from acutance.targets.pair import tuned
from acutance.targets.pair.gaussian_fit import GaussianFit
from acutance.targets.pair.kernel_covariance import KernelCovariance
from acutance.targets.pair.kernel_fit import KernelFit, square_root
from acutance.targets.pair.noise import WHITE
from acutance.targets.pair.tile import PAD_PX, Complexes, PairTile, TapAxis, TapGrid, first_of_cell

__all__ = ["PairSpectra", "fit_spectra", "pair_spectra"]

_MIN_WINDOWS = 2
_MISSING = 0.05
_LOWEST_BINS = 1.5
_MIN_COHERENCE = 1e-4
_PARTS = 5


@dataclass(frozen=True, eq=False)
class PairSpectra:
    """Averaged spectra of windows of both images.

    Frequencies in cycles per low pixel up to the reference's Nyquist; phases are relative to the
    parametric kernel's centre.

    Parameters
    ----------
    u_cpp, v_cpp : (m,) and (n,) arrays
        Frequencies across and along, ascending.
    cross : (n, m) complex array
    low, high : (n, m) arrays
        Power; that of the low image repeats itself with its sampling.
    windows : int
    size_px : int
        Side of a window in low pixels.
    part_cross, part_high : (g, n, m) arrays
        Shares of `cross` and `high` from separate parts of the images; they sum to the whole.
    """

    u_cpp: Floats
    v_cpp: Floats
    cross: Complexes
    low: Floats
    high: Floats
    windows: int
    size_px: int
    part_cross: Complexes
    part_high: Floats

    @property
    def transfer(self) -> Complexes:
        """The kernel's transfer with its gain, (n, m)."""
        return self.cross / np.maximum(self.high, 1e-300)

    @property
    def coherence(self) -> Floats:
        """Squared coherence over neighbouring frequencies, (n, m), less its bias."""
        return self._coherence((3, 3))

    def _coherence(self, around: tuple[int, int]) -> Floats:
        """Over so many frequencies along and across."""
        cross = _smooth(self.cross.real, around) + 1j * _smooth(self.cross.imag, around)
        power = _smooth(self.low, around) * _smooth(self.high, around)
        found = np.abs(cross) ** 2 / np.maximum(power, 1e-300)
        bias = 1 / (math.prod(around) * self.windows / tuned.OVERLAP + 1)
        return np.clip((found - bias) / (1 - bias), 0.0, 1.0)

    @property
    def noise(self) -> Floats:
        """Power of the low image that the high one does not explain, (n, m), in one window.

        Smooth over neighbouring frequencies: single ones would be weighted by their own chance.
        """
        share = uniform_filter(1 - self.coherence, 3, mode="nearest")
        floor = (tuned.LEAKAGE * np.abs(self.cross)) ** 2 / np.maximum(self.high, 1e-300)
        return np.asarray(share * _smooth(self.low) + _smooth(floor))

    def along_axis(self, axis: str) -> tuple[Floats, Floats]:
        """Frequencies from 0 and squared coherence across or along, averaged over 7 bins."""
        middle_v, middle_u = self.v_cpp.size // 2, self.u_cpp.size // 2
        if axis == "across":
            return self.u_cpp[middle_u:], self._coherence((7, 3))[middle_v, middle_u:]
        return self.v_cpp[middle_v:], self._coherence((3, 7))[middle_v:, middle_u]


def _smooth(field: Floats, around: tuple[int, int] = (3, 3)) -> Floats:
    return np.asarray(uniform_filter(field, around, mode="nearest"))


def pair_spectra(
    tiles: Iterable[PairTile],
    residuals: Iterable[Floats],
    grid: TapGrid,
    gaussian: GaussianFit,
    size_px: int,
) -> PairSpectra | None:
    """Spectra of all windows with both images whole; None where too few of them fit together.

    Parameters
    ----------
    tiles : iterable of PairTile
    residuals : iterable of (h, w) arrays
        Of the kernel fit, NaN where a pixel was left out.
    grid : TapGrid
    gaussian : GaussianFit
    size_px : int
        Side of a window in low pixels, even.
    """
    down = _Window(grid.down, gaussian.down.shift_px, size_px)
    across = _Window(grid.across, gaussian.across.shift_px, size_px)
    if not (down.high_taper.any() and across.high_taper.any()):
        # Displaced by more than a window: no two show the same ground.
        return None
    shape = down.order.size, across.order.size
    cross, high = np.zeros((_PARTS**2, *shape), complex), np.zeros((_PARTS**2, *shape))
    low, count = np.zeros(shape), 0
    for tile, residual in zip(tiles, residuals, strict=True):
        for place, pixels, samples in _windows(tile, residual, grid, size_px):
            a = _spectrum(pixels, down.low_taper, across.low_taper)
            b = _spectrum(samples, down.high_taper, across.high_taper)
            a = a[np.ix_(down.order % size_px, across.order % size_px)]
            b = b[np.ix_(down.order % samples.shape[0], across.order % samples.shape[1])]
            b = b / (grid.down.per_px * grid.across.per_px)
            part = (place[0] // size_px % _PARTS) * _PARTS + place[1] // size_px % _PARTS
            cross[part] += a * np.conj(b)
            high[part] += np.abs(b) ** 2
            low += np.abs(a) ** 2
            count += 1
    if count < _MIN_WINDOWS:
        return None
    filled = high.any(axis=(1, 2))
    cross = cross[filled] * (down.rotation[:, None] * across.rotation) / count
    high = high[filled] / count
    return PairSpectra(
        across.order / size_px, down.order / size_px, cross.sum(axis=0), low / count,
        high.sum(axis=0), count, size_px, cross, high,
    )  # fmt: skip


class _Window:
    """Tapers of a window along one axis, on the same ground, and the phase between the samples."""

    def __init__(self, axis: TapAxis, shift_px: float, size: int) -> None:
        most = size * axis.per_px // 2
        self.order = np.arange(-most + 1, most)
        samples = np.arange(size * axis.per_px) + first_of_cell(axis)
        places = samples / axis.per_px + axis.offset_px + shift_px
        self.low_taper = _hann(np.arange(size, dtype=float), size)
        self.high_taper = _hann(places, size)
        # From the first sample's place to that of the low pixel, as the content is displaced.
        self.rotation = np.exp(2j * math.pi * self.order / size * places[0])


def _hann(places_px: Floats, size: int) -> Floats:
    inside = np.clip((places_px + 0.5) / size, 0.0, 1.0)
    return np.asarray(np.sin(math.pi * inside) ** 2)


def _windows(
    tile: PairTile, residual: Floats, grid: TapGrid, size: int
) -> Iterator[tuple[tuple[int, int], Floats, Floats]]:
    """Places in the low image, low pixels there, and the samples under them, both flattened."""
    values = np.where(np.isfinite(residual), tile.low, np.nan)
    axes = (grid.down, grid.across)
    # On the right lie pads, which are holes at the border of the image.
    height, width = values.shape[0], values.shape[1] - PAD_PX
    for i in _starts(height, size):
        for j in _starts(width, size):
            pixels = values[i - 1 : i + size + 1, j - 1 : j + size + 1]
            holes = ~np.isfinite(pixels)
            if holes.mean() > _MISSING:
                continue
            if holes.any():
                pixels = np.where(holes, _neighbours(pixels), pixels)
            top, left = (
                axis.half + axis.per_px * (first - 1) + first_of_cell(axis)
                for axis, first in zip(axes, (i, j), strict=True)
            )
            rows, cols = ((size + 2) * axis.per_px for axis in axes)
            samples = tile.fine[top : top + rows, left : left + cols]
            place = tile.place[0] + i, tile.place[1] + j
            flat = _flattened(samples, grid.down.per_px, grid.across.per_px)
            yield place, _flattened(pixels, 1, 1), flat


def _starts(length: int, size: int) -> list[int]:
    """Where windows with a border of one pixel begin: half overlapping, spread evenly."""
    first, last = PAD_PX + 1, length - size - 1
    if last < first:
        return []
    count = 1 + round((last - first) / (size / 2))
    return [round(place) for place in np.linspace(first, last, count).tolist()]


def _flattened(field: Floats, down: int, across: int) -> Floats:
    """A field minus the mean of its neighbours a low pixel away, where it has all four.

    The same filter on the ground for both images: their ratio stays, but the spectrum of a
    landscape, steep as it is, becomes flat enough for windows to keep frequencies apart.
    """
    rows, cols = slice(down, -down), slice(across, -across)
    sides = field[rows, : -2 * across] + field[rows, 2 * across :]
    return np.asarray(
        field[rows, cols] - 0.25 * (field[: -2 * down, cols] + field[2 * down :, cols] + sides)
    )


def _flattening(u_cpp: Floats, v_cpp: Floats) -> Floats:
    """Transfer of `_flattened`."""
    return np.asarray(1 - 0.5 * (np.cos(2 * math.pi * u_cpp) + np.cos(2 * math.pi * v_cpp)))


def _neighbours(pixels: Floats) -> Floats:
    """Mean of the known pixels around each, or of all where there are none."""
    known = np.isfinite(pixels)
    share = uniform_filter(known.astype(float), 3, mode="constant")
    total = uniform_filter(np.where(known, pixels, 0.0), 3, mode="constant")
    return np.asarray(np.where(share > 0.05, total / np.maximum(share, 0.05), pixels[known].mean()))


def _spectrum(field: Floats, down: Floats, across: Floats) -> Complexes:
    taper = down[:, None] * across
    mean = float(np.sum(taper * field) / np.sum(taper))
    return np.asarray(np.fft.fft2(taper * (field - mean)))


def fit_spectra(spectra: PairSpectra | None, fit: KernelFit) -> KernelFit:
    """The kernel that fits the ratio of spectra, weighted by coherence.

    Parameters
    ----------
    spectra : PairSpectra or None
    fit : KernelFit
        The fit to the pixels: basis, noise and counts are taken from it.

    Raises
    ------
    TargetError
        If there are no spectra, or no frequency is coherent.
    """
    if spectra is None:
        raise TargetError(
            "the region has too few whole windows for spectra: choose a larger one, or method "
            "kernel-fit"
        )
    basis = fit.basis
    v, u = (grid.ravel() for grid in np.meshgrid(spectra.v_cpp, spectra.u_cpp, indexing="ij"))
    coherence = spectra.coherence.ravel()
    # One of each pair of opposite frequencies, without those next to zero in either image: the
    # mean was taken out there.
    chosen = (v > 0) | ((v == 0) & (u > 0))
    chosen &= np.hypot(u - np.round(u), v - np.round(v)) * spectra.size_px > _LOWEST_BINS
    # Frequencies are not chosen by their own coherence: where there is none, those that are by
    # chance in phase would be kept, and the MTF at Nyquist come out 0.02 too high.
    coherent = int(np.count_nonzero(coherence[chosen] > _MIN_COHERENCE))
    if coherent < 50:
        raise TargetError(
            f"only {coherent} frequencies are coherent between the two images, 50 are needed: they "
            "show different things, or little detail; use method kernel-fit"
        )
    u, v, high = u[chosen], v[chosen], spectra.high.ravel()[chosen]
    # Of a single frequency; half of the noise is in phase.
    precision = 2 * spectra.windows / spectra.noise.ravel()[chosen]
    unit = _noise_power(spectra, basis.grid) * _flattening(u, v) ** 2
    clean = np.maximum(high - fit.high_noise.power * unit, tuned.MAX_NOISE_SHARE * high)
    design = basis.transfer(u, v) * basis.centring(u, v)[:, None]
    cross = spectra.cross.ravel()[chosen]
    weighted = np.conj(design) * precision[:, None]
    normal = Normal(
        ((weighted * clean[:, None]).T @ design).real,
        (weighted.T @ cross).real,
        float(precision @ (np.abs(cross) ** 2 / clean)),
        2.0 * u.size,
    )
    posterior = fit.prior.posterior(normal, 1.0, tuned.OVERLAP)
    noise = tuned.OVERLAP * posterior.variance
    response = fit.prior.response(posterior, noise)
    fitted = design @ posterior.beta * (clean / high)
    rest = [
        part.ravel()[chosen] - power.ravel()[chosen] * fitted
        for part, power in zip(spectra.part_cross, spectra.part_high, strict=True)
    ]
    moves = response @ (weighted.T @ np.stack(rest, axis=1)).real
    # What the gram matrix would lose by noise of more power, also where no more was taken off.
    by_noise = response @ (weighted.T @ (unit * (design @ posterior.beta))).real
    return replace(
        fit, posterior=posterior, whitening=WHITE,
        covariance=KernelCovariance(
            posterior=posterior.factor,
            reference_noise=fit.high_noise.power_std * by_noise[:, None],
            scatter=moves - moves.mean(axis=1, keepdims=True),
            white=np.sqrt(noise) * response @ square_root(normal.gram),
            beyond=fit.covariance.beyond,
        ),
    )  # fmt: skip


def _noise_power(spectra: PairSpectra, grid: TapGrid) -> float:
    """Power in a window's spectrum of noise of variance 1 in the reference's samples."""
    per_px = grid.down.per_px * grid.across.per_px
    hann = (3 / 8) ** 2
    return hann * spectra.size_px**2 / per_px
