"""What is asked of an image pair, and where the questions come from.

- ratio, reference_mtf: the high image stands for the ground where its own MTF is near one (Li et
  al., "On-orbit MTF estimation methods", 5.1 and 5.2: "the resolution difference should be as much
  as possible"); the rest is divided out with a known reference.
- coherence, pixels: both images need high spatial frequencies: roads, shorelines, buildings (5.2).
- correlation, residual_correlation, inflation: the same or a similar spectral band (5.1); what one
  band sees and the other does not is no noise, and limits real pairs.
- shift_px, registration_px, left_out: the same ground at the same time.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from acutance.curves.metrics import NYQUIST_CPP
from acutance.targets.measurement import Check
from acutance.targets.pair.first_fit import BlurFit
from acutance.targets.pair.grid import PairGrid
from acutance.targets.pair.kernel_fit import KernelFit
from acutance.targets.pair.kernel_otf import KernelOtf
from acutance.targets.pair.local import LocalFit
from acutance.targets.pair.options import BiresolutionLimits
from acutance.targets.pair.spectral_ratio import PairSpectra
from acutance.targets.straight.check_data import at_least, at_most

__all__ = ["PairEvidence", "check_pair"]


@dataclass(frozen=True, eq=False)
class PairEvidence:
    """What the checks read.

    Parameters
    ----------
    grid : PairGrid
    blur : BlurFit
    fit : KernelFit
    model : KernelOtf
    spectra : PairSpectra or None
    local : LocalFit
    saturated : float
        Share of an image's pixels at the end of the scale, of the worse one.
    inverted : bool
        Whether the images match better with opposite sign.
    stop_change : float
        Threshold of the parametric fit.
    only_direction : str or None
        The direction of the reference's measurement, where it is a single one.
    """

    grid: PairGrid
    blur: BlurFit
    fit: KernelFit
    model: KernelOtf
    spectra: PairSpectra | None
    local: LocalFit
    saturated: float
    inverted: bool
    stop_change: float
    only_direction: str | None = None


def check_pair(seen: PairEvidence, limits: BiresolutionLimits) -> tuple[Check, ...]:
    """All checks of a pair."""
    return tuple(_checks(seen, limits))


def _checks(seen: PairEvidence, limits: BiresolutionLimits) -> Iterator[Check]:
    ratio = min(seen.grid.down.ratio, seen.grid.across.ratio)
    yield at_least(
        "ratio", round(ratio, 6), limits.ratio,
        f"the high image's pixels are {ratio:.4g} times finer: it says nothing beyond "
        f"{ratio / 2:.3g} cycles per low pixel, and its own blur and aliasing count the less the "
        "finer it is (Li et al. 5.2)",
    )  # fmt: skip
    yield _reference(seen, limits)
    if seen.only_direction is not None:
        yield at_least(
            "reference_directions", 1.0, limits.reference_directions,
            f"the reference's MTF was measured in {seen.only_direction}, and is taken for all: "
            "smear or asymmetry of its sensor is then in the result; combine measurements in two "
            "directions, or use points or a star",
        )  # fmt: skip
    sign = "; it matches better with opposite sign: not the same band" if seen.inverted else ""
    yield at_least(
        "correlation", seen.blur.correlation, limits.correlation,
        f"the low image and the blurred high one correlate by {seen.blur.correlation:.3f} without "
        f"their local means: other bands, dates or views show other things{sign}",
    )  # fmt: skip
    yield _coherence(seen, limits)
    yield at_least(
        "pixels", float(seen.fit.used), limits.pixels,
        f"{seen.fit.used} low pixels were used: the standard deviations fall with their root",
    )  # fmt: skip
    lost = seen.fit.left_out / max(seen.fit.left_out + seen.fit.used, 1)
    yield at_most(
        "left_out", lost, limits.left_out,
        f"{100 * lost:.1f} % of the low pixels do not fit the rest and were left out: clouds, "
        "shadows, changes between the two dates, defects; mask them, or choose another region",
    )  # fmt: skip
    spread = seen.local.shift_spread_px
    yield at_most(
        "registration_px", spread, limits.registration_px,
        f"the images shift against each other by {spread:.3f} low pixels (standard deviation over "
        "the map) from place to place: that blurs the kernel; choose a smaller region",
    )  # fmt: skip
    shift = float(np.hypot(seen.blur.down.shift_px, seen.blur.across.shift_px))
    yield at_most(
        "shift_px", shift, limits.shift_px,
        f"the low image lies {shift:.2f} low pixels off its geometry: measured and allowed for, "
        "but a sign of a wrong pair or ratio",
    )  # fmt: skip
    correlation = abs(seen.fit.whitening.strongest)
    yield at_most(
        "residual_correlation", correlation, limits.residual_correlation,
        f"neighbouring residuals correlate by {correlation:.2f}: the two bands see different "
        "colours, or the scene changed; the fit whitens them and the intervals allow for it, but "
        "a difference that looks like blur stays in the MTF",
    )  # fmt: skip
    inflation = seen.model.inflation
    yield at_most(
        "inflation", inflation, limits.inflation,
        f"regions of the map scatter {inflation:.2f} times as much as white residuals explain: the "
        "standard deviations were raised by that",
    )  # fmt: skip
    yield at_most(
        "saturation", seen.saturated, limits.saturation,
        f"{100 * seen.saturated:.2f} % of an image's pixels are clipped at the end of the scale",
    )  # fmt: skip
    change = seen.blur.steps[-1].change / seen.stop_change
    yield at_most(
        "iteration_change", change, limits.iteration_change,
        f"the parametric fit ended after {len(seen.blur.steps)} steps with a relative change of "
        f"the residual of {seen.blur.steps[-1].change:.1e} (threshold {seen.stop_change:.1e}, Li "
        "et al. 5.3)",
    )  # fmt: skip


def _reference(seen: PairEvidence, limits: BiresolutionLimits) -> Check:
    if seen.model.reference is None:
        return at_least(
            "reference_mtf", 0.0, limits.reference_mtf,
            "the high image's own MTF was not given: the result is the MTF of the low sensor OVER "
            "that of the high one, too large by the reciprocal of the latter; state it with "
            "reference_mtf (--reference)",
        )  # fmt: skip
    nyquist, nothing = np.array([NYQUIST_CPP]), np.zeros(1)
    both = (
        seen.model.reference.otf(nyquist, nothing),
        seen.model.reference.otf(nothing, nyquist),
    )  # fmt: skip
    value = min(float(np.abs(one[0])) for one in both)
    return at_least(
        "reference_mtf", value, limits.reference_mtf,
        f"the high image's own MTF is {value:.3f} at the low one's Nyquist frequency: it is "
        "divided out, and every per cent it is wrong by is in the result",
    )  # fmt: skip


def _coherence(seen: PairEvidence, limits: BiresolutionLimits) -> Check:
    if seen.spectra is None:
        return at_least(
            "coherence", 0.0, limits.coherence,
            "too few whole windows for spectra: choose a larger region with less nodata",
        )  # fmt: skip
    found = []
    for axis in ("across", "along"):
        freq, coherence = seen.spectra.along_axis(axis)
        found.append(float(np.interp(NYQUIST_CPP, freq, coherence)))
    value = min(found)
    return at_least(
        "coherence", value, limits.coherence,
        f"squared coherence at Nyquist {found[0]:.2f} across, {found[1]:.2f} along: the share of "
        "the low image's detail there that the high image explains; the rest is noise, aliasing "
        "and what the two see differently",
    )  # fmt: skip
