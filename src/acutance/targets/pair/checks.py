"""What is asked of an image pair.

The high image stands for the ground where its own MTF is near one (Li et al., "On-orbit MTF
estimation methods", 5.1 and 5.2); the rest is divided out with a known reference. What one band
sees and the other does not is no noise, and limits real pairs.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from acutance.curves import Estimate
from acutance.curves.metrics import NYQUIST_CPP
from acutance.raster import Box, Fill, Image
from acutance.targets.check import MAX_RATIO, Check, Limits, answer
from acutance.targets.pair import tuned
from acutance.targets.pair.gaussian_fit import GaussianFit
from acutance.targets.pair.grid import PairGrid
from acutance.targets.pair.kernel_fit import KernelFit
from acutance.targets.pair.kernel_otf import KernelOtf
from acutance.targets.pair.local import LocalFit
from acutance.targets.pair.rounding import detail_in_steps
from acutance.targets.pair.spectral_ratio import PairSpectra
from acutance.targets.processing_checks import PROCESSING_CHECKS, image_processing_checks
from acutance.targets.processing_traces import sample_boxes
from acutance.targets.record import ImageInfo
from acutance.targets.region import read_data, stated_gsd, undeclared_fill

__all__ = ["PAIR_CHECKS", "check_pair"]

PAIR_CHECKS = (
    "ratio",
    "reference_mtf",
    "reference_directions",
    "correlation",
    "coherence",
    "high_noise",
    "pixels",
    "left_out",
    "registration_px",
    "shift_px",
    "residual_correlation",
    "equal_blur",
    "inflation",
    "saturation",
    "undeclared_fill",
    "quantisation",
    "stated_gsd",
    *PROCESSING_CHECKS,
    "iteration_change",
)
"""The checks of a pair; "reference_directions" only where the reference was measured in one."""

_MIN_WINDOWS: Final = 4
"""Windows of one tile without gaps: of fewer the coherence is more chance than scene."""


def check_pair(
    grid: PairGrid,
    gaussian: GaussianFit,
    fit: KernelFit,
    model: KernelOtf,
    spectra: PairSpectra | None,
    local: LocalFit,
    difference: Estimate,
    limits: Limits,
    *,
    stop_change: float,
    clipped: float,
    fills: Sequence[Fill | None],
    defects: tuple[int, int],
    images: Sequence[tuple[Image, Box]],
    info: ImageInfo,
    inverted: bool,
) -> tuple[Check, ...]:
    """All checks of a pair.

    Parameters
    ----------
    grid : PairGrid
    gaussian : GaussianFit
    fit : KernelFit
        To the pixels.
    model : KernelOtf
    spectra : PairSpectra or None
    local : LocalFit
    difference : Estimate
        Variance of the blur of strong structures less that of weak ones, low pixels squared.
    limits : mapping of str to float
        Limits that the caller changed.
    stop_change : float
        Threshold of the parametric fit.
    clipped : float
        Share of clipped pixels, of the worse image.
    fills : sequence of Fill or None
        Undeclared fill of both images, tile by tile.
    defects : (int, int)
        Defective pixels of the low image, and samples of the high one, that were left out.
    images : sequence of (Image, Box)
        Both images, and which part of them is used.
    info : ImageInfo
        Of the low image.
    inverted : bool
        Whether the images match better with opposite sign.
    """
    return (
        _ratio(grid, limits),
        *_reference(model, limits),
        _correlation(gaussian, inverted, limits),
        _coherence(spectra, limits),
        _high_noise(model, limits),
        *_pixels(fit, defects, limits),
        *_places(gaussian, local, limits),
        *_residuals(fit, model, limits),
        _equal_blur(difference, limits),
        answer(
            "saturation", clipped, f"{100 * clipped:.2f} % of an image's pixels are clipped", limits
        ),
        undeclared_fill(fills, limits),
        _quantisation(images, limits),
        stated_gsd(info, limits),
        *image_processing_checks(images, limits),
        _iteration(gaussian, stop_change, limits),
    )


def _ratio(grid: PairGrid, limits: Limits) -> Check:
    axes = grid.down, grid.across
    ratio, band_cpp = min(one.ratio for one in axes), min(one.band_cpp for one in axes)
    found = (
        f"the high image's pixels are {ratio:.4g} times finer, and nothing is measured beyond "
        f"{band_cpp:.3g} cycles per low pixel"
    )
    return answer("ratio", round(ratio, 6), found, limits)


def _reference(model: KernelOtf, limits: Limits) -> Iterator[Check]:
    reference = model.reference
    if reference is None:
        yield answer(
            "reference_mtf", 0.0, "the high image's own MTF was not given", limits,
            advice="the result is the MTF of the low sensor OVER that of the high one, too large "
            "by the reciprocal of the latter; state it with reference_mtf (--reference)",
        )  # fmt: skip
        return
    nyquist, nothing = np.array([NYQUIST_CPP]), np.zeros(1)
    both = reference.otf(nyquist, nothing), reference.otf(nothing, nyquist)
    value = min(float(np.abs(one[0])) for one in both)
    found = f"the high image's own MTF is {value:.3f} at the low one's Nyquist frequency"
    yield answer("reference_mtf", value, found, limits)
    if reference.only_direction is not None:
        found = f"the reference's MTF was measured in {reference.only_direction}"
        yield answer("reference_directions", 1.0, found, limits)


def _correlation(gaussian: GaussianFit, inverted: bool, limits: Limits) -> Check:
    value = gaussian.correlation
    found = (
        f"the low image and the blurred high one correlate by {value:.3f} without their local means"
    )
    if inverted:
        found += "; they match better with opposite sign, so the bands differ"
    return answer("correlation", value, found, limits)


def _coherence(spectra: PairSpectra | None, limits: Limits) -> Check:
    if spectra is None:
        return answer(
            "coherence", 0.0, "the region has too few whole windows for spectra", limits,
            advice="choose a larger region with less nodata",
        )  # fmt: skip
    if spectra.windows < _MIN_WINDOWS:
        return answer(
            "coherence", 0.0,
            f"only {spectra.windows} windows are whole, too few to judge the coherence by", limits,
            advice="choose a larger region with fewer gaps",
        )  # fmt: skip
    columns, rows = (
        float(np.interp(NYQUIST_CPP, *spectra.along_axis(axis))) for axis in ("across", "along")
    )
    found = (
        f"squared coherence at Nyquist is {columns:.2f} from column to column, {rows:.2f} from row "
        "to row"
    )
    return answer("coherence", min(columns, rows), found, limits)


def _high_noise(model: KernelOtf, limits: Limits) -> Check:
    nyquist, nothing = np.array([NYQUIST_CPP]), np.zeros(1)
    shares = []
    for u, v in ((nyquist, nothing), (nothing, nyquist)):
        std = float(np.linalg.norm(model.by("reference_noise").factor(u, v)))
        mtf = float(np.abs(model.otf(u, v)[0]))
        shares.append(std / max(mtf, tuned.MIN_MTF_OF_NOISE))
    share = min(max(shares), MAX_RATIO)
    found = f"the high image's noise makes the MTF at Nyquist uncertain by {100 * share:.0f} %"
    return answer("high_noise", share, found, limits)


def _pixels(fit: KernelFit, defects: tuple[int, int], limits: Limits) -> Iterator[Check]:
    yield answer("pixels", float(fit.used), f"{fit.used} low pixels were used", limits)
    share = fit.left_out / max(fit.left_out + fit.used, 1)
    found = f"{100 * share:.1f} % of the low pixels do not fit the rest and were left out"
    if any(defects):
        low, high = defects
        found += (
            f"; {low} pixels of the low image and {high} samples of the high one lie far beyond "
            "all others, and the other image does not show them: defects, or a fill that is not "
            "declared"
        )
    yield answer("left_out", share, found, limits)


def _places(gaussian: GaussianFit, local: LocalFit, limits: Limits) -> Iterator[Check]:
    scatter = local.shift_scatter_px
    found = (
        f"the images shift against each other by {scatter:.3f} low pixels from place to place "
        "(standard deviation over the map)"
    )
    yield answer("registration_px", scatter, found, limits)
    shift = float(np.hypot(gaussian.down.shift_px, gaussian.across.shift_px))
    yield answer(
        "shift_px", shift, f"the low image lies {shift:.2f} low pixels off its geometry", limits
    )


def _residuals(fit: KernelFit, model: KernelOtf, limits: Limits) -> Iterator[Check]:
    correlation = fit.whitening.correlation.significant
    found = f"neighbouring residuals correlate by {correlation:.2f}"
    yield answer("residual_correlation", correlation, found, limits)
    found = (
        f"regions of the map scatter {model.inflation:.2f} times as much as white residuals explain"
    )
    yield answer("inflation", model.inflation, found, limits)


def _equal_blur(difference: Estimate, limits: Limits) -> Check:
    sigmas = min(abs(difference.value) / difference.std, MAX_RATIO) if difference.std > 0 else 0.0
    found = "strong and weak structures are too few to compare how they are blurred"
    if math.isfinite(difference.std):
        size = Estimate(abs(difference.value), difference.std)
        found = (
            f"the blur of strong structures is {'wider' if difference.value > 0 else 'narrower'} "
            f"than that of weak ones by a variance of {size} low pixels squared"
        )
    return answer("equal_blur", sigmas, found, limits)


def _quantisation(images: Sequence[tuple[Image, Box]], limits: Limits) -> Check:
    """How much the image of the fewer grey levels changes from pixel to pixel."""
    steps = [
        detail_in_steps(read_data(image, part)[0] for part in sample_boxes(box))
        for image, box in images
    ]
    least = min(steps)
    if least >= MAX_RATIO:
        found = "the images' numbers are finer than what changes from pixel to pixel"
        return answer("quantisation", MAX_RATIO, found, limits)
    which = "low" if least == steps[0] else "high"
    return answer(
        "quantisation", least,
        f"pixels of the {which} image differ from the mean of their neighbours by {least:.2f} "
        "steps of its numbers, rounding taken off", limits,
        advice="rounded images have contours at the same places, and the MTF is too high; use "
        "data of more bits",
    )  # fmt: skip


def _iteration(gaussian: GaussianFit, stop_change: float, limits: Limits) -> Check:
    change = gaussian.steps[-1].change
    found = (
        f"the parametric fit ended after {len(gaussian.steps)} steps with a relative change of the "
        f"residual of {change:.1e} (threshold {stop_change:.1e})"
    )
    return answer("iteration_change", change / stop_change, found, limits)
