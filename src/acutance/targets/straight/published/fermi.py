"""Parametric edge: a sum of Fermi functions fitted to all pixels at once.

Source: the Fermi function of Tzannes, Mooney, "Measurement of the modulation transfer function
of infrared cameras", Optical Engineering 34 (1995), doi:10.1117/12.203133, summed where there
is over- or undershoot as in the QuickBird report (2003), section 3.3.1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from acutance.arguments import require_types
from acutance.curves import Esf, Lsf, Mtf, Response
from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError, SupportError
from acutance.geometry.line import Line
from acutance.targets.straight.pixels import EdgeFit, EdgePixels
from acutance.targets.straight.published.fermi_sum import FermiSum
from acutance.targets.straight.published.resampled_response import (
    FREQ_CPP,
    GRID_PX,
    crossing_of_half,
    edge_fit,
)
from acutance.targets.straight.published.row_profiles import Frame, crossing_rows

__all__ = ["FermiOptions", "fermi"]

_MAX_TERM = 20.0
_PIXELS_PER_UNKNOWN = 5


@dataclass(frozen=True)
class FermiOptions:
    """Choices of `fermi`.

    Parameters
    ----------
    max_terms : {1, 2, 3}
        Most Fermi functions in the sum; how many are used is the criterion's choice.
    criterion : {"bic", "aicc"}
        Bayes's information criterion, or Akaike's with its correction for small samples,
        which admits more terms.
    """

    max_terms: Literal[1, 2, 3] = 3
    criterion: Literal["bic", "aicc"] = "bic"

    def __post_init__(self) -> None:
        require_types(self)


_DEFAULT = FermiOptions()


@dataclass(frozen=True, eq=False)
class _Fit:
    """One fitted sum: (turn in radians, dark level, then the sum's own numbers), (3 K + 2,)."""

    unknown: Floats
    covariance: Floats
    score: float

    @property
    def terms(self) -> FermiSum:
        return FermiSum.from_vector(self.unknown[2:])


def fermi(trimmed: EdgePixels, options: FermiOptions = _DEFAULT) -> EdgeFit:
    """Measure an edge by a sum of one to three Fermi functions.

    Direction, dark level and all terms are fitted to all pixels together by non-linear least
    squares; the number of terms is the one with the best information criterion. Edge spread
    function (ESF), line spread function (LSF) and optical transfer function (OTF) are closed forms
    of the fitted numbers.

    Parameters
    ----------
    trimmed : EdgePixels
    options : FermiOptions, optional

    Returns
    -------
    EdgeFit
        Curves along the normal. Their covariance is that of the fit, s^2 (J^T J)^-1: it holds
        for a system that is such a sum. The difference of another system's shape is a bias, and
        neither that nor the choice of the number of terms is covered.

    Raises
    ------
    SupportError
        If fewer than ten rows cross the edge, or too few pixels are usable.
    NoEdgeError
        If no sum of Fermi functions rises from dark to bright in the trimmed.
    """
    crossing_rows(trimmed, Frame.of(trimmed))
    row, col = trimmed.pixels.row, trimmed.pixels.col
    if row.size < _PIXELS_PER_UNKNOWN * (2 + 3 * options.max_terms):
        raise SupportError(
            f"{options.max_terms} Fermi functions need at least "
            f"{_PIXELS_PER_UNKNOWN * (2 + 3 * options.max_terms)} usable pixels, "
            f"found {row.size}: use a larger region or fewer terms"
        )
    pixels = _Pixels(
        *trimmed.line.distances(row, col),
        trimmed.pixels.value,
    )
    fit = _best_sum(pixels, trimmed, options)
    response, middle_px, middle_gradient = _response(fit)
    line = _line(trimmed.line, pixels, fit, middle_px, middle_gradient)
    dark = float(fit.unknown[1])
    return edge_fit(trimmed, line, response, dark=dark, bright=dark + fit.terms.contrast)


@dataclass(frozen=True, eq=False)
class _Pixels:
    """Usable pixels in the coordinates of the start line, (n,) each."""

    normal_px: Floats
    tangent_px: Floats
    value: Floats

    def distance(self, rotation_rad: float) -> tuple[Floats, Floats]:
        """Normal distance after turning the line about its point, and its derivative."""
        c, s = math.cos(rotation_rad), math.sin(rotation_rad)
        return (
            c * self.normal_px + s * self.tangent_px,
            c * self.tangent_px - s * self.normal_px,
        )

    def model(self, unknown: Floats) -> Floats:
        distance, _ = self.distance(float(unknown[0]))
        return np.asarray(unknown[1] + FermiSum.from_vector(unknown[2:]).value(distance))

    def jacobian(self, unknown: Floats) -> Floats:
        distance, turning = self.distance(float(unknown[0]))
        terms = FermiSum.from_vector(unknown[2:])
        turned = terms.slope(distance) * turning
        level = np.ones_like(distance)
        return np.column_stack((turned, level, terms.value_gradient(distance)))


def _best_sum(pixels: _Pixels, trimmed: EdgePixels, options: FermiOptions) -> _Fit:
    """The number of terms with the best criterion; each begins with the best sum before."""
    width = max(0.55 * trimmed.width_px, 0.05)
    single = FermiSum(np.array([trimmed.bright - trimmed.dark]), np.zeros(1), np.array([width]))
    best = _fit(pixels, np.concatenate(([0.0, trimmed.dark], single.to_vector())), options)
    if best is None:
        raise NoEdgeError(
            "no Fermi function rises from dark to bright: use a region with one "
            "edge and more contrast"
        )
    last = single_fit = best
    for count in range(2, options.max_terms + 1):
        starts = _with_one_more(last)
        if count == 3:
            # Over- and undershoot of a symmetric system: one of them alone may help nothing.
            starts.append(_with_both_shoots(single_fit))
        fits = [fit for start in starts if (fit := _fit(pixels, start, options))]
        if not fits:
            continue
        last = min(fits, key=lambda fit: fit.score)
        best = min(best, last, key=lambda fit: fit.score)
    return best


def _with_both_shoots(fit: _Fit) -> Floats:
    """A start with an under- and an overshoot about the largest term."""
    terms = fit.terms
    k = int(np.argmax(np.abs(terms.amplitude)))
    a, m, c = terms.amplitude[k], terms.centre_px[k], terms.width_px[k]
    shoots = FermiSum(
        a * np.array([1.2, -0.1, -0.1]), m + 4.0 * c * np.array([0, 1, -1]), c * np.ones(3)
    )
    return np.concatenate((fit.unknown[:2], shoots.to_vector()))


def _with_one_more(fit: _Fit) -> list[Floats]:
    """Starts with one term more: the largest one split, or an overshoot on either side."""
    terms = fit.terms
    k = int(np.argmax(np.abs(terms.amplitude)))
    a, m, c = terms.amplitude[k], terms.centre_px[k], terms.width_px[k]
    starts = []
    for share, shift, stretch in ((0.5, 1.5, 0.8), (-0.1, 4.0, 1.5), (-0.1, -4.0, 1.5)):
        amplitude = terms.amplitude.copy()
        centre, width = terms.centre_px.copy(), terms.width_px.copy()
        amplitude[k] = (1 - share) * a
        if share > 0:
            centre[k], width[k] = m - shift * c * (1 - share), stretch * c
        starts.append(
            np.concatenate(
                (
                    fit.unknown[:2],
                    np.append(amplitude, share * a),
                    np.append(centre, m + shift * c * (1 - share)),
                    np.log(np.append(width, stretch * c)),
                )
            )
        )
    return starts


def _fit(pixels: _Pixels, start: Floats, options: FermiOptions) -> _Fit | None:
    """Least squares from one start; None where it ends in no rising edge or is undetermined."""
    from scipy.optimize import least_squares

    count, size = pixels.value.size, start.size
    found = least_squares(
        lambda unknown: pixels.model(unknown) - pixels.value,
        start,
        jac=pixels.jacobian,
        method="lm",
        x_scale="jac",
        max_nfev=200,
    )
    terms = FermiSum.from_vector(found.x[2:])
    if terms.contrast <= 0 or np.abs(terms.amplitude).max() > _MAX_TERM * terms.contrast:
        return None
    jacobian = pixels.jacobian(found.x)
    scale = np.sqrt(np.einsum("ij,ij->j", jacobian, jacobian))
    if scale.min() <= 0:
        return None
    triangle = np.linalg.qr(jacobian / scale, mode="r")
    if np.linalg.cond(triangle) > 1e8:
        return None
    inverse = np.linalg.inv(triangle) / scale[:, None]
    squares = 2 * float(found.cost)
    variance = squares / (count - size)
    floor = count * (1e-12 * terms.contrast) ** 2
    fidelity = count * math.log((squares + floor) / count)
    if options.criterion == "bic":
        penalty = size * math.log(count)
    else:
        penalty = 2.0 * size * count / max(count - size - 1, 1)
    return _Fit(found.x, variance * inverse @ inverse.T, fidelity + penalty)


def _response(fit: _Fit) -> tuple[Response, float, Floats]:
    """The curves with their covariance, the 50 % point and its gradient by the unknowns."""
    terms, size = fit.terms, fit.unknown.size
    contrast, count = terms.contrast, terms.amplitude.size
    by_contrast = np.zeros(size)
    by_contrast[2 : 2 + count] = 1.0 / contrast
    middle, middle_gradient = _middle(terms, by_contrast)

    x = GRID_PX + middle
    esf, lsf = terms.value(x) / contrast, terms.slope(x) / contrast
    esf_gradient = (
        _padded(terms.value_gradient(x), size) / contrast
        - np.outer(esf, by_contrast)
        + np.outer(lsf, middle_gradient)
    )
    lsf_gradient = (
        _padded(terms.slope_gradient(x), size) / contrast
        - np.outer(lsf, by_contrast)
        + np.outer(terms.bend(x) / contrast, middle_gradient)
    )

    centroid_gradient = np.zeros(size)
    centroid_gradient[2 : 2 + count] = (terms.centre_px - terms.centroid_px) / contrast
    centroid_gradient[2 + count : 2 + 2 * count] = terms.amplitude / contrast
    phase = 2j * np.pi * FREQ_CPP
    back = np.exp(phase * terms.centroid_px) / contrast
    otf = terms.transfer(FREQ_CPP) * back
    otf_gradient = (
        _padded(terms.transfer_gradient(FREQ_CPP), size) * back[:, None]
        - np.outer(otf, by_contrast)
        + np.outer(otf * phase, centroid_gradient)
    )

    root = _square_root(fit.covariance)
    response = Response(
        Esf(GRID_PX, esf, esf_gradient @ root),
        Lsf(GRID_PX, lsf, lsf_gradient @ root),
        Mtf(FREQ_CPP, otf, otf_gradient @ root),
    )
    return response, middle, middle_gradient


def _middle(terms: FermiSum, by_contrast: Floats) -> tuple[float, Floats]:
    """The 50 % point of a sum and its gradient by all unknowns."""
    wide = np.arange(-200.0, 201.0) * 0.05 + terms.centroid_px
    middle = crossing_of_half(wide, terms.value(wide) / terms.contrast)
    if math.isnan(middle):
        raise NoEdgeError(
            "the fitted sum of Fermi functions never passes 50 % of its contrast: choose a region "
            "with one edge between uniform plateaus"
        )
    there = np.array([middle])
    steepness = float(terms.slope(there)[0]) / terms.contrast
    rise = _padded(terms.value_gradient(there), by_contrast.size)[0] / terms.contrast
    return middle, -(rise - 0.5 * by_contrast) / steepness


def _square_root(covariance: Floats) -> Floats:
    """A factor of a covariance, also of one that is 0 or singular."""
    deviation = np.sqrt(np.diag(covariance))
    scale = np.where(deviation > 0, deviation, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))


def _padded(gradient: NDArray[Any], size: int) -> NDArray[Any]:
    """A gradient by the terms' numbers as one by all unknowns: turn and level change nothing."""
    return np.hstack((np.zeros((gradient.shape[0], size - gradient.shape[1])), gradient))


def _line(
    start: Line, pixels: _Pixels, fit: _Fit, middle_px: float, middle_gradient: Floats
) -> Line:
    """The line through the 50 % point, given at the middle of the pixels used."""
    turned = start.moved(0.0, math.degrees(float(fit.unknown[0])))
    along = float(pixels.tangent_px.mean())
    x, y = turned.normal
    # Away from the point it was turned about, the turn's uncertainty moves the line as well.
    gradient = middle_gradient.copy()
    gradient[0] -= along
    return replace(
        turned,
        row=turned.row + middle_px * y + along * x,
        col=turned.col + middle_px * x - along * y,
        angle_std_deg=math.degrees(math.sqrt(max(float(fit.covariance[0, 0]), 0.0))),
        offset_std_px=math.sqrt(max(float(gradient @ fit.covariance @ gradient), 0.0)),
        length_px=float(np.ptp(pixels.tangent_px)),
    )
