"""The reference estimator of an edge."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from acutance.curves.grid import Floats
from acutance.errors import NoEdgeError
from acutance.numerics.gaussian_pixel import GaussianPixel
from acutance.numerics.noise import Correlation
from acutance.targets.steps import Steps, finished
from acutance.targets.straight.error_causes import FitCauses
from acutance.targets.straight.first_fit import FirstFit, fit_first
from acutance.targets.straight.ground_steps import GroundSide
from acutance.targets.straight.lsf import LsfModel, SplineResponse
from acutance.targets.straight.pixels import EdgeFit, EdgePixels, Pixels
from acutance.targets.straight.pixels_alone import PixelsAlone
from acutance.targets.straight.solve import Solved, solve
from acutance.targets.straight.tuned import MIN_FITTED_HEIGHT

__all__ = ["SplineEdge", "fit_edge", "fit_edge_steps", "spline_edge"]


@dataclass(frozen=True, eq=False)
class SplineEdge(EdgeFit):
    """The reference estimator's fit, with the data of its checks.

    Attributes
    ----------
    blur : GaussianPixel
        The Gaussian through a pixel that fits the edge best.
    noise_dark, noise_bright : float
        Standard deviation of the noise on either side, in image units.
    correlation : Correlation
        Correlation of the noise, from the residuals.
    random_profile : (n,) array
        What noise that correlates is taken to add to the pixels all along the edge, as a share of
        the contrast; it is part of the residual.
    weights : (n,) array
        Weight of every pixel used, 1 where it is no outlier.
    tail : float
        Share of the line spread function (LSF) in the 1/x^2 tail.
    ground : pair of GroundSide
        The ground before and behind the target.
    causes : FitCauses
        What the uncertainty of the curves consists of.
    pixels_alone : PixelsAlone
        What the pixels say of the curves, the prior apart.
    families : dict of str to float
        Probability of every family of sensors.
    """

    response: SplineResponse
    blur: GaussianPixel
    noise_dark: float
    noise_bright: float
    correlation: Correlation
    random_profile: Floats
    weights: Floats
    tail: float
    ground: tuple[GroundSide, GroundSide]
    causes: FitCauses
    pixels_alone: PixelsAlone
    families: dict[str, float]


def fit_edge(trimmed: EdgePixels, *, robust: bool = True) -> SplineEdge:
    """Measure the edge of trimmed pixels.

    Parameters
    ----------
    trimmed : EdgePixels
    robust : bool, optional
        Bound the weight of outliers.

    Raises
    ------
    NoEdgeError
        If they hold no step.
    """
    return finished(fit_edge_steps(trimmed, robust=robust))


def fit_edge_steps(trimmed: EdgePixels, *, robust: bool) -> Steps[SplineEdge]:
    """`fit_edge` in steps."""
    solved = yield from solve(trimmed.pixels, _first_fit(trimmed), robust=robust)
    yield
    return spline_edge(trimmed.pixels, solved)


def _first_fit(trimmed: EdgePixels) -> FirstFit:
    """The Gaussian through a pixel about which the linear model is made."""
    if trimmed.blur is not None:
        return FirstFit(
            trimmed.line,
            trimmed.blur,
            trimmed.dark,
            trimmed.bright - trimmed.dark,
            trimmed.noise,
        )
    pixels = trimmed.pixels
    return fit_first(
        pixels.row, pixels.col, pixels.value, trimmed.line,
        dark=trimmed.dark, bright=trimmed.bright, sigma_px=trimmed.width_px, noise=trimmed.noise,
    )  # fmt: skip


def spline_edge(pixels: Pixels, solved: Solved) -> SplineEdge:
    """Turn the coefficients into curves about the 50 % point, with their covariance.

    Raises
    ------
    NoEdgeError
        If what was fitted is no step.
    """
    first_fit, solution, model = solved.first_fit, solved.solution, solved.model
    middle = _half_point(model, first_fit)
    response = model.response(middle)
    line = first_fit.line.moved(middle, math.degrees(solution.rotation_rad))
    line = line.bent(solution.curvature_per_px)
    s, t = line.distances(pixels.row, pixels.col)
    near = np.abs(s) < first_fit.blur.width_px
    length = float(np.ptp(t[near])) if near.any() else math.nan
    dark, height = solved.dark, model.height
    line = replace(
        line,
        angle_std_deg=math.degrees(solution.rotation_std_rad),
        offset_std_px=model.half_point_std(response),
        length_px=length,
    )
    return SplineEdge(
        line, response, dark, dark + height, s, (pixels.value - dark) / height,
        solution.residual / height, first_fit.blur, *solution.side_noise, solved.correlation,
        solved.random_profile / height, solved.outlier, model.tail / height, solved.ground,
        solved.causes, solved.pixels_alone, solved.seen.share,
    )  # fmt: skip


def _half_point(model: LsfModel, first_fit: FirstFit) -> float:
    """Normal distance of the 50 % point of a response that rises from one level to another.

    Next to a line or a bump of the background the correction takes the height of the first fit
    away again: what is left is no step, and its curves would be divided by a height of about zero.

    Raises
    ------
    NoEdgeError
        If the response is none of a step.
    """
    if model.height < MIN_FITTED_HEIGHT * first_fit.height:
        raise NoEdgeError(
            f"a first fit has a height of {first_fit.height:.4g}, the free one of "
            f"{model.height:.4g}: the pixels follow a line or a bump and no step; choose a region "
            "with one edge, or one pulse, between uniform plateaus"
        )
    middle = model.half_point()
    if math.isnan(middle):
        raise NoEdgeError(
            "the fitted response does not pass half its height within two widths "
            f"({2 * first_fit.blur.width_px:.1f} px) of the line: something else lies next to it; "
            "choose a region with one edge, or one pulse, between uniform plateaus"
        )
    return middle
