"""The impulse method of South Dakota State University: one Gaussian for an array of mirrors.

Helder, Choi, Rangaswamy, "Quickbird satellite in-orbit modulation transfer function (MTF)
measurement using edge, pulse and impulse methods for summer 2003" (2005), 3.2 and 5.7 to 5.9; the
same steps are those of Li et al., "On-orbit MTF estimation methods", 2.3:

1. every source gets a 2-D Gaussian (peak, place, two widths, bias) by least squares, from its
   brightest pixel and the mean of its surroundings;
2. the sources are moved onto one another by their fitted places;
3. one Gaussian is fitted to the pixels of all of them together, in windows of 3 x 3 pixels. The
   ring around, to 5 x 5, "was effectively a 'bias' that was not used in the calculation of model
   parameters";
4. its slices through the peak are the PSF across and along, their Fourier transforms the MTF.

The model is not integrated over the pixel, knows no tails, and takes the slice for the LSF: exact
for a Gaussian whose samples are points, biased for everything else. The report does not print the
window of step 1, which is that of step 3 here. Its mirrors were equally bright but for what the
atmosphere did: sources that are not are an option of this package, not of the report.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from acutance.arguments import require_types
from acutance.curves.grid import Floats
from acutance.errors import OptionError, SupportError
from acutance.targets.points.detect import RejectedSpot

__all__ = [
    "AlignedFit",
    "GaussianPsf",
    "MirrorFit",
    "PublishedMirrors",
    "SdsuMirrorsOptions",
    "sdsu_2003_mirrors",
]

Complexes = NDArray[np.complex128]
_AROUND_PX = 5
_INCOMPLETE = "pixels of its window or its surroundings are missing"


@dataclass(frozen=True)
class SdsuMirrorsOptions:
    """Options of the impulse method of 2003.

    Parameters
    ----------
    window_px : int
        Side of the window whose pixels determine the Gaussians. The report's is 3, its 5 is
        drawn and not fitted.
    scaled : bool
        Whether each source is scaled by its own peak above its own bias before all are fitted.
        The report moves places alone. For sources of unequal brightness; among equal ones, half
        way between pixels, sharp Gaussians with too high a peak spoil the sum.

    Raises
    ------
    OptionError
        If a value is of another kind, or makes no sense.
    """

    window_px: int = 3
    scaled: bool = False

    def __post_init__(self) -> None:
        require_types(self)
        if self.window_px not in (3, 5, 7, 9):
            raise OptionError(f"window_px is {self.window_px}: windows have 3, 5, 7 or 9 pixels")


@dataclass(frozen=True)
class GaussianPsf:
    """A Gaussian PSF along the axes of the image, as a transfer model of the plane.

    Parameters
    ----------
    sigma_x_px, sigma_y_px : float
        Standard deviations along the rows and down the columns.
    factor_px : (2, k) tuple of tuples
        Factor of the covariance of both.
    """

    sigma_x_px: float
    sigma_y_px: float
    factor_px: tuple[tuple[float, ...], tuple[float, ...]]

    @property
    def band_cpp(self) -> float:
        """Frequency beyond which nothing is transferred."""
        return float(np.clip(1.0 / min(self.sigma_x_px, self.sigma_y_px), 2.0, 8.0))

    def otf(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """OTF, (n,), 1 at zero frequency."""
        power = (self.sigma_x_px * u_cpp) ** 2 + (self.sigma_y_px * v_cpp) ** 2
        return np.asarray(np.exp(-2 * np.pi**2 * power), complex)

    def factor(self, u_cpp: Floats, v_cpp: Floats) -> Complexes:
        """Factor of its covariance, (n, k)."""
        by = np.stack([self.sigma_x_px * u_cpp**2, self.sigma_y_px * v_cpp**2], axis=1)
        slopes = -4 * np.pi**2 * by * self.otf(u_cpp, v_cpp)[:, None]
        return np.asarray(slopes @ np.array(self.factor_px))


@dataclass(frozen=True)
class MirrorFit:
    """One source's own Gaussian: place (row, col), its standard deviations, peak and bias."""

    row: float
    col: float
    row_std: float
    col_std: float
    peak: float
    sigma_x_px: float
    sigma_y_px: float
    bias: float

    def at(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """The Gaussian with its bias at columns x and rows y."""
        p = np.array([self.peak, self.col, self.row, self.sigma_x_px, self.sigma_y_px])
        return self.bias + _gaussian(p, np.asarray(x, float), np.asarray(y, float))


@dataclass(frozen=True)
class AlignedFit:
    """The reported numbers of the Gaussian through all aligned samples.

    Parameters
    ----------
    sigma_x_px, sigma_y_px : float
        Its standard deviations along the rows and down the columns of the image.
    rmse : float
        Root mean square residual, in image units.
    background_mean, background_std : float
        Level and standard deviation of the background around the sources.
    mean_peak : float
        Peak of that Gaussian above its bias, in image units.
    """

    sigma_x_px: float
    sigma_y_px: float
    rmse: float
    background_mean: float
    background_std: float
    mean_peak: float

    @property
    def peak_over_background(self) -> float:
        """What the report calls SNR in its Figure 5.17: peak over the mean background."""
        return self.mean_peak / self.background_mean if self.background_mean > 0 else math.inf

    def to_dict(self) -> dict[str, float | None]:
        """All numbers by name, for JSON; no ratio to a background that is not above zero."""
        ratio = self.peak_over_background
        return {**vars(self), "peak_over_background": ratio if math.isfinite(ratio) else None}


@dataclass(frozen=True, eq=False)
class PublishedMirrors:
    """All sources, and the Gaussian of the aligned samples.

    Parameters
    ----------
    mirrors : tuple of MirrorFit
    psf : GaussianPsf
    x, y, value, residual : (n,) arrays
        The aligned samples above the bias and what the pooled Gaussian leaves of them, as shares
        of its peak.
    aligned : AlignedFit
    left_out : tuple of RejectedSpot
        Sources without a Gaussian of their own, in pixels of the image.
    """

    mirrors: tuple[MirrorFit, ...]
    psf: GaussianPsf
    x: Floats
    y: Floats
    value: Floats
    residual: Floats
    aligned: AlignedFit
    left_out: tuple[RejectedSpot, ...] = ()


def sdsu_2003_mirrors(
    image: Floats, places: Floats, options: SdsuMirrorsOptions | None = None
) -> PublishedMirrors:
    """Measure sources as the report of 2003 does.

    Parameters
    ----------
    image : (rows, cols) array
        NaN where there is no data.
    places : (n, 2) array
        Sources as (row, col), to a pixel.
    options : SdsuMirrorsOptions, optional

    Raises
    ------
    SupportError
        If no source has a Gaussian of its own; the message has the first one's reason.
    """
    chosen = options or SdsuMirrorsOptions()
    backgrounds = [_surroundings(image, place) for place in places]
    mirrors, left_out = [], []
    samples = []
    for place, around in zip(places, backgrounds, strict=True):
        found = _fit_mirror(image, place, around, chosen)
        if isinstance(found, RejectedSpot):
            left_out.append(found)
            continue
        rows, cols, values = _window(image, (found.row, found.col), chosen.window_px)
        mirrors.append(found)
        samples.append((cols - found.col, rows - found.row, values))
    if not mirrors:
        raise SupportError(
            f"none of {places.shape[0]} sources has a Gaussian of its own in a window of "
            f"{chosen.window_px} x {chosen.window_px} pixels, the first one because "
            f"{left_out[0].message}: choose other sources or method psf-fit"
        )
    around = np.concatenate([one[np.isfinite(one)] for one in backgrounds])
    x, y, values = (np.concatenate(part) for part in zip(*samples, strict=True))
    level, height = _levels(mirrors, values, float(around.mean()), chosen)
    unit = float(np.mean(height))
    psf, peak, bias, residual = _pool(x, y, (values - level) / height)
    value = ((values - level) / height - bias) / peak
    aligned = AlignedFit(
        psf.sigma_x_px, psf.sigma_y_px, unit * float(np.sqrt(np.mean(residual**2))),
        float(around.mean()), float(around.std()), unit * peak,
    )  # fmt: skip
    return PublishedMirrors(
        tuple(mirrors), psf, x, y, value, residual / peak, aligned, tuple(left_out)
    )


def _levels(
    mirrors: list[MirrorFit], values: Floats, background: float, options: SdsuMirrorsOptions
) -> tuple[Floats, Floats]:
    """Zero and unit of every pixel in the common fit: of all sources, or each source's own."""
    if options.scaled:
        biases, peaks = np.array([(one.bias, one.peak) for one in mirrors]).T
        size = options.window_px**2
        return np.repeat(biases, size), np.repeat(peaks, size)
    return np.full(values.size, background), np.full(values.size, values.max() - background)


def _window(image: Floats, place: tuple[float, float], side: int) -> tuple[Floats, Floats, Floats]:
    """Rows, columns and values of the window around the pixel nearest to a place; NaN outside."""
    reach = np.arange(side) - side // 2
    rows, cols = np.meshgrid(round(place[0]) + reach, round(place[1]) + reach, indexing="ij")
    inside = (rows >= 0) & (cols >= 0) & (rows < image.shape[0]) & (cols < image.shape[1])
    values = np.full(rows.shape, np.nan)
    values[inside] = image[rows[inside], cols[inside]]
    return rows.ravel().astype(float), cols.ravel().astype(float), values.ravel()


def _surroundings(image: Floats, place: Floats) -> Floats:
    """The uniform region around a source: the frame outside of its widest window."""
    side = 2 * _AROUND_PX + 1
    rows, cols, values = _window(image, (float(place[0]), float(place[1])), side)
    away = np.maximum(np.abs(rows - round(place[0])), np.abs(cols - round(place[1])))
    return np.asarray(values[away >= _AROUND_PX])


def _fit_mirror(
    image: Floats, place: Floats, around: Floats, options: SdsuMirrorsOptions
) -> MirrorFit | RejectedSpot:
    """The Gaussian of one source, or why there is none."""

    def rejected(reason: str, message: str) -> RejectedSpot:
        return RejectedSpot(float(place[0]), float(place[1]), reason, message)

    known = around[np.isfinite(around)]
    rows, cols, values = _window(image, (float(place[0]), float(place[1])), 3)
    if known.size < 8 or not np.isfinite(values).all():
        return rejected("edge", _INCOMPLETE)
    level, brightest = float(known.mean()), int(np.argmax(values))
    unit = float(values[brightest]) - level
    if not unit > 0:
        return rejected("faint", "its brightest pixel is no brighter than its surroundings")
    middle = (float(rows[brightest]), float(cols[brightest]))
    rows, cols, values = _window(image, middle, options.window_px)
    if not np.isfinite(values).all():
        return rejected("edge", _INCOMPLETE)
    # In shares of its own brightest pixel and about that, lest the unit and the place count.
    x, y, value = cols - middle[1], rows - middle[0], (values - level) / unit
    # Nine pixels leave three to tell their noise by: the surroundings know it better.
    final, covariance = _fit_gaussian(x, y, value, float(known.std()) / unit)
    peak, col, row, *_, bias = final.tolist()
    std = np.sqrt(np.maximum(covariance.diagonal(), 0.0))
    widths = np.abs(final[3:5])
    # Light in two rows or columns alone: the narrower and brighter, the better, without end.
    if not (peak > 0 and np.all(std[3:5] < widths)):
        return rejected(
            "no minimum", "its pixels do not determine the width and the peak of a Gaussian"
        )
    if max(abs(col), abs(row)) > options.window_px / 2:
        return rejected("no minimum", "the Gaussian that fits its pixels best lies beside them")
    row, col = row + middle[0], col + middle[1]
    # Of the window about the Gaussian's own place, whose pixels are pooled.
    if not np.isfinite(_window(image, (row, col), options.window_px)[2]).all():
        return rejected("edge", _INCOMPLETE)
    return MirrorFit(
        row, col, float(std[2]), float(std[1]), unit * peak, float(widths[0]), float(widths[1]),
        level + unit * bias,
    )  # fmt: skip


def _gaussian(p: Floats, x: Floats, y: Floats) -> Floats:
    """Peak, place x and y, widths x and y: the plain Gaussian of the report."""
    return np.asarray(p[0] * np.exp(-0.5 * (((x - p[1]) / p[3]) ** 2 + ((y - p[2]) / p[4]) ** 2)))


def _fit_gaussian(x: Floats, y: Floats, value: Floats, noise: float = 0.0) -> tuple[Floats, Floats]:
    """The Gaussian with a bias nearest to values, from one of peak 1 at 0, and its covariance.

    `noise` is the least standard deviation of the values.
    """
    start = np.array([1.0, 0.0, 0.0, 0.7, 0.7, 0.0])
    found = least_squares(
        lambda p: _gaussian(p[:5], x, y) + p[5] - value,
        start,
        x_scale=np.maximum(np.abs(start), 0.1),
        method="lm",
    )
    freedom = max(found.fun.size - start.size, 1)
    variance = max(float(found.fun @ found.fun) / freedom, noise**2)
    # What is not determined has a deviation without bound; a pseudo-inverse would call it exact.
    size = np.maximum(np.linalg.norm(found.jac, axis=0), 1e-60)
    _, power, axes = np.linalg.svd(found.jac / size, full_matrices=False)
    root = axes / np.maximum(power, 1e-60)[:, None] / size
    return np.asarray(found.x, float), np.asarray(variance * root.T @ root)


def _pool(x: Floats, y: Floats, value: Floats) -> tuple[GaussianPsf, float, float, Floats]:
    """One Gaussian for all aligned samples, its peak and bias, and what it leaves."""
    found, covariance = _fit_gaussian(x, y, value)
    power, axes = np.linalg.eigh(covariance[3:5, 3:5])
    factor = axes * np.sqrt(np.maximum(power, 0.0))
    rows = (tuple(factor[0].tolist()), tuple(factor[1].tolist()))
    psf = GaussianPsf(abs(float(found[3])), abs(float(found[4])), rows)
    peak, bias = float(found[0]), float(found[5])
    return psf, peak, bias, value - _gaussian(found[:5], x, y) - bias
